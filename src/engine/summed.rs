//! A surface whose curves are known, and what is asked of it then.

use super::job::Job;
use crate::asperity::Loop;
use crate::math::extrema::Extremum;

/// A surface that has been summed over the separations of its job.
pub(super) trait Summed {
    /// The highest asperity, m; NaN of none.
    fn highest(&self) -> f64;

    /// Separations h, m, at which the first asperity touches on approach, wherever the separations are, and at which the last
    /// loses contact on retraction from the smallest separation; NaN of none.
    fn contacts(&mut self, cycle: &Loop) -> (f64, f64);

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

/// First touch and last contact of asperities of one radius, whose highest is known, m: the higher an
/// asperity, the sooner it touches and the longer it keeps contact.
pub(super) fn of_highest(job: &Job<'_>, cycle: &Loop, highest: f64) -> (f64, f64) {
    let closest = job.separations[0];
    let detachment = cycle.detachment(highest - job.surface.asperity_separation(closest));
    (
        highest - cycle.touch() + job.surface.mean_plane_offset,
        detachment.map_or(f64::NAN, |distance| closest + distance),
    )
}
