//! Elastic asperities that each have a λ of their own, solved in blocks: the extended Maugis-Dugdale law of
//! [`super::emd`] with λ as a lane.
//!
//! Starting values are from tables over λ and the place on the branch (`starts.rs`). A Newton step follows, and
//! the outputs are corrected along a second. What is not good enough then is solved again on the safeguarded path.
//! Far from contact a series takes the place of solves (`far.rs`).

use super::block::BLOCK;
use super::branch::Branch;
use super::contact::Contact;
use super::curve::{Anchor, BranchCurve, corrected, last_step};
use super::far;
use super::folds::{contact_end, first_contact, first_outer, inner_fold, outer_fold};
use super::history::Path;
use super::noncontact::{Branches, Noncontact};
use super::outline::Ends;
use super::scale::LAMBDA_RANGE;
use super::starts::{Column, Starts, cell_of};
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use std::cell::RefCell;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Columns of the tables: this multiple of the root of |ln(λ/λ_first)|, for branches fold like a root from
/// λ_first on.
const COLUMNS: f64 = 14.0;
/// Root of the distance from the fold at which the place on the contact branch is half way.
const HALF_WAY: f64 = 2.0;
/// Newton steps one by one before a lane is left to the safeguarded path.
const MORE_STEPS: usize = 6;
/// λ up to which the branch before contact can be left for its inner part, and the columns of these λ.
const INNER: (f64, usize) = (1.12, 12);

/// An elastic asperity of one λ: the ends of its branches, and starting points of solves. The fields of one solve are next to each
/// other in memory.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Elastic {
    /// λ.
    pub lambda: f64,
    /// γλ^(3/2).
    stiffness: f64,
    /// ε at the outer fold before contact, 0 if there is none, and Δ there, or at first touch.
    fold: f64,
    reference: f64,
    /// 1/(Δ_reference − Δ) where the far series begins.
    per_span: f64,
    outer_starts: Column,
    /// θ and Δ at the end of the stable contact branch.
    contact_angle: f64,
    contact_end: f64,
    contact_starts: Column,
    /// Δ at first touch.
    first_touch: f64,
    inner_starts: Column,
    /// ε and Δ at the inner fold, of an asperity that comes out of contact onto the inner of two states before it.
    inner: Option<[f64; 2]>,
    /// Δ of a second fold to which the outermost state before contact lasts, of flattened summits; 0 if there is none.
    second: f64,
}

/// The tables of starting points for λ whose branch folds, and for smaller λ.
struct Tables {
    first: f64,
    with: Starts,
    without: Starts,
}

impl Tables {
    fn new(first: f64, with: fn(&Elastic, f64) -> f64, without: fn(&Elastic, f64) -> f64) -> Self {
        let columns = |ratio: f64| (COLUMNS * libm::log(ratio).sqrt()).ceil() as usize;
        let squared = |column: f64| (column / COLUMNS) * (column / COLUMNS);
        let limited = |lambda: f64| Elastic::branches(lambda.clamp(LAMBDA_RANGE.0, LAMBDA_RANGE.1));
        Self {
            first,
            with: Starts::new(columns(LAMBDA_RANGE.1 / first), move |column, place| {
                with(&limited(first * libm::exp(squared(column))), place)
            }),
            without: Starts::new(columns(first / LAMBDA_RANGE.0), move |column, place| {
                without(&limited(first * libm::exp(-squared(column))), place)
            }),
        }
    }

    /// The starts of λ, whose columns are √|ln(λ/λ_first)|.
    fn of(&'static self, lambda: f64) -> Column {
        let distance = libm::log(lambda) - libm::log(self.first);
        let column = COLUMNS * distance.abs().sqrt();
        if distance >= 0.0 { self.with.column(column) } else { self.without.column(column) }
    }
}

/// (θ_end/θ − 1)/s over s/(2 + s), s² = Δ − Δ_end.
static CONTACT: LazyLock<Tables> = LazyLock::new(|| {
    let sample = |of: &Elastic, place: f64| {
        let s = HALF_WAY * place / (1.0 - place);
        (of.contact_angle / of.contact_branch().locate(of.contact_end + s * s).0 - 1.0) / s
    };
    Tables::new(first_contact(), sample, sample)
});

