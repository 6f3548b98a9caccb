//! Maps names to entries. Each subtree seems to have its own blackboard, and its `<SubTree>` may bind names to
//! entries outside. Names are mapped when a tree is built. There is only one real blackboard. In it, the names of a
//! subtree's entries begin with the path of the subtree.

use std::collections::{BTreeMap, BTreeSet};

use crate::blackboard::{Blackboard, Slot, Unfit};
use crate::value::ValueType;

/// The scopes of a tree and its subtrees; the first one is the scope of the tree itself.
pub(super) struct Scopes {
    scopes: Vec<Scope>,
    /// Prefix of the names of all entries of subtrees. It separates the trees on one blackboard.
    root: String,
}

#[derive(Default)]
struct Scope {
    parent: usize,
    prefix: String,
    /// Names in this scope, each with its name in the parent scope.
    remapped: BTreeMap<String, String>,
    own: BTreeSet<String>,
    has_autoremap: bool,
    is_root: bool,
}

impl Scopes {
    pub(super) fn new(id: &str, blackboard: &Blackboard) -> Scopes {
        let is_taken = |root: &str| blackboard.entries().any(|entry| entry.name().starts_with(root));
        // If the same tree is built twice on one blackboard, the entries of its subtrees are separate.
        let names = std::iter::once(format!("{id}/")).chain((2..).map(|number| format!("{id}#{number}/")));
        let root = names.into_iter().find(|root| !is_taken(root)).unwrap_or_default();
        Scopes { scopes: vec![Scope { is_root: true, ..Scope::default() }], root }
    }

    pub(super) fn enter(&mut self, parent: usize, path: &str, has_autoremap: bool) -> usize {
        let prefix = format!("{}{path}/", self.root);
        self.scopes.push(Scope { parent, prefix, has_autoremap, ..Scope::default() });
        self.scopes.len() - 1
    }

    /// Binds a name of this scope to an entry outside.
    pub(super) fn remap(&mut self, scope: usize, inside: &str, outside: &str) {
        self.scopes[scope].remapped.insert(inside.to_owned(), outside.to_owned());
    }

    /// Binds a name of this scope to an entry of the scope itself, even if the name is remapped.
    pub(super) fn own(&mut self, scope: usize, name: &str) {
        self.scopes[scope].own.insert(name.to_owned());
    }

    /// Returns the blackboard's name for the entry called `name` in this scope. A name with `@` belongs to the scope
    /// of the main tree.
    pub(super) fn entry_name(&self, scope: usize, name: &str) -> String {
        if let Some(name) = name.strip_prefix('@') {
            return name.to_owned();
        }
        let here = &self.scopes[scope];
        if here.is_root || here.own.contains(name) {
            return format!("{}{name}", here.prefix);
        }
        if let Some(outside) = here.remapped.get(name) {
            return self.entry_name(here.parent, outside);
        }
        // Names that begin with _ are private.
        if here.has_autoremap && !name.starts_with('_') {
            return self.entry_name(here.parent, name);
        }
        format!("{}{name}", here.prefix)
    }

    /// Whether a name means an entry of this scope's own blackboard, and not an entry outside.
    pub(super) fn is_own(&self, scope: usize, name: &str) -> bool {
        let here = &self.scopes[scope];
        let leads_out = here.remapped.contains_key(name) || (here.has_autoremap && !name.starts_with('_'));
        !name.starts_with('@') && (here.is_root || here.own.contains(name) || !leads_out)
    }

    pub(super) fn declare(&self, scope: usize, name: &str, ty: ValueType, blackboard: &mut Blackboard) -> Result<Slot, Unfit> {
        blackboard.declare(&self.entry_name(scope, name), ty)
    }
}
