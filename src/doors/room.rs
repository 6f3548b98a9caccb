//! The share of its bounds that a door uses: all where the system allows enough file descriptors, and proportionally less where
//! it does not. So all doors together never need the last descriptor, and a crowd at one of them does not block the others
//! (safety S9). The bounds themselves are in each door.

/// Number of descriptors for the connections of all doors, including those that are closing: one each over HTTP, three each over
/// MQTT.
const PLACES: u64 = 2_600;

/// Number of further descriptors for the record, the ports, and the threads' event queues.
const BESIDE: u64 = 80;

/// Minimum of every bound.
const LEAST: usize = 4;

/// The descriptors available for connections.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    places: u64,
}

impl Room {
    /// The share on a system that allows this many descriptors.
    pub fn of(descriptors: u64) -> Room {
        Room { places: descriptors.saturating_sub(BESIDE).min(PLACES) }
    }

    /// The reduced value of a bound that is `all` with enough descriptors.
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
