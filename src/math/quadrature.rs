//! Adaptive Gauss-Legendre quadrature of vector-valued functions.

use gauss_quad::GaussLegendre;
use std::num::NonZeroUsize;

/// Nodes of a panel.
pub const NODES: usize = 20;

/// Halvings of a panel after which it is taken as it is.
const MAX_DEPTH: u32 = 30;

/// Nodes and weights of the rule on −1..1.
#[derive(Clone, Debug)]
pub struct Rule {
    nodes: [f64; NODES],
    weights: [f64; NODES],
}

/// Integrals and the bounds of their errors.
#[derive(Clone, Copy, Debug)]
pub struct Integral<const N: usize> {
    /// The integrals.
    pub value: [f64; N],
    /// Sum over the panels of |panel − its halves|, which bounds the error of the less accurate of the two.
    pub error: [f64; N],
}

impl Default for Rule {
    fn default() -> Self {
        let rule = GaussLegendre::new(NonZeroUsize::new(NODES).expect("a rule has nodes"));
        let pairs = rule.as_node_weight_pairs();
        Self { nodes: std::array::from_fn(|i| pairs[i].0), weights: std::array::from_fn(|i| pairs[i].1) }
    }
}

impl Rule {
    /// ∫f over consecutive panels `breaks[i]..breaks[i + 1]`, each halved until it agrees with its halves to `tolerance`
    /// times the integral of |panel| over all panels, component by component.
    ///
    /// `f` fills the values at [`NODES`] places at once.
    pub fn integrate<const N: usize>(
        &self,
        breaks: &[f64],
        tolerance: f64,
        mut f: impl FnMut(&[f64; NODES], &mut [[f64; N]; NODES]),
    ) -> Integral<N> {
        let coarse: Vec<[f64; N]> = breaks.windows(2).map(|panel| self.panel(panel[0], panel[1], &mut f)).collect();
        let allowed: [f64; N] =
            std::array::from_fn(|c| tolerance * coarse.iter().map(|panel| panel[c].abs()).sum::<f64>());
        let mut total = Integral { value: [0.0; N], error: [0.0; N] };
        for (ends, whole) in breaks.windows(2).zip(&coarse) {
            self.refine(ends[0], ends[1], whole, &allowed, 0, &mut f, &mut total);
        }
        total
    }

    #[expect(clippy::too_many_arguments, reason = "one private recursion, its state spelled out")]
    fn refine<const N: usize>(
        &self,
        low: f64,
        high: f64,
        whole: &[f64; N],
        allowed: &[f64; N],
        depth: u32,
        f: &mut impl FnMut(&[f64; NODES], &mut [[f64; N]; NODES]),
        total: &mut Integral<N>,
    ) {
        let middle = 0.5 * (low + high);
        let halves = [self.panel(low, middle, f), self.panel(middle, high, f)];
        let error: [f64; N] = std::array::from_fn(|c| (halves[0][c] + halves[1][c] - whole[c]).abs());
        // Once per halving half of what is allowed, and never less than rounding.
        let share = 0.5_f64.powi(depth.min(10) as i32);
        if depth == MAX_DEPTH || (0..N).all(|c| error[c] <= (allowed[c] * share).max(1e-15 * whole[c].abs())) {
            for c in 0..N {
                total.value[c] += halves[0][c] + halves[1][c];
                total.error[c] += error[c];
            }
        } else {
            self.refine(low, middle, &halves[0], allowed, depth + 1, f, total);
            self.refine(middle, high, &halves[1], allowed, depth + 1, f, total);
        }
    }

    fn panel<const N: usize>(
        &self,
        low: f64,
        high: f64,
        f: &mut impl FnMut(&[f64; NODES], &mut [[f64; N]; NODES]),
    ) -> [f64; N] {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let places = self.nodes.map(|node| middle + half * node);
        let mut values = [[0.0; N]; NODES];
        f(&places, &mut values);
        std::array::from_fn(|c| half * (0..NODES).map(|i| self.weights[i] * values[i][c]).sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_closed_forms_and_bounds_its_error() {
        let rule = Rule::default();
        let integral = rule.integrate(&[0.0, 1.0, 4.0], 1e-13, |places, values| {
            for (x, value) in places.iter().zip(values.iter_mut()) {
                *value = [x.exp(), x.sqrt(), 1.0 / ((x - 2.0) * (x - 2.0) + 1e-4)];
            }
        });
        let exact = [4.0_f64.exp() - 1.0, 16.0 / 3.0, 200.0 * 200.0_f64.atan()];
        for (c, exact) in exact.into_iter().enumerate() {
            let error = (integral.value[c] - exact).abs();
            assert!(error <= 1e-12 * exact, "{c}: {error:e}");
            assert!(error <= integral.error[c] + 1e-14 * exact, "{c}: {error:e} {:e}", integral.error[c]);
        }
    }
}
