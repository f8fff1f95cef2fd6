//! Chebyshev interpolation on −1..1: from samples at the nodes cos(π(i + 1/2)/n) to coefficients, and from
//! these to powers.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Fewer samples than this have their cosines kept.
const KEPT: usize = 64;

/// π(i + 1/2)/n, whose cosine is the node `i` of `n`.
pub fn angle(i: usize, n: usize) -> f64 {
    PI * (i as f64 + 0.5) / n as f64
}

/// cos(kπ(i + 1/2)/n), row by row of k.
fn cosines(n: usize) -> Vec<f64> {
    (0..n * n).map(|at| libm::cos((at / n) as f64 * angle(at % n, n))).collect()
}

/// Coefficients c of the interpolant Σ c_k T_k(v) through samples at the nodes, by the discrete orthogonality
/// of the T_k there.
pub fn coefficients(samples: &[f64]) -> Vec<f64> {
    static TABLES: [OnceLock<Vec<f64>>; KEPT] = [const { OnceLock::new() }; KEPT];
    let n = samples.len();
    let made;
    let cosines = match TABLES.get(n) {
        Some(table) => table.get_or_init(|| cosines(n)),
        None => {
            made = cosines(n);
            &made
        }
    };
    let coefficient = |(k, row): (usize, &[f64])| {
        let sum: f64 = samples.iter().zip(row).map(|(f, cosine)| f * cosine).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
    };
    cosines.chunks_exact(n.max(1)).enumerate().map(coefficient).collect()
}

/// Σ c_k T_k(v), at most N terms, as coefficients of the powers of v, by T_{k+1} = 2vT_k − T_{k−1}.
pub fn powers<const N: usize>(chebyshev: &[f64]) -> [f64; N] {
    let mut coefficients = [0.0; N];
    let (mut before, mut current) = ([0.0; N], [0.0; N]);
    current[0] = 1.0;
    for (k, c) in chebyshev.iter().enumerate() {
        for (coefficient, power) in coefficients.iter_mut().zip(&current) {
            *coefficient += c * power;
        }
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let next =
            std::array::from_fn(|i| if i == 0 { -before[0] } else { factor * current[i - 1] - before[i] });
        before = current;
        current = next;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_its_own_interpolant() {
        // v³ = (3T_1 + T_3)/4.
        let samples: Vec<f64> = (0..5).map(|i| libm::cos(angle(i, 5)).powi(3)).collect();
        let chebyshev = coefficients(&samples);
        for (c, expected) in chebyshev.iter().zip([0.0, 0.75, 0.0, 0.25, 0.0]) {
            assert!((c - expected).abs() < 1e-15, "{chebyshev:?}");
        }
        assert_eq!(powers::<4>(&[0.0, 0.75, 0.0, 0.25]), [0.0, 0.0, 0.0, 1.0]);
    }
}
