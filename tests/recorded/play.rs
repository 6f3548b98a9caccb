//! Missions that are played at all doors at once. An operator brings them to their end; between, the seed draws
//! commands from the table of all commands. After each event, everything that a door shows is recorded.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use super::book::Book;
use super::coap::{self, Coap};
use super::doors::{
    Access, Camera, CoapRequest, Format, Hall, Hold, Key, Keyring, Keys, Method, OPERATOR, PhaseName, RandomStream, Role,
    SimSettings, Snapshot, Taken, Token, Truth, cbor,
};
use super::http::Http;
use super::mqtt::{self, Mqtt};
use super::table::{Form, filled, forms};
use super::test_app::TestApp;
use super::wire;

/// Description of one play.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Play {
    pub(crate) hall: &'static str,
    pub(crate) seed: u64,
    /// Number of actions and waits.
    pub(crate) steps: usize,
    /// One in this many steps is a command from the table; 0 means none.
    pub(crate) one_in: u64,
    /// Whether all commands of the table are given, at the beginning and again at the first piece.
    pub(crate) with_table: bool,
    pub(crate) camera: Camera,
}

/// A mission and all doors to it.
pub(crate) struct Player {
    pub(crate) app: TestApp,
    http: Http,
    coap: Coap,
    locked: Coap,
    mqtt: Mqtt,
    dice: RandomStream,
    seen: Option<Arc<Snapshot>>,
    forms: Vec<Form>,
    /// Number of acceptances and of refusals of each command.
    outcomes: BTreeMap<String, [usize; 2]>,
}

/// Plays a mission and records it.
pub(crate) async fn play(book: &mut Book, of: Play) -> BTreeMap<String, [usize; 2]> {
    book.forget();
    let hall = Arc::new(Hall::named_or_file(of.hall).expect("the hall comes with the program"));
    let noisy = of.seed.is_multiple_of(2);
    let (unknown_rate, photo_failure_rate) = if noisy { (0.1, 0.3) } else { (0.0, 0.0) };
    let sim = SimSettings { unknown_rate, photo_failure_rate, ..SimSettings::new(of.seed, of.camera) };
    let app = TestApp::new(&hall, sim, of.seed % 3 == 2);
    let mut player = Player::new(app, RandomStream::new(of.seed, "recorder"));
    book.place = format!("{} {} begins", of.hall, of.seed);
    player.run(book, of).await;
    let inside = player.app.inside();
    wire::entries(book, &inside.run.journal);
    drop(inside);
    player.outcomes
}

/// Records what does not depend on a mission: unknown paths, keys, and every refusal at every door.
pub(crate) async fn at_the_doors(book: &mut Book) {
    book.place = "at the doors".to_owned();
    let hall = Arc::new(Hall::named_or_file("seed").expect("the hall comes with the program"));
    let app = TestApp::new(&hall, SimSettings::new(1, Camera::Stub), false);
    let http = Http::new(&app, Access::Open);
    http.look_round(book).await;
    Coap::new(&app, true).look_round(book).await;
    keys(book, &app).await;
    repeats(book).await;
    wire::problems(book);
    let (coap, mut mqtt) = (Coap::new(&app, true), Mqtt::new(&app, true));
    for refused in wire::refusals() {
        let code = refused.code();
        book.place = format!("refused {code}");
        book.fold();
        app.inside().refuse = Some(refused);
        let answered = http.ask("POST", "/api/v1/commands/start", &[], "").await;
        book.write("problems", &format!("HTTP {code}"), &answered.text);
        for accept in [None, Some(Format::TEXT), Some(Format::CBOR), Some(Format::PROBLEM)] {
            let request = CoapRequest { accept, ..coap::request(Method::Post, "/commands/start", None, "") };
            let (_, said) = coap.ask(&request).await;
            let accept = accept.map_or("any format".to_owned(), |format| format.to_string());
            book.write("problems", &format!("CoAP {code} · {accept}"), said.as_bytes());
        }
        tokio::time::sleep(Duration::from_secs(2)).await;
        let message = "msg(luggageSafe,event,js,none,luggageSafe,1)";
        for (topic, payload) in [(format!("{}/command/start", mqtt::BASE), "{}"), (format!("{}/events", mqtt::OLD), message)] {
            let (_, said) = mqtt.say(&topic, payload.as_bytes(), &mqtt::here()).await;
            book.write("problems", &format!("MQTT {code} · {topic}"), said.join("\n").as_bytes());
        }
        book.unfold();
    }
}

