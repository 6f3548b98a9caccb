//! Reads and writes a hall as the text in which the old clients show a map: `r` robot, `1` visited, `0` not visited
//! yet, `X` obstacle. Rows are either lines with commas (`|r, 1, X, `), or all in one line, each ended by `@`.

use super::error::{HallError, HallFault};
use super::rows::{DrawingRows, drawn, sides};
use super::{Hall, Truth};
use hallsweep_core::world::hall_map::Mark;

/// Characters that may separate two cells.
const BETWEEN: [char; 5] = ['|', ',', ' ', '\t', '\r'];

/// Whether all characters of a text are those of a map of old clients.
pub(super) fn is_one(text: &str) -> bool {
    let is_mark = |letter: char| "r10X".contains(letter);
    text.contains(is_mark)
        && text.chars().all(|letter| is_mark(letter) || letter == '@' || letter == '\n' || BETWEEN.contains(&letter))
}

/// Reads a map. The robot's cell is the start. Cells that were not visited yet are floor too.
pub(super) fn read(file: &str, name: &str, text: &str) -> Result<Hall, HallError> {
    let lines = text.lines().enumerate();
    let rows = lines.flat_map(|(index, line)| line.split('@').map(move |row| (index + 1, row)));
    let rows: Vec<(usize, &str)> = rows.filter(|(_, row)| row.contains(|letter| !BETWEEN.contains(&letter))).collect();
    let cells = |row: &str| row.chars().filter(|letter| !BETWEEN.contains(letter)).count();
    let width = rows.first().map_or(0, |(_, row)| cells(row));
    let size = sides(width as u64, rows.len() as u64).map_err(|fault| fault.of(file))?;
    let mut reading = DrawingRows::default();
    for (index, (line, row)) in rows.iter().enumerate() {
        let columns = cells(row);
        if columns != width {
            return Err(HallFault::Ragged { row: index + 1, columns, first: width }.at(file, *line));
        }
        read_row(&mut reading, index, row).map_err(|fault| fault.at(file, *line))?;
    }
    let start = reading.start.ok_or_else(|| HallFault::NoRobot.of(file))?;
    Ok(Hall::of(name, reading.plan(start, size)))
}

fn read_row(reading: &mut DrawingRows, index: usize, row: &str) -> Result<(), HallFault> {
    for (place, mark) in row.chars().filter(|letter| !BETWEEN.contains(letter)).enumerate() {
        let truth = match mark {
            'r' if reading.start.is_some() => return Err(HallFault::SecondRobot { row: index + 1, column: place + 1 }),
            'r' => {
                reading.start = Some(drawn(place, index));
                Truth::Free
            }
            '1' | '0' => Truth::Free,
            'X' => Truth::Wall,
            _ => return Err(HallFault::UnknownMark { row: index + 1, column: place + 1, mark }),
        };
        reading.squares.push(truth);
    }
    Ok(())
}

/// Writes one line per row, with `r` where the robot starts.
pub(super) fn write(hall: &Hall, squares: impl Iterator<Item = (Truth, Option<Mark>)>) -> String {
    let (home, width) = (hall.home(), usize::try_from(hall.bounds().width()).unwrap_or(1));
    let mut text = String::new();
    for (index, (truth, mark)) in squares.enumerate() {
        let cell = drawn(index % width, index / width);
        let letter = match (truth, mark) {
            _ if cell == home => 'r',
            (_, Some(Mark::Unknown | Mark::Seen)) => '0',
            (Truth::Free, _) => '1',
            (Truth::Wall | Truth::Luggage(_), _) => 'X',
        };
        text.push_str(if cell.x == 0 { "|" } else { "" });
        text.push(letter);
        text.push_str(if index % width + 1 == width { ", \n" } else { ", " });
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Cell;
    use hallsweep_core::world::hall_map::Bounds;

    fn truths(text: &str) -> Result<(Bounds, String), String> {
        let hall = read("m.txt", "m", text).map_err(|error| error.to_string())?;
        let letters = hall.rows().map(|row| row.iter().map(|truth| if *truth == Truth::Wall { '#' } else { '.' }).collect());
        Ok((hall.bounds(), letters.collect::<Vec<String>>().join("/")))
    }

    #[test]
    fn a_map_as_the_old_clients_show_it_is_a_hall() {
        let expect = Ok((Bounds { least: Cell::new(-1, 0), most: Cell::new(2, 1) }, "...#/###.".to_owned()));
        for text in [
            "|1, r, 1, X, \n|X, X, X, 0, \n",
            "1,r,1,X\nX,X,X,0",
            "|1, r, 1, X,|\r\n\r\n|X, X, X, 0,|\r\n\n",
            "1 r 1 X @X X X 0 @",
            "1r1X\nXXX0",
        ] {
            assert!(is_one(text));
            assert_eq!(truths(text), expect, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_with_a_map_in_text_is_said_with_its_line() {
        let check = |text: &str, expect: &str| assert_eq!(truths(text).expect_err("this map has a fault"), expect);
        check("|1, 1, \n", "m.txt: there is no robot: put one `r` where the robot starts");
        check("|r, 1, \n|1, r, \n", "m.txt:2: there is a second robot `r` in row 2, column 2: keep only one");
        check("|r, 1, \n\n|1, \n", "m.txt:3: row 2 has 1 columns, row 1 has 2: make all rows equally long");
        let marks = "`r` (robot), `1` (visited), `0` (not yet), `X` (obstacle)";
        check("r 1 @r ?", "m.txt:1: there is a second robot `r` in row 2, column 1: keep only one");
        check("|r, L, \n", &format!("m.txt:1: row 1 has 'L' in column 2: a map in text has only {marks}"));
        check("", "m.txt: a hall of 0 × 0 cells has no floor: give at least one column and one row");
        let row = "1,".repeat(2049);
        check(&row, "m.txt: a hall of 2049 × 1 cells is too large: at most 2048 × 2048 cells are allowed");
        assert!(!is_one("") && !is_one("\n, |") && !is_one("r, 1, L"));
    }
}
