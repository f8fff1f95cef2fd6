//! Whether asperities may be taken as independent, on the terminal.

use super::rows::{labelled, paragraph};
use crate::format::{percent, si};
use crate::integral::{Independence, IndependenceVerdict};
use crate::scene::Scene;
use crate::substrate::Coupling;

/// A ratio with two significant digits.
pub(crate) fn ratio(value: f64) -> String {
    let value = value.abs();
    match value {
        value if value == 0.0 || (9.95..9.95e4).contains(&value) => format!("{value:.0}"),
        value if (0.995..9.95).contains(&value) => format!("{value:.1}"),
        value if (0.0095..0.995).contains(&value) => {
            format!("{value:.*}", if value < 0.0995 { 3 } else { 2 })
        }
        value => format!("{value:.1e}"),
    }
}

/// The verdict on a scene with what to do: it is of the surface as a patch, which a repeated square is not.
pub(crate) fn independence(own: &Independence, scene: &Scene) -> String {
    let shift = ratio(own.relative_shift());
    let coupling = scene.substrate.as_ref().map(|substrate| substrate.coupling);
    let advice = match coupling {
        None => "; [substrate] couples asperities",
        Some(_) => "",
    };
    let text = match own.verdict() {
        IndependenceVerdict::Good => format!("good: the substrate is displaced by {shift} σ at pull-off"),
        IndependenceVerdict::Shift => match scene.surface.apex() {
            Some(_) => format!("a shift: the solids are displaced by up to {shift} σ at pull-off{advice}"),
            None => format!("a shift: read forces at h - F/k_s, {shift} σ off at pull-off{advice}"),
        },
        IndependenceVerdict::Invalid => format!("invalid: {}{advice}", reason(own)),
    };
    let of = if coupling == Some(Coupling::Periodic) { " (for a patch alone)" } else { "" };
    labelled("independence", &format!("{text}{of}")) + &of_apex(own)
}

/// The displacement of a body with an apex under its largest load, and its parameters.
fn of_apex(own: &Independence) -> String {
    let Some(mu) = own.greenwood_tripp else { return String::new() };
    let [loaded, mu, theta] = [own.relative_closest_shift(), mu, own.fuller_tabor].map(ratio);
    paragraph(&format!(
        "by {loaded} σ under the largest load; Greenwood and Tripp's mu = {mu}, Fuller and Tabor's theta = {theta}"
    ))
}

/// The figure that is beyond its limit.
fn reason(own: &Independence) -> String {
    let [_, stiffness, fluctuation, share] = Independence::LIMITS;
    if own.relative_attractive_stiffness() >= stiffness.invalid {
        let times = ratio(own.relative_attractive_stiffness());
        let below = si(own.substrate_stiffness, "N/m");
        return format!(
            "attraction is {times} times as stiff as the half-space (k_s = {below}): the patch snaps"
        );
    }
    if own.relative_fluctuation() >= fluctuation.invalid {
        return format!(
            "neighbours displace asperities by {} σ at random",
            ratio(own.relative_fluctuation())
        );
    }
    if own.contact_share >= share.invalid {
        return format!("{} is in contact, and contacts overlap", percent(own.contact_share));
    }
    "the integral is not a number".to_owned()
}
