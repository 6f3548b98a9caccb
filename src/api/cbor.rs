//! CBOR (RFC 8949): writes every shape of the API, and reads the bodies of commands. A body is one map without nested
//! values. A nested value is refused where it begins, so that no nesting can exhaust the stack or the memory.

use minicbor::Decoder;
use minicbor::data::Type;
use minicbor::decode::Error;
use serde::Serialize;
use serde_json::{Number, Value};

use super::fields::{Body, BodyFields, Unread, Unusable, in_short};

/// Writes a value in CBOR, with the same names and shapes as in JSON.
pub fn written(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut serializer = minicbor_serde::Serializer::new(&mut bytes);
    serializer.serialize_unit_as_null(true);
    value.serialize(&mut serializer).expect("the shapes of the wire are texts, numbers, lists and maps, which CBOR can hold");
    bytes
}

pub fn body<T: Body>(bytes: &[u8]) -> Result<T, Unread> {
    let mut decoder = Decoder::new(bytes);
    let fields = fields(&mut decoder)?;
    let rest = bytes.len() - decoder.position();
    if rest > 0 {
        return Err(Unread::Malformed(format!("the body is not one item of CBOR: {rest} bytes follow it")));
    }
    fields.read().map_err(Unread::Unusable)
}

/// Reads the fields of a body. The decoder stops at the first byte after the body.
pub(super) fn fields(decoder: &mut Decoder<'_>) -> Result<BodyFields, Unread> {
    let kind = decoder.datatype().map_err(no_cbor)?;
    if !matches!(kind, Type::Map | Type::MapIndef) {
        return Err(unusable(format!(
            "the body is {}: send a CBOR map, as {{}}, with the fields of this command",
            in_words(kind)
        )));
    }
    let mut fields = BodyFields::default();
    let mut left = decoder.map().map_err(no_cbor)?;
    while more(decoder, &mut left)? {
        let name = name(decoder)?;
        let value = value(decoder, &name)?;
        fields.put(name, value).map_err(Unread::Unusable)?;
    }
    Ok(fields)
}

/// Whether another field or value follows. At the end of a map or list of indefinite length, this also skips the break
/// byte (RFC 8949, section 3.2.2).
fn more(decoder: &mut Decoder<'_>, left: &mut Option<u64>) -> Result<bool, Unread> {
    if let Some(left) = left {
        let more = *left > 0;
        *left = left.saturating_sub(1);
        return Ok(more);
    }
    let ends = decoder.datatype().map_err(no_cbor)? == Type::Break;
    if ends {
        decoder.set_position(decoder.position() + 1);
    }
    Ok(!ends)
}

fn name(decoder: &mut Decoder<'_>) -> Result<String, Unread> {
    let kind = decoder.datatype().map_err(no_cbor)?;
    if matches!(kind, Type::String | Type::StringIndef) {
        return text(decoder);
    }
    Err(unusable(format!("the name of a field is {}: names are texts, as in JSON", in_words(kind))))
}

/// Reads the value of a field. A list has no lists in it.
fn value(decoder: &mut Decoder<'_>, name: &str) -> Result<Value, Unread> {
    if !matches!(decoder.datatype().map_err(no_cbor)?, Type::Array | Type::ArrayIndef) {
        return scalar(decoder, name);
    }
    let mut left = decoder.array().map_err(no_cbor)?;
    let mut values = Vec::new();
    while more(decoder, &mut left)? {
        values.push(scalar(decoder, name)?);
    }
    Ok(Value::Array(values))
}

#[expect(clippy::wildcard_enum_match_arm, reason = "whatever is no text, number, truth value or null is refused alike")]
fn scalar(decoder: &mut Decoder<'_>, name: &str) -> Result<Value, Unread> {
    let kind = decoder.datatype().map_err(no_cbor)?;
    match kind {
        Type::String | Type::StringIndef => text(decoder).map(Value::String),
        Type::Bool => decoder.bool().map(Value::Bool).map_err(no_cbor),
        Type::Null => decoder.null().map(|()| Value::Null).map_err(no_cbor),
        Type::Undefined => decoder.undefined().map(|()| Value::Null).map_err(no_cbor),
        Type::F16 => number(half(decoder)?, name),
        Type::F32 => number(decoder.f32().map_err(no_cbor)?.into(), name),
        Type::F64 => number(decoder.f64().map_err(no_cbor)?, name),
        Type::U8 | Type::U16 | Type::U32 | Type::U64 => decoder.u64().map(Value::from).map_err(no_cbor),
        Type::I8 | Type::I16 | Type::I32 | Type::I64 => decoder.i64().map(Value::from).map_err(no_cbor),
        other => Err(unusable(format!("`{}` is {}: send a text or a number", in_short(name), in_words(other)))),
    }
}

