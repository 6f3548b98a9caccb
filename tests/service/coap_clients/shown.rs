//! Expected output of the CoAP interface, derived from the output of the HTTP interface at the same moment.

use serde_json::Value;

use crate::program::Program;

/// Robot item, such as `robot( state(stopped), direction(downDir), position(0, 0))`.
pub(crate) fn robot(state: &Value) -> String {
    let robot = &state["robot"];
    let direction = match robot["heading"].as_str().expect("a heading") {
        "north" => "upDir",
        "east" => "rightDir",
        "south" => "downDir",
        "west" => "leftDir",
        other => panic!("no heading is called {other}"),
    };
    let (doing, position) = (robot["state"].as_str().expect("a state"), &robot["position"]);
    format!("robot( state({doing}), direction({direction}), position({}, {}))", position["x"], position["y"])
}

/// Map item, such as `roomMap( 'r 1 X @' )`. The source is the map as text, with a line such as `|r, 1, X, ` per row.
pub(crate) fn map(program: &Program) -> String {
    let text = program.read("/api/v1/map", &[("accept", "text/plain")]).text();
    let row = |line: &str| {
        let marks = line.trim_start_matches('|').split(',').map(str::trim).filter(|mark| !mark.is_empty());
        marks.map(|mark| format!("{mark} ")).collect::<String>() + "@"
    };
    format!("roomMap( '{}' )", text.lines().map(row).collect::<String>())
}

/// Item of the latest piece, such as `luggage( state( 'photo 1, position: (3, 3), date: …' ) )`.
pub(crate) fn luggage(state: &Value) -> String {
    let piece = state["luggage"].as_array().and_then(|all| all.last()).expect("a piece was found");
    let (cell, taken) = (&piece["cell"], piece["taken"].as_str().expect("a time"));
    format!("luggage( state( 'photo {}, position: ({}, {}), date: {taken}' ) )", piece["id"], cell["x"], cell["y"])
}

/// State as the CoAP interface writes it: photo paths start at the CoAP root and have no query, because the ETag
/// distinguishes the takes of a photo.
pub(crate) fn state(mut state: Value) -> Value {
    for piece in state["luggage"].as_array_mut().expect("a list") {
        let url =
            piece["photo"]["url"].as_str().map(|url| url.trim_start_matches("/api/v1").split('?').next().map(str::to_owned));
        piece["photo"]["url"] = url.flatten().into();
    }
    state
}
