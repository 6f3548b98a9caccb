//! The temperature of a hall over time: keyframes joined by straight lines. After the last keyframe the temperature
//! stays the same. The core decides what a temperature means for the robot.

use std::time::Duration;

use hallsweep_core::units::Celsius;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    /// Pairs of time in seconds and temperature, sorted by time. There is at least one, and no time occurs twice.
    keys: Vec<(f64, Celsius)>,
}

impl Curve {
    /// Makes a curve from keyframes (seconds, °C), which must be sorted by time. Returns `None` if `keys` is empty.
    pub(super) fn through(keys: Vec<(f64, Celsius)>) -> Option<Curve> {
        (!keys.is_empty()).then_some(Curve { keys })
    }

    pub(super) fn keys(&self) -> &[(f64, Celsius)] {
        &self.keys
    }

    pub(super) fn at(&self, since_start: Duration) -> Celsius {
        self.at_s(since_start.as_secs_f64())
    }

    /// The first whole second later than `after` at which the temperature, rounded to tenths of a degree, differs
    /// from `shown`.
    pub(super) fn next_change(&self, after: u64, shown: i64) -> Option<u64> {
        let differs = |second: u64| tenths(self.at_s(seconds(second))) != shown;
        let mut first = after + 1;
        for (at, _) in &self.keys {
            // Between two keyframes the temperature only rises or only falls. So once the temperature differs from
            // `shown`, it keeps differing up to the second before the next keyframe.
            let last = whole_second_before(*at);
            if first > last {
                continue;
            }
            if differs(first) {
                return Some(first);
            }
            if differs(last) {
                return Some(first_that(first, last, differs));
            }
            first = last + 1;
        }
        differs(first).then_some(first)
    }

    fn at_s(&self, second: f64) -> Celsius {
        let next = self.keys.partition_point(|(at, _)| *at <= second);
        let (Some(before), Some(after)) = (next.checked_sub(1).and_then(|index| self.keys.get(index)), self.keys.get(next))
        else {
            let end = if next == 0 { self.keys.first() } else { self.keys.last() };
            return end.expect("a curve has at least one keyframe").1;
        };
        let share = (second - before.0) / (after.0 - before.0);
        let degrees = before.1.degrees() + share * (after.1.degrees() - before.1.degrees());
        Celsius::new(degrees).unwrap_or(before.1)
    }
}

/// A temperature in tenths of a degree, rounded as it is shown.
#[expect(clippy::cast_possible_truncation, reason = "a temperature is at most a thousand degrees")]
pub(super) fn tenths(temperature: Celsius) -> i64 {
    (temperature.degrees() * 10.0).round() as i64
}

/// The first second in `first..=last` for which `holds` is true. Once `holds` is true, it must stay true up to
/// `last`, and it must be true at `last`.
fn first_that(mut first: u64, mut last: u64, holds: impl Fn(u64) -> bool) -> u64 {
    while first < last {
        let middle = first + (last - first) / 2;
        if holds(middle) { last = middle } else { first = middle + 1 }
    }
    first
}

#[expect(clippy::cast_precision_loss, reason = "a run lasts far less than 2^53 seconds")]
const fn seconds(second: u64) -> f64 {
    second as f64
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "keyframes lie between 0 and a billion seconds")]
fn whole_second_before(second: f64) -> u64 {
    second.floor() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(keys: &[(f64, f64)]) -> Curve {
        let keys = keys.iter().map(|(at, degrees)| (*at, Celsius::new(*degrees).unwrap())).collect();
        Curve::through(keys).unwrap()
    }

    #[test]
    fn it_is_linear_between_keyframes_and_holds_the_last() {
        let curve = curve(&[(10.0, 20.0), (20.0, 30.0)]);
        let at = |second| curve.at(Duration::from_secs(second)).degrees();
        assert_eq!((at(0), at(10), at(15), at(20), at(1000)), (20.0, 20.0, 25.0, 30.0, 30.0));
    }

    #[test]
    fn the_next_change_is_the_one_found_by_looking_at_every_second() {
        let curve = curve(&[(0.5, 21.0), (7.2, 21.04), (7.3, 21.3), (100.0, 21.3), (160.0, 20.9), (160.4, 25.0), (161.0, 20.9)]);
        for after in 0..200u64 {
            let shown = tenths(curve.at(Duration::from_secs(after)));
            let slow = (after + 1..400).find(|second| tenths(curve.at(Duration::from_secs(*second))) != shown);
            assert_eq!(curve.next_change(after, shown), slow, "after {after} s");
        }
    }
}
