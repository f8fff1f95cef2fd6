//! Round trips over the whole range of λ: from an angle or a gap by the equations as printed, with the
//! trigonometric functions of the standard library, to Δ, and back by the solver.
//!
//! The dense sweep takes longer and runs with `cargo test --release -- --ignored`.

use std::f64::consts::{FRAC_PI_2, PI};
use stiction::asperity::emd::Emd;
use stiction::asperity::{Path, SolverStats};

/// Δ, F_s, A in contact as Maugis (1992) gives them, with m = sec θ; for θ not too small.
fn maugis(lambda: f64, angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let alpha = lambda / 2.0 * (sin * cos - angle * (2.0 * angle).cos());
    let beta = 4.0 * lambda * lambda / 3.0 * (angle * sin + cos - 1.0);
    let outer = 2.0 / (beta + (beta * beta + 4.0 * alpha).sqrt());
    let radius = outer * cos;
    [radius * radius - 4.0 / 3.0 * lambda * outer * sin, lambda * outer * outer * (sin * cos + angle), radius]
}

/// Δ, F_s before contact from the gap z = h₀/Z₀ as Shi and Polycarpou (2005) give them, with the −Z₀.
fn extension(lambda: f64, z: f64) -> [f64; 2] {
    let stress = 8.0 / 3.0 * (z.powi(-3) - z.powi(-9)) / 1.03;
    let stats = 4.0 / 3.0 * z.powi(-2) - z.powi(-8) / 3.0;
    let b = 4.0 * (PI - 2.0) / (3.0 * PI) * lambda * stress;
    let offset = 2.0 * stats / (PI * lambda * stress);
    let outer = 2.0 * offset / (b + (b * b + 2.0 * offset).sqrt());
    let approach = -((z - 1.0) * 2.06 / (PI * lambda) + 4.0 / 3.0 * lambda * stress * outer);
    [approach, PI / 2.0 * lambda * stress * outer * outer]
}

/// What rounding Δ, which the round trip passes through, does to a value: its change when the parameter moves
/// so far that Δ changes by ε of its terms, and by ε of the parameter itself.
fn allowed(value: f64, slope: f64, approach_slope: f64, terms: f64, parameter: f64) -> f64 {
    100.0 * f64::EPSILON * (value.abs() + (slope / approach_slope).abs() * terms + slope.abs() * parameter)
}

fn round_trips(lambdas: usize, points: usize) {
    let mut stats = SolverStats::default();
    for i in 0..=lambdas {
        let lambda = 10f64.powf(-6.0 + 12.0 * i as f64 / lambdas as f64).clamp(1e-6, 1e6);
        let law = Emd::new(lambda, Path::Retraction).unwrap().with_tables(-1e6, 1e6);
        for j in 1..points {
            contact_round_trip(
                &law,
                lambda,
                0.02 + (FRAC_PI_2 - 0.02) * j as f64 / points as f64,
                &mut stats,
            );
            noncontact_round_trip(
                &law,
                lambda,
                1.0 + 10f64.powf(-4.0 + 10.0 * j as f64 / points as f64),
                &mut stats,
            );
        }
    }
    let solves = (lambdas + 1) * (points - 1);
    println!(
        "{} evaluations and {} safeguarded solves in about {solves} round trips",
        stats.evaluations, stats.safeguarded
    );
}

fn contact_round_trip(law: &Emd, lambda: f64, angle: f64, stats: &mut SolverStats) {
    let step = 1e-6 * angle;
    let (here, below, above) =
        (maugis(lambda, angle), maugis(lambda, angle - step), maugis(lambda, angle + step));
    let slope = |value: usize| (above[value] - below[value]) / (2.0 * step);
    // On the stable branch only, and away from its end, where the difference quotient means something.
    if slope(0) >= 0.0 || here[0] < law.contact_fold() + 1e-6 || here[0] > 1e6 {
        return;
    }
    let solution = law.contact(here[0], stats);
    let terms = here[2] * here[2] + (here[2] * here[2] - here[0]);
    // The printed brackets cancel like θ³ and θ².
    let cancelled = angle.powi(3).recip().max(1.0);
    for (value, found, name) in [(1, solution.adhesion, "F_s"), (2, solution.radius, "A")] {
        let tolerance = cancelled * allowed(here[value], slope(value), slope(0), terms, angle);
        let error = (found - here[value]).abs();
        assert!(
            error <= tolerance,
            "{name} at λ {lambda:e}, θ {angle}: {found} {} {error:e} {tolerance:e}",
            here[value]
        );
    }
}

fn noncontact_round_trip(law: &Emd, lambda: f64, z: f64, stats: &mut SolverStats) {
    let step = 1e-6 * (z - 1.0);
    let (here, below, above) =
        (extension(lambda, z), extension(lambda, z - step), extension(lambda, z + step));
    let slope = |value: usize| (above[value] - below[value]) / (2.0 * step);
    // The outermost branch only: Δ falls, and is below the fold and the end.
    let highest = law.noncontact_fold().unwrap_or(f64::INFINITY).min(law.end());
    // Folded above λ = 0.888; the outer fold is never beyond z = 1.2922.
    let outermost = lambda < 0.888 || z > 1.2922;
    if slope(0) >= 0.0 || here[0] >= highest - 1e-9 || here[0] < -1e6 || !outermost {
        return;
    }
    let solution = law.noncontact(here[0], stats);
    // 1 − z⁻⁶ cancels next to z = 1.
    let cancelled = (z - 1.0).recip().max(1.0);
    let tolerance = cancelled * allowed(here[1], slope(1), slope(0), here[0].abs(), z);
    let error = (solution.adhesion - here[1]).abs();
    assert!(
        error <= tolerance,
        "λ {lambda:e}, z {z}: {} {} {error:e} {tolerance:e}",
        solution.adhesion,
        here[1]
    );
}

#[test]
fn a_coarse_sweep_returns_to_where_it_began() {
    round_trips(36, 60);
}

#[test]
#[ignore = "slow sweep: cargo test --release -- --ignored"]
fn a_dense_sweep_returns_to_where_it_began() {
    round_trips(1200, 1000);
}
