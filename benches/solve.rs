//! One direct solve of the law of one asperity, in contact and before it, per adhesion parameter, beside
//! drawing one Gaussian height: the yardstick for everything else. Each sample covers a slice of rising
//! interferences, as a sorted surface gives them; divan reports the time of one solve as the reciprocal of
//! its item throughput.

use divan::{Bencher, black_box, counter::ItemsCount};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
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
