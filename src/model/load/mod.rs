//! Loading of models from XML and from the binary format.

mod compiler;
mod misspelling;
mod options;
mod package;

#[cfg(feature = "viewer")]
use std::cell::RefCell;
use std::ffi::CString;
use std::path::Path;
use std::ptr::{self, NonNull};

use mujoco_sys::guard;

use self::compiler::VirtualFiles;
pub(super) use self::compiler::{XmlState, path_c_string, with_sufficient_stack};
pub use self::options::LoadOptions;
use self::package::Resolved;
#[cfg(feature = "viewer")]
use super::xml_guard::FoundFiles;
use super::xml_guard::{self, Files};
use super::{DisableFlags, Model};
use crate::data::{Data, Warning};
use crate::engine;
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::messages::{self, collecting_warnings};
use crate::{ffi, file};

/// File name of the main text for the engine's compiler.
pub(crate) const TEXT: &str = "(main).xml";

/// Name of a text from memory in error messages.
const FROM_MEMORY: &str = "the given XML";

/// Name of a binary model from memory in error messages.
const BINARY_FROM_MEMORY: &str = "the given buffer";

/// Function that runs the engine's compiler on a file. The last argument is the name in error
/// messages.
type Compile<'a> = dyn FnMut(&CString, &VirtualFiles, &str) -> Result<Model> + 'a;

/// # Loading
impl Model {
    /// Loads a model from an MJCF or URDF file. Paths in it (includes, meshes, textures, height
    /// fields) are relative to it.
    ///
    /// The engine's own compiler reads the file and is not safe for all malicious inputs; see
    /// [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, [`Error::Load`] with the compiler's message if
    /// it is not a valid model.
    ///
    /// ```
    /// use mujoco_safe::{Error, Model};
    ///
    /// let error = Model::from_xml_path("no/such/model.xml").unwrap_err();
    /// assert!(matches!(error, Error::File { .. }));
    /// ```
    #[doc(alias = "mj_loadXML")]
    #[doc(alias = "load_model")]
    pub fn from_xml_path(path: impl AsRef<Path>) -> Result<Self> {
        Self::from_xml_path_with(path, &LoadOptions::default())
    }

    /// Loads a model from an MJCF or URDF file with [`LoadOptions`]: some of the files that it
    /// names can be in memory, and a URDF can name meshes by `package://` URIs.
    ///
    /// The file itself is read from disk. The compiler searches for the files that it names first
    /// in memory, by the part of their names after the last slash and ignoring case, and then on
    /// disk, relative to the file.
    ///
    /// For untrusted texts and files see [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path`](Self::from_xml_path), and [`Error::Invalid`] for the files in
    /// memory as for [`from_xml_str_with`](Self::from_xml_str_with).
    ///
    /// ```
    /// use mujoco_safe::{LoadOptions, Model};
    ///
    /// let folder = tempfile::tempdir()?; // cargo add tempfile
    /// let path = folder.path().join("scene.xml");
    /// std::fs::write(&path, r#"<mujoco><include file="ball.xml"/></mujoco>"#)?;
    ///
    /// let ball = |size: f64| format!(r#"<mujoco><worldbody><geom size="{size}"/></worldbody></mujoco>"#);
    /// std::fs::write(folder.path().join("ball.xml"), ball(0.1))?;
    /// assert_eq!(Model::from_xml_path(&path)?.geom_size()[0][0], 0.1);
    ///
    /// let large = ball(0.2);
    /// let options = LoadOptions::default().with_file("ball.xml", large.as_bytes());
    /// assert_eq!(Model::from_xml_path_with(&path, &options)?.geom_size()[0][0], 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "mj_loadXML")]
    #[doc(alias = "from_xml_path")]
    pub fn from_xml_path_with(path: impl AsRef<Path>, options: &LoadOptions<'_>) -> Result<Self> {
        let path = path.as_ref();
        // Compile the text that was checked, even if the file changes in the meantime. The text
        // gets another name in the same directory, so that the compiler cannot confuse it with
        // files of the same name in other directories.
        let text = file::read_regular(path).map_err(Error::file(path))?;
        Self::from_text(&path.display().to_string(), &path.with_file_name(TEXT), &text, options)
    }

