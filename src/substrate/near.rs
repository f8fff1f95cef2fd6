//! The part of the sums that near neighbours contribute, pair by pair: pairs are kept, or computed again for each sum where there
//! are many and sums are rare.

use super::influence::NearPart;
use super::{Coupling, Influence, nearest};
use crate::math::chunks::in_chunks;
use crate::math::counting_sort::counting_sort;
use crate::math::instruction_set::InstructionSet;
use crate::math::real::Real;
use std::ops::Range;

/// Rings of cells around that of a point in which its neighbours are.
pub const RINGS: usize = 2;
/// Fewest cells along a side: no cell is met twice.
pub const FEWEST_CELLS: usize = 2 * RINGS + 1;

/// Pairs that are taken together.
pub const LANES: usize = 8;
/// Points whose pairs one thread computes at a time.
const BLOCK: usize = 256;

/// Sum of points of a cell over all points up to which pairs, some nine times as many, are kept in double precision: 36 MB.
const MOST_KEPT: f64 = 5e5;

/// Points of the unit square in the order of their cells, row by row, rising in x in a row.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Cells along a side.
    pub count: usize,
    /// The points in their order.
    pub order: Vec<u32>,
    /// Index of the first point of each cell, and at last the number of points.
    starts: Vec<usize>,
}

/// Index along a side, of `count` cells, of the cell of a coordinate.
fn along(count: usize, x: f64) -> usize {
    ((x * count as f64) as usize).min(count - 1)
}

impl Cells {
    /// Sorts points into `count` × `count` cells.
    pub fn new(count: usize, points: &[[f64; 2]]) -> Self {
        let mut rising: Vec<u32> = (0..points.len() as u32).collect();
        rising.sort_by(|a, b| points[*a as usize][0].total_cmp(&points[*b as usize][0]));
        let cell = |i: u32| {
            let [column, row] = points[i as usize].map(|x| along(count, x));
            row * count + column
        };
        let mut order = Vec::new();
        let starts = counting_sort(rising.into_iter(), count * count, cell, &mut order);
        Self { count, order, starts }
    }

    fn points(&self, row: usize, columns: Range<usize>) -> Range<usize> {
        self.starts[row * self.count + columns.start]..self.starts[row * self.count + columns.end]
    }

    /// All points, in their order, of the cell of a place and the rings around it; of few cells some come twice.
    pub fn around(&self, coupling: Coupling, place: [f64; 2]) -> impl Iterator<Item = u32> {
        let (count, rings) = (self.count as isize, RINGS as isize);
        let [column, row] = place.map(|x| along(self.count, x) as isize);
        let of = move |row: isize, column: isize| {
            let is_there = |i: isize| coupling == Coupling::Periodic || (0..count).contains(&i);
            let wrap = |i: isize| i.rem_euclid(count) as usize;
            if is_there(row) && is_there(column) {
                self.points(wrap(row), wrap(column)..wrap(column) + 1)
            } else {
                0..0
            }
        };
        let rows = row - rings..=row + rings;
        rows.flat_map(move |row| (column - rings..=column + rings).flat_map(move |column| of(row, column)))
            .map(|place| self.order[place])
    }

    /// How far the points around a place reach, in sides.
    pub fn reach(&self) -> f64 {
        RINGS as f64 / self.count as f64
    }

    /// Adds the ranges of points within reach of one: the ones behind it in its row, then the rows after. Each pair is met once.
    fn add_ranges(
        &self,
        coupling: Coupling,
        (i, row): (usize, usize),
        points: &Points,
        ranges: &mut Vec<Range<u32>>,
    ) {
        let (count, reach, is_repeated) = (self.count, self.reach(), coupling == Coupling::Periodic);
        let [x, y] = points.place(i);
        let mut add = |range: Range<usize>, from: f64, to: f64| {
            let places = &points.x[range.clone()];
            let [first, end] = [places.partition_point(|x| *x < from), places.partition_point(|x| *x <= to)]
                .map(|k| range.start + k);
            if first < end {
                ranges.push(first as u32..end as u32);
            }
        };
        let own = self.points(row, 0..count);
        add(i + 1..own.end, x, x + reach);
        if is_repeated {
            add(own.start..i, 0.0, x + reach - 1.0);
        }
        for next in row + 1..=row + RINGS {
            let apart = next as f64 / count as f64 - y;
            if apart > reach || next >= count && !is_repeated {
                break;
            }
            let (range, half) = (self.points(next % count, 0..count), (reach * reach - apart * apart).sqrt());
            add(range.clone(), x - half, x + half);
            if is_repeated {
                add(range.clone(), 1.0 + x - half, 1.0);
                add(range, 0.0, x + half - 1.0);
            }
        }
    }
}

/// Points in the order of cells.
#[derive(Clone, Debug, Default)]
struct Points {
    /// Coordinates, with zeros for [`LANES`] more.
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Points {
    fn new(points: &[[f64; 2]]) -> Self {
        let along = |k: usize| points.iter().map(|point| point[k]).chain([0.0; LANES]).collect();
        Self { x: along(0), y: along(1) }
    }

    fn place(&self, i: usize) -> [f64; 2] {
        [self.x[i], self.y[i]]
    }
}

/// The influence of near neighbours.
#[derive(Clone, Debug)]
pub struct Near<T> {
    /// Ranges of points for each point in the order of the cells.
    ranges: Vec<Range<u32>>,
    /// Index of the first range of each point, and at last the number of ranges.
    starts: Vec<u32>,
    /// None where pairs are kept.
    points: Points,
    part: NearPart,
    /// Half the side of a repeated square.
    half: f64,
    /// The influence of each pair, with zeros to a multiple of [`LANES`] in each range, if they are kept.
    values: Vec<T>,
    /// The influence the other way, over that of the pair: 1, or −1 of an odd one.
    back: T,
}

impl<T: Real> Near<T> {
    /// Whether pairs are kept, by the sum of points of a cell over all points. Sums in single precision are taken often.
    pub fn are_kept(points_of_cells: f64) -> bool {
        size_of::<T>() < size_of::<f64>() || points_of_cells <= MOST_KEPT
    }

