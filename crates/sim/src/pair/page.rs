//! The stored form of a pair's memory: a title, its hall, and one line of JSON with a checksum. This file converts
//! between bytes and values, and does not touch files. The stored file is replaced as a whole, so it may grow when
//! more pieces are in the container.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::super::fingerprint::Fingerprint;
use super::super::page::{Unread, Whose};
use super::memory::{AstrayMemory, GripMemory, PairMemory, RobotMemory};
use super::settings::Slip;
use hallsweep_core::arm::{Controllers, Gripper, Parcel};
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::units::{Cell, Heading, Piece};

const MAGIC: &str = "hallsweep simulated pair, version ";

const VERSION: &str = "1";

/// Largest file, in bytes. It is more than enough even if all pieces of the fullest hall are in the container.
pub const MOST: usize = 8 << 20;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    whose: Whose,
    robots: [WrittenRobot; 2],
    grip: Option<WrittenGrip>,
    lying: Vec<(u32, WrittenPlace)>,
    taken_in: Vec<u32>,
    closed: Vec<[i32; 2]>,
    slips: Option<Vec<[u32; 2]>>,
    unrecognised: Option<Vec<u32>>,
    restarts: u32,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
enum WrittenPlace {
    Cell(i32, i32),
    Outside(u8),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenRobot {
    place: WrittenPlace,
    heading: String,
    astray: WrittenAstray,
    motion: Option<(WrittenAstray, u64)>,
    is_closed: bool,
    aligned: Option<WrittenPlace>,
    /// Whether the controllers of force, angle and distance are on, in this order.
    controllers: [bool; 3],
}

#[derive(Serialize, Deserialize)]
enum WrittenAstray {
    Not,
    Along(WrittenPlace, i64),
    Turned(i64),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenGrip {
    piece: u32,
    place: WrittenPlace,
    height: i64,
    steps: u32,
    force: [i64; 2],
    angle: [i64; 2],
    gap: [i64; 2],
    faster: i64,
    tilts: i64,
    beyond: u32,
}

#[must_use]
pub fn written(whose: &Whose, memory: &PairMemory) -> Vec<u8> {
    let json =
        serde_json::to_string(&Written::of(whose, memory)).expect("numbers, words and lists of them can always be written");
    format!("{MAGIC}{VERSION}\n{:016x} {json}\n", Fingerprint::of(&json)).into_bytes()
}

/// Reads the hall and the memory of a pair.
///
/// # Errors
/// When the bytes are not the memory of a pair. The error contains the reason.
pub fn read(bytes: &[u8]) -> Result<(Whose, PairMemory), Unread> {
    let damaged = |words: &str| Unread::Damaged(words.to_owned());
    let text = std::str::from_utf8(bytes).map_err(|_| damaged("it is not text"))?;
    let (title, rest) = text.split_once('\n').ok_or_else(|| damaged("it has no first line"))?;
    let version = title.strip_prefix(MAGIC).ok_or_else(|| damaged("it does not begin like the memory of a simulated pair"))?;
    if version != VERSION {
        return Err(Unread::Version(version.chars().take(20).collect()));
    }
    let (checksum, json) = rest.trim_end_matches('\n').split_once(' ').ok_or_else(|| damaged("its memory is damaged"))?;
    if checksum != format!("{:016x}", Fingerprint::of(json)) {
        return Err(damaged("its memory is damaged"));
    }
    let written: Written =
        serde_json::from_str(json).map_err(|error| Unread::Damaged(format!("its memory has an invalid value: {error}")))?;
    written.read().ok_or_else(|| damaged("it has an unknown heading"))
}

impl Written {
    fn of(whose: &Whose, memory: &PairMemory) -> Written {
        Written {
            whose: whose.clone(),
            robots: memory.robots.map(WrittenRobot::of),
            grip: memory.grip.map(WrittenGrip::of),
            lying: memory.lying.iter().map(|(piece, place)| (piece.0, (*place).into())).collect(),
            taken_in: memory.taken_in.iter().map(|piece| piece.0).collect(),
            closed: memory.closed.iter().map(|cell| [cell.x, cell.y]).collect(),
            slips: memory.slips.as_ref().map(|slips| slips.iter().map(|slip| [slip.parcel, slip.after_steps]).collect()),
            unrecognised: memory.unrecognised.clone(),
            restarts: memory.restarts,
        }
    }