    /// Returns the files that a model's text names and that exist, such as includes and meshes,
    /// until its first error. Files of `package://` URIs are not among them.
    #[cfg(feature = "viewer")]
    pub(crate) fn files_of_xml(path: &Path) -> FoundFiles {
        let found = RefCell::default();
        if let Ok(text) = file::read_regular(path) {
            let directory = xml_guard::directory(xml_guard::path_bytes(path));
            let files = Files { memory: &[], directory, found: Some(&found) };
            // A load reports the error.
            let _ = xml_guard::check("", &text, &files);
        }
        found.into_inner()
    }

    /// Loads a model from MJCF or URDF text.
    ///
    /// The engine's own compiler reads the text. On some inputs the compiler of 2.2.2 crashes, does
    /// not terminate, or accesses memory out of bounds. The following inputs can be recognised in
    /// the text and the files that it names, and are rejected before compilation:
    ///
    /// * recursive includes, models that are assets of themselves, more than a million copies of
    ///   elements, elements nested more than 400 deep, special files (pipes, devices, `/proc`),
    /// * in URDF: joints of an unknown type, links that are their own ancestors, chains of more
    ///   than 400 joints,
    /// * oversized textures, height fields, keyframes, user data, custom data and skins of
    ///   composites, more than 32 766 bodies, and more than 13 377 degrees of freedom,
    /// * rangefinders of cameras with more than 4 million rays, sensors and delays with more than
    ///   20 million values and samples, and large integers in an attribute that this crate does not
    ///   know,
    /// * damaged meshes, skins and height fields: a size that contradicts the header, faces with
    ///   nonexistent vertices, vertices that are not finite,
    /// * flexes of tetrahedra without a border, flexes with lists of contradictory lengths,
    /// * a muscle whose length range does not converge, a fixed tendon with the same joint twice,
    ///   adhesion with room for fewer than 100 constraints, a rangefinder together with a height
    ///   field of more rows than columns.
    ///
    /// The included texts pass the same checks, and since MuJoCo 3.2 so do the models that are
    /// assets (`<model>`), which must be MJCF or URDF.
    ///
    /// The compiled model then passes the checks of a binary model, see
    /// [`from_binary`](Self::from_binary).
    ///
    /// Compilation can still take minutes (thousands of bodies) or much memory (a PNG that
    /// decompresses to more than its header states), and a file on disk can change between the
    /// check and the compilation. Compile untrusted models in a separate process with limits on
    /// time and memory.
    ///
    /// # Errors
    ///
    /// [`Error::Load`] with the compiler's complete message, which includes the line if the
    /// compiler reports one. If the text is a path instead of XML, the message names the function
    /// that loads files.
    ///
    /// ```
    /// use mujoco_safe::Model;
    ///
    /// let error = Model::from_xml_str("<mujoco>\n  <worldbod/>\n</mujoco>").unwrap_err();
    /// assert!(error.to_string().contains("line 2"), "{error}");
    /// ```
    #[doc(alias = "from_xml_string")]
    pub fn from_xml_str(xml: &str) -> Result<Self> {
        Self::from_xml_str_with(xml, &LoadOptions::default())
    }

    /// Loads a model from MJCF or URDF text with [`LoadOptions`]: files that the text names can be
    /// in memory, and a URDF can name meshes by `package://` URIs.
    ///
    /// For untrusted texts and files see [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_str`](Self::from_xml_str), and [`Error::Invalid`] for a file without a
    /// name or content, with the same name as another file, with a name of 1000 bytes or more, or
    /// of 2 GiB or more, and before 3.2 for more than 1998 files.
    ///
    /// ```
    /// use mujoco_safe::{LoadOptions, Model};
    ///
    /// let ball = br#"<mujoco><worldbody><geom name="ball" size="0.1"/></worldbody></mujoco>"#;
    /// let model = Model::from_xml_str_with(
    ///     r#"<mujoco><include file="ball.xml"/></mujoco>"#,
    ///     &LoadOptions::default().with_file("ball.xml", ball),
    /// )?;
    /// assert_eq!(model.ngeom(), 1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_loadXML")]
    pub fn from_xml_str_with(xml: &str, options: &LoadOptions<'_>) -> Result<Self> {
        if let Some(message) = path_instead_of_xml(xml) {
            return Err(Error::Load { source_name: FROM_MEMORY.to_owned(), message });
        }
        Self::from_text(FROM_MEMORY, TEXT.as_ref(), xml.as_bytes(), options)
    }

