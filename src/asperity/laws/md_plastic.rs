//! Elastic-plastic adhesion that is continuous in λ and in the interference: Maugis-Dugdale around a flattened summit.
//!
//! # Formula
//! One assumption: at every moment a contact is an elastic Maugis-Dugdale contact of the outline that its flattened summit has.
//! With the load P(ω) and the contact radius a(ω) of a plastic contact without adhesion ([`PlasticContact`]), whose interference
//! ω is the parameter of the states, it leaves ([`crate::asperity::outline`])
//!
//! f(r) = r²/2ρ + br⁴ up to a, the paraboloid of R beyond, ρ = max{R[1 + 1.275 (E/Y)^−0.216 (ω/ω_c − 1)], Ka³/P}
//!
//! with ω_c of Jackson and Green. The first term is R below ω_c, and b gives the outline the load P at a. ρ, the residual depth and δ
//! are those at the ω at which the contact is reached (below). With δ_A of the history and δ_y, the δ at which yielding begins:
//!
//! | regime | interval | F_s | P |
//! |---|---|---|---|
//! | noncontact, lubricant | as [`super::emd`] | as [`super::emd`] | 0 |
//! | elastic | −δ_A ≤ δ ≤ δ_y | Maugis-Dugdale | K a³/R of Maugis-Dugdale |
//! | elastoplastic1, elastoplastic2, plastic | as the plastic contact has them, at their δ | that of the outline | P(ω) |
//!
//! Where adhesion alone makes a contact yield, δ_y is below first touch and there is no elastic regime. Of several states at one
//! δ the one of the largest ω acts, which is the stable one. Unloading is that of the elastic contact of the outline
//! ([`crate::asperity::Loop`]).
//!
//! Four conditions, which the plastic contacts do not meet by themselves, keep loops from gaining energy. a is at least √(Rω). P is
//! at most K a³/R, since a flattened summit is not sharper than before, and at most K R^(1/4) a^(1/2) ω^(5/4). The contact of a and
//! P is reached at ω or at a smaller interference, so that the sphere around it does not sink and lose attraction. Loads of Kogut and
//! Etsion pass from one fit to the next where both are equal. The load of Jackson and Green is above the second limit of P by
//! 0.5 % where it begins, for a fortieth of ω, and the sphere around its contact does not sink for ν ≤ 0.35 and H/E from 0.005 to
//! 0.09. The area of Kogut and Etsion jumps from one fit to the next.
//!
//! # Validity
//! All λ in 1e-6..1e6. Pile-up, ductile separation and the plastic work of pulling are left out. Loops dissipate where the
//! adhesive stress is less than the largest pressure of the plastic contact. Sources: Etsion, Kligerman and Kadin, Int. J. Solids
//! Struct. 42 (2005) 3716, for ρ; the conditions and the outline beyond a are assumptions of this program. Compare Mesarovic and
//! Johnson, J. Mech. Phys. Solids 48 (2000) 2009, and Maugis and Pollock, Acta Metall. 32 (1984) 1323.

