//! One asperity that is brought close and pulled back: each with its own history.
//!
//! # Formula
//! When the surfaces turn, an asperity has the interference ω_max; at a distance s ≥ 0 from there it has δ =
//! ω_max − s, and what it does is a function of ω_max and s alone. So all asperities of a surface at one
//! distance obey one law in the variable ω_max, [`Loop::at`]:
//!
//! | ω_max | what acts |
//! |---|---|
//! | below first touch | the law on approach at δ: nothing has been touched, so retraction retraces the approach |
//! | up to ω_c, or any of a law that knows no flow | the law on retraction at δ: contact lasts to the end of its stable branch |
//! | above ω_c | the unloading of an elastic-plastic contact, below |
//!
//! After plastic flow the asperity is lower by its residual interference ω_res, and springs back by ω_max −
//! ω_res only. With x = ω_max/ω_c (Etsion, Kligerman and Kadin 2005)
//!
//! ω_res/ω_max = (1 − x^−0.28)(1 − x^−0.69), P/P_max = r^(1.5 x^−0.0331), A/A_max = r^(x^−0.12), r = (δ −
//! ω_res)/(ω_max − ω_res),
//!
//! with P_max and A_max of the law on approach at ω_max. At x = 1 that is Hertz's contact.
//!
//! # Adhesion
//! The unloading is published without adhesion. What attracts acts outside the contact, across the gap beside
//! it, and the shape of that gap is what plastic flow has left behind: it does not heal. So F_s keeps its
//! value at ω_max for as long as there is contact, as in the DMT limit, for which the elastic-plastic
//! adhesion was computed. Contact lasts, without load, to the place where that of an elastic asperity would
//! end, counted from the lowered top: to δ − ω_res = −δ_A on retraction. From there on the asperity is one
//! whose top is lower by ω_res: lubricant and attraction across the gap at δ − ω_res.
//!
//! # Radius
//! What flowed is flatter. How much is not published with the unloading, and it decides what attracts from
//! then on, so it is a choice, [`UnloadedRadius`]: the top keeps R, or it has the R′ = 4E_r a³/(3P) of the
//! elastic contact whose radius and load are those at ω_max ([`super::flattened`]). With R′ the attraction
//! before contact, the lubricant's force and δ_A are those of R′.
//!
//! # Validity
//! One cycle from a fresh surface. The unloading was computed for loads up to the limits of the
//! elastic-plastic fits; in the fully plastic regime it is used beyond them, without adhesion, as there is
//! none on approach. Its ω_c is taken to be that of the law. Where the attraction across the gap has two
//! states, both ways take the outer one, as the laws do. Source: Etsion, Kligerman and Kadin, Int. J. Solids
//! Struct. 42 (2005) 3716.

use super::error::LawError;
use super::history::Path;
use super::law::{BLOCK, Boundary, End, Flattened, Law, Piece, Regime, Responses, Smoothness};
use super::models::{MODELS, Model, Plasticity};
use super::parameters::LawParameters;
use super::scale::Scale;
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::Piecewise;
use crate::math::roots::{Sample, safe_newton};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Exponents of x in ω_max − ω_res = ω_c (x^0.72 + x^0.31 − x^0.03), and their signs.
const RECOVERY: [(f64, f64); 3] = [(0.72, 1.0), (0.31, 1.0), (0.03, -1.0)];
/// Exponent of the load over r at x = 1, and that of x in it.
const LOAD: (f64, f64) = (1.5, -0.0331);
/// Exponent of x in the exponent of the area over r.
const AREA: f64 = -0.12;
/// The powers of r are no power series in any root of it; in the tenth what is left is too smooth to matter.
const ORDER: i32 = 10;
/// Nanoseconds that unloading takes beside the law, the lowered top alone, and one of a radius of its own.
const COSTS: (f64, f64, f64) = (60.0, 5.0, 400.0);
/// Parts of a regime of lowered tops of which each is looked at for a place where their attraction is not
/// smooth.
const KINK_PARTS: usize = 64;
/// Relative accuracy of tables: a few roundings, as those of a library's exponentials.
const TABLE_TOLERANCE: f64 = 2e-15;

