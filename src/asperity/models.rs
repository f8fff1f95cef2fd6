//! A law by name: its description, limits and constructor. The list of all is [`super::laws::MODELS`].

use super::block::Responses;
use super::error::LawError;
use super::history::Path;
use super::lane::Lanes;
use super::law::Law;
use super::laws::capillary;
use super::laws::capillary::Parts;
use super::laws::md_plastic::{PlasticContact, PlasticLoading, dry_loading};
use super::parameters::LawParameters;
use super::stats::SolverStats;
use crate::liquid::Meniscus;
use std::sync::Arc;

/// The constructor of a law.
#[derive(Clone, Copy, Debug)]
enum Build {
    /// The law of an asperity.
    Plain(Plain),
    /// The law of an asperity in a vapour whose liquid has a meniscus.
    Wet(Wet),
    /// The liquid in its bridge.
    Content,
    /// The law of an asperity with a plastic contact that is chosen.
    Plastic(Plastic),
    /// The solids in the liquid, which is under no tension.
    Immersed,
}

/// A law by name.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, MODELS, Model, Path, model};
///
/// let jkr: Model = model("jkr").unwrap();
/// assert_eq!(jkr.about, "Johnson-Kendall-Roberts, elastic and dry");
/// let law = jkr.law(&LawParameters::scaled(10.0, Path::Approach)?)?;
/// assert_eq!(law.regimes().len(), 2);
/// assert!(MODELS.iter().any(|model| model.name == "hybrid"));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// The name in scenes, on the command line and in files.
    pub name: &'static str,
    /// A line about it.
    pub about: &'static str,
    /// Limits of its validity.
    pub validity: Validity,
    /// The liquid that condenses around asperities, of a law with one.
    meniscus: Option<Meniscus>,
    /// The plastic contact, of a law that takes any.
    pub(crate) contact: PlasticContact,
    build: Build,
}

/// A scaled interference further away than any attraction of a finite range reaches for λ = 1.
const FAR: f64 = -1e4;

/// The law with the published fits, which alone takes a δ_A from the scene: all others find their own.
pub const PUBLISHED_FITS: &str = "fit:paper";

impl Model {
    /// Makes the law for one asperity.
    ///
    /// # Errors
    /// [`LawError`] where the law is not for these parameters, [`LawError::NoLiquid`] where it is for a liquid and has none.
    pub fn law(&self, parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
        match self.build {
            Build::Plain(build) => build(parameters),
            Build::Wet(build) => build(parameters, self.needed()?, self.contact),
            Build::Content => capillary::content(parameters, self.needed()?),
            Build::Plastic(build) => build(parameters, self.contact),
            Build::Immersed => capillary::immersed(parameters, self.needed()?, self.contact),
        }
    }

    /// The law with a plastic contact; no change to a law with one of its own.
    pub fn with_contact(self, contact: PlasticContact) -> Self {
        Self { contact, ..self }
    }

    /// The plastic contact of a law that takes any; none of one that has its own, or none.
    pub fn contact(&self) -> Option<PlasticContact> {
        self.has_unloading().then_some(self.contact)
    }

    /// Whether it has a law of unloading for contacts that have yielded.
    pub(crate) fn has_unloading(&self) -> bool {
        self.validity.plasticity == Plasticity::LoadingAndUnloading
    }

    /// The law with a liquid; no change to a law without liquid.
    pub fn with_liquid(self, meniscus: Meniscus) -> Self {
        Self { meniscus: self.is_wet().then_some(meniscus), ..self }
    }

    /// The liquid in the bridges of a law, V, m³, in the place of F_s.
    pub(crate) fn content(self) -> Self {
        Self { build: Build::Content, ..self }
    }

    /// The law of the solids in the liquid, which is under no tension.
    pub(crate) fn immersed(self) -> Self {
        Self { build: Build::Immersed, ..self }
    }

    /// Whether it is for asperities around which a liquid condenses, and needs the liquid.
    pub fn is_wet(&self) -> bool {
        !matches!(self.build, Build::Plain(_) | Build::Plastic(_))
    }

    /// The liquid that it has been given.
    pub fn meniscus(&self) -> Option<&Meniscus> {
        self.meniscus.as_ref()
    }

