//! Facts of every kind, drawn at random, for the tests of the journal and of the store.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use proptest::collection::{btree_map, btree_set, vec};
use proptest::option;
use proptest::prelude::*;

use crate::api::door::DOORS;
use crate::api::problem::refusal;
use behaviour_trees::Value as TreeValue;
use hallsweep_core::arm::Parcel;
use hallsweep_core::asked::Asked;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::closing::{AreaClosing, Closed, OpenInArea, OpenPoints};
use hallsweep_core::command::{
    Again, Command, CommandId, Hot, HotAnswer, Issuer, LuggageRef, Move, Note, Strategy as Order, TemperatureReport, Verdict,
};
use hallsweep_core::hold::Hold;
use hallsweep_core::not_fetched::{AloneFault, Fetcher, NotFetched, StuckFault};
use hallsweep_core::pair::{RetrievalFault, Saying};
use hallsweep_core::phase::{FaultCause, PhaseName};
use hallsweep_core::place::Place;
use hallsweep_core::refused::Refused;
use hallsweep_core::retrieval::Team;
use hallsweep_core::robot::RobotId;
use hallsweep_core::search::{Goal, Search};
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy};
use hallsweep_core::simulated::{Change, Simulated};
use hallsweep_core::speed::Speed;
use hallsweep_core::state::fact::{Entry, Fact, Unpacked, WrittenOut};
use hallsweep_core::state::{
    Conditions, Inspection, Participant, PersistentState, Phase, Reach, Retrieval, RetrievalStage, Stage, TeamStage, TeamState,
    Venue,
};
use hallsweep_core::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, Piece, Pose, Revision, Seq, WallTime};
use hallsweep_core::world::alarm::{Alarm, AlarmCause};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::coverage::{Coverage, Views};
use hallsweep_core::world::hall_map::{Bounds, HallMap, Mark, REACH};
use hallsweep_core::world::luggage::{Decision, Doubt, Judgement, Luggage, PhotoState};

const MARKS: [Mark; 6] = [Mark::Unknown, Mark::Seen, Mark::Visited, Mark::Wall, Mark::Luggage, Mark::NotInspected];

pub(crate) fn entry() -> impl Strategy<Value = Entry> {
    (wall(), fact()).prop_map(|(wall, fact)| Entry { wall, fact })
}

