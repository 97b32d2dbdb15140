//! A free base for a robot.

use super::names;
use super::tree::Index;
use super::{ElementMut, Spec, UrdfWarning};
use crate::error::{Error, InvalidKind, Result};
use crate::kind;

/// # Free base
impl Spec {
    /// Lets a robot float: adds a free joint to the only body in the world.
    ///
    /// The reader of a URDF, which states no joint between the base and the world, fixes the base.
    /// Removes the warning about its mass from [`urdf_warnings`](Self::urdf_warnings). For one of
    /// several bodies use [`add_freejoint`](Self::add_freejoint). A joint of type `fixed` to a link
    /// `world` is no joint of the spec, so the base becomes free there too.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`], and nothing is added, if the world has no body or several, or the body
    /// has a joint.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::from_xml_str(
    ///     r#"<robot name="box">
    ///       <link name="box">
    ///         <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    ///       </link>
    ///     </robot>"#,
    /// )?;
    /// spec.add_free_base()?.set_name("base");
    /// let model = spec.compile()?;
    /// assert_eq!((model.nv(), model.body("box")?.mass()), (6, 2.0));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "freejoint")]
    pub fn add_free_base(&mut self) -> Result<ElementMut<'_, kind::Joint>> {
        let is = |index: &Index, tags: &[&str]| tags.contains(&self.tree.tag(*index));
        let bodies: Vec<Index> =
            self.tree.children(self.world).iter().copied().filter(|index| is(index, &["body"])).collect();
        let &[base] = &bodies[..] else {
            let names: Vec<String> = bodies.iter().take(10).map(|&body| names::describe(&self.tree, body)).collect();
            let found = format!("{} ({})", bodies.len(), names.join(", "));
            let expected = "one, to which the joint is added; add_freejoint adds one to any body in the world";
            return Err(Error::invalid(InvalidKind::Unsuitable, "the number of bodies in the world", found, expected));
        };
        let joint = self.tree.children(base).iter().find(|index| is(index, &["joint", "freejoint"]));
        if let Some(&joint) = joint {
            let what = format!("the number of joints of {}", names::describe(&self.tree, base));
            let found = format!("not 0: it has {}", names::describe(&self.tree, joint));
            return Err(Error::invalid(InvalidKind::Unsuitable, what, found, "0, for a base that becomes free"));
        }
        self.warnings.retain(|warning| !matches!(warning, UrdfWarning::FixedMass { .. }));
        Ok(self.append(base, "freejoint"))
    }
}
