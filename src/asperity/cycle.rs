//! The loop of one asperity: loading to an interference ω_max, and unloading.
//!
//! # Formula
//! When the surfaces turn, an asperity has the interference ω_max; at a distance s ≥ 0 from there it has δ =
//! ω_max − s, and its response is a function of ω_max and s alone. So all asperities of a surface at one
//! distance obey one law in the variable ω_max, [`Loop::at`]:
//!
//! | ω_max | what acts |
//! |---|---|
//! | below first touch, or the jump to the inner of two states before it | the law on approach at δ: nothing has been touched, so retraction retraces the approach |
//! | up to ω_c, or any for a law of loading alone | the law on retraction at δ: contact lasts to the end of its stable branch |
//! | above ω_c | the elastic contact of the outline of the summit, `asperity::summit` |
//!
//! After plastic deformation the apex is lowered by the residual depth ω_r, recovers by ω_max − ω_r only, and has a radius ρ of its
//! own. Contact lasts to the interference, counted from the lowered apex, at which the contact of the outline ends. Then the summit
//! is an asperity whose apex is lowered by ω_r: its attraction across the gap follows from the outline; a lubricant or a bridge
//! follows from the radius ρ.
//!
//! # Validity
//! Cycles from a fresh surface to one depth. On the second approach ([`Loop::repeated`]) an asperity that has yielded is a lowered
//! summit. It comes into contact as on approach, at δ − ω_r, and reloads along its unloading branch up to ω_max. The second
//! retraction and every further cycle repeat. Laws without an outline of flattened summits are laws of loading alone: their
//! asperities retrace the approach, so that their loops are valid only where no asperity yields. Where the attraction across the
//! gap has two states, for λ from 0.888 on, approach follows the outermost one to its fold. Where contact leads to the innermost
//! state without a jump, for spheres up to λ = 0.938, an asperity that has reached that state stays on it to its own fold, whether
//! it has yielded or not; else it returns to the outermost one. Source: the contact of a known outline is that of Sneddon, Int. J. Eng. Sci. 3
//! (1965) 47, under the adhesion of Maugis and Dugdale.

use super::block::Responses;
use super::condition::AtDistance;
use super::error::LawError;
use super::history::{ContactHistory, Path};
use super::lane::{Lane, Numbered};
use super::law::Law;
use super::laws::md_plastic::PlasticLoading;
use super::models::Model;
use super::parameters::{InnerState, LawParameters};
use super::radius::RadiusLaw;
use super::scale::Scale;
use super::solved::SolvedAsperity;
use super::stats::SolverStats;
use super::summit::{FlattenedSummit, FlattenedSummits, SUMMIT_KINKS};
use super::summit_table::SummitTable;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

/// An interval of ω_max between two joints of the law on approach, with the distances at which some summits in it pass their kinks.
pub(super) struct Stretch {
    /// ω_max, m, rising.
    pub places: [f64; PLACES],
    /// Distances of the kinks from the closest approach, m.
    pub kinks: [[f64; SUMMIT_KINKS]; PLACES],
}

/// Joints closer than this share are one.
const SAME: f64 = 1e-12;
/// Least number of summits for which a table of them pays.
const MANY: usize = 8;
/// Places of a stretch, and the length of the last stretch in multiples of ω_c or s_δ.
pub(super) const PLACES: usize = 33;
const LAST_STRETCH: f64 = 100.0;

