//! The parts of robots in words: THE TABLE of replacements for parts that the searching robot lacks.

use schemars::JsonSchema;
use serde::Serialize;

use super::vocabulary;
use hallsweep_core::robot::{Part, Parts};

/// Replacements for missing parts. Nothing replaces a base, an arm or a gripper. Without an arm or a gripper the
/// robot fetches nothing.
const REPLACED: [(Part, &str); 5] = [
    (Part::Camera, "a drawing marked as a drawing"),
    (Part::Sonar, "touching obstacles on the way"),
    (Part::Led, "the display on the console alone"),
    (Part::Thermometer, "the operator's buttons and the hall's sensors"),
    (Part::AcknowledgedMoves, "moves are timed"),
];

/// A missing part, and what replaces the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ReplacedJson {
    /// Name of the part, as in `parts`.
    #[schemars(with = "vocabulary::Part")]
    pub part: &'static str,
    pub by: &'static str,
}

pub fn replaced(parts: Parts) -> Vec<ReplacedJson> {
    missing(parts).map(|(part, by)| ReplacedJson { part: part.name(), by }).collect()
}

/// Returns the missing parts that something replaces, each with the words for the replacement.
pub fn missing(parts: Parts) -> impl Iterator<Item = (Part, &'static str)> {
    REPLACED.into_iter().filter(move |(part, _)| !parts.has(*part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_simulated_robot_has_is_not_replaced_and_what_is_missing_is() {
        assert_eq!(replaced(Parts::ROUND_ROBOT), []);
        let bare = Parts::of(&[Part::Base, Part::Bump]);
        let parts: Vec<&str> = replaced(bare).iter().map(|replaced| replaced.part).collect();
        assert_eq!(parts, ["camera", "sonar", "led", "thermometer", "acknowledgedMoves"]);
        let replaced = replaced(bare.with(Part::Sonar).with(Part::Led).with(Part::Thermometer).with(Part::Camera));
        assert_eq!(replaced, [ReplacedJson { part: "acknowledgedMoves", by: "moves are timed" }]);
    }
}
