//! The program under the storm, in a separate process: its doors, main loop and store as `app` opens them, and a
//! robot that executes every order and reports when a halt reaches its port.

use std::io::Write;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use hallsweep::app;
use hallsweep::runtime::halt::Halts;
use hallsweep::runtime::link::{RobotSide, Stamped};
use hallsweep::{config, telemetry};
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::robot::Parts;

use crate::clock::now;

/// Argument with which the benchmark starts itself as this program.
pub(crate) const WORD: &str = "app";

/// Duration of a step or a turn.
const STEP: Duration = Duration::from_millis(2);

/// Serves with the settings of the environment until the process is killed. It prints `doors HTTP COAP MQTT` once,
/// `moves` at the robot's first step after a halt, and `halt EPOCH NANOSECONDS` at each halt.
pub(crate) fn serve() {
    let settings = config::load(&config::sources(None, Vec::new())).expect("the benchmark gives good settings");
    telemetry::start(&settings.log);
    let (say, said) = channel::<String>();
    // A separate thread writes, so that a full pipe does not block the robot.
    std::thread::spawn(move || {
        let mut out = std::io::stdout();
        for line in said {
            if out.write_all(line.as_bytes()).and_then(|()| out.flush()).is_err() {
                break;
            }
        }
    });
    let robot = say.clone();
    let served = app::serve_robot(
        &settings,
        Box::new(move |side| Box::pin(Wheels { side, say: robot, stands: true }.run())),
        |doors, _| {
            let [coap, mqtt] = [doors.coap, doors.mqtt].map(|door| door.expect("every door is open").at);
            let _ = say.send(format!("doors {} {coap} {mqtt}\n", doors.http.at));
        },
    );
    served.expect("it serves until it is ended");
}

struct Wheels {
    side: RobotSide,
    say: Sender<String>,
    /// Whether the robot has not moved since its last halt.
    stands: bool,
}

impl Wheels {
    async fn run(mut self) {
        let mut report = RobotEvent::LinkUp(Capabilities {
            step: STEP,
            turn: STEP,
            photo: STEP,
            arm: Duration::ZERO,
            nudges: false,
            parts: Parts::ROUND_ROBOT,
        });
        while self.side.reports.send(report).await.is_ok() {
            report = tokio::select! {
                biased;
                halts = self.side.halts.raised() => {
                    self.halted(halts);
                    RobotEvent::Sonar(None)
                }
                order = self.side.orders.recv() => match order {
                    Some(order) => self.obey(order).await,
                    None => return,
                },
            };
        }
    }

    async fn obey(&mut self, Stamped { order, halts }: Stamped) -> RobotEvent {
        if halts < self.side.halts.now().count {
            return RobotEvent::Halted(order.id, false);
        }
        if order.action.is_motion() && std::mem::take(&mut self.stands) {
            let _ = self.say.send("moves\n".to_owned());
        }
        tokio::select! {
            biased;
            halts = self.side.halts.raised() => {
                self.halted(halts);
                RobotEvent::Halted(order.id, true)
            }
            () = tokio::time::sleep(STEP) => RobotEvent::Done(order.id),
        }
    }

    fn halted(&mut self, halts: Halts) {
        self.stands = true;
        let _ = self.say.send(format!("halt {} {}\n", halts.epoch.0, now()));
    }
}
