//! The reasons why a file of trees is refused, each with the place in the file and one sentence. `tick::Fault` is an
//! error while a tree runs.

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
    /// Writes `line:column: reason`. A caller that knows the file puts the name of the file in front.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.reason)
    }
}

impl std::error::Error for TreeError {}

/// Why a file is refused, or what is noted about the file. Each reason has a sentence for the author of the file.
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
    /// The file is not XML. The text is the message of the XML parser, without the place.
    #[error("this is not XML: {0}")]
    NotXml(String),
    /// The file is XML, but not a file of trees. The text is the name of its root element.
    #[error("the file begins with <{0}> instead of <root BTCPP_format=\"4\">")]
    NotTrees(String),
    /// The file has no version. Files of format 3 have none, so format 4 is not assumed.
    #[error(
        "<root> has no BTCPP_format: write BTCPP_format=\"4\" if the file is of format 4, else convert it with \
         convert_v3_to_v4.py of BehaviorTree.CPP"
    )]
    NoFormat,
    /// The value of `BTCPP_format` is not 4. The text is this value.
    #[error("<root> says BTCPP_format=\"{0}\", but only format \"4\" is supported")]
    Format(String),
    /// An element is not allowed in its place, or is of another namespace. The text is the name of the element.
    #[error("<{0}> is not allowed here")]
    Misplaced(String),
    /// The file uses an XML namespace. Only prefixes that the root declares are allowed, as in a file with a schema.
    #[error("xmlns is not supported: files of trees have no namespaces")]
    Namespace,
    /// The file has an `<include>`. This crate opens no files.
    #[error("<include> is not supported: put all trees into one file")]
    Include,
    /// There is a second `<TreeNodesModel>`. Faults in it are reported as well.
    #[error("there is a second <TreeNodesModel>, but only one is allowed")]
    SecondModel,
    /// A port in a model has no name. The text is the name of the element, such as `input_port`.
    #[error("<{0}> has no name")]
    NoName(String),
    /// There is a text between elements. The value is its first 40 characters.
    #[error("there is text between the elements: {0:?}")]
    Text(String),
    /// The `ID` of an element is missing or empty. The text is the name of the element.
    #[error("<{0}> has no ID")]
    NoId(String),
    /// An element has an ID, although its own name is already its kind, such as `<Sequence>`. The text is the name of
    /// the element.
    #[error("<{0}> has an ID, which only <Action>, <Condition>, <Control>, <Decorator> and <SubTree> have")]
    NeedlessId(String),
    /// Two models, or two different trees, have this ID. Equal trees are allowed, because BehaviorTree.CPP writes a
    /// tree once for each use.
    #[error("the ID {0} is already in use")]
    TwiceId(String),
    /// A tree has this ID, which is also the name of a built-in node or of a leaf in the catalogue.
    #[error("the ID {0} is the name of a kind of node")]
    TakenId(String),
    /// A tree has no root, or several roots. Comments do not count.
    #[error("the tree {id} has {count} root nodes, but must have one")]
    Roots {
        /// The tree's ID; `BehaviorTree_0` and so on for a tree without one.
        id: String,
        /// Number of elements in the `<BehaviorTree>`.
        count: usize,
    },
    /// The file has no trees. A file with only models can be read, but not run.
    #[error("there is no <BehaviorTree> in the file")]
    NoTree,
    /// The file has several trees with these IDs, but does not name the main tree.
    #[error("the file has several trees, but no main_tree_to_execute: {0}")]
    NoMain(String),
    /// A `<SubTree>`, the file or the program asks for a tree with this ID, but there is no such tree.
    #[error("there is no tree {} in the file", .0.escape_debug())]
    UnknownTree(String),
    /// A tree uses itself, directly or through other trees.
    #[error("the tree {0} uses itself")]
    Recursive(String),
    /// An element without children is neither a built-in node nor in the catalogue. The text is its name.
    #[error("the node {0} is not known")]
    UnknownNode(String),
    /// An element with children is not a built-in node. It cannot be a leaf, because it has children. The text is its
    /// name.
    #[error("the node {0} is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>")]
    UnknownParent(String),
    /// A node or an attribute of format 3 has another name in format 4.
    #[error("{written} is of format 3: in format 4 it is {now}")]
    Format3 {
        /// The name in the file, such as `SequenceStar`.
        written: String,
        /// What to write in format 4, such as `SequenceWithMemory`.
        now: &'static str,
    },
    /// The file declares a control node or a decorator, which this engine cannot perform.
    #[error(
        "{id} is a <{form}> that the file declares: a tree with {id} can be checked but not run, since a mock replaces only \
         a leaf"
    )]
    NotPerformed {
        /// The name of the node in its model.
        id: String,
        /// `Control` or `Decorator`.
        form: &'static str,
    },
    /// A name is accepted here, but the newest version of BehaviorTree.CPP refuses it.
    #[error("BehaviorTree.CPP refuses the name {name:?} from version 4.10 on: {why}")]
    RefusedThere {
        /// The name of a tree, a model or a port.
        name: String,
        /// Why the name is refused, as the end of a sentence.
        why: &'static str,
    },
    /// An element has the wrong form for its node, such as `<Condition ID="Sequence">`.
    #[error("{id} is written as <{written}>, but is a node of another kind")]
    WrongForm {
        /// The kind that its `ID` names, such as `Sequence`.
        id: String,
        /// The element in the file, such as `Condition`.
        written: &'static str,
    },
    /// A node has more or fewer children than its kind allows. Comments do not count.
    #[error("{id} has {count} children, and must have {wanted}")]
    Children {
        /// The kind of the parent, such as `Inverter`.
        id: String,
        /// The number of children; a subtree counts as one.
        count: usize,
        /// The allowed number in words, such as `2 to 3`.
        wanted: String,
    },
    /// A node has two asynchronous children. Each of them would cause a halt of the other.
    #[error("ReactiveSequence has more than one AsyncSequence as a child")]
    TwoAsync,
    /// An attribute is not a port of this kind of node. Attributes that begin with `_` are never ports.
    #[error("{id} has no port {port}")]
    UnknownPort {
        /// The kind of the node, such as `Repeat`.
        id: String,
        /// The name of the attribute, such as a misspelt `num_cycle`.
        port: String,
    },
    /// An attribute looks like a misspelt condition or `_autoremap`. Ignoring it would be dangerous.
    #[error("{written} is no condition or setting: write {meant}")]
    Misspelt {
        /// The name of the attribute, with its wrong capitals or underscores.
        written: String,
        /// The condition that it resembles, or `_autoremap`.
        meant: &'static str,
    },
    /// A port that needs a value is not set and has no default. It is a port of a node, or of the model of a subtree.
    #[error("{id} needs its port {port}")]
    MissingPort {
        /// The kind of the node, or the ID of the subtree.
        id: String,
        /// The attribute to add, such as `num_cycles`.
        port: String,
    },
    /// A literal, or an element of a queue, cannot be read as the required type.
    #[error("the port {port} needs a value of type {}, but has \"{value}\"", ty.word())]
    Literal {
        /// The attribute with the literal, such as `num_cycles`.
        port: String,
        /// The type of the port, or of the elements of its queue.
        ty: ValueType,
        /// The literal, or the wrong element of the queue.
        value: String,
    },
    /// A port that writes an entry has a literal. The text is the name of the port.
    #[error("the port {0} is an output, so its value must name an entry: {{name}}")]
    LiteralOutput(String),
    /// A port names an entry, but the value of the port is needed when the tree is built. The text is the name of the
    /// port.
    #[error("the port {0} is read when the tree is built, so its value cannot be an entry")]
    EntryForLiteral(String),
    /// A port does not allow this value, although its type is right. An example is a negative time.
    #[error("the port {port} is {value:?}, and must be {wanted}")]
    Word {
        /// The attribute with the value, such as `msec`.
        port: String,
        /// The value as it is written, such as `-1`.
        value: String,
        /// The allowed values of the port, in words.
        wanted: &'static str,
    },
    /// Two barriers on one blackboard have this name but different parties.
    #[error("another node gives the barrier {0} different parties")]
    Parties(String),
    /// A script cannot be parsed, or names too many entries.
    #[error("{attribute} is not a valid script: {error}")]
    Script {
        /// The name of the attribute with the script, such as `_skipIf`.
        attribute: String,
        /// What is wrong with the script. Places in it are counted in bytes from 0.
        error: ScriptError,
    },
    /// An entry cannot have the type or the value that the file gives it.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// The file exceeds one of the limits that ensure that every file is checked quickly.
    #[error("there are more than {most} {what}")]
    TooMany {
        /// What the file has too much of, in the plural form, such as `trees in one file`.
        what: &'static str,
        /// The maximum number that a file may have.
        most: usize,
    },
    /// One tree has more than [`MOST_NODES`] nodes. Each use of a subtree counts. Otherwise a few subtrees that use
    /// each other twice would fill the memory.
    #[error("the tree has more than {MOST_NODES} nodes, subtrees included")]
    TooManyNodes,
    /// One tree has more than [`MOST_TEXT`] bytes of attributes. Each use of a subtree counts, because it is built
    /// each time.
    #[error("the attributes of the tree are longer than {MOST_TEXT} bytes, subtrees included")]
    TooMuchText,
    /// The tree is deeper than [`DEEPEST`] levels. A tick uses recursive calls, which must fit on a thread's stack.
    #[error("the tree is deeper than {DEEPEST} levels, subtrees included")]
    TooDeep,
}

/// Returns the name in format 4 of a node or an attribute of format 3; `None` if no other name is known.
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
