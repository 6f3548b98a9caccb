//! Requests, refusals and causes. In the journal they are codes with fields; in exported lines they are sentences of
//! this version. The codes are in `asked`, `refused` and `causes`; `earlier` reads sentences of earlier versions.

use std::fmt::Display;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Unparsed;
use crate::api::fields::in_short;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Codes, for the journal.
    Codes,
    /// Sentences, for export.
    Sentences,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Coded {
    pub(super) code: String,
    /// The fields depend on the code. A field without a value is absent.
    #[serde(flatten)]
    pub(super) fields: Map<String, Value>,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum CodeOrSentence {
    Sentence(String),
    Coded(Coded),
}

pub(super) trait Valued: Display + Sized {
    fn coded(&self) -> Coded;

    fn value(coded: &Coded) -> Result<Self, Unparsed>;

    /// Returns the code and the fields for a sentence of an earlier version; `None` if no earlier version wrote the
    /// sentence.
    fn earlier(sentence: &str) -> Option<Coded>;

    /// Returns the value for a sentence that no version wrote.
    fn words(words: String) -> Self;
}

impl Coded {
    /// Makes a code with fields. Fields that are null are left out.
    pub(super) fn new(code: &str, fields: Value) -> Coded {
        let Value::Object(mut fields) = fields else { return Coded { code: code.to_owned(), fields: Map::new() } };
        fields.retain(|_, field| !field.is_null());
        Coded { code: code.to_owned(), fields }
    }

    pub(super) fn bare(code: &str) -> Coded {
        Coded::new(code, Value::Null)
    }

    pub(super) fn object(mut self) -> Value {
        self.fields.insert("code".to_owned(), self.code.into());
        self.fields.into()
    }

    pub(super) fn field<T: DeserializeOwned>(&self, name: &str) -> Result<T, Unparsed> {
        let field = self.fields.get(name).cloned().unwrap_or_default();
        serde_json::from_value(field)
            .map_err(|error| Unparsed(format!("the field {name} of {:?}: {error}", in_short(&self.code))))
    }

    pub(super) fn unknown<T>(&self) -> Result<T, Unparsed> {
        Err(Unparsed(format!("{:?} is no code that this version knows", in_short(&self.code))))
    }
}

impl CodeOrSentence {
    pub(super) fn of(value: &impl Valued, form: Form) -> CodeOrSentence {
        match form {
            Form::Codes => CodeOrSentence::Coded(value.coded()),
            Form::Sentences => CodeOrSentence::Sentence(value.to_string()),
        }
    }

    pub(super) fn value<T: Valued>(self) -> Result<T, Unparsed> {
        match self {
            CodeOrSentence::Coded(coded) => T::value(&coded),
            CodeOrSentence::Sentence(words) => {
                let read = T::earlier(&words).and_then(|coded| T::value(&coded).ok());
                Ok(read.unwrap_or_else(|| T::words(words)))
            }
        }
    }
}
