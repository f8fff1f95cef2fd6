//! Closed forms as they are printed: a formula for each force at one interference, from which [`ClosedForm`]
//! makes the loop over blocks.

use super::block::{BLOCK, Responses};
use super::lane::{Lane, Lanes, Numbered};
use super::law::{End, Law, Method, Piece, RadiusDependence, Smoothness};
use super::parameters::LawParameters;
use super::radius::Similarity;
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::Piecewise;
use std::ops::Range;

/// One quantity of an asperity by its interference δ, m: any `Fn(f64) -> f64` is one.
///
/// # Examples
/// ```
/// use stiction::asperity::{ClosedForm, Constant, Formula, Regime, Row, SolvedAsperity, Table, Zero};
///
/// /// Nothing before contact, and a load without attraction in it.
/// fn contact(load: impl Formula) -> Table {
///     let rows = [
///         Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
///         Row::last(Regime::Elastic, ClosedForm::new(Zero, load, Zero)),
///     ];
///     Table::new(rows)
/// }
///
/// let spring = contact(|delta: f64| 3.0 * delta);
/// assert_eq!(SolvedAsperity::new(&spring, 2.0).contact_force, 6.0);
/// assert_eq!(SolvedAsperity::new(&spring, -2.0).contact_force, 0.0);
/// ```
pub trait Formula: Clone + Send + Sync + 'static {
    /// Fills `out` with the values at interferences δ, m.
    fn fill(&self, interference: &[f64], out: &mut [f64]);

    /// The similarity by which the values follow the radius of the asperity, if it is known.
    #[doc(hidden)]
    fn similarity(&self) -> Option<Similarity> {
        None
    }

    /// The formula with the similarity by which its values follow the radius.
    #[doc(hidden)]
    fn following(self, similarity: Similarity) -> Following<Self> {
        Following { formula: self, similarity }
    }
}

/// A formula of which it is known how it follows the radius.
#[doc(hidden)]
#[derive(Clone, Debug)]
pub struct Following<F> {
    formula: F,
    similarity: Similarity,
}

impl<F: Formula> Formula for Following<F> {
    #[inline(always)]
    fn fill(&self, interference: &[f64], out: &mut [f64]) {
        self.formula.fill(interference, out);
    }

    fn similarity(&self) -> Option<Similarity> {
        Some(self.similarity)
    }
}

impl<F: Fn(f64) -> f64 + Clone + Send + Sync + 'static> Formula for F {
    #[inline(always)]
    fn fill(&self, interference: &[f64], out: &mut [f64]) {
        for (value, &delta) in out.iter_mut().zip(interference) {
            *value = self(delta);
        }
    }
}

/// No force and no area.
#[derive(Clone, Copy, Debug)]
pub struct Zero;

impl Formula for Zero {
    #[inline(always)]
    fn fill(&self, _: &[f64], out: &mut [f64]) {
        out.fill(0.0);
    }

    fn similarity(&self) -> Option<Similarity> {
        Some(Similarity::new(0.0, 0.0))
    }
}

/// A formula that takes longer than a few products, such as a power or an integral, and is read from a table
/// where it has one.
///
/// # Examples
/// ```
/// use stiction::asperity::{ClosedForm, Regime, Row, SolvedAsperity, Table, Tabulated, Zero};
///
/// let power = Tabulated::new(1.0, 1.0, |x: f64| x.powf(1.425), 1e-12, (1.0, 110.0));
/// let law = Table::new([Row::last(Regime::Plastic, ClosedForm::new(Zero, power, Zero))]);
/// let force = SolvedAsperity::new(&law, 8.0).contact_force;
/// assert!((force / 8_f64.powf(1.425) - 1.0).abs() < 1e-11);
/// ```
#[derive(Clone, Debug)]
pub struct Tabulated<F> {
    formula: F,
    /// The variable of the formula over δ, 1/m.
    per_length: f64,
    /// The factor of its values.
    unit: f64,
    /// Whether the table is over the root of the variable.
    over_root: bool,
    table: Piecewise,
}

impl<F: Fn(f64) -> f64> Tabulated<F> {
    /// `unit` times the formula of x = δ `per_length`, with a table on the interval `reach` of x that meets
    /// it to a relative `tolerance`.
    pub fn new(unit: f64, per_length: f64, formula: F, tolerance: f64, reach: (f64, f64)) -> Self {
        let table = Piecewise::new(&formula, |_, value| tolerance * value, reach.0, reach.1);
        Self { formula, per_length, unit, over_root: false, table }
    }

