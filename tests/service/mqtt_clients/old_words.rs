//! The old topics as the tests read and write them: messages to the robot, and what the resource model says. The truth beside it is
//! what the HTTP door shows.

use serde_json::Value;

use super::told::Message;
use crate::coap_clients::shown;
use crate::program::Program;

/// Where events are.
pub(super) const EVENTS: &str = "unibo/qak/events";

/// What stands before the content of each message of the resource model.
const HEAD: &str = "msg(modelContent,event,resourcemodel,none,";

/// A message of an old client: a command as an event.
pub(super) fn event(name: &str) -> String {
    format!("msg({name},event,js,none,{name},1)")
}

/// What the resource model said: contents and numbers.
pub(super) fn model(heard: &[Message]) -> Vec<(&str, u64)> {
    let ours = heard.iter().filter(|message| message.topic == EVENTS);
    ours.filter_map(|message| {
        let (content, number) = message.payload.strip_prefix(HEAD)?.strip_suffix(')')?.rsplit_once(',')?;
        Some((content, number.parse().expect("a SEQNUM")))
    })
    .collect()
}

/// The newest content with this head, as `robot`; what is numbered 0 answers somebody, and says nothing of what stands.
pub(super) fn newest<'a>(heard: &'a [Message], head: &str) -> Option<&'a str> {
    let head = format!("content({head}(");
    let counted = model(heard).into_iter().filter(|(_, number)| *number > 0);
    counted.map(|(content, _)| content).rfind(|content| content.starts_with(&head))
}

/// The number of the piece that was shown last.
pub(super) fn piece(heard: &[Message]) -> Option<u64> {
    newest(heard, "luggage")?.split_once("photo ")?.1.split_once(',')?.0.parse().ok()
}

/// Fails unless every number is the one before and one more.
pub(super) fn check_numbers(heard: &[Message]) {
    // 0 is an answer to what was said, and counts as none of them.
    let numbers: Vec<u64> = model(heard).into_iter().map(|(_, number)| number).filter(|number| *number > 0).collect();
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{numbers:?}");
    assert!(numbers.len() > 8, "it heard the search, not only its end: {numbers:?}");
}

/// The robot as it stands.
pub(super) fn robot(state: &Value) -> String {
    format!("content({})", shown::robot(state).replace(' ', ""))
}

/// The map as it stands.
pub(super) fn map(program: &Program) -> String {
    format!("content(roomMap(state('{}')))", quoted(&shown::map(program)))
}

/// The last piece as it stands.
pub(super) fn luggage(state: &Value) -> String {
    format!("content(luggage(state('{}')))", quoted(&shown::luggage(state)))
}

fn quoted(item: &str) -> &str {
    item.split('\'').nth(1).expect("something in quotes")
}
