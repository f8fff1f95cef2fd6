//! Several laws on the same asperities, by the integral and, if asked for, by the ensemble.

mod file;

use super::integral::{Integral, PathIntegral};
use super::sampling::{Sampling, basis_of, cross_check};
use super::{Error, Phases};
use crate::asperity::emd::Emd;
use crate::asperity::laws::fit::FORCES;
use crate::asperity::models::Model;
use crate::asperity::{FitReport, Laws, Quantity, Scratch, SolverStats, SurfaceLaws, for_each_block};
use crate::background::Background;
use crate::engine::{Ensemble, Summation};
use crate::estimate::beyond;
use crate::experiment::layouts::COMPARISON;
use crate::format::percent;
use crate::integral::Expectations;
use crate::math::moments::Moments;
use crate::math::proportion::agreeing;
use crate::output::OutputLock;
use crate::output::writer::Writer;
use crate::scene::{Instability, Scene, Warning, warnings_of_scene};
use crate::validation::{Cumulants, JointTest};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Interferences of the curves of one asperity.
const INTERFERENCES: usize = 801;
/// Equilibrium spacings before contact where these curves begin.
const FURTHEST: f64 = 10.0;
/// Critical interferences after contact where they end.
const DEEPEST: f64 = 1.25;
/// Units of approach after which they end at least and at most.
const DEPTHS: (f64, f64) = (5.0, 50.0);
/// A curve fit is off where its residual is more than this share of its largest force: the publication says
/// that it is less.
const LARGEST_RESIDUAL: f64 = 0.01;

/// One law of a comparison.
///
/// # Examples
/// ```
/// use stiction::ComparedLaw;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let comparison = stiction::compare(&scene, &["hybrid", "dmt"])?;
/// let dmt: &ComparedLaw = &comparison.laws()[1];
/// assert_eq!(dmt.name(), "dmt");
/// assert!(!dmt.limits().is_empty(), "DMT is for small adhesion parameters");
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct ComparedLaw {
    pub(crate) model: Model,
    pub(crate) limits: Vec<String>,
    pub(crate) regimes: Vec<&'static str>,
    pub(crate) integral: PathIntegral,
    /// The attraction between the mean planes in addition to these asperities.
    pub(crate) background: Option<Arc<Background>>,
    /// Quantities of one asperity, by their index, over the interferences.
    pub(crate) asperity: [Vec<f64>; 4],
    pub(crate) fit: Option<FitReport>,
    pub(crate) sampled: Option<SampledLaw>,
}

impl ComparedLaw {
    /// The name of the law.
    pub fn name(&self) -> &'static str {
        self.model.name
    }

    /// The integral over the separations.
    pub fn integral(&self) -> &PathIntegral {
        &self.integral
    }

    /// The ensemble, if one was asked for.
    pub fn ensemble(&self) -> Option<&Ensemble> {
        self.sampled.as_ref().map(|sampled| sampled.ensemble.as_ref())
    }

    /// Reasons why the law is not valid for the scene, a line each.
    pub fn limits(&self) -> &[String] {
        &self.limits
    }
}

/// The ensemble of one law of a comparison.
pub(crate) struct SampledLaw {
    pub ensemble: Box<Ensemble>,
    pub summation: Summation,
    /// z-scores of adhesion force and external force.
    pub z: [Vec<f64>; 2],
    pub joint: JointTest,
    pub cumulants: Cumulants,
}

impl SampledLaw {
    /// Pull-off forces of the replicas, N.
    fn pull_off_forces(&self) -> impl Iterator<Item = f64> {
        self.ensemble.replicas.iter().map(|replica| replica.pull_off_force)
    }
}

/// The mean of a number over replicas.
///
/// # Examples
/// ```
/// use stiction::Mean;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let comparison = stiction::builder(&scene).compare_ensembles(&["hybrid", "isbl"])?;
/// let Mean { mean, standard_error, .. } = comparison.paired_difference(&comparison.laws()[1]).unwrap();
/// assert!(mean > 5.0 * standard_error, "the fits of ISBL pull more");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Mean {
    /// The mean.
    pub mean: f64,
    /// The standard error of the mean; NaN for one group of replicas, and where all agree, which is no certainty.
    pub standard_error: f64,
    /// The standard deviation over the replicas.
    pub std: f64,
    /// Where all groups of replicas agree, at least two, the largest share of patches that may differ otherwise, with
    /// 95 % confidence; otherwise NaN.
    pub most_differing: f64,
}

/// Several laws on the same asperities.
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("laws.h5");
/// use stiction::Comparison;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let comparison: Comparison = stiction::compare(&scene, &["hybrid", "emd", "md"])?;
/// assert_eq!(comparison.laws().len(), 3);
/// comparison.write(&path)?;
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct Comparison {
    pub(crate) scene: Scene,
    /// Interferences of one asperity, m.
    pub(crate) interferences: Vec<f64>,
    pub(crate) laws: Vec<ComparedLaw>,
    /// Warnings about the scene under the first law.
    pub(crate) warnings: Vec<Warning>,
}

