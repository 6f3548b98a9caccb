//! The picture of a run of the pallet scenario: the yard from above, and the ways of both robots and of the parcels.

use std::fmt::Write;

use hallsweep_core::retrieval::Place;
use hallsweep_core::units::Cell;
use hallsweep_sim::Truth;
use hallsweep_sim::pallet::{Frame, PalletRun};

/// The side of a cell in the picture, in its own units.
const SIDE: f64 = 24.0;

/// The yard is drawn with this much wall round it, in cells.
const BORDER: i32 = 1;

/// The whole picture.
pub(super) fn drawing(run: &PalletRun) -> String {
    let yard = run.yard();
    let (bounds, cell_m) = (yard.hall.bounds(), yard.hall.cell_m());
    let corner = Cell::new(bounds.least.x - BORDER, bounds.least.y - BORDER);
    let (columns, rows) = (bounds.width() + 2 * BORDER, bounds.height() + 2 * BORDER);
    let (width, height) = (f64::from(columns) * SIDE, f64::from(rows) * SIDE);
    let mut svg =
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\">\n");
    square(&mut svg, (0.0, 0.0), (width, height), "#5b5f66");
    for y in bounds.least.y..=bounds.most.y {
        for x in bounds.least.x..=bounds.most.x {
            let cell = Cell::new(x, y);
            let at = (f64::from(x - corner.x) * SIDE, f64::from(y - corner.y) * SIDE);
            let fill = match yard.hall.truth(cell) {
                _ if Place::Cell(cell) == yard.target => "#bfe3c8",
                Truth::Free => "#f4f4f2",
                Truth::Wall => continue,
                Truth::Luggage(_) => "#d9b382",
            };
            square(&mut svg, at, (SIDE - 1.0, SIDE - 1.0), fill);
        }
    }
    // The centre of home is the origin of the metres.
    let place = |(x_m, y_m): (f64, f64)| {
        let scale = |metres: f64, corner: i32| (metres / cell_m - f64::from(corner) + 0.5) * SIDE;
        (scale(x_m, corner.x), scale(y_m, corner.y))
    };
    let way = |of: &dyn Fn(&Frame) -> Option<(f64, f64)>| {
        let points = run.frames().iter().filter_map(of).map(|at| {
            let (x, y) = place(at);
            format!("{x:.1},{y:.1}")
        });
        let mut points: Vec<String> = points.collect();
        points.dedup();
        points.join(" ")
    };
    line(&mut svg, &way(&|frame| frame.load.map(|(x, y, _)| (x, y))), "#a8641c", 5.0);
    line(&mut svg, &way(&|frame| Some((frame.bodies[0].x_m, frame.bodies[0].y_m))), "#1f5fa8", 1.5);
    line(&mut svg, &way(&|frame| Some((frame.bodies[1].x_m, frame.bodies[1].y_m))), "#b02a4c", 1.5);
    svg.push_str("</svg>\n");
    svg
}

fn square(svg: &mut String, (x, y): (f64, f64), (width, height): (f64, f64), fill: &str) {
    // Writing to a text does not fail.
    let _ = writeln!(svg, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>");
}

fn line(svg: &mut String, points: &str, stroke: &str, width: f64) {
    let _ = writeln!(
        svg,
        "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" \
         stroke-opacity=\"0.7\"/>"
    );
}
