//! The contract between an asperity law and everything that sums it.

use super::block::{BLOCK, Responses};
use super::lane::{Lane, Lanes};
use super::outline::OutlinedSummit;
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;

/// A regime of an asperity, by its interference δ (Shi and Polycarpou 2005, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Before contact, the attraction of the surfaces across the gap.
    Noncontact,
    /// The lubricant touches, the solids do not.
    Lubricant,
    /// A bridge of condensed liquid spans the gap, the solids do not touch.
    Bridge,
    /// Elastic contact.
    Elastic,
    /// Elastic-plastic contact: by Kogut and Etsion's fits ω_c to 6ω_c.
    Elastoplastic1,
    /// Elastic-plastic contact, the second of two regimes: 6ω_c to 110ω_c.
    Elastoplastic2,
    /// Fully plastic contact.
    Plastic,
}

impl Regime {
    /// All of them, from far to deep.
    pub const ALL: [Self; 7] = [
        Self::Noncontact,
        Self::Lubricant,
        Self::Bridge,
        Self::Elastic,
        Self::Elastoplastic1,
        Self::Elastoplastic2,
        Self::Plastic,
    ];

    /// Whether the solids touch.
    pub fn is_contact(self) -> bool {
        !matches!(self, Self::Noncontact | Self::Lubricant | Self::Bridge)
    }

    /// Whether the contact is elastic-plastic or plastic.
    pub fn is_plastic(self) -> bool {
        matches!(self, Self::Elastoplastic1 | Self::Elastoplastic2 | Self::Plastic)
    }

    /// The regime of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|regime| regime.name() == name)
    }

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Noncontact => "noncontact",
            Self::Lubricant => "lubricant",
            Self::Bridge => "bridge",
            Self::Elastic => "elastic",
            Self::Elastoplastic1 => "elastoplastic1",
            Self::Elastoplastic2 => "elastoplastic2",
            Self::Plastic => "plastic",
        }
    }
}

/// An interference at which one regime ends and the next begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// δ, m.
    pub interference: f64,
    /// Whether δ itself still belongs to the regime below.
    pub belongs_below: bool,
}

impl Boundary {
    /// Whether an interference lies in a regime below this boundary.
    #[inline(always)]
    pub fn is_above(&self, interference: f64) -> bool {
        interference < self.interference || (self.belongs_below && interference == self.interference)
    }
}

/// An end of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Towards less interference.
    Lower,
    /// Towards more.
    Upper,
}

/// The smoothness of a law at the ends of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothness {
    /// Smooth up to both ends.
    Smooth,
    /// Smooth in |δ − place|^(1/order). The law says on which end of the piece the root sits, because
    /// comparing places would leave that to rounding.
    Root {
        /// The end of the piece at which, or beyond which, the root is.
        end: End,
        /// δ of the root, m; within the piece by a rounding at most.
        place: f64,
        /// 2 next to a fold or where a contact begins as Hertz's does.
        order: i32,
    },
}

/// An interval of interference on which the law is one smooth function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Index of its regime.
    pub regime: usize,
    /// Lower end δ, m; −∞ for the first.
    pub lower: f64,
    /// Upper end δ, m; may be +∞.
    pub upper: f64,
    /// Smoothness of the law on it.
    pub smoothness: Smoothness,
}

impl Piece {
    /// The pieces of an interval, m, of a law of one regime: the rising `ends` divide it, m, and each piece has its smoothness.
    pub(super) fn cut(
        within: Range<f64>,
        ends: impl IntoIterator<Item = f64>,
        smoothness: impl IntoIterator<Item = Smoothness>,
    ) -> Vec<Self> {
        let mut lower = within.start;
        let piece = |(upper, smoothness)| Self {
            regime: 0,
            lower: std::mem::replace(&mut lower, upper),
            upper,
            smoothness,
        };
        ends.into_iter().chain([within.end]).zip(smoothness).map(piece).collect()
    }

    /// δ of an end, m, and the direction from there into the piece, 1 or −1.
    pub fn inwards(&self, end: End) -> (f64, f64) {
        match end {
            End::Lower => (self.lower, 1.0),
            End::Upper => (self.upper, -1.0),
        }
    }
}

/// BranchCurve fits of the three elastic forces f_snc, f_sel and f_f against the direct solution, on the ranges of
/// the fits.
#[derive(Clone, Debug, PartialEq)]
pub struct FitReport {
    /// The 13 coefficients in the order of the published Table 3, approach in nm, forces in µN.
    pub coefficients: [f64; 13],
    /// Interferences from and to, m.
    pub range: [[f64; 2]; 3],
    /// Largest |force| of the direct solution, N.
    pub largest_force: [f64; 3],
    /// Largest |fit − direct|, N.
    pub largest_residual: [f64; 3],
    /// Root mean square of fit − direct, N.
    pub rms_residual: [f64; 3],
}

