//! Quantities such as scenes hold: any text is one or is refused, and a number keeps its value.

use super::{cases, runner};
use proptest::prelude::*;
use std::time::{Duration, Instant};
use stiction::scene::units::{Dimension, parse};

const DIMENSIONS: [Dimension; 5] = [
    Dimension::Length,
    Dimension::Area,
    Dimension::ArealDensity,
    Dimension::Pressure,
    Dimension::SurfaceEnergy,
];
const PIECES: [&str; 30] = [
    "1",
    "0",
    "9",
    ".",
    "-",
    "+",
    "e",
    "E",
    "_",
    " ",
    "\t",
    "\u{a0}",
    "nan",
    "inf",
    "infinity",
    "m",
    "um",
    "µm",
    "μm",
    "Å",
    "/",
    "^2",
    "²",
    "1/",
    "Pa",
    "J/m^2",
    "\u{1b}[31m",
    "\0",
    "e308",
    "e-324",
];

#[test]
fn every_text_is_a_quantity_or_none() {
    let _alone = super::alone();
    let pieces = proptest::collection::vec(proptest::sample::select(&PIECES[..]), 0..12);
    let texts = prop_oneof![pieces.prop_map(|pieces| pieces.concat()), any::<String>()];
    let case = |(text, dimension): (String, Dimension)| {
        let _ = parse(&text, dimension);
        Ok(())
    };
    runner(cases(10_000)).run(&(texts, proptest::sample::select(&DIMENSIONS[..])), case).unwrap();
}

/// The shortest decimals of any double are read as that double in m, and a power of ten elsewhere moves the
/// decimal point only.
#[test]
fn a_quantity_has_the_value_of_its_decimals() {
    let _alone = super::alone();
    let case = |number: f64| {
        prop_assert_eq!(parse(&format!("{number:e} m"), Dimension::Length), Ok(number));
        let text = format!("{number:e}");
        let (mantissa, exponent) = text.split_once('e').unwrap();
        let moved: f64 = format!("{mantissa}e{}", exponent.parse::<i32>().unwrap() - 9).parse().unwrap();
        prop_assert_eq!(parse(&format!("{number:e}nm"), Dimension::Length), Ok(moved));
        prop_assert_eq!(parse(&format!("{number} nm"), Dimension::Length), Ok(moved));
        Ok(())
    };
    runner(cases(5_000)).run(&proptest::num::f64::NORMAL, case).unwrap();
}

/// A megabyte of digits, with or without what makes it a number: milliseconds, not the square of its length.
#[test]
fn long_quantities_take_no_longer_than_they_are() {
    let _alone = super::alone();
    for piece in ["1", ".", "e", "-", "1e", "inf", "nan", " ", "1 ", "²", "1/"] {
        let text = piece.repeat(1_000_000 / piece.len());
        for text in [format!("{text}m"), format!("{text} m"), format!("1{text} nm"), format!("1 {text}")] {
            let begun = Instant::now();
            let _ = parse(&text, Dimension::Length);
            assert!(begun.elapsed() < Duration::from_secs(1), "{piece}: {:?}", begun.elapsed());
        }
    }
}
