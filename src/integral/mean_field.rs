//! The external force of a patch on its own half-space, by mean field.
//!
//! # Formula
//! Under the force F a patch is displaced by F/k_s. At the separation h of the surfaces far away its asperities see
//! the other surface at x = h + F/k_s, and F = F_GW(x), so that x − F_GW(x)/k_s = h. Where the attraction of the
//! integral is stiffer than k_s there are several such x: surfaces that are brought close follow the
//! outermost, and surfaces that are pulled back the innermost, as long as it is there. Where it ends they
//! jump to the next.
//!
//! # Validity
//! A uniform pressure: displacements are by the mean pressure alone.
//!
//! Source: Ciavarella, Greenwood and Paggi, Wear 265 (2008) 729.

/// Width of a bracket at which a root is known, in steps.
const ACCURACY: f64 = 1e-13;
/// Most steps, and most places that are looked at within one.
const MOST: (usize, usize) = (100_000, 200);

/// Surfaces on their way, as the asperities of a patch see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeanField {
    /// x, m, at each of the separations h of the way; NaN where there is none.
    pub separations: Vec<f64>,
    /// The external force F there, N.
    pub force: Vec<f64>,
    /// Indices of the separations to which the surfaces have jumped.
    pub jumps: Vec<usize>,
}

impl MeanField {
    /// The way through separations h, m, in their order, falling or rising, of a patch on a half-space of the
    /// stiffness k_s, N/m, whose integral is `force_at`, N, at any separation, m; it is looked at in steps of
    /// `step`, m. A way that begins at a state that is known begins at its x, `from`, m.
    pub fn new(
        separations: &[f64],
        stiffness: f64,
        step: f64,
        from: Option<f64>,
        force_at: impl Fn(f64) -> f64,
    ) -> Self {
        let Some(&first) = separations.first() else { return Self::default() };
        let is_outward = separations.last().is_some_and(|last| *last > first);
        let sign = if is_outward { 1.0 } else { -1.0 };
        // It has to rise on the way.
        let level = |x: f64| sign * (x - force_at(x) / stiffness);
        let mut way = Self::default();
        let mut x = from.unwrap_or(first);
        let mut here = level(x);
        let mut steps = 0..MOST.0;
        while from.is_none() && here > sign * first && steps.next().is_some() {
            x -= sign * step;
            here = level(x);
        }
        for (k, &h) in separations.iter().enumerate() {
            if k == 0 && from.is_some() {
                way.push(x, h, stiffness);
                continue;
            }
            let mut has_jumped = false;
            while here < sign * h && steps.next().is_some() {
                let next = x + sign * step;
                let there = level(next);
                has_jumped |= there < here;
                if there >= sign * h {
                    (x, here) = crossing(&level, [(x, here), (next, there)], sign * h, step);
                    break;
                }
                (x, here) = (next, there);
            }
            let is_found = here >= sign * h && !steps.is_empty();
            way.push(if is_found { x } else { f64::NAN }, h, stiffness);
            if has_jumped && k > 0 {
                way.jumps.push(k);
            }
        }
        way
    }

    fn push(&mut self, x: f64, h: f64, stiffness: f64) {
        self.separations.push(x);
        self.force.push(stiffness * (x - h));
    }

    /// The separations and forces in the opposite order.
    pub fn reversed(mut self) -> Self {
        let last = self.separations.len().saturating_sub(1);
        self.separations.reverse();
        self.force.reverse();
        self.jumps.iter_mut().for_each(|k| *k = last - *k);
        self
    }
}

/// The place where a function reaches a level between two of its points, by false position (Illinois), and
/// its value.
fn crossing(f: &impl Fn(f64) -> f64, [below, above]: [(f64, f64); 2], level: f64, step: f64) -> (f64, f64) {
    let mut ends = [(below.0, below.1 - level), (above.0, above.1 - level)];
    let mut found = above;
    let mut last = None;
    for _ in 0..MOST.1 {
        let [low, high] = ends;
        let x = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        let value = f(x);
        let end = usize::from(value >= level);
        let moved = (x - ends[end].0).abs();
        ends[end] = (x, value - level);
        if end == 1 {
            found = (x, value);
        }
        if moved <= ACCURACY * step {
            return (x, value.max(level));
        }
        // An end that stays is taken as half as far from the level.
        if last == Some(end) {
            ends[1 - end].1 *= 0.5;
        }
        last = Some(end);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::interpolation::linear;

    /// F in straight lines: 0 from x = 3 on, −8 at 1, and 8 − 16 x below.
    fn well(x: f64) -> f64 {
        linear(&[-9.0, 1.0, 3.0, 99.0], &[152.0, -8.0, 0.0, 0.0], x)
    }

    /// The attraction, of slope 4, is too stiff on k = 2: H is 3 at x = 3, rises to 5 at x = 1, and falls
    /// from there by 9 for each 1. Surfaces that come close are at x = h to h = 3 and then at 1 − (5 − h)/9;
    /// surfaces that are pulled back are there to h = 5, and then at h.
    #[test]
    fn several_states_are_taken_from_where_the_surfaces_come() {
        let h: Vec<f64> = (0..28).map(|k| 0.25 * f64::from(k) + 0.1).collect();
        let near = |h: f64| 1.0 - (5.0 - h) / 9.0;
        let falling: Vec<f64> = h.iter().rev().copied().collect();
        let inward = MeanField::new(&falling, 2.0, 0.125, None, well).reversed();
        let outward = MeanField::new(&h, 2.0, 0.125, None, well);
        for (k, &h) in h.iter().enumerate() {
            for (way, is_far) in [(&inward, h > 3.0), (&outward, h > 5.0)] {
                let expected = if is_far { h } else { near(h) };
                assert!((way.separations[k] - expected).abs() < 1e-12, "{h} {}", way.separations[k]);
                assert!((way.force[k] - well(expected)).abs() < 1e-11, "{h} {}", way.force[k]);
            }
        }
        assert_eq!((&inward.jumps[..], &outward.jumps[..]), (&[11][..], &[20][..]));
        // From a state that is known.
        let known = MeanField::new(&h[12..], 2.0, 0.125, Some(near(h[12])), well);
        assert_eq!(known.separations[0], near(h[12]));
        assert!((known.separations[3] - near(h[15])).abs() < 1e-12 && known.jumps == [8]);
    }

    /// One state on a stiff half-space, x = h + F/k: on k = 8 from h = 3 down to 2, H(1), at x = 3 − 2(3 −
    /// h).
    #[test]
    fn a_soft_attraction_shifts() {
        let falling: Vec<f64> = (0..40).map(|k| 4.05 - 0.1 * f64::from(k)).collect();
        let way = MeanField::new(&falling, 8.0, 0.125, None, well);
        assert!(way.jumps.is_empty());
        for (h, x) in falling.iter().zip(&way.separations) {
            let expected = match *h {
                h if h > 3.0 => h,
                h if h > 2.0 => 3.0 - 2.0 * (3.0 - h),
                h => 1.0 - (2.0 - h) / 3.0,
            };
            assert!((x - expected).abs() < 1e-12, "{h} {x} {expected}");
        }
    }

    /// Without a number there is no state.
    #[test]
    fn nothing_follows_from_what_is_not_a_number() {
        let way = MeanField::new(&[2.0, 1.0], 1.0, 0.1, None, |_| f64::NAN);
        assert!(way.separations.iter().chain(&way.force).all(|value| value.is_nan()));
    }
}
