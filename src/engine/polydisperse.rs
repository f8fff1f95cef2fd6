//! Sums over asperities that differ in their radii, and so in λ: asperity by asperity, each by its own law at
//! all separations at once.

use super::Job;
use super::curves::Curves;
use super::parts::deepest_of_parts;
use super::sums::RegimeSums;
use crate::asperity::{Family, Scratch, SolverStats, for_each_block, regime_ranges};
use crate::math::extrema::{Extremum, minimum};

/// Memory for the sums of one surface after the other.
pub(super) struct PlaneSums {
    /// −d, m, rising: in the frame of an asperity the plane moves, and its interference rises with −d.
    planes: Vec<f64>,
    /// By plane, then regime.
    sums: Vec<RegimeSums>,
}

impl PlaneSums {
    /// For surfaces of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let planes = planes(job, job.separations);
        Self { sums: vec![RegimeSums::default(); job.laws.regimes().len() * planes.len()], planes }
    }

    /// Sums a surface at all separations into its curves: `heights` and `radii`, m, of its asperities, whose
    /// laws are a family.
    pub fn surface(
        &mut self,
        family: &Family,
        asperities: (&[f64], &[f64]),
        scratch: &mut Scratch,
        stats: &mut SolverStats,
        curves: &mut Curves,
    ) {
        self.sums.fill(RegimeSums::default());
        add(family, asperities, &self.planes, scratch, stats, &mut self.sums);
        let (regimes, last) = (self.sums.len() / self.planes.len(), self.planes.len() - 1);
        for (plane, sums) in self.sums.chunks_exact(regimes).enumerate() {
            RegimeSums::record(sums, last - plane, curves);
        }
    }
}

/// The minimum of the external force, N, of a surface whose curve through the separations is known: of that,
/// and of places between the smallest of the samples and its neighbours, the `forces` at which, N, are asked
/// for at once.
pub(super) fn pull_off(
    job: &Job<'_>,
    external_force: &[f64],
    forces: impl FnOnce(&[f64]) -> Vec<f64>,
) -> Extremum {
    let sampled = minimum(job.separations, external_force);
    if sampled.at_edge {
        return sampled;
    }
    deepest_of_parts(&job.samples(external_force), forces)
}

/// External forces, N, of asperities, `heights` and `radii`, m, at separations h, m, rising.
pub(super) fn external_forces(
    job: &Job<'_>,
    family: &Family,
    asperities: (&[f64], &[f64]),
    scratch: &mut Scratch,
    stats: &mut SolverStats,
    separations: &[f64],
) -> Vec<f64> {
    let planes = planes(job, separations);
    let mut sums = vec![RegimeSums::default(); planes.len()];
    add(family, asperities, &planes, scratch, stats, &mut sums);
    sums.iter().rev().map(|sum| RegimeSums::external_force(std::slice::from_ref(sum))).collect()
}

/// −d, m, rising, of separations h, m, rising.
pub(super) fn planes(job: &Job<'_>, separations: &[f64]) -> Vec<f64> {
    separations.iter().rev().map(|&h| -job.surface.asperity_separation(h)).collect()
}

/// Adds asperities, `heights` and `radii`, m, to sums by plane, then regime; to one sum for each plane where
/// there is no more.
pub(super) fn add(
    family: &Family,
    (heights, radii): (&[f64], &[f64]),
    planes: &[f64],
    scratch: &mut Scratch,
    stats: &mut SolverStats,
    sums: &mut [RegimeSums],
) {
    let width = sums.len() / planes.len();
    let place = |plane: usize, regime: usize| plane * width + regime.min(width - 1);
    for (&u, &radius) in heights.iter().zip(radii) {
        let law = family.law(radius, None);
        for (regime, range) in regime_ranges(law.as_ref(), planes, -u) {
            range.for_each(|plane| sums[place(plane, regime)].count += 1.0);
        }
        for_each_block(law.as_ref(), planes, -u, scratch, stats, |regime, range, responses| {
            let touches = law.regimes()[regime].is_contact();
            for (i, plane) in range.enumerate() {
                let sum = &mut sums[place(plane, regime)];
                sum.adhesion.add(responses.adhesion[i]);
                if touches {
                    sum.contact.add(responses.contact[i]);
                    sum.area.add(responses.area[i]);
                }
            }
        });
    }
}
