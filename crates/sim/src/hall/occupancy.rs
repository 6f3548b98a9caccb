//! Reads and writes the maps of ROS `map_server`: a YAML file that says what the greys of an image mean. The image is
//! read by `pixels`.
//!
//! Pixels are judged as in the `map_io` of ROS 2 (Nav2). `occ` is the darkness of a pixel, or its lightness if
//! `negate` is set. A pixel with `occ` above `occupied_thresh` is occupied, and one below `free_thresh` is free. A
//! pixel in between is unknown in mode trinary, and a percentage in mode scale.

use serde::Deserialize;
use serde_saphyr::Spanned;

use super::error::{HallError, HallFault};
use super::pixel::{MAX_IMAGE_SIDE, Pixel};
use super::pixels::Image;
use super::rows::{self, DrawingRows, drawn};
use super::{Hall, Truth, USUAL_CELL_M, pgm};
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Mark;

/// Largest YAML file, in bytes. A description has a few lines, and the rest is room for comments.
pub(super) const MAX_YAML_BYTES: u64 = 64 << 10;

/// Shortest and longest side of a cell in metres, as in hall files.
const CELL_M: std::ops::RangeInclusive<f64> = 0.1..=5.0;

/// Two borders of a cell and a pixel count as the same border if they are at most this far apart, in pixels. The
/// limit is needed because decimal fractions are not exact.
const NEAR: f64 = 1e-4;

/// Largest relative error of a decimal number that the usual map tools stored as a 32-bit float. A yaw (rotation)
/// below this limit moves no point of the image by a whole pixel.
const ROUNDING: f64 = 1e-6;

/// The grey of a free cell. `map_saver` of ROS writes the same three greys for free, occupied and unknown cells.
const FREE: u8 = 254;
const OCCUPIED: u8 = 0;
const UNKNOWN: u8 = 205;

/// The grey of luggage. A reader that does not know this grey takes it for occupied.
const LUGGAGE: u8 = 50;

/// The thresholds that `map_saver` writes. A pixel of 205 is (255 − 205) / 255 = 0.1961 dark, so it is not free.
const GREYS: &str = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

