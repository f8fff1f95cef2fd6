//! Snaps of the replicas of a run: counts, probabilities, pull-off after preloads.

use super::ensemble::loading;
use super::results::Results;
use crate::engine::instability::{Snap, Turn};
use crate::engine::{Ensemble, Loading};
use crate::format::si;
use crate::math::interval::interval;
use crate::math::moments::Moments;
use crate::math::proportion::exact_interval;
use crate::scene::{Scene, Warning};

/// Largest share of the replicas that may miss a preload.
const LARGEST_MISSED: f64 = 0.01;

/// One of the numbers that are kept of every replica.
struct Column<'a> {
    snaps: &'a [f64],
    length: usize,
    place: usize,
}

impl Column<'_> {
    /// The values, replica by replica.
    fn values(&self) -> impl Iterator<Item = f64> {
        self.snaps.chunks_exact(self.length).map(|numbers| numbers[self.place])
    }
}

/// The snaps of all replicas.
pub(crate) struct Snaps<'a> {
    snaps: &'a [f64],
    pub loading: Loading<'a>,
}

/// Replicas of which it is known whether they snap: how many, how many do, and how many of these nothing
/// stops.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    pub known: u64,
    pub snap: u64,
    pub unstopped: u64,
}

impl Counts {
    /// The share that snaps.
    pub fn share(self) -> f64 {
        self.snap as f64 / self.known as f64
    }

    /// The 95 % interval of its probability.
    pub fn interval(self) -> (f64, f64) {
        exact_interval(self.snap, self.known)
    }
}

/// The pull-off force after a turn, N, over the replicas that turn: their number, the mean, the standard deviation, and the
/// standard error and 95 % interval of the mean. What too few replicas have is not a number.
pub(crate) struct PulledOff {
    pub count: u64,
    pub mean: f64,
    pub std: f64,
    pub standard_error: f64,
    pub interval: [f64; 2],
}

impl PulledOff {
    pub fn of(forces: Vec<f64>) -> Self {
        let moments = Moments::of(forces.into_iter());
        let count = moments.count();
        let (mean, std) =
            if count == 0 { (f64::NAN, f64::NAN) } else { (moments.mean()[0], moments.std()[0]) };
        let standard_error = std / (count as f64).sqrt();
        let interval = interval(mean, standard_error, 0.0, count, count as f64 - 1.0);
        Self { count, mean, std, standard_error, interval }
    }
}

/// Counts pull-off forces, N, that are larger than a force.
pub(crate) fn holding(pull_offs: impl Iterator<Item = f64>, force: f64) -> Counts {
    let mut counts = Counts { known: 0, snap: 0, unstopped: 0 };
    for pull_off in pull_offs {
        counts.known += 1;
        counts.snap += u64::from(pull_off > force);
    }
    counts
}

/// The replicas of a run with a pull-off force above the restoring force of the device, if there is one; with preloads
/// [`Snaps::stuck`] has them.
pub(crate) fn stuck(results: &Results) -> Option<Counts> {
    let force = results.scene.restoring_force.filter(|_| results.scene.instability.preload.is_empty())?;
    Some(holding(results.ensemble.replicas.iter().map(|replica| replica.pull_off_force), force))
}

/// Preloads that part of the replicas do not reach.
pub(crate) fn missed_preloads(results: &Results) -> Option<Warning> {
    let (snaps, replicas) = (Snaps::of(results), results.scene.replicas);
    let missed = snaps.loading.preload.iter().zip(snaps.places_of_turns()).filter_map(|(preload, turn)| {
        let missing = replicas - snaps.pull_offs(turn).len() as u64;
        let is_noticeable = missing as f64 > LARGEST_MISSED * replicas as f64;
        is_noticeable.then(|| format!("{missing} do not reach {}", si(*preload, "N")))
    });
    let missed: Vec<String> = missed.collect();
    (!missed.is_empty()).then(|| {
        Warning::new(
            format!(
                "of {replicas} replicas {}: a pull-off after a preload is of those that reach it",
                missed.join(", ")
            ),
            "replicas that reach a preload are no random choice",
            "let [separation] begin at a smaller h",
        )
    })
}

impl<'a> Snaps<'a> {
    pub fn of(results: &'a Results) -> Self {
        Self::new(&results.scene, &results.ensemble)
    }

    pub fn new(scene: &'a Scene, ensemble: &'a Ensemble) -> Self {
        Self::of_numbers(scene, &ensemble.snaps)
    }

    /// The snaps of some replicas of a scene, by the numbers that are kept of them.
    pub fn of_numbers(scene: &'a Scene, snaps: &'a [f64]) -> Self {
        Self { snaps, loading: loading(scene) }
    }

