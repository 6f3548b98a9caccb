//! Cycles of files: files of a crate that import each other, directly or through others. The files of a small cycle
//! are parts of one thing; no file of a large cycle can be read or changed alone.

use std::collections::{BTreeMap, BTreeSet};

use super::dependencies::{expanded, from_the_top, is_use, joined_uses, module_path, named_paths};
use super::reading::{Source, sources};

/// Maximum number of files in a cycle.
const FILES: usize = 4;

/// Folders of the crates.
const CRATES: [&str; 9] = [
    "",
    "crates/behaviour-trees/",
    "crates/coap/",
    "crates/core/",
    "crates/drivers/",
    "crates/evaluation/",
    "crates/laboratory/",
    "crates/mqtt/",
    "crates/sim/",
];

type Path = Vec<String>;

/// Files of a crate by module, with the paths that each names.
struct Files {
    /// Paths that each file names, including those that it re-exports.
    named: BTreeMap<Path, Vec<Path>>,
    /// Names that each file re-exports from others, with their paths.
    handed_on: BTreeMap<Path, BTreeMap<String, Path>>,
}

impl Files {
    fn of(sources: impl Iterator<Item = Source>) -> Files {
        let mut files = Files { named: BTreeMap::new(), handed_on: BTreeMap::new() };
        for source in sources.filter(|source| !source.is_all_tests()) {
            let module: Path =
                module_path(&source).into_iter().filter(|name| !["lib", "main"].contains(&name.as_str())).collect();
            let code = source.code_without_tests();
            let mut handed_on = BTreeMap::new();
            let mut others = String::new();
            for (_, line) in joined_uses(&code) {
                let path = line.split_once("use ").filter(|_| is_use(&line) && line.trim_start().starts_with("pub"));
                match path {
                    Some((_, path)) => handed_on.extend(expanded(path).into_iter().filter_map(|path| {
                        let is_own = ["crate", "self", "super"].contains(&path.first()?.as_str());
                        let path = if is_own { path } else { [vec!["self".to_owned()], path].concat() };
                        Some((path.last()?.clone(), from_the_top(&module, &path)?))
                    })),
                    None => others += &format!("{line}\n"),
                }
            }
            let others = Source::new(&format!("src/{}.rs", module.join("/")), &others);
            let named = named_paths(&others).into_iter().map(|(_, path)| path).chain(handed_on.values().cloned());
            files.named.insert(module.clone(), named.collect());
            files.handed_on.insert(module, handed_on);
        }
        files
    }

    /// File that defines the item of this path; re-exports are followed.
    fn home(&self, path: &[String]) -> Path {
        let mut path = path.to_vec();
        for _ in 0..8 {
            let depth = (0..=path.len()).rev().find(|depth| self.named.contains_key(&path[..*depth])).unwrap_or(0);
            let (file, rest) = path.split_at(depth);
            match rest.first().and_then(|name| self.handed_on.get(file)?.get(name)) {
                Some(elsewhere) => path = [elsewhere, &rest[1..]].concat(),
                None => return file.to_vec(),
            }
        }
        path
    }

    /// Files that each file imports. Imports from a module's own submodules do not count, because the module only
    /// presents them.
    fn arrows(&self) -> BTreeMap<&Path, BTreeSet<Path>> {
        let arrow = |from: &Path, path: &Path| Some(self.home(path)).filter(|to| !to.starts_with(from));
        self.named.iter().map(|(from, named)| (from, named.iter().filter_map(|path| arrow(from, path)).collect())).collect()
    }

    fn circles(&self) -> BTreeSet<Vec<String>> {
        let arrows = self.arrows();
        let reached = |from: &Path| {
            let (mut reached, mut open) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(next) = open.pop() {
                open.extend(arrows.get(&next).into_iter().flatten().filter(|to| reached.insert((*to).clone())).cloned());
            }
            reached
        };
        let reached: BTreeMap<&Path, BTreeSet<Path>> = self.named.keys().map(|from| (from, reached(from))).collect();
        let circle = |from: &Path| -> Vec<String> {
            reached[from]
                .iter()
                .filter(|to| reached.get(to).is_some_and(|back| back.contains(from)))
                .map(|to| to.join("::"))
                .collect()
        };
        self.named.keys().map(circle).filter(|circle| circle.len() > 1).collect()
    }
}

#[test]
fn no_circle_of_files_is_large() {
    for folder in CRATES {
        let within = |source: &Source| Source::new(source.path.trim_start_matches(folder), &source.text);
        let files = Files::of(sources(&format!("{folder}src")).iter().map(within));
        let large: Vec<Vec<String>> = files.circles().into_iter().filter(|circle| circle.len() > FILES).collect();
        assert!(large.is_empty(), "in {folder}src these import each other: {large:#?}");
    }
}

#[test]
fn a_circle_is_found_through_whatever_hands_a_name_on() {
    let circles = |texts: &[(&str, &str)]| Files::of(texts.iter().map(|(path, text)| Source::new(path, text))).circles().len();
    let (lib, a) = (("src/lib.rs", "mod a;\nmod b;\npub use b::B;"), ("src/a.rs", "use crate::B;\nstruct A;"));
    assert_eq!(circles(&[lib, a, ("src/b.rs", "struct B(super::a::A);")]), 1);
    assert_eq!(circles(&[lib, a, ("src/b.rs", "struct B;\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}")]), 0);
    let (face, below) = (("src/c/mod.rs", "mod d;\nuse self::d::D;\nstruct C;"), ("src/c/d.rs", "use super::C;\nstruct D;"));
    assert_eq!(circles(&[face, below]), 0, "a module and what it is the face of");
    let (on, back) = (("src/a.rs", "pub use super::b::B;\nstruct A;"), ("src/b.rs", "struct B(super::a::A);"));
    assert_eq!(circles(&[on, back]), 1, "to hand on is to import");
}
