//! The server of the virtual robot, reduced to what a STOP needs, on a local port. It greets each connection and
//! reports the received messages with their times. Its robot never collides.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use crate::paced::Seen;

/// Starts a server; returns its address and its events.
pub(crate) fn listening() -> (String, Receiver<(Seen, Instant)>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("this machine has a free port");
    let place = listener.local_addr().expect("it is bound").to_string();
    let (say, seen) = channel();
    std::thread::spawn(move || {
        // The only client opens a new connection after it has closed the last.
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
        // Each message arrives in one piece.
        for message in String::from_utf8_lossy(&bytes[..count]).split(';') {
            let seen = [("moveForward", Seen::Moves), ("alarm", Seen::Halt)];
            for (_, seen) in seen.into_iter().filter(|(name, _)| message.contains(name)) {
                // The receiver is gone when the benchmark has all its STOPs.
                let _ = say.send((seen, heard));
            }
        }
    }
}
