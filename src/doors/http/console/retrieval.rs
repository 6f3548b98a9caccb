//! The retrieval on the page: its stages in an operator's words, and its behaviour trees as nested rows. The
//! templates have the markup. `carriers` draws the robots in the hall.

use behaviour_trees::Status;
use hallsweep_core::hold::Hold;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::snapshot::retrieval::NodeShown;

use crate::phrases::{Language, Phrase};

/// Returns the names of the stages in the interface, in order. The stages depend on which robots fetch. If the
/// searching robot itself fetches the piece, it need not make room for other robots. It also need not drive home
/// afterwards, because it is at home when the piece is in the container.
pub(super) const fn stages(fetcher: Fetcher) -> &'static [&'static str] {
    match fetcher {
        Fetcher::Pair => &["makingRoom", "fetching", "goingOut", "comingHome"],
        Fetcher::Discovery => &["fetching", "lettingGo"],
        Fetcher::None => &[],
    }
}

pub(super) fn stage(language: Language, fetcher: Fetcher, stage: &str) -> Phrase<'_> {
    if fetcher == Fetcher::Pair { language.say_of("stage-pair", stage) } else { language.say_of("stage-discovery", stage) }
}

pub(in crate::doors::http) struct TreeRow<'a> {
    pub(in crate::doors::http) node: &'a NodeShown,
    /// Whether the next row is a child of this node.
    pub(in crate::doors::http) opens: bool,
    /// Number of nesting levels that end after this row.
    pub(in crate::doors::http) closes: usize,
}

/// Returns one row for each node of a tree. The nodes are in preorder. Each row says whether a nesting level begins
/// after the row, and how many levels end there.
pub(in crate::doors::http) fn rows(nodes: &[NodeShown]) -> Vec<TreeRow<'_>> {
    let next = nodes.iter().skip(1).map(|node| node.depth).chain([0]);
    let row = |(node, next): (_, usize)| row(node, next);
    nodes.iter().zip(next).map(row).collect()
}

fn row(node: &NodeShown, next: usize) -> TreeRow<'_> {
    TreeRow { node, opens: next > node.depth, closes: node.depth.saturating_sub(next) }
}

/// Returns a sign for a status, so that people can recognise the status without its colour.
pub(in crate::doors::http) const fn sign(status: Status) -> &'static str {
    match status {
        Status::Idle => "○",
        Status::Running => "▶",
        Status::Success => "✓",
        Status::Failure => "✗",
        Status::Skipped => "⤼",
    }
}

/// Returns which button the operator has to press so that the halted robots continue. The result is the id of a
/// phrase, or `None` while no button helps.
pub(super) fn wanted_of_the_operator(holds: &[Hold]) -> Option<&'static str> {
    if let Some((_, press)) =
        [(Hold::Alarm, "acknowledge"), (Hold::TooHigh, "ok")].into_iter().find(|(hold, _)| holds.contains(hold))
    {
        return Some(press);
    }
    let ends_by_itself = [Hold::Operator, Hold::Restart, Hold::AwaitingStart];
    (!holds.is_empty() && holds.iter().all(|hold| ends_by_itself.contains(hold))).then_some("start")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::sync::Arc;

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
    fn every_stage_and_who_fetches_is_said_in_every_language() {
        for (language, fetcher) in Language::ALL.into_iter().flat_map(|language| Fetcher::ALL.map(|fetcher| (language, fetcher)))
        {
            assert!(!language.say_of("fetcher", fetcher.name()).to_string().is_empty());
            assert!(stages(fetcher).iter().all(|name| !stage(language, fetcher, name).to_string().is_empty()));
        }
    }

    #[test]
    fn start_is_asked_for_where_it_helps_and_after_the_alarm_is_acknowledged_or_the_temperature_is_ok() {
        assert_eq!(wanted_of_the_operator(&[]), None);
        assert_eq!(wanted_of_the_operator(&[Hold::Operator]), Some("start"));
        assert_eq!(wanted_of_the_operator(&[Hold::Alarm, Hold::AwaitingStart]), Some("acknowledge"));
        assert_eq!(wanted_of_the_operator(&[Hold::TooHigh, Hold::AwaitingStart]), Some("ok"), "START before the OK is refused");
        assert_eq!(wanted_of_the_operator(&[Hold::Operator, Hold::Temperature]), None, "it is too hot: START would be refused");
    }
}
