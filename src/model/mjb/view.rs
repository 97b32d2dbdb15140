//! Zero-copy view of the bytes of a file as header, sizes, option structs and arrays.
//!
//! A [`View`] exists only if the length of the file is exactly the sum of its sizes, so every array
//! lies within the bytes.

use mujoco_sys::{mjOption, mjStatistic, mjVisual};

use super::invalid::Invalid;
use super::layout::{Array, Element, Extent, Field, MODEL_ARRAYS, SIZES, Size};

/// The integers at the start of the file: a magic number, and parameters of the engine's build
/// (bytes in an `mjtNum`, the numbers of size fields and of arrays in `mjModel`, the version since
/// 3.0).
const HEADER: &[(&str, i32)] = &[
    ("magic number", 54321),
    ("size of mjtNum", 8),
    ("number of sizes", SIZES as i32),
    #[cfg(engine_since = "3.5.0")]
    ("version", mujoco_sys::mjVERSION_HEADER as i32),
    ("number of arrays", MODEL_ARRAYS.len() as i32),
];

/// Integer of a size.
#[cfg(not(engine_since = "3.5.0"))]
pub(super) type SizeInt = i32;
#[cfg(engine_since = "3.5.0")]
pub(super) type SizeInt = i64;

/// Sizes that may be -1, which means that the engine chooses the size.
const AUTOMATIC: &[&str] = if cfg!(engine_since = "3.5.0") { &["njmax", "nconmax"] } else { &[] };

/// Sizes that may exceed an `int`, and their limit, which is beyond any machine's memory.
const WIDE: &[&str] = if cfg!(engine_since = "3.5.0") { &["ntexdata", "narena", "nbuffer"] } else { &[] };
const LARGEST_WIDE: usize = 1 << 48;

const INT: usize = size_of::<i32>();
pub(super) const SIZES_AT: usize = HEADER.len() * INT;
pub(super) const SIZE_BYTES: usize = size_of::<SizeInt>();
pub(super) const OPTION_AT: usize = SIZES_AT + SIZES * SIZE_BYTES;
const ARRAYS_AT: usize = OPTION_AT + size_of::<mjOption>() + size_of::<mjVisual>() + size_of::<mjStatistic>();

pub(super) struct View<'a> {
    bytes: &'a [u8],
    sizes: [usize; SIZES],
    starts: Vec<usize>,
}

impl<'a> View<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, Invalid> {
        let sizes = read_sizes(bytes)?;
        let (starts, end) = layout(&sizes);
        if end != bytes.len() as u128 {
            let length = bytes.len();
            return Err(Invalid::file(format!("the file has {length} bytes; its sizes require {end}")));
        }
        Ok(Self { bytes, sizes, starts })
    }

    pub(super) fn size(&self, size: Size) -> usize {
        self.sizes[size.0]
    }

    pub(super) fn sizes(&self) -> &[usize; SIZES] {
        &self.sizes
    }

    /// Returns the number of elements in an array.
    pub(super) fn len<T>(&self, field: Field<T>) -> usize {
        extent(field.array().rows, &self.sizes) as usize * extent(field.array().columns, &self.sizes) as usize
    }

    /// Returns an element.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    pub(super) fn get<T: Element>(&self, field: Field<T>, index: usize) -> T {
        debug_assert!(index < self.len(field), "Bug: {}[{index}] is out of bounds", field.name());
        read(self.bytes, self.starts[field.index] + index * T::BYTES)
    }

    pub(super) fn values<T: Element>(&self, field: Field<T>) -> impl DoubleEndedIterator<Item = T> + ExactSizeIterator {
        (0..self.len(field)).map(move |i| self.get(field, i))
    }

    /// Returns an array of bytes.
    pub(super) fn slice(&self, field: Field<u8>) -> &'a [u8] {
        let start = self.starts[field.index];
        &self.bytes[start..start + self.len(field)]
    }

    /// Returns the offset of an element in the file.
    #[cfg(test)]
    pub(super) fn position<T: Element>(&self, field: Field<T>, index: usize) -> usize {
        self.starts[field.index] + index * T::BYTES
    }

    /// Returns the number at `offset` in the file's `mjOption`.
    pub(super) fn option<T: Element>(&self, offset: usize) -> T {
        read(self.bytes, OPTION_AT + offset)
    }
}

/// Reads the sizes, after checking that the header belongs to this engine version.
fn read_sizes(bytes: &[u8]) -> Result<[usize; SIZES], Invalid> {
    if bytes.len() < ARRAYS_AT {
        let length = bytes.len();
        return Err(Invalid::file(format!(
            "the file has {length} bytes; the header, sizes and options of a model need {ARRAYS_AT}"
        )));
    }
    for (i, (name, expected)) in HEADER.iter().enumerate() {
        let value = read::<i32>(bytes, i * INT);
        if value != *expected {
            return Err(Invalid::scalar(
                &format!("the header's {name}"),
                value,
                format!("MuJoCo {} writes {expected}", crate::version::built_against()),
            ));
        }
    }
    let mut sizes = [0; SIZES];
    for (i, size) in sizes.iter_mut().enumerate() {
        let value = read::<SizeInt>(bytes, SIZES_AT + i * SIZE_BYTES);
        let name = Size(i).name();
        if value == -1 && AUTOMATIC.contains(&name) {
            continue;
        }
        *size = usize::try_from(value).map_err(|_| Invalid::scalar(name, value, "a size must not be negative"))?;
        let largest = if WIDE.contains(&name) { LARGEST_WIDE } else { i32::MAX as usize };
        if *size > largest {
            return Err(Invalid::scalar(name, value, format!("it must be at most {largest}")));
        }
    }
    Ok(sizes)
}

/// Computes the start of each array and the end of the last one.
fn layout(sizes: &[usize; SIZES]) -> (Vec<usize>, u128) {
    let mut starts = Vec::with_capacity(MODEL_ARRAYS.len());
    let mut end = ARRAYS_AT as u128;
    for array in MODEL_ARRAYS {
        // If this truncates, the length of the file cannot equal `end`, and the file is rejected.
        starts.push(end as usize);
        end += array_bytes(array, sizes);
    }
    (starts, end)
}

fn read<T: Element>(bytes: &[u8], at: usize) -> T {
    T::read(&bytes[at..at + T::BYTES])
}

pub(super) fn extent(extent: Extent, sizes: &[usize; SIZES]) -> u128 {
    extent.times as u128 * extent.size.map_or(1, |size| sizes[size.0] as u128)
}

/// Returns the length of an array in bytes. Sizes have at most 49 bits, so the product cannot
/// overflow 128 bits.
pub(super) fn array_bytes(array: &Array, sizes: &[usize; SIZES]) -> u128 {
    extent(array.rows, sizes) * extent(array.columns, sizes) * array.element as u128
}