    fn needed(&self) -> Result<&Meniscus, LawError> {
        self.meniscus.as_ref().ok_or(LawError::NoLiquid(self.name))
    }

    /// Whether an asperity is one that the law is solved for.
    ///
    /// # Errors
    /// [`LawError`] where it is not.
    #[doc(hidden)]
    pub fn admits(&self, parameters: &LawParameters) -> Result<(), LawError> {
        self.parts(parameters).map(drop)
    }

    /// The parts of a wet asperity, of a law that is for one.
    fn parts(&self, parameters: &LawParameters) -> Result<Option<Parts>, LawError> {
        Ok(match self.build {
            Build::Plain(_) | Build::Plastic(_) => None,
            Build::Wet(_) | Build::Content => Some(Parts::new(parameters, self.needed()?)?),
            Build::Immersed => Some(Parts::immersed(parameters, self.needed()?)?),
        })
    }

    /// The plastic loading of a law with outlines of flattened summits.
    pub(super) fn plastic_loading(
        &self,
        parameters: &LawParameters,
    ) -> Result<Arc<PlasticLoading>, LawError> {
        match self.parts(parameters)? {
            None => dry_loading(parameters, self.contact),
            Some(parts) => parts.plastic_loading(parameters, self.contact),
        }
    }

    /// Whether an asperity is attracted at any distance, as by the tail of a Lennard-Jones stress: not so by
    /// laws with the stress of Dugdale, which ends, or with none before contact. What cannot be made for a
    /// plain asperity counts as if it were.
    ///
    /// # Examples
    /// ```
    /// use stiction::asperity::model;
    ///
    /// assert!(["hybrid", "idmt", "sbl"].iter().all(|law| model(law).unwrap().has_endless_attraction()));
    /// assert!(["md", "md_kim", "jkr", "gw"].iter().all(|law| !model(law).unwrap().has_endless_attraction()));
    /// ```
    pub fn has_endless_attraction(&self) -> bool {
        let Ok(parameters) = LawParameters::scaled(1.0, Path::Approach) else { return true };
        let Ok(law) = self.law(&LawParameters { critical_interference: 1.0, ..parameters }) else {
            return true;
        };
        let pieces = law.pieces(None);
        let far = pieces.iter().find(|piece| piece.lower <= FAR && FAR <= piece.upper);
        far.is_some_and(|piece| {
            let mut responses = Responses::default();
            law.evaluate(piece.regime, Lanes::Own, &[FAR], &mut responses, &mut SolverStats::default());
            responses.adhesion[0] > 0.0
        })
    }

    /// Whether its forces are curve fits to the forces of one asperity.
    pub fn is_fit(&self) -> bool {
        self.name.starts_with("fit:")
    }
}

/// The limits of a law, which follow from what it leaves out.
///
/// # Examples
/// ```
/// use stiction::asperity::{Validity, model};
///
/// let validity: Validity = model("dmt").unwrap().validity;
/// assert!(validity.limits(0.05, 0.1, 0.0).is_empty());
/// assert_eq!(validity.limits(2.0, 0.1, 0.0).len(), 1, "DMT is for small adhesion parameters");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validity {
    /// Range of adhesion parameters that it is for.
    #[doc(hidden)]
    pub adhesion: Adhesion,
    /// The contact above the critical interference.
    #[doc(hidden)]
    pub plasticity: Plasticity,
    /// Whether it leaves out a lubricant.
    pub dry: bool,
}

/// Elastic-plastic contact of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plasticity {
    /// None: the law is elastic only.
    Without,
    /// On loading alone, without an outline of flattened summits. The contact is the nearest one of `md_plastic`.
    Loading(PlasticContact),
    /// On loading and unloading, of any plastic contact, under an adhesion that follows the flattened summit.
    LoadingAndUnloading,
}

/// Range of adhesion parameters λ that a law is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adhesion {
    /// None: the law has no adhesion.
    Without,
    /// λ up to [`LARGEST_DMT_LAMBDA`]: the profile of the sphere does not feel the adhesion.
    Low,
    /// λ from `SMALLEST_JKR_LAMBDA`: adhesion acts within the contact only.
    High,
    /// Every λ.
    Any,
}

