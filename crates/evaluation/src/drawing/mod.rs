//! Pictures of searches as stand-alone SVG files: a tour through a hall, a comparison of strategies, and measurements
//! that grow with the size of the hall.

mod curves;
mod plot;
mod tour;

pub use self::curves::{Curve, curves};
pub use self::plot::{Band, Dot, plot};
pub use self::tour::tour;

use std::fmt::Arguments;

/// The colours, in the order in which they are used. They can be distinguished by people with colour-blindness.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#343a40"];

/// Returns the `<svg>` tag, the title and a white background. The caller must add `</svg>`.
fn opening(width: f64, height: f64, title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
         font-family=\"system-ui, sans-serif\" font-size=\"13\">\n<title>{0}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
        escaped(title)
    )
}

fn push(out: &mut String, line: Arguments<'_>) {
    use std::fmt::Write;
    let _ = writeln!(out, "{line}");
}

/// Escapes characters that are special in SVG. This is needed because names come from files.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            control if control.is_control() => out.push(' '),
            other => out.push(other),
        }
    }
    out
}
