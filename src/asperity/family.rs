//! Laws of the asperities of a surface: one law of all, or a law for each radius.

use super::cycle::Loop;
use super::error::LawError;
use super::history::Path;
use super::lane::Lane;
use super::law::{Law, RadiusDependence};
use super::models::Model;
use super::parameters::{InnerState, LawParameters};
use super::radius::RadiusLaw;
use super::scale::Asperity;
use std::ops::Deref;
use std::sync::Arc;

/// End of the tables of closed forms, in critical interferences.
const TABULATED: f64 = 110.0;

/// The laws of asperities that differ in their radius alone.
///
/// # Examples
/// ```
/// use stiction::asperity::{Asperity, Family, Path, SolvedAsperity, model};
///
/// # let asperity = Asperity {
/// #     radius: 1e-6,
/// #     reduced_modulus: 100e9,
/// #     work_of_adhesion: 0.05,
/// #     equilibrium_spacing: 0.2e-9,
/// #     hardness: 5e9,
/// #     poisson_ratio: 0.3,
/// #     lubricant_thickness: 0.0,
/// # };
/// let family = Family::new(model("dmt").unwrap(), asperity, Path::Approach, (0.1, 10.0))?;
/// let [one, two] = [1e-6, 2e-6].map(|radius| SolvedAsperity::new(&*family.law(radius), 0.0));
/// assert!((two.adhesion_force / one.adhesion_force - 2.0).abs() < 1e-14);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone)]
pub struct Family {
    law: Arc<dyn Law>,
    /// Radius of the law, m.
    radius: f64,
    /// λ of the law, if it solves elastic branches.
    lambda: Option<f64>,
}

impl Family {
    /// The laws of a model for asperities like one, whose radii differ from its radius by factors between
    /// `least` and `most`.
    ///
    /// # Errors
    /// [`LawError`] when one of these two has no law, [`LawError::OneRadius`] when it is not known how the law follows
    /// the radius.
    pub fn new(
        model: Model,
        asperity: Asperity,
        path: Path,
        (least, most): (f64, f64),
    ) -> Result<Self, LawError> {
        for factor in [least, most] {
            let own = Asperity { radius: factor * asperity.radius, ..asperity };
            model.admits(&LawParameters::new(&own, path, (0.0, 0.0))?)?;
        }
        let tabulated = (0.0, TABULATED * asperity.critical_interference());
        let law: Arc<dyn Law> = Arc::from(model.law(&LawParameters::new(&asperity, path, tabulated)?)?);
        let dependence = law.radius_dependence();
        if dependence == RadiusDependence::Unknown {
            return Err(LawError::OneRadius);
        }
        Ok(Self { lambda: dependence.lambda(), law, radius: asperity.radius })
    }

    /// The law of an asperity of a radius, m.
    pub fn law(&self, radius: f64) -> Box<dyn Law> {
        Box::new(self.law_of(self.lane(radius)))
    }

    /// The law of an asperity.
    #[doc(hidden)]
    pub fn law_of(&self, lane: Lane) -> RadiusLaw {
        RadiusLaw::new(&self.law, lane)
    }

    /// An asperity of a radius, m.
    #[doc(hidden)]
    pub fn lane(&self, radius: f64) -> Lane {
        Lane::new(radius / self.radius, self.lambda)
    }

    /// The number of regimes of the law.
    #[doc(hidden)]
    pub fn regimes(&self) -> usize {
        self.law.regimes().len()
    }

    /// Whether the solids touch in a regime.
    #[doc(hidden)]
    pub fn touches(&self, regime: usize) -> bool {
        self.law.regimes()[regime].is_contact()
    }

    /// The law that follows the radius, in lanes.
    #[doc(hidden)]
    pub fn shared(&self) -> &dyn Law {
        self.law.as_ref()
    }
}

/// Makes the loop of an asperity of a radius, m.
type LoopOfRadius = dyn Fn(f64) -> Loop + Send + Sync;

/// The loops that coupled asperities remember their histories by: one of all, or one of each radius.
///
/// # Examples
/// ```
/// use stiction::asperity::SurfaceLoops;
///
/// let memory = stiction::Scene::from_toml_file("configs/coupled.toml")?.memory().unwrap();
/// assert!(matches!(memory, Some(SurfaceLoops::All(_))));
/// # Ok::<(), stiction::Error>(())
/// ```
pub enum SurfaceLoops {
    /// All asperities have one radius.
    All(Box<Loop>),
    /// The loop of an asperity by its radius, m.
    OfRadius(Box<LoopOfRadius>),
}

