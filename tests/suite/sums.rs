//! Sums under stress: forces that cancel, a hundred million asperities or one, all of them in one regime,
//! quantities that hardly vary, a million merged batches; against sums without rounding and closed forms.

use crate::common::exact::Exact;
use crate::common::program::{Folder, QUICK, assert_exit, text};
use crate::common::unlocked;
use crate::common::{case, job, law, respond};
use std::sync::atomic::AtomicBool;
use stiction::asperity::{Facing, Path, Quantity, Scratch, SolverStats};
use stiction::engine::moments::MomentMatrix;
use stiction::engine::stream::{Purpose, stream};
use stiction::engine::{Curves, Job, Workspace};
use stiction::integral::Expectations;
use stiction::math::moments::{Comoments, Moments};
use stiction::surface::{Heights, SamplingScheme, Surface};

/// Half a unit in the last place of 1.
const U: f64 = 0.5 * f64::EPSILON;

/// What rounding may take of a sum of forces of one sign, relative: a lane of a block adds 256/8 numbers,
/// which takes 31 roundings, lanes are combined in 3; blocks and regimes are added with compensation, 2
/// roundings each whatever their number (Neumaier 1974; its second-order term is below 1e-9 of the first even
/// for 1e6 blocks).
const DIRECT_SUM: f64 = 38.0 * U;

/// The curves of one replica.
fn curves(job: &Job<'_>, replica: u64) -> Curves {
    let mut found = None;
    Workspace::new(job).replicas(job, replica..replica + 1, |_, curves| found = Some(curves.clone()));
    found.unwrap()
}

/// F_s, P and F of a replica at a separation h, without rounding of the sums: heights are solved a few at a
/// time.
fn exact(job: &Job<'_>, replica: u64, separation: f64) -> [f64; 3] {
    let d = job.surface.asperity_separation(separation);
    let mut heights = Vec::new();
    job.draw(replica).of(job.surface, &mut heights, &mut Vec::new());
    let [mut adhesion_sum, mut contact_sum] = [Exact::default(), Exact::default()];
    let (mut scratch, mut stats) = (Scratch::default(), SolverStats::default());
    for heights in heights.chunks_mut(1 << 14) {
        heights.sort_unstable_by(f64::total_cmp);
        let facing = Facing { law: job.laws.typical, heights, separation: d };
        facing.for_each_block(&mut scratch, &mut stats, |_, range, responses| {
            for (adhesion, contact) in responses.adhesion.iter().zip(&responses.contact).take(range.len()) {
                adhesion_sum.add(*adhesion);
                contact_sum.add(*contact);
            }
        });
    }
    [adhesion_sum.value(), contact_sum.value(), contact_sum.less(&adhesion_sum).value()]
}

/// Has the sums of one replica at one of its separations within a share of F_s + P of the exact ones.
#[track_caller]
fn assert_close(curves: &Curves, k: usize, exact: [f64; 3], share: f64, place: &str) {
    let quantities = [Quantity::AdhesionForce, Quantity::ContactForce, Quantity::ExternalForce];
    for (quantity, exact_sum) in quantities.into_iter().zip(exact) {
        let error = (curves.total[quantity.index()][k] - exact_sum).abs() / (exact[0] + exact[1]);
        assert!(
            error <= share,
            "{place}: {} is off by {error:e} of F_s + P, more than {share:e}",
            quantity.name()
        );
    }
}

