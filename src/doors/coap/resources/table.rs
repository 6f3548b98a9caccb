//! THE TABLE of this door: every path with what it shows, in which formats, whether that can be observed, and what it can be asked
//! to do. Routing, the answer to a wrong method, `/.well-known/core` and the table in `docs/coap.md` are walks over it; what is not
//! listed is not there. Every resource of `Resource::ALL` has its row.

use super::actions::Action;
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
    pub(super) rt: &'static str,
    /// The same for people.
    pub(super) title: &'static str,
    /// What a GET shows.
    pub(super) shows: Option<Shown>,
    /// What it can be asked to do.
    pub(super) actions: &'static [(Method, Action)],
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
        Table { rows: [looking(), resources, of_a_piece(), commands()].into_iter().flatten().collect() }
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
    use Method::{Post, Put};
    vec![
        shown("/.well-known/core", "core.links", "What is here", Show::Links, &[Format::LINKS], false, &[]),
        shown("/resourcemodel", "resourcemodel", "The model as old clients know it", Show::OldItems, &[Format::TEXT], true,
            &[(Put, Action::OldWord), (Post, Action::OldWord)]),
        shown("/state", "state", "Everything at one revision", Show::State, SHAPES, true, &[]),
        shown("/strategy", "strategy", "The order of the search", Show::Strategy, WITH_TEXT, true,
            &[(Put, Action::Strategy), (Post, Action::Strategy)]),
    ]
}

/// The row of a resource; a new one does not compile until it has one.
fn resource(resource: Resource) -> Row {
    const TEMPERATURE: &[(Method, Action)] = &[(Method::Put, Action::Temperature), (Method::Post, Action::Temperature)];
    let (title, offers, actions): (_, _, &'static [(Method, Action)]) = match resource {
        Resource::Mission => ("Phase, holds, goal and progress", WITH_TEXT, &[]),
        Resource::Robot => ("What the robot does, and where", MEASURED, &[]),
        Resource::Map => ("The hall as far as it is known", WITH_TEXT, &[]),
        Resource::Luggage => ("The luggage of this mission", SHAPES, &[]),
        Resource::Temperature => ("The temperature, and what follows", MEASURED, TEMPERATURE),
        Resource::Alarms => ("The alarms", SHAPES, &[]),
        Resource::Log => ("The latest lines of the log", SHAPES, &[]),
    };
    shown(&format!("/{}", resource.name()), resource.name(), title, Show::Of(resource), offers, true, actions)
}

/// What belongs to a numbered thing.
#[rustfmt::skip]
fn of_a_piece() -> Vec<Row> {
    use Method::{Post, Put};
    vec![
        shown("/luggage/{id}", "piece", "A piece of luggage", Show::Piece, SHAPES, true, &[]),
        shown("/luggage/{id}/photo", "photo", "Its photo", Show::Photo, PICTURE, false, &[(Post, Action::Retake)]),
        done("/luggage/{id}/verdict", "verdict", "Safe or danger", &[(Put, Action::Verdict), (Post, Action::Verdict)]),
        done("/alarms/{id}/acknowledge", "acknowledge", "The alarm was seen", &[(Post, Action::Acknowledge)]),
    ]
}

#[rustfmt::skip]
fn commands() -> Vec<Row> {
    vec![
        done("/commands/start", "start", "Begin, or go on", &[(Method::Post, Action::Start)]),
        done("/commands/stop", "stop", "Halt the robot", &[(Method::Post, Action::Stop)]),
        done("/commands/backHome", "backhome", "Go home and wait", &[(Method::Post, Action::BackHome)]),
        done("/commands/retrieve", "retrieve", "Fetch the dangerous piece", &[(Method::Post, Action::Retrieve)]),
        done("/commands/reset", "reset", "Put the mission away", &[(Method::Post, Action::Reset)]),
        done("/commands/move", "move", "One move by hand", &[(Method::Post, Action::Move)]),
        done("/commands/goto", "goto", "Drive to a cell", &[(Method::Post, Action::Goto)]),
    ]
}

fn shown(
    path: &str,
    rt: &'static str,
    title: &'static str,
    show: Show,
    offers: &'static [Format],
    is_observable: bool,
    actions: &'static [(Method, Action)],
) -> Row {
    Row { path: path.to_owned(), rt, title, shows: Some(Shown { show, offers, is_observable }), actions }
}

fn done(path: &str, rt: &'static str, title: &'static str, actions: &'static [(Method, Action)]) -> Row {
    Row { path: path.to_owned(), rt, title, shows: None, actions }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
