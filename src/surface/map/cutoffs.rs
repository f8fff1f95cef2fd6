//! Summits over the cut-off of the filter: where density, radius and scatter settle, and where they do not.

use super::{HeightMap, MapError, Measured};

/// Largest cut-off of a series over the shorter side of a map.
const LARGEST_SHARE: f64 = 0.25;

/// Summits of a map that is smoothed with a cut-off.
///
/// # Examples
/// ```
/// use stiction::surface::map::{AtCutoff, HeightMap};
///
/// # let wave = std::f64::consts::PI / 8.0;
/// # let height = |k: i32| 1e-9 * (wave * f64::from(k / 64)).cos() * (wave * f64::from(k % 64)).cos();
/// # let map = HeightMap::new((0..64 * 64).map(height).collect(), [64, 64], [1e-8, 1e-8])?;
/// // An egg box: whatever is smoothed has as many summits, but they are blunter.
/// let series: Vec<AtCutoff> = map.at_cutoffs(&map.cutoff_series(3)?, None)?;
/// assert!((series[2].cutoff / 1.6e-7 - 1.0).abs() < 1e-12);
/// assert!(series[2].measured.unwrap().radius > 1.5 * series[0].measured.unwrap().radius);
/// # Ok::<(), stiction::surface::map::MapError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtCutoff {
    /// The cut-off wavelength, m.
    pub cutoff: f64,
    /// The number of summits.
    pub count: usize,
    /// Area that was searched for them, m².
    pub nominal_area: f64,
    /// Density and moments of the summits, if there are any.
    pub measured: Option<Measured>,
}

impl HeightMap {
    /// `count` cut-offs from two pixels to a quarter of the shorter side of the map, m, each by the same
    /// factor above the one before; two at least.
    ///
    /// # Errors
    /// [`MapError::NoCutoffs`] when a quarter of the side is no more than two pixels.
    pub fn cutoff_series(&self, count: usize) -> Result<Vec<f64>, MapError> {
        let (least, most) = (*self.cutoffs().start(), LARGEST_SHARE * self.shorter_side());
        if !(most > least * (1.0 + 1e-9)) {
            return Err(MapError::NoCutoffs { least, most });
        }
        let last = count.max(2) - 1;
        let cutoff = |i: usize| match i {
            0 => least,
            i if i == last => most,
            i => least * libm::pow(most / least, i as f64 / last as f64),
        };
        Ok((0..=last).map(cutoff).collect())
    }

    /// The summits of the levelled map, smoothed with each of some cut-offs, m; only summits of a least
    /// prominence, m, if one is given.
    ///
    /// # Errors
    /// [`MapError::Cutoff`] when a cut-off is not one of the map.
    pub fn at_cutoffs(&self, cutoffs: &[f64], prominence: Option<f64>) -> Result<Vec<AtCutoff>, MapError> {
        let at = |&cutoff: &f64| {
            let smooth = self.smoothed(cutoff)?;
            let found = smooth.summits();
            let [dy, dx] = self.pixel;
            let nominal_area = found.compared as f64 * dy * dx;
            let summits = smooth.prominent(found.summits, prominence).0;
            let measured = (!summits.is_empty()).then(|| Measured::new(&summits, nominal_area));
            Ok(AtCutoff { cutoff, count: summits.len(), nominal_area, measured })
        };
        cutoffs.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cutoffs_rise_by_a_factor() {
        let map = |shape| HeightMap::new(vec![0.0; shape], [shape / 40, 40], [2e-9, 1e-9]).unwrap();
        let series = map(1600).cutoff_series(5).unwrap();
        assert_eq!((series.len(), series[0], series[4]), (5, 4e-9, 10e-9));
        assert!(series.windows(3).all(|of| (of[1] * of[1] / (of[0] * of[2]) - 1.0).abs() < 1e-12));
        assert!(matches!(map(320).cutoff_series(5), Err(MapError::NoCutoffs { .. })));
    }
}
