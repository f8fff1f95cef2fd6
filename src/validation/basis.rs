//! Functionals of the force curves for the joint test.

use crate::asperity::{Law, Loop, Scratch, Work, for_each_block};
use crate::engine::Probe;
use crate::math::linalg::{gram, whitening};
use crate::surface::{STRATA, SamplingScheme, Surface};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Heights of the grid on which the covariance of the law over separations is formed. It shapes the functionals only: their
/// expectations are the integral's and their covariance the sample's, so its error costs power, not truth.
const GRID: usize = 4001;
/// The grid covers ± this many σ_s.
const GRID_REACH: f64 = 8.5;
/// Most separations that the functionals look at: of more, every n-th, because the eigenvectors cost the cube of their number.
const MAX_SEPARATIONS: usize = 400;
/// Most functionals.
const MAX_COMPONENTS: usize = 32;
/// Fewest groups of replicas per functional.
const GROUPS_PER_COMPONENT: u64 = 4;
/// Smallest eigenvalue that is kept, relative to the largest.
const SMALLEST_EIGENVALUE: f64 = 1e-9;
/// Largest squared skewness of a mean over all replicas that is still treated as Gaussian; for a rare event, the reciprocal of how
/// often it is expected in the whole ensemble.
const LARGEST_SKEWNESS_SQUARED: f64 = 0.01;
/// Largest excess kurtosis of a mean over all replicas, likewise.
const LARGEST_KURTOSIS: f64 = 0.02;

/// Relative accuracy of the integral, and of direct sums.
const ACCURACY: f64 = 2e-12;
/// Largest error of a mean score by the accuracy of integral and sums, over its standard error.
const LARGEST_ERROR: f64 = 0.1;

/// The functionals and the separations that they look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Basis {
    /// Each scaled to a score of unit variance per replica, or per replica's worth of what the sampling scheme leaves to chance.
    pub probes: Vec<Probe>,
    /// For each state of the job, whether adhesion force and external force are Gaussian enough to be looked at.
    pub tested: [Vec<bool>; 2],
}

/// Moments of one asperity's contribution, weighted by the height density.
struct Column {
    std: f64,
    gaussian: bool,
}

/// The functionals for `replicas` replicas that are drawn by a scheme, at separations h, m: leading eigenvectors of the correlation
/// of adhesion and external force over all separations, by the law and of what the scheme leaves to chance. Separations, and
/// eigenvectors, whose mean over the ensemble is still decided by a few rare asperities are left out, because no covariance
/// describes them.
///
/// Sums are direct; [`basis_to`] is for others.
pub fn basis(law: &dyn Law, surface: &Surface, separations: &[f64], scheme: SamplingScheme, replicas: u64) -> Basis {
    basis_to(law, surface, separations, scheme, replicas, ACCURACY)
}

/// A law, and the separation d, m, at which it acts on the heights.
#[derive(Clone, Copy)]
struct State<'a> {
    law: &'a dyn Law,
    separation: f64,
}

/// The same for sums that are accurate to the share `accuracy` of F_s + P: left out are also eigenvectors that vary so little that this
/// would count.
pub fn basis_to(
    law: &dyn Law,
    surface: &Surface,
    separations: &[f64],
    scheme: SamplingScheme,
    replicas: u64,
    accuracy: f64,
) -> Basis {
    let states: Vec<State<'_>> = separations.iter().map(|&h| at(law, surface, h)).collect();
    basis_of(&states, surface, scheme, replicas, accuracy)
}

/// The same for a loop: its functionals look at both ways, between which only what differs counts.
pub fn basis_of_loop(
    cycle: &Loop,
    surface: &Surface,
    separations: &[f64],
    scheme: SamplingScheme,
    replicas: u64,
) -> Basis {
    let closest = surface.asperity_separation(separations[0]);
    let back: Vec<_> = separations.iter().map(|&h| cycle.at(surface.asperity_separation(h) - closest)).collect();
    let states = separations.iter().map(|&h| at(cycle.approach(), surface, h));
    let states: Vec<State<'_>> = states.chain(back.iter().map(|law| at(law, surface, separations[0]))).collect();
    basis_of(&states, surface, scheme, replicas, ACCURACY)
}

