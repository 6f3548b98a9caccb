//! Tests that the English phrases are the same as the core's sentences, and that all of them are translated into
//! Italian.

use std::sync::Arc;
use std::time::Duration;

use crate::phrases::Language;
use behaviour_trees::state::StateError;
use hallsweep_core::asked::Asked;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::closing::{AreaClosing, Closed, Closing, OpenInArea, OpenPoints};
use hallsweep_core::command::{
    Again, Command, Door, Hot, HotAnswer, Issuer, LuggageRef, Move, Note, Strategy, TemperatureReport, Verdict,
};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::hold::{Hold, HoldReason};
use hallsweep_core::not_fetched::{AloneFault, Fetcher, NotFetched, StuckFault};
use hallsweep_core::pair::{RetrievalFault, Saying};
use hallsweep_core::phase::{FaultCause, PhaseName};
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy};
use hallsweep_core::snapshot::said::{Said, Trouble};
use hallsweep_core::state::fact::{Fact, Unpacked, WrittenOut};
use hallsweep_core::state::{Conditions, Inspection, Phase, Retrieval, RetrievalStage, Stage, Venue};
use hallsweep_core::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_core::world::alarm::AlarmCause;
use hallsweep_core::world::hall_map::{Bounds, Mark};
use hallsweep_core::world::luggage::{Luggage, PhotoState};

const ID: LuggageId = LuggageId(3);
const CELL: Cell = Cell::new(1, 2);

fn degrees(degrees: f64) -> Celsius {
    Celsius::new(degrees).unwrap()
}

fn issuer() -> Issuer {
    Issuer { door: Door("http"), who: "anna".into(), from: "192.0.2.7".into() }
}

/// Checks that the English phrase is `core`. The Italian phrase must differ, unless `alike` contains `core`.
#[track_caller]
fn check(core: &str, say: impl Fn(Language) -> String, alike: &[&str]) {
    assert_eq!(say(Language::English), core);
    let italian = say(Language::Italian);
    assert!(italian != core || alike.contains(&core), "{core} is the same in Italian");
}

#[test]
fn phases_holds_and_headings() {
    PhaseName::ALL.iter().for_each(|phase| check(phase.in_words(), |language| language.phase(*phase).to_string(), &[]));
    Heading::ALL.iter().for_each(|heading| check(heading.name(), |language| language.heading(*heading).to_string(), &[]));
    for hold in Hold::ALL {
        check(hold.in_words(), |language| language.hold(hold).to_string(), &[]);
        check(hold.over_in_words(), |language| language.said(&Said::Over(hold)), &[]);
    }
}

#[test]
fn commands() {
    let mut commands = vec![
        Command::Start,
        Command::Stop,
        Command::BackHome,
        Command::Retrieve(None),
        Command::Reset,
        Command::Goto(CELL),
        Command::SearchAgain(Again::Within(Bounds { least: Cell::HOME, most: CELL })),
        Command::SearchAgain(Again::Area("gate 1".into())),
        Command::OrderAreas([].into()),
        Command::OrderAreas(["gate 1".into(), "gate 2".into()].into()),
        Command::RetakePhoto(ID),
        Command::Acknowledge(AlarmId(4)),
        Command::Temperature(TemperatureReport::Ok),
        Command::Temperature(TemperatureReport::TooHigh),
        Command::Temperature(TemperatureReport::Reading(degrees(25.04))),
        Command::Temperature(TemperatureReport::Reading(degrees(21.0))),
        Command::Temperature(TemperatureReport::Sensor("roof".into(), degrees(21.5))),
    ];
    commands.extend(Move::ALL.map(Command::Move));
    commands.extend(Strategy::ALL.map(Command::ChooseStrategy));
    for (luggage, note) in [(LuggageRef::Id(ID), Note::new("red")), (LuggageRef::Pending, None)] {
        commands.extend([Verdict::Safe, Verdict::Danger].map(|verdict| Command::Verdict {
            luggage,
            verdict,
            note: note.clone(),
            hot: Hot {
                hidden: Some(HotAnswer::No),
                typical: Some(HotAnswer::CannotSay),
                size: Some(BombSize::Vest),
                ..Hot::NONE
            },
        }));
        let closing = Closing { name: Note::new("Anna Rossi").unwrap(), note: note.clone(), seen: "7:1,0,0,0,0,0".into() };
        commands.push(Command::Close(closing));
        commands.push(Command::HandOver(HandOver { mission: None, to: Note::new("police").unwrap(), note: note.clone() }));
        let (area, name) = ("gate 1".into(), Note::new("Anna Rossi").unwrap());
        commands.push(Command::CloseArea(AreaClosing { area, name, note: note.clone(), mission: None }));
        commands.push(Command::Unsure { luggage, note, hot: Hot { typical: Some(HotAnswer::No), ..Hot::NONE } });
    }
    let many = Asked::Many { last: Box::new(Asked::Command(Command::Start)), more: 4 };
    let stops = [None, Some(Duration::from_millis(1200))].map(|within| Asked::Stops { count: 3, within });
    for asked in commands.into_iter().map(Asked::Command).chain(stops).chain([many]) {
        check(&asked.to_string(), |language| language.asked(&asked, None), &["STOP"]);
    }
    let meant = Command::Verdict {
        luggage: LuggageRef::Pending,
        verdict: Verdict::Safe,
        note: Note::new("red"),
        hot: Default::default(),
    };
    assert_eq!(Language::English.asked(&Asked::Command(meant), Some(ID)), "safe #3 (note: red)");
}

