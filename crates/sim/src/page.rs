//! The stored form of a robot's memory: a text of fixed size. This file converts between bytes and values, and does
//! not touch files.
//!
//! ```text
//!  0     hallsweep simulated robot, version 1⏎
//!        3c1f… {"hall":"airport","fingerprint":"…"}                blanks ⏎   a checksum, then JSON
//!  2048  91a0… {"turn":41,"cell":[3,4],"heading":"east", …}        blanks ⏎   slot 0: the even turns
//!  3072  77e2… {"turn":42, …}                                      blanks ⏎   slot 1: the odd turns
//!  4096
//! ```
//! A write goes into the slot with the lower turn. If the write is interrupted, the other slot is still complete. On
//! reading, the complete slot with the higher turn is used.

use std::time::Duration;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::fingerprint::Fingerprint;
use super::hall::Hall;
use super::memory::{Astray, SimMemory, Taken, Underway};
use hallsweep_core::units::{Cell, Heading, Piece, Pose};

/// Bytes before the slots. The longest name fits, even if each letter is escaped as six bytes.
const HEAD: usize = 2048;

/// Bytes of a slot. This is several times the size of the longest memory.
const SLOT: usize = 1024;

/// Size of the whole file, in bytes. A file of any other size is damaged.
pub const SIZE: usize = HEAD + 2 * SLOT;

/// Maximum length of a stored hall name, in letters. Names in hall files are shorter.
const NAME: usize = 256;

const MAGIC: &str = "hallsweep simulated robot, version ";

