//! The parts of the page. The same template produces a part for the whole page and for the stream. Each part lists
//! the resources that it shows, so a change updates only the affected parts.

use askama::Template;

use super::areas;
use super::carriers::carriers;
use super::evacuation::{self, from_home};
use super::hall;
use super::incident::{Incident, is_of_incident};
use super::photo::{Take, takes};
use super::retrieval::{rows, sign, stage, stages};
use super::view::{View, danger_consequence, failure};
use crate::api::luggage::photo_url;
use crate::api::robot::ArmJson;
use crate::api::robot_parts;
use crate::api::time::rfc3339;
use crate::phrases::{Language, Phrase};
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::closing::OpenPoints;
use hallsweep_core::command::{Hot, HotAnswer, Note, Strategy};
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{self, Parts};
use hallsweep_core::settings::Rules;
use hallsweep_core::snapshot::AreaView;
use hallsweep_core::snapshot::log::LogLine;
use hallsweep_core::snapshot::retrieval::{TreeView, TreesView};
use hallsweep_core::snapshot::robot::RobotShown;
use hallsweep_core::units::{LuggageId, MissionId, WallTime};
use hallsweep_core::world::alarm::AlarmView;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

/// Maximum number of log lines on the page. The HTTP interface has more.
const LINES: usize = 40;

/// Maximum number of pieces in the gallery. It shows the latest ones; the page of the mission has all.
const PIECES: usize = 24;

/// A part of the page that the stream can replace. `id` is the id of its HTML element.
pub(super) struct PagePart {
    pub(super) id: &'static str,
    pub(super) shows: &'static [Resource],
    pub(super) render: fn(&View<'_>) -> String,
}

/// All parts, in the order of the page.
pub(super) const PARTS: [PagePart; 24] = [
    PagePart {
        id: "announce",
        shows: &[Resource::Mission, Resource::Luggage, Resource::Alarms, Resource::Temperature],
        render: |v| html(&Announce { v }),
    },
    PagePart {
        id: "bar",
        shows: &[Resource::Mission, Resource::Robot, Resource::Temperature, Resource::Luggage, Resource::Retrieval],
        render: |v| html(&Bar { v }),
    },
    PagePart { id: "holds", shows: &[Resource::Mission, Resource::Temperature], render: |v| html(&Holds { v }) },
    PagePart { id: "hall-areas", shows: &[Resource::Mission, Resource::Map], render: areas::outlines },
    PagePart { id: "hall-labels", shows: &[Resource::Map], render: |v| hall::labels(&v.snapshot.map) },
    PagePart {
        id: "hall-evacuation",
        shows: &[Resource::Mission, Resource::Luggage, Resource::Robot, Resource::Map, Resource::Retrieval],
        render: evacuation::circles,
    },
    PagePart { id: "hall-frontier", shows: &[Resource::Map], render: |v| hall::frontier(&v.snapshot.map) },
    PagePart {
        id: "hall-layer",
        shows: &[Resource::Mission, Resource::Robot, Resource::Luggage, Resource::Map, Resource::Retrieval],
        render: |v| hall::layer(v.language, v.snapshot),
    },
    PagePart {
        id: "hall-carriers",
        shows: &[Resource::Robot, Resource::Luggage, Resource::Map, Resource::Retrieval],
        render: |v| carriers(v.language, v.snapshot),
    },
    PagePart { id: "hall-robot", shows: &[Resource::Robot, Resource::Map], render: |v| hall::robot(v.snapshot) },
    PagePart {
        id: "about-hall",
        shows: &[Resource::Mission, Resource::Robot, Resource::Luggage],
        render: |v| html(&HallWords { v }),
    },
    PagePart { id: "progress", shows: &[Resource::Mission], render: |v| html(&Progress { v }) },
    PagePart {
        id: "incident",
        shows: &[
            Resource::Luggage,
            Resource::Alarms,
            Resource::Mission,
            Resource::Map,
            Resource::Temperature,
            Resource::Robot,
            Resource::Retrieval,
        ],
        render: |v| html(&Incident { v }),
    },
    PagePart { id: "alarms", shows: &[Resource::Alarms, Resource::Luggage], render: |v| html(&Alarms { v }) },
    PagePart { id: "retrieval", shows: &[Resource::Retrieval, Resource::Mission], render: |v| html(&Retrieval { v }) },
    PagePart { id: "trees", shows: &[Resource::Retrieval], render: |v| html(&Trees { v }) },
    PagePart { id: "blackboard", shows: &[Resource::Retrieval], render: |v| html(&Blackboard { v }) },
    PagePart {
        id: "inspect",
        shows: &[Resource::Mission, Resource::Luggage, Resource::Alarms],
        render: |v| html(&Inspect { v }),
    },
    PagePart { id: "actions", shows: &[Resource::Mission, Resource::Luggage, Resource::Robot], render: |v| html(&Actions { v }) },
    PagePart { id: "temperature", shows: &[Resource::Temperature, Resource::Mission], render: |v| html(&Temperature { v }) },
    PagePart { id: "robot", shows: &[Resource::Robot, Resource::Mission], render: |v| html(&Robot { v }) },
    PagePart { id: "more", shows: &[Resource::Mission], render: |v| html(&More { v }) },
    PagePart { id: "gallery", shows: &[Resource::Luggage], render: |v| html(&Gallery { v }) },
    PagePart { id: "log", shows: &[Resource::Log], render: |v| html(&Log { v }) },
];

#[derive(Template)]
#[template(path = "console/confirm.html")]
pub(super) struct Confirm {
    language: Language,
    question: String,
    consequence: Phrase<'static>,
    button: String,
    action: &'static str,
    id: Option<LuggageId>,
    photo: Option<String>,
    note: Option<Note>,
    hot: Hot,
}

impl Confirm {
    pub(super) fn danger(language: Language, luggage: &Luggage, note: Option<Note>, hot: Hot, rules: Rules) -> Confirm {
        Confirm {
            language,
            question: language.say("danger-question").with("id", luggage.id).to_string(),
            consequence: danger_consequence(language, rules),
            button: language.say("danger-yes").with("id", luggage.id).to_string(),
            action: "/console/danger",
            id: Some(luggage.id),
            photo: photo_url(luggage),
            note,
            hot,
        }
    }