#[test]
fn the_exact_sum_is_exact() {
    let sum = |values: &[f64]| {
        let mut sum = Exact::default();
        values.iter().for_each(|value| sum.add(*value));
        sum.value()
    };
    assert_eq!(sum(&[1.0, 1e100, 1.0, -1e100]), 2.0);
    assert_eq!(sum(&[1e16, 1.0, 1e-16, -1e16, -1.0]), 1e-16);
    // 0.1 is 3602879701896397/2^55: ten of them exceed 1 by 2/2^55.
    let tenths: Vec<f64> = [0.1; 10].into_iter().chain([-1.0]).collect();
    assert_eq!(sum(&tenths), 2.0_f64.powi(-54));
    let [mut three, mut third] = [Exact::default(), Exact::default()];
    [1e16, 3.0].into_iter().for_each(|value| three.add(value));
    [1e16, 0.25].into_iter().for_each(|value| third.add(value));
    assert_eq!(three.less(&third).value(), 2.75);
    let many: Vec<f64> =
        (0..100_000).map(|i| 1.0 / f64::from(1 + i)).flat_map(|x| [x, -x / 3.0, x / 3.0, -x]).collect();
    assert_eq!(sum(&many), 0.0);
}

/// A separation h at which the external force of a replica crosses zero without a jump, by bisection of the
/// exact sum, and its sums there.
fn crossing(job: &Job<'_>, replica: u64) -> Option<(f64, [f64; 3])> {
    let sigma = job.surface.surface_height_std;
    let (mut low, mut high) = (-sigma, 6.0 * sigma);
    // Compressive when close, tensile when far.
    if exact(job, replica, low)[2] <= 0.0 || exact(job, replica, high)[2] >= 0.0 {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if exact(job, replica, middle)[2] > 0.0 { low = middle } else { high = middle }
    }
    let sums = exact(job, replica, high);
    (sums[2].abs() < 1e-10 * (sums[0] + sums[1])).then_some((high, sums))
}

/// Where adhesion and contact force cancel to ten digits and more, the sums are as accurate as ever relative
/// to F_s + P.
#[test]
fn cancelling_forces_keep_the_digits_of_their_parts() {
    let mut crossings = 0;
    for (name, path) in [("I", Path::Approach), ("II", Path::Approach), ("III", Path::Retraction)] {
        let (asperity, mut surface) = case(name);
        surface.asperity_count = 2000;
        let law = law("hybrid", &asperity, path, (-60e-9, 40e-9));
        let step = 0.1 * surface.surface_height_std;
        for replica in 0..3 {
            let Some((h, sums)) = crossing(&job(law.as_ref(), &surface, &[], 8), replica) else { continue };
            // A grid of 40 separations that has the crossing in its middle.
            let separations: Vec<f64> = (0..40).map(|i| h + step * f64::from(i - 20)).collect();
            let place = format!("case {name}, replica {replica}");
            let direct = job(law.as_ref(), &surface, &separations, 8);
            let summed = curves(&direct, replica);
            assert_close(&summed, 20, sums, DIRECT_SUM, &place);
            let forces = [Quantity::AdhesionForce, Quantity::ContactForce].map(|q| &summed.total[q.index()]);
            let near =
                (19..22).map(|k| forces[0][k] + forces[1][k]).fold(0.0, f64::max) / (sums[0] + sums[1]);
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let matrix = MomentMatrix::new(law.as_ref(), &surface, &separations, tolerance).unwrap();
                let compressed = Job { moments: Some(&matrix), ..direct };
                // Relative to the largest F_s + P at this separation and its neighbours, as the tolerance is
                // meant.
                assert_close(&curves(&compressed, replica), 20, sums, tolerance * near, &place);
            }
            crossings += 1;
        }
    }
    println!("{crossings} crossings");
    assert!(crossings >= 4, "{crossings}");
}

/// Replicas beyond the last whole group would be in the means, but in no standard error: the engine takes
/// none.
#[test]
#[should_panic(expected = "sampling = \"stratified\" needs a multiple of 8 replicas, such as 8 or 16")]
fn replicas_that_are_no_whole_groups_are_refused_by_the_engine() {
    let (asperity, surface) = case("II");
    let law = law("gw", &asperity, Path::Approach, (-30e-9, 20e-9));
    let separations = [0.0, 1e-9];
    let job = Job {
        scheme: SamplingScheme::Stratified,
        replicas: 12,
        ..job(law.as_ref(), &surface, &separations, 8)
    };
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    let _ = stiction::engine::run::<()>(&job, &pool, &AtomicBool::new(false), |_, _| Ok(()));
}