#[derive(Deserialize)]
struct File {
    image: Option<Spanned<String>>,
    resolution: Option<Spanned<f64>>,
    origin: Option<Spanned<Vec<f64>>>,
    negate: Option<Spanned<Negate>>,
    occupied_thresh: Option<Spanned<f64>>,
    free_thresh: Option<Spanned<f64>>,
    mode: Option<Spanned<String>>,
    hallsweep: Option<Spanned<Own>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Negate {
    Said(bool),
    Number(i64),
}

/// Additional keys that this program writes. `map_server` ignores them.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Own {
    cell_m: f64,
    luggage: u8,
    /// Column and row of the robot's start, counted from 0 in the north-west corner.
    home: (u32, u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Trinary,
    Scale,
    Raw,
}

#[derive(Debug)]
pub(super) struct Description {
    /// The path of the image as the YAML file has it, and the line of the path in the file.
    pub(super) image: String,
    pub(super) image_line: usize,
    resolution: f64,
    /// The south-west corner of the image, in metres to the east and to the north.
    origin: [f64; 2],
    mode: Mode,
    negate: bool,
    occupied_thresh: f64,
    free_thresh: f64,
    own: Option<(Own, usize)>,
}

pub(super) fn describe(file: &str, text: &str) -> Result<Description, HallError> {
    let content: File = serde_saphyr::from_str_with_options(text, limits()).map_err(|error| syntax(file, &error))?;
    let image = content.image.ok_or_else(|| missing("`image`", "name the image file").of(file))?;
    let resolution = content.resolution.ok_or_else(|| missing("`resolution`", "give the width of a pixel in metres").of(file))?;
    let origin = content.origin.ok_or_else(|| missing("`origin`", "give [x, y, yaw], for example [0, 0, 0]").of(file))?;
    let negate = content.negate.ok_or_else(|| missing("`negate`", "give 0 if dark pixels are occupied, else 1").of(file))?;
    let threshold = |key, what, given: Option<Spanned<f64>>| {
        let given = given.ok_or_else(|| missing(what, "give a darkness from 0 to 1").of(file))?;
        within(file, key, given.value, 0.0..=1.0, line(&given))
    };
    let own = content.hallsweep.map(|own| (own.value, line(&own)));
    if let Some((own, line)) = own {
        within(file, "cell_m", own.cell_m, CELL_M, line)?;
    }
    let corner = corner(&origin.value).map_err(|fault| fault.at(file, line(&origin)))?;
    Ok(Description {
        image_line: line(&image),
        image: image.value,
        origin: corner,
        resolution: within(file, "resolution", resolution.value, 0.001..=*CELL_M.end(), line(&resolution))?,
        mode: content.mode.map_or(Ok(Mode::Trinary), |mode| {
            Mode::named(&mode.value).ok_or_else(|| HallFault::UnknownMode(mode.value.clone()).at(file, line(&mode)))
        })?,
        negate: match negate.value {
            Negate::Said(negate) => negate,
            Negate::Number(0) => false,
            Negate::Number(1) => true,
            Negate::Number(other) => return Err(HallFault::UnknownNegate(other).at(file, line(&negate))),
        },
        occupied_thresh: threshold("occupied_thresh", "`occupied_thresh`", content.occupied_thresh)?,
        free_thresh: threshold("free_thresh", "`free_thresh`", content.free_thresh)?,
        own,
    })
}

/// Limits for the YAML parser. A dozen keys need neither aliases nor deep nesting.
fn limits() -> serde_saphyr::Options {
    serde_saphyr::options! {
        budget: serde_saphyr::budget! { max_events: 4096, max_aliases: 64, max_anchors: 64, max_depth: 16, max_documents: 1 },
        alias_limits: serde_saphyr::alias_limits! { max_total_replayed_events: 4096, max_replay_stack_depth: 4 },
    }
}

fn line<T>(spanned: &Spanned<T>) -> usize {
    usize::try_from(spanned.referenced.line()).unwrap_or(1)
}

fn missing(key: &'static str, what: &'static str) -> HallFault {
    HallFault::Missing(key, what)
}

fn within(
    file: &str,
    key: &'static str,
    value: f64,
    limits: std::ops::RangeInclusive<f64>,
    line: usize,
) -> Result<f64, HallError> {
    let (least, most) = (limits.start().to_string(), limits.end().to_string());
    let fault = HallFault::OutOfRange { key, value: value.to_string(), least, most };
    if limits.contains(&value) { Ok(value) } else { Err(fault.at(file, line)) }
}

/// Returns the first two numbers of the origin, in metres to the east and to the north. The third number, the yaw,
/// must be zero.
fn corner(origin: &[f64]) -> Result<[f64; 2], HallFault> {
    let [x, y, yaw] = origin else { return Err(HallFault::OriginLength(origin.len())) };
    for value in [x, y] {
        if !value.is_finite() {
            let (least, most) = (f64::MIN.to_string(), f64::MAX.to_string());
            return Err(HallFault::OutOfRange { key: "origin", value: value.to_string(), least, most });
        }
    }
    if yaw.abs() < ROUNDING { Ok([*x, *y]) } else { Err(HallFault::Turned(yaw.to_string())) }
}

fn syntax(file: &str, error: &serde_saphyr::Error) -> HallError {
    let formatter = serde_saphyr::UserMessageFormatter;
    let said = error.without_snippet().render_with_formatter(&formatter);
    let fault = HallFault::Syntax(format!("{}: correct this line", said.lines().next().unwrap_or("this is not YAML")));
    match error.location().and_then(|location| usize::try_from(location.line()).ok()).filter(|line| *line > 0) {
        Some(line) => fault.at(file, line),
        None => fault.of(file),
    }
}

impl Mode {
    fn named(name: &str) -> Option<Mode> {
        match name.to_ascii_lowercase().as_str() {
            "trinary" => Some(Mode::Trinary),
            "scale" => Some(Mode::Scale),
            "raw" => Some(Mode::Raw),
            _ => None,
        }
    }
}

impl Description {
    /// Makes the hall of this image. `cell_m` is the side of a cell in metres, if the user sets it.
    pub(super) fn hall(
        &self,
        file: &str,
        name: &str,
        image_file: &str,
        image: &[u8],
        cell_m: Option<f64>,
    ) -> Result<Hall, HallError> {
        let cell_m = self.cell_m(cell_m).map_err(|fault| fault.of(file))?;
        let of_image = |fault: HallFault| fault.of(image_file);
        let mut image = Image::open(image).map_err(of_image)?;
        let (columns, rows) = image.size();
        // Pixels per cell. For example, 0.5 m divided by 0.05 m is 10. The file may have 0.0500000007 m because of a
        // 32-bit float.
        let exact = cell_m / self.resolution;
        let ratio = if is_same(exact, exact.round()) { exact.round() } else { exact };
        let (columns, rows) = (Cells::over(columns, ratio), Cells::over(rows, ratio));
        let size = rows::sides(columns.count as u64, rows.count as u64).map_err(of_image)?;
        let mut truths = vec![PixelGround::Free; columns.count * rows.count];
        let mut pixels = Vec::new();
        for above in &rows.of_pixel {
            image.next_row(&mut pixels).map_err(of_image)?;
            for (pixel, beside) in pixels.iter().zip(&columns.of_pixel) {
                let ground = self.ground(*pixel);
                for row in above.clone() {
                    for truth in &mut truths[row * columns.count..][beside.clone()] {
                        *truth = ground.max(*truth);
                    }
                }
            }
        }
        let mut reading = DrawingRows::default();
        for (index, ground) in truths.into_iter().enumerate() {
            let cell = drawn(index % columns.count, index / columns.count);
            let truth = match ground {
                PixelGround::Free => Truth::Free,
                PixelGround::Luggage => Truth::Luggage(reading.new_piece(cell).map_err(of_image)?),
                PixelGround::Blocked => Truth::Wall,
            };
            reading.squares.push(truth);
        }
        let usual = self.world_home(&reading, &columns, &rows).or_else(|| reading.start_in_largest_part(columns.count));
        let usual = usual.ok_or_else(|| of_image(HallFault::NoFreeCell))?;
        let home = self.home(&reading, usual, columns.count).map_err(|(fault, line)| fault.at(file, line))?;
        Ok(Hall::of(name, reading.plan(home, size)).measured(cell_m, None))
    }

