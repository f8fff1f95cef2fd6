//! Clenshaw-Curtis quadrature: nodes that include the ends, and of which every other one is a node of half
//! the degree, so that one set of values gives an integral and the integral by fewer nodes.
//!
//! # Formula
//! Nodes cos(jπ/n) on −1..1, j = 0..=n, with the weights (4/n)(c_j/2) Σ' cos(2kjπ/n)/(1 − 4k²) over k =
//! 0..=n/2, where the first and last term of the sum and the weights of the ends count half (Clenshaw and
//! Curtis, Numer. Math. 2 (1960) 197).

use std::f64::consts::PI;

/// A node of a panel, its weight, and its weight in the rule of half the degree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Place of the node.
    pub place: f64,
    /// Weight of the node.
    pub weight: f64,
    /// Weight among every other node; 0 for those between.
    pub coarse: f64,
}

/// The nodes of degree `n`, a multiple of 4, on `low..high`, rising.
pub fn nodes(low: f64, high: f64, n: usize) -> Vec<Node> {
    let half = 0.5 * (high - low);
    let node = |j: usize| {
        let place = 0.5 * (low + high) - half * libm::cos(j as f64 * PI / n as f64);
        let coarse = if j.is_multiple_of(2) { half * weight(j / 2, n / 2) } else { 0.0 };
        Node { place, weight: half * weight(j, n), coarse }
    };
    (0..=n).map(node).collect()
}

/// The weight of the node `j` on −1..1.
fn weight(j: usize, n: usize) -> f64 {
    let term = |k: usize| {
        let ends = if k == 0 || 2 * k == n { 0.5 } else { 1.0 };
        ends * libm::cos(2.0 * PI * (j * k) as f64 / n as f64) / (1.0 - 4.0 * (k * k) as f64)
    };
    let ends = if j == 0 || j == n { 0.5 } else { 1.0 };
    4.0 / n as f64 * ends * (0..=n / 2).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_the_degree_are_exact() {
        let nodes = nodes(-1.0, 3.0, 16);
        assert_eq!((nodes[0].place, nodes[16].place, nodes.len()), (-1.0, 3.0, 17));
        for power in 0..=16 {
            let exact = (3_f64.powi(power + 1) - (-1_f64).powi(power + 1)) / f64::from(power + 1);
            let sum =
                |weight: fn(&Node) -> f64| nodes.iter().map(|n| weight(n) * n.place.powi(power)).sum::<f64>();
            assert!((sum(|n| n.weight) / exact - 1.0).abs() < 1e-13, "{power}");
            assert!(power > 8 || (sum(|n| n.coarse) / exact - 1.0).abs() < 1e-13, "{power}");
        }
    }
}