/// Memory that is available, bytes; as much as one likes where that is not said.
fn available() -> f64 {
    let memory = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = memory.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::INFINITY, |kilobytes| 1024.0 * kilobytes)
}

/// So many asperities in one replica at two separations, directly, and compressed where asked for.
fn many(asperities: usize, model: &str, tolerance: Option<f64>, bytes: f64) {
    if available() < bytes {
        let reason = format!("{asperities} asperities take {bytes:e} bytes, {:e} are available", available());
        return crate::common::program::skip("sums of many asperities", &reason);
    }
    let (asperity, mut surface) = case("II");
    surface.asperity_count = asperities;
    let law = law(model, &asperity, Path::Approach, (-30e-9, 20e-9));
    let sigma = surface.surface_height_std;
    let step = if tolerance.is_some() { 0.1 } else { 1.8 };
    let separations = [1.0, 1.0 + step].map(|h| h * sigma);
    let matrix = tolerance
        .map(|tolerance| MomentMatrix::new(law.as_ref(), &surface, &separations, tolerance).unwrap());
    let job = Job { moments: matrix.as_ref(), ..job(law.as_ref(), &surface, &separations, 8) };
    let curves = curves(&job, 0);
    for (k, &h) in separations.iter().enumerate() {
        let counted: f64 = (0..law.regimes().len()).map(|r| curves.regime_count[r * 2 + k]).sum();
        assert_eq!(counted, asperities as f64);
        assert_close(
            &curves,
            k,
            exact(&job, 0, h),
            tolerance.unwrap_or(DIRECT_SUM),
            &format!("{model}, {asperities}"),
        );
    }
}

#[test]
fn a_million_asperities_are_summed_as_exactly() {
    many(1_000_000, "hybrid", Some(1e-9), 3e8);
}

/// 800 MB of heights.
#[test]
#[ignore = "slow"]
fn a_hundred_million_asperities_are_summed_as_exactly() {
    many(100_000_000, "hybrid", None, 1e9);
}

#[test]
#[ignore = "slow"]
fn ten_million_compressed_asperities_are_summed_to_the_tolerance() {
    many(10_000_000, "hybrid", Some(1e-9), 2e9);
}

/// The sum over one asperity is the law of that asperity, to the bit.
#[test]
fn one_asperity_is_its_law() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 1;
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let separations: Vec<f64> = (-60..300).map(|i| 0.1e-9 * f64::from(i)).collect();
    let job = job(law.as_ref(), &surface, &separations, 8);
    let mut reached = std::collections::BTreeSet::new();
    for replica in 0..8 {
        let mut height = [0.0];
        surface.heights.draw(&mut stream(5, Purpose::Heights, replica), &mut height);
        let curves = curves(&job, replica);
        for (k, &h) in separations.iter().enumerate() {
            let delta = height[0] - surface.asperity_separation(h);
            let (regime, [adhesion, contact, area]) = respond(law.as_ref(), delta).unwrap();
            let expected = Quantity::of_response(adhesion, contact, area);
            for quantity in Quantity::ALL {
                let sum = curves.total[quantity.index()][k];
                assert_eq!(
                    sum.to_bits(),
                    expected[quantity.index()].to_bits(),
                    "{} at {delta:e}",
                    quantity.name()
                );
            }
            reached.insert(regime.name());
        }
    }
    assert!(reached.len() >= 4, "{reached:?}");
}

