//! Datasets of a file that are looked at together, and what is found wrong with them.

use super::bounds::{Bound, Kind, Nan, bound_of};
use crate::asperity::Regime;
use crate::engine::{Ways, scalars};
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::{Dimension, Variable};
use std::path::Path;

/// Error by rounding at most, relative to what was summed.
pub(super) const ROUNDING: f64 = 1e-9;

/// A curve that files of coupled asperities have.
const COUPLED: &str = "/coupling/independent_external_force_mean";

/// A file that cannot be audited.
pub(super) fn refused(path: &Path, problem: &str) -> OutputError {
    OutputError::NotAResult { path: path.to_owned(), problem: problem.to_owned() }
}

/// The part of the datasets of a file that is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place<'a> {
    /// All of them.
    File,
    /// A point of a sweep, by its index along each dimension of the points.
    Point(&'a [usize]),
    /// A law of a comparison, by its index.
    Law(usize),
}

/// A run, a point of a sweep, a law of a comparison, or another file.
pub(super) struct Checked<'a> {
    pub reader: &'a Reader,
    pub place: Place<'a>,
    /// Replicas of a group.
    pub group: u64,
    pub replicas: u64,
    pub findings: Vec<String>,
}

impl<'a> Checked<'a> {
    /// A file without replicas, or with some that are independent of each other.
    pub fn new(reader: &'a Reader, replicas: u64) -> Self {
        Self { reader, place: Place::File, group: 1, replicas, findings: Vec::new() }
    }

    /// Where the datasets of a quantity are that the integral is about, which knows of no coupling: the path that
    /// their names begin with.
    pub fn independent(&self, way: &str, name: &str) -> String {
        let coupled = format!("/coupling/{way}independent_{name}");
        if self.is_coupled() { coupled } else { format!("/ensemble/{way}{name}") }
    }

    /// Whether asperities are coupled: of a sweep, at the place.
    pub fn is_coupled(&self) -> bool {
        let all_absent = |values: Vec<f64>| values.iter().all(|value| value.is_nan());
        self.has(COUPLED) && (self.place == Place::File || !self.values(COUPLED).is_ok_and(all_absent))
    }

    pub fn has(&self, path: &str) -> bool {
        self.reader.has(path)
    }

    /// The values of a dataset at the place.
    pub fn values(&self, path: &str) -> Result<Vec<f64>, OutputError> {
        Ok(match self.place {
            Place::File => self.reader.numbers(path, None)?,
            Place::Point(_) if is_shared(self.reader.layout().variable(path)) => {
                self.reader.numbers(path, None)?
            }
            Place::Point(place) => {
                let mut values = self.reader.numbers(path, Some(place))?;
                values.truncate(self.there(path, values.len())?);
                values
            }
            Place::Law(law) => {
                let values = self.reader.numbers(path, None)?;
                match self.reader.layout().variable(path).dimensions[..] {
                    [Dimension::Law, ..] => {
                        let length = values.len() / self.reader.length(Dimension::Law)?.max(1);
                        values[law * length..(law + 1) * length].to_vec()
                    }
                    _ => values,
                }
            }
        })
    }

    /// The values of a coordinate at the place, in the first group that has it.
    pub fn coordinate(&self, name: &str) -> Result<Vec<f64>, OutputError> {
        self.values(self.reader.coordinate(name))
    }

    /// Whether the file has a coordinate, which not every layout knows.
    pub fn has_coordinate(&self, name: &str) -> bool {
        let mut known = self.reader.layout().known();
        known.any(|known| known.is_coordinate() && known.name() == name && self.has(&known.path))
    }

    /// Compares a coordinate with what follows from others.
    pub fn repeats(
        &mut self,
        name: &str,
        expected: &[f64],
        tolerance: f64,
        from: &str,
    ) -> Result<(), OutputError> {
        let found = self.coordinate(name)?;
        self.compare(self.reader.coordinate(name), &found, expected, |_| tolerance, from);
        Ok(())
    }

    /// A coordinate is the same in every group.
    fn copy(&mut self, variable: &Variable) -> Result<(), OutputError> {
        if !variable.is_coordinate() {
            return Ok(());
        }
        let first = self.reader.coordinate(variable.name());
        if first == variable.path {
            return Ok(());
        }
        if let Ok(names) = self.reader.texts(first) {
            if self.reader.texts(&variable.path)? != names {
                self.say(&variable.path, &format!("has other names than {first}"));
            }
            return Ok(());
        }
        let expected = self.values(first)?;
        self.follows(&variable.path, &expected, 0.0, first)
    }

    /// How many of so many values at a point of a sweep are of its replicas: others may have more.
    fn there(&self, path: &str, count: usize) -> Result<usize, OutputError> {
        if self.reader.layout().variable(path).dimensions.first() != Some(&Dimension::Replica) {
            return Ok(count);
        }
        Ok(count / self.reader.length(Dimension::Replica)?.max(1) * self.replicas as usize)
    }

