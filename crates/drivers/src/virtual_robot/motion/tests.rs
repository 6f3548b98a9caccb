//! Tests of the virtual robot's motions: commands that must not be sent, motions that are not observed, and messages
//! that come late or refuse a move.

use super::super::OrderTask;
use super::*;
use crate::Driver;
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::units::{Epoch, Now, OrderId};

struct Test {
    robot: VirtualRobot,
    now: Now,
}

impl Test {
    fn connected() -> Test {
        Test::speaking(Dialect::Messages)
    }

    fn speaking(dialect: Dialect) -> Test {
        let robot = VirtualRobot::new(dialect, Duration::from_millis(330));
        let mut test = Test { robot, now: Now::default() };
        test.connect();
        test
    }

    /// Connects, and sends the greeting of the first server version.
    fn connect(&mut self) {
        self.robot.handle_connected(self.now);
        if self.robot.dialect == Dialect::Semicolons {
            self.robot.handle_received(b";{\"type\":\"webpage-ready\"};", self.now);
        }
    }

    fn order(&mut self, action: Action) {
        let order = Order { id: OrderId(1), action, epoch: Epoch(0), deadline: Duration::from_secs(30) };
        self.robot.handle_order(order, self.now);
    }

    /// Returns all outputs so far, and confirms each as done.
    fn sent(&mut self) -> Vec<Output> {
        let mut all = Vec::new();
        while let Some(output) = self.robot.poll_output() {
            if matches!(output, Output::Send(_)) {
                self.robot.handle_sent(self.now);
            }
            all.push(output);
        }
        all
    }

    fn alarms(&mut self) -> usize {
        let alarm = Output::Send(self.robot.written(Command::Alarm));
        self.sent().into_iter().filter(|output| *output == alarm).count()
    }

    /// Gives an order, and confirms its first message as sent.
    fn begin(&mut self, id: OrderId, action: Action) {
        let deadline = Duration::from_secs(3);
        self.robot.handle_order(Order { id, action, epoch: Epoch(0), deadline }, self.now);
        assert!(matches!(self.robot.poll_output(), Some(Output::Send(_))));
        self.robot.handle_sent(self.now);
    }

    fn passes(&mut self, time: Duration) {
        self.now.since_start += time;
        self.robot.handle_timeout(self.now);
    }

    fn last_event(&mut self) -> Option<RobotEvent> {
        std::iter::from_fn(|| self.robot.poll_event()).last()
    }
}

/// Safety S6: this turn did not begin because another client's turn was running.
#[test]
fn a_turn_that_was_refused_is_not_tried_again_after_a_halt() {
    let mut test = Test::connected();
    test.begin(OrderId(1), Action::Move(Move::TurnLeft));
    test.robot.handle_halt(test.now);
    test.robot.handle_received(br#"{"endmove":false,"move":"turnLeft_notallowed"}"#, test.now);
    test.passes(AGAIN);
    let alarm = Some(Output::Send(Command::Alarm.as_message()));
    assert_eq!((test.robot.poll_output(), test.robot.poll_output()), (alarm, None));
    assert_eq!(test.last_event(), Some(RobotEvent::Halted(OrderId(1), false)));
}

/// Safety S1: each STOP that changes the stored state would write the state file.
#[test]
fn a_flood_of_stops_sends_one_alarm_and_is_remembered_once() {
    for (action, alarms) in [(Action::Move(Move::Forward), 1), (Action::Move(Move::TurnLeft), 0)] {
        let mut test = Test::connected();
        test.begin(OrderId(1), action);
        test.passes(Duration::from_millis(100));
        assert!(test.robot.poll_memory().is_some());
        let mut changes = 0;
        for _ in 0..1000 {
            test.robot.handle_halt(test.now);
            changes += usize::from(test.robot.poll_memory().is_some());
        }
        let sent: Vec<Output> = std::iter::from_fn(|| test.robot.poll_output()).collect();
        assert_eq!((sent, changes), (vec![Output::Send(Command::Alarm.as_message()); alarms], alarms), "{action:?}");
    }
}

/// Safety S1: the STOP came while the state file was still being written.
#[test]
fn a_stop_does_not_take_back_the_alarm_of_an_order_that_is_late() {
    let mut test = Test::connected();
    let order =
        Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_millis(100) };
    test.robot.handle_order(order, test.now);
    assert!(test.robot.poll_output().is_some());
    test.robot.handle_sent(test.now);
    test.passes(Duration::from_millis(100));
    test.robot.handle_halt(test.now);
    assert_eq!(test.robot.poll_output(), Some(Output::Send(Command::Alarm.as_message())));
}

