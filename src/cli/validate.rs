//! `stiction validate`: whether a file is damaged, and its cross-check computed again.

use super::failure::Failure;
use super::sweep::together;
use super::terminal::print;
use crate::engine::Ways;
use crate::output::check::{Checked, Content, CrossCheck, SweptPoint, check};
use crate::scene::echo::one_line;
use crate::summary::rows::row;
use crate::summary::run::verdict;
use crate::validation::Verdict;
use std::path::Path;

/// Contradictions that are shown; more are counted.
const SHOWN: usize = 20;
/// Rows of the table; more separations are thinned out.
const ROWS: usize = 25;

pub(super) fn validate(path: &Path) -> Result<(), Failure> {
    let checked = check(path)?;
    let content = match &checked.content {
        Content::Run { cross_check, ways } => table(cross_check, *ways),
        Content::Integral => "the integral alone, no replicas\n".to_owned(),
        Content::Sweep { keys, points } => swept(keys, points),
        Content::Asperities(count) => format!("{count} asperities of a measured surface\n"),
    };
    concluded(format!("{}\n{content}", one_line(&path.display().to_string())), &checked)
}

/// The points of a sweep, a line each, and the verdict on all of them.
fn swept(keys: &str, points: &[SweptPoint]) -> String {
    let mut text =
        format!("{:>6}  {:<28}{:>10}{:>8}{:>10}  {}\n", "point", "indices", "chi2", "k", "p", "verdict");
    let mut p_values = Vec::with_capacity(points.len());
    for (point, SweptPoint { place, joint }) in points.iter().enumerate() {
        text += &format!("{:>6}  ", point + 1);
        text += &match joint {
            None => "of which no replicas are there\n".to_owned(),
            Some(joint) => {
                let indices: Vec<String> = place.iter().map(usize::to_string).collect();
                let (components, verdict) = (joint.degrees_of_freedom, joint.verdict.name());
                let [statistic, p] = [format!("{:.1}", joint.statistic), format!("{:.4}", joint.p_value)];
                format!("{:<28}{statistic:>10}{components:>8}{p:>10}  {verdict}\n", indices.join(", "))
            }
        };
        p_values.push(joint.as_ref().map_or(f64::NAN, |joint| joint.p_value));
    }
    text + &format!("indices along {}\n", one_line(keys)) + &together(&p_values)
}

/// Separation by separation, and the verdict.
fn table(cross_check: &CrossCheck, ways: usize) -> String {
    let CrossCheck { h_star, forces, z, joint } = cross_check;
    let mut text =
        "        h*   mean F_s (N)   integral (N)       z     mean F (N)   integral (N)       z\n".to_owned();
    let step = h_star.len().div_ceil(ROWS);
    for k in (0..h_star.len()).step_by(step.max(1)) {
        let cells = [0, 1]
            .map(|i| format!("{:>14.6e} {:>14.6e} {:>7}", forces[i][0][k], forces[i][1][k], score(z[i][k])));
        let (_, way) = Ways::NAMES[k / (h_star.len() / ways)];
        text += &format!("{:>10.3} {}{way}\n", h_star[k], cells.join(" "));
    }
    let shown = if step > 1 {
        format!("one in {step} of {} separations is shown", h_star.len())
    } else {
        "all separations are shown".to_owned()
    };
    let largest = |z: &[f64]| z.iter().filter(|z| z.is_finite()).map(|z| z.abs()).reduce(f64::max);
    let [adhesion, external] =
        [&z[0], &z[1]].map(|z| largest(z).map_or("-".to_owned(), |z| format!("{z:.2}")));
    text + &verdict(joint)
        + &row("", &format!("largest |z|: adhesion force {adhesion}, external force {external}"))
        + &row("", &shown)
}

/// A z-score; a dash where nothing varies.
fn score(z: f64) -> String {
    if z.is_finite() { format!("{z:.2}") } else { "-".to_owned() }
}

/// Prints what was found, and ends as it says.
fn concluded(text: String, Checked { contradictions, verdict, .. }: &Checked) -> Result<(), Failure> {
    let shown = contradictions.iter().take(SHOWN).enumerate();
    let mut rows: String =
        shown.map(|(i, own)| row(if i == 0 { "contradictions" } else { "" }, own)).collect();
    if contradictions.len() > SHOWN {
        rows += &row("", &format!("and {} more", contradictions.len() - SHOWN));
    }
    if contradictions.is_empty() {
        rows = row("file", "whole: all of it was read");
    }
    print(&(text + &rows))?;
    match (&contradictions[..], verdict) {
        ([], Verdict::Disagree) => Err(Failure::Disagree),
        ([], _) => Ok(()),
        ([one], _) => Err(Failure::Contradicts(one.clone())),
        (more, _) => Err(Failure::Contradicts(format!("{} contradictions in the file", more.len()))),
    }
}
