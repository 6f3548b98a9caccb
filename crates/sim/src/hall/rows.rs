//! Reads a drawing of a hall: rows of `.` `#` `S` `T` and letters. The descriptions of lettered pieces are read
//! elsewhere.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::error::{HallError, HallFault};
use super::{Hall, MAX_PIECES, MAX_SIDE, Plan, Truth};
use crate::bag::Bag;
use hallsweep_core::units::{Cell, Piece};
use hallsweep_core::world::hall_map::Bounds;

#[derive(Debug)]
pub(super) struct Drawing {
    pub(super) plan: Plan,
    pub(super) letters: BTreeMap<char, Piece>,
}

/// The row of a fault, counted from 1, and the fault. Row 0 means the drawing as a whole.
pub(super) type RowFault = (usize, HallFault);

impl Hall {
    /// Makes a hall from rows of characters: `.` is free, `#` a wall, `S` the start. All cells with the same letter
    /// a–z are one piece of luggage. Each `T` is a piece of its own. All luggage is harmless. The order of the pieces
    /// determines their kinds and colours.
    ///
    /// # Errors
    /// Returns the first fault, with its row as the line.
    pub fn from_rows(name: &str, rows: &[&str]) -> Result<Hall, HallError> {
        let drawing = read(rows).map_err(|(row, fault)| if row == 0 { fault.of(name) } else { fault.at(name, row) })?;
        Ok(Hall::of(name, drawing.plan))
    }
}

/// The plan of a hall that is a rectangle of free cells. The start is in the north-west corner.
pub(super) fn empty(width: u64, height: u64) -> Result<Plan, HallFault> {
    let (columns, rows) = sides(width, height)?;
    let bounds = Bounds { least: Cell::HOME, most: Cell::new(columns - 1, rows - 1) };
    let count = usize::try_from(width * height).expect("the sides have just been bounded");
    Ok(Plan { bounds, squares: vec![Truth::Free; count], bags: Vec::new() })
}

pub(super) fn sides(width: u64, height: u64) -> Result<(i32, i32), HallFault> {
    if width == 0 || height == 0 {
        return Err(HallFault::Empty(width, height));
    }
    let side = |cells: u64| i32::try_from(cells).ok().filter(|_| cells <= MAX_SIDE as u64);
    side(width).zip(side(height)).ok_or(HallFault::TooLarge(width, height, MAX_SIDE))
}

pub(super) fn read(rows: &[&str]) -> Result<Drawing, RowFault> {
    let width = rows.first().map_or(0, |row| row.chars().count());
    let size = sides(width as u64, rows.len() as u64).map_err(|fault| (0, fault))?;
    let mut reading = DrawingRows::default();
    for (index, row) in rows.iter().enumerate() {
        let columns = row.chars().count();
        if columns != width {
            return Err((index + 1, HallFault::Ragged { row: index + 1, columns, first: width }));
        }
        reading.row(index, row).map_err(|fault| (index + 1, fault))?;
    }
    reading.finish(size)
}

/// The part of a drawing that was read so far, in columns and rows of the drawing.
#[derive(Default)]
pub(super) struct DrawingRows {
    pub(super) squares: Vec<Truth>,
    pub(super) start: Option<Cell>,
    letters: BTreeMap<char, Piece>,
    cells: Vec<Vec<Cell>>,
}

impl DrawingRows {
    fn row(&mut self, index: usize, row: &str) -> Result<(), HallFault> {
        for (place, mark) in row.chars().enumerate() {
            let cell = drawn(place, index);
            let square = match mark {
                '.' => Truth::Free,
                '#' => Truth::Wall,
                'S' if self.start.is_some() => return Err(HallFault::SecondStart { row: index + 1, column: place + 1 }),
                'S' => {
                    self.start = Some(cell);
                    Truth::Free
                }
                'T' => Truth::Luggage(self.new_piece(cell)?),
                'a'..='z' => Truth::Luggage(self.lettered(mark, cell)?),
                _ => return Err(HallFault::UnknownSquare { row: index + 1, column: place + 1, mark }),
            };
            self.squares.push(square);
        }
        Ok(())
    }

