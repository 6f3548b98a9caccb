//! Behaviour trees through the public API: the rules of every node as tables, and random trees beside a second
//! interpreter that was written from the rules alone, and beside BehaviorTree.CPP.
#![expect(clippy::unwrap_used, clippy::wildcard_enum_match_arm, reason = "all of this is test")]

mod beside_behaviortree_cpp;
mod conditions;
mod other_tools;
mod random;
mod reference;
mod subtrees;
mod tables;
