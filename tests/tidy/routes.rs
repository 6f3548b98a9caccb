//! The rule for routes: the HTTP door has one table of routes, and no other code adds a route.

use super::reading::Source;

/// File that builds the router from the table.
const TABLE: &str = "src/doors/http/routes.rs";

/// Folder of the code that could add routes.
const DOOR: &str = "src/doors/http/";

/// Violations: lines that add routes outside the table.
pub(crate) fn beside_the_table(source: &Source) -> Vec<String> {
    if source.path == TABLE || !source.path.starts_with(DOOR) {
        return Vec::new();
    }
    let ways = [".route(", ".route_service(", ".nest(", ".nest_service(", ".merge(", ".fallback(", ".fallback_service("];
    let lines = source.code.lines().enumerate();
    let hits = lines.filter(|(_, line)| ways.iter().any(|way| line.contains(way)));
    hits.map(|(number, _)| source.at(number + 1, "a route beside the table: give it a row in routes.rs, with what it needs"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_beside_the_table_is_found() {
        let found = |path: &str, text: &str| beside_the_table(&Source::new(path, text)).len();
        assert_eq!(found("src/doors/http/old.rs", "Router::new().route(\"/w\", post(give))"), 1);
        assert_eq!(found("src/doors/http/console/mod.rs", "    .merge(pages)\n    .nest(\"/a\", b)"), 2);
        assert_eq!(found(TABLE, "router.route(row.path, row.answers)"), 0);
        assert_eq!(found("src/doors/http/old.rs", "// .route(\nlet way = route(here);"), 0);
        assert_eq!(found("src/doors/coap/a.rs", "table.merge(other)"), 0);
    }
}
