//! What a node of a tree returns when it is ticked. Which status follows from those of the children stands in `tick`.

named! {
    /// The statuses of BehaviorTree.CPP 4, with its words.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Status {
        /// Not begun, or halted, or reset by its parent. No tick ever returns it.
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

    /// Whether it is SUCCESS or FAILURE. SKIPPED is no result, since the parent goes on as if there were no node.
    #[must_use]
    pub const fn is_completed(self) -> bool {
        matches!(self, Status::Success | Status::Failure)
    }
}
