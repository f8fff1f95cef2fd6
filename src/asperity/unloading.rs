//! One asperity that is brought close and pulled back: each with its own history.
//!
//! # Formula
//! When the surfaces turn, an asperity has the interference ω_max; at a distance s ≥ 0 from there it has δ =
//! ω_max − s, and its response is a function of ω_max and s alone. So all asperities of a surface at one
//! distance obey one law in the variable ω_max, [`Loop::at`]:
//!
//! | ω_max | what acts |
//! |---|---|
//! | below first touch, or the jump to the inner of two states before it | the law on approach at δ: nothing has been touched, so retraction retraces the approach |
//! | up to ω_c (more in a case below), or any of a law that knows no flow | the law on retraction at δ: contact lasts to the end of its stable branch |
//! | above ω_c | the unloading of an elastic-plastic contact, below |
//!
//! After plastic flow the asperity is lower by its residual interference ω_res, springs back by its recovery ω_max −
//! ω_res only, and its top may have a radius R′ of its own. How is a choice, [`Unloading`], with the formulas in
//! `springback`. Contact lasts to the interference δ_end, counted from the lowered top; from there on the asperity is one
//! whose top is lower by ω_res, with the radius R′: lubricant and attraction across the gap at δ − ω_res.
//!
//! # Adhesion
//! The unloading of Etsion, Kligerman and Kadin is published without adhesion. The adhesion for which the elastic-plastic fits
//! were computed acts outside the contact, as in the DMT limit, across a gap whose shape plastic flow leaves behind: a contact
//! that has flowed deeply keeps its F_s. One that has only begun to flow is elastic. So F_s goes from the one to the other
//! with the share ω_res/ω_max that has flowed (`springback`). Contact lasts, without load, to the place where that of
//! an elastic asperity would end, δ_end = −δ_A on retraction. The others bring an adhesion of their own: that of the elastic
//! law with R′ by the secant, within the contact by the other two. F_s jumps where the surfaces turn, and with the
//! elastic law of Maugis and Dugdale or of JKR the load does so by what adhesion adds to it.
//!
//! # Radius
//! A top that flowed is flatter. How much is not published with the unloading of Etsion, Kligerman and Kadin, and it
//! decides what attracts from then on, so it is a choice there, [`UnloadedRadius`]: the top keeps R, or it
//! has that of the secant, the R′ = 4E_r a³/(3P) of the elastic contact whose radius and load are those at
//! ω_max. With R′ the attraction before contact, the lubricant's force and δ_A follow from R′: λ′ =
//! λ(R′/R)^(1/3), as in `radius`.
//!
//! # Validity
//! Cycles from a fresh surface to one depth. On the second approach ([`Loop::repeated`]) what has flowed is a lowered top that
//! comes into contact as on approach, at δ − ω_res, and is loaded along its unloading up to ω_max: the second retraction, and
//! every further cycle, repeat. The unloading of Etsion, Kligerman and Kadin was computed for loads up to the limits of
//! the elastic-plastic fits of Kogut and Etsion, and is for those alone; in the fully plastic regime it is used beyond them,
//! without adhesion, as there is none on approach. Its ω_c is taken to be that of the law. The others are for any loading.
//! Where a loading law jumps up as it begins to flow (by 3 % that of Kogut and Etsion, by half that of Chang, Etsion and Bogy),
//! the secant would have tops spring back by more than ω_max, and give out more energy than they took up. Up to where it does
//! not, 1.6ω_c and 3.9ω_c with these, asperities go back along their approach. Where the attraction across the gap has two
//! states, for λ from 0.888 on, approach takes the outer one to its fold. Where contact leads to the inner one without a jump,
//! to λ = 0.938, an asperity that has come to that stays on it to its own fold, lowered or not; above that it is on the outer
//! one again, as the laws are. Sources: Etsion, Kligerman and Kadin, Int. J. Solids Struct. 42
//! (2005) 3716; Johnson, Contact Mechanics (1985), section 6.4, for the secant; Mesarovic and Johnson, J. Mech. Phys.
//! Solids 48 (2000) 2009; Thornton and Ning, Powder Technol. 99 (1998) 154.

