//! Mergeable moments of vectors (Chan, Golub and LeVeque 1979).

use serde::{Deserialize, Serialize};

/// Largest scatter, relative to the mean, of samples that agree: rounding and the solvers leave less.
const ALIKE: f64 = 1e-9;

/// Whether samples agree, by their number, mean and sum of squared deviations. Of the error of their mean nothing
/// is known then: equal outcomes are no certainty.
pub fn agree(count: u64, mean: f64, squares: f64) -> bool {
    squares <= count as f64 * (ALIKE * mean).powi(2)
}

/// Count, mean and sum of squared deviations of each component.
///
/// # Examples
/// ```
/// use stiction::engine::Moments;
///
/// let mut moments = Moments::new(1);
/// for sample in [1.0, 2.0, 6.0] {
///     moments.push(&[sample]);
/// }
/// assert_eq!((moments.count(), moments.mean()[0]), (3, 3.0));
/// assert!((moments.std()[0] - 7_f64.sqrt()).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    count: u64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    /// No samples of vectors of `length` components.
    pub fn new(length: usize) -> Self {
        Self { count: 0, mean: vec![0.0; length], squares: vec![0.0; length] }
    }

    /// The moments of numbers.
    pub fn of(numbers: impl Iterator<Item = f64>) -> Self {
        let mut moments = Self::new(1);
        numbers.for_each(|number| moments.push(&[number]));
        moments
    }

    /// The moments of the means of groups of `group` neighbours; an incomplete group does not count.
    pub fn of_groups(numbers: &[f64], group: usize) -> Self {
        Self::of(numbers.chunks_exact(group).map(|group| group.iter().sum::<f64>() / group.len() as f64))
    }

    /// Adds one sample of the same length.
    pub fn push(&mut self, sample: &[f64]) {
        self.count += 1;
        let weight = 1.0 / self.count as f64;
        for ((mean, squares), &x) in self.mean.iter_mut().zip(&mut self.squares).zip(sample) {
            let deviation = x - *mean;
            *mean += weight * deviation;
            *squares += deviation * (x - *mean);
        }
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let total = self.count + other.count;
        let weight = other.count as f64 / total as f64;
        let between = self.count as f64 * weight;
        for i in 0..self.mean.len() {
            let deviation = other.mean[i] - self.mean[i];
            self.mean[i] += weight * deviation;
            self.squares[i] += other.squares[i] + between * deviation * deviation;
        }
        self.count = total;
    }

    /// The number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of each component.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// The standard deviation of each component, with n − 1; NaN for fewer than two samples.
    pub fn std(&self) -> Vec<f64> {
        if self.count < 2 {
            return vec![f64::NAN; self.mean.len()];
        }
        self.squares.iter().map(|squares| (squares / (self.count - 1) as f64).sqrt()).collect()
    }

    /// The standard error of the mean of each component; NaN for fewer than two samples, and where all agree.
    pub fn standard_error(&self) -> Vec<f64> {
        let root = (self.count as f64).sqrt();
        let known =
            self.mean.iter().zip(&self.squares).map(|(mean, squares)| !agree(self.count, *mean, *squares));
        self.std().iter().zip(known).map(|(std, known)| if known { std / root } else { f64::NAN }).collect()
    }

    /// Whether both are of vectors of the same length.
    pub fn is_like(&self, other: &Self) -> bool {
        [self.mean.len(), self.squares.len()] == [other.mean.len(), other.squares.len()]
    }
}

/// Mean and covariance of vectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comoments {
    count: u64,
    mean: Vec<f64>,
    /// Row-major sums of products of deviations.
    products: Vec<f64>,
}

impl Comoments {
    /// No samples of vectors of `length` components.
    pub fn new(length: usize) -> Self {
        Self { count: 0, mean: vec![0.0; length], products: vec![0.0; length * length] }
    }

    /// Adds one sample of the same length.
    pub fn push(&mut self, sample: &[f64]) {
        let n = self.mean.len();
        self.count += 1;
        let weight = 1.0 / self.count as f64;
        let deviations: Vec<f64> = sample.iter().zip(&self.mean).map(|(x, mean)| x - mean).collect();
        let between = 1.0 - weight;
        for i in 0..n {
            self.mean[i] += weight * deviations[i];
            for j in 0..n {
                self.products[i * n + j] += between * deviations[i] * deviations[j];
            }
        }
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let n = self.mean.len();
        let total = self.count + other.count;
        let weight = other.count as f64 / total as f64;
        let between = self.count as f64 * weight;
        let deviations: Vec<f64> = other.mean.iter().zip(&self.mean).map(|(b, a)| b - a).collect();
        for i in 0..n {
            self.mean[i] += weight * deviations[i];
            for j in 0..n {
                self.products[i * n + j] +=
                    other.products[i * n + j] + between * deviations[i] * deviations[j];
            }
        }
        self.count = total;
    }

    /// The number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of each component.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// The covariance with n − 1, row-major; NaN for fewer than two samples.
    pub fn covariance(&self) -> Vec<f64> {
        let freedom = if self.count < 2 { f64::NAN } else { (self.count - 1) as f64 };
        self.products.iter().map(|product| product / freedom).collect()
    }

