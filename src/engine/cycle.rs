//! The retraction of one surface, and the record of a surface that is brought close and pulled back.

use super::curves::Curves;
use super::instability::{Loading, Snap, Turn, largest_snap, largest_snap_of_all, reached};
use super::job::{Job, Protocol, Ways};
use super::summed::Summed;
use crate::asperity::Quantity;
use crate::math::extrema::Extremum;
use crate::math::sums::SUM_ROUNDING;
use serde::{Deserialize, Serialize};

/// The record of a replica whose retraction is another than its approach.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, model};
/// use stiction::engine::{Cycle, Job, Protocol};
/// use stiction::surface::Surface;
///
/// // Hertz's contact has no hysteresis, so nothing is lost.
/// let parameters = LawParameters::scaled(1.0, Path::Approach)?;
/// let cycle = Loop::new(&model("hertz").unwrap(), &parameters)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let protocol = Protocol { cycle: Some(&cycle), ..Protocol::default() };
/// let job = Job { protocol, ..Job::new(cycle.approach(), &surface, &[0.0, 1.0, 2.0], 8, 1) };
/// let lost = |cycle: &Cycle| cycle.dissipated_energy;
/// assert!(job.ensemble().replicas.iter().all(|replica| lost(replica.cycle.as_ref().unwrap()) == 0.0));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// −min F on approach, between the separations too, N.
    pub approach_pull_off_force: f64,
    /// Separation h there, m.
    pub approach_pull_off_separation: f64,
    /// ∫F dh of the approach less that of the retraction, J, with F in straight lines between the
    /// separations; 0 where it is below its rounding.
    pub dissipated_energy: f64,
    /// Dissipated energy of each further cycle to the same depth, J; none where there is one cycle.
    pub repeated_dissipated_energy: Option<f64>,
    /// Separation h at which the first asperity touches on approach, m, wherever the separations are;
    /// NaN of no asperities.
    pub touchdown_separation: f64,
    /// Separation h at which the last contact is lost on retraction, m; NaN if there was none.
    pub detachment_separation: f64,
}

impl Cycle {
    /// The record of a surface: its highest asperity, m, NaN of none, where its first and last contacts are, h in m, its
    /// curves over the states of the job, and the pull-off on approach.
    pub(super) fn new(
        job: &Job<'_>,
        highest: f64,
        (touchdown_separation, detachment_separation): (f64, f64),
        curves: &Curves,
        pull_off: &Extremum,
    ) -> Self {
        let s = job.separations.len();
        let quantities = [Quantity::AdhesionForce, Quantity::ContactForce];
        let way =
            |way: usize| quantities.map(|quantity| &curves.total[quantity.index()][way * s..(way + 1) * s]);
        let lost = |inward| dissipated(job.separations, [way(inward), way(1)], SUM_ROUNDING, highest);
        Self {
            approach_pull_off_force: -pull_off.value,
            approach_pull_off_separation: pull_off.place,
            dissipated_energy: lost(0),
            repeated_dissipated_energy: (job.ways() == Ways::Repeated).then(|| lost(2)),
            touchdown_separation,
            detachment_separation,
        }
    }
}

/// ∫F dh of the approach less that of the retraction, J, by the trapezoidal rule, from F_s and P of both, N,
/// over rising separations, m; 0 where it is below its rounding. `error` is that of F_s and P, relative;
/// `highest`, m, is the highest asperity.
///
/// The interference of an asperity takes at most 8 roundings of lengths within |h| + |u| on either way, and
/// moves the forces along their curves by as much.
pub fn dissipated(separations: &[f64], ways: [[&[f64]; 2]; 2], error: f64, highest: f64) -> f64 {
    let [approach, retraction] = ways;
    let difference = |k: usize| (approach[1][k] - approach[0][k]) - (retraction[1][k] - retraction[0][k]);
    let magnitude = |k: usize| approach[0][k] + approach[1][k] + retraction[0][k] + retraction[1][k];
    let (first, last) = (separations[0], separations[separations.len() - 1]);
    let offset = 4.0 * f64::EPSILON * (first.abs().max(last.abs()) + highest.abs());
    let (mut energy, mut rounding) = (0.0, 0.0);
    for k in 0..separations.len() - 1 {
        let half = 0.5 * (separations[k + 1] - separations[k]);
        energy += half * (difference(k) + difference(k + 1));
        rounding += error * half * (magnitude(k) + magnitude(k + 1));
        let moves = |force: &[f64]| (force[k + 1] - force[k]).abs();
        rounding += offset * ways.iter().flatten().map(|force| moves(force)).sum::<f64>();
    }
    if energy.abs() <= rounding { 0.0 } else { energy }
}

