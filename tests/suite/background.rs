//! The attraction of mean planes: against `tests/data/background.csv`, series, limits and published formulas, and in
//! every force, feature and file that it belongs to.

use crate::common::program::{Folder, QUICK, assert_exit, bits, looped, small, text, unbroken};
use crate::common::unlocked;
use crate::common::{case, job, law};
use std::f64::consts::PI;
use std::sync::Arc;
use stiction::asperity::model;
use stiction::asperity::{Family, LawParameters, Loop, Path, Quantity, SurfaceLaws};
use stiction::background::{
    Background, Cap, Caps, Dispersion, Electrostatic, NamedForce, Strength, VACUUM_PERMITTIVITY, VanDerWaals,
};
use stiction::engine::{Ensemble, Job, MomentMatrix, Protocol};
use stiction::integral::{Expectations, Independence};
use stiction::math::quadrature::Rule;
use stiction::surface::{Heights, RADIUS_RANGE, Radii, Surface};
use stiction::{Scene, integrate};

const NM: f64 = 1e-9;
const EXTERNAL: usize = Quantity::ExternalForce as usize;

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(error <= tolerance, "{value:e}, not {expected:e}: off by {error:e}");
}

fn dispersion(hamaker_constant: f64, wavelength: Option<f64>, smallest_gap: f64) -> Dispersion {
    let planes = VanDerWaals::new(hamaker_constant, wavelength);
    Dispersion { planes, smallest_gap, contact_distance: 0.2 * NM, caps: None }
}

fn of(dispersion: Dispersion) -> Vec<NamedForce> {
    vec![("van_der_waals", Arc::new(dispersion))]
}

fn voltage(voltage: f64, dielectric: f64) -> Vec<NamedForce> {
    vec![("electrostatic", Arc::new(Electrostatic { voltage, dielectric }))]
}

/// The asperities of the caps of the reference.
fn caps(share: f64) -> Caps {
    let heights = Arc::new(Heights::gaussian(1.417 * NM));
    Caps {
        share,
        density: 7.39e12,
        work_of_adhesion: 0.09,
        equilibrium_spacing: 0.2 * NM,
        contact_distance: 0.2 * NM,
        mean_plane_offset: 1.867 * NM,
        classes: vec![Cap { radius: 3.33e-6, weight: 1.0, heights }],
        retardation: None,
    }
}

#[test]
fn every_row_of_the_reference_is_met() {
    let mut rows = 0;
    for line in include_str!("../data/background.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let (std, h, strength, length) = (NM * number(1), NM * number(2), number(3), NM * number(4));
        let terms = match fields[0] {
            "voltage" => voltage(strength, length),
            _ => {
                let plain = dispersion(strength, (length > 0.0).then_some(length), NM * number(5));
                of(Dispersion { caps: (number(6) > 0.0).then(|| caps(number(6))), ..plain })
            }
        };
        let background = Background::new(terms, std, (h - 2.0 * std, h + 3.0 * std));
        let Strength { energy, pressure, slope } = background.strength(h);
        // What is left of terms of opposite signs has their rounding.
        let tolerance = if number(6) > 0.0 { 1e-10 } else { 5e-12 };
        for (value, i) in [(energy, 7), (pressure, 8), (slope, 9), (background.pressure(h), 8)] {
            close(value, number(i), tolerance);
        }
        rows += 1;
    }
    assert_eq!(rows, 13);
}

