//! Whether the asperities may be taken as independent.

use super::{Dataset, Results, path};
use crate::error::OutputError;
use crate::integral::Independence;
use crate::output::reader::Reader;
use crate::output::writer::Writer;

const GROUP: &str = "/independence";

/// Makes the group, and writes the limits of the figures.
pub(crate) fn write_limits(writer: &Writer<'_>) -> Result<(), OutputError> {
    writer.group("independence")?;
    for limit in Independence::LIMITS {
        writer.number(GROUP, &format!("good_{}", limit.name), limit.good)?;
        if limit.invalid.is_finite() {
            writer.number(GROUP, &format!("invalid_{}", limit.name), limit.invalid)?;
        }
    }
    Ok(())
}

/// Reads the figures of a run back.
pub(crate) fn read_independence(reader: &Reader) -> Result<Independence, OutputError> {
    let figure = |name: &str| reader.values::<f64>(&format!("{GROUP}/{name}")).map(|values| values[0]);
    Ok(Independence {
        surface_height_std: reader.number("/", "surface_height_std")?,
        patch_side: figure("patch_side")?,
        substrate_stiffness: figure("substrate_stiffness")?,
        shift: figure("shift")?,
        attractive_stiffness: figure("attractive_stiffness")?,
        fluctuation: figure("fluctuation")?,
        contact_share: figure("contact_share")?,
        closest_shift: figure("closest_shift")?,
        independent_from: figure("independent_from")?,
        greenwood_tripp: Some(figure("greenwood_tripp_mu")?).filter(|mu| !mu.is_nan()),
        fuller_tabor: figure("fuller_tabor_theta")?,
    })
}

/// The figures by which independence is judged.
pub(super) fn datasets() -> Vec<Dataset> {
    vec![
        figure(
            "patch_side",
            "m",
            "side L of the patch, the root of the nominal area, or of the area that is loaded under a body",
            |own| own.patch_side,
        ),
        figure(
            "substrate_stiffness",
            "N m-1",
            "stiffness k_s = E* L/0.9464 of the half-space under the patch",
            |own| own.substrate_stiffness,
        ),
        figure(
            "shift",
            "m",
            "shift of the separation at pull-off of the integral, or at the smallest separation where nothing pulls: F/k_s, and under a \
         body of radius R_m the displacement (9F^2/16 R_m E*^2)^(1/3) of Hertz, with the sign of F",
            |own| own.shift,
        ),
        figure(
            "relative_shift",
            "1",
            "that shift over the standard deviation of the surface heights",
            Independence::relative_shift,
        ),
        figure(
            "attractive_stiffness",
            "N m-1",
            "largest derivative of the integral's external force by the separation, 0 where it nowhere rises",
            |own| own.attractive_stiffness,
        ),
        figure(
            "relative_attractive_stiffness",
            "1",
            "that stiffness over the one of the half-space",
            Independence::relative_attractive_stiffness,
        ),
        figure(
            "fluctuation",
            "m",
            "standard deviation of the displacements by neighbours at random places, at the separation of the shift",
            |own| own.fluctuation,
        ),
        figure(
            "relative_fluctuation",
            "1",
            "that fluctuation over the standard deviation of the surface heights",
            Independence::relative_fluctuation,
        ),
        figure(
            "longest_stable_wavelength",
            "m",
            "wavelength up to which the surfaces are stable where they attract most stiffly, infinite without attraction",
            Independence::longest_stable_wavelength,
        ),
        figure(
            "contact_share",
            "1",
            "share of the area of the patch in contact, at the separation of the shift",
            |own| own.contact_share,
        ),
        figure(
            "closest_shift",
            "m",
            "shift under the largest preload, or at the smallest separation",
            |own| own.closest_shift,
        ),
        figure(
            "relative_closest_shift",
            "1",
            "that shift over the standard deviation of the surface heights",
            Independence::relative_closest_shift,
        ),
        figure(
            "independent_from",
            "m",
            "separation h from which on the shift is within its limit, NaN where it is not at the largest one",
            |own| own.independent_from,
        ),
        figure(
            "greenwood_tripp_mu",
            "1",
            "mu = (8/3) eta sigma_s sqrt(2 R_m R) of Greenwood and Tripp, NaN where no body has an apex of radius R_m",
            |own| own.greenwood_tripp.unwrap_or(f64::NAN),
        ),
        figure(
            "fuller_tabor_theta",
            "1",
            "theta = E* sigma_s^(3/2)/(sqrt(R) work_of_adhesion) of Fuller and Tabor",
            |own| own.fuller_tabor,
        ),
    ]
}

fn figure(
    name: &str,
    units: &'static str,
    meaning: &str,
    of: impl Fn(&Independence) -> f64 + Send + Sync + 'static,
) -> Dataset {
    Dataset::new(path(GROUP, name), &[], units, meaning, move |results: &Results| {
        Some(of(&results.independence))
    })
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    write_limits(writer)?;
    writer.text(GROUP, "verdict", results.independence.verdict().name())
}
