//! The whole page: all parts in their places, all tiles of the hall, and the whole timeline.

use askama::Template;
use serde::Serialize;

use super::parts::{Menu, PARTS, html};
use super::timeline::{MOST, THRESHOLD_Y, Timeline};
use super::view::{View, Why};
use super::{hall, pieces};
use crate::phrases::{Language, Phrase};
use hallsweep_core::bomb_size::BombSize;

/// The places of the tab *Drive* where refusals are shown.
pub(super) const DRIVE: [&str; 4] = ["strategy", "drive", "areas", "searchAgain"];

#[derive(Template)]
#[template(path = "console/page.html")]
pub(super) struct ConsolePage<'a> {
    v: &'a View<'a>,
    language: Language,
}

impl<'a> ConsolePage<'a> {
    pub(super) const fn new(v: &'a View<'a>) -> ConsolePage<'a> {
        ConsolePage { v, language: v.language }
    }

    fn part(&self, id: &str) -> String {
        let part = PARTS.iter().find(|part| part.id == id).expect("the page's template names only existing parts");
        (part.render)(self.v)
    }

    /// Returns the tab that is open at first. Without scripts it is the one with the button that was pressed.
    fn tab(&self) -> &'static str {
        let is_of_drive = |why: &Why| DRIVE.contains(&&*why.button);
        if self.v.why.as_ref().is_some_and(is_of_drive) { "drive" } else { "status" }
    }

    fn menu(&self) -> String {
        html(&Menu { v: self.v })
    }

    fn scale(&self) -> String {
        json(&self.v.line.filter(|line| !line.is_empty()).map(Timeline::scale))
    }

    fn times(&self) -> String {
        self.v.line.iter().flat_map(|line| line.sections(0)).map(|(_, markup)| markup.to_string()).collect()
    }

    fn width(&self) -> i64 {
        self.v.line.map_or(1, Timeline::width)
    }

    fn is_cut(&self) -> bool {
        self.v.line.is_some_and(Timeline::is_cut)
    }

    fn cursor(&self) -> i64 {
        self.v.line.map_or(0, |line| self.v.then.map_or(line.width(), |then| line.x(then.time)))
    }

    fn moment(&self) -> Phrase<'static> {
        match self.v.then {
            Some(then) => {
                self.v.say("moment").with("time", self.v.date(self.v.now)).with("entry", then.seq).with("mission", then.mission)
            }
            None if self.v.snapshot.mission.id.0 == 0 => self.v.say("moment-none"),
            None => self.v.say("moment-now"),
        }
    }
}

impl View<'_> {
    pub(super) fn here(&self) -> String {
        self.then.map_or_else(|| "/".to_owned(), |then| format!("/missions/{}/moment?at={}", then.mission, then.seq))
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers are what JSON can hold")
}
