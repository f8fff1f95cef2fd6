//! The ensemble of a scene under a law, and its cross-check.

use super::observer::Phases;
use super::workers::Workers;
use crate::asperity::{Laws, Loop, Quantity, SurfaceLoops};
use crate::engine::{
    Batch, Bounds, Ensemble, Job, Loading, Outcome, Protocol, ReductionTree, Rule, Substrate, Summation,
    Ways, run_from,
};
use crate::error::{Error, OutputError};
use crate::integral::Expectations;
use crate::scene::{self, Instability, Scene, Sums};
use crate::surface::SamplingScheme;
use crate::validation::{Basis, Draws, JointTest, basis_of_loop, basis_of_retraction, basis_to, z_scores};

/// The ensemble of a scene under a law.
pub(crate) struct Sampling<'a> {
    pub scene: &'a Scene,
    pub law: Laws<'a>,
    /// The loop of which the law is the approach, if surfaces are pulled back.
    pub cycle: Option<&'a Loop>,
    /// The loops that coupled asperities remember their histories by.
    pub memory: Option<&'a SurfaceLoops>,
    /// Largest error of a pull-off of coupled asperities between separations, relative to it.
    pub pull_off_tolerance: f64,
    /// Indices of the states of the control variates.
    pub controls: &'a [usize],
    /// The rule that ends it before all replicas of the scene are in.
    pub rule: Option<Rule<'a>>,
    pub keep_curves: bool,
}

impl Sampling<'_> {
    /// The job, summed directly.
    pub fn job(&self) -> Job<'_> {
        Job {
            laws: self.law,
            surface: &self.scene.surface,
            separations: &self.scene.separations,
            seed: self.scene.seed,
            scheme: self.scene.sampling,
            replicas: self.scene.replicas,
            controls: self.controls,
            keep_curves: self.keep_curves,
            moments: None,
            protocol: Protocol {
                cycle: self.cycle,
                only_back: self.scene.ways() == Ways::Back,
                loading: loading(self.scene),
                substrate: self.scene.substrate.as_ref().map(|substrate| self.substrate(substrate)),
                stiffness_span: Some(self.scene.stiffness_span),
            },
        }
    }

    fn substrate<'a>(&'a self, substrate: &'a scene::Substrate) -> Substrate<'a> {
        let scene::Substrate { coupling, kernel, places, tolerance, loads_at, .. } = substrate;
        Substrate {
            coupling: *coupling,
            places,
            kernel: *kernel,
            tolerance: *tolerance,
            pull_off_tolerance: self.pull_off_tolerance,
            loads_at,
            reduced_modulus: self.scene.asperity.reduced_modulus,
            memory: self.memory,
            length: self.scene.scale().length,
            energy: (!self.scene.model.is_wet()).then(|| self.scene.scale().energy()),
        }
    }

    /// The summation of the replicas.
    pub fn summation(&self, pool: &rayon::ThreadPool) -> Summation {
        match self.scene.sum_tolerance() {
            // On replicas that are in the result wherever it ends.
            Some(tolerance) if self.scene.replicas > 0 => {
                let job = Job { replicas: self.scene.fewest_replicas(), ..self.job() };
                let tried = pool.install(|| Summation::by_moments(&job, tolerance));
                let is_asked = self.scene.sums.is_some_and(|(sums, _)| sums == Sums::Moments);
                if tried.matrix.is_some() || is_asked { tried } else { Summation::direct() }
            }
            _ => Summation::direct(),
        }
    }

    /// Sums the replicas that `start` does not have yet, as the last phase that has begun; `observe` gets
    /// every batch in order, with the tree that it has been merged into.
    pub fn run(
        &self,
        summation: &Summation,
        workers: &Workers,
        phases: &mut Phases<'_>,
        start: ReductionTree,
        mut observe: impl FnMut(&Batch, &mut ReductionTree) -> Result<(), OutputError>,
    ) -> Result<Outcome, OutputError> {
        let job = Job { moments: summation.matrix.as_ref(), ..self.job() };
        let outcome = run_from(
            &job,
            &workers.pool,
            &workers.stop,
            Bounds { merged: start, rule: self.rule },
            |batch, merged| {
                observe(batch, merged)?;
                phases.advance(batch.ensemble.replicas.len() as u64);
                Ok::<(), OutputError>(())
            },
        )?;
        phases.end();
        Ok(outcome)
    }

    /// Sums all replicas, of which nothing is kept on the way, as the last phase that has begun; `observe` gets every batch in
    /// order.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn run_whole(
        &self,
        workers: &Workers,
        phases: &mut Phases<'_>,
        mut observe: impl FnMut(&Batch) -> Result<(), OutputError>,
    ) -> Result<(Box<ReductionTree>, Summation), Error> {
        let (start, summation) = (ReductionTree::of(&self.job()), self.summation(&workers.pool));
        match self.run(&summation, workers, phases, start, |batch, _| observe(batch))? {
            Outcome::Complete(reduction_tree) => Ok((reduction_tree, summation)),
            Outcome::Interrupted(reduction_tree) => {
                let done = reduction_tree.replicas.len() as u64;
                Err(Error::Interrupted { done, of: self.scene.replicas, kept: false })
            }
        }
    }
}

