//! A comparison: each law by the integral and by its ensemble, one asperity of it, and what it is beside the
//! first.

use super::answer::{Audit, Content};
use super::checked::{Checked, Place, ROUNDING, largest, refused, summed};
use super::cross_check::scheme;
use super::curves::LINES;
use crate::experiment::compare::deviation;
use crate::math::extrema::largest_secant;
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::scene::echo::one_line;
use crate::validation::{Cumulants, overall};
use std::f64::consts::PI;

/// The area of an asperity in contact over πRω is between these, deep in contact under any law.
const AREAS: (f64, f64) = (0.8, 2.35);
/// Interferences are deep from so many units of approach on.
const DEEP: f64 = 3.0;

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let laws = reader.texts(reader.coordinate("law"))?;
    if laws.is_empty() {
        return Err(refused(reader.path(), "has no laws"));
    }
    let is_sampled = reader.has(reader.coordinate("replica"));
    let replicas = if is_sampled { reader.number("/", "replicas")? } else { 0 };
    let mut file = Checked::new(reader, replicas);
    if is_sampled {
        file.group = scheme(&file)?.group();
        let there = reader.length(Dimension::Replica)? as u64;
        if replicas == 0 || replicas != there || !replicas.is_multiple_of(file.group) {
            return Err(refused(reader.path(), &format!("has replicas = {replicas} and {there} of them")));
        }
    }
    file.bounds()?;
    file.separations()?;
    file.differences()?;
    file.notes()?;
    let (group, mut findings) = (file.group, file.findings);
    for (law, name) in laws.iter().enumerate() {
        let mut checked = Checked { place: Place::Law(law), group, ..Checked::new(reader, replicas) };
        checked.law(is_sampled)?;
        findings.extend(checked.findings.into_iter().map(|finding| format!("{}: {finding}", one_line(name))));
    }
    let p_values = match is_sampled {
        true => reader.values("/validation/p_value")?,
        false => vec![f64::NAN; laws.len()],
    };
    let verdict = overall(&p_values);
    Ok(Audit { content: Content::Comparison { laws, p_values }, findings, verdict })
}

