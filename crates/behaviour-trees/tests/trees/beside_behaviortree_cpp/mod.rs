//! Compares random trees with BehaviorTree.CPP itself, as its Python package behaviortreepy has it (4.8.2): after every
//! tick the same root status, the same state of every node, the same ticks and halts of leaves in the same order, and
//! the same blackboard. Without the package the test is left out with a message; with `HALLSWEEP_REQUIRE_CLIENTS=1` it
//! fails.
//!
//! A failure prints the smallest tree that was found, as `tests/clients/behaviortree.py` reads it, and the seed:
//! `HALLSWEEP_SEED` replays it or sets another, and `HALLSWEEP_TREES` sets the number of trees.

mod making;
mod original;

use std::cell::{Cell, RefCell};
use std::time::Duration;

use behaviour_trees::{Blackboard, Catalogue, Findings, Leaf, Leaves, Mocks, Status, Tree, Value, xml};
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};

use making::Case;
use original::Original;

/// Takes some seconds.
const TREES: u32 = 1_500;

const TICKS: usize = 10;

/// Mocks that record the order in which they were ticked and halted.
struct Noted {
    mocks: Mocks,
    events: Vec<String>,
}

impl Leaves for Noted {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let status = self.mocks.tick(leaf);
        self.events.push(format!("{}:{}", leaf.name(), status.word()));
        status
    }

    fn halt(&mut self, leaf: &mut Leaf<'_>) {
        self.events.push(format!("{}:halt", leaf.name()));
    }
}

/// What our engine does with a file, in the words of `tests/clients/behaviortree.py`.
fn ours(case: &Case) -> Vec<String> {
    let refused = |why: String| vec![format!("refused {why}")];
    let document = match xml::read(&case.file) {
        Ok(document) => document,
        Err(error) => return refused(error.to_string()),
    };
    let mut leaves = Noted { mocks: Mocks::default(), events: Vec::new() };
    for (name, says) in &case.mocks {
        leaves.mocks.add(&format!("{name}={says}")).unwrap();
    }
    let mut blackboard = Blackboard::new();
    let catalogue = leaves.mocks.catalogue(&document, Catalogue::default());
    let mut tree = match Tree::build(&document, None, &catalogue, &mut blackboard) {
        Ok(tree) => tree,
        Err(error) => return refused(error.to_string()),
    };
    for name in case.entries {
        blackboard.set(name, Value::Int(0)).unwrap();
    }
    let mut said = Vec::new();
    for _ in 0..TICKS {
        match tree.tick(&mut blackboard, &mut leaves, Duration::ZERO) {
            Ok(root) => said.push(shown(root, &tree, &std::mem::take(&mut leaves.events), &blackboard)),
            Err(fault) => {
                said.push(format!("fault {fault}"));
                break;
            }
        }
    }
    said
}

fn shown(root: Status, tree: &Tree, events: &[String], blackboard: &Blackboard) -> String {
    let not_idle = tree.nodes().filter(|node| node.after != Status::Idle);
    let mut stand: Vec<String> = not_idle.map(|node| format!("{}={}", node.name, node.after.word())).collect();
    stand.sort();
    // Entries of a subtree stand in a blackboard of their own in BehaviorTree.CPP.
    let entries = blackboard.entries().filter(|entry| !entry.name().contains('/'));
    let mut held: Vec<String> = entries.filter_map(|entry| Some(format!("{}={}", entry.name(), told(entry.value()?)))).collect();
    held.sort();
    [root.word(), &stand.join(" "), &events.join(" "), &held.join(" ")].join(" | ")
}

/// A value as a number where it can be one: the package does not tell the type of an entry.
fn told(value: &Value) -> String {
    let text = if let Value::Bool(truth) = value { u8::from(*truth).to_string() } else { value.to_string() };
    text.parse::<f64>().map_or(text, |number| format!("{number:?}"))
}

