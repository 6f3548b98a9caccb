//! Faults of hall files. Each message tells the author of the file the place, the reason, and what to do. The code
//! that reads a format finds the faults of its files.

use std::fmt;

use hallsweep_core::world::areas::AreaFault;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HallError {
    /// The file. If the hall does not come from a file, the name of the hall.
    pub file: String,
    /// The line, counted from 1, if the fault has a line.
    pub line: Option<usize>,
    /// Boxed to keep the error small: it should not be larger than the value that a successful call returns.
    pub fault: Box<HallFault>,
}

impl fmt::Display for HallError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.fault),
            None => write!(f, "{}: {}", self.file, self.fault),
        }
    }
}

impl std::error::Error for HallError {}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HallFault {
    #[error("cannot read this file ({0}): give the path of a .toml, .map, .yaml or .txt file, or one of the built-in halls {1}")]
    Unreadable(String, String),
    #[error("this file is larger than {0} bytes: a hall has at most 2048 × 2048 cells")]
    FileTooLarge(u64),
    #[error("this image is larger than {0} bytes: save it with larger pixels")]
    ImageFileTooLarge(u64),
    #[error("this file is larger than {0} bytes: the description of an image has a few lines")]
    YamlTooLarge(u64),
    #[error("this file is not UTF-8 text: save it as UTF-8")]
    NotText,
    #[error(
        "this is not a hall: a hall file is TOML with a `drawing`, or with `width` and `height`; a MovingAI map begins with \
         `type octile`; a ROS map is given by its .yaml; a map in text has only `r` `1` `0` `X`"
    )]
    NoHall,
    #[error("{0}")]
    Syntax(String),
    #[error("{0} is missing: {1}")]
    Missing(&'static str, &'static str),
    #[error("`drawing` and `width`/`height` are both given: keep the drawing, or the size of an empty hall")]
    DrawingAndSize,
    #[error("a hall of {0} × {1} cells has no floor: give at least one column and one row")]
    Empty(u64, u64),
    #[error("a hall of {0} × {1} cells is too large: at most {2} × {2} cells are allowed")]
    TooLarge(u64, u64, usize),
    #[error("row {row} has {columns} columns, row 1 has {first}: make all rows equally long")]
    Ragged { row: usize, columns: usize, first: usize },
    #[error("row {row} has {mark:?} in column {column}: use `.` (free), `#` (wall), `S` (start), a letter a–z or `T` (luggage)")]
    UnknownSquare { row: usize, column: usize, mark: char },
    #[error("there is no start: put one `S` into the drawing where the robot starts")]
    NoStart,
    #[error("there is a second start `S` in row {row}, column {column}: keep only one")]
    SecondStart { row: usize, column: usize },
    #[error("luggage `{0}` is drawn in places that do not touch: give each piece a letter of its own")]
    Scattered(char),
    #[error("luggage `{0}` is in the drawing but not described: add a [[luggage]] with mark = \"{0}\"")]
    Undescribed(char),
    #[error("luggage {0:?} is described but not in the drawing: draw it, or remove this [[luggage]]")]
    Undrawn(String),
    #[error("the mark {0:?} is not one letter a–z: use the letter from the drawing (a `T` has no description)")]
    NotAMark(String),
    #[error("luggage `{0}` is described twice: keep one description")]
    DescribedTwice(char),
    #[error("{0:?} is not a kind of luggage: use suitcase, backpack, trolley, duffel, box or handbag")]
    UnknownKind(String),
    #[error("{0:?} is not a colour: use #rrggbb or one of {1}")]
    UnknownColour(String, String),
    #[error("`{key}` is {value}: give a number from {least} to {most}")]
    OutOfRange { key: &'static str, value: String, least: String, most: String },
    #[error("`name` has {0} characters: give 1 to 64")]
    NameLength(usize),
    #[error("`description` has {0} characters: at most 1000 are allowed")]
    DescriptionLength(usize),
    #[error("there are more than {0} pieces of luggage: remove some")]
    TooManyPieces(usize),
    #[error("there are more than {0} temperatures: remove some")]
    TooManyTemperatures(usize),
    #[error(
        "the temperature at {at} s comes after the one at {before} s: sort the temperatures by time, with each time only once"
    )]
    TemperatureOrder { at: String, before: String },
    #[error("a corner has {0} numbers: give its column and its row")]
    NoCorner(usize),
    #[error("area \"{name}\": {fault}{}", place(fault, *columns, *rows))]
    Area { name: String, fault: AreaFault, columns: i32, rows: i32 },
    #[error("area \"{0}\": it has only walls: give corners round floor or luggage, or remove the area")]
    AreaOfWalls(String),
    #[error("the speed of the player is {0}, or missing: give the speed of the page, from 0.014 (5 s per cell) to 1.33 (50 ms)")]
    PlayerSpeed(String),
    #[error("this is not a MovingAI map: line {line} {} instead of `{form}`", said(.found))]
    Header { line: usize, found: String, form: &'static str },
    #[error("the header says {said} rows, but there are {found}: correct `height` or the rows")]
    RowCount { said: usize, found: usize },
    #[error("row {row} has {found} columns, the header says {said}: correct `width` or the row")]
    ColumnCount { row: usize, said: usize, found: usize },
    #[error(
        "row {row} has {mark:?} in column {column}: a MovingAI map has only `.` `G` `S` (free), `T` (luggage), `@` `O` `W` (wall)"
    )]
    UnknownTerrain { row: usize, column: usize, mark: char },
    #[error("there is no free cell for the robot: make one cell free")]
    NoFreeCell,
    #[error("maps of type {0:?} are not supported: use `octile` or `octile-corner`")]
    UnknownType(String),
    #[error(
        "an octile-corner map of height {height} has {wanted} rows after `map`, half of corner heights and half of terrain, but \
         there are {found}: correct `height` or the rows"
    )]
    CornerRowCount { height: usize, wanted: usize, found: usize },
    #[error("row {row} of the corner heights has {mark:?} in column {column}: use digits")]
    CornerHeight { row: usize, column: usize, mark: char },
    #[error(
        "row {row} has {mark:?} in column {column}: a map in text has only `r` (robot), `1` (visited), `0` (not yet), `X` (obstacle)"
    )]
    UnknownMark { row: usize, column: usize, mark: char },
    #[error("there is no robot: put one `r` where the robot starts")]
    NoRobot,
    #[error("there is a second robot `r` in row {row}, column {column}: keep only one")]
    SecondRobot { row: usize, column: usize },
    #[error(
        "an image does not give the size of a pixel: put {0} beside the image, with `image`, `resolution`, `origin`, \
         `negate`, `occupied_thresh` and `free_thresh`"
    )]
    NoYaml(String),
    #[error("cannot read the image {path} ({error}): correct `image`")]
    UnreadableImage { path: String, error: String },
    #[error("this file needs its image: give the path of the .yaml, so that both are read")]
    NeedsImage,
    #[error("this image cannot be read: save it as PGM (P5 or P2) or PNG")]
    NoImage,
    #[error("BMP images are not supported: convert the image to PNG or PGM, and name the new file in `image`")]
    Bmp,
    #[error("this is not a PGM image: {0}")]
    Pgm(String),
    #[error("the image should have {wanted} pixels, but ends after {found}: save it again")]
    ShortImage { wanted: usize, found: usize },
    #[error("pixel {column} of row {row} is {value}, but the lightest value is {most}: correct this pixel")]
    PixelTooLight { row: usize, column: usize, value: u64, most: u16 },
    #[error("this PNG image cannot be read ({0}): save it again without interlacing, or as PGM")]
    Png(String),
    #[error("an image of {0} × {1} pixels has no floor: give at least one column and one row")]
    EmptyImage(u64, u64),
    #[error("an image of {0} × {1} pixels is too large: at most {2} × {2} pixels are read")]
    ImageTooLarge(u64, u64, u32),
    #[error("`mode` is {0:?}: use trinary, scale or raw")]
    UnknownMode(String),
    #[error("`negate` is {0}: use 0 or 1")]
    UnknownNegate(i64),
    #[error("`origin` has {0} numbers: give three, [x, y, yaw]")]
    OriginLength(usize),
    #[error("`origin` turns the image by {0} radians: turn the image itself, and give 0")]
    Turned(String),
    #[error(
        "`home` is [{x}, {y}], which is not a free cell of this hall: give column and row of a free cell, counted from 0 in the \
         north-west corner"
    )]
    HomeNotFree { x: u32, y: u32 },
    #[error(
        "the start {column},{row} is not a free cell of this hall of {columns} × {rows} cells: give column and row of a free cell, \
         counted from 0 in the north-west corner"
    )]
    StartNotFree { column: u32, row: u32, columns: i32, rows: i32 },
    #[error("cells of {cell} m are finer than the pixels of {resolution} m: give {resolution} or more")]
    CellTooFine { cell: String, resolution: String },
    #[error("cannot read this file ({0}): give the path of a scene file of the virtual robot's page")]
    UnreadableScene(String),
    #[error("this file is larger than {0} bytes: a scene file of the virtual robot's page is smaller")]
    SceneTooLarge(usize),
    #[error("this file has no scene: a scene file contains `const config = {{…}}` or `export default {{…}}`")]
    NoLiteral,
    #[error("the object that begins here is not closed: add its end")]
    UnclosedLiteral,
    #[error("this is nested deeper than {0} levels, which no scene needs: correct this line")]
    TooDeep(usize),
    #[error("there are more than {0} sonars or obstacles of one kind: remove some")]
    TooManyThings(usize),
    #[error("the player stands in {0:?}: move one of them")]
    PlayerStuck(String),
    #[error("this is the scene of a virtual robot: make a hall of it with `hallsweep hall import {0}`")]
    IsScene(String),
    #[error("{wanted} test pieces do not fit into this hall, {room} do: choose fewer, or a larger hall")]
    NoRoomForTests { wanted: u32, room: u32 },
    #[error("--cell is {asked} m, but the cells of this file are {has} m wide: leave --cell out")]
    CellGiven { asked: String, has: String },
}

