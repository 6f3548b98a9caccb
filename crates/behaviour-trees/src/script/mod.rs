//! The script language of BehaviorTree.CPP 4: `x := 3; x += 1; done = (x > 3 && name == 'SRM1')`. `token` splits a
//! text, `parse` builds the expressions, `evaluate` executes them. Entries are looked up when a tree is built.

mod evaluate;
mod parse;
mod token;

use super::blackboard::{Blackboard, Slot, Unfit};
use super::value::Value;

/// Longest script, in bytes: a screen full.
pub const LONGEST_SCRIPT: usize = 4096;

/// Deepest nesting of parentheses and operators: scripts are executed by recursive calls.
pub(crate) const DEEPEST_EXPRESSION: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Script {
    expressions: Vec<Expression>,
    /// Indices of the top-level expressions, in order; at least one.
    statements: Vec<usize>,
}

/// An expression. Its operands are indices in the list of expressions.
#[derive(Clone, Debug, PartialEq)]
enum Expression {
    Literal(Value),
    Entry(Slot),
    Prefix(Prefix, usize),
    Infix(Infix, usize, usize),
    /// `a < b <= c`: each operand is compared with the next one.
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
    /// `:=`, which creates the entry if it does not exist.
    Create,
    /// `=`, which requires an existing entry.
    Existing,
    Plus,
    Minus,
    Times,
    Divide,
}

/// Why a text is not a valid script. Places in it are in bytes, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// The length of the script in bytes, more than [`LONGEST_SCRIPT`].
    #[error("the script is {0} bytes long; the limit is {LONGEST_SCRIPT} bytes")]
    TooLong(usize),
    /// The script is nested deeper than 64 levels: scripts are executed by recursive calls.
    #[error("the script is nested deeper than {DEEPEST_EXPRESSION} levels")]
    TooDeep,
    /// The script has no statement; blanks and `;` are no statements.
    #[error("the script is empty")]
    Empty,
    /// The first part of the script that does not fit the part before it.
    #[error("expected {wanted} at character {at}, found {found}")]
    Unexpected {
        /// The place of this part in bytes, from 0.
        at: usize,
        /// The text at this place. A value is cut to the length of a line.
        found: String,
        /// The expected text, in words that an author knows, such as `; or the end`.
        wanted: &'static str,
    },
    /// The place, in bytes, of an assignment whose left side is no name of an entry.
    #[error("the assignment at character {0} has no entry on its left side")]
    NoEntry(usize),
    /// A name for which the blackboard cannot create an entry.
    #[error(transparent)]
    Unfit(#[from] Unfit),
}

/// Why a script could not be executed, as a part of the fault of its node.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Trouble {
    #[error("the entry {{{0}}} in its script has no value")]
    Nothing(String),
    #[error("the entry {{{0}}} in its script does not exist yet: := creates the entry")]
    NotThere(String),
    #[error("its script divides by zero")]
    ByZero,
    #[error("a number in its script is too large")]
    TooLarge,
    #[error("its script cannot apply {operator} to {left} and {right}")]
    Operands { operator: &'static str, left: String, right: String },
    #[error("its script cannot apply {operator} to {operand}")]
    Operand { operator: &'static str, operand: String },
    #[error("its script cannot assign {value} to {{{entry}}}, whose value is {before}")]
    Assigned { entry: String, value: String, before: String },
    #[error("the result of its script is {0}, which is neither true nor false")]
    NoTruth(String),
    #[error("in its script: {0}")]
    Unfit(#[from] Unfit),
}

impl Script {
    /// Parses a script. `slot` looks up the slot of each name here, so that a tick need not.
    pub(crate) fn parse(text: &str, slot: &mut dyn FnMut(&str) -> Result<Slot, Unfit>) -> Result<Script, ScriptError> {
        if text.len() > LONGEST_SCRIPT {
            return Err(ScriptError::TooLong(text.len()));
        }
        parse::parse(text, slot)
    }

    pub(crate) fn carry_out(&self, blackboard: &mut Blackboard) -> Result<Value, Trouble> {
        let mut last = Value::Bool(false);
        for statement in &self.statements {
            last = self.evaluate(*statement, blackboard)?;
        }
        Ok(last)
    }

    /// Executes the script, and returns whether the value of its last statement is true.
    pub(crate) fn holds(&self, blackboard: &mut Blackboard) -> Result<bool, Trouble> {
        let value = self.carry_out(blackboard)?;
        truth_of(&value).ok_or_else(|| Trouble::NoTruth(shown(&value)))
    }
}

/// A value as true or false; `None` if it is neither. As in BehaviorTree.CPP, texts, whole numbers other than 0 and
/// 1, and negative numbers are neither.
fn truth_of(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(truth) => Some(*truth),
        Value::Int(0) => Some(false),
        Value::Int(1) => Some(true),
        Value::Number(number) if *number >= 0.0 => Some(*number > 0.0),
        Value::Int(_) | Value::Number(_) | Value::Text(_) | Value::Cell(_) => None,
    }
}

/// A value in an error message, cut to the length of a line.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = value.to_string();
    let quote = if matches!(value, Value::Text(_)) { "'" } else { "" };
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{quote}{}…{quote}", &text[..end]),
        None => format!("{quote}{text}{quote}"),
    }
}
