//! `hallsweep robot-emulator`: a simulated robot that speaks the line protocol, for people who try this protocol or
//! build a robot. `robots::emulator` plays the robot; this file reads the flags.

use std::time::Duration;

use clap::Args;

use super::{Failure, sources};
use crate::app;
use crate::config::Flag;
use crate::robots::emulator::{Emulation, End, Faults, MOST_BYTES, RobotName};
use crate::telemetry;

/// The flags of `robot-emulator`. Where a flag is missing, the settings of the hall and the robot apply.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Then run in another terminal: hallsweep serve --robot line=ADDRESS:PORT, or line=DEVICE. \
                  docs/robot-line-protocol.md describes the protocol.")]
pub struct RobotEmulator {
    #[command(flatten)]
    at: At,
    /// Speed of the serial device, in bits per second.
    #[arg(long, value_name = "BAUD", default_value = "115200", conflicts_with = "listen", value_parser = baud, allow_hyphen_values = true)]
    baud: u32,
    /// Name that the robot reports.
    #[arg(long, value_name = "NAME", default_value = "emulator", value_parser = robot_name)]
    name: RobotName,
    /// Name of a built-in hall, or a hall file.
    #[arg(long, value_name = "HALL")]
    hall: Option<String>,
    /// Speed of the robot: 1 is normal, 10 is ten times faster, "max" is without waiting.
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Seed of all random numbers, including those of the connection faults.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    seed: Option<String>,
    /// How the robot checks that a cell is free: bump (drive into the cell) or sonar.
    #[arg(long, value_name = "NAME")]
    sensing: Option<String>,
    /// Minimum size of a photo, in bytes.
    #[arg(long, value_name = "BYTES", default_value = "0", value_parser = photo_bytes, allow_hyphen_values = true)]
    photo_bytes: usize,
    /// Probability, from 0 to 1, that a line, or 16 kB of a photo, loses a byte; in both directions.
    #[arg(long, value_name = "RATE", default_value = "0", value_parser = rate, allow_hyphen_values = true)]
    lose: f64,
    /// Probability, from 0 to 1, that a byte of a line, or of 16 kB of a photo, is changed; in both directions.
    #[arg(long, value_name = "RATE", default_value = "0", value_parser = rate, allow_hyphen_values = true)]
    garble: f64,
    /// Delay of the connection, in milliseconds.
    #[arg(long, value_name = "MS", default_value = "0", value_parser = delay, allow_hyphen_values = true)]
    delay: Duration,
    /// Cut every connection after this number of seconds.
    #[arg(long, value_name = "SECONDS", value_parser = cut_after, allow_hyphen_values = true)]
    cut_after: Option<Duration>,
}

/// Where programs reach the robot.
#[derive(Args, Clone, Debug)]
#[group(required = true, multiple = false)]
struct At {
    /// Address at which programs connect to the robot, over TCP; port 0 chooses a free port.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<String>,
    /// Serial device that connects the robot with the program.
    #[arg(long, value_name = "DEVICE")]
    serial: Option<String>,
}

/// Plays the robot until SIGINT, SIGTERM or SIGHUP.
pub fn run(flags: &RobotEmulator) -> Result<(), Failure> {
    telemetry::queue_lines();
    let settings = super::settings(&sources(None, flags.settings()))?;
    app::emulate(&settings, flags.emulation()?, |place| {
        super::announce(format!("The robot {} is at {place}: {}", flags.name, flags.hint(place)));
    })?;
    Ok(())
}

impl RobotEmulator {
    fn settings(&self) -> Vec<Flag> {
        let given =
            [("--hall", &self.hall), ("--speed", &self.speed), ("--seed", &self.seed), ("--sensing", &self.sensing)].into_iter();
        given.filter_map(|(flag, value)| Some(Flag::given(flag, value.clone()?))).collect()
    }

    fn hint(&self, place: &str) -> String {
        if self.at.serial.is_some() {
            return "hallsweep serve --robot line=DEVICE, with the device at the other end of the cable".to_owned();
        }
        // An address that means every interface is replaced by an address to which clients can connect.
        let here = place.replace("0.0.0.0:", "localhost:").replace("[::]:", "localhost:");
        format!("hallsweep serve --robot line={here}")
    }

