//! The asperities of a replica under a sampling scheme.

use super::stream::{Purpose, stream};
use crate::surface::{CountLaw, HeightLaw, Radii, STRATA, SamplingScheme, Surface};
use rand::RngExt;
use rand::distr::Open01;
use rand::seq::SliceRandom;
use rand_distr::{Distribution, Poisson, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};

/// What the asperities of a replica are drawn by.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Seed of all replicas.
    pub seed: u64,
    /// The scheme by which they depend on each other.
    pub scheme: SamplingScheme,
    /// Index of the replica.
    pub index: u64,
}

impl Draw {
    /// Draws the asperities of a surface, unsorted, into `heights`, m, and where radii differ into
    /// `radii`, m.
    ///
    /// They depend on seed, scheme and index alone. Number, heights and radii have streams of their own, so
    /// that a surface on which one of them follows another law still has the others.
    pub fn of(self, surface: &Surface, heights: &mut Vec<f64>, radii: &mut Vec<f64>) {
        self.under(surface, (heights, radii), None);
    }

    /// Draws the asperities as [`Draw::of`], and gives the places, m, from the middle, of asperities under a body.
    pub fn placed(
        self,
        surface: &Surface,
        heights: &mut Vec<f64>,
        radii: &mut Vec<f64>,
    ) -> Option<Vec<[f64; 2]>> {
        let mut places = Vec::new();
        self.under(surface, (heights, radii), Some(&mut places)).then_some(places)
    }

    /// Draws asperities, lowered under a body, and says whether there is one.
    fn under(
        self,
        surface: &Surface,
        (heights, radii): (&mut Vec<f64>, &mut Vec<f64>),
        places: Option<&mut Vec<[f64; 2]>>,
    ) -> bool {
        let HeightLaw::Lowered(lowered) = &surface.heights.law else {
            self.of_plane(surface, heights, radii);
            return false;
        };
        let random = &mut stream(self.seed, Purpose::Places, self.index);
        match (&surface.landing, &surface.radii) {
            (Some(map), Radii::Measured(asperities)) => {
                lowered.land(random, (map, asperities), (heights, radii), places);
            }
            _ => {
                self.of_plane(surface, heights, radii);
                lowered.lower(random, heights, radii, places);
            }
        }
        true
    }

    /// Draws the asperities of a plane.
    fn of_plane(self, surface: &Surface, heights: &mut Vec<f64>, radii: &mut Vec<f64>) {
        let Self { seed, scheme, index } = self;
        let count = count(surface, seed, index);
        heights.resize(count, 0.0);
        radii.resize(if surface.is_polydisperse() { count } else { 0 }, 0.0);
        if let Some(patches) = &surface.patches {
            let first = index as usize % (patches.len() / count) * count;
            return heights.copy_from_slice(&patches[first..first + count]);
        }
        match (&surface.radii, surface.heights.values()) {
            (Radii::Measured(asperities), _) if surface.whole => {
                for ((height, radius), asperity) in heights.iter_mut().zip(radii).zip(asperities.iter()) {
                    [*height, *radius] = *asperity;
                }
            }
            (_, Some(values)) if surface.whole => heights.copy_from_slice(&values[..count]),
            _ if scheme != SamplingScheme::Independent => {
                self.by_scheme(surface, heights, radii);
            }
            (Radii::Common, _) => surface.heights.draw(&mut stream(seed, Purpose::Heights, index), heights),
            (law, _) => {
                let [mut of_heights, mut of_radii] =
                    [Purpose::Heights, Purpose::Radii].map(|purpose| stream(seed, purpose, index));
                let streams = (&mut of_heights, &mut of_radii);
                let plane = surface.plane();
                law.draw(plane.asperity_radius, &plane.heights, streams, heights, radii);
            }
        }
    }

    /// Draws asperities, unsorted, by a scheme under which the asperities of one group of replicas depend on
    /// each other, asperity by asperity.
    ///
    /// Each replica by itself is as if it were drawn independently. What they depend on each other by is the
    /// normal score of an asperity in the order of heights; radii that scatter independently of the height
    /// are independent.
    ///
    /// * antithetic: a replica of odd index has the scores of the one before it with opposite sign;
    /// * stratified: the score of an asperity is the normal quantile of (π + U)/8, where π over the replicas of
    ///   the group is a random permutation of 0..8, another for each asperity, and U is uniform (McKay, Beckman
    ///   and Conover 1979).
    fn by_scheme(self, surface: &Surface, heights: &mut [f64], radii: &mut [f64]) {
        let Self { seed, scheme, index } = self;
        let stream = |purpose, index| stream(seed, purpose, index);
        let law = (surface.asperity_radius, &surface.heights);
        let streams = (&mut stream(Purpose::Heights, index), &mut stream(Purpose::Radii, index));
        if scheme == SamplingScheme::Antithetic {
            let mut deviates = stream(Purpose::Heights, index - index % 2);
            let sign = if index % 2 == 1 { -1.0 } else { 1.0 };
            let score = || {
                let deviate: f64 = StandardNormal.sample(&mut deviates);
                sign * deviate
            };
            return surface.radii.draw_by(law, score, streams, heights, radii);
        }
        let normal = Normal::standard();
        let mut permutations = stream(Purpose::Strata, index / STRATA);
        let mut uniforms = stream(Purpose::Heights, index);
        let score = || {
            let stratum = permutation(&mut permutations)[(index % STRATA) as usize];
            let share: f64 = uniforms.sample(Open01);
            // The upper half mirrors the lower one, so that both tails keep their digits.
            let (below, sign) =
                if stratum < STRATA / 2 { (stratum, 1.0) } else { (STRATA - 1 - stratum, -1.0) };
            sign * normal.inverse_cdf((below as f64 + share) / STRATA as f64)
        };
        surface.radii.draw_by(law, score, streams, heights, radii);
    }
}