use super::md::MaugisContact;
use super::{emd, jg, kogut_etsion, tn, zmc};
use crate::asperity::block::Responses;
use crate::asperity::error::LawError;
use crate::asperity::lane::{Lane, Lanes, Numbered};
use crate::asperity::law::{End, Law, Method, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::loading::{Around, State};
use crate::asperity::outline::Pressed;
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Place;
use crate::asperity::response_table::ResponseTable;
use crate::asperity::scale::{Asperity, poisson_ratio};
use crate::asperity::stats::SolverStats;
use crate::asperity::summit::FlattenedSummit;
use crate::asperity::table::{Row, Table};
use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// Largest number of steps of the search for a state. Most searches take six.
const MOST_STEPS: usize = 100;
/// Relative accuracy of tables, a few roundings of what is tabulated.
const TABLE_TOLERANCE: f64 = 2e-14;
/// Largest number of halvings of an interval of the tables.
const TABLE_HALVINGS: u32 = 10;
/// Halvings of an interval of ω.
const HALVINGS: usize = 60;
/// Relative step of ω over which slopes are taken.
const SHORT: f64 = 1e-5;
/// Coefficient and exponent of E/Y by which ρ/R − 1 grows with ω/ω_c − 1 (Etsion, Kligerman and Kadin 2005).
const FLATTENING: (f64, f64) = (1.275, -0.216);
/// Number of places of a regime at which changes of its formulas are searched for, and the end of that search in the last regime,
/// in multiples of its beginning.
const LOOKS: usize = 400;
const LAST_JOINT: f64 = 1e4;
/// Largest relative difference from a Hertz contact that counts as rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Joints closer than this share are one.
const SAME: f64 = 1e-12;
/// Steps of a search after which intervals are halved, because secants do not converge where the area of Kogut and Etsion jumps.
const SECANTS: u32 = 24;
/// Asperities that are solved together.
const TOGETHER: usize = 16;

thread_local! {
    /// Kept from solve to solve: to clear it would take longer than most.
    static BARE: RefCell<Box<Responses>> = RefCell::default();
}

/// The contact without adhesion of an asperity that yields.
///
/// # Examples
/// ```
/// use stiction::asperity::PlasticContact;
///
/// assert_eq!(PlasticContact::default(), PlasticContact::JacksonGreen);
/// assert_eq!(PlasticContact::ALL[2].0, "zmc");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlasticContact {
    /// Jackson and Green's, [`super::jg`].
    #[default]
    JacksonGreen,
    /// Kogut and Etsion's, [`super::kogut_etsion`].
    KogutEtsion,
    /// Zhao, Maietta and Chang's, [`super::zmc`].
    ZhaoMaiettaChang,
    /// Thornton and Ning's, [`super::tn`].
    ThorntonNing,
}

impl PlasticContact {
    /// All of them with their names, which the laws with these contacts have too.
    pub const ALL: [(&'static str, Self); 4] = [
        ("jg", Self::JacksonGreen),
        ("ke", Self::KogutEtsion),
        ("zmc", Self::ZhaoMaiettaChang),
        ("tn", Self::ThorntonNing),
    ];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, contact)| *contact == self).expect("every contact is in ALL").0
    }

    /// The largest mean pressure that a contact of an asperity takes, Pa: the hardness H, and kH by Thornton and Ning.
    pub(crate) fn largest_pressure(self, asperity: &Asperity) -> f64 {
        match self {
            Self::ThorntonNing => asperity.pressure_factor() * asperity.hardness,
            _ => asperity.hardness,
        }
    }

    fn law(self, parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
        match self {
            Self::JacksonGreen => jg::jg(parameters),
            Self::KogutEtsion => kogut_etsion::meeting_fits(parameters),
            Self::ZhaoMaiettaChang => zmc::zmc(parameters),
            Self::ThorntonNing => tn::tn(parameters),
        }
    }
}

/// The law `md_plastic`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved; [`LawError::Elastic`] and [`LawError::Hardness`] as the plastic contact.
pub fn md_plastic(parameters: &LawParameters, contact: PlasticContact) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("md_plastic")?;
    // The elastic contact and its tables go as deep as in `md`.
    let elastic = LawParameters { critical_interference: f64::INFINITY, ..*parameters };
    let (before, maugis) = emd::rows_before(&elastic)?;
    let begin = maugis.begins(0.0);
    let contact = contact_rows((parameters, contact), dry(parameters), begin, maugis)?;
    Ok(Box::new(Table::new(before.into_iter().chain(contact))))
}

/// The surroundings of the contacts of dry asperities.
fn dry(parameters: &LawParameters) -> Around {
    Around { scale: parameters.scale, bridge: None }
}

/// The plastic loading of dry asperities.
///
/// # Errors
/// As [`md_plastic`].
pub(in crate::asperity) fn dry_loading(
    parameters: &LawParameters,
    contact: PlasticContact,
) -> Result<Arc<PlasticLoading>, LawError> {
    let maugis = MaugisContact::new(&LawParameters { table_range: None, ..*parameters }, f64::INFINITY)?;
    plastic_loading((parameters, contact), dry(parameters), &maugis.begins(0.0))
}

