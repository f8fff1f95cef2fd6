//! Snaps of the replicas of a run, for the file and for the summary.

use super::format::{percent, row, si};
use super::results::Results;
use super::sampling::holding;
use crate::engine::Holding;
use crate::engine::instability::{Snap, Turn};
use crate::math::moments::Moments;
use crate::math::proportion::wilson_interval;
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;
use crate::scene::Scene;

/// Most stiffnesses of which the summary tells.
const SHOWN: usize = 8;

/// One of the numbers that are kept of every replica.
struct Column<'a> {
    snaps: &'a [f64],
    length: usize,
    place: usize,
}

impl Column<'_> {
    /// Its values, replica by replica.
    fn values(&self) -> impl Iterator<Item = f64> {
        self.snaps.chunks_exact(self.length).map(|numbers| numbers[self.place])
    }
}

/// The snaps of all replicas.
struct Snaps<'a> {
    snaps: &'a [f64],
    holding: Holding<'a>,
}

/// Replicas of which it is known whether they snap: how many, how many do, and how many of these nothing stops.
#[derive(Clone, Copy)]
struct Counts {
    known: u64,
    snap: u64,
    unstopped: u64,
}

impl Counts {
    /// The share that snaps.
    fn share(self) -> f64 {
        self.snap as f64 / self.known as f64
    }

    /// The 95 % interval of its probability.
    fn interval(self) -> (f64, f64) {
        wilson_interval(self.snap, self.known)
    }
}

impl<'a> Snaps<'a> {
    fn of(results: &'a Results) -> Self {
        Self { snaps: &results.ensemble.snaps, holding: holding(&results.scene) }
    }

    fn column(&self, place: usize) -> Column<'a> {
        Column { snaps: self.snaps, length: self.holding.length(), place }
    }

    /// The place of a snap on approach.
    fn place_in(&self, stiffness: usize) -> usize {
        Snap::LENGTH * stiffness
    }

    /// The place of a retraction.
    fn place_of_turn(&self, retraction: usize) -> usize {
        let one = Turn::LENGTH + Snap::LENGTH * self.holding.stiffness.len();
        Snap::LENGTH * self.holding.snaps_in() + one * retraction
    }

    /// The place of a snap on retraction.
    fn place_off(&self, retraction: usize, stiffness: usize) -> usize {
        self.place_of_turn(retraction) + Turn::LENGTH + Snap::LENGTH * stiffness
    }

    fn counts(&self, place: usize) -> Counts {
        let (is, distance) = (self.column(place), self.column(place + 2));
        let mut counts = Counts { known: 0, snap: 0, unstopped: 0 };
        for (is, distance) in is.values().zip(distance.values()) {
            counts.known += u64::from(!is.is_nan());
            counts.snap += u64::from(is == 1.0);
            counts.unstopped += u64::from(is == 1.0 && distance.is_nan());
        }
        counts
    }

    /// Number `offset` behind each of the places, for every replica.
    fn table(&self, places: &[usize], offset: usize) -> Vec<f64> {
        let replicas = self.snaps.chunks_exact(self.holding.length());
        replicas.flat_map(|numbers| places.iter().map(move |place| numbers[place + offset])).collect()
    }

    fn places_in(&self) -> Vec<usize> {
        (0..self.holding.snaps_in()).map(|stiffness| self.place_in(stiffness)).collect()
    }

    fn places_of_turns(&self) -> Vec<usize> {
        (0..self.holding.retractions()).map(|retraction| self.place_of_turn(retraction)).collect()
    }

    fn places_off(&self) -> Vec<usize> {
        let stiffnesses = self.holding.stiffness.len();
        let of = |retraction| (0..stiffnesses).map(move |stiffness| self.place_off(retraction, stiffness));
        (0..self.holding.retractions()).flat_map(of).collect()
    }

    /// Mean and standard deviation of the pull-off after a turn, over the replicas that turn, and how many these are.
    fn pull_off(&self, turn: usize) -> (f64, f64, u64) {
        let mut moments = Moments::new(1);
        let forces = self.column(turn + 1);
        forces.values().filter(|force| !force.is_nan()).for_each(|force| moments.push(&[force]));
        let mean = if moments.count() == 0 { f64::NAN } else { moments.mean()[0] };
        (mean, moments.std()[0], moments.count())
    }
}

