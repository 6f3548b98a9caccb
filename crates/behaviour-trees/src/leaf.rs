//! Leaves: their names and ports, the catalogue of leaves that a tree may name, and the trait of their performer. The
//! performer defines what a leaf does.

use std::borrow::Cow;
use std::time::Duration;

use super::blackboard::{Blackboard, Slot, Unfit};
use super::document::{Document, Form, Model, ModelPort};
use super::kind::BuiltIn;
use super::status::Status;
use super::tree::{Label, NodeId};
use super::value::{Value, ValueType};
use crate::value::Cell;

named! {
    /// Whether a leaf reads a port, writes it, or both. The word is the name of the element that declares such a port
    /// in a model.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Direction {
        /// The leaf reads a literal or an entry.
        In = "input_port",
        /// The leaf writes an entry. A literal instead of an entry is a fault.
        Out = "output_port",
        /// The leaf reads a literal or an entry, and may write an entry. A value written to a literal is lost.
        InOut = "inout_port",
    }
}

/// A port of a leaf: an argument or a result. A file sets it with an attribute.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The attribute with which a file sets the port.
    pub name: Cow<'static, str>,
    /// Whether the port is read or written. Writing a port that is only read ends the tick with a fault.
    pub direction: Direction,
    /// The type of the port's values. Literals in a file must be of this type.
    pub ty: ValueType,
    /// The default: the value, as text, that the port has if a file does not set the port.
    pub default: Option<Cow<'static, str>>,
}

impl Port {
    /// A port that is read and has no default. A file need not set it.
    #[must_use]
    pub const fn input(name: &'static str, ty: ValueType) -> Port {
        Port { name: Cow::Borrowed(name), direction: Direction::In, ty, default: None }
    }

    /// A port that is written. If a file does not set the port, the written value is lost.
    #[must_use]
    pub const fn output(name: &'static str, ty: ValueType) -> Port {
        Port { name: Cow::Borrowed(name), direction: Direction::Out, ty, default: None }
    }

    /// A port as a file declares it. An empty default means that there is no default, as in BehaviorTree.CPP.
    #[must_use]
    pub fn of_model(port: &ModelPort) -> Port {
        let default = Model::note(&port.notes, "default").filter(|default| !default.is_empty());
        Port {
            name: Cow::Owned(port.name.clone()),
            direction: port.direction,
            ty: Model::note(&port.notes, "type").map_or(ValueType::Any, ValueType::of_model),
            default: default.map(|default| Cow::Owned(default.to_owned())),
        }
    }

    /// Sets the value, as text, that the port has if a file does not set it.
    #[must_use]
    pub fn or(self, default: &'static str) -> Port {
        Port { default: Some(Cow::Borrowed(default)), ..self }
    }
}

/// A kind of leaf. A tree may have many leaves of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafKind {
    /// The name of the leaf's element, or the `ID` in its `<Action>` or `<Condition>`.
    pub name: Cow<'static, str>,
    /// Whether the leaf is a query. A query changes nothing, is written as a `<Condition>`, and should return at
    /// once.
    pub is_condition: bool,
    /// The ports of the leaf. A leaf refers to a port by its index in this list.
    pub ports: Vec<Port>,
}

impl LeafKind {
    /// A leaf that does something and may take many ticks, written as an `<Action>`.
    #[must_use]
    pub const fn action(name: &'static str, ports: Vec<Port>) -> LeafKind {
        LeafKind { name: Cow::Borrowed(name), is_condition: false, ports }
    }

    /// A leaf that is a query, written as a `<Condition>`.
    #[must_use]
    pub const fn condition(name: &'static str, ports: Vec<Port>) -> LeafKind {
        LeafKind { name: Cow::Borrowed(name), is_condition: true, ports }
    }
}

