//! How often surfaces snap.

use super::checked::{Checked, ROUNDING, largest};
use crate::math::moments::Moments;
use crate::math::proportion::wilson_interval;
use crate::output::OutputError;

impl Checked<'_> {
    /// How often surfaces snap.
    pub fn snaps(&mut self) -> Result<(), OutputError> {
        for name in ["in", "off"] {
            if !self.has(&format!("/replicas/snap_{name}")) {
                continue;
            }
            self.each_snap(name)?;
            self.softer(name)?;
            let snap = self.values(&format!("/replicas/snap_{name}"))?;
            let distance = self.values(&format!("/replicas/snap_{name}_distance"))?;
            let places = snap.len() / (self.replicas as usize).max(1);
            let column = |place: usize| snap.iter().zip(&distance).skip(place).step_by(places.max(1));
            let count = |does: &dyn Fn(f64, f64) -> bool| -> Vec<f64> {
                (0..places)
                    .map(|place| {
                        column(place).filter(|(snap, distance)| does(**snap, **distance)).count() as f64
                    })
                    .collect()
            };
            let (taken, snaps) = (count(&|snap, _| !snap.is_nan()), count(&|snap, _| snap == 1.0));
            let interval = |i: usize| wilson_interval(snaps[i] as u64, taken[i] as u64);
            let of = |f: &dyn Fn(usize) -> f64| (0..places).map(f).collect::<Vec<f64>>();
            let mut expected = vec![
                (format!("snap_{name}_count"), snaps.clone()),
                (format!("snap_{name}_probability"), of(&|i| snaps[i] / taken[i])),
                (format!("snap_{name}_probability_low"), of(&|i| interval(i).0)),
                (format!("snap_{name}_probability_high"), of(&|i| interval(i).1)),
            ];
            if name == "off" {
                expected.push((
                    "fly_off_count".to_owned(),
                    count(&|snap, distance| snap == 1.0 && distance.is_nan()),
                ));
            }
            for (path, expected) in expected {
                let path = format!("/instability/{path}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &expected, |_| 1e-12, "/replicas");
            }
        }
        if self.has("/replicas/pull_off_after_preload") { self.turns() } else { Ok(()) }
    }

    /// A snap begins somewhere, and ends within the separations or beyond them; without one there is nothing.
    fn each_snap(&mut self, name: &str) -> Result<(), OutputError> {
        let path = |of: &str| format!("/replicas/snap_{name}{of}");
        let [snap, separation, distance] = ["", "_separation", "_distance"].map(|of| self.values(&path(of)));
        let (snap, separation, distance, h) = (snap?, separation?, distance?, self.coordinate("separation")?);
        let ends = (h.first().copied().unwrap_or(f64::NAN), h.last().copied().unwrap_or(f64::NAN));
        let slack = ROUNDING * ends.0.abs().max(ends.1.abs());
        let landing =
            |i: usize| if name == "in" { separation[i] - distance[i] } else { separation[i] + distance[i] };
        for i in 0..snap.len().min(separation.len()).min(distance.len()) {
            if separation[i].is_nan() == (snap[i] == 1.0) {
                self.say_at(&path("_separation"), i, separation[i], &format!("{} has {}", path(""), snap[i]));
                break;
            }
            let lands = landing(i) >= ends.0 - slack && landing(i) <= ends.1 + slack;
            if !(distance[i].is_nan() || snap[i] == 1.0 && lands) {
                let expected = format!("a snap from {:e} within the separations is expected", separation[i]);
                self.say_at(&path("_distance"), i, distance[i], &expected);
                break;
            }
        }
        Ok(())
    }

    /// A replica that snaps held by a spring snaps held by a softer one too.
    fn softer(&mut self, name: &str) -> Result<(), OutputError> {
        let path = format!("/replicas/snap_{name}");
        let (snap, stiffness) = (self.values(&path)?, self.coordinate("stiffness")?);
        let n = stiffness.len().max(1);
        for (row, own) in snap.chunks_exact(n).enumerate() {
            let is_softer =
                |i: &usize| own[*i] == 0.0 && (0..n).any(|j| stiffness[j] > stiffness[*i] && own[j] == 1.0);
            if let Some(i) = (0..n).find(is_softer) {
                let expected = format!("held by more than {:e} N/m the surface snaps", stiffness[i]);
                self.say_at(&path, row * n + i, own[i], &expected);
                break;
            }
        }
        Ok(())
    }

    /// A surface reaches a smaller preload before a larger one, and without any it turns at the smallest
    /// separation.
    fn preloads(&mut self, turn: &[f64], h: &[f64]) -> Result<(), OutputError> {
        const PATH: &str = "/replicas/preload_separation";
        let preload = self.coordinate("preload")?;
        let n = preload.len().max(1);
        if let Some(i) = preload.iter().position(|preload| preload.is_nan() && n > 1) {
            self.say_at(
                self.reader.coordinate("preload"),
                i,
                f64::NAN,
                "a force is expected as for the others",
            );
        }
        for (row, own) in turn.chunks_exact(n).enumerate() {
            let is_late = |i: &usize| {
                let is_before = |j: usize| {
                    preload[j] > preload[*i]
                        && (own[j] > own[*i] || own[i.to_owned()].is_nan() && !own[j].is_nan())
                };
                (0..n).any(is_before) || preload[*i].is_nan() && h.first() != Some(&own[*i])
            };
            if let Some(i) = (0..n).find(is_late) {
                self.say_at(PATH, row * n + i, own[i], &format!("the preload is {:e}", preload[i]));
                break;
            }
        }
        Ok(())
    }

    /// Where surfaces turn back, and what pulls them off behind.
    fn turns(&mut self) -> Result<(), OutputError> {
        const FORCE: &str = "/replicas/pull_off_after_preload";
        const PLACE: &str = "/replicas/pull_off_after_preload_separation";
        let [turn, force, place] =
            ["/replicas/preload_separation", FORCE, PLACE].map(|path| self.values(path));
        let (turn, forces, place) = (turn?, force?, place?);
        let h = self.coordinate("separation")?;
        self.preloads(&turn, &h)?;
        let slack = ROUNDING * largest(&h);
        for i in 0..turn.len().min(forces.len()).min(place.len()) {
            let is_known = !turn[i].is_nan();
            if forces[i].is_nan() == is_known {
                self.say_at(FORCE, i, forces[i], &format!("the turn is at {:e}", turn[i]));
                break;
            }
            if place[i].is_nan() == is_known || place[i] < turn[i] - slack {
                let expected = format!("a separation behind the turn at {:e} is expected", turn[i]);
                self.say_at(PLACE, i, place[i], &expected);
                break;
            }
        }
        let turns = (forces.len() / (self.replicas as usize).max(1)).max(1);
        let mut expected: [Vec<f64>; 3] = Default::default();
        for turn in 0..turns {
            let own = forces.iter().skip(turn).step_by(turns).filter(|force| !force.is_nan());
            let moments = Moments::of(own.copied());
            let mean = if moments.count() == 0 { f64::NAN } else { moments.mean()[0] };
            let values = [moments.count() as f64, mean, moments.std()[0]];
            expected.iter_mut().zip(values).for_each(|(expected, value)| expected.push(value));
        }
        let size: Vec<f64> =
            expected[1].iter().map(|mean| if mean.is_nan() { 0.0 } else { mean.abs() }).collect();
        for (name, expected) in
            ["preload_reached_count", "pull_off_after_preload_mean", "pull_off_after_preload_std"]
                .iter()
                .zip(&expected)
        {
            let path = format!("/instability/{name}");
            let found = self.values(&path)?;
            self.compare(&path, &found, expected, |i| ROUNDING * size[i], "/replicas");
        }
        Ok(())
    }
}
