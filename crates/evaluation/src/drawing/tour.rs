//! Draws a tour through a hall: the walls, the luggage, and the robot's path. The path is blue at the beginning and
//! red at the end.

use hallsweep_core::units::Cell;
use hallsweep_sim::{Hall, Truth};

use super::{escaped, opening, push};

/// The longer side of the hall, in the units of the picture.
const SIDE: f64 = 900.0;

const MARGIN: f64 = 16.0;

/// Height of the lines above the hall, in the units of the picture.
const HEAD: f64 = 34.0;

/// Number of different colours along the path, from start to end.
const COLOURS: usize = 24;

#[must_use]
pub fn tour(hall: &Hall, way: &[Cell], caption: &str) -> String {
    let bounds = hall.bounds();
    let (columns, lines) = (f64::from(bounds.width()), f64::from(bounds.height()));
    let side = SIDE / columns.max(lines);
    let (width, height) = (columns * side + 2.0 * MARGIN, lines * side + 2.0 * MARGIN + HEAD);
    let mut out = opening(width, height, caption);
    push(&mut out, format_args!("<text x=\"{MARGIN}\" y=\"{}\">{}</text>", MARGIN + 13.0, escaped(caption)));
    push(&mut out, format_args!("<g transform=\"translate({MARGIN} {})\">", MARGIN + HEAD));
    push(&mut out, format_args!("<rect width=\"{}\" height=\"{}\" fill=\"#f1f3f5\"/>", columns * side, lines * side));
    let place = |cell: Cell| (f64::from(cell.x - bounds.least.x) * side, f64::from(cell.y - bounds.least.y) * side);
    for y in bounds.least.y..=bounds.most.y {
        for x in bounds.least.x..=bounds.most.x {
            let colour = match hall.truth(Cell::new(x, y)) {
                Truth::Free => continue,
                Truth::Wall => "#495057",
                Truth::Luggage(piece) if hall.is_dangerous(piece) => "#c92a2a",
                Truth::Luggage(_) => "#b08968",
            };
            let (left, top) = place(Cell::new(x, y));
            push(
                &mut out,
                format_args!("<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{side:.2}\" height=\"{side:.2}\" fill=\"{colour}\"/>"),
            );
        }
    }
    let centre = |cell: Cell| {
        let (left, top) = place(cell);
        (left + side / 2.0, top + side / 2.0)
    };
    for (number, part) in parts(way).enumerate() {
        let points: Vec<String> = part.iter().map(|cell| centre(*cell)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        push(
            &mut out,
            format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"hsl({} 75% 45%)\" stroke-width=\"{:.2}\" stroke-linejoin=\"round\"/>",
                points.join(" "),
                220 - 220 * number / COLOURS,
                (side / 6.0).max(0.4)
            ),
        );
    }
    let (x, y) = centre(Cell::HOME);
    push(&mut out, format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"#1971c2\"/>", side / 3.0));
    out.push_str("</g>\n</svg>\n");
    out
}

/// Divides the path into parts of equal length. Each part begins where the one before ends.
fn parts(way: &[Cell]) -> impl Iterator<Item = &[Cell]> {
    let steps = way.len().saturating_sub(1);
    let each = steps.div_ceil(COLOURS).max(1);
    (0..steps).step_by(each).map(move |from| &way[from..=(from + each).min(steps)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_of_a_way_is_in_one_part() {
        for steps in [0, 1, 5, 24, 25, 100] {
            let way: Vec<Cell> = (0..=steps).map(|x| Cell::new(x, 0)).collect();
            let drawn: Vec<&[Cell]> = parts(&way).collect();
            assert_eq!(drawn.iter().map(|part| part.len() - 1).sum::<usize>(), usize::try_from(steps).unwrap());
            assert!(drawn.windows(2).all(|pair| pair[0].last() == pair[1].first()));
            assert!(drawn.len() <= COLOURS);
        }
    }

    #[test]
    fn a_tour_shows_walls_luggage_and_the_way_and_says_whose_it_is() {
        let hall = Hall::from_rows("drawn", &["S.#", "..T"]).expect("a valid drawing");
        let picture = tour(&hall, &[Cell::HOME, Cell::new(0, 1), Cell::new(1, 1)], "a <b> & \"c\"");
        assert_eq!(picture.matches("<polyline").count(), 2);
        assert_eq!((picture.matches("#495057").count(), picture.matches("#b08968").count()), (1, 1));
        assert!(picture.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"), "{picture}");
    }
}
