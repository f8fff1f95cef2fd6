//! The program as a user drives it: files, messages, exit codes.

mod pages;

use crate::common::program::{
    ASPERITIES, Folder, QUICK, assert_exit, bits, looped, reported, small, text, unbroken, with_result,
};
use crate::common::unlocked;
use std::path::Path;

#[test]
fn a_run_leaves_one_file_and_a_summary() {
    let folder = Folder::new(&small());
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
    assert_eq!(reported(&run), "", "no progress where standard error is no terminal");
    let summary = text(&run.stdout);
    for part in [
        "hybrid on approach",
        "pull-off",
        "mean over patches",
        "std",
        "cross-check",
        "independence",
        "scene.h5",
    ] {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    let info = folder.stiction(&["info", "scene.h5"]);
    assert_exit(&info, 0);
    assert!(
        text(&info.stdout).contains("format_version") && text(&info.stdout).contains("external_force_mean")
    );
    let validate = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&validate, 0);
    assert!(text(&validate.stdout).contains("agree"));
}

/// Summaries of shipped scenes, with a few replicas: lines of at most 80 characters, and about 15 of them, of
/// points of sweeps, of preloads, of snaps and of warnings more.
fn summaries_fit_a_terminal(scenes: &[(&str, &str)]) {
    let folder = Folder::new("");
    for (name, replicas) in scenes {
        let scene = format!("{}/configs/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let output = format!("{}.h5", name.replace('/', "_"));
        let run = folder.stiction(&["run", &scene, "--replicas", replicas, "-o", &output]);
        assert_exit(&run, 0);
        let summary = text(&run.stdout);
        assert!(summary.lines().all(|line| line.chars().count() <= 80), "{name}: {summary}");
        let mut label = "";
        let counted = summary.lines().filter(|line| {
            let is_row = line.starts_with(&" ".repeat(20))
                || line.get(2..).is_some_and(|row| row.starts_with(char::is_alphabetic));
            label = line.get(2..20).map(str::trim).filter(|label| !label.is_empty()).unwrap_or(label);
            // What follows a preload has its own rows, as the points of a sweep.
            let is_of_preload = label.ends_with('N') && label.starts_with(|c: char| c.is_ascii_digit());
            is_row && !is_of_preload && !["warning", "snap-in", "preload"].contains(&label)
        });
        assert!(counted.count() <= 18, "{name}: {summary}");
    }
}

#[test]
fn summaries_of_a_patch_and_of_a_sweep_fit_a_terminal() {
    summaries_fit_a_terminal(&[("quick", "16"), ("coupled", "2")]);
}

#[test]
#[ignore = "slow: twenty seconds"]
fn summaries_of_other_shipped_scenes_fit_a_terminal() {
    summaries_fit_a_terminal(&[
        ("voltage", "4"),
        ("instability", "2"),
        ("case_iii", "8"),
        ("loop", "8"),
        ("preload", "4"),
        ("humidity", "4"),
        ("sweep_roughness", "4"),
        ("surfaces/poisson", "8"),
        ("coupled/patches", "2"),
        ("target", "16"),
    ]);
}

/// Five separations say of the integral's pull-off and stiffest point what ninety-one do, and tell the shares
/// at pull-off, not those at the separation next to it: the same as a polynomial through what the fine ones
/// have around it.
#[test]
fn coarse_separations_tell_the_same_of_the_integral() {
    let results = [5, 91].map(|count| {
        let folder = Folder::new(&QUICK.replace("count = 91", &format!("count = {count}")));
        let run = folder.stiction(&["run", "scene.toml", "--replicas", "20"]);
        assert_exit(&run, 0);
        let summary = unbroken(&text(&run.stdout));
        assert_eq!(
            summary.contains("the curves miss 54 % of the pull-off at h* = 2.815"),
            count == 5,
            "{summary}"
        );
        let file = unlocked::open(folder.path("scene.h5"));
        let model = file.group("integral").unwrap();
        let names = ["pull_off_force", "pull_off_separation", "peak_stiffness", "peak_stiffness_separation"];
        let read: Vec<f64> =
            names.iter().map(|name| model.attr(name).unwrap().read_scalar().unwrap()).collect();
        let values = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
        let shares = ["pull_off_regime_count", "pull_off_regime_adhesion_force", "pull_off_contact_area"];
        let shares: Vec<f64> = shares.iter().flat_map(|name| values(&format!("/integral/{name}"))).collect();
        let curves = ["regime_count", "regime_adhesion_force", "contact_area"];
        let curves: Vec<f64> = curves.iter().flat_map(|name| values(&format!("/integral/{name}"))).collect();
        (read, shares, values("/ensemble/separation"), curves)
    });
    let [(read, shares, ..), (read_of_fine, shares_of_fine, separations, curves)] = results;
    for (coarse, fine) in read.iter().zip(&read_of_fine) {
        assert!((coarse / fine - 1.0).abs() < 1e-4, "{coarse:e} {fine:e}");
    }
    for ((coarse, fine), curve) in shares.iter().zip(&shares_of_fine).zip(curves.chunks_exact(91)) {
        let around = stiction::math::interpolation::lagrange::<6>(&separations, curve, read[1]);
        // Where a regime is in its tail the polynomial is not what the curve is.
        let tail = 1e-9 * curve.iter().copied().fold(0.0, f64::max);
        assert!((coarse - around).abs() <= 1e-3 * around + tail, "{coarse:e} {around:e}");
        assert!((coarse - fine).abs() <= 1e-3 * fine, "{coarse:e} {fine:e}");
    }
    assert_eq!(shares.len(), 13);
}

#[test]
fn bits_do_not_depend_on_threads() {
    let folder = Folder::new(&small().replace("curves = false", "curves = true"));
    let reference = folder.path("1.h5");
    for threads in ["1", "2", "3", "8"] {
        let output = format!("{threads}.h5");
        assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", threads, "-o", &output]), 0);
        let (expected, found) = (bits(&reference), bits(&folder.path(&output)));
        assert!(expected.len() > 40, "{}", expected.len());
        for (a, b) in expected.iter().zip(&found) {
            assert_eq!(a, b, "{threads} threads");
        }
    }
    // The seed does change them.
    assert_exit(&folder.stiction(&["run", "scene.toml", "--seed", "2", "-o", "seed.h5"]), 0);
    assert_ne!(bits(&reference), bits(&folder.path("seed.h5")));
}

#[test]
fn fewer_replicas_are_the_first_ones() {
    let folder = with_result();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "11", "-o", "few.h5"]), 0);
    let pull_off = |name: &str| {
        let file = unlocked::open(folder.path(name));
        file.dataset("/replicas/pull_off_force").unwrap().read_raw::<f64>().unwrap()
    };
    assert_eq!(pull_off("few.h5"), pull_off("scene.h5")[..11]);
}

