//! What accuracy costs, as a table for `scripts/work_precision.py`: sums over a replica, the mean pull-off
//! over an ensemble, the integral, and one solve of an asperity. Every row says in its last column what was
//! run. Times are of one core, the least of several runs. Writes `work_precision.csv` into the target folder;
//! takes two minutes on two cores.

mod common;

use common::{job, least_seconds, least_seconds_of, scene};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stiction::asperity::emd::Emd;
use stiction::asperity::{self, BLOCK, Facing, Lanes, LawParameters, Quantity, Responses, SolverStats};
use stiction::engine::moments::{LANES, MomentMatrix};
use stiction::engine::{BATCH, Batch, Curves, Draw, Job, Outcome, ReductionTree, Summation, Workspace};
use stiction::integral::{Expectations, controls};
use stiction::math::control_variates::controlled_means;
use stiction::math::instruction_set::InstructionSet;
use stiction::math::sums::Compensated;
use stiction::scene::Scene;
use stiction::surface::SamplingScheme;
use stiction::validation::{Draws, basis};

const SUM_TOLERANCES: [f64; 11] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13];
const INTEGRAL_TOLERANCES: [f64; 7] = [1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
/// Replicas of an ensemble, and how many such ensembles there are.
const ENSEMBLES: [(u64, u64); 4] = [(64, 32), (256, 16), (1024, 8), (4096, 4)];
/// Tolerance of the compressed sums of ensembles, as in a scene that gives none.
const COMPRESSED: f64 = 1e-9;
/// Batches of ensembles that are timed.
const DIRECT_BATCHES: u64 = 2;
const COMPRESSED_BATCHES: u64 = 8;
/// Asperities that are solved in one run, as in `solve.rs`.
const SOLVES: usize = 4096;
/// The adhesion parameter of timed solves, that of case II, and the range of approaches, as in
/// `peers/peers.py`.
const LAMBDA: f64 = 0.9;
const FURTHEST: f64 = -30.0;
const DEEPEST: f64 = 10.0;
/// Distance from the end of the branch within which no series takes the place of solves.
const SOLVED: f64 = 2.0;
const RUNS: usize = 9;

/// The rows of the table.
struct Table(String);

impl Table {
    fn row(&mut self, panel: &str, method: &str, parameters: &str, seconds: f64, error: f64, what: &str) {
        eprintln!("{panel:12} {method:28} {parameters:24} {seconds:10.3e} s  {error:9.2e}");
        self.0 += &format!("{panel},\"{method}\",\"{parameters}\",{seconds:.4e},{error:.4e},\"{what}\"\n");
    }
}

fn main() {
    // Without it, as in `cargo test --benches`, it is enough that this compiles.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let mut table = Table("panel,method,setting,seconds,error,what\n".to_owned());
    sums(&mut table);
    monte_carlo(&mut table);
    integral(&mut table);
    solves(&mut table);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("a folder in the target folder");
    let path = folder.join("work_precision.csv");
    std::fs::write(&path, table.0).expect("the target folder can be written");
    println!("{}", path.display());
}

/// One replica of case II, directly and compressed.
fn sums(table: &mut Table) {
    let scene = scene("case_ii");
    let law = scene.law().expect("a law of the scene");
    let job = job(&scene, law.view(), LANES as u64);
    let truth: Vec<Vec<[f64; 2]>> = (0..LANES as u64).map(|index| summed_one_by_one(&scene, index)).collect();
    let what = format!(
        "case II, {} asperities, {} separations: drawing, summing and pull-off of {LANES} replicas, per replica, least of {} runs, \
         1 thread; error: the largest over separations and replicas of the external force against asperities solved one by one \
         without tables or series and added with compensation, highest first, over F_s + P",
        scene.surface.asperity_count,
        scene.separations.len(),
        2 * RUNS
    );
    let matrices: Vec<MomentMatrix> = SUM_TOLERANCES
        .iter()
        .filter_map(|&tolerance| {
            MomentMatrix::new(law.typical.as_ref(), &scene.surface, &scene.separations, tolerance)
                .inspect_err(|refusal| eprintln!("sums: compressed to {tolerance:e} is left out: {refusal}"))
                .ok()
        })
        .collect();
    let jobs: Vec<Job<'_>> = std::iter::once(job)
        .chain(matrices.iter().map(|matrix| Job { moments: Some(matrix), ..job }))
        .collect();
    let mut tasks: Vec<Box<dyn FnMut() + '_>> = Vec::new();
    for job in &jobs {
        let mut workspace = Workspace::new(job);
        tasks.push(Box::new(move || workspace.replicas(job, 0..LANES as u64, |_, _| ())));
    }
    let seconds = least_seconds_of(2 * RUNS, &mut tasks);
    for (of, seconds) in jobs.iter().zip(seconds) {
        let mut curves: Vec<Curves> = Vec::new();
        Workspace::new(of).replicas(of, 0..LANES as u64, |_, of_replica| curves.push(of_replica.clone()));
        let error = curves.iter().zip(&truth).fold(0.0, |worst: f64, (curves, truth)| {
            let external = &curves.total[Quantity::ExternalForce.index()];
            external
                .iter()
                .zip(truth)
                .fold(worst, |worst, (f, [truth, size])| worst.max((f - truth).abs() / size))
        });
        let (method, parameters, refusal) = match of.moments {
            None => ("direct", String::new(), None),
            Some(MomentMatrix { tolerance, .. }) => (
                "moments",
                format!("{tolerance:e} tolerance"),
                Summation::by_moments(&job, *tolerance).refusal,
            ),
        };
        let remark = refusal.map_or(String::new(), |why| format!("; a run sums directly: {why}"));
        table.row("sums", method, &parameters, seconds / LANES as f64, error, &format!("{what}{remark}"));
    }
}

/// External force of a replica and the sum of the magnitudes of its parts, N, at every separation: each
/// asperity by itself.
fn summed_one_by_one(scene: &Scene, index: u64) -> Vec<[f64; 2]> {
    let parameters = LawParameters::new(&scene.asperity, scene.history, scene.interference_range())
        .expect("a validated scene");
    let law =
        scene.model.law(&LawParameters { table_range: None, ..parameters }).expect("a law of the scene");
    let mut heights = Vec::new();
    let draw = Draw { seed: scene.seed, scheme: scene.sampling, index };
    draw.of(&scene.surface, &mut heights, &mut Vec::new());
    heights.sort_unstable_by(f64::total_cmp);
    let at = |&h: &f64| {
        let d = scene.surface.asperity_separation(h);
        let (mut out, mut stats) = (Responses::default(), SolverStats::default());
        let (mut force, mut size) = (Compensated::default(), Compensated::default());
        let facing = Facing { law: law.as_ref(), heights: &heights, separation: d };
        let ranges: Vec<_> = facing.regime_ranges().collect();
        for (regime, range) in ranges.into_iter().rev() {
            for u in heights[range].iter().rev() {
                law.evaluate(regime, Lanes::Own, &[u - d], &mut out, &mut stats);
                for (part, sign) in [(out.contact[0], 1.0), (out.adhesion[0], -1.0)] {
                    force.add(sign * part);
                    size.add(part);
                }
            }
        }
        [force.value(), size.value()]
    };
    scene.separations.par_iter().map(at).collect()
}

/// Mean pull-off of case II over numbers of replicas.
fn monte_carlo(table: &mut Table) {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let all = rayon::ThreadPoolBuilder::new().build().expect("threads");
    let scene = scene("case_ii");
    let law = scene.law().expect("a law of the scene");
    let model = || one.install(|| Expectations::new(law.view(), &scene.surface, &scene.separations));
    let expectations = model();
    let of_scheme = |scheme| Job { scheme, ..job(&scene, law.view(), BATCH) };
    let try_out = |scheme| one.install(|| Summation::by_moments(&of_scheme(scheme), COMPRESSED));
    let basis_of =
        |scheme, replicas| basis(law.view(), &scene.surface, &scene.separations, Draws { scheme, replicas });
    let places_of = |scheme: SamplingScheme, replicas| {
        let eligible = &basis_of(scheme, replicas).tested[1];
        controls(&scene.separations, &expectations, eligible, replicas / scheme.group())
    };
    let schemes = SamplingScheme::ALL.map(|(_, scheme)| (scheme, try_out(scheme), places_of(scheme, 1024)));
    let mut tasks: Vec<Box<dyn FnMut() + '_>> = vec![
        Box::new(|| drop(black_box(scene.law()))),
        Box::new(|| drop(black_box(model()))),
        Box::new(|| drop(black_box(try_out(SamplingScheme::Independent)))),
        Box::new(|| drop(black_box(basis_of(SamplingScheme::Independent, 1024)))),
    ];
    for (scheme, summation, places) in &schemes {
        let matrix = Some(summation.matrix.as_ref().expect("case II compresses"));
        for (matrix, batches) in [(None, DIRECT_BATCHES), (matrix, COMPRESSED_BATCHES)] {
            let job =
                Job { moments: matrix, controls: places, replicas: batches * BATCH, ..of_scheme(*scheme) };
            let mut workspace = Workspace::new(&job);
            tasks.push(Box::new(move || {
                let mut merged = ReductionTree::of(&job);
                (0..batches)
                    .for_each(|index| merged.push(&Batch::compute(&job, &mut workspace, index).ensemble));
                black_box(merged.into_ensemble(&job));
            }));
        }
    }
    let least = least_seconds_of(RUNS, &mut tasks);
    drop(tasks);
    let [law_seconds, model_seconds, try_seconds, basis_seconds] = [0, 1, 2, 3].map(|task| least[task]);
    for (i, (name, _)) in SamplingScheme::ALL.iter().enumerate() {
        let (scheme, summation, _) = &schemes[i];
        let direct_seconds = least[4 + 2 * i] / (DIRECT_BATCHES * BATCH) as f64;
        let compressed_seconds = least[5 + 2 * i] / (COMPRESSED_BATCHES * BATCH) as f64;
        let compressed = Job { moments: summation.matrix.as_ref(), ..of_scheme(*scheme) };
        for (replicas, seeds) in ENSEMBLES {
            let places = places_of(*scheme, replicas);
            let means =
                estimates(&Job { replicas, controls: &places, ..compressed }, &expectations, seeds, &all);
            for (controlled, of) in [("", 0), (", controlled", 1)] {
                if of == 1 && places.is_empty() {
                    continue;
                }
                let estimates: Vec<[f64; 2]> = means.iter().map(|means| means[of]).collect();
                let count = estimates.len() as f64;
                let mean = estimates.iter().map(|[mean, _]| mean).sum::<f64>() / count;
                let reported =
                    (estimates.iter().map(|[_, error]| error * error).sum::<f64>() / count).sqrt() / mean;
                let squares = estimates.iter().map(|[value, _]| (value - mean).powi(2)).sum::<f64>();
                let scatter = (squares / (count - 1.0)).sqrt() / mean;
                let share = if of == 1 { model_seconds + basis_seconds } else { 0.0 };
                let what = format!(
                    "case II, mean pull-off: core seconds, setting up and replicas times the least seconds of one; error: root mean \
                     square of the standard errors that {seeds} compressed runs of different seeds report, over the mean; the \
                     scatter of their means is {scatter:.2e}; {} controls",
                    if of == 1 { places.len() } else { 0 }
                );
                for (sum, each, set_up) in [
                    ("moments", compressed_seconds, law_seconds + try_seconds + share),
                    ("direct", direct_seconds, law_seconds + share),
                ] {
                    let method = format!("{name}{controlled}, {sum}");
                    let parameters = format!("{replicas} replicas");
                    table.row(
                        "monte_carlo",
                        &method,
                        &parameters,
                        set_up + replicas as f64 * each,
                        reported,
                        &what,
                    );
                }
            }
        }
    }
}

