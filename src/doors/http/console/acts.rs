//! Converts the fields of the page's forms to commands. It does not decide whether a command is allowed.

use serde::Deserialize;

use super::super::problem::Problem;
use super::super::reading::needed;
use crate::api::command::{self, AreaBody, CloseAreaBody, CloseBody, HandOverBody, OrderAreasBody, StrategyBody};
use crate::api::commands::{CommandKind, CommandRow};
use crate::api::fields::in_short;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::command::{Command, Hot, LuggageRef, Note, TemperatureReport, Verdict};
use hallsweep_core::units::{AlarmId, Epoch, LuggageId};

/// The fields of all forms of the page. A field that a form does not have is `None`.
#[derive(Debug, Default, Deserialize)]
pub(in crate::doors::http) struct Fields {
    epoch: Option<String>,
    id: Option<String>,
    #[serde(rename = "move")]
    word: Option<String>,
    x: Option<String>,
    y: Option<String>,
    #[serde(rename = "toX")]
    to_x: Option<String>,
    #[serde(rename = "toY")]
    to_y: Option<String>,
    name: Option<String>,
    status: Option<String>,
    celsius: Option<String>,
    note: Option<String>,
    luggage: Option<String>,
    hidden: Option<String>,
    obvious: Option<String>,
    typical: Option<String>,
    size: Option<String>,
    radius: Option<String>,
    open: Option<String>,
    to: Option<String>,
    mission: Option<String>,
    area: Option<String>,
    /// The names of the areas in the order of the page, one a line.
    areas: Option<String>,
    /// The name of the area that is to come one place earlier.
    earlier: Option<String>,
    later: Option<String>,
}

/// The remarks of the operator beside a verdict. They come from the query of the confirmation page (`?note=…`).
#[derive(Debug, Default, Deserialize)]
pub(in crate::doors::http) struct TypedRemarks {
    #[serde(default)]
    note: String,
    hidden: Option<String>,
    obvious: Option<String>,
    typical: Option<String>,
}

impl TypedRemarks {
    pub(super) fn remarks(&self) -> Result<(Option<Note>, Hot), Problem> {
        Ok((note(&self.note)?, hot([&self.hidden, &self.obvious, &self.typical])?))
    }
}

/// Returns the form actions of a command's buttons. A verdict has three buttons; every other command has one, with the
/// command's name.
pub(in crate::doors::http) fn buttons(command: &CommandRow) -> Vec<&'static str> {
    if command.kind == CommandKind::Verdict { vec!["safe", "danger", "unsure"] } else { vec![command.name] }
}

impl Fields {
    /// Returns the command of this form, and the epoch that the page showed when the form was sent.
    pub(super) fn command(&self, act: &str) -> Result<(Command, Option<Epoch>), Problem> {
        let epoch = self.epoch.as_deref().map(|text| number("epoch", text)).transpose()?.map(Epoch);
        let note = self.note.as_deref().map(one_line);
        let mission = || self.mission.as_deref().map(|text| number("mission", text)).transpose();
        let command = match act {
            "start" => Command::Start,
            "stop" => Command::Stop,
            "backHome" => Command::BackHome,
            "goOn" => Command::GoOn,
            "retrieve" => {
                let named = self.luggage.as_deref().map(|text| number("luggage", text)).transpose()?;
                Command::Retrieve(named.map(LuggageId))
            }
            "reset" => Command::Reset,
            "close" => {
                let name = one_line(needed("name", self.name.as_deref())?);
                let open_points = Some(needed("open", self.open.as_deref())?.to_owned());
                CloseBody { name, note, open_points }.command()?
            }
            "handOver" => {
                let to = one_line(needed("to", self.to.as_deref())?);
                HandOverBody { to, note, mission: mission()? }.command()?
            }
            "move" => command::move_word(needed("move", self.word.as_deref())?)?,
            "goto" => command::goto(whole("x", &self.x)?, whole("y", &self.y)?)?,
            "orderAreas" => self.area_order()?,
            "closeArea" => {
                let area = needed("area", self.area.as_deref())?.to_owned();
                let name = one_line(needed("name", self.name.as_deref())?);
                CloseAreaBody { area, name, note, mission: mission()? }.command()?
            }
            "searchAgain" => {
                let body = match self.area.clone() {
                    Some(area) => AreaBody::Named { area, epoch: None },
                    None => AreaBody::Corners {
                        x: whole("x", &self.x)?,
                        y: whole("y", &self.y)?,
                        to_x: whole("toX", &self.to_x)?,
                        to_y: whole("toY", &self.to_y)?,
                        epoch: None,
                    },
                };
                body.command()?.0
            }
            "safe" => self.answer(Some(Verdict::Safe))?,
            "danger" => self.answer(Some(Verdict::Danger))?,
            "unsure" => self.answer(None)?,
            "retake" => Command::RetakePhoto(LuggageId(self.id()?)),
            "acknowledge" => Command::Acknowledge(AlarmId(self.id()?)),
            "strategy" => Command::ChooseStrategy(self.strategy()?),
            "temperature" => Command::Temperature(self.temperature()?),
            other => return Err(Problem::not_found(format!("the console has no button {:?}", in_short(other)))),
        };
        Ok((command, epoch))
    }