impl SurfaceLoops {
    /// The loops of a model for asperities like one, whose radii differ from its radius by factors between
    /// `least` and `most`; before contact they are on the outermost state.
    ///
    /// # Errors
    /// As [`Loop::new`] for one of these two.
    pub fn of_radii(model: Model, asperity: Asperity, (least, most): (f64, f64)) -> Result<Self, LawError> {
        let of_radius = move |radius: f64| {
            let parameters =
                LawParameters::new(&Asperity { radius, ..asperity }, Path::Approach, (0.0, 0.0))?;
            let inner_state = InnerState::Ignored;
            Loop::new(&model, &LawParameters { table_range: None, inner_state, ..parameters })
        };
        for factor in [least, most] {
            of_radius(factor * asperity.radius)?;
        }
        let loop_of =
            move |radius| of_radius(radius).expect("loops between two radii that have one have one");
        Ok(Self::OfRadius(Box::new(loop_of)))
    }
}

/// The laws of the asperities of a surface, which behave as the law of the typical one.
///
/// # Examples
/// ```
/// use stiction::asperity::{ClosedForm, Law, Laws, Regime, Row, Table};
///
/// let law = Table::new([Row::last(Regime::Noncontact, ClosedForm::attraction(|delta: f64| delta.exp()))]);
/// let laws = Laws::from(&law);
/// assert!(laws.family.is_none(), "one law for all");
/// assert_eq!(laws.regimes(), [Regime::Noncontact]);
/// ```
#[derive(Clone, Copy)]
pub struct Laws<'a> {
    /// The law of the typical asperity; of every asperity where there is no family.
    pub typical: &'a dyn Law,
    /// The laws by radius, where asperities differ in it.
    pub family: Option<&'a Family>,
}

impl<'a> Deref for Laws<'a> {
    type Target = dyn Law + 'a;

    fn deref(&self) -> &Self::Target {
        self.typical
    }
}

impl<'a> From<&'a (dyn Law + 'a)> for Laws<'a> {
    fn from(typical: &'a (dyn Law + 'a)) -> Self {
        Self { typical, family: None }
    }
}

impl<'a, L: Law + 'a> From<&'a L> for Laws<'a> {
    fn from(law: &'a L) -> Self {
        Self { typical: law, family: None }
    }
}

/// The laws of a surface as they are made.
///
/// # Examples
/// ```
/// use stiction::asperity::{Asperity, Family, LawParameters, Path, SurfaceLaws, model};
/// use stiction::integral::Expectations;
/// use stiction::surface::{Radii, Surface};
///
/// # let asperity = Asperity {
/// #     radius: 1e-6,
/// #     reduced_modulus: 100e9,
/// #     work_of_adhesion: 0.05,
/// #     equilibrium_spacing: 0.2e-9,
/// #     hardness: 5e9,
/// #     poisson_ratio: 0.3,
/// #     lubricant_thickness: 0.0,
/// # };
/// let dmt = model("dmt").unwrap();
/// let typical = dmt.law(&LawParameters::new(&asperity, Path::Approach, (-1e-8, 1e-7))?)?;
/// let family = Some(Family::new(dmt, asperity, Path::Approach, (1e-6, 1e6))?);
/// let laws = SurfaceLaws { typical, family };
/// let surface = Surface { radii: Radii::LogNormal(0.3), ..Surface::uniform(1e-9, 1e-6, 100, 1e-10) };
/// // So close that all touch: the attraction is that of 100 asperities of the mean radius.
/// let integral = Expectations::new(laws.view(), &surface, &[-2e-8]);
/// let expected = 100.0 * 2.0 * std::f64::consts::PI * 1e-6 * 0.05;
/// assert!((integral.expected[0][0] / expected - 1.0).abs() < 1e-9);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct SurfaceLaws {
    /// The law of the typical asperity.
    pub typical: Box<dyn Law>,
    /// The laws by radius, where asperities differ in it.
    pub family: Option<Family>,
}

impl SurfaceLaws {
    /// The view that sums take.
    pub fn view(&self) -> Laws<'_> {
        Laws { typical: self.typical.as_ref(), family: self.family.as_ref() }
    }
}

impl Deref for SurfaceLaws {
    type Target = dyn Law;

    fn deref(&self) -> &Self::Target {
        self.typical.as_ref()
    }
}
