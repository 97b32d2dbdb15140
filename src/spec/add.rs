//! Creation of elements.

use super::attributes::Named;
use super::element_id::{ElementId, Reference};
use super::names;
use super::names::MAIN;
use super::tree::{Index, Tree};
use super::{ElementMut, Spec};
use crate::enums::SensorType;
#[cfg(doc)]
use crate::error::Error;
use crate::error::Result;
use crate::kind;

/// Declares methods that add an element to a body or to a section.
macro_rules! creators {
    (body { $($(#[$doc:meta])* $method:ident $kind:ident = $tag:literal;)* } $($section:literal {
        $($(#[$section_doc:meta])* $section_method:ident $section_kind:ident = $section_tag:literal;)*
    })*) => {
        /// # Elements of bodies
        ///
        /// These methods panic if the id belongs to another spec, or the body was removed.
        impl Spec {
            $(
                $(#[$doc])*
                #[track_caller]
                pub fn $method(&mut self, body: ElementId<kind::Body>) -> ElementMut<'_, kind::$kind> {
                    let body = self.index(body);
                    self.append(body, $tag)
                }
            )*
        }

        /// Sections and tags of the elements.
        #[cfg(test)]
        const CREATED: &[(&str, &str)] = &[$(("worldbody", $tag),)* $($(($section, $section_tag),)*)*];

        /// # Other elements
        impl Spec {
            $($(
                $(#[$section_doc])*
                pub fn $section_method(&mut self) -> ElementMut<'_, kind::$section_kind> {
                    let section = self.tree.section($section);
                    self.append(section, $section_tag)
                }
            )*)*
        }
    };
}

creators! {
    body {
        /// Adds a body.
        #[doc(alias = "mjs_addBody")]
        add_body Body = "body";
        /// Adds a joint between the body and its parent, a hinge by default.
        #[doc(alias = "mjs_addJoint")]
        add_joint Joint = "joint";
        /// Adds a free joint, with six degrees of freedom and without stiffness and damping. The
        /// body must be in the world.
        #[doc(alias = "mjs_addFreeJoint")]
        add_freejoint Joint = "freejoint";
        /// Adds a geom, a sphere by default.
        #[doc(alias = "mjs_addGeom")]
        add_geom Geom = "geom";
        /// Adds a site.
        #[doc(alias = "mjs_addSite")]
        add_site Site = "site";
        /// Adds a camera.
        #[doc(alias = "mjs_addCamera")]
        add_camera Camera = "camera";
        /// Adds a light.
        #[doc(alias = "mjs_addLight")]
        add_light Light = "light";
    }
    "asset" {
        /// Adds a mesh.
        #[doc(alias = "mjs_addMesh")]
        add_mesh Mesh = "mesh";
        /// Adds a height field.
        #[doc(alias = "mjs_addHField")]
        add_height_field HeightField = "hfield";
        /// Adds a texture.
        #[doc(alias = "mjs_addTexture")]
        add_texture Texture = "texture";
        /// Adds a material.
        #[doc(alias = "mjs_addMaterial")]
        add_material Material = "material";
    }
    "contact" {
        /// Adds a pair of geoms that collide whatever their bit masks.
        #[doc(alias = "mjs_addPair")]
        add_pair Pair = "pair";
        /// Excludes collisions between two bodies.
        #[doc(alias = "mjs_addExclude")]
        add_exclude Exclude = "exclude";
    }
    "equality" {
        /// Adds a constraint that connects two bodies at a point.
        #[doc(alias = "mjs_addEquality")]
        add_connect Equality = "connect";
        /// Adds a constraint that fixes two bodies to each other.
        add_weld Equality = "weld";
        /// Adds a constraint between the positions of two joints.
        add_joint_equality Equality = "joint";
        /// Adds a constraint between the lengths of two tendons.
        add_tendon_equality Equality = "tendon";
    }
    "tendon" {
        /// Adds a tendon along a path of sites and geoms.
        #[doc(alias = "mjs_addTendon")]
        add_spatial_tendon Tendon = "spatial";
        /// Adds a tendon whose length is a linear combination of joint positions.
        add_fixed_tendon Tendon = "fixed";
    }
    "custom" {
        /// Adds an array of numbers for the program.
        #[doc(alias = "mjs_addNumeric")]
        add_numeric Numeric = "numeric";
        /// Adds a text for the program.
        #[doc(alias = "mjs_addText")]
        add_text Text = "text";
        /// Adds a list of elements for the program.
        #[doc(alias = "mjs_addTuple")]
        add_tuple Tuple = "tuple";
    }
    "keyframe" {
        /// Adds a keyframe.
        #[doc(alias = "mjs_addKey")]
        #[doc(alias = "mj_setKeyframe")]
        add_keyframe Keyframe = "key";
    }
}

/// Element of MJCF that creates an actuator: `general`, or a shortcut with certain dynamics, gain
/// and bias. An argument of [`Spec::add_actuator`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ActuatorElement {
    /// Actuator with general gain, bias and activation dynamics.
    General,
    /// Force or torque in proportion to the control.
    Motor,
    /// Position servo.
    Position,
    /// Velocity servo.
    Velocity,
    /// Position servo whose target is the integral of the control.
    IntegratedVelocity,
    /// Damper whose coefficient is in proportion to the control.
    Damper,
    /// Pneumatic or hydraulic cylinder.
    Cylinder,
    /// Muscle.
    Muscle,
    /// Adhesive body.
    Adhesion,
}

impl ActuatorElement {
    #[cfg(test)]
    const ALL: [Self; 9] = [
        Self::General,
        Self::Motor,
        Self::Position,
        Self::Velocity,
        Self::IntegratedVelocity,
        Self::Damper,
        Self::Cylinder,
        Self::Muscle,
        Self::Adhesion,
    ];

    const fn tag(self) -> &'static str {
        match self {
            Self::General => "general",
            Self::Motor => "motor",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::IntegratedVelocity => "intvelocity",
            Self::Damper => "damper",
            Self::Cylinder => "cylinder",
            Self::Muscle => "muscle",
            Self::Adhesion => "adhesion",
        }
    }
}

impl Spec {
    /// Adds an actuator.
    ///
    /// ```
    /// use mujoco_safe::spec::{ActuatorElement, Spec};
    ///
    /// let mut spec = Spec::new("hinge");
    /// let body = spec.add_body(spec.world()).id();
    /// let hinge = spec.add_joint(body).id();
    /// spec.add_geom(body).set_size(&[0.1]);
    /// spec.add_actuator(ActuatorElement::Motor).set_joint(hinge).set_gear(&[10.0]);
    /// assert_eq!(spec.compile()?.nu(), 1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_addActuator")]
    #[doc(alias = "mjs_setToMotor")]
    #[doc(alias = "mjs_setToPosition")]
    #[doc(alias = "mjs_setToVelocity")]
    #[doc(alias = "mjs_setToIntVelocity")]
    #[doc(alias = "mjs_setToDamper")]
    #[doc(alias = "mjs_setToCylinder")]
    #[doc(alias = "mjs_setToMuscle")]
    #[doc(alias = "mjs_setToAdhesion")]
    pub fn add_actuator(&mut self, element: ActuatorElement) -> ElementMut<'_, kind::Actuator> {
        let section = self.tree.section("actuator");
        self.append(section, element.tag())
    }

    /// Adds a sensor.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the engine does not have the sensor.
    #[doc(alias = "mjs_addSensor")]
    pub fn add_sensor(&mut self, sensor: SensorType) -> Result<ElementMut<'_, kind::Sensor>> {
        sensor.check_supported()?;
        let tag = match sensor {
            SensorType::JointActuatorForce => "jointactuatorfrc".to_owned(),
            SensorType::TendonActuatorForce => "tendonactuatorfrc".to_owned(),
            SensorType::GeomDistance => "distance".to_owned(),
            SensorType::GeomNormal => "normal".to_owned(),
            SensorType::GeomFromTo => "fromto".to_owned(),
            sensor => sensor.constant().trim_start_matches("mjSENS_").to_ascii_lowercase(),
        };
        let section = self.tree.section("sensor");
        self.check_child(section, &tag)?;
        Ok(self.append(section, &tag))
    }

    /// Returns a section of the model, such as `option`, `compiler`, `visual` or `statistic`, and
    /// creates it if there is none.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the engine does not have such a section.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::new("weightless");
    /// spec.section_mut("option")?.set("gravity", [0.0; 3])?;
    /// spec.section_mut("visual")?.child_mut("headlight")?.set("ambient", [0.3; 3])?;
    /// assert_eq!(spec.compile()?.options().gravity, [0.0; 3]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn section_mut(&mut self, tag: &str) -> Result<ElementMut<'_>> {
        self.check_child(Tree::ROOT, tag)?;
        let index = if tag == "default" { self.main_class()? } else { self.tree.section(tag) };
        Ok(self.element_mut(index))
    }

    /// Returns the defaults of a class for an element, such as `geom` or `motor`. Creates the
    /// class, directly in `main`, if there is none with this name.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if elements with this tag have no defaults.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::new("balls");
    /// spec.default_mut("main", "geom")?.set("size", 0.1)?;
    /// spec.default_mut("large", "geom")?.set("size", 0.2)?;
    /// let world = spec.world();
    /// spec.add_geom(world);
    /// spec.add_geom(world).set_class("large");
    /// let model = spec.compile()?;
    /// assert_eq!([model.geom_size()[0][0], model.geom_size()[1][0]], [0.1, 0.2]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_addDefault")]
    #[doc(alias = "mjs_getDefault")]
    #[doc(alias = "mjs_findDefault")]
    #[doc(alias = "mjs_getSpecDefault")]
    pub fn default_mut(&mut self, class: &str, tag: &str) -> Result<ElementMut<'_>> {
        let known = names::find(&self.tree, Named::Class, class).filter(|_| class != MAIN);
        let parent = match known {
            Some(class) => class,
            None => self.main_class()?,
        };
        self.check_child(parent, tag)?;
        let class = match known {
            None if class != MAIN => {
                let index = self.tree.add(parent, "default");
                self.tree.node_mut(index).set("class", class.to_owned());
                index
            }
            _ => parent,
        };
        let index = self.child(class, tag);
        Ok(self.element_mut(index))
    }

    /// Returns the last element with a tag in another one, and creates it if there is none.
    fn child(&mut self, parent: Index, tag: &str) -> Index {
        let last = self.tree.children(parent).iter().copied().rfind(|&child| self.tree.tag(child) == tag);
        last.unwrap_or_else(|| self.tree.add(parent, tag))
    }
}