#[test]
fn an_existing_output_is_kept_unless_forced() {
    let folder = Folder::new(&small());
    std::fs::write(folder.path("scene.h5"), "precious").unwrap();
    let refused = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&refused, 2);
    assert!(text(&refused.stderr).contains("scene.h5 exists; give --force"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(folder.path("scene.h5")).unwrap(), b"precious");
    assert_exit(&folder.stiction(&["run", "scene.toml", "--force"]), 0);
    assert_exit(&folder.stiction(&["info", "scene.h5"]), 0);
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
}

#[test]
fn an_output_that_cannot_be_is_refused_before_computing() {
    let folder = Folder::new(&small());
    let missing = folder.stiction(&["run", "scene.toml", "-o", "nowhere/out.h5"]);
    assert_exit(&missing, 2);
    assert!(text(&missing.stderr).contains("the folder nowhere of the output does not exist"));
    // /proc takes no files from anybody, root included.
    if cfg!(target_os = "linux") {
        let unwritable = folder.stiction(&["run", "scene.toml", "-o", "/proc/out.h5"]);
        assert_exit(&unwritable, 2);
        assert!(text(&unwritable.stderr).contains("cannot write in /proc"), "{}", text(&unwritable.stderr));
    }
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// A planted disagreement: the integral of the file is changed by 5 %.
#[test]
fn validate_sees_a_disagreement() {
    let folder = with_result();
    {
        let file = unlocked::open_rw(folder.path("scene.h5"));
        let dataset = file.dataset("/integral/adhesion_force").unwrap();
        let changed: Vec<f64> = dataset.read_raw::<f64>().unwrap().iter().map(|force| 1.05 * force).collect();
        dataset.write_raw(&changed).unwrap();
    }
    let validate = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&validate, 3);
    assert!(text(&validate.stdout).contains("disagree"));
}