#[test]
fn what_went_wrong() {
    let pair = RetrievalFault::ALL.map(|fault| NotFetched::Pair(fault, None));
    let own = NotFetched::Pair(RetrievalFault::Tree, Some("its words".to_owned()));
    let alone = AloneFault::ALL.map(NotFetched::Alone);
    let stuck = StuckFault::ALL.map(|fault| NotFetched::Stuck(fault, None));
    let both = NotFetched::Stuck(StuckFault::NoWayOut, Some(Box::new(own.clone())));
    let other = NotFetched::OtherFetcher { began: Fetcher::Pair, set: Fetcher::Discovery };
    let reasons: Vec<NotFetched> = pair.into_iter().chain([own, both, other]).chain(alone).chain(stuck).collect();
    for why in &reasons {
        check(&why.to_string(), |language| language.not_fetched(why), &[]);
    }
    let faults = [FaultCause::NoWayHome, FaultCause::Unanswered, FaultCause::Undecided, FaultCause::Robot("it slips".to_owned())];
    for fault in faults.into_iter().chain(reasons.into_iter().map(FaultCause::NotFetched)) {
        check(&fault.to_string(), |language| language.fault(&fault), &[]);
    }
    let calls = Saying::ALL.map(|saying| AlarmCause::Call(ID, saying));
    for cause in [AlarmCause::Dangerous(ID, CELL), AlarmCause::Unrecorded(ID, CELL)].into_iter().chain(calls) {
        check(&cause.to_string(), |language| language.alarm(&cause), &[]);
    }
}

#[test]
fn the_log() {
    let srm1 = || RobotId::new("srm1").unwrap();
    let why = || "it is off".to_owned();
    let asked = |refused| Said::Asked { asked: Asked::Command(Command::Start), meant: None, issuer: issuer(), refused };
    let reasons = [HoldReason::Reading(degrees(31.0)), HoldReason::Silent("roof".into()), HoldReason::Unheard("roof".into())];
    let troubles = [
        Trouble::TooFar(CELL),
        Trouble::NoThermometer,
        Trouble::Unreached(why()),
        Trouble::MetObstacle(CELL),
        Trouble::Failed(why()),
        Trouble::NoPhoto(why()),
        Trouble::Unanswered,
        Trouble::StillUnreached(why()),
    ];
    let lines = [
        asked(None),
        asked(Some(Refused::Moving)),
        Said::Overtaken(Refused::Decided { luggage: ID, verdict: Verdict::Danger }),
        Said::Held(Hold::Operator, None),
        Said::Phase(PhaseName::Idle, PhaseName::Exploring),
        Said::Fault(FaultCause::NoWayHome),
        Said::Alarm(AlarmCause::Dangerous(ID, CELL)),
        Said::Found { luggage: ID, cell: CELL, has_photo: true },
        Said::Found { luggage: ID, cell: CELL, has_photo: false },
        Said::PhotographedAgain(ID),
        Said::PhotoStays(ID),
        Said::NoOtherView(ID),
        Said::Secured(ID),
        Said::NoWay(CELL),
        Said::Stands(None, Pose::START),
        Said::Stands(Some(srm1()), Pose::START),
        Said::TreesBeginAnew(StateError::OtherTree),
        Said::StartedAgain,
        Said::Ended("SIGTERM".to_owned()),
        Said::PutDown,
    ];
    let held = reasons.map(|reason| Said::Held(Hold::TemperatureStale, Some(reason)));
    for said in lines.into_iter().chain(held).chain(troubles.map(|trouble| Said::Robot(srm1(), trouble))) {
        check(&said.to_string(), |language| language.said(&said), &["srm1: it is off"]);
    }
}

