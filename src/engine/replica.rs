//! One replica: one surface, its curves and what is kept of them.

use super::Job;
use super::asperity_states::AsperityStates;
use super::chunks::{Chunks, Ends};
use super::coupled::{Substrate, couple};
use super::curves::Curves;
use super::cycle::{Cycle, snaps};
use super::force_table::ForceTable;
use super::held::HeldSurface;
use super::kinks::Kinks;
use super::moments::{LANES, MomentSums};
use super::polydisperse::{Asperities, LaneSums, PulledBack};
use super::sampling::{Draws, is_divided};
use super::summed::Summed;
use super::sums::{RegimeSums, State, Sums};
use crate::asperity::{Quantity, SolverStats};
use crate::coupled::{CLASSES, ENERGY_CLASSES};
use crate::math::extrema::Extremum;
use crate::surface::CHUNK_ASPERITIES;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The record of every replica.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, model};
/// use stiction::engine::{Job, Replica};
/// use stiction::surface::Surface;
///
/// # let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// # let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// # let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let ensemble = Job::new(law.as_ref(), &surface, &separations, 64, 1).ensemble();
/// let Replica { asperity_count, pull_off_force, pull_off_at_edge, .. } = ensemble.replicas[0];
/// assert_eq!(asperity_count, 100);
/// assert!(pull_off_force > 0.0 && !pull_off_at_edge);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Replica {
    /// Number of asperities.
    pub asperity_count: u64,
    /// Highest asperity above the asperity mean plane, m.
    pub highest_asperity: f64,
    /// −min F along its own curve, between the separations too, N.
    pub pull_off_force: f64,
    /// Separation h of the pull-off, m.
    pub pull_off_separation: f64,
    /// Largest secant stiffness of its own curve over the span of the job, N/m; NaN if the job has none.
    pub peak_secant_stiffness: f64,
    /// Separation h in the middle of the span there, m.
    pub peak_secant_stiffness_separation: f64,
    /// Whether the smallest force is at the first or last separation, so that the curve may fall further
    /// beyond.
    pub pull_off_at_edge: bool,
    /// The record of it as a loop, if it is one; all above is then of the retraction.
    pub cycle: Option<Box<Cycle>>,
    /// What there is of coupled asperities beside.
    pub coupled: Option<Box<CoupledReplica>>,
}

/// The record of a replica with coupled asperities, beside what every replica has.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoupledReplica {
    /// The record of the same asperities without coupling.
    pub independent: Replica,
    /// States in which no stable one was found.
    pub unsettled: u64,
    /// Asperities in the largest avalanche.
    pub largest_avalanche: u64,
    /// Largest (a_i + a_j)/r_ij of all pairs in all states, contact radii over distance.
    pub largest_crowding: f64,
    /// States in which circles of contact overlap.
    pub overlapping: u64,
    /// Avalanches by their size: of 2^k to 2^(k+1) − 1 asperities.
    pub avalanche_sizes: [u64; CLASSES],
    /// Energy that avalanches lost in all states, J.
    pub energy_lost: f64,
    /// States in which energy was lost, by [`energy_class`](crate::coupled::energy_class).
    pub energy_classes: [u64; ENERGY_CLASSES],
    /// The asperities one by one, of the first replica where that is asked for.
    pub asperities: Option<Box<AsperityStates>>,
}

impl Replica {
    fn pull_off(&mut self, smallest: &Extremum) {
        (self.pull_off_force, self.pull_off_separation) = (-smallest.value, smallest.place);
        self.pull_off_at_edge = smallest.at_edge;
    }

    pub(super) fn stiffest(&mut self, secant: &Extremum) {
        (self.peak_secant_stiffness, self.peak_secant_stiffness_separation) = (secant.value, secant.place);
    }
}

