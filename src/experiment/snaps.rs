//! Snaps of the replicas of a run: counts, probabilities, pull-off after preloads.

use super::results::Results;
use super::sampling::loading;
use crate::engine::Loading;
use crate::engine::instability::{Snap, Turn};
use crate::math::moments::Moments;
use crate::math::proportion::wilson_interval;
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;

/// One of the numbers that are kept of every replica.
struct Column<'a> {
    snaps: &'a [f64],
    length: usize,
    place: usize,
}

impl Column<'_> {
    /// The values, replica by replica.
    fn values(&self) -> impl Iterator<Item = f64> {
        self.snaps.chunks_exact(self.length).map(|numbers| numbers[self.place])
    }
}

/// The snaps of all replicas.
pub(crate) struct Snaps<'a> {
    snaps: &'a [f64],
    pub loading: Loading<'a>,
}

/// Replicas of which it is known whether they snap: how many, how many do, and how many of these nothing
/// stops.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    pub known: u64,
    pub snap: u64,
    pub unstopped: u64,
}

impl Counts {
    /// The share that snaps.
    pub fn share(self) -> f64 {
        self.snap as f64 / self.known as f64
    }

    /// The 95 % interval of its probability.
    pub fn interval(self) -> (f64, f64) {
        wilson_interval(self.snap, self.known)
    }
}

impl<'a> Snaps<'a> {
    pub fn of(results: &'a Results) -> Self {
        Self { snaps: &results.ensemble.snaps, loading: loading(&results.scene) }
    }

    fn column(&self, place: usize) -> Column<'a> {
        Column { snaps: self.snaps, length: self.loading.length(), place }
    }

    /// The place of a snap on approach.
    pub fn place_in(&self, stiffness: usize) -> usize {
        Snap::LENGTH * stiffness
    }

    /// The place of a retraction.
    fn place_of_turn(&self, retraction: usize) -> usize {
        let one = Turn::LENGTH + Snap::LENGTH * self.loading.stiffness.len();
        Snap::LENGTH * self.loading.snaps_in() + one * retraction
    }

    /// The place of a snap on retraction.
    pub fn place_off(&self, retraction: usize, stiffness: usize) -> usize {
        self.place_of_turn(retraction) + Turn::LENGTH + Snap::LENGTH * stiffness
    }

    pub fn counts(&self, place: usize) -> Counts {
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
        let replicas = self.snaps.chunks_exact(self.loading.length());
        replicas.flat_map(|numbers| places.iter().map(move |place| numbers[place + offset])).collect()
    }

    fn places_in(&self) -> Vec<usize> {
        (0..self.loading.snaps_in()).map(|stiffness| self.place_in(stiffness)).collect()
    }

    pub fn places_of_turns(&self) -> Vec<usize> {
        (0..self.loading.retractions()).map(|retraction| self.place_of_turn(retraction)).collect()
    }

    fn places_off(&self) -> Vec<usize> {
        let stiffnesses = self.loading.stiffness.len();
        let of = |retraction| (0..stiffnesses).map(move |stiffness| self.place_off(retraction, stiffness));
        (0..self.loading.retractions()).flat_map(of).collect()
    }

    /// Mean and standard deviation of the pull-off after a turn, over the replicas that turn, and how many
    /// these are.
    pub fn pull_off(&self, turn: usize) -> (f64, f64, u64) {
        let moments = Moments::of(self.column(turn + 1).values().filter(|force| !force.is_nan()));
        let mean = if moments.count() == 0 { f64::NAN } else { moments.mean()[0] };
        (mean, moments.std()[0], moments.count())
    }
}

/// Writes the snaps, if they were asked for.
pub(crate) fn write_instability(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let snaps = Snaps::of(results);
    let loading = snaps.loading;
    if loading.length() == 0 {
        return Ok(());
    }
    writer.group("instability")?;
    writer.number("/instability", "smallest_snap", loading.smallest_snap)?;
    writer.scale(Dimension::Stiffness, loading.stiffness);
    if loading.ways.0 {
        write_snaps(writer, "in", &snaps, &snaps.places_in())?;
    }
    if loading.retractions() > 0 {
        let preload = if loading.preload.is_empty() { &[f64::NAN] } else { loading.preload };
        writer.scale(Dimension::Preload, preload);
        write_turns(writer, &snaps)?;
        let places = snaps.places_off();
        write_snaps(writer, "off", &snaps, &places)?;
        let unstopped: Vec<u64> = places.iter().map(|place| snaps.counts(*place).unstopped).collect();
        writer.dataset("/instability/fly_off_count", &unstopped)?;
    }
    Ok(())
}

fn write_snaps(
    writer: &Writer<'_>,
    name: &str,
    snaps: &Snaps<'_>,
    places: &[usize],
) -> Result<(), OutputError> {
    for (offset, number) in ["", "_separation", "_distance"].into_iter().enumerate() {
        writer.dataset(&format!("/replicas/snap_{name}{number}"), &snaps.table(places, offset))?;
    }
    let counts: Vec<Counts> = places.iter().map(|place| snaps.counts(*place)).collect();
    let all = |of: fn(&Counts) -> f64| counts.iter().map(of).collect::<Vec<f64>>();
    let group = format!("/instability/snap_{name}");
    writer
        .dataset(&format!("{group}_count"), &counts.iter().map(|counts| counts.snap).collect::<Vec<u64>>())?;
    writer.dataset(&format!("{group}_probability"), &all(|counts| counts.share()))?;
    writer.dataset(&format!("{group}_probability_low"), &all(|counts| counts.interval().0))?;
    writer.dataset(&format!("{group}_probability_high"), &all(|counts| counts.interval().1))
}

fn write_turns(writer: &Writer<'_>, snaps: &Snaps<'_>) -> Result<(), OutputError> {
    let turns = snaps.places_of_turns();
    let names = ["preload_separation", "pull_off_after_preload", "pull_off_after_preload_separation"];
    for (offset, name) in names.into_iter().enumerate() {
        writer.dataset(&format!("/replicas/{name}"), &snaps.table(&turns, offset))?;
    }
    let pull_off: Vec<(f64, f64, u64)> = turns.iter().map(|turn| snaps.pull_off(*turn)).collect();
    writer.dataset(
        "/instability/preload_reached_count",
        &pull_off.iter().map(|(.., count)| *count).collect::<Vec<u64>>(),
    )?;
    let mean: Vec<f64> = pull_off.iter().map(|(mean, ..)| *mean).collect();
    writer.dataset("/instability/pull_off_after_preload_mean", &mean)?;
    let std: Vec<f64> = pull_off.iter().map(|(_, std, _)| *std).collect();
    writer.dataset("/instability/pull_off_after_preload_std", &std)
}