/// The radius of a top that has flowed, once its contact has ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnloadedRadius {
    /// As it was.
    #[default]
    Kept,
    /// 4E_r a³/(3P) of the largest load, the radius whose elastic contact that was.
    Elastic,
}

impl UnloadedRadius {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] = [("kept", Self::Kept), ("elastic", Self::Elastic)];

    /// Its name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, radius)| *radius == self).expect("every radius is in ALL").0
    }

    /// The other of the two.
    pub fn other(self) -> Self {
        match self {
            Self::Kept => Self::Elastic,
            Self::Elastic => Self::Kept,
        }
    }
}

/// The laws of one asperity on approach and on retraction.
pub struct Loop {
    approach: Box<dyn Law>,
    retraction: Box<dyn Law>,
    /// ω_c, m.
    critical: f64,
    /// Interference, m, from which retraction does not retrace the approach.
    capture: f64,
    /// Index of the first regime of contact, and of the first above ω_c.
    first_contact: usize,
    first_plastic: usize,
    /// (ω_max − ω_res)/ω_c and the exponents of r in load and area, over x.
    recovery: OfDepth,
    load_exponent: OfDepth,
    area_exponent: OfDepth,
    /// Attraction of tops that have flowed, where they have radii of their own.
    flattened: Option<Box<dyn Flattened>>,
    scale: Scale,
}

impl Loop {
    /// The loop of the law of a model for a setting, whatever its path.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made, [`LawError::NoUnloading`] when it flows otherwise than the
    /// contact that the unloading was computed for, [`LawError::NotFlattened`] when it is a fit to one radius
    /// and flows, and tops that have flowed are to have radii of their own.
    pub fn new(model: &Model, parameters: &LawParameters, radius: UnloadedRadius) -> Result<Self, LawError> {
        if !unloads(model) {
            return Err(LawError::NoUnloading { law: model.name, others: &UNLOADING });
        }
        let [approach, retraction] =
            [Path::Approach, Path::Retraction].map(|path| model.law(&LawParameters { path, ..*parameters }));
        let (approach, retraction) = (approach?, retraction?);
        let regimes = approach.regimes();
        let first = |is: fn(&Regime) -> bool| regimes.iter().position(is).unwrap_or(regimes.len());
        let (first_contact, first_plastic) =
            (first(|regime| regime.is_contact()), first(|regime| is_plastic(*regime)));
        let touch = begin_of(approach.as_ref(), first_contact);
        let capture = approach.capture().map_or(touch, |capture| capture.min(touch));
        let flattened = match radius {
            UnloadedRadius::Elastic if first_plastic < regimes.len() => {
                Some(retraction.flattened().ok_or(LawError::NotFlattened)?)
            }
            _ => None,
        };
        let critical = parameters.critical_interference;
        let deepest = parameters.reach.map_or(1.0, |(_, deepest)| deepest / critical);
        Ok(Self {
            critical,
            approach,
            retraction,
            capture,
            first_contact,
            first_plastic,
            recovery: OfDepth::new(scaled_recovery, deepest),
            load_exponent: OfDepth::new(|x| LOAD.0 * power(x, LOAD.1), deepest),
            area_exponent: OfDepth::new(|x| power(x, AREA), deepest),
            flattened,
            scale: parameters.scale,
        })
    }

    /// The law on approach.
    pub fn approach(&self) -> &dyn Law {
        self.approach.as_ref()
    }

    /// Whether the law knows plastic flow.
    pub fn flows(&self) -> bool {
        self.first_plastic < self.approach.regimes().len()
    }

    /// The law on retraction, of an asperity that has not flowed.
    pub fn retraction(&self) -> &dyn Law {
        self.retraction.as_ref()
    }

    /// What has become of an asperity of the interference ω_max, m: 0 of one that has never touched, 1 of one
    /// that has, 2 of one that has flowed.
    pub fn fate(&self, largest: f64) -> usize {
        if largest < self.capture {
            0
        } else if self.flows() && largest > self.top() {
            2
        } else {
            1
        }
    }

