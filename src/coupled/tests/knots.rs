//! Asperities that drive each other over jumps of their laws, where the only state has them at rest there.

use super::*;
use crate::coupled::knots::{Choice, untied};

const DISTANCE: f64 = 2e-7;

/// The compliance of one under the other, m/N.
fn influence(of: &Asperity) -> f64 {
    1.0 / (PI * of.reduced_modulus * DISTANCE)
}

/// Two asperities of heights, m, and what remembers for each.
fn pair<'a>(of: &Asperity, laws: [(Hysteresis<'a>, f64); 2], heights: &'a [f64; 2]) -> Solver<'a> {
    let side = 4.0 * DISTANCE;
    let places = vec![[0.25, 0.5], [0.5, 0.5]];
    let half_space = HalfSpace::new(Coupling::Patch, places, 1.0 / (PI * of.reduced_modulus * side), 1e-13);
    let laws = laws.into_iter().map(|(memory, length)| RadiusLaws::new(memory, length)).collect();
    Solver::new(Asperities::new(laws, vec![0, 1]), half_space, heights, 1e-12)
}

/// P − F_s, N, of a law at δ, m.
fn load(law: &dyn Law, delta: f64) -> f64 {
    crate::asperity::SolvedAsperity::new(law, delta).external_force()
}

/// The lubricant reaches the one: it pulls more. The other's solids touch: it pulls less. So the pull of the first lets the
/// second touch, which pushes the first away, and so on, unless each has the force at which the other stays where its
/// jump is: f of the one is (z − d − δ)/g of the other.
#[test]
fn two_at_jumps_to_either_side_hold_each_other() {
    let of = Asperity { lubricant_thickness: 0.5e-9, ..asperity(3.33e-6, 85.29e9, 0.09) };
    let parameters = parameters(&of, Path::Approach);
    let law = model("hybrid").unwrap().law(&parameters).unwrap();
    let law = law.as_ref();
    let [reached, touching] = [0, 1].map(|k| law.boundaries()[k].interference);
    let beside = 1e-16;
    let ends = [reached, touching].map(|place| [load(law, place - beside), load(law, place + beside)]);
    assert!(ends[0][1] < ends[0][0] && ends[1][1] > ends[1][0], "{ends:?}");
    for shares in [[0.5, 0.5], [0.1, 0.6], [0.95, 0.3]] {
        let expected = [0, 1].map(|k| ends[k][0] + shares[k] * (ends[k][1] - ends[k][0]));
        let d = 1e-9;
        let influence = influence(&of);
        let heights = [d + reached + influence * expected[1], d + touching + influence * expected[0]];
        let length = parameters.scale.length;
        let laws = [0, 1].map(|_| (Hysteresis::None(MaybeOwned::Shared(law)), length));
        let mut solver = pair(&of, laws, &heights);
        solver.begin(d + 1e-9);
        for step in (0..=20).rev() {
            let settled = solver.settle(d + 0.05e-9 * f64::from(step));
            assert!(settled.is_converged, "{shares:?} {step}: {settled:?}");
        }
        for (k, place) in [reached, touching].into_iter().enumerate() {
            assert!((solver.interference[k] - place).abs() < 1e-9 * length, "{shares:?} {k}");
            let off = solver.external[k] / expected[k] - 1.0;
            assert!(off.abs() < 1e-9, "{shares:?} {k}: {off:e}");
        }
        // And on: both are over their jumps.
        assert!(solver.settle(d - 1e-9).is_converged);
        assert!(
            solver.interference.iter().all(|delta| *delta > touching) && solver.states.resting.is_empty()
        );
    }
}

/// A Maugis sphere whose contact ends hardly further out than it begins, next to a sphere under load: contact
/// raises the other one's foot, and this one's with it, by more than that. It stays where contact begins,
/// with the force at which it does.
#[test]
fn one_that_contact_takes_back_out_stays_where_contact_begins() {
    let of = |work| asperity(6.38e-6, 85.29e9, work);
    let lambda = |work| parameters(&of(work), Path::Approach).scale.lambda;
    let work = 0.1 * (0.96 / lambda(0.1)).powf(1.5);
    let of = of(work);
    let parameters = parameters(&of, Path::Approach);
    assert!((parameters.scale.lambda - 0.96).abs() < 1e-12);
    let cycle = Loop::new(&model("md").unwrap(), &parameters).unwrap();
    let (begin, end) = (cycle.approach().boundaries()[0].interference, cycle.release());
    let (neighbour, inside) = (model("hertz").unwrap().law(&parameters).unwrap(), cycle.approach());
    let length = parameters.scale.length;
    let influence = influence(&of);
    for share in [0.2, 0.7] {
        let expected = share * load(inside, begin + 1e-16);
        let (d, height) = (1e-9, 6e-9);
        let other = load(neighbour.as_ref(), height - d - influence * expected);
        let heights = [d + begin + influence * other, height];
        let laws = [
            (Hysteresis::Loop(MaybeOwned::Shared(&cycle)), length),
            (Hysteresis::None(MaybeOwned::Shared(neighbour.as_ref())), length),
        ];
        let mut solver = pair(&of, laws, &heights);
        solver.begin(d + 1e-9);
        for step in (0..=20).rev() {
            let settled = solver.settle(d + 0.05e-9 * f64::from(step));
            assert!(settled.is_converged, "{share} {step}: {settled:?}");
        }
        let off = solver.external[0] / expected - 1.0;
        assert!(off.abs() < 1e-9 && solver.interference[0] == begin, "{share}: {off:e}");
        // In contact it would be where contact has ended.
        let within = load(neighbour.as_ref(), height - d - influence * load(inside, begin + 1e-16));
        assert!(heights[0] - d - influence * within < end, "{share}: nothing would be tested");
    }
}

