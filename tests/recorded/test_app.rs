//! The program without sockets: core and simulator in simulated time, a store in memory, and a main loop that answers
//! requests through a handle, as the doors use it.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::{mpsc, watch};

use super::doors::{
    COMMANDS, Command, Envelope, Event, Hall, Halter, Handle, MemoryStore, Page, PairSettings, Place, Refused, Run, Seq,
    Settings, SimSettings, Slip, Snapshot, Store, Strategy,
};

/// Name of the sensor in missions that have one.
pub(crate) const SENSOR: &str = "roof";

/// A mission and the handle to it; cheap to clone.
#[derive(Clone)]
pub(crate) struct TestApp {
    pub(crate) hall: Arc<Hall>,
    pub(crate) handle: Handle,
    pub(crate) memory: MemoryStore,
    inside: Arc<Mutex<Inside>>,
}

/// State of the main loop.
pub(crate) struct Inside {
    pub(crate) run: Run,
    /// Refusal that every command gets, if set.
    pub(crate) refuse: Option<Refused>,
    memory: MemoryStore,
    kept: usize,
    publish: watch::Sender<Arc<Snapshot>>,
}

impl TestApp {
    /// App with a robot at home. Must be called inside a runtime.
    pub(crate) fn new(hall: &Arc<Hall>, sim: SimSettings, with_sensor: bool) -> TestApp {
        let run = Run::new(Arc::clone(hall), sim, Settings::default(), Strategy::Snail);
        TestApp::of(hall, run, with_sensor)
    }

    /// App that also has a pair before the entrance; its parcel slips once.
    pub(crate) fn with_pair(hall: &Arc<Hall>, sim: SimSettings) -> TestApp {
        let mut pair = PairSettings { way_out: true, ..PairSettings::new(1, Place::ENTRANCE) };
        pair.mishaps.slips = vec![Slip { parcel: 1, after_steps: 1 }];
        let run = Run::with_pair(Arc::clone(hall), sim, Settings::default(), Strategy::Snail, pair);
        TestApp::of(hall, run, false)
    }

    fn of(hall: &Arc<Hall>, mut run: Run, with_sensor: bool) -> TestApp {
        if with_sensor {
            let now = run.now();
            run.engine.watch_sensor(SENSOR.into(), Duration::from_secs(600), now);
            run.wait(0.0);
        }
        let first = run.state();
        let (commands, envelopes) = mpsc::channel(COMMANDS);
        let publish = watch::Sender::new(Arc::clone(&first));
        let handle = Handle::new(commands, publish.subscribe(), Halter::new(first.mission.epoch));
        let memory = MemoryStore::new();
        let mut inside = Inside { run, refuse: None, memory: memory.clone(), kept: 0, publish };
        inside.publish();
        let inside = Arc::new(Mutex::new(inside));
        tokio::spawn(serve(Arc::clone(&inside), envelopes));
        TestApp { hall: Arc::clone(hall), handle, memory, inside }
    }

    /// Locks the state of the main loop. The guard must not be held across an await.
    pub(crate) fn inside(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().expect("nobody panicked here")
    }

    pub(crate) fn state(&self) -> Arc<Snapshot> {
        self.inside().run.state()
    }

    /// Gives a command directly to the core; returns whether it was accepted.
    pub(crate) fn give(&self, command: Command) -> bool {
        let mut inside = self.inside();
        let is_accepted = inside.run.give(command).is_ok();
        inside.publish();
        is_accepted
    }

    /// Handles an event that the simulator does not cause.
    pub(crate) fn happen(&self, event: Event) {
        let mut inside = self.inside();
        inside.run.happen(event);
        inside.publish();
    }

    /// Handles events until `is_there` is true, then publishes the state to the doors.
    pub(crate) fn until(&self, is_there: impl Fn(&Snapshot) -> bool) {
        let mut inside = self.inside();
        while !is_there(&inside.run.state()) {
            assert!(inside.run.advance(), "nothing more happens");
        }
        inside.publish();
    }

    /// Handles the next timed event; false when there is none.
    pub(crate) fn advance(&self) -> bool {
        let mut inside = self.inside();
        let went_on = inside.run.advance();
        inside.publish();
        went_on
    }
}

async fn serve(inside: Arc<Mutex<Inside>>, mut envelopes: mpsc::Receiver<Envelope>) {
    while let Some(envelope) = envelopes.recv().await {
        inside.lock().expect("nobody panicked here").take(envelope);
    }
}

impl Inside {
    fn take(&mut self, envelope: Envelope) {
        let now = self.run.now();
        match envelope {
            Envelope::Command(_, answer) if self.refuse.is_some() => {
                let _ = answer.send(Err(self.refuse.clone().expect("it was just there")));
            }
            Envelope::Command(request, answer) => {
                if let Some(epoch) = request.epoch.filter(|_| request.command == Command::Stop) {
                    self.run.engine.handle_halt(epoch, now);
                }
                let given = self.run.ask(request);
                self.publish();
                let _ = answer.send(given);
            }
            Envelope::Refused(issuer, asked, refused, answer) => {
                self.run.engine.note_refused(issuer, asked, &refused, 1, now);
                self.run.wait(0.0);
                self.publish();
                let _ = answer.map(|answer| answer.send(Err(refused)));
            }
            // No simulator takes these requests here.
            Envelope::Simulated(..) | Envelope::PutDown(..) => {}
        }
    }

    /// Stores new entries and publishes the state to the doors.
    fn publish(&mut self) {
        let entries = self.run.journal[self.kept..].to_vec();
        if !entries.is_empty() {
            let first = Seq(self.kept as u64 + 1);
            self.kept += entries.len();
            self.memory.record(Page { first, entries, kept_back: None }, 0);
        }
        let state = self.run.state();
        self.publish.send_replace(state);
    }
}
