//! The asperities of a measured surface: what is said of all of them together, and the grid of the map that
//! they lie on.

use super::answer::{Audit, Content};
use super::checked::{Checked, ROUNDING};
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::surface::map::{Equivalent, SpectralMoments};
use crate::validation::Verdict;

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let mut checked = Checked::new(reader, 0);
    checked.bounds()?;
    checked.measured()?;
    checked.spectrum()?;
    checked.grid()?;
    let count = checked.coordinate("asperity")?.len();
    let content = Content::Asperities(count);
    Ok(Audit { content, findings: checked.findings, verdict: Verdict::NotTested })
}

impl Checked<'_> {
    /// Radii are those of the curvatures, and what is measured is that of all asperities.
    fn measured(&mut self) -> Result<(), OutputError> {
        let along = |name: &str| self.values(&format!("/asperities/{name}"));
        let (heights, x, y) = (along("height")?, along("curvature_x")?, along("curvature_y")?);
        let curvatures: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 0.5 * (x + y)).collect();
        let radii: Vec<f64> = curvatures.iter().map(|curvature| 1.0 / curvature).collect();
        self.follows("/asperities/radius", &radii, ROUNDING, "both curvatures")?;
        let area: f64 = self.reader.number("/", "nominal_area")?;
        let density = [heights.len() as f64 / area];
        self.follows("/measured/asperity_density", &density, ROUNDING, "asperities and nominal_area")?;
        let mut sample = Moments::new(2);
        heights.iter().zip(&curvatures).for_each(|(height, curvature)| sample.push(&[*height, *curvature]));
        let (mean, std) = (sample.mean(), sample.std());
        let radius = [1.0 / mean[1]];
        self.follows("/measured/asperity_radius", &radius, ROUNDING, "/asperities/curvature_*")?;
        for (name, values, i) in
            [("height_mean", mean, 0), ("height_std", &std, 0), ("curvature_std", &std, 1)]
        {
            let path = format!("/measured/asperity_{name}");
            let size = mean[i].abs() + if std[i].is_nan() { 0.0 } else { std[i] };
            let found = self.values(&path)?;
            self.compare(&path, &found, &[values[i]], |_| ROUNDING * size, "/asperities");
        }
        Ok(())
    }

    /// Checks what follows from the mean squares of heights, slopes and second derivatives.
    fn spectrum(&mut self) -> Result<(), OutputError> {
        let one = |name: &str| self.values(&format!("/surface/{name}")).map(|values| values[0]);
        let m4 = one("m4")?;
        let moments = SpectralMoments {
            m0: one("m0")?,
            slope: [one("slope_y")?, one("slope_x")?],
            curvature: [m4, m4],
            skewness: one("skewness")?,
            excess_kurtosis: one("excess_kurtosis")?,
        };
        let Equivalent { density, radius, height_mean, height_std } = Equivalent::new(&moments);
        for (path, expected) in [
            ("/surface/m2", moments.m2()),
            ("/surface/alpha", moments.alpha()),
            ("/equivalent/asperity_density", density),
            ("/equivalent/asperity_radius", radius),
            ("/equivalent/asperity_height_mean", height_mean),
            ("/equivalent/asperity_height_std", height_std),
        ] {
            self.follows(path, &[expected], ROUNDING, "the moments of /surface")?;
        }
        // Of every distribution.
        let least = moments.skewness * moments.skewness - 2.0;
        if moments.excess_kurtosis < least - ROUNDING * (1.0 + least.abs()) {
            let expected = format!("the skewness allows no less than {least:e}");
            self.say_at("/surface/excess_kurtosis", 0, moments.excess_kurtosis, &expected);
        }
        Ok(())
    }

    /// Asperities are in the middle of pixels of the map, row by row.
    fn grid(&mut self) -> Result<(), OutputError> {
        let shape: Vec<u64> = self.reader.attribute("/", "map_shape")?;
        let pixel: Vec<f64> = self.reader.attribute("/", "pixel_size")?;
        let (&[rows, columns], &[dy, dx]) = (&shape[..], &pixel[..]) else {
            self.say("/ map_shape or pixel_size", "has not two numbers");
            return Ok(());
        };
        let (x, y) = (self.values("/asperities/x")?, self.values("/asperities/y")?);
        let mut places = Vec::new();
        for (path, values, pixel, count) in
            [("/asperities/y", &y, dy, rows), ("/asperities/x", &x, dx, columns)]
        {
            let indices: Vec<f64> = values.iter().map(|place| (place / pixel - 0.5).round()).collect();
            let is_off = |i: usize| {
                let middle = (indices[i] + 0.5) * pixel;
                !((0.0..count as f64).contains(&indices[i])
                    && (values[i] - middle).abs() <= ROUNDING * pixel * count as f64)
            };
            if let Some(i) = (0..values.len()).find(|&i| is_off(i)) {
                self.say_at(
                    path,
                    i,
                    values[i],
                    &format!("the middle of one of {count} pixels of {pixel:e} is expected"),
                );
            }
            places.push(indices);
        }
        let place = |i: usize| places[0][i] * columns as f64 + places[1][i];
        if let Some(i) = (1..x.len()).find(|&i| place(i) <= place(i - 1)) {
            self.say_at("/asperities/x", i, x[i], "asperities row by row are expected");
        }
        Ok(())
    }
}
