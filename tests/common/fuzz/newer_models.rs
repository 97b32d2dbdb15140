//! Models and fragments of MJCF with elements that 2.2.2 lacks. All models are small, so that a
//! step is fast.

use mujoco_safe::Version;

/// A model, and the first version that must load it. Models without a version may be rejected by
/// any engine.
pub(super) struct Newer {
    pub(super) name: &'static str,
    /// Relative number of cases with this model.
    pub(super) share: usize,
    pub(super) since: Option<Version>,
    pub(super) text: &'static str,
}

const fn version(major: u32, minor: u32, patch: u32) -> Version {
    Version { major, minor, patch }
}

pub(super) const NEWER: [Newer; 17] = [
    Newer { name: "rope", share: 240, since: Some(version(3, 5, 0)), text: ROPE },
    Newer { name: "cloth", share: 160, since: Some(version(3, 5, 0)), text: CLOTH },
    Newer { name: "soft block", share: 120, since: Some(version(3, 5, 0)), text: BLOCK },
    Newer { name: "trilinear block", share: 120, since: Some(version(3, 5, 0)), text: TRILINEAR },
    Newer { name: "islands", share: 240, since: Some(version(3, 5, 0)), text: ISLANDS },
    Newer { name: "newer sensors", share: 240, since: Some(version(3, 5, 0)), text: SENSORS },
    Newer { name: "tactile sensor", share: 40, since: Some(version(3, 5, 0)), text: TACTILE },
    Newer { name: "many shapes", share: 400, since: Some(version(3, 5, 0)), text: SHAPES },
    Newer { name: "newer actuators", share: 240, since: Some(version(3, 17, 0)), text: ACTUATORS },
    Newer { name: "sleep", share: 240, since: Some(version(3, 5, 0)), text: SLEEP },
    Newer { name: "delays", share: 240, since: Some(version(3, 5, 0)), text: DELAYS },
    Newer { name: "several controls", share: 240, since: Some(version(3, 17, 0)), text: CONTROLS },
    Newer { name: "strain", share: 120, since: Some(version(3, 17, 0)), text: STRAIN },
    Newer { name: "all actuators", share: 400, since: Some(version(3, 17, 0)), text: ALL_ACTUATORS },
    Newer { name: "flex contacts", share: 80, since: None, text: IPC },
    Newer { name: "plugins", share: 24, since: None, text: PLUGINS },
    Newer { name: "cable plugin", share: 60, since: None, text: CABLE },
];

/// A rope with a pinned end, on a floor and a ball.
const ROPE: &str = r#"<mujoco>
  <size memory="200K"/>
  <worldbody>
    <geom type="plane" size="1 1 .1"/><geom size=".05" pos=".1 0 .02"/>
    <flexcomp name="rope" type="grid" count="4 1 1" spacing=".05 .05 .05" pos="0 0 .08" dim="1" radius=".01" mass=".1">
      <edge stiffness="100" damping=".1"/><pin id="0"/>
    </flexcomp>
  </worldbody>
  <keyframe><key name="key" time="1"/></keyframe>
</mujoco>"#;

/// A cloth with edges as equality constraints and a skin, above a ball that moves.
const CLOTH: &str = r#"<mujoco>
  <size memory="600K"/>
  <option solver="CG" iterations="10"/>
  <asset><texture name="t" type="2d" builtin="checker" width="4" height="4"/><material name="m" texture="t"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <body pos="0 0 .1"><joint name="x" type="slide" axis="1 0 0"/><geom size=".1"/></body>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".08 .08 .08" pos="0 0 .21" dim="2" radius=".005" mass=".2" material="m">
      <edge equality="true" damping=".01"/><contact selfcollide="bvh" condim="4"/>
    </flexcomp>
  </worldbody>
  <actuator><motor joint="x"/></actuator>
</mujoco>"#;

/// A soft body in contact with a floor and a box.
const BLOCK: &str = r#"<mujoco>
  <size memory="600K"/>
  <option cone="elliptic" iterations="10"/>
  <worldbody>
    <geom type="plane" size="1 1 .1"/><geom type="box" size=".1 .1 .02" pos=".05 0 0"/>
    <flexcomp name="block" type="grid" count="2 2 2" spacing=".1 .1 .1" pos="0 0 .07" dim="3" radius=".005" mass=".5">
      <edge damping="1"/><elasticity young="5e3" poisson=".3" damping=".1"/><contact selfcollide="auto"/>
    </flexcomp>
  </worldbody>
