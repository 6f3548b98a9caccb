//! THE TABLE of files in which the map can be downloaded, under `/map`. The files show the explored part of the hall,
//! in the formats of hall files. Scenes (`.js`) are not among these formats, because they can only be read.
//! `hallsweep_sim` writes the formats; the map for screens is in `map`.

use super::coverage;
use super::resources::ResourceKind;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;
use hallsweep_core::world::resource::Resource;
use hallsweep_sim::{Export, Format};

#[derive(Clone, Copy, Debug)]
pub struct MapFileRow {
    /// Name of the file, used in its path and in the YAML.
    pub name: &'static str,
    pub media_type: &'static str,
    pub title: &'static str,
    part: MapPart,
}

#[derive(Clone, Copy, Debug)]
enum MapPart {
    File(Format),
    /// The image to which the YAML refers.
    Image,
    Coverage,
}

/// Common first part of the file names. All files share it, because the YAML refers to its image by file name.
const STEM: &str = "hall";

/// Side of a cell in metres if it is not known. This is the default of hall files.
const USUAL_CELL_M: f64 = 0.5;

#[rustfmt::skip]
pub const FILES: [MapFileRow; 6] = [
    row("hall.toml", "application/toml", "A hall file", MapPart::File(Format::Toml)),
    row("hall.map", "text/plain; charset=utf-8", "A MovingAI map", MapPart::File(Format::MovingAi)),
    row("hall.yaml", "application/yaml", "Description of `hall.pgm` for ROS `map_server`", MapPart::File(Format::Occupancy)),
    row("hall.pgm", "image/x-portable-graymap", "Image for `hall.yaml`, one pixel per cell", MapPart::Image),
    row("hall.txt", "text/plain; charset=utf-8", "Map text of old clients, from the first known cell", MapPart::File(Format::SeedText)),
    row("coverage.csv", "text/csv; charset=utf-8", "Every cell that was looked at, with its views", MapPart::Coverage),
];

const fn row(name: &'static str, media_type: &'static str, title: &'static str, part: MapPart) -> MapFileRow {
    MapFileRow { name, media_type, title, part }
}

impl MapFileRow {
    pub fn revision(&self, snapshot: &Snapshot) -> Revision {
        match self.part {
            MapPart::Coverage => ResourceKind::Of(Resource::Coverage).revision(snapshot),
            MapPart::File(_) | MapPart::Image => snapshot.revision_of(Resource::Map).max(snapshot.revision_of(Resource::Luggage)),
        }
    }

    /// Writes the file. `cell_m` is the side of a cell in metres, if known.
    pub fn written(&self, hall: &str, cell_m: Option<f64>, snapshot: &Snapshot) -> Vec<u8> {
        let export = Export::explored(hall, cell_m.unwrap_or(USUAL_CELL_M), snapshot);
        match self.part {
            MapPart::File(format) => export.file(format, STEM),
            MapPart::Image => export.image(),
            MapPart::Coverage => coverage::csv(snapshot).into_bytes(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::searching;
    use hallsweep_core::units::{Cell, Piece};
    use hallsweep_sim::{Hall, Truth};

    fn file(name: &str) -> Vec<u8> {
        let row = FILES.iter().find(|row| row.name == name).expect("it is in the table");
        row.written("airport", Some(0.3), &searching())
    }

    #[test]
    fn every_file_is_read_as_the_hall_that_is_known() {
        let text = |name: &str| String::from_utf8(file(name)).expect("UTF-8");
        let yaml = text("hall.yaml");
        assert!(yaml.starts_with("image: hall.pgm\n"), "{yaml}");
        let of_image = Hall::parse_occupancy("hall.yaml", &yaml, "hall.pgm", &file("hall.pgm"), None).unwrap();
        assert_eq!(of_image.cell_m(), 0.3);
        let read = |name: &str| Hall::parse(name, &text(name)).unwrap();
        for hall in [read("hall.toml"), read("hall.map"), of_image] {
            assert_eq!((hall.bounds().width(), hall.bounds().height(), hall.pieces().len()), (6, 5, 3));
            assert_eq!(hall.truth(Cell::new(3, 0)), Truth::Luggage(Piece(1)));
            assert_eq!(hall.truth(Cell::new(4, 1)), Truth::Wall, "nothing is known of it");
        }
        assert!(read("hall.toml").is_dangerous(Piece(2)) && !read("hall.toml").is_dangerous(Piece(1)));
        assert_eq!(
            text("hall.txt").lines().next(),
            Some("|r, 1, 1, X, 1, X, "),
            "the robot starts at home, wherever it stands now"
        );
        assert_eq!(read("hall.txt").truth(Cell::new(4, 1)), Truth::Free, "what was not visited yet is floor");
    }
}
