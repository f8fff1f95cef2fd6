//! What the table of keys says, against the reader: defaults, keys that have to be there, and those that
//! exclude others.

use super::{files, line, scene_of, texts};
use std::path::Path;
use std::sync::Arc;
use stiction::input::columns::SceneFiles;
use stiction::scene::{Absent, Document, KEYS, Key, Scene};

/// What a scene says, whatever its text.
fn said(folder: &Path, text: &str) -> Result<String, String> {
    let files = Arc::new(SceneFiles::scene(&folder.join("scene.toml")));
    let mut document = Document::parse(text, files).map_err(|error| error.to_string())?;
    document.scene.text.clear();
    let sweep = document.sweep.map(|sweep| (sweep.mode, sweep.common_random_numbers, sweep.axes));
    Ok(format!("{:?} {sweep:?}", document.scene))
}

/// The texts of all scenes that have a key.
fn with(key: &Key) -> impl Iterator<Item = String> {
    texts().into_iter().filter(|text| line(text, key).is_some())
}

#[test]
fn defaults_are_what_holds_without_the_key() {
    assert!(defaults_hold(|name| !name.starts_with("capillary.film")) > 15);
}

/// Films are solved whenever a scene is read.
#[test]
#[ignore = "slow: three seconds"]
fn defaults_of_films_are_what_holds_without_the_key() {
    assert!(defaults_hold(|name| name.starts_with("capillary.film")) > 0);
}

fn defaults_hold(of: fn(&str) -> bool) -> usize {
    let folder = files();
    let mut seen = 0;
    for key in KEYS.iter().filter(|key| of(key.name)) {
        let Absent::Is(default) = key.absent else { continue };
        let text = with(key).next().unwrap_or_else(|| panic!("no scene has {}", key.name));
        // What needs the key is left out with it.
        let text = match key.name {
            "solver.summation" => text.replace("solver.tolerance = 1e-9\n", ""),
            _ => text,
        };
        // Films are solved at every separation.
        let text = text.replace("count = 91", "count = 3");
        let own = line(&text, key).unwrap();
        let given = text.replace(own, &format!("{} = {default}\n", own.split(" = ").next().unwrap()));
        let [absent, given] = [text.replace(own, ""), given].map(|text| said(folder.path(), &text));
        assert_eq!(
            absent.as_ref().map_err(|error| format!("{}: {error}", key.name)),
            Ok(given.as_ref().unwrap())
        );
        seen += 1;
    }
    seen
}

#[test]
fn what_has_to_be_there_is_missed() {
    let folder = files();
    for key in KEYS.iter().filter(|key| matches!(key.absent, Absent::Required) && !key.name.contains('[')) {
        // A measured surface has an area, as has one under a body, and a key that is swept has its values there.
        let elsewhere = |text: &String| {
            key.name == "surface.nominal_area"
                && (text.contains("surface.asperities") || text.contains("shape.body"))
                || text.lines().any(|line| line.starts_with("sweep") && line.contains(key.name))
        };
        for text in with(key).filter(|text| !elsewhere(text)) {
            let absent = text.replace(line(&text, key).unwrap(), "");
            let error =
                said(folder.path(), &absent).err().unwrap_or_else(|| panic!("{} is not missed", key.name));
            let last = key.name.rsplit('.').next().unwrap();
            assert!(error.contains(last), "{}: {error}", key.name);
        }
    }
}

/// Worked by hand: 1/E_r = (1 - 0.22²)/169 + (1 - 0.33²)/70 = (0.9516·70 + 0.8911·169)/11830 per GPa, and 50
/// + 60 - 20 = 90 mJ/m². Two incompressible bodies of 100 GPa have 4/3 of half a modulus; a body beside one
///   ten thousand times as stiff nearly its own.
#[test]
fn bodies_have_the_reduced_modulus_and_the_work_of_adhesion_worked_by_hand() {
    let plain = scene_of(&(
        &[
            "material.reduced_modulus",
            "material.work_of_adhesion",
            "material.poisson_ratio",
            "material.hardness",
        ],
        &[],
        &[],
    ));
    for (bodies, expected) in [
        ("[\"169 GPa\", \"70 GPa\"]\nmaterial.poisson_ratio = [0.22, 0.33]", 11830.0 / 217.2079),
        ("[\"70 GPa\", \"169 GPa\"]\nmaterial.poisson_ratio = [0.33, 0.22]", 11830.0 / 217.2079),
        ("[\"0.1 TPa\", \"100 GPa\"]\nmaterial.poisson_ratio = [0.5, 0.5]", 200.0 / 3.0),
        ("[\"100 GPa\", \"1000 TPa\"]\nmaterial.poisson_ratio = [0.0, 0.0]", 100.0 / 1.0001),
    ] {
        let energies = "[\"50 mJ/m^2\", \"0.06 J/m^2\"]\nmaterial.interface_energy = \"20 mJ/m^2\"";
        let text = format!(
            "{plain}material.youngs_modulus = {bodies}\nmaterial.hardness = [\"2 GPa\", \"3 GPa\"]\nmaterial.surface_energy = {energies}\n"
        );
        let asperity = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).asperity;
        assert!(
            (asperity.reduced_modulus / (1e9 * expected) - 1.0).abs() < 1e-15,
            "{bodies}: {}",
            asperity.reduced_modulus
        );
        assert!((asperity.work_of_adhesion / 0.09 - 1.0).abs() < 1e-15, "{}", asperity.work_of_adhesion);
    }
    // Two bodies of one material have no interface.
    let text = format!(
        "{plain}material.reduced_modulus = \"85 GPa\"\nmaterial.poisson_ratio = 0.3\nmaterial.hardness = \"2 GPa\"\n"
    );
    let alike = Scene::parse(&format!("{text}material.surface_energy = \"45 mJ/m^2\"\n")).unwrap().asperity;
    assert!((alike.work_of_adhesion / 0.09 - 1.0).abs() < 1e-15, "{}", alike.work_of_adhesion);
    let two = format!("{text}material.surface_energy = [\"45 mJ/m^2\", \"45 mJ/m^2\"]\n");
    let error = Scene::parse(&two).unwrap_err().to_string();
    assert!(error.contains("`material.interface_energy` is missing"), "{error}");
}

#[test]
fn keys_that_exclude_each_other_are_refused() {
    let folder = files();
    let mut seen = 0;
    for key in KEYS.iter() {
        for excluded in key.excluded {
            let other = KEYS.iter().find(|key| key.name == *excluded).expect(excluded);
            let text = with(key).next().unwrap_or_else(|| panic!("no scene has {}", key.name));
            let text = match line(&text, other) {
                Some(_) => text,
                None => format!("{text}{excluded} = {}\n", other.example),
            };
            let error = said(folder.path(), &text).expect_err(&format!("{} beside {excluded}", key.name));
            assert!(
                error.contains(&format!("`{excluded} =")) || error.contains(&format!("`{} =", key.name)),
                "{error}"
            );
            seen += 1;
        }
    }
    assert!(seen > 20);
}