    pub(super) fn reset(language: Language) -> Confirm {
        Confirm {
            language,
            question: language.say("reset-question").to_string(),
            consequence: language.say("reset-consequence"),
            button: language.say("reset-yes").to_string(),
            action: "/console/reset",
            id: None,
            photo: None,
            note: None,
            hot: Hot::NONE,
        }
    }
}

#[derive(Template)]
#[template(path = "console/closing.html")]
pub(super) struct CloseMission {
    pub(super) language: Language,
    /// What the search has found.
    pub(super) finding: String,
    pub(super) open: OpenPoints,
    /// What the form sends as seen.
    pub(super) code: String,
    /// Why the mission could not be closed; empty before.
    pub(super) why: String,
    pub(super) name: String,
    pub(super) note: String,
}

#[derive(Template)]
#[template(path = "console/handing_over.html")]
pub(super) struct HandOverMission {
    pub(super) language: Language,
    /// The mission under way; `None` if there is none.
    pub(super) mission: Option<MissionId>,
    /// Why the mission could not be handed over; empty before.
    pub(super) why: String,
    pub(super) to: String,
    pub(super) note: String,
}

macro_rules! parts {
    ($($name:ident $path:literal)*) => {$(
        #[derive(Template)]
        #[template(path = $path)]
        pub(super) struct $name<'a> {
            pub(super) v: &'a View<'a>,
        }
    )*};
}

parts! {
    Menu "console/menu.html"
    Announce "console/announce.html"
    Bar "console/bar.html"
    Elsewhere "console/elsewhere.html"
    Holds "console/holds.html"
    HallWords "console/hall_words.html"
    Progress "console/progress.html"
    Alarms "console/alarms.html"
    Inspect "console/inspect.html"
    Actions "console/actions.html"
    Temperature "console/temperature.html"
    Robot "console/robot.html"
    More "console/more.html"
    Gallery "console/gallery.html"
    Log "console/log.html"
    Retrieval "console/retrieval.html"
    Trees "console/trees.html"
    Blackboard "console/blackboard.html"
}

impl Elsewhere<'_> {
    fn as_of(&self) -> Phrase<'static> {
        let (View { now, .. }, zone) = (self.v, self.v.zone());
        self.v.say("bar-as-of").with("time", zone.clock_time(*now)).with("zone", zone.name())
    }
}

impl Inspect<'_> {
    fn earlier(&self, luggage: &Luggage) -> Option<Vec<Take>> {
        let mut takes = takes(luggage);
        takes.pop();
        (!takes.is_empty()).then_some(takes)
    }

    fn where_and_when(&self, luggage: &Luggage) -> String {
        self.v
            .say("where-and-when")
            .with("place", self.v.place(luggage.cell))
            .with("from_home", from_home(self.v.language, luggage.cell, self.v.hall.cell_m))
            .with("from", self.v.place(luggage.pose.cell))
            .with("heading", self.v.language.heading(luggage.pose.heading))
            .with("time", self.v.date(luggage.taken))
            .to_string()
    }
}

