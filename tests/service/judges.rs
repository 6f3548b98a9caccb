//! Verdicts by two judges at the public doors: what the first has answered is shown nowhere before the second has
//! answered, and no way round leads to a *safe* by one key.

use crate::access::Folder;
use crate::mqtt_clients::client::Client;
use crate::mqtt_clients::running::RunningClient;
use crate::mqtt_clients::told::{Hello, Say};
use crate::program::{Answer, Program};

/// A program that asks for keys at HTTP and MQTT, with the operators `operator` and `ben`, and the viewer `lobby`.
struct Panel {
    program: Program,
    folder: Folder,
}

impl Panel {
    fn new(name: &str, hot: &str) -> Panel {
        let folder = Folder::new(name);
        folder.token(&["add", "ben", "--role", "operator"]);
        folder.token(&["add", "lobby", "--role", "viewer"]);
        Panel { program: Panel::serve(&folder, hot), folder }
    }

    fn serve(folder: &Folder, hot: &str) -> Program {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--seed", "1", "--speed", "max"];
        let mut command = folder.command(&arguments);
        command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("HALLSWEEP__MQTT__REQUIRE_PASSWORD", "true");
        command.env("HALLSWEEP__MISSION__SAFE_BY", "2").env("HALLSWEEP__MISSION__HOT", hot);
        Program::started(&mut command)
    }

    /// Kills the program and starts it again.
    fn again(self, hot: &str) -> Panel {
        let Panel { program, folder } = self;
        drop(program);
        Panel { program: Panel::serve(&folder, hot), folder }
    }

    fn key(&self, name: &str) -> String {
        format!("Bearer {}", self.folder.token_of(name))
    }

    fn post(&self, key: &str, path: &str, body: &str) -> Answer {
        let headers = [("authorization", &*self.key(key)), ("content-type", "application/json")];
        self.program.post_with(path, &headers, body)
    }

    fn read(&self, path: &str) -> String {
        self.program.read(path, &[("authorization", &self.key("lobby"))]).text()
    }