</mujoco>"#;

/// A soft body whose vertices are interpolated.
const TRILINEAR: &str = r#"<mujoco>
  <size memory="600K"/>
  <option iterations="10"/>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <flexcomp name="block" type="grid" count="3 3 3" spacing=".05 .05 .05" pos="0 0 .06" dim="3" radius=".005" mass=".5" dof="trilinear">
      <elasticity young="5e3" poisson=".3"/><contact selfcollide="none"/>
    </flexcomp>
  </worldbody>
</mujoco>"#;

/// Separate groups of bodies in contact, a limit and a tendon between trees.
const ISLANDS: &str = r#"<mujoco>
  <size memory="400K"/>
  <option iterations="10"/>
  <worldbody>
    <geom type="plane" size="3 3 .1"/>
    <body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body pos="1 0 .1"><freejoint/><geom size=".1" condim="6"/></body>
    <body pos="1 0 .29"><freejoint/><geom type="ellipsoid" size=".1 .1 .1"/></body>
    <body pos="2 0 .5"><joint name="a" axis="0 1 0" range="-.1 .1" limited="true" frictionloss=".1"/><geom type="capsule" size=".02 .1"/></body>
    <body pos="2 1 .5"><joint name="b" axis="0 1 0"/><geom type="capsule" size=".02 .1"/></body>
  </worldbody>
  <tendon><fixed name="t" limited="true" range="-.01 .2"><joint joint="a" coef="1"/><joint joint="b" coef="-1"/></fixed></tendon>
  <equality><joint joint1="a" joint2="b" active="false"/></equality>
  <actuator><motor joint="a"/><position joint="b" kp="10"/></actuator>
  <keyframe><key name="key" time="1"/></keyframe>
</mujoco>"#;

/// Sensors and limits of newer engines.
const SENSORS: &str = r#"<mujoco>
  <size memory="200K"/>
  <option integrator="implicitfast"><flag energy="enable"/></option>
  <asset><mesh name="tetrahedron" vertex="0 0 0  .1 0 0  0 .1 0  0 0 .1"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <camera name="camera" pos="0 -3 1" xyaxes="1 0 0 0 0 1" resolution="8 6"/>
    <site name="zone" type="box" size=".5 .5 .5"/>
    <body pos="0 0 2" gravcomp=".5">
      <joint name="hinge" axis="0 1 0" damping=".1" actuatorfrclimited="true" actuatorfrcrange="-1 1"/>
      <geom name="rod" type="capsule" size=".05" fromto="0 0 0 .5 0 -.5" mass="1"/>
      <site name="tip" pos=".5 0 -.5" zaxis="0 0 -1"/>
    </body>
    <body name="ball" pos="0 0 .09">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
      <geom name="ball" size=".1" mass="2"/>
      <geom name="skin" type="mesh" mesh="tetrahedron" contype="0" conaffinity="0" mass=".01"/>
    </body>
  </worldbody>
  <tendon><fixed name="tendon"><joint joint="hinge" coef=".5"/></fixed></tendon>
  <actuator>
    <motor joint="hinge" group="1"/><motor tendon="tendon"/>
    <general joint="hinge" dyntype="filterexact" dynprm=".1" gainprm="3" actearly="true" group="2"/>
  </actuator>
  <sensor>
    <jointactuatorfrc joint="hinge"/><tendonactuatorfrc tendon="tendon"/><camprojection site="tip" camera="camera"/>
    <distance geom1="ball" geom2="floor" cutoff="1"/><normal geom1="floor" geom2="rod" cutoff="3"/>
    <fromto body1="ball" geom2="rod" cutoff="3"/><e_potential/><e_kinetic/>
    <insidesite site="zone" objtype="geom" objname="ball"/>
    <contact geom1="floor" geom2="ball" num="2" data="found force dist normal tangent"/><contact reduce="netforce" subtree1="ball"/>
    <rangefinder site="tip"/><rangefinder camera="camera" data="dist point"/>
  </sensor>