use super::block::Responses;
use super::error::LawError;
use super::history::{ContactHistory, Path};
use super::lane::{Lane, Lanes};
use super::law::{End, Law, Smoothness};
use super::models::{Model, Plasticity, model};
use super::parameters::{InnerState, LawParameters};
use super::plastic_unloading::PlasticUnloading;
use super::radius::RadiusLaw;
use super::scale::Scale;
use super::springback::{Springback, Top, Tops, fade, first_contact};
use super::stats::SolverStats;
use crate::math::roots::{Sample, safe_newton};
use std::sync::Arc;

/// Recoveries of continuous laws are ω_max where they begin to flow, but for so much of it.
const ROUNDING: f64 = 1e-12;

/// The unloading of contacts that have flowed.
///
/// # Examples
/// ```
/// use stiction::asperity::{UnloadedRadius, Unloading, model};
///
/// assert_eq!(Unloading::of(&model("hybrid").unwrap()), UnloadedRadius::Kept.into());
/// assert_eq!(Unloading::of(&model("ceb").unwrap()), Unloading::Secant);
/// assert_eq!(Unloading::named("thornton_ning"), Some(Unloading::ThorntonNing));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unloading {
    /// Etsion, Kligerman and Kadin's fits, which are of Kogut and Etsion's contact alone; tops have one or
    /// the other radius.
    EtsionKligermanKadin(UnloadedRadius),
    /// The elastic contact of the law of a sphere whose Hertz contact has the largest load and its radius.
    Secant,
    /// The decohesion of a top that a uniform pressure has flattened.
    MesarovicJohnson,
    /// The JKR contact of the sphere of the secant.
    ThorntonNing,
    /// The elastic contact that the laws `md_plastic` and `capillary` have at the largest load, which nothing
    /// leaves abruptly.
    FlattenedTop,
}

impl Unloading {
    /// All of them, the first with tops that keep their radius, with their names.
    pub const ALL: [(&'static str, Self); 5] = [
        ("ekk", Self::EtsionKligermanKadin(UnloadedRadius::Kept)),
        ("secant", Self::Secant),
        ("mesarovic_johnson", Self::MesarovicJohnson),
        ("thornton_ning", Self::ThorntonNing),
        ("flattened_top", Self::FlattenedTop),
    ];

    /// The unloading of a law where none is chosen.
    pub fn of(model: &Model) -> Self {
        match model.validity.plasticity {
            Plasticity::Without | Plasticity::KogutEtsion => UnloadedRadius::Kept.into(),
            Plasticity::Other => Self::Secant,
            Plasticity::FlattenedTop => Self::FlattenedTop,
        }
    }

    /// The unloading of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, unloading)| *unloading)
    }

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        let is_same = |other: &Self| std::mem::discriminant(other) == std::mem::discriminant(&self);
        Self::ALL.iter().find(|(_, other)| is_same(other)).expect("every unloading is in ALL").0
    }

    /// Whether it is for the contacts of a law.
    pub fn suits(self, model: &Model) -> bool {
        match model.validity.plasticity {
            Plasticity::Without | Plasticity::KogutEtsion => self != Self::FlattenedTop,
            Plasticity::Other => !matches!(self, Self::EtsionKligermanKadin(_) | Self::FlattenedTop),
            Plasticity::FlattenedTop => self == Self::FlattenedTop,
        }
    }

    /// The radius of tops that have flowed, once their contact has ended.
    pub fn radius(self) -> UnloadedRadius {
        match self {
            Self::EtsionKligermanKadin(radius) => radius,
            _ => UnloadedRadius::Elastic,
        }
    }

    /// The unloading with the other radius of tops that have flowed, where that is a choice.
    pub fn other_radius(self) -> Option<Self> {
        match self {
            Self::EtsionKligermanKadin(radius) => Some(radius.other().into()),
            _ => None,
        }
    }
}

