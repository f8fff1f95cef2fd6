//! The parameters of a law: one asperity in its units, the history, and where starting tables are worth their
//! making.

use super::error::LawError;
use super::history::Path;
use super::scale::{Asperity, Scale, UNIT_RANGE};

/// The state of an asperity before contact where the attraction has two states, and contact leads to the
/// inner one: for λ from 0.888 to 0.938.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[doc(hidden)]
pub enum InnerState {
    /// The inner one from where the outer one ends, and the outer one before that.
    #[default]
    Entered,
    /// The inner one after contact, for as long as it exists.
    Held,
    /// The outermost one that there is, whatever the asperity has touched.
    Ignored,
}

/// Everything that the laws of one asperity depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawParameters {
    /// λ and the units of the scaled variables.
    pub scale: Scale,
    /// Critical interference ω_c, m; infinite where there is no plastic deformation.
    pub critical_interference: f64,
    /// Maximum contact pressure factor k.
    pub pressure_factor: f64,
    /// Hardness over reduced modulus H/E*, where it is known; a law whose form changes with it needs it.
    pub hardness_ratio: Option<f64>,
    /// Lubricant thickness t, m; 0 when dry.
    pub lubricant_thickness: f64,
    /// δ_A, m, that is set instead of following from the history; of the published fits only.
    pub critical_approach: Option<f64>,
    /// The history.
    pub path: Path,
    /// The state before contact where there are two.
    #[doc(hidden)]
    pub inner_state: InnerState,
    /// Range of interferences, m, that starting tables are made for; other interferences are solved too,
    /// slower.
    pub table_range: Option<(f64, f64)>,
}

impl LawParameters {
    /// The setting of an asperity.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved, or quantities that are not positive and finite.
    pub fn new(asperity: &Asperity, path: Path, table_range: (f64, f64)) -> Result<Self, LawError> {
        let yields = asperity.hardness < f64::INFINITY;
        let parameters = Self {
            scale: Scale::new(asperity)?,
            critical_interference: asperity.critical_interference(),
            pressure_factor: if yields { asperity.pressure_factor() } else { 1.0 },
            hardness_ratio: yields.then(|| asperity.hardness / asperity.reduced_modulus),
            lubricant_thickness: asperity.lubricant_thickness,
            critical_approach: None,
            path,
            inner_state: InnerState::default(),
            table_range: Some(table_range),
        };
        if !(asperity.hardness > 0.0) {
            return Err(LawError::NotPositive { name: "hardness", value: asperity.hardness });
        }
        let critical = parameters.critical_interference;
        if yields && !critical.is_finite() {
            return Err(LawError::NotPositive { name: "critical_interference", value: critical });
        }
        parameters.checked()
    }

    /// A dry, elastic asperity in scaled variables: all units are 1.
    ///
    /// # Errors
    /// [`LawError::Lambda`] for a λ that is not solved.
    pub fn scaled(lambda: f64, path: Path) -> Result<Self, LawError> {
        let parameters = Self {
            scale: Scale::unit(lambda)?,
            critical_interference: f64::INFINITY,
            pressure_factor: 1.0,
            hardness_ratio: None,
            lubricant_thickness: 0.0,
            critical_approach: None,
            path,
            inner_state: InnerState::default(),
            table_range: None,
        };
        parameters.checked()
    }

    /// The setting itself, if its quantities are possible.
    ///
    /// # Errors
    /// [`LawError::NotPositive`] when they are not, [`LawError::Length`] when their powers would under- or
    /// overflow.
    pub fn checked(self) -> Result<Self, LawError> {
        let (critical, t) = (self.critical_interference, self.lubricant_thickness);
        if !(critical > 0.0) {
            return Err(LawError::NotPositive { name: "critical_interference", value: critical });
        }
        if !(self.pressure_factor > 0.0 && self.pressure_factor.is_finite()) {
            return Err(LawError::NotPositive { name: "poisson_ratio", value: self.pressure_factor });
        }
        if !(t >= 0.0 && t.is_finite()) {
            return Err(LawError::NotPositive { name: "lubricant_thickness", value: t });
        }
        let (least, most) = (UNIT_RANGE.0 * self.scale.length, UNIT_RANGE.1 * self.scale.length);
        if critical < least || (critical > most && critical.is_finite()) {
            return Err(LawError::Length { name: "critical_interference", value: critical });
        }
        if t > most {
            return Err(LawError::Length { name: "lubricant_thickness", value: t });
        }
        Ok(self)
    }

    /// The setting itself, for the law `name`, whose forces depend on ω_c in its elastic regime too.
    ///
    /// # Errors
    /// [`LawError::Elastic`] when ω_c is infinite.
    pub fn plastic(&self, name: &'static str) -> Result<&Self, LawError> {
        if self.critical_interference.is_finite() { Ok(self) } else { Err(LawError::Elastic(name)) }
    }

    /// Largest scaled interference that starting tables are needed for, up to `end`, m.
    pub fn deepest(&self, end: f64) -> Option<f64> {
        self.table_range.map(|(_, deepest)| deepest.min(end) / self.scale.length)
    }
}
