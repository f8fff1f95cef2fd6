//! The points of a sweep put together into one result: the datasets of all, and their differences to the
//! first.

use super::points::Points;
use super::stack::{self, stack};
use crate::asperity::PlasticContact;
use crate::engine::SCALARS;
use crate::error::{Error, OutputError};
use crate::experiment::model_range::ends;
use crate::integral::Independence;
use crate::math::interval::LEVEL;
use crate::math::sums::SUM_ROUNDING;
use crate::output::datasets::{read_independence, write_limits};
use crate::output::file::{write_about, write_model};
use crate::output::kept::{Head, Identity, scene_file, state_in, write_restart};
use crate::output::layouts::{RUN, SWEEP};
use crate::output::reader::Reader;
use crate::output::writer::Writer;
use crate::scene::{Mode, Scene, Sweep};
use crate::validation::{Difference, SIGNIFICANCE, overall};
use std::path::{Path, PathBuf};

/// Computes the points and puts them together into the output: what each has to say, or none where the output
/// was complete.
///
/// # Errors
/// [`Error`]; points that are done are kept next to the output.
pub(crate) fn run_sweep(points: &Points<'_>) -> Result<Option<Vec<SweepPoint>>, Error> {
    points.require()?;
    let identity = points.identity(points.sweep.source())?;
    if !points.begin(&identity)? {
        return Ok(None);
    }
    points.compute()?;
    let rows = stacked(points, &identity, points.shard.is_some()).map_err(|error| points.kept(error))?;
    points.clear()?;
    Ok(Some(rows))
}

/// Puts the points together into the output, all that there are of a `partial` sweep: what each has to say.
pub(crate) fn stacked(
    points: &Points<'_>,
    identity: &Identity,
    partial: bool,
) -> Result<Vec<SweepPoint>, Error> {
    let scene = points.scene(0)?;
    match assembled(points, &scene, identity, partial) {
        Ok(Some(rows)) => Ok(rows),
        Ok(None) => Err(Error::Interrupted { done: scene.replicas, of: scene.replicas, kept: true }),
        Err(error) => Err(Error::NotWritten(error.writing(points.lock.output()))),
    }
}

/// One point of a sweep.
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let (source, output) = (folder.path().join("sweep.toml"), folder.path().join("sweep.h5"));
/// use stiction::{PointPullOff, SweepPoint};
///
/// let sweep = r#"[sweep]
/// "material.work_of_adhesion" = ["0.05 J/m^2", "0.09 J/m^2"]
/// "#;
/// let scene = std::fs::read_to_string("configs/quick.toml").unwrap();
/// std::fs::write(&source, scene + sweep).unwrap();
/// let points: Vec<SweepPoint> = stiction::sweep(&source, &output)?;
/// let difference = points[1].differences[0];
/// assert!(difference.mean > 10.0 * difference.standard_error, "more adhesion pulls harder");
/// let PointPullOff { preload, force: [mean, error], .. } = points[1].pull_offs[0];
/// assert!(preload.is_none() && mean > 10.0 * error);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SweepPoint {
    /// The pull-off of the whole history, or after each preload of the scene, in its order; none without replicas.
    pub pull_offs: Vec<PointPullOff>,
    /// Pull-off force of the integral, N.
    pub integral: f64,
    /// Difference of each of the [`SCALARS`] to the first point.
    pub differences: [Difference; 4],
    /// The p-value of the joint test.
    pub p_value: f64,
    /// Whether its asperities may be taken as independent; none where the point is not there.
    pub independence: Option<Independence>,
}

/// The pull-off of a point of a sweep, of its whole history or after a preload.
#[derive(Clone, Copy, Debug)]
pub struct PointPullOff {
    /// The preload, N; none where the pull-off is of the whole history.
    pub preload: Option<f64>,
    /// Mean pull-off force over the replicas and its standard error, N: of the whole history with control variates where there
    /// are some, after a preload over the replicas that reach it; NaN where none does.
    pub force: [f64; 2],
    /// Where the pull-off force is the same in all replicas, the largest share of patches that may differ, with 95 %
    /// confidence; otherwise NaN.
    pub most_differing: f64,
    /// Share of the replicas with a pull-off force above the restoring force of the device, and the ends of the 95 % interval
    /// of that probability; none without a device.
    pub stuck_probability: Option<[f64; 3]>,
    /// The smallest and the largest pull-off force by any plastic contact, N; none where no contacts yield.
    pub model_range: Option<[f64; 2]>,
    /// The smallest and the largest of that probability by any plastic contact.
    pub stuck_model_range: Option<[f64; 2]>,
}

