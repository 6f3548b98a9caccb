//! A run of the pallet scenario as JSON, for a page that plays the run: first the yard, then everything that changes.
//! Places of the yard are cells, and positions are in metres. Both are measured from the first robot's start, to the
//! east and to the south.

use schemars::JsonSchema;
use serde::Serialize;

use super::record::Frame;
use super::report::{ReportJson, short};
use super::shown::Pallet;
use super::yard::Yard;
use hallsweep_core::place::Place;
use hallsweep_core::units::Cell;
use hallsweep_sim::Truth;
use hallsweep_sim::pair::{ANGLE_LIMIT, FORCE_LIMIT_N, FORCE_N, GAP_LIMIT_M};

/// The whole run. The caller chooses in which form the actions of the trees are included.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletJson")]
pub struct PalletJson<Replay> {
    #[serde(flatten)]
    report: ReportJson,
    yard: YardJson,
    limits: LimitsJson,
    frames: Vec<FrameJson>,
    /// `[t, [[x, y], …]]`: from time `t` on, the cells of parcels that lie on the floor outside the target area.
    lying: Vec<(f64, Vec<Xy>)>,
    /// `trees`: the trees of SRM1, SRM2 and the Supervisor, tick by tick.
    #[serde(flatten)]
    replay: Replay,
}

/// `[column, row]`
type Xy = (i32, i32);

#[derive(Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
struct YardJson {
    /// Side of a cell, in metres.
    cell_m: f64,
    /// North-western and south-eastern cell of the floor. Everything outside is wall.
    least: Xy,
    most: Xy,
    /// Cells in which no robot can stand.
    walls: Vec<Xy>,
    /// Cells of the parcels at the beginning, in the order in which they are fetched.
    pallet: Vec<Xy>,
    target: Option<Xy>,
    /// Cells of SRM1 and SRM2 at the beginning.
    starts: Vec<Xy>,
}

/// Lowest and highest allowed value of each quantity that is measured on a held parcel.
#[derive(Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
struct LimitsJson {
    force_n: [f64; 2],
    angle_rad: [f64; 2],
    gap_m: [f64; 2],
}

/// `[t, SRM1, SRM2, load, held, delivered]`. `t` is in seconds; `SRM1` and `SRM2` are the bodies of the robots. While
/// a parcel is held, `load` is its `[x, y, height]`, with a height from 0 to 1, and `held` is `[force, angle, gap]`.
/// `delivered` is the number of parcels in the target area.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletFrame")]
struct FrameJson(f64, BodyJson, BodyJson, Option<[f64; 3]>, Option<[f64; 3]>, usize);

/// `[x, y, θ, closed]`: metres, metres, radians clockwise from the east, and whether the gripper is closed.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletBody")]
struct BodyJson(f64, f64, f64, bool);

const fn xy(cell: Cell) -> Xy {
    (cell.x, cell.y)
}

impl Pallet {
    pub fn json<Replay: Serialize>(&self, replay: Replay) -> String {
        serde_json::to_string(&PalletJson::new(self, replay)).expect("runs are finite numbers and words, which JSON can hold")
    }
}

impl<Replay> PalletJson<Replay> {
    fn new(pallet: &Pallet, replay: Replay) -> PalletJson<Replay> {
        let around = |wanted: f64, limit: f64| [wanted - limit, wanted + limit];
        PalletJson {
            report: ReportJson::new(&pallet.run, &pallet.figures, &pallet.faults),
            yard: YardJson::from(pallet.run.yard()),
            limits: LimitsJson {
                force_n: around(FORCE_N, FORCE_LIMIT_N),
                angle_rad: around(0.0, ANGLE_LIMIT),
                gap_m: around(0.0, GAP_LIMIT_M),
            },
            frames: pallet.frames.iter().map(FrameJson::from).collect(),
            lying: pallet
                .lying
                .iter()
                .map(|(at, cells)| (short(at.as_secs_f64()), cells.iter().copied().map(xy).collect()))
                .collect(),
            replay,
        }
    }
}

impl From<&Yard> for YardJson {
    fn from(yard: &Yard) -> YardJson {
        let bounds = yard.hall.bounds();
        let cells = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
        YardJson {
            cell_m: yard.hall.cell_m(),
            least: xy(bounds.least),
            most: xy(bounds.most),
            walls: cells.filter(|cell| yard.hall.truth(*cell) == Truth::Wall).map(xy).collect(),
            pallet: yard.parcels.iter().map(|(_, cell)| xy(*cell)).collect(),
            target: yard.target.cell().map(xy),
            starts: yard.starts.iter().map(|start| start.place).filter_map(Place::cell).map(xy).collect(),
        }
    }
}

impl From<&Frame> for FrameJson {
    fn from(frame: &Frame) -> FrameJson {
        let body = |index: usize| {
            let pose = frame.bodies[index];
            BodyJson(short(pose.x_m), short(pose.y_m), short(pose.theta), frame.closed[index])
        };
        let load = frame.load.map(|(x, y, height)| [x, y, height].map(short));
        FrameJson(short(frame.at.as_secs_f64()), body(0), body(1), load, frame.held.map(|held| held.map(short)), frame.delivered)
    }
}
