//! `hallsweep tree`: checks behaviour tree files, prints them in the standard layout, and runs them with mocks for
//! their leaves. `behaviour_trees` executes the trees; `shown` prints the ticks.

use std::fs::File;
use std::io::{Read, stdin};
use std::path::{Path, PathBuf};
use std::time::Duration;

use behaviour_trees::document::{Document, Element};
use behaviour_trees::error::Reason;
use behaviour_trees::{Blackboard, Catalogue, Findings, Mocks, Status, Tree, TreeError, Value, ValueType, xml};
use clap::{Args, Subcommand};

use super::Failure;
use crate::telemetry;

mod meant;
mod shown;

use meant::Meant;

/// The subcommands of `hallsweep tree`.
#[derive(Args, Clone, Debug)]
pub struct Trees {
    #[command(subcommand)]
    what: What,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Print the contents of each file, or all its faults as `file:line:column: reason` with exit code 1. A note is not
    /// a fault.
    Check {
        /// The files; `-` is standard input.
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// A file whose `<TreeNodesModel>` declares nodes that the other files use.
        #[arg(long, value_name = "FILE")]
        model: Vec<PathBuf>,
    },
    /// Print a file in the standard layout: the same trees, without comments.
    Write {
        /// The file; `-` is standard input.
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Tick a tree with mocks for its leaves, and print the status of every node after each tick.
    Run(RunTree),
}

#[derive(Args, Clone, Debug)]
#[command(
    after_help = "The run ends when the tree is done, or after --ticks. Exit codes: 0 SUCCESS, 1 FAILURE, 2 still RUNNING,\n\
    3 the file or a mock is refused or a node cannot be performed, 4 SKIPPED.\n\
    With --json each tick is one line: {\"tick\":1,\"timeMs\":0,\"status\":\"RUNNING\",\"nodes\":[…],\"blackboard\":{…}}.\n\
    Each node, in preorder, has \"uid\", \"path\" (unique, as BehaviorTree.CPP's fullPath), \"name\", \"kind\", \"status\" (the result\n\
    of this tick if the node was ticked, else its present status), \"after\" (the status after the tick: IDLE if the parent\n\
    reset the node), \"ticked\", and \"halted\" if a leaf was halted in this tick."
)]
struct RunTree {
    /// The file; `-` is standard input.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The tree to run; by default the main tree of the file, or its only tree.
    #[arg(long, value_name = "ID")]
    tree: Option<String>,
    /// A file whose `<TreeNodesModel>` declares nodes that the tree uses.
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,
    /// Stop after this number of ticks.
    #[arg(long, value_name = "COUNT", default_value_t = 1000)]
    ticks: u64,
    /// The simulated time between two ticks, in milliseconds.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 100)]
    period: u64,
    /// Results of a leaf in successive ticks. NAME is the path, the name or the kind of the leaf ("*" is every other
    /// leaf). The last status repeats; RUNNING*3 is three ticks.
    #[arg(long, value_name = "NAME=STATUS,STATUS*3,…")]
    mock: Vec<String>,
    /// Value that a leaf writes to a port whenever it succeeds (NAME.port=value), or first value of a blackboard entry
    /// (entry=value).
    #[arg(long, value_name = "NAME.PORT=VALUE|ENTRY=VALUE")]
    set: Vec<String>,
    /// First value of a blackboard entry.
    #[arg(long, value_name = "ENTRY=VALUE")]
    blackboard: Vec<String>,
    /// Print one line of JSON per tick.
    #[arg(long)]
    json: bool,
}

pub fn run(asked: &Trees) -> Result<(), Failure> {
    match &asked.what {
        What::Check { files, model } => check(files, model),
        What::Write { file } => super::print(xml::write(&read(file).map_err(Failure::Run)?).trim_end()),
        What::Run(flags) => tick(flags),
    }
}

const STANDARD_INPUT: &str = "-";

/// The nodes that a file may use: the nodes that it declares, and the nodes that the files of `--model` declare. This
/// program has no leaves of its own.
fn known(document: &Document, models: &[Document]) -> Catalogue {
    let mut known = Catalogue::default();
    std::iter::once(document).chain(models).for_each(|document| known.add_models(document));
    known
}

fn declared(files: &[PathBuf]) -> Result<Vec<Document>, String> {
    let declared = |file: &PathBuf| match read(file)? {
        document if document.models.is_empty() => {
            Err(format!("{}: there is no <TreeNodesModel> with a node in it", file.display()))
        }
        document => Ok(document),
    };
    files.iter().map(declared).collect()
}