impl From<UnloadedRadius> for Unloading {
    /// The unloading of Etsion, Kligerman and Kadin.
    fn from(radius: UnloadedRadius) -> Self {
        Self::EtsionKligermanKadin(radius)
    }
}

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
    /// The radius before flow.
    #[default]
    Kept,
    /// The radius that elastic unloading from the largest load leaves: 4E_r a³/(3P), or πE_r a³/P by
    /// Mesarovic and Johnson.
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
    /// Interference, m, above which an asperity does not go back as it came: ω_c, or more where the unloading would have
    /// tops spring back by more than ω_max.
    pub(super) onset: f64,
    /// Springback of contacts that have flowed.
    pub(super) springback: Springback,
    /// Whether tops that have flowed have radii of their own.
    pub(super) own_radii: bool,
    /// The loop of a second approach, if there is one.
    again: Option<Box<Loop>>,
    /// The radius over that of the laws as they follow it, and their λ, if they solve elastic branches.
    ratio: f64,
    lambda: Option<f64>,
    pub(super) scale: Scale,
}

impl Loop {
    /// The loop of the law of a model for a setting, whatever its path.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made, [`LawError::NoUnloading`] when it flows otherwise than the
    /// contact that the unloading was computed for, [`LawError::NotFlattened`] when it is a fit to one radius
    /// and flows, and tops that have flowed are to have radii of their own.
    pub fn new(
        model: &Model,
        parameters: &LawParameters,
        unloading: impl Into<Unloading>,
    ) -> Result<Self, LawError> {
        Self::back_along(Path::Retraction, model, parameters, unloading.into())
    }

    /// The loop with the second approach of surfaces that were parted until no contact was left: what has flowed is a lowered top
    /// there, and contact begins as on approach.
    ///
    /// # Errors
    /// As [`Loop::new`].
    pub fn repeated(
        model: &Model,
        parameters: &LawParameters,
        unloading: impl Into<Unloading>,
    ) -> Result<Self, LawError> {
        let unloading = unloading.into();
        let again = Self::back_along(Path::Approach, model, parameters, unloading)?;
        Ok(Self { again: Some(Box::new(again)), ..Self::new(model, parameters, unloading)? })
    }

    /// The loop whose asperities obey the law of a path once they have turned.
    fn back_along(
        path: Path,
        model: &Model,
        parameters: &LawParameters,
        unloading: Unloading,
    ) -> Result<Self, LawError> {
        if !unloading.suits(model) {
            return Err(LawError::NoUnloading { law: model.name, unloading: unloading.name() });
        }
        let back = match parameters.inner_state {
            InnerState::Ignored => InnerState::Ignored,
            _ if path == Path::Approach => parameters.inner_state,
            _ => InnerState::Held,
        };
        let [approach, retraction] = [(Path::Approach, parameters.inner_state), (path, back)]
            .map(|(path, inner_state)| model.law(&LawParameters { path, inner_state, ..*parameters }));
        let [approach, retraction]: [Arc<dyn Law>; 2] = [approach?.into(), retraction?.into()];
        let regimes = approach.regimes();
        let first_contact = first_contact(approach.as_ref());
        let first_plastic = regimes.iter().position(|regime| regime.is_plastic()).unwrap_or(regimes.len());
        let own_radii = unloading.radius() == UnloadedRadius::Elastic && first_plastic < regimes.len();
        if own_radii && (model.is_fit() || !retraction.follows_radius()) {
            return Err(LawError::NotFlattened);
        }
        let mut cycle = Self {
            capture: capture_of(approach.as_ref(), first_contact),
            first_contact,
            first_plastic,
            onset: f64::INFINITY,
            springback: springback((unloading, path), model, parameters)?,
            own_radii,
            again: None,
            ratio: 1.0,
            lambda: retraction.lambda().filter(|_| retraction.follows_radius()),
            scale: parameters.scale,
            approach,
            retraction,
        };
        cycle.onset = cycle.find_onset();
        Ok(cycle)
    }

