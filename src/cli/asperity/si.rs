//! Tables of asperities in SI: what each is made of and how far it is pressed, and the forces of that.

use super::{at, field_number, wrong};
use crate::asperity::Model;
use crate::asperity::scale::{Asperity, Scale};
use crate::asperity::{
    InnerState, Law, LawError, LawParameters, Loop, Path, Regime, SolvedAsperity, SolverStats,
};
use crate::input::table::{Row, Table};
use crate::scene::echo::shortened;
use crate::scene::nearest;
use crate::scene::units::{Dimension, parse};

/// The dimensions of the columns that have units.
const DIMENSIONS: [(&str, Dimension); 8] = [
    ("radius", Dimension::Length),
    ("reduced_modulus", Dimension::Pressure),
    ("work_of_adhesion", Dimension::SurfaceEnergy),
    ("equilibrium_spacing", Dimension::Length),
    ("interference", Dimension::Length),
    ("hardness", Dimension::Pressure),
    ("lubricant_thickness", Dimension::Length),
    ("deepest_interference", Dimension::Length),
];
/// The columns that have to be there.
pub(super) const NEEDED: [&str; 5] =
    ["radius", "reduced_modulus", "work_of_adhesion", "equilibrium_spacing", "interference"];
/// The columns that may be there, and may be empty.
const OPTIONAL: [&str; 4] = ["hardness", "poisson_ratio", "lubricant_thickness", "deepest_interference"];
/// The columns that are put behind them.
const FOUND: &str = "adhesion_parameter,regime,adhesion_force,contact_force,external_force,contact_radius";
/// Largest interference, as a multiple of the unit of the approach.
const MOST: f64 = 1e100;

/// A column of the table.
#[derive(Clone, Copy)]
struct Column {
    place: usize,
    /// 1 of its unit, SI.
    unit: f64,
}

/// An asperity of a table, SI.
#[derive(Clone, Copy, PartialEq)]
struct Tip {
    needed: [f64; NEEDED.len() - 1],
    optional: [Option<f64>; OPTIONAL.len() - 1],
    /// Whether it unloads.
    is_back: bool,
}

/// The state of an asperity that is asked for.
struct Asked {
    tip: Tip,
    /// δ, and the deepest before where the asperity unloads, m.
    interference: f64,
    deepest: Option<f64>,
}

/// The law of a tip.
enum Known {
    /// On its way along a path.
    Way(Box<dyn Law>),
    /// Back from where it turned.
    Back(Box<Loop>),
}

impl Known {
    fn new(tip: &Tip, model: &Model, parameters: &LawParameters) -> Result<Self, LawError> {
        Ok(if tip.is_back {
            Self::Back(Box::new(Loop::new(model, parameters)?))
        } else {
            Self::Way(model.law(parameters)?)
        })
    }

    /// The state that is asked for.
    fn solved(&self, asked: &Asked) -> SolvedAsperity {
        match (self, asked.deepest) {
            (Self::Back(cycle), Some(deepest)) => {
                SolvedAsperity::new(&cycle.at(deepest - asked.interference), deepest)
            }
            (Self::Back(cycle), None) => SolvedAsperity::new(cycle.approach(), asked.interference),
            (Self::Way(law), _) => SolvedAsperity::new(law.as_ref(), asked.interference),
        }
    }

    /// The problem of a state of unloading.
    fn problem(&self, asked: &Asked, law: &str) -> Option<String> {
        let Asked { interference, deepest, .. } = *asked;
        let (Self::Back(cycle), Some(deepest)) = (self, deepest) else { return None };
        if deepest < interference {
            return Some(format!(
                "deepest_interference = `{deepest:e}` m is less than the interference, `{interference:e}` m; give the \
                 interference at which the asperity turned"
            ));
        }
        let onset = cycle.approach().regimes().iter().position(|regime| regime.is_plastic())?;
        let onset = cycle.approach().boundaries()[onset.checked_sub(1)?].interference;
        (!cycle.yields() && deepest > onset).then(|| {
            format!(
                "deepest_interference = `{deepest:e}` m is above {onset:.3e} m, from where on the asperity flows, and {law} \
                 is a law of loading; take --law md_plastic"
            )
        })
    }
}