#[test]
fn the_journal() {
    let inspecting = |stage| Phase::Inspecting(Inspection { cell: CELL, piece: None, pose: Pose::START, stage, views: 0 });
    let fault = Phase::Fault { cause: FaultCause::Unanswered, interrupted: Box::new(inspecting(Stage::TakingPhoto)) };
    let command = |refused: Option<Refused>| {
        let note = Note::new("red");
        let asked = Asked::Command(Command::Verdict {
            luggage: LuggageRef::Id(ID),
            verdict: Verdict::Safe,
            note,
            hot: Default::default(),
        });
        Fact::Command { issuer: issuer(), id: None, asked, epoch: None, luggage: Some(ID), refused }
    };
    let verdict =
        |note| Fact::Verdict { luggage: ID, verdict: Verdict::Danger, who: "anna".into(), note, hot: Default::default() };
    let photographed = |photo| {
        let (pose, taken) = (Pose::START, WallTime::default());
        let record = Arc::new(Luggage {
            id: ID,
            cell: CELL,
            pose,
            taken,
            first_taken: taken,
            photo,
            verdict: None,
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        });
        Fact::Luggage { record, photo: None }
    };
    let closed = |note, open| {
        let name = Note::new("Anna Rossi").unwrap();
        Fact::Closed(Box::new(Closed { who: "anna".into(), name, note, open, wall: WallTime::default() }))
    };
    let facts = vec![
        Fact::ProgramStarted("1".to_owned()),
        Fact::ProgramEnded("SIGTERM".to_owned()),
        Fact::ClockSet(-600_000),
        Fact::ClockSet(46_800_000),
        command(None),
        command(Some(Refused::Moving)),
        Fact::MissionBegan(MissionId(2), Strategy::Columns),
        Fact::MissionArchived(MissionId(2), vec![ID]),
        Fact::MissionArchived(MissionId(2), Vec::new()),
        Fact::Unsure { luggage: ID, who: "anna".into(), note: Note::new("a shadow"), hot: Hot::NONE },
        Fact::HandedOver { who: "anna".into(), to: Note::new("police").unwrap(), note: Note::new("copy") },
        Fact::Revealed { luggage: ID, is_test: true },
        Fact::Revealed { luggage: ID, is_test: false },
        Fact::SearchAgain(Again::Within(Bounds { least: Cell::HOME, most: CELL })),
        closed(None, OpenPoints::default()),
        closed(
            Note::new("handed over"),
            OpenPoints { pending: 1, bombs: 2, places: 3, kept_out: 4, again: 7, unvisited: 5, unreachable: 6 },
        ),
        Fact::Phase(fault),
        Fact::Phase(Phase::Idle),
        Fact::Holds(Vec::new()),
        Fact::Holds(Hold::ALL.to_vec()),
        Fact::Epoch(Epoch(4)),
        Fact::Pose(Pose::START),
        Fact::RobotPose(RobotId::discovery(), Pose::START),
        Fact::Outside(RobotId::discovery(), 0),
        Fact::Outside(RobotId::discovery(), 2),
        Fact::Retrieval(None),
        Fact::Secured(ID),
        Fact::Led(true),
        Fact::Led(false),
        photographed(PhotoState::Taken { bytes: 4, take: 1 }),
        photographed(PhotoState::Taken { bytes: 4, take: 2 }),
        photographed(PhotoState::Failed("it is dark".to_owned())),
        verdict(None),
        verdict(Note::new("red")),
        Fact::Temperature("roof".into(), degrees(21.5)),
        Fact::ThermometerSilent("roof".into()),
        Fact::AlarmRaised(AlarmId(4), None, AlarmCause::Dangerous(ID, CELL)),
        Fact::AlarmAcknowledged(AlarmId(4), "anna".into()),
        Fact::MapEmptied(Heading::South),
    ];
    check_facts(facts);
}

