//! Transitions between phases, and the data that each phase takes from the phase before.

use super::Engine;
use super::decide::Step;
use crate::mission::{Input, InputContext, To};
use crate::phase::{FaultCause, PhaseName};
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::state::{Inspection, Phase, Stage};
use crate::units::{Cell, LuggageId};
use crate::world::hall_map::Mark;
use crate::world::resource::Resource;

impl Engine {
    /// Decides and carries out an input that cannot be refused.
    pub(super) fn feed(&mut self, input: Input, context: &InputContext) {
        if let Ok(step) = self.decide(input, context) {
            self.apply(step, context);
        }
    }

    pub(super) fn apply(&mut self, step: Step, context: &InputContext) {
        self.go(step, context);
        self.perform_all(step.acts, context);
    }

    /// Replaces the phase that the step concerns by the phase of the step. That is the present phase if `step.depth`
    /// is 0, otherwise the phase below that many interruptions.
    fn go(&mut self, step: Step, context: &InputContext) {
        if step.to == To::Stay {
            return;
        }
        let mut phase = self.state.phase.clone();
        let slot = phase.below_mut(step.depth);
        let old = std::mem::replace(slot, Phase::Idle);
        let new = match step.to {
            To::Stay => old,
            To::Interrupted => self.resumed(old),
            To::Phase(name) => self.entered(name, old, context),
        };
        *slot = new;
        self.mission.route.clear();
        self.mission.is_driven = false;
        self.note_phase(phase);
    }

    /// Whether the robot stands at the centre of its home cell, is not moving, and is not driven by hand.
    pub(super) fn rests_at_home(&self) -> bool {
        self.stands_at_home() && !matches!(self.state.phase, Phase::Driving { .. })
    }

    fn stands_at_home(&self) -> bool {
        self.is_home() && !self.robots.searching().controller.is_moving()
    }

    /// Returns the phase that was interrupted. If that phase is `AtHome` but the robot has left home or is about to
    /// leave it, returns `Exploring`.
    fn resumed(&self, phase: Phase) -> Phase {
        let (Phase::Driving { interrupted, .. } | Phase::Fault { interrupted, .. }) = phase else { return phase };
        if *interrupted == Phase::AtHome && !self.stands_at_home() { Phase::Exploring } else { *interrupted }
    }

    fn entered(&mut self, name: PhaseName, old: Phase, context: &InputContext) -> Phase {
        match name {
            PhaseName::Idle => Phase::Idle,
            PhaseName::Exploring => Phase::Exploring,
            PhaseName::Inspecting => Phase::Inspecting(self.inspection(context)),
            PhaseName::Driving => Phase::Driving { goal: context.cell, next: context.step, interrupted: Box::new(old) },
            PhaseName::ReturningHome => Phase::ReturningHome,
            PhaseName::AtHome => Phase::AtHome,
            PhaseName::ReturningWithAlarm => Phase::ReturningWithAlarm,
            PhaseName::BombLocated => Phase::BombLocated,
            PhaseName::Retrieving => Phase::Retrieving,
            PhaseName::BagSecured => Phase::BagSecured,
            PhaseName::Explored => Phase::Explored,
            PhaseName::Fault => self.fault(old, context),
        }
    }

    /// Returns the inspection of the obstacle just met, or of a recorded piece that still has no photo.
    fn inspection(&self, context: &InputContext) -> Inspection {
        let pose = self.state.pose;
        let piece = context.obstacle.and_then(super::obstacles::piece_of);
        match context.luggage.and_then(|id| self.state.luggage.get(id)) {
            Some(luggage) => {
                Inspection { cell: luggage.cell, piece: luggage.piece, pose, stage: Stage::RetakingPhoto(luggage.id), views: 0 }
            }
            None => Inspection { cell: context.cell.unwrap_or(pose.ahead()), piece, pose, stage: Stage::BackingUp, views: 0 },
        }
    }

    /// Halts the robot, and returns the phase of the fault. After a fault during a drive by hand, this phase remembers
    /// the phase from before the drive, not the drive itself.
    fn fault(&mut self, old: Phase, context: &InputContext) -> Phase {
        let cause = context.fault.clone().unwrap_or_else(|| FaultCause::Robot("it did not say why".to_owned()));
        self.halt_searching();
        self.world.write(self.now.wall, Tone::Alarm, Said::Fault(cause.clone()));
        let interrupted = if matches!(old, Phase::Driving { .. }) { self.resumed(old) } else { old };
        Phase::Fault { cause, interrupted: Box::new(interrupted) }
    }

    pub(super) fn note_phase(&mut self, phase: Phase) {
        let (before, after) = (self.phase_name(), phase.name());
        self.world.touch(Resource::Mission);
        self.world.touch(Resource::Robot);
        self.record(Fact::Phase(phase));
        if after != before {
            self.world.write(self.now.wall, Tone::Info, Said::Phase(before, after));
        }
    }

    /// Returns the stage of the inspection, even if the inspection is interrupted.
    pub(super) fn stage(&self) -> Option<Stage> {
        self.state.phase.inspection().map(|inspection| inspection.stage)
    }

    pub(super) fn set_stage(&mut self, stage: Stage) {
        self.change_inspection(|inspection| inspection.stage = stage);
    }

    pub(super) fn change_inspection(&mut self, change: impl FnOnce(&mut Inspection)) {
        let mut phase = self.state.phase.clone();
        if let Phase::Inspecting(inspection) = phase.underlying_mut() {
            change(inspection);
            self.note_phase(phase);
        }
    }

    pub(super) fn inspected(&self) -> Option<LuggageId> {
        self.state.phase.inspection().and_then(Inspection::luggage)
    }

    pub(super) fn mark(&mut self, cell: Cell, mark: Mark) {
        self.world.touch(Resource::Map);
        if self.state.map.is_news(cell, mark) {
            self.record(Fact::Mark(cell, mark));
        }
    }
}