    /// Interferences, m, rising, at which the force on retraction is not smooth, by [`Loop::fate`]: counted
    /// from the top that the asperity has then, so they are passed at the distance [`Loop::recovery`] less
    /// them.
    pub fn kinks(&self) -> [Vec<f64>; 3] {
        let ends = |law: &dyn Law, regimes: usize| {
            let mut ends: Vec<f64> =
                law.pieces().iter().filter(|piece| piece.regime < regimes).map(|piece| piece.upper).collect();
            ends.retain(|end| end.is_finite());
            ends
        };
        let untouched =
            ends(self.approach(), self.first_contact).into_iter().filter(|end| *end <= self.capture);
        let elastic = ends(self.retraction(), self.first_plastic);
        // The load ends where it has sprung back.
        let flowed = ends(self.retraction(), self.first_contact).into_iter().chain([0.0]);
        [untouched.collect(), elastic, flowed.collect()]
    }

    /// The same of a top that has a radius of its own since it flowed, at the interference ω_max, m: where
    /// its attraction jumps, if it does (else NaN), where contact ends, and where its load ends. None where R
    /// is kept.
    pub fn flattened_kinks(&self, largest: f64) -> Option<[f64; 3]> {
        let flattened = self.flattened.as_ref()?;
        let ratio = self.radius_ratio(largest);
        Some([flattened.kink(ratio).unwrap_or(f64::NAN), flattened.release(ratio), 0.0])
    }

    /// Interference of first touch on approach, m.
    pub fn touch(&self) -> f64 {
        begin_of(self.approach.as_ref(), self.first_contact)
    }

    /// Interference at which an elastic contact ends on retraction, m.
    pub fn release(&self) -> f64 {
        begin_of(self.retraction.as_ref(), self.first_contact)
    }

    /// ω_max − ω_res, m, by which an asperity of the interference ω_max, m, springs back at most: all of it
    /// up to ω_c.
    pub fn recovery(&self, largest: f64) -> f64 {
        if largest <= self.top() || !self.flows() {
            return largest;
        }
        self.critical * scaled_recovery(largest / self.critical)
    }

    /// The distance, m, at which an asperity of the interference ω_max, m, loses contact on retraction;
    /// none if it has none.
    pub fn takeoff(&self, largest: f64) -> Option<f64> {
        let release = || match &self.flattened {
            Some(flattened) if largest > self.top() => flattened.release(self.radius_ratio(largest)),
            _ => self.release(),
        };
        (largest >= self.touch()).then(|| self.recovery(largest) - release())
    }

    /// R′/R of the top of an asperity of the interference ω_max, m, whose contact has ended; 1 where nothing
    /// flowed, or R is kept.
    pub fn radius_ratio(&self, largest: f64) -> f64 {
        if self.flattened.is_none() || !(largest > self.top()) {
            return 1.0;
        }
        let mut ratio = [0.0];
        self.radius_ratios(&[largest], &mut ratio, &mut Responses::default(), &mut SolverStats::default());
        ratio[0]
    }

    /// R′/R of asperities of interferences ω_max, m, above ω_c.
    fn radius_ratios(
        &self,
        largest: &[f64],
        ratios: &mut [f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let boundaries = self.approach.boundaries();
        let regime =
            |largest: f64| boundaries.partition_point(|end| !end.is_above(largest)).max(self.first_plastic);
        let mut begin = 0;
        while begin < largest.len() {
            let own = regime(largest[begin]);
            let end = begin + largest[begin..].iter().take_while(|largest| regime(**largest) == own).count();
            self.approach.evaluate(own, &largest[begin..end], out, stats);
            for (ratio, (area, load)) in ratios[begin..end].iter_mut().zip(out.area.iter().zip(&out.contact))
            {
                let radius = (area / PI).sqrt() / self.scale.radius;
                *ratio = self.scale.force * radius * radius * radius / load;
            }
            begin = end;
        }
    }

    /// The ω_max, m, of the asperities whose contact has ended and that are `further` ≥ 0, m, beyond, at a
    /// distance, m; of radii of their own; ω_c where all that have flowed are.
    fn let_go_from(&self, flattened: &dyn Flattened, distance: f64, further: f64) -> f64 {
        let wanted = distance - further;
        let beyond = |largest: f64| {
            let x = largest / self.critical;
            let slope: f64 =
                RECOVERY.iter().map(|(exponent, sign)| sign * exponent * power(x, exponent - 1.0)).sum();
            let release = flattened.release(self.radius_ratio(largest));
            Sample { value: wanted - (self.recovery(largest) - release), slope: -slope }
        };
        let low = self.top().next_up();
        let high = self.recovered_from(wanted).max(low) * (1.0 + 1e-12);
        if beyond(low).value <= 0.0 {
            return self.top();
        }
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON * wanted;
        safe_newton(beyond, low, high, high, close).x
    }

    /// The law at the distance `distance` ≥ 0, m, from the closest approach, in the variable ω_max.
    pub fn at(&self, distance: f64) -> Retraction<'_> {
        Retraction::new(self, distance)
    }

