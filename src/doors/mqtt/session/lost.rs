//! Why there is no connection to the broker, as sentences for the log. In every case the program tries to connect
//! again.

use std::time::Duration;

use rumqttc::v5::mqttbytes::v5::ConnectReturnCode as Code;
use rumqttc::{ConnectReturnCode, ConnectionError, v5};

#[derive(Debug, thiserror::Error)]
pub(super) enum Lost {
    #[error("the broker refuses the connection: {0}")]
    Refused(&'static str),
    #[error("{0}")]
    Broken(String),
    #[error("the broker has not answered within {} s", .0.as_secs_f32())]
    NoGreeting(Duration),
    #[error("the broker has acknowledged no message for {} s", .0.as_secs_f32())]
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

impl From<v5::ConnectionError> for Lost {
    fn from(error: v5::ConnectionError) -> Lost {
        match error {
            v5::ConnectionError::ConnectionRefused(code)
            | v5::ConnectionError::MqttState(v5::StateError::ConnFail { reason: code }) => Lost::Refused(in_words_of_five(code)),
            v5::ConnectionError::MqttState(_)
            | v5::ConnectionError::Timeout(_)
            | v5::ConnectionError::Tls(_)
            | v5::ConnectionError::Io(_)
            | v5::ConnectionError::NotConnAck(_)
            | v5::ConnectionError::RequestsDone => Lost::Broken(root(&error)),
        }
    }
}

/// Returns the root cause of an error. The errors above the root cause only name the layers that it has passed.
fn root(error: &dyn std::error::Error) -> String {
    let mut deepest = error;
    while let Some(source) = deepest.source() {
        deepest = source;
    }
    deepest.to_string()
}

fn in_words(code: ConnectReturnCode) -> &'static str {
    match code {
        ConnectReturnCode::RefusedProtocolVersion => "it does not speak MQTT 3.1.1; see mqtt.version",
        ConnectReturnCode::BadClientId => "it does not accept our client id",
        ConnectReturnCode::ServiceUnavailable => "it is not ready",
        ConnectReturnCode::BadUserNamePassword => "it does not accept this name and password; see mqtt.name and mqtt.password",
        ConnectReturnCode::NotAuthorized => "it does not authorize us; see mqtt.name and mqtt.password, and its own rules",
        ConnectReturnCode::Success => "it answered CONNECT at the wrong time",
    }
}

fn in_words_of_five(code: Code) -> &'static str {
    let three = match code {
        Code::RefusedProtocolVersion | Code::UnsupportedProtocolVersion => return "it does not speak MQTT 5; see mqtt.version",
        Code::BadClientId | Code::ClientIdentifierNotValid => ConnectReturnCode::BadClientId,
        Code::ServiceUnavailable | Code::ServerUnavailable | Code::ServerBusy => ConnectReturnCode::ServiceUnavailable,
        Code::BadUserNamePassword => ConnectReturnCode::BadUserNamePassword,
        Code::NotAuthorized | Code::Banned => ConnectReturnCode::NotAuthorized,
        Code::Success => ConnectReturnCode::Success,
        Code::TopicNameInvalid | Code::PayloadFormatInvalid | Code::PacketTooLarge | Code::RetainNotSupported => {
            return "it does not accept our last will";
        }
        Code::UseAnotherServer | Code::ServerMoved => return "it tells us to use another broker",
        Code::QuotaExceeded | Code::ConnectionRateExceeded => return "its quota or connection rate is exceeded",
        Code::UnspecifiedError
        | Code::MalformedPacket
        | Code::ProtocolError
        | Code::ImplementationSpecificError
        | Code::BadAuthenticationMethod
        | Code::QoSNotSupported => return "it gives no reason",
    };
    in_words(three)
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
