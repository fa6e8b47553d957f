//! Sizes: how the radii of a scene are distributed.
//!
//! Radii lie between r / `size-ratio` and r, the largest. Without `sizes` they are uniform there,
//! and all r where the ratio is 1. Otherwise, for d dimensions and ratio ω:
//!
//! * `power`: the numbers of radii have the density r^`exponent`. Not drawn, but the quantiles of
//!   it at 0, 1/(n-1), .. 1, as in Krijgsman, Ogarko and Luding 2014
//!   (doi:10.1007/s40571-014-0020-9), so that every scene has both ends.
//! * `binary`: two radii; `share` is the volume of the small ones over that of all. So there are
//!   ω^d share / (1 - share) small ones for each large one, to the nearest whole number, and at
//!   least one large one unless the share is 1.
//! * `lognormal`: drawn; the logarithm is normal, cut off at two standard deviations either way,
//!   which are ω apart.
//! * `giants`: so many of radius r, all others of radius r / ω.
//! * `grading`: as a grading curve says ([`super::grading`]), from a file with a sieve size and the
//!   percent passing in each line, or written out (`grading=0.063 0, 0.2 15, 2 100`). Quantiles of
//!   the numbers as for `power`, where the largest is r; the curve has the ratio, and `size-ratio`
//!   stays away.
//!
//! Which particle has which radius is drawn independently of everything else.

use anyhow::{bail, ensure};
use rand::seq::SliceRandom;

use crate::generate::draw::{Draw, sizes};
use crate::generate::grading::Curve;
use crate::generate::table::{Kind, Parameter, number, optional};
use crate::generate::{Inputs, room};

/// Smallest and largest.
pub const SIZE_RATIO: Parameter = number(
    "size-ratio",
    Kind::AT_LEAST_ONE,
    1.0,
    "radii between r / ratio and r, uniform unless `sizes` says otherwise; 1 = one radius \
              for all",
);

/// The distribution.
pub const SIZES: Parameter = optional(
    "sizes",
    Kind::Word([&["power", "binary", "lognormal", "giants", "grading"]; 2]),
    "how radii are distributed: power, binary, lognormal, giants or grading; uniform if \
              it is left out",
);

/// Of [`SIZES`] `power`.
pub const EXPONENT: Parameter =
    optional("exponent", Kind::FINITE, "for sizes=power: numbers of radii go as r^exponent");

/// Of [`SIZES`] `binary`.
pub const SHARE: Parameter =
    optional("share", Kind::SHARE, "for sizes=binary: volume of the small ones over that of all");

/// Of [`SIZES`] `giants`.
pub const GIANTS: Parameter =
    optional("giants", Kind::COUNT, "for sizes=giants: how many have the largest radius");

/// Of [`SIZES`] `grading`.
pub const GRADING: Parameter = optional(
    "grading",
    Kind::Text,
    "for sizes=grading: a file with sieve size and percent passing by volume in each \
              line, or these points",
);

/// The cube of its inverse is still a normal number.
const MOST: f64 = 1e100;
/// The largest radius, for a diameter of 1.
const LARGEST: f64 = 0.5;