    /// The formula with a table that meets it to an absolute `tolerance` of x.
    pub(super) fn within(
        unit: f64,
        per_length: f64,
        formula: F,
        tolerance: impl Fn(f64) -> f64,
        reach: (f64, f64),
    ) -> Self {
        let table = Piecewise::new(&formula, |x, _| tolerance(x), reach.0, reach.1);
        Self { formula, per_length, unit, over_root: false, table }
    }

    /// The formula with a table over √x, in which it is smooth.
    pub fn over_root(unit: f64, per_length: f64, formula: F, tolerance: f64, reach: (f64, f64)) -> Self {
        let of_root = |root: f64| formula(root * root);
        let table = Piecewise::new(of_root, |_, value| tolerance * value, reach.0.sqrt(), reach.1.sqrt());
        Self { formula, per_length, unit, over_root: true, table }
    }

    /// Values that the table does not have.
    #[cold]
    fn complete(&self, interference: &[f64], out: &mut [f64]) {
        for (value, &delta) in out.iter_mut().zip(interference).filter(|(value, _)| value.is_nan()) {
            *value = (self.formula)(delta * self.per_length);
        }
    }
}

impl<F: Fn(f64) -> f64 + Clone + Send + Sync + 'static> Formula for Tabulated<F> {
    #[inline(always)]
    fn fill(&self, interference: &[f64], out: &mut [f64]) {
        let mut places = [0.0; BLOCK];
        let places = &mut places[..interference.len()];
        places.iter_mut().zip(interference).for_each(|(place, delta)| *place = delta * self.per_length);
        if self.over_root {
            places.iter_mut().for_each(|place| *place = place.sqrt());
        }
        self.table.values(places, out);
        if out.iter().fold(false, |any, value| any | value.is_nan()) {
            self.complete(interference, out);
        }
        if self.unit != 1.0 {
            out.iter_mut().for_each(|value| *value *= self.unit);
        }
    }
}

/// Where a closed form begins to vary like a root of δ.
#[derive(Clone, Copy, Debug)]
struct Root {
    /// δ from which it does, m.
    from: f64,
    /// δ of the root, m.
    place: f64,
    order: i32,
}

/// A law of one regime by a formula for the adhesion force F_s, N, the contact force P, N, and the contact
/// area, m².
///
/// # Examples
/// Hertz's contact under a constant pull, DMT's law:
///
/// ```
/// # use stiction::asperity::{LawError, LawParameters, Path};
/// use stiction::asperity::{ClosedForm, Constant, Law, Regime, Row, SolvedAsperity, Table};
/// use std::f64::consts::PI;
///
/// fn dmt(setting: &LawParameters) -> Result<Box<dyn Law>, LawError> {
///     // s_δ, s_a and s_F: F_s = 2πRΔγ = 2 s_F, P = s_F (δ/s_δ)^(3/2), area = π s_a² δ/s_δ.
///     let scale = setting.scale;
///     let adhesion = move |_: f64| 2.0 * scale.force;
///     let contact = move |delta: f64| scale.force * (delta / scale.length).powi(3).sqrt();
///     let area = move |delta: f64| PI * scale.radius * scale.radius * delta / scale.length;
///     Ok(Box::new(Table::new([
///         Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
///         Row::last(Regime::Elastic, ClosedForm::new(adhesion, contact, area).with_root(0.0, 2)),
///     ])))
/// }
///
/// let law = dmt(&LawParameters::scaled(0.05, Path::Approach)?)?;
/// assert_eq!(SolvedAsperity::new(law.as_ref(), 0.0).external_force(), -2.0);
/// # Ok::<(), LawError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClosedForm<F, P, A> {
    adhesion: F,
    contact: P,
    area: A,
    roots: Vec<Root>,
    unstable_work: f64,
}

impl<F: Formula> ClosedForm<F, Zero, Zero> {
    /// An attraction alone, smooth.
    pub fn attraction(adhesion: F) -> Self {
        Self::new(adhesion, Zero, Zero)
    }
}

impl<F: Formula, P: Formula, A: Formula> ClosedForm<F, P, A> {
    /// Formulas for F_s, P and the area, smooth.
    pub fn new(adhesion: F, contact: P, area: A) -> Self {
        Self { adhesion, contact, area, roots: Vec::new(), unstable_work: 0.0 }
    }

    /// The formulas with a root: from the interference `place`, m, on smooth in (δ − place)^(1/order) only.
    pub fn with_root(self, place: f64, order: i32) -> Self {
        self.with_root_from(place, place, order)
    }

    /// The formulas with a root at a `place`, m, that acts from a larger interference on, m.
    pub fn with_root_from(mut self, from: f64, place: f64, order: i32) -> Self {
        self.roots.push(Root { from, place, order });
        self
    }