impl Robot<'_> {
    /// Whether the robot has an arm. The page shows the figures about a grip only for an arm, because a hook has no
    /// such figures.
    fn has_arm(&self, robot: &RobotShown) -> bool {
        robot.parts.is_some_and(|parts| parts.has(robot::Part::Arm))
    }

    /// Returns a figure with exactly two decimals, so that the text does not change its width with the value.
    fn figure(&self, value: &f64) -> String {
        self.v.language.number(&format!("{value:.2}"))
    }

    fn sonar(&self) -> String {
        if self.v.parts().is_some_and(|parts| !parts.has(robot::Part::Sonar)) {
            return self.v.say("sonar-none").to_string();
        }
        let cm = self.v.snapshot.robot.sonar_cm;
        self.v.known(&cm.map_or_else(|| self.v.say("sonar-nothing").to_string(), |cm| format!("{cm} cm")))
    }

    fn heading(&self) -> String {
        self.v.known(&self.v.say_of("heading", self.v.snapshot.robot.pose.heading.name()))
    }

    fn led(&self) -> String {
        self.v.known(&self.v.say_of("led", self.v.last_led()))
    }

    fn place(&self, robot: &RobotShown) -> String {
        let outside = self.v.say("before-entrance").to_string();
        self.v.as_known(robot, &if robot.view.outside > 0 { outside } else { robot.view.pose.cell.to_string() })
    }

    fn position(&self) -> String {
        let robot = &self.v.snapshot.robot;
        let outside = self.v.say("before-entrance").to_string();
        let place = if robot.outside > 0 { outside } else { robot.pose.cell.to_string() };
        self.v.known(&if robot.off_centre { self.v.say("off-centre").with("place", place).to_string() } else { place })
    }

    fn parts_in_words(&self) -> String {
        let words = |parts: Parts| parts.iter().map(|part| self.part(part).to_string()).collect::<Vec<_>>().join(", ");
        self.v.parts().map_or_else(|| self.v.say("parts-unknown").to_string(), words)
    }

    const fn part(&self, part: robot::Part) -> Phrase<'static> {
        self.v.say_of("part", part.name())
    }

    fn missing(&self) -> Vec<(Phrase<'static>, Phrase<'static>)> {
        let missing = self.v.parts().into_iter().flat_map(robot_parts::missing);
        missing.map(|(part, _)| (self.part(part), self.v.say_of("instead", part.name()))).collect()
    }
}

impl More<'_> {
    /// Returns the areas with their numbers in the hall file. The areas in a person's order come first, then the others,
    /// the most probable first.
    fn areas(&self) -> Vec<(usize, &AreaView)> {
        let mut areas: Vec<(usize, &AreaView)> = self.v.snapshot.mission.areas.iter().enumerate().collect();
        areas.sort_by(|(_, one), (_, other)| {
            let place = |view: &AreaView| view.order.unwrap_or(usize::MAX);
            place(one).cmp(&place(other)).then(other.area.probability.total_cmp(&one.area.probability))
        });
        areas
    }
}

impl Gallery<'_> {
    fn pieces(&self) -> Vec<(&Luggage, Option<String>)> {
        let latest = self.v.snapshot.luggage.iter().rev().take(PIECES);
        latest.map(|luggage| (&**luggage, photo_url(luggage))).collect()
    }

    fn more(&self) -> usize {
        self.v.snapshot.luggage.len().saturating_sub(PIECES)
    }

    fn time(&self, wall: &WallTime) -> String {
        self.v.zone().clock_time(*wall)
    }
}

impl Alarms<'_> {
    /// Returns the alarms that nobody has acknowledged, newest first. Alarms about bombs are left out, because the
    /// incident shows them.
    fn unseen(&self) -> Vec<&AlarmView> {
        let unseen = |alarm: &&AlarmView| alarm.acknowledged.is_none() && !is_of_incident(self.v, alarm);
        self.v.snapshot.alarms.iter().rev().filter(unseen).collect()
    }
}

impl Retrieval<'_> {
    fn stages(&self, fetcher: &Fetcher) -> Vec<(&'static str, Phrase<'static>)> {
        stages(*fetcher).iter().map(|name| (*name, stage(self.v.language, *fetcher, name))).collect()
    }
}

impl Trees<'_> {
    const fn language(&self) -> Language {
        self.v.language
    }

    fn trees(&self) -> &[TreeView] {
        self.v.snapshot.retrieval.as_deref().map_or(&[], |retrieval| &retrieval.trees.trees)
    }
}

impl Blackboard<'_> {
    const fn language(&self) -> Language {
        self.v.language
    }

    fn ticked(&self) -> Option<&TreesView> {
        self.v.snapshot.retrieval.as_deref().map(|retrieval| &*retrieval.trees).filter(|trees| trees.ticks > 0)
    }
}

impl Log<'_> {
    fn lines(&self) -> Vec<(&LogLine, String, String)> {
        let latest = self.v.snapshot.log.iter().rev().take(LINES);
        latest.map(|line| (&**line, rfc3339(line.wall), self.v.zone().clock_time(line.wall))).collect()
    }
}

pub(super) fn html(part: &impl Template) -> String {
    part.render().expect("the console's templates only write strings, which does not fail")
}
