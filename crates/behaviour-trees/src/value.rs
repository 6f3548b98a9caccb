//! Values of ports and blackboard entries, their types, and their form in a file. `blackboard` decides which values
//! an entry accepts.

use std::fmt;
use std::sync::Arc;

/// A square of a floor. The engine can only compare cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The column. It is the first number in a file.
    pub x: i32,
    /// The row. It is the second number in a file.
    pub y: i32,
}

/// Maximum length of a text in an entry, in bytes. No name or sentence is so long. The limit stops a script that
/// doubles a text again and again.
pub const LONGEST_TEXT: usize = 64 * 1024;

/// The value of a port or of a blackboard entry. `Display` writes it in the form of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `true` or `false`. In a script they are 1 and 0.
    Bool(bool),
    /// A whole number of 64 bits.
    Int(i64),
    /// A finite number of 64 bits, never `NaN`.
    Number(f64),
    /// Any text. In an entry, it has at most [`LONGEST_TEXT`] bytes.
    Text(Arc<str>),
    /// A square of the floor, written `3;4` (column, row).
    Cell(Cell),
}

named! {
    /// The type of a port or an entry. A text in a file is parsed as this type.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum ValueType {
        /// No type was given. Any value fits, and a text stays a text.
        #[default]
        Any = "any",
        /// `true` or `false`, which may also be written as `1` or `0`.
        Bool = "bool",
        /// A whole number of 64 bits, in decimal digits.
        Int = "int",
        /// A finite number; `inf` and `NaN` are not accepted.
        Number = "number",
        /// Any text, including its blanks.
        Text = "text",
        /// A square of the floor, written `3;4` (column, row).
        Cell = "cell",
    }
}

impl ValueType {
    /// The type that a model of a leaf names, such as `type="std::string"`. It is a C++ name that the graphical
    /// editor writes, or a word of this crate. An unknown name means `Any`.
    #[must_use]
    pub fn of_model(name: &str) -> ValueType {
        match name {
            "bool" => ValueType::Bool,
            "int" | "unsigned" | "unsigned int" | "int64_t" | "uint64_t" | "int32_t" | "uint32_t" | "long" | "short" => {
                ValueType::Int
            }
            "number" | "double" | "float" => ValueType::Number,
            "text" | "std::string" | "string" => ValueType::Text,
            "cell" | "Cell" => ValueType::Cell,
            _ => ValueType::Any,
        }
    }
}

impl Value {
    /// A text value with a copy of this text.
    #[must_use]
    pub fn text(text: &str) -> Value {
        Value::Text(Arc::from(text))
    }

    /// The type of this value; never `Any`.
    #[must_use]
    pub const fn value_type(&self) -> ValueType {
        match self {
            Value::Bool(_) => ValueType::Bool,
            Value::Int(_) => ValueType::Int,
            Value::Number(_) => ValueType::Number,
            Value::Text(_) => ValueType::Text,
            Value::Cell(_) => ValueType::Cell,
        }
    }

    /// Reads `text` as a value of this type. With `Any`, the value is the text itself.
    #[must_use]
    pub fn parse(text: &str, ty: ValueType) -> Option<Value> {
        match ty {
            ValueType::Any | ValueType::Text => Some(Value::text(text)),
            ValueType::Bool => match text.trim() {
                "true" | "True" | "TRUE" | "1" => Some(Value::Bool(true)),
                "false" | "False" | "FALSE" | "0" => Some(Value::Bool(false)),
                _ => None,
            },
            ValueType::Int => text.trim().parse().ok().map(Value::Int),
            ValueType::Number => finite(text.trim().parse().ok()?),
            ValueType::Cell => {
                let (x, y) = text.split_once(';')?;
                Some(Value::Cell(Cell { x: x.trim().parse().ok()?, y: y.trim().parse().ok()? }))
            }
        }
    }

    /// Converts this value to the type, if nothing is lost. Texts are parsed, and numbers may become whole numbers.
    #[must_use]
    pub fn converted(&self, ty: ValueType) -> Option<Value> {
        if ty == ValueType::Any || self.value_type() == ty {
            return Some(self.clone());
        }
        match (self, ty) {
            (Value::Text(text), _) => Value::parse(text, ty),
            (_, ValueType::Int) => self.as_int().map(Value::Int),
            (_, ValueType::Number) => self.as_number().and_then(finite),
            (_, ValueType::Bool) => self.as_bool().map(Value::Bool),
            (_, ValueType::Text) => Some(Value::text(&self.to_string())),
            (_, ValueType::Cell | ValueType::Any) => None,
        }
    }

