//! `stiction run` of one scene: from there to a checked file and a summary.

use super::checkpoint::{Beginning, Interrupted, Keeper, Manner, Run, State, beginning};
use super::integral::{Integral, Way};
use super::record::{write_curves, write_head, write_results};
use super::results::{Results, Stopped, Told, WayBack, mean_features};
use super::sampling::{Sampling, basis_of, cross_check, interruption, override_ensemble, thread_pool};
use super::summary::summary;
use super::{
    Execution, Failure, RunArguments, files_of, law_of, loop_of, print_of, read_document, resources, shard, sweep,
};
use crate::asperity::{Law, Loop, Quantity};
use crate::engine::{Batch, Forest, Outcome, Rule, Shard, Summation, batches_of, replicas_of};
use crate::math::control_variates::controlled_means;
use crate::output::checkpoint::Records;
use crate::output::progress::Progress;
use crate::output::schema::RUN;
use crate::output::writer::Writer;
use crate::output::{Claim, OutputError, checksum};
use crate::scene::{Document, Plan, Scene, Sizes, Warning, warnings};
use crate::statistical::{Statistical, controls};
use rayon::ThreadPool;
use std::ops::Range;
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
    /// The shard that it is of the run, if not all of it.
    pub shard: Option<Shard>,
    /// Whether the result is read back later, and so has a checksum beside it.
    pub is_read_back: bool,
}

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let document = read_document(&arguments.scene)?;
    if let Some(shard) = arguments.shard {
        return shard::run(shard, document, arguments);
    }
    let Document { mut scene, sweep } = document;
    if let Some(sweep) = sweep {
        return sweep::run(&sweep, &scene, arguments);
    }
    override_ensemble(&mut scene, arguments.sitting.replicas, arguments.sitting.seed)?;
    let output = output_of(arguments);
    let session = Session::new(&arguments.sitting.execution, arguments.sitting.checkpoint)?;
    let claim = Claim::new(&output, &files_of(&arguments.scene, &scene))?;
    let manner = arguments.sitting.manner();
    let task =
        Task { source: &arguments.scene, output: &output, claim: &claim, manner, shard: None, is_read_back: false };
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
    scene: Scene,
    task: &Task<'_>,
    session: &Session,
    mut progress: Progress,
) -> Result<Option<Box<Results>>, Failure> {
    let laws = Laws::new(&scene, task.source)?;
    laws.require(&scene, scene.replicas, task, session.pool.current_num_threads())?;
    let interrupted = match beginning(task.claim, Run { scene: &scene, shard: task.shard }, task.manner)? {
        Beginning::Complete => return Ok(None),
        Beginning::Anew => None,
        Beginning::Resumed(run) => Some(run),
    };
    let kept = interrupted.as_ref().map(|run| run.state().clone());
    let ground = Groundwork::new(scene, laws, kept, session, &mut progress);
    let batches = 0..batches_of(ground.scene.replicas);
    let Sampled { forest, summation, mut keeper } =
        ground.sample(batches, interrupted, task, session, &mut progress)?;
    let most = ground.scene.replicas;
    let told = Told {
        seconds_before: keeper.seconds_before,
        resumptions: keeper.resumptions,
        checkpoints: keeper.journal.cost(),
        ..Told::default()
    };
    let results = ground.results(*forest, summation, told, session, task.output, &mut progress);
    progress.phase("writing");
    let written = write(task, &results, &mut keeper.journal, &session.stop);
    progress.end();
    keeper.ended(written, task.output, most)?;
    Ok(Some(Box::new(results)))
}

/// The laws of a scene.
pub(super) struct Laws {
    law: Box<dyn Law>,
    /// The loop of which the law is the approach, if surfaces are pulled back.
    cycle: Option<Loop>,
}

impl Laws {
    /// Those of a scene, with its file named in every error.
    pub fn new(scene: &Scene, source: &Path) -> Result<Self, Failure> {
        Ok(Self { law: law_of(scene, &scene.model, source)?, cycle: loop_of(scene, source)? })
    }

    /// Refuses a task of so many replicas of the scene, on so many threads, for which there is too little memory or disk.
    pub fn require(&self, scene: &Scene, replicas: u64, task: &Task<'_>, threads: usize) -> Result<(), Failure> {
        let sizes = Sizes { replicas: replicas as f64, ..Sizes::new(scene, self.law.as_ref(), threads) };
        // What an interrupted run has kept is on the disk already.
        let begins = !task.claim.beside(".checkpoint").exists();
        resources::require(task.source, &sizes, begins.then_some(task.output))
    }
}

/// What the ensemble of a scene is computed with and checked against.
pub(super) struct Groundwork {
    pub scene: Scene,
    laws: Laws,
    plan: Plan,
    warnings: Vec<Warning>,
    integral: Integral,
    state: State,
    /// Expectations of the external force at the control variates, N.
    expected: Vec<f64>,
}

/// What has been computed of an ensemble.
pub(super) struct Sampled {
    pub forest: Box<Forest>,
    pub summation: Summation,
    /// What keeps it until it is written.
    pub keeper: Keeper,
}

