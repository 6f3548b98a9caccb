//! One tick of a tree, by the rules of BehaviorTree.CPP 4. The code shared by all nodes is here. `control` has the
//! rules of nodes with several children, `decorator` of nodes with one child, and `leaf` of leaves. `entries` has the
//! rules of nodes that wait for entries of the blackboard or loop over a queue.

mod control;
mod decorator;
mod entries;
mod leaf;

pub(crate) use self::control::EPSILON;

use std::fmt;
use std::sync::Arc;

use super::blackboard::Blackboard;
use super::document::SourcePosition;
use super::kind::{BuiltIn, Family};
use super::leaf::{Binding, Leaves};
use super::script::Script;
use super::status::Status;
use super::tree::{Live, Node, NodeId, NodeKind, Shape};
use super::value::Value;

/// Why a tick could not be completed, and at which node. The whole tree has been halted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The node that failed first. Faults that follow from this one are not reported.
    pub node: NodeId,
    /// The path of this node in the tree, as in `NodeView::path`.
    pub path: Arc<str>,
    /// Where the node's element begins in the file.
    pub place: SourcePosition,
    /// The reason, as words that follow the path.
    pub reason: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (line {}): {}", self.path, self.place.line, self.reason)
    }
}

impl std::error::Error for Fault {}

/// Marks a tick that cannot continue. `TreeRun::fault` has the reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Faulted;

pub(crate) type Outcome = Result<Status, Faulted>;

pub(crate) struct TreeRun<'a, L> {
    pub(crate) shape: &'a Shape,
    pub(crate) live: &'a mut [Live],
    pub(crate) blackboard: &'a mut Blackboard,
    pub(crate) leaves: &'a mut L,
    pub(crate) clock: u64,
    pub(crate) number: u64,
    pub(crate) fault: Option<Fault>,
}

impl<'a, L: Leaves> TreeRun<'a, L> {
    /// Ticks a node: first its conditions, then the node itself, then the scripts that follow its result.
    pub(crate) fn tick(&mut self, at: usize) -> Outcome {
        let shape: &'a Shape = self.shape;
        let node = &shape.nodes[at];
        let said = match self.before(at, node)? {
            Some(status) => status,
            None => self.perform(at, node)?,
        };
        if said.is_completed() {
            self.after(at, node, said)?;
        }
        let live = &mut self.live[at];
        live.returned = said;
        live.ticked = self.number;
        // A skipped node keeps its state. SKIPPED is only returned to its parent.
        if said != Status::Skipped {
            live.status = said;
        }
        if node.family == Family::Decorator && self.live[at + 1].status.is_completed() {
            self.live[at + 1].status = Status::Idle;
        }
        Ok(said)
    }