#[test]
fn the_journal_says_where_it_is_and_what_left_it() {
    check_facts([
        Fact::Conditions(Conditions {
            venue: Venue { name: "depot".into(), cell_m: Some(0.25), ..Venue::default() },
            threshold: degrees(25.5),
            rules: Rules {
                after_danger: AfterDanger::GoOn,
                keep_out_m: 2.5,
                safe_by: SafeBy::Two,
                hot: HotRule::Required,
                unsure_views: 1,
            },
        }),
        Fact::Conditions(Conditions {
            venue: Venue { name: "depot".into(), ..Venue::default() },
            threshold: degrees(25.5),
            rules: Rules::default(),
        }),
        Fact::Conditions(Conditions {
            venue: Venue { name: "depot".into(), is_reckoned: true, ..Venue::default() },
            threshold: degrees(25.5),
            rules: Rules::default(),
        }),
        Fact::WrittenOut(WrittenOut {
            missions: (MissionId(1), MissionId(7)),
            until: Seq(4711),
            file: "2025.hallsweep".to_owned(),
            digest: "a5".repeat(32),
        }),
        Fact::Unpacked(Unpacked {
            file: "2025.hallsweep".to_owned(),
            digest: "a5".repeat(32),
            behind: Seq(4711),
            page: "5a".repeat(32),
        }),
    ]);
}

#[test]
fn the_journal_says_what_became_of_areas() {
    let closed_area = |note| {
        let (name, open) = (Note::new("Anna Rossi").unwrap(), OpenInArea { cells: 12, pending: 1 });
        let closed = Closed { who: "anna".into(), name, note, open, wall: WallTime::default() };
        Fact::AreaClosed("gate 1".into(), Box::new(closed))
    };
    check_facts([
        closed_area(None),
        closed_area(Note::new("the police is there")),
        Fact::SearchAgain(Again::Area("gate 1".into())),
        Fact::AreasOrdered([].into()),
        Fact::AreasOrdered(["gate 1".into(), "gate 2".into()].into()),
    ]);
}

fn check_facts(facts: impl IntoIterator<Item = Fact>) {
    for fact in facts {
        check(&hallsweep_core::snapshot::fact_words::words(&fact), |language| language.fact(&fact), &[]);
    }
}

#[test]
fn words_of_others_stay_as_they_are() {
    for language in Language::ALL {
        for words in ["safe #03", "<b>", "{ $id }", "a\u{2028}b"] {
            assert_eq!(language.said(&Said::Words(words.to_owned())), words);
            assert_eq!(language.asked(&Asked::Words(words.to_owned()), None), words);
            assert!(language.fault(&FaultCause::Robot(words.to_owned())).contains(words));
        }
    }
}

#[test]
fn a_retrieval_in_the_journal() {
    let not = || Some(NotFetched::Alone(AloneFault::PieceLost));
    let fetching = [
        RetrievalStage::MakingRoom,
        RetrievalStage::Fetching,
        RetrievalStage::LettingGo,
        RetrievalStage::GoingOut(not()),
        RetrievalStage::GoingOut(None),
        RetrievalStage::ComingHome(not()),
    ];
    let retrieval = |stage| Retrieval {
        luggage: ID,
        fetcher: Fetcher::Pair,
        stage,
        piece: std::collections::BTreeSet::new(),
        call: None,
        team: None,
    };
    check_facts(fetching.map(|stage| Fact::Retrieval(Some(Box::new(retrieval(stage))))));
}

#[test]
fn every_step_in_the_journal() {
    let inspecting = |stage| Phase::Inspecting(Inspection { cell: CELL, piece: None, pose: Pose::START, stage, views: 0 });
    let of_piece = [Stage::Recording(ID), Stage::AwaitingVerdict(ID), Stage::RetakingPhoto(ID), Stage::Viewing(ID)];
    let stages = [&[Stage::BackingUp, Stage::TakingPhoto][..], &of_piece].concat();
    check_facts(stages.into_iter().map(|stage| Fact::Phase(inspecting(stage))));
    check_facts(["wall", "luggage", "unknown"].map(|kind| Fact::Obstacle(CELL, kind)));
    let marks = [Mark::Unknown, Mark::Seen, Mark::Visited, Mark::Wall, Mark::Luggage, Mark::NotInspected];
    check_facts(marks.map(|mark| Fact::Mark(CELL, mark)));
    check_facts(Strategy::ALL.map(Fact::Strategy));
}