/// The snaps of a surface, in the order of [`Loading::length`], from its curve over the separations of the
/// job on approach, N, and the one on which it is pulled off, with its pull-off.
pub(super) fn snaps(
    job: &Job<'_>,
    surface: &mut dyn Summed,
    approach: &[f64],
    (last, pull_off): (&[f64], Extremum),
) -> Vec<f64> {
    let Protocol { cycle, loading, .. } = job.protocol;
    let mut numbers = Vec::with_capacity(loading.length());
    if loading.ways.0 {
        let inward: Vec<(f64, f64)> = job.samples(approach).into_iter().rev().collect();
        numbers.extend(of_stiffnesses(&loading, &inward, largest_snap_of_all));
    }
    if cycle.is_some() && !loading.preload.is_empty() {
        for &preload in loading.preload {
            numbers.extend(after_preload(job, surface, approach, preload));
        }
    } else if loading.ways.1 {
        numbers.extend(turn(job.separations[0], &pull_off).numbers());
        numbers.extend(of_stiffnesses(&loading, &job.samples(last), largest_snap_of_all));
    }
    numbers
}

/// The largest snap on a path for each stiffness, by `largest` of the samples, the stiffness and the smallest
/// snap.
fn of_stiffnesses(
    loading: &Loading<'_>,
    samples: &[(f64, f64)],
    largest: fn(&[(f64, f64)], f64, f64) -> Snap,
) -> Vec<f64> {
    let snap = |&stiffness: &f64| largest(samples, stiffness, loading.smallest_snap).numbers();
    loading.stiffness.iter().flat_map(snap).collect()
}

fn turn(separation: f64, pull_off: &Extremum) -> Turn {
    Turn { separation, pull_off_force: -pull_off.value, pull_off_separation: pull_off.place }
}

