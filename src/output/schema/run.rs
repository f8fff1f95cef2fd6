//! The layout of a result of `stiction run`.

use super::curves::{
    DIRECTIONS, OF_ENSEMBLE, OF_INTEGRAL, Statistic, background, forces, quantile, quantities, regimes,
    scalars, scores,
};
use super::independence::independence;
use super::{Dimension, Layout, N, NONE, Row, S, Variable, group, scale, variable, with_coordinates};
use crate::engine;
use std::sync::LazyLock;

const R: &[Dimension] = &[Dimension::Regime];
const NS: &[Dimension] = &[Dimension::Replica, Dimension::Separation];
const KS: &[Dimension] = &[Dimension::Component, Dimension::Separation];
const A: &[Dimension] = &[Dimension::Scalar];
const T: &[Dimension] = &[Dimension::Target];
const AE: &[Dimension] = &[Dimension::Scalar, Dimension::RangeEnd];
const TE: &[Dimension] = &[Dimension::Target, Dimension::RangeEnd];
const Q: &[Dimension] = &[Dimension::State];
const PLACES: &[Dimension] = &[Dimension::Asperity];
const QA: &[Dimension] = &[Dimension::State, Dimension::Asperity];
const V: &[Dimension] = &[Dimension::AvalancheSize];
const NV: &[Dimension] = &[Dimension::Replica, Dimension::AvalancheSize];
const W: &[Dimension] = &[Dimension::EnergyClass];
const NW: &[Dimension] = &[Dimension::Replica, Dimension::EnergyClass];
const J: &[Dimension] = &[Dimension::Step];
const D: &[Dimension] = &[Dimension::Stiffness];
const P: &[Dimension] = &[Dimension::Preload];
const PD: &[Dimension] = &[Dimension::Preload, Dimension::Stiffness];
const ND: &[Dimension] = &[Dimension::Replica, Dimension::Stiffness];
const NP: &[Dimension] = &[Dimension::Replica, Dimension::Preload];
const NPD: &[Dimension] = &[Dimension::Replica, Dimension::Preload, Dimension::Stiffness];

/// Groups of runs, and of sweeps, that not every scene has.
pub(super) const OPTIONAL_GROUPS: &[&str] =
    &["asperities", "background", "capillary", "coupling", "film", "independence", "instability"];

/// A result of `stiction run`.
pub static RUN: Layout = Layout {
    format: "stiction-run",
    command: "stiction run",
    version: [3, 7],
    groups: &["ensemble", "replicas", "integral", "validation", "diagnostics"],
    optional_groups: OPTIONAL_GROUPS,
    variables: LazyLock::new(variables),
    of_points: None,
};

/// All datasets that a file may hold.
fn variables() -> Vec<Variable> {
    let groups = [
        ensemble(),
        replicas(),
        coupling(),
        asperities(),
        capillary(),
        film(),
        instability(),
        integral(),
        background(NONE),
        independence(NONE),
        validation(),
    ];
    with_coordinates([groups.concat(), group("/diagnostics", NONE, DIAGNOSTICS)].concat())
}

fn ensemble() -> Vec<Variable> {
    const GROUP: &str = "/ensemble";
    let mut all = vec![scale(GROUP, Dimension::Control)];
    for direction in DIRECTIONS {
        all.extend(quantities(GROUP, S, direction, &OF_ENSEMBLE));
        all.push(quantile(GROUP, NONE, direction));
        all.extend(regimes(GROUP, NONE, direction, OF_ENSEMBLE[0]));
    }
    all.extend(group(GROUP, NONE, OF_SCALARS));
    all.extend(jumps(GROUP, OF_ENSEMBLE[0]));
    all
}

