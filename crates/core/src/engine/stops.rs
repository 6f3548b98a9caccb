//! The answers to STOP, and the records of STOPs. Each answer waits until the robot stands, but only for a short time
//! (safety S8). Each STOP of a sender gets its own entry. If a sender sends more than a few per second, the STOPs
//! share entries. Endless STOPs therefore cannot fill the store (safety A5, A6). The halt itself was sent before, and
//! waits for nothing.

use std::collections::VecDeque;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use super::Engine;
use super::coalesced_entries::{CoalescedEntries, CoalescedEntry, CoalescingLimits, Sender};
use crate::asked::Asked;
use crate::command::{Command, CommandId, Issuer, OPERATOR, Request};
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::units::{Epoch, Ticket, WallTime};

/// A person presses STOP less often than these limits allow, and a disk can write more entries. `senders` limits how
/// many recent senders are counted separately.
const RECORDS: CoalescingLimits =
    CoalescingLimits { burst: 20, earned: Duration::from_millis(200), every: Duration::from_secs(1), senders: 128 };

/// Maximum time that the answer to a stop waits for the robot's report that it stands.
const PATIENCE: Duration = Duration::from_millis(100);

/// Time within which a STOP with the same id counts as the same press of the button. A web page that gets no answer
/// sends its STOP again. If the robot was released in between, the STOP counts as a new press.
const SAME_PRESS: Duration = Duration::from_secs(60);

/// Maximum number of remembered presses with an id. This exceeds the number of web pages that people have open. At
/// the limit, the oldest press is forgotten.
const PRESSES: usize = 128;

#[derive(Clone, Debug)]
pub(super) struct Stops {
    /// The waiting answers, oldest first, each with the time by which it must be sent. The interfaces limit their
    /// number, because each answer belongs to a sender that waits.
    waiting: Vec<(Ticket, Duration)>,
    /// When the next order may be given, if it was delayed because of an answer.
    put_off: Option<Duration>,
    pub(super) records: CoalescedEntries<StopRequest>,
    /// The remembered presses, oldest first.
    named: VecDeque<Named>,
}

#[derive(Clone, Debug)]
struct Named {
    who: Arc<str>,
    id: CommandId,
    epoch: Epoch,
    at: Duration,
}

#[derive(Clone, Debug)]
pub(super) struct StopRequest {
    issuer: Issuer,
    id: Option<CommandId>,
    wall: WallTime,
}

impl Default for Stops {
    fn default() -> Stops {
        Stops { waiting: Vec::new(), put_off: None, records: CoalescedEntries::new(RECORDS), named: VecDeque::new() }
    }
}

impl Stops {
    pub(super) fn due(&self) -> Option<Duration> {
        self.waiting.first().map(|(_, due)| *due).into_iter().chain(self.put_off).chain(self.records.due()).min()
    }
}

impl Engine {
    /// Answers a stop when every robot stands, or `PATIENCE` later.
    pub(super) fn answer_when_standing(&mut self, ticket: Ticket) {
        if self.robots.are_halting() {
            self.stops.waiting.push((ticket, self.now.since_start.saturating_add(PATIENCE)));
        } else {
            self.answer(ticket, None);
        }
    }

    /// Gives the next order, if there is one. If stops are answered now, the order is delayed, so that the robot
    /// still stands in the revision that these answers name.
    pub(super) fn go_on(&mut self) {
        self.stops.put_off = None;
        if self.stops.waiting.is_empty() || self.robots.are_halting() {
            return self.pump();
        }
        self.stops.put_off = Some(self.now.since_start);
        for (ticket, _) in std::mem::take(&mut self.stops.waiting) {
            self.answer(ticket, None);
        }
    }

    pub(super) fn answer_overdue_stops(&mut self) {
        let now = self.now.since_start;
        let overdue = self.stops.waiting.iter().take_while(|(_, due)| *due <= now).count();
        for (ticket, _) in self.stops.waiting.drain(..overdue).collect::<Vec<_>>() {
            self.answer(ticket, None);
        }
    }

    /// Records `count` stops of one sender, now or together with other stops of the same sender.
    pub(super) fn record_stop(&mut self, request: &Request, count: u64) {
        if count == 1 && self.is_same_press(request) {
            return;
        }
        let stop_request = StopRequest { issuer: request.issuer.clone(), id: request.id.clone(), wall: self.now.wall };
        let due = self.stops.records.come(sender(&request.issuer), stop_request, count, self.now.since_start);
        self.write_stops(due);
    }

    /// Whether the press of this stop is recorded already. If not, the press is remembered.
    fn is_same_press(&mut self, request: &Request) -> bool {
        let (Some(id), Some(epoch)) = (&request.id, request.epoch) else { return false };
        let (at, released, named) = (self.now.since_start, self.released, &mut self.stops.named);
        let is_over = |epoch| released.is_some_and(|released| released >= epoch);
        named.retain(|stop_request| at.saturating_sub(stop_request.at) < SAME_PRESS && !is_over(stop_request.epoch));
        let who = request.issuer.key();
        let is_known = named.iter().any(|stop_request| stop_request.who == who && stop_request.id == *id);
        if !is_known {
            named.push_back(Named { who, id: id.clone(), epoch, at });
        }
        if named.len() > PRESSES {
            named.pop_front();
        }
        is_known
    }

    pub(super) fn write_stops(&mut self, stops: impl IntoIterator<Item = CoalescedEntry<StopRequest>>) {
        for CoalescedEntry { last: StopRequest { issuer, id, wall }, count, lasted } in stops {
            // The time is stored in whole milliseconds.
            let within = (!lasted.is_zero()).then(|| Duration::new(lasted.as_secs(), lasted.subsec_millis() * 1_000_000));
            let (issuer, id, asked) = if count == 1 {
                (issuer, id, Asked::Command(Command::Stop))
            } else {
                // Several people may share a key, so only the name of the key is written.
                (Issuer { who: issuer.key(), ..issuer }, None, Asked::Stops { count, within })
            };
            let said = Said::Asked { asked: asked.clone(), meant: None, issuer: issuer.clone(), refused: None };
            self.world.write(wall, Tone::Info, said);
            let fact = Fact::Command { issuer, id, asked, epoch: None, luggage: None, refused: None };
            self.outbox.record_command(wall, fact, None);
        }
    }
}

/// Returns the name that distinguishes this sender from others. A sender on this machine that has no name is
/// distinguished by its address.
fn sender(issuer: &Issuer) -> Sender {
    let is_here = issuer.from.parse().is_ok_and(|address: IpAddr| address.is_loopback());
    let name = if is_here && *issuer.who == *OPERATOR { Arc::clone(&issuer.from) } else { issuer.key() };
    (name, issuer.door)
}
