//! Readers under input that means harm: scenes, and the files that the program reads back.
//!
//! Every case follows from its number alone, so that a failure is repeated by running the test again. `STICTION_FUZZ_CASES` is the
//! number of cases of each target; without it there are as many as take a few seconds.

#[path = "../common/mod.rs"]
mod common;

mod bytes;
mod files;

/// The number of cases of a target, `default` unless the environment says otherwise.
fn cases(default: u64) -> u64 {
    match std::env::var("STICTION_FUZZ_CASES") {
        Ok(text) => text.parse().expect("STICTION_FUZZ_CASES is a whole number"),
        Err(_) => default,
    }
}
