//! mosquitto under the same flood: the time of single messages from a publisher to a subscriber.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::course::{Doors, OPERATOR};
use crate::figures::Spread;
use crate::floods::Flood;
use crate::packets::{SUBACK, publish, subscribe};
use crate::stage::Sender;
use crate::wire::{Wire, login};

/// Time from the beginning of the flood to the first message.
const WARM_UP: Duration = Duration::from_secs(2);

/// Pause between two messages, as between two STOPs.
const PAUSE: Duration = Duration::from_millis(10);

/// Time limit of a message.
const PATIENCE: Duration = Duration::from_secs(10);

const TOPIC: &str = "beside/stop";

struct Mosquitto {
    child: Child,
    folder: PathBuf,
    at: SocketAddr,
}

impl Mosquitto {
    fn start() -> Result<Mosquitto, String> {
        let folder = std::env::temp_dir().join(format!("hallsweep-storm-mosquitto-{}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        let free = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
        let at = free.map_err(|error| error.to_string())?;
        let settings = folder.join("mosquitto.conf");
        let text = format!("listener {} 127.0.0.1\nallow_anonymous true\npersistence false\n", at.port());
        std::fs::write(&settings, text).map_err(|error| error.to_string())?;
        let mut command = Command::new("mosquitto");
        command.arg("-c").arg(settings).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let child = command.spawn().map_err(|error| format!("mosquitto: {error}"))?;
        let started = Mosquitto { child, folder, at };
        let until = Instant::now() + PATIENCE;
        while std::net::TcpStream::connect(at).is_err() {
            if Instant::now() > until {
                return Err("mosquitto does not serve".to_owned());
            }
            std::thread::sleep(PAUSE);
        }
        Ok(started)
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Times of single messages through mosquitto during this flood, with the senders at mosquitto's own priority.
pub(crate) fn mosquitto(flood: &Flood, doors: &Doors, messages: usize) -> Result<Spread, String> {
    let mosquitto = Mosquitto::start()?;
    let sender = Sender::flood(flood.name, &Doors { mqtt: mosquitto.at, ..doors.clone() }, false)?;
    std::thread::sleep(WARM_UP);
    let took = single(mosquitto.at, messages).map_err(|error| format!("mosquitto: {error}"))?;
    let (done, _) = sender.end();
    if done == 0 {
        return Err(format!("{} did nothing at mosquitto", flood.name));
    }
    Spread::of(took).ok_or_else(|| "no message came".to_owned())
}

fn single(at: SocketAddr, messages: usize) -> io::Result<Vec<Duration>> {
    let come = |client_id| Wire::let_in(at, Ipv4Addr::LOCALHOST, &login(client_id, OPERATOR, "-"), PATIENCE);
    let (mut publisher, mut subscriber) = (come("beside-publisher")?, come("beside-subscriber")?);
    subscriber.say(&subscribe(1, TOPIC, 0))?;
    subscriber.until(SUBACK)?;
    let message = publish(TOPIC, b"stop", 0, 0, 0);
    let once = |_| {
        std::thread::sleep(PAUSE);
        let said = Instant::now();
        publisher.say(&message)?;
        subscriber.until(0x30)?;
        Ok(said.elapsed())
    };
    (0..messages).map(once).collect()
}
