//! Tests for maps of ROS `map_server`: the allowed content of the YAML file, which pixels are free, and how pixels
//! become cells.

use proptest::prelude::*;

use crate::{Hall, Truth};
use hallsweep_core::units::Cell;

/// The world's (0, 0) lies outside this image.
const YAML: &str =
    "image: m.pgm\nresolution: 0.5\norigin: [1.0, 1.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn pgm(width: usize, pixels: &[u8]) -> Vec<u8> {
    super::pgm::write(width, pixels)
}

/// Returns the hall as rows of `.` `#` `T`, with `S` as the start, and the side of its cells in metres.
fn drawn(yaml: &str, image: &[u8], cell_m: Option<f64>) -> Result<(String, f64), String> {
    let hall = Hall::parse_occupancy("m.yaml", yaml, "m.pgm", image, cell_m).map_err(|error| error.to_string())?;
    let home = hall.home();
    let letter = |x: i32, y: i32, truth: &Truth| match truth {
        Truth::Free if Cell::new(x, y) == home => 'S',
        Truth::Free => '.',
        Truth::Wall => '#',
        Truth::Luggage(_) => 'T',
    };
    let rows = (0..).zip(hall.rows()).map(|(y, row)| (0..).zip(row).map(|(x, truth)| letter(x, y, truth)).collect());
    Ok((rows.collect::<Vec<String>>().join("/"), hall.cell_m()))
}

fn is_drawn(yaml: &str, image: &[u8], expect: &str) {
    assert_eq!(drawn(yaml, image, None).map(|(rows, _)| rows), Ok(expect.to_owned()), "{yaml}");
}

fn check(yaml: &str, expect: &str) {
    let said = drawn(yaml, &pgm(1, &[254]), None).expect_err("this file has a fault");
    assert!(said.starts_with(expect), "expected {expect}\n     got {said}");
}

#[test]
fn what_is_occupied_or_unknown_is_a_wall() {
    let pixels = pgm(3, &[254, 205, 0, 206, 255, 89]);
    is_drawn(YAML, &pixels, "S##/..#");
    let looser = YAML.replace("0.196", "0.25");
    is_drawn(&looser, &pixels, "S.#/..#");
    is_drawn(&YAML.replace("0.196", "1").replace("0.65", "0.5"), &pgm(4, &[255, 128, 127, 0]), "S.##");
}

#[test]
fn negate_takes_dark_for_free() {
    for said in ["1", "true"] {
        is_drawn(&YAML.replace("negate: 0", &format!("negate: {said}")), &pgm(3, &[0, 50, 254]), "S##");
    }
    is_drawn(&YAML.replace("negate: 0", "negate: false"), &pgm(3, &[254, 205, 0]), "S##");
}

#[test]
fn scale_and_raw_are_free_where_the_occupancy_is_nought() {
    let scale = format!("{YAML}mode: scale\n");
    // The scale is rounded to whole percent. A pixel of 205 is at 0.02 %, which becomes 0 (free). A pixel of 204 is
    // at 0.9 %, which becomes 1.
    is_drawn(&scale, &pgm(4, &[254, 205, 204, 0]), "S.##");
    is_drawn(&format!("{YAML}mode: Raw\n"), &pgm(4, &[0, 1, 100, 254]), "S###");
    is_drawn(&format!("{YAML}mode: trinary\n"), &pgm(2, &[254, 205]), "S#");
}

#[test]
fn trinary_counts_how_opaque_a_pixel_is_and_scale_knows_nothing_of_what_is_not() {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 3, 1);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    encoder.write_header().unwrap().write_image_data(&[255, 255, 255, 0, 180, 255]).unwrap();
    is_drawn(YAML, &png, "S##");
    is_drawn(&YAML.replace("0.196", "0.26"), &png, "S..");
    is_drawn(&format!("{YAML}mode: scale\n").replace("0.196", "0.26"), &png, "S##");
}

