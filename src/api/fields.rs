//! Reads the fields of a command's body one by one. Every failure is a sentence that names the field, the value and
//! what is expected. JSON is read here, CBOR in `cbor`. The fields of each command are in `command`.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;

/// Number of characters of a client's input that an error repeats. They are enough to recognise the input.
const ECHO: usize = 40;

/// Why a well-formed request cannot be used, as a sentence that also says what to send.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unusable(pub(super) String);

impl Unusable {
    pub(super) const fn new(words: String) -> Unusable {
        Unusable(words)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// The body is not valid in its format.
    Malformed(String),
    /// The body is valid in its format, but this command does not accept it.
    Unusable(Unusable),
}

pub trait Body: Sized {
    const FIELDS: &'static [&'static str];

    fn taken(fields: &BodyFields) -> Result<Self, Unusable>;
}

/// The fields of one body. Each name occurs only once.
#[derive(Debug, Default)]
pub struct BodyFields {
    left: BTreeMap<String, Value>,
    /// Names of the fields that `aside` has removed. Sentences that list all fields of a body contain these names as
    /// well.
    aside: Vec<&'static str>,
}

pub fn body<T: Body>(bytes: &[u8]) -> Result<T, Unread> {
    fields(bytes)?.read().map_err(Unread::Unusable)
}

/// Reads the fields of a JSON body, for doors whose bodies have more fields than the command itself.
pub fn fields(bytes: &[u8]) -> Result<BodyFields, Unread> {
    let no_json = |error: serde_json::Error| Unread::Malformed(format!("the body is not JSON: {error}"));
    serde_json::from_slice::<IgnoredAny>(bytes).map_err(no_json)?;
    serde_json::from_slice(bytes)
        .map_err(|error| if error.is_data() { Unread::Unusable(not_an_object(bytes, &error)) } else { no_json(error) })
}

impl BodyFields {
    pub fn text(&self, name: &str) -> Result<Option<String>, Unusable> {
        self.field(name, "a text in quotes", |value| value.as_str().map(str::to_owned))
    }

    pub fn texts(&self, name: &str) -> Result<Option<Vec<String>>, Unusable> {
        let texts = |value: &Value| value.as_array()?.iter().map(|text| text.as_str().map(str::to_owned)).collect();
        self.field(name, "a list of texts in quotes", texts)
    }

    pub fn whole(&self, name: &str) -> Result<Option<i64>, Unusable> {
        self.field(name, "a whole number, such as 3", integer)
    }

    pub fn count(&self, name: &str) -> Result<Option<u64>, Unusable> {
        self.field(name, "a whole number from 0", integer)
    }

    pub fn number(&self, name: &str) -> Result<Option<f64>, Unusable> {
        self.field(name, "a number, such as 21.5", Value::as_f64)
    }

    /// Removes a field that does not belong to the command, and returns its value as read by `read`. The command is
    /// read from the other fields.
    pub fn aside<T>(
        &mut self,
        name: &'static str,
        read: impl Fn(&BodyFields, &str) -> Result<T, Unusable>,
    ) -> Result<T, Unusable> {
        let taken = read(self, name);
        self.left.remove(name);
        self.aside.push(name);
        taken
    }

    pub(super) fn put(&mut self, name: String, value: Value) -> Result<(), Unusable> {
        if self.left.contains_key(&name) {
            return Err(Unusable(format!("`{}` occurs twice: send it once", in_short(&name))));
        }
        self.left.insert(name, value);
        Ok(())
    }

    pub fn read<T: Body>(&self) -> Result<T, Unusable> {
        self.only(T::FIELDS).and_then(|()| T::taken(self))
    }

    pub(super) fn field<T>(&self, name: &str, kind: &str, read: impl Fn(&Value) -> Option<T>) -> Result<Option<T>, Unusable> {
        let there = self.left.get(name).filter(|value| !value.is_null());
        let wrong = |value: &Value| Unusable(format!("`{name}` is {}: send {kind}", in_short(&value.to_string())));
        there.map(|value| read(value).ok_or_else(|| wrong(value))).transpose()
    }

    fn only(&self, known: &[&str]) -> Result<(), Unusable> {
        let Some(unknown) = self.left.keys().find(|name| !known.contains(&name.as_str())) else { return Ok(()) };
        let known = [known, &self.aside].concat();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Err(Unusable(format!("this command has no field `{}`: its fields are {known}", in_short(unknown))))
    }
}

/// Reads a whole number, also in a form such as `3.0`; `None` if it cannot be read exactly.
fn integer<N: FromStr>(value: &Value) -> Option<N> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let number = value.as_number()?;
    let whole = || number.as_f64().filter(|number| number.abs() < EXACT)?.to_string().parse().ok();
    number.to_string().parse().ok().or_else(whole)
}

