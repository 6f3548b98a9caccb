//! The drawing of a run: the room, the floor that the body passed over, the path coloured by phase, the walls that it
//! met, and a legend. It is a complete SVG document without animation. A page can set other colours through its CSS
//! classes.

use std::fmt::Write;

use super::phase::Phase;
use super::room::{RADIUS_M, ROOM_LENGTH_M, ROOM_WIDTH_M};
use super::run::{Controller, Frame, Run};

/// Length of a metre, in units of the drawing.
const SCALE: f64 = 100.0;

/// Free margin around a room, in units of the drawing.
const MARGIN: f64 = 20.0;

/// Height of the lines above a room, in units of the drawing.
const HEAD: f64 = 58.0;

/// Height of the legend below a room, in units of the drawing.
const FOOT: f64 = 62.0;

/// Number of ticks between the drawn points of a spiral. The points are about 3 cm apart, so that no corners are
/// visible.
const SPIRAL_TICKS: u32 = 4;

struct Look {
    class: &'static str,
    colour: &'static str,
    width: f64,
}

/// Texts of a drawing, in the reader's language. They are inserted into the document without escaping.
pub trait Words {
    /// Controller, seed and duration of the run.
    fn title(&self, run: &Run) -> String;

    fn summary(&self, run: &Run) -> String;

    /// Legend for the mark of a wall that was met.
    fn wall_met(&self) -> String;

    /// Legend for the colour of the floor that was passed over.
    fn floor_passed(&self) -> String;

    /// Legend for the cross at the start and the circle at the end.
    fn start_and_end(&self) -> String;
}

/// English texts, for the command line.
#[derive(Clone, Copy, Debug)]
pub(super) struct English;

impl Words for English {
    fn title(&self, run: &Run) -> String {
        let who = match run.controller {
            Controller::Machine => "State machine",
            Controller::Tree => "Behaviour tree",
        };
        format!("{who}, seed {}, {} s", run.seed, run.figures.seconds)
    }

    fn summary(&self, run: &Run) -> String {
        let figures = &run.figures;
        let walls = if figures.bumps == 1 { "wall met once".to_owned() } else { format!("walls met {} times", figures.bumps) };
        format!("{:.1} % of the floor passed over, {:.2} m driven, {walls}", figures.share() * 100.0, figures.path_m)
    }

    fn wall_met(&self) -> String {
        "wall met".to_owned()
    }

    fn floor_passed(&self) -> String {
        "floor passed over".to_owned()
    }

    fn start_and_end(&self) -> String {
        "start; the circle is its end".to_owned()
    }
}

/// Draws the runs side by side in one SVG document, in the given order.
#[must_use]
pub(super) fn svg(runs: &[&Run], said: &dyn Words) -> String {
    let (width, height) = (ROOM_LENGTH_M * SCALE + 2.0 * MARGIN, HEAD + ROOM_WIDTH_M * SCALE + FOOT);
    let rooms = runs.iter().fold(0.0, |count, _| count + 1.0);
    let whole = width * rooms;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {whole} {height}\" width=\"{whole}\" height=\"{height}\" role=\"img\" \
         class=\"roomba\" font-family=\"system-ui, sans-serif\" font-size=\"15\">\n"
    );
    let titles: Vec<String> = runs.iter().map(|run| format!("{}: {}", said.title(run), said.summary(run))).collect();
    push(&mut out, format_args!("<title>{}</title>\n", titles.join("; ")));
    push(&mut out, format_args!("<rect class=\"roomba-paper\" width=\"{whole}\" height=\"{height}\" fill=\"#ffffff\"/>\n"));
    let mut left = 0.0;
    for run in runs {
        push(&mut out, format_args!("<g transform=\"translate({} {HEAD})\">\n", left + MARGIN));
        panel(&mut out, run, said);
        out.push_str("</g>\n");
        left += width;
    }
    out.push_str("</svg>\n");
    out
}

