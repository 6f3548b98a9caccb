//! Adapts rumqttc's MQTT 5 client to `transport`.

use bytes::Bytes;
use futures_util::stream::{Stream, unfold};
use rumqttc::Outgoing;
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{
    Filter, LastWill, Packet, PubAck, PubAckReason, Publish, PublishProperties, RetainForwardRule, SubscribeReasonCode,
};
use rumqttc::v5::{AsyncClient, Event as Happened, MqttOptions};

use super::super::publication::{LARGEST, Publication};
use super::event::{Event, Heard};
use super::link::{BESIDE, IN_FLIGHT, IN_FLIGHT_BELOW, SessionLink, network};
use super::lost::Lost;
use super::times::Times;
use mqtt_gate::packet::properties::Property;

pub(super) struct Five(AsyncClient);

fn options(link: &SessionLink, will: Publication, times: &Times) -> MqttOptions {
    let mut options = MqttOptions::new(&link.client_id, &link.host, link.port);
    options.set_clean_start(true).set_keep_alive(times.keep_alive);
    options.set_max_packet_size(u32::try_from(LARGEST).ok()).set_outgoing_inflight_upper_limit(IN_FLIGHT_BELOW);
    options.set_last_will(LastWill::new(will.topic, Vec::from(will.payload), QoS::AtLeastOnce, will.retain, None));
    if let Some((name, password)) = &link.login {
        options.set_credentials(name, password);
    }
    if let Some(transport) = link.transport() {
        options.set_transport(transport);
    }
    options.set_network_options(network(times));
    options
}

impl Five {
    pub(super) fn begin(
        link: &SessionLink,
        will: Publication,
        times: &Times,
    ) -> (Five, impl Stream<Item = Result<Event, Lost>> + Send + use<>) {
        let (client, events) = AsyncClient::new(options(link, will, times), IN_FLIGHT + BESIDE);
        // rumqttc's own loop must not be cancelled; the reason is in `three`.
        let events = unfold(events, async |mut events| {
            let happened = events.poll().await.map(event).map_err(Lost::from);
            Some((happened, events))
        });
        (Five(client), events)
    }

    pub(super) fn subscribe(&self, filters: Vec<String>, kept: Vec<String>) -> bool {
        let filters = filters.into_iter().map(|path| Filter::new(path, QoS::AtLeastOnce));
        // With these options the broker sends only messages that other clients publish from now on. It sends neither
        // our own messages nor retained ones.
        let now_and_theirs =
            |path| Filter { nolocal: true, retain_forward_rule: RetainForwardRule::Never, ..Filter::new(path, QoS::AtMostOnce) };
        self.0.try_subscribe_many(filters.chain(kept.into_iter().map(now_and_theirs))).is_ok()
    }

    pub(super) fn publish(&self, publication: &Publication) -> bool {
        let Publication { topic, payload, retain, beside } = publication;
        let properties = beside.with_properties(properties);
        self.0.try_publish_with_properties(topic, QoS::AtLeastOnce, *retain, payload.clone(), properties).is_ok()
    }

    pub(super) fn hang_up(&self) -> bool {
        self.0.try_disconnect().is_ok()
    }
}

fn properties(properties: &[Property<'_>]) -> PublishProperties {
    let mut said = PublishProperties::default();
    for property in properties {
        if let Property::PayloadFormat(flag) = *property {
            said.payload_format_indicator = Some(flag);
        } else if let Property::ContentType(content) = *property {
            said.content_type = Some(content.to_owned());
        } else if let Property::CorrelationData(data) = *property {
            said.correlation_data = Some(Bytes::copy_from_slice(data));
        } else if let Property::User(name, value) = *property {
            said.user_properties.push((name.to_owned(), value.to_owned()));
        }
    }
    said
}

fn event(happened: Happened) -> Event {
    match happened {
        Happened::Outgoing(Outgoing::Publish(id)) => Event::Sent(id),
        Happened::Outgoing(Outgoing::Disconnect) => Event::HungUp,
        Happened::Incoming(Packet::ConnAck(greeting)) => {
            let said = greeting.properties;
            let largest = said.as_ref().and_then(|said| said.max_packet_size);
            Event::Greeted { largest, receive_maximum: said.and_then(|said| said.receive_max) }
        }
        Happened::Incoming(Packet::SubAck(answer)) => {
            Event::Subscribed(answer.return_codes.iter().map(|code| matches!(code, SubscribeReasonCode::Success(_))).collect())
        }
        Happened::Incoming(Packet::PubAck(PubAck { pkid, reason, .. })) => {
            let is_refused = !matches!(reason, PubAckReason::Success | PubAckReason::NoMatchingSubscribers);
            Event::Acknowledged { id: pkid, is_refused }
        }
        Happened::Incoming(Packet::Publish(said)) => heard(said),
        Happened::Incoming(_) | Happened::Outgoing(_) => Event::Other,
    }
}

fn heard(said: Publish) -> Event {
    let Ok(topic) = String::from_utf8(Vec::from(said.topic)) else { return Event::Other };
    let answer_to = said.properties.and_then(|properties| {
        let correlation: Option<Bytes> = properties.correlation_data;
        properties.response_topic.map(|topic| (topic, correlation))
    });
    Event::Heard(Heard { topic, payload: said.payload, id: said.pkid, is_duplicate: said.dup, retain: said.retain, answer_to })
}
