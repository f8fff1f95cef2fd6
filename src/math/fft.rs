//! Convolution on a grid by Fourier transforms whose bits do not depend on the processor.
//!
//! # Formula
//! Stockham's self-sorting transform of mixed radix (Van Loan 1992, section 1.7), over many columns at once:
//! the innermost loop is over columns, so that vectors of any width give the same bits. Factors come from
//! `libm`. A library that takes them from the sine of the C library has other bits on processors with fused
//! multiplication, because that sine has.

use super::chunks::in_chunks;
use super::instruction_set::InstructionSet;
use super::real::Real;
use std::f64::consts::PI;
use std::ops::Range;

/// Columns of a block.
const WIDTH: usize = 64;
/// cos 72°, cos 144°, sin 72° and sin 144°.
const PENTAGON: [f64; 4] =
    [0.309_016_994_374_947_4, -0.809_016_994_374_947_4, 0.951_056_516_295_153_6, 0.587_785_252_292_473_1];
/// sin 60°.
const TRIANGLE: f64 = 0.866_025_403_784_438_6;

/// Complex numbers, real and imaginary parts apart.
#[derive(Clone, Debug, Default)]
pub struct Complex<T = f64> {
    /// Real parts.
    pub re: Vec<T>,
    /// Imaginary parts.
    pub im: Vec<T>,
}

impl<T: Real> Complex<T> {
    /// `count` zeros.
    pub fn zeros(count: usize) -> Self {
        Self { re: vec![T::zero(); count], im: vec![T::zero(); count] }
    }

    fn resize(&mut self, count: usize) {
        for part in [&mut self.re, &mut self.im] {
            part.resize(count, T::zero());
        }
    }
}

/// The least length from `least` on that has no other factors than 2, 3 and 5, and is even.
pub fn good_length(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least.max(2)..).find(|n| n.is_multiple_of(2) && smooth(*n)).expect("powers of 2 are without end")
}

/// A stage of a transform: its radix, and cos and sin of the factors of each of its groups, radix − 1 of them.
#[derive(Clone, Debug)]
struct Stage<T> {
    radix: usize,
    factors: Vec<(T, T)>,
}

/// Transforms of one length.
#[derive(Clone, Debug)]
pub struct Transform<T = f64> {
    length: usize,
    stages: Vec<Stage<T>>,
}

impl<T: Real> Transform<T> {
    /// Transforms of a [good](good_length) length.
    pub fn new(length: usize) -> Self {
        let (mut left, mut stages) = (length, Vec::new());
        for radix in [4, 2, 3, 5] {
            while left.is_multiple_of(radix) && left > 1 {
                let groups = left / radix;
                let angle = |p: usize, u: usize| -2.0 * PI * ((p * u) % left) as f64 / left as f64;
                let factor = |angle: f64| (T::of(libm::cos(angle)), T::of(libm::sin(angle)));
                let factors = (0..groups)
                    .flat_map(|p| (1..radix).map(move |u| (p, u)))
                    .map(|(p, u)| factor(angle(p, u)));
                stages.push(Stage { radix, factors: factors.collect() });
                left = groups;
            }
        }
        assert_eq!(left, 1, "{length} has another factor than 2, 3 and 5");
        Self { length, stages }
    }

    /// Transforms columns of `data` forward: Σ x e^(−2πi jk/n), in [`Blocks`] of up to `width` columns. Other threads of
    /// the pool may take blocks.
    pub fn forward(&self, width: usize, data: &mut Complex<T>, is_shared: bool) {
        let parts = [&mut data.re[..], &mut data.im];
        in_chunks((self.length * width, is_shared), parts, &|_, [re, im]| {
            let mut scratch = Complex::zeros(re.len());
            let (mut from, mut to) = ([re, im], [&mut scratch.re[..], &mut scratch.im]);
            let (mut left, mut stride) = (self.length, from[0].len() / self.length);
            for stage in &self.stages {
                InstructionSet::current().run(
                    #[inline(always)]
                    || pass(stage, left / stage.radix, stride, &from, &mut to),
                );
                std::mem::swap(&mut from, &mut to);
                left /= stage.radix;
                stride *= stage.radix;
            }
            if self.stages.len() % 2 == 1 {
                to.iter_mut().zip(from).for_each(|(data, scratch)| data.copy_from_slice(scratch));
            }
        });
    }

