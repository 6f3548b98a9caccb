//! What becomes of a motion that is under way when nobody hears the robot any more, because the link is lost or the program has ended: it
//! ends by itself, and where the robot then stands is found out with the next link; or nobody knows any more where it stands.

use std::time::Duration;

use super::{Aim, Stage, VirtualRobot, Way};
use hallsweep_core::units::Heading;

/// A link that is lost so soon after a move was sent may have been lost before the robot heard of it, and where the server is slow, later.
const BEGUN: Duration = Duration::from_millis(10);

/// What is to be done when nobody knows where it stands.
const PUT_HOME: &str = "Open its page anew, so that it stands at its start, and press START";

/// What is to be done when its places on record may be wrong as well.
const BEGIN_ANEW: &str =
    "The map may be wrong. Open its page anew, so that it stands at its start; RESET begins with an empty map";

/// Advice added where its scene file would have helped.
const WITH_SCENE: &str = ". With its scene file (robot.scene) a drift is set right";

/// A step that nobody has heard the end of: which way, how far it was to go, and how far it has felt ahead since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unheard {
    pub(super) towards: Heading,
    pub(super) cells: f64,
    pub(super) felt: f64,
}

impl VirtualRobot {
    /// Nobody knows any more where it stands, and something may have been told of the wrong cell.
    pub(super) fn lose(&mut self, words: &str) {
        self.reckoning.doubt();
        let advice = if self.room.is_none() { WITH_SCENE } else { "" };
        self.fail_lost(format!("{words}. {BEGIN_ANEW}{advice}"));
    }

    /// Nobody knows any more where it stands.
    pub(super) fn lose_sight(&mut self, words: &str) {
        self.fail_lost(format!("{words}. {PUT_HOME}"));
    }

    pub(super) fn fail_lost(&mut self, words: String) {
        // Nothing is on its way any more, and whoever has no order open is told with the next.
        self.forget_unsent();
        (self.off_centre, self.is_told_lost, self.is_changed) = (true, self.task.is_some(), true);
        self.fail(&words);
        self.lost = Some(words);
    }

    /// Nobody knows whether it was told to move.
    pub(super) fn left_in_doubt(&mut self) {
        self.off_centre = true;
        self.lost = Some(format!("it was lost in the moment in which it was told to move. {PUT_HOME}"));
    }

    /// It was going forward against something that stands there, and has met it by itself; of what is behind it nobody knows.
    fn left_against_something(&mut self, backward: bool) {
        let heading = self.reckoning.pose().heading;
        match self.reckoning.contact_ahead() {
            Some((way, true)) if !backward => self.reckoning.advance(heading, way),
            Some(_) | None => self.left_in_doubt(),
        }
    }

    /// The link is lost, or the program has ended: what is under way ends by itself, and nobody hears how. On the way back and in a turn
    /// nothing is to be met.
    pub(super) fn leave_unheard(&mut self) {
        let is_on_its_way = self.is_on_its_way();
        self.forget_unsent();
        let Some(task) = self.task.take() else { return };
        self.is_changed = true;
        let may_be_unheard = BEGUN + self.greeted_after;
        let Some(leg) = task.leg.filter(|leg| leg.is_sent() || is_on_its_way) else { return };
        if is_on_its_way || matches!(leg.stage, Stage::Sent(sent) if self.now.saturating_sub(sent) < may_be_unheard) {
            return self.left_in_doubt();
        }
        self.off_centre |= matches!(leg.way, Way::Straight { .. });
        if let Stage::Halting { lasted, .. } = leg.stage
            && !matches!(task.aim, Aim::Step(_))
        {
            return self.moved_for(leg, lasted);
        }
        match (leg.way, task.aim) {
            (Way::Turn { .. }, Aim::Turn(to) | Aim::Aside(to)) => self.reckoning.complete(to),
            (Way::Straight { towards, cells, .. }, Aim::Step(_)) => {
                let cells = match leg.stage {
                    Stage::Halting { lasted, .. } => cells.min(lasted.div_duration_f64(self.step)),
                    Stage::Fresh | Stage::Refused(_) | Stage::Queued | Stage::Sent(_) => cells,
                };
                self.unheard = Some(Unheard { towards, cells, felt: 0.0 });
            }
            (Way::Straight { cells, .. }, Aim::Feel) => {
                if let Some(unheard) = &mut self.unheard {
                    unheard.felt += cells;
                }
            }
            (
                Way::Straight { towards, cells, .. },
                Aim::Turn(_) | Aim::Back | Aim::Aside(_) | Aim::Return | Aim::Retreat(_) | Aim::Gauge | Aim::Gauged | Aim::Draw,
            ) => {
                self.reckoning.advance(towards, cells);
            }
            (Way::Straight { backward, .. }, Aim::Measure(_) | Aim::Touch { .. }) => self.left_against_something(backward),
            (Way::Turn { .. }, _) => {}
        }
    }
}
