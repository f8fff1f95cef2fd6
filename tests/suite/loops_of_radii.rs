//! Surfaces of several radii that are brought close and pulled back: against loops of one radius, against the law of each
//! radius asperity by asperity, against their integral, and themselves.

use crate::common::{brute_force, case, ensemble, flattening, one, respond, separations};
use stiction::asperity::scale::Asperity;
use stiction::asperity::{ContactHistory, Family, LawParameters, Loop, Path, Quantity, SurfaceLaws};
use stiction::asperity::{Model, model};
use stiction::engine::{Job, Loading, Protocol};
use stiction::integral::{Expectations, RetractionModel};
use stiction::surface::nayak::Spectrum;
use stiction::surface::{Heights, RADIUS_RANGE, Radii, SamplingScheme, Surface};
use stiction::validation::{Draws, JointTest, Verdict, basis_of_loop};

/// The loop and the laws of asperities that are typically one.
struct Setting {
    asperity: Asperity,
    model: Model,
    laws: SurfaceLaws,
    cycle: Loop,
}

impl Setting {
    fn new(model: Model, asperity: Asperity) -> Self {
        let parameters = LawParameters::new(&asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
        let family = Family::new(model, asperity, Path::Approach, RADIUS_RANGE).unwrap();
        let typical = model.law(&parameters).unwrap();
        let cycle = Loop::new(&model, &parameters).unwrap();
        Self { asperity, model, laws: SurfaceLaws { typical, family: Some(family) }, cycle }
    }

    /// With a second approach.
    fn repeated(self) -> Self {
        let parameters = LawParameters::new(&self.asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
        let cycle = Loop::repeated(&self.model, &parameters).unwrap();
        Self { cycle, ..self }
    }

    fn what(&self) -> String {
        format!("{} {:?}", self.model.name, self.model.contact())
    }

    fn job<'a>(&'a self, surface: &'a Surface, separations: &'a [f64], replicas: u64) -> Job<'a> {
        let stiffness_span = Some(0.2e-9);
        let protocol = Protocol { cycle: Some(&self.cycle), stiffness_span, ..Protocol::default() };
        Job { protocol, ..crate::common::job(self.laws.view(), surface, separations, replicas) }
    }

    /// The loop of an asperity of a radius, m, made for it alone.
    fn alone(&self, radius: f64) -> Loop {
        let asperity = Asperity { radius, ..self.asperity };
        let parameters = LawParameters::new(&asperity, Path::Approach, (0.0, 0.0)).unwrap();
        let parameters = LawParameters { table_range: None, ..parameters };
        Loop::new(&self.model, &parameters).unwrap()
    }
}

/// The laws that are looked at, each of a case.
fn settings() -> Vec<(Setting, Surface)> {
    let law = |name| model(name).unwrap();
    let all = [
        ("I", flattening("jg")),
        ("II", flattening("ke")),
        ("III", flattening("zmc")),
        ("I", flattening("tn")),
        ("I", law("isbl")),
        ("II", law("idmt")),
        ("II", flattening("jg")),
        ("I", law("md_kim")),
        ("III", law("jkr")),
        ("II", law("emd")),
    ];
    let setting = |(case_name, model): (&str, Model)| {
        let (asperity, surface) = case(case_name);
        (Setting::new(model, asperity), Surface { asperity_count: 300, ..surface })
    };
    all.into_iter().map(setting).collect()
}

