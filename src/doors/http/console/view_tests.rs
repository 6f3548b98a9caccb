//! The console's texts in an operator's words.

use std::time::Duration;

use super::super::page::ConsolePage;
use super::super::parts::PARTS;
use super::super::retrieval::stages;
use super::*;
use crate::api::tests::fixture::{TEN, degrees, idle, searching, touch};
use hallsweep_core::arm::{ArmState, Parcel};
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::pair::Which;
use hallsweep_core::place::Place;
use hallsweep_core::robot::{Part, Parts};
use hallsweep_core::settings::Rules;
use hallsweep_core::snapshot::retrieval::RetrievalView;
use hallsweep_core::snapshot::robot::RobotShown;
use hallsweep_core::snapshot::{Progress, TimeLeft};
use hallsweep_core::state::Reach;
use hallsweep_core::units::Piece;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::temperature::{SourceReading, TemperatureStatus};

fn view(snapshot: &Snapshot) -> View<'_> {
    let hall = HallInfo {
        name: "airport".into(),
        cell_m: Some(0.5),
        is_reckoned: false,
        evacuation_m: 100.0,
        is_paused: false,
        robot: None,
        rules: Rules::default(),
    };
    let now = WallTime { unix_ms: TEN.unix_ms + 74_900, ..TEN };
    View { snapshot, hall, began: Some(TEN), who: None, language: Language::English, why: None, now, line: None, then: None }
}

#[test]
fn how_far_the_search_has_come_is_announced_now_and_then() {
    let said = |cells| {
        let mut snapshot = searching();
        snapshot.mission.progress.visited = cells;
        snapshot.mission.phase = PhaseName::Exploring;
        view(&snapshot).announcement()
    };
    let announced: std::collections::BTreeSet<String> = (1..=1000).map(said).collect();
    assert_eq!(announced.len(), 8, "10, 20, 50, 100, 200, 500, 1000 and before: {announced:?}");
    assert!(said(70).contains("At least 50 cells are searched."), "{}", said(70));
    assert!(!said(9).contains("searched"), "{}", said(9));
}

#[test]
fn a_waiting_piece_is_what_is_said_first() {
    let snapshot = searching();
    let view = view(&snapshot);
    assert_eq!(view.mood(), Mood::Held);
    assert_eq!(view.announcement(), "Luggage #3 waits for your verdict. Luggage #2 is dangerous.");
    assert_eq!(view.title(), "‖ luggage #3 waits for your verdict · hallsweep");
    assert_eq!(view.gone(&snapshot.luggage[2].taken), "1:14");
}

#[test]
fn a_refusal_is_shown_at_its_own_button_only_and_escaped() {
    let snapshot = idle();
    let view = View { why: Some(Why::new("start", "a < b")), ..view(&snapshot) };
    assert!(view.why("start").to_string().contains("a &#60; b"));
    assert_eq!(view.why("reset").text, "");
}

fn reading(celsius: f64) -> SourceReading {
    SourceReading { celsius: degrees(celsius), read: Some(TEN), silent_since: None }
}

#[test]
fn a_hot_reading_has_the_age_of_its_own_source_and_is_not_known_when_that_is_silent() {
    let mut snapshot = searching();
    snapshot.temperature.read = Some(WallTime { unix_ms: TEN.unix_ms + 60_000, ..TEN });
    snapshot.temperature.hot = vec![("hall".into(), reading(27.0))];
    let age = view(&snapshot).reading_age(0).expect("it was read").to_string();
    assert!(age.contains(&format!("data-since=\"{}\"", TEN.unix_ms)), "{age}");
    snapshot.temperature.hot[0].1.silent_since = Some(TEN);
    let view = view(&snapshot);
    assert_eq!((view.celsius(), view.old_age().is_some()), ("not known".to_owned(), false));
    assert_eq!(view.heat(), ["Hall last read 27.0 °C and is now silent; the reading must fall to 24.0 °C or less."]);
    assert!(view.reading_age(0).expect("it was read").to_string().contains("last: 27.0 °C"));
}