impl SweepPoint {
    /// A point that is not there.
    const ABSENT: Self = Self {
        pull_offs: Vec::new(),
        integral: f64::NAN,
        differences: [Difference::UNKNOWN; 4],
        p_value: f64::NAN,
        independence: None,
    };

    /// The pull-off of the whole history, or after the largest preload that is reached; none where none is.
    pub fn pull_off(&self) -> Option<&PointPullOff> {
        let reached = self.pull_offs.iter().filter(|own| !own.force[0].is_nan());
        reached.max_by(|a, b| a.preload.partial_cmp(&b.preload).expect("preloads are numbers"))
    }
}

/// Puts the points together into the output; none when it was interrupted.
fn assembled(
    points: &Points<'_>,
    scene: &Scene,
    identity: &Identity,
    partial: bool,
) -> Result<Option<Vec<SweepPoint>>, OutputError> {
    let sweep = points.sweep;
    let files = points.files();
    let places: Vec<_> = (0..sweep.count()).map(|point| sweep.place(point)).collect();
    let mut writer = Writer::create(&SWEEP, points.lock, points.policy.force)?;
    write_axes(&mut writer, sweep)?;
    write_head(&writer, scene, identity)?;
    if partial {
        writer.number("/", "partial", 1_u8)?;
    }
    let goes_on = || !points.session.workers.is_stopped();
    if !stack(&mut writer, &stack::PointFiles { files: &files, places: &places, goes_on: &goes_on })? {
        return Ok(None);
    }
    let has_replicas = scene.replicas > 0;
    let first = files[0].as_deref().filter(|_| has_replicas).map(Compared::read).transpose()?;
    let (mut rows, mut warned) = (Vec::with_capacity(files.len()), Vec::new());
    for (point, file) in files.iter().enumerate() {
        if !goes_on() {
            return Ok(None);
        }
        rows.push(match file {
            Some(file) => {
                if sweep.is_left_dry(point) {
                    add(&mut warned, point, DRY);
                }
                warn(&mut warned, point, file)?;
                match has_replicas {
                    true => compared(file, first.as_ref(), scene, sweep.common_random_numbers)?,
                    false => of_integral(file)?,
                }
            }
            None => SweepPoint::ABSENT,
        });
    }
    if points.shard.is_some() {
        write_states(&writer, points, identity, &files)?;
    }
    writer.text("/", "warnings", &joined(sweep, &warned))?;
    if has_replicas {
        write_comparison(&writer, &rows)?;
    }
    writer.finish()?;
    Ok(Some(rows))
}

/// Writes what all points have in common.
fn write_head(writer: &Writer<'_>, scene: &Scene, identity: &Identity) -> Result<(), OutputError> {
    write_about(writer, scene, &identity.scene)?;
    write_model(writer, scene, identity.seed)?;
    if let Some(stopping) = &scene.stopping {
        writer.number("/", "min_replicas", stopping.min_replicas)?;
        writer.number("/", "max_replicas", stopping.max_replicas)?;
    }
    write_limits(writer)
}

/// Writes the differences of the points to the first, and the verdict on all of them.
fn write_comparison(writer: &Writer<'_>, rows: &[SweepPoint]) -> Result<(), OutputError> {
    write_differences(writer, rows)?;
    let p_values: Vec<f64> = rows.iter().map(|row| row.p_value).collect();
    writer.number("/ensemble", "interval_level", LEVEL)?;
    writer.number("/validation", "significance", SIGNIFICANCE)?;
    writer.text("/validation", "correction", "Holm")?;
    writer.text("/validation", "overall_verdict", overall(&p_values).name())
}

/// Writes the states of the points of a shard.
fn write_states(
    writer: &Writer<'_>,
    points: &Points<'_>,
    identity: &Identity,
    files: &[Option<PathBuf>],
) -> Result<(), OutputError> {
    let there = || files.iter().enumerate().filter_map(|(point, file)| Some((point, file.as_deref()?)));
    let head = Head {
        identity: identity.clone(),
        scene_file: scene_file(points.source),
        points: there().map(|(point, _)| point as u64).collect(),
    };
    write_restart(writer, &head, there().map(|(_, file)| state_in(file)))
}

/// The finding of points whose law knows no liquid, of a scene that has one.
pub(crate) const DRY: &str = "knows no liquid: computed as dry";

/// Findings of the points, and the points that have them.
type Warned = Vec<(String, Vec<usize>)>;

