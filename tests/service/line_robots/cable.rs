//! A cable between the program and a robot that listens on a port. After the cable is pulled nothing passes, and
//! neither end is told. The robot is not told either that the program has ended, as on a serial device. Tests can
//! read the lines on the cable.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::spawn;

use hallsweep_drivers::line::LineReader;

use crate::program::PATIENCE;

/// A cable for one connection.
pub(crate) struct Cable {
    /// Address at which the program connects to the robot.
    pub(crate) place: String,
    said: Receiver<String>,
    is_pulled: Arc<AtomicBool>,
}

impl Cable {
    pub(crate) fn to(robot: &str) -> Cable {
        let listener = TcpListener::bind("127.0.0.1:0").expect("this machine has a free port");
        let place = listener.local_addr().expect("it is bound").to_string();
        let robot = TcpStream::connect(robot).expect("the robot listens");
        let (say, said) = channel();
        let is_pulled = Arc::new(AtomicBool::new(false));
        let pulled = Arc::clone(&is_pulled);
        spawn(move || {
            let Ok((program, _)) = listener.accept() else { return };
            let copy = |end: &TcpStream| end.try_clone().expect("a descriptor is left");
            let there = (copy(&program), copy(&robot), Arc::clone(&pulled), say.clone());
            for (from, to, pulled, say) in [there, (robot, program, pulled, say)] {
                spawn(move || carry(from, to, &pulled, &say));
            }
        });
        Cable { place, said, is_pulled }
    }

    pub(crate) fn pull(&self) {
        self.is_pulled.store(true, Ordering::SeqCst);
    }

    /// Next line in either direction that starts with one of these words, even if the pulled cable did not deliver
    /// it.
    pub(crate) fn until(&self, words: &[&str]) -> String {
        loop {
            let text = self.said.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("nobody says any of {words:?}"));
            if text.split(' ').next().is_some_and(|word| words.contains(&word)) {
                return text;
            }
        }
    }
}

/// Forwards the bytes of one end until that end closes. Both connections stay open until the other end has closed
/// too.
fn carry(mut from: TcpStream, mut to: TcpStream, pulled: &AtomicBool, say: &Sender<String>) {
    let (mut bytes, mut lines) = ([0; 1024], LineReader::default());
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        if !pulled.load(Ordering::SeqCst) {
            // A write error is ignored: the sender must not learn that the other end is gone.
            let _ = to.write_all(&bytes[..count]);
        }
        for text in bytes[..count].iter().filter_map(|byte| lines.take(*byte)) {
            // A test that has dropped its receiver needs no further lines.
            let _ = say.send(text);
        }
    }
}
