//! Checks that the leaves and ports of `--mock` and `--set` are in the file. An unknown leaf or port is refused: otherwise its
//! flag would be ignored silently, and the run would differ from the request.

use std::collections::BTreeSet;

use behaviour_trees::{Catalogue, Document, Element, Tree, mock};

/// The name that means every leaf without a mock of its own.
const ALL_OTHERS: &str = "*";

#[derive(Clone, Copy, Debug)]
pub(super) struct Meant<'a> {
    pub(super) flag: &'static str,
    pub(super) leaf: &'a str,
    pub(super) port: Option<&'a str>,
}

/// Refuses an unknown leaf or port. A leaf is named by its path in the tree that runs. It can also be named by its
/// name or kind in any tree of the file.
pub(super) fn check(all: &[Meant<'_>], document: &Document, tree: &Tree, catalogue: &Catalogue) -> Result<(), String> {
    let leaves = leaves(document, tree);
    all.iter().try_for_each(|meant| one(*meant, &leaves, catalogue))
}

/// A leaf's path, name and kind.
type Leaf<'a> = [&'a str; 3];

/// The leaves of the tree, then the leaves of the whole file. A leaf of the file has no path, so its name is used as
/// the path.
fn leaves<'a>(document: &'a Document, tree: &'a Tree) -> Vec<Leaf<'a>> {
    let name = |leaf: &'a Element| leaf.name.as_deref().unwrap_or(&leaf.id);
    let of_file = mock::leaves(document).into_iter().map(|leaf| [name(leaf), name(leaf), &*leaf.id]);
    let of_file: Vec<Leaf<'_>> = of_file.collect();
    let is_leaf = |id: &str| of_file.iter().any(|[.., kind]| *kind == id);
    let of_tree = tree.nodes().filter(|node| is_leaf(node.id)).map(|node| [node.path, node.name, node.id]);
    of_tree.chain(of_file.iter().copied()).collect()
}

fn one(meant: Meant<'_>, leaves: &[Leaf<'_>], catalogue: &Catalogue) -> Result<(), String> {
    let Meant { flag, leaf, port } = meant;
    let named: Vec<&Leaf<'_>> = leaves.iter().filter(|names| leaf == ALL_OTHERS || names.contains(&leaf)).collect();
    if named.is_empty() && leaf != ALL_OTHERS {
        let names = listed(leaves.iter().flat_map(|[_, name, kind]| [*name, *kind]));
        return Err(format!("{flag}: there is no leaf {leaf} in the file: {names}"));
    }
    let Some(port) = port else { return Ok(()) };
    let kinds = named.iter().filter_map(|[.., kind]| catalogue.kinds().get(catalogue.place(kind)?));
    let ports: Vec<&str> = kinds.flat_map(|kind| kind.ports.iter().map(|port| &*port.name)).collect();
    if ports.contains(&port) {
        return Ok(());
    }
    Err(format!("{flag}: {leaf} has no port {port}: {}", listed(ports.into_iter())))
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: BTreeSet<&str> = names.collect();
    match names.len() {
        0 => "there is none".to_owned(),
        1 => format!("there is {}", names.into_iter().collect::<String>()),
        _ => format!("there are {}", names.into_iter().collect::<Vec<&str>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use behaviour_trees::{Blackboard, Mocks, xml};

    use super::*;

    const FILE: &str = "<root BTCPP_format=\"4\" main_tree_to_execute=\"A\"><BehaviorTree ID=\"A\"><Sequence name=\"all\">\
        <Find name=\"first\" at=\"{x}\"/><Find name=\"then\" of=\"{y}\"/><SubTree ID=\"B\" name=\"deep\"/></Sequence></BehaviorTree>\
        <BehaviorTree ID=\"B\"><Go name=\"home\"/></BehaviorTree><BehaviorTree ID=\"C\"><Wait/></BehaviorTree></root>";

    fn said(leaf: &str, port: Option<&str>) -> Result<(), String> {
        let document = xml::read(FILE).expect("it is well written");
        let mut mocks = Mocks::default();
        mocks.add("*=SUCCESS").expect("it is a mock");
        let catalogue = mocks.catalogue(&document, Catalogue::default());
        let tree = Tree::build(&document, None, &catalogue, &mut Blackboard::new()).expect("all leaves have mocks");
        check(&[Meant { flag: "--set", leaf, port }], &document, &tree, &catalogue)
    }

    #[test]
    fn a_leaf_is_meant_by_its_path_its_name_and_its_kind() {
        for leaf in ["first", "Find", "deep/home", "home", "Go", "Wait", "*"] {
            assert_eq!(said(leaf, None), Ok(()), "{leaf}");
        }
    }

    #[test]
    fn a_leaf_that_is_not_there_is_refused_with_those_that_are() {
        let there = "there are Find, Go, Wait, first, home, then";
        for leaf in ["frist", "all", "Sequence", "B", "other/home", ""] {
            assert_eq!(said(leaf, Some("at")), Err(format!("--set: there is no leaf {leaf} in the file: {there}")));
        }
    }

    #[test]
    fn a_port_that_is_not_there_is_refused_with_those_that_are() {
        for (leaf, port) in [("first", "at"), ("Find", "of"), ("*", "at")] {
            assert_eq!(said(leaf, Some(port)), Ok(()), "{leaf}.{port}");
        }
        let refused = |text: &str| Err(text.to_owned());
        assert_eq!(said("Find", Some("to")), refused("--set: Find has no port to: there are at, of"));
        assert_eq!(said("home", Some("at")), refused("--set: home has no port at: there is none"));
    }
}
