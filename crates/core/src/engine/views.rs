//! Further photos of a piece that a judge was unsure about: from another side, and from two cells off. The piece waits
//! for its verdict meanwhile. Afterwards it is asked again.

use std::sync::Arc;

use super::Engine;
use super::motion::Turn;
use crate::command::Move;
use crate::mission::InputContext;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::state::{Inspection, Stage};
use crate::units::{Cell, Heading, LuggageId, Pose};
use crate::world::hall_map::{Mark, is_in_reach};
use crate::world::luggage::Luggage;
use crate::world::resource::Resource;

/// Most moves to a view, with all detours, since the last photo or start of the program. More would be a search of the
/// hall.
const MOST_MOVES: usize = 24;

/// Longest distance from which a piece may have been photographed, in cells. No sonar sees farther.
const FARTHEST: usize = 8;

/// Most places that are tried for a view, the nearest ones first. It bounds the work for a large piece.
const MOST_PLACES: usize = 8;

impl Engine {
    /// Records that a judge is unsure. If the piece has just been asked about, sends the robot round it.
    pub(super) fn record_unsure(&mut self, context: &InputContext) {
        let (Some(luggage), Some(issuer)) = (context.luggage, &context.issuer) else { return };
        let (who, note, hot) = (issuer.who.clone(), context.note.clone(), context.hot);
        let views = self.settings.rules.unsure_views;
        let has_taken_back = self.take_back(luggage, issuer);
        let is_viewing = self.state.phase.inspection().is_some_and(Inspection::is_viewing);
        // A second press while the robot goes round the piece says nothing new.
        let latest = self.state.luggage.get(luggage).and_then(|piece| piece.unsure.last());
        let says_so = latest.is_some_and(|doubt| (&doubt.who, &doubt.note, doubt.hot) == (&who, &note, hot));
        if is_viewing && says_so && !has_taken_back {
            return;
        }
        self.world.touch(Resource::Mission);
        self.record(Fact::Unsure { luggage, who, note, hot });
        if views == 0 || is_viewing {
            return;
        }
        self.mission.route.clear();
        self.mission.view_moves = 0;
        self.change_inspection(|inspection| {
            inspection.views = views;
            if inspection.stage == Stage::AwaitingVerdict(luggage) {
                inspection.stage = Stage::Viewing(luggage);
            }
        });
    }

    /// Drives to the next view and takes its photo. If no view is left, drives back to the place of the latest photo,
    /// and the piece is asked again.
    pub(super) fn view_piece(&mut self, id: LuggageId) -> Turn {
        if !self.mission.route.is_empty() {
            self.mission.view_moves += 1;
            self.follow_route();
            return Turn::Rest;
        }
        let (most, here) = (self.settings.rules.unsure_views, self.state.pose);
        let Some((views, place)) = self.state.phase.inspection().map(|inspection| (inspection.views, inspection.pose)) else {
            return Turn::Rest;
        };
        let left = views.min(most);
        if left == 0 {
            let back = self.planner.way_to_pose(here, place).unwrap_or_default();
            if back.is_empty() {
                self.set_stage(Stage::AwaitingVerdict(id))
            } else {
                self.set_route(Some(back))
            }
            return Turn::Again;
        }
        let piece = self.state.luggage.get(id).map(Arc::clone);
        match piece.and_then(|piece| self.way_to_view(&piece, left == most)) {
            Some(way) if way.is_empty() => {
                self.mission.view_moves = 0;
                self.change_inspection(|inspection| {
                    (inspection.stage, inspection.pose, inspection.views) = (Stage::RetakingPhoto(id), here, left - 1);
                });
            }
            Some(way) => self.set_route(Some(way)),
            None => {
                self.world.write(self.now.wall, Tone::Warning, Said::NoOtherView(id));
                self.change_inspection(|inspection| inspection.views = 0);
            }
        }
        Turn::Again
    }

    /// Ends the taking of another photo. If further views are left, the robot drives on.
    pub(super) fn end_photo(&mut self, id: LuggageId) {
        let has_views = self.state.phase.inspection().is_some_and(|inspection| inspection.views > 0);
        self.set_stage(if has_views { Stage::Viewing(id) } else { Stage::AwaitingVerdict(id) });
    }

    /// Returns the shortest way to a view that no photo shows yet; empty if the robot stands there. The first photo is
    /// taken from another side, and the next one from two cells off. Where this is not possible, the other kind is
    /// taken.
    fn way_to_view(&mut self, piece: &Luggage, is_first: bool) -> Option<Vec<Move>> {
        let cells = self.cells_of(piece);
        let latest = piece.has_photo().then_some(piece.pose);
        let shown: Vec<Pose> = piece.seen_from.iter().copied().chain(latest).collect();
        let sides = || cells.iter().flat_map(|cell| Heading::ALL.map(|heading| (*cell, heading)));
        let back = |cell: Cell, heading: Heading| cell.ahead(heading.opposite());
        let looks_at_it = |pose: &Pose| {
            let ahead = std::iter::successors(Some(pose.ahead()), |cell| Some(cell.ahead(pose.heading)));
            ahead.take(FARTHEST).any(|cell| cells.contains(&cell))
        };
        let is_shown = |heading: Heading| shown.iter().any(|pose| pose.heading == heading && looks_at_it(pose));
        let near = sides().filter(|(_, heading)| !is_shown(*heading));
        let near: Vec<Pose> = near.map(|(cell, heading)| Pose { cell: back(cell, heading), heading }).collect();
        let is_clear = |cell: Cell| matches!(self.state.map.at(cell), Mark::Visited | Mark::Seen);
        let far = sides().filter(|(cell, heading)| is_clear(back(*cell, *heading)));
        let far = far.map(|(cell, heading)| Pose { cell: back(back(cell, heading), heading), heading });
        let far: Vec<Pose> = far.filter(|pose| !shown.contains(pose)).collect();
        let [first, second] = if is_first { [near, far] } else { [far, near] };
        self.shortest_way(first).or_else(|| self.shortest_way(second))
    }

    fn shortest_way(&mut self, mut poses: Vec<Pose>) -> Option<Vec<Move>> {
        let here = self.state.pose;
        let steps = |pose: &Pose| (pose.cell.x.abs_diff(here.cell.x) + pose.cell.y.abs_diff(here.cell.y)) as usize;
        let most = MOST_MOVES.saturating_sub(self.mission.view_moves);
        let is_shut = |cell: Cell| self.state.map.at(cell).is_obstacle() || self.planner.keep_out.contains(cell);
        poses.retain(|pose| is_in_reach(pose.cell) && steps(pose) <= most && !is_shut(pose.cell));
        poses.sort_by_key(steps);
        let ways = poses.into_iter().take(MOST_PLACES).filter_map(|pose| self.planner.way_to_look(here, pose));
        ways.filter(|way| way.len() <= most).min_by_key(Vec::len)
    }
}
