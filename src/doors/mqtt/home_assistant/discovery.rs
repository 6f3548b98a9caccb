//! The description of the robot for Home Assistant, in one message for all its entities (device-based discovery,
//! <https://www.home-assistant.io/integrations/mqtt/#device-discovery-payload>). The entities use the public topics.
//! Only the vacuum's state has a topic of its own.

use serde_json::{Map, Value, json};

use super::super::topics::Topics;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::world::resource::Resource;

/// Returns the payload for the topic `homeassistant/device/ID/config`.
pub fn config(topics: &Topics, version: &str) -> Value {
    let name = format!("hallsweep {}", topics.id());
    json!({
        "device": {
            "identifiers": [unique(topics)],
            "name": name,
            "manufacturer": "hallsweep",
            "model": "search robot",
            "sw_version": version,
        },
        "origin": {"name": "hallsweep", "sw_version": version},
        "availability_topic": topics.availability(),
        "qos": 1,
        "components": components(topics),
    })
}

fn components(topics: &Topics) -> Value {
    let all = [
        ("vacuum", vacuum(topics)),
        ("temperature", temperature(topics)),
        ("phase", phase(topics)),
        ("position", position(topics)),
        ("luggage", luggage(topics)),
        ("progress", progress(topics)),
        ("alarm", alarm(topics)),
        ("photo", photo(topics)),
    ];
    let named = all.map(|(name, component)| (name.to_owned(), identified(topics, name, component)));
    Value::Object(named.into_iter().collect::<Map<String, Value>>())
}

/// Describes the robot as a vacuum cleaner. Its buttons send the bare names of our commands: the pause button sends
/// STOP, the start button sends START.
fn vacuum(topics: &Topics) -> Value {
    json!({
        "platform": "vacuum",
        "name": null,
        "supported_features": ["start", "pause", "stop", "return_home", "status"],
        "command_topic": topics.word(),
        "payload_start": "start",
        "payload_pause": "stop",
        "payload_stop": "stop",
        "payload_return_to_base": "backHome",
        "state_topic": topics.home_assistant(),
        "json_attributes_topic": topics.state(Resource::Mission),
        "json_attributes_template": attributes(&["phase", "holds", "fault"]),
    })
}

fn temperature(topics: &Topics) -> Value {
    json!({
        "platform": "sensor",
        "name": "Temperature",
        "device_class": "temperature",
        "state_class": "measurement",
        "unit_of_measurement": "°C",
        "state_topic": topics.state(Resource::Temperature),
        "value_template": "{{ value_json.celsius if not value_json.silentSince else None }}",
        "json_attributes_topic": topics.state(Resource::Temperature),
        "json_attributes_template": attributes(&["status", "threshold", "silentSince"]),
    })
}

fn phase(topics: &Topics) -> Value {
    json!({
        "platform": "sensor",
        "name": "Phase",
        "icon": "mdi:map-search",
        "device_class": "enum",
        "options": PhaseName::ALL.map(PhaseName::name),
        "state_topic": topics.state(Resource::Mission),
        "value_template": "{{ value_json.phase }}",
    })
}

fn position(topics: &Topics) -> Value {
    json!({
        "platform": "sensor",
        "name": "Position",
        "icon": "mdi:crosshairs-gps",
        "state_topic": topics.state(Resource::Robot),
        "value_template": "{{ value_json.position.x }}, {{ value_json.position.y }}",
        "json_attributes_topic": topics.state(Resource::Robot),
        "json_attributes_template": attributes(&["heading", "state", "led"]),
    })
}

fn luggage(topics: &Topics) -> Value {
    json!({
        "platform": "sensor",
        "name": "Luggage",
        "icon": "mdi:bag-suitcase",
        "state_class": "measurement",
        "unit_of_measurement": "pieces",
        "state_topic": topics.state(Resource::Luggage),
        "value_template": "{{ value_json['pieces'] if value_json is mapping else value_json | count }}",
    })
}

fn progress(topics: &Topics) -> Value {
    json!({
        "platform": "sensor",
        "name": "Progress",
        "icon": "mdi:progress-check",
        "state_class": "measurement",
        "unit_of_measurement": "%",
        "state_topic": topics.state(Resource::Mission),
        "value_template": "{{ value_json.progress.percent }}",
    })
}

fn alarm(topics: &Topics) -> Value {
    json!({
        "platform": "binary_sensor",
        "name": "Alarm",
        "device_class": "safety",
        "state_topic": topics.home_assistant(),
        "value_template": "{{ 'ON' if value_json.alarm else 'OFF' }}",
    })
}

fn photo(topics: &Topics) -> Value {
    json!({
        "platform": "image",
        "name": "Last photo",
        "content_type": "image/png",
        "image_topic": topics.photo(),
    })
}

/// Adds the permanent id of an entity and its initial name to the description.
fn identified(topics: &Topics, name: &str, mut component: Value) -> Value {
    let id = format!("{}_{name}", unique(topics));
    let platform = component["platform"].as_str().unwrap_or_default();
    let entity = format!("{platform}.{}", id.to_ascii_lowercase().replace('-', "_"));
    component["default_entity_id"] = entity.into();
    component["unique_id"] = id.into();
    component
}

/// Returns the id of the device. The ids of all its entities begin with this id.
fn unique(topics: &Topics) -> String {
    format!("hallsweep_{}", topics.id())
}

fn attributes(fields: &[&str]) -> String {
    let taken: Vec<String> = fields.iter().map(|field| format!("'{field}': value_json.{field}")).collect();
    format!("{{{{ {{{}}} | tojson }}}}", taken.join(", "))
}