fn replicas() -> Vec<Variable> {
    const GROUP: &str = "/replicas";
    let mut all = group(
        GROUP,
        NONE,
        &[
            ("asperity_count", N, "1", "number of asperities"),
            ("highest_asperity", N, "m", "highest asperity above the asperity mean plane"),
        ],
    );
    all.extend(scalars(NONE, engine::scalars(true)));
    for (prefix, on) in DIRECTIONS {
        for (force, sign) in [("external_force", ", compressive positive"), ("adhesion_force", "")] {
            let meaning = format!("{} of each replica{on}{sign}", force.replace('_', " "));
            all.push(variable(format!("{GROUP}/{prefix}{force}"), NS, "N", meaning));
        }
    }
    for scalar in engine::scalars(true) {
        let meaning = format!("{}, without coupling", scalar.meaning);
        all.push(variable(format!("{GROUP}/independent_{}", scalar.name), N, scalar.units, meaning));
    }
    all.extend(group(GROUP, NONE, COUPLED));
    all.extend(group(GROUP, NONE, SNAPS));
    all
}

/// What coupling makes of an ensemble.
fn coupling() -> Vec<Variable> {
    const GROUP: &str = "/coupling";
    let mut all = Vec::new();
    for (prefix, on) in DIRECTIONS {
        for (kind, what) in
            [("independent", "without coupling"), ("difference", "with coupling less without")]
        {
            let statistics = OF_ENSEMBLE.map(|(suffix, meaning)| (suffix, format!("{meaning}, {what}")));
            let statistics: Vec<Statistic> = statistics
                .iter()
                .map(|(suffix, meaning)| (*suffix, &**meaning))
                .take(if kind == "independent" { 3 } else { 2 })
                .collect();
            all.extend(quantities(GROUP, S, (&format!("{prefix}{kind}_"), on), &statistics));
        }
        for (name, units, words) in [
            ("avalanche_count_mean", "1", "avalanches on the step to each separation{}, mean over replicas"),
            (
                "largest_avalanche_mean",
                "1",
                "asperities in the largest avalanche of the step{}, mean over replicas",
            ),
            (
                "energy_lost_mean",
                "J",
                "energy that avalanches lost on the step to each separation{}, mean over replicas, NaN with the contact kernel",
            ),
            ("unsettled_count", "1", "replicas without a stable state{}"),
            ("overlapping_count", "1", "replicas in which circles of contact overlap{}"),
        ] {
            all.push(variable(format!("{GROUP}/{prefix}{name}"), S, units, words.replace("{}", on)));
        }
    }
    for (name, words) in [
        ("independent_mean", "scalar without coupling, mean over replicas"),
        ("independent_standard_error", "scalar without coupling, standard error of the mean"),
        (
            "difference_mean",
            "scalar with coupling less that of the same asperities without, mean over replicas",
        ),
        ("difference_standard_error", "standard error of that mean difference"),
    ] {
        all.push(variable(format!("{GROUP}/scalar_{name}"), A, "scalar_units", words));
    }
    all.extend(group(GROUP, NONE, &[("scalar_units", A, "1", "units of each scalar")]));
    let sizes = "avalanches of all replicas at all separations, by their size";
    let energies = "separations of all replicas at which avalanches lost energy, by how much";
    all.extend(group(
        GROUP,
        NONE,
        &[("avalanche_size_count", V, "1", sizes), ("energy_lost_count", W, "1", energies)],
    ));
    all
}

/// Asperities of the first replica one by one.
fn asperities() -> Vec<Variable> {
    const GROUP: &str = "/asperities";
    let mut all = group(GROUP, NONE, ASPERITIES);
    for (prefix, on) in DIRECTIONS {
        for (name, units, words) in OF_ASPERITIES {
            all.push(variable(format!("{GROUP}/{prefix}{name}"), QA, units, words.replace("{}", on)));
        }
    }
    all
}

