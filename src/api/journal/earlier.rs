//! Reads entries of earlier versions. Up to format 4, the journal stored requests, refusals and causes as English
//! sentences. Each sentence becomes the code with fields that later formats store. The sentences here are those of
//! the earlier versions, and must not follow today's wording. A sentence that no earlier version wrote stays a
//! sentence.

use serde_json::{Map, Value, json};

use super::coded::Coded;

/// A code, and the sentence that earlier versions wrote for it. `{field:kind}` stands for a value of this kind,
/// `{field}` for any words.
type Sentence = (&'static str, &'static str);

const ASKED: [Sentence; 25] = [
    ("start", "START"),
    ("stop", "STOP"),
    ("backHome", "BACK HOME"),
    ("retrieve", "RETRIEVE"),
    ("reset", "RESET"),
    ("move", "move {step:move}"),
    ("goto", "goto {cell:cell}"),
    ("verdict", "{verdict:verdict}"),
    ("verdict", "{verdict:verdict} #{luggage:number}"),
    ("verdict", "{verdict:verdict} (note: {note:trimmed})"),
    ("verdict", "{verdict:verdict} #{luggage:number} (note: {note:trimmed})"),
    ("retake", "retake photo #{luggage:number}"),
    ("acknowledge", "acknowledge alarm {alarm:number}"),
    ("strategy", "choose strategy {strategy:name}"),
    ("temperatureOk", "temperature OK"),
    ("temperatureTooHigh", "temperature TOO HIGH"),
    ("reading", "temperature reading {celsius:decimal} °C"),
    ("sensorReading", "a sensor's reading {sensor} {celsius:decimal} °C"),
    ("stops", "STOP, {count:number} times at once"),
    ("stops", "STOP, {count:number} times within {withinMs:tenths} s"),
    ("simulatorStep", "simulator one step"),
    ("putDown", "put down in the hall {hall}"),
    ("hallKept", "simulator keeps the hall {hall}"),
    ("hallDiscarded", "simulator discards the hall {hall}"),
    ("many", "{last:asked}, and {more:number} more that were refused"),
];

const REFUSED: [Sentence; 27] = [
    (
        "outdated",
        "outdated: it was sent at epoch {sent:number}, but a STOP has since raised it to {now:number}; look again, then repeat it",
    ),
    ("sentBefore", "outdated: it was sent before, and a STOP or a restart may have come since; look again, then give it anew"),
    ("notInPhase", "not possible while {phase:phase}"),
    ("verdictPending", "luggage #{luggage:number} waits for its verdict: answer safe or danger first"),
    ("driving", "the robot is being driven by hand: wait for the end of the move, or press STOP"),
    ("notStopped", "the robot is on its mission: press STOP before driving it by hand"),
    ("intoObstacle", "there is an obstacle at {cell:cell}"),
    ("notCapable", "this robot has no small corrective turns"),
    ("moving", "the robot is moving: press STOP first"),
    ("unrecorded", "a piece of luggage is being recorded: wait for its photo"),
    ("bombUnfetched", "luggage #{luggage:number} is dangerous and still in the hall: acknowledge its alarm first"),
    ("unknownLuggage", "there is no luggage #{luggage:number}"),
    ("nothingPending", "no luggage waits for a verdict"),
    ("decided", "luggage #{luggage:number} was already found {verdict:verdict}: a verdict is final"),
    ("noPhoto", "luggage #{luggage:number} has no usable photo: take it again, or answer danger"),
    ("notInspected", "luggage #{luggage:number} is not the one being inspected"),
    ("photoUnderWay", "the photo is being taken"),
    ("unknownAlarm", "there is no alarm {alarm:number}"),
    ("noRetrievalRobot", "no retrieval robot is there"),
    ("fetcherUnreached", "{robot} cannot be reached, and the retrieval needs it: mend its link first"),
    ("fetcherAbroad", "{robot} is not back yet: press START, so that the retrieval goes on"),
    ("faultStands", "the fault still stands: {fault:fault}"),
    ("storeDown", "the record cannot be written, so nothing was decided: try again when the store is back"),
    ("notKept", "it could not be put on record, because the store has failed: look at the state before you repeat it"),
    ("otherContent", "the id {id} was used before, for another command: give each command an id of its own"),
    ("unknownSensor", "there is no sensor {sensor:quoted}: name it in the setting temperature.sensor"),
    ("notAllowed", "{words}"),
];