/// The laws of one asperity on approach and on retraction.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, SolvedAsperity, model};
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("jkr").unwrap(), &parameters)?;
/// assert!(cycle.release() < cycle.touch(), "contact lasts longer than it took to begin");
/// let between = 0.5 * (cycle.release() + cycle.touch());
/// assert_eq!(SolvedAsperity::new(cycle.approach(), between).contact_area, 0.0);
/// assert!(SolvedAsperity::new(cycle.retraction(), between).contact_area > 0.0);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct Loop {
    pub(super) approach: Arc<dyn Law>,
    pub(super) retraction: Arc<dyn Law>,
    /// Interference, m, from which retraction differs from the approach.
    pub(super) capture: f64,
    /// Index of the first regime of contact, and of the first above ω_c.
    pub(super) first_contact: usize,
    pub(super) first_plastic: usize,
    /// The plastic loading, of a law with outlines of flattened summits.
    loading: Option<Arc<PlasticLoading>>,
    /// The loop of a second approach, if there is one.
    again: Option<Box<Loop>>,
    /// Largest ω_max, m, for which kinks of summits are sampled, and these samples once they are needed.
    deepest: f64,
    known: OnceLock<Vec<Stretch>>,
    /// The table of summits, of a loop that has one, once it is needed.
    table: OnceLock<SummitTable>,
    is_tabulated: bool,
    /// The laws at distances that surfaces share, by the bits of the distance.
    pub(super) at_distances: Mutex<HashMap<u64, Arc<AtDistance>>>,
    /// The asperity of the own radius.
    lane: [Lane; 1],
    /// The radius over that of the laws that follow it, and their λ, if they solve elastic branches.
    ratio: f64,
    lambda: Option<f64>,
    pub(super) scale: Scale,
}

impl Loop {
    /// The loop of the law of a model for a setting, whatever its path.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made.
    pub fn new(model: &Model, parameters: &LawParameters) -> Result<Self, LawError> {
        Self::back_along(Path::Retraction, model, parameters)
    }

    /// The loop with a second approach, after the surfaces were separated until no contact was left. Asperities that have yielded are
    /// lowered summits there, and contact begins as on approach.
    ///
    /// # Errors
    /// As [`Loop::new`].
    pub fn repeated(model: &Model, parameters: &LawParameters) -> Result<Self, LawError> {
        let again = Self::back_along(Path::Approach, model, parameters)?;
        Ok(Self { again: Some(Box::new(again)), ..Self::new(model, parameters)? })
    }

    /// The loop whose asperities obey the law of a path once they have turned.
    fn back_along(path: Path, model: &Model, parameters: &LawParameters) -> Result<Self, LawError> {
        let back = match parameters.inner_state {
            InnerState::Ignored => InnerState::Ignored,
            _ if path == Path::Approach => parameters.inner_state,
            _ => InnerState::Held,
        };
        let [approach, retraction] = [(Path::Approach, parameters.inner_state), (path, back)]
            .map(|(path, inner_state)| model.law(&LawParameters { path, inner_state, ..*parameters }));
        let [approach, retraction]: [Arc<dyn Law>; 2] = [approach?.into(), retraction?.into()];
        let first_contact = approach.first_contact();
        let regimes = approach.regimes();
        let lambda = retraction.radius_dependence().lambda();
        let plastic = regimes.iter().position(|regime| regime.is_plastic()).filter(|_| model.has_unloading());
        Ok(Self {
            capture: capture_of(approach.as_ref(), first_contact),
            first_contact,
            first_plastic: plastic.unwrap_or(regimes.len()),
            loading: plastic.map(|_| model.plastic_loading(parameters)).transpose()?,
            again: None,
            deepest: parameters.table_range.map_or(f64::NEG_INFINITY, |(_, deepest)| deepest),
            known: OnceLock::new(),
            table: OnceLock::new(),
            at_distances: Mutex::default(),
            is_tabulated: parameters.table_range.is_some(),
            lane: [Lane::new(1.0, lambda)],
            ratio: 1.0,
            lambda,
            scale: parameters.scale,
            approach,
            retraction,
        })
    }

    /// The loop of asperities that differ from this loop's in their radius alone: the lane is one of this
    /// loop.
    ///
    /// # Panics
    /// When it is not known how the laws follow the radius.
    #[doc(hidden)]
    pub fn of(&self, lane: Lane) -> Self {
        let [approach, retraction] = [&self.approach, &self.retraction].map(|law| RadiusLaw::new(law, lane));
        Self {
            capture: capture_of(&approach, self.first_contact),
            first_contact: self.first_contact,
            first_plastic: self.first_plastic,
            loading: self.loading.clone(),
            again: self.again.as_ref().map(|again| Box::new(again.of(lane))),
            deepest: self.deepest,
            known: OnceLock::new(),
            table: OnceLock::new(),
            at_distances: Mutex::default(),
            is_tabulated: false,
            lane: [lane],
            ratio: lane.ratio,
            lambda: self.lambda,
            scale: self.scale.of_ratio(lane.ratio),
            approach: Arc::new(approach),
            retraction: Arc::new(retraction),
        }
    }

