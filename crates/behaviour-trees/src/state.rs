//! The state that a tree needs to continue after a restart, as a line of text. It has the state of each node, and the
//! tree's own time. The values of the blackboard are stored separately (`Blackboard::entries`,
//! `Blackboard::restore`). The performer of the leaves must store their progress.

use std::fmt;

use super::status::Status;
use super::tick::children;
use super::tree::{Live, NodeKind, Tree};

/// The version of the line's format. Lines of another version are refused.
const VERSION: &str = "1";

/// The state of a tree between two ticks. `to_string` writes it as a line of text, and `parse` reads such a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeState {
    /// Identifies the tree. The state of another tree is refused.
    fingerprint: u64,
    clock: u64,
    ticks: u64,
    nodes: Vec<Live>,
}

/// Why a tree cannot resume a state. The tree then stays unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The text is not a written state, or it has another version.
    #[error("this is no state of a tree")]
    Unreadable,
    /// The fingerprint belongs to another tree, or to this tree with a different text in its file.
    #[error("this is the state of another tree, or of this one before it was changed")]
    OtherTree,
    /// In this state, the node with this number would continue at a node that is not its child.
    #[error("node {0} of the tree cannot stand as this state says")]
    Impossible(u32),
}

impl Tree {
    /// The state of the tree after its last tick, without the values of the blackboard.
    #[must_use]
    pub fn state(&self) -> TreeState {
        TreeState { fingerprint: self.fingerprint, clock: self.clock, ticks: self.ticks, nodes: self.live.clone() }
    }

    /// Resumes a state. The next tick is the same as without a restart, with one exception: `WasEntryUpdated` and
    /// similar nodes treat the values of their entries as new. Leaves that were running continue and are not started
    /// again.
    ///
    /// # Errors
    /// If the state belongs to another tree. This tree then stays unchanged.
    pub fn resume(&mut self, state: TreeState) -> Result<(), StateError> {
        if state.fingerprint != self.fingerprint || state.nodes.len() != self.live.len() {
            return Err(StateError::OtherTree);
        }
        for (at, (live, node)) in state.nodes.iter().zip(&self.shape.nodes).enumerate() {
            // The next tick continues at the cursor. A wrong cursor would lead it out of the tree.
            let cursor = live.cursor as usize;
            if cursor != 0 && !children(&self.shape, at, node).any(|child| child == cursor) {
                return Err(StateError::Impossible(u32::try_from(at).unwrap_or(u32::MAX)));
            }
        }
        self.clock = state.clock;
        self.ticks = state.ticks;
        self.live = state.nodes;
        for (live, node) in self.live.iter_mut().zip(&self.shape.nodes) {
            if let NodeKind::BuiltIn(kind) = node.kind
                && kind.looks_at_writes()
            {
                // After a restart, the writes on a blackboard are counted from 0 again.
                live.since = 0;
            }
        }
        Ok(())
    }
}

impl TreeState {
    /// Whether both states belong to one tree and continue in the same way. Times and numbers of attempts may differ.
    #[must_use]
    pub fn stands_as(&self, other: &TreeState) -> bool {
        let standing = |live: &Live| (live.status, live.cursor, live.is_counted, live.has_begun, live.is_spent, live.failures);
        self.fingerprint == other.fingerprint && self.nodes.iter().map(standing).eq(other.nodes.iter().map(standing))
    }
}

impl fmt::Display for TreeState {
    /// Writes `1 fingerprint clock ticks nodes`. For each node that was ever ticked, it adds
    /// `node:status,returned,flags,cursor,count,failures,since,ticked`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{VERSION} {:016x} {} {} {}", self.fingerprint, self.clock, self.ticks, self.nodes.len())?;
        for (at, live) in self.nodes.iter().enumerate().filter(|(_, live)| **live != Live::default()) {
            let flags = u8::from(live.is_counted) + 2 * u8::from(live.has_begun) + 4 * u8::from(live.is_spent);
            write!(f, " {at}:{},{},{flags},{}", live.status.word(), live.returned.word(), live.cursor)?;
            write!(f, ",{},{},{},{}", live.count, live.failures, live.since, live.ticked)?;
        }
        Ok(())
    }
}

