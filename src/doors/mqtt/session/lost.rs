//! Why there is no connection: words for the log. What follows is always the same, another attempt.

use std::time::Duration;

use rumqttc::{ConnectReturnCode, ConnectionError};

#[derive(Debug, thiserror::Error)]
pub(super) enum Lost {
    #[error("it refuses us: {0}")]
    Refused(&'static str),
    /// The network, or the protocol.
    #[error("{0}")]
    Broken(String),
    #[error("it has not answered within {} s", .0.as_secs_f32())]
    NoGreeting(Duration),
    #[error("it has acknowledged nothing for {} s", .0.as_secs_f32())]
    NoAcknowledgement(Duration),
}

impl From<ConnectionError> for Lost {
    fn from(error: ConnectionError) -> Lost {
        match error {
            ConnectionError::ConnectionRefused(code) => Lost::Refused(in_words(code)),
            ConnectionError::Io(_)
            | ConnectionError::NetworkTimeout
            | ConnectionError::FlushTimeout
            | ConnectionError::MqttState(_)
            | ConnectionError::Tls(_)
            | ConnectionError::NotConnAck(_)
            | ConnectionError::RequestsDone => Lost::Broken(root(&error)),
        }
    }
}

/// What is at the bottom of an error: the layers above only say through which hands it went.
fn root(error: &dyn std::error::Error) -> String {
    let mut deepest = error;
    while let Some(source) = deepest.source() {
        deepest = source;
    }
    deepest.to_string()
}

fn in_words(code: ConnectReturnCode) -> &'static str {
    match code {
        ConnectReturnCode::RefusedProtocolVersion => "it does not speak MQTT 3.1.1",
        ConnectReturnCode::BadClientId => "it does not take our client id",
        ConnectReturnCode::ServiceUnavailable => "it is not ready",
        ConnectReturnCode::BadUserNamePassword => "it knows no such name and password; see mqtt.name and mqtt.password",
        ConnectReturnCode::NotAuthorized => "it lets in only whom it knows; see mqtt.name and mqtt.password, and its own rules",
        ConnectReturnCode::Success => "it answered CONNECT out of turn",
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use rumqttc::{StateError, mqttbytes};

    use super::*;

    #[test]
    fn what_is_at_the_bottom_is_said_and_what_the_user_can_mend() {
        let reset = Error::new(ErrorKind::ConnectionReset, "reset by peer");
        let deep = ConnectionError::MqttState(StateError::Deserialization(mqttbytes::Error::Io(reset)));
        assert_eq!(Lost::from(deep).to_string(), "reset by peer");
        let refused = Lost::from(ConnectionError::ConnectionRefused(ConnectReturnCode::BadUserNamePassword)).to_string();
        assert!(refused.contains("mqtt.name") && refused.contains("mqtt.password"), "{refused}");
    }
}
