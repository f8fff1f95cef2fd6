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
//! `fit:paper` takes the coefficients of its Table 3, for its three cases, and δ_A as it is given, if it is;
//! `fit:refit` fits the same forms to the direct law of any asperity. The contact area, which has no fit, is
//! that of Hertz.
//!
//! # Validity
//! On the range of the fits. Far away f_snc tends to the constant f_sonc instead of 0; below δ = 0 eq. 20 has
//! no contact force; where the base of the power in f_sel is negative it is taken as 0. A refit far from 0.05
//! < λ < 5 can give negative forces; its residuals tell.

mod forms;
mod refit;

pub use forms::{Coefficients, FORCES, NAMES};

use super::kogut_etsion::plastic_rows;
use crate::asperity::contact::Contact;
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Constant};
use crate::asperity::law::Method;
use crate::asperity::law::{End, Law, Regime, Responses, Smoothness};
use crate::asperity::parameters::LawParameters;
use crate::asperity::scale::{Asperity, Scale};
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Interaction, Row, Table};
use refit::{Direct, FITTED, JUDGED};
use std::f64::consts::PI;

/// Table 3.
const TABLE: &str = include_str!("table_3.csv");
/// The fractional powers of δ are no power series in any root of δ; in the tenth what is left is too smooth
/// to matter.
const ORDER: i32 = 10;
/// How closely an asperity has to be one of Table 3, relative.
const SAME: f64 = 1e-6;

/// The law `fit:paper`.
///
/// # Errors
/// [`LawError::NotInTable3`] for another asperity than its three.
pub fn paper(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let published = published(&parameters.scale).ok_or(LawError::NotInTable3)?;
    law(parameters, &published.in_units(parameters.scale.length / 1e-9, parameters.scale.force / 1e-6))
}

/// The law `fit:refit`.
///
/// # Errors
/// [`LawError`] without a critical interference, which ends the fit, or when the forms cannot be fitted.
pub fn refit(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("fit:refit")?;
    // A fit is for the range that the direct law has, which ends at its own δ_A.
    let parameters = &LawParameters { critical_approach: None, ..*parameters };
    law(parameters, &Direct::new(parameters, FITTED)?.fit()?)
}

/// The law of scaled coefficients.
fn law(parameters: &LawParameters, coefficients: &Coefficients) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("fit:paper")?;
    let direct = Direct::new(parameters, JUDGED)?;
    let report = direct.report(coefficients, parameters);
    // Powers with coefficients that no number holds, of a range that the forms were not made for.
    if !report.coefficients.iter().chain(&report.largest_residual).all(|value| value.is_finite()) {
        return Err(LawError::NoFit);
    }
    let critical_approach = parameters.critical_approach.unwrap_or(-direct.end * parameters.scale.length);
    let thickness = parameters.lubricant_thickness;
    let (scale, coefficients) = (parameters.scale, *coefficients);
    let attraction =
        move |delta: f64| scale.force * coefficients.noncontact((delta + thickness) / scale.length);
    let rows = [
        Row::below(Regime::Noncontact, -critical_approach - thickness, ClosedForm::attraction(attraction)),
        Row::below(Regime::Lubricant, -critical_approach, Constant::lubricant(parameters)),
        Row::up_to(Regime::Elastic, parameters.critical_interference, FittedContact { coefficients, scale }),
    ];
    Ok(Box::new(Table::new(rows.into_iter().chain(plastic_rows(parameters))).with_fit(report)))
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

/// f_sel and f_f.
#[derive(Clone, Copy, Debug)]
struct FittedContact {
    coefficients: Coefficients,
    scale: Scale,
}

impl Interaction for FittedContact {
    fn smoothness(&self, lower: f64, upper: f64) -> (Vec<f64>, Vec<Smoothness>) {
        // f_sel is a power from where its base is 0, f_f one from 0.
        let zero = self.coefficients.base_zero() * self.scale.length;
        let mut ends = vec![zero, 0.0];
        ends.sort_by(f64::total_cmp);
        ends.retain(|end| lower < *end && *end < upper);
        ends.dedup();
        let begins = [lower].into_iter().chain(ends.clone());
        let of = |begin: f64| if begin >= 0.0 { 0.0 } else { zero };
        let smoothness = |begin: f64| match begin < of(begin) {
            true => Smoothness::Smooth,
            false => Smoothness::Root { end: End::Lower, place: of(begin), order: ORDER },
        };
        let pieces = begins.map(smoothness).collect();
        (ends, pieces)
    }

    fn method(&self) -> Method {
        Method::Powers
    }

    // The forms have no unstable part: that of what they are fitted to.
    fn unstable_work(&self) -> f64 {
        Contact::new(self.scale.lambda).unstable_work() * self.scale.energy()
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, _: &mut SolverStats) {
        let area_unit = PI * self.scale.radius * self.scale.radius;
        for (i, &delta) in interference.iter().enumerate() {
            let scaled = delta / self.scale.length;
            let adhesion = self.coefficients.adhesion(scaled);
            let contact = if scaled < 0.0 { 0.0 } else { adhesion + self.coefficients.external(scaled) };
            out.adhesion[i] = self.scale.force * adhesion;
            out.contact[i] = self.scale.force * contact;
            out.area[i] = area_unit * scaled.max(0.0);
        }
    }
}
