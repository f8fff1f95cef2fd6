//! Functionals of the force curves for the joint test.

use super::grid::{StateAt, Turned, grid};
use super::joint::{Probe, SIGNIFICANCE};
use super::null::{Cumulants, GrowingCumulants};
use crate::asperity::{Facing, Laws, Loop, Scratch, SolverStats};
use crate::math::linalg::{LARGEST, gram, whitening};
use crate::surface::{CountLaw, Radii, STRATA, SamplingScheme, Surface};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Most separations that the functionals look at: of more, every n-th, because the eigenvectors cost the cube
/// of their number.
const MAX_SEPARATIONS: usize = LARGEST / 2;
/// Most functionals.
pub const MAX_COMPONENTS: usize = 32;
/// Smallest eigenvalue that is kept, relative to the largest.
const SMALLEST_EIGENVALUE: f64 = 1e-9;
/// Largest squared skewness of a mean over all replicas that is still treated as Gaussian. For a rare event this is the
/// reciprocal of its expected number in the whole ensemble.
const LARGEST_SKEWNESS_SQUARED: f64 = 0.01;
/// Largest excess kurtosis of a mean over all replicas that is still treated as Gaussian; for a rare event,
/// this reciprocal too.
const LARGEST_KURTOSIS: f64 = 0.02;
/// Largest correction of the p-value at the significance by the third and fourth cumulants, relative.
const LARGEST_CORRECTION: f64 = 0.1;

/// Relative accuracy of the integral, and of direct sums.
const ACCURACY: f64 = 2e-12;
/// Largest error of a mean score by the accuracy of integral and sums, over its standard error.
const LARGEST_ERROR: f64 = 0.1;

/// The functionals and the separations that they look at.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, Quantity, model};
/// use stiction::engine::Job;
/// use stiction::integral::Expectations;
/// use stiction::surface::Surface;
/// use stiction::validation::{Basis, JointTest, Draws, Verdict, basis};
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let job = Job::new(law.as_ref(), &surface, &separations, 256, 1);
/// let (ensemble, integral) = (job.ensemble(), Expectations::new(job.laws, &surface, &separations));
/// let quantities = [Quantity::AdhesionForce.index(), Quantity::ExternalForce.index()];
/// let mean = quantities.map(|q| ensemble.curves[q].mean());
/// let expected = quantities.map(|q| &integral.expected[q][..]);
/// let draws = Draws { scheme: job.scheme, replicas: job.replicas };
/// let Basis { probes, cumulants, .. } = basis(job.laws, &surface, &separations, draws);
/// let test = JointTest::new(&probes, mean, expected, cumulants, job.replicas);
/// assert_eq!(test.verdict, Verdict::Agree);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Basis {
    /// Functionals, each scaled to a score of unit variance per replica. Only the variance counts that the sampling scheme
    /// leaves to chance.
    pub probes: Vec<Probe>,
    /// Fourth and third cumulants of the scores of a replica.
    pub cumulants: Cumulants,
    /// For each state of the job, whether adhesion force and external force are Gaussian enough to be looked
    /// at.
    pub tested: [Vec<bool>; 2],
}

impl Basis {
    /// No functionals, which look at none of the states.
    pub(crate) fn untested(states: usize) -> Self {
        let tested = [vec![false; states], vec![false; states]];
        Self { probes: Vec::new(), cumulants: Cumulants::default(), tested }
    }
}

/// Moments of one asperity's contribution, weighted by the height density.
struct Column {
    std: f64,
    gaussian: bool,
}

/// The replicas that functionals are for.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    /// The scheme by which they are drawn.
    pub scheme: SamplingScheme,
    /// Their number.
    pub replicas: u64,
}

/// The functionals for replicas of a surface, at separations h, m: leading
/// eigenvectors of the correlation of adhesion and external force over all separations, by the law and of
/// what the scheme leaves to chance. Separations, and eigenvectors, whose mean over the ensemble is still
/// decided by a few rare asperities are left out, because no covariance describes them.
///
/// Sums are direct; [`basis_to`] is for others.
pub fn basis<'a>(laws: impl Into<Laws<'a>>, surface: &Surface, separations: &[f64], draws: Draws) -> Basis {
    basis_to(laws, surface, separations, draws, ACCURACY)
}

