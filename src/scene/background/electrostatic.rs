//! A voltage between the mean planes: `[electrostatic]`.

use super::{ForceTable, GivenForce, Setting};
use crate::background::{Electrostatic, MeanPlaneForce};
use crate::format::si;
use crate::scene::error::{SceneError, Together, all};
use crate::scene::keys::Sign::{Any, NotNegative};
use crate::scene::keys::Value::{Number, OneOrMore, Quantity, Table, Various};
use crate::scene::keys::key;
use crate::scene::reader::{Entry, Section};
use crate::scene::units::Dimension as Of;
use crate::scene::warning::{Warning, units};
use std::ops::Bound::{Included, Unbounded};
use std::sync::Arc;
use toml::de::DeValue;

/// Most dielectrics between two electrodes.
const MOST_LAYERS: usize = 20;
/// Largest field across a gap, V/m, that air withstands: 350 V/um across 0.1 to 1 um (Peschot et al., "Deviations from the
/// Paschen's law at short gap distances", 2014).
const LARGEST_FIELD: f64 = 3.5e8;
/// Largest voltage, V, that air withstands across any gap by Paschen's law.
const LARGEST_VOLTAGE: f64 = 327.0;

pub(super) const TABLE: ForceTable = ForceTable {
    name: "electrostatic",
    meaning: "attraction between the mean planes by the voltage",
    keys: &[
        key(
            "electrostatic",
            "{ voltage = \"30 V\", dielectric_thickness = \"100 nm\", relative_permittivity = 3.9 }",
            Table,
        )
        .what("a voltage between the surfaces")
        .about(
            "Its pressure per nominal area, over the gaps of the rough surface, is added to the attraction.",
        )
        .follows("none; no voltage"),
        key("electrostatic.voltage", "\"30 V\"", Quantity(Of::Voltage, Any))
            .what("applied voltage")
            .about("Steady, or the root of the mean square.")
            .swept(),
        key("electrostatic.contact_potential", "\"0.2 V\"", Quantity(Of::Voltage, Any))
            .what("contact potential")
            .about("It is added to `voltage`.")
            .defaults_to("\"0 V\"")
            .swept(),
        key("electrostatic.dielectric_thickness", "\"100 nm\"", OneOrMore(Of::Length, NotNegative, &[]))
            .what("thickness of the dielectric between the electrodes")
            .about(
                "A list for several layers. Without a dielectric the electrodes are bare, and separations \
                 have to be so large that they nowhere touch. Needs `relative_permittivity`.",
            )
            .follows("none; bare electrodes")
            .swept(),
        key(
            "electrostatic.relative_permittivity",
            "3.9",
            Various("a number of at least 1, or a list of them"),
        )
        .what("relative permittivity of the dielectric")
        .about("A list for several layers. Needs `dielectric_thickness`.")
        .follows("none; bare electrodes")
        .swept(),
        key("electrostatic.relative_permittivity[]", "3.9", Number(Included(1.0), Unbounded)),
        key("electrostatic.recess", "\"50 nm\"", Quantity(Of::Length, NotNegative))
            .what("gap that is left between the electrodes where the surfaces touch")
            .about("For electrodes next to the contact, lower than it.")
            .defaults_to("0")
            .swept(),
    ],
    read: |section| electrostatic(section).map(|force| Arc::new(force) as Arc<dyn GivenForce>),
};

impl GivenForce for Electrostatic {
    fn check(&self, section: &Section<'_>, setting: &Setting<'_>) -> Result<(), SceneError> {
        let least = Self::NEAREST_BARE * setting.surface.surface_height_std;
        if self.dielectric == 0.0 && self.voltage != 0.0 && !(setting.range.0 > least) {
            return Err(section.require("voltage")?.wrong(&format!(
                "bare electrodes touch as soon as a gap closes, and then there is no voltage; give \
                 dielectric_thickness and relative_permittivity, or a recess, or separations of more than h* = {}",
                Self::NEAREST_BARE
            )));
        }
        Ok(())
    }

    fn force(&self, _: &Setting<'_>) -> Arc<dyn MeanPlaneForce> {
        Arc::new(*self)
    }

    fn warnings(&self, nearest: f64) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let field = self.field(nearest);
        if field > LARGEST_FIELD {
            let [field, largest] = [field, LARGEST_FIELD].map(|field| si(field, "V/m"));
            warnings.push(Warning::new(
                format!("the field at the closest separation is {field}, more than {largest}"),
                "gaps of 0.1 to 1 um in air break down there, by field emission (Peschot et al. 2014); none of it is \
                 in the model",
                units(&["voltage", "dielectric_thickness", "separation"]),
            ));
        }
        let voltage = self.voltage.abs();
        if voltage > LARGEST_VOLTAGE {
            warnings.push(Warning::new(
                format!("a voltage of {} is above {LARGEST_VOLTAGE} V", si(voltage, "V")),
                "the least that breaks down air, across 7.5 um (Paschen); no discharge is in the model",
                units(&["voltage"]),
            ));
        }
        warnings
    }
}

fn electrostatic(section: &Section<'_>) -> Result<Electrostatic, SceneError> {
    let dielectric = layers(section);
    let readings = (
        section.measured("voltage"),
        section.value("contact_potential").measured(),
        section.value("recess").measured(),
        dielectric,
    );
    let (voltage, contact_potential, recess, dielectric) = readings.together()?;
    Ok(Electrostatic { voltage: voltage + contact_potential, dielectric: dielectric + recess })
}

/// Σt/ε_r of the dielectrics, m.
fn layers(section: &Section<'_>) -> Result<f64, SceneError> {
    let thicknesses = section.optional("dielectric_thickness", |entry| layer(entry, &Entry::measured));
    let permittivities = section.optional("relative_permittivity", |entry| layer(entry, &Entry::bounded));
    let (thicknesses, permittivities) = (thicknesses, permittivities).together()?;
    match (&thicknesses, &permittivities) {
        (None, None) => Ok(0.0),
        (Some(_), None) => Err(section.require("relative_permittivity").err().expect("it is not there")),
        (None, Some(_)) => Err(section.require("dielectric_thickness").err().expect("it is not there")),
        (Some(thicknesses), Some(permittivities)) if thicknesses.len() != permittivities.len() => {
            let entry = section.require("relative_permittivity")?;
            Err(entry.wrong(&format!(
                "has {} values, and dielectric_thickness {}; one for each dielectric is needed",
                permittivities.len(),
                thicknesses.len()
            )))
        }
        (Some(thicknesses), Some(permittivities)) => {
            Ok(thicknesses.iter().zip(permittivities).map(|(thickness, of)| thickness / of).sum())
        }
    }
}

/// A value, or one of each dielectric.
fn layer<'a>(
    entry: &Entry<'a>,
    read: &dyn Fn(&Entry<'a>) -> Result<f64, SceneError>,
) -> Result<Vec<f64>, SceneError> {
    let DeValue::Array(array) = entry.value.get_ref() else { return Ok(vec![read(entry)?]) };
    if !(1..=MOST_LAYERS).contains(&array.len()) {
        return Err(entry.wrong(&format!("has {} values; 1 to {MOST_LAYERS} are needed", array.len())));
    }
    all(array.iter().enumerate().map(|(i, element)| read(&entry.element(i, element))))
}
