//! Files as BehaviorTree.CPP, its graphical editors and navigation2 write them: what is read, what is written again,
//! what is refused, and that every fault of a file is reported.

use std::time::Duration;

use behaviour_trees::findings::MOST_FAULTS;
use behaviour_trees::{Blackboard, Catalogue, Findings, Mocks, Status, Tree, xml};

/// A file of one tree T, whose node begins in line 2, and of models.
fn file(root: &str, models: &str) -> String {
    format!(
        "<root BTCPP_format=\"4\"><BehaviorTree ID=\"T\">\n{root}\n</BehaviorTree><TreeNodesModel>{models}</TreeNodesModel></root>"
    )
}

fn found(text: &str) -> (Vec<String>, Vec<String>) {
    let mut findings = Findings::default();
    if let Some(document) = xml::read_with(text, &mut findings) {
        let mut catalogue = Catalogue::default();
        catalogue.add_models(&document);
        document.check(&catalogue, &mut findings);
    }
    let faults = findings.faults().into_iter().map(ToString::to_string).collect();
    (faults, findings.notes().iter().map(ToString::to_string).collect())
}

fn faults(text: &str) -> Vec<String> {
    found(text).0
}

/// Each of these stands in files that a tool wrote. What is written again stands behind it, where it differs.
#[test]
fn what_other_tools_write_and_nothing_here_needs_is_kept() {
    let metadata = "<Action ID=\"A\"><input_port name=\"x\"/><MetadataFields><Metadata colour=\"blue\"/><Metadata n=\"1\"/></MetadataFields></Action>";
    let models = [
        metadata,
        "<Control ID=\"Sequence\"><MetadataFields><Metadata a=\"b\"/></MetadataFields></Control>",
        "<MetadataFields><Metadata a=\"&lt;\">said <b/>twice</Metadata></MetadataFields>",
        "<Condition ID=\"C\"><input_port name=\"x\" type=\"T\" default=\"\"/><description>what it asks</description></Condition>",
        "<SubTree ID=\"SubTree\"><input_port name=\"_autoremap\" type=\"bool\" default=\"false\">If true</input_port></SubTree>",
        "<Action ID=\"A\"><bidirectional_port name=\"index\">where it is</bidirectional_port></Action>",
    ];
    let tree = "<AlwaysSuccess name=\"a b.c\" _uid=\"1\" _fullpath=\"T/a\" _description=\"why\" _onSuccess=\"x := 1\"/>";
    let mut files: Vec<(String, String)> = models.map(|model| (file(tree, model), model.to_owned())).into();
    files[5].1 = models[5].replace("bidirectional", "inout");
    files[2].1 = "<MetadataFields><Metadata a=\"&lt;\">said twice<b/></Metadata></MetadataFields>".to_owned();
    let root = |before: &str, attributes: &str| {
        let file = file(tree, "").replace("BTCPP_format", &format!("{attributes} BTCPP_format"));
        (format!("{before}{file}"), attributes.to_owned())
    };
    files.push(root("<?xml-model href=\"tree.xsd\"?><!-- a note -->", "project_name=\"p\""));
    let schema = "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:noNamespaceSchemaLocation=\"tree.xsd\"";
    files.push(root("", schema));
    for (file, kept) in files {
        assert_eq!(faults(&file), Vec::<String>::new(), "{file}");
        let document = xml::read(&file).unwrap();
        let written = xml::write(&document);
        assert_eq!(xml::read(&written).unwrap(), document, "{written}");
        let squeezed = |text: &str| text.split_whitespace().collect::<String>();
        assert!(squeezed(&written).contains(&squeezed(&kept)), "{kept} is not in {written}");
    }
}

/// Such a file is written again; `check` and `run` say that more files belong to it.
#[test]
fn a_file_that_includes_another_is_written_again_and_not_run() {
    let project = "<root BTCPP_format=\"4\" project_name=\"p\">\n<include path=\"a.xml\" ros_pkg=\"b\"/>\n\
                   <TreeNodesModel><Action ID=\"A\"/></TreeNodesModel></root>";
    let document = xml::read(project).unwrap();
    assert!(xml::write(&document).contains("<include path=\"a.xml\" ros_pkg=\"b\"/>"));
    let mut catalogue = Catalogue::default();
    catalogue.add_models(&document);
    assert!(catalogue.place("A").is_some(), "what a project declares is known by it");
    let include = "2:1: <include> is not supported: put all trees into one file";
    assert_eq!(faults(project), [include]);
    let with_tree = project.replace("<TreeNodes", "<BehaviorTree ID=\"T\"><AlwaysSuccess/></BehaviorTree><TreeNodes");
    let document = xml::read(&with_tree).unwrap();
    let refused = Tree::build(&document, None, &Catalogue::default(), &mut Blackboard::new()).unwrap_err();
    assert_eq!(refused.to_string(), include);
}

