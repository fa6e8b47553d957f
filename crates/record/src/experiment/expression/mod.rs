//! Expressions of claims and figures: `(list_push + list_step) / n`, `10^6`.
//!
//! Numbers may have an exponent (`1e6`). `^` binds tightest and groups to the right, then the minus
//! sign, then `*` and `/`, then `+` and `-`: `-n^2` is -(n²), `2^-1` is 1/2. An identifier is a
//! variable.
//!
//! A precedence-climbing (Pratt) parser translates the expression to postfix order, which is
//! evaluated on a stack.

use std::fmt;

use crate::record::column::Column;
use crate::record::outcome::Pass;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};

/// Maximum nesting of parentheses, signs and powers; it bounds the recursion of the parser.
const DEEPEST: u32 = 64;

type Binary = fn(f64, f64) -> f64;

#[derive(Clone, Copy, Debug)]
enum Step {
    Number(f64),
    Variable(usize),
    Negate,
    Binary(Binary),
}

#[derive(Clone, Debug)]
pub struct Expression {
    text: String,
    /// Each variable, and the column where it first occurs.
    variables: Vec<(String, usize)>,
    steps: Vec<Step>,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot read the expression '{text}': at column {column}, {problem}")]
pub struct NotAnExpression {
    text: String,
    /// Place of the error in the text, in characters from 1.
    pub column: usize,
    problem: String,
}

impl<'de> Deserialize<'de> for Expression {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Expression, D::Error> {
        deserializer.deserialize_any(TextOrNumber)
    }
}

struct TextOrNumber;

impl Visitor<'_> for TextOrNumber {
    type Value = Expression;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an expression in quotes, or a number")
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Expression, E> {
        self.visit_str(&value.to_string())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Expression, E> {
        self.visit_str(&value.to_string())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Expression, E> {
        Expression::parse(text).map_err(E::custom)
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Expression {
    /// Parses an expression; names of variables are not checked.
    pub fn parse(text: &str) -> Result<Expression, NotAnExpression> {
        let expression = Expression { text: text.into(), variables: Vec::new(), steps: Vec::new() };
        let mut parser = Parser { rest: text.chars().collect(), at: 0, depth: 0, expression };
        match parser.operand(0).and_then(|()| parser.end()) {
            Ok(()) => Ok(parser.expression),
            Err(problem) => {
                Err(NotAnExpression { text: text.into(), column: parser.at + 1, problem })
            }
        }
    }

    pub fn variables(&self) -> impl Iterator<Item = (&str, usize)> {
        self.variables.iter().map(|(name, column)| (name.as_str(), *column))
    }

    pub fn uses_time(&self) -> bool {
        self.variables().any(|(name, _)| {
            Column::find(name).is_some_and(|column| column.pass == Some(Pass::Time))
        })
    }

    pub fn evaluate(&self, value: impl Fn(&str) -> Option<f64>) -> Option<f64> {
        let values: Option<Vec<f64>> = self.variables().map(|(name, _)| value(name)).collect();
        let values = values?;
        let mut stack: Vec<f64> = Vec::new();
        for step in &self.steps {
            let result = match *step {
                Step::Number(number) => number,
                Step::Variable(k) => values[k],
                Step::Negate => -stack.pop()?,
                Step::Binary(function) => {
                    let right = stack.pop()?;
                    function(stack.pop()?, right)
                }
            };
            stack.push(result);
        }
        stack.pop()
    }
}

struct Parser {
    rest: Vec<char>,
    at: usize,
    depth: u32,
    expression: Expression,
}

/// Binding strength of the minus sign, between `*` and `^`.
const SIGN: u8 = 5;

fn operator(sign: char) -> Option<(u8, u8, Binary)> {
    Some(match sign {
        '+' => (1, 2, |a, b| a + b),
        '-' => (1, 2, |a, b| a - b),
        '*' => (3, 4, |a, b| a * b),
        '/' => (3, 4, |a, b| a / b),
        '^' => (8, 7, f64::powf),
        _ => return None,
    })
}

impl Parser {
    /// Parses an operand and the operators after it that bind at least as tightly as `least`.
    fn operand(&mut self, least: u8) -> Result<(), String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("it is nested more than {DEEPEST} levels deep"));
        }
        self.first()?;
        while let Some((left, right, function)) = self.peek().and_then(operator) {
            if left < least {
                break;
            }
            self.at += 1;
            self.operand(right)?;
            self.expression.steps.push(Step::Binary(function));
        }
        self.depth -= 1;
        Ok(())
    }

    fn first(&mut self) -> Result<(), String> {
        match self.peek() {
            Some('-') => {
                self.at += 1;
                self.operand(SIGN)?;
                self.expression.steps.push(Step::Negate);
                Ok(())
            }
            Some('(') => {
                self.at += 1;
                self.operand(0)?;
                self.closed()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => {
                self.variable();
                Ok(())
            }
            _ => Err(format!("a number, a variable or '(' is expected, not {}", self.found())),
        }
    }

    fn number(&mut self) -> Result<(), String> {
        let start = self.at;
        let digits = |parser: &mut Parser| {
            while parser.rest.get(parser.at).is_some_and(char::is_ascii_digit) {
                parser.at += 1;
            }
        };
        digits(self);
        if self.rest.get(self.at) == Some(&'.') {
            self.at += 1;
            digits(self);
        }
        if matches!(self.rest.get(self.at), Some('e' | 'E')) {
            let signed = matches!(self.rest.get(self.at + 1), Some('+' | '-'));
            let exponent = self.at + 1 + usize::from(signed);
            if self.rest.get(exponent).is_some_and(char::is_ascii_digit) {
                self.at = exponent;
                digits(self);
            }
        }
        let text: String = self.rest[start..self.at].iter().collect();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.expression.steps.push(Step::Number(number));
                Ok(())
            }
            _ => {
                self.at = start;
                Err(format!("'{text}' is not a finite number"))
            }
        }
    }

    fn variable(&mut self) {
        let start = self.at;
        while self.rest.get(self.at).is_some_and(|c| c.is_alphanumeric() || *c == '_') {
            self.at += 1;
        }
        let name: String = self.rest[start..self.at].iter().collect();
        let variables = &mut self.expression.variables;
        let k = variables.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
            variables.push((name, start + 1));
            variables.len() - 1
        });
        self.expression.steps.push(Step::Variable(k));
    }

    fn closed(&mut self) -> Result<(), String> {
        if self.peek() != Some(')') {
            return Err(format!("an operator or ')' is expected, not {}", self.found()));
        }
        self.at += 1;
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        match self.peek() {
            None => Ok(()),
            Some(_) => Err(format!("an operator is expected, not {}", self.found())),
        }
    }

    fn peek(&mut self) -> Option<char> {
        while self.rest.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.rest.get(self.at).copied()
    }

    fn found(&mut self) -> String {
        self.peek().map_or("its end".into(), |c| format!("'{c}'"))
    }
}

#[cfg(test)]
mod tests;
