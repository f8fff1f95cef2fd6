//! Extrema of sampled curves, refined between the samples.

use super::interpolation::linear;
use super::roots::golden_maximum;

/// A place and the value there.
///
/// # Examples
/// ```
/// use stiction::Extremum;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let Extremum { place, value, at_edge } = stiction::integrate(&scene)?.main.features.minimum;
/// assert!(value < 0.0 && !at_edge, "pulled off within the separations");
/// assert!(scene.separations[0] < place);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Place of the extremum.
    pub place: f64,
    /// Value there.
    pub value: f64,
    /// Whether it is the first or the last sample, so that the curve may go further beyond the samples.
    pub at_edge: bool,
}

/// The larger of two numbers; NaN if one of them is, which `f64::max` would pass over.
pub fn maximum(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The index of the smallest of some values, the first of them where several are; 0 of none.
pub fn smallest(values: &[f64]) -> usize {
    (1..values.len()).fold(0, |best, k| if values[k] < values[best] { k } else { best })
}

/// The one of two points, place and value, with the smaller value.
pub fn deeper(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

/// The minimum of a curve sampled at rising or falling places: the vertex of the parabola through the smallest sample
/// and its neighbours, or the smallest sample itself at an edge. Spacings may differ. For a smooth curve with
/// samples Δ apart the value is off by O(Δ³) of its third derivative, and by nothing for a parabola.
///
/// `places` and `values` have the same length, at least 1.
pub fn minimum(places: &[f64], values: &[f64]) -> Extremum {
    let smallest = smallest(values);
    let sample = Extremum { place: places[smallest], value: values[smallest], at_edge: true };
    if smallest == 0 || smallest + 1 == values.len() {
        return sample;
    }
    let [x0, x1, x2] = [places[smallest - 1], places[smallest], places[smallest + 1]];
    let [y0, y1, y2] = [values[smallest - 1], values[smallest], values[smallest + 1]];
    let left = (y1 - y0) / (x1 - x0);
    let right = (y2 - y1) / (x2 - x1);
    let curvature = (right - left) / (x2 - x0);
    if !(curvature > 0.0 && curvature.is_finite()) {
        return Extremum { at_edge: false, ..sample };
    }
    // Slope of the parabola at the middle sample: the differences weighted by the opposite spacing.
    let slope = (left * (x2 - x1) + right * (x1 - x0)) / (x2 - x0);
    let step = -slope / (2.0 * curvature);
    Extremum { place: x1 + step, value: y1 + 0.5 * slope * step, at_edge: false }
}

/// The largest secant slope over a span, in the middle of it, of a curve in straight lines between its
/// samples: one end of the span is at a sample.
///
/// `places` (rising) and `values` have the same length, at least 2, and reach over the span.
pub fn largest_secant(places: &[f64], values: &[f64], span: f64) -> Extremum {
    let (first, last) = (places[0], places[places.len() - 1]);
    let curve = |x: f64| linear(places, values, x);
    let begins = places.iter().flat_map(|&place| [place, place - span]);
    let begins = begins.filter(|&begin| begin >= first && begin + span <= last).chain([last - span]);
    let secant = |begin: f64| Extremum {
        place: begin + 0.5 * span,
        value: (curve(begin + span) - curve(begin)) / span,
        at_edge: begin == first || begin == last - span,
    };
    let steeper = |best: Extremum, begin: f64| {
        let other = secant(begin);
        if other.value > best.value { other } else { best }
    };
    begins.fold(secant(first), steeper)
}

/// Minimum and largest slope of a smooth curve that can be asked for anywhere.
///
/// # Examples
/// ```
/// use stiction::Features;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let integral = stiction::integrate(&scene)?.main;
/// let Features { minimum, steepest } = integral.features;
/// assert_eq!(integral.pull_off(), -minimum.value);
/// assert!(steepest.place > minimum.place, "the surfaces snap before they are pulled hardest");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// The minimum.
    pub minimum: Extremum,
    /// The largest slope.
    pub steepest: Extremum,
}

/// Accuracy of the places, relative to the spacing of the samples.
const PLACE_TOLERANCE: f64 = 1e-5;
/// Length over which a slope is taken, relative to the spacing of the samples, which it should resolve.
const SLOPE_LENGTH: f64 = 1e-2;

impl Features {
    /// Searches for the minimum between the neighbours of the smallest sample, and for the largest slope
    /// on the steepest piece and its neighbours. Where samples are further apart than `spacing`, which
    /// resolves the curve, it is sampled between them too.
    ///
    /// `places` (rising) and `values` have the same length, at least 2, and sample `curve`.
    pub fn new(curve: impl Fn(f64) -> f64, places: &[f64], values: &[f64], spacing: f64) -> Self {
        let (places, values) = refined(&curve, places, values, spacing);
        let slope = |k: usize| (values[k + 1] - values[k]) / (places[k + 1] - places[k]);
        let smallest = smallest(&values);
        let steepest = (1..values.len() - 1).fold(0, |best, k| if slope(k) > slope(best) { k } else { best });
        let minimum = between(&curve, &places, smallest, values[smallest]);
        let steepest = if steepest == 0 || steepest + 2 == values.len() {
            let place = 0.5 * (places[steepest] + places[steepest + 1]);
            Extremum { place, value: slope(steepest), at_edge: true }
        } else {
            let half = 0.5 * SLOPE_LENGTH * (places[steepest + 1] - places[steepest]);
            let local = |x: f64| (curve(x + half) - curve(x - half)) / (2.0 * half);
            let place = golden_maximum(local, places[steepest - 1], places[steepest + 2], PLACE_TOLERANCE);
            Extremum { place, value: local(place), at_edge: false }
        };
        Self { minimum, steepest }
    }
}

/// The minimum between the neighbours of a sample.
fn between(curve: impl Fn(f64) -> f64, places: &[f64], smallest: usize, value: f64) -> Extremum {
    if smallest == 0 || smallest + 1 == places.len() {
        return Extremum { place: places[smallest], value, at_edge: true };
    }
    let (low, high) = (places[smallest - 1], places[smallest + 1]);
    let place = golden_maximum(|x| -curve(x), low, high, PLACE_TOLERANCE);
    Extremum { place, value: curve(place), at_edge: false }
}

/// Most samples that are added to a curve.
const MOST_ADDED: f64 = 400.0;

/// Samples of a curve with even ones added wherever they are further apart than `spacing`, or than what so
/// many added ones leave.
fn refined(curve: impl Fn(f64) -> f64, places: &[f64], values: &[f64], spacing: f64) -> (Vec<f64>, Vec<f64>) {
    let spacing = maximum(spacing, (places[places.len() - 1] - places[0]) / MOST_ADDED);
    let mut samples = vec![(places[0], values[0])];
    for (ends, values) in places.windows(2).zip(values.windows(2)) {
        // What is wider by its rounding alone is not divided.
        let parts = ((ends[1] - ends[0]) / spacing * (1.0 - 1e-9)).ceil().max(1.0);
        let between = (1..parts as usize).map(|i| ends[0] + (ends[1] - ends[0]) * i as f64 / parts);
        samples.extend(between.map(|place| (place, curve(place))));
        samples.push((ends[1], values[1]));
    }
    samples.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_met_exactly_on_uneven_samples() {
        let places = [0.0, 0.4, 1.0, 1.3, 2.2];
        let values = places.map(|x: f64| 3.0 * (x - 0.9) * (x - 0.9) - 2.0);
        let minimum = minimum(&places, &values);
        assert!(
            (minimum.place - 0.9).abs() < 1e-14 && (minimum.value + 2.0).abs() < 1e-14 && !minimum.at_edge
        );
    }

    #[test]
    fn features_do_not_depend_on_the_samples() {
        let curve = |x: f64| -1.0 / (1.0 + x * x);
        for count in [8, 50] {
            let places: Vec<f64> =
                (0..count).map(|i| -3.1 + 6.0 * f64::from(i) / f64::from(count - 1)).collect();
            let values: Vec<f64> = places.iter().map(|x| curve(*x)).collect();
            let features = Features::new(curve, &places, &values, f64::INFINITY);
            // The steepest rise of −1/(1 + x²) is √27/8 at 1/√3.
            assert!(
                features.minimum.place.abs() < 1e-4 && (features.minimum.value + 1.0).abs() < 1e-8,
                "{features:?}"
            );
            assert!((features.steepest.place - 3f64.sqrt().recip()).abs() < 1e-4, "{features:?}");
            assert!((features.steepest.value - 27f64.sqrt() / 8.0).abs() < 1e-4, "{features:?}");
        }
    }

    /// Two samples on either side of what the curve does, and uneven ones, say as much as many.
    #[test]
    fn what_lies_between_the_samples_is_found() {
        let curve = |x: f64| -1.0 / (1.0 + 25.0 * x * x);
        for places in [&[-6.1, 6.3][..], &[-6.1, -3.0, -2.9, 5.0, 8.0], &[-2.0, -1.0, 1.1, 1.2]] {
            let values: Vec<f64> = places.iter().map(|x| curve(*x)).collect();
            let features = Features::new(curve, places, &values, 0.1);
            assert!(
                features.minimum.place.abs() < 1e-4 && (features.minimum.value + 1.0).abs() < 1e-6,
                "{features:?}"
            );
            assert!((features.steepest.place - 75f64.sqrt().recip()).abs() < 1e-4, "{features:?}");
            assert!((features.steepest.value - 5.0 * 27f64.sqrt() / 8.0).abs() < 1e-3, "{features:?}");
        }
        // Samples that resolve it are taken as they are.
        let places: Vec<f64> = (0..11).map(|i| 0.1 * f64::from(i)).collect();
        let asked = std::cell::Cell::new(0);
        let count = |_: f64| f64::from(asked.replace(asked.get() + 1));
        assert_eq!(refined(count, &places, &places, 0.1).0, places);
        assert_eq!(asked.get(), 0);
    }

    #[test]
    fn an_edge_is_said_to_be_one() {
        assert!(minimum(&[0.0, 1.0, 2.0], &[1.0, 2.0, 3.0]).at_edge);
        assert!(minimum(&[0.0, 1.0, 2.0], &[3.0, 2.0, 1.0]).at_edge);
        assert!(!minimum(&[0.0, 1.0, 2.0], &[3.0, 1.0, 1.0]).at_edge);
    }

    /// Values by hand.
    #[test]
    fn the_largest_secant_has_an_end_at_a_sample() {
        let (places, values) = ([0.0, 1.0, 2.0, 4.0], [-1.0, 0.0, 3.0, 2.0]);
        for (span, value, middle) in
            [(1.0, 3.0, 1.5), (2.0, 2.0, 1.0), (4.0, 0.75, 2.0), (0.5, 3.0, 1.25), (1.5, 3.5 / 1.5, 1.25)]
        {
            let secant = largest_secant(&places, &values, span);
            assert_eq!(
                (secant.value, secant.place, secant.at_edge),
                (value, middle, [2.0, 4.0].contains(&span)),
                "{span}"
            );
        }
        // Steepest where the curve begins, and where it ends.
        assert!(largest_secant(&places, &[0.0, 9.0, 10.0, 11.0], 0.5).at_edge);
        assert!(largest_secant(&places, &[0.0, 1.0, 2.0, 11.0], 2.0).at_edge);
    }
}
