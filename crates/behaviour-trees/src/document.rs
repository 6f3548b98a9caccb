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

/// All trees of a file and its models of leaves, as written. No name has been looked up yet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The tree that runs unless the program names another tree (`main_tree_to_execute`).
    pub main: Option<String>,
    /// Further attributes that the graphical editor wrote at the top, such as `project_name`.
    pub notes: Vec<Attribute>,
    /// The trees in the order of the file. They are written in the same order.
    pub trees: Vec<TreeDefinition>,
    /// The models of leaves and subtrees in `<TreeNodesModel>`.
    pub models: Vec<Model>,
    /// Other elements among the models. They are written after the models.
    pub kept: Vec<Kept>,
    /// The `<include>` elements for other files. A document with such elements can be written again, but it can be
    /// neither checked nor run.
    pub includes: Vec<Kept>,
}

/// An element without a meaning for this crate, such as `<MetadataFields>`. It is written again as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The name of the element's tag, without a prefix.
    pub name: String,
    /// The attributes of the element, in the order of the file.
    pub attributes: Vec<Attribute>,
    /// The texts between the children, joined into one. Blanks at both ends are removed.
    pub text: String,
    /// The elements inside this one, with at most `tree::DEEPEST` levels.
    pub children: Vec<Kept>,
    /// Where the tag of the element begins in the file, for error messages.
    pub place: SourcePosition,
}

/// One `<BehaviorTree>`: the main tree, a subtree, or an unused tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeDefinition {
    /// The `ID` that a `<SubTree>` uses. If the file has none, it is `BehaviorTree_0` and so on.
    pub id: String,
    /// Further attributes that the editor wrote, such as `_description`.
    pub notes: Vec<Attribute>,
    /// The only child. If there are more or fewer children, this is a fault, and the tree gets a placeholder.
    pub root: Element,
    /// Where the tag of the element begins in the file, for error messages.
    pub place: SourcePosition,
}

named! {
    /// How an element names its kind: by its own name, or by an `ID` in one of these elements.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Form {
        /// The element's own name is the kind: `<Sequence>`, `<NearObj>`.
        #[default]
        Compact = "",
        /// The form `<Action ID="NearObj">`.
        Action = "Action",
        /// The form `<Condition ID="NearObj">`.
        Condition = "Condition",
        /// The form `<Control ID="Sequence">`.
        Control = "Control",
        /// The form `<Decorator ID="Inverter">`.
        Decorator = "Decorator",
        /// The form `<SubTree ID="Approach">`, with the ID of a tree.
        SubTree = "SubTree",
    }
}

/// A node of a tree: an element of the file with its attributes as written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// The kind of the node, or the tree of a `<SubTree>`.
    pub id: String,
    /// The form in which the element was read. It is written again in this form.
    pub form: Form,
    /// The attribute `name`; `None` if the node has the name of its kind.
    pub name: Option<String>,
    /// All other attributes: ports, conditions and notes of the editor.
    pub attributes: Vec<Attribute>,
    /// The children in the order of the file. Their parent ticks them in this order.
    pub children: Vec<Element>,
    /// Where the tag of the element begins in the file, for error messages.
    pub place: SourcePosition,
}

/// An attribute of an element. Two attributes with the same name and value are equal, even at different places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute {
    /// The name of the attribute, with the prefix of a namespace.
    pub name: String,
    /// The value of the attribute, with XML entities resolved.
    pub value: String,
    /// Where the name of the attribute begins in the file, for error messages.
    pub place: SourcePosition,
}

/// A declaration of a leaf, a control node, a decorator or a subtree in `<TreeNodesModel>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Whether the model is a leaf, a control node, a decorator or a subtree. It is never `Compact`.
    pub form: Form,
    /// The name by which elements use it.
    pub id: String,
    /// Further attributes that the editor wrote, such as `editable`.
    pub notes: Vec<Attribute>,
    /// The ports. A leaf counts its ports in this order.
    pub ports: Vec<ModelPort>,
    /// Other elements in the model, such as `<MetadataFields>`.
    pub kept: Vec<Kept>,
    /// Where the tag of the element begins in the file, for error messages.
    pub place: SourcePosition,
}

/// A port that a model declares. `Port::of_model` reads its type and its default.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPort {
    /// `input_port`, `output_port` or `inout_port`.
    pub direction: super::leaf::Direction,
    /// The attribute with which an element sets the port.
    pub name: String,
    /// The attributes `type` and `default`, and further attributes.
    pub notes: Vec<Attribute>,
    /// The text in the element, which describes the port.
    pub text: String,
    /// Where the tag of the element begins in the file, for error messages.
    pub place: SourcePosition,
}

impl Element {
    /// Creates a node of this kind, written `<id>`, without attributes.
    #[must_use]
    pub fn new(id: &str, children: Vec<Element>) -> Element {
        Element { id: id.to_owned(), children, ..Element::default() }
    }

    /// Creates a `<SubTree>` that uses the tree with this ID, without ports.
    #[must_use]
    pub fn subtree(id: &str) -> Element {
        Element { form: Form::SubTree, ..Element::new(id, Vec::new()) }
    }

    /// Sets the `name`, which is a part of the node's path. `Mocks` can find the node by this name.
    #[must_use]
    pub fn named(self, name: &str) -> Element {
        Element { name: Some(name.to_owned()), ..self }
    }

    /// Adds an attribute at the end, even if there is one with the same name.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Element {
        self.attributes.push(Attribute::new(name, value));
        self
    }

    /// The first attribute with this name. `ID` and `name` are fields here, and not attributes.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }
}

impl Attribute {
    /// Creates an attribute that comes from no file. Its line is therefore 0.
    #[must_use]
    pub fn new(name: &str, value: &str) -> Attribute {
        Attribute { name: name.to_owned(), value: value.to_owned(), place: SourcePosition::default() }
    }
}

impl Model {
    /// The value of the first note with this name, such as `default` for a port.
    #[must_use]
    pub fn note<'a>(notes: &'a [Attribute], name: &str) -> Option<&'a str> {
        notes.iter().find(|note| note.name == name).map(|note| note.value.as_str())
    }
}

impl Document {
    /// Creates a document with one tree, which is the main tree.
    #[must_use]
    pub fn of(id: &str, root: Element) -> Document {
        Document { main: Some(id.to_owned()), ..Document::default() }.with_tree(id, root)
    }

    /// Adds a tree at the end. A later build checks that its ID is new.
    #[must_use]
    pub fn with_tree(mut self, id: &str, root: Element) -> Document {
        self.trees.push(TreeDefinition { id: id.to_owned(), notes: Vec::new(), root, place: SourcePosition::default() });
        self
    }

    /// The first tree with this ID, exactly as written.
    #[must_use]
    pub fn tree(&self, id: &str) -> Option<&TreeDefinition> {
        self.trees.iter().find(|tree| tree.id == id)
    }
}