/// (ε/ε_fold − 1)/s with a fold, and without one ε over that of an undeformed asperity, over s: s² is the share of
/// the way from the reference to where the far series begins.
static OUTER: LazyLock<Tables> = LazyLock::new(|| {
    fn displacement(of: &Elastic, place: f64) -> f64 {
        of.reference - place * place / of.per_span
    }
    fn gap(of: &Elastic, place: f64) -> f64 {
        of.outer_branch().locate(displacement(of, place)).0
    }
    Tables::new(
        first_outer(),
        |of, place| (gap(of, place) / of.fold - 1.0) / place,
        |of, place| gap(of, place) / of.rigid(displacement(of, place)),
    )
});

/// ε/ε_fold over the share of the way from the fold to first touch, on the inner part. Its columns begin where the branch
/// begins to fold, like a root.
static INNER_PART: LazyLock<Starts> = LazyLock::new(|| {
    Starts::new(INNER.1, |column, place| {
        let share = column / INNER.1 as f64;
        let of = Elastic::branches(first_outer() + share * share * (INNER.0 - first_outer()));
        let displacement = of.reference + place * (of.first_touch - of.reference);
        of.inner_branch(displacement).locate(displacement).0 / of.fold
    })
});

impl Elastic {
    /// The asperity of an adhesion parameter in [`LAMBDA_RANGE`].
    pub fn new(lambda: f64) -> Self {
        let inner = (lambda - first_outer()) / (INNER.0 - first_outer());
        Self {
            contact_starts: CONTACT.of(lambda),
            outer_starts: OUTER.of(lambda),
            inner_starts: INNER_PART.column(INNER.1 as f64 * inner.sqrt()),
            ..Self::branches(lambda)
        }
    }

    /// The asperity without starting points.
    fn branches(lambda: f64) -> Self {
        let contact_angle = contact_end(lambda);
        let contact = Contact::with_end(lambda, contact_angle);
        let first_touch = contact.first_touch();
        let contact_end =
            if contact_angle < FRAC_PI_2 { contact.at(contact_angle).displacement } else { first_touch };
        let whole = Noncontact::whole(lambda);
        let fold = outer_fold(lambda);
        let reference = fold.map_or(first_touch, |fold| whole.at(fold).displacement);
        let stiffness = far::stiffness(lambda);
        let far = -whole.spacing() * (far::nearest(stiffness) - 1.0);
        Self {
            lambda,
            contact_angle,
            contact_end,
            stiffness,
            first_touch,
            fold: fold.unwrap_or(0.0),
            reference,
            inner: inner_fold(lambda).map(|inner| [inner, whole.at(inner).displacement]),
            per_span: 1.0 / (reference - far),
            ..Self::default()
        }
    }

    /// The asperity of a flattened summit, whose states are solved by its outline.
    pub(super) fn of_ends(lambda: f64, ends: &Ends) -> Self {
        let [first, second] = ends.outer;
        Self {
            lambda,
            contact_end: ends.contact,
            first_touch: ends.first_touch,
            fold: first.map_or(0.0, |fold| fold.gap),
            reference: first.map_or(ends.first_touch, |fold| fold.displacement),
            inner: ends.inner.map(|fold| [fold.gap, fold.displacement]),
            second: second.map_or(0.0, |fold| fold.displacement),
            ..Self::default()
        }
    }

    /// Δ where contact begins or ends by the history; −δ_A in units of s_δ.
    pub fn end(&self, path: Path) -> f64 {
        match path {
            Path::Approach => self.first_touch,
            Path::Retraction => self.contact_end,
        }
    }

    /// θ at the end of the stable contact branch.
    pub fn contact_angle(&self) -> f64 {
        self.contact_angle
    }

    /// Δ at the end of the stable contact branch.
    pub fn contact_fold(&self) -> f64 {
        self.contact_end
    }

    /// Δ of the fold at which the branch before contact is left for its inner part, if that is before contact
    /// begins or ends by the history.
    pub fn noncontact_fold(&self, path: Path) -> Option<f64> {
        (self.fold > 0.0 && self.reference < self.end(path)).then_some(self.reference)
    }

    /// Δ of a second fold, at which the branch that follows the first is left, likewise.
    pub fn second_fold(&self, path: Path) -> Option<f64> {
        (self.second < 0.0 && self.second < self.end(path)).then_some(self.second)
    }

    /// Δ of the inner fold, to which an asperity that comes out of contact stays on the inner of two states before it.
    pub fn inner_fold(&self) -> Option<f64> {
        self.inner.map(|[_, displacement]| displacement)
    }

