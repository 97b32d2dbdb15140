//! Compilation of a spec, and its text.

use std::borrow::Cow;
use std::path::Path;

use super::text::{self, Written};
use super::tree::{Index, Tree};
use super::{Spec, attach, identity, keyframes, names};
use crate::error::{Error, InvalidKind, Result};
use crate::model::{LoadOptions, Model, TEXT};

/// # Compilation
impl Spec {
    /// Compiles the spec. Files of assets are relative to the [`directory`](Self::directory). After
    /// an edit, [`Data::adopt`](crate::Data::adopt) gives the new model to a simulation that runs.
    ///
    /// # Errors
    ///
    /// [`Error::Load`] with the message of the engine's compiler, and the element if the compiler
    /// names its place. The spec is unchanged and can be corrected. [`Error::Invalid`] if a name or
    /// another attribute has a NUL character, or if values of a keyframe cannot be placed (see
    /// [the module](super#keyframes)).
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::new("arm");
    /// let arm = spec.add_body(spec.world()).set_name("arm").id();
    /// spec.add_joint(arm).set_name("elbow");
    /// let error = spec.compile().unwrap_err();
    /// assert!(error.to_string().contains("body 'arm'"), "{error}"); // it has no mass
    ///
    /// spec.add_geom(arm).set_size(&[0.1]);
    /// assert_eq!(spec.compile()?.nv(), 1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_compile")]
    #[doc(alias = "mjs_getError")]
    pub fn compile(&self) -> Result<Model> {
        self.compile_with(&LoadOptions::default())
    }

    /// Compiles the spec with [`LoadOptions`]: files of assets can be in memory.
    ///
    /// # Errors
    ///
    /// As for [`compile`](Self::compile), and [`Error::Invalid`] as for
    /// [`Model::from_xml_str_with`].
    pub fn compile_with(&self, options: &LoadOptions<'_>) -> Result<Model> {
        let tree = self.complete_tree()?;
        let written = text::write(&tree);
        let path = self.directory.as_deref().unwrap_or(Path::new("")).join(TEXT);
        let mut model = Model::from_text(&self.source_name(), &path, written.text.as_bytes(), options);
        match &mut model {
            Ok(model) => model.set_identities(identity::of(self, model)),
            Err(Error::Load { message, .. }) => *message = self.located(std::mem::take(message), &written),
            Err(_) => {}
        }
        model
    }

    /// Returns the MJCF text of the spec. Includes are replaced by their content. Both the engine
    /// and [`Spec`] read all names and texts as they are here, also those with control characters,
    /// which are written as `&#1;`. Other readers of XML may reject these. Values of a keyframe
    /// that cannot be placed are replaced by a text with the reason, which the compiler rejects.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let spec = Spec::from_xml_str("<mujoco model='ball'><worldbody><geom size='.1'/></worldbody></mujoco>")?;
    /// assert!(spec.to_xml().contains(r#"<geom size=".1"/>"#));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_saveXMLString")]
    pub fn to_xml(&self) -> String {
        text::write(&keyframes::joined(attach::resolved(&self.tree)).0).text
    }

    /// Returns the elements as the compiler reads them, or an error if values of a keyframe cannot
    /// be placed, or an attribute has a NUL character, at which the engine would end its text.
    pub(super) fn complete_tree(&self) -> Result<Cow<'_, Tree>> {
        let (tree, placed) = keyframes::joined(attach::resolved(&self.tree));
        self.check_characters()?;
        placed?;
        Ok(tree)
    }

    fn check_characters(&self) -> Result<()> {
        for index in self.tree.descendants(Tree::ROOT) {
            for (attribute, value) in &self.tree.node(index).attributes {
                check_character(&self.tree, index, attribute, value)?;
            }
        }
        Ok(())
    }

    /// Returns the name of the spec for messages.
    pub(super) fn source_name(&self) -> String {
        if self.name().is_empty() { "the spec".to_owned() } else { format!("the spec '{}'", self.name()) }
    }

    /// Appends the element at a line that a message of the compiler contains.
    fn located(&self, message: String, written: &Written) -> String {
        let Some(line) = line(&message) else { return message };
        let Some(&index) = line.checked_sub(1).and_then(|line| written.lines.get(line)) else { return message };
        format!("{message} ({})", names::describe(&self.tree, index))
    }
}

/// Returns an error if the value of an attribute has a NUL character, which no text of a model can
/// have.
pub(super) fn check_character(tree: &Tree, index: Index, attribute: &str, value: &str) -> Result<()> {
    if !value.contains('\0') {
        return Ok(());
    }
    let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
    Err(Error::invalid(InvalidKind::Text, what, format!("{value:?}"), "a text without NUL"))
}

/// Returns the number of a line in a message: `line 3` or `line = 3`.
fn line(message: &str) -> Option<usize> {
    message.match_indices("line ").find_map(|(position, word)| {
        let rest = message[position + word.len()..].trim_start_matches(['=', ' ']);
        let digits = rest.find(|character: char| !character.is_ascii_digit()).unwrap_or(rest.len());
        rest[..digits].parse().ok().filter(|&line| line > 0)
    })
}
