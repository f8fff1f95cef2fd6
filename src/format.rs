//! Numbers as text.

use crate::math::power::power;
use std::ops::Range;

/// SI prefixes with their powers of ten.
const PREFIXES: [(&str, i32); 12] = [
    ("z", -21),
    ("a", -18),
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("µ", -6),
    ("m", -3),
    ("", 0),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// The SI prefix with which a value is from 1 to 1000, and its factor; none beyond them.
fn prefix(value: f64) -> Option<(&'static str, f64)> {
    let exponent = (value.abs().log10() / 3.0).floor() as i32 * 3;
    let (prefix, exponent) = PREFIXES.iter().find(|(_, power)| *power == exponent)?;
    Some((prefix, power(10.0, *exponent)))
}

/// A quantity with an SI prefix and four significant digits.
pub(crate) fn si(value: f64, unit: &str) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value} {unit}");
    }
    match prefix(value) {
        Some((prefix, factor)) => format!("{} {prefix}{unit}", significant(value / factor, 4)),
        None => format!("{value:.3e} {unit}"),
    }
}

/// A quantity and its error in one unit, to two digits of the error; without it where it is not known.
pub(crate) fn si_with_error(value: f64, error: f64, unit: &str) -> String {
    match prefix(value) {
        Some((prefix, factor)) if error > 0.0 && error.is_finite() => {
            let digits = (1.0 - (error / factor).log10().floor()).clamp(0.0, 6.0) as usize;
            let [value, error] = [value, error].map(|value| format!("{:.digits$}", value / factor));
            format!("{value} ± {error} {prefix}{unit}")
        }
        _ => si(value, unit),
    }
}

/// Quantities in one unit, that of the largest, four significant digits each.
pub(crate) fn si_all(values: &[f64], joint: &str, unit: &str) -> String {
    si_to(4, values, joint, unit)
}

/// Quantities in one unit, that of the largest, with some significant digits each.
pub(crate) fn si_to(digits: usize, values: &[f64], joint: &str, unit: &str) -> String {
    let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let Some((prefix, factor)) = prefix(largest) else {
        return values.iter().map(|value| si(*value, unit)).collect::<Vec<String>>().join(joint);
    };
    let shown: Vec<String> = values.iter().map(|value| significant(value / factor, digits)).collect();
    format!("{} {prefix}{unit}", shown.join(joint))
}

/// A number rounded to some significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Significant digits, at least three, for values from 1 to 1000.
fn significant(value: f64, digits: usize) -> String {
    let whole = if value.abs() < 10.0 {
        1
    } else if value.abs() < 100.0 {
        2
    } else {
        3
    };
    format!("{value:.*}", digits.saturating_sub(whole))
}

/// A share in per cent.
pub(crate) fn percent(share: f64) -> String {
    if share != 0.0 && share.abs() < 1e-4 {
        format!("{:.1e} %", 100.0 * share)
    } else {
        format!("{:.2} %", 100.0 * share)
    }
}

/// Shares in per cent, to a tenth where that shows all of them.
pub(crate) fn percents(shares: &[f64], joint: &str) -> String {
    if shares.iter().any(|share| *share != 0.0 && share.abs() < 5e-4) {
        return shares.iter().map(|share| percent(*share)).collect::<Vec<String>>().join(joint);
    }
    let shown: Vec<String> = shares.iter().map(|share| format!("{:.1}", 100.0 * share)).collect();
    format!("{} %", shown.join(joint))
}

/// A pure number with four decimals, or in powers of ten where they would hide it.
pub(crate) fn pure(value: f64) -> String {
    if (1e-2..1e5).contains(&value.abs()) { format!("{value:.4}") } else { format!("{value:.3e}") }
}

/// A deviation in per cent; a factor where it doubles or more; a dash where there is none.
pub(crate) fn signed_percent(deviation: f64) -> String {
    match deviation {
        d if d.is_nan() => "-".to_owned(),
        d if d < 1.0 => format!("{:+.2} %", 100.0 * d),
        d if d < 999.0 => format!("x {:.3}", 1.0 + d),
        d => format!("x {:.1e}", 1.0 + d),
    }
}

/// Bytes with a prefix and three significant digits, or whole below a kilobyte.
pub(crate) fn bytes(count: f64) -> String {
    const UNITS: [(&str, f64); 5] = [("PB", 1e15), ("TB", 1e12), ("GB", 1e9), ("MB", 1e6), ("kB", 1e3)];
    let Some((unit, size)) = UNITS.iter().find(|(_, size)| count >= 0.9995 * size) else {
        return format!("{count:.0} bytes");
    };
    let value = count / size;
    let digits = if value < 9.995 { 2 } else { usize::from(value < 99.95) };
    format!("{value:.digits$} {unit}")
}

/// Seconds, minutes or hours.
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 120.0 {
        format!("{seconds:.1} s")
    } else if seconds < 7200.0 {
        format!("{:.1} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

/// A number of things, of which there may be one: `1 patch`, `2 patches`.
pub(crate) fn counted(count: impl Into<u64>, one: &str, more: &str) -> String {
    match count.into() {
        1 => format!("1 {one}"),
        count => format!("{count} {more}"),
    }
}

/// A range of replicas, for people.
pub(crate) fn replicas(range: &Range<u64>, of: u64) -> String {
    format!("{} to {} of 0 to {}", range.start, range.end.saturating_sub(1), of.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_prefixes() {
        assert_eq!(si(6.4e-4, "N"), "640.0 µN");
        assert_eq!(si(-7.56e-2, "N"), "-75.60 mN");
        assert_eq!(si(2.5e9, "Pa"), "2.500 GPa");
        assert_eq!(si(0.0, "N"), "0 N");
        assert_eq!(si(1.2e-19, "J"), "120.0 zJ");
        assert_eq!(si(1e-25, "N"), "1.000e-25 N");
    }

    #[test]
    fn times_and_shares_are_readable() {
        assert_eq!(duration(3.25), "3.2 s");
        assert_eq!(bytes(12.0), "12 bytes");
        assert_eq!(bytes(43.9e6), "43.9 MB");
        assert_eq!(bytes(999.96e6), "1.00 GB");
        assert_eq!(bytes(8.4321e12), "8.43 TB");
        assert_eq!(bytes(12345e15), "12345 PB");
        assert_eq!(duration(600.0), "10.0 min");
        assert_eq!(duration(36000.0), "10.0 h");
        assert_eq!(percent(0.1234), "12.34 %");
        assert_eq!(percent(1e-6), "1.0e-4 %");
        assert_eq!(signed_percent(-0.0123), "-1.23 %");
        assert_eq!(signed_percent(7.638), "x 8.638");
        assert_eq!(signed_percent(1e12), "x 1.0e12");
        assert_eq!(signed_percent(f64::NAN), "-");
        assert_eq!(pure(0.8985), "0.8985");
        assert_eq!(pure(1.5e-7), "1.500e-7");
    }
}