fn panel(out: &mut String, run: &Run, said: &dyn Words) {
    let (length, width) = (ROOM_LENGTH_M * SCALE, ROOM_WIDTH_M * SCALE);
    push(
        out,
        format_args!("<text class=\"roomba-text\" y=\"-34\" font-size=\"18\" font-weight=\"600\">{}</text>\n", said.title(run)),
    );
    push(out, format_args!("<text class=\"roomba-text\" y=\"-12\">{}</text>\n", said.summary(run)));
    push(out, format_args!("<rect class=\"roomba-floor\" width=\"{length}\" height=\"{width}\" fill=\"#f1f3f5\"/>\n"));
    floor(out, run);
    push(
        out,
        format_args!(
            "<rect class=\"roomba-wall\" x=\"-3\" y=\"-3\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#343a40\" \
             stroke-width=\"6\"/>\n",
            length + 6.0,
            width + 6.0
        ),
    );
    for phase in [Phase::MoveForward, Phase::MoveInSpiral, Phase::GoBack] {
        way(out, run, phase);
    }
    for frame in run.frames.iter().filter(|frame| frame.bumper && frame.phase.heeds_bumper()) {
        let (x, y) = touched(frame);
        mark(out, x, y, "roomba-bump", "#c92a2a");
    }
    for change in run.transitions.iter().filter(|change| change.to == Phase::Rotate) {
        if let Some(frame) = run.frames.get(change.tick as usize) {
            mark(out, frame.pose.x_m * SCALE, frame.pose.y_m * SCALE, "roomba-turn", "#e8890c");
        }
    }
    if let (Some(first), Some(last)) = (run.frames.first(), run.frames.last()) {
        let (x, y) = (first.pose.x_m * SCALE, first.pose.y_m * SCALE);
        push(
            out,
            format_args!(
                "<path class=\"roomba-start\" d=\"M{:.1} {y:.1}h14M{x:.1} {:.1}v14\" stroke=\"#343a40\" stroke-width=\"2\"/>\n",
                x - 7.0,
                y - 7.0
            ),
        );
        body(out, last);
    }
    legend(out, width + 30.0, said);
}