const VERSION: &str = "1";

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Whose {
    /// Name of the hall, shown to people.
    pub hall: String,
    /// Fingerprint of the hall, by which the hall is recognised.
    fingerprint: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryPage {
    pub whose: Whose,
    /// Number of the write. An even number goes into slot 0, an odd number into slot 1.
    pub turn: u64,
    pub memory: SimMemory,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    Version(String),
    Damaged(String),
}

impl Whose {
    #[must_use]
    pub fn of(hall: &Hall) -> Whose {
        Whose { hall: hall.name().chars().take(NAME).collect(), fingerprint: format!("{:016x}", hall.fingerprint()) }
    }

    /// Whether both belong to the same hall. Only fingerprints are compared, because names are for people.
    pub fn is_same(&self, other: &Whose) -> bool {
        self.fingerprint == other.fingerprint
    }
}

/// The whole file for the first write. Both slots contain the same memory.
pub fn whole(whose: &Whose, turn: u64, memory: &SimMemory) -> Vec<u8> {
    let title = format!("{MAGIC}{VERSION}\n");
    let head = line(whose, HEAD - title.len());
    [title.as_bytes(), &head, &slot(turn, memory), &slot(turn, memory)].concat()
}

/// One slot with its memory. It must be written at `place(turn)`.
pub fn slot(turn: u64, memory: &SimMemory) -> Vec<u8> {
    line(&Written::of(turn, memory), SLOT)
}

/// Offset of the slot for this turn in the file, in bytes.
pub const fn place(turn: u64) -> u64 {
    if turn.is_multiple_of(2) { HEAD as u64 } else { (HEAD + SLOT) as u64 }
}

pub fn read(bytes: &[u8]) -> Result<MemoryPage, Unread> {
    let damaged = |words: &str| Unread::Damaged(words.to_owned());
    let title = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let title = std::str::from_utf8(title).map_err(|_| damaged("its first line is not text"))?;
    let version = title.strip_prefix(MAGIC).ok_or_else(|| damaged("it does not begin like the memory of a simulated robot"))?;
    if version != VERSION {
        return Err(Unread::Version(version.chars().take(20).collect()));
    }
    if bytes.len() != SIZE {
        return Err(Unread::Damaged(format!("it has {} bytes instead of {SIZE}", bytes.len())));
    }
    let head = &bytes[title.len() + 1..HEAD];
    let whose: Whose = read_line(head).ok_or_else(|| damaged("the line with the name of the hall is damaged"))?;
    let slots = [&bytes[HEAD..HEAD + SLOT], &bytes[HEAD + SLOT..]];
    let memories = slots.into_iter().filter_map(|slot| read_line::<Written>(slot)?.read());
    let (turn, memory) = memories.max_by_key(|(turn, _)| *turn).ok_or_else(|| damaged("both of its memories are damaged"))?;
    Ok(MemoryPage { whose, turn, memory })
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    turn: u64,
    cell: [i32; 2],
    heading: String,
    #[serde(default, skip_serializing_if = "is_inside")]
    outside: u8,
    #[serde(with = "WrittenAstray")]
    stands: Astray,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carried: Option<u32>,
    /// The words of `Taken::container`, each in hexadecimal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    container: Vec<String>,
    motion: Option<WrittenMotion>,
    age_us: u64,
    restarts: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Astray", deny_unknown_fields)]
struct WrittenAstray {
    ahead_um: i64,
    turned_urad: i64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenMotion {
    #[serde(with = "WrittenAstray")]
    to: Astray,
    left_us: u64,
}

impl Written {
    fn of(turn: u64, memory: &SimMemory) -> Written {
        let SimMemory { pose: Pose { cell, heading }, outside, stands, taken, motion, age, restarts } = *memory;
        let carried = taken.carried.map(|piece| piece.0);
        let container = if taken.container == Taken::NONE.container { Vec::new() } else { words_of(taken.container) };
        let motion = motion.map(|Underway { to, left }| WrittenMotion { to, left_us: micros(left) });
        let heading = heading.name().to_owned();
        let (cell, age_us) = ([cell.x, cell.y], micros(age));
        Written { turn, cell, heading, outside, stands, carried, container, motion, age_us, restarts }
    }

    fn read(self) -> Option<(u64, SimMemory)> {
        let heading = Heading::ALL.into_iter().find(|heading| heading.name() == self.heading)?;
        let [x, y] = self.cell;
        let motion = self.motion.map(|motion| Underway { to: motion.to, left: Duration::from_micros(motion.left_us) });
        let memory = SimMemory {
            pose: Pose { cell: Cell::new(x, y), heading },
            outside: self.outside,
            stands: self.stands,
            taken: Taken { carried: self.carried.map(Piece), container: container_of(&self.container)? },
            motion,
            age: Duration::from_micros(self.age_us),
            restarts: self.restarts,
        };
        Some((self.turn, memory))
    }
}

fn words_of(container: [u64; Taken::WORDS]) -> Vec<String> {
    container.iter().map(|word| format!("{word:x}")).collect()
}

/// Reads the words of the container. An empty list means an empty container.
fn container_of(words: &[String]) -> Option<[u64; Taken::WORDS]> {
    let mut container = Taken::NONE.container;
    if words.is_empty() {
        return Some(container);
    }
    for (word, text) in container.iter_mut().zip(words) {
        *word = u64::from_str_radix(text, 16).ok()?;
    }
    (words.len() == container.len()).then_some(container)
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
const fn is_inside(outside: &u8) -> bool {
    *outside == 0
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Makes a line of `size` bytes: a checksum, JSON, blanks, and a line break.
fn line(value: &impl Serialize, size: usize) -> Vec<u8> {
    let json = serde_json::to_string(value).expect("numbers, words and lists of them can always be written as JSON");
    let text = format!("{:016x} {json}", Fingerprint::of(&json));
    let mut bytes = text.into_bytes();
    bytes.resize(size - 1, b' ');
    bytes.push(b'\n');
    bytes
}

fn read_line<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let text = std::str::from_utf8(bytes.strip_suffix(b"\n")?).ok()?;
    let (checksum, json) = text.split_once(' ')?;
    let json = json.trim_end_matches(' ');
    (checksum == format!("{:016x}", Fingerprint::of(json))).then(|| serde_json::from_str(json).ok())?
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn whose() -> Whose {
        Whose::of(&Hall::from_rows("test", &["S."]).unwrap())
    }

    fn astray() -> impl Strategy<Value = Astray> {
        (any::<i64>(), any::<i64>()).prop_map(|(ahead_um, turned_urad)| Astray { ahead_um, turned_urad })
    }

    fn memory() -> impl Strategy<Value = SimMemory> {
        let micros = || any::<u64>().prop_map(Duration::from_micros);
        let motion = proptest::option::of((astray(), micros()).prop_map(|(to, left)| Underway { to, left }));
        let pose = (any::<(i32, i32)>(), 0..4usize)
            .prop_map(|((x, y), heading)| Pose { cell: Cell::new(x, y), heading: Heading::ALL[heading] });
        let taken = (proptest::option::of(any::<u32>().prop_map(Piece)), any::<[u64; Taken::WORDS]>())
            .prop_map(|(carried, container)| Taken { carried, container });
        (pose, any::<u8>(), astray(), taken, motion, micros(), any::<u32>()).prop_map(
            |(pose, outside, stands, taken, motion, age, restarts)| SimMemory {
                pose,
                outside,
                stands,
                taken,
                motion,
                age,
                restarts,
            },
        )
    }

    proptest! {
        #[test]
        fn whatever_is_written_is_read_back(memory in memory(), turn in any::<u64>(), name in any::<String>()) {
            let whose = Whose { hall: name.chars().take(NAME).collect(), ..whose() };
            let bytes = whole(&whose, turn, &memory);
            prop_assert_eq!(bytes.len(), SIZE);
            prop_assert_eq!(read(&bytes), Ok(MemoryPage { whose, turn, memory }));
        }

        /// Tests safety A7 (docs/safety.md).
        #[test]
        fn any_bytes_are_a_memory_or_a_clear_error(bytes in proptest::collection::vec(any::<u8>(), 0..2 * SIZE)) {
            prop_assert!(matches!(read(&bytes), Err(Unread::Damaged(words)) if !words.is_empty()));
            let titled = [format!("{MAGIC}{VERSION}\n").as_bytes(), &bytes].concat();
            prop_assert!(read(&titled).is_err(), "no checksum fits by luck");
        }

        /// Tests safety A7 (docs/safety.md).
        #[test]
        fn a_changed_byte_is_noticed_or_the_other_memory_counts(memory in memory(), at in 0..SIZE, byte in any::<u8>()) {
            let mut bytes = whole(&whose(), 4, &memory);
            bytes.splice(place(5) as usize.., slot(5, &SimMemory { restarts: 9, ..memory }));
            let before = std::mem::replace(&mut bytes[at], byte);
            match read(&bytes) {
                Ok(page) => prop_assert!(page.whose == whose() && (page.turn == 4 || page.turn == 5)),
                Err(_) => prop_assert!(at < HEAD && byte != before, "one slot is whole"),
            }
        }

        /// Tests safety A7 (docs/safety.md): text is also validated when its checksum is right.
        #[test]
        fn any_text_under_a_right_checksum_is_a_memory_or_a_clear_error(text in any::<String>(), number in any::<f64>()) {
            let texts = [text, format!("{{\"turn\":{number}}}"), "[".repeat(500), "null".to_owned()];
            for text in texts {
                let text: String = text.trim_end_matches(' ').chars().take(200).collect();
                let mut bytes = format!("{:016x} {text}", Fingerprint::of(&text)).into_bytes();
                bytes.resize(SLOT - 1, b' ');
                bytes.push(b'\n');
                let mut page = whole(&whose(), 4, &SimMemory::NEW);
                page.splice(HEAD.., [bytes.clone(), bytes].concat());
                prop_assert!(read(&page).is_err());
            }
        }
    }

    #[test]
    fn a_write_that_was_cut_short_leaves_the_memory_before_it() {
        let earlier = SimMemory { restarts: 1, ..SimMemory::NEW };
        let later = SimMemory { restarts: 2, ..SimMemory::NEW };
        for cut in 0..=SLOT {
            let mut bytes = whole(&whose(), 8, &earlier);
            let from = place(9) as usize;
            bytes[from..from + cut].copy_from_slice(&slot(9, &later)[..cut]);
            let read = read(&bytes).map(|page| page.memory);
            assert!(read == Ok(earlier) || read == Ok(later), "cut after {cut} bytes: {read:?}");
        }
    }

    #[test]
    fn another_version_is_told_from_a_damaged_file() {
        let text = String::from_utf8(whole(&whose(), 0, &SimMemory::NEW)).unwrap();
        assert_eq!(read(text.replace("version 1", "version 2").as_bytes()), Err(Unread::Version("2".to_owned())));
        assert_eq!(read(&text.as_bytes()[..SIZE - 1]), Err(Unread::Damaged("it has 4095 bytes instead of 4096".to_owned())));
        assert!(matches!(read(b""), Err(Unread::Damaged(words)) if words.contains("does not begin")));
    }

    #[test]
    fn a_name_of_the_most_and_widest_letters_fits() {
        let hall = Hall::from_rows(&"\u{1}".repeat(1000), &["S"]).unwrap();
        let bytes = whole(&Whose::of(&hall), u64::MAX, &SimMemory::NEW);
        assert_eq!(bytes.len(), SIZE);
        assert_eq!(read(&bytes).unwrap().whose, Whose::of(&hall));
    }
}
