//! The format of numbers in all output.

use crate::interval::Interval;

/// Formats a number with about four significant digits; whole numbers below 10^7 have all digits.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        return value.to_string();
    }
    if value == value.round() && size < 1e7 {
        return format!("{value:.0}");
    }
    match size {
        s if !(1e-3..1e7).contains(&s) => {
            let text = format!("{value:.3e}");
            match text.split_once('e') {
                Some((mantissa, power)) if mantissa.ends_with(".000") => {
                    format!("{}e{power}", mantissa.trim_end_matches(".000"))
                }
                _ => text,
            }
        }
        s if s < 1.0 => format!("{value:.4}"),
        s if s < 10.0 => format!("{value:.3}"),
        s if s < 100.0 => format!("{value:.2}"),
        s if s < 1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// Formats a time with three significant digits; the intervals of most times justify no more.
pub fn short(value: f64) -> String {
    let whole = value.abs().log10().floor() as i32;
    match value.is_finite() && (0..3).contains(&whole) {
        true => format!("{value:.*}", (2 - whole) as usize),
        false => number(value),
    }
}

/// Formats a depth or a gap, given in mean radii of the two particles.
pub fn mean_radii(depth: f64) -> String {
    format!("{} mean radii", number(depth))
}

/// Formats a depth or a gap like [`mean_radii`], but shorter, for tables.
pub fn radii(depth: f64) -> String {
    format!("{} r", number(depth))
}

/// Parses a whole number such as `1000000`, `1e6` or `1_000_000`. The largest is 2^53, or 2^64 - 1
/// if written in digits alone.
pub fn whole(text: &str) -> Option<u64> {
    let text = text.trim().replace('_', "");
    let real = || {
        let value: f64 = text.parse().ok()?;
        let exact = value >= 0.0 && value.fract() == 0.0 && value <= (1u64 << 53) as f64;
        exact.then_some(value as u64)
    };
    text.parse().ok().or_else(real)
}

/// Parses a number of bytes: a whole number, or a number with a unit such as `4GiB`, `512 MiB` or
/// `1.5GB`.
pub fn bytes(text: &str) -> Option<u64> {
    let text = text.trim();
    let end = text.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E'));
    let (value, unit) = text.split_at(end.unwrap_or(text.len()));
    let one: f64 = match unit.to_ascii_lowercase().as_str() {
        "" => return whole(value),
        "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1024f64.powi(2),
        "g" | "gib" => 1024f64.powi(3),
        "t" | "tib" => 1024f64.powi(4),
        _ => return None,
    };
    let value: f64 = value.trim().parse().ok()?;
    let bytes = (value * one).round();
    (bytes >= 0.0 && bytes < u64::MAX as f64).then_some(bytes as u64)
}

/// Formats a fraction as a percentage.
pub fn percent(fraction: f64) -> String {
    let value = 100.0 * fraction;
    if value == 0.0 {
        "0%".into()
    } else if value.abs() < 1e-3 {
        "< 0.001%".into()
    } else if value.abs() < 0.1 {
        format!("{value:.3}%")
    } else if value.abs() < 10.0 {
        format!("{value:.1}%")
    } else {
        format!("{value:.0}%")
    }
}

/// Returns how many digits after the decimal point show at least two significant digits of a ratio.
fn digits(ratio: f64) -> usize {
    match ratio {
        _ if ratio >= 10.0 => 1,
        _ if ratio >= 0.1 || ratio <= 0.0 => 2,
        _ if ratio >= 0.01 => 3,
        _ => 4,
    }
}

/// Formats a ratio without its interval, such as `1.25`.
pub fn times(ratio: f64) -> String {
    format!("{ratio:.*}", digits(ratio))
}

/// Formats a ratio as `1.25 (1.20 to 1.31)`, or as `1.25 (no interval)` if it is a single value.
pub fn with_interval(ratio: &Interval) -> String {
    let digits = digits(ratio.median);
    with_ends(ratio, |value| format!("{value:.digits$}"))
}

/// Formats a ratio like [`with_interval`], but formats each number by `write`.
pub fn with_ends(interval: &Interval, write: impl Fn(f64) -> String) -> String {
    let ends = match interval.ends() {
        Some([low, high]) => format!("{} to {}", write(low), write(high)),
        None => "no interval".into(),
    };
    format!("{} ({ends})", write(interval.median))
}

/// Formats a count with its noun, such as `1 cell` or `2 cells`.
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// Breaks text into lines of at most `width` characters; longer words are cut.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let (mut lines, mut line, mut length) = (Vec::new(), String::new(), 0);
    for word in text.split_whitespace() {
        let mut word: Vec<char> = word.chars().collect();
        if length > 0 && length + 1 + word.len() > width {
            lines.push(std::mem::take(&mut line));
            length = 0;
        }
        while word.len() > width {
            let rest = word.split_off(width);
            lines.push(std::mem::replace(&mut word, rest).into_iter().collect());
        }
        if length > 0 {
            line.push(' ');
            length += 1;
        }
        length += word.len();
        line.extend(word);
    }
    if !line.is_empty() || lines.is_empty() {
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (4.0004, "4.000"),
            (12.0, "12"),
            (499_500.0, "499500"),
            (1e8, "1e8"),
            (1.25e9, "1.250e9"),
            (0.5, "0.5000"),
            (1e-9, "1e-9"),
            (-3.25, "-3.250"),
            (123_456.7, "123457"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!([0.003, 0.5, 1e-7].map(percent), ["0.3%", "50%", "< 0.001%"]);
        let wide = Interval { median: 1.25, low: 1.2, high: 11.0, coverage: 0.96, count: 15 };
        assert_eq!(with_interval(&wide), "1.25 (1.20 to 11.00)");
        let one = Interval { low: 4.41, median: 4.41, high: 4.41, coverage: 0.0, count: 1 };
        assert_eq!(with_interval(&one), "4.41 (no interval)");
        assert_eq!([1.254, 12.54].map(times), ["1.25", "12.5"]);
    }

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let all = ["1000", "1e3", "1_000", "1000.0", "18446744073709551615", "1.5", "-1", "", "x"];
        let wholes = [Some(1000), Some(1000), Some(1000), Some(1000), Some(u64::MAX)];
        assert_eq!(all.map(whole)[..5], wholes);
        assert_eq!(all.map(whole)[5..], [None; 4]);
        let all = ["4096", "4GiB", "4 GiB", "4g", "0.5MB", "1e3kB", "4 GiBi", "GiB", "-1MiB"];
        let gib = Some(4 << 30);
        let sizes = [Some(4096), gib, gib, gib, Some(500_000), Some(1_000_000), None, None, None];
        assert_eq!(all.map(bytes), sizes);
    }

    #[test]
    fn lines_keep_their_width() {
        assert_eq!(wrap("one two abcdefgh", 5), ["one", "two", "abcde", "fgh"]);
        assert_eq!(wrap("", 5), [""]);
    }
}
