//! Subtrees and what they see of the blackboard, trees that share one, and barriers between them.

use std::time::Duration;

use behaviour_trees::{Blackboard, Catalogue, Document, Mocks, Status, Tree, Value, xml};

fn document(main: &str, inner: &str) -> Document {
    let file = format!(
        "<root BTCPP_format=\"4\" main_tree_to_execute=\"M\"><BehaviorTree ID=\"M\">{main}</BehaviorTree>\
         <BehaviorTree ID=\"I\">{inner}</BehaviorTree></root>"
    );
    xml::read(&file).unwrap()
}

/// The blackboard after a tree has been ticked once on it, by name.
fn held(main: &str, inner: &str) -> Vec<String> {
    after_a_tick(&document(main, inner))
}

fn after_a_tick(document: &Document) -> Vec<String> {
    let mut blackboard = Blackboard::new();
    let mut tree = Tree::build(document, None, &Catalogue::default(), &mut blackboard).unwrap();
    let said = tree.tick(&mut blackboard, &mut Mocks::default(), Duration::ZERO).unwrap();
    assert_eq!(said, Status::Success);
    blackboard.entries().filter_map(|entry| Some(format!("{}={}", entry.name(), entry.value()?))).collect()
}

#[test]
fn a_subtree_has_names_of_its_own() {
    assert_eq!(held("<SubTree ID=\"I\"/>", "<Script code=\"x := 1\"/>"), ["M/I::1/x=1"]);
    assert_eq!(held("<SubTree ID=\"I\" name=\"in\"/>", "<Script code=\"x := 1\"/>"), ["M/in/x=1"]);
}

#[test]
fn names_lead_out_where_the_subtree_says_so() {
    assert_eq!(held("<SubTree ID=\"I\" x=\"{y}\"/>", "<Script code=\"x := 1; z := 2\"/>"), ["y=1", "M/I::1/z=2"]);
    assert_eq!(held("<SubTree ID=\"I\" x=\"{=}\"/>", "<Script code=\"x := 1\"/>"), ["x=1"]);
    assert_eq!(held("<SubTree ID=\"I\" _autoremap=\"true\"/>", "<Script code=\"x := 1; _p := 2\"/>"), ["x=1", "M/I::1/_p=2"]);
    assert_eq!(held("<SubTree ID=\"I\"/>", "<Script code=\"@x := 1\"/>"), ["x=1"]);
}

/// As in BehaviorTree.CPP: unsetting an entry reaches no blackboard but that of its own tree.
#[test]
fn an_entry_outside_is_not_taken_away_by_a_subtree() {
    let main = |subtree: &str| format!("<Sequence><Script code=\"x := 1\"/>{subtree}</Sequence>");
    let unset = |key: &str| format!("<Sequence><Script code=\"z := 1\"/><UnsetBlackboard key=\"{key}\"/></Sequence>");
    assert_eq!(held(&main("<SubTree ID=\"I\" y=\"{x}\" z=\"{x}\"/>"), &unset("y")), ["x=1"]);
    assert_eq!(held(&main("<SubTree ID=\"I\" _autoremap=\"true\"/>"), &unset("x")), ["x=1", "z=1"]);
    assert_eq!(held(&main("<SubTree ID=\"I\"/>"), &unset("@x")), ["x=1", "M/I::3/z=1"]);
    assert_eq!(held(&main("<SubTree ID=\"I\"/>"), &unset("z")), ["x=1"]);
}

#[test]
fn a_subtree_can_be_given_a_text() {
    let inner = "<Sequence><Repeat num_cycles=\"{n}\"><AlwaysSuccess/></Repeat><Script code=\"m := n\"/></Sequence>";
    assert_eq!(held("<SubTree ID=\"I\" n=\"1\" m=\"{m}\"/>", inner), ["M/I::1/n=1", "m=1"]);
    let refused =
        Tree::build(&document("<SubTree ID=\"I\" n=\"x\"/>", inner), None, &Catalogue::default(), &mut Blackboard::new());
    assert_eq!(refused.unwrap_err().reason.to_string(), "the entry {M/I::1/n} is of type int and cannot hold \"x\"");
}