/// The plastic loading of asperities with `around` their contacts, which begin or end by the history at `begin`.
///
/// # Errors
/// As [`md_plastic`].
pub(in crate::asperity) fn plastic_loading(
    (parameters, contact): (&LawParameters, PlasticContact),
    around: Around,
    begin: &Place,
) -> Result<Arc<PlasticLoading>, LawError> {
    let law = contact.law(parameters)?;
    Ok(Arc::new(PlasticLoading::new((parameters, law), around, begin)?))
}

/// The rows of contact, which begins or ends by the history at `begin`: the law `elastic` up to the onset of yielding, and plastic
/// loading with `around` the contacts from there on.
///
/// # Errors
/// As [`md_plastic`].
pub(super) fn contact_rows(
    (parameters, contact): (&LawParameters, PlasticContact),
    around: Around,
    begin: Place,
    elastic: impl Law + 'static,
) -> Result<Vec<Row>, LawError> {
    // Tables are made from solves without tables.
    let exact =
        plastic_loading((&LawParameters { table_range: None, ..*parameters }, contact), around, &begin)?;
    let fast = plastic_loading((parameters, contact), around, &begin)?;
    let place = |regime: usize| {
        let loading = Arc::clone(&exact);
        let own = exact.end(regime, &exact.lane()).max(begin.interference);
        Place::following(own, move |lane| loading.end(regime, lane))
    };
    let mut rows = vec![Row::up_to(Regime::Elastic, place(exact.onset), elastic)];
    let deepest = parameters.table_range.map(|(_, deepest)| deepest);
    for (regime, name) in exact.law.regimes().iter().enumerate().skip(exact.onset + 1) {
        let lower = exact.end(regime - 1, &exact.lane());
        let part = PlasticRegime::new([&exact, &fast], regime, lower, deepest);
        rows.push(if regime < exact.law.boundaries().len() {
            Row::up_to(*name, place(regime), part)
        } else {
            Row::last(*name, part)
        });
    }
    Ok(rows)
}

/// The states of an asperity on loading, by ω/s_δ.
pub(in crate::asperity) struct PlasticLoading {
    /// The plastic contact without adhesion.
    law: Box<dyn Law>,
    /// The last elastic regime of that contact.
    onset: usize,
    around: Around,
    /// Where contact begins or ends by the history.
    begin: Place,
    /// ω_c/s_δ of Jackson and Green, where a sphere yields.
    critical: f64,
    /// The rate at which ρ/R grows with ω/ω_c.
    flattening: f64,
}

impl PlasticLoading {
    fn new(
        (parameters, law): (&LawParameters, Box<dyn Law>),
        around: Around,
        begin: &Place,
    ) -> Result<Self, LawError> {
        let plastic = law.regimes().iter().position(|regime| regime.is_plastic());
        let onset = plastic.expect("a plastic contact yields") - 1;
        let hardness = parameters.hardness_ratio.ok_or(LawError::Hardness("md_plastic"))?;
        let poisson = poisson_ratio(parameters.pressure_factor);
        let yielding = (1.0 - poisson * poisson) * jg::HARDNESS / hardness;
        let flattening = FLATTENING.0 * libm::pow(yielding, FLATTENING.1);
        let critical = jg::critical_interference(parameters) / around.scale.length;
        Ok(Self { law, onset, around, begin: begin.clone(), critical, flattening })
    }

    /// The asperity of the law's own radius.
    fn lane(&self) -> Lane {
        Lane::new(1.0, self.lambda())
    }

    /// λ of the solids, if they have adhesion.
    fn lambda(&self) -> Option<f64> {
        Some(self.around.scale.lambda).filter(|lambda| *lambda > 0.0)
    }

    /// ω/s_δ at the end of a regime of the plastic contact of an asperity.
    fn joint(&self, regime: usize, lane: &Lane) -> f64 {
        self.law.boundaries()[regime].interference * lane.ratio / self.around.scale.length
    }

    /// ω/s_δ at which an asperity begins to yield: at ω_c, or where the plastic contact does before it.
    fn onset(&self, lane: &Lane) -> f64 {
        self.joint(self.onset, lane).min(self.critical * lane.ratio)
    }

    /// ω/s_δ from which on an asperity is in a regime of the plastic contact.
    fn lower(&self, regime: usize, lane: &Lane) -> f64 {
        if regime == self.onset + 1 { self.onset(lane) } else { self.joint(regime - 1, lane) }
    }

