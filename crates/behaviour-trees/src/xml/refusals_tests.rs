//! A table of tests. Every fault of a file must be reported with its line, its column and a reason.

use super::{read, read_with};
use crate::blackboard::Blackboard;
use crate::document::Document;
use crate::error::Reason;
use crate::findings::Findings;
use crate::leaf::{Catalogue, LeafKind, Port};
use crate::tree::Tree;
use crate::value::ValueType;

fn catalogue() -> Catalogue {
    let say = vec![Port::input("text", ValueType::Text), Port::input("times", ValueType::Int).or("1")];
    let ports = vec![Port::output("cell", ValueType::Cell)];
    Catalogue::new(vec![LeafKind::action("Say", say), LeafKind::condition("Near", ports)])
}

/// Returns the document of a file, or all its faults, one per line.
fn checked(text: &str) -> Result<Document, String> {
    let mut findings = Findings::default();
    let document = read_with(text, &mut findings);
    if let Some(document) = &document {
        document.check(&catalogue(), &mut findings);
    }
    match document {
        Some(document) if findings.faults().is_empty() => Ok(document),
        _ => Err(findings.faults().iter().map(|fault| fault.to_string()).collect::<Vec<String>>().join("\n")),
    }
}

/// Returns a file with this text as its only tree. The tree begins in line 2.
fn tree(root: &str) -> String {
    format!("<root BTCPP_format=\"4\"><BehaviorTree ID=\"T\">\n{root}\n</BehaviorTree></root>")
}

fn refused(text: &str, expected: &str) {
    assert_eq!(checked(text).expect_err(text), expected, "{text}");
}

#[test]
fn what_is_no_file_of_trees_is_refused() {
    refused("", "1:1: this is not XML: the document does not have a root node");
    refused("<root>\n <a></root>", "2:5: this is not XML: expected 'a' tag, not 'root'");
    refused("<html/>", "1:1: the file begins with <html> instead of <root BTCPP_format=\"4\">");
    refused(
        "<root BTCPP_format=\"3\"><TreeNodesModel><Action ID=\"A\"/></TreeNodesModel></root>",
        "1:1: <root> says BTCPP_format=\"3\", but only format \"4\" is supported",
    );
    refused("<root BTCPP_format=\"4\"/>", "1:1: there is no <BehaviorTree> in the file");
    refused(
        "<root BTCPP_format=\"4\"><Sequence/></root>",
        "1:1: there is no <BehaviorTree> in the file\n1:24: <Sequence> is not allowed here",
    );
    refused("<root BTCPP_format=\"4\"><BehaviorTree ID=\"\"><Say/></BehaviorTree></root>", "1:24: <BehaviorTree> has no ID");
    refused(
        "<root BTCPP_format=\"4\"><include path=\"x.xml\"/></root>",
        "1:24: <include> is not supported: put all trees into one file",
    );
    refused(
        "<root BTCPP_format=\"4\"><TreeNodesModel/>\n<TreeNodesModel/></root>",
        "1:1: there is no <BehaviorTree> in the file\n2:1: there is a second <TreeNodesModel>, but only one is allowed",
    );
    refused(
        "<root BTCPP_format=\"4\"><TreeNodesModel><Action ID=\"A\"><input_port/></Action></TreeNodesModel></root>",
        "1:55: <input_port> has no name",
    );
    refused("<root BTCPP_format=\"4\"><BehaviorTree ID=\"T\"/></root>", "1:24: the tree T has 0 root nodes, but must have one");
    refused(
        &tree("<AlwaysSuccess/> and <AlwaysSuccess/>"),
        "1:24: the tree T has 2 root nodes, but must have one\n2:17: there is text between the elements: \"and\"",
    );
    refused(&tree("<b:AlwaysSuccess xmlns:b=\"x\"/>"), "2:1: xmlns is not supported: files of trees have no namespaces");
    refused(&tree("<AlwaysSuccess name='xmlns' xmlns='x'/>"), "2:1: xmlns is not supported: files of trees have no namespaces");
    refused(&tree("<AlwaysSuccess xml:lang=\"x\"/>"), "2:1: <AlwaysSuccess> is not allowed here");
    let doctype = "<!DOCTYPE a [<!ENTITY x \"y\">]><root BTCPP_format=\"4\"/>";
    assert!(
        checked(doctype).expect_err("a file needs no entities of its own").contains("this is not XML: XML with DTD detected")
    );
    let long = " ".repeat(super::LONGEST_FILE + 1);
    refused(&long, "1:1: the file is 1048577 bytes long; the limit is 1048576 bytes");
}

