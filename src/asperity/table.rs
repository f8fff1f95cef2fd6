//! A law as a table: regimes of interference, rising, and what acts in each.
//!
//! The laws in [`super::laws`] are such tables. Their rows share parts: the same contact solution serves
//! several laws, the same lubricant all that know one.

use super::law::{Boundary, FitReport, Law, Method, Piece, Regime, Responses, Smoothness};
use super::radius::{Lane, Lanes, OfRadii, Place};
use super::stats::SolverStats;

/// The interaction of an asperity in one regime: a [`ClosedForm`](super::ClosedForm), or a
/// [`Constant`](super::Constant) force.
///
/// What an interaction tells a law is not on this page, and may change.
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
    /// Ends, m, inside `lower..upper` where the part is not smooth, rising, and how it varies on each of the
    /// intervals that they leave: one more than ends.
    #[doc(hidden)]
    fn smoothness(&self, _lower: f64, _upper: f64) -> (Vec<f64>, Vec<Smoothness>) {
        (Vec::new(), vec![Smoothness::Smooth])
    }

    /// How it is evaluated.
    #[doc(hidden)]
    fn method(&self) -> Method;

    /// Interference, m, from which an asperity that turns back takes another way, if there is one within the
    /// part.
    #[doc(hidden)]
    fn capture(&self) -> Option<f64> {
        None
    }

    /// ∫(P − F_s) dδ, J, along what is unstable of its force curve, from where an asperity would come to it on
    /// approach to where it leaves it on retraction.
    #[doc(hidden)]
    fn unstable_work(&self) -> f64 {
        0.0
    }

    /// The same part of asperities of other radii, if it is known how it follows them.
    #[doc(hidden)]
    fn of_radii(&self) -> Option<&dyn PartOfRadii> {
        None
    }

    /// Fills the first `interference.len()` responses for interferences δ, m.
    #[doc(hidden)]
    fn evaluate(&self, interference: &[f64], out: &mut Responses, stats: &mut SolverStats);
}

/// An interaction as that of asperities of other radii.
#[doc(hidden)]
pub trait PartOfRadii {
    /// λ at ρ = 1, if elastic branches are solved.
    fn lambda(&self) -> Option<f64> {
        None
    }

    /// As [`Interaction::capture`], of an asperity.
    fn capture_of(&self, _lane: &Lane) -> Option<f64> {
        None
    }

    /// As [`Interaction::smoothness`], of an asperity.
    fn smoothness_of(&self, lane: &Lane, lower: f64, upper: f64) -> (Vec<f64>, Vec<Smoothness>);

    /// Fills the first responses for asperities at interferences δ, m.
    fn evaluate_lanes(
        &self,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    );
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
    /// The same as they follow the radius.
    places: Vec<Place>,
    parts: Vec<Box<dyn Interaction>>,
    fit: Option<FitReport>,
}

impl Table {
    /// The law of rows from far to deep. Only the last may lack an end; if it has one, nothing acts beyond.
    pub fn new(rows: impl IntoIterator<Item = Row>) -> Self {
        let (regimes, boundaries, places) = (Vec::new(), Vec::new(), Vec::new());
        let mut table = Self { regimes, boundaries, places, parts: Vec::new(), fit: None };
        for row in rows {
            table.regimes.push(row.regime);
            if let Some((place, belongs_below)) = row.end {
                table.boundaries.push(Boundary { interference: place.interference, belongs_below });
                table.places.push(place);
            }
            table.parts.push(row.part);
        }
        table
    }

    /// The same law with a report of its curve fits.
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

    fn pieces(&self) -> Vec<Piece> {
        let ends: Vec<f64> = self.boundaries.iter().map(|boundary| boundary.interference).collect();
        pieces(&self.parts, &ends, |part, lower, upper| part.smoothness(lower, upper))
    }

    fn of_radii(&self) -> Option<&dyn OfRadii> {
        self.parts.iter().all(|part| part.of_radii().is_some()).then_some(self)
    }

    fn method(&self, regime: usize) -> Method {
        self.parts[regime].method()
    }

    fn capture(&self) -> Option<f64> {
        self.parts.iter().find_map(|part| part.capture())
    }

    fn unstable_work(&self) -> f64 {
        self.parts.iter().map(|part| part.unstable_work()).sum()
    }

    fn fit(&self) -> Option<&FitReport> {
        self.fit.as_ref()
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let (part, far) = (&self.parts[regime], stats.far);
        part.evaluate(interference, out, stats);
        part.method().count(interference.len() as u64, stats.far - far, stats);
    }
}

/// The pieces of parts that end at interferences, m: of each part those that it says.
fn pieces(
    parts: &[Box<dyn Interaction>],
    ends: &[f64],
    smoothness: impl Fn(&dyn Interaction, f64, f64) -> (Vec<f64>, Vec<Smoothness>),
) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut lower = f64::NEG_INFINITY;
    for (regime, part) in parts.iter().enumerate() {
        let upper = ends.get(regime).copied().unwrap_or(f64::INFINITY);
        if lower < upper {
            let (mut ends, smoothness) = smoothness(part.as_ref(), lower, upper);
            ends.push(upper);
            for (end, smoothness) in ends.into_iter().zip(smoothness) {
                pieces.push(Piece { regime, lower, upper: end, smoothness });
                lower = end;
            }
        }
    }
    pieces
}

impl Table {
    fn part_of_radii(part: &dyn Interaction) -> &dyn PartOfRadii {
        part.of_radii().expect("all parts of a law that follows the radius do")
    }
}

impl OfRadii for Table {
    fn lambda(&self) -> Option<f64> {
        self.parts.iter().find_map(|part| Self::part_of_radii(part.as_ref()).lambda())
    }

    fn ends(&self, lane: &Lane, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.places.iter().map(|place| place.of(lane)));
    }

    fn end(&self, regime: usize, lane: &Lane) -> Option<f64> {
        self.places.get(regime).map(|place| place.of(lane))
    }

    fn pieces_of(&self, lane: &Lane) -> Vec<Piece> {
        let ends: Vec<f64> = self.places.iter().map(|place| place.of(lane)).collect();
        pieces(&self.parts, &ends, |part, lower, upper| {
            Self::part_of_radii(part).smoothness_of(lane, lower, upper)
        })
    }

    fn capture_of(&self, lane: &Lane) -> Option<f64> {
        self.parts.iter().find_map(|part| Self::part_of_radii(part.as_ref()).capture_of(lane))
    }

    fn evaluate_lanes(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let (part, far) = (&self.parts[regime], stats.far);
        Self::part_of_radii(part.as_ref()).evaluate_lanes(lanes, interference, out, stats);
        part.method().count(interference.len() as u64, stats.far - far, stats);
    }
}