    /// Δ of the outer fold, if there is one.
    pub fn outer_fold(&self) -> Option<f64> {
        (self.fold > 0.0).then_some(self.reference)
    }

    /// Δ of the fold from which an asperity is on the innermost state, if there is one.
    pub fn innermost_fold(&self) -> Option<f64> {
        Some(self.second).filter(|second| *second < 0.0).or(self.outer_fold())
    }

    /// Whether an asperity that stays on the inner of two states is on it at Δ.
    #[inline(always)]
    fn is_held(&self, displacement: f64) -> bool {
        self.inner.is_some_and(|[_, end]| end <= displacement && displacement < self.reference)
    }

    /// F̂_s on the inner of two states.
    #[cold]
    fn held(&self, displacement: f64, stats: &mut SolverStats) -> f64 {
        let [parameter, end] = self.inner.unwrap_or_default();
        let anchor = Anchor { displacement: end, parameter, fold: true };
        let branch = Branch::new(Noncontact::up_to(self.lambda, parameter), anchor);
        branch.solve(displacement, stats).adhesion
    }

    /// z₀, the gap of an undeformed asperity.
    pub fn rigid_gap(&self, displacement: f64) -> f64 {
        1.0 + self.rigid(displacement)
    }

    /// ε of an undeformed asperity.
    #[inline(always)]
    fn rigid(&self, displacement: f64) -> f64 {
        -displacement / Noncontact::whole(self.lambda).spacing()
    }

    fn contact_branch(&self) -> Branch<Contact> {
        let anchor = Anchor { displacement: self.contact_end, parameter: self.contact_angle, fold: true };
        Branch::new(Contact::with_end(self.lambda, self.contact_angle), anchor)
    }

    fn branches_before(&self) -> Branches {
        Noncontact::branches_at(self.lambda, Some(self.fold).filter(|fold| *fold > 0.0))
    }

    fn outer_branch(&self) -> Branch<Noncontact> {
        let (displacement, fold) = (self.reference, self.fold > 0.0);
        match self.branches_before() {
            Branches::Single(curve) => Branch::new(curve, Anchor { displacement, parameter: f64::NAN, fold }),
            Branches::Folded { outer, fold: parameter, .. } => {
                Branch::new(outer, Anchor { displacement, parameter, fold })
            }
        }
    }

    fn inner_branch(&self, displacement: f64) -> Branch<Noncontact> {
        let anchor = Anchor { displacement, parameter: f64::NAN, fold: false };
        match self.branches_before() {
            Branches::Single(curve) | Branches::Folded { inner: curve, .. } => Branch::new(curve, anchor),
        }
    }
}

/// The bit of the sign of a number, which NaN may have.
const SIGN: u32 = 1 << 31;
/// Lanes that are computed together.
const VECTOR: usize = 8;

/// Rounds a number of lanes up to whole vectors.
#[inline(always)]
fn whole_vectors(count: usize) -> usize {
    count.min(BLOCK).div_ceil(VECTOR) * VECTOR
}

/// Lanes of a block, each quantity on cache lines of its own.
#[repr(align(64))]
struct Lanes {
    lambda: [f64; BLOCK],
    /// Parameter and Δ at the end of the branch.
    ends: [f64; BLOCK],
    displacements: [f64; BLOCK],
    /// Root of the distance along the branch, and the cell of the table and the place in it.
    roots: [f64; BLOCK],
    rows: [u32; BLOCK],
    places: [f64; BLOCK],
    /// Values of the table there.
    starts: [f64; BLOCK],
    parameters: [f64; BLOCK],
    terms: [[f64; BLOCK]; 4],
    adhesion: [f64; BLOCK],
    radius: [f64; BLOCK],
    residual: [f32; BLOCK],
}

thread_local! {
    static LANES: RefCell<Box<Lanes>> = RefCell::new(Box::new(Lanes {
        lambda: [1.0; BLOCK],
        ends: [1.0; BLOCK],
        displacements: [0.0; BLOCK],
        roots: [0.0; BLOCK],
        rows: [0; BLOCK],
        places: [0.0; BLOCK],
        starts: [0.0; BLOCK],
        parameters: [f64::NAN; BLOCK],
        terms: [[0.0; BLOCK]; 4],
        adhesion: [0.0; BLOCK],
        radius: [0.0; BLOCK],
        residual: [0.0; BLOCK],
    }));
}

