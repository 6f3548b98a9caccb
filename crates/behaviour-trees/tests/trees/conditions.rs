//! Scripts in trees: nodes that are scripts, and the conditions round other nodes.

use std::time::Duration;

use behaviour_trees::{Blackboard, Catalogue, Mocks, Status, Tree, Value, xml};

/// Runs a tree whose leaf `Work` returns `work`. Returns the result of each tick (`!` and the reason for a fault) and
/// the blackboard.
fn run(root: &str, work: &str, entries: &[(&str, i64)], ticks: usize) -> (String, Blackboard) {
    let file = format!("<root BTCPP_format=\"4\"><BehaviorTree ID=\"T\">{root}</BehaviorTree></root>");
    let document = xml::read(&file).unwrap();
    let mut mocks = Mocks::default();
    mocks.add(&format!("Work={work}")).unwrap();
    let mut blackboard = Blackboard::new();
    for (name, number) in entries {
        blackboard.set(name, Value::Int(*number)).unwrap();
    }
    let catalogue = mocks.catalogue(&document, Catalogue::default());
    let mut tree = Tree::build(&document, None, &catalogue, &mut blackboard).unwrap();
    let said = (0..ticks).map(|_| match tree.tick(&mut blackboard, &mut mocks, Duration::ZERO) {
        Ok(status) => status.word().to_owned(),
        Err(fault) => format!("!{}", fault.reason),
    });
    (said.collect::<Vec<String>>().join(" "), blackboard)
}

fn check(root: &str, work: &str, entries: &[(&str, i64)], expected: &str) {
    assert_eq!(run(root, work, entries, 1).0, expected, "{root}");
}

#[test]
fn conditions_are_asked_when_a_node_begins() {
    check("<Work _failureIf=\"n == 1\"/>", "SUCCESS", &[("n", 1)], "FAILURE");
    check("<Work _successIf=\"n == 1\"/>", "FAILURE", &[("n", 1)], "SUCCESS");
    check("<Work _skipIf=\"n == 1\"/>", "FAILURE", &[("n", 1)], "SKIPPED");
    check("<Work _while=\"n == 1\"/>", "FAILURE", &[("n", 2)], "SKIPPED");
    check("<Work _while=\"n == 1\"/>", "SUCCESS", &[("n", 1)], "SUCCESS");
    check("<Work _failureIf=\"n\" _successIf=\"n\" _skipIf=\"n\"/>", "RUNNING", &[("n", 1)], "FAILURE");
    check("<Work _successIf=\"n\" _skipIf=\"n\"/>", "RUNNING", &[("n", 1)], "SUCCESS");
}

#[test]
fn what_runs_is_halted_when_its_while_does_not_hold_any_more() {
    let root = "<Parallel failure_count=\"2\"><Work name=\"w\" _while=\"n &lt; 2\" _onHalted=\"h := 1\"/><Script code=\"n = 2\"/></Parallel>";
    let (said, blackboard) = run(root, "RUNNING", &[("n", 1)], 2);
    assert_eq!(said, "RUNNING SUCCESS");
    assert_eq!(blackboard.get("h"), Some(&Value::Int(1)));
}

#[test]
fn scripts_follow_when_a_node_is_done() {
    let root = "<Work _onSuccess=\"a := 1\" _onFailure=\"b := 1\" _onHalted=\"c := 1\" _post=\"d := 1\"/>";
    let held = |work: &str| {
        let (_, blackboard) = run(root, work, &[], 1);
        ["a", "b", "c", "d"].into_iter().filter(|name| blackboard.get(name).is_some()).collect::<String>()
    };
    assert_eq!([held("SUCCESS"), held("FAILURE"), held("RUNNING"), held("SKIPPED")], ["ad", "bd", "", ""]);
}

#[test]
fn a_script_node_does_and_a_script_condition_asks() {
    check("<Script code=\"a := 1\"/>", "SUCCESS", &[], "SUCCESS");
    check("<Sequence><Script code=\"a := 2; a *= 3\"/><ScriptCondition code=\"a == 6\"/></Sequence>", "SUCCESS", &[], "SUCCESS");
    check("<ScriptCondition code=\"n &gt; 3\"/>", "SUCCESS", &[("n", 3)], "FAILURE");
    check("<Script code=\"n / 0\"/>", "SUCCESS", &[("n", 3)], "!its script divides by zero");
    check("<ScriptCondition code=\"m\"/>", "SUCCESS", &[], "!the entry {m} in its script has no value");
    check("<ScriptCondition code=\"'x'\"/>", "SUCCESS", &[], "!the result of its script is 'x', which is neither true nor false");
}

/// Its script is evaluated until it is true, and not again before the child is done.
#[test]
fn a_precondition_lets_its_child_or_says_otherwise() {
    check("<Precondition if=\"n == 1\"><Work/></Precondition>", "SUCCESS", &[("n", 2)], "FAILURE");
    check("<Precondition if=\"n == 1\" else=\"RUNNING\"><Work/></Precondition>", "SUCCESS", &[("n", 2)], "RUNNING");
    let root = "<Sequence><Precondition if=\"n == 1\"><Work _post=\"n = 2\"/></Precondition><AlwaysSuccess/></Sequence>";
    assert_eq!(run(root, "RUNNING,SUCCESS", &[("n", 1)], 3).0, "RUNNING SUCCESS FAILURE");
}

