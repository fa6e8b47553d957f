//! Distributions of the radii.
//!
//! Radii lie between r / `size-ratio` and r, the largest radius. Without `sizes` they are uniform
//! in this interval; with a ratio of 1 all are r. If `sizes` is given, the dimension is d and the
//! ratio is ω, radii are as follows.
//!
//! * `power`: the number of radii has the density r^`exponent`. Radii are its quantiles at 0,
//!   1/(n-1), .. 1, as in Krijgsman, Ogarko and Luding 2014 (doi:10.1007/s40571-014-0020-9), so
//!   that every scene has both extremes.
//! * `binary`: two radii. `share` is the volume of the small particles over that of all. For each
//!   large one there are ω^d share / (1 - share) small ones, to the nearest whole number, and at
//!   least one large one unless the share is 1.
//! * `lognormal`: the logarithm of a radius is normal, cut off at two standard deviations to either
//!   side; the cut-offs have the ratio ω.
//! * `giants`: this many particles have radius r, all others r / ω.
//! * `grading`: a grading curve ([`super::grading`]) from a file with a sieve size and the percent
//!   passing per line, or written out (`grading=0.063 0, 0.2 15, 2 100`). Radii are quantiles of
//!   the numbers, as for `power`. The curve sets the ratio, so `size-ratio` must not be given.
//!
//! Which particle gets which radius is drawn independently of all other random numbers.

use anyhow::{bail, ensure};
use rand::seq::SliceRandom;

use crate::generate::draw::{Draw, sizes};
use crate::generate::grading::Curve;
use crate::generate::table::{Parameter, ParameterKind, optional, parameter};
use crate::generate::{Inputs, room};

pub const SIZE_RATIO: Parameter = parameter(
    "size-ratio",
    ParameterKind::AT_LEAST_ONE,
    "1",
    "largest over smallest radius; radii are uniform unless `sizes` is given; 1 = one radius \
              for all",
);

pub const SIZES: Parameter = optional(
    "sizes",
    ParameterKind::Word([&["power", "binary", "lognormal", "giants", "grading"]; 2]),
    "distribution of radii: power, binary, lognormal, giants or grading; uniform by \
              default",
);

pub const EXPONENT: Parameter = optional(
    "exponent",
    ParameterKind::FINITE,
    "for sizes=power: the number of radii has the density r^exponent",
);

pub const SHARE: Parameter = optional(
    "share",
    ParameterKind::SHARE,
    "for sizes=binary: volume of the small particles over that of all",
);

pub const GIANTS: Parameter = optional(
    "giants",
    ParameterKind::COUNT,
    "for sizes=giants: number of particles with the largest radius",
);

pub const GRADING: Parameter = optional(
    "grading",
    ParameterKind::Text,
    "for sizes=grading: a file with sieve size and percent passing by volume in each \
              line, or these points",
);

/// Maximum ratio of radii; the cube of its inverse is a normal number.
const MOST: f64 = 1e100;
const LARGEST: f64 = 0.5;

/// Returns radii for a largest diameter of 1, or `None` if all are 1/2. Takes numbers from `draw`
/// only for uniform radii.
pub fn unit_radii(inputs: &Inputs<'_>, draw: &mut Draw) -> anyhow::Result<Option<Vec<f64>>> {
    let ratio = inputs.number("size-ratio")?;
    let kind = inputs.params.get(SIZES.name).and_then(|value| value.as_str());
    for (Parameter { name, meaning, .. }, of) in
        [(EXPONENT, "power"), (SHARE, "binary"), (GIANTS, "giants"), (GRADING, "grading")]
    {
        let (given, wanted) = (inputs.params.contains_key(name), kind == Some(of));
        ensure!(wanted || !given, "{name} belongs to sizes={of}: add that, or leave {name} out");
        ensure!(given || !wanted, "sizes={of} needs {name}: {meaning}");
    }
    if kind == Some("grading") {
        ensure!(ratio == 1.0, "the grading curve has the ratio of sizes: leave size-ratio out");
    } else if ratio == 1.0 {
        return Ok(None);
    }
    ensure!(ratio <= MOST, "size-ratio is {ratio:e}; it must be at most {MOST:e}");
    let mut radii = room(inputs.n)?;
    match kind {
        None => {
            let least = LARGEST / ratio;
            let radius = |_| (least + (LARGEST - least) * draw.unit()).clamp(least, LARGEST);
            radii.extend((0..inputs.n).map(radius));
        }
        Some(kind) => {
            distributed(inputs, kind, ratio, &mut radii)?;
            radii.shuffle(&mut sizes(inputs.seed));
        }
    }
    Ok(Some(radii))
}

/// Appends radii in an order that the distribution determines.
fn distributed(
    inputs: &Inputs<'_>,
    kind: &str,
    ratio: f64,
    radii: &mut Vec<f64>,
) -> anyhow::Result<()> {
    let (n, least) = (inputs.n, LARGEST / ratio);
    let inside = |radius: f64| radius.clamp(least, LARGEST);
    let largest_first = |large: u64| (0..n).map(move |k| if k < large { LARGEST } else { least });
    match kind {
        "power" => {
            let power = inputs.number(EXPONENT.name)? + 1.0;
            let last = n.saturating_sub(1).max(1) as f64;
            let radius = |k| inside(least * quantile(1.0 - k as f64 / last, power, ratio));
            radii.extend((0..n).map(radius));
            // A rounded power might differ from the largest radius.
            radii.iter_mut().take(1).for_each(|radius| *radius = LARGEST);
        }
        "binary" => {
            radii.extend(largest_first(large(n, inputs.number(SHARE.name)?, ratio, inputs.dim)));
        }
        "lognormal" => {
            let (middle, deviation) = (LARGEST / ratio.sqrt(), libm::log(ratio) / 4.0);
            let mut draw = Draw::of_sizes(inputs.seed);
            let mut normals = std::iter::repeat_with(|| draw.normal()).filter(|x| x.abs() <= 2.0);
            let radius = |normal| inside(middle * libm::exp(deviation * normal));
            radii.extend((0..n).filter_map(|_| normals.next()).map(radius));
        }
        "giants" => radii.extend(largest_first(inputs.whole(GIANTS.name)?)),
        "grading" => {
            let curve = Curve::new(inputs.text(GRADING.name)?)?;
            radii.extend(curve.quantiles(n, inputs.dim).map(|size| LARGEST * size.min(1.0)));
        }
        // The check of parameters refuses all other words.
        other => bail!("there are no sizes '{other}'"),
    }
    Ok(())
}

/// Returns the quantile `part` (0 to 1) of a distribution of radii from 1 to `ratio` whose density
/// is proportional to r^(power - 1).
fn quantile(part: f64, power: f64, ratio: f64) -> f64 {
    if (power * libm::log(ratio)).abs() < 1e-9 {
        return libm::pow(ratio, part);
    }
    // The formula starts at the end where no power is above 1, so that none overflows.
    if power > 0.0 {
        ratio * libm::pow(part + (1.0 - part) * libm::pow(ratio, -power), 1.0 / power)
    } else {
        libm::pow(1.0 + part * (libm::pow(ratio, power) - 1.0), 1.0 / power)
    }
}

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
