//! A chart of the temperature over the mission. Each column covers a part of the time. A line goes through the
//! highest reading of each column, and a horizontal line shows the threshold.

use std::fmt::Write;

use super::{Failure, Report, each};
use hallsweep_core::state::Speaking;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::Celsius;

/// Width of the chart, in the units of the drawing.
pub(super) const WIDTH: usize = 720;
pub(super) const HEIGHT: usize = 150;

/// Space above the highest and below the lowest value, in °C.
const MARGIN: f64 = 2.0;

#[derive(Debug)]
pub(super) struct Chart {
    pub(super) points: String,
    pub(super) threshold: Option<f64>,
    /// Temperatures at the upper and at the lower edge, in °C.
    pub(super) most: f64,
    pub(super) least: f64,
}

impl Chart {
    /// Makes the chart; `None` if there are no readings.
    pub(super) fn of(report: &Report<'_>, threshold: Option<Celsius>) -> Result<Option<Chart>, Failure> {
        let tally = &report.tally;
        let (Some((coldest, _)), Some((hottest, _)), Some((_, began))) = (tally.coldest, tally.hottest, tally.first) else {
            return Ok(None);
        };
        let mut columns = vec![None::<f64>; WIDTH];
        let (span, mut set) = (tally.span_ms().max(1), 0_i64);
        // The line continues at the height of the last reading, until no source reports a temperature any more.
        let (mut last, mut ends, mut speaking) = (None, span, Speaking::default());
        each(report.archive, report.claim.mission, report.claim.until, |_, entry| {
            if let Ok(Entry { fact: Fact::ClockSet(by_ms), .. }) = entry {
                set = set.saturating_add(*by_ms);
            }
            let Ok(entry) = entry else { return Ok(()) };
            let gone = entry.wall.unix_ms.saturating_sub(began.unix_ms).saturating_sub(set).clamp(0, span);
            let is_known = speaking.hear(&entry.fact);
            if let Fact::Temperature(_, celsius) = &entry.fact {
                let column = &mut columns[column(gone, span)];
                *column = Some(column.map_or(celsius.degrees(), |there| there.max(celsius.degrees())));
                (last, ends) = (Some(celsius.degrees()), span);
            } else if !is_known {
                ends = ends.min(gone);
            }
            Ok(())
        })?;
        if let Some(degrees) = last.filter(|_| report.claim.edition > 1) {
            columns[column(ends, span)].get_or_insert(degrees);
        }
        let highest = threshold.map_or(hottest.degrees(), |threshold| hottest.degrees().max(threshold.degrees()));
        let (most, least) = (highest.ceil() + MARGIN, coldest.degrees().floor() - MARGIN);
        let down = |degrees: f64| (most - degrees) / (most - least) * HEIGHT as f64;
        let mut points = String::new();
        for (column, degrees) in columns.iter().enumerate().filter_map(|(column, degrees)| Some((column, (*degrees)?))) {
            write!(points, "{column},{:.1} ", down(degrees)).expect("writing to a string does not fail");
        }
        Ok(Some(Chart { points, threshold: threshold.map(|threshold| down(threshold.degrees())), most, least }))
    }
}

fn column(gone_ms: i64, span_ms: i64) -> usize {
    let column = i128::from(gone_ms) * (WIDTH as i128 - 1) / i128::from(span_ms);
    usize::try_from(column).unwrap_or(0).min(WIDTH - 1)
}
