//! The engine's own kinds of nodes: their names, their ports and their numbers of children. `tick` has their
//! rules, and `leaf` has the leaves.

use super::value::ValueType;

named! {
    /// The supported nodes of BehaviorTree.CPP 4, with their names in a file. `Sync` is an addition of this crate.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum BuiltIn {
        /// Ticks its children in order. The first failure ends the node.
        Sequence = "Sequence",
        /// A sequence that, after a failure, continues at the failed child when it is ticked again.
        SequenceWithMemory = "SequenceWithMemory",
        /// A sequence that returns RUNNING after each child.
        AsyncSequence = "AsyncSequence",
        /// A sequence that begins at its first child in every tick.
        ReactiveSequence = "ReactiveSequence",
        /// Ticks its children in order. The first success ends the node.
        Fallback = "Fallback",
        /// A fallback that returns RUNNING after each child.
        AsyncFallback = "AsyncFallback",
        /// A fallback that begins at its first child in every tick.
        ReactiveFallback = "ReactiveFallback",
        /// Ticks all children until enough of them have succeeded or failed.
        Parallel = "Parallel",
        /// Ticks all children until all are done.
        ParallelAll = "ParallelAll",
        /// Ticks its first child, the condition, until it is done. Then ticks the second child if the condition
        /// succeeded, otherwise the third.
        IfThenElse = "IfThenElse",
        /// Ticks its first child, the condition, in every tick. Then ticks the second child if the condition
        /// succeeds, otherwise the third.
        WhileDoElse = "WhileDoElse",
        /// Ticks all children but the last as a sequence. If one of them fails, ticks the last child and then fails.
        TryCatch = "TryCatch",
        /// Ticks the child whose `case_N` equals `variable`. If neither case is equal, ticks the third child.
        Switch2 = "Switch2",
        /// Ticks the child whose `case_N` equals `variable`. If none of the three cases is equal, ticks the fourth
        /// child.
        Switch3 = "Switch3",
        /// Ticks the child whose `case_N` equals `variable`. If none of the four cases is equal, ticks the fifth
        /// child.
        Switch4 = "Switch4",
        /// Ticks the child whose `case_N` equals `variable`. If none of the five cases is equal, ticks the sixth
        /// child.
        Switch5 = "Switch5",
        /// Ticks the child whose `case_N` equals `variable`. If none of the six cases is equal, ticks the seventh
        /// child.
        Switch6 = "Switch6",
        /// Returns success for failure, and failure for success. RUNNING and SKIPPED are not changed.
        Inverter = "Inverter",
        /// Ticks its child again when the child fails, at most `num_attempts` times in all. −1 means no limit.
        RetryUntilSuccessful = "RetryUntilSuccessful",
        /// Ticks its child again when the child succeeds, `num_cycles` times in all. −1 means no limit.
        Repeat = "Repeat",
        /// If its child still runs after `msec` milliseconds, halts the child and fails. 0 means no limit.
        Timeout = "Timeout",
        /// Returns RUNNING for `delay_msec` milliseconds, and then ticks its child.
        Delay = "Delay",
        /// Returns success for failure. RUNNING and SKIPPED are not changed.
        ForceSuccess = "ForceSuccess",
        /// Returns failure for success. RUNNING and SKIPPED are not changed.
        ForceFailure = "ForceFailure",
        /// Performs its child only once. After that, the node returns SKIPPED, or returns the child's result again.
        RunOnce = "RunOnce",
        /// Ticks its child until the child fails. After a success of the child, the node returns RUNNING, and the
        /// child begins again.
        KeepRunningUntilFailure = "KeepRunningUntilFailure",
        /// Ticks its child for each whole number of a queue.
        LoopInt = "LoopInt",
        /// Ticks its child for each `true` or `false` of a queue.
        LoopBool = "LoopBool",
        /// Ticks its child for each number of a queue.
        LoopDouble = "LoopDouble",
        /// Ticks its child for each text of a queue.
        LoopString = "LoopString",
        /// Ticks its child if an entry was written, otherwise returns SKIPPED.
        SkipUnlessUpdated = "SkipUnlessUpdated",
        /// Ticks its child if an entry was written, otherwise returns RUNNING.
        WaitValueUpdate = "WaitValueUpdate",
        /// Runs another tree, which has its own blackboard.
        SubTree = "SubTree",
        /// Returns SUCCESS in its first tick.
        AlwaysSuccess = "AlwaysSuccess",
        /// Returns FAILURE in its first tick.
        AlwaysFailure = "AlwaysFailure",
        /// Writes a literal, or the value of another entry, to an entry. Fails if there is no value.
        SetBlackboard = "SetBlackboard",
        /// Removes the value of an entry of its own tree. Always succeeds.
        UnsetBlackboard = "UnsetBlackboard",
        /// Returns RUNNING for `msec` milliseconds, then SUCCESS.
        Sleep = "Sleep",
        /// Executes a script and succeeds. If the script cannot be executed, the tick ends with a fault.
        Script = "Script",
        /// Succeeds if a script is true, otherwise fails.
        ScriptCondition = "ScriptCondition",
        /// Succeeds if an entry was written after the last tick of this node.
        WasEntryUpdated = "WasEntryUpdated",
        /// Ticks its child if a script is true. Otherwise it returns the status in its port `else`.
        Precondition = "Precondition",
        /// Returns RUNNING until all parties of a barrier have arrived.
        Sync = "Sync",
    }
}

