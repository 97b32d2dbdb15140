//! Decisions from bytes.

use arbitrary::Unstructured;

use super::mutate::Random;

/// A source of decisions. When its bytes are used up, every decision is the first alternative.
pub struct Bytes<'b>(Unstructured<'b>);

impl<'b> Bytes<'b> {
    pub fn new(bytes: &'b [u8]) -> Self {
        Self(Unstructured::new(bytes))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns a number from 0 to `end - 1`, or 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0.choose_index(end).unwrap_or(0)
    }

    /// Returns `true` with a probability of 1 in `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == times - 1
    }

    pub fn either<T>(&mut self, first: T, second: T) -> T {
        if self.once_in(2) { first } else { second }
    }

    pub fn choose<'c, T: ?Sized>(&mut self, choices: &[&'c T]) -> &'c T {
        choices[self.below(choices.len())]
    }

    pub fn word(&mut self) -> u64 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// Returns a number: about half are ordinary, the others are extreme.
    pub fn number(&mut self) -> f64 {
        match self.below(24) {
            0..7 => self.fraction(),
            7..9 => self.below(7) as f64 - 3.0,
            9..11 => 10.0 * self.fraction(),
            11 => 1e-6,
            12 => f64::NAN,
            13 => f64::INFINITY,
            14 => f64::NEG_INFINITY,
            15 => 1e300,
            16 => -1e300,
            17 => 1e9,
            18 => 5e-324,
            19 => 1e-300,
            20 => -0.0,
            21 => 2_147_483_648.0,
            22 => -1e15,
            _ => f64::from_bits(self.word()),
        }
    }

    /// Returns an integer: zero, small or extreme.
    pub fn integer(&mut self) -> i32 {
        match self.below(8) {
            0..4 => self.below(9) as i32 - 2,
            4 => i32::MAX - self.below(2) as i32,
            5 => i32::MIN,
            6 => 1 << self.below(31),
            _ => self.word() as i32,
        }
    }

    /// Returns a number from -1 to 1.
    pub fn fraction(&mut self) -> f64 {
        self.below(2001) as f64 / 1000.0 - 1.0
    }

    pub fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }

    /// Returns a vector, mostly of the given length.
    pub fn vector(&mut self, length: usize) -> Vec<f64> {
        let length = if self.once_in(16) { self.below(length + 3) } else { length };
        // A few decisions apply to the whole vector, so that long vectors do not use up the bytes.
        let (first, other) = (self.number(), self.number());
        let at = self.below(length);
        (0..length).map(|index| if index == at { other } else { first }).collect()
    }

    /// Returns an index, mostly below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        match self.below(32) {
            31 => count + self.below(3),
            30 => usize::MAX - self.below(2),
            _ => self.below(count),
        }
    }
}

/// Returns the bytes of a seed.
pub(super) fn of_seed(seed: u64, salt: u64) -> Vec<u8> {
    // The streams of neighbouring seeds must not overlap.
    let mut random = Random(Random(seed ^ (salt << 56)).next());
    let words = 16 + random.next() % 64;
    (0..words).flat_map(|_| random.next().to_le_bytes()).collect()
}