#[test]
fn the_reading_that_is_too_hot_is_named_with_what_ends_it() {
    let mut snapshot = searching();
    snapshot.temperature.status = TemperatureStatus::TooHigh;
    snapshot.temperature.celsius = Some(degrees(21.0));
    snapshot.temperature.hot = vec![("hall".into(), reading(27.0)), ("operator".into(), reading(31.5))];
    snapshot.mission.holds = vec![Hold::Temperature];
    let view = view(&snapshot);
    assert_eq!(view.celsius(), "31.5 °C");
    assert_eq!(view.holds(), ["too hot: hall 27.0 °C, operator 31.5 °C; required: 24.0 °C or less"]);
    assert_eq!(
        view.heat(),
        [
            "Hall reads 27.0 °C; the reading must fall to 24.0 °C or less.",
            "An operator reported 31.5 °C. This reading applies until a reading of 24.0 °C or less is reported."
        ]
    );
}

#[test]
fn a_robot_that_was_told_to_halt_is_halting_until_it_is_known_to_stand() {
    let mut snapshot = searching();
    for (state, halting, words, is_still) in [
        (RobotState::MovingForward, false, "moving forward", false),
        (RobotState::MovingForward, true, "halting …", false),
        (RobotState::Stopped, true, "halting …", false),
        (RobotState::Stopped, false, "stopped", true),
    ] {
        (snapshot.robot.state, snapshot.robot.halting) = (state, halting);
        assert_eq!((view(&snapshot).doing().to_string().as_str(), view(&snapshot).is_still()), (words, is_still));
    }
    let srm1 = RobotView { state: RobotState::MovingArm, ..snapshot.robot };
    snapshot.robots =
        vec![RobotShown { id: Which::Srm1.robot(), view: srm1, parts: None, holds: Vec::new(), arm: None, unreached: None }]
            .into();
    assert_eq!((view(&snapshot).doing().to_string().as_str(), view(&snapshot).is_still()), ("pair moving", false));
    snapshot.mission.holds.push(Hold::Operator);
    assert_eq!(view(&snapshot).doing(), "pair moving", "nobody is told that all stand before they do");
    snapshot.robots = Vec::new().into();
    assert_eq!(view(&snapshot).doing(), "held by STOP");
    snapshot.robot.halting = true;
    assert_eq!(view(&snapshot).doing(), "halting …", "who pressed STOP is told so when the robot stands");
}

#[test]
fn without_a_reading_nothing_is_said_to_be_ok_and_no_button_is_lit() {
    let mut snapshot = idle();
    assert_eq!(view(&snapshot).celsius(), "no reading");
    assert!(!view(&snapshot).temperature_words().to_string().contains("normal") && !view(&snapshot).reads_ok());
    snapshot.temperature.celsius = Some(degrees(21.0));
    assert!(view(&snapshot).temperature_words() == "normal" && view(&snapshot).reads_ok());
    snapshot.temperature.status = TemperatureStatus::TooHigh;
    assert!(!view(&snapshot).reads_ok(), "OK is not lit while it is too hot");
    snapshot.temperature.status = TemperatureStatus::Stale;
    assert!(!view(&snapshot).reads_ok(), "nor while the sensor is silent");
}

#[test]
fn progress_says_what_was_searched_and_what_is_open_and_counts_until_it_is_over() {
    let mut snapshot = searching();
    assert_eq!(
        (view(&snapshot).searched().as_str(), view(&snapshot).open().to_string().as_str()),
        ("15 cells, 3.8 m²", "4 places left to search")
    );
    let unmeasured = View {
        hall: HallInfo {
            name: "airport".into(),
            cell_m: None,
            is_reckoned: false,
            evacuation_m: 100.0,
            is_paused: false,
            robot: None,
            rules: Rules::default(),
        },
        ..view(&snapshot)
    };
    assert_eq!(unmeasured.searched(), "15 cells");
    assert_eq!(view(&snapshot).counts_since(), Some(TEN));
    snapshot.mission.progress = Progress { visited: 19, ..Progress::default() };
    snapshot.mission.phase = PhaseName::Explored;
    assert!(view(&snapshot).open().to_string().starts_with("no place left"));
    assert_eq!(view(&snapshot).counts_since(), None);
}

