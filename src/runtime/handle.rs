//! The handle through which every door sends commands and sees the state (the driving port). Cheap to clone; hides
//! all channels.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::{mpsc, oneshot, watch};

use super::figures::Figures;
use super::halt::Halter;
use super::overflow::{Decision, OverflowIn, OverflowOut, overflow};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Issuer, Request};
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::simulated::Simulated;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::Venue;
use hallsweep_core::units::Epoch;

/// Capacity of the loop's queue. It is enough if every operator of a site sends a command at once.
pub const COMMANDS: usize = 256;

/// Queue length from which on stops are counted outside the queue. So a flood of stops leaves 32 places for other
/// commands.
const LEFT_BY_STOPS: usize = COMMANDS - 32;

#[derive(Debug)]
pub enum Envelope {
    Command(Request, oneshot::Sender<Decision>),
    /// A refusal by a door, to be recorded: the sender, the command and the reason. If a caller waits until the
    /// refusal is recorded, the channel tells this caller.
    Refused(Issuer, Asked, Refused, Option<oneshot::Sender<Decision>>),
    Simulated(Issuer, Simulated),
    PutDown(Issuer, Venue, Vec<RobotId>, oneshot::Sender<Decision>),
}

#[derive(Clone, Debug)]
pub struct Handle {
    commands: mpsc::Sender<Envelope>,
    snapshots: watch::Receiver<Arc<Snapshot>>,
    halter: Halter,
    overflow: OverflowIn,
    releases: Arc<AtomicU64>,
}

/// The loop has ended because the program is shutting down. `Display` is the message for a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("hallsweep is shutting down and has halted the robot: try again when hallsweep runs again")]
pub struct Gone;

pub type CommandOutcome = Result<Decision, Gone>;

/// A command that found the queue full, and waits for a free place.
struct QueuedCommand {
    commands: mpsc::Sender<Envelope>,
    envelope: Envelope,
}

impl Handle {
    /// A handle to a loop that reads only the queue of commands.
    pub fn new(commands: mpsc::Sender<Envelope>, snapshots: watch::Receiver<Arc<Snapshot>>, halter: Halter) -> Handle {
        Handle::with_overflow(commands, snapshots, halter).0
    }

    pub(super) fn with_overflow(
        commands: mpsc::Sender<Envelope>,
        snapshots: watch::Receiver<Arc<Snapshot>>,
        halter: Halter,
    ) -> (Handle, OverflowOut) {
        let (overflow, out) = overflow();
        (Handle { commands, snapshots, halter, overflow, releases: Arc::default() }, out)
    }

    #[cfg(test)]
    pub(super) const fn halter(&self) -> &Halter {
        &self.halter
    }

    /// Waits until the loop has ended.
    pub async fn ended(&self) {
        self.commands.closed().await;
    }

    /// Sends a command. The command is stamped and queued immediately: commands stay in order, and a stop halts the
    /// robots even if the future is dropped. The future yields the answer. The answer to a stop waits until the robot
    /// stands and the stop is on disk, but not longer than a tenth of a second (safety S4, S8). If the queue is full,
    /// the future waits for a free place; a stop never waits for a place. Must be called inside a runtime.
    #[must_use = "the command is given; whether it was accepted is said by the future"]
    pub fn give(&self, request: Request) -> impl Future<Output = CommandOutcome> + Send + use<> {
        let request = self.stamp(request);
        let stop = request.epoch.filter(|_| request.command == Command::Stop);
        let (answer, answered) = oneshot::channel();
        let waiting = self.queue(request, answer);
        let halter = self.halter.clone();
        async move {
            if let Some(QueuedCommand { commands, envelope }) = waiting {
                commands.send(envelope).await.map_err(|_| Gone)?;
            }
            let noted = async {
                if let Some(epoch) = stop {
                    halter.until_noted(epoch).await;
                }
            };
            // A stop waits for the robot and for the record. Both waits are bounded, and neither depends on the
            // other.
            let (answer, ()) = tokio::join!(answered, noted);
            answer.map_err(|_| Gone)
        }
    }

