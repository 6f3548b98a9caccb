//! A driver under test, which talks to a scripted robot.

use std::time::Duration;

use super::{LineDriver, framed};
use crate::line::crc::Crc32;
use crate::{Driver, Output};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order, Stamp};
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Epoch, Now, OrderId, Pose, WallTime};

pub(crate) const ADA: &str = "hello ada base camera sonar led bump step=800 turn=650 photo=2000 at=2,3,west centred last=";
pub(crate) const BLIND: &str = "hello ada base step=800 turn=650 photo=0 at=0,0,south centred last=";

pub(crate) struct Test {
    pub(crate) driver: LineDriver,
    pub(crate) now: Now,
}

impl Test {
    pub(crate) fn connected() -> Test {
        let mut test = Test { driver: LineDriver::new(), now: Now::default() };
        test.driver.handle_connected(test.now);
        assert_eq!(test.said(), ["", "hello"]);
        test
    }

    /// A driver after its robot has introduced itself. Both know that orders begin above 42.
    pub(crate) fn up(hello: &str) -> Test {
        let mut test = Test::connected();
        test.hears(&format!("{hello}41"));
        assert_eq!(test.said(), ["from 42"]);
        test.hears(&format!("{hello}42"));
        assert!(matches!(test.events()[..], [RobotEvent::Stands(_), RobotEvent::LinkUp(_)]));
        test.said();
        test
    }

    pub(crate) fn hears(&mut self, text: &str) {
        self.driver.handle_received(&framed(text), self.now);
    }

    pub(crate) fn passes(&mut self, ms: u64) {
        for _ in 0..ms / 10 {
            self.now.since_start += Duration::from_millis(10);
            self.driver.handle_timeout(self.now);
        }
    }

    pub(crate) fn order(&mut self, action: Action) {
        self.order_within(action, 2000);
    }

    pub(crate) fn order_within(&mut self, action: Action, ms: u64) {
        let deadline = Duration::from_millis(ms);
        self.driver.handle_order(Order { id: OrderId(7), action, epoch: Epoch(0), deadline }, self.now);
    }

    pub(crate) fn outputs(&mut self) -> Vec<Output> {
        std::iter::from_fn(|| self.driver.poll_output()).collect()
    }

    /// The texts of all lines that the driver has sent since the last call. The test fails if the driver requested
    /// anything else.
    pub(crate) fn said(&mut self) -> Vec<String> {
        let text = |output: Output| match output {
            Output::Send(bytes) => String::from_utf8(bytes).unwrap().trim_end().split('*').next().unwrap().to_owned(),
            other @ (Output::Reconnect | Output::GiveUp(_) | Output::Draw(..)) => panic!("{other:?}"),
        };
        self.outputs().into_iter().map(text).collect()
    }

    pub(crate) fn events(&mut self) -> Vec<RobotEvent> {
        std::iter::from_fn(|| self.driver.poll_event()).collect()
    }

    pub(crate) fn photo(&mut self, bytes: &[u8], sent: &[u8]) {
        let mut crc = Crc32::new();
        crc.add(bytes);
        self.hears(&format!("photo 43 {} {:08X}", bytes.len(), crc.value()));
        self.driver.handle_received(sent, self.now);
    }
}

pub(crate) const FORWARD: Action = Action::Move(Move::Forward);

pub(crate) fn photograph() -> Action {
    Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() })
}

/// The reason for which the driver closes the connection. This must be the driver's last output.
pub(crate) fn given_up(test: &mut Test) -> String {
    let outputs = test.outputs();
    let Some(Output::GiveUp(words)) = outputs.last() else {
        panic!("a connection that is given up was expected, not {outputs:?}")
    };
    assert_eq!(test.driver.poll_timeout(), None, "nothing more is said");
    words.clone()
}

pub(crate) fn lost(events: &[RobotEvent]) -> &str {
    match events {
        [RobotEvent::LinkLost(words)] => words,
        other => panic!("only a link that is lost was expected, not {other:?}"),
    }
}