    /// Compiles a text as if it were the contents of the file `path`, whose file name must be
    /// [`TEXT`].
    pub(crate) fn from_text(source_name: &str, path: &Path, text: &[u8], options: &LoadOptions<'_>) -> Result<Self> {
        let Resolved { text, files, unresolved } =
            package::resolve(text, &options.packages, &options.files, path.parent().unwrap_or(Path::new("")));
        let files: Vec<(&str, &[u8])> = (options.files.iter().copied())
            .chain(files.iter().map(|(name, content)| (&name[..], &content[..])))
            .collect();
        let model = Self::from_text_by(source_name, path, &text, &files, &mut Self::compile).map_err(|error| {
            // The engine discards visual meshes by default, so an unresolved one is the cause only
            // if the message names it.
            let Error::Load { source_name, mut message } = error else { return error };
            if let Some((_, reason)) = unresolved.iter().find(|(name, _)| !name.is_empty() && message.contains(name)) {
                message = format!("{message}; {reason}");
            } else if let Some(meant) = misspelling::suggestion(&message) {
                message = format!("{}; did you mean '{meant}'?", message.trim_end());
            }
            Error::Load { source_name, message }
        })?;
        // Log after the lock is released, because a logger is user code and may load a model
        // itself.
        for warning in &model.warnings {
            log::warn!(target: messages::LOG_TARGET, "{source_name}: {warning}");
        }
        Ok(model)
    }

    /// Checks a text and compiles it with `compile`, which acquires the lock of [`XmlState`] or
    /// already holds it.
    pub(super) fn from_text_by(
        source_name: &str,
        path: &Path,
        text: &[u8],
        files: &[(&str, &[u8])],
        compile: &mut Compile<'_>,
    ) -> Result<Self> {
        engine::ready()?;
        if text.is_empty() {
            return Err(Error::Load { source_name: source_name.to_owned(), message: "the text is empty".to_owned() });
        }
        let virtual_files = Self::in_memory(text, files)?;
        let memory: Vec<(&str, &[u8])> = std::iter::once((TEXT, text)).chain(files.iter().copied()).collect();
        let directory = xml_guard::directory(xml_guard::path_bytes(path));
        let sources = Files { memory: &memory, directory, found: None };
        let name = path_c_string(path)?;
        let simulations = xml_guard::check(source_name, text, &sources)?;
        if simulations.may_lack_room {
            let text = xml_guard::without_constraints(text);
            Self::check_variant(text, &name, files, source_name, compile, |model| model.check_room(source_name))?;
        }
        // Rejects a text for which the compiler's simulation of muscles would not terminate.
        if let Some(muscles) = simulations.muscles {
            let text = xml_guard::without_simulation(text);
            Self::check_variant(text, &name, files, source_name, compile, |mut model| {
                let checked = muscles.check(&mut model);
                checked.map_err(|message| Error::Load { source_name: source_name.to_owned(), message })
            })?;
        }
        compile(&name, &virtual_files, source_name)
    }

    /// Creates a virtual file system with a text and other files.
    fn in_memory(text: &[u8], files: &[(&str, &[u8])]) -> Result<VirtualFiles> {
        let mut virtual_files = VirtualFiles::new();
        virtual_files.add(TEXT, text)?;
        for (name, content) in files {
            virtual_files.add(name, content)?;
        }
        Ok(virtual_files)
    }