impl Checked<'_> {
    /// One law.
    fn law(&mut self, is_sampled: bool) -> Result<(), OutputError> {
        self.background_terms()?;
        self.sums("integral", "", "")?;
        self.deviations("")?;
        self.all_asperities()?;
        self.features()?;
        self.independence()?;
        self.edge()?;
        self.asperity()?;
        if self.has("/fit/range") {
            self.fit()?;
        }
        if is_sampled {
            self.sums("ensemble", "", "_mean")?;
            self.errors("")?;
            self.quantiles("")?;
            self.scores("")?;
            self.plausible("")?;
            self.pull_offs()?;
            self.significance()?;
        }
        Ok(())
    }

    /// Forces less those of the first law, and shares of what is read off them.
    fn differences(&mut self) -> Result<(), OutputError> {
        let laws = self.reader.length(Dimension::Law)?;
        for group in ["integral", "asperity"] {
            for name in ["adhesion_force", "external_force"] {
                let values = self.values(&format!("/{group}/{name}"))?;
                let length = (values.len() / laws).max(1);
                let expected: Vec<f64> =
                    values.iter().enumerate().map(|(i, value)| value - values[i % length]).collect();
                let path = format!("/{group}/{name}_difference");
                let found = self.values(&path)?;
                let size = |i: usize| values[i].abs() + values[i % length].abs();
                self.compare(&path, &found, &expected, |i| ROUNDING * size(i), "the first law");
            }
        }
        for (name, of) in [("pull_off", "pull_off_force"), ("peak_stiffness", "peak_stiffness")] {
            let values = self.values(&format!("/integral/{of}"))?;
            let expected: Vec<f64> = values.iter().map(|value| deviation(*value, values[0])).collect();
            let path = format!("/integral/{name}_deviation");
            let found = self.values(&path)?;
            self.compare(&path, &found, &expected, |i| ROUNDING * (1.0 + expected[i].abs()), "the first law");
        }
        Ok(())
    }

    /// A law is valid where nothing is noted.
    fn notes(&mut self) -> Result<(), OutputError> {
        let notes = self.reader.texts("/validity/note")?;
        let expected: Vec<f64> = notes.iter().map(|note| f64::from(u8::from(note.is_empty()))).collect();
        self.follows("/validity/valid", &expected, 0.0, "/validity/note")
    }

    /// No more asperities are in all regimes than there are.
    fn all_asperities(&mut self) -> Result<(), OutputError> {
        const PATH: &str = "/integral/regime_count";
        let (counts, s) = (self.values(PATH)?, self.coordinate("separation")?.len().max(1));
        let there = self.reader.number::<u64>("/", "asperity_count")? as f64;
        if let Some((k, sum)) =
            summed(&counts, s, |_| true).into_iter().enumerate().find(|(_, sum)| *sum > there * (1.0 + 1e-6))
        {
            self.say(
                PATH,
                &format!("comes to {sum:e} at separation {k}, and there are {there:e} asperities"),
            );
        }
        Ok(())
    }

    /// Whether the pull-off is at one of the ends of the separations.
    fn edge(&mut self) -> Result<(), OutputError> {
        let (h, place) = (self.coordinate("separation")?, self.number("/integral", "pull_off_separation")?);
        let is_end = h.first() == Some(&place) || h.last() == Some(&place);
        let expected = [f64::from(u8::from(is_end))];
        self.follows("/integral/pull_off_at_edge", &expected, 0.0, "/integral/pull_off_separation")
    }

    /// One asperity: F = P − F_s, what bears a load touches, and deep in contact its area is that of Hertz to
    /// that of flow.
    fn asperity(&mut self) -> Result<(), OutputError> {
        self.sums("asperity", "", "")?;
        let (contact, area) =
            (self.values("/asperity/contact_force")?, self.values("/asperity/contact_area")?);
        if let Some(i) = (0..area.len().min(contact.len())).find(|&i| area[i] == 0.0 && contact[i] > 0.0) {
            self.say_at("/asperity/contact_force", i, contact[i], "0 is expected without contact");
        }
        let approach = self.coordinate("interference")?;
        let [approach_unit, radius_unit] =
            ["approach_unit", "radius_unit"].map(|name| self.number("/", name));
        let (approach_unit, radius_unit) = (approach_unit?, radius_unit?);
        let deepest = (0..area.len()).rev().find(|&i| area[i] > 0.0);
        let Some(i) = deepest.filter(|&i| approach[i] > DEEP * approach_unit) else { return Ok(()) };
        let unit = PI * radius_unit * radius_unit * approach[i] / approach_unit;
        let (low, high) = (AREAS.0 * unit, AREAS.1 * unit);
        if !(low..=high).contains(&area[i]) {
            self.say_at("/asperity/contact_area", i, area[i], &format!("{low:e} to {high:e} is expected"));
        }
        Ok(())
    }

    /// A fit has a range, and no root mean square above the largest residual.
    fn fit(&mut self) -> Result<(), OutputError> {
        let is_fit = self.values("/fit/coefficients")?.iter().all(|value| value.is_finite());
        for name in ["coefficients", "range", "largest_force", "largest_residual", "rms_residual"] {
            let (path, expected) = (format!("/fit/{name}"), if is_fit { "a number" } else { "NaN" });
            let values = self.values(&path)?;
            if let Some(i) = values.iter().position(|value| value.is_nan() == is_fit) {
                self.say_at(&path, i, values[i], &format!("{expected} is expected as for all of the fit"));
            }
        }
        let range = self.values("/fit/range")?;
        if let Some(i) = range.chunks_exact(2).position(|ends| ends[0] >= ends[1]) {
            self.say_at(
                "/fit/range",
                2 * i,
                range[2 * i],
                &format!("less than {:e} is expected", range[2 * i + 1]),
            );
        }
        let (largest, rms) = (self.values("/fit/largest_residual")?, self.values("/fit/rms_residual")?);
        if let Some(i) = (0..rms.len().min(largest.len())).find(|&i| rms[i] > largest[i] * (1.0 + ROUNDING)) {
            self.say_at("/fit/rms_residual", i, rms[i], &format!("the largest is {:e}", largest[i]));
        }
        Ok(())
    }

    /// Pull-offs less those of the first law on the same asperities, and beside the mean curve.
    fn pull_offs(&mut self) -> Result<(), OutputError> {
        const PATH: &str = "/replicas/pull_off_force";
        let (own, n) = (self.values(PATH)?, self.replicas as usize);
        let first: Vec<f64> = self.reader.numbers(PATH, None)?[..n].to_vec();
        let differences: Vec<f64> = own.iter().zip(&first).map(|(own, first)| own - first).collect();
        let moments = Moments::of_groups(&differences, self.group as usize);
        let size = largest(&own) + largest(&first);
        for (name, expected) in [("mean", moments.mean()[0]), ("standard_error", moments.standard_error()[0])]
        {
            let path = format!("/ensemble/pull_off_force_difference_{name}");
            let found = self.values(&path)?;
            self.compare(&path, &found, &[expected], |_| ROUNDING * size, PATH);
        }
        self.secants()?;
        // The mean of minima is below the minimum of the mean.
        let curve = self.values("/ensemble/external_force_mean")?;
        let (mean, deepest) =
            (own.iter().sum::<f64>() / n as f64, curve.iter().copied().fold(f64::INFINITY, f64::min));
        if mean < -deepest - ROUNDING * size {
            self.say(PATH, &format!("has the mean {mean:e}, and the mean curve has {:e}", -deepest));
        }
        Ok(())
    }

    /// The mean of the largest secants is above the largest of the mean.
    fn secants(&mut self) -> Result<(), OutputError> {
        const PATH: &str = "/replicas/peak_secant_stiffness";
        let (own, place) = (self.values(PATH)?, self.values(&format!("{PATH}_separation"))?);
        let is_known = own.iter().any(|value| !value.is_nan());
        for (path, values) in [(PATH.to_owned(), &own), (format!("{PATH}_separation"), &place)] {
            if let Some(i) = values.iter().position(|value| value.is_nan() == is_known) {
                self.say_at(
                    &path,
                    i,
                    values[i],
                    "all replicas have a span within the separations, or none has",
                );
            }
        }
        let (h, span) = (self.coordinate("separation")?, self.number("/", "stiffness_span")?);
        let curve = self.values("/ensemble/external_force_mean")?;
        if h.len() > 1 && span <= h[h.len() - 1] - h[0] {
            let (mean, of_mean) =
                (own.iter().sum::<f64>() / own.len() as f64, largest_secant(&h, &curve, span).value);
            if mean < of_mean - LINES * of_mean.abs() - ROUNDING * (largest(&own) + largest(&curve) / span) {
                self.say(PATH, &format!("has the mean {mean:e}, and the mean curve has {of_mean:e}"));
            }
        }
        Ok(())
    }

    /// The p-value of the statistic.
    fn significance(&mut self) -> Result<(), OutputError> {
        let one = |name: &str| self.number("/validation", name);
        let (statistic, freedom) = (one("statistic")?, one("degrees_of_freedom")?);
        let cumulants = Cumulants { kurtosis: one("kurtosis")?, skewness: one("skewness")? };
        let expected = match statistic.is_nan() {
            true => f64::NAN,
            false => cumulants.of(1.0 / self.replicas as f64).upper_tail(statistic, freedom as u64),
        };
        let found = self.values("/validation/p_value")?;
        self.compare("/validation/p_value", &found, &[expected], |_| 1e-6, "the statistic");
        Ok(())
    }
}
