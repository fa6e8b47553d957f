//! What a list that differs may mean, in words and options.

use crate::check::listed::Meaning;
use crate::check::reading::words::rounded_up;
use crate::check::reading::{Deviation, Reading, TakenBox};
use crate::cli::verify::Verified;

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
        let no_images = self.list.images.iter().flatten().all(|image| *image == [0; 3]);
        let with = reading.sentence(self.naming, no_images);
        let flags = self.flags(reading);
        let input = &self.options.input;
        // What nobody need say is what the file says.
        let instead = match reading.periodic.is_some() || reading.declared.is_some() {
            true if input.boundaries.open => ": leave out --open",
            true if input.boundaries.periodic.is_some() => ": leave out --periodic none",
            _ => "",
        };
        let flag = |name: &str| flags.iter().any(|flag| flag.starts_with(name));
        let there = input.boundaries.periodic.is_some() && flag("--periodic")
            || input.boundaries.edges.is_some() && (flag("--box") || flag("--open"))
            || input.boundaries.periodic.is_some() && flag("--open");
        let flags = flags.join(" ");
        let add = match (flags.is_empty(), instead.is_empty()) {
            (true, _) => String::new(),
            (_, false) => format!(", and add {flags}"),
            (_, true) if there => format!(": give {flags} in the place of what is there"),
            _ => format!(": add {flags}"),
        };
        format!("{with}{instead}{add}")
    }
}
