//! A double of the servers that join the page with programs: of the first version over TCP, with all that its clients
//! must bear, and of those since 2021 over WebSocket.

use std::collections::BTreeMap;
use std::time::Duration;

use serde_json::{Value, json};

use super::page::{Command, Page, Told};

pub(crate) type Client = u64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Version {
    /// Between semicolons over TCP: one stream of events for each client address.
    First,
    /// Messages over WebSocket: a collision, with its name, in place of the end of a move.
    Year2021,
    /// The beginning of 2021: a collision without a name, and the end of each move when its time has passed, whatever
    /// has happened.
    Early2021,
    /// The version of 2022: the page reports the end of a move, of a turn at its beginning and at its end, and a halt
    /// stops a turn.
    Year2022,
    /// The version of 2023: after a collision the move runs on until its time has passed or an alarm comes, each
    /// refusal ends in ` (asynch)`, the end of a move that was cut short carries what cut it short, and a halt stops a
    /// turn.
    Year2023,
}

impl Version {
    pub(crate) const ALL: [Version; 5] =
        [Version::First, Version::Year2021, Version::Early2021, Version::Year2022, Version::Year2023];

    /// Versions that report what was met.
    pub(crate) const NAMING: [Version; 4] = [Version::First, Version::Year2021, Version::Year2022, Version::Year2023];

    fn halts_turns(self) -> bool {
        matches!(self, Version::Year2022 | Version::Year2023)
    }
}

pub(crate) struct Server {
    pub(crate) page: Option<Page>,
    pub(crate) version: Version,
    /// How long a message takes from the server to the page, and back.
    pub(crate) lag: Duration,
    /// The connection to which events go, for each client address.
    streams: BTreeMap<String, Client>,
    /// All connections of the later versions, each of which receives everything.
    listeners: Vec<Client>,
    clients: u64,
    pub(crate) is_dead: bool,
    /// The system accepts connections and bytes, and the server does nothing with them.
    pub(crate) is_stalled: bool,
    /// The move that it believes to be under way.
    pub(crate) running: Option<&'static str>,
    /// What has cut that move short: the server of 2023 remembers it until the page reports its end.
    cut_by: Option<&'static str>,
    /// It believes for ever that a move is under way, whatever ends.
    pub(crate) is_stuck: bool,
    /// It sends nothing any more.
    pub(crate) is_mute: bool,
    pub(crate) heard: Vec<(Duration, String)>,
    to_page: Vec<(Duration, Command)>,
    from_page: Vec<(Duration, Told)>,
    timers: Vec<(Duration, &'static str)>,
    target: bool,
    pub(crate) sent: Vec<(Client, Vec<u8>)>,
    now: Duration,
}

impl Server {
    pub(crate) fn new(version: Version, mut page: Option<Page>) -> Server {
        if let Some(page) = &mut page {
            page.turns_halt = version.halts_turns();
        }
        Server {
            page,
            version,
            lag: Duration::ZERO,
            streams: BTreeMap::new(),
            listeners: Vec::new(),
            clients: 0,
            is_dead: false,
            is_stalled: false,
            running: None,
            cut_by: None,
            is_stuck: false,
            is_mute: false,
            heard: Vec::new(),
            to_page: Vec::new(),
            from_page: Vec::new(),
            timers: Vec::new(),
            target: false,
            sent: Vec::new(),
            now: Duration::ZERO,
        }
    }

    /// Connects from this address; `None` when nobody listens.
    pub(crate) fn connect(&mut self, address: &str) -> Option<Client> {
        if self.is_dead {
            return None;
        }
        self.clients += 1;
        if self.version == Version::First {
            self.streams.insert(address.to_owned(), self.clients);
            if self.page.is_some() && !self.is_stalled {
                self.tell(&json!({"type": "webpage-ready", "arg": {}}));
            }
        } else {
            self.listeners.push(self.clients);
        }
        Some(self.clients)
    }

    /// A connection has ended: the latest client of that address receives nothing any more.
    pub(crate) fn end(&mut self, address: &str, client: Client) {
        if self.version == Version::First {
            self.streams.remove(address);
        }
        self.listeners.retain(|listener| *listener != client);
    }

