//! A law as a table: rising regimes of interference, and the law of one regime in each.
//!
//! The laws in [`super::laws`] are such tables and share the laws of their rows: several laws have the same contact, and all
//! lubricated ones the same lubricant.

use super::block::Responses;
use super::lane::{Lane, Lanes};
use super::law::{Boundary, FitReport, Law, Method, Piece, RadiusDependence, Regime};
use super::outline::OutlinedSummit;
use super::radius::Place;
use super::stats::SolverStats;
use std::ops::Range;

/// A regime, the boundary at its upper end if it has one, and the law of one regime that acts in it.
pub struct Row {
    regime: Regime,
    /// Where it ends, and whether that place still belongs to it.
    end: Option<(Place, bool)>,
    law: Box<dyn Law>,
}

impl Row {
    /// A regime for interferences below `end`, m.
    pub fn below(regime: Regime, end: impl Into<Place>, law: impl Law + 'static) -> Self {
        Self { regime, end: Some((end.into(), false)), law: Box::new(law) }
    }

    /// A regime for interferences up to `end`, m, itself.
    pub fn up_to(regime: Regime, end: impl Into<Place>, law: impl Law + 'static) -> Self {
        Self { regime, end: Some((end.into(), true)), law: Box::new(law) }
    }

    /// A regime without end.
    pub fn last(regime: Regime, law: impl Law + 'static) -> Self {
        Self { regime, end: None, law: Box::new(law) }
    }
}

/// A law of several regimes, made of rows.
pub struct Table {
    regimes: Vec<Regime>,
    boundaries: Vec<Boundary>,
    /// The boundaries as functions of the radius.
    places: Vec<Place>,
    laws: Vec<Box<dyn Law>>,
    fit: Option<FitReport>,
}

impl Table {
    /// The law of rows from far to deep, each of another regime. Only the last may lack an end; if it has one, nothing acts beyond.
    pub fn new(rows: impl IntoIterator<Item = Row>) -> Self {
        let (regimes, boundaries, places) = (Vec::new(), Vec::new(), Vec::new());
        let mut table = Self { regimes, boundaries, places, laws: Vec::new(), fit: None };
        for row in rows {
            assert!(!table.regimes.contains(&row.regime), "{:?} has two rows", row.regime);
            assert_eq!(
                row.law.regimes().len(),
                1,
                "the law of the row {:?} has other than one regime",
                row.regime
            );
            table.regimes.push(row.regime);
            if let Some((place, belongs_below)) = row.end {
                table.boundaries.push(Boundary { interference: place.interference, belongs_below });
                table.places.push(place);
            }
            table.laws.push(row.law);
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

    fn radius_dependence(&self) -> RadiusDependence {
        self.laws
            .iter()
            .map(|law| law.radius_dependence())
            .fold(RadiusDependence::Formulas, RadiusDependence::and)
    }

    fn end(&self, regime: usize, lane: &Lane) -> Option<f64> {
        self.places.get(regime).map(|place| place.of(lane))
    }

    fn pieces_within(&self, regime: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let Some(law) = self.laws.get(regime) else { return Vec::new() };
        let end = |place: &Place| lane.map_or(place.interference, |lane| place.of(lane));
        let lower = self.places[..regime].iter().map(end).fold(within.start, f64::max);
        let upper = self.places.get(regime).map_or(f64::INFINITY, end).min(within.end);
        if !(lower < upper) {
            return Vec::new();
        }
        let mut pieces = law.pieces_within(0, lane, lower..upper);
        pieces.iter_mut().for_each(|piece| piece.regime = regime);
        pieces
    }

    fn kinks_of_summit(&self, regime: usize, lane: &Lane, summit: &OutlinedSummit) -> Vec<f64> {
        self.laws[regime].kinks_of_summit(0, lane, summit)
    }

    fn method(&self, regime: usize) -> Method {
        self.laws[regime].method(0)
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        self.laws.iter().find_map(|law| law.capture(lane))
    }

    fn unstable_work(&self) -> f64 {
        self.laws.iter().map(|law| law.unstable_work()).sum()
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
        let (law, far) = (&self.laws[regime], stats.far);
        law.evaluate(0, lanes, interference, out, stats);
        law.method(0).count(interference.len() as u64, stats.far - far, stats);
    }
}
