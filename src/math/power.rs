//! Whole powers: `f64::powi` of an exponent that varies is another function on Windows, with other last digits.

/// xⁿ by squaring.
pub fn power(x: f64, exponent: i32) -> f64 {
    let (mut square, mut left, mut product) = (x, exponent.unsigned_abs(), 1.0);
    loop {
        if left & 1 == 1 {
            product *= square;
        }
        left >>= 1;
        if left == 0 {
            break;
        }
        square *= square;
    }
    if exponent < 0 { 1.0 / product } else { product }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_are_those_that_are_written() {
        for exponent in -22..=22 {
            assert_eq!(power(10.0, exponent), format!("1e{exponent}").parse::<f64>().unwrap(), "{exponent}");
        }
        assert_eq!([power(-3.0, 3), power(0.5, -2), power(7.0, 0), power(0.0, 0)], [-27.0, 4.0, 1.0, 1.0]);
    }
}
