//! Writes problems for this door: their response codes, and the three formats. Problems that exist only at this door
//! are here, too.

use super::super::application::HALTED;
use super::shows;
use super::table::PathRow;
use crate::api::concise_problem;
use crate::api::fields::in_short;
use crate::api::problem::{CONDITION_FAILED, ProblemJson, ProblemKind};
use crate::api::resources::{self, Form};
pub(super) use crate::doors::problem::Problem;
use coap_endpoint::{Code, Format, Method, Request, Response};

/// Seconds after which a client may retry if something is unavailable (RFC 7252, section 5.9.3.4).
const RETRY_S: u32 = 5;

impl Problem {
    pub(super) fn nothing_at(request: &Request) -> Problem {
        let path = request.path_text();
        Problem::not_found(format!("there is nothing at {}: GET /.well-known/core lists the resources", in_short(&path)))
    }

    pub(super) fn not_answered(request: &Request, row: &PathRow) -> Problem {
        let methods: Vec<&str> = row.methods().map(Method::name).collect();
        Problem::no_method(format!("{} does not accept {}: send {}", row.path, request.method.name(), methods.join(", ")))
    }

    pub(super) fn condition(said: &Response) -> Problem {
        Problem::new(CONDITION_FAILED, words(said))
    }

    /// Changes the problem of a STOP that has halted the robot: the text now says that the robot was halted.
    pub(super) fn although_halted(self) -> Problem {
        let words = format!("{HALTED}; {}", self.detail());
        self.saying(words)
    }

    /// Returns the answer to the sender, in JSON or CBOR if the sender accepts one of them, otherwise as text. Unless
    /// the request was a GET, the text begins with `refused: `, because some clients show nothing else.
    pub(super) fn response(&self, request: &Request) -> Response {
        let code = code_of(self.kind());
        let max_age = (code == Code::UNAVAILABLE).then_some(RETRY_S);
        let in_format = |format, body: Vec<u8>| Response { format: Some(format), body: body.into(), ..Response::new(code) };
        let response = match request.accept {
            Some(Format::JSON) => in_format(Format::JSON, resources::shape(Form::Json, &self.here())),
            Some(Format::CBOR | Format::PROBLEM) => in_format(Format::PROBLEM, concise_problem::written(&self.here(), code.0)),
            _ if request.method == Method::Get => Response::refusal(code, self.detail().to_owned()),
            _ => Response::refusal(code, format!("refused: {}", self.detail())),
        };
        Response { max_age, ..response }
    }

    fn here(&self) -> ProblemJson<'_> {
        let mut shape = self.shape();
        if self.kind() == ProblemKind::UnsupportedFormat {
            shape.title = "Unsupported Content-Format";
        }
        shape.luggage = shape.luggage.map(shows::at_this_door);
        shape
    }
}

/// Returns the response code of a kind of problem. If CoAP has a code with the digits of the HTTP status, that code
/// is used.
const fn code_of(kind: ProblemKind) -> Code {
    match kind {
        // `TooSlow` and `Misdirected` exist only in HTTP.
        ProblemKind::Malformed | ProblemKind::TooSlow | ProblemKind::Misdirected => Code::BAD_REQUEST,
        ProblemKind::NotSignedIn => Code::UNAUTHORIZED,
        ProblemKind::Forbidden => Code::FORBIDDEN,
        ProblemKind::NotFound => Code::NOT_FOUND,
        ProblemKind::NoSuchMethod => Code::METHOD_NOT_ALLOWED,
        ProblemKind::NotAcceptable => Code::NOT_ACCEPTABLE,
        ProblemKind::Conflict => Code::CONFLICT,
        ProblemKind::ConditionFailed => Code::PRECONDITION_FAILED,
        ProblemKind::TooLarge => Code::TOO_LARGE,
        ProblemKind::UnsupportedFormat => Code::UNSUPPORTED_FORMAT,
        ProblemKind::Unusable => Code::UNPROCESSABLE,
        ProblemKind::Internal => Code::INTERNAL,
        ProblemKind::Unavailable => Code::UNAVAILABLE,
    }
}

