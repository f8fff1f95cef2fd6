//! The matrix that moments of heights are multiplied with: polynomials of a law by offset.

use super::geometry::Geometry;
use super::lanes::{LANES, Lanes, TERMS};
use super::nodes::Nodes;
use super::offsets::{Cell, Offset, Polynomials};
use crate::asperity::{Law, Quantity};
use crate::engine::curves::Curves;
use crate::surface::Surface;
use thiserror::Error;

/// Separations have one step when they are off it by at most this share.
const UNEVEN: f64 = 1e-9;
/// Heights are binned up to this many σ_s, of laws with heavier tails than the normal one up to the second; a
/// surface with a higher asperity is summed directly.
const HEIGHT_REACH: [f64; 2] = [10.0, 16.0];
/// Most periods and separations: with more there are few asperities in each, and their moments take more
/// memory than direct sums and no less time.
pub const MOST_PERIODS: f64 = 4e3;

/// Reasons why sums are not taken by moments.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Unfit {
    /// The separations have no common step.
    #[error("the separations are not evenly spaced")]
    Uneven,
    /// Periods would hold too few asperities, or too many of them are solved one by one.
    #[error("{asperities:.0} of {all} asperities per separation would be solved one by one all the same")]
    NotWorthIt {
        /// Asperities per separation that are solved, on average.
        asperities: f64,
        /// All asperities.
        all: usize,
    },
    /// The periods are too many for any gain.
    #[error("a step of the separations is only {0:.1e} of the height deviation")]
    TooFine(f64),
    /// Asperities of several radii have no law in common.
    #[error("asperities differ in their radii, so no law is that of all")]
    Polydisperse,
    /// Surfaces are pulled back.
    #[error("on the retraction of a loop the law is another at every separation")]
    Loop,
    /// Measured against direct sums.
    #[error("the tolerance is not met, the achieved error is {0:.1e}")]
    NotMet(f64),
}

/// The Toeplitz matrix of a law for the separations of a scene, and the bins of heights for it.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, model};
/// use stiction::engine::{Job, MomentMatrix, Unfit};
/// use stiction::surface::Surface;
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 10_000, 1.0);
/// let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let direct = Job::new(law.as_ref(), &surface, &separations, 8, 1);
/// let matrix = MomentMatrix::new(law.as_ref(), &surface, &separations, 1e-9).expect("it is worth it");
/// let compressed = Job { moments: Some(&matrix), ..direct };
/// let [truth, sum] = [direct, compressed].map(|job| job.ensemble().curves[0].mean()[0]);
/// assert!((sum / truth - 1.0).abs() < 1e-9);
/// let uneven = MomentMatrix::new(law.as_ref(), &surface, &[0.0, 1.0, 3.0], 1e-9);
/// assert!(matches!(uneven, Err(Unfit::Uneven)));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Debug)]
pub struct MomentMatrix {
    pub(super) geometry: Geometry,
    /// By offset, from the first of the geometry's.
    pub(super) offsets: Vec<Offset>,
    /// By regime, the offsets and segments that are solved asperity by asperity.
    pub(super) solved: Vec<Vec<(usize, usize)>>,
    /// Terms of the largest polynomial of a whole offset.
    pub(super) terms: usize,
    /// Nodes of periods for what lies between separations.
    pub(super) nodes: Nodes,
    /// Regime boundaries as offset and segment at which the next regime begins.
    boundaries: Vec<(i64, usize)>,
    /// Separations d_k, m.
    pub(super) separations: Vec<f64>,
    /// The tolerance that was asked for.
    pub tolerance: f64,
}

impl MomentMatrix {
    /// The matrix for separations h (m, rising, evenly spaced), accurate to `tolerance`.
    ///
    /// # Errors
    /// [`Unfit`] where direct sums are the better or the only way.
    pub fn new(law: &dyn Law, surface: &Surface, separations: &[f64], tolerance: f64) -> Result<Self, Unfit> {
        if surface.is_polydisperse() {
            return Err(Unfit::Polydisperse);
        }
        let separations: Vec<f64> = separations.iter().map(|&h| surface.asperity_separation(h)).collect();
        let step = (separations[separations.len() - 1] - separations[0]) / (separations.len() - 1) as f64;
        let even = |(k, d): (usize, &f64)| (d - separations[0] - k as f64 * step).abs() <= UNEVEN * step;
        if !separations.iter().enumerate().all(even) {
            return Err(Unfit::Uneven);
        }
        if periods(surface, step) + separations.len() as f64 > MOST_PERIODS {
            return Err(Unfit::TooFine(step / surface.heights.std));
        }
        let pieces = law.pieces(None);
        let geometry = Geometry::new(&pieces, separations[0], step, separations.len(), reach(surface));
        let offsets: Vec<Offset> =
            geometry.offsets().map(|j| Offset::new(law, &pieces, &geometry, j, tolerance)).collect();
        let terms = offsets.iter().filter_map(Offset::terms).max().unwrap_or(1);
        let mut solved = vec![Vec::new(); law.regimes().len()];
        for (j, offset) in offsets.iter().enumerate() {
            for (segment, regime) in offset.solved() {
                solved[regime].push((j, segment));
            }
        }
        let boundaries = law.boundaries().iter().map(|b| geometry.boundary(b.interference)).collect();
        let matrix = Self {
            terms,
            nodes: Nodes::new(terms),
            geometry,
            offsets,
            solved,
            boundaries,
            separations,
            tolerance,
        };
        let asperities = matrix.solved_per_separation(surface);
        if asperities > 0.5 * surface.asperity_count as f64 {
            return Err(Unfit::NotWorthIt { asperities, all: surface.asperity_count });
        }
        Ok(matrix)
    }

