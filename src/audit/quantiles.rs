//! Checks of the quantiles of the external force.

use super::checked::{Checked, Place, ROUNDING, largest};
use super::curves::MOST_AT_POINT;
use crate::engine::{FEWEST_CURVES, FIRST_CURVES, quantiles};
use crate::output::OutputError;

impl Checked<'_> {
    /// Quantiles are there where enough of the first replicas are, rise with their probability, are no further from
    /// the mean than the standard deviation allows, and are those of the curves, where the file has these.
    pub fn quantiles(&mut self, way: &str) -> Result<(), OutputError> {
        let path = format!("/ensemble/{way}external_force_quantile");
        if !self.has(&path) {
            return Ok(());
        }
        let (found, probabilities) = (self.values(&path)?, self.coordinate("quantile")?);
        if let Some(i) = (0..probabilities.len()).find(|&i| !(0.0..=1.0).contains(&probabilities[i])) {
            self.say_at("/ensemble/quantile", i, probabilities[i], "a number from 0 to 1 is expected");
            return Ok(());
        }
        let s = found.len() / probabilities.len().max(1);
        let count = self.first_curves()?;
        let are_none = count.map_or(found.iter().all(|force| force.is_nan()), |count| count < FEWEST_CURVES);
        if let Some(i) = found.iter().position(|force| force.is_nan() != are_none) {
            let problem = match are_none {
                true => format!("NaN is expected of fewer than {FEWEST_CURVES} replicas"),
                false => "a number is expected".to_owned(),
            };
            self.say_at(&path, i, found[i], &problem);
        }
        let slack = ROUNDING * largest(&found);
        if let Some(i) = (s..found.len()).find(|&i| found[i] < found[i - s] - slack) {
            self.say_at(&path, i, found[i], &format!("at least {:e} is expected", found[i - s]));
        }
        let Some(count) = count.filter(|_| !are_none) else { return Ok(()) };
        let statistic = |name: &str| self.values(&format!("/ensemble/{way}external_force_{name}"));
        let (mean, std) = (statistic("mean")?, statistic("std")?);
        for (i, force) in found.iter().enumerate() {
            // What a share of all replicas reaches is at most so many standard deviations from the mean (Cantelli).
            let below = (probabilities[i / s] * (count - 1) as f64).floor() as usize;
            let reach = |of: usize| (self.replicas as f64 / of.max(1) as f64 - 1.0).sqrt() * std[i % s];
            let (low, high) = (mean[i % s] - reach(below + 1), mean[i % s] + reach(count - 1 - below));
            if *force < low - slack || *force > high + slack {
                let expected = format!("{low:e} to {high:e} is expected by mean and standard deviation");
                self.say_at(&path, i, *force, &expected);
                break;
            }
        }
        let curves = format!("/replicas/{way}external_force");
        let is_read = self.place == Place::File || self.replicas as usize * s <= MOST_AT_POINT;
        if self.has(&curves) && is_read {
            let forces = match self.place {
                Place::File => self.reader.rows::<f64>(&curves, 0..count)?,
                _ => self.values(&curves)?[..count * s].to_vec(),
            };
            let expected = quantiles(&forces, s, &probabilities).concat();
            self.compare(&path, &found, &expected, |_| slack, "the curves of the replicas");
        }
        Ok(())
    }

    /// How many of the replicas are among the first of the run, which quantiles are of; unknown at a point of a sweep
    /// that is not whole.
    fn first_curves(&self) -> Result<Option<usize>, OutputError> {
        Ok(match (self.is_partial()?, self.place) {
            (false, _) => Some(self.replicas.min(FIRST_CURVES) as usize),
            (true, Place::File) => {
                let replicas = self.coordinate("replica")?;
                Some(replicas.iter().filter(|replica| **replica < FIRST_CURVES as f64).count())
            }
            (true, _) => None,
        })
    }
}
