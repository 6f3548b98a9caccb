//! `/.well-known/core` (RFC 6690): lists the rows of the table as links. A path with a number becomes one link for
//! each existing piece or alarm. `coap_endpoint::link_format` filters and formats the links.

use super::etag::tag;
use super::table::{PathRow, Show, Table};
use crate::api::resources::ResourceKind;
use coap_endpoint::{Format, Link, Response, link_format};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::PhotoState;

const SEE: &str = "hallsweep.see";

const ACT: &str = "hallsweep.act";

pub(super) fn filtered(snapshot: &Snapshot, queries: &[String]) -> Response {
    let list = listing(snapshot, queries);
    Response { tag: Some(tag(&[&list])), max_age: Some(0), ..Response::content(Format::LINKS, list) }
}

pub(super) fn listing(snapshot: &Snapshot, queries: &[String]) -> Vec<u8> {
    let links: Vec<Link> = Table::default().rows.iter().flat_map(|row| links(row, snapshot)).collect();
    link_format(&links, queries).into_bytes()
}

/// Returns the links of a row. If its path contains `{id}`, there is one link for each piece of this mission, or one
/// for each alarm.
fn links(row: &PathRow, snapshot: &Snapshot) -> Vec<Link> {
    let each = |id: u64| link(row, &row.path.replace("{id}", &id.to_string()), size(row, LuggageId(id), snapshot));
    if row.path.starts_with("/luggage/{id}") {
        snapshot.luggage.iter().map(|piece| each(piece.id.0)).collect()
    } else if row.path.starts_with("/alarms/{id}") {
        snapshot.alarms.iter().filter_map(|alarm| alarm.id).map(|id| each(id.0)).collect()
    } else {
        vec![link(row, row.path, None)]
    }
}

fn link(row: &PathRow, href: &str, size: Option<usize>) -> Link {
    let interface = match (&row.shows, row.actions.is_empty()) {
        (Some(_), true) => SEE.to_owned(),
        (Some(_), false) => format!("{SEE} {ACT}"),
        (None, _) => ACT.to_owned(),
    };
    let mut link =
        Link::new(href).with("rt", format!("hallsweep.{}", row.rt)).with("if", interface).with("title", row.title.as_str());
    if let Some(shown) = &row.shows {
        let formats: Vec<String> = shown.formats.iter().map(|format| format.0.to_string()).collect();
        link = link.with("ct", formats.join(" "));
        link = if shown.is_observable { link.flag("obs") } else { link };
    }
    match size {
        Some(size) => link.with("sz", size.to_string()),
        None => link,
    }
}

/// Returns the size of a photo in bytes. Returns `None` for a failed photo, and for other resources, because their
/// sizes change all the time.
fn size(row: &PathRow, id: LuggageId, snapshot: &Snapshot) -> Option<usize> {
    row.shows.as_ref().filter(|shown| shown.show == Show::Resource(ResourceKind::Photo))?;
    match snapshot.luggage(id)?.photo {
        PhotoState::Taken { bytes, .. } => Some(bytes),
        PhotoState::Failed(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, searching};

    fn hrefs(snapshot: &Snapshot, queries: &[&str]) -> Vec<String> {
        let queries: Vec<String> = queries.iter().map(|query| (*query).to_owned()).collect();
        let list = String::from_utf8(listing(snapshot, &queries)).unwrap();
        list.split('<').skip(1).filter_map(|link| link.split('>').next()).map(str::to_owned).collect()
    }

    #[test]
    fn every_path_is_listed_and_those_with_a_number_once_for_each_thing() {
        let all = hrefs(&searching(), &[]);
        for row in Table::default().rows {
            let expect: Vec<String> = match row.path.split('/').nth(1) {
                Some("luggage") if row.path.contains("{id}") => {
                    (1..=3).map(|id| row.path.replace("{id}", &id.to_string())).collect()
                }
                Some("alarms") if row.path.contains("{id}") => vec![row.path.replace("{id}", "1")],
                _ => vec![row.path.to_owned()],
            };
            assert!(expect.iter().all(|href| all.contains(href)), "{expect:?} in {all:?}");
        }
        assert!(hrefs(&idle(), &[]).iter().all(|href| !href.contains("{id}")));
    }

    #[test]
    fn a_link_says_what_it_leads_to() {
        let links = listing(&searching(), &["href=/temperature".to_owned()]);
        let expect = "</temperature>;rt=\"hallsweep.temperature\";if=\"hallsweep.see hallsweep.act\";\
                      title=\"The temperature and its effect\";ct=\"50 60 0 110\";obs";
        assert_eq!(String::from_utf8(links).unwrap(), expect);
    }

    #[test]
    fn the_list_is_filtered_by_what_is_said_of_each_link() {
        let state = searching();
        assert_eq!(hrefs(&state, &["sz=*"]), ["/luggage/1/photo", "/luggage/2/photo", "/luggage/3/photo"]);
        assert_eq!(hrefs(&state, &["sz=4", "href=/luggage/2*"]), ["/luggage/2/photo"]);
        assert_eq!(hrefs(&state, &["rt=hallsweep.robot"]), ["/robot"]);
        assert_eq!(hrefs(&state, &["ct=110"]), ["/robot", "/temperature"]);
        assert_eq!(hrefs(&state, &["ct=40"]), ["/.well-known/core"]);
        assert!(hrefs(&state, &["if=hallsweep.act"]).contains(&"/commands/stop".to_owned()));
        assert!(hrefs(&state, &["obs"]).contains(&"/resourcemodel".to_owned()));
        assert_eq!(hrefs(&state, &["rt=nothing"]), Vec::<String>::new());
    }
}