    /// The number of the piece that waits for its verdict, after START.
    fn asked(&self) -> u64 {
        self.post("operator", "/api/v1/commands/start", "").accepted();
        let deadline = crate::program::Deadline::within(crate::program::PATIENCE);
        loop {
            let state: serde_json::Value = serde_json::from_str(&self.read("/api/v1/state")).expect("the state is JSON");
            let inspected = state["luggage"].as_array().and_then(|all| all.iter().find(|piece| piece["verdict"] == "pending"));
            if let Some(id) = inspected.and_then(|piece| piece["id"].as_u64())
                && state["robot"]["state"] == "stopped"
            {
                return id;
            }
            assert!(!deadline.has_passed(), "no piece waits: {state}");
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    }

    /// Everything that a viewer can read of the mission, but for the time of day and the figures of connections.
    fn shown(&self, luggage: u64) -> String {
        let state: serde_json::Value = serde_json::from_str(&self.read("/api/v1/state")).expect("the state is JSON");
        let [mission, pieces, alarms] = ["mission", "luggage", "alarms"].map(|part| state[part].to_string());
        let metrics = self.read("/metrics");
        let of_commands = |line: &&str| {
            ["commands_total", "verdicts_total", "refusals_total", "records", "record_seconds", "command_seconds"]
                .iter()
                .any(|name| line.contains(name))
        };
        let metrics: Vec<&str> = metrics.lines().filter(of_commands).collect();
        let pages = [
            format!("/api/v1/luggage/{luggage}"),
            "/api/v1/log".to_owned(),
            "/api/v1/missions/1/events?limit=1000".to_owned(),
            "/api/v1/missions/1/timeline".to_owned(),
            "/missions/1/record.csv".to_owned(),
        ];
        let pages: Vec<String> = pages.iter().map(|page| self.read(page)).collect();
        format!("{mission}\n{pieces}\n{alarms}\n{metrics:#?}\n{pages:#?}")
    }
}

#[test]
fn what_the_first_judge_has_answered_is_shown_at_no_door() {
    let client = Client::Mosquitto;
    if !client.is_here() {
        return;
    }
    let panel = Panel::new("judges", "optional");
    let id = panel.asked();
    let (verdict, safe) = (format!("/api/v1/luggage/{id}/verdict"), r#"{"verdict":"safe","note":"a lunch box","hidden":"no"}"#);
    let token = panel.folder.token_of("ben");
    let ben = RunningClient::begin(client, &panel.program, Hello::following(&["#"], 0).with_login("ben", &token));
    let before = panel.shown(id);
    assert!(before.contains("missionBegan") && before.contains("commands_total"), "the pages can be read: {before}");

    let first = panel.post("operator", &verdict, safe);
    first.accepted();
    let answer = first.json();
    assert_eq!((&answer["keptBack"], &answer["luggage"]["verdict"]), (&true.into(), &"pending".into()), "{answer}");
    assert_eq!(panel.shown(id), before, "nothing tells a viewer that somebody has answered");

    // The same judge at other doors is still the same judge. Nobody else reads what is sent over MQTT.
    let token = panel.folder.token_of("operator");
    let mut own = RunningClient::begin(client, &panel.program, Hello::following(&["x"], 0).with_login("operator", &token));
    let topic = "hallsweep/discovery/command/verdict";
    own.say(Say::plain(topic, &format!(r#"{{"luggage":{id},"verdict":"safe","id":"k7"}}"#)));
    own.say(Say::plain("unibo/qak/events", "msg(continueExploreAfterPhoto,event,js,none,continueExploreAfterPhoto,1)"));
    // Verdicts that are written wrongly would tell as much.
    for (topic, payload) in [
        (topic, r#"{"luggage":1,"verdict":"safe","hidden":"perhaps"}"#),
        (topic, r#"{"luggage":1,"verdict":"safe" half"#),
        ("hallsweep/discovery/command/Verdict", r#"{"luggage":1,"verdict":"safe"}"#),
        ("hallsweep/discovery/command", r#"{"luggage":1,"verdict":"safe","command":"verdict"}"#),
        ("unibo/qak/events", "msg(luggageSafe,event,js,none,luggageSafe,1"),
        ("unibo/qak/events", "luggageSafe"),
    ] {
        own.say(Say::plain(topic, payload));
    }
    own.say(Say::plain("x", "the last message"));
    ben.until("the last message", |heard| heard.iter().any(|message| message.topic == "x").then_some(()));
    let told: Vec<String> = ben.heard().iter().map(|message| format!("{} {}", message.topic, message.payload)).collect();
    let tells = |line: &&String| ["/command", "luggageSafe", "continueExploreAfterPhoto"].iter().any(|word| line.contains(word));
    assert_eq!(told.iter().find(tells), None, "neither the command nor its result");
    assert_eq!(panel.shown(id), before);
    for wrong in [r#"{"verdict":"safe","hidden":"perhaps"}"#, r#"{"verdict":"safe""#, r#"{"verdict":"safe","note":7}"#] {
        assert_eq!(panel.post("operator", &verdict, wrong).status / 100, 4, "{wrong}");
    }
    let form = [("authorization", &*panel.key("operator")), ("content-type", "application/x-www-form-urlencoded")];
    assert_eq!(panel.program.post_with("/console/safe", &form, "id=1&hidden=perhaps").status, 422);
    let named = [("authorization", &*panel.key("operator")), ("content-type", "application/json"), ("idempotency-key", "k7")];
    assert_eq!(panel.program.post_with(&verdict, &named, r#"{"verdict":"danger"}"#).status, 422, "k7 is another command");
    assert_eq!(panel.shown(id), before, "nor does a refusal");
    assert_eq!(panel.post("lobby", &verdict, safe).status, 403, "a viewer is no judge");
    assert_eq!(panel.post("operator", "/safe", "").json()["keptBack"], true, "nor is the same key at an old route");

    let second = panel.post("ben", &verdict, r#"{"verdict":"safe","typical":"yes"}"#);
    second.accepted();
    let record = &second.json()["luggage"];
    assert_eq!(
        (&record["verdict"], &record["decided"]["by"], &record["decided"]["typical"]),
        (&"safe".into(), &"ben".into(), &"yes".into())
    );
    let judged = &record["judged"][0];
    assert_eq!((&judged["by"], &judged["note"], &judged["hidden"]), (&"operator".into(), &"a lunch box".into(), &"no".into()));
    let after = panel.shown(id);
    assert!(
        after.contains("kept back until now") && after.contains("\\\"kind\\\":\\\"judged\\\""),
        "now it is on record: {after}"
    );
}

#[test]
fn a_danger_by_anybody_ends_the_wait_and_a_kill_loses_no_answer() {
    let panel = Panel::new("judges-danger", "required");
    let id = panel.asked();
    let verdict = format!("/api/v1/luggage/{id}/verdict");
    let whole = r#"{"verdict":"safe","hidden":"no","obvious":"no","typical":"cannotSay"}"#;
    let bare = panel.post("operator", &verdict, r#"{"verdict":"safe"}"#);
    assert!(bare.problem(409).contains("hidden") && bare.json()["code"] == "hotUnanswered");
    let wrong = panel.post("operator", &verdict, r#"{"verdict":"safe","hidden":"perhaps"}"#);
    assert!(wrong.problem(422).contains("cannotSay"), "{}", wrong.text());
    assert_eq!(panel.post("operator", &verdict, whole).json()["keptBack"], true);

    let panel = panel.again("optional");
    assert_eq!(panel.post("operator", &verdict, whole).json()["keptBack"], true, "it is known after the kill");
    let danger = panel.post("operator", &verdict, r#"{"verdict":"danger"}"#);
    danger.accepted();
    let record = &danger.json()["luggage"];
    assert_eq!((&record["verdict"], &record["judged"][0]["typical"]), (&"danger".into(), &"cannotSay".into()), "{record}");
    assert_eq!(
        panel.post("ben", &verdict, whole).problem(409),
        format!("luggage #{id} was already found danger: a verdict is final")
    );

    let panel = panel.again("optional");
    let read: serde_json::Value = serde_json::from_str(&panel.read(&format!("/api/v1/luggage/{id}"))).expect("it is JSON");
    assert_eq!((&read["verdict"], read["judged"].as_array().map(Vec::len)), (&"danger".into(), Some(1)), "{read}");
    let report = panel.read("/missions/1/report");
    assert!(report.contains("answer kept back until now") && report.contains("typical: cannot say"));
}

/// A data folder with the answer of a first judge, `operator`.
pub(crate) fn answered_once(name: &str) -> Folder {
    let panel = Panel::new(&format!("judges-{name}"), "optional");
    let id = panel.asked();
    let said = panel.post("operator", &format!("/api/v1/luggage/{id}/verdict"), r#"{"verdict":"safe"}"#);
    assert_eq!(said.json()["keptBack"], true, "{}", said.text());
    panel.folder
}

/// Safety V4: a damaged file of answers never makes one judge two. Both are asked again; if the file cannot even be
/// replaced, the robots are held and the file is named.
#[test]
fn damaged_answers_are_asked_for_again() {
    for damage in crate::damage::ALL {
        let folder = answered_once(&format!("{damage:?}"));
        let file = folder.path().join("kept-back.json");
        damage.apply(&file);
        let panel = Panel { program: Panel::serve(&folder, "optional"), folder };
        let state: serde_json::Value = serde_json::from_str(&panel.read("/api/v1/state")).expect("the state is JSON");
        let id = &state["luggage"][0]["id"];
        let said = panel.post("ben", &format!("/api/v1/luggage/{id}/verdict"), r#"{"verdict":"safe"}"#);
        let failure = || panel.read("/api/v1/state");
        let record = panel.read(&format!("/api/v1/luggage/{id}"));
        assert!(record.contains(r#""verdict":"pending""#), "{damage:?}: one answer is not two: {record}");
        if file.is_file() {
            assert_eq!(said.json()["keptBack"], true, "{damage:?}: {}", said.text());
        } else {
            assert!(said.status == 503 && failure().contains("kept-back.json"), "{damage:?}: {} {}", said.text(), failure());
        }
    }
}

#[test]
fn two_judges_are_refused_where_they_cannot_be_told_apart() {
    let start = |folder: &Folder, more: &[(&str, &str)]| {
        let mut command = folder.command(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8"]);
        command
            .env("HALLSWEEP__MISSION__SAFE_BY", "2")
            .envs(more.iter().map(|(name, value)| (format!("HALLSWEEP__{name}"), *value)));
        let output = command.output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let folder = Folder::new("judges-refused");
    assert!(start(&folder, &[]).contains("HTTP requires no keys"));
    let mqtt = start(&folder, &[("HTTP__REQUIRE_TOKEN", "true"), ("MQTT__BIND", "127.0.0.1:0")]);
    assert!(mqtt.contains("MQTT requires no keys"), "{mqtt}");
    let one =
        start(&folder, &[("HTTP__REQUIRE_TOKEN", "true"), ("MQTT__BIND", "127.0.0.1:0"), ("MQTT__REQUIRE_PASSWORD", "true")]);
    assert!(one.contains("operators' keys is 1") && one.contains("hallsweep token add"), "{one}");
    let broker = start(&folder, &[("HTTP__REQUIRE_TOKEN", "true"), ("MQTT__BROKER", "mqtt://127.0.0.1:1")]);
    assert!(broker.contains("mission.safe_by") && broker.contains("could read the answer"), "{broker}");
}
