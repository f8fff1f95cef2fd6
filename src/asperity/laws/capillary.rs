//! An asperity around which a liquid condenses: a bridge of liquid outside of the contact, the solids in the liquid inside.
//!
//! # Formula
//! The liquid pulls with the tension p_c = γ/r_K wherever the gap is below h₀ = s r_K. That is Dugdale's zone, with σ₀ = p_c
//! and the energy γs; so a wet asperity is a Maugis-Dugdale asperity of that energy and stress, in contact and before it
//! (`asperity::bridge`, which has the curvature of the meniscus around the circle too). The bridge bends the surfaces towards
//! each other: within it they are as near as an asperity without bridge at the interference
//!
//! δ₁ = a₀²/R in contact, a₀ the radius of contact under the bridge alone, and δ₁ = −g before it, g the gap in the middle.
//!
//! There the solids act with W_SLS = Δγ − γs (Young and Dupré; Δγ is that of the dry solids): in contact as a
//! Maugis-Dugdale asperity of W_SLS and Z₀ at δ₁, before it as an undeformed sphere at δ₁. F_s is the sum of both, P and
//! the area are those at δ₁. γs is thus not counted twice: a stiff asperity has 2πR(γs + W_SLS) = 2πRΔγ. Where W_SLS is not
//! above 0 the liquid comes between the solids, which are then without adhesion of their own.
//!
//! Liquid condenses only in gaps wider than the range of the attraction of dry solids, Z₀/1.03. For h₀ up to that range γs and p_c
//! are 0, from twice that range on they act fully, and between these a fraction that is linear in h₀ acts. So the limit of dry air
//! is the dry asperity, whichever of Δγ and γs is larger.
//!
//! | regime | interval | F_s | P |
//! |---|---|---|---|
//! | noncontact | no bridge | attraction of an undeformed dry sphere ([`super::idmt`]) | 0 |
//! | bridge | solids apart | bridge, and solids across it | 0 |
//! | elastic | up to the onset | bridge, and solids in it | K a³/R at δ₁ |
//! | elastoplastic1, elastoplastic2, plastic | above | bridge, and solids around the outline of the summit | P(ω) |
//!
//! Above the onset the asperity is at every moment the elastic wet contact of the outline of its flattened summit, with the load
//! P and the contact radius a of a plastic contact without adhesion that is reached at ω, as in [`super::md_plastic`]. With the
//! interference g(a) of the outline without adhesion and the radius ρ of its apex
//!
//! δ₁ = g(a) − 2σ₁ a√(m² − 1)/E_r, a₀ = √(ρδ₁), δ = ω − 2σ₁ a√(m² − 1)/E_r − (π/2)βc sin φ
//!
//! with the stress σ₁ and the zone m of the solids in the liquid around a, and c and φ of the bridge of a sphere of ρ around
//! a₀; where δ₁ < 0 the bridge is around the gap −δ₁. Nothing jumps at the onset. Without W_SLS δ₁ = g(a), without liquid
//! the law is `md_plastic`. It unloads as the elastic wet contact of the outline, which is a wet sphere of ρ once it has detached.
//!
//! Metastable bridges form when the solids touch, at δ = 0, or the films on them, at D = nt, and last until they are
//! unstable; reversible ones form and break where their energy equals that without them. A bridge breaks with
//! the contact where that ends at the fold of its branch (λ above 0.938).
//!
//! Bridges of a constant volume ([`Volume::Constant`]) keep from the end of contact on retraction the liquid
//! that they have there (`asperity::bridge`).
//!
//! # Validity
//! Elastic-plastic spheres of all λ, r_K ≪ R: the force of the bridge is off by the order of (κ/ch₀)². With both γs and
//! W_SLS the superposition is exact where either vanishes, and for stiff spheres; against two nested Dugdale zones it is
//! measured in `tests/suite/capillary.rs`. Sources: Maugis and Gauthier-Manuel, J. Adhes. Sci. Technol. 8 (1994) 1311;
//! mapping derived from Maugis (1992) with the Kelvin and Young-Dupré equations.

