//! Finds halls: built-in halls by name, and files in any format. The format is recognised by the content of the file.
//! Only images and their YAML files are recognised by their extensions. Each format is read in a file of its own.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{HallError, HallFault};
use super::pixels::{Image, MAX_IMAGE_BYTES};
use super::{Hall, movingai, occupancy, seed_text, toml};

const BUILT_IN: [(&str, &str); 4] = [
    ("airport", include_str!("../../../../config/halls/airport.toml")),
    ("empty-8x8", include_str!("../../../../config/halls/empty-8x8.toml")),
    ("seed-9x8", include_str!("../../../../config/halls/seed-9x8.toml")),
    ("seed", include_str!("../../../../config/halls/seed.toml")),
];

/// Largest file, in bytes. A hall of the largest size takes three bytes a cell in the text of old clients. The rest
/// is room for everything else.
const MAX_FILE_BYTES: u64 = 16 << 20;

impl Hall {
    /// Names of the built-in halls; the first is the default.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.into_iter().map(|(name, _)| name)
    }

    /// Reads the built-in hall of this name. If no built-in hall has this name, reads the hall file at this path, in
    /// any format.
    ///
    /// # Errors
    /// When the file cannot be read or has a fault.
    pub fn named_or_file(name_or_path: &str) -> Result<Hall, HallError> {
        Hall::open(name_or_path, None)
    }

    /// Like `named_or_file`. `cell_m` is the side of a cell in metres. It is useful for image files, which may leave
    /// out the size of a cell.
    ///
    /// # Errors
    /// When the file cannot be read or has a fault, or when the file sets a side of its cells that differs from
    /// `cell_m`.
    pub fn open(name_or_path: &str, cell_m: Option<f64>) -> Result<Hall, HallError> {
        if let Some((name, text)) = BUILT_IN.into_iter().find(|(name, _)| *name == name_or_path) {
            return Hall::parse(name, text).and_then(|hall| hall.with_own_cells(name, cell_m));
        }
        let path = Path::new(name_or_path);
        if has_extension(path, &["js"]) {
            return Err(HallFault::IsScene(name_or_path.to_owned()).of(name_or_path));
        }
        if has_extension(path, &YAML) {
            return open_yaml(name_or_path, path, cell_m);
        }
        let bytes = read_file(path).map_err(|fault| fault.of(name_or_path))?;
        if Image::begins(&bytes) || has_extension(path, &["pgm", "png", "bmp"]) {
            let beside = YAML.map(|extension| path.with_extension(extension)).into_iter().find(|yaml| yaml.is_file());
            let missing = || HallFault::NoYaml(path.with_extension(YAML[0]).display().to_string()).of(name_or_path);
            let yaml = beside.ok_or_else(missing)?;
            return open_yaml(&yaml.display().to_string(), &yaml, cell_m);
        }
        if bytes.len() as u64 > MAX_FILE_BYTES {
            return Err(HallFault::FileTooLarge(MAX_FILE_BYTES).of(name_or_path));
        }
        let text = String::from_utf8(bytes).map_err(|_| HallFault::NotText.of(name_or_path))?;
        Hall::parse(name_or_path, &text)?.with_own_cells(name_or_path, cell_m)
    }

    /// Reads the hall described by `text`. The text is a MovingAI map if it begins like one. It is a map of old
    /// clients if all its characters are those of such a map. Any other text is TOML. A byte order mark is skipped.
    /// `file` is named in errors, and its stem is the hall's name if the text has none.
    ///
    /// On failure, returns the fault with its line.
    pub fn parse(file: &str, text: &str) -> Result<Hall, HallError> {
        let (name, text) = (stem(file), unmarked(text));
        if has_extension(Path::new(file), &YAML) {
            Err(HallFault::NeedsImage.of(file))
        } else if is_movingai(file, text) {
            movingai::read(file, &name, text)
        } else if is_seed_text(file, text) {
            seed_text::read(file, &name, text)
        } else {
            toml::read(file, &name, text)
        }
    }

    /// Reads the hall of an image. `file` is the YAML file that describes the image. `cell_m` is the side of a cell
    /// in metres. If neither `cell_m` nor the file sets it, a cell is half a metre, or one pixel if that is longer.
    ///
    /// On failure, returns the fault with its file and line.
    pub fn parse_occupancy(
        file: &str,
        yaml: &str,
        image_file: &str,
        image: &[u8],
        cell_m: Option<f64>,
    ) -> Result<Hall, HallError> {
        occupancy::describe(file, unmarked(yaml))?.hall(file, &stem(file), image_file, image, cell_m)
    }

    /// Returns the hall of a file that sets the side of its cells. Returns an error if the user asks for another
    /// side.
    fn with_own_cells(self, file: &str, asked: Option<f64>) -> Result<Hall, HallError> {
        match asked {
            Some(asked) if !occupancy::is_same(asked, self.cell_m) => {
                Err(HallFault::CellGiven { asked: asked.to_string(), has: self.cell_m.to_string() }.of(file))
            }
            _ => Ok(self),
        }
    }
}

