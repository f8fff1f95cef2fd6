//! What a scene will compute, what it skips and why, and what that takes.

use super::{Scene, Sizes};
use crate::asperity::{Law, Regime};
use crate::surface::TRACT;

/// A regime that is expected less often than this in the whole run, at the separation that reaches it most,
/// is called skipped.
const NEVER: f64 = 1e-6;

/// Nanoseconds that a replica takes by compressed sums, about: for each asperity, and for each separation.
const COMPRESSED: (f64, f64) = (30.0, 700.0);
/// Nanoseconds that an asperity of a surface in tracts takes to be drawn again, twice, and looked at.
const AGAIN: f64 = 30.0;
/// Nanoseconds that making the law of an asperity takes, where each has its own, and a solve of that law.
const SCATTERED: (f64, f64) = (30e3, 400.0);
/// Replicas that are summed directly too before a compressed run, to see its error.
const PILOTS: f64 = 4.0;
/// Nanoseconds that an asperity takes to be drawn and sorted, about, and a surface at a separation, however
/// few its asperities.
const DIRECT: (f64, f64) = (40.0, 700.0);
/// The search for the pull-off solves a surface in so many spaces between separations that they are at most
/// so many σ_s apart, but at most so many times in each; and so many times more.
const SEARCH: (f64, f64, f64, f64) = (3.0, 0.06, 63.0, 5.0);
/// Of the integral: evaluations on a panel, panels of all heights, nanoseconds of the density of one of them,
/// and how many times the cost in full blocks one takes.
const INTEGRAL: (f64, f64, f64, f64) = (60.0, 17.0, 30.0, 3.0);
/// Nanoseconds of the joint test: for each height of its grid and separation, for each height and pair of
/// separations, for each triple.
const FUNCTIONALS: (f64, f64, f64) = (40.0, 0.12, 0.8);
/// Heights of that grid.
const GRID: f64 = 4001.0;

/// One regime of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegimePlan {
    /// Which.
    pub regime: Regime,
    /// Interferences from, m; −∞ for the first.
    pub lower: f64,
    /// Interferences to, m; may be +∞.
    pub upper: f64,
    /// Expected asperities per replica, averaged over the separations.
    pub asperities: f64,
    /// Expected asperities in the whole run at the separation that reaches the regime most.
    pub most: f64,
}

impl RegimePlan {
    /// Whether no asperity is expected in the whole run.
    pub fn is_skipped(&self) -> bool {
        self.most < NEVER
    }
}

/// The plan of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The regimes.
    pub regimes: Vec<RegimePlan>,
    /// What is skipped, and why, a line each.
    pub skips: Vec<String>,
    /// Expected asperities per replica beyond the law's last regime, where it has no force, at the separation
    /// with most of them.
    pub beyond: f64,
    /// Asperity-separations of the run.
    pub pairs: f64,
    /// Estimated core seconds.
    pub core_seconds: CoreSeconds,
}

/// Estimated core seconds of the phases of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoreSeconds {
    /// The integral, which threads share.
    pub integral: f64,
    /// The functionals of the joint test, which one thread finds.
    pub functionals: f64,
    /// What a few replicas take that are summed both ways before a compressed run.
    pub pilots: f64,
    /// The ensemble, which threads share batch by batch, or tract by tract of each surface.
    pub ensemble: f64,
}

impl CoreSeconds {
    /// Seconds that the phases take one after the other: integral, functionals, ensemble.
    pub fn on_threads(&self, sizes: &Sizes) -> [f64; 3] {
        let rounds = (sizes.batches() / sizes.threads).ceil();
        let share = if sizes.is_divided() { 1.0 / sizes.workers() } else { rounds / sizes.batches() };
        let pilots = self.pilots / sizes.threads.min(PILOTS).min(sizes.replicas);
        [self.integral / sizes.threads, self.functionals, pilots + self.ensemble * share]
    }
}

impl Plan {
    /// Plans a scene under its law.
    pub fn new(scene: &Scene, law: &dyn Law) -> Self {
        let regimes = regimes(scene, law);
        let pairs = scene.surface.asperity_count as f64 * scene.states() as f64 * scene.replicas as f64;
        Self {
            skips: skips(scene, law, &regimes),
            beyond: beyond(scene, law),
            pairs,
            core_seconds: core_seconds(scene, law, &regimes),
            regimes,
        }
    }
}

