//! Parses tokens into expressions. These are the operators of BehaviorTree.CPP, the loosest first:
//! `:= = += -= *= /=`, then `? :`, then `&& ||` (with equal precedence, from the left), then comparisons (in chains).
//! After these comes one of two groups: arithmetic with `..`, `+ -`, `* /` and `-x`, or bitwise operators with `| ^`,
//! `&` and `!x ~x`. The two groups can be mixed only with parentheses.

use super::token::{Token, tokens};
use super::{Assignment, Comparison, DEEPEST_EXPRESSION, Expression, Infix, Prefix, Script, ScriptError};
use crate::blackboard::{Slot, Unfit};
use crate::value::Value;

type Level<T> = &'static [(&'static str, T)];

const ASSIGNMENTS: Level<Assignment> = &[
    (":=", Assignment::Create),
    ("=", Assignment::Existing),
    ("+=", Assignment::Plus),
    ("-=", Assignment::Minus),
    ("*=", Assignment::Times),
    ("/=", Assignment::Divide),
];
const LOGIC: Level<Infix> = &[("&&", Infix::And), ("||", Infix::Or)];
const COMPARISONS: Level<Comparison> = &[
    ("==", Comparison::Equal),
    ("!=", Comparison::NotEqual),
    ("<", Comparison::Less),
    (">", Comparison::Greater),
    ("<=", Comparison::LessOrEqual),
    (">=", Comparison::GreaterOrEqual),
];
/// Arithmetic operators, the loosest first.
const ARITHMETIC: [Level<Infix>; 3] =
    [&[("..", Infix::Concat)], &[("+", Infix::Plus), ("-", Infix::Minus)], &[("*", Infix::Times), ("/", Infix::Divide)]];
const BIT_PREFIXES: Level<Prefix> = &[("~", Prefix::Complement), ("!", Prefix::Not)];
const BITS: [Level<Infix>; 2] = [&[("|", Infix::BitOr), ("^", Infix::BitXor)], &[("&", Infix::BitAnd)]];

pub(super) fn parse(text: &str, slot: &mut dyn FnMut(&str) -> Result<Slot, Unfit>) -> Result<Script, ScriptError> {
    let mut parser = Parser { tokens: tokens(text)?, next: 0, depth: 0, expressions: Vec::new(), slot };
    let mut statements = Vec::new();
    loop {
        while parser.take(";") {}
        if *parser.peek() == Token::End {
            break;
        }
        statements.push(parser.assignment()?);
        if *parser.peek() != Token::End && !parser.is_next(";") {
            return parser.unexpected("; or the end");
        }
    }
    if statements.is_empty() {
        return Err(ScriptError::Empty);
    }
    Ok(Script { expressions: parser.expressions, statements })
}

struct Parser<'a> {
    tokens: Vec<(usize, Token)>,
    next: usize,
    depth: usize,
    expressions: Vec<Expression>,
    slot: &'a mut dyn FnMut(&str) -> Result<Slot, Unfit>,
}