</mujoco>"#;

/// A tactile sensor, which binary models must not have.
const TACTILE: &str = r#"<mujoco>
  <size memory="200K"/>
  <asset><mesh name="tetrahedron" vertex="0 0 0  .1 0 0  0 .1 0  0 0 .1"/></asset>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body pos="0 0 .09">
      <freejoint/><geom size=".1" mass="2"/><geom name="skin" type="mesh" mesh="tetrahedron" contype="0" conaffinity="0" mass=".01"/>
    </body>
  </worldbody>
  <sensor><tactile geom="skin" mesh="tetrahedron"/></sensor>
</mujoco>"#;

/// Several shapes of a body in contact, hulls with large and small faces, several contact points, a
/// height field, textures, a mocap body, constraints of sites and tendons between trees.
const SHAPES: &str = r#"<mujoco>
  <size memory="600K"/>
  <option iterations="10" cone="elliptic"><flag multiccd="enable"/></option>
  <asset>
    <texture name="checks" type="2d" builtin="checker" width="4" height="6"/><texture name="sky" type="skybox" builtin="gradient" width="4" height="24"/>
    <material name="m" texture="checks"/><material name="layers"><layer role="rgb" texture="checks"/><layer role="normal" texture="checks"/></material>
    <mesh name="cube" vertex="0 0 0  .2 0 0  0 .2 0  .2 .2 0  0 0 .2  .2 0 .2  0 .2 .2  .2 .2 .2" texcoord="0 0  1 0  0 1  1 1  0 0  1 0  0 1  1 1"
          face="0 2 1  1 2 3  4 5 6  5 7 6  0 1 4  1 5 4  2 6 3  3 6 7  0 4 2  2 4 6  1 3 5  3 7 5"/>
    <mesh name="ball" vertex=".1 0 0  -.1 0 0  0 .1 0  0 -.1 0  0 0 .1  0 0 -.1  .07 .07 .01  -.07 .07 .02  .07 -.07 .01  -.07 -.07 .02  .01 .01 .01"/>
    <hfield name="hills" nrow="4" ncol="5" size="1 1 .1 .1"/>
  </asset>
  <worldbody>
    <light type="image" texture="sky"/><light type="point" mode="targetbody" target="pile" pos="0 0 2"/>
    <camera name="c" mode="targetbodycom" target="pile" pos="1 1 1" resolution="5 4" projection="orthographic"/>
    <geom name="floor" type="plane" size="3 3 .1" material="m"/><geom type="hfield" hfield="hills" pos="3 0 0"/><site name="anchor" pos="0 0 1"/>
    <body name="pile" pos="0 0 .1"><freejoint/>
      <geom type="mesh" mesh="cube" material="layers"/><geom name="sphere" size=".1" pos=".3 0 0"/><geom type="capsule" size=".05 .1" pos="-.3 0 0"/><site name="s"/>
    </body>
    <body pos="0 0 .35"><freejoint/><geom type="box" size=".1 .1 .1"/><geom type="mesh" mesh="cube" pos=".25 0 0"/></body>
    <body name="round" pos="3 0 .3"><freejoint/><geom name="round" type="mesh" mesh="ball"/><geom type="cylinder" size=".05 .1" pos=".2 0 0"/></body>
    <body name="hand" mocap="true" pos="0 1 1"><geom size=".05" contype="0" conaffinity="0"/></body>
    <body pos="1 1 1" gravcomp="1"><joint name="a" type="slide" axis="1 0 0"/><joint name="b" type="slide" axis="0 1 0"/><geom size=".1"/><site name="t"/></body>
    <body pos="-1 1 1"><joint name="c" axis="0 1 0" range="-.1 .1"/><geom size=".1" pos=".2 0 0"/><site name="u" pos=".2 0 0"/></body>
  </worldbody>
  <contact><pair geom1="floor" geom2="round" condim="6"/><exclude body1="pile" body2="hand"/></contact>
  <equality><connect site1="s" site2="anchor" active="false"/><weld body1="hand" body2="round"/><joint joint1="a" joint2="b"/></equality>
  <tendon>
    <spatial name="rope" armature=".1" range="0 2"><site site="t"/><site site="u"/><pulley divisor="2"/><site site="s"/><site site="anchor"/></spatial>
    <spatial name="wrapped" stiffness="1"><site site="t"/><geom geom="sphere" sidesite="anchor"/><site site="u"/></spatial>
    <fixed name="coupled" frictionloss=".1"><joint joint="a" coef="1"/><joint joint="c" coef="-1"/></fixed>
  </tendon>
  <actuator>
    <motor tendon="rope"/><position joint="c" nsample="3" delay=".004"/><general site="s" refsite="anchor" gear="0 0 1 0 0 0"/><adhesion body="pile" ctrlrange="0 1"/>
    <muscle tendon="coupled" lengthrange="-1 1"/>
  </actuator>
  <sensor>
    <rangefinder camera="c" data="dist normal"/><contact geom1="floor" num="3" reduce="maxforce" data="found force pos"/><tendonpos tendon="rope" nsample="2" interval=".004"/>
    <distance body1="round" body2="pile" cutoff="2"/><framepos objtype="geom" objname="round" reftype="camera" refname="c"/>
  </sensor>
  <keyframe><key name="key" time="1" mpos="0 1 1"/></keyframe>
  <custom><tuple name="all"><element objtype="mesh" objname="cube"/><element objtype="tendon" objname="rope"/></tuple></custom>
