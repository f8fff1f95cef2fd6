//! Warnings of a scene that is outside of what the models are valid for, or of what is known of materials and
//! surfaces, so that a unit may be wrong.
//!
//! Contacts do not merge. They are small against their radius, their number is large, and the surface is a continuum.

use super::definition::Scene;
use super::ranges::{FEWEST_ASPERITIES, Range, ranges};
use super::warning::{Expected, Reading, Warning, WhatIsRead, units};
use crate::asperity::scale::{Asperity, STRESS_RATIO};
use crate::asperity::{Adhesion, LARGEST_DMT_LAMBDA, LARGEST_ELASTIC_PSI, Model, Plasticity};
use crate::asperity::{Law, PlasticContact};
use crate::background::VanDerWaals;
use crate::format::{counted, si, signed_percent};
use crate::integral::{HIGHEST, LARGEST_CONTACT, LARGEST_SHARE, substrate_stiffness};
use crate::substrate::Coupling;
use crate::surface::{HeightLaw, Radii};

/// Most copies of the highest measured asperity in a replica on average: 95 % of the patches have it.
const MOST_COPIES: f64 = 3.0;
/// Largest fraction of a value read off the curves that the separations may miss.
const LARGEST_MISSED: f64 = 0.05;
/// Steps of the separation, over σ_s, that miss less.
const RESOLVING: f64 = 0.15;
/// Largest relative excess of the pull-off of surfaces that have touched.
const LARGEST_HELD: f64 = 0.01;
/// Largest fraction of the adhesion at pull-off of asperities that do not touch.
const LARGEST_UNTOUCHED: f64 = 0.5;
/// Largest relative error of an integral that passes without a warning.
const LARGEST_ERROR: f64 = 1e-6;
/// Largest displacement of a patch, in σ, that is neglected.
const LARGEST_SHIFT: f64 = 0.05;
/// Fewest given heights that pull at pull-off.
const FEWEST_NEAR: usize = 5;
/// Fewest contacts in the whole run at the closest separation.
const FEWEST_CONTACTS: f64 = 100.0;
/// Smallest Kelvin radius of a meniscus that is a continuum, m.
const SMALLEST_MENISCUS: f64 = 0.5e-9;
/// Largest fraction of the adhesion that contacts which have yielded may carry by fits for low λ.
const LARGEST_FLOWED: f64 = 0.1;
/// Largest fraction by which the curvature of a meniscus around an asperity shortens its reach.
const LARGEST_SHORTENING: f64 = 0.1;
/// Largest adhesive stress over the largest pressure of the plastic contact at which contacts detach at their interface.
const LARGEST_STRESS: f64 = 1.0;
/// Interference over the critical one up to which pull-offs by the fit of the apex radius are within some 10 % of finite elements,
/// and the largest fraction of the yielding contacts that may be beyond it.
const LARGEST_FITTED: f64 = 10.0;
const LARGEST_FLATTENED: f64 = 0.1;
/// Fewest contacts of a replica, on average, that yield before it is pulled back for the plastic contact to matter.
const FEWEST_YIELDED: f64 = 0.1;
/// Fewest contacts in the whole run that count.
const FEWEST_UNLOADED: f64 = 0.5;
/// Radius, over that of the typical asperity, of the asperities that yield first, where radii differ.
const SMALLEST_RADIUS: f64 = 0.1;
/// Fewest contacts of the whole run that yield, on average, for a loop to need a law of unloading.
const FEWEST_REFUSED: f64 = 1e-6;

/// The warnings of a scene under a law, of which the integral is `expected`.
pub fn warnings(scene: &Scene, model: &Model, law: &dyn Law, expected: &Expected) -> Vec<Warning> {
    let mut warnings = exceeded(scene, model);
    warnings.extend(warnings_of_scene(scene, model, law, expected));
    warnings
}

