//! Every refusal and error of this door: the one table from refusals to response codes, and the three forms in which one is sent.
//! Start at `Problem::refused` for the core's refusals; the other constructors are for requests that never reached it.

use std::sync::Arc;

use super::super::application::HALTED;
use super::shows;
use super::table::Row;
use crate::api::concise_problem;
use crate::api::fields::{Unread, Unusable, in_short};
use crate::api::problem::ProblemJson;
use crate::runtime::archive::Unreadable;
use crate::runtime::carry_out::NotDone;
use crate::runtime::handle::Gone;
use coap_endpoint::{Code, Format, Method, Request, Response};
use hallsweep_core::command::{Refusal, RefusalKind, Refused};
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Luggage, NoPhoto};

/// After so many seconds it is worth trying again when something is not available (RFC 7252, section 5.9.3.4).
const RETRY_S: u32 = 5;

/// A request that was not carried out, and why.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    code: Code,
    word: &'static str,
    kind: RefusalKind,
    detail: String,
    luggage: Option<Arc<Luggage>>,
    /// What was asked for, where it is known better than by method and path.
    asked: Option<String>,
    /// Whether it concerns what the sender asked for and the core has not put it on record.
    is_for_record: bool,
}

/// The table: which code each family of refusals gets.
pub(super) const fn code_of(kind: RefusalKind) -> Code {
    match kind {
        RefusalKind::Conflict => Code::CONFLICT,
        RefusalKind::Unknown => Code::NOT_FOUND,
        RefusalKind::Unavailable => Code::UNAVAILABLE,
        RefusalKind::Mismatch => Code::UNPROCESSABLE,
        RefusalKind::Forbidden => Code::FORBIDDEN,
    }
}

impl Problem {
    /// A refusal that is not on record yet, or the core's own, which is; `luggage` is the record the refused command was about.
    pub(super) fn refused(refused: &Refused, luggage: Option<Arc<Luggage>>) -> Problem {
        let problem = Problem::new(code_of(refused.kind()), refused.code(), refused.kind(), refused.to_string());
        Problem { luggage, ..problem }
    }

    /// The same, of something that can be named better than by method and path.
    pub(super) fn of(self, asked: String) -> Problem {
        Problem { asked: Some(asked), ..self }
    }

    /// 4.00: what was sent cannot be read.
    pub(super) fn malformed(detail: String) -> Problem {
        Problem::new(Code::BAD_REQUEST, "malformed", RefusalKind::Mismatch, detail)
    }

    /// 4.04: there is no such thing.
    pub(super) fn not_found(detail: String) -> Problem {
        Problem::new(Code::NOT_FOUND, "notFound", RefusalKind::Unknown, detail)
    }

    /// 4.04: no path of the table is this one.
    pub(super) fn nothing_at(request: &Request) -> Problem {
        let path = request.path_text();
        Problem::not_found(format!("there is nothing at {}: GET /.well-known/core lists what there is", in_short(&path)))
    }

    /// 4.04: there is no such piece.
    pub(super) fn no_luggage(number: u64) -> Problem {
        Problem::not_found(Refused::UnknownLuggage(LuggageId(number)).to_string())
    }

    /// 4.05: what is there cannot be asked to do this.
    pub(super) fn no_method(request: &Request, row: &Row) -> Problem {
        let methods: Vec<&str> = row.methods().map(Method::name).collect();
        let detail = format!("{} does not answer {}: it answers {}", row.path, request.method.name(), methods.join(", "));
        Problem::new(Code::METHOD_NOT_ALLOWED, "methodNotAllowed", RefusalKind::Mismatch, detail)
    }

    /// 4.06: it is not there in the format that is wanted.
    pub(super) fn not_acceptable(said: &Response) -> Problem {
        Problem::new(said.code, "notAcceptable", RefusalKind::Mismatch, words(said))
    }

    /// 4.12: a condition is not met.
    pub(super) fn condition(said: &Response) -> Problem {
        Problem::new(said.code, "preconditionFailed", RefusalKind::Mismatch, words(said))
    }

    /// 4.15: a body in this format is not read here.
    pub(super) fn wrong_format(detail: String) -> Problem {
        Problem::new(Code::UNSUPPORTED_FORMAT, "unsupportedMediaType", RefusalKind::Mismatch, detail)
    }