pub(super) fn words(said: &Response) -> String {
    String::from_utf8_lossy(&said.body).into_owned()
}

#[cfg(test)]
mod tests {
    use minicbor::Decoder;

    use super::super::testing::{get, post};
    use super::*;
    use crate::api::command::move_word;
    use crate::api::problem::refusal as named;
    use crate::api::tests::fixture::piece;
    use crate::runtime::carry_out::NotDone;
    use hallsweep_core::refused::{CODES, Refusal, Refused};
    use hallsweep_core::units::Cell;

    fn moving() -> Problem {
        Problem::refused(&Refused::Moving)
    }

    #[test]
    fn every_refusal_there_is_has_the_code_of_its_family() {
        for (word, kind) in CODES {
            let refused = Refused::InWords(Refusal { code: word, kind, words: "a sentence".to_owned() });
            let problem = Problem::refused(&refused);
            let expected = match word {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" | "unknownArea" => "4.04",
                "storeDown" | "notKept" => "5.03",
                "otherContent" => "4.22",
                "notAllowed" => "4.03",
                _ => "4.09",
            };
            assert_eq!((code_of(problem.kind()).to_string().as_str(), problem.code()), (expected, word));
            let (class, detail) = expected.split_once('.').unwrap();
            assert_eq!(problem.shape().status.to_string(), format!("{class}{detail}"));
        }
    }

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
            Problem::not_acceptable(super::words(&said(Code::NOT_ACCEPTABLE))),
            Problem::condition(&said(Code::PRECONDITION_FAILED)),
            Problem::not_answered(&post("/state", ""), row),
            Problem::refused(&Refused::NotAllowed(words())),
        ] {
            let refusal = named(problem.code(), problem.detail().to_owned());
            assert_eq!((refusal.code, refusal.kind), (problem.code(), problem.for_record().kind()));
        }
    }

    /// The codes and their names are those of RFC 7252, section 12.1.2, and RFC 8132.
    #[test]
    fn what_this_door_has_a_code_for_is_called_as_codes_are_and_its_status_has_the_same_digits() {
        let row = &super::super::table::Table::default().rows[0];
        let said = Response::refusal(Code::PRECONDITION_FAILED, "a sentence");
        let words = || "a sentence".to_owned();
        for (problem, code, title) in [
            (Problem::malformed(words()), "4.00", "Bad Request"),
            (Problem::refused(&Refused::NotAllowed(words())), "4.03", "Forbidden"),
            (Problem::not_found(words()), "4.04", "Not Found"),
            (Problem::not_answered(&post("/state", ""), row), "4.05", "Method Not Allowed"),
            (Problem::not_acceptable(words()), "4.06", "Not Acceptable"),
            (Problem::refused(&Refused::Moving), "4.09", "Conflict"),
            (Problem::condition(&said), "4.12", "Precondition Failed"),
            (Problem::wrong_format(words()), "4.15", "Unsupported Content-Format"),
            (Problem::unusable(words()), "4.22", "Unprocessable Entity"),
            (Problem::closing(), "5.03", "Service Unavailable"),
        ] {
            let request = Request { accept: Some(Format::JSON), ..post("/commands/start", "") };
            let response = problem.response(&request);
            let json: serde_json::Value = serde_json::from_slice(&response.body).unwrap();
            assert_eq!((response.code.to_string().as_str(), &json["title"]), (code, &title.into()));
            assert_eq!(json["status"].to_string(), code.replace('.', ""));
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
        let refused = NotDone::Refused(Refused::Moving, Some(piece(3, Cell::new(3, 2), None)), None);
        let with_record = Problem::from(refused).response(&request);
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
        let response = Problem::refused(&Refused::StoreDown).response(&post("/commands/start", ""));
        assert_eq!((response.code, response.max_age), (Code::UNAVAILABLE, Some(RETRY_S)));
    }
}