#[test]
fn one_asperity_is_printed_as_csv() {
    let folder = Folder::new("");
    let solved = folder.stiction(&["asperity", "--law", "emd", "--lambda", "1", "--delta", "-3", "0"]);
    assert_exit(&solved, 0);
    let rows: Vec<String> = text(&solved.stdout).lines().map(str::to_owned).collect();
    assert_eq!(rows[0], "lambda,delta,branch,adhesion_force,external_force,contact_radius");
    assert_eq!(rows.len(), 3);
    let fields: Vec<&str> = rows[2].split(',').collect();
    assert_eq!(fields[2], "contact");
    // 50-digit value.
    assert!((fields[3].parse::<f64>().unwrap() / 3.0650413658748398 - 1.0).abs() < 1e-14);
    assert!(
        fields[3].starts_with("3.065041365874839") || fields[3].starts_with("3.065041365874840"),
        "{}",
        fields[3]
    );

    // A table among other columns, both histories.
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/single_asperity.csv");
    for path in ["approach", "retraction"] {
        let solved = folder.stiction(&["asperity", "--law", "emd", "--table", table, "--path", path]);
        assert_exit(&solved, 0);
        assert_eq!(text(&solved.stdout).lines().count(), 323);
    }
}

/// What a solve took beside what it found, which stays as it is: with starting tables one evaluation, without
/// them a bracketed search.
#[test]
fn what_a_solve_took_is_printed_when_asked_for() {
    let folder = Folder::new("");
    let deltas = ["asperity", "--law", "emd", "--lambda", "1", "--delta", "-3", "0", "-5e5"];
    let plain = text(&folder.stiction(&deltas).stdout);
    for (tables, safeguarded) in [(None, ["1", "1", "1"]), (Some("--tables=20"), ["0", "0", "1"])] {
        let asked = [&deltas[..], &["--diagnostics"], tables.as_slice()].concat();
        let solved = folder.stiction(&asked);
        assert_exit(&solved, 0);
        let solved = text(&solved.stdout);
        for ((i, plain), line) in plain.lines().enumerate().zip(solved.lines()) {
            let (values, took) = line.match_indices(',').nth(5).map(|(end, _)| line.split_at(end)).unwrap();
            if i == 0 {
                assert_eq!((values, took), (plain, ",iterations,safeguarded"));
                continue;
            }
            let number =
                |text: &str, column: usize| text.split(',').nth(column).unwrap().parse::<f64>().unwrap();
            assert!((number(values, 3) / number(plain, 3) - 1.0).abs() < 1e-14, "{values} {plain}");
            let [iterations, bracketed] = [1, 2].map(|column| took.split(',').nth(column).unwrap());
            assert_eq!(bracketed, safeguarded[i - 1], "{line}");
            let iterations: u32 = iterations.parse().unwrap();
            // Three units before contact a series may take the place of the solve.
            assert!(
                if bracketed == "1" { (3..=70).contains(&iterations) } else { iterations <= 1 },
                "{line}"
            );
        }
        assert_eq!(solved.lines().count(), 4);
    }
    let refused = folder.stiction(&[&deltas[..], &["--tables", "20"]].concat());
    assert_exit(&refused, 2);
    assert!(text(&refused.stderr).contains("--diagnostics"), "{}", text(&refused.stderr));
}

