//! `stiction run`: from a scene to a checked file and a summary.

use super::checkpoint::{Beginning, Keeper, State, beginning};
use super::record::{write_curves, write_head, write_results};
use super::results::{Results, Stopped, integral_features, mean_features};
use super::sampling::{Sampling, basis_of, cross_check, interruption, override_ensemble, thread_pool};
use super::summary::summary;
use super::{Failure, RunArguments, law_of, print_of, read_scene, refuse_own_scene, resources, warnings_of};
use crate::asperity::{Law, Quantity};
use crate::engine::{Ensemble, Outcome, Rule};
use crate::math::control_variates::controlled_means;
use crate::output::progress::Progress;
use crate::output::schema::RUN;
use crate::output::writer::Writer;
use crate::output::{Claim, OutputError};
use crate::scene::{Plan, Scene, Sizes};
use crate::statistical::{Statistical, controls};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let stop = interruption()?;
    let mut scene = read_scene(&arguments.scene)?;
    override_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    };
    let law = law_of(&scene, &scene.model, &arguments.scene)?;
    let law = law.as_ref();
    refuse_own_scene(&arguments.scene, &output)?;
    let claim = Claim::new(&output)?;
    let pool = thread_pool(arguments.execution.threads)?;
    let sizes = Sizes::new(&scene, law, pool.current_num_threads());
    // What an interrupted run has kept is on the disk already.
    let begins = !claim.beside(".checkpoint").exists();
    resources::require(&arguments.scene, &sizes, begins.then_some(output.as_path()))?;
    let interrupted = match beginning(&claim, &scene, arguments)? {
        Beginning::Complete => {
            eprintln!("{} is complete: nothing to resume", output.display());
            return Ok(());
        }
        Beginning::Anew => None,
        Beginning::Resumed(run) => Some(run),
    };
    let mut progress = Progress::new(arguments.execution.quiet);

    progress.phase("integral");
    let plan = Plan::new(&scene, law);
    let warnings = warnings_of(&scene, &scene.model, law);
    let statistical = pool.install(|| Statistical::new(law, &scene.surface, &scene.separations));
    progress.phase("test functionals");
    let state = interrupted.as_ref().map_or_else(|| prepared(&scene, law, &statistical), |run| run.state().clone());
    let State { basis, controls, .. } = state.clone();
    let expected = &statistical.expected[Quantity::ExternalForce.index()];
    let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
    let stopping = scene.stopping.clone();
    let rule = stopping.as_ref().map(|stopping| Rule { stopping, expected: &expected });
    let setup = Sampling { scene: &scene, law, basis: &basis, controls: &controls, rule, keep_curves: scene.curves };
    let job = setup.job();
    let (mut keeper, start) = match interrupted {
        Some(run) => Keeper::resume(*run, &job, arguments.checkpoint)?,
        None => (Keeper::begin(&claim, &scene, state, arguments.checkpoint)?, Ensemble::new(&job)),
    };
    let computed =
        setup.run("ensemble", &pool, &stop, &mut progress, start, |batch, ensemble| keeper.keep(&job, batch, ensemble));
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
    let (z, joint) = cross_check(&ensemble, &statistical, &basis, &scene);
    let scalars = controlled_means(&ensemble.groups.scalars, &expected);
    let of_mean = mean_features(&scene, law, &ensemble, &statistical);
    let of_integral = integral_features(&scene, law, &statistical);
    progress.end();
    let mut seconds = progress.seconds();
    seconds.iter_mut().filter(|(name, _)| *name == "ensemble").for_each(|(_, time)| *time += keeper.seconds_before);
    progress.phase("writing");
    let regimes = law.regimes().iter().map(|regime| regime.name()).collect();
    let threads = pool.current_num_threads();
    let results = Results {
        scene,
        plan,
        warnings,
        regimes,
        statistical,
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
        threads,
        resumptions: keeper.resumptions,
        checkpoints: keeper.journal.cost(),
        output,
    };
    let written = write(&claim, arguments.execution.force, &results, &mut keeper, &stop);
    let failure = match written {
        Ok(true) => {
            keeper.journal.discard();
            progress.end();
            return print_of(&results.output, &summary(&results));
        }
        Ok(false) => None,
        Err(error) => Some(Failure::from(error.writing(&results.output))),
    };
    // What was computed may fit where the result does not.
    let kept = keeper.save(&results.ensemble);
    match failure {
        Some(failure) => Err(keeper.advised(failure)),
        None => Err(kept.map_or_else(Failure::from, |()| keeper.interrupted(most))),
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(scene: &Scene, law: &dyn Law, statistical: &Statistical) -> State {
    let basis = basis_of(scene, law);
    let groups = scene.fewest_replicas() / scene.sampling.group();
    let controls = controls(&scene.separations, statistical, &basis.tested[1], groups);
    State::new(basis, controls, scene.fewest_replicas())
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
