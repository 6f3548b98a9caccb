//! The server of the virtual robot as far as a STOP is concerned, at a port of this machine: it greets each connection and tells what came
//! over it, and when. Its robot meets nothing.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use crate::paced::Seen;

/// Starts one; where it listens, and what it sees.
pub(crate) fn listening() -> (String, Receiver<(Seen, Instant)>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("this machine has a free port");
    let place = listener.local_addr().expect("it is bound").to_string();
    let (say, seen) = channel();
    std::thread::spawn(move || {
        // Its one client makes a new connection when it has ended the last.
        for stream in listener.incoming().flatten() {
            let _ = serve(stream, &say);
        }
    });
    (place, seen)
}

fn serve(mut stream: TcpStream, say: &Sender<(Seen, Instant)>) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    stream.write_all(b";{\"type\":\"webpage-ready\",\"arg\":{}};\n")?;
    let mut bytes = [0; 1024];
    loop {
        let count = stream.read(&mut bytes)?;
        let heard = Instant::now();
        if count == 0 {
            return Ok(());
        }
        // A message comes in one piece.
        for message in String::from_utf8_lossy(&bytes[..count]).split(';') {
            let seen = [("moveForward", Seen::Moves), ("alarm", Seen::Halt)];
            for (_, seen) in seen.into_iter().filter(|(name, _)| message.contains(name)) {
                // Whoever no longer looks has seen enough.
                let _ = say.send((seen, heard));
            }
        }
    }
}
