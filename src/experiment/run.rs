//! Runs of scenes from Rust: with nothing but the scene, or set up.

use super::Error;
use super::checkpoint::{OverwritePolicy, record_of};
use super::observer::{Observer, Phases};
use super::prepared::{Laws, PreparedRun, Session, Task, write};
use super::results::{Results, RunMetadata};
use crate::engine::{Batch, Ensemble, scalars};
use crate::math::control_variates::ControlledMean;
use crate::output::checkpoint::{Records, Visit};
use crate::output::{OutputError, OutputLock};
use crate::scene::Scene;
use crate::validation::JointTest;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

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

/// A run of a scene that is to be set up.
pub fn builder(scene: &Scene) -> Builder<'_> {
    Builder { scene, threads: 0, observer: None, stop: Arc::default() }
}

/// A run of a scene that is set up.
pub struct Builder<'a> {
    scene: &'a Scene,
    threads: usize,
    observer: Option<&'a mut dyn Observer>,
    stop: Arc<AtomicBool>,
}

impl<'a> Builder<'a> {
    /// Computes on so many threads, or on one for each core with 0. They do not change the result.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Tells an observer of its progress.
    #[must_use]
    pub fn progress(self, observer: &'a mut dyn Observer) -> Self {
        Self { observer: Some(observer), ..self }
    }

    /// Ends with [`Error::Interrupted`] soon after this is set.
    #[must_use]
    pub fn stop(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Runs it.
    ///
    /// # Errors
    /// As [`run`], and [`Error::Interrupted`].
    pub fn run(self) -> Result<RunResult, Error> {
        let Self { scene, threads, observer, stop } = self;
        let mut nobody = ();
        let mut phases = Phases::new(observer.unwrap_or(&mut nobody));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let session = Session { stop, pool, interval: Duration::MAX };
        let run = PreparedRun::new(scene.clone(), Laws::new(scene)?, None, &session, &mut phases);
        let setup = run.sampling();
        let job = setup.job();
        let mut records = Vec::new();
        let observe = |batch: &Batch| {
            if scene.curves {
                records.extend(batch.records(&job));
            }
        };
        let (reduction_tree, summation) =
            setup.run_whole("ensemble", &session.pool, &session.stop, &mut phases, observe)?;
        let results =
            Box::new(run.results(*reduction_tree, summation, RunMetadata::default(), &session, &mut phases));
        Ok(RunResult { results, records })
    }
}

/// What a run has found out.
pub struct RunResult {
    results: Box<Results>,
    /// Records of the replicas, where their curves are kept.
    records: Vec<u64>,
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

    /// The same of any number that is kept of every replica, by its name in [`scalars`].
    pub fn scalar(&self, name: &str) -> Option<&ControlledMean> {
        let place = scalars(self.results.scene.cycle).position(|scalar| scalar.name == name)?;
        self.results.scalars.get(place)
    }

    /// The pull-off force of the integral, N.
    pub fn pull_off_of_integral(&self) -> f64 {
        -self.results.pulled().1.minimum.value
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
        let policy = OverwritePolicy { resume: false, force: false };
        let task = Task { output, lock: &lock, policy, shard: None, is_read_back: false };
        let mut records = Held { records: &self.records, length: record_of(&self.results.scene).length() };
        let written = write(&task, &self.results, &mut records, &AtomicBool::new(false));
        written.map(drop).map_err(|error| Error::NotWritten(error.writing(output)))
    }
}

/// Records that are held in memory.
struct Held<'a> {
    records: &'a [u64],
    length: usize,
}

impl Records for Held<'_> {
    fn records(&mut self, visit: &mut Visit<'_>) -> Result<(), OutputError> {
        for record in self.records.chunks_exact(self.length) {
            if !visit(record)? {
                break;
            }
        }
        Ok(())
    }
}