    /// Somebody opens the page, anew or for the first time.
    pub(crate) fn open(&mut self, mut page: Page) {
        page.turns_halt = self.version.halts_turns();
        self.page = Some(page);
        if self.version == Version::First {
            self.tell(&json!({"type": "webpage-ready", "arg": {}}));
        }
    }

    pub(crate) fn close(&mut self) {
        self.page = None;
    }

    /// It is started again; the page is still there and finds it by itself.
    pub(crate) fn restart(&mut self) {
        self.is_dead = false;
        if self.page.is_some() && self.version == Version::First {
            self.tell(&json!({"type": "webpage-ready", "arg": {}}));
        }
    }

    /// Takes one segment, or one message; input that it cannot bear ends it.
    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        let said = String::from_utf8_lossy(bytes).into_owned();
        if self.version != Version::First {
            return self.receive_message(&said);
        }
        for message in said.split(';').map(str::trim).filter(|message| !message.is_empty()) {
            self.heard.push((self.now, message.to_owned()));
            let Some(command) = serde_json::from_str(message).ok().and_then(|value: Value| typed(&value)) else {
                return self.die();
            };
            self.to_page.push((self.now + self.lag, command));
        }
    }

    fn receive_message(&mut self, said: &str) {
        self.heard.push((self.now, said.to_owned()));
        let Ok(value) = serde_json::from_str::<Value>(said) else { return self.die() };
        let (Some(name), time) = (value["robotmove"].as_str(), value["time"].as_i64().unwrap_or(0)) else { return };
        let Some((name, command)) = command(name, time) else { return };
        match (self.running, &command) {
            (Some(_), _) if self.is_stuck && command != Command::Alarm => {
                return self.refuse(name);
            }
            (Some(_), Command::Alarm) if self.is_stuck => {}
            (Some(_), Command::Alarm) if self.version == Version::Year2023 => {
                self.cut_by = self.cut_by.or(Some("interrupted"));
            }
            (Some(running), Command::Alarm) => {
                self.running = None;
                self.tell(&json!({"endmove": false, "move": format!("{running}_halted")}));
            }
            (Some(_), _) if self.version != Version::Early2021 => {
                return self.refuse(name);
            }
            (Some(_) | None, _) => {}
        }
        if command != Command::Alarm {
            self.running = Some(name);
            if self.version == Version::Early2021 {
                self.timers.push((self.now + Duration::from_millis(time.unsigned_abs()), name));
            }
        }
        if self.version == Version::Year2022 && name.starts_with("turn") {
            self.tell(&json!({"endmove": true}));
        }
        self.to_page.push((self.now + self.lag, command));
    }

    fn refuse(&mut self, name: &str) {
        let refusal = match self.version {
            Version::Year2023 => json!({"endmove": "false", "move": format!("{name}_notallowed (asynch)")}),
            Version::First | Version::Year2021 | Version::Early2021 | Version::Year2022 => {
                json!({"endmove": false, "move": format!("{name}_notallowed")})
            }
        };
        self.tell(&refusal);
    }

    fn die(&mut self) {
        self.is_dead = true;
        self.streams.clear();
        self.listeners.clear();
        self.running = None;
    }

    pub(crate) fn next(&self) -> Option<Duration> {
        let page = self.page.as_ref().and_then(Page::next);
        let to = self.to_page.iter().map(|(at, _)| *at).min();
        let from = self.from_page.iter().map(|(at, _)| *at).min();
        let timers = self.timers.iter().map(|(at, _)| *at).min();
        [page, to, from, timers].into_iter().flatten().min()
    }