/// Draws the floor that was passed over: the path of the run, as wide as the body.
fn floor(out: &mut String, run: &Run) {
    let mut path = String::new();
    for (index, (x, y)) in points(run).map(|(_, x, y)| (x, y)).enumerate() {
        push(&mut path, format_args!("{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' }));
    }
    push(
        out,
        format_args!(
            "<path class=\"roomba-passed\" d=\"{path}\" fill=\"none\" stroke=\"#cfe3f7\" stroke-width=\"{}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"round\"/>\n",
            2.0 * RADIUS_M * SCALE
        ),
    );
}

fn way(out: &mut String, run: &Run, phase: Phase) {
    let mut path = String::new();
    let mut last = None;
    let mut is_drawing = false;
    for (of, x, y) in points(run) {
        if of == phase {
            if let (false, Some((x, y))) = (is_drawing, last) {
                push(&mut path, format_args!("M{x:.1} {y:.1}"));
            }
            push(&mut path, format_args!("L{x:.1} {y:.1}"));
        }
        is_drawing = of == phase;
        last = Some((x, y));
    }
    // Only a path that begins at the start of the run begins with `L`. A path must begin with `M`.
    let path = path.strip_prefix('L').map_or_else(|| path.clone(), |rest| format!("M{rest}"));
    let Look { class, colour, width } = look(phase);
    if !path.is_empty() {
        push(
            out,
            format_args!(
                "<path class=\"{class}\" d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"/>\n"
            ),
        );
    }
}

/// Points of the path, each with the phase that led to it. Straight phases have only their end, and spirals have many
/// points.
fn points(run: &Run) -> impl Iterator<Item = (Phase, f64, f64)> {
    let next = run.frames.iter().skip(1).map(Some).chain([None]);
    let drawn = run.frames.iter().zip(next).filter(|(frame, next)| {
        let is_end = next.is_none_or(|next| next.phase != frame.phase);
        let is_of_curve = frame.phase == Phase::MoveInSpiral && frame.tick.is_multiple_of(SPIRAL_TICKS);
        frame.tick == 0 || (frame.phase != Phase::Rotate && (is_end || is_of_curve))
    });
    drawn.map(|(frame, _)| (frame.phase, frame.pose.x_m * SCALE, frame.pose.y_m * SCALE))
}

/// The point of the wall that the body touches, in units of the drawing.
fn touched(frame: &Frame) -> (f64, f64) {
    let towards = |at: f64, most: f64| {
        if at <= RADIUS_M {
            0.0
        } else if at >= most - RADIUS_M {
            most
        } else {
            at
        }
    };
    (towards(frame.pose.x_m, ROOM_LENGTH_M) * SCALE, towards(frame.pose.y_m, ROOM_WIDTH_M) * SCALE)
}

fn mark(out: &mut String, x: f64, y: f64, class: &str, colour: &str) {
    push(
        out,
        format_args!(
            "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\" stroke=\"#ffffff\" stroke-width=\"1.5\"/>\n"
        ),
    );
}

fn body(out: &mut String, frame: &Frame) {
    let (x, y, r) = (frame.pose.x_m * SCALE, frame.pose.y_m * SCALE, RADIUS_M * SCALE);
    let (dx, dy) = frame.pose.ahead();
    push(
        out,
        format_args!(
            "<g class=\"roomba-body\" fill=\"#ffffff\" fill-opacity=\"0.85\" stroke=\"#343a40\" stroke-width=\"2\">\
             <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\"/><path d=\"M{x:.1} {y:.1}L{:.1} {:.1}\"/></g>\n",
            x + dx * r,
            y + dy * r
        ),
    );
}

fn legend(out: &mut String, y: f64, said: &dyn Words) {
    let mut x = 0.0;
    for phase in Phase::ALL {
        let Look { class, colour, .. } = look(phase);
        if phase == Phase::Rotate {
            mark(out, x + 13.0, y - 5.0, class, colour);
        } else {
            push(
                out,
                format_args!("<path class=\"{class}\" d=\"M{x} {}h26\" stroke=\"{colour}\" stroke-width=\"4\"/>\n", y - 5.0),
            );
        }
        words(out, x + 33.0, y, phase.name());
        x += 160.0;
    }
    mark(out, 13.0, y + 17.0, "roomba-bump", "#c92a2a");
    words(out, 33.0, y + 22.0, &said.wall_met());
    push(
        out,
        format_args!("<rect class=\"roomba-key\" x=\"160\" y=\"{}\" width=\"26\" height=\"12\" fill=\"#cfe3f7\"/>\n", y + 11.0),
    );
    words(out, 193.0, y + 22.0, &said.floor_passed());
    push(
        out,
        format_args!(
            "<path class=\"roomba-start\" d=\"M376 {}h14M383 {}v14\" stroke=\"#343a40\" stroke-width=\"2\"/>\n",
            y + 17.0,
            y + 10.0
        ),
    );
    words(out, 403.0, y + 22.0, &said.start_and_end());
}

fn words(out: &mut String, x: f64, y: f64, text: &str) {
    push(out, format_args!("<text class=\"roomba-text\" x=\"{x}\" y=\"{y}\">{text}</text>\n"));
}

const fn look(phase: Phase) -> Look {
    match phase {
        Phase::MoveForward => Look { class: "roomba-forward", colour: "#1864ab", width: 2.5 },
        Phase::MoveInSpiral => Look { class: "roomba-spiral", colour: "#2b8a3e", width: 2.5 },
        Phase::GoBack => Look { class: "roomba-back", colour: "#c2255c", width: 5.0 },
        Phase::Rotate => Look { class: "roomba-turn", colour: "#e8890c", width: 0.0 },
    }
}

fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    out.write_fmt(text).expect("a String takes every text");
}

#[cfg(test)]
mod tests {
    use super::super::RunLength;
    use super::*;

    fn run(seed: u64, seconds: f64) -> Run {
        Run::new(Controller::Machine, seed, RunLength::from_seconds(seconds).unwrap())
    }

    fn count(drawing: &str, what: &str) -> usize {
        drawing.matches(what).count()
    }

    /// The legend adds one mark of each kind.
    #[test]
    fn every_wall_met_and_every_turn_is_marked() {
        let run = run(3, 120.0);
        let drawing = svg(&[&run], &English);
        assert!(run.figures.bumps > 3);
        assert_eq!(count(&drawing, "class=\"roomba-bump\""), run.figures.bumps as usize + 1);
        let turns = run.transitions.iter().filter(|change| change.to == Phase::Rotate).count();
        assert_eq!(count(&drawing, "class=\"roomba-turn\""), turns + 1);
    }

    #[test]
    fn the_way_begins_in_the_middle_and_a_straight_phase_is_one_line() {
        let drawing = svg(&[&run(1, 3.0)], &English);
        for class in ["roomba-forward", "roomba-passed"] {
            assert!(drawing.contains(&format!("class=\"{class}\" d=\"M320.0 240.0L470.0 240.0\"")), "{drawing}");
        }
        assert_eq!(count(&drawing, "class=\"roomba-spiral\""), 1, "the legend's alone");
    }

    #[test]
    fn a_run_of_an_hour_is_drawn_within_a_megabyte() {
        assert!(svg(&[&run(1, 3600.0)], &English).len() < 1_000_000);
    }

    #[test]
    fn two_runs_are_drawn_side_by_side_with_their_figures() {
        let run = run(1, 60.0);
        let drawing = svg(&[&run, &Run { controller: Controller::Tree, ..run.clone() }], &English);
        assert_eq!(count(&drawing, "class=\"roomba-wall\""), 2);
        assert!(drawing.contains("viewBox=\"0 0 1360 600\""), "{}", &drawing[..200]);
        assert!(drawing.contains(">State machine, seed 1, 60 s<") && drawing.contains(">Behaviour tree, seed 1, 60 s<"));
    }
}
