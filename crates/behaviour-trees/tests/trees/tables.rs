//! The rules of each node as tables: what its children return, tick by tick, and what follows. `R`, `S`, `F`, `K` are
//! RUNNING, SUCCESS, FAILURE and SKIPPED; a child that was halted in a tick has `h` behind it, and `.` is one that was
//! not ticked.

use std::time::Duration;

use behaviour_trees::{Blackboard, Catalogue, Document, Element, Mocks, Status, Tree};

const PERIOD: Duration = Duration::from_millis(100);

const fn letter(status: Status) -> char {
    match status {
        Status::Idle => 'I',
        Status::Running => 'R',
        Status::Success => 'S',
        Status::Failure => 'F',
        Status::Skipped => 'K',
    }
}

fn words(letters: &str) -> String {
    let word = |letter: char| match letter {
        'R' => "RUNNING",
        'S' => "SUCCESS",
        'F' => "FAILURE",
        'K' => "SKIPPED",
        other => panic!("{other} is no status"),
    };
    letters.chars().map(word).collect::<Vec<&str>>().join(",")
}

/// `node` is the kind with its attributes (`Repeat num_cycles=3`), `children` what each child returns in its successive
/// ticks, and `expected` one word per tick: what the node returns, and behind `:` its children.
fn check(node: &str, children: &[&str], expected: &str) {
    let mut pieces = node.split(' ');
    let mut element = Element::new(pieces.next().unwrap(), Vec::new());
    for attribute in pieces {
        let (name, value) = attribute.split_once('=').unwrap();
        element = element.with(name, value);
    }
    let mut mocks = Mocks::default();
    for (number, says) in children.iter().enumerate() {
        mocks.add(&format!("c{number}={}", words(says))).unwrap();
        element.children.push(Element::new("Leaf", Vec::new()).named(&format!("c{number}")));
    }
    let document = Document::of("T", element);
    let mut blackboard = Blackboard::new();
    let catalogue = mocks.catalogue(&document, Catalogue::default());
    let mut tree = Tree::build(&document, None, &catalogue, &mut blackboard).unwrap();
    let mut seen = Vec::new();
    for _ in expected.split_whitespace() {
        let said = match tree.tick(&mut blackboard, &mut mocks, PERIOD) {
            Ok(status) => letter(status),
            Err(_) => '!',
        };
        let halted = mocks.take_halted();
        let child = |node: behaviour_trees::NodeView<'_>| {
            let said = node.returned.map_or('.', letter);
            if halted.contains(&node.node) { format!("{said}h") } else { said.to_string() }
        };
        let children: String = tree.nodes().skip(1).map(child).collect();
        seen.push(if children.is_empty() { said.to_string() } else { format!("{said}:{children}") });
    }
    assert_eq!(seen.join(" "), expected.split_whitespace().collect::<Vec<&str>>().join(" "), "{node} over {children:?}");
}

#[test]
fn a_sequence_goes_on_at_the_child_that_runs() {
    check("Sequence", &["S", "RRS", "S"], "R:SR. R:.R. S:.SS S:SSS");
    check("Sequence", &["SF", "F"], "F:SF F:F.");
    check("Sequence", &["K", "S"], "S:KS");
    check("Sequence", &["K", "K"], "K:KK");
    check("AsyncSequence", &["S", "S", "RS"], "R:S.. R:.S. R:..R S:..S");
    check("SequenceWithMemory", &["S", "FS", "S"], "R:S.. F:.F. R:.S. S:..S");
}

#[test]
fn a_fallback_goes_on_at_the_child_that_runs() {
    check("Fallback", &["F", "RRF", "S"], "R:FR. R:.R. S:.FS");
    check("Fallback", &["F", "F"], "F:FF");
    check("Fallback", &["K", "F"], "F:KF");
    check("Fallback", &["K", "K"], "K:KK");
    check("AsyncFallback", &["F", "F", "S"], "R:F.. R:.F. S:..S");
}

#[test]
fn a_reactive_node_begins_at_its_first_child_and_halts_the_others() {
    check("ReactiveSequence", &["SSF", "R"], "R:SR R:SR F:F.h");
    check("ReactiveSequence", &["SRS", "R"], "R:SR R:R.h R:SR");
    check("ReactiveSequence", &["K", "K"], "K:KK");
    check("ReactiveFallback", &["FFS", "R"], "R:FR R:FR S:S.h");
    check("ReactiveFallback", &["F", "K", "F"], "F:FKF");
}

#[test]
fn a_parallel_counts_and_halts_whoever_still_runs() {
    check("Parallel", &["S", "RS", "RRS"], "R:SRR R:.SR S:..S");
    check("Parallel", &["S", "RF", "R"], "R:SRR F:.F.h");
    check("Parallel success_count=1", &["R", "RS", "R"], "R:RRR S:RhS.h");
    check("Parallel success_count=2 failure_count=2", &["F", "S", "RS"], "R:FSR S:..S");
    check("Parallel failure_count=-1", &["F", "R"], "F:F.");
    check("Parallel success_count=1 failure_count=-1", &["F", "RF"], "R:FR F:.F");
    check("Parallel", &["K", "S"], "S:KS");
    check("Parallel success_count=2", &["K", "S"], "R:KS R:K.");
    check("Parallel", &["K", "K"], "S:KK");
    check("Parallel success_count=3", &["S", "S"], "!:..");
    check("Parallel failure_count=3", &["S", "S"], "!:..");
}