/// Values between planes to ten digits, and of a rough surface whose faces have no distance of their own, by an
/// independent quadrature. Gregory (1981); ε₀ of CODATA 2018.
#[test]
fn planes_have_the_published_pressures() {
    let pressure = |wavelength, z| VanDerWaals::new(1e-19, wavelength).at(z).pressure;
    close(pressure(Some(100.0 * NM), 10.0 * NM), 4064.162214, 1e-9);
    close(pressure(None, 10.0 * NM), 5305.164770, 1e-9);
    close(pressure(Some(100.0 * NM), NM), 5164407.453, 1e-9);
    close(Electrostatic { voltage: -1.0, dielectric: 0.5 * NM }.at(5.0 * NM).pressure, 146350.2118, 1e-9);
    let plain = Dispersion { contact_distance: 0.0, ..dispersion(1e-19, None, NM) };
    let background = Background::new(of(plain), NM, (4.0 * NM, 6.0 * NM));
    close(background.pressure(5.0 * NM), 57774.21452, 1e-9);
    // 16πΔγZ₀² is what the Lennard-Jones attraction of asperities has far away.
    let far = 8.0 / 3.0 * 0.09 / (0.2 * NM) * (0.2_f64 / 50.0).powi(3);
    let planes = VanDerWaals::new(VanDerWaals::lennard_jones(0.09, 0.2 * NM), None);
    close(planes.at(50.0 * NM).pressure, far, 1e-14);
}

/// Retardation: A/6πz³ close by, A/4πbz⁴ far away; each is the derivative of the one before it.
#[test]
fn planes_have_their_limits_and_derivatives() {
    let (a, b) = (3e-20, 5.32 / 80e-9);
    let planes = VanDerWaals::new(a, Some(80e-9));
    close(planes.at(1e-14).pressure, a / (6.0 * PI * 1e-42), 1e-5);
    close(planes.at(1e-3).pressure, a / (4.0 * PI * b * 1e-12), 1e-4);
    let electrostatic = Electrostatic { voltage: 7.0, dielectric: 3e-9 };
    let terms: [&dyn Fn(f64) -> Strength; 2] = [&|z| planes.at(z), &|z| electrostatic.at(z)];
    for of in terms {
        for z in [0.3e-9, 2e-9, 15e-9, 300e-9] {
            let step = 1e-4 * z;
            let [below, above] = [of(z - step), of(z + step)];
            close((below.energy - above.energy) / (2.0 * step), of(z).pressure, 1e-6);
            close((above.pressure - below.pressure) / (2.0 * step), of(z).slope, 1e-6);
        }
    }
}

/// The asymptotic series of roughness, x = σ²/h²: 1 + 6x + 45x² + 420x³ of h⁻³, 1 + 10x + 105x² of h⁻⁴, and 1 + 3x
/// + 15x² + 105x³ of h⁻²; the next terms are 4725x⁴, 1260x³ and 945x⁴.
#[test]
fn roughness_adds_its_series() {
    let x: f64 = 1e-3;
    let std = x.sqrt() * 1000.0 * NM;
    let rough = |forces: Vec<NamedForce>| {
        Background::new(forces, std, (990.0 * NM, 1010.0 * NM)).pressure(1000.0 * NM)
    };
    let of_planes =
        |wavelength| Dispersion { contact_distance: 0.0, ..dispersion(1e-19, wavelength, 1.0 * NM) };
    let close_by = rough(of(of_planes(None))) / (1e-19 / (6.0 * PI * 1e-18));
    let retarded = rough(of(of_planes(Some(1e-16)))) / VanDerWaals::new(1e-19, Some(1e-16)).at(1e-6).pressure;
    let electrostatic = rough(voltage(3.0, 0.0)) / (0.5 * VACUUM_PERMITTIVITY * 9.0 / 1e-12);
    close(close_by, 1.0 + 6.0 * x + 45.0 * x * x + 420.0 * x.powi(3), 5000.0 * x.powi(4));
    close(retarded, 1.0 + 10.0 * x + 105.0 * x * x, 1500.0 * x.powi(3));
    close(electrostatic, 1.0 + 3.0 * x + 15.0 * x * x + 105.0 * x.powi(3), 1000.0 * x.powi(4));
}