pub fn needed<T>(value: Option<T>, name: &str, example: &str) -> Result<T, Unusable> {
    value.ok_or_else(|| Unusable(format!("`{name}` is missing: send {example}")))
}

/// Shortens a client's input so that an error can repeat it.
pub fn in_short(text: &str) -> String {
    let mut short: String = text.chars().take(ECHO).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

fn not_an_object(bytes: &[u8], error: &serde_json::Error) -> Unusable {
    let kind = match bytes.iter().find(|byte| !byte.is_ascii_whitespace()) {
        Some(b'{') => return Unusable(error.to_string()),
        Some(b'[') => "a list",
        Some(b'"') => "a text",
        Some(b't' | b'f') => "true or false",
        Some(b'n') => "null",
        _ => "a number",
    };
    Unusable(format!("the body is {kind}: send a JSON object, as {{}}, with the fields of this command"))
}

impl<'de> Deserialize<'de> for BodyFields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<BodyFields, D::Error> {
        deserializer.deserialize_map(FieldsVisitor)
    }
}

struct FieldsVisitor;

impl<'de> Visitor<'de> for FieldsVisitor {
    type Value = BodyFields;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON object")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<BodyFields, M::Error> {
        let mut fields = BodyFields::default();
        while let Some((name, value)) = map.next_entry::<String, Value>()? {
            fields.put(name, value).map_err(M::Error::custom)?;
        }
        Ok(fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Both;

    impl Body for Both {
        const FIELDS: &'static [&'static str] = &["text", "number"];

        fn taken(fields: &BodyFields) -> Result<Both, Unusable> {
            fields.text("text")?;
            fields.number("number")?;
            fields.whole("number")?;
            Ok(Both)
        }
    }

    fn refused(json: &str) -> String {
        match body::<Both>(json.as_bytes()) {
            Ok(_) => panic!("{json} was taken"),
            Err(Unread::Malformed(words)) => words,
            Err(Unread::Unusable(unusable)) => unusable.to_string(),
        }
    }

    #[test]
    fn what_is_wrong_is_said_without_the_words_of_a_programming_language() {
        let cases = [
            (r#"["w"]"#, "the body is a list"),
            ("\"w\"", "the body is a text"),
            ("3", "the body is a number"),
            ("null", "the body is null"),
            (r#"{"text":1}"#, "`text` is 1: send a text in quotes"),
            (r#"{"number":"hot"}"#, "`number` is \"hot\": send a number, such as 21.5"),
            (r#"{"number":1.5}"#, "`number` is 1.5: send a whole number, such as 3"),
            (r#"{"text":"a","text":"b"}"#, "`text` occurs twice"),
            (r#"{"txt":"a"}"#, "no field `txt`: its fields are text, number"),
            (r#"{"text":"#, "the body is not JSON"),
        ];
        for (json, words) in cases {
            let said = refused(json);
            assert!(said.contains(words), "{json}: {said}");
            for jargon in ["struct", "i64", "f64", "u64", "invalid type", "expected"] {
                assert!(!said.contains(jargon), "{json}: {said}");
            }
        }
    }

    #[test]
    fn null_means_absent_and_absent_is_no_mistake() {
        assert!(body::<Both>(br#"{"text":null}"#).is_ok() && body::<Both>(b" {} ").is_ok());
    }

    #[test]
    fn what_is_laid_aside_is_no_field_of_the_body_and_still_one_that_may_be_sent() {
        let read = |json: &str| {
            let mut fields = fields(json.as_bytes()).unwrap();
            (fields.aside("id", BodyFields::text), fields.read::<Both>().map(|_| ()))
        };
        assert_eq!(read(r#"{"id":"a-7","number":3}"#), (Ok(Some("a-7".to_owned())), Ok(())));
        assert_eq!(read(r#"{"number":3}"#), (Ok(None), Ok(())));
        let (id, body) = read(r#"{"id":7,"nummer":3}"#);
        assert_eq!(id.unwrap_err().to_string(), "`id` is 7: send a text in quotes");
        assert!(body.unwrap_err().to_string().contains("no field `nummer`: its fields are text, number, id"));
    }

    #[test]
    fn what_is_absurdly_long_is_not_repeated_at_full_length() {
        assert!(refused(&format!("{{\"text\":{}}}", "9".repeat(300))).len() < 150);
        assert!(refused(&format!("{{\"{}\":1}}", "x".repeat(9000))).len() < 200);
        assert_eq!(in_short("short"), "short");
        assert_eq!(in_short(&"ü".repeat(50)).chars().count(), ECHO + 1);
    }
}
