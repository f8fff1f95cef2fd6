//! Flattened summits of asperities of one radius, tabulated over ω_max: one takes tens of solves, and a run has millions.
//!
//! All numbers of a summit, [`FlattenedSummit::each`], are interpolated together by Chebyshev polynomials. Cells are halved until
//! summits between the nodes agree. No cell has an ω_max at which a number appears or disappears, such as a fold: summits around it
//! are computed one by one.

use super::summit::FlattenedSummit;
use crate::math::chebyshev;
use crate::math::instruction_set::InstructionSet;

/// Nodes of a cell.
const NODES: usize = 10;
/// Places between the nodes, in −1..1, at which a cell is compared.
const COMPARED: [f64; 3] = [-0.99, 0.17, 0.71];
/// Relative accuracy of the numbers of a summit, a few roundings of their computation, and of starting points of solves.
const TOLERANCE: f64 = 4e-14;
const OF_STARTS: f64 = 1e-3;
/// Halvings of a stretch.
const HALVINGS: u32 = 10;
/// Largest number of numbers of a summit.
const COLUMNS: usize = 88;

/// Chebyshev coefficients of all numbers of a summit, by their order.
type Coefficients = [[f64; COLUMNS]; NODES];

/// An interval of ω_max, m, in which all summits have the same kinks.
struct Cell {
    from: f64,
    to: f64,
    /// A summit of the cell, with its coefficients; none where summits are computed one by one.
    known: Option<(FlattenedSummit, Box<Coefficients>)>,
}

/// A table of summits over ω_max.
pub(super) struct SummitTable {
    cells: Vec<Cell>,
}

/// The numbers of a summit, 0 for those that it does not have.
fn columns(summit: &FlattenedSummit) -> [f64; COLUMNS] {
    let mut columns = [0.0; COLUMNS];
    let (mut summit, mut next) = (*summit, columns.iter_mut());
    summit.each(|value, _| next.next().into_iter().for_each(|column| *column = *value));
    columns
}

impl Cell {
    /// The cells of an interval of ω_max, m, of summits that `make` makes.
    fn of(make: &dyn Fn(f64) -> FlattenedSummit, from: f64, to: f64, halvings: u32, cells: &mut Vec<Self>) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let nodes: [FlattenedSummit; NODES] =
            std::array::from_fn(|i| make(middle + half * libm::cos(chebyshev::angle(i, NODES))));
        let compared = COMPARED.map(|place| make(middle + half * place));
        let kind = nodes[0].kind();
        let are_alike = nodes.iter().chain(&compared).all(|summit| summit.kind() == kind);
        let mut cell = Self { from, to, known: None };
        if are_alike {
            let samples = nodes.map(|summit| columns(&summit));
            let mut coefficients = Box::new([[0.0; COLUMNS]; NODES]);
            for column in 0..COLUMNS {
                let own = chebyshev::coefficients(&samples.map(|sample| sample[column]));
                own.into_iter().zip(coefficients.iter_mut()).for_each(|(own, row)| row[column] = own);
            }
            cell.known = Some((nodes[0], coefficients));
            let is_good =
                |(place, summit): (&f64, &FlattenedSummit)| cell.is_good(middle + half * place, summit);
            if COMPARED.iter().zip(&compared).all(is_good) {
                return cells.push(cell);
            }
            cell.known = None;
        }
        if halvings == 0 || !(from < middle && middle < to) {
            return cells.push(cell);
        }
        Self::of(make, from, middle, halvings - 1, cells);
        Self::of(make, middle, to, halvings - 1, cells);
    }

    /// Whether the cell reproduces the summit at ω_max, m.
    fn is_good(&self, largest: f64, summit: &FlattenedSummit) -> bool {
        let Some(found) = self.summit(largest) else { return false };
        let (found, mut number, mut is_good) = (columns(&found), 0, true);
        let mut summit = *summit;
        summit.each(|value, unit| {
            let tolerance = unit.map_or(OF_STARTS, |unit| TOLERANCE * (1.0 + unit / value.abs()));
            is_good &= (found[number] - *value).abs() <= tolerance * value.abs().max(f64::MIN_POSITIVE);
            number += 1;
        });
        is_good
    }

    /// The summit at ω_max, m.
    fn summit(&self, largest: f64) -> Option<FlattenedSummit> {
        let (summit, coefficients) = self.known.as_ref()?;
        let place = ((largest - self.from) - (self.to - largest)) / (self.to - self.from);
        let mut columns = [0.0; COLUMNS];
        InstructionSet::current().run(
            #[inline(always)]
            || {
                // Clenshaw's recurrence.
                let (mut next, mut after) = ([0.0; COLUMNS], [0.0; COLUMNS]);
                for row in coefficients[1..].iter().rev() {
                    for i in 0..COLUMNS {
                        let own = row[i] + 2.0 * place * next[i] - after[i];
                        (after[i], next[i]) = (next[i], own);
                    }
                }
                for i in 0..COLUMNS {
                    columns[i] = coefficients[0][i] + place * next[i] - after[i];
                }
            },
        );
        let (mut summit, mut next) = (*summit, columns.iter());
        summit.each(|value, _| next.next().into_iter().for_each(|column| *value = *column));
        summit.close();
        Some(summit)
    }
}

impl SummitTable {
    /// The table of the stretches between joints, ω_max in m, rising.
    pub fn new(joints: &[f64], make: impl Fn(f64) -> FlattenedSummit) -> Self {
        let mut cells = Vec::new();
        joints.windows(2).for_each(|ends| Cell::of(&make, ends[0], ends[1], HALVINGS, &mut cells));
        Self { cells }
    }

    /// The summit at ω_max, m, if it is in the table.
    pub fn summit(&self, largest: f64) -> Option<FlattenedSummit> {
        let cell = self.cells.get(self.cells.partition_point(|cell| cell.to < largest))?;
        if largest < cell.from { None } else { cell.summit(largest) }
    }
}
