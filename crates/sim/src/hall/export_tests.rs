//! Tests that write halls and explored maps and read them again. They also contain a second implementation of the
//! rule by which `map_server` reads pixels.

use proptest::prelude::*;

use super::*;
use crate::bag::{BagKind, Colour};
use crate::headless::{Run, Verdicts, explore_and_tell};
use crate::{Camera, SimSettings};
use hallsweep_core::command::Strategy as SearchStrategy;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::Piece;

/// A hall that uses everything that a hall file can express.
const RICH: &str = r##"
name = "Gate \"7\""
description = """Two lines,
the second with a \\ in it."""
cell_m = 0.3
drawing = """
##..T
..S#a
bb.#a
..T..
"""
[[luggage]]
mark = "a"
kind = "trolley"
colour = "#010203"
dangerous = true
[[luggage]]
mark = "b"
kind = "box"
colour = "brown"
height_m = 0.33
[[area]]
name = 'Gate "7", north'
probability = 0.1
corners = [[4, 0], [0, 1], [4, 1]]
[[area]]
name = "belt"
probability = 1e-9
corners = [[4, 3], [0, 2]]
[[temperature]]
at_s = 0
celsius = 21.4
[[temperature]]
at_s = 600.5
celsius = -3
"##;

fn rich() -> Hall {
    Hall::parse("rich.toml", RICH).unwrap()
}

fn again(written: &WrittenHall, format: Format) -> Hall {
    let text = String::from_utf8(written.file.clone()).unwrap();
    match &written.image {
        Some(image) => Hall::parse_occupancy("again.yaml", &text, "again.pgm", image, None),
        None => Hall::parse(&format!("again.{}", format.extension()), &text),
    }
    .unwrap()
}

fn lost(hall: Hall, format: Format) -> Vec<String> {
    Export::from(hall).written(format, "again").unwrap().lost
}

#[test]
fn a_hall_file_loses_nothing() {
    let written = Export::from(rich()).written(Format::Toml, "other").unwrap();
    assert_eq!(written.lost, Vec::<String>::new());
    assert_eq!(again(&written, Format::Toml), rich());
    let words = Export::from(rich()).in_words();
    assert_eq!(words, "5 × 4 cells of 0.3 m, 4 pieces of luggage, 2 areas");
}

#[test]
fn every_built_in_hall_is_the_same_when_it_is_written_and_read() {
    for name in Hall::builtin_names() {
        let hall = Hall::named_or_file(name).unwrap();
        let written = Export::from(hall.clone()).written(Format::Toml, name).unwrap();
        assert_eq!((again(&written, Format::Toml), written.lost.len()), (hall, 0), "{name}");
    }
}

#[test]
fn what_other_formats_cannot_say_is_said() {
    let words = ["kind, colour or height of 3 pieces", "the danger of 1 piece"];
    let rest = ["the temperature", "the areas (2)", "the name", "the description"];
    let apart = "the shape of 2 pieces";
    let map = lost(rich(), Format::MovingAi);
    let start = "the start moves from column 3, row 2 to column 1, row 2";
    let cells = "cells of 0.3 m become cells of 0.5 m";
    assert_eq!(map, [&[start, apart, words[0], words[1], cells][..], &rest].concat());
    assert_eq!(lost(rich(), Format::Occupancy), [&[apart, words[0], words[1]][..], &rest].concat());
    assert_eq!(lost(rich(), Format::SeedText), [&["the luggage (4 pieces, now walls)", cells][..], &rest].concat());
    let plain = Hall::from_rows("again", &["S.T", ".T#"]).unwrap();
    for format in [Format::Toml, Format::MovingAi, Format::Occupancy] {
        assert_eq!(lost(plain.clone(), format), Vec::<String>::new(), "{format:?}");
    }
}

#[test]
fn when_letters_run_out_the_dangerous_and_the_long_keep_theirs_and_the_file_says_so() {
    let mut hall = Hall::from_rows("many", &[&format!("S{}", "T".repeat(30)), &format!(".{}", ".".repeat(30))]).unwrap();
    for bag in &mut hall.bags {
        (bag.kind, bag.colour, bag.height_m, bag.name) = (BagKind::Box, Colour::new(1, 2, 3), 0.4, "black box".into());
        bag.dangerous = bag.piece.0 > 27;
    }
    let written = Export::from(hall.clone()).written(Format::Toml, "many").unwrap();
    let text = String::from_utf8(written.file.clone()).unwrap();
    assert!(text.contains("# 4 pieces are drawn as T without their words, since there are only 26 letters."), "{text}");
    assert_eq!(written.lost, ["kind, colour or height of 4 pieces"]);
    let dangerous = |hall: &Hall| hall.pieces().iter().filter(|bag| bag.dangerous).count();
    assert_eq!(dangerous(&again(&written, Format::Toml)), dangerous(&hall));
    assert_eq!(text.matches("[[luggage]]").count(), 26);
}