#[test]
fn what_nodes_are_not_is_refused() {
    refused(&tree("<Sequence>\n  <Fly/></Sequence>"), "3:3: the node Fly is not known");
    refused(&tree("<Action/>"), "2:1: <Action> has no ID");
    refused(
        &tree("<Say ID=\"x\"/>"),
        "2:1: <Say> has an ID, which only <Action>, <Condition>, <Control>, <Decorator> and <SubTree> have",
    );
    refused(&tree("<Condition ID=\"Say\"/>"), "2:1: Say is written as <Condition>, but is a node of another kind");
    refused(
        &tree("<Decorator ID=\"Sequence\"><Say/></Decorator>"),
        "2:1: Sequence is written as <Decorator>, but is a node of another kind",
    );
    refused(&tree("<Sequence/>"), "2:1: Sequence has 0 children, and must have 1 or more");
    refused(&tree("<Inverter><Say/><Say/></Inverter>"), "2:1: Inverter has 2 children, and must have 1");
    refused(&tree("<IfThenElse><Near/></IfThenElse>"), "2:1: IfThenElse has 1 children, and must have 2 to 3");
    refused(&tree("<Switch2 variable=\"{x}\"><Say/><Say/></Switch2>"), "2:1: Switch2 has 2 children, and must have 3");
    refused(&tree("<Say><Say/></Say>"), "2:1: Say has 1 children, and must have none");
    refused(&tree("<TryCatch><Say/></TryCatch>"), "2:1: TryCatch has 1 children, and must have 2 or more");
    let two = "<AsyncSequence><Say/></AsyncSequence>".repeat(2);
    refused(
        &tree(&format!("<ReactiveSequence>{two}</ReactiveSequence>")),
        "2:1: ReactiveSequence has more than one AsyncSequence as a child",
    );
}

#[test]
fn what_ports_are_not_is_refused() {
    refused(&tree("<Say txt=\"a\"/>"), "2:6: Say has no port txt");
    refused(&tree("<Sequence text=\"a\"><Say/></Sequence>"), "2:11: Sequence has no port text");
    refused(&tree("<Say times=\"many\"/>"), "2:6: the port times needs a value of type int, but has \"many\"");
    refused(
        &tree("<Repeat num_cycles=\"1.5\"><Say/></Repeat>"),
        "2:9: the port num_cycles needs a value of type int, but has \"1.5\"",
    );
    refused(&tree("<Repeat><Say/></Repeat>"), "2:1: Repeat needs its port num_cycles");
    refused(&tree("<Timeout msec=\"-1\"><Say/></Timeout>"), "2:10: the port msec is \"-1\", and must be 0 or more");
    refused(&tree("<LoopInt queue=\"1;x\"><Say/></LoopInt>"), "2:10: the port queue needs a value of type int, but has \"x\"");
    refused(
        &tree("<LoopInt queue=\"1;2\" value=\"v\"><Say/></LoopInt>"),
        "2:22: the port value is an output, so its value must name an entry: {name}",
    );
    refused(&tree("<Near cell=\"3;4\"/>"), "2:7: the port cell is an output, so its value must name an entry: {name}");
    refused(
        &tree("<Sequence><Near cell=\"{x}\"/>\n<Say text=\"{x}\"/></Sequence>"),
        "3:6: the entry {x} is of type cell elsewhere, and of type text here",
    );
    refused(
        &tree("<Script code=\"{x}\"/>"),
        "2:9: the port code is read when the tree is built, so its value cannot be an entry",
    );
    refused(&tree("<Script code=\"1 +\"/>"), "2:9: code is not a valid script: expected a value at character 3, found the end");
    refused(&tree("<Say _skipIf=\"\"/>"), "2:6: _skipIf is not a valid script: the script is empty");
    refused(&tree("<Say _skipif=\"1\"/>"), "2:6: _skipif is no condition or setting: write _skipIf");
    refused(
        &tree("<Precondition if=\"1\" else=\"IDLE\"><Say/></Precondition>"),
        "2:22: the port else is \"IDLE\", and must be SUCCESS, FAILURE, RUNNING or SKIPPED",
    );
    refused(
        &tree("<Sync parties=\"a;;b\"/>"),
        "2:7: the port parties is \"a;;b\", and must be 1 to 16 different names, separated by ;",
    );
    refused(
        &tree("<Sequence><Sync parties=\"a;b\"/><Sync parties=\"a;c\"/></Sequence>"),
        "2:38: another node gives the barrier Sync different parties",
    );
}

