//! The smooth part of the sums, on a grid.
//!
//! # Formula
//! Loads are spread to a grid by the window φ(t) = exp(β(√(1 − t²) − 1)) (Barnett, Magland and af Klinteberg,
//! SIAM J. Sci. Comput. 41 (2019) C479), convolved with the smooth part of their influence ([`super::influence`]), and
//! read off by the same window; the transform of the kernel is divided by the square of that of the window. Of a
//! square alone it is that of the kernel where it is needed, continued
//! smoothly to nothing in a larger square: the kernel has no waves shorter than the grid, so that this
//! transform is one on a grid.

use super::{Coupling, Influence};
use crate::math::chunks::in_chunks;
use crate::math::exponential::exp;
use crate::math::fft::{Complex, Convolution, ConvolutionScratch, Transform, good_length};
use crate::math::gauss::legendre;
use crate::math::instruction_set::InstructionSet;
use crate::math::real::Real;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Grid points over those that the shortest wave needs.
const OVERSAMPLING: f64 = 1.5;
/// Nodes of the integral that transforms a window.
const NODES: usize = 64;
/// Grid points over which the kernel of a square alone keeps its values beyond where it is needed, and fewest
/// over which it goes to nothing.
const MARGIN: (usize, usize) = (16, 64);
/// Points whose displacements one thread reads at a time.
const CHUNK: usize = 1024;
/// Columns of a window that are taken together.
const LANES: usize = 8;

/// The window.
#[derive(Clone, Copy, Debug)]
struct Window {
    /// Grid points that it covers along a side.
    width: usize,
    /// β.
    shape: f64,
}

impl Window {
    /// The window of an error of about `tolerance`.
    fn new(tolerance: f64) -> Self {
        let share = PI * (1.0 - 1.0 / OVERSAMPLING).sqrt();
        let width = (libm::log(1.0 / tolerance) / share).ceil() as usize + 2;
        Self { width, shape: 0.98 * PI * width as f64 * (1.0 - 0.5 / OVERSAMPLING) }
    }

    /// φ at a place between −1 and 1.
    #[inline(always)]
    fn value(self, t: f64) -> f64 {
        exp(self.shape * ((1.0 - t * t).max(0.0).sqrt() - 1.0))
    }

    /// The weights of the grid points along a window, with zeros to a multiple of [`LANES`]; the window begins at a distance from its
    /// point, in grid points.
    #[inline(always)]
    fn weights<T: Real, const GROUPS: usize>(self, begin: f64) -> [[T; LANES]; GROUPS] {
        let by_half = 2.0 / self.width as f64;
        let mut values = [[0.0; LANES]; GROUPS];
        // Vectors hold small whole numbers, not the long ones of an index.
        for (value, j) in values.as_flattened_mut().iter_mut().zip(0_i32..) {
            *value = self.value((begin + f64::from(j)) * by_half);
        }
        values.as_flattened_mut()[self.width..].fill(0.0);
        values.map(|group| group.map(T::of))
    }

    /// The weights of the columns and rows of windows.
    fn weights_of<T: Real, const GROUPS: usize>(self, begins: &[[f64; 2]]) -> Vec<T> {
        let mut weights = Vec::with_capacity(2 * GROUPS * LANES * begins.len());
        for begin in begins.as_flattened() {
            weights.extend_from_slice(self.weights::<T, GROUPS>(*begin).as_flattened());
        }
        weights
    }

    /// Transforms of φ in grid points, by the wave number of `0..=most` of a grid of `side`.
    fn transforms(self, most: usize, side: usize) -> Vec<f64> {
        let half = 0.5 * self.width as f64;
        static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| legendre(NODES));
        let nodes: Vec<(f64, f64)> =
            RULE.iter().map(|&(t, weight)| (half * t, half * weight * self.value(t))).collect();
        let at = |m: usize| {
            let k = 2.0 * PI * m as f64 / side as f64;
            nodes.iter().map(|(t, weight)| weight * libm::cos(k * t)).sum()
        };
        (0..=most).map(at).collect()
    }
}

