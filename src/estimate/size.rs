//! The size of a run, and the memory and disk that follow from it.
//!
//! They follow from what the parts of the program keep in memory at once; `tests/suite/sizes.rs` has memory within a factor of 2 of what a
//! run takes.

use crate::asperity::Laws;
use crate::engine::moments::{LANES, MANY, MOST_PERIODS, periods};
use crate::engine::{BATCH, FIRST_CURVES, PILOTS, batches_of};
use crate::experiment::{CURVE_CHUNK, HELD};
use crate::scene::{Scene, share_of_yielded};
use crate::substrate::{Coupling, Kernel};
use crate::validation::{GridSize, MAX_COMPONENTS, tested_separations};

/// Bytes of a number.
const NUMBER: f64 = 8.0;
/// Bytes that the program takes for nothing.
const PROGRAM: f64 = 11e6;
/// Bytes that are kept of every replica, and bytes that are written of it at once: a partial result has all of it as bytes.
const REPLICA: f64 = 64.0 + 60.0;
/// Bytes of an asperity that is binned for its moments: its height as drawn and in its bin, and the number of the bin.
const BINNED: f64 = 20.0;
/// Asperities that wait at a separation to be solved although sums are by moments: bytes of each, and about their share for
/// a step of the separations of 1 σ_s; the finer the steps, the fewer.
const QUEUED: (f64, f64) = (42.0, 0.045);
/// Bytes of the moments of a period, of a dozen segments.
const PERIOD: f64 = 16e3;
/// Bytes of an asperity in the search for the pull-off, and of the outline of one that has yielded.
const SEARCHED: f64 = 14.0;
const TOP: f64 = 1330.0;
/// Bytes of a coupled asperity, of a repeated square and of one alone: its near neighbours, its share of the grids, what
/// is solved for.
const COUPLED: (f64, f64) = (1.6e3, 2.1e3);
/// Bytes of its pairs in double precision, and of all that are kept at most.
const PAIRS: (f64, f64) = (1.5e3, 36e6);
/// Further bytes of a coupled asperity where each has its own laws.
const LAWS: f64 = 5e3;
/// Bytes of an asperity that is recorded by itself, and of it in a state.
const RECORDED: (f64, f64) = (4.0 * NUMBER, 4.0 * NUMBER + 3.0);

/// The size of a run, from which follows what it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Asperities of a replica.
    pub asperities: f64,
    /// States that a surface is summed in: separations, of a loop twice.
    pub separations: f64,
    /// Fraction of the asperities that have yielded when surfaces are pulled back.
    pub yielded: f64,
    /// Bytes of an asperity that is coupled; 0 where they are independent.
    pub coupled: f64,
    /// States in which the asperities of the first replica are recorded one by one.
    pub recorded: f64,
    /// Regimes of the law.
    pub regimes: f64,
    /// Replicas.
    pub replicas: f64,
    /// Replicas of a group of the sampling scheme.
    pub group: f64,
    /// Threads.
    pub threads: f64,
    /// Periods of moments; none where sums are direct.
    pub periods: Option<f64>,
    /// Step of the separations, in σ_s.
    pub step: f64,
    /// Grid of the joint test.
    pub grid: GridSize,
    /// Whether the curves of every replica are kept.
    pub curves: bool,
    /// Files of such a run that are on the disk at once.
    pub files: f64,
    /// Numbers that are kept of the jumps of a replica.
    pub snaps: f64,
}

impl Estimate {
    /// The estimate of a scene under its law, on a number of threads.
    pub fn new(scene: &Scene, law: Laws<'_>, threads: usize) -> Self {
        let (separations, ways) = (scene.separations.len(), scene.ways().count());
        let snaps = 3 * scene.instability.stiffness.len() * (1 + scene.instability.preload.len());
        let forces = if scene.curves { scene.instability.preload.len() * separations } else { 0 };
        let spread = scene.separations[separations - 1] - scene.separations[0];
        let step = spread / (separations - 1) as f64 / scene.surface.heights.std;
        let periods =
            scene.sum_tolerance().map(|_| periods(&scene.surface, step * scene.surface.heights.std));
        Self {
            asperities: scene.surface.asperity_count as f64,
            separations: scene.states() as f64,
            yielded: share_of_yielded(scene, law.typical),
            coupled: coupled(scene),
            recorded: scene.substrate.as_ref().map_or(0.0, |own| (own.loads_at.len() * ways) as f64),
            regimes: law.regimes().len() as f64,
            replicas: scene.replicas as f64,
            group: scene.sampling.group() as f64,
            threads: threads as f64,
            periods: periods.filter(|periods| periods + separations as f64 <= MOST_PERIODS),
            step,
            grid: GridSize::new(law, &scene.surface),
            curves: scene.curves,
            files: 1.0,
            snaps: (snaps + forces) as f64,
        }
    }

