//! The address of an external robot: an address on the network, or a serial device of this machine. The robot's
//! adapter connects later, and only then it is known whether a robot answers.

use std::fmt;
use std::net::IpAddr;

use super::error::SettingsError;
use super::host;
use super::layers::Layers;
use super::reading::read;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotKind {
    Sim,
    /// The virtual robot in the page of a browser, over TCP.
    VirtualTcp,
    /// The virtual robot in the page of a browser, over WebSocket, as in its version of 2021.
    VirtualWs,
    /// A robot that uses our line protocol, over TCP or a serial device.
    Line,
}

impl RobotKind {
    pub const ALL: [RobotKind; 4] = [RobotKind::Sim, RobotKind::VirtualTcp, RobotKind::VirtualWs, RobotKind::Line];

    pub const fn name(self) -> &'static str {
        match self {
            RobotKind::Sim => "sim",
            RobotKind::VirtualTcp => "virtual-tcp",
            RobotKind::VirtualWs => "virtual-ws",
            RobotKind::Line => "line",
        }
    }

    /// Whether robots of this kind may have a sonar; the robot itself says whether it has one.
    pub const fn may_have_sonar(self) -> bool {
        match self {
            RobotKind::Sim | RobotKind::Line => true,
            RobotKind::VirtualTcp | RobotKind::VirtualWs => false,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RobotAddress {
    Here,
    Network {
        host: String,
        port: u16,
    },
    /// Path or name of a serial device, such as `/dev/ttyUSB0` or `COM3`.
    Device(String),
}

impl RobotAddress {
    /// As written in the settings; `None` for a robot that is part of this program.
    pub fn written(&self) -> Option<String> {
        (*self != RobotAddress::Here).then(|| self.to_string())
    }

    /// Like `written`, but always with the same name for this machine, which has several names.
    pub fn place(&self) -> Option<String> {
        match self {
            RobotAddress::Network { host, port } => {
                let host = host.trim_end_matches('.').to_ascii_lowercase();
                let is_here = host.parse::<IpAddr>().is_ok_and(|address| address.to_canonical().is_loopback());
                Some(format!("{}:{port}", if is_here { "localhost" } else { &host }))
            }
            RobotAddress::Here | RobotAddress::Device(_) => self.written(),
        }
    }
}

impl fmt::Display for RobotAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RobotAddress::Here => Ok(()),
            RobotAddress::Network { host, port } if host.contains(':') => write!(f, "[{host}]:{port}"),
            RobotAddress::Network { host, port } => write!(f, "{host}:{port}"),
            RobotAddress::Device(name) => f.write_str(name),
        }
    }
}

/// Reads the address of a robot of this kind. The kind's defaults replace missing parts.
pub(super) fn robot_address(layers: &Layers, key: &str, kind: RobotKind) -> Result<RobotAddress, SettingsError> {
    let written: String = read(layers, key)?;
    // A device name may have colons too, but a host never has a slash.
    let com = written.get(..3).filter(|begins| begins.eq_ignore_ascii_case("COM")).and_then(|_| written.get(3..));
    let is_device = written.contains(['/', '\\']) || com.is_some_and(|number| number.parse::<u8>().is_ok());
    match kind {
        RobotKind::Sim if written.is_empty() => Ok(RobotAddress::Here),
        RobotKind::Sim => {
            let advice = "leave the address empty, or choose another kind of robot: virtual-tcp, virtual-ws or line";
            Err(layers.wrong_with_advice(key, "the simulated robot is part of this program and has no address", advice))
        }
        RobotKind::VirtualTcp => network(&written, Some(8999)).ok_or_else(|| no_host(layers, key, 8999)),
        RobotKind::VirtualWs => network(&written, Some(8091)).ok_or_else(|| no_host(layers, key, 8091)),
        RobotKind::Line if written.is_empty() => Err(layers.wrong(key, "a robot of the kind line needs an address")),
        RobotKind::Line if is_device => Ok(RobotAddress::Device(written)),
        RobotKind::Line => {
            let problem = "it is neither a host with a port nor the path of a serial device";
            network(&written, None).ok_or_else(|| layers.wrong(key, problem))
        }
    }
}

/// Parses an address on the network; a missing port becomes the usual port.
fn network(written: &str, usual: Option<u16>) -> Option<RobotAddress> {
    let written = if written.is_empty() { "localhost" } else { written };
    let (host, port) = host::host_and_port(written)?;
    Some(RobotAddress::Network { host, port: port.or(usual)? })
}

