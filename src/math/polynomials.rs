//! Values of polynomials.

/// Σ cᵢ xⁱ, the constant first.
#[inline(always)]
pub fn horner<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut value = coefficients[N - 1];
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        value = value * x + coefficients[i];
    }
    value
}

/// Σ cᵢ xⁱ of degree 7 by Estrin's scheme, which vector processors finish in half the time of Horner's
/// because less of it waits for the rest.
#[inline(always)]
pub fn estrin(coefficients: &[f64; 8], x: f64) -> f64 {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *coefficients;
    let square = x * x;
    let low = (c0 + c1 * x) + (c2 + c3 * x) * square;
    let high = (c4 + c5 * x) + (c6 + c7 * x) * square;
    low + high * (square * square)
}
