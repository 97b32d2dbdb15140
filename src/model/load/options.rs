//! Options for loading a model.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::package::{self, Packages};

/// Options for loading a model from XML: files in memory, and directories of the ROS packages that
/// a URDF names.
///
/// ```
/// use mujoco_safe::{LoadOptions, Model};
///
/// let folder = tempfile::tempdir()?; // cargo add tempfile
/// let meshes = folder.path().join("arm_description/meshes");
/// std::fs::create_dir_all(&meshes)?;
/// std::fs::write(meshes.join("hand.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")?;
/// let urdf = r#"<robot name="arm">
///   <link name="hand">
///     <collision><geometry><mesh filename="package://arm_description/meshes/hand.obj"/></geometry></collision>
///   </link>
/// </robot>"#;
///
/// // The directories of all packages below a workspace, in the form of ROS_PACKAGE_PATH …
/// let options = LoadOptions::default().with_package_path(folder.path());
/// assert_eq!(Model::from_xml_str_with(urdf, &options)?.nmesh(), 1);
/// // … or one package.
/// let options = LoadOptions::default().with_package("arm_description", folder.path().join("arm_description"));
/// assert_eq!(Model::from_xml_str_with(urdf, &options)?.nmesh(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct LoadOptions<'a> {
    pub(crate) files: Vec<(&'a str, &'a [u8])>,
    pub(super) packages: Packages,
    pub(crate) has_visuals: bool,
}

impl<'a> LoadOptions<'a> {
    /// Extensions of the mesh formats that the engine reads.
    pub(crate) const MESHES: [&'static str; 3] = package::FORMATS;

    /// Returns `true` if the name of a file is that of a mesh in a format that the engine reads.
    pub(crate) fn is_mesh(name: &str) -> bool {
        package::has_known_format(Path::new(name))
    }

    /// Returns the content of a file in memory, which has the same name after the last slash.
    pub(crate) fn file(&self, name: &str) -> Option<&'a [u8]> {
        self.known(name).map(|(_, content)| content)
    }

    /// Returns the complete name of a file in memory, which has the same name after the last slash.
    pub(crate) fn file_name(&self, name: &str) -> Option<&'a str> {
        self.known(name).map(|(known, _)| known)
    }

    fn known(&self, name: &str) -> Option<(&'a str, &'a [u8])> {
        fn last(name: &str) -> Option<&str> {
            name.rsplit(['/', '\\']).next()
        }
        let is =
            |&&(known, _): &&(&str, &[u8])| last(known).zip(last(name)).is_some_and(|(a, b)| a.eq_ignore_ascii_case(b));
        self.files.iter().find(is).copied()
    }

    /// Returns the path of a file in a package, given its URI without the scheme `package://`. The
    /// package is searched for around `directory` too.
    pub(crate) fn package(&self, uri: &str, directory: Option<&Path>) -> Result<PathBuf, String> {
        self.packages.find(uri, directory)
    }

    /// Adds a file in memory: an included text, a mesh (`.stl`, `.obj`, `.msh`), a skin, a height
    /// field or a texture (`.png`, or the engine's own formats). The compiler compares the part of
    /// a name after the last slash and ignores case, so two files must not differ only in their
    /// directories. Files in memory take precedence over files on disk.
    #[must_use]
    #[doc(alias = "mjVFS")]
    #[doc(alias = "mj_defaultVFS")]
    #[doc(alias = "mj_addFileVFS")]
    #[doc(alias = "mj_addBufferVFS")]
    #[doc(alias = "mj_makeEmptyFileVFS")]
    #[doc(alias = "mj_deleteVFS")]
    pub fn with_file(mut self, name: &'a str, content: &'a [u8]) -> Self {
        self.files.push((name, content));
        self
    }

    /// Adds files in memory, see [`with_file`](Self::with_file).
    #[must_use]
    pub fn with_files(mut self, files: &[(&'a str, &'a [u8])]) -> Self {
        self.files.extend_from_slice(files);
        self
    }

    /// Sets the directory of a package, to which `package://name/…` URIs of meshes are relative.
    #[must_use]
    pub fn with_package(mut self, name: impl Into<String>, directory: impl Into<PathBuf>) -> Self {
        self.packages.add(name.into(), directory.into());
        self
    }

    /// Adds directories that are searched for packages, separated as in the `PATH` of the platform.
    /// The list can be the value of `ROS_PACKAGE_PATH` or `AMENT_PREFIX_PATH`, for example. In each
    /// directory, the package `name` is `name`, `share/name`, or the directory itself if its name
    /// is `name`. The first match in the order of the list is used. Subdirectories are not
    /// searched.
    ///
    /// A package that is in none of them, and has no directory by
    /// [`with_package`](Self::with_package), is searched for in the same way in the directories
    /// around a file that is loaded, of which one whose `package.xml` has the name is the package
    /// too.
    #[must_use]
    pub fn with_package_path(mut self, list: impl AsRef<OsStr>) -> Self {
        self.packages.search(list.as_ref());
        self
    }

    /// Keeps the visual geometry of a URDF that a [`Spec`](crate::spec::Spec) reads, in group 1.
    /// The engine discards it unless the URDF says otherwise
    /// (`<mujoco><compiler discardvisual="false"/></mujoco>`). A [`Model`](crate::Model) is always
    /// loaded as the engine does.
    #[must_use]
    #[doc(alias = "discardvisual")]
    pub fn with_visuals(mut self) -> Self {
        self.has_visuals = true;
        self
    }
}
