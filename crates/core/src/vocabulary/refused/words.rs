//! A refusal from its words: the journal keeps the code and the sentence, and whoever says it in another language needs what was refused.
//! Arguments are found by how they are written, and what is read counts only if it is written with exactly these words.

use std::sync::Arc;

use crate::command::{CommandId, Verdict};
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::refused::{OTHER_CONTENT, Refusal, Refused};
use crate::robot::RobotId;
use crate::units::{AlarmId, Cell, Epoch, LuggageId};

/// What stands before the holds.
const HELD: &str = "not possible while held: ";

/// What stands before the store's own words.
const STORE: &str = "nothing can be recorded: ";

/// Between two holds.
const AND: &str = "; ";

impl Refusal {
    /// What was refused with these words; `None` when this version refuses nothing so, as what a door did not take. The words of a door
    /// about what its sender may not are given back as they are.
    #[must_use]
    pub fn refused(&self) -> Option<Refused> {
        let words = &*self.words;
        let refused = if self.code == "held" { held(words)? } else { read(self.code, words)? };
        (Refusal::from(&refused) == *self).then_some(refused)
    }
}

fn read(code: &str, words: &str) -> Option<Refused> {
    let piece = || number(words.split_once('#')?.1).map(LuggageId);
    let robot = || RobotId::new(words.split(' ').next()?);
    Some(match code {
        "outdated" => {
            let (sent, now) = words.split_once(" epoch ")?.1.split_once(" to ")?;
            Refused::Outdated { sent: Epoch(number(sent)?), now: Epoch(number(now)?) }
        }
        "sentBefore" => Refused::SentBefore,
        "notInPhase" => PhaseName::ALL.into_iter().map(Refused::NotInPhase).find(|refused| refused.to_string() == words)?,
        "verdictPending" => Refused::VerdictPending(piece()?),
        "driving" => Refused::Driving,
        "notStopped" => Refused::NotStopped,
        "intoObstacle" => Refused::IntoObstacle(Cell::from_words(words.get(words.find('(')?..)?)?),
        "notCapable" => Refused::NotCapable,
        "moving" => Refused::Moving,
        "unrecorded" => Refused::Unrecorded,
        "bombUnfetched" => Refused::BombUnfetched(piece()?),
        "unknownLuggage" => Refused::UnknownLuggage(piece()?),
        "nothingPending" => Refused::NothingPending,
        "decided" => {
            let luggage = piece()?;
            let decided = [Verdict::Safe, Verdict::Danger].map(|verdict| Refused::Decided { luggage, verdict });
            decided.into_iter().find(|refused| refused.to_string() == words)?
        }
        "noPhoto" => Refused::NoPhoto(piece()?),
        "notInspected" => Refused::NotInspected(piece()?),
        "photoUnderWay" => Refused::PhotoUnderWay,
        "unknownAlarm" => Refused::UnknownAlarm(AlarmId(number(words.rsplit_once(' ')?.1)?)),
        "noRetrievalRobot" => Refused::NoRetrievalRobot,
        "fetcherUnreached" => Refused::FetcherUnreached(robot()?),
        "fetcherAbroad" => Refused::FetcherAbroad(robot()?),
        "faultStands" => Refused::FaultStands(FaultCause::from_words(words.split_once(": ")?.1)?),
        "storeDown" => Refused::StoreDown,
        "notKept" => Refused::NotKept,
        "notOnRecord" => Refused::NotOnRecord,
        OTHER_CONTENT => Refused::OtherContent(CommandId::new(words.split(' ').nth(2)?)?),
        "unknownSensor" => Refused::UnknownSensor(unquoted(words)?),
        "notAllowed" => Refused::NotAllowed(words.to_owned()),
        _ => return None,
    })
}

/// The number with which words begin.
fn number(words: &str) -> Option<u64> {
    words.split(|letter: char| !letter.is_ascii_digit()).next()?.parse().ok()
}