    /// Chooses the robot's start when the file does not set it. The start is in the largest connected part of the
    /// floor: the cell of this part with the smallest sum of column and row. Of cells with the same sum, the
    /// northernmost is chosen.
    pub(super) fn start_in_largest_part(&self, columns: usize) -> Option<Cell> {
        let from_corner = |place: usize| (place % columns + place / columns, place);
        let mut seen = vec![false; self.squares.len()];
        let mut largest = (0, Reverse((0, 0)));
        for place in 0..self.squares.len() {
            if self.squares[place] == Truth::Free && !seen[place] {
                let part = part(&self.squares, columns, place, &mut seen);
                let first = part.iter().map(|place| from_corner(*place)).min().unwrap_or_default();
                largest = largest.max((part.len(), Reverse(first)));
            }
        }
        let (cells, Reverse((_, place))) = largest;
        (cells > 0).then(|| drawn(place % columns, place / columns))
    }

    /// Adds a cell to the piece with this letter. Begins a new piece if the letter is new.
    fn lettered(&mut self, letter: char, cell: Cell) -> Result<Piece, HallFault> {
        if let Some(piece) = self.letters.get(&letter).copied() {
            return Ok(self.extend(piece, cell));
        }
        let piece = self.new_piece(cell)?;
        self.letters.insert(letter, piece);
        Ok(piece)
    }

    pub(super) fn extend(&mut self, piece: Piece, cell: Cell) -> Piece {
        self.cells[piece.0 as usize - 1].push(cell);
        piece
    }

    pub(super) fn new_piece(&mut self, cell: Cell) -> Result<Piece, HallFault> {
        if self.cells.len() == MAX_PIECES {
            return Err(HallFault::TooManyPieces(MAX_PIECES));
        }
        self.cells.push(vec![cell]);
        Ok(Piece(u32::try_from(self.cells.len()).expect("the pieces have just been bounded")))
    }

    fn finish(self, size: (i32, i32)) -> Result<Drawing, RowFault> {
        let start = self.start.ok_or((0, HallFault::NoStart))?;
        for (letter, piece) in &self.letters {
            let cells = &self.cells[piece.0 as usize - 1];
            if !touch(cells) {
                let row = cells.last().and_then(|cell| usize::try_from(cell.y + 1).ok()).unwrap_or(0);
                return Err((row, HallFault::Scattered(*letter)));
            }
        }
        Ok(Drawing { letters: self.letters.clone(), plan: self.plan(start, size) })
    }

    /// The plan in map coordinates. No piece has a description yet.
    pub(super) fn plan(self, start: Cell, (width, height): (i32, i32)) -> Plan {
        let from_start = |cell: Cell| cell.relative_to(start);
        let bounds = Bounds { least: from_start(Cell::HOME), most: from_start(Cell::new(width - 1, height - 1)) };
        let moved = self.cells.into_iter().map(|cells| cells.into_iter().map(from_start).collect());
        let bags = (1..).zip(moved).map(|(number, cells)| Bag::plain(Piece(number), cells)).collect();
        Plan { bounds, squares: self.squares, bags }
    }
}

/// The free squares connected with `from` over their sides, including `from` itself. Marks them all in `seen`.
pub(super) fn part(squares: &[Truth], columns: usize, from: usize, seen: &mut [bool]) -> Vec<usize> {
    seen[from] = true;
    let (mut part, mut looked_at) = (vec![from], 0);
    while let Some(place) = part.get(looked_at).copied() {
        looked_at += 1;
        let west = (place % columns > 0).then(|| place - 1);
        let east = ((place + 1) % columns > 0).then_some(place + 1);
        for next in [place.checked_sub(columns), west, east, Some(place + columns)].into_iter().flatten() {
            if squares.get(next) == Some(&Truth::Free) && !std::mem::replace(&mut seen[next], true) {
                part.push(next);
            }
        }
    }
    part
}