/// A fact of any kind. The pixels of a photo are left out, because they are stored elsewhere.
pub(crate) fn fact() -> impl Strategy<Value = Fact> {
    prop_oneof![
        text().prop_map(Fact::ProgramStarted),
        text().prop_map(Fact::ProgramEnded),
        any::<i64>().prop_map(Fact::ClockSet),
        (any::<[u64; 3]>(), text(), text()).prop_map(|([first, last, until], file, digest)| {
            Fact::WrittenOut(WrittenOut { missions: (MissionId(first), MissionId(last)), until: Seq(until), file, digest })
        }),
        (text(), text(), any::<u64>(), text())
            .prop_map(|(file, digest, behind, page)| { Fact::Unpacked(Unpacked { file, digest, behind: Seq(behind), page }) }),
        conditions().prop_map(Fact::Conditions),
        state().prop_map(|state| Fact::State(Box::new(state))),
        command(),
        any::<u64>().prop_map(|id| Fact::MissionBegan(MissionId(id), Order::Snail)),
        (any::<u64>(), vec(any::<u64>().prop_map(LuggageId), 0..4))
            .prop_map(|(id, left)| Fact::MissionArchived(MissionId(id), left)),
        phase().prop_map(Fact::Phase),
        vec(hold(), 0..4).prop_map(Fact::Holds),
        stops().prop_map(Fact::Epoch),
        (option::of(goal()), search()).prop_map(|(goal, search)| Fact::Goal(goal, search)),
        pose().prop_map(Fact::Pose),
        (robot(), pose()).prop_map(|(robot, pose)| Fact::RobotPose(robot, pose)),
        (robot(), 0..=Place::FURTHEST).prop_map(|(robot, steps)| Fact::Outside(robot, steps)),
        option::of(retrieval()).prop_map(|retrieval| Fact::Retrieval(retrieval.map(Box::new))),
        (cell(), any::<u32>()).prop_map(|(cell, piece)| Fact::MetAgain(cell, Piece(piece))),
        any::<u64>().prop_map(|id| Fact::Secured(LuggageId(id))),
        any::<bool>().prop_map(Fact::Led),
        (cell(), prop_oneof![Just("wall"), Just("luggage"), Just("unknown")]).prop_map(|(cell, kind)| Fact::Obstacle(cell, kind)),
        (cell(), one_of(&MARKS)).prop_map(|(cell, mark)| Fact::Mark(cell, mark)),
        luggage().prop_map(|record| Fact::Luggage { record: Arc::new(record), photo: None }),
        (any::<u64>(), text(), note(), hot()).prop_map(|(id, who, note, hot)| Fact::Unsure {
            luggage: LuggageId(id),
            who: who.into(),
            note,
            hot
        }),
        (any::<u64>(), any::<bool>()).prop_map(|(id, is_test)| Fact::Revealed { luggage: LuggageId(id), is_test }),
        judgement().prop_map(|judgement| Fact::Judged(Box::new(judgement))),
        (any::<u64>(), verdict(), text(), note(), hot()).prop_map(|(id, verdict, who, note, hot)| Fact::Verdict {
            hot,
            luggage: LuggageId(id),
            verdict,
            who: who.into(),
            note
        }),
        closed().prop_map(|closed| Fact::Closed(Box::new(closed))),
        (text(), name(), note()).prop_map(|(who, to, note)| Fact::HandedOver { who: who.into(), to, note }),
        again().prop_map(Fact::SearchAgain),
        area_names().prop_map(Fact::AreasOrdered),
        (area_name(), closed_area()).prop_map(|(area, closed)| Fact::AreaClosed(area, Box::new(closed))),
        (text(), celsius()).prop_map(|(source, celsius)| Fact::Temperature(source.into(), celsius)),
        text().prop_map(|source| Fact::ThermometerSilent(source.into())),
        (any::<u64>(), option::of(any::<u64>()), alarm_cause())
            .prop_map(|(id, luggage, cause)| { Fact::AlarmRaised(AlarmId(id), luggage.map(LuggageId), cause) }),
        (any::<u64>(), text()).prop_map(|(id, who)| Fact::AlarmAcknowledged(AlarmId(id), who.into())),
        Just(Fact::Strategy(Order::Snail)),
        heading().prop_map(Fact::MapEmptied),
    ]
}

fn again() -> impl Strategy<Value = Again> {
    prop_oneof![
        (cell(), cell()).prop_map(|(one, other)| Again::Within(Bounds::of(one).including(other))),
        area_name().prop_map(Again::Area),
    ]
}

fn area_name() -> impl Strategy<Value = Arc<str>> {
    "[^\\p{C}\\p{Z}]{1,40}".prop_filter_map("a name of an area", |name| Area::is_name(&name).then(|| name.into()))
}

fn area_names() -> impl Strategy<Value = Arc<[Arc<str>]>> {
    btree_set(area_name(), 0..4).prop_map(|names| names.into_iter().collect())
}

fn closed_area() -> impl Strategy<Value = Closed<OpenInArea>> {
    (text(), name(), note(), (any::<u32>(), any::<u32>()), wall()).prop_map(|(who, name, note, (cells, pending), wall)| {
        let open = OpenInArea { cells: cells as usize, pending: pending as usize };
        Closed { who: who.into(), name, note, open, wall }
    })
}

fn open_points() -> impl Strategy<Value = OpenPoints> {
    let some = || 0..100_000_usize;
    let left = (some(), some(), some(), some(), some(), some(), some());
    left.prop_map(|(pending, bombs, places, kept_out, again, unvisited, unreachable)| OpenPoints {
        pending,
        bombs,
        places,
        kept_out,
        again,
        unvisited,
        unreachable,
    })
}

fn name() -> impl Strategy<Value = Note> {
    note().prop_map(|note| note.unwrap_or_else(|| Note::new("Anna Rossi").expect("a sound name")))
}

fn closed() -> impl Strategy<Value = Closed> {
    (text(), name(), note(), open_points(), wall()).prop_map(|(who, name, note, open, wall)| Closed {
        who: who.into(),
        name,
        note,
        open,
        wall,
    })
}

