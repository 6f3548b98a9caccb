//! Executes scripts as BehaviorTree.CPP does. Arithmetic uses doubles, comparisons give 1 or 0, and both sides of
//! `&&` and `||` are always evaluated. Results that nobody can use (a division by zero, an undefined number) are
//! errors here, although BehaviorTree.CPP accepts them.

use super::{Assignment, Comparison, Expression, Infix, Prefix, Script, Trouble, shown, truth_of};
use crate::blackboard::{Blackboard, Slot};
use crate::tick::EPSILON;
use crate::value::{Value, finite};

impl Script {
    pub(super) fn evaluate(&self, at: usize, blackboard: &mut Blackboard) -> Result<Value, Trouble> {
        match &self.expressions[at] {
            Expression::Literal(value) => Ok(value.clone()),
            Expression::Entry(slot) => blackboard.value(*slot).cloned().ok_or_else(|| Trouble::Nothing(name(blackboard, *slot))),
            Expression::Prefix(prefix, operand) => prefixed(*prefix, &self.evaluate(*operand, blackboard)?),
            Expression::Infix(infix, left, right) => {
                let left = self.evaluate(*left, blackboard)?;
                let right = self.evaluate(*right, blackboard)?;
                infixed(*infix, &left, &right)
            }
            Expression::Chain(first, others) => {
                let mut left = self.evaluate(*first, blackboard)?;
                for (comparison, right) in others {
                    let right = self.evaluate(*right, blackboard)?;
                    if !compared(*comparison, &left, &right)? {
                        return Ok(truth(false));
                    }
                    left = right;
                }
                Ok(truth(true))
            }
            Expression::Choice(condition, then, otherwise) => {
                let condition = self.evaluate(*condition, blackboard)?;
                let holds = match &condition {
                    Value::Text(text) => !text.is_empty(),
                    Value::Bool(_) | Value::Int(_) | Value::Number(_) => condition.as_bool().unwrap_or(false),
                    Value::Cell(_) => return Err(Trouble::NoTruth(shown(&condition))),
                };
                self.evaluate(if holds { *then } else { *otherwise }, blackboard)
            }
            Expression::Assign(assignment, slot, value) => {
                if *assignment != Assignment::Create && !blackboard.is_there(*slot) {
                    return Err(Trouble::NotThere(name(blackboard, *slot)));
                }
                let value = self.evaluate(*value, blackboard)?;
                assign(*assignment, *slot, value, blackboard)
            }
        }
    }
}

fn name(blackboard: &Blackboard, slot: Slot) -> String {
    blackboard.entry(slot).map_or_else(String::new, |entry| entry.name().to_owned())
}

fn truth(holds: bool) -> Value {
    Value::Number(f64::from(u8::from(holds)))
}

/// Returns a value as a number. Booleans count as numbers. Texts do not, even if they consist of digits.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Bool(_) | Value::Int(_) | Value::Number(_) => value.as_number(),
        Value::Text(_) | Value::Cell(_) => None,
    }
}

fn sound(number: f64) -> Result<Value, Trouble> {
    finite(number).ok_or(Trouble::TooLarge)
}

#[expect(clippy::cast_precision_loss, reason = "results are doubles, as those of BehaviorTree.CPP are")]
fn prefixed(prefix: Prefix, operand: &Value) -> Result<Value, Trouble> {
    let operator = match prefix {
        Prefix::Minus => "-",
        Prefix::Complement => "~",
        Prefix::Not => "!",
    };
    let wrong = || Trouble::Operand { operator, operand: shown(operand) };
    let number = number(operand).ok_or_else(wrong)?;
    match prefix {
        Prefix::Minus => sound(-number),
        Prefix::Not => Ok(truth(number == 0.0)),
        Prefix::Complement => Ok(Value::Number(!operand.as_int().ok_or_else(wrong)? as f64)),
    }
}

