//! Tracker specifications: `every-step(nbs)` or `verlet(streamed-nbs,rule=half-skin,skin=0.2)`.

use std::fmt;

use crate::spec::{self, DetectorSpec, SpecError};
use crate::table::Speed;
use contactbench_ground::contact::{Margin, Test};
use contactbench_ground::detect::Options;
use contactbench_lists::track::{self, Rule, Skin, Tracker};
use contactbench_terms::grammar::{self, Spec};

/// Specification of a tracker over a detector of the table. [`fmt::Display`] writes its normal
/// form, and [`parse`] reads that back.
#[derive(Clone, Debug, PartialEq)]
pub enum TrackerSpec {
    /// Calls the detector in every frame.
    EveryStep(DetectorSpec),
    /// Keeps a list of near pairs.
    Verlet {
        /// Detector that builds the list.
        detector: DetectorSpec,
        /// Largest distance of listed particles from surface to surface.
        skin: Skin,
        /// Rule that decides when the list is rebuilt.
        rule: Rule,
    },
}

impl TrackerSpec {
    /// Creates a tracker that has no list yet. Its lists may take the memory limit of `options`,
    /// and its detector may take as much again.
    pub fn make(&self, options: Options) -> Box<dyn Tracker> {
        let detector = self.detector();
        let (search, fast) = (detector.make(options), detector.entry.speed == Speed::Fast);
        match *self {
            TrackerSpec::EveryStep(_) => track::every_step(search),
            TrackerSpec::Verlet { skin, rule, .. } => track::verlet(search, fast, skin, rule),
        }
    }

    /// Returns the tracker's name, and its parameters in the order of the text. The first
    /// parameter, `over`, is the detector.
    pub fn parts(&self) -> (&'static str, Vec<(&'static str, String)>) {
        let over = ("over", self.detector().to_string());
        match self {
            TrackerSpec::EveryStep(_) => ("every-step", vec![over]),
            TrackerSpec::Verlet { skin, rule, .. } => {
                ("verlet", vec![over, ("rule", rule.to_string()), ("skin", skin.to_string())])
            }
        }
    }

    /// Returns the rule and the skin without the detector, such as `top-two, 0.1`.
    pub fn setting(&self) -> String {
        match self {
            TrackerSpec::EveryStep(_) => "every step".into(),
            TrackerSpec::Verlet { skin, rule, .. } => format!("{rule}, {skin}"),
        }
    }

    /// Returns the detector that finds the contacts or builds the list.
    pub fn detector(&self) -> &DetectorSpec {
        match self {
            TrackerSpec::EveryStep(detector) | TrackerSpec::Verlet { detector, .. } => detector,
        }
    }

    /// Returns whether the rule may miss contacts.
    pub fn may_miss(&self) -> bool {
        matches!(self, TrackerSpec::Verlet { rule, .. } if !rule.is_safe())
    }

    /// Returns whether the tracker misses no contact under this test, for any motion. Textbook
    /// filters may lose contacts in every frame; lists are built without these filters.
    pub fn is_safe(&self, test: Test) -> bool {
        let safe = match self {
            TrackerSpec::EveryStep(_) => test.margin() != Some(Margin::Textbook),
            TrackerSpec::Verlet { .. } => !self.may_miss(),
        };
        safe && self.detector().entry.must_be_right()
    }
}

impl fmt::Display for TrackerSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, parts) = self.parts();
        write!(f, "{name}({}", self.detector())?;
        for (key, value) in parts.iter().skip(1) {
            write!(f, ",{key}={value}")?;
        }
        f.write_str(")")
    }
}

