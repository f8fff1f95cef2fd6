//! Sums without rounding, to judge those with it.

/// A sum of numbers kept as numbers that do not overlap (Shewchuk 1997, Discrete Comput. Geom. 18, 305).
#[derive(Clone, Debug, Default)]
pub struct Exact {
    parts: Vec<f64>,
}

impl Exact {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        let mut carried = value;
        let mut kept = 0;
        for i in 0..self.parts.len() {
            let part = self.parts[i];
            let sum = carried + part;
            let other = sum - carried;
            let lost = (carried - (sum - other)) + (part - other);
            if lost != 0.0 {
                self.parts[kept] = lost;
                kept += 1;
            }
            carried = sum;
        }
        self.parts.truncate(kept);
        self.parts.push(carried);
    }

    /// This sum less another.
    pub fn less(mut self, other: &Self) -> Self {
        other.parts.iter().for_each(|part| self.add(-*part));
        self
    }

    /// The sum, off by less than its last digit.
    pub fn value(&self) -> f64 {
        self.parts.iter().sum()
    }
}