/// The extensions of files that describe an image.
const YAML: [&str; 2] = ["yaml", "yml"];

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|found| extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)))
}

fn stem(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(|| file.into(), |stem| stem.to_string_lossy()).into_owned()
}

fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

fn open_yaml(file: &str, path: &Path, cell_m: Option<f64>) -> Result<Hall, HallError> {
    let bytes = read_at_most(path, occupancy::MAX_YAML_BYTES).map_err(|error| unreadable(&error).of(file))?;
    let bytes = bytes.ok_or_else(|| HallFault::YamlTooLarge(occupancy::MAX_YAML_BYTES).of(file))?;
    let yaml = String::from_utf8(bytes).map_err(|_| HallFault::NotText.of(file))?;
    let description = occupancy::describe(file, unmarked(&yaml))?;
    // If the image has an absolute path, `join` returns that path.
    let image_path: PathBuf = path.parent().unwrap_or(Path::new("")).join(&description.image);
    let image_file = image_path.display().to_string();
    let image = read_at_most(&image_path, MAX_IMAGE_BYTES).map_err(|error| {
        HallFault::UnreadableImage { path: image_file.clone(), error: error.to_string() }.at(file, description.image_line)
    })?;
    let image = image.ok_or_else(|| HallFault::ImageFileTooLarge(MAX_IMAGE_BYTES).of(&image_file))?;
    description.hall(file, &stem(file), &image_file, &image, cell_m)
}

/// Whether a text is meant as a MovingAI map. There are two signs of such a map. Its first word is one of the map's
/// header, even if header lines are missing or in the wrong order. Or its file has the extension `.map` and contains
/// no `=`, which TOML would need.
fn is_movingai(file: &str, text: &str) -> bool {
    let mut words = text.split_whitespace();
    let begins = words.next().is_some_and(|word| ["type", "height", "width", "map"].contains(&word));
    let assigns = words.next().is_some_and(|word| word.starts_with('='));
    let called = Path::new(file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("map"));
    (begins && !assigns) || (called && !text.contains('='))
}

/// Whether a text is meant as a map of old clients. There are two signs of such a map. The whole text can be read as
/// one. Or its file has the extension `.txt` and contains no `=`, which TOML would need.
fn is_seed_text(file: &str, text: &str) -> bool {
    seed_text::is_one(text) || (has_extension(Path::new(file), &["txt"]) && !text.contains('='))
}

/// Reads a file up to one byte more than the size limit, so that the caller can see whether it is too large.
fn read_file(path: &Path) -> Result<Vec<u8>, HallFault> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    Ok(bytes)
}

/// Reads a whole file. Returns `None` if it has more than `most` bytes.
fn read_at_most(path: &Path, most: u64) -> std::io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

