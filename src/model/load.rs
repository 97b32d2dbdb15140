//! Loading.

use std::ffi::{CString, c_int};
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::{Mutex, MutexGuard, PoisonError};

use mujoco_sys::guard;

use super::length_range::Simulation;
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
        let result = ffi::check(function, status);
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
        Self::from_xml_path_with_files(path, &[])
    }

    /// Loads a model from an MJCF or URDF file, some of whose other files are in memory. The file itself comes from the disk. Those
    /// that it names are looked for in memory first, by their names without their folder, in upper or lower case, and then on
    /// the disk, relative to the file.
    ///
    /// What is true of hostile texts and files is in [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path`](Self::from_xml_path), and [`Error::Invalid`] for the files in memory as for
    /// [`from_xml_str_with_files`](Self::from_xml_str_with_files).
    ///
    /// ```
    /// use mujoco_safe::Model;
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
    /// let model = Model::from_xml_path_with_files(&path, &[("ball.xml", large.as_bytes())])?;
    /// assert_eq!(model.geom_size()[0][0], 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "mj_loadXML")]
    #[doc(alias = "mjVFS")]
    #[doc(alias = "from_xml_path")]
    pub fn from_xml_path_with_files(path: impl AsRef<Path>, files: &[(&str, &[u8])]) -> Result<Self> {
        let path = path.as_ref();
        // What was looked at is what is compiled, whatever becomes of the file: under another name in the same directory, so that
        // files of its own name in other directories are not mistaken for it.
        let text = file::read_regular(path).map_err(Error::file(path))?;
        Self::from_text(&path.display().to_string(), &path.with_file_name(TEXT), &text, files)
    }

    /// Loads a model from a text in MJCF or URDF.
    ///
    /// The text goes to the engine's own compiler. That of 2.2.2 is known to crash, to run without end, or to read and write
    /// outside of its memory on some kinds of input. Those that a look at the text and at the files that it names can see are
    /// refused here:
    ///
    /// * files that include each other without end, elements nested more than 400 deep, pipes and devices,
    /// * sizes that overflow or are beyond any use, of textures, height fields, keyframes, user and custom data, the skins of
    ///   composites, and more than 40 000 bodies or degrees of freedom,
    /// * meshes, skins and height fields that are damaged: another size than the header says, faces of vertices that there are
    ///   not, vertices that are not finite,
    /// * a muscle whose length range does not settle, a fixed tendon with the same joint twice, adhesion with room for fewer than
    ///   100 constraints, a rangefinder with a height field of more rows than columns.
    ///
    /// What is left takes time or memory: bodies by the ten thousand, and a PNG that unpacks to more than its head says. And a
    /// file on the disk that the text names could change between the look at it and the compiler's. So a text from strangers
    /// should be compiled in a process of its own, with limits.
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
        Self::from_xml_str_with_files(xml, &[])
    }

    /// Loads a model from a text whose other files are in memory too: included texts, meshes (`.stl`, `.obj`, `.msh`), skins,
    /// height fields and textures (`.png`, or the engine's own formats). The compiler looks for a file by its name without its
    /// folder, in upper or lower case, here first and then on the disk, so that no two may differ by their folder alone.
    ///
    /// What is true of a hostile text is true of a hostile file, too; see [`from_xml_str`](Self::from_xml_str).
    ///
    /// # Errors
    ///
    /// As for [`from_xml_str`](Self::from_xml_str), and [`Error::Invalid`] for a file without a name or content, of the name of
    /// another one, with a name of 1000 bytes or more, or of 2 GiB or more, and for more than 1998 files.
    ///
    /// ```
    /// use mujoco_safe::Model;
    ///
    /// let model = Model::from_xml_str_with_files(
    ///     r#"<mujoco><include file="ball.xml"/></mujoco>"#,
    ///     &[("ball.xml", br#"<mujoco><worldbody><geom name="ball" size="0.1"/></worldbody></mujoco>"#)],
    /// )?;
    /// assert_eq!(model.ngeom(), 1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjVFS")]
    #[doc(alias = "mj_defaultVFS")]
    #[doc(alias = "mj_addFileVFS")]
    #[doc(alias = "mj_addBufferVFS")]
    #[doc(alias = "mj_makeEmptyFileVFS")]
    #[doc(alias = "mj_deleteVFS")]
    pub fn from_xml_str_with_files(xml: &str, files: &[(&str, &[u8])]) -> Result<Self> {
        Self::from_text(GIVEN, TEXT.as_ref(), xml.as_bytes(), files)
    }

    /// Compiles a text as if it was in the file `path`, which it is to the compiler: its name must be [`TEXT`].
    fn from_text(source_name: &str, path: &Path, text: &[u8], files: &[(&str, &[u8])]) -> Result<Self> {
        let model = Self::from_text_by(source_name, path, text, files, &mut Self::compile_quietly)?;
        // Not under the lock: a logger is the user's code, and may load a model, too.
        for warning in &model.warnings {
            log::warn!(target: engine::LOG_TARGET, "{source_name}: {warning}");
        }
        Ok(model)
    }

    /// Checks a text and runs the compiler on it, by way of `compile`, which takes the lock of [`XmlState`] or already has it.
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
            ffi::check("mj_loadModel", status)
        });
        result?;
        let raw = NonNull::new(loaded).ok_or_else(|| invalid(warnings.join("; ")))?;
        // SAFETY: the engine allocated it for us, and its content was validated.
        let model = unsafe { Self::from_raw(raw, Lineage::new(), warnings) };
        model.hazard().map_or(Ok(model), |reason| Err(invalid(reason)))
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
        let (status, mut warnings) = collecting_warnings(|| {
            // SAFETY: a valid name and table, a buffer of the given size, a place for the result.
            unsafe {
                guard::mj_load_xml(name.as_ptr(), files.as_ptr(), message.as_mut_ptr(), MESSAGE as i32, &raw mut loaded)
            }
        });
        xml.leave("mj_loadXML", status)?;
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
        if let Some(message) = model.hazard() {
            return Err(Error::Load { source_name: source_name.to_owned(), message });
        }
        xml.last = Some(lineage);
        Ok(model)
    }
}

/// A path as the engine's C code takes it.
pub(super) fn path_c_string(path: &Path) -> Result<CString> {
    ffi::c_string("the path", text_check::path_bytes(path))
}
