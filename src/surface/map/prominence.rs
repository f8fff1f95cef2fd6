//! Prominence: how high a summit is above the saddle on the way to higher ground.

use super::{HeightMap, Summit};
use rayon::prelude::*;
use std::collections::HashSet;

/// The parent of a pixel that is not flooded yet.
const DRY: u32 = u32::MAX;

/// Pools of flooded pixels, each with its peak for a root.
struct Pools {
    parent: Vec<u32>,
    /// Peaks whose lowest pixel is known.
    drained: HashSet<u32>,
}

impl Pools {
    fn new(pixels: usize) -> Self {
        Self { parent: vec![DRY; pixels], drained: HashSet::new() }
    }

    /// The peak of the pool of a flooded pixel.
    fn of(&mut self, mut pixel: u32) -> u32 {
        while self.parent[pixel as usize] != pixel {
            let above = self.parent[self.parent[pixel as usize] as usize];
            self.parent[pixel as usize] = above;
            pixel = above;
        }
        pixel
    }
}

impl HeightMap {
    /// Topographic prominence of summits of the map, m, positive: height above the key saddle, the highest
    /// one over which a path from pixel to pixel, 8-connected, leads to higher ground.
    ///
    /// All known heights are ground, on the border too; paths lead over known heights alone. A saddle on the
    /// border or next to missing heights counts as it is: beyond there may be a higher one, so that the
    /// prominence is an upper bound. The highest summit that known heights connect has its height above the
    /// lowest of these. Among equally high pixels the first, row by row, is the higher one.
    ///
    /// Pixels are flooded from the highest down, with a union-find of pools: O(N log N) by the sort.
    pub fn prominences(&self, summits: &[Summit]) -> Vec<f64> {
        let mut order: Vec<u32> =
            (0..self.heights.len() as u32).filter(|&i| !self.heights[i as usize].is_nan()).collect();
        let height = |pixel: u32| self.heights[pixel as usize];
        order.par_sort_unstable_by(|&a, &b| height(b).total_cmp(&height(a)).then(a.cmp(&b)));
        let mut pools = Pools::new(self.heights.len());
        // Saddles by the pixel of the peak that is the lower one there.
        let mut saddles: Vec<(u32, f64)> = Vec::new();
        for &pixel in &order {
            let mut pool = None;
            for neighbour in self.around(pixel as usize) {
                if pools.parent[neighbour] == DRY {
                    continue;
                }
                let other = pools.of(neighbour as u32);
                match pool {
                    None => pool = Some(other),
                    Some(own) if own == other => (),
                    Some(own) => {
                        let (higher, lower) =
                            if self.is_higher(own, other) { (own, other) } else { (other, own) };
                        saddles.push((lower, height(pixel)));
                        pools.parent[lower as usize] = higher;
                        pool = Some(higher);
                    }
                }
            }
            pools.parent[pixel as usize] = pool.unwrap_or(pixel);
        }
        self.above(summits, saddles, pools, &order)
    }

    /// Heights of summits above their saddles; above the lowest pixel of their pool where they have none.
    fn above(
        &self,
        summits: &[Summit],
        mut saddles: Vec<(u32, f64)>,
        mut pools: Pools,
        order: &[u32],
    ) -> Vec<f64> {
        let mut last = DRY;
        for &pixel in order.iter().rev() {
            let peak = pools.of(pixel);
            if peak != last && pools.drained.insert(peak) {
                saddles.push((peak, self.heights[pixel as usize]));
            }
            last = peak;
        }
        saddles.sort_unstable_by_key(|(peak, _)| *peak);
        let above = |summit: &Summit| {
            let peak = (summit.row * self.columns + summit.column) as u32;
            let place = saddles.binary_search_by_key(&peak, |(peak, _)| *peak);
            place.map_or(0.0, |place| summit.height - saddles[place].1)
        };
        summits.iter().map(above).collect()
    }

    /// Whether a pixel is higher than another, or equally high and before it.
    fn is_higher(&self, one: u32, other: u32) -> bool {
        let (a, b) = (self.heights[one as usize], self.heights[other as usize]);
        a > b || a == b && one < other
    }

