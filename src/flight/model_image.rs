//! Models as bytes: a binary model, and the bytes in which an edited copy differs.

use std::sync::Arc;

use super::format::{Block, Invalid, Reader};

/// Number of bytes that are compared at a time.
const WORD: usize = 8;

/// Binary model, stored as the difference from another one of the same length.
pub(super) struct ModelImage {
    pub(super) base: Arc<[u8]>,
    /// Runs of bytes that differ: offset, length, bytes.
    pub(super) edit: Vec<u8>,
}

impl ModelImage {
    /// Stores a model. `base` is another one, which need not be similar.
    pub(super) fn new(bytes: Vec<u8>, base: Option<&Arc<[u8]>>) -> Self {
        let edit = base.filter(|base| base.len() == bytes.len()).map(|base| (base, difference(&bytes, base)));
        match edit {
            Some((base, edit)) if edit.len() <= bytes.len() / 2 => Self { base: base.clone(), edit },
            _ => Self { base: bytes.into(), edit: Vec::new() },
        }
    }

    /// Returns the binary model.
    pub(super) fn bytes(&self) -> Result<Vec<u8>, Invalid> {
        let mut bytes = self.base.to_vec();
        let mut reader = Reader::new(&self.edit);
        while !reader.is_at_end() {
            let offset = usize::try_from(reader.u64()?).unwrap_or(usize::MAX);
            let run = reader.block("a run of an edited model")?;
            let length = bytes.len();
            let target = offset.checked_add(run.len()).and_then(|end| bytes.get_mut(offset..end));
            let target = target.ok_or_else(|| {
                reader.invalid(format!("an edit at {offset} of {} bytes of a model of {length} bytes", run.len()))
            })?;
            target.copy_from_slice(run);
        }
        Ok(bytes)
    }
}

fn difference(new: &[u8], old: &[u8]) -> Vec<u8> {
    let (mut edit, mut start) = (Vec::new(), None);
    let words = new.chunks(WORD).zip(old.chunks(WORD)).map(|(new, old)| new != old);
    for (word, differs) in words.chain([false]).enumerate() {
        match (differs, start) {
            (true, None) => start = Some(word * WORD),
            (false, Some(first)) => {
                edit.extend_from_slice(&(first as u64).to_le_bytes());
                edit.put_block(&new[first..new.len().min(word * WORD)]);
                start = None;
            }
            _ => {}
        }
    }
    edit
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::ModelImage;

    #[test]
    fn an_edited_copy_is_stored_as_its_difference() {
        let base: Arc<[u8]> = (0..1003_u32).map(|byte| byte as u8).collect();
        for changed in [Vec::<usize>::new(), vec![0], vec![7, 8, 500], vec![1000, 1002], vec![990, 1001]] {
            let mut bytes = base.to_vec();
            for &index in &changed {
                bytes[index] ^= 0x55;
            }
            let image = ModelImage::new(bytes.clone(), Some(&base));
            assert!(Arc::ptr_eq(&image.base, &base) && image.edit.len() <= 24 * changed.len());
            assert_eq!(image.bytes().unwrap(), bytes);
        }
        for other in [vec![1; 1003], vec![1; 5]] {
            let image = ModelImage::new(other.clone(), Some(&base));
            assert_eq!((&*image.base, image.bytes().unwrap()), (&other[..], other.clone()));
        }
    }

    #[test]
    fn an_edit_beyond_the_model_is_an_error() {
        let mut image = ModelImage::new(vec![0; 100], None);
        for (offset, length) in [(97_u64, 4_u64), (u64::MAX, 4), (0, u64::MAX), (0, 5)] {
            image.edit = [&offset.to_le_bytes()[..], &length.to_le_bytes()[..], &[1; 4]].concat();
            assert!(image.bytes().is_err(), "{offset} {length}");
        }
    }
}
