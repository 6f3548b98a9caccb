//! Random trees with leaves that return random statuses. A failure prints the tree, and proptest can replay it.

use std::time::Duration;

use behaviour_trees::document::{Attribute, Form, Kept, Model, ModelPort};
use behaviour_trees::kind::{BuiltIn, Family};
use behaviour_trees::{
    Blackboard, Catalogue, Direction, Document, Element, Leaf, LeafKind, Leaves, NodeId, Port, Status, Tree, TreeState,
    ValueType, xml,
};
use proptest::prelude::*;
use proptest::sample::select;

use super::reference::{Reference, World};

const PERIOD: Duration = Duration::from_millis(50);

/// Leaves that return the words in their attribute, one per tick, and repeat the last.
#[derive(Clone, Default)]
struct Scripted {
    ticks: Vec<usize>,
    halted: Vec<String>,
    /// Nodes that returned RUNNING, and have neither ended nor been halted since.
    running: Vec<NodeId>,
}

impl Leaves for Scripted {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let node = leaf.node().0 as usize;
        self.ticks.resize(self.ticks.len().max(node + 1), 0);
        let words: Vec<&str> = leaf.text(0).unwrap().split(',').collect();
        let status = Status::named(words[self.ticks[node].min(words.len() - 1)]).unwrap();
        assert_eq!(leaf.is_starting(), !self.running.contains(&leaf.node()));
        self.ticks[node] += 1;
        // A skipped node keeps its state.
        if status != Status::Skipped {
            self.running.retain(|running| *running != leaf.node());
        }
        if status == Status::Running {
            self.running.push(leaf.node());
        }
        status
    }

    fn halt(&mut self, leaf: &mut Leaf<'_>) {
        assert!(self.running.contains(&leaf.node()), "{} is halted and was not running", leaf.path());
        self.running.retain(|running| *running != leaf.node());
        self.halted.push(leaf.name().to_owned());
    }
}

fn catalogue() -> Catalogue {
    Catalogue::new(vec![LeafKind::action("Leaf", vec![Port::input("says", ValueType::Text)])])
}

fn build(root: &Element) -> Tree {
    Tree::build(&Document::of("T", root.clone()), None, &catalogue(), &mut Blackboard::new()).unwrap()
}

fn leaf(words: &'static [&'static str]) -> impl Strategy<Value = Element> {
    prop::collection::vec(select(words), 1..5).prop_map(|says| Element::new("Leaf", vec![]).with("says", &says.join(",")))
}

fn trees(kinds: &'static [&'static str], words: &'static [&'static str]) -> impl Strategy<Value = Element> {
    let tree = leaf(words).prop_recursive(5, 40, 4, move |inner| {
        let children = prop::collection::vec(inner, 1..5);
        (select(kinds), children, -2_i64..4, -2_i64..3).prop_map(|(kind, children, first, second)| {
            let most = BuiltIn::named(kind).unwrap();
            let children: Vec<Element> = match (most.family(), kind) {
                (Family::Leaf, _) => Vec::new(),
                (Family::Decorator, _) => children.into_iter().take(1).collect(),
                (Family::Control, "IfThenElse" | "WhileDoElse") => {
                    children.iter().cycle().take(children.len().clamp(2, 3)).cloned().collect()
                }
                (Family::Control, _) => children,
            };
            // A second AsyncSequence in a ReactiveSequence is refused.
            let mut asyncs = 0;
            let is_allowed = |child: &Element| {
                asyncs += u32::from(child.id == "AsyncSequence");
                kind != "ReactiveSequence" || child.id != "AsyncSequence" || asyncs < 2
            };
            let children = children.into_iter().filter(is_allowed).collect();
            let element = Element::new(kind, children);
            match kind {
                "Parallel" => element.with("success_count", &first.to_string()).with("failure_count", &second.to_string()),
                "ParallelAll" => element.with("max_failures", &second.to_string()),
                "RetryUntilSuccessful" => element.with("num_attempts", &first.max(-1).to_string()),
                "Repeat" => element.with("num_cycles", &first.max(-1).to_string()),
                "Timeout" | "Sleep" => element.with("msec", &(first.abs() * 50).to_string()),
                "Delay" => element.with("delay_msec", &(first.abs() * 50).to_string()),
                _ => element,
            }
        })
    });
    tree.prop_map(|mut root| {
        fn number(element: &mut Element, next: &mut u32) {
            element.name = Some(format!("n{next}"));
            *next += 1;
            element.children.iter_mut().for_each(|child| number(child, next));
        }
        number(&mut root, &mut 0);
        root
    })
}