#[test]
fn a_cell_is_a_wall_when_any_pixel_in_it_is_and_what_is_left_over_is_a_cell_too() {
    let pixels = pgm(5, &[254, 254, 254, 254, 254, 254, 0, 254, 254, 254, 254, 254, 254, 254, 205]);
    let finer = YAML.replace("resolution: 0.5", "resolution: 0.25");
    is_drawn(&finer, &pixels, "#S./..#");
    assert_eq!(drawn(&finer, &pixels, Some(0.25)), Ok(("S..../.#.../....#".to_owned(), 0.25)));
    assert_eq!(drawn(&finer, &pixels, Some(1.25)).unwrap_err(), "m.pgm: there is no free cell for the robot: make one cell free");
    // A cell has one and a half pixels, so the pixel on a border belongs to both cells.
    let thin = pgm(6, &[254, 0, 254, 254, 254, 254]);
    assert_eq!(drawn(&finer, &thin, Some(0.375)), Ok(("##S.".to_owned(), 0.375)));
}

#[test]
fn decimal_fractions_do_not_make_a_pixel_more_or_less() {
    for (resolution, cell_m, pixels) in
        [(0.05, 0.5, 10), (0.1, 0.3, 3), (0.15, 0.45, 3), (0.05000000074505806, 0.5, 10), (0.2, 0.6, 3)]
    {
        let yaml = YAML.replace("resolution: 0.5", &format!("resolution: {resolution}"));
        for cells in [1, 7, 200] {
            let mut row = vec![254; cells * pixels];
            row[pixels - 1] = 0;
            let image = pgm(row.len(), &[row.clone(), vec![254; row.len()]].concat());
            let rows = drawn(&yaml, &image, Some(cell_m)).map_or_else(|said| said, |(rows, _)| rows);
            let expect = if cells == 1 {
                "m.pgm: there is no free cell for the robot: make one cell free".to_owned()
            } else {
                format!("#S{}", ".".repeat(cells - 2))
            };
            assert_eq!(rows, expect, "{resolution} {cell_m} {cells}");
        }
    }
}

#[test]
fn cells_are_half_a_metre_or_a_pixel_unless_they_are_asked_for() {
    let free = pgm(2, &[254, 254]);
    let with = |resolution: &str| YAML.replace("resolution: 0.5", &format!("resolution: {resolution}"));
    assert_eq!(drawn(&with("0.25"), &free, None).unwrap(), ("S".to_owned(), 0.5));
    assert_eq!(drawn(&with("1"), &free, None).unwrap(), ("S.".to_owned(), 1.0));
    let said = |yaml: &str, cell_m| drawn(yaml, &free, Some(cell_m)).unwrap_err();
    assert_eq!(said(&with("1"), 0.5), "m.yaml: cells of 0.5 m are finer than the pixels of 1 m: give 1 or more");
    for (cell_m, value) in [(0.05, "0.05"), (7.0, "7"), (f64::NAN, "NaN"), (-1.0, "-1"), (f64::INFINITY, "inf")] {
        assert_eq!(said(YAML, cell_m), format!("m.yaml: `--cell` is {value}: give a number from 0.1 to 5"));
    }
}

