//! A map of heights that is dropped on the page: its summits, as `stiction asperities` finds them, and the keys of a scene.
//!
//! The map is a plain text: a row of heights on each line, above them lines such as `Width: 5.76 µm` and `Value units: nm`. The
//! plane of least squares is subtracted, and what is shorter than a cut-off if one is given, by the areal Gaussian filter of
//! ISO 16610-61 (a wave of that length keeps half of its amplitude; half a cut-off along the border no longer counts). A summit
//! is a pixel, or the middle of a plateau, higher than its neighbours, with the mean curvature of second differences there.
//! Other formats, missing heights and rows that are offset are for the command.

use super::failure::Failure;
use crate::scene::units::{Dimension, parse};
use serde::Deserialize;
use serde_json::{Value, json};
use std::f64::consts::{LN_2, PI};

/// Fewest rows and columns, and the most heights.
const SMALLEST: usize = 8;
const MOST: usize = 16 << 20;
/// Largest height, m.
const HIGHEST: f64 = 1e6;
/// Roundings of the largest height within which heights are equal.
const ROUNDINGS: f64 = 64.0;
/// Bounds of a cut-off: in pixels, and over the shorter side.
const CUTOFFS: (f64, f64) = (2.0, 0.5);
/// Cut-offs beyond which weights are left out.
const REACH: f64 = 1.25;
/// Fewest pixels from one maximum of a profile to the next, and fewest summits, that pass without a warning.
const FEWEST_PIXELS: f64 = 10.0;
const FEWEST_SUMMITS: usize = 100;
/// Skewness and excess kurtosis of heights that are far from Gaussian.
const FAR: [f64; 2] = [0.3, 0.6];

/// The reason why a map has no roughness.
const FLAT: &str = "the levelled map is flat: no height differs from the others by more than rounding";

/// What is given of a map.
#[derive(Deserialize)]
struct Given {
    text: String,
    /// The width of a pixel, and its height behind a comma if it is another one.
    #[serde(default)]
    pixel: Option<String>,
    #[serde(default)]
    height_unit: Option<String>,
    /// The cut-off of the filter.
    #[serde(default)]
    smooth: Option<String>,
}

/// Heights on a grid, m, row by row.
struct Grid {
    heights: Vec<f64>,
    rows: usize,
    columns: usize,
    /// Height and width of a pixel, m.
    steps: [f64; 2],
    /// Heights that differ by no more, m, are equally high.
    resolution: f64,
    /// Rows and columns along the border that do not count.
    border: [usize; 2],
    /// The heights before levelling, where those are in steps that levelling has tilted.
    measured: Option<Vec<f64>>,
}

/// A summit: its height, m, and the mean curvature there, 1/m.
struct Summit {
    height: f64,
    curvature: f64,
}

/// Spectral moments of profiles, and how far the heights are from Gaussian ones.
struct Moments {
    m0: f64,
    m2: f64,
    m4: f64,
    skewness: f64,
    excess_kurtosis: f64,
}

/// The summits of a map, and the keys of a scene that they give.
pub(super) fn map(argument: &str) -> Result<Value, Failure> {
    let given: Given = serde_json::from_str(argument)?;
    let mut grid = Grid::read(&given)?;
    let cutoff = given.smooth.as_deref().map(|text| length("smooth", text)).transpose()?;
    grid.level()?;
    if let Some(cutoff) = cutoff {
        grid.smooth(cutoff)?;
    }
    let moments = grid.moments()?;
    let (summits, area) = grid.summits();
    if summits.is_empty() {
        return Err(Failure::new("no pixel and no plateau is higher than all around: the map has no summit"));
    }
    let count = summits.len() as f64;
    let mean = |of: &dyn Fn(&Summit) -> f64| summits.iter().map(of).sum::<f64>() / count;
    let (height, curvature) = (mean(&|own| own.height), mean(&|own| own.curvature));
    let spread = summits.iter().map(|own| (own.height - height).powi(2)).sum::<f64>() / (count - 1.0);
    let (radius, density, sigma, sigma_s) = (1.0 / curvature, count / area, moments.m0.sqrt(), spread.sqrt());
    let text = |value: f64, of: Dimension| of.shown(value);
    let set = [
        ("surface.asperity_radius", text(radius, Dimension::Length)),
        ("surface.asperity_density", text(density, Dimension::ArealDensity)),
        ("surface.surface_height_std", text(sigma, Dimension::Length)),
        ("surface.asperity_height_std", text(sigma_s, Dimension::Length)),
    ];
    let set = if sigma_s.is_nan() { &set[..3] } else { &set[..] };
    let [rows, columns] = [grid.rows, grid.columns];
    Ok(json!({
        "set": set, "summits": summits.len(), "rows": rows, "columns": columns,
        "extent": [columns as f64 * grid.steps[1], rows as f64 * grid.steps[0]],
        "values": {
            "radius": radius, "density": density, "surface_height_std": sigma, "height_mean": height, "height_std": sigma_s,
            "m0": moments.m0, "m2": moments.m2, "m4": moments.m4,
        },
        "warnings": warnings(&grid, &moments, summits.len(), radius),
    }))
}