/// One asperity through the whole program, alone and in many replicas.
#[test]
fn one_asperity_runs() {
    let scene = QUICK
        .replace("\"100 um^2\"", "\"0.135 um^2\"")
        .replace("from = -1.0, to = 8.0, count = 91", "from = -1.0, to = 6.0, count = 30");
    for replicas in ["1", "100"] {
        let folder = Folder::new(&scene);
        let run = folder.stiction(&["run", "scene.toml", "--replicas", replicas]);
        assert_exit(&run, 0);
        let validate = folder.stiction(&["validate", "scene.h5"]);
        assert_exit(&validate, 0);
        let compare = folder.stiction(&[
            "compare",
            "scene.toml",
            "--laws",
            "hybrid,gw",
            "--ensemble",
            "--replicas",
            replicas,
        ]);
        assert_exit(&compare, 0);
        for text in [run, validate, compare].map(|output| text(&output.stdout)) {
            assert!(!text.contains("NaN") && !text.contains("inf "), "{replicas} replicas: {text}");
        }
    }
}

/// Separations h, nm, at which every asperity of a flat surface of case II is in one regime of the hybrid
/// law.
const REGIMES: [(&str, f64, f64); 6] = [
    ("noncontact", 1.5, 2.5),
    ("lubricant", 0.4, 0.65),
    ("elastic", -2.0, 0.1),
    ("elastoplastic1", -12.0, -3.0),
    ("elastoplastic2", -50.0, -20.0),
    ("plastic", -300.0, -260.0),
];

/// A surface whose asperities have heights within some picometres, in one regime at all separations.
fn flat(low: f64, high: f64, height_std: &str) -> String {
    QUICK
        .replace(
            "surface_height_std = \"1.619 nm\"",
            &format!("surface_height_std = \"1.619 nm\"\nasperity_height_std = \"{height_std}\"\nmean_plane_offset = \"0 nm\""),
        )
        .replace(
            "h_star = { from = -1.0, to = 8.0, count = 91 }",
            &format!("h = {{ from = \"{low} nm\", to = \"{high} nm\", count = 21 }}"),
        )
        .replace("replicas = 200", "replicas = 40")
}

#[test]
#[ignore = "slow: four seconds"]
fn one_regime_alone_runs() {
    one_regime_alone("direct", |_| true);
    one_regime_alone("moments", |name| name == "elastic");
}

#[test]
#[ignore = "slow: ten seconds"]
fn every_regime_alone_runs_by_moments() {
    one_regime_alone("moments", |name| name != "elastic");
}