/// The share of caps and the rest of the area come to about the whole: Derjaguin's approximation for all gaps of a
/// Gaussian surface, of which the asperities alone, to no end, have other amounts, and with the whole background more
/// than twice as much.
#[test]
fn asperities_and_background_count_each_gap_about_once() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        let text = scene_of(name).replace("[ensemble]", "[van_der_waals]\n\n[ensemble]");
        let scene = Scene::parse(&text).unwrap();
        let surface = Surface { background: None, ..scene.surface.clone() };
        let (work, spacing, std) = (asperity.work_of_adhesion, 0.2 * NM, surface.surface_height_std);
        let lennard_jones = VanDerWaals::lennard_jones(work, spacing);
        let all = |h: f64| {
            // The Lennard-Jones stress between planes at all gaps that are open.
            let planes = VanDerWaals::new(lennard_jones, None);
            let of = |g: f64| planes.at(g + spacing).pressure * (1.0 - (spacing / (g + spacing)).powi(6));
            let ends: Vec<f64> = (0..=400).map(|i| (h + 9.0 * std) * f64::from(i) / 400.0).collect();
            let panels = ends.windows(2).flat_map(|ends| Rule::shared().places(ends[0], ends[1]));
            let density = |g: f64| (-0.5 * ((g - h) / std).powi(2)).exp() / (std * (2.0 * PI).sqrt());
            surface.nominal_area * panels.map(|(g, width)| width * density(g) * of(g)).sum::<f64>()
        };
        let dry = stiction::asperity::Asperity { lubricant_thickness: 0.0, ..asperity };
        let law = law("idmt", &dry, Path::Approach, (-60e-9, 60e-9));
        for h_star in [4.0, 6.0, 9.0] {
            let h = h_star * std;
            let alone = Expectations::new(law.as_ref(), &surface, &[h]).expected[0][0];
            let both = alone + scene.surface.background_force(h);
            let share = both / all(h);
            assert!((0.92..1.08).contains(&share), "{name} {h_star}: {share}");
        }
    }
}

/// Of retarded mean planes the asperities are retarded too: with them the sum is within 4 % of the attraction of all gaps by
/// Derjaguin's approximation from 5 to 80 nm. Unretarded caps had 1.05 to 3.04 of it.
#[test]
fn asperities_are_retarded_as_their_planes() {
    let (work, spacing, std, rate) = (0.05, 0.2 * NM, 0.5 * NM, 5.32 / 100e-9);
    let text = QUICK
        .replace("\"hybrid\"", "\"idmt\"")
        .replace("0.09 J/m^2", "0.05 J/m^2")
        .replace("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = 0")
        .replace("3.33 um", "2 um")
        .replace("1.619 nm", "0.5 nm")
        .replace("7.39 /um^2", "40 /um^2")
        .replace("[ensemble]", "[van_der_waals]\nretarded = true\n\n[ensemble]");
    let scene = Scene::parse(&text).unwrap();
    let surface = Surface { background: None, ..scene.surface.clone() };
    let asperity = stiction::asperity::Asperity {
        radius: 2e-6,
        work_of_adhesion: work,
        lubricant_thickness: 0.0,
        ..case("II").0
    };
    let law = law("idmt", &asperity, Path::Approach, (-200e-9, 60e-9));
    for (h, unretarded) in [(5.0, 1.05), (10.0, 1.19), (20.0, 1.46), (40.0, 1.98), (80.0, 3.04)] {
        let h = h * NM;
        // The pressure of planes, by the definition of retardation, over normal gaps, by the midpoint rule.
        let planes = |z: f64| {
            let delay = 1.0 + rate * z;
            16.0 * PI * work * spacing * spacing * (2.0 + 3.0 * rate * z)
                / (12.0 * PI * z.powi(3) * delay * delay)
        };
        let steps = 2000;
        let step = 16.0 / f64::from(steps);
        let mean: f64 = (0..steps)
            .map(|i| -8.0 + step * (f64::from(i) + 0.5))
            .map(|x| planes(h + std * x + spacing) * (-0.5 * x * x).exp() * step / (2.0 * PI).sqrt())
            .sum();
        let alone = Expectations::new(law.as_ref(), &surface, &[h]).expected[0][0];
        let share = (alone + scene.surface.background_force(h)) / (surface.nominal_area * mean);
        assert!((share - 1.0).abs() < 0.041, "{h:e}: {share}, and {unretarded} before");
    }
}