/// As in BehaviorTree.CPP since 4.9.1; before, each is a text.
#[test]
fn a_number_that_is_given_to_a_subtree_can_be_counted_with() {
    let given =
        |text: &str, code: &str| held(&format!("<SubTree ID=\"I\" v=\"{text}\"/>"), &format!("<Script code=\"{code}\"/>"));
    assert_eq!(given("2", "x := v * 2"), ["M/I::1/v=2", "M/I::1/x=4"]);
    assert_eq!(given("-2", "v += 5"), ["M/I::1/v=3"]);
    assert_eq!(given("0.5", "x := v * 3"), ["M/I::1/v=0.5", "M/I::1/x=1.5"]);
    assert_eq!(given("1e2", "x := v + 1"), ["M/I::1/v=100", "M/I::1/x=101"]);
    // What is not a number as a whole is a text.
    for text in ["1;2", "2 m", "", "two", " 2", "2 ", "+2", "0x10", "inf", "NaN", "-"] {
        assert_eq!(given(text, "x := v .. 'm'").last(), Some(&format!("M/I::1/x={text}m")), "{text}");
    }
    // A port has the text as it is written, with the port's own type.
    let port = |kind: &str, text: &str| {
        let inner = format!("<Sequence><{kind} queue=\"{{v}}\" value=\"{{x}}\"><AlwaysFailure/></{kind}></Sequence>");
        held(&format!("<ForceSuccess><SubTree ID=\"I\" v=\"{text}\"/></ForceSuccess>"), &inner)
    };
    assert!(port("LoopString", "007").contains(&"M/I::2/x=007".to_owned()));
    assert!(port("LoopDouble", "1.50").contains(&"M/I::2/x=1.5".to_owned()));
    // The number passes through names, and a model's default is passed in the same way.
    let nested = "<root BTCPP_format=\"4\" main_tree_to_execute=\"M\"><BehaviorTree ID=\"M\"><SubTree ID=\"I\"/></BehaviorTree>\
                  <BehaviorTree ID=\"I\"><SubTree ID=\"J\" w=\"{v}\"/></BehaviorTree>\
                  <BehaviorTree ID=\"J\"><Script code=\"w *= 3\"/></BehaviorTree>\
                  <TreeNodesModel><SubTree ID=\"I\"><input_port name=\"v\" default=\"2\"/></SubTree></TreeNodesModel></root>";
    assert_eq!(after_a_tick(&xml::read(nested).unwrap()), ["M/I::1/v=6"]);
}

#[test]
fn a_subtree_used_twice_has_two_blackboards_and_other_paths() {
    let main = "<Sequence><SubTree ID=\"I\" name=\"a\"/><SubTree ID=\"I\"/></Sequence>";
    assert_eq!(held(main, "<Script code=\"x := 1\"/>"), ["M/a/x=1", "M/I::4/x=1"]);
    let tree = Tree::build(&document(main, "<AlwaysSuccess name=\"s\"/>"), None, &Catalogue::default(), &mut Blackboard::new());
    let paths: Vec<String> = tree.unwrap().nodes().map(|node| node.path.to_owned()).collect();
    assert_eq!(paths, ["Sequence::1", "a", "a/s", "I::4", "I::4/s"]);
}

/// SRM1 and SRM2 meet; the Supervisor only waits. A party that has arrived stays counted, even when it is halted.
#[test]
fn a_barrier_opens_when_all_its_parties_have_come_and_stays_open() {
    let waits = |party: &str| {
        let root = format!("<Sync name=\"meet\" parties=\"SRM1;SRM2\"{party}/>");
        document(&root, "<AlwaysSuccess/>")
    };
    let mut blackboard = Blackboard::new();
    let tree =
        |party: &str, blackboard: &mut Blackboard| Tree::build(&waits(party), None, &Catalogue::default(), blackboard).unwrap();
    let mut first = tree(" party=\"SRM1\"", &mut blackboard);
    let mut second = tree(" party=\"SRM2\"", &mut blackboard);
    let mut supervisor = tree(" party=\"Supervisor\"", &mut blackboard);
    let mut tick = |tree: &mut Tree| tree.tick(&mut blackboard, &mut Mocks::default(), Duration::ZERO).unwrap();
    assert_eq!((tick(&mut supervisor), tick(&mut first)), (Status::Running, Status::Running));
    assert_eq!(tick(&mut supervisor), Status::Running, "one party is missing");
    assert_eq!(tick(&mut second), Status::Success);
    assert_eq!((tick(&mut supervisor), tick(&mut first)), (Status::Success, Status::Success));
    assert_eq!((tick(&mut supervisor), tick(&mut first), tick(&mut second)), (Status::Success, Status::Success, Status::Success));
    assert_eq!(blackboard.get("sync/meet/SRM1"), Some(&Value::Bool(true)));
}

#[test]
fn two_trees_on_one_blackboard_share_the_names_of_their_main_trees_alone() {
    let mut blackboard = Blackboard::new();
    let file = document("<Sequence><Script code=\"n := 0; n += 1\"/><SubTree ID=\"I\"/></Sequence>", "<Script code=\"x := 1\"/>");
    for _ in 0..2 {
        let mut tree = Tree::build(&file, None, &Catalogue::default(), &mut blackboard).unwrap();
        tree.tick(&mut blackboard, &mut Mocks::default(), Duration::ZERO).unwrap();
    }
    let names: Vec<&str> = blackboard.entries().map(|entry| entry.name()).collect();
    assert_eq!(names, ["n", "M/I::3/x", "M#2/I::3/x"]);
}