    fn column(&self, place: usize) -> Column<'a> {
        Column { snaps: self.snaps, length: self.loading.length(), place }
    }

    /// The place of a snap on approach.
    pub fn place_in(&self, stiffness: usize) -> usize {
        Snap::LENGTH * stiffness
    }

    /// The place of a retraction.
    fn place_of_turn(&self, retraction: usize) -> usize {
        Snap::LENGTH * self.loading.snaps_in() + self.loading.of_retraction() * retraction
    }

    /// The place of a snap on retraction.
    pub fn place_off(&self, retraction: usize, stiffness: usize) -> usize {
        self.place_of_turn(retraction) + Turn::LENGTH + Snap::LENGTH * stiffness
    }

    pub fn counts(&self, place: usize) -> Counts {
        let (is, distance) = (self.column(place), self.column(place + 2));
        let mut counts = Counts { known: 0, snap: 0, unstopped: 0 };
        for (is, distance) in is.values().zip(distance.values()) {
            counts.known += u64::from(!is.is_nan());
            counts.snap += u64::from(is == 1.0);
            counts.unstopped += u64::from(is == 1.0 && distance.is_nan());
        }
        counts
    }

    /// Number `offset` behind each of the places, for every replica.
    pub fn table(&self, places: &[usize], offset: usize) -> Vec<f64> {
        let replicas = self.snaps.chunks_exact(self.loading.length());
        replicas.flat_map(|numbers| places.iter().map(move |place| numbers[place + offset])).collect()
    }

    pub fn places_in(&self) -> Vec<usize> {
        (0..self.loading.snaps_in()).map(|stiffness| self.place_in(stiffness)).collect()
    }

    pub fn places_of_turns(&self) -> Vec<usize> {
        (0..self.loading.retractions()).map(|retraction| self.place_of_turn(retraction)).collect()
    }

    /// The places of the forces that are kept of retractions, separation by separation.
    pub fn places_of_forces(&self) -> Vec<usize> {
        let kept = self.loading.kept;
        let end = |retraction| self.place_of_turn(retraction + 1);
        (0..self.loading.retractions())
            .flat_map(|retraction| end(retraction) - kept..end(retraction))
            .collect()
    }

    pub fn places_off(&self) -> Vec<usize> {
        let stiffnesses = self.loading.stiffness.len();
        let of = |retraction| (0..stiffnesses).map(move |stiffness| self.place_off(retraction, stiffness));
        (0..self.loading.retractions()).flat_map(of).collect()
    }

    /// The pull-off force of every replica after a turn, N; NaN of one that does not turn.
    pub fn every_pull_off(&self, turn: usize) -> Vec<f64> {
        self.column(turn + 1).values().collect()
    }

    /// The pull-off forces after a turn, N, of the replicas that turn.
    pub fn pull_offs(&self, turn: usize) -> Vec<f64> {
        self.column(turn + 1).values().filter(|force| !force.is_nan()).collect()
    }

    /// The pull-off after a turn.
    pub fn pull_off(&self, turn: usize) -> PulledOff {
        PulledOff::of(self.pull_offs(turn))
    }

    /// The replicas with a pull-off above a force, N, after a turn.
    pub fn stuck(&self, turn: usize, force: f64) -> Counts {
        holding(self.pull_offs(turn).into_iter(), force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2 and 6 N: mean 3, variance 7; the 95 % interval is Student's of two degrees of freedom
    /// (scipy.stats.t.ppf(0.975, 2)). One force has no scatter, and none has no mean.
    #[test]
    fn pull_offs_have_the_interval_of_student() {
        let three = PulledOff::of(vec![1.0, 2.0, 6.0]);
        assert_eq!((three.count, three.mean), (3, 3.0));
        assert!((three.std - 7_f64.sqrt()).abs() < 1e-14);
        let error = (7.0_f64 / 3.0).sqrt();
        assert!((three.standard_error - error).abs() < 1e-14);
        for (end, sign) in three.interval.into_iter().zip([-1.0, 1.0]) {
            assert!(((end - 3.0) / error - sign * 4.302652729749462).abs() < 1e-7, "{:?}", three.interval);
        }
        let (one, none) = (PulledOff::of(vec![5.0]), PulledOff::of(Vec::new()));
        assert!(one.mean == 5.0 && one.std.is_nan() && one.interval.iter().all(|end| end.is_nan()));
        assert!(none.count == 0 && none.mean.is_nan() && none.standard_error.is_nan());
    }

    /// Of 1, 2 and 3 N, one holds harder than 2 N: what is as strong as the device is let go.
    #[test]
    fn what_holds_is_stronger_than_the_device() {
        for (force, holding_count) in [(0.5, 3), (2.0, 1), (3.0, 0)] {
            let counts = holding([1.0, 2.0, 3.0].into_iter(), force);
            assert_eq!((counts.known, counts.snap, counts.unstopped), (3, holding_count, 0), "{force}");
        }
    }
}
