//! How much memory and disk the ensemble of a scene takes.
//!
//! Estimates, from what the parts of the program hold at once; `tests/sizes.rs` has them within a factor of 2
//! of what a run takes.

use super::Scene;
use crate::asperity::Law;
use crate::surface::TRACT;

/// Bytes of a number.
const NUMBER: f64 = 8.0;
/// Bytes that the program takes for nothing.
const PROGRAM: f64 = 11e6;
/// Replicas of a batch, which are summed together when they are compressed.
const BATCH: f64 = 8.0;
/// Heights of the grid of the joint test, and the most separations that it looks at.
const GRID: (f64, usize) = (4001.0, 256);
/// Functionals of the joint test, at most.
const FUNCTIONALS: f64 = 32.0;
/// Bytes that are kept of every replica, and those of what is written of it at once.
const REPLICA: f64 = 64.0 + 24.0;
/// Replicas of a chunk of curves in the file.
const CHUNK: f64 = 64.0;
/// Bytes of an asperity of a surface whose sums are compressed: its height as it is drawn and in its bin, and
/// the bin's number.
const BINNED: f64 = 20.0;
/// Bytes of an asperity at a separation that waits to be solved although sums are compressed, and the share
/// of those that do, about, for a step of the separations of 1 σ_s; the finer the steps, the fewer.
const QUEUED: (f64, f64) = (42.0, 0.045);
/// Replicas that are summed both ways before a compressed run.
const PILOTS: f64 = 4.0;
/// Heights that compressed sums bin, in σ_s, and the most periods and separations that are not summed
/// directly all the same.
const BINS: (f64, f64) = (20.0, 4e3);
/// Bytes that the moments of a period take, for a dozen segments.
const PERIOD: f64 = 16e3;
/// Bytes of an asperity in the search for the pull-off, on one way and on the way back of a loop.
const SEARCHED: (f64, f64) = (14.0, 80.0);
/// A surface of at most so many tracts is held for it.
const HELD: f64 = 4.0;

/// Tracts of a large surface whose sums wait to be added, for each thread; bytes that one takes for a sum of
/// a regime, and for a period.
const WAITING: (f64, f64, f64) = (8.0, 56.0, 1.5e3);
/// Bytes that the search for the pull-off of a large surface counts in.
const COUNTED: f64 = 1e7;

/// What the memory and the disk of a run depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Asperities of a replica.
    pub asperities: f64,
    /// States that a surface is summed in: separations, of a loop twice.
    pub separations: f64,
    /// Whether a surface is pulled back.
    pub is_loop: bool,
    /// Regimes of the law.
    pub regimes: f64,
    /// Replicas.
    pub replicas: f64,
    /// Replicas of a group of the sampling scheme.
    pub group: f64,
    /// Threads.
    pub threads: f64,
    /// Ensembles that are kept: one for each law.
    pub ensembles: f64,
    /// Step of the separations, in σ_s.
    pub step: f64,
    /// Whether sums are compressed.
    pub compressed: bool,
    /// Whether the curves of every replica are kept.
    pub curves: bool,
    /// Files of such a run that are on the disk at once.
    pub files: f64,
    /// Numbers that are kept of the snaps of a replica.
    pub snaps: f64,
}

impl Sizes {
    /// Of a scene under its law, on so many threads.
    pub fn new(scene: &Scene, law: &dyn Law, threads: usize) -> Self {
        let separations = scene.separations.len();
        let snaps = 3 * scene.instability.stiffness.len() * (1 + scene.instability.preload.len());
        let range = scene.separations[separations - 1] - scene.separations[0];
        Self {
            asperities: scene.surface.asperity_count as f64,
            separations: scene.states() as f64,
            is_loop: scene.cycle,
            regimes: law.regimes().len() as f64,
            replicas: scene.replicas as f64,
            group: scene.sampling.group() as f64,
            threads: threads as f64,
            ensembles: 1.0,
            step: range / (separations - 1) as f64 / scene.surface.heights.std,
            compressed: scene.sum_tolerance.is_some(),
            curves: scene.curves,
            files: 1.0,
            snaps: snaps as f64,
        }
    }

    /// Batches of the run.
    pub fn batches(&self) -> f64 {
        (self.replicas / BATCH).ceil()
    }

    /// Whether surfaces are drawn and summed in tracts, which threads share.
    pub fn is_divided(&self) -> bool {
        self.asperities > TRACT as f64
    }