fn conditions() -> impl Strategy<Value = Conditions> {
    let reach = option::of((any::<u32>(), any::<u32>()).prop_map(|(a, b)| Reach { reachable: a.min(b), free: a.max(b) }));
    let robot = (text(), text(), option::of(text())).prop_map(|(name, kind, address)| Participant {
        name: name.into(),
        kind: kind.into(),
        address: address.map(Into::into),
    });
    let side = (option::of(0.01..100.0), any::<bool>(), any::<bool>());
    let rings = prop_oneof![Just(0.0), 0.1..Rules::WIDEST_M];
    let rules = (one_of(&AfterDanger::ALL), rings, one_of(&SafeBy::ALL), one_of(&HotRule::ALL), 0..=Rules::MOST_VIEWS);
    let rules = rules.prop_map(|(after_danger, keep_out_m, safe_by, hot, unsure_views)| Rules {
        after_danger,
        keep_out_m,
        safe_by,
        hot,
        unsure_views,
    });
    (text(), side, celsius(), reach, vec(robot, 0..3), option::of(any::<u64>()), rules).prop_map(
        |(hall, (cell_m, is_reckoned, is_exercise), threshold, reach, robots, seed, rules)| Conditions {
            venue: Venue {
                name: hall.into(),
                cell_m,
                is_reckoned,
                reach,
                robots: robots.into(),
                is_exercise,
                seed,
                ..Venue::default()
            },
            threshold,
            rules,
        },
    )
}

pub(super) fn command() -> impl Strategy<Value = Fact> {
    let issuer = (one_of(&DOORS), text(), text());
    let issuer = issuer.prop_map(|(door, who, from)| Issuer { door, who: who.into(), from: from.into() });
    let id = option::of(command_id());
    let refused = option::of(refused());
    let luggage = option::of(any::<u64>().prop_map(LuggageId));
    let epoch = option::of(any::<u64>().prop_map(Epoch));
    (issuer, id, asked(), epoch, luggage, refused).prop_map(|(issuer, id, asked, epoch, luggage, refused)| Fact::Command {
        issuer,
        id,
        asked,
        epoch,
        luggage,
        refused,
    })
}

fn command_id() -> impl Strategy<Value = CommandId> {
    "[!-~]{1,128}".prop_map(|text| CommandId::new(&text).expect("visible ASCII of a fit length"))
}

fn asked() -> impl Strategy<Value = Asked> {
    let piece = option::of(any::<u64>()).prop_map(|id| id.map_or(LuggageRef::Pending, |id| LuggageRef::Id(LuggageId(id))));
    let sensor = text().prop_filter_map("a name of a sensor", |text| TemperatureReport::sensor_name(&text));
    let report = prop_oneof![
        Just(TemperatureReport::Ok),
        Just(TemperatureReport::TooHigh),
        celsius().prop_map(TemperatureReport::Reading),
        (sensor, celsius()).prop_map(|(sensor, celsius)| TemperatureReport::Sensor(sensor, celsius)),
    ];
    let command = prop_oneof![
        prop::sample::select(Command::BARE.to_vec()),
        one_of(&Move::ALL).prop_map(Command::Move),
        cell().prop_map(Command::Goto),
        (piece, verdict(), note(), hot()).prop_map(|(luggage, verdict, note, hot)| Command::Verdict {
            luggage,
            verdict,
            note,
            hot
        }),
        any::<u64>().prop_map(|id| Command::RetakePhoto(LuggageId(id))),
        any::<u64>().prop_map(|id| Command::Acknowledge(AlarmId(id))),
        one_of(&Order::ALL).prop_map(Command::ChooseStrategy),
        report.prop_map(Command::Temperature),
        again().prop_map(Command::SearchAgain),
        area_names().prop_map(Command::OrderAreas),
        (area_name(), name(), note(), option::of(any::<u64>())).prop_map(|(area, name, note, mission)| {
            Command::CloseArea(AreaClosing { area, name, note, mission: mission.map(MissionId) })
        }),
    ];
    let within = option::of((0..100_000_u64).prop_map(|tenths| Duration::from_millis(tenths * 100)));
    let one = prop_oneof![
        4 => command.prop_map(Asked::Command),
        1 => (any::<u64>(), within).prop_map(|(count, within)| Asked::Stops { count, within }),
        1 => simulated().prop_map(Asked::Simulated),
        1 => text().prop_map(Asked::Words),
    ];
    one.prop_recursive(1, 2, 1, |one| (one, any::<u64>()).prop_map(|(last, more)| Asked::Many { last: Box::new(last), more }))
}

