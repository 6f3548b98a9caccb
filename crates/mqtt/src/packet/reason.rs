//! The reason codes of MQTT 5 (section 2.4).

/// A reason code of MQTT 5; codes from 0x80 on are failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[expect(missing_docs, reason = "the names are those of the standard, table 2-6")]
pub enum Reason {
    Success = 0x00,
    NoSubscribers = 0x10,
    NoSubscription = 0x11,
    Malformed = 0x81,
    Protocol = 0x82,
    Version = 0x84,
    ClientId = 0x85,
    Login = 0x86,
    NotAuthorized = 0x87,
    Unavailable = 0x88,
    Busy = 0x89,
    ShuttingDown = 0x8B,
    AuthenticationMethod = 0x8C,
    KeepAlive = 0x8D,
    TakenOver = 0x8E,
    Filter = 0x8F,
    Topic = 0x90,
    UnknownId = 0x92,
    ReceiveMaximum = 0x93,
    TopicAlias = 0x94,
    TooLarge = 0x95,
    Quota = 0x97,
    SharedSubscriptions = 0x9E,
}

impl Reason {
    /// Whether the code is a failure, from 0x80 on (section 2.4).
    #[must_use]
    pub const fn is_refusal(self) -> bool {
        self as u8 >= 0x80
    }
}
