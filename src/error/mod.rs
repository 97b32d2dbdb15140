//! The error type of the crate, and the conversion of panics into messages.

mod check;
mod instability;
mod outcome;
mod suggestion;

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

pub use self::instability::{Instability, UnstableField};
pub use self::outcome::Outcome;
pub(crate) use self::suggestion::{near_names, nearest_name};
use crate::kind::Kind;
use crate::stage::MissingResults;
use crate::version::{Version, built_against};

/// Implements `Debug` of an error type by its `Display`, because `unwrap` and a `main` that returns
/// an error print `Debug`.
macro_rules! debug_as_display {
    ($error:ty) => {
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(self, f)
            }
        }
    };
}
pub(crate) use debug_as_display;

/// Result of the fallible functions of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Error of this crate. Its text states the problem, its place, and the values that are allowed.
///
/// ```
/// use mujoco_safe::{Error, sample};
///
/// let model = sample::humanoid();
/// let error = model.joint("left_kne").unwrap_err();
/// assert!(matches!(&error, Error::NoSuchName { name, .. } if name == "left_kne"));
/// assert!(error.to_string().contains("did you mean 'left_knee'"));
/// ```
///
/// `Debug` prints the same text as `Display`, so `unwrap` and a `main` that returns a `Result` show
/// it too.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The engine raised an error (`mju_error`) during a call.
    ///
    /// A call that takes `&mut Data` poisons that data, because the engine may have left it half
    /// computed: further calls return [`Poisoned`](Self::Poisoned) until a
    /// [`reset`](crate::Data::reset). A call that takes `&Data`, such as
    /// [`Scene::select`](crate::Scene::select), only reads, so the data is unchanged and usable. A
    /// call on a model or a scene alone has no data to poison.
    #[error("the engine failed in {function}: {message}")]
    Engine {
        /// The C function.
        function: &'static str,
        /// Message of the engine.
        message: String,
    },

    /// A closure that the engine called panicked. The data is poisoned, as after
    /// [`Engine`](Self::Engine).
    #[error("the {callback} callback panicked: {message}")]
    Callback {
        /// Method of [`Callbacks`](crate::callback::Callbacks) that set the closure, without
        /// `with_`.
        callback: &'static str,
        /// Message of the panic.
        message: String,
    },

    /// Code of the caller panicked in a thread of this crate.
    #[error("{what} panicked: {message}")]
    Panicked {
        /// The object whose code panicked.
        what: &'static str,
        /// Message of the panic.
        message: String,
    },

    /// An earlier call with `&mut Data` failed with [`Engine`](Self::Engine),
    /// [`Callback`](Self::Callback), [`OutOfMemory`](Self::OutOfMemory) or
    /// [`Unstable`](Self::Unstable). The data may be half computed.
    ///
    /// [`reset`](crate::Data::reset), [`reset_to_key`](crate::Data::reset_to_key), and
    /// [`copy_from`](crate::Data::copy_from) with a usable source make it usable again. Until then
    /// every call that computes from the data returns this error. The arrays can be read and
    /// written, so a program can save the state; they hold the values that the failed call left.
    #[error("this data is unusable since {failure}; reset it first")]
    Poisoned {
        /// Text of the error that poisoned the data.
        failure: String,
    },

    /// A state, a control or an acceleration is NaN or beyond ±10¹⁰. The engine itself would
    /// silently reset the simulation or its controls. See [`Instability`] for the cases that poison
    /// the data.
    #[error(transparent)]
    Unstable(#[from] Instability),

    /// A solver that uses the simulation found no solution. [`solver`](Self::solver) returns the
    /// typed cause.
    ///
    /// Regulators return this error with a [`RiccatiError`](crate::control::riccati::RiccatiError)
    /// if the Riccati equation has no stabilising solution, or none of the required accuracy.
    #[error("there is no regulator: {0}")]
    Solver(#[source] Box<dyn std::error::Error + Send + Sync>),

    /// A model file or text could not be compiled. The message is the complete one of the engine,
    /// with the line number if known.
    #[error("cannot load {source_name}: {message}")]
    Load {
        /// Path of the file, or name of the text.
        source_name: String,
        /// Message of the engine's compiler.
        message: String,
    },

    /// A binary model is damaged.
    #[error("{source_name} is not a valid binary model: {reason}")]
    InvalidBinary {
        /// Path of the file, or "the given buffer".
        source_name: String,
        /// The defect and its place.
        reason: String,
    },

    /// A file of a [flight recorder](crate::flight) is damaged.
    #[error("{source_name} is not a valid recording: {reason}")]
    InvalidRecording {
        /// Path of the file, or "the given buffer".
        source_name: String,
        /// The defect and its place.
        reason: String,
    },

    /// A call of a [recording](crate::flight::Recording) has another result here than when it was
    /// recorded, so the simulation cannot continue as recorded.
    #[error("recorded call {call} cannot be repeated: {reason}")]
    NotRepeated {
        /// Number of the call since the creation of the recorder.
        call: u64,
        /// The first values that differ, and possible causes.
        reason: String,
    },

    /// The engine could not write a model, or a recording of frames failed.
    #[error("cannot save to {path}: {reason}")]
    Save {
        /// The file to write.
        path: PathBuf,
        /// Cause of the failure, and a remedy if there is one.
        reason: String,
    },

    /// XML cannot represent some values of the model: the text that the engine writes loads as a
    /// different model. Nothing was written.
    #[error(
        "{path} is not written, because XML would lose these values of the model: {}; save a binary model, or accept the loss with SaveXmlOptions",
        lost(fields)
    )]
    XmlLosesEdits {
        /// The file to write.
        path: PathBuf,
        /// The fields whose values differ in the reloaded model.
        fields: Vec<UnsavedField>,
    },

    /// A file could not be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },

    /// An address could not be served.
    #[error("cannot serve a page at {address}: {source}")]
    Serve {
        /// Address of the server.
        address: String,
        /// Error of the operating system.
        source: std::io::Error,
    },

    /// The model has no element with this name.
    #[error(
        "there is no {kind} named '{name}'{}{}",
        suggestion::of_other_kinds(name, others),
        suggestion::similar_and_known(name, known)
    )]
    NoSuchName {
        /// Kind of the element.
        kind: Kind,
        /// The unknown name.
        name: String,
        /// All names of this kind.
        known: Vec<String>,
        /// The other kinds that have an element of this name.
        others: Vec<Kind>,
    },

    /// The engine's struct has no field with this name.
    #[error("mj{structure} has no field '{name}'{}", suggestion::field(*owner, near))]
    NoSuchField {
        /// Name of the struct without `mj`.
        structure: &'static str,
        /// The unknown name.
        name: String,
        /// Similar names, most similar first.
        near: Vec<String>,
        /// Another struct that has a field with this name, without `mj`.
        owner: Option<&'static str>,
    },

    /// The model has no element with this index.
    #[error("there is no {kind} {index}: the model has {count}, counted from 0")]
    NoSuchIndex {
        /// Kind of the element.
        kind: Kind,
        /// The invalid index.
        index: usize,
        /// Number of elements of this kind.
        count: usize,
    },

    /// A vector or matrix has the wrong shape.
    #[error("{what} has shape {}, but must have {}", shape(*found), shape(*expected))]
    Shape {
        /// The argument and its function.
        what: &'static str,
        /// Required rows and columns; a vector has one column.
        expected: (usize, usize),
        /// Actual rows and columns.
        found: (usize, usize),
    },

    /// A value is not allowed. `kind` is for programs, the texts are for people.
    #[error("{what} is {value}, but must be {expected}")]
    Invalid {
        /// Kind of the mistake.
        kind: InvalidKind,
        /// The argument or field.
        what: String,
        /// The invalid value.
        value: String,
        /// Description of the allowed values.
        expected: String,
    },

    /// The call needs quantities that have not been computed for the present model and state.
    #[error("{call} needs {missing}, which have not been computed {}", missing.remedy())]
    NotComputed {
        /// The call.
        call: &'static str,
        /// Results that the call needs.
        missing: MissingResults,
    },

    /// Two objects belong to models that were loaded separately.
    #[error("{what} belongs to another model")]
    OtherModel {
        /// The argument.
        what: &'static str,
    },

    /// The XML of the model can no longer be saved, because the engine keeps only the XML of the
    /// last loaded model.
    #[error(
        "the engine keeps the XML of the last loaded model only, and another one was loaded since: save before loading the next, or save as a binary model"
    )]
    XmlReplaced,

    /// The engine's XML compiler was interrupted while it held its lock. Another call would
    /// deadlock.
    #[error("an earlier error has left the engine's XML compiler locked for the rest of this process: {cause}")]
    LoaderLocked {
        /// Text of the error that interrupted the compiler.
        cause: String,
    },

    /// The operation is not possible with this model or this engine.
    #[error("{0}")]
    Unsupported(String),

    /// A scene has too little capacity for all geoms or lights.
    #[error("the scene has capacity for only {capacity} {what}; the rest is omitted")]
    SceneFull {
        /// Kind of the omitted objects: geoms or lights.
        what: &'static str,
        /// Capacity of the scene.
        capacity: usize,
    },

    /// The engine could not allocate memory. A call that takes `&mut Data` poisons it, as with
    /// [`Engine`](Self::Engine).
    #[error("the engine is out of memory in {function}")]
    OutOfMemory {
        /// The C function.
        function: &'static str,
    },

    /// The engine that is loaded at run time has another version than the headers that this crate
    /// was built against.
    #[error(
        "this program was built against MuJoCo {built}, but runs with {running}, whose structures differ: rebuild it, or install {built}"
    )]
    EngineVersion {
        /// Version of the headers.
        built: Version,
        /// Version of the loaded library.
        running: Version,
    },
}