    fn read(self) -> Option<(Whose, PairMemory)> {
        let [one, two] = self.robots.map(WrittenRobot::read);
        let slip = |[parcel, after_steps]: [u32; 2]| Slip { parcel, after_steps };
        let memory = PairMemory {
            robots: [one?, two?],
            grip: self.grip.map(WrittenGrip::read),
            lying: self.lying.into_iter().map(|(piece, place)| (Piece(piece), place.into())).collect(),
            taken_in: self.taken_in.into_iter().map(Piece).collect(),
            closed: self.closed.into_iter().map(|[x, y]| Cell::new(x, y)).collect(),
            slips: self.slips.map(|slips| slips.into_iter().map(slip).collect()),
            unrecognised: self.unrecognised,
            restarts: self.restarts,
        };
        Some((self.whose, memory))
    }
}

impl WrittenRobot {
    fn of(robot: RobotMemory) -> WrittenRobot {
        let micros = |left: Duration| u64::try_from(left.as_micros()).unwrap_or(u64::MAX);
        let Controllers { force, angle, distance } = robot.controllers;
        WrittenRobot {
            place: robot.stands.place.into(),
            heading: robot.stands.heading.name().to_owned(),
            astray: robot.astray.into(),
            motion: robot.motion.map(|(to, left)| (to.into(), micros(left))),
            is_closed: robot.gripper == Gripper::Closed,
            aligned: robot.aligned.map(WrittenPlace::from),
            controllers: [force, angle, distance],
        }
    }

    fn read(self) -> Option<RobotMemory> {
        let heading = Heading::ALL.into_iter().find(|heading| heading.name() == self.heading)?;
        let [force, angle, distance] = self.controllers;
        Some(RobotMemory {
            stands: BasePose { place: self.place.into(), heading },
            astray: self.astray.into(),
            motion: self.motion.map(|(to, left_us)| (to.into(), Duration::from_micros(left_us))),
            gripper: if self.is_closed { Gripper::Closed } else { Gripper::Open },
            aligned: self.aligned.map(Place::from),
            controllers: Controllers { force, angle, distance },
        })
    }
}

impl WrittenGrip {
    fn of(grip: GripMemory) -> WrittenGrip {
        let GripMemory { parcel, height, steps, force, angle, gap, faster, tilts, beyond } = grip;
        let (piece, place) = (parcel.piece.0, parcel.place.into());
        WrittenGrip { piece, place, height, steps, force, angle, gap, faster, tilts, beyond }
    }

