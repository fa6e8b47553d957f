//! Rules that decide when a list of near pairs is rebuilt.

use std::fmt;
use std::str::FromStr;

/// Decides when a list is rebuilt: by displacements since it was built, or by the number of frames.
///
/// For the same list and any motion, three rules discard the list in this order: [`Rule::Summed`]
/// first, then [`Rule::HalfSkin`], then [`Rule::TopTwo`]. All three discard it no later than in the
/// frame in which an unlisted pair touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Rebuilds if twice the largest displacement exceeds the skin. Safe.
    HalfSkin,
    /// Rebuilds if the sum of the two largest displacements exceeds the skin. Safe.
    TopTwo,
    /// Adds up each frame's largest displacement, and rebuilds if twice the sum exceeds the skin.
    /// Codes after Munjiza's book use this rule. Safe.
    Summed,
    /// Rebuilds every k-th frame, for any motion. Unsafe unless k = 1.
    Every(u32),
    /// Works as `neigh_modify` of LAMMPS: may rebuild only if the list is at least `delay` frames
    /// old and its age is a multiple of `every`. It then always rebuilds or, with `check`, only if
    /// a displacement exceeds half the skin in LAMMPS's rounded comparison. Safe, up to rounding,
    /// only for a delay of at most 1, every frame and a check.
    Lammps {
        /// Least age in frames at which a list may be rebuilt.
        delay: u32,
        /// Number of frames from one possible rebuild to the next.
        every: u32,
        /// Whether the list is rebuilt only if a displacement requires it.
        check: bool,
    },
}

/// Displacements of particles: upper bounds of the true ones, except for the square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Displacements {
    /// Computed square of the largest displacement since the list was built.
    pub square: f64,
    /// Largest displacement since the list was built.
    pub first: f64,
    /// Second largest displacement since the list was built.
    pub second: f64,
    /// Sum over frames of each frame's largest displacement.
    pub summed: f64,
}

/// Which displacements a rule needs in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looks {
    Nowhere,
    /// Displacements since the list was built.
    SinceBuilt,
    /// Displacements since the list was built and since the previous frame.
    SinceFrame,
}

/// Decision of a rule for a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Due {
    pub build: bool,
    pub dangerous: bool,
}

impl Rule {
    /// Returns whether the rule misses no contact, for any motion.
    pub fn is_safe(self) -> bool {
        matches!(self, Rule::HalfSkin | Rule::TopTwo | Rule::Summed | Rule::Every(1))
    }

    /// Returns which displacements the rule needs when the list has this age in frames.
    pub(super) fn looks(self, age: u32) -> Looks {
        match self {
            Rule::HalfSkin | Rule::TopTwo => Looks::SinceBuilt,
            Rule::Summed => Looks::SinceFrame,
            Rule::Lammps { check: true, .. } if self.may_build(age) => Looks::SinceBuilt,
            Rule::Every(_) | Rule::Lammps { .. } => Looks::Nowhere,
        }
    }

    /// Returns whether the rule may rebuild a list of this age.
    fn may_build(self, age: u32) -> bool {
        match self {
            Rule::Lammps { delay, every, .. } => age >= delay && age.is_multiple_of(every),
            _ => true,
        }
    }

    /// Returns by how much two particles may have come nearer according to this rule. The list is
    /// discarded if this exceeds the skin.
    pub(super) fn approach(self, displacements: &Displacements) -> f64 {
        match self {
            // The sum is rounded up, but is at most twice the largest displacement.
            Rule::TopTwo => (displacements.first + displacements.second)
                .next_up()
                .min(2.0 * displacements.first),
            Rule::Summed => 2.0 * displacements.summed,
            Rule::HalfSkin | Rule::Every(_) | Rule::Lammps { .. } => 2.0 * displacements.first,
        }
    }

    /// Returns whether a list must be rebuilt at this age.
    pub(super) fn is_due(self, age: u32, displacements: &Displacements, skin: f64) -> Due {
        let build = match self {
            Rule::HalfSkin | Rule::TopTwo | Rule::Summed => self.approach(displacements) > skin,
            Rule::Every(k) => age >= k,
            Rule::Lammps { delay, every, check } => {
                let gone = displacements.square > 0.25 * skin * skin;
                let build = self.may_build(age) && (!check || gone);
                return Due { build, dangerous: build && check && age == delay.max(every) };
            }
        };
        Due { build, dangerous: false }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rule::HalfSkin => f.write_str("half-skin"),
            Rule::TopTwo => f.write_str("top-two"),
            Rule::Summed => f.write_str("summed"),
            Rule::Every(k) => write!(f, "every-{k}"),
            Rule::Lammps { delay, every, check } => {
                write!(f, "lammps-{delay}-{every}-{}", if *check { "yes" } else { "no" })
            }
        }
    }
}

