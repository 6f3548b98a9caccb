//! Leaves that return scripted statuses, for tests of trees.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::document::{Document, Element, Form};
use super::kind::BuiltIn;
use super::leaf::{Catalogue, Direction, Leaf, LeafKind, Leaves, Port};
use super::status::Status;
use super::tree::{NodeId, NodeKind, NodeView, Tree};
use super::value::{Value, ValueType};

/// The name of the mock for every leaf that has no mock of its own.
const ALL_OTHERS: &str = "*";

/// Scripted leaves. The mock of a leaf is looked up by three keys, in this order: the node's path, the node's
/// name, and the name of its kind. If none is found, the mock `*` is used.
#[derive(Clone, Debug, Default)]
pub struct Mocks {
    mocks: BTreeMap<String, Mock>,
    ticks: BTreeMap<NodeId, u64>,
    halted: Vec<NodeId>,
}

#[derive(Clone, Debug, Default)]
struct Mock {
    says: Vec<(Status, u64)>,
    /// The names of ports, and the texts that the mock writes to them whenever it succeeds.
    writes: Vec<(String, String)>,
}

/// Why [`Mocks::add`] refuses a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MockError {
    /// The text has no `=`, or no name before it.
    #[error("{0:?} should be NAME=STATUS,STATUS*3,…")]
    NoName(String),
    /// A word is not a status, or is IDLE, which no leaf returns. Or a number of ticks is not 1 or more.
    #[error("{0:?} is not a status: write RUNNING, SUCCESS, FAILURE or SKIPPED, or RUNNING*3 for three ticks")]
    NoStatus(String),
}

impl Mocks {
    /// Adds a mock from the text `NAME=STATUS,STATUS*3,…`. The list has the results of successive ticks of such a
    /// leaf. The last status is repeated.
    ///
    /// # Errors
    /// If the text has another form.
    pub fn add(&mut self, text: &str) -> Result<(), MockError> {
        let named = text.rsplit_once('=').filter(|(name, _)| !name.is_empty());
        let (name, list) = named.ok_or_else(|| MockError::NoName(text.to_owned()))?;
        let says = list.split(',').map(said).collect::<Result<Vec<(Status, u64)>, MockError>>()?;
        self.mocks.entry(name.to_owned()).or_default().says = says;
        Ok(())
    }

    /// Makes all leaves with this path, name or kind write this text to this port whenever they succeed.
    pub fn write(&mut self, name: &str, port: &str, text: &str) {
        self.mocks.entry(name.to_owned()).or_default().writes.push((port.to_owned(), text.to_owned()));
    }

    /// The nodes that were halted since the last call, in the order of their halts.
    pub fn take_halted(&mut self) -> Vec<NodeId> {
        std::mem::take(&mut self.halted)
    }

    /// Returns a catalogue with the leaves in `known` and the leaves that the document declares. It also has the
    /// leaves that the document uses and that have a mock. All attributes of such a leaf are ports.
    #[must_use]
    pub fn catalogue(&self, document: &Document, mut known: Catalogue) -> Catalogue {
        known.add_models(document);
        for tree in &document.trees {
            self.add_leaves(&tree.root, &mut known);
        }
        known
    }

    /// The first leaf of this tree for which there is no mock. Such a leaf would fail in every tick.
    #[must_use]
    pub fn missing<'t>(&self, tree: &'t Tree) -> Option<NodeView<'t>> {
        let is_leaf = |node: &NodeView<'_>| matches!(node.kind, NodeKind::Leaf(_));
        tree.nodes().filter(is_leaf).find(|node| self.of([node.path, node.name, node.id]).is_none())
    }

    fn add_leaves(&self, element: &Element, known: &mut Catalogue) {
        if is_leaf(element) && known.declared(&element.id).is_none() && self.stands_for(element) {
            let attributes = element.attributes.iter().filter(|attribute| !attribute.name.starts_with('_'));
            let ports = attributes.map(|attribute| Port {
                name: Cow::Owned(attribute.name.clone()),
                direction: Direction::InOut,
                ty: ValueType::Any,
                default: None,
            });
            let name = Cow::Owned(element.id.clone());
            known.add_or_widen(LeafKind { name, is_condition: element.form == Form::Condition, ports: ports.collect() });
        }
        element.children.iter().for_each(|child| self.add_leaves(child, known));
    }

    /// Whether a mock may be meant for this element. A mock's name with `/` or `::` may be a path. The paths of nodes
    /// are not known before the tree is built.
    fn stands_for(&self, element: &Element) -> bool {
        let name = element.name.as_deref().unwrap_or(&element.id);
        let is_path = |key: &String| key.rsplit('/').next().is_some_and(|last| last.split("::").next() == Some(name));
        self.mocks.iter().any(|(key, mock)| {
            let is_meant = key == name || *key == element.id || key == ALL_OTHERS || is_path(key);
            is_meant && !mock.says.is_empty()
        })
    }

    fn of(&self, keys: [&str; 3]) -> Option<&Mock> {
        keys.into_iter().chain([ALL_OTHERS]).filter_map(|key| self.mocks.get(key)).find(|mock| !mock.says.is_empty())
    }
}