/// Writes the snaps, if they were asked for.
pub(super) fn write_instability(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let snaps = Snaps::of(results);
    let holding = snaps.holding;
    if holding.length() == 0 {
        return Ok(());
    }
    writer.group("instability")?;
    writer.number("/instability", "smallest_snap", holding.smallest_snap)?;
    writer.scale(Dimension::Stiffness, holding.stiffness)?;
    if holding.ways.0 {
        write_snaps(writer, "in", &snaps, &snaps.places_in())?;
    }
    if holding.retractions() > 0 {
        let preload = if holding.preload.is_empty() { &[f64::NAN] } else { holding.preload };
        writer.scale(Dimension::Preload, preload)?;
        write_turns(writer, &snaps)?;
        let places = snaps.places_off();
        write_snaps(writer, "off", &snaps, &places)?;
        let unstopped: Vec<u64> = places.iter().map(|place| snaps.counts(*place).unstopped).collect();
        writer.dataset("/instability/fly_off_count", &unstopped)?;
    }
    Ok(())
}

fn write_snaps(writer: &Writer<'_>, name: &str, snaps: &Snaps<'_>, places: &[usize]) -> Result<(), OutputError> {
    for (offset, number) in ["", "_separation", "_distance"].into_iter().enumerate() {
        writer.dataset(&format!("/replicas/snap_{name}{number}"), &snaps.table(places, offset))?;
    }
    let counts: Vec<Counts> = places.iter().map(|place| snaps.counts(*place)).collect();
    let all = |of: fn(&Counts) -> f64| counts.iter().map(of).collect::<Vec<f64>>();
    let group = format!("/instability/snap_{name}");
    writer.dataset(&format!("{group}_count"), &counts.iter().map(|counts| counts.snap).collect::<Vec<u64>>())?;
    writer.dataset(&format!("{group}_probability"), &all(|counts| counts.share()))?;
    writer.dataset(&format!("{group}_probability_low"), &all(|counts| counts.interval().0))?;
    writer.dataset(&format!("{group}_probability_high"), &all(|counts| counts.interval().1))
}

fn write_turns(writer: &Writer<'_>, snaps: &Snaps<'_>) -> Result<(), OutputError> {
    let turns = snaps.places_of_turns();
    let names = ["turn_separation", "turned_pull_off_force", "turned_pull_off_separation"];
    for (offset, name) in names.into_iter().enumerate() {
        writer.dataset(&format!("/replicas/{name}"), &snaps.table(&turns, offset))?;
    }
    let pull_off: Vec<(f64, f64, u64)> = turns.iter().map(|turn| snaps.pull_off(*turn)).collect();
    writer.dataset("/instability/turned_count", &pull_off.iter().map(|(.., count)| *count).collect::<Vec<u64>>())?;
    let mean: Vec<f64> = pull_off.iter().map(|(mean, ..)| *mean).collect();
    writer.dataset("/instability/turned_pull_off_force_mean", &mean)?;
    let std: Vec<f64> = pull_off.iter().map(|(_, std, _)| *std).collect();
    writer.dataset("/instability/turned_pull_off_force_std", &std)
}

