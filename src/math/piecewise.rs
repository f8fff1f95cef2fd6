//! A function tabulated as polynomials on cells that adapt to it.

use super::polynomials::horner;
use multiversion::multiversion;

/// Degree of the polynomial of a cell.
const DEGREE: usize = 7;
const NODES: usize = DEGREE + 1;

/// Places in −1..1, away from the nodes, where a cell is compared with the function.
const CHECKS: [f64; 5] = [-0.995, -0.71, 0.2, 0.56, 0.92];

/// Piecewise polynomial on 0 ≤ s ≤ `end`.
#[derive(Clone, Debug, Default)]
pub struct Piecewise {
    /// Upper ends of the cells, rising.
    ends: Vec<f64>,
    cells: Vec<Cell>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    middle: f64,
    inverse_half_width: f64,
    coefficients: [f64; NODES],
}

impl Piecewise {
    /// Tabulates `f` on (0, `end`] so that it is met to `tolerance(s, f(s))`, an absolute error. Cells are halved until
    /// they meet it or are narrower than `end`·1e-7; the function is never evaluated at 0.
    pub fn new(f: impl Fn(f64) -> f64, tolerance: impl Fn(f64, f64) -> f64, end: f64) -> Self {
        let mut table = Self::default();
        if !(end > 0.0 && end.is_finite()) {
            return table;
        }
        let mut open = vec![(0.0, end)];
        while let Some((low, high)) = open.pop() {
            let cell = Cell::interpolate(&f, low, high);
            if high - low > 1e-7 * end && !cell.meets(&f, &tolerance) {
                let middle = 0.5 * (low + high);
                open.push((middle, high));
                open.push((low, middle));
            } else {
                table.ends.push(high);
                table.cells.push(cell);
            }
        }
        table
    }

    /// The largest argument covered, 0 for an empty table.
    pub fn end(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cell that holds `s`, searched outwards from cell `near`.
    fn cell(&self, s: f64, near: usize) -> usize {
        let mut i = near;
        while i + 1 < self.ends.len() && s > self.ends[i] {
            i += 1;
        }
        while i > 0 && s <= self.ends[i - 1] {
            i -= 1;
        }
        i
    }

    /// The values at places, run by run of those that share a cell: long runs where the places rise. NaN beyond the end.
    pub fn values(&self, places: &[f64], out: &mut [f64]) {
        let (end, mut cell, mut begin) = (self.end(), 0, 0);
        while begin < places.len() {
            if !(places[begin] < end) {
                out[begin] = f64::NAN;
                begin += 1;
                continue;
            }
            cell = self.cell(places[begin], cell);
            let low = if cell == 0 { f64::NEG_INFINITY } else { self.ends[cell - 1] };
            let high = self.ends[cell];
            let shares = |s: &&f64| **s > low && **s <= high && **s < end;
            let run = begin..begin + places[begin..].iter().take_while(shares).count().max(1);
            polynomial(&self.cells[cell], &places[run.clone()], &mut out[run.clone()]);
            begin = run.end;
        }
    }
}

/// A polynomial at places inside its cell.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512cd+avx512dq+avx512vl", "x86_64+avx2"))]
fn polynomial(cell: &Cell, places: &[f64], out: &mut [f64]) {
    for (value, &s) in out.iter_mut().zip(places) {
        *value = horner(&cell.coefficients, (s - cell.middle) * cell.inverse_half_width);
    }
}

impl Cell {
    fn interpolate(f: &impl Fn(f64) -> f64, low: f64, high: f64) -> Self {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let angle = |j: usize| std::f64::consts::PI * (j as f64 + 0.5) / NODES as f64;
        let samples: [f64; NODES] = std::array::from_fn(|j| f(middle + half * libm::cos(angle(j))));
        // Chebyshev coefficients by the discrete orthogonality of the nodes, then powers by T_{n+1} = 2xT_n − T_{n−1}.
        let mut coefficients = [0.0; NODES];
        let (mut before, mut current) = ([0.0; NODES], [0.0; NODES]);
        current[0] = 1.0;
        for n in 0..NODES {
            let scale = if n == 0 { 1.0 } else { 2.0 } / NODES as f64;
            let c = scale * (0..NODES).map(|j| samples[j] * libm::cos(n as f64 * angle(j))).sum::<f64>();
            for i in 0..NODES {
                coefficients[i] += c * current[i];
            }
            let factor = if n == 0 { 1.0 } else { 2.0 };
            let next = std::array::from_fn(|i| if i == 0 { -before[0] } else { factor * current[i - 1] - before[i] });
            before = current;
            current = next;
        }
        Self { middle, inverse_half_width: 1.0 / half, coefficients }
    }

    fn meets(&self, f: &impl Fn(f64) -> f64, tolerance: &impl Fn(f64, f64) -> f64) -> bool {
        CHECKS.iter().all(|&v| {
            let s = self.middle + v / self.inverse_half_width;
            let exact = f(s);
            (horner(&self.coefficients, v) - exact).abs() <= tolerance(s, exact)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_its_tolerance_between_the_checks() {
        let f = |s: f64| (1.0 + s).powf(-0.6) + 1e-3 / ((s - 2.0).powi(2) + 1e-2);
        let table = Piecewise::new(f, |_, _| 1e-9, 50.0);
        let places: Vec<f64> = (0..100_000).map(|i| f64::from(i) * 50.0 / 100_000.0).collect();
        let mut values = vec![0.0; places.len()];
        table.values(&places, &mut values);
        for (&s, value) in places.iter().zip(&values) {
            assert!((value - f(s)).abs() < 3e-9, "{s}");
        }
        // The same bits in any order; nothing beyond the end.
        for (&s, value) in places.iter().zip(&values).rev().step_by(77) {
            let mut alone = [0.0, 0.0];
            table.values(&[s, 50.1], &mut alone);
            assert_eq!(alone[0].to_bits(), value.to_bits());
            assert!(alone[1].is_nan());
        }
        assert!(table.len() < 60, "{}", table.len());
    }

    #[test]
    fn the_search_finds_the_same_cell_from_anywhere() {
        let table = Piecewise::new(|s| s.sqrt(), |_, _| 1e-8, 4.0);
        for s in [0.0, 1e-12, 0.3, 3.9999, 4.0] {
            let from_start = table.cell(s, 0);
            assert_eq!(from_start, table.cell(s, table.len() - 1));
        }
        assert!(Piecewise::new(|s| s, |_, _| 1.0, f64::NAN).is_empty());
    }
}
