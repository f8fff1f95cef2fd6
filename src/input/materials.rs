//! Numbers of materials.

/// The table, each number with its source.
const MATERIALS: &str = include_str!("materials.csv");
/// How the work of adhesion follows from surface energies.
pub(crate) const ADHESION: &str = "The work of adhesion of two surfaces is the sum of their surface energies less the energy of their \
    interface; of two surfaces with one coating it is twice its surface energy. Surfaces in air are mostly covered: 5 to 100 mJ/m^2 \
    are measured.";

/// Material, key, value, note and source of each number.
pub(crate) fn numbers() -> impl Iterator<Item = [String; 5]> {
    let rows = csv::Reader::from_reader(MATERIALS.as_bytes()).into_deserialize();
    rows.map(|row| row.expect("the table is part of the program"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::templates::TEMPLATES;
    use crate::scene::{Document, NoFiles};
    use std::sync::Arc;

    /// Every number of a material is one that a scene takes, with a source.
    #[test]
    fn materials_are_what_scenes_take() {
        let (_, scene) = TEMPLATES[0];
        assert!(numbers().count() > 30);
        for [material, key, value, _, source] in numbers() {
            assert!(source.len() > 20 && !material.is_empty(), "{material}: {source}");
            let key = if key == "surface_energy" { "work_of_adhesion" } else { &key };
            let own = scene.lines().find(|line| line.starts_with(key)).unwrap();
            let value = if key == "poisson_ratio" { value.clone() } else { format!("\"{value}\"") };
            let text = scene.replace(own, &format!("{key} = {value}"));
            let read = Document::parse(&text, Arc::new(NoFiles));
            assert!(read.is_ok(), "{material}: {}", read.unwrap_err());
        }
    }
}