    /// Transforms columns with the opposite sign in the exponent, not divided by the length.
    pub fn backward(&self, width: usize, data: &mut Complex<T>, is_shared: bool) {
        std::mem::swap(&mut data.re, &mut data.im);
        self.forward(width, data, is_shared);
        std::mem::swap(&mut data.re, &mut data.im);
    }
}

/// The places of numbers in rows and columns that come in blocks of columns, row by row in each: they stay in the cache.
#[derive(Clone, Copy, Debug)]
struct Blocks {
    rows: usize,
    columns: usize,
}

impl Blocks {
    fn at(self, row: usize, column: usize) -> usize {
        let begin = column - column % WIDTH;
        begin * self.rows + row * WIDTH.min(self.columns - begin) + column - begin
    }

    fn count(self) -> usize {
        self.rows * self.columns
    }

    /// The columns of blocks.
    fn of_blocks(self) -> impl Iterator<Item = Range<usize>> {
        (0..self.columns).step_by(WIDTH).map(move |begin| begin..(begin + WIDTH).min(self.columns))
    }
}

/// One stage: groups p of `radix` slices each a stride wide.
#[inline(always)]
fn pass<T: Real>(
    stage: &Stage<T>,
    groups: usize,
    stride: usize,
    [from_re, from_im]: &[&mut [T]; 2],
    [re, im]: &mut [&mut [T]; 2],
) {
    let radix = stage.radix;
    for p in 0..groups {
        let source = |t: usize| {
            let begin = stride * (p + groups * t);
            (&from_re[begin..begin + stride], &from_im[begin..begin + stride])
        };
        let out = radix * stride * p..radix * stride * (p + 1);
        let out = (&mut re[out.clone()], &mut im[out]);
        let factors = &stage.factors[(radix - 1) * p..(radix - 1) * (p + 1)];
        match radix {
            2 => butterfly::<T, 2>([source(0), source(1)], factors, out, |x| {
                let [a, b] = x;
                [(a.0 + b.0, a.1 + b.1), (a.0 - b.0, a.1 - b.1)]
            }),
            3 => butterfly::<T, 3>([source(0), source(1), source(2)], factors, out, three),
            4 => butterfly::<T, 4>([source(0), source(1), source(2), source(3)], factors, out, four),
            _ => {
                butterfly::<T, 5>([source(0), source(1), source(2), source(3), source(4)], factors, out, five)
            }
        }
    }
}

type Number<T> = (T, T);

#[inline(always)]
fn butterfly<T: Real, const R: usize>(
    from: [(&[T], &[T]); R],
    factors: &[Number<T>],
    (re, im): (&mut [T], &mut [T]),
    of: impl Fn([Number<T>; R]) -> [Number<T>; R],
) {
    let stride = from[0].0.len();
    let res: [&mut [T]; R] = split(re, stride);
    let ims: [&mut [T]; R] = split(im, stride);
    let from = from.map(|(re, im)| (&re[..stride], &im[..stride]));
    for q in 0..stride {
        // An array's own map is a call here, which keeps the loop from becoming one of vectors.
        let mut values = [(T::zero(), T::zero()); R];
        for t in 0..R {
            values[t] = (from[t].0[q], from[t].1[q]);
        }
        let out = of(values);
        res[0][q] = out[0].0;
        ims[0][q] = out[0].1;
        for u in 1..R {
            let (cos, sin) = factors[u - 1];
            res[u][q] = out[u].0 * cos - out[u].1 * sin;
            ims[u][q] = out[u].0 * sin + out[u].1 * cos;
        }
    }
}

#[inline(always)]
fn split<T, const R: usize>(mut all: &mut [T], stride: usize) -> [&mut [T]; R] {
    std::array::from_fn(|_| {
        let (first, rest) = std::mem::take(&mut all).split_at_mut(stride);
        all = rest;
        first
    })
}

#[inline(always)]
fn three<T: Real>([a, b, c]: [Number<T>; 3]) -> [Number<T>; 3] {
    let [half, triangle] = [T::of(0.5), T::of(TRIANGLE)];
    let (sum, less) = ((b.0 + c.0, b.1 + c.1), (b.0 - c.0, b.1 - c.1));
    let middle = (a.0 - half * sum.0, a.1 - half * sum.1);
    let turned = (triangle * less.1, -triangle * less.0);
    [
        (a.0 + sum.0, a.1 + sum.1),
        (middle.0 + turned.0, middle.1 + turned.1),
        (middle.0 - turned.0, middle.1 - turned.1),
    ]
}

