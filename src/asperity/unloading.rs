//! One asperity that is brought close and pulled back: each with its own history.
//!
//! # Formula
//! When the surfaces turn, an asperity has the interference ω_max; at a distance s ≥ 0 from there it has δ =
//! ω_max − s, and what it does is a function of ω_max and s alone. So all asperities of a surface at one
//! distance obey one law in the variable ω_max, [`Loop::at`]:
//!
//! | ω_max | what acts |
//! |---|---|
//! | below first touch | the law on approach at δ: nothing has been touched, so retraction retraces the approach |
//! | up to ω_c, or any of a law that knows no flow | the law on retraction at δ: contact lasts to the end of its stable branch |
//! | above ω_c | the unloading of an elastic-plastic contact, below |
//!
//! After plastic flow the asperity is lower by its residual interference ω_res, and springs back by its
//! recovery ω_max − ω_res only (`plastic_unloading`).
//!
//! # Adhesion
//! The unloading is published without adhesion. What attracts acts outside the contact, across the gap beside
//! it, and the shape of that gap is what plastic flow has left behind: it does not heal. So F_s keeps its
//! value at ω_max for as long as there is contact, as in the DMT limit, for which the elastic-plastic
//! adhesion was computed. Contact lasts, without load, to the place where that of an elastic asperity would
//! end, counted from the lowered top: to δ − ω_res = −δ_A on retraction. From there on the asperity is one
//! whose top is lower by ω_res: lubricant and attraction across the gap at δ − ω_res.
//!
//! # Radius
//! A top that flowed is flatter. How much is not published with the unloading, and it decides what attracts
//! from then on, so it is a choice, [`UnloadedRadius`]: the top keeps R, or it has the R′ = 4E_r a³/(3P) of
//! the elastic contact whose radius and load are those at ω_max ([`super::flattened`]). With R′ the
//! attraction before contact, the lubricant's force and δ_A are those of R′.
//!
//! # Validity
//! One cycle from a fresh surface. The unloading was computed for loads up to the limits of the
//! elastic-plastic fits; in the fully plastic regime it is used beyond them, without adhesion, as there is
//! none on approach. Its ω_c is taken to be that of the law. Where the attraction across the gap has two
//! states, both ways take the outer one, as the laws do. Source: Etsion, Kligerman and Kadin, Int. J. Solids
//! Struct. 42 (2005) 3716.

use super::error::LawError;
use super::history::Path;
use super::law::{BLOCK, Flattened, Law, Regime, Responses};
use super::models::{MODELS, Model, Plasticity};
use super::parameters::LawParameters;
use super::plastic_unloading::PlasticUnloading;
use super::radius::{Lane, OfRadii, RadiusLaw};
use super::scale::Scale;
use super::stats::SolverStats;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

/// The radius of a top that has flowed, once its contact has ended.
///
/// # Examples
/// ```
/// use stiction::asperity::UnloadedRadius;
///
/// assert_eq!(UnloadedRadius::default(), UnloadedRadius::Kept);
/// assert_eq!(UnloadedRadius::Kept.other().name(), "elastic");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnloadedRadius {
    /// As it was.
    #[default]
    Kept,
    /// 4E_r a³/(3P) of the largest load, the radius whose elastic contact that was.
    Elastic,
}

impl UnloadedRadius {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] = [("kept", Self::Kept), ("elastic", Self::Elastic)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, radius)| *radius == self).expect("every radius is in ALL").0
    }

    /// The other of the two.
    pub fn other(self) -> Self {
        match self {
            Self::Kept => Self::Elastic,
            Self::Elastic => Self::Kept,
        }
    }
}

/// The laws of one asperity on approach and on retraction.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, SolvedAsperity, UnloadedRadius, model};
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("jkr").unwrap(), &parameters, UnloadedRadius::Kept)?;
/// assert!(cycle.release() < cycle.touch(), "contact lasts longer than it took to begin");
/// let between = 0.5 * (cycle.release() + cycle.touch());
/// assert_eq!(SolvedAsperity::new(cycle.approach(), between).contact_area, 0.0);
/// assert!(SolvedAsperity::new(cycle.retraction(), between).contact_area > 0.0);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct Loop {
    pub(super) approach: Arc<dyn Law>,
    pub(super) retraction: Arc<dyn Law>,
    /// Interference, m, from which retraction does not retrace the approach.
    pub(super) capture: f64,
    /// Index of the first regime of contact, and of the first above ω_c.
    pub(super) first_contact: usize,
    pub(super) first_plastic: usize,
    /// Unloading of what has flowed.
    pub(super) plastic: PlasticUnloading,
    /// Attraction of tops that have flowed, where they have radii of their own.
    pub(super) flattened: Option<Arc<dyn Flattened>>,
    scale: Scale,
}

/// Attraction of tops by their radius over that of another law.
struct Relative {
    flattened: Arc<dyn Flattened>,
    ratio: f64,
}

impl Flattened for Relative {
    fn release(&self, ratio: f64) -> f64 {
        self.flattened.release(self.ratio * ratio)
    }

