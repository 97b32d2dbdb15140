//! What can go wrong, and how it is told.

use std::fmt;
use std::path::PathBuf;

use crate::control::riccati::RiccatiError;
use crate::data::{Instability, Needs};
use crate::engine::Version;
use crate::id::Kind;
use crate::model::LostEdit;

/// The result of whatever can fail here.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything that can go wrong. The text of an error says what was wrong, where, and what would be right.
///
/// ```
/// use mujoco_safe::{Error, sample};
///
/// let model = sample::humanoid();
/// let error = model.joint("left_kne").unwrap_err();
/// assert!(matches!(&error, Error::NoSuchName { name, .. } if name == "left_kne"));
/// assert!(error.to_string().contains("did you mean 'left_knee'"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The engine raised an error (`mju_error`) in the middle of a call.
    ///
    /// A call that takes `&mut Data` poisons that data, because the engine may have left it half computed: further calls return
    /// [`Poisoned`](Self::Poisoned) until a [`reset`](crate::Data::reset). A call that takes `&Data`, such as
    /// [`Scene::select`](crate::Scene::select), only reads, so the data stays as it was and usable. A call on a model or a scene
    /// alone has no data to poison.
    #[error("the engine failed in {function}: {message}")]
    Engine {
        /// The C function.
        function: &'static str,
        /// The engine's own message.
        message: String,
    },

    /// A closure that the engine called panicked. The data is poisoned, as after [`Engine`](Self::Engine).
    #[error("the {callback} callback panicked: {message}")]
    Callback {
        /// Which of the [`Callbacks`](crate::Callbacks).
        callback: &'static str,
        /// What the panic said.
        message: String,
    },

    /// An earlier call with `&mut Data` ended in the engine with [`Engine`](Self::Engine), [`Callback`](Self::Callback),
    /// [`OutOfMemory`](Self::OutOfMemory) or [`Unstable`](Self::Unstable). The data may be half computed.
    ///
    /// [`reset`](crate::Data::reset), [`reset_to_key`](crate::Data::reset_to_key) and
    /// [`copy_from`](crate::Data::copy_from) a usable data make it usable again. Until then every call that computes
    /// from the data returns this error. The arrays can be read and written, so a program can save the state; they hold whatever the
    /// failed call left.
    #[error("this data is unusable since {failure}; reset it first")]
    Poisoned {
        /// Text of the error that poisoned the data.
        failure: String,
    },

    /// A state, a control or an acceleration is not a number, or is huge. The engine itself would silently reset the simulation,
    /// or its controls. [`Instability`] says when the data is poisoned.
    #[error(transparent)]
    Unstable(#[from] Instability),

    /// The Riccati equation of a regulator has no stabilising solution, or none that is accurate enough.
    #[error("there is no regulator: {0}")]
    Riccati(#[from] RiccatiError),

    /// A model file or text could not be compiled. The message is the engine's, whole, with the line where it knows one.
    #[error("cannot load {source_name}: {message}")]
    Load {
        /// The file, or the name that was given to the text.
        source_name: String,
        /// What the engine's compiler says.
        message: String,
    },

    /// A binary model is damaged.
    #[error("{source_name} is not a valid binary model: {reason}")]
    InvalidBinary {
        /// The file, or "the bytes given".
        source_name: String,
        /// What is wrong, and where.
        reason: String,
    },

    /// The engine could not write a model.
    #[error("cannot save to {path}: {reason}")]
    Save {
        /// The file that was to be written.
        path: PathBuf,
        /// Why not.
        reason: String,
    },

    /// XML cannot carry some values of the model: the text that the engine writes loads as another model. Nothing was
    /// written.
    #[error(
        "{path} is not written, because XML would lose these values of the model: {}; save a binary model, or accept the loss with SaveXmlOptions",
        lost(fields)
    )]
    XmlLosesEdits {
        /// The file that was to be written.
        path: PathBuf,
        /// The fields whose values differ in the reloaded model.
        fields: Vec<LostEdit>,
    },

    /// A recording of frames failed.
    #[error("cannot record {path}: {reason}")]
    Recording {
        /// Output path of the recording.
        path: PathBuf,
        /// Cause of the failure, and a remedy if there is one.
        reason: String,
    },

    /// A file could not be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },

    /// There is no element of this name.
    #[error("there is no {kind} named '{name}'{}", names(name, known))]
    NoSuchName {
        /// What kind of element was looked for.
        kind: Kind,
        /// The name that was given.
        name: String,
        /// All names that there are.
        known: Vec<String>,
    },

    /// The engine's struct has no field of this name.
    #[error("mj{structure} has no field '{name}'{}", proposals(near))]
    NoSuchField {
        /// The struct, without `mj`.
        structure: &'static str,
        /// The name that was given.
        name: String,
        /// Names that are like it, the nearest first.
        near: Vec<String>,
    },

    /// There is no element of this index.
    #[error("there is no {kind} {index}: the model has {count}, counted from 0")]
    NoSuchIndex {
        /// What kind of element was looked for.
        kind: Kind,
        /// The index that was given.
        index: usize,
        /// How many there are.
        count: usize,
    },

    /// A vector or matrix has the wrong shape.
    #[error("{what} has shape {}, but must have {}", shape(*found), shape(*expected))]
    Shape {
        /// Which argument, and of which function.
        what: &'static str,
        /// Rows and columns that it must have; a vector has one column.
        expected: (usize, usize),
        /// Rows and columns that it has.
        found: (usize, usize),
    },

    /// A value is outside of what is allowed.
    #[error("{what} is {value}, but must be {expected}")]
    Invalid {
        /// What was to be set.
        what: String,
        /// The value that was given.
        value: String,
        /// What is allowed.
        expected: String,
    },

    /// The call needs quantities that have not been computed for the present model and state.
    #[error("{call} needs {needs}, which have not been computed {}", needs.remedy())]
    NotComputed {
        /// The call that was made.
        call: &'static str,
        /// What it needs.
        needs: Needs,
    },

    /// Two objects belong to models that were loaded separately.
    #[error("{what} belongs to another model")]
    OtherModel {
        /// Which argument.
        what: &'static str,
    },

    /// The model's XML cannot be saved any more.
    #[error(
        "the engine keeps the XML of the last loaded model only, and another one was loaded since: save before loading the next, or save as a binary model"
    )]
    XmlReplaced,

    /// The engine's XML compiler was interrupted while it held its lock, and would wait for ever.
    #[error("an earlier error has left the engine's XML compiler locked for the rest of this process: {cause}")]
    LoaderLocked {
        /// That error.
        cause: String,
    },

    /// What was asked for is not possible with this model.
    #[error("{0}")]
    Unsupported(String),

    /// A scene has not enough room for everything that is to be shown.
    #[error("the scene has room for {room} {what}, and there are more to show; the rest is left out")]
    SceneFull {
        /// What is left out: geoms or lights.
        what: &'static str,
        /// How many there is room for.
        room: usize,
    },

    /// The engine could not allocate memory. A call that takes `&mut Data` poisons it, as with [`Engine`](Self::Engine).
    #[error("the engine is out of memory in {function}")]
    OutOfMemory {
        /// The C function.
        function: &'static str,
    },

    /// The library that is running is not the one that this crate was built against.
    #[error(
        "this program was built against MuJoCo {built}, but runs with {running}, whose structures differ: rebuild it, or install {built}"
    )]
    EngineVersion {
        /// The version of the headers.
        built: Version,
        /// The version of the library.
        running: Version,
    },
}

