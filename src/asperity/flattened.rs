//! The Maugis-Dugdale contact of a known radius and load: the adhesive zone around a flattened top, and a bridge of liquid
//! around that.
//!
//! # Formula
//! In the units of any [`Scale`], with the contact radius r = a/s_a, the load p = P/s_F that the
//! contact would bear without adhesion, and τ = tan θ = √(m² − 1), m = c/a:
//!
//! (λ/2)(p/r) [τ − (1 − τ²)θ] + (4λ²/3) r [1 + τθ − √(1 + τ²)] = 1
//!
//! F̂_s = λ r² (τ + θ(1 + τ²)), and adhesion draws the surfaces nearer by (4λ/3) r τ. These are Maugis' equations with a²/R₁
//! = p/r for a sphere of R₁ = K a³/P: neither R₁ nor its λ has to be known.
//!
//! Under a bridge of liquid, which bends the faces towards each other too, these are the solids in the liquid, whose
//! interference from the first touch of the flattened top, δ₁, is p/r less what they have drawn. The bridge is that of a
//! sphere of R₁ whose contact under the bridge alone has the interference a₀²/R₁ = δ₁, or the gap −δ₁
//! ([`super::laws::capillary`]).
//!
//! # Validity
//! Every λ, r > 0 and p > 0. Source: Maugis, J. Colloid Interface Sci. 150 (1992) 243.

use super::angle::{AngleTerms, angle_terms};
use super::bridge::{Bridge, Wetted};
use super::scale::Scale;
use std::f64::consts::PI;

/// Relative Newton step after which a solve ends: the error that is left is of the order of its square.
const LAST_STEP: f64 = 1e-8;
/// Newton steps at most. From the start they take five.
const MOST_STEPS: usize = 60;

/// A contact of a known radius and load under an adhesive stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flattened {
    /// λ in the units of the contact; 0 without adhesion.
    pub lambda: f64,
    /// Contact radius r.
    pub radius: f64,
    /// Load p without adhesion.
    pub load: f64,
}

impl Flattened {
    /// τ of the adhesive zone, searched for from `start`, or from its limits where that is not positive.
    pub fn zone(&self, start: f64) -> f64 {
        let Self { lambda, radius, load } = *self;
        if lambda == 0.0 {
            return 0.0;
        }
        let (profile, stress) = (0.5 * lambda * load / radius, 4.0 / 3.0 * lambda * lambda * radius);
        let mut tangent = start;
        if !(tangent > 0.0) {
            tangent = libm::cbrt(0.75 / profile).min((2.0 / stress).sqrt());
        }
        for _ in 0..MOST_STEPS {
            // Both brackets are powers of τ at either end, so that steps are taken of logarithms.
            let angle = libm::atan(tangent);
            let AngleTerms { quadratic, linear, .. } = angle_terms(angle);
            let (square, secant) = (tangent * tangent, (1.0 + tangent * tangent).sqrt());
            let first = profile * quadratic * (angle * angle * angle) * (secant * secant);
            let second = stress * linear * (angle * angle) * secant;
            let of_first = 2.0 * profile * tangent * (tangent / (1.0 + square) + angle);
            let of_second = stress * (angle + tangent / (1.0 + square) - tangent / secant);
            let gap = first + second;
            let step = libm::log(gap) * gap / (tangent * (of_first + of_second));
            tangent *= libm::exp(-step);
            if !(step.abs() > LAST_STEP) {
                break;
            }
        }
        tangent
    }

    /// Adhesion force F̂_s of the zone τ.
    pub fn adhesion(&self, zone: f64) -> f64 {
        self.lambda * self.radius * self.radius * (zone + libm::atan(zone) * (1.0 + zone * zone))
    }

    /// The displacement by which adhesion draws the surfaces nearer.
    pub fn drawn(&self, zone: f64) -> f64 {
        4.0 / 3.0 * self.lambda * self.radius * zone
    }
}

/// Adhesion and liquid around flattened tops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// λ and the units; λ = 0 without adhesion of the solids.
    pub scale: Scale,
    /// The bridge around the sphere whose radius these units have, if there is liquid.
    pub bridge: Option<Bridge>,
}

impl Around {
    /// The state of a contact of a load, N, and an area, m².
    pub fn pressed(&self, load: f64, area: f64) -> State {
        let radius = (area / PI).sqrt() / self.scale.radius;
        self.state(radius, load / self.scale.force, &State::default())
    }

    /// The state of a contact of the scaled radius r and load p, searched for from another.
    pub fn state(&self, radius: f64, load: f64, start: &State) -> State {
        let contact = Flattened { lambda: self.scale.lambda, radius, load };
        let mut state = State { contact, zone: contact.zone(start.zone), ..State::default() };
        if let Some(bridge) = &self.bridge {
            let bridge = bridge.of_ratio(radius * radius * radius / load);
            let inner = self.scale.length * (load / radius - contact.drawn(state.zone));
            state.wet = bridge.around(inner, start.wet.angle);
            state.pull = bridge.pull_around(&state.wet) / self.scale.force;
            state.bent = (inner - state.wet.interference) / self.scale.length;
        }
        state
    }

    /// F_s, N, P, N, and the contact area, m², of a state.
    pub fn forces(&self, state: &State) -> [f64; 3] {
        let Flattened { radius, load, .. } = state.contact;
        let (own, force) = (radius * self.scale.radius, self.scale.force);
        [(state.contact.adhesion(state.zone) + state.pull) * force, load * force, PI * own * own]
    }
}

/// A state of an asperity with a flattened top.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// The contact.
    pub contact: Flattened,
    /// τ of the adhesive zone.
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

    /// The displacement from first touch of the flattened top.
    pub fn displacement(&self) -> f64 {
        self.contact.load / self.contact.radius - self.drawn()
    }
}