    /// The states of asperities at ω/s_δ in a regime of the plastic contact; adhesive zones are searched for from the states in `out`.
    fn states(&self, regime: usize, lanes: Numbered<'_>, places: &[f64], out: &mut [State]) {
        let mut interference = [0.0; TOGETHER];
        let interference = &mut interference[..places.len()];
        interference.iter_mut().zip(places).for_each(|(own, place)| *own = place * self.around.scale.length);
        BARE.with_borrow_mut(|bare| {
            if regime > self.onset {
                let (lanes, stats) = (Lanes::Each(lanes), &mut SolverStats::default());
                self.law.evaluate(regime, lanes, interference, bare, stats);
            }
            self.adhesive_states(regime, (lanes, bare), places, out);
        });
    }

    /// The states of asperities at ω/s_δ in a regime of the plastic contact, of which the responses without adhesion are
    /// known.
    fn adhesive_states(
        &self,
        regime: usize,
        (lanes, bare): (Numbered<'_>, &Responses),
        places: &[f64],
        out: &mut [State],
    ) {
        for (i, (state, &place)) in out.iter_mut().zip(places).enumerate() {
            let lane = lanes.at(i);
            let of_law = [bare.area[i], bare.contact[i]];
            *state = self.around.state(self.pressed(regime, lane, place, of_law).0, state);
        }
    }

    /// The contact without adhesion of an asperity at ω/s_δ, from the area and the load of the plastic contact, and the numbers of
    /// the formulas that give it.
    fn pressed(
        &self,
        regime: usize,
        lane: &Lane,
        place: f64,
        [area, load]: [f64; 2],
    ) -> ((Pressed, f64), [u8; 4]) {
        let ratio = lane.ratio;
        let hertz = (ratio * place).sqrt();
        let is_hertzian = regime <= self.onset || place <= self.joint(self.onset, lane);
        let (radius, load, interference, by) = if is_hertzian {
            (hertz, place * hertz, place, [0; 2])
        } else {
            let own = (area / PI).sqrt() / self.around.scale.radius;
            let is_own = own > hertz * (1.0 + ROUNDING);
            let radius = if is_own { own } else { hertz };
            let (load, of_load) = at_most(load / self.around.scale.force, most(ratio, place, radius));
            let (interference, sinks) = self.least_sunk(ratio, place, radius, load);
            (radius, load, interference, [1 + of_load, 1 + u8::from(is_own) + sinks])
        };
        let beyond = interference / (self.critical * ratio) - 1.0;
        let of_fit = ratio * (1.0 + self.flattening * beyond.max(0.0));
        let of_load = radius * radius * radius / load;
        let (apex, of_apex) = if is_hertzian || of_fit >= of_load { (of_fit, 0) } else { (of_load, 1) };
        let pressed = Pressed { lambda: self.around.scale.lambda, radius, load, apex, sphere: ratio };
        ((pressed, place - interference), [by[0], by[1], of_apex, u8::from(beyond > 0.0)])
    }

    /// ω/s_δ at which a contact of a radius and a load is reached: `place`, or less if the sphere around the contact would sink. And
    /// the number of the formula: 0 for `place`, 2 with ρ = a³/p, 4 with the fitted ρ. A contact of a radius a and a load p lowers the
    /// sphere at its edge by ω − a²/2R − (25/48)p/a + a²/48ρ, with ρ the larger of the fit and a³/p.
    fn least_sunk(&self, ratio: f64, place: f64, radius: f64, load: f64) -> (f64, u8) {
        let (square, per_radius) = (radius * radius, load / radius);
        let least = place * (1.0 - ROUNDING);
        let of_load = 0.5 * (square / ratio + per_radius);
        if of_load >= least {
            return (place, 0);
        }
        let whole = 0.5 * square / ratio + 25.0 / 48.0 * per_radius;
        let mut of_fit = whole - square / (48.0 * ratio);
        if of_fit > self.critical * ratio {
            // ρ = first + rate ω.
            let (first, rate) = (ratio * (1.0 - self.flattening), self.flattening / self.critical);
            let sum = first + whole * rate;
            of_fit = whole - square / (24.0 * (sum + (sum * sum - rate * square / 12.0).sqrt()));
        }
        if of_fit >= least {
            (place, 0)
        } else if of_load >= of_fit {
            (of_load, 2)
        } else {
            (of_fit, 4)
        }
    }

    /// The state of one asperity at ω/s_δ.
    fn state(&self, regime: usize, lane: &Lane, place: f64) -> State {
        let mut state = [State::default()];
        self.states(regime, Numbered::alike(std::array::from_ref(lane)), &[place], &mut state);
        state[0]
    }

    /// δ/s_δ of one asperity at ω/s_δ.
    fn displacement(&self, regime: usize, lane: &Lane, place: f64) -> f64 {
        place - self.state(regime, lane, place).short()
    }

    /// δ, m, at which a regime of the plastic contact ends: the onset of yielding, or the boundary of two plastic regimes. It is where
    /// contact begins if there is no stable state.
    fn end(&self, regime: usize, lane: &Lane) -> f64 {
        let begin = self.begin.of(lane);
        let place = if regime == self.onset { self.onset(lane) } else { self.joint(regime, lane) };
        let state = self.state(regime, lane, place);
        let end = place - state.short();
        let is_stable = self.displacement(regime, lane, place * (1.0 - SHORT)) < end
            && (regime > self.onset || libm::atan(state.zone) <= lane.elastic.contact_angle());
        if is_stable { begin.max(end * self.around.scale.length) } else { begin }
    }

    /// ω/s_δ within a regime, rising, at which one formula replaces another, for the law's own radius.
    fn joints(&self, regime: usize) -> Vec<f64> {
        let lane = self.lane();
        let from = self.lower(regime, &lane).next_up();
        let to =
            if regime < self.law.boundaries().len() { self.joint(regime, &lane) } else { LAST_JOINT * from };
        let formulas = |place: f64| {
            let mut bare = Responses::default();
            let own = [place * self.around.scale.length];
            if place > self.joint(self.onset, &lane) {
                self.law.evaluate(regime, Lanes::Own, &own, &mut bare, &mut SolverStats::default());
            }
            self.pressed(regime, &lane, place, [bare.area[0], bare.contact[0]]).1
        };
        let rate = libm::log(to / from) / LOOKS as f64;
        let places = (0..=LOOKS).map(|i| (from * libm::exp(rate * i as f64)).min(to));
        let looked_at: Vec<(f64, [u8; 4])> = places.map(|place| (place, formulas(place))).collect();
        let mut joints = Vec::new();
        for pair in looked_at.windows(2) {
            let ((mut low, mut below), (end, above)) = (pair[0], pair[1]);
            while below != above {
                let mut high = end;
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    *(if formulas(middle) == below { &mut low } else { &mut high }) = middle;
                }
                joints.push(high);
                (low, below) = (high, formulas(high));
            }
        }
        joints.dedup_by(|next, own| *next - *own <= SAME * *next);
        joints
    }

