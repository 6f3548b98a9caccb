//! The whole persistent state in the journal. A restarted program continues from this state.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::closing::{ClosedShape, OpenInAreaShape};
use super::coded::Form;
use super::conditions::ConditionsShape;
use super::coverage::{self, Looks};
use super::luggage::{AlarmShape, LuggageShape};
use super::map;
use super::names::SearchShape;
use super::phase::PhaseShape;
use super::places::{GoalShape, Point, PoseShape};
use super::retrieval::RetrievalShape;
use super::rows::Row;
use super::{Unparsed, names, retrieval};
use crate::api::is_default;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{AlarmId, LuggageId, MissionId, Piece};
use hallsweep_core::world::records::LuggageRecords;

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct StandingShape {
    mission: u64,
    under_way: bool,
    phase: PhaseShape,
    holds: Vec<String>,
    epoch: u64,
    strategy: String,
    search: SearchShape,
    goal: Option<GoalShape>,
    blocked: Vec<Point>,
    /// Cells that are to be searched again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    again: Vec<Point>,
    pose: PoseShape,
    /// Poses of all robots except the robot that searches.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    others: BTreeMap<String, PoseShape>,
    /// Distance from home of each robot outside the hall, in steps.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    outside: BTreeMap<String, u8>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    retrieval: Option<RetrievalShape>,
    /// Cells where a known piece was met again, each with the piece.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    met_again: Vec<(Point, u32)>,
    led_blinking: bool,
    map: Vec<Row<String>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    coverage: Vec<Looks>,
    pieces: Vec<u32>,
    luggage: Vec<LuggageShape>,
    last_luggage: u64,
    alarms: Vec<AlarmShape>,
    last_alarm: u64,
    reading: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    closed: Option<ClosedShape>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    area_order: Vec<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    closed_areas: BTreeMap<String, ClosedShape<OpenInAreaShape>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    conditions: Option<ConditionsShape>,
    #[serde(default, skip_serializing_if = "is_default")]
    clock_set_ms: i64,
}

impl StandingShape {
    pub(super) fn of(state: &PersistentState, form: Form) -> StandingShape {
        StandingShape {
            mission: state.mission.0,
            under_way: state.under_way,
            phase: PhaseShape::of(&state.phase, form),
            holds: state.holds.to_vec().into_iter().map(|hold| hold.name().to_owned()).collect(),
            epoch: state.epoch.0,
            strategy: state.strategy.name().to_owned(),
            search: (&state.search).into(),
            goal: state.goal.map(GoalShape::from),
            blocked: state.blocked.iter().copied().map(Point::from).collect(),
            again: state.again.iter().copied().map(Point::from).collect(),
            pose: state.pose.into(),
            others: state.others.iter().map(|(robot, pose)| (robot.name().to_owned(), (*pose).into())).collect(),
            outside: state.outside.iter().map(|(robot, steps)| (robot.name().to_owned(), *steps)).collect(),
            retrieval: state.retrieval.as_ref().map(|retrieval| RetrievalShape::of(retrieval, form)),
            met_again: state.met_again.iter().map(|(cell, piece)| (Point::from(*cell), piece.0)).collect(),
            led_blinking: state.led_blinking,
            map: map::rows(&state.map),
            coverage: coverage::rows(&state.coverage),
            pieces: state.pieces.iter().map(|piece| piece.0).collect(),
            luggage: state.luggage.iter().map(|record| LuggageShape::from(&**record)).collect(),
            last_luggage: state.last_luggage.0,
            alarms: state.alarms.iter().map(|alarm| AlarmShape::of(alarm, form)).collect(),
            last_alarm: state.last_alarm.0,
            reading: state.reading.map(hallsweep_core::units::Celsius::degrees),
            closed: state.closed.as_deref().map(ClosedShape::from),
            area_order: state.area_order.iter().map(ToString::to_string).collect(),
            closed_areas: state.closed_areas.iter().map(|(area, closed)| (area.to_string(), closed.into())).collect(),
            conditions: state.conditions.as_ref().map(ConditionsShape::from),
            clock_set_ms: state.clock_set_ms,
        }
    }

    pub(super) fn state(self) -> Result<PersistentState, Unparsed> {
        let closed_area = |(area, closed): (String, ClosedShape<OpenInAreaShape>)| Ok((names::area(area)?, closed.closed()?));
        Ok(PersistentState {
            mission: MissionId(self.mission),
            under_way: self.under_way,
            phase: self.phase.phase()?,
            holds: self.holds.iter().map(|name| names::hold(name)).collect::<Result<_, _>>()?,
            epoch: names::epoch(self.epoch)?,
            strategy: names::strategy(&self.strategy)?,
            search: self.search.search()?,
            goal: self.goal.map(Into::into),
            blocked: self.blocked.into_iter().map(Into::into).collect(),
            again: Arc::new(self.again.into_iter().map(Into::into).collect()),
            pose: self.pose.pose()?,
            others: self
                .others
                .iter()
                .map(|(robot, pose)| Ok((names::robot(robot)?, pose.pose()?)))
                .collect::<Result<_, Unparsed>>()?,
            outside: retrieval::outside(&self.outside)?,
            retrieval: self.retrieval.map(RetrievalShape::retrieval).transpose()?,
            met_again: self.met_again.into_iter().map(|(cell, piece)| (cell.into(), Piece(piece))).collect(),
            led_blinking: self.led_blinking,
            map: map::map(&self.map)?,
            coverage: coverage::coverage(&self.coverage)?,
            pieces: self.pieces.into_iter().map(Piece).collect(),
            luggage: records(self.luggage)?,
            last_luggage: LuggageId(self.last_luggage),
            alarms: self.alarms.into_iter().map(|alarm| alarm.alarm().map(Arc::new)).collect::<Result<_, _>>()?,
            last_alarm: AlarmId(self.last_alarm),
            reading: self.reading.map(names::celsius).transpose()?,
            closed: self.closed.map(ClosedShape::closed).transpose()?.map(Arc::new),
            area_order: names::areas(self.area_order)?,
            closed_areas: self.closed_areas.into_iter().map(closed_area).collect::<Result<_, Unparsed>>().map(Arc::new)?,
            conditions: self.conditions.map(ConditionsShape::conditions).transpose()?,
            clock_set_ms: self.clock_set_ms,
        })
    }
}

fn records(shapes: Vec<LuggageShape>) -> Result<LuggageRecords, Unparsed> {
    let mut records = LuggageRecords::default();
    for shape in shapes {
        let record = shape.record()?;
        if records.get(record.id).is_some() {
            return Err(Unparsed(format!("luggage #{} is recorded twice", record.id)));
        }
        records.insert(Arc::new(record));
    }
    Ok(records)
}
