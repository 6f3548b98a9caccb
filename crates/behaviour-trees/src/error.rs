//! Why a file of trees is refused, with the place in it, in one sentence each. Errors while a tree runs are a
//! `tick::Fault`.

use std::fmt;

use super::blackboard::Unfit;
use super::document::SourcePosition;
use super::script::ScriptError;
use super::tree::{DEEPEST, MOST_NODES, MOST_TEXT};
use super::value::ValueType;

/// A fault of a file, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeError {
    /// Its place in the file.
    pub place: SourcePosition,
    /// What is wrong.
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

/// Why a file is refused, or what is noted about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Reason {
    /// The file is too long.
    #[error("the file is {length} bytes long, and {most} is the most")]
    TooLong {
        /// Its length in bytes.
        length: usize,
        /// The limit in bytes.
        most: usize,
    },
    /// The file is not XML.
    #[error("this is no XML: {0}")]
    NotXml(String),
    /// The file is XML with another root.
    #[error("the file begins with <{0}>, and <root BTCPP_format=\"4\"> should be there")]
    NotTrees(String),
    /// The file has no version.
    #[error(
        "<root> has no BTCPP_format, as in files of format 3, and only format 4 is read here: write BTCPP_format=\"4\" if it is of \
         format 4, else convert it (convert_v3_to_v4.py of BehaviorTree.CPP does)"
    )]
    NoFormat,
    /// The file has another version.
    #[error("<root> says BTCPP_format=\"{0}\", and only version \"4\" is read here")]
    Format(String),
    /// An element in a place where it is not allowed.
    #[error("<{0}> does not belong here")]
    Misplaced(String),
    /// An XML namespace.
    #[error("xmlns is not read here: files of trees have no namespaces")]
    Namespace,
    /// An `<include>` of another file.
    #[error("<include> is not read here: put all trees into one file")]
    Include,
    /// A second `<TreeNodesModel>`.
    #[error("there is a second <TreeNodesModel>, and only one may be")]
    SecondModel,
    /// A port without a name in a model.
    #[error("<{0}> has no name")]
    NoName(String),
    /// Text between elements.
    #[error("there is text between the elements: {0:?}")]
    Text(String),
    /// An element without its ID.
    #[error("<{0}> has no ID")]
    NoId(String),
    /// An ID at an element whose own name is the kind.
    #[error("<{0}> has an ID, which only <Action>, <Condition>, <Control>, <Decorator> and <SubTree> have")]
    NeedlessId(String),
    /// An ID that is used twice.
    #[error("the ID {0} is taken already")]
    TwiceId(String),
    /// A tree with the ID of a kind of node.
    #[error("the ID {0} is that of a kind of node")]
    TakenId(String),
    /// A tree without a root, or with several.
    #[error("the tree {id} has {count} nodes at its top, and must have one")]
    Roots {
        /// The tree's ID.
        id: String,
        /// Number of its roots.
        count: usize,
    },
    /// A file without trees.
    #[error("there is no <BehaviorTree> in the file")]
    NoTree,
    /// Several trees, none of which is the main one.
    #[error("the file has several trees, and no main_tree_to_execute says which one runs: {0}")]
    NoMain(String),
    /// A tree that does not exist.
    #[error("there is no tree {} in the file", .0.escape_debug())]
    UnknownTree(String),
    /// A tree that uses itself.
    #[error("the tree {0} uses itself")]
    Recursive(String),
    /// An unknown kind of node.
    #[error("the node {0} is not known")]
    UnknownNode(String),
    /// An unknown kind of node, with children.
    #[error("the node {0} is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>")]
    UnknownParent(String),
    /// A name of format 3.
    #[error("{written} is of format 3: in format 4 it is {now}")]
    Format3 {
        /// The node or attribute.
        written: String,
        /// Its name in format 4.
        now: &'static str,
    },
    /// A declared control node or decorator, which nobody here can perform.
    #[error(
        "{id} is a <{form}> of the file's own: only those of BehaviorTree.CPP are performed, and a mock stands for a leaf alone, so a tree \
         with it can be checked but not run"
    )]
    NotPerformed {
        /// The kind of node.
        id: String,
        /// `Control` or `Decorator`.
        form: &'static str,
    },
    /// A name that is accepted here, but not by the newest version of BehaviorTree.CPP.
    #[error("BehaviorTree.CPP refuses the name {name:?} from version 4.10 on: {why}")]
    RefusedThere {
        /// The name.
        name: String,
        /// Why it is refused there.
        why: &'static str,
    },
    /// An element of the wrong form for its node, such as `<Condition ID="Sequence">`.
    #[error("{id} is written as <{written}>, and it is of another sort")]
    WrongForm {
        /// The kind of node.
        id: String,
        /// The element that it is written as.
        written: &'static str,
    },
    /// The wrong number of children.
    #[error("{id} has {count} children, and must have {wanted}")]
    Children {
        /// The kind of node.
        id: String,
        /// Number of its children.
        count: usize,
        /// The allowed number, in words.
        wanted: String,
    },
    /// Two asynchronous children, each of which would have the other halted.
    #[error("ReactiveSequence has more than one AsyncSequence as a child")]
    TwoAsync,
    /// A port that this kind of node does not have.
    #[error("{id} has no port {port}")]
    UnknownPort {
        /// The kind of node.
        id: String,
        /// The attribute.
        port: String,
    },
    /// An attribute that resembles a condition and is none.
    #[error("there is no condition or setting {written}: {meant} is meant")]
    Misspelt {
        /// The attribute.
        written: String,
        /// The condition that it resembles.
        meant: &'static str,
    },
    /// A mandatory port that is not set.
    #[error("{id} needs its port {port}")]
    MissingPort {
        /// The kind of node.
        id: String,
        /// The port.
        port: String,
    },
    /// A literal of the wrong type.
    #[error("the port {port} is of type {}, and \"{value}\" is none", ty.word())]
    Literal {
        /// The port.
        port: String,
        /// The type of the port.
        ty: ValueType,
        /// The literal.
        value: String,
    },
    /// A literal at a port that writes to an entry.
    #[error("the port {0} is written by its node, so it must name an entry: {{name}}")]
    LiteralOutput(String),
    /// An entry where a literal is required.
    #[error("the port {0} is looked at when the tree is built, so it cannot be an entry")]
    EntryForLiteral(String),
    /// A word that is not among those allowed.
    #[error("the port {port} is {value:?}, and must be {wanted}")]
    Word {
        /// The port.
        port: String,
        /// The word.
        value: String,
        /// The allowed words.
        wanted: &'static str,
    },
    /// Two barriers of one name with different parties.
    #[error("the barrier {0} has other parties elsewhere")]
    Parties(String),
    /// An invalid script.
    #[error("{attribute} is no script: {error}")]
    Script {
        /// The attribute that holds it.
        attribute: String,
        /// What is wrong with it.
        error: ScriptError,
    },
    /// An entry whose type or value does not fit.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// Too many of something in a file.
    #[error("there are more than {most} {what}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// Too many nodes in one tree.
    #[error("the tree has more than {MOST_NODES} nodes, those of its subtrees counted")]
    TooManyNodes,
    /// Too many bytes of attributes in one tree.
    #[error("the attributes of the tree are longer than {MOST_TEXT} bytes, those of its subtrees counted")]
    TooMuchText,
    /// A tree that is too deep.
    #[error("the tree is deeper than {DEEPEST} levels, those of its subtrees counted")]
    TooDeep,
}

/// The name in format 4 of something in format 3.
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