debug_as_display!(Error);

impl Error {
    /// Returns the cause of a [`Solver`](Self::Solver) error, if it is an `E`.
    ///
    /// ```
    /// use mujoco_safe::control::riccati::RiccatiError;
    /// use mujoco_safe::{Data, Lqr, LqrWeights, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let weights = LqrWeights::diagonal(&[1.0; 4], &[-1.0]);
    /// let error = Lqr::at_present_state(&mut data, &weights).unwrap_err();
    /// assert!(matches!(error.solver(), Some(RiccatiError::ControlCostNotPositive { .. })));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn solver<E: std::error::Error + 'static>(&self) -> Option<&E> {
        match self {
            Self::Solver(cause) => cause.downcast_ref(),
            _ => None,
        }
    }

    /// Returns the error about a value that is not allowed.
    pub(crate) fn invalid(
        kind: InvalidKind,
        what: impl Into<String>,
        value: impl fmt::Display,
        expected: impl Into<String>,
    ) -> Self {
        Self::Invalid { kind, what: what.into(), value: value.to_string(), expected: expected.into() }
    }

    /// Returns the error about a number outside of its range.
    pub(crate) fn out_of_range(what: impl Into<String>, value: impl fmt::Display, expected: impl Into<String>) -> Self {
        Self::invalid(InvalidKind::OutOfRange, what, value, expected)
    }

    /// Returns the error about a number that is infinite or NaN.
    pub(crate) fn not_finite(what: impl Into<String>, value: impl fmt::Display) -> Self {
        Self::invalid(InvalidKind::NotFinite, what, value, "finite")
    }

    /// Returns the error about something that only other versions of the engine have.
    pub(crate) fn lacks(what: &str, versions: &str) -> Self {
        let present = built_against();
        Self::Unsupported(format!("MuJoCo {present} does not have {what}; MuJoCo {versions} does"))
    }

    /// Checks that the engine has a constant. `what` describes its meaning.
    pub(crate) fn check_constant(constant: &str, what: impl fmt::Display) -> Result<()> {
        mujoco_sys::absent::versions(constant).map_or(Ok(()), |versions| Err(Self::lacks(&what.to_string(), versions)))
    }

    /// Returns a function that adds a path to an error of the operating system.
    pub(crate) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::File { path, source }
    }
}

