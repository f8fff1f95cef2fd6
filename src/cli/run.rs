//! `stiction run`: from a scene to a checked file and a summary.

use super::checkpoint::{Beginning, Keeper, State, beginning};
use super::record::{write_curves, write_head, write_results};
use super::results::{Results, WayBack, integral_features, mean_features};
use super::sampling::{Sampling, basis_of, cross_check, interruption, override_ensemble, thread_pool};
use super::summary::summary;
use super::{Failure, RunArguments, law_of, loop_of, print_of, read_scene, refuse_own_scene, resources, warnings_of};
use crate::asperity::{Law, Loop, Quantity};
use crate::engine::{Ensemble, Outcome};
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
    let cycle = loop_of(&scene, &arguments.scene)?;
    let cycle = cycle.as_ref();
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
    let back = cycle.map(|cycle| pool.install(|| Statistical::way_back(cycle, &scene.surface, &scene.separations)));
    progress.phase("test functionals");
    let state = interrupted
        .as_ref()
        .map_or_else(|| prepared(&scene, (law, cycle), (&statistical, back.as_ref())), |run| run.state().clone());
    let State { basis, controls, .. } = state.clone();
    let setup = Sampling { scene: &scene, law, cycle, basis: &basis, controls: &controls, keep_curves: scene.curves };
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

    progress.phase("cross-check");
    let ways: Vec<&Statistical> = [&statistical].into_iter().chain(&back).collect();
    let (z, joint) = cross_check(&ensemble, &ways, &basis, &scene);
    let force = |way: &&Statistical| way.expected[Quantity::ExternalForce.index()].clone();
    let expected: Vec<f64> = ways.iter().flat_map(force).collect();
    let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
    let scalars = controlled_means(&ensemble.groups.scalars, &expected);
    let of_mean = mean_features(&scene, law, &ensemble, &statistical);
    let of_integral = integral_features(&scene, law, &statistical);
    let back = cycle.zip(back).map(|(cycle, statistical)| WayBack::new(&scene, cycle, &ensemble, statistical));
    progress.end();
    let mut seconds = progress.seconds();
    seconds.iter_mut().filter(|(name, _)| *name == "ensemble").for_each(|(_, time)| *time += keeper.seconds_before);
    progress.phase("writing");
    let regimes = law.regimes().iter().map(|regime| regime.name()).collect();
    let (threads, replicas) = (pool.current_num_threads(), scene.replicas);
    let results = Results {
        scene,
        plan,
        warnings,
        regimes,
        statistical,
        back,
        ensemble,
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
        None => Err(kept.map_or_else(Failure::from, |()| keeper.interrupted(replicas))),
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(
    scene: &Scene,
    (law, cycle): (&dyn Law, Option<&Loop>),
    (there, back): (&Statistical, Option<&Statistical>),
) -> State {
    let basis = basis_of(scene, law, cycle);
    let groups = scene.replicas / scene.sampling.group();
    // Of a loop the way on which the surfaces are pulled off.
    let first = back.map_or(0, |_| scene.separations.len());
    let controls = controls(&scene.separations, back.unwrap_or(there), &basis.tested[1][first..], groups);
    State::new(basis, controls.into_iter().map(|place| first + place).collect())
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
