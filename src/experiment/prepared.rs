//! One scene, from its laws to a checked file.

use super::checkpoint::{Beginning, Checkpointer, Interrupted, OverwritePolicy, Run, beginning};
use super::coupling::mean_fields;
use super::datasets::write_results;
use super::host::Host;
use super::integral::{Integral, PathIntegral};
use super::layouts::RUN;
use super::result_file::{AllRecords, write_curves, write_head};
use super::results::{Results, RetractionResults, RunMetadata, Stopped, mean_features};
use super::sampling::{Sampling, basis_of, cross_check};
use super::{Error, Observer, Phases};
use crate::asperity::{Laws, Loop, Quantity, SurfaceLaws, SurfaceLoops};
use crate::engine::{Batch, Outcome, ReductionTree, Rule, Shard, Summation, batches_of, replicas_of};
use crate::estimate::Estimate;
use crate::integral::{Expectations, controls};
use crate::math::control_variates::controlled_means;
use crate::output::partial::Functionals;
use crate::output::writer::Writer;
use crate::output::{OutputError, OutputLock};
use crate::scene::{Scene, Warning, warnings};
use crate::validation::{Basis, Cumulants};
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A session: all that experiments one after the other have in common.
pub(crate) struct Session {
    /// Set by an interruption.
    pub stop: Arc<AtomicBool>,
    /// The threads that compute.
    pub pool: ThreadPool,
    /// How often what has been done is kept.
    pub interval: Duration,
    /// Who has them run.
    pub host: Box<dyn Host>,
}

/// Most threads for each processor: more would wait for each other only.
const THREADS_PER_PROCESSOR: usize = 8;

/// The most threads that this machine has a use for, and its processors.
pub(crate) fn most_threads() -> (usize, usize) {
    let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (THREADS_PER_PROCESSOR * processors, processors)
}

/// A pool of that number of threads, as far as the machine has a use for them, or of one per core with 0.
///
/// # Errors
/// [`Error::Threads`].
pub(crate) fn thread_pool(threads: usize) -> Result<ThreadPool, Error> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads.min(most_threads().0)).build()?)
}

/// One scene and where its result goes.
pub(crate) struct Task<'a> {
    /// The output, as the user names it.
    pub output: &'a Path,
    /// The lock on it.
    pub lock: &'a OutputLock,
    /// The policy for what is there already.
    pub policy: OverwritePolicy,
    /// The shard that it is of the run, if not all of it.
    pub shard: Option<Shard>,
}

/// Computes a scene into its output; what it has found out, or none where the output was complete before.
///
/// # Errors
/// [`Error`]; what has been done is kept beside the output, for a run that resumes it.
pub(crate) fn run_scene(
    scene: Scene,
    laws: SceneLaws,
    task: &Task<'_>,
    session: &Session,
    observer: &mut dyn Observer,
) -> Result<Option<Box<Results>>, Error> {
    let mut phases = Phases::new(observer);
    let interrupted = match beginning(task.lock, Run { scene: &scene, shard: task.shard }, task.policy)? {
        Beginning::Complete => return Ok(None),
        Beginning::Anew => None,
        Beginning::Resumed(run) => Some(run),
    };
    let kept = interrupted.as_ref().map(|run| run.functionals().clone());
    let ground = PreparedRun::new(scene, laws, kept, session, &mut phases);
    let batches = 0..batches_of(ground.scene.replicas);
    let Sampled { reduction_tree, summation, mut checkpointer } =
        ground.sample(batches, interrupted, task, session, &mut phases)?;
    let most = ground.scene.replicas;
    let metadata = RunMetadata {
        seconds_before: checkpointer.seconds_before,
        resumptions: checkpointer.resumptions(),
        checkpoints: checkpointer.journal.cost(),
        ..RunMetadata::default()
    };
    let results = ground.results(*reduction_tree, summation, metadata, session, &mut phases);
    phases.phase("writing");
    let written = write(task, &results, &mut |visit| checkpointer.journal.each(visit), &session.stop);
    phases.end();
    checkpointer.ended(written, task.output, most)?;
    Ok(Some(Box::new(results)))
}

/// The laws of a scene.
pub(crate) struct SceneLaws {
    pub law: SurfaceLaws,
    /// The loop of which the law is the approach, if surfaces are pulled back.
    pub cycle: Option<Loop>,
    /// The loops that coupled asperities remember their histories by.
    pub memory: Option<SurfaceLoops>,
}

