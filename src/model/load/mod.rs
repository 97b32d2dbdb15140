//! Loading.

use std::ffi::{CString, c_int};
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::{Mutex, MutexGuard, PoisonError};

use mujoco_sys::{guard, stderr};

use super::length_range::Simulation;
use super::load_options::LoadOptions;
use super::package::{self, Resolved};
use super::text_check::{self, Files};
use super::virtual_files::VirtualFiles;
use super::{Model, mjb};
use crate::engine::{self, collecting_warnings};
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::{ffi, file};

/// The name under which a text is known to the engine's compiler.
pub(super) const TEXT: &str = "(main).xml";

/// What errors call that text.
const GIVEN: &str = "the XML given";

/// Runs the engine's compiler on a file, under its name in error messages.
type Compile<'a> = dyn FnMut(&CString, &VirtualFiles, &str) -> Result<Model> + 'a;

/// What the engine keeps of XML for the whole process: the tree of the last model, under a lock.
pub(super) struct XmlState {
    /// The model whose tree it is.
    pub(super) last: Option<Lineage>,
    /// The error that made the engine jump out while it held its lock. Entering it again would wait for ever.
    locked: Option<String>,
}

impl XmlState {
    /// Waits for other loads, as the engine would, and refuses where the engine would wait for ever.
    pub(super) fn enter() -> Result<MutexGuard<'static, Self>> {
        static STATE: Mutex<XmlState> = Mutex::new(XmlState { last: None, locked: None });
        let state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
        match &state.locked {
            Some(cause) => Err(Error::LoaderLocked { cause: cause.clone() }),
            None => Ok(state),
        }
    }

    /// The result of a call into the compiler, and a note of what it left behind: an engine error has jumped over the release
    /// of the lock. A C++ exception has released it.
    pub(super) fn leave(&mut self, function: &'static str, status: c_int) -> Result<()> {
        let result = ffi::check_without_data(function, status);
        if let Err(error) = &result
            && status == guard::ERROR
        {
            self.locked = Some(error.to_string());
        }
        result
    }
}

impl Model {
    /// Loads a model from an MJCF or URDF file. Files that it names (includes, meshes, textures, height fields) are looked
    /// for relative to it.
    ///
    /// The file is trusted as far as the engine's own compiler goes, which is not proof against every malicious text; see
    /// [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, [`Error::Load`] with the compiler's message if it is not a model.
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