use super::idmt::across;
use super::md::MaugisContact;
use super::md_plastic::{PlasticContact, PlasticLoading, contact_rows, plastic_loading};
use crate::asperity::block::{BLOCK, Responses};
use crate::asperity::bridge::{Bridge, Closed, Last};
use crate::asperity::elastic::{self, Elastic};
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Constant, Formula};
use crate::asperity::history::Path;
use crate::asperity::lane::{Lane, Lanes, Numbered};
use crate::asperity::law::{End, Law, Method, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::loading::Around;
use crate::asperity::outline::{self, OutlinedSummit};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Place, Similarity};
use crate::asperity::scale::{LAMBDA_RANGE, STRESS_RATIO, Scale};
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Row, Table};
use crate::liquid::{Bridges, Meniscus, Volume};
use crate::math::piecewise::Piecewise;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// The law `capillary`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved, or as the plastic contact.
pub fn capillary(
    parameters: &LawParameters,
    meniscus: &Meniscus,
    contact: PlasticContact,
) -> Result<Box<dyn Law>, LawError> {
    Parts::new(parameters, meniscus)?.law(parameters, contact)
}

/// The law of the solids in the liquid, which is under no tension.
///
/// # Errors
/// As [`capillary`].
pub fn immersed(
    parameters: &LawParameters,
    meniscus: &Meniscus,
    contact: PlasticContact,
) -> Result<Box<dyn Law>, LawError> {
    Parts::immersed(parameters, meniscus)?.law(parameters, contact)
}

/// The liquid in bridges, V (m³) in the place of F_s: πR((h₀ − nt)² − (D − nt)²), that around rigid spheres.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn content(parameters: &LawParameters, meniscus: &Meniscus) -> Result<Box<dyn Law>, LawError> {
    let parts = Parts::new(parameters, meniscus)?;
    let typical = Lane::new(1.0, parts.lambda());
    let films = -meniscus.film_height();
    let begin = move |lane: &Lane| parts.ends(lane)[0];
    let full = move |lane: &Lane| begin(lane).max(films);
    let (meniscus, radius) = (*meniscus, parameters.scale.asperity_radius());
    let volume = move |delta: f64| PI * radius * meniscus.content(-delta);
    let volume = || ClosedForm::attraction(volume.following(OF_SPHERE));
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, Place::following(begin(&typical), begin), Constant::NOTHING),
        Row::below(Regime::Bridge, Place::following(full(&typical), full), volume()),
        Row::last(Regime::Elastic, volume()),
    ])))
}

/// Relative accuracy of the angles from which solves of contacts start.
const STARTS: f64 = 1e-8;

/// A force at δ that is proportional to the radius.
const OF_SPHERE: Similarity = Similarity::new(0.0, 1.0);

/// A wet asperity: its bridge, and its solids in the liquid.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    bridge: Bridge,
    /// K, Pa.
    stiffness: f64,
    /// Scale of the energy W_SLS; none where that is not above 0.
    solid: Option<Scale>,
    path: Path,
    bridges: Bridges,
    volume: Volume,
    /// The mean of both contact angles, rad.
    contact_angle: f64,
    /// n t of the films on the surfaces, m.
    films: f64,
}

impl Parts {
    /// The parts of an asperity whose dry solids are `parameters`.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved.
    pub fn new(parameters: &LawParameters, meniscus: &Meniscus) -> Result<Self, LawError> {
        let dry = parameters.scale;
        let work = dry.work_of_adhesion();
        let range = dry.equilibrium_spacing() / STRESS_RATIO;
        let share = meniscus.solid_energy(work, range) / work;
        // W_SLS of so small a λ is nothing next to γs.
        let is_some = share > 0.0 && dry.lambda * libm::pow(share, 2.0 / 3.0) >= LAMBDA_RANGE.0;
        let solid = is_some.then(|| dry.with_energy(share, range));
        let stress = meniscus.pressure() * meniscus.share_beyond(range);
        Ok(Self {
            bridge: Bridge {
                radius: dry.asperity_radius(),
                range: meniscus.range(),
                stress,
                compliance: 16.0 * stress / (3.0 * PI * dry.stiffness()),
                curvature: meniscus.turn() * meniscus.kelvin_radius * meniscus.kelvin_radius,
            },
            stiffness: dry.stiffness(),
            solid: solid.transpose()?,
            path: parameters.path,
            bridges: meniscus.bridges,
            volume: meniscus.volume,
            contact_angle: 0.5 * (meniscus.contact_angles[0] + meniscus.contact_angles[1]),
            films: meniscus.film_height(),
        })
    }

