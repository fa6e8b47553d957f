//! Tests whether a common mistake explains a list that differs from the truth.

use crate::verify::compare::Against;
use crate::verify::frames::counted;
use crate::verify::listing::{Listing, Meaning};
use crate::verify::{Allowed, Job, Naming, Verification, WORST, truth, within};
use contactbench_detectors::near::contacts;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::ContactList;

/// Memory that the tests may need, in bytes per pair of the list and of the truth.
const TEST_BYTES: u64 = 128;

/// A mistake that explains a list, and the differences that remain.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    pub mistake: Mistake,
    pub listed: u64,
    pub wrong: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mistake {
    Numbers(Meaning),
    BothSides,
    /// Pairs at exactly the sum of the radii are missed, or are listed although the rule is `<`.
    Ties {
        missed: bool,
    },
    /// All pairs with at most this gap (a length) are listed.
    Skin(f64),
    Diameters,
}

/// Returns the mistake that explains most differences, at least half of them. Fails if memory runs
/// out.
pub fn explain(job: &Job<'_>, found: &Verification) -> anyhow::Result<Option<Reading>> {
    let terms = job.terms;
    let listed = job.list.pairs.len() as u64;
    // The tests only give a hint, so they must not use all memory. An empty list explains nothing,
    // unless all contacts are ties.
    if found.is_same()
        || terms.allowed != Allowed::default()
        || terms.without.is_some()
        || (listed + found.truth.len()).saturating_mul(TEST_BYTES) > terms.memory_limit
        || listed == 0 && found.errors.deepest_miss > 0.0
    {
        return Ok(None);
    }
    let none = ContactList::default();
    let mut readings = Vec::new();
    let mut test = |mistake, naming, both_sides, truth: &ContactList| -> anyhow::Result<()> {
        let listing = Listing::new(job, naming, both_sides, truth)?;
        let against = Against { space: job.space, truth, near: &none, skin: 0.0, kept: WORST };
        let faults = (listing.unknown.len() + listing.one_sided.len()) as u64;
        let wrong = against.hold(&listing).errors.wrong() + faults;
        let listed = if both_sides { listed.div_ceil(2) } else { listed };
        readings.push(Reading { mistake, listed, wrong });
        Ok(())
    };
    for naming in job.others {
        test(Mistake::Numbers(Naming::meaning(naming)), naming, false, &found.truth)?;
    }
    test(Mistake::BothSides, job.naming, true, &found.truth)?;
    // Contacts as other programs may define them. A definition without a truth explains nothing.
    let errors = found.errors;
    let (limit, mut others) = (terms.memory_limit, Vec::new());
    if errors.deepest_miss == 0.0 && errors.widest_false == 0.0 {
        let missed = terms.arithmetic == Arithmetic::Exact;
        let other = match terms.arithmetic {
            Arithmetic::Exact => Some(Arithmetic::ExactOpen),
            Arithmetic::ExactOpen => Some(Arithmetic::Exact),
            _ => None,
        };
        let ties = other.and_then(|other| truth(job.space, other, limit).ok());
        others.extend(ties.map(|ties| (Mistake::Ties { missed }, ties)));
    }
    // Larger radii come first, because some skin always explains their pairs, too.
    if errors.missed == 0 && errors.widest_false > 1.0 {
        let sized = job.space.resized(|r| (2.0 * r).min(f64::MAX)).ok();
        let wide = sized.and_then(|sized| contacts(&sized, limit).ok());
        others.extend(wide.map(|wide| (Mistake::Diameters, wide.into_iter().collect())));
    }
    // A single spurious pair does not suggest a skin.
    if errors.missed == 0 && errors.spurious > 1 {
        let near = within(job.space, found.widest_gap, limit).ok();
        others.extend(near.map(|near| (Mistake::Skin(found.widest_gap), near)));
    }
    for (mistake, contacts) in &others {
        test(*mistake, job.naming, false, contacts)?;
    }
    let best = readings.into_iter().min_by_key(|reading| reading.wrong);
    Ok(best.filter(|reading| reading.wrong < found.wrong().div_ceil(2)))
}

impl Mistake {
    /// Returns the mistake as a phrase that can follow the word "with".
    fn words(self) -> String {
        match self {
            Mistake::Numbers(Meaning::Base(base)) => format!("numbers from {base}"),
            Mistake::Numbers(Meaning::Ids) => "ids of the particles' file as numbers".into(),
            Mistake::BothSides => "each pair taken once, which is listed as i,j and as j,i".into(),
            Mistake::Ties { missed: true } => "contacts decided by < instead of <=".into(),
            Mistake::Ties { missed: false } => "contacts decided by <= instead of <".into(),
            Mistake::Skin(gap) => format!("pairs up to {} apart (a skin)", rounded_up(gap)),
            Mistake::Diameters => "radii 2 times as large (diameters taken for radii?)".into(),
        }
    }

    /// Returns the options of `verify` that accept a list with this mistake; empty if none do.
    pub fn flags(self) -> String {
        match self {
            Mistake::Numbers(Meaning::Base(base)) => format!("--base {base}"),
            Mistake::Numbers(Meaning::Ids) => "--ids".into(),
            Mistake::BothSides => "--both-sides".into(),
            Mistake::Ties { missed: true } => "--arithmetic exact-open".into(),
            Mistake::Ties { missed: false } => "--arithmetic exact".into(),
            Mistake::Skin(gap) => format!("--skin {}", rounded_up(gap)),
            Mistake::Diameters => String::new(),
        }
    }
}

/// Rounds upwards, to three significant digits.
fn rounded_up(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    let up = format!("{:.2e}", (value / step).ceil() * step).parse().unwrap_or(value);
    if up >= value { up } else { value }
}

impl Reading {
    pub fn sentence(&self) -> String {
        let result = match self.wrong {
            0 => "the whole list agrees".into(),
            wrong => format!("all but {} agree", counted(wrong, "pair")),
        };
        format!("with {}, {result}", self.mistake.words())
    }

    /// Returns the sentence and the options that accept the list, if there are any.
    pub fn advice(&self) -> String {
        let flags = self.mistake.flags();
        let add = if flags.is_empty() { String::new() } else { format!(": add {flags}") };
        self.sentence() + &add
    }
}