    /// The interference, m, from which the recovery is not more than ω_max.
    fn find_onset(&self) -> f64 {
        let critical = self.critical();
        if !self.flows() || matches!(self.springback, Springback::Powers(_) | Springback::Flattened(_)) {
            return critical;
        }
        let more = |largest: f64| self.top_of(largest).recovery - largest;
        let (low, mut high) = (critical.next_up(), 2.0 * critical);
        // Equal recoveries differ by rounding.
        if !(more(low) > ROUNDING * critical) {
            return critical;
        }
        while more(high) > 0.0 && high < f64::MAX {
            high *= 2.0;
        }
        let falling = |largest: f64| Sample { value: more(largest), slope: f64::NAN };
        safe_newton(falling, low, high, f64::NAN, |_, _| false).x
    }

    /// The regimes in which asperities go back as they came, but for the history, and the first in which some do not.
    pub(super) fn elastic_regimes(&self) -> (usize, usize) {
        if self.onset == self.critical() {
            return (self.first_plastic, self.first_plastic);
        }
        let last = self.approach.boundaries().partition_point(|end| !end.is_above(self.onset));
        (last + 1, last)
    }

    /// The loop of asperities that differ from this loop's in their radius alone: the lane is one of this
    /// loop.
    ///
    /// # Panics
    /// When it is not known how the laws follow the radius.
    #[doc(hidden)]
    pub fn of(&self, lane: Lane) -> Self {
        let [approach, retraction] = [&self.approach, &self.retraction].map(|law| RadiusLaw::new(law, lane));
        let mut cycle = Self {
            capture: capture_of(&approach, self.first_contact),
            first_contact: self.first_contact,
            first_plastic: self.first_plastic,
            // Loads, areas and recoveries depend on ω_max/ω_c.
            onset: self.onset * lane.ratio,
            springback: self.springback.of(lane),
            own_radii: self.own_radii,
            again: self.again.as_ref().map(|again| Box::new(again.of(lane))),
            ratio: lane.ratio,
            lambda: self.lambda,
            scale: self.scale.of_ratio(lane.ratio),
            approach: Arc::new(approach),
            retraction: Arc::new(retraction),
        };
        if self.onset == self.critical() {
            cycle.onset = cycle.critical();
        }
        cycle
    }

    /// The law along a path.
    pub(super) fn law(&self, path: Path) -> &dyn Law {
        match path {
            Path::Approach => self.approach(),
            Path::Retraction => self.retraction(),
        }
    }

    /// Index of the first regime of contact.
    #[doc(hidden)]
    pub fn first_contact(&self) -> usize {
        self.first_contact
    }

    /// The law on approach.
    pub fn approach(&self) -> &dyn Law {
        self.approach.as_ref()
    }

    /// Whether the law knows plastic flow.
    pub fn flows(&self) -> bool {
        self.first_plastic < self.approach.regimes().len()
    }

    /// The law on retraction, of an asperity that has not flowed.
    pub fn retraction(&self) -> &dyn Law {
        self.retraction.as_ref()
    }

    /// The history of an asperity of the interference ω_max, m.
    pub fn history(&self, largest: f64) -> ContactHistory {
        if largest < self.capture {
            ContactHistory::Untouched
        } else if self.flows() && largest > self.onset {
            ContactHistory::Flowed
        } else {
            ContactHistory::Touched
        }
    }

    /// The loop of the second approach, if there is one: its retraction is the way of asperities that come close again.
    pub fn again(&self) -> Option<&Self> {
        self.again.as_deref()
    }

    /// Whether an asperity of the interference ω_max, m, has flowed.
    pub fn has_flowed(&self, largest: f64) -> bool {
        self.history(largest) == ContactHistory::Flowed
    }

    /// Whether tops that have flowed have radii of their own.
    #[doc(hidden)]
    pub fn own_radii(&self) -> bool {
        self.own_radii
    }

