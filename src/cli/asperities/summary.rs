//! A measured surface as the terminal shows it.

use super::surface::Surface;
use crate::cli::rows::row;
use crate::format::{percent, pure, si};
use crate::scene::echo::one_line;
use crate::surface::map::Summit;

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
    text +=
        &row("asperities", &format!("{} on {:.4e} m^2", asperities.summits.len(), asperities.nominal_area));
    text += &surface.caveats.iter().map(|caveat| row("warning", caveat)).collect::<String>();
    text.push('\n');
    text += &parameters(surface);
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