const WORDS: &[&str] = &["RUNNING", "SUCCESS", "FAILURE", "SKIPPED"];

const KINDS: &[&str] = &[
    "Sequence",
    "AsyncSequence",
    "SequenceWithMemory",
    "ReactiveSequence",
    "Fallback",
    "AsyncFallback",
    "ReactiveFallback",
    "Parallel",
    "ParallelAll",
    "IfThenElse",
    "WhileDoElse",
    "Inverter",
    "RetryUntilSuccessful",
    "Repeat",
    "Timeout",
    "Delay",
    "ForceSuccess",
    "ForceFailure",
    "RunOnce",
    "KeepRunningUntilFailure",
    "AlwaysSuccess",
    "AlwaysFailure",
    "Sleep",
];

/// Kinds that never return RUNNING while their children are done.
const PROMPT: &[&str] = &[
    "Sequence",
    "ReactiveSequence",
    "Fallback",
    "ReactiveFallback",
    "ParallelAll",
    "IfThenElse",
    "WhileDoElse",
    "Inverter",
    "ForceSuccess",
    "ForceFailure",
    "RunOnce",
    "AlwaysSuccess",
    "AlwaysFailure",
];

/// The visible result of a tick: what each node returned, its status, and the leaves that were halted.
type Shown = (Result<Status, ()>, Vec<(Option<Status>, Status)>, Vec<String>);

fn shown(tree: &mut Tree, leaves: &mut Scripted) -> Shown {
    let said = tree.tick(&mut Blackboard::new(), leaves, PERIOD).map_err(|_| ());
    let nodes = tree.nodes().map(|node| (node.returned, node.after)).collect();
    (said, nodes, std::mem::take(&mut leaves.halted))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_tree_does_what_the_plain_interpreter_does(root in trees(KINDS, WORDS)) {
        let (mut tree, mut leaves) = (build(&root), Scripted::default());
        let (mut reference, mut world) = (Reference::new(&root), World::default());
        for tick in 0..25 {
            let (said, nodes, halted) = shown(&mut tree, &mut leaves);
            world.clock_ms += 50;
            let expected = reference.tick_root(&mut world);
            prop_assert_eq!(said, expected, "tick {} of {:#?}", tick, root);
            if said.is_err() {
                break;
            }
            let mut standing = Vec::new();
            reference.visit(&mut |node| standing.push((node.returned, node.status)));
            prop_assert_eq!(nodes, standing, "tick {} of {}", tick, xml::write(&Document::of("T", root.clone())));
            prop_assert_eq!(halted, std::mem::take(&mut world.halted), "tick {}", tick);
        }
    }

    #[test]
    fn a_halt_reaches_every_leaf_that_runs_and_no_other(root in trees(KINDS, WORDS), ticks in 1_usize..12) {
        let (mut tree, mut leaves) = (build(&root), Scripted::default());
        for _ in 0..ticks {
            // The leaves themselves check that only running ones are halted.
            let (said, nodes, _) = shown(&mut tree, &mut leaves);
            if said.is_err() {
                prop_assert!(leaves.running.is_empty(), "after a fault nothing runs");
                prop_assert!(nodes.iter().all(|(_, after)| *after == Status::Idle));
            }
        }
        tree.halt(&mut Blackboard::new(), &mut leaves);
        prop_assert!(leaves.running.is_empty());
        prop_assert!(tree.nodes().all(|node| node.after == Status::Idle));
    }

    #[test]
    fn a_tree_without_anything_that_takes_time_is_done_in_one_tick(root in trees(PROMPT, &["SUCCESS", "FAILURE"])) {
        let (mut tree, mut leaves) = (build(&root), Scripted::default());
        let (said, nodes, halted) = shown(&mut tree, &mut leaves);
        if let Ok(said) = said {
            prop_assert_ne!(said, Status::Running);
            prop_assert!(halted.is_empty() && nodes.iter().all(|(said, _)| *said != Some(Status::Running)));
        }
    }

    #[test]
    fn a_tree_that_goes_on_from_its_written_state_does_what_it_would_have_done(root in trees(KINDS, WORDS), before in 1_usize..12) {
        let (mut first, mut leaves) = (build(&root), Scripted::default());
        for _ in 0..before {
            let _ = shown(&mut first, &mut leaves);
        }
        let mut second = build(&root);
        second.resume(first.state().to_string().parse::<TreeState>().unwrap()).unwrap();
        let mut others = leaves.clone();
        for _ in 0..12 {
            prop_assert_eq!(shown(&mut first, &mut leaves), shown(&mut second, &mut others));
        }
    }

    #[test]
    fn what_is_written_is_read_as_the_same(document in documents()) {
        let text = xml::write(&document);
        prop_assert_eq!(xml::read(&text).map_err(|error| error.to_string()), Ok(document), "{}", text);
    }
}

