//! A cable between the program and a robot that listens on a port, which can be pulled: nothing passes it any more, and neither end is told.
//! Nor is the robot told that the program has ended, as over a serial device. What is said over it can be read along.

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
    /// Where the program finds the robot.
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

    /// The next line at either end that is one of these, whether it has passed or not.
    pub(crate) fn until(&self, words: &[&str]) -> String {
        loop {
            let text = self.said.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("nobody says any of {words:?}"));
            if text.split(' ').next().is_some_and(|word| words.contains(&word)) {
                return text;
            }
        }
    }
}

/// Carries what one end says to the other as long as it says something; both connections stay open until the other end has ended too.
fn carry(mut from: TcpStream, mut to: TcpStream, pulled: &AtomicBool, say: &Sender<String>) {
    let (mut bytes, mut lines) = ([0; 1024], LineReader::default());
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        if !pulled.load(Ordering::SeqCst) {
            // An end that is gone hears nothing; the other is not told.
            let _ = to.write_all(&bytes[..count]);
        }
        for text in bytes[..count].iter().filter_map(|byte| lines.take(*byte)) {
            // Whoever no longer reads along has read enough.
            let _ = say.send(text);
        }
    }
}
