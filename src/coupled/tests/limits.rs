//! Coupled asperities where there are closed forms or scalar roots (`scripts/reference_coupling_limits.py`).

use super::*;
use crate::math::moments::Moments;
use crate::substrate::Influence;

const LIMITS: &str = include_str!("../../../tests/data/coupling_limits.json");
/// The self term of a square lattice, 4ζ(½)β(½).
const OWN: f64 = -3.900_264_920_001_956;

/// The numbers that stand under names.
fn named<const N: usize>(value: &Value, names: [&str; N]) -> [f64; N] {
    names.map(|name| value[name].as_f64().unwrap())
}

/// The asperity of the references.
fn reference(all: &Value) -> Asperity {
    let [radius, modulus, work] = named(all, ["asperity_radius", "reduced_modulus", "work_of_adhesion"]);
    asperity(radius, modulus, work)
}

/// A surface at one separation of its way: δ, m, and P − F_s, N, of each asperity.
struct State {
    interference: Vec<f64>,
    forces: Vec<f64>,
    settled: Settled,
    /// J.
    lost: f64,
}

impl State {
    fn total(&self) -> f64 {
        self.forces.iter().sum()
    }
}

/// Asperities of one radius, under a law, on a substrate that is softer than theirs by a factor.
struct Surface<'a> {
    law: &'a str,
    coupling: Coupling,
    side: f64,
    places: Vec<[f64; 2]>,
    heights: Vec<f64>,
    softness: f64,
    kernel: Kernel,
}

impl Surface<'_> {
    /// Two of the height 0, a distance, m, apart.
    fn pair(law: &str, distance: f64) -> Surface<'_> {
        let side = 4.0 * distance;
        let places = vec![[0.25, 0.5], [0.5, 0.5]];
        Surface {
            law,
            coupling: Coupling::Patch,
            side,
            places,
            heights: vec![0.0; 2],
            softness: 1.0,
            kernel: Kernel::Point,
        }
    }

    /// Goes through separations d, m, in their order.
    fn travel(&self, of: &Asperity, path: &[f64]) -> Vec<State> {
        let model = model(self.law).unwrap();
        let parameters = parameters(of, Path::Approach);
        let cycle = Loop::new(&model, &parameters).unwrap();
        let law = model.law(&parameters).unwrap();
        let memory = match self.law {
            "jkr" => Hysteresis::Loop(MaybeOwned::Shared(&cycle)),
            _ => Hysteresis::None(MaybeOwned::Shared(law.as_ref())),
        };
        let compliance = self.softness / (PI * of.reduced_modulus * self.side);
        let half_space = HalfSpace::new(self.coupling, self.places.clone(), compliance, 1e-13);
        let half_space = of_kernel(self.kernel, half_space, self.side, &vec![of.radius; self.heights.len()]);
        let laws = vec![RadiusLaws::new(memory, parameters.scale.length)];
        let asperities = Asperities::new(laws, vec![0; self.heights.len()]);
        let mut solver = Solver::new(asperities, half_space, &self.heights, 1e-13);
        solver.begin(path[0]);
        let go = |&d: &f64| {
            let settled = solver.settle(d);
            assert!(settled.is_converged, "{} {:?} {d:e}: {settled:?}", self.law, self.coupling);
            let lost = solver.energy_lost();
            let forces = solver.forces.contact.iter().zip(&solver.forces.adhesion);
            State {
                interference: solver.interference.clone(),
                forces: forces.map(|(contact, adhesion)| contact - adhesion).collect(),
                settled,
                lost,
            }
        };
        path.iter().map(go).collect()
    }
}

/// Evenly spaced separations from one to another.
fn steps(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found:e} {expected:e}");
}

