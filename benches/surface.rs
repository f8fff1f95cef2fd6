//! One replica of the published cases, draws and sorting and all 181 separations included, and the integral
//! of the same scene: what a run costs, and by law. divan reports asperity-separations per second.

mod common;

use common::{job, scene};
use divan::{Bencher, counter::ItemsCount};
use stiction::asperity::{MODELS, model};
use stiction::engine::moments::{LANES, MomentMatrix};
use stiction::engine::{Job, Protocol, Workspace};
use stiction::integral::Expectations;

const CASES: [&str; 3] = ["case_i", "case_ii", "case_iii"];

fn main() {
    divan::main();
}

#[divan::bench(args = CASES, sample_count = 20)]
fn replica(bencher: Bencher, name: &str) {
    one_replica(bencher, name);
}

/// One replica of a surface whose radii differ, at its own separations, with the search for its features.
#[divan::bench(args = ["surfaces/radii", "surfaces/nayak"], sample_count = 50)]
fn replica_of_radii(bencher: Bencher, name: &str) {
    one_replica(bencher, name);
}

/// One replica that is pressed together and pulled apart, of which half of the asperities flow.
#[divan::bench(args = ["loop"], sample_count = 20)]
fn replica_of_a_loop(bencher: Bencher, name: &str) {
    one_replica(bencher, name);
}

/// Replicas of a scene, one after the other.
fn one_replica(bencher: Bencher, name: &str) {
    let scene = scene(name);
    let law = scene.law().expect("a law of the scene");
    let cycle = scene.loop_law().expect("a law of the scene");
    let job = job(&scene, law.view(), 1);
    let job = Job { protocol: Protocol { cycle: cycle.as_ref(), ..job.protocol }, ..job };
    let mut workspace = Workspace::new(&job);
    let pairs = scene.surface.asperity_count * scene.separations.len();
    let mut index = 0;
    bencher.counter(ItemsCount::new(pairs)).bench_local(|| {
        index += 1;
        workspace.replicas(&job, index..index + 1, |_, _| ());
    });
}

/// The replicas that are summed together by moments, to the tolerance that a scene has unless it gives one.
#[divan::bench(args = CASES, sample_count = 20)]
fn eight_replicas_compressed(bencher: Bencher, name: &str) {
    let scene = scene(name);
    let law = scene.law().expect("a law of the scene");
    let matrix = MomentMatrix::new(law.typical.as_ref(), &scene.surface, &scene.separations, 1e-9)
        .expect("even separations");
    let at_once = LANES as u64;
    let job = Job { moments: Some(&matrix), ..job(&scene, law.view(), at_once) };
    let mut workspace = Workspace::new(&job);
    let pairs = LANES * scene.surface.asperity_count * scene.separations.len();
    let mut index = 0;
    bencher.counter(ItemsCount::new(pairs)).bench_local(|| {
        index += at_once;
        workspace.replicas(&job, index..index + at_once, |_, _| ());
    });
}

/// One replica of radii that scatter under every law that follows the radius.
#[divan::bench(args = MODELS.iter().map(|model| model.name), sample_count = 20)]
fn replica_of_radii_by_law(bencher: Bencher, name: &str) {
    let scene = scene("surfaces/radii");
    let Ok(law) = scene.law_of(&model(name).expect("a law")) else { return };
    let job = job(&scene, law.view(), 1);
    let mut workspace = Workspace::new(&job);
    let pairs = scene.surface.asperity_count * scene.separations.len();
    bencher.counter(ItemsCount::new(pairs)).bench_local(|| workspace.replicas(&job, 0..1, |_, _| ()));
}

/// One replica of case II under every law.
#[divan::bench(args = MODELS.iter().map(|model| model.name), sample_count = 10)]
fn replica_by_law(bencher: Bencher, name: &str) {
    let scene = scene("case_ii");
    let law = scene.law_of(&model(name).expect("a law")).expect("a law of the scene");
    let job = job(&scene, law.view(), 1);
    let mut workspace = Workspace::new(&job);
    let pairs = scene.surface.asperity_count * scene.separations.len();
    bencher.counter(ItemsCount::new(pairs)).bench_local(|| workspace.replicas(&job, 0..1, |_, _| ()));
}

#[divan::bench(args = ["case_i", "case_ii", "case_iii", "surfaces/radii", "surfaces/nayak"], sample_count = 20)]
fn integral(bencher: Bencher, name: &str) {
    let scene = scene(name);
    let law = scene.law().expect("a law of the scene");
    bencher.bench_local(|| Expectations::new(law.view(), &scene.surface, &scene.separations));
}
