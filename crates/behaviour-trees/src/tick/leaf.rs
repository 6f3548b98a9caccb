//! Nodes without children: leaves of the catalogue, which the program performs, and the engine's own leaves.

use std::time::Duration;

use super::{Leaves, Node, NodeId, Outcome, Status, TreeRun};
use crate::leaf::{Binding, Leaf, Misuse};
use crate::script::Script;
use crate::tree::Shape;
use crate::value::Value;

impl<'a, L: Leaves> TreeRun<'a, L> {
    pub(super) fn leaf(&mut self, at: usize, node: &Node, kind: usize) -> Outcome {
        let live = &mut self.live[at];
        let is_starting = live.status != Status::Running;
        if is_starting {
            live.since = self.clock;
        }
        let (said, misuse) = self.with_leaf(at, node, kind, is_starting, |leaves, leaf| leaves.tick(leaf));
        if let Some(misuse) = misuse {
            return self.fault(at, misuse.to_string());
        }
        match said {
            Status::Idle => self.fault(at, "it returned IDLE, which is not allowed in a tick"),
            Status::Running | Status::Success | Status::Failure | Status::Skipped => Ok(said),
        }
    }

    pub(super) fn halt_leaf(&mut self, at: usize, node: &Node, kind: usize) {
        let ((), misuse) = self.with_leaf(at, node, kind, false, |leaves, leaf| leaves.halt(leaf));
        if let Some(misuse) = misuse {
            let _ = self.fault::<()>(at, misuse.to_string());
        }
    }

    fn with_leaf<R>(
        &mut self,
        at: usize,
        node: &Node,
        kind: usize,
        is_starting: bool,
        work: impl FnOnce(&mut L, &mut Leaf<'_>) -> R,
    ) -> (R, Option<Misuse>) {
        let shape: &'a Shape = self.shape;
        let first = node.ports as usize;
        let mut leaf = Leaf {
            kind,
            node: NodeId(u32::try_from(at).unwrap_or(u32::MAX)),
            label: &shape.labels[at],
            ports: &shape.leaf_kinds[kind].ports,
            bindings: &shape.bindings[first..first + usize::from(node.port_count)],
            blackboard: self.blackboard,
            is_starting,
            elapsed: Duration::from_nanos(self.clock.saturating_sub(self.live[at].since)),
            misuse: None,
        };
        let done = work(self.leaves, &mut leaf);
        (done, leaf.misuse)
    }

    /// Copies an entry, or writes a text. Fails if there is no value to copy.
    pub(super) fn set_blackboard(&mut self, at: usize, node: &Node) -> Outcome {
        let Some(value) = self.port(node, 0).cloned() else { return Ok(Status::Failure) };
        let Binding::Slot(slot) = self.shape.bindings[node.ports as usize + 1] else {
            return self.fault(at, "its port output_key names no entry");
        };
        // A text is converted to the type of the entry's value.
        let before = self.blackboard.value(slot).map(Value::value_type);
        let value = before.and_then(|ty| value.converted(ty)).unwrap_or(value);
        match self.blackboard.put(slot, value) {
            Ok(()) => Ok(Status::Success),
            Err(unfit) => self.fault(at, unfit.to_string()),
        }
    }

    pub(super) fn unset_blackboard(&mut self, node: &Node) -> Outcome {
        if let Binding::Slot(slot) = self.shape.bindings[node.ports as usize] {
            self.blackboard.remove(slot);
        }
        Ok(Status::Success)
    }

    pub(super) fn sleep(&mut self, at: usize, node: &Node) -> Outcome {
        if self.live[at].status == Status::Success {
            // A node may be ticked again without a reset, such as the condition of a WhileDoElse. It must not sleep
            // twice.
            return Ok(Status::Success);
        }
        if self.live[at].status != Status::Running {
            let time = self.milliseconds(at, node)?;
            self.live[at].since = self.clock.saturating_add(time);
            return Ok(if time == 0 { Status::Success } else { Status::Running });
        }
        // `since` is the end of the sleep. The port is read only once.
        Ok(if self.clock < self.live[at].since { Status::Running } else { Status::Success })
    }

    pub(super) fn script(&mut self, at: usize) -> Outcome {
        let script = self.script_of(at);
        self.carry_out(at, script)?;
        Ok(Status::Success)
    }

    pub(super) fn script_condition(&mut self, at: usize) -> Outcome {
        let script = self.script_of(at);
        Ok(if self.holds(at, script)? { Status::Success } else { Status::Failure })
    }

    /// Returns the script of this node, which must have one. The list of scripts is sorted by node.
    pub(super) fn script_of(&self, at: usize) -> &'a Script {
        let shape: &'a Shape = self.shape;
        let number = u32::try_from(at).unwrap_or(u32::MAX);
        let found = shape.scripts.binary_search_by_key(&number, |(node, _)| *node);
        &shape.scripts[found.expect("a node of this kind is built with a script")].1
    }

    /// Ticks a barrier. A party arrives when it is ticked, and the barrier opens when all parties have arrived. The
    /// first binding is the arriving party, and the other bindings are all parties.
    pub(super) fn sync(&mut self, node: &Node) -> Outcome {
        let shape: &'a Shape = self.shape;
        let first = node.ports as usize;
        let (waiting, parties) = shape.bindings[first..first + usize::from(node.port_count)].split_at(1);
        for binding in waiting {
            if let Binding::Slot(slot) = binding
                && self.blackboard.value(*slot) != Some(&Value::Bool(true))
            {
                // This cannot fail, because only barriers write the entry, always with this type.
                let _ = self.blackboard.put(*slot, Value::Bool(true));
            }
        }
        let has_come = |binding: &Binding| match binding {
            Binding::Slot(slot) => self.blackboard.value(*slot) == Some(&Value::Bool(true)),
            Binding::Literal(_) | Binding::Unset => false,
        };
        Ok(if parties.iter().all(has_come) { Status::Success } else { Status::Running })
    }
}
