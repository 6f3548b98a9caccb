//! What is said in the language of the original system: the newest of robot and map, and every piece of luggage, in this order,
//! each message with the next number. How a message is written stands in `qak::outgoing`.

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

/// The least time between two rounds, and so between two messages on the robot: as over HTTP and CoAP.
const PACE: Duration = Duration::from_millis(20);

/// How many pieces wait to be said, and how many are remembered until they are acknowledged: more than are found while a broker is
/// away for a moment. While it is for longer, the oldest give way; the state topic has those that matter still.
const PIECES: usize = 4_096;

#[derive(Default)]
pub(super) struct Old {
    /// The number of the last message.
    number: u64,
    /// What the robot's last item showed.
    robot: Option<(RobotState, Pose)>,
    /// What the map's last item showed.
    map: Option<(Revision, Cell)>,
    /// The pieces still to be said, oldest news first.
    luggage: VecDeque<Arc<Luggage>>,
    round: VecDeque<Item>,
    /// No other round before this,
    next: Duration,
    /// and no other map, which is said whole, before this.
    next_map: Duration,
    /// The pieces that were said, each with the number of its message.
    said: VecDeque<(u64, Arc<Luggage>)>,
}

enum Item {
    Robot,
    Map,
    Luggage(Arc<Luggage>),
}

impl Old {
    /// Notes what is new of the luggage. Of the first state only the piece that an old client would be shown is news.
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

    /// When the next message is due: at once within a round, else when the pace allows a new one.
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

    /// The last `unacknowledged` messages count as never sent, and the newest of each item is said again.
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

    /// A piece waits to be said, in place of an earlier record of it.
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

/// What an item on the robot shows.
fn robot_of(snapshot: &Snapshot) -> (RobotState, Pose) {
    (snapshot.robot.state, snapshot.robot.pose)
}

/// What an item on the map shows: the hall, and the robot in it.
fn map_of(snapshot: &Snapshot) -> (Revision, Cell) {
    (snapshot.revision_of(Resource::Map), snapshot.robot.pose.cell)
}

/// The piece that an old client is shown: the one that waits for its verdict, else the last.
fn shown(snapshot: &Snapshot) -> Option<&Arc<Luggage>> {
    snapshot.pending().or(snapshot.luggage.last())
}

/// The oldest gives way when there are too many.
fn bound<T>(waiting: &mut VecDeque<T>) {
    if waiting.len() > PIECES {
        waiting.pop_front();
    }
}