</mujoco>"#;

/// Actuators that integrate, and a muscle.
const ACTUATORS: &str = r#"<mujoco>
  <size memory="200K"/>
  <option integrator="discrete"/>
  <worldbody>
    <body>
      <joint name="hinge" axis="0 1 0" damping=".1"/><geom type="capsule" size=".05" fromto="0 0 0 .5 0 -.5"/><site name="tip" pos=".5 0 -.5"/>
      <body pos=".5 0 -.5"><joint name="slide" type="slide"/><geom size=".1"/></body>
    </body>
  </worldbody>
  <actuator>
    <dcmotor name="motor" joint="hinge" resistance="2" motorconst=".5 .5"/>
    <dcmotor joint="slide" resistance="2" motorconst=".5 .5" inductance=".1"/>
    <pid joint="hinge" kp="5" kv=".5" ki="2" imax="1" input="pos"/>
    <general joint="slide" dyntype="filterexact" dynprm=".1" actlimited="true" actrange="-1 1"/>
    <muscle joint="hinge" lengthrange="-1 1"/>
  </actuator>
  <sensor><actuatorfrc actuator="motor"/><accelerometer site="tip"/></sensor>
</mujoco>"#;

const SLEEP: &str = r#"<mujoco>
  <size memory="200K"/>
  <option><flag sleep="enable"/></option>
  <worldbody>
    <geom type="plane" size="3 3 .1"/>
    <body pos="0 0 .1" sleep="allowed"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body pos="1 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body pos="1 0 .3"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body pos="2 0 .5"><joint name="a" axis="0 1 0"/><geom type="capsule" size=".02 .1"/></body>
  </worldbody>
  <actuator><motor joint="a"/></actuator>
</mujoco>"#;

/// Actuators and sensors with delays, and sensors with samples at intervals.
const DELAYS: &str = r#"<mujoco>
  <size memory="200K"/>
  <worldbody>
    <geom type="plane" size="1 1 .1" pos="0 0 -.2"/>
    <body><joint name="a" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/><site name="s" pos=".3 0 0" size=".2"/></body>
  </worldbody>
  <actuator>
    <motor name="first" joint="a" nsample="4" delay=".005"/><motor joint="a"/>
    <general joint="a" dyntype="filter" dynprm=".1" nsample="5" delay=".007" interp="cubic"/><motor joint="a" nsample="1"/>
  </actuator>
  <sensor>
    <jointpos joint="a" nsample="3" delay=".004" interp="linear"/><accelerometer site="s" nsample="2" interval=".01"/>
    <touch site="s" nsample="6" delay=".005" interval=".004 -.001" interp="cubic"/><jointvel joint="a" nsample="1"/>
    <framepos objtype="site" objname="s" nsample="4" delay=".003"/><actuatorfrc actuator="first" nsample="2" delay=".002"/>
  </sensor>
  <keyframe><key name="key" time="1"/></keyframe>
</mujoco>"#;

