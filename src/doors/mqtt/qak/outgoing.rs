//! The messages about the original system's resource model (mission §8): the three kinds of content in
//! `modelContent`, and the message around them. When they are published is decided elsewhere.

use super::message::{Message, MessageKind};
use super::term::Term;
use crate::api::{map_text, old_items};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::luggage::Luggage;

pub(super) const MODEL_CONTENT: &str = "modelContent";

/// Returns a term such as `content(robot(state(movingForward),direction(downDir),position(0,0)))`.
pub fn robot(snapshot: &Snapshot) -> Term {
    let (robot, cell) = (&snapshot.robot, snapshot.robot.pose.cell);
    let direction = Term::atom(old_items::direction(robot.pose.heading));
    let parts = [
        state(robot.state.name()),
        Term::compound("direction", [direction]),
        Term::compound("position", [Term::whole(cell.x), Term::whole(cell.y)]),
    ];
    content("robot", parts)
}

/// Returns a term such as `content(roomMap(state('r 1 1 X @1 1 1 X @X X 0 X @')))`.
pub fn room_map(snapshot: &Snapshot) -> Term {
    content("roomMap", [state(map_text::one_line(snapshot))])
}

/// Returns a term such as `content(luggage(state('photo 1, position: (0, 2), date:
/// 2026-02-03T10:05:12.000+01:00')))`.
pub fn luggage(luggage: &Luggage) -> Term {
    content("luggage", [state(old_items::luggage_state(luggage))])
}

/// Returns the reason of a refusal as a term such as `content(luggage(state('refused: luggage #3 has no usable
/// photo')))`. Old consoles show it in place of a piece.
pub fn why_not(words: &str) -> Term {
    let mut text = format!("refused: {words}");
    while text.contains("))") {
        text = text.replace("))", ") )");
    }
    content("luggage", [state(text)])
}

/// The number of every message that answers a command. Such messages are not counted.
pub const ANSWER: u64 = 0;

/// Whether a message made by `message` has a counted number, which is any number except `ANSWER`.
pub fn is_counted(message: &[u8]) -> bool {
    !message.ends_with(format!(",{ANSWER})").as_bytes())
}

/// Returns the text `msg(modelContent,event,resourcemodel,none,CONTENT,NUMBER)`.
pub fn message(content: Term, number: u64) -> String {
    let (sender, receiver) = ("resourcemodel".to_owned(), "none".to_owned());
    Message { id: MODEL_CONTENT.to_owned(), kind: MessageKind::Event, sender, receiver, content, number }.to_string()
}

/// Builds a content for old consoles. An old console searches for the word `content`, and shows the text from the
/// first `state` to the first `))`. So no part may contain `))`.
fn content(name: &str, parts: impl Into<Vec<Term>>) -> Term {
    Term::compound("content", [Term::compound(name, parts)])
}

fn state(text: impl Into<String>) -> Term {
    Term::compound("state", [Term::atom(text)])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::api::tests::fixture::{drawn, idle, piece, searching};
    use hallsweep_core::robot::RobotState;
    use hallsweep_core::units::{Cell, Heading, Pose, WallTime};

    /// Returns the part of a message that an old console shows.
    fn shown(text: &str) -> &str {
        assert!(text.contains("content"), "the word it looks for: {text}");
        let from = &text[text.find("state").unwrap()..];
        &from[..from.find("))").unwrap()]
    }

    #[test]
    fn an_old_console_shows_what_the_robot_does() {
        let mut state = idle();
        state.robot.state = RobotState::MovingForward;
        assert_eq!(robot(&state).to_string(), "content(robot(state(movingForward),direction(downDir),position(0,0)))");
        let text = message(robot(&state), 1);
        assert_eq!(
            text,
            "msg(modelContent,event,resourcemodel,none,content(robot(state(movingForward),direction(downDir),position(0,0))),1)"
        );
        assert_eq!(shown(&text), "state(movingForward),direction(downDir),position(0,0");
        state.robot.pose = Pose { cell: Cell::new(-3, 12), heading: Heading::West };
        assert_eq!(shown(&message(robot(&state), 2)), "state(movingForward),direction(leftDir),position(-3,12");
    }

    #[test]
    fn an_old_console_shows_the_map() {
        let mut state = idle();
        state.map = drawn(&["111W", "111W", "WW?W"], 2);
        let text = message(room_map(&state), 9);
        assert_eq!(text, "msg(modelContent,event,resourcemodel,none,content(roomMap(state('r 1 1 X @1 1 1 X @X X 0 X @'))),9)");
        assert_eq!(shown(&text), "state('r 1 1 X @1 1 1 X @X X 0 X @'");
    }

    #[test]
    fn an_old_console_shows_a_piece_of_luggage() {
        let text = message(luggage(&piece(1, Cell::new(0, 2), None)), 3);
        let state = "state('photo 1, position: (0, 2), date: 2026-02-03T10:00:00.000+01:00'";
        assert_eq!(text, format!("msg(modelContent,event,resourcemodel,none,content(luggage({state}))),3)"));
        assert_eq!(shown(&text), state);
    }

    #[test]
    fn an_old_console_shows_why_a_verdict_was_not_taken() {
        let text = message(why_not("no photo (the lens (left)) is covered))): take it again"), ANSWER);
        assert_eq!(shown(&text), "state('refused: no photo (the lens (left) ) is covered) ) ): take it again'");
        assert!(!is_counted(text.as_bytes()) && is_counted(message(room_map(&idle()), 10).as_bytes()));
    }

    #[test]
    fn even_the_smallest_map_is_in_quotes_and_every_state_keeps_the_shape() {
        assert_eq!(room_map(&idle()).to_string(), "content(roomMap(state('r @')))");
        let state = searching();
        for content in [robot(&state), room_map(&state), luggage(&state.luggage[0])] {
            let text = message(content.clone(), u64::MAX);
            assert_eq!(Message::parse(text.as_bytes()).unwrap().content, content);
        }
    }

    proptest! {
        #[test]
        fn whenever_and_wherever_a_piece_is_found_the_whole_of_it_is_shown(
            id in any::<u64>(), x in any::<i32>(), y in any::<i32>(), unix_ms in any::<i64>(), offset_s in any::<i32>(),
        ) {
            let mut found = Luggage::clone(&piece(id, Cell::new(1, 1), None));
            (found.cell, found.taken) = (Cell::new(x, y), WallTime { unix_ms, offset_s });
            let text = message(luggage(&found), 1);
            prop_assert_eq!(shown(&text), format!("state('{}'", old_items::luggage_state(&found)));
        }
    }
}