    /// The formulas with ∫(P − F_s) dδ, J, along the unstable part.
    pub fn with_unstable_work(self, unstable_work: f64) -> Self {
        Self { unstable_work, ..self }
    }
}

impl<F: Formula, P: Formula, A: Formula> Law for ClosedForm<F, P, A> {
    fn radius_dependence(&self) -> RadiusDependence {
        let known = [self.adhesion.similarity(), self.contact.similarity(), self.area.similarity()];
        let is_known = known.iter().all(Option::is_some);
        if is_known { RadiusDependence::Formulas } else { RadiusDependence::Unknown }
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let similarity = self.adhesion.similarity().unwrap_or(Similarity::new(0.0, 0.0));
        let place = |own: f64| lane.map_or(own, |lane| similarity.interference(own, lane));
        let of = |root: &Root| Root { from: place(root.from), place: place(root.place), order: root.order };
        pieces(&self.roots.iter().map(of).collect::<Vec<Root>>(), within)
    }

    fn unstable_work(&self) -> f64 {
        self.unstable_work
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, _: &mut SolverStats) {
        let count = at.len();
        let Responses { adhesion, contact, area } = out;
        let (adhesion, contact, area) = (&mut adhesion[..count], &mut contact[..count], &mut area[..count]);
        match lanes {
            Lanes::Own => InstructionSet::current().run(
                #[inline(always)]
                || {
                    self.adhesion.fill(at, adhesion);
                    self.contact.fill(at, contact);
                    self.area.fill(at, area);
                },
            ),
            Lanes::Each(lanes) => {
                fill_lanes(&self.adhesion, lanes, at, adhesion);
                fill_lanes(&self.contact, lanes, at, contact);
                fill_lanes(&self.area, lanes, at, area);
            }
        }
    }
}

/// The pieces of an interval, m, within which roots begin to act.
fn pieces(roots: &[Root], within: Range<f64>) -> Vec<Piece> {
    let Range { start: lower, end: upper } = within;
    let mut ends: Vec<f64> = roots.iter().map(|root| root.from).collect();
    ends.retain(|end| lower < *end && *end < upper);
    ends.sort_by(f64::total_cmp);
    let of =
        |begin: f64| {
            let roots = roots.iter().filter(|root| root.from <= begin);
            roots.max_by(|a, b| a.from.total_cmp(&b.from)).map_or(Smoothness::Smooth, |root| {
                Smoothness::Root { end: End::Lower, place: root.place, order: root.order }
            })
        };
    let smoothness: Vec<Smoothness> = [lower].into_iter().chain(ends.iter().copied()).map(of).collect();
    Piece::cut(within, ends, smoothness)
}

/// Fills `out` with the values of a formula for asperities at interferences δ, m.
fn fill_lanes(formula: &impl Formula, lanes: Numbered<'_>, interference: &[f64], out: &mut [f64]) {
    let Some(Similarity { origin, place, value }) = formula.similarity() else { return };
    if place == 0.0 {
        InstructionSet::current().run(
            #[inline(always)]
            || formula.fill(interference, out),
        );
    } else {
        let mut own = [0.0; BLOCK];
        let own = &mut own[..interference.len()];
        own.iter_mut().zip(interference).for_each(|(own, delta)| *own = delta - origin);
        lanes.times_power(-place, own);
        InstructionSet::current().run(
            #[inline(always)]
            || {
                own.iter_mut().for_each(|delta| *delta += origin);
                formula.fill(own, out);
            },
        );
    }
    lanes.times_power(value, out);
}

/// A law of one regime with a constant adhesion force and no load: no force before contact in laws without
/// attraction across a gap, or the force of a lubricant. Nothing is evaluated where it acts.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    adhesion: f64,
}

impl Constant {
    /// No force.
    pub const NOTHING: Self = Self { adhesion: 0.0 };

    /// The lubricant's force while the solids do not touch, 2πRΔγ (Stanley et al. 1990; Shi and Polycarpou
    /// 2005, eq. 16).
    pub fn lubricant(parameters: &LawParameters) -> Self {
        Self { adhesion: 2.0 * parameters.scale.force }
    }
}

impl Law for Constant {
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Formulas
    }

    fn method(&self, _: usize) -> Method {
        Method::Constant(self.adhesion)
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, _: &mut SolverStats) {
        let count = at.len();
        out.adhesion[..count].fill(self.adhesion);
        out.contact[..count].fill(0.0);
        out.area[..count].fill(0.0);
        if let Lanes::Each(lanes) = lanes {
            lanes.times_power(1.0, &mut out.adhesion[..count]);
        }
    }
}
