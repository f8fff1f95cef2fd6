//! `stiction run`: from a scene to a checked file and a summary.

use super::record::{write_head, write_results};
use super::results::{Results, integral_features, mean_features};
use super::sampling::{Sampling, basis_of, cross_check, interruption, override_ensemble, thread_pool};
use super::summary::summary;
use super::{Failure, RunArguments, law_of, print_of, read_scene, refuse_own_scene, resources, warnings_of};
use crate::asperity::Quantity;
use crate::math::control_variates::controlled_means;
use crate::output::progress::Progress;
use crate::output::schema::RUN;
use crate::output::writer::Writer;
use crate::scene::{Plan, Sizes};
use crate::statistical::{Statistical, controls};
use std::path::PathBuf;

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let mut scene = read_scene(&arguments.scene)?;
    override_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    let output = match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    };
    let law = law_of(&scene, &scene.model, &arguments.scene)?;
    refuse_own_scene(&arguments.scene, &output)?;
    let pool = thread_pool(arguments.execution.threads)?;
    let sizes = Sizes::new(&scene, law.as_ref(), pool.current_num_threads());
    resources::require(&arguments.scene, &sizes, Some(&output))?;
    let mut writer = Writer::create(&RUN, &output, arguments.execution.force)?;
    let stop = interruption()?;
    let mut progress = Progress::new(arguments.execution.quiet);

    progress.phase("integral");
    let plan = Plan::new(&scene, law.as_ref());
    let warnings = warnings_of(&scene, &scene.model, law.as_ref());
    let statistical = pool.install(|| Statistical::new(law.as_ref(), &scene.surface, &scene.separations));
    progress.phase("test functionals");
    let basis = basis_of(&scene, law.as_ref());
    let groups = scene.replicas / scene.sampling.group();
    let controls = controls(&scene.separations, &statistical, &basis.tested[1], groups);
    let regimes = write_head(&mut writer, &scene, law.as_ref(), &basis, &controls)?;
    let mut done = 0;
    let (ensemble, summation) = {
        let setup = Sampling {
            scene: &scene,
            law: law.as_ref(),
            basis: &basis,
            controls: &controls,
            keep_curves: scene.curves,
        };
        setup.run("ensemble", &pool, &stop, &mut progress, |batch| {
            if scene.curves {
                writer.curves("/replicas/external_force", done, &batch.external_force)?;
                writer.curves("/replicas/adhesion_force", done, &batch.adhesion_force)?;
            }
            done += batch.ensemble.replicas.len();
            Ok(())
        })?
    };

    progress.phase("cross-check");
    let (z, joint) = cross_check(&ensemble, &statistical, &basis, &scene);
    let expected = &statistical.expected[Quantity::ExternalForce.index()];
    let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
    let scalars = controlled_means(&ensemble.groups.scalars, &expected);
    let of_mean = mean_features(&scene, law.as_ref(), &ensemble, &statistical);
    let of_integral = integral_features(&scene, law.as_ref(), &statistical);
    progress.end();
    let seconds = progress.seconds();
    progress.phase("writing");
    let threads = pool.current_num_threads();
    let results = Results {
        scene,
        plan,
        warnings,
        regimes,
        statistical,
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
        output,
    };
    write_results(&mut writer, &results)?;
    writer.finish()?;
    progress.end();
    print_of(&results.output, &summary(&results))
}
