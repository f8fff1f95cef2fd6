//! Nonlinear least squares by the Levenberg-Marquardt method.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Const, Dyn, OMatrix, OVector, SVector};

/// Parameters of a fit and what it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<const N: usize> {
    /// The parameters.
    pub parameters: [f64; N],
    /// Σ residual².
    pub sum_of_squares: f64,
}

/// Fits `model`, which gives the value at a place and its derivatives by the N parameters, to `values` at
/// `places`, from each of the `starts`, to rounding or to a relative `tolerance` of the sum of squares and of the
/// parameters; the best of the fits. `None` when no start leads to finite values.
pub fn least_squares<const N: usize>(
    model: impl Fn(&[f64; N], f64) -> (f64, [f64; N]) + Copy,
    places: &[f64],
    values: &[f64],
    starts: &[[f64; N]],
    tolerance: Option<f64>,
) -> Option<Fit<N>> {
    let to_rounding = LevenbergMarquardt::new();
    let method = tolerance.map_or(to_rounding, |tolerance| to_rounding.with_tol(tolerance));
    let fits = starts.iter().map(|start| {
        let problem = Problem { model, places, values, parameters: SVector::from(*start) };
        let (problem, report) = method.minimize(problem);
        Fit { parameters: problem.parameters.into(), sum_of_squares: 2.0 * report.objective_function }
    });
    let finite =
        fits.filter(|fit| fit.sum_of_squares.is_finite() && fit.parameters.iter().all(|p| p.is_finite()));
    finite.min_by(|a, b| a.sum_of_squares.total_cmp(&b.sum_of_squares))
}

struct Problem<'a, F, const N: usize> {
    model: F,
    places: &'a [f64],
    values: &'a [f64],
    parameters: SVector<f64, N>,
}

impl<F: Fn(&[f64; N], f64) -> (f64, [f64; N]), const N: usize> Problem<'_, F, N> {
    fn at(&self, i: usize) -> (f64, [f64; N]) {
        (self.model)(&self.parameters.into(), self.places[i])
    }
}

impl<F: Fn(&[f64; N], f64) -> (f64, [f64; N]), const N: usize> LeastSquaresProblem<f64, Dyn, Const<N>>
    for Problem<'_, F, N>
{
    type ResidualStorage = nalgebra::storage::Owned<f64, Dyn>;
    type JacobianStorage = nalgebra::storage::Owned<f64, Dyn, Const<N>>;
    type ParameterStorage = nalgebra::storage::Owned<f64, Const<N>>;

    fn set_params(&mut self, parameters: &SVector<f64, N>) {
        self.parameters = *parameters;
    }

    fn params(&self) -> SVector<f64, N> {
        self.parameters
    }

    fn residuals(&self) -> Option<OVector<f64, Dyn>> {
        let residual = |i, _| self.at(i).0 - self.values[i];
        let residuals = OVector::from_fn_generic(Dyn(self.places.len()), Const::<1>, residual);
        residuals.iter().all(|residual: &f64| residual.is_finite()).then_some(residuals)
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, Const<N>>> {
        let mut jacobian = OMatrix::<f64, Dyn, Const<N>>::zeros(self.places.len());
        for (i, mut row) in jacobian.row_iter_mut().enumerate() {
            row.copy_from_slice(&self.at(i).1);
        }
        jacobian.iter().all(|slope| slope.is_finite()).then_some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decay whose parameters are known, from a bad and a hopeless start.
    #[test]
    fn finds_the_parameters_of_exact_values() {
        let model = |p: &[f64; 3], x: f64| {
            let decay = (-p[1] * x).exp();
            (p[0] * decay + p[2], [decay, -x * p[0] * decay, 1.0])
        };
        let places: Vec<f64> = (0..50).map(|i| 0.1 * f64::from(i)).collect();
        let values: Vec<f64> = places.iter().map(|x| 2.5 * (-1.3 * x).exp() + 0.4).collect();
        let fit = least_squares(model, &places, &values, &[[f64::NAN; 3], [1.0, 0.5, 0.0]], None).unwrap();
        for (parameter, exact) in fit.parameters.into_iter().zip([2.5, 1.3, 0.4]) {
            assert!((parameter - exact).abs() < 1e-10, "{fit:?}");
        }
        assert!(least_squares(model, &places, &values, &[[f64::NAN; 3]], None).is_none());
    }
}