const ALARMS: [Sentence; 3] = [
    ("dangerous", "luggage #{luggage:number} at {cell:cell} is dangerous"),
    ("unrecorded", "luggage #{luggage:number} at {cell:cell} is said to be dangerous, but that could not be recorded"),
    ("call", "luggage #{luggage:number}: {saying:saying}"),
];

const NOT_FETCHED: [Sentence; 6] = [
    ("stuck", "{fault:stuck}"),
    ("stuck", "{before:notFetched}; and {fault:stuck}"),
    ("pair", "{fault:pair}"),
    ("pair", "{fault:pair} ({words})"),
    ("alone", "{fault:alone}"),
    ("otherFetcher", "it was begun with mission.retrieval = \"{began:name}\", which is \"{set:name}\" now: set it back"),
];

const FAULTS: [Sentence; 5] = [
    ("noWayHome", "no known way leads home: clear the way, or fetch the robot"),
    ("unanswered", "the robot did not finish its order in time: look after it, then press START"),
    ("undecided", "the search finds no next step: press RESET and begin anew"),
    ("robot", "the robot could not carry out its order ({words}): look after it, then press START"),
    ("notFetched", "the piece was not fetched: {why:anyNotFetched}"),
];

const HOLDS: [Sentence; 9] = [
    ("operator", "stopped by the operator"),
    ("tooHigh", "temperature too high (button): press OK first"),
    ("temperature", "a reading is above the threshold: every source must read cool again"),
    ("temperatureStale", "the temperature sensor is silent: mend it first"),
    ("robotLink", "the robot cannot be reached: mend the link first"),
    ("store", "nothing can be recorded: mend the disk first"),
    ("restart", "the program was started again; everything is as it was"),
    ("alarm", "an alarm is open: acknowledge it first (or say danger again, where a danger could not be recorded)"),
    ("awaitingStart", "waiting for START"),
];

const PHASES: [Sentence; 12] = [
    ("idle", "idle"),
    ("exploring", "exploring"),
    ("inspecting", "inspecting luggage"),
    ("driving", "driving by hand"),
    ("returningHome", "returning home"),
    ("atHome", "waiting at home"),
    ("returningWithAlarm", "returning home with an alarm"),
    ("bombLocated", "home, bomb located"),
    ("retrieving", "retrieving the bag"),
    ("bagSecured", "bag secured"),
    ("explored", "hall explored"),
    ("fault", "in fault"),
];

const MOVES: [Sentence; 6] = [
    ("forward", "forward"),
    ("backward", "backward"),
    ("turnLeft", "left"),
    ("turnRight", "right"),
    ("nudgeLeft", "a little left"),
    ("nudgeRight", "a little right"),
];

const VERDICTS: [Sentence; 2] = [("safe", "safe"), ("danger", "danger")];

const SAYINGS: [Sentence; 2] = [
    ("callOperator", "the pair recognises no parcel: look what stands there, then acknowledge and press START"),
    ("packageLost", "the pair has lost the parcel: look where it lies, then acknowledge and press START"),
];

const OF_PAIR: [Sentence; 10] = [
    ("nothingToFetch", "the pair does not know what to fetch"),
    ("noWayToParcel", "the pair finds no way to take hold of the parcel from two sides and carry it off"),
    ("noWayToTarget", "the pair finds no way to carry the parcel to where it is to go"),
    ("noWayBack", "the pair finds no way back to the pallet"),
    ("wrongParcel", "the pair has taken hold of another parcel than the one it was sent for"),
    ("robotFails", "a robot of the pair cannot do what it is told: look after it"),
    ("lostTooOften", "the pair has lost the parcel too often"),
    ("notAligned", "the pair cannot bring the parcel exactly to where it is to be put down"),
    ("takesTooLong", "one step of the pair's work takes longer than it ever should"),
    ("tree", "a behaviour tree cannot be performed as it is written"),
];

const ALONE: [Sentence; 6] = [
    ("otherPiece", "the robot has taken another piece than the one it was sent for"),
    ("pieceLost", "the robot does not hold the piece any more, and it is not in the container"),
    ("noWayHome", "no known way leads home with the piece"),
    ("noWayToPiece", "no way leads to the piece"),
    ("cannotTake", "the robot cannot take hold of the piece"),
    ("notRecognised", "the robot does not recognise the piece where it should stand"),
];

