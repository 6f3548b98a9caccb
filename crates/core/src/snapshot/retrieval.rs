//! What is shown of a retrieval: how far it has come, the trees at work and what they share. What its robots do is shown of the robots.

use std::sync::Arc;

use crate::not_fetched::{Fetcher, NotFetched};
use crate::units::{Cell, LuggageId};
use behaviour_trees::{Blackboard, Status, Tree};

/// A retrieval under way, or in fault.
#[derive(Clone, Debug, PartialEq)]
pub struct RetrievalView {
    /// The piece that is fetched.
    pub luggage: LuggageId,
    /// By whom.
    pub fetcher: Fetcher,
    /// The word for how far it has come.
    pub stage: &'static str,
    /// Why it cannot be fetched, once that is known.
    pub reason: Option<NotFetched>,
    /// The cells in which it lies now, as far as they are known; none while it is off the floor.
    pub piece: Vec<Cell>,
    /// The trees that lead it; none when it is fetched without.
    pub trees: Arc<TreesView>,
}

/// Trees after a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreesView {
    /// How often they have been ticked.
    pub ticks: u64,
    /// In the order in which they are ticked.
    pub trees: Vec<TreeView>,
    /// What they share: the name and the value of each entry that holds something.
    pub blackboard: Vec<(Arc<str>, String)>,
}

impl TreesView {
    /// Trees as they are after their last tick.
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

/// A tree after a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeView {
    /// Its ID.
    pub id: Arc<str>,
    /// In preorder.
    pub nodes: Vec<NodeShown>,
}

/// A node after a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeShown {
    /// Names of the subtrees it is in and its own, joined with `/`.
    pub path: Arc<str>,
    /// Its name.
    pub name: Arc<str>,
    /// The name of its kind.
    pub kind: Arc<str>,
    /// How far below the root it is.
    pub depth: usize,
    /// What it said in the last tick if it was ticked in it, else how it stands.
    pub status: Status,
    /// Whether it was ticked in the last tick.
    pub is_ticked: bool,
}

impl TreeView {
    /// A tree as it is after its last tick.
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