    /// Records that a door refused a command (safety A6), and waits until the refusal is on record. Does not wait
    /// while nothing can be recorded, or if the refusal shares a journal entry with other refusals.
    pub async fn note_refused(&self, issuer: Issuer, asked: Asked, refused: Refused) -> Result<(), Gone> {
        let (answer, answered) = oneshot::channel();
        let note = Envelope::Refused(issuer, asked, refused, Some(answer));
        self.commands.send(note).await.map_err(|_| Gone)?;
        answered.await.map(drop).map_err(|_| Gone)
    }

    /// Like `note_refused`, for callers that cannot wait. If the queue is full, refusals are counted by sender. For
    /// each sender, the last refusal is recorded, with the number of refusals.
    pub fn note_refused_at_once(&self, issuer: Issuer, asked: Asked, refused: Refused) {
        let note = Envelope::Refused(issuer, asked, refused, None);
        if let Err(TrySendError::Full(Envelope::Refused(issuer, asked, refused, _))) = self.commands.try_send(note) {
            self.overflow.put_refusal(issuer, asked, refused);
        }
    }

    pub async fn note_simulated(&self, issuer: Issuer, simulated: Simulated) -> Result<(), Gone> {
        self.commands.send(Envelope::Simulated(issuer, simulated)).await.map_err(|_| Gone)
    }

    /// Asks to put these simulated robots into a hall, and waits until the move is on record. The robots count as
    /// unreachable until they report from the new hall.
    pub async fn put_down(&self, issuer: Issuer, venue: Venue, robots: Vec<RobotId>) -> CommandOutcome {
        let (answer, answered) = oneshot::channel();
        self.commands.send(Envelope::PutDown(issuer, venue, robots, answer)).await.map_err(|_| Gone)?;
        answered.await.map_err(|_| Gone)
    }

    /// The epoch of the last stop. Commands that arrive now belong to this epoch.
    pub fn epoch(&self) -> Epoch {
        self.halter.watch().now().epoch
    }

    /// Number of commands sent so far, at all doors, that can release a halted robot. A door may read this number
    /// before it sends a STOP and again later. If the number is the same, no robot was released in between.
    pub fn releases(&self) -> u64 {
        self.releases.load(Ordering::SeqCst)
    }