impl SceneLaws {
    /// Makes the laws of a scene.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let refused = |error| Error::Law { law: scene.model.name, error };
        Ok(Self {
            law: scene.law().map_err(refused)?,
            cycle: scene.loop_law().map_err(refused)?,
            memory: scene.memory().map_err(refused)?,
        })
    }

    /// The laws of a scene of which so many replicas are computed for a task on so many threads, if there is
    /// room for them.
    ///
    /// # Errors
    /// [`Error::Law`], [`Error::TooLarge`].
    pub fn fitting(
        scene: &Scene,
        replicas: u64,
        task: &Task<'_>,
        session: &Session,
        threads: usize,
    ) -> Result<Self, Error> {
        let laws = Self::new(scene)?;
        let estimate =
            Estimate { replicas: replicas as f64, ..Estimate::new(scene, laws.law.view(), threads) };
        // What an interrupted run has kept is on the disk already.
        let begins = !task.lock.beside(".checkpoint").exists();
        let required = session.host.require(&estimate, begins.then_some(task.output));
        required.map_err(Error::TooLarge).map(|()| laws)
    }
}

/// A scene with all that its ensemble is computed with and checked against.
pub(crate) struct PreparedRun {
    pub scene: Scene,
    laws: SceneLaws,
    warnings: Vec<Warning>,
    integral: Integral,
    functionals: Functionals,
    /// Expectations of the external force at the control variates, N.
    expected: Vec<f64>,
}

/// An ensemble that has been computed.
pub(crate) struct Sampled {
    pub reduction_tree: Box<ReductionTree>,
    pub summation: Summation,
    /// The checkpointer that keeps it until it is written.
    pub checkpointer: Checkpointer,
}

impl PreparedRun {
    /// Prepares a scene, with the functionals that have been kept of it, if any.
    pub fn new(
        scene: Scene,
        laws: SceneLaws,
        kept: Option<Functionals>,
        session: &Session,
        phases: &mut Phases<'_>,
    ) -> Self {
        let (law, cycle, pool) = (laws.law.view(), laws.cycle.as_ref(), &session.pool);
        phases.phase("integral");
        let (integral, warnings) = pool.install(|| {
            let integral = Integral::new(&scene, law, cycle);
            let expected = integral.expected(&scene, &scene.model, law);
            let warnings = warnings(&scene, &scene.model, law.typical, &expected);
            (integral, warnings)
        });
        phases.phase("test functionals");
        let functionals = kept.unwrap_or_else(|| prepared(&scene, (law, cycle), &integral));
        let force = |way: &PathIntegral| way.expectations.expected[Quantity::ExternalForce.index()].clone();
        let expected: Vec<f64> = integral.paths().flat_map(force).collect();
        let expected = functionals.controls.iter().map(|&place| expected[place]).collect();
        Self { scene, laws, warnings, integral, functionals, expected }
    }

    /// The ensemble.
    pub fn sampling(&self) -> Sampling<'_> {
        Sampling {
            scene: &self.scene,
            law: self.laws.law.view(),
            cycle: self.laws.cycle.as_ref(),
            memory: self.laws.memory.as_ref(),
            controls: &self.functionals.controls,
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
        phases: &mut Phases<'_>,
    ) -> Result<Sampled, Error> {
        let setup = self.sampling();
        let job = setup.job();
        let replicas = replicas_of(batches.clone(), job.replicas);
        let (mut checkpointer, start) = match interrupted {
            Some(run) => Checkpointer::resume(*run, &job, &batches, session.interval)?,
            None => {
                let run = Run { scene: &self.scene, shard: task.shard };
                (
                    Checkpointer::begin(task.lock, run, self.functionals.clone(), session.interval)?,
                    ReductionTree::new(batches),
                )
            }
        };
        let observe = |batch: &Batch, merged: &ReductionTree| checkpointer.keep(batch, merged);
        let computed = setup.run("ensemble", &session.pool, &session.stop, phases, start, observe);
        let (outcome, summation) = computed.map_err(|error| checkpointer.advised(error.into()))?;
        match outcome {
            Outcome::Complete(reduction_tree) => {
                checkpointer.hold(&reduction_tree);
                Ok(Sampled { reduction_tree, summation, checkpointer })
            }
            Outcome::Interrupted(reduction_tree) => {
                checkpointer.save(&reduction_tree)?;
                Err(checkpointer.interrupted(replicas.end - replicas.start))
            }
        }
    }

