//! What people come for: scenes to begin with, pull-off after preloads, quantiles, and the probability to stay stuck.

use crate::common::program::{Folder, assert_exit, labelled, looped, small, text, values};
use crate::common::unlocked;

/// A quick loop of summits that flow, not pressed so far that all do.
fn pressed() -> String {
    looped(&small()).replace("from = -1.0", "from = 1.5")
}

#[test]
fn a_template_is_written_once_and_runs() {
    let folder = Folder::new("");
    assert_exit(&folder.stiction(&["new", "pad.toml", "--template", "afm-tip"]), 0);
    let again = folder.stiction(&["new", "pad.toml"]);
    assert_exit(&again, 2);
    assert!(text(&again.stderr).contains("pad.toml: there is such a file; name another one"), "{again:?}");
    assert_exit(&folder.stiction(&["run", "pad.toml", "--replicas", "2"]), 0);
    let unknown = folder.stiction(&["new", "other.toml", "--template", "mems"]);
    assert_exit(&unknown, 2);
    assert!(text(&unknown.stderr).contains("mems-pad"), "{unknown:?}");
    assert!(!folder.files().contains(&"other.toml".to_owned()));
    let materials = folder.stiction(&["new", "--materials"]);
    assert_exit(&materials, 0);
    let printed = text(&materials.stdout);
    for material in ["poly-Si", "SiO2", "Si3N4", "Au", "Al", "DLC", "glass", "PDMS", "FDTS", "OTS"] {
        assert!(printed.lines().any(|line| line.contains(material)), "{material}");
    }
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
}

/// The probability is the share of patches with a larger pull-off force; a force above all has none, of 64 patches at most
/// 1 − 0.025^(1/64) = 5.60 % (scipy.stats.binomtest(0, 64).proportion_ci(method="exact")).
#[test]
fn patches_above_a_force_are_counted() {
    let folder = Folder::new(&small().replace("replicas = 8", "replicas = 64"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "64"]), 0);
    let mut forces = values(&folder, "scene.h5", "/replicas/pull_off_force");
    assert_eq!(forces.len(), 64);
    forces.sort_by(f64::total_cmp);
    let between = 0.5 * (forces[40] + forces[41]);
    let run = folder.stiction(&[
        "run",
        "scene.toml",
        "--replicas",
        "64",
        "--force",
        "--above",
        &format!("{between:e} N"),
    ]);
    assert_exit(&run, 0);
    // Nothing of the file stays open: Windows replaces no open ones.
    let count = {
        let dataset = unlocked::open(folder.path("scene.h5")).dataset("/device/stuck_count").unwrap();
        dataset.read_raw::<u64>().unwrap()
    };
    let share = values(&folder, "scene.h5", "/device/stuck_probability")[0];
    assert_eq!((count[0], share), (23, 23.0 / 64.0));
    assert!(text(&run.stdout).contains("P = 35.94 %"), "{}", text(&run.stdout));
    let run = folder.stiction(&["run", "scene.toml", "--replicas", "64", "--force", "--above", "1 N"]);
    assert!(
        text(&run.stdout).contains("P = 0.00 %, 95 % interval 0.00 % to 5.60 %"),
        "{}",
        text(&run.stdout)
    );
    // The median lies between order statistics that hold it with 95 %; 99.9 % needs 3688 patches.
    let quantiles = values(&folder, "scene.h5", "/pull_off/force_quantile");
    let intervals = values(&folder, "scene.h5", "/pull_off/force_quantile_interval");
    assert!((quantiles[1] - 0.5 * (forces[31] + forces[32])).abs() < 1e-12 * forces[31]);
    assert_eq!(intervals[2..4], [forces[23], forces[40]]);
    assert!(quantiles[3].is_nan());
    let wrong = folder.stiction(&["run", "scene.toml", "--above", "1 um"]);
    assert_exit(&wrong, 2);
    assert!(
        text(&wrong.stderr).contains("restoring_force") && text(&wrong.stderr).contains("a force is needed"),
        "{wrong:?}"
    );
}

/// A misspelt preload is named, and no spring asked for in its place.
#[test]
fn a_misspelt_preload_is_one_mistake() {
    let scene = looped(&small());
    let folder = Folder::new(&format!("{scene}\n[instability]\npreloads = [\"1 uN\"]\n"));
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 2);
    let said = text(&check.stderr);
    assert!(said.contains("did you mean `preload`") && !said.contains("stiffness` is missing"), "{said}");
}

