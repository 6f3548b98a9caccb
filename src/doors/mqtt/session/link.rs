//! Where a broker is and how it is reached: all that a connection is made of. The connection itself is `transport`.

use std::fmt;
use std::sync::Arc;

use rumqttc::{LastWill, MqttOptions, QoS, TlsConfiguration, Transport};
use rustls::ClientConfig;

use super::super::publication::{LARGEST, Publication};
use super::times::Times;

/// So many publications wait for the broker's acknowledgement: over a line of 200 ms three hundred a second, more than happen.
pub(super) const IN_FLIGHT: usize = 64;

/// rumqttc's own bound lies above ours, so that an acknowledgement out of order holds nothing up.
const IN_FLIGHT_BELOW: u16 = 128;

#[derive(Clone)]
pub struct Link {
    pub host: String,
    pub port: u16,
    pub tls: Option<Arc<ClientConfig>>,
    /// Name and password, where it asks for them.
    pub login: Option<(String, String)>,
    /// What it calls us; no other client of the broker may be called so.
    pub client_id: String,
}

impl Link {
    /// What rumqttc is told, with the last will that the broker speaks when we are lost.
    pub(super) fn options(&self, will: Publication, times: &Times) -> MqttOptions {
        let mut options = MqttOptions::new(&self.client_id, &self.host, self.port);
        options.set_clean_session(true).set_keep_alive(times.keep_alive);
        options.set_max_packet_size(LARGEST, LARGEST).set_inflight(IN_FLIGHT_BELOW);
        options.set_last_will(LastWill::new(will.topic, Vec::from(will.payload), QoS::AtLeastOnce, will.retain));
        if let Some((name, password)) = &self.login {
            options.set_credentials(name, password);
        }
        if let Some(tls) = &self.tls {
            options.set_transport(Transport::tls_with_config(TlsConfiguration::Rustls(Arc::clone(tls))));
        }
        options
    }
}

impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = if self.tls.is_some() { "mqtts" } else { "mqtt" };
        let (open, close) = if self.host.contains(':') { ("[", "]") } else { ("", "") };
        write!(f, "{scheme}://{open}{}{close}:{}", self.host, self.port)
    }
}

impl fmt::Debug for Link {
    /// Without the login, which is in no log.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Link({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link() -> Link {
        let login = Some(("robot".to_owned(), "secret".to_owned()));
        Link { host: "::1".to_owned(), port: 1883, tls: None, login, client_id: "hallsweep-1".to_owned() }
    }

    #[test]
    fn a_broker_is_told_who_we_are_and_what_to_say_when_we_are_gone() {
        let will = Publication::kept("hallsweep/discovery/availability".to_owned(), "offline");
        let options = link().options(will, &Times::default());
        assert_eq!(options.client_id(), "hallsweep-1");
        assert_eq!(options.broker_address(), ("::1".to_owned(), 1883));
        assert!(options.clean_session() && options.credentials().is_some());
        let will = options.last_will().expect("there is one");
        assert_eq!(
            (will.topic.as_str(), &will.message[..], will.retain),
            ("hallsweep/discovery/availability", &b"offline"[..], true)
        );
    }

    #[test]
    fn a_link_is_shown_without_its_login() {
        assert_eq!(link().to_string(), "mqtt://[::1]:1883");
        assert_eq!(format!("{:?}", link()), "Link(mqtt://[::1]:1883)");
    }
}