impl Comparison {
    /// The laws, in the order in which they were given.
    pub fn laws(&self) -> &[ComparedLaw] {
        &self.laws
    }

    /// The pull-off force of the replicas of a law, N; none without ensembles.
    pub fn pull_off(&self, law: &ComparedLaw) -> Option<Mean> {
        law.sampled.as_ref().map(|sampled| self.mean(sampled.pull_off_forces()))
    }

    /// The pull-off force of the replicas of a law less the first law's on the same asperities, N; none
    /// without ensembles.
    pub fn paired_difference(&self, law: &ComparedLaw) -> Option<Mean> {
        let (own, first) = (law.sampled.as_ref()?, self.laws[0].sampled.as_ref()?);
        let pairs = own.pull_off_forces().zip(first.pull_off_forces());
        Some(self.mean(pairs.map(|(own, first)| own - first)))
    }

    /// The mean over replicas, of which only groups are independent.
    fn mean(&self, values: impl Iterator<Item = f64>) -> Mean {
        let (values, group): (Vec<f64>, _) = (values.collect(), self.scene.sampling.group());
        let all = Moments::of(values.iter().copied());
        let groups = Moments::of_groups(&values, group as usize);
        let standard_error = groups.standard_error()[0];
        let most_differing = agreeing(groups.count(), standard_error);
        Mean { mean: all.mean()[0], standard_error, std: all.std()[0], most_differing }
    }

    /// Writes it into a new HDF5 file, which appears when it is complete.
    ///
    /// # Errors
    /// [`Error::Output`] when the file exists, [`Error::NotWritten`] when it cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let lock = OutputLock::new(path.as_ref(), &[])?;
        lock.check(false)?;
        self.write_locked(&lock, false)
    }

    /// Writes it where a lock is held; overwrites what is there if it may.
    ///
    /// # Errors
    /// [`Error::NotWritten`].
    pub(crate) fn write_locked(&self, lock: &OutputLock, overwrite: bool) -> Result<(), Error> {
        let written = Writer::create(&COMPARISON, lock, overwrite).and_then(|mut writer| {
            file::write(&mut writer, self)?;
            writer.finish()
        });
        written.map_err(|error| Error::NotWritten(error.writing(lock.output())))
    }
}

/// A value over that of the first law, less 1; NaN where one of them has none, which is 0 or negative.
pub(crate) fn deviation(value: f64, first: f64) -> f64 {
    if value > 0.0 && first > 0.0 { value / first - 1.0 } else { f64::NAN }
}

/// Laws that are about to be compared.
pub(crate) struct PreparedComparison {
    scene: Scene,
    laws: Vec<(Model, SurfaceLaws)>,
    with_ensembles: bool,
}

impl PreparedComparison {
    /// Makes the laws for a scene.
    ///
    /// # Errors
    /// [`Error::NotFor`] for a loop, for targets where there are ensembles, and for no law or one that is
    /// given twice; [`Error::Law`].
    pub fn new(mut scene: Scene, models: Vec<Model>, with_ensembles: bool) -> Result<Self, Error> {
        let refused = |problem: &str| Err(Error::NotFor(problem.to_owned()));
        if with_ensembles && scene.stopping.is_some() {
            return refused(
                "ends its ensemble at a target, which differs from law to law; give a number of replicas \
                 for all of them",
            );
        }
        if scene.cycle {
            return refused(
                "history = \"loop\": laws are compared on one way; give \"approach\" or \"retraction\"",
            );
        }
        if scene.substrate.is_some() {
            return refused("[substrate]: laws are compared for independent asperities; leave the table out");
        }
        let is_given_before = |i: usize| models[..i].iter().any(|model| model.name == models[i].name);
        if let Some(i) = (0..models.len()).find(|i| is_given_before(*i)) {
            return Err(Error::NotFor(format!("the law {} is given twice; give it once", models[i].name)));
        }
        if models.is_empty() {
            return refused("no law is given; give one or more");
        }
        // Snaps are a question of a run.
        scene.instability = Instability::default();
        let made = |model: Model| match scene.law_of(&model) {
            Ok(law) => Ok((model, law)),
            Err(error) => Err(Error::Law { law: model.name, error }),
        };
        let laws = models.into_iter().map(made).collect::<Result<_, _>>()?;
        Ok(Self { scene, laws, with_ensembles })
    }

    /// The scene and the law with the most regimes, for an estimate of what is needed.
    pub fn largest(&self) -> (&Scene, Laws<'_>) {
        let laws = self.laws.iter().map(|(_, law)| law.view());
        (&self.scene, laws.max_by_key(|law| law.regimes().len()).expect("there is a law"))
    }

