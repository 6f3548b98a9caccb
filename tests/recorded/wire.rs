//! JSON, CBOR and text forms of states, changes, refusals and entries of the journal.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::book::{Book, hex};
use super::doors::{
    AlarmId, CODES, Cell, ChangesJson, Code, CommandId, CoverageJson, Entry, Epoch, Fact, Hold, LuggageId, MapJson, MissionId,
    OpenPoints, PhaseName, Picture, ProblemJson, ProblemKind, Refusal, RefusalKind, Refused, Resource, ResourceKind, Revision,
    RobotId, Seq, Snapshot, StateJson, Verdict, cbor, concise_problem, journal, journal_words, map_text, old_items, qak, senml,
    state, text,
};

/// Records every form of a state, and of its changes since the one before.
pub(crate) fn snapshot(book: &mut Book, older: Option<&Snapshot>, newer: &Snapshot) {
    shape(book, "state", &StateJson::from(newer));
    if let Some(older) = older {
        shape(book, "changes", &ChangesJson::between(older, newer));
        let earlier = Revision(newer.revision.0.saturating_sub(20));
        shape(book, "changes since 20 revisions ago", &ChangesJson::since(newer, earlier));
    }
    for resource in Resource::ALL {
        let name = ResourceKind::Of(resource).row().name;
        match resource {
            Resource::Mission => shape(book, name, &state::mission(newer)),
            Resource::Robot => shape(book, name, &state::robot(newer)),
            Resource::Map => shape(book, name, &MapJson::from(newer)),
            Resource::Coverage => {
                let shown = ResourceKind::Of(resource);
                shape(book, name, &CoverageJson::new(newer, shown.revision(newer)));
            }
            Resource::Luggage => shape(book, name, &state::luggage(newer)),
            Resource::Temperature => shape(book, name, &state::temperature(newer)),
            Resource::Alarms => shape(book, name, &state::alarms(newer)),
            Resource::Retrieval => shape(book, name, &state::retrieval(newer)),
            Resource::Log => shape(book, name, &state::log_after(newer, newer.log.last().map_or(0, |line| line.number - 1))),
        }
    }
    words(book, newer);
}

/// Plain texts, also those of old clients.
fn words(book: &mut Book, newer: &Snapshot) {
    let mut say = |title: &str, words: String| book.show("text", title, words.as_bytes());
    say("mission", text::mission(&newer.mission));
    say("temperature", text::temperature(&newer.temperature));
    say("senml temperature", senml::temperature(&newer.temperature));
    say("senml robot", senml::robot(&newer.robot));
    say("map", map_text::lines(newer));
    say("map in one line", map_text::one_line(newer));
    say("old robot", old_items::robot(&newer.robot));
    say("old map", old_items::room_map(newer));
    say("old luggage", format!("{:?}", old_items::luggage(newer)));
    say("qak robot", qak::message(qak::robot(newer), 7));
    say("qak map", qak::message(qak::room_map(newer), 8));
    for piece in newer.luggage.iter() {
        say(&format!("old luggage {}", piece.id.0), old_items::luggage_state(piece));
        say(&format!("qak luggage {}", piece.id.0), qak::message(qak::luggage(piece), 9));
    }
}

fn shape(book: &mut Book, title: &str, shape: &impl Serialize) {
    book.show("json", title, &serde_json::to_vec(shape).expect("the shapes are strings, numbers, lists and maps of them"));
    book.show("cbor", title, &cbor::written(shape));
}

/// Records every entry of a journal in JSON and in words.
pub(crate) fn entries(book: &mut Book, entries: &[Entry]) {
    let mut mission = None;
    let mut kinds = BTreeSet::new();
    for (seq, entry) in (1..).zip(entries) {
        let photo = if let Fact::Luggage { photo, .. } = &entry.fact { photo.as_ref() } else { None };
        let picture =
            photo.map(|photo| Picture { digest: hex(&Sha256::digest(&photo.bytes)), media_type: photo.media_type.to_owned() });
        mission = begun(entry).or(mission);
        let line = journal::line(&journal::Line { seq: Seq(seq), mission, entry: entry.clone(), picture });
        let read = journal::read_line(line.as_bytes()).expect("what is written can be read");
        assert_eq!(journal::line(&read), line, "and is written the same again");
        if !kinds.insert(journal::kind(&entry.fact)) {
            book.fold();
        }
        book.write("journal", &format!("entry {seq}, {}", journal::kind(&entry.fact)), line.as_bytes());
        book.write("journal", &format!("entry {seq} in words"), journal_words::line(entry).as_bytes());
        book.unfold();
    }
}