/// A law at the separation h, m.
fn at<'a>(law: &'a dyn Law, surface: &Surface, separation: f64) -> State<'a> {
    State { law, separation: surface.asperity_separation(separation) }
}

fn basis_of(states: &[State<'_>], surface: &Surface, scheme: SamplingScheme, replicas: u64, accuracy: f64) -> Basis {
    let accuracy = accuracy.max(ACCURACY);
    let all = states.len();
    let stride = all.div_ceil(MAX_SEPARATIONS);
    let states: Vec<State<'_>> = states.iter().copied().step_by(stride).collect();
    let s = states.len();
    // Independent contributions in the ensemble: a pair of opposite heights is one.
    let pairs = if scheme == SamplingScheme::Antithetic { 0.5 } else { 1.0 };
    let samples = pairs * surface.asperity_count as f64 * replicas as f64;
    let contributions = contributions(&states, surface, scheme);
    let columns: Vec<Column> = contributions
        .values
        .chunks_exact(GRID)
        .zip(&contributions.largest)
        .map(|(c, largest)| contributions.column(c, *largest, samples))
        .collect();
    let kept: Vec<usize> = (0..2 * s).filter(|&j| columns[j].gaussian).collect();
    let tested = [0, 1].map(|q| (0..all).map(|k| k % stride == 0 && columns[q * s + k / stride].gaussian).collect());
    let most = MAX_COMPONENTS.min((replicas / scheme.group() / GROUPS_PER_COMPONENT) as usize);
    let errors: Vec<f64> =
        kept.iter().map(|&j| accuracy * contributions.forces[j % s] / columns[j].std * samples.sqrt()).collect();
    let components = contributions.components(&kept, &columns, samples, &errors).into_iter().take(most);
    let root_count = (surface.asperity_count as f64).sqrt();
    let probes = components
        .map(|component| {
            let mut weights = vec![0.0; 2 * all];
            for (&j, weight) in kept.iter().zip(&component) {
                weights[j / s * all + j % s * stride] = weight / (columns[j].std * root_count);
            }
            Probe { external_force: weights.split_off(all), adhesion_force: weights }
        })
        .collect();
    Basis { probes, tested }
}

/// Centred contributions of one asperity by its height.
struct Contributions {
    /// Probability of each height of the grid.
    weights: Vec<f64>,
    /// Column by column, adhesion force then external force at each separation: 2S × GRID.
    values: Vec<f64>,
    /// Largest |contribution| of each column before it was centred.
    largest: Vec<f64>,
    /// Mean F_s + P at each separation, N.
    forces: Vec<f64>,
}

fn contributions(states: &[State<'_>], surface: &Surface, scheme: SamplingScheme) -> Contributions {
    let std = surface.heights.std;
    let step = 2.0 * GRID_REACH * std / (GRID - 1) as f64;
    let heights: Vec<f64> = (0..GRID).map(|i| (i as f64 - (GRID / 2) as f64) * step).collect();
    let mut weights: Vec<f64> = heights.iter().map(|&u| surface.heights.density(u)).collect();
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let mut values = vec![0.0; 2 * states.len() * GRID];
    let (adhesion, external) = values.split_at_mut(states.len() * GRID);
    let (mut scratch, mut work) = (Scratch::default(), Work::default());
    for (k, state) in states.iter().enumerate() {
        for_each_block(state.law, &heights, state.separation, &mut scratch, &mut work, |_, range, responses| {
            for (i, node) in range.enumerate() {
                adhesion[k * GRID + node] = responses.adhesion[i];
                external[k * GRID + node] = responses.contact[i] - responses.adhesion[i];
            }
        });
    }
    let mean = |column: &[f64]| column.iter().zip(&weights).map(|(f, w)| f * w).sum::<f64>();
    // F_s + P = 2 F_s + F.
    let columns =
        values[..states.len() * GRID].chunks_exact(GRID).zip(values[states.len() * GRID..].chunks_exact(GRID));
    let forces = columns.map(|(adhesion, external)| 2.0 * mean(adhesion) + mean(external)).collect();
    let largest = values.chunks_exact(GRID).map(|c| c.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()))).collect();
    let strata = strata(&heights, surface, scheme);
    for column in values.chunks_exact_mut(GRID) {
        if scheme == SamplingScheme::Antithetic {
            // What is odd in the height cancels in every pair.
            for i in 0..GRID / 2 {
                let even = 0.5 * (column[i] + column[GRID - 1 - i]);
                (column[i], column[GRID - 1 - i]) = (even, even);
            }
        }
        for range in &strata {
            let (column, weights) = (&mut column[range.clone()], &weights[range.clone()]);
            let mean: f64 = column.iter().zip(weights).map(|(f, w)| f * w).sum::<f64>();
            let mean = if strata.len() == 1 { mean } else { mean / weights.iter().sum::<f64>() };
            column.iter_mut().for_each(|f| *f -= mean);
        }
    }
    Contributions { weights, values, largest, forces }
}

