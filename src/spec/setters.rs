//! Attributes with a method. They exist in every engine; [`ElementMut::set`] sets the others.

use super::ElementMut;
use super::element_id::Reference;
use super::value::{SensorFrame, TexturePattern};
use crate::enums::{CameraMode, GeomType, JointType, TextureType};
use crate::kind;

/// Declares the methods that set attributes of a kind: values by their type, and references after
/// `->`.
macro_rules! setters {
    ($($kind:ident { $($(#[$doc:meta])* $method:ident $attribute:literal $(: $value:ty)? $(=> $target:ident)?;)* })*) => {
        $(
            #[doc = concat!("# Attributes of ", stringify!($kind))]
            impl ElementMut<'_, kind::$kind> {
                $(
                    $(#[$doc])*
                    #[doc = concat!("\n\nAttribute `", $attribute, "` of MJCF.")]
                    #[track_caller]
                    pub fn $method(&mut self, value: setters!(@type $($value)? $(=> $target)?)) -> &mut Self {
                        setters!(@put self $attribute value $(=> $target)?)
                    }
                )*
            }
        )*

        /// Kinds and attributes of the methods.
        #[cfg(test)]
        const ATTRIBUTES: &[(kind::Kind, &str)] = &[$($((kind::Kind::$kind, $attribute)),*),*];
    };
    (@type $value:ty) => { $value };
    (@type => $target:ident) => { impl Reference<kind::$target> };
    (@put $self:ident $attribute:literal $value:ident) => { $self.put($attribute, &$value) };
    (@put $self:ident $attribute:literal $value:ident => $target:ident) => {{
        let name = $value.name($self.spec());
        $self.put($attribute, &name)
    }};
}

setters! {
    Body {
        /// Sets the position of the frame, metres, in the frame of the parent.
        set_pos "pos": [f64; 3];
        /// Sets the orientation of the frame in the frame of the parent.
        set_quat "quat": [f64; 4];
        /// Makes the body move by `mocap_pos` and `mocap_quat` only. It must be in the world,
        /// without joints.
        set_mocap "mocap": bool;
        /// Sets the class of defaults of all elements in the body that have no class.
        set_childclass "childclass": &str;
    }
    Joint {
        /// Sets the type. Free joints that [`add_freejoint`](super::Spec::add_freejoint) made have
        /// none.
        set_type "type": JointType;
        /// Sets the position of the joint, metres, in the frame of the body.
        set_pos "pos": [f64; 3];
        /// Sets the axis of a hinge or slide joint, in the frame of the body. The compiler
        /// normalises it.
        set_axis "axis": [f64; 3];
        /// Sets the limits: metres for a slide joint, otherwise angles in the unit of `compiler`
        /// (degrees by default). In a text that was written for 2.2.2 they may need
        /// [`set_limited`](Self::set_limited) to take effect.
        set_range "range": [f64; 2];
        /// Sets whether the limits take effect.
        set_limited "limited": bool;
        /// Sets the stiffness of the spring, N/m or N m/rad.
        set_stiffness "stiffness": f64;
        /// Sets the damping, N s/m or N m s/rad.
        set_damping "damping": f64;
        /// Sets the inertia of the rotor, kg m² (kg for a slide joint).
        set_armature "armature": f64;
        /// Sets the dry friction, N or N m.
        set_frictionloss "frictionloss": f64;
        /// Sets the joint position in the initial configuration, metres or an angle.
        set_ref "ref": f64;
        /// Sets the joint position at which the spring has no force, metres or an angle.
        set_springref "springref": f64;
        /// Sets the group for visualisation.
        set_group "group": i32;
    }
    Geom {
        /// Sets the shape.
        set_type "type": GeomType;
        /// Sets the sizes, metres: the radius of a sphere; the radius and the half-length of a
        /// capsule and a cylinder (only the radius with [`set_fromto`](Self::set_fromto)); the
        /// half-sizes of a box and an ellipsoid; the half-sizes of a plane, 0 if infinite, and the
        /// spacing of its grid.
        set_size "size": &[f64];
        /// Sets the position of the centre, metres, in the frame of the body.
        set_pos "pos": [f64; 3];
        /// Sets the orientation in the frame of the body.
        set_quat "quat": [f64; 4];
        /// Sets the two end points of a capsule, cylinder, box or ellipsoid, metres, in the frame
        /// of the body.
        set_fromto "fromto": [f64; 6];
        /// Sets the mass, kg. Without it the density applies.
        set_mass "mass": f64;
        /// Sets the density, kg/m³.
        set_density "density": f64;
        /// Sets the coefficients of sliding, torsional (metres) and rolling friction (metres).
        set_friction "friction": [f64; 3];
        /// Sets the dimension of contacts: 1, 3, 4 or 6.
        set_condim "condim": i32;
        /// Sets the bits of collisions that the geom has.
        set_contype "contype": i32;
        /// Sets the bits of collisions that the geom accepts.
        set_conaffinity "conaffinity": i32;
        /// Sets the distance, metres, below which contacts are active.
        set_margin "margin": f64;
        /// Sets the colour: red, green, blue, opacity, from 0 to 1.
        set_rgba "rgba": [f32; 4];
        /// Sets the group for visualisation.
        set_group "group": i32;
        /// Sets the material.
        set_material "material" => Material;
        /// Sets the mesh.
        set_mesh "mesh" => Mesh;
        /// Sets the height field.
        set_height_field "hfield" => HeightField;
    }
    Site {
        /// Sets the shape.
        set_type "type": GeomType;
        /// Sets the sizes, metres, as for a geom.
        set_size "size": &[f64];
        /// Sets the position, metres, in the frame of the body.
        set_pos "pos": [f64; 3];
        /// Sets the orientation in the frame of the body.
        set_quat "quat": [f64; 4];
        /// Sets the colour: red, green, blue, opacity, from 0 to 1.
        set_rgba "rgba": [f32; 4];
        /// Sets the group for visualisation.
        set_group "group": i32;
        /// Sets the material.
        set_material "material" => Material;
    }
    Camera {
        /// Sets the position, metres, in the frame of the body.
        set_pos "pos": [f64; 3];
        /// Sets the orientation in the frame of the body. The camera looks along its negative z
        /// axis.
        set_quat "quat": [f64; 4];
        /// Sets the x and the y axis of the camera, in the frame of the body.
        set_xyaxes "xyaxes": [f64; 6];
        /// Sets the vertical field of view, degrees.
        set_fovy "fovy": f64;
        /// Sets the tracking mode.
        set_mode "mode": CameraMode;
        /// Sets the body at which the camera looks in a mode with a target.
        set_target "target" => Body;
    }
    Light {
        /// Sets the position, metres, in the frame of the body.
        set_pos "pos": [f64; 3];
        /// Sets the direction, in the frame of the body.
        set_dir "dir": [f64; 3];
        /// Sets whether the light casts shadows.
        set_castshadow "castshadow": bool;
        /// Sets the diffuse colour: red, green, blue, from 0 to 1.
        set_diffuse "diffuse": [f32; 3];
        /// Sets the tracking mode, as for a camera.
        set_mode "mode": CameraMode;
        /// Sets the body at which the light points in a mode with a target.
        set_target "target" => Body;
    }
    Mesh {
        /// Sets the file, relative to the directory of the spec and to `meshdir` of `compiler`.
        set_file "file": &str;
        /// Sets the factors by which the compiler scales the vertices.
        set_scale "scale": [f64; 3];
        /// Sets the vertices: x, y and z of each, metres.
        set_vertex "vertex": &[f64];
        /// Sets the faces: the indices of three vertices of each. Without them the mesh is the
        /// convex hull of the vertices.
        set_face "face": &[i32];
    }
    HeightField {
        /// Sets the file, a PNG image or the engine's own format.
        set_file "file": &str;
        /// Sets the half-sizes along x and y, the largest height, and the depth below the lowest
        /// point, metres.
        set_size "size": [f64; 4];
        /// Sets the number of rows of a height field without a file, whose heights the program
        /// sets.
        set_nrow "nrow": i32;
        /// Sets the number of columns of a height field without a file.
        set_ncol "ncol": i32;
    }
    Texture {
        /// Sets the type.
        set_type "type": TextureType;
        /// Sets the file, a PNG image or the engine's own format.
        set_file "file": &str;
        /// Sets the generated pattern.
        set_builtin "builtin": TexturePattern;
        /// Sets the first colour of a pattern: red, green, blue, from 0 to 1.
        set_rgb1 "rgb1": [f32; 3];
        /// Sets the second colour of a pattern: red, green, blue, from 0 to 1.
        set_rgb2 "rgb2": [f32; 3];
        /// Sets the width of a pattern, pixels.
        set_width "width": i32;
        /// Sets the height of a pattern, pixels.
        set_height "height": i32;
    }
    Material {
        /// Sets the texture.
        set_texture "texture" => Texture;
        /// Sets the repetitions of the texture along x and y.
        set_texrepeat "texrepeat": [f32; 2];
        /// Sets the colour: red, green, blue, opacity, from 0 to 1.
        set_rgba "rgba": [f32; 4];
        /// Sets the strength of the highlights, from 0 to 1.
        set_specular "specular": f32;
        /// Sets the share of mirrored light, from 0 to 1.
        set_reflectance "reflectance": f32;
    }
    Pair {
        /// Sets the first geom.
        set_geom1 "geom1" => Geom;
        /// Sets the second geom.
        set_geom2 "geom2" => Geom;
        /// Sets the dimension of contacts: 1, 3, 4 or 6.
        set_condim "condim": i32;
    }
    Exclude {
        /// Sets the first body.
        set_body1 "body1" => Body;
        /// Sets the second body.
        set_body2 "body2" => Body;
    }
    Equality {
        /// Sets the first body of a connect or weld constraint.
        set_body1 "body1" => Body;
        /// Sets the second body of a connect or weld constraint, by default the world.
        set_body2 "body2" => Body;
        /// Sets the point of a connect constraint, metres, in the frame of the first body.
        set_anchor "anchor": [f64; 3];
        /// Sets the first joint of a joint constraint.
        set_joint1 "joint1" => Joint;
        /// Sets the second joint of a joint constraint. Without it the first joint is constant.
        set_joint2 "joint2" => Joint;
        /// Sets the first tendon of a tendon constraint.
        set_tendon1 "tendon1" => Tendon;
        /// Sets the second tendon of a tendon constraint.
        set_tendon2 "tendon2" => Tendon;
        /// Sets the coefficients of the polynomial of a joint or tendon constraint.
        set_polycoef "polycoef": [f64; 5];
        /// Sets whether the constraint is active at the start.
        set_active "active": bool;
        /// Sets the time constant (seconds) and the damping ratio of the constraint.
        set_solref "solref": [f64; 2];
    }
    Tendon {
        /// Sets the limits of the length, metres.
        set_range "range": [f64; 2];
        /// Sets whether the limits take effect.
        set_limited "limited": bool;
        /// Sets the stiffness of the spring, N/m.
        set_stiffness "stiffness": f64;
        /// Sets the damping, N s/m.
        set_damping "damping": f64;
        /// Sets the group for visualisation.
        set_group "group": i32;
    }
    Actuator {
        /// Sets the joint on which the actuator acts.
        set_joint "joint" => Joint;
        /// Sets the tendon on which the actuator acts.
        set_tendon "tendon" => Tendon;
        /// Sets the site on which the actuator acts.
        set_site "site" => Site;
        /// Sets the body on which an adhesive actuator acts.
        set_body "body" => Body;
        /// Sets the transmission: the factor of length and force, and for sites the force and
        /// torque in the site's frame.
        set_gear "gear": &[f64];
        /// Sets the range of the control.
        set_ctrlrange "ctrlrange": [f64; 2];
        /// Sets whether the control is clamped to its range.
        set_ctrllimited "ctrllimited": bool;
        /// Sets the range of the force, N or N m.
        set_forcerange "forcerange": [f64; 2];
        /// Sets whether the force is clamped to its range.
        set_forcelimited "forcelimited": bool;
        /// Sets the gain of a position servo.
        set_kp "kp": f64;
        /// Sets the gain of a velocity servo.
        set_kv "kv": f64;
        /// Sets the group for visualisation.
        set_group "group": i32;
    }
    Sensor {
        /// Sets the site of a sensor at a site.
        set_site "site" => Site;
        /// Sets the joint of a sensor at a joint.
        set_joint "joint" => Joint;
        /// Sets the tendon of a sensor at a tendon.
        set_tendon "tendon" => Tendon;
        /// Sets the actuator of a sensor of an actuator.
        set_actuator "actuator" => Actuator;
        /// Sets the body of a sensor of a subtree.
        set_body "body" => Body;
        /// Sets the type of the object of a sensor of a frame.
        set_objtype "objtype": SensorFrame;
        /// Sets the name of the object of a sensor of a frame.
        set_objname "objname": &str;
        /// Sets the largest magnitude of the reading; 0 means no limit.
        set_cutoff "cutoff": f64;
        /// Sets the standard deviation of noise, which the engine does not add by default.
        set_noise "noise": f64;
    }
    Numeric {
        /// Sets the numbers.
        set_data "data": &[f64];
    }
    Text {
        /// Sets the text.
        set_data "data": &str;
    }
    Keyframe {
        /// Sets the time, seconds.
        set_time "time": f64;
        /// Sets the positions, of length `nq`, for the present elements.
        set_qpos "qpos": &[f64];
        /// Sets the velocities, of length `nv`, for the present elements.
        set_qvel "qvel": &[f64];
        /// Sets the activations, of length `na`, for the present elements.
        set_act "act": &[f64];
        /// Sets the controls, of length `nu`, for the present elements.
        set_ctrl "ctrl": &[f64];
    }
}

#[cfg(test)]
mod tests {
    use super::ATTRIBUTES;
    use crate::spec::attributes::Named;
    use crate::spec::names::named;
    use crate::spec::schema::Schema;
    use crate::spec::tree::Tree;

    /// The methods do not check the names of their attributes.
    #[test]
    fn every_engine_has_the_attributes_with_a_method() {
        let schema = Schema::of_engine().unwrap();
        let mut tree = Tree::new("mujoco");
        for section in
            ["worldbody", "asset", "contact", "equality", "tendon", "actuator", "sensor", "custom", "keyframe"]
        {
            let section = tree.section(section);
            for tag in schema.children(&tree, section) {
                tree.add(section, tag);
            }
        }
        for &(kind, attribute) in ATTRIBUTES {
            let mut all = tree
                .descendants(Tree::ROOT)
                .into_iter()
                .filter(|&index| named(&tree, index) == Some(Named::Kind(kind)));
            assert!(all.any(|index| schema.has(&tree, index, attribute)), "{kind}: {attribute}");
        }
    }
}