    /// The same for asperities of one interference ω_max, m, alone.
    pub fn at_for(&self, distance: f64, largest: f64) -> Retraction<'_> {
        let reach = self.takeoff(largest).unwrap_or(f64::NEG_INFINITY);
        let end =
            |_: &dyn Flattened, further| if distance - further >= reach { f64::INFINITY } else { self.top() };
        Retraction::with(self, distance, end)
    }

    /// x of interferences ω_max, m.
    fn depths(&self, largest: &[f64], places: &mut [f64]) {
        places.iter_mut().zip(largest).for_each(|(x, largest)| *x = largest / self.critical);
    }

    /// End of the elastic regime, m.
    fn top(&self) -> f64 {
        self.approach.boundaries().get(self.first_plastic - 1).map_or(f64::INFINITY, |end| end.interference)
    }

    /// The ω_max, m, whose recovery is that, m: the inverse of [`Loop::recovery`], below ω_c continued with
    /// its slope there, which is 1.
    fn recovered_from(&self, recovery: f64) -> f64 {
        let wanted = recovery / self.critical;
        if !(wanted > 1.0) || wanted.is_infinite() {
            return recovery;
        }
        // All terms but the first are not negative in sum.
        let highest = libm::pow(wanted, 1.0 / RECOVERY[0].0) * (1.0 + 1e-12);
        let f = |x: f64| {
            let log = libm::log(x);
            let powers = RECOVERY.map(|(exponent, sign)| sign * libm::exp(exponent * log));
            let slope: f64 = powers.iter().zip(RECOVERY).map(|(power, (exponent, _))| exponent * power).sum();
            Sample { value: wanted - powers.iter().sum::<f64>(), slope: -slope / x }
        };
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON * wanted;
        self.critical * safe_newton(f, 1.0, highest, wanted, close).x
    }
}

/// Whether the unloading is known of what flows in a law.
fn unloads(model: &Model) -> bool {
    matches!(model.validity.plasticity, Plasticity::Without | Plasticity::KogutEtsion)
}

/// Names of the laws that can be unloaded.
static UNLOADING: LazyLock<String> = LazyLock::new(|| {
    let names: Vec<&str> = MODELS.iter().filter(|model| unloads(model)).map(|model| model.name).collect();
    names.join(", ")
});

/// x^exponent.
fn power(x: f64, exponent: f64) -> f64 {
    libm::exp(exponent * libm::log(x))
}

/// (ω_max − ω_res)/ω_c at x.
fn scaled_recovery(x: f64) -> f64 {
    let log = libm::log(x);
    RECOVERY.iter().map(|(exponent, sign)| sign * libm::exp(exponent * log)).sum()
}

/// A function of x with a table from 1 to the deepest interference that is expected.
struct OfDepth {
    exact: fn(f64) -> f64,
    table: Piecewise,
}

impl OfDepth {
    fn new(exact: fn(f64) -> f64, deepest: f64) -> Self {
        Self { exact, table: Piecewise::new(exact, |_, value| TABLE_TOLERANCE * value, 1.0, deepest) }
    }

    /// Its values at places x.
    fn values(&self, places: &[f64], out: &mut [f64]) {
        InstructionSet::current().run(
            #[inline(always)]
            || self.table.values(places, out),
        );
        let missing = out.iter_mut().zip(places).filter(|(value, _)| value.is_nan());
        missing.for_each(|(value, x)| *value = (self.exact)(*x));
    }
}

/// Interference at which a regime begins, m.
fn begin_of(law: &dyn Law, regime: usize) -> f64 {
    if regime == 0 { f64::NEG_INFINITY } else { law.boundaries()[regime - 1].interference }
}

/// Whether a regime is above ω_c.
fn is_plastic(regime: Regime) -> bool {
    matches!(regime, Regime::Elastoplastic1 | Regime::Elastoplastic2 | Regime::Plastic)
}

