//! How much of its bounds a door keeps to: all, where the system lets the program have enough files and connections open at once, and
//! in proportion less where it does not. So the doors together never need the last descriptor, and no crowd at one of them keeps the
//! others closed (safety S9). What is bounded is each door's own matter.

/// As many descriptors as all places of all doors need, with clients on their way out: over HTTP one each, over MQTT three.
const PLACES: u64 = 2_600;

/// The record, the ports, and what the threads wait with, need so many beside them.
const BESIDE: u64 = 80;

/// Of nothing there is less than this.
const LEAST: usize = 4;

/// How much there is for the places of all doors.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    places: u64,
}

impl Room {
    /// Where the program may have so many files and connections open.
    pub fn of(descriptors: u64) -> Room {
        Room { places: descriptors.saturating_sub(BESIDE).min(PLACES) }
    }

    /// What there is of something of which there are so many where there is room for all.
    pub fn part(self, all: usize) -> usize {
        let part = usize::try_from(all as u64 * self.places / PLACES).unwrap_or(all);
        part.max(LEAST.min(all))
    }
}

impl Default for Room {
    fn default() -> Room {
        Room { places: PLACES }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S9.
    #[test]
    fn with_few_descriptors_there_is_less_of_everything_and_of_nothing_none() {
        for enough in [Room::default(), Room::of(4096), Room::of(u64::MAX)] {
            assert_eq!([1, 32, 640].map(|all| enough.part(all)), [1, 32, 640]);
        }
        assert_eq!([1, 32, 640].map(|all| Room::of(80 + 1_300).part(all)), [1, 16, 320]);
        assert_eq!([1, 32, 640].map(|all| Room::of(10).part(all)), [1, 4, 4]);
    }
}