/// The sums over the smooth part.
#[derive(Clone, Debug)]
pub struct Far<T> {
    window: Window,
    /// Rows and columns of the grid that loads are spread to.
    side: usize,
    /// Repeated rows and columns among them.
    halo: usize,
    /// First column and row of the window of each point.
    places: Vec<[u32; 2]>,
    /// The distances of both from the point, in grid points. None where weights are kept.
    begins: Vec<[f64; 2]>,
    /// The weights of the columns and rows of each window, with zeros to a multiple of [`LANES`]. None where they are computed.
    weights: Vec<T>,
    convolution: Convolution<T>,
    scratch: ConvolutionScratch<T>,
    grid: Vec<T>,
}

impl<T: Real> Far<T> {
    /// The sums over the smooth part of an influence, split at α, of points of the unit square, with all windows kept or not, to about a
    /// relative `tolerance`; waves shorter than `shortest`, a wave number, are below that.
    pub fn new(
        coupling: Coupling,
        (influence, alpha): (Influence, f64),
        (points, are_kept): (&[[f64; 2]], bool),
        shortest: f64,
        tolerance: f64,
    ) -> Self {
        let window = Window::new(tolerance);
        let per_side = good_length(((OVERSAMPLING * shortest / PI).ceil() as usize).max(2 * window.width));
        let (inner, halo) = match coupling {
            Coupling::Periodic => (per_side, window.width),
            Coupling::Patch => (per_side + window.width + window.width % 2, 0),
        };
        let convolution = match coupling {
            Coupling::Periodic => periodic(window, per_side, (influence, alpha), shortest),
            Coupling::Patch => alone(window, (per_side, inner), (influence, alpha), shortest),
        };
        let scaled = || points.iter().map(|point| point.map(|x| x * per_side as f64));
        // From the first row of the grid, which lies half a window before the square.
        let places = scaled().map(|point| point.map(|x| x.ceil() as u32)).collect();
        let half = 0.5 * window.width as f64;
        let mut begins: Vec<[f64; 2]> = scaled().map(|point| point.map(|x| x.ceil() - x - half)).collect();
        let mut weights = Vec::new();
        if are_kept {
            let begins = std::mem::take(&mut begins);
            weights = match window.width.div_ceil(LANES) {
                1 => window.weights_of::<T, 1>(&begins),
                2 => window.weights_of::<T, 2>(&begins),
                _ => window.weights_of::<T, 3>(&begins),
            };
        }
        let side = inner + halo;
        Self {
            window,
            side,
            halo,
            places,
            begins,
            weights,
            convolution,
            scratch: ConvolutionScratch::default(),
            // Zeros of the last window go beyond its row.
            grid: vec![T::zero(); side * side + LANES],
        }
    }

    /// Fills `displacements` with those by the smooth part. Other threads of the pool may take parts.
    pub fn displace(&mut self, loads: &[T], displacements: &mut [T], is_shared: bool) {
        self.grid.fill(T::zero());
        match self.window.width.div_ceil(LANES) {
            1 => self.displace_by::<1>(loads, displacements, is_shared),
            2 => self.displace_by::<2>(loads, displacements, is_shared),
            3 => self.displace_by::<3>(loads, displacements, is_shared),
            _ => unreachable!("a window for 1e-16 has 23 columns"),
        }
    }

    /// The displacements with windows of `GROUPS` groups of columns.
    fn displace_by<const GROUPS: usize>(&mut self, loads: &[T], displacements: &mut [T], is_shared: bool) {
        InstructionSet::current().run(
            #[inline(always)]
            || self.spread::<GROUPS>(loads),
        );
        self.fold();
        let count = self.count();
        self.convolution.apply(&mut self.grid[..count * count], &mut self.scratch, is_shared);
        self.unfold();
        in_chunks((CHUNK, is_shared), [displacements], &|number, [displacements]| {
            InstructionSet::current().run(
                #[inline(always)]
                || self.read::<GROUPS>(number * CHUNK, displacements),
            );
        });
    }

    /// The weights of the columns and of the rows of the window of a point.
    #[inline(always)]
    fn window_of<const GROUPS: usize>(&self, i: usize) -> [[[T; LANES]; GROUPS]; 2] {
        if self.weights.is_empty() {
            // A closure of a map would not be compiled for the instruction set.
            let [column, row] = self.begins[i];
            return [self.window.weights(column), self.window.weights(row)];
        }
        let (own, _) = self.weights[i * 2 * GROUPS * LANES..][..2 * GROUPS * LANES].as_chunks::<LANES>();
        std::array::from_fn(|k| std::array::from_fn(|group| own[k * GROUPS + group]))
    }