/// The number of ticks that were compared, or the first difference.
fn compared(ours: &[String], theirs: &[String]) -> Result<usize, String> {
    // The wording of reasons differs.
    let word = |line: &String| line.split(' ').next().unwrap_or_default().to_owned();
    let is_end = |line: &String| matches!(word(line).as_str(), "refused" | "fault");
    let none = "nothing".to_owned();
    for tick in 0..ours.len().max(theirs.len()) {
        let (our, their) = (ours.get(tick).unwrap_or(&none), theirs.get(tick).unwrap_or(&none));
        if our != their && !(is_end(our) && word(our) == word(their)) {
            return Err(format!("tick {}\nhere:               {our}\nBehaviorTree.CPP:   {their}", tick + 1));
        }
    }
    Ok(ours.iter().filter(|line| !is_end(line)).count())
}

fn number(variable: &str) -> Option<u32> {
    std::env::var(variable).ok().and_then(|number| number.parse().ok())
}

#[test]
fn every_node_stands_as_in_behaviortree_cpp() {
    if !Original::is_here() {
        return;
    }
    let (seed, cases) = (number("HALLSWEEP_SEED").unwrap_or(1), number("HALLSWEEP_TREES").unwrap_or(TREES));
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let bytes: Vec<u8> = seed.to_be_bytes().repeat(8);
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &bytes));
    let original = RefCell::new(Original::default());
    let ticks = Cell::new(0_usize);
    let ran = runner.run(&making::cases(), |case| {
        let told = case.told(TICKS);
        let theirs = original.borrow_mut().ask(&told);
        let same = theirs.and_then(|theirs| compared(&ours(&case), &theirs));
        ticks.set(ticks.get() + same.map_err(|how| TestCaseError::fail(format!("{how}\n{told}")))?);
        Ok(())
    });
    match ran {
        Ok(()) => {}
        Err(TestError::Fail(how, _)) => panic!("HALLSWEEP_SEED={seed} HALLSWEEP_TREES={cases}: {how}"),
        Err(TestError::Abort(why)) => panic!("{why}"),
    }
    // Few trees are refused, and few end early with a fault.
    assert!(ticks.get() > cases as usize * TICKS * 9 / 10, "only {} ticks of {cases} trees were compared", ticks.get());
}

/// A file with the models of all its nodes, and a tree once for each of its uses.
#[test]
fn what_behaviortree_cpp_itself_writes_is_well_formed_and_written_again() {
    if !Original::is_here() {
        return;
    }
    let told = r#"file <root BTCPP_format="4" main_tree_to_execute="T"><BehaviorTree ID="T"><Sequence>
file <SubTree ID="S" x="2" y="{z}" _autoremap="true"/><SubTree ID="S" name="two"/>
file <Ask _skipIf="1 &lt; 0" _note="kept"/><Delay delay_msec="1"><AlwaysSuccess/></Delay></Sequence></BehaviorTree>
file <BehaviorTree ID="S"><Script code="x := 2"/></BehaviorTree></root>
written
"#;
    let written = Original::default().ask(told).unwrap().join("\n");
    assert!(written.contains("_fullpath=\"S::2\"") && written.contains("<TreeNodesModel>"), "{written}");
    let mut findings = Findings::default();
    let document = xml::read_with(&written, &mut findings).unwrap();
    let mut catalogue = Catalogue::default();
    catalogue.add_models(&document);
    document.check(&catalogue, &mut findings);
    assert_eq!((findings.faults(), findings.notes()), (vec![], &[][..]), "{written}");
    assert_eq!(xml::read(&xml::write(&document)).unwrap(), document);
    let mut mocks = Mocks::default();
    mocks.add("*=SUCCESS").unwrap();
    let mut blackboard = Blackboard::new();
    let mut tree = Tree::build(&document, Some("T"), &catalogue, &mut blackboard).unwrap();
    let mut tick = || tree.tick(&mut blackboard, &mut mocks, Duration::from_millis(1)).unwrap();
    assert_eq!((tick(), tick()), (Status::Running, Status::Success));
}