/// Actuators with several controls, forces and activations between others with one.
const CONTROLS: &str = r#"<mujoco>
  <size memory="200K"/>
  <worldbody>
    <site name="w"/>
    <body><joint name="ball" type="ball"/><geom size=".1" pos=".1 0 0"/><site name="s" pos=".1 0 0"/>
      <body pos=".3 0 0"><joint name="a" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body></body>
  </worldbody>
  <actuator>
    <motor name="first" joint="a"/><orientation name="turn" joint="ball" kp="3" kv=".2"/>
    <pid name="servo" joint="a" kp="5" kv=".5" ki="2" input="pos vel"/><orientation site="s" refsite="w" kp="2"/>
    <dcmotor joint="a" motorconst=".1 .1" resistance="1" inductance=".1" thermal="1 1"/><motor joint="a" ctrlrange="-1 1"/>
  </actuator>
  <sensor><actuatorpos actuator="turn"/><actuatorvel actuator="servo"/><actuatorfrc actuator="turn"/><jointactuatorfrc joint="a"/></sensor>
</mujoco>"#;

/// Flexes whose cells keep their strain, and equality constraints of all other types.
const STRAIN: &str = r#"<mujoco>
  <size memory="4M"/>
  <option iterations="5"/>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <body name="a" pos="0 1 .5"><joint name="a" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/></body>
    <body name="b" pos="0 2 .5"><joint name="b" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/></body>
    <flexcomp name="block" type="grid" count="5 3 3" spacing=".05 .05 .05" pos="0 0 .2" dim="3" radius=".005" mass=".5" dof="trilinear" cellcount="2 1 1">
      <edge equality="strain"/><contact selfcollide="none"/>
    </flexcomp>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".05 .05 .05" pos="2 0 .2" dim="2" radius=".005" mass=".5">
      <edge equality="true"/><contact selfcollide="none"/>
    </flexcomp>
  </worldbody>
  <tendon><fixed name="a"><joint joint="a" coef="1"/></fixed><fixed name="b"><joint joint="b" coef="1"/></fixed></tendon>
  <equality><connect body1="a" body2="b" anchor="0 0 0"/><weld body1="a" body2="b"/><joint joint1="a" joint2="b"/><tendon tendon1="a" tendon2="b"/></equality>
</mujoco>"#;

/// Actuators of all types, PID controllers and DC motors with each of their states. The crank is
/// before those with several forces.
const ALL_ACTUATORS: &str = r#"<mujoco>
  <size memory="400K" nuserdata="4"/>
  <worldbody>
    <site name="world"/>
    <body name="arm"><joint name="hinge" axis="0 1 0" damping=".1"/><geom type="capsule" size=".05" fromto="0 0 0 .5 0 -.5"/><site name="tip" pos=".5 0 -.5"/>
      <body pos=".5 0 -.5"><joint name="slide" type="slide" range="-1 1"/><geom size=".1"/><site name="slider"/>
        <body pos=".2 0 0"><joint name="ball" type="ball"/><geom size=".1" pos=".1 0 0"/></body></body></body>
  </worldbody>
  <tendon><spatial name="rope" range="0 2"><site site="world"/><site site="slider"/></spatial></tendon>
  <actuator>
    <general cranksite="tip" slidersite="world" cranklength=".1"/><general site="tip" refsite="world" gear="0 0 1 0 1 0"/><motor jointinparent="ball"/>
    <general name="affine" joint="hinge" biastype="affine" gaintype="affine" gainprm="1 1 1" biasprm="0 1 1"/>
    <general joint="slide" dyntype="integrator" actrange="-1 1" actlimited="true"/><general joint="slide" dyntype="filter" dynprm=".1"/>
    <general joint="slide" dyntype="filterexact" dynprm=".1" actearly="true"/>
    <general joint="slide" dyntype="user" actdim="3" gaintype="user" biastype="user" lengthrange="-1 1"/><muscle tendon="rope" lengthrange="0 1"/>
    <position joint="slide" kp="1" kv="1" timeconst=".1"/><intvelocity joint="slide" kp="1" actrange="-1 1"/><velocity joint="slide" kv="1"/>
    <damper joint="slide" kv="1" ctrlrange="0 1"/><cylinder joint="slide" timeconst="1"/><motor joint="slide" nsample="4" delay=".005"/>
    <pid joint="hinge" kp="5" kv=".5"/><pid name="integral" joint="hinge" kp="5" ki="2" imax="1" input="pos"/>
    <pid name="slew" joint="hinge" kp="5" slewmax="1" input="pos"/><pid name="both" joint="hinge" kp="5" ki="2" slewmax="1" input="pos vel ff"/>
    <orientation joint="ball" kp="3" kv=".2"/><orientation site="slider" refsite="world" kp="2"/>
    <dcmotor joint="hinge" resistance="2" motorconst=".5 .5"/><dcmotor name="current" joint="hinge" resistance="2" motorconst=".5 .5" inductance=".1"/>
    <dcmotor joint="hinge" resistance="2" motorconst=".5 .5" thermal="1 1 .01 25 25 100"/><dcmotor joint="hinge" resistance="2" motorconst=".5 .5" lugre="1 1 1 1 1"/>
    <dcmotor name="all" joint="hinge" resistance="2" motorconst=".5 .5" inductance=".1" thermal="1 1 .01 25 25 100" lugre="1 1 1 1 1" cogging=".1 4 0"
             input="pos vel" controller="1 1 1 1 1 1" saturation="10 10 10"/>
  </actuator>
  <sensor><actuatorpos actuator="both"/><actuatorvel actuator="all"/><actuatorfrc actuator="current"/></sensor>
  <keyframe><key name="key" time="1"/></keyframe>
