//! Places of asperities in a square.

use crate::substrate::Coupling;
use rand::{Rng, RngExt};
use std::f64::consts::PI;
use std::sync::Arc;
use thiserror::Error;

/// Largest share of the square that circles of half the least distance may cover: beyond it random places
/// that keep their distance become hard to find, and jam at 0.547 (Feder, J. Theor. Biol. 87 (1980) 237).
pub const LARGEST_COVER: f64 = 0.45;
/// Largest share by which a hexagonal lattice is stretched along a side to fit the square.
const LARGEST_STRETCH: f64 = 0.03;

/// The law of the places of asperities.
///
/// # Examples
/// ```
/// use stiction::substrate::Coupling;
/// use stiction::surface::Places;
/// use rand::SeedableRng;
///
/// let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
/// let places = Places::HardCore(0.05).draw(&mut random, (100, 1.0), Coupling::Periodic);
/// let distance = |i: usize, j: usize| Coupling::Periodic.square(places[i], places[j]).sqrt();
/// assert!((1..100).all(|i| (0..i).all(|j| distance(i, j) >= 0.05)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Places {
    /// Random places at least this distance apart, m; one after the other, each in the area that the others
    /// left free.
    HardCore(f64),
    /// Random places, independent of each other.
    Uniform,
    /// A square lattice.
    Square,
    /// A hexagonal lattice, stretched a little to fit the square.
    Hexagonal,
    /// Measured places.
    Measured(MeasuredPlaces),
}

/// Places of measured asperities, in their order, on a map.
///
/// # Examples
/// ```
/// use stiction::surface::MeasuredPlaces;
///
/// let positions = [[1e-6, 3e-6], [2e-6, 0.5e-6]];
/// let places = MeasuredPlaces { positions: positions.into(), extent: [4e-6, 3.5e-6] };
/// assert_eq!(places.side(), 4e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPlaces {
    /// x and y of each, m.
    pub positions: Arc<[[f64; 2]]>,
    /// Lengths of the map along x and y, m.
    pub extent: [f64; 2],
}

impl MeasuredPlaces {
    /// The side, m, of the square around the map.
    pub fn side(&self) -> f64 {
        self.extent[0].max(self.extent[1])
    }
}

/// Reasons why asperities do not have places.
///
/// # Examples
/// ```
/// use stiction::surface::{Places, PlacesError};
///
/// assert_eq!(Places::Square.check(50, 1e-6), Err(PlacesError::Lattice { count: 50, fits: 49 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PlacesError {
    /// No lattice of this number fits a square.
    #[error("{count} asperities form no such lattice in a square; {fits} would")]
    Lattice {
        /// The number of asperities.
        count: usize,
        /// The nearest number that fits.
        fits: usize,
    },
    /// The asperities cannot keep their distance.
    #[error(
        "circles of half that distance around {count} asperities cover {cover:.2} of the area, more than {LARGEST_COVER}; \
         {fits:.4e} m would do"
    )]
    Crowded {
        /// The number of asperities.
        count: usize,
        /// The share that is covered.
        cover: f64,
        /// The largest distance that would do, m.
        fits: f64,
    },
}

impl Places {
    /// The name in scenes and files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::HardCore(_) => "hard_core",
            Self::Uniform => "uniform",
            Self::Square => "square",
            Self::Hexagonal => "hexagonal",
            Self::Measured(_) => "measured",
        }
    }

    /// The side, m, of the square of the places on a surface of a nominal area, m².
    pub fn side(&self, nominal_area: f64) -> f64 {
        match self {
            Self::Measured(places) => places.side(),
            _ => nominal_area.sqrt(),
        }
    }

    /// The least distance, m, if they keep one.
    pub fn minimum_distance(&self) -> Option<f64> {
        match self {
            Self::HardCore(distance) => Some(*distance),
            _ => None,
        }
    }

    /// Whether they form a lattice, so that nothing is left to chance.
    pub fn is_lattice(&self) -> bool {
        matches!(self, Self::Square | Self::Hexagonal)
    }

    /// Checks that `count` asperities can have these places in a square of a side, m.
    ///
    /// # Errors
    /// [`PlacesError`].
    pub fn check(&self, count: usize, side: f64) -> Result<(), PlacesError> {
        match self {
            Self::Uniform | Self::Measured(_) => Ok(()),
            Self::HardCore(distance) => {
                let cover = 0.25 * PI * (distance / side).powi(2) * count as f64;
                if cover <= LARGEST_COVER {
                    return Ok(());
                }
                Err(PlacesError::Crowded { count, cover, fits: distance * (LARGEST_COVER / cover).sqrt() })
            }
            Self::Square | Self::Hexagonal => {
                let fits = |count: &usize| self.lattice(*count).is_some();
                if fits(&count) {
                    return Ok(());
                }
                let above = (count + 1..).find(fits).expect("there are larger lattices");
                let below = (1..count).rev().find(fits).unwrap_or(above);
                let fits = if above - count < count.abs_diff(below) { above } else { below };
                Err(PlacesError::Lattice { count, fits })
            }
        }
    }

    /// Columns and rows of a lattice of `count` places in a square.
    fn lattice(&self, count: usize) -> Option<[usize; 2]> {
        if *self == Self::Square {
            let side = count.isqrt();
            return (side * side == count && count > 0).then_some([side, side]);
        }
        let aspect = 2.0 / 3.0_f64.sqrt();
        let rows = (count as f64 * aspect).sqrt();
        let near = (rows * (1.0 - LARGEST_STRETCH)) as usize..=(rows * (1.0 + LARGEST_STRETCH)) as usize + 1;
        let stretch = |rows: usize| libm::log(rows as f64 / (count / rows) as f64 / aspect).abs();
        let fits = |rows: &usize| *rows > 0 && rows.is_multiple_of(2) && count.is_multiple_of(*rows);
        let best = near.filter(fits).min_by(|a, b| stretch(*a).total_cmp(&stretch(*b)))?;
        (stretch(best) <= 2.0 * LARGEST_STRETCH).then(|| [count / best, best])
    }

    /// Places of `count` asperities in a square of a side, m, in sides: 0 ≤ x, y < 1; distances are taken as
    /// `coupling` does.
    ///
    /// # Panics
    /// When the asperities cannot have such places ([`Places::check`]).
    pub fn draw(
        &self,
        random: &mut impl Rng,
        (count, side): (usize, f64),
        coupling: Coupling,
    ) -> Vec<[f64; 2]> {
        match self {
            Self::Uniform => (0..count).map(|_| point(random)).collect(),
            Self::HardCore(distance) => hard_core(random, count, distance / side, coupling),
            Self::Measured(places) => places.positions.iter().map(|[x, y]| [x / side, y / side]).collect(),
            Self::Square | Self::Hexagonal => {
                let [columns, rows] = self.lattice(count).expect("the number is checked");
                let shift = |row: usize| if *self == Self::Hexagonal && row % 2 == 1 { 0.75 } else { 0.25 };
                let at = |i: usize| {
                    let (row, column) = (i / columns, i % columns);
                    let x = (column as f64 + shift(row)) / columns as f64;
                    [x, (row as f64 + 0.5) / rows as f64]
                };
                (0..count).map(at).collect()
            }
        }
    }
}

