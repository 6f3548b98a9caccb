//! The number of descriptors (open files) for the connections of all doors. If the system allows enough, all limits
//! apply in full. Otherwise all limits are scaled down in proportion. So the doors together never use the last
//! descriptor, and no crowd at one door blocks the others (safety S9).

/// Descriptors for all connections when every door is at its limit. Closing connections count too. An HTTP connection
/// needs one descriptor, an MQTT client three.
const CONNECTIONS: u64 = 2_600;

/// Descriptors for everything else: the journal, the listening ports, and the event queues of the threads.
const RESERVED: u64 = 80;

/// No limit is scaled down below this value.
const LEAST: usize = 4;

#[derive(Clone, Copy, Debug)]
pub struct ConnectionBudget {
    descriptors: u64,
}

impl ConnectionBudget {
    /// Returns the budget of a program that may open this many descriptors.
    pub fn of(descriptors: u64) -> ConnectionBudget {
        ConnectionBudget { descriptors: descriptors.saturating_sub(RESERVED).min(CONNECTIONS) }
    }

    /// Scales a limit down; `all` is the limit in a full budget. A limit of at most `LEAST` stays as it is.
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
