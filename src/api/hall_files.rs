//! Reads uploaded hall files of every format in memory. The result is the hall in hallsweep's own format, and a list
//! of what a search could not reach. A map image is uploaded together with its YAML description: first the YAML, then
//! a line `...` (the end of a YAML document), then the image.

use schemars::JsonSchema;
use serde::Serialize;

use hallsweep_core::units::Cell;
use hallsweep_sim::{Export, Format, Hall, HallError, Scene};

/// Maximum number of findings of one kind that are listed with their cells. Further findings are only counted.
const SAID: usize = 20;

/// The line that ends the YAML. The image follows this line.
const END_OF_YAML: &[u8] = b"\n...\n";

/// Hall that was read from a file.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct ReadHall {
    name: String,
    /// Number of columns.
    width: i32,
    /// Number of rows.
    height: i32,
    /// Side of a cell, in metres.
    cell_m: f64,
    /// Number of pieces of luggage.
    pieces: usize,
    /// Text of the whole hall as a hall file.
    pub toml: String,
    pub findings: Vec<Finding>,
}

/// Finding about the hall, for example a piece that a search cannot reach.
#[derive(Debug, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// Cell of the finding, if the finding has a cell.
    #[serde(flatten)]
    pub at: Option<Place>,
    #[serde(flatten)]
    pub found: Found,
    pub text: String,
}

/// A cell of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// Column in the map, counted from home to the east.
    pub x: i32,
    /// Row in the map, counted from home to the south.
    pub y: i32,
    /// Column in the drawing, counted from 0 in the west.
    pub column: i32,
    /// Row in the drawing, counted from 0 in the north.
    pub row: i32,
}

/// Code and values of a finding, for programs that write their own sentence. `text` is the sentence in English.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error, JsonSchema)]
#[serde(tag = "code", rename_all = "camelCase")]
pub enum Found {
    #[error("the {name} cannot be reached: no free cell beside it leads home")]
    PieceUnreached { name: String },
    #[error("this free cell cannot be reached from home")]
    CellUnreached,
    #[error("{count} more places cannot be reached")]
    More { count: usize },
    #[error("the hall contains no luggage: a search has nothing to inspect")]
    NoLuggage,
}

impl Found {
    pub const fn code(&self) -> &'static str {
        match self {
            Found::PieceUnreached { .. } => "pieceUnreached",
            Found::CellUnreached => "cellUnreached",
            Found::More { .. } => "more",
            Found::NoLuggage => "noLuggage",
        }
    }
}

impl Finding {
    fn new(at: Option<Place>, found: Found) -> Finding {
        Finding { at, text: found.to_string(), found }
    }
}

/// Reads the hall from an uploaded file. The extension of the file name decides the format.
pub fn read(file: &str, bytes: &[u8]) -> Result<Hall, HallError> {
    let ends = |extension: &str| file.to_ascii_lowercase().ends_with(extension);
    if ends(".js") {
        let stem = std::path::Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
        let hall = Scene::parse(file, bytes)?.hall(&stem).map_err(|fault| fault.of(file))?;
        let toml = text(&Export::from(hall));
        return Hall::parse(file.trim_end_matches(".js"), &toml);
    }
    if (ends(".yaml") || ends(".yml"))
        && let Some(end) = bytes.windows(END_OF_YAML.len()).position(|window| window == END_OF_YAML)
    {
        let yaml = String::from_utf8_lossy(&bytes[..=end]);
        return Hall::parse_occupancy(file, &yaml, "the image", &bytes[end + END_OF_YAML.len()..], None);
    }
    Hall::parse(file, &String::from_utf8_lossy(bytes))
}

impl From<&Hall> for ReadHall {
    fn from(hall: &Hall) -> ReadHall {
        let bounds = hall.bounds();
        ReadHall {
            name: hall.name().to_owned(),
            width: bounds.width(),
            height: bounds.height(),
            cell_m: hall.cell_m(),
            pieces: hall.pieces().len(),
            toml: text(&Export::from(hall.clone())),
            findings: findings(hall),
        }
    }
}

fn text(export: &Export) -> String {
    String::from_utf8_lossy(&export.file(Format::Toml, "hall")).into_owned()
}

