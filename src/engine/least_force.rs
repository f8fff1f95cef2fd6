//! The smallest force of a surface between states that it has passed, to a tolerance.
//!
//! # Method
//! Forces are known at places along a way. Between the neighbours l and r of the smallest one, m, the curve is either smooth or jumps.
//! A smooth one is refined around the vertex of the parabola through the three; it is known where both neighbours are within the
//! tolerance. A curve that jumps behind m is smooth up to there: straight lines through l and m, and through l and the place before it,
//! bound from below what it can have between l and r. So do the lines from the other side where it jumps before m. What is not bounded
//! is halved.

use crate::math::extrema::{Extremum, minimum, smallest};

/// Tolerance up to which further states are no more than half as many as samples, or between two numbers; finer ones may have more for
/// each halving.
const COARSE: f64 = 1e-3;
const FEWEST: usize = 12;
const MOST: usize = 24;
const OF_HALVING: usize = 3;
/// Share of the larger difference in force from a neighbour that is left of a smooth curve in a closer bracket.
const SMOOTH: f64 = 0.3;
/// Share of the slope of a part that the part before it has at least, where the curve is smooth up to there.
const STEEP: f64 = 0.5;
/// Length of a part over the other part up to which its slope is known well enough for that.
const BALANCED: f64 = 4.0;
/// Share of a part next to a known place in which no further one is taken.
const CLOSE: f64 = 0.01;

/// A place on a way, m, with the force there, N, and the state, if that was kept.
#[derive(Clone, Debug)]
pub(super) struct Known<S> {
    pub place: f64,
    pub force: f64,
    pub state: Option<S>,
}

/// The smallest force at and next to the smallest of samples in the order of a way, to a relative tolerance. The smallest and the one
/// before it have their states; `travel` goes from a state to places, in the order of the way, and has force and state at each.
pub(super) fn least_force<S>(
    mut known: Vec<Known<S>>,
    tolerance: f64,
    mut travel: impl FnMut(&S, &[f64]) -> Vec<(f64, S)>,
) -> Extremum {
    let (mut rise, mut left) = (f64::INFINITY, most(known.len(), tolerance));
    loop {
        let at = smallest(&known.iter().map(|one| one.force).collect::<Vec<f64>>());
        let least = Extremum { place: known[at].place, value: known[at].force, at_edge: false };
        if at == 0 || at + 1 == known.len() {
            return Extremum { at_edge: true, ..least };
        }
        let bracket = Bracket::new(&known, at, tolerance);
        if let Some(found) = bracket.end() {
            return found;
        }
        let is_smooth = bracket.rise() <= SMOOTH * rise;
        rise = bracket.rise();
        let parts = bracket.next(is_smooth);
        if parts.iter().map(Vec::len).sum::<usize>() == 0 || left == 0 {
            return least;
        }
        for (k, one) in known.iter_mut().enumerate() {
            if k != at && k + 1 != at {
                one.state = None;
            }
        }
        for (part, places) in parts.iter().enumerate().rev() {
            let start = known[at - 1 + part].state.as_ref().expect("it is kept");
            let taken = &places[..places.len().min(left)];
            left -= taken.len();
            let found: Vec<Known<S>> = taken
                .iter()
                .zip(travel(start, taken))
                .map(|(&place, (force, state))| Known { place, force, state: Some(state) })
                .collect();
            known.splice(at + part..at + part, found);
        }
    }
}

/// Most further states: where single asperities come and go, a curve has more small jumps than it is worth to look at.
fn most(samples: usize, tolerance: f64) -> usize {
    let halvings = (COARSE / tolerance).max(1.0).log2().ceil() as usize;
    (samples / 2).clamp(FEWEST, MOST) + OF_HALVING * halvings
}

/// The smallest of the known forces with its neighbours.
struct Bracket {
    /// Places, m, and forces, N, of l, m and r.
    places: [f64; 3],
    forces: [f64; 3],
    /// Slopes, N/m, before l and behind r; none at the ends of the way.
    before: Option<f64>,
    behind: Option<f64>,
    /// The error of the force, N, that is allowed.
    allowed: f64,
}

impl Bracket {
    fn new<S>(known: &[Known<S>], at: usize, tolerance: f64) -> Self {
        let three = [&known[at - 1], &known[at], &known[at + 1]];
        let slope = |a: &Known<S>, b: &Known<S>| (b.force - a.force) / (b.place - a.place);
        Self {
            places: three.map(|one| one.place),
            forces: three.map(|one| one.force),
            before: (at >= 2).then(|| slope(&known[at - 2], three[0])),
            behind: known.get(at + 2).map(|next| slope(three[2], next)),
            allowed: tolerance * known[at].force.abs(),
        }
    }

    /// The larger difference in force from a neighbour, N.
    fn rise(&self) -> f64 {
        let [first, least, last] = self.forces;
        first.max(last) - least
    }

    /// Whether a part is far longer than the other one.
    fn is_longer(&self, part: usize) -> bool {
        let [a, b, c] = self.places;
        let lengths = [b - a, c - b].map(f64::abs);
        lengths[part] > BALANCED * lengths[1 - part]
    }