    /// Compiles a variant of a text, if there is one, and checks the result. The warnings of the
    /// check are the compiler's, or concern the variant only.
    fn check_variant(
        text: Option<Vec<u8>>,
        name: &CString,
        files: &[(&str, &[u8])],
        source_name: &str,
        compile: &mut Compile<'_>,
        check: impl FnOnce(Self) -> Result<()>,
    ) -> Result<()> {
        let Some(text) = text else { return Ok(()) };
        let model = compile(name, &Self::in_memory(&text, files)?, source_name)?;
        collecting_warnings(|| check(model)).0
    }

    /// Rejects a model, compiled without constraints, for which the engine would read constraints
    /// without room in the compiler's test step. Takes the step with them.
    fn check_room(mut self, source_name: &str) -> Result<()> {
        self.raw_mut().opt.disableflags &= !(DisableFlags::CONSTRAINT.bits() as i32);
        let mut data = Data::new(self)?;
        // The compiler reports other errors.
        let _ = data.step();
        if data.warning(Warning::ConstraintFull).number == 0 {
            return Ok(());
        }
        let message = "the memory in <size> is too small for the constraints of the initial state".to_owned();
        Err(Error::Load { source_name: source_name.to_owned(), message })
    }

    /// Loads a binary model (MJB) that [`save_binary`](Self::save_binary) or the engine wrote.
    ///
    /// The engine trusts such a file; this function does not. It checks every size, address, id and
    /// enum before it passes the file to the engine, so a damaged or malicious file results in an
    /// error.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, [`Error::InvalidBinary`] if it is not a complete
    /// and consistent model. [`Error::Unsupported`] with engines other than 2.2.2 and 3.5.0, for
    /// which the rules of a safe file are not known, and with 3.5.0 for a model with flexes,
    /// plugins, signed distance fields or tactile sensors, or with the option `multiccd` and a mesh
    /// in whose convex hull a polygon has more than 8 vertices; see
    /// [`from_binary_unchecked`](Self::from_binary_unchecked).
    #[doc(alias = "mj_loadModel")]
    pub fn from_binary_path(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = file::read_regular(path).map_err(Error::file(path))?;
        Self::from_binary_named(&bytes, &path.display().to_string())
    }

    /// Loads a binary model from memory. Otherwise the same as
    /// [`from_binary_path`](Self::from_binary_path).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidBinary`] if the bytes are not a complete and consistent model,
    /// [`Error::Unsupported`] as for [`from_binary_path`](Self::from_binary_path).
    ///
    #[cfg_attr(not(validates_binaries), doc = "```ignore")]
    #[cfg_attr(validates_binaries, doc = "```")]
    /// use mujoco_safe::{Error, Model, sample};
    ///
    /// let bytes = sample::cartpole().to_binary()?;
    /// assert_eq!(Model::from_binary(&bytes)?.nv(), 2);
    /// assert!(matches!(Model::from_binary(&bytes[..100]), Err(Error::InvalidBinary { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mj_loadModel")]
    pub fn from_binary(bytes: &[u8]) -> Result<Self> {
        Self::from_binary_named(bytes, BINARY_FROM_MEMORY)
    }

    /// Loads a binary model from memory without a check of its bytes, with every engine.
    ///
    /// With engines other than 2.2.2 and 3.5.0 this is the only way to load a binary model. It
    /// skips the XML compiler, which takes long for large models.
    ///
    /// # Safety
    ///
    /// The bytes are those that [`to_binary`](Self::to_binary), [`save_binary`](Self::save_binary)
    /// or `mj_saveModel` wrote with this version of the engine, for a model that the engine
    /// compiled. The engine reads out of bounds if a size, an address or an id is wrong.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidBinary`] if the engine rejects the bytes, such as bytes of another version,
    /// or if the model has a feature that this crate does not support.
    ///
    /// ```
    /// use mujoco_safe::{Model, sample};
    ///
    /// let bytes = sample::cartpole().to_binary()?;
    /// // SAFETY: the bytes of a compiled model, of the same version of the engine.
    /// let model = unsafe { Model::from_binary_unchecked(&bytes)? };
    /// assert_eq!(model.nv(), 2);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_loadModel")]
    pub unsafe fn from_binary_unchecked(bytes: &[u8]) -> Result<Self> {
        engine::ready()?;
        // SAFETY: the caller's promise.
        let model = unsafe { Self::load_binary(bytes, BINARY_FROM_MEMORY)? };
        let reason = model.validate().err();
        reason.map_or(Ok(model), |reason| Err(invalid_binary(BINARY_FROM_MEMORY, reason)))
    }

