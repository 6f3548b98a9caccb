//! Measures a tick of a behaviour tree per node, beside bonsai-bt in the same run: 100 nodes that are all ticked, in
//! sequences, in reactive ones, with ports that are read and written, and with children that are halted. Nothing here
//! is a test.
#![expect(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark looks at the clock and prints"
)]

#[path = "../../../benches/common/goals.rs"]
#[expect(dead_code, reason = "the rival is always there, and no goal was missed before")]
mod goals;

use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use behaviour_trees::{Blackboard, Catalogue, Document, Element, Leaf, LeafKind, Leaves, Port, Status, Tree, Value, ValueType};
use bonsai_bt::{Action, BT, Behavior, Event, UpdateArgs};

/// Goal in nanoseconds per node, with ports and halts.
const GOAL: f64 = 50.0;

const NODES: usize = 100;

/// Leaves that do almost nothing, so that the tree round them is measured.
struct Cheap {
    is_open: bool,
    halts: u64,
}

const SUCCEED: usize = 0;
const RUN: usize = 1;
const COUNT: usize = 2;
const DOOR: usize = 3;
const RUN_COUNTING: usize = 4;

fn catalogue() -> Catalogue {
    let ports = || vec![Port::input("from", ValueType::Int), Port::output("to", ValueType::Int)];
    Catalogue::new(vec![
        LeafKind::action("Succeed", vec![]),
        LeafKind::action("Run", vec![]),
        LeafKind::action("Count", ports()),
        LeafKind::condition("Door", vec![]),
        LeafKind::action("RunCounting", ports()),
    ])
}

impl Leaves for Cheap {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        match leaf.kind() {
            RUN => Status::Running,
            COUNT | RUN_COUNTING => {
                let from = leaf.int(0).unwrap_or(0);
                leaf.write(1, Value::Int(from + 1));
                if leaf.kind() == COUNT { Status::Success } else { Status::Running }
            }
            DOOR => {
                self.is_open = !self.is_open;
                if self.is_open { Status::Success } else { Status::Failure }
            }
            SUCCEED.. => Status::Success,
        }
    }

    fn halt(&mut self, _: &mut Leaf<'_>) {
        self.halts += 1;
    }
}

fn leaf(kind: &str) -> Element {
    match kind {
        "Count" | "RunCounting" => Element::new(kind, vec![]).with("from", "{a}").with("to", "{a}"),
        _ => Element::new(kind, vec![]),
    }
}

/// One node over nine, each over ten leaves; the very last leaf is `last`.
fn rows(kind: &str, inner: &str, last: &str) -> Element {
    let row = |row: usize| {
        let leaf = |at: usize| leaf(if row == 8 && at == 9 { last } else { inner });
        Element::new(kind, (0..10).map(leaf).collect())
    };
    Element::new(kind, (0..9).map(row).collect())
}

/// A condition that holds in every other tick, and beside it 97 leaves at once, which run in one tick and are halted in
/// the next.
fn door(inner: &str) -> Element {
    let all = Element::new("Parallel", (0..97).map(|_| leaf(inner)).collect());
    Element::new("ReactiveSequence", vec![leaf("Door"), all])
}

/// Nanoseconds per node, the median of several batches.
fn measured(mut tick: impl FnMut()) -> f64 {
    const TICKS: u32 = 2_000;
    let mut batch = || {
        let start = Instant::now();
        (0..TICKS).for_each(|_| tick());
        start.elapsed().as_secs_f64() * 1e9 / f64::from(TICKS) / NODES as f64
    };
    batch();
    let mut times: Vec<f64> = (0..31).map(|_| batch()).collect();
    times.sort_by(f64::total_cmp);
    times[15]
}

fn ours(root: Element) -> f64 {
    let mut blackboard = Blackboard::new();
    let mut tree = Tree::build(&Document::of("T", root), None, &catalogue(), &mut blackboard).unwrap();
    assert_eq!(tree.nodes().count(), NODES);
    blackboard.set("a", Value::Int(0)).unwrap();
    let mut leaves = Cheap { is_open: false, halts: 0 };
    measured(|| {
        black_box(tree.tick(&mut blackboard, &mut leaves, Duration::from_millis(1)).unwrap());
    })
}

/// The same trees in bonsai-bt: leaves without ports, and no halts, since it has neither.
fn theirs(is_reactive: bool) -> f64 {
    let row = |row: usize| {
        let leaves = (0..10).map(|at| Action(is_reactive && row == 8 && at == 9)).collect();
        Behavior::Sequence(leaves).memory(!is_reactive)
    };
    let root = Behavior::Sequence((0..9).map(row).collect()).memory(!is_reactive);
    let mut tree = BT::new(root, ());
    let event = Event::from(UpdateArgs { dt: 0.001 });
    measured(|| {
        let said = tree.tick(&event, &mut |args: bonsai_bt::ActionArgs<Event, bool>, _| {
            if *args.action { (bonsai_bt::Running, 0.0) } else { (bonsai_bt::Success, args.dt) }
        });
        black_box(said);
        if !is_reactive {
            // A tree of bonsai-bt that is done stays done, so the next run needs a reset.
            tree.reset_bt();
        }
    })
}

fn main() -> ExitCode {
    let (sequences, reactive) = (ours(rows("Sequence", "Succeed", "Succeed")), ours(rows("ReactiveSequence", "Succeed", "Run")));
    let (their_sequences, their_reactive) = (theirs(false), theirs(true));
    let ports = ours(rows("Sequence", "Count", "Count"));
    // Of two ticks the first performs all nodes, and the second halts those that run.
    let (halts, both) = (ours(door("Run")), ours(door("RunCounting")));
    println!("ns a node, trees of {NODES} nodes, the median of 31 batches");
    let beside = |what: &str, ours: f64, theirs: f64| {
        println!("  {what:<28} {ours:>6.1}   bonsai-bt {theirs:>6.1}   {:.2} ×", ours / theirs)
    };
    beside("sequences", sequences, their_sequences);
    beside("reactive sequences", reactive, their_reactive);
    println!("  sequences, with ports        {ports:>6.1}   bonsai-bt has none");
    println!("  run, then halted             {halts:>6.1}   bonsai-bt has none");
    println!("  the same, with ports         {both:>6.1}   bonsai-bt has none");
    for (what, figure) in [("sequences with ports", ports), ("with ports and halts", both)] {
        goals::at_most(&format!("{what}, ns a node"), figure, GOAL);
    }
    goals::exit()
}
