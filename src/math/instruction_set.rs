//! Vector instructions that the hot loops are compiled for, chosen when the program runs.
//!
//! A hot loop is a branch-free function that is inlined into [`InstructionSet::run`], which compiles it once
//! for each set. There is no fused multiply-add in any of them and no sum is reordered, so all of them give
//! the same bits; the choice is one of speed only. Tests and benchmarks force it by
//! [`InstructionSet::select`], users by the environment variable [`VARIABLE`].

use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};

/// The environment variable that chooses an instruction set by its name.
pub const VARIABLE: &str = "STICTION_INSTRUCTION_SET";

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionSet(Kind);

/// The known ones, rising. That a [`InstructionSet`] holds one is the proof that the processor has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Kind {
    Baseline = 1,
    Avx2 = 2,
    Avx512 = 3,
}

const KINDS: [Kind; 3] = [Kind::Baseline, Kind::Avx2, Kind::Avx512];

/// The one that is used, 0 as long as none was needed.
static CURRENT: AtomicU8 = AtomicU8::new(0);

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    fn is_there(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq"),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

impl InstructionSet {
    /// The sets of this processor, the fastest last.
    pub fn available() -> Vec<Self> {
        KINDS.into_iter().filter(|kind| kind.is_there()).map(Self).collect()
    }

    /// The one of that name, if this processor has it.
    ///
    /// # Errors
    /// The names that would do.
    pub fn named(name: &str) -> Result<Self, String> {
        let available = Self::available();
        available.iter().find(|set| set.name() == name).copied().ok_or_else(|| {
            let names: Vec<&str> = available.iter().map(|set| set.name()).collect();
            format!("{name:?} is none of this processor's: {}", names.join(", "))
        })
    }

    /// The one that the environment variable asks for, or the fastest.
    ///
    /// # Errors
    /// When the variable asks for something else than [`InstructionSet::named`] knows.
    pub fn of_environment() -> Result<Self, String> {
        match std::env::var_os(VARIABLE) {
            // A name that is no text is none of the known ones.
            Some(name) => {
                Self::named(&name.to_string_lossy()).map_err(|problem| format!("{VARIABLE}: {problem}"))
            }
            None => Ok(*Self::available().last().expect("the baseline is always there")),
        }
    }

    /// The one that is used by this process.
    #[inline]
    pub fn current() -> Self {
        match CURRENT.load(Ordering::Relaxed) {
            1 => Self(Kind::Baseline),
            2 => Self(Kind::Avx2),
            3 => Self(Kind::Avx512),
            _ => Self::choose(),
        }
    }

    #[cold]
    fn choose() -> Self {
        let chosen = Self::of_environment().unwrap_or(Self(Kind::Baseline));
        chosen.select();
        chosen
    }

    /// Makes this process use it from now on, in all its threads.
    pub fn select(self) {
        CURRENT.store(self.0 as u8, Ordering::Relaxed);
    }

    /// The name.
    pub fn name(self) -> &'static str {
        self.0.name()
    }

    /// Runs a task compiled for it. What is to profit has to be inlined into the task, and the task into
    /// this: mark both `#[inline(always)]`.
    #[inline(always)]
    #[allow(unsafe_code)]
    pub fn run<R>(self, task: impl FnOnce() -> R) -> R {
        match self.0 {
            // SAFETY: a value of this kind is only made where `is_there` has found the features that the
            // functions enable.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => unsafe { avx512(task) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { avx2(task) },
            _ => task(),
        }
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// AVX-512 without AVX512VL, because with it the compiler prefers vectors of 256 bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn avx512<R>(task: impl FnOnce() -> R) -> R {
    task()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn avx2<R>(task: impl FnOnce() -> R) -> R {
    task()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_what_the_processor_has() {
        for set in InstructionSet::available() {
            assert_eq!(InstructionSet::named(set.name()), Ok(set));
            assert_eq!(set.run(|| 6 * 7), 42);
        }
        assert_eq!(InstructionSet::available()[0].name(), "baseline");
        let refused = InstructionSet::named("sse9").unwrap_err();
        assert!(refused.contains("sse9") && refused.contains("baseline"), "{refused}");
    }
}
