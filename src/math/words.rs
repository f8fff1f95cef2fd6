//! The memory of an accumulator as 64-bit words, so that it can be kept and restored to the bit.

/// What consists of 64-bit words in a fixed order. How many there are depends on its size alone, not on its
/// values.
pub trait Words {
    /// Shows every word; one that `visit` changes is taken over.
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64));

    /// All words.
    fn words(&mut self) -> Vec<u64> {
        let mut words = Vec::new();
        self.each_word(&mut |word| words.push(*word));
        words
    }

    /// Takes over all words, of something of the same size; whether there were neither too few nor too many.
    fn restore(&mut self, words: &[u64]) -> bool {
        let mut rest = words.iter();
        let mut missing = false;
        self.each_word(&mut |word| match rest.next() {
            Some(kept) => *word = *kept,
            None => missing = true,
        });
        !missing && rest.next().is_none()
    }
}

impl Words for u64 {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(self);
    }
}

impl Words for f64 {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        let mut bits = self.to_bits();
        visit(&mut bits);
        *self = Self::from_bits(bits);
    }
}

impl<T: Words> Words for [T] {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        self.iter_mut().for_each(|part| part.each_word(visit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back_to_the_bit() {
        let mut kept = [1.5, -0.0, f64::from_bits(0x7ff8_0000_dead_beef), 5e-324, f64::NEG_INFINITY];
        let words = kept.words();
        let mut restored = [0.0; 5];
        assert!(restored.restore(&words));
        assert_eq!(restored.map(f64::to_bits), kept.map(f64::to_bits));
    }

    #[test]
    fn another_size_is_noticed() {
        assert!(!7_u64.restore(&[]));
        assert!(!7_u64.restore(&[1, 2]));
        assert!(![0.0; 2].restore(&[1]));
    }
}
