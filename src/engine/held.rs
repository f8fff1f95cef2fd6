//! Surfaces whose heights are all held at once.

use super::force_table::ForceTable;
use super::job::Job;
use super::kinks::{Kink, Kinks, rounding, widest_spacing};
use super::moments::{MomentMatrix, MomentSums};
use super::polydisperse::{Asperities, LaneSums, PulledBack};
use super::radii::{Places, PolydisperseCurve, Way};
use super::retraction::{Pulled, Retracted};
use super::search::{Curve, NODES, Passing, Sought, Stray};
use super::stray_table::StrayTable;
use super::summed::{Summed, of_highest};
use super::sums::{State, Sums};
use crate::asperity::Loop;
use crate::math::extrema::Extremum;

/// A surface that has been summed.
pub(super) struct HeldSurface<'a> {
    pub job: &'a Job<'a>,
    /// Heights, m, rising unless they are summed by moments or radii differ.
    pub heights: &'a [f64],
    /// The asperities where radii differ, and memory for their sums.
    pub asperities: Option<(&'a Asperities, &'a mut LaneSums)>,
    /// These asperities as they were pulled back last.
    pub pulled: &'a mut Option<PulledBack>,
    /// The kinks of the law.
    pub kinks: &'a Kinks,
    pub table: &'a mut ForceTable,
    /// The highest of the heights, m; NaN of none.
    pub highest: f64,
    pub sums: &'a mut Sums,
    /// The kinks of its asperities where radii differ, when they have been asked for: on approach, and on retraction from a
    /// separation h, m.
    pub places: Option<Places>,
    pub places_back: Option<(f64, Places)>,
    /// The moments of the surface, if it was summed by them.
    pub moments: Option<OfLane<'a>>,
}

/// The lane of a surface that was summed by moments.
pub(super) struct OfLane<'a> {
    pub matrix: &'a MomentMatrix,
    pub sums: &'a mut MomentSums,
    pub lane: usize,
}

impl Summed for HeldSurface<'_> {
    fn highest(&self) -> f64 {
        self.highest
    }

    fn pull_off(&mut self, external: &[f64]) -> Extremum {
        self.find(Sought::PullOff, &self.job.samples(external))
    }

    fn contacts(&mut self, cycle: &Loop) -> (f64, f64) {
        let (job, closest) = (self.job, self.job.separations[0]);
        if self.asperities.is_none() {
            return of_highest(job, cycle, self.highest);
        }
        self.turn(cycle, closest);
        let touchdown = self.asperities.as_ref().map_or(f64::NAN, |(all, _)| all.touchdown(cycle));
        let detachment = self.pulled.as_ref().map_or(f64::NAN, |pulled| pulled.detachment(cycle));
        let touchdown = if touchdown.is_finite() { touchdown } else { f64::NAN };
        (touchdown + job.surface.mean_plane_offset, detachment)
    }

    fn retraction(&mut self, from: f64, separations: &[f64]) -> Vec<f64> {
        if let (Some(cycle), Some(_)) = (self.job.protocol.cycle, &self.asperities) {
            self.turn(cycle, from);
            let (Some((_, lane_sums)), Some(pulled)) = (&mut self.asperities, &*self.pulled) else {
                unreachable!("they have been turned")
            };
            let (surface, stats) = (self.job.surface, &mut self.sums.stats);
            let force = |to: &f64| {
                let d = surface.asperity_separation(*to);
                surface.external_force_back(*to, pulled.external_force(cycle, None, d, lane_sums, stats))
            };
            return separations.iter().map(force).collect();
        }
        let force =
            |&to: &f64| self.sums.external_force(self.job, self.heights, State::Retraction { from, to });
        separations.iter().map(force).collect()
    }

    fn retraction_pull_off(&mut self, from: f64, samples: &[(f64, f64)]) -> Extremum {
        self.find_on_retraction(Sought::PullOff, from, samples)
    }

    fn stiffest(&mut self, from: Option<f64>, samples: &[(f64, f64)], span: f64) -> Extremum {
        match from {
            Some(from) => self.find_on_retraction(Sought::Stiffness(span), from, samples),
            None => self.find(Sought::Stiffness(span), samples),
        }
    }
}

