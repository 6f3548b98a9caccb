//! The three items of the resource model for old clients (mission §8), as the CoAP resource writes them. The MQTT
//! door writes the same items as Prolog terms. The doors decide when each item is sent.

use super::map_text;
use super::time::rfc3339;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::robot::RobotView;
use hallsweep_core::units::Heading;
use hallsweep_core::world::luggage::{Luggage, PhotoState};

/// The item of the robot, as `robot( state(stopped), direction(downDir), position(0, 0))`.
pub fn robot(robot: &RobotView) -> String {
    let cell = robot.pose.cell;
    let (state, direction) = (robot.state.name(), direction(robot.pose.heading));
    format!("robot( state({state}), direction({direction}), position({}, {}))", cell.x, cell.y)
}

/// The item of the map, as `roomMap( 'r 1 X @' )`.
pub fn room_map(snapshot: &Snapshot) -> String {
    format!("roomMap( '{}' )", map_text::one_line(snapshot))
}

/// The item of the luggage, as `luggage( state( 'photo 1, position: (0, 2), date: 2026-02-03T10:05:12.000+01:00' )
/// )`. `None` before the first piece is found.
pub fn luggage(snapshot: &Snapshot) -> Option<String> {
    let shown = snapshot.pending().or(snapshot.luggage.last())?;
    Some(format!("luggage( state( '{}' ) )", luggage_state(shown)))
}

pub fn luggage_state(luggage: &Luggage) -> String {
    let cell = luggage.cell;
    let failed = if matches!(luggage.photo, PhotoState::Failed(_)) { " failed" } else { "" };
    format!("photo {}{failed}, position: ({}, {}), date: {}", luggage.id, cell.x, cell.y, rfc3339(luggage.taken))
}

pub const fn direction(heading: Heading) -> &'static str {
    match heading {
        Heading::North => "upDir",
        Heading::East => "rightDir",
        Heading::South => "downDir",
        Heading::West => "leftDir",
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::api::tests::fixture::{drawn, idle, piece, searching};
    use hallsweep_core::robot::RobotState;
    use hallsweep_core::units::{Cell, LuggageId, Pose};

    #[test]
    fn a_robot_is_written_as_old_clients_expect_it() {
        let mut state = idle();
        assert_eq!(robot(&state.robot), "robot( state(stopped), direction(downDir), position(0, 0))");
        state.robot.state = RobotState::MovingForward;
        state.robot.pose = Pose { cell: Cell::new(-3, 12), heading: Heading::West };
        assert_eq!(robot(&state.robot), "robot( state(movingForward), direction(leftDir), position(-3, 12))");
        assert_eq!((direction(Heading::North), direction(Heading::East)), ("upDir", "rightDir"));
    }

    #[test]
    fn a_map_is_written_as_old_clients_expect_it() {
        let mut state = idle();
        state.map = drawn(&["11W"], 2);
        assert_eq!(room_map(&state), "roomMap( 'r 1 X @' )");
    }

    #[test]
    fn a_piece_is_written_with_the_cell_of_the_bag() {
        let mut state = idle();
        assert_eq!(luggage(&state), None);
        state.luggage = [piece(1, Cell::new(0, 2), None)].into();
        let item = "luggage( state( 'photo 1, position: (0, 2), date: 2026-02-03T10:00:00.000+01:00' ) )";
        assert_eq!(luggage(&state).as_deref(), Some(item));
    }

    #[test]
    fn a_photo_that_failed_is_not_told_as_one_that_is_there() {
        let failed = Luggage { photo: PhotoState::Failed("lens".to_owned()), ..Luggage::clone(&piece(1, Cell::new(0, 2), None)) };
        assert!(luggage_state(&failed).starts_with("photo 1 failed, position: (0, 2), date: "));
    }

    #[test]
    fn the_piece_that_is_shown_is_the_one_a_bare_word_would_decide_else_the_last() {
        let mut state = searching();
        assert!(luggage(&state).unwrap().contains("photo 3,"));
        state.luggage = [piece(7, Cell::new(1, 0), None), searching().luggage[1].clone()].into();
        state.mission.inspected = Some(LuggageId(7));
        assert!(luggage(&state).unwrap().contains("photo 7,"));
        state.luggage = searching().luggage.iter().take(2).cloned().collect();
        assert!(luggage(&state).unwrap().contains("photo 2,"));
    }
}
