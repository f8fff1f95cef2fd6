//! The energy that avalanches lose, against closed forms and the work around loops; it is never gained.

use super::*;

/// Asperities of a law with the memory of their history.
struct Square {
    cycle: Loop,
    /// Units of length, m, and of energy, J.
    units: [f64; 2],
    coupling: Coupling,
    side: f64,
    modulus: f64,
    places: Vec<[f64; 2]>,
    heights: Vec<f64>,
}

/// A state at a separation: the energy lost, J, and how it was reached.
struct State {
    lost: f64,
    settled: Settled,
}

impl Square {
    /// One of the height 0 in a square of the side, m.
    fn new(law: &str, of: &Asperity, coupling: Coupling, side: f64) -> Self {
        let parameters = parameters(of, Path::Approach);
        let model = model(law).unwrap();
        let cycle = Loop::new(&model, &parameters).unwrap();
        let (scale, modulus) = (parameters.scale, of.reduced_modulus);
        let units = [scale.length, scale.energy()];
        Self { cycle, units, coupling, side, modulus, places: vec![[0.5, 0.5]], heights: vec![0.0] }
    }

    /// `count` asperities of Gaussian heights at hard-core places, by an index.
    fn scattered(self, count: usize, std: f64, index: u64) -> Self {
        let mut heights = vec![0.0; count];
        Heights::gaussian(std).draw(&mut stream(29, Purpose::Heights, index), &mut heights);
        heights.sort_by(f64::total_cmp);
        let places = Places::HardCore(0.5 * self.side / (count as f64).sqrt());
        let random = &mut stream(29, Purpose::Places, index);
        let places = places.draw(random, (count, self.side), self.coupling);
        Self { places, heights, ..self }
    }

    fn solver(&self) -> Solver<'_> {
        let compliance = 1.0 / (PI * self.modulus * self.side);
        let half_space = HalfSpace::new(self.coupling, self.places.clone(), compliance, 1e-11);
        let laws = vec![RadiusLaws::new(Hysteresis::Loop(MaybeOwned::Shared(&self.cycle)), self.units[0])];
        let asperities = Asperities::new(laws, vec![0; self.heights.len()]);
        Solver::new(asperities, half_space, &self.heights, 1e-11)
    }

    /// Goes through separations d, m.
    fn travel(&self, path: &[f64]) -> Vec<State> {
        let mut solver = self.solver();
        solver.begin(path[0]);
        let go = |d: &f64| {
            let settled = solver.settle(*d);
            State { lost: solver.energy_lost(), settled }
        };
        path.iter().map(go).collect()
    }
}

/// Separations from one to another and back in `count` steps each.
fn there_and_back(from: f64, to: f64, count: usize) -> Vec<f64> {
    let way = |k: usize| from + (to - from) * k as f64 / count as f64;
    (0..=count).chain((0..count).rev()).map(way).collect()
}

/// Spheres like the ones of case III, of another work of adhesion and hardness.
fn sphere(work_of_adhesion: f64, hardness: f64) -> Asperity {
    Asperity { hardness, ..asperity(6.38e-6, 85.29e9, work_of_adhesion) }
}

/// Maugis' contact between first touch and its fold (`scripts/reference_coupling_limits.py`), JKR's as its limit, and the
/// branch before contact with constant stress, F̂ = −(π/2)λC², by the area under its chords.
#[test]
fn unstable_parts_have_the_work_of_their_curves() {
    let all = json(include_str!("../../../tests/data/coupling_limits.json"));
    let work = |law: &str, lambda: f64| {
        let parameters = LawParameters::scaled(lambda, Path::Retraction).unwrap();
        model(law).unwrap().law(&parameters).unwrap().unstable_work()
    };
    for row in all["unstable_work"].as_array().unwrap() {
        let [lambda, end, expected] =
            ["adhesion_parameter", "end", "work"].map(|name| row[name].as_f64().unwrap());
        let parameters = LawParameters::scaled(lambda, Path::Approach).unwrap();
        let cycle = Loop::new(&model("md").unwrap(), &parameters);
        assert!((cycle.unwrap().release() / end - 1.0).abs() < 1e-14);
        // At λ = 1 the fold is close to first touch, and the work is what two ends leave.
        let tolerance = 1e-12 + 1e-13 / expected;
        let found = work("md", lambda);
        assert!((found / expected - 1.0).abs() < tolerance, "{lambda}: {found:e} {expected:e}");
        let (half, touch) = (8.0 * lambda / (3.0 * PI), -0.75 / lambda * first_touch(lambda));
        let at = |k: usize| {
            let outer = half.min(touch) * k as f64 / 2000.0;
            (0.5 * outer * outer - half * outer, -0.5 * PI * lambda * outer * outer)
        };
        let chord = |k: usize| 0.5 * (at(k).1 + at(k + 1).1) * (at(k + 1).0 - at(k).0);
        let before: f64 = (0..2000).map(chord).sum();
        let found = work("md_kim", lambda) - work("md", lambda);
        assert!((found / before - 1.0).abs() < 1e-5, "{lambda}: {found:e} {before:e}");
    }
    assert!((work("md", 1e4) / work("jkr", 1.0) - 1.0).abs() < 1e-6);
}

