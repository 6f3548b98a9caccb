//! Requests, refusals and causes: codes with fields in the journal, sentences of this version in exported lines. `asked`,
//! `refused` and `causes` have the codes; `earlier` reads sentences of earlier versions.

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
    /// The fields depend on the code; an absent field has no value.
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

    /// Code and fields of a sentence that an earlier version wrote.
    fn earlier(sentence: &str) -> Option<Coded>;

    /// The value for a sentence that no version wrote.
    fn words(words: String) -> Self;
}

impl Coded {
    /// Null fields are left out.
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
