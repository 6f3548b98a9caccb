//! Requests in the journal, each as a code with fields. Requests are commands, STOPs in quick succession, and changes
//! of the simulator.

use std::time::Duration;

use serde_json::{Value, json};

use super::coded::{Coded, Valued};
use super::names::{self, Step};
use super::places::{AgainShape, Point};
use super::{Unparsed, earlier};
use hallsweep_core::asked::Asked;
use hallsweep_core::closing::{AreaClosing, Closing};
use hallsweep_core::command::{Carries, Command, Hot, LuggageRef, Note, TemperatureReport};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::simulated::{Change, Simulated};
use hallsweep_core::speed::Speed;
use hallsweep_core::units::{AlarmId, LuggageId, MissionId};

impl Valued for Asked {
    fn coded(&self) -> Coded {
        match self {
            Asked::Command(command) => of_command(command),
            Asked::Stops { count, within } => {
                let within_ms = within.map(|within| u64::try_from(within.as_millis()).unwrap_or(u64::MAX));
                Coded::new("stops", json!({ "count": count, "withinMs": within_ms }))
            }
            Asked::Simulated(Simulated::Changed(change)) => of_change(change),
            Asked::Simulated(Simulated::Step) => Coded::bare("simulatorStep"),
            Asked::Simulated(Simulated::PutDown(hall)) => Coded::new("putDown", json!({ "hall": &**hall })),
            Asked::Simulated(Simulated::Kept(hall)) => Coded::new("hallKept", json!({ "hall": hall })),
            Asked::Simulated(Simulated::Discarded(hall)) => Coded::new("hallDiscarded", json!({ "hall": hall })),
            Asked::Many { last, more } => Coded::new("many", json!({ "last": last.coded(), "more": more })),
            Asked::Words(words) => Coded::new("words", json!({ "words": words })),
        }
    }

    fn value(coded: &Coded) -> Result<Asked, Unparsed> {
        Ok(match &*coded.code {
            "stops" => Asked::Stops {
                count: coded.field("count")?,
                within: coded.field::<Option<u64>>("withinMs")?.map(Duration::from_millis),
            },
            "simulatorChange" => Asked::Simulated(Simulated::Changed(change(coded)?)),
            "simulatorStep" => Asked::Simulated(Simulated::Step),
            "putDown" => Asked::Simulated(Simulated::PutDown(coded.field::<String>("hall")?.into())),
            "hallKept" => Asked::Simulated(Simulated::Kept(coded.field("hall")?)),
            "hallDiscarded" => Asked::Simulated(Simulated::Discarded(coded.field("hall")?)),
            "many" => Asked::Many { last: Box::new(Asked::value(&coded.field("last")?)?), more: coded.field("more")? },
            "words" => Asked::Words(coded.field("words")?),
            _ => Asked::Command(command(coded)?),
        })
    }

    fn earlier(sentence: &str) -> Option<Coded> {
        earlier::asked(sentence)
    }

    fn words(words: String) -> Asked {
        Asked::Words(words)
    }
}

fn of_command(command: &Command) -> Coded {
    let code = command.code();
    match command.carries() {
        Carries::Nothing => Coded::bare(code),
        Carries::Luggage(id) => Coded::new(code, json!({ "luggage": id.0 })),
        Carries::Alarm(id) => Coded::new(code, json!({ "alarm": id.0 })),
        Carries::Move(step) => Coded::new(code, json!({ "step": Step::from(step) })),
        Carries::Cell(cell) => Coded::new(code, json!({ "cell": Point::from(cell) })),
        Carries::Verdict(luggage, verdict, note, hot) => {
            let mut fields = answer(luggage, note, hot);
            fields["verdict"] = verdict.name().into();
            Coded::new(code, fields)
        }
        Carries::Closing(Closing { name, note, seen }) => {
            let note = note.as_ref().map(Note::text);
            Coded::new(code, json!({ "name": name.text(), "note": note, "openPoints": &**seen }))
        }
        Carries::HandOver(HandOver { mission, to, note }) => {
            let mission = mission.map(|mission| mission.0);
            Coded::new(code, json!({ "mission": mission, "to": to.text(), "note": note.as_ref().map(Note::text) }))
        }
        Carries::Again(again) => Coded::new(code, json!({ "area": AgainShape::from(again) })),
        Carries::Areas(names) => Coded::new(code, json!({ "areas": names.iter().map(|name| &**name).collect::<Vec<_>>() })),
        Carries::AreaClosing(AreaClosing { area, name, note, mission }) => {
            let (mission, note) = (mission.map(|mission| mission.0), note.as_ref().map(Note::text));
            Coded::new(code, json!({ "area": &**area, "name": name.text(), "note": note, "mission": mission }))
        }
        Carries::Unsure(luggage, note, hot) => Coded::new(code, answer(luggage, note, hot)),
        Carries::Strategy(strategy) => Coded::new(code, json!({ "strategy": strategy.name() })),
        Carries::Temperature(TemperatureReport::Ok) => Coded::bare("temperatureOk"),
        Carries::Temperature(TemperatureReport::TooHigh) => Coded::bare("temperatureTooHigh"),
        Carries::Temperature(TemperatureReport::Reading(celsius)) => {
            Coded::new("reading", json!({ "celsius": celsius.degrees() }))
        }
        Carries::Temperature(TemperatureReport::Sensor(sensor, celsius)) => {
            Coded::new("sensorReading", json!({ "sensor": &**sensor, "celsius": celsius.degrees() }))
        }
    }
}