    /// Batches of the run.
    fn batches(&self) -> f64 {
        batches_of(self.replicas as u64) as f64
    }

    /// Whether asperities are coupled: replicas are then computed side by side.
    pub fn is_coupled(&self) -> bool {
        self.coupled > 0.0
    }

    /// Threads that have something to compute: batches, or coupled replicas.
    pub fn workers(&self) -> f64 {
        self.threads.min(if self.is_coupled() { self.replicas } else { self.batches() })
    }

    /// Pilot replicas that are summed both ways at the same time.
    fn pilots(&self) -> f64 {
        self.threads.min(PILOTS as f64).min(self.replicas)
    }

    /// Memory at its largest, bytes.
    pub fn memory(&self) -> f64 {
        let (s, r) = (self.separations, self.regimes);
        let moments = NUMBER * s * (20.0 + 6.0 * r);
        let kept = NUMBER * BATCH as f64 * s * if self.curves { 3.0 } else { 1.0 };
        // A batch that is computed, and for each two that wait to be merged.
        let batches = 3.0 * self.threads.min(self.batches()) * (moments + kept);
        // Sums of batches wait in a tree of log2(batches) levels, half of which have any, and once more while a
        // partial result is written.
        let waiting = (1.0 + self.batches().log2().max(0.0)) * moments;
        let of_replicas = (REPLICA + 3.0 * NUMBER * self.snaps) * self.replicas;
        let functionals = 2.0 * NUMBER * MAX_COMPONENTS as f64 * s;
        let ensemble = moments + waiting + of_replicas + functionals + self.first_curves();
        let integral = s * (100.0 * r + 24.0 * NUMBER);
        let of_curves = 2.0 * NUMBER * s;
        let held = (of_curves * self.replicas).min(HELD as f64);
        let file = if self.curves { 2.0 * of_curves * CURVE_CHUNK as f64 + held } else { 0.0 };
        // What is needed one after the other: the grid of the joint test, then the surfaces.
        PROGRAM
            + ensemble
            + integral
            + file
            + self.functionals().max(batches + self.surfaces() + self.coupled())
    }

    /// Bytes of the curves that quantiles are of.
    fn first_curves(&self) -> f64 {
        NUMBER * self.separations * self.replicas.min(FIRST_CURVES as f64)
    }

    /// Bytes of the grid of the joint test, its copy, and the matrix of its products.
    fn functionals(&self) -> f64 {
        let tested = tested_separations(self.separations as usize);
        let columns = 2.0 * tested as f64;
        NUMBER * (2.0 * self.grid.asperities(tested) * columns + 2.0 * columns * columns)
    }

    /// Bytes of the surfaces that are summed at the same time.
    fn surfaces(&self) -> f64 {
        let n = self.asperities;
        let searched = n * (SEARCHED + TOP * self.yielded);
        let Some(periods) = self.periods else { return self.workers() * (NUMBER * n + searched) };
        let of_moments = |n: f64, lanes: f64| {
            let queued = QUEUED.0 * (QUEUED.1 * self.step).min(0.5) * n * self.separations;
            lanes * BINNED * n + queued + PERIOD * periods
        };
        let tried = n.min(MANY as f64);
        let pilots = self.pilots() * (of_moments(tried, 1.0) + tried * (NUMBER + SEARCHED));
        let lanes = if n > MANY as f64 { 1.0 } else { self.replicas.min(LANES as f64) };
        (self.workers() * (of_moments(n, lanes) + searched)).max(pilots)
    }

    /// Bytes of coupling the surfaces that are computed at the same time.
    fn coupled(&self) -> f64 {
        let pairs = if self.is_coupled() { (PAIRS.0 * self.asperities).min(PAIRS.1) } else { 0.0 };
        // States are held by the replica, its batch, the bytes of a partial result and what is written.
        self.workers() * (self.asperities * self.coupled + pairs)
            + 4.0 * self.asperities * self.recorded_bytes()
    }

    /// Bytes of an asperity that is recorded in all its states.
    fn recorded_bytes(&self) -> f64 {
        if self.recorded == 0.0 { 0.0 } else { RECORDED.0 + RECORDED.1 * self.recorded }
    }

    /// Disk, bytes: the result and, as long as it is written, the partial result with the state next to its datasets; for
    /// curves the file without a name, too, that they are collected in, as they may not become smaller in the others.
    pub fn disk(&self) -> f64 {
        let curves = if self.curves { 3.0 * 2.0 * NUMBER * self.separations * self.replicas } else { 0.0 };
        let means = NUMBER * self.separations * (60.0 + 6.0 * self.regimes + 2.0 * MAX_COMPONENTS as f64);
        let replicas = (192.0 + 3.0 * NUMBER * self.snaps) * self.replicas;
        let recorded = 3.0 * self.asperities * self.recorded_bytes();
        self.files * (4e5 + 2.0 * means + replicas + curves + recorded + self.first_curves())
    }
}

