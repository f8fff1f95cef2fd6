//! The ensemble's sums against a plain loop over the law, its scatter against the integral, and what is read off a curve against a
//! much finer curve.

mod common;

use common::{case, law};
use std::sync::atomic::AtomicBool;
use stiction::asperity::emd::{Emd, State};
use stiction::asperity::scale::{Asperity, Scale};
use stiction::asperity::{Law, Path, Quantity, Work};
use stiction::engine::stream::{Purpose, stream};
use stiction::engine::{Ensemble, Job, Outcome, Workspace, run};
use stiction::statistical::Statistical;
use stiction::surface::Surface;

fn job<'a>(law: &'a dyn Law, surface: &'a Surface, separations: &'a [f64], replicas: u64) -> Job<'a> {
    Job { seed: 3, ..common::job(law, surface, separations, replicas) }
}

fn ensemble(job: &Job<'_>) -> Ensemble {
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    match run::<()>(job, &pool, &AtomicBool::new(false), |_, _| Ok(())) {
        Ok(Outcome::Complete(forest)) => forest.into_ensemble(job),
        _ => panic!("the run did not complete"),
    }
}

/// F_s and P of one asperity, N, from the scaled solver without tables and the closed forms: no regimes, no blocks.
fn plain_forces(asperity: &Asperity, scale: &Scale, emd: &Emd, interference: f64) -> (f64, f64) {
    let critical = asperity.critical_interference();
    let (x, pi) = (interference / critical, std::f64::consts::PI);
    let load = 2.0 / 3.0 * pi * asperity.pressure_factor() * asperity.hardness * asperity.radius * critical;
    let ratio = asperity.equilibrium_spacing / critical;
    if x > 110.0 {
        return (0.0, 2.0 * pi * asperity.radius * interference * asperity.hardness);
    } else if x > 6.0 {
        return (2.0 * scale.force * 1.19 * x.powf(0.093) * ratio.powf(-0.332), load * 1.40 * x.powf(1.263));
    } else if x > 1.0 {
        return (2.0 * scale.force * 0.79 * x.powf(0.356) * ratio.powf(-0.321), load * 1.03 * x.powf(1.425));
    }
    let mut work = Work::default();
    if interference >= emd.end() * scale.length {
        let (_, solution) = emd.respond((interference / scale.length).max(emd.end()), &mut work);
        return (scale.force * solution.adhesion, scale.force * solution.radius.powi(3));
    }
    let wetted = interference + asperity.lubricant_thickness;
    if wetted >= emd.end() * scale.length {
        return (2.0 * scale.force, 0.0);
    }
    let (state, solution) = emd.respond(wetted / scale.length, &mut work);
    assert_eq!(state, State::Noncontact);
    (scale.force * solution.adhesion, 0.0)
}

#[test]
fn sums_agree_with_a_plain_loop() {
    for (name, path) in [("I", Path::Approach), ("II", Path::Approach), ("III", Path::Retraction)] {
        let (asperity, mut surface) = case(name);
        surface.asperity_count = 700;
        let separations: Vec<f64> = (-1..7).map(|i| f64::from(i) * surface.surface_height_std).collect();
        let law = law("hybrid", &asperity, path, (-60e-9, 40e-9));
        let job = job(law.as_ref(), &surface, &separations, 1);
        let mut workspace = Workspace::new(&job);
        workspace.replicas(&job, 0..1, |_, _| ());
        let mut heights = vec![0.0; 700];
        surface.heights.draw(&mut stream(3, Purpose::Heights, 0), &mut heights);
        let scale = Scale::new(&asperity).unwrap();
        let emd = Emd::new(scale.lambda, path).unwrap();
        for (k, &h) in separations.iter().enumerate() {
            let d = surface.asperity_separation(h);
            let (mut adhesion, mut contact) = (0.0, 0.0);
            for &u in &heights {
                let forces = plain_forces(&asperity, &scale, &emd, u - d);
                adhesion += forces.0;
                contact += forces.1;
            }
            let total = |quantity: Quantity| workspace.curves[0].total[quantity.index()][k];
            assert!((total(Quantity::AdhesionForce) / adhesion - 1.0).abs() < 1e-12, "{name} at {h}");
            assert!((total(Quantity::ContactForce) - contact).abs() <= 1e-12 * (contact + adhesion), "{name} at {h}");
            let counted: f64 = (0..6).map(|r| workspace.curves[0].regime_count[r * separations.len() + k]).sum();
            assert_eq!(counted, 700.0);
        }
    }
}

/// The scatter of one replica by the integral: the sample variance over n replicas is within 5 standard errors, √((κ + 2)/n) with the
/// excess kurtosis κ bounded by 1 where hundreds of asperities bear the force. False alarm below 1e-5 for all checks together.
#[test]
fn scatter_agrees_with_the_integral() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 2000;
    let separations: Vec<f64> = (-2..6).map(|i| 0.5 * f64::from(i) * surface.surface_height_std).collect();
    let law = law("hybrid", &asperity, Path::Approach, (-30e-9, 20e-9));
    let replicas = 1500;
    let sampled = ensemble(&job(law.as_ref(), &surface, &separations, replicas));
    let model = Statistical::new(law.as_ref(), &surface, &separations);
    for quantity in Quantity::ALL {
        let sampled = sampled.curves[quantity.index()].std();
        for (k, (sample, exact)) in sampled.iter().zip(&model.std[quantity.index()]).enumerate() {
            let error = ((sample / exact).powi(2) - 1.0).abs();
            assert!(error < 5.0 * (3.0 / replicas as f64).sqrt(), "{} at {k}: {sample} {exact}", quantity.name());
        }
    }
}

/// Pull-off and its place from separations 0.05 σ apart, against the same replicas on separations 25 times finer: mostly the same
/// point of the curve, and never one that a finer look would call another pull-off.
#[test]
fn refinement_finds_what_a_finer_curve_shows() {
    let (asperity, surface) = case("II");
    let sigma = surface.surface_height_std;
    let law = law("hybrid", &asperity, Path::Approach, (-20e-9, 20e-9));
    let grid = |from: f64, to: f64, step: f64| -> Vec<f64> {
        (0..=((to - from) / step).round() as u32).map(|i| sigma * (from + step * f64::from(i))).collect()
    };
    let coarse = grid(1.0, 4.0, 0.05);
    let fine = grid(2.0, 4.0, 0.002);
    let [coarse, fine] =
        [&coarse, &fine].map(|separations| ensemble(&job(law.as_ref(), &surface, separations, 16)).replicas);
    let mut errors = Vec::new();
    for (a, b) in coarse.iter().zip(&fine) {
        assert!(!a.pull_off_at_edge && !b.pull_off_at_edge);
        assert!((a.pull_off_separation - b.pull_off_separation).abs() < 0.005 * sigma, "{a:?} {b:?}");
        errors.push((a.pull_off_force / b.pull_off_force - 1.0).abs());
    }
    errors.sort_by(f64::total_cmp);
    let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!("pull-off within {median:.1e} in the median, {largest:.1e} at most");
    assert!(median < 1e-6 && largest < 1e-3, "{errors:?}");
}
