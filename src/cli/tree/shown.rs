//! Prints a tick: as a tree for people, as a line of JSON for programs.

use std::collections::BTreeMap;
use std::fmt::Write;

use behaviour_trees::kind::Family;
use behaviour_trees::{Blackboard, Fault, NodeId, Status, Tree, Value};
use serde::Serialize;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Tick<'a> {
    tick: u64,
    time_ms: u128,
    status: &'static str,
    nodes: Vec<Node<'a>>,
    blackboard: BTreeMap<&'a str, serde_json::Value>,
}

#[derive(Serialize)]
struct Node<'a> {
    uid: u32,
    path: &'a str,
    name: &'a str,
    kind: &'a str,
    status: &'static str,
    after: &'static str,
    ticked: bool,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    halted: bool,
}

#[derive(Serialize)]
struct Faulted<'a> {
    tick: u64,
    path: &'a str,
    line: u32,
    error: &'a str,
}

pub(super) fn json(tree: &Tree, status: Status, halted: &[NodeId], blackboard: &Blackboard) -> String {
    let nodes = tree.nodes().map(|view| Node {
        uid: view.node.0 + 1,
        path: view.path,
        name: view.name,
        kind: view.id,
        status: view.status().word(),
        after: view.after.word(),
        ticked: view.returned.is_some(),
        halted: halted.contains(&view.node),
    });
    let nodes = nodes.collect();
    let held = blackboard.entries().filter_map(|entry| Some((entry.name(), json_value(entry.value()?))));
    let tick =
        Tick { tick: tree.ticks(), time_ms: tree.clock().as_millis(), status: status.word(), nodes, blackboard: held.collect() };
    serde_json::to_string(&tick).expect("texts and numbers can be written")
}

pub(super) fn json_fault(tick: u64, fault: &Fault) -> String {
    let faulted = Faulted { tick, path: &fault.path, line: fault.place.line, error: &fault.reason };
    serde_json::to_string(&faulted).expect("texts and numbers can be written")
}

fn json_value(value: &Value) -> serde_json::Value {
    match value {
        Value::Bool(truth) => (*truth).into(),
        Value::Int(number) => (*number).into(),
        Value::Number(number) => (*number).into(),
        Value::Text(text) => (**text).into(),
        Value::Cell(cell) => serde_json::json!({ "x": cell.x, "y": cell.y }),
    }
}

/// A tick for people: the result of each node, with `·` for a node that was not ticked and keeps its status.
pub(super) fn picture(tree: &Tree, status: Status, halted: &[NodeId], blackboard: &Blackboard) -> String {
    let mut text = format!("tick {} at {:.1} s: {}", tree.ticks(), tree.clock().as_secs_f64(), status.word());
    for view in tree.nodes() {
        let said = match view.returned {
            Some(said) => said.word(),
            None if view.after == Status::Idle => "·",
            None => view.after.word(),
        };
        let mark = if view.family == Family::Leaf { "" } else { " ▸" };
        let named = if view.name == view.id { view.id.to_owned() } else { format!("{} {}", view.id, view.name) };
        let end = if halted.contains(&view.node) { "  (halted)" } else { "" };
        // Writing to a String cannot fail.
        let _ = write!(text, "\n  {said:<8}{}{mark} {named}{end}", "  ".repeat(view.depth));
    }
    let held: Vec<String> =
        blackboard.entries().filter_map(|entry| Some(format!("{} = {}", entry.name(), entry.value()?))).collect();
    if !held.is_empty() {
        let _ = write!(text, "\n  {{ {} }}", held.join(", "));
    }
    text
}