    /// Returns what was sent with the form of a statement: the person in charge, the person who takes over, the note,
    /// the area, and what was open when the page was made.
    pub(super) fn stated(&self) -> [String; 5] {
        [&self.name, &self.to, &self.note, &self.area, &self.open].map(|typed| typed.clone().unwrap_or_default())
    }

    /// Returns the name of the place where the page shows a refusal: beside the pressed button.
    pub(super) fn button(&self, act: &str) -> String {
        match (act, &self.id) {
            ("safe" | "danger" | "unsure" | "retake", Some(_)) => "verdict".to_owned(),
            ("acknowledge", Some(id)) => format!("alarm-{id}"),
            ("move" | "goto", _) => "drive".to_owned(),
            _ if self.area.is_some() || self.areas.is_some() => "areas".to_owned(),
            // The place beside STOP is reserved for messages of the script, so a refusal is shown at the top of the
            // page.
            ("stop", _) => "page".to_owned(),
            _ => act.to_owned(),
        }
    }

    /// Returns the order on the page, with one area one place earlier or later.
    fn area_order(&self) -> Result<Command, Problem> {
        let areas = self.areas.as_deref().ok_or_else(|| Problem::unusable("areas is missing".to_owned()))?;
        let mut names: Vec<&str> = areas.lines().filter(|name| !name.is_empty()).collect();
        let place = |name: &Option<String>| names.iter().position(|known| Some(*known) == name.as_deref());
        let first = place(&self.earlier).and_then(|place| place.checked_sub(1));
        let first = first.or(place(&self.later)).filter(|first| first + 1 < names.len());
        if let Some(first) = first {
            names.swap(first, first + 1);
        }
        Ok(OrderAreasBody { areas: names.into_iter().map(str::to_owned).collect() }.command()?)
    }

    /// Returns the answer about a piece; without a verdict, the sender is unsure.
    fn answer(&self, verdict: Option<Verdict>) -> Result<Command, Problem> {
        let note = note(self.note.as_deref().unwrap_or_default())?;
        let hot = Hot { size: self.size()?, ..hot([&self.hidden, &self.obvious, &self.typical])? };
        Ok(command::answer(LuggageRef::Id(LuggageId(self.id()?)), verdict, note, hot)?)
    }

    /// Returns the size of the bomb: the chosen word of the list, or the typed number of metres.
    fn size(&self) -> Result<Option<BombSize>, Problem> {
        let typed = |field: &Option<String>| field.clone().map(|text| text.trim().to_owned()).filter(|text| !text.is_empty());
        let size = match (typed(&self.size), typed(&self.radius)) {
            (Some(_), Some(_)) => return Err(Problem::unusable("choose a size or type a radius, not both".to_owned())),
            (size, radius) => size.or(radius),
        };
        Ok(size.as_deref().map(command::bomb_size).transpose()?)
    }

    fn id(&self) -> Result<u64, Problem> {
        number("id", needed("id", self.id.as_deref())?)
    }

    fn strategy(&self) -> Result<hallsweep_core::command::Strategy, Problem> {
        let name = needed("name", self.name.as_deref())?.to_owned();
        Ok(StrategyBody { name }.strategy()?)
    }

    fn temperature(&self) -> Result<TemperatureReport, Problem> {
        match (self.status.as_deref(), self.celsius.as_deref()) {
            (Some("ok"), _) => Ok(TemperatureReport::Ok),
            (Some("tooHigh"), _) => Ok(TemperatureReport::TooHigh),
            (Some(other), _) => Err(Problem::unusable(format!("{:?} is no status: send ok or tooHigh", in_short(other)))),
            (None, degrees) => Ok(command::reading(number("celsius", &needed("celsius", degrees)?.replace(',', "."))?)?),
        }
    }
}

/// Returns the typed note as one line: each sequence of white space becomes one space.
fn note(typed: &str) -> Result<Option<Note>, Problem> {
    Ok(command::note(Some(&one_line(typed)))?)
}

