//! Bracketed root finding.

/// A function's value and slope at one place.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// f(x).
    pub value: f64,
    /// f'(x).
    pub slope: f64,
}

/// The end of a search.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// The last place evaluated.
    pub x: f64,
    /// Evaluations of the function.
    pub evaluations: u32,
}

/// Evaluations after which [`safe_newton`] stops in any case: 60 halvings and as many Newton steps.
pub const MAX_EVALUATIONS: u32 = 200;

/// Newton's method inside a bracket for a function that falls through zero, with bisection wherever Newton
/// leaves the bracket or fails to halve the value.
///
/// `f(low) ≥ 0 ≥ f(high)`, 0 ≤ low < high; a `start` outside them, or NaN, is replaced by the middle.
/// `done(x, sample)` decides when to stop; the caller usually adds the last Newton step itself. Also stops
/// when the bracket cannot shrink, or after [`MAX_EVALUATIONS`].
pub fn safe_newton(
    mut f: impl FnMut(f64) -> Sample,
    mut low: f64,
    mut high: f64,
    start: f64,
    done: impl Fn(f64, Sample) -> bool,
) -> Root {
    let mut x = if start > low && start < high { start } else { middle(low, high) };
    let mut previous = f64::INFINITY;
    for evaluations in 1..=MAX_EVALUATIONS {
        let sample = f(x);
        if sample.value == 0.0 || done(x, sample) {
            return Root { x, evaluations };
        }
        if sample.value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - sample.value / sample.slope;
        let halved = sample.value.abs() <= 0.5 * previous;
        previous = sample.value.abs();
        let next = if halved && newton > low && newton < high { newton } else { middle(low, high) };
        if next == x || next <= low || next >= high {
            return Root { x, evaluations };
        }
        x = next;
    }
    Root { x, evaluations: MAX_EVALUATIONS }
}

/// The root of a function between two places at which its values have opposite signs, without slopes: by false position after
/// Illinois, whose steps halve the value at an end that stays. `done` is asked of every place and value.
pub fn false_position(
    mut f: impl FnMut(f64) -> f64,
    mut from: (f64, f64),
    mut to: (f64, f64),
    done: impl Fn(f64, f64) -> bool,
) -> f64 {
    let mut kept = 0;
    for _ in 0..MAX_EVALUATIONS {
        let share = from.1 / (from.1 - to.1);
        let share = if share > 0.0 && share < 1.0 { share } else { 0.5 };
        let x = from.0 + share * (to.0 - from.0);
        if x == from.0 || x == to.0 {
            return x;
        }
        let value = f(x);
        if value == 0.0 || done(x, value) {
            return x;
        }
        if (value > 0.0) == (to.1 > 0.0) {
            to = (x, value);
            from.1 *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            from = (x, value);
            to.1 *= if kept == 2 { 0.5 } else { 1.0 };
            kept = 2;
        }
    }
    0.5 * (from.0 + to.0)
}

/// The middle of a bracket: geometric where it spans decades, so that small roots are found as fast as large
/// ones.
fn middle(low: f64, high: f64) -> f64 {
    if low > 0.0 && high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) }
}

/// The place of the maximum of `f` between `low` and `high` by golden section, to `tolerance` times the
/// interval.
pub fn golden_maximum(mut f: impl FnMut(f64) -> f64, mut low: f64, mut high: f64, tolerance: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let tolerance = tolerance * (high - low);
    let mut left = high - RATIO * (high - low);
    let mut right = low + RATIO * (high - low);
    let (mut at_left, mut at_right) = (f(left), f(right));
    while high - low > tolerance {
        if at_left < at_right {
            low = left;
            (left, at_left) = (right, at_right);
            right = low + RATIO * (high - low);
            at_right = f(right);
        } else {
            high = right;
            (right, at_right) = (left, at_left);
            left = high - RATIO * (high - low);
            at_left = f(left);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_a_root_from_any_start() {
        for start in [0.0, 1e-9, 0.3, 0.9999, 5.0] {
            let f = |x: f64| Sample { value: 0.5 - x.powi(9), slope: -9.0 * x.powi(8) };
            let root = safe_newton(f, 0.0, 1.0, start, |_, s| s.value.abs() < 1e-15);
            assert!((root.x - 0.5_f64.powf(1.0 / 9.0)).abs() < 1e-14, "start {start}: {root:?}");
            assert!(root.evaluations < 40, "start {start}: {root:?}");
        }
    }

    #[test]
    fn ends_on_a_step_that_has_no_root() {
        let step = |x: f64| Sample { value: if x < 0.25 { 1.0 } else { -1.0 }, slope: 0.0 };
        let root = safe_newton(step, 0.0, 1.0, 0.5, |_, _| false);
        assert!((root.x - 0.25).abs() < 1e-15 && root.evaluations < MAX_EVALUATIONS, "{root:?}");
    }

    #[test]
    fn ends_at_the_bound_where_nothing_converges() {
        // Newton's method gains a ninth with every step towards the multiple root at 0, and never meets
        // `done`.
        let multiple = |x: f64| Sample { value: -x.powi(9), slope: -9.0 * x.powi(8) };
        let root = safe_newton(multiple, 0.0, 1.0, 1.0, |_, _| false);
        assert_eq!(root.evaluations, MAX_EVALUATIONS);
        assert!(root.x > 0.0 && root.x < 1e-9, "{root:?}");
        // Values that are no numbers: halvings only, within the bracket.
        let root = safe_newton(|_| Sample { value: f64::NAN, slope: f64::NAN }, 0.0, 1.0, 0.5, |_, _| false);
        assert_eq!(root.evaluations, MAX_EVALUATIONS);
        assert!(root.x > 0.0 && root.x < 1.0, "{root:?}");
    }

    #[test]
    fn golden_section_finds_a_maximum() {
        let x = golden_maximum(|x| -(x - 0.3) * (x - 0.3), -1.0, 2.0, 1e-9);
        assert!((x - 0.3).abs() < 1e-7, "{x}");
    }
}