/// Two spheres of Hertz: f = (4/3) E* √R δ^(3/2) with δ + f/(πE*r) = −d, by bisection.
#[test]
fn two_spheres_meet_the_root_of_one_equation() {
    let all = json(LIMITS);
    let of = reference(&all);
    for distance in [1e-7, 2e-7, 1e-6] {
        let surface = Surface::pair("hertz", distance);
        let path = steps(0.0, -4e-9, 8);
        for (state, d) in surface.travel(&of, &path).iter().zip(path).skip(1) {
            let force = |delta: f64| 4.0 / 3.0 * of.reduced_modulus * of.radius.sqrt() * delta.powf(1.5);
            let (mut low, mut high) = (0.0, -d);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                let beyond = middle + force(middle) / (PI * of.reduced_modulus * distance) + d;
                *(if beyond > 0.0 { &mut high } else { &mut low }) = middle;
            }
            for own in &state.forces {
                assert_close(*own, force(low), 1e-12 * force(low), "force");
            }
        }
    }
}

/// Pulled off together two spheres of JKR hold F_c each under point forces, where they are further by F_c/(πE*r); what
/// the next orders change, +0.212 (a_c/r)³, is not theirs.
#[test]
fn neighbours_shift_the_pull_off_and_do_not_change_it() {
    let all = json(LIMITS);
    let of = reference(&all);
    for pair in all["jkr_pairs"].as_array().unwrap() {
        let [distance, single, alone] = named(pair, ["distance", "single_pull_off", "single_separation"]);
        let [place, radius, contact] = named(pair, ["point_separation", "single_radius", "contact_pull_off"]);
        let shift = single / (PI * of.reduced_modulus * distance);
        assert_close(place, alone + shift, 1e-12 * place, "reference");
        let order = 0.212 * (radius / distance).powi(3);
        assert_close(contact / single - 1.0, order, 0.05 * order, "reference");
        let path = [steps(-2e-9, place, 20), vec![place + 2e-12, place + 4e-12]].concat();
        let way = Surface::pair("jkr", distance).travel(&of, &path);
        for state in &way {
            assert!(state.settled.avalanches.count == 0, "{:?}", state.settled);
            assert!(state.forces.iter().all(|force| *force >= -single * (1.0 + 1e-13)), "{:?}", state.forces);
        }
        for (force, delta) in way[20].forces.iter().zip(&way[20].interference) {
            assert_close(-force, single, 1e-12 * single, "pull-off");
            // δ, not f, tells the place: f is flat there.
            assert_close(*delta, -alone, 1e-8 * alone, "interference at pull-off");
        }
        assert!(way[17].forces[0] > way[20].forces[0] && way[22].forces[0] > way[20].forces[0]);
    }
}

/// A pair that attracts more stiffly than 1/(πE*r) jumps where Johnson has it, to where it has to go, and loses what it has
/// to; elsewhere it loses nothing.
#[test]
fn pairs_jump_at_their_folds() {
    const BESIDE: f64 = 1e-14;
    let all = json(LIMITS);
    for fold in all["folds"].as_array().unwrap() {
        let [distance, radius, work] = named(fold, ["distance", "radius", "work_of_adhesion"]);
        let of = Asperity { radius, work_of_adhesion: work, ..reference(&all) };
        for (name, far, sign) in [("jump_in", 3e-9, 1.0), ("jump_off", -3e-9, -1.0)] {
            let jump = &fold[name];
            let [place, before, after] = named(jump, ["separation", "approach_before", "approach_after"]);
            let [force, lost] = named(jump, ["force_after", "energy_lost"]);
            let mut path = steps(place + far, place + sign * BESIDE, 60);
            path.push(place - sign * BESIDE);
            let way = Surface::pair("idmt", distance).travel(&of, &path);
            let of_none = way.iter().filter(|state| state.lost == 0.0).count();
            assert_eq!((of_none, way.len()), (61, 62), "{name}");
            // Beyond the fold by a little, to the next order, which goes like the power 3/2.
            let [old] = named(jump, ["force_before"]);
            let beyond = 2.0 * (old - force) * sign * BESIDE;
            assert_close(way[61].lost, lost + beyond, 1e-5 * lost + 0.1 * beyond.abs(), name);
            for k in 0..2 {
                // A root: δ goes like the root of the distance from the fold.
                let root = (BESIDE * of.equilibrium_spacing).sqrt();
                assert_close(way[60].interference[k], before, 3.0 * root, name);
                assert_close(way[61].interference[k], after, 20.0 * BESIDE, name);
                assert_close(way[61].forces[k], force, 1e-3 * force.abs(), name);
            }
        }
        // Further apart there is none.
        let [largest] = named(fold, ["largest_distance"]);
        let far = Surface::pair("idmt", 1.2 * largest);
        let path = steps(1e-9, 0.0, 25);
        let [inward, outward] =
            [path.clone(), path.into_iter().rev().collect()].map(|path| far.travel(&of, &path));
        for (inward, outward) in inward.iter().zip(outward.iter().rev()) {
            assert_close(inward.forces[0], outward.forces[0], 1e-10 * inward.forces[0].abs(), "both ways");
        }
    }
}