    /// Computes it.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn run(
        self,
        pool: &rayon::ThreadPool,
        stop: &AtomicBool,
        phases: &mut Phases<'_>,
    ) -> Result<Comparison, Error> {
        let Self { scene, laws, with_ensembles } = self;
        let interferences = interferences(&scene);
        let (mut compared, mut warnings) = (Vec::new(), Vec::new());
        for (model, law) in laws {
            phases.phase(model.name);
            let scene = scene.clone().with_background_of(&model);
            let law = law.view();
            let (integral, expected) = pool.install(|| {
                let integral = Integral::new(&scene, law, None);
                let expected = compared.is_empty().then(|| integral.expected(&scene, &model, law));
                (integral, expected)
            });
            if let Some(expected) = expected {
                warnings = warnings_of_scene(&scene, &model, law.typical, &expected);
            }
            let integral = integral.main;
            let sampled = match with_ensembles {
                true => Some(sample(&scene, law, model.name, &integral.expectations, pool, stop, phases)?),
                false => None,
            };
            compared.push(ComparedLaw {
                limits: limits(&scene, &model, law),
                model,
                regimes: law.regimes().iter().map(|regime| regime.name()).collect(),
                integral,
                background: scene.surface.background.clone(),
                asperity: curves(law, &interferences),
                fit: law.fit().cloned(),
                sampled,
            });
        }
        phases.end();
        Ok(Comparison { scene, interferences, laws: compared, warnings })
    }
}

/// Limits of the validity of a law, a line each: its own, asperities beyond its end, and curve fits that are
/// off.
fn limits(scene: &Scene, model: &Model, law: Laws<'_>) -> Vec<String> {
    let (lambda, psi) = (scene.scale().lambda, scene.plasticity_index());
    let mut limits = model.validity.limits(lambda, psi, scene.asperity.lubricant_thickness);
    if scene.model.meniscus().is_some() && !model.is_wet() {
        limits.push("knows no liquid: computed as dry".to_owned());
    }
    let beyond = beyond(scene, law);
    if beyond >= 1e-3 {
        let digits = if beyond < 10.0 { 3 } else { 0 };
        limits.push(format!(
            "up to {beyond:.digits$} asperities per replica are beyond its last regime and bear no force"
        ));
    }
    if let Some(fit) = law.fit() {
        let off = |i: usize| fit.largest_residual[i] / fit.largest_force[i];
        let forces = FORCES.iter().enumerate().filter(|(i, _)| !(off(*i) <= LARGEST_RESIDUAL));
        limits.extend(
            forces.map(|(i, force)| format!("{force} is off by up to {} of its largest", percent(off(i)))),
        );
    }
    limits
}

/// The ensemble of one law; every law draws the same asperities.
fn sample(
    scene: &Scene,
    law: Laws<'_>,
    name: &'static str,
    expectations: &Expectations,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
    phases: &mut Phases<'_>,
) -> Result<SampledLaw, Error> {
    let basis = basis_of(scene, law, None);
    let setup =
        Sampling { scene, law, cycle: None, memory: None, controls: &[], rule: None, keep_curves: false };
    let (reduction_tree, summation) = setup.run_whole(name, pool, stop, phases, |_| Ok(()))?;
    let ensemble = Box::new(reduction_tree.into_ensemble(&setup.job()));
    let (z, joint) = cross_check(&ensemble, &[expectations], &basis, scene);
    Ok(SampledLaw { ensemble, summation, z, joint, cumulants: basis.cumulants })
}

/// Interferences, m, from far before contact to beyond ω_c.
fn interferences(scene: &Scene) -> Vec<f64> {
    let scale = scene.scale();
    let emd = Emd::new(scale.lambda, scene.history).expect("a scene is validated when it is read");
    let before = scene.asperity.lubricant_thickness + FURTHEST * scene.asperity.equilibrium_spacing;
    let low = emd.end() * scale.length - before;
    let deepest = DEEPEST * scene.asperity.critical_interference();
    let high = deepest.clamp(DEPTHS.0 * scale.length, DEPTHS.1 * scale.length);
    (0..INTERFERENCES).map(|i| low + (high - low) * i as f64 / (INTERFERENCES - 1) as f64).collect()
}

/// The quantities of one asperity over rising interferences, m; 0 beyond the law's last regime.
fn curves(law: Laws<'_>, interferences: &[f64]) -> [Vec<f64>; 4] {
    let mut curves: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; interferences.len()]);
    let (mut scratch, mut stats) = (Scratch::default(), SolverStats::default());
    for_each_block(law.typical, interferences, 0.0, &mut scratch, &mut stats, |_, range, responses| {
        for (i, place) in range.enumerate() {
            let values =
                Quantity::of_response(responses.adhesion[i], responses.contact[i], responses.area[i]);
            for (curve, value) in curves.iter_mut().zip(values) {
                curve[place] = value;
            }
        }
    });
    curves
}
