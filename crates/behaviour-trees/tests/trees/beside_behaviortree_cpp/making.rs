//! Random trees of every kind that BehaviorTree.CPP 4.8.2 has, with conditions, scripts and ports, over leaves with
//! random results.
//!
//! Known differences (docs/trees.md) are left out: `TryCatch` and `Sync`, which it does not have; scripts that subtract
//! and then add, or whose result is no number; time that passes (a `Timeout` or `Delay` lasts for ever); and what
//! comments below name. `Sleep` is left out too: in BehaviorTree.CPP, one that starts just after it was halted may end
//! at once, since its old timer ends it from another thread.

use std::collections::BTreeMap;
use std::fmt::Write;

use behaviour_trees::document::Attribute;
use behaviour_trees::{Document, Element, xml};
use proptest::prelude::*;
use proptest::sample::select;

/// A file of trees, the results of its leaves, and the entries that are 0 at first.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) file: String,
    pub(super) mocks: BTreeMap<String, String>,
    pub(super) entries: &'static [&'static str],
}

impl Case {
    /// As `tests/clients/behaviortree.py` reads it.
    pub(super) fn told(&self, ticks: usize) -> String {
        let mut told = String::new();
        self.file.lines().for_each(|line| writeln!(told, "file {line}").unwrap());
        self.mocks.iter().for_each(|(name, says)| writeln!(told, "mock {name} {says}").unwrap());
        self.entries.iter().for_each(|name| writeln!(told, "entry {name} 0").unwrap());
        writeln!(told, "go {ticks}").unwrap();
        told
    }
}

const KINDS: &[&str] = &[
    "Sequence",
    "Fallback",
    "AsyncSequence",
    "AsyncFallback",
    "SequenceWithMemory",
    "ReactiveSequence",
    "ReactiveFallback",
    "Parallel",
    "ParallelAll",
    "IfThenElse",
    "WhileDoElse",
    "Switch2",
    "Switch3",
    "Switch4",
    "Switch5",
    "Switch6",
    "Inverter",
    "ForceSuccess",
    "ForceFailure",
    "RetryUntilSuccessful",
    "Repeat",
    "KeepRunningUntilFailure",
    "Timeout",
    "Delay",
    "RunOnce",
    "Precondition",
    "LoopInt",
    "LoopBool",
    "LoopDouble",
    "LoopString",
    "SkipUnlessUpdated",
    "WaitValueUpdate",
    "SubTree",
];

/// Conditions on the entries `a` and `b`; those in `HOLDS` stay true for long, and `DONE` changes the entries.
const ASKED: &[&str] =
    &["a==1", "a>1", "b==0", "a<2", "b>a", "a!=b", "true", "false", "a==1&&b<2||a>2", "a<1", "a>=2", "(a+b)*2>6", "!(a==b)"];
const HOLDS: &[&str] = &["a<2", "b<3", "a!=3", "true", "a<=b+1"];
const DONE: &[&str] = &["a+=1", "b+=1", "a=0", "b=0", "b=a", "a=b; b+=1", "b=a>1?0:a+1"];

/// What leaves return; the last word is repeated.
const ACTS: &[&str] = &["RUNNING", "RUNNING", "RUNNING", "SUCCESS", "SUCCESS", "SUCCESS", "FAILURE", "FAILURE", "SKIPPED"];
const ANSWERS: &[&str] = &["SUCCESS", "FAILURE"];

/// A time that never passes within a test.
const FOR_EVER_MS: &str = "1000000";

pub(super) fn cases() -> impl Strategy<Value = Case> {
    let leaf = (leaf(), conditions()).prop_map(|(leaf, conditions)| conditioned(leaf, conditions));
    let tree = leaf.prop_recursive(4, 24, 3, |inner| {
        let children = prop::collection::vec(inner, 1..5);
        (select(KINDS), children, any::<[u8; 8]>(), conditions()).prop_map(|(kind, children, picks, conditions)| {
            conditioned(node(kind, children, &mut Picks(picks.into_iter())), conditions)
        })
    });
    tree.prop_map(finished)
}

