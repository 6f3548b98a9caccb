//! THE TABLE of this door: every path with what it shows, in which formats, whether that can be observed, and what it can be asked
//! to do. Routing, the answer to a wrong method, `/.well-known/core` and the table in `docs/coap.md` are walks over it; what is not
//! listed is not there. Every resource of `Resource::ALL` has its row.

use super::actions::Action;
use crate::api::commands::{self, COMMANDS, Methods, Subject};
use coap_endpoint::{Format, Method};
use hallsweep_core::world::resource::Resource;

/// Every path.
pub(super) struct Table {
    pub(super) rows: Vec<Row>,
}

/// One path.
pub(super) struct Row {
    /// As `/luggage/{id}/photo`; `{id}` stands for a number.
    pub(super) path: String,
    /// What kind of thing is there, for discovery.
    pub(super) rt: String,
    /// The same for people.
    pub(super) title: String,
    /// What a GET shows.
    pub(super) shows: Option<Shown>,
    /// What it can be asked to do.
    pub(super) actions: Vec<(Method, Action)>,
}

/// What a GET shows.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) show: Show,
    /// The first is sent to whoever names none.
    pub(super) offers: &'static [Format],
    pub(super) is_observable: bool,
}

/// Something to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Show {
    /// Everything at one revision.
    State,
    /// One resource.
    Of(Resource),
    /// The three items of old clients.
    OldItems,
    /// A piece of luggage.
    Piece,
    /// Its photo.
    Photo,
    /// The order of the search.
    Strategy,
    /// The list of all this.
    Links,
}

/// Where a path leads.
pub(super) struct Found<'a> {
    pub(super) row: &'a Row,
    /// The number in the path; 0 where there is none.
    pub(super) number: u64,
}

const SHAPES: &[Format] = &[Format::JSON, Format::CBOR];
const WITH_TEXT: &[Format] = &[Format::JSON, Format::CBOR, Format::TEXT];
const PICTURE: &[Format] = &[Format::PNG, Format::BYTES];
const MEASURED: &[Format] = &[Format::JSON, Format::CBOR, Format::TEXT, Format::SENML_JSON];

impl Default for Table {
    fn default() -> Table {
        let resources = Resource::ALL.into_iter().map(resource).collect();
        Table { rows: with_commands([looking(), resources, of_a_piece()].into_iter().flatten().collect()) }
    }
}

impl Table {
    /// The row of a path.
    pub(super) fn find(&self, path: &[String]) -> Option<Found<'_>> {
        self.rows.iter().find_map(|row| row.number(path).map(|number| Found { row, number }))
    }
}

impl Row {
    /// What it does when it is asked by this method.
    pub(super) fn action(&self, method: Method) -> Option<Action> {
        self.actions.iter().find(|(answers, _)| *answers == method).map(|(_, action)| *action)
    }

    /// The methods it answers.
    pub(super) fn methods(&self) -> impl Iterator<Item = Method> {
        self.shows.iter().map(|_| Method::Get).chain(self.actions.iter().map(|(method, _)| *method))
    }

    /// The number in a path that is this one, 0 where it has none; `None` when it is another.
    fn number(&self, path: &[String]) -> Option<u64> {
        // Every path begins with a word, and most are told apart by it.
        if !self.path[1..].starts_with(path.first()?) {
            return None;
        }
        let mut number = 0;
        let mut ours = self.path.split('/').skip(1);
        for segment in path {
            match ours.next()? {
                "{id}" => number = plain_number(segment)?,
                other if other == segment => {}
                _ => return None,
            }
        }
        ours.next().is_none().then_some(number)
    }
}

/// The number that a segment writes as we write it, so that a thing has one path: neither `+1` nor `01`.
fn plain_number(segment: &str) -> Option<u64> {
    segment.parse().ok().filter(|number: &u64| number.to_string() == segment)
}

/// What is no single resource.
#[rustfmt::skip]
fn looking() -> Vec<Row> {
    let old_words = vec![(Method::Put, Action::OldWord), (Method::Post, Action::OldWord)];
    vec![
        shown("/.well-known/core", "core.links", "What is here", Show::Links, &[Format::LINKS], false),
        Row { actions: old_words,
            ..shown("/resourcemodel", "resourcemodel", "The model as old clients know it", Show::OldItems, &[Format::TEXT], true) },
        shown("/state", "state", "Everything at one revision", Show::State, SHAPES, true),
        shown("/strategy", "strategy", "The order of the search", Show::Strategy, WITH_TEXT, true),
    ]
}

/// The row of a resource; a new one does not compile until it has one.
fn resource(resource: Resource) -> Row {
    let (title, offers) = match resource {
        Resource::Mission => ("Phase, holds, goal and progress", WITH_TEXT),
        Resource::Robot => ("What the robot does, and where", MEASURED),
        Resource::Map => ("The hall as far as it is known", WITH_TEXT),
        Resource::Luggage => ("The luggage of this mission", SHAPES),
        Resource::Temperature => ("The temperature, and what follows", MEASURED),
        Resource::Alarms => ("The alarms", SHAPES),
        Resource::Log => ("The latest lines of the log", SHAPES),
    };
    shown(&format!("/{}", resource.name()), resource.name(), title, Show::Of(resource), offers, true)
}

/// What belongs to a numbered thing.
fn of_a_piece() -> Vec<Row> {
    vec![
        shown("/luggage/{id}", "piece", "A piece of luggage", Show::Piece, SHAPES, true),
        shown("/luggage/{id}/photo", "photo", "Its photo", Show::Photo, PICTURE, false),
    ]
}

/// Puts the commands of the one table where they belong: to what is shown at their path, or into a row of their own. Those that are
/// about a numbered thing come before the others.
fn with_commands(mut rows: Vec<Row>) -> Vec<Row> {
    let (of_a_thing, plain): (Vec<&commands::Row>, Vec<_>) =
        COMMANDS.iter().partition(|command| command.subject != Subject::None);
    for command in of_a_thing.into_iter().chain(plain) {
        let action = Action::Command(command.kind);
        let actions = match command.methods {
            Methods::Post => vec![(Method::Post, action)],
            Methods::PostOrPut | Methods::Put => vec![(Method::Put, action), (Method::Post, action)],
        };
        match rows.iter_mut().find(|row| row.path == command.path) {
            Some(row) => row.actions = actions,
            None => rows.push(done(command, actions)),
        }
    }
    rows
}

fn shown(path: &str, rt: &str, title: &str, show: Show, offers: &'static [Format], is_observable: bool) -> Row {
    let shows = Some(Shown { show, offers, is_observable });
    Row { path: path.to_owned(), rt: rt.to_owned(), title: title.to_owned(), shows, actions: Vec::new() }
}

/// The row of a command at whose path nothing is shown.
fn done(command: &commands::Row, actions: Vec<(Method, Action)>) -> Row {
    let title = command.title[..1].to_uppercase() + &command.title[1..];
    Row { path: command.path.to_owned(), rt: command.name.to_ascii_lowercase(), title, shows: None, actions }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
