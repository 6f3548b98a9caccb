//! Further photos of a piece that a judge was unsure about: from another side, and from two cells off. The piece waits
//! for its verdict meanwhile. Afterwards it is asked again.

use std::sync::Arc;

use super::Engine;
use super::motion::Turn;
use crate::command::Move;
use crate::mission::InputContext;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::Stage;
use crate::state::fact::Fact;
use crate::units::{Cell, Heading, LuggageId, Pose};
use crate::world::hall_map::{Mark, is_in_reach};
use crate::world::luggage::Luggage;
use crate::world::resource::Resource;

/// Longest way to a view, in moves. A robot that shall look at a piece does not search the hall for another way.
const LONGEST_WAY: usize = 24;

impl Engine {
    /// Records that a judge is unsure, and sends the robot round the piece.
    pub(super) fn record_unsure(&mut self, context: &InputContext) {
        let (Some(luggage), Some(issuer)) = (context.luggage, &context.issuer) else { return };
        let (who, note, hot) = (issuer.who.clone(), context.note.clone(), context.hot);
        let views = self.settings.rules.unsure_views;
        self.world.touch(Resource::Mission);
        self.mission.route.clear();
        self.record(Fact::Unsure { luggage, who, note, hot });
        self.take_back(luggage, issuer);
        if views > 0 {
            self.change_inspection(|inspection| (inspection.stage, inspection.views) = (Stage::Viewing(luggage), views));
        }
    }

    /// Drives to the next view and takes its photo. If no view is left, the piece is asked again.
    pub(super) fn view_piece(&mut self, id: LuggageId) -> Turn {
        if self.mission.route.is_empty() {
            let piece = self.state.luggage.get(id).map(Arc::clone);
            let way = piece.and_then(|piece| self.way_to_view(&piece));
            match way {
                Some(way) if way.is_empty() => {
                    let pose = self.state.pose;
                    self.change_inspection(|inspection| {
                        inspection.views = inspection.views.saturating_sub(1);
                        (inspection.stage, inspection.pose) = (Stage::RetakingPhoto(id), pose);
                    });
                    return Turn::Again;
                }
                Some(way) => self.set_route(Some(way)),
                None => {
                    self.world.write(self.now.wall, Tone::Warning, Said::NoOtherView(id));
                    let pose = self.state.pose;
                    self.change_inspection(|inspection| {
                        (inspection.stage, inspection.pose, inspection.views) = (Stage::AwaitingVerdict(id), pose, 0);
                    });
                    return Turn::Again;
                }
            }
        }
        self.follow_route();
        Turn::Rest
    }

    /// Returns the shortest way to a view that no photo shows yet; empty if the robot stands there. The first photo is
    /// taken from another side, and the next one from two cells off, if both are possible.
    fn way_to_view(&mut self, piece: &Luggage) -> Option<Vec<Move>> {
        let cells = self.cells_of(piece);
        let shown: Vec<Pose> = piece.seen_from.iter().copied().chain([piece.pose]).collect();
        let sides = || cells.iter().flat_map(|cell| Heading::ALL.map(|heading| (*cell, heading)));
        let back = |cell: Cell, heading: Heading| cell.ahead(heading.opposite());
        let is_shown = |heading: Heading| shown.iter().any(|pose| pose.heading == heading && cells.contains(&pose.ahead()));
        let near = sides().filter(|(_, heading)| !is_shown(*heading));
        let near: Vec<Pose> = near.map(|(cell, heading)| Pose { cell: back(cell, heading), heading }).collect();
        let is_clear = |cell: Cell| matches!(self.state.map.at(cell), Mark::Visited | Mark::Seen);
        let far = sides().filter(|(cell, heading)| is_clear(back(*cell, *heading)));
        let far = far.map(|(cell, heading)| Pose { cell: back(back(cell, heading), heading), heading });
        let far: Vec<Pose> = far.filter(|pose| !shown.contains(pose)).collect();
        let is_first =
            self.state.phase.inspection().is_some_and(|inspection| inspection.views == self.settings.rules.unsure_views);
        let [first, second] = if is_first { [near, far] } else { [far, near] };
        self.shortest_way(&first).or_else(|| self.shortest_way(&second))
    }

    fn shortest_way(&mut self, poses: &[Pose]) -> Option<Vec<Move>> {
        let mut ways = Vec::new();
        for pose in poses.iter().filter(|pose| is_in_reach(pose.cell)) {
            let is_shut = self.state.map.at(pose.cell).is_obstacle() || self.planner.keep_out.contains(pose.cell);
            if !is_shut {
                ways.extend(self.planner.way_to_look(self.state.pose, *pose));
            }
        }
        ways.into_iter().filter(|way| way.len() <= LONGEST_WAY).min_by_key(Vec::len)
    }
}