    fn perform(&mut self, at: usize, node: &Node) -> Outcome {
        match node.kind {
            NodeKind::Leaf(kind) => self.leaf(at, node, kind),
            NodeKind::BuiltIn(kind) => match kind {
                BuiltIn::Sequence => self.in_order(at, node, Status::Failure, false),
                BuiltIn::AsyncSequence => self.in_order(at, node, Status::Failure, true),
                BuiltIn::Fallback => self.in_order(at, node, Status::Success, false),
                BuiltIn::AsyncFallback => self.in_order(at, node, Status::Success, true),
                BuiltIn::SequenceWithMemory => self.sequence_with_memory(at, node),
                BuiltIn::ReactiveSequence => self.reactive(at, node, Status::Failure),
                BuiltIn::ReactiveFallback => self.reactive(at, node, Status::Success),
                BuiltIn::Parallel => self.parallel(at, node),
                BuiltIn::ParallelAll => self.parallel_all(at, node),
                BuiltIn::IfThenElse => self.if_then_else(at, node),
                BuiltIn::WhileDoElse => self.while_do_else(at, node),
                BuiltIn::Switch2 | BuiltIn::Switch3 | BuiltIn::Switch4 | BuiltIn::Switch5 | BuiltIn::Switch6 => {
                    self.switch(at, node, kind.cases())
                }
                BuiltIn::TryCatch => self.try_catch(at, node),
                BuiltIn::Inverter => self.inverter(at),
                BuiltIn::RetryUntilSuccessful => self.again(at, node, Status::Failure),
                BuiltIn::Repeat => self.again(at, node, Status::Success),
                BuiltIn::Timeout => self.timeout(at, node),
                BuiltIn::Delay => self.delay(at, node),
                BuiltIn::ForceSuccess => self.force(at, Status::Success),
                BuiltIn::ForceFailure => self.force(at, Status::Failure),
                BuiltIn::RunOnce => self.run_once(at, node),
                BuiltIn::KeepRunningUntilFailure => self.keep_running(at),
                BuiltIn::SubTree => self.subtree(at),
                BuiltIn::Precondition => self.precondition(at),
                BuiltIn::LoopInt | BuiltIn::LoopBool | BuiltIn::LoopDouble | BuiltIn::LoopString => self.each(at, node, kind),
                BuiltIn::SkipUnlessUpdated => self.if_updated(at, node, Status::Skipped),
                BuiltIn::WaitValueUpdate => self.if_updated(at, node, Status::Running),
                BuiltIn::WasEntryUpdated => self.was_updated(at, node),
                BuiltIn::AlwaysSuccess => Ok(Status::Success),
                BuiltIn::AlwaysFailure => Ok(Status::Failure),
                BuiltIn::SetBlackboard => self.set_blackboard(at, node),
                BuiltIn::UnsetBlackboard => self.unset_blackboard(node),
                BuiltIn::Sleep => self.sleep(at, node),
                BuiltIn::Script => self.script(at),
                BuiltIn::ScriptCondition => self.script_condition(at),
                BuiltIn::Sync => self.sync(node),
            },
        }
    }

    /// Returns the status that a node's conditions give it, if there is one. The conditions for the start are checked
    /// when the node starts, and `_while` is checked in every tick.
    fn before(&mut self, at: usize, node: &Node) -> Result<Option<Status>, Faulted> {
        let Some(conditions) = node.conditions else { return Ok(None) };
        let shape: &'a Shape = self.shape;
        let conditions = &shape.conditions[conditions as usize];
        match self.live[at].status {
            Status::Idle | Status::Skipped => {
                let asked = [
                    (&conditions.failure_if, true, Status::Failure),
                    (&conditions.success_if, true, Status::Success),
                    (&conditions.skip_if, true, Status::Skipped),
                    (&conditions.keep_while, false, Status::Skipped),
                ];
                for (script, when, status) in asked {
                    if let Some(script) = script
                        && self.holds(at, script)? == when
                    {
                        return Ok(Some(status));
                    }
                }
            }
            Status::Running => {
                if let Some(script) = &conditions.keep_while
                    && !self.holds(at, script)?
                {
                    self.halt(at);
                    return Ok(Some(Status::Skipped));
                }
            }
            Status::Success | Status::Failure => {}
        }
        Ok(None)
    }

    fn after(&mut self, at: usize, node: &Node, said: Status) -> Result<(), Faulted> {
        let Some(conditions) = node.conditions else { return Ok(()) };
        let shape: &'a Shape = self.shape;
        let conditions = &shape.conditions[conditions as usize];
        let first = if said == Status::Success { &conditions.on_success } else { &conditions.on_failure };
        for script in [first, &conditions.post].into_iter().flatten() {
            self.carry_out(at, script)?;
        }
        Ok(())
    }

    /// Halts a node and all running nodes below it. The node is then idle.
    pub(crate) fn halt(&mut self, at: usize) {
        let shape: &'a Shape = self.shape;
        let node = &shape.nodes[at];
        match node.kind {
            NodeKind::Leaf(kind) => self.halt_leaf(at, node, kind),
            NodeKind::BuiltIn(kind) => {
                if kind == BuiltIn::TryCatch {
                    self.catch_on_halt(at, node);
                }
                self.forget(at, kind);
            }
        }
        self.reset_children(at, node);
        self.live[at].status = Status::Idle;
        if let Some(conditions) = node.conditions
            && let Some(script) = &shape.conditions[conditions as usize].on_halted
        {
            // A halt always completes. The fault is reported at the end of the tick.
            let _ = self.carry_out(at, script);
        }
    }

