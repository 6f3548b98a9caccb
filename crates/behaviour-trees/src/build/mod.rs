//! Builds a tree that can be ticked from a document. Every name is looked up here. Every fault of a file is found
//! here or in `xml`. `scope` has the entries of subtrees, and `ports` has the bindings of ports.

mod ports;
mod scope;

use std::collections::BTreeSet;
use std::sync::Arc;

use self::scope::Scopes;
use super::blackboard::Blackboard;
use super::document::{Attribute, Document, Element, Form, Model, SourcePosition, TreeDefinition};
use super::error::{Reason, TreeError, format_4_name};
use super::findings::Findings;
use super::kind::{BuiltIn, Family};
use super::leaf::Catalogue;
use super::tree::{DEEPEST, Label, Live, MOST_NODES, MOST_TEXT, Node, NodeKind, Shape, Tree};
use crate::fnv1a;

/// Maximum number of nodes, and of bytes of attributes, when a file is checked. They are counted over all trees of
/// the file, each with its subtrees. Without this limit, two hundred trees could each use a subtree of the largest
/// size.
const MOST_TOGETHER: (usize, usize) = (20 * MOST_NODES, 4 * MOST_TEXT);

impl Tree {
    /// Builds a tree of a document on a blackboard. `main` is the ID of the tree; `None` means the main tree. Several
    /// trees can be built on one blackboard. If their main scopes have entries with the same name, the trees share
    /// these entries.
    ///
    /// # Errors
    /// The first fault of the file, with its place. Entries may already have been created on the blackboard.
    pub fn build(
        document: &Document,
        main: Option<&str>,
        catalogue: &Catalogue,
        blackboard: &mut Blackboard,
    ) -> Result<Tree, TreeError> {
        let tree = document.main_tree(main)?;
        let mut findings = Findings::default();
        document.whole(catalogue, &mut findings);
        let (built, _) = Tree::built(document, tree, catalogue, blackboard, &mut findings);
        findings.first()?;
        // The only notes of a build are about nodes that this engine cannot perform.
        findings.notes().first().map_or(Ok(built), |note| Err(note.clone()))
    }

    /// Builds a tree without its faulty parts. Also returns the number of nodes and of bytes of attributes that were
    /// checked.
    fn built(
        document: &Document,
        tree: &TreeDefinition,
        catalogue: &Catalogue,
        blackboard: &mut Blackboard,
        findings: &mut Findings,
    ) -> (Tree, (usize, usize)) {
        let scopes = Scopes::new(&tree.id, blackboard);
        let shape = Shape { leaf_kinds: catalogue.kinds().to_vec(), ..Shape::default() };
        let mut builder = Builder {
            document,
            catalogue,
            blackboard,
            findings,
            scopes,
            shape,
            paths: BTreeSet::new(),
            open: Vec::new(),
            depth: 0,
            nodes: 0,
            text: 0,
            fingerprint: 0,
        };
        if let Err(fault) = builder.tree(tree, 0, "") {
            builder.findings.fault(fault);
        }
        let live = vec![Live::default(); builder.shape.nodes.len()];
        let looked_at = (builder.nodes, builder.text);
        let fingerprint = builder.fingerprint;
        let built = Tree { id: Arc::from(tree.id.as_str()), shape: builder.shape, live, clock: 0, ticks: 0, fingerprint };
        (built, looked_at)
    }
}

impl Document {
    /// Returns the tree with this ID. Without an ID, returns the main tree that the document names, or its only tree.
    pub(crate) fn main_tree(&self, id: Option<&str>) -> Result<&TreeDefinition, TreeError> {
        let refuse = |reason| TreeError::at(SourcePosition { line: 1, column: 1 }, reason);
        match (id.or(self.main.as_deref()), &self.trees[..]) {
            (Some(id), _) => self.tree(id).ok_or_else(|| refuse(Reason::UnknownTree(id.to_owned()))),
            (None, [only]) => Ok(only),
            (None, []) => Err(refuse(Reason::NoTree)),
            (None, several) => {
                let ids: Vec<&str> = several.iter().map(|tree| tree.id.as_str()).collect();
                Err(refuse(Reason::NoMain(ids.join(", "))))
            }
        }
    }