/// The leaves that a tree may name. Their performer refers to a leaf by its index in this list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Catalogue {
    kinds: Vec<LeafKind>,
    /// Control nodes, decorators and subtrees that files declare. This engine performs none of them.
    declared: Vec<Model>,
}

impl Catalogue {
    /// A catalogue of these leaves. If two leaves have the same name, the first one counts.
    #[must_use]
    pub const fn new(kinds: Vec<LeafKind>) -> Catalogue {
        Catalogue { kinds, declared: Vec::new() }
    }

    /// All leaves, in the order of their indices.
    #[must_use]
    pub fn kinds(&self) -> &[LeafKind] {
        &self.kinds
    }

    /// The index of the leaf with this name. [`Leaf::kind`] returns the same index when such a leaf is performed.
    #[must_use]
    pub fn place(&self, name: &str) -> Option<usize> {
        self.kinds.iter().position(|kind| kind.name == name)
    }

    /// Adds the models in a file's `<TreeNodesModel>`, except models whose names are already in use. The file may be
    /// the file of the trees or another file.
    pub fn add_models(&mut self, document: &Document) {
        for model in document.models.iter().filter(|model| BuiltIn::named(&model.id).is_none()) {
            if matches!(model.form, Form::Action | Form::Condition) {
                let ports = model.ports.iter().map(Port::of_model).collect();
                let name = Cow::Owned(model.id.clone());
                self.add(LeafKind { name, is_condition: model.form == Form::Condition, ports });
            } else if self.place(&model.id).is_none() && self.declared(&model.id).is_none() {
                self.declared.push(model.clone());
            }
        }
    }

    /// The control node, decorator or subtree with this name that a file declares. It is checked but not performed.
    #[must_use]
    pub fn declared(&self, name: &str) -> Option<&Model> {
        self.declared.iter().find(|model| model.id == name)
    }

    /// Adds a leaf at the end of the list, unless its name is already in use.
    pub fn add(&mut self, kind: LeafKind) {
        if self.place(&kind.name).is_none() && self.declared(&kind.name).is_none() {
            self.kinds.push(kind);
        }
    }

    /// Adds a leaf. If the name exists, adds the missing ports to the existing leaf. This is for leaves that are
    /// known only from their use.
    pub(crate) fn add_or_widen(&mut self, kind: LeafKind) {
        let Some(place) = self.place(&kind.name) else { return self.kinds.push(kind) };
        let known = &mut self.kinds[place];
        for port in kind.ports {
            if !known.ports.iter().any(|other| other.name == port.name) {
                known.ports.push(port);
            }
        }
    }
}

/// Performs the leaves of a tree. It is called in the tick that reaches a leaf.
pub trait Leaves {
    /// Performs or continues a leaf, and returns RUNNING, SUCCESS, FAILURE or SKIPPED. SKIPPED does not change the
    /// state of the leaf: a running leaf still runs and may be halted. IDLE ends the tick with an error.
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status;

    /// Halts a running leaf. The leaf is then IDLE. This is called only for running leaves.
    fn halt(&mut self, leaf: &mut Leaf<'_>);
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Binding {
    /// The file does not set the port, and the port has no default.
    Unset,
    Literal(Value),
    Slot(Slot),
}

/// A leaf while it is performed, with its ports. A new `Leaf` is made for each call.
#[derive(Debug)]
pub struct Leaf<'a> {
    pub(crate) kind: usize,
    pub(crate) node: NodeId,
    pub(crate) label: &'a Label,
    pub(crate) ports: &'a [Port],
    pub(crate) bindings: &'a [Binding],
    pub(crate) blackboard: &'a mut Blackboard,
    pub(crate) is_starting: bool,
    pub(crate) elapsed: Duration,
    pub(crate) misuse: Option<Misuse>,
}

/// A port was used in a way that is not allowed. This ends the tick with a fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misuse {
    /// The kind of the leaf has no port with this index.
    #[error("it has no port number {0}")]
    NoPort(usize),
    /// The leaf writes a port with `Direction::In`. The text is the name of the port.
    #[error("it writes its port {0}, which is an input")]
    ReadOnly(String),
    /// The blackboard refuses the value, because the value has another type or is too long a text.
    #[error("it writes its port {port}: {unfit}")]
    Unfit {
        /// The attribute that names the entry in the file.
        port: String,
        /// The reason, with the entry and its type.
        unfit: Unfit,
    },
}