/// Memory that batches reuse one after the other.
pub struct Workspace {
    /// Asperities of a chunk, and whether surfaces are summed chunk by chunk.
    chunk: usize,
    is_divided: bool,
    heights: Vec<Vec<f64>>,
    /// The radii of the surface that is summed, where asperities differ in their radii.
    radii: Vec<f64>,
    /// The asperities of that, and memory for their sums.
    asperities: Option<Asperities>,
    pulled: Option<PulledBack>,
    lane_sums: LaneSums,
    kinks: Kinks,
    table: ForceTable,
    sums: Sums,
    moments: Option<MomentSums>,
    /// The curves of the surfaces that were summed last.
    pub curves: Vec<Curves>,
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        Self::with_chunks(job, CHUNK_ASPERITIES)
    }

    /// Memory for replicas of a job whose surfaces are drawn, and summed, in chunks of `chunk` asperities
    /// where they have more.
    pub fn with_chunks(job: &Job<'_>, chunk: usize) -> Self {
        let r = job.laws.regimes().len();
        let is_divided = is_divided(job.surface, chunk);
        let matrix = job.moments.filter(|_| !is_divided);
        let at_once = if matrix.is_some() { LANES } else { 1 };
        let kinks = Kinks::new(job);
        Self {
            chunk,
            is_divided,
            heights: vec![Vec::new(); at_once],
            radii: Vec::new(),
            asperities: None,
            pulled: None,
            lane_sums: LaneSums::new(r),
            table: ForceTable::of(job, &kinks),
            kinks,
            sums: Sums::new(r),
            moments: matrix.map(|matrix| MomentSums::new(matrix, r)),
            curves: vec![Curves::new(job.states(), r); at_once],
        }
    }

    /// The cost of the surfaces since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        std::mem::take(&mut self.sums.stats)
    }

    /// Draws replicas, sums them over all separations, and visits each with what is kept of it and its
    /// curves.
    pub fn replicas(&mut self, job: &Job<'_>, replicas: Range<u64>, visit: impl FnMut(Replica, &Curves)) {
        self.replicas_until(job, replicas, &|| false, visit);
    }

    /// The same, until `ends` is true, which surfaces that are summed chunk by chunk look at before each, and coupled
    /// ones before each separation: then the replica at hand is not visited, nor any further one. Whether all were visited.
    pub fn replicas_until(
        &mut self,
        job: &Job<'_>,
        replicas: Range<u64>,
        ends: Ends<'_>,
        mut visit: impl FnMut(Replica, &Curves),
    ) -> bool {
        if self.is_divided {
            return replicas.into_iter().all(|index| {
                let kept = self.divided(job, index, ends);
                kept.map(|kept| visit(kept, &self.curves[0])).is_some()
            });
        }
        match &job.protocol.substrate {
            None => self.held(job, replicas, |_, kept, curves| visit(kept, curves)),
            Some(substrate) => {
                let mut independent = Vec::new();
                self.held(job, replicas, |index, kept, curves| {
                    independent.push((index, kept, curves.clone()))
                });
                // They take seconds each: those of a batch do not wait for each other.
                let (of, chunk) = ((job, substrate, ends), self.chunk);
                let coupled: Vec<_> =
                    independent.into_par_iter().map(|replica| coupled(of, chunk, replica)).collect();
                for coupled in coupled {
                    let Some((kept, curves, stats)) = coupled else { return false };
                    self.sums.stats.merge(&stats);
                    visit(kept, &curves);
                }
            }
        }
        true
    }

    /// Draws replicas with all their asperities, sums them as independent ones, and visits each with its index, what is
    /// kept of it and its curves.
    fn held(&mut self, job: &Job<'_>, replicas: Range<u64>, mut visit: impl FnMut(u64, Replica, &Curves)) {
        let mut first = replicas.start;
        while first < replicas.end {
            let at_once = (replicas.end - first).min(self.heights.len() as u64);
            for (heights, index) in self.heights.iter_mut().zip(first..first + at_once) {
                Draws::of(job, index, self.chunk).all(heights, &mut self.radii);
            }
            self.sum(job, at_once as usize);
            for lane in 0..at_once as usize {
                let kept = self.keep(job, lane);
                visit(first + lane as u64, kept, &self.curves[lane]);
            }
            first += at_once;
        }
    }

    /// The record of a surface that is summed chunk by chunk; nothing when that was ended.
    fn divided(&mut self, job: &Job<'_>, index: u64, ends: Ends<'_>) -> Option<Replica> {
        let draws = Draws::of(job, index, self.chunk);
        let mut surface = Chunks::new(job, draws, (&self.kinks, &mut self.table), ends);
        surface.sum(&mut self.curves[0]);
        let kept = keep(job, &mut surface, draws.count, &mut self.curves[0]);
        self.sums.stats.merge(&surface.stats);
        (!ends()).then_some(kept)
    }

    /// Sums the first `count` surfaces, whose heights it sorts: rising heights make the regimes contiguous,
    /// and neighbours in a slice neighbours in the law.
    fn sum(&mut self, job: &Job<'_>, count: usize) {
        if let (Some(matrix), Some(moments)) = (job.moments, &mut self.moments) {
            moments.take(matrix, &self.heights[..count]);
            moments.fill(matrix, job.laws.typical, &mut self.curves[..count], &mut self.sums.stats);
        }
        if let Some(family) = job.laws.family {
            let asperities = Asperities::new(family, &self.heights[0], &self.radii);
            let (stats, curves) = (&mut self.sums.stats, &mut self.curves[0]);
            asperities.record(job, &mut self.lane_sums, stats, curves);
            self.pulled = job.protocol.cycle.map(|cycle| {
                let pulled = asperities.turn(job, cycle, job.separations[0], stats);
                let s = job.separations.len();
                pulled.record((job, cycle), s, &mut self.lane_sums, stats, curves);
                if let Some(again) = cycle.again() {
                    let closer = asperities.turn(job, again, job.separations[0], stats);
                    closer.record((job, again), 2 * s, &mut self.lane_sums, stats, curves);
                }
                pulled
            });
            self.asperities = Some(asperities);
            return;
        }
        let states = State::all(job);
        for (lane, heights) in self.heights[..count].iter_mut().enumerate() {
            if self.moments.as_ref().is_some_and(|moments| moments.surface(lane).is_some()) {
                continue;
            }
            heights.sort_unstable_by(f64::total_cmp);
            self.sums.forget();
            for (k, state) in states.iter().enumerate() {
                self.sums.surface(job, heights, *state);
                RegimeSums::record(&self.sums.regimes, k, &mut self.curves[lane]);
            }
        }
    }

    /// The record of a surface that has been summed.
    fn keep(&mut self, job: &Job<'_>, lane: usize) -> Replica {
        let heights = self.heights[lane].as_slice();
        let moments = job.moments.zip(self.moments.as_mut());
        let mut surface = HeldSurface {
            job,
            heights,
            asperities: self.asperities.as_ref().map(|asperities| (asperities, &mut self.lane_sums)),
            pulled: &mut self.pulled,
            kinks: &self.kinks,
            table: &mut self.table,
            places: None,
            places_back: None,
            flattened: None,
            highest: heights.iter().copied().reduce(f64::max).unwrap_or(f64::NAN),
            sums: &mut self.sums,
            moments: moments
                .filter(|(_, sums)| sums.surface(lane).is_some())
                .map(|(matrix, sums)| (matrix, sums, lane)),
        };
        keep(job, &mut surface, heights.len(), &mut self.curves[lane])
    }
}

