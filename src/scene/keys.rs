//! The keys of scenes: each with an example of its own magnitude, and what people write in their place.

/// Every key of a scene by its dotted name, with an example as it stands behind the `=`. `[]` stands for an element of a list, `sweep.*`
/// for a key that is swept.
pub const KEYS: &[(&str, &str)] = &[
    ("format", "1"),
    ("title", "\"Case II\""),
    ("material", "{ reduced_modulus = \"85.29 GPa\" }"),
    ("material.reduced_modulus", "\"85.29 GPa\""),
    ("material.hardness", "\"2.5 GPa\""),
    ("material.poisson_ratio", "0.27"),
    ("material.work_of_adhesion", "\"0.09 J/m^2\""),
    ("material.equilibrium_spacing", "\"0.2 nm\""),
    ("surface", "{ asperity_radius = \"3.33 um\" }"),
    ("surface.asperity_radius", "\"3.33 um\""),
    ("surface.asperity_density", "\"7.39 /um^2\""),
    ("surface.surface_height_std", "\"1.619 nm\""),
    ("surface.asperity_height_std", "\"1.417 nm\""),
    ("surface.mean_plane_offset", "\"1.867 nm\""),
    ("surface.nominal_area", "\"100 um^2\""),
    ("surface.lubricant_thickness", "\"0.5 nm\""),
    ("surface.heights", "{ law = \"weibull\", shape = 2.0 }"),
    ("surface.heights.law", "\"weibull\""),
    ("surface.heights.shape", "1.5"),
    ("surface.heights.lower", "-3.0"),
    ("surface.heights.upper", "1.5"),
    ("surface.heights.path", "\"heights.csv\""),
    ("surface.heights.column", "\"height\""),
    ("surface.heights.dataset", "\"/asperities/height\""),
    ("surface.heights.unit", "\"nm\""),
    ("surface.radii", "{ law = \"gamma\", coefficient_of_variation = 0.5 }"),
    ("surface.radii.law", "\"lognormal\""),
    ("surface.radii.coefficient_of_variation", "0.3"),
    ("surface.radii.path", "\"radii.csv\""),
    ("surface.radii.column", "\"radius\""),
    ("surface.radii.dataset", "\"/asperities/radius\""),
    ("surface.radii.unit", "\"um\""),
    ("surface.count", "\"poisson\""),
    ("surface.summits", "\"nayak\""),
    ("surface.spectrum", "{ m0 = \"2.37 nm^2\", m2 = 6.26e-5, m4 = \"0.0146 /um^2\" }"),
    ("surface.spectrum.m0", "\"2.37 nm^2\""),
    ("surface.spectrum.m2", "6.26e-5"),
    ("surface.spectrum.m4", "\"0.0146 /um^2\""),
    ("surface.asperities", "{ path = \"asperities.h5\" }"),
    ("surface.asperities.path", "\"asperities.h5\""),
    ("surface.asperities.sample", "\"bootstrap\""),
    ("model", "{ law = \"hybrid\" }"),
    ("model.law", "\"hybrid\""),
    ("model.path", "\"approach\""),
    ("model.unloaded_radius", "\"elastic\""),
    ("model.critical_approach", "\"0.3 nm\""),
    ("separation", "{ h_star = { from = -1.0, to = 8.0, count = 91 } }"),
    ("separation.h", "{ from = \"-2 nm\", to = \"13 nm\", count = 91 }"),
    ("separation.h.from", "\"-2 nm\""),
    ("separation.h.to", "\"13 nm\""),
    ("separation.h.count", "91"),
    ("separation.h[]", "\"3 nm\""),
    ("separation.h_star", "{ from = -1.0, to = 8.0, count = 91 }"),
    ("separation.h_star.from", "-1.0"),
    ("separation.h_star.to", "8.0"),
    ("separation.h_star.count", "91"),
    ("separation.h_star[]", "2.0"),
    ("separation.stiffness_span", "\"0.2 nm\""),
    ("ensemble", "{ replicas = 200 }"),
    ("ensemble.replicas", "200"),
    ("ensemble.target", "{ quantity = \"pull_off_force\", relative_standard_error = 5e-3 }"),
    ("ensemble.target.quantity", "\"pull_off_force\""),
    ("ensemble.target.relative_standard_error", "5e-3"),
    ("ensemble.target.standard_error", "\"0.5 uN\""),
    ("ensemble.target.estimate", "\"controlled\""),
    ("ensemble.min_replicas", "64"),
    ("ensemble.max_replicas", "50000"),
    ("ensemble.sampling", "\"stratified\""),
    ("ensemble.seed", "1"),
    ("instability", "{ stiffness = \"100 kN/m\" }"),
    ("instability.stiffness", "\"100 kN/m\""),
    ("instability.preload", "\"10 mN\""),
    ("instability.smallest_snap", "\"0.01 nm\""),
    ("solver", "{ sum = \"compressed\" }"),
    ("solver.sum", "\"compressed\""),
    ("solver.tolerance", "1e-9"),
    ("output", "{ curves = true }"),
    ("output.curves", "true"),
    ("sweep", "{ \"material.work_of_adhesion\" = [\"0.04 J/m^2\", \"0.09 J/m^2\"] }"),
    ("sweep.mode", "\"grid\""),
    ("sweep.common_random_numbers", "true"),
    ("sweep.*.from", ""),
    ("sweep.*.to", ""),
    ("sweep.*.count", "7"),
    ("sweep.*.spacing", "\"log\""),
];