    /// Interferences, m, rising, at which the force on retraction is not smooth, by [`ContactHistory`]: counted
    /// from the top that the asperity has then, so they are passed at the distance [`Loop::recovery`] less
    /// them.
    pub fn kinks(&self) -> [Vec<f64>; 3] {
        let ends = |law: &dyn Law, regimes: usize| {
            let ends = (0..regimes).flat_map(|regime| law.pieces_of(regime, None)).map(|piece| piece.upper);
            ends.filter(|end| end.is_finite()).collect::<Vec<f64>>()
        };
        let untouched =
            ends(self.approach(), self.first_contact).into_iter().filter(|end| *end <= self.capture);
        let elastic = ends(self.retraction(), self.elastic_regimes().0);
        // Contact ends, and the load where it has sprung back.
        let mut flowed = ends(self.retraction(), self.first_contact);
        let contact = self.contact();
        flowed.pop();
        flowed.extend([begin_of(contact, first_contact(contact)), 0.0]);
        [untouched.collect(), elastic, flowed]
    }

    /// Kinks of a top that has a radius of its own since it flowed, at the interference ω_max, m: where its
    /// attraction jumps, where the film breaks, where contact ends, and where the contact is not smooth; NaN
    /// where it has none. None where R is kept.
    pub fn flattened_kinks(&self, largest: f64) -> Option<[f64; 4]> {
        if !self.own_radii {
            return None;
        }
        let top = self.top_of(largest);
        let lane = self.lane(top.ratio);
        let leaves = |regime: usize| self.leaves(regime, &top, &lane);
        let film = self.first_contact.checked_sub(2).map_or(f64::NAN, leaves);
        let attraction = self.attraction_kink(&lane).unwrap_or(f64::NAN);
        Some([attraction, film, leaves(self.first_contact - 1), self.springback.kink(&top)])
    }

    /// The interference, m, from the lowered top, of a lane, at which it comes into a regime before contact from above: the
    /// last where its contact ends.
    pub(super) fn leaves(&self, regime: usize, top: &Top, lane: &Lane) -> f64 {
        let release = self.springback.release(self.retraction(), top, lane);
        match &self.springback {
            // It is the law on retraction of its radius.
            Springback::Elastic(None) | Springback::Flattened(_) => {
                self.retraction.end(regime, lane).map_or(release, |end| end.min(release))
            }
            _ => release - (self.release() - self.retraction.boundaries()[regime].interference),
        }
    }

    /// The law of which the end of contact is that of contacts that have flowed.
    #[doc(hidden)]
    pub fn contact(&self) -> &dyn Law {
        self.springback.contact(self.retraction())
    }

    /// Interference, m, at which the attraction of a top of its own radius jumps and is a root of what is left of the
    /// approach, if there is one.
    pub(super) fn attraction_kink(&self, lane: &Lane) -> Option<f64> {
        let is_kink = |smoothness| matches!(smoothness, Smoothness::Root { end: End::Upper, .. });
        let mut pieces =
            (0..self.first_contact).flat_map(|regime| self.retraction.pieces_of(regime, Some(lane)));
        pieces.find(|piece| is_kink(piece.smoothness)).map(|piece| piece.upper)
    }

    /// The asperity of R′/R.
    #[doc(hidden)]
    pub fn lane(&self, ratio: f64) -> Lane {
        Lane::new(self.ratio * ratio, self.lambda)
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
        match &self.springback {
            _ if largest <= self.onset || !self.flows() => largest,
            Springback::Powers(plastic) => plastic.recovery(largest),
            _ => self.top_of(largest).recovery,
        }
    }

    /// The distance, m, at which an asperity of the interference ω_max, m, loses contact on retraction;
    /// none if it has none.
    pub fn detachment(&self, largest: f64) -> Option<f64> {
        (largest >= self.touch()).then(|| {
            if self.own_radii && largest > self.onset {
                self.left_at(self.first_contact - 1, largest)
            } else {
                self.recovery(largest) - self.release()
            }
        })
    }

    /// The distance, m, at which an asperity that has flowed to ω_max, m, and whose top has a radius of its own, comes into a
    /// regime before contact from above.
    pub(super) fn left_at(&self, regime: usize, largest: f64) -> f64 {
        let top = self.top_of(largest);
        let recovery = match &self.springback {
            Springback::Powers(plastic) => plastic.recovery(largest),
            _ => top.recovery,
        };
        recovery - self.leaves(regime, &top, &self.lane(top.ratio))
    }

