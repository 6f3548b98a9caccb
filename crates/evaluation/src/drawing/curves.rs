//! Draws a chart with one line for each measured quantity. The horizontal axis is logarithmic. The vertical axis
//! begins at 0.

use super::{COLOURS, escaped, opening, push};

#[derive(Clone, Debug)]
pub struct Curve {
    pub name: String,
    /// Pairs of x and measured value. Each x is above 0, because its axis is logarithmic.
    pub points: Vec<(f64, f64)>,
}

const WIDTH: f64 = 820.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 180.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 60.0;

/// Number of intervals between the labelled grid lines of the vertical axis.
const PARTS: u8 = 4;

/// The ranges of the axes: `least` to `most` on the logarithmic horizontal axis, 0 to `highest` on the vertical axis.
struct Scale {
    least: f64,
    most: f64,
    highest: f64,
}

impl Scale {
    fn of(curves: &[Curve]) -> Scale {
        let points = || curves.iter().flat_map(|curve| &curve.points);
        Scale {
            least: points().map(|point| point.0).fold(f64::MAX, f64::min),
            most: points().map(|point| point.0).fold(f64::MIN_POSITIVE, f64::max),
            highest: points().map(|point| point.1).fold(f64::MIN_POSITIVE, f64::max),
        }
    }

    fn across(&self, x: f64) -> f64 {
        let share = (x / self.least).ln() / (self.most / self.least).ln().max(f64::MIN_POSITIVE);
        LEFT + (WIDTH - LEFT - RIGHT) * share
    }

    fn down(&self, y: f64) -> f64 {
        HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * y / self.highest
    }
}

/// Draws the chart as SVG. `axes` has the labels of the horizontal and the vertical axis.
#[must_use]
pub fn curves(title: &str, axes: [&str; 2], curves: &[Curve]) -> String {
    let scale = Scale::of(curves);
    let mut out = opening(WIDTH, HEIGHT, title);
    push(&mut out, format_args!("<text x=\"16\" y=\"24\" font-size=\"16\" font-weight=\"600\">{}</text>", escaped(title)));
    draw_axes(&mut out, axes, &scale, curves);
    for (curve, colour) in curves.iter().zip(COLOURS.into_iter().cycle()) {
        draw(&mut out, curve, colour, &scale);
    }
    out.push_str("</svg>\n");
    out
}

fn draw_axes(out: &mut String, [across, up]: [&str; 2], scale: &Scale, curves: &[Curve]) {
    let (end, floor) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
    for part in 0..=PARTS {
        let value = scale.highest * f64::from(part) / f64::from(PARTS);
        let y = scale.down(value);
        push(out, format_args!("<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{end}\" y2=\"{y:.1}\" stroke=\"#dee2e6\"/>"));
        push(out, format_args!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{value:.2}</text>", LEFT - 8.0, y + 4.0));
    }
    for (x, _) in curves.first().into_iter().flat_map(|curve| &curve.points) {
        push(out, format_args!("<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{x}</text>", scale.across(*x), floor + 20.0));
    }
    push(out, format_args!("<text x=\"{LEFT}\" y=\"{}\">{}</text>", TOP - 14.0, escaped(up)));
    push(out, format_args!("<text x=\"{end}\" y=\"{}\" text-anchor=\"end\">{}</text>", floor + 42.0, escaped(across)));
}

fn draw(out: &mut String, curve: &Curve, colour: &str, scale: &Scale) {
    let places: Vec<(f64, f64)> = curve.points.iter().map(|(x, y)| (scale.across(*x), scale.down(*y))).collect();
    let line: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    push(out, format_args!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\"/>", line.join(" ")));
    for (x, y) in &places {
        push(out, format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>"));
    }
    if let Some((x, y)) = places.last() {
        push(
            out,
            format_args!("<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{}</text>", x + 10.0, y + 4.0, escaped(&curve.name)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_stands_where_its_numbers_say() {
        let curve = |name: &str, points: &[(f64, f64)]| Curve { name: name.to_owned(), points: points.to_vec() };
        let drawn = [curve("a & b", &[(50.0, 1.0), (100.0, 2.0), (200.0, 4.0)]), curve("flat", &[(50.0, 0.0), (200.0, 0.0)])];
        let picture = curves("growth", ["cells", "µs"], &drawn);
        assert_eq!((picture.matches("<polyline").count(), picture.matches("<circle").count()), (2, 5));
        assert!(picture.contains("a &amp; b") && picture.contains(">4.00<") && picture.contains(">200<"), "{picture}");
        // On a logarithmic axis, every doubling has the same width. So 100 is in the middle between 50 and 200.
        let middle = f64::midpoint(LEFT, WIDTH - RIGHT);
        assert!(picture.contains(&format!("cx=\"{middle:.1}\" cy=\"{:.1}\"", f64::midpoint(TOP, HEIGHT - BOTTOM))), "{picture}");
        assert!(picture.contains(&format!("cx=\"{LEFT:.1}\" cy=\"{:.1}\"", HEIGHT - BOTTOM)), "{picture}");
    }

    #[test]
    fn nothing_measured_is_an_empty_picture() {
        assert!(!curves("nothing", ["cells", "µs"], &[]).contains("NaN"));
    }
}
