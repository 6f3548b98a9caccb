//! Every resource in each of its formats, read by three clients and compared with the HTTP interface at the same
//! moment.

use super::ask::Ask;
use super::client::Client;
use super::{CBOR, ETAG, JSON, LINKS, SENML, TEXT, door, serve, shown, with_each};

/// Current ETag of a resource, read with libcoap's command, which can print options.
pub(super) fn tag(door: &str, path: &str) -> Vec<u8> {
    let mut command = Client::Libcoap.command(door, &Ask::get(path).in_blocks_of(1024));
    let output = Client::Libcoap.finish(command.args(["-v", "6", "-o", "/dev/null"]));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let hex = printed.split("ETag:0x").nth(1).and_then(|rest| rest.split(|letter: char| !letter.is_ascii_hexdigit()).next());
    let hex = hex.unwrap_or_else(|| panic!("no tag: {printed}"));
    (0..hex.len()).step_by(2).map(|place| u8::from_str_radix(&hex[place..place + 2], 16).expect("hexadecimal")).collect()
}

#[test]
fn every_client_reads_what_the_http_door_shows() {
    let program = serve("seed", "max");
    let door = door(&program);
    program.command("start").accepted();
    let piece = program.until_asked();
    let state = shown::state(program.json("state"));
    let map = program.read("/api/v1/map", &[("accept", "text/plain")]).text();
    with_each(|client| {
        let get = |path: &str, format: u16| client.ask(&door, &Ask::get(path).accept(format));
        assert_eq!(get("/state", JSON).json(), state, "{client:?}");
        for name in ["mission", "robot", "map", "temperature"] {
            assert_eq!(get(&format!("/{name}"), JSON).json(), state[name], "{client:?} /{name}");
        }
        assert_eq!(get("/luggage", JSON).json(), state["luggage"], "{client:?}");
        assert_eq!(get(&format!("/luggage/{piece}"), JSON).json(), state["luggage"][0], "{client:?}");
        assert_eq!(get("/map", TEXT).text(), map, "{client:?}");
        let robot = get("/robot", CBOR);
        assert!(
            robot.content()[0] >> 5 == 5 && robot.content().windows(7).any(|word| word == b"heading"),
            "a CBOR map: {robot:?}"
        );
        // coap-cli does not know the SenML format and cannot read an answer in it.
        if client != Client::CoapCli {
            let temperature = get("/temperature", SENML).json();
            let celsius = &state["temperature"]["celsius"];
            assert_eq!((&temperature[0]["u"], &temperature[0]["v"]), (&"Cel".into(), celsius), "{temperature}");
        }
        let model = client.ask(&door, &Ask::get("/resourcemodel"));
        let items = [shown::robot(&state), shown::map(&program), shown::luggage(&state)];
        assert!(items.contains(&model.text().to_owned()), "{client:?}: {model:?}");
    });
}

#[test]
fn every_client_reads_why_there_is_nothing() {
    let program = serve("empty-8x8", "max");
    let door = door(&program);
    with_each(|client| {
        client.ask(&door, &Ask::get("/state").accept(LINKS)).refused("4.06", "application/json");
        client.ask(&door, &Ask::get("/luggage/7")).refused("4.04", "7");
        client.ask(&door, &Ask::get("/nowhere")).refused("4.04", "/nowhere");
        client.ask(&door, &Ask { method: "delete", path: "/state", ..Ask::default() }).refused("4.05", "");
    });
}

#[test]
fn every_client_reads_without_confirmation() {
    let program = serve("empty-8x8", "max");
    let door = door(&program);
    let state = program.until("the robot is there", |state| state["mission"]["holds"] == serde_json::json!([]));
    with_each(|client| {
        assert_eq!(client.ask(&door, &Ask::get("/state").accept(JSON).non()).json(), state, "{client:?}");
    });
}

#[test]
fn whoever_has_what_stands_is_told_so() {
    if !Client::Libcoap.is_here() {
        return;
    }
    let program = serve("empty-8x8", "max");
    let door = door(&program);
    program.until("the robot is there", |state| state["mission"]["holds"] == serde_json::json!([]));
    let tag = tag(&door, "/map");
    with_each(|client| {
        let reply = client.ask(&door, &Ask::get("/map").with(ETAG, &tag));
        assert!(reply.body.is_empty(), "2.03 carries nothing: {reply:?}");
        let reply = client.ask(&door, &Ask::get("/map").with(ETAG, b"another"));
        assert!(!reply.content().is_empty(), "{reply:?}");
    });
}

/// Every link leads to a resource, and each filter returns the expected links.
#[test]
fn every_client_finds_what_there_is() {
    let program = serve("empty-8x8", "max");
    let door = door(&program);
    with_each(|client| {
        let links = |query: &str| {
            let reply = client.ask(&door, &Ask::get(&format!("/.well-known/core{query}")));
            let targets =
                reply.text().split(",<").map(|link| link.trim_start_matches('<').split('>').next().unwrap_or("").to_owned());
            targets.filter(|target| !target.is_empty()).collect::<Vec<String>>()
        };
        let all = links("");
        for path in ["/resourcemodel", "/state", "/robot", "/map", "/luggage", "/temperature", "/mission"] {
            assert!(all.iter().any(|target| target == path), "{client:?} finds no {path}: {all:?}");
            let reply = client.ask(&door, &Ask::get(path));
            assert!(!reply.content().is_empty(), "{client:?} {path}");
            assert_eq!(links(&format!("?href={path}")), [path], "{client:?}");
        }
        let commands = links("?href=/commands/*");
        assert!(commands.iter().any(|target| target == "/commands/start"), "{commands:?}");
        assert!(commands.iter().all(|target| target.starts_with("/commands/")), "{commands:?}");
        let observable = links("?obs");
        assert!(
            observable.contains(&"/state".to_owned()) && !observable.contains(&"/commands/start".to_owned()),
            "{observable:?}"
        );
        assert!(links(&format!("?ct={SENML}")).contains(&"/temperature".to_owned()));
        assert!(links("?rt=nothing-of-this-kind").is_empty());
    });
}