impl<K> ElementMut<'_, K> {
    /// Returns the last element with a tag in this one, and creates it if there is none.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the engine does not accept the element here.
    pub fn child_mut(&mut self, tag: &str) -> Result<ElementMut<'_>> {
        let index = self.index();
        let spec = self.spec();
        spec.check_child(index, tag)?;
        let index = spec.child(index, tag);
        Ok(spec.element_mut(index))
    }

    fn index(&mut self) -> Index {
        let id = self.id();
        self.spec().index(id)
    }
}

/// # Inertia
impl ElementMut<'_, kind::Body> {
    /// Sets the mass (kg), the centre of mass (metres, in the frame of the body) and the moments of
    /// inertia (kg m²) about axes through it that are parallel to the axes of the body. Without
    /// this, the compiler computes them from the geoms.
    pub fn set_inertial(&mut self, mass: f64, pos: [f64; 3], diaginertia: [f64; 3]) -> &mut Self {
        let index = self.index();
        let spec = self.spec();
        let inertial = spec.child(index, "inertial");
        // Other attributes, such as an orientation, would contradict these.
        spec.tree.node_mut(inertial).attributes.clear();
        let mut inertial: ElementMut<'_> = spec.element_mut(inertial);
        inertial.put("pos", &pos).put("mass", &mass).put("diaginertia", &diaginertia);
        self
    }
}

