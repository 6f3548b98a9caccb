//! Why a door refuses a request. Each door writes the same problem in its own form, with its own status or code. For
//! the core's refusals use `Problem::refused`. The other constructors are for requests that never reached the core.
//! Problems of a single door are in that door.

use std::sync::Arc;

use crate::api::fields::{Unread, Unusable};
use crate::api::luggage::LuggageJson;
use crate::api::problem::{self, ProblemCode, ProblemJson, ProblemKind};
use crate::runtime::archive::Unreadable;
use crate::runtime::carry_out::NotDone;
use crate::runtime::handle::Gone;
use hallsweep_core::asked::Asked;
use hallsweep_core::hall::HallId;
use hallsweep_core::refused::{Refusal, Refused};
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Luggage, NoPhoto};

#[derive(Clone, Debug)]
pub(super) struct Problem {
    kind: ProblemKind,
    code: &'static str,
    detail: String,
    /// The refusal of the core. `None` if `detail` is not the core's sentence.
    refused: Option<Box<Refused>>,
    luggage: Option<Arc<Luggage>>,
    /// The hall of the luggage; `None` for the default hall.
    hall: Option<HallId>,
    /// The requested command, if more is known about the request than method and path.
    asked: Option<Box<Asked>>,
    /// Whether the door must record this problem. A problem that the core has recorded is not recorded again.
    is_for_record: bool,
}

impl Problem {
    pub(super) const fn new((code, kind): ProblemCode, detail: String) -> Problem {
        Problem { kind, code, detail, refused: None, luggage: None, hall: None, asked: None, is_for_record: true }
    }

    /// Refuses a request with the sentence of the core. The core has not recorded this refusal.
    pub(super) fn refused(refused: &Refused) -> Problem {
        Problem::new((refused.code(), refused.kind().into()), String::new()).with(refused.clone())
    }

    fn with(self, refused: Refused) -> Problem {
        Problem { detail: refused.to_string(), refused: Some(Box::new(refused)), ..self }
    }

    pub(super) fn of(self, asked: Asked) -> Problem {
        Problem { asked: Some(Box::new(asked)), ..self }
    }

    pub(super) fn saying(self, detail: String) -> Problem {
        Problem { detail, refused: None, ..self }
    }

    /// Marks the problem as not to be recorded by the door: the core has recorded it already, or it is no fault of
    /// the sender.
    pub(super) fn off_record(self) -> Problem {
        Problem { is_for_record: false, ..self }
    }

    pub(super) const fn malformed(detail: String) -> Problem {
        Problem::new(problem::MALFORMED, detail)
    }

    /// The request can be read, but one of its values cannot be used, such as an unknown move.
    pub(super) const fn unusable(detail: String) -> Problem {
        Problem::new(problem::UNUSABLE, detail)
    }

    pub(super) const fn not_found(detail: String) -> Problem {
        Problem::new(problem::NOT_FOUND, detail)
    }

    pub(super) fn no_luggage(number: u64) -> Problem {
        Problem::not_found(String::new()).with(Refused::UnknownLuggage(LuggageId(number)))
    }

    pub(super) const fn no_method(detail: String) -> Problem {
        Problem::new(problem::NO_SUCH_METHOD, detail)
    }

    pub(super) const fn not_acceptable(detail: String) -> Problem {
        Problem::new(problem::NOT_ACCEPTABLE, detail)
    }

    pub(super) const fn too_large(detail: String) -> Problem {
        Problem::new(problem::TOO_LARGE, detail)
    }

    pub(super) const fn wrong_format(detail: String) -> Problem {
        Problem::new(problem::UNSUPPORTED_FORMAT, detail)
    }

    pub(super) fn closing() -> Problem {
        Problem::new(("shuttingDown", ProblemKind::Unavailable), Gone.to_string()).off_record()
    }

    pub(super) const fn kind(&self) -> ProblemKind {
        self.kind
    }

    pub(super) const fn code(&self) -> &'static str {
        self.code
    }

    pub(super) fn detail(&self) -> &str {
        &self.detail
    }

    pub(super) fn of_core(&self) -> Option<&Refused> {
        self.refused.as_deref()
    }

    pub(super) fn asked(&self) -> Option<Asked> {
        self.asked.as_deref().cloned()
    }

    pub(super) const fn is_for_record(&self) -> bool {
        self.is_for_record
    }

    pub(super) fn for_record(&self) -> Refused {
        let own = || Refusal { code: self.code, kind: self.kind.refusal_kind(), words: self.detail.clone() };
        let of_core = self.of_core().filter(|refused| refused.code() == self.code).cloned();
        of_core.unwrap_or_else(|| Refused::InWords(own()))
    }

    pub(super) fn shape(&self) -> ProblemJson<'_> {
        let luggage = self.luggage.as_ref().map(|piece| LuggageJson::new(piece, self.hall.as_ref()));
        ProblemJson { luggage, ..ProblemJson::new((self.code, self.kind), &self.detail) }
    }
}

impl From<NotDone> for Problem {
    /// The core has already recorded its own refusals, so the door does not record them again.
    fn from(not_done: NotDone) -> Problem {
        match not_done {
            NotDone::Refused(refused, luggage, hall) => Problem { luggage, hall, ..Problem::refused(&refused).off_record() },
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