    /// The loop with a table of its summits, which pays for many summits.
    #[doc(hidden)]
    pub fn tabulated(self) -> Self {
        Self { is_tabulated: true, ..self }
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

    /// Whether its asperities yield, and unload along another branch.
    pub fn yields(&self) -> bool {
        self.loading.is_some()
    }

    /// The law on retraction, of an asperity that has not yielded.
    pub fn retraction(&self) -> &dyn Law {
        self.retraction.as_ref()
    }

    /// The history of an asperity of the interference ω_max, m.
    pub fn history(&self, largest: f64) -> ContactHistory {
        ContactHistory::of(largest, self.capture, self.onset())
    }

    /// The loop of the second approach, if there is one: its law on retraction is that of asperities that approach again.
    pub fn again(&self) -> Option<&Self> {
        self.again.as_deref()
    }

    /// Whether an asperity of the interference ω_max, m, has yielded.
    pub fn has_yielded(&self, largest: f64) -> bool {
        self.history(largest) == ContactHistory::Yielded
    }

    /// Interferences, m, rising, at which the force on retraction is not smooth: of asperities that have not touched, and of elastic
    /// asperities that have.
    pub fn kinks(&self) -> [Vec<f64>; 2] {
        let ends = |law: &dyn Law, regimes: usize| {
            let ends = (0..regimes).flat_map(|regime| law.pieces_of(regime, None)).map(|piece| piece.upper);
            ends.filter(|end| end.is_finite()).collect::<Vec<f64>>()
        };
        let untouched =
            ends(self.approach(), self.first_contact).into_iter().filter(|end| *end <= self.capture);
        let elastic = ends(self.retraction(), self.first_plastic);
        [untouched.collect(), elastic]
    }

    /// The kinks ([`SUMMIT_KINKS`]) of the summit of an asperity that has yielded to ω_max, m: interferences, m, from the lowered apex,
    /// NaN for a kink that it does not have.
    pub fn flattened_kinks(&self, largest: f64) -> [f64; SUMMIT_KINKS] {
        self.kinks_of(&self.summit_of(largest))
    }

    /// The stretches of ω_max between the joints of the law on approach, rising.
    pub(super) fn stretches(&self) -> &[Stretch] {
        self.known.get_or_init(|| {
            let stretch = |ends: &[f64]| {
                let share = |i: usize| i as f64 / (PLACES - 1) as f64;
                let (from, width) = (ends[0], ends[1] - ends[0]);
                let place = |i: usize| from + width * share(i) * share(i);
                let places: [f64; PLACES] =
                    std::array::from_fn(|i| place(i).max(from + SAME * from.abs()).min(ends[1].next_down()));
                let mut kinks = [[f64::NAN; SUMMIT_KINKS]; PLACES];
                let mut rows = kinks.iter_mut();
                self.summits(&places, &mut SolverStats::default(), |summit| {
                    rows.next().into_iter().for_each(|row| *row = summit.passes());
                });
                Stretch { places, kinks }
            };
            self.joints().windows(2).map(stretch).collect()
        })
    }

    /// The external forces, N, of an asperity that has yielded to ω_max, m, at interferences from its lowered apex, m: on unloading,
    /// and above ω_max on loading.
    pub fn forces_after(&self, largest: f64, interferences: &[f64]) -> Vec<f64> {
        let (summit, mut summits) = (self.summit_of(largest), FlattenedSummits::default());
        let (kinks, recovery) = (summit.kinks, summit.recovery);
        summits.push(summit);
        let ends: Vec<f64> = (0..self.first_contact).map(|regime| kinks[self.end_kink(regime)]).collect();
        let (mut out, mut stats) = (Responses::default(), SolverStats::default());
        let force = |own: &f64| {
            if *own > recovery {
                return SolvedAsperity::new(self.approach(), largest + (own - recovery)).external_force();
            }
            let law = (self.retraction(), ends.iter().filter(|end| **end <= *own).count());
            summits.respond_all(law, recovery - own, &mut out, &mut stats);
            out.contact[0] - out.adhesion[0]
        };
        interferences.iter().map(force).collect()
    }

    /// The interferences, m, from the lowered apex, of the kinks of a summit.
    pub(super) fn kinks_of(&self, summit: &FlattenedSummit) -> [f64; SUMMIT_KINKS] {
        let lane = summit.lane();
        let mut kinks = [f64::NAN; SUMMIT_KINKS];
        let mut lower = f64::NEG_INFINITY;
        let mut count = 0;
        for regime in 0..=self.first_contact {
            let is_contact = regime == self.first_contact;
            let upper = if is_contact { summit.recovery } else { self.leaves(regime, &lane) };
            let own = self.retraction.kinks_of_summit(regime, &lane, &summit.outlined).into_iter();
            for kink in own {
                if kink.is_finite() && lower < kink && kink < upper {
                    kinks[count] = kink;
                }
                count = (count + 1).min(SUMMIT_KINKS - 3);
            }
            lower = upper;
        }
        for regime in self.first_contact.saturating_sub(2)..self.first_contact {
            kinks[self.end_kink(regime)] = self.leaves(regime, &lane);
        }
        kinks
    }

    /// The number of the kink at which an unloading summit enters a regime before contact.
    pub(super) fn end_kink(&self, regime: usize) -> usize {
        SUMMIT_KINKS + regime - self.first_contact
    }

    /// Whether an asperity has the radius of the loop.
    pub(super) fn is_of(&self, lane: &Lane) -> bool {
        lane.ratio == self.ratio
    }

    /// The interference, m, from the lowered apex at which an unloading summit enters a regime before contact; for the last of
    /// these regimes, the end of contact.
    pub(super) fn leaves(&self, regime: usize, lane: &Lane) -> f64 {
        let end = |regime: usize| self.retraction.end(regime, lane).unwrap_or(f64::NEG_INFINITY);
        end(regime).min(end(self.first_contact - 1))
    }

    /// The asperity of a multiple of the radius.
    #[doc(hidden)]
    pub fn lane(&self, ratio: f64) -> Lane {
        Lane::new(self.ratio * ratio, self.lambda)
    }

    /// Interference of first touch on approach, m.
    pub fn touch(&self) -> f64 {
        self.approach.begin(self.first_contact)
    }

    /// Interference at which an elastic contact ends on retraction, m.
    pub fn release(&self) -> f64 {
        self.retraction.begin(self.first_contact)
    }

    /// The elastic recovery ω_max − ω_r, m, of an asperity of the interference ω_max, m: all of it up to ω_c.
    pub fn recovery(&self, largest: f64) -> f64 {
        if largest > self.onset() { self.summit_of(largest).recovery } else { largest }
    }

    /// The distance, m, at which an asperity of the interference ω_max, m, loses contact on retraction;
    /// none if it has not touched.
    pub fn detachment(&self, largest: f64) -> Option<f64> {
        (largest >= self.touch()).then(|| {
            if largest > self.onset() {
                self.left_at(self.first_contact - 1, largest)
            } else {
                largest - self.release()
            }
        })
    }

    /// The distance, m, at which an asperity that has yielded to ω_max, m, enters a regime before contact on unloading.
    pub(super) fn left_at(&self, regime: usize, largest: f64) -> f64 {
        self.summit_of(largest).passes()[self.end_kink(regime)]
    }

    /// ρ/R of the apex of an asperity of the interference ω_max, m; 1 where nothing has yielded.
    pub fn radius_ratio(&self, largest: f64) -> f64 {
        if largest > self.onset() { self.summit_of(largest).ratio / self.ratio } else { 1.0 }
    }

    /// The flattened summit of an asperity of the interference ω_max, m, above ω_c.
    pub(super) fn summit_of(&self, largest: f64) -> FlattenedSummit {
        let mut summit = FlattenedSummit::default();
        self.flatten(
            self.plastic_regime(largest),
            self.own(),
            &[largest],
            &mut SolverStats::default(),
            |own| summit = own,
        );
        summit
    }

    /// A block of asperities of the radius of the loop.
    fn own(&self) -> Numbered<'_> {
        Numbered::alike(&self.lane)
    }