/// Forces that do not vary but jump: of three in a ring each of which drives the next one, the shares are a linear system; and
/// a law with a root has the one of its two solutions that is within the segment.
#[test]
fn knots_have_the_state_of_their_equations() {
    let step = |segment: u8, ends: [f64; 2]| Choice::In { segment, ends, jumps: ends };
    let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
    // f is 0 below 0, and 1 above.
    let rest = Choice::At { place: 0.0, forces: [0.0, 1.0], is_hysteretic: false };
    let choices = vec![vec![step(0, [low, 0.0]), step(1, [0.0, high]), rest]; 3];
    let yielding = [0.1, 2.0, 0.0, 0.0, -0.1, 1.0, 1.0, 0.0, 0.2];
    let shares = [0.3, 0.6, 0.8];
    let still: Vec<f64> = (0..3).map(|k| (0..3).map(|l| yielding[3 * k + l] * shares[l]).sum()).collect();
    let law = |_: usize, segment: u8, _: f64| [f64::from(segment), 0.0];
    let found = untied(&choices, (&still, &yielding), law).unwrap();
    assert_eq!(found.choices, [2, 2, 2]);
    for (k, share) in shares.iter().enumerate() {
        assert!((found.forces[k] - share).abs() < 1e-14 && found.places[k].abs() < 1e-14, "{k}: {found:?}");
    }
    // f = −√(δ + 1) from −1 to 1 and δ = 0.3 − Y f: δ = Y√(δ + 1) + 0.3, above 0.
    let choices = [vec![step(0, [-1.0, 1.0])]];
    let root = |_: usize, _: u8, delta: f64| {
        let root = (delta + 1.0).max(1e-12).sqrt();
        [-root, -0.5 / root]
    };
    let found = untied(&choices, (&[-0.9], &[0.9]), root).unwrap();
    // x = √(δ + 1): x² − 0.9 x − 0.1 = 0.
    let x = 0.5 * (0.9 + (0.81_f64 + 0.4).sqrt());
    assert!((found.places[0] - (x * x - 1.0)).abs() < 1e-12, "{found:?}");
}

/// Sixteen spheres under load, so close that they yield to each other, on a quarter of the side: near neighbours
/// give way as a system of all says, which has two digits.
#[test]
fn near_neighbours_give_way_as_all_do() {
    let of = asperity(3.33e-6, 85.29e9, 0.09);
    let parameters = parameters(&of, Path::Approach);
    let (law, length) = (model("hertz").unwrap().law(&parameters).unwrap(), parameters.scale.length);
    let (side, count) = (8e-6, 16_usize);
    for coupling in [Coupling::Periodic, Coupling::Patch] {
        let places = (0..count).map(|i| [i % 4, i / 4].map(|k| (k as f64 + 0.5) / 16.0)).collect();
        let heights: Vec<f64> = (0..count).map(|i| 1e-10 * ((7 * i) % 16) as f64).collect();
        let half_space = HalfSpace::new(coupling, places, 1.0 / (PI * of.reduced_modulus * side), 1e-10);
        let laws = vec![RadiusLaws::new(Hysteresis::None(MaybeOwned::Shared(law.as_ref())), length)];
        let mut solver = Solver::new(Asperities::new(laws, vec![0; count]), half_space, &heights, 1e-9);
        solver.begin(2e-9);
        for step in 1..=8 {
            let settled = solver.settle(2e-9 - 5e-10 * f64::from(step));
            assert!(settled.is_converged, "{coupling:?} {step}: {settled:?}");
        }
        let members = [5, 6].map(|i| (i, Vec::new()));
        let of = members.each_ref().map(|(i, _)| *i as usize);
        let residual: Vec<f64> = (0..count).map(|i| 1e-11 * ((5 * i) % 7) as f64).collect();
        solver.residual.copy_from_slice(&residual);
        let [near, all] = [true, false].map(|is_local| solver.around(&members, is_local));
        assert_eq!(near.len(), count);
        let (steps, responses) = solver.local(&near, &of).unwrap();
        let (expected_steps, expected) = solver.global(&all, &of);
        let place = |i: usize| all.iter().position(|j| *j == near[i]).unwrap();
        let off = |k: usize| (steps[k] - expected_steps[place(k)]).abs();
        let worst = (0..count).map(off).fold(0.0, f64::max);
        let size = |all: &[f64]| all.iter().map(|x| x.abs()).fold(0.0, f64::max);
        assert!(worst < 0.02 * size(&steps), "{coupling:?}: {worst:e} of {:e}", size(&steps));
        let most = size(&responses.concat());
        for l in 0..of.len() {
            let off = |k: usize| (responses[l][k] - expected[l][place(k)]).abs();
            let worst = (0..count).map(off).fold(0.0, f64::max);
            assert!(worst < 0.02 * most, "{coupling:?}: {worst:e} of {most:e}");
        }
        // That others give way makes a difference.
        let alone = solver.half_space.influence(6, 5);
        let given = responses[0][1];
        assert!((given + alone).abs() > 0.1 * alone, "{given:e} {alone:e}");
    }
}