/// The force of a spring over a gap is their product; the pull-off after preloads does not ask for a stiffness.
#[test]
fn preloads_need_no_spring() {
    let run_with = |table: &str| {
        let scene = pressed().replace("\"100 um^2\"", "\"25 um^2\"");
        let folder = Folder::new(&format!(
            "{scene}\n[instability]\n{table}preload = [\"1 uN\", \"20 uN\"]\n[device]\nstiffness = \"2 N/m\"\ngap = \"0.5 um\"\n"
        ));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let (forces, force) = (
            values(&folder, "scene.h5", "/replicas/pull_off_after_preload"),
            values(&folder, "scene.h5", "/device/restoring_force"),
        );
        let stuck = values(&folder, "scene.h5", "/device/stuck_probability_after_preload");
        (forces, force, stuck, text(&run.stdout))
    };
    let (with, force, stuck, _) = run_with("stiffness = \"1 kN/m\"\n");
    let (without, _, _, printed) = run_with("");
    assert_eq!(
        with.iter().map(|force| force.to_bits()).collect::<Vec<u64>>(),
        without.iter().map(|force| force.to_bits()).collect::<Vec<u64>>()
    );
    assert_eq!(force, [1e-6]);
    let known = |i: usize| without.iter().skip(i).step_by(2).filter(|force| !force.is_nan());
    for i in 0..2 {
        let share = known(i).filter(|force| **force > 1e-6).count() as f64 / known(i).count() as f64;
        assert!(share == stuck[i] || share.is_nan() && stuck[i].is_nan(), "{share} {stuck:?}");
    }
    assert!(printed.contains("after a preload") && printed.contains("above 1.000 µN"), "{printed}");
}

/// The table of replicas has a column for each preload, of whose numbers above the force the summary has the share; the pull-off of
/// the whole loop is named as that.
#[test]
fn each_preload_has_columns_in_the_table_of_replicas() {
    let table = "[instability]\npreload = [\"1 uN\", \"20 uN\"]\n[device]\nrestoring_force = \"40 uN\"\n";
    let folder = Folder::new(&format!("{}\n{table}", pressed()));
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let printed = text(&folder.stiction(&["info", "--csv", "--by", "replica", "scene.h5"]).stdout);
    let rows: Vec<Vec<&str>> = printed.lines().map(|line| line.split(',').collect()).collect();
    let stuck = values(&folder, "scene.h5", "/device/stuck_probability_after_preload");
    for (preload, stuck) in ["1e-6", "2e-5"].iter().zip(stuck) {
        let name = format!("replicas/pull_off_after_preload[{preload} N] [N]");
        let place = rows[0].iter().position(|own| **own == name).unwrap();
        let forces: Vec<f64> = rows[1..].iter().map(|row| row[place].parse().unwrap()).collect();
        let above = forces.iter().filter(|force| **force > 40e-6).count() as f64;
        assert!((above / forces.len() as f64 - stuck).abs() < 1e-12 && stuck > 0.0, "{preload} {stuck}");
    }
    assert!(rows[0].contains(&"replicas/pull_off_force_of_whole_loop [N]"), "{:?}", rows[0]);
    assert!(!rows[0].contains(&"replicas/pull_off_force [N]"));
}