    /// The near part of an influence, split at α, of points of the unit square in the order of their cells, with all pairs kept or not.
    pub fn new(
        coupling: Coupling,
        (influence, alpha): (Influence, f64),
        (cells, points): (&Cells, &[[f64; 2]]),
        is_kept: bool,
    ) -> Self {
        let points = Points::new(points);
        let (mut ranges, mut starts) = (Vec::<Range<u32>>::new(), vec![0]);
        for row in 0..cells.count {
            for i in cells.points(row, 0..cells.count) {
                cells.add_ranges(coupling, (i, row), &points, &mut ranges);
                starts.push(ranges.len() as u32);
            }
        }
        ranges.shrink_to_fit();
        let pairs: usize = ranges.iter().map(|range| range.len().next_multiple_of(LANES)).sum();
        let mut near = Self {
            ranges,
            starts,
            points,
            part: NearPart::new(influence, alpha),
            half: coupling.half(),
            values: Vec::new(),
            back: T::of(if influence.is_odd() { -1.0 } else { 1.0 }),
        };
        if is_kept {
            let mut values = Vec::with_capacity(pairs);
            (0..points_of(&near.starts)).for_each(|i| near.add_pairs(i, &mut values));
            near.values = values;
            near.points = Points::default();
        }
        near
    }

    /// The ranges of a point.
    fn ranges_of(&self, i: usize) -> &[Range<u32>] {
        &self.ranges[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// Adds the influence of each pair of a point, with zeros to a multiple of [`LANES`] in each range.
    fn add_pairs(&self, i: usize, values: &mut Vec<T>) {
        InstructionSet::current().run(
            #[inline(always)]
            || {
                let [x, y] = self.points.place(i);
                for range in self.ranges_of(i) {
                    let (begin, count, first) = (range.start as usize, range.len(), values.len());
                    let taken = begin..begin + count.next_multiple_of(LANES);
                    values.resize(first + taken.len(), T::zero());
                    let (xs, ys) = (&self.points.x[taken.clone()], &self.points.y[taken]);
                    for ((value, of_x), of_y) in values[first..].iter_mut().zip(xs).zip(ys) {
                        let way = [nearest(x - of_x, self.half), nearest(y - of_y, self.half)];
                        *value = T::of(self.part.value(way));
                    }
                    values[first + count..].fill(T::zero());
                }
            },
        );
    }

    /// Adds to the displacements what near neighbours contribute; both have room for [`LANES`] more numbers. Another thread of the
    /// pool may compute pairs that are not kept.
    pub fn add(&self, loads: &[T], displacements: &mut [T], is_shared: bool) {
        let count = points_of(&self.starts);
        if self.points.x.is_empty() {
            return self.add_of_points(0..count, &self.values, loads, displacements);
        }
        let mut values = [Vec::new(), Vec::new()];
        for first in (0..count).step_by(values.len() * BLOCK) {
            let points = |k: usize| (first + k * BLOCK).min(count)..(first + (k + 1) * BLOCK).min(count);
            in_chunks((1, is_shared), [&mut values], &|k, [values]| {
                values[0].clear();
                points(k).for_each(|i| self.add_pairs(i, &mut values[0]));
            });
            for (k, values) in values.iter().enumerate() {
                self.add_of_points(points(k), values, loads, displacements);
            }
        }
    }

    /// Adds what points contribute to their neighbours, and they to them, by the influence of each of their pairs.
    fn add_of_points(&self, points: Range<usize>, values: &[T], loads: &[T], displacements: &mut [T]) {
        let (mut values, _) = values.as_chunks::<LANES>();
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for i in points {
                    values = self.add_of(i, values, loads, displacements);
                }
            },
        );
    }

    /// Adds what a point contributes to its neighbours, and they to it, by the influence of each pair; the values that are left.
    #[inline(always)]
    fn add_of<'v>(
        &self,
        i: usize,
        mut values: &'v [[T; LANES]],
        loads: &[T],
        displacements: &mut [T],
    ) -> &'v [[T; LANES]] {
        let (load, mut lanes) = (self.back * loads[i], [T::zero(); LANES]);
        for range in self.ranges_of(i) {
            let (begin, count) = (range.start as usize, range.len().div_ceil(LANES));
            let (own, further) = values.split_at(count);
            values = further;
            let (loads, _) = loads[begin..begin + LANES * count].as_chunks::<LANES>();
            let (displaced, _) = displacements[begin..begin + LANES * count].as_chunks_mut::<LANES>();
            for ((value, load_of), displacement) in own.iter().zip(loads).zip(displaced) {
                let (value, load_of, own) = (*value, *load_of, *displacement);
                lanes = std::array::from_fn(|k| lanes[k] + value[k] * load_of[k]);
                *displacement = std::array::from_fn(|k| own[k] + value[k] * load);
            }
        }
        let pairs: [T; 4] = std::array::from_fn(|k| lanes[k] + lanes[k + 4]);
        displacements[i] += (pairs[0] + pairs[2]) + (pairs[1] + pairs[3]);
        values
    }
}

/// The number of points of indices of ranges.
fn points_of(starts: &[u32]) -> usize {
    starts.len() - 1
}