#[expect(clippy::cast_precision_loss, reason = "results are doubles, as those of BehaviorTree.CPP are")]
fn infixed(infix: Infix, left: &Value, right: &Value) -> Result<Value, Trouble> {
    let wrong = || Trouble::Operands { operator: infix.word(), left: shown(left), right: shown(right) };
    let truths = || truth_of(left).zip(truth_of(right)).ok_or_else(wrong);
    let numbers = || number(left).zip(number(right)).ok_or_else(wrong);
    let whole = || {
        numbers()?;
        left.as_int().zip(right.as_int()).ok_or_else(wrong)
    };
    match infix {
        Infix::Plus => match (left, right) {
            (Value::Text(left), Value::Text(right)) => Ok(Value::text(&format!("{left}{right}"))),
            _ => numbers().and_then(|(left, right)| sound(left + right)),
        },
        Infix::Minus => numbers().and_then(|(left, right)| sound(left - right)),
        Infix::Times => numbers().and_then(|(left, right)| sound(left * right)),
        Infix::Divide => match numbers()? {
            (_, 0.0) => Err(Trouble::ByZero),
            (left, right) => sound(left / right),
        },
        Infix::Concat => match (left, right) {
            (Value::Text(_), _) | (_, Value::Text(_)) => Ok(Value::text(&format!("{}{}", joined(left), joined(right)))),
            _ => Err(wrong()),
        },
        Infix::BitAnd => whole().map(|(left, right)| Value::Number((left & right) as f64)),
        Infix::BitOr => whole().map(|(left, right)| Value::Number((left | right) as f64)),
        Infix::BitXor => whole().map(|(left, right)| Value::Number((left ^ right) as f64)),
        Infix::And => truths().map(|(left, right)| truth(left && right)),
        Infix::Or => truths().map(|(left, right)| truth(left || right)),
    }
}

/// Returns a value in the form in which it is joined to a text. A number that is not of a whole type has six
/// decimals, as from `std::to_string`.
fn joined(value: &Value) -> String {
    match value {
        Value::Number(number) => format!("{number:.6}"),
        Value::Bool(_) | Value::Int(_) | Value::Text(_) | Value::Cell(_) => value.to_string(),
    }
}

/// Compares texts with texts, and numbers with numbers. A text is compared with a number only if the text is a number
/// (`true` and `false` are 1 and 0).
fn compared(comparison: Comparison, left: &Value, right: &Value) -> Result<bool, Trouble> {
    if let (Value::Text(left), Value::Text(right)) = (left, right) {
        return Ok(match comparison {
            Comparison::Equal => left == right,
            Comparison::NotEqual => left != right,
            Comparison::Less => left < right,
            Comparison::Greater => left > right,
            Comparison::LessOrEqual => left <= right,
            Comparison::GreaterOrEqual => left >= right,
        });
    }
    if let (Value::Cell(left), Value::Cell(right)) = (left, right) {
        match comparison {
            Comparison::Equal => return Ok(left == right),
            Comparison::NotEqual => return Ok(left != right),
            Comparison::Less | Comparison::Greater | Comparison::LessOrEqual | Comparison::GreaterOrEqual => {}
        }
    }
    let as_number = |value: &Value| match value {
        Value::Text(text) if &**text == "true" => Some(1.0),
        Value::Text(text) if &**text == "false" => Some(0.0),
        Value::Text(_) | Value::Bool(_) | Value::Int(_) | Value::Number(_) | Value::Cell(_) => value.as_number(),
    };
    let wrong = || Trouble::Operands { operator: "a comparison", left: shown(left), right: shown(right) };
    let (left, right) = as_number(left).zip(as_number(right)).ok_or_else(wrong)?;
    let is_same = (left - right).abs() <= EPSILON;
    Ok(match comparison {
        Comparison::Equal => is_same,
        Comparison::NotEqual => !is_same,
        Comparison::Less => left < right,
        Comparison::Greater => left > right,
        Comparison::LessOrEqual => left <= right,
        Comparison::GreaterOrEqual => left >= right,
    })
}

