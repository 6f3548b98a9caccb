//! The address of another broker, with login and encryption. The connection itself is in `transport`.

use std::fmt;
use std::sync::Arc;

use rumqttc::{NetworkOptions, TlsConfiguration, Transport};
use rustls::ClientConfig;

use super::times::Times;
use mqtt_gate::packet::Version;

/// Maximum number of unacknowledged publications. With a round trip of 200 ms this allows three hundred publications
/// a second, more than are ever published.
pub(super) const IN_FLIGHT: usize = 64;

/// rumqttc's own maximum of unacknowledged publications. It is above `IN_FLIGHT`, so that acknowledgements in another
/// order do not block.
pub(super) const IN_FLIGHT_BELOW: u16 = 128;

/// Additional room in the queue to rumqttc, for a subscription, a ping and two last messages.
pub(super) const BESIDE: usize = 8;

#[derive(Clone)]
pub struct SessionLink {
    pub version: Version,
    pub host: String,
    pub port: u16,
    pub tls: Option<Arc<ClientConfig>>,
    pub login: Option<(String, String)>,
    /// Our client id. No other client of the broker may have the same id.
    pub client_id: String,
}

impl SessionLink {
    pub(super) fn transport(&self) -> Option<Transport> {
        let tls = self.tls.as_ref()?;
        Some(Transport::tls_with_config(TlsConfiguration::Rustls(Arc::clone(tls))))
    }
}

pub(super) fn network(times: &Times) -> NetworkOptions {
    let mut network = NetworkOptions::new();
    network.set_tcp_nodelay(true);
    // rumqttc's own time limit is longer than that of the session, so that the session's limit ends first.
    network.set_connection_timeout((times.greeting * 2).as_secs().max(1));
    network
}

impl fmt::Display for SessionLink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = if self.tls.is_some() { "mqtts" } else { "mqtt" };
        let (open, close) = if self.host.contains(':') { ("[", "]") } else { ("", "") };
        write!(f, "{scheme}://{open}{}{close}:{}", self.host, self.port)
    }
}

impl fmt::Debug for SessionLink {
    /// Shows the address without the login, because the login must not be logged.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Link({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_shown_without_its_login() {
        let login = Some(("robot".to_owned(), "secret".to_owned()));
        let (host, client_id) = ("::1".to_owned(), "hallsweep-1".to_owned());
        let link = SessionLink { version: Version::Three, host, port: 1883, tls: None, login, client_id };
        assert_eq!(link.to_string(), "mqtt://[::1]:1883");
        assert_eq!(format!("{link:?}"), "Link(mqtt://[::1]:1883)");
    }
}
