//! `stiction compare`: several laws on the same asperities, by the integral and, if asked for, by the
//! ensemble.

mod record;
mod table;

use super::asperity::find;
use super::format::percent;
use super::progress::Progress;
use super::session::{interruption, override_ensemble, thread_pool};
use super::{CompareArguments, Failure, files_of, law_of, print, print_of, read_scene, resources};
use crate::asperity::emd::Emd;
use crate::asperity::laws::fit::FORCES;
use crate::asperity::models::Model;
use crate::asperity::{FitReport, Law, Quantity, Scratch, SolverStats, for_each_block};
use crate::engine::{Ensemble, Outcome, ReductionTree, Summation};
use crate::estimate::{Estimate, beyond};
use crate::experiment::Phases;
use crate::experiment::integral::{Integral, Way};
use crate::experiment::sampling::{Sampling, basis_of, cross_check};
use crate::integral::Expectations;
use crate::math::extrema::Features;
use crate::output::OutputLock;
use crate::output::schema::COMPARISON;
use crate::output::writer::Writer;
use crate::scene::{Instability, Scene, Warning, warnings_of_scene};
use crate::validation::{Cumulants, JointTest};
use std::sync::atomic::AtomicBool;

/// Interferences of the curves of one asperity.
const INTERFERENCES: usize = 801;
/// They begin so many equilibrium spacings before contact.
const FURTHEST: f64 = 10.0;
/// They end at so many critical interferences.
const DEEPEST: f64 = 1.25;
/// But after at least and at most so many units of approach.
const DEPTHS: (f64, f64) = (5.0, 50.0);
/// A curve fit is off where its residual is more than this share of its largest force: the publication says
/// that it is less.
const LARGEST_RESIDUAL: f64 = 0.01;

/// One law of a comparison.
struct Compared {
    model: Model,
    /// Where it is not valid, a line each.
    limits: Vec<String>,
    regimes: Vec<&'static str>,
    expectations: Expectations,
    features: Features,
    /// Quantities of one asperity, by their index, over the interferences.
    asperity: [Vec<f64>; 4],
    fit: Option<FitReport>,
    sampled: Option<Sampled>,
}

/// A value over that of the first law, less 1; NaN where one of them has none, which is 0 or negative.
pub(super) fn deviation(value: f64, first: f64) -> f64 {
    if value > 0.0 && first > 0.0 { value / first - 1.0 } else { f64::NAN }
}

/// What the ensemble adds.
struct Sampled {
    ensemble: Box<Ensemble>,
    summation: Summation,
    /// z-scores of adhesion force and external force.
    z: [Vec<f64>; 2],
    joint: JointTest,
    cumulants: Cumulants,
}

/// A comparison.
struct Comparison {
    scene: Scene,
    /// Interferences of one asperity, m.
    interferences: Vec<f64>,
    laws: Vec<Compared>,
    /// What of the scene is outside of what the models are valid for, by the first law.
    warnings: Vec<Warning>,
}

pub(super) fn compare(arguments: &CompareArguments) -> Result<(), Failure> {
    let stop = interruption()?;
    let models = models(&arguments.laws)?;
    let mut scene = read_scene(&arguments.scene)?;
    override_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    if arguments.ensemble && scene.stopping.is_some() {
        let problem = "ends its ensemble at a target, which differs from law to law";
        let advice = "give --replicas with the number for all of them";
        return Err(Failure::Usage(format!("{}: {problem}; {advice}", arguments.scene.display())));
    }
    if scene.cycle {
        let path = arguments.scene.display();
        let problem = "path = \"loop\": laws are compared on one way; give \"approach\" or \"retraction\"";
        return Err(Failure::Usage(format!("{path}: {problem}")));
    }
    // What holds the surfaces is a question of `stiction run`.
    scene.instability = Instability::default();
    let laws: Vec<Box<dyn Law>> =
        models.iter().map(|model| law_of(&scene, model, &arguments.scene)).collect::<Result<_, _>>()?;
    let inputs = files_of(&arguments.scene, &scene);
    let lock = arguments.output.as_ref().map(|output| OutputLock::new(output, &inputs)).transpose()?;
    lock.as_ref().map_or(Ok(()), |lock| lock.check(arguments.execution.force))?;
    let pool = thread_pool(arguments.execution.threads)?;
    if arguments.ensemble {
        let largest = laws.iter().max_by_key(|law| law.regimes().len()).expect("a law is required");
        let estimate = Estimate::new(&scene, largest.as_ref(), pool.current_num_threads());
        let estimate = Estimate { ensembles: laws.len() as f64, curves: false, ..estimate };
        resources::require(&arguments.scene, &estimate, arguments.output.as_deref())?;
    }
    let mut progress = Progress::new(arguments.execution.quiet);
    let mut phases = Phases::new(&mut progress);
    let interferences = interferences(&scene);
    let (mut compared, mut warnings) = (Vec::new(), Vec::new());
    for (model, law) in models.into_iter().zip(&laws) {
        phases.phase(model.name);
        let law = law.as_ref();
        let (integral, expected) = pool.install(|| {
            let integral = Integral::new(&scene, law, None);
            let expected = compared.is_empty().then(|| integral.expected(&scene, law));
            (integral, expected)
        });
        if let Some(expected) = expected {
            warnings = warnings_of_scene(&scene, &model, law, &expected);
        }
        let Way { expectations, features, .. } = integral.there;
        let sampled = match arguments.ensemble {
            true => Some(sample(&scene, law, model.name, &expectations, &pool, &stop, &mut phases)?),
            false => None,
        };
        compared.push(Compared {
            model,
            limits: limits(&scene, &model, law),
            regimes: law.regimes().iter().map(|regime| regime.name()).collect(),
            expectations,
            features,
            asperity: curves(law, &interferences),
            fit: law.fit().cloned(),
            sampled,
        });
    }
    phases.end();
    let comparison = Comparison { scene, interferences, laws: compared, warnings };
    if let Some(lock) = &lock {
        let written = Writer::create(&COMPARISON, lock, arguments.execution.force).and_then(|mut writer| {
            record::write(&mut writer, &comparison)?;
            writer.finish()
        });
        written.map_err(|error| Failure::not_written(error, lock.output()))?;
    }
    let table = table::table(&comparison, arguments.output.as_deref());
    match &arguments.output {
        Some(output) => print_of(output, &table),
        None => print(&table),
    }
}

