//! External forces of asperities that differ in their radii, each at separations of its own, in blocks of one regime.

use super::asperities::Asperities;
use crate::asperity::Lanes;
use crate::asperity::{BLOCK, Responses, SolverStats};

/// An asperity at a separation.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Number of the asperity.
    pub asperity: u32,
    /// d, m.
    pub separation: f64,
    /// The number of the sum that it counts in.
    pub sum: u32,
}

/// Memory for the sums of some pairs after the other.
pub struct Pairs {
    /// By regime.
    lists: Vec<List>,
    interference: Box<[f64; BLOCK]>,
    responses: Box<Responses>,
}

/// Pairs in one regime.
#[derive(Default)]
struct List {
    /// The numbers of the asperities.
    which: Vec<u32>,
    /// Their interferences, m, and the sums that they count in.
    places: Vec<(f64, u32)>,
}

impl Default for Pairs {
    fn default() -> Self {
        Self { lists: Vec::new(), interference: Box::new([0.0; BLOCK]), responses: Box::default() }
    }
}

impl Pairs {
    /// Adds the external forces of pairs, N, to the sums that they count in.
    pub fn add(
        &mut self,
        asperities: &Asperities,
        pairs: impl Iterator<Item = Pair>,
        stats: &mut SolverStats,
        sums: &mut [f64],
    ) {
        let Asperities { family, heights, lanes, ends, .. } = asperities;
        let law = family.shared();
        self.lists.resize_with(family.regimes() + 1, Default::default);
        for List { which, places } in &mut self.lists {
            which.clear();
            places.clear();
        }
        for Pair { asperity, separation, sum } in pairs {
            let i = asperity as usize;
            let regime: usize = ends.iter().map(|ends| usize::from(separation <= ends[i])).sum();
            let list = &mut self.lists[regime];
            list.which.push(asperity);
            list.places.push((heights[i] - separation, sum));
        }
        for (regime, List { which, places }) in self.lists[..family.regimes()].iter().enumerate() {
            let touches = family.touches(regime);
            stats.unloaded += if touches { 0 } else { which.len() as u64 };
            for (which, places) in which.chunks(BLOCK).zip(places.chunks(BLOCK)) {
                let interference = &mut self.interference[..which.len()];
                interference.iter_mut().zip(places).for_each(|(delta, (own, _))| *delta = *own);
                law.evaluate(regime, Lanes::new(lanes, which), interference, &mut self.responses, stats);
                for (lane, (_, sum)) in places.iter().enumerate() {
                    let load = if touches { self.responses.contact[lane] } else { 0.0 };
                    sums[*sum as usize] += load - self.responses.adhesion[lane];
                }
            }
        }
    }
}