fn leaf() -> impl Strategy<Value = Element> {
    let of = |kind: &'static str, port: &'static str, words: &'static [&'static str]| {
        select(words).prop_map(move |word| Element::new(kind, Vec::new()).with(port, word))
    };
    let says = |kind: &'static str, words: &'static [&'static str]| {
        prop::collection::vec(select(words), 1..6)
            .prop_map(move |says| Element::new(kind, Vec::new()).with("says", &says.join(",")))
    };
    // Only a whole number is copied: 4.8 empties the entry of an untyped text.
    let set = select(&[("7", "k"), ("x", "k"), ("{i}", "c")][..])
        .prop_map(|(value, key)| Element::new("SetBlackboard", Vec::new()).with("value", value).with("output_key", key));
    prop_oneof![
        12 => says("Act", ACTS),
        4 => says("Ask", ANSWERS),
        1 => Just(Element::new("AlwaysSuccess", Vec::new())),
        1 => Just(Element::new("AlwaysFailure", Vec::new())),
        3 => of("Script", "code", DONE),
        2 => of("ScriptCondition", "code", ASKED),
        2 => of("WasEntryUpdated", "entry", &["{a}", "{b}"]),
        1 => set,
        1 => of("UnsetBlackboard", "key", &["k", "c"]),
    ]
}

/// Conditions for every third node.
fn conditions() -> impl Strategy<Value = Vec<Attribute>> {
    let one = prop_oneof![
        3 => (select(&["_failureIf", "_successIf", "_skipIf"][..]), select(ASKED)),
        1 => (Just("_while"), select(HOLDS)),
        2 => (select(&["_onSuccess", "_onFailure", "_onHalted", "_post"][..]), select(DONE)),
    ];
    let some = prop::collection::vec(one, 1..4).prop_map(|some| {
        // At most one of each name.
        let some: BTreeMap<&str, &str> = some.into_iter().collect();
        some.into_iter().map(|(name, code)| Attribute::new(name, code)).collect()
    });
    prop_oneof![2 => Just(Vec::new()), 1 => some]
}

fn conditioned(mut element: Element, mut conditions: Vec<Attribute>) -> Element {
    // A loop of 4.8 that has SUCCESS or FAILURE by a condition, and was not reset, has no queue when it begins.
    if element.id.starts_with("Loop") {
        conditions.retain(|condition| condition.name != "_successIf" && condition.name != "_failureIf");
    }
    element.attributes.extend(conditions);
    element
}

struct Picks(std::array::IntoIter<u8, 8>);

impl Picks {
    fn of<'w>(&mut self, words: &[&'w str]) -> &'w str {
        words[usize::from(self.0.next().unwrap_or_default()) % words.len()]
    }

    fn port(&mut self, element: Element, name: &str, words: &[&str]) -> Element {
        match self.of(&["", "set", "set"]) {
            "" => element,
            _ => element.with(name, self.of(words)),
        }
    }
}