/// What the summits do not meet.
fn warnings(grid: &Grid, moments: &Moments, count: usize, radius: f64) -> Vec<String> {
    let largest = grid.steps[0].max(grid.steps[1]);
    let pixels = 2.0 * PI * (moments.m2 / moments.m4).sqrt() / largest;
    let mut warnings = Vec::new();
    if pixels < FEWEST_PIXELS {
        warnings.push(format!(
            "{pixels:.1} pixels from one maximum of a profile to the next, fewer than {FEWEST_PIXELS}: pixels are too coarse for \
             the summits, which have a radius of {:.3} pixels",
            radius / largest
        ));
    }
    if count < FEWEST_SUMMITS {
        let uncertain = 100.0 / (count as f64).sqrt();
        warnings.push(format!("few summits ({count}): their density is uncertain by about {uncertain:.0} %"));
    }
    let Moments { skewness, excess_kurtosis, .. } = moments;
    if skewness.abs() > FAR[0] || excess_kurtosis.abs() > FAR[1] {
        warnings.push(format!(
            "heights are far from Gaussian (skewness {skewness:.2}, excess kurtosis {excess_kurtosis:.2}), which the scene takes \
             them for"
        ));
    }
    warnings
}

/// A length with its unit, m.
fn length(what: &str, text: &str) -> Result<f64, Failure> {
    let found = parse(text, Dimension::Length).ok().filter(|length| *length > 0.0 && length.is_finite());
    found.ok_or_else(|| {
        Failure::new(format!("{what} = {text:?}: a length with its unit is needed, such as \"10 nm\""))
    })
}

/// The lines of a text: what the head says, and the rows of numbers.
struct Lines<'t> {
    head: Vec<&'t str>,
    rows: Vec<Vec<f64>>,
}

impl<'t> Lines<'t> {
    /// Comments, and lines before the rows that do not begin with a number, are the head.
    fn of(text: &'t str) -> Result<Self, Failure> {
        let (mut head, mut rows) = (Vec::new(), Vec::<Vec<f64>>::new());
        let text = text.trim_start_matches('\u{feff}');
        for (i, line) in text.lines().enumerate() {
            let own = line.trim();
            let is_comment = ["#", "%", "//"].iter().any(|mark| own.starts_with(mark));
            let cells: Vec<&str> = cells(own);
            let begins = cells.first().is_some_and(|cell| cell.parse::<f64>().is_ok());
            if own.is_empty() || is_comment || (rows.is_empty() && !begins) {
                head.push(own.trim_start_matches(['#', '%', '/', ' ']));
                continue;
            }
            let number = |(column, cell): (usize, &&str)| {
                cell.parse::<f64>().ok().filter(|height| height.is_finite()).ok_or_else(|| {
                    let place = format!("line {}, column {}", i + 1, column + 1);
                    Failure::new(format!(
                        "{place}: {cell:?} is no height; maps with decimal commas or missing heights are for `stiction asperities`"
                    ))
                })
            };
            rows.push(cells.iter().enumerate().map(number).collect::<Result<_, _>>()?);
            let (first, last) = (rows[0].len(), rows[rows.len() - 1].len());
            if first != last {
                let problem = format!("line {}: has {last} heights, and the first row {first}", i + 1);
                return Err(Failure::new(problem));
            }
            if rows.len() * first > MOST {
                return Err(Failure::new(format!("the map has more than {MOST} heights")));
            }
        }
        Ok(Self { head, rows })
    }

