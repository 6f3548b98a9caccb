//! The status that a node of a tree returns when it is ticked. `tick` defines how it follows from the statuses of the
//! children.

named! {
    /// The statuses of BehaviorTree.CPP 4, with the same words.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Status {
        /// Not begun, halted, or reset by its parent. No tick returns this status.
        #[default]
        Idle = "IDLE",
        /// Not done yet. The node must be ticked again.
        Running = "RUNNING",
        /// Done, with success. A sequence continues, and a fallback ends.
        Success = "SUCCESS",
        /// Done, with a failure. A fallback continues, and a sequence ends.
        Failure = "FAILURE",
        /// Not performed because of a condition. The parent continues as if the node did not exist.
        Skipped = "SKIPPED",
    }
}

impl Status {
    /// The status with this word. The word is in capitals.
    #[must_use]
    pub fn named(word: &str) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.word() == word)
    }

    /// Whether it is SUCCESS or FAILURE. SKIPPED is not a result, because the parent continues as if the node did not
    /// exist.
    #[must_use]
    pub const fn is_completed(self) -> bool {
        matches!(self, Status::Success | Status::Failure)
    }
}
