//! The retrieval on the page: its stages and arms in an operator's words, and its trees as rows that nest as the nodes do. Markup
//! stands in the templates; the robots in the hall are `carriers`'.

use hallsweep_core::behaviour::Status;
use hallsweep_core::mission::Hold;
use hallsweep_core::retrieval::ArmState;
use hallsweep_core::settings::Fetcher;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::retrieval::NodeShown;
use hallsweep_core::world::robot::RobotShown;

use crate::api::retrieval::ArmJson;

/// The stages in their order, by the word of the doors and in words for an operator.
const BY_THE_PAIR: [(&str, &str); 4] = [
    ("makingRoom", "the robot that searched makes room"),
    ("fetching", "the pair fetches the piece"),
    ("goingOut", "the pair goes out"),
    ("comingHome", "the robot that searched comes home"),
];

/// The one that searches needs no room, and is home when the piece is in the container.
const ALONE: [(&str, &str); 2] =
    [("fetching", "the robot that searched fetches the piece"), ("lettingGo", "it puts the piece into the container")];

/// The stages by who fetches.
pub(super) const fn stages(fetcher: Fetcher) -> &'static [(&'static str, &'static str)] {
    match fetcher {
        Fetcher::Pair => &BY_THE_PAIR,
        Fetcher::Discovery => &ALONE,
        Fetcher::None => &[],
    }
}

/// A node in its place among the rows of its tree.
pub(in crate::doors::http) struct Row<'a> {
    pub(in crate::doors::http) node: &'a NodeShown,
    /// Its children follow.
    pub(in crate::doors::http) opens: bool,
    /// So many nodes above it end with it.
    pub(in crate::doors::http) closes: usize,
}

/// The nodes of a tree, which come in preorder, each with what begins and ends there.
pub(in crate::doors::http) fn rows(nodes: &[NodeShown]) -> Vec<Row<'_>> {
    let next = nodes.iter().skip(1).map(|node| node.depth).chain([0]);
    let row = |(node, next): (_, usize)| row(node, next);
    nodes.iter().zip(next).map(row).collect()
}

fn row(node: &NodeShown, next: usize) -> Row<'_> {
    Row { node, opens: next > node.depth, closes: node.depth.saturating_sub(next) }
}

/// The sign of a status, so that it is known without its colour.
pub(in crate::doors::http) const fn sign(status: Status) -> &'static str {
    match status {
        Status::Idle => "○",
        Status::Running => "▶",
        Status::Success => "✓",
        Status::Failure => "✗",
        Status::Skipped => "⤼",
    }
}

/// The robots that have an arm, with what it says of itself.
pub(super) fn armed(robots: &[RobotShown]) -> Vec<(&RobotShown, ArmState, ArmJson)> {
    robots.iter().filter_map(|robot| robot.arm.map(|arm| (robot, arm, ArmJson::from(arm)))).collect()
}

/// What is to be done about a retrieval that stands still, in few words: the bar has little room.
pub(super) fn wanted_of_the_operator(holds: &[Hold]) -> Option<&'static str> {
    if holds.contains(&Hold::Alarm) {
        return Some("acknowledge, then START");
    }
    let ends_by_itself = [Hold::Operator, Hold::Restart, Hold::AwaitingStart];
    (!holds.is_empty() && holds.iter().all(|hold| ends_by_itself.contains(hold))).then_some("START goes on")
}

/// The pieces that are in the container, as `luggage #1 is in the container`.
pub(super) fn secured_in_words<'a>(luggage: impl Iterator<Item = &'a Luggage>) -> Option<String> {
    let ids: Vec<LuggageId> = luggage.filter(|piece| piece.secured.is_some()).map(|piece| piece.id).collect();
    let (last, others) = ids.split_last()?;
    if others.is_empty() {
        return Some(format!("luggage #{last} is in the container"));
    }
    let others: Vec<String> = others.iter().map(|id| format!("#{id}")).collect();
    Some(format!("luggage {} and #{last} are in the container", others.join(", ")))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::sync::Arc;

    /// A node for tests.
    pub(in super::super) fn node(name: &str, depth: usize, status: Status) -> NodeShown {
        let [path, name, kind] = [name, name, "Sequence"].map(Arc::from);
        NodeShown { path, name, kind, depth, status, is_ticked: status == Status::Running }
    }

    #[test]
    fn every_list_that_is_opened_is_closed_again_and_where_the_nodes_say() {
        for depths in [vec![0], vec![0, 1, 2, 2, 1], vec![0, 1, 2, 3, 1, 2], vec![0, 1, 1, 1]] {
            let nodes: Vec<NodeShown> = depths.iter().map(|depth| node("n", *depth, Status::Idle)).collect();
            let mut open = 0;
            for row in rows(&nodes) {
                assert_eq!(open, row.node.depth, "{depths:?}");
                open = open + usize::from(row.opens) - row.closes;
            }
            assert_eq!(open, 0, "{depths:?}");
        }
    }

    #[test]
    fn start_is_asked_for_where_it_helps_and_after_the_alarm_is_acknowledged() {
        assert_eq!(wanted_of_the_operator(&[]), None);
        assert_eq!(wanted_of_the_operator(&[Hold::Operator]), Some("START goes on"));
        assert_eq!(wanted_of_the_operator(&[Hold::Alarm, Hold::AwaitingStart]), Some("acknowledge, then START"));
        assert_eq!(wanted_of_the_operator(&[Hold::Operator, Hold::Temperature]), None, "it is too hot: START would be refused");
    }
}