    /// The value behind a key of the head.
    fn value(&self, key: &str) -> Option<&'t str> {
        let of = |line: &&'t str| {
            let (own, value) = line.split_once([':', '=', '\t'])?;
            own.trim().eq_ignore_ascii_case(key).then(|| value.trim())
        };
        self.head.iter().find_map(of)
    }
}

/// The cells of a line.
fn cells(line: &str) -> Vec<&str> {
    let separator = ['\t', ';', ','].into_iter().find(|separator| line.contains(*separator));
    match separator {
        Some(separator) => {
            let line = line.trim_end_matches(separator);
            line.split(separator).map(str::trim).collect()
        }
        None => line.split_whitespace().collect(),
    }
}

impl Grid {
    fn read(given: &Given) -> Result<Self, Failure> {
        let lines = Lines::of(&given.text)?;
        let (rows, columns) = (lines.rows.len(), lines.rows.first().map_or(0, Vec::len));
        if rows < SMALLEST || columns < SMALLEST {
            return Err(Failure::new(format!(
                "the map has {rows} rows and {columns} columns; at least {SMALLEST} of each are needed"
            )));
        }
        let side = |key: &str| lines.value(key).map(|text| length(key, text)).transpose();
        let steps = match (&given.pixel, side("Height")?, side("Width")?) {
            (Some(pixel), ..) => {
                let (width, height) = pixel.split_once(',').unwrap_or((pixel, pixel));
                [length("pixel", height)?, length("pixel", width)?]
            }
            (None, Some(height), Some(width)) => [height / rows as f64, width / columns as f64],
            _ => return Err(Failure::new("the map does not say its pixel; give it, such as \"10 nm\"")),
        };
        let unit = given.height_unit.as_deref().or_else(|| lines.value("Value units"));
        let unit = unit.ok_or_else(|| {
            Failure::new("the map does not say the unit of its heights; give it, such as \"nm\"")
        })?;
        let factor = length("the unit of the heights", &format!("1 {unit}"))?;
        let heights: Vec<f64> = lines.rows.concat().into_iter().map(|height| factor * height).collect();
        let largest = largest(&heights);
        if largest > HIGHEST {
            return Err(Failure::new("heights up to 1e6 m are needed; check their unit"));
        }
        let resolution = ROUNDINGS * f64::EPSILON * largest;
        Ok(Self { heights, rows, columns, steps, resolution, border: [0; 2], measured: None })
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.heights[row * self.columns + column]
    }

    /// Subtracts the plane of least squares. The second fit, of what the first has left, takes its rounding away.
    fn level(&mut self) -> Result<(), Failure> {
        let before = self.heights.clone();
        let place = |i: usize, count: usize| 2.0 * i as f64 / (count - 1) as f64 - 1.0;
        let square = |count: usize| (0..count).map(|i| place(i, count).powi(2)).sum::<f64>() / count as f64;
        let (rows, columns) = (self.rows, self.columns);
        let along = [square(rows), square(columns)];
        for _ in 0..2 {
            let count = self.heights.len() as f64;
            let (mut mean, mut slopes) = (0.0, [0.0; 2]);
            for (i, height) in self.heights.iter().enumerate() {
                let (v, u) = (place(i / columns, rows), place(i % columns, columns));
                mean += height / count;
                slopes =
                    [slopes[0] + v * height / count / along[0], slopes[1] + u * height / count / along[1]];
            }
            for (i, height) in self.heights.iter_mut().enumerate() {
                let (v, u) = (place(i / columns, rows), place(i % columns, columns));
                *height -= mean + slopes[0] * v + slopes[1] * u;
            }
        }
        if !(largest(&self.heights) > self.resolution) {
            return Err(Failure::new(FLAT));
        }
        let surface: Vec<f64> = before.iter().zip(&self.heights).map(|(one, other)| one - other).collect();
        let tilt = self.rises(&surface).fold([0.0; 2], |mut most: [f64; 2], (axis, rise)| {
            most[axis] = most[axis].max(rise.abs());
            most
        });
        let step = self.rises(&before).map(|(_, rise)| rise.abs()).filter(|rise| *rise > self.resolution);
        let in_steps = tilt[0] + tilt[1] < step.fold(f64::INFINITY, f64::min);
        self.measured = in_steps.then_some(before);
        Ok(())
    }