const STUCK: [Sentence; 2] = [
    ("robotFails", "a robot that fetches cannot do what it is told"),
    ("noWayOut", "no way leads the robots that fetch back outside"),
];

pub(super) fn asked(sentence: &str) -> Option<Coded> {
    one_of(&ASKED, sentence).or_else(|| Some(Coded { code: "simulatorChange".to_owned(), fields: changes(sentence)? }))
}

pub(super) fn refused(code: &str, sentence: &str) -> Option<Coded> {
    if code == "held" {
        return held(sentence).map(|fields| Coded::new(code, fields));
    }
    one_of(REFUSED.iter().filter(|(known, _)| *known == code), sentence)
}

pub(super) fn alarm(sentence: &str) -> Option<Coded> {
    one_of(&ALARMS, sentence)
}

pub(super) fn not_fetched(sentence: &str) -> Option<Coded> {
    one_of(&NOT_FETCHED, sentence)
}

fn one_of<'s>(sentences: impl IntoIterator<Item = &'s Sentence>, words: &str) -> Option<Coded> {
    sentences.into_iter().find_map(|(code, sentence)| {
        let fields = fields(sentence, words)?;
        Some(Coded { code: (*code).to_owned(), fields })
    })
}

/// Compares `words` with a sentence, and returns the values of the sentence's fields; `None` if they do not match. If
/// the text between two fields occurs several times, the leftmost occurrence that fits is used.
fn fields(sentence: &str, words: &str) -> Option<Map<String, Value>> {
    let Some((before, behind)) = sentence.split_once('{') else { return (sentence == words).then(Map::new) };
    let words = words.strip_prefix(before)?;
    let (field, rest) = behind.split_once('}')?;
    let (name, kind) = field.split_once(':').unwrap_or((field, "words"));
    let next = rest.split('{').next()?;
    let ends_at = |end: usize| {
        let mut fields = fields(rest, &words[end..])?;
        fields.insert(name.to_owned(), value(kind, &words[..end])?);
        Some(fields)
    };
    if next == rest {
        return ends_at(words.strip_suffix(next)?.len());
    }
    words.match_indices(next).find_map(|(end, _)| ends_at(end))
}

fn value(kind: &str, words: &str) -> Option<Value> {
    let known = |all: &[Sentence]| all.iter().find(|(_, known)| *known == words).map(|(name, _)| Value::from(*name));
    match kind {
        "words" => Some(words.into()),
        "trimmed" => (words.trim() == words).then(|| words.into()),
        "name" => words.bytes().all(|letter| letter.is_ascii_alphabetic()).then(|| words.into()),
        "number" => number(words).map(Value::from),
        "decimal" => words.parse::<f64>().ok().filter(|number| number.to_string() == words).map(Value::from),
        "tenths" => tenths(words),
        "cell" => cell(words),
        "quoted" => unquoted(words),
        "move" => known(&MOVES),
        "phase" => known(&PHASES),
        "verdict" => known(&VERDICTS),
        "saying" => known(&SAYINGS),
        "pair" => known(&OF_PAIR),
        "alone" => known(&ALONE),
        "stuck" => known(&STUCK),
        // The value has the shape of `CauseShape` in `phase`. This is a name, or an object with the name as its only
        // key.
        "fault" => {
            let Coded { code, mut fields } = one_of(&FAULTS, words)?;
            let own = fields.remove("words").or_else(|| fields.remove("why"));
            Some(own.map_or_else(|| Value::from(&*code), |own| json!({ &code: own })))
        }
        // A sentence inside another sentence contains no third one. A damaged journal may have more nested words,
        // which are not split further.
        "asked" => Some(within(&ASKED[..ASKED.len() - 1], words)),
        "notFetched" => Some(within(&NOT_FETCHED[2..], words)),
        "anyNotFetched" => Some(within(&NOT_FETCHED, words)),
        _ => None,
    }
}

fn within(sentences: &[Sentence], words: &str) -> Value {
    one_of(sentences, words).unwrap_or_else(|| Coded::new("words", json!({ "words": words }))).object()
}

fn number(words: &str) -> Option<u64> {
    words.parse().ok().filter(|number: &u64| number.to_string() == words)
}