fn simulated() -> impl Strategy<Value = Simulated> {
    let either = || option::of(any::<bool>());
    let speed = option::of(prop_oneof![Just(Speed::Max), (0.1..1000.0).prop_map(Speed::Times)]);
    let change = (speed, either(), either(), either(), either(), option::of(btree_set(cell(), 0..3)));
    let change = change.prop_map(|(speed, is_paused, link_lost, no_thermometer, camera_fails, blocked)| Change {
        speed,
        is_paused,
        link_lost,
        no_thermometer,
        camera_fails,
        blocked,
    });
    prop_oneof![
        4 => change.prop_map(Simulated::Changed),
        1 => Just(Simulated::Step),
        1 => text().prop_map(|hall| Simulated::PutDown(hall.into())),
        1 => text().prop_map(Simulated::Kept),
        1 => text().prop_map(Simulated::Discarded),
    ]
}

fn refused() -> impl Strategy<Value = Refused> {
    let plain = [
        Refused::SentBefore,
        Refused::Driving,
        Refused::NotStopped,
        Refused::NotCapable,
        Refused::Moving,
        Refused::Unrecorded,
        Refused::NothingPending,
        Refused::PhotoUnderWay,
        Refused::NoRetrievalRobot,
        Refused::StoreDown,
        Refused::NotKept,
    ];
    let of_pieces =
        [Refused::VerdictPending, Refused::BombUnfetched, Refused::UnknownLuggage, Refused::NoPhoto, Refused::NotInspected];
    let of_robots = [Refused::FetcherUnreached, Refused::FetcherAbroad];
    prop_oneof![
        8 => prop::sample::select(plain.to_vec()),
        4 => (prop::sample::select(of_pieces.to_vec()), any::<u64>()).prop_map(|(refused, id)| refused(LuggageId(id))),
        2 => (prop::sample::select(of_robots.to_vec()), robot()).prop_map(|(refused, robot)| refused(robot)),
        2 => (btree_set(hold(), 1..9), option::of(text())).prop_map(|(holds, why)| held(holds, why)),
        1 => (any::<u64>(), any::<u64>()).prop_map(|(sent, now)| Refused::Outdated { sent: Epoch(sent), now: Epoch(now) }),
        1 => one_of(&PhaseName::ALL).prop_map(Refused::NotInPhase),
        1 => cell().prop_map(Refused::IntoObstacle),
        1 => (any::<u64>(), verdict()).prop_map(|(id, verdict)| Refused::Decided { luggage: LuggageId(id), verdict }),
        1 => any::<u64>().prop_map(|id| Refused::UnknownAlarm(AlarmId(id))),
        1 => any::<u64>().prop_map(|id| Refused::OtherMission(MissionId(id))),
        1 => cause().prop_map(Refused::FaultStands),
        1 => command_id().prop_map(Refused::OtherContent),
        1 => text().prop_map(|name| Refused::UnknownSensor(name.into())),
        1 => area_name().prop_map(Refused::UnknownArea),
        1 => area_name().prop_map(Refused::AreaClosed),
        1 => text().prop_map(Refused::NotAllowed),
        1 => text().prop_map(|words| Refused::InWords(refusal("malformed", words))),
    ]
}

/// A refusal because of holds. If there is a reason of the store, the store's hold is added: the reason occurs only
/// with this hold.
fn held(mut holds: BTreeSet<Hold>, why: Option<String>) -> Refused {
    if why.is_some() {
        holds.insert(Hold::Store);
    }
    Refused::Held(holds.into_iter().collect(), why)
}

fn coverage() -> impl Strategy<Value = Coverage> {
    let views = (1..=u32::MAX, 0..u32::MAX / 2).prop_map(|(bits, minute)| Views { bits, minute });
    vec((-5..70, -5..70, views), 0..9).prop_map(|cells| {
        let mut coverage = Coverage::default();
        cells.into_iter().for_each(|(x, y, views)| coverage.add(Cell::new(x, y), views));
        coverage
    })
}

fn stops() -> impl Strategy<Value = Epoch> {
    (0..=i64::MAX as u64).prop_map(Epoch)
}

fn robot() -> impl Strategy<Value = RobotId> {
    "[a-z][a-z0-9-]{0,31}".prop_map(|name| RobotId::new(&name).expect("a name"))
}

