//! What the simulated robot perceives with its sonar, camera and thermometer, including noise and errors. The exact
//! geometry is in `sonar` and `recognise`.

use std::sync::Arc;
use std::time::Duration;

use super::curve;
use super::drive::BodyPose;
use super::hall::{Hall, Truth};
use super::settings::SimSettings;
use super::{misses, recognise, sonar};
use hallsweep_core::event::{Ahead, Obstacle, RobotEvent};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::Pose;

/// Sonar and camera. Each has its own random stream.
#[derive(Debug)]
pub(super) struct Senses {
    hall: Arc<Hall>,
    sonar: RandomStream,
    sonar_noise_cm: f64,
    sonar_cells: u8,
    camera: RandomStream,
    unknown_rate: f64,
    /// The seed of what the camera misses. `None` if it misses nothing.
    misses: Option<u64>,
    reported: Option<Option<u16>>,
}

impl Senses {
    pub(super) fn new(hall: Arc<Hall>, settings: &SimSettings) -> Senses {
        Senses {
            hall,
            sonar: RandomStream::new(settings.seed, "sonar"),
            sonar_noise_cm: settings.sonar_noise_cm,
            sonar_cells: settings.sonar_cells,
            camera: RandomStream::new(settings.seed, "camera"),
            unknown_rate: settings.unknown_rate,
            misses: settings.camera_misses.then_some(settings.seed),
            reported: None,
        }
    }

    pub(super) fn look_into(&mut self, hall: Arc<Hall>) {
        self.hall = hall;
    }

    /// Takes a reading of the sonar, and reports it even if it is unchanged.
    pub(super) fn listen(&mut self, body: BodyPose) -> RobotEvent {
        let reading = self.read_sonar(body);
        self.reported = Some(reading);
        RobotEvent::Sonar(reading)
    }

    /// Takes a reading of the sonar, and reports it only if it differs from the last report.
    pub(super) fn listen_for_change(&mut self, body: BodyPose) -> Option<RobotEvent> {
        let before = self.reported;
        let reading = self.listen(body);
        (self.reported != before).then_some(reading)
    }

    /// Reports which cells ahead are free according to the last reading. The robot must stand exactly in `pose`. The
    /// obstacle behind the free cells is reported only if the camera sees it too.
    pub(super) fn look_ahead(&mut self, pose: Pose) -> Option<RobotEvent> {
        let cells = u16::from(self.sonar_cells);
        let (reading, cell_m) = (self.reported.flatten(), self.hall.cell_m());
        let free = reading.map_or(sonar::cells_in_range(cell_m), |cm| sonar::free_cells(cm, cell_m)).min(cells);
        let is_free = |away: u16| self.hall.truth(pose.cell.onward(pose.heading, away)) == Truth::Free;
        let before = Pose { cell: pose.cell.onward(pose.heading, free), ..pose };
        let is_there = reading.is_some() && free < cells && (1..=free).all(is_free) && !is_free(free + 1);
        let obstacle = is_there.then(|| self.recognise(pose, before));
        (cells > 0).then_some(RobotEvent::Ahead(Ahead { free, obstacle }))
    }

    /// Recognises the obstacle ahead of `before`, which is `pose` or a free cell ahead of it. The robot is in `pose`.
    pub(super) fn recognise(&mut self, pose: Pose, before: Pose) -> Obstacle {
        let mut obstacle = recognise::obstacle_ahead(&self.hall, before);
        if let (Obstacle::Luggage(piece), Some(seed)) = (obstacle, self.misses)
            && let Some(bag) = self.hall.bag(piece)
            && !misses::recognises(&self.hall, seed, bag, before.ahead(), pose)
        {
            obstacle = Obstacle::Wall { left: 0, right: 0 };
        }
        if self.camera.happens(self.unknown_rate) { Obstacle::Unknown } else { obstacle }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the distance is clamped to the sonar's range")]
    fn read_sonar(&mut self, body: BodyPose) -> Option<u16> {
        let noise = self.sonar.normal(self.sonar_noise_cm);
        let exact = sonar::distance_cm(&self.hall, body)?;
        Some((exact + noise).clamp(0.0, sonar::RANGE_M * 100.0).round() as u16)
    }
}

/// The hall's thermometer. It reports each change of the temperature, rounded to a tenth of a degree, at most once a
/// second.
#[derive(Debug)]
pub(super) struct Thermometer {
    hall: Arc<Hall>,
    /// Age of the hall when the run began. The temperature curve continues over all runs.
    before: Duration,
    /// The next report, in whole seconds of the hall's age.
    next: Option<u64>,
}

impl Thermometer {
    /// A thermometer in a hall of this age. It reports at once.
    pub(super) fn new(hall: Arc<Hall>, before: Duration) -> Thermometer {
        let next = hall.curve().map(|_| before.as_secs());
        Thermometer { hall, before, next }
    }

    /// When the next report is due, counted from the start of the run.
    pub(super) fn next(&self) -> Option<Duration> {
        self.next.map(|second| Duration::from_secs(second).saturating_sub(self.before))
    }

    /// Skips the reports that were due while the thermometer was missing, up to this age of the hall.
    pub(super) fn come_back(&mut self, age: Duration) {
        self.next = self.next.map(|second| second.max(age.as_secs()));
    }

    /// Makes the report that is due now, and plans the next one.
    pub(super) fn read(&mut self) -> Option<RobotEvent> {
        let second = self.next.take()?;
        let curve = self.hall.curve()?;
        let reading = curve.at(Duration::from_secs(second));
        self.next = curve.next_change(second, curve::tenths(reading));
        Some(RobotEvent::Temperature(reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Camera;
    use hallsweep_core::units::{Cell, Heading, Piece};

    const EAST: Pose = Pose { cell: Cell::HOME, heading: Heading::East };

    fn looks(hall: Hall, settings: SimSettings) -> Ahead {
        let hall = Arc::new(hall);
        let mut senses = Senses::new(Arc::clone(&hall), &settings);
        let _reading = senses.listen(BodyPose::centred(EAST, hall.cell_m()));
        match senses.look_ahead(EAST) {
            Some(RobotEvent::Ahead(ahead)) => ahead,
            other => panic!("it has a sonar: {other:?}"),
        }
    }

    fn with_sonar(seed: u64) -> SimSettings {
        SimSettings { sonar_cells: 7, ..SimSettings::new(seed, Camera::Stub) }
    }

    #[test]
    fn luggage_is_recognised_as_far_as_the_sonar_sees() {
        let hall = Hall::from_rows("test", &["S...a"]).unwrap();
        assert_eq!(looks(hall, with_sonar(1)), Ahead { free: 3, obstacle: Some(Obstacle::Luggage(Piece(1))) });
    }

    /// Seven cells of five metres are out of the sonar's range.
    #[test]
    fn nothing_is_said_of_cells_beyond_the_range() {
        let hall = Hall::from_rows("test", &["S.#.."]).unwrap().measured(5.0, None);
        assert_eq!(looks(hall, with_sonar(1)), Ahead { free: 0, obstacle: None });
    }

    #[test]
    fn nothing_is_recognised_through_a_wall_however_wrong_the_reading_is() {
        for seed in 0..200 {
            let hall = Hall::from_rows("test", &["S.#a..#"]).unwrap();
            let seen = looks(hall, SimSettings { sonar_noise_cm: 40.0, ..with_sonar(seed) });
            assert!(!matches!(seen.obstacle, Some(Obstacle::Luggage(_))), "seed {seed}: {seen:?}");
        }
    }
}