/// Reads seconds with one decimal, such as `1.2`, as milliseconds.
fn tenths(words: &str) -> Option<Value> {
    let (seconds, tenths) = words.split_once('.')?;
    let tenths = number(tenths).filter(|tenths| *tenths < 10)?;
    Some(number(seconds)?.checked_mul(1000)?.checked_add(tenths * 100)?.into())
}

/// Reads a cell written as `(1, 2)`.
fn cell(words: &str) -> Option<Value> {
    let (x, y) = words.strip_prefix('(')?.strip_suffix(')')?.split_once(", ")?;
    let side = |words: &str| words.parse::<i32>().ok().filter(|side| side.to_string() == words);
    Some(json!({ "x": side(x)?, "y": side(y)? }))
}

/// Reads holds separated by `; `. The reason why the store cannot write may come before the holds. This reason may
/// contain `; ` itself. So the known holds are split off from the end, and the rest is the reason.
fn held(sentence: &str) -> Option<Value> {
    let mut rest = sentence.strip_prefix("not possible while held: ")?;
    let mut holds = Vec::new();
    let place = |name: &str| HOLDS.iter().position(|(known, _)| *known == name);
    while let Some((hold, before)) = HOLDS.iter().find_map(|(name, hold)| Some((*name, before_last(rest, hold)?))) {
        holds.insert(0, hold);
        let Some(before) = before else { return Some(json!({ "holds": holds })) };
        rest = before;
    }
    let store_failure = rest.strip_prefix("nothing can be recorded: ").filter(|_| !holds.contains(&"store"))?;
    // The sentence begins with the store's reason. In the list, the store's hold has its place in the order of
    // `HOLDS`.
    let behind = holds.iter().position(|hold| place(hold) > place("store")).unwrap_or(holds.len());
    holds.insert(behind, "store");
    Some(json!({ "holds": holds, "storeFailure": store_failure }))
}

/// Returns the words before this hold, if the words end with the hold. The inner `None` means that nothing comes
/// before the hold.
fn before_last<'w>(words: &'w str, hold: &str) -> Option<Option<&'w str>> {
    let before = words.strip_suffix(hold)?;
    if before.is_empty() { Some(None) } else { before.strip_suffix("; ").map(Some) }
}

/// Reads changes of the simulator, such as `simulator paused, speed 2, camera fails: yes, blocked (1, 2), (3, 4)`.
/// The cells come last.
fn changes(sentence: &str) -> Option<Map<String, Value>> {
    let words = sentence.strip_prefix("simulator ")?;
    let (before, cells) = words.split_once("blocked (").map_or((words, None), |(before, cells)| (before, Some(cells)));
    let mut fields = Map::new();
    for change in before.split(", ").filter(|change| !change.is_empty()) {
        let (name, value) = match change {
            "paused" => ("paused", true.into()),
            "going on" => ("paused", false.into()),
            "link lost: yes" => ("linkLost", true.into()),
            "link lost: no" => ("linkLost", false.into()),
            "no thermometer: yes" => ("noThermometer", true.into()),
            "no thermometer: no" => ("noThermometer", false.into()),
            "camera fails: yes" => ("cameraFails", true.into()),
            "camera fails: no" => ("cameraFails", false.into()),
            "speed max" => ("speed", "max".into()),
            "no way blocked" => ("blocked", json!([])),
            _ => ("speed", value("decimal", change.strip_prefix("speed ")?)?),
        };
        fields.insert(name.to_owned(), value);
    }
    if let Some(cells) = cells {
        let cells = cells.strip_suffix(')')?.split("), (").map(|words| cell(&format!("({words})")));
        fields.insert("blocked".to_owned(), cells.collect::<Option<Vec<_>>>()?.into());
    }
    (!fields.is_empty()).then_some(fields)
}

/// Reads a string literal of Rust.
fn unquoted(literal: &str) -> Option<Value> {
    let mut letters = literal.strip_prefix('"')?.strip_suffix('"')?.chars();
    let mut text = String::new();
    while let Some(letter) = letters.next() {
        text.push(if letter == '\\' { escaped(&mut letters)? } else { letter });
    }
    (format!("{text:?}") == literal).then(|| text.into())
}

/// Returns the letter that an escape stands for. The backslash has been read already.
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
#[path = "earlier_tests.rs"]
mod tests;