/// The method by which the forces of a regime follow from the interference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// A constant adhesion force, N, is all that acts: nothing is evaluated.
    Constant(f64),
    /// Formulas.
    ClosedForm,
    /// Solves of the equations of a contact.
    Contact,
    /// Solves of the equations before contact.
    Noncontact {
        /// Interference, m, below which a series takes the place of solves, if there is one.
        far: Option<f64>,
    },
}

impl Method {
    /// Counts evaluations, of which some were not solved because they are far from contact.
    pub(super) fn count(self, evaluations: u64, far: u64, stats: &mut SolverStats) {
        match self {
            Self::Constant(_) => stats.constant += evaluations,
            Self::ClosedForm => stats.closed_form += evaluations,
            Self::Contact => stats.contact_solves += evaluations,
            Self::Noncontact { .. } => stats.noncontact_solves += evaluations - far,
        }
    }
}

/// The dependence of a law on the radius of the asperity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RadiusDependence {
    /// Unknown: the law may not be evaluated for lanes.
    Unknown,
    /// Formulas of the radius.
    Formulas,
    /// Elastic branches that are solved for each radius, with λ of the law's own radius, and formulas.
    Elastic(f64),
}

impl RadiusDependence {
    /// λ of the law's own radius, if the law solves elastic branches.
    pub fn lambda(self) -> Option<f64> {
        match self {
            Self::Elastic(lambda) => Some(lambda),
            Self::Unknown | Self::Formulas => None,
        }
    }

    /// The dependence of two laws together.
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unknown, _) | (_, Self::Unknown) => Self::Unknown,
            (Self::Formulas, other) => other,
            (elastic, _) => elastic,
        }
    }
}

/// A law of one asperity as the sums see it: contiguous regimes of interference, and forces evaluated block
/// by block, so that choosing the law costs one call per block and nothing in the inner loop.
///
/// A law of one regime is a [`ClosedForm`](super::ClosedForm) or a [`Constant`](super::Constant) force; a
/// [`Table`](super::Table) makes a law of such laws, each on its interval of interference. What else a law
/// provides to the sums is not on this page, and may change.
///
/// # Examples
/// ```
/// use stiction::asperity::{ClosedForm, Constant, Law, Regime, Row, Table};
///
/// fn beyond(end: f64, law: impl Law + 'static) -> Table {
///     let nothing = Row::below(Regime::Noncontact, end, Constant::NOTHING);
///     Table::new([nothing, Row::last(Regime::Lubricant, law)])
/// }
///
/// let law = beyond(-1.0, ClosedForm::attraction(|delta: f64| delta.exp()));
/// assert_eq!(law.regimes(), [Regime::Noncontact, Regime::Lubricant]);
/// ```
pub trait Law: Send + Sync {
    /// The regimes from far to deep. That of a law of one regime has no meaning in a row of a table, which has
    /// its own.
    fn regimes(&self) -> &[Regime] {
        &[Regime::Elastic]
    }

    /// The boundaries between the regimes, rising; one more than between them when the law ends above the
    /// last regime. Asperities beyond the end bear no force and are counted nowhere.
    #[doc(hidden)]
    fn boundaries(&self) -> &[Boundary] {
        &[]
    }