    /// Whether both are of vectors of the same length.
    pub fn is_like(&self, other: &Self) -> bool {
        [self.mean.len(), self.products.len()] == [other.mean.len(), other.products.len()]
    }
}

/// Mean, covariance and third central moments of vectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CentralMoments {
    second: Comoments,
    /// Sums of products of three deviations, of components i ≤ j ≤ k in lexicographic order.
    third: Vec<f64>,
}

impl CentralMoments {
    /// No samples of vectors of `length` components.
    pub fn new(length: usize) -> Self {
        Self { second: Comoments::new(length), third: vec![0.0; length * (length + 1) * (length + 2) / 6] }
    }

    /// Adds one sample of the same length.
    pub fn push(&mut self, sample: &[f64]) {
        let mut one = Comoments::new(sample.len());
        one.push(sample);
        self.merge_third(&one, None);
        self.second.push(sample);
    }

    /// Adds the samples of another.
    pub fn merge(&mut self, other: &Self) {
        if other.count() == 0 {
            return;
        }
        self.merge_third(&other.second, Some(&other.third));
        self.second.merge(&other.second);
    }

    /// Adds the third moments of another, before its other moments are added (Pébay 2008, SAND2008-6212).
    fn merge_third(&mut self, other: &Comoments, third: Option<&[f64]>) {
        let (n, mine, theirs) = (self.second.mean.len(), self.second.count as f64, other.count as f64);
        let total = mine + theirs;
        let deviations: Vec<f64> = other.mean.iter().zip(&self.second.mean).map(|(b, a)| b - a).collect();
        let [mine, theirs] = [mine / total, theirs / total];
        let cubic = total * mine * theirs * (mine - theirs);
        // Σ over the three choices of δ_i (mine B_jk − theirs A_jk).
        let between =
            |j: usize, k: usize| mine * other.products[j * n + k] - theirs * self.second.products[j * n + k];
        let between: Vec<f64> = (0..n * n).map(|place| between(place / n, place % n)).collect();
        let mut place = 0;
        for i in 0..n {
            for j in i..n {
                let pair = cubic * deviations[i] * deviations[j] + between[i * n + j];
                for k in j..n {
                    let rest = deviations[i] * between[j * n + k] + deviations[j] * between[i * n + k];
                    self.third[place] +=
                        third.map_or(0.0, |third| third[place]) + (pair * deviations[k] + rest);
                    place += 1;
                }
            }
        }
    }

    /// The number of samples.
    pub fn count(&self) -> u64 {
        self.second.count
    }

    /// Mean and covariance.
    pub fn second(&self) -> &Comoments {
        &self.second
    }

    /// Moments of the combination of the components with `weights`, `shift` added.
    pub fn combined(&self, weights: &[f64], shift: f64) -> Self {
        let [mean, squares, cubes] = self.of_combination(weights);
        let second = Comoments { count: self.count(), mean: vec![mean + shift], products: vec![squares] };
        Self { second, third: vec![cubes] }
    }

    /// Mean and sums of squared and cubed deviations of the combination of the components with `weights`.
    pub fn of_combination(&self, weights: &[f64]) -> [f64; 3] {
        let n = weights.len();
        let used: Vec<usize> = (0..n).filter(|&i| weights[i] != 0.0).collect();
        let mut sums = [0.0; 3];
        for &i in &used {
            sums[0] += weights[i] * self.second.mean[i];
            for &j in &used {
                sums[1] += weights[i] * weights[j] * self.second.products[i * n + j];
                for &k in &used {
                    let mut sorted = [i, j, k];
                    sorted.sort_unstable();
                    sums[2] += weights[i] * weights[j] * weights[k] * self.third[place_of(n, sorted)];
                }
            }
        }
        [sums[0], sums[1].max(0.0), sums[2]]
    }

    /// Whether both are of vectors of the same length.
    pub fn is_like(&self, other: &Self) -> bool {
        self.second.is_like(&other.second) && self.third.len() == other.third.len()
    }
}