    /// Threads that have something to compute: a batch, or a tract of one.
    pub fn workers(&self) -> f64 {
        let tracts = if self.is_divided() { (self.asperities / TRACT as f64).ceil() } else { 1.0 };
        self.threads.min(self.batches() * tracts)
    }

    /// Estimated memory, bytes, at its largest.
    pub fn memory(&self) -> f64 {
        let (s, r) = (self.separations, self.regimes);
        let moments = NUMBER * s * (20.0 + 6.0 * r);
        let kept = if self.curves { 2.0 * NUMBER * BATCH * s } else { 0.0 };
        // A batch that is computed, and for each as many that wait to be merged.
        let batches = 3.0 * self.threads.min(self.batches()) * (moments + kept);
        // Sums of batches wait in a tree of so many levels, half of which have any, and once more as what a
        // checkpoint holds.
        let waiting = (1.0 + self.batches().log2().max(0.0)) * moments;
        let ensembles = self.ensembles
            * (moments
                + waiting
                + (REPLICA + 2.0 * NUMBER * self.snaps) * self.replicas
                + 2.0 * NUMBER * FUNCTIONALS * s);
        let expectations = s * (100.0 * r + 24.0 * NUMBER);
        let file = if self.curves { 4.0 * NUMBER * CHUNK * s } else { 0.0 };
        // What is needed one after the other: the grid of the joint test, then the surfaces.
        PROGRAM + ensembles + expectations + file + self.functionals().max(batches + self.surfaces())
    }

    /// Separations that the joint test looks at.
    pub fn tested(&self) -> f64 {
        let s = self.separations as usize;
        s.div_ceil(s.div_ceil(GRID.1).max(1)) as f64
    }

    /// Bytes of the grid of the joint test, its copy, and the matrix of its products.
    fn functionals(&self) -> f64 {
        let columns = 2.0 * self.tested();
        NUMBER * (2.0 * GRID.0 * columns + 2.0 * columns * columns)
    }

    /// Bytes of the surfaces, or tracts of them, that are summed at the same time.
    fn surfaces(&self) -> f64 {
        let n = self.asperities.min(TRACT as f64);
        let of_search = if self.is_loop { SEARCHED.1 } else { SEARCHED.0 };
        let searched = n * of_search;
        let direct = NUMBER * n + searched;
        let held =
            if self.asperities > HELD * TRACT as f64 { 0.0 } else { self.asperities * (NUMBER + of_search) };
        let periods = BINS.0 / self.step;
        let compressed = self.compressed && periods + self.separations <= BINS.1;
        let queued = QUEUED.0 * (QUEUED.1 * self.step).min(0.5) * n * self.separations;
        let moments = PERIOD * periods;
        let pilot = BINNED * n + queued + direct + moments;
        let pilots = self.threads.min(PILOTS).min(self.replicas) * pilot;
        let lanes = self.replicas.min(BATCH);
        match (self.is_divided(), compressed) {
            (false, false) => self.workers() * direct,
            (false, true) => {
                (self.workers() * (lanes * BINNED * n + queued + searched + moments)).max(pilots)
            }
            (true, false) => {
                let sums = WAITING.1 * self.separations * self.regimes;
                COUNTED + self.workers() * (NUMBER * n + WAITING.0 * sums) + held
            }
            (true, true) => {
                // Each tract is queued in as many pieces as there are lanes.
                let tract = BINNED * n + queued / BATCH + moments + WAITING.0 * WAITING.2 * periods;
                (COUNTED + moments + self.workers() * tract + held).max(pilots)
            }
        }
    }

    /// Estimated disk, bytes: what is kept of the replicas, and for curves the file beside the result that
    /// they are collected in and as much in the result, as they may not become smaller there.
    pub fn disk(&self) -> f64 {
        let curves = if self.curves { 2.0 * 2.0 * NUMBER * self.separations * self.replicas } else { 0.0 };
        let means = NUMBER * self.separations * (60.0 + 6.0 * self.regimes + 2.0 * FUNCTIONALS);
        let replicas = (128.0 + 2.0 * NUMBER * self.snaps) * self.replicas;
        self.files * (2e5 + means + replicas + curves)
    }
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

    /// How so many of it are chosen.
    pub fn chosen(self, number: u64) -> String {
        match self {
            Self::Asperities => format!("a nominal_area of {number:e} asperities"),
            Self::Separations => format!("{number} separations"),
            Self::Replicas => format!("--replicas {number}"),
            Self::Threads => format!("--threads {number}"),
        }
    }

