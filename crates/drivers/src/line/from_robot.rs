//! The lines from the robot to the program: writes and reads their texts. `driver` decides what to do with them.

use std::fmt;
use std::time::Duration;

use super::numbers::{Seq, millis, number, signed};
use hallsweep_core::event::{Ahead, Obstacle, OffCentre, Whereabouts};
use hallsweep_core::robot::{Part, Parts};
use hallsweep_core::units::{Cell, Celsius, Heading, Piece, Pose};

#[derive(Clone, Debug, PartialEq)]
pub enum FromRobot {
    Hello(Hello),
    /// A motion is complete. The second value is what the robot sees ahead, if it has reported this.
    Done(Seq, Option<Ahead>),
    /// A motion met an obstacle. The second value is the distance to the obstacle in centimetres, if the robot has
    /// measured this distance.
    Blocked(Seq, Option<u16>, Obstacle),
    /// A motion was cut short by a halt, or was halted before it began.
    Halted(Seq, OffCentre),
    Failed(Seq, Words),
    NoPhoto(Seq, Words),
    /// A photo: its length in bytes and its CRC-32. The bytes follow at once.
    Photo(Seq, u32, u32),
    /// Distance to the next obstacle ahead, in centimetres. `None` if nothing is in range.
    Sonar(Option<u16>),
    Temperature(Celsius),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    pub name: RobotName,
    pub parts: Parts,
    pub step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    /// Duration of a photo, including the sending of its bytes.
    pub photo: Duration,
    /// Where the robot itself believes that it stands.
    pub stands: Whereabouts,
    /// The greatest number of an order that has begun or was voided. `None` if the robot has received no `from` since
    /// it was switched on.
    pub last: Option<Seq>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotName(String);

impl RobotName {
    /// Maximum length of a name, in bytes. A longer name does not fit into a line.
    pub const MOST: usize = 24;

    #[must_use]
    pub fn new(text: &str) -> Option<RobotName> {
        let is_sound = text.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'*');
        (is_sound && (1..=RobotName::MOST).contains(&text.len())).then(|| RobotName(text.to_owned()))
    }
}

impl fmt::Display for RobotName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A reason in words, cut so that it fits into a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words(String);

impl Words {
    const MOST: usize = 100;

    #[must_use]
    pub fn new(text: &str) -> Words {
        let carried = |letter: char| if (' '..='~').contains(&letter) && letter != '*' { letter } else { '?' };
        Words(text.chars().map(carried).take(Words::MOST).collect())
    }
}

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromRobot {
    #[must_use]
    pub fn parse(text: &str) -> Option<FromRobot> {
        let (word, rest) = text.split_once(' ')?;
        let words: Vec<&str> = rest.split(' ').collect();
        let seq = || Seq::read(words[0]);
        match (word, &words[..]) {
            ("hello", _) => hello(&words).map(FromRobot::Hello),
            ("done", [_]) => Some(FromRobot::Done(seq()?, None)),
            ("done", [_, "ahead", free]) => Some(FromRobot::Done(seq()?, Some(Ahead { free: number(free)?, obstacle: None }))),
            ("done", [_, "ahead", free, what @ ..]) => {
                Some(FromRobot::Done(seq()?, Some(Ahead { free: number(free)?, obstacle: Some(obstacle(what)?) })))
            }
            ("blocked", [_, cm, what @ ..]) => Some(FromRobot::Blocked(seq()?, centimetres(cm)?, obstacle(what)?)),
            ("halted", [_, off]) => Some(FromRobot::Halted(seq()?, off_centre(off)?)),
            ("failed", [_, why @ ..]) => Some(FromRobot::Failed(seq()?, Words::new(&why.join(" ")))),
            ("nophoto", [_, why @ ..]) => Some(FromRobot::NoPhoto(seq()?, Words::new(&why.join(" ")))),
            ("photo", [_, length, crc]) => {
                let crc = Some(*crc).filter(|crc| crc.len() == 8 && crc.bytes().all(|byte| byte.is_ascii_hexdigit()))?;
                Some(FromRobot::Photo(seq()?, number(length)?, u32::from_str_radix(crc, 16).ok()?))
            }
            ("sonar", [cm]) => centimetres(cm).map(FromRobot::Sonar),
            ("temp", [degrees]) => temperature(degrees).map(FromRobot::Temperature),
            _ => None,
        }
    }
}

