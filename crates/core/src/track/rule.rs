//! When a list of near pairs must be built again.

use std::fmt;
use std::str::FromStr;

/// When a list is built again: by how far particles have gone since it was built, or by the number
/// of frames.
///
/// For the same list the frames at which it is given up come in this order, for every motion:
/// [`Rule::Summed`] first, then [`Rule::HalfSkin`], then [`Rule::TopTwo`], and last of all the
/// frame in which a pair that is not listed touches, at which it must be given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// When twice the way of the particle that is farthest from where it was is more than the skin.
    /// Safe.
    HalfSkin,
    /// When the ways of the two particles that are farthest from where they were are together more
    /// than the skin. Safe.
    TopTwo,
    /// When twice the sum, over the frames, of the longest way of a particle in a frame is more
    /// than the skin: the rule of codes after Munjiza's book, which add up the way of the fastest.
    /// Safe.
    Summed,
    /// In every k-th frame, whatever moves. Unsafe but for k = 1.
    Every(u32),
    /// As `neigh_modify` of LAMMPS: never in fewer than `delay` frames, at multiples of `every`,
    /// and then always or, with `check`, when a particle has gone more than half of the skin by
    /// LAMMPS's own rounded comparison. Unsafe but for a delay of at most 1, every frame and a
    /// check, and there up to rounding.
    Lammps {
        /// Frames that a list serves at least.
        delay: u32,
        /// Frames between two looks.
        every: u32,
        /// Whether ways are looked at.
        check: bool,
    },
}

/// How far particles have gone. Those but the squares are upper bounds of the true ways.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ways {
    /// The square of the longest way since the list was built, as computed.
    pub square: f64,
    /// The longest way since then.
    pub first: f64,
    /// That of the particle that is next.
    pub second: f64,
    /// The longest way in each frame, added up.
    pub summed: f64,
}

/// From where a rule has to know ways in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looks {
    Nowhere,
    /// From where particles were when the list was built.
    SinceBuilt,
    /// And from where they were in the frame before.
    SinceFrame,
}

/// What a rule says of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Due {
    pub build: bool,
    pub dangerous: bool,
}

impl Rule {
    /// No contact is missed, whatever moves.
    pub fn is_safe(self) -> bool {
        matches!(self, Rule::HalfSkin | Rule::TopTwo | Rule::Summed | Rule::Every(1))
    }

    /// What it looks at in the frame that is the `age`-th after that in which the list was built.
    pub(super) fn looks(self, age: u32) -> Looks {
        match self {
            Rule::HalfSkin | Rule::TopTwo => Looks::SinceBuilt,
            Rule::Summed => Looks::SinceFrame,
            Rule::Lammps { check: true, .. } if self.may_build(age) => Looks::SinceBuilt,
            Rule::Every(_) | Rule::Lammps { .. } => Looks::Nowhere,
        }
    }

    /// Whether LAMMPS asks in this frame.
    fn may_build(self, age: u32) -> bool {
        match self {
            Rule::Lammps { delay, every, .. } => age >= delay && age.is_multiple_of(every),
            _ => true,
        }
    }

    /// How far two particles may have come nearer, by this rule, so that a list is given up when it
    /// is more than the skin.
    pub(super) fn gone(self, ways: &Ways) -> f64 {
        match self {
            // Rounded up, but no more than twice the longest.
            Rule::TopTwo => (ways.first + ways.second).next_up().min(2.0 * ways.first),
            Rule::Summed => 2.0 * ways.summed,
            Rule::HalfSkin | Rule::Every(_) | Rule::Lammps { .. } => 2.0 * ways.first,
        }
    }

    /// Must a list with this skin be built again in this frame, the `age`-th after that in which
    /// it was built? Of a skin below 0 nothing is left.
    pub(super) fn is_due(self, age: u32, ways: &Ways, skin: f64) -> Due {
        let build = match self {
            Rule::HalfSkin | Rule::TopTwo | Rule::Summed => self.gone(ways) > skin,
            Rule::Every(k) => age >= k,
            Rule::Lammps { delay, every, check } => {
                let gone = skin < 0.0 || ways.square > 0.25 * skin * skin;
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
    fn rules_are_read_as_they_are_written() {
        for text in
            ["half-skin", "top-two", "summed", "every-1", "lammps-10-5-yes", "lammps-0-1-no"]
        {
            assert_eq!(text.parse::<Rule>().unwrap().to_string(), text);
        }
        for text in ["", "half", "every", "every-0", "every--1", "lammps-1-0-yes", "lammps-1-1"] {
            assert_eq!(text.parse::<Rule>(), Err(()), "{text}");
        }
    }

    /// LAMMPS: `ago >= delay && ago % every == 0`, then the check; dangerous is a list that was
    /// given up at the first look.
    #[test]
    fn the_rule_of_lammps_looks_when_lammps_looks() {
        let (far, near) = (
            Ways { square: 0.25f64.next_up(), ..Ways::default() },
            Ways { square: 0.25, ..Ways::default() },
        );
        let rule = Rule::Lammps { delay: 4, every: 3, check: true };
        let looks: Vec<u32> = (1..13).filter(|&age| rule.is_due(age, &far, 1.0).build).collect();
        assert_eq!(looks, [6, 9, 12]);
        assert!((1..13).all(|age| rule.is_due(age, &near, 1.0) == Due::default()));
        // `ago == max(delay, every)` is no multiple of every: never called dangerous, as there.
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
        let ways =
            |first: f64, second: f64, summed: f64| Ways { square: 0.0, first, second, summed };
        let due = |rule: Rule, ways: Ways| rule.is_due(1, &ways, 1.0).build;
        assert!(!due(Rule::HalfSkin, ways(0.5, 0.5, 9.0)));
        assert!(due(Rule::HalfSkin, ways(0.5f64.next_up(), 0.0, 0.0)));
        assert!(!due(Rule::TopTwo, ways(0.6, 0.3, 9.0)));
        assert!(due(Rule::TopTwo, ways(0.75, 0.25, 0.0)), "a sum of ways is rounded up");
        assert!(!due(Rule::Summed, ways(9.0, 9.0, 0.5)));
        assert!(due(Rule::Summed, ways(0.0, 0.0, 0.5f64.next_up())));
        assert!(due(Rule::Every(1), Ways::default()) && !due(Rule::Every(2), Ways::default()));
        // Two that have gone half of it each: no rule gives up before the one below.
        assert!(
            !due(Rule::TopTwo, ways(0.5, 0.5, 0.5)) && !due(Rule::HalfSkin, ways(0.5, 0.5, 0.5))
        );
        for rule in [Rule::HalfSkin, Rule::TopTwo, Rule::Summed] {
            let far = ways(f64::INFINITY, 0.0, f64::INFINITY);
            assert!(rule.is_due(1, &far, f64::MAX).build && rule.is_safe());
        }
        assert!(Rule::Every(1).is_safe() && !Rule::Every(2).is_safe());
    }
}
