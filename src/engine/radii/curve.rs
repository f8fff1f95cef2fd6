//! The curve of a surface of asperities that differ in their radii, each with a law, and so with kinks, of
//! its own.

use super::asperities::{Asperities, LaneSums, OnBranch};
use super::pairs::{Pair, Pairs};
use crate::engine::job::Job;
use crate::engine::kinks::{KINKS, Kink, Kinks, beside, rounding};
use crate::engine::search::{Curve, Passing, Stray};
use crate::surface::Surface;

/// Largest ratio of the stray and the fall of a kink of another asperity to the typical asperity's.
const UNLIKE: f64 = 2.0;
/// Roundings of a recovery and of its inverse, in roundings of a height.
const ROUNDINGS: f64 = 32.0;

/// Separations h, m, of the kinks of asperities, asperity after asperity, and the end of each asperity's.
#[derive(Debug)]
pub struct Places {
    places: Vec<f64>,
    ends: Vec<u32>,
}

impl Places {
    /// The places of `count` asperities of a job.
    pub fn new(job: &Job<'_>, count: usize, branch: OnBranch<'_>) -> Self {
        let (mut places, mut ends) = (Vec::new(), Vec::with_capacity(count));
        for asperity in 0..count {
            places.extend(branch.kinks(asperity));
            ends.push(places.len() as u32);
        }
        places.iter_mut().for_each(|place| *place += job.surface.mean_plane_offset);
        Self { places, ends }
    }

    /// The places of an asperity, falling.
    fn of(&self, asperity: u32) -> &[f64] {
        let asperity = asperity as usize;
        let first = if asperity == 0 { 0 } else { self.ends[asperity - 1] as usize };
        &self.places[first..self.ends[asperity] as usize]
    }
}

/// The external force of a surface over the separation on a branch.
pub struct ForceCurve<'a> {
    job: &'a Job<'a>,
    /// The kinks of the typical asperity, by its history.
    typical: Vec<Vec<Kink>>,
    asperities: &'a Asperities,
    branch: OnBranch<'a>,
    places: &'a Places,
    /// The places of each kink, rising, when they have been asked for.
    sorted: Vec<Vec<f64>>,
    sums: &'a mut LaneSums,
    pairs: Pairs,
}

impl<'a> ForceCurve<'a> {
    /// The asperities of a job on a branch, with their kinks and these of the typical one.
    pub fn new(
        job: &'a Job<'a>,
        (typical, places): (&Kinks, &'a Places),
        (asperities, branch): (&'a Asperities, OnBranch<'a>),
        sums: &'a mut LaneSums,
    ) -> Self {
        let unlike = |kinks: &Vec<Kink>| {
            let mut last = Stray::default();
            let unlike = |kink: &Kink| {
                // Kinks that are one to the typical asperity may be two to another.
                let samples = if kink.stray.samples.0 > 0.0 { kink.stray.samples } else { last.samples };
                last = Stray { samples, ..kink.stray };
                Kink { fall: UNLIKE * kink.fall, stray: last.times(UNLIKE), ..*kink }
            };
            kinks.iter().map(unlike).collect()
        };
        let typical = match branch {
            OnBranch::Approach(_) => vec![unlike(&typical.approach)],
            OnBranch::Reversed(..) => typical.retraction.iter().map(unlike).collect(),
        };
        Self { job, typical, asperities, branch, places, sorted: Vec::new(), sums, pairs: Pairs::default() }
    }

    /// The history of an asperity, as an index of typical kinks.
    fn history(&self, asperity: u32) -> usize {
        match self.branch {
            OnBranch::Approach(_) => 0,
            OnBranch::Reversed(_, reversed) => reversed.history(asperity as usize) as usize,
        }
    }

    /// The kinks of an asperity: separations h, m, falling, each with the number of the corresponding kink of the typical
    /// asperity. They correspond from the last on: an asperity may have more or fewer at first.
    fn kinks(&self, asperity: u32) -> impl Iterator<Item = (f64, usize)> + use<'_> {
        let (places, history) = (self.places.of(asperity), self.history(asperity));
        let typical = self.typical[history].len();
        let like = move |i: usize| (i + typical).saturating_sub(places.len()).min(typical - 1);
        places.iter().enumerate().map(move |(i, place)| (*place, history * KINKS + like(i)))
    }

