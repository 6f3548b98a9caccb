//! From a document to a tree that can be ticked: every name is looked up here, and everything that is wrong in a file is refused here
//! or in `xml`. Where entries of subtrees are stands in `scope`, what is bound to ports in `ports`.

mod ports;
mod scope;

use std::collections::BTreeSet;
use std::sync::Arc;

use self::scope::Scopes;
use super::blackboard::Blackboard;
use super::document::{Document, Element, Form, Place, TreeDefinition};
use super::error::{Reason, TreeError};
use super::kind::{BuiltIn, Family};
use super::leaf::Catalogue;
use super::tree::{DEEPEST, Kind, Label, Live, MOST_NODES, MOST_TEXT, Node, Shape, Tree};
use crate::rng::fnv1a;

/// The most nodes and the most bytes of attributes of all trees of a file together, each with its subtrees, when the file is checked:
/// two hundred trees may use one that is as large as a tree may be.
const MOST_TOGETHER: (usize, usize) = (20 * MOST_NODES, 4 * MOST_TEXT);

impl Tree {
    /// A tree of a document, its main one unless another is named, on a blackboard. Several trees can be built on one blackboard; in
    /// the scope of their main trees entries of one name are one entry.
    ///
    /// # Errors
    /// The first thing in the file that is wrong, with its place. The blackboard may have got entries by then.
    pub fn build(
        document: &Document,
        main: Option<&str>,
        catalogue: &Catalogue,
        blackboard: &mut Blackboard,
    ) -> Result<Tree, TreeError> {
        Tree::built(document, main, catalogue, blackboard).map(|(tree, _)| tree)
    }

    /// The same, and how many bytes of attributes there are in it.
    fn built(
        document: &Document,
        main: Option<&str>,
        catalogue: &Catalogue,
        blackboard: &mut Blackboard,
    ) -> Result<(Tree, usize), TreeError> {
        let tree = document.main_tree(main)?;
        document.distinct(catalogue)?;
        let scopes = Scopes::new(&tree.id, blackboard);
        let shape = Shape { leaf_kinds: catalogue.kinds().to_vec(), ..Shape::default() };
        let mut builder = Builder {
            document,
            catalogue,
            blackboard,
            scopes,
            shape,
            paths: BTreeSet::new(),
            open: Vec::new(),
            depth: 0,
            text: 0,
            fingerprint: 0,
        };
        builder.tree(tree, 0, "")?;
        let live = vec![Live::default(); builder.shape.nodes.len()];
        let fingerprint = builder.fingerprint;
        let built = Tree { id: Arc::from(tree.id.as_str()), shape: builder.shape, live, clock: 0, ticks: 0, fingerprint };
        Ok((built, builder.text))
    }
}

impl Document {
    /// The tree of this ID, or else the main one: that which the document names, or its only one.
    pub(crate) fn main_tree(&self, id: Option<&str>) -> Result<&TreeDefinition, TreeError> {
        let refuse = |reason| TreeError::at(Place { line: 1, column: 1 }, reason);
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

    /// That each tree has an ID of its own, which is not that of a kind of node.
    fn distinct(&self, catalogue: &Catalogue) -> Result<(), TreeError> {
        for (number, tree) in self.trees.iter().enumerate() {
            if self.trees[..number].iter().any(|earlier| earlier.id == tree.id) {
                return Err(TreeError::at(tree.place, Reason::TwiceId(tree.id.clone())));
            }
            if BuiltIn::named(&tree.id).is_some() || catalogue.place(&tree.id).is_some() {
                return Err(TreeError::at(tree.place, Reason::TakenId(tree.id.clone())));
            }
        }
        Ok(())
    }

    /// Looks at all trees of the document as they would be built, also those that the main one does not use.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self, catalogue: &Catalogue) -> Result<(), TreeError> {
        self.main_tree(None)?;
        let (mut nodes, mut text) = (0, 0);
        for tree in &self.trees {
            let (built, length) = Tree::built(self, Some(&tree.id), catalogue, &mut Blackboard::new())?;
            nodes += built.shape.nodes.len();
            text += length;
            let (most_nodes, most_text) = MOST_TOGETHER;
            let refuse = |what, most| Err(TreeError::at(tree.place, Reason::TooMany { what, most }));
            if nodes > most_nodes {
                return refuse("nodes in the trees so far, each with its subtrees", most_nodes);
            }
            if text > most_text {
                return refuse("bytes of attributes in the trees so far, each with its subtrees", most_text);
            }
        }
        Ok(())
    }
}