    /// The solids of an asperity in the liquid, which is under no tension.
    ///
    /// # Errors
    /// As [`Parts::new`].
    pub fn immersed(parameters: &LawParameters, meniscus: &Meniscus) -> Result<Self, LawError> {
        let parts = Self::new(parameters, meniscus)?;
        Ok(Self { bridge: Bridge { stress: 0.0, compliance: 0.0, ..parts.bridge }, ..parts })
    }

    /// The plastic loading of wet asperities.
    ///
    /// # Errors
    /// As [`capillary`].
    pub(in crate::asperity) fn plastic_loading(
        self,
        parameters: &LawParameters,
        contact: PlasticContact,
    ) -> Result<Arc<PlasticLoading>, LawError> {
        plastic_loading((parameters, contact), self.around(&parameters.scale), &self.boundaries()[1])
    }

    /// Where bridges form or break, and where contact begins or ends.
    fn boundaries(self) -> [Place; 2] {
        let typical = Lane::new(1.0, self.lambda());
        [0, 1].map(|end| {
            let of = move |lane: &Lane| self.ends(lane)[end];
            Place::following(of(&typical), of)
        })
    }

    /// Adhesion and liquid around flattened summits, whose dry solids have the units `dry`.
    fn around(&self, dry: &Scale) -> Around {
        let scale = self.solid.unwrap_or(Scale { lambda: 0.0, ..*dry });
        Around { scale, bridge: Some(self.bridge).filter(|bridge| bridge.stress > 0.0) }
    }

    /// The law of the asperity with a plastic contact.
    fn law(self, parameters: &LawParameters, contact: PlasticContact) -> Result<Box<dyn Law>, LawError> {
        let dry = across(&parameters.scale);
        let attraction = ClosedForm::attraction((move |delta: f64| dry(-delta)).following(OF_SPHERE));
        let typical = Lane::new(1.0, self.lambda());
        let [begin, touch] = self.boundaries();
        let elastic = WetContact::new(self, parameters)?;
        let contact = if parameters.critical_interference.is_finite() {
            contact_rows((parameters, contact), self.around(&parameters.scale), touch.clone(), elastic)?
        } else {
            vec![Row::last(Regime::Elastic, elastic)]
        };
        let before = [
            Row::below(Regime::Noncontact, begin, attraction),
            Row::below(Regime::Bridge, touch, Spanned { parts: self, typical }),
        ];
        Ok(Box::new(Table::new(before.into_iter().chain(contact))))
    }

    /// λ of the solids in the liquid, which the lanes solve.
    fn lambda(&self) -> Option<f64> {
        self.solid.map(|scale| scale.lambda)
    }

