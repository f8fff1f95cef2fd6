//! What a scene will compute, what it skips and why, and what that takes.

use super::Scene;
use crate::asperity::{Law, Regime};

/// A regime that is expected less often than this in the whole run, at the separation that reaches it most, is called skipped.
const NEVER: f64 = 1e-6;

/// Nanoseconds that a replica takes by compressed sums, about: for each asperity, and for each separation.
const COMPRESSED: (f64, f64) = (30.0, 700.0);
/// Heights that compressed sums bin, in σ_s.
const BINNED_WIDTH: f64 = 20.0;
/// Bytes that the moments of one step of separation take, for a dozen segments.
const MOMENTS_OF_PERIOD: f64 = 16e3;

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
    /// Expected asperities per replica beyond the law's last regime, where it has no force, at the separation with most of them.
    pub beyond: f64,
    /// Asperity-separations of the run.
    pub pairs: f64,
    /// Estimated core seconds of the ensemble.
    pub core_seconds: f64,
    /// Estimated memory of a run on one thread, bytes.
    pub memory: f64,
    /// Estimated memory of each further thread, bytes.
    pub memory_per_thread: f64,
}

impl Plan {
    /// Plans a scene under its law.
    pub fn new(scene: &Scene, law: &dyn Law) -> Self {
        let regimes = regimes(scene, law);
        let (s, r) = (scene.separations.len() as f64, regimes.len() as f64);
        let (n, replicas) = (scene.surface.asperity_count as f64, scene.replicas as f64);
        let direct =
            40.0 * n + s * regimes.iter().enumerate().map(|(i, plan)| plan.asperities * law.cost(i)).sum::<f64>();
        let step = (scene.separations[scene.separations.len() - 1] - scene.separations[0]) / s;
        let periods = BINNED_WIDTH * scene.surface.heights.std / step;
        let (nanoseconds, moments) = match scene.sum_tolerance {
            Some(_) => (COMPRESSED.0 * n + COMPRESSED.1 * s, MOMENTS_OF_PERIOD * periods),
            None => (direct, 0.0),
        };
        // Moments and curves of a batch and of its groups, heights, and for curves what waits to be written.
        let batch = 8.0 * (n + 3.0 * s * (8.0 + 3.0 * r)) + if scene.curves { 8.0 * 2.0 * s * 8.0 } else { 0.0 };
        Self {
            skips: skips(scene, law, &regimes),
            beyond: beyond(scene, law),
            pairs: n * s * replicas,
            core_seconds: 1e-9 * replicas * nanoseconds,
            // The grid of the joint test, its copy, and the scalars of the replicas.
            memory: 8.0 * 4001.0 * 4.0 * s.min(400.0) + 64.0 * replicas + batch + 20e6,
            memory_per_thread: 2.0 * batch + moments,
            regimes,
        }
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

/// Expected asperities per replica beyond the law's last regime, where it has no force, at the separation with most of them.
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
    if let Some(far) = law.far() {
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
    let loads = regimes.iter().filter(|plan| !plan.regime.is_contact()).map(|plan| plan.asperities).sum::<f64>();
    let all = scene.surface.asperity_count as f64;
    skips.push(format!(
        "load and area where nothing touches: {:.3} % of asperities and separations",
        100.0 * loads / all
    ));
    if let Some(tolerance) = scene.sum_tolerance {
        skips.push(format!("asperities one by one: sums by moments to {tolerance:e}, if a trial meets it"));
    }
    skips.push("one lambda for all asperities: what depends on it is made once".to_owned());
    if !scene.curves {
        skips.push("curves of single replicas: not asked for".to_owned());
    }
    skips
}
