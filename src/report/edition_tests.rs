//! Tests that the reports of an edition never change. `words.txt` has their words and templates, `pages.txt` the
//! digests of their pages. The pages are made of entries of every kind (`every_kind.jsonl`) and of a large hall.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::EDITION;
use super::tests::{MISSION, Mission, of_every_kind};
use crate::api::journal::{self, Line};
use crate::phrases::Language;
use crate::runtime::archive::hex;
use hallsweep_core::command::{Note, Verdict};
use hallsweep_core::settings::Rules;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{Conditions, Venue};
use hallsweep_core::units::{Cell, Celsius, LuggageId, Pose, Seq, WallTime};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::luggage::{Luggage, PhotoState};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn phrases(language: &str, file: &str) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(root().join(format!("src/phrases/{language}/{file}.ftl"))).unwrap();
    let mut phrases = BTreeMap::new();
    let mut last = String::new();
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()) {
        match line.split_once(" =").filter(|_| !line.starts_with(' ')) {
            Some((id, said)) => {
                id.clone_into(&mut last);
                phrases.insert(last.clone(), said.trim().to_owned());
            }
            None => *phrases.get_mut(&last).expect("it goes on") += &format!("⏎{}", line.trim()),
        }
    }
    phrases
}

/// A report may use all phrases of these files.
const WHOLE: [&str; 4] = ["said", "log", "report", "coverage"];

/// Phrases of other files that a report may use. Each item is an id, or a prefix of ids that ends with a dash.
const PARTS: [&str; 16] = [
    "hall",
    "temperature",
    "place",
    "month-",
    "list",
    "missions-searched",
    "missions-searched-of",
    "missions-bomb-",
    "missions-under-way",
    "missions-archived-while",
    "missions-luggage",
    "missions-no-luggage",
    "secured-one",
    "goal-at",
    "interrupted",
    "problem-",
];

/// Words of this edition's reports: each phrase in both languages, and the digest of each template.
pub(super) fn words() -> Vec<String> {
    let mut words = Vec::new();
    for language in ["en", "it"] {
        for file in ["common", "console", "coverage", "log", "missions", "photo", "report", "said", "problems", "simulator"] {
            for (id, said) in phrases(language, file) {
                if WHOLE.contains(&file) || PARTS.iter().any(|part| id == *part || (part.ends_with('-') && id.starts_with(part)))
                {
                    words.push(format!("{language} {id} = {said}"));
                }
            }
        }
    }
    let mut pages: Vec<PathBuf> =
        std::fs::read_dir(root().join("templates/report")).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.sort();
    for page in pages {
        let digest = hex(&Sha256::digest(std::fs::read(&page).unwrap()));
        words.push(format!("{} sha256 {digest}", page.strip_prefix(root()).unwrap().display()));
    }
    words
}

fn kept(name: &str) -> String {
    std::fs::read_to_string(root().join("src/report").join(name)).unwrap_or_default()
}

/// Fails if a remembered text has changed. A new text also fails, unless `HALLSWEEP_RENEW=1` is set; then it is added
/// to the file.
fn check_kept(name: &str, now: &[String]) {
    let kept = kept(name);
    let missing: Vec<&str> = kept.lines().filter(|line| !now.iter().any(|now| now == line)).collect();
    assert!(
        missing.is_empty(),
        "reports say this, and could not be confirmed any more: make edition {} beside it\n{}",
        EDITION + 1,
        missing.join("\n")
    );
    let new: Vec<&str> = now.iter().map(String::as_str).filter(|now| !kept.lines().any(|line| line == *now)).collect();
    if is_renewed() {
        let all: String = kept.lines().chain(new).fold(String::new(), |all, line| all + line + "\n");
        std::fs::write(root().join("src/report").join(name), all).unwrap();
    } else {
        assert_eq!(new, Vec::<&str>::new(), "HALLSWEEP_RENEW=1 adds them to src/report/{name}");
    }
}

/// Whether `HALLSWEEP_RENEW=1` is set, which adds new texts to the files. It never changes a remembered text: such a
/// change needs a further edition.
fn is_renewed() -> bool {
    std::env::var("HALLSWEEP_RENEW").is_ok_and(|value| value == "1")
}

#[test]
fn what_reports_of_this_edition_say_is_never_said_otherwise() {
    check_kept("words.txt", &words());
}

/// Maximum number of remembered entries of each kind.
const OF_EACH_KIND: usize = 4;

/// Maximum length of a remembered entry, in bytes.
const LONGEST: usize = 1500;

/// Entries of every kind as lines of a journal: the remembered entries, and random entries for each new kind.
fn lines_of_every_kind() -> Vec<String> {
    let mut lines: Vec<String> = kept("every_kind.jsonl").lines().map(str::to_owned).collect();
    let known: BTreeSet<&str> = lines.iter().map(|line| journal::kind(&read(line).fact)).collect();
    let mut new: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for entry in of_every_kind().entries {
        let of_kind = new.entry(journal::kind(&entry.fact)).or_default();
        let line = journal::line(&Line { seq: Seq(1), mission: Some(MISSION), entry, picture: None });
        if of_kind.len() < OF_EACH_KIND && line.len() <= LONGEST {
            of_kind.push(line);
        }
    }
    new.retain(|kind, _| !known.contains(kind));
    assert!(new.values().all(|lines| !lines.is_empty()), "each kind has a short one: {:?}", new.keys());
    lines.extend(new.into_values().flatten());
    lines
}

