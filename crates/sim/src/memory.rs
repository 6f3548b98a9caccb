//! The state that remains after the program has died, as with a real robot and hall: the robot's place, its motion,
//! the age of the hall. The program that runs the robot stores this state, and `simulator::recall` continues from it.
//!
//! ```text
//!            pose: the cell and heading of the last completed order
//!              │         stands: ahead of it, or turned away from it, never both
//!        ┌─────┴─────┬───┼───────┐
//!        │     +     │   o──►    │   motion: where it ends, and the time left
//!        └───────────┴───────────┘
//! ```
//! Lengths are whole micrometres and angles are whole microradians. So values are the same after writing and reading.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use std::time::Duration;

use super::drive::{BodyPose, normal};
use super::hall::{Hall, Truth};
use super::sonar::way_to_contact;
use hallsweep_core::place::Place;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Piece, Pose};

/// Longest time from the death of the program to the robot's own halt, in simulated time (safety S5).
const WATCHDOG: Duration = Duration::from_millis(500);

/// Largest rounding error of micrometres and microradians.
const ROUNDING: i64 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimMemory {
    /// The cell and heading of the robot after its last completed order.
    pub pose: Pose,
    /// Number of steps from home to a robot that stands outside, before the entrance. 0 if the robot is in the hall.
    pub outside: u8,
    pub stands: Astray,
    pub taken: Taken,
    pub motion: Option<Underway>,
    /// How long the hall has existed, over all runs. The temperature depends on this age.
    pub age: Duration,
    /// Number of times that the robot continued after the program had ended. After each restart, the sensors use new
    /// random numbers.
    pub restarts: u32,
}

/// The pieces that a robot has taken with its hook. They no longer stand in the hall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Taken {
    /// The piece that the robot carries on its back.
    pub carried: Option<Piece>,
    /// One bit for each piece, at the position of its number. The bit is set if the piece is in the container.
    pub container: [u64; Taken::WORDS],
}

impl Taken {
    pub const NONE: Taken = Taken { carried: None, container: [0; Taken::WORDS] };

    pub(crate) const WORDS: usize = 16;

    /// Whether there is a bit for this piece. A hall can have more pieces than there are bits.
    #[must_use]
    pub const fn has_room_for(piece: Piece) -> bool {
        (piece.0 as usize) < 64 * Taken::WORDS
    }

    pub fn let_go(&mut self) -> Option<Piece> {
        let piece = self.carried.take().filter(|piece| Taken::has_room_for(*piece))?;
        self.container[piece.0 as usize / 64] |= 1 << (piece.0 % 64);
        Some(piece)
    }

    /// The pieces in the container, sorted by their numbers.
    pub fn in_container(&self) -> impl Iterator<Item = Piece> {
        let words = (0..).zip(self.container);
        words.flat_map(|(word, bits)| (0..64).filter(move |bit| bits & (1 << bit) != 0).map(move |bit| Piece(word * 64 + bit)))
    }

    /// The pieces that no longer stand in the hall: the carried piece and those in the container.
    pub fn gone(&self) -> impl Iterator<Item = Piece> {
        self.carried.into_iter().chain(self.in_container())
    }
}

/// How far the body is from the centre of its cell, or from its heading. At least one of the two is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Astray {
    /// Micrometres ahead of the centre. Negative if behind it.
    pub ahead_um: i64,
    /// Angle away from the heading, in microradians. Positive is clockwise.
    pub turned_urad: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Underway {
    pub to: Astray,
    /// Simulated time until the motion would end.
    pub left: Duration,
}

impl SimMemory {
    /// The memory of a new robot that stands at home in a hall of age 0.
    pub const NEW: SimMemory = SimMemory {
        pose: Pose::START,
        outside: 0,
        stands: Astray { ahead_um: 0, turned_urad: 0 },
        taken: Taken::NONE,
        motion: None,
        age: Duration::ZERO,
        restarts: 0,
    };

    /// The state after the program has died and the robot has stopped. Nobody knows when the wheels stopped, so the
    /// time is drawn from the seed. It is at most `WATCHDOG` after the last known moment, and not after the end of
    /// the motion.
    pub fn at_rest(self, seed: u64) -> SimMemory {
        let restarts = self.restarts.wrapping_add(1);
        let stands = self.motion.map_or(self.stands, |motion| {
            let rolls = motion.left.min(WATCHDOG).mul_f64(RandomStream::new(reseeded(seed, restarts), "watchdog").fraction());
            let share = if motion.left.is_zero() { 1.0 } else { rolls.as_secs_f64() / motion.left.as_secs_f64() };
            self.stands.towards(motion.to, share)
        });
        SimMemory { stands, motion: None, restarts, ..self }
    }

