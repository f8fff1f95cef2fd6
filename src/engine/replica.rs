//! One replica: one surface, its curves and what is kept of them.

use super::Job;
use super::pull_off::pull_off;
use super::stream::{Purpose, stream};
use crate::asperity::{Quantity, Scratch, Work, for_each_block};
use crate::math::extrema::steepest_rise;
use crate::math::sums::{Compensated, lane_sum};

/// What is kept of every replica.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replica {
    /// Number of asperities.
    pub asperity_count: u64,
    /// Highest asperity above the asperity mean plane, m.
    pub highest_asperity: f64,
    /// −min F along its own curve, between the separations too, N.
    pub pull_off_force: f64,
    /// Separation h of the pull-off, m.
    pub pull_off_separation: f64,
    /// Largest dF/dh along its own curve, N/m, at the resolution of the separations.
    pub peak_stiffness: f64,
    /// Separation h of the peak stiffness, m.
    pub peak_stiffness_separation: f64,
    /// Whether the smallest force is at the first or last separation, so that the curve may fall further beyond.
    pub pull_off_at_edge: bool,
}

/// Curves of one surface over S separations and R regimes.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Sums over all asperities, by [`Quantity::index`], each over S.
    pub total: [Vec<f64>; 4],
    /// Asperities in each regime, R × S.
    pub regime_count: Vec<f64>,
    /// Adhesion force of each regime, N, R × S.
    pub regime_adhesion_force: Vec<f64>,
    /// External force of each regime, N, R × S.
    pub regime_external_force: Vec<f64>,
}

/// Memory that replicas reuse one after the other.
pub struct Workspace {
    heights: Vec<f64>,
    /// Interferences, m, at which the law has a kink or jump.
    kinks: Vec<f64>,
    scratch: Scratch,
    sums: Vec<RegimeSums>,
    /// The curves of the last surface.
    pub curves: Curves,
    /// What all surfaces have cost.
    pub work: Work,
}

#[derive(Clone, Copy, Default)]
struct RegimeSums {
    count: f64,
    adhesion: Compensated,
    contact: Compensated,
    area: Compensated,
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let (s, r) = (job.separations.len(), job.law.regimes().len());
        Self {
            heights: vec![0.0; job.surface.asperity_count],
            kinks: job.law.pieces().iter().map(|piece| piece.lower).filter(|lower| lower.is_finite()).collect(),
            scratch: Scratch::default(),
            sums: vec![RegimeSums::default(); r],
            curves: Curves {
                total: std::array::from_fn(|_| vec![0.0; s]),
                regime_count: vec![0.0; r * s],
                regime_adhesion_force: vec![0.0; r * s],
                regime_external_force: vec![0.0; r * s],
            },
            work: Work::default(),
        }
    }

    /// Draws a replica, sums it over all separations, and tells what is kept of it.
    pub fn replica(&mut self, job: &Job<'_>, index: u64) -> Replica {
        let mut random = stream(job.seed, Purpose::Heights, index);
        job.surface.heights.draw(&mut random, &mut self.heights);
        // Rising heights make the regimes contiguous, and neighbours in a slice neighbours in the law.
        self.heights.sort_unstable_by(f64::total_cmp);
        self.sum_surface(job);
        let external = &self.curves.total[Quantity::ExternalForce.index()];
        let pull_off = pull_off(job, &self.kinks, &self.heights, external, &mut self.scratch, &mut self.work);
        let stiffest = steepest_rise(job.separations, external);
        Replica {
            asperity_count: self.heights.len() as u64,
            highest_asperity: self.heights.last().copied().unwrap_or(f64::NAN),
            pull_off_force: -pull_off.value,
            pull_off_separation: pull_off.place,
            peak_stiffness: stiffest.value,
            peak_stiffness_separation: stiffest.place,
            pull_off_at_edge: pull_off.at_edge,
        }
    }

    fn sum_surface(&mut self, job: &Job<'_>) {
        let separations = job.separations.len();
        for (k, &h) in job.separations.iter().enumerate() {
            self.sums.fill(RegimeSums::default());
            let (sums, scratch, work) = (&mut self.sums, &mut self.scratch, &mut self.work);
            let d = job.surface.asperity_separation(h);
            for_each_block(job.law, &self.heights, d, scratch, work, |regime, range, responses| {
                let (sum, n) = (&mut sums[regime], range.len());
                sum.count += n as f64;
                sum.adhesion.add(lane_sum(&responses.adhesion[..n]));
                sum.contact.add(lane_sum(&responses.contact[..n]));
                sum.area.add(lane_sum(&responses.area[..n]));
            });
            let mut total = [Compensated::default(); 3];
            for (regime, sum) in self.sums.iter().enumerate() {
                let (adhesion, contact) = (sum.adhesion.value(), sum.contact.value());
                let place = regime * separations + k;
                self.curves.regime_count[place] = sum.count;
                self.curves.regime_adhesion_force[place] = adhesion;
                self.curves.regime_external_force[place] = contact - adhesion;
                total[0].add(adhesion);
                total[1].add(contact);
                total[2].add(sum.area.value());
            }
            let total = Quantity::of_response(total[0].value(), total[1].value(), total[2].value());
            for (curve, value) in self.curves.total.iter_mut().zip(total) {
                curve[k] = value;
            }
        }
    }
}