/// Kind of an [`Error::Invalid`].
///
/// ```
/// use mujoco_safe::{Error, InvalidKind, math, sample};
///
/// let error = sample::humanoid().edit().set_timestep(-0.001).unwrap_err();
/// assert!(matches!(error, Error::Invalid { kind: InvalidKind::OutOfRange, .. }));
/// let error = math::euler2quat(&[0.0; 3], "xyw").unwrap_err();
/// assert!(matches!(error, Error::Invalid { kind: InvalidKind::Text, .. }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum InvalidKind {
    /// A number is infinite or NaN. Not every finite number need be allowed.
    NotFinite,
    /// A number, a size or an interval is outside of its range. NaN is outside of each.
    OutOfRange,
    /// A text has the wrong format: a NUL byte, not a number, an unknown letter.
    Text,
    /// A name is none of the known ones. For names of elements see [`Error::NoSuchName`].
    Unknown,
    /// A name or a parameter is given twice.
    Duplicate,
    /// An element or an object does not fit the call: a geom without a height field, the root of a
    /// spec for a removal.
    Unsuitable,
}

/// A field of a model that the model's XML cannot represent.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct UnsavedField {
    /// The field in the engine's spelling, for example `body_mass`, `opt.timestep` or `nconmax`.
    pub field: String,
    /// Names of the elements whose values differ, or the index of an element without a name. Empty
    /// for a size and for the fields of options, statistics and visualiser settings.
    pub elements: Vec<String>,
}