    /// An attribute of a run, which files of several have as a dataset.
    pub fn number(&self, group: &str, name: &str) -> Result<f64, OutputError> {
        let path = format!("{}/{name}", group.trim_end_matches('/'));
        match self.place {
            Place::Point(_) => Ok(self.values(&path)?[0]),
            Place::Law(_) if self.has(&path) => Ok(self.values(&path)?[0]),
            _ => Ok(self.reader.number(group, name)?),
        }
    }

    /// A text at the place; of all points there is one dataset.
    pub fn text(&self, path: &str) -> Result<String, OutputError> {
        let texts = self.reader.texts(path)?;
        let index = match self.place {
            Place::Point(place) => {
                let shape = self.reader.point_shape()?;
                place.iter().zip(shape).fold(0, |index, (place, length)| index * length + place)
            }
            _ => 0,
        };
        Ok(texts.into_iter().nth(index).unwrap_or_default())
    }

    pub fn groups(&self) -> u64 {
        self.replicas / self.group
    }

    /// Whether only some of the replicas of a run are there.
    pub fn is_partial(&self) -> Result<bool, OutputError> {
        self.reader.has_attribute("/", "partial")
    }

    pub fn is_loop(&self) -> Result<bool, OutputError> {
        Ok(self.reader.optional_text("/", "history")?.is_some_and(|path| path == "loop"))
    }

    /// The ways that the surfaces take.
    pub fn course(&self) -> Result<Ways, OutputError> {
        if !self.is_loop()? {
            return Ok(Ways::One);
        }
        let is_repeated = self.reader.has_attribute("/", "cycles")? && self.number("/", "cycles")? > 1.0;
        Ok(if is_repeated { Ways::Repeated } else { Ways::Loop })
    }

