//! A finished run, with the frames for a drawing of it and the final state of its trees.

use std::time::Duration;

use super::drawing::drawing;
use super::mishap::{AskedFault, Missed, missed};
use super::record::{Entry, Figures, Frame, PalletFault};
use super::run::{Asked, PalletRun};
use super::yard::ParcelsError;
use behaviour_trees::{TickLog, Tree};
use hallsweep_core::snapshot::retrieval::TreesView;
use hallsweep_core::units::Cell;

/// Interval of the frames. It is so short that a straight line between two frames does not visibly cut corners.
const FRAME_EVERY: Duration = Duration::from_millis(200);

#[derive(Debug)]
pub struct Pallet {
    pub(super) run: PalletRun,
    pub(super) faults: Vec<AskedFault>,
    pub(super) figures: Figures,
    /// The frames of the whole run. Of several equal frames in a row, only the first and the last are stored.
    pub(super) frames: Vec<Frame>,
    /// The cells of the parcels on the floor, with the time: at the start and after each change.
    pub(super) lying: Vec<(Duration, Vec<Cell>)>,
}

impl Pallet {
    /// Runs the scenario to its end. `asked` must be made from `faults`.
    ///
    /// # Errors
    /// If `parcels` is 0 or more than fit on the pallet.
    pub fn new(parcels: u32, seed: u64, faults: Vec<AskedFault>, asked: Asked) -> Result<Pallet, ParcelsError> {
        let mut run = PalletRun::new(parcels, seed, asked)?;
        let (mut frames, mut lying) = (vec![run.frame()], vec![(Duration::ZERO, run.parcels())]);
        while !run.has_ended() {
            let count = u32::try_from(run.time().as_millis() / FRAME_EVERY.as_millis()).unwrap_or(u32::MAX);
            let (due, told) = (FRAME_EVERY * (count + 1), run.entries().len());
            // There is a frame for each event, so that the drawing agrees with the report.
            while run.time() < due && run.entries().len() == told && run.advance(|_| {}) {}
            keep(&mut frames, run.frame());
            let lie = run.parcels();
            if lying.last().is_none_or(|(_, last)| *last != lie) {
                lying.push((run.time(), lie));
            }
        }
        let figures = run.figures();
        Ok(Pallet { run, faults, figures, frames, lying })
    }

    pub fn drawing(&self, title: &str) -> String {
        drawing(&self.run, title)
    }

    pub fn entries(&self) -> &[Entry] {
        self.run.entries()
    }

    pub const fn figures(&self) -> &Figures {
        &self.figures
    }

    pub const fn fault(&self) -> Option<PalletFault> {
        self.figures.fault
    }

    pub fn missed(&self) -> Vec<(AskedFault, Missed)> {
        missed(&self.faults, &self.run)
    }

    /// Columns and rows of the drawn yard. Half a cell of the wall is added on each side.
    pub fn size(&self) -> (i32, i32) {
        let bounds = self.run.yard().hall.bounds();
        (bounds.width() + 1, bounds.height() + 1)
    }

    pub fn trees(&self) -> TreesView {
        let team = self.run.team();
        let mut trees = TreesView::of(team.trees(), team.blackboard());
        trees.blackboard.sort();
        trees
    }

    pub fn logs(&self) -> impl Iterator<Item = (&Tree, &TickLog)> {
        self.run.team().trees().iter().zip(self.run.logs())
    }
}

/// Adds a frame. If the last two frames equal the new frame except for their times, the last one is replaced.
fn keep(frames: &mut Vec<Frame>, frame: Frame) {
    let is_same = |other: &Frame| Frame { at: frame.at, ..other.clone() } == frame;
    if let [.., before, last] = frames.as_slice()
        && is_same(before)
        && is_same(last)
    {
        frames.pop();
    }
    frames.push(frame);
}

#[cfg(test)]
mod tests {
    use super::super::drawing::TITLE;
    use super::super::mishap::{Mishap, asked};
    use super::super::record::News;
    use super::*;
    use serde_json::{Value, json};

    fn ran(parcels: u32, faults: &[AskedFault]) -> Pallet {
        Pallet::new(parcels, 1, faults.to_vec(), asked(parcels, faults).unwrap()).unwrap()
    }