/// Bytes of an asperity of a scene that is coupled.
fn coupled(scene: &Scene) -> f64 {
    let Some(substrate) = &scene.substrate else { return 0.0 };
    let own = match substrate.coupling {
        Coupling::Periodic => COUPLED.0,
        Coupling::Patch => COUPLED.1,
    };
    // The sums of 1/r³ in addition to the sums of 1/r.
    let own = if substrate.kernel == Kernel::Contact { 2.0 * own } else { own };
    if scene.surface.is_polydisperse() { own + LAWS } else { own }
}

/// One of the sizes that a user may choose smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Asperities, by the nominal area.
    Asperities,
    /// Separations.
    Separations,
    /// Replicas.
    Replicas,
    /// Threads.
    Threads,
}

impl Choice {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Asperities, Self::Separations, Self::Replicas, Self::Threads];

    /// The fewest that make a run; any multiple of replicas does too.
    fn least(self, estimate: &Estimate) -> f64 {
        match self {
            Self::Separations => 2.0,
            Self::Replicas => estimate.group,
            Self::Asperities | Self::Threads => 1.0,
        }
    }

    fn of(self, estimate: &mut Estimate) -> &mut f64 {
        match self {
            Self::Asperities => &mut estimate.asperities,
            Self::Separations => &mut estimate.separations,
            Self::Replicas => &mut estimate.replicas,
            Self::Threads => &mut estimate.threads,
        }
    }

    /// About the most of these, all else being as it is, for which `needed` bytes are at most `limit`, to two digits; `None`
    /// when not even the fewest do.
    pub fn most(self, estimate: &Estimate, limit: f64, needed: impl Fn(&Estimate) -> f64) -> Option<u64> {
        let fits = |value: f64| {
            let mut smaller = *estimate;
            *self.of(&mut smaller) = value;
            needed(&smaller) <= limit
        };
        let (mut low, mut high) = (self.least(estimate), *self.of(&mut { *estimate }));
        if !fits(low) {
            return None;
        }
        while high - low > 1.0 {
            let middle = (0.5 * (low + high)).floor();
            if fits(middle) { low = middle } else { high = middle }
        }
        let step = if self == Self::Replicas { estimate.group } else { 1.0 };
        let two_digits = libm::pow(10.0, libm::log10(low).floor() - 1.0).max(1.0);
        let rounded = (low / two_digits).floor() * two_digits;
        Some(((rounded / step).floor() * step).max(self.least(estimate)) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN: Estimate = Estimate {
        yielded: 0.0,
        coupled: 0.0,
        recorded: 0.0,
        asperities: 1e6,
        separations: 100.0,
        regimes: 6.0,
        replicas: 1e9,
        group: 1.0,
        threads: 64.0,
        periods: None,
        step: 0.05,
        grid: GridSize { fixed: 2000, per_separation: 10 },
        curves: false,
        files: 1.0,
        snaps: 0.0,
    };

    #[test]
    fn what_fits_is_the_most_that_does() {
        for choice in [Choice::Asperities, Choice::Replicas, Choice::Threads] {
            let with = |value: u64| {
                let mut run = RUN;
                *choice.of(&mut run) = value as f64;
                run.memory()
            };
            let limit = 0.5 * (with(1) + RUN.memory());
            let most = choice.most(&RUN, limit, Estimate::memory).unwrap();
            assert!(
                most > 1 && with(most) <= limit && with(most + most / 10 + 1) > limit,
                "{choice:?}: {most}"
            );
        }
        let most = Choice::Replicas.most(&Estimate { group: 8.0, ..RUN }, 50e9, Estimate::memory);
        assert!(most.is_some_and(|most| most.is_multiple_of(8)), "{most:?}");
        // Two digits of what fits, and whole groups of it, are what fits to a tenth.
        let with = |replicas: u64| Estimate { replicas: replicas as f64, ..RUN }.memory();
        assert!(most.is_some_and(|most| with(most) <= 50e9 && with(most + most / 10 + 8) > 50e9), "{most:?}");
        // A billion replicas do not fit, however few the asperities.
        assert_eq!(Choice::Asperities.most(&RUN, 50e9, Estimate::memory), None);
    }

    #[test]
    fn curves_take_disk() {
        let curves = Estimate { curves: true, ..RUN };
        assert_eq!(curves.disk() - RUN.disk(), 48.0 * 1e9 * 100.0);
        let most = Choice::Replicas.most(&curves, 1e9, Estimate::disk).unwrap() as f64;
        assert!((most * 4992.0 / 1e9 - 1.0).abs() < 0.05, "{most}");
    }
}
