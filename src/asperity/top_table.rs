//! The tops that asperities of one radius leave, tabulated over ω_max: to make one takes tens of solves, and a run has millions.
//!
//! All that is known of a top, [`Top::each`], is interpolated together, by Chebyshev polynomials on cells that are halved until
//! places between the nodes agree. What begins or ends at some ω_max, such as a fold, is in no cell: tops around there are made
//! one by one.

use super::top::Top;
use crate::math::chebyshev;
use crate::math::instruction_set::InstructionSet;

/// Nodes of a cell.
const NODES: usize = 10;
/// Places between the nodes, in −1..1, at which a cell is compared.
const COMPARED: [f64; 3] = [-0.99, 0.17, 0.71];
/// Relative accuracy of what is known of a top, a few roundings of how it is found, and of where solves start.
const TOLERANCE: f64 = 4e-14;
const OF_STARTS: f64 = 1e-3;
/// Halvings of a stretch.
const HALVINGS: u32 = 10;
/// Numbers of a top, at most.
const COLUMNS: usize = 88;

/// Chebyshev coefficients of all numbers of a top, by their order.
type Coefficients = [[f64; COLUMNS]; NODES];

/// An interval of ω_max, m, in which all tops have the same kinks.
struct Cell {
    from: f64,
    to: f64,
    /// A top of the cell, with its coefficients; none where tops are made one by one.
    known: Option<(Top, Box<Coefficients>)>,
}

/// A table of tops over ω_max.
pub(super) struct TopTable {
    cells: Vec<Cell>,
}

/// The numbers of a top, with 0 for what it has not.
fn columns(top: &Top) -> [f64; COLUMNS] {
    let mut columns = [0.0; COLUMNS];
    let (mut top, mut next) = (*top, columns.iter_mut());
    top.each(|value, _| next.next().into_iter().for_each(|column| *column = *value));
    columns
}

impl Cell {
    /// The cells of an interval of ω_max, m, of tops that `make` makes.
    fn of(make: &dyn Fn(f64) -> Top, from: f64, to: f64, halvings: u32, cells: &mut Vec<Self>) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let nodes: [Top; NODES] =
            std::array::from_fn(|i| make(middle + half * libm::cos(chebyshev::angle(i, NODES))));
        let compared = COMPARED.map(|place| make(middle + half * place));
        let kind = nodes[0].kind();
        let are_alike = nodes.iter().chain(&compared).all(|top| top.kind() == kind);
        let mut cell = Self { from, to, known: None };
        if are_alike {
            let samples = nodes.map(|top| columns(&top));
            let mut coefficients = Box::new([[0.0; COLUMNS]; NODES]);
            for column in 0..COLUMNS {
                let own = chebyshev::coefficients(&samples.map(|sample| sample[column]));
                own.into_iter().zip(coefficients.iter_mut()).for_each(|(own, row)| row[column] = own);
            }
            cell.known = Some((nodes[0], coefficients));
            let is_good = |(place, top): (&f64, &Top)| cell.is_good(middle + half * place, top);
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

    /// Whether the top at ω_max, m, is what the cell has.
    fn is_good(&self, largest: f64, top: &Top) -> bool {
        let Some(found) = self.top(largest) else { return false };
        let (found, mut number, mut is_good) = (columns(&found), 0, true);
        let mut top = *top;
        top.each(|value, unit| {
            let tolerance = unit.map_or(OF_STARTS, |unit| TOLERANCE * (1.0 + unit / value.abs()));
            is_good &= (found[number] - *value).abs() <= tolerance * value.abs().max(f64::MIN_POSITIVE);
            number += 1;
        });
        is_good
    }

    /// The top at ω_max, m.
    fn top(&self, largest: f64) -> Option<Top> {
        let (top, coefficients) = self.known.as_ref()?;
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
        let (mut top, mut next) = (*top, columns.iter());
        top.each(|value, _| next.next().into_iter().for_each(|column| *value = *column));
        top.close();
        Some(top)
    }
}

impl TopTable {
    /// The table of the stretches between joints, ω_max in m, rising.
    pub fn new(joints: &[f64], make: impl Fn(f64) -> Top) -> Self {
        let mut cells = Vec::new();
        joints.windows(2).for_each(|ends| Cell::of(&make, ends[0], ends[1], HALVINGS, &mut cells));
        Self { cells }
    }

    /// The top at ω_max, m, if it is in the table.
    pub fn top(&self, largest: f64) -> Option<Top> {
        let cell = self.cells.get(self.cells.partition_point(|cell| cell.to < largest))?;
        if largest < cell.from { None } else { cell.top(largest) }
    }
}