fn check(files: &[PathBuf], models: &[PathBuf]) -> Result<(), Failure> {
    let models = declared(models).map_err(Failure::Run)?;
    let mut refused = 0;
    for file in files {
        match checked(file, &models) {
            Ok(words) => super::print(&words)?,
            Err(words) => {
                telemetry::say(words);
                refused += 1;
            }
        }
    }
    match refused {
        0 => Ok(()),
        1 if files.len() == 1 => Err(Failure::Run("the file is refused".to_owned())),
        refused => Err(Failure::Run(format!("{refused} of {} files are refused", files.len()))),
    }
}

/// The contents of a file with its notes, or all its faults, one line each.
fn checked(file: &Path, models: &[Document]) -> Result<String, String> {
    let mut findings = Findings::default();
    let document = xml::read_with(&text(file)?, &mut findings);
    if let Some(document) = &document {
        document.check(&known(document, models), &mut findings);
    }
    let name = file.display();
    let mut lines: Vec<String> = findings.faults().into_iter().map(|fault| placed(file, fault)).collect();
    let is_good = lines.is_empty();
    if is_good {
        lines.extend(document.iter().map(|document| format!("{name}: {}", held(document))));
    }
    if findings.more() > 0 {
        lines.push(format!("{name}: and {} more faults", findings.more()));
    }
    let is_unknown = |fault: &&TreeError| matches!(fault.reason, Reason::UnknownNode(_) | Reason::UnknownParent(_));
    if models.is_empty() && findings.faults().iter().any(is_unknown) {
        lines.push(format!("{name}: note: use --model FILE for nodes that another file declares"));
    }
    lines.extend(findings.notes().iter().map(|note| format!("{name}:{}: note: {}", note.place, note.reason)));
    if is_good { Ok(lines.join("\n")) } else { Err(lines.join("\n")) }
}

fn placed(file: &Path, error: &TreeError) -> String {
    format!("{}:{error}", file.display())
}

fn held(document: &Document) -> String {
    fn count(element: &Element) -> usize {
        1 + element.children.iter().map(count).sum::<usize>()
    }
    let size = |tree: &Element| match count(tree) {
        1 => "1 node".to_owned(),
        many => format!("{many} nodes"),
    };
    let trees: Vec<String> = document.trees.iter().map(|tree| format!("{} ({})", tree.id, size(&tree.root))).collect();
    let main = match &document.main {
        _ if trees.len() < 2 => String::new(),
        Some(main) => format!("; {main} is the main tree"),
        None => "; no tree is the main tree".to_owned(),
    };
    if trees.is_empty() {
        return format!("well formed: no tree, {} declared nodes", document.models.len());
    }
    format!("well formed: {}{main}", trees.join(", "))
}

fn read(file: &Path) -> Result<Document, String> {
    xml::read(&text(file)?).map_err(|error| placed(file, &error))
}

fn text(file: &Path) -> Result<String, String> {
    let unreadable = |error: std::io::Error| format!("{} cannot be read: {error}", file.display());
    // One byte more than allowed is read. If it exists, the parser reports that the file is too long.
    let most = u64::try_from(xml::LONGEST_FILE).unwrap_or(u64::MAX).saturating_add(1);
    let mut bytes = Vec::new();
    let read = if file == Path::new(STANDARD_INPUT) {
        stdin().take(most).read_to_end(&mut bytes)
    } else {
        File::open(file).and_then(|open| open.take(most).read_to_end(&mut bytes))
    };
    read.map_err(unreadable)?;
    // A file that was cut off may end in the middle of a character. It is then refused because of its length.
    let is_cut = bytes.len() > xml::LONGEST_FILE;
    String::from_utf8(bytes).map_err(|error| {
        if is_cut {
            format!("{}:1:1: the file is longer than {} bytes", file.display(), xml::LONGEST_FILE)
        } else {
            format!("{} is not UTF-8: {}", file.display(), error.utf8_error())
        }
    })
}

