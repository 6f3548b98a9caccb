//! The bodies of commands in JSON, and their conversion to the core's commands. Every field is checked here, and no
//! value is guessed.

mod areas;

use std::borrow::Cow;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::json;

use super::fields::{Body, BodyFields, Unread, in_short, needed};
use super::halt::is_halt;
use super::vocabulary;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::closing::Closing;
use hallsweep_core::command::{Command, CommandId, Hot, HotAnswer, LuggageRef, Move, Note, Strategy, TemperatureReport, Verdict};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::units::{Cell, Celsius, Epoch, LuggageId, MissionId};
use hallsweep_core::words::is_visible;
use hallsweep_core::world::hall_map::REACH;

pub use self::areas::{AreaBody, CloseAreaBody, OrderAreasBody};
pub use super::fields::Unusable;

/// Body of a command without arguments. The body may be absent.
#[derive(Clone, Copy, Debug, Default, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct EpochBody {
    /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
    #[schemars(range(max = u64::MAX))]
    epoch: Option<u64>,
}

/// Piece to fetch, as `{"luggage":3}`. The body may be absent.
#[derive(Clone, Copy, Debug, Default, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct RetrieveBody {
    /// Number of a dangerous piece in the hall. Without a number, the piece that was found first is fetched.
    #[schemars(range(max = u64::MAX))]
    luggage: Option<u64>,
    /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
    #[schemars(range(max = u64::MAX))]
    epoch: Option<u64>,
}

/// Statement of the person in charge, as `{"name":"Anna Rossi","openPoints":"7:0,1,21,0,0,111,0"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields, rename_all = "camelCase")]
pub struct CloseBody {
    /// Name of the person in charge, in one line of visible characters.
    #[schemars(length(min = 1, max = Note::MOST), regex(pattern = NAME))]
    pub name: String,
    /// Remark, in one line of visible characters.
    #[schemars(length(max = Note::MOST), regex(pattern = VISIBLE))]
    pub note: Option<String>,
    /// Mission and open points that the sender has seen. May be absent if nothing is open. The refusal `openPoints` has
    /// the text to send.
    #[schemars(length(max = OPEN_POINTS))]
    pub open_points: Option<String>,
}

/// Hand-over of the mission and its record, as `{"to":"Inspector Bianchi","mission":7}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct HandOverBody {
    /// Name of the person or office that takes over, in one line of visible characters.
    #[schemars(length(min = 1, max = Note::MOST), regex(pattern = NAME))]
    pub to: String,
    /// Remark, in one line of visible characters.
    #[schemars(length(max = Note::MOST), regex(pattern = VISIBLE))]
    pub note: Option<String>,
    /// Number of the mission that the sender means. The command is refused if another mission is under way.
    #[schemars(range(max = u64::MAX))]
    pub mission: Option<u64>,
}

/// One move by hand, as `{"move":"w"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct MoveBody {
    #[schemars(rename = "move", with = "vocabulary::Move")]
    word: String,
    /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
    #[schemars(range(max = u64::MAX))]
    epoch: Option<u64>,
}

/// Target cell, counted from home, as `{"x":1,"y":1}`.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct GotoBody {
    /// Column, growing to the east.
    #[schemars(range(min = -REACH, max = REACH))]
    x: i64,
    /// Row, growing to the south.
    #[schemars(range(min = -REACH, max = REACH))]
    y: i64,
    /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
    #[schemars(range(max = u64::MAX))]
    epoch: Option<u64>,
}

/// Answer about a piece, as `{"verdict":"safe"}`, `{"verdict":"danger","note":"wires"}` or `{"verdict":"unsure"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields, transform = only_danger)]
pub struct VerdictBody {
    #[schemars(with = "vocabulary::AnswerWord")]
    verdict: String,
    /// Remark on the piece, in one line of visible characters.
    #[schemars(length(max = Note::MOST), regex(pattern = VISIBLE))]
    note: Option<String>,
    /// Is the piece hidden?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    hidden: Option<String>,
    /// Is the piece obviously suspicious?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    obvious: Option<String>,
    /// Is the piece typical of this place?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    typical: Option<String>,
    /// How large the bomb may be, only with `danger`: `pipe`, `vest`, `suitcase`, `car`, or a radius in metres such as `120`.
    #[schemars(regex(pattern = SIZE))]
    size: Option<String>,
}

