//! Who hears commands beside the gate, and what is known of a packet before the gate comes to it. What is done with a message that was
//! heard stands in `publishing`.

/// What the listener stamps on what has come, so that it knows again what came before and what after something urgent. Nobody else
/// reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epoch(pub u64);

/// What a PUBLISH says, as far as it can be read at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// The bytes of its topic.
    pub topic: &'a [u8],
    /// What of its payload has come.
    pub payload: &'a [u8],
    /// Where its sender wants an answer.
    pub answer_to: Option<AnswerTo<'a>>,
}

/// Where the sender of a message wants an answer (MQTT 5, section 4.10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnswerTo<'a> {
    /// On which topic.
    pub topic: &'a str,
    /// By what it knows the answer.
    pub correlation: Option<&'a [u8]>,
}

/// Whoever hears commands; one for each connection, since it knows whose they are.
pub trait Listener: Send + Sync {
    /// Acts at once if this message is an urgent one, which must be heard ahead of everything else, whatever else is wrong with it;
    /// whether it is. No more of it need have come than names it.
    fn hear_urgent(&self, said: Said<'_>) -> bool;

    /// Any other message on the topic of a command, once, as it is sent, before anybody else gets it; the epoch in which it came, and
    /// whether it was sent before.
    fn hear(&self, topic: &str, said: Said<'_>, came: (Option<Epoch>, bool)) -> CommandDecision;

    /// The epoch that the last urgent message has begun.
    fn epoch(&self) -> Epoch;
}

/// What is to be done with a message that was heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandDecision {
    /// It goes on to whoever subscribed.
    Pass,
    /// Its sender may not say this: nobody gets it.
    Forbidden,
}

/// What is known of a packet before its turn comes.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Where it begins, in bytes since the CONNECT.
    pub begins: u64,
    /// In which epoch it came, and those behind it up to the next mark; of an urgent one the epoch that it has begun.
    pub epoch: Epoch,
    /// It was urgent, and was heard when it came: it is not heard again when its turn comes.
    pub heard_ahead: bool,
}