#[test]
fn bad_arguments_of_asperity_are_named() {
    let folder = Folder::new("");
    std::fs::write(folder.path("table.csv"), "lambda,approach\n1,2\n").unwrap();
    std::fs::write(folder.path("words.csv"), "lambda,delta\n1,two\n").unwrap();
    let cases: [(&[&str], &str); 11] = [
        (
            &["--law", "edm", "--lambda", "1", "--delta", "0"],
            "--law edm: unknown law; known: md_plastic, hybrid, emd",
        ),
        (&["--law", "md_kin", "--lambda", "1", "--delta", "0"], "did you mean md_kim?"),
        (&["--law", "ke", "--lambda", "1", "--delta", "0"], "give --critical-interference"),
        (
            &["--law", "ke", "--lambda", "1", "--delta", "0", "--critical-interference", "0"],
            "a positive number is needed",
        ),
        (
            &["--law", "ke", "--lambda", "1", "--delta", "200", "--critical-interference", "1"],
            "give --poisson-ratio",
        ),
        (
            &["--law", "emd", "--lambda", "1", "--delta", "0", "--lubricant-thickness=-1"],
            "0 or a positive number is needed",
        ),
        (&["--law", "emd", "--lambda", "1e9", "--delta", "0"], "outside 1e-6..1e6"),
        (&["--law", "emd", "--lambda", "1", "--delta", "nan"], "a finite number is needed"),
        (&["--law", "emd", "--table", "table.csv"], "no column `delta`"),
        (&["--law", "emd", "--table", "words.csv"], "line 2: delta = `two` is not a number"),
        (&["--law", "emd", "--lambda", "1", "--delta", "0", "--path", "both"], "known: approach, retraction"),
    ];
    for (arguments, message) in cases {
        let refused = folder.stiction(&[&["asperity"], arguments].concat());
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains(message), "{arguments:?}: {}", text(&refused.stderr));
    }
}

fn sampled(scheme: &str) -> String {
    let scene = small().replace("\"100 um^2\"", "\"20 um^2\"");
    scene.replace("[ensemble]", &format!("[ensemble]\nsampling = \"{scheme}\""))
}

/// Every scheme through the whole program: the file says it, its cross-check is computed anew from the file,
/// and bits do not depend on threads.
#[test]
fn sampling_schemes_are_honoured() {
    for scheme in ["independent", "antithetic", "stratified"] {
        let folder = Folder::new(&sampled(scheme));
        assert!(text(&folder.stiction(&["check", "scene.toml"]).stdout).contains(&format!("  {scheme}: ")));
        let run =
            folder.stiction(&["run", "scene.toml", "--replicas", "160", "--threads", "1", "-o", "1.h5"]);
        assert_exit(&run, 0);
        let summary = text(&run.stdout);
        let p =
            |text: &str| text.split("p = ").nth(1).map(|rest| rest.split('\n').next().unwrap().to_owned());
        assert!(p(&summary).is_some(), "{summary}");
        assert_exit(
            &folder.stiction(&["run", "scene.toml", "--replicas", "160", "--threads", "3", "-o", "3.h5"]),
            0,
        );
        assert_eq!(bits(&folder.path("1.h5")), bits(&folder.path("3.h5")));
        let validate = folder.stiction(&["validate", "1.h5"]);
        assert_exit(&validate, 0);
        let validated = text(&validate.stdout);
        assert_eq!(p(&validated), p(&summary), "{scheme}");
        let info = text(&folder.stiction(&["info", "1.h5"]).stdout);
        let line = info.lines().find(|line| line.trim_start().starts_with("sampling ")).unwrap_or_default();
        assert!(line.ends_with(scheme), "{info}");
    }
}

/// One group has a mean and a scatter, but no standard error; the joint test takes its scatter from the law
/// and is reported all the same.
#[test]
fn one_group_has_no_standard_error() {
    let folder = Folder::new(&sampled("stratified"));
    let run = folder.stiction(&["run", "scene.toml", "--replicas", "8"]);
    assert_exit(&run, 0);
    let summary = text(&run.stdout);
    assert!(
        summary.contains("one group of replicas: no standard error")
            && summary.contains("ensemble and integral agree"),
        "{summary}"
    );
    assert!(!summary.contains("NaN") && !summary.contains('±'), "{summary}");
    assert!(text(&folder.stiction(&["validate", "scene.h5"]).stdout).contains("ensemble and integral agree"));
}

