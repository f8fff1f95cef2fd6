//! The published forms fitted anew to the direct law of any asperity.
//!
//! Plain least squares of each force on evenly spaced displacements, in scaled variables: f_snc from
//! [`FURTHEST`] equilibrium spacings before the end of contact to that end, f_sel from there to ω_c, f_f from
//! 0 to ω_c.

use super::forms::{Coefficients, lorentzian, power, two_powers};
use crate::asperity::emd::Emd;
use crate::asperity::error::LawError;
use crate::asperity::law::FitReport;
use crate::asperity::parameters::LawParameters;
use crate::asperity::stats::SolverStats;
use crate::math::least_squares::least_squares;

/// Displacements that each force is fitted on.
pub const FITTED: usize = 401;
/// Displacements that the residuals are taken at: they vary fastest at first touch.
pub const JUDGED: usize = 2001;
/// Tolerance of fits near those of similar asperities, relative to the sum of squares.
const NEAR: f64 = 1e-7;
/// How far before contact f_snc is fitted, in equilibrium spacings.
const FURTHEST: f64 = 10.0;

/// The direct law of a setting on the ranges of the fits, scaled.
pub struct Direct {
    /// Where contact begins or ends by the history.
    pub end: f64,
    /// Displacements of f_snc, f_sel and f_f.
    displacements: [Vec<f64>; 3],
    /// The forces there.
    forces: [Vec<f64>; 3],
}

impl Direct {
    /// Solves the law of a setting at so many `points` of each range.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved.
    pub fn new(parameters: &LawParameters, points: usize) -> Result<Self, LawError> {
        let scale = parameters.scale;
        let emd = Emd::new(scale.lambda, parameters.path)?;
        let end = emd.end();
        let [spacing, critical] = [scale.equilibrium_spacing(), parameters.critical_interference]
            .map(|length| length / scale.length);
        let ranges = [(end - FURTHEST * spacing, end), (end, critical), (0.0, critical)];
        let displacements = ranges.map(|(low, high)| {
            (0..points).map(|i| low + (high - low) * i as f64 / (points - 1) as f64).collect::<Vec<f64>>()
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

    /// The best coefficients, scaled.
    ///
    /// # Errors
    /// [`LawError::NoFit`] when the forms cannot be fitted.
    pub fn fit(&self) -> Result<Coefficients, LawError> {
        self.fit_from(None).ok_or(LawError::NoFit)
    }

    /// The best coefficients, scaled, close to those of a similar asperity.
    pub fn fit_near(&self, similar: &Coefficients) -> Option<Coefficients> {
        self.fit_from(Some(similar)).or_else(|| self.fit_from(None))
    }

    fn fit_from(&self, similar: Option<&Coefficients>) -> Option<Coefficients> {
        Some(Coefficients {
            noncontact: self.fit_noncontact(similar)?,
            adhesion: self.fit_adhesion(similar)?,
            external: self.fit_external(similar)?,
        })
    }

    fn fit_noncontact(&self, similar: Option<&Coefficients>) -> Option<[f64; 4]> {
        let (places, values) = (&self.displacements[0], &self.forces[0]);
        let (end, highest) = (*places.last()?, *values.last()?);
        let range = end - places[0];
        // A peak at or beyond the end of the range, as wide as a part of it.
        let far =
            [(0.02, 0.02), (0.05, 0.1), (0.0, 0.1), (0.2, 0.2), (-0.02, 0.05)].map(|(beyond, width)| {
                let (x, b) = (beyond * range, width * range);
                [0.0, highest * std::f64::consts::FRAC_PI_2 * (4.0 * x * x + b * b) / b, b, end + x]
            });
        let near = similar.map(|similar| [similar.noncontact]);
        Some(
            least_squares(lorentzian, places, values, starts(&near, &far), similar.map(|_| NEAR))?.parameters,
        )
    }

    fn fit_adhesion(&self, similar: Option<&Coefficients>) -> Option<[f64; 4]> {
        let begin = self.displacements[1][0];
        let places: Vec<f64> = self.displacements[1].iter().map(|delta| delta - begin).collect();
        let (values, range) = (&self.forces[1], *places.last()?);
        let rise = (values.last()? - values[0]).max(f64::MIN_POSITIVE);
        let far = [0.5, 0.65, 0.8, 1.0].map(|exponent| {
            let slope = libm::pow(rise, 1.0 / exponent) / range;
            [values[0], libm::log(slope), libm::log(0.01 * slope * range), exponent]
        });
        let near = similar.map(|similar| {
            let [constant, slope, offset, exponent] = similar.adhesion;
            [[constant, libm::log(slope), libm::log(offset + slope * begin), exponent]]
        });
        let fitted =
            least_squares(power, &places, values, starts(&near, &far), similar.map(|_| NEAR))?.parameters;
        let [constant, slope, offset, exponent] = fitted;
        let slope = libm::exp(slope);
        Some([constant, slope, libm::exp(offset) - slope * begin, exponent])
    }

    fn fit_external(&self, similar: Option<&Coefficients>) -> Option<[f64; 5]> {
        let (places, values) = (&self.displacements[2], &self.forces[2]);
        let far =
            [0.5, 1.0, 1.4, 2.0].map(|other: f64| [values[0], 1.0, 0.1, libm::log(1.5), libm::log(other)]);
        let near = similar.map(|similar| {
            let [constant, a, b, m, n] = similar.external;
            [[constant, a, b, libm::log(m), libm::log(n)]]
        });
        let [constant, a, b, m, n] =
            least_squares(two_powers, places, values, starts(&near, &far), similar.map(|_| NEAR))?.parameters;
        Some([constant, a, b, libm::exp(m), libm::exp(n)])
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

/// Where a fit starts: at that of a similar asperity, if there is one.
fn starts<'a, const N: usize>(near: &'a Option<[[f64; N]; 1]>, far: &'a [[f64; N]]) -> &'a [[f64; N]] {
    near.as_ref().map_or(far, |near| near)
}
