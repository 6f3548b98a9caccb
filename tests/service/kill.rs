//! Safety R1, V3, A6: the real program is killed with SIGKILL at random moments, many times, on one folder. Nothing
//! that was acknowledged is missing, nothing is stored twice, and nothing moves before a START.
//! `HALLSWEEP_KILLS=1000` makes a longer run.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use hallsweep_core::rng::RandomStream;
use serde_json::{Value, json};

use crate::program::{Answer, Deadline, PATIENCE, Program, hallsweep};

/// Number of kills, unless `HALLSWEEP_KILLS` says otherwise.
const KILLS: u64 = 200;

/// Choice of `act` that lets the mission progress: START, and verdicts.
const SEARCH: u64 = 0;

/// Number of the latest pieces that are checked after each start.
const LOOKED_UP: usize = 12;

#[test]
fn killed_at_any_moment_it_has_everything_that_was_acknowledged_and_nothing_twice() {
    let kills = std::env::var("HALLSWEEP_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(KILLS);
    let folder = Folder::new("kill");
    let mut ledger = Ledger::default();
    for life in 0..kills {
        let mut dice = RandomStream::new(life, "kill");
        if dice.below(12) == 0 {
            die_unborn(&folder, &mut dice);
            continue;
        }
        let program = serve(&folder, &mut dice);
        ledger.check(&program, life);
        match dice.below(2) {
            0 => ledger.work_until_killed(&program, &mut dice, life),
            _ => ledger.work_and_rest(&program, &mut dice, life),
        }
        drop(program);
        if (life + 1) % 100 == 0 {
            eprintln!("{} kills, {}", life + 1, ledger.in_words());
        }
    }
    eprintln!("{kills} kills, {}", ledger.in_words());
    assert!(ledger.refused.len() as u64 > kills / 4, "hardly anything was refused");
    assert!(ledger.keys.len() as u64 > kills && ledger.verdicts.len() as u64 > kills / 20, "hardly anything was tried");
    ledger.audit(&folder);
    bring_to_the_end(&serve(&folder, &mut RandomStream::new(0, "end")));
}

/// Folder that is removed when the test ends.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("hallsweep-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder for the test");
        Folder(path)
    }

    pub(crate) fn path(&self) -> &std::path::Path {
        &self.0
    }

    pub(crate) fn text(&self) -> &str {
        self.0.to_str().expect("a path of plain letters")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Everything that was acknowledged to the operator, and must still be there after a restart.
#[derive(Default)]
struct Ledger {
    verdicts: BTreeMap<u64, String>,
    luggage: BTreeMap<u64, Value>,
    photos: BTreeMap<u64, Vec<u8>>,
    /// Ids of accepted commands, each with its command.
    keys: BTreeMap<String, String>,
    /// Ids of refused commands, each with its command.
    refused: BTreeMap<String, String>,
    /// Number of accepted commands.
    accepted: Arc<AtomicU64>,
    mission: u64,
    /// State at the kill, if the program was at rest by then.
    rest: Option<Value>,
}

impl Ledger {
    fn in_words(&self) -> String {
        let (keys, refused) = (self.keys.len(), self.refused.len());
        let (luggage, verdicts) = (self.luggage.len(), self.verdicts.len());
        format!(
            "{keys} commands acknowledged, {refused} refused, {luggage} pieces seen, {verdicts} verdicts acknowledged, mission {}",
            self.mission
        )
    }

    /// Sends random commands until the program is gone. The kill comes at a random moment after a random number of
    /// accepted commands, however long those take.
    fn work_until_killed(&mut self, program: &Program, dice: &mut RandomStream, life: u64) {
        let (least, moment) = (dice.below(6), Duration::from_millis(dice.below(60)));
        let kill = program.killer();
        let accepted = Arc::clone(&self.accepted);
        let enough = accepted.load(Ordering::Relaxed) + least;
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let deadline = Deadline::within(PATIENCE);
                while accepted.load(Ordering::Relaxed) < enough && !deadline.has_passed() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                std::thread::sleep(moment);
                kill();
            });
            for n in 0.. {
                if self.work(program, dice, &format!("{life}-{n}")).is_none() {
                    break;
                }
            }
        });
        self.rest = None;
    }

    /// Sends random commands, then STOP, and records the state when it no longer changes. In every third life the
    /// commands continue until a verdict is acknowledged.
    fn work_and_rest(&mut self, program: &Program, dice: &mut RandomStream, life: u64) {
        for n in 0..dice.below(12) {
            self.work(program, dice, &format!("{life}-{n}")).expect("the program is running");
        }
        let (known, deadline) = (self.verdicts.len(), Deadline::within(PATIENCE));
        for n in (0..).take_while(|_| life.is_multiple_of(3)) {
            if self.verdicts.len() > known || deadline.has_passed() {
                break;
            }
            self.act(program, dice, &format!("{life}-more-{n}"), SEARCH).expect("the program is running");
        }
        program.command("stop").accepted();
        let mut state = program.until("it rests", |state| state["robot"]["state"] == "stopped");
        loop {
            std::thread::sleep(Duration::from_millis(20));
            let again = program.json("state");
            if again == state {
                break;
            }
            state = again;
        }
        // A STOP is answered before the journal stores it. The next command is answered when both are stored.
        program.put("/api/v1/temperature", "{\"status\":\"ok\"}").accepted();
        let state = program.json("state");
        self.look(&state);
        self.rest = Some(state);
    }

    /// Does one random action of an operator. Returns `None` if the program is gone.
    fn work(&mut self, program: &Program, dice: &mut RandomStream, key: &str) -> Option<()> {
        let what = dice.below(12);
        self.act(program, dice, key, what)
    }

    fn act(&mut self, program: &Program, dice: &mut RandomStream, key: &str, what: u64) -> Option<()> {
        let state = program.try_ask("GET", "/api/v1/state", "", "")?.json();
        self.look(&state);
        let pending = state["luggage"].as_array()?.iter().find(|piece| piece["verdict"] == "pending").cloned();
        let at_rest = ["idle", "atHome", "explored"].iter().any(|phase| state["mission"]["phase"] == *phase);
        let held = at_rest || state["mission"]["holds"] != json!([]);
        match (pending, what) {
            (None, 0..=7) if !held => std::thread::sleep(Duration::from_millis(2)),
            (Some(piece), 0..=6) => self.decide(program, dice, key, piece["id"].as_u64()?)?,
            (Some(piece), 7) => self.fetch_photo(program, &piece)?,
            (_, 8) => drop(program.try_ask("POST", "/api/v1/commands/stop", key, "")?),
            (_, 9) => self.command(program, "POST", "/api/v1/commands/backHome", key, "")?,
            (_, 10) => self.command(program, "PUT", "/api/v1/temperature", key, "{\"status\":\"ok\"}")?,
            (_, 11) => self.command(program, "POST", "/api/v1/alarms/1/acknowledge", key, "")?,
            _ => self.command(program, "POST", "/api/v1/commands/start", key, "")?,
        }
        if state["mission"]["phase"] == "bombLocated" {
            for alarm in state["alarms"].as_array()?.iter().filter(|alarm| alarm["acknowledged"].is_null()) {
                let path = format!("/api/v1/alarms/{}/acknowledge", alarm["id"]);
                self.command(program, "POST", &path, &format!("{key}-seen-{}", alarm["id"]), "")?;
            }
            self.command(program, "POST", "/api/v1/commands/reset", &format!("{key}-reset"), "")?;
        }
        Some(())
    }

    fn command(&mut self, program: &Program, method: &str, path: &str, key: &str, body: &str) -> Option<()> {
        let answer = program.try_ask(method, path, key, body)?;
        self.note(&answer, key, path);
        Some(())
    }

    /// Records the answer to a command.
    fn note(&mut self, answer: &Answer, key: &str, what: &str) {
        if answer.status == 200 {
            self.keys.insert(key.to_owned(), what.to_owned());
            self.accepted.fetch_add(1, Ordering::Relaxed);
        } else if (400..500).contains(&answer.status) {
            self.refused.insert(key.to_owned(), what.to_owned());
        }
    }

    fn decide(&mut self, program: &Program, dice: &mut RandomStream, key: &str, id: u64) -> Option<()> {
        let verdict = if dice.below(12) == 0 { "danger" } else { "safe" };
        let body = json!({ "verdict": verdict }).to_string();
        let answer = program.try_ask("POST", &format!("/api/v1/luggage/{id}/verdict"), key, &body)?;
        if answer.status == 200 {
            self.verdicts.insert(id, verdict.to_owned());
        }
        self.note(&answer, key, &format!("verdict {id}"));
        Some(())
    }

    fn fetch_photo(&mut self, program: &Program, piece: &Value) -> Option<()> {
        if let Some(url) = piece["photo"]["url"].as_str() {
            let photo = program.try_ask("GET", url, "", "")?;
            if photo.status == 200 {
                self.photos.insert(piece["id"].as_u64()?, photo.body);
            }
        }
        Some(())
    }

    fn look(&mut self, state: &Value) {
        self.mission = self.mission.max(state["mission"]["id"].as_u64().expect("a mission has a number"));
        for piece in state["luggage"].as_array().expect("luggage is a list") {
            let id = piece["id"].as_u64().expect("a piece has a number");
            if let Some(verdict) = piece["verdict"].as_str().filter(|verdict| *verdict != "pending") {
                self.verdicts.insert(id, verdict.to_owned());
            }
            self.luggage.insert(id, piece.clone());
        }
    }

    fn check(&mut self, program: &Program, life: u64) {
        let state = program.json("state");
        let holds = state["mission"]["holds"].as_array().expect("holds are a list");
        assert!(life == 0 || holds.contains(&"restart".into()) || self.keys.is_empty(), "life {life}: {holds:?}");
        assert!(state["mission"]["id"].as_u64() >= Some(self.mission), "life {life}: mission {} is gone", self.mission);
        for id in self.luggage.keys().rev().take(LOOKED_UP) {
            self.check_piece(program, *id, life);
        }
        let mut cells: Vec<String> =
            state["luggage"].as_array().expect("a list").iter().map(|piece| piece["cell"].to_string()).collect();
        let pieces = cells.len();
        cells.sort();
        cells.dedup();
        assert_eq!(cells.len(), pieces, "life {life}: a piece is on record twice: {state:#}");
        if let Some(rest) = self.rest.take() {
            compare(&rest, &program.json("state"), life);
        }
        let later = program.json("state");
        assert_eq!(later["robot"]["position"], state["robot"]["position"], "life {life}: it moved before a START");
        assert!(
            later["robot"]["state"] == "stopped"
                || later["robot"]["state"].as_str().is_some_and(|doing| doing.ends_with("Photo"))
        );
    }

    fn check_piece(&self, program: &Program, id: u64, life: u64) {
        let found = program.json(&format!("luggage/{id}"));
        let seen = &self.luggage[&id];
        for field in ["cell", "position", "heading"] {
            assert_eq!(found[field], seen[field], "life {life}: luggage #{id}");
        }
        if let Some(verdict) = self.verdicts.get(&id) {
            assert_eq!(found["verdict"], verdict.as_str(), "life {life}: the verdict on #{id}");
        }
        if let Some(photo) = self.photos.get(&id) {
            let kept = program.read(&format!("/api/v1/luggage/{id}/photo"), &[]);
            assert!(kept.status == 200 && kept.body == *photo, "life {life}: the photo of #{id} is another");
        }
    }

    /// Checks the journal: no gap, every acknowledged command exactly once with its answer, and one verdict per
    /// piece.
    fn audit(&self, folder: &Folder) {
        let check = hallsweep(&["journal", "check", "--data", folder.text()]).output().expect("it runs");
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
        let export = hallsweep(&["journal", "export", "--data", folder.text()]).output().expect("it runs");
        let lines: Vec<Value> = String::from_utf8(export.stdout)
            .expect("JSON is text")
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect();
        assert!(lines.iter().zip(1..).all(|(line, seq)| line["seq"] == seq), "the journal has gaps");
        for key in self.keys.keys() {
            let found = lines.iter().filter(|line| line["id"] == key.as_str()).count();
            assert_eq!(found, 1, "the command {key} ({}) is in the journal {found} times", self.keys[key]);
        }
        for (key, what) in &self.refused {
            let found: Vec<&Value> = lines.iter().filter(|line| line["id"] == key.as_str()).collect();
            let is_refused = found.len() == 1 && found[0]["refused"]["code"].is_string();
            assert!(is_refused, "the command {key} ({what}) was refused: {found:?}");
        }
        for (id, verdict) in &self.verdicts {
            let found: Vec<&Value> = lines.iter().filter(|line| line["kind"] == "verdict" && line["luggage"] == *id).collect();
            assert!(found.len() == 1 && found[0]["verdict"] == verdict.as_str(), "luggage #{id}: {found:?}");
        }
    }
}

