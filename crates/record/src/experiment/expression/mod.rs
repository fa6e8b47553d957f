//! Expressions of claims and figures: `(list_push + list_step) / n`, `10^6`.
//!
//! Numbers may have an exponent (`1e6`). `^` binds tightest and groups to the right, then the minus
//! sign, then `*` and `/`, then `+` and `-`: `-n^2` is -(n²), `2^-1` is 1/2. An identifier is a
//! variable.
//!
//! A precedence-climbing (Pratt) parser evaluates the expression while it reads the text.

use std::fmt;

use crate::record::column::Column;
use crate::record::outcome::Pass;
use serde::Deserialize;

/// Maximum nesting of parentheses, signs and powers; it bounds the recursion of the parser.
const DEEPEST: u32 = 64;

type Binary = fn(f64, f64) -> f64;

#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "toml::Value")]
pub struct Expression {
    text: String,
    /// Each variable, and the column where it first occurs.
    variables: Vec<(String, usize)>,
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
        let mut variables: Vec<(String, usize)> = Vec::new();
        read(text, &mut |name, column| {
            if variables.iter().all(|(known, _)| known != name) {
                variables.push((name.into(), column));
            }
            0.0
        })?;
        Ok(Expression { text: text.into(), variables })
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
        let mut known = true;
        let found = read(&self.text, &mut |name, _| {
            let value = value(name);
            known &= value.is_some();
            value.unwrap_or(0.0)
        });
        found.ok().filter(|_| known)
    }
}

/// Returns the value of an expression. `value` returns that of a variable, from its name and
/// column.
fn read(text: &str, value: &mut dyn FnMut(&str, usize) -> f64) -> Result<f64, String> {
    let mut parser = Parser { rest: text.chars().collect(), at: 0, depth: 0, value };
    let found = parser.operand(0).and_then(|found| match parser.peek() {
        None => Ok(found),
        Some(_) => Err(format!("an operator is expected, not {}", parser.found())),
    });
    found.map_err(|problem| {
        format!("cannot read the expression '{text}': at column {}, {problem}", parser.at + 1)
    })
}

struct Parser<'a> {
    rest: Vec<char>,
    at: usize,
    depth: u32,
    value: &'a mut dyn FnMut(&str, usize) -> f64,
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

impl Parser<'_> {
    /// Evaluates an operand and the operators after it that bind at least as tightly as `least`.
    fn operand(&mut self, least: u8) -> Result<f64, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("it is nested more than {DEEPEST} levels deep"));
        }
        let mut value = self.first()?;
        while let Some((left, right, function)) = self.peek().and_then(operator) {
            if left < least {
                break;
            }
            self.at += 1;
            value = function(value, self.operand(right)?);
        }
        self.depth -= 1;
        Ok(value)
    }

    fn first(&mut self) -> Result<f64, String> {
        match self.peek() {
            Some('-') => {
                self.at += 1;
                Ok(-self.operand(SIGN)?)
            }
            Some('(') => {
                self.at += 1;
                let value = self.operand(0)?;
                if self.peek() != Some(')') {
                    return Err(format!("an operator or ')' is expected, not {}", self.found()));
                }
                self.at += 1;
                Ok(value)
            }
            Some('0'..='9' | '.') => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => {
                let column = self.at + 1;
                let name = self.take(|all, k| all[k].is_alphanumeric() || all[k] == '_');
                Ok((self.value)(&name, column))
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

    fn number(&mut self) -> Result<f64, String> {
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
        text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            self.at = start;
            format!("'{text}' is not a finite number")
        })
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