#[test]
fn how_much_of_the_hall_can_be_reached_is_said_where_the_hall_is_known_beforehand() {
    let mut snapshot = searching();
    assert!(view(&snapshot).reach().is_none(), "of a hall that nobody knows nothing is said");
    snapshot.mission.progress.reach = Some(Reach { reachable: 51, free: 60 });
    let said = |language| View { language, ..view(&snapshot) }.reach().map(|phrase| phrase.to_string());
    assert_eq!(said(Language::English).as_deref(), Some("51 of 60 free cells reachable"));
    assert_eq!(said(Language::Italian).as_deref(), Some("51 celle libere su 60 raggiungibili"));
}

#[test]
fn how_long_it_will_drive_on_is_said_as_a_range_as_far_as_it_is_known() {
    let mut snapshot = searching();
    let mut said = |seconds: Option<(u64, Option<u64>)>| {
        let left = |(least, most): (u64, Option<u64>)| TimeLeft {
            least: Duration::from_secs(least),
            most: most.map(Duration::from_secs),
        };
        snapshot.mission.progress.left = seconds.map(left);
        view(&snapshot).left().map(|phrase| phrase.to_string())
    };
    assert_eq!(said(None), None);
    assert_eq!(said(Some((59, None))).unwrap(), "at least 50 s of driving left");
    assert_eq!(said(Some((200, Some(601)))).unwrap(), "3 min to 11 min of driving left");
    assert_eq!(said(Some((32, Some(81)))).unwrap(), "30 s to 90 s of driving left");
    assert_eq!(said(Some((119, Some(120)))).unwrap(), "110 s to 2 min of driving left");
}

#[test]
fn what_would_change_nothing_is_dead_and_says_why() {
    use PhaseName::{AtHome, Exploring, Fault, Idle, Inspecting, Retrieving, ReturningHome, ReturningWithAlarm};
    let dead = |phase, holds: &[Hold]| {
        let mut snapshot = idle();
        (snapshot.mission.phase, snapshot.mission.holds) = (phase, holds.to_vec());
        snapshot.mission.refusals.back_home = None;
        let view = view(&snapshot);
        [view.bar_of_start(), view.bar_of_back_home(), view.bar_of_ok()]
    };
    let goes_on = Some("the mission is already running".to_owned());
    for phase in [Exploring, Inspecting, ReturningHome, ReturningWithAlarm, Retrieving] {
        assert_eq!(dead(phase, &[])[0], goes_on, "{phase:?}");
        assert_eq!(dead(phase, &[Hold::Operator, Hold::AwaitingStart])[0], None, "{phase:?}");
    }
    for phase in [Idle, AtHome, Fault, PhaseName::BombLocated, PhaseName::BagSecured, PhaseName::Explored] {
        assert_eq!(dead(phase, &[])[0], None, "the core says whether START is refused: {phase:?}");
    }
    assert_eq!(dead(ReturningHome, &[])[1].as_deref(), Some("the robot is already coming home"));
    assert_eq!(dead(AtHome, &[])[1].as_deref(), Some("the robot is already at home"));
    assert_eq!([dead(Exploring, &[])[1].clone(), dead(ReturningHome, &[Hold::Operator])[1].clone()], [None, None]);
    assert_eq!(dead(Idle, &[])[2].as_deref(), Some("there is no TOO HIGH to cancel"));
    assert_eq!(dead(Exploring, &[Hold::TooHigh])[2], None);

    let mut snapshot = idle();
    snapshot.mission.phase = Exploring;
    let part = PARTS.iter().find(|part| part.id == "actions").expect("it is there");
    let shown = (part.render)(&view(&snapshot));
    assert!(shown.contains("START: the mission is already running."), "{shown}");
    snapshot.mission.refusals.start = Some(Refused::Moving);
    assert_ne!(view(&snapshot).bar_of_start(), goes_on, "a refusal has its own reason");
}

