//! The curve of a surface of asperities that differ in their radii, each with a law, and so with kinks, of
//! its own.

use super::Job;
use super::kinks::{Kink, beside, rounding};
use super::polydisperse::{Asperities, LaneSums, Pair, Pairs};
use super::search::{Curve, Passing, Stray};
use crate::asperity::SolverStats;

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
    /// The places of each kink, rising, when they have been asked for.
    sorted: Vec<Vec<f64>>,
    sums: &'a mut LaneSums,
    pairs: Pairs,
    stats: &'a mut SolverStats,
}

impl<'a> PolydisperseCurve<'a> {
    /// The asperities of a job, with their kinks and these of the typical one.
    pub fn new(
        job: &'a Job<'a>,
        (typical, places): (&[Kink], &'a Places),
        asperities: &'a Asperities,
        sums: &'a mut LaneSums,
        stats: &'a mut SolverStats,
    ) -> Self {
        let mut last = Stray::default();
        let unlike = |kink: &Kink| {
            // Kinks that are one to the typical asperity may be two to another.
            let samples = if kink.stray.samples.0 > 0.0 { kink.stray.samples } else { last.samples };
            last = Stray { samples, ..kink.stray };
            Kink { fall: UNLIKE * kink.fall, stray: last.times(UNLIKE), ..*kink }
        };
        let typical = typical.iter().map(unlike).collect();
        Self { job, typical, asperities, places, sorted: Vec::new(), sums, pairs: Pairs::default(), stats }
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

    fn external_force(&mut self, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        self.asperities.external_force(None, d, self.sums, self.stats)
    }
}

impl Curve for PolydisperseCurve<'_> {
    type Asperity = u32;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        separations.iter().map(|h| self.external_force(*h)).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<u32> {
        let is_near = |asperity: &u32| self.kinks(*asperity).any(|(place, _)| place >= low && place <= high);
        (0..self.asperities.heights.len() as u32).filter(is_near).collect()
    }

    fn passings(&mut self, asperities: &[u32], low: f64, high: f64, passings: &mut Vec<Passing>) {
        let first = passings.len();
        for (i, asperity) in asperities.iter().enumerate() {
            let near = self.kinks(*asperity).filter(|(place, _)| *place >= low && *place <= high);
            let passing = |(place, kink)| Passing { place, step: 0.0, kink: kink as u32, asperity: i as u32 };
            passings.extend(near.map(passing));
        }
        let (heights, offset) = (&self.asperities.heights, self.job.surface.mean_plane_offset);
        let sides = passings[first..].iter().enumerate().flat_map(|(k, passing)| {
            let asperity = asperities[passing.asperity as usize];
            let height = heights[asperity as usize];
            beside(height + offset - passing.place).into_iter().enumerate().map(
                move |(side, interference)| Pair {
                    asperity,
                    separation: height - interference,
                    sum: (2 * k + side) as u32,
                },
            )
        });
        let mut forces = vec![0.0; 2 * (passings.len() - first)];
        self.pairs.add(self.asperities, sides, self.stats, &mut forces);
        for (passing, sides) in passings[first..].iter_mut().zip(forces.chunks(2)) {
            passing.step = sides[0] - sides[1];
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.typical[kink as usize].stray
    }

    fn rounding(&self) -> f64 {
        rounding(self.job, self.asperities.heights.iter().fold(0.0, |most: f64, u| most.max(u.abs())))
    }

    fn add(&mut self, asperities: &[u32], separations: &[f64], sums: &mut [f64]) {
        let surface = self.job.surface;
        let pairs = separations.iter().enumerate().flat_map(|(sum, separation)| {
            let separation = surface.asperity_separation(*separation);
            asperities.iter().map(move |asperity| Pair { asperity: *asperity, separation, sum: sum as u32 })
        });
        self.pairs.add(self.asperities, pairs, self.stats, sums);
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        if self.sorted.is_empty() {
            self.sorted = vec![Vec::new(); self.typical.len()];
            for asperity in 0..self.asperities.heights.len() as u32 {
                let kinks: Vec<(f64, usize)> = self.kinks(asperity).collect();
                kinks.into_iter().for_each(|(place, kink)| self.sorted[kink].push(place));
            }
            self.sorted.iter_mut().for_each(|places| places.sort_unstable_by(f64::total_cmp));
        }
        let count = |places: &Vec<f64>| {
            let first = places.partition_point(|place| *place < low);
            places.partition_point(|place| *place <= high).saturating_sub(first)
        };
        let counts: Vec<usize> = self.sorted.iter().map(count).collect();
        let kinks = self.typical.iter().zip(counts);
        kinks
            .filter(|(kink, count)| kink.fall > 0.0 && *count > 0)
            .for_each(|(kink, count)| visit(kink.fall, count));
    }
}