    /// Where the body is. `cell_m` is the side of a cell in metres.
    pub fn body(&self, cell_m: f64) -> BodyPose {
        self.stands.from(centre_of(self.pose, self.outside, cell_m))
    }

    /// Whether this state is possible in the given hall. The robot must be on free floor, and not further off the
    /// centre than obstacles allow.
    pub fn fits(&self, hall: &Hall) -> bool {
        let hall = &hall.rearranged(&self.taken.gone().map(|piece| (piece, None)).collect());
        let stands = match self.outside {
            0 => hall.truth(self.pose.cell) == Truth::Free,
            steps => steps <= Place::FURTHEST && self.pose == Pose::START,
        };
        let moving = self.motion.is_none_or(|motion| self.reaches(motion.to, hall));
        stands && self.reaches(self.stands, hall) && moving
    }

    /// Whether a body can be this far off the centre and heading of `pose`.
    fn reaches(&self, astray: Astray, hall: &Hall) -> bool {
        let backs = astray.ahead_um < 0;
        let heading = if backs { self.pose.heading.opposite() } else { self.pose.heading };
        // The entrance is behind a robot that stands at home before a mission. Halfway through the entrance, the
        // robot already counts as outside.
        let way = if self.outside > 0 || backs && self.pose == Pose::START {
            1.0
        } else {
            way_to_contact(hall.truth(self.pose.cell.ahead(heading))).unwrap_or(1.0)
        };
        let way = way * hall.cell_m();
        let ahead = astray.ahead_um.unsigned_abs() <= (micro(way) + ROUNDING).unsigned_abs();
        let turned = astray.turned_urad.unsigned_abs() <= (micro(FRAC_PI_2) + ROUNDING).unsigned_abs();
        ahead && turned && (astray.ahead_um == 0 || astray.turned_urad == 0)
    }
}

impl Astray {
    pub fn between(centre: BodyPose, body: BodyPose) -> Astray {
        let turned_urad = micro(normal(body.theta - centre.theta));
        if turned_urad != 0 {
            return Astray { ahead_um: 0, turned_urad };
        }
        let (dx, dy) = centre.ahead();
        Astray { ahead_um: micro((body.x_m - centre.x_m) * dx + (body.y_m - centre.y_m) * dy), turned_urad }
    }

    fn from(self, centre: BodyPose) -> BodyPose {
        let (dx, dy) = centre.ahead();
        let ahead_m = whole(self.ahead_um);
        let theta = normal(centre.theta + whole(self.turned_urad));
        BodyPose { x_m: centre.x_m + ahead_m * dx, y_m: centre.y_m + ahead_m * dy, theta }
    }

    /// The point that is reached on the way to `end` after this share (0–1) of the motion's time. The speed is
    /// constant.
    #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "both ends are within a cell and a turn")]
    fn towards(self, end: Astray, share: f64) -> Astray {
        let between = |from: i64, to: i64| from + ((to - from) as f64 * share) as i64;
        Astray { ahead_um: between(self.ahead_um, end.ahead_um), turned_urad: between(self.turned_urad, end.turned_urad) }
    }
}

pub(crate) fn without(hall: &Arc<Hall>, taken: Taken) -> Arc<Hall> {
    match taken {
        Taken::NONE => Arc::clone(hall),
        taken => Arc::new(hall.rearranged(&taken.gone().map(|piece| (piece, None)).collect())),
    }
}