    pub(crate) fn pass_to(&mut self, now: Duration) {
        while let Some(at) = self.next().filter(|at| *at <= now) {
            self.now = at.max(self.now);
            let (due, later) = std::mem::take(&mut self.to_page).into_iter().partition(|(at, _)| *at <= self.now);
            self.to_page = later;
            let due: Vec<(Duration, Command)> = due;
            if let Some(page) = &mut self.page {
                page.pass_to(self.now);
                for (_, command) in &due {
                    page.command(command, self.now);
                }
                self.from_page.extend(page.told.drain(..).map(|(at, told)| (at + self.lag, told)));
            }
            let (due, later) = std::mem::take(&mut self.from_page).into_iter().partition(|(at, _)| *at <= self.now);
            self.from_page = later;
            let due: Vec<(Duration, Told)> = due;
            for (_, told) in due {
                self.hear(told);
            }
            let (due, later) = std::mem::take(&mut self.timers).into_iter().partition(|(at, _)| *at <= self.now);
            self.timers = later;
            let due: Vec<(Duration, &'static str)> = due;
            for (_, name) in due {
                self.running = self.running.filter(|_| self.is_stuck);
                let ok = !std::mem::take(&mut self.target);
                self.tell(&json!({"endmove": ok, "move": name}));
            }
        }
        self.now = now;
    }

    fn hear(&mut self, told: Told) {
        match (self.version, told) {
            (Version::Year2023, Told::Collision(name)) => {
                self.cut_by = Some("collision").filter(|_| self.running.is_some());
                self.tell(&json!({"collision": self.running, "target": name}));
            }
            // It reports the end of whatever is under way, though the page speaks of an earlier move.
            (Version::Year2023, ended @ (Told::EndOfMove(_) | Told::Halted)) => {
                let Some(running) = self.running else { return };
                match self.cut_by {
                    None => self.tell(&json!({"endmove": true, "move": running})),
                    Some(by) => self.tell(&json!({"endmove": "false", "move": format!("{running}-{by}")})),
                }
                if !self.is_stuck && (ended == Told::Halted || ended == Told::EndOfMove(running)) {
                    (self.running, self.cut_by) = (None, None);
                }
            }
            (_, Told::Halted) => {}
            (_, Told::EndOfMove(_)) if self.is_stuck => {}
            (Version::First, Told::Collision(name)) => self.tell(&json!({"type": "collision", "arg": {"objectName": name}})),
            (Version::First | Version::Early2021, Told::EndOfMove(_)) => {}
            (Version::Early2021, Told::Collision(_)) => {
                self.target = true;
                self.tell(&json!({"collision": true, "move": "unknown"}));
            }
            (Version::Year2021 | Version::Year2022, Told::Collision(name)) => {
                let running = self.running.take_if(|_| !self.is_stuck).unwrap_or("unknown");
                self.tell(&json!({"collision": running, "target": name}));
            }
            (Version::Year2021, Told::EndOfMove(name)) => {
                if self.running.take_if(|running| *running == name).is_some() {
                    self.tell(&json!({"endmove": true, "move": name}));
                }
            }
            (Version::Year2022, Told::EndOfMove(_)) => {
                self.running = None;
                self.tell(&json!({"endmove": true}));
            }
        }
    }

    fn tell(&mut self, message: &Value) {
        if self.is_mute {
            return;
        }
        if self.version == Version::First {
            let bytes = format!(";{message};\n").into_bytes();
            self.sent.extend(self.streams.values().map(|client| (*client, bytes.clone())));
        } else {
            let bytes = message.to_string().into_bytes();
            self.sent.extend(self.listeners.iter().map(|client| (*client, bytes.clone())));
        }
    }
}

fn typed(value: &Value) -> Option<Command> {
    let name = value["type"].as_str()?;
    command(name, value["arg"].as_i64().unwrap_or(0)).map(|(_, command)| command)
}

fn command(name: &str, ms: i64) -> Option<(&'static str, Command)> {
    Some(match name {
        "moveForward" => ("moveForward", Command::Forward(ms)),
        "moveBackward" => ("moveBackward", Command::Backward(ms)),
        "turnLeft" => ("turnLeft", Command::Left(ms.unsigned_abs())),
        "turnRight" => ("turnRight", Command::Right(ms.unsigned_abs())),
        "alarm" => ("alarm", Command::Alarm),
        _ => return None,
    })
}