/// The quick scene with the surface of a case, dry.
fn scene_of(name: &str) -> String {
    let (asperity, surface) = case(name);
    QUICK
        .replace("\"hybrid\"", "\"idmt\"")
        .replace("0.09 J/m^2", &format!("{:e} J/m^2", asperity.work_of_adhesion))
        .replace("3.33 um", &format!("{:e} m", asperity.radius))
        .replace("1.619 nm", &format!("{:e} m", surface.surface_height_std))
        .replace("7.39 /um^2", &format!("{:e} /m^2", surface.asperity_count as f64 / surface.nominal_area))
}

/// A background that is no small thing beside the asperities of case II.
fn with_background(surface: &Surface) -> Surface {
    let forces = [of(dispersion(1e-19, None, 0.2 * NM)), voltage(5.0, 2.0 * NM)].concat();
    let std = surface.surface_height_std;
    let background = Background::new(forces, std, (-2.0 * std, 9.0 * std));
    Surface { background: Some(Arc::new(background)), ..surface.clone() }
}

fn separations(surface: &Surface, count: usize) -> Vec<f64> {
    let h_star = |i: usize| -1.0 + 9.0 * i as f64 / (count - 1) as f64;
    (0..count).map(|i| h_star(i) * surface.surface_height_std).collect()
}

/// The curves of a job with a background are those without, less its force: at every state, and of no other quantity;
/// and the pull-off of each replica is that of its own curve at finer separations.
fn checked(name: &str, job: &Job<'_>, plain: &Surface) {
    let ensemble_of = |surface: &Surface| Job { surface, ..*job }.ensemble();
    let (with, without) = (job.ensemble(), ensemble_of(plain));
    let compare = |with: &[f64], without: &[f64], sign: f64| {
        for (k, (with, without)) in with.iter().zip(without).enumerate() {
            let force = job.surface.background_force(job.separations[k % job.separations.len()]);
            let expected = without - sign * force;
            let size = without.abs() + force;
            assert!((with - expected).abs() <= 1e-12 * size, "{name} {k}: {with:e}, {expected:e}");
        }
    };
    for quantity in 0..4 {
        let sign = if quantity == EXTERNAL { 1.0 } else { 0.0 };
        compare(with.curves[quantity].mean(), without.curves[quantity].mean(), sign);
    }
    let count = 20 * (job.separations.len() - 1) + 1;
    let fine = separations(plain, count);
    let fine = Job { separations: &fine, moments: None, ..*job }.ensemble();
    for (own, fine) in with.replicas.iter().zip(&fine.replicas) {
        close(own.pull_off_force, fine.pull_off_force, 1e-7);
        close(own.peak_secant_stiffness, fine.peak_secant_stiffness, 1e-3);
    }
}

#[test]
fn every_sum_has_the_background_once() {
    let (asperity, mut plain) = case("II");
    (plain.asperity_count, plain.nominal_area) = (700, 700.0 / 7.39e12);
    let surface = with_background(&plain);
    let separations = separations(&plain, 46);
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 60e-9));
    let direct = job(law.as_ref(), &surface, &separations, 8);
    checked("direct", &direct, &plain);
    let matrix = MomentMatrix::new(law.as_ref(), &surface, &separations, 1e-9).unwrap();
    checked("moments", &Job { moments: Some(&matrix), ..direct }, &plain);
    let parameters = LawParameters::new(&asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
    let cycle = Loop::new(&model("md_plastic").unwrap(), &parameters).unwrap();
    let protocol = Protocol { cycle: Some(&cycle), ..direct.protocol };
    checked("loop", &Job { protocol, laws: cycle.approach().into(), ..direct }, &plain);
    let family = Family::new(model("hybrid").unwrap(), asperity, Path::Approach, RADIUS_RANGE).unwrap();
    let typical = model("hybrid").unwrap().law(&parameters).unwrap();
    let laws = SurfaceLaws { typical, family: Some(family) };
    let scattered = Surface { radii: Radii::LogNormal(0.3), ..surface.clone() };
    let plain = Surface { background: None, ..scattered.clone() };
    let direct = Job { laws: laws.view(), surface: &scattered, ..direct };
    checked("radii", &direct, &plain);
    checked(
        "loop of radii",
        &Job { protocol: Protocol { cycle: Some(&cycle), ..direct.protocol }, ..direct },
        &plain,
    );
}

