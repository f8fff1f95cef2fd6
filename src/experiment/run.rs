//! Experiments on scenes from Rust: with nothing but the scene, or set up.

use super::Error;
use super::files::session;
use super::integral::Integral;
use super::layouts::RUN;
use super::observer::{Observer, Phases};
use super::partial::OverwritePolicy;
use super::prepared::{PreparedRun, SceneLaws, Session, Task, run_scene, write};
use super::results::{Results, RunMetadata};
use crate::engine::Ensemble;
use crate::integral::Independence;
use crate::math::control_variates::ControlledMean;
use crate::output::OutputLock;
use crate::output::curves::Curves;
use crate::output::writer::Writer;
use crate::scene::Scene;
use crate::validation::JointTest;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

/// Runs a scene on all cores: its integral, its ensemble, and the check of one against the other.
///
/// # Errors
/// [`Error::Law`] when its law cannot be made for its asperities; [`Error::Threads`].
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("scene.toml");
/// # std::fs::copy("tests/data/quick.toml", &path).unwrap();
/// let scene = stiction::Scene::from_toml_file(&path)?;
/// let result = stiction::run(&scene)?;
/// println!("{:.3e} N", result.pull_off().mean);
/// # let path = folder.path().join("scene.h5");
/// result.write(&path)?;
/// # Ok::<(), stiction::Error>(())
/// ```
pub fn run(scene: &Scene) -> Result<RunResult, Error> {
    builder(scene).run()
}

/// Computes the integral of a scene, and no ensemble.
///
/// # Errors
/// [`Error::Law`] when its law cannot be made for its asperities; [`Error::Threads`].
///
/// # Examples
/// ```
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let integral = stiction::integrate(&scene)?;
/// println!("{:.3e} N", integral.main.pull_off());
/// # Ok::<(), stiction::Error>(())
/// ```
pub fn integrate(scene: &Scene) -> Result<Integral, Error> {
    builder(scene).integrate()
}

/// An experiment on a scene that is to be set up.
pub fn builder(scene: &Scene) -> Builder<'_> {
    Builder { scene, threads: 0, observer: None, stop: Arc::default() }
}

/// An experiment on a scene that is set up.
///
/// # Examples
/// ```
/// use stiction::Builder;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let experiment: Builder<'_> = stiction::builder(&scene).threads(2);
/// assert_eq!(experiment.run()?.pull_off().mean, stiction::run(&scene)?.pull_off().mean);
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct Builder<'a> {
    scene: &'a Scene,
    threads: usize,
    observer: Option<&'a mut dyn Observer>,
    stop: Arc<AtomicBool>,
}

impl<'a> Builder<'a> {
    /// Computes on this number of threads, or on one for each core with 0. They do not change the result.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Reports its progress to an observer.
    #[must_use]
    pub fn progress(self, observer: &'a mut dyn Observer) -> Self {
        Self { observer: Some(observer), ..self }
    }