/// The warnings of a scene apart from the law's own limits.
pub fn warnings_of_scene(scene: &Scene, model: &Model, law: &dyn Law, expected: &Expected) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = ranges(scene).into_iter().filter_map(Range::warning).collect();
    warnings.extend(sizes(scene, model.validity.dry));
    warnings.extend(copies(scene));
    warnings.extend(wet(scene, model));
    warnings.extend(contacts(scene, law));
    warnings.extend(unloading(scene, law));
    warnings.extend(ductile(scene, model, law));
    warnings.extend(flattened(scene, model, &expected.readings));
    warnings.extend(left_out(scene, law, &expected.readings));
    warnings.extend(joined(scene, model, &expected.readings));
    warnings.extend(contact_share(scene, &expected.readings));
    warnings.extend(repeated(scene, &expected.readings));
    warnings.extend(tails(scene, &expected.readings));
    warnings.extend(expected.held.and_then(held));
    warnings.extend(pressed(scene, model));
    warnings.extend(unresolved(scene, &expected.readings));
    warnings.extend(twice(scene));
    warnings.extend(mean_planes(scene));
    warnings.extend(inaccurate(expected.error));
    warnings
}

/// Limits of λ and ψ of σ_s of a law that a scene exceeds.
fn exceeded(scene: &Scene, model: &Model) -> Vec<Warning> {
    let exceeded = model.validity.exceeded(scene.scale().lambda, scene.plasticity_index()).into_iter();
    exceeded
        .map(|(finding, reason)| {
            Warning::new(finding, reason, "model.law = \"md_plastic\" has no such limit")
        })
        .collect()
}

/// Lengths that are too large or too small relative to others, under a law that may take the asperities as
/// dry, and too few asperities.
fn sizes(scene: &Scene, dry: bool) -> Vec<Warning> {
    let (asperity, surface) = (&scene.asperity, &scene.surface);
    let sigma = surface.surface_height_std;
    let mut warnings = Vec::new();
    let deepest = HIGHEST * surface.heights.std - surface.asperity_separation(scene.separations[0]);
    let largest = (deepest.max(0.0) / asperity.radius).sqrt();
    if largest > LARGEST_CONTACT {
        warnings.push(Warning::new(format!(
                "contacts of the highest asperities are {largest:.2} of their radius wide at the closest separation, more than {LARGEST_CONTACT}"
            ), "the laws take contacts as small against the radius (Johnson 1985, section 4.2)",
            "loads that close are rough: check the units, or let [separation] begin at a larger h"));
    }
    let adhesive = scene.scale().radius / asperity.radius;
    if adhesive > LARGEST_CONTACT {
        warnings.push(Warning::new(
            format!(
                "adhesion makes contacts {adhesive:.2} of their radius wide, more than {LARGEST_CONTACT}"
            ),
            "the laws take contacts as small against the radius (Maugis 1995)",
            units(&["reduced_modulus", "work_of_adhesion", "asperity_radius"]),
        ));
    }
    if sigma < asperity.equilibrium_spacing {
        warnings.push(Warning::new(
            format!(
                "sigma = {:.3} nm is below the equilibrium spacing of {:.3} nm",
                1e9 * sigma,
                1e9 * asperity.equilibrium_spacing
            ),
            "such a surface is rough by atoms, not by asperities (Luan and Robbins 2005)",
            units(&["surface_height_std", "asperity_height_std", "equilibrium_spacing"]),
        ));
    }
    if asperity.lubricant_thickness > sigma && !dry {
        warnings.push(Warning::new(
            format!(
                "the lubricant of {:.3} nm is thicker than sigma = {:.3} nm",
                1e9 * asperity.lubricant_thickness,
                1e9 * sigma
            ),
            "sub-boundary lubrication is that of films thinner than the roughness, without menisci \
                     (Stanley, Etsion and Bogy 1990)",
            units(&["lubricant_thickness", "surface_height_std"]),
        ));
    }
    // Under a body there may be few.
    let is_flat = surface.heights.depths().is_none();
    if is_flat && surface.asperity_count < FEWEST_ASPERITIES {
        warnings.push(Warning::new(format!("N = {} is fewer than {FEWEST_ASPERITIES} asperities per replica", surface.asperity_count), "a patch with this few is no population of heights (Greenwood and Williamson 1966); its standard deviation is of \
                     the size of its mean", units(&["nominal_area", "asperity_density"])));
    }
    warnings
}