/// A point of the unit square.
fn point(random: &mut impl Rng) -> [f64; 2] {
    [random.random(), random.random()]
}

/// Random sequential places at least `distance`, in sides, apart.
fn hard_core(random: &mut impl Rng, count: usize, distance: f64, coupling: Coupling) -> Vec<[f64; 2]> {
    // Cells as wide as the distance: whoever is too close is in one of nine.
    let cells = ((1.0 / distance) as usize).clamp(1, (count as f64).sqrt() as usize + 1);
    let of = |x: f64| ((x * cells as f64) as usize).min(cells - 1) as isize;
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); cells * cells];
    let mut places: Vec<[f64; 2]> = Vec::with_capacity(count);
    while places.len() < count {
        let place = point(random);
        let [column, row] = place.map(of);
        let is_free = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))).all(|(dx, dy)| {
            let wrap = |i: isize| i.rem_euclid(cells as isize) as usize;
            let members = &members[wrap(row + dy) * cells + wrap(column + dx)];
            members.iter().all(|&i| coupling.square(place, places[i as usize]) >= distance * distance)
        });
        if is_free {
            members[row as usize * cells + column as usize].push(places.len() as u32);
            places.push(place);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn lattices_fit_or_say_what_would() {
        assert!(Places::Square.check(49, 1.0).is_ok() && Places::Square.check(50, 1.0).is_err());
        let fits: Vec<usize> =
            (1..200).filter(|count| Places::Hexagonal.check(*count, 1.0).is_ok()).collect();
        // 7 × 8 and 12 × 14: rows over columns are 2/√3 within a few per cent.
        assert!(fits.contains(&56) && fits.contains(&168), "{fits:?}");
        for count in [2, 5, 100, 1000, 7390] {
            if let Err(PlacesError::Lattice { fits, .. }) = Places::Hexagonal.check(count, 1.0) {
                assert!(Places::Hexagonal.check(fits, 1.0).is_ok(), "{count} {fits}");
            }
        }
    }

    /// Each place of a hexagonal lattice has six neighbours at nearly the same distance.
    #[test]
    fn hexagonal_places_have_six_neighbours() {
        let places =
            Places::Hexagonal.draw(&mut ChaCha8Rng::seed_from_u64(1), (168, 1.0), Coupling::Periodic);
        for a in &places {
            let distance = |b: &[f64; 2]| Coupling::Periodic.square(*a, *b).sqrt();
            let mut distances: Vec<f64> = places.iter().map(distance).collect();
            distances.sort_by(f64::total_cmp);
            assert!(distances[6] / distances[1] < 1.05 && distances[7] / distances[1] > 1.6);
        }
    }

    #[test]
    fn what_is_crowded_is_refused() {
        let refused = Places::HardCore(0.1).check(100, 1.0).unwrap_err();
        let PlacesError::Crowded { fits, .. } = refused else { panic!("{refused}") };
        let places = Places::HardCore(fits * (1.0 - 1e-12));
        assert!(places.check(100, 1.0).is_ok());
        assert_eq!(places.draw(&mut ChaCha8Rng::seed_from_u64(1), (100, 1.0), Coupling::Periodic).len(), 100);
    }

    /// Mean distance to the nearest of independent places: 1/(2√η).
    #[test]
    fn uniform_places_are_a_poisson_process() {
        let count = 4000;
        let places =
            Places::Uniform.draw(&mut ChaCha8Rng::seed_from_u64(5), (count, 1.0), Coupling::Periodic);
        let nearest = |i: usize| {
            let distance = |j: usize| Coupling::Periodic.square(places[i], places[j]).sqrt();
            (0..count).filter(|j| *j != i).map(distance).fold(1.0, f64::min)
        };
        let mean = (0..count).map(nearest).sum::<f64>() / count as f64 * (count as f64).sqrt();
        // Its standard error is √(1/π − 1/4)/√N = 0.0041, a little more with neighbours in common.
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}