    /// Results of the ensemble that has been merged.
    pub fn results(
        mut self,
        reduction_tree: ReductionTree,
        summation: Summation,
        metadata: RunMetadata,
        session: &Session,
        phases: &mut Phases<'_>,
    ) -> Results {
        let ensemble = Box::new(reduction_tree.into_ensemble(&self.sampling().job()));
        let stopped = self.rule().map(|rule| Stopped::new(&rule, &ensemble));
        // From here on the scene is that of the replicas that there are.
        self.scene.stopping = None;
        self.scene.replicas = ensemble.replicas.len() as u64;
        let Self { scene, laws: SceneLaws { law, cycle, .. }, warnings, integral, functionals, expected } =
            self;
        let Functionals { basis, controls, .. } = functionals;
        phases.phase("cross-check");
        let paths: Vec<&Expectations> = integral.paths().map(|way| &way.expectations).collect();
        let (z, joint) = cross_check(&ensemble, &paths, &basis, &scene);
        let scalars = controlled_means(&ensemble.groups.scalars, &expected);
        let has_replicas = scene.replicas > 0;
        let mean_fields = match has_replicas {
            true => session.pool.install(|| mean_fields(&scene, law.view(), cycle.as_ref(), &integral)),
            false => Vec::new(),
        };
        let PathIntegral { at_pull_off, independence, .. } = integral.pulled().clone();
        let Integral { main, retraction, reapproach } = integral;
        let PathIntegral { expectations, features: of_integral, .. } = main;
        let (of_mean, retraction) = session.pool.install(|| {
            let of_mean = match has_replicas {
                true => mean_features(&scene, law.view(), &ensemble, &expectations),
                false => of_integral,
            };
            (
                of_mean,
                cycle
                    .zip(retraction)
                    .map(|(cycle, way)| RetractionResults::new(&scene, &cycle, &ensemble, way)),
            )
        });
        phases.end();
        let mut seconds = phases.seconds();
        seconds
            .iter_mut()
            .filter(|(name, _)| *name == "ensemble")
            .for_each(|(_, time)| *time += metadata.seconds_before);
        Results {
            regimes: law.regimes().iter().map(|regime| regime.name()).collect(),
            scene,
            warnings,
            expectations,
            retraction,
            reapproach: reapproach.map(|way| way.expectations),
            ensemble,
            stopped,
            summation,
            basis,
            controls,
            scalars,
            of_mean,
            of_integral,
            at_pull_off,
            independence,
            z,
            joint,
            mean_fields,
            seconds,
            threads: session.pool.current_num_threads(),
            metadata,
        }
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(scene: &Scene, (law, cycle): (Laws<'_>, Option<&Loop>), integral: &Integral) -> Functionals {
    if scene.replicas == 0 {
        let basis = Basis { probes: Vec::new(), cumulants: Cumulants::default(), tested: Default::default() };
        return Functionals { basis, controls: Vec::new(), fewest_replicas: 0 };
    }
    let basis = basis_of(scene, law, cycle);
    let groups = scene.fewest_replicas() / scene.sampling.group();
    // Of a loop the way on which the surfaces are pulled off.
    let first = cycle.map_or(0, |_| scene.separations.len());
    let pulled = &integral.pulled().expectations;
    let controls = controls(&scene.separations, pulled, &basis.tested[1][first..], groups);
    let controls = controls.into_iter().map(|place| first + place).collect();
    Functionals { basis, controls, fewest_replicas: scene.fewest_replicas() }
}

/// Writes the result, with curves out of the records of the replicas; `false` if it was interrupted before it
/// was complete, and then is not there.
pub(crate) fn write(
    task: &Task<'_>,
    results: &Results,
    records: &mut AllRecords<'_>,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    let mut writer = Writer::create(&RUN, task.lock, task.policy.force)?;
    write_head(&mut writer, results)?;
    if results.scene.curves && results.scene.replicas > 0 {
        write_curves(&writer, results, records, stop)?;
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(false);
    }
    write_results(&mut writer, results)?;
    writer.finish()?;
    Ok(true)
}
