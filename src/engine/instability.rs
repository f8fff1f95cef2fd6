//! Snaps of a surface that is held by a spring.
//!
//! # Formula
//! The external force F(h) bends what holds the surface: with a stiffness k its base is at H = h − F(h)/k,
//! above the surface where F pulls it down. The base is moved steadily, and the surface follows for as long
//! as H(h) is monotone. Where dF/dh exceeds k it is not: at constant H the surface snaps to the next
//! separation on its way that has this H. Load control is the limit k → 0, at constant F.
//!
//! Both are the same in kh − F, which is kH, so that is what is followed.
//!
//! # Validity
//! Quasistatic; the surface comes to rest at the first equilibrium. Curves are lines between their samples: a
//! jump of one asperity has the slope that the samples give it, so how many of the smallest snaps are seen
//! depends on these; of those over several samples it does not.

use crate::math::interpolation::linear;

/// The loading of the surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loading<'a> {
    /// Stiffnesses k, N/m; 0 for load control.
    pub stiffness: &'a [f64],
    /// Largest external forces, N, at which the approach ends and the retraction begins; without one the
    /// approach ends at the smallest separation.
    pub preload: &'a [f64],
    /// The least distance, m, that counts as a snap.
    pub smallest_snap: f64,
    /// Whether the surfaces are brought close, and whether they are pulled back.
    pub ways: (bool, bool),
    /// Separations over which the forces on retraction after each preload are kept; 0 for none.
    pub kept: usize,
}

impl Loading<'_> {
    /// Retractions of a replica.
    pub fn retractions(&self) -> usize {
        let is_asked = !self.stiffness.is_empty() || !self.preload.is_empty();
        if is_asked && self.ways.1 { self.preload.len().max(1) } else { 0 }
    }

    /// Snaps of the approach of a replica.
    pub fn snaps_in(&self) -> usize {
        if self.ways.0 { self.stiffness.len() } else { 0 }
    }

    /// Numbers that are kept of a retraction: [`Turn`], a [`Snap`] for each stiffness, and the forces.
    pub fn of_retraction(&self) -> usize {
        Turn::LENGTH + Snap::LENGTH * self.stiffness.len() + self.kept
    }

    /// Numbers that are kept of a replica: [`Snap`] for each stiffness on approach, then the ones of each
    /// retraction.
    pub fn length(&self) -> usize {
        Snap::LENGTH * self.snaps_in() + self.retractions() * self.of_retraction()
    }
}

/// The largest snap of a surface on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// Whether there is one, 1 or 0; NaN where the surface never came to begin its way, or is unstable where
    /// the separations begin.
    pub occurred: f64,
    /// Separation h where it begins, m; NaN without one.
    pub separation: f64,
    /// Length of the snap, m; NaN without one, and where nothing within the separations stops the surface.
    pub distance: f64,
}

/// The place where the surface turns back, and the force that pulls it off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Separation h, m; NaN where the preload is not reached.
    pub separation: f64,
    /// −min F on retraction, N.
    pub pull_off_force: f64,
    /// Separation h there, m.
    pub pull_off_separation: f64,
}

impl Snap {
    /// The count of its numbers.
    pub const LENGTH: usize = 3;
    /// No snap.
    pub const NONE: Self = Self { occurred: 0.0, separation: f64::NAN, distance: f64::NAN };
    /// A snap on a path that was not taken, or begins beyond the separations.
    pub const UNKNOWN: Self = Self { occurred: f64::NAN, ..Self::NONE };

    /// The numbers as they are kept.
    pub fn numbers(self) -> [f64; Self::LENGTH] {
        [self.occurred, self.separation, self.distance]
    }
}

impl Turn {
    /// The count of its numbers.
    pub const LENGTH: usize = 3;
    /// The turn of a path that was not taken.
    pub const UNKNOWN: Self =
        Self { separation: f64::NAN, pull_off_force: f64::NAN, pull_off_separation: f64::NAN };

    /// The numbers as they are kept.
    pub fn numbers(self) -> [f64; Self::LENGTH] {
        [self.separation, self.pull_off_force, self.pull_off_separation]
    }
}

/// The largest snap on the way through the samples of a curve in their order: separations h, m, and external
/// forces, N. One that nothing stops is the largest; one shorter than `smallest`, m, is none.
pub fn largest_snap(samples: &[(f64, f64)], stiffness: f64, smallest: f64) -> Snap {
    let outward = samples.first().zip(samples.last()).is_some_and(|(first, last)| first.0 < last.0);
    let sign = if outward { 1.0 } else { -1.0 };
    // It has to rise on the way.
    let level = |i: usize| sign * (stiffness * samples[i].0 - samples[i].1);
    let mut largest = Snap::NONE;
    let mut i = 0;
    while i + 1 < samples.len() {
        let next = i + 1;
        if level(next) >= level(i) {
            i = next;
            continue;
        }
        let separation = samples[i].0;
        let Some(beyond) = (next..samples.len()).find(|&j| level(j) > level(i)) else {
            return Snap { occurred: 1.0, separation, distance: f64::NAN };
        };
        let levels = [level(beyond - 1), level(beyond)];
        let stop = linear(&levels, &[samples[beyond - 1].0, samples[beyond].0], level(i));
        let distance = (stop - separation).abs();
        if distance >= smallest && !(distance <= largest.distance) {
            largest = Snap { occurred: 1.0, separation, distance };
        }
        i = beyond;
    }
    largest
}