/// What follows each preload is a column of the points of a sweep; differences are of whole loops. A warning that all points give is in the summary.
#[test]
fn each_preload_has_columns_in_the_table_of_a_sweep() {
    let scene = pressed().replace("\"7.39 /um^2\"", "\"4 /um^2\"");
    let folder = Folder::new(&format!(
        "{scene}\n[instability]\npreload = [\"20 uN\", \"1 uN\", \"1 N\"]\n[device]\nrestoring_force = \"40 uN\"\n\
         [sweep]\n\"material.work_of_adhesion\" = [\"0.05 J/m^2\", \"0.09 J/m^2\"]\n"
    ));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let printed = labelled(&text(&run.stdout), "warning");
    let begins =
        |words: &str| printed.iter().any(|row| row.starts_with(words) && row.contains("(at all points)"));
    assert!(begins("eta R sigma = 0.0216 is below 0.0249"), "{printed:?}");
    assert!(
        begins("of 40 replicas 40 do not reach 1.000 N: a pull-off after a preload is of those"),
        "{printed:?}"
    );
    let table = text(&folder.stiction(&["info", "--csv", "--all", "scene.h5"]).stdout);
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| {
        let place =
            rows[0].iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name}: {:?}", rows[0]));
        rows[1..].iter().map(|row| row[place].parse().unwrap()).collect::<Vec<f64>>()
    };
    let of =
        |dataset: &str| values(&folder, "scene.h5", dataset).into_iter().step_by(3).collect::<Vec<f64>>();
    let std = of("/instability/pull_off_after_preload_std");
    let reached = column("preload_reached_count[2e-5 N] [1]");
    let errors: Vec<f64> = std.iter().zip(&reached).map(|(std, count)| std / count.sqrt()).collect();
    assert!(reached.iter().all(|count| *count > 30.0), "{reached:?}");
    assert_eq!(column("pull_off_after_preload_standard_error[2e-5 N] [N]"), errors);
    // A row of each point and preload in two tables: its pull-off, and its probability with the interval.
    let means = values(&folder, "scene.h5", "/instability/pull_off_after_preload_mean");
    let stuck = ["", "_low", "_high"]
        .map(|end| values(&folder, "scene.h5", &format!("/device/stuck_probability{end}_after_preload")));
    let printed = text(&run.stdout);
    let (first, second) =
        printed.split_once("P: the probability that the pull-off exceeds 40.00 µN").unwrap();
    let rows_of = |table: &str| -> Vec<String> {
        table.lines().filter(|line| line.contains(" mJ/m^2  ")).map(str::to_owned).collect()
    };
    let (first, second) = (rows_of(first), rows_of(second));
    assert_eq!([first.len(), second.len()], [6, 6], "{printed}");
    for (i, mean) in means.iter().enumerate() {
        let begins =
            format!("{} mJ/m^2  {}", ["50", "90"][i / 3], ["20.00 µN", "1.000 µN", " 1.000 N"][i % 3]);
        assert!(first[i].contains(&begins) && second[i].contains(&begins), "{begins}: {printed}");
        let [share, low, high] = [0, 1, 2].map(|k| format!("{:.1}", 100.0 * stuck[k][i]));
        let (force, chance) = match mean.is_nan() {
            true => (" -  ".to_owned(), vec!["-", "-", "-"]),
            false => (format!(" {:.1} ± ", 1e6 * mean), vec![&share[..], "%", &low, "to", &high, "%"]),
        };
        assert!(first[i].contains(&force), "{force}: {printed}");
        let words: Vec<&str> = second[i].split_whitespace().collect();
        assert!(words.windows(chance.len()).any(|own| own == chance), "{chance:?}: {printed}");
    }
    for name in ["stuck_probability", "stuck_probability_low", "stuck_probability_high"] {
        let after = format!("{name}_after_preload");
        assert_eq!(column(&format!("{after}[2e-5 N] [1]")), of(&format!("/device/{after}")));
        assert!(rows[0].iter().all(|own| !own.starts_with(&format!("device/{name}"))), "{:?}", rows[0]);
    }
    let ends = values(&folder, "scene.h5", "/instability/pull_off_after_preload_interval");
    for (i, name) in ["from", "to"].iter().enumerate() {
        let ends: Vec<f64> = ends.iter().skip(i).step_by(6).copied().collect();
        assert_eq!(column(&format!("pull_off_after_preload_{name}[2e-5 N] [N]")), ends);
    }
    column("differences/pull_off_force_mean_of_whole_loop [N]");
    column("integral/pull_off_force_of_whole_loop [N]");
    // By default there are keys, pull-offs with intervals, probabilities and assessments; others are asked for by name or group.
    let heads = |options: &[&str]| -> Vec<String> {
        let table = folder.stiction(&[&["info", "--csv"], options, &["scene.h5"]].concat());
        assert_exit(&table, 0);
        let table = text(&table.stdout);
        table
            .lines()
            .next()
            .unwrap()
            .split(',')
            .map(|head| head.split([' ', '[']).next().unwrap().to_owned())
            .collect()
    };
    let by_default = heads(&[]);
    let answers = ["material_work_of_adhesion", "pull_off_after_preload_mean", "pull_off_after_preload_from"];
    let others =
        ["stuck_probability_after_preload", "stuck_probability_high_after_preload", "independence/verdict"];
    for name in answers.iter().chain(&others).chain(&["validation/verdict"]) {
        assert!(by_default.iter().any(|own| own == name), "{name}: {by_default:?}");
    }
    assert!(by_default.len() < 40 && rows[0].len() > 80, "{by_default:?}");
    let chosen = heads(&["--columns", "validation,pull_off_after_preload_std"]);
    assert_eq!(chosen[0], "material_work_of_adhesion");
    assert_eq!(chosen.iter().filter(|own| *own == "pull_off_after_preload_std").count(), 3);
    assert!(chosen[4..].iter().all(|own| own.starts_with("validation/")) && chosen.len() > 6, "{chosen:?}");
    let refused = folder.stiction(&["info", "--csv", "--columns", "pull_off_after_preload_sd", "scene.h5"]);
    assert_exit(&refused, 2);
    let message = "has no column `pull_off_after_preload_sd`; did you mean pull_off_after_preload_std?";
    assert!(text(&refused.stderr).contains(message), "{}", text(&refused.stderr));
    let refused = text(&folder.stiction(&["info", "--csv", "--columns", "zzz", "scene.h5"]).stderr);
    assert!(
        refused.contains(
            "has no column `zzz`; there are material_work_of_adhesion, pull_off_after_preload_mean,"
        ),
        "{refused}"
    );
}

