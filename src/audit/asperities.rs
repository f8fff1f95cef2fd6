//! The asperities of a measured surface: what is said of all of them together, and the grid of the map that
//! they lie on.

use super::answer::{Audit, Content};
use super::checked::{Checked, ROUNDING};
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::surface::map::{Equivalent, HeightMap, SpectralMoments};
use crate::validation::Verdict;

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let mut checked = Checked::new(reader, 0);
    checked.bounds()?;
    checked.measured()?;
    checked.spectrum()?;
    checked.grid()?;
    checked.map()?;
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

    /// The heights of the map, where the file has them, have so many gaps, such moments, and such asperities.
    fn map(&mut self) -> Result<(), OutputError> {
        const PATH: &str = "/map/height";
        if !self.has(PATH) {
            return Ok(());
        }
        let shape: Vec<u64> = self.reader.attribute("/", "map_shape")?;
        let pixel: Vec<f64> = self.reader.attribute("/", "pixel_size")?;
        let (&[rows, columns], &[dy, dx]) = (&shape[..], &pixel[..]) else { return Ok(()) };
        let heights = self.values(PATH)?;
        if rows.checked_mul(columns) != Some(heights.len() as u64) {
            self.say(PATH, &format!("has {} heights, and map_shape {rows} x {columns}", heights.len()));
            return Ok(());
        }
        for (path, count, pixel) in [("/map/y", rows, dy), ("/map/x", columns, dx)] {
            let middles: Vec<f64> = (0..count).map(|index| (index as f64 + 0.5) * pixel).collect();
            self.follows(path, &middles, ROUNDING, "map_shape and pixel_size")?;
        }
        let (rows, columns) = (rows as usize, columns as usize);
        let map = HeightMap::new(heights, [rows, columns], [dy, dx]);
        let (map, moments) = match map.and_then(|map| SpectralMoments::new(&map).map(|own| (map, own))) {
            Ok(own) => own,
            Err(problem) => {
                self.say(PATH, &format!("is no map: {problem}"));
                return Ok(());
            }
        };
        let (heights, [x, y]) =
            (map.heights(), ["x", "y"].map(|name| self.values(&format!("/asperities/{name}"))));
        let (mut own, mut bends) = (Vec::new(), [Vec::new(), Vec::new()]);
        for (x, y) in x?.into_iter().zip(y?) {
            let [row, column] = [y / dy, x / dx].map(|place| (place - 0.5).round() as usize);
            let is_inside = (1..rows - 1).contains(&row) && (1..columns - 1).contains(&column);
            let place = if is_inside { row * columns + column } else { columns + 1 };
            let bend = |step: usize| {
                (heights[place] - heights[place - step]) + (heights[place] - heights[place + step])
            };
            own.push(heights[place]);
            bends[0].push(bend(1) / (dx * dx));
            bends[1].push(bend(columns) / (dy * dy));
        }
        self.follows("/asperities/height", &own, ROUNDING, PATH)?;
        for (name, bends) in ["x", "y"].into_iter().zip(&bends) {
            self.follows(&format!("/asperities/curvature_{name}"), bends, ROUNDING, PATH)?;
        }
        self.heights(&map, &moments)
    }

    /// What is said of all heights of a map.
    fn heights(&mut self, map: &HeightMap, moments: &SpectralMoments) -> Result<(), OutputError> {
        const PATH: &str = "/map/height";
        for (name, expected) in [
            ("m0", moments.m0),
            ("m4", moments.m4()),
            ("slope_x", moments.slope[1]),
            ("slope_y", moments.slope[0]),
            ("skewness", moments.skewness),
            ("excess_kurtosis", moments.excess_kurtosis),
        ] {
            let path = format!("/surface/{name}");
            let found = self.values(&path)?;
            // Heights have moments of any size, and their shape some of about 1.
            let is_shape = ["skewness", "excess_kurtosis"].contains(&name);
            let size = if is_shape { 1.0 + expected.abs() } else { expected };
            self.compare(&path, &found, &[expected], |_| ROUNDING * size, PATH);
        }
        let [dy, dx] = map.pixel();
        let area = map.summits().compared as f64 * dy * dx;
        let missing: u64 = self.reader.number("/", "missing_pixels")?;
        let told: f64 = self.reader.number("/", "nominal_area")?;
        if missing != map.missing() as u64 {
            self.say(PATH, &format!("lacks {} heights, and missing_pixels is {missing}", map.missing()));
        }
        if (told - area).abs() > ROUNDING * area {
            self.say(PATH, &format!("was searched over {area:e} m^2, and nominal_area is {told:e}"));
        }
        Ok(())
    }
}
