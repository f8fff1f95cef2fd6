//! Bridges of liquid at the pull-off of a run, and the regime of a wet surface.

use super::results::Results;
use crate::asperity::Quantity;
use crate::integral::Wet;
use crate::liquid::COVERS;

/// The share of the nominal area from which on what lies between the surfaces is flooded.
const FLOODED: f64 = 0.9;

/// The regime of a wet surface by the share of the nominal area that bridges cover (Matthewson and Mamin 1988).
pub(crate) fn regime(covered: f64) -> &'static str {
    match covered {
        0.0 => "dry",
        covered if covered <= COVERS.1 => "toe-dipping: bridges are apart",
        covered if covered < FLOODED => "pillbox: bridges merge",
        _ => "flooded",
    }
}

/// The integral where the surfaces are pulled off.
pub(crate) fn at_pull_off(results: &Results) -> Wet {
    let at = &results.at_pull_off;
    let area = at.expected[Quantity::ContactArea.index()][0];
    Wet::new(area, &at.regime_count, &at.regime_adhesion_force, 0)
}
