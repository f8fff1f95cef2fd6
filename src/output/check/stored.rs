//! A run, or a point of a sweep, as its file has it.

use crate::engine::Ways;
use crate::error::OutputError;
use crate::output::reader::Reader;

/// A curve that files of coupled asperities have.
const COUPLED: &str = "/coupling/independent_external_force_mean";

/// A run of a file, or a point of a sweep.
pub(super) struct StoredRun<'a> {
    pub reader: &'a Reader,
    /// The index of a point along each dimension of the points.
    pub place: Option<&'a [usize]>,
    pub replicas: u64,
    /// Replicas of a group.
    pub group: u64,
}

impl StoredRun<'_> {
    /// The values of a dataset.
    pub fn values(&self, path: &str) -> Result<Vec<f64>, OutputError> {
        match self.place {
            Some(place) => self.reader.at_point(path, place),
            None => self.reader.values(path),
        }
    }

    /// A number of `/validation`, which a sweep has over its points.
    pub fn number(&self, name: &str) -> Result<f64, OutputError> {
        match self.place {
            Some(place) => Ok(self.reader.numbers(&format!("/validation/{name}"), Some(place))?[0]),
            None => self.reader.number("/validation", name),
        }
    }

    /// The beginnings of the names of datasets on each way that the surfaces take.
    pub fn ways(&self) -> Result<Vec<&'static str>, OutputError> {
        let reader = self.reader;
        let is_loop = reader.optional_text("/", "history")?.is_some_and(|history| history == "loop");
        let has_cycles = reader.has_attribute("/", "cycles")?;
        let cycles = if has_cycles { reader.number::<f64>("/", "cycles")? } else { 1.0 };
        let ways = match is_loop {
            false => Ways::One,
            true if cycles > 1.0 => Ways::Repeated,
            true => Ways::Loop,
        };
        Ok(ways.prefixes().collect())
    }

    pub fn groups(&self) -> u64 {
        self.replicas / self.group
    }

    /// The beginning of the paths of a quantity without coupling, which the integral does not know.
    pub fn independent(&self, way: &str, name: &str) -> String {
        let is_absent = |values: Vec<f64>| values.iter().all(|value| value.is_nan());
        let is_coupled =
            self.reader.has(COUPLED) && (self.place.is_none() || !self.values(COUPLED).is_ok_and(is_absent));
        match is_coupled {
            true => format!("/coupling/{way}independent_{name}"),
            false => format!("/ensemble/{way}{name}"),
        }
    }

    /// Standard deviation of the mean of one group of replicas: 0 where all agree, which has no standard error.
    pub fn std_of_groups(&self, way: &str, name: &str) -> Result<Vec<f64>, OutputError> {
        let groups = self.groups();
        let errors = self.values(&format!("{}_standard_error", self.independent(way, name)))?;
        let std = |error: &f64| if groups > 1 { (groups as f64).sqrt() * error.max(0.0) } else { f64::NAN };
        Ok(errors.iter().map(std).collect())
    }
}