/// Report of the temperature: `{"celsius":21.5}`, `{"celsius":21.5,"sensor":"roof"}` or `{"status":"ok"}`.
#[derive(Clone, Debug)]
pub struct TemperatureBody {
    celsius: Option<f64>,
    sensor: Option<String>,
    status: Option<String>,
}

/// Search strategy, as `{"name":"snail"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct StrategyBody {
    #[schemars(with = "vocabulary::StrategyName")]
    pub name: String,
}

/// Maximum length of the text that names a mission and its open points, in characters. Seven numbers fit.
const OPEN_POINTS: usize = 160;

/// The characters that `is_visible` allows, as a regular expression for clients. Blanks at both ends are allowed,
/// because `note` removes blanks there.
const VISIBLE: &str = r"^[ \t\n\r]*[^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*[ \t\n\r]*$";

/// The texts that `BombSize::read` accepts.
const SIZE: &str = "^(pipe|vest|suitcase|car|[1-9][0-9]{0,2}|[1-4][0-9]{3}|5000)$";

/// Adds to the schema of a verdict that only a danger has a size.
fn only_danger(schema: &mut Schema) {
    schema.insert("if".to_owned(), json!({"required": ["size"], "properties": {"size": {"type": "string"}}}));
    schema.insert("then".to_owned(), json!({"properties": {"verdict": {"const": "danger"}}}));
}

/// Like `VISIBLE`, with at least one character that is not blank.
const NAME: &str = concat!(
    r"^[ \t\n\r]*[^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*",
    r"[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]",
    r"[^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*[ \t\n\r]*$"
);

impl JsonSchema for TemperatureBody {
    fn schema_name() -> Cow<'static, str> {
        "TemperatureBody".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let word = generator.subschema_for::<vocabulary::TemperatureWord>();
        json_schema!({
            "description": "Reading in °C, by the operator or by a sensor, or the operator's judgement as `status`.",
            "oneOf": [
                {
                    "type": "object",
                    "properties": {
                        "celsius": {
                            "description": "Reading, in °C.",
                            "type": "number",
                            "minimum": Celsius::LEAST,
                            "maximum": Celsius::MOST,
                        },
                        "sensor": {
                            "description": "Name of the sensor, as in the setting `temperature.sensor`.",
                            "type": ["string", "null"],
                            "minLength": 1,
                            "maxLength": TemperatureReport::MOST,
                            "pattern": r"^(?!(operator|robot|others)$)[^\s,\u0000-\u001f\u007f-\u009f]*$",
                        },
                        "status": {"const": null},
                    },
                    "required": ["celsius"],
                    "additionalProperties": false,
                },
                {
                    "type": "object",
                    "properties": {"status": word, "celsius": {"const": null}, "sensor": {"const": null}},
                    "required": ["status"],
                    "additionalProperties": false,
                },
            ],
        })
    }
}

impl Body for EpochBody {
    const FIELDS: &'static [&'static str] = &["epoch"];

    fn taken(fields: &BodyFields) -> Result<EpochBody, Unusable> {
        Ok(EpochBody { epoch: fields.count("epoch")? })
    }
}

impl Body for RetrieveBody {
    const FIELDS: &'static [&'static str] = &["luggage", "epoch"];

    fn taken(fields: &BodyFields) -> Result<RetrieveBody, Unusable> {
        Ok(RetrieveBody { luggage: fields.count("luggage")?, epoch: fields.count("epoch")? })
    }
}

impl Body for CloseBody {
    const FIELDS: &'static [&'static str] = &["name", "note", "openPoints"];

    fn taken(fields: &BodyFields) -> Result<CloseBody, Unusable> {
        let name = needed(fields.text("name")?, "name", "{\"name\":\"Anna Rossi\"}")?;
        Ok(CloseBody { name, note: fields.text("note")?, open_points: fields.text("openPoints")? })
    }
}

