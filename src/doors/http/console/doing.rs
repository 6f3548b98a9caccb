//! The console's sentences about what each robot is doing, and about the link and the parts of the searching robot.

use std::borrow::Cow;
use std::fmt::Display;

use super::view::View;
use crate::phrases::Phrase;
use hallsweep_core::hold::Hold;
use hallsweep_core::robot::{Part, Parts, RobotState};
use hallsweep_core::snapshot::robot::{RobotShown, RobotView};
use hallsweep_core::units::WallTime;

/// Maximum number of pieces named to users of screen readers. Nobody remembers more.
const NAMED: usize = 8;

impl View<'_> {
    /// Returns the activity shown in the status bar. A STOP is shown here because a small screen has no room for the
    /// list of holds.
    pub(super) fn doing(&self) -> Phrase<'static> {
        let is_halting = self.snapshot.robot.halting || self.snapshot.robots.iter().any(|robot| robot.view.halting);
        let searching_stands = self.snapshot.robot.state == RobotState::Stopped;
        match self.is_still() {
            true if self.snapshot.mission.holds.contains(&Hold::Operator) => self.say("doing-held"),
            false if is_halting => self.say("doing-halting"),
            false if searching_stands => self.say("doing-pair"),
            true | false => self.robot_state(),
        }
    }

    pub(super) fn unreached(&self) -> Option<Cow<'_, str>> {
        let why = self.snapshot.robots.first()?.unreached.as_deref()?;
        Some(self.language.robot_said(why))
    }

    /// Returns which hardware parts the searching robot has, or `None` while there is no link to the robot.
    pub(super) fn parts(&self) -> Option<Parts> {
        self.snapshot.robots.first().and_then(|robot| robot.parts)
    }

    pub(super) fn led_words(&self) -> Phrase<'static> {
        self.say_of("led", self.led())
    }

    /// Whether the shown state of the searching robot can be relied on. Without a link, the page shows only the
    /// robot's last report. A page about the past shows the recorded state, which counts as reliable.
    pub(super) fn is_reached(&self) -> bool {
        self.then.is_some() || self.snapshot.robots.first().is_none_or(|robot| robot.parts.is_some())
    }

    /// Returns a robot's last report as text. If there is no link to the robot, the text also says since when the
    /// report is outdated.
    pub(super) fn as_known(&self, robot: &RobotShown, last: &impl Display) -> String {
        match robot.view.unreached_since {
            _ if self.then.is_some() || robot.parts.is_some() => last.to_string(),
            Some(since) => self.unknown_since(since, last).to_string(),
            None => self.say("not-known").to_string(),
        }
    }

    pub(super) fn known(&self, last: &impl Display) -> String {
        self.snapshot.robots.first().map_or_else(|| last.to_string(), |robot| self.as_known(robot, last))
    }

    pub(super) fn unknown_since(&self, since: WallTime, last: impl Display) -> Phrase<'static> {
        self.say("unknown-since").with("time", self.zone().clock_time(since)).with("last", last)
    }

    pub(super) fn led(&self) -> &'static str {
        if self.is_reached() { self.last_led() } else { "unknown" }
    }

    pub(super) fn last_led(&self) -> &'static str {
        match self.parts() {
            Some(parts) if !parts.has(Part::Led) => "none",
            Some(_) | None if self.snapshot.robot.led_blinking => "blinking",
            Some(_) | None => "off",
        }
    }

    pub(super) fn robot_state(&self) -> Phrase<'static> {
        if self.unreached().is_some() {
            return self.say("doing-no-link");
        }
        self.last_state()
    }

    pub(super) const fn last_state(&self) -> Phrase<'static> {
        self.does_itself(&self.snapshot.robot)
    }

    pub(super) fn others(&self) -> &[RobotShown] {
        self.snapshot.robots.get(1..).unwrap_or_default()
    }

    pub(super) fn does(&self, robot: &RobotShown) -> Phrase<'static> {
        if robot.unreached.is_some() || robot.holds.contains(&Hold::RobotLink) {
            return self.say("doing-no-link");
        }
        self.does_itself(&robot.view)
    }

    /// Returns the activity of a robot. A robot that was told to halt counts as halting until it reports that it
    /// stands still.
    const fn does_itself(&self, robot: &RobotView) -> Phrase<'static> {
        if robot.halting { self.say("doing-halting") } else { self.say_of("doing", robot.state.name()) }
    }

    /// Describes the hall for users of screen readers: the progress of the search, the robot's position, and where
    /// each piece was found.
    pub(super) fn hall_in_words(&self) -> String {
        let robot = &self.snapshot.robot;
        let stands = match robot.outside {
            0 => self
                .say("hall-robot-at")
                .with("place", self.place(robot.pose.cell))
                .with("heading", self.language.heading(robot.pose.heading)),
            _ => self.say("hall-robot-outside"),
        };
        let search = self.say("hall-in-words").with("searched", self.searched()).with("open", self.open());
        let mut words = vec![search.with("robot", self.known(&stands)).to_string()];
        let pieces = &self.snapshot.luggage;
        let left = pieces.pending().chain(pieces.bombs_left()).take(NAMED);
        words.extend(left.map(|piece| {
            let say = self.say(if piece.is_pending() { "hall-piece-waits" } else { "hall-piece-dangerous" });
            say.with("id", piece.id).with("place", self.place(piece.cell)).to_string()
        }));
        words.push(self.say("hall-pieces").with("count", pieces.len()).to_string());
        words.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::HallInfo;
    use super::*;
    use crate::api::tests::fixture::{TEN, searching};
    use crate::phrases::Language;
    use hallsweep_core::pair::Which;
    use hallsweep_core::settings::Rules;
    use hallsweep_core::snapshot::Snapshot;
    use hallsweep_core::snapshot::robot::RobotView;

    fn view(snapshot: &Snapshot) -> View<'_> {
        let hall = HallInfo {
            name: "airport".into(),
            cell_m: Some(0.5),
            is_reckoned: false,
            evacuation_m: 100.0,
            is_paused: false,
            robot: None,
            rules: Rules::default(),
        };
        View { snapshot, hall, began: None, who: None, language: Language::English, why: None, now: TEN, line: None, then: None }
    }

    #[test]
    fn who_does_not_see_the_hall_hears_what_is_where() {
        let snapshot = searching();
        assert_eq!(
            view(&snapshot).hall_in_words(),
            "15 cells, 3.8 m² searched, 4 places left to search; the robot at column 2, row 2, facing east. Luggage #3 at column 3, row 2 waits for \
             its verdict. Luggage #2 at column 1, row 2 is dangerous. Pieces of luggage found: 3."
        );
    }

    #[test]
    fn of_every_robot_it_is_said_what_it_does_and_whether_it_is_there() {
        let mut snapshot = searching();
        let robot = |unreached: Option<&str>, halting| RobotShown {
            id: Which::Srm1.robot(),
            view: RobotView { state: RobotState::MovingArm, halting, ..snapshot.robot },
            parts: None,
            holds: Vec::new(),
            arm: None,
            unreached: unreached.map(Into::into),
        };
        let robots = [robot(None, false), robot(None, true), robot(Some("nobody answers"), false)];
        let said = robots.each_ref().map(|robot| view(&snapshot).does(robot).to_string());
        assert_eq!(said, ["moving its arm", "halting …", "no link"]);
        snapshot.robots = robots.into();
        assert_eq!(view(&snapshot).others().len(), 2, "the first is the one that searches");
    }
}
