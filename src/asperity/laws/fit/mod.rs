//! The hybrid law as it was published: with curve fits instead of the elastic solution.
//!
//! # Formula
//! The rows of [`super::hybrid`] with (Shi and Polycarpou 2005, eqs. 15, 17, 20 and A.1)
//!
//! | regime | F_s | P |
//! |---|---|---|
//! | noncontact | f_snc(δ + t) | 0 |
//! | elastic, δ < 0 | f_sel(δ) | 0 |
//! | elastic, δ ≥ 0 | f_sel(δ) | f_sel(δ) + f_f(δ) |
//!
//! Coefficients are from its Table 3, for its three cases, and δ_A is as it is given, if it is. The contact
//! area, which has no fit, is that of Hertz.
//!
//! # Validity
//! On the range of the fits. Far away f_snc tends to the constant f_sonc instead of 0; below δ = 0 eq. 20 has
//! no contact force; where the base of the power in f_sel is negative it is taken as 0.

mod direct;
mod forms;

pub use forms::{Coefficients, FORCES, NAMES};

use super::kogut_etsion::plastic_rows;
use crate::asperity::block::BLOCK;
use crate::asperity::contact::Contact;
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Constant, Formula, Tabulated};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Place;
use crate::asperity::scale::{Asperity, Scale};
use crate::asperity::table::{Row, Table};
use direct::Direct;
use std::f64::consts::PI;

/// Table 3.
const TABLE: &str = include_str!("table_3.csv");
/// The fractional powers of δ are no power series in any root of δ; in the tenth what is left is too smooth
/// to matter.
const ORDER: i32 = 10;
/// Accuracy of tabulated powers, relative to the magnitudes of their terms: a few roundings.
const TABLE_TOLERANCE: f64 = 4e-15;
/// Relative difference within which an asperity is one of Table 3.
const SAME: f64 = 1e-6;

/// The law `fit:paper`.
///
/// # Errors
/// [`LawError::NotInTable3`] for another asperity than its three; [`LawError`] without a critical interference, which
/// ends the fits, or with one so deep that no number holds their powers.
pub fn paper(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let published = published(&parameters.scale).ok_or(LawError::NotInTable3)?;
    parameters.plastic("fit:paper")?;
    let (scale, thickness) = (parameters.scale, parameters.lubricant_thickness);
    let coefficients = published.in_units(scale.length / 1e-9, scale.force / 1e-6);
    let direct = Direct::new(parameters)?;
    let report = direct.report(&coefficients, parameters);
    // Powers with coefficients that no number holds, of a range that the forms were not made for.
    if !report.coefficients.iter().chain(&report.largest_residual).all(|value| value.is_finite()) {
        return Err(LawError::NoFit);
    }
    let own_end = direct.end * scale.length;
    // Where contact begins or ends by the history, less an offset, m; at the one place that is given, if it is.
    let begins = |offset: f64| match parameters.critical_approach {
        Some(given) => Place::from(-given - offset),
        None => {
            let least = (f64::NEG_INFINITY, -offset);
            Place::elastic(own_end - offset, parameters.path, scale.length, least)
        }
    };
    let attraction = ClosedForm::attraction(move |delta: f64| {
        scale.force * coefficients.noncontact((delta + thickness) / scale.length)
    });
    let contact = fitted_contact(parameters, coefficients, direct.end);
    let rows = [
        Row::below(Regime::Noncontact, begins(thickness), attraction),
        Row::below(Regime::Lubricant, begins(0.0), Constant::lubricant(parameters)),
        Row::up_to(Regime::Elastic, Place::proportional(parameters.critical_interference, 1.0), contact),
    ];
    Ok(Box::new(Table::new(rows.into_iter().chain(plastic_rows(parameters))).with_fit(report)))
}

/// f_sel and f_f from tables of their powers, from the scaled displacement `begin` on.
fn fitted_contact(parameters: &LawParameters, coefficients: Coefficients, begin: f64) -> impl Law + use<> {
    let scale = parameters.scale;
    let critical = parameters.critical_interference / scale.length;
    let deepest = parameters.deepest(parameters.critical_interference).map_or(begin, |end| end.min(critical));
    let adhesion = Tabulated::within(
        scale.force,
        1.0 / scale.length,
        move |x| coefficients.adhesion(x),
        move |x| TABLE_TOLERANCE * coefficients.adhesion_magnitude(x),
        (begin, deepest),
    );
    let load = Tabulated::within(
        scale.force,
        1.0 / scale.length,
        move |x| coefficients.adhesion(x) + coefficients.external(x),
        move |x| TABLE_TOLERANCE * (coefficients.adhesion_magnitude(x) + coefficients.external_magnitude(x)),
        (0.0, deepest),
    );
    let area_unit = PI * scale.radius * scale.radius / scale.length;
    let area = move |delta: f64| area_unit * delta.max(0.0);
    // f_sel is a power from where its base is 0, f_f one from 0.
    let zero = coefficients.base_zero() * scale.length;
    // The forms have no unstable part: that of what they are fitted to.
    let unstable_work = Contact::new(scale.lambda).unstable_work() * scale.energy();
    let load = Inside { formula: load, inside: 0.5 * deepest * scale.length };
    ClosedForm::new(adhesion, load, area)
        .with_root_from(zero, zero.min(0.0), ORDER)
        .with_root(0.0, ORDER)
        .with_unstable_work(unstable_work)
}

/// A formula from δ = 0 on, and 0 before.
#[derive(Clone, Debug)]
struct Inside<F> {
    formula: F,
    /// δ, m, of which the formula has a table.
    inside: f64,
}

impl<F: Formula> Formula for Inside<F> {
    #[inline(always)]
    fn fill(&self, interference: &[f64], out: &mut [f64]) {
        let mut inside = [0.0; BLOCK];
        let inside = &mut inside[..out.len()];
        inside.iter_mut().zip(interference).for_each(|(place, delta)| {
            *place = if *delta < 0.0 { self.inside } else { *delta };
        });
        self.formula.fill(inside, out);
        for (value, delta) in out.iter_mut().zip(interference) {
            *value = if *delta < 0.0 { 0.0 } else { *value };
        }
    }
}

/// The coefficients of Table 3 for an asperity, in nm and µN.
fn published(scale: &Scale) -> Option<Coefficients> {
    let rows: Vec<Vec<&str>> = TABLE
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .map(|line| line.split(',').skip(1).collect())
        .collect();
    (0..3).find_map(|case| {
        let numbers: Vec<f64> = rows.iter().filter_map(|row| row[case].parse().ok()).collect();
        let [radius, work_of_adhesion, modulus, spacing, coefficients @ ..] = numbers.as_slice() else {
            return None;
        };
        let asperity = Asperity {
            radius: radius * 1e-6,
            reduced_modulus: modulus * 1e9,
            work_of_adhesion: *work_of_adhesion,
            equilibrium_spacing: spacing * 1e-9,
            hardness: 1.0,
            poisson_ratio: 0.0,
            lubricant_thickness: 0.0,
        };
        let own = Scale::new(&asperity).ok()?;
        let same = |a: f64, b: f64| (a / b - 1.0).abs() < SAME;
        let is_it = same(own.lambda, scale.lambda)
            && same(own.length, scale.length)
            && same(own.radius, scale.radius)
            && same(own.force, scale.force);
        if is_it { Some(Coefficients::from_list(coefficients.try_into().ok()?)) } else { None }
    })
}