/// Where all radii are one, the loops of one radius: curves, and what is kept of a replica.
#[test]
fn alike_radii_have_the_loops_of_one_radius() {
    for (setting, plain) in settings() {
        let setting = setting.repeated();
        let alike = Surface { radii: Radii::Sample([plain.asperity_radius; 2].into()), ..plain.clone() };
        let separations = separations(&plain, 0.5, 6.0, 45);
        let loading = Loading {
            stiffness: &[1e5, 1e6],
            preload: &[1e-5, 1e3],
            smallest_snap: 0.0,
            ways: (true, true),
            ..Loading::default()
        };
        let with = |job: Job<'_>| {
            let protocol = Protocol { loading, ..job.protocol };
            one(&Job { protocol, ..job })
        };
        let (mine, curves) = with(setting.job(&alike, &separations, 1));
        let job = setting.job(&plain, &separations, 1);
        let (truth, direct) = with(Job { laws: setting.cycle.approach().into(), ..job });
        let what = setting.what();
        for q in 0..4 {
            let scale = |k: usize| match q {
                3 => direct.total[3][k],
                _ => direct.total[0][k] + direct.total[1][k],
            };
            for k in 0..135 {
                let off = (curves.total[q][k] - direct.total[q][k]).abs();
                assert!(off <= 1e-11 * scale(k), "{what:?} {q} {k}: {off:e}");
            }
        }
        assert_eq!(curves.regime_count, direct.regime_count, "{what:?}");
        let close = |mine: f64, truth: f64, tolerance: f64| {
            let is_close = (mine - truth).abs() <= tolerance * truth.abs();
            assert!(is_close || mine.to_bits() == truth.to_bits(), "{what}: {mine:e} {truth:e}");
        };
        close(mine.pull_off_force, truth.pull_off_force, 1e-7);
        close(mine.peak_secant_stiffness, truth.peak_secant_stiffness, 1e-6);
        let [mine, truth] = [mine, truth].map(|replica| replica.cycle.unwrap());
        close(mine.touchdown_separation, truth.touchdown_separation, 1e-12);
        close(mine.detachment_separation, truth.detachment_separation, 1e-12);
        close(mine.dissipated_energy, truth.dissipated_energy, 1e-8);
        for (mine, truth) in curves.snaps.iter().zip(&direct.snaps) {
            close(*mine, *truth, 1e-6);
        }
    }
}

/// Asperities of many radii, each with a loop that was made for it alone, added up one by one; and the pull-off where all of
/// the retraction is looked at.
#[test]
fn the_retraction_is_the_sum_over_loops_of_each_radius() {
    const SEPARATIONS: usize = 16;
    for (number, (setting, plain)) in settings().into_iter().enumerate() {
        let surface = Surface { radii: Radii::LogNormal(0.5), asperity_count: 60, ..plain };
        let separations = separations(&surface, 0.0, 6.0, SEPARATIONS);
        let job = setting.job(&surface, &separations, 1);
        let (replica, curves) = one(&job);
        let (mut heights, mut radii) = (Vec::new(), Vec::new());
        job.draw(0).of(&surface, &mut heights, &mut radii);
        let loops: Vec<Loop> = radii.iter().map(|radius| setting.alone(*radius)).collect();
        let d = |h: f64| surface.asperity_separation(h);
        let closest = d(separations[0]);
        let sums_at = |h: f64| {
            let mut sums = [0.0; 3];
            for (height, cycle) in heights.iter().zip(&loops) {
                if let Some((_, forces)) = respond(&cycle.at(d(h) - closest), height - closest) {
                    sums.iter_mut().zip(forces).for_each(|(sum, force)| *sum += force);
                }
            }
            sums
        };
        let what = setting.what();
        for (k, &h) in separations.iter().enumerate() {
            let sums = sums_at(h);
            let total = |quantity: Quantity| curves.total[quantity.index()][SEPARATIONS + k];
            let scale = sums[0] + sums[1];
            for (quantity, sum) in [(Quantity::AdhesionForce, sums[0]), (Quantity::ContactForce, sums[1])] {
                let off = (total(quantity) - sum).abs();
                assert!(
                    off <= 1e-10 * scale,
                    "{what:?} {quantity:?} at {k}: {:e}, not {sum:e}",
                    total(quantity)
                );
            }
            let off = (total(Quantity::ContactArea) - sums[2]).abs();
            assert!(off <= 1e-10 * sums[2], "{what:?} area at {k}");
        }
        let kept = replica.cycle.as_ref().unwrap();
        let distances = heights.iter().zip(&loops).map(|(height, cycle)| cycle.detachment(height - closest));
        let last = distances.flatten().fold(f64::NAN, f64::max) + separations[0];
        assert!((kept.detachment_separation / last - 1.0).abs() < 1e-9, "{what:?}");
        // Two of them: it takes a second.
        if number % 6 != 0 {
            continue;
        }
        let mut events = Vec::new();
        for (height, cycle) in heights.iter().zip(&loops) {
            let largest = height - closest;
            let recovery = cycle.recovery(largest);
            let history = cycle.history(largest);
            let kinks = match history {
                ContactHistory::Yielded => cycle.flattened_kinks(largest).to_vec(),
                own => cycle.kinks()[own as usize].clone(),
            };
            events.extend(kinks.iter().map(|kink| separations[0] + recovery - kink));
        }
        let force = |h: f64| {
            let [adhesion, load, _] = sums_at(h);
            load - adhesion
        };
        let (place, deepest) = brute_force::deepest(&separations, events, 0.2, force);
        let off = replica.pull_off_force / -deepest - 1.0;
        assert!(off.abs() < 1e-6, "{what:?}: {:?}, but {deepest:e} at {place:e}: {off:e}", replica);
    }
}