#[test]
fn what_trees_are_not_to_each_other_is_refused() {
    let file = |main: &str, trees: &str| format!("<root BTCPP_format=\"4\"{main}>\n{trees}\n</root>");
    let two = "<BehaviorTree ID=\"A\"><SubTree ID=\"B\"/></BehaviorTree>\n<BehaviorTree ID=\"B\"><Say/></BehaviorTree>";
    refused(&file(" main_tree_to_execute=\"C\"", two), "1:1: there is no tree C in the file");
    assert!(checked(&file(" main_tree_to_execute=\"A\"", two)).is_ok());
    let itself = two.replace("<Say/>", "<SubTree ID=\"A\"/>");
    refused(&file(" main_tree_to_execute=\"A\"", &itself), "2:22: the tree B uses itself\n3:22: the tree A uses itself");
    refused(&tree("<SubTree ID=\"X\"/>"), "2:1: there is no tree X in the file");
    let twice = two.replace("ID=\"B\"><Say", "ID=\"A\"><Say").replace("<SubTree ID=\"B\"/>", "<Say/>");
    refused(&file(" main_tree_to_execute=\"A\"", &twice), "3:1: the ID A is already in use");
    let taken = two.replace("\"B\"", "\"Say\"");
    refused(&file(" main_tree_to_execute=\"A\"", &taken), "3:1: the ID Say is the name of a kind of node");
    let model = "<TreeNodesModel><SubTree ID=\"B\"><input_port name=\"goal\"/></SubTree></TreeNodesModel>";
    refused(&file(" main_tree_to_execute=\"A\"", &format!("{two}{model}")), "2:22: B needs its port goal");
    let twice = "<TreeNodesModel><Action ID=\"X\"/><Action ID=\"X\"/></TreeNodesModel>";
    refused(&file(" main_tree_to_execute=\"A\"", &format!("{two}{twice}")), "3:75: the ID X is already in use");
}

/// BehaviorTree.CPP gives the tree the same name. Thus `read(write(document))` is the same document.
#[test]
fn a_tree_without_an_id_is_called_by_its_number() {
    let document = checked("<root BTCPP_format=\"4\"><BehaviorTree><Say/></BehaviorTree></root>").expect("it is a good file");
    assert_eq!(document.trees[0].id, "BehaviorTree_0");
}

/// A file that `check` refuses must not run either.
#[test]
fn trees_of_one_id_are_refused_when_one_is_built() {
    let twice = "<BehaviorTree ID=\"A\"><Say/></BehaviorTree>".repeat(2);
    let file = format!("<root BTCPP_format=\"4\" main_tree_to_execute=\"A\">{twice}</root>");
    let document = read(&file).expect("its XML is good");
    let refused = Tree::build(&document, None, &catalogue(), &mut Blackboard::new()).expect_err("which one is meant?");
    assert_eq!(refused.reason, Reason::TwiceId("A".to_owned()));
}

