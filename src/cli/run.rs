//! `stiction run` of one scene: from there to a checked file and a summary.

use super::checkpoint::{Beginning, Keeper, Manner, State, beginning};
use super::record::{write_curves, write_head, write_results};
use super::results::{Results, Stopped, WayBack, integral_features, mean_features};
use super::sampling::{Sampling, basis_of, cross_check, interruption, override_ensemble, thread_pool};
use super::summary::summary;
use super::{
    Execution, Failure, RunArguments, law_of, loop_of, print_of, read_document, refuse_own_scene, resources, sweep,
    warnings_of,
};
use crate::asperity::{Law, Loop, Quantity};
use crate::engine::{Batch, Ensemble, Outcome, Rule};
use crate::math::control_variates::controlled_means;
use crate::output::progress::Progress;
use crate::output::schema::RUN;
use crate::output::writer::Writer;
use crate::output::{Claim, OutputError};
use crate::scene::{Document, Plan, Scene, Sizes};
use crate::statistical::{Statistical, controls};
use rayon::ThreadPool;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// What the runs of a command have in common.
pub(super) struct Session {
    /// Set by an interruption.
    pub stop: Arc<AtomicBool>,
    /// The threads that compute.
    pub pool: ThreadPool,
    /// How often what has been done is kept.
    pub interval: Duration,
    /// Whether there is no progress.
    pub quiet: bool,
}

impl Session {
    /// Of the arguments of a command.
    pub fn new(execution: &Execution, interval: Duration) -> Result<Self, Failure> {
        let stop = interruption()?;
        Ok(Self { stop, pool: thread_pool(execution.threads)?, interval, quiet: execution.quiet })
    }
}

/// One scene and where its result goes.
pub(super) struct Task<'a> {
    /// The file of the scene, for messages.
    pub source: &'a Path,
    /// The output, as the user names it.
    pub output: &'a Path,
    /// The claim on it.
    pub claim: &'a Claim,
    /// What may become of what is there.
    pub manner: Manner,
}

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let Document { mut scene, sweep } = read_document(&arguments.scene)?;
    if let Some(sweep) = sweep {
        return sweep::run(&sweep, arguments);
    }
    override_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    let output = output_of(arguments);
    refuse_own_scene(&arguments.scene, &output)?;
    let session = Session::new(&arguments.execution, arguments.checkpoint)?;
    let claim = Claim::new(&output)?;
    let manner = Manner { resume: arguments.resume, force: arguments.execution.force };
    let task = Task { source: &arguments.scene, output: &output, claim: &claim, manner };
    match run_scene(scene, &task, &session, Progress::new(session.quiet))? {
        Some(results) => print_of(&output, &summary(&results)),
        None => {
            eprintln!("{} is complete: nothing to resume", output.display());
            Ok(())
        }
    }
}

/// The output that the arguments name, or that of the scene's name.
pub(super) fn output_of(arguments: &RunArguments) -> PathBuf {
    match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    }
}