    /// The solids of an asperity in the liquid, and s_δ, m.
    fn elastic<'a>(&self, lane: &'a Lane) -> Option<(&'a Elastic, f64)> {
        self.solid.map(|scale| (&lane.elastic, scale.length * lane.cube_root))
    }

    /// δ, m, from which there is a bridge, and from which the solids touch.
    fn ends(&self, lane: &Lane) -> [f64; 2] {
        let bridge = self.bridge.of_ratio(lane.ratio);
        // Under the bridge alone.
        let [touch, fold] = [-bridge.at_gap(0.0).distance, bridge.last_contact().interference];
        let solids = self.elastic(lane).map(|(solid, length)| solid.end(self.path) * length);
        let touches = solids.map(|end| bridge.at_gap(-end));
        match (self.path, self.bridges) {
            (Path::Approach, Bridges::Metastable) if self.films == 0.0 => [0.0; 2],
            (Path::Approach, bridges) => {
                let forms = match bridges {
                    Bridges::Metastable => bridge.at_distance(self.films.min(bridge.rupture().distance)),
                    Bridges::Reversible => bridge.equilibrium(),
                };
                let begin = -forms.distance;
                // Where contact is nearer than where it forms, it begins at once.
                let touches = touches.unwrap_or_else(|| bridge.at_gap(0.0));
                [begin, if touches.circle > forms.circle { begin.max(-touches.distance) } else { begin }]
            }
            (Path::Retraction, _) if fold < touch => [fold; 2],
            (Path::Retraction, _) if self.volume == Volume::Constant => {
                let (closed, contact) = self.closed(lane);
                [-contact.max(closed.rupture(self.contact_angle)), -contact]
            }
            (Path::Retraction, bridges) => {
                let rupture = bridge.rupture();
                let contact = match (solids, touches) {
                    (_, Some(end)) if end.circle > rupture.circle => -end.distance,
                    // Solids that adhere for longer than a bridge keep it.
                    (Some(solids), _) if bridge.at_gap(0.0).circle > rupture.circle => {
                        solids.min(-rupture.distance)
                    }
                    _ => touch,
                };
                let breaks = match bridges {
                    Bridges::Metastable => rupture,
                    Bridges::Reversible => bridge.equilibrium(),
                };
                let contact = contact.min(touch);
                [contact.min(-breaks.distance), contact]
            }
        }
    }

    /// The bridge that keeps the liquid which it has at the end of contact, and D there, m.
    fn closed(&self, lane: &Lane) -> (Closed, f64) {
        let bridge = self.bridge.of_ratio(lane.ratio);
        let solid = self.elastic(lane).map_or(0.0, |(solid, length)| -solid.end(Path::Retraction) * length);
        let edge = bridge.at_gap(solid);
        // Beyond the fold there is no state in equilibrium whose liquid could be kept.
        let edge = if edge.circle > bridge.spinodal().circle { edge } else { bridge.spinodal() };
        (Closed::new(bridge, edge), edge.distance)
    }

    /// δ from which an asperity on approach has what it keeps on retraction: a bridge, or what it begins with.
    fn capture(&self, lane: &Lane) -> Option<f64> {
        let is_kept = self.path == Path::Approach && self.bridges == Bridges::Metastable;
        is_kept.then(|| self.ends(lane)[0])
    }

    /// Whether bridges keep their liquid.
    fn is_closed(&self) -> bool {
        self.path == Path::Retraction && self.volume == Volume::Constant
    }

    /// The smoothness of a bridge before contact, which folds at its end or beyond.
    fn spanned(&self, ratio: f64) -> Smoothness {
        if self.is_closed() {
            return Smoothness::Smooth;
        }
        Smoothness::Root {
            end: End::Lower,
            place: -self.bridge.of_ratio(ratio).spinodal().distance,
            order: 2,
        }
    }
}

/// A bridge between solids that do not touch.
#[derive(Clone, Copy)]
struct Spanned {
    parts: Parts,
    /// The asperity of ρ = 1.
    typical: Lane,
}

impl Spanned {
    /// F_s of an asperity at δ, m, N; `closed` is its bridge if that keeps its liquid.
    fn force(&self, ratio: f64, closed: Option<&Closed>, delta: f64) -> f64 {
        let Parts { bridge, solid, .. } = self.parts;
        let (pull, gap) = match closed {
            Some(closed) => closed.pull(-delta),
            None => bridge.of_ratio(ratio).pull(-delta),
        };
        pull + solid.map_or(0.0, |solid| ratio * across(&solid)(gap.max(0.0)))
    }

    /// The bridge of an asperity if it keeps its liquid.
    fn closed(&self, lane: &Lane) -> Option<Closed> {
        self.parts.is_closed().then(|| self.parts.closed(lane).0)
    }
}

