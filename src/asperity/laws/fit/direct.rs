//! The direct law on the ranges of the fits, which their residuals are taken against.
//!
//! Evenly spaced displacements, in scaled variables: f_snc from [`FURTHEST`] equilibrium spacings before the end of
//! contact to that end, f_sel from there to ω_c, f_f from 0 to ω_c.

use super::forms::Coefficients;
use crate::asperity::emd::Emd;
use crate::asperity::error::LawError;
use crate::asperity::law::FitReport;
use crate::asperity::parameters::LawParameters;
use crate::asperity::stats::SolverStats;

/// Displacements of a range: residuals vary fastest at first touch.
const POINTS: usize = 2001;
/// Distance before contact at which the range of f_snc begins, in equilibrium spacings.
const FURTHEST: f64 = 10.0;

/// The direct law of a setting on the ranges of the fits, scaled.
pub struct Direct {
    /// Displacement at which contact begins or ends by the history.
    pub end: f64,
    /// Displacements of f_snc, f_sel and f_f.
    displacements: [Vec<f64>; 3],
    /// The forces there.
    forces: [Vec<f64>; 3],
}

impl Direct {
    /// Solves the law of a setting.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved.
    pub fn new(parameters: &LawParameters) -> Result<Self, LawError> {
        let scale = parameters.scale;
        let emd = Emd::new(scale.lambda, parameters.path)?;
        let end = emd.end();
        let [spacing, critical] = [scale.equilibrium_spacing(), parameters.critical_interference]
            .map(|length| length / scale.length);
        let ranges = [(end - FURTHEST * spacing, end), (end, critical), (0.0, critical)];
        let displacements = ranges.map(|(low, high)| {
            (0..POINTS).map(|i| low + (high - low) * i as f64 / (POINTS - 1) as f64).collect::<Vec<f64>>()
        });
        let mut stats = SolverStats::default();
        let mut contact = |delta: &f64| emd.contact(*delta, &mut stats);
        let adhesion = displacements[1].iter().map(|delta| contact(delta).adhesion).collect();
        let external = displacements[2].iter().map(contact).map(|s| s.radius.powi(3) - s.adhesion).collect();
        // The last point is the end from outside: contact has not begun there.
        let before = |delta: &f64| emd.noncontact(delta.min(end.next_down()), &mut stats).adhesion;
        let noncontact = displacements[0].iter().map(before).collect();
        Ok(Self { end, displacements, forces: [noncontact, adhesion, external] })
    }

    /// Ranges and residuals of scaled coefficients; in SI by the units of `parameters`.
    pub fn report(&self, coefficients: &Coefficients, parameters: &LawParameters) -> FitReport {
        let (length, force) = (parameters.scale.length, parameters.scale.force);
        let fitted = |i: usize, delta: f64| match i {
            0 => coefficients.noncontact(delta),
            1 => coefficients.adhesion(delta),
            _ => coefficients.external(delta),
        };
        let residuals = |i: usize| -> Vec<f64> {
            let pairs = self.displacements[i].iter().zip(&self.forces[i]);
            pairs.map(|(delta, exact)| force * (fitted(i, *delta) - exact)).collect()
        };
        let largest = |values: &[f64]| values.iter().fold(0.0, |worst: f64, value| worst.max(value.abs()));
        // Table 3 is in nm and µN.
        let published = coefficients.in_units(1e-9 / length, 1e-6 / force);
        FitReport {
            coefficients: published.list(),
            range: std::array::from_fn(|i| {
                [0, self.displacements[i].len() - 1].map(|k| length * self.displacements[i][k])
            }),
            largest_force: std::array::from_fn(|i| force * largest(&self.forces[i])),
            largest_residual: std::array::from_fn(|i| largest(&residuals(i))),
            rms_residual: std::array::from_fn(|i| {
                let residuals = residuals(i);
                (residuals.iter().map(|residual| residual * residual).sum::<f64>() / residuals.len() as f64)
                    .sqrt()
            }),
        }
    }
}
