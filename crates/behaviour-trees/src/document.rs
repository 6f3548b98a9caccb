//! A file of trees as a value, element by element. How it is read and written stands in `xml`, what it means in
//! `build`.

use std::fmt;

/// A place in a file. All places compare equal, so that a document with another layout is the same document.
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

/// All trees of a file, and its models of leaves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The tree that runs unless another is named: `main_tree_to_execute`.
    pub main: Option<String>,
    /// Further attributes that the graphical editor wrote at the top, such as `project_name`.
    pub notes: Vec<Attribute>,
    /// The trees, in their order.
    pub trees: Vec<TreeDefinition>,
    /// The models of leaves and subtrees in `<TreeNodesModel>`.
    pub models: Vec<Model>,
    /// Other elements between the models.
    pub kept: Vec<Kept>,
    /// The `<include>` elements for other files. A document with any is written again, but neither checked nor run.
    pub includes: Vec<Kept>,
}

/// An element without meaning here, which is written again as it was read, such as `<MetadataFields>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Its name.
    pub name: String,
    /// Its attributes.
    pub attributes: Vec<Attribute>,
    /// The text in it, between its children.
    pub text: String,
    /// The elements in it.
    pub children: Vec<Kept>,
    /// Its place in the file.
    pub place: SourcePosition,
}

/// One `<BehaviorTree>`.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeDefinition {
    /// Its `ID`.
    pub id: String,
    /// Further attributes that the editor wrote, such as `_description`.
    pub notes: Vec<Attribute>,
    /// Its only child.
    pub root: Element,
    /// Its place in the file.
    pub place: SourcePosition,
}

named! {
    /// How an element names its kind: by its own name, or by the `ID` of one of these elements.
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
        /// `<SubTree ID="Approach">`, whose ID is that of a tree.
        SubTree = "SubTree",
    }
}

/// A node of a tree, as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// The kind of the node, or the tree of a `<SubTree>`.
    pub id: String,
    /// How it is written.
    pub form: Form,
    /// Its `name`, if it has one.
    pub name: Option<String>,
    /// All other attributes: ports, conditions, notes of the editor.
    pub attributes: Vec<Attribute>,
    /// Its children, in their order.
    pub children: Vec<Element>,
    /// Its place in the file.
    pub place: SourcePosition,
}

/// An attribute, as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute {
    /// Its name.
    pub name: String,
    /// Its value, with entities resolved.
    pub value: String,
    /// Its place in the file.
    pub place: SourcePosition,
}

/// A declaration of a leaf, a control node, a decorator or a subtree.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Which of them it is; never `Compact`.
    pub form: Form,
    /// Its name.
    pub id: String,
    /// Further attributes that the editor wrote, such as `editable`.
    pub notes: Vec<Attribute>,
    /// Its ports.
    pub ports: Vec<ModelPort>,
    /// Other elements in it, such as `<MetadataFields>`.
    pub kept: Vec<Kept>,
    /// Its place in the file.
    pub place: SourcePosition,
}

/// A port in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPort {
    /// `input_port`, `output_port` or `inout_port`.
    pub direction: super::leaf::Direction,
    /// Its name.
    pub name: String,
    /// `type`, `default` and further attributes.
    pub notes: Vec<Attribute>,
    /// Its text, which describes it.
    pub text: String,
    /// Its place in the file.
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

    /// Sets its `name`.
    #[must_use]
    pub fn named(self, name: &str) -> Element {
        Element { name: Some(name.to_owned()), ..self }
    }

    /// Adds an attribute.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Element {
        self.attributes.push(Attribute::new(name, value));
        self
    }

    /// The attribute of this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }
}

impl Attribute {
    /// An attribute that comes from no file.
    #[must_use]
    pub fn new(name: &str, value: &str) -> Attribute {
        Attribute { name: name.to_owned(), value: value.to_owned(), place: SourcePosition::default() }
    }
}

impl Model {
    /// The value of the note of this name.
    #[must_use]
    pub fn note<'a>(notes: &'a [Attribute], name: &str) -> Option<&'a str> {
        notes.iter().find(|note| note.name == name).map(|note| note.value.as_str())
    }
}

impl Document {
    /// A document with one tree, which is the main one.
    #[must_use]
    pub fn of(id: &str, root: Element) -> Document {
        Document { main: Some(id.to_owned()), ..Document::default() }.with_tree(id, root)
    }

    /// Adds a tree.
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
