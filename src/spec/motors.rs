//! Motors for the joints of a robot.

use std::collections::HashSet;

use super::attach::effective;
use super::value::numbers;
use super::{ActuatorElement, ElementId, Spec, UrdfWarning, layout};
use crate::kind;

/// # Motors
impl Spec {
    /// Adds a motor for each hinge and slide joint that no actuator drives, and that follows no
    /// other joint (`joint1` of an equality, `mimic` in a URDF). Returns the motors in the order of
    /// their joints.
    ///
    /// The control is the force, in N m or N. Its range is the effort limit of the URDF, or
    /// `actuatorfrcrange` of the joint; without them it is not limited. A motor has the name of its
    /// joint, unless another actuator has it.
    ///
    /// Removes the warnings about the effort limits of these joints from
    /// [`urdf_warnings`](Self::urdf_warnings).
    ///
    /// ```
    /// use mujoco_safe::Data;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut arm = Spec::from_xml_str(
    ///     r#"<robot name="arm">
    ///       <link name="base"/>
    ///       <link name="arm">
    ///         <inertial>
    ///           <mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
    ///         </inertial>
    ///       </link>
    ///       <joint name="shoulder" type="continuous">
    ///         <parent link="base"/><child link="arm"/><limit effort="30" velocity="10"/>
    ///       </joint>
    ///     </robot>"#,
    /// )?;
    /// arm.add_motors();
    /// let mut data = Data::new(arm.compile()?)?;
    /// data.actuator_mut("shoulder")?.set_ctrl(100.0); // N m
    /// data.forward()?;
    /// assert_eq!(data.actuator("shoulder")?.force(), 30.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "motors of a URDF")]
    #[doc(alias = "effort limit")]
    pub fn add_motors(&mut self) -> Vec<ElementId<kind::Actuator>> {
        let driven = self.driven();
        let needs_motor = |id: &ElementId<kind::Joint>| {
            matches!(layout::joint_type(&self.tree, id.index()), "hinge" | "slide")
                && !self.joint(*id).name().is_some_and(|name| driven.contains(name))
        };
        let joints: Vec<ElementId<kind::Joint>> = self.ids().into_iter().filter(needs_motor).collect();
        joints.into_iter().map(|joint| self.add_motor(joint)).collect()
    }

    /// Names of the joints that an actuator drives or that follow another one.
    fn driven(&self) -> HashSet<&str> {
        let tree = &self.tree;
        let elements = |section| tree.sections(section).flat_map(|section| tree.children(section).iter().copied());
        let drive = elements("actuator")
            .flat_map(|actuator| ["joint", "jointinparent"].map(|attribute| tree.attribute(actuator, attribute)));
        let follow = elements("equality")
            .filter(|&equality| tree.tag(equality) == "joint")
            .map(|equality| tree.attribute(equality, "joint1"));
        drive.chain(follow).flatten().collect()
    }

    fn add_motor(&mut self, joint: ElementId<kind::Joint>) -> ElementId<kind::Actuator> {
        let range = self.take_effort(joint);
        let name = self.joint(joint).name().filter(|name| self.actuator(*name).is_err()).map(str::to_owned);
        let mut motor = self.add_actuator(ActuatorElement::Motor);
        motor.set_joint(joint);
        if let Some(name) = name {
            motor.set_name(&name);
        }
        if let Some(range) = range {
            // Older engines do not limit by the range alone.
            motor.put("ctrllimited", &true).put("ctrlrange", &range);
        }
        motor.id()
    }

    /// Returns the limits of the force of a joint, and removes the warning about them.
    fn take_effort(&mut self, joint: ElementId<kind::Joint>) -> Option<[f64; 2]> {
        let of_joint = |attribute| effective(&self.tree, joint.index(), attribute);
        let in_joint = of_joint("actuatorfrcrange")
            .filter(|_| of_joint("actuatorfrclimited") != Some("false"))
            .and_then(|text| <[f64; 2]>::try_from(numbers(text)?).ok());
        let name = self.joint(joint).name().map(str::to_owned);
        let of_name = |warning: &UrdfWarning| match warning {
            UrdfWarning::EffortLimit { joint, effort } if Some(joint) == name.as_ref() => Some([-effort, *effort]),
            _ => None,
        };
        let in_warning = self.warnings.iter().find_map(of_name);
        self.warnings.retain(|warning| of_name(warning).is_none());
        in_joint.or(in_warning)
    }
}