/// Rows of the summary: how often surfaces snap in, and after each turn how hard they are pulled off and how often they snap off.
pub(super) fn instability(results: &Results) -> String {
    let snaps = Snaps::of(results);
    let holding = snaps.holding;
    if holding.length() == 0 {
        return String::new();
    }
    let label = |line: usize, label: &str| if line == 0 { label.to_owned() } else { String::new() };
    let mut text = String::new();
    let shown = shown(holding.stiffness.len());
    for (line, &i) in shown.iter().enumerate().filter(|_| holding.ways.0) {
        let (counts, stiffness) = (snaps.counts(snaps.place_in(i)), stiffness_text(holding.stiffness[i]));
        let replicas = results.scene.replicas;
        text += &row(&label(line, "snap-in"), &held_by(counts, &stiffness, replicas, "last"));
    }
    for (p, turn) in snaps.places_of_turns().into_iter().enumerate() {
        text += &row(&label(p, "turn"), &turned(&snaps, p, turn, results.scene.replicas));
        let taken = snaps.pull_off(turn).2;
        for (line, &i) in shown.iter().enumerate().filter(|_| taken > 0) {
            let counts = snaps.counts(snaps.place_off(p, i));
            let stiffness = stiffness_text(holding.stiffness[i]);
            text += &row(&label(line, "snap-off"), &held_by(counts, &stiffness, taken, "first"));
        }
    }
    if holding.stiffness.len() > shown.len() {
        text +=
            &row("", &format!("{} of {} stiffnesses; all are in /instability", shown.len(), holding.stiffness.len()));
    }
    text
}

/// Indices of so many stiffnesses, spread over all, that the summary tells of.
fn shown(all: usize) -> Vec<usize> {
    let count = all.min(SHOWN);
    (0..count).map(|i| i * (all - 1) / (count - 1).max(1)).collect()
}

/// Where the replicas turn back, and what pulls them off.
fn turned(snaps: &Snaps<'_>, retraction: usize, turn: usize, replicas: u64) -> String {
    let (mean, std, count) = snaps.pull_off(turn);
    let place = match snaps.holding.preload.get(retraction) {
        Some(preload) => format!("at {}, which {count} of {replicas} replicas reach", si(*preload, "N")),
        None => "at the smallest separation".to_owned(),
    };
    if count == 0 {
        return place;
    }
    let scatter = if std.is_finite() { format!(", scatter {}", percent(std / mean.abs())) } else { String::new() };
    format!("{place}; pull-off {}{scatter}", si(mean, "N"))
}

/// How many of the replicas that took a way snap, held by a stiffness. One that is unstable where the separations begin, the first or the
/// last of them, would have snapped beyond.
fn held_by(counts: Counts, stiffness: &str, taken: u64, begin: &str) -> String {
    let unknown = taken - counts.known;
    if counts.known == 0 {
        return format!("not known held by {stiffness}: all are unstable at the {begin} separation");
    }
    let (low, high) = counts.interval();
    let share = format!("{} of replicas (95 %: {} to {})", percent(counts.share()), percent(low), percent(high));
    let flies = if counts.unstopped > 0 { format!(", {} fly off", counts.unstopped) } else { String::new() };
    let left_out = match unknown {
        0 => String::new(),
        _ => format!(", but for {unknown} that are unstable at the {begin} separation"),
    };
    format!("{share} held by {stiffness}{flies}{left_out}")
}

/// A stiffness, or load control.
fn stiffness_text(stiffness: f64) -> String {
    if stiffness == 0.0 { "a constant load".to_owned() } else { si(stiffness, "N/m") }
}

/// What holds the surfaces of a scene, for `check` and the heading of a summary.
pub(super) fn held(scene: &Scene) -> String {
    let holding = holding(scene);
    if holding.length() == 0 {
        return String::new();
    }
    let list = |values: &[f64], text: &dyn Fn(f64) -> String| match values {
        [] => String::new(),
        [only] => text(*only),
        [first, .., last] => format!("{} values from {} to {}", values.len(), text(*first), text(*last)),
    };
    let mut text = row("held by", &list(holding.stiffness, &stiffness_text));
    if !holding.preload.is_empty() {
        text += &row("preload", &list(holding.preload, &|preload| si(preload, "N")));
    }
    if holding.smallest_snap > 0.0 {
        text += &row("snaps", &format!("of at least {}", si(holding.smallest_snap, "m")));
    }
    text
}