/// Ranges of rising heights, m, over each of which the mean contribution is not left to chance.
fn strata(heights: &[f64], surface: &Surface, scheme: SamplingScheme) -> Vec<Range<usize>> {
    let count = if scheme == SamplingScheme::Stratified { STRATA } else { 1 };
    let end = |stratum: u64| {
        let below = stratum as f64 / count as f64;
        heights.partition_point(|&u| surface.heights.probability(f64::NEG_INFINITY, u) < below)
    };
    let ends: Vec<usize> = (0..count).map(end).chain([heights.len()]).collect();
    ends.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

impl Contributions {
    fn column(&self, column: &[f64], largest: f64, samples: f64) -> Column {
        let moment = |power: i32| column.iter().zip(&self.weights).map(|(f, w)| w * f.powi(power)).sum::<f64>();
        let std = moment(2).sqrt();
        // What is constant but for rounding, as in the lubricant regime, has no covariance.
        if !(std > 1e-10 * largest && std.is_finite()) {
            return Column { std, gaussian: false };
        }
        let skewness = moment(3) / std.powi(3);
        let kurtosis = moment(4) / std.powi(4) - 3.0;
        let gaussian =
            skewness * skewness <= LARGEST_SKEWNESS_SQUARED * samples && kurtosis.abs() <= LARGEST_KURTOSIS * samples;
        Column { std, gaussian }
    }

    /// Eigenvectors of the correlation of the kept columns, scaled to unit variance; `errors` of the columns' means are in units of their
    /// standard errors.
    fn components(&self, kept: &[usize], columns: &[Column], samples: f64, errors: &[f64]) -> Vec<Vec<f64>> {
        let n = kept.len();
        let mut rows = vec![0.0; GRID * n];
        for (place, &j) in kept.iter().enumerate() {
            for (i, weight) in self.weights.iter().enumerate() {
                rows[i * n + place] = weight.sqrt() * self.values[j * GRID + i] / columns[j].std;
            }
        }
        let components = whitening(&gram(&rows, n), n, SMALLEST_EIGENVALUE).into_iter();
        let error = |component: &[f64]| component.iter().zip(errors).map(|(c, e)| (c * e).powi(2)).sum::<f64>().sqrt();
        let resolved = components.filter(|component| error(component) <= LARGEST_ERROR);
        resolved.filter(|component| self.is_gaussian(component, &rows, samples)).take(MAX_COMPONENTS).collect()
    }

    /// Whether the ensemble's mean of a component is close to Gaussian.
    fn is_gaussian(&self, component: &[f64], rows: &[f64], samples: f64) -> bool {
        let (mut third, mut fourth) = (0.0, 0.0);
        for (row, weight) in rows.chunks_exact(component.len()).zip(&self.weights) {
            if *weight > 0.0 {
                let score: f64 = row.iter().zip(component).map(|(x, c)| x * c).sum::<f64>() / weight.sqrt();
                third += weight * score.powi(3);
                fourth += weight * score.powi(4);
            }
        }
        third * third <= LARGEST_SKEWNESS_SQUARED * samples && (fourth - 3.0).abs() <= LARGEST_KURTOSIS * samples
    }
}
