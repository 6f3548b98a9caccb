//! Why a file of trees is refused, with the place in the file, in one sentence each. An error while a tree runs is a
//! `tick::Fault`.

use std::fmt;

use super::blackboard::Unfit;
use super::document::SourcePosition;
use super::script::ScriptError;
use super::tree::{DEEPEST, MOST_NODES, MOST_TEXT};
use super::value::ValueType;

/// A fault of a file, or a note about it, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeError {
    /// The place to show in an editor; line 1, column 1 if the fault concerns the whole file.
    pub place: SourcePosition,
    /// What is wrong, in one sentence that does not name the place.
    pub reason: Reason,
}

impl TreeError {
    pub(crate) const fn at(place: SourcePosition, reason: Reason) -> TreeError {
        TreeError { place, reason }
    }
}

impl fmt::Display for TreeError {
    /// Written as `line:column: reason`; a caller that knows the file puts its name in front.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.reason)
    }
}

impl std::error::Error for TreeError {}

/// Why a file is refused, or what is noted about it, with a sentence for its author.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Reason {
    /// The file is longer than `xml::LONGEST_FILE`.
    #[error("the file is {length} bytes long; the limit is {most} bytes")]
    TooLong {
        /// The length of the file in bytes.
        length: usize,
        /// The longest file that is read, in bytes.
        most: usize,
    },
    /// The message of the XML parser, without the place.
    #[error("this is not XML: {0}")]
    NotXml(String),
    /// The name of the root element of a file that is XML, but not a file of trees.
    #[error("the file begins with <{0}> instead of <root BTCPP_format=\"4\">")]
    NotTrees(String),
    /// The file has no version. Files of format 3 have none, so format 4 is not assumed.
    #[error(
        "<root> has no BTCPP_format: write BTCPP_format=\"4\" if the file is of format 4, else convert it with \
         convert_v3_to_v4.py of BehaviorTree.CPP"
    )]
    NoFormat,
    /// The value of `BTCPP_format`, if it is not 4.
    #[error("<root> says BTCPP_format=\"{0}\", but only format \"4\" is supported")]
    Format(String),
    /// The name of an element that is not allowed in its place, or is of another namespace.
    #[error("<{0}> is not allowed here")]
    Misplaced(String),
    /// An XML namespace. Only prefixes that the root declares are allowed, as in a file with a schema.
    #[error("xmlns is not supported: files of trees have no namespaces")]
    Namespace,
    /// An `<include>`: this crate opens no files.
    #[error("<include> is not supported: put all trees into one file")]
    Include,
    /// A second `<TreeNodesModel>`. Faults in it are reported as well.
    #[error("there is a second <TreeNodesModel>, but only one is allowed")]
    SecondModel,
    /// The element of a port without a name in a model, such as `input_port`.
    #[error("<{0}> has no name")]
    NoName(String),
    /// The first 40 characters of a text between elements.
    #[error("there is text between the elements: {0:?}")]
    Text(String),
    /// The name of an element whose `ID` is missing or empty.
    #[error("<{0}> has no ID")]
    NoId(String),
    /// The name of an element that is its own kind, such as `<Sequence>`, and nevertheless has an ID.
    #[error("<{0}> has an ID, which only <Action>, <Condition>, <Control>, <Decorator> and <SubTree> have")]
    NeedlessId(String),
    /// The ID of two models, or of two trees that differ. Equal trees are allowed, since BehaviorTree.CPP writes a tree
    /// once for each use.
    #[error("the ID {0} is already in use")]
    TwiceId(String),
    /// The ID of a tree that is the name of a built-in node or of a leaf in the catalogue.
    #[error("the ID {0} is the name of a kind of node")]
    TakenId(String),
    /// A tree without a root, or with several; comments do not count.
    #[error("the tree {id} has {count} root nodes, but must have one")]
    Roots {
        /// The tree's ID; `BehaviorTree_0` and so on for a tree without one.
        id: String,
        /// Number of elements in the `<BehaviorTree>`.
        count: usize,
    },
    /// A file without trees. A file with only models can be read, but not run.
    #[error("there is no <BehaviorTree> in the file")]
    NoTree,
    /// The IDs of several trees, none of which is the main one.
    #[error("the file has several trees, but no main_tree_to_execute: {0}")]
    NoMain(String),
    /// The ID for which a `<SubTree>`, the file or the program asks, but which no tree has.
    #[error("there is no tree {} in the file", .0.escape_debug())]
    UnknownTree(String),
    /// A tree that uses itself, directly or by way of others.
    #[error("the tree {0} uses itself")]
    Recursive(String),
    /// The name of an element without children that is neither a built-in node nor in the catalogue.
    #[error("the node {0} is not known")]
    UnknownNode(String),
    /// The name of an element with children that is no built-in node. Since it has children, it cannot be a leaf.
    #[error("the node {0} is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>")]
    UnknownParent(String),
    /// A node or an attribute of format 3 that has another name in format 4.
    #[error("{written} is of format 3: in format 4 it is {now}")]
    Format3 {
        /// The name in the file, such as `SequenceStar`.
        written: String,
        /// What to write in format 4, such as `SequenceWithMemory`.
        now: &'static str,
    },
    /// A declared control node or decorator, which cannot be performed here.
    #[error(
        "{id} is a <{form}> that the file declares: a tree with {id} can be checked but not run, since a mock replaces only \
         a leaf"
    )]
    NotPerformed {
        /// The name by which its model declares it.
        id: String,
        /// `Control` or `Decorator`.
        form: &'static str,
    },
    /// A name that is accepted here, but not by the newest version of BehaviorTree.CPP.
    #[error("BehaviorTree.CPP refuses the name {name:?} from version 4.10 on: {why}")]
    RefusedThere {
        /// The name of a tree, a model or a port.
        name: String,
        /// Why the name is refused, as the end of a sentence.
        why: &'static str,
    },
    /// An element of the wrong form for its node, such as `<Condition ID="Sequence">`.
    #[error("{id} is written as <{written}>, but is a node of another kind")]
    WrongForm {
        /// The kind that its `ID` names, such as `Sequence`.
        id: String,
        /// The element in the file, such as `Condition`.
        written: &'static str,
    },
    /// More or fewer children than a node of this kind has; comments do not count.
    #[error("{id} has {count} children, and must have {wanted}")]
    Children {
        /// The kind of the parent, such as `Inverter`.
        id: String,
        /// The number of children; a subtree counts as one.
        count: usize,
        /// The allowed number in words, such as `2 to 3`.
        wanted: String,
    },
    /// Two asynchronous children, each of which would have the other halted.
    #[error("ReactiveSequence has more than one AsyncSequence as a child")]
    TwoAsync,
    /// An attribute that is no port of this kind. Attributes that begin with `_` are never ports.
    #[error("{id} has no port {port}")]
    UnknownPort {
        /// The kind of the node, such as `Repeat`.
        id: String,
        /// The name of the attribute, such as a misspelt `num_cycle`.
        port: String,
    },
    /// An attribute that resembles a condition but is none: ignoring it would be dangerous.
    #[error("{written} is no condition or setting: write {meant}")]
    Misspelt {
        /// The name of the attribute, with its wrong capitals or underscores.
        written: String,
        /// The condition that it resembles, or `_autoremap`.
        meant: &'static str,
    },
    /// A port of a node, or of the model of a subtree, that is not set and has no default.
    #[error("{id} needs its port {port}")]
    MissingPort {
        /// The kind of the node, or the ID of the subtree.
        id: String,
        /// The attribute to add, such as `num_cycles`.
        port: String,
    },
    /// A literal, or an element of a queue, that cannot be read as the required type.
    #[error("the port {port} needs a value of type {}, but has \"{value}\"", ty.word())]
    Literal {
        /// The attribute with the literal, such as `num_cycles`.
        port: String,
        /// The type of the port, or of the elements of its queue.
        ty: ValueType,
        /// The literal, or the wrong element of the queue.
        value: String,
    },
    /// The name of a port that writes an entry, but has a literal.
    #[error("the port {0} is an output, so its value must name an entry: {{name}}")]
    LiteralOutput(String),
    /// The name of a port whose value is needed when the tree is built, but that names an entry.
    #[error("the port {0} is read when the tree is built, so its value cannot be an entry")]
    EntryForLiteral(String),
    /// A value that the port cannot have, although its type is right, such as a negative time.
    #[error("the port {port} is {value:?}, and must be {wanted}")]
    Word {
        /// The attribute with the value, such as `msec`.
        port: String,
        /// The value as it is written, such as `-1`.
        value: String,
        /// The allowed values of the port, in words.
        wanted: &'static str,
    },
    /// The name of two barriers on one blackboard with different parties.
    #[error("another node gives the barrier {0} different parties")]
    Parties(String),
    /// A script that cannot be parsed, or that names too many entries.
    #[error("{attribute} is not a valid script: {error}")]
    Script {
        /// The name of the attribute with the script, such as `_skipIf`.
        attribute: String,
        /// What is wrong with the script. Places in it are counted in bytes from 0.
        error: ScriptError,
    },
    /// An entry that cannot have the type or the value that the file gives it.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// More of something than is accepted, so that no file takes long to check.
    #[error("there are more than {most} {what}")]
    TooMany {
        /// The thing that there is too much of, in the plural.
        what: &'static str,
        /// The largest number that a file may have.
        most: usize,
    },
    /// More than [`MOST_NODES`] nodes in one tree. Each use of a subtree counts. Otherwise a few subtrees that use each
    /// other twice would fill the memory.
    #[error("the tree has more than {MOST_NODES} nodes, subtrees included")]
    TooManyNodes,
    /// More than [`MOST_TEXT`] bytes of attributes in one tree. Each use of a subtree counts, since it is built each
    /// time.
    #[error("the attributes of the tree are longer than {MOST_TEXT} bytes, subtrees included")]
    TooMuchText,
    /// Deeper than [`DEEPEST`] levels. A tick descends by recursive calls, which must fit on a thread's stack.
    #[error("the tree is deeper than {DEEPEST} levels, subtrees included")]
    TooDeep,
}

/// The name in format 4 of a node or an attribute of format 3; `None` if no other name is known.
pub(crate) fn format_4_name(name: &str) -> Option<&'static str> {
    match name {
        "SubTreePlus" => Some("SubTree, with _autoremap where it has __autoremap"),
        "SequenceStar" => Some("SequenceWithMemory"),
        "RetryUntilSuccesful" => Some("RetryUntilSuccessful"),
        "BlackboardCheckBool" | "BlackboardCheckDouble" | "BlackboardCheckInt" | "BlackboardCheckString" => {
            Some("Precondition, or _skipIf and _while of the node itself")
        }
        "__autoremap" | "__shared_blackboard" => Some("_autoremap"),
        _ => None,
    }
}
