//! Faults of the simulated robot that can be switched on and off. A blocked way is not a fault of the robot. It is a
//! change of its hall.

use super::{End, Sim, SimTask, Work};
use hallsweep_core::units::{Cell, Now};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    pub no_thermometer: bool,
    pub camera_fails: bool,
}

impl Sim {
    /// Sets the faults that are on. If the thermometer appears or disappears, the robot reports its capabilities
    /// again.
    pub fn handle_faults(&mut self, faults: Faults, now: Now) {
        self.handle_timeout(now);
        let is_news = self.faults.no_thermometer != faults.no_thermometer;
        self.faults = faults;
        if is_news {
            self.thermometer.come_back(self.before.saturating_add(self.now));
            self.tell_capabilities();
        }
    }

    /// Cuts the link. The robot halts by itself, and never answers its current order.
    pub fn handle_link_lost(&mut self, now: Now) {
        self.handle_timeout(now);
        if self.task.is_some() {
            self.stop_wheels();
        }
        self.events.clear();
    }

    /// Restores the link. The robot reports where it is.
    pub fn handle_link_back(&mut self, now: Now) {
        self.handle_timeout(now);
        self.events.clear();
        self.introduce();
    }

    #[must_use]
    pub fn is_in_or_enters(&self, cell: Cell) -> bool {
        let enters = |task: &SimTask| matches!(task.work, Work::Drive { end: End::At(pose), .. } if pose.cell == cell);
        self.pose.cell == cell || self.task.as_ref().is_some_and(enters)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::super::super::settings::{Camera, SimSettings};
    use super::super::Hall;
    use super::*;
    use hallsweep_core::command::Move;
    use hallsweep_core::effect::{Action, Order, Stamp};
    use hallsweep_core::event::RobotEvent;
    use hallsweep_core::robot::Part;
    use hallsweep_core::units::{Epoch, OrderId, Pose, WallTime};

    fn now(ms: u64) -> Now {
        Now { since_start: Duration::from_millis(ms), wall: WallTime::default() }
    }

    fn sim(temperature: &str) -> Sim {
        let text = format!("drawing = \"\"\"\nS.\n..\n\"\"\"\n{temperature}");
        let hall = Hall::parse("test.toml", &text).expect("a good hall");
        let mut sim = Sim::new(Arc::new(hall), SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Stub) });
        while sim.poll_event().is_some() {}
        sim
    }

    fn order(sim: &mut Sim, action: Action, at: u64) {
        let order = Order { id: OrderId(1), action, epoch: Epoch(0), deadline: Duration::from_secs(9) };
        sim.handle_order(order, now(at));
    }

    fn events(sim: &mut Sim) -> Vec<RobotEvent> {
        std::iter::from_fn(|| sim.poll_event()).collect()
    }

    const WARMER: &str = "[[temperature]]\nat_s = 0\ncelsius = 20\n[[temperature]]\nat_s = 100\ncelsius = 30\n";

    #[test]
    fn without_a_thermometer_it_says_so_and_reads_nothing_until_it_is_back() {
        let mut sim = sim(WARMER);
        sim.handle_timeout(now(1));
        assert!(matches!(events(&mut sim)[..], [RobotEvent::Temperature(_)]));
        sim.handle_faults(Faults { no_thermometer: true, ..Faults::default() }, now(2));
        sim.handle_timeout(now(50_000));
        let [RobotEvent::LinkUp(can)] = events(&mut sim)[..] else { panic!("it says what it can do and nothing else") };
        assert!(!can.parts.has(Part::Thermometer) && can.parts.has(Part::Camera));
        sim.handle_faults(Faults::default(), now(50_000));
        sim.handle_timeout(now(50_000));
        let [RobotEvent::LinkUp(can), RobotEvent::Temperature(celsius)] = events(&mut sim)[..] else { panic!("one reading") };
        assert!(can.parts.has(Part::Thermometer));
        assert!((celsius.degrees() - 25.0).abs() < 0.01, "what it is now, and not what it was: {celsius:?}");
    }

    #[test]
    fn no_photo_succeeds_while_the_camera_fails() {
        let mut sim = sim("");
        let photo = Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() });
        sim.handle_faults(Faults { camera_fails: true, ..Faults::default() }, now(0));
        order(&mut sim, photo, 0);
        sim.handle_timeout(now(2000));
        assert!(matches!(events(&mut sim)[..], [RobotEvent::PhotoFailed(OrderId(1), _)]));
        sim.handle_faults(Faults::default(), now(2000));
        order(&mut sim, photo, 2000);
        sim.handle_timeout(now(4000));
        assert!(matches!(events(&mut sim)[..], [RobotEvent::Photo(..)]));
    }

    #[test]
    fn a_robot_that_lost_its_link_has_halted_and_says_where_it_is_when_it_is_back() {
        let mut sim = sim("");
        order(&mut sim, Action::Move(Move::Forward), 0);
        assert!(sim.is_in_or_enters(Cell::new(0, 1)) && sim.is_in_or_enters(Cell::HOME));
        sim.handle_link_lost(now(100));
        sim.handle_timeout(now(5000));
        assert!(events(&mut sim).is_empty() && sim.is_off_centre() && !sim.is_busy());
        assert!(!sim.is_in_or_enters(Cell::new(0, 1)));
        sim.handle_link_back(now(5000));
        let [RobotEvent::Stands(stands), RobotEvent::LinkUp(_)] = events(&mut sim)[..] else { panic!("where, then what") };
        assert!(stands.pose == Pose::START && stands.off_centre);
    }
}
