//! The output of `hallsweep tree` in `docs/trees.md` is what the command prints.

use std::path::Path;

use crate::program::{hallsweep, run};

/// Commands in `docs/trees.md` that use the example files, each with the output on the page.
fn shown() -> Vec<(String, String)> {
    let page = std::fs::read_to_string("docs/trees.md").expect("the page is there");
    let blocks = page.split("```\n").filter(|block| block.starts_with("$ hallsweep tree"));
    let commands = blocks.flat_map(|block| block.split("$ hallsweep ").map(str::to_owned).collect::<Vec<_>>());
    let split = commands.filter_map(|shown| shown.split_once('\n').map(|(command, said)| (command.to_owned(), said.to_owned())));
    split.filter(|(command, _)| command.contains("docs/examples/")).collect()
}

#[test]
fn the_page_about_trees_shows_what_its_example_prints() {
    let shown = shown();
    assert_eq!(shown.len(), 2, "{shown:?}");
    for (command, said) in shown {
        let arguments: Vec<String> = command.split(' ').map(|word| word.replace('\'', "")).collect();
        let output = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(String::from_utf8_lossy(&output.stdout), said, "{command}");
    }
}

/// Runs a command in a new folder with these files. Returns the exit code, standard output and standard error.
fn said(name: &str, files: &[(&str, &str)], arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("trees-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    for (file, text) in files {
        std::fs::write(folder.join(file), text).expect("the file can be written");
    }
    let output = hallsweep(arguments).current_dir(&folder).output().expect("the program starts");
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("it is text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// A navigation2 tree, which does not declare its nodes, and the file that declares them.
const NAVIGATION: [(&str, &str); 2] = [
    (
        "tree.xml",
        "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\">\n<BehaviorTree ID=\"Main\">\n<RecoveryNode number_of_retries=\"6\" name=\"all\">\n\
         <Follow path=\"{path}\"/><Wait duration=\"5\"/></RecoveryNode>\n</BehaviorTree>\n\
         <BehaviorTree ID=\"Only Leaves\"><Wait duration=\"5\"/></BehaviorTree></root>",
    ),
    (
        "models.xml",
        "<root BTCPP_format=\"4\"><TreeNodesModel><Control ID=\"RecoveryNode\"><input_port name=\"number_of_retries\"/></Control>\
         <Action ID=\"Follow\"><input_port name=\"path\"/><bidirectional_port name=\"index\"/><MetadataFields><Metadata a=\"b\"/>\
         </MetadataFields></Action><Action ID=\"Wait\"><input_port name=\"duration\" type=\"double\"/></Action></TreeNodesModel></root>",
    ),
];

#[test]
fn nodes_that_another_file_declares_are_known_by_it_and_trees_of_leaves_run() {
    let model = ["--model", "models.xml"];
    let (code, out, _) = said("models", &NAVIGATION, &["tree", "check", "tree.xml", "models.xml", model[0], model[1]]);
    let foreign = "RecoveryNode is a <Control> that the file declares: a tree with RecoveryNode can be checked but not run, \
                   since a mock replaces only a leaf";
    let expected = format!(
        "tree.xml: well formed: Main (3 nodes), Only Leaves (1 node); Main is the main tree\n\
         tree.xml:6:1: note: BehaviorTree.CPP refuses the name \"Only Leaves\" from version 4.10 on: a name has no blanks and \
         none of < > & \" ' / \\ : * ? | .\n\
         tree.xml:3:1: note: {foreign}\nmodels.xml: well formed: no tree, 3 declared nodes\n"
    );
    assert_eq!((code, out), (Some(0), expected));
    let ran =
        |more: &[&str]| said("models", &NAVIGATION, &[&["tree", "run", "tree.xml", "--mock", "*=SUCCESS"][..], more].concat());
    let (code, _, error) = ran(&model);
    assert_eq!((code, error), (Some(3), format!("hallsweep: tree.xml:3:1: {foreign}\n")));
    let (code, out, _) = ran(&["--tree", "Only Leaves", "--model", "models.xml"]);
    assert_eq!((code, out), (Some(0), "tick 1 at 0.0 s: SUCCESS\n  SUCCESS  Wait\n".to_owned()));
    // A mock cannot stand in for a node with children, so without the models none is offered.
    let (code, _, error) = ran(&[]);
    let unknown =
        "the node RecoveryNode is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>";
    assert_eq!((code, error), (Some(3), format!("hallsweep: tree.xml:3:1: {unknown}\n")));
    let (code, _, error) = ran(&["--model", "tree.xml"]);
    assert_eq!((code, error), (Some(3), "hallsweep: tree.xml: there is no <TreeNodesModel> with a node in it\n".to_owned()));
}

#[test]
fn tree_check_tells_every_fault_of_a_file_with_its_place() {
    let wrong =
        "<root>\n<BehaviorTree ID=\"A\"><Sequence>\n<Fly/><Sleep msec=\"soon\"/>\n<Inverter/></Sequence></BehaviorTree></root>";
    let many = format!(
        "<root BTCPP_format=\"4\"><BehaviorTree ID=\"A\"><Sequence>{}</Sequence></BehaviorTree></root>",
        "<Fly/>".repeat(150)
    );
    let (code, out, error) = said("faults", &[("a.xml", wrong), ("b.xml", &many)], &["tree", "check", "a.xml", "b.xml"]);
    assert_eq!((code, out.as_str()), (Some(1), ""));
    let lines: Vec<&str> = error.lines().collect();
    assert!(lines[0].starts_with("a.xml:1:1: <root> has no BTCPP_format: write BTCPP_format=\"4\""), "{error}");
    let hint = "note: use --model FILE for nodes that another file declares";
    let hints = ["a.xml", "b.xml"].map(|file| format!("{file}: {hint}"));
    let expected = [
        "a.xml:3:1: the node Fly is not known",
        "a.xml:3:14: the port msec needs a value of type int, but has \"soon\"",
        "a.xml:4:1: Inverter has 0 children, and must have 1",
        &hints[0],
    ];
    assert_eq!(lines[1..5], expected);
    let named = [lines[5], lines[104]];
    assert_eq!(named, ["b.xml:1:55: the node Fly is not known", "b.xml:1:649: the node Fly is not known"], "a hundred are named");
    assert_eq!(lines[105..], ["b.xml: and 50 more faults", &hints[1], "hallsweep: 2 of 2 files are refused"]);
}

/// A program that names the tree itself can use such a file.
#[test]
fn a_file_without_a_main_tree_is_well_formed_and_runs_by_its_name() {
    let file = [(
        "a.xml",
        "<root BTCPP_format=\"4\"><BehaviorTree ID=\"A\"><AlwaysSuccess/></BehaviorTree>\
         <BehaviorTree ID=\"B\"><AlwaysSuccess/></BehaviorTree></root>",
    )];
    let (code, out, _) = said("main", &file, &["tree", "check", "a.xml"]);
    assert_eq!((code, out.as_str()), (Some(0), "a.xml: well formed: A (1 node), B (1 node); no tree is the main tree\n"));
    assert_eq!(said("main", &file, &["tree", "run", "a.xml", "--tree", "B"]).0, Some(0));
    let (code, _, error) = said("main", &file, &["tree", "run", "a.xml"]);
    assert!(code == Some(3) && error.ends_with("no main_tree_to_execute: A, B: choose a tree with --tree\n"), "{error}");
}