/// What has become of an asperity, and the regime of the law that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Condition {
    /// It has never touched.
    Untouched(usize),
    /// It is elastic and has touched.
    Elastic(usize),
    /// It has flowed and is out of contact.
    Lowered(usize),
    /// It has flowed and is in contact; the regime is that of ω_max.
    Unloading(usize),
}

impl Condition {
    fn regime(self) -> usize {
        let (Self::Untouched(regime)
        | Self::Elastic(regime)
        | Self::Lowered(regime)
        | Self::Unloading(regime)) = self;
        regime
    }
}

/// The law of a [`Loop`] at one distance from the closest approach. Its interference is ω_max. Its regimes
/// are those of the law, some more than once: [`Retraction::base`].
pub struct Retraction<'a> {
    cycle: &'a Loop,
    distance: f64,
    states: Vec<Condition>,
    regimes: Vec<Regime>,
    base: Vec<usize>,
    boundaries: Vec<Boundary>,
}

impl<'a> Retraction<'a> {
    fn new(cycle: &'a Loop, distance: f64) -> Self {
        Self::with(cycle, distance, |flattened, further| cycle.let_go_from(flattened, distance, further))
    }

    /// With the end of what has flowed, is `further` beyond the end of its contact and has a radius of its
    /// own, in ω_max, m.
    fn with(cycle: &'a Loop, distance: f64, let_go: impl Fn(&dyn Flattened, f64) -> f64) -> Self {
        let mut law = Self {
            cycle,
            distance,
            states: Vec::with_capacity(12),
            regimes: Vec::with_capacity(12),
            base: Vec::with_capacity(12),
            boundaries: Vec::with_capacity(12),
        };
        let Loop { approach, retraction, capture, first_contact, first_plastic, .. } = cycle;
        let shifted =
            |boundary: Boundary| Boundary { interference: boundary.interference + distance, ..boundary };
        let captured = Boundary { interference: *capture, belongs_below: false };
        for regime in 0..*first_contact {
            law.push(
                Condition::Untouched(regime),
                Some(lower(shifted(approach.boundaries()[regime]), captured)),
            );
        }
        let flows = cycle.flows();
        // Where a law without plastic flow ends, it is not known; on retraction it is known again.
        let top =
            approach.boundaries().get(first_plastic - 1).map(|end| if flows { *end } else { shifted(*end) });
        for regime in 0..*first_plastic {
            let end = retraction.boundaries().get(regime).filter(|_| regime + 1 < *first_plastic);
            let end = end.map(|end| higher(shifted(*end), captured));
            let end = match (end, top) {
                (Some(end), Some(top)) => Some(lower(end, top)),
                (end, top) => end.or(top),
            };
            law.push(Condition::Elastic(regime), end);
        }
        let Some(top) = top.filter(|_| flows) else { return law };
        let mut end = top;
        for regime in 0..*first_contact {
            let Boundary { interference, belongs_below } = shifted(retraction.boundaries()[regime]);
            let interference = match &cycle.flattened {
                None => cycle.recovered_from(interference),
                Some(flattened) => {
                    let further = cycle.release() - retraction.boundaries()[regime].interference;
                    let_go(flattened.as_ref(), further)
                }
            };
            end = higher(Boundary { interference, belongs_below }, top);
            law.push(Condition::Lowered(regime), Some(end));
        }
        for regime in *first_plastic..approach.regimes().len() {
            law.push(
                Condition::Unloading(regime),
                approach.boundaries().get(regime).map(|upper| higher(*upper, end)),
            );
        }
        law
    }

    fn push(&mut self, state: Condition, end: Option<Boundary>) {
        self.states.push(state);
        self.base.push(state.regime());
        self.regimes.push(self.cycle.approach.regimes()[state.regime()]);
        self.boundaries.extend(end);
    }

    /// For each of its regimes, which one it is of the law on approach.
    pub fn base(&self) -> &[usize] {
        &self.base
    }

    /// The law that acts in a state.
    fn law(&self, state: Condition) -> &dyn Law {
        match state {
            Condition::Untouched(_) | Condition::Unloading(_) => self.cycle.approach.as_ref(),
            Condition::Elastic(_) | Condition::Lowered(_) => self.cycle.retraction.as_ref(),
        }
    }