/// The holds in their order. As many of the last words as can be are taken for holds, and the rest for those of the store.
fn held(words: &str) -> Option<Refused> {
    let mut rest = words.strip_prefix(HELD)?;
    let mut holds = Vec::new();
    while let Some((hold, before)) = Hold::ALL.into_iter().find_map(|hold| Some((hold, last(rest, hold)?))) {
        holds.insert(0, hold);
        let Some(before) = before else { return Some(Refused::Held(holds, None)) };
        rest = before;
    }
    let store_failure = rest.strip_prefix(STORE)?.to_owned();
    // Its words stand first, whatever its place among the holds is.
    let place = holds.iter().position(|hold| *hold > Hold::Store).unwrap_or(holds.len());
    holds.insert(place, Hold::Store);
    Some(Refused::Held(holds, Some(store_failure)))
}

/// What stands before this hold, where words end with it.
fn last(words: &str, hold: Hold) -> Option<Option<&str>> {
    let before = words.strip_suffix(hold.in_words())?;
    if before.is_empty() { Some(None) } else { before.strip_suffix(AND).map(Some) }
}

/// The text between the first and the last quotation mark, which is written as a literal.
fn unquoted(words: &str) -> Option<Arc<str>> {
    let mut letters = words.get(words.find('"')? + 1..words.rfind('"')?)?.chars();
    let mut text = String::new();
    while let Some(letter) = letters.next() {
        text.push(if letter == '\\' { escaped(&mut letters)? } else { letter });
    }
    Some(Arc::from(text))
}