    /// Checks that each tree has its own ID, that no ID is the name of a kind of node, and that no other file is
    /// needed.
    fn whole(&self, catalogue: &Catalogue, findings: &mut Findings) {
        for include in &self.includes {
            findings.fault(TreeError::at(include.place, Reason::Include));
        }
        for (number, tree) in self.trees.iter().enumerate() {
            let earlier = self.trees[..number].iter().find(|earlier| earlier.id == tree.id);
            let is_use = |tree: &TreeDefinition| Model::note(&tree.notes, "_fullpath").is_some();
            let is_twin = |earlier: &TreeDefinition| is_use(earlier) && is_use(tree) && is_same(&earlier.root, &tree.root);
            if earlier.is_some_and(|earlier| !is_twin(earlier)) {
                findings.fault(TreeError::at(tree.place, Reason::TwiceId(tree.id.clone())));
            }
            if BuiltIn::named(&tree.id).is_some() || catalogue.place(&tree.id).is_some() {
                findings.fault(TreeError::at(tree.place, Reason::TakenId(tree.id.clone())));
            }
        }
    }

    /// Checks all trees of the document as if they were built, including trees that the main tree does not use. For
    /// this check, a file of several trees needs no main tree.
    pub fn check(&self, catalogue: &Catalogue, findings: &mut Findings) {
        if self.main.is_some()
            && let Err(fault) = self.main_tree(None)
        {
            findings.fault(fault);
        }
        self.whole(catalogue, findings);
        self.names(findings);
        let (mut nodes, mut text) = (0, 0);
        for tree in &self.trees {
            let (_, looked_at) = Tree::built(self, tree, catalogue, &mut Blackboard::new(), findings);
            nodes += looked_at.0;
            text += looked_at.1;
            let (most_nodes, most_text) = MOST_TOGETHER;
            let too_many = match (nodes > most_nodes, text > most_text) {
                (true, _) => ("nodes in the trees up to this one, subtrees included", most_nodes),
                (_, true) => ("bytes of attributes in the trees up to this one, subtrees included", most_text),
                (false, false) => continue,
            };
            return findings.fault(TreeError::at(tree.place, Reason::TooMany { what: too_many.0, most: too_many.1 }));
        }
    }

    /// Notes the names of trees, nodes and ports that BehaviorTree.CPP 4.10 and later versions refuse.
    fn names(&self, findings: &mut Findings) {
        let ids = self.trees.iter().map(|tree| (tree.place, &tree.id, false));
        let models = self.models.iter().flat_map(|model| {
            let ports = model.ports.iter().map(|port| (port.place, &port.name, true));
            std::iter::once((model.place, &model.id, false)).chain(ports)
        });
        for (place, name, is_port) in ids.chain(models) {
            let is_bad = |letter: char| letter.is_ascii_control() || " <>&\"'/\\:*?|.".contains(letter);
            let why = match name.as_str() {
                "Root" | "root" if !is_port => "the name is reserved",
                "ID" | "name" if is_port => "the name is reserved",
                name if name.contains(is_bad) => "a name has no blanks and none of < > & \" ' / \\ : * ? | .",
                name if is_port && name.starts_with(|letter: char| letter.is_ascii_digit()) => {
                    "the name of a port begins with a letter"
                }
                _ => continue,
            };
            findings.note(TreeError::at(place, Reason::RefusedThere { name: name.clone(), why }));
        }
    }
}

/// Whether two trees with one ID are the same. BehaviorTree.CPP writes a tree once for each use, with the path of
/// each node, so such repeated trees are allowed.
fn is_same(one: &Element, other: &Element) -> bool {
    fn said(element: &Element) -> impl Iterator<Item = &Attribute> {
        element.attributes.iter().filter(|said| !matches!(said.name.as_str(), "_uid" | "_fullpath"))
    }
    let is_alike = (&one.id, one.form, &one.name) == (&other.id, other.form, &other.name) && said(one).eq(said(other));
    let children = one.children.iter().zip(&other.children);
    is_alike && one.children.len() == other.children.len() && children.into_iter().all(|(one, other)| is_same(one, other))
}

struct Builder<'a> {
    document: &'a Document,
    catalogue: &'a Catalogue,
    blackboard: &'a mut Blackboard,
    findings: &'a mut Findings,
    scopes: Scopes,
    shape: Shape,
    paths: BTreeSet<Arc<str>>,
    /// The IDs of the trees that contain the node being built, the outermost first.
    open: Vec<&'a str>,
    depth: usize,
    nodes: usize,
    text: usize,
    /// Hash of the elements of all nodes so far.
    fingerprint: u64,
}