fn core_seconds(scene: &Scene, law: &dyn Law, regimes: &[RegimePlan]) -> CoreSeconds {
    let sizes = Sizes::new(scene, law, 1);
    let (n, s) = (sizes.asperities, sizes.separations);
    let of_asperity = |i: usize| {
        if scene.surface.is_scattered() && law.constant(i).is_none() { SCATTERED.1 } else { law.cost(i) }
    };
    let solving: f64 = regimes.iter().enumerate().map(|(i, plan)| plan.asperities * of_asperity(i)).sum();
    let between = ((sizes.step / SEARCH.1).ceil() - 1.0).min(SEARCH.2);
    // After each preload a surface is pulled back by itself.
    let turns = scene.separations.len() * scene.instability.preload.len();
    let searched = SEARCH.0.min(s - 1.0) * between + SEARCH.3 + turns as f64;
    let making = if scene.surface.is_scattered() { SCATTERED.0 } else { 0.0 };
    let direct = (DIRECT.0 + making) * n + (s + searched) * (DIRECT.1 + solving);
    let again = if sizes.is_divided() { AGAIN * n } else { 0.0 };
    let compressed = COMPRESSED.0 * n + COMPRESSED.1 * s + again;
    let tried = sizes.asperities.min(TRACT as f64) / sizes.asperities;
    let (replica, pilots) = match scene.sum_tolerance {
        Some(_) => (compressed, PILOTS.min(sizes.replicas) * tried * (direct + compressed)),
        None => (direct, 0.0),
    };
    let parts = scene.surface.parts().len() as f64;
    let dearest = (0..regimes.len()).map(|regime| law.cost(regime)).fold(0.0, f64::max);
    let panels = INTEGRAL.1 + 2.0 * law.pieces().len() as f64;
    let columns = sizes.tested();
    let grid = FUNCTIONALS.0 * columns + FUNCTIONALS.1 * columns * columns;
    CoreSeconds {
        integral: 1e-9 * parts * s * INTEGRAL.0 * panels * (INTEGRAL.2 + INTEGRAL.3 * dearest),
        functionals: 1e-9 * (GRID * grid + FUNCTIONALS.2 * columns.powi(3)),
        pilots: 1e-9 * pilots,
        ensemble: 1e-9 * sizes.replicas * replica,
    }
}

fn regimes(scene: &Scene, law: &dyn Law) -> Vec<RegimePlan> {
    let (n, replicas) = (scene.surface.asperity_count as f64, scene.replicas as f64);
    let mut lower = f64::NEG_INFINITY;
    let mut plans = Vec::new();
    for (i, &regime) in law.regimes().iter().enumerate() {
        let upper = law.boundaries().get(i).map_or(f64::INFINITY, |boundary| boundary.interference);
        let expected = scene.separations.iter().map(|&h| {
            let d = scene.surface.asperity_separation(h);
            n * scene.surface.heights.probability(lower + d, upper + d)
        });
        let (sum, most) = expected.fold((0.0, 0.0_f64), |(sum, most), e| (sum + e, most.max(e)));
        let asperities = sum / scene.separations.len() as f64;
        plans.push(RegimePlan { regime, lower, upper, asperities, most: most * replicas });
        lower = upper;
    }
    plans
}

/// Expected asperities per replica beyond the law's last regime, where it has no force, at the separation
/// with most of them.
pub fn beyond(scene: &Scene, law: &dyn Law) -> f64 {
    let Some(end) = law.boundaries().get(law.regimes().len() - 1) else { return 0.0 };
    let smallest = scene.surface.asperity_separation(scene.separations[0]);
    let share = scene.surface.heights.probability(end.interference + smallest, f64::INFINITY);
    scene.surface.asperity_count as f64 * share
}

fn skips(scene: &Scene, law: &dyn Law, regimes: &[RegimePlan]) -> Vec<String> {
    let mut skips = Vec::new();
    let dry = scene.asperity.lubricant_thickness == 0.0;
    if dry {
        skips.push("lubricant regime: the scene is dry".to_owned());
    } else if scene.model.validity.dry {
        skips.push("lubricant: this law knows none, the asperities are dry".to_owned());
    } else {
        skips.push("solves in the lubricant regime: its force is constant".to_owned());
    }
    let never: Vec<&str> = regimes
        .iter()
        .filter(|plan| plan.is_skipped() && !(dry && plan.regime == Regime::Lubricant))
        .map(|plan| plan.regime.name())
        .collect();
    if !never.is_empty() {
        skips.push(format!("{}: no asperity expected there in the whole run", never.join(", ")));
    }
    if let Some(far) = law.far().filter(|_| !scene.surface.is_scattered()) {
        let share = |h: &f64| {
            let d = scene.surface.asperity_separation(*h);
            scene.surface.heights.probability(f64::NEG_INFINITY, far + d)
        };
        let share = scene.separations.iter().map(share).sum::<f64>() / scene.separations.len() as f64;
        skips.push(format!(
            "solves more than {:.3} nm before contact: a series, for {:.3} % of asperities and separations",
            -1e9 * far,
            100.0 * share
        ));
    }
    let loads =
        regimes.iter().filter(|plan| !plan.regime.is_contact()).map(|plan| plan.asperities).sum::<f64>();
    let all = scene.surface.asperity_count as f64;
    skips.push(format!(
        "load and area where nothing touches: {:.3} % of asperities and separations",
        100.0 * loads / all
    ));
    if let Some(tolerance) = scene.sum_tolerance {
        skips.push(format!("asperities one by one: sums by moments to {tolerance:e}, if a trial meets it"));
    }
    if !scene.surface.is_scattered() {
        skips.push("one lambda for all asperities: what depends on it is made once".to_owned());
    }
    if !scene.curves {
        skips.push("curves of single replicas: not asked for".to_owned());
    }
    skips
}