</mujoco>"#;

const IPC: &str = r#"<mujoco>
  <size memory="600K"/>
  <option integrator="discrete"><flag ipc="enable"/></option>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".08 .08 .08" pos="0 0 .05" dim="2" radius=".005" mass=".2"/>
  </worldbody>
</mujoco>"#;

/// All plugins of a wheel except that of cables. Loads if the program has loaded the plugins.
const PLUGINS: &str = r#"<mujoco>
  <size memory="1M"/>
  <option iterations="10" sdf_iterations="5" sdf_initpoints="10"/>
  <extension>
    <plugin plugin="mujoco.pid"><instance name="pid"><config key="kp" value="40"/><config key="ki" value="5"/><config key="kd" value="1"/><config key="imax" value="3"/><config key="slewmax" value="3"/></instance></plugin>
    <plugin plugin="mujoco.sensor.touch_grid"/>
    <plugin plugin="mujoco.sdf.torus"><instance name="torus"><config key="radius1" value=".2"/><config key="radius2" value=".1"/></instance></plugin>
    <plugin plugin="mujoco.sdf.bowl"><instance name="bowl"/></plugin><plugin plugin="mujoco.sdf.gear"><instance name="gear"/></plugin>
    <plugin plugin="mujoco.sdf.nut"><instance name="nut"/></plugin><plugin plugin="mujoco.sdf.bolt"><instance name="bolt"/></plugin>
  </extension>
  <asset>
    <mesh name="torus"><plugin instance="torus"/></mesh><mesh name="bowl"><plugin instance="bowl"/></mesh><mesh name="gear"><plugin instance="gear"/></mesh>
    <mesh name="nut"><plugin instance="nut"/></mesh><mesh name="bolt"><plugin instance="bolt"/></mesh>
  </asset>
  <worldbody>
    <geom type="plane" size="0 0 1"/><geom type="sdf" mesh="bowl" pos="0 0 .5"><plugin instance="bowl"/></geom>
    <body pos="0 0 .6"><freejoint/><geom type="sdf" mesh="torus"><plugin instance="torus"/></geom><site name="pad" size=".1"/></body>
    <body pos="0 0 .2"><joint name="a" axis="0 1 0"/><geom type="sdf" mesh="gear" mass="1"><plugin instance="gear"/></geom></body>
    <body pos="1 0 .2"><freejoint/><geom type="sdf" mesh="nut"><plugin instance="nut"/></geom></body>
    <body pos="1 0 .1"><joint name="b" type="slide" axis="0 0 1"/><geom type="sdf" mesh="bolt"><plugin instance="bolt"/></geom></body>
  </worldbody>
  <actuator><plugin joint="a" plugin="mujoco.pid" instance="pid" actdim="2"/><motor joint="a"/><plugin joint="b" plugin="mujoco.pid"><config key="kp" value="3"/></plugin></actuator>
  <sensor><jointpos joint="a"/>
    <plugin name="grid" plugin="mujoco.sensor.touch_grid" objtype="site" objname="pad"><config key="size" value="3 2"/><config key="fov" value="40 30"/><config key="gamma" value="0"/><config key="nchannel" value="3"/></plugin>
  </sensor>