#[test]
fn a_parallel_all_waits_for_every_child() {
    check("ParallelAll", &["F", "RS", "RRS"], "R:FRR R:.SR F:..S");
    check("ParallelAll max_failures=2", &["F", "RS", "S"], "R:FRS S:.S.");
    check("ParallelAll max_failures=-1", &["F", "F"], "F:FF");
    check("ParallelAll", &["K", "S"], "S:KS");
    check("ParallelAll", &["K", "K"], "K:KK");
    check("ParallelAll max_failures=3", &["S", "S"], "!:..");
}

#[test]
fn if_then_else_asks_once_and_while_do_else_in_every_tick() {
    check("IfThenElse", &["S", "RS", "S"], "R:SR. S:.S.");
    check("IfThenElse", &["F", "S", "RF"], "R:F.R F:..F");
    check("IfThenElse", &["RF", "S"], "R:R. F:F.");
    check("IfThenElse", &["K", "S"], "!:K.");
    check("WhileDoElse", &["SSF", "R", "R"], "R:SR. R:SR. R:F.hR");
    check("WhileDoElse", &["SF", "R"], "R:SR F:F.h");
    check("WhileDoElse", &["FS", "S", "R"], "R:F.R S:SS.h");
}

#[test]
fn a_switch_follows_its_variable() {
    let cases = "Switch2 variable=b case_1=a case_2=b";
    check(cases, &["S", "F", "R"], "F:.F.");
    check("Switch2 variable=3.0 case_1=1 case_2=3", &["S", "F", "R"], "F:.F.");
    check("Switch2 variable=x case_1=a case_2=b", &["S", "F", "R"], "R:..R");
    check("Switch2 case_1=a case_2=b", &["S", "S", "K"], "K:..K");
    check("Switch3 variable=2 case_1=1 case_2=2 case_3=2", &["S", "R", "F", "F"], "R:.R..");
}

#[test]
fn what_has_one_child_turns_what_it_says() {
    check("Inverter", &["RSFK"], "R:R F:S S:F K:K");
    check("ForceSuccess", &["RFSK"], "R:R S:F S:S K:K");
    check("ForceFailure", &["RFSK"], "R:R F:F F:S K:K");
    check("KeepRunningUntilFailure", &["SRKF"], "R:S R:R R:K F:F");
    check("RunOnce", &["RS"], "R:R S:S K:.");
    check("RunOnce then_skip=false", &["RF"], "R:R F:F F:.");
}

/// A child that was not running before is not ticked twice in one tick; one that was may be.
#[test]
fn retry_and_repeat_give_the_tick_back_between_attempts() {
    check("RetryUntilSuccessful num_attempts=3", &["FFF"], "R:F R:F F:F");
    check("RetryUntilSuccessful num_attempts=3", &["FS"], "R:F S:S");
    check("RetryUntilSuccessful num_attempts=-1", &["FFFFFFFS"], "R:F R:F R:F R:F R:F R:F R:F S:S");
    check("RetryUntilSuccessful num_attempts=2", &["RFS"], "R:R S:S");
    check("RetryUntilSuccessful num_attempts=0", &["S"], "F:.");
    check("RetryUntilSuccessful num_attempts=2", &["FKF"], "R:F K:K F:F");
    check("Repeat num_cycles=3", &["SSS"], "R:S R:S S:S");
    check("Repeat num_cycles=3", &["SF"], "R:S F:F");
    check("Repeat num_cycles=2", &["RSR"], "R:R R:R");
    check("Repeat num_cycles=0", &["F"], "S:.");
}

#[test]
fn time_is_that_of_the_ticks() {
    check("Timeout msec=200", &["R"], "R:R R:R F:.h R:R");
    check("Timeout msec=200", &["RRS"], "R:R R:R F:.h S:S");
    check("Timeout msec=300", &["RRS"], "R:R R:R S:S");
    check("Timeout msec=0", &["RRRRS"], "R:R R:R R:R R:R S:S");
    check("Delay delay_msec=200", &["RS"], "R:. R:. R:R S:S R:.");
    check("Delay delay_msec=0", &["S"], "S:S");
    check("Sleep msec=200", &[], "R R S R");
    check("Sleep msec=0", &[], "S");
}

#[test]
fn what_always_says_the_same_says_it() {
    check("AlwaysSuccess", &[], "S S");
    check("AlwaysFailure", &[], "F F");
}

#[test]
fn a_try_catch_ends_with_its_last_child_when_another_fails() {
    check("TryCatch", &["S", "RS", "S"], "R:SR. S:.S.");
    check("TryCatch", &["S", "F", "RS"], "R:SFR F:..S F:SFS");
    check("TryCatch", &["F", "S", "F"], "F:F.F");
    check("TryCatch", &["K", "K", "S"], "K:KK.");
    check("TryCatch", &["F", "S", "K"], "F:F.K");
}

#[test]
fn a_loop_ticks_its_child_for_each_element() {
    check("LoopInt queue=1;2", &["S"], "R:S R:S S:. R:S");
    check("LoopInt queue=1;2", &["RF"], "R:R F:F");
    check("LoopString queue=a if_empty=FAILURE", &["K"], "R:K F:.");
    for empty in ["LoopInt", "LoopBool", "LoopDouble", "LoopString"] {
        check(&format!("{empty} queue= if_empty=FAILURE"), &["S"], "F:. F:.");
        check(&format!("{empty} queue="), &["S"], "S:.");
    }
    check("LoopInt queue=1;2; if_empty=FAILURE", &["S"], "R:S R:S F:.");
    check("LoopString queue=; if_empty=FAILURE", &["S"], "R:S F:.");
    check("LoopString queue=a;; if_empty=FAILURE", &["S"], "R:S R:S F:.");
}