/// The functionals for sums that are accurate to the share `accuracy` of F_s + P: left out are also
/// eigenvectors that vary so little that this would count.
pub fn basis_to<'a>(
    laws: impl Into<Laws<'a>>,
    surface: &Surface,
    separations: &[f64],
    draws: Draws,
    accuracy: f64,
) -> Basis {
    let laws = laws.into();
    let at = |h: &f64| StateAt::Way(laws, surface.asperity_separation(*h));
    let states: Vec<StateAt<'_>> = separations.iter().map(at).collect();
    basis_of(&states, surface, draws, accuracy)
}

/// The functionals for a loop: they look at all its ways, between which only what differs counts.
pub fn basis_of_loop<'a>(
    laws: impl Into<Laws<'a>>,
    cycle: &Loop,
    surface: &Surface,
    separations: &[f64],
    draws: Draws,
) -> Basis {
    let laws = laws.into();
    let inward = separations.iter().map(|h| StateAt::Way(laws, surface.asperity_separation(*h)));
    let back = |of: fn(_) -> _| turned(cycle, surface, separations).map(of);
    let again = back(StateAt::Again).filter(|_| cycle.again().is_some());
    let states: Vec<StateAt<'_>> = inward.chain(back(StateAt::Retraction)).chain(again).collect();
    basis_of(&states, surface, draws, ACCURACY)
}

/// The functionals for the retraction of a loop alone.
pub fn basis_of_retraction(cycle: &Loop, surface: &Surface, separations: &[f64], draws: Draws) -> Basis {
    let states: Vec<StateAt<'_>> = turned(cycle, surface, separations).map(StateAt::Retraction).collect();
    basis_of(&states, surface, draws, ACCURACY)
}

/// A loop at separations h, m, after it turned at the first of them.
fn turned<'a>(
    cycle: &'a Loop,
    surface: &'a Surface,
    separations: &'a [f64],
) -> impl Iterator<Item = Turned<'a>> {
    let from = surface.asperity_separation(separations[0]);
    separations.iter().map(move |h| Turned { cycle, from, distance: surface.asperity_separation(*h) - from })
}

/// The number of separations that the functionals look at, out of `separations`.
pub fn tested_separations(separations: usize) -> usize {
    separations.div_ceil(separations.div_ceil(MAX_SEPARATIONS).max(1))
}

