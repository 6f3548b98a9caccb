//! Common part of the targets that read halls: any file parses as a hall in which a robot can stand, or is refused
//! with a sentence for its author.

use hallsweep_fuzz::core::units::Cell;
use hallsweep_fuzz::sim::{Export, Format, Hall, HallError, Truth};

/// Longest refusal in bytes; it quotes at most a line of the file.
const SENTENCE: usize = 8192;

/// Largest hall, in cells, that is also searched and written again; larger halls are only parsed, because more would
/// take too long.
const WALKED: i64 = 128 * 128;

/// Checks the result of reading a file; `files` are the names that a refusal may begin with.
pub fn check(files: &[&str], read: Result<Hall, HallError>) {
    match read {
        Ok(hall) => sound(hall),
        Err(error) => {
            let said = error.to_string();
            let file = files.iter().find(|file| said.starts_with(**file));
            let least = file.map_or(usize::MAX, |file| file.len() + 10);
            assert!((least..SENTENCE).contains(&said.len()), "{said}");
        }
    }
}

fn sound(hall: Hall) {
    let bounds = hall.bounds();
    let side = |least: i32, most: i32| i64::from(most) - i64::from(least) + 1;
    let cells = side(bounds.least.x, bounds.most.x) * side(bounds.least.y, bounds.most.y);
    assert_eq!(hall.truth(Cell::HOME), Truth::Free, "the robot stands on the floor");
    if cells <= WALKED {
        let reachable = hall.reachable();
        assert!(reachable.contains(&Cell::HOME));
        assert!(reachable.iter().all(|cell| hall.truth(*cell) == Truth::Free));
        let export = Export::from(hall);
        for format in Format::ALL {
            export.written(format, "again").expect("what is written is read again");
        }
    }
}