struct Builder<'a> {
    document: &'a Document,
    catalogue: &'a Catalogue,
    blackboard: &'a mut Blackboard,
    scopes: Scopes,
    shape: Shape,
    /// Paths that are taken.
    paths: BTreeSet<Arc<str>>,
    /// The trees that the node being built is in, from the outermost.
    open: Vec<&'a str>,
    depth: usize,
    /// The bytes of attributes so far.
    text: usize,
    /// Over everything that the nodes so far say.
    fingerprint: u64,
}

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
        if self.shape.nodes.len() >= MOST_NODES {
            return refuse(Reason::TooManyNodes);
        }
        self.text += element.attributes.iter().map(|attribute| attribute.name.len() + attribute.value.len()).sum::<usize>();
        if self.text > MOST_TEXT {
            return refuse(Reason::TooMuchText);
        }
        let kind = self.kind(element)?;
        let family = match kind {
            Kind::BuiltIn(kind) => kind.family(),
            Kind::Leaf(_) => Family::Leaf,
        };
        self.count_children(element, kind)?;
        self.count_async(element, kind)?;
        self.note(element);
        let at = self.shape.nodes.len();
        let (path, name) = self.path(element, prefix, at + 1);
        let conditions = self.conditions(element, scope)?;
        let ports = to_u32(self.shape.bindings.len());
        let label = Label {
            name: Arc::from(name),
            path: path.clone(),
            id: Arc::from(if kind == Kind::BuiltIn(BuiltIn::SubTree) { "SubTree" } else { element.id.as_str() }),
            place: element.place,
            depth: u16::try_from(self.depth).unwrap_or(u16::MAX),
        };
        self.shape.nodes.push(Node { kind, family, end: 0, ports, port_count: 0, conditions });
        self.shape.labels.push(label);
        self.bind(element, kind, scope, to_u32(at))?;
        self.shape.nodes[at].port_count = u16::try_from(self.shape.bindings.len() - ports as usize).unwrap_or(u16::MAX);
        self.depth += 1;
        if kind == Kind::BuiltIn(BuiltIn::SubTree) {
            self.subtree(element, scope, &path)?;
        } else {
            for child in &element.children {
                self.node(child, scope, prefix)?;
            }
        }
        self.depth -= 1;
        self.shape.nodes[at].end = to_u32(self.shape.nodes.len());
        Ok(())
    }

    fn subtree(&mut self, element: &'a Element, scope: usize, path: &str) -> Result<(), TreeError> {
        let refuse = |reason| TreeError::at(element.place, reason);
        let document: &'a Document = self.document;
        let tree = document.tree(&element.id).ok_or_else(|| refuse(Reason::UnknownTree(element.id.clone())))?;
        if self.open.contains(&tree.id.as_str()) {
            return Err(refuse(Reason::Recursive(tree.id.clone())));
        }
        let inner = self.enter(element, scope, path)?;
        self.tree(tree, inner, &format!("{path}/"))
    }

    /// What an element names: a node of the engine, a leaf, or, by its own name, nothing else.
    fn kind(&self, element: &Element) -> Result<Kind, TreeError> {
        let refuse = |reason| Err(TreeError::at(element.place, reason));
        if element.form == Form::SubTree {
            return Ok(Kind::BuiltIn(BuiltIn::SubTree));
        }
        let wrong = || Reason::WrongForm { id: element.id.clone(), written: element.form.word() };
        if let Some(kind) = BuiltIn::named(&element.id) {
            let fits = match element.form {
                Form::Compact => true,
                Form::Control => kind.family() == Family::Control,
                Form::Decorator => kind.family() == Family::Decorator,
                Form::Action => kind.family() == Family::Leaf && kind != BuiltIn::ScriptCondition,
                Form::Condition => kind == BuiltIn::ScriptCondition,
                Form::SubTree => false,
            };
            return if fits { Ok(Kind::BuiltIn(kind)) } else { refuse(wrong()) };
        }
        let Some(place) = self.catalogue.place(&element.id) else {
            return refuse(Reason::UnknownNode(element.id.clone()));
        };
        let is_condition = self.catalogue.kinds()[place].is_condition;
        let fits = match element.form {
            Form::Compact => true,
            Form::Action => !is_condition,
            Form::Condition => is_condition,
            Form::Control | Form::Decorator | Form::SubTree => false,
        };
        if fits { Ok(Kind::Leaf(place)) } else { refuse(wrong()) }
    }

    fn count_children(&self, element: &Element, kind: Kind) -> Result<(), TreeError> {
        let (least, most) = match kind {
            // The child of a subtree stands elsewhere.
            Kind::BuiltIn(BuiltIn::SubTree) | Kind::Leaf(_) => (0, 0),
            Kind::BuiltIn(kind) => kind.children(),
        };
        let count = element.children.len();
        if (least..=most).contains(&count) {
            return Ok(());
        }
        let wanted = match (least, most) {
            (0, 0) => "none".to_owned(),
            (least, usize::MAX) => format!("{least} or more"),
            (least, most) if least == most => least.to_string(),
            (least, most) => format!("{least} to {most}"),
        };
        Err(TreeError::at(element.place, Reason::Children { id: element.id.clone(), count, wanted }))
    }

    /// As BehaviorTree.CPP has it: one asynchronous child would have the other halted in each tick.
    fn count_async(&self, element: &Element, kind: Kind) -> Result<(), TreeError> {
        let is_async = |child: &&Element| child.id == BuiltIn::AsyncSequence.word();
        if kind == Kind::BuiltIn(BuiltIn::ReactiveSequence) && element.children.iter().filter(is_async).count() > 1 {
            return Err(TreeError::at(element.place, Reason::TwoAsync));
        }
        Ok(())
    }

    /// Another word in a file is another tree.
    fn note(&mut self, element: &Element) {
        let attributes = element.attributes.iter().map(|attribute| format!("{}={}", attribute.name, attribute.value));
        let words: Vec<String> = attributes.collect();
        let said = format!("{} {:?} {:?} {words:?} {}", self.depth, element.id, element.name, element.children.len());
        self.fingerprint = fnv1a(&format!("{:x}{said}", self.fingerprint));
    }

    /// The path of a node, as BehaviorTree.CPP makes it, and its name. Where two nodes would have the same, the UID tells them apart.
    fn path<'e>(&mut self, element: &'e Element, prefix: &str, uid: usize) -> (Arc<str>, &'e str) {
        let name = element.name.as_deref().unwrap_or(&element.id);
        let named = format!("{prefix}{name}");
        let is_taken = name == element.id || self.paths.contains(named.as_str());
        let path: Arc<str> = if is_taken { Arc::from(format!("{named}::{uid}")) } else { Arc::from(named) };
        self.paths.insert(path.clone());
        (path, name)
    }
}

/// Numbers of nodes and ports are bounded by `MOST_NODES` and by what a file can hold.
fn to_u32(number: usize) -> u32 {
    u32::try_from(number).expect("a file is too short for so many")
}