/// Safety S6: the robot is halted while it feels whether its step is complete, and then a contact is reported.
#[test]
fn what_is_met_in_the_moment_of_a_halt_sets_nothing_moving() {
    let mut test = Test::connected();
    test.begin(OrderId(1), Action::Move(Move::Forward));
    test.passes(Duration::from_millis(200));
    test.robot.handle_lost("the cable was pulled", test.now);
    test.robot.handle_connected(test.now);
    test.begin(OrderId(2), Action::Recentre);
    test.passes(Duration::from_millis(90));
    test.robot.handle_halt(test.now);
    assert_eq!(test.robot.poll_output(), Some(Output::Send(Command::Alarm.as_message())));
    test.robot.handle_received(br#"{"collision":"moveForward","target":"wallDown"}"#, test.now);
    assert_eq!((test.robot.poll_output(), test.last_event()), (None, Some(RobotEvent::Halted(OrderId(2), true))));
}

/// Safety S6: the link was lost while the state file was still being written, and a STOP came after the link was
/// back.
#[test]
fn what_has_not_gone_out_when_the_link_is_lost_never_goes_out() {
    let mut test = Test::connected();
    let order = Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
    test.robot.handle_order(order, test.now);
    test.robot.handle_lost("the cable was pulled", test.now);
    test.robot.handle_connected(test.now);
    test.robot.handle_halt(test.now);
    assert_eq!(test.sent(), [Output::Send(Command::Alarm.as_message())]);
    assert!(test.robot.lost.is_none() && !test.robot.off_centre, "it was not told to move");
}

#[test]
fn what_was_going_out_when_the_link_was_lost_may_have_come() {
    let mut test = Test::connected();
    let order = Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
    test.robot.handle_order(order, test.now);
    assert!(matches!(test.robot.poll_output(), Some(Output::Send(_))), "and nobody says whether it was sent");
    test.robot.handle_lost("it does not take what is sent", test.now);
    assert!(test.robot.lost.is_some());
}

const FORWARD: Action = Action::Move(Move::Forward);

/// Safety S1: a STOP must work in every state.
#[test]
fn every_stop_sends_an_alarm_whatever_the_robot_does_or_waits_for() {
    let refuse = |test: &mut Test| {
        test.order(FORWARD);
        test.sent();
        test.robot.handle_received(br#"{"endmove":"false","move":"moveForward_notallowed (asynch)"}"#, test.now);
    };
    type State<'a> = (&'a str, &'a dyn Fn(&mut Test));
    let states: [State<'_>; 9] = [
        ("nothing", &|_| {}),
        ("a drawing", &|test| {
            test.order(Action::Photograph(hallsweep_core::effect::Stamp { pose: Pose::START, wall: Default::default() }));
        }),
        ("an unsent step", &|test| test.order(FORWARD)),
        ("a step", &|test| {
            test.order(FORWARD);
            test.sent();
            test.connect();
            test.sent();
            test.passes(Duration::from_millis(50));
        }),
        ("a step that is being halted", &|test| {
            test.order(FORWARD);
            test.sent();
            test.connect();
            test.sent();
            test.robot.handle_halt(test.now);
            test.sent();
            test.passes(ALARM_SERVES);
        }),
        ("a server that refuses", &refuse),
        ("a halt long ago", &|test| {
            test.robot.handle_halt(test.now);
            test.sent();
            test.passes(ALARM_SERVES);
        }),
        ("a halt, and a step behind it", &|test| {
            test.robot.handle_halt(test.now);
            test.sent();
            test.order(FORWARD);
            test.sent();
            test.connect();
            test.sent();
        }),
        ("a fault", &|test| test.robot.lose_sight("it was kicked")),
    ];
    for dialect in [Dialect::Semicolons, Dialect::Messages] {
        for (what, reach) in &states {
            let mut test = Test::speaking(dialect);
            reach(&mut test);
            test.sent();
            test.robot.handle_halt(test.now);
            let now = test.alarms();
            // If a new connection is being made, the alarm is sent as soon as the connection is up.
            test.connect();
            assert_eq!(now + test.alarms(), 1, "{dialect:?}: {what}");
            test.robot.handle_halt(test.now);
            assert_eq!(test.alarms(), 0, "{dialect:?}: {what}: one alarm serves two STOPs in a moment");
        }
    }
}

/// Safety S1: a STOP comes while there is no link, or the link is lost at the same time.
#[test]
fn a_stop_that_cannot_go_out_goes_out_with_the_next_connection() {
    for is_lost_before in [true, false] {
        let mut test = Test::connected();
        for step in [is_lost_before, !is_lost_before] {
            if step {
                test.robot.handle_lost("the cable was pulled", test.now);
            } else {
                test.robot.handle_halt(test.now);
            }
        }
        test.sent();
        test.passes(Duration::from_secs(5));
        test.connect();
        assert_eq!(test.alarms(), 1, "{is_lost_before}");
        test.robot.handle_lost("the cable was pulled", test.now);
    }
}

/// Safety S1: in later versions of the page, an alarm during a turn leaves the robot at a wrong angle.
#[test]
fn a_stop_in_a_turn_sends_its_alarm_when_the_turn_is_over() {
    let mut test = Test::connected();
    test.robot.latency = Some(LATENCY);
    test.begin(OrderId(1), Action::Move(Move::TurnLeft));
    test.passes(Duration::from_millis(100));
    test.robot.handle_halt(test.now);
    assert_eq!(test.alarms(), 0);
    test.passes(Duration::from_millis(300));
    assert_eq!(test.alarms(), 0, "it still turns");
    test.passes(Duration::from_millis(300));
    assert_eq!(test.alarms(), 1, "though the server has not said that it is over");
}

/// The order must fail even if much of its deadline is left.
#[test]
fn a_server_that_refuses_for_ever_is_sent_an_alarm_and_then_the_order_fails_in_words() {
    let mut test = Test::connected();
    test.order(FORWARD);
    let (mut alarms, mut moves) = (0, 0);
    for _ in 0..100 {
        for output in test.sent() {
            if output == Output::Send(Command::Alarm.as_message()) {
                alarms += 1;
            } else {
                moves += 1;
                test.robot.handle_received(br#"{"endmove":false,"move":"moveForward_notallowed"}"#, test.now);
            }
        }
        test.passes(Duration::from_millis(100));
    }
    assert_eq!((alarms, moves < 20), (1, true), "{moves}");
    let event = test.last_event();
    assert!(
        matches!(&event, Some(RobotEvent::Failed(_, words)) if words.contains("another move is still under way")),
        "{event:?}"
    );
    assert!(test.now.since_start < Duration::from_secs(30), "the order was not overdue");
}

/// Every client gets the refusals of all moves.
#[test]
fn a_refusal_of_another_programs_move_is_not_taken_for_ours() {
    for (name, late) in [("moveBackward", 10), ("moveForward", 500)] {
        let mut test = Test::connected();
        test.robot.step = Duration::from_secs(1);
        test.begin(OrderId(1), Action::Move(Move::Forward));
        test.passes(Duration::from_millis(late));
        let said = format!("{{\"endmove\":false,\"move\":\"{name}_notallowed\"}}");
        test.robot.handle_received(said.as_bytes(), test.now);
        assert!(test.robot.leg().is_some_and(|leg| matches!(leg.stage, LegStage::Sent(_))), "{name} after {late} ms");
    }
}

/// While a new connection is being made, a greeting may still come over the old one. The server greets all clients
/// whenever one connects.
#[test]
fn a_greeting_over_a_connection_that_is_given_up_begins_nothing() {
    let mut test = Test { robot: VirtualRobot::new(Dialect::Semicolons, Duration::from_millis(330)), now: Now::default() };
    let greet = |test: &mut Test| test.robot.handle_received(b";{\"type\":\"webpage-ready\"};", test.now);
    test.robot.handle_connected(test.now);
    greet(&mut test);
    let order = Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
    test.robot.handle_order(order, test.now);
    greet(&mut test);
    assert_eq!(test.robot.poll_output(), Some(Output::Reconnect));
    assert_eq!(test.robot.poll_output(), None);
    test.robot.handle_connected(test.now);
    greet(&mut test);
    assert!(matches!(test.robot.poll_output(), Some(Output::Send(_))));
}

const CONTACT: &[u8] = br#"{"collision":"moveForward","target":"wallDown"}"#;

/// A robot after a step that has ended by its time and was acknowledged.
fn stepped() -> Test {
    let mut test = Test::connected();
    test.robot.latency = Some(Duration::ZERO);
    test.begin(OrderId(1), Action::Move(Move::Forward));
    test.robot.handle_received(br#"{"endmove":true,"move":"moveForward"}"#, test.now);
    test.passes(Duration::from_secs(1));
    assert_eq!(test.last_event(), Some(RobotEvent::Done(OrderId(1))));
    test
}

/// No order was open when the contact was reported.
#[test]
fn of_a_word_that_came_too_late_whoever_orders_next_is_told() {
    let mut test = stepped();
    test.robot.handle_received(CONTACT, test.now);
    assert_eq!(test.last_event(), None);
    let order = Order { id: OrderId(2), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
    test.robot.handle_order(order, test.now);
    assert!(matches!(test.last_event(), Some(RobotEvent::Failed(OrderId(2), words)) if words.contains("too late")));
    assert_eq!(test.robot.poll_output(), None);
}

/// The contact was reported while the state file was still being written.
#[test]
fn what_has_not_gone_out_when_the_robot_is_lost_never_goes_out() {
    let mut test = stepped();
    let order = Order { id: OrderId(2), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
    test.robot.handle_order(order, test.now);
    test.robot.handle_received(CONTACT, test.now);
    assert!(matches!(test.last_event(), Some(RobotEvent::Failed(OrderId(2), _))));
    assert_eq!(test.robot.poll_output(), None);
}

#[test]
fn one_that_is_lost_against_something_behind_it_is_not_taken_to_stand_before_what_is_ahead() {
    for (backward, is_lost) in [(false, false), (true, true)] {
        let mut test = Test::connected();
        test.robot.reckoning.advance(Heading::South, 0.9);
        test.robot.reckoning.meet(Some("wallDown"), Heading::South).expect("it is new");
        test.robot.reckoning.advance(Heading::North, 0.9);
        let way = Way::Straight {
            towards: Heading::South,
            cells: 1.0,
            backward,
            lasts: Duration::from_millis(330),
            rest: 0.0,
            before: Duration::ZERO,
        };
        let leg = Some(Leg::new(way, LegStage::Sent(Duration::ZERO)));
        let aim = Aim::Touch { is_certain: true, further: 0 };
        test.robot.task =
            Some(OrderTask { order: OrderId(1), action: Action::Recentre, deadline: Duration::MAX, aim, leg, hindered: 0 });
        test.now.since_start += Duration::from_secs(1);
        test.robot.handle_lost("the cable was pulled", test.now);
        assert_eq!(test.robot.lost.is_some(), is_lost, "backward: {backward}");
    }
}

#[test]
fn back_from_touching_or_gauging_a_recentring_is_done() {
    for aim in [Aim::Return, Aim::Gauged] {
        let mut test = Test::connected();
        (test.robot.gauge, test.robot.gauged) = (Some(7.0), Duration::from_secs(3));
        let (order, deadline) = (OrderId(1), Duration::MAX);
        test.robot.task = Some(OrderTask { order, action: Action::Recentre, deadline, aim, leg: None, hindered: 0 });
        test.robot.go_back();
        assert_eq!((test.robot.poll_output(), test.last_event()), (None, Some(RobotEvent::Done(order))), "{aim:?}");
    }
}
