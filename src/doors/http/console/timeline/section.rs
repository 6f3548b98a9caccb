//! A section of the timeline as a picture: bands for phases and holds, the temperature curve, and a mark for each
//! other entry that is shown. The numbers are vertical positions, from the top.
//!
//! ```text
//!   0 ── 12  phases: each band is drawn to the far end, and the next band covers it
//!  12 ── 16  holds: drawn in the same way
//!  18 ── 42  temperature, with the threshold
//!  44 ── 54  luggage and verdicts
//!  56 ── 64  commands; the mark of a STOP has the full height, 0 ── 64
//! ```
//! `line` decides what is shown and where.

use askama::filters::{Html, escape};

use super::super::drawing::write;
use hallsweep_core::units::Celsius;

/// A position to the right of every drawn moment.
pub(super) const FAR: i64 = 1_000_000_000;

/// Range of the temperature curve below and above the threshold, in °C.
const BELOW: f64 = 12.0;
const ABOVE: f64 = 8.0;

const COLD: f64 = 42.0;
const HOT: f64 = 18.0;

pub(in super::super) const THRESHOLD_Y: f64 = COLD - BELOW / (ABOVE + BELOW) * (COLD - HOT);

#[derive(Clone, Copy, Debug)]
pub(super) struct TemperaturePoint {
    pub(super) x: i64,
    pub(super) celsius: Celsius,
    height: f64,
    is_hot: bool,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    pub(super) entries: usize,
    marks: String,
    temperature: String,
    hot: String,
}

impl Section {
    /// Adds a band. `about` has the attribute with the name of a phase.
    pub(super) fn band(&mut self, x: i64, (top, bottom): (i64, i64), class: &str, about: &str, said: &str) {
        let (height, said) = (bottom - top, escaped(said));
        write(
            &mut self.marks,
            format_args!("<path class=\"{class}\" d=\"M{x} {top}H{FAR}v{height}H{x}z\"{about}><title>{said}</title></path>"),
        );
    }

    /// Adds a mark. `about` has the attributes that tell which piece it is about.
    pub(super) fn mark(&mut self, x: i64, class: &str, about: &str, said: &str) {
        let (from, to) = heights(class);
        let said = escaped(said);
        write(
            &mut self.marks,
            format_args!("<path class=\"mark {class}\" d=\"M{x} {from}V{to}\"{about}><title>{said}</title></path>"),
        );
    }

    /// Adds a reading to the curve. The line goes on horizontally to the new reading, then steps up or down.
    pub(super) fn reading(&mut self, x: i64, celsius: Celsius, threshold: Celsius, at: &mut Option<TemperaturePoint>) {
        let above = (celsius.degrees() - threshold.degrees()).clamp(-BELOW, ABOVE);
        let height = COLD - (above + BELOW) / (ABOVE + BELOW) * (COLD - HOT);
        let height = (height * 10.0).round() / 10.0;
        let is_hot = celsius > threshold;
        match *at {
            Some(TemperaturePoint { x: from, height: before, is_hot: was_hot, .. }) => {
                write(&mut self.temperature, format_args!("H{x}V{height}"));
                if was_hot {
                    write(&mut self.hot, format_args!("M{from} {before}H{x}"));
                }
            }
            None => write(&mut self.temperature, format_args!("M{x} {height}")),
        }
        *at = Some(TemperaturePoint { x, celsius, height, is_hot });
    }

    /// Ends the line of the curve, because the last reading is not valid any more.
    pub(super) fn reading_ends(&mut self, x: i64, at: &mut Option<TemperaturePoint>) {
        if let Some(TemperaturePoint { x: from, height, is_hot, .. }) = at.take() {
            write(&mut self.temperature, format_args!("H{x}"));
            if is_hot {
                write(&mut self.hot, format_args!("M{from} {height}H{x}"));
            }
        }
    }

    pub(super) fn go_on(&mut self, reading: Option<TemperaturePoint>) {
        if let Some(TemperaturePoint { x, height, .. }) = reading {
            write(&mut self.temperature, format_args!("M{x} {height}"));
        }
    }

    /// Returns the markup of the section's group. The line of a reading that is still valid is drawn to the far end.
    pub(super) fn drawn(&self, place: usize, lasting: Option<TemperaturePoint>) -> String {
        let (mut temperature, mut hot) = (self.temperature.clone(), self.hot.clone());
        if let Some(TemperaturePoint { x, height, is_hot, .. }) = lasting {
            write(&mut temperature, format_args!("H{FAR}"));
            if is_hot {
                write(&mut hot, format_args!("M{x} {height}H{FAR}"));
            }
        }
        let line = |class: &str, path: &str| match path {
            "" => String::new(),
            path => format!("<path class=\"{class}\" d=\"{path}\"/>"),
        };
        let (temperature, hot) = (line("temperature", &temperature), line("temperature hot", &hot));
        format!("<g id=\"{}\">{}{temperature}{hot}</g>", id(place), self.marks)
    }
}

pub(in super::super) fn id(place: usize) -> String {
    format!("time_{place}")
}

fn heights(class: &str) -> (i64, i64) {
    match class {
        "found" => (49, 54),
        "safe" => (44, 54),
        "danger" | "secured" => (42, 56),
        "alarm" => (16, 44),
        "seen" => (38, 44),
        "stop" | "program" => (0, 64),
        _ => (57, 64),
    }
}

/// Escapes markup and removes characters that XML does not allow. One such character would make the whole picture
/// invalid.
pub(in crate::doors::http::console) fn escaped(words: &str) -> String {
    let is_of_xml = |c: &char| !matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
    let words: String = words.chars().filter(is_of_xml).collect();
    escape(words.as_str(), Html).map(|safe| safe.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A browser does not draw a picture that is not valid XML.
    #[test]
    fn whatever_is_said_of_a_mark_the_picture_stays_one() {
        let said: String = ('\0'..='\u{ff}').chain(['\u{fffd}', '\u{fffe}', '\u{ffff}', '鞄']).collect();
        let mut section = Section::default();
        section.mark(3, "refused", "", &said);
        section.band(3, (0, 12), "phase", &format!(" data-name=\"{}\"", escaped(&said)), &said);
        let drawn = section.drawn(0, None);
        assert!(roxmltree::Document::parse(&drawn).is_ok(), "{drawn}");
        assert!(drawn.contains("é") && drawn.contains('鞄') && !drawn.contains('\u{ffff}'));
    }
}