    /// Differences of neighbours of a map of this size, along the columns (0) and the rows (1).
    fn rises<'a>(&self, heights: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + use<'a> {
        let columns = self.columns;
        let down = (columns..heights.len()).map(move |i| (0, heights[i] - heights[i - columns]));
        let along = (1..heights.len()).filter(move |i| i % columns != 0);
        down.chain(along.map(|i| (1, heights[i] - heights[i - 1])))
    }

    /// Takes away what is shorter than a cut-off, m.
    fn smooth(&mut self, cutoff: f64) -> Result<(), Failure> {
        let [dy, dx] = self.steps;
        let (least, side) = (CUTOFFS.0 * dy.max(dx), (self.rows as f64 * dy).min(self.columns as f64 * dx));
        if !(least..=CUTOFFS.1 * side).contains(&cutoff) {
            let [low, high] = [least, CUTOFFS.1 * side].map(|end| Dimension::Length.shown(end));
            return Err(Failure::new(format!(
                "smooth: a cut-off from {low}, two pixels, to {high}, half the shorter side"
            )));
        }
        let counts = [(self.rows, self.columns, dy), (self.columns, 1, dx)];
        for (count, stride, step) in counts {
            let pixels = cutoff / step;
            let reach = (REACH * pixels).ceil() as usize;
            let weight = |k: usize| libm::exp(-PI * PI / LN_2 * (k as f64 / pixels).powi(2));
            let kernel: Vec<f64> = (0..=reach).map(weight).collect();
            self.heights = convolved(&self.heights, &kernel, count, stride);
        }
        self.border = self.steps.map(|step| (0.5 * cutoff / step * (1.0 - 1e-12)).ceil() as usize);
        self.measured = None;
        Ok(())
    }

    /// The rows and columns within the border, which is `least` wide or wider.
    fn within(&self, least: usize) -> [std::ops::Range<usize>; 2] {
        [(self.rows, self.border[0]), (self.columns, self.border[1])].map(|(count, border)| {
            let border = border.max(least);
            border..count.saturating_sub(border).max(border)
        })
    }

