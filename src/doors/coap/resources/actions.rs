//! The actions of resources: the right that each action needs, its command, and the answer when the command is
//! accepted. `Resources` sends the command to the core. The words of old clients are in `old`.

use super::problem::{Problem, words};
use super::table::Action;
use super::{old, shows};
use crate::access::Need;
use crate::api::answer::AnswerJson;
use crate::api::cbor;
use crate::api::command::no_command_id;
use crate::api::commands::{self, Payload};
use crate::api::fields::{self, Body, in_short};
use crate::api::resources;
use crate::runtime::carry_out::Done;
use coap_endpoint::{Code, Format, Request, Response};
use hallsweep_core::command::{Command, CommandId};
use hallsweep_core::units::Epoch;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Terms {
    pub(super) id: Option<CommandId>,
    /// The format of the answer. `None` if the client accepts only the format of problems; then the answer to a
    /// success has no body.
    pub(super) form: Option<Format>,
}

const ANSWERS: &[Format] = &[Format::JSON, Format::CBOR, Format::TEXT];

const ID: &str = "id";

impl Action {
    /// Returns the right that a request of this action needs. The words of old clients include STOP, so only the
    /// right to stop is checked for them.
    pub(super) fn need(self) -> Need {
        match self {
            Action::Command(kind) => kind.row().need,
            Action::OldWord => Need::Stop,
        }
    }

    const fn answers(self) -> &'static [Format] {
        if matches!(self, Action::OldWord) { &[Format::TEXT] } else { ANSWERS }
    }
}

impl Terms {
    pub(super) fn plain(act: Action) -> Terms {
        Terms { id: None, form: act.answers().first().copied() }
    }
}

/// Returns the command of a request, and the epoch that its sender saw. A STOP never comes here: `stop` handles it
/// before.
pub(super) fn command(
    act: Action,
    number: u64,
    request: &Request,
    manual_driving: bool,
) -> Result<(Command, Option<Epoch>), Problem> {
    match act {
        Action::Command(kind) => commands::asked(kind, number, &CarriedRequest(request)),
        Action::OldWord => Ok((old::command(request, manual_driving)?, None)),
    }
}

struct CarriedRequest<'a>(&'a Request);

impl Payload for CarriedRequest<'_> {
    type Problem = Problem;

    fn needed<T: Body>(&self) -> Result<T, Problem> {
        let CarriedRequest(request) = self;
        if request.payload.is_empty() {
            return Err(Problem::malformed("the body is empty: this command needs JSON or CBOR, see docs/coap.md".to_owned()));
        }
        match request.format {
            None | Some(Format::JSON) => fields::body(&request.payload).map_err(Problem::from),
            Some(Format::CBOR) => cbor::body(&request.payload).map_err(Problem::from),
            Some(other) => {
                Err(Problem::wrong_format(format!("the body is in {other}: send {} or {}", Format::JSON, Format::CBOR)))
            }
        }
    }

    fn optional<T: Body + Default>(&self) -> Result<T, Problem> {
        if self.0.payload.is_empty() { Ok(T::default()) } else { self.needed() }
    }
}

/// Returns the parameters of a command. An unknown query parameter is refused, because with a misspelt `id` a
/// repeated command would act twice.
pub(super) fn terms(act: Action, request: &Request) -> Result<Terms, Problem> {
    let mut id = None;
    for query in &request.queries {
        let name = query.split_once('=').filter(|(name, _)| *name == ID).map(|(_, value)| value);
        let name = name.ok_or_else(|| {
            Problem::malformed(format!("a command has no query {:?}: send the id of the command as {ID}=NAME", in_short(query)))
        })?;
        let named = CommandId::new(name).filter(|_| id.is_none());
        id = Some(named.ok_or_else(|| Problem::malformed(no_command_id(ID, name)))?);
    }
    let form = if request.accept == Some(Format::PROBLEM) {
        None
    } else {
        Some(request.negotiated(act.answers()).map_err(|response| Problem::not_acceptable(words(&response)))?)
    };
    Ok(Terms { id, form })
}

pub(super) fn accepted(form: Option<Format>, done: &Done) -> Response {
    let Some(form) = form else { return Response::new(Code::CHANGED) };
    let body = if form == Format::TEXT {
        b"accepted".to_vec()
    } else {
        let mut answer = AnswerJson::new(done.accepted, &done.snapshot);
        answer.luggage = answer.luggage.map(shows::at_this_door);
        resources::shape(shows::form_of(form), &answer)
    };
    Response { format: Some(form), body: body.into(), ..Response::new(Code::CHANGED) }
}
