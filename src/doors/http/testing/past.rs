//! Two invented missions for tests of this door. The first mission is over, and a bomb was left behind. The second
//! mission has just begun. `testing` has the archive that returns them.

use std::collections::BTreeSet;

use crate::api::tests::fixture::{TEN, searching};
use crate::runtime::archive::{At, Happened, MissionRecord, PastMoment, Sound, Unreadable};
use hallsweep_core::arm::{ArmState, Parcel};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Issuer, Strategy};
use hallsweep_core::engine::Past;
use hallsweep_core::hold::Hold;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::refused::Refused;
use hallsweep_core::retrieval::team::TICK;
use hallsweep_core::retrieval::{BaseView, Team, View};
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{PersistentState, Phase, Retrieval, RetrievalStage};
use hallsweep_core::units::{Cell, Celsius, Heading, LuggageId, MissionId, Piece, Pose, Revision, Seq, WallTime};
use hallsweep_core::world::hall_map::HallMap;
use hallsweep_core::world::keep_out::NOWHERE;

/// Number of a mission that cannot be read.
pub(super) const UNREADABLE: MissionId = MissionId(99);

/// The reported damage in the record of the first mission.
pub(super) const DAMAGE: &str = "entry 6 of the journal cannot be understood (a mouse was at it)";

pub(super) fn missions() -> [MissionRecord; 2] {
    let hour = |hours: i64| WallTime { unix_ms: TEN.unix_ms + hours * 3_600_000, ..TEN };
    let first = MissionRecord {
        id: MissionId(1),
        strategy: Strategy::Snail.name().into(),
        began: TEN,
        archived: Some(hour(1)),
        phase: "bombLocated".into(),
        luggage: 3,
        dangerous: 1,
        left: vec![LuggageId(2)],
        is_exercise: false,
    };
    let second = MissionRecord {
        id: MissionId(2),
        began: hour(2),
        archived: None,
        phase: "exploring".into(),
        luggage: 0,
        dangerous: 0,
        left: Vec::new(),
        ..first.clone()
    };
    [second, first]
}

/// Returns the state when the first mission was archived, with the map and the luggage of `searching()`.
pub(super) fn state() -> PersistentState {
    let state = searching();
    PersistentState {
        mission: MissionId(1),
        map: state.map,
        luggage: state.luggage,
        phase: Phase::BombLocated,
        ..PersistentState::first(Strategy::Snail)
    }
}

/// Returns the first mission at a moment. The robot was held at home, and the temperature rose. All its entries were
/// written at the same time.
pub(super) fn moment(at: At) -> Option<PastMoment> {
    let most = match at {
        At::Entry(seq) => seq,
        At::Time(unix_ms) | At::TimeAmong(unix_ms, _) if unix_ms < TEN.unix_ms => Seq(1),
        At::Time(_) | At::TimeAmong(..) => Seq(5),
    };
    let entries = entries().into_iter().filter(|(seq, _)| *seq <= most);
    let mut state = PersistentState { mission: MissionId(1), ..PersistentState::first(Strategy::Snail) };
    let seq = entries.filter_map(|(seq, entry)| entry.ok().map(|entry| (seq, state.apply(&entry)))).last()?.0;
    let warm = Celsius::new(23.5).map(|celsius| Entry { wall: TEN, fact: Fact::Temperature("hall".into(), celsius) });
    let past = Past { seq, state, trail: Vec::new(), temperatures: warm.into_iter().collect(), latest: Vec::new() };
    let (earlier, later) = ((seq > Seq(1)).then(|| Seq(seq.0 - 1)), (seq < Seq(6)).then(|| seq.next()));
    Some(PastMoment { past: Sound { of: past, damage: Vec::new() }, wall: TEN, earlier, later })
}

/// Returns the journal entries of a retrieval by the pair of robots. They contain the behaviour trees after each
/// tick, until the robots have found the parcel. Then the retrieval ends.
pub(super) fn retrieval() -> Vec<Happened> {
    let bag = Cell::new(3, 3);
    let (map, piece) = (HallMap::new(Cell::HOME, Revision(0)), BTreeSet::from([bag]));
    let (left, right) = (Place::Cell(Cell::new(2, 3)), Place::Cell(Cell::new(4, 3)));
    let outside = Place::ENTRANCE;
    let stations =
        [[outside; 2], [Place::Cell(Cell::HOME), outside], [left, outside], [left, right], [left, right], [left, right]];
    let kept = Retrieval {
        luggage: LuggageId(1),
        fetcher: Fetcher::Pair,
        stage: RetrievalStage::Fetching,
        piece: piece.clone(),
        call: None,
        team: None,
    };
    let mut team = Team::new();
    let mut facts = vec![Fact::Retrieval(Some(Box::new(Retrieval { stage: RetrievalStage::MakingRoom, ..kept.clone() })))];
    for (tick, places) in stations.into_iter().enumerate() {
        let base = |place| BaseView {
            stands: BasePose { place, heading: Heading::East },
            off_centre: false,
            open: None,
            failures: 0,
            arm: ArmState::default(),
        };
        let bases = places.map(base);
        let (map, piece, others, wanted) = (&map, &piece, &[], Some(Piece(1)));
        let view = View {
            map,
            way_out: true,
            others,
            piece,
            wanted,
            target: Place::ENTRANCE,
            bases,
            is_calling: false,
            kept_out: &NOWHERE,
        };
        if tick == 5 {
            team.handle_found(Some(Parcel { piece: Piece(1), place: Place::Cell(bag) }), wanted);
        }
        team.tick(&view, TICK);
        facts.push(Fact::Retrieval(Some(Box::new(Retrieval { team: Some(team.state()), ..kept.clone() }))));
    }
    facts.extend([Fact::Secured(LuggageId(1)), Fact::Retrieval(None)]);
    let at = |tenths: i64| WallTime { unix_ms: TEN.unix_ms + tenths * 100, ..TEN };
    let entries = (0..).zip(facts).map(|(tenths, fact)| Ok(Entry { wall: at(tenths), fact }));
    (1..).map(Seq).zip(entries).collect()
}

/// Returns the events of the first mission. One of them cannot be read.
pub(super) fn entries() -> Vec<Happened> {
    let command = |command, refused: Option<Refused>| {
        let issuer = Issuer { door: crate::api::door::CONSOLE, who: "anna".into(), from: "192.0.2.7".into() };
        Fact::Command { issuer, id: None, asked: Asked::Command(command), epoch: None, luggage: None, refused }
    };
    let facts = [
        Fact::MissionBegan(MissionId(1), Strategy::Snail),
        command(Command::Start, None),
        command(Command::Reset, Some(Refused::Moving)),
        Fact::Holds(vec![Hold::Operator]),
        Fact::Pose(Pose::START),
    ];
    let sound = facts.map(|fact| Ok(Entry { wall: TEN, fact }));
    (1..).map(Seq).zip(sound.into_iter().chain([Err(Unreadable(DAMAGE.to_owned()))])).collect()
}