/// Mean pull-off and its standard error, N, without and with control variates, of runs with the seeds from 1.
fn estimates(
    job: &Job<'_>,
    expectations: &Expectations,
    seeds: u64,
    pool: &rayon::ThreadPool,
) -> Vec<[[f64; 2]; 2]> {
    let expected = &expectations.expected[Quantity::ExternalForce.index()];
    let expected: Vec<f64> = job.controls.iter().map(|&place| expected[place]).collect();
    let estimate = |seed| {
        let job = Job { seed, ..*job };
        let outcome = stiction::engine::run(&job, pool, &AtomicBool::new(false), |_, _| Ok::<(), ()>(()));
        let Ok(Outcome::Complete(reduction_tree)) = outcome else { panic!("nothing ends the run") };
        let ensemble = reduction_tree.into_ensemble(&job);
        let pull_off = controlled_means(&ensemble.groups.scalars, &expected)[0];
        [
            [pull_off.mean, pull_off.standard_error],
            [pull_off.controlled_mean, pull_off.controlled_standard_error],
        ]
    };
    (1..=seeds).map(estimate).collect()
}

/// The statistical integral of the cases.
fn integral(table: &mut Table) {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for (case, name) in [("I", "case_i"), ("II", "case_ii"), ("III", "case_iii")] {
        let scene = scene(name);
        let law = scene.law().expect("a law of the scene");
        let taken = |separations: &[f64], tolerance: f64| {
            Expectations::with_tolerance(law.view(), &scene.surface, separations, tolerance)
        };
        let known = known_integral(case);
        let places: Vec<f64> =
            known.iter().map(|(h_star, _)| h_star * scene.surface.surface_height_std).collect();
        let truth: Vec<[f64; 2]> = known.iter().map(|(_, values)| *values).collect();
        let tightest = taken(&scene.separations, 0.0);
        let [external, adhesion, contact] =
            [Quantity::ExternalForce, Quantity::AdhesionForce, Quantity::ContactForce]
                .map(|q| &tightest.expected[q.index()]);
        let tightest: Vec<[f64; 2]> =
            (0..external.len()).map(|k| [external[k], adhesion[k] + contact[k]]).collect();
        let largest = |model: &Expectations, truth: &[[f64; 2]]| {
            let external = &model.expected[Quantity::ExternalForce.index()];
            external
                .iter()
                .zip(truth)
                .fold(0.0, |worst: f64, (f, [truth, size])| worst.max((f - truth).abs() / size))
        };
        let timed = |tolerance| one.install(|| taken(&scene.separations, tolerance));
        let mut tasks: Vec<Box<dyn FnMut() + '_>> = Vec::new();
        for tolerance in INTEGRAL_TOLERANCES {
            tasks.push(Box::new(move || drop(black_box(timed(tolerance)))));
        }
        for (tolerance, seconds) in
            INTEGRAL_TOLERANCES.into_iter().zip(least_seconds_of(2 * RUNS, &mut tasks))
        {
            let of_tightest = largest(&timed(tolerance), &tightest);
            let of_known = largest(&taken(&places, tolerance), &truth);
            let what = format!(
                "integral of case {case} at {} separations, least of {} runs, 1 thread; error of the external force over F_s + P: \
                 {of_known:.1e} against 40-digit values at {} separations, {of_tightest:.1e} against the tightest tolerance \
                 that rounding allows at all",
                scene.separations.len(),
                2 * RUNS,
                places.len()
            );
            let parameters = format!("{tolerance:e} tolerance");
            table.row(
                "integral",
                &format!("case {case}"),
                &parameters,
                seconds,
                of_known.max(of_tightest),
                &what,
            );
        }
    }
}

