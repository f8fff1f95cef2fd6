//! Numbers of asperities: of all regimes together, and those that come into contact and lose it.

use super::checked::{Checked, ROUNDING, is_contact, summed};
use crate::output::OutputError;

/// Asperities from which on the highest of a replica is above their mean plane.
const MANY: f64 = 100.0;

impl Checked<'_> {
    /// Asperities: of all regimes together, and those that come into contact and lose it.
    pub fn counts(&mut self, cycle: bool) -> Result<(), OutputError> {
        let s = self.coordinate("separation")?.len().max(1);
        let own = self.values("/replicas/asperity_count")?;
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        if self.reader.optional_text("/", "count")?.is_some_and(|count| count == "fixed")
            && own.windows(2).any(|pair| pair[0] != pair[1])
        {
            self.say("/replicas/asperity_count", "differs, and the number is fixed");
        }
        let regimes = self.reader.texts(self.reader.coordinate("regime"))?;
        for way in self.ways()? {
            let expected = self.values(&format!("/integral/{way}regime_count"))?;
            let expected = summed(&expected, s, |_| true);
            let all = expected.iter().copied().fold(0.0, f64::max);
            let path = format!("/ensemble/{way}regime_count_mean");
            let counts = self.values(&path)?;
            let sum = summed(&counts, s, |_| true);
            // The law `emd` may end before the first asperity: what is beyond its last regime is in none.
            let scatter = 1e-6 + 12.0 / (mean * own.len() as f64).sqrt();
            let ends = all < mean * (1.0 - scatter)
                && self.reader.optional_text("/", "law")?.as_deref() == Some("emd");
            let complete =
                |i: &usize| !ends && self.replicas as f64 * (all - expected[*i]) < 1e-6 * all.max(1.0);
            let wrong = (0..s)
                .find(|i| sum[*i] > mean * (1.0 + ROUNDING) || complete(i) && sum[*i] < mean * (1.0 - 1e-6));
            if let Some(i) = wrong {
                self.say(
                    &path,
                    &format!("has {:e} asperities at {i}, and the replicas have {mean:e}", sum[i]),
                );
            }
            if !ends && (all - mean).abs() > scatter * mean {
                self.say(
                    &format!("/integral/{way}regime_count"),
                    &format!("has {all:e} asperities, and the replicas {mean:e}"),
                );
            }
        }
        self.highest(&own, &regimes, s)?;
        if !cycle {
            return Ok(());
        }
        for (name, way) in [("jump_in_count", ""), ("jump_off_count", "retraction_")] {
            for (group, of) in [("ensemble", "_mean"), ("integral", "")] {
                let counts = self.values(&format!("/{group}/{way}regime_count{of}"))?;
                let apart = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| !is_contact(name)));
                let changes: Vec<f64> = apart.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let path = format!("/{group}/{name}{of}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &changes, |_| ROUNDING * mean, "the counts of the regimes");
            }
        }
        Ok(())
    }

    /// The highest asperities: one that is above the other surface touches it.
    fn highest(&mut self, asperities: &[f64], regimes: &[String], s: usize) -> Result<(), OutputError> {
        const PATH: &str = "/replicas/highest_asperity";
        let highest = self.values(PATH)?;
        let is_wrong = |i: &usize| {
            let (count, highest) = (asperities[*i], highest[*i]);
            count > 0.0 && !highest.is_finite() || count >= MANY && highest <= 0.0
        };
        if let Some(i) = (0..highest.len().min(asperities.len())).find(is_wrong) {
            self.say(PATH, &format!("has {:e} at {i}, of {} asperities", highest[i], asperities[i]));
        }
        let counts = self.values("/ensemble/regime_count_mean")?;
        let touching = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| is_contact(name)));
        let all = summed(&counts, s, |_| true);
        let mean = asperities.iter().sum::<f64>() / asperities.len().max(1) as f64;
        for (k, d) in self.coordinate("asperity_separation")?.into_iter().enumerate() {
            let above = highest.iter().filter(|highest| **highest > d).count() as f64;
            // A law may end before.
            if all[k] >= mean * (1.0 - ROUNDING)
                && above > self.replicas as f64 * touching[k] * (1.0 + ROUNDING) + 0.5
            {
                self.say(
                    PATH,
                    &format!("is above the other surface in {above} replicas at {k}, more than touch"),
                );
                break;
            }
        }
        Ok(())
    }
}