impl Leaf<'_> {
    /// The leaf's index in the catalogue with which the tree was built.
    #[must_use]
    pub const fn kind(&self) -> usize {
        self.kind
    }

    /// The leaf's node in the tree. It distinguishes two leaves of one kind.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// The leaf's name in the file (`name="…"`), or the name of its kind.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.label.name
    }

    /// The leaf's path in the tree, as the graphical editor shows it.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.label.path
    }

    /// The name of the leaf's kind. Several leaves of a tree may have the same kind.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.label.id
    }

    /// Whether the leaf begins, which means that it was not running before this tick.
    #[must_use]
    pub const fn is_starting(&self) -> bool {
        self.is_starting
    }

    /// How long the leaf has been running; zero when it starts. Time during which the tree is not ticked does not
    /// count.
    #[must_use]
    pub const fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// The value of a port. `port` is its index in the list of the leaf's kind. `None` if the file does not set the
    /// port, or if its entry has no value.
    #[must_use]
    pub fn read(&self, port: usize) -> Option<&Value> {
        match self.bindings.get(port)? {
            Binding::Unset => None,
            Binding::Literal(value) => Some(value),
            Binding::Slot(slot) => self.blackboard.value(*slot),
        }
    }

    /// The index of the port with this name. It is for performers without a fixed set of leaves, such as mocks.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<usize> {
        self.ports.iter().position(|port| port.name == name)
    }

    /// The value of a port, if it is a text. Other values are not converted.
    #[must_use]
    pub fn text(&self, port: usize) -> Option<&str> {
        self.read(port)?.as_text()
    }

    /// The value of a port as a whole number. A text is parsed. A number with a fraction gives `None`.
    #[must_use]
    pub fn int(&self, port: usize) -> Option<i64> {
        self.read(port)?.as_int()
    }

    /// The value of a port as a number. A text is parsed; `true` is 1.
    #[must_use]
    pub fn number(&self, port: usize) -> Option<f64> {
        self.read(port)?.as_number()
    }

    /// The value of a port as `true` or `false`; a number is true unless it is 0.
    #[must_use]
    pub fn truth(&self, port: usize) -> Option<bool> {
        self.read(port)?.as_bool()
    }

    /// The value of a port as a cell. A text such as `3;4` is parsed.
    #[must_use]
    pub fn cell(&self, port: usize) -> Option<Cell> {
        self.read(port)?.as_cell()
    }

    /// Writes an entry through a port. If the file does not set the port, nothing is written. If the value does not
    /// fit, the tick ends with an error.
    pub fn write(&mut self, port: usize, value: Value) {
        if let Err(misuse) = self.try_write(port, value) {
            self.misuse.get_or_insert(misuse);
        }
    }

    fn try_write(&mut self, port: usize, value: Value) -> Result<(), Misuse> {
        let (Some(spec), Some(binding)) = (self.ports.get(port), self.bindings.get(port)) else {
            return Err(Misuse::NoPort(port));
        };
        match (spec.direction, binding) {
            (Direction::In, _) => Err(Misuse::ReadOnly(spec.name.to_string())),
            (Direction::Out | Direction::InOut, Binding::Slot(slot)) => {
                let put = self.blackboard.put(*slot, value);
                put.map_err(|unfit| Misuse::Unfit { port: spec.name.to_string(), unfit })
            }
            (Direction::Out | Direction::InOut, Binding::Unset | Binding::Literal(_)) => Ok(()),
        }
    }
}