impl Error {
    /// A value that is outside of what is allowed.
    pub(crate) fn invalid(what: impl Into<String>, value: impl fmt::Display, expected: impl Into<String>) -> Self {
        Self::Invalid { what: what.into(), value: value.to_string(), expected: expected.into() }
    }

    /// A check of a vector's length.
    #[inline]
    pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<()> {
        Self::check_shape(what, (found, 1), (expected, 1))
    }

    /// A check of a matrix's shape.
    #[inline]
    pub(crate) fn check_shape(what: &'static str, found: (usize, usize), expected: (usize, usize)) -> Result<()> {
        if found == expected { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }

    pub(crate) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::File { path, source }
    }
}

/// Lists the fields that XML loses.
fn lost(fields: &[LostEdit]) -> String {
    fields.iter().map(LostEdit::to_string).collect::<Vec<_>>().join(", ")
}

/// A vector's shape is its length.
fn shape((rows, columns): (usize, usize)) -> String {
    if columns == 1 { format!("({rows})") } else { format!("({rows}, {columns})") }
}

/// The nearest name, if one is near, and the names that there are.
fn names(name: &str, known: &[String]) -> String {
    const SHOWN: usize = 40;
    let nearest = known.iter().map(|candidate| (distance(name, candidate), candidate)).min();
    let proposal = match nearest {
        Some((distance, candidate)) if is_near(distance, name) => format!(", did you mean '{candidate}'?"),
        _ => String::new(),
    };
    if known.is_empty() {
        return proposal + " (none of this kind has a name)";
    }
    let list = known.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    let more = match known.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{proposal} (there are: {list}{more})")
}

/// The names that differ little from `name`, or have it in them, or are in it: the nearest first, and not many.
pub(crate) fn near_names<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<String> {
    const SHOWN: usize = 8;
    let mut near: Vec<(usize, &str)> = known
        .map(|candidate| (distance(name, candidate), candidate))
        .filter(|&(distance, candidate)| {
            is_near(distance, name) || (name.len() > 1 && (candidate.contains(name) || name.contains(candidate)))
        })
        .collect();
    near.sort_by_key(|&(distance, _)| distance);
    near.into_iter().take(SHOWN).map(|(_, candidate)| candidate.to_owned()).collect()
}

/// Whether an edit distance is that of a slip.
fn is_near(distance: usize, name: &str) -> bool {
    distance <= 1 + name.len() / 3
}

/// The end of an error that knows names that are near.
fn proposals(near: &[String]) -> String {
    if near.is_empty() { String::new() } else { format!(", did you mean '{}'?", near.join("', '")) }
}

/// Levenshtein's edit distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{distance, names, near_names};

    #[test]
    fn edit_distance_counts_insertions_deletions_and_replacements() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("same", "same"), 0);
    }

    #[test]
    fn a_far_name_is_not_proposed_and_a_long_list_is_cut() {
        let known: Vec<String> = (0..50).map(|index| format!("element_{index}")).collect();
        let text = names("zzz", &known);
        assert!(!text.contains("did you mean"), "{text}");
        assert!(text.contains("and 10 more"), "{text}");
    }
    #[test]
    fn near_names_are_slips_and_parts_the_nearest_first() {
        let known = ["qpos", "qvel", "xpos", "map.znear", "nstack", "maxuse_stack"];
        let near = |name| near_names(name, known.into_iter());
        assert_eq!(near("qpso"), ["qpos"]);
        assert_eq!(near("znear"), ["map.znear"]);
        assert_eq!(near("stack"), ["nstack", "maxuse_stack"]);
        assert_eq!(near("something else"), [""; 0]);
    }
}
