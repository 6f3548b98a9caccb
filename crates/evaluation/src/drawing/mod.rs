//! Pictures of searches as stand-alone SVG: a tour through a hall, strategies side by side, and growth with the size of
//! the hall.

mod curves;
mod plot;
mod tour;

pub use self::curves::{Curve, curves};
pub use self::plot::{Band, Dot, plot};
pub use self::tour::tour;

use std::fmt::Arguments;

/// Colours in their order of use, chosen to be distinct for people with defective colour vision.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#343a40"];

/// The `<svg>` tag with its title and a white background; the caller writes `</svg>`.
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

/// Escapes text and attributes of SVG; names come from files.
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