    fn from_binary_named(bytes: &[u8], source_name: &str) -> Result<Self> {
        engine::ready()?;
        check_binary(bytes, source_name)?;
        // SAFETY: the bytes were validated.
        let model = unsafe { Self::load_binary(bytes, source_name)? };
        #[cfg(all(validates_binaries, engine_since = "3.5.0"))]
        let model = model.with_checked_features(source_name)?;
        Ok(model)
    }

    /// Checks conditions of the process, and records which options must not be enabled.
    #[cfg(all(validates_binaries, engine_since = "3.5.0"))]
    fn with_checked_features(mut self, source_name: &str) -> Result<Self> {
        self.validate_features().map_err(|reason| invalid_binary(source_name, reason))?;
        self.has_unsafe_polygons = self.find_unsafe_polygons();
        Ok(self)
    }

    /// Loads a binary model by the engine.
    ///
    /// # Safety
    ///
    /// The sizes, addresses, ids and enums in the bytes are those of a model.
    unsafe fn load_binary(bytes: &[u8], source_name: &str) -> Result<Self> {
        let name = "model.mjb";
        let mut files = VirtualFiles::new();
        files.add(name, bytes)?;
        let name = ffi::c_string("the name of the binary model", name)?;
        let mut loaded = ptr::null_mut();
        let (result, warnings) = collecting_warnings(|| {
            // SAFETY: a valid name and table. By the caller's promise the engine reads only within
            // the bytes.
            let status = unsafe { guard::mj_load_model(name.as_ptr(), files.as_ptr(), &raw mut loaded) };
            ffi::check_without_data("mj_loadModel", status)
        });
        result?;
        let raw = NonNull::new(loaded).ok_or_else(|| invalid_binary(source_name, warnings.join("; ")))?;
        // SAFETY: the engine allocated the model, nothing else owns it, and by the caller's promise
        // its contents are valid.
        Ok(unsafe { Self::from_raw(raw, Lineage::new(), warnings) })
    }
}

fn invalid_binary(source_name: &str, reason: String) -> Error {
    Error::InvalidBinary { source_name: source_name.to_owned(), reason }
}

/// Validates a binary model.
#[cfg(validates_binaries)]
fn check_binary(bytes: &[u8], source_name: &str) -> Result<()> {
    super::mjb::check(bytes).map_err(|error| {
        if error.is_unsupported() {
            let version = crate::version::built_against();
            return Error::Unsupported(format!(
                "binary models with {error} with MuJoCo {version}; load the XML, or a trusted file with the unsafe Model::from_binary_unchecked"
            ));
        }
        invalid_binary(source_name, error.to_string())
    })
}

/// Rejects a binary model: the rules by which a file is safe to load are known for 2.2.2 and 3.5.0
/// only.
#[cfg(not(validates_binaries))]
fn check_binary(_: &[u8], _: &str) -> Result<()> {
    let version = crate::version::built_against();
    Err(Error::Unsupported(format!(
        "binary models with MuJoCo {version}; load the XML, or a trusted file with the unsafe Model::from_binary_unchecked"
    )))
}

/// Returns the message for a text that is the path of a model file.
fn path_instead_of_xml(text: &str) -> Option<String> {
    let text = text.trim();
    if text.contains(['<', '\n']) {
        return None;
    }
    let function = match Path::new(text).extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "xml" | "mjcf" | "urdf" => "from_xml_path",
        "mjb" => "from_binary_path",
        _ => return None,
    };
    Some(format!("'{text}' is a path, not XML: load the file with Model::{function}"))
}
