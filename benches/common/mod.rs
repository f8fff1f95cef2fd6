//! Shared by the benchmarks: shipped scenes, jobs of them, and the least time of several runs.
#![allow(dead_code)] // Each benchmark takes what it needs.

use std::path::Path;
use std::time::Instant;
use stiction::asperity::Laws;
use stiction::engine::{Job, Protocol};
use stiction::scene::Scene;

/// The text of a shipped scene.
pub fn text(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name).with_extension("toml");
    std::fs::read_to_string(path).expect("a shipped scene")
}

/// A shipped scene.
pub fn scene(name: &str) -> Scene {
    Scene::parse(&text(name)).expect("a valid scene")
}

/// A job of a scene that sums directly and keeps nothing but the replicas.
pub fn job<'a>(scene: &'a Scene, laws: impl Into<Laws<'a>>, replicas: u64) -> Job<'a> {
    Job {
        laws: laws.into(),
        surface: &scene.surface,
        separations: &scene.separations,
        seed: scene.seed,
        scheme: scene.sampling,
        replicas,
        controls: &[],
        keep_curves: false,
        moments: None,
        protocol: Protocol { stiffness_span: Some(scene.stiffness_span), ..Protocol::default() },
    }
}

/// Seconds of one run.
pub fn seconds(run: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    run();
    begin.elapsed().as_secs_f64()
}

/// The least seconds of several runs: what others do on the machine only adds to them.
pub fn least_seconds(runs: usize, mut run: impl FnMut()) -> f64 {
    (0..runs).map(|_| seconds(&mut run)).fold(f64::INFINITY, f64::min)
}

/// The least seconds of each of several tasks, in so many rounds of all of them, so that a busy moment of the
/// machine is none of one task alone.
pub fn least_seconds_of(rounds: usize, tasks: &mut [Box<dyn FnMut() + '_>]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; tasks.len()];
    for _ in 0..rounds {
        least.iter_mut().zip(tasks.iter_mut()).for_each(|(least, task)| *least = least.min(seconds(task)));
    }
    least
}
