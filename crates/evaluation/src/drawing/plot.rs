//! Draws a comparison of strategies. Each kind of hall has a band. In the band, each strategy has a line with its
//! mean and its confidence interval.

use super::{COLOURS, escaped, opening, push};
use crate::compare::Estimate;

#[derive(Clone, Debug)]
pub struct Band {
    pub title: String,
    pub dots: Vec<Dot>,
}

#[derive(Clone, Debug)]
pub struct Dot {
    pub name: String,
    pub estimate: Estimate,
}

const WIDTH: f64 = 820.0;
const LEFT: f64 = 150.0;
const RIGHT: f64 = 130.0;
const LINE: f64 = 20.0;
const TITLE: f64 = 34.0;

/// Draws the bands as SVG. Each band has its own scale, from 0 to the largest number in it.
#[must_use]
pub fn plot(title: &str, bands: &[Band]) -> String {
    let lines = bands.iter().map(|band| TITLE + LINE * count(band.dots.len()) + 12.0);
    let height = 40.0 + lines.sum::<f64>();
    let mut out = opening(WIDTH, height, title);
    push(&mut out, format_args!("<text x=\"16\" y=\"24\" font-size=\"16\" font-weight=\"600\">{}</text>", escaped(title)));
    let mut top = 40.0;
    for band in bands {
        draw(&mut out, band, top);
        top += TITLE + LINE * count(band.dots.len()) + 12.0;
    }
    out.push_str("</svg>\n");
    out
}

fn draw(out: &mut String, band: &Band, top: f64) {
    let most = band.dots.iter().map(|dot| dot.estimate.mean + dot.estimate.half_width).fold(f64::MIN_POSITIVE, f64::max);
    let across = |value: f64| LEFT + (WIDTH - LEFT - RIGHT) * value.max(0.0) / most;
    push(out, format_args!("<text x=\"16\" y=\"{}\" font-weight=\"600\">{}</text>", top + 20.0, escaped(&band.title)));
    for (number, dot) in band.dots.iter().enumerate() {
        let (y, Estimate { mean, half_width, .. }) = (top + TITLE + LINE * count(number) + 6.0, dot.estimate);
        let colour = COLOURS[number % COLOURS.len()];
        push(
            out,
            format_args!("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", LEFT - 10.0, y + 4.0, escaped(&dot.name)),
        );
        push(
            out,
            format_args!(
                "<line x1=\"{LEFT}\" y1=\"{y}\" x2=\"{:.1}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"7\" opacity=\"0.35\"/>",
                across(mean)
            ),
        );
        push(
            out,
            format_args!(
                "<line x1=\"{:.1}\" y1=\"{y}\" x2=\"{:.1}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"3\"/>",
                across(mean - half_width),
                across(mean + half_width)
            ),
        );
        push(out, format_args!("<circle cx=\"{:.1}\" cy=\"{y}\" r=\"4.5\" fill=\"{colour}\"/>", across(mean)));
        push(out, format_args!("<text x=\"{:.1}\" y=\"{}\">{}</text>", across(mean + half_width) + 10.0, y + 4.0, dot.estimate));
    }
}

#[expect(clippy::cast_precision_loss, reason = "a picture has few lines")]
fn count(lines: usize) -> f64 {
    lines as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strategy_has_its_line_with_the_numbers_it_stands_for() {
        let dot = |name: &str, mean| Dot { name: name.to_owned(), estimate: Estimate { mean, half_width: 0.25, count: 60 } };
        let band = Band { title: "walls & corners".to_owned(), dots: vec![dot("snail", 4.0), dot("columns", 2.0)] };
        let picture = plot("moves", &[band.clone(), band]);
        assert_eq!(picture.matches("<circle").count(), 4);
        assert!(picture.contains("walls &amp; corners") && picture.contains("4.000 ± 0.250"), "{picture}");
        // The bar of the largest mean reaches the right end. The bar of half that mean is half as long.
        let ends: Vec<f64> = picture
            .split("cx=\"")
            .skip(1)
            .filter_map(|rest| rest.split('"').next()?.parse().ok())
            .map(|x: f64| x - LEFT)
            .collect();
        assert!((ends[0] / ends[1] - 2.0).abs() < 0.01, "{ends:?}");
    }
}
