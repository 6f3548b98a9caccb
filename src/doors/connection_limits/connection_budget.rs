//! The budget of descriptors for the connections of all doors: their limits hold as they are where the system allows enough open files,
//! and are smaller in proportion where it does not. So the doors together never need the last descriptor, and no crowd at one of them
//! keeps the others closed (safety S9).

/// Descriptors for all connections of all doors at their limits, closing ones included: over HTTP one each, over MQTT three.
const CONNECTIONS: u64 = 2_600;

/// Descriptors for everything else: the record, the ports, and what the threads wait with.
const RESERVED: u64 = 80;

/// No limit is scaled down below this.
const LEAST: usize = 4;

/// Descriptors that connections may take.
#[derive(Clone, Copy, Debug)]
pub struct ConnectionBudget {
    descriptors: u64,
}

impl ConnectionBudget {
    /// The budget of a program that may have this many descriptors open.
    pub fn of(descriptors: u64) -> ConnectionBudget {
        ConnectionBudget { descriptors: descriptors.saturating_sub(RESERVED).min(CONNECTIONS) }
    }

    /// A limit of `all` in a full budget, scaled down to this one.
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