/// The place of components i ≤ j ≤ k of n among the packed third moments.
fn place_of(n: usize, [i, j, k]: [usize; 3]) -> usize {
    let triangle = |m: usize| m * (m + 1) / 2;
    let tetrahedron = |m: usize| m * (m + 1) * (m + 2) / 6;
    tetrahedron(n) - tetrahedron(n - i) + triangle(n - i) - triangle(n - j) + (k - j)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Vec<[f64; 2]> {
        (0..37).map(|i| [1e6 + f64::from(i * i % 17), f64::from(i * 7 % 11) - 3.0]).collect()
    }

    /// Mean and covariance in two passes.
    fn two_pass(samples: &[[f64; 2]]) -> ([f64; 2], [f64; 4]) {
        let n = samples.len() as f64;
        let mean = [0, 1].map(|c| samples.iter().map(|s| s[c]).sum::<f64>() / n);
        let product = |a: usize, b: usize| {
            samples.iter().map(|s| (s[a] - mean[a]) * (s[b] - mean[b])).sum::<f64>() / (n - 1.0)
        };
        (mean, [product(0, 0), product(0, 1), product(1, 0), product(1, 1)])
    }

    #[test]
    fn merged_parts_agree_with_two_passes() {
        let samples = samples();
        let (mean, covariance) = two_pass(&samples);
        for split in [0, 1, 5, 36, 37] {
            let (mut moments, mut comoments) = (Moments::new(2), Comoments::new(2));
            for part in [&samples[..split], &samples[split..]] {
                let (mut m, mut c) = (Moments::new(2), Comoments::new(2));
                for sample in part {
                    m.push(sample);
                    c.push(sample);
                }
                moments.merge(&m);
                comoments.merge(&c);
            }
            assert_eq!((moments.count(), comoments.count()), (37, 37));
            for i in 0..2 {
                assert!((moments.mean()[i] / mean[i] - 1.0).abs() < 1e-14);
                assert!((comoments.mean()[i] / mean[i] - 1.0).abs() < 1e-14);
                assert!((moments.std()[i] / covariance[3 * i].sqrt() - 1.0).abs() < 1e-9);
            }
            for (a, b) in comoments.covariance().iter().zip(covariance) {
                assert!((a - b).abs() < 1e-8 * b.abs().max(1.0), "{a} {b}");
            }
        }
    }

    /// Combinations of merged parts against their own values in two passes, shifted so far that sums of cubes
    /// would lose them.
    #[test]
    fn combinations_have_the_moments_of_their_values() {
        let samples: Vec<[f64; 4]> = (0..41)
            .map(|i| {
                let x = f64::from(i);
                [
                    1e4 + f64::from(i * i % 17),
                    f64::from(i * 7 % 11) - 3.0,
                    (0.2 * x).exp(),
                    f64::from(i * i * i % 13),
                ]
            })
            .collect();
        for split in [0, 1, 2, 20, 40, 41] {
            let mut merged = CentralMoments::new(4);
            for part in [&samples[..split], &samples[split..]] {
                let mut moments = CentralMoments::new(4);
                part.iter().for_each(|sample| moments.push(sample));
                merged.merge(&moments);
            }
            assert_eq!(merged.count(), 41);
            for weights in
                [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.3, -2.0, 0.05, 1.5], [0.0, 1.0, 0.0, 2.0]]
            {
                let values: Vec<f64> = samples
                    .iter()
                    .map(|sample| sample.iter().zip(weights).map(|(x, w)| x * w).sum())
                    .collect();
                let mean = values.iter().sum::<f64>() / 41.0;
                let [found, squares, cubes] = merged.of_combination(&weights);
                let sum = |power: i32| values.iter().map(|value| (value - mean).powi(power)).sum::<f64>();
                let scale = values.iter().map(|value| (value - mean).abs().powi(3)).sum::<f64>();
                assert!((found - mean).abs() < 1e-11 * mean.abs().max(1.0), "{found} {mean}");
                assert!((squares / sum(2) - 1.0).abs() < 1e-9, "{squares} {}", sum(2));
                assert!((cubes - sum(3)).abs() < 1e-9 * scale, "{split} {weights:?}: {cubes} {}", sum(3));
            }
        }
    }

    #[test]
    fn one_sample_has_no_spread() {
        let mut moments = Moments::new(1);
        moments.push(&[3.0]);
        assert!(moments.std()[0].is_nan() && moments.standard_error()[0].is_nan());
    }

    /// Equal samples scatter by nothing, but that says nothing about the error of their mean; a billionth counts as
    /// rounding, and a millionth does not.
    #[test]
    fn equal_samples_have_no_standard_error() {
        let error = |samples: [f64; 3]| {
            let moments = Moments::of(samples.into_iter());
            assert!(moments.std()[0] >= 0.0);
            moments.standard_error()[0]
        };
        assert!(
            error([3.0; 3]).is_nan() && error([0.0; 3]).is_nan() && error([3.0, 3.0, 3.0 + 1e-9]).is_nan()
        );
        assert!((error([3.0, 3.0, 3.0 + 1e-6]) - 1e-6 / 3.0).abs() < 1e-12);
    }

    /// Two groups of two, with the means 2 and 6, of the mean 4 and the variance 8; of the fifth number a group would
    /// need another. Groups of three: one, of mean 3; groups of six: none.
    #[test]
    fn an_incomplete_group_does_not_count() {
        let numbers = [1.0, 3.0, 5.0, 7.0, 1000.0];
        let pairs = Moments::of_groups(&numbers, 2);
        assert_eq!((pairs.count(), pairs.mean()[0]), (2, 4.0));
        assert!((pairs.std()[0] - 8_f64.sqrt()).abs() < 1e-15, "{:?}", pairs.std());
        let triple = Moments::of_groups(&numbers, 3);
        assert_eq!((triple.count(), triple.mean()[0]), (1, 3.0));
        assert_eq!(Moments::of_groups(&numbers, 6).count(), 0);
    }
}
