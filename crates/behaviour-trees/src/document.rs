//! A file of trees as a value: what it says, element by element. How it is read and written stands in `xml`, what it means in
//! `build`.

use std::fmt;

/// Where something stands in a file. It takes no part in comparisons: a document that is laid out anew is the same document.
#[derive(Clone, Copy, Debug, Default, Eq)]
pub struct SourcePosition {
    /// The line, counted from 1; 0 for what comes from no file.
    pub line: u32,
    /// The column, counted in characters from 1.
    pub column: u32,
}

impl PartialEq for SourcePosition {
    fn eq(&self, _: &SourcePosition) -> bool {
        true
    }
}

impl fmt::Display for SourcePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// All trees of a file, and what it says of their leaves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The tree that runs unless another is named: `main_tree_to_execute`.
    pub main: Option<String>,
    /// What else the graphical editor noted at the top, as `project_name`.
    pub notes: Vec<Attribute>,
    /// The trees, in their order.
    pub trees: Vec<TreeDefinition>,
    /// What the file says of leaves and subtrees: `<TreeNodesModel>`.
    pub models: Vec<Model>,
    /// What stands between the models and is none.
    pub kept: Vec<Kept>,
    /// The other files that it wants to be read: `<include>`. Such a document is written again, and neither checked nor run.
    pub includes: Vec<Kept>,
}

/// An element that means nothing here and is written again as it was read, as `<MetadataFields>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Its name.
    pub name: String,
    /// Its attributes.
    pub attributes: Vec<Attribute>,
    /// What is written in it, between its children.
    pub text: String,
    /// The elements in it.
    pub children: Vec<Kept>,
    /// Where it stands.
    pub place: SourcePosition,
}

/// One `<BehaviorTree>`.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeDefinition {
    /// Its `ID`.
    pub id: String,
    /// What else the editor noted of it, as `_description`.
    pub notes: Vec<Attribute>,
    /// Its one child.
    pub root: Element,
    /// Where it stands.
    pub place: SourcePosition,
}

named! {
    /// How an element names its kind: by its own name, or by the `ID` of one of these.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Form {
        /// `<Sequence>`, `<NearObj>`.
        #[default]
        Compact = "",
        /// `<Action ID="NearObj">`.
        Action = "Action",
        /// `<Condition ID="NearObj">`.
        Condition = "Condition",
        /// `<Control ID="Sequence">`.
        Control = "Control",
        /// `<Decorator ID="Inverter">`.
        Decorator = "Decorator",
        /// `<SubTree ID="Approach">`; its ID is that of a tree.
        SubTree = "SubTree",
    }
}

/// A node of a tree, as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// The kind of node that it names, or the tree that a `<SubTree>` names.
    pub id: String,
    /// How it names it.
    pub form: Form,
    /// Its `name`, if it has one.
    pub name: Option<String>,
    /// Everything else: ports, conditions, notes of the editor.
    pub attributes: Vec<Attribute>,
    /// Its children, in their order.
    pub children: Vec<Element>,
    /// Where it stands.
    pub place: SourcePosition,
}

/// An attribute, as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute {
    /// Its name.
    pub name: String,
    /// Its value, entities resolved.
    pub value: String,
    /// Where it stands.
    pub place: SourcePosition,
}

/// What a file says of a leaf, a control node, a decorator or a subtree.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Which of them it is; never `Compact`.
    pub form: Form,
    /// Its name.
    pub id: String,
    /// What else the editor noted of it, as `editable`.
    pub notes: Vec<Attribute>,
    /// Its ports.
    pub ports: Vec<ModelPort>,
    /// What else stands in it, as `<MetadataFields>`.
    pub kept: Vec<Kept>,
    /// Where it stands.
    pub place: SourcePosition,
}

/// A port in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPort {
    /// `input_port`, `output_port` or `inout_port`.
    pub direction: super::leaf::Direction,
    /// Its name.
    pub name: String,
    /// `type`, `default` and what else is noted of it.
    pub notes: Vec<Attribute>,
    /// What is written in it: a description.
    pub text: String,
    /// Where it stands.
    pub place: SourcePosition,
}

impl Element {
    /// A node of this kind.
    #[must_use]
    pub fn new(id: &str, children: Vec<Element>) -> Element {
        Element { id: id.to_owned(), children, ..Element::default() }
    }

    /// A use of the tree of this ID.
    #[must_use]
    pub fn subtree(id: &str) -> Element {
        Element { form: Form::SubTree, ..Element::new(id, Vec::new()) }
    }

    /// With this name.
    #[must_use]
    pub fn named(self, name: &str) -> Element {
        Element { name: Some(name.to_owned()), ..self }
    }

    /// With one more attribute.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Element {
        self.attributes.push(Attribute::new(name, value));
        self
    }

    /// The value of an attribute.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }
}

impl Attribute {
    /// One that stands in no file.
    #[must_use]
    pub fn new(name: &str, value: &str) -> Attribute {
        Attribute { name: name.to_owned(), value: value.to_owned(), place: SourcePosition::default() }
    }
}

impl Model {
    /// The value of a note.
    #[must_use]
    pub fn note<'a>(notes: &'a [Attribute], name: &str) -> Option<&'a str> {
        notes.iter().find(|note| note.name == name).map(|note| note.value.as_str())
    }
}

impl Document {
    /// One tree, as its only and main one.
    #[must_use]
    pub fn of(id: &str, root: Element) -> Document {
        Document { main: Some(id.to_owned()), ..Document::default() }.with_tree(id, root)
    }

    /// With one more tree.
    #[must_use]
    pub fn with_tree(mut self, id: &str, root: Element) -> Document {
        self.trees.push(TreeDefinition { id: id.to_owned(), notes: Vec::new(), root, place: SourcePosition::default() });
        self
    }

    /// The tree of this ID.
    #[must_use]
    pub fn tree(&self, id: &str) -> Option<&TreeDefinition> {
        self.trees.iter().find(|tree| tree.id == id)
    }
}
