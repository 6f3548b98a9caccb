//! A whole mission that one client commands and observes. The last observed state is the real state.

use serde_json::Value;

use super::ask::Ask;
use super::client::Client;
use super::observer::{Observer, items, values};
use super::{JSON, TEXT, door, serve, shown};
use crate::program::Program;

/// One piece is safe, the next is dangerous, and the robot returns home. Five processes observe: one
/// `/resourcemodel`, and four a JSON resource each.
fn a_bomb_is_found(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = serve("airport", "max");
    let door = door(&program);
    let model = Observer::start(client, &door, Ask::get("/resourcemodel"));
    let [mission, robot, map, temperature] = ["/mission", "/robot", "/map", "/temperature"].map(|path| {
        let observer = Observer::start(client, &door, Ask::get(path).accept(JSON));
        (path.trim_start_matches('/'), observer)
    });

    client.ask(&door, &Ask::post("/commands/start", "{}").labelled(JSON)).accepted();
    let first = waits_for_a_verdict(&model, 1);
    assert_eq!(first, program.until_asked());
    let verdict = format!("/luggage/{first}/verdict");
    client.ask(&door, &Ask::post(&verdict, "{\"verdict\":\"safe\"}").labelled(JSON)).accepted();
    client.ask(&door, &Ask::put("/temperature", "{\"celsius\":19.5}").labelled(JSON)).accepted();
    let second = waits_for_a_verdict(&model, first + 1);
    assert_eq!(second, program.until_asked());
    client.ask(&door, &Ask::put("/resourcemodel", "danger").labelled(TEXT)).accepted();
    mission.1.until_json("the bomb is located", |seen| seen["phase"] == "bombLocated");

    program.until_phase("bombLocated");
    for (name, observer) in [mission, robot, map, temperature] {
        observer.until_json(&format!("{name} is as it stands"), |seen| *seen == program.json("state")[name]);
        observer.end();
    }
    shows_what_stands(&model, &program);
    model.end();
}

/// Waits until `/resourcemodel` shows a piece with at least this number, and returns the number of that piece.
fn waits_for_a_verdict(model: &Observer, least: u64) -> u64 {
    let number = |item: &str| item.split(['\'', ' ', ',']).find_map(|word| word.parse().ok());
    let item = model.until_item("luggage( ", "a piece is found", |item| number(item).is_some_and(|found: u64| found >= least));
    number(&item).expect("it was there just now")
}

/// Fails unless the last item of each kind matches the current state byte for byte.
fn shows_what_stands(model: &Observer, program: &Program) {
    let state = program.json("state");
    let (robot, map, luggage) = (shown::robot(&state), shown::map(program), shown::luggage(&state));
    model.until_item("robot( ", "the robot is where it stands", |item| item == robot);
    model.until_item("roomMap( ", "the map is as it stands", |item| item == map);
    model.until_item("luggage( ", "the last piece is the last one", |item| item == luggage);
    let seen = items(&model.text());
    assert!(seen.len() > 6, "it saw the search, not only its end: {seen:?}");
}

#[test]
fn libcoap_sees_a_whole_mission() {
    a_bomb_is_found(Client::Libcoap);
}

#[test]
fn aiocoap_sees_a_whole_mission() {
    a_bomb_is_found(Client::Aiocoap);
}

#[test]
fn coap_cli_sees_a_whole_mission() {
    a_bomb_is_found(Client::CoapCli);
}

/// The whole state is larger than a datagram. A notification carries the first block, and the client fetches the
/// rest.
fn everything_is_safe(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = serve("seed", "max");
    let door = door(&program);
    let luggage = Observer::start(client, &door, Ask::get("/luggage").accept(JSON));
    let state = Observer::start(client, &door, Ask::get("/state").accept(JSON));
    client.ask(&door, &Ask::post("/commands/start", "{}").labelled(JSON)).accepted();
    for found in 1..=3 {
        let pending = |piece: &&Value| piece["verdict"] == "pending";
        let seen = luggage.until_json("a piece waits for its verdict", |seen| {
            seen.as_array().is_some_and(|all| all.len() == found && all.iter().any(|piece| pending(&piece)))
        });
        let piece = seen.as_array().and_then(|all| all.iter().find(pending)).expect("it was there just now");
        let verdict = format!("/luggage/{}/verdict", piece["id"]);
        client.ask(&door, &Ask::put(&verdict, "{\"verdict\":\"safe\"}").labelled(JSON)).accepted();
    }
    program.until_phase("explored");
    state.until_json("the hall is explored", |seen| *seen == shown::state(program.json("state")));
    luggage.until_json("all is safe", |seen| *seen == shown::state(program.json("state"))["luggage"]);
    state.end();
    luggage.end();
}

#[test]
fn libcoap_observes_the_whole_state_through_a_mission() {
    everything_is_safe(Client::Libcoap);
}

#[test]
fn aiocoap_observes_the_whole_state_through_a_mission() {
    everything_is_safe(Client::Aiocoap);
}

/// The map of this hall takes more than one block as an item. The later blocks must belong to the same map, even if
/// another item changed in the meantime.
fn a_large_model(client: Client) {
    if !client.is_here() {
        return;
    }
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("wide-{client:?}-{}.toml", std::process::id()));
    let row = ".".repeat(60);
    let hall = format!("name = \"wide\"\ndrawing = \"\"\"\nS{}\n{}\"\"\"\n", &row[1..], format!("{row}\n").repeat(10));
    std::fs::write(&file, hall).expect("a folder of our own");
    let program = serve(&file.display().to_string(), "max");
    let door = door(&program);
    let model = Observer::start(client, &door, Ask::get("/resourcemodel"));
    client.ask(&door, &Ask::post("/commands/start", "{}").labelled(JSON)).accepted();
    program.until_phase("explored");
    let map = shown::map(&program);
    assert!(map.len() > 1024, "{map}");
    model.until_item("roomMap( ", "the map is as it stands", |item| item == map);
    model.end();
    std::fs::remove_file(file).expect("it is ours");
}

#[test]
fn libcoap_observes_a_map_of_several_blocks() {
    a_large_model(Client::Libcoap);
}

#[test]
fn aiocoap_observes_a_map_of_several_blocks() {
    a_large_model(Client::Aiocoap);
}

/// Sprint 3 of the seed: START and STOP on the page change the resource, and the page shows the same state.
#[test]
fn start_and_stop_on_the_page_change_what_is_observed() {
    super::with_each(|client| {
        let program = serve("empty-8x8", "4");
        let door = door(&program);
        let model = Observer::start(client, &door, Ask::get("/resourcemodel"));
        program.press("/startappl").accepted();
        model.until_item("robot( ", "it moves", |item| item.contains("state(movingForward)"));
        program.press("/stopappl").accepted();
        let state = program.until("it stands", |state| state["robot"]["state"] == "stopped");
        let robot = shown::robot(&state);
        model.until_item("robot( ", "it stands where the page shows it", |item| item == robot);
        model.end();
    });
}

/// A client that ended its observation receives nothing more, and the robot continues.
#[test]
fn an_observer_that_goes_away_is_not_missed() {
    super::with_each(|client| {
        let program = serve("empty-8x8", "4");
        let door = door(&program);
        let gone = Observer::start(client, &door, Ask::get("/robot").accept(JSON));
        gone.end();
        let stays = Observer::start(client, &door, Ask::get("/robot").accept(JSON));
        client.ask(&door, &Ask::post("/commands/start", "{}").labelled(JSON)).accepted();
        stays.until("it has moved for a while", |text| values(text).len() > 10);
        stays.end();
    });
}