fn tick(flags: &RunTree) -> Result<(), Failure> {
    let refused = |words: String| Failure::Tree(words, 3);
    let document = read(&flags.file).map_err(refused)?;
    let (mut mocks, entries) = scripted(flags).map_err(refused)?;
    let models = declared(&flags.model).map_err(refused)?;
    let catalogue = mocks.catalogue(&document, known(&document, &models));
    let mut blackboard = Blackboard::new();
    let built = Tree::build(&document, flags.tree.as_deref(), &catalogue, &mut blackboard);
    let mut tree = built.map_err(|error| {
        let hint = if let Reason::UnknownNode(id) = &error.reason {
            mock_it(id)
        } else if matches!(error.reason, Reason::NoMain(_)) {
            ": choose a tree with --tree".to_owned()
        } else {
            String::new()
        };
        refused(format!("{}{hint}", placed(&flags.file, &error)))
    })?;
    meant::check(&meant(flags), &document, &tree, &catalogue).map_err(refused)?;
    if let Some(bare) = mocks.missing(&tree) {
        let (file, place, name) = (flags.file.display(), bare.place, bare.name);
        return Err(refused(format!("{file}:{place}: there is no mock for the leaf {name}{}", mock_it(name))));
    }
    for (name, text) in entries {
        let unfit = |unfit: behaviour_trees::blackboard::Unfit| refused(unfit.to_string());
        blackboard.set(&name, value(&text, &blackboard, &name)).map_err(unfit)?;
    }
    let period = Duration::from_millis(flags.period);
    for number in 1..=flags.ticks {
        let since_last = if number == 1 { Duration::ZERO } else { period };
        let ticked = tree.tick(&mut blackboard, &mut mocks, since_last);
        let halted = mocks.take_halted();
        match &ticked {
            Ok(status) if flags.json => super::print(&shown::json(&tree, *status, &halted, &blackboard))?,
            Ok(status) => super::print(&shown::picture(&tree, *status, &halted, &blackboard))?,
            Err(fault) if flags.json => super::print(&shown::json_fault(number, fault))?,
            Err(_) => {}
        }
        match ticked {
            Ok(Status::Running) => {}
            Ok(Status::Success) => return Ok(()),
            Ok(Status::Failure) => return Err(Failure::Tree(format!("the tree returned FAILURE in tick {number}"), 1)),
            Ok(Status::Skipped | Status::Idle) => return Err(Failure::Tree(format!("the tree was skipped in tick {number}"), 4)),
            Err(fault) => return Err(Failure::Tree(format!("{}: in tick {number}: {fault}", flags.file.display()), 3)),
        }
    }
    Err(Failure::Tree(format!("the tree is still running after {} ticks", flags.ticks), 2))
}

fn mock_it(name: &str) -> String {
    format!(": add --mock '{name}=SUCCESS', or --mock '*=SUCCESS' for all leaves")
}

fn scripted(flags: &RunTree) -> Result<(Mocks, Vec<(String, String)>), String> {
    let mut mocks = Mocks::default();
    for mock in &flags.mock {
        mocks.add(mock).map_err(|error| format!("--mock: {error}"))?;
    }
    let mut entries = Vec::new();
    for text in &flags.set {
        let (name, value) =
            text.split_once('=').ok_or_else(|| format!("--set: {text:?} should be NAME.PORT=VALUE or ENTRY=VALUE"))?;
        match name.rsplit_once('.') {
            Some((leaf, port)) => mocks.write(leaf, port, value),
            None => entries.push((name.to_owned(), value.to_owned())),
        }
    }
    for text in &flags.blackboard {
        let (name, value) = text.split_once('=').ok_or_else(|| format!("--blackboard: {text:?} should be ENTRY=VALUE"))?;
        entries.push((name.to_owned(), value.to_owned()));
    }
    Ok((mocks, entries))
}

/// The leaves and ports that the flags name; the flags were parsed before.
fn meant(flags: &RunTree) -> Vec<Meant<'_>> {
    let mocks = flags.mock.iter().filter_map(|text| text.rsplit_once('=')).map(|(leaf, _)| (leaf, None));
    let sets = flags.set.iter().filter_map(|text| text.split_once('=')?.0.rsplit_once('.'));
    let mocks = mocks.map(|(leaf, port)| Meant { flag: "--mock", leaf, port });
    mocks.chain(sets.map(|(leaf, port)| Meant { flag: "--set", leaf, port: Some(port) })).collect()
}

/// Parses a value of the command line. The entry on the blackboard determines the type; if the entry has no type, the
/// text determines the type.
fn value(text: &str, blackboard: &Blackboard, name: &str) -> Value {
    let declared =
        blackboard.slot(name).and_then(|slot| blackboard.entry(slot)).map_or(ValueType::Any, |entry| entry.value_type());
    let looks_like = [ValueType::Int, ValueType::Number].into_iter().find_map(|ty| Value::parse(text, ty));
    match (declared, text, looks_like) {
        (ValueType::Any, "true" | "false", _) => Value::Bool(text == "true"),
        (ValueType::Any, _, Some(number)) => number,
        _ => Value::text(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_of_the_command_line_is_of_the_type_of_its_entry() {
        let mut blackboard = Blackboard::new();
        blackboard.declare("name", ValueType::Text).expect("it is new");
        assert_eq!(value("3", &blackboard, "name"), Value::text("3"));
        assert_eq!(value("3", &blackboard, "other"), Value::Int(3));
        assert_eq!(value("0.5", &blackboard, "other"), Value::Number(0.5));
        assert_eq!(value("true", &blackboard, "other"), Value::Bool(true));
        assert_eq!(value("3;4", &blackboard, "other"), Value::text("3;4"));
    }
}