/// Rows of a sweep have the values of their keys, of however many keys, and fit 80 columns.
#[test]
fn rows_of_a_sweep_have_the_values_of_their_keys() {
    let keys = [
        ("material.work_of_adhesion", ["50 mJ/m^2", "90 mJ/m^2"]),
        ("material.hardness", ["10 GPa", "12 GPa"]),
        ("surface.lubricant_thickness", ["1 nm", "2 nm"]),
        ("surface.asperity_density", ["100 /um^2", "120 /um^2"]),
        ("surface.asperity_radius", ["100 nm", "120 nm"]),
        ("surface.surface_height_std", ["3 nm", "4 nm"]),
    ];
    let scene = "material.youngs_modulus = \"169 GPa\"\nmaterial.poisson_ratio = 0.22\nmaterial.hardness = \"12 GPa\"\n\
        material.work_of_adhesion = \"20 mJ/m^2\"\nsurface.asperity_radius = \"100 nm\"\n\
        surface.asperity_density = \"100 /um^2\"\nsurface.surface_height_std = \"4 nm\"\nsurface.nominal_area = \"4 um^2\"\n\
        ensemble.replicas = 20\nensemble.model_range = false\ndevice.restoring_force = \"20 nN\"\n";
    for count in [1, 2, 3, 6] {
        let axes = keys[..count].iter().map(|(key, values)| format!("\"{key}\" = {values:?}\n"));
        let folder = Folder::new(&format!("{scene}[sweep]\nmode = \"zip\"\n{}", axes.collect::<String>()));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let printed = text(&run.stdout);
        assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
        for (of, table) in printed.split("P: the probability").enumerate() {
            for (key, value) in
                keys[..count].iter().flat_map(|(key, values)| values.map(|value| (key, value)))
            {
                // The first table stands below the list of keys, which has their ends.
                let often = table.matches(value).count();
                assert!(often > usize::from(of == 0), "{key} = {value} {often} times: {printed}");
            }
        }
    }
}

/// A preload that a share of the replicas misses is warned of.
#[test]
fn missed_preloads_are_warned_of() {
    let folder =
        Folder::new(&format!("{}\n[instability]\npreload = [\"1 uN\", \"1 mN\", \"1 N\"]\n", pressed()));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let reached = unlocked::open(folder.path("scene.h5"));
    let reached = reached.dataset("/instability/preload_reached_count").unwrap().read_raw::<u64>().unwrap();
    assert!((1..40).contains(&reached[1]), "{reached:?}");
    let printed = text(&run.stdout);
    let expected =
        format!("of 40 replicas {} do not reach 1.000 mN, 40 do not reach 1.000 N", 40 - reached[1]);
    let warnings = labelled(&printed, "warning");
    assert!(
        warnings.iter().any(|row| row.starts_with(&expected) && row.contains("smaller h")),
        "{expected}: {printed}"
    );
    assert!(labelled(&printed, "dissipated")[0].starts_with("over all separations, per cycle"), "{printed}");
}

/// A point of a sweep whose preload no replica reaches has no pull-off and no probability, whatever its whole loop holds.
#[test]
fn points_that_miss_their_preload_have_no_pull_off() {
    let scene = pressed().replace("\"100 um^2\"", "\"10 um^2\"");
    let folder = Folder::new(&format!(
        "{scene}\n[instability]\npreload = \"1 N\"\n[device]\nrestoring_force = \"1 nN\"\n\
         [sweep]\n\"material.work_of_adhesion\" = [\"0.05 J/m^2\", \"0.09 J/m^2\"]\n"
    ));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let printed = text(&run.stdout);
    let rows: Vec<Vec<&str>> = printed.lines().map(|line| line.split_whitespace().collect()).collect();
    for energy in ["50", "90"] {
        let of_point: Vec<_> = rows.iter().filter(|row| row.starts_with(&[energy, "mJ/m^2"])).collect();
        assert_eq!(of_point.len(), 2, "{printed}");
        assert!(of_point.iter().all(|row| row[2..5] == ["1.000", "N", "-"]), "{printed}");
    }
    for of_loop in ["NaN", "integral  ", "to the first"] {
        assert!(!printed.contains(of_loop), "{of_loop}: {printed}");
    }
}

