//! Writes halls and explored maps to files. This module lists the formats, what a file of each format contains, and
//! what it leaves out. The code that writes a format is beside the code that reads it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::HallError;
use super::rows::DrawingRows;
use super::scene::HallOfScene;
use super::{Hall, Truth, movingai, occupancy, rows, seed_text, toml};
use crate::bag::Bag;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::{Bounds, HallMap, Mark};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Toml,
    MovingAi,
    /// A map of ROS `map_server`: a YAML file and a PGM image.
    Occupancy,
    /// The text in which the old clients show a map.
    SeedText,
}

impl Format {
    pub const ALL: [Format; 4] = [Format::Toml, Format::MovingAi, Format::Occupancy, Format::SeedText];

    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Format::Toml => "toml",
            Format::MovingAi => "map",
            Format::Occupancy => "yaml",
            Format::SeedText => "txt",
        }
    }

    #[must_use]
    pub fn of_file(path: &Path) -> Option<Format> {
        let extension = path.extension()?;
        Format::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }
}

/// The description that is written into the file of an explored hall.
const EXPLORED: &str = "This is the hall as explored; unknown cells are walls.";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenHall {
    pub file: Vec<u8>,
    /// The PGM image that belongs to the file, if the format has one.
    pub image: Option<Vec<u8>>,
    /// What the file leaves out, in a few words each.
    pub lost: Vec<String>,
}

#[derive(Clone, Debug)]
pub struct Export {
    /// The hall to write. Unknown cells are walls.
    hall: Hall,
    /// What the robot knows of each square, if the hall was explored.
    marks: Option<Vec<Mark>>,
    /// Parts of the scene file that were lost when the hall was made from it.
    lost_before: Vec<String>,
}

impl From<Hall> for Export {
    fn from(hall: Hall) -> Export {
        Export { hall, marks: None, lost_before: Vec::new() }
    }
}

impl From<HallOfScene> for Export {
    fn from(HallOfScene { hall, lost }: HallOfScene) -> Export {
        Export { hall, marks: None, lost_before: lost }
    }
}

impl Export {
    /// Exports the explored part of a hall, with walls around it. `cell_m` is the side of a cell in metres. Each cell
    /// of luggage becomes one piece. The description of a piece says only whether it is dangerous, because the robot
    /// knows no more. Areas are left out, because an area may reach beyond what is explored.
    #[must_use]
    pub fn explored(name: &str, cell_m: f64, state: &Snapshot) -> Export {
        let bounds = known_bounds(&state.map);
        let mut reading = DrawingRows::default();
        let mut marks = Vec::new();
        for y in bounds.least.y..=bounds.most.y {
            for cell in (bounds.least.x..=bounds.most.x).map(|x| Cell::new(x, y)) {
                // The robot started in this cell, so it has visited the cell, even if the map was cleared later.
                let mark = if cell == Cell::HOME { Mark::Visited } else { state.map.at(cell) };
                let in_drawing = Cell::new(cell.x - bounds.least.x, cell.y - bounds.least.y);
                let truth = match mark {
                    Mark::Visited | Mark::Seen => Truth::Free,
                    Mark::Wall | Mark::Unknown => Truth::Wall,
                    Mark::Luggage | Mark::NotInspected => reading.new_piece(in_drawing).map_or(Truth::Wall, Truth::Luggage),
                };
                reading.squares.push(truth);
                marks.push(mark);
            }
        }
        let home = Cell::new(-bounds.least.x, -bounds.least.y);
        let mut plan = reading.plan(home, (bounds.width(), bounds.height()));
        let dangerous: BTreeSet<Cell> =
            state.luggage.iter().filter(|piece| piece.is_bomb_left()).map(|piece| piece.cell).collect();
        plan.bags.iter_mut().for_each(|bag| bag.dangerous = bag.cells.iter().any(|cell| dangerous.contains(cell)));
        let hall = Hall::of(name, plan).measured(cell_m, None).described(Some(EXPLORED));
        Export { hall, marks: Some(marks), lost_before: Vec::new() }
    }

    #[must_use]
    pub fn in_words(&self) -> String {
        let (bounds, cell_m) = (self.hall.bounds(), self.hall.cell_m());
        let areas = match self.hall.areas().len() {
            0 => String::new(),
            1 => ", 1 area".to_owned(),
            areas => format!(", {areas} areas"),
        };
        let pieces = pieces(self.hall.pieces().len());
        format!("{} × {} cells of {cell_m} m, {pieces} of luggage{areas}", bounds.width(), bounds.height())
    }

    /// Every square, row by row from the north. In an explored hall, each square comes with its mark.
    fn squares(&self) -> impl Iterator<Item = (Truth, Option<Mark>)> {
        let marks = self.marks.iter().flatten().copied().map(Some).chain(std::iter::repeat(None));
        self.hall.squares.iter().copied().zip(marks)
    }

    /// The content of the file in this format. `stem` is the file name without its extension.
    #[must_use]
    pub fn file(&self, format: Format, stem: &str) -> Vec<u8> {
        match format {
            Format::Toml => toml::write(&self.hall).into_bytes(),
            Format::MovingAi => movingai::write(&self.hall).into_bytes(),
            Format::Occupancy => occupancy::yaml(&self.hall, &format!("{stem}.pgm")).into_bytes(),
            Format::SeedText => seed_text::write(&self.hall, self.squares()).into_bytes(),
        }
    }

    /// The image that belongs to the format `Occupancy`.
    #[must_use]
    pub fn image(&self) -> Vec<u8> {
        occupancy::image(&self.hall, self.squares())
    }

