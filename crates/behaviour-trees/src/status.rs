//! The status that a node of a tree returns when it is ticked. How it follows from the statuses of its children stands
//! in `tick`.

named! {
    /// The statuses of BehaviorTree.CPP 4, with its words.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Status {
        /// Not begun, or halted, or reset by its parent. No tick returns this status.
        #[default]
        Idle = "IDLE",
        /// Not done yet: it has to be ticked again.
        Running = "RUNNING",
        /// Done, with success: a sequence goes on, and a fallback ends.
        Success = "SUCCESS",
        /// Done, with a failure: a fallback goes on, and a sequence ends.
        Failure = "FAILURE",
        /// Not done because of a condition; its parent goes on as if the node did not exist.
        Skipped = "SKIPPED",
    }
}

impl Status {
    /// The status with this word, in capitals.
    #[must_use]
    pub fn named(word: &str) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.word() == word)
    }

    /// Whether it is SUCCESS or FAILURE. SKIPPED is no result, since the parent continues as if the node did not exist.
    #[must_use]
    pub const fn is_completed(self) -> bool {
        matches!(self, Status::Success | Status::Failure)
    }
}
