//! THE TABLE of floods: everything that a client without a key, or a viewer, can do to each door. The modules beside
//! this file implement them.

use std::sync::Arc;

use crate::course::Course;

#[path = "floods/coap.rs"]
mod coap;
#[path = "floods/http.rs"]
mod http;
#[path = "floods/mqtt.rs"]
mod mqtt;
#[path = "floods/web.rs"]
mod web;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Door {
    Http,
    Mqtt,
    Coap,
}

/// One way to flood one door.
pub(crate) struct Flood {
    /// Name on the command line.
    pub(crate) name: &'static str,
    pub(crate) door: Door,
    /// Begins the flood, which continues until its course is over.
    pub(crate) begin: fn(&Arc<Course>),
}

const fn flood(door: Door, name: &'static str, begin: fn(&Arc<Course>)) -> Flood {
    Flood { name, door, begin }
}

pub(crate) const FLOODS: [Flood; 32] = [
    flood(Door::Http, "http-bodies", http::bodies),
    flood(Door::Http, "http-bodies-near", http::bodies_near),
    flood(Door::Http, "http-heads", http::heads),
    flood(Door::Http, "http-heads-near", http::heads_near),
    flood(Door::Http, "http-great-heads", http::great_heads),
    flood(Door::Http, "http-silence", http::silence),
    flood(Door::Http, "http-silence-near", http::silence_near),
    flood(Door::Http, "http-refused", http::refused),
    flood(Door::Http, "http-strangers", http::strangers),
    flood(Door::Http, "http-reads", http::reads),
    flood(Door::Http, "http-pipelines", http::pipelines),
    flood(Door::Http, "http-streams", http::streams),
    flood(Door::Http, "http-comings", http::comings),
    flood(Door::Mqtt, "mqtt-refused", mqtt::refused),
    flood(Door::Mqtt, "mqtt-terms", mqtt::terms),
    flood(Door::Mqtt, "mqtt-pings", mqtt::pings),
    flood(Door::Mqtt, "mqtt-unsubscribe", mqtt::unsubscribe),
    flood(Door::Mqtt, "mqtt-filters", mqtt::filters),
    flood(Door::Mqtt, "mqtt-topics", mqtt::topics),
    flood(Door::Mqtt, "mqtt-sessions", mqtt::sessions),
    flood(Door::Mqtt, "mqtt-stalled", mqtt::stalled),
    flood(Door::Mqtt, "mqtt-deaf", mqtt::deaf),
    flood(Door::Mqtt, "mqtt-halves", mqtt::halves),
    flood(Door::Mqtt, "mqtt-halves-near", mqtt::halves_near),
    flood(Door::Mqtt, "mqtt-comings", mqtt::comings),
    flood(Door::Http, "web-refused", web::refused),
    flood(Door::Http, "web-sessions", web::sessions),
    flood(Door::Http, "web-halves", web::halves),
    flood(Door::Coap, "coap-gets", coap::gets),
    flood(Door::Coap, "coap-refused", coap::refused),
    flood(Door::Coap, "coap-malformed", coap::malformed),
    flood(Door::Coap, "coap-observers", coap::observers),
];

pub(crate) fn named(name: &str) -> Option<&'static Flood> {
    FLOODS.iter().find(|flood| flood.name == name)
}