/// Writes an entry. An entry with a value keeps its type.
fn assign(assignment: Assignment, slot: Slot, value: Value, blackboard: &mut Blackboard) -> Result<Value, Trouble> {
    let before = blackboard.value(slot).cloned();
    let value = match (assignment, &before) {
        (Assignment::Create | Assignment::Existing, _) => value,
        (_, None) => return Err(Trouble::Nothing(name(blackboard, slot))),
        (Assignment::Plus, Some(before)) => infixed(Infix::Plus, before, &value)?,
        (Assignment::Minus, Some(before)) => infixed(Infix::Minus, before, &value)?,
        (Assignment::Times, Some(before)) => infixed(Infix::Times, before, &value)?,
        (Assignment::Divide, Some(before)) => infixed(Infix::Divide, before, &value)?,
    };
    let value = match &before {
        None => value,
        Some(before) => {
            let is_text_for_number = matches!(before, Value::Text(_)) && !matches!(value, Value::Text(_));
            let fitting = if is_text_for_number { None } else { value.converted(before.value_type()) };
            fitting.ok_or_else(|| Trouble::Assigned {
                entry: name(blackboard, slot),
                value: shown(&value),
                before: shown(before),
            })?
        }
    };
    blackboard.put(slot, value.clone())?;
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: Result<Value, &str>) {
        let mut blackboard = Blackboard::new();
        let script = Script::parse(text, &mut |name| blackboard.mention(name));
        let result = match script {
            Ok(script) => script.carry_out(&mut blackboard).map_err(|trouble| trouble.to_string()),
            Err(error) => Err(error.to_string()),
        };
        assert_eq!(result, expected.map_err(str::to_owned), "{text}");
    }

    fn number(value: f64) -> Result<Value, &'static str> {
        Ok(Value::Number(value))
    }

    #[test]
    fn scripts_count_and_compare_as_in_behaviortree_cpp() {
        check("1 + 2 * 3 - 4 / 2", number(5.0));
        check("-(2 + 1) * -2", number(6.0));
        check("7 & 3 | 8 ^ 1", number(10.0));
        check("~0", number(-1.0));
        check("!0", number(1.0));
        check("1 < 2 < 3", number(1.0));
        check("3 > 2 > 2", number(0.0));
        check("0.1 + 0.2 == 0.3", number(1.0));
        check("1 ? 'a' : 'b'", Ok(Value::text("a")));
        check("'' ? 1 : 2", Ok(Value::Int(2)));
        check("'x' + 'y'", Ok(Value::text("xy")));
        check("'x' .. 3", Ok(Value::text("x3")));
        check("'x' .. 0.5", Ok(Value::text("x0.500000")));
        check("7 - 1 + 10", number(16.0));
        check("--1", number(1.0));
        check("!!1", number(1.0));
        check("1 + +1", number(2.0));
        check("'3' == 3 && 'true' == 1", number(1.0));
        check("'b' > 'a'", number(1.0));
    }

    /// `&&` and `||` have the same precedence, from left to right.
    #[test]
    fn and_binds_no_tighter_than_or() {
        check("1 || 1 && 0", number(0.0));
        check("1 || (1 && 0)", number(1.0));
    }

    #[test]
    fn an_entry_keeps_its_type() {
        check("x := 3; x += 1; x", Ok(Value::Int(4)));
        check("x := 3; x /= 2", Err("its script cannot assign 1.5 to {x}, whose value is 3"));
        check("x := 1.0; x = 3; x", number(3.0));
        check("x := 'a'; x += 'b'; x", Ok(Value::text("ab")));
        check("x := 'a'; x = 3", Err("its script cannot assign 3 to {x}, whose value is 'a'"));
        check("x := 5; x = '7'; x", Ok(Value::Int(7)));
    }

    #[test]
    fn what_cannot_be_done_is_said() {
        check("1 / 0", Err("its script divides by zero"));
        check("1e308 * 10", Err("a number in its script is too large"));
        check("x + 1", Err("the entry {x} in its script has no value"));
        check("x = 1", Err("the entry {x} in its script does not exist yet: := creates the entry"));
        check("'a' - 1", Err("its script cannot apply - to 'a' and 1"));
        check("-'a'", Err("its script cannot apply - to 'a'"));
        check("7 || 0", Err("its script cannot apply || to 7 and 0"));
        check("-0.5 || 1", Err("its script cannot apply || to -0.5 and 1"));
        check("'a' && 1", Err("its script cannot apply && to 'a' and 1"));
        check("1.5 & 1", Err("its script cannot apply & to 1.5 and 1"));
        check("'a' == 1", Err("its script cannot apply a comparison to 'a' and 1"));
    }

    #[test]
    fn what_is_no_script_is_refused() {
        check("", Err("the script is empty"));
        check(" ; ", Err("the script is empty"));
        check("1 +", Err("expected a value at character 3, found the end"));
        check("(1", Err("expected ) at character 2, found the end"));
        check("1 2", Err("expected ; or the end at character 2, found 2"));
        check("3 := x", Err("the assignment at character 2 has no entry on its left side"));
        check("1 + 2 & 3", Err("expected parentheses between arithmetic and bit operators at character 6, found &"));
        check("!1 + 2", Err("expected parentheses between arithmetic and bit operators at character 3, found +"));
        check(&"(".repeat(200), Err("the script is nested deeper than 64 levels"));
        check(&"1+".repeat(200), Err("the script is nested deeper than 64 levels"));
        check(&"x".repeat(5000), Err("the script is 5000 bytes long; the limit is 4096 bytes"));
    }

    /// A script that doubles a text again and again must end at the limit of the blackboard.
    #[test]
    fn a_text_does_not_grow_without_end() {
        let text = format!("x := '{}'{}", "y".repeat(100), "; x += x".repeat(20));
        let mut blackboard = Blackboard::new();
        let script = Script::parse(&text, &mut |name| blackboard.mention(name)).expect("it is well written");
        assert!(matches!(script.carry_out(&mut blackboard), Err(Trouble::Unfit(_))));
    }
}