/// Whether nearly every patch has a copy of the highest measured asperity, and none a higher one.
fn copies(scene: &Scene) -> Option<Warning> {
    let surface = &scene.surface;
    let HeightLaw::Sample(heights) = &surface.heights.law else { return None };
    let count = heights.len();
    let copies = surface.asperity_count as f64 / count as f64;
    let change = match &surface.radii {
        Radii::Measured(_) => "surface.spectrum of the map's moments has a tail of heights",
        _ => "surface.heights of a law, such as \"gaussian\", has a tail of heights",
    };
    (copies > MOST_COPIES && !surface.whole).then(|| {
        Warning::new(
            format!("the highest of the {count} heights is in a replica {copies:.1} times on average, more than {MOST_COPIES}"),
            "a patch so much larger than what was measured would have higher asperities, and patches would differ more",
            format!("a smaller surface.nominal_area has patches of what was measured; {change}"),
        )
    })
}

/// Whether a few of the highest given heights carry the pull-off, of which replicas have several copies at one height.
fn repeated(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let surface = &scene.surface;
    let HeightLaw::Sample(heights) = &surface.heights.law else { return None };
    let pull_off = readings.iter().find(|reading| reading.what == WhatIsRead::PullOff)?;
    // As far as an asperity attracts through its film.
    let Asperity { equilibrium_spacing, lubricant_thickness, .. } = scene.asperity;
    let plane = surface.asperity_separation(pull_off.separation) - surface.heights.mean;
    let near =
        heights.iter().filter(|height| **height > plane - equilibrium_spacing - lubricant_thickness).count();
    let change = match &surface.radii {
        Radii::Measured(_) => {
            "compare surface.asperities.sample = \"whole\", and surface.spectrum, which has a tail of heights"
        }
        _ => "compare surface.heights of a law, such as \"gaussian\", which has a tail of heights",
    };
    ((1..FEWEST_NEAR).contains(&near) && !surface.whole).then(|| {
        Warning::new(
            format!(
                "{near} of the {} given heights carry the pull-off, fewer than {FEWEST_NEAR}: replicas have copies of them at one \
                 height, whose pull-off together is too large",
                heights.len()
            ),
            "a surface has no two summits of exactly one height",
            change,
        )
    })
}

/// Menisci that are too small for a continuum or too large for the asperities, and solids that the liquid separates, under a law
/// of a liquid.
fn wet(scene: &Scene, model: &Model) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let Some(meniscus) = scene.model.meniscus().filter(|_| model.is_wet()) else { return warnings };
    let (kelvin, dry_range) = (meniscus.kelvin_radius, scene.asperity.attraction_range());
    let keys: &[&str] = match scene.draining_film {
        Some(_) => &["film_thickness", "asperity_radius"],
        None => &["relative_humidity", "asperity_radius"],
    };
    // In dry air there is no meniscus to be too small.
    if kelvin < SMALLEST_MENISCUS && meniscus.share_beyond(dry_range) > 0.0 {
        warnings.push(Warning::new(
            format!("the Kelvin radius is {}, below {}", si(kelvin, "m"), si(SMALLEST_MENISCUS, "m")),
            "a meniscus of a few molecules is no surface of a liquid (Fisher and Israelachvili 1981)",
            units(&keys[..1]),
        ));
    }
    let share = meniscus.shortening(scene.surface.asperity_radius);
    if share > LARGEST_SHORTENING {
        warnings.push(Warning::new(
            format!(
                "the curvature around bridges takes {} % of the reach of the liquid, more than {:.0} %",
                above(share, LARGEST_SHORTENING),
                100.0 * LARGEST_SHORTENING
            ),
            "forces of bridges have it to first order, and are off by some four times its square from Young and Laplace",
            units(if scene.draining_film.is_some() { keys } else { &["relative_humidity", "contact_angles", "asperity_radius"] }),
        ));
    }
    let solid = meniscus.solid_energy(scene.asperity.work_of_adhesion, dry_range);
    if !(solid > 0.0) {
        warnings.push(Warning::new(
            format!(
                "the work of adhesion of the dry solids, {}, is not above the energy of the liquid, {}",
                si(scene.asperity.work_of_adhesion, "J/m^2"),
                si(meniscus.energy(), "J/m^2")
            ),
            "the liquid comes between such solids (Young and Dupre), which are computed without adhesion of their own in it",
            units(&["work_of_adhesion", "contact_angles"]),
        ));
    }
    warnings
}

