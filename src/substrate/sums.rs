//! Displacements of the feet of all asperities by the forces of all others.

use super::Coupling;
use super::far::Far;
use super::near::{Cells, FEWEST_CELLS, Near, RINGS};
use std::f64::consts::PI;

/// Points of a cell over the square of the reach of near pairs: balances the time of near sums against that of
/// sums on the grid.
const PER_CELL: f64 = 0.75;

/// The sums u_i = Σ_j g_ij f_j over points of a square, as a split of 1/r into what near neighbours do and
/// what a grid does (Ewald 1921).
///
/// Places are in sides of the square, forces in any unit, and displacements in that unit over πE* times the
/// side.
#[derive(Clone, Debug)]
pub struct DisplacementSums {
    coupling: Coupling,
    cells: Cells,
    near: Near,
    far: Far,
    /// What the grid has of the displacement of a foot by its own force.
    own: f64,
    loads: Vec<f64>,
    displacements: Vec<f64>,
}

impl DisplacementSums {
    /// The sums over `points` of the unit square, 0 ≤ x, y < 1, with an error of about `tolerance` times the
    /// largest force over the mean distance.
    pub fn new(coupling: Coupling, points: &[[f64; 2]], tolerance: f64) -> Self {
        // What is left out of near pairs, and of waves: erfc(reach) ≈ exp(−reach²)/(√π reach).
        let reach = libm::log(1.0 / tolerance).sqrt();
        let per_cell = PER_CELL * reach * reach;
        let count = ((points.len() as f64 / per_cell).sqrt() as usize).max(FEWEST_CELLS);
        let cells = Cells::new(count, points);
        let sorted: Vec<[f64; 2]> = cells.order.iter().map(|&i| points[i as usize]).collect();
        let alpha = reach * count as f64 / RINGS as f64;
        let kernel = |square: f64| {
            let r = square.sqrt();
            libm::erfc(alpha * r) / r
        };
        Self {
            coupling,
            near: Near::new(coupling, &cells, &sorted, kernel),
            far: Far::new(coupling, &sorted, alpha, 2.0 * alpha * reach, tolerance),
            own: 2.0 * alpha / PI.sqrt(),
            cells,
            loads: vec![0.0; points.len()],
            displacements: vec![0.0; points.len()],
        }
    }

    /// The points around a place, and how far they reach from it at least, in sides.
    pub fn around(&self, place: [f64; 2]) -> (impl Iterator<Item = u32>, f64) {
        (self.cells.around(self.coupling, place), RINGS as f64 / self.cells.count as f64)
    }

    /// The displacements by `loads`, in the order of the points.
    pub fn apply(&mut self, loads: &[f64], displacements: &mut [f64]) {
        for (own, &i) in self.loads.iter_mut().zip(&self.cells.order) {
            *own = loads[i as usize];
        }
        self.displacements.iter_mut().zip(&self.loads).for_each(|(u, load)| *u = -self.own * load);
        self.near.add(&self.loads, &mut self.displacements);
        self.far.add(&self.loads, &mut self.displacements);
        for (own, &i) in self.displacements.iter().zip(&self.cells.order) {
            displacements[i as usize] = *own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: usize) -> Vec<[f64; 2]> {
        // Weyl's sequence of the plastic number: a distance apart of each other.
        let at = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
        (0..count).map(|i| [at(i, 0.754_877_666_246_693), at(i, 0.569_840_290_998_053_3)]).collect()
    }

    /// The periodic sum by Ewald's formula term by term, with a splitting of its own.
    fn periodic([x, y]: [f64; 2]) -> f64 {
        let a = 2.0_f64;
        let mut sum = -2.0 * PI.sqrt() / a;
        for n in -4..=4_i32 {
            for m in -4..=4_i32 {
                let r = (x - f64::from(n)).hypot(y - f64::from(m));
                sum += if r > 0.0 { libm::erfc(a * r) / r } else { -2.0 * a / PI.sqrt() };
                let k = 2.0 * PI * f64::from(n).hypot(f64::from(m));
                if k > 0.0 {
                    let phase = 2.0 * PI * (f64::from(n) * x + f64::from(m) * y);
                    sum += 2.0 * PI / k * libm::erfc(0.5 * k / a) * phase.cos();
                }
            }
        }
        sum
    }

    fn direct(coupling: Coupling, points: &[[f64; 2]], loads: &[f64]) -> Vec<f64> {
        let n = points.len();
        let pair = |i: usize, j: usize| {
            let [x, y] = [points[i][0] - points[j][0], points[i][1] - points[j][1]];
            match coupling {
                Coupling::Periodic => periodic([x, y]),
                Coupling::Patch => {
                    if i == j {
                        0.0
                    } else {
                        1.0 / x.hypot(y)
                    }
                }
            }
        };
        (0..n).map(|i| (0..n).map(|j| pair(i, j) * loads[j]).sum()).collect()
    }

    #[test]
    fn fast_sums_are_the_direct_ones() {
        for coupling in [Coupling::Periodic, Coupling::Patch] {
            for count in [1, 2, 3, 10, 100, 700] {
                let points = points(count);
                let loads: Vec<f64> = (0..count).map(|i| (i as f64).sin() + 0.3).collect();
                let expected = direct(coupling, &points, &loads);
                let largest = expected.iter().fold(1.0, |most: f64, u| most.max(u.abs()));
                for tolerance in [1e-4, 1e-8, 1e-13] {
                    let mut found = vec![0.0; count];
                    DisplacementSums::new(coupling, &points, tolerance).apply(&loads, &mut found);
                    let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(
                        error <= 10.0 * tolerance * largest,
                        "{coupling:?} {count} {tolerance:e} {:e}",
                        error / largest
                    );
                }
            }
        }
    }

    /// 4ζ(½)β(½), the self term of a square lattice.
    #[test]
    fn the_lattice_constant() {
        let mut found = [0.0];
        DisplacementSums::new(Coupling::Periodic, &[[0.3, 0.9]], 1e-14).apply(&[1.0], &mut found);
        assert!((found[0] + 3.900_264_920_001_959).abs() < 1e-12, "{:e}", found[0] + 3.900_264_920_001_959);
    }
}
