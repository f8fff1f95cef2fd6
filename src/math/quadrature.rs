//! Adaptive Gauss-Legendre quadrature of vector-valued functions.

use super::gauss::legendre;
use std::sync::LazyLock;

/// Nodes of a panel.
pub const NODES: usize = 20;

/// Bisections after which an integral is taken as it is, with the error that it then has: an integrand whose
/// noise is above the tolerance would never meet it.
const MAX_BISECTIONS: usize = 300;

/// Nodes and weights of the rule on −1..1.
#[derive(Clone, Debug)]
pub struct Rule {
    nodes: [f64; NODES],
    weights: [f64; NODES],
}

/// A panel, integrated in two halves.
struct Panel<const N: usize> {
    low: f64,
    high: f64,
    halves: [[f64; N]; 2],
    /// |halves − whole|.
    error: [f64; N],
}

impl<const N: usize> Panel<N> {
    fn value(&self, component: usize) -> f64 {
        self.halves[0][component] + self.halves[1][component]
    }
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
        let pairs = legendre(NODES);
        Self { nodes: std::array::from_fn(|i| pairs[i].0), weights: std::array::from_fn(|i| pairs[i].1) }
    }
}

impl Rule {
    /// The rule, whose nodes are found once.
    pub fn shared() -> &'static Self {
        static RULE: LazyLock<Rule> = LazyLock::new(Rule::default);
        &RULE
    }

    /// The places of the rule on a panel, and their weights.
    pub fn places(&self, low: f64, high: f64) -> [(f64, f64); NODES] {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        std::array::from_fn(|i| (middle + half * self.nodes[i], half * self.weights[i]))
    }

    /// ∫f over consecutive panels `breaks[i]..breaks[i + 1]`. The panel with the largest error is bisected
    /// until the errors of all panels add up to at most `tolerance` times the integral of |panel|, component
    /// by component.
    ///
    /// `f` fills the values at [`NODES`] places at once.
    pub fn integrate<const N: usize>(
        &self,
        breaks: &[f64],
        tolerance: f64,
        mut f: impl FnMut(&[f64; NODES], &mut [[f64; N]; NODES]),
    ) -> Integral<N> {
        let mut panels: Vec<Panel<N>> = breaks
            .windows(2)
            .map(|ends| {
                let whole = self.panel(ends[0], ends[1], &mut f);
                self.halved(ends[0], ends[1], &whole, &mut f)
            })
            .collect();
        for _ in 0..MAX_BISECTIONS {
            let sum = |part: fn(&Panel<N>, usize) -> f64| -> [f64; N] {
                std::array::from_fn(|c| panels.iter().map(|panel| part(panel, c)).sum())
            };
            let (size, error) = (sum(|panel, c| panel.value(c).abs()), sum(|panel, c| panel.error[c]));
            let open: Vec<usize> = (0..N).filter(|&c| error[c] > tolerance * size[c]).collect();
            let weight =
                |panel: &Panel<N>| open.iter().map(|&c| panel.error[c] / size[c]).fold(0.0, f64::max);
            let worst = (0..panels.len()).max_by(|&i, &j| weight(&panels[i]).total_cmp(&weight(&panels[j])));
            let Some(worst) = worst.filter(|_| !open.is_empty()) else { break };
            let Panel { low, high, halves, .. } = panels.swap_remove(worst);
            let middle = 0.5 * (low + high);
            panels.push(self.halved(low, middle, &halves[0], &mut f));
            panels.push(self.halved(middle, high, &halves[1], &mut f));
        }
        panels.sort_by(|a, b| a.low.total_cmp(&b.low));
        Integral {
            value: std::array::from_fn(|c| panels.iter().map(|panel| panel.value(c)).sum()),
            error: std::array::from_fn(|c| panels.iter().map(|panel| panel.error[c]).sum()),
        }
    }

    fn halved<const N: usize>(
        &self,
        low: f64,
        high: f64,
        whole: &[f64; N],
        f: &mut impl FnMut(&[f64; NODES], &mut [[f64; N]; NODES]),
    ) -> Panel<N> {
        let middle = 0.5 * (low + high);
        let halves = [self.panel(low, middle, f), self.panel(middle, high, f)];
        let error = std::array::from_fn(|c| (halves[0][c] + halves[1][c] - whole[c]).abs());
        Panel { low, high, halves, error }
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
    fn noise_above_the_tolerance_ends() {
        let mut evaluations = 0;
        let integral = Rule::default().integrate(&[0.0, 1.0], 1e-13, |places, values| {
            evaluations += 1;
            for (x, value) in places.iter().zip(values.iter_mut()) {
                *value = [1.0 + 1e-6 * (1e9 * x).sin()];
            }
        });
        assert!(evaluations < 2000, "{evaluations}");
        assert!((integral.value[0] - 1.0).abs() < 1e-6 && integral.error[0] > 1e-13);
    }

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