/// The same bits on one thread and on two.
#[test]
fn bits_do_not_depend_on_threads() {
    let (asperity, plain) = case("I");
    let setting = Setting::new(flattening("jg"), asperity);
    let surface = Surface { radii: Radii::Gamma(0.5), asperity_count: 100, ..plain };
    let separations = separations(&surface, 0.0, 6.0, 13);
    let job = setting.job(&surface, &separations, 80);
    let [one, two] = [1, 2].map(|threads| ensemble(&job, threads));
    assert_eq!(one.replicas, two.replicas);
    assert_eq!(crate::common::bytes(&one.curves), crate::common::bytes(&two.curves));
}

/// Ensemble against integral on both ways, of radii in `radii`; the verdict is a false alarm once in 1000 (the seed is
/// fixed), and one per cent more adhesion on retraction is seen.
fn agrees(setting: &Setting, surface: &Surface, replicas: u64) {
    let separations = separations(surface, 0.5, 5.0, 19);
    let scheme = SamplingScheme::Independent;
    let basis =
        basis_of_loop(setting.laws.view(), &setting.cycle, surface, &separations, Draws { scheme, replicas });
    let sampled = ensemble(&setting.job(surface, &separations, replicas), 2);
    let there = Expectations::new(setting.laws.view(), surface, &separations);
    let back = Expectations::retraction(&setting.cycle, surface, &separations);
    let what = (setting.what(), &surface.radii);
    // Measured: 1.7e-5 of gamma radii, 2.3e-5 of log-normal and 6e-5 of Nayak radii, whose retraction has jumps in the radius, and
    // 1.4e-4 of gamma radii by `zmc`, which has folds in the radius, too.
    let has_folds = setting.what().contains("Zhao") && matches!(surface.radii, Radii::Gamma(_));
    let most = if has_folds { 1.5e-4 } else { 1e-4 };
    assert!(back.quadrature_error < most, "{what:?}: {:e}", back.quadrature_error);
    let forces = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    let mean = forces.map(|q| sampled.curves[q].mean());
    let tested = |more: f64| {
        let joined = |q: usize, sign: f64| {
            let more = |k: usize| sign * more * back.expected[forces[0]][k];
            let back = back.expected[q].iter().enumerate().map(|(k, force)| force + more(k));
            there.expected[q].iter().copied().chain(back).collect::<Vec<f64>>()
        };
        let expected = [joined(forces[0], 1.0), joined(forces[1], -1.0)];
        let expected = [0, 1].map(|i| expected[i].as_slice());
        JointTest::new(&basis.probes, mean, expected, basis.cumulants, replicas)
    };
    let (test, planted) = (tested(0.0), tested(0.01));
    assert_eq!(test.verdict, Verdict::Agree, "{what:?}: {test:?}");
    assert_eq!(planted.verdict, Verdict::Disagree, "{what:?}: {planted:?}");
}

#[test]
fn a_few_radii_agree_with_their_integral() {
    let (asperity, plain) = case("I");
    let setting = Setting::new(flattening("jg"), asperity);
    let radii = Radii::Sample([1e-6, 1.6e-6, 2.4e-6].into());
    agrees(&setting, &Surface { radii, asperity_count: 1500, ..plain }, 48);
}

#[test]
#[ignore = "slow: a minute"]
fn radii_that_scatter_agree_with_their_integral() {
    for (name, contact) in [("I", "jg"), ("II", "zmc"), ("I", "tn")] {
        let (asperity, plain) = case(name);
        let setting = Setting::new(flattening(contact), asperity);
        let spectrum = Spectrum::of_asperities(plain.surface_height_std, plain.asperity_radius, 7.39e12);
        for radii in [Radii::Gamma(0.5), Radii::LogNormal(0.3), Radii::Nayak(spectrum)] {
            let heights = match &radii {
                Radii::Nayak(spectrum) => Heights::gaussian(spectrum.height_std()),
                _ => plain.heights.clone(),
            };
            agrees(&setting, &Surface { radii, heights, asperity_count: 1500, ..plain.clone() }, 80);
        }
    }
}

