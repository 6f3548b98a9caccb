//! Hand-made snapshots for tests of the API and of the doors: a small hall, a mission under way, and one piece of
//! each kind. The snapshots are not simulated, so their parts need not fit together.

use std::sync::Arc;

use crate::api::journal::{self, Line};
use crate::runtime::archive::{Happened, Unreadable};
use hallsweep_core::command::{Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{Parts, RobotId, RobotState};
use hallsweep_core::snapshot::log::{LogLine, Tone};
use hallsweep_core::snapshot::robot::{RobotShown, RobotView};
use hallsweep_core::snapshot::said::Said;
use hallsweep_core::snapshot::{MissionView, Progress, Refusals, Snapshot};
use hallsweep_core::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, Pose, Revision, Seq, WallTime};
use hallsweep_core::world::alarm::{AlarmCause, AlarmView};
use hallsweep_core::world::hall_map::{HallMap, Mark};
use hallsweep_core::world::keep_out::KeepOut;
use hallsweep_core::world::luggage::{Decision, Luggage, PhotoState};
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::temperature::{TemperatureStatus, TemperatureView};

/// 10:00 on 3 February 2026, one hour east of Greenwich.
pub(crate) const TEN: WallTime = WallTime { unix_ms: 1_770_109_200_000, offset_s: 3600 };

/// Returns these entries as exported lines.
pub(crate) fn exported(mission: MissionId, happened: Vec<Happened>) -> Vec<(Seq, String)> {
    let line = |(seq, entry): Happened| match entry {
        Ok(entry) => (seq, journal::line(&Line { seq, mission: Some(mission), entry, picture: None })),
        Err(Unreadable(why)) => (seq, journal::unreadable(seq, &why)),
    };
    happened.into_iter().map(line).collect()
}

/// A snapshot at revision 1: an idle robot at home that knows only its own cell.
pub(crate) fn idle() -> Snapshot {
    let robot = RobotView {
        state: RobotState::Stopped,
        halting: false,
        pose: Pose::START,
        off_centre: false,
        outside: 0,
        sonar_cm: None,
        led_blinking: false,
        unreached_since: None,
    };
    Snapshot {
        run: Arc::from("t-1"),
        hall: None,
        revision: Revision(1),
        revisions: [Revision(1); Resource::COUNT],
        mission: idle_mission(),
        robot,
        robots: alone(robot),
        map: HallMap::new(Cell::HOME, Revision(1)),
        coverage: Default::default(),
        venue: Default::default(),
        luggage: Default::default(),
        temperature: TemperatureView {
            celsius: None,
            read: None,
            silent_since: None,
            status: TemperatureStatus::Ok,
            threshold: degrees(25.0),
            cool: degrees(24.0),
            hot: Vec::new(),
        },
        alarms: Arc::from([]),
        retrieval: None,
        log: Arc::from([]),
    }
}

/// A snapshot at revision 20 of a search in a hall of six columns and four rows. There are a safe piece, a dangerous
/// one and a pending one.
pub(crate) fn searching() -> Snapshot {
    let mut snapshot = idle();
    touch(&mut snapshot, 20, &Resource::ALL);
    snapshot.map = drawn(&["111L1W", "1111?W", "1L1N?W", "1111?W", "WWWWW?"], 20);
    snapshot.robot.pose = Pose { cell: Cell::new(2, 2), heading: Heading::East };
    snapshot.robot.sonar_cm = Some(42);
    snapshot.robot.led_blinking = true;
    snapshot.robots = alone(snapshot.robot);
    snapshot.mission.id = MissionId(1);
    snapshot.mission.phase = PhaseName::Inspecting;
    snapshot.mission.goal = Some(Cell::new(4, 4));
    snapshot.mission.route = Arc::from([Cell::new(2, 3), Cell::new(3, 3)]);
    snapshot.mission.trail = Arc::from([Cell::new(0, 0), Cell::new(1, 0), Cell::new(2, 0), Cell::new(2, 1), Cell::new(2, 2)]);
    snapshot.mission.inspected = Some(LuggageId(3));
    snapshot.mission.progress = Progress { visited: 15, unknown: 4, ..Progress::default() };
    snapshot.mission.refusals.start = Some(Refused::VerdictPending(LuggageId(3)));
    (snapshot.temperature.celsius, snapshot.temperature.read) = (Some(degrees(21.4)), Some(TEN));
    snapshot.luggage = [
        piece(1, Cell::new(3, 0), Some(Verdict::Safe)),
        piece(2, Cell::new(1, 2), Some(Verdict::Danger)),
        piece(3, Cell::new(3, 2), None),
    ]
    .into();
    let cause = AlarmCause::Other("luggage #2 is dangerous".to_owned());
    let alarm = AlarmView { id: Some(AlarmId(1)), raised: TEN, cause, luggage: Some(LuggageId(2)), acknowledged: None };
    snapshot.alarms = Arc::from([alarm]);
    write(&mut snapshot, Tone::Info, "exploration began");
    write(&mut snapshot, Tone::Alarm, "luggage #2 is dangerous");
    write(&mut snapshot, Tone::Info, "luggage #3 found at (3, 2)");
    snapshot
}

