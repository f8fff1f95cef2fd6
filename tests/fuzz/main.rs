//! Readers under input that means harm: scenes, quantities, and the files that the program reads back.
//!
//! Every case follows from fixed seeds, so that a failure is repeated by running the test again.
//! `STICTION_FUZZ_CASES` is the number of cases of each target; without it there are as many as take a few
//! seconds:
//!
//! ```sh
//! STICTION_FUZZ_CASES=10000000 cargo test --release --test fuzz scene -- --nocapture
//! ```

#[path = "../common/mod.rs"]
mod common;

mod arguments;
mod bytes;
mod files;
mod quantities;
mod scenes;
mod states;
mod text;

use cap::Cap;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::alloc::System;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Counts what is allocated.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// What is allocated is counted for the process: tests that look at it run one by one, and so do the others.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The number of cases of a target, `default` unless the environment says otherwise.
fn cases(default: u64) -> u64 {
    match std::env::var("STICTION_FUZZ_CASES") {
        Ok(text) => text.parse().expect("STICTION_FUZZ_CASES is a whole number"),
        Err(_) => default,
    }
}

/// Makes cases from a fixed seed and shrinks the one that fails.
fn runner(cases: u64) -> TestRunner {
    let config = Config {
        cases: u32::try_from(cases).unwrap_or(u32::MAX),
        failure_persistence: None,
        ..Config::default()
    };
    TestRunner::new_with_rng(
        config,
        TestRng::from_seed(RngAlgorithm::ChaCha, b"what comes from anywhere, 32 B.."),
    )
}
