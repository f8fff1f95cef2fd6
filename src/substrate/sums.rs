//! Displacements of the feet of all asperities by the forces of all others.

use super::far::Far;
use super::near::{Cells, FEWEST_CELLS, LANES, Near, RINGS};
use super::{Coupling, Influence};
use crate::math::real::Real;

/// Points of a cell over the square of the reach of near pairs, where pairs are kept and where they are computed for each sum, each of
/// a repeated square and of one alone, the grid of which is twice as wide: balances the time of near sums against the time of sums on
/// the grid. Where pairs are computed, 0.5 and 0.85 would be a tenth faster, with a grid that is a quarter larger.
const PER_CELL: [[f64; 2]; 2] = [[1.0, 1.7], [0.65, 1.1]];
/// Most points whose windows on the grid are kept in double precision: 20 MB.
const MOST_WINDOWS: usize = 80_000;
/// Fewest points of sums that two threads take faster than one.
const WORTH_SHARING: usize = 4000;

/// The sums u_i = Σ_j g_ij f_j over points of a square, as a split of 1/r, its slopes, or 1/r³, into a part of near
/// neighbours and a part on a grid (Ewald 1921).
///
/// Places are in sides of the square, forces in any unit, and displacements in that unit over πE* times the
/// side; slopes in that over the side, curvatures in that over its square.
#[derive(Clone, Debug)]
pub struct DisplacementSums<T = f64> {
    coupling: Coupling,
    cells: Cells,
    near: Near<T>,
    far: Far<T>,
    /// The part on the grid of the displacement of a foot by its own force.
    own: T,
    loads: Vec<T>,
    displacements: Vec<T>,
    /// Part of the displacements on the grid.
    smooth: Vec<T>,
    is_shared: bool,
}

impl<T: Real> DisplacementSums<T> {
    /// The sums over `points` of the unit square, 0 ≤ x, y < 1, with an error of about `tolerance` times the
    /// largest force over the mean distance.
    pub fn new(coupling: Coupling, influence: Influence, points: &[[f64; 2]], tolerance: f64) -> Self {
        let fewest = reach(tolerance) * FEWEST_CELLS as f64 / RINGS as f64;
        let tolerance = influence.of_parts(tolerance, points.len(), fewest);
        let reach = reach(tolerance);
        let per_cell = |are_kept: bool| {
            let alone = usize::from(coupling == Coupling::Patch);
            PER_CELL[usize::from(!are_kept)][alone] * reach * reach
        };
        let are_kept = Near::<T>::are_kept(points.len() as f64 * per_cell(true));
        let per_cell = per_cell(are_kept);
        let count = ((points.len() as f64 / per_cell).sqrt() as usize).max(FEWEST_CELLS);
        let cells = Cells::new(count, points);
        let sorted: Vec<[f64; 2]> = cells.order.iter().map(|&i| points[i as usize]).collect();
        let alpha = reach * count as f64 / RINGS as f64;
        let are_windows_kept = are_kept || points.len() <= MOST_WINDOWS;
        Self {
            coupling,
            near: Near::new(coupling, (influence, alpha), (&cells, &sorted), are_kept),
            far: Far::new(
                coupling,
                (influence, alpha),
                (&sorted, are_windows_kept),
                2.0 * alpha * reach,
                tolerance,
            ),
            own: T::of(influence.own(alpha)),
            cells,
            loads: vec![T::zero(); points.len() + LANES],
            displacements: vec![T::zero(); points.len() + LANES],
            smooth: vec![T::zero(); points.len()],
            is_shared: false,
        }
    }

    /// Lets another thread of the pool take a part of the sums, if that is worth it, or not: for a pool that
    /// has one to spare. The sums are the same to the bit.
    pub fn share(&mut self, is_shared: bool) {
        self.is_shared = is_shared && self.smooth.len() >= WORTH_SHARING;
    }

    /// The points around a place, and how far they reach from it at least, in sides.
    pub fn around(&self, place: [f64; 2]) -> (impl Iterator<Item = u32>, f64) {
        (self.cells.around(self.coupling, place), self.cells.reach())
    }

