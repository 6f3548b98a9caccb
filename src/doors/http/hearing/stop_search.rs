//! What is heard of one connection: its requests one by one, and a STOP given as soon as it has come, be it named by a head or said by
//! a body. How the bytes come, and where they go, is the connection's business.

use super::judge::{Judge, StopRequest};
use super::shared::StopOutcome;
use crate::api::halt::{says_halt, says_halt_from};
use crate::doors::connection_limits::SlotClaim;
use crate::doors::http::scanning::{self, BodyLength, Scanner, names};
use hallsweep_core::command::Request;
use hallsweep_core::units::Epoch;

/// So long a body is looked at whole whenever more of it has come, in bytes: that of a move is a few dozen. So much of a longer one is
/// looked at again with what has come behind it.
const SHORT: usize = 1024;

pub(super) struct StopSearch {
    pub(super) judge: Judge,
    pub(super) scanner: Scanner,
    /// The STOP that the request heard last will be, if its body says so.
    unsaid: Option<Request>,
    /// How much was looked at of what its body says, and how much of it when it was last looked at whole.
    looked: usize,
    looked_whole: usize,
}

/// What has come to its end.
pub(super) enum Heard {
    Head(HeardRequest),
    /// The body of the request whose head was heard last.
    Body,
}

pub(super) struct HeardRequest {
    pub(super) claim: SlotClaim,
    pub(super) has_body: bool,
    pub(super) may_hand_over: bool,
    pub(super) came: Epoch,
}

impl StopSearch {
    pub(super) fn new(judge: Judge) -> StopSearch {
        let scanner = Scanner::new(judge.door.cookie());
        StopSearch { judge, scanner, unsaid: None, looked: 0, looked_whole: 0 }
    }

    /// Takes bytes up to the first that brings something to its end, and says how many it took; a STOP in them was given.
    pub(super) fn take(&mut self, bytes: &[u8]) -> (usize, Option<Heard>, Option<StopOutcome>) {
        let (taken, heard) = self.scanner.take(bytes);
        match heard {
            None => (taken, None, None),
            Some(scanning::Heard::Body) => {
                let given = self.look();
                self.unsaid = None;
                (taken, Some(Heard::Body), given)
            }
            Some(scanning::Heard::Head(head)) => {
                let came = self.judge.door.handle.epoch();
                let (claim, press) = self.judge.hear(&head);
                let (unsaid, given) = match press {
                    None => (None, None),
                    Some(StopRequest::Named(stop)) => (None, Some(self.judge.give(stop))),
                    Some(StopRequest::Unsaid(stop)) => (Some(stop), None),
                };
                self.unsaid = unsaid;
                (self.looked, self.looked_whole) = (0, 0);
                let asked = HeardRequest {
                    claim,
                    has_body: head.body != BodyLength::Known(0),
                    may_hand_over: head.wants_upgrade && names::is_upgrade(&head.path),
                    came,
                };
                (taken, Some(Heard::Head(asked)), given)
            }
        }
    }

    /// The STOP that a body says although it has no end yet: it need not come, and where it is cannot always be told. A long body is
    /// looked at whole whenever it has doubled, so that one in many pieces costs little.
    pub(super) fn look_early(&mut self) -> Option<StopOutcome> {
        let said = self.scanner.said();
        if said.len() == self.looked {
            return None;
        }
        let start = self.looked.saturating_sub(SHORT);
        self.looked = said.len();
        if said.len() <= SHORT || said.len() >= 2 * self.looked_whole {
            self.looked_whole = said.len();
            return self.look();
        }
        self.unsaid.take_if(|_| says_halt_from(said, start)).map(|stop| self.judge.give(stop))
    }

    /// The same, when nothing more comes.
    pub(super) fn look(&mut self) -> Option<StopOutcome> {
        let said = self.scanner.said();
        self.unsaid.take_if(|_| says_halt(said)).map(|stop| self.judge.give(stop))
    }

    /// The number of the request whose head was heard last; the first is 0.
    pub(super) fn number(&self) -> u64 {
        self.scanner.heads().saturating_sub(1)
    }
}

impl Drop for StopSearch {
    /// However the connection ends, be it cut: nothing more comes.
    fn drop(&mut self) {
        drop(self.look());
    }
}
