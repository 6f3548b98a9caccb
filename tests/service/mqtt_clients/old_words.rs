//! The old topics as the tests read and write them: messages to the robot, and messages of the resource model. The
//! expected contents come from the HTTP interface.

use serde_json::Value;

use super::told::Message;
use crate::coap_clients::shown;
use crate::program::Program;

/// Topic of events.
pub(super) const EVENTS: &str = "unibo/qak/events";

/// Beginning of each message of the resource model, before the content.
const HEAD: &str = "msg(modelContent,event,resourcemodel,none,";

/// Message of an old client that sends a command as an event.
pub(super) fn event(name: &str) -> String {
    format!("msg({name},event,js,none,{name},1)")
}

/// Contents and sequence numbers of the messages of the resource model.
pub(super) fn model(heard: &[Message]) -> Vec<(&str, u64)> {
    let ours = heard.iter().filter(|message| message.topic == EVENTS);
    ours.filter_map(|message| {
        let (content, number) = message.payload.strip_prefix(HEAD)?.strip_suffix(')')?.rsplit_once(',')?;
        Some((content, number.parse().expect("a SEQNUM")))
    })
    .collect()
}

/// Newest content with this head, such as `robot`. Messages with number 0 are answers to a command and do not
/// describe the state.
pub(super) fn newest<'a>(heard: &'a [Message], head: &str) -> Option<&'a str> {
    let head = format!("content({head}(");
    let counted = model(heard).into_iter().filter(|(_, number)| *number > 0);
    counted.map(|(content, _)| content).rfind(|content| content.starts_with(&head))
}

/// Number of the piece that was shown last.
pub(super) fn piece(heard: &[Message]) -> Option<u64> {
    newest(heard, "luggage")?.split_once("photo ")?.1.split_once(',')?.0.parse().ok()
}

/// Fails unless the sequence numbers have no gap.
pub(super) fn check_numbers(heard: &[Message]) {
    // Messages with number 0 are answers and are not part of the sequence.
    let numbers: Vec<u64> = model(heard).into_iter().map(|(_, number)| number).filter(|number| *number > 0).collect();
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{numbers:?}");
    assert!(numbers.len() > 8, "it heard the search, not only its end: {numbers:?}");
}

/// Expected robot content for this state.
pub(super) fn robot(state: &Value) -> String {
    format!("content({})", shown::robot(state).replace(' ', ""))
}

/// Expected map content.
pub(super) fn map(program: &Program) -> String {
    format!("content(roomMap(state('{}')))", quoted(&shown::map(program)))
}

/// Expected content of the last piece for this state.
pub(super) fn luggage(state: &Value) -> String {
    format!("content(luggage(state('{}')))", quoted(&shown::luggage(state)))
}

fn quoted(item: &str) -> &str {
    item.split('\'').nth(1).expect("something in quotes")
}
