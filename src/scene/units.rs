//! Quantities as scenes write them: a number and a unit.

/// The dimension of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// m.
    Length,
    /// m².
    Area,
    /// 1/m².
    ArealDensity,
    /// Pa.
    Pressure,
    /// J/m².
    SurfaceEnergy,
    /// N.
    Force,
    /// N/m, of the derivative of a force by a separation.
    Stiffness,
    /// J.
    Energy,
    /// V.
    Voltage,
    /// K.
    Temperature,
    /// rad.
    Angle,
    /// m³/mol.
    MolarVolume,
}

/// A dimension: its name in messages, its SI unit in files, its units with their factors to SI as powers of
/// ten.
type Row = (Dimension, [&'static str; 2], &'static [(&'static str, i32)]);

const UNITS: &[Row] = &[
    (
        Dimension::Length,
        ["a length", "m"],
        &[("m", 0), ("cm", -2), ("mm", -3), ("um", -6), ("nm", -9), ("angstrom", -10), ("pm", -12)],
    ),
    (
        Dimension::Area,
        ["an area", "m2"],
        &[("m^2", 0), ("cm^2", -4), ("mm^2", -6), ("um^2", -12), ("nm^2", -18)],
    ),
    (
        Dimension::ArealDensity,
        ["a number per area", "m-2"],
        &[("/m^2", 0), ("/cm^2", 4), ("/mm^2", 6), ("/um^2", 12), ("/nm^2", 18)],
    ),
    (
        Dimension::Pressure,
        ["a pressure", "Pa"],
        &[("Pa", 0), ("kPa", 3), ("MPa", 6), ("GPa", 9), ("TPa", 12)],
    ),
    (
        Dimension::SurfaceEnergy,
        ["an energy per area", "J m-2"],
        &[("J/m^2", 0), ("mJ/m^2", -3), ("uJ/m^2", -6), ("N/m", 0), ("mN/m", -3), ("uN/m", -6)],
    ),
    (
        Dimension::Force,
        ["a force", "N"],
        &[("N", 0), ("mN", -3), ("uN", -6), ("nN", -9), ("pN", -12), ("fN", -15), ("kN", 3)],
    ),
    (
        Dimension::Stiffness,
        ["a stiffness", "N m-1"],
        &[
            ("N/m", 0),
            ("mN/m", -3),
            ("uN/m", -6),
            ("kN/m", 3),
            ("MN/m", 6),
            ("N/mm", 3),
            ("N/um", 6),
            ("nN/nm", 0),
        ],
    ),
    (
        Dimension::Energy,
        ["an energy", "J"],
        &[("J", 0), ("mJ", -3), ("uJ", -6), ("nJ", -9), ("pJ", -12), ("fJ", -15), ("aJ", -18), ("zJ", -21)],
    ),
    (Dimension::Voltage, ["a voltage", "V"], &[("V", 0), ("kV", 3), ("mV", -3), ("uV", -6)]),
    (Dimension::Temperature, ["a temperature", "K"], &[("K", 0)]),
    (Dimension::Angle, ["an angle", "rad"], &[("rad", 0)]),
    (
        Dimension::MolarVolume,
        ["a volume per amount", "m3 mol-1"],
        &[("m^3/mol", 0), ("cm^3/mol", -6), ("mm^3/mol", -9)],
    ),
];

/// A dimension, a unit of it, and what makes SI values of values in it.
type Other = (Dimension, &'static str, fn(f64) -> f64);

/// Units that are no power of ten of the SI unit.
const OTHERS: &[Other] = &[
    (Dimension::Temperature, "degC", |celsius| celsius + 273.15),
    (Dimension::Angle, "deg", f64::to_radians),
];

/// Characters and sequences of other writers, and what they are here: the micro sign and the Greek mu, the
/// letter, the sign and the composed ångström, superscripts, the true minus.
const SPELLINGS: &[(&str, &str)] = &[
    ("\u{b5}", "u"),
    ("\u{3bc}", "u"),
    ("\u{c5}", "angstrom"),
    ("\u{212b}", "angstrom"),
    ("A\u{30a}", "angstrom"),
    ("\u{212a}", "K"),
    ("\u{2103}", "degC"),
    ("\u{b0}C", "degC"),
    ("\u{b0}", "deg"),
    ("\u{b9}", "1"),
    ("\u{b2}", "2"),
    ("\u{b3}", "3"),
    ("\u{207b}", "-"),
    ("\u{2212}", "-"),
    ("\u{22c5}", " "),
    ("\u{b7}", " "),
    ("\u{a0}", " "),
    ("**", "^"),
    ("*", " "),
];

impl Dimension {
    /// The name in messages, with an article.
    pub fn name(self) -> &'static str {
        row(self).1[0]
    }

    /// The SI unit as scenes write it.
    pub fn si(self) -> &'static str {
        units(self).iter().find(|(_, power)| *power == 0).expect("every dimension has its SI unit").0
    }

    /// The largest of its units that is not larger than a value, and its size, SI; the SI unit for a value
    /// below all of them.
    fn unit_below(self, value: f64) -> (&'static str, f64) {
        let thousands = units(self).iter().filter(|(_, power)| power % 3 == 0);
        let sizes = thousands.map(|(unit, power)| (*unit, crate::math::power::power(10.0, *power)));
        let below = sizes.filter(|(_, size)| *size <= value * (1.0 + 1e-9));
        let largest = below.fold(None, |best: Option<(&str, f64)>, unit| match best {
            Some(best) if best.1 >= unit.1 => Some(best),
            _ => Some(unit),
        });
        largest.unwrap_or((self.si(), 1.0))
    }

    /// The SI unit as files write it.
    pub fn file_units(self) -> &'static str {
        row(self).1[1]
    }

    /// The dimension of an SI unit as files write it.
    ///
    /// # Panics
    /// When no dimension has it, which is an error in this program.
    pub fn of_units(units: &str) -> Self {
        let found = UNITS.iter().find(|row| row.1[1] == units);
        found.unwrap_or_else(|| panic!("no dimension has the units {units}")).0
    }

    /// A value, SI, in messages and tables: six digits at most, in the unit that is next below it.
    pub fn shown(self, value: f64) -> String {
        let (unit, size) = self.unit_below(value.abs());
        format!("{} {unit}", rounded(value / size))
    }

    /// Advice on what an unknown unit of a quantity may mean: a unit in other letters, or a Vickers hardness.
    pub fn meant(self, unknown: &str, quantity: &str) -> Option<String> {
        if self == Self::Pressure && unknown.to_uppercase().starts_with("HV") {
            let number: f64 = quantity.trim()[..number_end(quantity.trim())].trim().parse().ok()?;
            return Some(format!("1 HV is 9.807 MPa: \"{:.3} GPa\"", 9.807e-3 * number));
        }
        let same = |(unit, _): &&(&str, i32)| unit.eq_ignore_ascii_case(unknown);
        Some(format!("did you mean `{}`?", units(self).iter().find(same)?.0))
    }

    /// The units in messages.
    pub fn units(self) -> String {
        let others = OTHERS.iter().filter(|(dimension, ..)| *dimension == self).map(|(_, unit, _)| *unit);
        let spellings = units(self).iter().map(|(spelling, _)| *spelling).chain(others);
        spellings.collect::<Vec<_>>().join(", ")
    }
}

/// A number to six digits at most.
pub fn rounded(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let is_plain = (1e-3..1e6).contains(&rounded.abs()) || rounded == 0.0;
    if is_plain { format!("{rounded}") } else { format!("{rounded:e}") }
}

fn units(dimension: Dimension) -> &'static [(&'static str, i32)] {
    row(dimension).2
}

