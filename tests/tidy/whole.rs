//! Rules for the whole project: no path of one machine, no download address, no link without a target, and a
//! Dockerfile that copies existing files.

use super::reading::{files, name, root};

/// Folders of the project that contain our own text.
const PLACES: [&str; 8] = ["src", "tests", "config", "templates", "static", "docs", ".ci", "benches"];

/// Folders of a developer's machine. Each name is joined from two parts, so that this file does not violate its own
/// rule.
const MACHINE: [&str; 4] = [concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("/Us", "ers/")];

pub(crate) fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Lines that name a path of a developer's machine.
pub(crate) fn machine_paths() -> Vec<String> {
    let mut paths: Vec<_> = PLACES.iter().flat_map(|place| files(&root().join(place))).collect();
    paths.extend(["README.md", "CHANGELOG.md", "Cargo.toml", "Dockerfile"].map(|file| root().join(file)));
    let texts = paths.iter().filter_map(|path| Some((name(path), std::fs::read_to_string(path).ok()?)));
    texts.flat_map(|(name, text)| machine_paths_in(&name, &text)).collect()
}

fn machine_paths_in(name: &str, text: &str) -> Vec<String> {
    let lines = text.lines().enumerate();
    let hits = lines.filter(|(_, line)| MACHINE.iter().any(|path| line.contains(path)));
    hits.map(|(number, _)| format!("{name}:{}: a path of one machine", number + 1)).collect()
}

/// Paths that the Dockerfile copies from the project and that do not exist.
pub(crate) fn container_paths(recipe: &str) -> Vec<String> {
    let copies = recipe.lines().filter(|line| line.starts_with("COPY ") && !line.contains("--from="));
    let paths = copies.flat_map(|line| {
        let words: Vec<&str> = line.split_whitespace().skip(1).filter(|word| !word.starts_with("--")).collect();
        words[..words.len().saturating_sub(1)].to_vec()
    });
    paths.filter(|path| !root().join(path).exists()).map(|path| format!("Dockerfile copies {path}, which is not there")).collect()
}

/// Links in our documents to files that do not exist.
pub(crate) fn dead_links() -> Vec<String> {
    let mut documents: Vec<_> = files(&root().join("docs")).into_iter().filter(|path| name(path).ends_with(".md")).collect();
    documents.extend(["README.md", "CHANGELOG.md"].map(|file| root().join(file)));
    let texts = documents.iter().map(|path| (name(path), std::fs::read_to_string(path).expect("a document is UTF-8")));
    texts.flat_map(|(name, text)| dead_links_in(&name, &text)).collect()
}

fn dead_links_in(document: &str, text: &str) -> Vec<String> {
    let folder = root().join(document).parent().expect("a file is in a folder").to_owned();
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#', ' ']).next());
    let local = targets.filter(|target| !target.is_empty() && !target.contains("://"));
    local
        .filter(|target| !folder.join(target).exists())
        .map(|target| format!("{document} links to {target}, which is not there"))
        .collect()
}

/// Lines of pages and scripts with an address from the root of the host, where a proxy may serve something else. The
/// value of `here`, the page to return to, is excepted, because the program and not the browser resolves it.
pub(crate) fn absolute_addresses() -> Vec<String> {
    let pages = ["templates", "static"].iter().flat_map(|place| files(&root().join(place)));
    let ours = pages.map(|path| (name(&path), path)).filter(|(name, _)| !name.contains("/vendor/"));
    ours.flat_map(|(name, path)| absolute_addresses_in(&name, &std::fs::read_to_string(path).expect("text"))).collect()
}

fn absolute_addresses_in(name: &str, text: &str) -> Vec<String> {
    let named = |rest: &str| rest.starts_with(|letter: char| letter.is_ascii_lowercase() || "{$".contains(letter));
    let is_address = |line: &str| {
        let named = ["\"/", "'/", "`/", "url(/"].iter().any(|start| line.split(start).skip(1).any(named));
        named || ["=\"/\"", "fetch(\"/\"", "assign(\"/\"", ", \"/\")"].iter().any(|root| line.contains(root))
    };
    let lines = text.lines().enumerate().filter(|(_, line)| !line.contains("let here = ") && is_address(line));
    lines.map(|(number, _)| format!("{name}:{}: an address from the root: write ./", number + 1)).collect()
}

/// Packages whose manifests the Dockerfile does not copy; cargo would not build without them.
pub(crate) fn container_manifests(recipe: &str) -> Vec<String> {
    let packages = std::fs::read_dir(root().join("crates")).expect("the project has crates");
    let manifests = packages.map(|package| name(&package.expect("it can be read").path().join("Cargo.toml")));
    let missing = manifests.filter(|manifest| !recipe.contains(&format!("COPY {manifest} ")));
    missing.map(|manifest| format!("the Dockerfile must copy {manifest} by itself")).collect()
}

/// Lines of a lock file that contain a download address.
pub(crate) fn download_addresses(lock: &str) -> Vec<String> {
    let lines = lock.lines().enumerate().filter(|(_, line)| line.contains("\"resolved\"") || line.contains("http://"));
    lines.map(|(number, line)| format!("{}: {}", number + 1, line.trim())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_of_a_machine_is_found_with_its_line() {
        let text = format!("fine\nlet a = \"{}me/b\";", MACHINE[0]);
        assert_eq!(machine_paths_in("src/a.rs", &text), ["src/a.rs:2: a path of one machine"]);
    }

    #[test]
    fn a_container_that_copies_what_is_not_there_is_found() {
        let recipe = "COPY Cargo.toml no-such-folder ./\nCOPY --from=build /app /app\n";
        assert_eq!(container_paths(recipe), ["Dockerfile copies no-such-folder, which is not there"]);
    }

    #[test]
    fn a_dead_link_is_found() {
        let text = "[a](docs/no-such.md) [b](https://example.org/c) [d](Cargo.toml#e) ![f](no.png)";
        assert_eq!(dead_links_in("README.md", text).len(), 2);
    }

    #[test]
    fn an_address_from_the_root_is_found() {
        for text in [
            "<a href=\"/\">",
            "<img src='/static/a.svg'>",
            "fetch(`/console/${a}`)",
            "fetch(\"/\")",
            "b { mask: url(/c) }",
            "<a href=\"/{{ b }}\">",
            "fetch(`/${c}`)",
        ] {
            assert_eq!(absolute_addresses_in("a", text), ["a:1: an address from the root: write ./"], "{text}");
        }
        for text in
            ["<a href=\"./missions\">", "{% let here = \"/api\" %}", "a.split(\"/\").join(\"//\")", "b.matches(/-?\\d+/g)"]
        {
            assert_eq!(absolute_addresses_in("a", text), Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn a_container_without_the_manifest_of_a_package_is_found() {
        let packages = container_manifests("").len();
        assert_eq!(container_manifests("COPY crates/core/Cargo.toml crates/core/").len(), packages - 1);
    }

    #[test]
    fn a_download_address_is_found() {
        assert_eq!(download_addresses("{\n\"resolved\": \"https://a/b.tgz\",\n}").len(), 1);
        assert_eq!(download_addresses("\"integrity\": \"sha512-\"").len(), 0);
    }
}
