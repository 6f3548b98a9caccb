//! Nodes with several children. The rules follow the source code of BehaviorTree.CPP 4, including when nodes are
//! reset. Comments mark surprising rules.

use super::{Faulted, Leaves, Node, Outcome, Status, TreeRun, children};
use crate::tree::Shape;
use crate::value::Value;

impl<'a, L: Leaves> TreeRun<'a, L> {
    /// Ticks a Sequence or a Fallback. `end` is the status of a child that ends the node. An asynchronous node
    /// returns RUNNING after each child that was not running before.
    pub(super) fn in_order(&mut self, at: usize, node: &Node, end: Status, is_async: bool) -> Outcome {
        let shape: &'a Shape = self.shape;
        let first = at + 1;
        self.begin(at);
        let mut child = match self.live[at].cursor {
            0 => first,
            cursor => cursor as usize,
        };
        while child < node.end as usize {
            let was_idle = self.live[child].status == Status::Idle;
            let said = self.tick(child)?;
            let next = shape.nodes[child].end;
            match said {
                Status::Running => {
                    self.live[at].cursor = place(child);
                    return Ok(Status::Running);
                }
                Status::Skipped => self.live[at].count += 1,
                Status::Idle => return self.unexpected(at, child, said),
                Status::Success | Status::Failure if said == end => {
                    self.reset_children(at, node);
                    self.live[at].cursor = 0;
                    return Ok(said);
                }
                Status::Success | Status::Failure => {
                    if is_async && was_idle && next < node.end {
                        self.live[at].cursor = next;
                        return Ok(Status::Running);
                    }
                }
            }
            child = next as usize;
        }
        let are_all_skipped = self.live[at].count as usize == children(shape, at, node).count();
        self.reset_children(at, node);
        self.live[at].cursor = 0;
        self.live[at].count = 0;
        Ok(if are_all_skipped { Status::Skipped } else { opposite(end) })
    }

    /// Ticks a sequence that continues at the child that failed, even after a halt. It returns RUNNING after each
    /// child.
    pub(super) fn sequence_with_memory(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        self.begin(at);
        let mut child = match self.live[at].cursor {
            0 => at + 1,
            cursor => cursor as usize,
        };
        while child < node.end as usize {
            self.live[at].cursor = place(child);
            let was_idle = self.live[child].status == Status::Idle;
            let said = self.tick(child)?;
            let next = shape.nodes[child].end;
            match said {
                Status::Running => return Ok(Status::Running),
                Status::Failure => {
                    for later in children(shape, at, node).filter(|later| *later >= child) {
                        self.reset(later);
                    }
                    return Ok(Status::Failure);
                }
                Status::Success => {
                    if was_idle && next < node.end {
                        self.live[at].cursor = next;
                        return Ok(Status::Running);
                    }
                }
                Status::Skipped => self.live[at].count += 1,
                Status::Idle => return self.unexpected(at, child, said),
            }
            child = next as usize;
        }
        let are_all_skipped = self.live[at].count as usize == children(shape, at, node).count();
        self.reset_children(at, node);
        self.live[at].cursor = 0;
        self.live[at].count = 0;
        Ok(if are_all_skipped { Status::Skipped } else { Status::Success })
    }

    /// Marks a sequence or a fallback as running. If the node was idle, skipped children are counted from 0 again.
    fn begin(&mut self, at: usize) {
        let live = &mut self.live[at];
        if live.status == Status::Idle {
            live.count = 0;
        }
        live.status = Status::Running;
    }

    /// Ticks a `ReactiveSequence` or a `ReactiveFallback`. Every tick begins at the first child, and only one of the
    /// running children continues.
    pub(super) fn reactive(&mut self, at: usize, node: &Node, end: Status) -> Outcome {
        let shape: &'a Shape = self.shape;
        let mut are_all_skipped = true;
        self.live[at].status = Status::Running;
        for child in children(shape, at, node) {
            let said = self.tick(child)?;
            are_all_skipped &= said == Status::Skipped;
            match said {
                Status::Running => {
                    for other in children(shape, at, node).filter(|other| *other != child) {
                        self.reset(other);
                    }
                    return Ok(Status::Running);
                }
                Status::Skipped => self.reset(child),
                Status::Idle => return self.unexpected(at, child, said),
                Status::Success | Status::Failure if said == end => {
                    self.reset_children(at, node);
                    return Ok(said);
                }
                Status::Success | Status::Failure => {}
            }
        }
        self.reset_children(at, node);
        Ok(if are_all_skipped { Status::Skipped } else { opposite(end) })
    }

