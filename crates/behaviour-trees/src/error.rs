//! Why a file of trees is refused, with the place in it. One sentence each: what is wrong, and with what.
//! What goes wrong while a tree runs is a `tick::Fault`.

use std::fmt;

use super::blackboard::Unfit;
use super::document::SourcePosition;
use super::script::ScriptError;
use super::tree::{DEEPEST, MOST_NODES, MOST_TEXT};
use super::value::ValueType;

/// A refusal: where, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeError {
    /// Where in the file.
    pub place: SourcePosition,
    /// Why.
    pub reason: Reason,
}

impl TreeError {
    pub(crate) const fn at(place: SourcePosition, reason: Reason) -> TreeError {
        TreeError { place, reason }
    }
}

impl fmt::Display for TreeError {
    /// `line:column: reason`; whoever knows the file puts its name in front.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.reason)
    }
}

impl std::error::Error for TreeError {}

/// Why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Reason {
    /// It is too long to be read.
    #[error("the file is {length} bytes long, and {most} is the most")]
    TooLong {
        /// How long it is, in bytes.
        length: usize,
        /// How long it may be.
        most: usize,
    },
    /// It is no XML.
    #[error("this is no XML: {0}")]
    NotXml(String),
    /// It is XML of something else.
    #[error("the file begins with <{0}>, and <root BTCPP_format=\"4\"> should be there")]
    NotTrees(String),
    /// It does not say of which version it is.
    #[error(
        "<root> has no BTCPP_format, as in files of format 3, and only format 4 is read here: write BTCPP_format=\"4\" if it is of \
         format 4, else convert it (convert_v3_to_v4.py of BehaviorTree.CPP does)"
    )]
    NoFormat,
    /// It is of another version.
    #[error("<root> says BTCPP_format=\"{0}\", and only version \"4\" is read here")]
    Format(String),
    /// An element where it does not belong.
    #[error("<{0}> does not belong here")]
    Misplaced(String),
    /// Names that belong to somebody else.
    #[error("xmlns is not read here: files of trees have no namespaces")]
    Namespace,
    /// Another file is to be read.
    #[error("<include> is not read here: put all trees into one file")]
    Include,
    /// There are two models.
    #[error("there is a second <TreeNodesModel>, and only one may be")]
    SecondModel,
    /// A port in a model without a name.
    #[error("<{0}> has no name")]
    NoName(String),
    /// Text between elements.
    #[error("there is text between the elements: {0:?}")]
    Text(String),
    /// An element without an ID.
    #[error("<{0}> has no ID")]
    NoId(String),
    /// An ID where the element itself is the name.
    #[error("<{0}> has an ID, which only <Action>, <Condition>, <Control>, <Decorator> and <SubTree> have")]
    NeedlessId(String),
    /// Two of one ID.
    #[error("the ID {0} is taken already")]
    TwiceId(String),
    /// A tree has the ID of a kind of node.
    #[error("the ID {0} is that of a kind of node")]
    TakenId(String),
    /// A tree without a root, or with several.
    #[error("the tree {id} has {count} nodes at its top, and must have one")]
    Roots {
        /// The tree.
        id: String,
        /// How many there are.
        count: usize,
    },
    /// There is no tree in it.
    #[error("there is no <BehaviorTree> in the file")]
    NoTree,
    /// There are several trees, and none is the main one.
    #[error("the file has several trees, and no main_tree_to_execute says which one runs: {0}")]
    NoMain(String),
    /// A tree is named that is not there.
    #[error("there is no tree {} in the file", .0.escape_debug())]
    UnknownTree(String),
    /// A tree uses itself.
    #[error("the tree {0} uses itself")]
    Recursive(String),
    /// A kind of node that nobody knows.
    #[error("the node {0} is not known")]
    UnknownNode(String),
    /// A node with children that nobody knows.
    #[error("the node {0} is not known, and has children: a <TreeNodesModel> must declare it as <Control> or <Decorator>")]
    UnknownParent(String),
    /// A name of the format before.
    #[error("{written} is of format 3: in format 4 it is {now}")]
    Format3 {
        /// The node or attribute.
        written: String,
        /// What it is called now.
        now: &'static str,
    },
    /// A node that a file declares and that nobody here can perform.
    #[error(
        "{id} is a <{form}> of the file's own: only those of BehaviorTree.CPP are performed, and a mock stands for a leaf alone, so a tree \
         with it can be checked but not run"
    )]
    NotPerformed {
        /// The node.
        id: String,
        /// `Control` or `Decorator`.
        form: &'static str,
    },
    /// A name that is taken here, and not by the newest version of BehaviorTree.CPP.
    #[error("BehaviorTree.CPP refuses the name {name:?} from version 4.10 on: {why}")]
    RefusedThere {
        /// The name.
        name: String,
        /// Why it does.
        why: &'static str,
    },
    /// An element that says the wrong thing of its node, as `<Condition ID="Sequence">`.
    #[error("{id} is written as <{written}>, and it is of another sort")]
    WrongForm {
        /// The node.
        id: String,
        /// How it is written.
        written: &'static str,
    },
    /// The wrong number of children.
    #[error("{id} has {count} children, and must have {wanted}")]
    Children {
        /// The node.
        id: String,
        /// How many it has.
        count: usize,
        /// How many it must have, in words.
        wanted: String,
    },
    /// Children that would never let each other be done.
    #[error("ReactiveSequence has more than one AsyncSequence as a child")]
    TwoAsync,
    /// A port that its node has not.
    #[error("{id} has no port {port}")]
    UnknownPort {
        /// The node.
        id: String,
        /// The attribute.
        port: String,
    },
    /// An attribute that looks like a condition and is none.
    #[error("there is no condition or setting {written}: {meant} is meant")]
    Misspelt {
        /// The attribute.
        written: String,
        /// What it looks like.
        meant: &'static str,
    },
    /// A port that must be set.
    #[error("{id} needs its port {port}")]
    MissingPort {
        /// The node.
        id: String,
        /// The port.
        port: String,
    },
    /// A literal of the wrong type.
    #[error("the port {port} is of type {}, and \"{value}\" is none", ty.word())]
    Literal {
        /// The port.
        port: String,
        /// What it should be.
        ty: ValueType,
        /// What is written.
        value: String,
    },
    /// A literal where an entry is written.
    #[error("the port {0} is written by its node, so it must name an entry: {{name}}")]
    LiteralOutput(String),
    /// An entry where a literal must stand.
    #[error("the port {0} is looked at when the tree is built, so it cannot be an entry")]
    EntryForLiteral(String),
    /// A word that is none of those that may stand there.
    #[error("the port {port} is {value:?}, and must be {wanted}")]
    Word {
        /// The port.
        port: String,
        /// What is written.
        value: String,
        /// What may be, in words.
        wanted: &'static str,
    },
    /// Two barriers of one name with different parties.
    #[error("the barrier {0} has other parties elsewhere")]
    Parties(String),
    /// No script.
    #[error("{attribute} is no script: {error}")]
    Script {
        /// Where it is written.
        attribute: String,
        /// Why.
        error: ScriptError,
    },
    /// An entry cannot be as it should.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// Too many of something in a file.
    #[error("there are more than {most} {what}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there may be.
        most: usize,
    },
    /// Too many nodes.
    #[error("the tree has more than {MOST_NODES} nodes, those of its subtrees counted")]
    TooManyNodes,
    /// Too much is written in it.
    #[error("the attributes of the tree are longer than {MOST_TEXT} bytes, those of its subtrees counted")]
    TooMuchText,
    /// Too deep.
    #[error("the tree is deeper than {DEEPEST} levels, those of its subtrees counted")]
    TooDeep,
}

/// What a name of format 3 is called in format 4.
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
