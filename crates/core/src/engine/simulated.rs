//! Actions on a simulated hall and simulated robots, and their effect on the mission. Each action is recorded with
//! the person who took it. The robots are put down in another hall only if nothing is lost by that. The simulation
//! itself is not part of the core.

use std::sync::Arc;

use super::Engine;
use super::outbox::WaitingAnswer;
use crate::asked::Asked;
use crate::command::Issuer;
use crate::hold::Hold;
use crate::refused::Refused;
use crate::robot::RobotId;
use crate::simulated::Simulated;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::Venue;
use crate::state::fact::Fact;
use crate::units::{Now, Ticket};

impl Engine {
    pub fn note_simulated(&mut self, issuer: Issuer, simulated: Simulated, now: Now) {
        self.begin(now);
        self.write_simulated(issuer, simulated);
    }

    /// Puts the robots down at home in another hall. No mission may be under way; a mission that is over is archived.
    /// The simulated robots in `robots` count as unreached until they report that they stand there. The ticket is
    /// answered when all these changes are recorded.
    ///
    /// # Errors
    /// The reason why the robots cannot be put down now: something would be lost. In this case nothing has changed.
    pub fn put_down_in(&mut self, venue: Venue, robots: &[RobotId], issuer: Issuer, now: Now) -> Result<Ticket, Refused> {
        self.may_be_put_down()?;
        self.begin(now);
        self.write_simulated(issuer, Simulated::PutDown(Arc::clone(&venue.name)));
        self.put_down();
        for robot in robots {
            self.link_lost(robot, format!("it is put down in the hall {}", venue.name));
        }
        self.record_conditions(venue);
        let (ticket, seq) = (self.outbox.next_ticket(), self.outbox.written());
        self.outbox.wait(WaitingAnswer { ticket, seq, luggage: None, verdict: None, decided: false });
        self.go_on();
        Ok(ticket)
    }

    fn may_be_put_down(&self) -> Result<(), Refused> {
        if self.state.phase.is_mission() {
            Err(Refused::NotInPhase(self.state.phase.name()))
        } else if self.robots.are_halting() || !self.robots.moving().is_empty() {
            Err(Refused::Moving)
        } else if self.state.holds.contains(Hold::Store) {
            Err(Refused::StoreDown)
        } else {
            Ok(())
        }
    }

    fn write_simulated(&mut self, issuer: Issuer, simulated: Simulated) {
        let asked = Asked::Simulated(simulated);
        let said = Said::Asked { asked: asked.clone(), meant: None, issuer: issuer.clone(), refused: None };
        self.world.write(self.now.wall, Tone::Info, said);
        let fact = Fact::Command { issuer, id: None, asked, epoch: None, luggage: None, refused: None };
        self.outbox.record_command(self.now.wall, fact, None);
    }
}