impl std::str::FromStr for TreeState {
    type Err = StateError;

    fn from_str(text: &str) -> Result<TreeState, StateError> {
        parsed(text).ok_or(StateError::Unreadable)
    }
}

fn parsed(text: &str) -> Option<TreeState> {
    let mut words = text.split(' ');
    if words.next()? != VERSION {
        return None;
    }
    let fingerprint = u64::from_str_radix(words.next()?, 16).ok()?;
    let (clock, ticks) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let count = words.next()?.parse().ok().filter(|count| *count <= super::tree::MOST_NODES)?;
    let mut nodes = vec![Live::default(); count];
    for word in words {
        let (at, live) = word.split_once(':')?;
        *nodes.get_mut(at.parse::<usize>().ok()?)? = node(live)?;
    }
    Some(TreeState { fingerprint, clock, ticks, nodes })
}

fn node(text: &str) -> Option<Live> {
    let mut fields = text.split(',');
    let status = Status::named(fields.next()?)?;
    let returned = Status::named(fields.next()?)?;
    let flags: u8 = fields.next()?.parse().ok().filter(|flags| *flags < 8)?;
    let live = Live {
        status,
        returned,
        is_counted: flags & 1 != 0,
        has_begun: flags & 2 != 0,
        is_spent: flags & 4 != 0,
        cursor: fields.next()?.parse().ok()?,
        count: fields.next()?.parse().ok()?,
        failures: fields.next()?.parse().ok()?,
        since: fields.next()?.parse().ok()?,
        ticked: fields.next()?.parse().ok()?,
    };
    fields.next().is_none().then_some(live)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::mock::Mocks;
    use crate::{Blackboard, Catalogue, Document, Element};

    fn built(attempts: &str) -> Tree {
        let retry =
            Element::new("RetryUntilSuccessful", vec![Element::new("AlwaysFailure", vec![])]).with("num_attempts", attempts);
        let document = Document::of("T", Element::new("Sequence", vec![Element::new("AlwaysSuccess", vec![]), retry]));
        Tree::build(&document, None, &Catalogue::default(), &mut Blackboard::new()).expect("its names are known")
    }

    fn ticked(tree: &mut Tree) -> Status {
        tree.tick(&mut Blackboard::new(), &mut Mocks::default(), Duration::from_millis(100)).expect("no fault")
    }

    #[test]
    fn a_tree_goes_on_from_its_written_state_where_it_was() {
        let mut first = built("3");
        assert_eq!([ticked(&mut first), ticked(&mut first)], [Status::Running, Status::Running]);
        let kept: TreeState = first.state().to_string().parse().expect("it was written so");
        let mut second = built("3");
        second.resume(kept).expect("it is the same tree");
        assert_eq!(second.clock(), Duration::from_millis(200));
        assert_eq!(ticked(&mut second), Status::Failure, "the third attempt is the last");
    }

    #[test]
    fn a_state_of_another_tree_is_refused() {
        let mut tree = built("3");
        assert_eq!(tree.resume(built("4").state()), Err(StateError::OtherTree));
        assert_eq!("nonsense".parse::<TreeState>(), Err(StateError::Unreadable));
        let text = tree.state().to_string();
        let wrong: TreeState = format!("{text} 0:RUNNING,RUNNING,0,77,0,0,0,1").parse().expect("it is well written");
        assert_eq!(tree.resume(wrong), Err(StateError::Impossible(0)));
        assert!(format!("{text} 9:RUNNING,RUNNING,0,0,0,0,0,1").parse::<TreeState>().is_err(), "there is no node 9");
    }
}