/// Measured asperities: their integral is their mean, and a whole map has it itself.
#[test]
fn a_whole_map_is_its_integral() {
    let (asperity, plain) = case("II");
    let setting = Setting::new(flattening("jg"), asperity);
    let std = plain.heights.std;
    let pair =
        |i: u32| [std * (4.0 * f64::from(i) / 199.0 - 2.0), 3.33e-6 * (0.5 + f64::from(i * i % 97) / 97.0)];
    let measured: Vec<[f64; 2]> = (0..200).map(pair).collect();
    let heights = Heights::sample(measured.iter().map(|pair| pair[0]).collect());
    let radii = Radii::Measured(measured.into());
    let surface = Surface { heights, radii, whole: true, asperity_count: 200, ..plain };
    let separations = separations(&surface, 0.0, 5.0, 21);
    let (_, curves) = one(&setting.job(&surface, &separations, 1));
    let back = Expectations::retraction(&setting.cycle, &surface, &separations);
    for q in 0..4 {
        for k in 0..21 {
            let scale = if q == 3 { back.expected[3][k] } else { back.expected[0][k] + back.expected[1][k] };
            let off = (curves.total[q][21 + k] - back.expected[q][k]).abs();
            assert!(off <= 1e-11 * scale, "{q} {k}: {off:e}");
        }
    }
    assert!(back.std.iter().flatten().all(|std| *std == 0.0));
}

/// What is expected is not smooth in the radius where ends of the law meet: without panels that end there the integral is off
/// by 1e-4. What is left, 4e-5 at most here, is of folds that the attraction of some radii has and that of others has not.
#[test]
fn the_integral_over_radii_knows_its_kinks() {
    for name in ["II", "III"] {
        let (asperity, plain) = case(name);
        let setting = Setting::new(flattening("zmc"), asperity);
        let surface = Surface { radii: Radii::LogNormal(0.4), ..plain };
        let [closest, ..] = separations(&surface, 0.75, 6.0, 2)[..] else { unreachable!() };
        let model = RetractionModel::new(&setting.cycle, &surface, closest);
        for h_star in [0.75, 2.5, 4.5, 5.5] {
            let error = model.answer(&[h_star * surface.surface_height_std]).quadrature_error;
            assert!(error < 5e-5, "{name} {h_star}: {error:e}");
        }
    }
}

