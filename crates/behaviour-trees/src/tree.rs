//! A tree that can be ticked: its nodes in one row, and the state of each node. `build` makes it from a document.
//! `tick` has its rules.
//!
//! ```text
//!   Sequence ──┬─ Fallback ─┬─ NearObj            nodes:   0 Sequence  1 Fallback  2 NearObj  3 ApproachObject  4 Sync
//!              │            └─ ApproachObject     end:     5           4           3          4                 5
//!              └─ Sync
//! ```
//! A node's children come directly after it in the row. Each child ends where the next child begins.

use std::sync::Arc;
use std::time::Duration;

use super::blackboard::Blackboard;
use super::document::SourcePosition;
use super::kind::{BuiltIn, Family};
use super::leaf::{Binding, LeafKind, Leaves};
use super::script::Script;
use super::status::Status;
use super::tick::{Fault, TreeRun};

/// Maximum number of nodes of a tree, including the nodes of its subtrees. Trees that people draw have some hundreds.
/// Without a limit, a few subtrees that use each other twice would fill the memory.
pub const MOST_NODES: usize = 10_000;

/// Maximum number of bytes of attributes in a tree. The attributes of a subtree count at each use, because each use
/// is built. Without this limit, a subtree with the longest scripts could be used a thousand times.
pub const MOST_TEXT: usize = 2 << 20;

/// Maximum depth of a tree, including its subtrees. A tick uses recursive calls, which must fit on a thread's stack.
pub const DEEPEST: usize = 128;

/// A node of a tree: its index in preorder, counted from 0. The graphical editor's UID is this number plus one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

/// Tells who performs a node: the engine, or the performer of the leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// One of the engine's own kinds. `tick` has its rules.
    BuiltIn(BuiltIn),
    /// The leaf at this index of the catalogue.
    Leaf(usize),
}

/// The names of a node, and its places in the file and in the tree. They are used in messages and views.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub(crate) name: Arc<str>,
    pub(crate) path: Arc<str>,
    pub(crate) id: Arc<str>,
    pub(crate) place: SourcePosition,
    pub(crate) depth: u16,
}

/// The part of a node that does not change while the tree runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) kind: NodeKind,
    pub(crate) family: Family,
    /// The index after the last node of its subtree.
    pub(crate) end: u32,
    pub(crate) ports: u32,
    pub(crate) port_count: u16,
    /// The index of the node's scripts in `Shape::conditions`.
    pub(crate) conditions: Option<u32>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Conditions {
    pub(crate) failure_if: Option<Script>,
    pub(crate) success_if: Option<Script>,
    pub(crate) skip_if: Option<Script>,
    pub(crate) keep_while: Option<Script>,
    pub(crate) on_success: Option<Script>,
    pub(crate) on_failure: Option<Script>,
    pub(crate) on_halted: Option<Script>,
    pub(crate) post: Option<Script>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    pub(crate) nodes: Vec<Node>,
    pub(crate) labels: Vec<Label>,
    pub(crate) bindings: Vec<Binding>,
    pub(crate) conditions: Vec<Conditions>,
    /// The scripts of `Script`, `ScriptCondition` and `Precondition`, each with its node.
    pub(crate) scripts: Vec<(u32, Script)>,
    /// The results of `Precondition` and of loops when they do not tick their child. Each is stored with its node.
    pub(crate) otherwise: Vec<(u32, Status)>,
    pub(crate) leaf_kinds: Vec<LeafKind>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Live {
    pub(crate) status: Status,
    pub(crate) returned: Status,
    /// Whether the result of this node is already counted by its parallel parent.
    pub(crate) is_counted: bool,
    /// A fact that a node remembers. Depending on its kind: its time has started, it has run, its condition held, or
    /// it is at the last child.
    pub(crate) has_begun: bool,
    /// Whether the time of a Timeout ended while its child was not running.
    pub(crate) is_spent: bool,
    /// The child at which the node continues, as an index in the row. 0 means the first child.
    pub(crate) cursor: u32,
    /// Number of skipped children, of successes, of attempts or of elements, depending on the kind of node.
    pub(crate) count: u32,
    pub(crate) failures: u32,
    /// The tree's time when the node began, in nanoseconds. For some kinds, the number of the last write that the
    /// node has seen.
    pub(crate) since: u64,
    pub(crate) ticked: u64,
}

/// A tree that can be ticked. It must be ticked with the blackboard on which it was built.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(crate) id: Arc<str>,
    pub(crate) shape: Shape,
    pub(crate) live: Vec<Live>,
    /// Total time of this tree's ticks, in nanoseconds.
    pub(crate) clock: u64,
    pub(crate) ticks: u64,
    /// Distinguishes this tree from other trees (`state`).
    pub(crate) fingerprint: u64,
}

