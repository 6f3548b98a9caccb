//! What a node of a tree says when it is ticked.
//! Which status follows from those of the children stands in `tick`.

named! {
    /// The statuses of BehaviorTree.CPP 4, with its words.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Status {
        /// Not begun, or halted, or reset by its parent. No tick ever returns it.
        #[default]
        Idle = "IDLE",
        /// Not done yet: it wants to be ticked again.
        Running = "RUNNING",
        /// Done, and well.
        Success = "SUCCESS",
        /// Done, and not well.
        Failure = "FAILURE",
        /// Not done, since a condition said so; a parent goes on as if it were not there.
        Skipped = "SKIPPED",
    }
}

impl Status {
    /// The status of this word.
    #[must_use]
    pub fn named(word: &str) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.word() == word)
    }

    /// SUCCESS or FAILURE.
    #[must_use]
    pub const fn is_completed(self) -> bool {
        matches!(self, Status::Success | Status::Failure)
    }
}
