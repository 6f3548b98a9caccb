//! Reads and writes a hall file in TOML: `name`, `description`, `cell_m`, a `drawing` or `width` and `height`,
//! `[[luggage]]`, `[[area]]` and `[[temperature]]`. `docs/halls.md` explains each key to authors.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use serde::Deserialize;
use toml::Spanned;

use super::error::{HallError, HallFault};
use super::rows::{self, Drawing};
use super::{Hall, MAX_SIDE, Plan, Truth, USUAL_CELL_M, relative_to};
use crate::bag::{Bag, BagKind, Colour};
use crate::curve::Curve;
use hallsweep_core::units::{Cell, Celsius, Piece};
use hallsweep_core::world::areas::{Area, AreaFault};
use hallsweep_core::world::hall_map::Bounds;

/// Maximum number of temperature keyframes. It is enough for one a minute over more than a day.
const MAX_TEMPERATURES: usize = 2048;

/// Latest time of a keyframe, in seconds. A billion seconds are about thirty years, and no search lasts longer.
const MAX_SECONDS: f64 = 1e9;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<Spanned<String>>,
    description: Option<Spanned<String>>,
    cell_m: Option<Spanned<f64>>,
    drawing: Option<Spanned<String>>,
    width: Option<Spanned<i64>>,
    height: Option<Spanned<i64>>,
    #[serde(default)]
    luggage: Vec<Luggage>,
    #[serde(default)]
    area: Vec<NamedArea>,
    #[serde(default)]
    temperature: Vec<Keyframe>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Luggage {
    mark: Spanned<String>,
    kind: Spanned<String>,
    colour: Spanned<String>,
    height_m: Option<Spanned<f64>>,
    #[serde(default)]
    dangerous: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NamedArea {
    name: Spanned<String>,
    probability: Spanned<f64>,
    /// Column and row of each corner, from 0 in the north-west.
    corners: Spanned<Vec<Vec<i32>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keyframe {
    at_s: Spanned<f64>,
    celsius: Spanned<f64>,
}

/// Reads a hall file. `name` is the hall's name if the file has none.
pub(super) fn read(file: &str, name: &str, text: &str) -> Result<Hall, HallError> {
    let source = Source { file, text };
    let content: File = toml::from_str(text).map_err(|error| source.syntax(&error))?;
    source.check_length(content.name.as_ref(), 1..=64, HallFault::NameLength)?;
    // A description is shown only to readers of the file, so it may be longer than a name, or empty.
    source.check_length(content.description.as_ref(), 0..=1000, HallFault::DescriptionLength)?;
    let cell_m = source.within("cell_m", content.cell_m.as_ref(), 0.1..=5.0)?.unwrap_or(USUAL_CELL_M);
    let plan = match &content.drawing {
        Some(drawing) if content.width.is_none() && content.height.is_none() => source.drawing(drawing, &content.luggage)?,
        Some(drawing) => return Err(source.at(&drawing.span(), HallFault::DrawingAndSize)),
        None => source.empty(content.width.as_ref(), content.height.as_ref(), &content.luggage)?,
    };
    let curve = source.curve(&content.temperature)?;
    let hall = Hall::of(content.name.as_ref().map_or(name, |name| name.get_ref()), plan).measured(cell_m, curve);
    let hall = Hall { areas: source.areas(&content.area, &hall)?, ..hall };
    Ok(hall.described(content.description.as_ref().map(|words| words.get_ref().as_str())))
}

/// The text of a hall file. It finds the line of each fault.
struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    fn line(&self, span: &Range<usize>) -> usize {
        let before = self.text.as_bytes().get(..span.start).unwrap_or(self.text.as_bytes());
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    }

    fn at(&self, span: &Range<usize>, fault: HallFault) -> HallError {
        fault.at(self.file, self.line(span))
    }

    fn syntax(&self, error: &toml::de::Error) -> HallError {
        // A text without any `=` was never meant as TOML. A message about TOML would not help its author.
        if !self.text.contains('=') {
            return HallFault::NoHall.at(self.file, 1);
        }
        let reason = error.message().lines().collect::<Vec<_>>().join(", ");
        let reason = reason.replace("expected i64", "expected a whole number").replace("expected f64", "expected a number");
        let reason = reason.replace("expected i32", "expected a column or row of the hall");
        let fault = HallFault::Syntax(format!("{reason}: correct this line"));
        match error.span() {
            Some(span) => self.at(&span, fault),
            None => fault.of(self.file),
        }
    }

    fn check_length(
        &self,
        given: Option<&Spanned<String>>,
        limits: RangeInclusive<usize>,
        fault: fn(usize) -> HallFault,
    ) -> Result<(), HallError> {
        let Some(text) = given else { return Ok(()) };
        let length = text.get_ref().chars().count();
        if limits.contains(&length) { Ok(()) } else { Err(self.at(&text.span(), fault(length))) }
    }

    /// Checks that a number is within limits. NaN is never within limits.
    fn within(
        &self,
        key: &'static str,
        given: Option<&Spanned<f64>>,
        limits: RangeInclusive<f64>,
    ) -> Result<Option<f64>, HallError> {
        let Some(number) = given else { return Ok(None) };
        let (value, least, most) = (number.get_ref().to_string(), limits.start().to_string(), limits.end().to_string());
        let fault = HallFault::OutOfRange { key, value, least, most };
        if limits.contains(number.get_ref()) { Ok(Some(*number.get_ref())) } else { Err(self.at(&number.span(), fault)) }
    }

    fn empty(&self, width: Option<&Spanned<i64>>, height: Option<&Spanned<i64>>, luggage: &[Luggage]) -> Result<Plan, HallError> {
        let missing = |key| HallFault::Missing(key, "give a `drawing`, or both `width` and `height` of an empty hall");
        let (width, height) = match (width, height) {
            (Some(width), Some(height)) => (width, height),
            (Some(width), None) => return Err(self.at(&width.span(), missing("`height`"))),
            (None, Some(height)) => return Err(self.at(&height.span(), missing("`width`"))),
            (None, None) => return Err(missing("`drawing`").of(self.file)),
        };
        if let Some(bag) = luggage.first() {
            return Err(self.at(&bag.mark.span(), HallFault::Undrawn(bag.mark.get_ref().clone())));
        }
        let (columns, rows) = (self.side("width", width)?, self.side("height", height)?);
        let worst = if columns == 0 || (columns > rows && rows > 0) { width } else { height };
        rows::empty(columns, rows).map_err(|fault| self.at(&worst.span(), fault))
    }

    fn side(&self, key: &'static str, side: &Spanned<i64>) -> Result<u64, HallError> {
        let (value, least, most) = (side.get_ref().to_string(), 1.to_string(), MAX_SIDE.to_string());
        u64::try_from(*side.get_ref()).map_err(|_| self.at(&side.span(), HallFault::OutOfRange { key, value, least, most }))
    }

    fn drawing(&self, drawing: &Spanned<String>, luggage: &[Luggage]) -> Result<Plan, HallError> {
        let mut rows: Vec<&str> = drawing.get_ref().lines().map(str::trim).collect();
        while rows.last().is_some_and(|row| row.is_empty()) {
            rows.pop();
        }
        let blank = rows.iter().take_while(|row| row.is_empty()).count();
        let first_line = self.first_row_line(&drawing.span()) + blank;
        let read = rows::read(&rows[blank..]).map_err(|(row, fault)| match row {
            0 => self.at(&drawing.span(), fault),
            row => fault.at(self.file, first_line + row - 1),
        })?;
        self.furnish(read, &drawing.span(), luggage)
    }

    /// The line of a drawing's first row. If three opening quotes end their line, the first row is on the next line.
    fn first_row_line(&self, span: &Range<usize>) -> usize {
        let value = self.text.get(span.clone()).unwrap_or_default();
        let opened = value.strip_prefix("\"\"\"").or_else(|| value.strip_prefix("'''"));
        let next = opened.is_some_and(|rest| rest.starts_with('\n') || rest.starts_with("\r\n"));
        self.line(span) + usize::from(next)
    }

    fn furnish(&self, drawing: Drawing, span: &Range<usize>, luggage: &[Luggage]) -> Result<Plan, HallError> {
        let Drawing { mut plan, letters } = drawing;
        let mut described: BTreeMap<char, Piece> = BTreeMap::new();
        for entry in luggage {
            let fault = |fault| self.at(&entry.mark.span(), fault);
            let mark = self.mark(&entry.mark)?;
            let piece = *letters.get(&mark).ok_or_else(|| fault(HallFault::Undrawn(entry.mark.get_ref().clone())))?;
            if described.insert(mark, piece).is_some() {
                return Err(fault(HallFault::DescribedTwice(mark)));
            }
            let bag = plan.bags.iter_mut().find(|bag| bag.piece == piece).expect("every letter of a drawing has its piece");
            self.describe(bag, entry)?;
        }
        match letters.keys().find(|letter| !described.contains_key(letter)) {
            Some(letter) => Err(self.at(span, HallFault::Undescribed(*letter))),
            None => Ok(plan),
        }
    }

    fn mark(&self, mark: &Spanned<String>) -> Result<char, HallError> {
        let mut letters = mark.get_ref().chars();
        match (letters.next(), letters.next()) {
            (Some(letter @ 'a'..='z'), None) => Ok(letter),
            _ => Err(self.at(&mark.span(), HallFault::NotAMark(mark.get_ref().clone()))),
        }
    }

    fn describe(&self, bag: &mut Bag, entry: &Luggage) -> Result<(), HallError> {
        let kind_name = entry.kind.get_ref();
        bag.kind =
            BagKind::named(kind_name).ok_or_else(|| self.at(&entry.kind.span(), HallFault::UnknownKind(kind_name.clone())))?;
        bag.colour = Colour::parse(entry.colour.get_ref()).ok_or_else(|| {
            let names = Colour::NAMED.map(|(name, _)| name).join(", ");
            self.at(&entry.colour.span(), HallFault::UnknownColour(entry.colour.get_ref().clone(), names))
        })?;
        let height_m = self.within("height_m", entry.height_m.as_ref(), 0.1..=2.0)?;
        bag.height_m = height_m.unwrap_or(bag.kind.usual_height_m());
        bag.dangerous = entry.dangerous;
        bag.name = format!("{} {}", bag.colour.nearest_name(), bag.kind.name()).into();
        Ok(())
    }

    fn areas(&self, given: &[NamedArea], hall: &Hall) -> Result<Arc<[Area]>, HallError> {
        let area = |NamedArea { name, probability, corners }: &NamedArea| {
            let corner = |corner: &Vec<i32>| match **corner {
                [column, row] => Ok(Cell::new(column, row)),
                _ => Err(self.at(&corners.span(), HallFault::NoCorner(corner.len()))),
            };
            let corners = corners.get_ref().iter().map(corner).collect::<Result<_, _>>()?;
            Ok(Area { name: name.get_ref().as_str().into(), probability: *probability.get_ref(), corners })
        };
        let areas = given.iter().map(area).collect::<Result<Vec<Area>, HallError>>()?;
        // Faults are found in columns and rows of the drawing, so that the author understands their cells.
        let (columns, rows) = (hall.bounds().width(), hall.bounds().height());
        let drawing = Bounds { least: Cell::HOME, most: Cell::new(columns - 1, rows - 1) };
        Area::check(&areas, drawing).map_err(|(index, fault)| {
            let NamedArea { name, probability, corners } = &given[index];
            let span = match fault {
                AreaFault::TooMany(_) | AreaFault::Name | AreaFault::SameName => name.span(),
                AreaFault::Probability | AreaFault::Sum => probability.span(),
                AreaFault::Corners(_) | AreaFault::Outside(_) | AreaFault::Overlap(..) => corners.span(),
            };
            let name = name.get_ref().chars().take(Area::NAME).collect();
            self.at(&span, HallFault::Area { name, fault, columns, rows })
        })?;
        let areas = relative_to(hall.home(), &areas);
        let of_walls = |area: &Area| area.cells().all(|cell| hall.truth(cell) == Truth::Wall);
        match areas.iter().zip(given).find(|(area, _)| of_walls(area)) {
            Some((area, given)) => Err(self.at(&given.corners.span(), HallFault::AreaOfWalls(area.name.to_string()))),
            None => Ok(areas),
        }
    }

    fn curve(&self, keyframes: &[Keyframe]) -> Result<Option<Curve>, HallError> {
        let mut keys: Vec<(f64, Celsius)> = Vec::new();
        for keyframe in keyframes {
            let at_s = self.within("at_s", Some(&keyframe.at_s), 0.0..=MAX_SECONDS)?.unwrap_or(0.0);
            let degrees = self.within("celsius", Some(&keyframe.celsius), Celsius::LEAST..=Celsius::MOST)?;
            let celsius = degrees.and_then(Celsius::new).expect("the checked limits are those of Celsius");
            if let Some((before, _)) = keys.last().filter(|(before, _)| at_s <= *before) {
                let fault = HallFault::TemperatureOrder { at: at_s.to_string(), before: before.to_string() };
                return Err(self.at(&keyframe.at_s.span(), fault));
            }
            if keys.len() == MAX_TEMPERATURES {
                return Err(self.at(&keyframe.at_s.span(), HallFault::TooManyTemperatures(MAX_TEMPERATURES)));
            }
            keys.push((at_s, celsius));
        }
        Ok(Curve::through(keys))
    }
}

/// Writes the hall as a file. Pieces that need a description get letters, as long as letters are left. The other
/// pieces are drawn as `T`, and the file says so.
pub(super) fn write(hall: &Hall) -> String {
    let letters = letters(hall.pieces());
    let mut text = String::new();
    // If the name is too long for the key, it is left out. The reader then takes the name from the file name.
    if (1..=64).contains(&hall.name().chars().count()) {
        key(&mut text, "name", &toml::Value::from(hall.name()));
    }
    if let Some(description) = &hall.description {
        key(&mut text, "description", &toml::Value::from(&**description));
    }
    key(&mut text, "cell_m", &hall.cell_m());
    let without = hall.pieces().iter().filter(|bag| needs_words(bag)).count() - letters.len();
    if without > 0 {
        let _ = writeln!(text, "\n# {without} pieces are drawn as T without their words, since there are only 26 letters.");
    }
    let home = hall.home();
    text.push_str("\ndrawing = \"\"\"\n");
    for (y, row) in (0..).zip(hall.rows()) {
        text.extend((0..).zip(row).map(|(x, truth)| match truth {
            Truth::Free if (x, y) == (home.x, home.y) => 'S',
            Truth::Free => '.',
            Truth::Wall => '#',
            Truth::Luggage(piece) => letters.get(piece).copied().unwrap_or('T'),
        }));
        text.push('\n');
    }
    text.push_str("\"\"\"\n");
    for bag in hall.pieces() {
        if let Some(mark) = letters.get(&bag.piece) {
            describe(&mut text, *mark, bag);
        }
    }
    for Area { name, probability, corners } in &*relative_to(hall.bounds().least, hall.areas()) {
        let corners: Vec<String> = corners.iter().map(|Cell { x, y }| format!("[{x}, {y}]")).collect();
        let (name, corners) = (toml::Value::from(&**name), corners.join(", "));
        let _ = write!(text, "\n[[area]]\nname = {name}\nprobability = {probability}\ncorners = [{corners}]\n");
    }
    for (at_s, celsius) in hall.curve().map_or(&[][..], Curve::keys) {
        let _ = write!(text, "\n[[temperature]]\nat_s = {at_s}\ncelsius = {}\n", celsius.degrees());
    }
    text
}

fn key(text: &mut String, key: &str, value: &dyn std::fmt::Display) {
    let _ = writeln!(text, "{key} = {value}");
}

fn describe(text: &mut String, mark: char, bag: &Bag) {
    let Colour { red, green, blue } = bag.colour;
    let named = Colour::NAMED.into_iter().find(|(_, colour)| *colour == bag.colour);
    let colour = named.map_or_else(|| format!("#{red:02x}{green:02x}{blue:02x}"), |(name, _)| name.to_owned());
    let kind = bag.kind.name();
    let _ = write!(text, "\n[[luggage]]\nmark = \"{mark}\"\nkind = \"{kind}\"\ncolour = \"{colour}\"\n");
    if bag.height_m.to_bits() != bag.kind.usual_height_m().to_bits() {
        key(text, "height_m", &bag.height_m);
    }
    if bag.dangerous {
        key(text, "dangerous", &true);
    }
}

/// Whether a piece needs a description, because a plain `T` would be read as a different piece.
fn needs_words(bag: &Bag) -> bool {
    bag.cells.len() != 1 || *bag != Bag::plain(bag.piece, bag.cells.clone())
}

/// A letter for every piece that needs a description. If more than 26 pieces need one, dangerous pieces get letters
/// first, then pieces of several cells.
fn letters(bags: &[Bag]) -> BTreeMap<Piece, char> {
    let mut wanted: Vec<&Bag> = bags.iter().filter(|bag| needs_words(bag)).collect();
    wanted.sort_by_key(|bag| (!bag.dangerous, bag.cells.len() == 1, bag.piece));
    let chosen: BTreeSet<Piece> = wanted.into_iter().map(|bag| bag.piece).take(('a'..='z').count()).collect();
    chosen.into_iter().zip('a'..='z').collect()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const HALL: &str = r##"name = "two bags"
drawing = """
  S.a
  .ba
"""
[[luggage]]
mark = "a"
kind = "trolley"
colour = "#b8222a"
dangerous = true

[[luggage]]
mark = "b"
kind = "box"
colour = "brown"
height_m = 0.3

[[temperature]]
at_s = 0
celsius = 21.5
"##;

    /// A hall with three columns and two rows. The areas begin at line 6.
    fn with_areas(areas: &str) -> String {
        format!("drawing = '''\nS.#\n..#\n'''\n{areas}")
    }

    fn area(name: &str, probability: &str, corners: &str) -> String {
        format!("[[area]]\nname = \"{name}\"\nprobability = {probability}\ncorners = {corners}\n")
    }

    fn check(text: &str, expect: &str) {
        let error = read("halls/x.toml", "x", text).expect_err("this hall has a fault").to_string();
        assert!(error.starts_with(expect), "expected {expect}\n     got {error}");
    }

    #[test]
    fn a_hall_file_is_read_whole() {
        let hall = read("halls/x.toml", "x", HALL).unwrap();
        assert_eq!(hall.name(), "two bags");
        assert_eq!(hall.curve().map(|curve| curve.at(Duration::from_secs(9))), Celsius::new(21.5));
        let [a, b] = hall.pieces() else { panic!("two pieces are drawn") };
        assert_eq!((a.kind, &*a.name, a.cells.len(), a.dangerous), (BagKind::Trolley, "red trolley", 2, true));
        assert_eq!((b.kind, b.height_m, b.dangerous), (BagKind::Box, 0.3, false));
    }

    #[test]
    fn a_t_needs_no_description_and_can_have_none() {
        let hall = read("halls/x.toml", "x", &HALL.replace("S.a", "STa")).unwrap();
        let [t, a, b] = hall.pieces() else { panic!("three pieces are drawn") };
        assert_eq!((t.piece, t.cells.len(), t.dangerous), (Piece(1), 1, false));
        assert_eq!((&*a.name, &*b.name), ("red trolley", "brown box"));
        let described = HALL.replace("S.a", "STa").replace("mark = \"b\"", "mark = \"T\"");
        check(&described, "halls/x.toml:13: the mark \"T\" is not one letter a–z");
    }

    #[test]
    fn an_empty_hall_needs_only_its_size() {
        let hall = read("e.toml", "e", "width = 3\nheight = 2\n").unwrap();
        assert_eq!((hall.name(), hall.reachable().len()), ("e", 6));
    }

    #[test]
    fn faults_of_the_drawing_are_found_at_their_row() {
        let ragged = HALL.replace("  .ba", "  .baaaaaaa");
        check(&ragged, "halls/x.toml:4: row 2 has 9 columns, row 1 has 3: make all rows equally long");
        check(&HALL.replace(".ba", ".b?"), "halls/x.toml:4: row 2 has '?' in column 3");
        check(&HALL.replace('S', "."), "halls/x.toml:2: there is no start");
        check(&HALL.replace(".ba", "Sba"), "halls/x.toml:4: there is a second start `S` in row 2, column 1");
        check(&HALL.replace("S.a", "S.c"), "halls/x.toml:2: luggage `c` is in the drawing but not described");
    }

    #[test]
    fn faults_of_the_luggage_are_found_at_their_key() {
        check(
            &HALL.replace("mark = \"b\"", "mark = \"z\""),
            "halls/x.toml:13: luggage \"z\" is described but not in the drawing",
        );
        check(&HALL.replace("mark = \"b\"", "mark = \"bb\""), "halls/x.toml:13: the mark \"bb\" is not one letter a–z");
        check(&HALL.replace("mark = \"b\"", "mark = \"a\""), "halls/x.toml:13: luggage `a` is described twice");
        check(&HALL.replace("\"box\"", "\"crate\""), "halls/x.toml:14: \"crate\" is not a kind of luggage: use suitcase");
        check(&HALL.replace("brown", "mud"), "halls/x.toml:15: \"mud\" is not a colour: use #rrggbb or one of red,");
        check(&HALL.replace("0.3", "nan"), "halls/x.toml:16: `height_m` is NaN: give a number from 0.1 to 2");
    }

    #[test]
    fn faults_of_size_temperature_and_toml_are_found_at_their_line() {
        check("width = 0\nheight = 4\n", "halls/x.toml:1: a hall of 0 × 4 cells has no floor");
        check("width = 9000\nheight = 4\n", "halls/x.toml:1: a hall of 9000 × 4 cells is too large");
        check("width = 4\nheight = 9000\n", "halls/x.toml:2: a hall of 4 × 9000 cells is too large");
        check("width = -1\nheight = 4\n", "halls/x.toml:1: `width` is -1: give a number from 1 to 2048");
        check("width = 3\nheight = -7\n", "halls/x.toml:2: `height` is -7: give a number from 1 to 2048");
        check("width = 3\n", "halls/x.toml:1: `height` is missing");
        check("# A hall.\nheight = 3\n", "halls/x.toml:2: `width` is missing");
        check("name = \"x\"\n", "halls/x.toml: `drawing` is missing");
        check(&format!("width = 3\n{HALL}"), "halls/x.toml:3: `drawing` and `width`/`height` are both given");
        check(&HALL.replace("21.5", "5000"), "halls/x.toml:20: `celsius` is 5000: give a number from -60 to 1000");
        check(&format!("{HALL}[[temperature]]\nat_s = 0\ncelsius = 3\n"), "halls/x.toml:22: the temperature at 0 s comes after");
        check("width = 3\nheight = 3\nwidht = 4\n", "halls/x.toml:3: unknown field `widht`, expected one of `name`");
        check("width = 3\nheight = = 3\n", "halls/x.toml:2: ");
        check("width = 3.5\nheight = 3\n", "halls/x.toml:1: invalid type: floating point `3.5`, expected a whole number");
        check("name = \"\"\nwidth = 1\nheight = 1\n", "halls/x.toml:1: `name` has 0 characters: give 1 to 64");
    }
    #[test]
    fn areas_are_counted_from_the_corner_of_the_drawing_in_the_file_and_from_the_start_on_the_map() {
        let text = HALL.replace("S.a", ".Sa") + &area("gate 1", "0.25", "[[0, 0], [1, 1]]") + &area("b", "0", "[[2, 0]]");
        check(&text, "halls/x.toml:28: area \"b\": the area has 1 corners: give 2 to 32, two for a rectangle");
        let hall = read("x", "x", &text.replace("[[2, 0]]", "[[2, 0], [2, 1], [2, 0]]")).unwrap();
        let [gate, line] = &**hall.areas() else { panic!("two areas: {:?}", hall.areas()) };
        assert_eq!((&*gate.name, gate.probability, &*line.name, line.probability), ("gate 1", 0.25, "b", 0.0));
        assert_eq!(*gate.corners, [Cell::new(-1, 0), Cell::new(0, 1)]);
        assert_eq!(line.cells().collect::<Vec<_>>(), [Cell::new(1, 0), Cell::new(1, 1)]);
        let moved = hall.clone().starting_at((0, 1)).unwrap();
        assert_eq!(*moved.areas()[0].corners, [Cell::new(0, -1), Cell::new(1, 0)]);
        for other in [hall.rearranged(&BTreeMap::new()), hall.blocked(&BTreeSet::from([Cell::HOME])), hall.clone().called("y")] {
            assert_eq!(other.areas(), hall.areas());
        }
        let empty = read("x", "x", &(String::from("width = 9\nheight = 9\n") + &area("a", "1", "[[8, 8], [0, 0]]"))).unwrap();
        assert_eq!(empty.areas()[0].cells().count(), 81, "a hall without a drawing has areas, too");
    }

    #[test]
    fn faults_of_areas_are_found_at_their_line_with_columns_and_rows_of_the_file() {
        let good = area("a", "0.6", "[[0, 0], [1, 0]]");
        let says = |text: &str, expect: &str| check(&with_areas(text), &format!("halls/x.toml:{expect}"));
        let corners = "correct the corners of this area (column and row, counted from 0 in the north-west corner; this hall has";
        let place = format!("{corners} 3 × 2 cells)");
        let outside = |corner: &str| format!("8: area \"a\": the corner {corner} is outside the hall: {place}");
        says(&area("a", "0.6", "[[0, 0], [3, 0]]"), &outside("(3, 0)"));
        says(&area("a", "0.6", "[[0, -1], [1, 0]]"), &outside("(0, -1)"));
        says(&area("a", "0.6", "[[0, 0], [2147483647, -2147483648]]"), &outside("(2147483647, -2147483648)"));
        let overlap = format!("12: area \"b\": the cell (1, 0) is in the area \"a\" too: {place}");
        says(&(good.clone() + &area("b", "0.1", "[[1, 0], [1, 1]]")), &overlap);
        says(&(good.clone() + &area("a", "0.1", "[[0, 1], [1, 1]]")), "10: area \"a\": an earlier area has the same name");
        says(
            &(good.clone() + &area("b", "0.5", "[[0, 1], [1, 1]]")),
            "11: area \"b\": the probabilities of the areas up to this one",
        );
        says(&area("a", "0.6", "[[2, 0], [2, 1]]"), "8: area \"a\": it has only walls: give corners round floor or luggage");
        for number in ["nan", "inf", "-inf", "-0.1", "1.1", "1e308"] {
            says(&area("a", number, "[[0, 0], [1, 0]]"), "7: area \"a\": the probability is a number from 0 to 1");
        }
        for name in ["", " a", "a\\n", &"n".repeat(41)] {
            let said = read("x", "x", &with_areas(&area(name, "0.6", "[[0, 0], [1, 0]]"))).unwrap_err().to_string();
            assert!(said.starts_with("x:6: area \""), "{said}");
            assert!(said.ends_with(": the name of an area is one line of 1 to 40 visible characters"), "{said}");
        }
        let polygon = |corners: usize| format!("[{}]", "[0, 0], ".repeat(corners));
        assert!(read("x", "x", &with_areas(&area("a", "0.6", &polygon(32)))).is_ok());
        for (corners, given) in [("[]".to_owned(), 0), (polygon(33), 33), (polygon(100_000), 100_000)] {
            says(&area("a", "0.6", &corners), &format!("8: area \"a\": the area has {given} corners: give 2 to 32"));
        }
        for (corners, wrong) in [("[[99999999999, 0], [1, 1]]", "99999999999"), ("[[0.5, 0], [1, 1]]", "0.5")] {
            let error = read("x", "x", &with_areas(&area("a", "0.6", corners))).unwrap_err().to_string();
            assert!(error.starts_with("x:8: invalid ") && error.contains(wrong), "{error}");
            assert!(error.ends_with("expected a column or row of the hall: correct this line"), "{error}");
        }
        says(&area("a", "0.6", "[[0, 0, 0], [1, 1]]"), "8: a corner has 3 numbers: give its column and its row");
        says(&area("a", "\"half\"", "[[0, 0], [1, 1]]"), "7: invalid type: string \"half\", expected a number");
        says(&format!("{good}colour = \"red\"\n"), "9: unknown field `colour`, expected one of `name`, `probability`");
        says("[[area]]\nname = \"a\"\n", "5: missing field `probability`");
        let many: String = (0..10_000).map(|n| area(&format!("a{n}"), "0", "[[0, 0], [1, 0]]")).collect();
        says(&many, "262: area \"a64\": there are 10000 areas: give at most 64");
    }
}