/// The forms of a tracker specification, each with its meaning.
pub const FORMS: [(&str, &str); 9] = [
    ("every-step(DETECTOR)", "calls the detector in every frame; DETECTOR alone is the same"),
    (
        "every-step(binary-tree:tree=kept)",
        "keeps the tree between frames and moves particles that left their leaf, as in the book",
    ),
    (
        "verlet(DETECTOR,rule=RULE,skin=S)",
        "keeps a list of all pairs at most S diameters apart and tests only those until the rule \
         requires a rebuild; the defaults are skin=0.1 and rule=top-two",
    ),
    (
        "skin=auto",
        "chooses the skin that minimises the cost of steps, or no list if that is cheaper; with \
         top-two, half-skin or summed",
    ),
    ("rule=top-two", "when the sum of the two largest displacements exceeds the skin: safe"),
    ("rule=half-skin", "when a displacement exceeds half the skin: safe"),
    ("rule=summed", "when each frame's largest displacement, summed, exceeds half the skin: safe"),
    ("rule=every-K", "in every K-th frame, whatever moves: not safe"),
    (
        "rule=lammps-DELAY-EVERY-yes",
        "as LAMMPS's neigh_modify delay every check (yes or no); its default is lammps-0-1-yes: \
         not safe if frames are not checked",
    ),
];

/// Why the text of a [`TrackerSpec`] is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TrackerError {
    /// The text is not one of the forms of a tracker.
    #[error(
        "'{0}' is not a tracker; write every-step(DETECTOR) or verlet(DETECTOR,rule=RULE,skin=S)"
    )]
    Form(String),
    /// `skin=auto` is combined with a rule that does not use displacements.
    #[error("'{0}': skin=auto needs rule=half-skin, top-two or summed, which track displacements")]
    Auto(String),
    /// A parameter is given twice or has an invalid value.
    #[error(transparent)]
    Grammar(#[from] grammar::Error),
    /// The detector's text is invalid.
    #[error(transparent)]
    Detector(#[from] SpecError),
}

/// Default skin: a tenth of a diameter, as in the granular benchmark of LAMMPS (`bench/in.chute`).
const SKIN: Skin = Skin::Diameters(0.1);

/// Parses a tracker. The name of a detector alone means `every-step` over that detector.
///
/// # Errors
/// Fails if the text has another form or its detector is invalid.
pub fn parse(text: &str) -> Result<TrackerSpec, TrackerError> {
    let given = Spec::parse_tracker(text);
    match (given.name, &given.over) {
        ("every-step" | "verlet", None) => Err(TrackerError::Form(text.into())),
        (_, None) => Ok(TrackerSpec::EveryStep(spec::parse(text)?)),
        ("verlet", Some(over)) if given.stray.is_none() => verlet(&given, over),
        ("every-step", Some(over)) if given.stray.is_none() && given.params.is_empty() => {
            Ok(TrackerSpec::EveryStep(spec::parse(over)?))
        }
        _ => Err(TrackerError::Form(text.into())),
    }
}

fn verlet(given: &Spec<'_>, over: &str) -> Result<TrackerSpec, TrackerError> {
    given.keys(&["rule", "skin"], "verlet takes rule and skin")?;
    let skin = match given.get("skin") {
        None => SKIN,
        Some("auto") => Skin::Auto,
        Some(value) => Skin::Diameters(length(value).ok_or_else(|| {
            let allowed = "a number of at least 0, in diameters, or auto";
            given.wrong("skin", value, &["auto"], allowed)
        })?),
    };
    let rule = given.get("rule").map_or(Ok(Rule::TopTwo), |value| {
        let allowed = "half-skin, top-two, summed, every-K or lammps-DELAY-EVERY-yes (or -no)";
        let words = ["half-skin", "top-two", "summed"];
        value.parse().map_err(|()| given.wrong("rule", value, &words, allowed))
    })?;
    if skin == Skin::Auto && !matches!(rule, Rule::HalfSkin | Rule::TopTwo | Rule::Summed) {
        return Err(TrackerError::Auto(given.text.into()));
    }
    Ok(TrackerSpec::Verlet { detector: spec::parse(over)?, skin, rule })
}

/// Parses a number of at least 0; -0 becomes 0.
fn length(text: &str) -> Option<f64> {
    let length: f64 = text.parse().ok()?;
    (length >= 0.0 && length.is_finite()).then_some(length + 0.0)
}