/// The integral, its pull-off and stiffness, the shift and attraction of the verdict, and the retraction of a loop.
#[test]
fn the_integral_has_the_background_once() {
    let text = looped(&small());
    let plain = Scene::parse(&text).unwrap();
    let scene = Scene { surface: with_background(&plain.surface), ..plain.clone() };
    let [with, without] = [&scene, &plain].map(|scene| integrate(scene).unwrap());
    let ways =
        [(with.main.clone(), without.main.clone()), (with.retraction.unwrap(), without.retraction.unwrap())];
    for (with, without) in ways {
        for (k, h) in plain.separations.iter().enumerate() {
            let force = scene.surface.background_force(*h);
            let forces = [&with, &without].map(|way| way.expectations.expected[EXTERNAL][k]);
            assert!((forces[0] - (forces[1] - force)).abs() <= 1e-13 * (force + forces[1].abs()), "{k}");
        }
        let Independence { shift, attractive_stiffness, substrate_stiffness, .. } = with.independence;
        close(-shift * substrate_stiffness, with.pull_off(), 1e-9);
        assert!(with.pull_off() > 1.5 * without.pull_off(), "a background that is seen");
        let h = with.features.steepest.place;
        let slope = |step: f64| -scene.surface.background_force(h + step) / 2e-14;
        let of_background = slope(1e-14) - slope(-1e-14);
        assert!(of_background > 0.0 && attractive_stiffness > of_background);
    }
    assert_ne!(with.main.independence, without.main.independence);
}

/// A spring pulls in a plate whose asperities do nothing where the plates are 2/3 of the rest gap g apart, V² =
/// 8kg³/27ε₀A: at constant V, it begins where dF/dh = ε₀AV²/h³ is k.
#[test]
fn a_spring_is_pulled_in_where_parallel_plates_are() {
    const SPRING: f64 = 1.0;
    for volts in [1.0_f64, 2.0] {
        let text = QUICK
            .replace("\"hybrid\"", "\"hertz\"")
            .replace(
                "h_star = { from = -1.0, to = 8.0, count = 91 }",
                "h = { from = \"30 nm\", to = \"200 nm\", count = 1701 }",
            )
            .replace("replicas = 200", "replicas = 8")
            + &format!(
                "\n[electrostatic]\nvoltage = \"{volts} V\"\n\n[instability]\nstiffness = \"{SPRING} N/m\"\n"
            );
        let scene = Scene::parse(&text).unwrap();
        let area = scene.surface.nominal_area;
        let place = (VACUUM_PERMITTIVITY * area * volts * volts / SPRING).cbrt();
        let result = stiction::run(&scene).unwrap();
        let snaps: &[f64] = &result.ensemble().snaps;
        let [occurred, separation, distance] = snaps[..3] else { panic!("{snaps:?}") };
        assert!(occurred == 1.0 && distance.is_nan(), "nothing stops it: {snaps:?}");
        // Roughness of σ/h = 0.02 adds 6 x = 0.2 % to the slope of the force, so 0.07 % to h; a step is 0.1 nm.
        assert!((separation - place).abs() < 0.15 * NM + 1e-3 * place, "{separation:e}, not {place:e}");
        // The rest gap is h + F/k there.
        let gap = separation + scene.surface.background_force(separation) / SPRING;
        close(8.0 * SPRING * gap.powi(3) / (27.0 * VACUUM_PERMITTIVITY * area), volts * volts, 5e-3);
    }
}