fn text(decoder: &mut Decoder<'_>) -> Result<String, Unread> {
    decoder.str_iter().and_then(Iterator::collect).map_err(no_cbor)
}

fn number(value: f64, name: &str) -> Result<Value, Unread> {
    let number = Number::from_f64(value).map(Value::Number);
    number.ok_or_else(|| unusable(format!("`{}` is {value}: send a number, such as 21.5", in_short(name))))
}

/// Reads a floating-point number of 16 bits (RFC 8949, appendix D): 1 bit of sign, 5 of exponent, 10 of fraction.
/// This is the shortest form of most readings.
fn half(decoder: &mut Decoder<'_>) -> Result<f64, Unread> {
    let start = decoder.position() + 1;
    let bytes = decoder.input().get(start..start + 2).ok_or_else(|| no_cbor(Error::end_of_input()))?;
    let bits = u16::from_be_bytes([bytes[0], bytes[1]]);
    decoder.set_position(start + 2);
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF));
    let size = match exponent {
        0 => fraction * f64::powi(2.0, -24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1024.0 + fraction) * f64::powi(2.0, exponent - 25),
    };
    Ok(if bits >> 15 == 1 { -size } else { size })
}

fn no_cbor(error: Error) -> Unread {
    Unread::Malformed(format!("the body is not CBOR: {error}"))
}

fn unusable(words: String) -> Unread {
    Unread::Unusable(Unusable(words))
}