    #[inline(always)]
    fn spread<const GROUPS: usize>(&mut self, loads: &[T]) {
        for (i, load) in (0..self.places.len()).zip(loads) {
            let ([columns, rows], place) = (self.window_of::<GROUPS>(i), self.places[i]);
            let mut begin = place[1] as usize * self.side + place[0] as usize;
            for row in &rows.as_flattened()[..self.window.width] {
                let strength = *load * *row;
                let (values, _) = self.grid[begin..begin + GROUPS * LANES].as_chunks_mut::<LANES>();
                for (values, columns) in values.iter_mut().zip(&columns) {
                    let own = *values;
                    *values = std::array::from_fn(|k| own[k] + strength * columns[k]);
                }
                begin += self.side;
            }
        }
    }

    #[inline(always)]
    fn read<const GROUPS: usize>(&self, first: usize, displacements: &mut [T]) {
        for (i, displacement) in (first..).zip(displacements) {
            let ([columns, rows], place) = (self.window_of::<GROUPS>(i), self.places[i]);
            // Columns are summed over the rows first, which every vector does alike.
            let mut sums = [[T::zero(); LANES]; GROUPS];
            let mut begin = place[1] as usize * self.side + place[0] as usize;
            for row in &rows.as_flattened()[..self.window.width] {
                let (values, _) = self.grid[begin..begin + GROUPS * LANES].as_chunks::<LANES>();
                for (sums, values) in sums.iter_mut().zip(values) {
                    let (own, values) = (*sums, *values);
                    *sums = std::array::from_fn(|k| own[k] + *row * values[k]);
                }
                begin += self.side;
            }
            let mut lanes = [T::zero(); LANES];
            for (sums, columns) in sums.iter().zip(columns) {
                lanes = std::array::from_fn(|k| lanes[k] + sums[k] * columns[k]);
            }
            let fours: [T; 4] = std::array::from_fn(|k| lanes[k] + lanes[k + 4]);
            *displacement = (fours[0] + fours[2]) + (fours[1] + fours[3]);
        }
    }

    /// Rows and columns without those that are repeated.
    fn count(&self) -> usize {
        self.side - self.halo
    }

    /// Adds the repeated rows and columns of the grid to those that they repeat, and moves all rows next to each other.
    fn fold(&mut self) {
        let (count, side, halo) = (self.count(), self.side, self.halo);
        if halo == 0 {
            return;
        }
        let (rows, repeated) = self.grid[..side * side].split_at_mut(count * side);
        for row in rows.chunks_exact_mut(side) {
            let (begin, repeated) = row.split_at_mut(count);
            begin.iter_mut().zip(repeated).for_each(|(value, repeated)| *value += *repeated);
        }
        for (row, repeated) in rows.chunks_exact_mut(side).zip(repeated.chunks_exact(side)) {
            let (begin, further) = repeated.split_at(count);
            row.iter_mut().zip(begin).for_each(|(value, repeated)| *value += *repeated);
            row.iter_mut().zip(further).for_each(|(value, repeated)| *value += *repeated);
        }
        for y in 1..count {
            self.grid.copy_within(y * side..y * side + count, y * count);
        }
    }

    /// Moves the rows back to their places, and repeats rows and columns.
    fn unfold(&mut self) {
        let (count, side, halo) = (self.count(), self.side, self.halo);
        if halo == 0 {
            return;
        }
        for y in (0..count).rev() {
            self.grid.copy_within(y * count..(y + 1) * count, y * side);
            self.grid.copy_within(y * side..y * side + halo, y * side + count);
        }
        self.grid.copy_within(..halo * side, count * side);
    }
}