/// Every asperity in one regime: the ensemble's mean is the integral's, and what does not vary is not tested
/// and has no score.
fn one_regime_alone(sum: &str, of: fn(&str) -> bool) {
    for (i, (name, low, high)) in REGIMES.into_iter().enumerate().filter(|(_, regime)| of(regime.0)) {
        // A tolerance is one of F_s + P; deep in contact F_s is a thousandth of P, and hardly varies here:
        // 1e-9 would be the larger.
        let tolerance = if sum == "direct" { "" } else { "tolerance = 1e-12\n" };
        let solver = format!("[solver]\nsummation = \"{sum}\"\n{tolerance}[output]");
        let folder = Folder::new(&flat(low, high, "5 pm").replace("[output]", &solver));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let summary = text(&run.stdout);
        let validate = folder.stiction(&["validate", "scene.h5"]);
        assert_exit(&validate, 0);
        let table = text(&validate.stdout);
        for said in [&summary, &table] {
            assert!(!said.contains("NaN") && !said.contains("inf "), "{name}, {sum}: {said}");
            // Compressed sums may be too coarse for a test of what varies as little, but must not fail
            // it.
            let tested = said.contains("ensemble and integral agree, p = ");
            let allowed = said.contains("not tested") && (name == "lubricant" || sum == "moments");
            assert!(tested || allowed, "{name}, {sum}: {said}");
            assert!(!(tested && name == "lubricant"), "{name}, {sum}: {said}");
        }
        let file = unlocked::open(folder.path("scene.h5"));
        let values = |path: &str| file.dataset(path).unwrap().read_raw::<f64>().unwrap();
        for (regime, counts) in values("/ensemble/regime_count_mean").chunks_exact(21).enumerate() {
            let expected = if regime == i { 739.0 } else { 0.0 };
            assert!(counts.iter().all(|count| *count == expected), "{name}, {sum}: {counts:?}");
        }
        for quantity in Quantity::ALL.map(Quantity::name) {
            let [mean, expected] = ["ensemble", "integral"].map(|group| {
                values(&format!("/{group}/{quantity}{}", if group == "ensemble" { "_mean" } else { "" }))
            });
            let [std, error] =
                ["std", "standard_error"].map(|what| values(&format!("/ensemble/{quantity}_{what}")));
            let exact_std = values(&format!("/integral/{quantity}_std"));
            for k in 0..21 {
                let place = format!("{name}, {sum}, {quantity} at {k}: {:e} {:e}", mean[k], expected[k]);
                if expected[k].abs() < 1e-30 {
                    // What needs an asperity many σ_s away does not happen.
                    assert!(mean[k] == 0.0 && std[k] == 0.0, "{place}");
                    continue;
                }
                // 6 standard errors, in at most 500 places: false alarm below 1e-6; rounding where
                // nothing varies, and for compressed sums their tolerance, which is one of F_s + P.
                let rounding = if sum == "direct" { 1e-12 } else { 1e-9 } * expected[k].abs();
                // No error is known where nothing varies.
                assert!((mean[k] - expected[k]).abs() <= 6.0 * error[k].max(0.0) + rounding, "{place}");
                if exact_std[k] < 1e-30 {
                    assert!(std[k] <= 1e-14 * expected[k].abs(), "{place}: {:e}", std[k]);
                    continue;
                }
                // The standard deviation of 200 replicas is known to 1/√(2·200) = 5 %: five times that.
                assert!(
                    (std[k] - exact_std[k]).abs() <= 0.25 * exact_std[k] + rounding,
                    "{place}: {:e} {:e}",
                    std[k],
                    exact_std[k]
                );
            }
        }
        for force in ["adhesion_force", "external_force"] {
            let z = values(&format!("/validation/z_{force}"));
            assert_eq!(z.len(), 21);
            assert!(z.iter().all(|z| z.abs() < 6.0), "{name}, {sum}: {z:?}");
        }
    }
}