    /// Resets the state that a node loses when it is halted. Some nodes remember something: `SequenceWithMemory` its
    /// child, `RunOnce` that it has run, `Precondition` that its condition held, and a loop its progress in the queue
    /// of an entry.
    fn forget(&mut self, at: usize, kind: BuiltIn) {
        let remembers = matches!(kind, BuiltIn::SequenceWithMemory | BuiltIn::RunOnce | BuiltIn::Precondition);
        if matches!(kind, BuiltIn::Parallel | BuiltIn::ParallelAll) {
            self.uncount(at);
        } else if !remembers && kind.element().is_none() {
            let live = &mut self.live[at];
            live.cursor = 0;
            live.count = 0;
            live.has_begun = false;
            live.is_spent = false;
        }
    }

    /// Halts all running nodes, from the root down. A node that runs without a running parent is halted too.
    pub(crate) fn halt_all(&mut self) {
        for at in 0..self.live.len() {
            if self.live[at].status == Status::Running {
                self.halt(at);
            }
            self.live[at].status = Status::Idle;
        }
    }

    fn reset(&mut self, child: usize) {
        if self.live[child].status == Status::Running {
            self.halt(child);
        }
        self.live[child].status = Status::Idle;
    }

    fn reset_children(&mut self, at: usize, node: &Node) {
        for child in children(self.shape, at, node) {
            self.reset(child);
        }
    }

    fn fault<T>(&mut self, at: usize, reason: impl Into<String>) -> Result<T, Faulted> {
        let label = &self.shape.labels[at];
        self.fault.get_or_insert_with(|| Fault {
            node: NodeId(u32::try_from(at).unwrap_or(u32::MAX)),
            path: label.path.clone(),
            place: label.place,
            reason: reason.into(),
        });
        Err(Faulted)
    }

    fn unexpected<T>(&mut self, at: usize, child: usize, said: Status) -> Result<T, Faulted> {
        let child = self.shape.labels[child].path.clone();
        self.fault(at, format!("its child {child} returned {}, which is not allowed here", said.word()))
    }

    fn holds(&mut self, at: usize, script: &Script) -> Result<bool, Faulted> {
        match script.holds(self.blackboard) {
            Ok(holds) => Ok(holds),
            Err(reason) => self.fault(at, reason.to_string()),
        }
    }

    fn carry_out(&mut self, at: usize, script: &Script) -> Result<(), Faulted> {
        match script.carry_out(self.blackboard) {
            Ok(_) => Ok(()),
            Err(reason) => self.fault(at, reason.to_string()),
        }
    }

    fn port(&self, node: &Node, port: usize) -> Option<&Value> {
        match &self.shape.bindings[node.ports as usize + port] {
            Binding::Unset => None,
            Binding::Literal(value) => Some(value),
            Binding::Slot(slot) => self.blackboard.value(*slot),
        }
    }

    fn number(&mut self, at: usize, node: &Node, port: usize) -> Result<i64, Faulted> {
        // The common case comes first: the number is a literal in the file.
        if let Some(Value::Int(number)) = self.port(node, port) {
            return Ok(*number);
        }
        match self.port(node, port).and_then(Value::as_int) {
            Some(number) => Ok(number),
            None => self.fault(at, format!("the value of its port {} is not a whole number", self.port_name(node, port))),
        }
    }

    fn port_name(&self, node: &Node, port: usize) -> &'static str {
        match node.kind {
            NodeKind::BuiltIn(kind) => kind.ports().get(port).map_or("", |port| port.name),
            NodeKind::Leaf(_) => "",
        }
    }
}

/// Returns the children of a node, as their indices in the row of nodes.
pub(crate) fn children<'a>(shape: &'a Shape, at: usize, node: &Node) -> impl Iterator<Item = usize> + use<'a> {
    let end = node.end as usize;
    let mut next = at + 1;
    std::iter::from_fn(move || {
        let child = next;
        (child < end).then(|| {
            next = shape.nodes[child].end as usize;
            child
        })
    })
}
