//! Reads and writes the grid maps of the MovingAI benchmark (N. Sturtevant, "Benchmarks for Grid-Based Pathfinding",
//! 2012). `T` is luggage, and each such cell is one piece. All other obstacles are walls. Nothing is dangerous, and
//! there is no thermometer.

use super::error::{HallError, HallFault};
use super::rows::{DrawingRows, drawn, sides};
use super::{Hall, Truth};

/// The lines before the rows: `type …`, `height N`, `width N`, `map`.
const HEADER_LINES: usize = 4;

/// The header line that contains the number of rows. Lines are counted from 1.
const HEIGHT_LINE: usize = 2;

const WIDTH_LINE: usize = 3;

struct Header {
    has_corners: bool,
    width: usize,
    height: usize,
}

/// Reads a map. The robot starts in the largest connected part of the floor.
pub(super) fn read(file: &str, name: &str, text: &str) -> Result<Hall, HallError> {
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let header = header(file, &lines)?;
    // A map of type `octile-corner` has one more column and one more row than the hall.
    let more = usize::from(header.has_corners);
    let (width, height) = (header.width.saturating_sub(more), header.height.saturating_sub(more));
    let worst = if width == 0 || (width > height && height > 0) { WIDTH_LINE } else { HEIGHT_LINE };
    let size = sides(width as u64, height as u64).map_err(|fault| fault.at(file, worst))?;
    let rows = rows(file, &lines, &header)?;
    let above = if header.has_corners { header.height } else { 0 };
    for (index, row) in rows.iter().enumerate() {
        let line = HEADER_LINES + index + 1;
        let found = row.chars().count();
        if found != header.width {
            return Err(HallFault::ColumnCount { row: index + 1, said: header.width, found }.at(file, line));
        }
        if index < above {
            check_corners(index, row).map_err(|fault| fault.at(file, line))?;
        }
    }
    let mut reading = DrawingRows::default();
    for (index, row) in rows[above..].iter().take(height).enumerate() {
        read_row(&mut reading, index, row, width).map_err(|fault| fault.at(file, HEADER_LINES + above + index + 1))?;
    }
    let home =
        reading.start_in_largest_part(width.max(1)).ok_or_else(|| HallFault::NoFreeCell.at(file, HEADER_LINES + above + 1))?;
    Ok(Hall::of(name, reading.plan(home, size)))
}

fn header(file: &str, lines: &[&str]) -> Result<Header, HallError> {
    let words = |line: usize| -> Vec<&str> { lines.get(line).map_or(Vec::new(), |line| line.split_whitespace().collect()) };
    let wrong = |line: usize, form: &'static str| {
        let found = lines.get(line - 1).map_or(String::new(), |line| (*line).to_owned());
        HallFault::Header { line, found, form }.at(file, line)
    };
    let number = |line: usize, key: &str, form: &'static str| match words(line - 1).as_slice() {
        [word, value] if *word == key => value.parse().map_err(|_| wrong(line, form)),
        _ => Err(wrong(line, form)),
    };
    let has_corners = match words(0).as_slice() {
        ["type", "octile"] => false,
        ["type", "octile-corner"] => true,
        ["type", other] => return Err(HallFault::UnknownType((*other).to_owned()).at(file, 1)),
        _ => return Err(wrong(1, "type octile")),
    };
    let height = number(HEIGHT_LINE, "height", "height NUMBER")?;
    let width = number(WIDTH_LINE, "width", "width NUMBER")?;
    if words(HEADER_LINES - 1) != ["map"] {
        return Err(wrong(HEADER_LINES, "map"));
    }
    Ok(Header { has_corners, width, height })
}