    /// The same of a STOP: whoever reads it must not think that nothing has halted.
    pub(super) fn although_halted(self) -> Problem {
        Problem { detail: format!("{HALTED}; {}", self.detail), ..self }
    }

    /// The sentence a person reads.
    pub(super) fn detail(&self) -> &str {
        &self.detail
    }

    /// What was asked for, where it is known better than by method and path.
    pub(super) fn asked(&self) -> Option<String> {
        self.asked.clone()
    }

    /// Whether it is the door that has to put it on record.
    pub(super) const fn is_for_record(&self) -> bool {
        self.is_for_record
    }

    /// As records keep it.
    pub(super) fn refusal(&self) -> Refusal {
        Refusal { code: self.word, kind: self.kind, words: self.detail.clone() }
    }

    /// What the sender of this request is told: in JSON or in CBOR when that is what it accepts, else as a text, which begins
    /// with `refused: ` when it asked for a change, because some clients show nothing else.
    pub(super) fn response(&self, request: &Request) -> Response {
        let max_age = (self.code == Code::UNAVAILABLE).then_some(RETRY_S);
        let in_format = |format, body: Vec<u8>| Response { format: Some(format), body: body.into(), ..Response::new(self.code) };
        let response = match request.accept {
            Some(Format::JSON) => in_format(Format::JSON, self.json()),
            Some(Format::CBOR | Format::PROBLEM) => {
                in_format(Format::PROBLEM, concise_problem::written(&self.shape(), self.code.0))
            }
            _ if request.method == Method::Get => Response::refusal(self.code, self.detail.clone()),
            _ => Response::refusal(self.code, format!("refused: {}", self.detail)),
        };
        Response { max_age, ..response }
    }

    fn json(&self) -> Vec<u8> {
        serde_json::to_vec(&self.shape()).expect("a problem is strings and numbers, which JSON can hold")
    }

    fn shape(&self) -> ProblemJson {
        let status = u16::from(self.code.class()) * 100 + u16::from(self.code.detail());
        let mut shape = ProblemJson::new(status, title(self.code), self.word, self.detail.clone());
        shape.luggage = self.luggage.as_ref().map(|piece| shows::piece(piece));
        shape
    }

    fn new(code: Code, word: &'static str, kind: RefusalKind, detail: String) -> Problem {
        Problem { code, word, kind, detail, luggage: None, asked: None, is_for_record: true }
    }
}

impl From<NotDone> for Problem {
    fn from(not_done: NotDone) -> Problem {
        let problem = match not_done {
            NotDone::Refused(refused, luggage) => Problem::refused(&refused, luggage),
            NotDone::Gone => Problem::new(Code::UNAVAILABLE, "shuttingDown", RefusalKind::Unavailable, Gone.to_string()),
        };
        Problem { is_for_record: false, ..problem }
    }
}

impl From<NoPhoto> for Problem {
    fn from(none: NoPhoto) -> Problem {
        Problem::not_found(none.to_string())
    }
}

impl From<Unreadable> for Problem {
    fn from(unreadable: Unreadable) -> Problem {
        let problem = Problem::new(Code::UNAVAILABLE, "unreadable", RefusalKind::Unavailable, unreadable.to_string());
        Problem { is_for_record: false, ..problem }
    }
}

impl From<Unusable> for Problem {
    fn from(unusable: Unusable) -> Problem {
        Problem::new(Code::UNPROCESSABLE, "unusable", RefusalKind::Mismatch, unusable.to_string())
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

fn words(said: &Response) -> String {
    String::from_utf8_lossy(&said.body).into_owned()
}

/// A code in words (RFC 7252, section 12.1.2, and RFC 8132).
fn title(code: Code) -> &'static str {
    match code {
        Code::BAD_REQUEST => "Bad Request",
        Code::FORBIDDEN => "Forbidden",
        Code::NOT_FOUND => "Not Found",
        Code::METHOD_NOT_ALLOWED => "Method Not Allowed",
        Code::NOT_ACCEPTABLE => "Not Acceptable",
        Code::CONFLICT => "Conflict",
        Code::PRECONDITION_FAILED => "Precondition Failed",
        Code::UNSUPPORTED_FORMAT => "Unsupported Content-Format",
        Code::UNPROCESSABLE => "Unprocessable Entity",
        Code::UNAVAILABLE => "Service Unavailable",
        _ => "Problem",
    }
}

#[cfg(test)]
mod tests {
    use minicbor::Decoder;