    fn told(pallet: &Pallet) -> Value {
        serde_json::from_str(&pallet.json(())).unwrap()
    }

    #[test]
    fn a_run_is_a_yard_frames_and_events_and_ends_with_all_parcels_in_the_target_area() {
        let told = told(&ran(2, &[]));
        let (yard, frames) = (&told["yard"], told["frames"].as_array().unwrap());
        assert_eq!((yard["pallet"].as_array().map(Vec::len), &yard["starts"]), (Some(2), &json!([[0, 0], [0, 1]])));
        assert_eq!(frames[0], json!([0.0, [0.0, 0.0, 0.0, false], [0.0, yard["cellM"], 0.0, false], null, null, 0]));
        let last = frames.last().unwrap();
        assert_eq!((&last[0], &last[5]), (&told["seconds"], &json!(2)));
        assert!(frames.iter().any(|frame| frame[3][2] == 1.0 && frame[4][0].as_f64().unwrap() > 50.0), "one is lifted and held");
        assert_eq!(told["lying"].as_array().unwrap().last().unwrap()[1], json!([]));
        assert_eq!((&told["figures"]["delivered"], &told["fault"]), (&json!(2), &Value::Null));
        let phases: Vec<u64> = told["events"].as_array().unwrap().iter().filter_map(|event| event["phase"].as_u64()).collect();
        assert_eq!(phases, [1, 2, 3, 4, 5, 6, 7, 8, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn frames_come_twice_a_second_as_long_as_anything_moves() {
        for pallet in [ran(2, &[]), ran(1, &[Mishap::Lost.at(1), Mishap::Absent.at(1)])] {
            for pair in pallet.frames.windows(2) {
                let still = Frame { at: pair[1].at, ..pair[0].clone() } == pair[1];
                let between = pair[1].at - pair[0].at;
                assert!(still || between <= Duration::from_millis(500), "{between:?} before {:?}", pair[1]);
            }
            assert!(pallet.frames.len() < 1000, "ten minutes of waiting are two frames");
        }
    }

    #[test]
    fn at_the_time_of_an_event_the_picture_shows_what_is_told() {
        let pallet = ran(1, &[Mishap::Lost.at(1)]);
        let lost = pallet.run.entries().iter().find(|entry| entry.news == News::Lost).unwrap();
        let shown = pallet.frames.iter().rfind(|frame| frame.at <= lost.at).unwrap();
        assert_eq!((shown.at, shown.load, shown.held), (lost.at, None, None));
    }

    #[test]
    fn a_lost_parcel_lies_where_it_fell_until_it_is_picked_up_there() {
        let pallet = ran(1, &[Mishap::Lost.at(1)]);
        let lay: Vec<usize> = pallet.lying.iter().map(|(_, cells)| cells.len()).collect();
        assert_eq!(lay, [1, 0, 1, 0], "{:?}", pallet.lying);
        assert_ne!(pallet.lying[0].1, pallet.lying[2].1);
        let told = told(&pallet);
        assert_eq!(told["faults"], json!(["lost@1"]));
        let kinds: Vec<&str> = told["events"].as_array().unwrap().iter().filter_map(|event| event["kind"].as_str()).collect();
        assert!(kinds.windows(4).any(|kinds| kinds == ["lost", "alarm", "acknowledged", "start"]), "{kinds:?}");
    }

    #[test]
    fn a_run_that_does_not_end_well_says_why() {
        let told = told(&ran(1, &[Mishap::Blocked.at(1)]));
        assert_eq!((&told["fault"]["name"], &told["figures"]["delivered"]), (&json!("noWayToTarget"), &json!(0)));
        assert!(told["fault"]["words"].as_str().unwrap().starts_with("the pair finds no way"), "{}", told["fault"]);
    }

    #[test]
    fn the_picture_shows_the_yard_and_three_ways() {
        let drawing = ran(1, &[]).drawing(TITLE);
        assert!(drawing.starts_with("<svg xmlns=") && drawing.trim_end().ends_with("</svg>"));
        assert_eq!(drawing.matches("<polyline").count(), 3, "SRM1, SRM2 and the parcel");
    }
}