#[test]
fn entries_are_written_copied_and_emptied() {
    let root = "<Sequence><SetBlackboard value=\"7\" output_key=\"a\"/><SetBlackboard value=\"{a}\" output_key=\"{b}\"/><UnsetBlackboard key=\"a\"/></Sequence>";
    let (said, blackboard) = run(root, "SUCCESS", &[], 1);
    assert_eq!((said.as_str(), blackboard.get("a"), blackboard.get("b")), ("SUCCESS", None, Some(&Value::text("7"))));
    check("<SetBlackboard value=\"{none}\" output_key=\"b\"/>", "SUCCESS", &[], "FAILURE");
    let root = "<Sequence><Repeat num_cycles=\"{b}\"><Work/></Repeat><SetBlackboard value=\"many\" output_key=\"b\"/></Sequence>";
    check(root, "SUCCESS", &[("b", 1)], "!the entry {b} is of type int and cannot hold \"many\"");
}

#[test]
fn a_port_without_a_value_is_said() {
    let said = "!the value of its port num_cycles is not a whole number";
    check("<Repeat num_cycles=\"{n}\"><Work/></Repeat>", "SUCCESS", &[], said);
    check("<Repeat num_cycles=\"{n}\"><Work/></Repeat>", "FAILURE", &[("n", 2)], "FAILURE");
}

#[test]
fn whoever_says_that_a_fault_happened_leaves_nothing_running() {
    let root = "<Parallel><Work/><Script code=\"1 / 0\"/></Parallel>";
    let (said, _) = run(root, Status::Running.word(), &[], 2);
    assert_eq!(said, "!its script divides by zero !its script divides by zero");
}

#[test]
fn a_node_that_wants_an_entry_to_be_written_sees_each_write_once() {
    let after = |node: &str| format!("<Sequence><Script code=\"n += 1\" _skipIf=\"n &gt; 1\"/><Work/>{node}</Sequence>");
    let ticks = |node: &str| run(&after(node), "SUCCESS", &[("n", 0)], 3).0;
    assert_eq!(ticks("<WasEntryUpdated entry=\"{n}\"/>"), "SUCCESS SUCCESS FAILURE");
    assert_eq!(ticks("<SkipUnlessUpdated entry=\"n\"><AlwaysFailure/></SkipUnlessUpdated>"), "FAILURE FAILURE SUCCESS");
    assert_eq!(ticks("<WaitValueUpdate entry=\"{n}\"><AlwaysFailure/></WaitValueUpdate>"), "FAILURE FAILURE RUNNING");
    let nothing = "<WasEntryUpdated entry=\"{other}\"/>";
    assert_eq!(run(nothing, "SUCCESS", &[], 1).0, "FAILURE");
}

#[test]
fn a_loop_writes_its_elements_one_after_the_other() {
    let root = "<LoopInt queue=\"3;4\" value=\"{v}\"><Script code=\"sum += v\"/></LoopInt>";
    let (said, blackboard) = run(root, "SUCCESS", &[("sum", 0)], 4);
    assert_eq!(said, "RUNNING RUNNING SUCCESS RUNNING");
    assert_eq!(blackboard.get("sum"), Some(&Value::Int(10)), "a queue in the file begins anew");
    let root = "<LoopInt queue=\"{q}\" value=\"{v}\"><Script code=\"sum += v\"/></LoopInt>";
    let root = format!("<Sequence><Script code=\"q := '3;4'\" _skipIf=\"sum &gt; 0\"/>{root}</Sequence>");
    let (said, blackboard) = run(&root, "SUCCESS", &[("sum", 0)], 5);
    assert_eq!(said, "RUNNING RUNNING SUCCESS SUCCESS SUCCESS");
    assert_eq!(blackboard.get("sum"), Some(&Value::Int(7)), "that of an entry is used up");
}

/// With `catch_on_halt`, a node that is halted in its try-children has one tick to clean up.
#[test]
fn a_try_catch_that_is_halted_cleans_up_if_it_is_told_to() {
    let root =
        |flag: &str| format!("<Parallel><TryCatch{flag}><Work/><Script code=\"n += 1\"/></TryCatch><AlwaysFailure/></Parallel>");
    let after = |flag: &str| run(&root(flag), "RUNNING", &[("n", 0)], 1).1.get("n").cloned();
    assert_eq!(after(""), Some(Value::Int(0)));
    assert_eq!(after(" catch_on_halt=\"true\""), Some(Value::Int(1)));
}

/// Every action of BehaviorTree.CPP that takes time does the same: it repeats its result until it is reset.
#[test]
fn a_sleep_that_is_over_does_not_begin_again_before_it_is_reset() {
    let file =
        "<root BTCPP_format=\"4\"><BehaviorTree><WhileDoElse><Sleep msec=\"50\"/><Work/></WhileDoElse></BehaviorTree></root>";
    let document = xml::read(file).unwrap();
    let mut mocks = Mocks::default();
    mocks.add("Work=RUNNING").unwrap();
    let mut blackboard = Blackboard::new();
    let mut tree = Tree::build(&document, None, &mocks.catalogue(&document, Catalogue::default()), &mut blackboard).unwrap();
    let said = [0; 4].map(|_| {
        tree.tick(&mut blackboard, &mut mocks, Duration::from_millis(50)).unwrap();
        tree.nodes().nth(1).and_then(|sleep| sleep.returned)
    });
    assert_eq!(said, [Some(Status::Running), Some(Status::Success), Some(Status::Success), Some(Status::Success)]);
}

#[test]
fn an_entry_that_was_unset_must_be_made_again() {
    let root = "<Sequence><UnsetBlackboard key=\"n\"/><Script code=\"n = 1\"/></Sequence>";
    check(root, "SUCCESS", &[("n", 0)], "!the entry {n} in its script does not exist yet: := creates the entry");
    check(&root.replace("n = 1", "n := 1"), "SUCCESS", &[("n", 0)], "SUCCESS");
}
