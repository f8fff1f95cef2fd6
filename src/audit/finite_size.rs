//! Patches of several sizes: what is said of each size follows from its replicas, and what is said of all of
//! them from each.

use super::answer::{Audit, Content};
use super::checked::{Checked, ROUNDING, largest};
use super::cross_check::scheme;
use super::scalars::FARTHEST;
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::scene::echo::one_line;
use crate::validation::finite_size::{Approach, QUANTILES, Reached, Scatter};
use crate::validation::overall;

/// Beginning of the datasets of the pull-off force over the number of asperities.
const FORCE: &str = "/pull_off_per_asperity";

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let mut checked = Checked::new(reader, reader.length(Dimension::Replica)? as u64);
    checked.group = scheme(&checked)?.group();
    checked.bounds()?;
    let replicas: Vec<f64> = (0..checked.replicas).map(|index| index as f64).collect();
    checked.follows("/replica", &replicas, 0.0, "their number")?;
    checked.follows("/quantile", &QUANTILES, ROUNDING, "the format")?;
    let counts = checked.values("/asperity_count")?;
    let areas = checked.values("/nominal_area")?;
    let expected: Vec<f64> = counts.iter().map(|count| count / counts[0] * areas[0]).collect();
    checked.compare(
        "/nominal_area",
        &areas,
        &expected,
        |i| ROUNDING * expected[i],
        "the numbers of asperities",
    );
    checked.means()?;
    checked.scatter()?;
    checked.independence_of_sizes(&areas)?;
    checked.approach(&counts)?;
    let p_values = checked.values("/p_value")?;
    let verdict = overall(&p_values);
    Ok(Audit { content: Content::FiniteSize { p_values }, findings: checked.findings, verdict })
}

/// The forces of the replicas that a size has: others may have more.
fn there(forces: &[f64]) -> &[f64] {
    let beyond = forces.iter().rev().take_while(|force| force.is_nan()).count();
    &forces[..forces.len() - beyond]
}

