//! Adapts rumqttc's MQTT 3.1.1 client to `transport`.

use futures_util::stream::{Stream, unfold};
use rumqttc::{
    AsyncClient, Event as Happened, LastWill, MqttOptions, Outgoing, Packet, QoS, SubscribeFilter, SubscribeReasonCode,
};

use super::super::publication::{LARGEST, Publication};
use super::event::{Event, Heard};
use super::link::{BESIDE, IN_FLIGHT, IN_FLIGHT_BELOW, SessionLink, network};
use super::lost::Lost;
use super::times::Times;

pub(super) struct Three(AsyncClient);

fn options(link: &SessionLink, will: Publication, times: &Times) -> MqttOptions {
    let mut options = MqttOptions::new(&link.client_id, &link.host, link.port);
    options.set_clean_session(true).set_keep_alive(times.keep_alive);
    options.set_max_packet_size(LARGEST, LARGEST).set_inflight(IN_FLIGHT_BELOW);
    options.set_last_will(LastWill::new(will.topic, Vec::from(will.payload), QoS::AtLeastOnce, will.retain));
    if let Some((name, password)) = &link.login {
        options.set_credentials(name, password);
    }
    if let Some(transport) = link.transport() {
        options.set_transport(transport);
    }
    options
}

impl Three {
    pub(super) fn begin(
        link: &SessionLink,
        will: Publication,
        times: &Times,
    ) -> (Three, impl Stream<Item = Result<Event, Lost>> + Send + use<>) {
        let (client, mut events) = AsyncClient::new(options(link, will, times), IN_FLIGHT + BESIDE);
        events.set_network_options(network(times));
        // rumqttc's own loop must not be cancelled, because it would lose what it was about to write. This stream
        // keeps the unfinished call between polls.
        let events = unfold(events, async |mut events| {
            let happened = events.poll().await.map(event).map_err(Lost::from);
            Some((happened, events))
        });
        (Three(client), events)
    }

    pub(super) fn subscribe(&self, filters: Vec<String>, kept: Vec<String>) -> bool {
        let filters = filters.into_iter().map(|path| SubscribeFilter { path, qos: QoS::AtLeastOnce });
        let kept = kept.into_iter().map(|path| SubscribeFilter { path, qos: QoS::AtMostOnce });
        self.0.try_subscribe_many(filters.chain(kept)).is_ok()
    }

    pub(super) fn publish(&self, Publication { topic, payload, retain, .. }: &Publication) -> bool {
        self.0.try_publish(topic, QoS::AtLeastOnce, *retain, Vec::from(payload.clone())).is_ok()
    }

    pub(super) fn hang_up(&self) -> bool {
        self.0.try_disconnect().is_ok()
    }
}

fn event(happened: Happened) -> Event {
    match happened {
        Happened::Outgoing(Outgoing::Publish(id)) => Event::Sent(id),
        Happened::Outgoing(Outgoing::Disconnect) => Event::HungUp,
        Happened::Incoming(Packet::ConnAck(_)) => Event::Greeted { largest: None, receive_maximum: None },
        Happened::Incoming(Packet::SubAck(answer)) => {
            Event::Subscribed(answer.return_codes.iter().map(|code| *code != SubscribeReasonCode::Failure).collect())
        }
        Happened::Incoming(Packet::PubAck(acknowledged)) => Event::Acknowledged { id: acknowledged.pkid, is_refused: false },
        Happened::Incoming(Packet::Publish(said)) => Event::Heard(Heard {
            topic: said.topic,
            payload: said.payload,
            id: said.pkid,
            is_duplicate: said.dup,
            retain: said.retain,
            answer_to: None,
        }),
        Happened::Incoming(_) | Happened::Outgoing(_) => Event::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mqtt_gate::packet::Version;

    #[test]
    fn a_broker_is_told_who_we_are_and_what_to_say_when_we_are_gone() {
        let login = Some(("robot".to_owned(), "secret".to_owned()));
        let (host, client_id) = ("::1".to_owned(), "hallsweep-1".to_owned());
        let link = SessionLink { version: Version::Three, host, port: 1883, tls: None, login, client_id };
        let will = Publication::kept("hallsweep/discovery/availability".to_owned(), "offline");
        let options = options(&link, will, &Times::default());
        assert_eq!(options.client_id(), "hallsweep-1");
        assert_eq!(options.broker_address(), ("::1".to_owned(), 1883));
        assert!(options.clean_session() && options.credentials().is_some());
        let will = options.last_will().expect("there is one");
        assert_eq!(
            (will.topic.as_str(), &will.message[..], will.retain),
            ("hallsweep/discovery/availability", &b"offline"[..], true)
        );
    }
}