/// The number of contacts of the whole run that yield before retraction under a law of loading alone, and the plastic contact that is
/// nearest to its own; none where too few do. Where radii differ, contacts of small ones yield sooner.
pub(super) fn unknown_unloading(scene: &Scene) -> Option<(f64, PlasticContact)> {
    let Plasticity::Loading(nearest) = scene.model.validity.plasticity else { return None };
    let onset = scene.turns().then(|| yield_onset(scene.law_of(&scene.model).ok()?.typical.as_ref()))??;
    let least = if scene.surface.is_polydisperse() { SMALLEST_RADIUS * onset } else { onset };
    let flowing = contacts_beyond(scene, least);
    (flowing >= FEWEST_REFUSED).then_some((flowing, nearest))
}

/// Interference, m, from which contacts yield under a law, if they do.
fn yield_onset(law: &dyn Law) -> Option<f64> {
    let first = law.regimes().iter().position(|regime| regime.is_plastic()).filter(|first| *first > 0)?;
    Some(law.boundaries()[first - 1].interference)
}

/// Whether enough contacts of a replica yield before retraction, under a law that takes any plastic contact, for the
/// pull-off to depend on the plastic contact: on approach the contacts agree within 1 %. Where radii differ, contacts of small ones yield sooner.
pub(crate) fn yields(scene: &Scene, law: &dyn Law, readings: &[Reading]) -> bool {
    let Some(onset) = yield_onset(law).filter(|_| scene.model.has_unloading()) else { return false };
    let least = if scene.surface.is_polydisperse() { SMALLEST_RADIUS * onset } else { onset };
    let count = scene.surface.asperity_count as f64;
    let mut turns = readings.iter().filter(|reading| reading.what == WhatIsRead::Turn);
    turns.any(|turn| share_beyond(scene, least, turn.separation) * count >= FEWEST_YIELDED)
}

/// The fraction of asperities that yield under a law before retraction, of which each then has an outline of its own.
pub(crate) fn share_of_yielded(scene: &Scene, law: &dyn Law) -> f64 {
    let onset = yield_onset(law).filter(|_| scene.turns() && scene.model.has_unloading());
    onset.map_or(0.0, |onset| share_beyond(scene, onset, scene.separations[0]))
}

/// The fraction of asperities beyond an interference, m, at a separation h, m.
fn share_beyond(scene: &Scene, interference: f64, h: f64) -> f64 {
    scene.surface.heights.probability(interference + scene.surface.asperity_separation(h), f64::INFINITY)
}

/// Contacts of the whole run beyond an interference, m, at the closest separation.
fn contacts_beyond(scene: &Scene, interference: f64) -> f64 {
    share_beyond(scene, interference, scene.separations[0]) * asperities_of_run(scene)
}

/// Whether contacts unload that have yielded by adhesion alone.
fn unloading(scene: &Scene, law: &dyn Law) -> Option<Warning> {
    let onset = yield_onset(law).filter(|onset| scene.turns() && *onset < 0.0)?;
    (contacts_beyond(scene, onset) >= FEWEST_UNLOADED).then(|| {
        Warning::new(
            format!("adhesion alone makes contacts yield, from the interference {} on", si(onset, "m")),
            "the plastic contact does not know of the tension around it",
            "the pull-off of such soft summits is uncertain: compare model.plastic_contact",
        )
    })
}

