//! From URDF to a scene: robots with a floor, motors, cameras and other robots, saved as MJCF.
//!
//! [`Model::from_xml_path`](crate::Model::from_xml_path) simulates a URDF as it is. A
//! [`Spec`](crate::spec::Spec) reads it too, and is then edited, joined with others and saved as
//! MJCF.
//!
//! ```
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::spec::{Mount, Spec, UrdfWarning};
//! use mujoco_safe::{Data, Model};
//!
//! let urdf = r#"
//! <robot name="walker">
//!   <link name="trunk">
//!     <inertial><mass value="5"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
//!     <collision><geometry><box size=".4 .2 .1"/></geometry></collision>
//!   </link>
//!   <link name="leg">
//!     <inertial>
//!       <origin xyz="0 0 -.2"/>
//!       <mass value="1"/><inertia ixx=".01" iyy=".01" izz=".001" ixy="0" ixz="0" iyz="0"/>
//!     </inertial>
//!     <collision><origin xyz="0 0 -.2"/><geometry><cylinder radius=".02" length=".4"/></geometry></collision>
//!   </link>
//!   <joint name="hip" type="revolute">
//!     <parent link="trunk"/><child link="leg"/><axis xyz="0 1 0"/>
//!     <limit lower="-1" upper="1" effort="30" velocity="10"/>
//!   </joint>
//! </robot>"#;
//! let mut robot = Spec::from_xml_str(urdf)?; // or Spec::from_xml_path("walker.urdf")?
//!
//! // What the engine does not have, or what surprises, is a value.
//! for warning in robot.urdf_warnings() {
//!     println!("{warning}");
//! }
//! let fixed = UrdfWarning::FixedMass { link: "trunk".to_owned(), mass: 5.0 };
//! assert!(robot.urdf_warnings().contains(&fixed));
//!
//! // A URDF does not say that the robot floats.
//! robot.add_free_base()?;
//!
//! // A motor for each joint, with the limit of the URDF. Older engines have no other limit of force.
//! robot.add_motors();
//!
//! // Two robots on a floor, with a camera.
//! let mut scene = Spec::new("scene");
//! let world = scene.world();
//! scene.add_geom(world).set_type(GeomType::Plane).set_size(&[5.0, 5.0, 0.1]);
//! scene.add_camera(world).set_name("eye").set_pos([0.0, -3.0, 1.0]).set("xyaxes", [1.0, 0.0, 0.0, 0.0, 0.3, 1.0])?;
//! scene.attach(&robot, Mount::body(world).with_pos([-1.0, 0.0, 0.5]), "left/")?;
//! scene.attach(&robot, Mount::body(world).with_pos([1.0, 0.0, 0.5]), "right/")?;
//! let model = scene.compile()?;
//! assert_eq!((model.nv(), model.nu()), (14, 2));
//! assert_eq!(model.actuator("left/hip")?.ctrlrange(), &[-30.0, 30.0]);
//!
//! // A folder that can be moved: scene.xml and the meshes in scene_assets.
//! let folder = tempfile::tempdir()?; // cargo add tempfile
//! scene.save_xml_with_assets(folder.path().join("scene.xml"))?;
//! let mut data = Data::new(Model::from_xml_path(folder.path().join("scene.xml"))?)?;
//! data.step()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Files
//!
//! The meshes of `walker.urdf` are found
//!
//! - by their path relative to `meshdir` of its `<mujoco><compiler/></mujoco>`, by the last part of
//!   the path in `meshdir` (first with `strippath="true"`; both precede packages too), by their
//!   path relative to the URDF, and by the last part beside it,
//! - by absolute paths and `file://`, with backslashes for slashes and `%20` for spaces,
//! - by `package://name/…` in the directories that
//!   [`LoadOptions`](crate::LoadOptions::with_package_path) states. Without one for the package, it
//!   is one of the directories around the URDF that has the name, or whose `package.xml` has it, or
//!   a folder of this name in one of them or in its folder `share`,
//! - in memory ([`LoadOptions::with_file`](crate::LoadOptions::with_file)), by the last part.
//!
//! A mesh in a format that the engine does not read (it reads STL, OBJ and MSH, not Collada) is
//! left out with a [warning](crate::spec::UrdfWarning::Mesh). So is a visual mesh that is not
//! found; for a text from memory, whose files can be in memory too, the compiler reports it. A
//! collision mesh that is not found is an error.
//!
//! [`Spec::save_xml`](crate::spec::Spec::save_xml) writes absolute paths, and
//! [`Spec::save_xml_with_assets`](crate::spec::Spec::save_xml_with_assets) copies all assets to a
//! folder. Both are for every spec, also for MJCF.
//!
//! # What a spec has
//!
//! | URDF | MJCF |
//! |---|---|
//! | link | body; `world` is the world, without an inertia |
//! | `revolute`, `continuous` | hinge, without limits if continuous |
//! | `prismatic` | slide |
//! | `planar` | two slides and a hinge: `name_TX`, `name_TY`, `name_RZ`; limits act on the first |
//! | `floating` | free joint, which the engine accepts in the world only |
//! | `spherical` | ball, with every engine |
//! | `fixed` | no joint |
//! | `lower`, `upper` | range; no limit if `lower` is not below `upper` |
//! | `effort` | `actuatorfrcrange` since MuJoCo 3.0; range of motors of [`add_motors`][motors] |
//! | `damping`, `friction` | `damping`, `frictionloss` |
//! | `mimic` | equality of two joints, with every engine |
//! | `collision` | geom of group 0 |
//! | `visual` | geom of group 1 without contacts, with [`LoadOptions::with_visuals`](crate::LoadOptions::with_visuals) or `discardvisual="false"`; else left out |
//! | colour of a material | `rgba` of the link's geoms that follow |
//! | `compiler`, `option`, `size` in `mujoco` | the same |
//!
//! [motors]: crate::spec::Spec::add_motors
//!
//! Velocity limits, textures, `transmission`, `gazebo` and all other elements are ignored, with a
//! [warning](crate::spec::UrdfWarning).
//!
//! The spec compiles to the model that the engine's own reader makes of the URDF, up to rounding
//! and these differences:
//!
//! - Meshes are found in more places, and two files of the same name are two meshes. Without
//!   `<mujoco>`, `meshes/a.obj` precedes `a.obj`, which engines before 3.7 prefer. Geoms and
//!   meshes have names with every engine.
//! - `mimic` and `effort` act also with engines whose readers ignore them. Continuous joints have
//!   no limits.
//! - The orientation of an inertia counts. The readers of 3.1.6 and 3.5.0, for example, forget it;
//!   those of 2.2.2, 3.16.0 and later do not.
//! - What the reader rejects may load: capsules in 2.2.2, a mass without moments of inertia, limits
//!   of a floating joint. A link `world` cannot be a child, and its inertia is not that of the
//!   world.
//! - A template (`<xacro:…>`) that was not expanded is an error. Readers ignore its elements.
//!
//! Angles are in radians (`angle="radian"`) and rotations are about fixed axes (`eulerseq="XYZ"`),
//! also for elements that are added later.
//!
//! # Fixed links
//!
//! As for every URDF, the compiler fuses links without a joint with their parents
//! (`fusestatic="true"`); older engines only in a model without actuators, sensors, equalities,
//! cameras and lights. 3.5.0 places the mass of a fused link wrongly, also in the model of its own
//! reader. Fused links have no names in the model. To keep them, attach the robot to a new spec as
//! above, or write
//!
//! ```
//! # let mut robot = mujoco_safe::spec::Spec::from_xml_str(r#"<robot name="r"><link name="tool"/></robot>"#)?;
//! robot.section_mut("compiler")?.set("fusestatic", false)?;
//! assert!(robot.compile()?.body("tool").is_ok());
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Inertias that are rejected
//!
//! Many files have inertias that no body can have: `inertia must satisfy A + B >= C`, or `mass and
//! inertia of moving bodies must be larger than mjMINVAL`. Settings of the compiler correct them:
//!
//! ```
//! # let mut robot = mujoco_safe::spec::Spec::from_xml_str(
//! #     r#"<robot name="r"><link name="tool"><inertial><mass value="1"/>
//! #        <inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#)?;
//! assert!(robot.compile().unwrap_err().to_string().contains("A + B >= C"));
//! robot.section_mut("compiler")?.set("balanceinertia", true)?; // the mean of the three
//! robot.section_mut("compiler")?.set("boundmass", 1e-3)?; // kg, the least mass
//! robot.section_mut("compiler")?.set("boundinertia", 1e-6)?; // kg·m²
//! robot.compile()?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The line in such a message is that of the text of [`Spec::to_xml`](crate::spec::Spec::to_xml).
//! Robots with different values of these settings can be in one scene if all their links have an
//! `<inertial>`. Else set the values of one of them in all, before they are attached.