fn one_line(typed: &str) -> String {
    typed.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Reads the answers to the three questions, in the order of `Hot::answers`. A form sends an empty text for a question
/// that was not answered.
fn hot([hidden, obvious, typical]: [&Option<String>; 3]) -> Result<Hot, Problem> {
    let answer = |question: &str, given: &Option<String>| {
        command::hot_answer(question, given.as_deref().filter(|given| !given.is_empty()))
    };
    let [hidden, obvious, typical] = [answer("hidden", hidden), answer("obvious", obvious), answer("typical", typical)];
    Ok(Hot { hidden: hidden?, obvious: obvious?, typical: typical?, size: None })
}

fn whole(name: &'static str, typed: &Option<String>) -> Result<i64, Problem> {
    number(name, needed(name, typed.as_deref())?)
}

fn number<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, Problem> {
    text.trim().parse().map_err(|_| Problem::unusable(format!("{name} is {:?}: enter a number", in_short(text))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::Method;
    use hallsweep_core::command::{Again, HotAnswer};
    use hallsweep_core::units::Cell;
    use hallsweep_core::world::hall_map::Bounds;

    #[test]
    fn every_form_is_understood_when_it_is_filled_in() {
        let fields = Fields {
            epoch: Some("4".to_owned()),
            id: Some("3".to_owned()),
            word: Some("w".to_owned()),
            x: Some("1".to_owned()),
            y: Some("-2".to_owned()),
            to_x: Some("0".to_owned()),
            to_y: Some("4".to_owned()),
            name: Some("snail".to_owned()),
            status: None,
            open: Some("1:0,0,3,0,0,0,0".to_owned()),
            to: Some("police".to_owned()),
            mission: Some("7".to_owned()),
            size: Some(String::new()),
            radius: Some(" ".to_owned()),
            luggage: Some("3".to_owned()),
            hidden: Some("no".to_owned()),
            obvious: Some("cannotSay".to_owned()),
            typical: Some(String::new()),
            celsius: Some("21,5".to_owned()),
            area: Some("gate 1".to_owned()),
            areas: Some("gate 2\r\ngate 1\r\nbar".to_owned()),
            earlier: Some("gate 1".to_owned()),
            later: None,
            note: Some(" a lunch\r\n\tbox".to_owned()),
        };
        let rows = super::super::super::routes::table();
        let acts = rows.iter().filter(|row| row.method == Method::POST);
        let acts = acts.filter_map(|row| row.path.strip_prefix("/console/"));
        for act in acts {
            assert_eq!(fields.command(act).map(|(_, epoch)| epoch).ok(), Some(Some(Epoch(4))), "{act}");
        }
        assert_eq!(fields.command("goto").unwrap().0, Command::Goto(Cell::new(1, -2)));
        let area = Bounds { least: Cell::new(0, -2), most: Cell::new(1, 4) };
        assert_eq!(fields.command("searchAgain").unwrap().0, Command::SearchAgain(Again::Area("gate 1".into())));
        let order = |names: [&str; 3]| Command::OrderAreas(names.map(Into::into).into());
        assert_eq!(fields.command("orderAreas").unwrap().0, order(["gate 1", "gate 2", "bar"]));
        let fields = Fields { area: None, earlier: Some("gate 2".to_owned()), ..fields };
        assert_eq!(fields.command("orderAreas").unwrap().0, order(["gate 2", "gate 1", "bar"]), "it is the first");
        let fields = Fields { earlier: None, later: Some("gate 1".to_owned()), ..fields };
        assert_eq!(fields.command("orderAreas").unwrap().0, order(["gate 2", "bar", "gate 1"]));
        let corners = Command::SearchAgain(Again::Within(area));
        assert_eq!(fields.command("searchAgain").unwrap().0, corners, "corners in any order");
        let (luggage, note) = (LuggageRef::Id(LuggageId(3)), Note::new("a lunch box"));
        let hot = Hot { hidden: Some(HotAnswer::No), obvious: Some(HotAnswer::CannotSay), ..Hot::NONE };
        let verdict = |verdict, hot| Command::Verdict { luggage, verdict, note: note.clone(), hot };
        assert_eq!(fields.command("safe").unwrap().0, verdict(Verdict::Safe, hot));
        let fields = Fields { size: Some("suitcase".to_owned()), ..fields };
        let sized = Hot { size: Some(BombSize::Suitcase), ..hot };
        assert_eq!(fields.command("danger").unwrap().0, verdict(Verdict::Danger, sized));
        assert!(fields.command("safe").unwrap_err().detail().contains("with the verdict danger only"));
    }

    #[test]
    fn what_is_missing_or_no_number_is_named() {
        let problem = Fields::default().command("goto").unwrap_err();
        assert!(problem.detail().contains("x is missing"), "{}", problem.detail());
        let fields = Fields { celsius: Some("warm".to_owned()), ..Fields::default() };
        assert!(fields.command("temperature").unwrap_err().detail().contains("\"warm\""));
        let with = |note: String| Fields { id: Some("3".to_owned()), note: Some(note), ..Fields::default() }.command("danger");
        assert!(with("x".repeat(501)).unwrap_err().detail().contains("501 characters: the limit is 500"));
        assert!(with("a\u{202e}b".to_owned()).unwrap_err().detail().contains("invisible"));
        let sized = |size: &str, radius: &str| {
            let (size, radius) = (Some(size.to_owned()), Some(radius.to_owned()));
            Fields { id: Some("3".to_owned()), size, radius, ..Fields::default() }.command("danger")
        };
        assert!(sized("", "12,5").unwrap_err().detail().contains("\"12,5\" is no size"));
        assert!(sized("car", "120").unwrap_err().detail().contains("not both"));
        assert!(matches!(with(" \n".to_owned()), Ok((Command::Verdict { note: None, .. }, _))), "a blank note is none");
    }
}
