//! The MQTT door as its clients see it: every publication in order, with its topic, its payload and its retain
//! flag, and the result of every command message. The QoS of publications is always 1 and not recorded, because the
//! connection handles it.

use tokio::sync::mpsc;

use super::book::{Book, readable};
use super::doors::{
    ANSWERS, Access, Caller, ChangeFeed, Commands, IncomingMessage, Keyring, Publication, Publisher, ResultMessage, Snapshot,
    Taken, Topics,
};
use super::test_app::TestApp;

/// Prefix of all topics of hallsweep.
pub(crate) const BASE: &str = "hallsweep/discovery";

/// Prefix of the topics of old clients.
pub(crate) const OLD: &str = "unibo/qak";

/// A door without sockets.
pub(crate) struct Mqtt {
    feed: ChangeFeed,
    plain_feed: ChangeFeed,
    commands: Commands,
    answers: mpsc::Receiver<ResultMessage>,
}

impl Mqtt {
    /// Creates a door of this app; `manual_driving` sets whether old clients may drive.
    pub(crate) fn new(app: &TestApp, manual_driving: bool) -> Mqtt {
        let (give, answers) = mpsc::channel(ANSWERS);
        let commands = Commands::new(app.handle.clone(), topics(), manual_driving, give);
        Mqtt { feed: ChangeFeed::new(topics(), true), plain_feed: ChangeFeed::new(topics(), false), commands, answers }
    }

    /// Records everything that is published for this state.
    pub(crate) fn look(&mut self, book: &mut Book, app: &TestApp, state: &std::sync::Arc<Snapshot>) {
        let now = app.inside().run.now().since_start;
        self.feed.handle_state(std::sync::Arc::clone(state));
        self.plain_feed.handle_state(std::sync::Arc::clone(state));
        while let Some(picture) = self.feed.poll_photo() {
            if let Ok(Some(photo)) = app.memory.archive().photo(picture.luggage) {
                let goes_out = self.feed.handle_photo(picture, photo);
                book.write(
                    "mqtt",
                    &format!("photo {} take {}", picture.luggage.0, picture.take),
                    goes_out.to_string().as_bytes(),
                );
            }
        }
        while let Some(publication) = self.feed.poll_publication(now) {
            let counted = if self.feed.is_numbered(&publication) { " · numbered" } else { "" };
            write(book, "mqtt", counted, &publication);
        }
        while let Some(publication) = self.plain_feed.poll_publication(now) {
            write(book, "mqtt_plain", "", &publication);
        }
    }

    /// Simulates a new connection and a start of Home Assistant.
    pub(crate) fn renew(&mut self, book: &mut Book) {
        book.write("mqtt", "a new connection", b"");
        self.feed.renew(2);
        self.plain_feed.renew(0);
        self.feed.handle_birth();
    }

    /// Sends a message and returns its result and the publications about it.
    pub(crate) async fn say(&mut self, topic: &str, payload: &[u8], publisher: &Publisher) -> (Taken, Vec<String>) {
        let taken =
            self.commands.take(&IncomingMessage { topic, payload, arrived: None, is_again: false, answer_to: None }, publisher);
        // Everything runs on this thread, so the main loop and the results must get their turns.
        for _ in 0..24 {
            tokio::task::yield_now().await;
        }
        let mut said = Vec::new();
        while let Ok(answer) = self.answers.try_recv() {
            said.push(shown(&answer.taken()));
        }
        (taken, said)
    }
}

/// Publisher on this machine.
pub(crate) fn here() -> Publisher {
    Publisher::Known { caller: Caller::Here, from: "127.0.0.1".into() }
}

/// Unknown publisher at another broker.
pub(crate) fn unknown() -> Publisher {
    Publisher::Unknown { broker: "broker.example".into() }
}

/// Publisher with this key.
pub(crate) fn with_key(keyring: &Keyring, token: &str) -> Publisher {
    Publisher::Known { caller: Caller::Known(keyring.check(token).expect("the key is there")), from: "192.0.2.7".into() }
}

pub(crate) fn by_keys(keyring: &Keyring) -> Access {
    Access::Keys(keyring.clone())
}

fn topics() -> Topics {
    Topics::new("hallsweep", "discovery", OLD)
}

fn write(book: &mut Book, kind: &'static str, more: &str, publication: &Publication) {
    let kept = if publication.retain { " · kept" } else { "" };
    book.write(kind, &format!("{}{kept}{more}", publication.topic), &publication.payload);
}

fn shown(publication: &Publication) -> String {
    let kept = if publication.retain { " · kept" } else { "" };
    format!("{}{kept}\n{}", publication.topic, readable(&publication.payload))
}
