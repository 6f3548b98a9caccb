//! The log of a tree's ticks. It has only the changes of each tick. The state of every node and entry at that time
//! can be calculated from them. Other code stores and shows the log.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use super::blackboard::Blackboard;
use super::status::Status;
use super::tree::{NodeId, NodeView, Tree};
use super::value::Value;

/// Maximum number of changes in a log. This is about one hour of a tree with ten ticks a second, if ten nodes change
/// in each tick. Older changes are merged into the state before the oldest remaining tick.
pub const MOST_CHANGES: usize = 360_000;

/// A node's state after a tick. It differs from the returned status if the parent has reset the node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeState {
    /// The status after the tick. It is IDLE if the parent has reset the node, even if the node returned another
    /// status.
    pub after: Status,
    /// The status returned in the tick; `None` if the node was not ticked.
    pub returned: Option<Status>,
}

/// The changes of one tick since the previous record.
#[derive(Clone, Debug, PartialEq)]
pub struct TickRecord {
    /// The number of the tick, counted from 1.
    pub tick: u64,
    /// The time of the tick on the clock of the log's owner. The tree's own time is paused while the tree is not
    /// ticked.
    pub at: Duration,
    /// Nodes whose state differs from their state in the previous record.
    pub nodes: Vec<(NodeId, NodeState)>,
    /// Entries whose value differs from their value in the previous record, no matter who wrote them. `None` if the
    /// entry has no value any more.
    pub entries: Vec<(Arc<str>, Option<Value>)>,
}

impl TickRecord {
    fn changes(&self) -> usize {
        // A tick without changes needs space as well.
        1 + self.nodes.len() + self.entries.len()
    }
}

/// The whole state after one tick, computed from all changes up to this tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoggedTick {
    /// The state of each node. The index is the number of the node.
    pub nodes: Vec<NodeState>,
    /// The value of each entry that has one.
    pub entries: BTreeMap<Arc<str>, Value>,
}

type Changes = (Vec<(NodeId, NodeState)>, Vec<(Arc<str>, Option<Value>)>);

impl LoggedTick {
    fn of(tree: &Tree, blackboard: &Blackboard) -> LoggedTick {
        let held = blackboard.entries().filter_map(|entry| Some((Arc::from(entry.name()), entry.value()?.clone())));
        let standing = |node: NodeView<'_>| NodeState { after: node.after, returned: node.returned };
        LoggedTick { nodes: tree.nodes().map(standing).collect(), entries: held.collect() }
    }

    fn changes(&self, other: &LoggedTick) -> Changes {
        let before = self.nodes.iter().copied().chain(std::iter::repeat(NodeState::default()));
        let nodes = (0..).map(NodeId).zip(other.nodes.iter().copied()).zip(before);
        let nodes = nodes.filter(|((_, now), before)| now != before).map(|(node, _)| node).collect();
        let gone = self.entries.keys().filter(|name| !other.entries.contains_key(*name)).map(|name| (Arc::clone(name), None));
        let held = other.entries.iter().filter(|(name, value)| self.entries.get(*name) != Some(*value));
        let held = held.map(|(name, value)| (Arc::clone(name), Some(value.clone())));
        (nodes, gone.chain(held).collect())
    }

    fn apply(&mut self, record: &TickRecord) {
        for (node, standing) in &record.nodes {
            let at = node.0 as usize;
            if at >= self.nodes.len() {
                self.nodes.resize(at + 1, NodeState::default());
            }
            self.nodes[at] = *standing;
        }
        for (name, value) in &record.entries {
            match value {
                Some(value) => self.entries.insert(name.clone(), value.clone()),
                None => self.entries.remove(name),
            };
        }
    }
}

/// The latest ticks of one tree, with a limit on the number of changes.
#[derive(Clone, Debug)]
pub struct TickLog {
    most: usize,
    changes: usize,
    /// The state before the oldest record.
    before: LoggedTick,
    /// The state after the last record.
    last: LoggedTick,
    records: VecDeque<TickRecord>,
}

impl Default for TickLog {
    fn default() -> TickLog {
        TickLog::new(MOST_CHANGES)
    }
}