/// The replica of an index with its curves, its asperities coupled, and the cost of that; nothing when that was ended.
/// `kept` and `curves` are of the same asperities without coupling.
fn coupled(
    of: (&Job<'_>, &Substrate<'_>, Ends<'_>),
    chunk: usize,
    (index, kept, curves): (u64, Replica, Curves),
) -> Option<(Replica, Curves, SolverStats)> {
    let (job, _, ends) = of;
    let (mut heights, mut radii, mut stats) = (Vec::new(), Vec::new(), SolverStats::default());
    Draws::of(job, index, chunk).all(&mut heights, &mut radii);
    let count = heights.len();
    let keep = |surface: &mut dyn Summed, curves: &mut Curves| keep(job, surface, count, curves);
    let (kept, curves) = couple(of, index, (&heights, &radii), (kept, &curves), &mut stats, keep);
    (!ends()).then_some((kept, curves, stats))
}

/// The record of a surface of `count` asperities whose curves are known; its snaps are left in these, and the
/// attraction of the mean planes in the external force.
fn keep(job: &Job<'_>, surface: &mut dyn Summed, count: usize, curves: &mut Curves) -> Replica {
    for (force, state) in curves.total[Quantity::ExternalForce.index()].iter_mut().zip(State::all(job)) {
        *force = state.external_force(job.surface, *force);
    }
    let external = &curves.total[Quantity::ExternalForce.index()];
    let (external, back) = external.split_at(job.separations.len());
    let pull_off = surface.pull_off(external);
    let highest_asperity = surface.highest();
    let mut kept = Replica { asperity_count: count as u64, highest_asperity, ..Replica::default() };
    let mut last = (external, pull_off);
    if let Some(cycle) = job.protocol.cycle {
        let contacts = surface.contacts(cycle);
        kept.cycle = Some(Box::new(Cycle::new(job, highest_asperity, contacts, curves, &pull_off)));
        let retraction = &back[..job.separations.len()];
        last = (retraction, surface.retraction_pull_off(job.separations[0], &job.samples(retraction)));
    }
    kept.pull_off(&last.1);
    let from = job.protocol.cycle.map(|_| job.separations[0]);
    let unknown = Extremum { place: f64::NAN, value: f64::NAN, at_edge: false };
    let stiffest = |span| surface.stiffest(from, &job.samples(last.0), span);
    kept.stiffest(&job.protocol.stiffness_span.map_or(unknown, stiffest));
    if !job.protocol.loading.stiffness.is_empty() {
        curves.snaps = snaps(job, surface, external, last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::case_ii::CASE_II;
    use super::super::kinks::Kink;
    use super::super::moments::{MomentMatrix, largest_error};
    use super::super::{Loading, Protocol};
    use super::*;
    use crate::asperity::models::model;
    use crate::asperity::{Family, Law, LawParameters, Laws, Loop, Path, SurfaceLaws, UnloadedRadius};
    use crate::surface::{
        CountLaw, HeightLaw, Heights, LogNormal, RADIUS_RANGE, Radii, Roughness, SamplingScheme, Surface,
    };
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Asperities of a chunk, no power of 2, and of a surface of several, the last of which is not full.
    const SMALL: usize = 6000;
    const COUNT: usize = 20_000;

    fn surface() -> Surface {
        let roughness = Roughness {
            asperity_radius: CASE_II.radius,
            asperity_density: 7.39e12,
            nominal_area: COUNT as f64 / 7.39e12,
            surface_height_std: Some(1.619e-9),
            asperity_height_std: None,
            mean_plane_offset: None,
        };
        Surface::new(&roughness).unwrap()
    }

    fn separations(surface: &Surface, step: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| surface.surface_height_std * (-1.0 + step * k as f64)).collect()
    }

    fn parameters() -> LawParameters {
        LawParameters::new(&CASE_II, Path::Approach, (-40e-9, 60e-9)).unwrap()
    }

    fn law(name: &str) -> Box<dyn Law> {
        model(name).unwrap().law(&parameters()).unwrap()
    }

    fn job<'a>(laws: impl Into<Laws<'a>>, surface: &'a Surface, separations: &'a [f64]) -> Job<'a> {
        Job {
            laws: laws.into(),
            surface,
            separations,
            seed: 7,
            scheme: SamplingScheme::Independent,
            replicas: 8,
            controls: &[],
            keep_curves: false,
            moments: None,
            protocol: Protocol { stiffness_span: Some(CASE_II.equilibrium_spacing), ..Protocol::default() },
        }
    }

    /// The replica `index` chunk by chunk.
    fn divided(job: &Job<'_>, index: u64) -> (Replica, Curves) {
        let mut workspace = Workspace::with_chunks(job, SMALL);
        assert!(workspace.is_divided);
        let kept = workspace.divided(job, index, &|| false).unwrap();
        (kept, workspace.curves.remove(0))
    }

    /// The same asperities, all held at once.
    fn held(job: &Job<'_>, index: u64) -> (Replica, Curves) {
        let mut workspace = Workspace::with_chunks(job, usize::MAX);
        assert!(!workspace.is_divided);
        Draws::of(job, index, SMALL).all(&mut workspace.heights[0], &mut workspace.radii);
        workspace.sum(job, 1);
        (workspace.keep(job, 0), workspace.curves.remove(0))
    }

    /// Has both ways of summing a replica agree: curves to a share `tolerance` of F_s + P, and what is kept
    /// to as much. Its pull-off may be less deep by what the steepest part of a curve falls on the way
    /// between the ends of cells, or deeper; the place of that is one of the curve.
    #[track_caller]
    fn agree(job: &Job<'_>, index: u64, (mine, curves): &(Replica, Curves), tolerance: f64) {
        let (truth, direct) = held(&Job { moments: None, ..*job }, index);
        let error = largest_error(curves, &direct);
        assert!(error <= tolerance, "{error:e}");
        let exact = |replica: &Replica| {
            (replica.asperity_count, replica.highest_asperity.to_bits(), replica.pull_off_at_edge)
        };
        assert_eq!(exact(mine), exact(&truth));
        let forces =
            direct.total[0].iter().zip(&direct.total[1]).map(|(adhesion, contact)| adhesion + contact);
        let rounding = 2.0 * tolerance * forces.fold(0.0, f64::max);
        // Of the cells in ten spaces between separations.
        let cell = 10.0 * (job.separations[1] - job.separations[0]) / f64::from(1 << 18);
        let external = direct.total[Quantity::ExternalForce.index()].chunks_exact(job.separations.len());
        let rises = external.flat_map(|curve| curve.windows(2)).zip(job.separations.windows(2).cycle());
        let steepest =
            rises.map(|(force, h)| ((force[1] - force[0]) / (h[1] - h[0])).abs()).fold(0.0, f64::max);
        let approach = |replica: &Replica| {
            replica.cycle.as_ref().map_or(f64::NAN, |cycle| cycle.approach_pull_off_force)
        };
        let is_polydisperse = job.laws.family.is_some();
        for force in [|replica: &Replica| replica.pull_off_force, approach] {
            let missed = force(&truth) - force(mine);
            // Of several radii in chunks no kinks are known, so that even places are looked at.
            assert!(is_polydisperse || !(missed > 2.0 * cell * steepest + rounding), "{mine:?}, {truth:?}");
            assert!(!(missed < -rounding - 2.0 * cell * steepest), "{mine:?}, {truth:?}");
        }
        assert_eq!(mine.cycle.is_some(), truth.cycle.is_some());
        let close = |mine: f64, truth: f64| {
            let off = (mine - truth).abs();
            assert!(
                off <= 1e3 * tolerance * truth.abs() || mine.to_bits() == truth.to_bits(),
                "{mine:e} {truth:e}"
            );
        };
        if is_polydisperse {
            assert!(
                mine.peak_secant_stiffness <= truth.peak_secant_stiffness * (1.0 + 1e-9),
                "{mine:?}, {truth:?}"
            );
        } else {
            close(mine.peak_secant_stiffness, truth.peak_secant_stiffness);
        }
        if let (Some(mine), Some(truth)) = (&mine.cycle, &truth.cycle) {
            close(mine.dissipated_energy, truth.dissipated_energy);
            assert_eq!(mine.touchdown_separation.to_bits(), truth.touchdown_separation.to_bits());
            assert_eq!(mine.detachment_separation.to_bits(), truth.detachment_separation.to_bits());
        }
        if job.laws.family.is_none() && mine.cycle.is_none() {
            let mut heights = Vec::new();
            Draws::of(job, index, SMALL).all(&mut heights, &mut Vec::new());
            heights.sort_unstable_by(f64::total_cmp);
            let state = State::Approach(mine.pull_off_separation);
            let force = Sums::new(job.laws.regimes().len()).external_force(job, &heights, state);
            assert!((force + mine.pull_off_force).abs() <= rounding, "{force:e} {mine:?}");
        }
    }

    /// Rounding of sums in another order.
    const ROUNDING: f64 = 1e-13;

    #[test]
    fn a_surface_in_chunks_is_the_one_held_at_once() {
        let surface = surface();
        for (name, step, count) in
            [("hybrid", 0.05, 181), ("emd", 0.1, 91), ("jkr", 0.3, 31), ("gw", 0.1, 91), ("hybrid", 1.0, 10)]
        {
            let law = law(name);
            let separations = separations(&surface, step, count);
            let direct = job(law.as_ref(), &surface, &separations);
            for index in [0, 5] {
                agree(&direct, index, &divided(&direct, index), ROUNDING);
                for tolerance in [1e-6, 1e-9, 1e-12] {
                    let Ok(matrix) = MomentMatrix::new(law.as_ref(), &surface, &separations, tolerance)
                    else {
                        assert_eq!(step, 1.0);
                        continue;
                    };
                    let moments = Job { moments: Some(&matrix), ..direct };
                    agree(&moments, index, &divided(&moments, index), tolerance);
                }
            }
        }
    }

    /// Other laws of heights, with asperities beyond all bins, a Poisson number, given heights, and every
    /// scheme.
    #[test]
    fn every_kind_of_surface_comes_in_chunks() {
        let plain = surface();
        let law = law("hybrid");
        let separations = separations(&plain, 0.1, 91);
        let with = |law| Surface { heights: Heights { law, ..plain.heights.clone() }, ..plain.clone() };
        let mut given = vec![0.0; COUNT];
        plain.heights.draw(
            &mut super::super::stream::stream(3, super::super::stream::Purpose::Heights, 0),
            &mut given,
        );
        let given = Surface { heights: Heights::sample(given), ..plain.clone() };
        let tail = with(HeightLaw::LogNormal(LogNormal::new(1.0)));
        let poisson = Surface { count_law: CountLaw::Poisson, ..plain.clone() };
        let whole = Surface { whole: true, ..given.clone() };
        let independent =
            [&tail, &poisson, &given, &whole].map(|surface| (surface, SamplingScheme::Independent));
        let schemes = [SamplingScheme::Antithetic, SamplingScheme::Stratified].map(|scheme| (&plain, scheme));
        for (surface, scheme) in independent.into_iter().chain(schemes) {
            let direct = Job { scheme, ..job(law.as_ref(), surface, &separations) };
            let matrix = MomentMatrix::new(law.as_ref(), surface, &separations, 1e-9).unwrap();
            let moments = Job { moments: Some(&matrix), ..direct };
            for index in [0, 1] {
                agree(&direct, index, &divided(&direct, index), ROUNDING);
                agree(&moments, index, &divided(&moments, index), 1e-9);
            }
        }
        let beyond = |u: &&f64| **u > 16.0 * tail.heights.std;
        let mut heights = Vec::new();
        Draws::of(&job(law.as_ref(), &tail, &separations), 0, SMALL).all(&mut heights, &mut Vec::new());
        assert!(heights.iter().filter(beyond).count() > 2, "no asperity is beyond the bins");
    }

    /// A surface of so many chunks that it is not held has a pull-off that is less deep by what roots leave
    /// out of what is interpolated between samples, and by the jumps of the asperities of a cell: 3.5 √(Σ n
    /// r²) + Σ n |J| / cells, n asperities that pass a kink in a space between samples, at most, with jump J
    /// and r for its roots.
    #[test]
    fn the_pull_off_of_many_chunks_is_within_its_bound() {
        let surface = surface();
        let law = law("hybrid");
        let separations = separations(&surface, 0.05, 181);
        let job = job(law.as_ref(), &surface, &separations);
        let width = separations[1] - separations[0];
        let per_space = COUNT as f64 * width / (surface.heights.std * (2.0 * std::f64::consts::PI).sqrt());
        let (mut square, mut jumps) = (0.0, 0.0);
        for kink in
            Kink::of(law.as_ref(), width).iter().filter(|kink| kink.interference < surface.heights.std)
        {
            square += per_space * kink.stray.samples.1.powi(2);
            jumps += per_space * kink.jump.abs();
        }
        // As few cells as a space has at least.
        let bound = 3.5 * f64::sqrt(square) + jumps / f64::from(1 << 10);
        let mut largest: f64 = 0.0;
        for index in 0..6 {
            let mut workspace = Workspace::with_chunks(&job, 200);
            let mine = workspace.divided(&job, index, &|| false).unwrap();
            let mut workspace = Workspace::with_chunks(&job, usize::MAX);
            Draws::of(&job, index, 200).all(&mut workspace.heights[0], &mut workspace.radii);
            workspace.sum(&job, 1);
            let missed = workspace.keep(&job, 0).pull_off_force - mine.pull_off_force;
            assert!(missed >= -1e-12 * mine.pull_off_force && missed <= bound, "{missed:e} {bound:e}");
            largest = largest.max(missed / mine.pull_off_force);
        }
        println!("missed by {largest:.1e} of the pull-off at most, bound {bound:.1e} N");
    }

    #[test]
    fn scattered_radii_come_in_chunks() {
        let surface = Surface { radii: Radii::LogNormal(0.3), ..surface() };
        let family = Family::new(model("hybrid").unwrap(), CASE_II, Path::Approach, RADIUS_RANGE).unwrap();
        let law = SurfaceLaws { typical: law("hybrid"), family: Some(family) };
        let separations = separations(&surface, 0.5, 15);
        let job = job(law.view(), &surface, &separations);
        agree(&job, 1, &divided(&job, 1), ROUNDING);
        let cycle = Loop::new(&model("hybrid").unwrap(), &parameters(), UnloadedRadius::Kept).unwrap();
        let protocol = Protocol { cycle: Some(&cycle), ..job.protocol };
        let job = Job { protocol, ..job };
        agree(&job, 1, &divided(&job, 1), ROUNDING);
    }

    /// Loops, their snaps, and turns at preloads of which one is never reached.
    #[test]
    fn loops_come_in_chunks() {
        let surface = surface();
        let cycle = Loop::new(&model("hybrid").unwrap(), &parameters(), UnloadedRadius::Kept).unwrap();
        let separations = separations(&surface, 0.1, 81);
        let [stiffness, preload] = [[1e5, 1e6], [1e-4, 1e3]];
        for preload in [&preload[..], &[]] {
            let loading = Loading { stiffness: &stiffness, preload, smallest_snap: 0.0, ways: (true, true) };
            let protocol = Protocol { cycle: Some(&cycle), loading, ..Protocol::default() };
            let job = Job { protocol, ..job(cycle.approach(), &surface, &separations) };
            let (mine, truth) = (divided(&job, 0), held(&job, 0));
            agree(&job, 0, &mine, ROUNDING);
            assert_eq!(mine.1.snaps.len(), loading.length());
            for (mine, truth) in mine.1.snaps.iter().zip(&truth.1.snaps) {
                let off = (mine - truth).abs();
                assert!(off <= 1e-9 * truth.abs() || mine.to_bits() == truth.to_bits(), "{mine:e} {truth:e}");
            }
        }
    }

    /// Bits on 1, 2, 3 and 8 threads, and what it cost.
    #[test]
    fn threads_do_not_matter() {
        let surface = surface();
        let law = law("hybrid");
        let separations = separations(&surface, 0.1, 91);
        let direct = job(law.as_ref(), &surface, &separations);
        let matrix = MomentMatrix::new(law.as_ref(), &surface, &separations, 1e-9).unwrap();
        for job in [direct, Job { moments: Some(&matrix), ..direct }] {
            let on = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let mut workspace = Workspace::with_chunks(&job, SMALL);
                    let kept = workspace.divided(&job, 3, &|| false).unwrap();
                    (format!("{kept:?}"), workspace.curves.remove(0), workspace.sums.stats)
                })
            };
            let one = on(1);
            for threads in [2, 3, 8] {
                assert_eq!(on(threads), one, "{threads} threads");
            }
        }
    }

    /// Whenever it is ended, nothing of the replica at hand is visited, those before it are, and no chunk is
    /// begun any more.
    #[test]
    fn a_surface_in_chunks_can_be_ended() {
        let surface = surface();
        let law = law("hybrid");
        let separations = separations(&surface, 0.5, 19);
        let job = job(law.as_ref(), &surface, &separations);
        let looks = |most: usize| {
            let (looked, mut visited) = (AtomicUsize::new(0), 0);
            let ends = || looked.fetch_add(1, Ordering::Relaxed) >= most;
            let all =
                Workspace::with_chunks(&job, SMALL).replicas_until(&job, 0..2, &ends, |_, _| visited += 1);
            (all, visited, looked.into_inner())
        };
        let (all, visited, needed) = looks(usize::MAX);
        assert_eq!((all, visited), (true, 2));
        assert!(needed > 2 * COUNT / SMALL, "{needed}");
        for most in [0, 1, 3, needed / 2 - 1] {
            assert!(!looks(most).0, "{most}");
            assert_eq!(looks(most).1, 0, "{most}");
        }
        assert_eq!(looks(needed / 2 + 3).1, 1);
        assert!(!looks(needed - 1).0);
    }
}