impl FromStr for Rule {
    type Err = ();

    fn from_str(text: &str) -> Result<Rule, ()> {
        let at_least_one = |text: &str| text.parse().ok().filter(|&k: &u32| k >= 1).ok_or(());
        match text.split('-').collect::<Vec<_>>()[..] {
            ["half", "skin"] => Ok(Rule::HalfSkin),
            ["top", "two"] => Ok(Rule::TopTwo),
            ["summed"] => Ok(Rule::Summed),
            ["every", k] => Ok(Rule::Every(at_least_one(k)?)),
            ["lammps", delay, every, check @ ("yes" | "no")] => Ok(Rule::Lammps {
                delay: delay.parse().map_err(|_| ())?,
                every: at_least_one(every)?,
                check: check == "yes",
            }),
            _ => Err(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_a_rule_parses_to_itself() {
        for text in
            ["half-skin", "top-two", "summed", "every-1", "lammps-10-5-yes", "lammps-0-1-no"]
        {
            assert_eq!(text.parse::<Rule>().unwrap().to_string(), text);
        }
        for text in ["", "half", "every", "every-0", "every--1", "lammps-1-0-yes", "lammps-1-1"] {
            assert_eq!(text.parse::<Rule>(), Err(()), "{text}");
        }
    }

    /// LAMMPS checks if `ago >= delay && ago % every == 0`. A build at the first check is
    /// dangerous.
    #[test]
    fn the_rule_of_lammps_looks_when_lammps_looks() {
        let (far, near) = (
            Displacements { square: 0.25f64.next_up(), ..Displacements::default() },
            Displacements { square: 0.25, ..Displacements::default() },
        );
        let rule = Rule::Lammps { delay: 4, every: 3, check: true };
        let looks: Vec<u32> = (1..13).filter(|&age| rule.is_due(age, &far, 1.0).build).collect();
        assert_eq!(looks, [6, 9, 12]);
        assert!((1..13).all(|age| rule.is_due(age, &near, 1.0) == Due::default()));
        // Here `max(delay, every)` is not a multiple of `every`, so no build counts as dangerous.
        assert!((1..13).all(|age| !rule.is_due(age, &far, 1.0).dangerous));
        let rule = Rule::Lammps { delay: 0, every: 3, check: true };
        let dangerous: Vec<u32> =
            (1..13).filter(|&age| rule.is_due(age, &far, 1.0).dangerous).collect();
        assert_eq!(dangerous, [3]);
        let rule = Rule::Lammps { delay: 0, every: 3, check: false };
        assert_eq!(rule.is_due(3, &near, 1.0), Due { build: true, dangerous: false });
        assert_eq!(rule.is_due(4, &far, 1.0), Due::default());
    }

    #[test]
    fn safe_rules_are_closed_at_the_skin() {
        let displacements = |first: f64, second: f64, summed: f64| Displacements {
            square: 0.0,
            first,
            second,
            summed,
        };
        let due =
            |rule: Rule, displacements: Displacements| rule.is_due(1, &displacements, 1.0).build;
        assert!(!due(Rule::HalfSkin, displacements(0.5, 0.5, 9.0)));
        assert!(due(Rule::HalfSkin, displacements(0.5f64.next_up(), 0.0, 0.0)));
        assert!(!due(Rule::TopTwo, displacements(0.6, 0.3, 9.0)));
        assert!(
            due(Rule::TopTwo, displacements(0.75, 0.25, 0.0)),
            "a sum of displacements is rounded up"
        );
        assert!(!due(Rule::Summed, displacements(9.0, 9.0, 0.5)));
        assert!(due(Rule::Summed, displacements(0.0, 0.0, 0.5f64.next_up())));
        assert!(
            due(Rule::Every(1), Displacements::default())
                && !due(Rule::Every(2), Displacements::default())
        );
        // If two particles moved by half the skin each, no rule discards the list yet.
        assert!(
            !due(Rule::TopTwo, displacements(0.5, 0.5, 0.5))
                && !due(Rule::HalfSkin, displacements(0.5, 0.5, 0.5))
        );
        for rule in [Rule::HalfSkin, Rule::TopTwo, Rule::Summed] {
            let far = displacements(f64::INFINITY, 0.0, f64::INFINITY);
            assert!(rule.is_due(1, &far, f64::MAX).build && rule.is_safe());
        }
        assert!(Rule::Every(1).is_safe() && !Rule::Every(2).is_safe());
    }
}