    /// The kink of the typical asperity by its number.
    fn typical(&self, kink: usize) -> &Kink {
        &self.typical[kink / KINKS][kink % KINKS]
    }

    fn external_force(&mut self, which: Option<&[u32]>, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        self.branch.external_force(which, d, self.sums)
    }

    /// The steps of the curve, as the separation grows, at the places of passings of some asperities on approach.
    fn steps(&mut self, asperities: &[u32], passings: &mut [Passing]) {
        let (heights, offset) = (&self.asperities.heights, self.job.surface.mean_plane_offset);
        let sides = passings.iter().enumerate().flat_map(|(k, passing)| {
            let asperity = asperities[passing.asperity as usize];
            let height = heights[asperity as usize];
            let pair = move |(side, interference)| Pair {
                asperity,
                separation: height - interference,
                sum: (2 * k + side) as u32,
            };
            beside(height + offset - passing.place).into_iter().enumerate().map(pair)
        });
        let mut forces = vec![0.0; 2 * passings.len()];
        self.pairs.add(self.asperities, sides, &mut self.sums.stats, &mut forces);
        for (passing, sides) in passings.iter_mut().zip(forces.chunks(2)) {
            passing.step = sides[0] - sides[1];
        }
    }

    /// The steps of the curve at the places of passings of some asperities on retraction.
    fn steps_back(&mut self, asperities: &[u32], passings: &mut [Passing]) {
        let beside = self.rounding();
        for passing in passings {
            let own = [asperities[passing.asperity as usize]];
            let [below, above] =
                [passing.place - beside, passing.place + beside].map(|h| self.external_force(Some(&own), h));
            passing.step = above - below;
        }
    }
}

impl Curve for ForceCurve<'_> {
    type Asperity = u32;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        let surface = self.job.surface;
        let all = |force: fn(&Surface, f64, f64) -> f64, curve: &mut Self| {
            separations.iter().map(|h| force(surface, *h, curve.external_force(None, *h))).collect()
        };
        match self.branch {
            OnBranch::Approach(_) => all(Surface::external_force, self),
            OnBranch::Reversed(..) => all(Surface::external_force_back, self),
        }
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
        match self.branch {
            OnBranch::Approach(_) => self.steps(asperities, &mut passings[first..]),
            OnBranch::Reversed(..) => self.steps_back(asperities, &mut passings[first..]),
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.typical(kink as usize).stray
    }

    fn rounding(&self) -> f64 {
        let highest = self.asperities.heights.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let roundings = match self.branch {
            OnBranch::Approach(_) => 1.0,
            // A recovery is found by powers.
            OnBranch::Reversed(..) => ROUNDINGS,
        };
        roundings * rounding(self.job, highest)
    }

    fn add(&mut self, asperities: &[u32], separations: &[f64], sums: &mut [f64]) {
        if let OnBranch::Reversed(..) = self.branch {
            for (separation, sum) in separations.iter().zip(sums) {
                *sum += self.external_force(Some(asperities), *separation);
            }
            return;
        }
        let surface = self.job.surface;
        let pairs = separations.iter().enumerate().flat_map(|(sum, separation)| {
            let separation = surface.asperity_separation(*separation);
            asperities.iter().map(move |asperity| Pair { asperity: *asperity, separation, sum: sum as u32 })
        });
        self.pairs.add(self.asperities, pairs, &mut self.sums.stats, sums);
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        if self.sorted.is_empty() {
            self.sorted = vec![Vec::new(); KINKS * self.typical.len()];
            for asperity in 0..self.asperities.heights.len() as u32 {
                let kinks: Vec<(f64, usize)> = self.kinks(asperity).collect();
                kinks.into_iter().for_each(|(place, kink)| self.sorted[kink].push(place));
            }
            self.sorted.iter_mut().for_each(|places| places.sort_unstable_by(f64::total_cmp));
        }
        for (kink, places) in self.sorted.iter().enumerate().filter(|(_, places)| !places.is_empty()) {
            let first = places.partition_point(|place| *place < low);
            let count = places.partition_point(|place| *place <= high).saturating_sub(first);
            let fall = self.typical(kink).fall;
            if fall > 0.0 && count > 0 {
                visit(fall, count);
            }
        }
    }
}