fn state() -> impl Strategy<Value = PersistentState> {
    let numbers = (any::<u64>(), any::<bool>(), stops(), any::<u64>(), any::<u64>(), any::<bool>());
    let others = btree_map(robot(), pose(), 0..3);
    let outside = (btree_map(robot(), 1..=Place::FURTHEST, 0..3), option::of(retrieval()));
    let mission =
        (phase(), btree_set(hold(), 0..9), search(), option::of(goal()), btree_set(cell(), 0..4), (pose(), others, outside));
    let met_again = btree_map(cell(), any::<u32>().prop_map(Piece), 0..3);
    let pieces = (btree_set(any::<u32>().prop_map(Piece), 0..4), met_again);
    let map = (hall_map(), coverage());
    let world = (map, pieces, vec(luggage(), 0..4), vec(alarm(), 0..4));
    let areas = (area_names(), btree_map(area_name(), closed_area(), 0..3));
    let rest = (option::of(celsius()), option::of(conditions()), option::of(closed()), btree_set(cell(), 0..4), areas);
    (numbers, mission, world, rest).prop_map(|(numbers, mission, world, (reading, conditions, closed, again, areas))| {
        let (id, under_way, epoch, last_luggage, last_alarm, led_blinking) = numbers;
        let (phase, holds, search, goal, blocked, (pose, others, (outside, retrieval))) = mission;
        let ((map, coverage), (pieces, met_again), luggage, alarms) = world;
        PersistentState {
            mission: MissionId(id),
            under_way,
            phase,
            holds: holds.into_iter().collect(),
            epoch,
            strategy: Order::Snail,
            search,
            goal,
            blocked,
            again: Arc::new(again),
            pose,
            others,
            outside,
            retrieval,
            led_blinking,
            map,
            coverage,
            pieces,
            met_again,
            luggage: luggage.into_iter().map(Arc::new).collect(),
            last_luggage: LuggageId(last_luggage),
            alarms: alarms.into_iter().map(Arc::new).collect(),
            last_alarm: AlarmId(last_alarm),
            reading,
            closed: closed.map(Arc::new),
            area_order: areas.0,
            closed_areas: Arc::new(areas.1),
            conditions,
            clock_set_ms: i64::try_from(epoch.0).unwrap_or(-1),
        }
    })
}

fn phase() -> impl Strategy<Value = Phase> {
    let leaf = prop_oneof![
        Just(Phase::Idle),
        Just(Phase::Exploring),
        inspection().prop_map(Phase::Inspecting),
        Just(Phase::ReturningHome),
        Just(Phase::AtHome),
        Just(Phase::ReturningWithAlarm),
        Just(Phase::BombLocated),
        Just(Phase::Retrieving),
        Just(Phase::BagSecured),
        Just(Phase::Explored),
    ];
    leaf.prop_recursive(3, 4, 1, |inner| {
        let interrupted = inner.prop_map(Box::new);
        prop_oneof![
            (option::of(cell()), option::of(one_of(&Move::ALL)), interrupted.clone())
                .prop_map(|(goal, next, interrupted)| Phase::Driving { goal, next, interrupted }),
            (cause(), interrupted).prop_map(|(cause, interrupted)| Phase::Fault { cause, interrupted }),
        ]
    })
}

fn inspection() -> impl Strategy<Value = Inspection> {
    let id = || any::<u64>().prop_map(LuggageId);
    let stage = prop_oneof![
        Just(Stage::BackingUp),
        Just(Stage::TakingPhoto),
        id().prop_map(Stage::Recording),
        id().prop_map(Stage::AwaitingVerdict),
        id().prop_map(Stage::RetakingPhoto),
        id().prop_map(Stage::Viewing),
    ];
    (cell(), option::of(any::<u32>().prop_map(Piece)), pose(), stage, any::<u8>())
        .prop_map(|(cell, piece, pose, stage, views)| Inspection { cell, piece, pose, stage, views })
}

fn cause() -> impl Strategy<Value = FaultCause> {
    prop_oneof![
        Just(FaultCause::NoWayHome),
        Just(FaultCause::Unanswered),
        Just(FaultCause::Undecided),
        text().prop_map(FaultCause::Robot),
        not_fetched().prop_map(FaultCause::NotFetched),
    ]
}