impl HeldSurface<'_> {
    /// Finds what is sought on the way of the job from samples of it: separations h, m, rising, and external
    /// forces, N.
    fn find(&mut self, sought: Sought, samples: &[(f64, f64)]) -> Extremum {
        let (job, highest) = (self.job, self.highest);
        let (kinks, spacing) = (self.kinks.approach.as_slice(), widest_spacing(job));
        if let Some((asperities, lane_sums)) = &mut self.asperities {
            let way = Way::Approach;
            let places = self.places.get_or_insert_with(|| Places::new(job, asperities, way));
            let stats = &mut self.sums.stats;
            let known = (self.kinks, &*places);
            let mut surface = PolydisperseCurve::new(job, known, (asperities, way), lane_sums, stats);
            return sought.find(&mut surface, samples, spacing);
        }
        match &mut self.moments {
            Some(moments) => {
                let heights = ByMoments { job, moments, sums: self.sums };
                let (strays, table) = (&self.kinks.strays, &mut *self.table);
                sought.find(&mut OfHeights { job, kinks, strays, highest, table, heights }, samples, spacing)
            }
            None => self.find_sorted(sought, samples),
        }
    }

    /// Finds what is sought on retraction from the separation `from`, m.
    fn find_on_retraction(&mut self, sought: Sought, from: f64, samples: &[(f64, f64)]) -> Extremum {
        let Self { job, heights, .. } = *self;
        let Some(cycle) = job.protocol.cycle else { return self.find_sorted(sought, samples) };
        if self.asperities.is_some() {
            return self.find_pulled(sought, (cycle, from), samples);
        }
        let pulled = Pulled { job, cycle, heights, from };
        let mut surface = Retracted::new(pulled, &self.kinks.retraction, self.sums);
        sought.find(&mut surface, samples, widest_spacing(job))
    }

    /// Turns asperities that differ in their radii at the separation `from`, m, if they have not last.
    fn turn(&mut self, cycle: &Loop, from: f64) {
        let (Some((asperities, _)), pulled) = (&self.asperities, &mut *self.pulled) else { return };
        if pulled.as_ref().is_none_or(|pulled| pulled.from != from) {
            *pulled = Some(asperities.turn(self.job, cycle, from, &mut self.sums.stats));
        }
    }

    /// Finds what is sought on retraction of asperities that differ in their radii.
    fn find_pulled(
        &mut self,
        sought: Sought,
        (cycle, from): (&Loop, f64),
        samples: &[(f64, f64)],
    ) -> Extremum {
        self.turn(cycle, from);
        let (job, spacing) = (self.job, widest_spacing(self.job));
        let (Some((asperities, lane_sums)), Some(pulled)) = (&mut self.asperities, &*self.pulled) else {
            unreachable!("they have been turned")
        };
        let way = Way::Retraction(cycle, pulled);
        if self.places_back.as_ref().is_none_or(|(of, _)| *of != from) {
            self.places_back = Some((from, Places::new(job, asperities, way)));
        }
        let (_, places) = self.places_back.as_ref().expect("it was found");
        let (known, stats) = ((self.kinks, places), &mut self.sums.stats);
        let mut surface = PolydisperseCurve::new(job, known, (asperities, way), lane_sums, stats);
        sought.find(&mut surface, samples, spacing)
    }

    /// Finds what is sought where nothing but heights counts, which rise.
    fn find_sorted(&mut self, sought: Sought, samples: &[(f64, f64)]) -> Extremum {
        let Self { job, heights, highest, .. } = *self;
        let heights = Sorted { job, heights, sums: self.sums };
        let Kinks { approach, strays, .. } = self.kinks;
        let mut surface = OfHeights { job, kinks: approach, strays, highest, table: self.table, heights };
        sought.find(&mut surface, samples, widest_spacing(job))
    }
}

/// Heights that are held.
trait Heights {
    /// The heights in `low..high`, m, rising.
    fn between(&self, low: f64, high: f64) -> Vec<f64>;

    /// The number of heights in `low..high`, m, at least.
    fn count(&self, low: f64, high: f64) -> usize;

    /// External force of all, N, at a separation h, m, solved.
    fn external_force(&mut self, separation: f64) -> f64;