fn answer(luggage: LuggageRef, note: Option<&Note>, hot: Hot) -> Value {
    let luggage = if let LuggageRef::Id(id) = luggage { Some(id.0) } else { None };
    let mut fields = json!({ "luggage": luggage, "note": note.map(|note| note.text()) });
    for (question, answer) in hot.answers() {
        if let Some(answer) = answer {
            fields[question] = answer.name().into();
        }
    }
    if let Some(size) = hot.size {
        fields["size"] = size.to_string().into();
    }
    fields
}

fn command(coded: &Coded) -> Result<Command, Unparsed> {
    let celsius = || names::celsius(coded.field("celsius")?);
    let hot_answer = |question| coded.field::<Option<String>>(question)?.map(|answer| names::hot_answer(&answer)).transpose();
    let note = || names::note(coded.field("note")?);
    let name = |field| names::name(coded.field(field)?);
    let mission = || Ok::<_, Unparsed>(coded.field::<Option<u64>>("mission")?.map(MissionId));
    let luggage = || {
        let id = coded.field::<Option<u64>>("luggage")?;
        Ok::<_, Unparsed>(id.map_or(LuggageRef::Pending, |id| LuggageRef::Id(LuggageId(id))))
    };
    let hot = || {
        let size = coded.field::<Option<String>>("size")?.map(|size| names::bomb_size(&size)).transpose()?;
        let [hidden, obvious, typical] = ["hidden", "obvious", "typical"].map(hot_answer);
        Ok::<_, Unparsed>(Hot { hidden: hidden?, obvious: obvious?, typical: typical?, size })
    };
    if let Some(bare) = Command::BARE.into_iter().find(|bare| bare.code() == coded.code) {
        return Ok(bare);
    }
    Ok(match &*coded.code {
        "retrieve" => Command::Retrieve(coded.field::<Option<u64>>("luggage")?.map(LuggageId)),
        "move" => Command::Move(coded.field::<Step>("step")?.into()),
        "goto" => Command::Goto(coded.field::<Point>("cell")?.into()),
        "verdict" => Command::Verdict {
            luggage: luggage()?,
            verdict: names::verdict(&coded.field::<String>("verdict")?)?,
            note: note()?,
            hot: hot()?,
        },
        "unsure" => Command::Unsure { luggage: luggage()?, note: note()?, hot: hot()? },
        "close" => {
            let seen = coded.field::<String>("openPoints")?.into();
            Command::Close(Closing { name: name("name")?, note: note()?, seen })
        }
        "handOver" => Command::HandOver(HandOver { mission: mission()?, to: name("to")?, note: note()? }),
        "searchAgain" => Command::SearchAgain(coded.field::<AgainShape>("area")?.again()?),
        "orderAreas" => Command::OrderAreas(names::areas(coded.field("areas")?)?),
        "closeArea" => {
            let area = names::area(coded.field("area")?)?;
            Command::CloseArea(AreaClosing { area, name: name("name")?, note: note()?, mission: mission()? })
        }
        "retake" => Command::RetakePhoto(LuggageId(coded.field("luggage")?)),
        "acknowledge" => Command::Acknowledge(AlarmId(coded.field("alarm")?)),
        "strategy" => Command::ChooseStrategy(names::strategy(&coded.field::<String>("strategy")?)?),
        "temperatureOk" => Command::Temperature(TemperatureReport::Ok),
        "temperatureTooHigh" => Command::Temperature(TemperatureReport::TooHigh),
        "reading" => Command::Temperature(TemperatureReport::Reading(celsius()?)),
        "sensorReading" => {
            Command::Temperature(TemperatureReport::Sensor(names::sensor(&coded.field::<String>("sensor")?)?, celsius()?))
        }
        _ => return coded.unknown(),
    })
}

fn of_change(Change { speed, is_paused, link_lost, no_thermometer, camera_fails, blocked }: &Change) -> Coded {
    let speed = speed.map(|speed| match speed {
        Speed::Times(factor) => Value::from(factor),
        Speed::Max => Value::from("max"),
    });
    let blocked = blocked.as_ref().map(|cells| cells.iter().copied().map(Point::from).collect::<Vec<_>>());
    let fields = json!({
        "paused": is_paused, "speed": speed, "linkLost": link_lost, "noThermometer": no_thermometer,
        "cameraFails": camera_fails, "blocked": blocked,
    });
    Coded::new("simulatorChange", fields)
}

fn change(coded: &Coded) -> Result<Change, Unparsed> {
    let speed = match coded.field::<Option<Value>>("speed")? {
        Some(Value::String(word)) if word == "max" => Some(Speed::Max),
        _ => coded.field::<Option<f64>>("speed")?.map(Speed::Times),
    };
    let blocked = coded.field::<Option<Vec<Point>>>("blocked")?;
    Ok(Change {
        speed,
        is_paused: coded.field("paused")?,
        link_lost: coded.field("linkLost")?,
        no_thermometer: coded.field("noThermometer")?,
        camera_fails: coded.field("cameraFails")?,
        blocked: blocked.map(|cells| cells.into_iter().map(Into::into).collect()),
    })
}
