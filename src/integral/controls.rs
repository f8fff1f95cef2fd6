//! Separations at which the external force of a replica is a control variate for quantities without closed
//! form.

use super::expectations::Expectations;
use crate::asperity::Quantity;

/// Fewest groups of replicas per control: estimating their coefficients then costs about a tenth of the
/// variance.
const GROUPS_PER_CONTROL: u64 = 10;
/// The peak of the stiffness ends where the slope is this share of the largest.
const FLANK: f64 = 0.5;

/// Rising indices of at most 8 of the separations, m, at which the integral was taken, for an ensemble of
/// `groups`; none for fewer than 10. Only `eligible` ones are taken: where a few rare
/// asperities decide a mean, no covariance describes it.
///
/// They come from the integral, not from the sample, and explain pull-off and stiffest point
/// of a replica: the deepest point of the integral's curve; the ends and middles of the separations around it
/// where one standard deviation of a replica reaches as deep, because there a replica has its own deepest
/// point; the stiffest point, and the ends of its peak; each of them, or the nearest that is eligible. With
/// fewer groups they are the first of these.
pub fn controls(
    separations: &[f64],
    expectations: &Expectations,
    eligible: &[bool],
    groups: u64,
) -> Vec<usize> {
    let q = Quantity::ExternalForce.index();
    let (force, std) = (&expectations.expected[q], &expectations.std[q]);
    let last = force.len() - 1;
    let lowest = |curve: &dyn Fn(usize) -> f64, count: usize| {
        (1..count).fold(0, |best, k| if curve(k) < curve(best) { k } else { best })
    };
    let nearest = |place: usize| (0..=last).filter(|&k| eligible[k]).min_by_key(|&k| k.abs_diff(place));
    let deepest = lowest(&|k| force[k], force.len());
    let (low, high) = contiguous(deepest, last, |k| force[k] - std[k] <= force[deepest]);
    let slope = |k: usize| (force[k + 1] - force[k]) / (separations[k + 1] - separations[k]);
    let stiffest = lowest(&|k| -slope(k), last);
    let (begin, end) = contiguous(stiffest, last - 1, |k| slope(k) > FLANK * slope(stiffest));
    let [Some(deepest), Some(low), Some(high)] = [deepest, low, high].map(nearest) else { return Vec::new() };
    let middle = |a: usize, b: usize| (a + b).div_ceil(2);
    let wanted = [deepest, low, high, stiffest, middle(low, deepest), middle(deepest, high), begin, end + 1];
    let most = usize::try_from(groups / GROUPS_PER_CONTROL).unwrap_or(usize::MAX);
    let mut chosen: Vec<usize> = Vec::new();
    for k in wanted.into_iter().filter_map(nearest) {
        if chosen.len() < most && !chosen.contains(&k) {
            chosen.push(k);
        }
    }
    chosen.sort_unstable();
    chosen
}

/// The first and last index of the run around `inside`, from 0 to `last`, all of which belong.
fn contiguous(inside: usize, last: usize, belongs: impl Fn(usize) -> bool) -> (usize, usize) {
    let low = (0..inside).rev().take_while(|&k| belongs(k)).last().unwrap_or(inside);
    let high = (inside + 1..=last).take_while(|&k| belongs(k)).last().unwrap_or(inside);
    (low, high)
}
