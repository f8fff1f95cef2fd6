//! One direct solve of the law of one asperity, in contact and before it, per adhesion parameter, beside
//! drawing one Gaussian height: the yardstick for everything else. Each sample covers a slice of rising
//! interferences, as a sorted surface gives them; divan reports the time of one solve as the reciprocal of
//! its item throughput.

use divan::{Bencher, black_box, counter::ItemsCount};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use stiction::asperity::elastic::{self, Elastic};
use stiction::asperity::emd::Emd;
use stiction::asperity::{BLOCK, Path, SolverStats};
use stiction::math::instruction_set::InstructionSet;

const COUNT: usize = 4096;
const LAMBDAS: [f64; 6] = [0.01, 0.155, 0.9, 0.94, 2.49, 100.0];

fn main() {
    divan::main();
}

/// Rising values, evenly spaced in `low..high`.
fn slice(low: f64, high: f64) -> Vec<f64> {
    (0..COUNT).map(|i| low + (high - low) * (i as f64 + 0.5) / COUNT as f64).collect()
}

#[divan::bench(args = LAMBDAS)]
fn contact(bencher: Bencher, lambda: f64) {
    let law = Emd::new(lambda, Path::Approach).expect("a valid lambda").with_tables(-30.0, 10.0);
    let approaches = slice(law.end(), 10.0);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let (mut stats, mut sum) = (SolverStats::default(), 0.0);
        let (mut block, mut adhesion, mut radius) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for approaches in black_box(&approaches).chunks_exact(BLOCK) {
            block.copy_from_slice(approaches);
            law.contact_block(&mut block, &mut adhesion, &mut radius, &mut stats);
            sum += adhesion[0] + radius[BLOCK - 1];
        }
        sum
    });
}

/// As a surface needs it: far from contact a series takes the place of solves.
#[divan::bench(args = LAMBDAS)]
fn noncontact(bencher: Bencher, lambda: f64) {
    let law = Emd::new(lambda, Path::Approach).expect("a valid lambda").with_tables(-30.0, 10.0);
    before_contact(bencher, &law, -30.0);
}

/// Near contact, where every asperity is solved.
#[divan::bench(args = LAMBDAS)]
fn noncontact_solved(bencher: Bencher, lambda: f64) {
    let law = Emd::new(lambda, Path::Approach).expect("a valid lambda").with_noncontact_tables(-30.0);
    before_contact(bencher, &law, law.end() - 2.0);
}

fn before_contact(bencher: Bencher, law: &Emd, furthest: f64) {
    let approaches = slice(furthest, law.end() - 1e-9);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let (mut stats, mut sum) = (SolverStats::default(), 0.0);
        let (mut block, mut adhesion) = ([0.0; BLOCK], [0.0; BLOCK]);
        for approaches in black_box(&approaches).chunks_exact(BLOCK) {
            block.copy_from_slice(approaches);
            InstructionSet::current().run(
                #[inline(always)]
                || law.noncontact_block(&mut block, &mut adhesion, &mut stats),
            );
            sum += adhesion[0];
        }
        sum
    });
}

/// Ranges of λ of surfaces whose radii differ: those of case II with radii that scatter by half, around the first folds, and
/// all that are solved.
const RANGES: [(f64, f64); 3] = [(0.55, 1.25), (0.88, 0.95), (1e-6, 1e6)];

/// Asperities whose λ are spread over a range in any order.
fn many((low, high): (f64, f64)) -> Vec<Elastic> {
    let share = |i: usize| (i as f64 * 0.618_033_988_749_894_9).fract();
    (0..COUNT).map(|i| Elastic::new((low * (high / low).powf(share(i))).clamp(low, high))).collect()
}

/// A λ for each asperity, in contact.
#[divan::bench(args = RANGES)]
fn many_contacts(bencher: Bencher, range: (f64, f64)) {
    let asperities = many(range);
    let displacements: Vec<f64> = asperities
        .iter()
        .zip(slice(0.0, 10.0))
        .map(|(own, distance)| own.end(Path::Approach) + distance)
        .collect();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let (mut stats, mut sum) = (SolverStats::default(), 0.0);
        let (mut adhesion, mut radius) = ([0.0; BLOCK], [0.0; BLOCK]);
        for (asperities, displacements) in
            asperities.chunks_exact(BLOCK).zip(black_box(&displacements).chunks_exact(BLOCK))
        {
            elastic::contact(|i| &asperities[i], displacements, &mut adhesion, &mut radius, &mut stats);
            sum += adhesion[0] + radius[BLOCK - 1];
        }
        sum
    });
}

/// The same before contact, where every asperity is solved.
#[divan::bench(args = RANGES)]
fn many_noncontacts_solved(bencher: Bencher, range: (f64, f64)) {
    many_before_contact(bencher, range, 2.0);
}

/// As a surface needs it.
#[divan::bench(args = RANGES)]
fn many_noncontacts(bencher: Bencher, range: (f64, f64)) {
    many_before_contact(bencher, range, 30.0);
}

fn many_before_contact(bencher: Bencher, range: (f64, f64), furthest: f64) {
    let asperities = many(range);
    let displacements: Vec<f64> = asperities
        .iter()
        .zip(slice(1e-9, furthest))
        .map(|(own, distance)| own.end(Path::Approach) - distance)
        .collect();
    let gaps: Vec<f64> = asperities.iter().zip(&displacements).map(|(own, d)| own.rigid_gap(*d)).collect();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let (mut stats, mut sum, mut adhesion) = (SolverStats::default(), 0.0, [0.0; BLOCK]);
        for block in (0..COUNT).step_by(BLOCK) {
            let displacements = &black_box(&displacements)[block..block + BLOCK];
            let of = |i: usize| &asperities[block + i];
            elastic::noncontact(of, |i| gaps[block + i], (displacements, false), &mut adhesion, &mut stats);
            sum += adhesion[0];
        }
        sum
    });
}

#[divan::bench]
fn starting_tables(bencher: Bencher) {
    bencher.bench_local(|| {
        Emd::new(black_box(0.9), Path::Approach).expect("a valid lambda").with_tables(-30.0, 10.0)
    });
}

#[divan::bench]
fn one_gaussian_height(bencher: Bencher) {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let mut sum = 0.0;
        for _ in 0..COUNT {
            let height: f64 = StandardNormal.sample(&mut random);
            sum += height;
        }
        sum
    });
}