/// # Paths of tendons
impl ElementMut<'_, kind::Tendon> {
    /// Adds a site to the path of a spatial tendon.
    #[doc(alias = "mjs_wrapSite")]
    pub fn wrap_site(&mut self, site: impl Reference<kind::Site>) -> &mut Self {
        let site = site.name(self.spec());
        self.append("site").put("site", &site);
        self
    }

    /// Adds a sphere or cylinder, around which a spatial tendon wraps.
    #[doc(alias = "mjs_wrapGeom")]
    pub fn wrap_geom(&mut self, geom: impl Reference<kind::Geom>) -> &mut Self {
        let geom = geom.name(self.spec());
        self.append("geom").put("geom", &geom);
        self
    }

    /// Adds a sphere or cylinder, around which a spatial tendon wraps on the side of a site.
    pub fn wrap_geom_on_side(
        &mut self,
        geom: impl Reference<kind::Geom>,
        sidesite: impl Reference<kind::Site>,
    ) -> &mut Self {
        let geom = geom.name(self.spec());
        let sidesite = sidesite.name(self.spec());
        self.append("geom").put("geom", &geom).put("sidesite", &sidesite);
        self
    }

    /// Adds a pulley, after which a spatial tendon starts a new branch with its length divided by
    /// `divisor`.
    #[doc(alias = "mjs_wrapPulley")]
    pub fn wrap_pulley(&mut self, divisor: f64) -> &mut Self {
        self.append("pulley").put("divisor", &divisor);
        self
    }

    /// Adds a joint position times a coefficient to the length of a fixed tendon.
    #[doc(alias = "mjs_wrapJoint")]
    pub fn wrap_joint(&mut self, joint: impl Reference<kind::Joint>, coef: f64) -> &mut Self {
        let joint = joint.name(self.spec());
        self.append("joint").put("joint", &joint).put("coef", &coef);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::{ActuatorElement, CREATED};
    use crate::enums::SensorType;
    use crate::spec::Spec;

    #[test]
    fn every_engine_accepts_the_created_elements() {
        let mut spec = Spec::new("all");
        let actuators = ActuatorElement::ALL.map(|element| ("actuator", element.tag()));
        for (section, tag) in CREATED.iter().chain(&actuators) {
            let section = spec.tree.section(section);
            spec.check_child(section, tag).unwrap();
        }
    }

    /// The tags of sensors follow from the names of constants.
    #[test]
    fn every_sensor_has_a_tag_that_the_engine_accepts() {
        for raw in 0..100 {
            let Some(sensor) = SensorType::from_raw(raw) else { continue };
            Spec::new("sensor").add_sensor(sensor).unwrap();
        }
    }
}
