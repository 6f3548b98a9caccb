//! Tests for scenes and for the halls made from them.

use proptest::prelude::*;

use super::*;
use crate::hall::{Export, Format, Hall, Truth};

const EMPTY: &str = include_str!("../../../../../config/scenes/empty-35x35.js");
const THREE_BAGS: &str = include_str!("../../../../../config/scenes/three-bags.js");

fn scene(text: &str) -> Scene {
    Scene::parse("room.js", text.as_bytes()).expect("a good scene")
}

/// A scene with a floor of these sides, the player in its middle, and these obstacles.
fn room(x: f64, y: f64, statics: &str) -> Scene {
    let player = "player: {position: {x: .5, y: .5}}";
    scene(&format!("x = {{floor: {{size: {{x: {x}, y: {y}}}}}, {player}, staticObstacles: [{statics}]}}"))
}

fn obstacle(name: &str, (x, y): (f64, f64), (width, height): (f64, f64)) -> String {
    format!("{{name: '{name}', centerPosition: {{x: {x}, y: {y}}}, size: {{x: {width}, y: {height}}}}},")
}

fn drawn(hall: &Hall) -> String {
    let letter = |truth: &Truth| match truth {
        Truth::Free => '.',
        Truth::Wall => '#',
        Truth::Luggage(piece) => char::from_digit(piece.0, 36).unwrap_or('?'),
    };
    hall.rows().map(|row| row.iter().map(letter).collect::<String>()).collect::<Vec<_>>().join("/")
}

#[test]
fn positions_are_told_from_the_middle_of_the_floor_and_obstacles_from_the_south() {
    let scene = scene(THREE_BAGS);
    assert_eq!(scene.floor, Floor { x: 35.0, z: 35.0 });
    assert!((scene.player.x + 14.7).abs() < 1e-9 && (scene.player.z + 14.7).abs() < 1e-9, "{:?}", scene.player);
    let up = scene.statics.iter().find(|thing| thing.name == "wallUp").expect("it is there");
    assert!((up.min_z + 17.5).abs() < 1e-9 && (up.max_z + 17.15).abs() < 1e-9 && up.is_wall(), "{up:?}");
    assert_eq!((scene.moving[0].along_x, scene.moving[0].along_z), (true, false));
    let sonar = &scene.sonars[0];
    assert!(sonar.z < -16.0 && sonar.sees_along_z && !sonar.sees_along_x, "it stands in the north: {sonar:?}");
}

#[test]
fn a_cell_takes_as_long_as_the_speed_of_the_player_says() {
    let step = |speed: &str| scene(&EMPTY.replace("speed: .2", speed)).step();
    assert_eq!(step("speed: .2"), Ok(std::time::Duration::from_secs(1) / 3));
    for wrong in ["", "speed: 0", "speed: -.2", "speed: 1.4", "speed: 0.01", "speed: 1e300"] {
        assert!(matches!(step(wrong), Err(HallFault::PlayerSpeed(_))), "{wrong}");
    }
}

#[test]
fn the_room_of_35_has_8_by_8_free_cells_and_the_player_in_its_north_west() {
    let HallOfScene { hall, lost } = scene(EMPTY).hall("room").expect("a hall");
    assert_eq!(drawn(&hall), ["........"; 8].join("/"));
    assert_eq!((hall.home(), hall.reachable().len()), (hallsweep_core::units::Cell::HOME, 64));
    assert_eq!(lost, [""; 0]);
}

#[test]
fn what_is_no_wall_is_a_box_where_the_page_shows_it() {
    let HallOfScene { hall, lost } = scene(THREE_BAGS).hall("room").expect("a hall");
    let expect = "......../......../...1..../......../......2./......../.33...../........";
    assert_eq!(drawn(&hall), expect, "{lost:?}");
    assert!(hall.pieces().iter().all(|bag| bag.name.ends_with(" box") && !bag.dangerous));
    assert_eq!(lost, ["the moving obstacles (1)", "the sonars of the hall (2)", "the names of luggage (3)"]);
    let written = Export::from(hall.clone()).written(Format::Toml, "room").expect("it is written");
    assert_eq!(Hall::parse("room.toml", &String::from_utf8(written.file).expect("text")), Ok(hall));
}

