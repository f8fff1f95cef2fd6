//! A surface whose curves are known, and what is asked of it then.

use crate::math::extrema::Extremum;

/// A surface that has been summed over the separations of its job.
pub(super) trait Summed {
    /// The highest asperity, m; NaN of none.
    fn highest(&self) -> f64;

    /// The pull-off on its way over the separations of the job, from its external force there, N.
    fn pull_off(&mut self, external_force: &[f64]) -> Extremum;

    /// External forces, N, at separations h, m, rising, on retraction from the separation `from`, m.
    fn retraction(&mut self, from: f64, separations: &[f64]) -> Vec<f64>;

    /// The pull-off on retraction from the separation `from`, m, from samples of it: separations h, m,
    /// rising, and external forces, N.
    fn retraction_pull_off(&mut self, from: f64, samples: &[(f64, f64)]) -> Extremum;

    /// The largest secant stiffness over a span, m, from samples of its way: on retraction from the
    /// separation `from`, m, if there is one.
    fn stiffest(&mut self, from: Option<f64>, samples: &[(f64, f64)], span: f64) -> Extremum;
}