/// The total force changes by −Σ f′_i G_ij f_j on substrates that are a thousand times stiffer.
#[test]
fn the_first_order_in_the_compliance_is_its_closed_form() {
    let (all, surfaces) = (json(LIMITS), json(REFERENCES));
    let of = reference(&all);
    for row in all["first_order"].as_array().unwrap() {
        let [name, law, coupling] = ["surface", "law", "coupling"].map(|name| row[name].as_str().unwrap());
        let given = Given::new(&surfaces["surfaces"][name]);
        let [d, independent, change] = named(row, ["separation", "independent", "change"]);
        let total = |softness: f64| {
            let Given { side, places, heights, .. } = &given;
            let coupling = Coupling::ALL.into_iter().find(|(name, _)| *name == coupling).unwrap().1;
            let (places, heights) = (places.clone(), heights.clone());
            let surface =
                Surface { law, coupling, side: *side, places, heights, softness, kernel: Kernel::Point };
            surface.travel(&of, &[d + 20e-9, d])[1].total()
        };
        assert_close(total(1e-9), independent, 1e-7 * independent.abs(), name);
        let [one, half] = [1e-3, 5e-4].map(|softness| (total(softness) - independent) / softness);
        assert_close(2.0 * half - one, change, 1e-5 * change.abs(), name);
    }
}

/// G over hard-core places has its closed form on average, and so has the first order of the total force over these and
/// Gaussian heights, −(⟨f⟩⟨f′⟩ Σ G_ij + ⟨f f′⟩ Σ G_ii): within 4 standard errors (of 6 means, by chance in 1 of 2000).
// The second half takes the mean of G that the first has met.
#[test]
fn hard_core_places_have_the_first_order_of_their_closed_form() {
    let all = json(LIMITS);
    let of = reference(&all);
    let random = &mut stream(17, Purpose::Places, 0);
    let mut mean_of_thirty = 0.0;
    for row in all["hard_core"].as_array().unwrap() {
        let [distance, expected] = named(row, ["minimum_distance", "mean"]);
        let count = row["count"].as_u64().unwrap() as usize;
        let draw = |_| {
            let places = Places::HardCore(distance).draw(random, (count, 1.0), Coupling::Periodic);
            let mut found = vec![0.0; count];
            let loads: Vec<f64> = (0..count).map(|i| f64::from(u8::from(i == 0))).collect();
            let mut sums = crate::substrate::DisplacementSums::<f64>::new(
                Coupling::Periodic,
                Influence::Displacement,
                &places,
                1e-6,
            );
            sums.apply(&loads, &mut found);
            found[1..].iter().sum::<f64>() / (count - 1) as f64
        };
        let moments = Moments::of((0..800).map(draw));
        let error = moments.standard_error()[0].hypot(row["standard_error"].as_f64().unwrap_or(0.0));
        assert_close(moments.mean()[0], expected, 4.0 * error, "mean of G");
        mean_of_thirty = expected;
    }
    let (side, count, softness) = (1e-6, 30, 1e-4);
    let means = &all["hertz_means"];
    let [std] = named(means, ["std"]);
    // Further apart too few touch.
    for row in &means["separations"].as_array().unwrap()[..2] {
        let [d, force, slope, both] = named(row, ["separation", "force", "slope", "force_times_slope"]);
        let pairs = (count * (count - 1)) as f64 * force * slope * mean_of_thirty;
        let expected = -(pairs + count as f64 * both * OWN) / (PI * of.reduced_modulus * side);
        let draw = |index: u64| {
            let mut heights = vec![0.0; count];
            Heights::gaussian(std).draw(&mut stream(18, Purpose::Heights, index), &mut heights);
            heights.sort_by(f64::total_cmp);
            let random = &mut stream(18, Purpose::Places, index);
            let places = Places::HardCore(0.09 * side).draw(random, (count, side), Coupling::Periodic);
            let own = |softness| {
                let (places, heights) = (places.clone(), heights.clone());
                let (law, coupling) = ("hertz", Coupling::Periodic);
                let surface =
                    Surface { law, coupling, side, places, heights, softness, kernel: Kernel::Point };
                surface.travel(&of, &[d + 20e-9, d])[1].total()
            };
            (own(softness) - own(1e-9 * softness)) / softness
        };
        let moments = Moments::of((0..120).map(draw));
        let error = moments.standard_error()[0];
        assert!(error < 0.3 * expected.abs(), "{error:e} {expected:e}: nothing would be tested");
        assert_close(moments.mean()[0], expected, 4.0 * error, "first order");
    }
}

