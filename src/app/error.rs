//! Why the program cannot start or cannot continue: one line for the person who started it, which also says what to
//! do.

use std::net::SocketAddr;
use std::path::PathBuf;

use crate::access::AccessError;
use crate::doors::http::TlsError;
use crate::doors::mqtt;
use crate::robots::Unusable;
use crate::robots::emulator::EmulatorError;
use crate::storage::sqlite::OpenError;
use hallsweep_core::hall::HallId;
use hallsweep_core::units::MissionId;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    Http,
    Coap,
    Mqtt,
}

impl Port {
    pub const fn name(self) -> &'static str {
        match self {
            Port::Http => "HTTP",
            Port::Coap => "CoAP",
            Port::Mqtt => "MQTT",
        }
    }

    pub const fn flag(self) -> &'static str {
        match self {
            Port::Http => "--http",
            Port::Coap => "--coap",
            Port::Mqtt => "--mqtt",
        }
    }

    pub const fn usual(self) -> u16 {
        match self {
            Port::Http => 8080,
            Port::Coap => 5683,
            Port::Mqtt => 1883,
        }
    }
}

/// `Display` is one line for the person who started the program, and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    #[error(transparent)]
    Unusable(#[from] Unusable),
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    #[error(transparent)]
    Access(#[from] AccessError),
    #[error(
        "mission.safe_by is 2, but {0} requires no keys, so two judges cannot be told apart there: set {1}, or write \
         mission.safe_by = 1"
    )]
    NoKeysForJudges(&'static str, &'static str),
    #[error(
        "mission.safe_by is 2, but the number of operators' keys is {0}: add a key with `hallsweep token add NAME --role \
         operator`, or write mission.safe_by = 1"
    )]
    TooFewJudges(usize),
    /// There are operators' keys enough, but too few of them see this hall.
    #[error(
        "mission.safe_by of the hall `{1}` is 2, but the number of operators' keys that see this hall is {0}: add a key with \
         `hallsweep token add NAME --role operator`, or write mission.safe_by = 1"
    )]
    TooFewJudgesOfHall(usize, HallId),
    #[error(
        "mission {0} in the data folder {path} is under way, and it is no exercise: start hallsweep without --exercise and end the \
         mission with RESET, or choose another folder with --data DIR", path = .1.display()
    )]
    MissionNoExercise(MissionId, PathBuf),
    /// The mission, the folder, and the number of test pieces.
    #[error(
        "mission {0} in the data folder {path} is an exercise that is under way: start hallsweep with --exercise {2} and without \
         --seed to continue it or to end it with RESET, or choose another folder with --data DIR", path = .1.display()
    )]
    MissionExercise(MissionId, PathBuf, String),
    #[error(
        "mission {0} in the data folder {path} is an exercise that is under way, but the file exercise.txt, which has its seed, is \
         missing or damaged: put the file back; or move simulated-robot.txt away, start with --exercise NUMBER --seed 1, and end \
         the mission with RESET. Its results are lost then", path = .1.display()
    )]
    ExerciseLost(MissionId, PathBuf),
    #[error(transparent)]
    Tls(#[from] TlsError),
    #[error(transparent)]
    MqttTls(#[from] mqtt::session::TlsError),
    #[error("cannot listen on {address} for {}: {error}; {}", .port.name(), what_to_do(*.port, .error))]
    Bind { port: Port, address: SocketAddr, error: std::io::Error },
    #[error(transparent)]
    Store(#[from] OpenError),
    #[error("the user who runs hallsweep cannot use the data folder {}: give this user access to the folder, or choose another \
             folder with --data DIR", .0.display())]
    ClosedFolder(PathBuf),
    #[error("the program cannot start: {0}")]
    System(std::io::Error),
    /// The core's loop has ended unexpectedly: a fault in the program.
    #[error("hallsweep ended after an internal error: start hallsweep again, and look at the log above")]
    LoopEnded,
}

fn what_to_do(port: Port, error: &std::io::Error) -> String {
    let flag = port.flag();
    if error.kind() == std::io::ErrorKind::AddrInUse {
        let without = if port == Port::Http { String::new() } else { format!(", or turn {} off with {flag} none", port.name()) };
        format!(
            "another program uses this port: end that program, or choose another port with {flag}, such as {flag} localhost:0 \
             for a free port{without}"
        )
    } else if error.kind() == std::io::ErrorKind::PermissionDenied {
        format!("ports below 1024 are for privileged programs: choose a higher port with {flag}")
    } else {
        format!("choose an address of this machine with {flag}, such as 127.0.0.1:{}", port.usual())
    }
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;

    use super::*;

    #[test]
    fn a_port_that_cannot_be_had_is_said_with_what_to_do() {
        let said = |port, error: ErrorKind| {
            let address = "127.0.0.1:999".parse().expect("an address");
            AppError::Bind { port, address, error: error.into() }.to_string()
        };
        let doors = [(Port::Http, "HTTP", "--http"), (Port::Coap, "CoAP", "--coap"), (Port::Mqtt, "MQTT", "--mqtt")];
        for (port, name, flag) in doors {
            let taken = said(port, ErrorKind::AddrInUse);
            assert!(taken.starts_with(&format!("cannot listen on 127.0.0.1:999 for {name}: ")), "{taken}");
            assert!(taken.contains(&format!("{flag} localhost:0")), "{taken}");
            assert!(said(port, ErrorKind::PermissionDenied).ends_with(&format!("choose a higher port with {flag}")));
            let foreign = said(port, ErrorKind::AddrNotAvailable);
            assert!(foreign.contains(&format!("of this machine with {flag}, such as 127.0.0.1:{}", port.usual())), "{foreign}");
        }
    }
}