impl Body for HandOverBody {
    const FIELDS: &'static [&'static str] = &["to", "note", "mission"];

    fn taken(fields: &BodyFields) -> Result<HandOverBody, Unusable> {
        let to = needed(fields.text("to")?, "to", "{\"to\":\"Inspector Bianchi\"}")?;
        Ok(HandOverBody { to, note: fields.text("note")?, mission: fields.count("mission")? })
    }
}

impl Body for MoveBody {
    const FIELDS: &'static [&'static str] = &["move", "epoch"];

    fn taken(fields: &BodyFields) -> Result<MoveBody, Unusable> {
        let word = needed(fields.text("move")?, "move", "{\"move\":\"w\"}")?;
        Ok(MoveBody { word, epoch: fields.count("epoch")? })
    }
}

impl Body for GotoBody {
    const FIELDS: &'static [&'static str] = &["x", "y", "epoch"];

    fn taken(fields: &BodyFields) -> Result<GotoBody, Unusable> {
        let side = |name| needed(fields.whole(name)?, name, "{\"x\":1,\"y\":1}");
        Ok(GotoBody { x: side("x")?, y: side("y")?, epoch: fields.count("epoch")? })
    }
}

impl Body for VerdictBody {
    const FIELDS: &'static [&'static str] = &["verdict", "note", "hidden", "obvious", "typical", "size"];

    fn taken(fields: &BodyFields) -> Result<VerdictBody, Unusable> {
        let verdict = needed(fields.text("verdict")?, "verdict", "{\"verdict\":\"safe\"}")?;
        let [hidden, obvious, typical] = ["hidden", "obvious", "typical"].map(|question| fields.text(question));
        let (note, size) = (fields.text("note")?, fields.text("size")?);
        Ok(VerdictBody { verdict, note, hidden: hidden?, obvious: obvious?, typical: typical?, size })
    }
}

impl Body for TemperatureBody {
    const FIELDS: &'static [&'static str] = &["celsius", "sensor", "status"];

    fn taken(fields: &BodyFields) -> Result<TemperatureBody, Unusable> {
        Ok(TemperatureBody { celsius: fields.number("celsius")?, sensor: fields.text("sensor")?, status: fields.text("status")? })
    }
}

impl Body for StrategyBody {
    const FIELDS: &'static [&'static str] = &["name"];

    fn taken(fields: &BodyFields) -> Result<StrategyBody, Unusable> {
        Ok(StrategyBody { name: needed(fields.text("name")?, "name", "{\"name\":\"snail\"}")? })
    }
}

impl EpochBody {
    pub fn epoch(self) -> Option<Epoch> {
        self.epoch.map(Epoch)
    }
}

impl RetrieveBody {
    pub fn command(self) -> (Command, Option<Epoch>) {
        (Command::Retrieve(self.luggage.map(LuggageId)), self.epoch.map(Epoch))
    }
}

impl CloseBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        let name = person(&self.name)?;
        let open = self.open_points.as_deref().unwrap_or_default();
        let length = open.chars().count();
        if length > OPEN_POINTS {
            return Err(Unusable(format!("openPoints has {length} characters: send the text of the refusal openPoints")));
        }
        Ok(Command::Close(Closing { name, note: note(self.note.as_deref())?, seen: open.into() }))
    }
}

impl HandOverBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        let empty = || Unusable("`to` is empty: write who takes the mission over".to_owned());
        let to = line("`to`", &self.to)?.ok_or_else(empty)?;
        Ok(Command::HandOver(HandOver { mission: self.mission.map(MissionId), to, note: note(self.note.as_deref())? }))
    }
}

impl MoveBody {
    pub fn command(&self) -> Result<(Command, Option<Epoch>), Unusable> {
        Ok((move_word(&self.word)?, self.epoch.map(Epoch)))
    }
}

impl GotoBody {
    pub fn command(self) -> Result<(Command, Option<Epoch>), Unusable> {
        Ok((goto(self.x, self.y)?, self.epoch.map(Epoch)))
    }
}