/// Gives a command with an idempotency key, repeats it, and gives another command with the same key.
async fn repeats(book: &mut Book) {
    let hall = Arc::new(Hall::named_or_file("seed").expect("the hall comes with the program"));
    let mut player = Player::new(TestApp::new(&hall, SimSettings::new(1, Camera::Stub), false), RandomStream::new(1, "repeats"));
    for path in ["/api/v1/commands/start", "/api/v1/commands/start", "/api/v1/commands/reset"] {
        for id in ["h-1", "\"h-1\"", "a b", ""] {
            let answered = player.http.ask("POST", path, &[("idempotency-key", id)], "").await;
            book.write("repeats", &format!("POST {path} · idempotency-key: {id}"), &answered.text);
        }
    }
    for path in
        ["/commands/stop?id=c-1", "/commands/stop?id=c-1", "/commands/start?id=c-1", "/commands/start?id=", "/commands/start?a=1"]
    {
        let (_, said) = player.coap.ask(&coap::request(Method::Post, path, None, "")).await;
        book.write("repeats", &format!("POST {path}"), said.as_bytes());
    }
    for name in ["backHome", "backHome", "start"] {
        for id in [r#"{"id":"m-1"}"#, r#"{"id":"a b"}"#, r#"{"id":7}"#] {
            let (taken, said) = player.mqtt.say(&format!("{}/command/{name}", mqtt::BASE), id.as_bytes(), &mqtt::here()).await;
            book.write("repeats", &format!("{name} {id}"), outcome(taken, &said).as_bytes());
        }
    }
    let inside = player.app.inside();
    wire::entries(book, &inside.run.journal);
}