/// A node with its names and its state after the last tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeView<'a> {
    /// The number of the node in preorder, counted from 0.
    pub node: NodeId,
    /// The path, as in BehaviorTree.CPP (`fullPath`): the names of the subtrees and the node's name, joined with `/`.
    /// If the node has no name of its own, or if another node has the same path, `::` and the UID follow. No two
    /// nodes have the same path.
    pub path: &'a str,
    /// The node's name, or the name of its kind.
    pub name: &'a str,
    /// The name of the node's kind. It is `SubTree` for the use of another tree.
    pub id: &'a str,
    /// The built-in kind, or the index of the leaf in the catalogue.
    pub kind: NodeKind,
    /// The class of the node by its number of children. A `SubTree` is a decorator.
    pub family: Family,
    /// Number of levels below the root; 0 for the root. Levels of subtrees count.
    pub depth: usize,
    /// Where the node's element begins in the file.
    pub place: SourcePosition,
    /// The status after the tick. It is IDLE if the parent has reset the node.
    pub after: Status,
    /// The status returned in the last tick; `None` if the node was not ticked.
    pub returned: Option<Status>,
}

impl NodeView<'_> {
    /// The status that the node returned in the last tick, even if the parent has reset the node since then. If the
    /// node was not ticked, its present status.
    #[must_use]
    pub fn status(&self) -> Status {
        self.returned.unwrap_or(self.after)
    }
}

impl Tree {
    /// The `ID` of the tree's `<BehaviorTree>`.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Ticks the tree once. `since_last` is the time since the last tick. Timeout, Delay, Sleep and `Leaf::elapsed`
    /// count only this time, so their time is paused while the tree is not ticked. After SUCCESS or FAILURE, the next
    /// tick begins a new run.
    ///
    /// # Errors
    /// If a node cannot be performed. Examples are a script that divides by zero, and an entry without a value where
    /// a number is needed. The whole tree has then been halted.
    pub fn tick<L: Leaves>(
        &mut self,
        blackboard: &mut Blackboard,
        leaves: &mut L,
        since_last: Duration,
    ) -> Result<Status, Fault> {
        self.clock = self.clock.saturating_add(nanoseconds(since_last));
        self.ticks += 1;
        let mut run = self.run(blackboard, leaves);
        let outcome = run.tick(0);
        let fault = run.fault.take();
        match (outcome, fault) {
            (Ok(status), None) => {
                if status.is_completed() {
                    self.live[0].status = Status::Idle;
                }
                Ok(status)
            }
            (_, Some(fault)) => {
                self.halt(blackboard, leaves);
                Err(fault)
            }
            (Err(_), None) => unreachable!("whoever says that a tick cannot go on says why"),
        }
    }

    /// Halts every running node. The next tick begins at the root.
    pub fn halt<L: Leaves>(&mut self, blackboard: &mut Blackboard, leaves: &mut L) {
        let mut run = self.run(blackboard, leaves);
        run.halt_all();
    }

