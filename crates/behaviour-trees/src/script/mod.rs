//! The little language of scripts, that of BehaviorTree.CPP 4: `x := 3; x += 1; done = (x > 3 && name == 'SRM1')`.
//! `token` cuts a text, `parse` finds what is meant, `evaluate` does it. Entries are looked up when a tree is built.

mod evaluate;
mod parse;
mod token;

use super::blackboard::{Blackboard, Slot, Unfit};
use super::value::Value;

/// The longest script, in bytes: a screen full.
pub const LONGEST_SCRIPT: usize = 4096;

/// How deep parentheses and operators may be nested: scripts are carried out by calls.
pub(crate) const DEEPEST_EXPRESSION: usize = 64;

/// A script that can be carried out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Script {
    expressions: Vec<Expression>,
    /// The expressions that stand alone, in their order; at least one.
    statements: Vec<usize>,
}

/// What is computed; operands are named by their places in the list.
#[derive(Clone, Debug, PartialEq)]
enum Expression {
    Literal(Value),
    Entry(Slot),
    Prefix(Prefix, usize),
    Infix(Infix, usize, usize),
    /// `a < b <= c`: each is compared with the next.
    Chain(usize, Vec<(Comparison, usize)>),
    /// `a ? b : c`
    Choice(usize, usize, usize),
    Assign(Assignment, Slot, usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prefix {
    Minus,
    Complement,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Infix {
    Plus,
    Minus,
    Times,
    Divide,
    Concat,
    BitAnd,
    BitOr,
    BitXor,
    And,
    Or,
}

impl Infix {
    const fn word(self) -> &'static str {
        match self {
            Infix::Plus => "+",
            Infix::Minus => "-",
            Infix::Times => "*",
            Infix::Divide => "/",
            Infix::Concat => "..",
            Infix::BitAnd => "&",
            Infix::BitOr => "|",
            Infix::BitXor => "^",
            Infix::And => "&&",
            Infix::Or => "||",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comparison {
    Equal,
    NotEqual,
    Less,
    Greater,
    LessOrEqual,
    GreaterOrEqual,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Assignment {
    /// `:=`
    Create,
    /// `=`
    Existing,
    Plus,
    Minus,
    Times,
    Divide,
}

/// Why a text is no script. The place is that in the script, in bytes from 0.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// It is too long.
    #[error("it is {0} bytes long, and {LONGEST_SCRIPT} is the most")]
    TooLong(usize),
    /// It is nested too deeply.
    #[error("it is nested deeper than {DEEPEST_EXPRESSION} levels")]
    TooDeep,
    /// There is nothing in it.
    #[error("it is empty")]
    Empty,
    /// Something else should stand there.
    #[error("at character {at} there is {found}, and {wanted} should be there")]
    Unexpected {
        /// Where.
        at: usize,
        /// What stands there.
        found: String,
        /// What should.
        wanted: &'static str,
    },
    /// Something is assigned to what is no entry.
    #[error("at character {0} something is assigned to what is no entry")]
    NoEntry(usize),
    /// An entry cannot be.
    #[error(transparent)]
    Unfit(#[from] Unfit),
}

/// Why a script could not be carried out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Trouble {
    #[error("in its script the entry {{{0}}} holds nothing")]
    Nothing(String),
    #[error("in its script the entry {{{0}}} is not there yet: := makes it")]
    NotThere(String),
    #[error("its script divides by zero")]
    ByZero,
    #[error("a number in its script is too large")]
    TooLarge,
    #[error("in its script {operator} does not go with {left} and {right}")]
    Operands { operator: &'static str, left: String, right: String },
    #[error("in its script {operator} does not go with {operand}")]
    Operand { operator: &'static str, operand: String },
    #[error("in its script {value} cannot be assigned to {{{entry}}}, which holds {before}")]
    Assigned { entry: String, value: String, before: String },
    #[error("its script comes to {0}, which is neither true nor false")]
    NoTruth(String),
    #[error("in its script: {0}")]
    Unfit(#[from] Unfit),
}

impl Script {
    /// Reads a script. `slot` says where the entry of a name is.
    pub(crate) fn parse(text: &str, slot: &mut dyn FnMut(&str) -> Result<Slot, Unfit>) -> Result<Script, ScriptError> {
        if text.len() > LONGEST_SCRIPT {
            return Err(ScriptError::TooLong(text.len()));
        }
        parse::parse(text, slot)
    }

    /// Carries it out, and gives what its last statement came to.
    pub(crate) fn carry_out(&self, blackboard: &mut Blackboard) -> Result<Value, Trouble> {
        let mut last = Value::Bool(false);
        for statement in &self.statements {
            last = self.evaluate(*statement, blackboard)?;
        }
        Ok(last)
    }

    /// Carries it out, and says whether what it came to is true.
    pub(crate) fn holds(&self, blackboard: &mut Blackboard) -> Result<bool, Trouble> {
        let value = self.carry_out(blackboard)?;
        truth_of(&value).ok_or_else(|| Trouble::NoTruth(shown(&value)))
    }
}

/// A value as true or false. BehaviorTree.CPP takes no text for one, of whole numbers 0 and 1 alone, and nothing below 0.
fn truth_of(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(truth) => Some(*truth),
        Value::Int(0) => Some(false),
        Value::Int(1) => Some(true),
        Value::Number(number) if *number >= 0.0 => Some(*number > 0.0),
        Value::Int(_) | Value::Number(_) | Value::Text(_) | Value::Cell(_) => None,
    }
}

/// A value in a sentence: no longer than a line.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = value.to_string();
    let quote = if matches!(value, Value::Text(_)) { "'" } else { "" };
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{quote}{}…{quote}", &text[..end]),
        None => format!("{quote}{text}{quote}"),
    }
}