#[expect(clippy::wildcard_enum_match_arm, reason = "what has no word of its own is not told apart")]
fn in_words(kind: Type) -> &'static str {
    match kind {
        Type::Array | Type::ArrayIndef => "a list",
        Type::Map | Type::MapIndef => "a map",
        Type::Bytes | Type::BytesIndef => "a string of bytes",
        Type::String | Type::StringIndef => "a text",
        Type::Tag => "a tagged item",
        Type::Bool => "true or false",
        Type::Int => "too large a number",
        Type::Null | Type::Undefined => "null",
        Type::Break | Type::Simple | Type::Unknown(_) => "no value",
        _ => "a number",
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::api::command::{EpochBody, GotoBody, MoveBody, OrderAreasBody, TemperatureBody, VerdictBody};
    use crate::api::state::StateJson;
    use crate::api::tests::fixture::{degrees, searching};
    use hallsweep_core::command::{Command, TemperatureReport};
    use hallsweep_core::units::Cell;

    fn refused<T: Body>(bytes: &[u8]) -> String {
        match body::<T>(bytes) {
            Ok(_) => panic!("{bytes:02x?} was taken"),
            Err(Unread::Malformed(words)) => words,
            Err(Unread::Unusable(unusable)) => unusable.to_string(),
        }
    }

    #[test]
    fn what_json_says_is_said_in_cbor_too() {
        let goto: GotoBody = body(&written(&json!({"x": 4, "y": -2, "epoch": 7}))).unwrap();
        assert_eq!(goto.command().unwrap().0, Command::Goto(Cell::new(4, -2)));
        let report = |value| body::<TemperatureBody>(&written(&value)).unwrap().report().unwrap();
        assert_eq!(report(json!({"celsius": 21.5})), TemperatureReport::Reading(degrees(21.5)));
        assert_eq!(report(json!({"status": "tooHigh", "celsius": null})), TemperatureReport::TooHigh);
        assert!(body::<EpochBody>(&written(&json!({}))).is_ok());
    }

    #[test]
    fn a_state_is_written_with_the_names_it_has_in_json() {
        let state = StateJson::from(&searching());
        let bytes = written(&state);
        let mut decoder = Decoder::new(&bytes);
        assert_eq!(decoder.map().unwrap(), Some(11));
        assert_eq!((decoder.str().unwrap(), decoder.str().unwrap()), ("run", "t-1"));
        assert_eq!((decoder.str().unwrap(), decoder.u64().unwrap()), ("revision", 20));
        assert_eq!(decoder.str().unwrap(), "mission");
        assert!(bytes.len() < serde_json::to_vec(&state).unwrap().len());
    }

    #[test]
    fn numbers_of_every_width_and_texts_in_pieces_are_read() {
        let celsius = |number: &[u8]| {
            let bytes = [b"\xa1\x67celsius", number].concat();
            body::<TemperatureBody>(&bytes).unwrap().report().unwrap()
        };
        for number in [&b"\xf9\x4d\x60"[..], b"\xfa\x41\xac\x00\x00", b"\xfb\x40\x35\x80\x00\x00\x00\x00\x00"] {
            assert_eq!(celsius(number), TemperatureReport::Reading(degrees(21.5)), "{number:02x?}");
        }
        assert_eq!(celsius(b"\x15"), TemperatureReport::Reading(degrees(21.0)));
        assert_eq!(celsius(b"\x29"), TemperatureReport::Reading(degrees(-10.0)));
        assert_eq!(celsius(b"\xf9\x80\x01"), TemperatureReport::Reading(degrees(-f64::powi(2.0, -24))));
        let pieces: MoveBody = body(b"\xbf\x64move\x7f\x61w\x60\xff\xff").unwrap();
        assert_eq!(pieces.command().unwrap().0, Command::Move(hallsweep_core::command::Move::Forward));
    }

    #[test]
    fn what_is_no_flat_map_is_refused_in_words() {
        let cases: [(&[u8], &str); 18] = [
            (b"", "the body is not CBOR"),
            (b"\xa1", "the body is not CBOR"),
            (b"\xa1\x67verdict", "the body is not CBOR"),
            (b"\xbf\x67verdict\x64safe", "the body is not CBOR"),
            (b"\xa1\x67verdict\x62\xff\xff", "the body is not CBOR"),
            (b"\xa0\xa0", "1 bytes follow it"),
            (b"\x81\x64safe", "the body is a list: send a CBOR map"),
            (b"\x64safe", "the body is a text"),
            (b"\xa1\x01\x64safe", "the name of a field is a number"),
            (b"\xa1\x67verdict\x81\x64safe", "`verdict` is [\"safe\"]: send a text in quotes"),
            (b"\xa1\x67verdict\x81\x81\x64safe", "`verdict` is a list: send a text or a number"),
            (b"\xa1\x67verdict\x9f\x64safe", "the body is not CBOR"),
            (b"\xa1\x67verdict\x9b\xff\xff\xff\xff\xff\xff\xff\xff", "the body is not CBOR"),
            (b"\xa1\x67verdict\xa0", "`verdict` is a map"),
            (b"\xa1\x67verdict\x44safe", "`verdict` is a string of bytes"),
            (b"\xa1\x67verdict\xc0\x64safe", "`verdict` is a tagged item"),
            (b"\xa2\x67verdict\x64safe\x67verdict\x66danger", "`verdict` occurs twice"),
            (b"\xa1\x64word\x64safe", "no field `word`: its fields are verdict"),
        ];
        for (bytes, words) in cases {
            let said = refused::<VerdictBody>(bytes);
            assert!(said.contains(words), "{bytes:02x?}: {said}");
        }
        for bytes in [&b"\xa1\x65areas\x82\x61a\x61b"[..], b"\xa1\x65areas\x9f\x61a\x61b\xff"] {
            let order = body::<OrderAreasBody>(bytes).unwrap().command().unwrap();
            assert_eq!(order, Command::OrderAreas(["a".into(), "b".into()].into()));
        }
        assert!(refused::<TemperatureBody>(b"\xa1\x67celsius\xf9\x7e\x00").contains("`celsius` is NaN"));
        assert!(refused::<TemperatureBody>(b"\xa1\x67celsius\xf9\xfc\x00").contains("`celsius` is -inf"));
        assert!(refused::<TemperatureBody>(b"\xa1\x67celsius\x3b\xff\xff\xff\xff\xff\xff\xff\xff").contains("too large"));
    }

    /// Safety A7: no nesting and no announced length exhausts the stack or the memory.
    #[test]
    fn no_nesting_and_no_announced_length_exhausts_anything() {
        let deep = [b"\xa1\x67verdict".to_vec(), vec![0x81; 16 * 1024]].concat();
        assert!(refused::<VerdictBody>(&deep).contains("`verdict` is a list"));
        for opener in [0x81, 0x9f, 0xbf, 0xc0] {
            assert!(!refused::<VerdictBody>(&vec![opener; 16 * 1024]).is_empty());
        }
        assert!(refused::<VerdictBody>(b"\xbb\xff\xff\xff\xff\xff\xff\xff\xff").contains("not CBOR"));
        assert!(refused::<VerdictBody>(b"\xa1\x7b\x7f\xff\xff\xff\xff\xff\xff\xff").contains("not CBOR"));
    }
}
