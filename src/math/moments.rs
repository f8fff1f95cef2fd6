//! Mergeable moments of vectors (Chan, Golub and LeVeque 1979).

use super::words::Words;

/// Count, mean and sum of squared deviations of each component.
#[derive(Clone, Debug, PartialEq)]
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

    /// How many samples.
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

    /// The standard error of the mean of each component; NaN for fewer than two samples.
    pub fn standard_error(&self) -> Vec<f64> {
        let root = (self.count as f64).sqrt();
        self.std().iter().map(|std| std / root).collect()
    }
}

impl Words for Moments {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.count);
        self.mean.each_word(visit);
        self.squares.each_word(visit);
    }
}

/// Mean and covariance of vectors.
#[derive(Clone, Debug, PartialEq)]
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
                self.products[i * n + j] += other.products[i * n + j] + between * deviations[i] * deviations[j];
            }
        }
        self.count = total;
    }

    /// How many samples.
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
}

impl Words for Comoments {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.count);
        self.mean.each_word(visit);
        self.products.each_word(visit);
    }
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
        let product =
            |a: usize, b: usize| samples.iter().map(|s| (s[a] - mean[a]) * (s[b] - mean[b])).sum::<f64>() / (n - 1.0);
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

    #[test]
    fn one_sample_has_no_spread() {
        let mut moments = Moments::new(1);
        moments.push(&[3.0]);
        assert!(moments.std()[0].is_nan() && moments.standard_error()[0].is_nan());
    }
}
