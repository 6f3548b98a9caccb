//! The program's interface for commands: the listener that hears them, and what is known of a packet before the gate
//! handles it. What becomes of a message afterwards stands in `publishing`.

/// A counter with which the listener stamps incoming packets, to tell packets before an urgent message from packets
/// after it. The gate does not interpret the counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epoch(pub u64);

/// The contents of a PUBLISH, as far as they can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// The bytes of its topic, which need not be UTF-8. For a packet with only a topic alias, the topic that the
    /// alias stands for.
    pub topic: &'a [u8],
    /// The part of its payload that has arrived.
    pub payload: &'a [u8],
    /// `None`: MQTT 3.1.1, no response topic, or one that has not arrived yet.
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

/// Hears the commands of one connection, and knows their sender.
pub trait Listener: Send + Sync {
    /// Acts at once if this message is urgent, ahead of all waiting messages and whatever else is wrong with it.
    /// Returns whether it is urgent. The packet need not have arrived beyond the part that names the command.
    fn hear_urgent(&self, said: Said<'_>) -> bool;

    /// Hears a message on a topic of commands that is not urgent: once, in the order of sending, before any subscriber
    /// gets it. `arrived` is the epoch in which it arrived, and `is_again` says whether it was sent before.
    fn hear(&self, topic: &str, said: Said<'_>, arrived: Option<Epoch>, is_again: bool) -> CommandDecision;

    /// The epoch that began with the latest urgent message.
    fn epoch(&self) -> Epoch;
}

/// Whether a message that was heard goes on to subscribers. Urgent messages always do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandDecision {
    /// The message goes on to its subscribers, and is not retained.
    Pass,
    /// The sender may not send this command. No subscriber gets it, and a sender that uses MQTT 5 is told so.
    Forbidden,
}

/// What is known of a packet before it is handled.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Where the packet begins, in bytes since the CONNECT.
    pub begins: u64,
    /// The epoch in which this packet arrived, and all packets after it up to the next mark. For an urgent message, the
    /// epoch that the message began.
    pub epoch: Epoch,
    /// Whether the message was urgent and was heard on arrival. If so, it is not heard again when its packet is
    /// handled.
    pub heard_ahead: bool,
}