impl Lanes {
    /// A Newton step, and a second one to correct the outputs along, of every lane. `FOLD` says whether branches end
    /// at folds.
    #[inline(always)]
    fn solve<C: BranchCurve, const FOLD: bool>(
        &mut self,
        count: usize,
        curve: impl Fn(f64, f64) -> C,
        is_on_branch: impl Fn(f64, f64) -> bool,
    ) {
        let count = whole_vectors(count);
        let Self { lambda, ends, displacements, parameters, terms, adhesion, radius, residual, .. } = self;
        let [first, second, third, fourth] = terms;
        for pass in 0..2 {
            for i in 0..count {
                [first[i], second[i], third[i], fourth[i]] = curve(lambda[i], ends[i]).terms(parameters[i]);
            }
            if pass == 0 {
                for i in 0..count {
                    let x = parameters[i];
                    let state =
                        curve(lambda[i], ends[i]).state(x, [first[i], second[i], third[i], fourth[i]]);
                    parameters[i] = x + (displacements[i] - state.displacement) / state.slope;
                }
            }
        }
        for i in 0..count {
            let (x, displacement) = (parameters[i], displacements[i]);
            let state = curve(lambda[i], ends[i]).state(x, [first[i], second[i], third[i], fourth[i]]);
            let anchor = Anchor { displacement, parameter: ends[i], fold: FOLD };
            let (step, good) = last_step(&anchor, x, &state, displacement, 1.0 / state.slope);
            let solution = corrected(&state, step);
            (adhesion[i], radius[i]) = (solution.adhesion, solution.radius);
            let off = (displacement - state.displacement).abs() as f32 / state.magnitude as f32;
            residual[i] = if good & (state.slope < 0.0) & is_on_branch(x, ends[i]) { off } else { f32::NAN };
        }
    }

    /// Solves the lanes again that are not good enough; no parameter is above `largest`.
    fn finish<C: BranchCurve, const FOLD: bool>(
        &mut self,
        (count, largest): (usize, f64),
        curve: impl Fn(f64, f64) -> C,
        branch: impl Fn(usize) -> Branch<C>,
        is_on_branch: impl Fn(f64, f64) -> bool,
        stats: &mut SolverStats,
    ) {
        stats.evaluations += 2 * count as u64;
        // The bits of numbers that are not negative are in their order, and the bits of NaN above all.
        let most = |residual: &[f32]| {
            f32::from_bits(residual.iter().fold(0, |most, off| most.max(off.to_bits() & !SIGN)))
        };
        let largest_residual = InstructionSet::current().run(
            #[inline(always)]
            || most(&self.residual[..count]),
        );
        if !largest_residual.is_nan() {
            stats.largest_residual = stats.largest_residual.max(f64::from(largest_residual));
            return;
        }
        for i in 0..count {
            if !self.residual[i].is_nan() {
                stats.largest_residual = stats.largest_residual.max(f64::from(self.residual[i]));
                continue;
            }
            let (displacement, end) = (self.displacements[i], self.ends[i]);
            let curve = curve(self.lambda[i], end);
            let anchor = Anchor { displacement, parameter: end, fold: FOLD };
            let mut x = self.parameters[i];
            let mut solution = None;
            for _ in 0..MORE_STEPS {
                let state = curve.at(x);
                stats.evaluations += 1;
                let (step, good) = last_step(&anchor, x, &state, displacement, 1.0 / state.slope);
                if !(x >= 0.0 && x <= largest && state.slope < 0.0) {
                    break;
                }
                if good && is_on_branch(x, end) {
                    solution = Some(corrected(&state, step));
                    let off = (displacement - state.displacement).abs() / state.magnitude;
                    stats.largest_residual = stats.largest_residual.max(off);
                    break;
                }
                x += (displacement - state.displacement) / state.slope;
            }
            let solution = solution.unwrap_or_else(|| branch(i).solve(displacement, stats));
            (self.adhesion[i], self.radius[i]) = (solution.adhesion, solution.radius);
        }
    }
}

