//! What was asked, refused and caused: in the journal a code with its fields, in an exported line the sentence of today. Which codes there
//! are stands in `asked`, `refused` and `causes`; how sentences of earlier versions are read, in `earlier`.

use std::fmt::Display;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Unparsed;
use crate::api::fields::in_short;

/// For whom a fact is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// For the journal.
    Codes,
    /// For export.
    Sentences,
}

/// A value as the journal keeps it.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Coded {
    pub(super) code: String,
    /// Which there are follows from the code; one that is absent says nothing.
    #[serde(flatten)]
    pub(super) fields: Map<String, Value>,
}

/// A value as it is written.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Written {
    Sentence(String),
    Coded(Coded),
}

/// What has a code and a sentence.
pub(super) trait Valued: Display + Sized {
    fn coded(&self) -> Coded;

    fn value(coded: &Coded) -> Result<Self, Unparsed>;

    /// The code and the fields of a sentence that an earlier version wrote.
    fn earlier(sentence: &str) -> Option<Coded>;

    /// A sentence of which nothing is known.
    fn words(words: String) -> Self;
}

impl Coded {
    /// A code with these fields, an object; those that are null are left out.
    pub(super) fn new(code: &str, fields: Value) -> Coded {
        let Value::Object(mut fields) = fields else { return Coded { code: code.to_owned(), fields: Map::new() } };
        fields.retain(|_, field| !field.is_null());
        Coded { code: code.to_owned(), fields }
    }

    /// A code that says everything.
    pub(super) fn bare(code: &str) -> Coded {
        Coded::new(code, Value::Null)
    }

    /// The same as one object.
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

impl Written {
    pub(super) fn of(value: &impl Valued, form: Form) -> Written {
        match form {
            Form::Codes => Written::Coded(value.coded()),
            Form::Sentences => Written::Sentence(value.to_string()),
        }
    }

    pub(super) fn value<T: Valued>(self) -> Result<T, Unparsed> {
        match self {
            Written::Coded(coded) => T::value(&coded),
            Written::Sentence(words) => {
                let read = T::earlier(&words).and_then(|coded| T::value(&coded).ok());
                Ok(read.unwrap_or_else(|| T::words(words)))
            }
        }
    }
}