/// Whether yielding contacts would be torn off rather than detach at their interface.
fn ductile(scene: &Scene, model: &Model, law: &dyn Law) -> Option<Warning> {
    let Asperity { work_of_adhesion, equilibrium_spacing, hardness, .. } = scene.asperity;
    let contact = model.contact().filter(|_| scene.turns())?;
    let pressure = contact.largest_pressure(&scene.asperity);
    let share = STRESS_RATIO * work_of_adhesion / (equilibrium_spacing * pressure);
    let tears = |onset: &f64| share > LARGEST_STRESS && contacts_beyond(scene, *onset) >= FEWEST_UNLOADED;
    let of = if pressure < hardness { "the pressure at which contacts yield" } else { "the hardness" };
    yield_onset(law).filter(tears).map(|_| {
        Warning::new(
            format!("the adhesive stress is {share:.2} of {of}, more than {LARGEST_STRESS}"),
            "summits as soft and sticky detach by plastic deformation, not at their interface (Du et al. 2007), which the law leaves out",
            units(&["work_of_adhesion", "equilibrium_spacing", "hardness"]),
        )
    })
}

/// Whether summits are pressed so far that the fit of the radius that they keep is uncertain.
fn flattened(scene: &Scene, model: &Model, readings: &[Reading]) -> Option<Warning> {
    let flow = scene.asperity.critical_interference();
    if !model.has_unloading() {
        return None;
    }
    let beyond = |turn: &&Reading| share_beyond(scene, LARGEST_FITTED * flow, turn.separation);
    let turn = readings.iter().filter(|reading| reading.what == WhatIsRead::Turn);
    let turn = turn.max_by(|a, b| beyond(a).total_cmp(&beyond(b)))?;
    let share = beyond(&turn) / share_beyond(scene, flow, turn.separation);
    (share > LARGEST_FLATTENED).then(|| {
        Warning::new(
            format!(
                "{:.0} % of the contacts that yield are pressed beyond {LARGEST_FITTED:.0} times the critical interference at h* = {:.3}",
                100.0 * share,
                turn.separation / scene.surface.surface_height_std
            ),
            "the radius that such summits keep is a fit (Etsion et al. 2005); by finite elements pull-offs are up to 27 % larger at 30 times, \
             and half as large at 100 times where E/Y is 100",
            "take the pull-off as uncertain by that",
        )
    })
}

/// Whether a law that ends leaves out asperities where results are read off.
fn left_out(scene: &Scene, law: &dyn Law, readings: &[Reading]) -> Option<Warning> {
    let end = law.boundaries().get(law.regimes().len() - 1)?.interference;
    let count = scene.surface.asperity_count as f64;
    let words = |reading: &Reading| {
        let share = share_beyond(scene, end, reading.separation);
        let (left, share) = (share * count, 100.0 * share);
        (left >= FEWEST_UNLOADED)
            .then(|| format!("{left:.0} of {count:.0} asperities ({share:.2} %) {}", reading.what.place()))
    };
    let places: Vec<String> = readings.iter().filter_map(words).collect();
    (!places.is_empty()).then(|| {
        Warning::new(
            format!(
                "the law ends at the interference {} and leaves out {}",
                si(end, "m"),
                places.join(" and ")
            ),
            "asperities beyond the end of a law bear no force and adhere with none",
            "model.law = \"md_plastic\" has no end",
        )
    })
}

/// Whether contacts that have yielded carry adhesion under a law that joins Maugis and Dugdale's to Kogut and Etsion's fits.
fn joined(scene: &Scene, model: &Model, readings: &[Reading]) -> Option<Warning> {
    let lambda = scene.scale().lambda;
    let is_joined = matches!(model.validity.plasticity, Plasticity::Loading(_))
        && model.validity.adhesion == Adhesion::Any;
    if !is_joined || !(lambda > LARGEST_DMT_LAMBDA) {
        return None;
    }
    let words = |what: WhatIsRead, share: f64, h_star: &str| {
        format!(
            "contacts that have yielded carry {:.0} % of the adhesion {}, {h_star}",
            100.0 * share,
            what.place()
        )
    };
    let shares = phrases(scene, readings, LARGEST_FLOWED, |reading| reading.flowed_adhesion, words)?;
    Some(Warning::new(
        format!("lambda = {lambda:.3} is above {LARGEST_DMT_LAMBDA}, and {shares}"),
        "theirs is by fits for DMT-like contacts (Kogut and Etsion 2003) and jumps where they begin to yield",
        "model.law = \"md_plastic\" is continuous there",
    ))
}