/// The highest of four asperities that scatter by 1 µm touches alone, so that each patch pulls 2πRΔγ, 125.7 nN:
/// a closed form. That all replicas agree is no certainty: of eight 1 − 0.05^(1/8) = 31 % may differ, and a target
/// of 1 % is met when 3/n is below 2 %.
#[test]
fn replicas_that_agree_have_a_bound_in_the_place_of_an_error() {
    let scene = |ensemble: &str| {
        format!(
            r#"format = 1
[material]
reduced_modulus = "20 GPa"
hardness = "1 TPa"
poisson_ratio = 0.3
work_of_adhesion = "0.02 J/m^2"
equilibrium_spacing = "0.3 nm"
[surface]
asperity_radius = "1 um"
asperity_density = "0.04 /um^2"
asperity_height_std = "1 um"
mean_plane_offset = "0 nm"
nominal_area = "100 um^2"
[model]
law = "dmt"
[separation]
h = {{ from = "-1 um", to = "6 um", count = 101 }}
[ensemble]
{ensemble}
"#
        )
    };
    let target =
        "target = { quantity = \"pull_off_force\", relative_standard_error = 0.01 }\nmin_replicas = 8";
    for (ensemble, replicas) in [("replicas = 8", 8), (target, 152)] {
        let folder = Folder::new(&scene(ensemble));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let percent = 100.0 * (1.0 - 0.05_f64.powf(1.0 / f64::from(replicas)));
        let summary = unbroken(&text(&run.stdout));
        let agree = format!("all {replicas} replicas agree: with 95 % confidence at most {percent:.3}");
        assert!(
            summary.contains("125.7 nN") && summary.contains(&agree[..agree.len() - 2]),
            "{agree} {summary}"
        );
        assert!(!summary.contains("NaN") && !summary.contains('±'), "{summary}");
        assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    }
}

#[test]
fn replicas_that_are_no_whole_groups_are_refused() {
    let folder = Folder::new(&sampled("stratified"));
    std::fs::write(folder.path("scene.h5"), "precious").unwrap();
    for command in
        [&["run", "scene.toml", "--force"][..], &["compare", "scene.toml", "--laws", "emd", "--ensemble"]]
    {
        let refused = folder.stiction(&[command, &["--replicas", "20"]].concat());
        assert_exit(&refused, 2);
        let error = text(&refused.stderr);
        assert!(
            error.contains(
                "--replicas 20: sampling = \"stratified\" needs a multiple of 8 replicas, such as 16 or 24"
            ),
            "{error}"
        );
    }
    assert_eq!(std::fs::read(folder.path("scene.h5")).unwrap(), b"precious");
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
}

/// The R of a scene of measured asperities is the mean of their radii.
#[test]
fn the_radius_of_measured_asperities_is_their_mean() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Folder::new(&std::fs::read_to_string(root.join("configs/surfaces/measured.toml")).unwrap());
    std::fs::copy(ASPERITIES, folder.path("polished.h5")).unwrap();
    let file = unlocked::open(folder.path("polished.h5"));
    let radii = file.dataset("/asperities/radius").unwrap().read_raw::<f64>().unwrap();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let check = text(&folder.stiction(&["check", "scene.toml"]).stdout);
    assert!(unbroken(&check).contains(&format!("mean radius {:.3} µm", 1e6 * mean)), "{check}");
}