/// Lists what a search cannot reach. Pieces come first, because a piece that nobody finds may be a bomb.
fn findings(hall: &Hall) -> Vec<Finding> {
    let least = hall.bounds().least;
    let at = |cell: Cell, found| {
        Finding::new(Some(Place { x: cell.x, y: cell.y, column: cell.x - least.x, row: cell.y - least.y }), found)
    };
    let pieces = hall.unreachable_pieces();
    let of_pieces = pieces.iter().filter_map(|bag| {
        let cell = *bag.cells.first()?;
        Some(at(cell, Found::PieceUnreached { name: bag.name.to_string() }))
    });
    let cells = hall.unreachable_cells();
    let of_cells = cells.iter().map(|cell| at(*cell, Found::CellUnreached));
    let mut said: Vec<Finding> = of_pieces.take(SAID).chain(of_cells.take(SAID)).collect();
    let more = pieces.len().saturating_sub(SAID) + cells.len().saturating_sub(SAID);
    if more > 0 {
        said.push(Finding::new(None, Found::More { count: more }));
    }
    if hall.pieces().is_empty() {
        said.push(Finding::new(None, Found::NoLuggage));
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str, bytes: &[u8]) -> ReadHall {
        super::read(file, bytes).map_or_else(|error| panic!("{file}: {error}"), |hall| ReadHall::from(&hall))
    }

    #[test]
    fn a_file_of_every_format_is_read() {
        let toml = b"drawing = \"\"\"\nS.T\n\"\"\"\n";
        let movingai = b"type octile\nheight 1\nwidth 3\nmap\n..T\n";
        let yaml =
            b"image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n...\n\
                     P2 3 1 255\n254 254 0\n";
        let scene = b"const config = { floor: { size: { x: 35, y: 35 } }, player: { position: { x: .08, y: .08 }, speed: .2 },\n\
                      staticObstacles: [] };\nexport default config;\n";
        for (file, bytes, size, pieces) in [
            ("m.toml", &toml[..], (3, 1), 1),
            ("m.map", movingai, (3, 1), 1),
            ("m.yaml", yaml, (3, 1), 0),
            ("m.txt", b"|r, 1, X, \n", (3, 1), 0),
            ("room.js", scene, (9, 9), 0),
        ] {
            let hall = read(file, bytes);
            assert_eq!(((hall.width, hall.height), hall.pieces), (size, pieces), "{file}");
            let again = read("again.toml", hall.toml.as_bytes());
            assert_eq!((again.width, again.height, again.pieces), (hall.width, hall.height, hall.pieces), "{file}");
        }
    }

    #[test]
    fn what_a_search_does_not_come_to_is_said_with_its_cell() {
        let hall = read("m.toml", b"drawing = \"\"\"\n.#T#\nS###\n.#..\n\"\"\"\n");
        let said: Vec<_> = hall.findings.iter().map(|finding| (finding.at, &finding.found)).collect();
        let at = |column, row| Some(Place { x: column, y: row - 1, column, row });
        let [(piece, Found::PieceUnreached { .. }), (first, Found::CellUnreached), (second, Found::CellUnreached)] = said[..]
        else {
            panic!("{said:?}")
        };
        assert_eq!((piece, first, second), (at(2, 0), at(2, 2), at(3, 2)));
        assert!(read("m.toml", b"drawing = \"\"\"\nS.T\n\"\"\"\n").findings.is_empty());
        let empty = read("m.toml", b"width = 3\nheight = 2\n").findings;
        assert!(empty.iter().any(|finding| finding.text.contains("no luggage") && finding.at.is_none()), "{empty:?}");
    }

    #[test]
    fn a_great_many_findings_are_counted() {
        let walls = format!("drawing = \"\"\"\nS#{}\n\"\"\"\n", ".".repeat(100));
        let findings = read("m.toml", walls.as_bytes()).findings;
        assert!(findings.len() < 30 && findings.iter().any(|finding| finding.text == "80 more places cannot be reached"));
    }

    #[test]
    fn what_cannot_be_read_is_said_with_its_file() {
        for (file, bytes, words) in [
            ("m.toml", &b"drawing = \"\"\"\n...\n\"\"\"\n"[..], "m.toml:1: there is no start"),
            ("m.js", b"nonsense", "m.js:1: "),
            ("m.yaml", b"image: m.pgm\n", "m.yaml: "),
            ("m.yaml", b"image: m.pgm\n...\nP5 9 9 255\n", "m.yaml: "),
            ("m.map", b"\xff\xfe", "m.map:1: "),
        ] {
            let why = super::read(file, bytes).expect_err(file).to_string();
            assert!(why.starts_with(words), "{why}");
        }
    }
}
