//! A retrieval in JSON: the piece, the stage, and the behaviour trees that control the robots. The robots are in
//! `robot`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::vocabulary;
use hallsweep_core::not_fetched::NotFetched;
use hallsweep_core::snapshot::retrieval::{NodeShown, RetrievalView, TreeView};
use hallsweep_core::units::Revision;

/// Retrieval of a dangerous piece; `stage` is `none` while no retrieval runs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RetrievalJson {
    /// Revision at which the retrieval last changed.
    pub revision: u64,
    /// Stage: `none`, `makingRoom`, `fetching`, `lettingGo`, `goingOut` or `comingHome`.
    #[schemars(with = "vocabulary::RetrievalStage")]
    pub stage: &'static str,
    /// Number of the piece that is fetched.
    pub luggage: Option<u64>,
    /// Robots that fetch: `pair` or `discovery`.
    #[schemars(with = "Option<vocabulary::Fetcher>")]
    pub fetcher: Option<&'static str>,
    /// Reason why the piece cannot be fetched; null while no reason is known.
    pub reason: Option<String>,
    /// Number of ticks of the trees.
    pub ticks: u64,
    /// Behaviour trees, in the order in which they are ticked.
    pub trees: Vec<TreeJson>,
    /// Blackboard that the trees share: entries by name, written as in a tree file.
    pub blackboard: BTreeMap<String, String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TreeJson {
    pub id: String,
    /// Nodes of the tree, in preorder.
    pub nodes: Vec<NodeJson>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NodeJson {
    pub path: String,
    pub name: String,
    pub kind: String,
    pub depth: usize,
    /// `IDLE`, `RUNNING`, `SUCCESS`, `FAILURE` or `SKIPPED`. This is the result of the last tick if `ticked` is true,
    /// else the present status.
    #[schemars(with = "vocabulary::NodeStatus")]
    pub status: &'static str,
    /// Whether the last tick visited the node.
    pub ticked: bool,
}

impl RetrievalJson {
    pub fn new(retrieval: Option<&RetrievalView>, revision: Revision) -> RetrievalJson {
        let trees = retrieval.map(|retrieval| &retrieval.trees);
        RetrievalJson {
            revision: revision.0,
            stage: retrieval.map_or("none", |retrieval| retrieval.stage),
            luggage: retrieval.map(|retrieval| retrieval.luggage.0),
            fetcher: retrieval.map(|retrieval| retrieval.fetcher.name()),
            reason: retrieval.and_then(|retrieval| retrieval.reason.as_ref().map(NotFetched::to_string)),
            ticks: trees.map_or(0, |trees| trees.ticks),
            trees: trees.map(|trees| trees.trees.iter().map(TreeJson::from).collect()).unwrap_or_default(),
            blackboard: trees
                .map(|trees| trees.blackboard.iter().map(|(name, value)| (name.to_string(), value.clone())).collect())
                .unwrap_or_default(),
        }
    }
}

impl From<&TreeView> for TreeJson {
    fn from(tree: &TreeView) -> TreeJson {
        TreeJson { id: tree.id.to_string(), nodes: tree.nodes.iter().map(NodeJson::from).collect() }
    }
}

impl From<&NodeShown> for NodeJson {
    fn from(node: &NodeShown) -> NodeJson {
        NodeJson {
            path: node.path.to_string(),
            name: node.name.to_string(),
            kind: node.kind.to_string(),
            depth: node.depth,
            status: node.status.word(),
            ticked: node.is_ticked,
        }
    }
}
