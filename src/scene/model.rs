//! The law of one asperity and the history of a scene, `[model]`.

use super::error::{SceneError, Together};
use super::keys::Listed::WithContact;
use super::keys::Sign::NotNegative;
use super::keys::Value::{Choice, Quantity, Table};
use super::keys::{Key, key, names};
use super::reader::Section;
use super::units::Dimension as Of;
use crate::asperity::{MODELS, Model, PUBLISHED_FITS};
use crate::asperity::{Path, PlasticContact, model};

/// Histories: their paths, of a loop that of its first way, and whether the surfaces are pulled back.
const HISTORIES: [(&str, (Path, bool)); 3] = [
    (Path::ALL[0].0, (Path::ALL[0].1, false)),
    (Path::ALL[1].0, (Path::ALL[1].1, false)),
    (LOOP, (Path::Approach, true)),
];
/// Name of the history of approach and retraction.
pub(super) const LOOP: &str = "loop";
/// The law of scenes that name none, and of those with a liquid.
pub(super) const DEFAULT_LAW: &str = "md_plastic";
const DEFAULT_LAW_IN_LIQUID: &str = "capillary";

/// The keys of `[model]`.
pub(super) static KEYS: &[Key] = &[
    key("model", "{ law = \"md_plastic\" }", Table)
        .what("the law of one asperity, and the history")
        .follows("the defaults of its keys"),
    key("model.law", "\"hybrid\"", Choice(|| MODELS.iter().map(|model| model.name).collect()))
        .what("law of one asperity")
        .swept()
        .about(
            "`md_plastic` covers elastic contacts at any λ and plastic flow up to λ ≈ 1, and is continuous where contacts \
             begin to flow; the page of the laws gives the range of each law.",
        )
        .follows("`md_plastic`; with `[capillary]` `capillary`"),
    key("model.plastic_contact", "\"zmc\"", Choice(|| names(&PlasticContact::ALL)))
        .what("plastic contact under `md_plastic` and `capillary`")
        .about(
            "The load and the contact radius of an asperity that flows, without adhesion: `jg` Jackson and Green, `ke` \
             Kogut and Etsion, `zmc` Zhao, Maietta and Chang, `tn` Thornton and Ning.",
        )
        .defaults_to("\"jg\"")
        .swept()
        .listed(WithContact),
    key("model.history", "\"approach\"", Choice(|| names(&HISTORIES)))
        .formerly("path")
        .what("history")
        .about(
            "`approach`: contact begins at first touch. `loop`: approach to the closest separation, then retraction from there, \
             each asperity by its own history. `retraction`: the retraction of that loop, without the approach. Surfaces that \
             have touched are pulled off on `loop` or `retraction`.",
        )
        .defaults_to("\"approach\""),
    key("model.critical_approach", "\"0.3 nm\"", Quantity(Of::Length, NotNegative))
        .what("critical approach of the published fits")
        .about("δ_A of the law `fit:paper`; other laws find theirs.")
        .follows("from the history")
        .swept(),
];

fn critical_approach(section: &Section<'_>, law: &Model) -> Result<Option<f64>, SceneError> {
    let Some(entry) = section.get("critical_approach") else { return Ok(None) };
    if law.name != PUBLISHED_FITS {
        return Err(
            entry.wrong(&format!("the law {} finds its own; only {PUBLISHED_FITS} takes it", law.name))
        );
    }
    entry.measured().map(Some)
}

/// The law with the plastic contact that is chosen for it.
fn plastic_contact(section: &Section<'_>, law: Model) -> Result<Model, SceneError> {
    let contact = section.value("plastic_contact").choice("plastic_contact", &PlasticContact::ALL)?;
    match section.get("plastic_contact").filter(|_| law.contact().is_none()) {
        None => Ok(law.with_contact(contact)),
        Some(entry) => Err(entry.wrong(&format!(
            "the law {} has no contact to choose; law = \"{DEFAULT_LAW}\" takes any of them, and \"capillary\" in a liquid",
            law.name
        ))),
    }
}

/// The table `[model]`: law and history.
pub(super) struct ModelTable {
    pub law: Model,
    pub history: Path,
    pub cycle: bool,
    pub critical_approach: Option<f64>,
}

impl ModelTable {
    pub fn read(section: &Section<'_>, is_wet: bool) -> Result<Self, SceneError> {
        let models: Vec<(&str, Model)> = MODELS.iter().map(|model| (model.name, *model)).collect();
        let history = section.value("history").choice("history", &HISTORIES);
        let law = match section.get("law") {
            None => {
                let name = if is_wet { DEFAULT_LAW_IN_LIQUID } else { DEFAULT_LAW };
                Ok(model(name).expect("it is one of the registry"))
            }
            Some(law) => law.choice("law", &models),
        };
        let law = law.and_then(|law| plastic_contact(section, law));
        let critical_approach = match &law {
            Ok(law) => critical_approach(section, law),
            Err(_) => Ok(None),
        };
        let (law, (history, cycle), critical_approach) = (law, history, critical_approach).together()?;
        Ok(Self { law, history, cycle, critical_approach })
    }
}