    fn kink(&self, ratio: f64) -> Option<f64> {
        self.flattened.kink(self.ratio * ratio)
    }

    fn attraction(&self, ratios: &[f64], interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let mut own = [0.0; BLOCK];
        own.iter_mut().zip(ratios).for_each(|(own, ratio)| *own = self.ratio * ratio);
        self.flattened.attraction(&own[..ratios.len()], interference, out, stats);
    }
}

impl Loop {
    /// The loop of the law of a model for a setting, whatever its path.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made, [`LawError::NoUnloading`] when it flows otherwise than the
    /// contact that the unloading was computed for, [`LawError::NotFlattened`] when it is a fit to one radius
    /// and flows, and tops that have flowed are to have radii of their own.
    pub fn new(model: &Model, parameters: &LawParameters, radius: UnloadedRadius) -> Result<Self, LawError> {
        if !unloads(model) {
            return Err(LawError::NoUnloading { law: model.name, others: &UNLOADING });
        }
        let [approach, retraction] =
            [Path::Approach, Path::Retraction].map(|path| model.law(&LawParameters { path, ..*parameters }));
        let [approach, retraction]: [Arc<dyn Law>; 2] = [approach?.into(), retraction?.into()];
        let regimes = approach.regimes();
        let first = |is: fn(&Regime) -> bool| regimes.iter().position(is).unwrap_or(regimes.len());
        let (first_contact, first_plastic) =
            (first(|regime| regime.is_contact()), first(|regime| is_plastic(*regime)));
        let touch = begin_of(approach.as_ref(), first_contact);
        let capture = approach.capture().map_or(touch, |capture| capture.min(touch));
        let flattened = match radius {
            UnloadedRadius::Elastic if first_plastic < regimes.len() => {
                Some(retraction.flattened().ok_or(LawError::NotFlattened)?.into())
            }
            _ => None,
        };
        let deepest = parameters.table_range.map(|(_, deepest)| deepest);
        Ok(Self {
            approach,
            retraction,
            capture,
            first_contact,
            first_plastic,
            plastic: PlasticUnloading::new(parameters.critical_interference, deepest),
            flattened,
            scale: parameters.scale,
        })
    }

    /// The loop of asperities that differ from those of this one in their radius.
    ///
    /// # Panics
    /// When it is not known how the laws follow the radius.
    #[doc(hidden)]
    pub fn of(&self, lane: Lane) -> Self {
        let [approach, retraction] = [&self.approach, &self.retraction].map(|law| RadiusLaw::new(law, lane));
        let touch = begin_of(&approach, self.first_contact);
        let capture = approach.capture().map_or(touch, |capture| capture.min(touch));
        let relative = |flattened: &Arc<dyn Flattened>| -> Arc<dyn Flattened> {
            Arc::new(Relative { flattened: Arc::clone(flattened), ratio: lane.ratio })
        };
        let Scale { lambda, length, radius, force } = self.scale;
        Self {
            capture,
            first_contact: self.first_contact,
            first_plastic: self.first_plastic,
            plastic: self.plastic.of_radius(lane.ratio),
            flattened: self.flattened.as_ref().map(relative),
            scale: Scale {
                lambda: lambda * lane.cube_root,
                length: length * lane.cube_root,
                radius: radius * (lane.cube_root * lane.cube_root),
                force: force * lane.ratio,
            },
            approach: Arc::new(approach),
            retraction: Arc::new(retraction),
        }
    }

    /// An asperity of a radius over that of the loop.
    ///
    /// # Panics
    /// When it is not known how the laws follow the radius.
    #[doc(hidden)]
    pub fn lane(&self, ratio: f64) -> Lane {
        Lane::new(ratio, self.lanes(Path::Approach).lambda())
    }

    /// The law along a path of asperities of any radius, in lanes.
    pub(super) fn lanes(&self, path: Path) -> &dyn OfRadii {
        let law = match path {
            Path::Approach => &self.approach,
            Path::Retraction => &self.retraction,
        };
        law.of_radii().expect("a loop of several radii is of a law that follows the radius")
    }

    /// The law on approach.
    pub fn approach(&self) -> &dyn Law {
        self.approach.as_ref()
    }

    /// Index of the first regime of contact.
    #[doc(hidden)]
    pub fn first_contact(&self) -> usize {
        self.first_contact
    }

    /// Whether the law knows plastic flow.
    pub fn flows(&self) -> bool {
        self.first_plastic < self.approach.regimes().len()
    }

    /// The law on retraction, of an asperity that has not flowed.
    pub fn retraction(&self) -> &dyn Law {
        self.retraction.as_ref()
    }

    /// The fate of an asperity of the interference ω_max, m: 0 of one that has never touched, 1 of one
    /// that has, 2 of one that has flowed.
    pub fn fate(&self, largest: f64) -> usize {
        if largest < self.capture {
            0
        } else if self.flows() && largest > self.top() {
            2
        } else {
            1
        }
    }