fn unreadable(error: &std::io::Error) -> HallFault {
    HallFault::Unreadable(error.to_string(), Hall::builtin_names().collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use proptest::prelude::*;

    use super::*;
    use hallsweep_core::rng::RandomStream;
    use hallsweep_core::units::Cell;

    #[test]
    fn every_built_in_hall_is_sound_and_all_its_luggage_can_be_met() {
        for name in Hall::builtin_names() {
            let hall = Hall::named_or_file(name).unwrap();
            assert_eq!(hall.name(), name);
            let reachable = hall.reachable();
            for bag in hall.pieces() {
                assert!(
                    bag.cells.iter().any(|cell| cell.neighbours().iter().any(|next| reachable.contains(next))),
                    "{}",
                    bag.name
                );
            }
        }
    }

    #[test]
    fn the_airport_has_varied_luggage_one_of_it_dangerous_and_stays_cool() {
        let hall = Hall::named_or_file("airport").unwrap();
        let kinds: std::collections::BTreeSet<&str> = hall.pieces().iter().map(|bag| bag.kind.name()).collect();
        assert!(hall.pieces().len() >= 6 && kinds.len() == 6);
        assert_eq!(hall.pieces().iter().filter(|bag| bag.dangerous).count(), 1);
        assert!(hall.pieces().iter().any(|bag| bag.cells.len() == 2));
        let curve = hall.curve().expect("it has a thermometer");
        assert!((0..7200).all(|second| curve.at(Duration::from_secs(second)).degrees() < 25.0));
    }

    #[test]
    fn the_seeds_halls_have_their_sizes() {
        let cells = |name| Hall::named_or_file(name).unwrap().reachable().len();
        assert_eq!((cells("empty-8x8"), cells("seed-9x8")), (64, 72));
        assert!(Hall::named_or_file("seed-9x8").unwrap().reachable().contains(&Cell::new(8, 7)));
    }

    #[test]
    fn a_file_that_is_not_there_is_said_with_the_halls_that_are() {
        let error = Hall::named_or_file("no/such.toml").unwrap_err().to_string();
        assert!(error.starts_with("no/such.toml: cannot read this file ("), "{error}");
        assert!(error.ends_with("built-in halls airport, empty-8x8, seed-9x8, seed"), "{error}");
    }

    #[test]
    fn a_byte_order_mark_is_passed_over_in_both_formats() {
        for text in ["type octile\nheight 1\nwidth 2\nmap\n..\n", "width = 2\nheight = 1\n"] {
            let hall = Hall::parse("marked", &format!("\u{feff}{text}")).unwrap();
            assert_eq!(hall.reachable().len(), 2, "{text}");
        }
        let error = Hall::parse("m.toml", "\u{feff}width = 2\nheight = -1\n").unwrap_err().to_string();
        assert_eq!(error, "m.toml:2: `height` is -1: give a number from 1 to 2048");
    }

    #[test]
    fn whoever_names_a_scene_is_told_how_a_hall_is_made_of_it() {
        let error = Hall::open("halls/room.js", None).unwrap_err().to_string();
        let expect =
            "halls/room.js: this is the scene of a virtual robot: make a hall of it with `hallsweep hall import halls/room.js`";
        assert_eq!(error, expect);
    }

    #[test]
    fn a_text_of_neither_format_is_told_what_a_hall_file_is() {
        let no_hall = "x:1: this is not a hall: a hall file is TOML with a `drawing`, or with `width` and `height`; a MovingAI \
                       map begins with `type octile`; a ROS map is given by its .yaml; a map in text has only `r` `1` `0` `X`";
        for text in ["hello", "hello\nworld\n", "{\"width\": 3}", "S..#\n....\n", "type"] {
            let error = Hall::parse("x", text).unwrap_err().to_string();
            let expect = if text == "type" {
                "x:1: this is not a MovingAI map: line 1 reads \"type\" instead of `type octile`"
            } else {
                no_hall
            };
            assert_eq!(error, expect, "{text}");
        }
        let empty = Hall::parse("x", "").unwrap_err().to_string();
        assert!(empty.starts_with("x: `drawing` is missing: give a `drawing`"), "{empty}");
    }

    #[test]
    fn a_map_with_lines_missing_or_in_the_wrong_order_is_told_which() {
        let check = |file: &str, text: &str, expect: &str| {
            let error = Hall::parse(file, text).unwrap_err().to_string();
            assert_eq!(error, format!("{file}:{expect}"));
        };
        check(
            "m",
            "height 1\nwidth 1\nmap\n.\n",
            "1: this is not a MovingAI map: line 1 reads \"height 1\" instead of `type octile`",
        );
        check("m.map", "..T\n", "1: this is not a MovingAI map: line 1 reads \"..T\" instead of `type octile`");
        check("m.map", "", "1: this is not a MovingAI map: line 1 is empty instead of `type octile`");
        let swapped = "type octile\nwidth 1\nheight 1\nmap\n.\n";
        check("m", swapped, "2: this is not a MovingAI map: line 2 reads \"width 1\" instead of `height NUMBER`");
        let no_map = format!("type octile\nheight 1\nwidth 1\n{}\n", ".".repeat(50));
        let dots = ".".repeat(40);
        check("m", &no_map, &format!("4: this is not a MovingAI map: line 4 begins with \"{dots}\" instead of `map`"));
    }

    #[test]
    fn the_example_in_the_documentation_is_a_sound_hall() {
        let page = include_str!("../../../../docs/halls.md");
        let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
        let hall = Hall::parse("docs/halls.md", example).unwrap();
        assert_eq!((hall.name(), hall.pieces().len()), ("arrivals", 2));
        assert!(crate::bag::Colour::NAMED.iter().all(|(name, _)| page.contains(name)), "every colour is told");
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "\\PC{0,200}") {
            let _ = Hall::parse("x.toml", &text);
        }

        #[test]
        fn no_movingai_body_makes_the_reader_panic(width in 0usize..5, height in 0usize..5, body in "[.@TGSOW#\r\n é]{0,40}") {
            let _ = Hall::parse("x.map", &format!("type octile\nheight {height}\nwidth {width}\nmap\n{body}"));
        }

        #[test]
        fn no_drawing_makes_the_reader_panic(body in "[.#SabT\n é]{0,60}", tail in "[a-z_= \"\\[\\]\n0-9.]{0,80}") {
            let _ = Hall::parse("x.toml", &format!("drawing = \"\"\"\n{body}\"\"\"\n{tail}"));
        }

        #[test]
        fn a_good_drawing_is_read_as_it_is_drawn(rows in proptest::collection::vec("[.#]{7}", 1..9)) {
            let mut rows = rows;
            rows[0].replace_range(0..1, "S");
            let hall = Hall::parse("x.toml", &format!("drawing = '''\n{}\n'''", rows.join("\n"))).unwrap();
            for (y, row) in (0i32..).zip(&rows) {
                for (x, mark) in (0i32..).zip(row.chars()) {
                    prop_assert_eq!(hall.truth(Cell::new(x, y)) == super::super::Truth::Wall, mark == '#');
                }
            }
        }
    }

    /// Bytes of valid files are changed, dropped, doubled and swapped at random. The reader must return a hall or an
    /// error each time.
    #[test]
    fn mutated_files_are_read_or_refused_but_never_panic() {
        let map = "type octile\nheight 3\nwidth 4\nmap\n@@.T\nO.GS\nWTT.\n";
        let mut stream = RandomStream::new(2026, "mutation");
        let mut refused = 0;
        for (_, original) in BUILT_IN.into_iter().chain([("map", map)]) {
            for _ in 0..400 {
                let mut bytes = original.as_bytes().to_vec();
                for _ in 0..=stream.below(6) {
                    mutate(&mut bytes, &mut stream);
                }
                refused += usize::from(Hall::parse("mutant", &String::from_utf8_lossy(&bytes)).is_err());
            }
        }
        assert!(refused > 200, "most mutants are broken: {refused}");
    }

    fn mutate(bytes: &mut Vec<u8>, stream: &mut RandomStream) {
        let place = usize::try_from(stream.below(bytes.len().max(1) as u64)).unwrap();
        match stream.below(4) {
            0 if place < bytes.len() => bytes[place] = stream.number().to_le_bytes()[0],
            1 => bytes.truncate(place),
            2 => bytes.extend_from_within(place..),
            _ => bytes.rotate_left(place),
        }
    }
}
