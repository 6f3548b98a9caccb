//! Runs of the Roomba as the pages and the command line show them.

use schemars::JsonSchema;
use serde::Serialize;

use super::compare::{Parting, parting};
use super::drawing::{English, Words, svg};
use super::floor::SQUARE_M;
use super::length::{RunLength, RunLengthError};
use super::phase::Phase;
use super::room::{RADIUS_M, ROOM_LENGTH_M, ROOM_WIDTH_M, TICKS_PER_SECOND};
use super::run::{Controller, Figures, Frame, Run, Transition};

/// Interval of the frames, in ticks. Fifteen frames per second look smooth. The end of each phase is a frame too.
const FRAME_TICKS: u32 = TICKS_PER_SECOND / 15;

/// Runs with the same seed and duration: of the machine, of the tree, or of both.
#[derive(Clone, Debug)]
pub struct Roomba {
    seed: u64,
    runs: Vec<Run>,
}

/// Name of a figure, and its value in each of the runs.
pub type FigureRow = (&'static str, Vec<String>);

/// Runs of the Roomba: times in seconds, lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RoombaJson {
    seed: u64,
    /// Duration of each run.
    seconds: f64,
    room: RoomJson,
    robot: BodyJson,
    /// Names of the phases. The fifth number of a frame is an index into this list, counted from 0.
    phases: [&'static str; 4],
    runs: Vec<RunJson>,
    /// Whether machine and tree made the same transitions. Null if there is only one run.
    same: Option<bool>,
    /// Where and how the two runs differ, in words.
    parting: Option<String>,
}

/// The room. Its north-west corner is (0, 0), and x grows along its length.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RoombaRoom")]
#[serde(rename_all = "camelCase")]
struct RoomJson {
    length_m: f64,
    width_m: f64,
    /// Side of a square of the floor, in metres.
    square_m: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RoombaBody")]
#[serde(rename_all = "camelCase")]
struct BodyJson {
    radius_m: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RoombaRun")]
struct RunJson {
    /// `machine` or `tree`.
    controller: &'static str,
    frames: Vec<FrameJson>,
    transitions: Vec<TransitionJson>,
    figures: FiguresJson,
}

/// `[t, x, y, θ, phase, passed]`: seconds, metres, metres, radians clockwise from the x axis, index of the phase that
/// lasted until then, and number of floor squares passed over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RoombaFrame")]
struct FrameJson(f64, f64, f64, f64, usize, u32);

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
struct TransitionJson {
    /// Seconds since the start.
    t: f64,
    from: &'static str,
    to: &'static str,
    /// Angle of a turn, in radians in -π..π. Null for other phases.
    angle_rad: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RoombaFigures")]
#[serde(rename_all = "camelCase")]
struct FiguresJson {
    path_m: f64,
    bumps: u32,
    transitions: usize,
    passed_squares: u32,
    /// Number of squares that a round body can pass over: all except those in the corners.
    reachable_squares: u32,
    /// `passedSquares` divided by `reachableSquares`.
    share: f64,
    /// Seconds in each phase, in the order of `phases`.
    in_phase_s: [f64; 4],
}

impl Roomba {
    pub fn new(controllers: &[Controller], seed: u64, length: RunLength) -> Roomba {
        Roomba { seed, runs: controllers.iter().map(|controller| Run::new(*controller, seed, length)).collect() }
    }

    /// Runs the machine and the tree for this number of seconds.
    ///
    /// # Errors
    /// When `seconds` is not within 1 to `RunLength::LONGEST_S`.
    pub fn both(seed: u64, seconds: u32) -> Result<Roomba, RunLengthError> {
        Ok(Roomba::new(&Controller::ALL, seed, RunLength::from_seconds(f64::from(seconds))?))
    }

    /// Name of each run, in the order of the runs.
    pub fn names(&self) -> Vec<&'static str> {
        self.runs.iter().map(|run| run.controller.name()).collect()
    }

    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    pub fn transitions(&self) -> usize {
        self.runs.first().map_or(0, |run| run.transitions.len())
    }

    pub fn is_comparison(&self) -> bool {
        self.runs.len() > 1
    }

    /// The first difference between machine and tree, if both were run and they differ.
    pub fn parting(&self) -> Option<Parting> {
        match self.runs.as_slice() {
            [one, other] => parting(one, other),
            _ => None,
        }
    }

    /// Draws all runs side by side.
    pub fn drawing(&self) -> String {
        svg(&self.runs.iter().collect::<Vec<_>>(), &English)
    }

    /// Draws each run by itself, in order, with these texts.
    pub fn drawings(&self, said: &dyn Words) -> Vec<String> {
        self.runs.iter().map(|run| svg(&[run], said)).collect()
    }

    pub fn figures(&self) -> Vec<FigureRow> {
        let row = |name, value: &dyn Fn(&Figures) -> String| {
            (name, self.runs.iter().map(|run| value(&run.figures)).collect::<Vec<String>>())
        };
        let mut rows = vec![
            row("path", &|figures| format!("{:.2} m", figures.path_m)),
            row("floor passed over", &|figures| format!("{:.1} %", figures.share() * 100.0)),
            row("squares of 5 cm", &|figures| format!("{} of {}", figures.passed, figures.reachable)),
            row("walls met", &|figures| figures.bumps.to_string()),
            ("transitions", self.runs.iter().map(|run| run.transitions.len().to_string()).collect()),
        ];
        for (index, phase) in Phase::ALL.into_iter().enumerate() {
            rows.push(row(phase.name(), &|figures| format!("{:.2} s", figures.in_phase_s[index])));
        }
        rows
    }

    pub fn json(&self) -> String {
        serde_json::to_string(&RoombaJson::from(self)).expect("runs are finite numbers and words, which JSON can hold")
    }
}

impl From<&Roomba> for RoombaJson {
    fn from(roomba: &Roomba) -> RoombaJson {
        let parting = roomba.parting();
        RoombaJson {
            seed: roomba.seed,
            seconds: roomba.runs.first().map_or(0.0, |run| run.figures.seconds),
            room: RoomJson { length_m: ROOM_LENGTH_M, width_m: ROOM_WIDTH_M, square_m: SQUARE_M },
            robot: BodyJson { radius_m: RADIUS_M },
            phases: Phase::ALL.map(Phase::name),
            runs: roomba.runs.iter().map(RunJson::from).collect(),
            same: roomba.is_comparison().then_some(parting.is_none()),
            parting: parting.map(|parting| parting.to_string()),
        }
    }
}

impl From<&Run> for RunJson {
    fn from(run: &Run) -> RunJson {
        let next = run.frames.iter().skip(1).map(Some).chain([None]);
        let shown =
            run.frames.iter().zip(next).filter(|(frame, next)| {
                frame.tick.is_multiple_of(FRAME_TICKS) || next.is_none_or(|next| next.phase != frame.phase)
            });
        RunJson {
            controller: run.controller.name(),
            frames: shown.map(|(frame, _)| FrameJson::from(frame)).collect(),
            transitions: run.transitions.iter().map(TransitionJson::from).collect(),
            figures: FiguresJson::new(&run.figures, run.transitions.len()),
        }
    }
}

impl From<&Frame> for FrameJson {
    fn from(frame: &Frame) -> FrameJson {
        // Four decimals are a tenth of a millimetre. No drawing is finer.
        let short = |number: f64| (number * 10_000.0).round() / 10_000.0;
        let phase = Phase::ALL.iter().position(|phase| *phase == frame.phase).unwrap_or_default();
        FrameJson(
            short(frame.seconds()),
            short(frame.pose.x_m),
            short(frame.pose.y_m),
            short(frame.pose.theta),
            phase,
            frame.passed,
        )
    }
}

impl From<&Transition> for TransitionJson {
    fn from(change: &Transition) -> TransitionJson {
        TransitionJson { t: change.seconds(), from: change.from.name(), to: change.to.name(), angle_rad: change.angle }
    }
}

impl FiguresJson {
    fn new(figures: &Figures, transitions: usize) -> FiguresJson {
        FiguresJson {
            path_m: figures.path_m,
            bumps: figures.bumps,
            transitions,
            passed_squares: figures.passed,
            reachable_squares: figures.reachable,
            share: figures.share(),
            in_phase_s: figures.in_phase_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn both(seconds: u32) -> Roomba {
        Roomba::both(1, seconds).unwrap()
    }

    fn written(roomba: &Roomba) -> Value {
        serde_json::from_str(&roomba.json()).unwrap()
    }

    #[test]
    fn a_run_is_a_room_a_body_and_frames_with_their_phases() {
        let told = written(&both(4));
        assert_eq!(told["room"], json!({"lengthM": 6.4, "widthM": 4.8, "squareM": 0.05}));
        assert_eq!(told["robot"], json!({"radiusM": 0.17}));
        assert_eq!(told["phases"], json!(["MoveForward", "MoveInSpiral", "GoBack", "Rotate"]));
        let frames = &told["runs"][0]["frames"];
        assert_eq!(frames[0], json!([0.0, 3.2, 2.4, 0.0, 0, 32]));
        assert_eq!(frames[15], json!([1.0, 3.7, 2.4, 0.0, 0, 92]));
        assert_eq!(frames[46][4], 1, "after 3 s it spirals: {frames}");
        assert_eq!(
            told["runs"][0]["transitions"],
            json!([{"t": 3.0, "from": "MoveForward", "to": "MoveInSpiral", "angleRad": null}])
        );
    }

    #[test]
    fn one_run_alone_is_compared_with_nothing_and_two_with_one_another() {
        let mut both = both(60);
        let told = written(&both);
        assert_eq!((&told["same"], &told["parting"]), (&json!(true), &Value::Null));
        both.runs[1].transitions.truncate(2);
        let parted = written(&both);
        assert_eq!(parted["same"], false);
        assert!(parted["parting"].as_str().unwrap().starts_with("machine and tree differ after 2 transitions"), "{parted}");
        both.runs.truncate(1);
        assert_eq!(written(&both)["same"], Value::Null);
    }

    #[test]
    fn every_figure_is_said_of_every_run() {
        let rows = both(3).figures();
        assert!(rows.iter().all(|(_, values)| values.len() == 2));
        assert_eq!(rows[0], ("path", vec!["1.50 m".to_owned(); 2]));
        assert!(rows.contains(&("MoveForward", vec!["3.00 s".to_owned(); 2])), "{rows:?}");
    }

    #[test]
    fn every_end_of_a_phase_is_a_frame() {
        let both = both(120);
        let machine = &both.runs[0];
        let told = RunJson::from(machine);
        for change in &machine.transitions {
            let t = change.seconds();
            assert!(told.frames.iter().any(|frame| (frame.0 - t).abs() < 1e-4), "none at {t}");
        }
        assert!(told.frames.len() < machine.frames.len() / 3);
    }
}