/// What is written in the place of a key, in lower case, the key, and what to know of it.
const MEANT: &[(&[&str], &str, &str)] = &[
    (
        &["youngs_modulus", "young_modulus", "young", "elastic_modulus", "modulus", "e", "e1", "e_r", "e_star"],
        "material.reduced_modulus",
        ", 1/E_r = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 of the two bodies",
    ),
    (&["nu", "poisson", "poissons_ratio"], "material.poisson_ratio", ""),
    (
        &["gamma", "surface_energy", "delta_gamma", "dgamma", "adhesion_energy", "adhesion", "w"],
        "material.work_of_adhesion",
        ", the energy of both surfaces less that of their interface",
    ),
    (&["z0", "z_0", "epsilon"], "material.equilibrium_spacing", ""),
    (&["h"], "material.hardness", ""),
    (&["sigma", "rms", "rq", "sq", "roughness", "height_std"], "surface.surface_height_std", ""),
    (&["sigma_s"], "surface.asperity_height_std", ""),
    (&["r", "radius"], "surface.asperity_radius", ""),
    (&["eta", "density"], "surface.asperity_density", ""),
    (&["area", "a", "a_n"], "surface.nominal_area", ""),
    (&["t", "thickness", "lubricant"], "surface.lubricant_thickness", ""),
    (&["y_s"], "surface.mean_plane_offset", ""),
    (&["n", "samples", "runs"], "ensemble.replicas", ""),
];

/// A dotted name as the table has it: without the index of an element, and without the sweep that a key is in.
fn tabled(name: &str) -> String {
    let name = match name.split_once('[') {
        Some((list, rest)) => {
            let rest = rest.split_once(']').map_or("", |(_, rest)| rest);
            if rest.is_empty() { format!("{list}[]") } else { format!("{list}{rest}") }
        }
        None => name.to_owned(),
    };
    let swept = name.strip_prefix("sweep.").filter(|name| name.contains('.'));
    match swept.map(|name| (name, name.rsplit_once('.'))) {
        Some((_, Some((_, last @ ("count" | "spacing"))))) => format!("sweep.*.{last}"),
        Some((_, Some((key, "from" | "to")))) => key.to_owned(),
        Some((name, _)) => name.trim_end_matches("[]").to_owned(),
        None => name,
    }
}

/// An example for the key of a dotted name; none for what is no key.
pub fn example(name: &str) -> Option<&'static str> {
    let name = tabled(name);
    let find = |name: &str| KEYS.iter().find(|(known, _)| *known == name).map(|(_, example)| *example);
    find(&name).or_else(|| find(name.trim_end_matches("[]")))
}

/// The keys of a table by its dotted name, "" for the root.
pub fn keys_of(table: &str) -> impl Iterator<Item = &'static str> + Clone + use<> {
    let prefix = if table.is_empty() { String::new() } else { format!("{}.", tabled_table(table)) };
    KEYS.iter().filter_map(move |(name, _)| name.strip_prefix(&prefix)).filter(|rest| !rest.contains(['.', '[']))
}

/// The name of a table as the keys in it have it.
fn tabled_table(name: &str) -> String {
    match name.strip_prefix("sweep.") {
        Some(_) => "sweep.*".to_owned(),
        None => tabled(name).trim_end_matches("[]").to_owned(),
    }
}

/// The dotted name of the key that was most likely meant by an unknown one, and what to know of it.
pub fn meant(given: &str) -> Option<(&'static str, &'static str)> {
    let given = given.to_lowercase().replace(['-', ' '], "_").replace(['\'', '’'], "");
    let alias = MEANT.iter().find(|(words, ..)| words.contains(&given.as_str()));
    let elsewhere = || {
        let is_meant = |name: &str| name.split_once('.').is_some_and(|(_, key)| key == given);
        KEYS.iter().find(|(name, _)| is_meant(name)).map(|(name, _)| (*name, ""))
    };
    alias.map(|(_, key, note)| (*key, *note)).or_else(elsewhere)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_found_by_what_messages_name() {
        for (name, expected) in [
            ("material.hardness", "\"2.5 GPa\""),
            ("separation.h[3]", "\"3 nm\""),
            ("separation.h.from", "\"-2 nm\""),
            ("instability.stiffness[2]", "\"100 kN/m\""),
            ("ensemble.target[1].standard_error", "\"0.5 uN\""),
            ("sweep.material.hardness[4]", "\"2.5 GPa\""),
            ("sweep.material.hardness.from", "\"2.5 GPa\""),
            ("sweep.material.hardness.count", "7"),
            ("sweep.mode", "\"grid\""),
        ] {
            assert_eq!(example(name), Some(expected), "{name}");
        }
        assert_eq!(example("material.colour"), None);
    }

    #[test]
    fn tables_have_their_keys() {
        let of = |name: &str| keys_of(name).collect::<Vec<&str>>();
        assert_eq!(of("solver"), ["sum", "tolerance"]);
        assert_eq!(of("ensemble.target[3]"), ["quantity", "relative_standard_error", "standard_error", "estimate"]);
        assert_eq!(of("sweep.material.hardness"), ["from", "to", "count", "spacing"]);
        assert!(of("").contains(&"sweep") && !of("").contains(&"hardness"));
        assert!(of("title").is_empty());
    }

    #[test]
    fn what_people_write_is_known_and_names_keys() {
        for (given, key) in [
            ("youngs_modulus", "material.reduced_modulus"),
            ("Young's modulus", "material.reduced_modulus"),
            ("sigma", "surface.surface_height_std"),
            ("gamma", "material.work_of_adhesion"),
            ("density", "surface.asperity_density"),
            ("hardness", "material.hardness"),
            ("Hardness", "material.hardness"),
        ] {
            assert_eq!(meant(given).unwrap().0, key, "{given}");
        }
        assert!(MEANT.iter().all(|(_, key, _)| KEYS.iter().any(|(name, _)| name == key)));
        assert_eq!(meant("colour"), None);
    }
}
