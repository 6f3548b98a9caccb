//! What every door says when it does not do what it was asked: one problem, which each door writes in its own form, with a status or a
//! code of its own. Start at `Problem::refused` for the core's refusals; the other constructors are for what never reached the core.
//! Those that only one door has stand there.

use std::sync::Arc;

use crate::api::fields::{Unread, Unusable};
use crate::api::luggage::LuggageJson;
use crate::api::problem::{self, ProblemCode, ProblemJson, ProblemKind};
use crate::runtime::archive::Unreadable;
use crate::runtime::carry_out::NotDone;
use crate::runtime::handle::Gone;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Refusal, Refused};
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Luggage, NoPhoto};

/// What was not done, and why.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    kind: ProblemKind,
    code: &'static str,
    detail: String,
    /// The refusal of the core that the detail is the sentence of.
    refused: Option<Refused>,
    luggage: Option<Arc<Luggage>>,
    /// What was asked for, where it is known better than by method and path.
    asked: Option<Asked>,
    /// Whether it concerns what the sender asked for and the core has not put it on record.
    is_for_record: bool,
}

impl Problem {
    pub(super) const fn new((code, kind): ProblemCode, detail: String) -> Problem {
        Problem { kind, code, detail, refused: None, luggage: None, asked: None, is_for_record: true }
    }

    /// What a door refuses in the core's words, which is not on record yet.
    pub(super) fn refused(refused: &Refused) -> Problem {
        Problem::new((refused.code(), refused.kind().into()), String::new()).with(refused.clone())
    }

    /// The same in the words of a refusal of the core.
    fn with(self, refused: Refused) -> Problem {
        Problem { detail: refused.to_string(), refused: Some(refused), ..self }
    }

    /// The same of something that can be named better than by method and path.
    pub(super) fn of(self, asked: Asked) -> Problem {
        Problem { asked: Some(asked), ..self }
    }

    /// The same, with other words.
    pub(super) fn saying(self, detail: String) -> Problem {
        Problem { detail, refused: None, ..self }
    }

    /// The same, which is nothing that its sender did wrong.
    pub(super) fn off_record(self) -> Problem {
        Problem { is_for_record: false, ..self }
    }

    /// What was sent cannot be read.
    pub(super) const fn malformed(detail: String) -> Problem {
        Problem::new(problem::MALFORMED, detail)
    }

    /// It can be read, and asks for something that does not exist.
    pub(super) const fn unusable(detail: String) -> Problem {
        Problem::new(problem::UNUSABLE, detail)
    }

    pub(super) const fn not_found(detail: String) -> Problem {
        Problem::new(problem::NOT_FOUND, detail)
    }

    pub(super) fn no_luggage(number: u64) -> Problem {
        Problem::not_found(String::new()).with(Refused::UnknownLuggage(LuggageId(number)))
    }

    /// What is there does not answer this method.
    pub(super) const fn no_method(detail: String) -> Problem {
        Problem::new(problem::NO_SUCH_METHOD, detail)
    }

    /// It is not there in a format that is wanted.
    pub(super) const fn not_acceptable(detail: String) -> Problem {
        Problem::new(problem::NOT_ACCEPTABLE, detail)
    }

    /// It is larger than any command.
    pub(super) const fn too_large(detail: String) -> Problem {
        Problem::new(problem::TOO_LARGE, detail)
    }

    /// A body in this format is not read here.
    pub(super) const fn wrong_format(detail: String) -> Problem {
        Problem::new(problem::UNSUPPORTED_FORMAT, detail)
    }

    /// The program is ending.
    pub(super) fn closing() -> Problem {
        Problem::new(("shuttingDown", ProblemKind::Unavailable), Gone.to_string()).off_record()
    }

    pub(super) const fn kind(&self) -> ProblemKind {
        self.kind
    }

    /// The short word for programs.
    pub(super) const fn code(&self) -> &'static str {
        self.code
    }

    /// The sentence a person reads.
    pub(super) fn detail(&self) -> &str {
        &self.detail
    }

    /// The refusal of the core of which the detail is the sentence.
    pub(super) const fn of_core(&self) -> Option<&Refused> {
        self.refused.as_ref()
    }

    pub(super) fn asked(&self) -> Option<Asked> {
        self.asked.clone()
    }

    /// Whether it is the door that has to put it on record.
    pub(super) const fn is_for_record(&self) -> bool {
        self.is_for_record
    }

    /// As records keep it.
    pub(super) fn for_record(&self) -> Refused {
        let own = || Refusal { code: self.code, kind: self.kind.refusal_kind(), words: self.detail.clone() };
        let of_core = self.refused.clone().filter(|refused| refused.code() == self.code);
        of_core.unwrap_or_else(|| Refused::InWords(own()))
    }

    /// As programs read it.
    pub(super) fn shape(&self) -> ProblemJson<'_> {
        let luggage = self.luggage.as_ref().map(|piece| LuggageJson::from(&**piece));
        ProblemJson { luggage, ..ProblemJson::new((self.code, self.kind), &self.detail) }
    }
}

impl From<NotDone> for Problem {
    /// The core has put on record what it refused.
    fn from(not_done: NotDone) -> Problem {
        match not_done {
            NotDone::Refused(refused, luggage) => Problem { luggage, ..Problem::refused(&refused).off_record() },
            NotDone::Gone => Problem::closing(),
        }
    }
}

impl From<NoPhoto> for Problem {
    fn from(none: NoPhoto) -> Problem {
        Problem::not_found(none.to_string())
    }
}

impl From<Unreadable> for Problem {
    fn from(unreadable: Unreadable) -> Problem {
        Problem::new(("unreadable", ProblemKind::Unavailable), unreadable.to_string()).off_record()
    }
}

impl From<Unusable> for Problem {
    fn from(unusable: Unusable) -> Problem {
        Problem::unusable(unusable.to_string())
    }
}

impl From<Unread> for Problem {
    fn from(unread: Unread) -> Problem {
        match unread {
            Unread::Malformed(words) => Problem::malformed(words),
            Unread::Unusable(unusable) => unusable.into(),
        }
    }
}