/// Where a law is not valid, a line each: its own limits, asperities beyond its end, and curve fits that are
/// off.
fn limits(scene: &Scene, model: &Model, law: &dyn Law) -> Vec<String> {
    let psi = scene.asperity.plasticity_index(scene.surface.surface_height_std);
    let mut limits = model.validity.limits(scene.scale().lambda, psi, scene.asperity.lubricant_thickness);
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

/// The laws of a list of names.
fn models(names: &[String]) -> Result<Vec<Model>, Failure> {
    let mut models: Vec<Model> = Vec::new();
    for name in names {
        if name.trim().is_empty() {
            return Err(Failure::Usage(
                "--laws: a name is empty; names are separated by single commas".to_owned(),
            ));
        }
        let model = find("--laws", name)?;
        if models.iter().any(|known| known.name == model.name) {
            return Err(Failure::Usage(format!("--laws: {name} is given twice; each law once")));
        }
        models.push(model);
    }
    Ok(models)
}

/// The ensemble of one law; every law draws the same asperities.
fn sample(
    scene: &Scene,
    law: &dyn Law,
    name: &'static str,
    expectations: &Expectations,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
    phases: &mut Phases<'_>,
) -> Result<Sampled, Failure> {
    let basis = basis_of(scene, law, None);
    let setup = Sampling { scene, law, cycle: None, controls: &[], rule: None, keep_curves: false };
    let job = setup.job();
    let (outcome, summation) = setup.run(name, pool, stop, phases, ReductionTree::of(&job), |_, _| Ok(()))?;
    let Outcome::Complete(reduction_tree) = outcome else {
        let done = outcome.reduction_tree().replicas.len() as u64;
        return Err(Failure::Interrupted { done, of: scene.replicas, kept: false });
    };
    let ensemble = Box::new(reduction_tree.into_ensemble(&job));
    let (z, joint) = cross_check(&ensemble, &[expectations], &basis, scene);
    Ok(Sampled { ensemble, summation, z, joint, cumulants: basis.cumulants })
}

/// Interferences, m, from far before contact to beyond ω_c.
fn interferences(scene: &Scene) -> Vec<f64> {
    let scale = scene.scale();
    let emd = Emd::new(scale.lambda, scene.path).expect("a scene is validated when it is read");
    let before = scene.asperity.lubricant_thickness + FURTHEST * scene.asperity.equilibrium_spacing;
    let low = emd.end() * scale.length - before;
    let deepest = DEEPEST * scene.asperity.critical_interference();
    let high = deepest.clamp(DEPTHS.0 * scale.length, DEPTHS.1 * scale.length);
    (0..INTERFERENCES).map(|i| low + (high - low) * i as f64 / (INTERFERENCES - 1) as f64).collect()
}

/// The quantities of one asperity over rising interferences, m; 0 beyond the law's last regime.
fn curves(law: &dyn Law, interferences: &[f64]) -> [Vec<f64>; 4] {
    let mut curves: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; interferences.len()]);
    let (mut scratch, mut stats) = (Scratch::default(), SolverStats::default());
    for_each_block(law, interferences, 0.0, &mut scratch, &mut stats, |_, range, responses| {
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