/// The asperities of all replicas; of the integral alone those of a patch.
fn asperities_of_run(scene: &Scene) -> f64 {
    scene.surface.asperity_count as f64 * scene.replicas.max(1) as f64
}

/// Whether any asperity touches at the closest separation, and enough of them.
fn contacts(scene: &Scene, law: &dyn Law) -> Option<Warning> {
    let first = law.regimes().iter().position(|regime| regime.is_contact())?;
    let touch = match first {
        0 => f64::NEG_INFINITY,
        _ => law.boundaries()[first - 1].interference,
    };
    let contacts = contacts_beyond(scene, touch);
    let h_star = scene.separations[0] / scene.surface.surface_height_std;
    let place = format!("in the whole run at the closest separation, h* = {h_star:.3}");
    // The integral leaves nothing to chance.
    if contacts >= FEWEST_CONTACTS || scene.replicas == 0 && contacts >= 0.5 {
        return None;
    }
    let (finding, reason) = if contacts < 0.5 {
        let finding = format!("{contacts:.1e} contacts are expected {place}");
        (finding, "nothing touches, only attraction across the gap is computed".to_owned())
    } else {
        let expected = counted(contacts.round_ties_even() as u64, "contact is", "contacts are");
        let finding = format!("only {expected} expected {place}, fewer than {FEWEST_CONTACTS}");
        (
            finding,
            format!("what rests on them has a relative error of {:.0} % (Poisson)", 100.0 / contacts.sqrt()),
        )
    };
    Some(Warning::new(finding, reason, units(&["separation", "surface_height_std"])))
}

/// A phrase for each reading whose value exceeds `largest`, joined by "and". `phrase` makes it of what is read, the value and h*.
fn phrases(
    scene: &Scene,
    readings: &[Reading],
    largest: f64,
    of: fn(&Reading) -> f64,
    phrase: fn(WhatIsRead, f64, &str) -> String,
) -> Option<String> {
    let phrase = |reading: &Reading| {
        let h_star = reading.separation / scene.surface.surface_height_std;
        phrase(reading.what, of(reading), &format!("h* = {h_star:.3}"))
    };
    let all: Vec<String> = readings.iter().filter(|reading| of(reading) > largest).map(phrase).collect();
    (!all.is_empty()).then(|| all.join(" and "))
}

/// A fraction above a limit in whole per cent, with a digit more where it would look like the limit.
fn above(share: f64, limit: f64) -> String {
    let digits = usize::from(100.0 * share < 100.0 * limit + 0.5);
    format!("{:.digits$}", 100.0 * share)
}

/// Whether contacts cover too much of the surface, where results are read off, to be independent.
fn contact_share(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let phrase = |what: WhatIsRead, share: f64, h_star: &str| {
        let share = match share {
            share if share < 10.0 => format!("{} % of", above(share, LARGEST_SHARE)),
            share => format!("{share:.0} times"),
        };
        format!("{share} the nominal area is in contact {}, {h_star}", what.place())
    };
    let shares = phrases(scene, readings, LARGEST_SHARE, |reading| reading.share_in_contact, phrase)?;
    Some(Warning::new(
        format!("{shares}: more than {:.0} %", 100.0 * LARGEST_SHARE),
        "asperities are taken as independent (Greenwood and Williamson 1966), but of contacts that cover so much at \
                 random one in three overlaps",
        match scene.instability.preload.is_empty() {
            true => {
                "turn back at a larger separation; at pull-off compute the whole contact by boundary elements"
            }
            false => {
                "press with a smaller preload; at pull-off compute the whole contact by boundary elements"
            }
        },
    ))
}