    pub(super) fn parallel(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        let count = children(shape, at, node).count();
        let wanted = self.number(at, node, 0)?;
        let (successes, failures) = (self.threshold(at, node, 0, count)?, self.threshold(at, node, 1, count)?);
        self.live[at].status = Status::Running;
        let mut skipped = 0;
        for child in children(shape, at, node) {
            if !self.live[child].is_counted {
                match self.tick(child)? {
                    Status::Skipped => skipped += 1,
                    Status::Success => {
                        self.live[child].is_counted = true;
                        self.live[at].count += 1;
                    }
                    Status::Failure => {
                        self.live[child].is_counted = true;
                        self.live[at].failures += 1;
                    }
                    Status::Running => {}
                    Status::Idle => return self.unexpected(at, child, Status::Idle),
                }
            }
            let (succeeded, failed) = (self.live[at].count as usize, self.live[at].failures as usize);
            // A skipped child counts as a success only if the threshold is negative.
            if succeeded >= successes || (wanted < 0 && succeeded + skipped >= successes) {
                return self.decided(at, node, Status::Success);
            }
            if count.saturating_sub(failed) < successes || failed == failures {
                return self.decided(at, node, Status::Failure);
            }
        }
        Ok(if skipped == count { Status::Skipped } else { Status::Running })
    }

    fn decided(&mut self, at: usize, node: &Node, status: Status) -> Outcome {
        self.uncount(at);
        self.reset_children(at, node);
        Ok(status)
    }

    pub(super) fn parallel_all(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        let count = children(shape, at, node).count();
        let most_failures = self.threshold(at, node, 0, count)?;
        self.live[at].status = Status::Running;
        let mut skipped = 0;
        for child in children(shape, at, node) {
            if self.live[child].is_counted {
                continue;
            }
            match self.tick(child)? {
                Status::Success => self.live[child].is_counted = true,
                Status::Failure => {
                    self.live[child].is_counted = true;
                    self.live[at].failures += 1;
                }
                Status::Running => {}
                Status::Skipped => skipped += 1,
                Status::Idle => return self.unexpected(at, child, Status::Idle),
            }
        }
        if skipped == count {
            return Ok(Status::Skipped);
        }
        let done = children(shape, at, node).filter(|child| self.live[*child].is_counted).count();
        if skipped + done < count {
            return Ok(Status::Running);
        }
        let has_failed = self.live[at].failures as usize >= most_failures;
        self.decided(at, node, if has_failed { Status::Failure } else { Status::Success })
    }

    /// Returns the number of children that a threshold means. −1 means all children, and −2 means all but one.
    fn threshold(&mut self, at: usize, node: &Node, port: usize, count: usize) -> Result<usize, Faulted> {
        let number = self.number(at, node, port)?;
        let all = i64::try_from(count).unwrap_or(i64::MAX);
        let meant = if number < 0 { all.saturating_add(number).saturating_add(1).max(0) } else { number };
        match usize::try_from(meant) {
            Ok(meant) if meant <= count => Ok(meant),
            _ => {
                self.fault(at, format!("its port {} is {number}, but the node has {count} children", self.port_name(node, port)))
            }
        }
    }

    pub(super) fn uncount(&mut self, at: usize) {
        let shape: &'a Shape = self.shape;
        self.live[at].count = 0;
        self.live[at].failures = 0;
        for child in children(shape, at, &shape.nodes[at]) {
            self.live[child].is_counted = false;
        }
    }

    /// Ticks the condition until it is done. The condition is ticked again only after the chosen child is done.
    pub(super) fn if_then_else(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        self.live[at].status = Status::Running;
        if self.live[at].cursor == 0 {
            let condition = at + 1;
            let then = shape.nodes[condition].end;
            let otherwise = shape.nodes[then as usize].end;
            match self.tick(condition)? {
                Status::Running => return Ok(Status::Running),
                Status::Success => self.live[at].cursor = then,
                Status::Failure if otherwise < node.end => self.live[at].cursor = otherwise,
                Status::Failure => return Ok(Status::Failure),
                said @ (Status::Skipped | Status::Idle) => return self.unexpected(at, condition, said),
            }
        }
        let chosen = self.live[at].cursor as usize;
        let said = self.tick(chosen)?;
        if said != Status::Running {
            self.reset_children(at, node);
            self.live[at].cursor = 0;
        }
        Ok(said)
    }