#[inline(always)]
fn four<T: Real>([a, b, c, d]: [Number<T>; 4]) -> [Number<T>; 4] {
    let (even, odd) = ((a.0 + c.0, a.1 + c.1), (b.0 + d.0, b.1 + d.1));
    let (less, turned) = ((a.0 - c.0, a.1 - c.1), (b.1 - d.1, d.0 - b.0));
    [
        (even.0 + odd.0, even.1 + odd.1),
        (less.0 + turned.0, less.1 + turned.1),
        (even.0 - odd.0, even.1 - odd.1),
        (less.0 - turned.0, less.1 - turned.1),
    ]
}

#[inline(always)]
fn five<T: Real>([a, b, c, d, e]: [Number<T>; 5]) -> [Number<T>; 5] {
    let [c1, c2, s1, s2] = PENTAGON.map(T::of);
    let (outer, inner) = ((b.0 + e.0, b.1 + e.1), (c.0 + d.0, c.1 + d.1));
    let (less, lesser) = ((b.0 - e.0, b.1 - e.1), (c.0 - d.0, c.1 - d.1));
    let one = (a.0 + c1 * outer.0 + c2 * inner.0, a.1 + c1 * outer.1 + c2 * inner.1);
    let two = (a.0 + c2 * outer.0 + c1 * inner.0, a.1 + c2 * outer.1 + c1 * inner.1);
    let first = (s1 * less.1 + s2 * lesser.1, -(s1 * less.0 + s2 * lesser.0));
    let second = (s2 * less.1 - s1 * lesser.1, -(s2 * less.0 - s1 * lesser.0));
    [
        (a.0 + outer.0 + inner.0, a.1 + outer.1 + inner.1),
        (one.0 + first.0, one.1 + first.1),
        (two.0 + second.0, two.1 + second.1),
        (two.0 - second.0, two.1 - second.1),
        (one.0 - first.0, one.1 - first.1),
    ]
}

/// Circular convolutions of square real grids with one kernel, even or odd; what is convolved fills the first `inner`
/// rows and columns of a grid of side `side`, and no more is read of the result.
#[derive(Clone, Debug)]
pub struct Convolution<T = f64> {
    inner: usize,
    side: usize,
    transform: Transform<T>,
    /// Transform of the kernel over side², by wave numbers along the columns 0..=side/2, and along the rows, in blocks as
    /// transforms of rows are; of an odd kernel over i.
    spectrum: Vec<T>,
    is_odd: bool,
}

/// Memory of convolutions.
#[derive(Clone, Debug, Default)]
pub struct ConvolutionScratch<T = f64> {
    pairs: Complex<T>,
    rows: Complex<T>,
}

impl<T: Real> Convolution<T> {
    /// Convolutions with the kernel whose transform, or that over i if it is odd, is given at the wave numbers (along the
    /// rows, along the columns), both of 0..side.
    pub fn new(inner: usize, side: usize, is_odd: bool, spectrum: impl Fn(usize, usize) -> f64) -> Self {
        let norm = 1.0 / (side as f64 * side as f64);
        let at = |x, y| T::of(norm * spectrum(x, y));
        let blocks = Blocks { rows: side, columns: side / 2 + 1 };
        let of_rows = blocks.of_blocks().flat_map(|block| (0..side).map(move |x| (x, block.clone())));
        let spectrum = of_rows.flat_map(|(x, block)| block.map(move |y| (x, y))).map(|(x, y)| at(x, y));
        Self { inner, side, transform: Transform::new(side), spectrum: spectrum.collect(), is_odd }
    }

    /// Convolves a grid of `inner` rows and columns, `inner` even, in its place. Other threads of the pool may take parts.
    pub fn apply(&self, grid: &mut [T], memory: &mut ConvolutionScratch<T>, is_shared: bool) {
        let ConvolutionScratch { pairs, rows } = memory;
        pairs.resize(self.of_pairs().count());
        rows.resize(self.of_rows().count());
        self.pair(grid, pairs, is_shared);
        self.transform.forward(WIDTH, pairs, is_shared);
        self.separate(pairs, rows, is_shared);
        self.transform.forward(WIDTH, rows, is_shared);
        self.multiply(rows, is_shared);
        self.transform.backward(WIDTH, rows, is_shared);
        self.join(rows, pairs, is_shared);
        self.transform.backward(WIDTH, pairs, is_shared);
        self.unpair(pairs, grid);
    }