/// Whether the pull-off is that of contacts, and not of the tails of attraction of asperities that do not touch, which
/// together stand for the attraction between the surfaces.
fn tails(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let surface = &scene.surface;
    let Asperity { work_of_adhesion, equilibrium_spacing, .. } = scene.asperity;
    let reading = readings.iter().find(|reading| reading.what == WhatIsRead::PullOff)?;
    let (h, share) = (reading.separation, reading.untouched_adhesion);
    let is_of_tails = share > LARGEST_UNTOUCHED && surface.background.is_none() && h > 0.0;
    // The pull-off of a loop is on retraction, and replicas under a body pull off elsewhere than their mean.
    let is_read = !scene.turns() && surface.heights.depths().is_none();
    (is_of_tails && is_read).then(|| {
        let planes = VanDerWaals::new(VanDerWaals::lennard_jones(work_of_adhesion, equilibrium_spacing), None);
        let flat = surface.nominal_area * planes.at(h).pressure;
        let h_star = h / surface.surface_height_std;
        Warning::new(
            format!(
                "{:.0} % of the adhesion at pull-off, h* = {h_star:.3}, is of asperities that do not touch; flat surfaces attract \
                 with {} at this h",
                100.0 * share,
                si(flat, "N")
            ),
            "the tails of asperities are no sum over the surfaces: between these act the van der Waals forces of all their points",
            "compare with [van_der_waals], the attraction between the mean planes",
        )
    })
}

/// Whether the pull-off of surfaces that have touched is larger than that on approach, N.
fn held([on_approach, touched]: [f64; 2]) -> Option<Warning> {
    let more = touched / on_approach - 1.0;
    (more > LARGEST_HELD).then(|| {
        let [on_approach, touched] = [on_approach, touched].map(|force| si(force, "N"));
        let more = signed_percent(more);
        Warning::new(
            format!("surfaces that have touched are pulled off with {touched}, not {on_approach} ({more})"),
            "contact lasts beyond first touch (Maugis 1992), and longer where summits yielded: model.history = \"approach\" is of surfaces that never touched",
            "model.history = \"loop\" or \"retraction\" is of those that did",
        )
    })
}

/// Whether surfaces that have been pressed together are pulled off harder than the approach of fresh ones says.
fn pressed(scene: &Scene, model: &Model) -> Option<Warning> {
    let (psi, yields) = (scene.plasticity_index(), model.validity.plasticity != Plasticity::Without);
    (yields && psi > LARGEST_ELASTIC_PSI && !scene.turns()).then(|| {
        Warning::new(
            format!("psi of sigma_s = {psi:.3} is above {LARGEST_ELASTIC_PSI}: surfaces that were pressed together have a larger pull-off"),
            "summits that have yielded are flatter (Greenwood and Williamson 1966): model.history = \"approach\" is of the first \
                     touch",
            "for surfaces in use model.law = \"md_plastic\", model.history = \"loop\", instability.preload",
        )
    })
}

/// Whether the separations are fine enough for the values that are read off the curves.
fn unresolved(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let phrase = |what: WhatIsRead, share: f64, h_star: &str| {
        let share = if share < 1.0 { format!("{:.0} %", 100.0 * share) } else { "all".to_owned() };
        format!("{share} of the {} at {h_star}", what.name())
    };
    let missed = phrases(scene, readings, LARGEST_MISSED, |reading| reading.missed, phrase)?;
    // What parabolas miss grows with the square of the step.
    let share = readings.iter().map(|reading| reading.missed).fold(0.0, f64::max).min(1.0);
    let [first, last] = [scene.separations[0], scene.separations[scene.separations.len() - 1]];
    let finer = (LARGEST_MISSED / share).sqrt() * (last - first) / (scene.separations.len() - 1) as f64;
    let resolving = finer.min(RESOLVING * scene.surface.heights.std) / scene.surface.surface_height_std;
    let why = "curves, scores and control variates are known at the separations only";
    let digits = (1.0 - libm::log10(resolving).floor()).max(0.0) as usize;
    let steps =
        format!("[separation] with steps of {resolving:.digits$} in h* has what the integral expects");
    Some(Warning::new(format!("the separations are too coarse: the curves miss {missed}"), why, steps))
}