    /// Writes all files of this format, and lists what they leave out. For the list, the files are read again and
    /// compared with the hall.
    ///
    /// # Errors
    /// When the written files cannot be read again, for example because the map is wider than a hall may be.
    pub fn written(&self, format: Format, stem: &str) -> Result<WrittenHall, HallError> {
        let (file, image) = (self.file(format, stem), (format == Format::Occupancy).then(|| self.image()));
        let name = format!("{stem}.{}", format.extension());
        let text = String::from_utf8_lossy(&file);
        let again = match &image {
            Some(image) => Hall::parse_occupancy(&name, &text, &format!("{stem}.pgm"), image, None)?,
            None => Hall::parse(&name, &text)?,
        };
        let lost = self.lost(&again, format);
        Ok(WrittenHall { file, image, lost })
    }

    fn lost(&self, again: &Hall, format: Format) -> Vec<String> {
        let hall = &self.hall;
        let mut lost = self.lost_before.clone();
        let (home, home_again) = (hall.home(), again.home());
        if home != home_again {
            let place = |cell: Cell| format!("column {}, row {}", cell.x + 1, cell.y + 1);
            lost.push(format!("the start moves from {} to {}", place(home), place(home_again)));
        }
        lost.extend(self.lost_knowledge(format));
        lost.extend(lost_luggage(hall, again));
        if hall.cell_m().to_bits() != again.cell_m().to_bits() {
            lost.push(format!("cells of {} m become cells of {} m", hall.cell_m(), again.cell_m()));
        }
        let is_said = |is_lost: bool, what: &str| is_lost.then(|| what.to_owned());
        lost.extend(is_said(hall.curve() != again.curve(), "the temperature"));
        let areas = format!("the areas ({})", hall.areas().len());
        lost.extend(is_said(hall.areas().len() != again.areas().len(), &areas));
        lost.extend(is_said(hall.name() != again.name(), "the name"));
        let described = hall.description.as_deref().filter(|words| *words != EXPLORED);
        lost.extend(is_said(described.is_some() && hall.description != again.description, "the description"));
        lost
    }

    /// Lists the knowledge about unknown and seen cells that the format cannot express.
    fn lost_knowledge(&self, format: Format) -> Vec<String> {
        let count = |mark: Mark| self.marks.iter().flatten().filter(|known| **known == mark).count();
        let (unknown, seen) = (count(Mark::Unknown), count(Mark::Seen));
        let (unknown_are, seen_are) = match format {
            Format::Toml | Format::MovingAi => (Some("walls"), Some("visited")),
            Format::Occupancy => (None, Some("visited")),
            Format::SeedText => (Some("floor not visited yet"), None),
        };
        let said = |what: &str, count: usize, are: Option<&str>| {
            are.filter(|_| count > 0).map(|are| format!("which cells {what} ({count}, now {are})"))
        };
        [said("are unknown", unknown, unknown_are), said("were only seen", seen, seen_are)].into_iter().flatten().collect()
    }
}

fn pieces(count: usize) -> String {
    format!("{count} {}", if count == 1 { "piece" } else { "pieces" })
}

fn lost_luggage(hall: &Hall, again: &Hall) -> Vec<String> {
    let is_luggage = |truth: &Truth| matches!(truth, Truth::Luggage(_));
    if !hall.pieces().is_empty() && !again.squares.iter().any(is_luggage) {
        return vec![format!("the luggage ({}, now walls)", pieces(hall.pieces().len()))];
    }
    // The same piece has the same first cell in both drawings.
    let begins =
        |hall: &Hall, bag: &Bag| bag.cells.first().map(|cell| (cell.x - hall.bounds().least.x, cell.y - hall.bounds().least.y));
    let known: BTreeMap<_, &Bag> = again.pieces().iter().map(|bag| (begins(again, bag), bag)).collect();
    let differ = |differs: &dyn Fn(&Bag, &Bag) -> bool| {
        hall.pieces().iter().filter(|bag| known.get(&begins(hall, bag)).is_none_or(|again| differs(bag, again))).count()
    };
    let looks = |bag: &Bag| (bag.kind, bag.colour, bag.height_m.to_bits());
    let counted = [
        (differ(&|bag, again| bag.cells.len() != again.cells.len()), "the shape"),
        (differ(&|bag, again| looks(bag) != looks(again)), "kind, colour or height"),
        (differ(&|bag, again| bag.dangerous && !again.dangerous), "the danger"),
    ];
    counted.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{what} of {}", pieces(count))).collect()
}

/// The bounds of the known area, including home and the walls around it. If the area with its walls is too large for
/// a hall, the walls are left out. A larger file could not be read again, and outside a hall everything is wall
/// anyway.
fn known_bounds(map: &HallMap) -> Bounds {
    let with = |bounds: Bounds, cell: Cell| Bounds {
        least: Cell::new(bounds.least.x.min(cell.x), bounds.least.y.min(cell.y)),
        most: Cell::new(bounds.most.x.max(cell.x), bounds.most.y.max(cell.y)),
    };
    let bounds = with(map.known_bounds(), Cell::HOME);
    let side = |cells: i32| u64::try_from(cells).unwrap_or(0);
    if rows::sides(side(bounds.width()), side(bounds.height())).is_ok() {
        return bounds;
    }
    map.known().filter(|(_, mark)| *mark != Mark::Wall).fold(Bounds::of(Cell::HOME), |bounds, (cell, _)| with(bounds, cell))
}

#[cfg(test)]
#[path = "export_tests.rs"]
mod tests;
