//! The rules for the crates: the drawing in `docs/architecture.md` agrees with the manifests, and the crates for
//! others contain no word of this program.

use super::reading::{files, name, root};

/// Words that crates for others must not contain, in lower or upper case.
const OUR_WORDS: [&str; 3] = ["hallsweep", "luggage", "verdict"];

/// Crates that other programs may use.
const FOR_OTHERS: [&str; 3] = ["crates/behaviour-trees", "crates/coap", "crates/mqtt"];

/// Manifests of the program and of each crate.
pub(crate) fn manifests() -> Vec<String> {
    let crates = files(&root().join("crates")).into_iter().filter(|path| path.ends_with("Cargo.toml"));
    let all = std::iter::once(root().join("Cargo.toml")).chain(crates);
    all.map(|path| std::fs::read_to_string(path).expect("a manifest is UTF-8")).collect()
}

/// Dependencies between our crates that are only in the drawing or only in the manifests.
pub(crate) fn differ_from_picture(manifests: &[String], page: &str) -> Vec<String> {
    let names: Vec<String> = manifests.iter().filter_map(|manifest| package(manifest)).collect();
    let mut there: Vec<String> = Vec::new();
    for manifest in manifests {
        let Some(from) = package(manifest) else { continue };
        let wanted = section(manifest, "[dependencies]").filter_map(|line| line.split([' ', '.', '=']).next());
        let ours = wanted.filter(|wanted| names.iter().any(|name| name == wanted));
        there.extend(ours.map(|to| format!("{from} -> {to}")));
        there.push(from);
    }
    let drawn = drawn(page, &names);
    let missing = there.iter().filter(|arrow| !drawn.contains(arrow)).map(|arrow| format!("not drawn: {arrow}"));
    let wrong = drawn.iter().filter(|arrow| !there.contains(arrow)).map(|arrow| format!("drawn, and not there: {arrow}"));
    missing.chain(wrong).collect()
}

/// Crates and arrows of the drawing: the lines of the block whose first line begins with the name of a crate.
fn drawn(page: &str, names: &[String]) -> Vec<String> {
    let block = page.split("```").skip(1).step_by(2).find(|block| {
        let first = block.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
        names.iter().any(|name| first.split(' ').next() == Some(name))
    });
    let lines = block.unwrap_or_default().lines().map(str::trim).filter(|line| !line.is_empty());
    let mut drawn = Vec::new();
    for line in lines {
        let (from, to) = line.split_once('►').unwrap_or((line, ""));
        let from = from.trim_end_matches([' ', '─']);
        drawn.extend(to.split(',').map(str::trim).filter(|to| !to.is_empty()).map(|to| format!("{from} -> {to}")));
        drawn.push(from.to_owned());
    }
    drawn
}

fn package(manifest: &str) -> Option<String> {
    let line = section(manifest, "[package]").find(|line| line.starts_with("name = "))?;
    Some(line.trim_start_matches("name = ").trim_matches('"').to_owned())
}

fn section<'a>(manifest: &'a str, title: &'a str) -> impl Iterator<Item = &'a str> {
    manifest.lines().skip_while(move |line| *line != title).skip(1).take_while(|line| !line.starts_with('['))
}

/// Words of this program in the crates for others.
pub(crate) fn our_words() -> Vec<String> {
    let all = FOR_OTHERS.iter().flat_map(|folder| files(&root().join(folder)));
    all.filter_map(|path| Some((name(&path), std::fs::read_to_string(&path).ok()?)))
        .flat_map(|(name, text)| our_words_in(&name, &text))
        .collect()
}

fn our_words_in(name: &str, text: &str) -> Vec<String> {
    let lines = text.lines().enumerate();
    // The tests of all crates read variables with this prefix.
    let lines = lines.map(|(number, line)| (number, line.replace("HALLSWEEP_", "")));
    let hits = lines.filter(|(_, line)| OUR_WORDS.iter().any(|word| line.to_lowercase().contains(word)));
    hits.map(|(number, _)| format!("{name}:{}: a word of this program in a crate for others", number + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(name: &str, dependencies: &str) -> String {
        format!("[package]\nname = \"{name}\"\n\n[dependencies]\n{dependencies}\n\n[dev-dependencies]\nc.workspace = true\n")
    }

    #[test]
    fn an_arrow_that_is_not_drawn_is_found_and_one_that_is_not_there() {
        let manifests = [manifest("a", "b = { path = \"b\" }\nserde = \"1\""), manifest("b", ""), manifest("c", "")];
        assert_eq!(differ_from_picture(&manifests, "```\na ─► b\nb\nc\n```"), Vec::<String>::new());
        assert_eq!(differ_from_picture(&manifests, "```\na\nb\nc\n```"), ["not drawn: a -> b"]);
        assert_eq!(differ_from_picture(&manifests, "```\na ─► b, c\nb\nc\n```"), ["drawn, and not there: a -> c"]);
        assert_eq!(differ_from_picture(&manifests, "```\na ─► b\nb\n```"), ["not drawn: c"]);
    }

    #[test]
    fn a_word_of_ours_is_found_whatever_its_letters() {
        assert_eq!(our_words_in("a.rs", "fn a() {}\n// Luggage\n").len(), 1);
    }
}