    /// The displacements by `loads`, in the order of the points.
    pub fn apply(&mut self, loads: &[f64], displacements: &mut [f64]) {
        for (own, &i) in self.loads.iter_mut().zip(&self.cells.order) {
            *own = T::of(loads[i as usize]);
        }
        let Self { near, far, loads, displacements: close, smooth, .. } = self;
        let mut near = || {
            close.iter_mut().zip(&*loads).for_each(|(u, load)| *u = -self.own * *load);
            near.add(loads, close, self.is_shared);
        };
        let mut far = || far.displace(loads, smooth, self.is_shared);
        if self.is_shared {
            rayon::join(near, far);
        } else {
            near();
            far();
        }
        for ((close, smooth), &i) in close.iter().zip(&*smooth).zip(&self.cells.order) {
            displacements[i as usize] = (*close + *smooth).value();
        }
    }
}

/// αr beyond which near pairs, and k/2α beyond which waves, are left out: erfc(reach) ≈ exp(−reach²)/(√π reach).
fn reach(tolerance: f64) -> f64 {
    libm::log(1.0 / tolerance).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn points(count: usize) -> Vec<[f64; 2]> {
        // Weyl's sequence of the plastic number: a distance apart of each other.
        let at = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
        (0..count).map(|i| [at(i, 0.754_877_666_246_693), at(i, 0.569_840_290_998_053_3)]).collect()
    }

    /// The periodic sum by Ewald's formula term by term, with a splitting of its own.
    fn periodic(influence: Influence, [x, y]: [f64; 2]) -> f64 {
        let a = 2.0_f64;
        let mut sum = match influence {
            Influence::Displacement => -2.0 * PI.sqrt() / a,
            _ => 0.0,
        };
        for n in -4..=4_i32 {
            for m in -4..=4_i32 {
                let way = [x - f64::from(n), y - f64::from(m)];
                let r = way[0].hypot(way[1]);
                let (erfc, gaussian) = (libm::erfc(a * r), 2.0 * a / PI.sqrt() * (-a * a * r * r).exp());
                sum += match influence {
                    Influence::Displacement if r == 0.0 => -2.0 * a / PI.sqrt(),
                    Influence::Displacement => erfc / r,
                    Influence::SlopeX | Influence::SlopeY if r == 0.0 => 0.0,
                    Influence::SlopeX => -way[0] * (erfc / r.powi(3) + gaussian / (r * r)),
                    Influence::SlopeY => -way[1] * (erfc / r.powi(3) + gaussian / (r * r)),
                    Influence::Curvature if r == 0.0 => 8.0 * a.powi(3) / (3.0 * PI.sqrt()),
                    Influence::Curvature => erfc / r.powi(3) + gaussian * (r.powi(-2) + 2.0 * a * a),
                };
                let k = 2.0 * PI * f64::from(n).hypot(f64::from(m));
                if k > 0.0 {
                    let phase = 2.0 * PI * (f64::from(n) * x + f64::from(m) * y);
                    let wave = match influence {
                        Influence::Displacement => phase.cos(),
                        Influence::SlopeX => -2.0 * PI * f64::from(n) * phase.sin(),
                        Influence::SlopeY => -2.0 * PI * f64::from(m) * phase.sin(),
                        Influence::Curvature => -k * k * phase.cos(),
                    };
                    sum += wave * 2.0 * PI / k * libm::erfc(0.5 * k / a);
                }
            }
        }
        sum
    }

    fn direct(coupling: Coupling, influence: Influence, points: &[[f64; 2]], loads: &[f64]) -> Vec<f64> {
        let n = points.len();
        let power = if influence == Influence::Displacement { -1 } else { -3 };
        let sign = if influence.is_odd() { -1.0 } else { 1.0 };
        let pair = |i: usize, j: usize| {
            let [x, y] = [points[i][0] - points[j][0], points[i][1] - points[j][1]];
            match coupling {
                Coupling::Periodic => periodic(influence, [x, y]),
                Coupling::Patch => {
                    if i == j {
                        0.0
                    } else {
                        sign * influence.along([x, y]) * x.hypot(y).powi(power)
                    }
                }
            }
        };
        let mut sums = vec![0.0; n];
        for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let influence = pair(i, j);
            sums[i] += influence * loads[j];
            sums[j] += if i == j { 0.0 } else { sign * influence * loads[i] };
        }
        sums
    }

    #[test]
    fn fast_sums_are_the_direct_ones() {
        let couplings = [Coupling::Periodic, Coupling::Patch];
        use Influence::{Curvature, Displacement, SlopeX, SlopeY};
        let influences = [Displacement, SlopeX, SlopeY, Curvature];
        for (coupling, influence) in couplings.into_iter().flat_map(|own| influences.map(|one| (own, one))) {
            for count in [1, 2, 3, 10, 200] {
                let points = points(count);
                let loads: Vec<f64> = (0..count).map(|i| (i as f64).sin() + 0.3).collect();
                let expected = direct(coupling, influence, &points, &loads);
                // Of one to three points the sum of 1/r³ is some 10, its parts are 5000: rounding, 1e-14, is that of the parts.
                let least = if influence == Influence::Curvature { 100.0 } else { 1.0 };
                let largest = expected.iter().fold(least, |most: f64, u| most.max(u.abs()));
                for (tolerance, is_single) in [(1e-3, true), (1e-4, false), (1e-8, false), (1e-13, false)] {
                    let mut found = vec![0.0; count];
                    if is_single {
                        DisplacementSums::<f32>::new(coupling, influence, &points, tolerance)
                            .apply(&loads, &mut found);
                    } else {
                        DisplacementSums::<f64>::new(coupling, influence, &points, tolerance)
                            .apply(&loads, &mut found);
                    }
                    let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(
                        error <= 10.0 * tolerance * largest,
                        "{coupling:?} {influence:?} {count} {tolerance:e} {:e}",
                        error / largest
                    );
                }
            }
        }
    }

    /// Sums by one thread and by two.
    fn by_one_and_two<T: Real>(coupling: Coupling, count: usize, tolerance: f64) -> [Vec<f64>; 2] {
        let points = points(count);
        let loads: Vec<f64> = (0..count).map(|i| (i as f64).sin() + 0.3).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut sums = DisplacementSums::<T>::new(coupling, Influence::Displacement, &points, tolerance);
        [false, true].map(|is_shared| {
            let mut found = vec![0.0; count];
            sums.share(is_shared);
            assert_eq!(sums.is_shared, is_shared);
            pool.install(|| sums.apply(&loads, &mut found));
            found
        })
    }

    #[test]
    fn two_threads_make_the_same_bits() {
        for coupling in [Coupling::Periodic, Coupling::Patch] {
            let [one, two] = by_one_and_two::<f32>(coupling, WORTH_SHARING, 1e-3);
            assert_eq!(one, two, "{coupling:?}");
            // Pairs are computed.
            let count = 30_000;
            assert!(!Near::<f64>::are_kept(PER_CELL[0][0] * count as f64 * reach(1e-11).powi(2)));
            let [one, two] = by_one_and_two::<f64>(coupling, count, 1e-11);
            assert_eq!(one, two, "{coupling:?}");
        }
    }

    #[test]
    fn windows_are_kept_and_computed_alike() {
        use Coupling::{Patch, Periodic};
        let points = points(200);
        let loads: Vec<f64> = (0..200).map(|i| f64::from(i).sin() + 0.3).collect();
        for (coupling, tolerance) in [(Periodic, 1e-3), (Patch, 1e-8), (Periodic, 1e-13)] {
            let alpha = 2.0 * reach(tolerance);
            let (influence, shortest) = ((Influence::Displacement, alpha), 2.0 * alpha * reach(tolerance));
            let [kept, computed] = [true, false].map(|are_kept| {
                let mut far = Far::<f64>::new(coupling, influence, (&points, are_kept), shortest, tolerance);
                let mut found = vec![0.0; points.len()];
                far.displace(&loads, &mut found, false);
                found
            });
            assert_eq!(kept, computed, "{coupling:?} {tolerance:e}");
        }
    }

    /// Self terms of a square lattice: 4ζ(½)β(½), and 4ζ(3/2)β(3/2), the sum of 1/n³.
    #[test]
    fn the_lattice_constant() {
        // Parts of 1/r³ are 5000 times their sum.
        for (influence, expected, tolerance) in [
            (Influence::Displacement, -3.900_264_920_001_956, 1e-12),
            (Influence::Curvature, 9.033_621_683_100_95, 2e-11),
        ] {
            let (mut found, place) = ([0.0], [[0.3, 0.9]]);
            DisplacementSums::<f64>::new(Coupling::Periodic, influence, &place, 1e-14)
                .apply(&[1.0], &mut found);
            let off = (found[0] - expected).abs();
            assert!(off < tolerance, "{influence:?} {off:e}");
        }
    }
}