#[test]
fn a_name_too_long_for_a_hall_file_is_left_out() {
    let hall = Hall::from_rows(&"n".repeat(65), &["S."]).unwrap();
    assert_eq!(lost(hall, Format::Toml), ["the name"]);
}

/// What `map_server` of ROS 2 (mode trinary, by its documentation) reads at a place of the world: occupied 100, free
/// 0, unknown −1. The place is in metres, `x` to the east and `y` to the north.
fn map_server(yaml: &str, pgm: &[u8], x: f64, y: f64) -> i8 {
    let value = |key: &str| yaml.lines().find_map(|line| line.strip_prefix(&format!("{key}: "))).unwrap().to_owned();
    let number = |key: &str| value(key).parse::<f64>().unwrap();
    let origin: Vec<f64> = value("origin").trim_matches(['[', ']']).split(", ").map(|part| part.parse().unwrap()).collect();
    assert_eq!((value("mode").as_str(), value("negate").as_str(), origin[2]), ("trinary", "0", 0.0));
    let header = pgm.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at).nth(2).unwrap() + 1;
    let words: Vec<String> = String::from_utf8_lossy(&pgm[..header]).split_whitespace().map(str::to_owned).collect();
    let [magic, width, height, most] = words.as_slice() else { panic!("{words:?}") };
    let (width, height): (i32, i32) = (width.parse().unwrap(), height.parse().unwrap());
    assert_eq!((magic.as_str(), most.as_str(), pgm.len() - header), ("P5", "255", (width * height) as usize));
    let column = ((x - origin[0]) / number("resolution")).floor() as i32;
    let from_south = ((y - origin[1]) / number("resolution")).floor() as i32;
    assert!((0..width).contains(&column) && (0..height).contains(&from_south), "({x}, {y}) is outside the map");
    let pixel = pgm[header + ((height - 1 - from_south) * width + column) as usize];
    let occ = (255.0 - f64::from(pixel)) / 255.0;
    if occ > number("occupied_thresh") {
        100
    } else if occ < number("free_thresh") {
        0
    } else {
        -1
    }
}

#[test]
fn map_server_finds_every_cell_where_the_robot_does() {
    let hall = rich();
    let written = Export::from(hall.clone()).written(Format::Occupancy, "rich").unwrap();
    let (yaml, image) = (String::from_utf8(written.file).unwrap(), written.image.unwrap());
    assert!(yaml.starts_with("image: rich.pgm\n"), "{yaml}");
    let bounds = hall.bounds();
    for y in bounds.least.y..=bounds.most.y {
        for x in bounds.least.x..=bounds.most.x {
            // Checks the centre of a cell and points just inside two of its corners.
            for off in [0.0, -0.149, 0.149] {
                let seen = map_server(&yaml, &image, f64::from(x) * 0.3 + off, f64::from(-y) * 0.3 + off);
                assert_eq!(seen == 0, hall.truth(Cell::new(x, y)) == Truth::Free, "({x}, {y})");
                assert!(seen != -1);
            }
        }
    }
}

#[test]
fn an_image_file_is_named_so_that_yaml_reads_it() {
    let yaml = |stem: &str| String::from_utf8(Export::from(rich()).file(Format::Occupancy, stem)).unwrap();
    assert!(yaml("depot-2").starts_with("image: depot-2.pgm\n"));
    for stem in ["2: depot", "a # b", "\"quoted\"", "- x", "Ä\\é"] {
        let described = crate::hall::occupancy::describe("x.yaml", &yaml(stem)).unwrap();
        assert_eq!(described.image, format!("{stem}.pgm"));
    }
}

/// The state of a run after the robot has visited `cells` cells of the hall.
fn explored(hall: &Hall, cells: usize) -> std::sync::Arc<Snapshot> {
    let sim = SimSettings::new(7, Camera::Stub);
    let mut run = Run::new(std::sync::Arc::new(hall.clone()), sim, Settings::default(), SearchStrategy::Snail);
    run.give(hallsweep_core::command::Command::Start).unwrap();
    assert!(run.run_until(10_000, |state| state.map.visited() == cells));
    run.state()
}