impl Checked<'_> {
    /// Means over replicas, and their bias to the integral.
    fn means(&mut self) -> Result<(), OutputError> {
        let forces = self.values(FORCE)?;
        let n = self.replicas.max(1) as usize;
        let (mut means, mut errors) = (Vec::new(), Vec::new());
        for own in forces.chunks_exact(n).map(there) {
            let moments = Moments::of_groups(own, self.group as usize);
            means.push(moments.mean()[0]);
            errors.push(moments.standard_error()[0]);
        }
        let size: Vec<f64> = forces.chunks_exact(n).map(there).map(largest).collect();
        let of = |name: &str| format!("{FORCE}_{name}");
        let found = self.values(&of("mean"))?;
        self.compare(&of("mean"), &found, &means, |i| ROUNDING * size[i], FORCE);
        let found = self.values(&of("standard_error"))?;
        self.compare(&of("standard_error"), &found, &errors, |i| ROUNDING * size[i], FORCE);
        let [controlled, error] =
            ["controlled_mean", "controlled_standard_error"].map(|name| self.values(&of(name)));
        let (controlled, error) = (controlled?, error?);
        let is_far =
            |i: &usize| (controlled[*i] - means[*i]).abs() > FARTHEST * errors[*i] + ROUNDING * size[*i];
        if let Some(i) = (0..controlled.len().min(means.len())).find(is_far) {
            self.say_at(
                &of("controlled_mean"),
                i,
                controlled[i],
                &format!("the plain mean is {:e}", means[i]),
            );
        }
        let is_worse = |i: &usize| error[*i] > FARTHEST * errors[*i] + ROUNDING * size[*i];
        if let Some(i) = (0..error.len().min(errors.len())).find(is_worse) {
            let plain = format!("the plain one is {:e}", errors[i]);
            self.say_at(&of("controlled_standard_error"), i, error[i], &plain);
        }
        let integral = self.values("/integral_pull_off_per_asperity")?[0];
        let bias: Vec<f64> = controlled.iter().map(|mean| mean / integral - 1.0).collect();
        let found = self.values("/bias")?;
        let from = "the means with control variates and the integral";
        self.compare("/bias", &found, &bias, |i| ROUNDING * (1.0 + bias[i].abs()), from);
        let errors: Vec<f64> = error.iter().map(|error| error / integral).collect();
        self.follows("/bias_standard_error", &errors, ROUNDING, from)
    }

    /// How replicas scatter.
    fn scatter(&mut self) -> Result<(), OutputError> {
        let (forces, integral) = (self.values(FORCE)?, self.values("/integral_pull_off_per_asperity")?[0]);
        let of_size =
            |own: &[f64]| Scatter::new(&own.iter().map(|force| force / integral).collect::<Vec<f64>>());
        let sizes = forces.chunks_exact(self.replicas.max(1) as usize).map(there);
        let all: Vec<Scatter> = sizes.map(of_size).collect();
        let of = |value: fn(&Scatter) -> f64| all.iter().map(value).collect::<Vec<f64>>();
        self.follows("/relative_std", &of(|scatter| scatter.relative_std), ROUNDING, FORCE)?;
        let (expected, found) = (of(|scatter| scatter.skewness), self.values("/skewness")?);
        self.compare("/skewness", &found, &expected, |i| 1e-6 * (1.0 + expected[i].abs()), FORCE);
        let expected: Vec<f64> = all.iter().flat_map(|scatter| scatter.quantiles).collect();
        let found = self.values("/pull_off_quantiles")?;
        self.compare("/pull_off_quantiles", &found, &expected, |_| ROUNDING * largest(&expected), FORCE);
        Ok(())
    }

    /// The power law of the biases, and the number of asperities from which on each accuracy is had.
    fn approach(&mut self, counts: &[f64]) -> Result<(), OutputError> {
        const FROM: &str = "the biases";
        let (bias, errors) = (self.values("/bias")?, self.values("/bias_standard_error")?);
        let approach = Approach::new(counts, &bias, &errors);
        let fitted = approach.as_ref().map_or(vec![false; counts.len()], |fit| fit.fitted.clone());
        let fitted: Vec<f64> = fitted.into_iter().map(|fitted| f64::from(u8::from(fitted))).collect();
        self.follows("/is_fitted", &fitted, 0.0, FROM)?;
        let bias_of = |count: &f64| approach.as_ref().map_or(f64::NAN, |fit: &Approach| fit.bias(*count));
        self.follows("/bias_fitted", &counts.iter().map(bias_of).collect::<Vec<f64>>(), 1e-6, FROM)?;
        match &approach {
            Ok(fit) => {
                for (name, expected) in [
                    ("coefficient", fit.coefficient),
                    ("exponent", fit.exponent),
                    ("log_coefficient_standard_error", fit.standard_errors[0]),
                    ("exponent_standard_error", fit.standard_errors[1]),
                    ("chi_squared", fit.chi_squared),
                ] {
                    let name = format!("fit_{name}");
                    let there = self.reader.has_attribute("/", &name)?;
                    let found = if there { self.reader.number("/", &name)? } else { f64::NAN };
                    let tolerance =
                        |_| 1e-6 * (expected.abs() + if name == "fit_chi_squared" { 1.0 } else { 0.0 });
                    self.compare(&format!("/{name}"), &[found], &[expected], tolerance, FROM);
                }
            }
            Err(refusal) if self.reader.has_attribute("/", "fit_coefficient")? => {
                self.say("/fit_coefficient", &format!("is there, and {refusal}"));
            }
            Err(_) => {}
        }
        let accuracies = self.values("/accuracy")?;
        let reached: Vec<Reached> = accuracies
            .iter()
            .map(|accuracy| Reached::new(*accuracy, counts, &bias, &errors, approach.as_ref().ok()))
            .collect();
        let found: Vec<f64> = reached.iter().map(|reached| reached.count()).collect();
        self.follows("/count_at_accuracy", &found, 1e-6, FROM)?;
        let told = self.reader.texts("/count_at_accuracy_source")?;
        if let Some(i) = (0..told.len().min(reached.len())).find(|&i| told[i] != reached[i].name()) {
            let (told, own) = (one_line(&told[i]), reached[i].name());
            self.say(
                "/count_at_accuracy_source",
                &format!("has \"{told}\" at {i}, and \"{own}\" follows from {FROM}"),
            );
        }
        Ok(())
    }
}
