//! Whether asperities may be taken as independent, on the terminal.

use super::rows::row;
use crate::format::{percent, si};
use crate::integral::{Independence, IndependenceVerdict};
use crate::scene::Scene;
use crate::substrate::Coupling;

/// A ratio with two significant digits.
pub(super) fn ratio(value: f64) -> String {
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

/// The verdict on a scene with what it means, and the figures behind it: it is of the surface as a patch, which a repeated
/// square is not.
pub(super) fn independence(own: &Independence, scene: &Scene) -> String {
    let shift = ratio(own.relative_shift());
    let place = if own.shift < 0.0 { "at pull-off" } else { "where closest" };
    let verdict = own.verdict();
    let meaning = match verdict {
        IndependenceVerdict::Good => format!("the substrate gives way by {shift} σ {place}{}", range(own)),
        IndependenceVerdict::Shift => format!("forces are at h - F/k_s, {shift} σ off {place}{}", range(own)),
        IndependenceVerdict::Invalid => reason(own),
    };
    let mut figures = format!(
        "attraction {} k_s, fluctuation {} σ",
        ratio(own.relative_attractive_stiffness()),
        ratio(own.relative_fluctuation())
    );
    if own.attractive_stiffness > 0.0 {
        let [longest, side] = [own.longest_stable_wavelength(), own.patch_side].map(|length| si(length, "m"));
        let widest = si(own.patch_side / own.relative_attractive_stiffness(), "m");
        figures += &format!(", patches stable to {widest}, waves to {longest} (side {side})");
    }
    if verdict == IndependenceVerdict::Invalid {
        figures += &format!(", F/k_s {shift} σ {place}");
    }
    let coupling = scene.substrate.as_ref().map(|substrate| substrate.coupling);
    let of = if coupling == Some(Coupling::Periodic) { " for a patch alone" } else { "" };
    row("independence", &format!("{}{of}: {meaning}", verdict.name())) + &row("", &figures)
}

/// Where the shift comes to its limit, and the largest of it when the surfaces are pressed together.
fn range(own: &Independence) -> String {
    let [limit, ..] = Independence::LIMITS;
    let (from, closest) = (own.independent_from / own.surface_height_std, own.relative_closest_shift());
    if from.is_nan() {
        return format!(", above {} σ at every separation", limit.good);
    }
    if closest.abs() <= limit.good && own.verdict() == IndependenceVerdict::Good {
        return format!(", nowhere by more than {} σ", limit.good);
    }
    let pressed = match own.shift < 0.0 && closest.abs() > limit.good {
        true => format!(", {} σ where closest", ratio(closest)),
        false => String::new(),
    };
    format!(", {} σ at h* = {from:.3}{pressed}", limit.good)
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
