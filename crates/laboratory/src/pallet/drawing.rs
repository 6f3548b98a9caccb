//! The drawing of a run of the pallet scenario: the yard from above, the paths of both robots and of the parcels, and
//! the robots at the end. It is a complete SVG document. A page can set other colours through its CSS classes.

use std::fmt::Write;

use super::record::Frame;
use super::run::PalletRun;
use hallsweep_core::place::Place;
use hallsweep_core::units::Cell;
use hallsweep_sim::{BodyPose, Truth};

/// Side of a cell, in units of the drawing.
const SIDE: f64 = 24.0;

/// Width of the wall that is drawn around the yard, in cells.
const BORDER: i32 = 1;

const ROBOTS: [Look; 2] = [Look::new("yard-one", "#1f5fa8"), Look::new("yard-two", "#b02a4c")];

/// A CSS class, and the colour that is used if the page sets no other.
#[derive(Clone, Copy)]
struct Look {
    class: &'static str,
    colour: &'static str,
}

impl Look {
    const fn new(class: &'static str, colour: &'static str) -> Look {
        Look { class, colour }
    }
}

/// Converts places of the yard to the drawing. `corner` is the north-western cell of the drawing, including `BORDER`.
struct Scale {
    corner: Cell,
    cell_m: f64,
}

impl Scale {
    fn of_cell(&self, cell: Cell) -> (f64, f64) {
        (f64::from(cell.x - self.corner.x) * SIDE, f64::from(cell.y - self.corner.y) * SIDE)
    }

    /// Converts a point in metres from the centre of home to units of the drawing.
    fn of_metres(&self, (x_m, y_m): (f64, f64)) -> (f64, f64) {
        let scale = |metres: f64, corner: i32| (metres / self.cell_m - f64::from(corner) + 0.5) * SIDE;
        (scale(x_m, self.corner.x), scale(y_m, self.corner.y))
    }
}

/// Title of the drawing, for screen readers and the command line.
pub const TITLE: &str = "The yard from above, with the ways of both robots and of the parcels";

/// Draws the run as SVG. `title` is inserted without escaping.
pub fn drawing(run: &PalletRun, title: &str) -> String {
    let hall = &run.yard().hall;
    let bounds = hall.bounds();
    let scale = Scale { corner: Cell::new(bounds.least.x - BORDER, bounds.least.y - BORDER), cell_m: hall.cell_m() };
    let (columns, rows) = (bounds.width() + 2 * BORDER, bounds.height() + 2 * BORDER);
    let (width, height) = (f64::from(columns) * SIDE, f64::from(rows) * SIDE);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" class=\"yard\" \
         font-family=\"sans-serif\">\n"
    );
    push(&mut svg, format_args!("<title>{title}</title>\n"));
    square(&mut svg, (0.0, 0.0), (width, height), Look::new("yard-wall", "#5b5f66"));
    floor(&mut svg, run, &scale);
    let way = |frames: &[Frame], of: &dyn Fn(&Frame) -> Option<(f64, f64)>| {
        let points = frames.iter().filter_map(of).map(|at| {
            let (x, y) = scale.of_metres(at);
            format!("{x:.1},{y:.1}")
        });
        let mut points: Vec<String> = points.collect();
        points.dedup();
        points.join(" ")
    };
    // Draws one line for each time that a parcel was held.
    for carried in run.frames().split(|frame| frame.load.is_none()).filter(|frames| !frames.is_empty()) {
        line(&mut svg, &way(carried, &|frame| frame.load.map(|(x, y, _)| (x, y))), Look::new("yard-carried", "#a8641c"), 5.0);
    }
    for (index, look) in ROBOTS.into_iter().enumerate() {
        line(&mut svg, &way(run.frames(), &|frame| Some((frame.bodies[index].x_m, frame.bodies[index].y_m))), look, 1.5);
    }
    let end = run.frame();
    for (index, look) in ROBOTS.into_iter().enumerate() {
        robot(&mut svg, &scale, end.bodies[index], index + 1, look);
    }
    svg.push_str("</svg>\n");
    svg
}

fn floor(svg: &mut String, run: &PalletRun, scale: &Scale) {
    let yard = run.yard();
    let bounds = yard.hall.bounds();
    let cells = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
    for cell in cells {
        let look = match yard.hall.truth(cell) {
            _ if Place::Cell(cell) == yard.target => Look::new("yard-target", "#bfe3c8"),
            Truth::Free => Look::new("yard-floor", "#f4f4f2"),
            Truth::Wall => continue,
            Truth::Luggage(_) => Look::new("yard-pallet", "#d9b382"),
        };
        square(svg, scale.of_cell(cell), (SIDE - 1.0, SIDE - 1.0), look);
    }
}

/// Draws a robot: a circle with its number and a mark in the direction that it faces.
fn robot(svg: &mut String, scale: &Scale, body: BodyPose, number: usize, look: Look) {
    let Look { class, colour } = look;
    let (x, y) = scale.of_metres((body.x_m, body.y_m));
    let (ahead_x, ahead_y) = body.ahead();
    let (nose_x, nose_y) = (x + ahead_x * SIDE * 0.46, y + ahead_y * SIDE * 0.46);
    push(
        svg,
        format_args!(
            "<g class=\"{class}-body\" fill=\"{colour}\" stroke=\"{colour}\"><path d=\"M{x:.1} {y:.1}L{nose_x:.1} {nose_y:.1}\" \
             stroke-width=\"5\" stroke-linecap=\"round\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/><text class=\"yard-number\" \
             x=\"{x:.1}\" y=\"{:.1}\" font-size=\"11\" font-weight=\"700\" text-anchor=\"middle\" fill=\"#ffffff\" \
             stroke=\"none\">{number}</text></g>\n",
            SIDE * 0.36,
            y + 4.0
        ),
    );
}

fn square(svg: &mut String, (x, y): (f64, f64), (width, height): (f64, f64), look: Look) {
    let Look { class, colour } = look;
    push(
        svg,
        format_args!("<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{colour}\"/>\n"),
    );
}

fn line(svg: &mut String, points: &str, look: Look, width: f64) {
    let Look { class, colour } = look;
    push(
        svg,
        format_args!(
            "<polyline class=\"{class}\" points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\" stroke-opacity=\"0.7\"/>\n"
        ),
    );
}

fn push(svg: &mut String, text: std::fmt::Arguments<'_>) {
    svg.write_fmt(text).expect("writing to a text does not fail");
}
