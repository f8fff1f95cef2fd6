//! A function tabulated as polynomials on cells that adapt to it.

use super::chebyshev;
use super::extrema::maximum;
use super::polynomials::estrin;

/// Degree of the polynomial of a cell.
const DEGREE: usize = 7;
const NODES: usize = DEGREE + 1;

/// Places in −1..1, away from the nodes, where a cell is compared with the function.
const CHECKS: [f64; 5] = [-0.995, -0.71, 0.2, 0.56, 0.92];
/// Cells narrower than this share of the whole are not halved any more.
const NARROWEST: f64 = 1e-7;
/// Most cells: what needs more is not smooth, and is left to other means.
const MOST_CELLS: usize = 4096;
/// Places that are looked at together in the search for the end of a run.
const CHUNK: usize = 8;

/// Piecewise polynomial on `begin` ≤ s ≤ `end`.
#[derive(Clone, Debug, Default)]
pub struct Piecewise {
    /// Upper ends of the cells, rising.
    ends: Vec<f64>,
    cells: Vec<Cell>,
}

/// One polynomial and where it holds.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Lower end, itself in the cell only where the table begins.
    low: f64,
    /// Upper end, in the cell.
    high: f64,
    middle: f64,
    inverse_half_width: f64,
    coefficients: [f64; NODES],
    /// The coefficients of the derivative.
    slopes: [f64; NODES],
}

impl Piecewise {
    /// Tabulates `f` on (`begin`, `end`] so that it is met to `tolerance(s, f(s))`, an absolute error. Cells
    /// are halved until they meet it; one that is narrower than `end`·1e-7, or comes after 4096 others, and
    /// does not meet it holds NaN. The function is never evaluated at `begin`.
    pub fn new(f: impl Fn(f64) -> f64, tolerance: impl Fn(f64, f64) -> f64, begin: f64, end: f64) -> Self {
        let [table] = Self::halved((begin, end), NARROWEST * end, |low, high| {
            let cell = Cell::interpolate(&f, low, high);
            ([cell], cell.meets(&f, &tolerance))
        });
        table
    }

    /// Tabulates functions together, all of which `f` gives at places, on (`begin`, `end`] so that each is met to `tolerance` of
    /// its largest value in the cell. Cells are halved until they meet it; one of 2^−`halvings` of the whole, or that comes after
    /// 4096 others, and does not meet it holds NaN. The functions are never evaluated at `begin`.
    pub fn together<const N: usize>(
        mut f: impl FnMut(&[f64]) -> Vec<[f64; N]>,
        tolerance: f64,
        (begin, end): (f64, f64),
        halvings: u32,
    ) -> [Self; N] {
        let narrowest = 1.5 * (end - begin) * (0.5_f64).powi(halvings as i32);
        Self::halved((begin, end), narrowest, |low, high| {
            let places = Cell::places(low, high);
            let samples = f(&places);
            let (at_nodes, checks) = samples.split_at(NODES);
            let cells: [Cell; N] =
                std::array::from_fn(|i| Cell::through(std::array::from_fn(|j| at_nodes[j][i]), (low, high)));
            let is_good = |i: usize| {
                let largest = at_nodes.iter().fold(0.0, |largest, values| maximum(values[i].abs(), largest));
                let off = |(place, values): (&f64, &[f64; N])| (cells[i].value(*place) - values[i]).abs();
                places[NODES..].iter().zip(checks).all(|check| off(check) <= tolerance * largest)
            };
            let are_good = (0..N).all(is_good);
            (cells, are_good)
        })
    }