</mujoco>"#;

/// The plugin of engines before 4.0.
const CABLE: &str = r#"<mujoco>
  <size memory="400K"/>
  <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <composite type="cable" curve="s" count="5 1 1" size=".4" offset="0 0 .1" initial="none">
      <plugin plugin="mujoco.elasticity.cable"><config key="twist" value="1e5"/><config key="bend" value="1e6"/><config key="vmax" value=".1"/></plugin>
      <joint kind="main" damping=".1"/><geom type="capsule" size=".01" density="1000"/>
    </composite>
  </worldbody>
</mujoco>"#;

/// Values of attributes that 2.2.2 lacks.
pub(super) const VALUES: [&str; 18] = [
    "implicitfast",
    "discrete",
    "trilinear",
    "quadratic",
    "sap",
    "bvh",
    "direct",
    "disc",
    "circle",
    "full",
    "radial",
    "cable",
    "sdf",
    "filterexact",
    "never",
    "init",
    "linear",
    "enable",
];

/// Elements that 2.2.2 lacks.
#[rustfmt::skip]
pub(super) const PIECES: [&str; 23] = [
    "<flexcomp name='q' type='grid' count='3 3 1' spacing='.1 .1 .1' dim='2' radius='.01' mass='.1'><edge equality='true'/></flexcomp>",
    "<flexcomp name='q' type='grid' count='3 3 3' spacing='.1 .1 .1' dim='3' radius='.01' mass='.1' dof='trilinear'><elasticity young='1e4' poisson='.3'/></flexcomp>",
    "<flexcomp name='q' type='direct' dim='2' point='0 0 0 1 0 0 0 1 0' element='0 1 2' radius='.01' mass='.1'><pin id='0'/></flexcomp>",
    "<flexcomp name='q' type='circle' count='5 1 1' spacing='.1 .1 .1' dim='1' radius='.01' mass='.1'><edge stiffness='10' damping='.1'/></flexcomp>",
    "<flexcomp name='q' type='box' count='3 3 3' spacing='.1 .1 .1' dim='3' rigid='true'><contact selfcollide='auto'/></flexcomp>",
    "<deformable><flex name='q' dim='1' body='world world' vertex='0 0 0 1 0 0' element='0 1' radius='.01'/></deformable>",
    "<equality><flex flex='q'/></equality>",
    "<replicate count='3' offset='.1 0 0' euler='0 0 10'><geom size='.1'/></replicate>",
    "<frame pos='1 0 0' euler='0 90 0'><geom size='.1'/></frame>",
    "<mesh name='q' builtin='supersphere' params='10 1 1'/>",
    "<mesh name='q' builtin='plate' params='3 3'/>",
    "<position joint='hinge' kp='3' dampratio='1' timeconst='.1' inheritrange='1'/>",
    "<pid joint='hinge' kp='5' kv='.5' ki='2' imax='1' input='pos'/>",
    "<dcmotor joint='hinge' resistance='1' motorconst='1 1' inductance='.1'/>",
    "<orientation joint='ball' kp='3' kv='1'/>",
    "<motor joint='hinge' nsample='3' delay='.01'/>",
    "<contact num='3' data='found force dist pos normal tangent' reduce='mindist'/>",
    "<distance body1='world' body2='ball' cutoff='1'/>",
    "<composite type='cable' curve='s' count='5 1 1' size='1' initial='none'><joint kind='main' damping='.1'/><geom type='capsule' size='.01'/></composite>",
    "<size memory='100K'/>",
    "<option integrator='discrete'><flag sleep='enable' ipc='enable' multiccd='enable' nativeccd='disable'/></option>",
    "<model name='q' file='part.xml'/>",
    "<material name='q'><layer texture='texture' role='rgb'/><layer texture='texture' role='normal'/></material>",
];