#[test]
fn a_contact_counts_at_the_border_of_what_is_kept_free() {
    // The middle of the next cell to the east is at 4. A box that begins at 6 keeps the player's middle at 4 or less,
    // so this cell is still free.
    let row = |from: f64| {
        let thing = obstacle("case", ((from + 1.0) / 20.0 + 0.5, 0.5), (0.1, 0.1));
        drawn(&room(20.0, 4.0, &thing).hall("row").expect("a hall").hall)
    };
    assert_eq!(row(6.0), "...1");
    assert_eq!(row(6.1), "....1");
    assert_eq!(drawn(&room(8.0, 4.0, "").hall("border").expect("a hall").hall), "...", "on the border it may stand");
}

#[test]
fn what_is_met_first_is_what_is_there() {
    let both = obstacle("wallRight", (0.85, 0.5), (0.1, 1.0)) + &obstacle("case", (0.8, 0.5), (0.1, 0.1));
    assert_eq!(drawn(&room(20.0, 4.0, &both).hall("row").expect("a hall").hall), "...1");
    let behind = obstacle("wallRight", (0.8, 0.5), (0.1, 1.0)) + &obstacle("case", (0.85, 0.5), (0.1, 0.1));
    let HallOfScene { hall, lost } = room(20.0, 4.0, &behind).hall("row").expect("a hall");
    assert_eq!((drawn(&hall).as_str(), lost), ("...", vec!["the obstacles that the robot cannot meet (1)".to_owned()]));
}

#[test]
fn one_name_is_one_piece_where_its_cells_touch() {
    let apart = obstacle("case", (0.1, 0.5), (0.05, 0.05)) + &obstacle("case", (0.9, 0.5), (0.05, 0.05));
    let HallOfScene { hall, lost } = room(20.0, 4.0, &apart).hall("row").expect("a hall");
    assert_eq!(drawn(&hall), "1...2");
    assert_eq!(lost, ["the names of luggage (2)", "which pieces of luggage had the same name (1)"]);
}

/// The module `cells` relies on this.
#[test]
fn nothing_is_so_thin_that_it_stands_between_two_free_cells() {
    for x in 0..=100 {
        let bar = obstacle("wall", (f64::from(x) / 400.0 + 0.61, 0.5), (0.0, 1.0));
        let hall = room(40.0, 20.0, &bar).hall("room").expect("a hall").hall;
        let end = drawn(&hall).split('/').next().map_or(0, str::len);
        assert!(end < 11, "it comes past the bar at {x}: {}", drawn(&hall));
    }
}

#[test]
fn a_player_that_stands_in_something_is_told_in_what() {
    let said = |scene: &Scene| scene.hall("x").expect_err("it stands in it").to_string();
    assert_eq!(
        said(&room(20.0, 20.0, &obstacle("case", (0.5, 0.5), (0.1, 0.1)))),
        "the player stands in \"case\": move one of them"
    );
    let mut outside = room(20.0, 20.0, "");
    outside.player.x = 10.1;
    assert_eq!(said(&outside), "the player stands in \"floor-border\": move one of them");
}