/// The seed of the noise after `restarts` restarts. Before the first restart, it is the user's own seed.
pub(crate) fn reseeded(seed: u64, restarts: u32) -> u64 {
    // The golden ratio's bits make the results very different even for neighbouring counts and seeds.
    seed ^ u64::from(restarts).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

#[expect(clippy::cast_possible_truncation, reason = "a body is at most a cell astray, and half a turn")]
pub(crate) fn micro(metres_or_radians: f64) -> i64 {
    (metres_or_radians * 1e6).round() as i64
}

#[expect(clippy::cast_precision_loss, reason = "it is at most a few million")]
pub(crate) fn whole(micro: i64) -> f64 {
    micro as f64 / 1e6
}

/// Where the body stands when it is exactly at its place. The way out is drawn to the north of home, where the halls
/// of the original specification have nothing.
pub(crate) fn centre_of(pose: Pose, outside: u8, cell_m: f64) -> BodyPose {
    let cell = Cell::new(pose.cell.x, pose.cell.y - i32::from(outside));
    BodyPose::centred(Pose { cell, ..pose }, cell_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Cell, Heading};

    const fn ahead(ahead_um: i64) -> Astray {
        Astray { ahead_um, turned_urad: 0 }
    }

    const fn turned(turned_urad: i64) -> Astray {
        Astray { ahead_um: 0, turned_urad }
    }

    fn standing(stands: Astray) -> SimMemory {
        SimMemory { stands, ..SimMemory::NEW }
    }

    fn moving(to: Astray, left_ms: u64) -> SimMemory {
        SimMemory { motion: Some(Underway { to, left: Duration::from_millis(left_ms) }), ..SimMemory::NEW }
    }

    #[test]
    fn how_far_astray_a_body_is_can_be_read_off_it() {
        for heading in Heading::ALL {
            let centre = BodyPose::centred(Pose { cell: Cell::new(-3, 7), heading }, 0.5);
            for astray in [ahead(0), ahead(123_456), ahead(-500_000), turned(1), turned(-1_570_796)] {
                assert_eq!(Astray::between(centre, astray.from(centre)), astray, "{heading:?}");
            }
            assert_eq!(ahead(0).from(centre), centre, "to the last bit");
            assert!(ahead(250_000).from(centre).theta.total_cmp(&centre.theta).is_eq(), "to the last bit");
        }
    }

    /// Tests safety S5 (docs/safety.md).
    #[test]
    fn a_robot_whose_program_has_died_rolls_no_further_than_its_motion_and_no_longer_than_half_a_second() {
        let places: Vec<i64> = (0..200).map(|seed| moving(ahead(500_000), 330).at_rest(seed).stands.ahead_um).collect();
        assert!(places.iter().all(|place| (0..=500_000).contains(place)));
        assert!(places.iter().any(|place| *place < 50_000) && places.iter().any(|place| *place > 450_000), "anywhere between");
        for seed in 0..200 {
            let slow = moving(turned(1_000_000), 5000).at_rest(seed);
            assert!((0..=100_000).contains(&slow.stands.turned_urad) && slow.motion.is_none(), "a tenth of the turn: {slow:?}");
        }
    }

    #[test]
    fn what_was_let_go_is_in_the_container_and_stands_nowhere() {
        let mut taken = Taken { carried: Some(Piece(70)), ..Taken::NONE };
        assert_eq!(taken.gone().collect::<Vec<_>>(), [Piece(70)]);
        assert_eq!((taken.let_go(), taken.carried), (Some(Piece(70)), None));
        taken.carried = Some(Piece(1));
        assert_eq!(taken.gone().collect::<Vec<_>>(), [Piece(1), Piece(70)]);
        assert!(Taken::has_room_for(Piece(1023)) && !Taken::has_room_for(Piece(1024)));
    }

    #[test]
    fn each_restart_is_counted_and_draws_anew() {
        let once = moving(ahead(500_000), 330).at_rest(7);
        let twice = SimMemory { motion: moving(ahead(500_000), 330).motion, stands: ahead(0), ..once }.at_rest(7);
        assert_eq!((once.restarts, twice.restarts), (1, 2));
        assert_ne!(once.stands, twice.stands);
        assert_eq!(reseeded(7, 0), 7);
    }

    #[test]
    fn a_robot_in_a_wall_or_too_far_astray_fits_no_hall() {
        let hall = Hall::from_rows("test", &["S.", "a#"]).unwrap();
        // The entrance is behind the robot, so it may stand up to a cell behind the centre.
        for fits in [ahead(0), ahead(100_000), ahead(-500_000), turned(1_570_796), turned(-1_570_796)] {
            assert!(standing(fits).fits(&hall), "{fits:?}");
            assert!(moving(fits, 100).fits(&hall), "{fits:?}");
        }
        for wrong in [ahead(100_010), ahead(-500_010), turned(1_600_000), ahead(i64::MIN), turned(i64::MAX)] {
            assert!(!standing(wrong).fits(&hall), "{wrong:?}");
            assert!(!moving(wrong, 100).fits(&hall), "{wrong:?}");
        }
        assert!(!standing(Astray { ahead_um: 10, turned_urad: 10 }).fits(&hall), "both at once");
        let west = |ahead_um| SimMemory { pose: Pose { cell: Cell::HOME, heading: Heading::East }, ..standing(ahead(ahead_um)) };
        assert!(west(-40_000).fits(&hall) && !west(-40_010).fits(&hall), "to the west is a wall");
        let outside = |steps, ahead_um| SimMemory { outside: steps, ..standing(ahead(ahead_um)) };
        assert!(outside(1, 500_000).fits(&hall) && outside(Place::FURTHEST, -500_000).fits(&hall), "out there is nothing");
        assert!(!outside(1, 500_010).fits(&hall) && !outside(Place::FURTHEST + 1, 0).fits(&hall));
        for cell in [Cell::new(1, 1), Cell::new(0, 1), Cell::new(i32::MAX, i32::MIN)] {
            let there = SimMemory { pose: Pose { cell, heading: Heading::South }, ..SimMemory::NEW };
            assert!(!there.fits(&hall), "{cell}");
        }
    }
}
