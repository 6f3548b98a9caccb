//! The program's side of commands: who hears them, and what is known of a packet before the gate comes to it. What
//! becomes of a message afterwards stands in `publishing`.

/// A counter that the listener stamps on incoming packets, to tell those before an urgent message from those after it.
/// The gate does not interpret it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epoch(pub u64);

/// What a PUBLISH says, as far as it can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// The bytes of its topic, which need not be UTF-8; that of an alias, where the packet has one instead.
    pub topic: &'a [u8],
    /// As much of its payload as has arrived.
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

/// Hears the commands of one connection, and knows whose they are.
pub trait Listener: Send + Sync {
    /// Acts at once if this message is urgent, whatever else is wrong with it, ahead of everything that waits. Returns
    /// whether it is urgent. Only the part of the packet that names the command need have arrived.
    fn hear_urgent(&self, said: Said<'_>) -> bool;

    /// Hears any other message on the topic of a command, once, in the order in which it was sent, before any
    /// subscriber gets it. `arrived` is the epoch in which it arrived, and `is_again` says whether it was sent before.
    fn hear(&self, topic: &str, said: Said<'_>, arrived: Option<Epoch>, is_again: bool) -> CommandDecision;

    /// The epoch that began with the latest urgent message.
    fn epoch(&self) -> Epoch;
}

/// Whether a message that was heard goes on to subscribers. Urgent ones always do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandDecision {
    /// It goes on to its subscribers, and is not retained.
    Pass,
    /// Its sender may not say this; nobody gets it, and in MQTT 5 the sender is told so.
    Forbidden,
}

/// What is known of a packet before its turn comes.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Where the packet begins, in bytes since the CONNECT.
    pub begins: u64,
    /// The epoch in which this packet and those behind it came, up to the next mark. An urgent message has the one that
    /// it began.
    pub epoch: Epoch,
    /// Whether it was urgent and was heard on arrival; if so, it is not heard again when its turn comes.
    pub heard_ahead: bool,
}
