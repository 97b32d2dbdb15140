//! Attached models keep their values, whatever the defaults and settings of the spec.

use std::path::Path;

use mujoco_safe::spec::{Mount, Spec};
use mujoco_safe::{Data, Error, math};

use super::parse;
use super::reading::all_models;
use crate::cases::cases;

/// A spec whose defaults and settings differ from those of most models.
const PARENT: &str = "<mujoco>
  <compiler angle='radian' eulerseq='zyx' autolimits='true'/>
  <default>
    <geom size='.77 .5 .3' friction='3 2 1' rgba='0 1 0 1' margin='.01' solref='.3 1' density='5' condim='6'/>
    <joint damping='9' stiffness='8' armature='3' range='-.1 .1' axis='1 0 0' frictionloss='2'/>
    <site size='.3' rgba='0 1 0 1'/>
    <motor gear='77' ctrlrange='-.5 .5' forcerange='-9 9'/>
    <tendon stiffness='5' damping='6' width='.1' rgba='0 1 0 1'/>
    <equality solref='.5 1'/>
    <mesh scale='7 7 7'/>
    <material rgba='0 1 0 1' shininess='.1'/>
    <camera fovy='11'/>
  </default>
  <worldbody><geom name='own_geom'/><site name='own_site'/></worldbody>
</mujoco>";

/// Compares a field of the attached elements, which follow those of the spec.
macro_rules! same {
    ($path:ident $ours:ident $theirs:ident: $($field:ident)*) => {
        $(
            let [ours, theirs] = [&$ours.$field()[..], &$theirs.$field()[..]];
            assert!(ours.len() >= theirs.len());
            let ours = &ours[ours.len() - theirs.len()..];
            for (index, (a, b)) in ours.iter().zip(theirs).enumerate() {
                assert!(near(a, b), "{}: {} of {index}: {a:?}, {b:?}", $path.display(), stringify!($field));
            }
        )*
    };
}

/// Values that can be compared up to rounding.
trait Near: PartialEq + std::fmt::Debug {
    fn distance(&self, other: &Self) -> f64;
}

impl Near for f64 {
    fn distance(&self, other: &Self) -> f64 {
        (self - other).abs() / (1.0 + self.abs())
    }
}

impl Near for f32 {
    fn distance(&self, other: &Self) -> f64 {
        f64::from((self - other).abs())
    }
}

macro_rules! equal {
    ($($kind:ty)*) => {
        $(impl Near for $kind {
            fn distance(&self, other: &Self) -> f64 {
                if self == other { 0.0 } else { f64::INFINITY }
            }
        })*
    };
}
equal!(i32 u8 bool);

impl<T: Near, const N: usize> Near for [T; N] {
    fn distance(&self, other: &Self) -> f64 {
        self.iter().zip(other).map(|(a, b)| a.distance(b)).fold(0.0, f64::max)
    }
}

/// The compiler computes inertias of meshes and angles from numbers that went through text.
fn near<T: Near>(a: &T, b: &T) -> bool {
    a.distance(b) < 1e-9
}

#[test]
fn attached_models_keep_all_values() {
    let (pos, quat) = ([0.3, -0.2, 0.5], [0.8, 0.0, 0.36, -0.48]);
    let mut number = 0;
    for (path, theirs) in all_models() {
        let mut spec = Spec::from_xml_str(PARENT).unwrap();
        let mount = Mount::body(spec.world()).with_pos(pos).with_quat(quat);
        let child = Spec::from_xml_path(&path).unwrap();
        match spec.attach(&child, mount, "c_") {
            Ok(_) => {}
            Err(Error::Unsupported(_)) => continue,
            Err(error) => panic!("{}: {error}", path.display()),
        }
        let ours = spec.compile().unwrap_or_else(|error| panic!("{}: {error}\n{}", path.display(), spec.to_xml()));
        compare(&path, &ours, &theirs);
        number += 1;

        // The whole world has moved.
        let pose = math::Pose { pos, quat };
        let [mut ours, mut theirs] = [Data::new(ours).unwrap(), Data::new(theirs).unwrap()];
        for data in [&mut ours, &mut theirs] {
            data.kinematics().unwrap();
        }
        // Bodies without mass have an arbitrary centre of mass.
        let masses = ours.model().body_mass();
        let centres = ours.xipos().iter().zip(theirs.xipos()).enumerate().filter(|(index, _)| masses[*index] > 0.0);
        for (index, (a, b)) in ours.xpos().iter().zip(theirs.xpos()).enumerate().skip(1).chain(centres) {
            let b = math::trn_vec_pose(&pose, b);
            assert!(
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9),
                "{}: body {index}: {a:?}, {b:?}",
                path.display()
            );
        }
    }
    assert!(number >= cases(3, 10), "{number} models");
}

fn compare(path: &Path, ours: &mujoco_safe::Model, theirs: &mujoco_safe::Model) {
    assert_eq!(ours.nbody(), theirs.nbody(), "{}", path.display());
    assert_eq!([ours.nq(), ours.nv(), ours.nu(), ours.na()], [theirs.nq(), theirs.nv(), theirs.nu(), theirs.na()]);
    same!(path ours theirs:
        body_mass body_inertia
        jnt_type jnt_range jnt_stiffness jnt_axis jnt_pos jnt_limited jnt_margin jnt_solref jnt_solimp
        dof_damping dof_armature dof_frictionloss
        geom_type geom_size geom_friction geom_rgba geom_margin geom_solref geom_solimp geom_condim geom_contype geom_conaffinity geom_solmix
        site_size site_rgba cam_fovy light_diffuse light_castshadow
        mesh_vert mat_rgba mat_shininess mat_specular
        tendon_range tendon_limited tendon_stiffness tendon_damping tendon_width tendon_rgba
        eq_solref eq_solimp pair_solref pair_friction
        actuator_gainprm actuator_biasprm actuator_dynprm actuator_gear actuator_ctrlrange actuator_ctrllimited actuator_forcerange actuator_forcelimited
        sensor_cutoff sensor_noise
    );
}

/// A setting of the compiler that acts on meshes is not taken from an attached spec.
#[test]
fn settings_of_meshes_do_not_change_geoms_in_the_world() {
    let mut spec = parse(
        "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset>
         <worldbody><geom name='g' type='box' mesh='m'/></worldbody></mujoco>",
    );
    let before = spec.compile().unwrap().geom_size().to_vec();
    let child =
        "<mujoco><compiler fitaabb='true'/><worldbody><body name='b'><geom size='.1'/></body></worldbody></mujoco>";
    let mount = Mount::body(spec.world());
    let with_mesh =
        child.replace("<worldbody>", "<asset><mesh name='n' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset><worldbody>");
    let error = spec.attach(&parse(&with_mesh), mount, "").unwrap_err();
    assert!(error.to_string().contains("fitaabb"), "{error}");
    spec.attach(&parse(child), mount, "").unwrap();
    assert_eq!(spec.compile().unwrap().geom_size()[0], before[0]);
}