#[test]
fn a_located_bomb_says_what_to_do_next() {
    let mut snapshot = searching();
    snapshot.mission.phase = PhaseName::BombLocated;
    let next = view(&snapshot).next_step().unwrap();
    assert!(next.starts_with("Acknowledge the alarm, then press RETRIEVE") && next.contains("press RESET"), "{next}");
    snapshot.alarms = std::sync::Arc::from([]);
    touch(&mut snapshot, 21, &[Resource::Alarms]);
    assert!(view(&snapshot).next_step().unwrap().starts_with("Press RETRIEVE"));
}

#[test]
fn the_panel_of_the_robot_says_what_it_is_what_it_has_and_what_is_done_instead() {
    let mut snapshot = searching();
    let [sim, page] = [("sim", None), ("virtual-tcp", Some("localhost:8999"))].map(|(kind, address)| Participant {
        name: "discovery".into(),
        kind: kind.into(),
        address: address.map(Into::into),
    });
    let panel = |snapshot: &Snapshot, robot| {
        let hall = HallInfo {
            name: "airport".into(),
            cell_m: None,
            is_reckoned: false,
            evacuation_m: 100.0,
            is_paused: false,
            robot,
            rules: Rules::default(),
        };
        let part = PARTS.iter().find(|part| part.id == "robot").expect("it is there");
        (part.render)(&View { hall, ..view(snapshot) })
    };
    let simulated = panel(&snapshot, Some(sim));
    assert!(simulated.contains("<dt>Kind</dt><dd>sim</dd>") && simulated.contains("camera, sonar, LED"), "{simulated}");
    assert!(
        !simulated.contains("Replacements for missing parts") && !simulated.contains("Address"),
        "it has everything: {simulated}"
    );
    let mut robots = snapshot.robots.to_vec();
    robots[0].parts = Some(Parts::of(&[Part::Base, Part::Bump, Part::Sonar]));
    snapshot.robots = robots.into();
    let virtual_robot = panel(&snapshot, Some(page));
    assert!(virtual_robot.contains("<dd>wheels, sonar, bumper</dd>"), "{virtual_robot}");
    assert!(virtual_robot.contains("<dt>No camera</dt><dd>a drawing, which says that it is one</dd>"), "{virtual_robot}");
    assert!(
        virtual_robot.contains("<dt>Address</dt><dd>localhost:8999</dd>") && virtual_robot.contains("<dt>LED</dt><dd>none</dd>")
    );
    let mut robots = snapshot.robots.to_vec();
    robots[0].parts = None;
    snapshot.robots = robots.into();
    let unlinked = panel(&snapshot, None);
    assert!(unlinked.contains("<dd>not known while there is no link</dd>") && !unlinked.contains("Kind"), "{unlinked}");
}

#[test]
fn the_bar_says_whether_the_robot_is_simulated_and_in_the_past_what_is_on_record() {
    let snapshot = searching();
    let bar = |kind: Option<&str>, then| {
        let robot = kind.map(|kind| Participant { name: "discovery".into(), kind: kind.into(), address: None });
        let view = view(&snapshot);
        let hall = HallInfo { robot, ..view.hall.clone() };
        let part = PARTS.iter().find(|part| part.id == "bar").expect("it is there");
        (part.render)(&View { hall, then, ..view })
    };
    let past = Some(Then { mission: 1, seq: 9, time: 0, earlier: None, later: None });
    for (kind, then, said) in [
        (Some("sim"), None, "simulated"),
        (Some("sim"), past, "simulated"),
        (Some("virtual-ws"), None, "virtual robot"),
        (Some("line"), None, "line robot"),
        (None, past, "not on record whether simulated"),
    ] {
        let bar = bar(kind, then);
        let simulated = if kind == Some("sim") { " is-simulated" } else { "" };
        assert!(bar.contains(&format!("<li class=\"chip engine{simulated}\">{said}</li>")), "{kind:?}: {bar}");
    }
    assert!(!bar(None, None).contains("engine"), "nobody has said what it is");
}

