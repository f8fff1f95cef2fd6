//! One replica: one surface, its curves and what is kept of them.

use super::Job;
use super::pull_off::{Jump, jumps, pull_off};
use super::sampling::draw;
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
    jumps: Vec<Jump>,
    sums: Sums,
    /// The curves of the last surface.
    pub curves: Curves,
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let (s, r) = (job.separations.len(), job.law.regimes().len());
        Self {
            heights: vec![0.0; job.surface.asperity_count],
            jumps: jumps(job.law),
            sums: Sums { regimes: vec![RegimeSums::default(); r], scratch: Scratch::default(), work: Work::default() },
            curves: Curves {
                total: std::array::from_fn(|_| vec![0.0; s]),
                regime_count: vec![0.0; r * s],
                regime_adhesion_force: vec![0.0; r * s],
                regime_external_force: vec![0.0; r * s],
            },
        }
    }

    /// What all surfaces have cost.
    pub fn work(&self) -> Work {
        self.sums.work
    }

    /// Draws a replica, sums it over all separations, and tells what is kept of it.
    pub fn replica(&mut self, job: &Job<'_>, index: u64) -> Replica {
        draw(job.surface, job.seed, job.scheme, index, &mut self.heights);
        // Rising heights make the regimes contiguous, and neighbours in a slice neighbours in the law.
        self.heights.sort_unstable_by(f64::total_cmp);
        for k in 0..job.separations.len() {
            self.sums.surface(job, &self.heights, job.separations[k]);
            self.curves.record(k, &self.sums);
        }
        let external = &self.curves.total[Quantity::ExternalForce.index()];
        let pull_off = pull_off(job, &self.jumps, &self.heights, external, |h| {
            self.sums.surface(job, &self.heights, h);
            self.sums.total()[Quantity::ExternalForce.index()]
        });
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
}

/// Sums over the asperities of one surface at one separation.
struct Sums {
    regimes: Vec<RegimeSums>,
    scratch: Scratch,
    work: Work,
}

#[derive(Clone, Copy, Default)]
struct RegimeSums {
    count: f64,
    adhesion: Compensated,
    contact: Compensated,
    area: Compensated,
}

impl Sums {
    /// Sums a surface: `heights` (m) rising, at the separation h, m.
    fn surface(&mut self, job: &Job<'_>, heights: &[f64], separation: f64) {
        self.regimes.fill(RegimeSums::default());
        let (regimes, d) = (&mut self.regimes, job.surface.asperity_separation(separation));
        for_each_block(job.law, heights, d, &mut self.scratch, &mut self.work, |regime, range, responses| {
            let (sum, n) = (&mut regimes[regime], range.len());
            sum.count += n as f64;
            sum.adhesion.add(lane_sum(&responses.adhesion[..n]));
            sum.contact.add(lane_sum(&responses.contact[..n]));
            sum.area.add(lane_sum(&responses.area[..n]));
        });
    }

    /// The quantities of the whole surface, by [`Quantity::index`].
    fn total(&self) -> [f64; 4] {
        let total = |part: fn(&RegimeSums) -> f64| {
            let mut sum = Compensated::default();
            self.regimes.iter().for_each(|regime| sum.add(part(regime)));
            sum.value()
        };
        Quantity::of_response(total(|r| r.adhesion.value()), total(|r| r.contact.value()), total(|r| r.area.value()))
    }
}

impl Curves {
    /// Takes over the sums at the separation `k`.
    fn record(&mut self, k: usize, sums: &Sums) {
        let separations = self.total[0].len();
        for (regime, sum) in sums.regimes.iter().enumerate() {
            let place = regime * separations + k;
            self.regime_count[place] = sum.count;
            self.regime_adhesion_force[place] = sum.adhesion.value();
            self.regime_external_force[place] = sum.contact.value() - sum.adhesion.value();
        }
        for (curve, value) in self.total.iter_mut().zip(sums.total()) {
            curve[k] = value;
        }
    }
}