    /// The regime above ω_c of an asperity on approach.
    fn plastic_regime(&self, largest: f64) -> usize {
        let boundaries = self.approach.boundaries();
        boundaries.partition_point(|end| !end.is_above(largest)).max(self.first_plastic)
    }

    /// Visits the flattened summits of asperities of the radius of the loop, of interferences ω_max, m, above ω_c. Many summits are
    /// read from the table.
    pub(super) fn summits(
        &self,
        largest: &[f64],
        stats: &mut SolverStats,
        mut visit: impl FnMut(FlattenedSummit),
    ) {
        if self.is_tabulated && largest.len() >= MANY {
            let table =
                self.table.get_or_init(|| SummitTable::new(&self.joints(), |own| self.summit_of(own)));
            return largest
                .iter()
                .for_each(|own| visit(table.summit(*own).unwrap_or_else(|| self.summit_of(*own))));
        }
        for same in largest.chunk_by(|a, b| self.plastic_regime(*a) == self.plastic_regime(*b)) {
            self.flatten(self.plastic_regime(same[0]), self.own(), same, stats, &mut visit);
        }
    }

    /// Visits the flattened summits of asperities of lanes, of interferences ω_max, m, in one regime above ω_c.
    pub(super) fn flatten(
        &self,
        regime: usize,
        lanes: Numbered<'_>,
        largest: &[f64],
        stats: &mut SolverStats,
        mut visit: impl FnMut(FlattenedSummit),
    ) {
        let Some(loading) = &self.loading else { return };
        loading.summits(regime - self.first_plastic, lanes, largest, stats, |summit| {
            visit(FlattenedSummit { kinks: self.kinks_of(&summit), ..summit });
        });
    }

