//! Messages for clients of the original system: the newest state of robot and map, and every piece of luggage, in
//! this order. Messages are numbered consecutively. `qak::outgoing` writes the messages.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::super::qak::outgoing;
use super::pieces;
use crate::api::old_items::luggage_state;
use crate::doors::update_interval;
use hallsweep_core::robot::RobotState;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, Pose, Revision};
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

/// Minimum time between two rounds of messages, and so between two messages about the robot. HTTP and CoAP use the
/// same interval.
const PACE: Duration = Duration::from_millis(20);

/// Maximum number of pieces in each of the two queues below: the pieces waiting to be published, and the published
/// ones. Fewer pieces are found while the broker is absent for a short time. During a longer absence the oldest
/// pieces are dropped, but the state topic still has those that matter.
const PIECES: usize = 4_096;

#[derive(Default)]
pub(super) struct Old {
    number: u64,
    /// Contents of the last message about the robot. A message with equal contents is not published again.
    robot: Option<(RobotState, Pose)>,
    /// Contents of the last message about the map. A message with equal contents is not published again.
    map: Option<(Revision, Cell)>,
    /// The pieces still to be published, oldest change first.
    luggage: VecDeque<Arc<Luggage>>,
    round: VecDeque<Item>,
    /// Earliest time of the next round. Two rounds begin at least `PACE` apart.
    next: Duration,
    /// Earliest time of the next map. The map is published less often, because each message contains the whole map.
    next_map: Duration,
    /// The last published pieces, each with the number of its message. `renew` queues the unacknowledged ones again.
    said: VecDeque<(u64, Arc<Luggage>)>,
}

enum Item {
    Robot,
    Map,
    Luggage(Arc<Luggage>),
}

impl Old {
    /// Notes which pieces of luggage have changed. In the first state, only the piece shown to old clients counts as
    /// changed.
    pub(super) fn handle_state(&mut self, older: Option<&Snapshot>, newer: &Snapshot) {
        let Some(older) = older else {
            self.luggage.extend(shown(newer).cloned());
            return;
        };
        let differs = |earlier: &Luggage, later: &Luggage| luggage_state(earlier) != luggage_state(later);
        for piece in pieces::changed(older, newer, differs) {
            self.wait(Arc::clone(piece));
        }
    }

    /// Returns when the next message is due: at once during a round, otherwise when the next round may begin. Returns
    /// `None` when everything is published.
    pub(super) fn due(&self, snapshot: &Snapshot) -> Option<Duration> {
        if !self.round.is_empty() {
            return Some(Duration::ZERO);
        }
        let is_news = self.robot != Some(robot_of(snapshot)) || !self.luggage.is_empty();
        let is_other_map = self.map != Some(map_of(snapshot));
        let map = is_other_map.then_some(self.next.max(self.next_map));
        is_news.then_some(self.next).into_iter().chain(map).min()
    }

    pub(super) fn take(&mut self, snapshot: &Snapshot, now: Duration) -> Option<String> {
        if self.round.is_empty() {
            self.begin(snapshot, now);
        }
        let item = self.round.pop_front()?;
        self.number += 1;
        let content = match item {
            Item::Robot => {
                self.robot = Some(robot_of(snapshot));
                outgoing::robot(snapshot)
            }
            Item::Map => {
                self.map = Some(map_of(snapshot));
                let message = outgoing::message(outgoing::room_map(snapshot), self.number);
                self.next_map = now + update_interval::for_size(message.len());
                return Some(message);
            }
            Item::Luggage(piece) => {
                let content = outgoing::luggage(&piece);
                self.said.push_back((self.number, piece));
                bound(&mut self.said);
                content
            }
        };
        Some(outgoing::message(content, self.number))
    }

    /// Prepares for a new connection. The last `unacknowledged` messages count as never sent, and the newest version
    /// of each item is published again.
    pub(super) fn renew(&mut self, unacknowledged: u64, snapshot: Option<&Snapshot>) {
        self.number = self.number.saturating_sub(unacknowledged);
        (self.robot, self.map) = (None, None);
        let unheard = self.said.partition_point(|(number, _)| *number <= self.number);
        let lost = self.said.split_off(unheard).into_iter().map(|(_, piece)| piece);
        let unsaid = self.round.drain(..).filter_map(Item::luggage);
        let again: Vec<Arc<Luggage>> = lost.chain(unsaid).chain(self.luggage.drain(..)).collect();
        for piece in again {
            self.wait(piece);
        }
        if let Some(piece) = snapshot.and_then(shown).filter(|piece| !self.luggage.iter().any(|other| other.id == piece.id)) {
            self.wait(Arc::clone(piece));
        }
    }

    fn begin(&mut self, snapshot: &Snapshot, now: Duration) {
        self.next = now + PACE;
        if self.robot != Some(robot_of(snapshot)) {
            self.round.push_back(Item::Robot);
        }
        if self.map != Some(map_of(snapshot)) && now >= self.next_map {
            self.round.push_back(Item::Map);
        }
        self.round.extend(self.luggage.drain(..).map(Item::Luggage));
    }

    /// Queues a piece. An earlier version of it is removed from the queue.
    fn wait(&mut self, piece: Arc<Luggage>) {
        self.luggage.retain(|other| other.id != piece.id);
        self.luggage.push_back(piece);
        bound(&mut self.luggage);
    }
}

impl Item {
    fn luggage(self) -> Option<Arc<Luggage>> {
        if let Item::Luggage(piece) = self { Some(piece) } else { None }
    }
}

fn robot_of(snapshot: &Snapshot) -> (RobotState, Pose) {
    (snapshot.robot.state, snapshot.robot.pose)
}

/// Contents of a message about the map. The robot's cell belongs to it, because the message shows the robot on the
/// map.
fn map_of(snapshot: &Snapshot) -> (Revision, Cell) {
    (snapshot.revision_of(Resource::Map), snapshot.robot.pose.cell)
}

/// The piece shown to old clients: the one that waits for its verdict, otherwise the last.
fn shown(snapshot: &Snapshot) -> Option<&Arc<Luggage>> {
    snapshot.pending().or(snapshot.luggage.last())
}

fn bound<T>(waiting: &mut VecDeque<T>) {
    if waiting.len() > PIECES {
        waiting.pop_front();
    }
}