impl VerdictBody {
    pub fn command(&self, luggage: LuggageRef) -> Result<Command, Unusable> {
        let note = note(self.note.as_deref())?;
        let hot = Hot {
            hidden: hot_answer("hidden", self.hidden.as_deref())?,
            obvious: hot_answer("obvious", self.obvious.as_deref())?,
            typical: hot_answer("typical", self.typical.as_deref())?,
            size: self.size.as_deref().map(bomb_size).transpose()?,
        };
        let verdict = match self.verdict.as_str() {
            "safe" => Some(Verdict::Safe),
            "danger" => Some(Verdict::Danger),
            "unsure" => None,
            other => {
                let other = in_short(other);
                return Err(Unusable(format!("{other:?} is no verdict: verdict is \"safe\", \"danger\" or \"unsure\"")));
            }
        };
        answer(luggage, verdict, note, hot)
    }
}

impl TemperatureBody {
    pub fn report(&self) -> Result<TemperatureReport, Unusable> {
        match (self.celsius, self.status.as_deref()) {
            (Some(degrees), None) => {
                let celsius = celsius(degrees)?;
                let sensor = self.sensor()?;
                Ok(sensor.map_or(TemperatureReport::Reading(celsius), |sensor| TemperatureReport::Sensor(sensor, celsius)))
            }
            (None, Some(_)) if self.sensor.is_some() => {
                Err(Unusable("a sensor needs a reading: send {\"celsius\":21.5,\"sensor\":\"roof\"}".to_owned()))
            }
            (None, Some("ok")) => Ok(TemperatureReport::Ok),
            (None, Some("tooHigh")) => Ok(TemperatureReport::TooHigh),
            (None, Some(other)) => Err(Unusable(format!("{:?} is no status: status is \"ok\" or \"tooHigh\"", in_short(other)))),
            (Some(_), Some(_)) | (None, None) => {
                Err(Unusable("give either celsius, as {\"celsius\":21.5}, or status, as {\"status\":\"ok\"}".to_owned()))
            }
        }
    }

    fn sensor(&self) -> Result<Option<Arc<str>>, Unusable> {
        let Some(name) = &self.sensor else { return Ok(None) };
        let sound = TemperatureReport::sensor_name(name);
        sound.map(Some).ok_or_else(|| {
            let most = TemperatureReport::MOST;
            Unusable(format!("{:?} is no sensor's name: sensor is 1 to {most} visible characters, as \"roof\"", in_short(name)))
        })
    }
}

impl StrategyBody {
    pub fn strategy(&self) -> Result<Strategy, Unusable> {
        let known: Vec<&str> = Strategy::ALL.iter().map(|strategy| strategy.name()).collect();
        Strategy::named(&self.name)
            .ok_or_else(|| Unusable(format!("there is no strategy {:?}: send one of {}", in_short(&self.name), known.join(", "))))
    }
}

/// Reads a note; `None` if the note is blank.
pub fn note(text: Option<&str>) -> Result<Option<Note>, Unusable> {
    text.map_or(Ok(None), |text| line("the note", text))
}

/// Reads one line of visible characters; `None` if it is blank. `what` names the field in the error message.
fn line(what: &str, text: &str) -> Result<Option<Note>, Unusable> {
    let (text, most) = (text.trim(), Note::MOST);
    let length = text.chars().count();
    if length > most {
        return Err(Unusable(format!("{what} has {length} characters: the limit is {most}")));
    }
    if let Some(hidden) = text.chars().find(|letter| !is_visible(*letter)) {
        return Err(Unusable(format!("{what} has the invisible character {hidden:?}: write one line of visible characters")));
    }
    Ok(Note::new(text))
}

fn person(name: &str) -> Result<Note, Unusable> {
    let empty = || Unusable("the name is empty: write the name of the person in charge".to_owned());
    line("the name", name)?.ok_or_else(empty)
}

pub fn bomb_size(text: &str) -> Result<BombSize, Unusable> {
    let most = BombSize::WIDEST_M;
    let wrong =
        || format!("{:?} is no size: size is pipe, vest, suitcase, car or a number of metres from 1 to {most}", in_short(text));
    BombSize::read(text).ok_or_else(|| Unusable(wrong()))
}