fn begun(entry: &Entry) -> Option<MissionId> {
    if let Fact::MissionBegan(mission, _) = &entry.fact { Some(*mission) } else { None }
}

/// Every refusal, each with its fixed code.
pub(crate) fn refusals() -> Vec<Refused> {
    let piece = LuggageId(3);
    let refused = vec![
        Refused::Held(Hold::ALL.to_vec(), None),
        Refused::Held(vec![Hold::Store, Hold::Operator], Some("the disk is full".to_owned())),
        Refused::Outdated { sent: Epoch(3), now: Epoch(5) },
        Refused::SentBefore,
        Refused::VerdictPending(piece),
        Refused::Driving,
        Refused::NotStopped,
        Refused::IntoObstacle(Cell::new(2, -1)),
        Refused::NotCapable,
        Refused::Moving,
        Refused::Unrecorded,
        Refused::BombUnfetched(piece),
        Refused::UnknownLuggage(piece),
        Refused::NothingPending,
        Refused::Decided { luggage: piece, verdict: Verdict::Safe },
        Refused::Decided { luggage: piece, verdict: Verdict::Danger },
        Refused::NotABomb(piece),
        Refused::OpenPoints {
            mission: MissionId(7),
            open: Box::new(OpenPoints { pending: 1, unvisited: 12, ..OpenPoints::default() }),
        },
        Refused::OtherMission(MissionId(7)),
        Refused::ExerciseOver,
        Refused::NothingSearched,
        Refused::AreaTooLarge(4096),
        Refused::UnknownArea(Arc::from("gate 3")),
        Refused::AreaClosed(Arc::from("gate 1")),
        Refused::NoPhoto(piece),
        Refused::HotUnanswered(piece),
        Refused::NotInspected(piece),
        Refused::PhotoUnderWay,
        Refused::UnknownAlarm(AlarmId(4)),
        Refused::NoRetrievalRobot,
        Refused::FetcherUnreached(RobotId::new("srm1").expect("a sound name")),
        Refused::FetcherAbroad(RobotId::new("srm2").expect("a sound name")),
        // A refusal in the words of an earlier version.
        Refused::InWords(Refusal {
            code: "faultStands",
            kind: RefusalKind::Conflict,
            words: "the fault still stands: the robot's wheels slip".to_owned(),
        }),
        Refused::StoreDown,
        Refused::NotKept,
        Refused::OtherContent(CommandId::new("c-1").expect("a sound name")),
        Refused::UnknownSensor(Arc::from("cellar")),
        Refused::NotAllowed("the viewer lobby may look and stop, no more".to_owned()),
        Refused::InWords(Refusal { code: "tooMany", kind: RefusalKind::Unavailable, words: "too many at once".to_owned() }),
    ];
    let phases = PhaseName::ALL.into_iter().map(Refused::NotInPhase);
    let all: Vec<Refused> = refused.into_iter().chain(phases).collect();
    for (code, _) in CODES {
        assert!(all.iter().any(|refused| refused.code() == code), "{code}");
    }
    all
}

/// Records the problem details of every refusal in JSON and CBOR.
pub(crate) fn problems(book: &mut Book) {
    for refused in refusals() {
        let (kind, detail) = (ProblemKind::from(refused.kind()), refused.to_string());
        let title = format!("{} {}", refused.code(), kind.status().0);
        let problem = ProblemJson { title: "Some title", ..ProblemJson::new((refused.code(), kind), &detail) };
        book.write("problems", &title, &serde_json::to_vec(&problem).expect("a problem is strings and numbers"));
        book.write("problems", &format!("{title} in CBOR"), &concise_problem::written(&problem, Code::CONFLICT.0));
    }
}