    /// Moments of profiles within the border.
    fn moments(&self) -> Result<Moments, Failure> {
        let [rows, columns] = self.within(0);
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut count) = (0.0, 0.0);
            values.for_each(|value| (sum, count) = (sum + value, count + 1.0));
            sum / count
        };
        let inner = || rows.clone().flat_map(|row| columns.clone().map(move |column| (row, column)));
        let power = |power: i32| mean(&mut inner().map(|(row, column)| self.at(row, column).powi(power)));
        let [dy, dx] = self.steps;
        let second = |before: f64, own: f64, after: f64| (after - own) - (own - before);
        let down = |&(row, _): &(usize, usize), by: usize| row + by < rows.end;
        let along = |&(_, column): &(usize, usize), by: usize| column + by < columns.end;
        let at = |place: (usize, usize), by: [usize; 2]| self.at(place.0 + by[0], place.1 + by[1]);
        let slope_y = mean(
            &mut inner().filter(|own| down(own, 1)).map(|own| (at(own, [1, 0]) - at(own, [0, 0])).powi(2)),
        );
        let slope_x = mean(
            &mut inner().filter(|own| along(own, 1)).map(|own| (at(own, [0, 1]) - at(own, [0, 0])).powi(2)),
        );
        let bend_y = mean(
            &mut inner()
                .filter(|own| down(own, 2))
                .map(|own| second(at(own, [0, 0]), at(own, [1, 0]), at(own, [2, 0])).powi(2)),
        );
        let bend_x = mean(
            &mut inner()
                .filter(|own| along(own, 2))
                .map(|own| second(at(own, [0, 0]), at(own, [0, 1]), at(own, [0, 2])).powi(2)),
        );
        let (m0, m2) = (power(2), 0.5 * (slope_y / (dy * dy) + slope_x / (dx * dx)));
        let m4 = 0.5 * (bend_y / (dy * dy * dy * dy) + bend_x / (dx * dx * dx * dx));
        if !(m2 > 0.0 && m4 > 0.0) {
            return Err(Failure::new(FLAT));
        }
        let (skewness, excess_kurtosis) = (power(3) / (m0 * m0.sqrt()), power(4) / (m0 * m0) - 3.0);
        Ok(Moments { m0, m2, m4, skewness, excess_kurtosis })
    }

    /// The summits, and the area that was searched, m².
    fn summits(&self) -> (Vec<Summit>, f64) {
        let z = self.measured.as_ref().unwrap_or(&self.heights);
        let ([rows, columns], width) = (self.within(1), self.columns);
        let around = |place: usize| {
            let above = [place - width - 1, place - width, place - width + 1, place - 1];
            above.into_iter().chain([place + 1, place + width - 1, place + width, place + width + 1])
        };
        let is_top = |place: usize| around(place).all(|other| z[place] >= z[other] - self.resolution);
        let inner = || rows.clone().flat_map(|row| columns.clone().map(move |column| row * width + column));
        let mut tops = vec![false; z.len()];
        inner().filter(|place| is_top(*place)).for_each(|place| tops[place] = true);
        let mut seen = vec![false; z.len()];
        let mut summits = Vec::new();
        for place in inner().filter(|place| tops[*place]) {
            if seen[place] {
                continue;
            }
            let (mut plateau, mut open, mut is_whole) = (Vec::new(), vec![place], true);
            seen[place] = true;
            while let Some(own) = open.pop() {
                plateau.push(own);
                for other in around(own) {
                    if tops[other] {
                        open.extend((!std::mem::replace(&mut seen[other], true)).then_some(other));
                    } else {
                        // It goes on in a pixel that has a higher neighbour, or is at the border.
                        is_whole &= z[other] < z[own] - self.resolution;
                    }
                }
            }
            if is_whole {
                summits.push(self.summit(&mut plateau));
            }
        }
        (summits, inner().count() as f64 * self.steps[0] * self.steps[1])
    }

    /// The summit at the pixel nearest to the middle of a plateau, with curvatures by the first pixels beyond it.
    fn summit(&self, plateau: &mut [usize]) -> Summit {
        plateau.sort_unstable();
        let (width, count) = (self.columns, plateau.len() as f64);
        let [dy, dx] = self.steps;
        let mean =
            |of: &dyn Fn(usize) -> usize| plateau.iter().map(|own| of(*own) as f64).sum::<f64>() / count;
        let middle = [mean(&|own| own / width), mean(&|own| own % width)];
        let away = |own: &usize| {
            let [y, x] = [(own / width) as f64 - middle[0], (own % width) as f64 - middle[1]];
            (y * dy).powi(2) + (x * dx).powi(2)
        };
        let own = plateau.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))).expect("it has a pixel");
        let edge = |step: isize| {
            let at = |k: usize| own.wrapping_add_signed(step * k as isize);
            let beyond = (1..).find(|k| plateau.binary_search(&at(*k)).is_err()).expect("a plateau ends");
            (beyond as f64, self.heights[at(beyond)])
        };
        let height = self.heights[own];
        let bend = |step: isize, pixel: f64| {
            let ((before, low), (after, high)) = (edge(-step), edge(step));
            2.0 * ((height - low) / before + (height - high) / after) / (before + after) / (pixel * pixel)
        };
        Summit { height, curvature: 0.5 * (bend(width as isize, dy) + bend(1, dx)) }
    }
}

/// The largest height of either sign.
fn largest(heights: &[f64]) -> f64 {
    heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()))
}

/// Heights under a kernel, from its middle on, along lines of `count` heights a `stride` apart: weights are normalised over the
/// heights that are there.
fn convolved(heights: &[f64], kernel: &[f64], count: usize, stride: usize) -> Vec<f64> {
    let reach = kernel.len() - 1;
    let total = |i: usize| -> f64 {
        (i.saturating_sub(reach)..(i + reach + 1).min(count)).map(|k| kernel[k.abs_diff(i)]).sum()
    };
    let totals: Vec<f64> = (0..count).map(total).collect();
    let one = |place: usize| {
        let i = place / stride % count;
        let first = place - i * stride;
        let near = i.saturating_sub(reach)..(i + reach + 1).min(count);
        near.map(|k| kernel[k.abs_diff(i)] * heights[first + k * stride]).sum::<f64>() / totals[i]
    };
    (0..heights.len()).map(one).collect()
}
