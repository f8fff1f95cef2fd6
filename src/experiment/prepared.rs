//! A scene with all that its ensemble is computed with and checked against.

use super::Phases;
use super::coupling::mean_fields;
use super::ensemble::{Sampling, basis_of, cross_check};
use super::integral::{Integral, PathIntegral};
use super::results::{PathResults, Results, RunMetadata, Stopped};
use super::snaps::missed_preloads;
use super::workers::Workers;
use crate::asperity::{Laws, Loop, Quantity, SurfaceLaws, SurfaceLoops};
use crate::engine::{ReductionTree, Rule, Summation, Ways};
use crate::error::Error;
use crate::integral::{Expectations, MeanField, controls};
use crate::math::control_variates::controlled_means;
use crate::scene::{Scene, Warning, warnings};
use crate::validation::Basis;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Least and largest error of a pull-off of coupled asperities, relative to it, where a scene leaves it open; and the share of the
/// standard error of the mean that it is to have. A larger one saves few states, and would show in the difference that coupling
/// makes, which scatters less than pull-offs do.
const PULL_OFF_TOLERANCE: (f64, f64) = (1e-4, 1e-3);
const SHARE_OF_ERROR: f64 = 0.1;

/// The largest error of a pull-off, relative to it, that a scene asks for.
fn asked_tolerance(scene: &Scene) -> Option<f64> {
    scene.substrate.as_ref()?.pull_off_tolerance
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

    /// Makes the laws of a scene on the workers.
    ///
    /// # Errors
    /// [`Error::Law`], [`Error::Interrupted`].
    pub fn within(scene: &Scene, workers: &Workers) -> Result<Self, Error> {
        // What a scene computes once, its clones have, too.
        let (own, of) = (scene.clone(), scene.replicas);
        let laws = workers.unless_interrupted(move || Self::new(&own));
        laws.unwrap_or(Err(Error::Interrupted { done: 0, of, kept: false }))
    }

    /// The ensemble of the scene that they are of, without control variates and targets.
    pub fn sampling<'a>(&'a self, scene: &'a Scene) -> Sampling<'a> {
        Sampling {
            scene,
            law: self.law.view(),
            cycle: self.cycle.as_ref(),
            memory: self.memory.as_ref(),
            pull_off_tolerance: asked_tolerance(scene).unwrap_or(PULL_OFF_TOLERANCE.1),
            controls: &[],
            rule: None,
            keep_curves: scene.curves,
        }
    }
}

/// The functionals that an ensemble is tested with. They come from linear algebra whose last bits may differ
/// between processors, so they are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Functionals {
    /// The functionals of the joint test.
    pub basis: Basis,
    /// Indices of the separations of the control variates.
    pub controls: Vec<usize>,
    /// The fewest replicas that the run may end with, for which they are: a run that ends at targets may end
    /// with fewer than without them.
    pub fewest_replicas: u64,
}

/// A scene with all that its ensemble is computed with and checked against.
pub(crate) struct PreparedRun {
    pub scene: Scene,
    laws: SceneLaws,
    warnings: Vec<Warning>,
    /// Whether contacts yield before the surfaces turn back.
    pub yields: bool,
    pub integral: Integral,
    mean_fields: Vec<MeanField>,
    pub functionals: Functionals,
    /// Expectations of the external force at the control variates, N.
    expected: Vec<f64>,
}

