//! The numbers of a replica whose means over replicas have no closed form.

use super::cycle::Cycle;
use super::job::Ways;
use super::replica::Replica;

/// A number that is read off a replica's own curve.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, model};
/// use stiction::engine::{Job, SCALARS, Scalar};
/// use stiction::surface::Surface;
///
/// # let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// # let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// # let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let ensemble = Job::new(law.as_ref(), &surface, &separations, 8, 1).ensemble();
/// let Scalar { name, units, of, .. } = SCALARS[0];
/// assert_eq!((name, units), ("pull_off_force", "N"));
/// assert_eq!(of(&ensemble.replicas[0]), ensemble.replicas[0].pull_off_force);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Scalar {
    /// The name.
    pub name: &'static str,
    /// The units, SI.
    pub units: &'static str,
    /// The meaning, in files.
    pub meaning: &'static str,
    /// The value.
    pub of: fn(&Replica) -> f64,
}

/// The scalars of every replica.
pub const SCALARS: [Scalar; 4] = [
    Scalar {
        name: "pull_off_force",
        units: "N",
        meaning: "pull-off force, minus the minimum of the replica's external force",
        of: |replica| replica.pull_off_force,
    },
    Scalar {
        name: "pull_off_separation",
        units: "m",
        meaning: "separation h at pull-off",
        of: |replica| replica.pull_off_separation,
    },
    Scalar {
        name: "peak_secant_stiffness",
        units: "N m-1",
        meaning: "largest secant stiffness of the external force over the stiffness span",
        of: |replica| replica.peak_secant_stiffness,
    },
    Scalar {
        name: "peak_secant_stiffness_separation",
        units: "m",
        meaning: "separation h in the middle of the span of the peak secant stiffness",
        of: |replica| replica.peak_secant_stiffness_separation,
    },
];

/// The scalars of a replica that is brought close and pulled back.
pub const LOOP_SCALARS: [Scalar; 5] = [
    Scalar {
        name: "approach_pull_off_force",
        units: "N",
        meaning: "minus the minimum of the external force on approach",
        of: |replica| of_cycle(replica, |cycle| cycle.approach_pull_off_force),
    },
    Scalar {
        name: "approach_pull_off_separation",
        units: "m",
        meaning: "separation h of that minimum",
        of: |replica| of_cycle(replica, |cycle| cycle.approach_pull_off_separation),
    },
    Scalar {
        name: "dissipated_energy",
        units: "J",
        meaning: "integral of the external force over the separation, on approach less on retraction; 0 where it is below its rounding",
        of: |replica| of_cycle(replica, |cycle| cycle.dissipated_energy),
    },
    Scalar {
        name: "touchdown_separation",
        units: "m",
        meaning: "separation h at which the highest asperity touches on approach, NaN without asperities",
        of: |replica| of_cycle(replica, |cycle| cycle.touchdown_separation),
    },
    Scalar {
        name: "detachment_separation",
        units: "m",
        meaning: "separation h at which the last contact is lost on retraction, NaN without contact",
        of: |replica| of_cycle(replica, |cycle| cycle.detachment_separation),
    },
];

/// The scalar of a replica that is brought close again.
pub const REPEATED_SCALARS: [Scalar; 1] = [Scalar {
    name: "repeated_dissipated_energy",
    units: "J",
    meaning: "energy that each further cycle to the same depth dissipates; 0 where it is below its rounding",
    of: |replica| of_cycle(replica, |cycle| cycle.repeated_dissipated_energy.unwrap_or(f64::NAN)),
}];

/// A number of a replica that is a loop; NaN of any other.
fn of_cycle(replica: &Replica, of: fn(&Cycle) -> f64) -> f64 {
    replica.cycle.as_deref().map_or(f64::NAN, of)
}

/// The scalars of a job on its ways: [`SCALARS`], and of loops behind these [`LOOP_SCALARS`] and [`REPEATED_SCALARS`].
pub fn scalars(ways: Ways) -> impl Iterator<Item = Scalar> {
    let of_loops = LOOP_SCALARS.into_iter().filter(move |_| ways.is_loop());
    let of_repeated = REPEATED_SCALARS.into_iter().filter(move |_| ways == Ways::Repeated);
    SCALARS.into_iter().chain(of_loops).chain(of_repeated)
}
