//! Models as words: a binary model, and the words in which an edited copy differs.

use std::sync::Arc;

use super::change;

/// Binary model, stored as the difference from another one of the same length.
pub(super) struct ModelImage {
    /// Words of the other model. The last one is filled with zeros.
    pub(super) base: Arc<[f64]>,
    /// Runs of words that differ.
    pub(super) edit: Vec<f64>,
    /// Number of bytes.
    pub(super) length: usize,
}

impl ModelImage {
    /// Stores a model. `base` is another one, which need not be similar.
    pub(super) fn new(bytes: &[u8], base: Option<&Arc<[f64]>>) -> Self {
        let word = |bytes: &[u8]| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            f64::from_le_bytes(word)
        };
        let (words, length): (Vec<f64>, usize) = (bytes.chunks(8).map(word).collect(), bytes.len());
        if let Some(base) = base.filter(|base| base.len() == words.len()) {
            let mut edit = Vec::new();
            change::runs(&words, base, |start, run| change::put_run(&mut edit, start, run));
            if edit.len() <= words.len() / 2 {
                return Self { base: base.clone(), edit, length };
            }
        }
        Self { base: words.into(), edit: Vec::new(), length }
    }
}

/// Returns the binary model of an image. `None` if the parts contradict each other.
pub(super) fn bytes(base: &[f64], mut edit: &[f64], length: usize) -> Option<Vec<u8>> {
    let mut words = base.to_vec();
    while !edit.is_empty() {
        change::take_run(&mut edit, words.len())?.set(&mut words);
    }
    let mut bytes: Vec<u8> = words.into_iter().flat_map(f64::to_le_bytes).collect();
    bytes.truncate(length);
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{ModelImage, bytes};

    #[test]
    fn an_edited_copy_is_stored_as_its_difference() {
        let base: Vec<u8> = (0..1003_u32).map(|byte| byte as u8).collect();
        let first = ModelImage::new(&base, None);
        for changed in [Vec::<usize>::new(), vec![0], vec![7, 8, 500], vec![1000, 1002], vec![990, 1001]] {
            let mut edited = base.clone();
            for &index in &changed {
                edited[index] ^= 0x55;
            }
            let image = ModelImage::new(&edited, Some(&first.base));
            assert!(Arc::ptr_eq(&image.base, &first.base) && image.edit.len() <= 2 * changed.len());
            assert_eq!(bytes(&image.base, &image.edit, image.length).unwrap(), edited);
        }
        for other in [vec![1; 1003], vec![1; 5]] {
            let image = ModelImage::new(&other, Some(&first.base));
            assert!(image.edit.is_empty());
            assert_eq!(bytes(&image.base, &image.edit, image.length).unwrap(), other);
        }
    }

    #[test]
    fn an_edit_beyond_the_model_is_an_error() {
        for (start, count) in [(97, 4), (u64::MAX >> 32, 4), (0, u64::from(u32::MAX)), (0, 5)] {
            let edit = [&[f64::from_bits(start << 32 | count)][..], &[1.0; 4]].concat();
            assert_eq!(bytes(&[0.0; 100], &edit, 800), None, "{start} {count}");
        }
    }
}
