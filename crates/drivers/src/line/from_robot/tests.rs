//! Tests of the robot's lines. Every written line can be read again. Any other text is either a line or refused,
//! without a panic.

use proptest::prelude::*;

use super::*;
use crate::line::{LONGEST, framed};

fn seq() -> impl Strategy<Value = Seq> {
    (1..=Seq::LAST.number()).prop_map(|number| Seq::new(number).expect("it is within"))
}

fn what() -> impl Strategy<Value = Obstacle> {
    prop_oneof![
        (any::<u16>(), any::<u16>()).prop_map(|(left, right)| Obstacle::Wall { left, right }),
        any::<u32>().prop_map(|piece| Obstacle::Luggage(Piece(piece))),
        Just(Obstacle::Unknown),
    ]
}

fn time() -> impl Strategy<Value = Duration> {
    (0..=u64::from(SLOWEST_MS)).prop_map(Duration::from_millis)
}

fn whereabouts() -> impl Strategy<Value = Whereabouts> {
    let place = -i32::from(i16::MAX)..=i32::from(i16::MAX);
    (place.clone(), place, prop::sample::select(&Heading::ALL[..]), any::<bool>())
        .prop_map(|(x, y, heading, off_centre)| Whereabouts { pose: Pose { cell: Cell::new(x, y), heading }, off_centre })
}

fn greeting() -> impl Strategy<Value = FromRobot> {
    let parts = prop::sample::subsequence(PARTS.to_vec(), 0..=PARTS.len());
    let last = prop::option::of(seq());
    ("[!-)+-~]{1,24}", parts, time(), time(), time(), whereabouts(), last).prop_map(
        |(name, parts, step, turn, photo, stands, last)| {
            let name = RobotName::new(&name).expect("it is one");
            FromRobot::Hello(Hello { name, parts: Parts::of(&parts), step, turn, photo, stands, last })
        },
    )
}

fn said() -> impl Strategy<Value = FromRobot> {
    let ahead = (any::<u16>(), prop::option::of(what())).prop_map(|(free, obstacle)| Ahead { free, obstacle });
    let words = any::<String>().prop_map(|text| Words::new(&text));
    let tenths = (-600..=10_000_i32).prop_map(|tenths| Celsius::new(f64::from(tenths) / 10.0).expect("it is one"));
    prop_oneof![
        greeting(),
        (seq(), prop::option::of(ahead)).prop_map(|(seq, ahead)| FromRobot::Done(seq, ahead)),
        (seq(), prop::option::of(any::<u16>()), what()).prop_map(|(seq, cm, what)| FromRobot::Blocked(seq, cm, what)),
        (seq(), any::<bool>()).prop_map(|(seq, off)| FromRobot::Halted(seq, off)),
        (seq(), words.clone()).prop_map(|(seq, why)| FromRobot::Failed(seq, why)),
        (seq(), words).prop_map(|(seq, why)| FromRobot::NoPhoto(seq, why)),
        (seq(), any::<u32>(), any::<u32>()).prop_map(|(seq, length, crc)| FromRobot::Photo(seq, length, crc)),
        prop::option::of(any::<u16>()).prop_map(FromRobot::Sonar),
        tenths.prop_map(FromRobot::Temperature),
    ]
}

proptest! {
    #[test]
    fn what_is_said_is_read_back_and_fits_a_line(said in said()) {
        prop_assert_eq!(FromRobot::parse(&said.to_string()), Some(said.clone()));
        prop_assert!(framed(&said.to_string()).len() <= LONGEST + 1, "{}", said);
    }

    #[test]
    fn any_text_says_something_or_nothing(text in any::<String>()) {
        if let Some(said) = FromRobot::parse(&text) {
            prop_assert_eq!(FromRobot::parse(&said.to_string()), Some(said));
        }
    }

    #[test]
    fn a_line_with_a_word_too_many_or_too_few_says_something_else(said in said(), word in "[a-z0-9]{1,5}") {
        let text = format!("{said} {word}");
        prop_assert_ne!(FromRobot::parse(&text), Some(said));
    }
}

#[test]
fn the_texts_are_those_of_the_documentation() {
    for text in [
        "hello ada base sonar led bump step=800 turn=650 photo=0 at=0,0,south centred last=0",
        "hello ada base camera sonar led thermometer bump step=800 turn=650 photo=2000 at=-3,12,west off last=41",
        "done 42",
        "done 42 ahead 3",
        "done 42 ahead 1 luggage 5",
        "blocked 42 4 wall",
        "blocked 42 none unknown",
        "blocked 42 4 wall 3 2",
        "halted 42 off",
        "failed 42 it did not finish in time",
        "nophoto 42 the camera does not answer",
        "photo 42 18211 CBF43926",
        "sonar 37",
        "sonar none",
        "temp 21.5",
    ] {
        let said = FromRobot::parse(text).unwrap_or_else(|| panic!("{text} says something"));
        assert_eq!(said.to_string(), text);
    }
    assert_eq!(FromRobot::parse("blocked 42 4 luggage").map(|said| said.to_string()), Some("blocked 42 4 unknown".to_owned()));
}

#[test]
fn what_says_nothing_is_nothing() {
    for wrong in [
        "",
        "done",
        "done 0",
        "done 42 ahead",
        "blocked 42 wall",
        "halted 42",
        "photo 42 10 xyz",
        "photo 42 10 +0000001",
        "sonar",
        "sonar -1",
        "temp nan",
        "temp 1e2",
        "hello ada",
        "hello ada gripper step=1 turn=1 photo=1 at=0,0,south centred last=0",
        "hello ada base step=1 turn=1 photo=1 at=0,0 centred last=0",
        "hello ada base step=1 turn=1 photo=1 at=0,0,south centred last=2147483648",
    ] {
        assert_eq!(FromRobot::parse(wrong), None, "{wrong}");
    }
}
