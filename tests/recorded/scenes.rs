//! Every command of the table in every scene. Each command gets a new state, so that every command is accepted in one
//! scene and refused in another.

use std::fmt::Write;
use std::sync::Arc;

use super::book::Book;
use super::doors::{
    Camera, Command, Event, Hall, Hold, LuggageRef, PhaseName, RandomStream, RobotEvent, RobotId, SimSettings, TemperatureReport,
    Verdict,
};
use super::play::Player;
use super::table::forms;
use super::test_app::TestApp;

/// State in which the commands are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scene {
    Idle,
    Silent,
    Searching,
    Stopped,
    Hot,
    CoolAgain,
    Inspecting,
    WithoutPhoto,
    BombLocated,
    Fetching,
    Secured,
    Explored,
    LinkLost,
    StoreFailed,
}

const ALL: [Scene; 14] = [
    Scene::Idle,
    Scene::Silent,
    Scene::Searching,
    Scene::Stopped,
    Scene::Hot,
    Scene::CoolAgain,
    Scene::Inspecting,
    Scene::WithoutPhoto,
    Scene::BombLocated,
    Scene::Fetching,
    Scene::Secured,
    Scene::Explored,
    Scene::LinkLost,
    Scene::StoreFailed,
];

impl Scene {
    const fn name(self) -> &'static str {
        match self {
            Scene::Idle => "idle",
            Scene::Silent => "a sensor is silent",
            Scene::Searching => "searching",
            Scene::Stopped => "stopped",
            Scene::Hot => "too hot",
            Scene::CoolAgain => "cool again",
            Scene::Inspecting => "inspecting",
            Scene::WithoutPhoto => "without a photo",
            Scene::BombLocated => "a bomb is located",
            Scene::Fetching => "the bag is fetched",
            Scene::Secured => "the bag is secured",
            Scene::Explored => "explored",
            Scene::LinkLost => "the link is lost",
            Scene::StoreFailed => "the store has failed",
        }
    }

    /// Creates an app in this state.
    fn app(self) -> TestApp {
        let rows: &[&str] = if self == Scene::Explored { &["S..", "..."] } else { &["S...", ".T..", "...."] };
        let hall = Arc::new(Hall::from_rows("scene", rows).expect("a sound hall"));
        let photo_failure_rate = if self == Scene::WithoutPhoto { 1.0 } else { 0.0 };
        let sim = SimSettings { photo_failure_rate, ..SimSettings::new(1, Camera::Stub) };
        let has_pair = matches!(self, Scene::BombLocated | Scene::Fetching | Scene::Secured);
        let app = if has_pair { TestApp::with_pair(&hall, sim) } else { TestApp::new(&hall, sim, self == Scene::Silent) };
        if matches!(self, Scene::Idle | Scene::Silent) {
            return app;
        }
        given(&app, Command::Start);
        match self {
            Scene::Idle | Scene::Silent => {}
            Scene::Searching | Scene::Stopped | Scene::Hot | Scene::CoolAgain | Scene::LinkLost | Scene::StoreFailed => {
                some(&app, 4);
                self.halt(&app);
            }
            Scene::Inspecting | Scene::WithoutPhoto => inspected(&app),
            Scene::BombLocated | Scene::Fetching | Scene::Secured => {
                inspected(&app);
                given(
                    &app,
                    Command::Verdict {
                        luggage: LuggageRef::Pending,
                        verdict: Verdict::Danger,
                        note: None,
                        hot: Default::default(),
                    },
                );
                app.until(|state| state.mission.phase == PhaseName::BombLocated);
                self.fetch(&app);
            }
            Scene::Explored => app.until(|state| state.mission.phase == PhaseName::Explored),
        }
        app
    }

    /// Continues the retrieval to the stage of the scene.
    fn fetch(self, app: &TestApp) {
        if self == Scene::BombLocated {
            return;
        }
        given(app, Command::Retrieve(None));
        if self == Scene::Fetching {
            return some(app, 20);
        }
        app.until(|state| state.mission.holds.contains(&Hold::Alarm));
        let call = app.state().alarms.iter().rev().find_map(|alarm| alarm.id).expect("the pair calls");
        given(app, Command::Acknowledge(call));
        given(app, Command::Start);
        app.until(|state| state.mission.phase == PhaseName::BagSecured);
    }

    /// Causes what stops the search in the scene.
    fn halt(self, app: &TestApp) {
        if self == Scene::Stopped {
            given(app, Command::Stop);
            some(app, 3);
        }
        if matches!(self, Scene::Hot | Scene::CoolAgain) {
            given(app, Command::Temperature(TemperatureReport::TooHigh));
            some(app, 3);
        }
        if self == Scene::CoolAgain {
            given(app, Command::Temperature(TemperatureReport::Ok));
        }
        if self == Scene::LinkLost {
            app.happen(Event::Robot(RobotId::discovery(), RobotEvent::LinkLost("the cable is out".to_owned())));
        }
        if self == Scene::StoreFailed {
            app.happen(Event::StoreFailed("the disk is full".to_owned()));
        }
    }
}

/// Continues until a piece is inspected.
fn inspected(app: &TestApp) {
    app.until(|state| state.mission.inspected.is_some());
    some(app, 3);
}

/// Handles this number of events, or fewer if there are no more.
fn some(app: &TestApp, things: usize) {
    for _ in 0..things {
        app.advance();
    }
}

fn given(app: &TestApp, command: Command) {
    assert!(app.give(command.clone()), "{command:?} in phase {}", app.state().mission.phase.name());
}

/// Gives every command in every scene. If `in_full` is not set, only one answer of each command is written: the first
/// accepted one, or the first of all. A digest covers all answers.
pub(crate) async fn play(book: &mut Book, in_full: bool) -> Vec<String> {
    for scene in ALL {
        book.forget();
        book.place = scene.name().to_owned();
        Player::new(scene.app(), RandomStream::new(1, "scene")).look_at_all(book).await;
    }
    let mut outcomes = Vec::new();
    for form in forms() {
        let (mut pattern, mut all, mut first) = (String::new(), Vec::new(), None);
        for scene in ALL {
            book.place = scene.name().to_owned();
            let mut player = Player::new(scene.app(), RandomStream::new(1, "scene"));
            let given = player.answer(&form).await;
            pattern.push(if given.is_accepted { '+' } else { '-' });
            all.extend_from_slice(&given.said);
            if in_full {
                book.write(given.kind, &given.title, &given.said);
            }
            let is_better =
                given.is_accepted && first.as_ref().is_none_or(|(_, first): &(_, super::play::Given)| !first.is_accepted);
            if first.is_none() || is_better {
                first = Some((scene, given));
            }
        }
        let (scene, first) = first.expect("there are scenes");
        outcomes.push(format!("{pattern} {} {}", first.kind, first.title));
        if !in_full {
            book.place = format!("{} {pattern}", scene.name());
            book.write(first.kind, &first.title, &first.said);
            let mut digest = String::new();
            write!(digest, "in all scenes {}", super::book::digest(&all)).expect("a text takes everything");
            book.write_on(first.kind, &digest);
        }
    }
    outcomes
}
