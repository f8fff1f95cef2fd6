//! The curve of a surface of asperities that differ in their radii, each with a law, and so with kinks, of
//! its own.

use super::Job;
use super::kinks::{Kink, beside, rounding};
use super::polydisperse::{Asperities, LaneSums};
use super::search::{Curve, Passing, Stray};
use crate::asperity::{Scratch, SolverStats};

/// How many times the stray and the fall of a kink of the typical asperity those of another may be.
const UNLIKE: f64 = 2.0;

/// Separations h, m, of the kinks of asperities, those of one after those of the other, and where those of
/// each end.
#[derive(Debug)]
pub(super) struct Places {
    places: Vec<f64>,
    ends: Vec<u32>,
}

impl Places {
    /// The places of asperities of a job.
    pub fn new(job: &Job<'_>, asperities: &Asperities) -> Self {
        let count = asperities.heights.len();
        let (mut places, mut ends) = (Vec::new(), Vec::with_capacity(count));
        for asperity in 0..count {
            places.extend(asperities.kinks(asperity).map(|d| d + job.surface.mean_plane_offset));
            ends.push(places.len() as u32);
        }
        Self { places, ends }
    }

    /// The places of an asperity, falling.
    fn of(&self, asperity: u32) -> &[f64] {
        let asperity = asperity as usize;
        let first = if asperity == 0 { 0 } else { self.ends[asperity - 1] as usize };
        &self.places[first..self.ends[asperity] as usize]
    }
}

/// A surface of which all asperities are held.
pub(super) struct PolydisperseCurve<'a> {
    job: &'a Job<'a>,
    /// The kinks of the typical asperity.
    typical: Vec<Kink>,
    asperities: &'a Asperities,
    places: &'a Places,
    sums: &'a mut LaneSums,
    scratch: &'a mut Scratch,
    stats: &'a mut SolverStats,
}

impl<'a> PolydisperseCurve<'a> {
    /// The asperities of a job, with their kinks and these of the typical one.
    pub fn new(
        job: &'a Job<'a>,
        (typical, places): (&[Kink], &'a Places),
        asperities: &'a Asperities,
        sums: &'a mut LaneSums,
        (scratch, stats): (&'a mut Scratch, &'a mut SolverStats),
    ) -> Self {
        let mut last = Stray::default();
        let unlike = |kink: &Kink| {
            // Kinks that are one to the typical asperity may be two to another.
            let samples = if kink.stray.samples.0 > 0.0 { kink.stray.samples } else { last.samples };
            last = Stray { samples, ..kink.stray };
            Kink { fall: UNLIKE * kink.fall, stray: last.times(UNLIKE), ..*kink }
        };
        let typical = typical.iter().map(unlike).collect();
        Self { job, typical, asperities, places, sums, scratch, stats }
    }

    /// The kinks of an asperity: separations h, m, falling, and the kink of the typical asperity that is like
    /// each. The last are alike, and what not all have comes first.
    fn kinks(&self, asperity: u32) -> impl Iterator<Item = (f64, usize)> + use<'_> {
        let (places, typical) = (self.places.of(asperity), self.typical.len());
        places
            .iter()
            .enumerate()
            .map(move |(i, place)| (*place, (i + typical).saturating_sub(places.len()).min(typical - 1)))
    }

    fn external_force(&mut self, which: Option<&[u32]>, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        self.asperities.external_force(which, d, self.sums, self.stats)
    }
}

impl Curve for PolydisperseCurve<'_> {
    type Asperity = u32;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        let surface = self.job.surface;
        separations.iter().map(|h| surface.external_force(*h, self.external_force(None, *h))).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<u32> {
        let is_near = |asperity: &u32| self.kinks(*asperity).any(|(place, _)| place >= low && place <= high);
        (0..self.asperities.heights.len() as u32).filter(is_near).collect()
    }

    fn passings(&mut self, asperities: &[u32], low: f64, high: f64, passings: &mut Vec<Passing>) {
        for (i, asperity) in asperities.iter().enumerate() {
            let height = self.asperities.heights[*asperity as usize] + self.job.surface.mean_plane_offset;
            let near: Vec<(f64, usize)> =
                self.kinks(*asperity).filter(|(place, _)| *place >= low && *place <= high).collect();
            for (place, kink) in near {
                let sides = beside(height - place);
                let force = self.asperities.forces(*asperity as usize, &sides, self.scratch, self.stats);
                passings.push(Passing {
                    place,
                    step: force[0] - force[1],
                    kink: kink as u32,
                    asperity: i as u32,
                });
            }
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.typical[kink as usize].stray
    }

    fn rounding(&self) -> f64 {
        rounding(self.job, self.asperities.heights.iter().fold(0.0, |most: f64, u| most.max(u.abs())))
    }

    fn add(&mut self, asperities: &[u32], separations: &[f64], sums: &mut [f64]) {
        for (separation, sum) in separations.iter().zip(sums) {
            *sum += self.external_force(Some(asperities), *separation);
        }
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        let mut counts = vec![0; self.typical.len()];
        for asperity in 0..self.asperities.heights.len() as u32 {
            let near = self.kinks(asperity).filter(|(place, _)| *place >= low && *place <= high);
            near.for_each(|(_, kink)| counts[kink] += 1);
        }
        let kinks = self.typical.iter().zip(counts);
        kinks
            .filter(|(kink, count)| kink.fall > 0.0 && *count > 0)
            .for_each(|(kink, count)| visit(kink.fall, count));
    }
}