/// Adds what a point warns of.
fn warn(warned: &mut Warned, point: usize, file: &Path) -> Result<(), OutputError> {
    let reader = Reader::open(file, &[&RUN])?;
    for finding in reader.optional_text("/", "warnings")?.unwrap_or_default().lines() {
        add(warned, point, finding);
    }
    Ok(())
}

fn add(warned: &mut Warned, point: usize, finding: &str) {
    match warned.iter_mut().find(|(known, _)| known == finding) {
        Some((_, points)) => points.push(point),
        None => warned.push((finding.to_owned(), vec![point])),
    }
}

/// Warnings of the points, a line each, with the points that give them.
fn joined(sweep: &Sweep, warned: &Warned) -> String {
    let line = |(finding, points): &(String, Vec<usize>)| match points.len() {
        1 => format!("{finding} (at {})", sweep.assignments(points[0])),
        count if count == sweep.count() => format!("{finding} (at all points)"),
        count => {
            format!(
                "{finding} (at {count} of {} points, first at {})",
                sweep.count(),
                sweep.assignments(points[0])
            )
        }
    };
    warned.iter().map(line).collect::<Vec<String>>().join("\n")
}

/// Writes the dimensions of the points: one for each key, or one for all.
fn write_axes(writer: &mut Writer<'_>, sweep: &Sweep) -> Result<(), OutputError> {
    let keys: Vec<&str> = sweep.axes.iter().map(|axis| axis.key.name).collect();
    writer.text("/", "sweep_keys", &keys.join(", "))?;
    writer.text("/", "sweep_mode", sweep.mode.name())?;
    writer.number("/", "points", sweep.count() as u64)?;
    writer.number("/", "common_random_numbers", u8::from(sweep.common_random_numbers))?;
    if sweep.mode == Mode::Zip {
        let points: Vec<u64> = (0..sweep.count() as u64).collect();
        writer.point_scale("point", "1", &SWEEP.variable("/point").long_name, &points);
    }
    for axis in &sweep.axes {
        let (key, values) = (axis.key, &axis.values);
        let units = key.dimension.map_or("1", |dimension| dimension.file_units());
        match sweep.mode {
            Mode::Grid => writer.point_scale(key.name, units, &key.meaning(), values),
            Mode::Zip => writer.point_coordinate(key.name, units, &key.meaning(), values),
        }
    }
    Ok(())
}

/// The numbers of a point that are compared.
struct Compared {
    /// The values of each of the [`SCALARS`] for all replicas.
    values: [Vec<f64>; 4],
    /// The most that rounding may make of each: of a force its share of F_s + P, of a secant that share at
    /// both ends of the span, and of a separation a few units in its last place.
    rounding: [f64; 4],
}

impl Compared {
    fn read(file: &Path) -> Result<Self, OutputError> {
        let reader = Reader::open(file, &[&RUN])?;
        let read = |path: &str| reader.values::<f64>(path);
        let span: f64 = reader.number("/", "stiffness_span")?;
        let is_loop = reader.optional_text("/", "history")?.as_deref() == Some("loop");
        let mut values: [Vec<f64>; 4] = Default::default();
        for (values, scalar) in values.iter_mut().zip(SCALARS) {
            *values = read(&format!("/replicas/{}", scalar.name))?;
        }
        let way = if is_loop { "retraction_" } else { "" };
        let curve = |name: &str| read(&format!("/ensemble/{way}{name}_mean"));
        let [adhesion, contact, external] = ["adhesion_force", "contact_force", "external_force"].map(curve);
        let (adhesion, contact, external) = (adhesion?, contact?, external?);
        let separations = read(RUN.coordinate("separation"))?;
        // The load of the mean surface at or before the nearest place of any replica: it falls with the
        // separation.
        let load = |nearest: f64| {
            let before = separations.partition_point(|h| *h <= nearest).saturating_sub(1);
            let beside = (contact[before] - adhesion[before] - external[before]).abs();
            adhesion[before] + contact[before] + beside
        };
        let nearest = |places: &[f64]| places.iter().copied().fold(f64::INFINITY, f64::min);
        let of_place = 4.0 * f64::EPSILON * separations.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
        let of_force = SUM_ROUNDING * load(nearest(&values[1]));
        let of_secant = 2.0 * SUM_ROUNDING * load(nearest(&values[3]) - 0.5 * span) / span;
        Ok(Self { values, rounding: [of_force, of_place, of_secant, of_place] })
    }

    /// The number of replicas.
    fn replicas(&self) -> u64 {
        self.values[0].len() as u64
    }

    /// The difference of each scalar to the scalar of the first point.
    fn differences(&self, first: &Self, group: usize, common: bool) -> [Difference; 4] {
        std::array::from_fn(|i| {
            let rounding = first.rounding[i] + self.rounding[i];
            Difference::new(&first.values[i], &self.values[i], group, common, rounding)
        })
    }
}

