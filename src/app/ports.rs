//! The ports of the doors. All ports are bound before anything stored is opened. So a start that fails because a port
//! is in use changes nothing. The settings say which ports to bind.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener, UdpSocket};

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use socket2::{Domain, Socket, Type};

use super::error::{AppError, Port};
use crate::config::{Bind, BindAddress, Broker, Settings};
use crate::doors::coap::beside;

/// Wanted number of file descriptors: enough for every connection of every door, and for files.
pub(super) const DESCRIPTORS: u64 = 4096;

/// Raises the limit of file descriptors to the wanted number, as far as the system allows; returns the new limit.
/// Most systems start a program with few descriptors and allow more on request. HTTP and MQTT together may need more
/// than these few.
pub fn raise_descriptors(wanted: u64) -> u64 {
    let limit = getrlimit(Resource::Nofile);
    let wanted = limit.maximum.map_or(wanted, |most| most.min(wanted));
    // `None` means that there is no limit.
    let current = limit.current.unwrap_or(u64::MAX);
    if current >= wanted {
        return current;
    }
    match setrlimit(Resource::Nofile, Rlimit { current: Some(wanted), ..limit }) {
        Ok(()) => wanted,
        Err(error) => {
            tracing::debug!(%error, "the number of open files and connections cannot be raised");
            current
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doors {
    pub http: BoundPort,
    pub coap: Option<BoundPort>,
    pub mqtt: Option<BoundPort>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundPort {
    pub at: SocketAddr,
    /// The default port, if this port replaces it because another program uses the default port.
    pub instead_of: Option<u16>,
}

pub(super) struct Ports {
    pub(super) http: Vec<TcpListener>,
    pub(super) coap: Vec<UdpSocket>,
    pub(super) mqtt: Vec<TcpListener>,
    pub(super) doors: Doors,
}

type NotHad = (SocketAddr, io::Error);

/// Length of the listen queue, as far as the system allows. A connection that finds the queue full is dropped
/// silently, and the client tries again after a second. For a STOP this is too late.
const WAITING: i32 = 4096;

/// Maximum number of ports to try. A port that is free at one loopback address may be in use at the other.
const TRIES: usize = 16;

impl Ports {
    pub(super) fn bind(settings: &Settings) -> Result<Ports, AppError> {
        let (http, http_at) = open(Port::Http, settings.http.bind, tcp)?;
        let coap = settings.coap.map(|bind| open(Port::Coap, bind, udp)).transpose()?;
        let coap = coap.map(|(ports, place)| (with_loopback(ports, place.at), place));
        let mqtt = match settings.mqtt.broker {
            Some(Broker::Own { bind, .. }) => Some(open(Port::Mqtt, bind, tcp)?),
            Some(Broker::Other(_)) | None => None,
        };
        let ((coap, coap_at), (mqtt, mqtt_at)) = (coap.unzip(), mqtt.unzip());
        let doors = Doors { http: http_at, coap: coap_at, mqtt: mqtt_at };
        Ok(Ports { http, coap: coap.unwrap_or_default(), mqtt: mqtt.unwrap_or_default(), doors })
    }
}

/// Binds a port at all addresses of a door. If the default port is in use, a free port replaces it.
fn open<P>(
    port: Port,
    bind: Bind,
    one: impl Fn(SocketAddr) -> io::Result<(P, SocketAddr)>,
) -> Result<(Vec<P>, BoundPort), AppError> {
    let (bound, instead_of) = match at_all(bind.at, &one) {
        Err((_, error)) if error.kind() == ErrorKind::AddrInUse && !bind.is_chosen => {
            (at_a_free_one(bind.at, &one), Some(bind.at.first().port()))
        }
        Err((_, error)) if error.kind() == ErrorKind::AddrInUse && bind.at.first().port() == 0 => {
            (at_a_free_one(bind.at, &one), None)
        }
        bound => (bound, None),
    };
    let (ports, addresses): (Vec<P>, Vec<SocketAddr>) =
        bound.map_err(|(address, error)| AppError::Bind { port, address, error })?.into_iter().unzip();
    let at = addresses.first().copied().unwrap_or(bind.at.first());
    if let Some(taken) = instead_of {
        tracing::warn!(door = port.name(), taken, %at, "another program uses the default port of this door: the door uses a free \
                                                        port");
    }
    Ok((ports, BoundPort { at, instead_of }))
}

fn at_a_free_one<P>(
    at: BindAddress,
    one: &impl Fn(SocketAddr) -> io::Result<(P, SocketAddr)>,
) -> Result<Vec<(P, SocketAddr)>, NotHad> {
    let once = || at_all(at.with_port(0), one);
    (1..TRIES).fold(once(), |last, _| last.or_else(|_| once()))
}

/// Binds the same port at each of these addresses. It is no error if the machine lacks the second address.
fn at_all<P>(at: BindAddress, one: &impl Fn(SocketAddr) -> io::Result<(P, SocketAddr)>) -> Result<Vec<(P, SocketAddr)>, NotHad> {
    let mut bound: Vec<(P, SocketAddr)> = Vec::new();
    for mut address in at.addresses() {
        if let Some((_, first)) = bound.first() {
            address.set_port(first.port());
        }
        match one(address) {
            Ok(port) => bound.push(port),
            Err(error) if !bound.is_empty() && error.kind() != ErrorKind::AddrInUse => {
                tracing::debug!(%address, %error, "this machine has no such address");
            }
            Err(error) => return Err((address, error)),
        }
    }
    Ok(bound)
}

fn tcp(address: SocketAddr) -> io::Result<(TcpListener, SocketAddr)> {
    let port = Socket::new(Domain::for_address(address), Type::STREAM, None)?;
    // Only on Unix: there, this option makes a port available as soon as its owner has ended.
    #[cfg(unix)]
    port.set_reuse_address(true)?;
    port.bind(&address.into())?;
    port.listen(WAITING)?;
    port.set_nonblocking(true)?;
    let port = TcpListener::from(port);
    let address = port.local_addr()?;
    Ok((port, address))
}

fn udp(address: SocketAddr) -> io::Result<(UdpSocket, SocketAddr)> {
    let port = UdpSocket::bind(address)?;
    let address = port.local_addr()?;
    Ok((port, address))
}

/// If other machines can reach the port, adds separate sockets for packets from this machine. No flood from elsewhere
/// can fill these sockets (safety S7). The system delivers a packet to the socket that is bound to exactly the
/// packet's destination address.
fn with_loopback(mut ports: Vec<UdpSocket>, at: SocketAddr) -> Vec<UdpSocket> {
    if at.ip().to_canonical().is_loopback() {
        return ports;
    }
    for address in BindAddress::Localhost(at.port()).addresses() {
        match ports.first().map(|first| beside(first, address)) {
            Some(Ok(port)) => ports.push(port),
            // Without the separate socket, packets from this machine go to the common socket or are lost.
            Some(Err(error)) => tracing::warn!(%address, %error, "cannot open a separate socket for CoAP from this machine"),
            None => {}
        }
    }
    ports
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;
    use std::time::Duration;

    use super::*;

    fn bind(at: BindAddress, is_chosen: bool) -> Result<(Vec<TcpListener>, BoundPort), AppError> {
        open(Port::Mqtt, Bind { at, is_chosen }, tcp)
    }

    /// Safety S9: connections that arrive while a door is busy wait in the system's queue, so clients need not try
    /// again after a second.
    #[test]
    fn hundreds_of_connections_may_wait_to_be_received() {
        let (_port, address) = tcp(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
        let come = |n| {
            std::net::TcpStream::connect_timeout(&address, Duration::from_secs(30)).unwrap_or_else(|error| panic!("{n}: {error}"))
        };
        let waiting: Vec<_> = (0..500).map(come).collect();
        assert_eq!(waiting.len(), 500);
    }

    #[test]
    fn localhost_is_listened_to_at_both_addresses_by_one_port() {
        let (ports, place) = bind(BindAddress::Localhost(0), true).expect("a free port");
        let at: Vec<_> = ports.iter().map(|port| port.local_addr().expect("it is bound")).collect();
        assert_eq!((at[0], place.instead_of), (place.at, None));
        assert!(at.iter().all(|address| address.port() == place.at.port() && address.ip().is_loopback()), "{at:?}");
        let has_six = TcpListener::bind("[::1]:0").is_ok();
        assert_eq!(at.len(), if has_six { 2 } else { 1 });
    }

    #[test]
    fn a_port_that_nobody_has_chosen_gives_way_and_one_that_was_chosen_does_not() {
        for taken_at in ["127.0.0.1:0", "[::1]:0"] {
            let Ok(taken) = TcpListener::bind(taken_at) else { continue };
            let port = taken.local_addr().expect("it is bound").port();
            let (ports, place) = bind(BindAddress::Localhost(port), false).expect("another port");
            assert_eq!(place.instead_of, Some(port));
            assert!(place.at.port() != port && !ports.is_empty());
            let refused = bind(BindAddress::Localhost(port), true).expect_err("it is taken");
            assert!(matches!(refused, AppError::Bind { address, .. } if address.port() == port), "{refused}");
        }
    }

    /// Safety S7: a flood that nobody reads fills the common socket, not the socket for this machine.
    #[test]
    fn this_machine_has_a_socket_of_its_own_at_a_port_that_others_reach() {
        let (first, at) = udp("0.0.0.0:0".parse().unwrap()).expect("a free port");
        let ports = with_loopback(vec![first], at);
        let own = ports.iter().find(|port| port.local_addr().unwrap().ip() == Ipv4Addr::LOCALHOST).expect("its own");
        ports.iter().for_each(|port| port.set_nonblocking(true).unwrap());
        let client = UdpSocket::bind("127.0.0.1:0").unwrap();
        for _ in 0..10_000 {
            // 127.0.0.2 represents an address that other machines can reach. Packets that do not fit into the socket
            // are lost.
            let _ = client.send_to(&[0; 1024], ("127.0.0.2", at.port()));
        }
        client.send_to(b"stop", ("127.0.0.1", at.port())).unwrap();
        let mut heard = [0; 2048];
        let length = own.recv(&mut heard).expect("it is there");
        assert_eq!(&heard[..length], b"stop");
        assert!(own.recv(&mut heard).is_err(), "and nothing else");
        assert!(ports[0].recv(&mut heard).is_ok(), "which came to the other");
        for taken in ["0.0.0.0", "127.0.0.1"] {
            assert!(UdpSocket::bind((taken, at.port())).is_err(), "{taken}: nobody else has a part in it");
            let elsewhere = UdpSocket::bind("127.0.0.1:0").unwrap();
            let address = SocketAddr::new(taken.parse().unwrap(), at.port());
            assert!(beside(&elsewhere, address).is_err(), "{taken}: not even who is ready to share");
        }
    }

    #[test]
    fn a_port_of_this_machine_alone_has_no_other_sockets() {
        let (first, at) = udp("127.0.0.1:0".parse().unwrap()).expect("a free port");
        assert_eq!(with_loopback(vec![first], at).len(), 1);
    }
}
