//! Sums whose order, and so whose bits, never depends on the machine.

/// Relative rounding of a sum of asperities' forces of one sign: in a block of 256 a lane adds
/// 32 numbers, 31 roundings, and 3 combine the lanes; blocks and regimes are added with compensation, 2
/// roundings each, whatever their number (Neumaier 1974). A rounding is half of epsilon.
pub const SUM_ROUNDING: f64 = 19.0 * f64::EPSILON;

/// The sum of a slice in eight interleaved lanes, combined pairwise.
#[inline(always)]
pub fn lane_sum(values: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let chunks = values.chunks_exact(8);
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    for (lane, value) in lanes.iter_mut().zip(rest) {
        *lane += value;
    }
    ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
}

/// Σ aᵢ bᵢ in eight lanes, as [`lane_sum`] adds.
#[inline(always)]
pub fn lane_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = (a.remainder(), b.remainder());
    for (a, b) in a.zip(b) {
        for i in 0..8 {
            lanes[i] += a[i] * b[i];
        }
    }
    for (lane, (a, b)) in lanes.iter_mut().zip(rest.0.iter().zip(rest.1)) {
        *lane += a * b;
    }
    lane_sum(&lanes)
}

/// A running sum that carries its rounding error along (Neumaier 1974).
#[derive(Clone, Copy, Debug, Default)]
pub struct Compensated {
    sum: f64,
    carried: f64,
}

impl Compensated {
    /// Adds one value.
    #[inline]
    pub fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        self.carried +=
            if self.sum.abs() >= value.abs() { (self.sum - sum) + value } else { (value - sum) + self.sum };
        self.sum = sum;
    }

    /// Adds another sum with what it carries.
    pub fn merge(&mut self, other: &Self) {
        self.add(other.sum);
        self.carried += other.carried;
    }

    /// The sum.
    #[inline]
    pub fn value(&self) -> f64 {
        self.sum + self.carried
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_sum_every_value_once() {
        for n in 0..40 {
            let values: Vec<f64> = (0..n).map(|i| f64::from(i) + 1.0).collect();
            assert_eq!(lane_sum(&values), f64::from(n) * f64::from(n + 1) / 2.0);
        }
    }

    #[test]
    fn compensation_keeps_what_a_plain_sum_loses() {
        let mut sum = Compensated::default();
        for value in [1.0, 1e100, 1.0, -1e100] {
            sum.add(value);
        }
        assert_eq!(sum.value(), 2.0);
    }

    #[test]
    fn merging_keeps_what_both_carry() {
        let of = |values: [f64; 2]| {
            let mut sum = Compensated::default();
            values.into_iter().for_each(|value| sum.add(value));
            sum
        };
        let mut sum = of([1.0, 1e100]);
        sum.merge(&of([-1e100, 1.0]));
        assert_eq!(sum.value(), 2.0);
    }
}
