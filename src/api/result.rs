//! The result of a command at a door whose answers are not tied to a request. It is an answer or a problem, together
//! with the command id. `answer` and `problem` describe these two.

use serde::Serialize;

/// A result, as `{"id":"k7","accepted":true,"revision":812,"epoch":4}`. A refusal has the fields of a problem
/// together with the id.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultJson<'a, T> {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<&'a str>,
    #[serde(flatten)]
    pub said: T,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::answer::AnswerJson;
    use crate::api::problem::{ProblemJson, ProblemKind};

    #[test]
    fn a_result_has_the_fields_of_what_is_said_and_the_name() {
        let said = AnswerJson { accepted: true, revision: 812, epoch: 4, luggage: None, kept_back: false };
        let written = |id| serde_json::to_string(&ResultJson { id, said: said.clone() }).unwrap();
        assert_eq!(written(Some("k7")), r#"{"id":"k7","accepted":true,"revision":812,"epoch":4}"#);
        assert_eq!(written(None), r#"{"accepted":true,"revision":812,"epoch":4}"#);
        let said = ProblemJson::new(("moving", ProblemKind::Conflict), "the robot is moving");
        let json = serde_json::to_value(ResultJson { id: Some("k8"), said }).unwrap();
        assert_eq!((&json["id"], &json["accepted"], &json["code"]), (&"k8".into(), &false.into(), &"moving".into()));
    }
}