/// Safety R1: the state at rest is the same after the start.
fn compare(before: &Value, after: &Value, life: u64) {
    for pointer in ["/map/rows", "/map/origin", "/luggage", "/robot/position", "/robot/heading", "/robot/led", "/alarms"] {
        assert_eq!(before.pointer(pointer), after.pointer(pointer), "life {life}: {pointer}");
    }
    for field in ["id", "phase", "interrupted", "goal", "strategy", "epoch"] {
        assert_eq!(before["mission"][field], after["mission"][field], "life {life}: mission.{field}");
    }
    let holds = |state: &Value| -> Vec<Value> {
        let raised = |hold: &&Value| **hold != "restart" && **hold != "awaitingStart";
        state["mission"]["holds"].as_array().expect("a list").iter().filter(raised).cloned().collect()
    };
    assert_eq!(holds(before), holds(after), "life {life}");
}

fn serve(folder: &Folder, dice: &mut RandomStream) -> Program {
    let speed = ["max", "30", "200"][dice.below(3) as usize];
    Program::with(&["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", speed, "--data", folder.text()])
}

/// Starts the program and kills it during its start.
fn die_unborn(folder: &Folder, dice: &mut RandomStream) {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--data", folder.text()];
    let mut child = hallsweep(&arguments).stdout(std::process::Stdio::null()).spawn().expect("the program starts");
    std::thread::sleep(Duration::from_millis(dice.below(60)));
    child.kill().expect("the child is ours");
    child.wait().expect("the child is ours");
}

/// Fails unless the mission can still be completed.
fn bring_to_the_end(program: &Program) {
    let over = |state: &Value| ["explored", "bombLocated"].iter().any(|phase| state["mission"]["phase"] == *phase);
    loop {
        let state = program.until("the end, or a question", |state| {
            over(state)
                || state["luggage"].as_array().is_some_and(|pieces| pieces.iter().any(|piece| piece["verdict"] == "pending"))
                || state["mission"]["holds"] != json!([])
                || ["idle", "atHome"].iter().any(|phase| state["mission"]["phase"] == *phase)
        });
        if over(&state) {
            return;
        }
        let pending =
            state["luggage"].as_array().and_then(|pieces| pieces.iter().find(|piece| piece["verdict"] == "pending").cloned());
        match pending {
            Some(piece) => drop(program.verdict(piece["id"].as_u64().expect("a number"), "safe")),
            None => drop(program.command("start")),
        }
    }
}