    /// Memory to sum a few of them.
    fn sums(&mut self) -> &mut Sums;
}

/// The curve of heights that obey one law.
struct OfHeights<'a, T> {
    job: &'a Job<'a>,
    /// The highest of the heights, m.
    highest: f64,
    kinks: &'a [Kink],
    strays: &'a StrayTable,
    table: &'a mut ForceTable,
    heights: T,
}

impl<T: Heights> Curve for OfHeights<'_, T> {
    type Asperity = f64;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        separations.iter().map(|&h| self.heights.external_force(h)).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<f64> {
        let [low, high] = [low, high].map(|h| self.job.surface.asperity_separation(h));
        let mut found = Vec::new();
        let mut reached = f64::NEG_INFINITY;
        for Kink { interference, .. } in self.kinks {
            let (begin, end) = ((low + interference).max(reached), high + interference);
            if begin < end {
                found.append(&mut self.heights.between(begin, end));
                reached = end;
            }
        }
        found
    }

    fn passings(&mut self, heights: &[f64], low: f64, high: f64, passings: &mut Vec<Passing>) {
        let offset = self.job.surface.mean_plane_offset;
        for (kink, of) in self.kinks.iter().enumerate().rev() {
            let kink = kink as u32;
            let place = |height: f64| height - of.interference + offset;
            let first = heights.partition_point(|height| place(*height) < low);
            let passing = |(asperity, height): (u32, &f64)| Passing {
                place: place(*height),
                step: -of.jump,
                kink,
                asperity,
            };
            let all = (first as u32..).zip(&heights[first..]).map(passing);
            passings.extend(all.take_while(|passing| passing.place <= high));
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.kinks[kink as usize].stray
    }

    fn rounding(&self) -> f64 {
        rounding(self.job, self.highest)
    }

    fn add(&mut self, heights: &[f64], separations: &[f64], sums: &mut [f64]) {
        for (separation, sum) in separations.iter().zip(sums) {
            let d = self.job.surface.asperity_separation(*separation);
            *sum += self.table.sum(self.job.laws.typical, heights, d, self.heights.sums());
        }
    }

    fn strays(&self, heights: &[f64], third: f64, sums: &mut [f64; NODES]) -> bool {
        self.strays.add(heights, self.job.surface.asperity_separation(third), sums);
        true
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        let [low, high] = [low, high].map(|h| self.job.surface.asperity_separation(h));
        for kink in self.kinks.iter().filter(|kink| kink.fall > 0.0) {
            visit(kink.fall, self.heights.count(low + kink.interference, high + kink.interference));
        }
    }
}

/// A surface that is summed asperity by asperity.
struct Sorted<'a> {
    job: &'a Job<'a>,
    /// Rising, m.
    heights: &'a [f64],
    sums: &'a mut Sums,
}

impl Heights for Sorted<'_> {
    fn between(&self, low: f64, high: f64) -> Vec<f64> {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        self.heights[low..high].to_vec()
    }

    fn count(&self, low: f64, high: f64) -> usize {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        high - low
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        self.sums.external_force(self.job, self.heights, State::Approach(separation))
    }

    fn sums(&mut self) -> &mut Sums {
        self.sums
    }
}

/// A surface that is summed by moments.
struct ByMoments<'a, 'm> {
    job: &'a Job<'a>,
    moments: &'a mut OfLane<'m>,
    sums: &'a mut Sums,
}

impl Heights for ByMoments<'_, '_> {
    fn between(&self, low: f64, high: f64) -> Vec<f64> {
        let OfLane { matrix, sums, lane } = &*self.moments;
        sums.surface(*lane).map(|binned| binned.between(matrix, low, high)).unwrap_or_default()
    }

    fn count(&self, low: f64, high: f64) -> usize {
        let OfLane { matrix, sums, lane } = &*self.moments;
        sums.surface(*lane).map_or(0, |binned| binned.count(matrix, low, high))
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        let (OfLane { matrix, sums, lane }, law) = (&mut *self.moments, self.job.laws.typical);
        let force = sums.external_force(matrix, law, *lane, d, &mut self.sums.stats);
        self.job.surface.external_force(separation, force)
    }

    fn sums(&mut self) -> &mut Sums {
        self.sums
    }
}