    fn read(self) -> GripMemory {
        let WrittenGrip { piece, place, height, steps, force, angle, gap, faster, tilts, beyond } = self;
        let parcel = Parcel { piece: Piece(piece), place: place.into() };
        GripMemory { parcel, height, steps, force, angle, gap, faster, tilts, beyond }
    }
}

impl From<Place> for WrittenPlace {
    fn from(place: Place) -> WrittenPlace {
        match place {
            Place::Cell(cell) => WrittenPlace::Cell(cell.x, cell.y),
            Place::Outside(steps) => WrittenPlace::Outside(steps),
        }
    }
}

impl From<WrittenPlace> for Place {
    fn from(place: WrittenPlace) -> Place {
        match place {
            WrittenPlace::Cell(x, y) => Place::Cell(Cell::new(x, y)),
            WrittenPlace::Outside(steps) => Place::Outside(steps),
        }
    }
}

impl From<AstrayMemory> for WrittenAstray {
    fn from(astray: AstrayMemory) -> WrittenAstray {
        match astray {
            AstrayMemory::Not => WrittenAstray::Not,
            AstrayMemory::Along(place, millionths) => WrittenAstray::Along(place.into(), millionths),
            AstrayMemory::Turned(microradians) => WrittenAstray::Turned(microradians),
        }
    }
}

impl From<WrittenAstray> for AstrayMemory {
    fn from(astray: WrittenAstray) -> AstrayMemory {
        match astray {
            WrittenAstray::Not => AstrayMemory::Not,
            WrittenAstray::Along(place, millionths) => AstrayMemory::Along(place.into(), millionths),
            WrittenAstray::Turned(microradians) => AstrayMemory::Turned(microradians),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Hall;

    fn whose() -> Whose {
        Whose::of(&Hall::from_rows("test", &["S."]).unwrap())
    }

    fn place() -> impl Strategy<Value = Place> {
        prop_oneof![any::<(i32, i32)>().prop_map(|(x, y)| Place::Cell(Cell::new(x, y))), any::<u8>().prop_map(Place::Outside),]
    }

    fn astray() -> impl Strategy<Value = AstrayMemory> {
        prop_oneof![
            Just(AstrayMemory::Not),
            (place(), any::<i64>()).prop_map(|(place, way)| AstrayMemory::Along(place, way)),
            any::<i64>().prop_map(AstrayMemory::Turned),
        ]
    }

    fn robot() -> impl Strategy<Value = RobotMemory> {
        let motion = proptest::option::of((astray(), any::<u64>().prop_map(Duration::from_micros)));
        let arm = (any::<bool>(), proptest::option::of(place()), any::<[bool; 3]>());
        (place(), 0..4usize, astray(), motion, arm).prop_map(|(place, heading, astray, motion, arm)| {
            let (is_closed, aligned, [force, angle, distance]) = arm;
            RobotMemory {
                stands: BasePose { place, heading: Heading::ALL[heading] },
                astray,
                motion,
                gripper: if is_closed { Gripper::Closed } else { Gripper::Open },
                aligned,
                controllers: Controllers { force, angle, distance },
            }
        })
    }

    fn grip() -> impl Strategy<Value = GripMemory> {
        let held = any::<[[i64; 2]; 3]>();
        (any::<u32>(), place(), any::<[i64; 3]>(), any::<[u32; 2]>(), held).prop_map(|(piece, place, one, two, held)| {
            let ([height, faster, tilts], [steps, beyond], [force, angle, gap]) = (one, two, held);
            let parcel = Parcel { piece: Piece(piece), place };
            GripMemory { parcel, height, steps, force, angle, gap, faster, tilts, beyond }
        })
    }

    fn memory() -> impl Strategy<Value = PairMemory> {
        let numbers = || proptest::collection::vec(any::<u32>(), 0..4);
        let lying = proptest::collection::vec((any::<u32>().prop_map(Piece), place()), 0..4);
        let closed = proptest::collection::vec(any::<(i32, i32)>().prop_map(|(x, y)| Cell::new(x, y)), 0..4);
        let slips = numbers().prop_map(|all| all.into_iter().map(|n| Slip { parcel: n, after_steps: n / 3 }).collect::<Vec<_>>());
        let coming = (proptest::option::of(slips), proptest::option::of(numbers()), any::<u32>());
        (robot(), robot(), proptest::option::of(grip()), lying, numbers(), closed, coming).prop_map(
            |(one, two, grip, lying, taken_in, closed, (slips, unrecognised, restarts))| PairMemory {
                robots: [one, two],
                grip,
                lying,
                taken_in: taken_in.into_iter().map(Piece).collect(),
                closed,
                slips,
                unrecognised,
                restarts,
            },
        )
    }

    proptest! {
        #[test]
        fn whatever_is_written_is_read_back(memory in memory()) {
            prop_assert_eq!(read(&super::written(&whose(), &memory)), Ok((whose(), memory)));
        }

        /// Tests safety A7 (docs/safety.md).
        #[test]
        fn any_bytes_are_a_memory_or_a_clear_error(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
            prop_assert!(matches!(read(&bytes), Err(Unread::Damaged(words)) if !words.is_empty()));
            let titled = [format!("{MAGIC}{VERSION}\n").as_bytes(), &bytes].concat();
            prop_assert!(read(&titled).is_err(), "no checksum fits by luck");
        }

        /// Tests safety A7 (docs/safety.md).
        #[test]
        fn a_changed_byte_is_noticed(memory in memory(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
            let mut bytes = super::written(&whose(), &memory);
            let at = at.index(bytes.len() - 1);
            prop_assume!(bytes[at] != byte);
            bytes[at] = byte;
            prop_assert!(read(&bytes).is_err());
        }
    }
}
