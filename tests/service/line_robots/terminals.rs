//! Two pseudo-terminals in place of a serial cable and its two devices, with faults from a seed: bytes are lost,
//! changed or inserted.

use std::fs::File;
use std::io::{Read, Write};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{sleep, spawn};
use std::time::Duration;

use hallsweep_core::rng::RandomStream;
use hallsweep_drivers::line::LineReader;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

pub(crate) struct Terminals {
    /// Device of the robot.
    pub(crate) robot: String,
    /// Device of the program.
    pub(crate) program: String,
    /// Kept open, so that the cable survives if one end closes its device for a while.
    _held: [File; 2],
}

impl Terminals {
    /// Creates a cable. For each read, `trouble` is the probability of each kind of fault.
    pub(crate) fn joined(seed: u64, trouble: f64) -> Terminals {
        let ((robot, robot_device), (program, program_device)) = (terminal(), terminal());
        let held = [&robot_device, &program_device].map(|device| File::open(device).expect("the device is there"));
        let copy = |end: &File| end.try_clone().expect("a descriptor is left");
        let there = (copy(&program), copy(&robot), RandomStream::new(seed, "there"));
        for (from, to, chance) in [there, (robot, program, RandomStream::new(seed, "back"))] {
            // Ends when nothing holds the device any more.
            spawn(move || carry(from, to, chance, trouble));
        }
        Terminals { robot: robot_device, program: program_device, _held: held }
    }

    /// Creates a reliable cable with this speed in each direction. The receiver gets the lines of the program as they
    /// arrive.
    pub(crate) fn slow(bytes_a_second: u32) -> (Terminals, Receiver<String>) {
        let ((robot, robot_device), (program, program_device)) = (terminal(), terminal());
        let held = [&robot_device, &program_device].map(|device| File::open(device).expect("the device is there"));
        let copy = |end: &File| end.try_clone().expect("a descriptor is left");
        let ((say, said), (nobody, _)) = (channel(), channel());
        for (from, to, say) in [(copy(&program), copy(&robot), say), (robot, program, nobody)] {
            spawn(move || carry_slowly(from, to, bytes_a_second, &say));
        }
        (Terminals { robot: robot_device, program: program_device, _held: held }, said)
    }
}

fn terminal() -> (File, String) {
    let end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("the system has pseudo-terminals");
    grantpt(&end).expect("it is ours");
    unlockpt(&end).expect("it is ours");
    let device = ptsname(&end, Vec::new()).expect("it has a name");
    (File::from(end), device.into_string().expect("the name is ASCII"))
}

fn carry(mut from: File, mut to: File, mut chance: RandomStream, trouble: f64) {
    let mut bytes = [0; 512];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        let mut piece = bytes[..count].to_vec();
        let place = usize::try_from(chance.below(count as u64)).expect("it is less than a length");
        if chance.happens(trouble) {
            piece[place] = chance.number().to_le_bytes()[0];
        }
        if chance.happens(trouble) {
            piece.remove(place);
        }
        if chance.happens(trouble) {
            piece.extend((0..chance.below(40)).map(|_| chance.number().to_le_bytes()[0]));
        }
        if to.write_all(&piece).is_err() {
            return;
        }
    }
}

fn carry_slowly(mut from: File, mut to: File, bytes_a_second: u32, say: &Sender<String>) {
    let (mut bytes, mut lines) = ([0; 16], LineReader::default());
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        sleep(Duration::from_secs(count as u64) / bytes_a_second);
        if to.write_all(&bytes[..count]).is_err() {
            return;
        }
        for text in bytes[..count].iter().filter_map(|byte| lines.take(*byte)) {
            // A test that has dropped its receiver needs no further lines.
            let _ = say.send(text);
        }
    }
}
