//! Control of the simulator while the real program runs: its time, its faults and their effect on the mission, and
//! other halls.

use std::io::{Read, Write};
use std::net::TcpStream;

use serde_json::{Value, json};

use crate::kill::Folder;
use crate::program::{Program, hallsweep};

const SIMULATOR: &str = "/api/v1/simulator";

fn change(program: &Program, body: &str) -> Value {
    let answer = program.put(SIMULATOR, body);
    assert_eq!(answer.status, 200, "{body}: {}", answer.text());
    answer.json()
}

fn holds(state: &Value, hold: &str) -> bool {
    state["mission"]["holds"].as_array().is_some_and(|holds| holds.iter().any(|held| held == hold))
}

fn says(state: &Value, words: &str) -> bool {
    state["log"]
        .as_array()
        .is_some_and(|lines| lines.iter().any(|line| line["text"].as_str().is_some_and(|text| text.contains(words))))
}

/// The console page in Italian.
fn in_italian(program: &Program) -> String {
    program.read("/", &[("accept", "text/html"), ("accept-language", "it")]).text()
}

/// Beginning of the answer to these bytes.
fn raw(program: &Program, bytes: &str) -> String {
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.write_all(bytes.as_bytes()).expect("it takes a head");
    let mut answer = [0; 64];
    let read = stream.read(&mut answer).expect("it answers");
    String::from_utf8_lossy(&answer[..read]).into_owned()
}

fn put_down(program: &Program, toml: &str) {
    let answer = program.put("/api/v1/simulator/hall", &json!({ "toml": toml }).to_string());
    assert_eq!(answer.status, 200, "{}", answer.text());
}

const LONG: &str = "name = \"corridor\"\ndrawing = \"\"\"\nS.........\n..........\n\"\"\"\n";

