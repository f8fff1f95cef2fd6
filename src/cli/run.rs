//! `stiction run`: from a scene to a checked file and a summary.

use super::record::{write_head, write_results};
use super::summary::summary;
use super::{Failure, RunArguments, print, read_scene};
use crate::asperity::{Law, Quantity};
use crate::engine::{Ensemble, Job, Outcome};
use crate::math::extrema::Features;
use crate::math::interpolation::lagrange;
use crate::output::OutputError;
use crate::output::progress::Progress;
use crate::output::writer::RunWriter;
use crate::scene::{Plan, Scene};
use crate::statistical::{Statistical, external_force};
use crate::validation::{Basis, JointTest, basis, z_scores};
use anyhow::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Everything that a run has found out.
pub(super) struct Results {
    pub scene: Scene,
    pub plan: Plan,
    pub regimes: Vec<&'static str>,
    pub statistical: Statistical,
    pub ensemble: Box<Ensemble>,
    pub basis: Basis,
    /// What is read off the mean curve of the external force, and off the integral's.
    pub of_mean: Features,
    pub of_integral: Features,
    /// z-scores of adhesion force and external force.
    pub z: [Vec<f64>; 2],
    pub joint: JointTest,
    pub seconds: Vec<(&'static str, f64)>,
    pub threads: usize,
    pub output: PathBuf,
}

impl Results {
    /// The mean curve of a quantity.
    pub fn mean(&self, quantity: Quantity) -> &[f64] {
        self.ensemble.curves[quantity.index()].mean()
    }
}

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let mut scene = read_scene(&arguments.scene)?;
    scene.replicas = arguments.replicas.unwrap_or(scene.replicas);
    scene.seed = arguments.seed.unwrap_or(scene.seed);
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    };
    let mut writer = RunWriter::create(&output, arguments.force)?;
    let mut threads = rayon::ThreadPoolBuilder::new();
    if let Some(count) = arguments.threads {
        threads = threads.num_threads(usize::from(count));
    }
    let pool = threads.build().context("cannot start threads")?;
    let stop = interruption()?;
    let mut progress = Progress::new(arguments.quiet);

    progress.phase("integral");
    let law = scene.law();
    let plan = Plan::new(&scene, law.as_ref());
    let statistical = pool.install(|| Statistical::new(law.as_ref(), &scene.surface, &scene.separations));
    progress.phase("test functionals");
    let basis = basis(law.as_ref(), &scene.surface, &scene.separations, scene.replicas);
    let regimes = write_head(&mut writer, &scene, &plan, law.as_ref(), &basis)?;
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
    let (of_mean, of_integral) = features(&scene, law.as_ref(), &ensemble, &statistical);
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

/// A flag that the first interruption sets; a second one ends the program at once.
fn interruption() -> Result<Arc<AtomicBool>, Failure> {
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

/// Pull-off and stiffest point of the mean curve and of the integral. The integral is solved where it is asked for; the mean curve is
/// known at the separations only, so between them its deviation from the integral, which is small, is interpolated.
fn features(scene: &Scene, law: &dyn Law, ensemble: &Ensemble, statistical: &Statistical) -> (Features, Features) {
    let q = Quantity::ExternalForce.index();
    let (mean, expected) = (ensemble.curves[q].mean(), statistical.expected[q].as_slice());
    let deviation: Vec<f64> = mean.iter().zip(expected).map(|(m, e)| m - e).collect();
    let integral = |h: f64| external_force(law, &scene.surface, h);
    let of_mean = |h: f64| integral(h) + lagrange(&scene.separations, &deviation, h);
    (Features::new(of_mean, &scene.separations, mean), Features::new(integral, &scene.separations, expected))
}

fn cross_check(
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