impl TickLog {
    /// Creates a log with room for at most this many changes. Each tick counts as one additional change.
    #[must_use]
    pub fn new(most: usize) -> TickLog {
        TickLog { most, changes: 0, before: LoggedTick::default(), last: LoggedTick::default(), records: VecDeque::new() }
    }

    /// Records the changes of the tree's last tick, with the time of that tick. Call this after each tick, even if
    /// the tick ended with a fault. If the tick is recorded already, nothing happens. The changes are those since the
    /// previous record, even if the tree was resumed from a state in between.
    pub fn note(&mut self, tree: &Tree, blackboard: &Blackboard, at: Duration) {
        if self.records.back().map_or(0, |last| last.tick) == tree.ticks() {
            return;
        }
        let moment = LoggedTick::of(tree, blackboard);
        let (nodes, entries) = self.last.changes(&moment);
        self.last = moment;
        self.push(TickRecord { tick: tree.ticks(), at, nodes, entries });
    }

    fn push(&mut self, record: TickRecord) {
        self.changes += record.changes();
        self.records.push_back(record);
        while self.changes > self.most
            && self.records.len() > 1
            && let Some(oldest) = self.records.pop_front()
        {
            self.changes -= oldest.changes();
            self.before.apply(&oldest);
        }
    }

    /// The remaining ticks, oldest first.
    pub fn records(&self) -> impl Iterator<Item = &TickRecord> {
        self.records.iter()
    }

    /// The state after this tick; `None` if the tick is not in the log.
    #[must_use]
    pub fn moment(&self, tick: u64) -> Option<LoggedTick> {
        let first = self.records.front()?.tick;
        let last = self.records.back()?.tick;
        if !(first..=last).contains(&tick) {
            return None;
        }
        let mut moment = self.before.clone();
        moment.nodes.resize(self.last.nodes.len().max(moment.nodes.len()), NodeState::default());
        self.records.iter().take_while(|record| record.tick <= tick).for_each(|record| moment.apply(record));
        Some(moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mock::Mocks;
    use crate::{Catalogue, xml};

    const FILE: &str = r#"<root BTCPP_format="4"><BehaviorTree ID="T"><Repeat num_cycles="-1"><Sequence>
        <Script code="n := 1; n += 1"/><Work/><AlwaysFailure _skipIf="n == 2"/></Sequence></Repeat></BehaviorTree></root>"#;

    /// Returns a log with room for `most` changes, and the real state after each of 30 ticks.
    fn logged(most: usize) -> (TickLog, Vec<LoggedTick>) {
        let document = xml::read(FILE).expect("it is a good file");
        let mut mocks = Mocks::default();
        mocks.add("Work=RUNNING*2,SUCCESS,RUNNING,SUCCESS").expect("it is well written");
        let catalogue = mocks.catalogue(&document, Catalogue::default());
        let mut blackboard = Blackboard::new();
        let mut tree = Tree::build(&document, None, &catalogue, &mut blackboard).expect("its names are known");
        let mut log = TickLog::new(most);
        let mut moments = Vec::new();
        for _ in 0..30 {
            tree.tick(&mut blackboard, &mut mocks, Duration::from_millis(100)).expect("no fault");
            log.note(&tree, &blackboard, tree.clock());
            moments.push(LoggedTick::of(&tree, &blackboard));
        }
        (log, moments)
    }

    #[test]
    fn every_tick_can_be_shown_again_from_its_changes() {
        let (log, moments) = logged(MOST_CHANGES);
        for (tick, moment) in (1..).zip(&moments) {
            assert_eq!(log.moment(tick).as_ref(), Some(moment), "tick {tick}");
        }
        assert_eq!((log.moment(0), log.moment(31)), (None, None));
        assert!(log.records().any(|record| record.nodes.is_empty()), "a tick like the one before changes nothing");
    }

    #[test]
    fn a_log_that_is_full_forgets_its_oldest_ticks_and_shows_the_others_as_they_were() {
        let (log, moments) = logged(20);
        let left: Vec<u64> = log.records().map(|record| record.tick).collect();
        assert!(left.len() < 30 && left.last() == Some(&30), "{left:?}");
        assert_eq!(log.moment(left[0] - 1), None);
        for tick in left {
            let at = usize::try_from(tick).expect("it is small") - 1;
            assert_eq!(log.moment(tick).as_ref(), Some(&moments[at]), "tick {tick}");
        }
    }
}