#[test]
fn what_is_shown_changes_as_it_was_asked_for_and_is_on_record() {
    let program = Program::serve("airport", "2");
    let shown = program.json("simulator");
    assert_eq!(shown["hall"], json!({"name":"airport","width":16,"height":10,"cellM":0.5,"pieces":7}));
    assert_eq!((&shown["speed"], &shown["paused"], &shown["blocked"]), (&json!(2.0), &json!(false), &json!([])));
    assert!(shown["halls"].as_array().is_some_and(|halls| halls.contains(&json!("seed"))) && shown["bound"].is_null());
    let shown = change(&program, r#"{"speed":"max","paused":true,"cameraFails":true,"blocked":[{"x":1,"y":0}]}"#);
    assert_eq!((&shown["speed"], &shown["paused"], &shown["cameraFails"]), (&json!("max"), &json!(true), &json!(true)));
    assert_eq!(program.json("simulator"), shown);
    let words = "simulator paused, speed max, camera fails: yes, blocked (1, 0), by operator (http, 127.0.0.1)";
    program.until("it is on record", |state| says(state, words));
}

/// Safety S1: STOP works during a pause, at once.
#[test]
fn a_paused_robot_does_not_get_on_is_stopped_and_takes_steps() {
    let program = Program::serve("empty-8x8", "1");
    change(&program, r#"{"paused":true}"#);
    assert!(program.command("start").status == 200);
    let state = program.until("it has an order", |state| state["robot"]["state"] != "stopped");
    assert_eq!(state["robot"]["position"], json!({"x":0,"y":0}));
    let stopped = program.command("stop");
    assert_eq!(stopped.status, 200);
    let state = program.until("it stands", |state| state["robot"]["halting"] == false && state["robot"]["state"] == "stopped");
    assert!(holds(&state, "operator"), "{state:#}");
    program.command("start").accepted();
    program.until("it has an order", |state| state["robot"]["state"] != "stopped");
    let mut steps = 0;
    while program.json("state")["robot"]["position"] == json!({"x":0,"y":0}) {
        let _ = program.post("/api/v1/simulator/step", "");
        steps += 1;
        assert!(steps < 100, "steps lead nowhere");
    }
    let why = program.put(SIMULATOR, r#"{"paused":false,"speed":"max"}"#);
    assert_eq!(why.status, 200);
    assert!(program.post("/api/v1/simulator/step", "").problem(409).contains("pause it first"));
    program.until_phase("explored");
    change(&program, r#"{"paused":true}"#);
    assert_eq!(program.post("/api/v1/simulator/step", "").json()["code"], "nothingUnderWay");
    let page = in_italian(&program);
    assert!(page.contains("il tempo del simulatore è fermo") && page.contains("nessun robot ha un ordine in corso"), "{page}");
}

#[test]
fn a_lost_link_holds_the_mission_and_it_goes_on_when_the_link_is_back() {
    let program = Program::serve("empty-8x8", "5");
    program.command("start").accepted();
    program.until("it drives", |state| state["robot"]["position"] != json!({"x":0,"y":0}));
    change(&program, r#"{"linkLost":true}"#);
    let state = program.until("it is held", |state| holds(state, "robotLink"));
    assert!(holds(&state, "awaitingStart") && state["robots"][0]["unreached"].is_string(), "{state:#}");
    assert!(program.command("start").problem(409).contains("link"));
    let page = in_italian(&program);
    assert!(page.contains("simulatore: collegamento interrotto") && !page.contains("keeps it lost"), "{page}");
    change(&program, r#"{"linkLost":false,"speed":"max"}"#);
    let state = program.until("it is linked", |state| !holds(state, "robotLink"));
    assert!(holds(&state, "awaitingStart"), "the end of the cause alone sets nothing moving");
    program.command("start").accepted();
    program.until_phase("explored");
}

#[test]
fn a_camera_that_fails_leaves_a_piece_without_a_photo_until_it_is_mended() {
    let program = Program::serve("airport", "max");
    change(&program, r#"{"cameraFails":true,"noThermometer":true}"#);
    let parts = |state: &Value| state["robots"][0]["parts"].as_array().cloned().unwrap_or_default();
    program.until("it has no thermometer", |state| !parts(state).contains(&json!("thermometer")));
    program.command("start").accepted();
    let id = program.until_asked();
    let photo = |state: &Value| state["luggage"].as_array().and_then(|all| all.iter().find(|piece| piece["id"] == id).cloned());
    let piece = photo(&program.json("state")).expect("it is there");
    assert_eq!(piece["photo"]["state"], "failed", "{piece}");
    assert!(program.verdict(id, "safe").problem(409).contains("no usable photo"));
    let page = in_italian(&program);
    assert!(page.contains("otturatore") && !page.contains("shutter"), "{page}");
    change(&program, r#"{"cameraFails":false,"noThermometer":false}"#);
    program.post(&format!("/api/v1/luggage/{id}/photo"), "").accepted();
    program.until("it has a photo", |state| photo(state).is_some_and(|piece| piece["photo"]["state"] == "taken"));
    program.until("it has its thermometer", |state| parts(state).contains(&json!("thermometer")));
}

#[test]
fn a_blocked_way_is_an_obstacle_and_the_search_goes_round_it() {
    let program = Program::serve("empty-8x8", "max");
    change(&program, r#"{"blocked":[{"x":0,"y":3},{"x":4,"y":4}]}"#);
    program.command("start").accepted();
    let state = program.until_phase("explored");
    let rows = state["map"]["rows"].as_array().expect("rows");
    // The outer walls are the first row and the first column.
    let mark = |x: usize, y: usize| rows[y + 1].as_str().map(|row| row[x + 1..=x + 1].to_owned());
    assert_eq!((mark(0, 3), mark(4, 4), mark(4, 3)), (Some("X".into()), Some("X".into()), Some("1".into())), "{rows:?}");
    for (body, words) in [
        (r#"{"blocked":[{"x":99,"y":0}]}"#, "the cell (99, 0) cannot be blocked"),
        (r#"{"blocked":[{"x":0}]}"#, "`blocked` is"),
        (r#"{"speed":0}"#, "0.1 to 1000"),
        (r#"{"pause":true}"#, "has no field `pause`"),
    ] {
        assert!(program.put(SIMULATOR, body).problem(422).contains(words), "{body}");
    }
}

#[test]
fn another_hall_is_searched_while_no_mission_is_under_way_and_a_restart_goes_on_in_it() {
    let folder = Folder::new("simulator-hall");
    let serve = |hall: &str| {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", hall, "--speed", "max", "--data", folder.text()];
        Program::started(&mut hallsweep(&arguments))
    };
    let program = serve("airport");
    program.command("start").accepted();
    program.until_asked();
    let refused = program.put("/api/v1/simulator/hall", r#"{"name":"seed"}"#);
    assert_eq!(refused.json()["code"], "notInPhase");
    assert!(refused.problem(409).contains("let the mission end, or press RESET"));
    assert!(program.json("simulator")["bound"].is_string());
    let id = program.json("state")["luggage"][0]["id"].as_u64().expect("a piece");
    program.command("stop").accepted();
    program.verdict(id, "safe").accepted();
    program.until("it stands", |state| state["robot"]["state"] == "stopped" && state["robot"]["halting"] == false);
    program.command("reset").accepted();

    put_down(&program, LONG);
    let state = program
        .until("it is there", |state| !holds(state, "robotLink") && says(state, "put down in the hall corridor, by operator"));
    assert_eq!((&state["robot"]["position"], &state["mission"]["phase"]), (&json!({"x":0,"y":0}), &json!("idle")));
    assert_eq!(program.json("simulator")["hall"]["name"], "corridor");
    program.command("start").accepted();
    let explored = program.until_phase("explored");
    assert_eq!(explored["mission"]["progress"]["visited"], 20);
    program.killer()();
    drop(program);

    let program = serve("airport");
    let state = program.until("it is linked", |state| !holds(state, "robotLink"));
    assert_eq!((&state["mission"]["phase"], &state["map"]["rows"]), (&json!("explored"), &explored["map"]["rows"]));
    assert_eq!(program.json("simulator")["hall"]["name"], "corridor", "it goes on in the hall that was chosen");
    put_down(&program, "name = \"small\"\nwidth = 2\nheight = 2\n");
    program.command("start").accepted();
    assert_eq!(program.until_phase("explored")["mission"]["progress"]["visited"], 4);
    drop(program);

    let program = serve("seed-9x8");
    assert_eq!(program.json("simulator")["hall"]["name"], "seed-9x8", "the settings name another hall now: they hold");
}

#[test]
fn a_hall_is_kept_under_a_name_over_a_restart_until_it_is_discarded() {
    const HALLS: &str = "/api/v1/simulator/halls";
    let folder = Folder::new("kept-halls");
    let serve = || {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", folder.text()];
        Program::started(&mut hallsweep(&arguments))
    };
    let program = serve();
    let keep =
        |program: &Program, name: &str, file: &str| program.send("PUT", &format!("{HALLS}/{name}"), "application/toml", file);
    for (name, file, status, words) in [
        ("Mine", LONG, 422, "small letters, digits"),
        ("..%2F..%2Fmine", LONG, 422, "small letters, digits"),
        ("airport", LONG, 409, "another name"),
        ("mine", "width = 0\n", 422, "mine.toml:1"),
        ("mine", "width = 251\nheight = 2\n", 422, "too large"),
        ("mine", &"#".repeat(70_000), 413, "larger than 65536 bytes"),
    ] {
        assert!(keep(&program, name, file).problem(status).contains(words), "{name}");
    }
    assert_eq!(program.json("simulator")["keptHalls"], json!([]));
    let kept = keep(&program, "corridor-2", LONG);
    assert_eq!((kept.status, &kept.json()["keptHalls"]), (200, &json!(["corridor-2"])), "{}", kept.text());
    program.until("it is on record", |state| says(state, "simulator keeps the hall corridor-2, by operator"));
    assert!(in_italian(&program).contains("simulatore: conservata la sala corridor-2"));
    program.killer()();
    drop(program);

    let program = serve();
    let text = program.read(&format!("{HALLS}/corridor-2"), &[]).text();
    assert!(text.contains("S.........") && text.contains("name = \"corridor-2\""), "{text}");
    assert_eq!(program.put("/api/v1/simulator/hall", r#"{"name":"corridor-2"}"#).status, 200);
    program.command("start").accepted();
    assert_eq!(program.until_phase("explored")["mission"]["progress"]["visited"], 20);
    let discard = |name: &str| program.delete(&format!("{HALLS}/{name}"));
    assert_eq!((discard("corridor-2").status, discard("corridor-2").status, discard("airport").status), (200, 404, 404));
    assert_eq!(program.json("simulator")["keptHalls"], json!([]));
    assert_eq!(program.read(&format!("{HALLS}/corridor-2"), &[]).status, 404);
    let page = in_italian(&program);
    assert!(
        page.contains("simulatore: eliminata la sala corridor-2") && page.contains("robot messi nella sala corridor-2"),
        "{page}"
    );
}

/// Repeated, because the fault depended on timing.
#[test]
fn right_after_another_hall_was_chosen_start_is_not_refused() {
    let program = Program::serve("airport", "max");
    // A hall without luggage, at which the robot would stop by itself.
    let choose =
        |seed: u32| program.put("/api/v1/simulator/hall", &json!({ "name": "empty-8x8", "seed": seed }).to_string()).status;
    for seed in 0..30 {
        assert_eq!(choose(seed), 200);
        program.command("start").accepted();
        program.command("stop").accepted();
        program.until("it stands", |state| state["robot"]["state"] == "stopped" && state["robot"]["halting"] == false);
        program.command("reset").accepted();
    }
    assert_eq!(program.put("/api/v1/simulator", r#"{"linkLost":true}"#).status, 200);
    assert_eq!(choose(30), 200, "one that is kept from saying where it stands is not waited for");
    assert!(program.command("start").problem(409).contains("cannot be reached"));
}

#[test]
fn a_hall_that_cannot_be_kept_is_said_so() {
    let folder = Folder::new("unkept-halls");
    std::fs::create_dir_all(folder.text()).expect("a folder");
    std::fs::write(std::path::Path::new(folder.text()).join("halls"), "no folder").expect("a file");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", folder.text()];
    let program = Program::started(&mut hallsweep(&arguments));
    let refused = program.send("PUT", "/api/v1/simulator/halls/mine", "application/toml", LONG);
    assert_eq!((refused.status, &refused.json()["code"]), (503, &json!("cannotChangeKept")));
    let without = Program::serve("airport", "max");
    let refused = without.send("PUT", "/api/v1/simulator/halls/mine", "application/toml", LONG);
    assert!(refused.problem(409).contains("only in a data folder"));
}

#[test]
fn halls_of_every_format_are_read_over_the_wire_and_nonsense_is_refused_in_words() {
    let program = Program::serve("empty-8x8", "max");
    let check = |name: &str, file: &str| {
        program.send("POST", &format!("/api/v1/simulator/hall/check?name={name}"), "application/octet-stream", file)
    };
    let yaml = "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n...\n\
                P2 3 1 255\n254 254 0\n";
    let scene = "const config = { floor: { size: { x: 35, y: 35 } }, player: { position: { x: .08, y: .08 }, speed: .2 } };\n\
                 export default config;\n";
    for (name, file, width) in [
        ("m.toml", LONG, 10),
        ("m.map", "type octile\nheight 1\nwidth 3\nmap\n..T\n", 3),
        ("m.yaml", yaml, 3),
        ("room.js", scene, 9),
    ] {
        let read = check(name, file);
        assert_eq!((read.status, &read.json()["width"]), (200, &json!(width)), "{name}: {}", read.text());
        put_down(&program, read.json()["toml"].as_str().expect("a hall file"));
        assert_eq!(program.json("simulator")["hall"]["width"], width, "{name}");
    }
    let walled = check("m.toml", "drawing = \"\"\"\nS.#T\n\"\"\"\n").json();
    assert_eq!((&walled["findings"][0]["column"], &walled["findings"][0]["row"]), (&json!(3), &json!(0)), "{walled}");
    for (name, file, words) in [
        ("m.toml", "drawing = \"\"\"\n...\n\"\"\"\n", "m.toml:1: there is no start"),
        ("m.js", "nonsense", "m.js:1: "),
        ("m.toml", "\u{0}\u{1}", "m.toml:1: "),
    ] {
        assert!(check(name, file).problem(422).contains(words), "{name}");
    }
    let large = "#".repeat(70_000);
    for (method, path) in
        [("POST", "/api/v1/simulator/hall/check"), ("PUT", "/api/v1/simulator/hall"), ("POST", "/simulator/editor")]
    {
        let answer = program.send(method, path, "application/json", &large);
        assert!(answer.problem(413).contains("the hall is larger than 65536 bytes"), "{path}");
        let huge = format!("{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n", 10 << 20);
        assert!(raw(&program, &huge).starts_with("HTTP/1.1 413"), "{path}: before any of it has come");
    }
    assert_eq!(program.read("/api/v1/simulator/halls/%FF", &[]).json()["code"], "notFound");
    assert!(program.put("/api/v1/simulator/hall", r#"{"name":"../../etc/passwd"}"#).problem(422).contains("; it has airport"));
    assert_eq!(program.read("/api/v1/simulator/halls/nowhere", &[]).status, 404);
    let wide = json!({ "toml": "width = 251\nheight = 2\n" });
    let refused = program.put("/api/v1/simulator/hall", &wide.to_string());
    assert!(refused.problem(422).contains("251 × 2 cells is too large"));
    assert!(check("m.map", "type octile\nheight 1\nwidth 300\nmap\n").status == 422);
    let wide = format!("type octile\nheight 1\nwidth 300\nmap\n{}\n", ".".repeat(300));
    assert!(check("m.map", &wide).problem(422).contains("300 × 1 cells is too large"));
    // A hall of the maximum size is accepted whole, also through the form of the editor.
    let walls = format!("drawing = \"\"\"\nS{}\n{}\"\"\"\n", "#".repeat(249), format!("{}\n", "#".repeat(250)).repeat(249));
    let part = |name: &str, text: &str| format!("--parted\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n{text}\r\n");
    let form = |parts: &[(&str, &str)]| {
        let parts: String = parts.iter().map(|(name, text)| part(name, text)).collect();
        program.send("POST", "/simulator/editor", "multipart/form-data; boundary=parted", &format!("{parts}--parted--\r\n"))
    };
    let used = form(&[("toml", &walls.replace('\n', "\r\n")), ("act", "check")]);
    assert!(used.status == 200 && used.text().contains("no luggage"), "{}", used.status);
    for bad in [&[("act", "check"), ("act", "use")][..], &[("toml", &"#".repeat(66_000)), ("act", "check")]] {
        assert!([413, 422].contains(&form(bad).status));
    }
    assert_eq!(
        program.send("POST", "/simulator/editor", "multipart/form-data; boundary=parted", "--parted\r\nrubbish").status,
        422
    );
    let wide = format!("drawing = \"\"\"\nS{}\n{}\"\"\"\n", "#".repeat(249), format!("{}\n", ".".repeat(250)).repeat(249));
    put_down(&program, &wide);
    assert_eq!(program.json("simulator")["hall"]["height"], 250);
}

/// Of several clients that save under a new name at once, exactly one succeeds without a question about overwriting.
#[test]
fn of_many_who_keep_different_halls_under_one_new_name_at_once_one_is_let() {
    let folder = Folder::new("kept-at-once");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", folder.text()];
    let program = Program::started(&mut hallsweep(&arguments));
    for round in 0..5 {
        let keep = |n: usize| {
            let form = format!("act=keep&name=new-{round}&toml=width+%3D+{}%0Aheight+%3D+2%0A", n + 2);
            program.send("POST", "/simulator/editor", "application/x-www-form-urlencoded", &form).status
        };
        let answers: Vec<u16> = std::thread::scope(|scope| {
            let pressing: Vec<_> = (0..8).map(|n| scope.spawn(move || keep(n))).collect();
            pressing.into_iter().map(|press| press.join().expect("it is answered")).collect()
        });
        assert_eq!(answers.iter().filter(|status| **status == 409).count(), 7, "{answers:?}");
    }
}

/// Answer to a check of this file, compressed with gzip.
fn packed(program: &Program, name: &str, file: &[u8]) -> String {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(file).expect("memory takes it");
    let body = packer.finish().expect("memory takes it");
    let length = body.len();
    let head = format!(
        "POST /api/v1/simulator/hall/check?name={name} HTTP/1.1\r\nHost: localhost\r\nContent-Encoding: gzip\r\n\
         Content-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.write_all(&[head.as_bytes(), &body].concat()).expect("it takes the request");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("it answers");
    String::from_utf8_lossy(&answer).into_owned()
}

/// ROS maps are images of hundreds of kilobytes, so they may be compressed. A small file may also expand to a very
/// large one.
#[test]
fn a_large_image_comes_packed_and_what_unpacks_without_end_is_refused() {
    let program = Program::serve("empty-8x8", "max");
    let yaml = |resolution: f64| {
        format!(
            "image: m.pgm\nresolution: {resolution}\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n...\n"
        )
    };
    let image = |side: usize| [format!("P5 {side} {side} 255\n").into_bytes(), vec![254; side * side]].concat();
    let fine = packed(&program, "depot.yaml", &[yaml(0.05).as_bytes(), &image(421)].concat());
    assert!(fine.starts_with("HTTP/1.1 200") && fine.contains("\"pieces\":0"), "{fine}");
    let many = packed(&program, "depot.yaml", &[yaml(0.5).as_bytes(), &image(1900)].concat());
    assert!(many.starts_with("HTTP/1.1 422") && many.contains("1900 × 1900 cells is too large"), "{many}");
    let endless = packed(&program, "m.toml", &vec![b'#'; 60 << 20]);
    assert!(endless.starts_with("HTTP/1.1 413") && endless.contains("unpacked"), "{endless}");
    let broken = program.read("/api/v1/simulator", &[]);
    assert_eq!(broken.status, 200, "it is there still");
}

/// The figures of an old mission use the hall and the limit of that mission, not the current ones.
#[test]
fn an_old_mission_is_shown_in_the_hall_and_under_the_limit_of_then() {
    let folder = Folder::new("conditions");
    let serve = |hall: &str, threshold: &str| {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", hall, "--speed", "max", "--data", folder.text()];
        Program::started(hallsweep(&arguments).env("HALLSWEEP__TEMPERATURE__THRESHOLD_CELSIUS", threshold))
    };
    let moment = |program: &Program, mission: u64, is_hot: bool| {
        let conditions = program.json(&format!("missions/{mission}"))["conditions"].clone();
        assert_eq!(program.json(&format!("missions/{mission}/moment"))["conditions"], conditions);
        let last = program.json(&format!("missions/{mission}/moment"))["seq"].as_u64().expect("an entry");
        let page = program.read(&format!("/missions/{mission}/moment?at={last}"), &[("accept", "text/html")]).text();
        assert_eq!(page.contains("too high: nothing moves"), is_hot, "{page}");
        (conditions, page)
    };
    let program = serve("empty-8x8", "40");
    program.command("start").accepted();
    program.until_phase("explored");
    program.put("/api/v1/temperature", r#"{"celsius":30}"#).accepted();
    let robots = json!(["discovery", "srm1", "srm2"].map(|name| json!({"name":name,"kind":"sim"})));
    let seed = program.json("simulator")["seed"].clone();
    let before = json!({"hall":"empty-8x8","cellM":0.5,"threshold":40.0,"reach":[64,64],"robots":robots,"seed":seed});
    assert_eq!(moment(&program, 1, false).0, before);
    program.put("/api/v1/temperature", r#"{"celsius":20}"#).accepted();
    put_down(&program, "name = \"wide\"\ncell_m = 2.0\nwidth = 2\nheight = 2\n");
    program.until("it is there", |state| !holds(state, "robotLink"));
    program.command("start").accepted();
    program.until_phase("explored");
    program.killer()();
    drop(program);

    let program = serve("empty-8x8", "19");
    let (conditions, page) = moment(&program, 1, false);
    assert!(
        conditions == before && page.contains("64 cells, 16.0 m²") && page.contains("</span> empty-8x8</h1>"),
        "{conditions}: {page}"
    );
    let first = program.read("/missions/2/moment", &[("accept", "text/html")]).text();
    assert!(first.contains("</span> wide</h1>") && first.contains("limit 40.0 °C"), "when it began: {first}");
    let (conditions, page) = moment(&program, 2, true);
    let now = json!({"hall":"wide","cellM":2.0,"threshold":19.0,"reach":[4,4],"robots":robots,"seed":seed});
    assert_eq!(conditions, now, "since the restart");
    assert!(page.contains("4 cells, 16.0 m²") && page.contains("</span> wide</h1>"), "{page}");
}

/// The areas of the simulated hall are on record with the mission. Another hall brings its own.
#[test]
fn a_mission_has_the_areas_of_its_hall() {
    let program = Program::serve("empty-8x8", "max");
    let areas = |mission: u64| program.json(&format!("missions/{mission}"))["conditions"]["areas"].clone();
    program.command("start").accepted();
    program.until_phase("explored");
    assert_eq!(areas(1), Value::Null, "a hall without areas");
    let area = "[[area]]\nname = \"gate 1\"\nprobability = 0.4\ncorners = [[0, 0], [1, 1]]\n";
    put_down(&program, &format!("drawing = \"\"\"\n.S.\n...\n\"\"\"\n{area}"));
    program.command("start").accepted();
    program.until_phase("explored");
    assert_eq!(areas(2), json!([{"name":"gate 1","probability":0.4,"corners":[[-1,0],[0,1]]}]));
    let hall = program.read("/api/v1/simulator/hall", &[]).text();
    assert!(hall.contains(area), "{hall}");
    let wrong = hall.replace("[1, 1]", "[3, 1]");
    let refused = program.put("/api/v1/simulator/hall", &json!({ "toml": wrong }).to_string());
    assert!(refused.problem(422).contains("the corner (3, 1) is outside the hall"), "it names the corner as in the file");
}

#[test]
fn where_the_robot_is_not_simulated_there_is_no_simulator() {
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--robot", "virtual-tcp=127.0.0.1:9"]);
    let program = Program::started(&mut command);
    let answer = program.read(SIMULATOR, &[]);
    assert_eq!(answer.json()["code"], "notSimulated");
    assert!(answer.problem(404).contains("not simulated"));
    let page = program.read("/simulator", &[("accept", "text/html")]);
    assert!(page.status == 404 && page.text().contains("not simulated"));
}