#[test]
fn beside_what_sounds_like_an_end_stands_what_is_not_searched() {
    let shown = |phase, unknown| {
        let mut snapshot = idle();
        (snapshot.mission.phase, snapshot.mission.progress.unknown) = (phase, unknown);
        let part = PARTS.iter().find(|part| part.id == "bar").expect("it is there");
        let view = view(&snapshot);
        [(part.render)(&view), view.title(), view.announcement()]
    };
    for phase in [PhaseName::AtHome, PhaseName::BombLocated, PhaseName::BagSecured, PhaseName::Explored] {
        for said in shown(phase, 24) {
            assert!(
                said.replace("<span class=\"unseen\">· </span>", "· ").contains("· 24 known places not searched"),
                "{phase:?}: {said}"
            );
        }
        assert!(
            shown(phase, 1)[0]
                .contains("<span class=\"left\"><span class=\"unseen\">· </span>1 known place not searched</span></p>"),
            "in the heading itself"
        );
        assert!(shown(phase, 0).iter().all(|said| !said.contains("not searched")), "{phase:?}");
    }
    for phase in [PhaseName::Exploring, PhaseName::Retrieving, PhaseName::Idle] {
        assert!(shown(phase, 24).iter().all(|said| !said.contains("not searched")), "{phase:?} is no end");
    }
}

#[test]
fn a_hall_of_which_a_part_cannot_be_reached_is_not_simply_explored() {
    let shown = |free| {
        let mut snapshot = idle();
        (snapshot.mission.phase, snapshot.mission.progress.unknown) = (PhaseName::Explored, 0);
        snapshot.mission.progress.reach = Some(Reach { reachable: 8, free });
        view(&snapshot).title()
    };
    assert!(shown(14).contains("explored · 8 of 14 free cells"), "{}", shown(14));
    assert!(!shown(8).contains("free cells"));
}

fn fields(page: &str) -> [String; 5] {
    let between = |from: &str, to: &str| page.split_once(from).map_or("", |(_, rest)| rest.split(to).next().unwrap_or_default());
    let heat = between("<li class=\"chip num heat ", "</li>").split_once("<span>").map_or("", |(_, heat)| heat);
    let heat = heat.split(" <span class=\"quiet\">").next().unwrap_or_default();
    let row = |label: &str| between(&format!("<dt>{label}</dt><dd>"), "</dd>").to_owned();
    [heat.to_owned(), row("State"), row("Sonar"), row("Position"), row("LED")]
}