/// External force and F_s + P, N, of a case on approach, by h*, from `tests/data/rough_surface.csv`.
fn known_integral(case: &str) -> Vec<(f64, [f64; 2])> {
    let mut found: Vec<(f64, [f64; 2])> = Vec::new();
    for line in include_str!("../tests/data/rough_surface.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        if fields[0] != case || fields[1] != "approach" {
            continue;
        }
        let [h_star, adhesion, external] = [3, 6, 7].map(|i| fields[i].parse::<f64>().expect("a number"));
        if found.last().is_none_or(|(last, _)| *last != h_star) {
            found.push((h_star, [0.0; 2]));
        }
        let (_, sums) = found.last_mut().expect("just pushed");
        sums[0] += external;
        sums[1] += external + 2.0 * adhesion;
    }
    found
}

/// One solve of an asperity, in contact and before it, with every instruction set.
fn solves(table: &mut Table) {
    let rows = reference();
    let chosen = InstructionSet::current();
    let end = Emd::new(LAMBDA, asperity::Path::Approach).expect("a valid lambda").end();
    for set in InstructionSet::available() {
        set.select();
        for (branch, parameters, low, high) in [
            ("contact", "solve", end, DEEPEST),
            ("before contact", "solve", end - SOLVED, end - 1e-9),
            ("before contact", "with series", FURTHEST, end - 1e-9),
        ] {
            let contact = branch == "contact";
            let series = low == FURTHEST;
            let tabulated = |law: Emd| {
                let law = law.with_contact_table(DEEPEST).with_noncontact_tables(FURTHEST);
                if series { law.with_far_series(FURTHEST) } else { law }
            };
            let law = tabulated(Emd::new(LAMBDA, asperity::Path::Approach).expect("a valid lambda"));
            let approaches: Vec<f64> =
                (0..SOLVES).map(|i| low + (high - low) * (i as f64 + 0.5) / SOLVES as f64).collect();
            let least = least_seconds(50 * RUNS, || solve(&law, &approaches, contact)) / SOLVES as f64;
            let rows = rows.iter().filter(|row| row.contact == contact);
            let (mut count, mut error) = (0, 0.0_f64);
            for row in rows {
                let path = if contact { asperity::Path::Retraction } else { asperity::Path::Approach };
                let law = tabulated(Emd::new(row.lambda, path).expect("a valid lambda"));
                let mut stats = SolverStats::default();
                let solution = if contact {
                    law.contact(row.delta, &mut stats)
                } else {
                    law.noncontact(row.delta, &mut stats)
                };
                let external = solution.radius.powi(3) - solution.adhesion;
                let size = row.external + 2.0 * row.adhesion;
                error = error.max((solution.adhesion - row.adhesion).abs() / row.adhesion);
                error = error.max((external - row.external).abs() / size);
                count += 1;
            }
            let needed = if series { "as a surface needs it, a series for most" } else { "all solved" };
            let what = format!(
                "{branch}: {SOLVES} rising approaches from {low:.3} to {high:.3} at lambda = {LAMBDA} in blocks of {BLOCK}, {needed}, least \
                 of {} runs, 1 thread; error: worst of {count} rows of all lambdas",
                50 * RUNS
            );
            table.row("peers", &format!("stiction {set}, {branch}"), parameters, least, error, &what);
        }
    }
    chosen.select();
}

fn solve(law: &Emd, approaches: &[f64], contact: bool) {
    let (mut stats, mut block) = (SolverStats::default(), [0.0; BLOCK]);
    let (mut adhesion, mut radius) = ([0.0; BLOCK], [0.0; BLOCK]);
    for approaches in black_box(approaches).chunks_exact(BLOCK) {
        block.copy_from_slice(approaches);
        if contact {
            law.contact_block(&mut block, &mut adhesion, &mut radius, &mut stats);
        } else {
            InstructionSet::current().run(
                #[inline(always)]
                || law.noncontact_block(&mut block, &mut adhesion, &mut stats),
            );
        }
        black_box((&adhesion, &radius));
    }
}

/// A row of the 50-digit values.
struct Row {
    lambda: f64,
    delta: f64,
    contact: bool,
    adhesion: f64,
    external: f64,
}

fn reference() -> Vec<Row> {
    let lines = include_str!("../tests/data/single_asperity.csv").lines().skip(1);
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let [lambda, delta, adhesion, external] =
            [0, 1, 3, 4].map(|i| fields[i].parse::<f64>().expect("a number"));
        Row { lambda, delta, contact: fields[2] == "contact", adhesion, external }
    };
    lines.map(row).collect()
}