named! {
    /// The class of a node by its number of children. The word is the name of an element in files.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Family {
        /// One or more children; some kinds need two.
        Control = "Control",
        /// One child. In the row of nodes, the child comes directly after its parent.
        Decorator = "Decorator",
        /// No children: an action or a condition.
        Leaf = "Action",
    }
}

/// The form of the value that may be written at a port of a built-in node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PortForm {
    /// A literal of this type, or an entry.
    Value(ValueType),
    /// Only a literal, because the value is needed when the tree is built.
    Literal,
    /// The name of an entry, with or without braces.
    EntryName,
    /// An entry of this type, in braces.
    Output(ValueType),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BuiltInPort {
    pub(crate) name: &'static str,
    pub(crate) written: PortForm,
    pub(crate) needed: Needed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needed {
    Yes,
    No,
    Otherwise(&'static str),
}

const fn value(name: &'static str, ty: ValueType, needed: Needed) -> BuiltInPort {
    BuiltInPort { name, written: PortForm::Value(ty), needed }
}

const fn literal(name: &'static str, needed: Needed) -> BuiltInPort {
    BuiltInPort { name, written: PortForm::Literal, needed }
}

const fn entry_name(name: &'static str) -> BuiltInPort {
    BuiltInPort { name, written: PortForm::EntryName, needed: Needed::Yes }
}

/// The ports of a loop. The queue is a text with `;` between its elements, or an entry that holds such a text.
const fn queue(element: ValueType) -> [BuiltInPort; 3] {
    let value = BuiltInPort { name: "value", written: PortForm::Output(element), needed: Needed::No };
    [self::value("queue", ValueType::Text, Needed::Yes), literal("if_empty", Needed::Otherwise("SUCCESS")), value]
}

const LOOPS: [(BuiltIn, ValueType); 4] = [
    (BuiltIn::LoopInt, ValueType::Int),
    (BuiltIn::LoopBool, ValueType::Bool),
    (BuiltIn::LoopDouble, ValueType::Number),
    (BuiltIn::LoopString, ValueType::Text),
];

const SWITCH: [BuiltInPort; 7] = [
    value("variable", ValueType::Any, Needed::No),
    value("case_1", ValueType::Any, Needed::No),
    value("case_2", ValueType::Any, Needed::No),
    value("case_3", ValueType::Any, Needed::No),
    value("case_4", ValueType::Any, Needed::No),
    value("case_5", ValueType::Any, Needed::No),
    value("case_6", ValueType::Any, Needed::No),
];

impl BuiltIn {
    /// The kind with this name, which is case-sensitive.
    #[must_use]
    pub fn named(word: &str) -> Option<BuiltIn> {
        BuiltIn::ALL.into_iter().find(|kind| kind.word() == word)
    }

    /// The class of this kind. A `SubTree` is a `Decorator`. Its child is the root of the other tree.
    #[must_use]
    pub const fn family(self) -> Family {
        use BuiltIn as B;
        match self {
            B::Sequence | B::SequenceWithMemory | B::AsyncSequence | B::ReactiveSequence | B::Fallback | B::AsyncFallback => {
                Family::Control
            }
            B::ReactiveFallback | B::Parallel | B::ParallelAll | B::IfThenElse | B::WhileDoElse | B::TryCatch => Family::Control,
            B::Switch2 | B::Switch3 | B::Switch4 | B::Switch5 | B::Switch6 => Family::Control,
            B::Inverter | B::RetryUntilSuccessful | B::Repeat | B::Timeout | B::Delay | B::ForceSuccess | B::ForceFailure => {
                Family::Decorator
            }
            B::RunOnce | B::KeepRunningUntilFailure | B::SubTree | B::Precondition => Family::Decorator,
            B::LoopInt | B::LoopBool | B::LoopDouble | B::LoopString | B::SkipUnlessUpdated | B::WaitValueUpdate => {
                Family::Decorator
            }
            B::AlwaysSuccess | B::AlwaysFailure | B::SetBlackboard | B::UnsetBlackboard | B::Sleep => Family::Leaf,
            B::Script | B::ScriptCondition | B::WasEntryUpdated | B::Sync => Family::Leaf,
        }
    }

    /// Number of cases of a switch; 0 for other kinds.
    pub(crate) const fn cases(self) -> usize {
        if !matches!(self, BuiltIn::Switch2 | BuiltIn::Switch3 | BuiltIn::Switch4 | BuiltIn::Switch5 | BuiltIn::Switch6) {
            return 0;
        }
        // The switches are declared one after the other in the enum.
        2 + self as usize - BuiltIn::Switch2 as usize
    }

    /// The type of a loop's elements; `None` for other kinds.
    pub(crate) fn element(self) -> Option<ValueType> {
        LOOPS.into_iter().find(|(kind, _)| *kind == self).map(|(_, element)| element)
    }

    /// Whether a node of this kind remembers the last write of an entry that the node has seen.
    pub(crate) const fn looks_at_writes(self) -> bool {
        matches!(self, BuiltIn::SkipUnlessUpdated | BuiltIn::WaitValueUpdate | BuiltIn::WasEntryUpdated)
    }

    /// The minimum and the maximum number of children.
    pub(crate) const fn children(self) -> (usize, usize) {
        if self.cases() > 0 {
            return (self.cases() + 1, self.cases() + 1);
        }
        if matches!(self, BuiltIn::IfThenElse | BuiltIn::WhileDoElse) {
            return (2, 3);
        }
        if matches!(self, BuiltIn::TryCatch) {
            return (2, usize::MAX);
        }
        match self.family() {
            Family::Control => (1, usize::MAX),
            Family::Decorator => (1, 1),
            Family::Leaf => (0, 0),
        }
    }

    pub(crate) const fn ports(self) -> &'static [BuiltInPort] {
        use Needed::{No, Otherwise, Yes};
        use ValueType::{Any, Bool, Int, Number, Text};
        match self {
            BuiltIn::Parallel => {
                const { &[value("success_count", Int, Otherwise("-1")), value("failure_count", Int, Otherwise("1"))] }
            }
            BuiltIn::ParallelAll => const { &[value("max_failures", Int, Otherwise("1"))] },
            BuiltIn::Switch2 | BuiltIn::Switch3 | BuiltIn::Switch4 | BuiltIn::Switch5 | BuiltIn::Switch6 => {
                SWITCH.split_at(self.cases() + 1).0
            }
            BuiltIn::RetryUntilSuccessful => const { &[value("num_attempts", Int, Yes)] },
            BuiltIn::Repeat => const { &[value("num_cycles", Int, Yes)] },
            BuiltIn::Timeout | BuiltIn::Sleep => const { &[value("msec", Int, Yes)] },
            BuiltIn::Delay => const { &[value("delay_msec", Int, Yes)] },
            BuiltIn::RunOnce => const { &[value("then_skip", Bool, Otherwise("true"))] },
            BuiltIn::TryCatch => const { &[value("catch_on_halt", Bool, Otherwise("false"))] },
            BuiltIn::LoopInt => const { &queue(Int) },
            BuiltIn::LoopBool => const { &queue(Bool) },
            BuiltIn::LoopDouble => const { &queue(Number) },
            BuiltIn::LoopString => const { &queue(Text) },
            BuiltIn::SkipUnlessUpdated | BuiltIn::WaitValueUpdate | BuiltIn::WasEntryUpdated => const { &[entry_name("entry")] },
            BuiltIn::SetBlackboard => const { &[value("value", Any, Yes), entry_name("output_key")] },
            BuiltIn::UnsetBlackboard => const { &[entry_name("key")] },
            BuiltIn::Script | BuiltIn::ScriptCondition => const { &[literal("code", Yes)] },
            BuiltIn::Precondition => const { &[literal("if", Yes), literal("else", Otherwise("FAILURE"))] },
            BuiltIn::Sync => const { &[literal("parties", Yes), literal("party", No)] },
            BuiltIn::Sequence | BuiltIn::SequenceWithMemory | BuiltIn::AsyncSequence | BuiltIn::ReactiveSequence => &[],
            BuiltIn::Fallback | BuiltIn::AsyncFallback | BuiltIn::ReactiveFallback => &[],
            BuiltIn::IfThenElse | BuiltIn::WhileDoElse | BuiltIn::Inverter | BuiltIn::ForceSuccess | BuiltIn::ForceFailure => &[],
            BuiltIn::KeepRunningUntilFailure | BuiltIn::SubTree | BuiltIn::AlwaysSuccess | BuiltIn::AlwaysFailure => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_known_by_its_name_and_has_the_children_of_its_family() {
        for kind in BuiltIn::ALL {
            assert_eq!(BuiltIn::named(kind.word()), Some(kind));
            let (least, most) = kind.children();
            match kind.family() {
                Family::Control => assert!(least >= 1 && most > 1, "{kind:?}"),
                Family::Decorator => assert_eq!((least, most), (1, 1), "{kind:?}"),
                Family::Leaf => assert_eq!((least, most), (0, 0), "{kind:?}"),
            }
        }
        let cases = BuiltIn::ALL.map(BuiltIn::cases).into_iter().filter(|cases| *cases > 0);
        assert_eq!(cases.collect::<Vec<usize>>(), [2, 3, 4, 5, 6]);
        assert_eq!(BuiltIn::Switch3.ports().len(), 4);
        assert_eq!(BuiltIn::Switch3.children(), (4, 4));
    }
}
