//! Ring buffer of bytes, addressed by positions that only grow.

use std::ops::Range;

pub(super) struct Ring {
    bytes: Box<[u8]>,
    /// Number of bytes that were ever written.
    end: u64,
}

impl Ring {
    pub(super) fn new(capacity: usize) -> Self {
        // Memory of zeros would be mapped in the steps that write to it first.
        Self { bytes: vec![1; capacity].into(), end: 0 }
    }

    pub(super) fn capacity(&self) -> u64 {
        self.bytes.len() as u64
    }

    pub(super) fn end(&self) -> u64 {
        self.end
    }

    /// Removes the bytes after a position.
    pub(super) fn rewind(&mut self, end: u64) {
        debug_assert!(end <= self.end, "Bug: a ring is rewound to its future");
        self.end = end;
    }

    /// Appends bytes, over the oldest ones.
    #[inline]
    pub(super) fn put(&mut self, bytes: &[u8]) {
        let place = (self.end % self.capacity()) as usize;
        self.end += bytes.len() as u64;
        let (first, rest) = bytes.split_at(bytes.len().min(self.bytes.len() - place));
        self.bytes[place..][..first.len()].copy_from_slice(first);
        self.bytes[..rest.len()].copy_from_slice(rest);
    }

    /// Appends numbers.
    #[inline]
    pub(super) fn put_numbers(&mut self, values: &[f64]) {
        let (place, length) = ((self.end % self.capacity()) as usize, 8 * values.len());
        match self.bytes.get_mut(place..place + length) {
            Some(target) => {
                let (words, _) = target.as_chunks_mut::<8>();
                words.iter_mut().zip(values).for_each(|(word, value)| *word = value.to_le_bytes());
                self.end += length as u64;
            }
            None => values.iter().for_each(|value| self.put(&value.to_le_bytes())),
        }
    }

    /// Appends a copy of bytes that are still there to `target`.
    pub(super) fn copy(&self, range: Range<u64>, target: &mut Vec<u8>) {
        assert!(range.end <= self.end && self.end - range.start <= self.capacity(), "Bug: the bytes were overwritten");
        let (place, length) = ((range.start % self.capacity()) as usize, (range.end - range.start) as usize);
        let first = length.min(self.bytes.len() - place);
        target.extend_from_slice(&self.bytes[place..][..first]);
        target.extend_from_slice(&self.bytes[..length - first]);
    }
}

#[cfg(test)]
mod tests {
    use super::Ring;

    #[test]
    fn the_newest_bytes_are_kept_in_order() {
        let mut ring = Ring::new(50);
        let mut all = Vec::new();
        for round in 0..40_u8 {
            let bytes: Vec<u8> = (0..round % 7).map(|index| round.wrapping_mul(10).wrapping_add(index)).collect();
            ring.put(&bytes);
            all.extend(bytes);
            let values = [f64::from(round), -1.5];
            ring.put_numbers(&values);
            all.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            assert_eq!(ring.end(), all.len() as u64);
            for length in 0..all.len().min(50) {
                let mut copy = Vec::new();
                ring.copy((all.len() - length) as u64..all.len() as u64, &mut copy);
                assert_eq!(copy, all[all.len() - length..]);
            }
        }
    }
}
