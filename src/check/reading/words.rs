//! A reading in words.

use super::{Deviation, ImagesOf, Reading, TakenBox};
use crate::check::listed::Meaning;
use crate::io::boxes::along;
use crate::number::{number, plural};

/// Upwards to three digits, in the fewest that read back.
pub fn rounded_up(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    let up = format!("{:.2e}", (value / step).ceil() * step).parse().unwrap_or(value);
    if up >= value { up } else { value }
}

impl Reading {
    /// How the list would agree, and how far: of a list whose numbers were taken to mean this, and
    /// whose images, if it has any, may all be 0.
    pub fn sentence(&self, meaning: Meaning, no_images: bool) -> String {
        let mut with = Vec::new();
        if self.meaning != meaning {
            with.push(match self.meaning {
                Meaning::Base(base) => format!("numbers from {base}"),
                Meaning::Ids => "ids of the particles' file as numbers".into(),
            });
        }
        if self.both_sides {
            with.push("each pair taken once, which is listed as i,j and as j,i".into());
        }
        match self.deviation {
            None => {}
            Some(Deviation::Rounded(arithmetic)) => {
                with.push(format!("contacts decided in {}", arithmetic.name()))
            }
            Some(Deviation::Strict) => with.push(
                "contacts decided by <, where here it is <= (each pair missed is an exact tie: \
                     the distance is the sum of the radii)"
                    .into(),
            ),
            Some(Deviation::Tangent) => {
                with.push("any answer for pairs that are tangent to the last digits".into())
            }
            Some(Deviation::Skin(gap)) => {
                with.push(format!("pairs up to {} apart (a skin)", rounded_up(gap)))
            }
            Some(Deviation::Radii(by)) => {
                let times = if [0.5, 2.0].contains(&by) { by.to_string() } else { number(by) };
                let slip = match by {
                    2.0 => ": diameters taken for radii?",
                    0.5 => ": radii taken for diameters?",
                    _ => "",
                };
                with.push(format!("radii {times} times as large{slip}"))
            }
        }
        if let Some(lengths) = &self.periodic {
            let along = lengths.iter().zip(["x", "y", "z"]);
            let box_of = |(length, axis): (&Option<f64>, &str)| {
                length.map(|length| format!("{} along {axis}", number(length)))
            };
            let lengths: Vec<String> = along.filter_map(box_of).collect();
            with.push(format!("periodic images (a box of {})", lengths.join(", ")));
        }
        if let Some(axes) = self.declared {
            with.push(format!("the file's box, repeating along {}", along(axes)));
        }
        match self.images {
            ImagesOf::Second => {}
            ImagesOf::First => {
                with.push("images of i in the place of those of j (S with the other sign)".into())
            }
            ImagesOf::Wrapped => with.push(
                "images that are counted from particles put into the box (in the file some are \
                 outside)"
                    .into(),
            ),
            ImagesOf::LeftOut => {
                let why = if no_images { " (all that are named are 0)" } else { "" };
                with.push(format!("the images of the list left out{why}"))
            }
        }
        match self.taken {
            TakenBox::All => {}
            TakenBox::Open => with.push("open boundaries (no contact across the box)".into()),
            TakenBox::WithoutOwn => with.push("no contact of a particle with its own image".into()),
            TakenBox::Nearest => {
                with.push("no image but the nearest of each pair (minimum image)".into())
            }
            TakenBox::Along(axes) => with.push(format!("a box that repeats along {}", along(axes))),
            TakenBox::Straight(_) => with.push("a box without its tilt".into()),
        }
        let result = match self.wrong {
            0 if self.listed == 1 => "the one pair agrees".into(),
            0 => format!("all {} agree", counted(self.listed, "pair")),
            wrong => format!("all but {} agree", counted(wrong, "pair")),
        };
        format!("with {}, {result}", with.join(", and "))
    }
}

/// A number of things.
pub fn counted(count: u64, what: &str) -> String {
    plural(usize::try_from(count).unwrap_or(usize::MAX), what)
}