/// Without a voltage the bits are those without the table, and V and −V are alike; a scene with neither table has no
/// group of it.
#[test]
fn nothing_is_added_where_nothing_acts() {
    let layer = "dielectric_thickness = \"2 nm\"\nrelative_permittivity = 4.0\n";
    let few = || small().replace("replicas = 40", "replicas = 8");
    let scene = |volts: &str| format!("{}\n[electrostatic]\nvoltage = \"{volts}\"\n{layer}", few());
    let folder = Folder::new(&few());
    for (name, volts) in [("off", "0 V"), ("on", "3 V"), ("minus", "-3 V")] {
        std::fs::write(folder.path(&format!("{name}.toml")), scene(volts)).unwrap();
    }
    let run = |name: &str| {
        assert_exit(&folder.stiction(&["run", &format!("{name}.toml"), "-o", &format!("{name}.h5")]), 0);
        bits(&folder.path(&format!("{name}.h5")))
    };
    let [none, off, on, minus] = ["scene", "off", "on", "minus"].map(run);
    assert!(none.iter().all(|(name, _)| !name.contains("background")));
    let without = |all: &[(String, Vec<u64>)]| {
        all.iter().filter(|(name, _)| !name.contains("/background/")).cloned().collect::<Vec<_>>()
    };
    let (off, on, minus) = (without(&off), without(&on), without(&minus));
    assert_eq!(none, off);
    assert_eq!(on, minus);
    assert_ne!(none, on);
}

/// Runs, sweeps and comparisons have the background in their files, by terms; summary and description tell it.
#[test]
fn files_have_the_background() {
    let tables = "\n[van_der_waals]\nhamaker_constant = \"1e-19 J\"\nretarded = true\n\n[electrostatic]\nvoltage = \"3 V\"\n\
                  dielectric_thickness = [\"4 nm\", \"1 nm\"]\nrelative_permittivity = [4.0, 2.0]\n";
    let few = || small().replace("replicas = 40", "replicas = 8");
    let folder = Folder::new(&(few() + tables));
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    let reported = unbroken(&text(&check.stdout));
    assert!(
        reported.contains("A = 100.0 zJ, retarded: asperities own caps of 75.00 % of the area"),
        "{reported}"
    );
    assert!(reported.contains("voltage, 3.000 V") && reported.contains("a gap of 1.500 nm"), "{reported}");
    let run = folder.stiction(&["run", "scene.toml", "-o", "run.h5"]);
    assert_exit(&run, 0);
    assert_exit(&folder.stiction(&["compare", "scene.toml", "--laws", "hybrid,md,gw", "-o", "laws.h5"]), 0);
    let sweep = few()
        + tables
        + "\n[sweep]\n\"electrostatic.voltage\" = [\"0 V\", \"2 V\"]\n\
        \"van_der_waals.hamaker_constant\" = [\"1e-20 J\", \"200 zJ\"]\n";
    std::fs::write(folder.path("sweep.toml"), sweep).unwrap();
    assert_exit(&folder.stiction(&["run", "sweep.toml", "-o", "sweep.h5"]), 0);
    for name in ["run", "laws", "sweep"] {
        let validated = folder.stiction(&["validate", &format!("{name}.h5")]);
        assert_exit(&validated, 0);
    }
    let file = unlocked::open(folder.path("laws.h5"));
    let force = file.dataset("/background/van_der_waals_force").unwrap().read_raw::<f64>().unwrap();
    let rows: Vec<&[f64]> = force.chunks_exact(force.len() / 3).collect();
    assert_eq!(rows[1], rows[2], "neither has an attraction without end");
    assert!(rows[0].iter().zip(rows[1]).all(|(own, all)| own < all), "asperities of the first own caps");
    drop(file);
    // One point of the sweep is a scene of its own.
    let file = unlocked::open(folder.path("sweep.h5"));
    let force = file.dataset("/background/electrostatic_force").unwrap().read_raw::<f64>().unwrap();
    let point = force.len() / 4;
    assert!(force[..2 * point].iter().all(|force| *force == 0.0) && force[2 * point] > 0.0);
}

