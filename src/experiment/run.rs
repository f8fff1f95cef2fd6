//! Experiments on scenes from Rust: with nothing but the scene, or set up.

use super::curves::Curves;
use super::integral::Integral;
use super::observer::{Observer, Phases};
use super::prepared::{PreparedRun, SceneLaws};
use super::results::{Results, RunMetadata};
use super::workers::Workers;
use crate::error::Error;
use crate::scene::Scene;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
/// let results = stiction::run(&scene)?;
/// println!("{:.3e} N", results.pull_off().mean);
/// # let path = folder.path().join("scene.h5");
/// results.write(&path)?;
/// # Ok::<(), stiction::Error>(())
/// ```
pub fn run(scene: &Scene) -> Result<Results, Error> {
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
    Builder { scene, threads: 0, workers: None, observer: None, stop: Arc::default() }
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
    /// Threads of others, if it does not start its own.
    workers: Option<&'a Workers>,
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
    pub fn run(self) -> Result<Results, Error> {
        if self.scene.replicas == 0 {
            let problem = "replicas = 0 asks for the integral alone, which `integrate` computes";
            return Err(Error::NotFor(problem.to_owned()));
        }
        self.with_workers(|scene, workers, phases| {
            let run = PreparedRun::new(scene.clone(), SceneLaws::new(scene)?, None, workers, phases);
            let run = run.ok_or(Error::Interrupted { done: 0, of: scene.replicas, kept: false })?;
            let setup = run.sampling();
            let curves = Curves::new(scene, &std::env::temp_dir());
            phases.replicas("ensemble", 0, scene.replicas);
            let (mut tree, summation) = setup.run_whole(workers, phases, |batch| curves.add(batch))?;
            let whole = (&Arc::new(summation), u64::MAX);
            let metadata = RunMetadata::new(curves);
            run.whole_results(&mut tree, whole, metadata, (workers, phases))
        })
    }

    /// Computes the integral alone.
    ///
    /// # Errors
    /// As [`integrate`].
    pub fn integrate(self) -> Result<Integral, Error> {
        self.with_workers(|scene, workers, phases| {
            let laws = SceneLaws::new(scene)?;
            phases.phase("integral");
            let integral = || Integral::new(scene, laws.law.view(), laws.cycle.as_ref());
            Ok(workers.pool.install(integral))
        })
    }

    /// Computes on the threads of an experiment before, and ends with it.
    pub(crate) fn within(self, workers: &'a Workers) -> Self {
        Self { workers: Some(workers), ..self }
    }

    /// Does something with the scene on its threads; the observer sees its phases.
    pub(crate) fn with_workers<T>(
        self,
        experiment: impl FnOnce(&Scene, &Workers, &mut Phases<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let Self { scene, threads, workers, observer, stop } = self;
        let own;
        let workers = match workers {
            Some(workers) => workers,
            None => {
                own = Workers::new(threads, stop)?;
                &own
            }
        };
        let mut nobody = ();
        let mut phases = Phases::new(observer.unwrap_or(&mut nobody));
        let result = experiment(scene, workers, &mut phases);
        phases.end();
        result
    }
}
