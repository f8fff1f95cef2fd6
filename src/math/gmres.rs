//! Linear systems by their products alone: GMRES (Saad and Schultz 1986), without restart, in a fixed order
//! of operations.

use super::instruction_set::InstructionSet;
use super::real::Real;
use super::sums::lane_sum;

/// A solution and how it was found.
#[derive(Clone, Debug, Default)]
pub struct Solved {
    /// Products that were taken.
    pub products: usize,
    /// Norm of the residual over that of the right-hand side.
    pub residual: f64,
    /// The upper Hessenberg matrix of the products in their basis, column by column, each with one row more than
    /// its number: its eigenvalues are close to the outermost of the system.
    pub hessenberg: Vec<Vec<f64>>,
    /// The share of each vector of the basis in the solution.
    pub weights: Vec<f64>,
}

/// Memory of solutions, with a basis of numbers of a precision.
#[derive(Clone, Debug, Default)]
pub struct Memory<T> {
    basis: Vec<Vec<T>>,
    terms: Vec<f64>,
}

impl<T: Real> Memory<T> {
    /// Solves A x = b from nothing to a residual of `tolerance` times the right-hand side, with `most` products
    /// at most; `product` fills A v for v.
    pub fn solve(
        &mut self,
        right: &[f64],
        x: &mut [f64],
        (tolerance, most): (f64, usize),
        mut product: impl FnMut(&[T], &mut [T]),
    ) -> Solved {
        let n = right.len();
        x.fill(0.0);
        let norm = dot(&mut self.terms, right, right).sqrt();
        let mut solved = Solved::default();
        if !(norm > 0.0 && norm.is_finite()) {
            return solved;
        }
        self.vector(0, n).iter_mut().zip(right).for_each(|(v, b)| *v = T::of(b / norm));
        let mut triangle = Triangle { rotations: Vec::new(), columns: Vec::new(), rest: vec![norm] };
        for k in 0..most {
            let mut next = std::mem::take(self.vector(k + 1, n));
            product(&self.basis[k], &mut next);
            let column = self.orthogonalise(&mut next, k + 1);
            self.basis[k + 1] = next;
            solved.products = k + 1;
            solved.residual = triangle.push(column.clone()).abs() / norm;
            let is_last = solved.residual <= tolerance || !(column[k + 1] > 0.0);
            solved.hessenberg.push(column);
            if is_last {
                break;
            }
        }
        solved.weights = triangle.solution();
        for (weight, basis) in solved.weights.iter().zip(&self.basis) {
            add(x, *weight, basis);
        }
        solved
    }

    /// Makes the next vector of the basis from a product with the last; the column of the Hessenberg matrix.
    fn orthogonalise(&mut self, next: &mut [T], count: usize) -> Vec<f64> {
        let mut column = Vec::with_capacity(count + 1);
        let Self { basis, terms } = self;
        for basis in &basis[..count] {
            let along = dot(terms, basis, next);
            add(next, -along, basis);
            column.push(along);
        }
        let length = dot(terms, next, next).sqrt();
        column.push(length);
        if length > 0.0 {
            next.iter_mut().for_each(|v| *v = T::of(v.value() / length));
        }
        column
    }

    fn vector(&mut self, k: usize, n: usize) -> &mut Vec<T> {
        if self.basis.len() <= k {
            self.basis.push(Vec::new());
        }
        self.basis[k].resize(n, T::zero());
        &mut self.basis[k]
    }
}

fn dot<T: Real>(terms: &mut Vec<f64>, a: &[T], b: &[T]) -> f64 {
    terms.resize(a.len(), 0.0);
    InstructionSet::current().run(
        #[inline(always)]
        || {
            for ((term, a), b) in terms.iter_mut().zip(a).zip(b) {
                *term = a.value() * b.value();
            }
            lane_sum(terms)
        },
    )
}

/// The Hessenberg matrix made triangular by rotations, and the right-hand side with it.
struct Triangle {
    rotations: Vec<[f64; 2]>,
    columns: Vec<Vec<f64>>,
    rest: Vec<f64>,
}

impl Triangle {
    /// Adds a column of the Hessenberg matrix; the residual that is left.
    fn push(&mut self, mut column: Vec<f64>) -> f64 {
        let Self { rotations, columns, rest } = self;
        for (i, [cos, sin]) in rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (cos * a + sin * b, cos * b - sin * a);
        }
        let (k, length) = (rotations.len(), column[rotations.len() + 1]);
        let hypot = (column[k] * column[k] + length * length).sqrt();
        let [cos, sin] = if hypot > 0.0 { [column[k] / hypot, length / hypot] } else { [1.0, 0.0] };
        rotations.push([cos, sin]);
        column[k] = hypot;
        column.truncate(k + 1);
        columns.push(column);
        let last = rest[k];
        rest[k] = cos * last;
        rest.push(-sin * last);
        rest[k + 1]
    }

    /// The solution of the triangular system, from its last unknown on.
    fn solution(&self) -> Vec<f64> {
        let Self { columns, rest, .. } = self;
        let count = columns.len();
        let mut solution = vec![0.0; count];
        for k in (0..count).rev() {
            let known: f64 = (k + 1..count).map(|j| columns[j][k] * solution[j]).sum();
            solution[k] = if columns[k][k] > 0.0 { (rest[k] - known) / columns[k][k] } else { 0.0 };
        }
        solution
    }
}

/// x + factor · y in the place of x.
pub fn add<T: Real, U: Real>(x: &mut [T], factor: f64, y: &[U]) {
    InstructionSet::current().run(
        #[inline(always)]
        || {
            for (x, y) in x.iter_mut().zip(y) {
                *x = T::of(x.value() + factor * y.value());
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A system of 40 unknowns with the solution 1, 2, 3 ...
    #[test]
    fn solutions_solve() {
        let n = 40;
        let a =
            |i: usize, j: usize| f64::from(u8::from(i == j)) * 3.0 + ((i * 7 + j * 13) % 11) as f64 / 11.0;
        let product = |v: &[f64], out: &mut [f64]| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = v.iter().enumerate().map(|(j, v)| a(i, j) * v).sum();
            }
        };
        let truth: Vec<f64> = (0..n).map(|i| i as f64 + 1.0).collect();
        let (mut right, mut x) = (vec![0.0; n], vec![0.0; n]);
        product(&truth, &mut right);
        let solved = Memory::<f64>::default().solve(&right, &mut x, (1e-13, n), product);
        assert!(solved.residual <= 1e-13 && solved.products <= n);
        assert!(x.iter().zip(&truth).all(|(x, truth)| (x - truth).abs() < 1e-10), "{x:?}");
    }

    #[test]
    fn nothing_solves_nothing() {
        let mut x = [1.0; 3];
        let solved = Memory::<f64>::default().solve(&[0.0; 3], &mut x, (1e-9, 9), |_, _| unreachable!());
        assert_eq!((solved.products, x), (0, [0.0; 3]));
    }
}
