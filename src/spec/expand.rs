//! Elements that the compiler creates, as elements of a spec.

use std::path::Path;

use super::Spec;
use crate::error::{Error, Result};
use crate::model::{LoadOptions, SaveXmlOptions};

/// Number of attempts while other threads load models.
const ATTEMPTS: usize = 100;

/// # Expansion
impl Spec {
    /// Returns the spec with the elements that the compiler creates for `replicate`, `composite`,
    /// `flexcomp` and `attach`, which then have ids, can be edited, and have values in keyframes.
    ///
    /// The result is the text that the engine saves for the compiled spec
    /// ([`Model::save_xml`](crate::Model::save_xml)): it compiles to the same model within the
    /// tolerances of [`save_xml_with`](crate::Model::save_xml_with), has the names of the model's
    /// elements, and angles in radians. Its elements have new ids. Settings that the compiler has
    /// applied, such as `fusestatic` and `settotalmass`, are expanded too.
    ///
    /// # Errors
    ///
    /// As for [`compile`](Self::compile), and as for [`Model::save_xml`](crate::Model::save_xml)
    /// where the engine cannot save what it compiled: it does not save the directory of the files
    /// of an asset that is a model, for which [`attach`](Self::attach) is the way.
    /// [`Error::XmlReplaced`] if other threads load models all the time.
    ///
    #[cfg_attr(not(engine_since = "3.1.3"), doc = "```ignore")]
    #[cfg_attr(engine_since = "3.1.3", doc = "```")]
    /// use mujoco_safe::spec::Spec;
    ///
    /// let spec = Spec::from_xml_str(
    ///     r#"<mujoco><worldbody><replicate count="3" offset="1 0 0">
    ///          <body name="post"><joint/><geom size="0.1"/></body>
    ///        </replicate></worldbody></mujoco>"#,
    /// )?;
    /// let mut posts = spec.expanded()?;
    /// let middle = posts.body("post1")?.id();
    /// posts.remove(middle)?;
    /// assert_eq!(posts.compile()?.nbody(), 3); // with the world
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "replicate")]
    #[doc(alias = "composite")]
    #[doc(alias = "flexcomp")]
    pub fn expanded(&self) -> Result<Self> {
        self.expanded_with(&LoadOptions::default())
    }

    /// As [`expanded`](Self::expanded), with [`LoadOptions`]: files of assets can be in memory.
    ///
    /// # Errors
    ///
    /// As for [`expanded`](Self::expanded) and [`compile_with`](Self::compile_with).
    pub fn expanded_with(&self, options: &LoadOptions<'_>) -> Result<Self> {
        let path = self.directory().unwrap_or(Path::new("")).join("the expanded spec");
        let save = SaveXmlOptions::default().with_files(&options.files);
        let mut attempts = (0..ATTEMPTS).map(|_| self.compile_with(options)?.checked_text(&path, &save));
        let saved = attempts.find(|saved| !matches!(saved, Err(Error::XmlReplaced)));
        let (text, _) = saved.unwrap_or(Err(Error::XmlReplaced))?;
        let mut spec = Self::from_xml_str(&text)?;
        spec.directory.clone_from(&self.directory);
        spec.unpacked.clone_from(&self.unpacked);
        Ok(spec)
    }
}