#[test]
fn our_own_files_say_where_luggage_lies_and_the_robot_starts() {
    let own = format!("{YAML}hallsweep: {{cell_m: 0.5, luggage: 50, home: [2, 1]}}\n");
    let pixels = pgm(3, &[254, 50, 0, 254, 51, 254]);
    is_drawn(&own, &pixels, ".T#/.#S");
    is_drawn(YAML, &pixels, "S##/.#.");
    let said = |yaml: &str, cell_m| drawn(yaml, &pixels, cell_m).unwrap_err();
    for (x, y) in [(1, 0), (2, 0), (3, 0), (0, 2), (5, 0), (4_294_967_295_u32, 4_294_967_295_u32)] {
        let home = own.replace("[2, 1]", &format!("[{x}, {y}]"));
        assert!(said(&home, None).starts_with(&format!("m.yaml:7: `home` is [{x}, {y}], which is not a free cell of this hall")));
    }
    assert_eq!(said(&own, Some(1.0)), "m.yaml: --cell is 1 m, but the cells of this file are 0.5 m wide: leave --cell out");
    assert!(drawn(&own, &pixels, Some(0.5)).is_ok());
    check(&own.replace("cell_m: 0.5", "cell_m: 9"), "m.yaml:7: `cell_m` is 9: give a number from 0.1 to 5");
    check(&own.replace("luggage: 50", "luggage: 300"), "m.yaml:7: ");
    check(&own.replace(", home: [2, 1]", ""), "m.yaml:7: missing field");
    check(&own.replace("home", "hone"), "m.yaml:7: unknown field");
}

#[test]
fn what_is_missing_or_out_of_range_is_named_with_its_line() {
    for (index, key) in ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"].into_iter().enumerate() {
        let rest: String = YAML.lines().enumerate().filter(|(at, _)| *at != index).map(|(_, line)| format!("{line}\n")).collect();
        check(&rest, &format!("m.yaml: `{key}` is missing: "));
    }
    let with = |key: &str, value: &str| {
        YAML.lines()
            .map(|line| if line.starts_with(key) { format!("{key}: {value}\n") } else { format!("{line}\n") })
            .collect::<String>()
    };
    for (value, said) in [(".nan", "NaN"), ("0", "0"), ("-0.05", "-0.05"), (".inf", "inf"), ("7", "7"), ("0.0001", "0.0001")] {
        check(&with("resolution", value), &format!("m.yaml:2: `resolution` is {said}: give a number from 0.001 to 5"));
    }
    check(&with("resolution", "nan"), "m.yaml:2: ");
    check(&with("resolution", "five"), "m.yaml:2: ");
    check(&with("origin", "[0, 0]"), "m.yaml:3: `origin` has 2 numbers: give three, [x, y, yaw]");
    check(
        &with("origin", "[0, 0, 1.57]"),
        "m.yaml:3: `origin` turns the image by 1.57 radians: turn the image itself, and give 0",
    );
    check(&with("origin", "[.nan, 0, 0]"), "m.yaml:3: `origin` is NaN: give a number from ");
    check(&with("negate", "2"), "m.yaml:4: `negate` is 2: use 0 or 1");
    check(&with("negate", "maybe"), "m.yaml:4: ");
    check(&with("occupied_thresh", "1.5"), "m.yaml:5: `occupied_thresh` is 1.5: give a number from 0 to 1");
    check(&with("free_thresh", "-1"), "m.yaml:6: `free_thresh` is -1: give a number from 0 to 1");
    check(&format!("{YAML}mode: binary\n"), "m.yaml:7: `mode` is \"binary\": use trinary, scale or raw");
    check("", "m.yaml");
    check("- 1\n- 2\n", "m.yaml:1: ");
    check("image: [\n", "m.yaml:");
    check(&format!("{YAML}negate: 1\n"), "m.yaml:7: ");
}