#[test]
fn a_map_that_is_half_explored_says_what_is_not_known() {
    let hall = Hall::from_rows("half", &["S.......", "........", "........", "........"]).unwrap();
    let state = explored(&hall, 10);
    let export = Export::explored("half", 0.5, &state);
    let bounds = export.hall.bounds();
    let unknown = export.squares().filter(|(_, mark)| *mark == Some(Mark::Unknown)).count();
    assert!(unknown > 0);
    let places = || (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));

    let written = export.written(Format::Occupancy, "half").unwrap();
    let (yaml, image) = (String::from_utf8_lossy(&written.file).into_owned(), written.image.clone().unwrap());
    for cell in places() {
        let seen = map_server(&yaml, &image, f64::from(cell.x) * 0.5, f64::from(-cell.y) * 0.5);
        let expect = match state.map.at(cell) {
            Mark::Unknown => -1,
            Mark::Seen | Mark::Visited => 0,
            Mark::Wall | Mark::Luggage | Mark::NotInspected => 100,
        };
        assert_eq!(seen, expect, "{cell:?}");
    }
    assert!(!written.lost.iter().any(|words| words.contains("unknown")), "{:?}", written.lost);

    let text = String::from_utf8(export.file(Format::SeedText, "half")).unwrap();
    let marks: Vec<char> = text.chars().filter(|letter| "r10X".contains(*letter)).collect();
    for (cell, mark) in places().zip(marks) {
        let expect = match state.map.at(cell) {
            _ if cell == Cell::HOME => 'r',
            Mark::Unknown | Mark::Seen => '0',
            Mark::Visited => '1',
            Mark::Wall | Mark::Luggage | Mark::NotInspected => 'X',
        };
        assert_eq!(mark, expect, "{cell:?}");
    }
    for (format, words) in [(Format::Toml, "walls"), (Format::MovingAi, "walls"), (Format::SeedText, "floor not visited yet")] {
        let lost = export.written(format, "half").unwrap().lost;
        assert!(lost.contains(&format!("which cells are unknown ({unknown}, now {words})")), "{format:?}: {lost:?}");
    }
}

#[test]
fn a_map_that_is_explored_is_the_hall_with_walls_round_it() {
    let hall = Hall::parse(
        "x.toml",
        "drawing = '''\n...#\n.aS.\n....\n'''\n[[luggage]]\nmark = \"a\"\nkind = \"box\"\ncolour = \"red\"\ndangerous = true\n",
    )
    .map(std::sync::Arc::new)
    .unwrap();
    let (sim, settings) = (SimSettings::new(7, Camera::Stub), Settings::default());
    let figures = explore_and_tell(&hall, sim, settings, SearchStrategy::Snail, Verdicts::AllSafe, |_, _| ());
    let hall_again = Export::explored("x", hall.cell_m(), &figures.state).hall.clone();
    let bounds = hall.bounds();
    assert_eq!(hall_again.bounds(), bounds.grown(1));
    for y in bounds.least.y - 1..=bounds.most.y + 1 {
        for x in bounds.least.x - 1..=bounds.most.x + 1 {
            assert_eq!(hall_again.truth(Cell::new(x, y)), hall.truth(Cell::new(x, y)), "({x}, {y})");
        }
    }
    assert!(!hall_again.is_dangerous(Piece(1)), "it was said to be safe");

    let figures = explore_and_tell(
        &hall,
        SimSettings::new(7, Camera::Stub),
        Settings::default(),
        SearchStrategy::Snail,
        Verdicts::Hall,
        |_, _| (),
    );
    let toml = again(&Export::explored("x", 0.5, &figures.state).written(Format::Toml, "x").unwrap(), Format::Toml);
    assert!(toml.is_dangerous(Piece(1)), "it was said to be dangerous");
}

#[test]
fn the_largest_hall_explored_can_be_read_again() {
    use hallsweep_core::units::Revision;
    let mut map = HallMap::new(Cell::HOME, Revision(1));
    for (cell, mark) in [
        (Cell::new(2047, 2047), Mark::Visited),
        (Cell::new(-1, 0), Mark::Wall),
        (Cell::new(2048, 5), Mark::Wall),
        (Cell::new(5, -1), Mark::Wall),
    ] {
        map.mark(cell, mark, Revision(2));
    }
    assert_eq!(known_bounds(&map), Bounds { least: Cell::HOME, most: Cell::new(2047, 2047) });
}