fn basis_of(states: &[StateAt<'_>], surface: &Surface, draws: Draws, accuracy: f64) -> Basis {
    let (accuracy, Draws { scheme, replicas }) = (accuracy.max(ACCURACY), draws);
    let all = states.len();
    let stride = all.div_ceil(MAX_SEPARATIONS);
    if surface.whole || surface.landing.is_some() {
        // Nothing is left to chance, or places of a map depend on each other.
        return Basis::untested(all);
    }
    let states: Vec<StateAt<'_>> = states.iter().copied().step_by(stride).collect();
    let s = states.len();
    // Independent contributions in the ensemble: a pair of opposite heights is one.
    let pairs = if scheme == SamplingScheme::Antithetic { 0.5 } else { 1.0 };
    let samples = pairs * surface.asperity_count as f64 * replicas as f64;
    let contributions = contributions(&states, surface, scheme);
    let columns = contributions.values.chunks_exact(contributions.weights.len()).zip(&contributions.largest);
    let columns: Vec<Column> =
        columns.map(|(c, largest)| contributions.column(c, *largest, samples)).collect();
    let kept: Vec<usize> = (0..2 * s).filter(|&j| columns[j].gaussian).collect();
    let tested =
        [0, 1].map(|q| (0..all).map(|k| k % stride == 0 && columns[q * s + k / stride].gaussian).collect());
    let errors: Vec<f64> = kept
        .iter()
        .map(|&j| accuracy * contributions.forces[j % s] / columns[j].std * samples.sqrt())
        .collect();
    let (components, cumulants) = contributions.components(&kept, &columns, samples, &errors);
    // What a scheme leaves to chance of radii that scatter is known on a grid that is too coarse for small eigenvalues.
    let is_exact = matches!(surface.radii, Radii::Common | Radii::Measured(_));
    let components = if scheme == SamplingScheme::Independent || is_exact { components } else { Vec::new() };
    // A pair of opposite heights adds twice the half of it that is not odd.
    let root_count = (surface.asperity_count as f64 / pairs).sqrt();
    let probes = components
        .iter()
        .map(|component| {
            let mut weights = vec![0.0; 2 * all];
            for (&j, weight) in kept.iter().zip(component) {
                weights[j / s * all + j % s * stride] = weight / (columns[j].std * root_count);
            }
            Probe { external_force: weights.split_off(all), adhesion_force: weights }
        })
        .collect();
    Basis { probes, cumulants: cumulants.of(1.0 / (pairs * surface.asperity_count as f64)), tested }
}

/// The contribution of one asperity, less its mean where the number of asperities is fixed.
struct Contributions {
    /// Probability of each asperity of the grid.
    weights: Vec<f64>,
    /// Column by column, adhesion force then external force at each separation: 2S × the grid.
    values: Vec<f64>,
    /// Largest |contribution| of each column before it was centred.
    largest: Vec<f64>,
    /// Mean F_s + P at each separation, N.
    forces: Vec<f64>,
    /// Ranges of the grid over each of which the mean is not left to chance; none where the number of
    /// asperities is left to it.
    strata: Vec<Range<usize>>,
}

fn contributions(states: &[StateAt<'_>], surface: &Surface, scheme: SamplingScheme) -> Contributions {
    let grid = grid(states, surface, scheme);
    let count: usize = grid.iter().map(|alike| alike.heights.len()).sum();
    // Nodes of the same score are together where a scheme relates scores.
    let rows = grid[0].heights.len();
    let radii = if scheme != SamplingScheme::Independent && rows > 1 { grid.len() } else { 1 };
    let mut first = 0;
    let places = grid.iter().enumerate().map(|(number, alike)| {
        let begin = if radii > 1 { number } else { first };
        first += alike.heights.len();
        (0..alike.heights.len()).map(|node| begin + node * radii).collect()
    });
    let places: Vec<Vec<usize>> = places.collect();
    let mut weights = vec![0.0; count];
    for (place, weight) in places.iter().flatten().zip(grid.iter().flat_map(|alike| &alike.weights)) {
        weights[*place] = *weight;
    }
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let mut values = vec![0.0; 2 * states.len() * count];
    let (adhesion, external) = values.split_at_mut(states.len() * count);
    let (mut scratch, mut stats) = (Scratch::default(), SolverStats::default());
    for (alike, places) in grid.iter().zip(&places) {
        for (k, state) in states.iter().enumerate() {
            state.visit(&alike.laws, |law, separation| {
                let facing = Facing { law, heights: &alike.heights, separation };
                facing.for_each_block(&mut scratch, &mut stats, |_, range, responses| {
                    for (i, node) in range.enumerate() {
                        let place = k * count + places[node];
                        adhesion[place] = responses.adhesion[i];
                        external[place] = responses.contact[i] - responses.adhesion[i];
                    }
                });
            });
        }
    }
    let mean = |column: &[f64]| column.iter().zip(&weights).map(|(f, w)| f * w).sum::<f64>();
    // F_s + P = 2 F_s + F.
    let columns = adhesion.chunks_exact(count).zip(external.chunks_exact(count));
    let forces = columns.map(|(adhesion, external)| 2.0 * mean(adhesion) + mean(external)).collect();
    let largest =
        values.chunks_exact(count).map(|c| c.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()))).collect();
    let mut strata = strata(&weights, scheme);
    if surface.count_law == CountLaw::Fixed {
        centre(&mut values, &weights, (&strata, radii), scheme);
    } else {
        strata.clear();
    }
    Contributions { weights, values, largest, forces, strata }
}