    /// The dependence on the radius.
    #[doc(hidden)]
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Unknown
    }

    /// The first regime of contact; the number of regimes if there is none.
    #[doc(hidden)]
    fn first_contact(&self) -> usize {
        let regimes = self.regimes();
        regimes.iter().position(|regime| regime.is_contact()).unwrap_or(regimes.len())
    }

    /// Interference, m, at which a regime begins.
    #[doc(hidden)]
    fn begin(&self, regime: usize) -> f64 {
        if regime == 0 { f64::NEG_INFINITY } else { self.boundaries()[regime - 1].interference }
    }

    /// The end of a regime of an asperity, m, if it has one.
    #[doc(hidden)]
    fn end(&self, regime: usize, _lane: &Lane) -> Option<f64> {
        self.boundaries().get(regime).map(|end| end.interference)
    }

    /// The ends of all regimes of an asperity, m, rising.
    #[doc(hidden)]
    fn ends(&self, lane: &Lane, out: &mut Vec<f64>) {
        out.clear();
        out.extend((0..self.boundaries().len()).filter_map(|regime| self.end(regime, lane)));
    }

    /// The smooth pieces, rising, of a regime within an interval, m, divided at every kink and jump: of an asperity of the law's own
    /// radius, or of a lane.
    #[doc(hidden)]
    fn pieces_within(&self, regime: usize, _lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let Range { start: lower, end: upper } = within;
        vec![Piece { regime, lower, upper, smoothness: Smoothness::Smooth }]
    }

    /// The smooth pieces, rising, that cover a regime.
    #[doc(hidden)]
    fn pieces_of(&self, regime: usize, lane: Option<&Lane>) -> Vec<Piece> {
        self.pieces_within(regime, lane, f64::NEG_INFINITY..f64::INFINITY)
    }

    /// The smooth pieces, rising, of all regimes.
    #[doc(hidden)]
    fn pieces(&self, lane: Option<&Lane>) -> Vec<Piece> {
        (0..self.regimes().len()).flat_map(|regime| self.pieces_of(regime, lane)).collect()
    }

    /// Interferences, m, of the kinks and jumps of the force of a flattened summit within a regime, with the lane of its apex. Every
    /// summit has the same number of them in the same order; a kink that it does not have is not finite.
    #[doc(hidden)]
    fn kinks_of_summit(&self, _regime: usize, _lane: &Lane, _summit: &OutlinedSummit) -> Vec<f64> {
        Vec::new()
    }

    /// The method by which the forces of a regime are evaluated.
    #[doc(hidden)]
    fn method(&self, _regime: usize) -> Method {
        Method::ClosedForm
    }

    /// Interference, m, from which retraction follows another branch than approach, if that is before contact begins.
    #[doc(hidden)]
    fn capture(&self, _lane: Option<&Lane>) -> Option<f64> {
        None
    }

    /// ∫(P − F_s) dδ, J, along the unstable part of its force curve, from the interference at which contact
    /// begins on approach to that at which it ends on retraction; 0 of a law that has none.
    #[doc(hidden)]
    fn unstable_work(&self) -> f64 {
        0.0
    }

    /// The report on its curve fits, when it has any.
    #[doc(hidden)]
    fn fit(&self) -> Option<&FitReport> {
        None
    }

    /// Fills the first `interference.len()` ≤ [`BLOCK`] responses for asperities at interferences δ, m, that all lie
    /// in one regime.
    #[doc(hidden)]
    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    );
}

/// Scratch space of [`Facing::for_each_block`].
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Scratch {
    interference: [f64; BLOCK],
    responses: Responses,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { interference: [0.0; BLOCK], responses: Responses::default() }
    }
}

/// Asperities of a law that face a plane.
#[derive(Clone, Copy)]
pub struct Facing<'a> {
    /// Their law.
    pub law: &'a dyn Law,
    /// Their heights, m, rising.
    pub heights: &'a [f64],
    /// The separation of the plane, m.
    pub separation: f64,
}

impl<'a> Facing<'a> {
    /// The ranges of heights in each regime, with the index of that, rising.
    pub fn regime_ranges(self) -> impl Iterator<Item = (usize, Range<usize>)> + use<'a> {
        let Self { law, heights, separation } = self;
        let mut start = 0;
        (0..law.regimes().len()).map(move |regime| {
            let end = match law.boundaries().get(regime) {
                Some(boundary) => {
                    start + heights[start..].partition_point(|&u| boundary.is_above(u - separation))
                }
                None => heights.len(),
            };
            (regime, std::mem::replace(&mut start, end)..end)
        })
    }

    /// Evaluates the law for a range of heights in one regime. `visit` gets the range of each block and its
    /// responses.
    pub fn for_each_block_of(
        self,
        (regime, range): (usize, Range<usize>),
        scratch: &mut Scratch,
        stats: &mut SolverStats,
        mut visit: impl FnMut(Range<usize>, &Responses),
    ) {
        for block in range.clone().step_by(BLOCK) {
            let block = block..range.end.min(block + BLOCK);
            let interference = &mut scratch.interference[..block.len()];
            InstructionSet::current().run(
                #[inline(always)]
                || {
                    for (delta, &height) in interference.iter_mut().zip(&self.heights[block.clone()]) {
                        *delta = height - self.separation;
                    }
                },
            );
            self.law.evaluate(regime, Lanes::Own, interference, &mut scratch.responses, stats);
            visit(block, &scratch.responses);
        }
    }

    /// Evaluates the law for all heights. `visit` gets the regime's index, the range of heights and their
    /// responses, block by block; the ranges of a regime are contiguous and rise.
    pub fn for_each_block(
        self,
        scratch: &mut Scratch,
        stats: &mut SolverStats,
        mut visit: impl FnMut(usize, Range<usize>, &Responses),
    ) {
        for (regime, range) in self.regime_ranges() {
            let visit = |range, responses: &Responses| visit(regime, range, responses);
            self.for_each_block_of((regime, range), scratch, stats, visit);
        }
    }
}