/// The row of a point of the integral alone.
fn of_integral(file: &Path) -> Result<SweepPoint, OutputError> {
    let reader = Reader::open(file, &[&RUN])?;
    Ok(SweepPoint {
        integral: reader.number("/integral", "pull_off_force")?,
        independence: Some(read_independence(&reader)?),
        ..SweepPoint::ABSENT
    })
}

/// The row of a point, with differences to the replicas of the first. Only where all replicas of both are
/// there they are compared; with targets, which end each point by itself, the replicas that both have.
fn compared(
    file: &Path,
    first: Option<&Compared>,
    scene: &Scene,
    common: bool,
) -> Result<SweepPoint, OutputError> {
    let own = Compared::read(file)?;
    let reader = Reader::open(file, &[&RUN])?;
    let group = scene.sampling.group() as usize;
    let are_whole = |point: &Compared| scene.stopping.is_some() || point.replicas() == scene.replicas;
    let first = first.filter(|first| are_whole(first) && are_whole(&own));
    Ok(SweepPoint {
        pull_offs: pull_offs(&reader)?,
        differences: first.map_or([Difference::UNKNOWN; 4], |first| own.differences(first, group, common)),
        p_value: reader.number("/validation", "p_value")?,
        ..of_integral(file)?
    })
}

/// The pull-offs of a point: of its whole history, or after each preload.
fn pull_offs(reader: &Reader) -> Result<Vec<PointPullOff>, OutputError> {
    let is_pressed = reader.has("/instability/pull_off_after_preload_mean");
    let (after, [mean, error], pull_off) = match is_pressed {
        true => ("_after_preload", ["mean", "standard_error"], "/instability/pull_off_after_preload"),
        false => ("", ["controlled_mean", "controlled_standard_error"], "/ensemble/scalar"),
    };
    let of = |path: String| if reader.has(&path) { reader.values::<f64>(&path).map(Some) } else { Ok(None) };
    let of_pull_off = |name: &str| reader.values::<f64>(&format!("{pull_off}_{name}"));
    let (means, errors) = (of_pull_off(mean)?, of_pull_off(error)?);
    let [share, low, high] =
        ["", "_low", "_high"].map(|end| of(format!("/device/stuck_probability{end}{after}")));
    let stuck = share?.zip(low?).zip(high?);
    let preloads = if is_pressed { Some(reader.values::<f64>("/instability/preload")?) } else { None };
    let [force_range, stuck_range] =
        [if is_pressed { "pull_off" } else { "pull_off_force" }, "stuck_probability"]
            .map(|name| of(format!("/model_range/{name}{after}")));
    let count = preloads.as_ref().map_or(1, Vec::len);
    let [force_range, stuck_range] = [force_range?, stuck_range?]
        .map(|of_contacts| of_contacts.map(|values| ends(&values, values.len() / PlasticContact::ALL.len())));
    let range_at = |ends: &Option<[Vec<f64>; 2]>, i: usize| {
        ends.as_ref().map(|[low, high]| [low[i], high[i]]).filter(|[low, _]| !low.is_nan())
    };
    let most_differing =
        if is_pressed { f64::NAN } else { reader.values::<f64>("/ensemble/scalar_most_differing")?[0] };
    let pull_off = |i: usize| PointPullOff {
        preload: preloads.as_ref().map(|preloads| preloads[i]),
        force: [means[i], errors[i]],
        most_differing,
        stuck_probability: stuck.as_ref().map(|((share, low), high)| [share[i], low[i], high[i]]),
        model_range: range_at(&force_range, i),
        stuck_model_range: range_at(&stuck_range, i),
    };
    let is_preload = |own: &PointPullOff| own.preload.is_none_or(f64::is_finite);
    Ok((0..count).map(pull_off).filter(is_preload).collect())
}

fn write_differences(writer: &Writer<'_>, rows: &[SweepPoint]) -> Result<(), OutputError> {
    for (i, scalar) in SCALARS.into_iter().enumerate() {
        let write = |name: &str, of: fn(&Difference) -> f64| {
            let values: Vec<f64> = rows.iter().map(|row| of(&row.differences[i])).collect();
            writer.over_points(&format!("/differences/{}_{name}", scalar.name), &values)
        };
        write("mean", |difference| difference.mean)?;
        write("standard_error", |difference| difference.standard_error)?;
        write("variance_ratio", |difference| difference.variance_ratio)?;
    }
    Ok(())
}
