//! Surfaces that are drawn and summed tract by tract: against the same asperities held at once, on any number of threads.

mod common;

use common::{case, job, law};
use stiction::asperity::{Law, Path, Quantity};
use stiction::engine::compressed::{Compression, largest_error};
use stiction::engine::{Curves, Job, Replica, Workspace};
use stiction::surface::{HeightLaw, Heights, Surface};

/// Asperities of a tract, so few that a surface of some thousand has several.
const TRACT: usize = 1 << 12;

struct Patch {
    law: Box<dyn Law>,
    surface: Surface,
    separations: Vec<f64>,
}

impl Patch {
    fn new(name: &str, model: &str, count: usize) -> Self {
        let (asperity, surface) = case(name);
        let surface = Surface { asperity_count: count, ..surface };
        let separations: Vec<f64> = (0..91).map(|i| surface.surface_height_std * (-1.0 + 0.1 * f64::from(i))).collect();
        let margin = 11.0 * surface.heights.std;
        let law = law(model, &asperity, Path::Approach, (-margin - separations[90], margin - separations[0]));
        Self { law, surface, separations }
    }

    fn job<'a>(&'a self, compression: Option<&'a Compression>) -> Job<'a> {
        Job { compression, ..job(self.law.as_ref(), &self.surface, &self.separations, 8) }
    }
}

/// Replicas of a job in tracts of `tract` asperities, on so many threads.
fn summed(job: &Job<'_>, tract: usize, threads: usize) -> Vec<(Replica, Curves)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut all = Vec::new();
        let visit = |replica, curves: &Curves| all.push((replica, curves.clone()));
        Workspace::with_tracts(job, tract).replicas(job, 0..2, visit);
        all
    })
}

#[test]
fn debug() {
    let patch = Patch::new("II", "hybrid", 50_000);
    let compression = Compression::new(patch.law.as_ref(), &patch.surface, &patch.separations, 1e-9).unwrap();
    for c in [None, Some(&compression)] {
        let job = patch.job(c);
        for tract in [1 << 12, 1 << 30] {
            for (replica, curves) in summed(&job, tract, 2) {
                println!("{} {replica:?} {:?}", c.is_some(), &curves.total[2][30..40]);
            }
        }
    }
}