/// navigation2's trees are full of them.
#[test]
fn a_control_node_or_decorator_that_a_file_declares_is_checked_and_not_run() {
    let models = "<Control ID=\"Pipeline\"/><Decorator ID=\"Rate\"><input_port name=\"hz\" type=\"double\"/></Decorator><Action ID=\"Go\"/>";
    let good = "<Pipeline><Rate hz=\"1.0\"><Pipeline><Go/></Pipeline></Rate><Control ID=\"Pipeline\"><Go/></Control></Pipeline>";
    let note = |id: &str, form: &str| {
        format!(
            "{id} is a <{form}> that the file declares: a tree with {id} can be checked but not run, since a mock \
             replaces only a leaf"
        )
    };
    let pipeline = format!("2:1: {}", note("Pipeline", "Control"));
    let rate = format!("2:11: {}", note("Rate", "Decorator"));
    assert_eq!(found(&file(good, models)), (vec![], vec![pipeline.clone(), rate]));
    let document = xml::read(&file(good, models)).unwrap();
    let mut mocks = Mocks::default();
    mocks.add("*=SUCCESS").unwrap();
    let catalogue = mocks.catalogue(&document, Catalogue::default());
    let refused = Tree::build(&document, None, &catalogue, &mut Blackboard::new()).unwrap_err();
    assert_eq!(refused.to_string(), pipeline);
    let wrong = "<Pipeline>\n<Rate hz=\"often\" x=\"1\" _skipIf=\"+\"/>\n<Action ID=\"Rate\"/>\n<Pipeline/>\n<Other><Go/></Other></Pipeline>";
    let expected = [
        "3:1: Rate has 0 children, and must have 1",
        "3:7: the port hz needs a value of type number, but has \"often\"",
        "3:18: Rate has no port x",
        "3:24: _skipIf is not a valid script: expected a value at character 0, found +",
        "4:1: Rate is written as <Action>, but is a node of another kind",
        "5:1: Pipeline has 0 children, and must have 1 or more",
        "6:1: the node Other is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>",
    ];
    assert_eq!(faults(&file(wrong, models)), expected);
}

/// Models of a separate file (`nav2_tree_nodes.xml`) count where the file of the trees says nothing else.
#[test]
fn models_of_another_file_are_known() {
    let trees = xml::read(
        &file("<Sequence><Go far=\"1\"/><Wait/><SubTree ID=\"T2\"/></Sequence>", "<Action ID=\"Wait\"/>")
            .replace("<TreeNodes", "<BehaviorTree ID=\"T2\"><Script code=\"x := far\"/></BehaviorTree><TreeNodes"),
    );
    let models = "<root BTCPP_format=\"4\"><TreeNodesModel><Action ID=\"Go\"><input_port name=\"far\"/></Action><Control ID=\"Wait\"/>\
                  <SubTree ID=\"T2\"><input_port name=\"far\" default=\"7\"/></SubTree></TreeNodesModel></root>";
    let (trees, models) = (trees.unwrap(), xml::read(models).unwrap());
    let mut catalogue = Catalogue::default();
    [&trees, &models].into_iter().for_each(|document| catalogue.add_models(document));
    let mut findings = Findings::default();
    trees.check(&catalogue, &mut findings);
    assert_eq!((findings.faults(), findings.notes()), (vec![], &[][..]));
    let mut mocks = Mocks::default();
    mocks.add("*=SUCCESS").unwrap();
    let mut blackboard = Blackboard::new();
    let mut tree = Tree::build(&trees, Some("T"), &catalogue, &mut blackboard).unwrap();
    assert_eq!(tree.tick(&mut blackboard, &mut mocks, Duration::ZERO), Ok(Status::Success));
    assert!(blackboard.entries().any(|entry| entry.name().ends_with("/x") && entry.value().is_some()), "the default has come");
}

