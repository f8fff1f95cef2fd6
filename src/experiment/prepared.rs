//! One scene, from its laws to a checked file.

use super::coupling::mean_fields;
use super::datasets::write_results;
use super::host::Host;
use super::integral::{Integral, PathIntegral};
use super::keeper::Keeper;
use super::partial::{Beginning, OverwritePolicy, Part, Run, beginning, write_restart};
use super::result_file::{write_curves, write_head};
use super::results::{PathResults, Results, RunMetadata, Stopped};
use super::sampling::{Sampling, basis_of, cross_check};
use super::snaps::missed_preloads;
use super::{Error, Observer, Phases};
use crate::asperity::{Laws, Loop, Quantity, SurfaceLaws, SurfaceLoops};
use crate::engine::{Batch, Outcome, ReductionTree, Rule, Shard, Summation, Ways, batches_of, replicas_of};
use crate::estimate::Estimate;
use crate::integral::{Expectations, MeanField, controls};
use crate::math::control_variates::controlled_means;
use crate::output::curves::Curves;
use crate::output::partial::{Functionals, Head};
use crate::output::writer::Writer;
use crate::output::{OutputError, OutputLock};
use crate::scene::{Scene, Warning, warnings};
use crate::validation::Basis;
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// The time from one look for an interruption to the next, while a scene is prepared.
const LOOK: Duration = Duration::from_millis(50);

/// A session: all that experiments one after the other have in common.
pub(crate) struct Session {
    /// Set by an interruption.
    pub stop: Arc<AtomicBool>,
    /// The threads that compute.
    pub pool: ThreadPool,
    /// The interval at which what has been done is kept.
    pub interval: Duration,
    /// Whoever starts them.
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
    /// The part of the scene that is computed, if not all of it.
    pub part: Option<Part>,
}

impl Task<'_> {
    /// The shard that the part is of.
    pub fn shard(&self) -> Option<Shard> {
        self.part.as_ref().map(|part| part.shard)
    }

    /// The batches of a scene that are computed.
    fn batches(&self, scene: &Scene) -> Range<u64> {
        self.part.as_ref().map_or(0..batches_of(scene.replicas), |part| part.batches.clone())
    }
}

/// Computes a scene into its output; what it has found out, or none where the output was complete before.
///
/// # Errors
/// [`Error`]; what has been done is kept next to the output, for a run that resumes it.
pub(crate) fn run_scene(
    scene: Scene,
    laws: SceneLaws,
    task: &Task<'_>,
    session: &Session,
    observer: &mut dyn Observer,
) -> Result<Option<Box<Results>>, Error> {
    let mut phases = Phases::new(observer);
    let run = Run { scene: &scene, shard: task.shard() };
    let mut curves = Curves::new(&scene, task.lock.folder());
    let state = match beginning(task.lock, run, task.policy)? {
        Beginning::Complete => return Ok(None),
        Beginning::Anew => None,
        Beginning::Resumed(found) => match &found.pieces[..] {
            [piece] => {
                found.read_curves(piece, &scene, &mut curves)?;
                Some(found.state(piece, &scene)?)
            }
            _ => return Err(found.refused("is not of one scene").into()),
        },
    };
    let kept = state.as_ref().map(|state| state.functionals.clone());
    let asked = replicas_of(task.batches(&scene), scene.replicas);
    let (done, of) =
        (state.as_ref().map_or(0, |state| state.tree.replicas.len() as u64), asked.end - asked.start);
    let interrupted = || {
        let (kept, partial) = (done > 0, task.lock.partial());
        let error = Error::Interrupted { done, of, kept };
        if kept { Error::Kept { error: Box::new(error), replicas: done, partial } } else { error }
    };
    let ground = PreparedRun::new(scene, laws, kept, session, &mut phases).ok_or_else(interrupted)?;
    let sampling = ground.sampling();
    let summation = Arc::new(sampling.summation(&session.pool));
    let batches = task.batches(&ground.scene);
    let (mut keeper, start) = Keeper::begin((&ground, &summation), (task, session), state, batches, curves)?;
    phases.replicas("ensemble", keeper.done, keeper.count);
    keeper.phases = phases.seconds();
    let observe = |batch: &Batch, merged: &mut ReductionTree| keeper.keep(batch, merged);
    let outcome = sampling.run(&summation, (&session.pool, &session.stop), &mut phases, start, observe);
    match outcome.map_err(|error| keeper.advised(error.into()))? {
        Outcome::Complete(tree) => keeper.complete(tree, &mut phases).map(Some),
        Outcome::Interrupted(mut tree) => {
            keeper.save(&mut tree)?;
            Err(keeper.interrupted())
        }
    }
}

