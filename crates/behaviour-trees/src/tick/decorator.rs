//! Nodes with one child, which is the next node in the row. Their time is the tree's own time: the sum of the times
//! passed to the tree's ticks.

use super::{Leaves, Node, Outcome, Status, TreeRun};

const NANOSECONDS_PER_MILLISECOND: u64 = 1_000_000;

impl<L: Leaves> TreeRun<'_, L> {
    pub(super) fn inverter(&mut self, at: usize) -> Outcome {
        self.live[at].status = Status::Running;
        let said = self.tick(at + 1)?;
        match said {
            Status::Success | Status::Failure => {
                self.reset(at + 1);
                Ok(if said == Status::Success { Status::Failure } else { Status::Success })
            }
            Status::Running | Status::Skipped => Ok(said),
            Status::Idle => self.unexpected(at, at + 1, said),
        }
    }

    pub(super) fn force(&mut self, at: usize, status: Status) -> Outcome {
        self.live[at].status = Status::Running;
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.reset(at + 1);
            return Ok(status);
        }
        Ok(said)
    }

    /// Ticks a RetryUntilSuccessful or a Repeat. The child is ticked again after it returned `retried`. If the child
    /// was not running before the tick, it is ticked only once in this tick, so that a tick always ends.
    pub(super) fn again(&mut self, at: usize, node: &Node, retried: Status) -> Outcome {
        let child = at + 1;
        let mut most = self.number(at, node, 0)?;
        self.live[at].status = Status::Running;
        while most == -1 || i64::from(self.live[at].count) < most {
            let was_idle = self.live[child].status == Status::Idle;
            let said = self.tick(child)?;
            match said {
                Status::Running => return Ok(Status::Running),
                // A skipped child neither counts as an attempt nor resets the count.
                Status::Skipped => {
                    self.reset(child);
                    return Ok(Status::Skipped);
                }
                Status::Idle => return self.unexpected(at, child, said),
                Status::Success | Status::Failure if said == retried => {
                    self.live[at].count = self.live[at].count.saturating_add(1);
                    if retried == Status::Failure {
                        // The child may have written the entry with the limit.
                        most = self.number(at, node, 0)?;
                    }
                    self.reset(child);
                    if was_idle && (most == -1 || i64::from(self.live[at].count) < most) {
                        return Ok(Status::Running);
                    }
                }
                Status::Success | Status::Failure => {
                    self.live[at].count = 0;
                    self.reset(child);
                    return Ok(said);
                }
            }
        }
        self.live[at].count = 0;
        Ok(retried)
    }

    /// Halts the child if it still runs after the time in the port, in milliseconds. 0 means no limit.
    pub(super) fn timeout(&mut self, at: usize, node: &Node) -> Outcome {
        let limit = self.milliseconds(at, node)?;
        let child = at + 1;
        let live = &mut self.live[at];
        if !live.has_begun {
            live.has_begun = true;
            live.is_spent = limit == 0;
            live.since = self.clock;
            live.status = Status::Running;
        }
        if !live.is_spent && self.clock.saturating_sub(live.since) >= limit {
            live.is_spent = true;
            if self.live[child].status == Status::Running {
                self.reset(child);
                self.live[at].has_begun = false;
                return Ok(Status::Failure);
            }
        }
        let said = self.tick(child)?;
        if said.is_completed() {
            self.live[at].has_begun = false;
            self.reset(child);
        }
        Ok(said)
    }

    pub(super) fn delay(&mut self, at: usize, node: &Node) -> Outcome {
        let wait = self.milliseconds(at, node)?;
        let live = &mut self.live[at];
        if !live.has_begun {
            live.has_begun = true;
            live.since = self.clock;
            live.status = Status::Running;
        }
        if self.clock.saturating_sub(live.since) < wait {
            return Ok(Status::Running);
        }
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.live[at].has_begun = false;
            self.reset(at + 1);
        }
        Ok(said)
    }

    /// Returns the milliseconds in the first port, converted to nanoseconds.
    pub(super) fn milliseconds(&mut self, at: usize, node: &Node) -> Result<u64, super::Faulted> {
        let milliseconds = self.number(at, node, 0)?;
        match u64::try_from(milliseconds) {
            Ok(milliseconds) => Ok(milliseconds.saturating_mul(NANOSECONDS_PER_MILLISECOND)),
            Err(_) => self.fault(at, format!("its port {} is {milliseconds}, less than 0", self.port_name(node, 0))),
        }
    }

    /// Ticks the child once. After a halt, the node still remembers that the child has run, and its result.
    pub(super) fn run_once(&mut self, at: usize, node: &Node) -> Outcome {
        let then_skip = self.port(node, 0).and_then(crate::value::Value::as_bool).unwrap_or(true);
        let live = &mut self.live[at];
        if live.has_begun {
            let before = if live.count == 0 { Status::Failure } else { Status::Success };
            return Ok(if then_skip { Status::Skipped } else { before });
        }
        live.status = Status::Running;
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.live[at].has_begun = true;
            self.live[at].count = u32::from(said == Status::Success);
            self.reset(at + 1);
        }
        Ok(said)
    }

    pub(super) fn keep_running(&mut self, at: usize) -> Outcome {
        self.live[at].status = Status::Running;
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.reset(at + 1);
        }
        Ok(if said == Status::Failure { Status::Failure } else { Status::Running })
    }

    pub(super) fn subtree(&mut self, at: usize) -> Outcome {
        if self.live[at].status == Status::Idle {
            self.live[at].status = Status::Running;
        }
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.reset(at + 1);
        }
        Ok(said)
    }

    /// Evaluates the script until it is true. After that, the script is evaluated again only when the child is done.
    pub(super) fn precondition(&mut self, at: usize) -> Outcome {
        if !self.live[at].has_begun {
            let script = self.script_of(at);
            if !self.holds(at, script)? {
                return Ok(self.otherwise(at).unwrap_or(Status::Failure));
            }
            self.live[at].has_begun = true;
        }
        let said = self.tick(at + 1)?;
        if said.is_completed() {
            self.reset(at + 1);
            self.live[at].has_begun = false;
        }
        Ok(said)
    }

    /// Returns the result of a `Precondition` or a loop that does not tick its child.
    pub(super) fn otherwise(&self, at: usize) -> Option<Status> {
        let number = u32::try_from(at).unwrap_or(u32::MAX);
        self.shape.otherwise.iter().find(|(node, _)| *node == number).map(|(_, status)| *status)
    }
}