#[test]
fn what_is_of_format_3_is_named_with_what_it_is_called_now() {
    let three = file("<SubTreePlus ID=\"S\" __autoremap=\"1\"/>", "").replace(" BTCPP_format=\"4\"", "");
    let expected = [
        "1:1: <root> has no BTCPP_format: write BTCPP_format=\"4\" if the file is of format 4, else convert it with \
         convert_v3_to_v4.py of BehaviorTree.CPP",
        "2:1: SubTreePlus is of format 3: in format 4 it is SubTree, with _autoremap where it has __autoremap",
    ];
    assert_eq!(faults(&three), expected);
    let table = [
        (
            "<SequenceStar><AlwaysSuccess/></SequenceStar>",
            "2:1: SequenceStar is of format 3: in format 4 it is SequenceWithMemory",
        ),
        (
            "<RetryUntilSuccesful num_attempts=\"1\"><AlwaysSuccess/></RetryUntilSuccesful>",
            "2:1: RetryUntilSuccesful is of format 3: in format 4 it is RetryUntilSuccessful",
        ),
        ("<SubTree ID=\"S\" __autoremap=\"1\"/>", "2:17: __autoremap is of format 3: in format 4 it is _autoremap"),
        (
            "<SubTree ID=\"S\" __shared_blackboard=\"1\"/>",
            "2:17: __shared_blackboard is of format 3: in format 4 it is _autoremap",
        ),
        ("<SubTree ID=\"S\" _autoRemap=\"1\"/>", "2:17: _autoRemap is no condition or setting: write _autoremap"),
        ("<AlwaysSuccess __skipIf=\"1\"/>", "2:16: __skipIf is no condition or setting: write _skipIf"),
        ("<AlwaysSuccess _skip_if=\"1\"/>", "2:16: _skip_if is no condition or setting: write _skipIf"),
    ];
    for (root, expected) in table {
        let file = file(root, "").replace("<TreeNodes", "<BehaviorTree ID=\"S\"><AlwaysSuccess/></BehaviorTree><TreeNodes");
        assert_eq!(faults(&file), [expected]);
    }
}

/// Versions before 4.10 accept them, and so do we.
#[test]
fn names_that_behaviortree_cpp_refuses_are_noted() {
    let noted = |text: &str| {
        let (faults, notes) = found(text);
        assert_eq!(faults, Vec::<String>::new(), "{text}");
        notes
    };
    let why = "a name has no blanks and none of < > & \" ' / \\ : * ? | .";
    for name in ["Main Tree", "Main.Tree", "a/b", "a&amp;b", "a*", "a&#9;b"] {
        let text = file("<AlwaysSuccess/>", "").replace("ID=\"T\"", &format!("ID=\"{name}\""));
        let name = name.replace("&amp;", "&").replace("&#9;", "\\t");
        assert_eq!(noted(&text), [format!("1:24: BehaviorTree.CPP refuses the name \"{name}\" from version 4.10 on: {why}")]);
    }
    for name in ["Root", "root"] {
        let text = file("<AlwaysSuccess/>", "").replace("ID=\"T\"", &format!("ID=\"{name}\""));
        assert!(noted(&text)[0].ends_with("from version 4.10 on: the name is reserved"));
    }
    let models = "<Action ID=\"x.y\"><input_port name=\"a.b\"/><input_port name=\"1\"/><input_port name=\"ID\"/></Action>";
    assert_eq!(noted(&file("<AlwaysSuccess name=\"a b.c\"/>", models)).len(), 4);
    assert_eq!(
        noted(&file("<AlwaysSuccess/>", "<Action ID=\"1A-_é\"><input_port name=\"a1-_\"/></Action>")),
        Vec::<String>::new()
    );
}

/// One fault of each step of reading, in the order of the file, and none that only follows from another.
#[test]
fn every_fault_of_a_file_is_told_at_once() {
    let text = "<root>\n<BehaviorTree ID=\"A\">\n<Sequence wrong=\"1\"> words\n<Say ID=\"x\" n=\"many\" m=\"1\"/>\n<Action/>\n<Fly/>\n\
                <SubTree ID=\"Nowhere\"/>\n<SubTree ID=\"A\"/>\n<SubTree ID=\"B\"/><SubTree ID=\"B\"/>\n</Sequence></BehaviorTree>\n\
                <BehaviorTree ID=\"B\">\n<Repeat><Inverter/></Repeat></BehaviorTree>\n<BehaviorTree ID=\"B\"><AlwaysSuccess/></BehaviorTree>\n\
                <BehaviorTree ID=\"C\"/>\n<Odd/>\n<TreeNodesModel><Action ID=\"Say\"><input_port name=\"n\" type=\"int\"/><input_port/></Action>\n\
                <Action/></TreeNodesModel>\n<TreeNodesModel/></root>";
    let expected = [
        "1:1: <root> has no BTCPP_format",
        "3:11: Sequence has no port wrong",
        "3:21: there is text between the elements: \"words\"",
        "4:1: <Say> has an ID, which only",
        "4:13: the port n needs a value of type int, but has \"many\"",
        "4:22: Say has no port m",
        "5:1: <Action> has no ID",
        "6:1: the node Fly is not known",
        "7:1: there is no tree Nowhere in the file",
        "8:1: the tree A uses itself",
        "12:1: Repeat needs its port num_cycles",
        "12:9: Inverter has 0 children, and must have 1",
        "13:1: the ID B is already in use",
        "14:1: the tree C has 0 root nodes, but must have one",
        "15:1: <Odd> is not allowed here",
        "16:67: <input_port> has no name",
        "17:1: <Action> has no ID",
        "18:1: there is a second <TreeNodesModel>, but only one is allowed",
    ];
    let told = faults(text);
    assert_eq!(told.len(), expected.len(), "{told:#?}");
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.starts_with(expected), "{told} is not {expected}");
    }
}

