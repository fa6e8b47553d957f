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
use serde::Deserialize;

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

#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "toml::Value")]
pub struct Expression {
    text: String,
    /// Each variable, and the column where it first occurs.
    variables: Vec<(String, usize)>,
    steps: Vec<Step>,
}

impl TryFrom<toml::Value> for Expression {
    type Error = String;

    fn try_from(value: toml::Value) -> Result<Expression, String> {
        match value {
            toml::Value::String(text) => Expression::parse(&text),
            toml::Value::Integer(_) | toml::Value::Float(_) => {
                Expression::parse(&value.to_string())
            }
            _ => Err("an expression in quotes, or a number, is expected".into()),
        }
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Expression {
    /// Parses an expression; names of variables are not checked.
    pub fn parse(text: &str) -> Result<Expression, String> {
        let expression = Expression { text: text.into(), variables: Vec::new(), steps: Vec::new() };
        let mut parser = Parser { rest: text.chars().collect(), at: 0, depth: 0, expression };
        let parsed = parser.operand(0).and_then(|()| match parser.peek() {
            None => Ok(()),
            Some(_) => Err(format!("an operator is expected, not {}", parser.found())),
        });
        let column = parser.at + 1;
        parsed.map(|()| parser.expression).map_err(|problem| {
            format!("cannot read the expression '{text}': at column {column}, {problem}")
        })
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
                if self.peek() != Some(')') {
                    return Err(format!("an operator or ')' is expected, not {}", self.found()));
                }
                self.at += 1;
                Ok(())
            }
            Some('0'..='9' | '.') => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => {
                self.variable();
                Ok(())
            }
            _ => Err(format!("a number, a variable or '(' is expected, not {}", self.found())),
        }
    }

    /// Returns the text up to the first place where `is_part` fails.
    fn take(&mut self, is_part: impl Fn(&[char], usize) -> bool) -> String {
        let start = self.at;
        while self.at < self.rest.len() && is_part(&self.rest, self.at) {
            self.at += 1;
        }
        self.rest[start..self.at].iter().collect()
    }

    fn number(&mut self) -> Result<(), String> {
        let start = self.at;
        let text = self.take(|all, k| {
            let digit = |k: usize| all.get(k).is_some_and(char::is_ascii_digit);
            match all[k] {
                // The exponent is part of the number if it has digits.
                'e' | 'E' => {
                    digit(k + 1) || matches!(all.get(k + 1), Some('+' | '-')) && digit(k + 2)
                }
                '+' | '-' => matches!(all[k - 1], 'e' | 'E'),
                c => c.is_ascii_digit() || c == '.',
            }
        });
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        if number.is_none() {
            self.at = start;
        }
        let number = number.ok_or_else(|| format!("'{text}' is not a finite number"))?;
        self.expression.steps.push(Step::Number(number));
        Ok(())
    }

    fn variable(&mut self) {
        let column = self.at + 1;
        let name = self.take(|all, k| all[k].is_alphanumeric() || all[k] == '_');
        let variables = &mut self.expression.variables;
        let k = variables.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
            variables.push((name, column));
            variables.len() - 1
        });
        self.expression.steps.push(Step::Variable(k));
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
