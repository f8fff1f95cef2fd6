//! The gap between two neighbouring kinks, in which a curve is smooth.

use crate::math::extrema::smallest;

/// Parts of the angle between two kinks, and the samples at their ends.
pub(super) const PARTS: usize = 6;
pub(super) const SAMPLED: usize = PARTS + 1;

/// A gap between two kinks, as far as it is in an interval.
#[derive(Clone, Copy)]
pub(super) struct Gap {
    /// The kinks, h, m.
    pub ends: (f64, f64),
    /// The part of it, h, m, and the angles θ at its ends.
    pub part: (f64, f64),
    pub from: f64,
    pub to: f64,
}

impl Gap {
    /// Between two kinks, the part in `low..high`, m; none if there is none.
    pub fn new((begin, end): (f64, f64), (low, high): (f64, f64)) -> Option<Self> {
        let part = (begin.max(low), end.min(high));
        let angle = |h: f64| 2.0 * libm::atan2((h - begin).sqrt(), (end - h).sqrt());
        (part.0 < part.1).then(|| Self { ends: (begin, end), part, from: angle(part.0), to: angle(part.1) })
    }

    /// The place of an angle.
    pub fn at(&self, angle: f64) -> f64 {
        let ((begin, end), half) = (self.ends, 0.5 * angle);
        let (sine, cosine) = (libm::sin(half), libm::cos(half));
        // From the nearer end, so that it keeps its digits.
        let near = sine < cosine;
        let place =
            if near { begin + (end - begin) * sine * sine } else { end - (end - begin) * cosine * cosine };
        place.clamp(self.part.0, self.part.1)
    }

    /// The places of even angles.
    pub fn places(&self) -> [f64; SAMPLED] {
        let step = (self.to - self.from) / PARTS as f64;
        std::array::from_fn(|i| match i {
            0 => self.part.0,
            PARTS => self.part.1,
            i => self.at(self.from + step * i as f64),
        })
    }
}

/// The lowest place of the parabola through the lowest of even samples and its neighbours, in steps, and its
/// value there.
pub(super) fn vertex(values: &[f64]) -> Option<(f64, f64)> {
    let lowest = smallest(values);
    let middle = lowest.clamp(1, values.len() - 2);
    let [a, b, c] = [values[middle - 1], values[middle], values[middle + 1]];
    let curvature = a - 2.0 * b + c;
    let step = 0.5 * (a - c) / curvature;
    (curvature > 0.0 && step.abs() < 1.0)
        .then(|| (middle as f64 + step, b - 0.125 * (a - c) * (a - c) / curvature))
}