    /// The beginnings of the names of datasets on each of these.
    pub fn ways(&self) -> Result<Vec<&'static str>, OutputError> {
        Ok(self.course()?.prefixes().collect())
    }

    pub fn say(&mut self, path: &str, problem: &str) {
        self.findings.push(format!("{path} {problem}"));
    }

    /// Where the value of an index stands in a dataset.
    fn index(&self, path: &str, index: usize) -> String {
        let variable = self.reader.layout().known().find(|variable| variable.path == path);
        let dimensions = match (variable.map_or(&[][..], |variable| &variable.dimensions), self.place) {
            ([Dimension::Law, rest @ ..], Place::Law(_)) => rest,
            (dimensions, _) => dimensions,
        };
        let length = |dimension: &Dimension| match self.place {
            Place::Point(_) => self.reader.length(dimension.of_points()),
            _ => self.reader.length(*dimension),
        };
        let mut rest = index;
        let mut places: Vec<String> = Vec::new();
        for dimension in dimensions.iter().rev() {
            let length = length(dimension).unwrap_or(1).max(1);
            places.push(format!("{} {}", dimension.name(), rest % length));
            rest /= length;
        }
        match places.len() {
            0 if index == 0 => String::new(),
            0 | 1 => format!(" at {index}"),
            _ => format!(" at {}", places.into_iter().rev().collect::<Vec<String>>().join(", ")),
        }
    }

    /// Says that a dataset has a value at an index, and what is expected there.
    pub fn say_at(&mut self, path: &str, index: usize, found: f64, expected: &str) {
        let place = self.index(path, index);
        self.say(path, &format!("has {found:e}{place}, and {expected}"));
    }

    /// Compares a dataset with what follows from others, each value within its tolerance.
    pub fn compare(
        &mut self,
        path: &str,
        found: &[f64],
        expected: &[f64],
        tolerance: impl Fn(usize) -> f64,
        from: &str,
    ) {
        if found.len() != expected.len() {
            return self.say(
                path,
                &format!("has {} values, and {} follow from {from}", found.len(), expected.len()),
            );
        }
        let agree = |i: usize| {
            let (found, expected) = (found[i], expected[i]);
            found == expected
                || found.is_nan() && expected.is_nan()
                || (found - expected).abs() <= tolerance(i)
        };
        if let Some(i) = (0..found.len()).find(|&i| !agree(i)) {
            self.say_at(path, i, found[i], &format!("{:e} follows from {from}", expected[i]));
        }
    }

    /// Compares a dataset as a whole with what follows from others, to a share of each value.
    pub fn follows(
        &mut self,
        path: &str,
        expected: &[f64],
        share: f64,
        from: &str,
    ) -> Result<(), OutputError> {
        let found = self.values(path)?;
        self.compare(path, &found, expected, |i| share * expected[i].abs(), from);
        Ok(())
    }

    /// Each dataset by itself.
    pub fn bounds(&mut self) -> Result<(), OutputError> {
        let of_all_points = self.place == Place::File && self.reader.layout().of_points.is_some();
        let has_ends =
            self.reader.layout().known().any(|known| known.dimensions.contains(&Dimension::Separation));
        let ends = if has_ends && !of_all_points { self.coordinate("separation")? } else { Vec::new() };
        let ends = (ends.first().copied().unwrap_or(f64::NAN), ends.last().copied().unwrap_or(f64::NAN));
        // Of a sweep some points may not be coupled.
        let lacks_coupling = self.has(COUPLED) && !self.is_coupled();
        for variable in self.reader.layout().known() {
            if !self.has(&variable.path)
                || !self.is_here(variable)
                || (lacks_coupling && is_of_coupled(variable))
            {
                continue;
            }
            self.copy(variable)?;
            let Some(bound) = bound_of(variable).filter(|bound| bound.is_of_numbers()) else { continue };
            let values = self.values(&variable.path)?;
            if let Some((i, expected)) = self.broken(bound, &values, ends) {
                self.say_at(&variable.path, i, values[i], &expected);
            }
            if matches!(self.place, Place::Point(_)) {
                self.padding(variable)?;
            }
        }
        Ok(())
    }

    /// Whether the place has a dataset: curves are looked at row by row, and what all points share with the
    /// file of all.
    fn is_here(&self, variable: &Variable) -> bool {
        let is_scale = is_shared(variable);
        match self.place {
            Place::Point(_) => !is_scale && !is_curve(variable),
            _ if self.reader.layout().of_points.is_some() => is_scale,
            _ => !is_curve(variable),
        }
    }

    /// Checks that all a point of a sweep does not have is NaN, or 0.
    fn padding(&mut self, variable: &Variable) -> Result<(), OutputError> {
        let Place::Point(place) = self.place else { return Ok(()) };
        if variable.dimensions.first() == Some(&Dimension::Replica) {
            let all = self.reader.numbers(&variable.path, Some(place))?;
            let there = self.there(&variable.path, all.len())?;
            if let Some(i) = (there..all.len()).find(|&i| !(all[i].is_nan() || all[i] == 0.0)) {
                self.say_at(&variable.path, i, all[i], &format!("the point has {} replicas", self.replicas));
            }
        }
        Ok(())
    }

    /// The index of a value that cannot be, and what it should be.
    fn broken(&self, bound: &Bound, values: &[f64], ends: (f64, f64)) -> Option<(usize, String)> {
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let slack = ROUNDING * largest;
        let is_point = matches!(self.place, Place::Point(_));
        let is_absent = |value: f64| {
            value.is_nan()
                && match bound.nan {
                    Nan::Never => false,
                    Nan::OneGroup => self.groups() < 2,
                    Nan::Absent => true,
                    Nan::Padded => is_point,
                }
        };
        let does = |i: usize| {
            let value = values[i];
            (value.is_finite() || bound.kind == Kind::Ratio && value == f64::INFINITY)
                && match bound.kind {
                    Kind::Other | Kind::Finite => true,
                    Kind::Ratio => value >= 0.0,
                    Kind::Index => value == i as f64,
                    Kind::Rising => i == 0 || value > values[i - 1],
                    Kind::Positive => value > 0.0,
                    Kind::NotNegative => value >= -slack,
                    Kind::Share => (0.0..=1.0).contains(&value),
                    Kind::Flag => value == 0.0 || value == 1.0,
                    Kind::Within => (ends.0..=ends.1).contains(&value),
                }
        };
        let place = (0..values.len()).find(|&i| !(is_absent(values[i]) || does(i)))?;
        Some((place, bound.kind.expected(ends)))
    }
}

/// Whether a dataset is a scale that all points of a sweep share.
fn is_shared(variable: &Variable) -> bool {
    variable.scales().is_some_and(|dimension| dimension.of_points() == dimension)
}

/// Whether a dataset is of coupled asperities alone.
fn is_of_coupled(variable: &Variable) -> bool {
    let of_coupled = [
        "/coupling/",
        "/validation/mean_field_",
        "/validation/retraction_mean_field_",
        "/validation/reapproach_mean_field_",
        "/asperities/",
        "/replicas/independent_",
        "/replicas/unsettled_count",
        "/replicas/overlapping_count",
        "/replicas/largest_crowding",
        "/replicas/largest_avalanche",
        "/replicas/avalanche_size_count",
        "/replicas/energy_lost",
    ];
    of_coupled.iter().any(|begin| variable.path.starts_with(begin))
}

/// Whether a dataset has a curve of every replica.
fn is_curve(variable: &Variable) -> bool {
    variable.dimensions == [Dimension::Replica, Dimension::Separation]
}

/// The names of the scalars of `/replicas`.
pub(super) fn names(ways: Ways) -> Vec<&'static str> {
    scalars(ways).map(|scalar| scalar.name).collect()
}

/// The largest magnitude of some numbers.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

pub(super) fn is_contact(name: &str) -> bool {
    Regime::named(name).is_some_and(Regime::is_contact)
}

/// The sums over some rows of so many columns.
pub(super) fn summed(values: &[f64], columns: usize, of: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sums = vec![0.0; columns];
    for (_, row) in values.chunks_exact(columns).enumerate().filter(|(row, _)| of(*row)) {
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
    sums
}