impl fmt::Display for UnsavedField {
    /// Writes the field, and in parentheses the first elements.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 4;
        f.write_str(&self.field)?;
        if self.elements.is_empty() {
            return Ok(());
        }
        let shown: Vec<&str> = self.elements.iter().take(SHOWN).map(String::as_str).collect();
        write!(f, " ({}", shown.join(", "))?;
        match self.elements.len().saturating_sub(SHOWN) {
            0 => f.write_str(")"),
            more => write!(f, " and {more} more)"),
        }
    }
}

/// Lists the fields that XML loses.
fn lost(fields: &[UnsavedField]) -> String {
    fields.iter().map(UnsavedField::to_string).collect::<Vec<_>>().join(", ")
}

/// Formats a shape. The shape of a vector is its length.
fn shape((rows, columns): (usize, usize)) -> String {
    if columns == 1 { format!("({rows})") } else { format!("({rows}, {columns})") }
}

/// Runs a closure and turns a panic into its message.
///
/// State that the closure was changing may be inconsistent after a panic; the caller must repair or
/// discard it.
pub(crate) fn catch_panic<T>(run: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).map_err(|payload| {
        let message = match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
            (Some(text), _) => (*text).to_owned(),
            (None, Some(text)) => text.clone(),
            (None, None) => "(no message)".to_owned(),
        };
        // The payload has a type of the caller's code, whose destructor may panic again.
        std::mem::forget(payload);
        message
    })
}

#[cfg(test)]
mod tests {
    use super::catch_panic;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(catch_panic(|| 1), Ok(1));
        assert_eq!(catch_panic(|| panic!("literal")), Err::<(), _>("literal".to_owned()));
        assert_eq!(catch_panic(|| panic!("formatted {}", 1)), Err::<(), _>("formatted 1".to_owned()));
        assert_eq!(catch_panic(|| std::panic::panic_any(1)), Err::<(), _>("(no message)".to_owned()));
    }
}
