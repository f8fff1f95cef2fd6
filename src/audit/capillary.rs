//! Bridges of liquid, against the regimes that they are in.

use super::checked::{Checked, ROUNDING};
use crate::asperity::Regime;
use crate::math::extrema::smallest;
use crate::output::OutputError;

const GROUP: &str = "/capillary";

impl Checked<'_> {
    /// Wet asperities are those that touch and those with a bridge; what they cover follows from their forces and the
    /// liquid; nothing in files of dry asperities.
    pub fn bridges(&mut self) -> Result<(), OutputError> {
        if !self.has(&format!("{GROUP}/kelvin_radius")) {
            return Ok(());
        }
        let number = |name: &str| self.values(&format!("{GROUP}/{name}")).map(|values| values[0]);
        let (pressure, range, energy) =
            (number("capillary_pressure")?, number("range")?, number("liquid_energy")?);
        self.figure_of(&format!("{GROUP}/liquid_energy"), energy, pressure * range);
        let s = self.coordinate("separation")?.len().max(1);
        let regimes = self.reader.texts(self.reader.coordinate("regime"))?;
        let own = self.values("/replicas/asperity_count")?;
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        let (radius, nominal) = (self.number("/", "asperity_radius")?, self.number("/", "nominal_area")?);
        for way in self.ways()? {
            let rows = |name: &str| self.values(&format!("/ensemble/{way}regime_{name}_mean"));
            let (counts, pulls) = (rows("count")?, rows("adhesion_force")?);
            let areas = self.values(&format!("/ensemble/{way}contact_area_mean"))?;
            let (mut wet, mut wetted) = (vec![0.0; s], areas.clone());
            for (row, name) in regimes.iter().enumerate() {
                let Some(regime) = Regime::named(name) else { continue };
                let own = row * s..(row + 1) * s;
                let states = wet.iter_mut().zip(&mut wetted).zip(counts[own.clone()].iter().zip(&pulls[own]));
                for ((wet, wetted), (count, pull)) in states {
                    if regime == Regime::Bridge {
                        *wet += count;
                        *wetted += pull / pressure;
                    } else if regime.is_contact() {
                        *wet += count;
                        *wetted += count * std::f64::consts::TAU * radius * range;
                    }
                }
            }
            let steps = wet.windows(2).map(|pair| pair[0] - pair[1]);
            let steps: Vec<f64> = [0.0].into_iter().chain(steps).collect();
            let covered: Vec<f64> = wetted.iter().map(|area| -(-area / nominal).exp_m1()).collect();
            let path = format!("{GROUP}/{way}bridge_step_count");
            let found = self.values(&path)?;
            self.compare(&path, &found, &steps, |_| ROUNDING * mean, "the counts of the regimes");
            let path = format!("{GROUP}/{way}covered_share");
            let found = self.values(&path)?;
            self.compare(&path, &found, &covered, |_| ROUNDING, "the forces of the regimes");
            let path = format!("{GROUP}/{way}wet_share");
            let found = self.values(&path)?;
            let shares: Vec<f64> = wet.iter().map(|wet| wet / mean).collect();
            self.compare(&path, &found, &shares, |_| ROUNDING, "the counts of the regimes");
        }
        Ok(())
    }

    /// Films are no thicker than before they drain, bridges feed on them, and the law has those of the pull-off; nothing in
    /// files without films.
    pub fn films(&mut self) -> Result<(), OutputError> {
        const FILM: &str = "/film";
        if !self.has(&format!("{FILM}/law_thickness")) {
            return Ok(());
        }
        let initial = self.values(&format!("{FILM}/initial_thickness"))?[0];
        let mut at_pull_off = initial;
        for way in self.ways()? {
            let path = format!("{FILM}/{way}thickness");
            let (thickness, forces) =
                (self.values(&path)?, self.values(&format!("{FILM}/{way}external_force"))?);
            if let Some(k) = thickness.iter().position(|thickness| *thickness > initial * (1.0 + ROUNDING)) {
                self.say_at(&path, k, thickness[k], &format!("{initial:e} at most is expected"));
            }
            at_pull_off = thickness[smallest(&forces)];
        }
        let path = format!("{FILM}/law_thickness");
        self.follows(&path, &[at_pull_off], ROUNDING, "the film where the surfaces are pulled off")
    }

    fn figure_of(&mut self, path: &str, found: f64, expected: f64) {
        if !((found - expected).abs() <= 1e-12 * expected.abs()) {
            self.say(path, &format!("is {found:e}, and capillary_pressure times range is {expected:e}"));
        }
    }
}
