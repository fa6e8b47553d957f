//! How a figure marks a cell without a value: a letter in a disc.

use crate::figure::canvas::{Canvas, Point, Text};
use crate::figure::style::{Colour, ink_on};
use contactbench_record::record::row::Outcome;

/// The letter that marks an outcome, and what it says.
pub fn letter(outcome: Outcome) -> (&'static str, &'static str) {
    match outcome {
        Outcome::Ok => ("", "ok"),
        Outcome::Lossy => ("", "lossy"),
        Outcome::Control => ("", "control"),
        Outcome::Wrong => ("W", "wrong answer"),
        Outcome::Timeout => ("T", "time limit"),
        Outcome::OutOfMemory => ("M", "memory limit"),
        Outcome::Refused => ("R", "refused"),
        Outcome::Unavailable => ("U", "unavailable"),
        Outcome::Crashed => ("C", "crashed"),
    }
}

/// A letter in a disc: the mark of a cell without a value.
pub fn badge(canvas: &mut Canvas, at: Point, letter: &str, colour: Colour) -> anyhow::Result<()> {
    canvas.disc(at, 7.5, colour)?;
    canvas.text(letter, (at.0, at.1), Text::new(13.0, ink_on(colour)).bold().anchor(0))
}