/// The cell at this column and row of a drawing, both counted from 0.
pub(super) fn drawn(column: usize, row: usize) -> Cell {
    let number = |place: usize| i32::try_from(place).expect("the sides of a hall have been bounded");
    Cell::new(number(column), number(row))
}

/// Whether all these cells are connected over their sides.
fn touch(cells: &[Cell]) -> bool {
    let mut left: BTreeSet<Cell> = cells.iter().copied().collect();
    let mut border: Vec<Cell> = left.pop_first().into_iter().collect();
    while let Some(cell) = border.pop() {
        border.extend(cell.neighbours().into_iter().filter(|next| left.remove(next)));
    }
    left.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(rows: &[&str], expect: &str) {
        let error = Hall::from_rows("drawing", rows).expect_err("this drawing has a fault");
        assert_eq!(error.to_string(), expect);
    }

    /// A terminal would execute control characters.
    #[test]
    fn a_name_has_no_control_characters() {
        assert_eq!(Hall::from_rows("a\u{1b}[31m\nb", &["S"]).unwrap().name(), "a [31m b");
    }

    #[test]
    fn faults_of_a_drawing_are_named_with_their_row() {
        check(&["S..", ".."], "drawing:2: row 2 has 2 columns, row 1 has 3: make all rows equally long");
        check(&["..", ".."], "drawing: there is no start: put one `S` into the drawing where the robot starts");
        check(&["S.", ".S"], "drawing:2: there is a second start `S` in row 2, column 2: keep only one");
        check(
            &["S?"],
            "drawing:1: row 1 has '?' in column 2: use `.` (free), `#` (wall), `S` (start), a letter a–z or `T` (luggage)",
        );
        check(&[], "drawing: a hall of 0 × 0 cells has no floor: give at least one column and one row");
        check(
            &["Sa", "..", ".a"],
            "drawing:3: luggage `a` is drawn in places that do not touch: give each piece a letter of its own",
        );
    }

    #[test]
    fn every_t_is_a_harmless_piece_of_its_own_numbered_with_the_letters_in_reading_order() {
        let hall = Hall::from_rows("drawing", &["STT", "a.T", "aTb"]).unwrap();
        let cells: Vec<Vec<(i32, i32)>> =
            hall.pieces().iter().map(|bag| bag.cells.iter().map(|cell| (cell.x, cell.y)).collect()).collect();
        let [t, next_t, a] = [vec![(1, 0)], vec![(2, 0)], vec![(0, 1), (0, 2)]];
        assert_eq!(cells, [t, next_t, a, vec![(2, 1)], vec![(1, 2)], vec![(2, 2)]]);
        assert_eq!(hall.truth(Cell::new(2, 1)), Truth::Luggage(Piece(4)));
        for (number, bag) in (1..).zip(hall.pieces()) {
            assert_eq!(*bag, Bag::plain(Piece(number), bag.cells.clone()), "kind and colour follow from the order");
            assert!(!bag.dangerous);
        }
    }

    #[test]
    fn more_single_pieces_than_the_bound_are_refused_at_their_row() {
        let side = "T".repeat(MAX_SIDE);
        let mut rows = vec![format!("S{}", &side[1..])];
        rows.resize(MAX_PIECES / MAX_SIDE, side.clone());
        let drawing: Vec<&str> = rows.iter().map(String::as_str).collect();
        assert_eq!(Hall::from_rows("drawing", &drawing).unwrap().pieces().len(), MAX_PIECES - 1);
        let more: Vec<&str> = drawing.into_iter().chain([side.as_str()]).collect();
        check(&more, "drawing:129: there are more than 262144 pieces of luggage: remove some");
    }

    #[test]
    fn a_drawing_larger_than_the_bound_is_refused() {
        let row = ".".repeat(MAX_SIDE + 1);
        check(&[&row], "drawing: a hall of 2049 × 1 cells is too large: at most 2048 × 2048 cells are allowed");
    }
}