/// Both states before contact, λ in 0.888..0.938: F̂_s and Δ by ε, with the constants of the law written out; the folds by
/// bisection of dΔ/dε.
#[test]
fn an_asperity_stays_on_the_inner_of_two_states_to_its_fold() {
    use std::f64::consts::PI;
    let state = |lambda: f64, gap: f64| {
        let z = 1.0 + gap;
        let stress = 8.0 / 3.0 * (z.powi(-3) - z.powi(-9)) / 1.03;
        let work = 4.0 / 3.0 * z.powi(-2) - z.powi(-8) / 3.0;
        let mu = lambda * stress;
        let (g, w) = (4.0 * (PI - 2.0) / (3.0 * PI) * mu.powf(1.5), 4.0 * work / PI);
        let y = w / (g + (g * g + w).sqrt());
        (-(2.06 / (PI * lambda) * gap + 4.0 / 3.0 * mu.sqrt() * y), 0.5 * PI * y * y)
    };
    let rises =
        |lambda: f64, gap: f64| state(lambda, gap * (1.0 + 1e-7)).0 > state(lambda, gap * (1.0 - 1e-7)).0;
    let bisect = |mut low: f64, mut high: f64, is_low: &dyn Fn(f64) -> bool| {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            *(if is_low(middle) { &mut low } else { &mut high }) = middle;
        }
        0.5 * (low + high)
    };
    for lambda in [0.895, 0.9, 0.92, 0.935] {
        // Between the folds Δ rises with ε: that is so at 0.19 for all of these λ.
        let inner_gap = bisect(0.05, 0.19, &|gap| !rises(lambda, gap));
        let outer_gap = bisect(0.19, 0.35, &|gap| rises(lambda, gap));
        let [inner, outer] = [inner_gap, outer_gap].map(|gap| state(lambda, gap).0);
        assert!(inner < outer);
        let parameters = LawParameters::scaled(lambda, Path::Approach).unwrap();
        let cycle = Loop::new(&model("emd").unwrap(), &parameters).unwrap();
        let adhesion = |largest: f64, delta: f64| respond(&cycle.at(largest - delta), largest).unwrap().1[0];
        let delta = 0.5 * (inner + outer);
        let on = |low: f64, high: f64| {
            let gap = bisect(low, high, &|gap| state(lambda, gap).0 > delta);
            state(lambda, gap).1
        };
        let [of_inner, of_outer] = [on(1e-6, inner_gap), on(outer_gap, 3.0)];
        assert!(of_inner > 1.05 * of_outer, "{lambda}: {of_inner} {of_outer}");
        // It has passed the outer fold, it has been in contact, and it has not passed the fold.
        for (largest, expected) in
            [(outer + 1e-6, of_inner), (0.5, of_inner), (outer - 1e-6, of_outer), (delta, of_outer)]
        {
            let adhesion = adhesion(largest, delta);
            assert!((adhesion / expected - 1.0).abs() < 1e-9, "{lambda} {largest}: {adhesion} {expected}");
        }
        // Beyond the inner fold it is on the outer state again.
        for (delta, is_inner) in [(inner + 1e-7, true), (inner - 1e-7, false)] {
            let adhesion = adhesion(0.5, delta);
            assert_eq!(adhesion > 0.5 * (of_inner + of_outer), is_inner, "{lambda} {delta}: {adhesion}");
        }
        // A cycle loses what lies between the states: ∫F_s dΔ of the inner state less that of the outer, by the trapezoidal
        // rule over even steps of the law, and over those of ε.
        let steps = 20_000;
        let between = |i: i32| inner + (outer - inner) * (f64::from(i) + 0.5) / f64::from(steps);
        let lost: f64 =
            (0..steps).map(|i| adhesion(0.5, between(i)) - adhesion(between(i), between(i))).sum::<f64>()
                * (outer - inner)
                / f64::from(steps);
        let integral = |from: f64, to: f64| -> f64 {
            let gap = |i: i32| from + (to - from) * f64::from(i) / 100_000.0;
            (0..100_000)
                .map(|i| {
                    let [a, b] = [i, i + 1].map(|i| state(lambda, gap(i)));
                    0.5 * (a.1 + b.1) * (b.0 - a.0)
                })
                .sum()
        };
        let at_outer = bisect(1e-6, inner_gap, &|gap| state(lambda, gap).0 > outer);
        let at_inner = bisect(outer_gap, 3.0, &|gap| state(lambda, gap).0 > inner);
        let exact = integral(inner_gap, at_outer) - integral(at_inner, outer_gap);
        assert!((lost / exact - 1.0).abs() < 1e-3, "{lambda}: {lost:e} {exact:e}");
    }
    // As lanes.
    let parameters = LawParameters::scaled(0.9, Path::Approach).unwrap();
    let cycle = Loop::new(&model("emd").unwrap(), &parameters).unwrap();
    for ratio in [0.97, 1.0, 1.04, 1.12, 1.3] {
        let own = cycle.of(cycle.lane(ratio));
        let scale = |power: f64| f64::powf(ratio, power);
        let lambda = 0.9 * scale(1.0 / 3.0);
        let parameters = LawParameters::scaled(lambda, Path::Approach).unwrap();
        let truth = Loop::new(&model("emd").unwrap(), &parameters).unwrap();
        for step in 0..400 {
            let delta = -1.045 + 1e-4 * f64::from(step) + 3.3e-6;
            for largest in [delta, -1.02, 0.3] {
                let of = |cycle: &Loop, unit: f64, largest: f64, delta: f64| {
                    respond(&cycle.at((largest - delta) * unit), largest * unit).unwrap().1[0]
                };
                let largest = f64::max(largest, delta);
                let mine = of(&own, scale(1.0 / 3.0), largest, delta) / ratio;
                let truth = of(&truth, 1.0, largest, delta);
                assert!((mine / truth - 1.0).abs() < 1e-9, "{ratio} {delta} {largest}: {mine} {truth}");
            }
        }
    }
}
