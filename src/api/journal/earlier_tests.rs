//! Tests with sentences of versions up to format 4 and the codes for them, and with sentences that no version wrote.

use super::super::coded::{CodeOrSentence, Form, Valued};
use super::super::refused;
use super::*;
use hallsweep_core::asked::Asked;
use hallsweep_core::not_fetched::NotFetched;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::world::alarm::AlarmCause;

/// Sentences of requests in earlier versions, and the codes with which the journal stores these requests now.
const WAS_ASKED: [(&str, &str); 29] = [
    ("START", r#"{"code":"start"}"#),
    ("STOP", r#"{"code":"stop"}"#),
    ("BACK HOME", r#"{"code":"backHome"}"#),
    ("RETRIEVE", r#"{"code":"retrieve"}"#),
    ("RESET", r#"{"code":"reset"}"#),
    ("move forward", r#"{"code":"move","step":"forward"}"#),
    ("move left", r#"{"code":"move","step":"turnLeft"}"#),
    ("move a little right", r#"{"code":"move","step":"nudgeRight"}"#),
    ("goto (-3, 12)", r#"{"cell":{"x":-3,"y":12},"code":"goto"}"#),
    ("safe", r#"{"code":"verdict","verdict":"safe"}"#),
    ("danger #3", r#"{"code":"verdict","luggage":3,"verdict":"danger"}"#),
    ("safe (note: a) #3 (note: b))", r#"{"code":"verdict","note":"a) #3 (note: b)","verdict":"safe"}"#),
    ("safe #3 (note: red)", r#"{"code":"verdict","luggage":3,"note":"red","verdict":"safe"}"#),
    ("retake photo #3", r#"{"code":"retake","luggage":3}"#),
    ("acknowledge alarm 4", r#"{"alarm":4,"code":"acknowledge"}"#),
    ("choose strategy snail", r#"{"code":"strategy","strategy":"snail"}"#),
    ("temperature OK", r#"{"code":"temperatureOk"}"#),
    ("temperature TOO HIGH", r#"{"code":"temperatureTooHigh"}"#),
    ("temperature reading 20.5 °C", r#"{"celsius":20.5,"code":"reading"}"#),
    ("a sensor's reading roof -3 °C", r#"{"celsius":-3.0,"code":"sensorReading","sensor":"roof"}"#),
    ("STOP, 3 times at once", r#"{"code":"stops","count":3}"#),
    ("STOP, 2960 times within 1.2 s", r#"{"code":"stops","count":2960,"withinMs":1200}"#),
    ("simulator one step", r#"{"code":"simulatorStep"}"#),
    ("put down in the hall depot", r#"{"code":"putDown","hall":"depot"}"#),
    ("simulator keeps the hall mine", r#"{"code":"hallKept","hall":"mine"}"#),
    ("simulator discards the hall mine", r#"{"code":"hallDiscarded","hall":"mine"}"#),
    (
        "simulator paused, speed 2.5, link lost: yes, camera fails: no, blocked (1, 2), (3, 4)",
        r#"{"blocked":[{"x":1,"y":2},{"x":3,"y":4}],"cameraFails":false,"code":"simulatorChange","linkLost":true,"paused":true,"speed":2.5}"#,
    ),
    (
        "simulator going on, speed max, no thermometer: no, no way blocked",
        r#"{"blocked":[],"code":"simulatorChange","noThermometer":false,"paused":false,"speed":"max"}"#,
    ),
    ("POST /x, and 7 more that were refused", r#"{"code":"many","last":{"code":"words","words":"POST /x"},"more":7}"#),
];

/// Codes and sentences of refusals in earlier versions, and the codes with which the journal stores these refusals
/// now.
const WAS_REFUSED: [(&str, &str, &str); 38] = [
    (
        "outdated",
        "outdated: it was sent at epoch 3, but a STOP has since raised it to 5; look again, then repeat it",
        r#"{"code":"outdated","now":5,"sent":3}"#,
    ),
    (
        "sentBefore",
        "outdated: it was sent before, and a STOP or a restart may have come since; look again, then give it anew",
        r#"{"code":"sentBefore"}"#,
    ),
    ("notInPhase", "not possible while inspecting luggage", r#"{"code":"notInPhase","phase":"inspecting"}"#),
    ("notInPhase", "not possible while home, bomb located", r#"{"code":"notInPhase","phase":"bombLocated"}"#),
    (
        "verdictPending",
        "luggage #3 waits for its verdict: answer safe or danger first",
        r#"{"code":"verdictPending","luggage":3}"#,
    ),
    ("driving", "the robot is being driven by hand: wait for the end of the move, or press STOP", r#"{"code":"driving"}"#),
    ("notStopped", "the robot is on its mission: press STOP before driving it by hand", r#"{"code":"notStopped"}"#),
    ("intoObstacle", "there is an obstacle at (2, -1)", r#"{"cell":{"x":2,"y":-1},"code":"intoObstacle"}"#),
    ("notCapable", "this robot has no small corrective turns", r#"{"code":"notCapable"}"#),
    ("moving", "the robot is moving: press STOP first", r#"{"code":"moving"}"#),
    ("unrecorded", "a piece of luggage is being recorded: wait for its photo", r#"{"code":"unrecorded"}"#),
    (
        "bombUnfetched",
        "luggage #3 is dangerous and still in the hall: acknowledge its alarm first",
        r#"{"code":"bombUnfetched","luggage":3}"#,
    ),
    ("unknownLuggage", "there is no luggage #3", r#"{"code":"unknownLuggage","luggage":3}"#),
    ("nothingPending", "no luggage waits for a verdict", r#"{"code":"nothingPending"}"#),
    ("decided", "luggage #3 was already found safe: a verdict is final", r#"{"code":"decided","luggage":3,"verdict":"safe"}"#),
    ("noPhoto", "luggage #3 has no usable photo: take it again, or answer danger", r#"{"code":"noPhoto","luggage":3}"#),
    ("notInspected", "luggage #3 is not the one being inspected", r#"{"code":"notInspected","luggage":3}"#),
    ("photoUnderWay", "the photo is being taken", r#"{"code":"photoUnderWay"}"#),
    ("unknownAlarm", "there is no alarm 9", r#"{"alarm":9,"code":"unknownAlarm"}"#),
    ("noRetrievalRobot", "no retrieval robot is there", r#"{"code":"noRetrievalRobot"}"#),
    (
        "fetcherUnreached",
        "srm1 cannot be reached, and the retrieval needs it: mend its link first",
        r#"{"code":"fetcherUnreached","robot":"srm1"}"#,
    ),
    (
        "fetcherAbroad",
        "srm2 is not back yet: press START, so that the retrieval goes on",
        r#"{"code":"fetcherAbroad","robot":"srm2"}"#,
    ),
    (
        "faultStands",
        "the fault still stands: no known way leads home: clear the way, or fetch the robot",
        r#"{"code":"faultStands","fault":"noWayHome"}"#,
    ),
    (
        "faultStands",
        "the fault still stands: the robot did not finish its order in time: look after it, then press START",
        r#"{"code":"faultStands","fault":"unanswered"}"#,
    ),
    (
        "faultStands",
        "the fault still stands: the search finds no next step: press RESET and begin anew",
        r#"{"code":"faultStands","fault":"undecided"}"#,
    ),
    (
        "faultStands",
        "the fault still stands: the robot could not carry out its order (it slips): look after it, then press START",
        r#"{"code":"faultStands","fault":{"robot":"it slips"}}"#,
    ),
    (
        "faultStands",
        "the fault still stands: the piece was not fetched: the pair has lost the parcel too often",
        r#"{"code":"faultStands","fault":{"notFetched":{"code":"pair","fault":"lostTooOften"}}}"#,
    ),
    (
        "storeDown",
        "the record cannot be written, so nothing was decided: try again when the store is back",
        r#"{"code":"storeDown"}"#,
    ),
    (
        "notKept",
        "it could not be put on record, because the store has failed: look at the state before you repeat it",
        r#"{"code":"notKept"}"#,
    ),
    (
        "otherContent",
        "the id was was used before, for another command: give each command an id of its own",
        r#"{"code":"otherContent","id":"was"}"#,
    ),
    (
        "unknownSensor",
        r#"there is no sensor "\u{7}\"\\n": name it in the setting temperature.sensor"#,
        r#"{"code":"unknownSensor","sensor":"\u0007\"\\n"}"#,
    ),
    ("notAllowed", "lobby may only look", r#"{"code":"notAllowed","words":"lobby may only look"}"#),
    (
        "held",
        "not possible while held: stopped by the operator; waiting for START",
        r#"{"code":"held","holds":["operator","awaitingStart"]}"#,
    ),
    (
        "held",
        "not possible while held: nothing can be recorded: the disk is full; why: (so); stopped by the operator; waiting for START",
        r#"{"code":"held","holds":["operator","store","awaitingStart"],"storeFailure":"the disk is full; why: (so)"}"#,
    ),
    (
        "held",
        "not possible while held: nothing can be recorded: not waiting for START",
        r#"{"code":"held","holds":["store"],"storeFailure":"not waiting for START"}"#,
    ),
    (
        "held",
        "not possible while held: temperature too high (button): press OK first; a reading is above the threshold: every source must \
         read cool again; the temperature sensor is silent: mend it first; the robot cannot be reached: mend the link first; nothing \
         can be recorded: mend the disk first; the program was started again; everything is as it was; an alarm is open: acknowledge \
         it first (or say danger again, where a danger could not be recorded)",
        r#"{"code":"held","holds":["tooHigh","temperature","temperatureStale","robotLink","store","restart","alarm"]}"#,
    ),
    ("malformed", "the body is not JSON", r#"{"code":"malformed","words":"the body is not JSON"}"#),
    ("moving", "the robot moves", r#"{"code":"moving","words":"the robot moves"}"#),
];

const WAS_ALARM: [(&str, &str); 4] = [
    ("luggage #4 at (3, 3) is dangerous", r#"{"cell":{"x":3,"y":3},"code":"dangerous","luggage":4}"#),
    (
        "luggage #4 at (3, 3) is said to be dangerous, but that could not be recorded",
        r#"{"cell":{"x":3,"y":3},"code":"unrecorded","luggage":4}"#,
    ),
    (
        "luggage #4: the pair recognises no parcel: look what stands there, then acknowledge and press START",
        r#"{"code":"call","luggage":4,"saying":"callOperator"}"#,
    ),
    (
        "luggage #4: the pair has lost the parcel: look where it lies, then acknowledge and press START",
        r#"{"code":"call","luggage":4,"saying":"packageLost"}"#,
    ),
];

const WAS_NOT_FETCHED: [(&str, &str); 5] = [
    ("the pair does not know what to fetch", r#"{"code":"pair","fault":"nothingToFetch"}"#),
    (
        "a behaviour tree cannot be performed as it is written (line 3 (so))",
        r#"{"code":"pair","fault":"tree","words":"line 3 (so)"}"#,
    ),
    ("no way leads to the piece", r#"{"code":"alone","fault":"noWayToPiece"}"#),
    (
        "it was begun with mission.retrieval = \"discovery\", which is \"none\" now: set it back",
        r#"{"began":"discovery","code":"otherFetcher","set":"none"}"#,
    ),
    (
        "a tree fell; and no way leads the robots that fetch back outside",
        r#"{"before":{"code":"words","words":"a tree fell"},"code":"stuck","fault":"noWayOut"}"#,
    ),
];

fn now(coded: Coded) -> String {
    coded.object().to_string()
}

fn read<T: Valued>(sentence: &str) -> T {
    CodeOrSentence::Sentence(sentence.to_owned()).value().unwrap()
}

fn reads_as<T: Valued>(sentences: &[(&str, &str)]) {
    for (sentence, expect) in sentences {
        assert_eq!(now(read::<T>(sentence).coded()), *expect, "{sentence}");
    }
}

#[test]
fn every_sentence_of_an_earlier_version_has_its_code() {
    reads_as::<Asked>(&WAS_ASKED);
    reads_as::<AlarmCause>(&WAS_ALARM);
    reads_as::<NotFetched>(&WAS_NOT_FETCHED);
    for (code, sentence, expect) in WAS_REFUSED {
        let refused = refused::read(&Coded::new(code, json!({ "words": sentence }))).unwrap();
        assert_eq!(now(refused::written(&refused, Form::Codes)), expect, "{sentence}");
    }
}

#[test]
fn what_no_version_wrote_stays_as_it_is() {
    for words in [
        "",
        "start",
        "START ",
        "STOP, 03 times at once",
        "STOP, 3 times within 1.25 s",
        "GO, 3 times at once",
        "safe #03",
        "safe  #3",
        "safe 3",
        "safe #18446744073709551616",
        "safe #3 (note: )",
        "safe (note:  red)",
        "safe #3 (note: a",
        "safe #3(note: a)",
        "goto (note: a)",
        "goto (1,2)",
        "goto (1, +2)",
        "move",
        "choose strategy fly",
        "a sensor's reading operator 20 °C",
        "temperature reading 1e9 °C",
        "simulator ",
        "simulator paused, dancing",
        "simulator blocked (",
    ] {
        assert_eq!(read::<Asked>(words), Asked::Words(words.to_owned()));
    }
    for words in
        ["luggage #2 is dangerous", "luggage #02 at (1, 2) is dangerous", "luggage #2 at (1, 2) is dangerous ", "luggage #2: "]
    {
        assert_eq!(read::<AlarmCause>(words), AlarmCause::Other(words.to_owned()));
    }
    for words in ["", "no way leads to the piece.", "the pair has lost the parcel too often ("] {
        assert_eq!(read::<NotFetched>(words), NotFetched::Other(words.to_owned()));
    }
    for (code, words) in [
        ("driving", "the robot is moving: press STOP first"),
        ("tooMany", "too many at once"),
        ("verdictPending", "luggage #03 waits for its verdict: answer safe or danger first"),
        ("faultStands", "the fault still stands: the robot's wheels slip"),
        ("held", "not possible while held: "),
        ("held", "not possible while held: tired"),
        ("held", "not possible while held: ; waiting for START"),
        ("held", "not possible while held: nothing can be recorded: why; nothing can be recorded: mend the disk first"),
        ("unknownSensor", "there is no sensor \""),
        ("unknownSensor", "there is no sensor \"\\u{110000}\": name it in the setting temperature.sensor"),
        ("fetcherAbroad", "SRM 1 is not back yet: press START, so that the retrieval goes on"),
    ] {
        let refused = refused::read(&Coded::new(code, json!({ "words": words }))).unwrap();
        assert_eq!((refused.code(), refused.to_string().as_str()), (code, words));
        assert!(matches!(refused, hallsweep_core::refused::Refused::InWords(_)), "{words}");
    }
}

/// Random words by an attacker who knows the program's sentences.
fn hostile(dice: &mut RandomStream) -> String {
    const PIECES: [&str; 24] = [
        "the wheels slip",
        " ",
        "\n",
        "\"",
        "\\",
        "\u{301}",
        "ü鞄",
        "(",
        ")",
        " (",
        ": ",
        "; ",
        "#",
        "7",
        " at (1, 2)",
        " is dangerous",
        ", and 3 more that were refused",
        "STOP, 3 times at once",
        " (note: ",
        "; stopped by the operator",
        "): look after it, then press START",
        "no way leads to the piece",
        "; and no way leads the robots that fetch back outside",
        "{words}",
    ];
    let length = 1 + dice.below(6);
    (0..length).map(|_| PIECES[dice.below(PIECES.len() as u64) as usize]).collect()
}

/// A random value of this kind, as text and as JSON.
fn drawn(kind: &str, dice: &mut RandomStream) -> (String, Value) {
    let any = dice.number() >> dice.below(64);
    let of = |all: &[Sentence]| {
        let (name, words) = all[(any % all.len() as u64) as usize];
        (words.to_owned(), name.into())
    };
    match kind {
        "words" => Some(hostile(dice)).map(|words| (words.clone(), words.into())).unwrap(),
        "trimmed" => Some(hostile(dice).trim().to_owned()).map(|words| (words.clone(), words.into())).unwrap(),
        "name" => ("discovery".to_owned(), "discovery".into()),
        "number" => (any.to_string(), any.into()),
        "decimal" => Some(dice.fraction() * 100.0 - 50.0).map(|number| (number.to_string(), number.into())).unwrap(),
        "tenths" => (format!("{}.{}", any >> 11, any % 10), ((any >> 11) * 1000 + any % 10 * 100).into()),
        "cell" => (format!("({}, -{})", any >> 33, (any >> 34) + 1), json!({ "x": any >> 33, "y": -1 - (any >> 34) as i64 })),
        "quoted" => Some(hostile(dice)).map(|words| (format!("{words:?}"), words.into())).unwrap(),
        "move" => of(&MOVES),
        "phase" => of(&PHASES),
        "verdict" => of(&VERDICTS),
        "saying" => of(&SAYINGS),
        "pair" => of(&OF_PAIR),
        "alone" => of(&ALONE),
        "stuck" => of(&STUCK),
        "fault" => of(&FAULTS[..3]),
        "asked" => ("STOP".to_owned(), json!({ "code": "stop" })),
        "notFetched" | "anyNotFetched" => (ALONE[3].1.to_owned(), json!({ "code": "alone", "fault": "noWayToPiece" })),
        _ => panic!("{kind} is drawn"),
    }
}

/// A sentence with random values, and these values.
fn filled(sentence: &str, dice: &mut RandomStream) -> (String, Map<String, Value>) {
    let Some((before, (field, rest))) = sentence.split_once('{').and_then(|(before, rest)| Some((before, rest.split_once('}')?)))
    else {
        return (sentence.to_owned(), Map::new());
    };
    let (name, kind) = field.split_once(':').unwrap_or((field, "words"));
    let ((words, value), (rest, mut fields)) = (drawn(kind, dice), filled(rest, dice));
    fields.insert(name.to_owned(), value);
    (format!("{before}{words}{rest}"), fields)
}

#[test]
fn every_sentence_comes_back_with_whatever_stands_in_it() {
    let mut dice = RandomStream::new(1, "sentences");
    let tables: [&[Sentence]; 5] = [&ASKED, &REFUSED, &ALARMS, &NOT_FETCHED, &FAULTS];
    for (code, sentence) in tables.concat() {
        for _ in 0..300 {
            let (words, expect) = filled(sentence, &mut dice);
            assert_eq!(fields(sentence, &words), Some(expect), "{code}: {words}");
        }
    }
}

#[test]
fn words_without_end_are_taken_apart_once() {
    let words = format!("START{}", ", and 7 more that were refused".repeat(100_000));
    assert!(matches!(read(&words), Asked::Many { last, more: 7 } if matches!(*last, Asked::Words(_))));
    let words = "; and no way leads the robots that fetch back outside".repeat(100_000);
    assert!(matches!(read(&words), NotFetched::Stuck(_, Some(before)) if matches!(*before, NotFetched::Other(_))));
}