/// The number of asperities of the replica `index`.
fn count(surface: &Surface, seed: u64, index: u64) -> usize {
    match surface.count_law {
        CountLaw::Fixed => surface.asperity_count,
        CountLaw::Poisson => {
            let law = Poisson::new(surface.asperity_count as f64).expect("a surface has asperities");
            let count: f64 = law.sample(&mut stream(seed, Purpose::Count, index));
            count as usize
        }
    }
}

/// A random permutation of the strata.
fn permutation(random: &mut impl rand::Rng) -> [u64; STRATA as usize] {
    let mut strata = std::array::from_fn(|i| i as u64);
    strata.shuffle(random);
    strata
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Heights;

    const STD: f64 = 1.6e-9;

    fn surface(asperity_count: usize) -> Surface {
        Surface::uniform(STD, 1e-6, asperity_count, 1e-9)
    }

    fn heights(scheme: SamplingScheme, index: u64, count: usize) -> Vec<f64> {
        let mut heights = vec![0.0; count];
        Draw { seed: 3, scheme, index }.of(&surface(count), &mut heights, &mut Vec::new());
        heights
    }

    #[test]
    fn independent_replicas_are_the_streams() {
        let mut plain = vec![0.0; 50];
        Heights::gaussian(STD).draw(&mut stream(3, Purpose::Heights, 5), &mut plain);
        assert_eq!(heights(SamplingScheme::Independent, 5, 50), plain);
    }

    #[test]
    fn antithetic_pairs_are_mirror_images() {
        for pair in 0..3 {
            let [first, second] =
                [0, 1].map(|member| heights(SamplingScheme::Antithetic, 2 * pair + member, 500));
            assert!(first.iter().zip(&second).all(|(a, b)| *a == -*b));
            assert_eq!(first, heights(SamplingScheme::Independent, 2 * pair, 500));
        }
    }

    #[test]
    fn an_asperity_of_a_group_is_once_in_each_stratum() {
        let distribution = Heights::gaussian(STD);
        for group in [0, 7] {
            let group: Vec<Vec<f64>> =
                (0..8).map(|m| heights(SamplingScheme::Stratified, 8 * group + m, 300)).collect();
            for asperity in 0..300 {
                let mut strata: Vec<u64> = group
                    .iter()
                    .map(|replica| {
                        (8.0 * distribution.probability(f64::NEG_INFINITY, replica[asperity])) as u64
                    })
                    .collect();
                strata.sort_unstable();
                assert_eq!(strata, [0, 1, 2, 3, 4, 5, 6, 7], "asperity {asperity}");
            }
        }
    }

    /// All 8! permutations are equally likely: Pearson's χ² of pairs of the first two entries over 56 cells,
    /// 55 degrees of freedom; the critical value at the level 1e-3 is 93.2 (the false-alarm rate of this
    /// test; the seed is fixed).
    #[test]
    fn permutations_are_random() {
        let mut random = stream(1, Purpose::Strata, 0);
        let (mut counts, draws) = ([[0.0_f64; 8]; 8], 56_000);
        for _ in 0..draws {
            let permutation = permutation(&mut random);
            let mut sorted = permutation;
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4, 5, 6, 7]);
            counts[permutation[0] as usize][permutation[1] as usize] += 1.0;
        }
        let expected = f64::from(draws) / 56.0;
        let cells = (0..64).filter(|cell| cell / 8 != cell % 8).map(|cell| counts[cell / 8][cell % 8]);
        let statistic: f64 = cells.map(|count| (count - expected).powi(2) / expected).sum();
        assert!(statistic < 93.2, "{statistic}");
    }

    /// Each of the 8 replicas of a group is Gaussian by itself, by Kolmogorov and Smirnov at the level 1e-4
    /// (false alarm below 1e-3 for all; the seed is fixed), and its asperities are uncorrelated: their lag-1
    /// correlation is below 4 standard errors (5e-4).
    #[test]
    fn one_replica_is_a_plain_surface() {
        let (distribution, n) = (Heights::gaussian(STD), 20_000);
        for index in 16..24 {
            let heights = heights(SamplingScheme::Stratified, index, n);
            let neighbours: f64 = heights.windows(2).map(|pair| pair[0] * pair[1]).sum();
            assert!((neighbours / (n as f64 * STD * STD)).abs() < 4.0 / (n as f64).sqrt(), "{index}");
            let mut sorted = heights;
            sorted.sort_by(f64::total_cmp);
            let distance = sorted.iter().enumerate().fold(0.0_f64, |worst, (i, u)| {
                let below = distribution.probability(f64::NEG_INFINITY, *u);
                worst.max((below - i as f64 / n as f64).abs()).max(((i + 1) as f64 / n as f64 - below).abs())
            });
            // Critical distance at 1e-4: 2.225/√n.
            assert!(distance < 2.225 / (n as f64).sqrt(), "{index}: {distance}");
        }
    }
}