    /// Loads a model from an MJCF or URDF file with [`LoadOptions`]: some of the files that it names can be in memory, and a URDF
    /// can name meshes by `package://` URIs. The file itself comes from disk. Files that it names are looked up in memory first,
    /// by the part of their names behind the last slash, in upper or lower case, and then on disk, relative to the file.
    ///
    /// For hostile texts and files see [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path`](Self::from_xml_path), and [`Error::Invalid`] for the files in memory as for
    /// [`from_xml_str_with`](Self::from_xml_str_with).
    ///
    /// ```
    /// use mujoco_safe::{LoadOptions, Model};
    ///
    /// let folder = tempfile::tempdir()?;
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
        // The text that was checked is the one that is compiled, even if the file changes: under another name in the same
        // directory, so that files of the same name in other directories are not mistaken for it.
        let text = file::read_regular(path).map_err(Error::file(path))?;
        Self::from_text(&path.display().to_string(), &path.with_file_name(TEXT), &text, options)
    }

    /// Loads a model from MJCF or URDF text.
    ///
    /// The engine's own compiler reads the text. The compiler of 2.2.2 crashes, runs without end, or accesses memory out of
    /// bounds on some inputs. Inputs that the text and the files that it names reveal are rejected before compilation:
    ///
    /// * includes that recurse, elements nested more than 400 deep, special files (pipes, devices, `/proc`),
    /// * in URDF: joints of an unknown type, links that are their own ancestors, chains of more than 400 joints,
    /// * oversized textures, height fields, keyframes, user and custom data and skins of composites, more than 32 766 bodies, and
    ///   more than 13 377 degrees of freedom,
    /// * damaged meshes, skins and height fields: a size that contradicts the header, faces with vertices that do not exist,
    ///   vertices that are not finite,
    /// * a muscle whose length range does not converge, a fixed tendon with the same joint twice, adhesion with room for fewer
    ///   than 100 constraints, a rangefinder together with a height field of more rows than columns.
    ///
    /// The compiled model then passes the checks of a binary model, see [`from_binary`](Self::from_binary).
    ///
    /// Compilation can still take minutes (thousands of bodies) or much memory (a PNG that decompresses to more than its header
    /// says), and a file on disk can change between the check and the compilation. Compile untrusted models in a separate process
    /// with limits on time and memory.
    ///
    /// # Errors
    ///
    /// [`Error::Load`] with the compiler's whole message, and the line where it knows one.
    ///
    /// ```
    /// use mujoco_safe::Model;
    ///
    /// let error = Model::from_xml_str("<mujoco>\n  <worldbod/>\n</mujoco>").unwrap_err();
    /// assert!(error.to_string().contains("line 2"), "{error}");
    /// ```
    pub fn from_xml_str(xml: &str) -> Result<Self> {
        Self::from_xml_str_with(xml, &LoadOptions::default())
    }

    /// Loads a model from MJCF or URDF text with [`LoadOptions`]: files that the text names can be in memory, and a URDF can name
    /// meshes by `package://` URIs.
    ///
    /// For hostile texts and files see [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_str`](Self::from_xml_str), and [`Error::Invalid`] for a file without a name or content, of the name of
    /// another one, with a name of 1000 bytes or more, or of 2 GiB or more, and for more than 1998 files.
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
        Self::from_text(GIVEN, TEXT.as_ref(), xml.as_bytes(), options)
    }

    /// Compiles a text as if it was in the file `path`, which it is to the compiler: its name must be [`TEXT`].
    fn from_text(source_name: &str, path: &Path, text: &[u8], options: &LoadOptions<'_>) -> Result<Self> {
        let Resolved { text, files, unresolved } = package::resolve(text, &options.packages, &options.files);
        let files: Vec<(&str, &[u8])> = (options.files.iter().copied())
            .chain(files.iter().map(|(name, content)| (&name[..], &content[..])))
            .collect();
        let model =
            Self::from_text_by(source_name, path, &text, &files, &mut Self::compile_quietly).map_err(|error| {
                // The engine discards visual meshes by default, so an unresolved one is the cause only if the message names it.
                let Error::Load { source_name, mut message } = error else { return error };
                if let Some((_, reason)) =
                    unresolved.iter().find(|(name, _)| !name.is_empty() && message.contains(name))
                {
                    message = format!("{message}; {reason}");
                }
                Error::Load { source_name, message }
            })?;
        // Not under the lock: a logger is the user's code, and may load a model, too.
        for warning in &model.warnings {
            log::warn!(target: engine::LOG_TARGET, "{source_name}: {warning}");
        }
        Ok(model)
    }

    /// Checks a text and runs the compiler on it by `compile`, which takes the lock of [`XmlState`] or already has it.
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
        let places = Files { memory: &memory, directory: text_check::directory(text_check::path_bytes(path)) };
        let name = path_c_string(path)?;
        if let Some(muscles) = text_check::check(source_name, text, &places)? {
            Self::try_muscles(&muscles, text, &name, files, source_name, compile)?;
        }
        compile(&name, &virtual_files, source_name)
    }

    /// A text and other files as the compiler takes them.
    fn in_memory(text: &[u8], files: &[(&str, &[u8])]) -> Result<VirtualFiles> {
        let mut virtual_files = VirtualFiles::new();
        virtual_files.add(TEXT, text)?;
        for (name, content) in files {
            virtual_files.add(name, content)?;
        }
        Ok(virtual_files)
    }

    /// Refuses a text in which the compiler's simulation of the muscles would not come to an end.
    fn try_muscles(
        muscles: &Simulation,
        text: &[u8],
        name: &CString,
        files: &[(&str, &[u8])],
        source_name: &str,
        compile: &mut Compile<'_>,
    ) -> Result<()> {
        let Some(text) = text_check::without_simulation(text) else { return Ok(()) };
        let mut model = compile(name, &Self::in_memory(&text, files)?, source_name)?;
        let (checked, _) = collecting_warnings(|| muscles.check(&mut model));
        checked.map_err(|message| Error::Load { source_name: source_name.to_owned(), message })
    }

    /// Loads a binary model (MJB) that [`save_binary`](Self::save_binary) or the engine wrote.
    ///
    /// The engine trusts such a file; this function does not. Every size, address, id and enum is checked before the engine
    /// sees the file, so a damaged or hostile one is an error.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, [`Error::InvalidBinary`] if it is not a whole and consistent model.
    #[doc(alias = "mj_loadModel")]
    pub fn from_binary_path(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = file::read_regular(path).map_err(Error::file(path))?;
        Self::from_binary_named(&bytes, &path.display().to_string())
    }

    /// As [`from_binary_path`](Self::from_binary_path), from memory.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidBinary`] if the bytes are not a whole and consistent model.
    ///
    /// ```
    /// use mujoco_safe::{Error, Model, sample};
    ///
    /// let bytes = sample::cartpole().to_binary()?;
    /// assert_eq!(Model::from_binary(&bytes)?.nv(), 2);
    /// assert!(matches!(Model::from_binary(&bytes[..100]), Err(Error::InvalidBinary { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn from_binary(bytes: &[u8]) -> Result<Self> {
        Self::from_binary_named(bytes, "the bytes given")
    }

    fn from_binary_named(bytes: &[u8], source_name: &str) -> Result<Self> {
        engine::ready()?;
        let invalid = |reason: String| Error::InvalidBinary { source_name: source_name.to_owned(), reason };
        mjb::check(bytes).map_err(|error| invalid(error.to_string()))?;
        let name = "model.mjb";
        let mut files = VirtualFiles::new();
        files.add(name, bytes)?;
        let name = ffi::c_string("the binary model's name", name)?;
        let mut loaded = ptr::null_mut();
        let (result, warnings) = collecting_warnings(|| {
            // SAFETY: a valid name and table. The bytes were validated, so what the engine reads by them stays inside.
            let status = unsafe { guard::mj_load_model(name.as_ptr(), files.as_ptr(), &raw mut loaded) };
            ffi::check_without_data("mj_loadModel", status)
        });
        result?;
        let raw = NonNull::new(loaded).ok_or_else(|| invalid(warnings.join("; ")))?;
        // SAFETY: the engine allocated it for us, and its content was validated.
        Ok(unsafe { Self::from_raw(raw, Lineage::new(), warnings) })
    }

    fn compile_quietly(name: &CString, files: &VirtualFiles, source_name: &str) -> Result<Self> {
        engine::ready()?;
        Self::compile_under(&mut *XmlState::enter()?, name, files, source_name)
    }

    /// Runs the compiler while the caller holds the lock.
    pub(super) fn compile_under(
        xml: &mut XmlState,
        name: &CString,
        files: &VirtualFiles,
        source_name: &str,
    ) -> Result<Self> {
        const MESSAGE: usize = 4096;
        // The engine replaces its tree before it returns a model, which may still be refused below.
        let last = xml.last.take();
        let mut message = [0; MESSAGE];
        let mut loaded = ptr::null_mut();
        let ((status, printed), mut warnings) = collecting_warnings(|| {
            stderr::captured(|| {
                // SAFETY: a valid name and table, a buffer of the given size, a place for the result.
                unsafe {
                    let (message, loaded) = (message.as_mut_ptr(), &raw mut loaded);
                    guard::mj_load_xml(name.as_ptr(), files.as_ptr(), message, MESSAGE as i32, loaded)
                }
            })
        });
        xml.leave("mj_loadXML", status)?;
        // The convex hull library prints the reason first, and then pages of numbers.
        warnings.extend(printed.lines().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned));
        // SAFETY: the engine ended the text in the buffer with NUL, or left it empty.
        let message = unsafe { ffi::text(message.as_ptr()) };
        let Some(raw) = NonNull::new(loaded) else {
            // The engine deletes what it could not compile, and keeps the tree that it had.
            xml.last = last;
            warnings.insert(0, message);
            return Err(Error::Load { source_name: source_name.to_owned(), message: warnings.join("; ") });
        };
        // Upon success the same buffer holds the compiler's warning, if there was one.
        if !message.is_empty() && !warnings.contains(&message) {
            warnings.push(message);
        }
        let lineage = Lineage::new();
        // SAFETY: the engine compiled it for us.
        let model = unsafe { Self::from_raw(raw, lineage, warnings) };
        model.validate().map_err(|reason| Error::Load {
            source_name: source_name.to_owned(),
            message: format!("the compiled model is invalid: {reason}"),
        })?;
        xml.last = Some(lineage);
        Ok(model)
    }
}

/// A path as the engine's C code takes it.
pub(super) fn path_c_string(path: &Path) -> Result<CString> {
    ffi::c_string("the path", text_check::path_bytes(path))
}