fn texts() -> impl Strategy<Value = String> {
    prop::collection::vec(
        select(&["a", "Z", " ", "  ", "<", ">", "&", "\"", "'", "\n", "\t", "\r", "]]>", "é", "{x}", "&amp;", "🧳"][..]),
        0..6,
    )
    .prop_map(|pieces| pieces.concat())
}

fn ids() -> impl Strategy<Value = String> {
    "[A-Z][a-z0-9]{0,5}"
}

fn attributes() -> impl Strategy<Value = Vec<Attribute>> {
    prop::collection::btree_map("_[a-z]{1,3}|x[a-z_]{0,3}", texts(), 0..3)
        .prop_map(|all| all.into_iter().map(|(name, value)| Attribute::new(&name, &value)).collect())
}

fn elements() -> impl Strategy<Value = Element> {
    let node = (ids(), select(&Form::ALL[..]), prop::option::of(texts()), attributes());
    let one = node.prop_map(|(id, form, name, attributes)| {
        // An element cannot be named like one of the forms.
        let id = if Form::ALL.iter().any(|form| form.word() == id) { format!("X{id}") } else { id };
        Element { id, form, name, attributes, ..Element::default() }
    });
    let one = one.boxed();
    one.clone().prop_recursive(4, 20, 4, move |inner| {
        (one.clone(), prop::collection::vec(inner, 0..4)).prop_map(|(element, children)| Element { children, ..element })
    })
}

/// Elements without meaning here.
fn kept() -> impl Strategy<Value = Vec<Kept>> {
    let of = |children: Vec<Kept>, (name, attributes, text): (String, Vec<Attribute>, String)| Kept {
        name,
        attributes,
        text: text.trim().to_owned(),
        children,
        place: Default::default(),
    };
    let one = ("k[a-z]{0,3}", attributes(), texts()).boxed();
    let leaf = one.clone().prop_map(move |said| of(Vec::new(), said)).boxed();
    let all = leaf.prop_recursive(3, 8, 3, move |inner| {
        (prop::collection::vec(inner, 0..3), one.clone()).prop_map(move |(children, said)| of(children, said))
    });
    prop::collection::vec(all, 0..3)
}

fn documents() -> impl Strategy<Value = Document> {
    let port = (select(&Direction::ALL[..]), texts(), attributes(), texts()).prop_map(|(direction, name, notes, text)| {
        ModelPort { direction, name, notes, text: text.trim().to_owned(), place: Default::default() }
    });
    let model = (select(&Form::ALL[1..]), attributes(), prop::collection::vec(port, 0..3), kept());
    let models = prop::collection::btree_map(ids(), model, 0..3).prop_map(|models| {
        let model = |(id, (form, notes, ports, kept))| Model { form, id, notes, ports, kept, place: Default::default() };
        models.into_iter().map(model).collect::<Vec<Model>>()
    });
    let trees = prop::collection::vec((ids(), elements()), 1..4);
    let more = (kept(), kept());
    (prop::option::of(texts()), attributes(), trees, models, more).prop_map(|(main, notes, trees, models, (kept, files))| {
        let includes = files.into_iter().map(|file| Kept { name: "include".to_owned(), ..file }).collect();
        let document = Document { main, notes, models, kept, includes, ..Document::default() };
        trees.into_iter().fold(document, |document, (id, root)| document.with_tree(&id, root))
    })
}
