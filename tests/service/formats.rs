//! Readable resources and their formats: JSON, text, images, pages, ETags and compression.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::program::Program;

#[test]
fn the_state_holds_everything() {
    let program = Program::serve("empty-8x8", "max");
    let state = program.json("state");
    let has = |value: &Value, keys: &str| {
        let there: BTreeSet<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
        for key in keys.split(' ') {
            assert!(there.contains(key), "{key} is not in {value}");
        }
    };
    has(&state, "revision mission robot map luggage temperature alarms log");
    has(&state["mission"], "id phase holds goal strategy epoch progress");
    has(&state["robot"], "state heading position sonar led");
    has(&state["temperature"], "celsius status threshold");
    assert_eq!(state["mission"]["phase"], "idle");
    assert_eq!(state["mission"]["strategy"], "auto");
    assert_eq!(state["robot"]["position"], serde_json::json!({"x": 0, "y": 0}));
    assert_eq!((&state["robot"]["heading"], &state["robot"]["led"]), (&"south".into(), &"off".into()));
    assert_eq!((&state["robot"]["state"], &state["temperature"]["threshold"]), (&"stopped".into(), &25.0.into()));
}

#[test]
fn an_explored_hall_is_the_map_of_the_documents() {
    let program = Program::serve("empty-8x8", "max");
    program.command("start").accepted();
    let state = program.until_phase("explored");
    assert_eq!((&state["robot"]["led"], &state["mission"]["progress"]["percent"]), (&"off".into(), &100.into()));
    let text = program.read("/api/v1/map", &[("accept", "text/plain")]);
    let inside = |first: &str| format!("|{first}, {}X, \n", "1, ".repeat(7));
    let expected = format!("{}{}|{}\n", inside("r"), inside("1").repeat(7), "X, ".repeat(9));
    assert_eq!(text.text(), expected);
    assert!(text.header("content-type").starts_with("text/plain"));
    let map = program.json("map");
    let rows = map["rows"].as_array().expect("rows");
    assert_eq!(rows.len() as u64, map["height"].as_u64().expect("a height"));
    assert_eq!(rows.iter().filter_map(Value::as_str).flat_map(str::chars).filter(|mark| "1r".contains(*mark)).count(), 64);
}

#[test]
fn what_has_not_changed_is_not_sent_again() {
    let program = Program::serve("empty-8x8", "max");
    for resource in ["state", "map", "luggage"] {
        let path = format!("/api/v1/{resource}");
        // The hall's thermometer may change the state between the two requests. In that case the ETag changes too.
        let unchanged = (0..20).any(|_| {
            let tag = program.read(&path, &[]).header("etag").to_owned();
            assert!(!tag.is_empty(), "{resource} has no tag");
            let again = program.read(&path, &[("if-none-match", &tag)]);
            again.status == 304 && again.body.is_empty() && again.header("etag") == tag
        });
        assert!(unchanged, "{resource} is sent again although nothing changed");
        assert_eq!(program.read(&path, &[("if-none-match", "\"something else\"")]).status, 200);
    }
    let before = program.read("/api/v1/state", &[]).header("etag").to_owned();
    program.command("stop").accepted();
    assert_eq!(program.read("/api/v1/state", &[("if-none-match", &before)]).status, 200, "a change is sent");
}

#[test]
fn json_and_pages_are_compressed_for_those_who_ask() {
    let program = Program::serve("empty-8x8", "max");
    for path in ["/api/v1/state", "/"] {
        let plain = program.read(path, &[]);
        let small = program.read(path, &[("accept-encoding", "gzip")]);
        assert_eq!((plain.header("content-encoding"), small.header("content-encoding")), ("", "gzip"), "{path}");
        assert_eq!(&small.body[..2], b"\x1f\x8b", "{path} is no gzip");
        assert!(small.body.len() < plain.body.len(), "{path} has not become smaller");
    }
}

#[test]
fn a_piece_of_luggage_has_a_record_and_a_picture() {
    let program = Program::serve("airport", "max");
    program.command("start").accepted();
    let id = program.until_asked();
    let record = program.json(&format!("luggage/{id}"));
    assert_eq!((&record["id"], &record["verdict"]), (&id.into(), &"pending".into()));
    let time = record["taken"].as_str().expect("a time");
    assert!(time.len() >= 20 && time.contains('T'), "{time} is not RFC 3339 with a zone");
    assert_eq!(program.json("luggage").as_array().expect("a list").len(), 1);

    let photo = program.read(&format!("/api/v1/luggage/{id}/photo"), &[]);
    assert_eq!((photo.status, photo.header("content-type")), (200, "image/png"));
    assert_eq!(&photo.body[..8], b"\x89PNG\r\n\x1a\n");
    let side = |at: usize| u32::from_be_bytes(photo.body[at..at + 4].try_into().expect("four bytes"));
    assert!(side(16) >= 640 && side(20) >= 480, "{} × {}", side(16), side(20));
    let tag = photo.header("etag");
    assert_eq!(program.read(&format!("/api/v1/luggage/{id}/photo"), &[("if-none-match", tag)]).status, 304);
}

#[test]
fn the_console_is_a_page_of_this_origin_alone() {
    let program = Program::serve("empty-8x8", "max");
    let page = program.read("/", &[("accept", "text/html")]);
    assert_eq!(page.status, 200);
    assert!(page.header("content-type").starts_with("text/html"));
    let policy = page.header("content-security-policy");
    assert!(policy.contains("default-src 'self'") && !policy.contains("unsafe"), "{policy}");
    let text = page.text();
    assert!(!text.contains("https://") && !text.contains("<script>"), "no other origin, no inline script");
    let files = text.split('"').filter_map(|word| word.strip_prefix('.')).filter(|path| path.starts_with("/static/"));
    let files: BTreeSet<&str> = files.collect();
    assert!(files.len() >= 2, "a style and a script: {files:?}");
    for file in files {
        assert_eq!(program.read(file, &[]).status, 200, "{file}");
    }
}
