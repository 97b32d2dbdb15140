//! Elements of newer engines in saved text.

use mujoco_safe::Model;

use super::lost;

/// Flexes, layers of materials, and attributes of options, cameras, lights, bodies, joints,
/// tendons, actuators and sensors that 2.2.2 lacks.
const TEXT: &str = r#"<mujoco>
  <option ls_tolerance="0.02" ls_iterations="40" ccd_iterations="30" sdf_iterations="12" actuatorgroupdisable="2"/>
  <visual><global cameraid="0" orthographic="true" fovy="2"/></visual>
  <asset>
    <texture name="grid" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 1 0"/>
    <texture name="rough" type="2d" builtin="flat" width="8" height="8" rgb1="1 0 0"/>
    <material name="metal" metallic="0.3" roughness="0.7"><layer role="rgb" texture="grid"/><layer role="roughness" texture="rough"/></material>
  </asset>
  <worldbody>
    <light type="directional" pos="0 0 3" bulbradius="0.1" intensity="3" range="7"/>
    <camera name="pinhole" pos="0 -2 1" resolution="64 48" focal="0.02 0.02" sensorsize="0.01 0.0075"/>
    <geom name="floor" type="plane" size="2 2 0.1" material="metal"/>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing="0.08 0.08 0.08" pos="0 0 0.22" dim="2" radius="0.005" mass="0.2">
      <edge equality="true"/><contact selfcollide="none"/>
    </flexcomp>
    <flexcomp name="rope" type="grid" count="4 1 1" spacing="0.05 0.05 0.05" pos="0.5 0 0.05" dim="1" radius="0.01" mass="0.1">
      <edge stiffness="100" damping="0.1"/><pin id="0"/>
    </flexcomp>
    <flexcomp name="block" type="grid" count="3 3 3" spacing="0.05 0.05 0.05" pos="-0.5 0 0.1" dim="3" radius="0.005" mass="0.5">
      <edge damping="1"/><elasticity young="5e3" poisson="0.3"/><contact selfcollide="none"/>
    </flexcomp>
    <body name="arm" gravcomp="0.4">
      <joint name="hinge" axis="0 1 0" damping="0.1" armature="0.01" actuatorfrcrange="-3 3" actuatorgravcomp="true"/>
      <geom name="link" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/><site name="tip" pos="0.3 0 0"/>
      <body pos="0.3 0 0"><joint name="elbow" axis="0 1 0" range="-90 90"/><geom type="box" size="0.1 0.02 0.02" pos="0.1 0 0"/><site name="end"/></body>
    </body>
  </worldbody>
  <contact><pair geom1="floor" geom2="link" solreffriction="0.03 1.1"/></contact>
  <equality><connect site1="tip" site2="end" active="false"/></equality>
  <tendon><fixed name="tendon" armature="0.01" actuatorfrcrange="-2 2" springlength="0.1 0.2"><joint joint="hinge" coef="1"/></fixed></tendon>
  <actuator>
    <position name="servo" joint="hinge" kp="20" dampratio="1"/>
    <general name="filter" joint="elbow" dyntype="filterexact" dynprm="0.1" actearly="true" group="1"/>
  </actuator>
  <sensor>
    <jointactuatorfrc joint="hinge"/><tendonactuatorfrc tendon="tendon"/><distance geom1="link" geom2="floor"/>
    <contact geom1="link" num="2" data="found force"/><insidesite site="tip" objtype="site" objname="end"/>
  </sensor>
</mujoco>"#;

#[test]
fn elements_of_newer_engines_save_without_loss() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("newer.xml");
    let model = Model::from_xml_str(TEXT).unwrap();
    assert_eq!(lost(|| model.clone(), &path).unwrap(), [""; 0]);
    let again = Model::from_xml_path(&path).unwrap();
    assert_eq!((again.nflexvert(), again.nflexedge()), (model.nflexvert(), model.nflexedge()));
    assert!(again.flex_stiffness() == model.flex_stiffness() && again.body_gravcomp() == model.body_gravcomp());
}

#[test]
fn edits_of_elements_of_newer_engines_are_saved_or_named() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("newer.xml");
    let model = Model::from_xml_str(TEXT).unwrap();
    let mut edited = model.clone();
    edited.edit().edit_options(|options| options.ls_iterations = 17).unwrap();
    assert_eq!(lost(|| edited, &path).unwrap(), [""; 0]);
    let mut edited = model.clone();
    let vertex = edited.nbody() - 1;
    edited.edit().body_mass_mut()[vertex] *= 2.0;
    edited.edit().update_constants().unwrap();
    let mut lost = lost(|| edited.clone(), &path).unwrap();
    // It stays in an edited model with armature of tendons, which the documentation of
    // `update_constants` states.
    lost.retain(|field| field != "stat.meaninertia");
    let again = Model::from_xml_path(&path).unwrap();
    let is_carried = again.body_mass() == edited.body_mass();
    assert_eq!(lost.contains(&"body_mass".to_owned()), !is_carried);
    assert_eq!(lost.is_empty(), is_carried, "{lost:?}");
    assert_eq!(again.options().ls_iterations, 40);
}

#[test]
fn an_edited_pose_of_a_weld_is_saved_after_an_update() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("weld.xml");
    let mut model = Model::from_xml_str(
        "<mujoco><worldbody>
           <body name='one'><freejoint/><geom size='.1'/></body><body name='two' pos='1 0 0'><freejoint/><geom size='.1'/></body>
         </worldbody><equality><weld name='grasp' body1='one' body2='two'/></equality></mujoco>",
    )
    .unwrap();
    model.edit().equality_mut("grasp").unwrap().data_mut()[3..10].copy_from_slice(&[0.0, 0.0, 0.5, 0.6, 0.8, 0.0, 0.0]);
    model.edit().update_constants().unwrap();
    assert_eq!(lost(|| model, &path).unwrap(), [""; 0]);
    let again = Model::from_xml_path(&path).unwrap();
    assert_eq!(again.equality("grasp").unwrap().data()[3..10], [0.0, 0.0, 0.5, 0.6, 0.8, 0.0, 0.0]);
}