fn read(line: &str) -> Entry {
    journal::read_line(line.as_bytes()).unwrap().entry
}

/// A hall with thousands of cells, and with pieces of every verdict.
fn large_hall() -> Vec<Entry> {
    const SIDES: (i32, i32) = (140, 90);
    let at = |step: i64, fact| Entry { wall: WallTime { unix_ms: 1_770_109_512_250 + step * 1000, offset_s: 3600 }, fact };
    let cells = (0..SIDES.1).flat_map(|y| (0..SIDES.0).map(move |x| Cell::new(x, y)));
    let marks = [Mark::Visited, Mark::Visited, Mark::Seen, Mark::Wall, Mark::Visited, Mark::NotInspected, Mark::Visited];
    let mut entries: Vec<Entry> = cells
        .filter(|cell| (cell.x * 7 + cell.y * 3) % 11 != 0)
        .map(|cell| at(0, Fact::Mark(cell, marks[(cell.x / 5 + cell.y / 3).unsigned_abs() as usize % marks.len()])))
        .collect();
    for id in 1..=60_i32 {
        let (luggage, step) = (LuggageId(u64::from(id.unsigned_abs())), i64::from(id));
        let cell = Cell::new(id * 17 % SIDES.0, id * 29 % SIDES.1);
        let photo = if id % 7 == 0 {
            PhotoState::Failed("dark".to_owned())
        } else {
            PhotoState::Taken { bytes: 3, take: 1 + luggage.0 as u32 % 3 }
        };
        let taken = at(step, Fact::Led(true)).wall;
        let record = Luggage {
            id: luggage,
            cell,
            pose: Pose::START,
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
        };
        entries.push(at(step, Fact::Mark(cell, Mark::Luggage)));
        entries.push(at(step, Fact::Luggage { record: record.into(), photo: None }));
        let verdict = if id % 5 == 0 { Verdict::Danger } else { Verdict::Safe };
        let note = (id % 10 == 0).then(|| Note::new("wires & battery")).flatten();
        if id % 3 != 0 {
            entries.push(at(step + 9, Fact::Verdict { luggage, verdict, who: "anna".into(), note, hot: Default::default() }));
        }
    }
    entries.push(at(100, Fact::Secured(LuggageId(5))));
    entries
}

/// The large hall as an exercise, of which every third piece is a test piece.
fn exercise() -> Vec<Entry> {
    let venue = Venue { name: "airport".into(), is_exercise: true, ..Venue::default() };
    let threshold = Celsius::new(25.0).expect("a believable temperature");
    let conditions = Fact::Conditions(Conditions { venue, threshold, rules: Rules::default() });
    let revealed = (1..=60).map(|id| Fact::Revealed { luggage: LuggageId(id), is_test: id % 3 == 0 });
    let wall = WallTime { unix_ms: 1_770_109_612_250, offset_s: 3600 };
    let further = std::iter::once(conditions).chain(revealed).map(|fact| Entry { wall, fact });
    large_hall().into_iter().chain(further).collect()
}

/// Digests of pages, one for each edition, language and mission. `every_kind.jsonl` grows with every new kind. Each
/// of its earlier lengths is a mission of its own, so that the older digests are still checked.
fn pages() -> Vec<String> {
    let lines = lines_of_every_kind();
    if is_renewed() {
        std::fs::write(root().join("src/report/every_kind.jsonl"), lines.join("\n") + "\n").unwrap();
    }
    let kept = kept("pages.txt");
    let lengths = kept.lines().filter_map(|line| line.split_once(" entries")?.0.rsplit(' ').next()?.parse().ok());
    let lengths: BTreeSet<usize> = lengths.filter(|length| *length <= lines.len()).chain([lines.len()]).collect();
    let every_kind = lengths.into_iter().map(|length| {
        let entries = lines.iter().take(length).map(|line| read(line)).collect();
        (format!("{length} entries of every kind"), Mission::of(entries))
    });
    let named = [("a large hall", large_hall()), ("an exercise", exercise())];
    let named = named.into_iter().map(|(name, entries)| (name.to_owned(), Mission::of(entries)));
    let missions: Vec<(String, Mission)> = every_kind.chain(named).collect();
    let page = |edition: u32, language: Language, (name, mission): &(String, Mission)| {
        let named = if edition == 1 { String::new() } else { format!("edition {edition} ") };
        let digest = hex(&Sha256::digest(mission.report_of(edition, language)));
        format!("{named}{} {name} sha256 {digest}", language.tag())
    };
    let languages = (1..=EDITION).flat_map(|edition| Language::ALL.map(|language| (edition, language)));
    languages.flat_map(|(edition, language)| missions.iter().map(move |mission| page(edition, language, mission))).collect()
}

#[test]
fn pages_of_this_edition_are_never_drawn_otherwise() {
    check_kept("pages.txt", &pages());
}