/// The turn of a surface at a preload, N, its snaps on retraction from there, and the forces that are kept.
fn after_preload(job: &Job<'_>, surface: &mut dyn Summed, approach: &[f64], preload: f64) -> Vec<f64> {
    let loading = &job.protocol.loading;
    let Some((nearer, from)) = reached(job.separations, approach, preload) else {
        let snaps = loading.stiffness.iter().flat_map(|_| Snap::UNKNOWN.numbers());
        let forces = std::iter::repeat_n(f64::NAN, loading.kept);
        return Turn::UNKNOWN.numbers().into_iter().chain(snaps).chain(forces).collect();
    };
    let further = job.separations[nearer + 1..].iter().copied().filter(|h| *h > from);
    let places: Vec<f64> = [from].into_iter().chain(further).collect();
    let forces = surface.retraction(from, &places);
    let outward: Vec<(f64, f64)> = places.into_iter().zip(forces).collect();
    let turn = turn(from, &surface.retraction_pull_off(from, &outward));
    let snaps = of_stiffnesses(loading, &outward, largest_snap);
    let nearer = std::iter::repeat_n(f64::NAN, (loading.kept + 1).saturating_sub(outward.len()));
    let forces = nearer.chain(outward[1..].iter().map(|(_, force)| *force)).take(loading.kept);
    turn.numbers().into_iter().chain(snaps).chain(forces).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{LawParameters, Loop, Path, model};
    use crate::surface::Surface;

    /// F_s = 1 N and P = 3 N over 2 nm on either way: 16e-9 J in all, of which SUM_ROUNDING is 7e-23 J. The
    /// places are off by up to 2e-23 m, which takes nothing where no force changes.
    #[test]
    fn what_is_below_its_rounding_is_nothing() {
        let (separations, adhesion, contact) = ([0.0, 1e-9, 2e-9], [1.0; 3], [3.0; 3]);
        let lost = |loss: f64| {
            let less = [3.0, 3.0 - loss, 3.0];
            dissipated(&separations, [[&adhesion, &contact], [&adhesion, &less]], SUM_ROUNDING, 1e-9)
        };
        for loss in [2e-13, 0.5, -2e-13] {
            assert!((lost(loss) / (loss * 1e-9) - 1.0).abs() < 1e-2, "{loss}: {:e}", lost(loss));
        }
        for loss in [0.0, 4e-14, -4e-14] {
            assert_eq!(lost(loss), 0.0, "{loss}");
        }
    }

    /// F of the approach less that of the retraction is 6, 2, 0 and −1 N at 0, 1, 3 and 7 nm: trapezoids of 4, 2 and
    /// −2 N nm, each alone, and 4e-9 J in all.
    #[test]
    fn every_interval_dissipates_its_trapezoid() {
        let (separations, none) = ([0.0, 1e-9, 3e-9, 7e-9], [0.0; 4]);
        let (approach, retraction) = ([6.0, 3.0, 1.0, 0.0], [0.0, 1.0, 1.0, 1.0]);
        let lost = |from: usize, to: usize| {
            let way = |contact| [&none[from..to], contact];
            let ways = [way(&approach[from..to]), way(&retraction[from..to])];
            dissipated(&separations[from..to], ways, SUM_ROUNDING, 1e-9)
        };
        for (from, to, energy) in [(0, 2, 4e-9), (1, 3, 2e-9), (2, 4, -2e-9), (0, 4, 4e-9)] {
            assert!((lost(from, to) / energy - 1.0).abs() < 1e-14, "{from} {to}: {:e}", lost(from, to));
        }
    }

    /// A surface whose force on the way back is the separation less ten, from wherever it turns.
    struct Line {
        /// The separations that were asked for, from each turn.
        asked: Vec<Vec<f64>>,
    }

    impl Summed for Line {
        fn highest(&self) -> f64 {
            f64::NAN
        }

        fn contacts(&mut self, _: &Loop) -> (f64, f64) {
            (f64::NAN, f64::NAN)
        }

        fn pull_off(&mut self, _: &[f64]) -> Extremum {
            unreachable!("it is that of the retraction")
        }

        fn retraction(&mut self, _: f64, separations: &[f64]) -> Vec<f64> {
            self.asked.push(separations.to_vec());
            separations.iter().map(|h| h - 10.0).collect()
        }

        fn retraction_pull_off(&mut self, _: f64, samples: &[(f64, f64)]) -> Extremum {
            Extremum { value: samples[0].1, place: samples[0].0, at_edge: true }
        }

        fn stiffest(&mut self, _: Option<f64>, _: &[(f64, f64)], _: f64) -> Extremum {
            unreachable!("nobody asks for it")
        }
    }

    /// F falls from 5 N at h = 0 to −1 at 3: 2 N are reached at h = 3/2, on the way back from which come 2, 3 and 4; 3 N
    /// are reached at 1 itself, which does not come again; 5 N at 0. Of separations before the turn no force is known.
    #[test]
    fn a_retraction_after_a_preload_goes_through_every_separation() {
        let parameters = LawParameters::scaled(1.0, Path::Approach).unwrap();
        let law = model("hertz").unwrap().law(&parameters).unwrap();
        let (surface, separations) = (Surface::uniform(1.0, 1.0, 1, 1.0), [0.0, 1.0, 2.0, 3.0, 4.0]);
        let loading = Loading { ways: (true, true), kept: 5, ..Loading::default() };
        let protocol = Protocol { loading, ..Protocol::default() };
        let job = Job { protocol, ..Job::new(law.as_ref(), &surface, &separations, 8, 1) };
        let mut line = Line { asked: Vec::new() };
        let mut numbers = |preload| after_preload(&job, &mut line, &[5.0, 3.0, 1.0, -1.0, 0.0], preload);
        let between = numbers(2.0);
        assert_eq!(between[..3], [1.5, 8.5, 1.5]);
        assert!(between[3].is_nan() && between[4].is_nan());
        assert_eq!(between[5..], [-8.0, -7.0, -6.0]);
        let at = numbers(3.0);
        assert_eq!((at[0], &at[5..]), (1.0, &[-8.0, -7.0, -6.0][..]));
        let innermost = numbers(5.0);
        assert_eq!((innermost[0], &innermost[4..]), (0.0, &[-9.0, -8.0, -7.0, -6.0][..]));
        assert!(numbers(6.0).len() == 8 && numbers(6.0).iter().all(|number| number.is_nan()));
        let expected: [&[f64]; 3] = [&[1.5, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 4.0], &separations];
        assert_eq!(line.asked, expected);
    }
}