/// Δ at first touch, where (π/4)λc̄² + (4λ²/3)(π/2 − 1)c̄ = 1.
fn first_touch(lambda: f64) -> f64 {
    let (square, line) = (0.25 * PI * lambda, 4.0 / 3.0 * lambda * lambda * (0.5 * PI - 1.0));
    -4.0 / 3.0 * lambda * ((line * line + 4.0 * square).sqrt() - line) / (2.0 * square)
}

/// One sphere of JKR in a repeated square: all of its curve has ∫F̂ dΔ = (2/5)A⁵ − (2√6/3)A^(7/2) + A², and its own images
/// raise it by the lattice constant.
#[test]
fn a_sphere_that_snaps_loses_the_area_of_its_curve() {
    const OWN: f64 = -3.900_264_920_001_956;
    let of = sphere(0.3, 2.5e9);
    for side in [2e-6, 20e-6] {
        let square = Square::new("jkr", &of, Coupling::Periodic, side);
        let [length, energy] = square.units;
        let force = energy / length;
        let compliance = OWN / (PI * of.reduced_modulus * side);
        let root = 6_f64.sqrt();
        let place = |a: f64| a * a - 2.0 / 3.0 * root * a.sqrt();
        let pull = |a: f64| a * a * a - root * a * a.sqrt();
        let held = |a: f64| 0.4 * a.powi(5) - 2.0 / 3.0 * root * a.powf(3.5) + a * a;
        // In contact, to both sides of its ends.
        let turn = -0.3 * length;
        let path = [vec![length], there_and_back(2.0 * length, turn, 40)[40..].to_vec()].concat();
        let way = square.travel(&path);
        assert!(way.iter().all(|state| state.settled.is_converged));
        let lost: Vec<f64> = way.iter().map(|state| state.lost).filter(|lost| *lost != 0.0).collect();
        let end = 6_f64.powf(-1.0 / 3.0);
        // The radius at which the foot is at Δ with a part of what the images raise it by.
        let radius = |share: f64, at: f64| {
            let (mut low, mut high) = (end, 10.0);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                let is_above = length * place(middle) + share * compliance * force * pull(middle) > at;
                *(if is_above { &mut high } else { &mut low }) = middle;
            }
            low
        };
        // It has touched at Δ = 0, and then went on.
        let (touch, beyond, now) = (radius(0.0, 0.0), radius(0.0, -turn), radius(1.0, -turn));
        let on = held(now) - held(beyond) - 0.5 * pull(now) * (place(now) - place(beyond));
        let off = held(end) + 0.5 * compliance * (force * pull(end)) * (force * pull(end)) / energy;
        let expected = [-energy * (held(touch) + on), energy * off];
        assert_eq!(lost.len(), 2, "{lost:?}");
        for (lost, expected) in lost.iter().zip(expected) {
            // The branch is known to a hundredth of how far the surface has moved from it, the energy to its square.
            assert!((lost / expected - 1.0).abs() < 1e-4, "{side:e}: {lost:e} {expected:e}");
        }
    }
}

/// Goes to the separation d, m, with steps halved so often where energy is lost; the work of the surfaces, J, to the
/// next order by the trapezoidal rule, and the energy lost.
fn work_to(solver: &mut Solver<'_>, d: f64, halvings: u32) -> [f64; 2] {
    let (before, from, force) = (solver.snapshot(), solver.separation(), solver.external_force());
    assert!(solver.settle(d).is_converged, "{d:e}");
    let lost = solver.energy_lost();
    if lost == 0.0 || halvings == 0 {
        return [0.5 * (force + solver.external_force()) * (d - from), lost];
    }
    solver.restore(&before);
    solver.settle(from);
    let parts = [0.5 * (from + d), d].map(|d| work_to(solver, d, halvings - 1));
    [0, 1].map(|k| parts[0][k] + parts[1][k])
}

