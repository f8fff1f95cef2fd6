//! The deepest point of a curve by looking at all of it: both sides of every event, and what lies between
//! them.

use stiction::asperity::{Facing, Law, Scratch, SolverStats};
use stiction::math::sums::Compensated;

/// Interferences, m, at which a law is not smooth, from its boundaries and pieces.
pub fn events(law: &dyn Law) -> Vec<f64> {
    let boundaries = law.boundaries().iter().map(|boundary| boundary.interference);
    let pieces = law.pieces(None).into_iter().flat_map(|piece| [piece.lower, piece.upper]);
    let mut events: Vec<f64> = boundaries.chain(pieces).filter(|event| event.is_finite()).collect();
    events.sort_by(f64::total_cmp);
    events.dedup();
    events
}

/// External force, N, of rising heights at the separation d, m.
pub fn external_force(law: &dyn Law, heights: &[f64], d: f64) -> f64 {
    let (mut scratch, mut stats, mut sum) =
        (Scratch::default(), SolverStats::default(), Compensated::default());
    let facing = Facing { law, heights, separation: d };
    facing.for_each_block(&mut scratch, &mut stats, |_, range, responses| {
        for i in 0..range.len() {
            sum.add(responses.contact[i]);
            sum.add(-responses.adhesion[i]);
        }
    });
    sum.value()
}

/// Where a curve is deepest between the first and the last of rising places, and how deep, with its `events`;
/// spaces between neighbouring places are passed over where the curve at both is less deep than the deepest
/// of the places by more than the share `far` of that.
pub fn deepest(
    places: &[f64],
    mut events: Vec<f64>,
    far: f64,
    mut force: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    events.sort_by(f64::total_cmp);
    let forces: Vec<f64> = places.iter().map(|h| force(*h)).collect();
    let mut best = (f64::NAN, f64::INFINITY);
    for (h, force) in places.iter().zip(&forces) {
        if *force < best.1 {
            best = (*h, *force);
        }
    }
    let limit = best.1 + far * best.1.abs();
    for (space, ends) in places.windows(2).zip(forces.windows(2)) {
        if ends[0].min(ends[1]) > limit {
            continue;
        }
        let inside = events.iter().copied().filter(|event| *event > space[0] && *event < space[1]);
        let edges: Vec<f64> = [space[0]].into_iter().chain(inside).chain([space[1]]).collect();
        for edge in edges.windows(2) {
            let beside = 1e-14 * edge[1].abs().max(edge[0].abs()).max(1e-9);
            let (low, high) = (edge[0] + beside, edge[1] - beside);
            if low < high {
                let found = deepest_between(low, high, space[1] - space[0], &mut force);
                if found.1 < best.1 {
                    best = found;
                }
            }
        }
    }
    best
}

/// Where a smooth curve that may begin like a root at either end is deepest.
fn deepest_between(low: f64, high: f64, space: f64, force: &mut impl FnMut(f64) -> f64) -> (f64, f64) {
    let parts = if high - low < 1e-3 * space { 2 } else { 12 };
    let at = |share: f64| low + (high - low) * share * share * (3.0 - 2.0 * share);
    let shares: Vec<f64> = (0..=parts).map(|i| f64::from(i) / f64::from(parts)).collect();
    let values: Vec<f64> = shares.iter().map(|share| force(at(*share))).collect();
    let smallest = (0..values.len()).fold(0, |best, i| if values[i] < values[best] { i } else { best });
    let mut best = (at(shares[smallest]), values[smallest]);
    let (mut from, mut to) =
        (shares[smallest.saturating_sub(1)], shares[(smallest + 1).min(values.len() - 1)]);
    let turns = parts > 2;
    while turns && to - from > 1e-5 {
        let third = (to - from) / 3.0;
        let [a, b] = [from + third, to - third].map(|share| (share, force(at(share))));
        for (share, value) in [a, b] {
            if value < best.1 {
                best = (at(share), value);
            }
        }
        if a.1 < b.1 { to = b.0 } else { from = a.0 }
    }
    best
}

/// How deep a curve is at its deepest of even places and of even places around the deepest of these, again
/// and again: at most how deep it is, and where it jumps, to within a jump's last asperity.
fn deepest_of_looks(low: f64, high: f64, mut force: impl FnMut(f64) -> f64) -> (f64, f64) {
    const PLACES: usize = 1500;
    const CLOSER: usize = 40;
    let mut look = |low: f64, high: f64, places: usize| -> Vec<(f64, f64)> {
        let place = |i: usize| low + (high - low) * i as f64 / places as f64;
        (0..=places).map(|i| (place(i), force(place(i)))).collect()
    };
    let all = look(low, high, PLACES);
    let mut order: Vec<usize> = (1..PLACES).collect();
    order.sort_by(|a, b| all[*a].1.total_cmp(&all[*b].1));
    let mut best = all[order[0]];
    for i in order.into_iter().take(CLOSER / 2) {
        let (mut low, mut high) = (all[i - 1].0, all[i + 1].0);
        for _ in 0..6 {
            let closer = look(low, high, CLOSER);
            let k = (1..CLOSER).fold(1, |best, k| if closer[k].1 < closer[best].1 { k } else { best });
            (low, high) = (closer[k - 1].0, closer[k + 1].0);
            if closer[k].1 < best.1 {
                best = closer[k];
            }
        }
    }
    best
}

/// Requires that a curve has a pull-off where it is said to be, and that no look at it between two
/// separations, m, finds anything deeper.
#[track_caller]
pub fn require_deepest(
    what: &str,
    (place, pull_off): (f64, f64),
    (low, high): (f64, f64),
    force: impl Fn(f64) -> f64,
) {
    assert!(
        (force(place) / pull_off + 1.0).abs() < 1e-9,
        "{what}: {pull_off:e} N at {place:e} m is {:e}",
        force(place)
    );
    let (there, deepest) = deepest_of_looks(low, high, force);
    println!("{what}: {pull_off:e} N at {place:e} m, by looks {deepest:e} at {there:e}");
    assert!(
        -pull_off <= deepest * (1.0 - 1e-6),
        "{what}: {pull_off:e} N at {place:e} m, by looks {deepest:e} at {there:e}"
    );
}