    pub fn figures(&self) -> &Figures {
        self.halter.figures()
    }

    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshots.borrow())
    }

    pub fn watch(&self) -> watch::Receiver<Arc<Snapshot>> {
        self.snapshots.clone()
    }

    /// Queues a command if there is room, and otherwise returns it. A stop that finds no room is counted outside the
    /// queue, and is recorded even if nobody waits for its answer. If the loop has ended, the command and the channel
    /// for its answer are dropped.
    fn queue(&self, request: Request, answer: oneshot::Sender<Decision>) -> Option<QueuedCommand> {
        let is_stop = request.command == Command::Stop;
        let beside = |request, answer| if is_stop { self.overflow.put_stop(request, answer) } else { Some((request, answer)) };
        let has_room = self.commands.capacity() > LEFT_BY_STOPS;
        let (request, answer) = if has_room { (request, answer) } else { beside(request, answer)? };
        match self.commands.try_send(Envelope::Command(request, answer)) {
            // Other senders may have filled the queue in between.
            Err(TrySendError::Full(Envelope::Command(request, answer))) => {
                let (request, answer) = beside(request, answer)?;
                Some(QueuedCommand { commands: self.commands.clone(), envelope: Envelope::Command(request, answer) })
            }
            Ok(())
            | Err(
                TrySendError::Full(Envelope::Refused(..) | Envelope::Simulated(..) | Envelope::PutDown(..))
                | TrySendError::Closed(_),
            ) => None,
        }
    }

    /// Stamps a command with its epoch. A stop gets the epoch that it raises. Any other command gets the epoch in
    /// which it arrived, or the present epoch if its door gave none. So a stop that overtakes the command makes the
    /// command outdated.
    fn stamp(&self, mut request: Request) -> Request {
        if request.command == Command::Stop {
            // A stop belongs to the epoch that it raises, even if its door received it earlier.
            (request.epoch, request.arrived) = (Some(self.halter.stop()), None);
        } else {
            // The door may have received the command before the last stop.
            let now = self.epoch();
            request.arrived = Some(request.arrived.map_or(now, |arrived| arrived.min(now)));
        }
        if request.command.releases() {
            // The command is counted only after the epoch was read. A STOP from a door that has read the new count
            // therefore makes the command outdated.
            self.releases.fetch_add(1, Ordering::SeqCst);
        }
        request
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::tests::within::within;
    use hallsweep_core::command::{Door, Move};
    use hallsweep_core::engine::Engine;
    use hallsweep_core::settings::Settings;
    use hallsweep_core::units::Epoch;

    /// A handle to a loop that does not run, with the loop's queue.
    fn handle() -> (Handle, mpsc::Receiver<Envelope>, Halter) {
        let (handle, envelopes, halter, _) = handle_with_overflow();
        (handle, envelopes, halter)
    }

    fn handle_with_overflow() -> (Handle, mpsc::Receiver<Envelope>, Halter, OverflowOut) {
        let (commands, envelopes) = mpsc::channel(COMMANDS);
        let halter = Halter::new(Epoch(4));
        let (_, snapshots) = watch::channel(Engine::new(Settings::default(), Default::default(), "test".into()).snapshot());
        let (handle, overflow) = Handle::with_overflow(commands, snapshots, halter.clone());
        (handle, envelopes, halter, overflow)
    }

    fn request(command: Command) -> Request {
        Request::new(command, Issuer::operator(Door::LOCAL))
    }

    fn next(envelopes: &mut mpsc::Receiver<Envelope>) -> Option<Request> {
        match envelopes.try_recv().ok()? {
            Envelope::Command(request, _) => Some(request),
            Envelope::Refused(..) | Envelope::Simulated(..) | Envelope::PutDown(..) => panic!("nothing but commands is given"),
        }
    }

    /// Safety S1: commands that can release a robot are counted when they are sent, at whatever door.
    #[tokio::test]
    async fn what_can_let_a_robot_go_is_counted_when_it_is_given_and_at_whatever_door() {
        let (handle, _envelopes, _) = handle();
        let other_door = handle.clone();
        for (command, count) in [
            (Command::Stop, 0),
            (Command::Start, 1),
            (Command::ChooseStrategy(Default::default()), 1),
            (Command::Move(Move::Forward), 2),
            (Command::Reset, 3),
            (Command::Stop, 3),
        ] {
            drop(other_door.give(request(command.clone())));
            assert_eq!(handle.releases(), count, "{command:?}");
        }
    }

    #[tokio::test]
    async fn commands_keep_the_order_in_which_they_were_given() {
        let (handle, mut envelopes, _) = handle();
        let given = [Command::Start, Command::Move(Move::Forward), Command::BackHome];
        let answers: Vec<_> = given.iter().map(|command| handle.give(request(command.clone()))).collect();
        let came: Vec<Command> = std::iter::from_fn(|| next(&mut envelopes)).map(|request| request.command).collect();
        assert_eq!(came, given);
        drop(answers);
    }

    /// Safety S1, S4: a stop halts when it is sent, and makes all commands sent before it outdated.
    #[tokio::test]
    async fn a_stop_halts_when_it_is_given_and_outdates_what_was_given_before() {
        let (handle, mut envelopes, halter) = handle();
        let (started, stopped) = (handle.give(request(Command::Start)), handle.give(request(Command::Stop)));
        assert_eq!((halter.watch().now().epoch, halter.watch().now().count), (Epoch(5), 1));
        assert_eq!(next(&mut envelopes).and_then(|start| start.arrived), Some(Epoch(4)));
        assert_eq!(next(&mut envelopes).and_then(|stop| stop.epoch), Some(Epoch(5)));
        drop((started, stopped));
    }

    /// Safety S4: a command belongs to the epoch that its door reports, even if that is long ago. A stop belongs to
    /// the epoch that it raises.
    #[tokio::test]
    async fn what_was_heard_before_a_stop_arrived_before_it_and_a_stop_counts_from_what_it_raises() {
        let (handle, mut envelopes, _) = handle();
        let heard = |command, epoch| Request { arrived: Some(Epoch(epoch)), ..request(command) };
        for (command, said, arrived, raised) in [
            (Command::Start, 3, Some(Epoch(3)), None),
            (Command::Start, 9, Some(Epoch(4)), None),
            (Command::Stop, 3, None, Some(Epoch(5))),
        ] {
            drop(handle.give(heard(command, said)));
            let given = next(&mut envelopes).expect("it is queued");
            assert_eq!((given.arrived, given.epoch), (arrived, raised), "{given:?}");
        }
    }

    /// Safety A6: stops are recorded even if nobody waits for their answers.
    #[tokio::test]
    async fn stops_come_to_the_loop_although_their_senders_hang_up_and_the_queue_is_full() {
        let (handle, mut envelopes, _, overflow) = handle_with_overflow();
        let waiting: Vec<_> = (0..=COMMANDS).map(|_| handle.give(request(Command::Start))).collect();
        (0..9 * COMMANDS).for_each(|_| drop(handle.give(request(Command::Stop))));
        for _ in 0..COMMANDS {
            assert_eq!(next(&mut envelopes).map(|request| request.command), Some(Command::Start));
        }
        drop(waiting);
        within("the stops", overflow.news()).await;
        let came: Vec<_> = overflow.take().stops.into_values().map(|stops| (stops.last.epoch, stops.count)).collect();
        let last = Epoch(4 + 9 * COMMANDS as u64);
        assert_eq!(came, [(Some(last), 9 * COMMANDS as u64)], "all of them, up to the last");
    }

    /// Safety A5, S9: a flood of stops leaves places in the queue to other commands.
    #[tokio::test]
    async fn stops_leave_places_in_the_queue_to_other_commands() {
        let (handle, mut envelopes, _, overflow) = handle_with_overflow();
        (0..9 * COMMANDS).for_each(|_| drop(handle.give(request(Command::Stop))));
        let waiting: Vec<_> = (0..LEFT_BY_STOPS).map(|_| handle.give(request(Command::Start))).collect();
        let queued: Vec<_> = std::iter::from_fn(|| next(&mut envelopes)).collect();
        let starts = queued.iter().filter(|request| request.command == Command::Start).count();
        assert_eq!((queued.len(), starts), (COMMANDS, LEFT_BY_STOPS), "each has its place at once");
        let beside: u64 = overflow.take().stops.values().map(|stops| stops.count).sum();
        assert_eq!(beside as usize + COMMANDS - LEFT_BY_STOPS, 9 * COMMANDS, "and no stop is left out");
        drop(waiting);
    }

    /// Safety A5, A6: refusals that find the queue full are counted outside the queue.
    #[test]
    fn what_is_refused_while_the_queue_is_full_is_counted_beside_it() {
        let (handle, mut envelopes, _, overflow) = handle_with_overflow();
        for n in 0..COMMANDS + 1000 {
            let refused = Refused::NotAllowed("no".to_owned());
            handle.note_refused_at_once(Issuer::operator(Door("coap")), Asked::Words(format!("START {n}")), refused);
        }
        let mut queued = Vec::new();
        while let Ok(Envelope::Refused(_, asked, _, None)) = envelopes.try_recv() {
            queued.push(asked);
        }
        assert_eq!(queued, (0..COMMANDS).map(|n| Asked::Words(format!("START {n}"))).collect::<Vec<_>>());
        let beside: Vec<_> = overflow.take().refusals.into_values().map(|counted| (counted.last.1, counted.count)).collect();
        assert_eq!(beside, [(Asked::Words(format!("START {}", COMMANDS + 999)), 1000)]);
    }

    #[tokio::test]
    async fn what_found_the_queue_full_is_queued_by_its_future() {
        let (handle, mut envelopes, _) = handle();
        let mut waiting: Vec<_> = (0..COMMANDS).map(|_| handle.give(request(Command::Start))).collect();
        waiting.push(handle.give(request(Command::Reset)));
        let reset = tokio::spawn(waiting.pop().expect("the last one"));
        let mut last = None;
        for _ in 0..=COMMANDS {
            last = within("what was queued", envelopes.recv()).await;
        }
        let Some(Envelope::Command(Request { command: Command::Reset, .. }, _)) = last.take() else { panic!("{last:?}") };
        drop(last);
        assert_eq!(within("its answer", reset).await.expect("it did not panic"), Err(Gone), "nobody answered it");
    }

    #[tokio::test]
    async fn a_loop_that_has_ended_is_said_to_be_gone() {
        let (handle, envelopes, _) = handle();
        drop(envelopes);
        assert_eq!(handle.give(request(Command::Start)).await, Err(Gone));
        assert_eq!(handle.give(request(Command::Stop)).await, Err(Gone));
    }
}