#[test]
fn what_is_wrong_with_a_scene_is_said_with_its_line() {
    let check = |text: &str, expect: &str| {
        let said = Scene::parse("room.js", text.as_bytes()).expect_err(text).to_string();
        assert!(said.starts_with(&format!("room.js:{expect}")), "{said}");
    };
    check("", "1: this file has no scene: a scene file contains `const config");
    check("\nx = {", "2: the object that begins here is not closed");
    check(&EMPTY.replace("speed: .2 }", "speed: .2 "), "2: the object that begins here is not closed: add its end");
    check(
        &EMPTY.replace("size: { x: 35", "size: { x: 1001"),
        "3: a side of the floor is 1001, but must be 4 to 1000: correct this line",
    );
    check(&EMPTY.replace("size: { x: 35", "size: { x: NaN"), "3: a side of the floor is NaN");
    check(&EMPTY.replace("speed: .2", "speed: Infinity"), "4: inf is not a finite number: correct this line");
    check(&EMPTY.replace("speed: .2", "speed: fast"), "4: expected number: correct this line");
    check(&EMPTY.replace("speed: .2", "speed: 1 / 5"), "4: a calculation is not allowed here: write its result, as .5 for 1/2");
    check(&EMPTY.replace("y: .08", "z: .08"), "4: missing field `y`: correct this line");
    check(&EMPTY.replace("x: .995", "x: 1e9"), "11: 1000000000 is not a fraction of the floor (about 0 to 1)");
    check(&EMPTY.replace("\"wallRight\"", "\"\""), "11: a name has 1 to 64 visible characters: correct this line");
    check(&EMPTY.replace("wallRight", "wall\u{202e}Right"), "11: a name has 1 to 64 visible characters");
    check(
        &EMPTY.replace("size: { x: .01", "size: { x: -.01"),
        "10: -0.01 is not a length (0 to 1 of the floor): correct this line",
    );
    check(&EMPTY.replace("    floor:", "    flor:"), "2: missing field `floor`: correct this line");
    let many = obstacle("case", (0.5, 0.5), (0.1, 0.1)).repeat(257);
    let too_many = Scene::parse("room.js", EMPTY.replace("icObstacles: [", &format!("icObstacles: [{many}")).as_bytes());
    let said = too_many.map(|scene| scene.statics.len()).expect_err("too many").to_string();
    assert!(said.starts_with("room.js:2: there are more than 256 sonars or obstacles of one kind"), "{said}");
    check(&format!("x = {}", "[{a:".repeat(20_000)), "1: ");
    check(&" ".repeat(MAX_SCENE_BYTES + 1), "1: this file is larger than 262144 bytes");
    let not_text = Scene::parse("room.js", b"x =\n\xff {}").expect_err("no UTF-8").to_string();
    assert!(not_text.starts_with("room.js:2: this file is not UTF-8 text"), "{not_text}");
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic_and_every_fault_has_a_line(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        if let Err(error) = Scene::parse("x.js", &bytes) {
            prop_assert!(error.line.is_some(), "{}", error);
        }
    }

    /// Random combinations of parts of scene files.
    #[test]
    fn whatever_is_said_of_a_scene_it_is_refused_or_a_hall(pieces in proptest::collection::vec(prop::sample::select(&[
        "x =", "{", "}", "[", "]", ",", "floor:", "size:", "x:", "y:", "35", ".5", "-1e9", "NaN", "'wall'", "//", "\n", "/*", "*/",
        "player:", "position:", "staticObstacles:", "name:", "centerPosition:", "é", "\\", "\"",
    ][..]), 0..60)) {
        match Scene::parse("x.js", pieces.concat().as_bytes()) {
            Ok(scene) => drop(scene.hall("x")),
            Err(error) => prop_assert!(error.line.is_some(), "{}", error),
        }
    }

    #[test]
    fn every_scene_that_is_read_is_a_hall_that_is_written_or_says_why_not(
        sides in (4.0..90.0, 4.0..90.0),
        places in proptest::collection::vec(((0.0..1.0, 0.0..1.0), (0.0..0.3, 0.0..0.3), any::<bool>()), 0..12),
    ) {
        let name = |is_wall: bool| if is_wall { "wall" } else { "case" };
        let things: String = places.into_iter().map(|(place, size, is_wall)| obstacle(name(is_wall), place, size)).collect();
        let scene = room(sides.0, sides.1, &things);
        let Ok(HallOfScene { hall, .. }) = scene.hall("x") else { return Ok(()) };
        let free = hall.rows().flatten().filter(|truth| **truth == Truth::Free).count();
        prop_assert_eq!(hall.reachable().len(), free, "it comes to every free cell");
        prop_assert!(Export::from(hall).written(Format::Toml, "x").is_ok());
    }
}