/// Spheres of Hertz of one height in a square of a side, m, that repeats.
fn flat(side: f64, places: Vec<[f64; 2]>, kernel: Kernel) -> Surface<'static> {
    let (law, coupling, heights) = ("hertz", Coupling::Periodic, vec![0.0; places.len()]);
    Surface { law, coupling, side, places, heights, softness: 1.0, kernel }
}

/// One sphere of Hertz in a square that repeats, and 2 × 2 and 3 × 3 of them at once: force to 1e-12, near
/// the end of its states to the rounding of the separation.
#[test]
fn cells_of_one_sphere_are_one_cell() {
    let all = json(LIMITS);
    let of = reference(&all);
    let [cell, end] =
        [all["lattice"]["cell"].as_f64().unwrap(), all["lattice"]["end_radius"].as_f64().unwrap()];
    for n in [1, 2, 3] {
        let place = |i: usize| [(0.3 + (i % n) as f64) / n as f64, (0.6 + (i / n) as f64) / n as f64];
        let places: Vec<[f64; 2]> = (0..n * n).map(place).collect();
        let surface = flat(n as f64 * cell, places, Kernel::Point);
        let states = all["lattice"]["states"].as_array().unwrap();
        let path: Vec<f64> = states.iter().map(|state| state["point_separation"].as_f64().unwrap()).collect();
        for (found, expected) in surface.travel(&of, &path).iter().zip(states) {
            let [radius, force] = named(expected, ["radius", "point_force"]);
            let tolerance = 1e-12 / (1.0 - radius / end);
            for own in &found.forces {
                assert_close(own / force, 1.0, tolerance, &format!("{n} x {n}, a = {radius:e}"));
            }
        }
    }
}

/// The loads of finite contacts differ from the loads of point forces by −(8 S/15π)(a/L)³ at the same
/// separation, S = Σ 1/n³.
#[test]
fn what_point_forces_leave_out_of_a_lattice_is_of_third_order() {
    let all = json(LIMITS);
    let (of, lattice) = (reference(&all), &all["lattice"]);
    let [cell, order] = named(lattice, ["cell", "order_three"]);
    let surface = flat(cell, vec![[0.5, 0.5]], Kernel::Point);
    let states = &lattice["states"].as_array().unwrap()[..4];
    let path: Vec<f64> = states.iter().map(|state| state["contact_separation"].as_f64().unwrap()).collect();
    let found = surface.travel(&of, &path);
    let orders = found.iter().zip(states).map(|(point, contact)| {
        let [radius, force] = named(contact, ["radius", "contact_force"]);
        (radius / cell, (force / point.forces[0] - 1.0) / (radius / cell).powi(3))
    });
    for (share, found) in orders {
        assert_close(found / order, 1.0, 4.0 * share, &format!("a = {share} L"));
    }
}