    /// Ends with [`Error::Interrupted`] soon after this is set.
    #[must_use]
    pub fn stop(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Runs the scene.
    ///
    /// # Errors
    /// As [`run`], [`Error::NotFor`] for a scene of the integral alone, and [`Error::Interrupted`].
    pub fn run(self) -> Result<RunResult, Error> {
        let scene = self.scene;
        if scene.replicas == 0 {
            let problem = "replicas = 0 asks for the integral alone, which `integrate` computes";
            return Err(Error::NotFor(problem.to_owned()));
        }
        self.with_session(|session, phases| {
            let run = PreparedRun::new(scene.clone(), SceneLaws::new(scene)?, None, session, phases);
            let run = run.ok_or(Error::Interrupted { done: 0, of: scene.replicas, kept: false })?;
            let setup = run.sampling();
            let mut curves = Curves::new(scene, &std::env::temp_dir());
            let observe = |batch: &_| curves.add(batch);
            phases.replicas("ensemble", 0, scene.replicas);
            let (mut tree, summation) = setup.run_whole((&session.pool, &session.stop), phases, observe)?;
            let (summation, metadata) = (Arc::new(summation), RunMetadata::default());
            let results =
                run.whole_results(&mut tree, (&summation, u64::MAX), metadata, (session, phases))?;
            Ok(RunResult { results: Box::new(results), curves: Mutex::new(curves) })
        })
    }

    /// Runs the scene into a file. What is done is kept next to it, and what an interrupted run of the same
    /// scene into it has kept is gone on with. A complete result of it is left as it is.
    ///
    /// # Errors
    /// As [`run`]; [`Error::Output`] when the file is anything else than a result of this scene,
    /// [`Error::Interrupted`] and [`Error::Kept`] where something is kept.
    pub fn resume(self, output: impl AsRef<Path>) -> Result<(), Error> {
        let (scene, output) = (self.scene, output.as_ref());
        let laws = SceneLaws::new(scene)?;
        let lock = OutputLock::new(output, &[])?;
        let policy = OverwritePolicy { resume: true, force: false };
        let task = Task { output, lock: &lock, policy, part: None };
        let Self { threads, observer, stop, .. } = self;
        let session = Session { stop, ..session(threads)? };
        let mut nobody = ();
        run_scene(scene.clone(), laws, &task, &session, observer.unwrap_or(&mut nobody)).map(drop)
    }

    /// Computes the integral alone.
    ///
    /// # Errors
    /// As [`integrate`].
    pub fn integrate(self) -> Result<Integral, Error> {
        let scene = self.scene;
        let laws = SceneLaws::new(scene)?;
        self.with_session(|session, phases| {
            phases.phase("integral");
            let integral = || Integral::new(scene, laws.law.view(), laws.cycle.as_ref());
            Ok(session.pool.install(integral))
        })
    }

    /// Does something with threads, and tells the observer of it.
    fn with_session<T>(
        self,
        experiment: impl FnOnce(&Session, &mut Phases<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let Self { threads, observer, stop, .. } = self;
        let mut nobody = ();
        let mut phases = Phases::new(observer.unwrap_or(&mut nobody));
        let result = experiment(&Session { stop, ..session(threads)? }, &mut phases);
        phases.end();
        result
    }
}

/// The result of a run.
///
/// # Examples
/// ```
/// use stiction::RunResult;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let result: RunResult = stiction::run(&scene)?;
/// let pull_off = result.pull_off();
/// println!("{:.3e} N ± {:.0e} N", pull_off.controlled_mean, pull_off.controlled_standard_error);
/// assert_eq!(result.ensemble().replicas.len() as u64, scene.replicas);
/// assert_eq!(result.joint_test().verdict.name(), "agree");
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct RunResult {
    results: Box<Results>,
    /// Curves of the replicas, where they are kept.
    curves: Mutex<Curves>,
}

impl RunResult {
    /// The scene with the number of replicas that there are.
    pub fn scene(&self) -> &Scene {
        &self.results.scene
    }

    /// The pull-off force of the replicas, N: mean, standard error and 95 % interval, without and with
    /// control variates; of a loop on retraction.
    pub fn pull_off(&self) -> &ControlledMean {
        self.scalar("pull_off_force").expect("every run has a pull-off")
    }

    /// The mean of a number that every replica has, by its name in [`scalars`](crate::engine::scalars).
    pub fn scalar(&self, name: &str) -> Option<&ControlledMean> {
        self.results.scalar(name)
    }

    /// The pull-off force of the integral, N.
    pub fn pull_off_of_integral(&self) -> f64 {
        -self.results.pulled().1.minimum.value
    }

    /// Whether the asperities may be taken as independent of each other.
    pub fn independence(&self) -> &Independence {
        &self.results.independence
    }

    /// The ensemble: mean curves over the separations, their scatter, and what is kept of every replica.
    pub fn ensemble(&self) -> &Ensemble {
        &self.results.ensemble
    }

    /// The test of the ensemble against the integral.
    pub fn joint_test(&self) -> &JointTest {
        &self.results.joint
    }

    /// Writes it into a new HDF5 file, which appears when it is complete.
    ///
    /// # Errors
    /// [`Error::Output`] when the file exists, [`Error::NotWritten`] when it cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let output = path.as_ref();
        let lock = OutputLock::new(output, &[])?;
        lock.check(false)?;
        let mut curves = self.curves.lock().unwrap_or_else(PoisonError::into_inner);
        let writer = Writer::create(&RUN, &lock, false);
        let written = writer
            .and_then(|writer| write(writer, &self.results, None, &mut curves, &AtomicBool::new(false)));
        written.map(drop).map_err(|error| Error::NotWritten(error.writing(output)))
    }
}