/// The table with the forces of every row behind what is given, all of it SI.
///
/// # Errors
/// The problem, with its line and column.
pub(super) fn solved(
    table: Table<'_>,
    model: &Model,
    path: Path,
    diagnostics: bool,
) -> Result<String, String> {
    let columns = columns(&table)?;
    let cost = if diagnostics { ",iterations,safeguarded" } else { "" };
    let header = line(table.heads.iter().map(|head| head.text.as_str()));
    let mut text = format!("{header},{FOUND}{cost}\n");
    let mut known: Option<(Tip, Scale, Known)> = None;
    for row in table.rows() {
        let row = row?;
        let asked = read(&row, &columns)?;
        let (tip, interference) = (asked.tip, asked.interference);
        let (_, scale, law) = match known.take() {
            Some(same) if same.0 == tip => known.insert(same),
            _ => {
                let parameters = tip.parameters(path).map_err(|error| refused(&row, &error))?;
                let law = Known::new(&tip, model, &parameters).map_err(|error| refused(&row, &error))?;
                known.insert((tip, parameters.scale, law))
            }
        };
        if !(interference.abs() <= MOST * scale.length) {
            let problem = "is too large beside the unit of the approach";
            return Err(at(&row, &format!("interference = `{interference}` {problem}")));
        }
        if let Some(problem) = law.problem(&asked, model.name) {
            return Err(at(&row, &problem));
        }
        let solved = law.solved(&asked);
        let numbers =
            [solved.adhesion_force, solved.contact_force, solved.external_force(), solved.contact_radius()];
        let numbers = numbers.map(|number| format!("{number:.16e}")).join(",");
        let regime = solved.regime.map_or("none", Regime::name);
        let SolverStats { evaluations, safeguarded, .. } = solved.stats;
        let cost = if diagnostics { format!(",{evaluations},{safeguarded}") } else { String::new() };
        let given = line(row.fields.iter());
        text += &format!("{given},{:.16e},{regime},{numbers}{cost}\n", scale.lambda);
    }
    Ok(text)
}

/// Fields as a line of CSV.
fn line<'f>(fields: impl Iterator<Item = &'f str>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(fields).expect("memory takes any record");
    let bytes = writer.into_inner().expect("memory takes any record");
    String::from_utf8_lossy(&bytes).trim_end().to_owned()
}

/// The columns, the optional ones behind the others.
fn columns(table: &Table<'_>) -> Result<[Option<Column>; NEEDED.len() + OPTIONAL.len()], String> {
    let known = || NEEDED.into_iter().chain(OPTIONAL);
    if let Some(missing) = NEEDED.iter().find(|name| table.place(name).is_none()) {
        let (needed, optional) = (NEEDED.join(","), OPTIONAL.join(","));
        return Err(format!(
            "line 1: no column `{missing}`; the columns {needed} are needed, in SI or with a unit, and {optional} may \
             be there"
        ));
    }
    for (i, head) in table.heads.iter().enumerate() {
        if known().any(|known| table.place(known) == Some(i)) {
            continue;
        }
        if let Some(meant) = nearest(&head.name, known().filter(|known| table.place(known).is_none())) {
            return Err(format!(
                "line 1: unknown column `{}`; did you mean `{meant}`?",
                shortened(&head.text)
            ));
        }
    }
    let mut found = [None; NEEDED.len() + OPTIONAL.len()];
    for (found, name) in found.iter_mut().zip(known()) {
        *found = table.place(name).map(|place| column(table, place, name)).transpose()?;
    }
    Ok(found)
}

