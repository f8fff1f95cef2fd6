//! Nodes and weights of Gauss's rules.
//!
//! # Formula
//! Of an even density with the integral β₀, p_{k+1} = x p_k − β_k p_{k−1} are orthogonal. The nodes of a rule
//! are the zeros of p_n, which are the eigenvalues of a matrix with √β_k on both sides of a diagonal of zeros;
//! the weights are β₀ β₁ ⋯ β_{n−1}/(p_n′ p_{n−1}) (Golub and Welsch, Math. Comp. 23 (1969) 221). Newton's method
//! in doubled precision takes the rounding out of the eigenvalues. Its fused operations are correctly rounded,
//! and so the same on every processor.
//!
//! # Validity
//! An even number of nodes, up to about a hundred: an odd one has a node at 0, which is found to 1e-32 only.

use super::linalg::symmetric_eigen;
use faer::fx128 as Doubled;
use std::f64::consts::PI;

/// Steps of Newton's method: the first leaves about 1e-28, the second nothing.
const STEPS: usize = 2;
/// Terms of the series of a cosine, for angles of up to π/2: the next one is below 1e-36.
const TERMS: usize = 19;

/// Nodes, rising, and weights of the rule for ∫f over −1..1. Weights are correctly rounded. So are the angles of
/// nodes; their cosines are within 3e-16 of the zeros.
pub fn legendre(nodes: usize) -> Vec<(f64, f64)> {
    let square = |k: usize| Doubled::from((k * k) as f64);
    let beta = |k: usize| square(k) / (square(2 * k) - Doubled::from(1.0));
    let pairs = rule(nodes, |k| if k == 0 { Doubled::from(2.0) } else { beta(k) });
    pairs.into_iter().map(|(node, weight)| (by_angle(node), weight.0)).collect()
}

/// Nodes, rising, and weights of the rule for the mean of f of a standard normal deviate, correctly rounded.
pub fn normal(nodes: usize) -> Vec<(f64, f64)> {
    let pairs = rule(nodes, |k| Doubled::from(k.max(1) as f64));
    pairs.into_iter().map(|(node, weight)| (node.0, weight.0)).collect()
}

/// The cosine of the rounded angle of a node, measured from the nearer end of −1..1, as in the tables of Bogaert
/// (SIAM J. Sci. Comput. 36 (2014) A1008).
fn by_angle(node: Doubled) -> f64 {
    let size = if node.0 < 0.0 { -node } else { node };
    let angle = libm::acos(size.0);
    let square = Doubled::from(angle) * Doubled::from(angle);
    let (mut term, mut cosine) = (Doubled::from(1.0), Doubled::from(1.0));
    for k in 1..TERMS {
        term = -term * square / Doubled::from((2 * k * (2 * k - 1)) as f64);
        cosine += term;
    }
    let angle = angle + (cosine - size).0 / libm::sin(angle);
    libm::cos(if node.0 < 0.0 { PI - angle } else { angle })
}

/// The rule of a density with the coefficients β.
fn rule(nodes: usize, beta: impl Fn(usize) -> Doubled) -> Vec<(Doubled, Doubled)> {
    let beta: Vec<Doubled> = (0..nodes).map(beta).collect();
    let mut matrix = vec![0.0; nodes * nodes];
    for k in 1..nodes {
        let root = beta[k].0.sqrt();
        (matrix[k * nodes + k - 1], matrix[(k - 1) * nodes + k]) = (root, root);
    }
    let eigen = symmetric_eigen(&matrix, nodes).expect("the matrix is finite");
    let product = beta.iter().fold(Doubled::from(1.0), |product, beta| product * beta);
    let pair = |eigenvalue: &f64| {
        let mut node = Doubled::from(*eigenvalue);
        for _ in 0..STEPS {
            let [value, slope, _] = polynomial(&beta, node);
            node -= value / slope;
        }
        let [_, slope, before] = polynomial(&beta, node);
        (node, product / (slope * before))
    };
    eigen.values.iter().rev().map(pair).collect()
}

/// p_n, p_n′ and p_{n−1} at x.
fn polynomial(beta: &[Doubled], x: Doubled) -> [Doubled; 3] {
    let (zero, one) = (Doubled::from(0.0), Doubled::from(1.0));
    let (mut own, mut before) = ([one, zero], [zero; 2]);
    for beta in beta {
        let next = [x * own[0] - *beta * before[0], own[0] + x * own[1] - *beta * before[1]];
        (before, own) = (own, next);
    }
    [own[0], own[1], before[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper nodes and weights by `mpmath` with 60 digits: zeros of P_20, P_64, He_8 and He_10 and, by derivatives,
    /// 2/((1 − x²) P_n′²) and n!/He_n′².
    #[test]
    fn nodes_and_weights_are_known_ones() {
        let known = [
            (legendre(20), 10, 0.07652652113349734, 0.15275338713072584),
            (legendre(20), 14, 0.636053680726515, 0.11819453196151841),
            (legendre(20), 19, 0.9931285991850949, 0.017614007139152118),
            (legendre(64), 32, 0.024350292663424433, 0.048690957009139724),
            (legendre(64), 63, 0.9993050417357722, 0.001783280721696433),
            (normal(8), 4, 0.5390798113513751, 0.37301225767907736),
            (normal(8), 7, 4.1445471861258945, 1.1261453837536777e-4),
            (normal(10), 5, 0.48493570751549764, 0.34464233493201907),
            (normal(10), 9, 4.859462828332312, 4.310652630718287e-6),
        ];
        for (rule, i, node, weight) in known {
            let (of, off) = (rule.len(), if rule.len() < 20 { 0.0 } else { 3e-16 });
            let (upper, lower) = (rule[i], rule[of - 1 - i]);
            assert_eq!((upper.1, lower.1), (weight, weight), "{of} {i}");
            assert!((upper.0 - node).abs() <= off && (lower.0 + node).abs() <= off, "{of} {i}: {upper:?}");
        }
    }
}