/// Random halls with floor, walls, single pieces, and long pieces with letters. Some pieces have descriptions.
fn halls() -> impl Strategy<Value = Hall> {
    let square = prop::sample::select(vec!['.', '.', '.', '.', '#', '#', 'T', 'l', 'm']);
    let rows = (1usize..9, 1usize..9)
        .prop_flat_map(move |(width, height)| prop::collection::vec(prop::collection::vec(square.clone(), width), height));
    let words = prop::collection::vec((0usize..6, any::<[u8; 3]>(), prop::bool::ANY, 0.1f64..2.0), 40);
    (rows, any::<prop::sample::Index>(), words, 0.1f64..5.0, prop::bool::ANY).prop_map(
        |(mut rows, start, words, cell_m, is_hot)| {
            let (width, count) = (rows[0].len(), rows.len() * rows[0].len());
            let start = start.index(count);
            rows[start / width][start % width] = 'S';
            let mut letters = ('a'..='k').cycle();
            // A letter may be used again only in the next cell of the same row, so that its cells form one piece.
            let mut used = 0;
            for row in &mut rows {
                let mut before = '.';
                for square in row.iter_mut() {
                    let mark = *square;
                    if "lm".contains(mark) {
                        let goes_on = before.is_ascii_lowercase() && used > 0;
                        *square = if goes_on {
                            before
                        } else if used < 11 {
                            used += 1;
                            letters.next().unwrap()
                        } else {
                            'T'
                        };
                    }
                    before = *square;
                }
            }
            let rows: Vec<String> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
            let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
            let mut hall = Hall::from_rows("again", &rows).unwrap();
            for (bag, (kind, [red, green, blue], dangerous, height_m)) in
                hall.bags.iter_mut().zip(words).filter(|(bag, _)| bag.cells.len() > 1)
            {
                (bag.kind, bag.colour, bag.dangerous, bag.height_m) =
                    (BagKind::ALL[kind], Colour { red, green, blue }, dangerous, height_m);
                bag.name = format!("{} {}", bag.colour.nearest_name(), bag.kind.name()).into();
            }
            let curve = is_hot
                .then(|| crate::curve::Curve::through(vec![(0.5, hallsweep_core::units::Celsius::new(20.25).unwrap())]))
                .flatten();
            hall.measured(cell_m, curve)
        },
    )
}

fn kinds(hall: &Hall) -> Vec<u8> {
    hall.squares
        .iter()
        .map(|truth| match truth {
            Truth::Free => b'.',
            Truth::Wall => b'#',
            Truth::Luggage(_) => b'T',
        })
        .collect()
}

proptest! {
    #[test]
    fn a_hall_through_its_own_format_is_the_same(hall in halls()) {
        let written = Export::from(hall.clone()).written(Format::Toml, "again").unwrap();
        prop_assert_eq!(&written.lost, &Vec::<String>::new());
        prop_assert_eq!(again(&written, Format::Toml), hall);
    }

    #[test]
    fn a_hall_through_movingai_has_the_same_cells(hall in halls()) {
        let written = Export::from(hall.clone()).written(Format::MovingAi, "again").unwrap();
        let map = again(&written, Format::MovingAi);
        prop_assert_eq!(kinds(&map), kinds(&hall));
        prop_assert_eq!(map.bounds().width(), hall.bounds().width());
        prop_assert_eq!(written.lost.iter().any(|words| words.starts_with("the start moves")), map.home() != hall.home());
    }

    #[test]
    fn a_hall_through_pgm_and_yaml_has_the_same_cells_home_and_size(hall in halls()) {
        let written = Export::from(hall.clone()).written(Format::Occupancy, "again").unwrap();
        let map = again(&written, Format::Occupancy);
        prop_assert_eq!((kinds(&map), map.bounds(), map.cell_m()), (kinds(&hall), hall.bounds(), hall.cell_m()));
        if hall.pieces().iter().all(|bag| bag.cells.len() == 1) {
            prop_assert_eq!(&map.squares, &hall.squares, "pieces have their numbers");
        }
    }

    #[test]
    fn a_hall_through_the_text_of_old_clients_has_the_same_floor_and_home(hall in halls()) {
        let written = Export::from(hall.clone()).written(Format::SeedText, "again").unwrap();
        let text = again(&written, Format::SeedText);
        let floor = |hall: &Hall| kinds(hall).iter().map(|kind| *kind == b'.').collect::<Vec<bool>>();
        prop_assert_eq!((floor(&text), text.bounds()), (floor(&hall), hall.bounds()));
    }

    #[test]
    fn no_text_of_old_clients_makes_the_reader_panic(text in "[r10X,|@ \n\r\tL]{0,60}") {
        let _ = Hall::parse("x.txt", &text);
    }
}
