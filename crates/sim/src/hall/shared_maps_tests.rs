//! Reads public maps from a folder `shared/maps` in this project's folder or above it. Without the folder, a message
//! says that it is missing.

use std::path::{Path, PathBuf};

use crate::{Export, Format, Hall, Truth};

fn folder() -> Option<PathBuf> {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|folder| folder.join("shared").join("maps"));
    let found = above.into_iter().find(|folder| folder.is_dir());
    if found.is_none() {
        eprintln!("the test of public maps is left out: there is no folder shared/maps beside this project");
    }
    found
}

fn read(file: &Path) -> Hall {
    Hall::named_or_file(file.to_str().expect("a printable path")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_public_map_is_read_and_comes_back_through_every_format() {
    let Some(folder) = folder() else { return };
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let maps: Vec<PathBuf> =
        files.filter(|file| file.extension().is_some_and(|extension| extension == "map" || extension == "yaml")).collect();
    assert!(!maps.is_empty());
    for map in maps {
        let hall = read(&map);
        assert!(hall.reachable().len() > 1, "{}: the robot can go nowhere", map.display());
        let free = |hall: &Hall| hall.rows().flatten().filter(|truth| **truth == Truth::Free).count();
        for format in Format::ALL {
            let written = Export::from(hall.clone()).written(format, "again").unwrap();
            let text = String::from_utf8(written.file).unwrap();
            let again = match &written.image {
                Some(image) => Hall::parse_occupancy("again.yaml", &text, "again.pgm", image, None),
                None => Hall::parse(&format!("again.{}", format.extension()), &text),
            };
            assert_eq!(free(&again.unwrap()), free(&hall), "{} as {format:?}", map.display());
        }
    }
}

#[test]
fn a_benchmark_map_has_as_many_free_cells_as_its_file() {
    let Some(folder) = folder() else { return };
    let Ok(text) = std::fs::read_to_string(folder.join("random-64-64-20.map")) else { return };
    let hall = read(&folder.join("random-64-64-20.map"));
    let rows = text.lines().skip(4);
    let free = rows.flat_map(str::chars).filter(|mark| ".GS".contains(*mark)).count();
    assert_eq!((hall.bounds().width(), hall.bounds().height()), (64, 64));
    assert_eq!(hall.rows().flatten().filter(|truth| **truth == Truth::Free).count(), free);
}

/// The test divides the image into cells of ten pixels itself, by the rule of `map_server`, and compares.
#[test]
fn the_depot_of_nav2_has_the_cells_of_its_image() {
    let Some(folder) = folder() else { return };
    let Ok(bytes) = std::fs::read(folder.join("depot.pgm")) else { return };
    let hall = read(&folder.join("depot.pgm"));
    let header = b"P5\n604 307\n255\n".len();
    let (columns, rows) = (604_usize.div_ceil(10), 307_usize.div_ceil(10));
    assert_eq!((hall.bounds().width(), hall.bounds().height()), (columns as i32, rows as i32));
    for (y, row) in hall.rows().enumerate() {
        for (x, truth) in row.iter().enumerate() {
            let pixels = (y * 10..(y * 10 + 10).min(307)).flat_map(|j| (x * 10..(x * 10 + 10).min(604)).map(move |i| (i, j)));
            let is_free = pixels.into_iter().all(|(i, j)| (255.0 - f64::from(bytes[header + j * 604 + i])) / 255.0 < 0.25);
            assert_eq!(*truth == Truth::Free, is_free, "column {x}, row {y}");
        }
    }
}