/// Bridges of liquid.
fn capillary() -> Vec<Variable> {
    const GROUP: &str = "/capillary";
    let mut all = group(GROUP, NONE, LIQUID);
    for (prefix, on) in DIRECTIONS {
        for (name, dimensions, words) in [
            ("wet_share", S, "share of the asperities that touch or have a bridge{}, mean over replicas"),
            (
                "covered_share",
                S,
                "share of the nominal area that wetted circles of the mean area cover at random places{}",
            ),
            (
                "bridge_step_count",
                S,
                "asperities that become dry when the faces part from the separation before{}, or wet the other way, mean over \
                 replicas, 0 at the first",
            ),
        ] {
            all.push(variable(format!("{GROUP}/{prefix}{name}"), dimensions, "1", words.replace("{}", on)));
        }
        let words = "force of liquid that spreads between merging bridges{}, beyond that of the bridges, attraction \
                     positive: in the external force, not in the adhesion force";
        let path = format!("{GROUP}/{prefix}spread_force");
        all.push(variable(path, S, "N", words.replace("{}", on)));
    }
    for (name, words) in [
        ("area_force", "tension of a liquid that fills all gaps below range, attraction positive"),
        ("contour_force", "force of the contour around these gaps, attraction positive"),
    ] {
        all.push(variable(format!("{GROUP}/{name}"), S, "N", words));
    }
    all
}

/// Films of liquid.
fn film() -> Vec<Variable> {
    const GROUP: &str = "/film";
    let mut all = group(GROUP, NONE, FILM);
    for (prefix, on) in DIRECTIONS {
        for (name, units, words) in [
            ("thickness", "m", "thickness of the films{}, drained into the expected bridges"),
            (
                "external_force",
                "N",
                "external force of the integral{} with the films of each separation, compressive positive",
            ),
        ] {
            all.push(variable(format!("{GROUP}/{prefix}{name}"), S, units, words.replace("{}", on)));
        }
    }
    all
}

fn instability() -> Vec<Variable> {
    const GROUP: &str = "/instability";
    let mut all = Vec::new();
    let stable = "share of replicas that snap in, of those that are stable at the last separation";
    let retracted = "share of replicas that snap off, of those that were retracted and are stable at the first separation";
    for (name, dimensions, share) in [("in", D, stable), ("off", PD, retracted)] {
        let end =
            |end: &str| format!("{end} end of the 95 % Wilson interval of the probability to snap {name}");
        for (of, meaning) in [
            ("count", format!("replicas that snap {name}")),
            ("probability", share.to_owned()),
            ("probability_low", end("lower")),
            ("probability_high", end("upper")),
        ] {
            all.push(variable(format!("{GROUP}/snap_{name}_{of}"), dimensions, "1", meaning));
        }
    }
    all.extend(group(GROUP, NONE, PRELOADS));
    all
}

fn integral() -> Vec<Variable> {
    const GROUP: &str = "/integral";
    let mut all = Vec::new();
    for direction in DIRECTIONS {
        all.extend(quantities(GROUP, S, direction, &OF_INTEGRAL));
        all.extend(regimes(GROUP, NONE, direction, OF_INTEGRAL[0]));
    }
    let at = "at pull-off of the integral, or at the smallest separation where nothing pulls";
    for (name, dimensions, units, words) in [
        ("regime_count", R, "1", "asperities in each regime"),
        ("regime_adhesion_force", R, "N", "adhesion force of each regime"),
        ("contact_area", NONE, "m2", "contact area"),
    ] {
        all.push(variable(format!("{GROUP}/pull_off_{name}"), dimensions, units, format!("{words} {at}")));
    }
    all.extend(jumps(GROUP, OF_INTEGRAL[0]));
    all
}

fn validation() -> Vec<Variable> {
    let mut all = Vec::new();
    for direction in DIRECTIONS {
        let (prefix, on) = direction;
        let path = |name: &str| format!("/validation/{prefix}{name}_");
        let tested = format!("whether the joint test looks at the {{}}{on} here (1) or not (0)");
        let weights = format!("weights of the {{}}{on} in each functional of the joint test");
        all.extend(scores(NONE, direction));
        all.extend(forces(&path("tested"), "", S, "1", &tested));
        all.extend(forces(&path("probe"), "", KS, "N-1", &weights));
        for (name, units, words) in MEAN_FIELD {
            let words = words.replace("{}", on);
            all.push(variable(format!("/validation/{prefix}mean_field_{name}"), S, units, words));
        }
    }
    all
}