/// Maximum number of characters of a wrong line that a message repeats. The file may not be text at all.
const REPEATED: usize = 40;

fn said(found: &str) -> String {
    let mut letters = found.chars();
    let shown: String = letters.by_ref().take(REPEATED).collect();
    match (found, letters.next()) {
        ("", _) => "is empty".to_owned(),
        (_, None) => format!("reads {shown:?}"),
        (_, Some(_)) => format!("begins with {shown:?}"),
    }
}

/// Tells the author how the cell in a fault is counted.
fn place(fault: &AreaFault, columns: i32, rows: i32) -> String {
    let has_cell = matches!(fault, AreaFault::Outside(_) | AreaFault::Overlap(..));
    let counted = "correct the corners of this area (column and row, counted from 0 in the north-west corner; this hall has";
    if has_cell { format!(": {counted} {columns} × {rows} cells)") } else { String::new() }
}

impl HallFault {
    /// Adds the file and the line, counted from 1.
    #[must_use]
    pub fn at(self, file: &str, line: usize) -> HallError {
        HallError { file: file.to_owned(), line: Some(line), fault: Box::new(self) }
    }

    /// Adds the file to a fault that has no line.
    #[must_use]
    pub fn of(self, file: &str) -> HallError {
        HallError { file: file.to_owned(), line: None, fault: Box::new(self) }
    }
}