async fn keys(book: &mut Book, app: &TestApp) {
    let token = || Token::draw().expect("chance is there");
    let keys =
        [("lobby", Role::Viewer), (OPERATOR, Role::Operator)].map(|(name, role)| Key::new(name, role, token()).expect("sound"));
    let keyring = Keyring::of(Keys::new(Vec::from(keys)).expect("two keys")).expect("the system gives chance");
    let shown = |name| keyring.keys().named(name).expect("it is there").token.reveal().to_owned();
    let tokens = [("a viewer", shown("lobby")), ("an operator", shown(OPERATOR))];
    let told: Vec<(&str, &str)> = tokens.iter().map(|(role, token)| (*role, token.as_str())).collect();
    Http::new(app, mqtt::by_keys(&keyring)).sign_in(book, &told).await;
    let mut mqtt = Mqtt::new(app, false);
    for (role, token) in &tokens {
        let sender = mqtt::with_key(&keyring, token);
        for (name, payload) in [("start", "{}"), ("stop", ""), ("move", r#"{"move":"w"}"#), ("dance", "{}")] {
            let (taken, said) = mqtt.say(&format!("{}/command/{name}", mqtt::BASE), payload.as_bytes(), &sender).await;
            book.write("commands_mqtt", &format!("{name} of {role}"), outcome(taken, &said).as_bytes());
        }
    }
    let (taken, said) = mqtt.say(&format!("{}/command", mqtt::BASE), b"start", &mqtt::unknown()).await;
    book.write("commands_mqtt", "start at another's broker", outcome(taken, &said).as_bytes());
    for content in ["userCmd(w)", "userCmd(h)"] {
        let message = format!("msg(userCmd,event,js,none,{content},1)");
        let (taken, said) = mqtt.say(&format!("{}/events", mqtt::OLD), message.as_bytes(), &mqtt::here()).await;
        book.write("commands_mqtt", &format!("{content} where old clients may not drive"), outcome(taken, &said).as_bytes());
    }
}

/// Result of a message, in words that do not change when code is renamed.
fn outcome(taken: Taken, said: &[String]) -> String {
    let taken = match taken {
        Taken::NotACommand => "not a command",
        Taken::Taken => "taken",
        Taken::InConfidence => "in confidence",
        Taken::Forbidden => "forbidden",
    };
    format!("{taken}\n{}", said.join("\n"))
}

/// Answer to a command.
pub(crate) struct Given {
    pub(crate) kind: &'static str,
    pub(crate) title: String,
    pub(crate) is_accepted: bool,
    pub(crate) said: Vec<u8>,
}

impl Player {
    pub(crate) fn new(app: TestApp, dice: RandomStream) -> Player {
        Player {
            http: Http::new(&app, Access::Open),
            coap: Coap::new(&app, true),
            locked: Coap::new(&app, false),
            mqtt: Mqtt::new(&app, true),
            dice,
            seen: None,
            forms: forms(),
            outcomes: BTreeMap::new(),
            app,
        }
    }

    async fn run(&mut self, book: &mut Book, of: Play) {
        self.look(book, of).await;
        if of.with_table {
            self.whole_table(book, of).await;
        }
        let mut is_table_due = of.with_table;
        for step in 0..of.steps {
            if is_table_due && self.app.state().pending().is_some() {
                is_table_due = false;
                self.whole_table(book, of).await;
            }
            if of.one_in > 0 && self.dice.below(of.one_in) == 0 {
                let form = self.drawn();
                self.give(book, &form).await;
            } else if let Some(form) = self.operator() {
                self.give(book, &form).await;
            } else if !self.app.advance() {
                let form = self.way_out();
                self.give(book, &form).await;
            }
            if step == of.steps / 2 {
                self.mqtt.renew(book);
            }
            self.look(book, of).await;
        }
    }

    /// Gives every command of the table in turn; the first at this state, each further one at the state that follows.
    async fn whole_table(&mut self, book: &mut Book, of: Play) {
        for form in self.forms.clone() {
            self.give(book, &form).await;
            for _ in 0..self.dice.below(3) {
                self.app.advance();
            }
            self.place(book, of);
        }
    }

    fn drawn(&mut self) -> Form {
        let place = usize::try_from(self.dice.below(self.forms.len() as u64)).expect("there are few");
        self.forms[place].clone()
    }

    /// Next command of the operator; `None` while the robot works.
    fn operator(&mut self) -> Option<Form> {
        let state = self.app.state();
        let mission = &state.mission;
        if state.alarms.iter().any(|alarm| alarm.acknowledged.is_none()) && self.dice.below(4) == 0 {
            return Some(self.command("acknowledge", ""));
        }
        let piece = mission.inspected.and_then(|id| state.luggage(id)).filter(|piece| piece.is_pending());
        if let Some(piece) = piece.filter(|_| self.dice.below(2) == 0) {
            let is_bomb = matches!(self.app.hall.truth(piece.cell), Truth::Luggage(of) if self.app.hall.is_dangerous(of));
            if !is_bomb && !piece.has_photo() {
                return mission.refusals.retake.is_none().then(|| self.command("retake", ""));
            }
            return Some(self.command("verdict", if is_bomb { r#"{"verdict":"danger"}"# } else { r#"{"verdict":"safe"}"# }));
        }
        let has_ended = matches!(mission.phase, PhaseName::Explored | PhaseName::BombLocated | PhaseName::BagSecured);
        if has_ended && self.dice.below(4) == 0 {
            return Some(self.command("reset", ""));
        }
        let is_cold = mission.holds.iter().any(|hold| matches!(hold, Hold::Temperature | Hold::TooHigh | Hold::TemperatureStale));
        if is_cold && self.dice.below(3) == 0 {
            return Some(self.way_out());
        }
        let may_start = mission.refusals.start.is_none() && (!mission.holds.is_empty() || mission.phase == PhaseName::Idle);
        (may_start && self.dice.below(3) == 0).then(|| self.command("start", ""))
    }

    /// Command that may help when nothing happens by itself any more.
    fn way_out(&mut self) -> Form {
        let heats = [r#"{"status":"ok"}"#, r#"{"celsius":20}"#, r#"{"celsius":20,"sensor":"roof"}"#];
        match self.dice.below(6) {
            0 => self.command("start", ""),
            1 => self.command("reset", ""),
            2 => self.command("acknowledge", ""),
            place => self.command("temperature", heats[usize::try_from(place - 3).expect("three of them")]),
        }
    }

    /// Command at a random door.
    fn command(&mut self, name: &str, body: &str) -> Form {
        let door = self.dice.below(4);
        let path = match name {
            "verdict" => "/luggage/$pending/verdict".to_owned(),
            "retake" => "/luggage/$pending/photo".to_owned(),
            "acknowledge" => "/alarms/$alarm/acknowledge".to_owned(),
            "temperature" => "/temperature".to_owned(),
            name => format!("/commands/{name}"),
        };
        let is_put = name == "temperature";
        let (method, word) = if is_put { (Method::Put, "PUT") } else { (Method::Post, "POST") };
        match door {
            0 => Form::Http(word, format!("/api/v1{path}"), None, Some("application/json"), body.to_owned()),
            1 => Form::Coap(method, path, Some(Format::CBOR).filter(|_| !body.is_empty()), body.to_owned()),
            _ if body.is_empty() && !path.contains('$') => Form::Mqtt(format!("{}/command", mqtt::BASE), name.to_owned()),
            _ => {
                let number = if name == "acknowledge" { "\"alarm\":$alarm" } else { "\"luggage\":$pending" };
                let rest = body.trim_start_matches('{').trim_end_matches('}');
                let fields = if is_put { vec![rest] } else { vec![number, rest] };
                let fields: Vec<&str> = fields.into_iter().filter(|field| !field.is_empty()).collect();
                Form::Mqtt(format!("{}/command/{name}", mqtt::BASE), format!("{{{}}}", fields.join(",")))
            }
        }
    }

    /// Gives a command and records the answer.
    async fn give(&mut self, book: &mut Book, form: &Form) {
        let Given { kind, title, is_accepted, said } = self.answer(form).await;
        self.outcomes.entry(format!("{kind} {title}")).or_default()[usize::from(!is_accepted)] += 1;
        book.write(kind, &title, &said);
    }

    pub(crate) async fn answer(&mut self, form: &Form) -> Given {
        let state = self.app.state();
        let of = |text: &str| filled(text, &state);
        // Keeps below the doors' rate limits.
        tokio::time::sleep(Duration::from_secs(2)).await;
        let (kind, title, is_accepted, said) = match form {
            Form::Http(method, path, accept, content, body) => {
                let accept = accept.map(|accept| ("accept", accept));
                let content = content.filter(|_| !body.is_empty()).map(|content| ("content-type", content));
                let headers: Vec<_> = accept.into_iter().chain(content).collect();
                let answered = self.http.ask(method, &of(path), &headers, &of(body)).await;
                let told: String = headers.iter().map(|(name, value)| format!(" · {name}: {value}")).collect();
                ("commands_http", format!("{method} {path}{told} · {body}"), answered.status < 400, answered.text)
            }
            Form::Coap(method, path, format, body) => {
                let request = coap_request(*method, &of(path), *format, &of(body));
                let (is_accepted, said) = self.coap.ask(&request).await;
                let (_, locked) = if path == "/resourcemodel" { self.locked.ask(&request).await } else { (false, String::new()) };
                let format = format.map_or("no format".to_owned(), |format| format.to_string());
                let title = format!("{} {path} · {format} · {body}", method.name());
                ("commands_coap", title, is_accepted, [said, locked].join("\n").trim_end().as_bytes().to_vec())
            }
            Form::Mqtt(topic, payload) => {
                let (taken, said) = self.mqtt.say(&of(topic), of(payload).as_bytes(), &mqtt::here()).await;
                let is_refused = taken != Taken::Taken || said.iter().any(|said| said.contains("\"accepted\":false"));
                ("commands_mqtt", format!("{topic} {payload}"), !is_refused, outcome(taken, &said).into_bytes())
            }
        };
        Given { kind, title, is_accepted, said }
    }

    fn place(&self, book: &mut Book, of: Play) {
        book.place = format!("{} {} · revision {}", of.hall, of.seed, self.app.state().revision);
    }

    /// Records the state if it has changed.
    async fn look(&mut self, book: &mut Book, of: Play) {
        let state = self.app.state();
        if self.seen.as_ref().is_some_and(|seen| seen.revision == state.revision) {
            return;
        }
        self.place(book, of);
        let older = self.seen.replace(Arc::clone(&state));
        let is_worth = older.as_ref().is_none_or(|older| {
            let told = |state: &Snapshot| (state.mission.phase, state.mission.holds.clone(), state.luggage.len());
            told(older) != told(&state)
        });
        if older.as_ref().is_some_and(|older| older.mission.phase == state.mission.phase) {
            book.fold();
        }
        self.look_at(book, older.as_deref(), &state, is_worth).await;
        book.unfold();
    }

    /// Records everything that is shown in this state.
    pub(crate) async fn look_at_all(&mut self, book: &mut Book) {
        book.fold();
        self.look_at(book, None, &self.app.state(), true).await;
        book.unfold();
    }

    async fn look_at(&mut self, book: &mut Book, older: Option<&Snapshot>, state: &Arc<Snapshot>, is_worth: bool) {
        wire::snapshot(book, older, state);
        self.mqtt.look(book, &self.app, state);
        self.coap.look(book, state, is_worth).await;
        self.http.look(book, state, is_worth).await;
    }
}

fn coap_request(method: Method, path: &str, format: Option<Format>, body: &str) -> CoapRequest {
    if format != Some(Format::CBOR) {
        return coap::request(method, path, format, body);
    }
    let payload = match serde_json::from_str::<serde_json::Value>(body) {
        Ok(value) => cbor::written(&value),
        Err(_) => body.as_bytes().to_vec(),
    };
    CoapRequest { accept: format, ..coap::request(method, path, format, payload) }
}