    /// Tables of cells that `fit` makes between two ends, and says of whether they are good: these that are not are halved unless
    /// they are no wider than `narrowest`.
    fn halved<const N: usize>(
        (begin, end): (f64, f64),
        narrowest: f64,
        mut fit: impl FnMut(f64, f64) -> ([Cell; N], bool),
    ) -> [Self; N] {
        let mut tables = [(); N].map(|()| Self::default());
        if !(end > begin && end.is_finite()) {
            return tables;
        }
        let mut open = vec![(begin, end)];
        while let Some((low, high)) = open.pop() {
            let (mut cells, good) = fit(low, high);
            if !good && high - low > narrowest && tables[0].cells.len() < MOST_CELLS {
                let middle = 0.5 * (low + high);
                open.push((middle, high));
                open.push((low, middle));
                continue;
            }
            if !good {
                cells.iter_mut().for_each(|cell| cell.coefficients = [f64::NAN; NODES]);
            }
            for (table, cell) in tables.iter_mut().zip(cells) {
                table.ends.push(high);
                table.cells.push(cell);
            }
        }
        tables
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether every cell meets the tolerance.
    pub fn is_complete(&self) -> bool {
        self.cells.iter().all(|cell| !cell.coefficients[0].is_nan())
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cell that holds `s`.
    #[inline(always)]
    fn cell(&self, s: f64) -> Option<&Cell> {
        let cell = self.cells.get(self.ends.partition_point(|end| *end < s))?;
        (s > cell.low || s == self.cells[0].low).then_some(cell)
    }

    /// The cell of the first of some places, if there is one, and how many of the first places share it (1
    /// without a cell): many where the places rise or fall.
    #[inline(always)]
    pub fn run(&self, places: &[f64]) -> (Option<&Cell>, usize) {
        match self.cell(places[0]) {
            Some(cell) => (Some(cell), 1 + leading(&places[1..], cell.low, cell.high)),
            None => (None, 1),
        }
    }

    /// The values at places, NaN where there is no cell.
    #[inline(always)]
    pub fn values(&self, places: &[f64], out: &mut [f64]) {
        let mut begin = 0;
        while begin < places.len() {
            let (cell, length) = self.run(&places[begin..]);
            let (places, out) = (&places[begin..begin + length], &mut out[begin..begin + length]);
            begin += length;
            match cell {
                Some(cell) => out.iter_mut().zip(places).for_each(|(value, s)| *value = cell.value(*s)),
                None => out.fill(f64::NAN),
            }
        }
    }
}

/// The number of leading values that are above `low` and not above `high`.
#[inline(always)]
pub fn leading(values: &[f64], low: f64, high: f64) -> usize {
    let inside = |value: &f64| (*value > low) & (*value <= high);
    let mut whole = 0;
    for chunk in values.chunks_exact(CHUNK) {
        if !chunk.iter().fold(true, |all, value| all & inside(value)) {
            break;
        }
        whole += CHUNK;
    }
    whole + values[whole..].iter().take_while(|value| inside(value)).count()
}

impl Cell {
    /// The value at a place in the cell.
    #[inline(always)]
    pub fn value(&self, s: f64) -> f64 {
        estrin(&self.coefficients, (s - self.middle) * self.inverse_half_width)
    }

    /// The derivative at a place in the cell.
    #[inline(always)]
    pub fn slope(&self, s: f64) -> f64 {
        estrin(&self.slopes, (s - self.middle) * self.inverse_half_width)
    }

    /// The interpolant at Chebyshev nodes.
    pub fn interpolate(f: &impl Fn(f64) -> f64, low: f64, high: f64) -> Self {
        let places = Self::places(low, high);
        Self::through(std::array::from_fn(|j| f(places[j])), (low, high))
    }

    /// The Chebyshev nodes of an interval, and after them the places where a cell is compared.
    fn places(low: f64, high: f64) -> [f64; NODES + CHECKS.len()] {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        std::array::from_fn(|j| match j.checked_sub(NODES) {
            None => middle + half * libm::cos(chebyshev::angle(j, NODES)),
            Some(check) => middle + half * CHECKS[check],
        })
    }

    /// The interpolant of samples at the nodes of an interval, corrected once by that of its own rounding errors.
    fn through(samples: [f64; NODES], (low, high): (f64, f64)) -> Self {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let places = Self::places(low, high);
        let powers = |samples: [f64; NODES]| chebyshev::powers::<NODES>(&chebyshev::coefficients(&samples));
        let mut cell = Self {
            low,
            high,
            middle,
            inverse_half_width: 1.0 / half,
            coefficients: powers(samples),
            slopes: [0.0; NODES],
        };
        let rest = powers(std::array::from_fn(|j| samples[j] - cell.value(places[j])));
        cell.coefficients.iter_mut().zip(rest).for_each(|(coefficient, rest)| *coefficient += rest);
        let slope = |i: usize| cell.coefficients.get(i + 1).map_or(0.0, |c| (i + 1) as f64 * c / half);
        cell.slopes = std::array::from_fn(slope);
        cell
    }

    /// The size of its highest Chebyshev polynomial, about by how much it is off, over the largest coefficient.
    pub fn last_term(&self) -> f64 {
        let largest = self.coefficients.iter().fold(0.0, |largest, c| maximum(c.abs(), largest));
        self.coefficients[DEGREE].abs() / (f64::from(1 << (DEGREE - 1)) * largest)
    }

    fn meets(&self, f: &impl Fn(f64) -> f64, tolerance: &impl Fn(f64, f64) -> f64) -> bool {
        CHECKS.iter().all(|&v| {
            let s = self.middle + v / self.inverse_half_width;
            let exact = f(s);
            (self.value(s) - exact).abs() <= tolerance(s, exact)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_its_tolerance_between_the_checks() {
        let f = |s: f64| (1.0 + s).powf(-0.6) + 1e-3 / ((s - 2.0).powi(2) + 1e-2);
        let table = Piecewise::new(f, |_, _| 1e-9, 0.0, 50.0);
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
    fn slopes_are_those_of_the_polynomials() {
        let table = Piecewise::new(f64::sin, |_, _| 1e-12, 1.0, 7.0);
        for i in 0..1000 {
            let s = 1.0 + 0.006 * (f64::from(i) + 0.5);
            let cell = table.cell(s).unwrap();
            let (value, slope) = (cell.value(s), cell.slope(s));
            assert!((value - s.sin()).abs() < 3e-12 && (slope - s.cos()).abs() < 1e-9, "{s}");
        }
    }

    #[test]
    fn runs_cover_all_places_and_know_where_no_cell_is() {
        let table = Piecewise::new(|s| s.sqrt(), |_, value| 1e-8 * value, 0.5, 4.0);
        let places = [0.5, 0.50001, 0.499, f64::NAN, 3.0, 3.00001, 4.0, 4.0001, 0.6];
        let mut values = [0.0; 9];
        table.values(&places, &mut values);
        for (place, value) in places.iter().zip(values) {
            if (0.5..=4.0).contains(place) {
                assert!((value - place.sqrt()).abs() < 3e-8, "{place}");
            } else {
                assert!(value.is_nan(), "{place}");
            }
        }
        assert_eq!(table.run(&[3.0, 3.00001, 3.0, 0.5]).1, 3);
        assert!(Piecewise::new(|s| s, |_, _| 1.0, 0.0, f64::NAN).is_empty());
        // What no polynomial meets is not tabulated.
        let jump = Piecewise::new(|s| if s < 1.0 { 0.0 } else { 1.0 }, |_, _| 1e-9, 0.0, 3.0);
        let mut values = [0.0; 3];
        jump.values(&[0.9, 1.0, 1.1], &mut values);
        assert!(values[0] == 0.0 && values[1].is_nan() && (values[2] - 1.0).abs() < 1e-9, "{values:?}");
    }
}
