//! The largest secant stiffness of replicas, against brute force over all events of their curves, whatever
//! the separations.

use crate::common::{brute_force, program::QUICK};
use stiction::asperity::Laws;
use stiction::engine::{Job, Protocol, Replica, Workspace};
use stiction::scene::Scene;

/// The quick scene on so many separations over the same range.
fn scene(count: usize, law: &str) -> Scene {
    let text =
        QUICK.replace("count = 91", &format!("count = {count}")).replace("\"hybrid\"", &format!("\"{law}\""));
    Scene::parse(&text).unwrap()
}

fn job<'a>(scene: &'a Scene, laws: impl Into<Laws<'a>>, replicas: u64) -> Job<'a> {
    let protocol = Protocol { stiffness_span: Some(scene.stiffness_span), ..Protocol::default() };
    Job {
        seed: scene.seed,
        protocol,
        ..crate::common::job(laws, &scene.surface, &scene.separations, replicas)
    }
}

fn replicas(job: &Job<'_>) -> Vec<Replica> {
    let mut found = Vec::new();
    Workspace::new(job).replicas(job, 0..job.replicas, |replica, _| found.push(replica));
    found
}

/// The external force of replica 0 anywhere, N, and the separations h, m, of its events.
fn curve<'a>(job: &'a Job<'a>, index: u64) -> (impl Fn(f64) -> f64 + 'a, Vec<f64>) {
    let mut heights = Vec::new();
    job.draw(index).of(job.surface, &mut heights, &mut Vec::new());
    heights.sort_by(f64::total_cmp);
    let events = brute_force::events(job.laws.typical);
    let offset = job.surface.mean_plane_offset;
    let of_all = heights.iter().flat_map(|u| events.iter().map(move |event| u - event + offset)).collect();
    let force = move |h: f64| {
        brute_force::external_force(job.laws.typical, &heights, job.surface.asperity_separation(h))
    };
    (force, of_all)
}

/// The quantity of a patch does not depend on the separations, and is what brute force over all events finds.
#[test]
fn the_largest_secant_does_not_depend_on_the_separations() {
    const REPLICAS: u64 = 4;
    let fine = scene(361, "hybrid");
    let law = fine.law().unwrap();
    let job_of = job(&fine, law.view(), REPLICAS);
    let span = fine.stiffness_span;
    assert_eq!(span, 0.2e-9);
    let begins: Vec<f64> =
        fine.separations.iter().copied().filter(|h| h + span <= fine.separations[360]).collect();
    let expected: Vec<f64> = (0..REPLICAS)
        .map(|index| {
            let (force, events) = curve(&job_of, index);
            let events = events.iter().flat_map(|event| [*event, event - span]).collect();
            -brute_force::deepest(&begins, events, 0.3, |h| force(h) - force(h + span)).1 / span
        })
        .collect();
    for count in [20, 46, 91, 361] {
        let scene = scene(count, "hybrid");
        let law = scene.law().unwrap();
        let job = job(&scene, law.view(), REPLICAS);
        for ((replica, expected), index) in replicas(&job).iter().zip(&expected).zip(0..) {
            let (stiffness, place) =
                (replica.peak_secant_stiffness, replica.peak_secant_stiffness_separation);
            let off = stiffness / expected - 1.0;
            println!(
                "{count} separations, replica {index}: {stiffness:e} N/m at {place:e} m, off by {off:.1e}"
            );
            assert!(off.abs() < 1e-6, "{count} separations, replica {index}: {stiffness:e} {expected:e}");
            // What is reported is the secant there.
            let (force, _) = curve(&job, index);
            let there = (force(place + 0.5 * span) - force(place - 0.5 * span)) / span;
            assert!((there / stiffness - 1.0).abs() < 1e-2, "{there:e} {stiffness:e}");
        }
    }
}
