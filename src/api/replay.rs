//! The recorded ticks of behaviour trees. They are written as JSON with the changes of each tick, and shown as the
//! state at any moment. `static/trees.js` shows the ticks. Other data about a run, such as the events of a retrieval,
//! is not here.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use schemars::JsonSchema;
use serde::Serialize;

use super::vocabulary;
use behaviour_trees::log::NodeState;
use behaviour_trees::{TickLog, Tree};
use hallsweep_core::snapshot::retrieval::{NodeShown, TreeView, TreesView};

/// Ticks of behaviour trees that share one blackboard.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ReplayJson {
    /// Trees, in the order in which they are ticked.
    pub trees: Vec<TreeLogJson>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TreeLogJson {
    pub id: String,
    /// Nodes of the tree, in preorder.
    pub nodes: Vec<NodeLabelJson>,
    /// Recorded ticks, oldest first.
    pub ticks: Vec<TickJson>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NodeLabelJson {
    pub path: String,
    pub name: String,
    pub kind: String,
    pub depth: usize,
}

/// Changes by one tick. The first tick of a list has the whole state after that tick instead.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TickJson {
    /// Time since the run began, in seconds.
    pub t: f64,
    /// The number of the tick, counted from 1.
    pub tick: u64,
    /// For each changed node: its index in the `nodes` of the tree, its status, and whether the node was ticked.
    #[schemars(with = "Vec<(usize, vocabulary::NodeStatus, bool)>")]
    pub nodes: Vec<(usize, &'static str, bool)>,
    /// Changed entries of the blackboard, written as in a tree file; null for an entry that is empty now.
    pub entries: BTreeMap<String, Option<String>>,
}

impl ReplayJson {
    pub fn new<'a>(logged: impl IntoIterator<Item = (&'a Tree, &'a TickLog)>) -> ReplayJson {
        ReplayJson { trees: logged.into_iter().map(|(tree, log)| TreeLogJson::new(tree, log)).collect() }
    }

    /// Returns the times of all ticks in seconds, in ascending order and without duplicates.
    pub fn moments(&self) -> Vec<f64> {
        let mut moments: Vec<f64> = self.trees.iter().flat_map(|tree| &tree.ticks).map(|tick| tick.t).collect();
        moments.sort_by(f64::total_cmp);
        moments.dedup();
        moments
    }

    /// Returns the state of all trees `t` seconds after the run began.
    pub fn shown(&self, t: f64) -> TreesView {
        let mut entries = BTreeMap::new();
        let mut ticks: Vec<&TickJson> = self.trees.iter().flat_map(|tree| tree.up_to(t)).collect();
        ticks.sort_by(|one, other| one.t.total_cmp(&other.t));
        for (name, value) in ticks.iter().flat_map(|tick| &tick.entries) {
            match value {
                Some(value) => entries.insert(Arc::from(name.as_str()), value.clone()),
                None => entries.remove(name.as_str()),
            };
        }
        TreesView {
            ticks: ticks.iter().map(|tick| tick.tick).max().unwrap_or(0),
            trees: self.trees.iter().map(|tree| tree.shown(t)).collect(),
            blackboard: entries.into_iter().collect(),
        }
    }
}

impl TreeLogJson {
    fn new(tree: &Tree, log: &TickLog) -> TreeLogJson {
        let label = |node: behaviour_trees::NodeView<'_>| NodeLabelJson {
            path: node.path.to_owned(),
            name: node.name.to_owned(),
            kind: node.id.to_owned(),
            depth: node.depth,
        };
        let mut ticks: Vec<TickJson> = log.records().map(TickJson::from).collect();
        // A full log has dropped its oldest changes. So the first tick that is left gets the whole state after this
        // tick.
        if let Some((first, stood)) = ticks.first_mut().and_then(|first| Some((log.moment(first.tick)?, first))) {
            stood.nodes =
                first.nodes.iter().enumerate().filter(|(_, node)| **node != NodeState::default()).map(changed).collect();
            stood.entries = first.entries.iter().map(|(name, value)| (name.to_string(), Some(value.to_string()))).collect();
        }
        TreeLogJson { id: tree.id().to_owned(), nodes: tree.nodes().map(label).collect(), ticks }
    }

    fn up_to(&self, t: f64) -> impl Iterator<Item = &TickJson> {
        self.ticks.iter().take_while(move |tick| tick.t <= t)
    }

    fn shown(&self, t: f64) -> TreeView {
        let idle = |label: &NodeLabelJson| NodeShown {
            path: Arc::from(label.path.as_str()),
            name: Arc::from(label.name.as_str()),
            kind: Arc::from(label.kind.as_str()),
            depth: label.depth,
            status: Default::default(),
            is_ticked: false,
        };
        let mut nodes: Vec<NodeShown> = self.nodes.iter().map(idle).collect();
        for (index, status, is_ticked) in self.up_to(t).flat_map(|tick| &tick.nodes) {
            if let Some((node, status)) = nodes.get_mut(*index).zip(behaviour_trees::Status::named(status)) {
                (node.status, node.is_ticked) = (status, *is_ticked);
            }
        }
        TreeView { id: Arc::from(self.id.as_str()), nodes }
    }
}

impl From<&behaviour_trees::log::TickRecord> for TickJson {
    fn from(record: &behaviour_trees::log::TickRecord) -> TickJson {
        let nodes = record.nodes.iter().map(|(node, standing)| changed((node.0 as usize, standing)));
        let held = record.entries.iter().map(|(name, value)| (name.to_string(), value.as_ref().map(ToString::to_string)));
        TickJson { t: seconds(record.at), tick: record.tick, nodes: nodes.collect(), entries: held.collect() }
    }
}

/// The index of a node, its status, and whether it was ticked. The status of a ticked node is the result of its tick.
fn changed((index, standing): (usize, &NodeState)) -> (usize, &'static str, bool) {
    (index, standing.returned.unwrap_or(standing.after).word(), standing.returned.is_some())
}

/// Converts to seconds, rounded to a hundredth. Nobody sees smaller differences.
pub fn seconds(since: Duration) -> f64 {
    (since.as_secs_f64() * 100.0).round() / 100.0
}