/// Returns the answer about a piece; without a verdict, the sender is unsure.
pub fn answer(luggage: LuggageRef, verdict: Option<Verdict>, note: Option<Note>, hot: Hot) -> Result<Command, Unusable> {
    match verdict {
        None | Some(Verdict::Safe) if hot.size.is_some() => {
            Err(Unusable("size is how large a bomb may be: send it with the verdict danger only".to_owned()))
        }
        Some(verdict) => Ok(Command::Verdict { luggage, verdict, note, hot }),
        None => Ok(Command::Unsure { luggage, note, hot }),
    }
}

/// Reads the answer to one of the three questions about a piece; `None` if it was not answered.
pub fn hot_answer(question: &str, given: Option<&str>) -> Result<Option<HotAnswer>, Unusable> {
    let known = |answer: &str| HotAnswer::ALL.into_iter().find(|known| known.name() == answer);
    let wrong =
        |answer: &str| Unusable(format!("{:?} is no answer: {question} is \"yes\", \"no\" or \"cannotSay\"", in_short(answer)));
    given.map(|answer| known(answer).ok_or_else(|| wrong(answer))).transpose()
}

/// The error message for a command id that cannot be used, or that a request contains more than once. `place` is the
/// header, option or field from which the door reads the id.
pub fn no_command_id(place: &str, name: &str) -> String {
    format!("{place} is {:?}: send one name of 1 to {} visible ASCII characters", in_short(name), CommandId::MOST)
}

/// Removes the command id from the fields of a body, and returns it. For doors where a body has the id as its field
/// `id`.
pub fn id_aside(fields: &mut BodyFields) -> Result<Option<CommandId>, Unread> {
    let Some(name) = fields.aside("id", BodyFields::text).map_err(Unread::Unusable)? else { return Ok(None) };
    let id = CommandId::new(&name);
    id.map(Some).ok_or_else(|| Unread::Malformed(no_command_id("id", &name)))
}

/// Removes the number of the piece or alarm from the fields of a body, and returns it. For doors without paths.
pub fn number_aside(fields: &mut BodyFields, name: &'static str, example: &str) -> Result<u64, Unusable> {
    needed(fields.aside(name, BodyFields::count)?, name, example)
}

/// Returns the command for a one-letter word of old clients or of the field `move`. `h` and `stop` mean STOP.
pub fn move_word(word: &str) -> Result<Command, Unusable> {
    match word {
        halt if is_halt(halt) => Ok(Command::Stop),
        "w" => Ok(Command::Move(Move::Forward)),
        "s" => Ok(Command::Move(Move::Backward)),
        "a" | "l" => Ok(Command::Move(Move::TurnLeft)),
        "d" | "r" => Ok(Command::Move(Move::TurnRight)),
        "z" => Ok(Command::Move(Move::NudgeLeft)),
        "x" => Ok(Command::Move(Move::NudgeRight)),
        other => Err(Unusable(format!(
            "{:?} is no move: w forward, s backward, a or l left, d or r right, z and x small turns, h stop",
            in_short(other)
        ))),
    }
}

pub fn goto(x: i64, y: i64) -> Result<Command, Unusable> {
    cell(x, y).map(Command::Goto)
}

fn cell(x: i64, y: i64) -> Result<Cell, Unusable> {
    let within = |value: i64| i32::try_from(value).ok().filter(|value| (-REACH..=REACH).contains(value));
    let cell = within(x).zip(within(y)).map(|(x, y)| Cell::new(x, y));
    cell.ok_or_else(|| Unusable(format!("({x}, {y}) is out of reach: x and y must be between -{REACH} and {REACH}")))
}

pub fn reading(degrees: f64) -> Result<TemperatureReport, Unusable> {
    celsius(degrees).map(TemperatureReport::Reading)
}

fn celsius(degrees: f64) -> Result<Celsius, Unusable> {
    let (least, most) = (Celsius::LEAST, Celsius::MOST);
    Celsius::new(degrees).ok_or_else(|| Unusable(format!("{degrees:?} °C is not plausible: celsius must be {least} to {most}")))
}

#[cfg(test)]
mod tests {
    use super::super::fields::body;
    use super::*;