    /// The fewest that make a run; any multiple of replicas does too.
    fn least(self, sizes: &Sizes) -> f64 {
        match self {
            Self::Separations => 2.0,
            Self::Replicas => sizes.group,
            Self::Asperities | Self::Threads => 1.0,
        }
    }

    fn of(self, sizes: &mut Sizes) -> &mut f64 {
        match self {
            Self::Asperities => &mut sizes.asperities,
            Self::Separations => &mut sizes.separations,
            Self::Replicas => &mut sizes.replicas,
            Self::Threads => &mut sizes.threads,
        }
    }

    /// About the most of these, all else being as it is, for which `needed` bytes are at most `limit`, to two
    /// digits; `None` when not even the fewest do.
    pub fn most(self, sizes: &Sizes, limit: f64, needed: impl Fn(&Sizes) -> f64) -> Option<u64> {
        let fits = |value: f64| {
            let mut sizes = *sizes;
            *self.of(&mut sizes) = value;
            needed(&sizes) <= limit
        };
        let (mut low, mut high) = (self.least(sizes), *self.of(&mut { *sizes }));
        if !fits(low) {
            return None;
        }
        while high - low > 1.0 {
            let middle = (0.5 * (low + high)).floor();
            if fits(middle) { low = middle } else { high = middle }
        }
        let step = if self == Self::Replicas { sizes.group } else { 1.0 };
        let two_digits = libm::pow(10.0, libm::log10(low).floor() - 1.0).max(1.0);
        let rounded = (low / two_digits).floor() * two_digits;
        Some(((rounded / step).floor() * step).max(self.least(sizes)) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: Sizes = Sizes {
        is_loop: false,
        asperities: 1e6,
        separations: 100.0,
        regimes: 6.0,
        replicas: 1e9,
        group: 1.0,
        threads: 64.0,
        ensembles: 1.0,
        step: 0.05,
        compressed: false,
        curves: false,
        files: 1.0,
        snaps: 0.0,
    };

    #[test]
    fn what_fits_is_the_most_that_does() {
        for choice in [Choice::Asperities, Choice::Replicas, Choice::Threads] {
            let with = |value: u64| {
                let mut sizes = SIZES;
                *choice.of(&mut sizes) = value as f64;
                sizes.memory()
            };
            let limit = 0.5 * (with(1) + SIZES.memory());
            let most = choice.most(&SIZES, limit, Sizes::memory).unwrap();
            assert!(
                most > 1 && with(most) <= limit && with(most + most / 10 + 1) > limit,
                "{choice:?}: {most}"
            );
        }
        let most = Choice::Replicas.most(&Sizes { group: 8.0, ..SIZES }, 50e9, Sizes::memory);
        assert!(most.is_some_and(|most| most.is_multiple_of(8)), "{most:?}");
        // Two digits of what fits, and whole groups of it, are what fits to a tenth.
        let with = |replicas: u64| Sizes { replicas: replicas as f64, ..SIZES }.memory();
        assert!(most.is_some_and(|most| with(most) <= 50e9 && with(most + most / 10 + 8) > 50e9), "{most:?}");
        // A billion replicas do not fit, however few the asperities.
        assert_eq!(Choice::Asperities.most(&SIZES, 50e9, Sizes::memory), None);
    }

    /// A surface that is divided takes no more memory with more asperities, and all threads.
    #[test]
    fn tracts_take_as_much_memory_however_many() {
        for compressed in [false, true] {
            let one = Sizes { asperities: 1e9, replicas: 1.0, compressed, ..SIZES };
            assert_eq!(one.memory(), Sizes { asperities: 1e12, ..one }.memory());
            assert_eq!((one.is_divided(), one.workers()), (true, 64.0));
            assert_eq!(Sizes { asperities: 3e6, ..one }.workers(), 3.0);
            let held = Sizes { asperities: TRACT as f64, ..one };
            assert_eq!((held.is_divided(), held.workers()), (false, 1.0));
        }
    }

    #[test]
    fn curves_take_disk() {
        let curves = Sizes { curves: true, ..SIZES };
        assert_eq!(curves.disk() - SIZES.disk(), 32.0 * 1e9 * 100.0);
        let most = Choice::Replicas.most(&curves, 1e9, Sizes::disk).unwrap() as f64;
        assert!((most * 3304.0 / 1e9 - 1.0).abs() < 0.05, "{most}");
    }
}
