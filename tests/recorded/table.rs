//! Every command as clients write it, right and wrong, at every door. `$pending`, `$alarm`, `$epoch`, `$revision`,
//! `$x` and `$y` stand for current values.

use super::doors::{Format, Method, Snapshot};
use super::mqtt::{BASE, OLD};

/// One message to one door.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// Method, path, Accept, Content-Type, and body.
    Http(&'static str, String, Option<&'static str>, Option<&'static str>, String),
    /// Method, path, format of body and answer, and the body as JSON.
    Coap(Method, String, Option<Format>, String),
    /// Topic and payload.
    Mqtt(String, String),
}

/// Command of the interfaces: name, HTTP method and path, CoAP path, and bodies.
type Row = (&'static str, &'static str, &'static str, &'static str, &'static [&'static str]);

const EPOCHS: &[&str] = &["", "{}", r#"{"epoch":$epoch}"#, r#"{"epoch":0}"#, r#"{"epoch":"x"}"#, "{", "[]"];

const ROWS: &[Row] = &[
    ("start", "POST", "/api/v1/commands/start", "/commands/start", EPOCHS),
    ("stop", "POST", "/api/v1/commands/stop", "/commands/stop", &["", "garbage", r#"{"epoch":0}"#]),
    ("backHome", "POST", "/api/v1/commands/backHome", "/commands/backHome", EPOCHS),
    ("retrieve", "POST", "/api/v1/commands/retrieve", "/commands/retrieve", EPOCHS),
    ("reset", "POST", "/api/v1/commands/reset", "/commands/reset", EPOCHS),
    ("move", "POST", "/api/v1/commands/move", "/commands/move", MOVES),
    ("goto", "POST", "/api/v1/commands/goto", "/commands/goto", GOTOS),
    ("strategy", "PUT", "/api/v1/strategy", "/strategy", &[r#"{"name":"snail"}"#, r#"{"name":"zigzag"}"#, "{}", "", "7"]),
    ("temperature", "PUT", "/api/v1/temperature", "/temperature", DEGREES),
    ("verdict", "POST", "/api/v1/luggage/$pending/verdict", "/luggage/$pending/verdict", VERDICTS),
    ("verdict", "POST", "/api/v1/luggage/999/verdict", "/luggage/999/verdict", &[r#"{"verdict":"safe"}"#]),
    ("verdict", "POST", "/api/v1/luggage/x/verdict", "/luggage/x/verdict", &[r#"{"verdict":"safe"}"#]),
    ("retake", "POST", "/api/v1/luggage/$pending/photo", "/luggage/$pending/photo", &["", "{", r#"{"epoch":1}"#]),
    ("retake", "POST", "/api/v1/luggage/999/photo", "/luggage/999/photo", &[""]),
    ("acknowledge", "POST", "/api/v1/alarms/$alarm/acknowledge", "/alarms/$alarm/acknowledge", &["", "{", "{}"]),
    ("acknowledge", "POST", "/api/v1/alarms/999/acknowledge", "/alarms/999/acknowledge", &[""]),
    ("acknowledge", "POST", "/api/v1/alarms/-1/acknowledge", "/alarms/-1/acknowledge", &[""]),
    ("nothing", "POST", "/api/v1/commands/dance", "/commands/dance", &["", "{}"]),
];

const MOVES: &[&str] = &[
    r#"{"move":"w"}"#,
    r#"{"move":"s","epoch":$epoch}"#,
    r#"{"move":"a"}"#,
    r#"{"move":"l","epoch":0}"#,
    r#"{"move":"d"}"#,
    r#"{"move":"r"}"#,
    r#"{"move":"z"}"#,
    r#"{"move":"x"}"#,
    r#"{"move":"h"}"#,
    r#"{"move":"q"}"#,
    r#"{"move":3}"#,
    "{}",
    "",
    "w",
];

const GOTOS: &[&str] = &[
    r#"{"x":$x,"y":$y}"#,
    r#"{"x":0,"y":0,"epoch":$epoch}"#,
    r#"{"x":1,"y":1,"epoch":0}"#,
    r#"{"x":1}"#,
    r#"{"x":1.5,"y":2}"#,
    r#"{"x":99999999999,"y":0}"#,
    r#"{"x":40,"y":40}"#,
    "",
];

const DEGREES: &[&str] = &[
    r#"{"celsius":21.5}"#,
    r#"{"celsius":30}"#,
    r#"{"status":"tooHigh"}"#,
    r#"{"status":"ok"}"#,
    r#"{"status":"warm"}"#,
    r#"{"celsius":20.25,"sensor":"roof"}"#,
    r#"{"celsius":31,"sensor":"roof"}"#,
    r#"{"celsius":20,"sensor":"cellar"}"#,
    r#"{"celsius":20,"sensor":"a b"}"#,
    r#"{"celsius":1e9}"#,
    r#"{"celsius":"21"}"#,
    "{}",
    "",
];

const VERDICTS: &[&str] = &[r#"{"verdict":"safe"}"#, r#"{"verdict":"danger"}"#, r#"{"verdict":"maybe"}"#, "{}", "", "safe"];

/// Letters and words of old consoles, which are paths over HTTP and payloads over CoAP.
const OLD_PATHS: [&str; 16] = [
    "w",
    "s",
    "a",
    "l",
    "d",
    "r",
    "h",
    "z",
    "x",
    "safe",
    "danger",
    "startappl",
    "stopappl",
    "backhomeappl",
    "temperatureOk",
    "temperatureTooHigh",
];
const OLD_WORDS: [&str; 16] =
    ["w", "s", "a", "l", "d", "r", "h", "z", "x", "safe", "danger", "\"w\"", "W", "", "stop", "{\"move\":\"w\"}"];

/// Forms that the console sends.
const FORMS: [(&str, &str); 19] = [
    ("start", "epoch=$epoch"),
    ("start", "epoch=0"),
    ("start", "epoch=x"),
    ("stop", ""),
    ("backHome", "epoch=$epoch"),
    ("retrieve", "epoch=$epoch"),
    ("reset", ""),
    ("move", "epoch=$epoch&move=w"),
    ("move", "move=q"),
    ("goto", "epoch=$epoch&x=$x&y=$y"),
    ("goto", "x=&y=2"),
    ("safe", "id=$pending"),
    ("danger", "id=999"),
    ("retake", "id=$pending"),
    ("acknowledge", "id=$alarm"),
    ("strategy", "name=snail"),
    ("temperature", "status=ok"),
    ("temperature", "celsius=21,5"),
    ("temperature", "celsius=warm"),
];

/// Messages of old clients: MSGID and CONTENT.
const MESSAGES: [(&str, &str); 30] = [
    ("startCmd", "startCmd"),
    ("startCmd", "stopCmd"),
    ("stopCmd", "stopCmd"),
    ("backHomeCmd", "backHomeCmd"),
    ("temperatureTooHigh", "temperatureTooHigh"),
    ("temperatureOk", "temperatureOk"),
    ("luggageSafe", "luggageSafe"),
    ("luggageSafe", "1"),
    ("luggageDanger", "luggageDanger"),
    ("explore", "explore"),
    ("stopExplore", "stopExplore"),
    ("backHome", "backHome"),
    ("continueExplore", "continueExplore"),
    ("continueExploreAfterPhoto", "continueExploreAfterPhoto"),
    ("backHomeSinceBomb", "backHomeSinceBomb"),
    ("startTest", "startTest($x,$y)"),
    ("startTest", "startTest(1)"),
    ("userCmd", "userCmd(w)"),
    ("userCmd", "userCmd(h)"),
    ("userCmd", "userCmd(q)"),
    ("robotCmd", "robotCmd(a)"),
    ("modelChange", "modelChange(robot,d)"),
    ("modelChange", "modelChange(luggage,safe)"),
    ("modelChange", "modelChange(luggage,bomb)"),
    ("startAppl", "startAppl(go)"),
    ("stopAppl", "stopAppl(go)"),
    ("reachBag", "reachBag"),
    ("sonarRobot", "sonar(12)"),
    ("modelContent", "content(robot(state(stopped)))"),
    ("nobodys", "[a|B]"),
];

const JSON: &str = "application/json";
const URLENCODED: &str = "application/x-www-form-urlencoded";

pub(crate) fn forms() -> Vec<Form> {
    [interfaces(), old_words(), console(), bare()].concat()
}

fn interfaces() -> Vec<Form> {
    let mut forms = Vec::new();
    for (name, method, http, coap, bodies) in ROWS {
        let put = if *method == "PUT" { Method::Put } else { Method::Post };
        for body in *bodies {
            forms.push(Form::Http(method, (*http).to_owned(), None, Some(JSON), (*body).to_owned()));
            forms.push(Form::Coap(put, (*coap).to_owned(), Some(Format::JSON), (*body).to_owned()));
            if body.starts_with('{') && body.ends_with('}') {
                forms.push(Form::Coap(put, (*coap).to_owned(), Some(Format::CBOR), (*body).to_owned()));
            }
            forms.push(Form::Mqtt(format!("{BASE}/command/{name}"), numbered(http, body)));
        }
        forms.push(Form::Http(method, (*http).to_owned(), None, Some("text/plain"), "no JSON".to_owned()));
        forms.push(Form::Coap(put, (*coap).to_owned(), Some(Format::TEXT), "no JSON".to_owned()));
        let named = format!("{coap}?id=c-$revision");
        forms.push(Form::Coap(put, named, None, bodies[0].to_owned()));
    }
    forms
}

/// Body for MQTT, which contains the number that HTTP has in the path.
fn numbered(path: &str, body: &str) -> String {
    let number = path.split('/').find(|part| part.starts_with('$') || *part == "999").unwrap_or_default();
    let name = if path.contains("/alarms/") { "alarm" } else { "luggage" };
    match body.strip_prefix('{') {
        _ if number.is_empty() => body.to_owned(),
        Some("}") => format!("{{\"{name}\":{number}}}"),
        Some(rest) => format!("{{\"{name}\":{number},\"id\":\"m-$revision\",{rest}"),
        None if body.is_empty() => format!("{{\"{name}\":{number}}}"),
        None => body.to_owned(),
    }
}

fn old_words() -> Vec<Form> {
    let mut forms = Vec::new();
    for word in OLD_PATHS {
        forms.push(Form::Http("POST", format!("/{word}"), None, None, String::new()));
        forms.push(Form::Http("POST", format!("/{word}"), Some("text/html"), Some(URLENCODED), "x=1".to_owned()));
    }
    for word in OLD_WORDS {
        forms.push(Form::Coap(Method::Put, "/resourcemodel".to_owned(), None, word.to_owned()));
    }
    forms.push(Form::Coap(Method::Post, "/resourcemodel".to_owned(), Some(Format::TEXT), "w".to_owned()));
    forms.push(Form::Coap(Method::Put, "/resourcemodel".to_owned(), Some(Format::CBOR), "w".to_owned()));
    for (id, content) in MESSAGES {
        forms.push(Form::Mqtt(format!("{OLD}/events"), format!("msg({id},event,js,none,{content},1)")));
        forms.push(Form::Mqtt(format!("{OLD}/robotmind"), format!("msg({id},dispatch,js,robotmind,{content},1)")));
    }
    for wrong in ["", "startCmd", "msg(startCmd,event,js,none,startCmd)", "{\"id\":1}"] {
        forms.push(Form::Mqtt(format!("{OLD}/events"), wrong.to_owned()));
    }
    forms
}

fn console() -> Vec<Form> {
    let both = [Some(JSON), Some("text/html")];
    let form = |(act, body): (&str, &str), accept| {
        Form::Http("POST", format!("/console/{act}"), accept, Some(URLENCODED), body.to_owned())
    };
    FORMS.into_iter().flat_map(|filled_in| both.map(|accept| form(filled_in, accept))).collect()
}

/// Bare words over MQTT, and unknown topics.
fn bare() -> Vec<Form> {
    let words = ["start", "stop", "backHome", "retrieve", "reset", "goto", "dance", "", " Stop! "];
    let topics = ["command/start/result", "state/robot", "command", "nothing"];
    let words = words.map(|word| Form::Mqtt(format!("{BASE}/command"), word.to_owned()));
    let topics = topics.map(|topic| Form::Mqtt(format!("{BASE}/{topic}"), "{}".to_owned()));
    words.into_iter().chain(topics).collect()
}

/// Replaces the placeholders with current values.
pub(crate) fn filled(text: &str, state: &Snapshot) -> String {
    let pending = state.pending().or(state.luggage.last()).map_or(1, |piece| piece.id.0);
    let alarm = state.alarms.iter().find(|alarm| alarm.acknowledged.is_none()).or(state.alarms.first());
    let alarm = alarm.and_then(|alarm| alarm.id).map_or(1, |id| id.0);
    let place = state.mission.trail.first().copied().unwrap_or(state.robot.pose.cell);
    text.replace("$pending", &pending.to_string())
        .replace("$alarm", &alarm.to_string())
        .replace("$epoch", &state.mission.epoch.0.to_string())
        .replace("$revision", &state.revision.to_string())
        .replace("$x", &place.x.to_string())
        .replace("$y", &place.y.to_string())
}