/// Puts another number of replicas and another seed, if given, in the place of the scene's.
///
/// # Errors
/// [`Error::Replicas`] when the scene cannot have this number.
pub(crate) fn set_ensemble(scene: &mut Scene, replicas: Option<u64>, seed: Option<u64>) -> Result<(), Error> {
    if let Some(replicas) = replicas {
        scene.check_replicas(replicas).map_err(|problem| Error::Replicas { replicas, problem })?;
        (scene.replicas, scene.stopping) = (replicas, None);
    }
    scene.seed = seed.unwrap_or(scene.seed);
    Ok(())
}

/// The springs and preloads of a scene.
pub(crate) fn loading(scene: &Scene) -> Loading<'_> {
    let ways = (scene.ways() != Ways::Back, scene.turns());
    let Instability { stiffness, preload, smallest_snap } = &scene.instability;
    let kept = if scene.curves && !preload.is_empty() { scene.separations.len() } else { 0 };
    Loading { stiffness, preload, smallest_snap: *smallest_snap, ways, kept }
}

/// The functionals of the joint test of a scene under a law, for the sums that it asks for and the fewest
/// replicas that it may have.
pub(crate) fn basis_of(scene: &Scene, law: Laws<'_>, cycle: Option<&Loop>) -> Basis {
    let Scene { surface, separations, .. } = scene;
    let draws = Draws { scheme: scene.sampling, replicas: scene.fewest_replicas() };
    match cycle {
        Some(cycle) if scene.ways() == Ways::Back => basis_of_retraction(cycle, surface, separations, draws),
        Some(cycle) => basis_of_loop(law, cycle, surface, separations, draws),
        None => basis_to(law, surface, separations, draws, scene.sum_tolerance().unwrap_or(0.0)),
    }
}

/// z-scores of adhesion force and external force over the states, and the joint test; of a loop `ways` are
/// the integrals of both.
pub(crate) fn cross_check(
    ensemble: &Ensemble,
    ways: &[&Expectations],
    basis: &Basis,
    scene: &Scene,
) -> ([Vec<f64>; 2], JointTest) {
    let forces = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    let mean = forces.map(|q| ensemble.independent()[q].mean());
    let joined = |of: fn(&Expectations, usize) -> &Vec<f64>| {
        forces.map(|q| ways.iter().flat_map(|way| of(way, q).iter().copied()).collect::<Vec<f64>>())
    };
    let (expected, std) = (joined(|way, q| &way.expected[q]), joined(|way, q| &way.std[q]));
    let expected = [0, 1].map(|i| expected[i].as_slice());
    let groups = scene.replicas / scene.sampling.group();
    let z = [0, 1].map(|i| match scene.sampling {
        SamplingScheme::Independent => z_scores(mean[i], expected[i], &std[i], groups),
        _ => z_scores(mean[i], expected[i], &ensemble.independent_groups()[forces[i]].std(), groups),
    });
    let joint = JointTest::new(&basis.probes, mean, expected, basis.cumulants, scene.replicas);
    (z, joint)
}
