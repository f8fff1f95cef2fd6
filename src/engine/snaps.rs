//! The snaps of one surface, and its retractions after preloads.

use super::instability::{Loading, Snap, Turn, largest_snap, largest_snap_of_all, reached};
use super::job::{Job, Protocol};
use super::search::Sought;
use super::state::{Branch, Reversal};
use super::summed::Summed;
use crate::asperity::Loop;
use crate::math::extrema::Extremum;

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
    if let Some(cycle) = cycle.filter(|_| !loading.preload.is_empty()) {
        for &preload in loading.preload {
            numbers.extend(after_preload((job, cycle), surface, approach, preload));
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
fn after_preload(
    (job, cycle): (&Job<'_>, &Loop),
    surface: &mut dyn Summed,
    approach: &[f64],
    preload: f64,
) -> Vec<f64> {
    let loading = &job.protocol.loading;
    let Some((nearer, from)) = reached(job.separations, approach, preload) else {
        let snaps = loading.stiffness.iter().flat_map(|_| Snap::UNKNOWN.numbers());
        let forces = std::iter::repeat_n(f64::NAN, loading.kept);
        return Turn::UNKNOWN.numbers().into_iter().chain(snaps).chain(forces).collect();
    };
    let further = job.separations[nearer + 1..].iter().copied().filter(|h| *h > from);
    let places: Vec<f64> = [from].into_iter().chain(further).collect();
    let reversal = Reversal { cycle, from };
    let forces = surface.retraction(reversal, &places);
    let outward: Vec<(f64, f64)> = places.into_iter().zip(forces).collect();
    let turn = turn(from, &surface.find(Sought::PullOff, Branch::Retraction(reversal), &outward));
    let snaps = of_stiffnesses(loading, &outward, largest_snap);
    let nearer = std::iter::repeat_n(f64::NAN, (loading.kept + 1).saturating_sub(outward.len()));
    let forces = nearer.chain(outward[1..].iter().map(|(_, force)| *force)).take(loading.kept);
    turn.numbers().into_iter().chain(snaps).chain(forces).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{LawParameters, Path, model};
    use crate::engine::summed::Contacts;
    use crate::surface::Surface;

    /// A surface whose force on retraction is the separation less ten, from wherever it turns.
    struct Line {
        /// The separations that were asked for, from each turn.
        asked: Vec<Vec<f64>>,
    }

    impl Summed for Line {
        fn highest(&self) -> f64 {
            f64::NAN
        }

        fn contacts(&mut self, _: Reversal<'_>) -> Contacts {
            unreachable!("nobody asks for them")
        }

        fn retraction(&mut self, _: Reversal<'_>, separations: &[f64]) -> Vec<f64> {
            self.asked.push(separations.to_vec());
            separations.iter().map(|h| h - 10.0).collect()
        }

        fn find(&mut self, _: Sought, _: Branch<'_>, samples: &[(f64, f64)]) -> Extremum {
            Extremum { value: samples[0].1, place: samples[0].0, at_edge: true }
        }
    }

    /// F falls from 5 N at h = 0 to −1 at 3: 2 N are reached at h = 3/2, from where retraction passes 2, 3 and 4; 3 N
    /// are reached at 1 itself, which does not come again; 5 N at 0. Of separations before the turn no force is known.
    #[test]
    fn a_retraction_after_a_preload_goes_through_every_separation() {
        let parameters = LawParameters::scaled(1.0, Path::Approach).unwrap();
        let cycle = Loop::new(&model("hertz").unwrap(), &parameters).unwrap();
        let (surface, separations) = (Surface::uniform(1.0, 1.0, 1, 1.0), [0.0, 1.0, 2.0, 3.0, 4.0]);
        let loading = Loading { ways: (true, true), kept: 5, ..Loading::default() };
        let protocol = Protocol { loading, ..Protocol::default() };
        let job = Job { protocol, ..Job::new(cycle.approach(), &surface, &separations, 8, 1) };
        let mut line = Line { asked: Vec::new() };
        let mut numbers =
            |preload| after_preload((&job, &cycle), &mut line, &[5.0, 3.0, 1.0, -1.0, 0.0], preload);
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