fn row(dimension: Dimension) -> &'static Row {
    UNITS.iter().find(|row| row.0 == dimension).expect("every dimension has units")
}

/// Reasons why a text is not a quantity of a dimension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum QuantityError {
    /// The text does not begin with a number.
    NoNumber,
    /// The number has a comma.
    DecimalComma,
    /// Nothing follows the number.
    NoUnit,
    /// The unit measures something else.
    OtherDimension(Dimension),
    /// The unit is unknown.
    UnknownUnit(String),
}

/// Reads a quantity such as `3.33 um`; SI. The power of ten of the unit is applied in the decimal text, so
/// `1.6 nm` is the double nearest to 1.6e-9.
///
/// # Errors
/// [`QuantityError`].
pub fn parse(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    let text = text.trim();
    let text = &text.strip_prefix('\u{2212}').map_or_else(|| text.to_owned(), |rest| format!("-{rest}"));
    let end = number_end(text);
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    if unit.strip_prefix(',').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit())) {
        return Err(QuantityError::DecimalComma);
    }
    let plain: f64 = number.parse().map_err(|_| QuantityError::NoNumber)?;
    if unit.is_empty() {
        return Err(QuantityError::NoUnit);
    }
    let normal = normal(unit);
    if let Some((other, _, si)) = OTHERS.iter().find(|(_, spelling, _)| *spelling == normal) {
        return if *other == dimension { Ok(si(plain)) } else { Err(QuantityError::OtherDimension(*other)) };
    }
    let find = |dimension| units(dimension).iter().find(|(spelling, _)| *spelling == normal);
    match find(dimension) {
        Some((_, power)) => Ok(scaled(number, plain, *power)),
        None => Err(UNITS
            .iter()
            .find(|(other, ..)| find(*other).is_some())
            .map_or(QuantityError::UnknownUnit(unit.to_owned()), |(other, ..)| {
                QuantityError::OtherDimension(*other)
            })),
    }
}