impl PreparedRun {
    /// Prepares a scene, with the functionals that have been kept of it, if any; none where it is interrupted meanwhile.
    pub fn new(
        scene: Scene,
        laws: SceneLaws,
        kept: Option<Functionals>,
        workers: &Workers,
        phases: &mut Phases<'_>,
    ) -> Option<Self> {
        phases.phase("integral");
        let (scene, laws, integral, expected, mean_fields) = workers.unless_interrupted(move || {
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
        let (scene, laws, integral, functionals) = workers.unless_interrupted(move || {
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
        let pull_off_tolerance = self.pull_off_tolerance();
        Sampling { controls, pull_off_tolerance, rule: self.rule(), ..self.laws.sampling(&self.scene) }
    }

    /// The largest error of a pull-off of coupled asperities, relative to it: unless the scene has one, a share of the standard error
    /// of the mean over the replicas, by the integral.
    pub fn pull_off_tolerance(&self) -> f64 {
        let (PathIntegral { at_pull_off, .. }, q) = (self.integral.pulled(), Quantity::ExternalForce.index());
        let scatter = (at_pull_off.std[q][0] / at_pull_off.expected[q][0]).abs();
        let (least, most) = PULL_OFF_TOLERANCE;
        let of_error = |replicas: u64| SHARE_OF_ERROR * scatter / (replicas as f64).sqrt();
        let own = match self.scene.replicas {
            replicas @ 2.. if scatter.is_finite() => of_error(replicas).clamp(least, most),
            _ => most,
        };
        asked_tolerance(&self.scene).unwrap_or(own)
    }

    fn rule(&self) -> Option<Rule<'_>> {
        self.scene.stopping.as_ref().map(|stopping| Rule { stopping, expected: &self.expected })
    }

    /// Results of the ensemble that has been merged, on the workers and with the seconds of its
    /// phases, and their model range, for which `most` replicas at most are computed by each of the other plastic contacts.
    ///
    /// # Errors
    /// As [`PreparedRun::model_range`]; the tree has its replicas then.
    pub fn whole_results(
        &self,
        tree: &mut ReductionTree,
        (summation, most): (&Arc<Summation>, u64),
        metadata: RunMetadata,
        (workers, phases): (&Workers, &mut Phases<'_>),
    ) -> Result<Results, Error> {
        phases.phase("cross-check");
        let results = workers.pool.install(|| self.results(tree, summation, metadata));
        let model_range = match self.model_range(&results, most, (workers, &mut *phases)) {
            Ok(model_range) => model_range,
            Err(error) => {
                tree.give_back(*results.ensemble);
                return Err(error);
            }
        };
        phases.end();
        let (seconds, threads) = (phases.seconds(), workers.count());
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
        let mut scene = Scene { stopping: None, replicas, ..self.scene.clone() };
        if let Some(substrate) = &mut scene.substrate {
            substrate.pull_off_tolerance = Some(self.pull_off_tolerance());
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A tenth of std/(|F|√replicas) by the integral at its pull-off, between 1e-4 and 1e-3; 1e-3 for one patch; what a scene asks for.
    #[test]
    fn pull_offs_are_sought_as_closely_as_their_mean_is_known() {
        let scene = Scene::from_toml_file("configs/coupled.toml").unwrap();
        let workers = Workers::new(1, Arc::default()).unwrap();
        let of = |replicas: u64, asked: Option<f64>| {
            let mut own = Scene { replicas, ..scene.clone() };
            own.substrate.as_mut().unwrap().pull_off_tolerance = asked;
            let (laws, mut nobody) = (SceneLaws::new(&own).unwrap(), ());
            let run = PreparedRun::new(own, laws, None, &workers, &mut Phases::new(&mut nobody)).unwrap();
            let sampling = run.sampling();
            (run.pull_off_tolerance(), sampling.job().protocol.substrate.unwrap().pull_off_tolerance)
        };
        let integral = crate::integrate(&scene).unwrap().main;
        let at = &integral.at_pull_off;
        let q = Quantity::ExternalForce.index();
        let scatter = at.std[q][0] / at.expected[q][0].abs();
        for (replicas, asked, expected) in [
            (1, None, 1e-3),
            (16, None, 1e-3),
            (40_000, None, 0.1 * scatter / 200.0),
            (100_000_000, None, 1e-4),
            (16, Some(1e-5), 1e-5),
        ] {
            let (own, of_job) = of(replicas, asked);
            assert!((own / expected - 1.0).abs() < 1e-12, "{replicas}: {own:e} {expected:e}");
            assert_eq!(own, of_job);
        }
        assert!((1e-4..1e-3).contains(&(0.1 * scatter / 200.0)), "{scatter}");
    }
}