    /// Ticks all children but the last as a sequence. When one of them fails, the last child is ticked in the same
    /// tick, and the result is always a failure. `has_begun` tells that the node is at the last child.
    pub(super) fn try_catch(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        let last = self.last_child(at, node);
        if self.live[at].status == Status::Idle {
            self.live[at].has_begun = false;
        }
        self.begin(at);
        let mut child = match self.live[at].cursor {
            0 => at + 1,
            cursor => cursor as usize,
        };
        while !self.live[at].has_begun && child < last {
            match self.tick(child)? {
                Status::Running => {
                    self.live[at].cursor = place(child);
                    return Ok(Status::Running);
                }
                Status::Failure => {
                    self.reset_children(at, node);
                    self.live[at].has_begun = true;
                }
                Status::Success => {}
                Status::Skipped => self.live[at].count += 1,
                Status::Idle => return self.unexpected(at, child, Status::Idle),
            }
            child = shape.nodes[child].end as usize;
        }
        self.live[at].cursor = 0;
        if self.live[at].has_begun {
            if self.tick(last)? == Status::Running {
                return Ok(Status::Running);
            }
            self.reset_children(at, node);
            self.live[at].has_begun = false;
            return Ok(Status::Failure);
        }
        let are_all_skipped = self.live[at].count as usize + 1 == children(shape, at, node).count();
        self.reset_children(at, node);
        self.live[at].count = 0;
        Ok(if are_all_skipped { Status::Skipped } else { Status::Success })
    }

    /// Ticks the last child of a halted TryCatch, so that it can clean up. A halt does not wait, so the last child
    /// has only one tick.
    pub(super) fn catch_on_halt(&mut self, at: usize, node: &Node) {
        let is_wanted = self.port(node, 0).and_then(Value::as_bool).unwrap_or(false);
        if !is_wanted || self.live[at].has_begun {
            return;
        }
        let last = self.last_child(at, node);
        for child in children(self.shape, at, node).filter(|child| *child < last) {
            self.reset(child);
        }
        // A fault is reported at the end of the tick. A child that still runs is halted with the other children.
        let _ = self.tick(last);
    }

    fn last_child(&self, at: usize, node: &Node) -> usize {
        children(self.shape, at, node).last().unwrap_or(at + 1)
    }

    /// Ticks the condition every time, and then the chosen child. The child that is not chosen is halted.
    pub(super) fn while_do_else(&mut self, at: usize, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        self.live[at].status = Status::Running;
        let condition = at + 1;
        let body = shape.nodes[condition].end as usize;
        let otherwise = shape.nodes[body].end as usize;
        let has_otherwise = otherwise < node.end as usize;
        let said = match self.tick(condition)? {
            Status::Running => return Ok(Status::Running),
            Status::Success => {
                if has_otherwise {
                    self.reset(otherwise);
                }
                self.tick(body)?
            }
            Status::Failure if has_otherwise => {
                self.reset(body);
                self.tick(otherwise)?
            }
            Status::Failure => Status::Failure,
            said @ (Status::Skipped | Status::Idle) => return self.unexpected(at, condition, said),
        };
        if said != Status::Running {
            self.reset_children(at, node);
        }
        Ok(said)
    }

    /// Ticks the child whose case equals the variable, or the last child if no case is equal. If another child was
    /// running, it is halted.
    pub(super) fn switch(&mut self, at: usize, node: &Node, cases: usize) -> Outcome {
        let shape: &'a Shape = self.shape;
        let variable = self.port(node, 0);
        let chosen = (1..=cases).position(|case| match (variable, self.port(node, case)) {
            (Some(variable), Some(case)) => equals(variable, case),
            (None, _) | (_, None) => false,
        });
        let chosen = chosen.unwrap_or(cases);
        let Some(child) = children(shape, at, node).nth(chosen) else {
            return self.fault(at, "it has not as many children as cases");
        };
        let before = self.live[at].cursor as usize;
        if before != 0 && before != child {
            self.reset(before);
        }
        let said = self.tick(child)?;
        match said {
            Status::Running => self.live[at].cursor = place(child),
            Status::Skipped => self.live[at].cursor = 0,
            Status::Success | Status::Failure | Status::Idle => {
                self.reset_children(at, node);
                self.live[at].cursor = 0;
            }
        }
        Ok(said)
    }
}

/// The precision of a `float`. BehaviorTree.CPP compares numbers with this precision.
pub(crate) const EPSILON: f64 = 1.192_092_895_507_812_5e-7;

/// Whether a variable equals a case. They are compared as texts, and then as numbers.
fn equals(variable: &Value, case: &Value) -> bool {
    if variable.to_string() == case.to_string() {
        return true;
    }
    match (variable.as_number(), case.as_number()) {
        (Some(variable), Some(case)) => (variable - case).abs() <= EPSILON,
        (None, _) | (_, None) => false,
    }
}

const fn opposite(status: Status) -> Status {
    match status {
        Status::Success => Status::Failure,
        Status::Failure => Status::Success,
        Status::Idle | Status::Running | Status::Skipped => status,
    }
}

fn place(child: usize) -> u32 {
    u32::try_from(child).expect("a tree has no more than MOST_NODES nodes")
}