/// Whether a text is a unit of any quantity.
pub fn is_unit(text: &str) -> bool {
    matches!(parse(&format!("1 {text}"), Dimension::Length), Ok(_) | Err(QuantityError::OtherDimension(_)))
}

/// A number of per cent, such as `10 %`: 0.1.
pub fn percentage(text: &str) -> Option<f64> {
    let number = text.trim().strip_suffix('%')?.trim();
    let plain = number.parse().ok()?;
    Some(scaled(number, plain, -2))
}

/// A whole number as people write many, such as `1e3`.
pub fn whole(text: &str) -> Option<u64> {
    let is_whole = |number: &f64| number.fract() == 0.0 && (0.0..=9e15).contains(number);
    text.parse().ok().or_else(|| text.parse::<f64>().ok().filter(is_whole).map(|number| number as u64))
}

/// A unit as the table spells it: `um^-2`, `µm⁻²`, `1/um2` and `um**-2` are `/um^2`, `J m-2` is `J/m^2`.
fn normal(unit: &str) -> String {
    let plain = SPELLINGS.iter().fold(unit.to_owned(), |unit, (other, own)| unit.replace(other, own));
    let (mut above, mut below) = (String::new(), String::new());
    for (i, part) in plain.split('/').enumerate() {
        for factor in part.split(' ').filter(|factor| !(factor.is_empty() || i == 0 && *factor == "1")) {
            let base = factor.trim_end_matches(|c: char| c.is_ascii_digit());
            let power = &factor[base.len()..];
            let (inverse, base) = match base.strip_suffix('-') {
                Some(base) if !power.is_empty() => (true, base),
                _ => (false, base),
            };
            let name = base.strip_suffix('^').filter(|_| !power.is_empty()).unwrap_or(base);
            if name.is_empty() {
                return plain;
            }
            let power = if matches!(power, "" | "1") { String::new() } else { format!("^{power}") };
            let side = if (i > 0) != inverse { &mut below } else { &mut above };
            *side += &format!("{}{name}{power}", if side.is_empty() { "" } else { " " });
        }
    }
    if below.is_empty() { above } else { format!("{above}/{}", below.replace(' ', "/")) }
}

/// The end of the number at the beginning of a text, in bytes; 0 where there is none. Looks at each byte
/// once.
fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(bytes.get(at).is_some_and(|byte| matches!(byte, b'+' | b'-')));
    let start = sign(0);
    let word = |word: &&str| {
        bytes[start..].get(..word.len()).is_some_and(|b| b.eq_ignore_ascii_case(word.as_bytes()))
    };
    if let Some(word) = ["infinity", "inf", "nan"].iter().find(|name| word(name)) {
        return start + word.len();
    }
    let whole = digits(start);
    let mut end = start + whole;
    if bytes.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        if whole + fraction == 0 {
            return 0;
        }
        end += 1 + fraction;
    } else if whole == 0 {
        return 0;
    }
    if bytes.get(end).is_some_and(|byte| matches!(byte, b'e' | b'E')) {
        let exponent = end + 1 + sign(end + 1);
        let count = digits(exponent);
        if count > 0 {
            end = exponent + count;
        }
    }
    end
}