    /// δ/s_δ at the fold of a regime, which is the least δ/s_δ of its stable states, unless the regime begins with that.
    fn fold(&self, regime: usize, lane: &Lane) -> Option<f64> {
        let at = |place: f64| self.displacement(regime, lane, place);
        let begin = self.lower(regime, lane);
        if at(begin * (1.0 + SHORT)) >= at(begin) {
            return None;
        }
        let mut high = 2.0 * begin;
        while at(2.0 * high) < at(high) {
            high *= 2.0;
        }
        let (mut low, mut high) = (begin, 2.0 * high);
        for _ in 0..HALVINGS {
            let third = (high - low) / 3.0;
            if at(low + third) < at(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        Some(at(0.5 * (low + high)))
    }

    /// The smoothness of a regime from where it begins, m, on.
    fn first_smoothness(&self, regime: usize, lane: &Lane, begin: f64) -> Smoothness {
        self.fold(regime, lane).map_or(Smoothness::Smooth, |fold| {
            let place = begin.min(fold * self.around.scale.length);
            Smoothness::Root { end: End::Lower, place, order: 2 }
        })
    }

    /// Writes the responses of asperities at interferences δ, m, in a regime of the plastic contact; of several states, the one of
    /// the largest ω. Secants approach it from above, and intervals are halved where they do not converge.
    fn solve(
        &self,
        regime: usize,
        lanes: Numbered<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        for (chunk, interference) in interference.chunks(TOGETHER).enumerate() {
            let first = chunk * TOGETHER;
            let states = self.solve_few(regime, lanes.from(first), interference, stats);
            for (i, state) in states[..interference.len()].iter().enumerate() {
                let i = first + i;
                [out.adhesion[i], out.contact[i], out.area[i]] = self.around.forces(state);
            }
        }
    }

    /// Visits the flattened summits of asperities of lanes at interferences ω_max, m, in one of the plastic regimes.
    pub(in crate::asperity) fn summits(
        &self,
        number: usize,
        lanes: Numbered<'_>,
        largest: &[f64],
        stats: &mut SolverStats,
        mut visit: impl FnMut(FlattenedSummit),
    ) {
        for (chunk, largest) in largest.chunks(TOGETHER).enumerate() {
            let lanes = lanes.from(chunk * TOGETHER);
            let states = self.solve_few(self.onset + 1 + number, lanes, largest, stats);
            for state in &states[..largest.len()] {
                visit(FlattenedSummit::new(state, self.around.scale.length));
            }
        }
    }

    /// The states of at most [`TOGETHER`] asperities at interferences δ, m.
    fn solve_few(
        &self,
        regime: usize,
        lanes: Numbered<'_>,
        interference: &[f64],
        stats: &mut SolverStats,
    ) -> [State; TOGETHER] {
        let count = interference.len();
        let mut states = [State::default(); TOGETHER];
        let (mut places, mut searches) = ([0.0; TOGETHER], [Search::default(); TOGETHER]);
        for (i, place) in places[..count].iter_mut().enumerate() {
            searches[i].wanted = interference[i] / self.around.scale.length;
            *place = searches[i].wanted.max(self.lower(regime, lanes.at(i)));
        }
        for _ in 0..MOST_STEPS {
            self.states(regime, lanes, &places[..count], &mut states[..count]);
            stats.evaluations += count as u64;
            let mut is_done = true;
            for (i, place) in places[..count].iter_mut().enumerate() {
                is_done &= searches[i].step(place, states[i].short());
            }
            if is_done {
                break;
            }
        }
        states
    }
}

/// The search for the state of the largest ω at a displacement.
#[derive(Clone, Copy, Default)]
struct Search {
    /// δ/s_δ that is searched for.
    wanted: f64,
    /// The last place above the state, and how far its displacement is off.
    last: Option<[f64; 2]>,
    /// The nearest places below and above that were passed.
    below: Option<f64>,
    above: Option<f64>,
    steps: u32,
    is_done: bool,
}

impl Search {
    /// Takes a step from a place ω/s_δ whose displacement is less by `short`, and returns whether the search is done. If the
    /// displacement jumps over the wanted one, the search ends above the jump.
    fn step(&mut self, place: &mut f64, short: f64) -> bool {
        let (here, off) = (*place, *place - short - self.wanted);
        self.steps += 1;
        let noise = 2.0 * f64::EPSILON * (here + short + self.wanted.abs());
        if off.abs() <= noise {
            self.is_done = true;
        }
        if self.is_done {
            return true;
        }
        *(if off < 0.0 { &mut self.below } else { &mut self.above }) = Some(here);
        let next = match self.last {
            None if off < 0.0 => self.wanted + 2.0 * short,
            None => self.wanted + short,
            Some([last, of_last]) => here - off * (here - last) / (off - of_last),
        };
        if off >= 0.0 || self.last.is_some() {
            self.last = Some([here, off]);
        }
        let next = match (self.below, self.above) {
            (Some(below), Some(above)) if self.steps > SECANTS && below < above => {
                let middle = 0.5 * (below + above);
                if middle > below && middle < above {
                    middle
                } else {
                    self.is_done = here == above;
                    above
                }
            }
            _ => next,
        };
        self.is_done |= !(next > 0.0 && next.is_finite());
        if !self.is_done {
            *place = next;
        }
        self.is_done
    }
}

/// The largest loads p of a contact of radius r at ω/s_δ: the load of the elastic sphere, and the load with which a loop gains no
/// energy.
fn most(ratio: f64, place: f64, radius: f64) -> [f64; 2] {
    let energy = (ratio.sqrt().sqrt() * radius.sqrt()) * (place * place.sqrt().sqrt());
    [radius * radius * radius / ratio, energy]
}

/// The least of a load and two others, and its number.
fn at_most(load: f64, [first, second]: [f64; 2]) -> (f64, u8) {
    if load <= first && load <= second {
        (load, 0)
    } else if first <= second {
        (first, 1)
    } else {
        (second, 2)
    }
}

/// The plastic loading in one regime.
struct PlasticRegime {
    exact: Arc<PlasticLoading>,
    fast: Arc<PlasticLoading>,
    regime: usize,
    /// ω/s_δ at which one formula replaces another, for the law's own radius, and δ there, m.
    joints: Vec<[f64; 2]>,
    /// The responses of asperities of the law's own radius between these joints.
    table: ResponseTable,
}

impl PlasticRegime {
    fn new(
        [exact, fast]: [&Arc<PlasticLoading>; 2],
        regime: usize,
        lower: f64,
        deepest: Option<f64>,
    ) -> Self {
        let lane = exact.lane();
        let at = |place: f64| [place, exact.displacement(regime, &lane, place) * exact.around.scale.length];
        let is_last = regime == exact.law.boundaries().len();
        let upper = if is_last { f64::INFINITY } else { exact.end(regime, &lane) };
        let deepest = deepest.map_or(lower, |deepest| deepest.min(upper));
        let mut joints: Vec<[f64; 2]> = exact.joints(regime).into_iter().map(at).collect();
        joints.retain(|[_, joint]| lower < *joint && *joint < upper);
        let ends: Vec<f64> = joints.iter().map(|[_, joint]| *joint).chain([f64::INFINITY]).collect();
        let first = exact.first_smoothness(regime, &lane, lower);
        let piece = |(i, upper): (usize, &f64)| match i.checked_sub(1) {
            None => Piece { regime, lower, upper: *upper, smoothness: first },
            Some(before) => {
                Piece { regime, lower: ends[before], upper: *upper, smoothness: Smoothness::Smooth }
            }
        };
        let pieces: Vec<Piece> = ends.iter().enumerate().map(piece).collect();
        let lane = [lane];
        let solve = |interference: &[f64], out: &mut Responses| {
            let stats = &mut SolverStats::default();
            exact.solve(regime, Numbered::alike(&lane), interference, out, stats);
        };
        let table = ResponseTable::new(&pieces, deepest, (TABLE_TOLERANCE, TABLE_HALVINGS), solve);
        Self { exact: Arc::clone(exact), fast: Arc::clone(fast), regime, joints, table }
    }
}

impl Law for PlasticRegime {
    fn radius_dependence(&self) -> RadiusDependence {
        self.exact.lambda().map_or(RadiusDependence::Formulas, RadiusDependence::Elastic)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let (loading, regime, own) = (&self.exact, self.regime, self.exact.lane());
        let place = |[place, joint]: &[f64; 2]| match lane {
            None => *joint,
            // ω is proportional to the radius.
            Some(lane) => {
                loading.displacement(regime, lane, place * lane.ratio) * loading.around.scale.length
            }
        };
        let mut joints: Vec<f64> = self.joints.iter().map(place).collect();
        joints.retain(|joint| within.start < *joint && *joint < within.end);
        joints.sort_by(f64::total_cmp);
        let first = loading.first_smoothness(regime, lane.unwrap_or(&own), within.start);
        Piece::cut(within, joints, std::iter::once(first).chain(std::iter::repeat(Smoothness::Smooth)))
    }

    fn method(&self, _: usize) -> Method {
        Method::Contact
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        if let Lanes::Each(lanes) = lanes {
            return self.fast.solve(self.regime, lanes, at, out, stats);
        }
        self.table.respond(at, out, |missing, out| {
            let lane = [self.exact.lane()];
            self.exact.solve(self.regime, Numbered::alike(&lane), missing, out, stats);
        });
    }
}
