//! The driving port: how every door gives commands and sees the state. Cheap to clone; hides all channels.

use std::sync::Arc;

use tokio::sync::{mpsc, oneshot, watch};

use super::halt::Halter;
use crate::core::command::{Accepted, Command, Issuer, Refused, Request};
use crate::core::world::snapshot::Snapshot;

/// Commands that wait for the loop: enough for every operator of a site to press at once.
pub const COMMANDS: usize = 256;

/// What is on its way from a door to the loop.
#[derive(Debug)]
pub enum Envelope {
    /// A command, and where its answer goes.
    Command(Request, oneshot::Sender<Result<Accepted, Refused>>),
    /// What a door refused to take from somebody, for the record: who, what was asked for, and why not.
    Refused(Issuer, String, Refused),
}

/// The doors' end: commands in, snapshots out.
#[derive(Clone, Debug)]
pub struct Handle {
    commands: mpsc::Sender<Envelope>,
    snapshots: watch::Receiver<Arc<Snapshot>>,
    halter: Halter,
}

/// The loop has ended; the program is shutting down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("hallsweep is shutting down")]
pub struct Gone;

impl Handle {
    /// A handle over the loop's channels.
    #[must_use]
    pub const fn new(commands: mpsc::Sender<Envelope>, snapshots: watch::Receiver<Arc<Snapshot>>, halter: Halter) -> Handle {
        Handle { commands, snapshots, halter }
    }

    /// Gives a command and waits for its answer. A stop halts the robots before it queues for its record, and when it is answered
    /// it is written down where it outlives the program, if the disk takes it at once (safety S4).
    ///
    /// # Errors
    /// `Gone` when the program is shutting down; the inner result is the core's answer.
    pub async fn give(&self, request: Request) -> Result<Result<Accepted, Refused>, Gone> {
        let request = self.stamp(request);
        let stop = request.epoch.filter(|_| request.command == Command::Stop);
        let (answer, answered) = oneshot::channel();
        self.commands.send(Envelope::Command(request, answer)).await.map_err(|_| Gone)?;
        let answer = answered.await.map_err(|_| Gone)?;
        if let Some(epoch) = stop {
            self.halter.until_noted(epoch).await;
        }
        Ok(answer)
    }

    /// Puts on record that a door refused to take a command from somebody (safety A6).
    ///
    /// # Errors
    /// `Gone` when the program is shutting down.
    pub async fn note_refused(&self, issuer: Issuer, asked: String, refused: Refused) -> Result<(), Gone> {
        self.commands.send(Envelope::Refused(issuer, asked, refused)).await.map_err(|_| Gone)
    }

    /// The newest state.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshots.borrow())
    }

    /// A watch on the state: always the newest, whatever was missed.
    #[must_use]
    pub fn watch(&self) -> watch::Receiver<Arc<Snapshot>> {
        self.snapshots.clone()
    }

    /// A stop carries the epoch it has raised; a movement command without an epoch is stamped with the one that holds now, so
    /// that a stop overtaking it in the queue outdates it.
    fn stamp(&self, mut request: Request) -> Request {
        if request.command == Command::Stop {
            request.epoch = Some(self.halter.stop());
        } else {
            request.arrived = Some(self.halter.watch().now().epoch);
        }
        request
    }
}