/// The column of a name.
fn column(table: &Table<'_>, place: usize, name: &str) -> Result<Column, String> {
    let Some(given) = &table.heads[place].unit else { return Ok(Column { place, unit: 1.0 }) };
    let Some((_, dimension)) = DIMENSIONS.iter().find(|(known, _)| *known == name) else {
        return Err(format!("line 1: {name} is a number without a unit"));
    };
    let unit = parse(&format!("1 {given}"), *dimension).map_err(|_| {
        let (unit, of, units) = (shortened(given), dimension.name(), dimension.units());
        format!("line 1: {name} ({unit}): the unit of {of} is needed: {units}")
    })?;
    Ok(Column { place, unit })
}

/// The state that a row asks for.
fn read(row: &Row, columns: &[Option<Column>]) -> Result<Asked, String> {
    let number = |name: &str, column: Column, does: fn(f64) -> bool, needed: &str| {
        let value = field_number(row, column.place, name)?;
        match value.is_finite() && does(value) {
            true => Ok(value * column.unit),
            false => Err(wrong(row, column.place, name, &format!("will not do: {needed} is needed"))),
        }
    };
    let (places, optional) = columns.split_at(NEEDED.len());
    let mut needed = [0.0; NEEDED.len()];
    for ((value, name), place) in needed.iter_mut().zip(NEEDED).zip(places) {
        let column = place.expect("columns that are needed are there");
        *value = match name {
            "interference" => number(name, column, |_| true, "a finite number")?,
            _ => number(name, column, |value| value > 0.0, "a positive number")?,
        };
    }
    let given = |i: usize, does: fn(f64) -> bool, needed: &str| {
        let column = optional[i].filter(|column| !row.fields[column.place].is_empty());
        column.map(|column| number(OPTIONAL[i], column, does, needed)).transpose()
    };
    let optional = [
        given(0, |value| value > 0.0, "a positive number")?,
        given(1, |value| value > -1.0 && value <= 0.5, "a number greater than -1 and at most 0.5")?,
        given(2, |value| value >= 0.0, "0 or a positive number")?,
    ];
    let deepest = given(3, |_| true, "a finite number")?;
    if optional[0].is_some() && optional[1].is_none() {
        return Err(at(row, "poisson_ratio is missing, which the hardness needs"));
    }
    let [radius, modulus, work, spacing, interference] = needed;
    let tip = Tip { needed: [radius, modulus, work, spacing], optional, is_back: deepest.is_some() };
    Ok(Asked { tip, interference, deepest })
}

impl Tip {
    /// The parameters of its law; it stays elastic where no hardness is given.
    fn parameters(&self, path: Path) -> Result<LawParameters, LawError> {
        let [radius, reduced_modulus, work_of_adhesion, equilibrium_spacing] = self.needed;
        let [hardness, poisson_ratio, lubricant_thickness] = self.optional;
        let asperity = Asperity {
            radius,
            reduced_modulus,
            work_of_adhesion,
            equilibrium_spacing,
            hardness: hardness.unwrap_or(f64::INFINITY),
            poisson_ratio: poisson_ratio.unwrap_or(0.0),
            lubricant_thickness: lubricant_thickness.unwrap_or(0.0),
        };
        let parameters = LawParameters {
            scale: Scale::new(&asperity)?,
            critical_interference: asperity.critical_interference(),
            pressure_factor: asperity.pressure_factor(),
            hardness_ratio: hardness.map(|hardness| hardness / reduced_modulus),
            lubricant_thickness: asperity.lubricant_thickness,
            critical_approach: None,
            path,
            inner_state: InnerState::default(),
            table_range: None,
        };
        parameters.checked()
    }
}

fn refused(row: &Row, error: &LawError) -> String {
    match error {
        LawError::Elastic(law) => {
            at(row, &format!("hardness and poisson_ratio are missing, which the law {law} needs"))
        }
        error => at(row, &error.to_string()),
    }
}
