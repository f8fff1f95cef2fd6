//! A law as a table: regimes of interference, rising, and what acts in each.
//!
//! The laws in [`super::laws`] are such tables. Their rows share parts: the same contact solution serves
//! several laws, the same lubricant all that know one.

use super::block::Responses;
use super::lane::{Lane, Lanes};
use super::law::{Boundary, FitReport, Law, Method, Piece, Regime, Smoothness};
use super::outline::OutlinedTop;
use super::radius::Place;
use super::stats::SolverStats;
use std::ops::Range;

/// The interaction of an asperity in one regime: a [`ClosedForm`](super::ClosedForm), or a
/// [`Constant`](super::Constant) force.
///
/// The methods by which a law uses an interaction are not on this page, and may change.
///
/// # Examples
/// ```
/// use stiction::asperity::{ClosedForm, Constant, Interaction, Law, Regime, Row, Table};
///
/// fn beyond(end: f64, part: impl Interaction + 'static) -> Table {
///     let nothing = Row::below(Regime::Noncontact, end, Constant::NOTHING);
///     Table::new([nothing, Row::last(Regime::Lubricant, part)])
/// }
///
/// let law = beyond(-1.0, ClosedForm::attraction(|delta: f64| delta.exp()));
/// assert_eq!(law.regimes(), [Regime::Noncontact, Regime::Lubricant]);
/// ```
pub trait Interaction: Send + Sync {
    /// Whether it is known how the part follows the radius: only then a lane may be given to what takes one.
    #[doc(hidden)]
    fn follows_radius(&self) -> bool {
        true
    }

    /// λ of its own radius, if it solves elastic branches.
    #[doc(hidden)]
    fn lambda(&self) -> Option<f64> {
        None
    }

    /// Ends, m, inside an interval where the part of an asperity is not smooth, rising, and its smoothness on
    /// each of the intervals that they leave: one more than ends.
    #[doc(hidden)]
    fn smoothness(&self, _lane: Option<&Lane>, _within: Range<f64>) -> (Vec<f64>, Vec<Smoothness>) {
        (Vec::new(), vec![Smoothness::Smooth])
    }

    /// Interferences, m, at which a top of its own outline is not smooth within the part, or jumps there, as many of every
    /// top, and not finite where it has one not.
    #[doc(hidden)]
    fn kinks_of_top(&self, _lane: &Lane, _top: &OutlinedTop) -> Vec<f64> {
        Vec::new()
    }

    /// The method by which it is evaluated.
    #[doc(hidden)]
    fn method(&self) -> Method;

    /// Interference, m, from which an asperity that turns back takes another way, if there is one within the
    /// part.
    #[doc(hidden)]
    fn capture(&self, _lane: Option<&Lane>) -> Option<f64> {
        None
    }

    /// ∫(P − F_s) dδ, J, along what is unstable of its force curve, from where an asperity would come to it on
    /// approach to where it leaves it on retraction.
    #[doc(hidden)]
    fn unstable_work(&self) -> f64 {
        0.0
    }

    /// Fills the first `interference.len()` responses for asperities at interferences δ, m.
    #[doc(hidden)]
    fn evaluate(&self, lanes: Lanes<'_>, interference: &[f64], out: &mut Responses, stats: &mut SolverStats);
}

/// A regime, the boundary at its upper end if it has one, and what acts in it.
pub struct Row {
    regime: Regime,
    /// Where it ends, and whether that place still belongs to it.
    end: Option<(Place, bool)>,
    part: Box<dyn Interaction>,
}

impl Row {
    /// A regime for interferences below `end`, m.
    pub fn below(regime: Regime, end: impl Into<Place>, part: impl Interaction + 'static) -> Self {
        Self { regime, end: Some((end.into(), false)), part: Box::new(part) }
    }

    /// A regime for interferences up to `end`, m, itself.
    pub fn up_to(regime: Regime, end: impl Into<Place>, part: impl Interaction + 'static) -> Self {
        Self { regime, end: Some((end.into(), true)), part: Box::new(part) }
    }

    /// A regime without end.
    pub fn last(regime: Regime, part: impl Interaction + 'static) -> Self {
        Self { regime, end: None, part: Box::new(part) }
    }
}

/// A law made of rows.
pub struct Table {
    regimes: Vec<Regime>,
    boundaries: Vec<Boundary>,
    /// Boundaries as they follow the radius.
    places: Vec<Place>,
    parts: Vec<Box<dyn Interaction>>,
    fit: Option<FitReport>,
}

impl Table {
    /// The law of rows from far to deep, each of another regime. Only the last may lack an end; if it has one, nothing acts beyond.
    pub fn new(rows: impl IntoIterator<Item = Row>) -> Self {
        let (regimes, boundaries, places) = (Vec::new(), Vec::new(), Vec::new());
        let mut table = Self { regimes, boundaries, places, parts: Vec::new(), fit: None };
        for row in rows {
            assert!(!table.regimes.contains(&row.regime), "{:?} has two rows", row.regime);
            table.regimes.push(row.regime);
            if let Some((place, belongs_below)) = row.end {
                table.boundaries.push(Boundary { interference: place.interference, belongs_below });
                table.places.push(place);
            }
            table.parts.push(row.part);
        }
        table
    }

    /// The law with a report of its curve fits.
    #[doc(hidden)]
    pub fn with_fit(mut self, report: FitReport) -> Self {
        self.fit = Some(report);
        self
    }
}

impl Law for Table {
    fn regimes(&self) -> &[Regime] {
        &self.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn follows_radius(&self) -> bool {
        self.parts.iter().all(|part| part.follows_radius())
    }

    fn lambda(&self) -> Option<f64> {
        self.parts.iter().find_map(|part| part.lambda())
    }

    fn end(&self, regime: usize, lane: &Lane) -> Option<f64> {
        self.places.get(regime).map(|place| place.of(lane))
    }

    fn pieces_of(&self, regime: usize, lane: Option<&Lane>) -> Vec<Piece> {
        let Some(part) = self.parts.get(regime) else { return Vec::new() };
        let end = |place: &Place| lane.map_or(place.interference, |lane| place.of(lane));
        let mut lower = self.places[..regime].iter().map(end).fold(f64::NEG_INFINITY, f64::max);
        let upper = self.places.get(regime).map_or(f64::INFINITY, end);
        if !(lower < upper) {
            return Vec::new();
        }
        let (mut ends, smoothness) = part.smoothness(lane, lower..upper);
        ends.push(upper);
        let piece = |(end, smoothness)| {
            let lower = std::mem::replace(&mut lower, end);
            Piece { regime, lower, upper: end, smoothness }
        };
        ends.into_iter().zip(smoothness).map(piece).collect()
    }

    fn kinks_of_top(&self, regime: usize, lane: &Lane, top: &OutlinedTop) -> Vec<f64> {
        self.parts[regime].kinks_of_top(lane, top)
    }

    fn method(&self, regime: usize) -> Method {
        self.parts[regime].method()
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        self.parts.iter().find_map(|part| part.capture(lane))
    }

    fn unstable_work(&self) -> f64 {
        self.parts.iter().map(|part| part.unstable_work()).sum()
    }

    fn fit(&self) -> Option<&FitReport> {
        self.fit.as_ref()
    }

    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let (part, far) = (&self.parts[regime], stats.far);
        part.evaluate(lanes, interference, out, stats);
        part.method().count(interference.len() as u64, stats.far - far, stats);
    }
}
