//! `stiction run`: from a scene to a checked file and a summary.

use super::record::{write_head, write_results};
use super::results::{Results, integral_features, mean_features};
use super::summary::summary;
use super::{Failure, RunArguments, law_of, print, read_scene, refuse_own_scene};
use crate::asperity::Quantity;
use crate::engine::{Ensemble, Job, Outcome};
use crate::output::OutputError;
use crate::output::progress::Progress;
use crate::output::schema::RUN;
use crate::output::writer::Writer;
use crate::scene::Plan;
use crate::statistical::Statistical;
use crate::validation::{Basis, JointTest, basis, z_scores};
use anyhow::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let mut scene = read_scene(&arguments.scene)?;
    scene.replicas = arguments.replicas.unwrap_or(scene.replicas);
    scene.seed = arguments.seed.unwrap_or(scene.seed);
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    };
    let law = law_of(&scene, &scene.model, &arguments.scene)?;
    refuse_own_scene(&arguments.scene, &output)?;
    let mut writer = Writer::create(&RUN, &output, arguments.force)?;
    let pool = thread_pool(arguments.threads)?;
    let stop = interruption()?;
    let mut progress = Progress::new(arguments.quiet);

    progress.phase("integral");
    let plan = Plan::new(&scene, law.as_ref());
    let statistical = pool.install(|| Statistical::new(law.as_ref(), &scene.surface, &scene.separations));
    progress.phase("test functionals");
    let basis = basis(law.as_ref(), &scene.surface, &scene.separations, scene.replicas);
    let regimes = write_head(&mut writer, &scene, law.as_ref(), &basis)?;
    let job = Job {
        law: law.as_ref(),
        surface: &scene.surface,
        separations: &scene.separations,
        seed: scene.seed,
        replicas: scene.replicas,
        probes: &basis.probes,
        keep_curves: scene.curves,
    };
    progress.replicas("ensemble", scene.replicas);
    let mut done = 0;
    let outcome = crate::engine::run(&job, &pool, &stop, |batch| -> Result<(), OutputError> {
        if job.keep_curves {
            writer.curves("/replicas/external_force", done, &batch.external_force)?;
            writer.curves("/replicas/adhesion_force", done, &batch.adhesion_force)?;
        }
        done += batch.ensemble.replicas.len();
        progress.advance(batch.ensemble.replicas.len() as u64);
        Ok(())
    })?;
    let ensemble = match outcome {
        Outcome::Complete(ensemble) => ensemble,
        Outcome::Interrupted { replicas } => {
            progress.end();
            return Err(Failure::Interrupted { done: replicas, of: scene.replicas });
        }
    };

    progress.phase("cross-check");
    let (z, joint) = cross_check(&ensemble, &statistical, &basis, scene.replicas);
    let of_mean = mean_features(&scene, law.as_ref(), &ensemble, &statistical);
    let of_integral = integral_features(&scene, law.as_ref(), &statistical);
    progress.end();
    let seconds = progress.seconds();
    progress.phase("writing");
    let threads = pool.current_num_threads();
    let results = Results {
        scene,
        plan,
        regimes,
        statistical,
        ensemble,
        basis,
        of_mean,
        of_integral,
        z,
        joint,
        seconds,
        threads,
        output,
    };
    write_results(&mut writer, &results)?;
    writer.finish()?;
    progress.end();
    print(&summary(&results));
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

pub(super) fn cross_check(
    ensemble: &Ensemble,
    statistical: &Statistical,
    basis: &Basis,
    replicas: u64,
) -> ([Vec<f64>; 2], JointTest) {
    let forces = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    let mean = forces.map(|q| ensemble.curves[q].mean());
    let expected = forces.map(|q| statistical.expected[q].as_slice());
    let z = [0, 1].map(|i| z_scores(mean[i], expected[i], &statistical.std[forces[i]], replicas));
    let joint = JointTest::new(&basis.probes, mean, expected, &ensemble.scores.covariance(), replicas);
    (z, joint)
}
