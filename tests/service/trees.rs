//! What the page about trees shows of the command line is what it prints.

use crate::program::run;

/// The commands of `docs/trees.md` that name its example, each with what stands below it there.
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
