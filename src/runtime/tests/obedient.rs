//! For tests of the doors: a loop without a mission. The loop accepts every command, unless the test sets a refusal.
//! The test can read the commands and refusals that the loop received.

use std::sync::{Arc, Mutex};

use tokio::sync::{mpsc, watch};

use crate::runtime::halt::Halter;
use crate::runtime::handle::{COMMANDS, Envelope, Handle};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Accepted, Command, Issuer, LuggageRef, Request};
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Epoch, LuggageId};

/// A refusal that a door asked to record: the sender, the command and the reason.
pub(crate) type Noted = (Issuer, Asked, Refused);

#[derive(Clone)]
pub(crate) struct Script {
    pub(crate) publish: watch::Sender<Arc<Snapshot>>,
    pub(crate) refuse: Arc<Mutex<Option<Refused>>>,
    pub(crate) given: Arc<Mutex<Vec<Request>>>,
    pub(crate) noted: Arc<Mutex<Vec<Noted>>>,
}

/// Starts a loop with this state. Must be called inside a runtime.
pub(crate) fn obedient(snapshot: Snapshot) -> (Handle, Script) {
    let (commands, envelopes) = mpsc::channel(COMMANDS);
    let publish = watch::Sender::new(Arc::new(snapshot));
    let handle = Handle::new(commands, publish.subscribe(), Halter::new(Epoch(1)));
    let script = Script { publish, refuse: Arc::default(), given: Arc::default(), noted: Arc::default() };
    tokio::spawn(script.clone().obey(envelopes));
    (handle, script)
}

impl Script {
    async fn obey(self, mut envelopes: mpsc::Receiver<Envelope>) {
        while let Some(envelope) = envelopes.recv().await {
            let (request, answer) = match envelope {
                Envelope::Command(request, answer) => (request, answer),
                Envelope::Refused(issuer, asked, refused, answer) => {
                    self.noted.lock().unwrap().push((issuer, asked, refused.clone()));
                    let _ = answer.map(|answer| answer.send(Err(refused)));
                    continue;
                }
                Envelope::Simulated(..) => continue,
                Envelope::PutDown(_, _, _, answer) => {
                    let refused = self.refuse.lock().unwrap().clone();
                    let Snapshot { revision, mission, .. } = &**self.publish.borrow();
                    let accepted = Accepted { revision: *revision, epoch: mission.epoch, luggage: None, is_kept_back: false };
                    let _ = answer.send(refused.map_or(Ok(accepted), Err));
                    continue;
                }
            };
            let snapshot = Arc::clone(&self.publish.borrow());
            let luggage = about(&request.command, &snapshot);
            self.given.lock().unwrap().push(request);
            let refused = self.refuse.lock().unwrap().clone();
            let accepted = Accepted { revision: snapshot.revision, epoch: snapshot.mission.epoch, luggage, is_kept_back: false };
            let _ = answer.send(refused.map_or(Ok(accepted), Err));
        }
    }
}

fn about(command: &Command, snapshot: &Snapshot) -> Option<LuggageId> {
    match command.luggage()? {
        LuggageRef::Id(id) => Some(id),
        LuggageRef::Pending => snapshot.pending().map(|luggage| luggage.id),
    }
}