/// A reason why a piece was not fetched. The reason is known to this version, or is in words that may be unknown.
fn not_fetched() -> impl Strategy<Value = NotFetched> {
    let once = || {
        prop_oneof![
            (one_of(&RetrievalFault::ALL), option::of(text())).prop_map(|(fault, words)| NotFetched::Pair(fault, words)),
            one_of(&AloneFault::ALL).prop_map(NotFetched::Alone),
            text().prop_map(NotFetched::Other),
        ]
    };
    let stuck = |(fault, before): (_, Option<NotFetched>)| NotFetched::Stuck(fault, before.map(Box::new));
    prop_oneof![once(), (one_of(&StuckFault::ALL), option::of(once())).prop_map(stuck)]
}

fn retrieval() -> impl Strategy<Value = Retrieval> {
    let stage = prop_oneof![
        Just(RetrievalStage::MakingRoom),
        Just(RetrievalStage::Fetching),
        Just(RetrievalStage::LettingGo),
        option::of(not_fetched()).prop_map(RetrievalStage::GoingOut),
        option::of(not_fetched()).prop_map(RetrievalStage::ComingHome),
    ];
    let call = option::of(any::<u64>().prop_map(AlarmId));
    (any::<u64>(), one_of(&Fetcher::ALL), stage, btree_set(cell(), 0..3), call, option::of(team())).prop_map(
        |(luggage, fetcher, stage, piece, call, team)| Retrieval {
            luggage: LuggageId(luggage),
            fetcher,
            stage,
            piece,
            call,
            team,
        },
    )
}

fn team() -> impl Strategy<Value = TeamState> {
    let stage = prop_oneof![
        Just(TeamStage::Working),
        Just(TeamStage::Lost),
        Just(TeamStage::Done),
        one_of(&RetrievalFault::ALL).prop_map(TeamStage::Faulted),
    ];
    let place = prop_oneof![cell().prop_map(Place::Cell), (1..=Place::FURTHEST).prop_map(Place::Outside)];
    let dropped = option::of((any::<u32>(), place).prop_map(|(piece, place)| Parcel { piece: Piece(piece), place }));
    let blackboard = vec(("[a-z]{1,8}", text().prop_map(|text| TreeValue::text(&text))), 0..3);
    let counts = (any::<u32>(), any::<bool>(), any::<u32>());
    (stage, dropped, blackboard, counts).prop_map(|(stage, dropped, blackboard, (losses, has_called, runs))| TeamState {
        stage,
        dropped,
        blackboard,
        losses,
        has_called,
        runs,
        ..Team::new().state()
    })
}

fn note() -> impl Strategy<Value = Option<Note>> {
    text().prop_map(|text| Note::new(&text))
}

fn hot() -> impl Strategy<Value = Hot> {
    let answer = || option::of(one_of(&HotAnswer::ALL));
    let size = option::of(prop_oneof![one_of(&BombSize::NAMED), (1..=BombSize::WIDEST_M).prop_map(BombSize::Radius)]);
    (answer(), answer(), answer(), size).prop_map(|(hidden, obvious, typical, size)| Hot { hidden, obvious, typical, size })
}

fn judgement() -> impl Strategy<Value = Judgement> {
    let issuer = (one_of(&DOORS), text(), text());
    let issuer = issuer.prop_map(|(door, who, from)| Issuer { door, who: who.into(), from: from.into() });
    let known_by = (wall(), option::of(command_id()), any::<bool>());
    (any::<u64>(), verdict(), issuer, note(), hot(), wall(), known_by).prop_map(
        |(luggage, verdict, issuer, note, hot, wall, (taken, id, is_bare))| Judgement {
            luggage: LuggageId(luggage),
            verdict,
            issuer,
            note,
            hot,
            wall,
            taken,
            id,
            is_bare,
        },
    )
}

