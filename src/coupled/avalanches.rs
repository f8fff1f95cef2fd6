//! Avalanches: passages over jumps that set off each other.
//!
//! An asperity that passes because the surfaces were moved sets off an avalanche. One that passes only
//! because others have is part of the avalanche of the nearest of these: the displacement by a force falls
//! with the distance.

use std::collections::BTreeMap;

/// A passage over an irreversible jump, or over one that pulls others along.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    /// The asperity.
    pub asperity: u32,
    /// Whether the motion of the surfaces was enough for it.
    pub is_trigger: bool,
}

/// Classes of avalanches by their size: the class k has avalanches of 2^k to 2^(k+1) − 1 asperities.
pub const CLASSES: usize = 21;

/// Avalanches of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Avalanches {
    /// The number of avalanches.
    pub count: usize,
    /// Asperities in the largest of them.
    pub largest: usize,
    /// The number in each class.
    pub of_class: [u32; CLASSES],
}

impl Avalanches {
    /// The avalanches of this step and a further one.
    pub fn and(self, further: Self) -> Self {
        Self {
            count: self.count + further.count,
            largest: self.largest.max(further.largest),
            of_class: std::array::from_fn(|class| self.of_class[class] + further.of_class[class]),
        }
    }
}

/// The avalanches of events in their order. `is_lasting` says whether an asperity has not gone back;
/// `distance` is between two asperities, in any unit.
pub fn avalanches(
    events: &[Event],
    is_lasting: impl Fn(u32) -> bool,
    distance: impl Fn(u32, u32) -> f64,
) -> Avalanches {
    let mut roots: BTreeMap<u32, u32> = BTreeMap::new();
    let mut earlier: Vec<u32> = Vec::new();
    for event in events.iter().filter(|event| is_lasting(event.asperity)) {
        if roots.contains_key(&event.asperity) {
            continue;
        }
        let nearest = || {
            let by_distance =
                |a: &&u32, b: &&u32| distance(event.asperity, **a).total_cmp(&distance(event.asperity, **b));
            earlier.iter().min_by(by_distance).map(|other| roots[other])
        };
        let root = if event.is_trigger { None } else { nearest() };
        roots.insert(event.asperity, root.unwrap_or(event.asperity));
        earlier.push(event.asperity);
    }
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    roots.values().for_each(|root| *sizes.entry(*root).or_default() += 1);
    let mut all = Avalanches::default();
    for &size in sizes.values() {
        all.count += 1;
        all.largest = all.largest.max(size);
        all.of_class[(size.ilog2() as usize).min(CLASSES - 1)] += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passages_belong_to_what_set_them_off() {
        let event = |asperity, is_trigger| Event { asperity, is_trigger };
        let distance = |a: u32, b: u32| f64::from(a.abs_diff(b));
        // 10 and 20 are triggers; 11, 12 and 13 follow 10, 19 follows 20, 30 went back.
        let events = [
            event(10, true),
            event(20, true),
            event(11, false),
            event(30, true),
            event(12, false),
            event(19, false),
            event(13, false),
            event(12, false),
        ];
        let Avalanches { count, largest, of_class } = avalanches(&events, |i| i != 30, distance);
        // One of 4 asperities and one of 2.
        assert_eq!((count, largest, &of_class[..4]), (2, 4, &[0, 1, 1, 0][..]));
        assert_eq!(avalanches(&[], |_| true, distance), Avalanches::default());
        let both =
            avalanches(&events[..1], |_| true, distance).and(avalanches(&events, |i| i != 30, distance));
        assert_eq!((both.count, both.largest, &both.of_class[..4]), (3, 4, &[1, 1, 1, 0][..]));
    }
}