/// The number times a power of ten, rounded once.
fn scaled(number: &str, plain: f64, power: i32) -> f64 {
    let (mantissa, exponent) = match number.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => match exponent.parse::<i64>() {
            Ok(exponent) => (mantissa, exponent),
            Err(_) => return plain, // 0 or infinite whatever the unit
        },
        None => (number, 0),
    };
    match format!("{mantissa}e{}", exponent.saturating_add(i64::from(power))).parse::<f64>() {
        Ok(value) => value,
        Err(_) => plain, // nan and inf have no exponent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_rounded_once() {
        let cases = [
            ("3.33 um", Dimension::Length, 3.33e-6),
            ("3.33um", Dimension::Length, 3.33e-6),
            ("1.619 nm", Dimension::Length, 1.619e-9),
            ("1.5e3 µm", Dimension::Length, 1.5e-3),
            ("2 \u{c5}", Dimension::Length, 2e-10),
            ("2 \u{212b}", Dimension::Length, 2e-10),
            ("2 A\u{30a}", Dimension::Length, 2e-10),
            ("-1 nm", Dimension::Length, -1e-9),
            ("7.39 /um^2", Dimension::ArealDensity, 7.39e12),
            ("7.39 1/um^2", Dimension::ArealDensity, 7.39e12),
            ("7.39 um^-2", Dimension::ArealDensity, 7.39e12),
            ("7.39 um-2", Dimension::ArealDensity, 7.39e12),
            ("7.39 /um2", Dimension::ArealDensity, 7.39e12),
            ("7.39 µm⁻²", Dimension::ArealDensity, 7.39e12),
            ("7.39 um**-2", Dimension::ArealDensity, 7.39e12),
            ("1000 um²", Dimension::Area, 1e-9),
            ("1000 um2", Dimension::Area, 1e-9),
            ("90 mJ/m2", Dimension::SurfaceEnergy, 0.09),
            ("90 mJ m^-2", Dimension::SurfaceEnergy, 0.09),
            ("90 mJ·m⁻²", Dimension::SurfaceEnergy, 0.09),
            ("5 N m-1", Dimension::Stiffness, 5.0),
            ("85.29 GPa", Dimension::Pressure, 85.29e9),
            ("20 degC", Dimension::Temperature, 293.15),
            ("-5 °C", Dimension::Temperature, 268.15),
            ("300 K", Dimension::Temperature, 300.0),
            ("30 deg", Dimension::Angle, std::f64::consts::PI / 6.0),
            ("0.5 rad", Dimension::Angle, 0.5),
            ("18 cm^3/mol", Dimension::MolarVolume, 18e-6),
            ("18 cm3 mol-1", Dimension::MolarVolume, 18e-6),
            ("90 mJ/m^2", Dimension::SurfaceEnergy, 0.09),
            ("90 mJ*m**-2", Dimension::SurfaceEnergy, 0.09),
            ("0.09 N/m", Dimension::SurfaceEnergy, 0.09),
            ("\u{2212}5 nm", Dimension::Length, -5e-9),
        ];
        for (text, dimension, expected) in cases {
            assert_eq!(parse(text, dimension), Ok(expected), "{text}");
        }
        assert!(parse("nan nm", Dimension::Length).unwrap().is_nan());
        assert_eq!(parse("inf nm", Dimension::Length), Ok(f64::INFINITY));
    }

    /// The power of ten of a spelling, from what its prefixes and exponents mean in the SI.
    fn power(spelling: &str) -> i32 {
        let factor = |text: &str| {
            let digits =
                text.find(|c: char| c == '^' || c == '-' || c.is_ascii_digit()).unwrap_or(text.len());
            let (unit, exponent) = (&text[..digits], text[digits..].trim_start_matches('^'));
            let exponent: i32 = if exponent.is_empty() { 1 } else { exponent.parse().unwrap() };
            let prefix = match unit.strip_suffix("Pa").or(unit.strip_suffix(['m', 'N', 'J', 'V'])) {
                _ if matches!(unit, "K" | "rad" | "mol") => 0,
                _ if unit == "angstrom" => -10,
                Some("") => 0,
                Some("z") => -21,
                Some("a") => -18,
                Some("f") => -15,
                Some("p") => -12,
                Some("n") => -9,
                Some("u") => -6,
                Some("c") => -2,
                Some("m") => -3,
                Some("k") => 3,
                Some("M") => 6,
                Some("G") => 9,
                Some("T") => 12,
                _ => panic!("{spelling}"),
            };
            prefix * exponent
        };
        match spelling.split_once('/') {
            Some(("", below)) => -factor(below),
            Some((above, below)) => factor(above) - factor(below),
            None => factor(spelling),
        }
    }

    #[test]
    fn every_unit_has_the_power_of_its_prefixes() {
        let mut units = 0;
        for (dimension, _, spellings) in UNITS {
            for (spelling, _) in *spellings {
                let value: f64 = format!("2.5e{}", power(spelling)).parse().unwrap();
                assert_eq!(parse(&format!("2.5 {spelling}"), *dimension), Ok(value), "{spelling}");
                units += 1;
            }
        }
        assert!(units >= 45, "{units}");
    }

    /// The list that the Python package reads as well: what is no quantity has no value there. Every unit is in
    /// it.
    #[test]
    fn quantities_are_those_of_the_list() {
        let mut reader = csv::Reader::from_reader(&include_bytes!("../../tests/data/units.csv")[..]);
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let found = |text: &str, unit: &str| match unit {
            "1" => percentage(text).or_else(|| text.parse().ok()),
            _ => parse(text, Dimension::of_units(unit)).ok(),
        };
        for row in &rows {
            assert_eq!(found(&row[0], &row[1]), row[2].parse().ok(), "{row:?}");
        }
        for (dimension, spelling) in UNITS
            .iter()
            .flat_map(|(dimension, _, units)| units.iter().map(move |(spelling, _)| (dimension, spelling)))
            .chain(OTHERS.iter().map(|(dimension, spelling, _)| (dimension, spelling)))
        {
            let is_listed = |row: &csv::StringRecord| {
                row[1] == *dimension.file_units() && row[0] == format!("2.5 {spelling}")
            };
            assert!(rows.iter().any(is_listed), "{spelling}");
        }
    }

    #[test]
    fn exponents_beyond_any_integer_are_no_other_number() {
        assert_eq!(parse("1e99999999999999999999 m", Dimension::Length), Ok(f64::INFINITY));
        assert_eq!(parse("1e-99999999999999999999 m", Dimension::Length), Ok(0.0));
        assert_eq!(parse("-1e99999999999999999999 m", Dimension::Length), Ok(f64::NEG_INFINITY));
        assert_eq!(parse("1e9223372036854775807 m", Dimension::Length), Ok(f64::INFINITY));
    }

    /// The number is the longest beginning that Rust's own parser takes for one.
    #[test]
    fn a_number_ends_where_the_longest_one_does() {
        let texts = "|-|+.|.|.5m|5.m|-.5e3m|1e|1e+|1e+m|1e5|1e5e5|1.2.3|--1|+-1|inf|infm|-infinitym|INFINIT|nan|+NaNo|in|1inf|1_000|١ m|0x10 m|1e-5µm|e5|.e5|5.e-7nm".split('|');
        for text in texts {
            let ends = text.char_indices().map(|(i, _)| i).chain([text.len()]);
            let longest = ends.filter(|&i| text[..i].parse::<f64>().is_ok()).max().unwrap_or(0);
            assert_eq!(number_end(text), longest, "{text}");
        }
    }

    #[test]
    fn what_is_not_a_quantity_is_named() {
        assert_eq!(parse("3", Dimension::Length), Err(QuantityError::NoUnit));
        assert_eq!(
            parse("3 GPa", Dimension::Length),
            Err(QuantityError::OtherDimension(Dimension::Pressure))
        );
        assert_eq!(parse("3 furlong", Dimension::Length), Err(QuantityError::UnknownUnit("furlong".into())));
        assert_eq!(parse("three nm", Dimension::Length), Err(QuantityError::NoNumber));
        assert_eq!(parse("", Dimension::Length), Err(QuantityError::NoNumber));
        for text in ["3,33 um", "3 ,33 um", "1,000 um", ",5 um"] {
            assert_eq!(parse(text, Dimension::Length), Err(QuantityError::DecimalComma), "{text}");
        }
        for unit in ["um^-3", "/um", "um^2 um", "um/1", "m^0", "m^-1/", "um^", "-", "1"] {
            assert!(
                matches!(parse(&format!("3 {unit}"), Dimension::Area), Err(QuantityError::UnknownUnit(_))),
                "{unit}"
            );
        }
    }

    /// An energy per area and a stiffness share units, which are the same in SI; no other spelling is there
    /// twice.
    #[test]
    fn no_spelling_means_two_things() {
        let of =
            |(dimension, _, units): &Row| units.iter().map(|unit| (*dimension, *unit)).collect::<Vec<_>>();
        let all: Vec<(Dimension, (&str, i32))> = UNITS.iter().flat_map(of).collect();
        let shared = [Dimension::SurfaceEnergy, Dimension::Stiffness];
        for (i, (dimension, unit)) in all.iter().enumerate() {
            let same: Vec<_> =
                all.iter().enumerate().filter(|(j, (_, other))| *j != i && other.0 == unit.0).collect();
            assert!(same.len() <= usize::from(shared.contains(dimension)), "{unit:?}");
            let fits = |(_, (other, also)): &(usize, &(Dimension, (&str, i32)))| {
                *other != *dimension && shared.contains(other) && also == unit
            };
            assert!(same.iter().all(fits), "{unit:?}");
        }
    }
}