/// All leaves of a file that can have a mock, including leaves of trees that do not run.
#[must_use]
pub fn leaves(document: &Document) -> Vec<&Element> {
    fn add<'d>(element: &'d Element, leaves: &mut Vec<&'d Element>) {
        leaves.extend(Some(element).filter(|element| is_leaf(element)));
        element.children.iter().for_each(|child| add(child, leaves));
    }
    let mut leaves = Vec::new();
    document.trees.iter().for_each(|tree| add(&tree.root, &mut leaves));
    leaves
}

/// Whether an element has no children and is not a built-in node.
fn is_leaf(element: &Element) -> bool {
    let may_be = matches!(element.form, Form::Compact | Form::Action | Form::Condition);
    may_be && element.children.is_empty() && BuiltIn::named(&element.id).is_none()
}

/// Parses `STATUS` or `STATUS*3`.
fn said(text: &str) -> Result<(Status, u64), MockError> {
    let no_status = || MockError::NoStatus(text.to_owned());
    let (word, times) = text.trim().split_once('*').unwrap_or((text.trim(), "1"));
    let status = Status::named(&word.trim().to_ascii_uppercase()).filter(|status| *status != Status::Idle);
    let times = times.trim().parse().ok().filter(|times| *times > 0);
    status.zip(times).ok_or_else(no_status)
}

impl Leaves for Mocks {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let ticks = self.ticks.entry(leaf.node()).or_default();
        let before = *ticks;
        *ticks += 1;
        let Some(mock) = self.of([leaf.path(), leaf.name(), leaf.id()]) else { return Status::Failure };
        let mut left = before;
        let says = mock.says.iter().find(|(_, times)| {
            let is_now = left < *times;
            left = left.saturating_sub(*times);
            is_now
        });
        let status = says.or(mock.says.last()).map_or(Status::Failure, |(status, _)| *status);
        if status == Status::Success {
            let keys = [leaf.path(), leaf.name(), leaf.id(), ALL_OTHERS].map(str::to_owned);
            let writes: Vec<(String, String)> =
                keys.iter().filter_map(|key| self.mocks.get(key)).flat_map(|mock| mock.writes.clone()).collect();
            for (port, text) in writes {
                if let Some(port) = leaf.port(&port) {
                    leaf.write(port, Value::text(&text));
                }
            }
        }
        status
    }

    fn halt(&mut self, leaf: &mut Leaf<'_>) {
        self.halted.push(leaf.node());
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::Blackboard;

    fn leaf(id: &str, name: &str) -> Element {
        Element::new(id, Vec::new()).named(name).with("at", "{here}")
    }

    #[test]
    fn a_mock_is_found_by_name_then_by_kind_and_its_last_status_stays() {
        let document = Document::of("T", Element::new("Parallel", vec![leaf("Go", "a"), leaf("Go", "b"), leaf("See", "c")]));
        let mut mocks = Mocks::default();
        for text in ["b=RUNNING*2,SUCCESS", "Go=running", "*=SKIPPED,RUNNING"] {
            mocks.add(text).expect("it is well written");
        }
        mocks.write("b", "at", "3;4");
        let mut blackboard = Blackboard::new();
        let catalogue = mocks.catalogue(&document, Catalogue::default());
        let mut tree = Tree::build(&document, None, &catalogue, &mut blackboard).expect("all leaves have mocks");
        assert_eq!(mocks.missing(&tree), None);
        let mut said = Vec::new();
        for _ in 0..3 {
            tree.tick(&mut blackboard, &mut mocks, Duration::ZERO).expect("no fault");
            said.push(tree.nodes().skip(1).map(|node| node.status()).collect::<Vec<Status>>());
        }
        use Status::{Running, Skipped, Success};
        assert_eq!(said, [[Running, Running, Skipped], [Running, Running, Running], [Running, Success, Running]]);
        assert_eq!(blackboard.get("here"), Some(&Value::text("3;4")));
    }

    #[test]
    fn what_is_no_mock_is_said() {
        let refused = |text: &str| Mocks::default().add(text).expect_err(text).to_string();
        assert_eq!(refused("Go"), "\"Go\" should be NAME=STATUS,STATUS*3,…");
        assert!(refused("Go=IDLE").starts_with("\"IDLE\" is not a status"));
        assert!(refused("Go=RUNNING*0").starts_with("\"RUNNING*0\" is not a status"));
    }

    #[test]
    fn a_leaf_without_a_mock_is_found_if_its_tree_uses_it() {
        let go = Document::of("T", leaf("Go", "a")).with_tree("unused", leaf("Fly", "b"));
        let catalogue = Catalogue::new(vec![LeafKind::action("Go", vec![Port::output("at", ValueType::Any)])]);
        let tree = Tree::build(&go, None, &catalogue, &mut Blackboard::new()).expect("its leaf is known");
        let mut mocks = Mocks::default();
        assert_eq!(mocks.missing(&tree).map(|node| node.name), Some("a"));
        mocks.add("Go=SUCCESS").expect("it is well written");
        assert_eq!(mocks.missing(&tree), None);
    }
}
