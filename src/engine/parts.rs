//! The pull-off and the stiffest place of a curve of which no kinks are known: at even parts of the spaces
//! between samples, quarters first and quarters of these beside the best.

use crate::math::extrema::{Extremum, deeper, largest_secant};

/// Parts of a space that are looked at at once.
const PARTS: usize = 4;

/// The minimum of the external force from its samples alone: separations h, m, rising, and forces, N.
/// Places between the neighbours of the smallest are looked at too.
pub(super) fn deepest_of_parts(samples: &[(f64, f64)], forces: impl FnMut(&[f64]) -> Vec<f64>) -> Extremum {
    let smallest = samples.iter().copied().fold(samples[0], deeper);
    let at_edge = smallest.0 == samples[0].0 || smallest.0 == samples[samples.len() - 1].0;
    let (place, value) = smallest_of_parts(samples, 2, forces);
    Extremum { place, value, at_edge: at_edge && place == smallest.0 }
}

/// The largest secant stiffness over a span, m, in its middle, likewise: of spans that begin in the spaces
/// beside the one where the samples have it.
pub(super) fn stiffest_of_parts(
    samples: &[(f64, f64)],
    span: f64,
    mut forces: impl FnMut(&[f64]) -> Vec<f64>,
) -> Extremum {
    let (separations, sampled): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
    let (first, last) = (separations[0], separations[separations.len() - 1] - span);
    let mut differences = |places: &[f64]| differences(places, span, &mut forces);
    let (place, value) = if last <= first {
        (first, differences(&[first])[0])
    } else {
        let about = largest_secant(&separations, &sampled, span).place - 0.5 * span;
        let above = separations.partition_point(|h| *h < about).clamp(1, separations.len() - 1);
        let step = separations[above] - separations[above - 1];
        let parts = (0..=2 * PARTS).map(|i| about + step * (i as f64 / PARTS as f64 - 1.0));
        let mut places: Vec<f64> = parts.map(|h| h.clamp(first, last)).collect();
        places.dedup();
        let values = differences(&places);
        smallest_of_parts(&places.into_iter().zip(values).collect::<Vec<_>>(), 1, differences)
    };
    Extremum { place: place + 0.5 * span, value: -value / span, at_edge: place == first || place == last }
}

/// The smallest point of a curve, place and value, from some of its points at rising places and from `values`
/// at parts of the spaces beside the smallest, so many times.
fn smallest_of_parts(
    points: &[(f64, f64)],
    times: usize,
    mut values: impl FnMut(&[f64]) -> Vec<f64>,
) -> (f64, f64) {
    let mut points = points.to_vec();
    for _ in 0..times {
        let smallest =
            (1..points.len()).fold(0, |best, k| if points[k].1 < points[best].1 { k } else { best });
        let around = &points[smallest.saturating_sub(1)..points.len().min(smallest + 2)];
        let between = |pair: &[(f64, f64)]| {
            let (from, step) = (pair[0].0, (pair[1].0 - pair[0].0) / PARTS as f64);
            (1..PARTS).map(move |part| from + step * part as f64)
        };
        let places: Vec<f64> = around.windows(2).flat_map(between).collect();
        let found = values(&places);
        points = around.iter().copied().chain(places.into_iter().zip(found)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    points.iter().copied().fold(points[0], deeper)
}

/// F(h) − F(h + s), N, at rising separations h, m, from `forces` at rising ones.
fn differences(separations: &[f64], span: f64, forces: &mut impl FnMut(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut places: Vec<f64> = separations.iter().flat_map(|h| [*h, h + span]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let forces = forces(&places);
    let force = |h: f64| forces[places.partition_point(|place| *place < h)];
    separations.iter().map(|h| force(*h) - force(h + span)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: sin has its largest secants in the middle of what rises. A span that is wider than the
    /// samples begins with these.
    #[test]
    fn secants_are_found_between_samples_and_beyond_them() {
        let sin = |places: &[f64]| places.iter().map(|x| x.sin()).collect::<Vec<f64>>();
        let samples = |from: f64, step: f64, count: usize| -> Vec<(f64, f64)> {
            (0..count).map(|i| from + step * i as f64).map(|x| (x, x.sin())).collect()
        };
        let found = stiffest_of_parts(&samples(-1.0, 0.23, 10), 0.5, sin);
        assert!((found.value - 2.0 * 0.25f64.sin() / 0.5).abs() < 1e-4 && !found.at_edge, "{found:?}");
        for span in [0.3, 0.4] {
            let found = stiffest_of_parts(&samples(0.1, 0.3, 2), span, sin);
            let secant = ((0.1 + span).sin() - 0.1f64.sin()) / span;
            assert!((found.value - secant).abs() < 1e-15 && found.at_edge, "{found:?}");
            assert_eq!(found.place, 0.1 + 0.5 * span);
        }
    }
}
