//! The ports of the doors: all of them are had before anything that is kept is opened, so that a port in use leaves no trace.

use std::io;
use std::net::{SocketAddr, TcpListener, UdpSocket};

use super::AppError;
use crate::config::{Broker, Settings};

/// Whose port it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// The console's and the API's.
    Http,
    /// That of the CoAP resources.
    Coap,
    /// That of our own MQTT broker.
    Mqtt,
}

impl Port {
    /// The door's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Port::Http => "HTTP",
            Port::Coap => "CoAP",
            Port::Mqtt => "MQTT",
        }
    }

    /// The flag that chooses it.
    #[must_use]
    pub const fn flag(self) -> &'static str {
        match self {
            Port::Http => "--http",
            Port::Coap => "--coap",
            Port::Mqtt => "--mqtt",
        }
    }

    /// Its usual number.
    #[must_use]
    pub const fn usual(self) -> u16 {
        match self {
            Port::Http => 8080,
            Port::Coap => 5683,
            Port::Mqtt => 1883,
        }
    }
}

/// Where the doors are, with their real ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doors {
    /// The console and the API.
    pub http: SocketAddr,
    /// The CoAP resources, where there are any.
    pub coap: Option<SocketAddr>,
    /// Our own MQTT broker, where there is one.
    pub mqtt: Option<SocketAddr>,
}

/// What is listened to.
pub(super) struct Ports {
    pub(super) http: Vec<TcpListener>,
    pub(super) coap: Vec<UdpSocket>,
    pub(super) mqtt: Vec<TcpListener>,
    /// Where they are.
    pub(super) doors: Doors,
}

impl Ports {
    /// Binds every port of the settings.
    ///
    /// # Errors
    /// `AppError::Bind`: which cannot be had, and why.
    pub(super) fn bind(settings: &Settings) -> Result<Ports, AppError> {
        let (http, http_at) = tcp(settings.http.bind).map_err(refused(Port::Http, settings.http.bind))?;
        let doors = Doors { http: http_at, coap: None, mqtt: None };
        let mut ports = Ports { http: vec![http], coap: Vec::new(), mqtt: Vec::new(), doors };
        if let Some(address) = settings.coap {
            let (port, at) = udp(address).map_err(refused(Port::Coap, address))?;
            ports.coap.push(port);
            ports.doors.coap = Some(at);
        }
        if let Some(Broker::Own { bind, .. }) = settings.mqtt.broker {
            let (port, at) = tcp(bind).map_err(refused(Port::Mqtt, bind))?;
            ports.mqtt.push(port);
            ports.doors.mqtt = Some(at);
        }
        Ok(ports)
    }
}

fn tcp(address: SocketAddr) -> io::Result<(TcpListener, SocketAddr)> {
    let port = TcpListener::bind(address)?;
    port.set_nonblocking(true)?;
    let address = port.local_addr()?;
    Ok((port, address))
}

fn udp(address: SocketAddr) -> io::Result<(UdpSocket, SocketAddr)> {
    let port = UdpSocket::bind(address)?;
    let address = port.local_addr()?;
    Ok((port, address))
}

fn refused(port: Port, address: SocketAddr) -> impl Fn(io::Error) -> AppError {
    move |error| AppError::Bind { port, address, error }
}
