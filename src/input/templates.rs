//! Scenes to begin with.

/// The scenes by name.
pub(crate) const TEMPLATES: [(&str, &str); 6] = [
    ("mems-pad", include_str!("templates/mems-pad.toml")),
    ("afm-tip", include_str!("templates/afm-tip.toml")),
    ("disk-head", include_str!("templates/disk-head.toml")),
    ("measured-map", include_str!("templates/measured-map.toml")),
    ("wet", include_str!("templates/wet.toml")),
    ("coupled", include_str!("templates/coupled.toml")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Document, NoFiles};
    use std::sync::Arc;

    /// All templates are scenes but for the file of asperities that one names.
    #[test]
    fn templates_are_scenes() {
        for (name, text) in TEMPLATES {
            let read = Document::parse(text, Arc::new(NoFiles)).err().map(|error| error.to_string());
            match name {
                "measured-map" => assert!(read.unwrap().contains("asperities.h5")),
                _ => assert_eq!(read, None, "{name}"),
            }
        }
    }
}