/// One sphere of Hertz with a contact of finite size in a square that repeats: f = K a³/R_eff,
/// 1/R_eff = 1/R + S f/(2πE*L³), −d = a²/R_eff + f (c/L + S a²/10L³)/(πE*), to 1e-12; and from all orders they
/// are off by less than 0.6 (a/L)⁵.
#[test]
fn a_lattice_of_finite_contacts_has_its_closed_form() {
    let all = json(LIMITS);
    let (of, lattice) = (reference(&all), &all["lattice"]);
    let [cell, cubes] = named(lattice, ["cell", "cubes"]);
    let surface = flat(cell, vec![[0.5, 0.5]], Kernel::Contact);
    let states = &lattice["states"].as_array().unwrap()[..7];
    let exact = states.iter().map(|state| {
        let [radius, force] = named(state, ["radius", "contact_force"]);
        let bent = 4.0 / 3.0 * of.reduced_modulus * radius.powi(3) / force;
        let widened = OWN / cell + cubes * radius.powi(2) / (10.0 * cell.powi(3));
        (-(radius * radius / bent + force * widened / (PI * of.reduced_modulus)), force)
    });
    let (path, forces): (Vec<f64>, Vec<f64>) = exact.unzip();
    for (state, expected) in surface.travel(&of, &path).iter().zip(forces) {
        assert_close(state.forces[0] / expected, 1.0, 3e-12, "force");
    }
    let path: Vec<f64> = states.iter().map(|state| state["contact_separation"].as_f64().unwrap()).collect();
    for (found, state) in surface.travel(&of, &path).iter().zip(states) {
        let [radius, force] = named(state, ["radius", "contact_force"]);
        let off = found.forces[0] / force - 1.0;
        assert!(off.abs() < 0.6 * (radius / cell).powi(5) + 1e-12, "{off:e} at a = {} L", radius / cell);
    }
}

/// Two spheres of JKR with contacts of finite size pull off at the root of f/R + f²/(2πE*r³) = −(3/2)πΔγ, to first order
/// 0.212 (a_c/r)³ above that of one.
#[test]
fn finite_contacts_change_the_pull_off() {
    let all = json(LIMITS);
    let of = reference(&all);
    for pair in all["jkr_pairs"].as_array().unwrap() {
        let [distance, alone, force] = named(pair, ["distance", "single_separation", "contact_pull_off"]);
        let bend = 1.0 / of.radius - force / (2.0 * PI * of.reduced_modulus * distance.powi(3));
        let stretch = 1.0 / (of.radius * bend).cbrt();
        let radius = (9.0 * PI * of.work_of_adhesion / (8.0 * of.reduced_modulus * bend * bend)).cbrt();
        let load = 4.0 / 3.0 * of.reduced_modulus * radius.powi(3) * bend;
        let moment = radius.powi(2) * (0.4 * load - 2.0 / 3.0 * (load + force));
        let raised = -force / distance + moment / (4.0 * distance.powi(3));
        let tilt = force / (PI * of.reduced_modulus * distance.powi(2));
        let place = alone * stretch - raised / (PI * of.reduced_modulus) + 1.5 * of.radius * tilt * tilt;
        let surface = Surface { kernel: Kernel::Contact, ..Surface::pair("jkr", distance) };
        let path = [steps(-2e-9, place, 20), vec![place + 1e-12, place + 2e-12]].concat();
        let way = surface.travel(&of, &path);
        for (found, delta) in way[20].forces.iter().zip(&way[20].interference) {
            assert_close(-found, force, 1e-11 * force, "pull-off");
            assert_close(*delta, -alone * stretch, 1e-7 * alone, "interference at pull-off");
        }
        assert!(way.iter().all(|state| -state.forces[0] <= force * (1.0 + 1e-11)));
    }
}

