//! The script language of BehaviorTree.CPP 4: `x := 3; x += 1; done = (x > 3 && name == 'SRM1')`. `token` splits a
//! text, `parse` builds the expressions, and `evaluate` executes them. Entries are looked up when a tree is built.

mod evaluate;
mod parse;
mod token;

use super::blackboard::{Blackboard, Slot, Unfit};
use super::value::Value;

/// Maximum length of a script, in bytes. This is about one screen of text.
pub const LONGEST_SCRIPT: usize = 4096;

/// Maximum depth of nested parentheses and operators. It is limited because scripts are executed by recursive calls.
pub(crate) const DEEPEST_EXPRESSION: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Script {
    expressions: Vec<Expression>,
    /// Indices of the top-level expressions, in order. There is at least one.
    statements: Vec<usize>,
}

/// An expression. Its operands are indices in the list of all expressions.
#[derive(Clone, Debug, PartialEq)]
enum Expression {
    Literal(Value),
    Entry(Slot),
    Prefix(Prefix, usize),
    Infix(Infix, usize, usize),
    /// `a < b <= c`, where each operand is compared with the next one.
    Chain(usize, Vec<(Comparison, usize)>),
    /// `a ? b : c`, which gives `b` if `a` is true, otherwise `c`.
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

/// Why a text is not a valid script. Places in the text are in bytes, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// The script is longer than [`LONGEST_SCRIPT`]. The value is its length in bytes.
    #[error("the script is {0} bytes long; the limit is {LONGEST_SCRIPT} bytes")]
    TooLong(usize),
    /// The script is nested deeper than 64 levels. The depth is limited because scripts are executed by recursive
    /// calls.
    #[error("the script is nested deeper than {DEEPEST_EXPRESSION} levels")]
    TooDeep,
    /// The script has no statement. Blanks and `;` are not statements.
    #[error("the script is empty")]
    Empty,
    /// A part of the script does not fit the part before it. The fields describe the first such part.
    #[error("expected {wanted} at character {at}, found {found}")]
    Unexpected {
        /// The place of this part, in bytes from 0.
        at: usize,
        /// The text at this place. A long value is cut to the length of a line.
        found: String,
        /// The expected text, in words that an author knows, such as `; or the end`.
        wanted: &'static str,
    },
    /// The left side of an assignment is not the name of an entry. The value is the place of the assignment in bytes.
    #[error("the assignment at character {0} has no entry on its left side")]
    NoEntry(usize),
    /// The script has a name for which the blackboard cannot create an entry.
    #[error(transparent)]
    Unfit(#[from] Unfit),
}

/// Why a script could not be executed. It becomes a part of the fault of the script's node.
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
    /// Parses a script. `slot` looks up the slot of each name now, so that a tick need not look up names.
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

    /// Executes the script. Returns whether the value of its last statement is true.
    pub(crate) fn holds(&self, blackboard: &mut Blackboard) -> Result<bool, Trouble> {
        let value = self.carry_out(blackboard)?;
        truth_of(&value).ok_or_else(|| Trouble::NoTruth(shown(&value)))
    }
}

/// Returns a value as true or false; `None` if it is neither. As in BehaviorTree.CPP, texts, negative numbers, and
/// whole numbers other than 0 and 1 are neither.
fn truth_of(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(truth) => Some(*truth),
        Value::Int(0) => Some(false),
        Value::Int(1) => Some(true),
        Value::Number(number) if *number >= 0.0 => Some(*number > 0.0),
        Value::Int(_) | Value::Number(_) | Value::Text(_) | Value::Cell(_) => None,
    }
}

/// Returns a value for an error message, cut to the length of a line.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = value.to_string();
    let quote = if matches!(value, Value::Text(_)) { "'" } else { "" };
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{quote}{}…{quote}", &text[..end]),
        None => format!("{quote}{text}{quote}"),
    }
}
