//! Screens that come and go: each opens an event stream, reads it for a while, and closes it.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{sleep, spawn};
use std::time::Duration;

use hallsweep_core::rng::RandomStream;

/// Number of concurrent screens.
const SCREENS: u64 = 6;

/// Interval between a screen's decisions whether to leave; a stream sends an event at least every second.
const GLANCE: Duration = Duration::from_millis(100);

/// All screens; their threads end with this process.
pub(crate) struct Readers(Arc<Screens>);

#[derive(Default)]
struct Screens {
    rests: AtomicBool,
    open: AtomicUsize,
}

impl Readers {
    pub(crate) fn start(address: &str) -> Readers {
        let screens = Arc::new(Screens::default());
        for number in 0..SCREENS {
            let (screens, address) = (Arc::clone(&screens), address.to_owned());
            spawn(move || screens.look(&address, RandomStream::new(number, "screen")));
        }
        Readers(screens)
    }

    /// Makes all screens leave and stay away, or return; waits until they have left.
    pub(crate) fn rest(&self, rests: bool) {
        self.0.rests.store(rests, Ordering::SeqCst);
        while rests && self.0.open.load(Ordering::SeqCst) > 0 {
            sleep(GLANCE);
        }
    }
}

impl Screens {
    fn look(&self, address: &str, mut chance: RandomStream) {
        loop {
            sleep(GLANCE);
            self.open.fetch_add(1, Ordering::SeqCst);
            if !self.rests.load(Ordering::SeqCst) {
                // A broken stream counts as one that a screen left.
                let _ = self.read(address, &mut chance);
            }
            self.open.fetch_sub(1, Ordering::SeqCst);
        }
    }

    fn read(&self, address: &str, chance: &mut RandomStream) -> std::io::Result<()> {
        let path = if chance.happens(0.5) { "/api/v1/events" } else { "/console/live" };
        let mut stream = TcpStream::connect(address)?;
        stream.set_read_timeout(Some(GLANCE))?;
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\n\r\n")?;
        let mut events = [0; 16 * 1024];
        while !chance.happens(0.01) && !self.rests.load(Ordering::SeqCst) {
            match stream.read(&mut events) {
                Ok(0) => break,
                Ok(_) => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