/// Returns the rows after the header. Empty lines at the end are ignored.
fn rows<'a>(file: &str, lines: &'a [&'a str], header: &Header) -> Result<&'a [&'a str], HallError> {
    let rows = lines.get(HEADER_LINES..).unwrap_or_default();
    let found = rows.iter().rposition(|row| !row.is_empty()).map_or(0, |last| last + 1);
    let height = header.height;
    let wanted = if header.has_corners { height.saturating_mul(2) } else { height };
    // An error names the line of the first surplus row, or of the last row if rows are missing.
    let line = HEADER_LINES + if found > wanted { wanted + 1 } else { found };
    match found == wanted {
        true => Ok(&rows[..found]),
        false if header.has_corners => Err(HallFault::CornerRowCount { height, wanted, found }.at(file, line)),
        false => Err(HallFault::RowCount { said: height, found }.at(file, line)),
    }
}

/// Checks a row of corner heights. The heights themselves are ignored. A row of terrain in the place of corner
/// heights means that a row is missing.
fn check_corners(index: usize, row: &str) -> Result<(), HallFault> {
    match row.chars().enumerate().find(|(_, mark)| !mark.is_ascii_digit()) {
        Some((place, mark)) => Err(HallFault::CornerHeight { row: index + 1, column: place + 1, mark }),
        None => Ok(()),
    }
}

fn read_row(reading: &mut DrawingRows, index: usize, row: &str, width: usize) -> Result<(), HallFault> {
    for (place, mark) in row.chars().take(width).enumerate() {
        let cell = drawn(place, index);
        let square = match mark.to_ascii_uppercase() {
            '.' | 'G' | 'S' => Truth::Free,
            'T' => Truth::Luggage(reading.new_piece(cell)?),
            '@' | 'O' | 'W' => Truth::Wall,
            _ => return Err(HallFault::UnknownTerrain { row: index + 1, column: place + 1, mark }),
        };
        reading.squares.push(square);
    }
    Ok(())
}

/// Writes a map of type `octile`.
pub(super) fn write(hall: &Hall) -> String {
    let bounds = hall.bounds();
    let mut text = format!("type octile\nheight {}\nwidth {}\nmap\n", bounds.height(), bounds.width());
    for row in hall.rows() {
        text.extend(row.iter().map(|truth| match truth {
            Truth::Free => '.',
            Truth::Luggage(_) => 'T',
            Truth::Wall => '@',
        }));
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Cell, Piece};
    use hallsweep_core::world::hall_map::Bounds;

    const MAP: &str = "type octile\r\nheight 3\r\nwidth 4\r\nmap\r\n@@.T\r\nO.GS\r\nWTT.\r\n";

    fn check(text: &str, expect: &str) {
        assert_eq!(read("m.map", "m", text).expect_err("this map has a fault").to_string(), expect);
    }

    #[test]
    fn home_is_the_free_cell_nearest_to_the_north_west_and_the_first_of_equals() {
        let hall = read("m.map", "m", MAP).unwrap();
        assert_eq!(hall.bounds(), Bounds { least: Cell::new(-2, 0), most: Cell::new(1, 2) });
        assert_eq!(hall.truth(Cell::HOME), Truth::Free);
    }

    #[test]
    fn every_t_is_a_piece_of_its_own() {
        let hall = read("m.map", "m", MAP).unwrap();
        let cells: Vec<Cell> = hall.pieces().iter().flat_map(|bag| bag.cells.clone()).collect();
        assert_eq!(cells, [Cell::new(1, 0), Cell::new(-1, 2), Cell::new(0, 2)]);
        assert_eq!(hall.truth(Cell::new(0, 2)), Truth::Luggage(Piece(3)));
        assert!(hall.pieces().iter().all(|bag| !bag.dangerous));
    }

    #[test]
    fn a_broken_header_or_row_is_named_with_its_line() {
        check(
            "type octile\nheight x\nwidth 1\nmap\n.\n",
            "m.map:2: this is not a MovingAI map: line 2 reads \"height x\" instead of `height NUMBER`",
        );
        check("type octile\nheight 1\n", "m.map:3: this is not a MovingAI map: line 3 is empty instead of `width NUMBER`");
        check(
            "type octile\nheight 2\nwidth 1\nmap\n.\n",
            "m.map:5: the header says 2 rows, but there are 1: correct `height` or the rows",
        );
        check(
            "type octile\nheight 2\nwidth 1\nmap\n.\n.\n.\n.\n",
            "m.map:7: the header says 2 rows, but there are 4: correct `height` or the rows",
        );
        check(
            "type octile\nheight 1\nwidth 5000\nmap\n.\n",
            "m.map:3: a hall of 5000 × 1 cells is too large: at most 2048 × 2048 cells are allowed",
        );
        check(
            "type octile\nheight 2\nwidth 2\nmap\n..\n.\n",
            "m.map:6: row 2 has 1 columns, the header says 2: correct `width` or the row",
        );
        check("type octile\nheight 1\nwidth 1\nmap\n@\n", "m.map:5: there is no free cell for the robot: make one cell free");
        check(
            "type octile\nheight 0\nwidth 9\nmap\n",
            "m.map:2: a hall of 9 × 0 cells has no floor: give at least one column and one row",
        );
        check(
            "type octile\nheight 1\nwidth 2\nmap\n.x\n",
            "m.map:5: row 1 has 'x' in column 2: a MovingAI map has only `.` `G` `S` (free), `T` (luggage), `@` `O` `W` (wall)",
        );
    }

    const CORNERS: &str = "type octile-corner\nheight 3\nwidth 4\nmap\n0000\n0120\n0000\n@.Tx\n..@?\n@@@@\n";

    #[test]
    fn letters_may_be_small() {
        let small = read("m.map", "m", &MAP.to_lowercase()).unwrap();
        assert_eq!(small, read("m.map", "m", MAP).unwrap());
    }

    #[test]
    fn a_map_with_corner_heights_is_a_column_and_a_row_smaller_than_it_says() {
        let hall = read("m.map", "m", CORNERS).unwrap();
        assert_eq!(hall, read("m.map", "m", "type octile\nheight 2\nwidth 3\nmap\n@.T\n..@\n").unwrap());
    }

    #[test]
    fn what_is_wrong_with_corner_heights_and_types_is_named_with_its_line() {
        let types = "use `octile` or `octile-corner`";
        check(&CORNERS.replace("octile-corner", "tile"), &format!("m.map:1: maps of type \"tile\" are not supported: {types}"));
        check(
            &CORNERS.replace("octile-corner", "octile"),
            "m.map:8: the header says 3 rows, but there are 6: correct `height` or the rows",
        );
        let rows = "an octile-corner map of height 3 has 6 rows after `map`, half of corner heights and half of terrain";
        check(&CORNERS.replace("@@@@\n", ""), &format!("m.map:9: {rows}, but there are 5: correct `height` or the rows"));
        check(
            "type octile-corner\nheight 2\nwidth 2\nmap\n00\n.0\n..\n..\n",
            "m.map:6: row 2 of the corner heights has '.' in column 1: use digits",
        );
        check(&CORNERS.replace("0120", "012"), "m.map:6: row 2 has 3 columns, the header says 4: correct `width` or the row");
        check(
            "type octile-corner\nheight 1\nwidth 9\nmap\n",
            "m.map:2: a hall of 8 × 0 cells has no floor: give at least one column and one row",
        );
        check(
            &CORNERS.replace(".Tx", "#Tx"),
            "m.map:8: row 1 has '#' in column 2: a MovingAI map has only `.` `G` `S` (free), `T` (luggage), `@` `O` `W` (wall)",
        );
    }
}
