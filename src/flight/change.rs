//! Values that differ between two vectors, as runs of words, and a checksum.

/// Number of words that are compared at a time.
pub(super) const BLOCK: usize = 16;

/// End of a list of runs.
pub(super) const END: u32 = u32::MAX;

/// Returns a bound of the size of the runs of `count` words in bytes, with their end: one word, or
/// every other one of three, differs. Words that are compared in several parts, which have no
/// common runs, need no more if each part but `short` ones has two or more words.
pub(super) fn bound(count: usize, short: usize) -> usize {
    12 * count + 4 * short + 4
}

/// Returns `true` if all bits of two vectors are the same.
#[inline]
pub(super) fn is_same(new: &[f64], old: &[f64]) -> bool {
    let ((new, new_rest), (old, old_rest)) = (new.as_chunks::<4>(), old.as_chunks::<4>());
    let differs = |(new, old): (&f64, &f64)| new.to_bits() ^ old.to_bits();
    // The processor compares the words of a block at a time.
    let blocks = new.iter().zip(old).fold([0; 4], |different, (new, old)| {
        std::array::from_fn(|lane| different[lane] | differs((&new[lane], &old[lane])))
    });
    let rest = new_rest.iter().zip(old_rest).map(differs);
    rest.chain(blocks).fold(0, |different, bits| different | bits) == 0
}

/// Calls `each` with the start and the values of each run of words of `new` that differ from those
/// of `old` in a bit.
#[inline]
pub(super) fn runs(new: &[f64], old: &[f64], mut each: impl FnMut(usize, &[f64])) {
    debug_assert_eq!(new.len(), old.len(), "Bug: the values of different models are compared");
    let mut start = None;
    for (block, (words, old)) in new.chunks(BLOCK).zip(old.chunks(BLOCK)).enumerate() {
        let first = block * BLOCK;
        if is_same(words, old) {
            if let Some(start) = start.take() {
                each(start, &new[start..first]);
            }
            continue;
        }
        for (index, (word, old)) in words.iter().zip(old).enumerate() {
            match (word.to_bits() != old.to_bits(), start) {
                (true, None) => start = Some(first + index),
                (false, Some(first_word)) => {
                    each(first_word, &new[first_word..first + index]);
                    start = None;
                }
                _ => {}
            }
        }
    }
    if let Some(start) = start {
        each(start, &new[start..]);
    }
}

/// Checksum of words. It is not cryptographic: it detects changes, not forgeries.
pub(super) struct Checksum {
    lanes: [u64; 4],
    count: u64,
}

impl Checksum {
    pub(super) fn new() -> Self {
        Self { lanes: [1, 2, 3, 4], count: 0 }
    }

    #[inline]
    fn mix(lane: u64, word: u64) -> u64 {
        (lane ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    }

    /// Adds words. Four lanes hide the latency of the multiplication.
    #[inline]
    pub(super) fn add<T: Copy>(&mut self, words: &[T], bits: impl Fn(T) -> u64) {
        let (blocks, rest) = words.as_chunks::<4>();
        for block in blocks {
            for (lane, &word) in self.lanes.iter_mut().zip(block) {
                *lane = Self::mix(*lane, bits(word));
            }
        }
        for (lane, &word) in self.lanes.iter_mut().zip(rest) {
            *lane = Self::mix(*lane, bits(word));
        }
        self.count += words.len() as u64;
    }

    pub(super) fn finish(&self) -> u64 {
        let mixed = self.lanes.iter().fold(self.count, |all, &lane| Self::mix(all, lane));
        mixed ^ (mixed >> 32)
    }

    /// Returns the checksum of bytes.
    pub(super) fn of_bytes(bytes: &[u8]) -> u64 {
        let (words, rest) = bytes.as_chunks::<8>();
        let mut checksum = Self::new();
        checksum.add(words, u64::from_le_bytes);
        checksum.add(rest, u64::from);
        checksum.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::{Checksum, bound, runs};

    fn found(new: &[f64], old: &[f64]) -> Vec<(usize, Vec<f64>)> {
        let mut found = Vec::new();
        runs(new, old, |start, values| found.push((start, values.to_vec())));
        found
    }

    #[test]
    fn runs_are_the_words_that_differ_in_a_bit() {
        let old = vec![0.0; 50];
        for changed in [vec![], vec![0], vec![15, 16, 17], vec![31, 33, 49], (0..50).collect(), vec![14, 15, 32]] {
            let mut new = old.clone();
            for &index in &changed {
                new[index] = -0.0;
            }
            let places: Vec<usize> =
                found(&new, &old).iter().flat_map(|(start, run)| *start..start + run.len()).collect();
            assert_eq!(places, changed);
        }
        assert_eq!(found(&[f64::NAN, 1.0], &[f64::NAN, 2.0]), [(1, vec![1.0])]);
    }

    #[test]
    fn the_bound_holds_for_short_runs_and_short_parts() {
        for count in [1_usize, 2, 17, 64] {
            let new: Vec<f64> = (0..count).map(|index| if index % 2 == 0 { 1.0 } else { 0.0 }).collect();
            let size: usize = found(&new, &vec![0.0; count]).iter().map(|(_, run)| 8 + 8 * run.len()).sum();
            assert!(size + 4 <= bound(count, 1), "{count}");
            assert!(8 + 8 * count + 4 <= bound(count, 1), "{count}");
        }
        // Each part has one word, and all differ.
        assert_eq!(16 * (8 + 8) + 4, bound(16, 16));
    }

    fn of(values: &[f64]) -> u64 {
        let mut checksum = Checksum::new();
        checksum.add(values, f64::to_bits);
        checksum.finish()
    }

    #[test]
    fn a_changed_bit_a_swap_and_a_missing_word_change_the_checksum() {
        let values: Vec<f64> = (0..23).map(|value| 0.1 * f64::from(value)).collect();
        let original = of(&values);
        for index in 0..values.len() {
            for bit in 0..64 {
                let mut changed = values.clone();
                changed[index] = f64::from_bits(changed[index].to_bits() ^ (1 << bit));
                assert_ne!(of(&changed), original, "bit {bit} of word {index}");
            }
            let mut swapped = values.clone();
            swapped.swap(index, (index + 4) % values.len());
            assert_ne!(of(&swapped), original, "word {index}");
        }
        assert_ne!(of(&values[..22]), original);
        assert_ne!(Checksum::of_bytes(b"one byte more\0"), Checksum::of_bytes(b"one byte more"));
    }
}
