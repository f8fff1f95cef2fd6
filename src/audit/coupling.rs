//! What coupling makes of an ensemble: differences, and the curves against their mean field.

use super::checked::{Checked, ROUNDING, largest};
use crate::asperity::Quantity;
use crate::output::OutputError;
use crate::validation::z_scores;

impl Checked<'_> {
    /// Differences that coupling makes, and the curve with coupling against its mean field.
    pub fn coupling(&mut self, way: &str) -> Result<(), OutputError> {
        if !self.is_coupled() {
            return Ok(());
        }
        for quantity in Quantity::ALL {
            let name = quantity.name();
            let path = format!("/coupling/{way}difference_{name}_mean");
            if !self.has(&path) {
                return Ok(());
            }
            let with = self.values(&format!("/ensemble/{way}{name}_mean"))?;
            let without = self.values(&format!("/coupling/{way}independent_{name}_mean"))?;
            let expected = minus(&with, &without);
            let (found, size) = (self.values(&path)?, largest(&with).max(largest(&without)));
            self.compare(&path, &found, &expected, |_| ROUNDING * size, "means with coupling and without");
        }
        self.mean_field(way)
    }

    /// Avalanches by their size, and what they lost, are those of all replicas, and of all steps; states that are no results
    /// likewise.
    pub fn avalanches(&mut self) -> Result<(), OutputError> {
        const PATH: &str = "/coupling/avalanche_size_count";
        const LOST: &str = "/replicas/energy_lost";
        if !self.has(PATH) {
            return Ok(());
        }
        let total = self.classes("avalanche_size_count")?;
        self.classes("energy_lost_count")?;
        // Steps of a point of a sweep without coupling have no avalanches, not none.
        if !self.is_coupled() {
            return Ok(());
        }
        for kind in ["unsettled", "overlapping"] {
            let path = format!("/replicas/{kind}_count");
            let mut of_states = 0.0;
            for way in self.ways()? {
                of_states += self.values(&format!("/coupling/{way}{kind}_count"))?.iter().sum::<f64>();
            }
            let total = self.values(&path)?.iter().sum::<f64>();
            self.compare(&path, &[total], &[of_states], |_| 0.0, "all separations together");
        }
        let of_steps = self.all_steps("avalanche_count")?;
        let count: f64 = of_steps.iter().sum();
        self.compare(PATH, &[total], &[count], |_| ROUNDING * (1.0 + count), "all steps together");
        let (found, of_steps) = (self.values(LOST)?, self.all_steps("energy_lost")?);
        // Of laws by which surfaces may gain, terms have both signs.
        let size: f64 = of_steps.iter().chain(&found).map(|energy| energy.abs()).sum();
        let sums = [found.iter().sum(), of_steps.iter().sum()];
        self.compare(LOST, &sums[..1], &sums[1..], |_| ROUNDING * size, "all steps together");
        Ok(())
    }

    /// Counts by classes are those of all replicas; their sum.
    fn classes(&mut self, name: &str) -> Result<f64, OutputError> {
        let path = format!("/coupling/{name}");
        let found = self.values(&path)?;
        let mut expected = vec![0.0; found.len()];
        for own in self.values(&format!("/replicas/{name}"))?.chunks_exact(found.len().max(1)) {
            expected.iter_mut().zip(own).for_each(|(sum, count)| *sum += count);
        }
        self.compare(&path, &found, &expected, |_| 0.0, "the replicas");
        Ok(found.iter().sum())
    }

    /// What there is of all replicas on each step, of which the file has the mean.
    fn all_steps(&mut self, name: &str) -> Result<Vec<f64>, OutputError> {
        let mut all = Vec::new();
        for way in self.ways()? {
            let mean = self.values(&format!("/coupling/{way}{name}_mean"))?;
            all.extend(mean.iter().map(|mean| mean * self.replicas as f64));
        }
        Ok(all)
    }

    fn mean_field(&mut self, way: &str) -> Result<(), OutputError> {
        let path = |name: &str| format!("/validation/{way}mean_field_{name}");
        if !self.has(&path("z")) {
            return Ok(());
        }
        let force = self.values(&path("external_force"))?;
        let mean = self.values(&format!("/ensemble/{way}external_force_mean"))?;
        let error = self.values(&format!("/ensemble/{way}external_force_standard_error"))?;
        let size = ROUNDING * largest(&mean).max(largest(&force));
        let expected = minus(&mean, &force);
        let found = self.values(&path("difference"))?;
        self.compare(&path("difference"), &found, &expected, |_| size, "the mean and its mean field");
        let found = self.values(&path("standard_error"))?;
        self.compare(&path("standard_error"), &found, &error, |i| ROUNDING * error[i], "the ensemble");
        let scores = z_scores(&mean, &force, &error, 1);
        let found = self.values(&path("z"))?;
        self.compare(&path("z"), &found, &scores, |i| ROUNDING * (1.0 + scores[i].abs()), "the differences");
        self.field_itself(way, &force)
    }

    /// A patch gives way by F/k_s; the mean field of a repeated square, which does not, is the integral.
    fn field_itself(&mut self, way: &str, force: &[f64]) -> Result<(), OutputError> {
        let path = format!("/validation/{way}mean_field_separation");
        let (found, h) = (self.values(&path)?, self.coordinate("separation")?);
        if found == h {
            let integral = self.values(&format!("/integral/{way}external_force"))?;
            let path = format!("/validation/{way}mean_field_external_force");
            self.compare(&path, force, &integral, |_| 0.0, "the integral");
            return Ok(());
        }
        let stiffness = self.values("/independence/substrate_stiffness")?[0];
        // What bends it is the force of the asperities.
        let background = self.background(way, h.len())?;
        let own = |k: usize| h[k] + (force[k] + background[k]) / stiffness;
        let expected: Vec<f64> = (0..h.len()).map(own).collect();
        self.compare(&path, &found, &expected, |_| ROUNDING * largest(&h), "the force over k_s");
        if let Some(i) = (1..found.len()).find(|&i| found[i] < found[i - 1]) {
            self.say_at(&path, i, found[i], "no less than the one before is expected");
        }
        Ok(())
    }
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
