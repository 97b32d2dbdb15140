//! Values that differ between two vectors, as runs of words, and a checksum.
//!
//! In memory and in files, a run is a word with the index of its first value and the number of
//! values, 32 bits each, and the values.

/// End of a list of runs. No run has this word.
pub(super) const END: f64 = f64::from_bits(u64::MAX);

/// Returns a bound of the number of words of the runs of `count` words with their end. Words that
/// are compared in several parts have no common runs.
pub(super) fn bound(count: usize) -> usize {
    2 * count + 1
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
    let find = |from: usize, differs: bool| {
        let mut words = new[from..].iter().zip(&old[from..]);
        words.position(|(new, old)| (new.to_bits() != old.to_bits()) == differs).map(|count| from + count)
    };
    let mut place = 0;
    while let Some(start) = find(place, true) {
        let end = find(start, false).unwrap_or(new.len());
        each(start, &new[start..end]);
        place = end;
    }
}

/// Run of values of a vector.
pub(super) struct Run<'w> {
    start: usize,
    values: &'w [f64],
}

impl Run<'_> {
    /// Sets these values of a vector.
    pub(super) fn set(&self, vector: &mut [f64]) {
        vector[self.start..][..self.values.len()].copy_from_slice(self.values);
    }

    /// Returns `true` if the run has all values of a vector of this length.
    pub(super) fn is_whole(&self, length: usize) -> bool {
        self.values.len() == length
    }
}

/// Appends a run.
#[inline]
pub(super) fn put_run(to: &mut Vec<f64>, start: usize, values: &[f64]) {
    to.push(f64::from_bits((start as u64) << 32 | values.len() as u64));
    to.extend_from_slice(values);
}

/// Returns the next run of words of unknown origin. `None` if it is incomplete or exceeds a vector
/// of `length` values.
pub(super) fn take_run<'w>(words: &mut &'w [f64], length: usize) -> Option<Run<'w>> {
    let header = words.split_off_first()?.to_bits();
    let (start, count) = ((header >> 32) as usize, header as u32 as usize);
    let values = words.split_off(..count)?;
    (start + count <= length).then_some(Run { start, values })
}

/// Returns the runs up to the end of their list, as [`take_run`] does.
pub(super) fn take_runs<'w>(words: &mut &'w [f64], length: usize) -> Option<Vec<Run<'w>>> {
    let mut runs = Vec::new();
    while words.first()?.to_bits() != END.to_bits() {
        runs.push(take_run(words, length)?);
    }
    words.split_off_first();
    Some(runs)
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
    use super::{Checksum, END, bound, put_run, runs, take_runs};

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
    fn runs_are_read_as_they_were_written_and_within_the_bound() {
        let all = |length: usize| vec![1.0; length];
        let every_other = |length: usize| (0..length).map(|index| f64::from(index % 2 == 0)).collect();
        for count in [1_usize, 2, 17, 64] {
            for new in [all(count), every_other(count)] {
                // As one part, and as parts of one word.
                for part in [count, 1] {
                    let (mut words, mut start) = (Vec::new(), 0);
                    for values in new.chunks(part) {
                        runs(values, &vec![0.0; part], |of, run| put_run(&mut words, start + of, run));
                        start += part;
                    }
                    words.push(END);
                    assert!(words.len() <= bound(count), "{count}");
                    let (mut rest, mut read) = (&words[..], vec![0.0; count]);
                    take_runs(&mut rest, count).unwrap().iter().for_each(|run| run.set(&mut read));
                    assert!(rest.is_empty() && read == new, "{read:?}");
                    assert!(take_runs(&mut &words[..words.len() - 1], count).is_none());
                    assert!(take_runs(&mut &words[..], (count - 1) & !1).is_none());
                }
            }
        }
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
