//! Plan of a run of a scene: what it computes, and what it skips and why.

use crate::asperity::{Law, Laws, Method, Regime};
use crate::scene::Scene;
use crate::surface::{Heights, RadiusClass};

/// A regime that is expected less often than this in the whole run, at the separation that reaches it most,
/// is called skipped.
const NEVER: f64 = 1e-6;
/// Most radii of a surface that stand for all of them.
const MOST_RADII: usize = 1000;

/// A regime of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegimePlan {
    /// The regime.
    pub regime: Regime,
    /// Interferences from, m; −∞ for the first.
    pub lower: f64,
    /// Interferences to, m; may be +∞.
    pub upper: f64,
    /// Expected asperities per replica, averaged over the separations.
    pub asperities: f64,
    /// Expected asperities in the whole run at the separation that reaches the regime most.
    most: f64,
}

impl RegimePlan {
    /// Whether no asperity is expected in the whole run.
    fn is_skipped(&self) -> bool {
        self.most < NEVER
    }
}

/// The plan of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The regimes.
    pub regimes: Vec<RegimePlan>,
    /// Things that are skipped, and why, a line each.
    pub skips: Vec<String>,
    /// Expected asperities per replica beyond the law's last regime, where it has no force, at the separation
    /// with most of them.
    pub beyond: f64,
    /// Asperity-separations of the run.
    pub pairs: f64,
}

impl Plan {
    /// The plan of a scene under its law.
    pub fn new(scene: &Scene, law: Laws<'_>) -> Self {
        let regimes = regimes(scene, law);
        let pairs = scene.surface.asperity_count as f64 * scene.states() as f64 * scene.replicas as f64;
        Self { skips: skips(scene, law, &regimes), beyond: beyond(scene, law), pairs, regimes }
    }
}

/// Asperities of one radius.
struct Class {
    share: f64,
    /// Interferences between regimes, m.
    boundaries: Vec<f64>,
    heights: Heights,
}

impl Class {
    /// The share of all asperities that are of it and in a regime at a separation d of the asperity mean plane, m.
    fn in_regime(&self, regime: usize, d: f64) -> f64 {
        let end = |i: usize| self.boundaries.get(i).map_or(f64::INFINITY, |boundary| boundary + d);
        let lower = regime.checked_sub(1).map_or(f64::NEG_INFINITY, end);
        self.share * self.heights.probability(lower, end(regime))
    }
}

/// The asperities of a surface by their radii.
fn classes(scene: &Scene, law: Laws<'_>) -> Vec<Class> {
    let boundaries = |law: &dyn Law| law.boundaries().iter().map(|boundary| boundary.interference).collect();
    let Some(family) = law.family else {
        let heights = scene.surface.heights.clone();
        return vec![Class { share: 1.0, boundaries: boundaries(law.typical), heights }];
    };
    let parts = scene.surface.parts();
    let kept: Vec<_> = parts.iter().step_by(parts.len().div_ceil(MOST_RADII)).collect();
    let whole: f64 = kept.iter().map(|part| part.weight).sum();
    let class = |part: &&RadiusClass| Class {
        share: part.weight / whole,
        boundaries: boundaries(&*family.law(part.radius)),
        heights: part.heights.clone(),
    };
    kept.iter().map(class).collect()
}

/// The regimes of a scene under its law.
fn regimes(scene: &Scene, law: Laws<'_>) -> Vec<RegimePlan> {
    let (n, replicas) = (scene.surface.asperity_count as f64, scene.replicas.max(1) as f64);
    let classes = classes(scene, law);
    let mut lower = f64::NEG_INFINITY;
    let mut plans = Vec::new();
    for (i, &regime) in law.regimes().iter().enumerate() {
        let upper = law.boundaries().get(i).map_or(f64::INFINITY, |boundary| boundary.interference);
        let expected = scene.separations.iter().map(|&h| {
            let d = scene.surface.asperity_separation(h);
            n * classes.iter().map(|class| class.in_regime(i, d)).sum::<f64>()
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
pub fn beyond(scene: &Scene, law: Laws<'_>) -> f64 {
    let last = law.regimes().len();
    if law.boundaries().len() < last {
        return 0.0;
    }
    let smallest = scene.surface.asperity_separation(scene.separations[0]);
    let share: f64 = classes(scene, law).iter().map(|class| class.in_regime(last, smallest)).sum();
    scene.surface.asperity_count as f64 * share
}

/// The solves far from contact that a series takes the place of.
fn series(scene: &Scene, law: Laws<'_>) -> Option<String> {
    let series = |regime| match law.method(regime) {
        Method::Noncontact { far } => far,
        _ => None,
    };
    let far = (0..law.regimes().len()).find_map(series).filter(|_| !scene.surface.is_polydisperse())?;
    let share = |h: &f64| {
        let d = scene.surface.asperity_separation(*h);
        scene.surface.heights.probability(f64::NEG_INFINITY, far + d)
    };
    let share = scene.separations.iter().map(share).sum::<f64>() / scene.separations.len() as f64;
    Some(format!(
        "solves more than {:.3} nm before contact: a series, for {:.3} % of asperities and separations",
        -1e9 * far,
        100.0 * share
    ))
}

fn skips(scene: &Scene, law: Laws<'_>, regimes: &[RegimePlan]) -> Vec<String> {
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
    skips.extend(series(scene, law));
    let loads =
        regimes.iter().filter(|plan| !plan.regime.is_contact()).map(|plan| plan.asperities).sum::<f64>();
    let all = scene.surface.asperity_count as f64;
    skips.push(format!(
        "load and area where nothing touches: {:.3} % of asperities and separations",
        100.0 * loads / all
    ));
    if let Some(tolerance) = scene.sum_tolerance() {
        skips.push(format!("asperities one by one: sums by moments to {tolerance:e}, if a trial meets it"));
    }
    if !scene.surface.is_polydisperse() {
        skips.push("one lambda for all asperities: what depends on it is made once".to_owned());
    }
    if !scene.curves {
        skips.push("curves of single replicas: not asked for".to_owned());
    }
    skips
}
