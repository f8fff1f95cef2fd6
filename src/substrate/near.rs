//! The part of the sums that near neighbours contribute, from a table of all their pairs.

use super::{Coupling, Influence};
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

/// Points of the unit square in the order of their cells, row by row.
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
        let cell = |i: u32| {
            let [column, row] = points[i as usize].map(|x| along(count, x));
            row * count + column
        };
        let mut order = Vec::new();
        let starts = counting_sort(0..points.len() as u32, count * count, cell, &mut order);
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

    /// Ranges of points in the cells after a cell among its neighbours: each pair of cells is met once.
    fn after(&self, coupling: Coupling, (column, row): (usize, usize)) -> Vec<Range<usize>> {
        let (count, rings) = (self.count as isize, RINGS as isize);
        let mut ranges = Vec::with_capacity(2 * FEWEST_CELLS);
        for dy in 0..=rings {
            let y = row as isize + dy;
            if y >= count && coupling == Coupling::Patch {
                break;
            }
            let y = y.rem_euclid(count) as usize;
            let (first, last) = (column as isize + if dy == 0 { 1 } else { -rings }, column as isize + rings);
            let mut add = |first: isize, last: isize| {
                if first <= last {
                    ranges.push(self.points(y, first as usize..last as usize + 1));
                }
            };
            add(first.max(0), last.min(count - 1));
            if coupling == Coupling::Periodic {
                add((first + count).max(0).min(count), count - 1);
                add(first.max(count) - count, last - count);
            }
        }
        ranges.retain(|range| !range.is_empty());
        ranges
    }
}

/// The influence of near neighbours.
#[derive(Clone, Debug)]
pub struct Near<T> {
    /// Ranges of points for each point in the order of the cells: the ones behind it in its own cell, then
    /// the points of the cells after, together where they follow each other.
    ranges: Vec<Range<u32>>,
    /// Index of the first range of each point, and at last the number of ranges.
    starts: Vec<u32>,
    /// The influence of each pair, with zeros to a multiple of [`LANES`] in each range.
    values: Vec<T>,
    /// The influence the other way, over that of the pair: 1, or −1 of an odd one.
    back: T,
}

impl<T: Real> Near<T> {
    /// The near part of an influence, split at α, of points of the unit square in the order of their cells.
    pub fn new(
        coupling: Coupling,
        (influence, alpha): (Influence, f64),
        cells: &Cells,
        points: &[[f64; 2]],
    ) -> Self {
        let kernel =
            |[x, y]: [f64; 2]| T::of(influence.near(alpha, (x * x + y * y).sqrt()) * influence.along([x, y]));
        let (mut ranges, mut starts, mut values) = (Vec::<Range<u32>>::new(), vec![0], Vec::new());
        for row in 0..cells.count {
            for column in 0..cells.count {
                let after = cells.after(coupling, (column, row));
                let own = cells.points(row, column..column + 1);
                for i in own.clone() {
                    let first = ranges.len();
                    for range in std::iter::once(i + 1..own.end).chain(after.iter().cloned()) {
                        if range.is_empty() {
                            continue;
                        }
                        let range = range.start as u32..range.end as u32;
                        match ranges[first..].last_mut() {
                            Some(Range { end, .. }) if *end == range.start => *end = range.end,
                            _ => ranges.push(range),
                        }
                    }
                    for range in &ranges[first..] {
                        let near = &points[range.start as usize..range.end as usize];
                        values.extend(near.iter().map(|point| kernel(coupling.apart(points[i], *point))));
                        values.resize(values.len().next_multiple_of(LANES), T::zero());
                    }
                    starts.push(ranges.len() as u32);
                }
            }
        }
        let back = T::of(if influence.is_odd() { -1.0 } else { 1.0 });
        Self { ranges, starts, values, back }
    }

    /// Adds to the displacements what near neighbours contribute; both have room for [`LANES`] more numbers.
    pub fn add(&self, loads: &[T], displacements: &mut [T]) {
        InstructionSet::current().run(
            #[inline(always)]
            || self.add_in_lanes(loads, displacements),
        );
    }

    #[inline(always)]
    fn add_in_lanes(&self, loads: &[T], displacements: &mut [T]) {
        let (mut values, _) = self.values.as_chunks::<LANES>();
        for (i, limits) in self.starts.windows(2).enumerate() {
            let (load, mut lanes) = (self.back * loads[i], [T::zero(); LANES]);
            for range in &self.ranges[limits[0] as usize..limits[1] as usize] {
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
        }
    }
}