    /// Expected asperities per separation that are solved one by one.
    pub fn solved_per_separation(&self, surface: &Surface) -> f64 {
        let first = self.geometry.offsets().start;
        let mut probability = 0.0;
        for &(j, segment) in self.solved.iter().flatten() {
            let [low, high] = self.geometry.interference(first + j as i64, segment);
            let shares = self.separations.iter().map(|d| surface.heights.probability(low + d, high + d));
            probability += shares.sum::<f64>();
        }
        surface.asperity_count as f64 * probability / self.separations.len() as f64
    }

    /// Adds what the moments of a period give at the separation `k`.
    #[inline(always)]
    pub(super) fn add(
        &self,
        period: usize,
        k: usize,
        bins: &[[Lanes; TERMS]],
        periods: &[[Lanes; TERMS]],
        sums: &mut [[Lanes; 3]],
    ) {
        match &self.offsets[self.offset(period, k)] {
            Offset::Whole(polynomials) => multiply(polynomials, &periods[period], sums),
            Offset::Split(cells) => {
                for (cell, moments) in cells.iter().zip(&bins[period * cells.len()..]) {
                    if let Cell::Smooth(polynomials) = cell {
                        multiply(polynomials, moments, sums);
                    }
                }
            }
        }
    }

    /// The offset of a period at the separation `k`.
    #[inline(always)]
    fn offset(&self, period: usize, k: usize) -> usize {
        period + self.separations.len() - 1 - k
    }

    /// The period that has an offset at the separation `k`.
    pub(super) fn period(&self, offset: usize, k: usize) -> Option<usize> {
        (offset + k + 1).checked_sub(self.separations.len())
    }

    /// Takes over sums by regime of one lane, and the exact counts by where each bin begins among the
    /// heights, as point `k` of the curves.
    pub(super) fn record(
        &self,
        k: usize,
        starts: impl Fn(usize) -> f64,
        l: usize,
        sums: &[[Lanes; 3]],
        curves: &mut Curves,
    ) {
        let separations = self.separations.len();
        let segments = self.geometry.segments() as i64;
        let bins = self.geometry.period_count() * self.geometry.segments();
        let mut begin = 0.0;
        let mut total = [0.0; 3];
        for (regime, [adhesion, contact, area]) in sums.iter().enumerate() {
            let [adhesion, contact, area] = [adhesion[l], contact[l], area[l]];
            let end = match self.boundaries.get(regime) {
                Some(&(offset, segment)) => {
                    let period = offset + k as i64 - self.geometry.periods.start;
                    let bin = (period * segments + segment as i64).clamp(0, bins as i64);
                    starts(bin as usize)
                }
                None => starts(bins),
            };
            let place = regime * separations + k;
            curves.regime_count[place] = end - begin;
            curves.regime_adhesion_force[place] = adhesion;
            curves.regime_external_force[place] = contact - adhesion;
            begin = end;
            for (total, sum) in total.iter_mut().zip([adhesion, contact, area]) {
                *total += sum;
            }
        }
        for (curve, value) in curves.total.iter_mut().zip(Quantity::of_response(total[0], total[1], total[2]))
        {
            curve[k] = value;
        }
    }
}

/// The farthest that heights are binned from their mean plane, m.
fn reach(surface: &Surface) -> f64 {
    let heavy = !surface.heights.law.has_normal_tails();
    HEIGHT_REACH[usize::from(heavy)] * surface.heights.std
}

/// The number of periods of a step, m.
pub fn periods(surface: &Surface, step: f64) -> f64 {
    2.0 * reach(surface) / step
}

/// Adds what polynomials make of moments to the sums of their regime.
#[inline(always)]
fn multiply(polynomials: &Polynomials, moments: &[Lanes; TERMS], sums: &mut [[Lanes; 3]]) {
    let sums = &mut sums[polynomials.regime];
    let components = if polynomials.touches { 3 } else { 1 };
    for (sum, coefficients) in sums.iter_mut().zip(&polynomials.coefficients).take(components) {
        // A sum of its own, so that one product need not wait for the one before.
        let mut product = [0.0; LANES];
        for (coefficient, moment) in coefficients.iter().zip(moments).take(polynomials.terms) {
            for l in 0..LANES {
                product[l] += coefficient * moment[l];
            }
        }
        for l in 0..LANES {
            sum[l] += product[l];
        }
    }
}