    /// How far below the smallest force the curve can be, N, in the parts before and behind it, by lines from the left; then by
    /// lines from the right. Without bound where the slopes are not those of a curve that is smooth up to there.
    fn bounds(&self) -> [[f64; 2]; 2] {
        let ([a, b, c], [f, g, h]) = (self.places, self.forces);
        let (one, two) = ((g - f) / (b - a), (h - g) / (c - b));
        let before = self.before.filter(|slope| slope / one >= STEEP && !self.is_longer(0));
        let behind = self.behind.filter(|slope| slope / two >= STEEP && !self.is_longer(1));
        let of_left = [before.map_or(f64::INFINITY, |slope| g - f - slope * (b - a)), -one * (c - b)];
        let of_right = [two * (b - a), behind.map_or(f64::INFINITY, |slope| g - h + slope * (c - b))];
        [of_left, of_right]
    }

    /// The smallest force where it is known well enough.
    fn end(&self) -> Option<Extremum> {
        let is_within = |bounds: [f64; 2]| bounds.iter().all(|bound| *bound <= self.allowed);
        if self.rise() <= self.allowed {
            return Some(minimum(&self.places, &self.forces));
        }
        let least = Extremum { place: self.places[1], value: self.forces[1], at_edge: false };
        self.bounds().into_iter().any(is_within).then_some(least)
    }

    /// Further places in the parts before and behind the smallest force.
    fn next(&self, is_smooth: bool) -> [Vec<f64>; 2] {
        let [a, b, c] = self.places;
        let parabola = minimum(&self.places, &self.forces);
        let curvature = ((self.forces[2] - self.forces[1]) / (c - b)
            - (self.forces[1] - self.forces[0]) / (b - a))
            / (c - a);
        if is_smooth && curvature > 0.0 {
            let half = (0.5 * self.allowed / curvature).sqrt().copysign(c - a);
            let around = [-half, 0.0, half].map(|by| parabola.place + by);
            let within = |from: f64, to: f64| {
                let is_inside = |place: &f64| (CLOSE..=1.0 - CLOSE).contains(&((place - from) / (to - from)));
                around.iter().copied().filter(is_inside).collect()
            };
            return [within(a, b), within(b, c)];
        }
        // Lines from one side bound the part on that side: what is left is the other part.
        let ([before, behind], [left, right]) = ([0.5 * (a + b), 0.5 * (b + c)], self.bounds());
        match (left[0] <= self.allowed, right[1] <= self.allowed) {
            _ if self.is_longer(0) => [vec![before], Vec::new()],
            _ if self.is_longer(1) => [Vec::new(), vec![behind]],
            (true, is_right) if !is_right || left[1] < right[0] => [Vec::new(), vec![behind]],
            (_, true) => [vec![before], Vec::new()],
            _ => [vec![before], vec![behind]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest force of a curve sampled at rising or falling places, and the number of further states.
    fn found(places: &[f64], tolerance: f64, curve: impl Fn(f64) -> f64) -> (Extremum, usize) {
        let mut count = 0;
        let known = |place: &f64| Known { place: *place, force: curve(*place), state: Some(()) };
        let least = least_force(places.iter().map(known).collect(), tolerance, |(), places| {
            count += places.len();
            places.iter().map(|place| (curve(*place), ())).collect()
        });
        (least, count)
    }

    fn steps(count: usize, reversed: bool) -> Vec<f64> {
        let mut places: Vec<f64> = (0..=count).map(|k| 10.0 * k as f64 / count as f64).collect();
        if reversed {
            places.reverse();
        }
        places
    }

    /// −exp(−(x − c)²/2) is least at c; from coarse samples to all tolerances, both ways.
    #[test]
    fn a_smooth_curve_needs_few_states() {
        for (center, tolerance, reversed) in [3.21, 5.0, 6.66].into_iter().flat_map(|c| {
            [1e-2, 1e-3, 1e-5].map(|t| (c, t, false)).into_iter().chain([1e-3].map(|t| (c, t, true)))
        }) {
            let (least, count) =
                found(&steps(15, reversed), tolerance, |x| -libm::exp(-0.5 * (x - center) * (x - center)));
            assert!((least.value + 1.0).abs() <= tolerance, "{center} {tolerance:e}: {}", least.value);
            assert!(count <= 9 && !least.at_edge, "{center} {tolerance:e}: {count} states");
        }
    }

    /// −x up to where it jumps to 0, and 0 up to where it jumps to −(10 − x): least next to the jump.
    #[test]
    fn a_jump_is_halved_up_to_the_tolerance() {
        for jump in [3.21, 6.62] {
            for (tolerance, most) in [(1e-2, 9), (1e-3, 14), (1e-4, 18)] {
                let (least, count) = found(&steps(40, false), tolerance, |x| if x < jump { -x } else { 0.0 });
                assert!(
                    (least.value + jump).abs() <= tolerance * jump,
                    "{jump} {tolerance:e}: {}",
                    least.value
                );
                assert!(count <= most, "{jump} {tolerance:e}: {count} states");
                let (least, count) =
                    found(&steps(40, false), tolerance, |x| if x > jump { x - 10.0 } else { 0.0 });
                let exact = jump - 10.0;
                assert!(
                    (least.value - exact).abs() <= tolerance * -exact,
                    "{jump} {tolerance:e}: {}",
                    least.value
                );
                assert!(count <= most, "{jump} {tolerance:e}: {count} states");
            }
        }
    }

    /// Where samples are close enough there is nothing to do; the smallest at an end stays there.
    #[test]
    fn what_is_known_well_enough_needs_no_state() {
        let (least, count) = found(&steps(1000, false), 1e-3, |x| (x - 4.0) * (x - 4.0) - 1.0);
        assert_eq!((least.value, count), (-1.0, 0));
        let (least, count) = found(&steps(10, false), 1e-3, |x| x);
        assert_eq!((least.value, least.at_edge, count), (0.0, true, 0));
    }
}