fn no_host(layers: &Layers, key: &str, usual: u16) -> SettingsError {
    let advice =
        format!("write HOST or HOST:PORT, such as localhost:{usual}; or leave it empty for this machine and the default port");
    layers.wrong_with_advice(key, "its host is missing, or its port is not valid", &advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Flag, Sources, load};

    fn given(robot: &str) -> Result<(RobotKind, String), String> {
        let sources = Sources { flags: Flag::robot(robot).into(), ..Sources::default() };
        load(&sources)
            .map(|settings| (settings.hall.robot.kind, settings.hall.robot.address.to_string()))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn an_address_is_completed_by_what_is_usual_for_its_kind() {
        for (robot, kind, address) in [
            ("sim", RobotKind::Sim, ""),
            ("virtual-tcp", RobotKind::VirtualTcp, "localhost:8999"),
            ("virtual-tcp=hall.example", RobotKind::VirtualTcp, "hall.example:8999"),
            ("virtual-ws", RobotKind::VirtualWs, "localhost:8091"),
            ("virtual-ws=[::1]:9", RobotKind::VirtualWs, "[::1]:9"),
            ("line=robot.example:4000", RobotKind::Line, "robot.example:4000"),
            ("line=/dev/ttyUSB0", RobotKind::Line, "/dev/ttyUSB0"),
            ("line=/dev/serial/by-path/pci-0:1", RobotKind::Line, "/dev/serial/by-path/pci-0:1"),
            ("line=COM3", RobotKind::Line, "COM3"),
        ] {
            assert_eq!(given(robot), Ok((kind, address.to_owned())), "{robot}");
        }
    }

    #[test]
    fn a_line_over_a_device_is_told_from_one_over_the_network() {
        let address =
            |robot| load(&Sources { flags: Flag::robot(robot).into(), ..Sources::default() }).map(|s| s.hall.robot.address);
        assert_eq!(address("line=com12"), Ok(RobotAddress::Device("com12".into())));
        assert_eq!(address("line=com:12"), Ok(RobotAddress::Network { host: "com".into(), port: 12 }));
    }

    #[test]
    fn a_wrong_kind_or_address_is_refused_with_what_to_do() {
        for (robot, expect) in [
            (
                "mbot",
                "setting robot.kind = \"mbot\" (from flag --robot): there is no such kind of robot; write one of: sim, virtual",
            ),
            ("", "setting robot.kind = \"\" (from flag --robot): there is no such kind of robot; write one of: sim, virtual-tcp"),
            (
                "sim=localhost",
                "setting robot.address = \"localhost\" (from flag --robot): the simulated robot is part of this program",
            ),
            (
                "line",
                "setting robot.address = \"\" (from flag --robot): a robot of the kind line needs an address; write HOST:PORT",
            ),
            (
                "line=ttyUSB0",
                "setting robot.address = \"ttyUSB0\" (from flag --robot): it is neither a host with a port nor the path",
            ),
            (
                "line=host",
                "setting robot.address = \"host\" (from flag --robot): it is neither a host with a port nor the path of a",
            ),
            (
                "virtual-tcp=a:0",
                "setting robot.address = \"a:0\" (from flag --robot): its host is missing, or its port is not valid; write",
            ),
            (
                "virtual-ws=/dev/tty",
                "setting robot.address = \"/dev/tty\" (from flag --robot): its host is missing, or its port is not",
            ),
            (
                "virtual-ws=ws://a",
                "setting robot.address = \"ws://a\" (from flag --robot): its host is missing, or its port is not valid",
            ),
        ] {
            let said = given(robot).expect_err(robot);
            assert!(said.starts_with(expect), "{said}");
        }
    }

    #[test]
    fn the_flag_says_kind_and_address_whatever_the_environment_says() {
        let environment = ["KIND", "ADDRESS"].into_iter().zip(["line", "/dev/ttyUSB0"]);
        let environment = environment.map(|(key, value)| (format!("HALLSWEEP__ROBOT__{key}"), value.to_owned())).collect();
        let mut sources = Sources { environment, ..Sources::default() };
        assert_eq!(load(&sources).map(|settings| settings.hall.robot.kind), Ok(RobotKind::Line));
        sources.flags = Flag::robot("sim").into();
        assert_eq!(load(&sources).map(|settings| settings.hall.robot.address), Ok(RobotAddress::Here));
    }
}
