//! The asperities of a measured surface: what is said of all of them together, and the grid of the map that
//! they lie on.

use super::answer::{Audit, Content};
use super::checked::{Checked, ROUNDING};
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::surface::map::{AtCutoff, Equivalent, HeightMap, Shape, SpectralMoments, Summit};
use crate::validation::Verdict;

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let mut checked = Checked::new(reader, 0);
    checked.bounds()?;
    checked.measured()?;
    checked.spectrum()?;
    checked.grid()?;
    checked.shape()?;
    checked.map()?;
    checked.chosen_cutoff()?;
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

    /// Principal radii are those of the second derivatives; files of before version 2.2 have none.
    fn shape(&mut self) -> Result<(), OutputError> {
        if !self.has("/asperities/curvature_xy") {
            return Ok(());
        }
        let along = |name: &str| self.values(&format!("/asperities/curvature_{name}"));
        let (x, y, xy) = (along("x")?, along("y")?, along("xy")?);
        let summit = |((&x, &y), &twist): ((&f64, &f64), &f64)| Summit {
            row: 0,
            column: 0,
            height: 0.0,
            curvature: [y, x],
            twist,
        };
        let summits: Vec<Summit> = x.iter().zip(&y).zip(&xy).map(summit).collect();
        let principal: Vec<[f64; 2]> = summits.iter().map(Summit::principal_curvatures).collect();
        const FROM: &str = "/asperities/curvature_*";
        let sharp: Vec<f64> = principal.iter().map(|own| 1.0 / own[0]).collect();
        self.follows("/asperities/principal_radius_1", &sharp, ROUNDING, FROM)?;
        // The bits are those of the same arithmetic: a summit that is close to a saddle is none here either.
        let of_blunt = |blunt: f64| if blunt > 0.0 { 1.0 / blunt } else { f64::NAN };
        let blunt: Vec<f64> = principal.iter().map(|own| of_blunt(own[1])).collect();
        self.follows("/asperities/principal_radius_2", &blunt, ROUNDING, FROM)?;
        let equivalent: Vec<f64> = summits.iter().map(Summit::equivalent_radius).collect();
        self.follows("/asperities/equivalent_radius", &equivalent, ROUNDING, FROM)?;
        let shape = Shape::new(&summits);
        self.follows("/measured/saddle_count", &[shape.saddles as f64], 0.0, FROM)?;
        self.follows("/measured/curvature_ratio_median", &[shape.ratio], ROUNDING, FROM)
    }

    /// Over the cut-off: densities are those of counts and areas, a mean is there from one summit and a deviation
    /// from two, and at the cut-off of the map all is what is measured on it.
    fn chosen_cutoff(&mut self) -> Result<(), OutputError> {
        if !self.has("/cutoffs/cutoff") {
            return Ok(());
        }
        let own = |name: &str| self.values(&format!("/cutoffs/{name}"));
        let (cutoffs, counts, areas) = (own("cutoff")?, own("summit_count")?, own("nominal_area")?);
        let densities: Vec<f64> = counts.iter().zip(&areas).map(|(count, area)| count / area).collect();
        self.follows("/cutoffs/asperity_density", &densities, ROUNDING, "summit_count and nominal_area")?;
        for (name, least) in
            [("asperity_radius", 1.0), ("asperity_height_std", 2.0), ("asperity_curvature_std", 2.0)]
        {
            let path = format!("/cutoffs/{name}");
            let found = self.values(&path)?;
            if let Some(i) = (0..found.len()).find(|&i| found[i].is_nan() != (counts[i] < least)) {
                self.say_at(&path, i, found[i], &format!("summit_count is {}", counts[i]));
            }
        }
        let smooth: f64 = self.reader.number("/", "smooth")?;
        let Some(place) = cutoffs.iter().position(|cutoff| *cutoff == smooth) else {
            if smooth > 0.0 {
                self.say("/cutoffs/cutoff", &format!("lacks that of the map, {smooth:e} m"));
            }
            return Ok(());
        };
        for name in ["asperity_density", "asperity_radius", "asperity_height_std", "asperity_curvature_std"] {
            let (path, measured) = (format!("/cutoffs/{name}"), self.values(&format!("/measured/{name}"))?);
            let (found, expected) = (self.values(&path)?[place], measured[0]);
            if !(found.is_nan() && expected.is_nan() || (found / expected - 1.0).abs() <= ROUNDING) {
                self.say_at(&path, place, found, &format!("{expected:e} follows from /measured/{name}"));
            }
        }
        Ok(())
    }

    /// Over the cut-off of a map that is not smoothed itself all can be counted anew; of one that is, the areas.
    fn cutoffs(&mut self, map: &HeightMap, is_smoothed: bool) -> Result<(), OutputError> {
        if !self.has("/cutoffs/cutoff") {
            return Ok(());
        }
        const PATH: &str = "/map/height";
        let cutoffs = self.values("/cutoffs/cutoff")?;
        let [dy, dx] = map.pixel();
        let area = |cutoff: &f64| map.clone().within_border(*cutoff).summits().compared as f64 * dy * dx;
        let is_possible = |cutoff: &f64| map.cutoffs().contains(cutoff);
        if let Some(i) = cutoffs.iter().position(|cutoff| !is_possible(cutoff)) {
            self.say_at(
                "/cutoffs/cutoff",
                i,
                cutoffs[i],
                "a cut-off that the map can be smoothed with is expected",
            );
            return Ok(());
        }
        let areas: Vec<f64> = cutoffs.iter().map(area).collect();
        self.follows("/cutoffs/nominal_area", &areas, ROUNDING, PATH)?;
        if is_smoothed {
            return Ok(());
        }
        let least = self.has("/asperities/prominence").then(|| self.reader.number("/", "prominence"));
        let Ok(series) = map.at_cutoffs(&cutoffs, least.transpose()?) else { return Ok(()) };
        let of = |value: &dyn Fn(&AtCutoff) -> f64| series.iter().map(value).collect::<Vec<f64>>();
        self.follows("/cutoffs/summit_count", &of(&|at| at.count as f64), 0.0, PATH)?;
        let radii = of(&|at| at.measured.map_or(f64::NAN, |measured| measured.radius));
        self.follows("/cutoffs/asperity_radius", &radii, ROUNDING, PATH)?;
        let scatter = of(&|at| at.measured.map_or(f64::NAN, |measured| measured.height_std));
        self.follows("/cutoffs/asperity_height_std", &scatter, ROUNDING, PATH)?;
        let scatter = of(&|at| at.measured.map_or(f64::NAN, |measured| measured.curvature_std));
        self.follows("/cutoffs/asperity_curvature_std", &scatter, ROUNDING, PATH)
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
        let cutoff = self.attribute_since("smooth")?;
        if let (true, Ok(map)) = (cutoff != 0.0, &map)
            && !map.cutoffs().contains(&cutoff)
        {
            self.say(PATH, &format!("cannot be smoothed with {cutoff:e} m, and smooth says so"));
            return Ok(());
        }
        let map = map.map(|map| if cutoff > 0.0 { map.within_border(cutoff) } else { map });
        let (map, moments) = match map.and_then(|map| SpectralMoments::new(&map).map(|own| (map, own))) {
            Ok(own) => own,
            Err(problem) => {
                self.say(PATH, &format!("is no map: {problem}"));
                return Ok(());
            }
        };
        let (heights, [x, y]) =
            (map.heights(), ["x", "y"].map(|name| self.values(&format!("/asperities/{name}"))));
        let (mut own, mut bends) = (Vec::new(), [Vec::new(), Vec::new(), Vec::new()]);
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
            let rising = |above: usize| heights[above + 1] - heights[above - 1];
            bends[2].push(-0.25 * (rising(place + columns) - rising(place - columns)) / (dx * dy));
        }
        self.follows("/asperities/height", &own, ROUNDING, PATH)?;
        for (name, bends) in ["x", "y"].into_iter().zip(&bends) {
            self.follows(&format!("/asperities/curvature_{name}"), bends, ROUNDING, PATH)?;
        }
        if self.has("/asperities/curvature_xy") {
            let (path, found) = ("/asperities/curvature_xy", self.values("/asperities/curvature_xy")?);
            self.compare(path, &found, &bends[2], |i| ROUNDING * (bends[0][i] + bends[1][i]).abs(), PATH);
        }
        self.prominences(&map)?;
        self.cutoffs(&map, cutoff > 0.0)?;
        self.heights(&map, &moments)
    }

    /// A number of the root that files of before version 2.2 do not have; 0 there.
    fn attribute_since(&self, name: &str) -> Result<f64, OutputError> {
        if self.reader.has_attribute("/", name)? { Ok(self.reader.number("/", name)?) } else { Ok(0.0) }
    }

    /// Where a prominence was asked for, each asperity has its own, and at least that.
    fn prominences(&mut self, map: &HeightMap) -> Result<(), OutputError> {
        const PATH: &str = "/asperities/prominence";
        if !self.has(PATH) {
            return Ok(());
        }
        let least = self.attribute_since("prominence")?;
        let found = self.values(PATH)?;
        if let Some(i) = found.iter().position(|own| !(*own >= least)) {
            self.say_at(PATH, i, found[i], &format!("{least:e} at least is expected"));
        }
        let all = map.summits().summits;
        let prominences = map.prominences(&all);
        let expected: Vec<f64> = prominences.into_iter().filter(|own| *own >= least).collect();
        self.follows(PATH, &expected, ROUNDING, "/map/height")
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
