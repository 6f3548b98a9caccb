//! Single lines for clients that do not read JSON: the mission, the retrieval and the temperature in short. The text
//! forms of the map are in `map_text`, the words of old clients in `old_items`.

use super::time::rfc3339;
use hallsweep_core::snapshot::retrieval::RetrievalView;
use hallsweep_core::snapshot::{MissionView, Snapshot};
use hallsweep_core::world::temperature::TemperatureView;

/// The phase, such as `exploring`. Holds follow if there are any: `exploring, held by operator, awaitingStart`.
pub fn mission(mission: &MissionView) -> String {
    let phase = mission.phase.name();
    if mission.holds.is_empty() {
        return phase.to_owned();
    }
    let holds: Vec<&str> = mission.holds.iter().map(|hold| hold.name()).collect();
    format!("{phase}, held by {}", holds.join(", "))
}

/// The retrieval in one line, such as `fetching, luggage #6`, or `none`.
pub fn retrieval(snapshot: &Snapshot) -> String {
    match snapshot.retrieval.as_deref() {
        None => "none".to_owned(),
        Some(RetrievalView { stage, luggage, reason: None, .. }) => format!("{stage}, luggage #{luggage}"),
        Some(RetrievalView { stage, luggage, reason: Some(reason), .. }) => format!("{stage}, luggage #{luggage}: {reason}"),
    }
}

/// The reading and the status. Examples: `21.4 °C, ok`; `no reading, ok` before the first reading; `not known since
/// 2026-02-03T10:00:00.000+01:00, last 21.4 °C, ok`.
pub fn temperature(view: &TemperatureView) -> String {
    let reading = view.celsius.as_ref().map_or_else(|| "no reading".to_owned(), ToString::to_string);
    let silent = view.silent_since.map_or_else(String::new, |since| format!("not known since {}, last ", rfc3339(since)));
    format!("{silent}{reading}, {}", view.status.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, searching};
    use hallsweep_core::hold::Hold;

    #[test]
    fn a_line_says_what_one_must_know() {
        let mut state = searching();
        assert_eq!((mission(&state.mission), temperature(&state.temperature)), ("inspecting".into(), "21.4 °C, ok".into()));
        state.mission.holds = vec![Hold::Operator, Hold::AwaitingStart];
        assert_eq!(mission(&state.mission), "inspecting, held by operator, awaitingStart");
        assert_eq!(temperature(&idle().temperature), "no reading, ok");
        state.temperature.silent_since = state.temperature.read;
        assert_eq!(temperature(&state.temperature), "not known since 2026-02-03T10:00:00.000+01:00, last 21.4 °C, ok");
    }
}
