//! Requests in the journal.

use std::time::Duration;

use serde_json::{Value, json};

use super::coded::{Coded, Valued};
use super::names::{self, Step};
use super::places::Point;
use super::{Unparsed, earlier};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, LuggageRef, TemperatureReport};
use hallsweep_core::simulated::{Change, Pace, Simulated};
use hallsweep_core::units::{AlarmId, LuggageId};

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
    match command {
        Command::Start => Coded::bare("start"),
        Command::Stop => Coded::bare("stop"),
        Command::BackHome => Coded::bare("backHome"),
        Command::Retrieve => Coded::bare("retrieve"),
        Command::Reset => Coded::bare("reset"),
        Command::Move(step) => Coded::new("move", json!({ "step": Step::from(*step) })),
        Command::Goto(cell) => Coded::new("goto", json!({ "cell": Point::from(*cell) })),
        Command::Verdict { luggage, verdict, note } => {
            let luggage = if let LuggageRef::Id(id) = luggage { Some(id.0) } else { None };
            let note = note.as_ref().map(|note| note.text());
            Coded::new("verdict", json!({ "luggage": luggage, "verdict": verdict.name(), "note": note }))
        }
        Command::RetakePhoto(id) => Coded::new("retake", json!({ "luggage": id.0 })),
        Command::Acknowledge(id) => Coded::new("acknowledge", json!({ "alarm": id.0 })),
        Command::ChooseStrategy(strategy) => Coded::new("strategy", json!({ "strategy": strategy.name() })),
        Command::Temperature(TemperatureReport::Ok) => Coded::bare("temperatureOk"),
        Command::Temperature(TemperatureReport::TooHigh) => Coded::bare("temperatureTooHigh"),
        Command::Temperature(TemperatureReport::Reading(celsius)) => {
            Coded::new("reading", json!({ "celsius": celsius.degrees() }))
        }
        Command::Temperature(TemperatureReport::Sensor(sensor, celsius)) => {
            Coded::new("sensorReading", json!({ "sensor": &**sensor, "celsius": celsius.degrees() }))
        }
    }
}

fn command(coded: &Coded) -> Result<Command, Unparsed> {
    let celsius = || names::celsius(coded.field("celsius")?);
    Ok(match &*coded.code {
        "start" => Command::Start,
        "stop" => Command::Stop,
        "backHome" => Command::BackHome,
        "retrieve" => Command::Retrieve,
        "reset" => Command::Reset,
        "move" => Command::Move(coded.field::<Step>("step")?.into()),
        "goto" => Command::Goto(coded.field::<Point>("cell")?.into()),
        "verdict" => Command::Verdict {
            luggage: coded.field::<Option<u64>>("luggage")?.map_or(LuggageRef::Pending, |id| LuggageRef::Id(LuggageId(id))),
            verdict: names::verdict(&coded.field::<String>("verdict")?)?,
            note: names::note(coded.field("note")?)?,
        },
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
        Pace::Times(factor) => Value::from(factor),
        Pace::Max => Value::from("max"),
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
        Some(Value::String(word)) if word == "max" => Some(Pace::Max),
        _ => coded.field::<Option<f64>>("speed")?.map(Pace::Times),
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