    /// Interferences, m, rising, at which the force on retraction is not smooth, by [`Loop::fate`]: counted
    /// from the top that the asperity has then, so they are passed at the distance [`Loop::recovery`] less
    /// them.
    pub fn kinks(&self) -> [Vec<f64>; 3] {
        let ends = |law: &dyn Law, regimes: usize| {
            let mut ends: Vec<f64> =
                law.pieces().iter().filter(|piece| piece.regime < regimes).map(|piece| piece.upper).collect();
            ends.retain(|end| end.is_finite());
            ends
        };
        let untouched =
            ends(self.approach(), self.first_contact).into_iter().filter(|end| *end <= self.capture);
        let elastic = ends(self.retraction(), self.first_plastic);
        // The load ends where it has sprung back.
        let flowed = ends(self.retraction(), self.first_contact).into_iter().chain([0.0]);
        [untouched.collect(), elastic, flowed.collect()]
    }

    /// The same of a top that has a radius of its own since it flowed, at the interference ω_max, m: where
    /// its attraction jumps, if it does (else NaN), where contact ends, and where its load ends. None where R
    /// is kept.
    pub fn flattened_kinks(&self, largest: f64) -> Option<[f64; 3]> {
        let flattened = self.flattened.as_ref()?;
        let ratio = self.radius_ratio(largest);
        Some([flattened.kink(ratio).unwrap_or(f64::NAN), flattened.release(ratio), 0.0])
    }

    /// Interference of first touch on approach, m.
    pub fn touch(&self) -> f64 {
        begin_of(self.approach.as_ref(), self.first_contact)
    }

    /// Interference at which an elastic contact ends on retraction, m.
    pub fn release(&self) -> f64 {
        begin_of(self.retraction.as_ref(), self.first_contact)
    }

    /// ω_max − ω_res, m, by which an asperity of the interference ω_max, m, springs back at most: all of it
    /// up to ω_c.
    pub fn recovery(&self, largest: f64) -> f64 {
        if largest <= self.top() || !self.flows() { largest } else { self.plastic.recovery(largest) }
    }

    /// The distance, m, at which an asperity of the interference ω_max, m, loses contact on retraction;
    /// none if it has none.
    pub fn detachment(&self, largest: f64) -> Option<f64> {
        let release = || match &self.flattened {
            Some(flattened) if largest > self.top() => flattened.release(self.radius_ratio(largest)),
            _ => self.release(),
        };
        (largest >= self.touch()).then(|| self.recovery(largest) - release())
    }

    /// R′/R of the top of an asperity of the interference ω_max, m, whose contact has ended; 1 where nothing
    /// flowed, or R is kept.
    pub fn radius_ratio(&self, largest: f64) -> f64 {
        if self.flattened.is_none() || !(largest > self.top()) {
            return 1.0;
        }
        let mut ratio = [0.0];
        self.radius_ratios(&[largest], &mut ratio, &mut Responses::default(), &mut SolverStats::default());
        ratio[0]
    }

    /// R′ over the radius of the loop, of asperities that have responded at ω_max.
    pub(super) fn flattened_radius(&self, area: f64, load: f64) -> f64 {
        let radius = (area / PI).sqrt() / self.scale.radius;
        self.scale.force * radius * radius * radius / load
    }

    /// R′/R of asperities of interferences ω_max, m, above ω_c.
    pub(super) fn radius_ratios(
        &self,
        largest: &[f64],
        ratios: &mut [f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let boundaries = self.approach.boundaries();
        let regime =
            |largest: f64| boundaries.partition_point(|end| !end.is_above(largest)).max(self.first_plastic);
        let mut begin = 0;
        while begin < largest.len() {
            let own = regime(largest[begin]);
            let end = begin + largest[begin..].iter().take_while(|largest| regime(**largest) == own).count();
            self.approach.evaluate(own, &largest[begin..end], out, stats);
            for (ratio, (area, load)) in ratios[begin..end].iter_mut().zip(out.area.iter().zip(&out.contact))
            {
                *ratio = self.flattened_radius(*area, *load);
            }
            begin = end;
        }
    }

    /// End of the elastic regime, m.
    pub(super) fn top(&self) -> f64 {
        self.approach.boundaries().get(self.first_plastic - 1).map_or(f64::INFINITY, |end| end.interference)
    }
}

/// Whether the unloading is known of what flows in a law.
fn unloads(model: &Model) -> bool {
    matches!(model.validity.plasticity, Plasticity::Without | Plasticity::KogutEtsion)
}

/// Names of the laws that can be unloaded.
static UNLOADING: LazyLock<String> = LazyLock::new(|| {
    let names: Vec<&str> = MODELS.iter().filter(|model| unloads(model)).map(|model| model.name).collect();
    names.join(", ")
});

/// Interference at which a regime begins, m.
pub(super) fn begin_of(law: &dyn Law, regime: usize) -> f64 {
    if regime == 0 { f64::NEG_INFINITY } else { law.boundaries()[regime - 1].interference }
}

/// Whether a regime is above ω_c.
fn is_plastic(regime: Regime) -> bool {
    matches!(regime, Regime::Elastoplastic1 | Regime::Elastoplastic2 | Regime::Plastic)
}
