//! The MQTT door as its clients see it: every publication with its topic, its payload and whether it is kept, in their order, and
//! what becomes of messages that command. All are published with QoS 1, which is the connection's business and not seen here.

use tokio::sync::mpsc;

use super::book::{Book, readable};
use super::doors::{ANSWERS, Access, Answer, Caller, Heard, Keyring, News, Orders, Publication, Sender, Snapshot, Taken, Topics};
use super::house::House;

/// What all our topics begin with.
pub(crate) const BASE: &str = "hallsweep/discovery";

/// The topics of old clients.
pub(crate) const OLD: &str = "unibo/qak";

/// A door without its sockets.
pub(crate) struct Mqtt {
    news: News,
    plain_news: News,
    orders: Orders,
    answers: mpsc::Receiver<Answer>,
}

impl Mqtt {
    /// A door of this house, at which old clients may drive or not.
    pub(crate) fn new(house: &House, manual_driving: bool) -> Mqtt {
        let (give, answers) = mpsc::channel(ANSWERS);
        let orders = Orders::new(house.handle.clone(), topics(), manual_driving, give);
        Mqtt { news: News::new(topics(), true), plain_news: News::new(topics(), false), orders, answers }
    }

    /// Everything that goes out for this state.
    pub(crate) fn look(&mut self, book: &mut Book, house: &House, state: &std::sync::Arc<Snapshot>) {
        let now = house.inside().run.now().since_start;
        self.news.handle_state(std::sync::Arc::clone(state));
        self.plain_news.handle_state(std::sync::Arc::clone(state));
        while let Some(picture) = self.news.poll_photo() {
            if let Ok(Some(photo)) = house.memory.archive().photo(picture.luggage) {
                let goes_out = self.news.handle_photo(picture, photo);
                book.write(
                    "mqtt",
                    &format!("photo {} take {}", picture.luggage.0, picture.take),
                    goes_out.to_string().as_bytes(),
                );
            }
        }
        while let Some(publication) = self.news.poll_publication(now) {
            let counted = if self.news.is_numbered(&publication) { " · numbered" } else { "" };
            write(book, "mqtt", counted, &publication);
        }
        while let Some(publication) = self.plain_news.poll_publication(now) {
            write(book, "mqtt_plain", "", &publication);
        }
    }

    /// The connection is a new one, and Home Assistant has started.
    pub(crate) fn renew(&mut self, book: &mut Book) {
        book.write("mqtt", "a new connection", b"");
        self.news.renew(2);
        self.plain_news.renew(0);
        self.news.handle_birth();
    }

    /// Says something, and collects what is published about it.
    pub(crate) async fn say(&mut self, topic: &str, payload: &[u8], sender: &Sender) -> (Taken, Vec<String>) {
        let taken = self.orders.take(&Heard { topic, payload, arrived: None, is_again: false }, sender);
        // Everything is on this thread: loop and results get their turns.
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

/// Somebody on this machine.
pub(crate) fn here() -> Sender {
    Sender::Known { caller: Caller::Here, from: "127.0.0.1".into() }
}

/// Somebody at somebody else's broker.
pub(crate) fn unknown() -> Sender {
    Sender::Unknown { broker: "broker.example".into() }
}

/// Somebody with this key.
pub(crate) fn with_key(keyring: &Keyring, token: &str) -> Sender {
    Sender::Known { caller: Caller::Known(keyring.check(token).expect("the key is there")), from: "192.0.2.7".into() }
}

/// Access by these keys.
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