/// Largest λ of the DMT limit: there its pull-off is 2.5 % above that of Maugis-Dugdale (Maugis 1992; Johnson
/// and Greenwood, J. Colloid Interface Sci. 192 (1997) 326).
pub const LARGEST_DMT_LAMBDA: f64 = 0.1;
/// Smallest λ of the JKR limit (the same sources).
pub const SMALLEST_JKR_LAMBDA: f64 = 5.0;
/// Largest ψ of σ_s of elastic contact (Greenwood and Williamson 1966; Shi and Polycarpou 2005, section 3.1).
pub const LARGEST_ELASTIC_PSI: f64 = 0.6;

impl Validity {
    /// The limits that a law is beyond at an adhesion parameter λ, a plasticity index ψ of σ_s and a
    /// lubricant thickness t, m: a line each, with the limit and its source. Empty where it is valid.
    pub fn limits(&self, lambda: f64, plasticity_index: f64, lubricant_thickness: f64) -> Vec<String> {
        let mut limits = Vec::new();
        if self.adhesion == Adhesion::Without {
            limits.push("leaves out adhesion".to_owned());
        }
        let exceeded = self.exceeded(lambda, plasticity_index);
        limits.extend(exceeded.into_iter().map(|(finding, reason)| format!("{finding}, {reason}")));
        if self.dry && lubricant_thickness > 0.0 {
            limits.push("knows no lubricant: computed as dry".to_owned());
        }
        limits
    }

    /// The limits of a law that an adhesion parameter λ and a plasticity index ψ of σ_s exceed: the number
    /// and the limit, and what it is and whose.
    #[doc(hidden)]
    pub fn exceeded(&self, lambda: f64, plasticity_index: f64) -> Vec<(String, String)> {
        let mut exceeded = Vec::new();
        match self.adhesion {
            Adhesion::Low if lambda > LARGEST_DMT_LAMBDA => exceeded.push((
                format!("lambda = {lambda:.3} is above {LARGEST_DMT_LAMBDA}"),
                "the limit of DMT-like laws (Johnson and Greenwood 1997)".to_owned(),
            )),
            Adhesion::High if lambda < SMALLEST_JKR_LAMBDA => {
                let lambda = if lambda < 1e-3 { format!("{lambda:.3e}") } else { format!("{lambda:.3}") };
                exceeded.push((
                    format!("lambda = {lambda} is below {SMALLEST_JKR_LAMBDA}"),
                    "the limit of JKR (Johnson and Greenwood 1997)".to_owned(),
                ));
            }
            _ => {}
        }
        if self.plasticity == Plasticity::Without && plasticity_index > LARGEST_ELASTIC_PSI {
            exceeded.push((
                format!("psi of sigma_s = {plasticity_index:.3} is above {LARGEST_ELASTIC_PSI}"),
                "the limit of elastic contact (Greenwood and Williamson 1966)".to_owned(),
            ));
        }
        exceeded
    }
}

pub(super) const fn validity(adhesion: Adhesion, plasticity: Plasticity, dry: bool) -> Validity {
    Validity { adhesion, plasticity, dry }
}

type Plain = fn(&LawParameters) -> Result<Box<dyn Law>, LawError>;
type Wet = fn(&LawParameters, &Meniscus, PlasticContact) -> Result<Box<dyn Law>, LawError>;
type Plastic = fn(&LawParameters, PlasticContact) -> Result<Box<dyn Law>, LawError>;

const fn model_of(name: &'static str, about: &'static str, validity: Validity, build: Build) -> Model {
    Model { name, about, validity, meniscus: None, contact: PlasticContact::JacksonGreen, build }
}

pub(super) const fn law(name: &'static str, about: &'static str, validity: Validity, build: Plain) -> Model {
    model_of(name, about, validity, Build::Plain(build))
}

pub(super) const fn wet(name: &'static str, about: &'static str, validity: Validity, build: Wet) -> Model {
    model_of(name, about, validity, Build::Wet(build))
}

pub(super) const fn plastic(
    name: &'static str,
    about: &'static str,
    validity: Validity,
    build: Plastic,
) -> Model {
    model_of(name, about, validity, Build::Plastic(build))
}