    fn run<'a, L: Leaves>(&'a mut self, blackboard: &'a mut Blackboard, leaves: &'a mut L) -> TreeRun<'a, L> {
        TreeRun {
            shape: &self.shape,
            live: &mut self.live,
            blackboard,
            leaves,
            clock: self.clock,
            number: self.ticks,
            fault: None,
        }
    }

    /// All nodes in preorder, with their state after the last tick.
    pub fn nodes(&self) -> impl Iterator<Item = NodeView<'_>> {
        let rows = self.shape.nodes.iter().zip(&self.shape.labels).zip(&self.live);
        rows.zip(0..).map(|(((node, label), live), number)| NodeView {
            node: NodeId(number),
            path: &label.path,
            name: &label.name,
            id: &label.id,
            kind: node.kind,
            family: node.family,
            depth: usize::from(label.depth),
            place: label.place,
            after: live.status,
            returned: (live.ticked == self.ticks && self.ticks > 0).then_some(live.returned),
        })
    }

    /// The status of the root: RUNNING between the ticks of a run, otherwise IDLE.
    #[must_use]
    pub fn status(&self) -> Status {
        self.live[0].status
    }

    /// Number of ticks, including ticks before a restart.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }

    /// The tree's own time: the sum of the times passed to its ticks.
    #[must_use]
    pub const fn clock(&self) -> Duration {
        Duration::from_nanos(self.clock)
    }
}

/// Converts a time to nanoseconds, at most 584 years.
pub(crate) fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaf::{Catalogue, Leaf, LeafKind, Port};
    use crate::value::Cell;
    use crate::value::{Value, ValueType};
    use crate::xml;

    /// A test performer that drives to the goal in three ticks, and then writes its cell.
    #[derive(Default)]
    struct Driver {
        halted: Vec<String>,
        elapsed: Vec<u128>,
    }

    impl Leaves for Driver {
        fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
            self.elapsed.push(leaf.elapsed().as_millis());
            if leaf.elapsed() < Duration::from_millis(200) {
                return Status::Running;
            }
            let goal = leaf.cell(0).expect("the goal is set");
            leaf.write(1, Value::Cell(goal));
            Status::Success
        }

        fn halt(&mut self, leaf: &mut Leaf<'_>) {
            self.halted.push(leaf.name().to_owned());
        }
    }

    fn catalogue() -> Catalogue {
        let ports = vec![Port::input("goal", ValueType::Cell), Port::output("at", ValueType::Cell)];
        Catalogue::new(vec![LeafKind::action("Drive", ports)])
    }

    const FILE: &str = r#"<root BTCPP_format="4"><BehaviorTree ID="Go">
        <Sequence><Drive name="out" goal="3;4" at="{here}"/><Drive name="back" goal="0;0" at="{here}"/></Sequence>
    </BehaviorTree></root>"#;

    #[test]
    fn a_tree_from_a_file_runs_its_leaves_in_their_own_time() {
        let document = xml::read(FILE).expect("it is a good file");
        let mut blackboard = Blackboard::new();
        let mut tree = Tree::build(&document, None, &catalogue(), &mut blackboard).expect("its names are known");
        let mut driver = Driver::default();
        let mut tick = |tree: &mut Tree| tree.tick(&mut blackboard, &mut driver, Duration::from_millis(100)).expect("no fault");
        let said: Vec<Status> = (0..5).map(|_| tick(&mut tree)).collect();
        assert_eq!(said, [Status::Running, Status::Running, Status::Running, Status::Running, Status::Success]);
        assert_eq!(driver.elapsed, [0, 100, 200, 0, 100, 200]);
        assert_eq!(blackboard.get("here"), Some(&Value::Cell(Cell { x: 0, y: 0 })));
        assert!(tree.nodes().all(|node| node.after == Status::Idle), "who is done is reset");
    }

    #[test]
    fn a_halt_reaches_the_leaf_that_runs_and_no_other() {
        let document = xml::read(FILE).expect("it is a good file");
        let mut blackboard = Blackboard::new();
        let mut tree = Tree::build(&document, None, &catalogue(), &mut blackboard).expect("its names are known");
        let mut driver = Driver::default();
        for _ in 0..4 {
            tree.tick(&mut blackboard, &mut driver, Duration::from_millis(100)).expect("no fault");
        }
        tree.halt(&mut blackboard, &mut driver);
        assert_eq!(driver.halted, ["back"]);
        assert_eq!(tree.status(), Status::Idle);
    }

    #[test]
    fn paths_are_those_of_the_graphical_editor() {
        let document = xml::read(FILE).expect("it is a good file");
        let tree = Tree::build(&document, None, &catalogue(), &mut Blackboard::new()).expect("its names are known");
        let paths: Vec<&str> = tree.nodes().map(|node| node.path).collect();
        assert_eq!(paths, ["Sequence::1", "out", "back"]);
    }
}