/// Surfaces do the work that avalanches lose around a closed loop, where steps are short enough that it is
/// known where these are; with long ones the energy is nearly the same.
fn loops_lose_their_work(cases: &[(&str, Coupling)], (count, halvings): (usize, u32), tolerance: f64) {
    for &(law, coupling) in cases {
        let square = Square::new(law, &sphere(0.3, 2.5e9), coupling, 3e-6).scattered(16, 0.65e-9, 1);
        let around = |count: usize, halvings: u32| {
            let path = there_and_back(6e-9, -1e-9, count);
            let mut solver = square.solver();
            solver.begin(path[0]);
            assert!(solver.settle(path[0]).is_converged);
            let parts: Vec<[f64; 2]> = path[1..].iter().map(|d| work_to(&mut solver, *d, halvings)).collect();
            [0, 1].map(|k| parts.iter().map(|part| part[k]).sum::<f64>())
        };
        let [[_, coarse], [work, lost]] = [around(100, 0), around(count, halvings)];
        let off = [-work / lost - 1.0, coarse / lost - 1.0];
        println!("{law} {coupling:?}: {lost:e} J, work {:e}, by long steps {:e}", off[0], off[1]);
        assert!(off[0].abs() < tolerance && off[1].abs() < 0.02, "{law} {coupling:?}: {off:?}");
    }
}

#[test]
fn the_work_around_a_loop_is_what_avalanches_lose() {
    loops_lose_their_work(&[("jkr", Coupling::Patch)], (150, 6), 2e-3);
}

#[test]
#[ignore = "slow: short steps, ten seconds"]
fn the_work_around_more_loops_is_what_avalanches_lose() {
    let cases = [("jkr", Coupling::Patch), ("md", Coupling::Periodic), ("md_kim", Coupling::Patch)];
    loops_lose_their_work(&cases, (400, 12), 1e-3);
}

/// Two spheres of JKR half a diagonal of a repeated square apart: the first one touches, and that its attraction raises the
/// other surface between its images keeps the second one, further back by less than the step, from touching.
#[test]
fn passages_that_another_relieves_are_undone() {
    let one = Square::new("jkr", &sphere(0.3, 2.5e9), Coupling::Periodic, 2e-6);
    let [length, energy] = one.units;
    // About: −1.33 s_F at first touch, and −1.61 for its images at half a diagonal.
    let relief = 1.33 * 1.61 * energy / length / (PI * one.modulus * one.side);
    let step = 0.3 * length;
    let (places, heights) = (vec![[0.25, 0.25], [0.75, 0.75]], vec![0.0, 0.3 * relief - step]);
    let square = Square { places, heights, ..one };
    let mut solver = square.solver();
    solver.begin(length);
    for d in [length, 1e-3 * length, -step] {
        assert!(solver.settle(d).is_converged, "{d:e}");
    }
    assert!(solver.has_touched(0) && !solver.has_touched(1));
    assert!(solver.interference[1] < -0.2 * relief && solver.interference[1] > -relief);
}

/// Whatever surfaces do, no avalanche of an elastic law gains energy.
fn no_avalanche_gains(couplings: &[Coupling], laws: &[(&str, f64)], indices: std::ops::Range<u64>) {
    let mut steps = 0;
    for &(law, work) in laws {
        for &coupling in couplings {
            for index in indices.clone() {
                let count = 3 + 7 * (index % 5) as usize;
                let square = Square::new(law, &sphere(work, 2.5e9), coupling, 3e-6);
                let square = square.scattered(count, 0.4e-9 + 0.3e-9 * (index % 3) as f64, index);
                let path = there_and_back(6e-9, -1.5e-9, 25 + 8 * (index % 7) as usize);
                for (state, d) in square.travel(&path).iter().zip(&path) {
                    let floor = -1e-9 * square.units[1];
                    assert!(state.settled.is_converged, "{law} {coupling:?} {index} {d:e}");
                    assert!(state.lost >= floor, "{law} {coupling:?} {index} {d:e}: {:e}", state.lost);
                    assert!(state.lost <= 0.0 || state.settled.avalanches.count > 0, "{law} {index} {d:e}");
                    steps += usize::from(state.lost > 0.0);
                }
            }
        }
    }
    assert!(steps > 6 * laws.len() * couplings.len() * indices.count(), "{steps}: nothing would be tested");
}

/// Laws, and works of adhesion, J/m².
const LAWS: [(&str, f64); 5] = [("jkr", 0.3), ("md", 0.3), ("md_kim", 0.3), ("emd", 0.3), ("md", 0.6)];

#[test]
fn energy_falls_in_every_avalanche() {
    no_avalanche_gains(&[Coupling::Periodic, Coupling::Patch], &LAWS, 0..3);
}

#[test]
#[ignore = "slow: a thousand loops, a minute"]
fn energy_falls_in_every_avalanche_of_many() {
    no_avalanche_gains(&[Coupling::Periodic, Coupling::Patch], &LAWS, 3..80);
}