/// What `work` gives on the threads of a session; nothing where that is interrupted meanwhile, and nobody waits for the work any
/// more.
fn unless_interrupted<T: Send + 'static>(
    session: &Session,
    work: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    let (sender, receiver) = sync_channel(1);
    session.pool.spawn(move || drop(sender.send(catch_unwind(AssertUnwindSafe(work)))));
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(done) => return Some(done.unwrap_or_else(|panic| resume_unwind(panic))),
            Err(_) if session.stop.load(Ordering::Relaxed) => return None,
            Err(_) => {}
        }
    }
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

    /// Makes the laws of a scene on the threads of a session.
    ///
    /// # Errors
    /// [`Error::Law`], [`Error::Interrupted`].
    pub fn within(scene: &Scene, session: &Session) -> Result<Self, Error> {
        // What a scene computes once, its clones have, too.
        let (own, of) = (scene.clone(), scene.replicas);
        let laws = unless_interrupted(session, move || Self::new(&own));
        laws.unwrap_or(Err(Error::Interrupted { done: 0, of, kept: false }))
    }

    /// The ensemble of the scene that they are of, without control variates and targets.
    pub fn sampling<'a>(&'a self, scene: &'a Scene) -> Sampling<'a> {
        Sampling {
            scene,
            law: self.law.view(),
            cycle: self.cycle.as_ref(),
            memory: self.memory.as_ref(),
            controls: &[],
            rule: None,
            keep_curves: scene.curves,
        }
    }

    /// The laws of a scene, if there is room for computing this number of replicas for a task on this number
    /// of threads.
    ///
    /// # Errors
    /// [`Error::Law`], [`Error::TooLarge`], [`Error::Interrupted`].
    pub fn fitting(
        scene: &Scene,
        replicas: u64,
        task: &Task<'_>,
        session: &Session,
        threads: usize,
    ) -> Result<Self, Error> {
        let laws = Self::within(scene, session)?;
        let estimate =
            Estimate { replicas: replicas as f64, ..Estimate::new(scene, laws.law.view(), threads) };
        // What an interrupted run has kept is on the disk already.
        let begins = !task.lock.partial().exists();
        let required = session.host.require(&estimate, begins.then_some(task.output));
        required.map_err(Error::TooLarge).map(|()| laws)
    }
}

/// A scene with all that its ensemble is computed with and checked against.
pub(crate) struct PreparedRun {
    pub scene: Scene,
    laws: SceneLaws,
    warnings: Vec<Warning>,
    /// Whether contacts yield before the surfaces turn back.
    pub yields: bool,
    integral: Integral,
    mean_fields: Vec<MeanField>,
    pub functionals: Functionals,
    /// Expectations of the external force at the control variates, N.
    expected: Vec<f64>,
}

impl PreparedRun {
    /// Prepares a scene, with the functionals that have been kept of it, if any; none where the session is interrupted meanwhile.
    pub fn new(
        scene: Scene,
        laws: SceneLaws,
        kept: Option<Functionals>,
        session: &Session,
        phases: &mut Phases<'_>,
    ) -> Option<Self> {
        phases.phase("integral");
        let (scene, laws, integral, expected, mean_fields) = unless_interrupted(session, move || {
            let (law, cycle) = (laws.law.view(), laws.cycle.as_ref());
            let integral = Integral::new(&scene, law, cycle);
            let expected = integral.expected(&scene, law);
            let mean_fields = match scene.replicas {
                0 => Vec::new(),
                _ => mean_fields(&scene, law, cycle, &integral),
            };
            (scene, laws, integral, expected, mean_fields)
        })?;
        let typical = laws.law.view().typical;
        let (warnings, yields) = (warnings(&scene, &scene.model, typical, &expected), expected.yields);
        phases.phase("test functionals");
        let (scene, laws, integral, functionals) = unless_interrupted(session, move || {
            let law = (laws.law.view(), laws.cycle.as_ref());
            let functionals = kept.unwrap_or_else(|| prepared(&scene, law, &integral));
            (scene, laws, integral, functionals)
        })?;
        let force = |way: &PathIntegral| way.expectations.expected[Quantity::ExternalForce.index()].clone();
        let expected: Vec<f64> = integral.paths().flat_map(force).collect();
        let expected = functionals.controls.iter().map(|&place| expected[place]).collect();
        Some(Self { scene, laws, warnings, yields, integral, mean_fields, functionals, expected })
    }

