//! The view of a retrieval: its progress, its behaviour trees and the values that they share. `robot` has the view of
//! the robots.

use std::sync::Arc;

use crate::not_fetched::{Fetcher, NotFetched};
use crate::units::{Cell, LuggageId};
use behaviour_trees::{Blackboard, Status, Tree};

/// A retrieval that is under way or in fault.
#[derive(Clone, Debug, PartialEq)]
pub struct RetrievalView {
    pub luggage: LuggageId,
    pub fetcher: Fetcher,
    pub stage: &'static str,
    pub reason: Option<NotFetched>,
    /// The known cells in which the piece lies now; empty while it is off the floor.
    pub piece: Vec<Cell>,
    /// The behaviour trees; empty if the piece is fetched without trees.
    pub trees: Arc<TreesView>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreesView {
    pub ticks: u64,
    /// The trees in the order in which they are ticked.
    pub trees: Vec<TreeView>,
    /// The names and values of the blackboard's entries. Entries without a value are left out.
    pub blackboard: Vec<(Arc<str>, String)>,
}

impl TreesView {
    #[must_use]
    pub fn of(trees: &[Tree], blackboard: &Blackboard) -> TreesView {
        let held = blackboard.entries().filter_map(|entry| Some((Arc::from(entry.name()), entry.value()?.to_string())));
        TreesView {
            ticks: trees.iter().map(Tree::ticks).max().unwrap_or(0),
            trees: trees.iter().map(TreeView::of).collect(),
            blackboard: held.collect(),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct TreeView {
    pub id: Arc<str>,
    /// The nodes in preorder.
    pub nodes: Vec<NodeShown>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NodeShown {
    /// The names of the subtrees that contain the node, followed by the node's name, joined with `/`.
    pub path: Arc<str>,
    pub name: Arc<str>,
    pub kind: Arc<str>,
    /// The depth of the node; 0 for the root.
    pub depth: usize,
    /// The status from the last tick, if the node was ticked then; otherwise its present status.
    pub status: Status,
    /// Whether `status` comes from the last tick.
    pub is_ticked: bool,
}

impl TreeView {
    #[must_use]
    pub fn of(tree: &Tree) -> TreeView {
        let nodes = tree.nodes().map(|node| NodeShown {
            path: Arc::from(node.path),
            name: Arc::from(node.name),
            kind: Arc::from(node.id),
            depth: node.depth,
            status: node.status(),
            is_ticked: node.returned.is_some(),
        });
        TreeView { id: Arc::from(tree.id()), nodes: nodes.collect() }
    }
}