/// Computes a scene into its output; what it has found out, or none where the output was complete before.
///
/// # Errors
/// [`Failure`]; what has been done is kept beside the output, for a run that resumes it.
pub(super) fn run_scene(
    mut scene: Scene,
    task: &Task<'_>,
    session: &Session,
    mut progress: Progress,
) -> Result<Option<Box<Results>>, Failure> {
    let (claim, pool) = (task.claim, &session.pool);
    let law = law_of(&scene, &scene.model, task.source)?;
    let law = law.as_ref();
    let cycle = loop_of(&scene, task.source)?;
    let cycle = cycle.as_ref();
    let sizes = Sizes::new(&scene, law, pool.current_num_threads());
    // What an interrupted run has kept is on the disk already.
    let begins = !claim.beside(".checkpoint").exists();
    resources::require(task.source, &sizes, begins.then_some(task.output))?;
    let interrupted = match beginning(claim, &scene, task.manner)? {
        Beginning::Complete => return Ok(None),
        Beginning::Anew => None,
        Beginning::Resumed(run) => Some(run),
    };

    progress.phase("integral");
    let plan = Plan::new(&scene, law);
    let warnings = warnings_of(&scene, &scene.model, law);
    let statistical = pool.install(|| Statistical::new(law, &scene.surface, &scene.separations));
    let back = cycle.map(|cycle| pool.install(|| Statistical::way_back(cycle, &scene.surface, &scene.separations)));
    progress.phase("test functionals");
    let state = interrupted
        .as_ref()
        .map_or_else(|| prepared(&scene, (law, cycle), (&statistical, back.as_ref())), |run| run.state().clone());
    let State { basis, controls, .. } = state.clone();
    let ways: Vec<&Statistical> = [&statistical].into_iter().chain(&back).collect();
    let force = |way: &&Statistical| way.expected[Quantity::ExternalForce.index()].clone();
    let expected: Vec<f64> = ways.iter().flat_map(force).collect();
    let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
    let stopping = scene.stopping.clone();
    let rule = stopping.as_ref().map(|stopping| Rule { stopping, expected: &expected });
    let keep_curves = scene.curves;
    let setup = Sampling { scene: &scene, law, cycle, basis: &basis, controls: &controls, rule, keep_curves };
    let job = setup.job();
    let (mut keeper, start) = match interrupted {
        Some(run) => Keeper::resume(*run, &job, session.interval)?,
        None => (Keeper::begin(claim, &scene, state, session.interval)?, Ensemble::new(&job)),
    };
    let observe = |batch: &Batch, ensemble: &Ensemble| keeper.keep(&job, batch, ensemble);
    let computed = setup.run("ensemble", pool, &session.stop, &mut progress, start, observe);
    let (outcome, summation) = computed.map_err(|failure| keeper.advised(failure))?;
    let ensemble = match outcome {
        Outcome::Complete(ensemble) => ensemble,
        Outcome::Interrupted(ensemble) => {
            keeper.save(&ensemble)?;
            return Err(keeper.interrupted(scene.replicas));
        }
    };

    let stopped = rule.map(|rule| Stopped::new(&rule, &ensemble));
    // From here on the scene is that of the replicas that there are.
    scene.stopping = None;
    let most = std::mem::replace(&mut scene.replicas, ensemble.replicas.len() as u64);

    progress.phase("cross-check");
    let (z, joint) = cross_check(&ensemble, &ways, &basis, &scene);
    let scalars = controlled_means(&ensemble.groups.scalars, &expected);
    let of_mean = mean_features(&scene, law, &ensemble, &statistical);
    let of_integral = integral_features(&scene, law, &statistical);
    let back = cycle.zip(back).map(|(cycle, statistical)| WayBack::new(&scene, cycle, &ensemble, statistical));
    progress.end();
    let mut seconds = progress.seconds();
    seconds.iter_mut().filter(|(name, _)| *name == "ensemble").for_each(|(_, time)| *time += keeper.seconds_before);
    let results = Results {
        regimes: law.regimes().iter().map(|regime| regime.name()).collect(),
        scene,
        plan,
        warnings,
        statistical,
        back,
        ensemble,
        stopped,
        summation,
        basis,
        controls,
        scalars,
        of_mean,
        of_integral,
        z,
        joint,
        seconds,
        threads: pool.current_num_threads(),
        resumptions: keeper.resumptions,
        checkpoints: keeper.journal.cost(),
        output: task.output.to_owned(),
    };
    progress.phase("writing");
    let written = complete(results, most, keeper, task, session);
    progress.end();
    written.map(Some)
}

/// Brings the results into their file, after which nothing is kept beside it; or keeps what was computed, of `most` replicas.
fn complete(
    results: Results,
    most: u64,
    mut keeper: Keeper,
    task: &Task<'_>,
    session: &Session,
) -> Result<Box<Results>, Failure> {
    let failure = match write(task.claim, task.manner.force, &results, &mut keeper, &session.stop) {
        Ok(true) => {
            keeper.journal.discard();
            return Ok(Box::new(results));
        }
        Ok(false) => None,
        Err(error) => Some(Failure::from(error.writing(task.output))),
    };
    // What was computed may fit where the result does not.
    let kept = keeper.save(&results.ensemble);
    match failure {
        Some(failure) => Err(keeper.advised(failure)),
        None => Err(kept.map_or_else(Failure::from, |()| keeper.interrupted(most))),
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(
    scene: &Scene,
    (law, cycle): (&dyn Law, Option<&Loop>),
    (there, back): (&Statistical, Option<&Statistical>),
) -> State {
    let basis = basis_of(scene, law, cycle);
    let groups = scene.fewest_replicas() / scene.sampling.group();
    // Of a loop the way on which the surfaces are pulled off.
    let first = back.map_or(0, |_| scene.separations.len());
    let controls = controls(&scene.separations, back.unwrap_or(there), &basis.tested[1][first..], groups);
    State::new(basis, controls.into_iter().map(|place| first + place).collect(), scene.fewest_replicas())
}

/// Writes the result; `false` if it was interrupted before it was complete, and then is not there.
fn write(
    claim: &Claim,
    overwrite: bool,
    results: &Results,
    keeper: &mut Keeper,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    let mut writer = Writer::create(&RUN, claim, overwrite)?;
    write_head(&mut writer, results)?;
    if results.scene.curves {
        write_curves(&writer, results, &mut keeper.journal, stop)?;
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(false);
    }
    write_results(&mut writer, results)?;
    writer.finish()?;
    Ok(true)
}
