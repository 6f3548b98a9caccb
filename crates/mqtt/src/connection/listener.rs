//! The program's interface for commands: a listener that receives them, and marks that describe a packet before it is
//! handled. `publishing` decides what happens to a message afterwards.

/// A counter of the listener, stored with each incoming packet. It shows whether a packet arrived before or after an
/// urgent message. The broker does not interpret the counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epoch(pub u64);

/// The contents of a PUBLISH, as far as they can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// The bytes of its topic, which need not be UTF-8. If the packet has only a topic alias, this is the topic that
    /// the alias stands for.
    pub topic: &'a [u8],
    /// The part of its payload that has arrived so far.
    pub payload: &'a [u8],
    /// Where to send an answer. `None` in MQTT 3.1.1, without a response topic, or while the response topic has not
    /// arrived.
    pub answer_to: Option<AnswerTo<'a>>,
}

/// Where the sender of a message wants an answer (MQTT 5, section 4.10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnswerTo<'a> {
    /// The response topic. In an urgent message it is not checked yet, and may be empty or have wildcards.
    pub topic: &'a str,
    /// The correlation data, by which the sender recognises the answer.
    pub correlation: Option<&'a [u8]>,
}

/// Receives the commands of one connection, and knows their sender.
pub trait Listener: Send + Sync {
    /// Acts at once if this message is urgent, ahead of all waiting messages and even if the message is malformed.
    /// Returns whether it is urgent. It is enough that the part of the packet that names the command has arrived.
    fn hear_urgent(&self, said: Said<'_>) -> bool;

    /// Receives a message on a topic of commands that is not urgent. Called once for each message, in the order of
    /// sending, before any subscriber gets the message. `arrived` is the epoch in which the message arrived, and
    /// `is_again` says whether it was sent before.
    fn hear(&self, topic: &str, said: Said<'_>, arrived: Option<Epoch>, is_again: bool) -> CommandDecision;

    /// The epoch that began with the latest urgent message.
    fn epoch(&self) -> Epoch;
}

/// Whether a command is passed on to its subscribers. Urgent commands are always passed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandDecision {
    /// The message goes on to its subscribers, and is not retained.
    Pass,
    /// The listener has taken the message, and nobody else gets it.
    Keep,
    /// The sender may not send this command. No subscriber gets it, and a sender that uses MQTT 5 is told so.
    Forbidden,
}

/// Describes a packet before the packet is handled.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Where the packet begins, in bytes since the CONNECT.
    pub begins: u64,
    /// The epoch in which this packet and all packets up to the next mark arrived. For an urgent message, the epoch
    /// that begins with the message.
    pub epoch: Epoch,
    /// Whether the message was urgent and the listener acted on it on arrival. If so, the listener does not get the
    /// message again when its packet is handled.
    pub heard_ahead: bool,
}