/// The largest snap on a path through all separations. A surface that snaps from the first of them cannot
/// rest there, so it has snapped before, where the samples do not reach: the range has no say in where a snap
/// begins, and if that one is the largest, none is known.
pub fn largest_snap_of_all(samples: &[(f64, f64)], stiffness: f64, smallest: f64) -> Snap {
    let snap = largest_snap(samples, stiffness, smallest);
    if samples.first().is_some_and(|first| snap.separation == first.0) { Snap::UNKNOWN } else { snap }
}

/// The place where a surface that is brought close first bears a preload, N: the index of the sample before,
/// at rising separations, m, and the separation, m.
pub fn reached(separations: &[f64], external_force: &[f64], preload: f64) -> Option<(usize, f64)> {
    let nearer = external_force.iter().rposition(|force| *force >= preload)?;
    let Some(&further) = external_force.get(nearer + 1) else { return Some((nearer, separations[nearer])) };
    let forces = [further, external_force[nearer]];
    Some((nearer, linear(&forces, &[separations[nearer + 1], separations[nearer]], preload)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F falls from 0 at h = 4 to −2 at 2 and rises to 2 at 0, in straight lines.
    const WELL: [(f64, f64); 5] = [(0.0, 2.0), (1.0, 0.0), (2.0, -2.0), (3.0, -1.0), (4.0, 0.0)];

    fn inward() -> Vec<(f64, f64)> {
        WELL.iter().rev().copied().collect()
    }

    /// Slope 1 beyond the minimum. On approach at k = 1/2 from H = 4: kh − F = 2 is met again at h = 2/5·…:
    /// on the steep side kh − F = h/2 − 2 + 2h, so h = 8/5. On retraction from (2, −2): kh − F = 3 is met at
    /// h = 6 only, beyond the samples.
    #[test]
    fn snaps_are_where_the_slope_exceeds_the_stiffness() {
        let soft = largest_snap(&inward(), 0.5, 0.0);
        assert_eq!((soft.occurred, soft.separation), (1.0, 4.0));
        assert!((soft.distance - (4.0 - 1.6)).abs() < 1e-14, "{soft:?}");
        let off = largest_snap(&WELL, 0.5, 0.0);
        assert!(off.occurred == 1.0 && off.separation == 2.0 && off.distance.is_nan(), "{off:?}");
        for stiff in [1.0, 1.5, 100.0] {
            assert_eq!(largest_snap(&inward(), stiff, 0.0).occurred, 0.0);
            assert_eq!(largest_snap(&WELL, stiff, 0.0).occurred, 0.0);
        }
    }

    /// The well pulls from h = 4 on: it is not known where it began to. On a stiffer spring nothing snaps,
    /// and off the spring it does at 2.
    #[test]
    fn what_is_unstable_where_the_samples_begin_has_begun_before() {
        for soft in [0.0, 0.5] {
            let snap = largest_snap_of_all(&inward(), soft, 0.0);
            assert!(snap.occurred.is_nan() && snap.separation.is_nan() && snap.distance.is_nan(), "{snap:?}");
            assert_eq!(largest_snap_of_all(&WELL, soft, 0.0).separation, 2.0);
        }
        assert_eq!(largest_snap_of_all(&inward(), 1.0, 0.0).occurred, 0.0);
        // A flat beginning is stable, and what lies behind it is known.
        let flat = [&[(5.0, 0.0)][..], &inward()].concat();
        assert_eq!(largest_snap_of_all(&flat, 0.0, 0.0).separation, 4.0);
        // A shorter one at the beginning leaves the largest known.
        let behind = [&[(5.5, 0.5), (5.0, 0.0), (4.5, 0.9)][..], &inward()].concat();
        assert_eq!(largest_snap_of_all(&behind, 0.0, 0.0).separation, 4.5);
    }

    /// At constant force 0 from h = 4 to 1; pulled off at −2, where nothing stops it.
    #[test]
    fn without_stiffness_the_force_is_constant() {
        let dead = largest_snap(&inward(), 0.0, 0.0);
        assert_eq!((dead.separation, dead.distance), (4.0, 3.0));
        let off = largest_snap(&WELL, 0.0, 0.0);
        assert!(off.separation == 2.0 && off.distance.is_nan());
    }

    /// Two wells at k = 0: from (1, −1) to F = −1 at h = 7/2, on to (4, −3/2), and from there to h = 11/2.
    #[test]
    fn the_largest_of_several_snaps_is_reported() {
        let stairs =
            [(0.0, 0.0), (1.0, -1.0), (2.0, -0.5), (3.0, -0.5), (4.0, -1.5), (5.0, -1.0), (6.0, -2.0)];
        let snap = largest_snap(&stairs, 0.0, 0.0);
        assert_eq!((snap.separation, snap.distance), (1.0, 2.5));
        assert_eq!(largest_snap(&stairs, 0.0, 2.5), snap);
        assert_eq!(largest_snap(&stairs, 0.0, 2.6).occurred, 0.0);
    }

    #[test]
    fn a_preload_is_reached_between_samples() {
        let (h, force): (Vec<f64>, Vec<f64>) = WELL.iter().copied().unzip();
        assert_eq!(reached(&h, &force, 0.5), Some((0, 0.75)));
        assert_eq!(reached(&h, &force, 2.0), Some((0, 0.0)));
        assert_eq!(reached(&h, &force, 3.0), None);
        // Of several places the outermost: it is come to first. From (4, 0) to (3, 3) F = 1 at 11/3.
        let places = [0.0, 1.0, 2.0, 3.0, 4.0];
        let (_, h) = reached(&places, &[5.0, -1.0, -2.0, 3.0, 0.0], 1.0).unwrap();
        assert!((h - 11.0 / 3.0).abs() < 1e-14, "{h}");
    }

    #[test]
    fn nothing_snaps_where_no_force_acts() {
        assert_eq!(largest_snap(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 0.0, 0.0).occurred, 0.0);
    }
}