/// Coupled asperities: the pressure between the mean planes bends nothing, so what asperities do is the same without
/// it, and the forces are less by it, in both kinds of coupling and on both ways of a loop.
#[test]
#[ignore = "slow: four seconds"]
fn coupled_asperities_do_not_feel_the_background() {
    let scene = looped(&small()).replace("from = -1.0", "from = 1.0");
    let scene = scene.replace("count = 16", "count = 8").replace("replicas = 40", "replicas = 8");
    let table = "\n[electrostatic]\nvoltage = \"3 V\"\ndielectric_thickness = \"2 nm\"\nrelative_permittivity = 4.0\n";
    for coupling in ["periodic", "patch"] {
        let plain = format!("{scene}\n[substrate]\ncoupling = \"{coupling}\"\n")
            .replace("nominal_area = \"100 um^2\"", "nominal_area = \"6.77 um^2\"");
        let [plain, with] = [plain.clone(), plain + table].map(|text| Scene::parse(&text).unwrap());
        let (area, surface) = (with.separations.len(), with.surface.clone());
        let runs = [&plain, &with].map(|scene| stiction::run(scene).unwrap());
        let [plain, with]: [&Ensemble; 2] = [runs[0].ensemble(), runs[1].ensemble()];
        let size = with.curves[0].mean().iter().fold(0.0, |most: f64, force| most.max(*force));
        for quantity in [Quantity::AdhesionForce, Quantity::ContactForce, Quantity::ContactArea] {
            assert_eq!(plain.curves[quantity.index()].mean(), with.curves[quantity.index()].mean());
        }
        for (k, force) in with.curves[EXTERNAL].mean().iter().enumerate() {
            let h = runs[1].scene().separations[k % area];
            let expected = plain.curves[EXTERNAL].mean()[k] - surface.background_force(h);
            assert!(
                (force - expected).abs() < 1e-12 * (size + surface.background_force(h)),
                "{coupling} {k}"
            );
        }
        for (own, other) in with.replicas.iter().zip(&plain.replicas) {
            assert!(own.pull_off_force > other.pull_off_force.max(0.0), "{coupling}");
        }
    }
}

#[test]
fn what_the_background_leaves_out_is_warned_of() {
    let folder = Folder::new("");
    let check = |more: &str| {
        let text_of = small().replace("from = -1.0", "from = 1.0") + more;
        std::fs::write(folder.path("scene.toml"), text_of).unwrap();
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        text(&check.stdout).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let layer = |volts: &str, thickness: &str| {
        format!(
            "\n[electrostatic]\nvoltage = \"{volts}\"\ndielectric_thickness = \"{thickness}\"\nrelative_permittivity = 1.0\n"
        )
    };
    // 1.619 nm of gap and 98.381 nm: 100 nm.
    for (volts, warns) in [("34.9 V", false), ("35.1 V", true)] {
        let reported = check(&layer(volts, "98.381 nm"));
        assert_eq!(reported.contains("more than 350.0 MV/m"), warns, "{reported}");
        assert!(!reported.contains("Paschen"), "{reported}");
    }
    for (volts, warns) in [("326 V", false), ("-328 V", true)] {
        assert_eq!(check(&layer(volts, "10 um")).contains("Paschen"), warns);
    }
    assert!(!check("\n[van_der_waals]\n").contains("taken as normal"));
    let reported = check("\n[van_der_waals]\n\n[surface.heights]\nlaw = \"exponential\"\n");
    assert!(
        reported.contains("the gaps between the mean planes are taken as normal, not exponential"),
        "{reported}"
    );
}