    /// The pixels around a pixel.
    fn around(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        let (row, column, columns) = (pixel / self.columns, pixel % self.columns, self.columns);
        let near = |place: usize, count: usize| place.saturating_sub(1)..=(place + 1).min(count - 1);
        let along = near(column, columns);
        near(row, self.rows)
            .flat_map(move |i| along.clone().map(move |j| i * columns + j))
            .filter(move |&other| other != pixel)
    }
}

#[cfg(test)]
mod tests {
    use crate::surface::map::HeightMap;

    /// Numbers without a pattern.
    fn scattered(seed: u64) -> impl FnMut() -> u64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state >> 20
        }
    }

    /// The prominence of a pixel by its definition: the ground is flooded to each level in turn, and the
    /// lowest loss of height at which higher ground is reached counts; the whole of what is connected, if none.
    fn brute(map: &HeightMap, peak: usize) -> f64 {
        let mut levels: Vec<f64> = map.heights.iter().copied().filter(|z| !z.is_nan()).collect();
        levels.sort_by(|a, b| b.total_cmp(a));
        let mut lowest = map.heights[peak];
        for level in levels.into_iter().filter(|level| *level <= map.heights[peak]) {
            let (mut reached, mut next) = (vec![false; map.heights.len()], vec![peak]);
            while let Some(pixel) = next.pop() {
                if std::mem::replace(&mut reached[pixel], true) {
                    continue;
                }
                next.extend(map.around(pixel).filter(|&other| map.heights[other] >= level));
            }
            let flooded = || (0..reached.len()).filter(|&pixel| reached[pixel]);
            if flooded().any(|pixel| map.is_higher(pixel as u32, peak as u32)) {
                return map.heights[peak] - level;
            }
            lowest = flooded().map(|pixel| map.heights[pixel]).fold(lowest, f64::min);
        }
        map.heights[peak] - lowest
    }

    /// Small maps of few levels and of many, with missing heights: every summit, and every pixel that is no
    /// summit has none above its neighbours.
    #[test]
    fn prominence_is_that_of_brute_force() {
        let mut seen = 0;
        for seed in 0..60 {
            let (mut next, levels) = (scattered(seed + 1), [4, 12, 1 << 19][seed as usize % 3]);
            let heights = (0..99).map(|_| if next() % 23 == 0 { f64::NAN } else { (next() % levels) as f64 });
            let map = HeightMap::new(heights.collect(), [9, 11], [1e-9; 2]).unwrap();
            let summits = map.summits().summits;
            let found = map.prominences(&summits);
            for (summit, prominence) in summits.iter().zip(&found) {
                let expected = brute(&map, summit.row * 11 + summit.column);
                assert_eq!(*prominence, expected, "{seed}: {summit:?}");
                assert!(*prominence > 0.0);
            }
            seen += summits.len();
        }
        assert!(seen > 150, "{seen}");
    }

    /// Two hills of the same height: the first row by row is the higher one; a third on the border is higher
    /// ground for both.
    #[test]
    fn equal_heights_and_the_border() {
        let mut heights = vec![0.0; 100];
        (heights[23], heights[24], heights[25], heights[26], heights[27]) = (5.0, 4.0, 1.0, 2.0, 5.0);
        let prominences = |heights: &[f64]| {
            let map = HeightMap::new(heights.to_vec(), [10, 10], [1e-9; 2]).unwrap();
            map.prominences(&map.summits().summits)
        };
        assert_eq!(prominences(&heights), [5.0, 4.0]);
        heights[3] = 6.0;
        heights[13] = 3.0;
        assert_eq!(prominences(&heights), [2.0, 4.0]);
        // Missing heights are no way.
        (0..10).for_each(|column| heights[10 + column] = f64::NAN);
        heights[23] = 0.0;
        heights[33] = 5.0;
        heights[34] = 4.0;
        heights[35] = 1.0;
        assert_eq!(prominences(&heights), [4.0]);
    }

    #[test]
    fn the_prominences_do_not_depend_on_threads() {
        let mut next = scattered(77);
        let map = HeightMap::new((0..60 * 70).map(|_| (next() % 1000) as f64).collect(), [60, 70], [1e-9; 2])
            .unwrap();
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| map.prominences(&map.summits().summits))
        };
        let one = of(1);
        assert!([2, 3, 8].into_iter().all(|threads| of(threads) == one) && one.len() > 300);
    }
}
