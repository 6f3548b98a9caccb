//! A file of trees as a value, element by element. `xml` reads and writes it, and `build` interprets it.

use std::fmt;

/// A place in a file. All places compare equal, so documents that differ only in layout are equal.
#[derive(Clone, Copy, Debug, Default, Eq)]
pub struct SourcePosition {
    /// The line, counted from 1; 0 for an element that comes from no file.
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

/// All trees of a file and its models of leaves, as written: no name has been looked up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The tree that runs unless the program names another: `main_tree_to_execute`.
    pub main: Option<String>,
    /// Further attributes that the graphical editor wrote at the top, such as `project_name`.
    pub notes: Vec<Attribute>,
    /// The trees in the order of the file, in which they are written again.
    pub trees: Vec<TreeDefinition>,
    /// The models of leaves and subtrees in `<TreeNodesModel>`.
    pub models: Vec<Model>,
    /// Other elements among the models, which are written again behind them.
    pub kept: Vec<Kept>,
    /// The `<include>` elements for other files. A document with such elements can be written again, but neither
    /// checked nor run.
    pub includes: Vec<Kept>,
}

/// An element without meaning here, such as `<MetadataFields>`. It is written again as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The name of its tag, which has no prefix.
    pub name: String,
    /// Its attributes in the order of the file.
    pub attributes: Vec<Attribute>,
    /// The text between the children, joined, and without blanks at both ends.
    pub text: String,
    /// The elements in this one, at most `tree::DEEPEST` levels of them.
    pub children: Vec<Kept>,
    /// Where its tag begins in the file, for error messages.
    pub place: SourcePosition,
}

/// One `<BehaviorTree>`: the main tree, a subtree of others, or one that nothing uses.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeDefinition {
    /// The `ID`, by which a `<SubTree>` uses the tree. If the file has none, `BehaviorTree_0` and so on.
    pub id: String,
    /// Further attributes that the editor wrote, such as `_description`.
    pub notes: Vec<Attribute>,
    /// The only child. A tree with more or fewer children is a fault, and gets a stand-in.
    pub root: Element,
    /// Where its tag begins in the file, for error messages.
    pub place: SourcePosition,
}

named! {
    /// How an element names its kind: by its own name, or as the `ID` of one of these elements.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Form {
        /// The element's own name is the kind: `<Sequence>`, `<NearObj>`.
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

/// A node of a tree: an element of the file, whose attributes nobody has interpreted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// The kind of the node, or the tree of a `<SubTree>`.
    pub id: String,
    /// The form in which the element was read and is written again.
    pub form: Form,
    /// The `name`; `None` if the node has the name of its kind.
    pub name: Option<String>,
    /// All other attributes: ports, conditions, notes of the editor.
    pub attributes: Vec<Attribute>,
    /// The children in the order of the file, in which their parent ticks them.
    pub children: Vec<Element>,
    /// Where its tag begins in the file, for error messages.
    pub place: SourcePosition,
}

/// An attribute of an element. Two attributes of the same name and value are equal, wherever they stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute {
    /// Its name, with the prefix of a namespace.
    pub name: String,
    /// Its value, with entities resolved.
    pub value: String,
    /// Where its name begins in the file, for error messages.
    pub place: SourcePosition,
}

/// A declaration of a leaf, a control node, a decorator or a subtree in `<TreeNodesModel>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Whether it is a leaf, a control node, a decorator or a subtree; never `Compact`.
    pub form: Form,
    /// The name by which elements use it.
    pub id: String,
    /// Further attributes that the editor wrote, such as `editable`.
    pub notes: Vec<Attribute>,
    /// The ports. A leaf counts its ports in this order.
    pub ports: Vec<ModelPort>,
    /// Other elements in the model, such as `<MetadataFields>`.
    pub kept: Vec<Kept>,
    /// Where its tag begins in the file, for error messages.
    pub place: SourcePosition,
}

/// A port that a model declares. `Port::of_model` reads its type and its default.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPort {
    /// `input_port`, `output_port` or `inout_port`.
    pub direction: super::leaf::Direction,
    /// The attribute by which an element sets it.
    pub name: String,
    /// `type`, `default` and further attributes.
    pub notes: Vec<Attribute>,
    /// Its text, which describes it.
    pub text: String,
    /// Where its tag begins in the file, for error messages.
    pub place: SourcePosition,
}

impl Element {
    /// A node of this kind, written `<id>`, without attributes.
    #[must_use]
    pub fn new(id: &str, children: Vec<Element>) -> Element {
        Element { id: id.to_owned(), children, ..Element::default() }
    }

    /// A `<SubTree>` that uses the tree of this ID, without ports.
    #[must_use]
    pub fn subtree(id: &str) -> Element {
        Element { form: Form::SubTree, ..Element::new(id, Vec::new()) }
    }

    /// Sets the `name`, which is a part of the node's path. `Mocks` may refer to the node by it.
    #[must_use]
    pub fn named(self, name: &str) -> Element {
        Element { name: Some(name.to_owned()), ..self }
    }

    /// Adds an attribute at the end, even if there is one of that name.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Element {
        self.attributes.push(Attribute::new(name, value));
        self
    }

    /// The first attribute of this name. `ID` and `name` are not attributes here, but fields.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }
}

impl Attribute {
    /// An attribute that comes from no file, so that its line is 0.
    #[must_use]
    pub fn new(name: &str, value: &str) -> Attribute {
        Attribute { name: name.to_owned(), value: value.to_owned(), place: SourcePosition::default() }
    }
}

impl Model {
    /// The value of the first note of this name, such as `default` among those of a port.
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

    /// Adds a tree at the end. Building a tree later checks that the ID is new.
    #[must_use]
    pub fn with_tree(mut self, id: &str, root: Element) -> Document {
        self.trees.push(TreeDefinition { id: id.to_owned(), notes: Vec::new(), root, place: SourcePosition::default() });
        self
    }

    /// The first tree of this ID, exactly as written.
    #[must_use]
    pub fn tree(&self, id: &str) -> Option<&TreeDefinition> {
        self.trees.iter().find(|tree| tree.id == id)
    }
}
