//! Loading of an asperity that yields: the contact without adhesion, the adhesive zone around it, and a bridge of liquid around
//! that.
//!
//! # Formula
//! In the units of any [`Scale`] the contact has the radius r = a₀/s_a and the load p = P₀/s_F without adhesion, and its
//! apex the radius ρ ([`super::laws::md_plastic`]). The zone is that of the outline that it leaves ([`super::outline`]) at the
//! contact radius a₀. Adhesion draws the surfaces nearer by (4λ/3) r tan θ.
//!
//! A bridge of liquid draws the surfaces nearer, too. The solids in the liquid then have the interference δ₁ from the first touch of
//! the lowered summit: the interference without adhesion less the displacement by the adhesion of the solids. The bridge is that of
//! a sphere of the radius ρ whose contact under the bridge alone has the interference a₀²/ρ = δ₁, or the gap −δ₁
//! ([`super::laws::capillary`]).
//!
//! # Validity
//! Every λ, r > 0 and p > 0. Source: Maugis, J. Colloid Interface Sci. 150 (1992) 243.

use super::bridge::{Bridge, Wetted};
use super::outline::Pressed;
use super::scale::Scale;
use std::f64::consts::PI;

/// Adhesion and liquid around flattened summits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// λ and the units; λ = 0 without adhesion of the solids.
    pub scale: Scale,
    /// The bridge around the sphere whose radius these units have, if there is liquid.
    pub bridge: Option<Bridge>,
}

impl Around {
    /// The state of a contact without adhesion that is reached `early`, searched for from another state.
    pub fn state(&self, (contact, early): (Pressed, f64), start: &State) -> State {
        let mut state = State { contact, early, zone: contact.zone(start.zone), ..State::default() };
        if let Some(bridge) = &self.bridge {
            let bridge = bridge.of_ratio(contact.apex);
            let inner = self.scale.length * (contact.indentation() - contact.drawn(state.zone));
            state.wet = bridge.around(inner, start.wet.angle);
            state.pull = bridge.pull_around(&state.wet) / self.scale.force;
            state.bent = (inner - state.wet.interference) / self.scale.length;
        }
        state
    }

    /// F_s, N, P, N, and the contact area, m², of a state.
    pub fn forces(&self, state: &State) -> [f64; 3] {
        let Pressed { radius, load, .. } = state.contact;
        let (own, force) = (radius * self.scale.radius, self.scale.force);
        [(state.contact.adhesion(state.zone) + state.pull) * force, load * force, PI * own * own]
    }
}

/// A state of an asperity on loading.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// The contact.
    pub contact: Pressed,
    /// The difference between the interference at which the plastic contact has this contact and the smaller one at which it is
    /// reached.
    pub early: f64,
    /// tan θ of the adhesive zone.
    pub zone: f64,
    /// The contact under the bridge alone, the force of the bridge, and the displacement by which it draws the surfaces
    /// nearer.
    wet: Wetted,
    pull: f64,
    bent: f64,
}

impl State {
    /// The displacement by which adhesion and liquid draw the surfaces nearer.
    pub fn drawn(&self) -> f64 {
        self.contact.drawn(self.zone) + self.bent
    }

    /// The interference at which the plastic contact has this contact, less the displacement of this state.
    pub fn short(&self) -> f64 {
        self.early + self.drawn()
    }

    /// The displacement from first touch of the lowered summit, which recovers elastically.
    pub fn recovery(&self) -> f64 {
        self.contact.indentation() - self.drawn()
    }
}
