//! A surface whose curves are known, and what is sought of it then.

use super::search::Sought;
use super::state::{Branch, Reversal};
use crate::math::extrema::Extremum;

/// Separations h, m, of the first and the last contact of a surface; NaN of none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contacts {
    /// Where the first asperity touches on approach, wherever the separations are.
    pub touchdown: f64,
    /// Where the last contact is lost on retraction from the smallest separation.
    pub detachment: f64,
}

/// A surface that has been summed over the separations of its job.
pub(super) trait Summed {
    /// The highest asperity, m; NaN of none.
    fn highest(&self) -> f64;

    /// The first and the last contact of a surface on a loop.
    fn contacts(&mut self, reversal: Reversal<'_>) -> Contacts;

    /// External forces, N, at separations h, m, rising, on retraction.
    fn retraction(&mut self, reversal: Reversal<'_>, separations: &[f64]) -> Vec<f64>;

    /// Finds what is sought on a branch from samples of it: separations h, m, rising, and external forces, N.
    fn find(&mut self, sought: Sought, branch: Branch<'_>, samples: &[(f64, f64)]) -> Extremum;
}