/// One state of the page: its name, the snapshot, the texts of its fields, further texts, and texts that must not
/// appear.
type Case<'c> = (&'c str, Snapshot, [&'c str; 5], &'c [&'c str], &'c [&'c str]);

const KNOWN: [&str; 5] = ["21.4 °C", "stopped", "42 cm", "(2, 2)", "blinking"];

const LIT: &str = "lamp led on";

const FETCHED: &str = "The piece is being fetched";

fn changed(mut snapshot: Snapshot, change: impl FnOnce(&mut Snapshot)) -> Snapshot {
    change(&mut snapshot);
    snapshot
}

fn unlinked() -> Snapshot {
    changed(searching(), |snapshot| {
        snapshot.robot.state = RobotState::MovingForward;
        snapshot.robot.unreached_since = Some(TEN);
        let robot = snapshot.robots[0].clone();
        snapshot.robots = vec![RobotShown { view: snapshot.robot, parts: None, unreached: Some("cable".into()), ..robot }].into();
    })
}

fn retrieving(holds: &[Hold]) -> Snapshot {
    changed(searching(), |snapshot| {
        snapshot.luggage = snapshot.luggage.iter().take(2).cloned().collect();
        (snapshot.mission.phase, snapshot.mission.holds) = (PhaseName::Retrieving, holds.to_vec());
    })
}

fn at_stage(fetcher: Fetcher, stage: &'static str) -> RetrievalView {
    RetrievalView { luggage: LuggageId(2), fetcher, stage, reason: None, piece: Vec::new(), trees: Arc::default() }
}

#[test]
fn the_bar_names_the_stage_of_a_retrieval_where_it_has_a_name() {
    for fetcher in Fetcher::ALL {
        for stage in ["makingRoom", "fetching", "lettingGo", "goingOut", "comingHome"] {
            let snapshot = changed(retrieving(&[]), |snapshot| snapshot.retrieval = Some(Arc::new(at_stage(fetcher, stage))));
            let named = view(&snapshot).stage().map(|stage| stage.to_string());
            assert_eq!(named.is_some(), stages(fetcher).contains(&stage), "{} {stage}", fetcher.name());
            let bar = part("bar", &snapshot);
            assert!(named.is_none_or(|named| bar.contains(&named)) && !bar.contains("stage-"), "{stage} in {bar}");
        }
    }
}

fn part(id: &str, snapshot: &Snapshot) -> String {
    let part = PARTS.iter().find(|part| part.id == id).expect("it is there");
    (part.render)(&view(snapshot))
}

#[test]
fn a_robot_with_an_arm_shows_how_it_grips_and_one_with_a_hook_only_what_it_holds() {
    for (parts, figures) in [(Parts::default().with(Part::Arm), 2), (Parts::default(), 0)] {
        let snapshot = changed(searching(), |snapshot| {
            let robot = RobotShown { parts: Some(parts), arm: Some(ArmState::default()), ..snapshot.robots[0].clone() };
            snapshot.robots = vec![robot.clone(), robot].into();
        });
        let robots = part("robot", &snapshot);
        assert_eq!(robots.matches("<dt>Gripper</dt>").count(), 2, "{robots}");
        assert_eq!(robots.matches(" N</dd>").count(), figures, "{robots}");
    }
}

#[test]
fn a_bomb_that_is_carried_is_said_to_be_where_it_is() {
    let incident = |place: Option<Place>| {
        let snapshot = changed(retrieving(&[]), |snapshot| {
            snapshot.retrieval = Some(Arc::new(at_stage(Fetcher::Pair, "carrying")));
            let arm = ArmState { holds: place.map(|place| Parcel { piece: Piece(1), place }), ..ArmState::default() };
            snapshot.robots = snapshot.robots.iter().map(|robot| RobotShown { arm: Some(arm), ..robot.clone() }).collect();
        });
        part("incident", &snapshot)
    };
    let found = incident(None);
    assert!(!found.contains("is being carried") && found.contains("of home"), "{found}");
    assert!(incident(Some(Place::Cell(Cell::new(7, 9)))).contains("is being carried (column 7, row 9); it was found at"));
    assert!(incident(Some(Place::ENTRANCE)).contains("carried (before the entrance); it was found at"));
}

fn check_fields(is_past: bool, cases: impl IntoIterator<Item = Case<'static>>) {
    for (state, snapshot, expect, says, never) in cases {
        let then = is_past.then_some(Then { mission: 1, seq: 9, time: TEN.unix_ms, earlier: None, later: None });
        let page = ConsolePage::new(&View { then, ..view(&snapshot) }).render().expect("it is written");
        assert_eq!(fields(&page), expect.map(str::to_owned), "{state}");
        for said in says {
            assert!(page.contains(said), "{state}: {said} in {page}");
        }
        for said in never {
            assert!(!page.contains(said), "{state}: no {said} in {page}");
        }
    }
}

#[test]
fn in_every_state_of_a_mission_each_field_says_what_is_so() {
    let moving = ["21.4 °C", "moving forward", "42 cm", "(2, 2)", "blinking"];
    let explores = changed(searching(), |snapshot| {
        (snapshot.mission.phase, snapshot.robot.state) = (PhaseName::Exploring, RobotState::MovingForward);
    });
    let stopped = changed(searching(), |snapshot| snapshot.mission.holds = vec![Hold::Operator]);
    let hot = changed(searching(), |snapshot| {
        snapshot.temperature.status = TemperatureStatus::TooHigh;
        snapshot.temperature.hot = vec![("hall".into(), reading(27.0))];
        snapshot.mission.holds = vec![Hold::Temperature];
    });
    let too_hot = ["27.0 °C", "stopped", "42 cm", "(2, 2)", "blinking"];
    let secured = changed(searching(), |snapshot| {
        (snapshot.mission.phase, snapshot.luggage) = (PhaseName::BagSecured, Default::default());
    });
    let at_rest = ["no reading", "stopped", "nothing near", "(0, 0)", "off"];
    check_fields(
        false,
        [
            ("at rest", idle(), at_rest, &[][..], &[LIT, "unlinked\">"][..]),
            ("exploring", explores, moving, &[LIT, "\" data-old=\"0\">1:14</b> ago"], &["unlinked\">"]),
            ("awaiting a verdict", searching(), KNOWN, &["data-luggage=\"3\"", "Nobody has acknowledged this alarm yet"], &[]),
            ("stopped", stopped, KNOWN, &["held by STOP", "stopped by the operator"], &[]),
            ("too hot", hot, too_hot, &["num heat tooHigh", "Hall reads 27.0 °C"], &["class=\"status\">normal<"]),
            ("a retrieval", retrieving(&[]), KNOWN, &[FETCHED], &[]),
            ("a retrieval stopped", retrieving(&[Hold::Operator]), KNOWN, &["held by STOP"], &[FETCHED]),
            ("secured, with open places", secured, KNOWN, &["· </span>4 known places not searched"], &[]),
        ],
    );
}

#[test]
fn what_is_not_heard_any_more_is_not_known_in_any_field() {
    let last = [
        "21.4 °C",
        "not known since 10:00:00, last: moving forward",
        "not known since 10:00:00, last: 42 cm",
        "not known since 10:00:00, last: (2, 2)",
        "not known since 10:00:00, last: blinking",
    ];
    let silent = changed(searching(), |snapshot| snapshot.temperature.silent_since = Some(TEN));
    let without = ["not known", "stopped", "42 cm", "(2, 2)", "blinking"];
    let before = changed(idle(), |snapshot| {
        snapshot.robots = vec![RobotShown { parts: None, ..snapshot.robots[0].clone() }].into();
    });
    let never = ["no reading", "not known", "not known", "not known", "not known"];
    check_fields(
        false,
        [
            ("before the first link", before, never, &["unlinked\">", "LED not known"][..], &[LIT][..]),
            ("the link lost", unlinked(), last, &["unlinked\">", "LED not known"], &[LIT]),
            (
                "a silent thermometer",
                silent,
                without,
                &["not known since 10:00:00, last: 21.4 °C", "num heat stale"],
                &["num heat ok", "class=\"status\">normal<", "ago</span>"],
            ),
        ],
    );
    let css = include_str!("../../../../static/shell.css");
    assert!(css.contains("#bar.unlinked ~ .link .lamp { background: var(--amber)"), "without a link the lamp is not green");
}

#[test]
fn in_the_past_nothing_is_live_and_alarms_were_raised_then() {
    let on_record = ["21.4 °C", "", "", "(2, 2)", "blinking"];
    check_fields(
        true,
        [
            (
                "the past",
                searching(),
                on_record,
                &["data-past=\"yes\"", "recorded at 10:00:00", "<b>Alarm</b> raised at", "Danger then:"][..],
                &["Nobody has acknowledged", "<b>Next:</b>", "class=\"evacuate\"", "panel alarm", "ago</span>", "unlinked\">"][..],
            ),
            ("the past of a lost link", unlinked(), on_record, &["data-past=\"yes\""], &["unlinked\">"]),
        ],
    );
    let css = include_str!("../../../../static/console.css");
    assert!(css.contains("html[data-past] .link { display: none; }"));
}