    /// ω_max, m, rising, between which summits vary smoothly, from the onset of plastic deformation to [`Loop::deepest`].
    fn joints(&self) -> Vec<f64> {
        let critical = self.critical();
        let mut joints: Vec<f64> = self.approach.pieces(None).iter().map(|piece| piece.upper).collect();
        joints.retain(|end| critical < *end && end.is_finite());
        joints.insert(0, critical);
        joints.push(self.deepest());
        // Joints of two kinds are one but for rounding.
        joints.dedup_by(|next, own| *next - *own <= SAME * next.abs());
        joints
    }

    /// The largest ω_max, m, for which summits are sampled and tabulated.
    pub(super) fn deepest(&self) -> f64 {
        let critical = self.critical();
        let joints = self.approach.pieces(None);
        let last = joints.iter().map(|piece| piece.upper).filter(|end| critical < *end && end.is_finite());
        let last = last.fold(critical, f64::max);
        self.deepest.max(last + LAST_STRETCH * critical.abs().max(self.scale.length))
    }

    /// The interference, m, from which asperities yield and unload by their outlines; infinite if none does.
    pub fn onset(&self) -> f64 {
        if self.yields() { self.critical() } else { f64::INFINITY }
    }

    /// End of the elastic regime, m.
    pub(super) fn critical(&self) -> f64 {
        self.approach.boundaries().get(self.first_plastic - 1).map_or(f64::INFINITY, |end| end.interference)
    }
}

/// Interference, m, from which retraction differs from an approach whose contact begins in a regime.
fn capture_of(approach: &dyn Law, first_contact: usize) -> f64 {
    let touch = approach.begin(first_contact);
    approach.capture(None).map_or(touch, |capture| capture.min(touch))
}