impl Parser<'_> {
    /// Returns the next token. This cannot fail, because the list ends with `End`, which is never passed.
    fn peek(&self) -> &Token {
        &self.tokens[self.next].1
    }

    fn is_next(&self, sign: &str) -> bool {
        matches!(self.peek(), Token::Sign(next) if *next == sign)
    }

    fn take(&mut self, sign: &str) -> bool {
        let is_next = self.is_next(sign);
        self.next += usize::from(is_next);
        is_next
    }

    fn operator<T: Copy>(&mut self, level: Level<T>) -> Option<T> {
        let (_, operator) = level.iter().find(|(sign, _)| self.is_next(sign))?;
        self.next += 1;
        Some(*operator)
    }

    fn unexpected<T>(&self, wanted: &'static str) -> Result<T, ScriptError> {
        let (at, token) = &self.tokens[self.next];
        let found = match token {
            Token::Value(value) => super::shown(value),
            Token::Name(name) => name.clone(),
            Token::Sign(sign) => (*sign).to_owned(),
            Token::End => "the end".to_owned(),
        };
        Err(ScriptError::Unexpected { at: *at, found, wanted })
    }

    fn push(&mut self, expression: Expression) -> usize {
        self.expressions.push(expression);
        self.expressions.len() - 1
    }

    fn assignment(&mut self) -> Result<usize, ScriptError> {
        self.depth += 1;
        if self.depth > DEEPEST_EXPRESSION {
            return Err(ScriptError::TooDeep);
        }
        let left = self.choice()?;
        let at = self.tokens[self.next].0;
        let result = match self.operator(ASSIGNMENTS) {
            None => left,
            Some(operator) => {
                let Expression::Entry(slot) = self.expressions[left] else { return Err(ScriptError::NoEntry(at)) };
                let right = self.choice()?;
                self.push(Expression::Assign(operator, slot, right))
            }
        };
        self.depth -= 1;
        Ok(result)
    }

    fn choice(&mut self) -> Result<usize, ScriptError> {
        let condition = self.logic()?;
        if !self.take("?") {
            return Ok(condition);
        }
        let then = self.assignment()?;
        if !self.take(":") {
            return self.unexpected(":");
        }
        let otherwise = self.logic()?;
        Ok(self.push(Expression::Choice(condition, then, otherwise)))
    }

    fn logic(&mut self) -> Result<usize, ScriptError> {
        let mut left = self.comparison()?;
        let mut length = 0;
        while let Some(operator) = self.operator(LOGIC) {
            length = self.longer(length)?;
            let right = self.comparison()?;
            left = self.push(Expression::Infix(operator, left, right));
        }
        Ok(left)
    }

    fn comparison(&mut self) -> Result<usize, ScriptError> {
        let first = self.operand()?;
        let mut chain = Vec::new();
        while let Some(operator) = self.operator(COMPARISONS) {
            chain.push((operator, self.operand()?));
        }
        Ok(if chain.is_empty() { first } else { self.push(Expression::Chain(first, chain)) })
    }

    /// Parses an operand of a comparison. It is an arithmetic or a bitwise expression, but not a mixture of both.
    fn operand(&mut self) -> Result<usize, ScriptError> {
        let is_bits = self.is_next("~") || self.is_next("!");
        let is_arithmetic = self.is_next("-");
        let first = if is_bits { self.bit_operand()? } else { self.number_operand()? };
        let after =
            |parser: &Self, levels: &[Level<Infix>]| levels.iter().copied().flatten().any(|(sign, _)| parser.is_next(sign));
        let result = if after(self, &ARITHMETIC) && !is_bits {
            self.infix(first, &ARITHMETIC, Self::number_operand)?
        } else if after(self, &BITS) && !is_arithmetic {
            self.infix(first, &BITS, Self::bit_operand)?
        } else {
            first
        };
        if after(self, &ARITHMETIC) || after(self, &BITS) {
            return self.unexpected("parentheses between arithmetic and bit operators");
        }
        Ok(result)
    }

    /// Parses the operators of these levels, the loosest first. Their first operand is parsed already.
    fn infix(
        &mut self,
        first: usize,
        levels: &[Level<Infix>],
        operand: fn(&mut Self) -> Result<usize, ScriptError>,
    ) -> Result<usize, ScriptError> {
        let Some((level, tighter)) = levels.split_first() else { return Ok(first) };
        let mut left = self.infix(first, tighter, operand)?;
        let mut length = 0;
        while let Some(operator) = self.operator(level) {
            length = self.longer(length)?;
            let next = operand(self)?;
            let right = self.infix(next, tighter, operand)?;
            left = self.push(Expression::Infix(operator, left, right));
        }
        Ok(left)
    }

    /// Checks the length of a chain of operators. The chain is nested to the left, so its length counts as depth.
    fn longer(&self, length: usize) -> Result<usize, ScriptError> {
        if self.depth + length >= DEEPEST_EXPRESSION { Err(ScriptError::TooDeep) } else { Ok(length + 1) }
    }

    /// Parses an operand with its prefix operators, which may be repeated. A `+` is allowed only as a part of a
    /// number.
    fn number_operand(&mut self) -> Result<usize, ScriptError> {
        let mut minuses = 0;
        while self.take("-") {
            minuses = self.longer(minuses)?;
        }
        if self.is_next("+")
            && matches!(self.tokens.get(self.next + 1), Some((_, Token::Value(Value::Int(_) | Value::Number(_)))))
        {
            self.next += 1;
        }
        let mut operand = self.atom()?;
        for _ in 0..minuses {
            operand = self.push(Expression::Prefix(Prefix::Minus, operand));
        }
        Ok(operand)
    }

    fn bit_operand(&mut self) -> Result<usize, ScriptError> {
        let mut prefixes = Vec::new();
        while let Some(prefix) = self.operator(BIT_PREFIXES) {
            self.longer(prefixes.len())?;
            prefixes.push(prefix);
        }
        let atom = self.atom()?;
        Ok(prefixes.into_iter().rev().fold(atom, |operand, prefix| self.push(Expression::Prefix(prefix, operand))))
    }

    fn atom(&mut self) -> Result<usize, ScriptError> {
        let token = self.peek().clone();
        match token {
            Token::Value(value) => {
                self.next += 1;
                Ok(self.push(Expression::Literal(value)))
            }
            Token::Name(name) => {
                self.next += 1;
                let slot = (self.slot)(&name)?;
                Ok(self.push(Expression::Entry(slot)))
            }
            Token::Sign("(") => {
                self.next += 1;
                let inner = self.assignment()?;
                if self.take(")") { Ok(inner) } else { self.unexpected(")") }
            }
            Token::Sign(_) | Token::End => self.unexpected("a value"),
        }
    }
}