    /// The side of a cell in metres. It is taken from the user, from the file, or from `USUAL_CELL_M`. It is at least
    /// one pixel.
    fn cell_m(&self, asked: Option<f64>) -> Result<f64, HallFault> {
        let Some(asked) = asked else {
            return Ok(self.own.map_or(USUAL_CELL_M.max(self.resolution), |(own, _)| own.cell_m.max(self.resolution)));
        };
        let value = asked.to_string();
        if !CELL_M.contains(&asked) {
            let (least, most) = (CELL_M.start().to_string(), CELL_M.end().to_string());
            return Err(HallFault::OutOfRange { key: "--cell", value, least, most });
        }
        if let Some((own, _)) = self.own.filter(|(own, _)| !is_same(own.cell_m, asked)) {
            return Err(HallFault::CellGiven { asked: value, has: own.cell_m.to_string() });
        }
        if asked < self.resolution && !is_same(asked, self.resolution) {
            return Err(HallFault::CellTooFine { cell: value, resolution: self.resolution.to_string() });
        }
        Ok(asked)
    }

    /// The cell that contains the world's (0, 0), if that cell is free. The robot that made the map usually stood
    /// there. The origin is the south-west corner of the image.
    fn world_home(&self, reading: &DrawingRows, columns: &Cells, rows: &Cells) -> Option<Cell> {
        let [east, north] = self.origin.map(|metres| -metres / self.resolution);
        let (column, row) =
            (columns.of_pixel.get(pixel_at(east)?)?.start, rows.of_pixel.iter().rev().nth(pixel_at(north)?)?.start);
        (reading.squares.get(row * columns.count + column) == Some(&Truth::Free)).then(|| drawn(column, row))
    }

    fn home(&self, reading: &DrawingRows, usual: Cell, columns: usize) -> Result<Cell, (HallFault, usize)> {
        let Some((Own { home: (x, y), .. }, line)) = self.own else { return Ok(usual) };
        let place = (x as usize, y as usize);
        let square = reading.squares.get(place.1.saturating_mul(columns).saturating_add(place.0));
        if place.0 < columns && square == Some(&Truth::Free) {
            Ok(drawn(place.0, place.1))
        } else {
            Err((HallFault::HomeNotFree { x, y }, line))
        }
    }

    fn ground(&self, pixel: Pixel) -> PixelGround {
        match self.own {
            Some((own, _)) if pixel.shade == f64::from(own.luggage) / 255.0 => PixelGround::Luggage,
            _ if self.is_free(pixel) => PixelGround::Free,
            _ => PixelGround::Blocked,
        }
    }

