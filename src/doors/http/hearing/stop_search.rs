//! Finds the requests of one connection, and carries out a STOP as soon as it has come, whether a head names it or a body says
//! it. `connection` reads the bytes and passes them on.

use super::judge::{Judge, StopRequest};
use super::shared::StopOutcome;
use crate::api::halt::{says_halt, says_halt_from};
use crate::doors::connection_limits::SlotClaim;
use crate::doors::http::scanning::{self, BodyLength, Scanner, names};
use hallsweep_core::command::Request;
use hallsweep_core::units::Epoch;

/// Length up to which a body is searched whole whenever more of it comes, in bytes: the body of a move is a few dozen. This much
/// of a longer body is searched again together with what has come after it.
const SHORT: usize = 1024;

pub(super) struct StopSearch {
    pub(super) judge: Judge,
    pub(super) scanner: Scanner,
    /// The STOP that the last request is if its body says so.
    unsaid: Option<Request>,
    /// Number of bytes of the body that were searched.
    looked: usize,
    /// Length of the body when it was last searched whole, in bytes.
    looked_whole: usize,
}

/// The part of a request that is complete.
pub(super) enum Heard {
    Head(HeardRequest),
    /// The body of the last request.
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

    /// Reads up to the first byte that completes a part, and returns the number of bytes. A STOP in them is carried out.
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

    /// Carries out a STOP that an incomplete body says: the end of a body need not come, and cannot always be found. A long body
    /// is searched whole whenever it has doubled, so that one in many pieces costs little.
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

    /// Carries out a STOP that the body says, when nothing more of it comes.
    pub(super) fn look(&mut self) -> Option<StopOutcome> {
        let said = self.scanner.said();
        self.unsaid.take_if(|_| says_halt(said)).map(|stop| self.judge.give(stop))
    }

    /// Number of the last request; the first is 0.
    pub(super) fn number(&self) -> u64 {
        self.scanner.heads().saturating_sub(1)
    }
}

impl Drop for StopSearch {
    /// Nothing more comes, however the connection has ended.
    fn drop(&mut self) {
        drop(self.look());
    }
}
