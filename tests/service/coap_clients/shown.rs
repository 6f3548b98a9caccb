//! What `/resourcemodel` has to show, worked out from what the HTTP door shows at the same moment.

use serde_json::Value;

use crate::program::Program;

/// The robot's item, as `robot( state(stopped), direction(downDir), position(0, 0))`.
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

/// The map's item, as `roomMap( 'r 1 X @' )`, from the map as text, a line `|r, 1, X, ` a row.
pub(crate) fn map(program: &Program) -> String {
    let text = program.read("/api/v1/map", &[("accept", "text/plain")]).text();
    let row = |line: &str| {
        let marks = line.trim_start_matches('|').split(',').map(str::trim).filter(|mark| !mark.is_empty());
        marks.map(|mark| format!("{mark} ")).collect::<String>() + "@"
    };
    format!("roomMap( '{}' )", text.lines().map(row).collect::<String>())
}

/// What the item of the latest piece says of it: its number and the bag's cell.
pub(crate) fn luggage(state: &Value) -> String {
    let piece = state["luggage"].as_array().and_then(|all| all.last()).expect("a piece was found");
    format!("luggage( state( 'photo {}, position: ({}, {}), date: ", piece["id"], piece["cell"]["x"], piece["cell"]["y"])
}