impl Law for Spanned {
    fn radius_dependence(&self) -> RadiusDependence {
        self.parts.lambda().map_or(RadiusDependence::Formulas, RadiusDependence::Elastic)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        Piece::cut(within, [], [self.parts.spanned(lane.map_or(1.0, |lane| lane.ratio))])
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        self.parts.capture(lane.unwrap_or(&self.typical))
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, _: &mut SolverStats) {
        let count = at.len();
        let forces = out.adhesion.iter_mut().zip(at);
        match lanes {
            Lanes::Own => {
                let closed = self.closed(&self.typical);
                forces.for_each(|(force, delta)| *force = self.force(1.0, closed.as_ref(), *delta));
            }
            Lanes::Each(lanes) => {
                for (i, (force, delta)) in forces.enumerate() {
                    let lane = lanes.at(i);
                    *force = self.force(lane.ratio, self.closed(lane).as_ref(), *delta);
                }
            }
        }
        out.contact[..count].fill(0.0);
        out.area[..count].fill(0.0);
    }
}

/// Elastic contact of solids in the liquid, within a bridge.
struct WetContact {
    parts: Parts,
    /// The end of contact under the bridge alone of the asperity of ρ = 1.
    last: Last,
    /// Angles of that contact over the root of δ beyond its end, m, from which solves start.
    starts: Piecewise,
    /// The contact of the solids in the liquid.
    solid: Option<MaugisContact>,
    /// The units of the dry solids.
    dry: Scale,
}

impl WetContact {
    fn new(parts: Parts, parameters: &LawParameters) -> Result<Self, LawError> {
        let contact = |scale| {
            let parameters = LawParameters { scale, path: Path::Retraction, ..*parameters };
            MaugisContact::new(&parameters, parameters.critical_interference)
        };
        let (bridge, last) = (parts.bridge, parts.bridge.last_contact());
        let deepest = parameters.deepest(parameters.critical_interference).unwrap_or(f64::NEG_INFINITY);
        let deepest = deepest * parameters.scale.length - last.interference;
        let angle = |root: f64| bridge.contact(last.interference + root * root, &last, None).angle;
        let starts = Piecewise::new(angle, |_, angle| STARTS * angle, 0.0, deepest.max(0.0).sqrt());
        let solid = parts.solid.map(contact).transpose()?;
        Ok(Self { last, starts, solid, dry: parameters.scale, parts })
    }

    /// Contacts begin, and folds of them, are roots; the contact under the bridge alone, which ends at `end`, may begin
    /// after that of the solids.
    fn pieces_in(end: f64, within: Range<f64>) -> Vec<Piece> {
        let Range { start: lower, end: upper } = within;
        let root = |place| Smoothness::Root { end: End::Lower, place, order: 2 };
        // Where both begin at once the two places are one but for rounding.
        if lower < end - 1e-14 * end.abs() && end < upper {
            Piece::cut(within, [end], [root(lower), root(end)])
        } else {
            Piece::cut(within, [], [root(end)])
        }
    }

    /// Responses under bridges alone, and δ₁, of asperities by their ρ, with the ends of their contacts.
    fn bridges(
        &self,
        of: impl Fn(usize) -> (f64, Last),
        start: impl Fn(usize) -> Option<f64>,
        interference: &[f64],
        out: &mut Responses,
    ) -> [f64; BLOCK] {
        let mut inner = [0.0; BLOCK];
        for (i, &delta) in interference.iter().enumerate() {
            let (ratio, last) = of(i);
            let bridge = self.parts.bridge.of_ratio(ratio);
            if bridge.stress == 0.0 {
                // A liquid without tension bends nothing.
                let radius = (bridge.radius * delta.max(0.0)).sqrt();
                inner[i] = delta;
                out.adhesion[i] = 0.0;
                out.contact[i] = self.parts.stiffness * delta.max(0.0) * radius;
                out.area[i] = PI * radius * radius;
            } else if delta >= last.interference {
                let state = bridge.contact(delta, &last, start(i));
                let square = state.contact * state.contact;
                inner[i] = square / bridge.radius;
                out.adhesion[i] = bridge.pull_around(&state);
                out.contact[i] = self.parts.stiffness * inner[i] * state.contact;
                out.area[i] = PI * square;
            } else {
                let (pull, gap) = bridge.pull(-delta);
                (out.adhesion[i], out.contact[i], out.area[i]) = (pull, 0.0, 0.0);
                inner[i] = -gap;
            }
        }
        inner
    }

