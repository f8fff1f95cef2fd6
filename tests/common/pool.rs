//! Ensembles drawn with replacement from many groups of replicas, whose mean is then known exactly: what
//! takes thousands of ensembles is cheap.

use rayon::prelude::*;
use stiction::asperity::Law;
use stiction::engine::{BATCH, Batch, Job, SCALARS, Workspace};
use stiction::math::moments::CentralMoments;
use stiction::surface::Surface;

/// Groups of replicas of one patch.
pub struct Pool {
    /// Of each group the mean external force at the controls, and behind these the mean scalars.
    groups: Vec<Vec<f64>>,
    /// How many controls there are.
    pub controls: usize,
    /// Means over all groups.
    pub mean: Vec<f64>,
    /// Groups of a batch.
    per_batch: usize,
}

impl Pool {
    /// All groups of a job, with the external force at indices of its separations as controls.
    pub fn new(job: &Job<'_>, controls: &[usize]) -> Self {
        let job = Job { keep_curves: true, ..*job };
        let group = job.scheme.group() as usize;
        let of_batch = |workspace: &mut Workspace, index: u64| {
            let batch = Batch::compute(&job, workspace, index);
            let replicas =
                batch.ensemble.replicas.iter().zip(batch.external_force.chunks_exact(job.states()));
            let values = replicas.map(|(replica, force)| {
                let forces = controls.iter().map(|&place| force[place]);
                forces.chain(SCALARS.iter().map(|scalar| (scalar.of)(replica))).collect()
            });
            let values: Vec<Vec<f64>> = values.collect();
            let mean = |group: &[Vec<f64>]| -> Vec<f64> {
                (0..group[0].len())
                    .map(|i| group.iter().map(|of| of[i]).sum::<f64>() / group.len() as f64)
                    .collect()
            };
            values.chunks_exact(group).map(mean).collect::<Vec<Vec<f64>>>()
        };
        let batches = (0..job.batches()).into_par_iter().map_init(|| Workspace::new(&job), of_batch);
        let groups: Vec<Vec<f64>> = batches.collect::<Vec<Vec<Vec<f64>>>>().concat();
        let length = groups[0].len();
        let mean =
            (0..length).map(|i| groups.iter().map(|of| of[i]).sum::<f64>() / groups.len() as f64).collect();
        Self { groups, controls: controls.len(), mean, per_batch: BATCH as usize / group }
    }

    /// The same groups with some of the controls, by their indices.
    pub fn with_controls(&self, places: &[usize]) -> Self {
        let kept = |of: &Vec<f64>| -> Vec<f64> {
            places.iter().map(|&place| of[place]).chain(of[self.controls..].iter().copied()).collect()
        };
        Self {
            groups: self.groups.iter().map(kept).collect(),
            controls: places.len(),
            mean: kept(&self.mean),
            per_batch: self.per_batch,
        }
    }

    /// What the controls are expected to be.
    pub fn expected(&self) -> &[f64] {
        &self.mean[..self.controls]
    }

    /// The true means of the scalars.
    pub fn truth(&self) -> &[f64] {
        &self.mean[self.controls..]
    }

    /// Indices of so many groups of an ensemble of its own.
    pub fn draw(&self, ensemble: u64, groups: usize) -> impl Iterator<Item = &[f64]> {
        // SplitMix64 (Steele, Lea and Flood 2014).
        let mut state = ensemble.wrapping_mul(0xd134_2543_de82_ef95);
        std::iter::repeat_with(move || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            self.groups[((z ^ (z >> 31)) % self.groups.len() as u64) as usize].as_slice()
        })
        .take(groups)
    }

    /// Adds groups to the parts of an ensemble that has so many, as the engine does: batch i to part i modulo
    /// 16.
    pub fn push<'a>(
        &self,
        parts: &mut [CentralMoments; 16],
        from: usize,
        groups: impl Iterator<Item = &'a [f64]>,
    ) {
        groups.enumerate().for_each(|(i, group)| parts[(from + i) / self.per_batch % 16].push(group));
    }

    /// An ensemble without groups.
    pub fn empty(&self) -> [CentralMoments; 16] {
        std::array::from_fn(|_| CentralMoments::new(self.mean.len()))
    }

    /// The parts of an ensemble of so many groups.
    pub fn parts(&self, ensemble: u64, groups: usize) -> [CentralMoments; 16] {
        let mut parts = self.empty();
        self.push(&mut parts, 0, self.draw(ensemble, groups));
        parts
    }
}

/// Shares of intervals that hold a truth, that lie below it, and that lie above it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coverage {
    pub held: f64,
    pub below: f64,
    pub above: f64,
}

impl Coverage {
    /// Of intervals of a truth.
    pub fn new(intervals: &[[f64; 2]], truth: f64) -> Self {
        let share = |of: &dyn Fn(&[f64; 2]) -> bool| {
            intervals.iter().filter(|interval| of(interval)).count() as f64 / intervals.len() as f64
        };
        Self {
            held: share(&|[from, to]| *from <= truth && truth <= *to),
            below: share(&|[_, to]| *to < truth),
            above: share(&|[from, _]| *from > truth),
        }
    }
}

/// So many standard deviations of a share of a count.
pub fn deviations(number: f64, share: f64, count: usize) -> f64 {
    number * (share * (1.0 - share) / count as f64).sqrt()
}

/// A patch of case II.
pub fn patch(
    heights: stiction::surface::HeightLaw,
    asperity_count: usize,
    name: &str,
) -> (Box<dyn Law>, Surface, Vec<f64>) {
    let (asperity, mut surface) = super::case("II");
    surface.asperity_count = asperity_count;
    // As far as the highest asperities of the pool reach.
    let step = if heights == stiction::surface::HeightLaw::Gaussian { 0.4 } else { 0.9 };
    surface.heights.law = heights;
    let separations = (0..16).map(|i| surface.surface_height_std * (0.4 + step * f64::from(i))).collect();
    let law = super::law(name, &asperity, stiction::asperity::Path::Approach, (-30e-9, 30e-9));
    (law, surface, separations)
}
