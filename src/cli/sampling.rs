//! What `run` and `compare` do alike: threads, interruptions, the ensemble of a scene under a law, and its cross-check.

use super::Failure;
use crate::asperity::{Law, Quantity};
use crate::engine::{Batch, Ensemble, Job, Outcome, Summation};
use crate::output::OutputError;
use crate::output::progress::Progress;
use crate::scene::Scene;
use crate::statistical::Statistical;
use crate::surface::SamplingScheme;
use crate::validation::{Basis, JointTest, basis_to, z_scores};
use anyhow::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The ensemble of a scene under a law.
pub(super) struct Sampling<'a> {
    pub scene: &'a Scene,
    pub law: &'a dyn Law,
    pub basis: &'a Basis,
    /// Indices of the separations of the control variates.
    pub controls: &'a [usize],
    pub keep_curves: bool,
}

impl Sampling<'_> {
    /// Sums all replicas, with progress under `name`; `observe` gets every batch in order. Also tells how they were summed.
    pub fn run(
        &self,
        name: &'static str,
        pool: &rayon::ThreadPool,
        stop: &AtomicBool,
        progress: &mut Progress,
        mut observe: impl FnMut(&Batch) -> Result<(), OutputError>,
    ) -> Result<(Box<Ensemble>, Summation), Failure> {
        let Self { scene, law, basis, controls, keep_curves } = *self;
        let job = Job {
            law,
            surface: &scene.surface,
            separations: &scene.separations,
            seed: scene.seed,
            scheme: scene.sampling,
            replicas: scene.replicas,
            probes: &basis.probes,
            controls,
            keep_curves,
            compression: None,
        };
        let summation = match scene.sum_tolerance {
            Some(tolerance) => pool.install(|| Summation::compressed(&job, tolerance)),
            None => Summation::direct(),
        };
        let job = Job { compression: summation.compression.as_ref(), ..job };
        progress.replicas(name, scene.replicas);
        let outcome = crate::engine::run(&job, pool, stop, |batch| {
            observe(batch)?;
            progress.advance(batch.ensemble.replicas.len() as u64);
            Ok::<(), OutputError>(())
        })?;
        match outcome {
            Outcome::Complete(ensemble) => Ok((ensemble, summation)),
            Outcome::Interrupted { replicas } => {
                progress.end();
                Err(Failure::Interrupted { done: replicas, of: scene.replicas })
            }
        }
    }
}

/// Puts what the command line says of the ensemble in the place of what the scene says.
pub(super) fn override_ensemble(scene: &mut Scene, replicas: Option<u64>, seed: Option<u64>) -> Result<(), Failure> {
    if let Some(replicas) = replicas {
        let refused = |problem| Failure::Usage(format!("--replicas {replicas}: {problem}"));
        scene.sampling.check(replicas).map_err(refused)?;
        scene.replicas = replicas;
    }
    scene.seed = seed.unwrap_or(scene.seed);
    Ok(())
}

/// So many threads, or one per core.
pub(super) fn thread_pool(count: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let mut threads = rayon::ThreadPoolBuilder::new();
    if let Some(count) = count {
        threads = threads.num_threads(usize::from(count));
    }
    Ok(threads.build().context("cannot start threads")?)
}

/// A flag that the first interruption sets; a second one ends the program at once.
pub(super) fn interruption() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(handler).context("cannot handle interruptions")?;
    Ok(stop)
}

/// The functionals of the joint test of a scene under a law, for the sums that it asks for.
pub(super) fn basis_of(scene: &Scene, law: &dyn Law) -> Basis {
    let accuracy = scene.sum_tolerance.unwrap_or(0.0);
    basis_to(law, &scene.surface, &scene.separations, scene.sampling, scene.replicas, accuracy)
}

/// z-scores of adhesion force and external force, and the joint test.
pub(super) fn cross_check(
    ensemble: &Ensemble,
    statistical: &Statistical,
    basis: &Basis,
    scene: &Scene,
) -> ([Vec<f64>; 2], JointTest) {
    let forces = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    let mean = forces.map(|q| ensemble.curves[q].mean());
    let expected = forces.map(|q| statistical.expected[q].as_slice());
    let groups = scene.replicas / scene.sampling.group();
    let z = [0, 1].map(|i| match scene.sampling {
        SamplingScheme::Independent => z_scores(mean[i], expected[i], &statistical.std[forces[i]], groups),
        _ => z_scores(mean[i], expected[i], &ensemble.groups.curves[forces[i]].std(), groups),
    });
    let joint = JointTest::new(&basis.probes, mean, expected, &ensemble.groups.scores.covariance(), groups);
    (z, joint)
}