/// The default separations reach a preload under each model of flow: flat and sticky summits push less than Hertz's contacts.
#[test]
fn default_separations_reach_preloads_under_every_model_of_flow() {
    default_separations_reach_preloads(&["jg"]);
}

#[test]
#[ignore = "slow: three seconds"]
fn default_separations_reach_preloads_under_other_models_of_flow() {
    default_separations_reach_preloads(&["ke", "zmc", "tn"]);
}

fn default_separations_reach_preloads(contacts: &[&str]) {
    for contact in contacts {
        let folder = Folder::new(&format!(
            "material.youngs_modulus = \"80 GPa\"\nmaterial.poisson_ratio = 0.42\nmaterial.hardness = \"1.2 GPa\"\n\
             material.work_of_adhesion = \"50 mJ/m^2\"\nsurface.asperity_radius = \"80 nm\"\n\
             surface.asperity_density = \"150 /um^2\"\nsurface.surface_height_std = \"4.24 nm\"\n\
             surface.nominal_area = \"10 um^2\"\nmodel.history = \"loop\"\nmodel.plastic_contact = \"{contact}\"\n\
             instability.preload = \"20 uN\"\nensemble.replicas = 16\n"
        ));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let reached = unlocked::open(folder.path("scene.h5"));
        let reached = reached.dataset("/instability/preload_reached_count").unwrap().read_raw::<u64>();
        assert_eq!(reached.unwrap(), [16], "{contact}");
        // The mean after the preload has its interval.
        let printed = text(&run.stdout);
        let row = labelled(&printed, "20.00 µN").join(" ");
        assert!(row.contains(", 95 % ") && row.contains(" below "), "{printed}");
    }
}

/// `check` says where both standard deviations of heights come from; a summary, where the surface's follows.
#[test]
fn sources_of_roughness_are_said() {
    let given = "surface_height_std = \"1.619 nm\"";
    let both = format!("{given}\nasperity_height_std = \"1 nm\"");
    for (heights, surface, asperities) in [
        (given, "1.619 nm: rms height of the surface, given", "from sigma, as of a Gaussian surface"),
        (
            "asperity_height_std = \"1.417 nm\"",
            "surface, from sigma_s, as of a Gaussian surface",
            "asperities, given",
        ),
        (
            both.as_str(),
            "1.619 nm: rms height of the surface, given",
            "1.000 nm: rms height of the asperities, given",
        ),
    ] {
        let folder = Folder::new(&small().replace(given, heights));
        let printed = text(&folder.stiction(&["check", "scene.toml"]).stdout);
        let [sigma, sigma_s] = ["sigma", "sigma_s"].map(|label| labelled(&printed, label).concat());
        assert!(sigma.contains(surface) && sigma_s.contains(asperities), "{printed}");
        let summary = text(&folder.stiction(&["run", "scene.toml"]).stdout);
        assert_eq!(labelled(&summary, "sigma").len(), usize::from(!heights.contains("surface")), "{summary}");
    }
}

/// A sweep has one value where a scene may have two, of both bodies.
#[test]
fn values_of_two_bodies_are_not_swept() {
    for (key, values, advice) in [
        ("material.hardness", "[\"2.5 GPa\", \"9 GPa\"]", "poisson_ratio of the softer body"),
        (
            "surface.surface_height_std",
            "[\"1 nm\", \"1.3 nm\"]",
            "one value there, of both surfaces together",
        ),
    ] {
        let name = key.split_once('.').unwrap().1;
        let scene = small();
        let own = scene.lines().find(|line| line.starts_with(name)).unwrap();
        let scene = scene.replace(own, &format!("{name} = {values}"));
        let folder = Folder::new(&format!("{scene}\n[sweep]\n\"{key}\" = {values}\n"));
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 2);
        let said = text(&check.stderr);
        assert!(said.contains(&format!("`sweep.{key}`")) && said.contains(advice), "{said}");
    }
}