/// F̂_s and A of asperities in contact at displacements Δ, at most [`BLOCK`]; those below the end of the branch are
/// taken as the end. `of` gives the asperity of a lane.
pub fn contact<'a>(
    of: impl Fn(usize) -> &'a Elastic,
    displacements: &[f64],
    adhesion: &mut [f64],
    radius: &mut [f64],
    stats: &mut SolverStats,
) {
    let count = displacements.len();
    LANES.with_borrow_mut(|lanes| {
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (i, displacement) in displacements.iter().enumerate() {
                    let own = of(i);
                    lanes.lambda[i] = own.lambda;
                    lanes.ends[i] = own.contact_angle;
                    lanes.roots[i] = own.contact_end;
                    lanes.displacements[i] = displacement.max(own.contact_end);
                }
                for i in 0..whole_vectors(count) {
                    let s = (lanes.displacements[i] - lanes.roots[i]).sqrt();
                    lanes.roots[i] = s;
                    (lanes.rows[i], lanes.places[i]) = cell_of(s / (HALF_WAY + s));
                }
                for i in 0..count {
                    lanes.starts[i] = of(i).contact_starts.value((lanes.rows[i], lanes.places[i]));
                }
                for i in 0..whole_vectors(count) {
                    lanes.parameters[i] = lanes.ends[i] / (1.0 + lanes.roots[i] * lanes.starts[i]);
                }
                lanes.solve::<Contact, true>(count, Contact::with_end, |x, end| x <= end);
            },
        );
        lanes.finish::<Contact, true>(
            (count, FRAC_PI_2),
            Contact::with_end,
            |i| of(i).contact_branch(),
            |x, end| x <= end,
            stats,
        );
        adhesion[..count].copy_from_slice(&lanes.adhesion[..count]);
        radius[..count].copy_from_slice(&lanes.radius[..count]);
    });
}

/// F̂_s of asperities before contact at displacements Δ, at most [`BLOCK`], below the beginning or end of contact: of the outermost
/// state, or with `stays` of the inner of two states if they have been on it. `of` gives the asperity of a lane, and `gap` its rigid
/// gap z₀.
pub fn noncontact<'a>(
    of: impl Fn(usize) -> &'a Elastic,
    gap: impl Fn(usize) -> f64,
    (displacements, stays): (&[f64], bool),
    adhesion: &mut [f64],
    stats: &mut SolverStats,
) {
    let count = displacements.len().min(BLOCK);
    let (displacements, adhesion) = (&displacements[..count], &mut adhesion[..count]);
    LANES.with_borrow_mut(|lanes| {
        let mut near = Chosen::default();
        let any_inner = InstructionSet::current().run(
            #[inline(always)]
            || {
                for (i, displacement) in displacements.iter().enumerate() {
                    let own = of(i);
                    lanes.roots[i] = (own.reference - displacement) * own.per_span;
                }
                lanes.roots[..count].iter().enumerate().for_each(|(i, share)| near.add(i, *share <= 1.0));
                if near.count < count {
                    for i in 0..count {
                        (lanes.places[i], lanes.starts[i]) = (gap(i), of(i).stiffness);
                    }
                    let far = lanes.places.iter().zip(&lanes.starts);
                    for (adhesion, (gap, stiffness)) in adhesion.iter_mut().zip(far) {
                        *adhesion = far::attraction(*gap, *stiffness);
                    }
                }
                lanes.roots[..count].iter().fold(false, |any, share| any | (*share <= 0.0))
            },
        );
        stats.far += (count - near.count) as u64;
        if stays {
            let held;
            [held, near] = near.split(|i| of(i).is_held(displacements[i]));
            held.lanes().for_each(|i| adhesion[i] = of(i).held(displacements[i], stats));
        }
        if any_inner {
            let inner;
            [inner, near] = near.split(|i| lanes.roots[i] <= 0.0 && of(i).fold > 0.0);
            if inner.count > 0 {
                lanes.inner(&inner, &of, displacements, adhesion, stats);
            }
        }
        if near.count > 0 {
            lanes.outer(&near, &of, displacements, adhesion, stats);
        }
    });
}

/// Some lanes of a block.
struct Chosen {
    lanes: [u8; BLOCK],
    count: usize,
}

impl Default for Chosen {
    fn default() -> Self {
        Self { lanes: [0; BLOCK], count: 0 }
    }
}

impl Chosen {
    /// Adds a lane if it is chosen, without a branch of the program.
    #[inline(always)]
    fn add(&mut self, lane: usize, is_one: bool) {
        self.lanes[self.count % BLOCK] = lane as u8;
        self.count += usize::from(is_one);
    }

    /// The lanes that meet a condition, and the others.
    fn split(&self, is_of: impl Fn(usize) -> bool) -> [Self; 2] {
        let [mut chosen, mut others] = [Self::default(), Self::default()];
        for i in self.lanes() {
            let is_chosen = is_of(i);
            chosen.add(i, is_chosen);
            others.add(i, !is_chosen);
        }
        [chosen, others]
    }