/// Pairs and ensembles of Hertz and JKR asperities with contacts of finite size, of one radius and of several: every load
/// to 1e-9 of the largest.
#[test]
fn loads_of_finite_contacts_are_those_of_a_dense_method() {
    let (all, surfaces) = (json(LIMITS), json(REFERENCES));
    for row in all["contact"].as_array().unwrap() {
        let [name, law, coupling] = ["surface", "law", "coupling"].map(|name| row[name].as_str().unwrap());
        let given = Given { kernel: Kernel::Contact, ..Given::new(&surfaces["surfaces"][name]) };
        let coupling = Coupling::ALL.into_iter().find(|(name, _)| *name == coupling).unwrap().1;
        for state in row["states"].as_array().unwrap() {
            let d = state["separation"].as_f64().unwrap();
            let found = given.forces(law, coupling, d, &reference(&all));
            let [expected, whole] = ["third_order_forces", "forces"].map(|name| numbers(&state[name]));
            let largest = expected.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            for ((found, expected), whole) in found.iter().zip(&expected).zip(&whole) {
                assert_close(*found, *expected, 1e-9 * largest, &format!("{name} {law} {coupling:?} {d:e}"));
                assert_close(*found, *whole, 3e-4 * largest, "all orders");
            }
        }
    }
}

/// The widest pair of circles is found among all, of some and of many that touch.
#[test]
fn the_closest_contacts_are_found() {
    for (count, share) in [(1, 1), (2, 1), (12, 1), (12, 5), (900, 1), (900, 7), (900, 200)] {
        let random = &mut stream(19, Purpose::Places, count as u64);
        let places = Places::Uniform.draw(random, (count, 1.0), Coupling::Patch);
        let radius = |i: usize| if i.is_multiple_of(share) { 1e-3 * (1.0 + (i as f64).sin()) } else { 0.0 };
        let radii: Vec<f64> = (0..count).map(radius).collect();
        for coupling in [Coupling::Periodic, Coupling::Patch] {
            let mut expected = if coupling == Coupling::Periodic { 2.0 } else { 0.0 };
            expected *= radii.iter().copied().fold(0.0, f64::max);
            for (i, j) in (0..count).flat_map(|i| (0..i).map(move |j| (i, j))) {
                if radii[i] > 0.0 && radii[j] > 0.0 {
                    let distance = coupling.square(places[i], places[j]).sqrt();
                    expected = f64::max(expected, (radii[i] + radii[j]) / distance);
                }
            }
            let half_space = HalfSpace::new(coupling, places.clone(), 1.0, 1e-9);
            assert_eq!(half_space.crowding(&radii), expected, "{count} {share} {coupling:?}");
        }
    }
}

/// Raising one asperity changes the force on another as raising the other changes the force on the first.
#[test]
fn responses_are_reciprocal() {
    let surfaces = json(REFERENCES);
    let given = Given::new(&surfaces["surfaces"]["thirty"]);
    let of = reference(&json(LIMITS));
    let couplings = [Coupling::Periodic, Coupling::Patch];
    for (coupling, kernel) in
        couplings.into_iter().flat_map(|own| Kernel::ALL.map(|(_, kernel)| (own, kernel)))
    {
        let forces = |i: usize, by: f64| {
            let mut heights = given.heights.clone();
            heights[i] += by;
            let (side, places) = (given.side, given.places.clone());
            let surface = Surface { law: "hertz", coupling, side, places, heights, softness: 1.0, kernel };
            surface.travel(&of, &[20e-9, 1e-9]).pop().unwrap().forces
        };
        let first = forces(0, 0.0);
        let touching: Vec<usize> = (0..30).filter(|i| first[*i] > 1e-7).take(5).collect();
        assert!(touching.len() == 5);
        const BY: f64 = 1e-13;
        let response = |i: usize| -> Vec<f64> {
            let [up, down] = [BY, -BY].map(|by| forces(i, by));
            touching.iter().map(|j| (up[*j] - down[*j]) / (2.0 * BY)).collect()
        };
        let table: Vec<Vec<f64>> = touching.iter().map(|i| response(*i)).collect();
        for (i, j) in (0..5).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let largest = table[i][i].abs().min(table[j][j].abs());
            assert!(table[i][j].abs() > 1e-4 * largest);
            assert_close(table[i][j], table[j][i], 1e-6 * largest, "response");
        }
    }
}
