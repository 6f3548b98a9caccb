//! All paths of this door: their representations with formats, whether they can be observed, and their actions. The
//! rows come from `api::resources` and `api::commands`; some paths exist only at this door. Routing, the answer to a
//! wrong method, `/.well-known/core` and the table in `docs/coap.md` all use this table. A path that is not in the
//! table does not exist.

use crate::api::commands::{self, COMMANDS, CommandKind, Methods, Subject};
use crate::api::resources::{Form, RESOURCES, ResourceKind};
use coap_endpoint::{Format, Method};

pub(super) struct Table {
    pub(super) rows: Vec<PathRow>,
}

pub(super) struct PathRow {
    /// A path such as `/luggage/{id}/photo`, where `{id}` stands for a number.
    pub(super) path: &'static str,
    pub(super) rt: String,
    pub(super) title: String,
    pub(super) shows: Option<Representations>,
    pub(super) actions: Vec<(Method, Action)>,
}

#[derive(Clone)]
pub(super) struct Representations {
    pub(super) show: Show,
    /// The first format is the default.
    pub(super) formats: Vec<Format>,
    pub(super) is_observable: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Show {
    Resource(ResourceKind),
    OldItems,
    Links,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Command(CommandKind),
    OldWord,
}

pub(super) struct FoundPath<'a> {
    pub(super) row: &'a PathRow,
    /// The number in the path, or 0 if the path has no number.
    pub(super) number: u64,
}

impl Default for Table {
    fn default() -> Table {
        let resources = RESOURCES.iter().map(|row| {
            let formats = row.forms.iter().flat_map(|form| formats_of(*form)).copied().collect();
            shown(row.path, row.name, row.title, Show::Resource(row.kind), formats, row.is_observable)
        });
        Table { rows: with_commands(only_here().into_iter().chain(resources).collect()) }
    }
}

impl Table {
    pub(super) fn find(&self, path: &[String]) -> Option<FoundPath<'_>> {
        self.rows.iter().find_map(|row| row.number(path).map(|number| FoundPath { row, number }))
    }
}

impl PathRow {
    pub(super) fn action(&self, method: Method) -> Option<Action> {
        self.actions.iter().find(|(answers, _)| *answers == method).map(|(_, action)| *action)
    }

    pub(super) fn methods(&self) -> impl Iterator<Item = Method> {
        self.shows.iter().map(|_| Method::Get).chain(self.actions.iter().map(|(method, _)| *method))
    }

    /// Returns the number in a path that matches this row, or 0 if the row has no number. Returns `None` if the path
    /// does not match.
    fn number(&self, path: &[String]) -> Option<u64> {
        // Most paths differ in the first word, so that word is compared first.
        if !self.path[1..].starts_with(path.first()?) {
            return None;
        }
        let mut number = 0;
        let mut ours = self.path.split('/').skip(1);
        for segment in path {
            match ours.next()? {
                // Numbers such as `+1` and `01` are not accepted, so that each thing has a single path.
                "{id}" => number = segment.parse().ok().filter(|number: &u64| number.to_string() == *segment)?,
                other if other == segment => {}
                _ => return None,
            }
        }
        ours.next().is_none().then_some(number)
    }
}

fn only_here() -> [PathRow; 2] {
    let old_words = vec![(Method::Put, Action::OldWord), (Method::Post, Action::OldWord)];
    let (links, items) = (vec![Format::LINKS], vec![Format::TEXT]);
    let old_items = shown("/resourcemodel", "resourcemodel", "The model for old clients", Show::OldItems, items, true);
    [
        shown("/.well-known/core", "core.links", "The list of resources", Show::Links, links, false),
        PathRow { actions: old_words, ..old_items },
    ]
}

/// Returns the content formats of a form. Clients that cannot accept a picture format get plain bytes.
const fn formats_of(form: Form) -> &'static [Format] {
    match form {
        Form::Json => &[Format::JSON],
        Form::Cbor => &[Format::CBOR],
        Form::Text => &[Format::TEXT],
        Form::Senml => &[Format::SENML_JSON],
        Form::Picture => &[Format::PNG, Format::BYTES],
    }
}

/// Adds the commands of the common table. A command is added to the row with the same path, or gets a row of its own.
/// Rows whose path contains `{id}` come before the others.
fn with_commands(mut rows: Vec<PathRow>) -> Vec<PathRow> {
    let (of_a_thing, plain): (Vec<&'static commands::CommandRow>, Vec<_>) =
        COMMANDS.iter().partition(|command| command.subject != Subject::None);
    for command in of_a_thing.into_iter().chain(plain) {
        let action = Action::Command(command.kind);
        let actions = match command.methods {
            Methods::Post => vec![(Method::Post, action)],
            Methods::PostOrPut | Methods::Put => vec![(Method::Put, action), (Method::Post, action)],
        };
        match rows.iter_mut().find(|row| row.path == command.path) {
            Some(row) => row.actions = actions,
            None => {
                let title = command.title[..1].to_uppercase() + &command.title[1..];
                rows.push(PathRow { path: command.path, rt: command.name.to_ascii_lowercase(), title, shows: None, actions });
            }
        }
    }
    rows
}

fn shown(path: &'static str, rt: &str, title: &str, show: Show, formats: Vec<Format>, is_observable: bool) -> PathRow {
    let shows = Some(Representations { show, formats, is_observable });
    PathRow { path, rt: rt.to_owned(), title: title.to_owned(), shows, actions: Vec::new() }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