fn luggage() -> impl Strategy<Value = Luggage> {
    let photo = prop_oneof![
        (any::<usize>(), any::<u32>()).prop_map(|(bytes, take)| PhotoState::Taken { bytes, take }),
        text().prop_map(PhotoState::Failed),
    ];
    let decision = (verdict(), text(), wall(), note(), hot());
    let decision = decision.prop_map(|(verdict, who, wall, note, hot)| Decision { verdict, who: who.into(), wall, note, hot });
    let doubt = (text(), wall(), note(), hot());
    let doubt = doubt.prop_map(|(who, wall, note, hot)| Doubt { who: who.into(), wall, note, hot });
    let decision = (option::of(decision), vec(judgement(), 0..2), vec(doubt, 0..2), option::of(any::<bool>()));
    let pose = (pose(), vec(pose(), 0..3));
    let piece = option::of(any::<u32>().prop_map(Piece));
    (any::<u64>(), cell(), pose, wall(), photo, decision, piece, (option::of(wall()), any::<i64>(), wall())).prop_map(
        |(
            id,
            cell,
            (pose, seen_from),
            taken,
            photo,
            (verdict, judged, unsure, truth),
            piece,
            (secured, clock_set_ms, first_taken),
        )| {
            Luggage {
                id: LuggageId(id),
                cell,
                pose,
                taken,
                first_taken,
                photo,
                seen_from,
                verdict,
                unsure,
                judged,
                truth,
                piece,
                secured,
                clock_set_ms,
            }
        },
    )
}

fn alarm_cause() -> impl Strategy<Value = AlarmCause> {
    let id = || any::<u64>().prop_map(LuggageId);
    prop_oneof![
        (id(), cell()).prop_map(|(id, cell)| AlarmCause::Dangerous(id, cell)),
        (id(), cell()).prop_map(|(id, cell)| AlarmCause::Unrecorded(id, cell)),
        (id(), one_of(&[Saying::CallOperator, Saying::PackageLost])).prop_map(|(id, saying)| AlarmCause::Call(id, saying)),
        text().prop_map(AlarmCause::Other),
    ]
}

fn alarm() -> impl Strategy<Value = Alarm> {
    let seen = option::of((text().prop_map(Arc::from), wall()));
    (any::<u64>(), wall(), alarm_cause(), option::of(any::<u64>()), seen).prop_map(
        |(id, raised, cause, luggage, acknowledged)| Alarm {
            id: AlarmId(id),
            raised,
            cause,
            luggage: luggage.map(LuggageId),
            acknowledged,
        },
    )
}

/// A map with cells near home and at the greatest distance.
fn hall_map() -> impl Strategy<Value = HallMap> {
    let near = (-40..40, -40..40);
    let far = (prop_oneof![Just(-REACH), Just(REACH), -REACH..=REACH], -40..40);
    let cells = prop_oneof![8 => near, 1 => far].prop_map(|(x, y)| Cell::new(x, y));
    vec((cells, one_of(&MARKS)), 0..60).prop_map(|cells| {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for (cell, mark) in cells {
            map.mark(cell, mark, Revision(2));
        }
        map
    })
}

fn search() -> impl Strategy<Value = Search> {
    (1..2 * i64::from(REACH), 0..5_i64).prop_map(|(ring, stage)| Order::Snail.resume(&[ring, stage]))
}

fn goal() -> impl Strategy<Value = Goal> {
    prop_oneof![Just(Goal::Home), cell().prop_map(Goal::Visit)]
}

fn pose() -> impl Strategy<Value = Pose> {
    (cell(), heading()).prop_map(|(cell, heading)| Pose { cell, heading })
}

fn cell() -> impl Strategy<Value = Cell> {
    (-2 * REACH..=2 * REACH, -2 * REACH..=2 * REACH).prop_map(|(x, y)| Cell::new(x, y))
}

fn wall() -> impl Strategy<Value = WallTime> {
    (any::<i64>(), any::<i32>()).prop_map(|(unix_ms, offset_s)| WallTime { unix_ms, offset_s })
}

fn celsius() -> impl Strategy<Value = Celsius> {
    (Celsius::LEAST..=Celsius::MOST).prop_map(|degrees| Celsius::new(degrees).expect("drawn from what is believed"))
}

fn heading() -> impl Strategy<Value = Heading> {
    one_of(&Heading::ALL)
}

fn hold() -> impl Strategy<Value = Hold> {
    one_of(&Hold::ALL)
}

fn verdict() -> impl Strategy<Value = Verdict> {
    prop_oneof![Just(Verdict::Safe), Just(Verdict::Danger)]
}

fn text() -> impl Strategy<Value = String> {
    ".{0,20}"
}

fn one_of<T: Copy + std::fmt::Debug + 'static>(all: &'static [T]) -> impl Strategy<Value = T> + Clone {
    proptest::sample::select(all)
}
