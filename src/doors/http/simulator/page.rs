//! The page of the simulator's controls. Every button is an HTML form, so the page works without scripts. A refusal
//! is shown beside its button.

use std::collections::BTreeSet;
use std::sync::Arc;

use askama::Template;
use axum::response::{Html, IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::super::console::html;
use super::super::problem::Problem;
use super::super::reading::{Form, needed};
use super::Asker;
use crate::api::door;
use crate::api::fields::in_short;
use crate::api::simulator::pace;
use crate::phrases::{Language, Markup, Phrase};
use crate::runtime::simulator::{Change, HallSource, OtherHall, SimulatorState, Speed};
use hallsweep_core::robot::RobotState;
use hallsweep_core::snapshot::robot::RobotView;
use hallsweep_core::units::Cell;

/// The speeds that the page offers. The interface also accepts speeds between these.
const SPEEDS: [&str; 8] = ["0.1", "0.5", "1", "2", "5", "10", "50", "max"];

struct Fault {
    name: &'static str,
    is_there: bool,
}

#[derive(Template)]
#[template(path = "simulator/page.html")]
struct SimulatorPage {
    language: Language,
    state: Arc<SimulatorState>,
    halls: Vec<String>,
    bound: Option<String>,
    may_act: bool,
    why: Option<(&'static str, String)>,
}

impl SimulatorPage {
    fn of(asker: &Asker, why: Option<(&'static str, String)>) -> SimulatorPage {
        SimulatorPage {
            language: asker.language,
            state: asker.state(),
            halls: asker.simulator.halls(),
            bound: asker.bound_in_words(),
            may_act: asker.may_act(),
            why,
        }
    }

    fn why(&self, place: &str) -> &str {
        self.why.as_ref().filter(|(of, _)| *of == place).map_or("", |(_, words)| words)
    }

    fn speeds(&self) -> Vec<(String, bool)> {
        let now = self.state.speed.to_string();
        let other = (!SPEEDS.contains(&now.as_str())).then(|| now.clone());
        other.into_iter().chain(SPEEDS.map(str::to_owned)).map(|speed| (speed.clone(), speed == now)).collect()
    }

    fn runs(&self) -> Phrase<'_> {
        match (self.state.is_paused, self.state.speed) {
            (true, _) => self.language.say("simulator-paused"),
            (false, Speed::Max) => self.language.say("simulator-runs-max"),
            (false, Speed::Times(factor)) => {
                self.language.say("simulator-runs").with("factor", self.language.number(&factor.to_string()))
            }
        }
    }

    fn hall_now(&self) -> Markup {
        let (hall, (columns, rows)) = (&self.state.hall, self.state.hall.size);
        let said = self.language.say("simulator-hall-now").with("hall", &hall.name).with("columns", columns).with("rows", rows);
        let said = said.with("side", self.language.number(&hall.cell_m.to_string())).with("pieces", hall.pieces);
        said.with("seed", self.state.seed).markup()
    }

    fn faults(&self) -> [Fault; 3] {
        let faults = &self.state.faults;
        [
            Fault { name: "linkLost", is_there: faults.link_lost },
            Fault { name: "noThermometer", is_there: faults.no_thermometer },
            Fault { name: "cameraFails", is_there: faults.camera_fails },
        ]
    }
}

pub(in crate::doors::http) async fn page(asker: Asker) -> Html<String> {
    html(&SimulatorPage::of(&asker, None))
}

/// The fields of all forms on the page, except the form with the hall.
#[derive(Debug, Default, Deserialize)]
pub(in crate::doors::http) struct Fields {
    act: String,
    speed: Option<String>,
    fault: Option<String>,
    x: Option<String>,
    y: Option<String>,
}

pub(in crate::doors::http) async fn change_by_form(asker: Asker, Form(fields): Form<Fields>) -> Response {
    let issuer = asker.issuer(door::CONSOLE);
    let simulator = Arc::clone(&asker.simulator);
    let done = match fields.act.as_str() {
        "step" => Asker::done(simulator.step(issuer)).await,
        _ => match fields.change(&asker) {
            Ok(change) => Asker::done(simulator.change(change, issuer)).await,
            Err(problem) => Err(problem),
        },
    };
    answer(&asker, fields.place(), done.err())
}

#[derive(Debug, Deserialize)]
pub(in crate::doors::http) struct HallFields {
    name: String,
    seed: Option<String>,
}

pub(in crate::doors::http) async fn choose_by_form(asker: Asker, Form(fields): Form<HallFields>) -> Response {
    let seed = fields.seed.as_deref().map(str::trim).filter(|seed| !seed.is_empty());
    let wrong = |seed: &str| Problem::unusable(format!("seed is {:?}: enter a whole number from 0", in_short(seed)));
    let seed = seed.map(|seed| seed.parse().map_err(|_| wrong(seed))).transpose();
    let done = match seed {
        Ok(seed) => {
            let hall = OtherHall { source: HallSource::Named(fields.name), seed };
            Asker::done(Arc::clone(&asker.simulator).put_down(hall, asker.issuer(door::CONSOLE))).await
        }
        Err(problem) => Err(problem),
    };
    answer(&asker, "hall", done.err())
}

fn answer(asker: &Asker, place: &'static str, problem: Option<Problem>) -> Response {
    let Some(problem) = problem else { return Redirect::to("/simulator").into_response() };
    let page = SimulatorPage::of(asker, Some((place, asker.in_words(&problem))));
    let mut response = (problem.status(), html(&page)).into_response();
    problem.tell_gate(&mut response);
    response
}

impl Fields {
    fn place(&self) -> &'static str {
        match self.act.as_str() {
            "block" | "blockAhead" | "free" | "freeAll" => "way",
            "fault" | "mend" => "faults",
            _ => "time",
        }
    }

    fn change(&self, asker: &Asker) -> Result<Change, Problem> {
        let blocked = || asker.state().faults.blocked.clone();
        let change = Change::default();
        Ok(match self.act.as_str() {
            "pause" => Change { is_paused: Some(true), ..change },
            "goOn" => Change { is_paused: Some(false), ..change },
            "speed" => Change { speed: Some(pace(needed("speed", self.speed.as_deref())?)?), ..change },
            "fault" => self.fault(true)?,
            "mend" => self.fault(false)?,
            "block" => Change { blocked: Some(with(blocked(), self.cell()?)), ..change },
            "blockAhead" => {
                let ahead = ahead(&asker.door.hall.handle.snapshot().robot);
                Change { blocked: Some(with(blocked(), ahead)), ..change }
            }
            "free" => {
                let cell = self.cell()?;
                Change { blocked: Some(blocked().into_iter().filter(|other| *other != cell).collect()), ..change }
            }
            "freeAll" => Change { blocked: Some(BTreeSet::new()), ..change },
            other => return Err(Problem::not_found(format!("the simulator has no button {:?}", in_short(other)))),
        })
    }

    fn fault(&self, is_so: bool) -> Result<Change, Problem> {
        let (is_so, change) = (Some(is_so), Change::default());
        match needed("fault", self.fault.as_deref())? {
            "linkLost" => Ok(Change { link_lost: is_so, ..change }),
            "noThermometer" => Ok(Change { no_thermometer: is_so, ..change }),
            "cameraFails" => Ok(Change { camera_fails: is_so, ..change }),
            other => {
                let words = format!("{:?} is no fault: the faults are linkLost, noThermometer, cameraFails", in_short(other));
                Err(Problem::unusable(words))
            }
        }
    }

    fn cell(&self) -> Result<Cell, Problem> {
        let side = |name: &str, text: Option<&str>| {
            let text = needed(name, text)?;
            text.parse().map_err(|_| Problem::unusable(format!("{name} is {:?}: enter a whole number", in_short(text))))
        };
        Ok(Cell::new(side("x", self.x.as_deref())?, side("y", self.y.as_deref())?))
    }
}

fn with(mut blocked: BTreeSet<Cell>, cell: Cell) -> BTreeSet<Cell> {
    blocked.insert(cell);
    blocked
}

/// Returns the cell ahead of a robot. If the robot is making a step, this is the cell ahead of the position after
/// that step.
fn ahead(robot: &RobotView) -> Cell {
    let steps = if robot.state == RobotState::MovingForward { 2 } else { 1 };
    let (Cell { x, y }, (dx, dy)) = (robot.pose.cell, robot.pose.heading.vector());
    Cell::new(x + dx * steps, y + dy * steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::searching;
    use hallsweep_core::units::Heading;

    #[test]
    fn the_way_ahead_is_beyond_the_step_under_way() {
        let mut robot = searching().robot;
        robot.pose.cell = Cell::new(3, 4);
        for (heading, state, expect) in [
            (Heading::North, RobotState::Stopped, Cell::new(3, 3)),
            (Heading::East, RobotState::MovingForward, Cell::new(5, 4)),
            (Heading::South, RobotState::RotateLeft, Cell::new(3, 5)),
            (Heading::West, RobotState::MovingForward, Cell::new(1, 4)),
        ] {
            (robot.pose.heading, robot.state) = (heading, state);
            assert_eq!(ahead(&robot), expect);
        }
    }
}