    /// The distance, m, from which a contact that has flowed to ω_max, m, is not smooth, in itself.
    pub(super) fn opening(&self, largest: f64) -> f64 {
        let top = self.top_of(largest);
        top.recovery - self.springback.kink(&top)
    }

    /// R′/R of the top of an asperity of the interference ω_max, m, whose contact has ended; 1 where nothing
    /// flowed, or R is kept.
    pub fn radius_ratio(&self, largest: f64) -> f64 {
        if self.own_radii && largest > self.onset { self.top_of(largest).ratio } else { 1.0 }
    }

    /// The top of an asperity of the interference ω_max, m, above ω_c.
    pub(super) fn top_of(&self, largest: f64) -> Top {
        let mut top = [Top::default()];
        self.tops(&[largest], &mut top, &mut Responses::default(), &mut SolverStats::default());
        top[0]
    }

    /// The tops of asperities of interferences ω_max, m, above ω_c.
    pub(super) fn tops(
        &self,
        largest: &[f64],
        tops: &mut [Top],
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
            self.approach.evaluate(own, Lanes::Own, &largest[begin..end], out, stats);
            for (i, place) in (begin..end).enumerate() {
                tops[place] = self.springback.top(&self.scale, out.contact[i], out.area[i]);
            }
            begin = end;
        }
        if let Springback::Powers(plastic) = &self.springback {
            let mut recoveries = vec![0.0; largest.len()];
            plastic.recoveries(largest, &mut recoveries);
            tops.iter_mut().zip(recoveries).for_each(|(top, recovery)| top.recovery = recovery);
        }
    }

    /// Turns the responses at interferences ω_max, m, above ω_c into responses of contacts at a distance, m,
    /// from there.
    pub(super) fn unload(
        &self,
        largest: &[f64],
        distance: f64,
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let (law, scale) = (self.retraction(), &self.scale);
        if let Springback::Powers(plastic) = &self.springback {
            plastic.unload(largest, |_| distance, out);
            return fade(plastic, (law, scale), (largest, distance), out, stats);
        }
        let top = |i: usize| self.springback.top(scale, out.contact[i], out.area[i]);
        let tops: Vec<Top> = (0..largest.len()).map(top).collect();
        let lanes: Vec<Lane> = tops.iter().map(|top| self.lane(top.ratio)).collect();
        self.springback.unload(Tops { law, tops: &tops, lanes: &lanes }, distance, out, stats);
    }

    /// End of the elastic regime, m.
    pub(super) fn critical(&self) -> f64 {
        self.approach.boundaries().get(self.first_plastic - 1).map_or(f64::INFINITY, |end| end.interference)
    }
}

/// The springback of contacts of a setting on a path.
fn springback(
    (unloading, path): (Unloading, Path),
    own: &Model,
    parameters: &LawParameters,
) -> Result<Springback, LawError> {
    let jkr = |path| {
        let jkr = model("jkr").expect("it is a law");
        jkr.law(&LawParameters { path, ..*parameters })
    };
    Ok(match unloading {
        Unloading::EtsionKligermanKadin(_) => {
            let deepest = parameters.table_range.map(|(_, deepest)| deepest);
            Springback::Powers(PlasticUnloading::new(parameters.critical_interference, deepest))
        }
        Unloading::Secant => Springback::Elastic(None),
        Unloading::FlattenedTop => Springback::Flattened(own.around(parameters)?),
        Unloading::ThorntonNing => Springback::Elastic(Some(jkr(path)?.into())),
        // It closes as it has opened.
        Unloading::MesarovicJohnson => Springback::Punch(jkr(Path::Retraction)?.into()),
    })
}

/// Interference, m, from which retraction does not retrace an approach whose contact begins in a regime.
fn capture_of(approach: &dyn Law, first_contact: usize) -> f64 {
    let touch = begin_of(approach, first_contact);
    approach.capture(None).map_or(touch, |capture| capture.min(touch))
}

/// Interference at which a regime begins, m.
pub(super) fn begin_of(law: &dyn Law, regime: usize) -> f64 {
    if regime == 0 { f64::NEG_INFINITY } else { law.boundaries()[regime - 1].interference }
}