    /// Pieces of a state, of which `place` says where an interference of the law is, m, within `limits`.
    fn moved(
        &self,
        index: usize,
        limits: (f64, f64),
        place: impl Fn(f64) -> f64,
    ) -> impl Iterator<Item = Piece> {
        let state = self.states[index];
        let pieces = self.law(state).pieces().into_iter().filter(move |piece| piece.regime == state.regime());
        let moved = pieces.map(move |piece| Piece {
            regime: index,
            lower: place(piece.lower).max(limits.0),
            upper: place(piece.upper).min(limits.1),
            smoothness: match piece.smoothness {
                Smoothness::Root { place: root, end, order } => {
                    Smoothness::Root { place: place(root), end, order }
                }
                Smoothness::Smooth => Smoothness::Smooth,
            },
        });
        moved.filter(|piece| piece.lower < piece.upper)
    }

    /// Pieces of a contact that is unloaded: without load, and under it.
    fn unloading(&self, index: usize, limits: (f64, f64)) -> Vec<Piece> {
        let unloaded = self.cycle.recovered_from(self.distance);
        let bare = self.moved(index, (limits.0, limits.1.min(unloaded)), |place| place);
        let loaded = self.moved(index, (limits.0.max(unloaded), limits.1), |place| place);
        let smoothness = Smoothness::Root { end: End::Lower, place: unloaded, order: ORDER };
        bare.chain(loaded.map(|piece| Piece { smoothness, ..piece })).collect()
    }

    /// Pieces of lowered tops of radii of their own: between jumps of the radius, and on both sides of a jump
    /// of the attraction.
    fn flattened(&self, index: usize, flattened: &dyn Flattened, (lower, upper): (f64, f64)) -> Vec<Piece> {
        let mut ends: Vec<f64> =
            self.cycle.approach.boundaries().iter().map(|end| end.interference).collect();
        ends.retain(|end| lower < *end && *end < upper);
        ends.push(upper);
        let mut pieces = Vec::new();
        let mut lower = lower;
        for end in ends {
            let kink =
                (self.states[index].regime() == 0).then(|| self.kink(flattened, (lower, end))).flatten();
            if let Some(place) = kink {
                let smoothness = Smoothness::Root { end: End::Upper, place, order: 2 };
                pieces.push(Piece { regime: index, lower, upper: place, smoothness });
                lower = place;
            }
            pieces.push(Piece { regime: index, lower, upper: end, smoothness: Smoothness::Smooth });
            lower = end;
        }
        pieces.retain(|piece| piece.lower < piece.upper);
        pieces
    }

    /// The ω_max, m, within limits at which the attraction of lowered tops of radii of their own jumps.
    fn kink(&self, flattened: &dyn Flattened, (lower, upper): (f64, f64)) -> Option<f64> {
        let cycle = self.cycle;
        if !(upper - lower > 4.0 * KINK_PARTS as f64 * f64::EPSILON * upper) {
            return None;
        }
        let beyond = |largest: f64| {
            let kink = flattened.kink(cycle.radius_ratio(largest))?;
            Some(kink - (cycle.recovery(largest) - self.distance))
        };
        let place = |part: usize| lower + (upper - lower) * part as f64 / KINK_PARTS as f64;
        let inside = |part: usize| place(part).clamp(lower.next_up(), upper.next_down());
        let (mut low, mut high) =
            (0..KINK_PARTS).map(|part| (inside(part), inside(part + 1))).find(|&(low, high)| {
                beyond(low).is_some_and(|b| b > 0.0) && beyond(high).is_some_and(|b| b <= 0.0)
            })?;
        while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            *(if beyond(middle)? > 0.0 { &mut low } else { &mut high }) = middle;
        }
        Some(high)
    }

    /// Forces of contacts above ω_c that are unloaded from ω_max, m, at which `out` has them.
    fn unload(&self, largest: &[f64], out: &mut Responses) {
        let (mut places, mut recovery, mut load, mut area) =
            ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        let count = largest.len();
        self.cycle.depths(largest, &mut places[..count]);
        self.cycle.recovery.values(&places[..count], &mut recovery[..count]);
        self.cycle.load_exponent.values(&places[..count], &mut load[..count]);
        self.cycle.area_exponent.values(&places[..count], &mut area[..count]);
        for i in 0..count {
            let recovery = self.cycle.critical * recovery[i];
            let ratio = libm::log(((recovery - self.distance) / recovery).max(0.0));
            out.contact[i] *= libm::exp(load[i] * ratio);
            out.area[i] *= libm::exp(area[i] * ratio);
        }
    }
}