/// Radii for a diameter of 1, or none where all are 1/2. `draw` is asked for uniform ones only.
pub fn unit_radii(inputs: &Inputs<'_>, draw: &mut Draw) -> anyhow::Result<Option<Vec<f64>>> {
    let ratio = inputs.number("size-ratio")?;
    let kind = inputs.params.get(SIZES.name).and_then(|value| value.as_str());
    for (parameter, of) in
        [(EXPONENT, "power"), (SHARE, "binary"), (GIANTS, "giants"), (GRADING, "grading")]
    {
        let given = inputs.params.contains_key(parameter.name);
        ensure!(
            !given || kind == Some(of),
            "{} belongs to sizes={of}: add that, or leave {} out",
            parameter.name,
            parameter.name
        );
        ensure!(
            given || kind != Some(of),
            "sizes={of} needs {}: {}",
            parameter.name,
            parameter.meaning
        );
    }
    if kind == Some("grading") {
        ensure!(ratio == 1.0, "the grading curve has the ratio of sizes: leave size-ratio out");
        return graded(inputs).map(Some);
    }
    if ratio == 1.0 {
        return Ok(None);
    }
    ensure!(
        ratio <= MOST,
        "size-ratio is {ratio:e}; at most {MOST:e}, beyond which the volume of the smallest bodies \
         is no number"
    );
    let (n, least) = (inputs.n, LARGEST / ratio);
    let mut radii = room(n)?;
    // The bounds keep a radius that was rounded from leaving the range.
    let inside = |radius: f64| radius.clamp(least, LARGEST);
    match kind {
        None => {
            radii.extend((0..n).map(|_| inside(least + (LARGEST - least) * draw.unit())));
            return Ok(Some(radii));
        }
        Some("power") => {
            let power = inputs.number(EXPONENT.name)? + 1.0;
            let last = n.saturating_sub(1).max(1) as f64;
            radii.extend(
                (0..n).map(|k| inside(least * quantile(1.0 - k as f64 / last, power, ratio))),
            );
            // Which a rounded power might miss.
            radii.iter_mut().take(1).for_each(|radius| *radius = LARGEST);
        }
        Some("binary") => {
            let large = large(n, inputs.number(SHARE.name)?, ratio, inputs.dim);
            radii.extend((0..n).map(|k| if k < large { LARGEST } else { least }));
        }
        Some("lognormal") => {
            let (middle, deviation) = (LARGEST / ratio.sqrt(), libm::log(ratio) / 4.0);
            let mut draw = Draw::of_sizes(inputs.seed);
            radii.extend((0..n).map(|_| {
                let mut normal = draw.normal();
                while normal.abs() > 2.0 {
                    normal = draw.normal();
                }
                inside(middle * libm::exp(deviation * normal))
            }));
        }
        Some("giants") => {
            let giants = inputs.whole(GIANTS.name)?;
            radii.extend((0..n).map(|k| if k < giants { LARGEST } else { least }));
        }
        // The table lets nothing else pass.
        Some(other) => bail!("there are no sizes '{other}'"),
    }
    radii.shuffle(&mut sizes(inputs.seed));
    Ok(Some(radii))
}

/// Radii as a grading curve says.
fn graded(inputs: &Inputs<'_>) -> anyhow::Result<Vec<f64>> {
    let curve = Curve::new(inputs.text(GRADING.name)?)?;
    let mut radii = room(inputs.n)?;
    radii.extend(curve.quantiles(inputs.n, inputs.dim).map(|size| LARGEST * size.min(1.0)));
    radii.shuffle(&mut sizes(inputs.seed));
    Ok(radii)
}

/// The radius, from 1 to `ratio`, below which this part of the numbers is, if they have the density
/// r^(power - 1).
fn quantile(part: f64, power: f64, ratio: f64) -> f64 {
    if (power * libm::log(ratio)).abs() < 1e-9 {
        return libm::pow(ratio, part);
    }
    // From the end that is nearer to 1, so that no power overflows.
    if power > 0.0 {
        ratio * libm::pow(part + (1.0 - part) * libm::pow(ratio, -power), 1.0 / power)
    } else {
        libm::pow(1.0 + part * (libm::pow(ratio, power) - 1.0), 1.0 / power)
    }
}

/// How many of `n` are large.
fn large(n: u64, share: f64, ratio: f64, dim: u32) -> u64 {
    let small_for_each =
        share / (1.0 - share) * if dim == 2 { ratio * ratio } else { ratio * ratio * ratio };
    let large = (n as f64 / (1.0 + small_for_each) + 0.5) as u64;
    match share {
        0.0 => n,
        1.0 => 0,
        _ => large.max(1),
    }
}
