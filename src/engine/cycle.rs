//! The way back of one surface, and what is kept of a surface that is brought close and pulled back.

use super::instability::{Holding, Snap, Turn, largest_snap, reached};
use super::pull_off::deepest_of_parts;
use super::replica::Summed;
use super::{Job, Protocol};
use crate::asperity::Loop;
use crate::math::extrema::Extremum;
use crate::math::words::Words;

/// What is kept of a replica whose way back is another than its way there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// −min F on the way there, between the separations too, N.
    pub approach_pull_off_force: f64,
    /// Separation h there, m.
    pub approach_pull_off_separation: f64,
    /// ∫F dh of the way there less that of the way back, J, with F in straight lines between the separations.
    pub dissipated_energy: f64,
    /// Separation h at which the highest asperity touches on the way there, m, wherever the separations are; NaN of no asperities.
    pub touchdown_separation: f64,
    /// Separation h at which the last contact is lost on the way back, m; NaN if there was none.
    pub takeoff_separation: f64,
}

impl Cycle {
    /// Of a surface: its highest asperity, m, NaN of none, its external force (N) of both ways over the separations of the job, and the
    /// pull-off on the way there.
    pub(super) fn new(job: &Job<'_>, cycle: &Loop, highest: f64, external: [&[f64]; 2], pull_off: &Extremum) -> Self {
        let (surface, closest) = (job.surface, job.separations[0]);
        let d = surface.asperity_separation(closest);
        // The higher an asperity, the longer it keeps contact.
        let takeoff = cycle.takeoff(highest - d);
        Self {
            approach_pull_off_force: -pull_off.value,
            approach_pull_off_separation: pull_off.place,
            dissipated_energy: area_between(job.separations, external),
            touchdown_separation: highest - cycle.touch() + surface.mean_plane_offset,
            takeoff_separation: takeoff.map_or(f64::NAN, |distance| closest + distance),
        }
    }
}

impl Words for Cycle {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        self.approach_pull_off_force.each_word(visit);
        self.approach_pull_off_separation.each_word(visit);
        self.dissipated_energy.each_word(visit);
        self.touchdown_separation.each_word(visit);
        self.takeoff_separation.each_word(visit);
    }
}

/// The integral of the first of two curves less the second over rising places, by the trapezoidal rule.
pub fn area_between(places: &[f64], [first, second]: [&[f64]; 2]) -> f64 {
    let difference = |k: usize| first[k] - second[k];
    let strip = |k: usize| 0.5 * (places[k + 1] - places[k]) * (difference(k) + difference(k + 1));
    (0..places.len() - 1).map(strip).sum()
}

/// The pull-off on the way back from a separation h, m, from its samples: separations h, m, rising, and external forces, N.
pub(super) fn pull_off_back(surface: &mut dyn Summed, from: f64, samples: &[(f64, f64)]) -> Extremum {
    deepest_of_parts(samples, |places| surface.back(from, places))
}

/// The snaps of a surface, in the order of [`Holding::length`], from its curve over the separations of the job on the way there, N, and the
/// one on which it is pulled off, with its pull-off.
pub(super) fn snaps(
    job: &Job<'_>,
    surface: &mut dyn Summed,
    there: &[f64],
    (last, pull_off): (&[f64], Extremum),
) -> Vec<f64> {
    let Protocol { cycle, holding, .. } = job.protocol;
    let mut numbers = Vec::with_capacity(holding.length());
    if holding.ways.0 {
        let inward: Vec<(f64, f64)> = job.samples(there).into_iter().rev().collect();
        numbers.extend(of_stiffnesses(&holding, &inward));
    }
    if cycle.is_some() && !holding.preload.is_empty() {
        for &preload in holding.preload {
            numbers.extend(after_preload(job, surface, there, preload));
        }
    } else if holding.ways.1 {
        numbers.extend(turn(job.separations[0], &pull_off).numbers());
        numbers.extend(of_stiffnesses(&holding, &job.samples(last)));
    }
    numbers
}

/// The largest snap on a way for each stiffness.
fn of_stiffnesses(holding: &Holding<'_>, samples: &[(f64, f64)]) -> Vec<f64> {
    let snap = |&stiffness: &f64| largest_snap(samples, stiffness, holding.smallest_snap).numbers();
    holding.stiffness.iter().flat_map(snap).collect()
}

fn turn(separation: f64, pull_off: &Extremum) -> Turn {
    Turn { separation, pull_off_force: -pull_off.value, pull_off_separation: pull_off.place }
}

/// The turn of a surface at a preload, N, and its snaps on the way back from there.
fn after_preload(job: &Job<'_>, surface: &mut dyn Summed, there: &[f64], preload: f64) -> Vec<f64> {
    let holding = &job.protocol.holding;
    let Some((nearer, from)) = reached(job.separations, there, preload) else {
        let snaps = holding.stiffness.iter().flat_map(|_| Snap::UNKNOWN.numbers());
        return Turn::UNKNOWN.numbers().into_iter().chain(snaps).collect();
    };
    let further = job.separations[nearer + 1..].iter().copied().filter(|h| *h > from);
    let places: Vec<f64> = [from].into_iter().chain(further).collect();
    let forces = surface.back(from, &places);
    let outward: Vec<(f64, f64)> = places.into_iter().zip(forces).collect();
    let turn = turn(from, &pull_off_back(surface, from, &outward));
    turn.numbers().into_iter().chain(of_stiffnesses(holding, &outward)).collect()
}