/// Makes a map from rows that begin at (0, 0). `1` is visited, `W` wall, `L` luggage, `N` luggage not inspected;
/// anything else is unknown.
pub(crate) fn drawn(rows: &[&str], revision: u64) -> HallMap {
    let mut map = HallMap::new(Cell::HOME, Revision(revision));
    for (y, row) in (0..).zip(rows) {
        for (x, mark) in (0..).zip(row.chars()) {
            let mark = match mark {
                '1' => Mark::Visited,
                'W' => Mark::Wall,
                'L' => Mark::Luggage,
                'N' => Mark::NotInspected,
                _ => Mark::Unknown,
            };
            map.mark(Cell::new(x, y), mark, Revision(revision));
        }
    }
    map
}

/// A record of a piece that was photographed from the cell to its west.
pub(crate) fn piece(id: u64, cell: Cell, verdict: Option<Verdict>) -> Arc<Luggage> {
    Arc::new(Luggage {
        id: LuggageId(id),
        cell,
        pose: Pose { cell: Cell::new(cell.x - 1, cell.y), heading: Heading::East },
        taken: TEN,
        first_taken: TEN,
        photo: PhotoState::Taken { bytes: 4, take: 1 },
        verdict: verdict.map(|verdict| Decision {
            verdict,
            who: Arc::from("operator"),
            wall: TEN,
            note: None,
            hot: Default::default(),
        }),
        seen_from: Vec::new(),
        unsure: Vec::new(),
        judged: Vec::new(),
        truth: None,
        piece: None,
        secured: None,
        clock_set_ms: 0,
    })
}

pub(crate) fn touch(snapshot: &mut Snapshot, revision: u64, resources: &[Resource]) {
    snapshot.revision = Revision(revision);
    for resource in resources {
        snapshot.revisions[*resource as usize] = Revision(revision);
    }
}

pub(crate) fn write(snapshot: &mut Snapshot, tone: Tone, text: &str) {
    let number = snapshot.log.last().map_or(1, |line| line.number + 1);
    let line = Arc::new(LogLine { number, wall: TEN, tone, said: Said::Words(text.to_owned()) });
    snapshot.log = snapshot.log.iter().cloned().chain([line]).collect();
}

pub(crate) fn degrees(celsius: f64) -> Celsius {
    Celsius::new(celsius).unwrap()
}

/// The list of all robots if the robot that searches is the only one.
fn alone(view: RobotView) -> Arc<[RobotShown]> {
    Arc::from([RobotShown {
        id: RobotId::discovery(),
        view,
        parts: Some(Parts::ROUND_ROBOT),
        holds: Vec::new(),
        arm: None,
        unreached: None,
    }])
}

fn idle_mission() -> MissionView {
    MissionView {
        open: Default::default(),
        again: Default::default(),
        areas: Default::default(),
        is_viewing: false,
        is_exercise: false,
        is_truth_hidden: false,
        closed: None,
        id: MissionId(0),
        phase: PhaseName::Idle,
        interrupted: None,
        fault: None,
        store_failure: None,
        holds: Vec::new(),
        goal: None,
        route: Arc::from([]),
        trail: Arc::from([]),
        inspected: None,
        strategy: Strategy::Snail,
        epoch: Epoch(1),
        progress: Progress::default(),
        keep_out: KeepOut::default(),
        clock_set_ms: 0,
        refusals: Refusals { back_home: Some(Refused::NotInPhase(PhaseName::Idle)), ..Refusals::default() },
    }
}
