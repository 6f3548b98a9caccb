//! Temperature and position as sensor measurements in SenML JSON (RFC 8428). The measurements have no time, because
//! they are always the present values.

use serde::Serialize;

use hallsweep_core::snapshot::robot::RobotView;
use hallsweep_core::world::temperature::TemperatureView;

/// The unit of a temperature (RFC 8428, section 12.1).
const CELSIUS: Option<&str> = Some("Cel");

const METRES: Option<&str> = Some("m");

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Record {
    /// Prefix of the names of this record and of all records after it.
    #[serde(rename = "bn", skip_serializing_if = "Option::is_none")]
    base: Option<&'static str>,
    #[serde(rename = "n")]
    name: &'static str,
    #[serde(rename = "u", skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    #[serde(rename = "v", skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    #[serde(rename = "vs", skip_serializing_if = "Option::is_none")]
    word: Option<&'static str>,
}

/// Writes the reading, the threshold above which no robot moves, and the status. There is no reading before the first
/// report, and while the temperature is not known.
pub fn temperature(view: &TemperatureView) -> String {
    let degrees = |name, degrees| Record { name, unit: CELSIUS, value: Some(degrees), ..Record::default() };
    let reading = view.celsius.filter(|_| view.silent_since.is_none()).map(|celsius| degrees("celsius", celsius.degrees()));
    let threshold = degrees("threshold", view.threshold.degrees());
    let status = Record { name: "status", word: Some(view.status.name()), ..Record::default() };
    packed("hallsweep:temperature:", reading.into_iter().chain([threshold, status]))
}

/// Writes the robot's column and row, counted from home to the east and to the south. Its heading, its state and the
/// distance to the next obstacle follow. The distance is absent beyond the sonar's range.
pub fn robot(robot: &RobotView) -> String {
    let cell = robot.pose.cell;
    let count = |name, count: i32| Record { name, value: Some(count.into()), ..Record::default() };
    let word = |name, word| Record { name, word: Some(word), ..Record::default() };
    let metres = robot.sonar_cm.map(|cm| f64::from(cm) / 100.0);
    let sonar = metres.map(|metres| Record { name: "sonar", unit: METRES, value: Some(metres), ..Record::default() });
    let always =
        [count("x", cell.x), count("y", cell.y), word("heading", robot.pose.heading.name()), word("state", robot.state.name())];
    packed("hallsweep:robot:", always.into_iter().chain(sonar))
}

fn packed(base: &'static str, records: impl Iterator<Item = Record>) -> String {
    let mut pack: Vec<Record> = records.collect();
    if let Some(first) = pack.first_mut() {
        first.base = Some(base);
    }
    serde_json::to_string(&pack).expect("a record is texts and finite numbers, which JSON can hold")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, searching};

    #[test]
    fn a_temperature_is_a_measurement_in_celsius() {
        let json = r#"[{"bn":"hallsweep:temperature:","n":"celsius","u":"Cel","v":21.4},{"n":"threshold","u":"Cel","v":25.0},{"n":"status","vs":"ok"}]"#;
        assert_eq!(temperature(&searching().temperature), json);
    }

    /// A record without a value is not allowed (RFC 8428, section 4.2).
    #[test]
    fn before_the_first_reading_there_is_no_record_of_one() {
        let json = r#"[{"bn":"hallsweep:temperature:","n":"threshold","u":"Cel","v":25.0},{"n":"status","vs":"ok"}]"#;
        assert_eq!(temperature(&idle().temperature), json);
        let mut silent = searching().temperature;
        silent.silent_since = silent.read;
        assert_eq!(temperature(&silent), json, "nor is there one of a reading that is true no more");
    }

    #[test]
    fn a_robot_is_its_cell_its_heading_and_what_its_sonar_says() {
        let json = r#"[{"bn":"hallsweep:robot:","n":"x","v":2.0},{"n":"y","v":2.0},{"n":"heading","vs":"east"},{"n":"state","vs":"stopped"},{"n":"sonar","u":"m","v":0.42}]"#;
        assert_eq!(robot(&searching().robot), json);
        assert!(!robot(&idle().robot).contains("sonar"));
    }
}