enum FoundNode<'a> {
    Node(NodeKind),
    /// A control node or decorator that the file declares and that this engine does not perform.
    Declared(&'a Model),
}

/// Faults are added to the findings. An `Err` is a fault after which the tree cannot be checked any further.
impl<'a> Builder<'a> {
    fn tree(&mut self, tree: &'a TreeDefinition, scope: usize, prefix: &str) -> Result<(), TreeError> {
        self.open.push(&tree.id);
        self.node(&tree.root, scope, prefix)?;
        self.open.pop();
        Ok(())
    }

    fn node(&mut self, element: &'a Element, scope: usize, prefix: &str) -> Result<(), TreeError> {
        let refuse = |reason| Err(TreeError::at(element.place, reason));
        if self.depth >= DEEPEST {
            return refuse(Reason::TooDeep);
        }
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return refuse(Reason::TooManyNodes);
        }
        self.text += element.attributes.iter().map(|attribute| attribute.name.len() + attribute.value.len()).sum::<usize>();
        if self.text > MOST_TEXT {
            return refuse(Reason::TooMuchText);
        }
        let kind = match self.kind(element) {
            Ok(FoundNode::Node(kind)) => kind,
            Ok(FoundNode::Declared(model)) => {
                self.declared(element, model, scope);
                return self.children(element, scope, prefix);
            }
            Err(reason) => {
                self.findings.fault(TreeError::at(element.place, reason));
                return self.children(element, scope, prefix);
            }
        };
        let (family, children) = match kind {
            // The child of a `SubTree` belongs to another tree.
            NodeKind::BuiltIn(BuiltIn::SubTree) => (Family::Decorator, (0, 0)),
            NodeKind::BuiltIn(kind) => (kind.family(), kind.children()),
            NodeKind::Leaf(_) => (Family::Leaf, (0, 0)),
        };
        self.count_children(element, children);
        self.count_async(element, kind);
        self.note(element);
        let at = self.shape.nodes.len();
        let (path, name) = self.path(element, prefix, at + 1);
        let conditions = self.conditions(element, scope);
        let ports = to_u32(self.shape.bindings.len());
        let label = Label {
            name: Arc::from(name),
            path: path.clone(),
            id: Arc::from(if kind == NodeKind::BuiltIn(BuiltIn::SubTree) { "SubTree" } else { element.id.as_str() }),
            place: element.place,
            depth: u16::try_from(self.depth).unwrap_or(u16::MAX),
        };
        self.shape.nodes.push(Node { kind, family, end: 0, ports, port_count: 0, conditions });
        self.shape.labels.push(label);
        self.bind(element, kind, scope, to_u32(at));
        self.shape.nodes[at].port_count = u16::try_from(self.shape.bindings.len() - ports as usize).unwrap_or(u16::MAX);
        if kind == NodeKind::BuiltIn(BuiltIn::SubTree) {
            self.subtree(element, scope, &path)?;
        } else {
            self.children(element, scope, prefix)?;
        }
        self.shape.nodes[at].end = to_u32(self.shape.nodes.len());
        Ok(())
    }

    fn children(&mut self, element: &'a Element, scope: usize, prefix: &str) -> Result<(), TreeError> {
        self.depth += 1;
        for child in &element.children {
            self.node(child, scope, prefix)?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn subtree(&mut self, element: &'a Element, scope: usize, path: &str) -> Result<(), TreeError> {
        let document: &'a Document = self.document;
        let reason = match document.tree(&element.id) {
            None => Reason::UnknownTree(element.id.clone()),
            Some(tree) if self.open.contains(&tree.id.as_str()) => Reason::Recursive(tree.id.clone()),
            Some(tree) => {
                let (inner, given) = self.enter(element, scope, path);
                self.depth += 1;
                self.tree(tree, inner, &format!("{path}/"))?;
                self.depth -= 1;
                given.into_iter().for_each(|slot| self.blackboard.take_for_number(slot));
                return Ok(());
            }
        };
        self.findings.fault(TreeError::at(element.place, reason));
        Ok(())
    }

    /// Finds the kind of an element. The engine's nodes come first, then the leaves of the catalogue, then the nodes
    /// that a file declares.
    fn kind(&self, element: &Element) -> Result<FoundNode<'a>, Reason> {
        let id = &element.id;
        if id.is_empty() {
            return Err(Reason::NoId(element.form.word().to_owned()));
        }
        if element.form == Form::SubTree {
            return Ok(FoundNode::Node(NodeKind::BuiltIn(BuiltIn::SubTree)));
        }
        let (found, fits) = if let Some(kind) = BuiltIn::named(id) {
            let fits = match element.form {
                Form::Compact => true,
                Form::Control => kind.family() == Family::Control,
                Form::Decorator => kind.family() == Family::Decorator,
                Form::Action => kind.family() == Family::Leaf && kind != BuiltIn::ScriptCondition,
                Form::Condition => kind == BuiltIn::ScriptCondition,
                Form::SubTree => false,
            };
            (FoundNode::Node(NodeKind::BuiltIn(kind)), fits)
        } else if let Some(place) = self.catalogue.place(id) {
            let is_condition = self.catalogue.kinds()[place].is_condition;
            let form = if is_condition { Form::Condition } else { Form::Action };
            (FoundNode::Node(NodeKind::Leaf(place)), [Form::Compact, form].contains(&element.form))
        } else if let Some(model) = self.catalogue.declared(id).filter(|model| model.form != Form::SubTree) {
            (FoundNode::Declared(model), [Form::Compact, model.form].contains(&element.form))
        } else if let Some(now) = format_4_name(id) {
            return Err(Reason::Format3 { written: id.clone(), now });
        } else if element.children.is_empty() {
            return Err(Reason::UnknownNode(id.clone()));
        } else {
            return Err(Reason::UnknownParent(id.clone()));
        };
        if fits { Ok(found) } else { Err(Reason::WrongForm { id: id.clone(), written: element.form.word() }) }
    }

    /// Checks a declared node like any other node, although this engine does not perform it.
    fn declared(&mut self, element: &Element, model: &Model, scope: usize) {
        let most = if model.form == Form::Decorator { 1 } else { usize::MAX };
        self.count_children(element, (1, most));
        self.conditions(element, scope);
        self.bind_declared(element, model, scope);
        let reason = Reason::NotPerformed { id: model.id.clone(), form: model.form.word() };
        self.findings.note(TreeError::at(element.place, reason));
    }

    fn count_children(&mut self, element: &Element, (least, most): (usize, usize)) {
        let count = element.children.len();
        if (least..=most).contains(&count) {
            return;
        }
        let wanted = match (least, most) {
            (0, 0) => "none".to_owned(),
            (least, usize::MAX) => format!("{least} or more"),
            (least, most) if least == most => least.to_string(),
            (least, most) => format!("{least} to {most}"),
        };
        self.findings.fault(TreeError::at(element.place, Reason::Children { id: element.id.clone(), count, wanted }));
    }

    /// Refuses a second asynchronous child, as BehaviorTree.CPP does. In each tick, each of the two would cause a
    /// halt of the other.
    fn count_async(&mut self, element: &Element, kind: NodeKind) {
        let is_async = |child: &&Element| child.id == BuiltIn::AsyncSequence.word();
        if kind == NodeKind::BuiltIn(BuiltIn::ReactiveSequence) && element.children.iter().filter(is_async).count() > 1 {
            self.findings.fault(TreeError::at(element.place, Reason::TwoAsync));
        }
    }

    /// Adds an element to the fingerprint. A tree with one changed word therefore counts as another tree.
    fn note(&mut self, element: &Element) {
        let attributes = element.attributes.iter().map(|attribute| format!("{}={}", attribute.name, attribute.value));
        let words: Vec<String> = attributes.collect();
        let said = format!("{} {:?} {:?} {words:?} {}", self.depth, element.id, element.name, element.children.len());
        self.fingerprint = fnv1a(&format!("{:x}{said}", self.fingerprint));
    }

    /// Returns the path of a node, as in BehaviorTree.CPP, and its name. If another node has the same path, the UID
    /// is added.
    fn path<'e>(&mut self, element: &'e Element, prefix: &str, uid: usize) -> (Arc<str>, &'e str) {
        let name = element.name.as_deref().unwrap_or(&element.id);
        let named = format!("{prefix}{name}");
        let is_taken = name == element.id || self.paths.contains(named.as_str());
        let path: Arc<str> = if is_taken { Arc::from(format!("{named}::{uid}")) } else { Arc::from(named) };
        self.paths.insert(path.clone());
        (path, name)
    }
}

/// Cannot overflow, because `MOST_NODES` and the size of a file limit the numbers of nodes and ports.
fn to_u32(number: usize) -> u32 {
    u32::try_from(number).expect("a file is too short for so many")
}