/// Contacts made and lost between neighbouring separations of a loop.
fn jumps(group: &str, (suffix, meaning): (&str, &str)) -> Vec<Variable> {
    let one = |(name, words): (&str, &str)| {
        variable(format!("{group}/{name}_count{suffix}"), J, "1", meaning.replace("{}", words))
    };
    let on_approach = "asperities that come into contact on approach";
    [("jump_in", on_approach), ("jump_off", "asperities that lose contact on retraction")].map(one).to_vec()
}

const OF_SCALARS: &[Row] = &[
    ("scalar_units", A, "1", "units of each scalar"),
    ("scalar_mean", A, "scalar_units", "scalar, mean over replicas"),
    ("scalar_standard_error", A, "scalar_units", "scalar, standard error of the mean"),
    ("scalar_interval", AE, "scalar_units", "scalar, confidence interval of the mean"),
    (
        "scalar_most_differing",
        A,
        "1",
        "where a scalar is the same in all replicas: share of patches that differ at most, with 95 % confidence",
    ),
    ("scalar_controlled_mean", A, "scalar_units", "scalar, mean with control variates"),
    (
        "scalar_controlled_standard_error",
        A,
        "scalar_units",
        "scalar, standard error of the mean with control variates",
    ),
    (
        "scalar_controlled_interval",
        AE,
        "scalar_units",
        "scalar, confidence interval of the mean with control variates",
    ),
    (
        "scalar_variance_reduction",
        A,
        "1",
        "variance of the mean of a scalar over that of the mean with control variates",
    ),
    ("target_estimate", T, "1", "which mean the target is for, plain or controlled"),
    ("target_units", T, "1", "units of each target"),
    ("target_mean", T, "target_units", "mean of the target's quantity over replicas"),
    ("target_standard_error", T, "target_units", "standard error of the target's mean"),
    ("target_interval", TE, "target_units", "confidence interval of the target's mean"),
    ("target_largest_standard_error", T, "target_units", "largest standard error that the target allows"),
    ("target_met", T, "1", "whether the target is met (1) or not (0)"),
];

/// The curve with coupling against its mean field.
const MEAN_FIELD: [(&str, &str, &str); 5] = [
    (
        "separation",
        "m",
        "separation x that coupled asperities have by mean field{}: h + F/k_s of a patch, h of a repeated square",
    ),
    (
        "external_force",
        "N",
        "external force by mean field{}, which is that of the integral at the separation x; where there are several, \
         it is that of surfaces which have come from the other end of the path",
    ),
    ("difference", "N", "mean external force with coupling{} less that by mean field"),
    ("standard_error", "N", "standard error of that difference{}"),
    ("z", "1", "that difference{} in standard errors"),
];

const COUPLED: &[Row] = &[
    ("unsettled_count", N, "1", "separations at which a coupled replica has no stable state"),
    ("overlapping_count", N, "1", "separations at which circles of contact of a coupled replica overlap"),
    (
        "largest_crowding",
        N,
        "1",
        "largest (a_i + a_j)/r_ij of a coupled replica at all separations, contact radii over distance: 1 where circles touch",
    ),
    ("largest_avalanche", N, "1", "asperities in the largest avalanche of a coupled replica"),
    ("avalanche_size_count", NV, "1", "avalanches of a coupled replica at all separations, by their size"),
    (
        "energy_lost",
        N,
        "J",
        "energy that avalanches of a coupled replica lost at all separations, NaN with the contact kernel",
    ),
    (
        "energy_lost_count",
        NW,
        "1",
        "separations at which avalanches of a coupled replica lost energy, by how much",
    ),
];

const ASPERITIES: &[Row] = &[
    ("state_separation", Q, "m", "separation h of each state"),
    ("x", PLACES, "m", "place of each asperity of the first replica along the first side of the surface"),
    ("y", PLACES, "m", "place of each asperity of the first replica along the other side of the surface"),
    (
        "height",
        PLACES,
        "m",
        "height of each asperity of the first replica above the mean plane of the surface",
    ),
    ("radius", PLACES, "m", "radius of each asperity of the first replica"),
];