    fn is_free(&self, pixel: Pixel) -> bool {
        // In mode trinary, a pixel's lightness is the mean of its three colours and its opacity.
        let shade = match (self.mode, pixel.alpha) {
            (Mode::Trinary, Some(alpha)) => (3.0 * pixel.shade + alpha) / 4.0,
            _ => pixel.shade,
        };
        let occ = if self.negate { shade } else { 1.0 - shade };
        match self.mode {
            Mode::Trinary => occ <= self.occupied_thresh && occ < self.free_thresh,
            Mode::Scale => {
                let share = (occ - self.free_thresh) / (self.occupied_thresh - self.free_thresh);
                let is_opaque = pixel.alpha.is_none_or(|alpha| alpha == 1.0);
                is_opaque && occ <= self.occupied_thresh && (occ < self.free_thresh || (share * 100.0).round_ties_even() == 0.0)
            }
            Mode::Raw => (pixel.shade * 255.0).round() == 0.0,
        }
    }
}

/// What a pixel shows. The order matters: a cell gets the greatest value among its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum PixelGround {
    Free,
    Luggage,
    Blocked,
}

/// How the pixels along one side of an image are divided into cells.
struct Cells {
    count: usize,
    of_pixel: Vec<std::ops::Range<usize>>,
}

impl Cells {
    /// Divides a side of the image into cells of `ratio` pixels, starting at the first pixel. There is at least one
    /// cell. The last cell may have fewer pixels.
    fn over(pixels: u32, ratio: f64) -> Cells {
        let near = |border: f64| (border.round(), (border - border.round()).abs() * ratio < NEAR);
        let begin = |border: f64| whole(if near(border).1 { near(border).0 } else { border.floor() });
        let end = |border: f64| whole(if near(border).1 { near(border).0 } else { border.ceil() });
        let of_pixel = |pixel: u32| begin(f64::from(pixel) / ratio)..end(f64::from(pixel + 1) / ratio);
        Cells { count: end(f64::from(pixels) / ratio).max(1), of_pixel: (0..pixels).map(of_pixel).collect() }
    }
}

/// Whether two numbers differ only by rounding.
pub(super) fn is_same(one: f64, other: f64) -> bool {
    (one - other).abs() < ROUNDING * one.abs()
}

/// The number of the pixel at this distance from the image's edge. Pixels and distance are counted from 0. `None` if
/// the distance is not within an image of the largest size.
fn pixel_at(pixels: f64) -> Option<usize> {
    let is_near = (pixels - pixels.round()).abs() < NEAR;
    let begun = if is_near { pixels.round() } else { pixels.floor() };
    (0.0..f64::from(MAX_IMAGE_SIDE)).contains(&begun).then(|| whole(begun))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an image has at most some thousand pixels a side")]
fn whole(cells: f64) -> usize {
    cells as usize
}

pub(super) fn yaml(hall: &Hall, image_file: &str) -> String {
    let (bounds, home, cell_m) = (hall.bounds(), hall.home(), hall.cell_m());
    // The centre of the home cell is the world's (0, 0). The image is placed by its south-west corner, rounded to a
    // micrometre.
    let metres = |cells: i32| (-(f64::from(cells) + 0.5) * cell_m * 1e6).round() / 1e6;
    let (x, y) = (metres(home.x), metres(bounds.height() - 1 - home.y));
    format!(
        "image: {}\nmode: trinary\nresolution: {cell_m}\norigin: [{x}, {y}, 0]\n{GREYS}\
         hallsweep: {{cell_m: {cell_m}, luggage: {LUGGAGE}, home: [{}, {}]}}\n",
        quoted(image_file),
        home.x,
        home.y
    )
}

/// The image of the hall, with one pixel per cell. Each square comes with what the robot knows of it.
pub(super) fn image(hall: &Hall, squares: impl Iterator<Item = (Truth, Option<Mark>)>) -> Vec<u8> {
    let grey = |(truth, mark): (Truth, Option<Mark>)| match truth {
        Truth::Free => FREE,
        Truth::Luggage(_) => LUGGAGE,
        Truth::Wall if mark == Some(Mark::Unknown) => UNKNOWN,
        Truth::Wall => OCCUPIED,
    };
    let pixels: Vec<u8> = squares.map(grey).collect();
    pgm::write(usize::try_from(hall.bounds().width()).unwrap_or(1), &pixels)
}

/// Writes a file name for YAML, in quotes if it needs them.
fn quoted(name: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "._-".contains(letter);
    let is_plain = name.starts_with(|first: char| first.is_ascii_alphabetic()) && name.chars().all(plain);
    if is_plain { name.to_owned() } else { serde_json::Value::from(name).to_string() }
}

#[cfg(test)]
#[path = "occupancy_tests.rs"]
mod tests;