impl fmt::Display for FromRobot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FromRobot::Hello(hello) => hello.fmt(f),
            FromRobot::Done(seq, None) => write!(f, "done {seq}"),
            FromRobot::Done(seq, Some(Ahead { free, obstacle: None })) => write!(f, "done {seq} ahead {free}"),
            FromRobot::Done(seq, Some(Ahead { free, obstacle: Some(what) })) => {
                write!(f, "done {seq} ahead {free} {}", ObstacleWords(*what))
            }
            FromRobot::Blocked(seq, None, what) => write!(f, "blocked {seq} none {}", ObstacleWords(*what)),
            FromRobot::Blocked(seq, Some(cm), what) => write!(f, "blocked {seq} {cm} {}", ObstacleWords(*what)),
            FromRobot::Halted(seq, off) => write!(f, "halted {seq} {}", word(*off)),
            FromRobot::Failed(seq, why) => write!(f, "failed {seq} {why}"),
            FromRobot::NoPhoto(seq, why) => write!(f, "nophoto {seq} {why}"),
            FromRobot::Photo(seq, length, crc) => write!(f, "photo {seq} {length} {crc:08X}"),
            FromRobot::Sonar(None) => f.write_str("sonar none"),
            FromRobot::Sonar(Some(cm)) => write!(f, "sonar {cm}"),
            FromRobot::Temperature(celsius) => write!(f, "temp {:.1}", celsius.degrees()),
        }
    }
}

impl fmt::Display for Hello {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "hello {}", self.name)?;
        self.parts.iter().filter(|part| PARTS.contains(part)).try_for_each(|part| write!(f, " {}", part.name()))?;
        let [step, turn, photo] = [self.step, self.turn, self.photo].map(|time| millis(time).min(SLOWEST_MS));
        let Whereabouts { pose: Pose { cell, heading }, off_centre } = self.stands;
        write!(f, " step={step} turn={turn} photo={photo} at={},{},{} {}", cell.x, cell.y, heading.name(), word(off_centre))?;
        write!(f, " last={}", self.last.map_or(0, Seq::number))
    }
}

const PARTS: [Part; 6] = [Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Thermometer, Part::Bump];

/// Longest duration of a step, turn or photo, in milliseconds.
const SLOWEST_MS: u32 = 999_999;

fn hello(words: &[&str]) -> Option<Hello> {
    let (name, words) = words.split_first()?;
    let [words @ .., step, turn, photo, at, off, last] = words else { return None };
    let parts = words.iter().map(|word| PARTS.into_iter().find(|part| part.name() == *word)).collect::<Option<Vec<Part>>>()?;
    let time = |text: &str, name| {
        let ms: u32 = number(text.strip_prefix(name)?)?;
        (ms <= SLOWEST_MS).then(|| Duration::from_millis(ms.into()))
    };
    Some(Hello {
        name: RobotName::new(name)?,
        parts: Parts::of(&parts),
        step: time(step, "step=")?,
        turn: time(turn, "turn=")?,
        photo: time(photo, "photo=")?,
        stands: Whereabouts { pose: pose(at.strip_prefix("at=")?)?, off_centre: off_centre(off)? },
        last: match last.strip_prefix("last=")? {
            "0" => None,
            last => Some(Seq::read(last)?),
        },
    })
}

fn pose(text: &str) -> Option<Pose> {
    let [x, y, heading] = text.split(',').collect::<Vec<&str>>()[..] else { return None };
    let heading = Heading::ALL.into_iter().find(|known| known.name() == heading)?;
    Some(Pose { cell: Cell::new(signed(x)?, signed(y)?), heading })
}

const fn word(off_centre: OffCentre) -> &'static str {
    if off_centre { "off" } else { "centred" }
}

fn off_centre(text: &str) -> Option<OffCentre> {
    match text {
        "centred" => Some(false),
        "off" => Some(true),
        _ => None,
    }
}

fn centimetres(text: &str) -> Option<Option<u16>> {
    if text == "none" { Some(None) } else { number(text).map(Some) }
}

/// Reads a temperature, to a tenth of a degree. Only digits, a point and a minus sign are accepted, although the
/// standard library can read other forms.
fn temperature(text: &str) -> Option<Celsius> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || b"-.".contains(&byte));
    let degrees: f64 = is_plain.then(|| text.parse().ok()).flatten()?;
    Celsius::new((degrees * 10.0).round() / 10.0)
}

struct ObstacleWords(Obstacle);

impl fmt::Display for ObstacleWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Obstacle::Wall { left: 0, right: 0 } => f.write_str("wall"),
            Obstacle::Wall { left, right } => write!(f, "wall {left} {right}"),
            Obstacle::Luggage(Piece(piece)) => write!(f, "luggage {piece}"),
            Obstacle::Unknown => f.write_str("unknown"),
        }
    }
}

fn obstacle(words: &[&str]) -> Option<Obstacle> {
    match words {
        ["wall"] => Some(Obstacle::Wall { left: 0, right: 0 }),
        ["wall", left, right] => Some(Obstacle::Wall { left: number(left)?, right: number(right)? }),
        ["luggage", piece] => Some(Obstacle::Luggage(Piece(number(piece)?))),
        // The program could not recognise this piece again later, so it counts as an unknown obstacle.
        ["luggage" | "unknown"] => Some(Obstacle::Unknown),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
