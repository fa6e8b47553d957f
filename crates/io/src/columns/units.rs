//! Units of length in column names: `x [mm]`, `x (mm)`, `x_mm`.

use crate::raw::lines::among;

const UNITS: &str = "km m meter metre meters metres dm cm mm um µm μm micron microns nm pm \
                     angstrom Angstrom Å pc kpc Mpc Gpc px pixel pixels in inch ft";

/// Splits `x [mm]` into the name and what stands in brackets.
pub fn split(name: &str) -> (&str, Option<&str>) {
    let Some(at) = name.find(['[', '(']) else { return (name.trim(), None) };
    let unit = name[at + 1..].trim_end_matches([']', ')', ' ']).trim();
    (name[..at].trim(), Some(unit).filter(|unit| !unit.is_empty()))
}

/// Splits a name such as `x_mm` into the name and the unit.
pub fn suffixed(name: &str) -> Option<(&str, &str)> {
    name.trim().rsplit_once('_').filter(|(_, unit)| is_unit(unit))
}

pub fn is_unit(text: &str) -> bool {
    among(UNITS, text)
}

pub fn unit_of(name: &str) -> Option<&str> {
    split(name).1.or_else(|| suffixed(name).map(|(_, unit)| unit))
}
