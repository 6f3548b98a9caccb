//! The ports of the doors: all of them are had before anything that is kept is opened, so that a port in use leaves no trace.

use std::net::SocketAddr;

use tokio::net::TcpListener;

use super::AppError;
use crate::config::{Broker, Settings};
use crate::inbound::coap::Socket;

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
    pub(super) http: TcpListener,
    pub(super) coap: Option<Socket>,
    pub(super) mqtt: Option<TcpListener>,
    /// Where they are.
    pub(super) doors: Doors,
}

impl Ports {
    /// Binds every port of the settings.
    ///
    /// # Errors
    /// `AppError::Bind`: which cannot be had, and why.
    pub(super) async fn bind(settings: &Settings) -> Result<Ports, AppError> {
        let (http, http_at) = tcp(settings.http.bind).await.map_err(refused(Port::Http, settings.http.bind))?;
        let mut ports = Ports { http, coap: None, mqtt: None, doors: Doors { http: http_at, coap: None, mqtt: None } };
        if let Some(address) = settings.coap {
            let (socket, coap_at) = coap(address).await.map_err(refused(Port::Coap, address))?;
            (ports.coap, ports.doors.coap) = (Some(socket), Some(coap_at));
        }
        if let Some(Broker::Own { bind, .. }) = settings.mqtt.broker {
            let (listener, mqtt_at) = tcp(bind).await.map_err(refused(Port::Mqtt, bind))?;
            (ports.mqtt, ports.doors.mqtt) = (Some(listener), Some(mqtt_at));
        }
        Ok(ports)
    }
}

async fn tcp(address: SocketAddr) -> std::io::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind(address).await?;
    let address = listener.local_addr()?;
    Ok((listener, address))
}

async fn coap(address: SocketAddr) -> std::io::Result<(Socket, SocketAddr)> {
    let socket = Socket::bind(address).await?;
    let address = socket.address()?;
    Ok((socket, address))
}

fn refused(port: Port, address: SocketAddr) -> impl Fn(std::io::Error) -> AppError {
    move |error| AppError::Bind { port, address, error }
}
