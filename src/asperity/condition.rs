//! The conditions of the asperities of a loop on unloading.

use super::law::{Boundary, Regime};
use super::response_table::ResponseTable;

/// The contact history of an asperity, and the regime of the law that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Condition {
    /// An asperity that has never touched.
    Untouched(usize),
    /// An elastic asperity that has touched.
    Elastic(usize),
    /// An asperity that has yielded and has detached.
    Detached(usize),
    /// An asperity that has yielded and is in contact; the regime is that at ω_max.
    Unloading(usize),
}

impl Condition {
    pub fn regime(self) -> usize {
        let (Self::Untouched(regime)
        | Self::Elastic(regime)
        | Self::Detached(regime)
        | Self::Unloading(regime)) = self;
        regime
    }
}

/// The law of unloading at one distance from the closest approach.
#[derive(Default)]
pub(super) struct AtDistance {
    /// The distance, m.
    pub distance: f64,
    /// The conditions of asperities in the order of ω_max, the regime of each, its index in the law on approach, and the ends, ω_max in m.
    pub conditions: Vec<Condition>,
    pub regimes: Vec<Regime>,
    pub base: Vec<usize>,
    pub boundaries: Vec<Boundary>,
    /// The responses of summits, by condition, of a law that is tabulated.
    pub tables: Vec<ResponseTable>,
}

impl AtDistance {
    /// Adds a condition in a regime of the law, and its end.
    pub fn push(&mut self, condition: Condition, regimes: &[Regime], end: Option<Boundary>) {
        self.conditions.push(condition);
        self.base.push(condition.regime());
        self.regimes.push(regimes[condition.regime()]);
        self.boundaries.extend(end);
    }
}
