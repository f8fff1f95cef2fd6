//! Sums over asperities that differ in their radii, and so in λ: asperity by asperity, each by its own law at all separations at once.

use super::Job;
use super::curves::Curves;
use super::replica::RegimeSums;
use crate::asperity::{Family, Quantity, Scratch, Work, for_each_block, regime_ranges};
use crate::math::extrema::{Extremum, minimum};

/// Places between two separations at which the search for the pull-off sums the surface.
const PLACES: usize = 16;

/// Memory for the sums of one surface after the other.
pub(super) struct Scattered {
    family: Family,
    /// Number of regimes, which the laws of a model have in common.
    regimes: usize,
    /// −d, m, rising: in the frame of an asperity the plane moves, and its interference rises with −d.
    planes: Vec<f64>,
    separations: Vec<f64>,
    /// y_s, m.
    offset: f64,
    /// By plane, then regime.
    sums: Vec<RegimeSums>,
}

impl Scattered {
    /// For surfaces of a job whose laws are a family.
    pub fn new(job: &Job<'_>, family: &Family) -> Self {
        let regimes = job.law.regimes().len();
        let planes: Vec<f64> = job.separations.iter().rev().map(|&h| -job.surface.asperity_separation(h)).collect();
        Self {
            family: family.clone(),
            sums: vec![RegimeSums::default(); regimes * planes.len()],
            regimes,
            planes,
            separations: job.separations.to_vec(),
            offset: job.surface.mean_plane_offset,
        }
    }

    /// Sums a surface at all separations into its curves: `heights` and `radii`, m, of its asperities.
    pub fn surface(
        &mut self,
        heights: &[f64],
        radii: &[f64],
        scratch: &mut Scratch,
        work: &mut Work,
        curves: &mut Curves,
    ) {
        let (regimes, last) = (self.regimes, self.planes.len() - 1);
        self.sums.fill(RegimeSums::default());
        for (&u, &radius) in heights.iter().zip(radii) {
            let law = self.family.law(radius, None);
            for (regime, range) in regime_ranges(law.as_ref(), &self.planes, -u) {
                range.for_each(|plane| self.sums[plane * regimes + regime].count += 1.0);
            }
            for_each_block(law.as_ref(), &self.planes, -u, scratch, work, |regime, range, responses| {
                let touches = law.regimes()[regime].is_contact();
                for (i, plane) in range.enumerate() {
                    let sum = &mut self.sums[plane * regimes + regime];
                    sum.adhesion.add(responses.adhesion[i]);
                    if touches {
                        sum.contact.add(responses.contact[i]);
                        sum.area.add(responses.area[i]);
                    }
                }
            });
        }
        for (plane, sums) in self.sums.chunks_exact(regimes).enumerate() {
            RegimeSums::record(sums, last - plane, curves);
        }
    }

    /// The minimum of the external force, N, of a surface whose curve through the separations is known: of that, and of places between
    /// the smallest of the samples and its neighbours, at which the surface is summed too.
    pub fn pull_off(
        &self,
        heights: &[f64],
        radii: &[f64],
        scratch: &mut Scratch,
        work: &mut Work,
        external_force: &[f64],
    ) -> Extremum {
        let sampled = minimum(&self.separations, external_force);
        if sampled.at_edge {
            return sampled;
        }
        let smallest =
            (0..external_force.len()).reduce(|a, b| if external_force[b] < external_force[a] { b } else { a });
        let smallest = smallest.unwrap_or(0).clamp(1, self.separations.len() - 2);
        let between = self.separations[smallest - 1..=smallest + 1].windows(2).flat_map(|ends| {
            let step = (ends[1] - ends[0]) / PLACES as f64;
            (1..PLACES).map(move |i| ends[0] + step * i as f64)
        });
        let places: Vec<f64> = between.collect();
        let planes: Vec<f64> = places.iter().rev().map(|h| self.offset - h).collect();
        let mut forces = vec![RegimeSums::default(); planes.len()];
        for (&u, &radius) in heights.iter().zip(radii) {
            let law = self.family.law(radius, None);
            for_each_block(law.as_ref(), &planes, -u, scratch, work, |regime, range, responses| {
                let touches = law.regimes()[regime].is_contact();
                for (i, plane) in range.enumerate() {
                    forces[plane].adhesion.add(responses.adhesion[i]);
                    forces[plane].contact.add(if touches { responses.contact[i] } else { 0.0 });
                }
            });
        }
        let force = |sum: &RegimeSums| RegimeSums::total(std::slice::from_ref(sum))[Quantity::ExternalForce.index()];
        let samples = places.iter().zip(forces.iter().rev().map(force));
        let deepest = samples.chain([(&self.separations[smallest], external_force[smallest])]);
        let deepest = deepest.reduce(|a, b| if b.1 < a.1 { b } else { a });
        deepest.map_or(sampled, |(&place, value)| Extremum { place, value, at_edge: false })
    }
}
