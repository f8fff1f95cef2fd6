//! Asperities of a coupled surface one by one, against what its curves say of all.

use super::checked::{Checked, Place, ROUNDING};
use crate::output::OutputError;
use crate::output::schema::Dimension;

impl Checked<'_> {
    /// Checks the asperities of the first replica, where the file has them: their number, the separations of their
    /// states, their forces against the curve of the replica, and that nothing presses out of contact.
    pub fn asperity_states(&mut self) -> Result<(), OutputError> {
        if !self.has("/asperities/interference") || !self.is_coupled() {
            return Ok(());
        }
        let there =
            |values: Vec<f64>| values.into_iter().filter(|value| !value.is_nan()).collect::<Vec<f64>>();
        let count = there(self.values("/asperities/height")?).len();
        let expected = self.values("/replicas/asperity_count")?.first().copied().unwrap_or(0.0);
        if count as f64 != expected {
            self.say("/asperities/height", &format!("has {count} asperities, and the replica {expected}"));
        }
        let separations = self.coordinate("separation")?;
        let states = there(self.values("/asperities/state_separation")?);
        let at: Vec<usize> =
            states.iter().filter_map(|h| separations.iter().position(|known| known == h)).collect();
        if at.len() < states.len() {
            self.say("/asperities/state_separation", "has a separation that the curves do not have");
            return Ok(());
        }
        for way in self.ways()? {
            self.states_of(way, &at)?;
        }
        Ok(())
    }

    /// The states of one way, at separations by their indices.
    fn states_of(&mut self, way: &str, at: &[usize]) -> Result<(), OutputError> {
        let path = |name: &str| format!("/asperities/{way}{name}");
        let [external, contact, area, is_contact, at_rest] =
            ["external_force", "contact_force", "contact_area", "in_contact", "at_rest"]
                .map(|name| self.values(&path(name)));
        let (external, contact, area) = (external?, contact?, area?);
        let (is_contact, at_rest) = (is_contact?, at_rest?);
        let presses =
            |i: &usize| is_contact[*i] == 0.0 && at_rest[*i] == 0.0 && (contact[*i] > 0.0 || area[*i] > 0.0);
        if let Some(i) = (0..contact.len()).find(presses) {
            self.say(
                &path("contact_force"),
                &format!("or the area is above 0 at {i}, which is not in contact"),
            );
        }
        let curve = if self.replicas == 1 {
            self.values(&format!("/ensemble/{way}external_force_mean"))?
        } else if self.place == Place::File && self.has("/replicas/external_force") {
            self.reader.rows(&format!("/replicas/{way}external_force"), 0..1)?
        } else {
            return Ok(());
        };
        let width = self.reader.length(Dimension::Asperity)?.max(1);
        let background = self.background(way, curve.len())?;
        for (forces, place) in external.chunks_exact(width).zip(at) {
            let (own, beside) = (|| forces.iter().filter(|force| !force.is_nan()), background[*place]);
            let sum = own().sum::<f64>() - beside;
            let most = own().map(|force| force.abs()).sum::<f64>() + beside.abs();
            if !((sum - curve[*place]).abs() <= ROUNDING * most) {
                self.say(
                    &path("external_force"),
                    &format!(
                        "adds up to {sum:e} N at separation {place}, and the curve has {:e} N",
                        curve[*place]
                    ),
                );
            }
        }
        Ok(())
    }
}