/// The integral's standard deviation of a replica whose asperities all but have one height: √N |f′(δ)| σ_s,
/// with f′ by a central difference of the law; the next terms are smaller by (σ_s/δ)².
#[test]
fn the_integral_knows_the_spread_of_what_hardly_varies() {
    let (asperity, surface) = case("II");
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 400e-9));
    let mut checked = 0;
    for (name, low, high) in REGIMES {
        for relative in [1e-4, 1e-7, 1e-10] {
            let h = 1e-9 * (0.5 * (low + high));
            let std = relative * h.abs();
            let surface =
                Surface { heights: Heights::gaussian(std), mean_plane_offset: 0.0, ..surface.clone() };
            let integral = Expectations::new(law.as_ref(), &surface, &[h]);
            let step = 1e-4 * h.abs();
            let [above, below] = [-h + step, -h - step].map(|delta| {
                let (_, [adhesion, contact, area]) = respond(law.as_ref(), delta).unwrap();
                Quantity::of_response(adhesion, contact, area)
            });
            for quantity in Quantity::ALL {
                let q = quantity.index();
                let slope = (above[q] - below[q]) / (2.0 * step);
                let expected = (surface.asperity_count as f64).sqrt() * slope.abs() * std;
                let found = integral.std[q][0];
                if slope == 0.0 {
                    let size = integral.expected[q][0].abs();
                    assert!(
                        found <= 1e-14 * size,
                        "{name}, {relative:e}, {}: {found:e} of {size:e}",
                        quantity.name()
                    );
                    continue;
                }
                // The difference is off by its step squared, heights of 1e-10 relative by their rounding.
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{name}, {relative:e}, {}: {found:e} {expected:e}",
                    quantity.name()
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 40, "{checked}");
}

/// Mean and sum of squared deviations of whole numbers, without rounding but the last.
fn two_pass(samples: impl Iterator<Item = [i64; 2]> + Clone) -> ([f64; 2], [f64; 3]) {
    let count = samples.clone().count() as i128;
    let sums =
        samples.clone().fold([0_i128; 2], |sums, s| [sums[0] + i128::from(s[0]), sums[1] + i128::from(s[1])]);
    // n Σ(x − x̄)(y − ȳ) = n Σxy − Σx Σy, in whole numbers.
    let products = samples.fold([0_i128; 3], |p, [x, y]| {
        let (x, y) = (i128::from(x), i128::from(y));
        [p[0] + x * x, p[1] + x * y, p[2] + y * y]
    });
    let centred = [
        count * products[0] - sums[0] * sums[0],
        count * products[1] - sums[0] * sums[1],
        count * products[2] - sums[1] * sums[1],
    ];
    (sums.map(|sum| sum as f64 / count as f64), centred.map(|product| product as f64 / count as f64))
}

/// A value around 1 whose deviations are units in the last place, whole multiples of ε: a spread of 1e-12,
/// and none at all. Merging m batches rounds the mean m times, the k-th time with the weight k/m of the last:
/// as good as random, by U√(m/3) in the root of the mean square.
#[test]
fn what_hardly_varies_has_a_spread() {
    for (units, replicas) in [(16_384, 1000), (16_384, 200_000), (1, 200_000)] {
        let samples = (0..replicas).map(|i| [i * i % 104_729 * 7919 % units, i * 7901 % units]);
        let (mean, products) = two_pass(samples.clone());
        let (mut moments, mut comoments) = (Moments::new(2), Comoments::new(2));
        let all: Vec<[i64; 2]> = samples.collect();
        for batch in all.chunks(8) {
            let (mut m, mut c) = (Moments::new(2), Comoments::new(2));
            for sample in batch {
                let values = sample.map(|units| 1.0 + f64::EPSILON * units as f64);
                m.push(&values);
                c.push(&values);
            }
            moments.merge(&m);
            comoments.merge(&c);
        }
        let freedom = (all.len() - 1) as f64;
        let exact = products.map(|product| product * f64::EPSILON * f64::EPSILON / freedom);
        let covariance = comoments.covariance();
        // Four standard deviations of the drift of the mean; nothing drifts where nothing varies.
        let drift = if units == 1 { 0.0 } else { 4.0 * U * (replicas as f64 / 24.0).sqrt() + U };
        for i in 0..2 {
            let error = (moments.mean()[i] - 1.0 - f64::EPSILON * mean[i]).abs();
            assert!(error <= drift, "{units}, {replicas}: {error:e}, {drift:e}");
            let share = if units == 1 { 0.0 } else { 2.0 * drift / exact[2 * i].sqrt() };
            for variance in [moments.std()[i].powi(2), covariance[3 * i]] {
                let off = (variance - exact[2 * i]).abs();
                assert!(off <= share * exact[2 * i], "{units}, {replicas}: {variance:e} {exact:?}");
            }
        }
        let limit = (covariance[0] * covariance[3]).sqrt();
        assert!((covariance[1] - covariance[2]).abs() <= 1e-12 * limit, "{covariance:?}");
        assert!(covariance[1].abs() <= limit, "{covariance:?}");
    }
}

/// Batches of 8, merged one after the other, against whole numbers.
///
/// The bound: merging batch k moves the mean by 1/k of the difference, exactly but for one rounding of the
/// mean, U|x̄|, and 3 of the step, which is smaller by 1/k. An error that is there shrinks by 1 − 1/k. So k
/// e_k ≤ (k − 1) e_(k−1) + k U|x̄| (1 + …), and e_m ≤ U |x̄| (m + 1)/2, to which the batch's own 8 pushes add
/// 8 U|x̄|. Squares are sums of m + 8 terms ≥ 0, so rounding takes at most (m + 16) U of them; that the
/// deviations are off by e takes 2e/σ + (e/σ)² more (Cauchy and Schwarz).
#[test]
fn many_merged_batches_are_two_passes() {
    merged_batches_are_two_passes(100_000);
}

#[test]
#[ignore = "slow: two seconds"]
fn a_million_merged_batches_are_two_passes() {
    merged_batches_are_two_passes(1_000_000);
}

fn merged_batches_are_two_passes(batches: i64) {
    // Means 1000 and −17 with deviations of the order of 3 and 5, correlated.
    let sample = |i: i64| {
        let hash = (i.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407) >> 33)
            & 0xffff;
        let r = hash % 11 - 5;
        [1000 + r, -17 + r + (hash >> 8) % 13 - 6]
    };
    let (mean, products) = two_pass((0..8 * batches).map(sample));
    let (mut moments, mut comoments) = (Moments::new(2), Comoments::new(2));
    for batch in 0..batches {
        let (mut m, mut c) = (Moments::new(2), Comoments::new(2));
        for i in 8 * batch..8 * (batch + 1) {
            let values = sample(i).map(|value| value as f64);
            m.push(&values);
            c.push(&values);
        }
        moments.merge(&m);
        comoments.merge(&c);
    }
    let freedom = (8 * batches - 1) as f64;
    assert_eq!((moments.count(), comoments.count()), (8 * batches as u64, 8 * batches as u64));
    let exact = products.map(|product| product / freedom);
    let std = [exact[0].sqrt(), exact[2].sqrt()];
    let m = batches as f64;
    let of_mean = mean.map(|mean| U * mean.abs() * ((m + 1.0) / 2.0 + 8.0));
    let of_product = |i: usize, j: usize| {
        let [a, b] = [of_mean[i] / std[i], of_mean[j] / std[j]];
        ((m + 16.0) * U + a + b + a * b) * std[i] * std[j]
    };
    for (name, found) in [("moments", moments.mean()), ("comoments", comoments.mean())] {
        for i in 0..2 {
            let error = (found[i] - mean[i]).abs();
            println!("mean of {name}: off by {error:.1e}, at most {:.1e}", of_mean[i]);
            assert!(error <= of_mean[i], "{name}: {error:e}");
        }
    }
    let covariance = comoments.covariance();
    for i in 0..2 {
        let error = (moments.std()[i].powi(2) - exact[2 * i]).abs();
        println!("variance: off by {error:.1e}, at most {:.1e}", of_product(i, i));
        assert!(error <= of_product(i, i), "{error:e}");
    }
    for (place, (i, j)) in [(0, (0, 0)), (1, (0, 1)), (2, (1, 0)), (3, (1, 1))] {
        let error = (covariance[place] - exact[i + j]).abs();
        println!("covariance: off by {error:.1e}, at most {:.1e}", of_product(i, j));
        assert!(error <= of_product(i, j), "{error:e}");
    }
}

/// The work of two parts is the sum of each, and the larger of the largest residuals.
#[test]
fn work_adds_up() {
    let of = |k: u64, largest_residual: f64| SolverStats {
        contact_solves: k,
        noncontact_solves: 2 * k,
        constant: 3 * k,
        closed_form: 4 * k,
        far: 5 * k,
        unloaded: 6 * k,
        by_moments: 7 * k,
        evaluations: 8 * k,
        safeguarded: 9 * k,
        largest_residual,
    };
    for residuals in [[1e-3, 1e-2], [1e-2, 1e-3]] {
        let mut sum = of(10, residuals[0]);
        sum.merge(&of(1, residuals[1]));
        assert_eq!(sum, of(11, 1e-2));
    }
}
