//! The list of links at `/.well-known/core`, and the filters on it (RFC 6690). The application decides which links
//! there are. Nothing is read or sent here.

use std::fmt::Write;

/// One link with its attributes (RFC 6690, section 2).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    href: String,
    attributes: Vec<(&'static str, Option<String>)>,
}

impl Link {
    /// A link to a path, such as `/robot`.
    #[must_use]
    pub fn new(href: impl Into<String>) -> Link {
        Link { href: href.into(), attributes: Vec::new() }
    }

    /// Adds an attribute, such as `rt`. Several values of `rt`, `if`, `rel` or `ct` are written in one text,
    /// separated by spaces.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Link {
        self.attributes.push((name, Some(value.into())));
        self
    }

    /// Adds an attribute without a value, such as `obs`.
    #[must_use]
    pub fn flag(mut self, name: &'static str) -> Link {
        self.attributes.push((name, None));
        self
    }

    /// Whether this link matches a query (RFC 6690, section 4.1), such as `rt=map`, `href=/rob*`, `sz=*` or `obs`.
    fn matches(&self, query: &str) -> bool {
        let Some((name, wanted)) = query.split_once('=') else {
            return query == "href" || self.attributes.iter().any(|(known, _)| *known == query);
        };
        if name == "href" {
            return is_wanted(&self.href, wanted);
        }
        self.attributes.iter().filter(|(known, _)| *known == name).any(|(name, value)| match value {
            Some(value) if MANY.contains(name) => value.split(' ').any(|value| is_wanted(value, wanted)),
            Some(value) => is_wanted(value, wanted),
            None => wanted == "*",
        })
    }

    fn print(&self, list: &mut String) {
        let _ = write!(list, "<{}>", self.href);
        for (name, value) in &self.attributes {
            let _ = match value {
                None => write!(list, ";{name}"),
                Some(value) if is_bare(name, value) => write!(list, ";{name}={value}"),
                Some(value) => write!(list, ";{name}=\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\"")),
            };
        }
    }
}

/// The links that match every query, in `application/link-format`. The text is empty without links.
#[must_use]
pub fn link_format(links: &[Link], queries: &[String]) -> String {
    let mut list = String::new();
    for link in links.iter().filter(|link| queries.iter().all(|query| link.matches(query))) {
        if !list.is_empty() {
            list.push(',');
        }
        link.print(&mut list);
    }
    list
}

/// Attributes whose value is a list of values (RFC 6690, section 4.1; for `ct` RFC 7252, section 7.2.1).
const MANY: [&str; 4] = ["rt", "if", "rel", "ct"];

/// Whether a value is equal to `wanted`, or begins with it when `wanted` ends with `*` (RFC 6690, section 4.1).
fn is_wanted(value: &str, wanted: &str) -> bool {
    wanted.strip_suffix('*').map_or(value == wanted, |beginning| value.starts_with(beginning))
}

/// Whether the value is written without quotes, as a single number is.
fn is_bare(name: &str, value: &str) -> bool {
    matches!(name, "ct" | "sz") && !value.is_empty() && value.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn links() -> Vec<Link> {
        vec![
            Link::new("/robot").with("rt", "robot core.pose").with("if", "sensor").with("ct", "50 60").flag("obs"),
            Link::new("/photo").with("rt", "photo").with("ct", "23").with("sz", "70000").with("title", "say \"cheese\" here"),
            Link::new("/robot/arm").with("if", "sense").with("title", "A long arm"),
        ]
    }

    /// Checks which of the three links match the queries. `expect` has the paths of these links.
    fn check(queries: &[&str], expect: &[&str]) {
        let queries: Vec<String> = queries.iter().map(|query| (*query).to_owned()).collect();
        let list = link_format(&links(), &queries);
        let found: Vec<&str> = list.split('<').skip(1).filter_map(|link| link.split('>').next()).collect();
        assert_eq!(found, expect, "{queries:?}");
    }

    #[test]
    fn a_list_is_written_as_the_rfc_writes_it() {
        let list = "</robot>;rt=\"robot core.pose\";if=\"sensor\";ct=\"50 60\";obs,\
                    </photo>;rt=\"photo\";ct=23;sz=70000;title=\"say \\\"cheese\\\" here\",\
                    </robot/arm>;if=\"sense\";title=\"A long arm\"";
        assert_eq!(link_format(&links(), &[]), list);
        assert_eq!(link_format(&[], &[]), "");
    }

    #[test]
    fn a_value_is_matched_whole_or_by_its_beginning() {
        check(&["rt=photo"], &["/photo"]);
        check(&["rt=phot"], &[]);
        check(&["rt=*"], &["/robot", "/photo"]);
        check(&["if=sens*"], &["/robot", "/robot/arm"]);
        check(&["if=sensor"], &["/robot"]);
        check(&["sz=*"], &["/photo"]);
        check(&["sz=70000"], &["/photo"]);
        check(&["title=A long arm"], &["/robot/arm"]);
        check(&["title=long"], &[]);
    }

    #[test]
    fn one_of_several_values_is_enough() {
        check(&["rt=core.pose"], &["/robot"]);
        check(&["rt=core*"], &["/robot"]);
        check(&["ct=60"], &["/robot"]);
        check(&["ct=6"], &[]);
        check(&["rt=robot core.pose"], &[]);
    }

    #[test]
    fn a_path_is_matched_whole_or_by_its_beginning() {
        check(&["href=/robot"], &["/robot"]);
        check(&["href=/robot*"], &["/robot", "/robot/arm"]);
        check(&["href=robot"], &[]);
    }

    #[test]
    fn what_can_be_observed_is_found_with_and_without_a_star() {
        check(&["obs"], &["/robot"]);
        check(&["obs=*"], &["/robot"]);
        check(&["obs=1"], &[]);
    }

    #[test]
    fn several_filters_must_all_let_through_and_an_unknown_one_lets_nothing() {
        check(&["rt=*", "sz=*"], &["/photo"]);
        check(&["rt=robot", "sz=*"], &[]);
        check(&["colour=blue"], &[]);
        check(&["colour"], &[]);
    }
}