    fn emulation(&self) -> Result<Emulation, Failure> {
        let end = match (&self.at.listen, &self.at.serial) {
            (Some(listen), None) => End::Port(listen.clone()),
            (None, Some(device)) => End::Device(device.clone(), self.baud),
            (Some(_), Some(_)) | (None, None) => {
                return Err(Failure::Usage("say where the robot is: --listen ADDRESS:PORT or --serial DEVICE".to_owned()));
            }
        };
        let faults = Faults { lose: self.lose, garble: self.garble, delay: self.delay, cut_after: self.cut_after };
        Ok(Emulation { name: self.name.clone(), end, photo_bytes: self.photo_bytes, faults })
    }
}

fn robot_name(text: &str) -> Result<RobotName, String> {
    let most = RobotName::MOST;
    RobotName::new(text).ok_or_else(|| format!("write 1 to {most} ASCII letters, digits or signs, with no blank and no star"))
}

fn baud(text: &str) -> Result<u32, String> {
    let baud = text.parse().ok().filter(|baud| (300..=4_000_000).contains(baud));
    baud.ok_or_else(|| "write a whole number from 300 to 4000000, the same as at the other end, often 115200".to_owned())
}

fn photo_bytes(text: &str) -> Result<usize, String> {
    let most = MOST_BYTES as usize;
    let bytes = text.parse().ok().filter(|bytes| *bytes <= most);
    bytes.ok_or_else(|| format!("write a whole number from 0 to {most}, the size of the largest accepted photo"))
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.0..=1.0).contains(rate));
    rate.ok_or_else(|| "write a rate from 0 (never) to 1 (always)".to_owned())
}

fn delay(text: &str) -> Result<Duration, String> {
    let ms = text.parse().ok().filter(|ms| *ms <= 10_000);
    ms.map(Duration::from_millis).ok_or_else(|| "write whole milliseconds from 0 to 10000".to_owned())
}

fn cut_after(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.1..=86_400.0).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "write seconds from 0.1 to 86400".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Typed {
        #[command(flatten)]
        flags: RobotEmulator,
    }

    fn typed(flags: &str) -> Result<RobotEmulator, String> {
        let words = ["robot-emulator"].into_iter().chain(flags.split_whitespace());
        Typed::try_parse_from(words).map(|typed| typed.flags).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_typed_is_what_is_played() {
        let flags = typed(
            "--serial /dev/ttyUSB0 --baud 9600 --name ada --lose 0.1 --garble 0.2 --delay 30 --cut-after 2 --photo-bytes 9",
        );
        let played = flags.and_then(|flags| flags.emulation().map_err(|failure| failure.to_string())).unwrap();
        assert!(matches!(&played.end, End::Device(device, 9600) if device == "/dev/ttyUSB0"));
        let expect = Faults { lose: 0.1, garble: 0.2, delay: Duration::from_millis(30), cut_after: Some(Duration::from_secs(2)) };
        assert_eq!((played.name.to_string().as_str(), played.photo_bytes, played.faults), ("ada", 9, expect));
    }

    #[test]
    fn every_flag_of_the_robot_is_a_setting() {
        let flags = typed("--listen a --hall h --speed 1 --seed 2 --sensing sonar").unwrap().settings();
        assert_eq!(flags.iter().map(|flag| flag.flag).collect::<Vec<_>>(), ["--hall", "--speed", "--seed", "--sensing"]);
    }

    #[test]
    fn what_cannot_be_played_is_refused_in_words() {
        for (flags, words) in [
            ("", "--listen <ADDRESS:PORT>|--serial <DEVICE>"),
            ("--listen a --serial b", "cannot be used with"),
            ("--listen a --baud 9600", "cannot be used with"),
            ("--serial a --baud 1", "from 300 to 4000000"),
            ("--listen a --name two*", "with no blank and no star"),
            ("--listen a --lose 2", "from 0 (never) to 1 (always)"),
            ("--listen a --garble -1", "from 0 (never) to 1 (always)"),
            ("--listen a --delay -1", "whole milliseconds from 0"),
            ("--listen a --delay 1h", "whole milliseconds"),
            ("--listen a --cut-after 0", "seconds from 0.1"),
            ("--listen a --photo-bytes 5000000", "from 0 to 4194304"),
        ] {
            let said = typed(flags).unwrap_err();
            assert!(said.contains(words), "{flags}: {said}");
        }
    }
}
