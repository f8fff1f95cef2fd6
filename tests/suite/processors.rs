//! The same bits on other processors: the program runs with the functions that the C library has for an older
//! one, and on emulated ones.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use crate::common::program::{Folder, assert_exit, bits, looped, skip, small};
use std::process::Command;

/// Every kind of sum, sample and law that calls functions or libraries of its own, small enough for an
/// emulator.
fn scenes() -> Vec<(&'static str, String)> {
    let with = |from: &str, to: &str| {
        let scene = small().replace(from, to);
        assert_ne!(scene, small(), "{from}");
        scene.replace("replicas = 40", "replicas = 16").replace("\"100 um^2", "\"40 um^2")
    };
    // A few asperities of a few surfaces.
    let coupled = |coupling: &str| {
        let table = format!("[substrate]\ncoupling = \"{coupling}\"\n\n[output]");
        let scene = with("[output]", &table).replace("replicas = 16", "replicas = 8");
        scene.replace("\"40 um^2", "\"5 um^2")
    };
    let radius = "asperity_radius = \"3.33 um\"";
    vec![
        ("direct", with("curves = false", "curves = true")),
        ("compressed", with("[output]", "[solver]\nsummation = \"moments\"\n\n[output]")),
        ("loop", looped(&with("[output]", "\n[output]"))),
        ("stratified", with("seed = 1", "seed = 1\nsampling = \"stratified\"")),
        ("fits", with("\"hybrid\"", "\"fit:paper\"")),
        ("truncated", with(radius, &format!("{radius}\nheights = {{ law = \"truncated\", upper = 1.5 }}"))),
        ("coupled", coupled("periodic")),
        ("coupled patch", looped(&coupled("patch"))),
        (
            "sweep",
            with("[material]", "[sweep]\nsurface.nominal_area = [\"60 um^2\", \"90 um^2\"]\n\n[material]"),
        ),
    ]
}

/// Runs each scene natively and by each of the commands, which get the program and its arguments, and
/// compares all bits.
fn assert_same_bits(scenes: &[(&str, String)], others: &[(&str, &dyn Fn() -> Command)]) {
    for (scene, text) in scenes {
        let folder = Folder::new(text);
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "native.h5"]), 0);
        let native = bits(&folder.path("native.h5"));
        assert!(native.len() > 40, "{scene}: {}", native.len());
        for (name, command) in others {
            let run = command()
                .args(["run", "scene.toml", "-o", "other.h5", "--force"])
                .current_dir(folder.path(""))
                .output();
            assert_exit(&run.unwrap(), 0);
            let other = bits(&folder.path("other.h5"));
            assert_eq!(native.len(), other.len());
            for (a, b) in native.iter().zip(&other) {
                assert!(a == b, "{scene}: {} differs on {name}", a.0);
            }
        }
    }
}

/// glibc takes other exponentials, logarithms, powers, sines and cosines where the processor does not
/// multiply and add at once: one in some thousand of their results has another last bit. Its variable, which
/// other C libraries do not know, makes it believe so.
#[test]
#[ignore = "slow: five seconds"]
fn functions_of_the_c_library_do_not_matter() {
    another_c_library_does_not_matter(|name| ["compressed", "fits", "coupled patch"].contains(&name));
}

#[test]
#[ignore = "slow: six seconds"]
fn functions_of_the_c_library_do_not_matter_to_other_scenes() {
    another_c_library_does_not_matter(|name| !["compressed", "fits", "coupled patch"].contains(&name));
}

fn another_c_library_does_not_matter(of: fn(&str) -> bool) {
    let older = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.env("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable");
        command
    };
    let scenes: Vec<_> = scenes().into_iter().filter(|(name, _)| of(name)).collect();
    assert_same_bits(&scenes, &[("an older processor's C library", &older)]);
}

/// Emulated processors with AVX2 and the fused multiply-add, as all have since about 2013; their caches
/// differ from the native ones too. The linear algebra of the joint test chooses its kernels by the
/// processor, and has other last digits without these.
#[test]
#[ignore = "minutes, and needs qemu-x86_64 on the PATH (Debian: qemu-user)"]
fn emulated_processors_have_the_same_bits() {
    if Command::new("qemu-x86_64").arg("--version").output().is_err() {
        return skip("processors", "there is no qemu-x86_64 on the PATH (Debian: qemu-user)");
    }
    if !std::arch::is_x86_feature_detected!("avx2") || !std::arch::is_x86_feature_detected!("fma") {
        return skip("processors", "this processor has no AVX2 or no fused multiply-add");
    }
    let emulated = |processor: &'static str| {
        move || {
            let mut command = Command::new("qemu-x86_64");
            command.args(["-cpu", processor, env!("CARGO_BIN_EXE_stiction")]);
            command
        }
    };
    // An emulated run takes some hundred times as long.
    let few = |names: &[&str]| -> Vec<(&'static str, String)> {
        scenes().into_iter().filter(|(name, _)| names.contains(name)).collect()
    };
    let (haswell, rome) = (emulated("Haswell"), emulated("EPYC-Rome"));
    assert_same_bits(&few(&["direct", "compressed"]), &[("Haswell", &haswell), ("EPYC-Rome", &rome)]);
    assert_same_bits(&few(&["loop"]), &[("EPYC-Rome", &rome)]);
}
