//! A measured surface as the terminal shows it.

use super::surface::Surface;
use crate::cli::rows::row;
use crate::format::{percent, pure, si, signed_percent};
use crate::scene::echo::one_line;
use crate::surface::map::{Measured, Shape, Summit};

pub(super) fn summary(surface: &Surface<'_>) -> String {
    let Surface { arguments, asperities, map, .. } = surface;
    let mut text = format!("{}\n", one_line(&arguments.map.display().to_string()));
    let [rows, columns] = map.shape();
    let [dy, dx] = map.pixel();
    text += &row(
        "map",
        &format!("{columns} x {rows} pixels of {} x {} ({})", si(dx, "m"), si(dy, "m"), surface.source),
    );
    let pixels = (rows * columns) as f64;
    if surface.missing > 0 {
        let share = percent(surface.missing as f64 / pixels);
        text += &row("missing", &format!("{} heights, {share}", surface.missing));
    }
    text += &row("levelled", &format!("less the {}", arguments.level.surface()));
    if let Some(cutoff) = arguments.smooth {
        let [down, along] = map.margin();
        let left = format!("{along} x {down} pixels along the border left out");
        text += &row("smoothed", &format!("Gaussian, cut-off {}; {left}", si(cutoff, "m")));
    }
    let moments = &asperities.moments;
    let heights = format!(
        "standard deviation {}, skewness {:.3}, excess kurtosis {:.3}",
        si(moments.m0.sqrt(), "m"),
        moments.skewness,
        moments.excess_kurtosis
    );
    text += &row("heights", &heights);
    let [m0, m2, m4] = [moments.m0, moments.m2(), moments.m4()];
    text += &row(
        "moments",
        &format!("m0 = {m0:.4e} m^2, m2 = {m2:.4e}, m4 = {m4:.4e} /m^2, alpha = {}", pure(moments.alpha())),
    );
    let prominent = arguments.prominence.map(|least| format!(", prominent by {} or more", si(least, "m")));
    let prominent = prominent.unwrap_or_default();
    let count = asperities.summits.len();
    text += &row("asperities", &format!("{count} on {:.4e} m^2{prominent}", asperities.nominal_area));
    text += &shape(&asperities.shape, count);
    text += &surface.caveats.iter().map(|caveat| row("warning", caveat)).collect::<String>();
    text.push('\n');
    text += &parameters(surface);
    text += &series(surface);
    if let Some(output) = &arguments.output {
        text.push('\n');
        text += &row("written", &output.display().to_string());
    }
    text
}

/// The parameters of an equivalent surface, counted and by theory, side by side.
fn parameters(surface: &Surface<'_>) -> String {
    let (measured, equivalent) = (&surface.asperities.measured, &surface.asperities.equivalent);
    let line = |label: &str, summits: String, moments: String, ratio: f64| {
        row(label, &format!("{summits:>18}{moments:>18}{ratio:>9.3}"))
    };
    let mut text = row("", &format!("{:>18}{:>18}{:>9}", "of summits", "of moments", "ratio"));
    let density = |density: f64| format!("{} /um^2", pure(1e-12 * density));
    let (ours, theirs) = (measured.density, equivalent.density);
    text += &line("density", density(ours), density(theirs), ours / theirs);
    let (ours, theirs) = (measured.radius, equivalent.radius);
    text += &line("1/mean curvature", si(ours, "m"), si(theirs, "m"), ours / theirs);
    let summits = &surface.asperities.summits;
    let mean = summits.iter().map(Summit::radius).sum::<f64>() / summits.len() as f64;
    text +=
        &row("mean radius", &format!("{:>18}  the R that a run of these asperities tells", si(mean, "m")));
    let (ours, theirs) = (measured.height_mean, equivalent.height_mean);
    text += &line("mean height", si(ours, "m"), si(theirs, "m"), ours / theirs);
    let (ours, theirs) = (measured.height_std, equivalent.height_std);
    text += &line("height std", si(ours, "m"), si(theirs, "m"), ours / theirs);
    let beta = |density: f64, radius: f64, std: f64| density * radius * std;
    let ours = beta(measured.density, measured.radius, measured.height_std);
    let theirs = beta(equivalent.density, equivalent.radius, equivalent.height_std);
    text + &line("eta R sigma_s", pure(ours), pure(theirs), ours / theirs)
}

/// The deviation of `count` summits from the spheres of the laws, and its effect on their force.
fn shape(shape: &Shape, count: usize) -> String {
    if !shape.ratio.is_finite() {
        return String::new();
    }
    let [mean, geometric] = shape.forces.map(|share| signed_percent(share - 1.0));
    let mut text =
        row("shape", &format!("k1/k2 = {:.2}, median ratio of the principal curvatures", shape.ratio))
            + &row(
                "",
                "Hertz force of a sphere against that of such an ellipsoid, at the same interference:",
            )
            + &row("", &format!("{mean} with R = 1/mean curvature, {geometric} with R = 1/sqrt(k1 k2)"));
    if shape.saddles > 0 {
        let share = 100.0 * shape.saddles as f64 / count as f64;
        let saddles =
            format!("{} of {count} ({share:.1} %) are saddles by second differences, k2 <= 0", shape.saddles);
        text += &row("", &format!("{saddles}: spheres of their mean curvature"));
    }
    text
}

/// The parameters over the cut-off; the cut-off of the map has a mark.
fn series(surface: &Surface<'_>) -> String {
    if surface.series.is_empty() {
        return String::new();
    }
    let line = |cutoff: &str, count: &str, density: &str, radius: &str, std: &str| {
        row(cutoff, &format!("{count:>9}{density:>18}{radius:>18}{std:>14}"))
    };
    let mut text = "\n".to_owned() + &line("cut-off", "summits", "density", "1/mean curv.", "height std");
    for at in &surface.series {
        let mark = if surface.arguments.smooth == Some(at.cutoff) { " *" } else { "" };
        let of = |value: fn(&Measured) -> f64| at.measured.as_ref().map_or(f64::NAN, value);
        let length = |value: f64| if value.is_finite() { si(value, "m") } else { "-".to_owned() };
        let density = format!("{} /um^2", pure(1e-12 * at.count as f64 / at.nominal_area));
        text += &line(
            &format!("{}{mark}", si(at.cutoff, "m")),
            &at.count.to_string(),
            &density,
            &length(of(|measured| measured.radius)),
            &length(of(|measured| measured.height_std)),
        );
    }
    text
}
