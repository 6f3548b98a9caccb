//! Words for the log of the state, which the console shows; the log on standard error stays English.

use crate::phrases::Language;
use hallsweep_core::hold::{Hold, HoldReason};
use hallsweep_core::robot::RobotId;
use hallsweep_core::snapshot::said::{Said, Trouble};

impl Language {
    pub fn said(self, said: &Said) -> String {
        let phrase = match said {
            Said::Asked { asked, meant, issuer, refused } => {
                let say = self.say(if refused.is_some() { "said-refused" } else { "said-by" });
                let say = say.with("asked", self.asked(asked, *meant)).with("issuer", self.issuer(issuer));
                refused.as_ref().map_or_else(|| say.clone(), |refused| say.clone().with("refused", self.refused(refused)))
            }
            Said::Overtaken(refused) => self.say("said-overtaken").with("refused", self.refused(refused)),
            Said::Held(hold, None) => self.say("said-held").with("hold", self.hold(*hold)),
            Said::Held(hold, Some(why)) => {
                self.say("said-held-why").with("hold", self.hold(*hold)).with("why", self.hold_reason(why))
            }
            Said::Over(hold) => self.say_of("hold-over", hold.name()),
            Said::Phase(before, after) => {
                self.say("said-phase").with("before", self.phase(*before)).with("after", self.phase(*after))
            }
            Said::Fault(cause) => self.say("said-fault").with("fault", self.fault(cause)),
            Said::Alarm(cause) => return self.alarm(cause),
            Said::Found { luggage, cell, has_photo } => {
                let say = self.say(if *has_photo { "said-found" } else { "said-found-without-photo" });
                say.with("id", luggage).with("cell", cell)
            }
            Said::PhotographedAgain(luggage) => self.say("said-photographed-again").with("id", luggage),
            Said::PhotoStays(luggage) => self.say("said-photo-stays").with("id", luggage),
            Said::NoOtherView(luggage) => self.say("said-no-other-view").with("id", luggage),
            Said::Secured(luggage) => self.say("secured-one").with("id", luggage),
            Said::HomeThroughRings => self.say("said-home-through-rings"),
            Said::NoWay(cell) => self.say("said-no-way").with("cell", cell),
            Said::Stands(robot, pose) => {
                let say = self.say(if robot.is_some() { "said-robot-stands" } else { "said-stands" });
                let say = say.with("cell", pose.cell).with("heading", self.heading(pose.heading));
                robot.as_ref().map_or_else(|| say.clone(), |robot| say.clone().with("robot", robot))
            }
            Said::Robot(robot, trouble) => return self.trouble(robot, trouble),
            Said::TreesBeginAnew(why) => self.say("said-trees-anew").with("why", why),
            Said::StartedAgain => self.hold(Hold::Restart),
            Said::Ended(by) => self.say("said-ended").with("by", by),
            Said::PutDown => self.say("said-put-down"),
            Said::Fact(fact) => return self.fact(fact),
            Said::Words(words) => return words.clone(),
        };
        phrase.to_string()
    }

    fn hold_reason(self, why: &HoldReason) -> String {
        match why {
            HoldReason::Reading(celsius) => self.celsius(*celsius),
            HoldReason::Silent(sensor) => sensor.to_string(),
            HoldReason::Unheard(sensor) => self.say("said-unheard").with("sensor", sensor).to_string(),
            HoldReason::Words(words) => self.robot_said(words).into_owned(),
        }
    }

    fn trouble(self, robot: &RobotId, trouble: &Trouble) -> String {
        let said = match trouble {
            Trouble::TooFar(cell) => self.say("said-too-far").with("cell", cell),
            Trouble::NoThermometer => self.say("said-no-thermometer"),
            Trouble::StillUnreached(why) => self.say("said-still-unreached").with("why", self.robot_said(why)),
            Trouble::Unreached(why) => self.say("said-unreached").with("why", self.robot_said(why)),
            Trouble::MetObstacle(cell) => self.say("said-met-obstacle").with("cell", cell),
            Trouble::Failed(why) => self.say("said-failed").with("why", self.robot_said(why)),
            Trouble::NoPhoto(why) => self.say("said-no-photo").with("why", self.robot_said(why)),
            Trouble::Unanswered => self.say("said-unanswered"),
        };
        said.with("robot", robot).to_string()
    }
}