    /// Responses under bridges alone, and δ₁, of a block of asperities at interferences δ, m.
    fn bent(&self, lanes: Lanes<'_>, interference: &[f64], out: &mut Responses) -> [f64; BLOCK] {
        let count = interference.len();
        match lanes {
            Lanes::Own => {
                let (mut starts, mut roots) = ([f64::NAN; BLOCK], [0.0; BLOCK]);
                for (root, delta) in roots.iter_mut().zip(interference) {
                    *root = (delta - self.last.interference).max(0.0).sqrt();
                }
                self.starts.values(&roots[..count], &mut starts[..count]);
                let start = |i: usize| Some(starts[i]).filter(|start| *start > 0.0);
                self.bridges(|_| (1.0, self.last), start, interference, out)
            }
            Lanes::Each(lanes) => {
                let of = |i: usize| {
                    let ratio = lanes.at(i).ratio;
                    (ratio, self.parts.bridge.of_ratio(ratio).last_contact())
                };
                self.bridges(of, |_| None, interference, out)
            }
        }
    }

    /// The contacts at δ₁, m, of summits without adhesion of their own.
    fn bare(&self, lanes: Numbered<'_>, inner: &[f64], out: &mut Responses) {
        for (i, inner) in inner.iter().enumerate() {
            let (lane, outline) = (lanes.at(i), &lanes.summit(i).outline);
            let length = self.dry.length * lane.cube_root;
            let radius = outline.radius_at((inner / length).max(0.0));
            let own = self.dry.radius * (lane.cube_root * lane.cube_root) * radius;
            out.contact[i] = self.dry.force * lane.ratio * outline.load(radius);
            out.area[i] = PI * own * own;
        }
    }

    /// Adds what the solids do.
    fn add(out: &mut Responses, solid: &Responses, count: usize) {
        for i in 0..count {
            out.adhesion[i] += solid.adhesion[i];
        }
        out.contact[..count].copy_from_slice(&solid.contact[..count]);
        out.area[..count].copy_from_slice(&solid.area[..count]);
    }
}

impl Law for WetContact {
    fn radius_dependence(&self) -> RadiusDependence {
        self.parts.lambda().map_or(RadiusDependence::Formulas, RadiusDependence::Elastic)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let own = |lane: &Lane| self.parts.bridge.of_ratio(lane.ratio).last_contact();
        Self::pieces_in(lane.map_or(self.last, own).interference, within)
    }

    fn kinks_of_summit(&self, _: usize, lane: &Lane, summit: &OutlinedSummit) -> Vec<f64> {
        let bridge = self.parts.bridge.of_ratio(lane.ratio);
        let of_bridge = bridge.last_contact().interference;
        let of_solid = self.parts.solid.map(|scale| summit.ends.edge * (scale.length * lane.cube_root));
        let edge = of_solid.filter(|edge| edge.is_finite());
        vec![of_bridge, edge.map_or(f64::NAN, |edge| bridge.around(edge, 0.0).interference)]
    }

    fn method(&self, _: usize) -> Method {
        Method::Contact
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let (count, mut inner) = (at.len(), self.bent(lanes, at, out));
        let (Some(contact), Some(scale)) = (&self.solid, self.parts.solid) else {
            if let Lanes::Each(each) = lanes
                && each.have_summits()
            {
                self.bare(each, &inner[..count], out);
            }
            return;
        };
        let mut solid = Responses::default();
        match lanes {
            Lanes::Own => contact.evaluate(0, lanes, &inner[..count], &mut solid, stats),
            Lanes::Each(each) => {
                for (i, inner) in inner[..count].iter_mut().enumerate() {
                    *inner /= scale.length * each.at(i).cube_root;
                }
                let (mut radius, adhesion) = ([0.0; BLOCK], &mut solid.adhesion);
                if each.have_summits() {
                    outline::contacts(|i| each.summit(i), &inner[..count], adhesion, &mut radius, stats);
                } else {
                    elastic::contact(|i| &each.at(i).elastic, &inner[..count], adhesion, &mut radius, stats);
                }
                lanes.scale_contacts(&scale, &radius[..count], &mut solid);
            }
        }
        Self::add(out, &solid, count);
    }
}
