//! Vector instructions are a matter of speed: every law and every result has the same bits with all of them,
//! and the program takes the ones it is asked to.

use crate::common::program::{Folder, assert_exit, attribute, bits, small, text};
use crate::common::{case, dry_laws, for_each_instruction_set, law};
use std::process::{Command, Output};
use stiction::asperity::{BLOCK, Lanes, Law, LawParameters, Path, Responses, SolverStats};
use stiction::math::instruction_set::{InstructionSet, VARIABLE};

/// Interferences of a regime within ±`reach`, in no order.
fn mixed(law: &dyn Law, regime: usize, reach: f64, count: usize) -> Vec<f64> {
    let end = |i: usize| {
        law.boundaries().get(i).map_or(reach, |boundary| boundary.interference).clamp(-reach, reach)
    };
    let (low, high) = (if regime == 0 { -reach } else { end(regime - 1) }, end(regime));
    let share = |i: usize| (0.37 + 0.618_033_988 * i as f64).fract();
    // Half of them close to one end, where roots are.
    let place = |i: usize| match i % 4 {
        0 => low + (high - low) * share(i).powi(6),
        1 => high - (high - low) * share(i).powi(6),
        _ => low + (high - low) * share(i),
    };
    (0..count).map(place).filter(|delta| low < *delta && *delta < high).collect()
}

/// Forces, area and what they cost on blocks of all regimes.
fn evaluated(law: &dyn Law, reach: f64) -> (Vec<u64>, SolverStats) {
    let (mut all, mut stats) = (Vec::new(), SolverStats::default());
    for regime in 0..law.regimes().len() {
        for count in [BLOCK, 100, 9, 1] {
            let block = mixed(law, regime, reach, count);
            let mut out = Responses::default();
            law.evaluate(regime, Lanes::Own, &block, &mut out, &mut stats);
            for values in [&out.adhesion, &out.contact, &out.area] {
                all.extend(values[..block.len()].iter().map(|value| value.to_bits()));
            }
        }
    }
    (all, stats)
}

fn assert_same_bits(name: &str, law: &dyn Law, reach: f64) {
    let mut first = None;
    for_each_instruction_set(|set| {
        let found = evaluated(law, reach);
        assert!(found.0.len() > BLOCK, "{name}: {}", found.0.len());
        let expected = first.get_or_insert_with(|| found.clone());
        assert!(*expected == found, "{name} on {set}");
    });
}

/// Case I to III with tables that do not reach everywhere, and scaled asperities from one limit of λ to the
/// other with and without tables.
#[test]
fn every_law_has_the_same_bits() {
    for (_, path) in Path::ALL {
        for name in ["I", "II", "III"] {
            let (asperity, _) = case(name);
            for model in dry_laws() {
                // Beyond 110 critical interferences, so that all regimes are there.
                let reach = 120.0 * asperity.critical_interference();
                let law = law(model.name, &asperity, path, (-10e-9, 0.5 * reach));
                assert_same_bits(&format!("{} in case {name}", model.name), law.as_ref(), reach);
            }
        }
        let tables = Some((-30.0, 40.0));
        for (lambda, reach) in
            [(1e-6, tables), (0.1, None), (0.94, None), (0.94, tables), (5.0, tables), (1e6, None)]
        {
            let parameters = LawParameters {
                critical_interference: 3.0,
                hardness_ratio: Some(0.03),
                lubricant_thickness: 0.4,
                table_range: reach,
                ..LawParameters::scaled(lambda, path).unwrap()
            };
            for model in dry_laws().filter(|model| !model.is_fit()) {
                let name = format!("{} at λ = {lambda}", model.name);
                assert_same_bits(&name, model.law(&parameters).unwrap().as_ref(), 400.0);
            }
        }
    }
}

fn stiction(folder: &Folder, set: &str, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(arguments)
        .env(VARIABLE, set)
        .current_dir(folder.path(""))
        .output()
        .unwrap()
}

/// A run's numbers, datasets and attributes, outside /diagnostics, and which instructions it says it took.
#[test]
fn a_run_has_the_same_bits() {
    let by_moments = small().replace("[output]", "[solver]\nsummation = \"moments\"\n\n[output]");
    for (sum, scene) in [("direct", small()), ("moments", by_moments)] {
        let folder = Folder::new(&scene.replace("curves = false", "curves = true"));
        let mut expected = None;
        for set in InstructionSet::available() {
            let file = format!("{set}.h5");
            let run = stiction(&folder, set.name(), &["run", "scene.toml", "--replicas", "11", "-o", &file]);
            assert_exit(&run, 0);
            let path = folder.path(&file);
            assert_eq!(attribute(&path, "/diagnostics", "instruction_set"), set.name());
            assert_eq!(attribute(&path, "/ensemble", "summation"), sum);
            let found = bits(&path);
            assert!(found.len() > 50, "{}", found.len());
            assert!(*expected.get_or_insert_with(|| found.clone()) == found, "{sum} on {set}");
        }
        // Without the variable, the fastest.
        let default = Command::new(env!("CARGO_BIN_EXE_stiction"))
            .args(["run", "scene.toml", "--replicas", "1", "-o", "default.h5"])
            .env_remove(VARIABLE)
            .current_dir(folder.path(""))
            .output();
        assert_exit(&default.unwrap(), 0);
        let fastest = InstructionSet::available().last().unwrap().name();
        assert_eq!(attribute(&folder.path("default.h5"), "/diagnostics", "instruction_set"), fastest);
    }
}

#[test]
fn what_the_processor_does_not_have_is_refused() {
    let folder = Folder::new(&small());
    let all = InstructionSet::available().iter().map(|set| set.name()).collect::<Vec<_>>().join(", ");
    let unavailable =
        ["baseline", "avx2", "avx512"].into_iter().filter(|name| InstructionSet::named(name).is_err());
    let commands: [&[&str]; 4] = [
        &["run", "scene.toml"],
        &["check", "scene.toml"],
        &["compare", "scene.toml", "--laws", "emd,gw", "-o", "all.h5"],
        &["asperity", "--law", "emd", "--lambda", "1", "--delta", "0"],
    ];
    for given in ["sse9", "AVX2", "avx2 ", ""].into_iter().chain(unavailable) {
        for arguments in commands {
            let refused = stiction(&folder, given, arguments);
            assert_exit(&refused, 2);
            let message = format!("stiction: {VARIABLE}: {given:?} is none of this processor's: {all}\n");
            assert_eq!(text(&refused.stderr), message);
            assert_eq!(text(&refused.stdout), "");
        }
    }
    assert_eq!(folder.files(), ["scene.toml"]);
    // Help is had all the same, and tells of the variable.
    let help = stiction(&folder, "sse9", &["--help"]);
    assert_exit(&help, 0);
    assert!(text(&help.stdout).contains(VARIABLE), "{}", text(&help.stdout));
}

#[cfg(unix)]
#[test]
fn a_value_that_is_no_text_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new(&small());
    let refused = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["run", "scene.toml"])
        .env(VARIABLE, std::ffi::OsStr::from_bytes(b"avx\xff"))
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    assert_exit(&refused, 2);
    assert!(
        text(&refused.stderr).starts_with(&format!("stiction: {VARIABLE}: ")),
        "{}",
        text(&refused.stderr)
    );
    assert_eq!(folder.files(), ["scene.toml"]);
}