/// Numbers as other tools write them, each with the rounding error of a 32-bit float.
#[test]
fn a_number_that_is_off_by_rounding_alone_means_the_round_number() {
    let rounded = YAML.replace("resolution: 0.5", "resolution: 0.05000000074505806");
    let origin = |yaw: &str| YAML.replace("0.0]", &format!("{yaw}]"));
    for yaw in ["1e-9", "-4.3711388e-8", "-0.0", "9.9e-7"] {
        is_drawn(&origin(yaw), &pgm(1, &[254]), "S");
    }
    for yaw in ["1e-5", "-0.001", "3.1415927", ".nan", ".inf"] {
        check(&origin(yaw), "m.yaml:3: `origin` turns the image by ");
    }
    let coarse = rounded.replace("0.05000000074505806", "0.20000000298023224");
    assert_eq!(drawn(&coarse, &pgm(2, &[254, 0]), Some(0.2)).map(|(rows, _)| rows), Ok("S#".to_owned()));
    assert!(drawn(&coarse, &pgm(1, &[254]), Some(0.199)).unwrap_err().contains("are finer than the pixels"));
    // There are 1,600 cells of ten pixels. The wall is the last pixel of the second-last cell. This wall must not
    // touch the last cell.
    let mut row = vec![254; 16_000];
    row[15_989] = 0;
    let (rows, _) = drawn(&rounded, &pgm(row.len(), &row), None).unwrap();
    assert_eq!((rows.len(), rows.matches('#').count(), rows.ends_with("#.")), (1600, 1, true));
    let own = format!("{YAML}hallsweep: {{cell_m: 0.5, luggage: 50, home: [0, 0]}}\n");
    assert!(drawn(&own, &pgm(1, &[254]), Some(0.5 + 1e-9)).is_ok());
}

#[test]
fn what_map_server_passes_over_is_passed_over() {
    is_drawn(&format!("# A comment.\n{YAML}later: {{keys: [1, 2]}}\n"), &pgm(2, &[254, 0]), "S#");
    assert!(Hall::parse("m.yaml", YAML).unwrap_err().to_string().contains("give the path of the .yaml"));
}

#[test]
fn absurd_sizes_are_refused_before_anything_is_made_of_them() {
    let said = |yaml: &str, image: &[u8]| drawn(yaml, image, None).unwrap_err();
    assert!(
        said(YAML, b"P5 4000000000 4000000000 255\n")
            .starts_with("m.pgm: an image of 4000000000 × 4000000000 pixels is too large")
    );
    let wide = pgm(3000, &[254; 3000]);
    assert_eq!(said(YAML, &wide), "m.pgm: a hall of 3000 × 1 cells is too large: at most 2048 × 2048 cells are allowed");
    let short = "m.pgm: the image should have 4194304 pixels, but ends after 2: save it again";
    assert_eq!(said(YAML, b"P5 2048 2048 255\n\xff\xff"), short);
}

#[test]
fn a_yaml_bomb_is_refused() {
    let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x]\n");
    for level in 1..12 {
        let reference = format!("*a{}", level - 1);
        bomb += &format!("a{level}: &a{level} [{}]\n", [reference.as_str(); 9].join(", "));
    }
    check(&format!("{bomb}{YAML}"), "m.yaml");
    check(&"[".repeat(5000), "m.yaml");
    check(&format!("image: {}", "{a: ".repeat(3000)), "m.yaml");
}

proptest! {
    #[test]
    fn no_yaml_makes_the_reader_panic(text in "([a-z_]{1,9}: [-0-9.\\[\\]{}&*a!|>'\"# ]{0,12}\n){0,8}", tail in "\\PC{0,80}") {
        let image = pgm(2, &[254, 0]);
        let _ = Hall::parse_occupancy("m.yaml", &format!("{text}{tail}"), "m.pgm", &image, None);
        let _ = Hall::parse_occupancy("m.yaml", &format!("{YAML}{text}"), "m.pgm", &image, None);
    }

    #[test]
    fn no_bytes_of_an_image_make_the_reader_panic(
        begin in prop::sample::select(vec!["", "P5", "P2", "P5 3 2 255\n", "P2 2 2 9 ", "\u{89}PNG\r\n\u{1a}\n"]),
        bytes in prop::collection::vec(any::<u8>(), 0..120),
        cell_m in prop::option::of(0.1f64..5.0),
    ) {
        let begin: Vec<u8> = begin.chars().map(|letter| letter as u8).collect();
        let _ = Hall::parse_occupancy("m.yaml", YAML, "m.pgm", &[begin, bytes].concat(), cell_m);
    }
}