/// Whether the half-space both couples the asperities and is the spring on the surface.
fn twice(scene: &Scene) -> Option<Warning> {
    let is_patch = scene.substrate.as_ref().is_some_and(|substrate| substrate.coupling == Coupling::Patch);
    let stiffness = substrate_stiffness(scene.asperity.reduced_modulus, scene.surface.loaded_area());
    (is_patch && scene.instability.stiffness.contains(&stiffness)).then(|| {
        Warning::new(
            "the half-space of the patch gives way twice: under the asperities, and as the spring that holds them".to_owned(),
            "by substrate.coupling = \"patch\" the half-space is there already",
            "instability.stiffness = \"patch\" is for independent asperities and substrate.coupling = \"periodic\"",
        )
    })
}

/// Effects that the forces between the mean planes leave out, each by itself and all of them: other than normal heights, and a
/// patch that they bend.
fn mean_planes(scene: &Scene) -> Vec<Warning> {
    let surface = &scene.surface;
    let mut warnings: Vec<Warning> =
        scene.forces.0.iter().flat_map(|(_, given)| given.warnings(scene.separations[0])).collect();
    if surface.background.is_none() {
        return warnings;
    }
    let law = &surface.plane().heights.law;
    if *law != HeightLaw::Gaussian && !matches!(surface.radii, Radii::Nayak(_)) {
        warnings.push(Warning::new(
            format!("the gaps between the mean planes are taken as normal, not {}", law.about()),
            "forces between them know the standard deviation of all points of the surface, not their law; the heights \
             of the scene are heights of asperities",
            "surface.heights.law = \"gaussian\" has normal gaps",
        ));
    }
    let is_patch = scene.substrate.as_ref().is_some_and(|substrate| substrate.coupling == Coupling::Patch);
    let stiffness = substrate_stiffness(scene.asperity.reduced_modulus, surface.loaded_area());
    let shift = surface.background_force(scene.separations[0]) / (stiffness * surface.surface_height_std);
    if is_patch && shift.abs() > LARGEST_SHIFT {
        warnings.push(Warning::new(
            format!("the pressure between the mean planes would bend the patch by {shift:.2} sigma"),
            "it is added to the force and bends nothing",
            "substrate.coupling = \"periodic\" is of a surface that it could not bend",
        ));
    }
    warnings
}

/// Whether the error of the integral is too large.
fn inaccurate(error: f64) -> Option<Warning> {
    (!(error <= LARGEST_ERROR)).then(|| {
        Warning::new(
            format!("the relative error of the integral may be {error:.1e}, more than {LARGEST_ERROR:.0e}"),
            "what is compared with it, or corrected by it as a control variate, is off by as much",
            "another model.law may be smoother",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_above_a_limit_does_not_look_like_it() {
        assert_eq!([above(0.102, 0.1), above(0.107, 0.1), above(0.27, 0.1)], ["10.2", "11", "27"]);
    }

    /// An integral that has lost something, or is not a number, is warned of.
    #[test]
    fn an_integral_that_is_none_is_reported() {
        assert!(inaccurate(1e-6).is_none());
        let finding = |error: f64| inaccurate(error).unwrap().finding;
        assert!(finding(0.19).contains("may be 1.9e-1, more") && finding(f64::NAN).contains("NaN"));
    }

    /// Circles of one size at random overlap none of their neighbours with the probability exp(−4 share).
    #[test]
    fn one_in_three_contacts_overlaps_at_the_largest_share() {
        assert!((1.0 - (-4.0 * LARGEST_SHARE).exp() - 1.0 / 3.0).abs() < 0.01);
    }
}