#[test]
fn of_very_many_faults_some_are_named_and_all_are_counted() {
    let trees = "<BehaviorTree ID=\"T\"><Sequence>\n".to_owned() + &"<Fly/>\n".repeat(1_000) + "</Sequence></BehaviorTree>";
    let mut findings = Findings::default();
    let document = xml::read_with(&format!("<root BTCPP_format=\"4\">{trees}</root>"), &mut findings).unwrap();
    document.check(&Catalogue::default(), &mut findings);
    assert_eq!((findings.faults().len(), findings.more()), (MOST_FAULTS, 900));
}

#[test]
fn a_tree_that_is_written_once_for_each_use_is_one_tree() {
    let tree = |id: &str, at: &str, root: &str| format!("<BehaviorTree ID=\"{id}\" _fullpath=\"{at}\">{root}</BehaviorTree>");
    let main =
        tree("M", "", "<Sequence><SubTree ID=\"S\" _fullpath=\"a\" _uid=\"2\"/><SubTree ID=\"S\" _fullpath=\"b\"/></Sequence>");
    let text = |second: &str| {
        let first = tree("S", "a", "<AlwaysSuccess _uid=\"3\"/>");
        format!("<root BTCPP_format=\"4\">{main}{first}{}</root>", tree("S", "b", second))
    };
    assert_eq!(faults(&text("<AlwaysSuccess _uid=\"5\"/>")), Vec::<String>::new());
    assert_eq!(faults(&text("<AlwaysFailure _uid=\"5\"/>")).len(), 1, "they are two trees");
    assert_eq!(faults(&text("<AlwaysSuccess _uid=\"5\"/>").replace(" _fullpath=\"b\">", ">")).len(), 1, "it was not written so");
}

/// A file of several trees needs no main one when a program names the one that runs.
#[test]
fn a_file_without_a_main_tree_is_well_formed() {
    let two = "<root BTCPP_format=\"4\"><BehaviorTree ID=\"A\"><AlwaysSuccess/></BehaviorTree>\
               <BehaviorTree ID=\"B\"><AlwaysFailure/></BehaviorTree></root>";
    assert_eq!(faults(two), Vec::<String>::new());
    let document = xml::read(two).unwrap();
    let build = |main| Tree::build(&document, main, &Catalogue::default(), &mut Blackboard::new());
    assert!(build(Some("B")).is_ok());
    let expected = "1:1: the file has several trees, but no main_tree_to_execute: A, B";
    assert_eq!(build(None).unwrap_err().to_string(), expected);
    let missing = two.replace("\"4\"", "\"4\" main_tree_to_execute=\"C\"");
    assert_eq!(faults(&missing), ["1:1: there is no tree C in the file"]);
}

/// BehaviorTree.CPP takes an empty default for none, and ignores that of an output that names no entry.
#[test]
fn a_default_that_cannot_be_one_is_none() {
    let models =
        "<Action ID=\"A\"><input_port name=\"n\" type=\"int\" default=\"\"/><output_port name=\"o\" default=\"7\"/></Action>";
    assert_eq!(faults(&file("<A/>", models)), Vec::<String>::new());
    let subtree = "<SubTree ID=\"S\"><input_port name=\"n\" default=\"\"/></SubTree>";
    let file = file("<SubTree ID=\"S\"/>", subtree)
        .replace("<TreeNodes", "<BehaviorTree ID=\"S\"><AlwaysSuccess/></BehaviorTree><TreeNodes");
    assert_eq!(faults(&file), ["2:1: S needs its port n"]);
}

#[test]
fn a_model_has_no_more_ports_than_can_be_bound() {
    let ports: String = (0..257).map(|n| format!("<input_port name=\"p{n}\"/>")).collect();
    let told = faults(&file("<AlwaysSuccess/>", &format!("<Action ID=\"A\">{ports}</Action>")));
    assert_eq!(told, ["3:32: there are more than 256 ports in one model"]);
    let deep = |depth: usize| format!("{}{}", "<a>".repeat(depth), "</a>".repeat(depth));
    assert_eq!(faults(&file("<AlwaysSuccess/>", &deep(100))), Vec::<String>::new());
    assert!(faults(&file("<AlwaysSuccess/>", &deep(10_000)))[0].contains("deeper than 128 levels"));
}