/// A node of this kind with as many of the children as it may have, some of them twice if there are too few.
fn node(kind: &str, children: Vec<Element>, picks: &mut Picks) -> Element {
    let some = |count: usize| Element::new(kind, children.iter().cycle().take(count).cloned().collect());
    let one = some(1);
    match kind {
        "IfThenElse" | "WhileDoElse" => {
            let mut element = some(if picks.of(&["2", "3"]) == "2" { 2 } else { 3 });
            // A stateful leaf that ended and was not reset is performed again here; in BehaviorTree.CPP it repeats its
            // result.
            let first = element.children.remove(0);
            let is_stateful = first.id == "Act";
            element.children.insert(0, if is_stateful { Element::new("Inverter", vec![first]) } else { first });
            element
        }
        "Parallel" => {
            let all = picks.port(some(children.len()), "success_count", &["1", "2", "-1", "-2", "0", "3"]);
            picks.port(all, "failure_count", &["1", "2", "-1", "-2", "0"])
        }
        "ParallelAll" => picks.port(some(children.len()), "max_failures", &["0", "1", "2", "-1", "-2"]),
        "Switch2" | "Switch3" | "Switch4" | "Switch5" | "Switch6" => {
            let cases: usize = kind["Switch".len()..].parse().unwrap();
            let element = some(cases + 1).with("variable", picks.of(&["{a}", "{b}", "1", "{zzz}"]));
            let case = |element: Element, case: usize| {
                element.with(&format!("case_{case}"), picks.of(&["0", "1", "2", "x", "1.0", "{b}"]))
            };
            (1..=cases).fold(element, case)
        }
        "RetryUntilSuccessful" => one.with("num_attempts", picks.of(&["-1", "1", "2", "3", "3", "0"])),
        "Repeat" => one.with("num_cycles", picks.of(&["-1", "1", "2", "3", "3", "0"])),
        "Timeout" => one.with("msec", picks.of(&["0", FOR_EVER_MS])),
        "Delay" => one.with("delay_msec", FOR_EVER_MS),
        "RunOnce" => picks.port(one, "then_skip", &["true", "false"]),
        "Precondition" => {
            let element = one.with("if", picks.of(ASKED));
            picks.port(element, "else", &["SUCCESS", "FAILURE", "RUNNING", "SKIPPED"])
        }
        "LoopInt" | "LoopBool" | "LoopDouble" | "LoopString" => {
            let (queues, value) = match kind {
                "LoopInt" => (["1;2;3", "1;", ""], "{int}"),
                "LoopBool" => (["1;0", "1;0;", ""], "{bool}"),
                "LoopDouble" => (["1.5", "1.5;2;", ""], "{double}"),
                _ => (["x;y", "x;;", ""], "{text}"),
            };
            let element = one.with("queue", picks.of(&queues)).with("value", value);
            picks.port(element, "if_empty", &["SUCCESS", "FAILURE", "SKIPPED"])
        }
        "SkipUnlessUpdated" | "WaitValueUpdate" => {
            // Only over leaves that never run: before 4.9 these nodes do not halt their child.
            let says = picks.of(&["SUCCESS", "FAILURE", "SUCCESS,FAILURE", "FAILURE,SUCCESS"]);
            let child = Element::new("Ask", Vec::new()).with("says", says);
            Element::new(kind, vec![child]).with("entry", picks.of(&["{a}", "{b}"]))
        }
        "Inverter" | "ForceSuccess" | "ForceFailure" | "KeepRunningUntilFailure" | "SubTree" => one,
        _ => some(children.len()),
    }
}

/// Completes a case: names for all nodes, results of leaves outside the file, and each subtree as a tree of its own.
fn finished(root: Element) -> Case {
    let switches = has_switch(&root);
    let mut parts = Parts::default();
    let mut main = parts.named(root);
    // A switch turns its variable into a text, so its first value comes from a script.
    if switches {
        let script = Element::new("Script", Vec::new()).named("made").with("code", "a:=0; b:=0");
        let once = Element::new("RunOnce", vec![script]).named("once");
        main = Element::new("Sequence", vec![once, main]).named("first");
    }
    let document = parts.trees.into_iter().fold(Document::of("Main", main), |all, (id, tree)| all.with_tree(&id, tree));
    Case { file: xml::write(&document), mocks: parts.mocks, entries: if switches { &["i"] } else { &["a", "b", "i"] } }
}

fn has_switch(element: &Element) -> bool {
    element.id.starts_with("Switch") || element.children.iter().any(has_switch)
}

#[derive(Default)]
struct Parts {
    names: usize,
    mocks: BTreeMap<String, String>,
    trees: Vec<(String, Element)>,
}

impl Parts {
    fn named(&mut self, element: Element) -> Element {
        let number = self.names;
        self.names += 1;
        let name = format!("n{number}");
        let mut children: Vec<Element> = element.children.into_iter().map(|child| self.named(child)).collect();
        let all = element.attributes.into_iter();
        let (says, attributes): (Vec<Attribute>, Vec<Attribute>) = all.partition(|attribute| attribute.name == "says");
        self.mocks.extend(says.into_iter().map(|says| (name.clone(), says.value)));
        if element.id != "SubTree" {
            return Element { name: Some(name), attributes, children, ..Element::new(&element.id, Vec::new()) };
        }
        let id = format!("T{number}");
        self.trees.push((id.clone(), children.remove(0)));
        let subtree = Element { name: Some(name), attributes, ..Element::subtree(&id) };
        subtree.with("a", "{a}").with("b", "{b}").with("i", "{i}")
    }
}
