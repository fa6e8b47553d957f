//! What a list that differs may mean, in words and options.

use crate::check::listed::Meaning;
use crate::check::reading::{Deviation, ImagesOf, Reading, TakenBox};
use crate::cli::verify::{Verified, counted};
use crate::io::boxes::along;
use crate::number::number;

fn flag(meaning: Meaning) -> String {
    match meaning {
        Meaning::Base(base) => format!("--base {base}"),
        Meaning::Ids => "--ids".into(),
    }
}

/// The axes as --periodic takes them.
fn letters(axes: [bool; 3]) -> String {
    let names = ["x", "y", "z"].into_iter().zip(axes).filter(|(_, yes)| *yes);
    names.map(|(name, _)| name).collect()
}

/// Upwards to three digits, in the fewest that read back.
fn rounded_up(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    let up = format!("{:.2e}", (value / step).ceil() * step).parse().unwrap_or(value);
    if up >= value { up } else { value }
}

impl Verified<'_> {
    /// The options with which the list would be read so.
    pub(super) fn flags(&self, reading: &Reading) -> Vec<String> {
        let mut flags = Vec::new();
        if reading.meaning != self.naming {
            flags.push(flag(reading.meaning));
        }
        if reading.both_sides {
            flags.push("--both-sides".into());
        }
        match reading.deviation {
            Some(Deviation::Rounded(arithmetic)) => {
                flags.push(format!("--arithmetic {}", arithmetic.name()))
            }
            Some(Deviation::Skin(gap)) => flags.push(format!("--skin {}", rounded_up(gap))),
            _ => {}
        }
        match reading.taken {
            TakenBox::All | TakenBox::WithoutOwn | TakenBox::Nearest => {}
            TakenBox::Open => flags.push("--open".into()),
            TakenBox::Along(axes) => flags.push(format!("--periodic {}", letters(axes))),
            TakenBox::Straight(edges) => {
                let edges = edges[..self.scene.dim()].iter().map(|edge| format!("{edge:?}"));
                flags.push(format!("--box {}", edges.collect::<Vec<_>>().join(",")));
            }
        }
        if let Some(axes) = reading.declared.filter(|_| !self.repeats) {
            flags.push(format!("--periodic {}", letters(axes)));
        }
        if let Some(lengths) = &reading.periodic {
            let axes: String = lengths
                .iter()
                .zip(["x", "y", "z"])
                .filter_map(|(length, axis)| length.map(|_| axis))
                .collect();
            if !self.boxed {
                // The length of an axis that is open is not looked at.
                let edges: Vec<String> =
                    lengths.iter().map(|length| format!("{:?}", length.unwrap_or(0.0))).collect();
                flags.push(format!("--box {}", edges.join(",")));
            }
            flags.push(format!("--periodic {axes}"));
        }
        flags
    }

    /// How the list would agree, and what to do.
    pub(super) fn sentence(&self, reading: &Reading) -> String {
        let mut with = Vec::new();
        if reading.meaning != self.naming {
            with.push(match reading.meaning {
                Meaning::Base(base) => format!("numbers from {base}"),
                Meaning::Ids => "ids of the particles' file as numbers".into(),
            });
        }
        if reading.both_sides {
            with.push("each pair taken once, which is listed as i,j and as j,i".into());
        }
        match reading.deviation {
            None => {}
            Some(Deviation::Rounded(arithmetic)) => {
                with.push(format!("contacts decided in {}", arithmetic.name()))
            }
            Some(Deviation::Strict) => {
                with.push("< in the place of <= (the pairs missed touch in one point)".into())
            }
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
        if let Some(lengths) = &reading.periodic {
            let along = lengths.iter().zip(["x", "y", "z"]);
            let box_of = |(length, axis): (&Option<f64>, &str)| {
                length.map(|length| format!("{} along {axis}", number(length)))
            };
            let lengths: Vec<String> = along.filter_map(box_of).collect();
            with.push(format!("periodic images (a box of {})", lengths.join(", ")));
        }
        if let Some(axes) = reading.declared {
            with.push(format!("the file's box, repeating along {}", along(axes)));
        }
        match reading.images {
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
                let none = self.list.images.iter().flatten().all(|image| *image == [0; 3]);
                let why = if none { " (all that are named are 0)" } else { "" };
                with.push(format!("the images of the list left out{why}"))
            }
        }
        match reading.taken {
            TakenBox::All => {}
            TakenBox::Open => with.push("open boundaries (no contact across the box)".into()),
            TakenBox::WithoutOwn => with.push("no contact of a particle with its own image".into()),
            TakenBox::Nearest => {
                with.push("no image but the nearest of each pair (minimum image)".into())
            }
            TakenBox::Along(axes) => with.push(format!("a box that repeats along {}", along(axes))),
            TakenBox::Straight(_) => with.push("a box without its tilt".into()),
        }
        let result = match reading.wrong {
            0 if reading.listed == 1 => "the one pair agrees".into(),
            0 => format!("all {} agree", counted(reading.listed, "pair")),
            wrong => format!("all but {} agree", counted(wrong, "pair")),
        };
        let flags = self.flags(reading);
        let input = &self.options.input;
        // What nobody need say is what the file says.
        let instead = match reading.periodic.is_some() || reading.declared.is_some() {
            true if input.open => ": leave out --open",
            true if input.periodic.is_some() => ": leave out --periodic none",
            _ => "",
        };
        let flag = |name: &str| flags.iter().any(|flag| flag.starts_with(name));
        let there = input.periodic.is_some() && flag("--periodic")
            || input.edges.is_some() && (flag("--box") || flag("--open"))
            || input.periodic.is_some() && flag("--open");
        let flags = flags.join(" ");
        let add = match (flags.is_empty(), instead.is_empty()) {
            (true, _) => String::new(),
            (_, false) => format!(", and add {flags}"),
            (_, true) if there => format!(": give {flags} in the place of what is there"),
            _ => format!(": add {flags}"),
        };
        format!("with {}, {result}{instead}{add}", with.join(", and "))
    }
}
