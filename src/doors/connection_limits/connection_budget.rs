//! The budget of descriptors for the connections of all doors. Where the system allows enough open files, the limits hold in
//! full; otherwise they are scaled down in proportion. So the doors together never need the last descriptor, and no crowd at
//! one door keeps the others closed (safety S9).

/// Descriptors for all connections, closing ones included, when every door is at its limit: one per HTTP connection, three per
/// MQTT client.
const CONNECTIONS: u64 = 2_600;

/// Descriptors for everything else: the journal, the listening ports, and the pollers of the threads.
const RESERVED: u64 = 80;

/// Smallest value to which a limit is scaled down.
const LEAST: usize = 4;

#[derive(Clone, Copy, Debug)]
pub struct ConnectionBudget {
    descriptors: u64,
}

impl ConnectionBudget {
    /// The budget of a program that may have this many open descriptors.
    pub fn of(descriptors: u64) -> ConnectionBudget {
        ConnectionBudget { descriptors: descriptors.saturating_sub(RESERVED).min(CONNECTIONS) }
    }

    /// `all` is the limit in a full budget. A limit of at most `LEAST` is not scaled down.
    pub fn scaled(self, all: usize) -> usize {
        let part = usize::try_from(all as u64 * self.descriptors / CONNECTIONS).unwrap_or(all);
        part.max(LEAST.min(all))
    }
}

impl Default for ConnectionBudget {
    fn default() -> ConnectionBudget {
        ConnectionBudget { descriptors: CONNECTIONS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S9.
    #[test]
    fn with_few_descriptors_there_is_less_of_everything_and_of_nothing_none() {
        for enough in [ConnectionBudget::default(), ConnectionBudget::of(4096), ConnectionBudget::of(u64::MAX)] {
            assert_eq!([1, 32, 640].map(|all| enough.scaled(all)), [1, 32, 640]);
        }
        assert_eq!([1, 32, 640].map(|all| ConnectionBudget::of(80 + 1_300).scaled(all)), [1, 16, 320]);
        assert_eq!([1, 32, 640].map(|all| ConnectionBudget::of(10).scaled(all)), [1, 4, 4]);
    }
}
