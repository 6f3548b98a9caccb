//! Finds the rule of the transition table that applies. It tests guards and cases against the state, and changes
//! nothing.

use std::sync::Arc;

use super::Engine;
use crate::command::{Again, Door, Move, Request, Verdict};
use crate::hold::Hold;
use crate::mission::{Act, Case, Guard, Input, InputContext, Rule, To, rules};
use crate::phase::{FaultCause, PhaseName};
use crate::refused::Refused;
use crate::search::plan::after;
use crate::settings::{AfterDanger, HotRule, SafeBy};
use crate::state::{Inspection, PersistentState, Phase, Stage};
use crate::units::{Cell, Epoch, LuggageId};
use crate::world::hall_map::Mark;

const NO_KEY: &str = "safe and unsure need a key, because two judges answer, and CoAP has no keys: use the console, HTTP or MQTT";

#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) to: To,
    pub(super) acts: &'static [Act],
    /// Number of interruptions between the present phase and the phase that the step concerns.
    pub(super) depth: usize,
}

pub(super) type RefusedStep = (Refused, &'static [Act]);

impl Engine {
    pub(super) fn decide(&self, input: Input, context: &InputContext) -> Result<Step, RefusedStep> {
        let mut phase = &self.state.phase;
        let mut depth = 0;
        loop {
            for rule in rules(phase.name(), input) {
                match *rule {
                    Rule::RefuseIf(guard) | Rule::Never(guard) => {
                        self.guard(guard, phase, input, context).map_or(Ok(()), |refused| Err((refused, &[][..])))?
                    }
                    Rule::RefuseIfThen(guard, acts) => {
                        self.guard(guard, phase, input, context).map_or(Ok(()), |refused| Err((refused, acts)))?
                    }
                    Rule::When(case, to, acts) if self.case(case, phase, context) => return Ok(Step { to, acts, depth }),
                    Rule::When(..) | Rule::AsInterrupted => {}
                    Rule::Go(to, acts) => return Ok(Step { to, acts, depth }),
                }
            }
            let Some(interrupted) = phase.interrupted() else { return Ok(Step { to: To::Stay, acts: &[], depth }) };
            (phase, depth) = (interrupted, depth + 1);
        }
    }

    /// Refuses a movement command that was sent, or may have been sent, before the last stop (safety S4). Other
    /// commands are never refused as outdated.
    pub(super) fn refuse_outdated(&self, input: Input, request: &Request, sent: Option<Epoch>) -> Result<(), Refused> {
        let moves = matches!(
            input,
            Input::Start | Input::BackHome | Input::GoOn | Input::Retrieve | Input::Move | Input::Goto | Input::SearchAgain
        );
        match sent {
            _ if moves && request.is_again && request.epoch.is_none() => Err(Refused::SentBefore),
            Some(sent) if moves && sent < self.state.epoch => Err(Refused::Outdated { sent, now: self.state.epoch }),
            Some(_) | None => Ok(()),
        }
    }

    fn guard(&self, guard: Guard, phase: &Phase, input: Input, context: &InputContext) -> Option<Refused> {
        let (mission, luggage) = (self.state.mission, context.luggage.and_then(|id| self.state.luggage.get(id)));
        let forbids = |yes: bool, refused: Refused| yes.then_some(refused);
        let area = |is_meant: &dyn Fn(&str) -> bool| context.areas.iter().find(|name| is_meant(name)).cloned();
        match guard {
            Guard::Held => self.held(self.state.holds.standing_against_start()),
            Guard::ExerciseOver => forbids(self.is_exercise_begun(), Refused::ExerciseOver),
            Guard::NoMission if !self.state.under_way => Some(Refused::NotInPhase(phase.name())),
            Guard::NoMission => forbids(context.mission.is_some_and(|named| named != mission), Refused::OtherMission(mission)),
            Guard::NotInPhase => Some(Refused::NotInPhase(phase.name())),
            Guard::VerdictAwaited => self.verdict_awaited(phase, input).map(Refused::VerdictPending),
            Guard::VerdictPending => self.first_pending(false).map(Refused::VerdictPending),
            Guard::OperatorAsked => {
                let is_viewing = phase.inspection().is_some_and(Inspection::is_viewing);
                self.asked().filter(|_| !is_viewing).map(Refused::VerdictPending)
            }
            Guard::Driving => Some(Refused::Driving),
            Guard::NotStopped => forbids(!self.state.holds.contains(Hold::Operator), Refused::NotStopped),
            Guard::IntoObstacle => {
                // The cell that a single move would enter, or the destination of a goto.
                let pose = self.state.pose;
                let entered = context.cell.or(context.step.map(|step| after(pose, step).cell)).filter(|cell| *cell != pose.cell);
                entered.filter(|cell| self.state.map.at(*cell).is_obstacle()).map(Refused::IntoObstacle)
            }
            Guard::NotCapable => {
                let is_nudge = matches!(context.step, Some(Move::NudgeLeft | Move::NudgeRight));
                let can_nudge = self.robots.searching().controller.capabilities.is_some_and(|can| can.nudges);
                forbids(is_nudge && !can_nudge, Refused::NotCapable)
            }
            Guard::Moving => {
                let is_about_to = self.state.phase.is_motion() && self.state.holds.is_empty();
                forbids(is_about_to || !self.robots.moving().is_empty(), Refused::Moving)
            }
            Guard::Unrecorded => {
                let is_photo_awaited = matches!(self.stage(), Some(Stage::TakingPhoto));
                forbids(!self.mission.recording.is_empty() || is_photo_awaited, Refused::Unrecorded)
            }
            Guard::BombUnfetched => {
                let mut bombs = self.state.luggage.bombs_left().map(|luggage| luggage.id);
                let unseen = |id: LuggageId| {
                    self.state.alarms.iter().any(|alarm| alarm.luggage == Some(id) && alarm.acknowledged.is_none())
                };
                bombs.find(|id| unseen(*id)).map(Refused::BombUnfetched)
            }
            Guard::UnknownLuggage => match context.luggage {
                None => Some(Refused::NothingPending),
                Some(id) => forbids(luggage.is_none(), Refused::UnknownLuggage(id)),
            },
            Guard::NotABomb => match (context.luggage, luggage) {
                (Some(id), None) => Some(Refused::UnknownLuggage(id)),
                (Some(id), Some(luggage)) => forbids(!luggage.is_bomb_left(), Refused::NotABomb(id)),
                (None, _) => None,
            },
            Guard::Decided => self.decided(input, context),
            Guard::NoKey => {
                let is_without = context.issuer.as_ref().is_some_and(|issuer| issuer.door == Door::COAP);
                forbids(is_without && self.settings.rules.safe_by == SafeBy::Two, Refused::NotAllowed(NO_KEY.to_owned()))
            }
            Guard::NoPhoto => luggage.filter(|luggage| !luggage.has_photo()).map(|luggage| Refused::NoPhoto(luggage.id)),
            Guard::HotUnanswered => {
                let is_missing =
                    self.settings.rules.hot == HotRule::Required && !context.hot.is_complete() && !self.has_answered(context);
                context.luggage.filter(|_| is_missing).map(Refused::HotUnanswered)
            }
            Guard::NotInspected => self.not_inspected(phase, input, context),
            Guard::PhotoUnderWay => {
                let is_under_way = matches!(self.stage(), Some(Stage::RetakingPhoto(_) | Stage::Viewing(_)));
                forbids(is_under_way, Refused::PhotoUnderWay)
            }
            Guard::PhotoHeld => {
                let holds = [Hold::RobotLink, Hold::Store].into_iter();
                self.held(holds.filter(|hold| self.state.holds.contains(*hold)).collect())
            }
            Guard::StoreDown => forbids(self.state.holds.contains(Hold::Store), Refused::StoreDown),
            Guard::UnknownAlarm => context.alarm.filter(|id| !self.is_on_record(*id)).map(Refused::UnknownAlarm),
            Guard::NoRetrievalRobot => forbids(self.fetchers().is_none(), Refused::NoRetrievalRobot),
            Guard::FetcherUnreached => self.unreached().map(Refused::FetcherUnreached),
            Guard::FetcherAbroad => self.abroad(phase).map(Refused::FetcherAbroad),
            Guard::UnknownSensor => {
                let sensor = context.reading.as_ref().map(|(sensor, _)| sensor);
                sensor.filter(|sensor| !self.watchdog.watches(sensor)).map(|sensor| Refused::UnknownSensor(Arc::clone(sensor)))
            }
            Guard::OpenUnseen => self.open_unseen(phase, context),
            Guard::AreaUnfit => self.area_unfit(context.again.as_ref()?),
            Guard::UnknownArea => area(&|name| self.state.area(name).is_none()).map(Refused::UnknownArea),
            Guard::AreaClosed => area(&|name| self.state.closed_areas.contains_key(name)).map(Refused::AreaClosed),
            Guard::FaultStands => self.fault_stands(phase).map(|cause| Refused::FaultStands(cause.clone())),
        }
    }

    /// Refuses a command about a piece that is decided or not in front of the robot.
    fn not_inspected(&self, phase: &Phase, input: Input, context: &InputContext) -> Option<Refused> {
        let Some(id) = context.luggage else { return Some(Refused::NothingPending) };
        if self.state.luggage.get(id).is_none() {
            return Some(Refused::UnknownLuggage(id));
        }
        // The photo may have been taken when another robot searched. The present robot may stand in another place.
        let is_before = phase
            .inspection()
            .is_some_and(|inspection| inspection.pose == self.state.pose || matches!(inspection.stage, Stage::Viewing(_)));
        let is_open = self.inspected() == Some(id) && self.decided(input, context).is_none();
        (!is_before || !is_open).then_some(Refused::NotInspected(id))
    }

    fn open_unseen(&self, phase: &Phase, context: &InputContext) -> Option<Refused> {
        if !self.state.under_way {
            return Some(Refused::NotInPhase(phase.name()));
        }
        let (mission, open) =
            (self.state.mission, self.open_points(&self.state.map, &self.state.luggage, self.state.again.len()));
        let seen = context.closing.as_ref().map(|closing| &*closing.seen)?;
        let is_seen = seen == open.code(mission) || seen.is_empty() && open.is_empty();
        (!is_seen).then(|| Refused::OpenPoints { mission, open: Box::new(open) })
    }

    /// Refuses an area without a searched cell, and an area that would make the list of cells too long. Cells that are
    /// on the list already may be named again. A closed area may always be named to open it.
    fn area_unfit(&self, again: &Again) -> Option<Refused> {
        match again {
            Again::Area(name) if self.state.area(name).is_none() => return Some(Refused::UnknownArea(Arc::clone(name))),
            Again::Area(name) if self.state.closed_areas.contains_key(name) => return None,
            Again::Area(_) | Again::Within(_) => {}
        }
        let (noted, most) = (&self.state.again, PersistentState::MOST_AGAIN);
        let fresh = self.state.searched_in(again).filter(|cell| !noted.contains(cell)).take(most + 1).count();
        if fresh + noted.len() > most {
            return Some(Refused::AreaTooLarge(most));
        }
        self.state.searched_in(again).next().is_none().then_some(Refused::NothingSearched)
    }

    /// The piece that an exploring robot waits for. In some phases only these two commands explore.
    fn verdict_awaited(&self, phase: &Phase, input: Input) -> Option<LuggageId> {
        let explores = match phase.underlying() {
            Phase::Exploring | Phase::AtHome => true,
            Phase::BombLocated | Phase::BagSecured => matches!(input, Input::GoOn | Input::SearchAgain),
            Phase::Explored => input == Input::SearchAgain,
            Phase::Idle
            | Phase::Inspecting(_)
            | Phase::Driving { .. }
            | Phase::ReturningHome
            | Phase::ReturningWithAlarm
            | Phase::Retrieving
            | Phase::Fault { .. } => false,
        };
        self.first_pending(true).filter(|_| explores)
    }

    pub(super) fn goes_on(&self) -> bool {
        self.settings.rules.after_danger == AfterDanger::GoOn
    }

    fn held(&self, holds: Vec<Hold>) -> Option<Refused> {
        let store_failure = self.world.store_failure.clone().filter(|_| holds.contains(&Hold::Store));
        (!holds.is_empty()).then_some(Refused::Held(holds, store_failure))
    }

    fn case(&self, case: Case, phase: &Phase, context: &InputContext) -> bool {
        match case {
            Case::ToBeInspected => context.cell.is_some_and(|cell| self.state.map.at(cell) == Mark::NotInspected),
            Case::BackedUp => self.stage() == Some(Stage::BackingUp) && !self.robots.searching().off_centre,
            Case::FirstPhoto => self.stage() == Some(Stage::TakingPhoto),
            Case::ThisPiece => matches!(phase, Phase::Inspecting(inspection) if inspection.luggage() == context.luggage),
            Case::SameVerdict => {
                let verdict = context.luggage.and_then(|id| self.verdict_kept(id).or_else(|| self.mission.deciding(id)));
                context.verdict.is_some() && verdict == context.verdict && !self.names_another_size(context)
            }
            Case::FirstJudge => self.settings.rules.safe_by == SafeBy::Two && !self.is_second_judge(context),
            Case::FromIdle => matches!(phase.underlying(), Phase::Idle),
            Case::RobotAtHome => self.rests_at_home(),
            Case::KeptOutLeft => {
                let is_kept_out = |cell: &Cell| self.planner.keep_out.contains(*cell);
                self.unsearched_in_rings(&self.state.map) > 0 || self.state.again.iter().any(is_kept_out)
            }
            Case::BombLeft => self.state.luggage.bombs_left().next().is_some(),
            Case::GoesOn => self.goes_on(),
            Case::GoesOnFromHere => self.goes_on() && self.case(Case::ThisPiece, phase, context),
            Case::SearchUnderWay => self.state.led_blinking,
        }
    }

    /// Whether the sender gives a bomb another size than the verdict has. A verdict is final, and so is its size.
    fn names_another_size(&self, context: &InputContext) -> bool {
        let stored = context.luggage.and_then(|id| self.state.luggage.get(id)?.verdict.as_ref()).map(|decision| decision.hot);
        let hot = stored.or_else(|| {
            self.mission.deciding.iter().find(|deciding| Some(deciding.luggage) == context.luggage).map(|deciding| deciding.hot)
        });
        context.hot.size.is_some() && hot.is_some_and(|hot| hot.size != context.hot.size)
    }

    /// Returns the refusal of a verdict if the piece already has a verdict, even one that is not stored yet. There is
    /// one exception: a danger may replace a safe that is not stored yet.
    fn decided(&self, input: Input, context: &InputContext) -> Option<Refused> {
        let luggage = context.luggage?;
        // To an unsure judge, a verdict that is not stored yet would tell what the others have answered.
        let deciding = self.mission.deciding(luggage).filter(|_| input != Input::Unsure);
        let in_flight = || deciding.filter(|verdict| *verdict == Verdict::Danger || input != Input::Danger);
        self.verdict_kept(luggage).or_else(in_flight).map(|verdict| Refused::Decided { luggage, verdict })
    }

    fn first_pending(&self, with_photo: bool) -> Option<LuggageId> {
        self.state.luggage.pending().find(|luggage| !with_photo || luggage.has_photo()).map(|luggage| luggage.id)
    }

    /// Returns the piece in front of the robot if it waits for its verdict, even while the inspection is interrupted.
    pub(super) fn asked(&self) -> Option<LuggageId> {
        self.inspected().filter(|id| self.state.luggage.get(*id).is_some_and(|luggage| luggage.is_pending()))
    }

    /// Returns the cause of the fault if this cause persists, so that START must be refused. A cell that was free and
    /// is now blocked does not count, because the robot may try it again.
    pub(super) fn fault_stands<'a>(&self, phase: &'a Phase) -> Option<&'a FaultCause> {
        let cause = phase.fault()?;
        let stands = match cause {
            FaultCause::NoWayHome => {
                let is_shut = self.state.map.at(Cell::HOME).is_obstacle() || !self.knows_way_home();
                self.state.blocked.is_empty() && is_shut
            }
            FaultCause::Undecided => true,
            FaultCause::NotFetched(_) => self.unreached().is_some(),
            FaultCause::Unanswered | FaultCause::Robot(_) => self.robots.searching().controller.capabilities.is_none(),
        };
        stands.then_some(cause)
    }

    pub(super) fn phase_name(&self) -> PhaseName {
        self.state.phase.name()
    }
}