/// These few subtrees use each other twice and would become a million nodes.
#[test]
fn what_would_fill_the_memory_is_refused() {
    let trees: String = (0..40)
        .map(|n| {
            format!(
                "<BehaviorTree ID=\"t{n}\"><Sequence><SubTree ID=\"t{}\"/><SubTree ID=\"t{0}\"/></Sequence></BehaviorTree>",
                n + 1
            )
        })
        .collect();
    let file = format!(
        "<root BTCPP_format=\"4\" main_tree_to_execute=\"t0\">{trees}<BehaviorTree ID=\"t40\"><Say/></BehaviorTree></root>"
    );
    let said = checked(&file).expect_err("it is too large");
    assert!(said.ends_with("the tree has more than 10000 nodes, subtrees included"), "{said}");
    let long = format!("<Say _note=\"{}\"/>", "x".repeat(200_000));
    let uses = |count: usize| format!("<Sequence>{}</Sequence>", "<SubTree ID=\"L\"/>".repeat(count));
    let file = |trees: usize, leaf: &str, count: usize| {
        let trees: String = (0..trees).map(|n| format!("<BehaviorTree ID=\"t{n}\">{}</BehaviorTree>", uses(count))).collect();
        let main = "<root BTCPP_format=\"4\" main_tree_to_execute=\"t0\">";
        format!("{main}{trees}\n<BehaviorTree ID=\"L\">{leaf}</BehaviorTree></root>")
    };
    assert!(checked(&file(1, &long, 10)).is_ok());
    let said = checked(&file(1, &long, 11)).expect_err("too much in one");
    assert!(said.ends_with("the attributes of the tree are longer than 2097152 bytes, subtrees included"), "{said}");
    let said = checked(&file(5, &long, 10)).expect_err("too much together");
    assert!(
        said.ends_with("there are more than 8388608 bytes of attributes in the trees up to this one, subtrees included"),
        "{said}"
    );
    let many = format!("<Sequence>{}</Sequence>", "<Say/>".repeat(97));
    let said = checked(&file(30, &many, 90)).expect_err("too many together");
    assert!(said.ends_with("there are more than 200000 nodes in the trees up to this one, subtrees included"), "{said}");
    let deep = format!("{}<Say/>{}", "<Inverter>".repeat(200), "</Inverter>".repeat(200));
    refused(&tree(&deep), "2:1281: the tree is deeper than 128 levels, subtrees included");
    let deeper = "<a>".repeat(100_000);
    refused(&tree(&deeper), "1:1: there are more than 32768 elements, comments and texts in one file");
    let crowd: String = (0..65).map(|n| format!(" a{n}=\"1\"")).collect();
    refused(&tree(&format!("<Say{crowd}/>")), "2:1: there are more than 64 attributes in one element");
    // `<!-->` looks like a whole comment, but it is only the beginning of a comment.
    refused(&tree(&format!("<!--> <x a=\"--><Say{crowd}/>")), "2:16: there are more than 64 attributes in one element");
    let passed = format!("<!-- <Say{crowd} xmlns='x'/> --><?say {crowd} xmlns='x'?><AlwaysSuccess/>");
    assert!(checked(&tree(&passed)).is_ok(), "what is no element is not counted");
    let trees = "<BehaviorTree ID=\"x\"><Say/></BehaviorTree>".repeat(201);
    let file = format!("<root BTCPP_format=\"4\">{trees}</root>");
    assert!(checked(&file).expect_err("too many").ends_with("there are more than 200 trees in one file"));
}

/// Columns are counted in characters, even in a file of one long line with a fault far from its beginning.
#[test]
fn the_place_of_a_refusal_is_where_an_editor_shows_it() {
    let before = "<Say text=\"é🧳\"/>".repeat(50);
    refused(&tree(&format!("<Sequence>{before}<Fly/></Sequence>")), "2:811: the node Fly is not known");
}