/// Name, units and meaning.
const OF_ASPERITIES: [(&str, &str, &str); 7] = [
    ("interference", "m", "interference of each asperity{}"),
    ("external_force", "N", "external force of each asperity{}, compressive positive"),
    ("contact_force", "N", "contact force of each asperity{}"),
    ("contact_area", "m2", "contact area of each asperity{}"),
    ("in_contact", "1", "whether each asperity is in contact{} (1) or not (0)"),
    ("has_touched", "1", "whether each asperity has touched{} and remembers it (1) or not (0)"),
    ("at_rest", "1", "whether each asperity is at rest at a jump of its law{} (1) or not (0)"),
];

const LIQUID: &[Row] = &[
    ("kelvin_radius", NONE, "m", "Kelvin radius r_K of the meniscus"),
    ("capillary_pressure", NONE, "Pa", "tension p_c = gamma/r_K in the liquid"),
    ("range", NONE, "m", "widest gap h_0 that the liquid fills"),
    ("liquid_energy", NONE, "J m-2", "energy that filling a gap gains, gamma s and that of the films"),
    (
        "solid_energy",
        NONE,
        "J m-2",
        "work of adhesion less gamma s: the energy between the solids in the liquid",
    ),
];

const FILM: &[Row] = &[
    ("initial_thickness", NONE, "m", "thickness of the films before they drain"),
    ("law_thickness", NONE, "m", "thickness of the films in the law of all replicas: that at pull-off"),
];

const SNAPS: &[Row] = &[
    (
        "snap_in",
        ND,
        "1",
        "whether the surface snaps in (1) or not (0), NaN where it is unstable at the last separation",
    ),
    ("snap_in_separation", ND, "m", "separation h where the largest snap-in begins, NaN without one"),
    (
        "snap_in_distance",
        ND,
        "m",
        "how far the surface snaps in, NaN where nothing within the separations stops it",
    ),
    (
        "snap_off",
        NPD,
        "1",
        "whether the surface snaps off (1) or not (0), NaN where it was never retracted or is unstable at the first separation",
    ),
    ("snap_off_separation", NPD, "m", "separation h where the largest snap-off begins, NaN without one"),
    (
        "snap_off_distance",
        NPD,
        "m",
        "how far the surface snaps off, NaN where nothing within the separations stops it",
    ),
    (
        "preload_separation",
        NP,
        "m",
        "separation h where the preload is reached and the surface retracts, NaN where it is not reached",
    ),
    ("pull_off_after_preload", NP, "N", "pull-off force after that preload"),
    ("pull_off_after_preload_separation", NP, "m", "separation h at that pull-off"),
];

const PRELOADS: &[Row] = &[
    ("fly_off_count", PD, "1", "replicas that snap off and that nothing within the separations stops"),
    ("preload_reached_count", P, "1", "replicas that reach the preload"),
    (
        "pull_off_after_preload_mean",
        P,
        "N",
        "pull-off force after the preload, mean over the replicas that reach it",
    ),
    (
        "pull_off_after_preload_std",
        P,
        "N",
        "pull-off force after the preload, standard deviation of one replica",
    ),
];

const DIAGNOSTICS: &[Row] = &[
    ("contact_solves", NONE, "1", "solves of the contact equations"),
    ("noncontact_solves", NONE, "1", "solves of the noncontact equations"),
    ("safeguarded_solves", NONE, "1", "solves for which the starting table was not good enough"),
    ("skipped_solves", &[Dimension::SkipReason], "1", "asperities that needed no solve"),
    ("skipped_loads", NONE, "1", "asperities whose load and area were not summed, because nothing touches"),
    ("moment_sums", NONE, "1", "sums of a surface at one separation that were made of moments"),
    ("iterations", NONE, "1", "evaluations of the equations by all solves"),
    ("largest_residual", NONE, "1", "largest relative residual before the last Newton step"),
    ("seconds", &[Dimension::Phase], "s", "wall time of each phase"),
    ("threads", NONE, "1", "threads that computed the ensemble"),
    ("resumptions", NONE, "1", "how often the run was resumed after an interruption"),
    ("checkpoints", NONE, "1", "checkpoints that were saved since the run was last resumed"),
    ("checkpoint_seconds", NONE, "s", "wall time that saving these checkpoints took"),
];
