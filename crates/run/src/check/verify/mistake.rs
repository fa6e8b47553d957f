//! Common mistakes in contact lists, as words and as options of `verify`.

use crate::check::verify::listing::Meaning;
use contactbench_ground::contact::Arithmetic;
use contactbench_io::boxes::along;
use contactbench_terms::number::{number, plural};

/// An interpretation of a list: assumed mistakes, and the differences that remain.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The assumed mistakes: in numbers, images, the definition of a contact, or the box.
    pub mistakes: Vec<Mistake>,
    pub listed: u64,
    pub wrong: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mistake {
    Numbers(Meaning),
    BothSides,
    ImagesOfFirst,
    /// Images are relative to particles wrapped into the box.
    ImagesWrapped,
    /// The list's pairs are right but its images are not; `zero` if all images are 0.
    ImagesLeftOut {
        zero: bool,
    },
    Declared([bool; 3]),
    Rounded(Arithmetic),
    Strict,
    Closed,
    /// All differing pairs are tangent up to the last digits.
    Tangent,
    /// All pairs with at most this gap (a length) are listed.
    Skin(f64),
    Radii(f64),
    Open,
    WithoutOwn,
    Nearest,
    Along([bool; 3]),
    Straight([f64; 3]),
    /// The box has these periods; `None` along open axes.
    Periods([Option<f64>; 3]),
}

impl Mistake {
    /// Returns the mistake as a phrase that can follow the word "with".
    fn words(self) -> String {
        match self {
            Mistake::Numbers(Meaning::Base(base)) => format!("numbers from {base}"),
            Mistake::Numbers(Meaning::Ids) => "ids of the particles' file as numbers".into(),
            Mistake::BothSides => "each pair taken once, which is listed as i,j and as j,i".into(),
            Mistake::ImagesOfFirst => "images of i instead of j (S with the other sign)".into(),
            Mistake::ImagesWrapped => {
                "images that are counted from particles put into the box (in \
                                       the file some are outside)"
                    .into()
            }
            Mistake::ImagesLeftOut { zero } => format!(
                "the images of the list left out{}",
                if zero { " (all that are named are 0)" } else { "" }
            ),
            Mistake::Declared(axes) => format!("the file's box, periodic along {}", along(axes)),
            Mistake::Rounded(arithmetic) => format!("contacts decided in {}", arithmetic.name()),
            Mistake::Strict => {
                "contacts decided by < instead of <= (each pair missed is an exact tie: the \
                 distance is the sum of the radii)"
                    .into()
            }
            Mistake::Closed => {
                "contacts decided by <= instead of < (each spurious pair is an exact tie)".into()
            }
            Mistake::Tangent => "any answer for pairs that are tangent to the last digits".into(),
            Mistake::Skin(gap) => format!("pairs up to {} apart (a skin)", rounded_up(gap)),
            Mistake::Radii(by) => {
                let why = match by {
                    2.0 => " (diameters taken for radii?)",
                    0.5 => " (radii taken for diameters?)",
                    _ => "",
                };
                format!("radii {} times as large{why}", number(by))
            }
            Mistake::Open => "open boundaries (no contact across the box)".into(),
            Mistake::WithoutOwn => "no contact of a particle with its own image".into(),
            Mistake::Nearest => "no image but the nearest of each pair (minimum image)".into(),
            Mistake::Along(axes) => format!("a box periodic along {}", along(axes)),
            Mistake::Straight(_) => "a box without its tilt".into(),
            Mistake::Periods(periods) => {
                let of = |(period, axis): (Option<f64>, &str)| {
                    period.map(|period| format!("{} along {axis}", number(period)))
                };
                let periods = periods.into_iter().zip(["x", "y", "z"]).filter_map(of);
                let periods: Vec<String> = periods.collect();
                format!("periodic images (a box of {})", periods.join(", "))
            }
        }
    }

    /// Returns the options of `verify`, in `dim` dimensions, that accept a list with this mistake.
    pub fn flags(self, dim: usize) -> Option<String> {
        let lengths = |lengths: [f64; 3]| {
            lengths[..dim].iter().map(|length| format!("{length:?}")).collect::<Vec<_>>().join(",")
        };
        Some(match self {
            Mistake::Numbers(Meaning::Base(base)) => format!("--base {base}"),
            Mistake::Numbers(Meaning::Ids) => "--ids".into(),
            Mistake::BothSides => "--both-sides".into(),
            Mistake::Rounded(arithmetic) => format!("--arithmetic {}", arithmetic.name()),
            Mistake::Strict => "--rule open".into(),
            Mistake::Closed => "--rule closed".into(),
            Mistake::Skin(gap) => format!("--skin {}", rounded_up(gap)),
            Mistake::Open => "--open".into(),
            Mistake::Declared(axes) | Mistake::Along(axes) => {
                format!("--periodic {}", letters(axes))
            }
            Mistake::Straight(edges) => format!("--box {}", lengths(edges)),
            Mistake::Periods(periods) => format!(
                "--box {} --periodic {}",
                lengths(periods.map(Option::unwrap_or_default)),
                letters(periods.map(|period| period.is_some()))
            ),
            _ => return None,
        })
    }
}

fn letters(axes: [bool; 3]) -> String {
    let names = ["x", "y", "z"].into_iter().zip(axes).filter(|(_, yes)| *yes);
    names.map(|(name, _)| name).collect()
}

/// Rounds upwards, to three significant digits.
pub fn rounded_up(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    let up = format!("{:.2e}", (value / step).ceil() * step).parse().unwrap_or(value);
    if up >= value { up } else { value }
}

impl Reading {
    pub(super) fn plain(listed: u64) -> Reading {
        Reading { mistakes: Vec::new(), listed, wrong: 0 }
    }

    pub(super) fn declared(mut self, axes: [bool; 3]) -> Reading {
        let of_list = |it: &&Mistake| matches!(it, Mistake::Numbers(_) | Mistake::BothSides);
        let at = self.mistakes.iter().take_while(of_list).count();
        if !self.mistakes.iter().any(|it| matches!(it, Mistake::Along(_))) {
            self.mistakes.insert(at, Mistake::Declared(axes));
        }
        self
    }

    pub fn sentence(&self) -> String {
        let with: Vec<String> = self.mistakes.iter().map(|mistake| mistake.words()).collect();
        let pairs = |count: u64| plural(usize::try_from(count).unwrap_or(usize::MAX), "pair");
        let result = match self.wrong {
            0 if self.listed == 0 => "no pair is missed".into(),
            0 if self.listed == 1 => "the one pair agrees".into(),
            0 => format!("all {} agree", pairs(self.listed)),
            wrong => format!("all but {} agree", pairs(wrong)),
        };
        format!("with {}, {result}", with.join(", and "))
    }
}