    #[test]
    fn old_and_new_words_for_moves_mean_the_same() {
        assert_eq!(move_word("l"), move_word("a"));
        assert_eq!(move_word("r"), move_word("d"));
        assert!(["h", "H", "stop", "STOP"].iter().all(|word| move_word(word) == Ok(Command::Stop)));
        assert!(move_word("W").is_err() && move_word("").is_err());
    }

    #[test]
    fn a_name_and_a_number_may_stand_beside_the_fields_of_a_body() {
        let mut fields = super::super::fields::fields(br#"{"luggage":3,"verdict":"safe","id":"k7"}"#).unwrap();
        assert_eq!(id_aside(&mut fields).unwrap(), CommandId::new("k7"));
        assert_eq!(number_aside(&mut fields, "luggage", "{\"luggage\":3}"), Ok(3));
        let luggage = LuggageRef::Pending;
        let safe = Command::Verdict { luggage, verdict: Verdict::Safe, note: None, hot: Hot::NONE };
        assert_eq!(fields.read::<VerdictBody>().unwrap().command(luggage), Ok(safe));
        let missing = number_aside(&mut fields, "alarm", "{\"alarm\":2}").unwrap_err();
        assert_eq!(missing.to_string(), "`alarm` is missing: send {\"alarm\":2}");
    }

    #[test]
    fn a_name_that_is_none_is_said_to_be_none() {
        let said = |json: &str| id_aside(&mut super::super::fields::fields(json.as_bytes()).unwrap());
        assert_eq!(said("{}"), Ok(None));
        assert_eq!(said(r#"{"id":null}"#), Ok(None));
        assert!(matches!(said(r#"{"id":"two words"}"#), Err(Unread::Malformed(words)) if words.contains("1 to 128 visible")));
        assert!(matches!(said(r#"{"id":7}"#), Err(Unread::Unusable(_))));
    }

    #[test]
    fn a_cell_must_be_within_reach() {
        assert_eq!(goto(-8192, 8192), Ok(Command::Goto(Cell::new(-8192, 8192))));
        for (x, y) in [(8193, 0), (0, -8193), (i64::MIN, 0), (0, i64::MAX), (i64::from(i32::MIN), 0)] {
            assert!(goto(x, y).is_err(), "({x}, {y})");
        }
    }

    #[test]
    fn a_temperature_is_a_reading_or_a_word_and_never_both() {
        let report = |json: &str| body::<TemperatureBody>(json.as_bytes()).unwrap().report();
        assert_eq!(report(r#"{"status":"tooHigh"}"#), Ok(TemperatureReport::TooHigh));
        assert!(matches!(report(r#"{"celsius":21.5}"#), Ok(TemperatureReport::Reading(_))));
        assert!(
            matches!(report(r#"{"celsius":21.5,"sensor":"roof"}"#), Ok(TemperatureReport::Sensor(name, _)) if &*name == "roof")
        );
        for wrong in [r#"{}"#, r#"{"celsius":1,"status":"ok"}"#, r#"{"celsius":1e9}"#, r#"{"status":"warm"}"#] {
            assert!(report(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_sensor_has_a_name_of_its_own_and_reads_degrees_that_can_be() {
        let report = |json: &str| body::<TemperatureBody>(json.as_bytes()).unwrap().report();
        let long = "x".repeat(65);
        for name in ["", " ", "two words", "a,b", "bell\\u0007", "operator", "robot", "others", &long] {
            let said = report(&format!(r#"{{"celsius":21.5,"sensor":"{name}"}}"#)).unwrap_err().to_string();
            assert!(said.contains("sensor is 1 to 64 visible characters"), "{name}: {said}");
        }
        assert!(report(&format!(r#"{{"celsius":21.5,"sensor":"{}"}}"#, &long[1..])).is_ok());
        for wrong in [r#"{"celsius":-300,"sensor":"roof"}"#, r#"{"status":"ok","sensor":"roof"}"#, r#"{"sensor":"roof"}"#] {
            assert!(report(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_unknown_strategy_is_told_which_there_are() {
        let sentence = body::<StrategyBody>(br#"{"name":"worm"}"#).unwrap().strategy().unwrap_err().to_string();
        assert!(sentence.contains("\"worm\"") && sentence.contains("snail"), "{sentence}");
    }
}