/// What is no scene is refused in words that say what it is; a pipe that nobody writes to is not waited for.
#[test]
fn what_is_no_text_is_said() {
    let folder = with_result();
    std::fs::write(folder.path("latin.toml"), b"title = \"\xb5m\"\n").unwrap();
    for (name, part) in [
        ("scene.h5", "scene.h5: is an HDF5 file, not a text; `stiction info` shows what is in a result"),
        ("latin.toml", "latin.toml: is not a text in UTF-8: byte 10 belongs to no character"),
    ] {
        for command in ["run", "check"] {
            let output = folder.stiction(&[command, name, "--quiet"][..if command == "run" { 3 } else { 2 }]);
            assert_exit(&output, 2);
            assert!(text(&output.stderr).contains(part), "{}", text(&output.stderr));
        }
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_read_if_somebody_writes_to_it() {
    let folder = Folder::new(&small());
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.toml")).status().unwrap();
    assert!(made.success());
    for arguments in [
        &["check", "pipe.toml"][..],
        &["run", "pipe.toml", "--quiet"],
        &["asperity", "--law", "md", "--table", "pipe.toml"],
    ] {
        let refused = folder.stiction(arguments);
        assert_exit(&refused, 2);
        assert!(
            text(&refused.stderr).contains("is a pipe that nobody writes to; name a file"),
            "{}",
            text(&refused.stderr)
        );
    }
    let (pipe, scene) = (folder.path("pipe.toml"), small());
    let writer = std::thread::spawn(move || std::fs::write(pipe, scene));
    let output =
        (0..100).map(|_| folder.stiction(&["check", "pipe.toml"])).find(|output| output.status.success());
    assert!(text(&output.unwrap().stdout).contains("case II"));
    writer.join().unwrap().unwrap();
}

/// A scene may come from anybody and name any file of the user: what is in it is not in the messages.
#[test]
fn files_that_scenes_name_are_not_shown() {
    let folder = Folder::new("");
    std::fs::write(folder.path("private"), "root:x:0:0:secret\nhidden:1\n").unwrap();
    for column in ["\"height\"", "1", "3"] {
        let heights =
            format!("heights = {{ law = \"file\", path = \"private\", column = {column}, unit = \"nm\" }}");
        let scene = small().replace("[surface]", &format!("[surface]\n{heights}"));
        std::fs::write(folder.path("scene.toml"), scene).unwrap();
        let output = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&output, 2);
        let message = text(&output.stderr);
        assert!(message.contains("private"), "{message}");
        assert!(!["root", "secret", "hidden"].iter().any(|word| message.contains(word)), "{message}");
    }
}

/// `info` shows the values of datasets that have one, or a few with names, with errors and units as the file has
/// them, and the shape of others; `run --verbose` prints it behind the summary.
#[test]
fn info_has_values_and_a_verbose_run_all_of_it() {
    let folder = Folder::new(&small());
    let run = folder.stiction(&["run", "scene.toml", "--verbose"]);
    assert_exit(&run, 0);
    let info = text(&folder.stiction(&["info", "scene.h5"]).stdout);
    let printed = text(&run.stdout);
    assert!(printed.contains("  cross-check") && printed.ends_with(&format!("\n\n{info}")), "{printed}");
    let row = |name: &str| -> Vec<&str> {
        let row = info.lines().find_map(|line| line.trim_start().strip_prefix(name)?.strip_prefix(' '));
        row.unwrap_or_else(|| panic!("{name}: {info}")).split_whitespace().collect()
    };
    let file = unlocked::open(folder.path("scene.h5"));
    let of = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap()[0];
    let [mean, sign, error, unit] = row("scalar_mean[pull_off_force]")[..] else { panic!("{info}") };
    let is_near = |shown: &str, value: f64, digits: f64| {
        (shown.parse::<f64>().unwrap() / value - 1.0).abs() <= 0.5 * 10f64.powf(1.0 - digits)
    };
    assert!(is_near(mean, of("/ensemble/scalar_mean"), 6.0) && sign == "±" && unit == "N", "{info}");
    assert!(is_near(error, of("/ensemble/scalar_standard_error"), 2.0), "{info}");
    assert!(is_near(row("shift")[0], of("/independence/shift"), 6.0) && row("shift")[1] == "m", "{info}");
    assert!(!info.contains("scalar_standard_error") && !info.contains("scalar_units"), "{info}");
    let interval = file.dataset("/ensemble/scalar_interval").unwrap().read_raw::<f64>().unwrap();
    for (name, unit, ends) in [("pull_off_force", "N", 0), ("peak_secant_stiffness", "N", 4)] {
        let shown = row(&format!("scalar_interval[{name}]"));
        assert!(
            is_near(shown[0], interval[ends], 6.0) && is_near(shown[2], interval[ends + 1], 6.0),
            "{info}"
        );
        assert!(shown[1] == "to" && shown[3] == unit, "{info}");
    }
    assert_eq!(row("external_force_quantile"), ["5", "x", "16", "(quantile,", "separation)"]);
}

/// What is reported of a result stands in two columns, however long its names are.
#[test]
fn columns_of_info_do_not_touch() {
    let scene = looped(&small());
    let folder = Folder::new(&scene.replace("from = -1.0", "from = 1.5"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--quiet", "--replicas", "8"]), 0);
    let info = text(&folder.stiction(&["info", "scene.h5"]).stdout);
    let (head, _) = info.split_once("\nscene\n").unwrap();
    let rows: Vec<&str> = head.lines().filter(|line| line.starts_with("  ")).collect();
    let names: Vec<&str> = rows.iter().map(|row| row.split_whitespace().next().unwrap()).collect();
    assert!(names.iter().map(|name| name.len()).max() > Some(46), "{info}");
    let column = |row: &&str| row.len() - row[2..].split_once("  ").unwrap().1.trim_start().len();
    assert!(rows.iter().all(|row| column(row) == column(&rows[0])), "{info}");
}

/// A log gets a line after ten seconds, and none with --quiet.
#[test]
#[ignore = "slow: twelve seconds"]
fn there_is_a_sign_of_life_without_a_terminal() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let folder = Folder::new(&small().replace("replicas = 40", "replicas = 100000000"));
    let begin = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.args(["run", "scene.toml", "--threads", "1"]).args(arguments).current_dir(folder.path(""));
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let (mut reported, mut quiet) = (begin(&["-o", "reported.h5"]), begin(&["-o", "quiet.h5", "--quiet"]));
    let mut line = String::new();
    BufReader::new(reported.stderr.take().unwrap()).read_line(&mut line).unwrap();
    assert!(
        line.starts_with("stiction: ensemble: ") && line.contains(" of 100000000 replicas, 10 s so far"),
        "{line}"
    );
    for child in [&mut reported, &mut quiet] {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let mut said = String::new();
    quiet.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(said, "");
}

/// A run by the library has the bits of the command's, with the curves of its replicas; it overwrites
/// nothing, and ends when it is reported to.
#[test]
fn a_run_from_rust_is_that_of_the_command() {
    let folder = Folder::new(&small().replace("curves = false", "curves = true"));
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let scene = stiction::Scene::from_toml_file(folder.path("scene.toml")).unwrap();
    let result = stiction::builder(&scene).threads(2).run().unwrap();
    result.write(folder.path("library.h5")).unwrap();
    assert_eq!(bits(&folder.path("library.h5")), bits(&folder.path("scene.h5")));
    let means = unlocked::open(folder.path("scene.h5")).dataset("/ensemble/scalar_mean").unwrap();
    assert_eq!(means.read_raw::<f64>().unwrap()[0].to_bits(), result.pull_off().mean.to_bits());
    let error = result.write(folder.path("library.h5")).unwrap_err();
    assert!(matches!(error, stiction::Error::Output(stiction::OutputError::Exists(_))), "{error}");
    assert_exit(&folder.stiction(&["validate", "library.h5"]), 0);
    let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let stopped = stiction::builder(&scene).stop(stop).run();
    assert!(matches!(stopped, Err(stiction::Error::Interrupted { kept: false, .. })));
}

#[test]
fn a_sweep_is_no_scene() {
    let folder = Folder::new(&format!(
        "{}\n[sweep]\nsurface.surface_height_std = [\"1.4 nm\", \"1.8 nm\"]\n",
        small()
    ));
    let error = stiction::Scene::from_toml_file(folder.path("scene.toml")).unwrap_err().to_string();
    assert!(error.contains("scene.toml: has a table [sweep]"), "{error}");
    let error = stiction::Scene::from_toml_file(folder.path("none.toml")).unwrap_err().to_string();
    assert!(error.contains("none.toml: cannot be read"), "{error}");
}

/// The adhesive stress of a sticky metal is above its hardness, and its loop gives out energy, which is said to be no result. Case II,
/// dry, turned where few asperities have yielded, dissipates.
#[test]
#[ignore = "slow: three seconds"]
fn a_loop_that_gives_out_energy_is_no_result() {
    let scene = QUICK
        .replace("lubricant_thickness = \"0.5 nm\"      # inferred\n", "")
        .replace("law = \"hybrid\"\nhistory = \"approach\"", "history = \"loop\"")
        .replace("from = -1.0, to = 8.0, count = 91", "from = 1.5, to = 6.0, count = 91");
    let words = "no result: a loop cannot give out energy";
    let folder = Folder::new(&scene);
    let summary = |settings: &[&str]| {
        let run = folder.stiction(&[&["run", "scene.toml", "--force"], settings].concat());
        assert_exit(&run, 0);
        unbroken(&text(&run.stdout))
    };
    let sticky = summary(&[
        "--set",
        "material.work_of_adhesion=1 J/m^2",
        "--set",
        "material.hardness=0.3 GPa",
        "--set",
        "model.plastic_contact=tn",
    ]);
    assert!(
        sticky.contains(words) && sticky.contains("dissipated per cycle: mean over patches -"),
        "{sticky}"
    );
    let own = summary(&[]);
    assert!(own.contains("md_plastic on loop"), "{own}");
    assert!(!own.contains(words) && !own.contains("dissipated per cycle: mean -"), "{own}");
}

/// A message names the option or key, what was given, and what would do.
#[test]
fn messages_say_what_would_do() {
    let scene = looped(&small());
    let folder = Folder::new(&scene);
    let refused = |arguments: &[&str]| {
        let run = folder.stiction(arguments);
        assert_exit(&run, 2);
        text(&run.stderr)
    };
    for (options, message) in [
        (
            &["--above", "80"][..],
            "--above 80: `device.restoring_force = \"80\"`: the unit is missing; a force is needed",
        ),
        (
            &["--above", "-1 uN"],
            "--above -1 uN: `device.restoring_force = \"-1 uN\"`: has to be greater than 0",
        ),
        (&["--replicas", "-5"], "invalid value '-5' for '--replicas <REPLICAS>': a whole number from 0 to"),
        (&["--seed", "-5"], "invalid value '-5' for '--seed <SEED>': a whole number from 0 to"),
        (
            &["--set", "material.hardness=12 GPA"],
            "unknown unit `GPA` (did you mean `GPa`?); a pressure is needed",
        ),
        (&["--set", "material.hardness=1200 HV"], "unknown unit `HV` (1 HV is 9.807 MPa: \"11.768 GPa\")"),
        (
            &["--set", "instability.preload=[\"1 uN\", \"2 uN\", \"1 uN\"]"],
            "`instability.preload[2] = \"1 uN\"`: is given twice; give it once",
        ),
        (
            &["--set", "surface.surface_height_std=6 um"],
            "`surface.surface_height_std = \"6 um\"`: is above asperity_radius, 3.330 µm",
        ),
    ] {
        let printed = refused(&[&["run", "scene.toml"], options].concat());
        assert!(printed.contains(message), "{message}: {printed}");
    }
    // R and eta that would do, do: sigma_s = 0 at them.
    let printed = refused(&["run", "scene.toml", "--set", "surface.asperity_radius=1 um"]);
    let (_, advice) = printed.split_once(": R above ").unwrap_or_else(|| panic!("{printed}"));
    let words: Vec<&str> = advice.split_whitespace().collect();
    let (radius, density) = (format!("{} {}", words[0], words[1]), format!("{} {}", words[5], words[6]));
    for (least, key, others) in [
        (radius, "asperity_radius", &[][..]),
        (density, "asperity_density", &["--set", "surface.asperity_radius=1 um"]),
    ] {
        let (number, unit) = least.split_once(' ').unwrap();
        let tried = |factor: f64| {
            let number: f64 = number.parse().unwrap();
            let setting = format!("surface.{key}={} {unit}", number * factor);
            folder.stiction(&[&["check", "scene.toml", "--set", &setting], others].concat())
        };
        assert_exit(&tried(1.01), 0);
        assert!(text(&tried(0.99).stderr).contains("would do"), "{least}");
    }
    let help = folder.stiction(&["help", "--help"]);
    assert_exit(&help, 0);
    assert_eq!(text(&help.stdout), text(&folder.stiction(&["--help"]).stdout));
    let few = folder.stiction(&["check", "scene.toml", "--set", "surface.surface_height_std=20 nm"]);
    let printed = text(&few.stdout).split_whitespace().collect::<Vec<&str>>().join(" ");
    assert!(printed.contains("is above 0.204, the most of isotropic Gaussian surfaces"), "{printed}");
}
