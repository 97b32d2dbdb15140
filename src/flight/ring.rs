//! Ring buffer of bytes, addressed by positions that only grow. Its parts are contiguous.

use std::ops::Range;

pub(super) struct Ring {
    bytes: Box<[u8]>,
    /// Number of bytes that were ever written or left free.
    end: u64,
    /// Place of the next byte in `bytes`.
    place: usize,
}

impl Ring {
    pub(super) fn new(capacity: usize) -> Self {
        // Memory of zeros would be mapped in the steps that write to it first.
        Self { bytes: vec![1; capacity].into(), end: 0, place: 0 }
    }

    pub(super) fn capacity(&self) -> u64 {
        self.bytes.len() as u64
    }

    pub(super) fn end(&self) -> u64 {
        self.end
    }

    /// Returns `true` if this number of bytes fits before the end of the memory.
    #[inline]
    pub(super) fn has_room(&self, count: usize) -> bool {
        self.bytes.len() - self.place >= count
    }

    /// Leaves the rest of the memory free, so that the next part begins at its start.
    pub(super) fn wrap(&mut self) {
        self.end += (self.bytes.len() - self.place) as u64;
        self.place = 0;
    }

    /// Removes the bytes after a position.
    pub(super) fn rewind(&mut self, end: u64) {
        debug_assert!(end <= self.end, "Bug: a ring is rewound to its future");
        self.end = end;
        self.place = (end % self.capacity()) as usize;
    }

    /// Appends bytes, over the oldest ones. There must be [room](Self::has_room).
    #[inline]
    pub(super) fn put(&mut self, bytes: &[u8]) {
        self.bytes[self.place..][..bytes.len()].copy_from_slice(bytes);
        self.advance(bytes.len());
    }

    /// Appends numbers.
    #[inline]
    pub(super) fn put_numbers(&mut self, values: &[f64]) {
        let (words, _) = self.bytes[self.place..][..8 * values.len()].as_chunks_mut();
        words.iter_mut().zip(values).for_each(|(word, value)| *word = value.to_le_bytes());
        self.advance(8 * values.len());
    }

    #[inline]
    fn advance(&mut self, count: usize) {
        self.place += count;
        self.end += count as u64;
    }

    /// Returns a part whose bytes are still there.
    pub(super) fn part(&self, range: Range<u64>) -> &[u8] {
        assert!(range.end <= self.end && self.end - range.start <= self.capacity(), "Bug: the bytes were overwritten");
        let (place, length) = ((range.start % self.capacity()) as usize, (range.end - range.start) as usize);
        &self.bytes[place..][..length]
    }
}

#[cfg(test)]
mod tests {
    use super::Ring;

    #[test]
    fn the_newest_parts_are_kept() {
        let mut ring = Ring::new(100);
        let mut parts = Vec::new();
        for round in 0..200_u8 {
            let bytes: Vec<u8> = (0..round % 7).map(|index| round.wrapping_mul(10).wrapping_add(index)).collect();
            let values = [f64::from(round), -1.5];
            if !ring.has_room(bytes.len() + 16) {
                ring.wrap();
            }
            let start = ring.end();
            ring.put(&bytes);
            ring.put_numbers(&values);
            let written = [&bytes[..], &values[0].to_le_bytes(), &values[1].to_le_bytes()].concat();
            parts.push((start..ring.end(), written));
            let kept = parts.iter().filter(|(range, _)| ring.end() - range.start <= 100);
            assert!(kept.clone().count() >= parts.len().min(2));
            kept.for_each(|(range, written)| assert_eq!(ring.part(range.clone()), written));
        }
        let (range, _) = parts.pop().unwrap();
        ring.rewind(range.start);
        ring.put(&[7]);
        assert_eq!(ring.part(range.start..ring.end()), [7]);
    }
}