    /// The layout of pairs of columns.
    fn of_pairs(&self) -> Blocks {
        Blocks { rows: self.side, columns: self.inner / 2 }
    }

    /// The layout of rows, the half that is not the mirror of another.
    fn of_rows(&self) -> Blocks {
        Blocks { rows: self.side, columns: self.side / 2 + 1 }
    }

    /// Takes the columns of a grid in pairs: two real ones come as one complex one.
    fn pair(&self, grid: &[T], z: &mut Complex<T>, is_shared: bool) {
        let Self { inner, side, .. } = *self;
        in_chunks((WIDTH * side, is_shared), [&mut z.re, &mut z.im], &|block, [re, im]| {
            let width = re.len() / side;
            for (part, first) in [(re, block * WIDTH), (im, inner / 2 + block * WIDTH)] {
                let (given, rest) = part.split_at_mut(inner * width);
                for (row, given) in grid.chunks_exact(inner).zip(given.chunks_exact_mut(width)) {
                    given.copy_from_slice(&row[first..first + width]);
                }
                rest.fill(T::zero());
            }
        });
    }

    /// Fills rows with the transforms of both columns of each pair.
    fn separate(&self, z: &Complex<T>, rows: &mut Complex<T>, is_shared: bool) {
        let Self { inner, side, .. } = *self;
        let (pairs, of_pairs, of_two) = (inner / 2, self.of_pairs(), T::of(0.5));
        in_chunks((WIDTH * side, is_shared), [&mut rows.re, &mut rows.im], &|block, [re, im]| {
            let width = re.len() / side;
            for columns in of_pairs.of_blocks() {
                for (k, y) in (block * WIDTH..).take(width).enumerate() {
                    let [a, b] = [y, (side - y) % side].map(|y| of_pairs.at(y, columns.start));
                    for (j, c) in columns.clone().enumerate() {
                        let (a, b, left, right) = (a + j, b + j, c * width + k, (c + pairs) * width + k);
                        re[left] = of_two * (z.re[a] + z.re[b]);
                        im[left] = of_two * (z.im[a] - z.im[b]);
                        re[right] = of_two * (z.im[a] + z.im[b]);
                        im[right] = of_two * (z.re[b] - z.re[a]);
                    }
                }
            }
            re[inner * width..].fill(T::zero());
            im[inner * width..].fill(T::zero());
        });
    }

    /// Multiplies rows by the transform of the kernel.
    fn multiply(&self, rows: &mut Complex<T>, is_shared: bool) {
        in_chunks((WIDTH * self.side, is_shared), [&mut rows.re, &mut rows.im], &|block, parts| {
            let factors = &self.spectrum[block * WIDTH * self.side..];
            if self.is_odd {
                let [re, im] = parts;
                for ((re, im), factor) in re.iter_mut().zip(im).zip(factors) {
                    (*re, *im) = (-(*im * *factor), *re * *factor);
                }
                return;
            }
            for part in parts {
                part.iter_mut().zip(factors).for_each(|(value, factor)| *value *= *factor);
            }
        });
    }

    /// Fills pairs of columns from rows.
    fn join(&self, rows: &Complex<T>, z: &mut Complex<T>, is_shared: bool) {
        let Self { inner, side, .. } = *self;
        let (pairs, of_rows) = (inner / 2, self.of_rows());
        in_chunks((WIDTH * side, is_shared), [&mut z.re, &mut z.im], &|block, [re, im]| {
            let width = re.len() / side;
            for columns in of_rows.of_blocks() {
                for (j, c) in (block * WIDTH..).take(width).enumerate() {
                    let [left, right] = [c, c + pairs].map(|c| of_rows.at(c, columns.start));
                    for (k, y) in columns.clone().enumerate() {
                        let (left, right) = (left + k, right + k);
                        re[y * width + j] = rows.re[left] - rows.im[right];
                        im[y * width + j] = rows.im[left] + rows.re[right];
                        if y > 0 && 2 * y < side {
                            re[(side - y) * width + j] = rows.re[left] + rows.im[right];
                            im[(side - y) * width + j] = rows.re[right] - rows.im[left];
                        }
                    }
                }
            }
        });
    }