    /// The value as `true` or `false`. A number is true unless it is 0, and texts such as `true` are parsed.
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        match self {
            Value::Bool(truth) => Some(*truth),
            Value::Int(number) => Some(*number != 0),
            Value::Number(number) => Some(*number != 0.0),
            Value::Text(text) => match Value::parse(text, ValueType::Bool)? {
                Value::Bool(truth) => Some(truth),
                Value::Int(_) | Value::Number(_) | Value::Text(_) | Value::Cell(_) => None,
            },
            Value::Cell(_) => None,
        }
    }

    /// The value as a whole number, if it is one. `true` is 1, and texts are parsed.
    #[must_use]
    pub fn as_int(&self) -> Option<i64> {
        match self {
            Value::Bool(truth) => Some(i64::from(*truth)),
            Value::Int(number) => Some(*number),
            Value::Number(number) => whole(*number),
            Value::Text(text) => text.trim().parse().ok(),
            Value::Cell(_) => None,
        }
    }

    /// The value as a number. `true` is 1, and texts are parsed; `None` for a cell.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a script counts in doubles, as those of BehaviorTree.CPP do")]
    pub fn as_number(&self) -> Option<f64> {
        match self {
            Value::Bool(truth) => Some(f64::from(u8::from(*truth))),
            Value::Int(number) => Some(*number as f64),
            Value::Number(number) => Some(*number),
            Value::Text(text) => text.trim().parse().ok().filter(|number: &f64| number.is_finite()),
            Value::Cell(_) => None,
        }
    }

    /// The value as a text, if it is one. Other values are not converted.
    #[must_use]
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Value::Text(text) => Some(text),
            Value::Bool(_) | Value::Int(_) | Value::Number(_) | Value::Cell(_) => None,
        }
    }

    /// The value as a cell. A text such as `3;4` is parsed.
    #[must_use]
    pub fn as_cell(&self) -> Option<Cell> {
        match self {
            Value::Cell(cell) => Some(*cell),
            Value::Text(text) => match Value::parse(text, ValueType::Cell)? {
                Value::Cell(cell) => Some(cell),
                Value::Bool(_) | Value::Int(_) | Value::Number(_) | Value::Text(_) => None,
            },
            Value::Bool(_) | Value::Int(_) | Value::Number(_) => None,
        }
    }
}

/// Returns a number as a value; `None` if the number is infinite or undefined.
pub(crate) fn finite(number: f64) -> Option<Value> {
    number.is_finite().then_some(Value::Number(number))
}

/// 2⁵³. Up to this number, a double represents every whole number exactly.
const EXACT: f64 = 9_007_199_254_740_992.0;

#[expect(clippy::cast_possible_truncation, reason = "looked at before: whole, and within what a double holds exactly")]
pub(crate) fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() <= EXACT).then_some(number as i64)
}

impl fmt::Display for Value {
    /// Writes the value in the form of a file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(truth) => write!(f, "{truth}"),
            Value::Int(number) => write!(f, "{number}"),
            Value::Number(number) => write!(f, "{number}"),
            Value::Text(text) => f.write_str(text),
            Value::Cell(cell) => write!(f, "{};{}", cell.x, cell.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_as_the_same() {
        for value in [
            Value::Bool(false),
            Value::Int(i64::MIN),
            Value::Number(-0.125),
            Value::text("a;b\n"),
            Value::Cell(Cell { x: -3, y: 4 }),
        ] {
            assert_eq!(Value::parse(&value.to_string(), value.value_type()), Some(value));
        }
    }

    #[test]
    fn what_is_no_value_of_its_type_is_none() {
        let bad = [
            ("maybe", ValueType::Bool),
            ("1.5", ValueType::Int),
            ("inf", ValueType::Number),
            ("NaN", ValueType::Number),
            ("3,4", ValueType::Cell),
            ("3;4;5", ValueType::Cell),
            ("", ValueType::Int),
        ];
        for (text, ty) in bad {
            assert_eq!(Value::parse(text, ty), None, "{text} as {ty:?}");
        }
    }

    #[test]
    fn nothing_is_lost_when_a_value_changes_its_type() {
        assert_eq!(Value::Number(3.0).converted(ValueType::Int), Some(Value::Int(3)));
        assert_eq!(Value::Number(3.5).converted(ValueType::Int), None);
        assert_eq!(Value::Number(1e300).converted(ValueType::Int), None);
        assert_eq!(Value::text("3;4").converted(ValueType::Cell), Some(Value::Cell(Cell { x: 3, y: 4 })));
        assert_eq!(Value::Int(1).converted(ValueType::Cell), None);
        assert_eq!(Value::Cell(Cell { x: 1, y: 2 }).converted(ValueType::Text), Some(Value::text("1;2")));
    }
}