/// Takes away what is not left to chance: the mean over all asperities, or over all of each stratum. Each
/// `radii` neighbouring values have the same score.
fn centre(
    values: &mut [f64],
    weights: &[f64],
    (strata, radii): (&[Range<usize>], usize),
    scheme: SamplingScheme,
) {
    let count = weights.len();
    for column in values.chunks_exact_mut(count) {
        if scheme == SamplingScheme::Antithetic {
            // What is odd in the score cancels in every pair, on average over radii, which are independent.
            let mean = |(values, weights): (&[f64], &[f64])| {
                if radii == 1 {
                    return values[0];
                }
                let sum: f64 = values.iter().zip(weights).map(|(value, weight)| value * weight).sum();
                sum / weights.iter().sum::<f64>()
            };
            let means: Vec<f64> =
                column.chunks_exact(radii).zip(weights.chunks_exact(radii)).map(mean).collect();
            for (i, values) in column.chunks_exact_mut(radii).enumerate() {
                let odd = 0.5 * (means[i] - means[means.len() - 1 - i]);
                values.iter_mut().for_each(|value| *value -= odd);
            }
        }
        for range in strata {
            let (column, weights) = (&mut column[range.clone()], &weights[range.clone()]);
            let mean: f64 = column.iter().zip(weights).map(|(f, w)| f * w).sum::<f64>();
            let mean = if strata.len() == 1 { mean } else { mean / weights.iter().sum::<f64>() };
            column.iter_mut().for_each(|f| *f -= mean);
        }
    }
}

/// Ranges of the asperities of the grid, of their weights, over each of which the mean contribution is not left to chance;
/// where there are several the grid is in the order of scores.
fn strata(weights: &[f64], scheme: SamplingScheme) -> Vec<Range<usize>> {
    let all = 0..weights.len();
    if scheme != SamplingScheme::Stratified {
        return Vec::from([all]);
    }
    let mut below = 0.0;
    // By the middles of asperities, none of which is in two strata.
    let middles: Vec<f64> = weights.iter().map(|weight| (below += weight, below - 0.5 * weight).1).collect();
    let end = |stratum: u64| middles.partition_point(|middle| *middle < stratum as f64 / STRATA as f64);
    (0..STRATA).map(|stratum| end(stratum)..end(stratum + 1)).collect()
}

impl Contributions {
    fn column(&self, column: &[f64], largest: f64, samples: f64) -> Column {
        let moment =
            |power: i32| column.iter().zip(&self.weights).map(|(f, w)| w * f.powi(power)).sum::<f64>();
        let std = moment(2).sqrt();
        // What is constant but for rounding, as in the lubricant regime, has no covariance.
        if !(std > 1e-10 * largest && std.is_finite()) {
            return Column { std, gaussian: false };
        }
        let skewness = moment(3) / std.powi(3);
        let kurtosis = moment(4) / std.powi(4) - 3.0;
        let gaussian = skewness * skewness <= LARGEST_SKEWNESS_SQUARED * samples
            && kurtosis.abs() <= LARGEST_KURTOSIS * samples;
        Column { std, gaussian }
    }

    /// Eigenvectors of the correlation of the kept columns, scaled to unit variance, and the cumulants of one
    /// asperity's contributions to them; `errors` of the columns' means are in units of their standard
    /// errors. Left out are those with which the mean of `samples` contributions would not be close to
    /// Gaussian.
    fn components(
        &self,
        kept: &[usize],
        columns: &[Column],
        samples: f64,
        errors: &[f64],
    ) -> (Vec<Vec<f64>>, Cumulants) {
        let count = self.weights.len();
        let scaled = |j: &usize| {
            let values = self.values[j * count..].iter().zip(&self.weights);
            values.map(|(value, weight)| weight.sqrt() * value / columns[*j].std).collect()
        };
        let scaled: Vec<Vec<f64>> = kept.iter().map(scaled).collect();
        let (mut components, mut growing) = (Vec::new(), GrowingCumulants::new(&self.weights, &self.strata));
        let error = |component: &[f64]| {
            component.iter().zip(errors).map(|(c, e)| (c * e).powi(2)).sum::<f64>().sqrt()
        };
        for component in whitening(&gram(&scaled), kept.len(), SMALLEST_EIGENVALUE) {
            if components.len() == MAX_COMPONENTS {
                break;
            }
            if error(&component) > LARGEST_ERROR {
                continue;
            }
            let mut scores = vec![0.0; count];
            for (column, weight) in scaled.iter().zip(&component) {
                scores.iter_mut().zip(column).for_each(|(score, x)| *score += weight * x);
            }
            let unweighted =
                scores.iter().zip(&self.weights).map(|(x, w)| if *w > 0.0 { x / w.sqrt() } else { 0.0 });
            if growing.push(unweighted.collect(), |cumulants, k| {
                cumulants.of(1.0 / samples).correction_at(SIGNIFICANCE, k) <= LARGEST_CORRECTION
            }) {
                components.push(component);
            }
        }
        (components, growing.cumulants)
    }
}