/// The convolution of a repeated square.
fn periodic<T: Real>(
    window: Window,
    side: usize,
    (influence, alpha): (Influence, f64),
    shortest: f64,
) -> Convolution<T> {
    let transforms = window.transforms(side / 2, side);
    let magnitude = |m: usize| m.min(side - m);
    Convolution::new(side, side, influence.is_odd(), |x, y| {
        let along = influence.along([x, y].map(|m| 2.0 * PI * signed(m, side)));
        let (x, y) = (magnitude(x), magnitude(y));
        let k = 2.0 * PI * ((x * x + y * y) as f64).sqrt();
        if k > shortest {
            return 0.0;
        }
        let transform = influence.transform(alpha, k) * along;
        transform / (transforms[x] * transforms[y]).powi(2) * (side as f64).powi(2)
    })
}

/// The wave number, or the coordinate, in a row of `side` that begins at 0 and ends before it again.
fn signed(i: usize, side: usize) -> f64 {
    if 2 * i > side { -((side - i) as f64) } else { i as f64 }
}

/// The convolution of a square alone, of `per_side` grid points and in all `inner`.
fn alone<T: Real>(
    window: Window,
    (per_side, inner): (usize, usize),
    (influence, alpha): (Influence, f64),
    shortest: f64,
) -> Convolution<T> {
    let kept = inner + MARGIN.0;
    let large = good_length(2 * kept + (inner / 2).max(2 * MARGIN.1));
    let spacing = 1.0 / per_side as f64;
    let fade = |g: usize| {
        let share = (g.max(kept) - kept) as f64 / (large / 2 - kept) as f64;
        0.5 * libm::erfc(5.8 * (2.0 * share - 1.0))
    };
    let fades: Vec<f64> = (0..=large / 2).map(fade).collect();
    let distance = |i: usize| i.min(large - i);
    let mut kernel: Complex = Complex::zeros(large * large);
    for y in 0..large {
        for x in 0..large {
            let (x_of, y_of) = (distance(x), distance(y));
            let r = spacing * ((x_of * x_of + y_of * y_of) as f64).sqrt();
            let along = influence.along([x, y].map(|i| spacing * signed(i, large)));
            kernel.re[y * large + x] = influence.smooth(alpha, r) * along * fades[x_of] * fades[y_of];
        }
    }
    let transforms = window.transforms(large / 2, large);
    let last = (shortest * large as f64 * spacing / (2.0 * PI)) as usize;
    in_both_ways(large, &mut kernel, Transform::forward);
    // The transform of an odd kernel is imaginary.
    let Complex { re, im } = &mut kernel;
    let (values, zeros) = if influence.is_odd() { (im, re) } else { (re, im) };
    for y in 0..large {
        for x in 0..large {
            let (m, n) = (distance(x), distance(y));
            let within = m * m + n * n <= last * last;
            let factor = (transforms[m] * transforms[n]).powi(2) * (large as f64).powi(2);
            values[y * large + x] = if within { values[y * large + x] / factor } else { 0.0 };
        }
    }
    zeros.fill(0.0);
    in_both_ways(large, &mut kernel, Transform::backward);
    cut_out(influence, kernel.re, large, inner)
}

/// The convolution of a grid of `inner` points a side with a kernel that is known on a square of `large`.
fn cut_out<T: Real>(influence: Influence, kernel: Vec<f64>, large: usize, inner: usize) -> Convolution<T> {
    let side = good_length(2 * inner);
    let mut own: Complex = Complex::zeros(side * side);
    for y in 0..side {
        for x in 0..side {
            let distance = |i: usize| i.min(side - i);
            let sign = influence.along([x, y].map(|i| signed(i, side).signum()));
            own.re[y * side + x] = sign * kernel[distance(y) * large + distance(x)];
        }
    }
    drop(kernel);
    in_both_ways(side, &mut own, Transform::forward);
    let spectrum = if influence.is_odd() { own.im } else { own.re };
    Convolution::new(inner, side, influence.is_odd(), |x, y| spectrum[y * side + x])
}

/// Transforms a square along both its sides.
fn in_both_ways(side: usize, data: &mut Complex, transform: fn(&Transform, usize, &mut Complex, bool)) {
    let own = Transform::new(side);
    for _ in 0..2 {
        transform(&own, side, data, false);
        for part in [&mut data.re, &mut data.im] {
            for y in 0..side {
                for x in 0..y {
                    part.swap(y * side + x, x * side + y);
                }
            }
        }
    }
}
