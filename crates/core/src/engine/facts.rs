//! Applies facts to `state` at once, and records them. Luggage and verdicts are an exception: `records` applies them
//! only after they are stored.

use super::Engine;
use crate::asked::Asked;
use crate::command::{Command, LuggageRef, Request, TemperatureReport};
use crate::mission::InputContext;
use crate::refused::Refused;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::units::Seq;

impl Engine {
    /// Applies the fact before it is stored. Returns the number of its entry in the journal.
    pub(super) fn record(&mut self, fact: Fact) -> Seq {
        self.state.follow(&fact, self.now.wall, self.world.revision());
        if let Fact::Mark(cell, _) = fact {
            self.planner.mark(cell, &self.state.map);
        } else if matches!(fact, Fact::MapEmptied(_)) {
            self.planner.learn(&self.state.map);
        }
        self.outbox.record(self.now.wall, fact)
    }

    /// Applies a fact at once. The fact is recorded with the next entry, or after a second at the latest. If another
    /// fact arrives here in this time, it replaces the waiting fact, so many such facts make few entries.
    pub(super) fn record_soon(&mut self, fact: Fact) {
        self.state.follow(&fact, self.now.wall, self.world.revision());
        self.outbox.record_soon(self.now, fact);
    }

    pub(super) fn record_state(&mut self) {
        self.outbox.record(self.now.wall, Fact::State(Box::new(self.state.clone())));
    }

    /// Writes a command into the log and the journal, even if the command was refused (safety A6). Accepted readings
    /// of sensors are left out.
    pub(super) fn write_command(&mut self, request: &Request, context: &InputContext, refused: Option<&Refused>) {
        // `record_stop` records an accepted stop, after the stop has taken effect.
        let is_left_out = matches!(request.command, Command::Temperature(TemperatureReport::Sensor(..)) | Command::Stop);
        if is_left_out && refused.is_none() {
            return;
        }
        let meant = context.luggage.filter(|_| request.command.luggage() == Some(LuggageRef::Pending));
        let tone = if refused.is_none() { Tone::Info } else { Tone::Warning };
        let (asked, issuer) = (Asked::Command(request.command.clone()), request.issuer.clone());
        // The second of two judges: if the verdict is lost, nothing may tell what he has answered.
        let is_confidential = self.is_for_two(context.verdict) && refused.is_none();
        if !is_confidential {
            let said = Said::Asked { asked: asked.clone(), meant, issuer: issuer.clone(), refused: refused.cloned() };
            self.world.write(self.now.wall, tone, said);
        }
        let if_lost = refused.is_none().then_some(if context.verdict.is_some() { Refused::StoreDown } else { Refused::NotKept });
        let (luggage, refused) = (context.luggage, refused.cloned());
        let fact = Fact::Command { issuer, id: request.id.clone(), asked, epoch: request.epoch, luggage, refused };
        if is_confidential {
            self.outbox.record(self.now.wall, fact);
        } else {
            self.outbox.record_command(self.now.wall, fact, if_lost);
        }
    }
}
