//! NumPy archives (`.npz`) of named arrays of any shape, which Python reads with `numpy.load`.
//!
//! [`Trajectory::save_npz`](crate::Trajectory::save_npz) and
//! [`RolloutResult::save_npz`](crate::rollout::RolloutResult::save_npz) write such files. [`save`]
//! writes any other results:
//!
//! ```
//! use mujoco_safe::npz::{self, Array};
//! use mujoco_safe::{Data, sample};
//!
//! // The poses of all bodies of the humanoid during a fall.
//! let mut data = Data::new(sample::humanoid())?;
//! let (nstep, nbody) = (50, data.model().nbody());
//! let (mut time, mut xpos) = (Vec::new(), Vec::new());
//! for _ in 0..nstep {
//!     data.forward()?;
//!     time.push(data.time());
//!     xpos.extend_from_slice(data.xpos().as_flattened());
//!     data.step()?;
//! }
//! let path = std::env::temp_dir().join("mujoco_safe_fall.npz");
//! npz::save(&path, &[
//!     Array::new("time", &[nstep], &time),
//!     Array::new("xpos", &[nstep, nbody, 3], &xpos),
//!     Array::new("mass", &[nbody], data.model().body_mass()),
//! ])?;
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! ```python
//! fall = numpy.load("mujoco_safe_fall.npz")
//! fall["xpos"][:, 1, 2]  # the height of body 1
//! ```
//!
//! Requires the feature `npz`.

mod element;
pub(crate) mod read;

use std::collections::HashSet;
use std::fmt;
use std::io::{self, Seek, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

pub use self::element::Element;
use self::element::Values;
use crate::error::{Error, InvalidKind, Result};
use crate::file;

/// Start of every array: the magic string and version 1.0 of the format.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// Alignment of the values within a file, bytes.
const ALIGNMENT: usize = 64;

/// Largest number of dimensions that every version of NumPy supports.
const MOST_DIMENSIONS: usize = 32;
/// Largest length of a name, bytes. File systems allow 255 for the name and `.npy`.
const LONGEST_NAME: usize = 251;
/// Characters that a file name must not contain, on some system.
const RESERVED: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// Array of an archive: a name, a shape, and values in row-major order. Borrows the name and the
/// values.
#[derive(Clone)]
pub struct Array<'a> {
    name: &'a str,
    shape: Vec<usize>,
    values: Values<'a>,
}

impl<'a> Array<'a> {
    /// Creates an array from its values in row-major order, of one of the types that implement
    /// [`Element`]. An empty shape means a single number. [`save`] checks the name and the shape.
    pub fn new<T: Element>(name: &'a str, shape: &[usize], values: &'a [T]) -> Self {
        Self { name, shape: shape.to_vec(), values: T::values(values) }
    }

    /// Returns the shape as a Python tuple.
    fn tuple(&self) -> String {
        match &self.shape[..] {
            [length] => format!("({length},)"),
            shape => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
        }
    }

    fn check_name(&self) -> Result<()> {
        let name = self.name;
        let is_file_name = !name.contains(|character: char| character.is_control() || RESERVED.contains(&character));
        if (1..=LONGEST_NAME).contains(&name.len()) && is_file_name && name.strip_suffix(".npy").is_none() {
            return Ok(());
        }
        let reserved = RESERVED.iter().collect::<String>();
        Err(Error::invalid(
            InvalidKind::Text,
            "the name of an array",
            format!("{name:?}"),
            format!(
                "a file name without the ending .npy: 1 to {LONGEST_NAME} bytes, no control characters, none of {reserved}"
            ),
        ))
    }

    fn check_shape(&self) -> Result<()> {
        let Self { name, shape, values } = self;
        if shape.len() > MOST_DIMENSIONS {
            let what = format!("the number of dimensions of the array '{name}'");
            return Err(Error::out_of_range(what, shape.len(), format!("at most {MOST_DIMENSIONS}")));
        }
        let expected = shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length));
        if expected == Some(values.len()) {
            return Ok(());
        }
        Err(Error::out_of_range(
            format!("the number of values of the array '{name}' of shape {}", self.tuple()),
            values.len(),
            expected
                .map_or_else(|| "the product of the shape, which is too large".to_owned(), |count| count.to_string()),
        ))
    }

    /// Writes the array in the NumPy format: a header and the values.
    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let (descr, shape) = (self.values.descr(), self.tuple());
        let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        // Magic string, length of the header, header, and newline.
        let length = MAGIC.len() + 2 + header.len() + 1;
        header.extend(std::iter::repeat_n(' ', length.next_multiple_of(ALIGNMENT) - length));
        header.push('\n');
        let length = u16::try_from(header.len()).map_err(io::Error::other)?;
        out.write_all(MAGIC)?;
        out.write_all(&length.to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        self.values.write(out)
    }
}

impl fmt::Debug for Array<'_> {
    /// Writes the name, the type and the shape.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Array '{}': {} {}", self.name, self.values.descr(), self.tuple())
    }
}

/// Writes arrays to a NumPy archive (`.npz`), uncompressed like `numpy.savez`. The [module](self)
/// has an example.
///
/// # Errors
///
/// [`Error::Invalid`] if a name occurs twice or is not a file name, if the values of an array do
/// not fill its shape, or if an array has more than 32 dimensions; nothing is written then.
/// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
///
/// ```
/// use mujoco_safe::npz::{self, Array};
///
/// let error = npz::save("unwritten.npz", &[Array::new("pairs", &[3, 2], &[1.0, 2.0, 3.0])]).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "the number of values of the array 'pairs' of shape (3, 2) is 3, but must be 6"
/// );
/// ```
#[doc(alias = "savez")]
pub fn save(path: impl AsRef<Path>, arrays: &[Array<'_>]) -> Result<()> {
    let mut names = HashSet::new();
    for array in arrays {
        array.check_name()?;
        array.check_shape()?;
        if !names.insert(array.name) {
            return Err(Error::invalid(
                InvalidKind::Duplicate,
                "the name of an array",
                format!("{:?} twice", array.name),
                "unique",
            ));
        }
    }
    file::replace(path.as_ref(), |out| write(arrays, out))
}

fn write(arrays: &[Array<'_>], out: &mut (impl Write + Seek)) -> io::Result<()> {
    let mut archive = ZipWriter::new(out);
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
    for array in arrays {
        archive.start_file(format!("{}.npy", array.name), options)?;
        array.write(&mut archive)?;
    }
    archive.finish()?;
    Ok(())
}