    #[inline(always)]
    fn lanes(&self) -> impl Iterator<Item = usize> + '_ {
        self.lanes[..self.count].iter().map(|lane| usize::from(*lane))
    }
}

/// The curve before contact without its ends.
#[inline(always)]
fn uncut(lambda: f64, _: f64) -> Noncontact {
    Noncontact::whole(lambda)
}

impl Lanes {
    /// Solves chosen lanes on the outermost branch. Without a fold it ends at ε = 0.
    fn outer<'a>(
        &mut self,
        chosen: &Chosen,
        of: impl Fn(usize) -> &'a Elastic,
        displacements: &[f64],
        adhesion: &mut [f64],
        stats: &mut SolverStats,
    ) {
        let is_on_branch = |gap: f64, fold: f64| gap >= fold;
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (lane, i) in chosen.lanes().enumerate() {
                    let own = of(i);
                    self.lambda[lane] = own.lambda;
                    self.ends[lane] = own.fold;
                    self.displacements[lane] = displacements[i].min(own.reference);
                    // Lanes move towards the first.
                    self.roots[lane] = self.roots[i];
                }
                let whole = whole_vectors(chosen.count);
                for lane in 0..whole {
                    let root = self.roots[lane].max(0.0).sqrt();
                    self.roots[lane] = root;
                    (self.rows[lane], self.places[lane]) = cell_of(root);
                }
                for (lane, i) in chosen.lanes().enumerate() {
                    self.starts[lane] = of(i).outer_starts.value((self.rows[lane], self.places[lane]));
                }
                for lane in 0..whole {
                    let (end, start) = (self.ends[lane], self.starts[lane]);
                    let rigid = self.displacements[lane] * self.lambda[lane] * -Noncontact::PER_SPACING;
                    let folded = end * (1.0 + self.roots[lane] * start);
                    self.parameters[lane] = if end > 0.0 { folded } else { rigid * start };
                }
                self.solve::<Noncontact, true>(chosen.count, uncut, is_on_branch);
            },
        );
        let branch = |lane: usize| of(usize::from(chosen.lanes[lane])).outer_branch();
        self.finish::<Noncontact, true>((chosen.count, f64::INFINITY), uncut, branch, is_on_branch, stats);
        chosen.lanes().enumerate().for_each(|(lane, i)| adhesion[i] = self.adhesion[lane]);
    }

    /// Solves lanes on the inner part, beyond the fold.
    fn inner<'a>(
        &mut self,
        chosen: &Chosen,
        of: impl Fn(usize) -> &'a Elastic,
        displacements: &[f64],
        adhesion: &mut [f64],
        stats: &mut SolverStats,
    ) {
        let is_on_branch = |gap: f64, fold: f64| gap <= fold;
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (lane, i) in chosen.lanes().enumerate() {
                    let own = of(i);
                    let place = (displacements[i] - own.reference) / (own.first_touch - own.reference);
                    self.lambda[lane] = own.lambda;
                    self.ends[lane] = own.fold;
                    self.displacements[lane] = displacements[i];
                    self.parameters[lane] = own.inner_starts.value(cell_of(place)) * own.fold;
                }
                self.solve::<Noncontact, false>(chosen.count, uncut, is_on_branch);
            },
        );
        let branch = |lane: usize| {
            let i = usize::from(chosen.lanes[lane]);
            of(i).inner_branch(displacements[i])
        };
        self.finish::<Noncontact, false>((chosen.count, f64::INFINITY), uncut, branch, is_on_branch, stats);
        chosen.lanes().enumerate().for_each(|(lane, i)| adhesion[i] = self.adhesion[lane]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::emd::Emd;

    /// Numbers spread evenly over 0..1.
    fn spread(seed: usize, count: usize) -> impl Iterator<Item = f64> {
        (0..count).map(move |i| ((seed * 31 + i + 1) as f64 * 0.618_033_988_749_894_9).fract())
    }

    /// Adhesion parameters of which each lane has one: all that there are, and close to both first folds.
    fn lambdas(count: usize) -> Vec<f64> {
        let ranges = [LAMBDA_RANGE, (0.3, 1.6), (0.888, 0.9), (0.93, 0.945), (1.0, 10.0)];
        let of = |(k, (low, high)): (usize, (f64, f64))| {
            spread(k, count).map(move |x| (low * libm::exp(x * libm::log(high / low))).clamp(low, high))
        };
        ranges.into_iter().enumerate().flat_map(of).collect()
    }

    struct Solved {
        contact: [Vec<f64>; 2],
        before: Vec<f64>,
        stats: SolverStats,
    }

    /// All lanes at Δ beyond the ends of their branches by `distances`, in contact and before it.
    fn solved(asperities: &[Elastic], path: Path, distances: &[f64], block: usize) -> Solved {
        let count = asperities.len();
        let (mut contacts, mut before) = ([vec![0.0; count], vec![0.0; count]], vec![0.0; count]);
        let mut stats = SolverStats::default();
        for begin in (0..count).step_by(block) {
            let range = begin..count.min(begin + block);
            let of = |i: usize| &asperities[begin + i];
            let deep: Vec<f64> = range.clone().map(|i| asperities[i].end(path) + distances[i]).collect();
            let [adhesion, radius] = &mut contacts;
            contact(of, &deep, &mut adhesion[range.clone()], &mut radius[range.clone()], &mut stats);
            let far: Vec<f64> = range
                .clone()
                .map(|i| asperities[i].end(path) - (1e-9 + distances[i]) / asperities[i].per_span.min(1.0))
                .collect();
            let gap = |i: usize| of(i).rigid_gap(far[i]);
            noncontact(of, gap, (&far, false), &mut before[range.clone()], &mut stats);
        }
        Solved { contact: contacts, before, stats }
    }

    /// The law of each λ by itself, which has no table that is shared.
    #[test]
    fn lanes_have_the_law_of_their_own_lambda() {
        let lambdas = lambdas(300);
        let asperities: Vec<Elastic> = lambdas.iter().map(|lambda| Elastic::new(*lambda)).collect();
        let distances: Vec<f64> =
            spread(9, lambdas.len()).map(|x| if x < 0.3 { 0.02 * x } else { 20.0 * x * x }).collect();
        for path in [Path::Approach, Path::Retraction] {
            let solved = solved(&asperities, path, &distances, BLOCK);
            assert_eq!(solved.stats.safeguarded, 0);
            for (i, own) in asperities.iter().enumerate() {
                let emd = Emd::new(own.lambda, path).unwrap();
                let close = |mine: f64, truth: f64, tolerance: f64| {
                    let off = (mine - truth).abs() / truth.abs();
                    assert!(
                        off <= tolerance,
                        "λ {} {path:?} {}: {mine:e} {truth:e}",
                        own.lambda,
                        distances[i]
                    );
                };
                close(own.end(path), emd.end(), 8.0 * f64::EPSILON);
                let deep = emd.contact(own.end(path) + distances[i], &mut SolverStats::default());
                // At a fold both vary like the root of a distance that is rounded, and so do neighbours of λ_f.
                let condition = 1.0 + 1.0 / (distances[i] + 1e-13).sqrt().powi(3).min(1.0);
                close(solved.contact[0][i], deep.adhesion, 60.0 * f64::EPSILON * condition);
                close(solved.contact[1][i], deep.radius, 60.0 * f64::EPSILON * condition);
                let far = own.end(path) - (1e-9 + distances[i]) / own.per_span.min(1.0);
                let far = emd.noncontact(far, &mut SolverStats::default());
                if own.noncontact_fold(path).is_none_or(|fold| (fold - own.end(path)).abs() > 1e-3) {
                    close(solved.before[i], far.adhesion, 1e-12);
                }
            }
        }
    }

    #[test]
    fn bits_depend_on_no_instruction_set_and_no_neighbour() {
        let lambdas = lambdas(100);
        let asperities: Vec<Elastic> = lambdas.iter().map(|lambda| Elastic::new(*lambda)).collect();
        let distances: Vec<f64> = spread(4, lambdas.len()).map(|x| 20.0 * x * x * x).collect();
        let bits = |solved: Solved| -> Vec<u64> {
            let [adhesion, radius] = solved.contact;
            [adhesion, radius, solved.before].concat().into_iter().map(f64::to_bits).collect()
        };
        let mut all = Vec::new();
        for set in InstructionSet::available() {
            set.select();
            for block in [BLOCK, 100, 7, 1] {
                all.push(bits(solved(&asperities, Path::Approach, &distances, block)));
            }
        }
        assert!(all.iter().all(|bits| *bits == all[0]));
    }
}