    /// The ensemble.
    pub fn sampling(&self) -> Sampling<'_> {
        let controls = &self.functionals.controls;
        Sampling { controls, rule: self.rule(), ..self.laws.sampling(&self.scene) }
    }

    fn rule(&self) -> Option<Rule<'_>> {
        self.scene.stopping.as_ref().map(|stopping| Rule { stopping, expected: &self.expected })
    }

    /// Results of the ensemble that has been merged, on the threads of a session and with the seconds of its
    /// phases, and their model range, for which `most` replicas at most are computed by each of the other plastic contacts.
    ///
    /// # Errors
    /// As [`PreparedRun::model_range`]; the tree has its replicas then.
    pub fn whole_results(
        &self,
        tree: &mut ReductionTree,
        (summation, most): (&Arc<Summation>, u64),
        metadata: RunMetadata,
        (session, phases): (&Session, &mut Phases<'_>),
    ) -> Result<Results, Error> {
        phases.phase("cross-check");
        let results = session.pool.install(|| self.results(tree, summation, metadata));
        let model_range = match self.model_range(&results, most, (session, &mut *phases)) {
            Ok(model_range) => model_range,
            Err(error) => {
                tree.give_back(*results.ensemble);
                return Err(error);
            }
        };
        phases.end();
        let (seconds, threads) = (phases.seconds(), session.pool.current_num_threads());
        Ok(Results { model_range, seconds, threads, ..results })
    }

    /// Results of the replicas that a tree has, which go over to them.
    pub fn results(
        &self,
        tree: &mut ReductionTree,
        summation: &Arc<Summation>,
        metadata: RunMetadata,
    ) -> Results {
        let ensemble = Box::new(tree.lend(&self.sampling().job()));
        let stopped = self.rule().map(|rule| Stopped::new(&rule, &ensemble));
        // The scene of the replicas that there are.
        let replicas = ensemble.replicas.len() as u64;
        let scene = Scene { stopping: None, replicas, ..self.scene.clone() };
        let (law, cycle, integral) = (&self.laws.law, self.laws.cycle.as_ref(), self.integral.clone());
        let Functionals { basis, controls, .. } = self.functionals.clone();
        let paths: Vec<&Expectations> = integral.paths().map(|way| &way.expectations).collect();
        let (z, joint) = cross_check(&ensemble, &paths, &basis, &scene);
        let scalars = controlled_means(&ensemble.groups.scalars, &self.expected);
        let PathIntegral { at_pull_off, independence, .. } = integral.pulled().clone();
        let Integral { main, retraction, reapproach } = integral;
        let back = |way| Some(PathResults::of_retraction(&scene, cycle?, &ensemble, way));
        let retraction = retraction.and_then(back);
        let main = match scene.ways() {
            Ways::Back => back(main).expect("surfaces that are pulled back have a loop"),
            _ => PathResults::of_approach(&scene, law.view(), &ensemble, main),
        };
        let PathResults { expectations, of_mean, of_integral } = main;
        let mut results = Results {
            regimes: law.regimes().to_vec(),
            fit: law.view().fit().cloned(),
            scene,
            warnings: self.warnings.clone(),
            expectations,
            retraction,
            reapproach: reapproach.map(|way| way.expectations),
            ensemble,
            stopped,
            summation: Arc::clone(summation),
            basis,
            controls,
            scalars,
            of_mean,
            of_integral,
            at_pull_off,
            independence,
            model_range: None,
            z,
            joint,
            mean_fields: self.mean_fields.clone(),
            seconds: Vec::new(),
            threads: 0,
            metadata,
        };
        results.warnings.extend(missed_preloads(&results));
        results
    }
}

/// The functionals of the joint test, and the control variates.
fn prepared(scene: &Scene, (law, cycle): (Laws<'_>, Option<&Loop>), integral: &Integral) -> Functionals {
    if scene.replicas == 0 {
        return Functionals { basis: Basis::untested(0), controls: Vec::new(), fewest_replicas: 0 };
    }
    let basis = basis_of(scene, law, cycle);
    let groups = scene.fewest_replicas() / scene.sampling.group();
    // The way on which the surfaces are pulled off.
    let first = scene.ways().pulled() * scene.separations.len();
    let pulled = &integral.pulled().expectations;
    let controls = controls(&scene.separations, pulled, &basis.tested[1][first..], groups);
    let controls = controls.into_iter().map(|place| first + place).collect();
    Functionals { basis, controls, fewest_replicas: scene.fewest_replicas() }
}

/// The state that the file of a partial result holds.
pub(crate) struct Restart {
    pub head: Head,
    pub state: Vec<u8>,
}

/// Writes results, and of partial ones the state; `false` if it was interrupted before the file was complete,
/// which then is not there. A shard without replicas has no datasets.
pub(crate) fn write(
    mut writer: Writer<'_>,
    results: &Results,
    restart: Option<Restart>,
    curves: &mut Curves,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    write_head(&mut writer, results)?;
    let has_replicas = results.scene.replicas > 0;
    if has_replicas && results.scene.curves {
        write_curves(&writer, &results.scene, curves, stop)?;
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(false);
    }
    // An empty part of an ensemble is not the integral alone.
    if has_replicas || restart.is_none() {
        write_results(&mut writer, results)?;
    }
    if let Some(Restart { head, state }) = restart {
        write_restart(&writer, &head, std::iter::once(Ok(state)))?;
    }
    writer.finish()?;
    Ok(true)
}
