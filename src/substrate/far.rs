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
    fn value(self, t: f64) -> f64 {
        libm::exp(self.shape * ((1.0 - t * t).max(0.0).sqrt() - 1.0))
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
    /// First row and column of the window of each point.
    places: Vec<[u32; 2]>,
    /// The weights of the columns of each window, with zeros to a multiple of [`LANES`], then of its rows.
    weights: Vec<T>,
    convolution: Convolution<T>,
    scratch: ConvolutionScratch<T>,
    grid: Vec<T>,
    inner: Vec<T>,
}

impl<T: Real> Far<T> {
    /// The sums over the smooth part of an influence, split at α, of points of the unit square, to about a relative
    /// `tolerance`; waves shorter than `shortest`, a wave number, are below that.
    pub fn new(
        coupling: Coupling,
        (influence, alpha): (Influence, f64),
        points: &[[f64; 2]],
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
        let (mut places, mut weights) = (Vec::with_capacity(points.len()), Vec::new());
        let columns = window.width.next_multiple_of(LANES);
        weights.reserve((columns + window.width) * points.len());
        let half = 0.5 * window.width as f64;
        for point in points {
            let mut place = [0; 2];
            for (k, &x) in point.iter().enumerate() {
                // From the first row of the grid, which lies half a window before the square.
                let x = x * per_side as f64;
                let first = x.ceil();
                place[k] = first as u32;
                let along = |j: usize| T::of(window.value((first - x + j as f64 - half) / half));
                weights.extend((0..window.width).map(along));
                if k == 0 {
                    weights.resize(weights.len() + columns - window.width, T::zero());
                }
            }
            places.push(place);
        }
        let side = inner + halo;
        Self {
            window,
            side,
            halo,
            places,
            weights,
            convolution,
            scratch: ConvolutionScratch::default(),
            // Zeros of the last window go beyond its row.
            grid: vec![T::zero(); side * side + LANES],
            inner: vec![T::zero(); inner * inner],
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
        self.convolution.apply(&mut self.inner, &mut self.scratch, is_shared);
        self.unfold();
        in_chunks((CHUNK, is_shared), [displacements], &|number, [displacements]| {
            InstructionSet::current().run(
                #[inline(always)]
                || self.read::<GROUPS>(number * CHUNK, displacements),
            );
        });
    }

    #[inline(always)]
    fn spread<const GROUPS: usize>(&mut self, loads: &[T]) {
        let Self { window, side, places, weights, grid, .. } = self;
        let weights = weights.chunks_exact(GROUPS * LANES + window.width);
        for ((place, weights), load) in places.iter().zip(weights).zip(loads) {
            let (columns, rows) = groups::<T, GROUPS>(weights);
            let columns = *columns;
            let mut begin = place[1] as usize * *side + place[0] as usize;
            for row in rows {
                let strength = *load * *row;
                let (values, _) = grid[begin..begin + GROUPS * LANES].as_chunks_mut::<LANES>();
                for (values, columns) in values.iter_mut().zip(&columns) {
                    let own = *values;
                    *values = std::array::from_fn(|k| own[k] + strength * columns[k]);
                }
                begin += *side;
            }
        }
    }

    #[inline(always)]
    fn read<const GROUPS: usize>(&self, first: usize, displacements: &mut [T]) {
        let count = GROUPS * LANES + self.window.width;
        let weights = self.weights[first * count..].chunks_exact(count);
        for ((place, weights), displacement) in self.places[first..].iter().zip(weights).zip(displacements) {
            let (columns, rows) = groups::<T, GROUPS>(weights);
            // Columns are summed over the rows first, which every vector does alike.
            let mut sums = [[T::zero(); LANES]; GROUPS];
            let mut begin = place[1] as usize * self.side + place[0] as usize;
            for row in rows {
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

    /// Takes the grid without what is repeated.
    fn fold(&mut self) {
        let (count, side) = (self.count(), self.side);
        if self.halo == 0 {
            for y in 0..count {
                self.inner[y * count..(y + 1) * count]
                    .copy_from_slice(&self.grid[y * side..y * side + count]);
            }
            return;
        }
        self.inner.fill(T::zero());
        for y in 0..side {
            let row = &self.grid[y * side..(y + 1) * side];
            let (begin, repeated) = row.split_at(count);
            let inner = &mut self.inner[(y % count) * count..][..count];
            inner.iter_mut().zip(begin).for_each(|(inner, value)| *inner += *value);
            for (x, value) in repeated.iter().enumerate() {
                inner[x % count] += *value;
            }
        }
    }

    fn unfold(&mut self) {
        let (count, side) = (self.count(), self.side);
        let rows = if self.halo == 0 { count } else { side };
        for y in 0..rows {
            let inner = &self.inner[(y % count) * count..][..count];
            let (begin, repeated) = self.grid[y * side..(y + 1) * side].split_at_mut(count);
            begin.copy_from_slice(inner);
            if self.halo > 0 {
                repeated.iter_mut().enumerate().for_each(|(x, value)| *value = inner[x % count]);
            }
        }
    }
}

/// The weights of the columns of a window, in groups, and the weights of its rows.
#[inline(always)]
fn groups<T, const GROUPS: usize>(weights: &[T]) -> (&[[T; LANES]; GROUPS], &[T]) {
    let (columns, rows) = weights.split_at(GROUPS * LANES);
    let (columns, _) = columns.as_chunks::<LANES>();
    (columns.try_into().expect("the window has this number of groups"), rows)
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
fn in_both_ways(
    side: usize,
    data: &mut Complex,
    transform: fn(&Transform, usize, &mut Complex, &mut Complex, bool),
) {
    let (own, mut scratch) = (Transform::new(side), Complex::zeros(side * side));
    for _ in 0..2 {
        transform(&own, side, data, &mut scratch, false);
        for part in [&mut data.re, &mut data.im] {
            for y in 0..side {
                for x in 0..y {
                    part.swap(y * side + x, x * side + y);
                }
            }
        }
    }
}