    /// Puts pairs of columns into a grid.
    fn unpair(&self, z: &Complex<T>, grid: &mut [T]) {
        let (pairs, of_pairs) = (self.inner / 2, self.of_pairs());
        for (y, row) in grid.chunks_exact_mut(self.inner).enumerate() {
            for columns in of_pairs.of_blocks() {
                let (begin, width) = (of_pairs.at(y, columns.start), columns.len());
                row[columns.clone()].copy_from_slice(&z.re[begin..begin + width]);
                row[pairs + columns.start..pairs + columns.end].copy_from_slice(&z.im[begin..begin + width]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(i: usize) -> f64 {
        ((i * 7919 + 13) % 1009) as f64 / 1009.0 - 0.5
    }

    /// The sum that defines the transform, for every radix and mixtures of them, over several columns.
    #[test]
    fn transforms_are_their_sums() {
        for length in [2, 3, 4, 5, 6, 8, 10, 16, 30, 36, 60] {
            let (columns, transform) = (3, Transform::new(length));
            let count = columns * length;
            let mut data = Complex {
                re: (0..count).map(number).collect(),
                im: (0..count).map(|i| number(i + count)).collect(),
            };
            let given = data.clone();
            transform.forward(columns, &mut data, false);
            for k in 0..length {
                for c in 0..columns {
                    let (mut re, mut im) = (0.0, 0.0);
                    for j in 0..length {
                        let angle = -2.0 * PI * ((j * k) % length) as f64 / length as f64;
                        let (cos, sin, i) = (angle.cos(), angle.sin(), j * columns + c);
                        re += given.re[i] * cos - given.im[i] * sin;
                        im += given.re[i] * sin + given.im[i] * cos;
                    }
                    let i = k * columns + c;
                    assert!((data.re[i] - re).abs() + (data.im[i] - im).abs() < 1e-13, "{length}");
                }
            }
            transform.backward(columns, &mut data, false);
            let n = length as f64;
            assert!((0..count).all(|i| (data.re[i] / n - given.re[i]).abs() < 1e-14));
        }
    }

    /// A kernel that shifts both ways at once, and an odd one, by the sum that defines a convolution.
    #[test]
    fn convolutions_are_their_sums() {
        for (inner, side) in [(8, 8), (6, 12), (10, 20), (12, 30), (150, 160)] {
            // k(x, y) = (δ₀ + 0.5 δ₁ + 0.5 δ₋₁)(x) (δ₀ + 0.25 δ₂ + 0.25 δ₋₂)(y).
            let cosine = |k: usize, by: usize| (2.0 * PI * (k * by) as f64 / side as f64).cos();
            let spectrum = |x, y| (1.0 + cosine(x, 1)) * (1.0 + 0.5 * cosine(y, 2));
            let convolution = Convolution::new(inner, side, false, spectrum);
            let given: Vec<f64> = (0..inner * inner).map(number).collect();
            let mut grid = given.clone();
            convolution.apply(&mut grid, &mut ConvolutionScratch::default(), false);
            let mut by_many = given.clone();
            convolution.apply(&mut by_many, &mut ConvolutionScratch::default(), true);
            assert_eq!(grid, by_many);
            let at = |x: isize, y: isize| {
                let wrap = |i: isize| i.rem_euclid(side as isize) as usize;
                let (x, y) = (wrap(x), wrap(y));
                if x < inner && y < inner { given[y * inner + x] } else { 0.0 }
            };
            // The slopes 0.5 (δ₁ − δ₋₁)(x) (δ₀ + 0.25 δ₂ + 0.25 δ₋₂)(y), of which −i sin k is the transform.
            let sine = |k: usize| (2.0 * PI * k as f64 / side as f64).sin();
            let odd = Convolution::new(inner, side, true, |x, y| -sine(x) * (1.0 + 0.5 * cosine(y, 2)));
            let mut slopes = given.clone();
            odd.apply(&mut slopes, &mut ConvolutionScratch::default(), false);
            let rows = [(grid, [(0, 1.0), (1, 0.5), (-1, 0.5)]), (slopes, [(0, 0.0), (1, 0.5), (-1, -0.5)])];
            for (x, y) in (0..inner).flat_map(|y| (0..inner).map(move |x| (x, y))) {
                for (found, row) in &rows {
                    let mut sum = 0.0;
                    for (dx, wx) in row {
                        for (dy, wy) in [(0, 1.0), (2, 0.25), (-2, 0.25)] {
                            sum += wx * wy * at(x as isize - dx, y as isize - dy);
                        }
                    }
                    assert!((found[y * inner + x] - sum).abs() < 1e-14);
                }
            }
        }
    }
}
