//! Units of length in column names: `x [mm]`, `x (mm)`, `x_mm`.

use std::borrow::Cow;

use crate::raw::lines::among;

/// Names of units, their family and power of ten. Units of different families cannot be converted.
const UNITS: [(&str, &str, i32); 16] = [
    ("km", "m", 3),
    ("m meter meters metre metres", "m", 0),
    ("dm", "m", -1),
    ("cm", "m", -2),
    ("mm millimeter millimeters millimetre millimetres", "m", -3),
    ("um µm μm micron microns micrometer micrometre", "m", -6),
    ("nm nanometer nanometre", "m", -9),
    ("angstrom Angstrom Å", "m", -10),
    ("pm", "m", -12),
    ("pc", "pc", 0),
    ("kpc", "pc", 3),
    ("Mpc", "pc", 6),
    ("Gpc", "pc", 9),
    ("px pixel pixels", "px", 0),
    ("in inch", "in", 0),
    ("ft", "ft", 0),
];

pub fn known(unit: &str) -> Option<(&'static str, i32)> {
    let found = UNITS.iter().find(|(names, ..)| among(names, unit));
    found.map(|&(_, family, power)| (family, power))
}

pub fn split(name: &str) -> (&str, Option<&str>) {
    let Some(at) = name.find(['[', '(']) else { return (name.trim(), None) };
    let unit = name[at + 1..].trim_end_matches([']', ')', ' ']).trim();
    (name[..at].trim(), Some(unit).filter(|unit| !unit.is_empty()))
}

/// Splits a name such as `x_mm` into the name and the unit.
pub fn suffixed(name: &str) -> Option<(&str, &str)> {
    name.trim().rsplit_once('_').filter(|(_, unit)| known(unit).is_some())
}

/// Multiplies a written number by a power of ten in its text, so that it is rounded only once.
pub fn shifted(cell: &[u8], power: i32) -> Cow<'_, [u8]> {
    let at = cell
        .iter()
        .position(|byte| matches!(byte, b'e' | b'E' | b'd' | b'D'))
        .unwrap_or(cell.len());
    let (digits, exponent) = cell.split_at(at);
    let written = match exponent {
        [] => Some(0),
        [_, exponent @ ..] => std::str::from_utf8(exponent).ok().and_then(|text| text.parse().ok()),
    };
    let numeral = digits.last().is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.');
    match written.and_then(|written: i32| written.checked_add(power)) {
        Some(exponent) if numeral => [digits, format!("e{exponent}").as_bytes()].concat().into(),
        _ => cell.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::lines::number;

    #[test]
    fn a_power_of_ten_is_rounded_once() {
        for (cell, power, value) in [
            ("1000", -3, Some(1.0)),
            ("0.3", -3, Some(0.0003)),
            // The product 0.9 * 0.001 is rounded twice, to a different number.
            ("0.9", -3, Some(0.0009)),
            ("-4.35E2", 3, Some(-435e3)),
            ("4.35e+2", -9, Some(4.35e-7)),
            ("1.", 3, Some(1e3)),
            ("1D-3", -3, Some(1e-6)),
            ("2.5d+02", 3, Some(2.5e5)),
            ("inf", 3, Some(f64::INFINITY)),
            ("1e", 3, None),
            ("x", 3, None),
            ("", 3, None),
        ] {
            assert_eq!(number(&shifted(cell.as_bytes(), power)), value, "{cell}");
        }
    }
}