    use super::super::testing::{get, post};
    use super::*;
    use crate::api::command::move_word;
    use crate::api::fixture::piece;
    use hallsweep_core::command::CODES;
    use hallsweep_core::units::Cell;

    fn moving() -> Problem {
        Problem::refused(&Refused::Moving, None)
    }

    #[test]
    fn every_refusal_there_is_has_the_code_of_its_family() {
        for (word, kind) in CODES {
            let refused = Refused::Before(Refusal { code: word, kind, words: "a sentence".to_owned() });
            let problem = Problem::refused(&refused, None);
            let expected = match word {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" => "4.04",
                "storeDown" | "notKept" => "5.03",
                "otherContent" => "4.22",
                "notAllowed" => "4.03",
                _ => "4.09",
            };
            assert_eq!((problem.code.to_string().as_str(), problem.word), (expected, word));
            assert_ne!(title(problem.code), "Problem");
            let (class, detail) = expected.split_once('.').unwrap();
            assert_eq!(problem.shape().status.to_string(), format!("{class}{detail}"));
        }
    }

    /// What this door refused is read back from the journal as it was written.
    #[test]
    fn what_the_door_refuses_is_known_again_after_a_restart() {
        let words = || "a sentence".to_owned();
        let said = |code| Response::refusal(code, words());
        let row = &super::super::table::Table::default().rows[0];
        for problem in [
            Problem::malformed(words()),
            move_word("q").unwrap_err().into(),
            Problem::not_found(words()),
            Problem::wrong_format(words()),
            Problem::not_acceptable(&said(Code::NOT_ACCEPTABLE)),
            Problem::condition(&said(Code::PRECONDITION_FAILED)),
            Problem::no_method(&post("/state", ""), row),
            Problem::refused(&Refused::NotAllowed(words()), None),
        ] {
            let refusal = problem.refusal();
            assert_eq!(Refusal::named(refusal.code, refusal.words.clone()), refusal);
            assert_ne!(title(problem.code), "Problem");
        }
    }

    #[test]
    fn a_refusal_is_a_sentence_unless_a_form_for_programs_is_accepted() {
        let plain = moving().response(&post("/commands/start", ""));
        assert_eq!((plain.code, plain.format), (Code::CONFLICT, None));
        assert_eq!(&*plain.body, b"refused: the robot is moving: press STOP first");
        let looked = Problem::no_luggage(9).response(&get("/luggage/9"));
        assert_eq!(&*looked.body, b"there is no luggage #9");
    }

    #[test]
    fn a_refusal_in_json_is_the_problem_of_the_other_doors() {
        let request = Request { accept: Some(Format::JSON), ..post("/commands/start", "") };
        let response = moving().response(&request);
        assert_eq!(response.format, Some(Format::JSON));
        let json: serde_json::Value = serde_json::from_slice(&response.body).unwrap();
        assert_eq!((&json["status"], &json["code"], &json["accepted"]), (&409.into(), &"moving".into(), &false.into()));
        assert_eq!(json["type"], "urn:hallsweep:problem:moving");
        let with_record = Problem::refused(&Refused::Moving, Some(piece(3, Cell::new(3, 2), None))).response(&request);
        let json: serde_json::Value = serde_json::from_slice(&with_record.body).unwrap();
        assert_eq!(json["luggage"]["photo"]["url"], "/luggage/3/photo");
    }

    #[test]
    fn a_refusal_in_cbor_is_a_concise_problem() {
        for accept in [Format::CBOR, Format::PROBLEM] {
            let response = moving().response(&Request { accept: Some(accept), ..post("/commands/start", "") });
            assert_eq!(response.format, Some(Format::PROBLEM));
            let mut decoder = Decoder::new(&response.body);
            assert_eq!((decoder.map().unwrap(), decoder.i8().unwrap(), decoder.u8().unwrap()), (Some(4), -4, 0x89));
        }
    }

    #[test]
    fn what_is_not_available_says_when_to_try_again() {
        let response = Problem::refused(&Refused::StoreDown, None).response(&post("/commands/start", ""));
        assert_eq!((response.code, response.max_age), (Code::UNAVAILABLE, Some(RETRY_S)));
    }
}