/// The letter that an escape stands for, behind its backslash.
fn escaped(letters: &mut std::str::Chars<'_>) -> Option<char> {
    Some(match letters.next()? {
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        '0' => '\0',
        'u' => {
            let code: String = letters.by_ref().take_while(|letter| *letter != '}').skip(1).collect();
            char::from_u32(u32::from_str_radix(&code, 16).ok()?)?
        }
        letter => letter,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::TemperatureReport;
    use crate::refused::{CODES, RefusalKind};
    use crate::rng::RandomStream;
    use crate::words::{coordinate, hostile, number};

    /// One of each kind.
    fn all(dice: &mut RandomStream) -> Vec<Refused> {
        let piece = LuggageId(number(dice));
        let (sent, now) = (Epoch(number(dice)), Epoch(number(dice)));
        let verdict = if dice.happens(0.5) { Verdict::Safe } else { Verdict::Danger };
        let robot = RobotId::new(["discovery", "srm1", "a-robot-7"][dice.below(3) as usize]).unwrap();
        let id = CommandId::new(["k7", "was", "\"'#:\\", "used-before,"][dice.below(4) as usize]).unwrap();
        vec![
            Refused::Outdated { sent, now },
            Refused::SentBefore,
            Refused::NotInPhase(PhaseName::ALL[dice.below(PhaseName::ALL.len() as u64) as usize]),
            Refused::VerdictPending(piece),
            Refused::Driving,
            Refused::NotStopped,
            Refused::IntoObstacle(Cell::new(coordinate(dice), coordinate(dice))),
            Refused::NotCapable,
            Refused::Moving,
            Refused::Unrecorded,
            Refused::BombUnfetched(piece),
            Refused::UnknownLuggage(piece),
            Refused::NothingPending,
            Refused::Decided { luggage: piece, verdict },
            Refused::NoPhoto(piece),
            Refused::NotInspected(piece),
            Refused::PhotoUnderWay,
            Refused::UnknownAlarm(AlarmId(number(dice))),
            Refused::NoRetrievalRobot,
            Refused::FetcherUnreached(robot.clone()),
            Refused::FetcherAbroad(robot),
            Refused::FaultStands(FaultCause::Robot(hostile(dice))),
            Refused::StoreDown,
            Refused::NotKept,
            Refused::NotOnRecord,
            Refused::OtherContent(id),
            Refused::UnknownSensor(Arc::from(hostile(dice))),
            Refused::NotAllowed(hostile(dice)),
        ]
    }

    fn holds(dice: &mut RandomStream) -> Vec<Hold> {
        Hold::ALL.into_iter().filter(|_| dice.happens(0.4)).collect()
    }

    #[test]
    fn every_refusal_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "refusals");
        for _ in 0..2000 {
            for refused in all(&mut dice) {
                assert_eq!(Refusal::from(&refused).refused(), Some(refused));
            }
        }
    }

    #[test]
    fn a_fault_that_stands_is_told_in_its_own_words() {
        let words = "the fault still stands: no known way leads home: clear the way, or fetch the robot";
        assert_eq!(Refused::FaultStands(FaultCause::NoWayHome).to_string(), words);
    }

    #[test]
    fn of_the_codes_none_but_that_of_holds_is_left_out_above() {
        let mut dice = RandomStream::new(1, "codes");
        let all: Vec<&str> = all(&mut dice).iter().map(Refused::code).collect();
        assert!(CODES.into_iter().all(|(code, _)| code == "held" || all.contains(&code)));
    }

    #[test]
    fn holds_come_back_with_what_the_store_said() {
        let mut dice = RandomStream::new(1, "holds");
        for _ in 0..5000 {
            let held = Refused::Held(holds(&mut dice), None);
            let expected = Some(held.clone()).filter(|held| *held != Refused::Held(Vec::new(), None));
            assert_eq!(Refusal::from(&held).refused(), expected);
            let mut of_store = holds(&mut dice);
            of_store.retain(|hold| *hold != Hold::Store);
            of_store.push(Hold::Store);
            of_store.sort();
            let held = Refused::Held(of_store.clone(), Some("the disk is full; why: (so)".to_owned()));
            assert_eq!(Refusal::from(&held).refused(), Some(held));
            // Words of the store that end with a hold's are not told apart from it; the sentence is the same.
            let refusal = Refusal::from(&Refused::Held(of_store, Some(hostile(&mut dice))));
            assert_eq!(refusal.refused().map(|refused| Refusal::from(&refused)), Some(refusal));
        }
    }

    #[test]
    fn a_sensor_of_any_name_comes_back() {
        let names = ["roof", "a\"b", "a\\n", "'", "\u{301}a", "\u{e000}", "ü鞄", "\\u{7}"];
        for name in names.into_iter().filter_map(TemperatureReport::sensor_name) {
            let refused = Refused::UnknownSensor(name);
            assert_eq!(Refusal::from(&refused).refused(), Some(refused));
        }
    }

    #[test]
    fn words_of_a_door_or_of_another_version_are_no_refusal_here() {
        let refused = |code, words: &str| Refusal { code, kind: RefusalKind::Conflict, words: words.to_owned() }.refused();
        assert_eq!(refused("moving", "the robot is moving: press STOP first"), Some(Refused::Moving));
        for (code, words) in [
            ("moving", "the robot moves"),
            ("driving", "the robot is moving: press STOP first"),
            ("tooMany", "too many at once"),
            ("verdictPending", "luggage #03 waits for its verdict: answer safe or danger first"),
            ("faultStands", "the fault still stands: the robot's wheels slip"),
            ("held", "not possible while held: "),
            ("held", "not possible while held: tired"),
            ("unknownSensor", "there is no sensor \""),
            ("unknownSensor", "there is no sensor \"\\u{110000}\": name it in the setting temperature.sensor"),
            ("otherContent", ""),
            ("notAllowed", "its kind is another"),
        ] {
            assert_eq!(refused(code, words), None, "{code}: {words}");
        }
        let mut dice = RandomStream::new(2, "refusals");
        for _ in 0..1000 {
            let (code, kind) = CODES[dice.below(CODES.len() as u64) as usize];
            let refusal = Refusal { code, kind, words: hostile(&mut dice) };
            let back = refusal.refused().map(|refused| Refusal::from(&refused));
            assert!(back.is_none_or(|back| back == refusal));
        }
    }
}