/// The lower of two boundaries, the second where they are at the same place.
fn lower(a: Boundary, b: Boundary) -> Boundary {
    if a.interference < b.interference { a } else { b }
}

/// The higher of two boundaries, the second where they are at the same place.
fn higher(a: Boundary, b: Boundary) -> Boundary {
    if a.interference > b.interference { a } else { b }
}

impl Law for Retraction<'_> {
    fn regimes(&self) -> &[Regime] {
        &self.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut lower = f64::NEG_INFINITY;
        for (index, state) in self.states.iter().enumerate() {
            let upper = self.boundaries.get(index).map_or(f64::INFINITY, |end| end.interference);
            let limits = (lower, upper);
            match state {
                Condition::Untouched(_) | Condition::Elastic(_) => {
                    pieces.extend(self.moved(index, limits, |place| place + self.distance));
                }
                Condition::Lowered(_) if let Some(flattened) = &self.cycle.flattened => {
                    pieces.extend(self.flattened(index, flattened.as_ref(), limits));
                }
                Condition::Lowered(_) => {
                    pieces.extend(
                        self.moved(index, limits, |place| self.cycle.recovered_from(place + self.distance)),
                    );
                }
                Condition::Unloading(_) => pieces.extend(self.unloading(index, limits)),
            }
            lower = upper;
        }
        pieces
    }

    fn cost(&self, regime: usize) -> f64 {
        let state = self.states[regime];
        let own = match state {
            Condition::Unloading(_) => COSTS.0,
            Condition::Lowered(0) if self.cycle.flattened.is_some() => COSTS.2,
            Condition::Lowered(_) => COSTS.1,
            Condition::Untouched(_) | Condition::Elastic(_) => 0.0,
        };
        own + self.law(state).cost(state.regime())
    }

    fn constant(&self, regime: usize) -> Option<f64> {
        let state = self.states[regime];
        let varies = match state {
            Condition::Unloading(_) => true,
            Condition::Lowered(_) => self.cycle.flattened.is_some(),
            Condition::Untouched(_) | Condition::Elastic(_) => false,
        };
        self.law(state).constant(state.regime()).filter(|_| !varies)
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let state = self.states[regime];
        let (law, base) = (self.law(state), state.regime());
        if let Condition::Unloading(_) = state {
            law.evaluate(base, interference, out, stats);
            self.unload(interference, out);
            return;
        }
        // Rounding must not lead out of the regime.
        let upper = law.boundaries().get(base).map_or(f64::INFINITY, |end| end.interference);
        let lower = begin_of(law, base).min(upper);
        let mut own = [0.0; BLOCK];
        let own = &mut own[..interference.len()];
        if let Condition::Lowered(_) = state {
            let mut places = [0.0; BLOCK];
            self.cycle.depths(interference, &mut places[..interference.len()]);
            self.cycle.recovery.values(&places[..interference.len()], own);
            own.iter_mut().for_each(|recovery| *recovery *= self.cycle.critical);
        } else {
            own.copy_from_slice(interference);
        }
        if let (Condition::Lowered(_), Some(flattened)) = (state, &self.cycle.flattened) {
            let mut ratios = [0.0; BLOCK];
            let ratios = &mut ratios[..interference.len()];
            self.cycle.radius_ratios(interference, ratios, out, stats);
            own.iter_mut().for_each(|delta| *delta -= self.distance);
            match law.constant(base) {
                None => flattened.attraction(ratios, own, out, stats),
                Some(adhesion) => {
                    law.evaluate(base, own, out, stats);
                    out.adhesion.iter_mut().zip(ratios).for_each(|(out, ratio)| *out = adhesion * *ratio);
                }
            }
            return;
        }
        own.iter_mut().for_each(|delta| *delta = (*delta - self.distance).clamp(lower, upper));
        law.evaluate(base, own, out, stats);
    }
}
