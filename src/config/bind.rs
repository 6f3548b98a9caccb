//! The address of a door (HTTP, CoAP, MQTT): one address, or both addresses of `localhost`. Whether the ports are
//! free is known only when they are bound.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

const LOCALHOST: &str = "localhost";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bind {
    pub at: BindAddress,
    /// Whether the address was set explicitly. If not, another port is used when the default port is in use.
    pub is_chosen: bool,
}

/// Addresses and port of a door. Port 0 means any free port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindAddress {
    /// `127.0.0.1` and `::1`: clients that connect to `localhost` may use either address.
    Localhost(u16),
    Address(SocketAddr),
}

impl BindAddress {
    /// Parses `localhost:8080`, `127.0.0.1:8080` or `[::1]:8080`.
    pub(super) fn read(written: &str) -> Option<BindAddress> {
        match written.split_once(':') {
            Some((LOCALHOST, port)) => port.parse().ok().map(BindAddress::Localhost),
            _ => written.parse().ok().map(BindAddress::Address),
        }
    }

    /// All addresses; the first one is shown to users.
    pub fn addresses(self) -> Vec<SocketAddr> {
        match self {
            BindAddress::Localhost(port) => {
                let both: [IpAddr; 2] = [Ipv4Addr::LOCALHOST.into(), Ipv6Addr::LOCALHOST.into()];
                both.map(|ip| SocketAddr::new(ip, port)).to_vec()
            }
            BindAddress::Address(address) => vec![address],
        }
    }

    pub const fn first(self) -> SocketAddr {
        match self {
            BindAddress::Localhost(port) => SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port),
            BindAddress::Address(address) => address,
        }
    }

    pub fn is_local(self) -> bool {
        self.first().ip().to_canonical().is_loopback()
    }

    pub const fn with_port(self, port: u16) -> BindAddress {
        match self {
            BindAddress::Localhost(_) => BindAddress::Localhost(port),
            BindAddress::Address(address) => BindAddress::Address(SocketAddr::new(address.ip(), port)),
        }
    }
}

/// Address of a door as seen from this machine. A door that listens on all addresses can also be reached at this
/// address, even in a container whose port is published. Other machines need another address. The address is always
/// written in the same way, since a browser that is signed in at `127.0.0.1` is not signed in at `localhost`.
pub fn from_here(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        ip if !ip.is_unspecified() => ip,
        IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
    };
    SocketAddr::new(ip, address.port())
}

impl fmt::Display for BindAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BindAddress::Localhost(port) => write!(f, "{LOCALHOST}:{port}"),
            BindAddress::Address(address) => write!(f, "{address}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn localhost_means_both_of_its_addresses() {
        let at = BindAddress::read("localhost:8080").expect("it is one");
        assert_eq!(at.addresses().iter().map(ToString::to_string).collect::<Vec<_>>(), ["127.0.0.1:8080", "[::1]:8080"]);
        assert_eq!((at.to_string(), at.first(), at.is_local()), ("localhost:8080".into(), at.addresses()[0], true));
        for wrong in ["localhost", "localhost:", "localhost:65536", "elsewhere:80", "8080", ""] {
            assert_eq!(BindAddress::read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn one_address_is_one_address() {
        for (written, is_local) in
            [("127.0.0.1:1", true), ("[::1]:1", true), ("[::ffff:127.0.0.1]:1", true), ("0.0.0.0:1", false)]
        {
            let at = BindAddress::read(written).expect("it is one");
            assert_eq!((at.to_string().as_str(), at.addresses().len(), at.is_local()), (written, 1, is_local));
            assert_eq!(at.with_port(7).first().port(), 7);
        }
    }
}
