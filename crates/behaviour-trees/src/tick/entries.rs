//! Nodes that wait until an entry of the blackboard is written, and loops over a queue. A queue is a text with `;`
//! between its elements, or after each of them. An empty text has no elements. BehaviorTree.CPP can also store queues
//! in entries of a special type, which are not supported here.

use super::{Leaves, Node, Outcome, Status, TreeRun};
use crate::kind::BuiltIn;
use crate::leaf::Binding;
use crate::value::{Value, ValueType};

impl<L: Leaves> TreeRun<'_, L> {
    /// Ticks the child if the entry was written since the last check. A running child continues without a new check.
    pub(super) fn if_updated(&mut self, at: usize, node: &Node, otherwise: Status) -> Outcome {
        if !self.live[at].has_begun && !self.is_updated(at, node) {
            return Ok(otherwise);
        }
        let said = self.tick(at + 1)?;
        self.live[at].has_begun = said == Status::Running;
        Ok(said)
    }

    pub(super) fn was_updated(&mut self, at: usize, node: &Node) -> Outcome {
        Ok(if self.is_updated(at, node) { Status::Success } else { Status::Failure })
    }

    /// Whether the entry was written since the last check. `since` is the number of the last write that the node has
    /// seen. A halt does not reset `since`.
    fn is_updated(&mut self, at: usize, node: &Node) -> bool {
        let Binding::Slot(slot) = self.shape.bindings[node.ports as usize] else { return false };
        let Some(entry) = self.blackboard.entry(slot).filter(|entry| entry.value().is_some()) else { return false };
        let before = std::mem::replace(&mut self.live[at].since, entry.written());
        before != entry.written()
    }

    /// Ticks a loop. Whenever its child is done, the next element is written to `value`. `count` is the number of
    /// elements taken.
    pub(super) fn each(&mut self, at: usize, node: &Node, kind: BuiltIn) -> Outcome {
        let is_literal = matches!(self.shape.bindings[node.ports as usize], Binding::Literal(_));
        let live = &mut self.live[at];
        if live.status == Status::Idle {
            live.has_begun = false;
            // A queue in the file starts again from its beginning. A queue in an entry is used only once.
            live.count = if is_literal { 0 } else { live.count };
        }
        if !live.has_begun {
            let Some(element) = self.next_element(at, node, kind.element().unwrap_or_default())? else {
                return Ok(self.otherwise(at).unwrap_or(Status::Success));
            };
            self.live[at].count = self.live[at].count.saturating_add(1);
            if let Binding::Slot(slot) = self.shape.bindings[node.ports as usize + 2]
                && let Err(unfit) = self.blackboard.put(slot, element)
            {
                return self.fault(at, unfit.to_string());
            }
        }
        self.live[at].status = Status::Running;
        let said = self.tick(at + 1)?;
        self.live[at].has_begun = said == Status::Running;
        Ok(if said == Status::Failure { Status::Failure } else { Status::Running })
    }

    fn next_element(&mut self, at: usize, node: &Node, ty: ValueType) -> Result<Option<Value>, super::Faulted> {
        let Some(queue) = self.port(node, 0) else { return Ok(None) };
        let Some(queue) = queue.as_text() else {
            return self.fault(at, "its port queue is not a text of elements separated by ;");
        };
        let Some(element) = queue.split_terminator(';').nth(self.live[at].count as usize) else { return Ok(None) };
        match Value::parse(element, ty) {
            Some(value) => Ok(Some(value)),
            None => {
                let reason = format!("the element {element:?} of its queue is not of type {}", ty.word());
                self.fault(at, reason)
            }
        }
    }
}
