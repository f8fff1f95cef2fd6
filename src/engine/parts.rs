//! The pull-off and the stiffest place of a curve of which no kinks are known: at even parts of the spaces between samples.

use crate::math::extrema::{Extremum, deeper, largest_secant};

/// Parts of the space between two separations at whose ends the curve is looked at.
const PARTS: usize = 16;

/// The minimum of the external force from its samples alone: separations h, m, rising, and forces, N. The forces at every sixteenth of the
/// way between the neighbours of the smallest, which are asked for at once, are looked at too.
pub(super) fn deepest_of_parts(samples: &[(f64, f64)], forces: impl FnOnce(&[f64]) -> Vec<f64>) -> Extremum {
    let smallest = (1..samples.len()).fold(0, |best, k| if samples[k].1 < samples[best].1 { k } else { best });
    let at_edge = smallest == 0 || smallest + 1 == samples.len();
    let around = &samples[smallest.saturating_sub(1)..samples.len().min(smallest + 2)];
    let places: Vec<f64> = around
        .windows(2)
        .flat_map(|pair| {
            let step = (pair[1].0 - pair[0].0) / PARTS as f64;
            (1..PARTS).map(move |part| pair[0].0 + step * part as f64)
        })
        .collect();
    let forces = forces(&places);
    let deepest = places.into_iter().zip(forces).fold(samples[smallest], deeper);
    Extremum { place: deepest.0, value: deepest.1, at_edge: at_edge && deepest == samples[smallest] }
}

/// The largest secant stiffness over a span, m, in its middle, likewise: of spans that begin in the spaces beside the one where the samples
/// have it.
pub(super) fn stiffest_of_parts(
    samples: &[(f64, f64)],
    span: f64,
    forces: impl FnOnce(&[f64]) -> Vec<f64>,
) -> Extremum {
    let (separations, sampled): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
    let (first, last) = (separations[0], separations[separations.len() - 1] - span);
    let about = largest_secant(&separations, &sampled, span).place - 0.5 * span;
    let above = separations.partition_point(|h| *h < about).clamp(1, separations.len() - 1);
    let step = separations[above] - separations[above - 1];
    let parts = (0..=2 * PARTS).map(|i| about + step * (i as f64 / PARTS as f64 - 1.0));
    let mut places: Vec<f64> = parts.map(|h| h.clamp(first, last)).collect();
    places.dedup();
    let values = differences(&places, span, forces);
    let deepest = (1..places.len()).fold(0, |best, i| if values[i] < values[best] { i } else { best });
    let (place, value) = (places[deepest], -values[deepest] / span);
    Extremum { place: place + 0.5 * span, value, at_edge: place == first || place == last }
}

/// F(h) − F(h + s), N, at rising separations h, m, from `forces` at rising ones.
fn differences(separations: &[f64], span: f64, forces: impl FnOnce(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut places: Vec<f64> = separations.iter().flat_map(|h| [*h, h + span]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let forces = forces(&places);
    let force = |h: f64| forces[places.partition_point(|place| *place < h)];
    separations.iter().map(|h| force(*h) - force(h + span)).collect()
}