impl Groundwork {
    /// That of a scene; with what has been kept of it.
    pub fn new(scene: Scene, laws: Laws, kept: Option<State>, session: &Session, progress: &mut Progress) -> Self {
        let (law, cycle, pool) = (laws.law.as_ref(), laws.cycle.as_ref(), &session.pool);
        progress.phase("integral");
        let plan = Plan::new(&scene, law);
        let (integral, warnings) = pool.install(|| {
            let integral = Integral::new(&scene, law, cycle);
            let warnings = warnings(&scene, &scene.model, law, &integral.expected(&scene, law));
            (integral, warnings)
        });
        progress.phase("test functionals");
        let state = kept.unwrap_or_else(|| prepared(&scene, (law, cycle), &integral));
        let force = |way: &Way| way.statistical.expected[Quantity::ExternalForce.index()].clone();
        let expected: Vec<f64> = integral.ways().flat_map(force).collect();
        let expected = state.controls.iter().map(|&place| expected[place]).collect();
        Self { scene, laws, plan, warnings, integral, state, expected }
    }

    /// The ensemble.
    pub fn sampling(&self) -> Sampling<'_> {
        Sampling {
            scene: &self.scene,
            law: self.laws.law.as_ref(),
            cycle: self.laws.cycle.as_ref(),
            controls: &self.state.controls,
            rule: self.rule(),
            keep_curves: self.scene.curves,
        }
    }

    fn rule(&self) -> Option<Rule<'_>> {
        self.scene.stopping.as_ref().map(|stopping| Rule { stopping, expected: &self.expected })
    }

    /// Computes a range of batches for a task, from what was kept of it.
    pub fn sample(
        &self,
        batches: Range<u64>,
        interrupted: Option<Box<Interrupted>>,
        task: &Task<'_>,
        session: &Session,
        progress: &mut Progress,
    ) -> Result<Sampled, Failure> {
        let setup = self.sampling();
        let job = setup.job();
        let replicas = replicas_of(batches.clone(), job.replicas);
        let (mut keeper, start) = match interrupted {
            Some(run) => Keeper::resume(*run, &job, &batches, session.interval)?,
            None => {
                let run = Run { scene: &self.scene, shard: task.shard };
                (Keeper::begin(task.claim, run, self.state.clone(), session.interval)?, Forest::new(batches))
            }
        };
        let observe = |batch: &Batch, merged: &Forest| keeper.keep(&job, batch, merged);
        let computed = setup.run("ensemble", &session.pool, &session.stop, progress, start, observe);
        let (outcome, summation) = computed.map_err(|failure| keeper.advised(failure))?;
        match outcome {
            Outcome::Complete(forest) => {
                keeper.hold(&forest);
                Ok(Sampled { forest, summation, keeper })
            }
            Outcome::Interrupted(forest) => {
                keeper.save(&forest)?;
                Err(keeper.interrupted(replicas.end - replicas.start))
            }
        }
    }

    /// What is found out by the ensemble that has been merged.
    pub fn results(
        mut self,
        forest: Forest,
        summation: Summation,
        told: Told,
        session: &Session,
        output: &Path,
        progress: &mut Progress,
    ) -> Results {
        let ensemble = Box::new(forest.into_ensemble(&self.sampling().job()));
        let stopped = self.rule().map(|rule| Stopped::new(&rule, &ensemble));
        // From here on the scene is that of the replicas that there are.
        self.scene.stopping = None;
        self.scene.replicas = ensemble.replicas.len() as u64;
        let Self { scene, laws: Laws { law, cycle }, plan, warnings, integral, state, expected } = self;
        let State { basis, controls, .. } = state;
        progress.phase("cross-check");
        let ways: Vec<&Statistical> = integral.ways().map(|way| &way.statistical).collect();
        let (z, joint) = cross_check(&ensemble, &ways, &basis, &scene);
        let scalars = controlled_means(&ensemble.groups.scalars, &expected);
        let at_pull_off = integral.pulled().at_pull_off.clone();
        let Integral { there: Way { statistical, features: of_integral, .. }, back } = integral;
        let (of_mean, back) = session.pool.install(|| {
            let of_mean = mean_features(&scene, law.as_ref(), &ensemble, &statistical);
            (of_mean, cycle.zip(back).map(|(cycle, way)| WayBack::new(&scene, &cycle, &ensemble, way)))
        });
        progress.end();
        let mut seconds = progress.seconds();
        seconds.iter_mut().filter(|(name, _)| *name == "ensemble").for_each(|(_, time)| *time += told.seconds_before);
        Results {
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
            at_pull_off,
            z,
            joint,
            seconds,
            threads: session.pool.current_num_threads(),
            told,
            output: output.to_owned(),
        }
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(scene: &Scene, (law, cycle): (&dyn Law, Option<&Loop>), integral: &Integral) -> State {
    let basis = basis_of(scene, law, cycle);
    let groups = scene.fewest_replicas() / scene.sampling.group();
    // Of a loop the way on which the surfaces are pulled off.
    let first = cycle.map_or(0, |_| scene.separations.len());
    let pulled = &integral.pulled().statistical;
    let controls = controls(&scene.separations, pulled, &basis.tested[1][first..], groups);
    State::new(basis, controls.into_iter().map(|place| first + place).collect(), scene.fewest_replicas())
}

/// Writes the result, with curves out of the records of the replicas; `false` if it was interrupted before it was complete, and then is not
/// there.
pub(super) fn write(
    task: &Task<'_>,
    results: &Results,
    records: &mut dyn Records,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    let mut writer = Writer::create(&RUN, task.claim, task.manner.force)?;
    write_head(&mut writer, results)?;
    if results.scene.curves {
        write_curves(&writer, results, records, stop)?;
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(false);
    }
    write_results(&mut writer, results)?;
    writer.finish()?;
    if task.is_read_back {
        checksum::keep(task.claim)?;
    }
    Ok(true)
}
