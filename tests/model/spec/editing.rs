//! Changes of specs.

use mujoco_safe::kind::{Body, Geom};
use mujoco_safe::spec::{Mount, Spec};

use super::{parse, same};

const ARM: &str = "<mujoco>
  <worldbody>
    <body name='upper'><joint name='shoulder'/><geom name='a' size='.1'/>
      <body name='lower' pos='1 0 0'><joint name='elbow'/><geom name='b' size='.1'/><site name='tip'/></body>
    </body>
  </worldbody>
  <tendon><fixed name='both'><joint joint='shoulder' coef='1'/><joint joint='elbow' coef='1'/></fixed></tendon>
  <actuator><motor name='m' joint='elbow'/><motor name='t' tendon='both'/></actuator>
  <sensor><framepos name='s' objtype='site' objname='tip' reftype='body' refname='upper'/><jointpos joint='shoulder'/></sensor>
  <contact><exclude body1='upper' body2='lower'/></contact>
</mujoco>";

#[test]
fn renaming_an_element_renames_all_references() {
    let mut spec = parse(ARM);
    spec.joint_mut("elbow").unwrap().set_name("knee");
    spec.body_mut("upper").unwrap().set_name("thigh");
    spec.site_mut("tip").unwrap().set_name("toe");
    spec.tendon_mut("both").unwrap().set_name("sum");
    let expected = ARM.replace("elbow", "knee").replace("upper", "thigh").replace("tip", "toe").replace("both", "sum");
    same(&spec, &expected);
}

#[test]
fn elements_exchange_their_names_by_way_of_a_third_one() {
    let mut spec = parse(ARM);
    for (old, new) in [("shoulder", "joint"), ("elbow", "shoulder"), ("joint", "elbow")] {
        spec.joint_mut(old).unwrap().set_name(new);
    }
    same(&spec, &ARM.replace("shoulder", "joint").replace("elbow", "shoulder").replace("joint'", "elbow'"));
}

#[test]
fn removing_an_element_needs_its_references_to_be_removed() {
    let mut spec = parse(ARM);
    let before = spec.to_xml();
    let lower = spec.body("lower").unwrap().id();
    let error = spec.remove(lower).unwrap_err().to_string();
    for referrer in ["fixed 'both'", "motor 'm'", "framepos 's'", "exclude"] {
        assert!(error.contains(referrer), "{referrer}: {error}");
    }
    assert_eq!(spec.to_xml(), before);
    let geom = spec.geom("b").unwrap().id();
    spec.remove(geom).unwrap();
    assert!(!spec.contains(geom));

    // The tendon is removed with its joint, and the motor with its tendon.
    spec.remove_with_references(lower).unwrap();
    same(
        &spec,
        "<mujoco><worldbody><body name='upper'><joint name='shoulder'/><geom name='a' size='.1'/></body></worldbody>
         <sensor><jointpos joint='shoulder'/></sensor></mujoco>",
    );
    let world = spec.world();
    assert!(spec.remove(world).is_err());
}

#[test]
fn removing_a_class_or_a_material_keeps_the_elements_that_have_it() {
    let mut spec = parse(
        "<mujoco><default><default class='c'><geom size='.3'/></default></default>
         <asset><texture name='t' type='2d' builtin='flat' width='2' height='2'/><material name='m' texture='t'/></asset>
         <worldbody childclass='c'><geom name='g' class='c' material='m' size='.1'/>
           <body childclass='c'><geom material='m' size='.2'/></body></worldbody></mujoco>",
    );
    let class = spec.default_mut("c", "geom").unwrap().view().parent().unwrap();
    assert!(spec.remove(class).is_err());
    let [material, texture] = [spec.material("m").unwrap().id().any(), spec.texture("t").unwrap().id().any()];
    for id in [class, texture] {
        spec.remove_with_references(id).unwrap();
    }
    assert!(spec.contains(material));
    spec.remove_with_references(material).unwrap();
    same(&spec, "<mujoco><worldbody><geom name='g' size='.1'/><body><geom size='.2'/></body></worldbody></mujoco>");
}

#[test]
fn ids_stay_valid_when_other_elements_change() {
    let mut spec = parse(ARM);
    let ids: Vec<_> = spec.ids::<Geom>();
    let upper = spec.body("upper").unwrap().id();
    spec.remove(ids[0]).unwrap();
    for _ in 0..10 {
        spec.add_geom(upper).set_size(&[0.2]);
    }
    assert_eq!(spec.geom(ids[1]).name(), Some("b"));
    let copy = spec.clone();
    assert_eq!(copy.geom(ids[1]).name(), Some("b"));
    assert!(!copy.contains(ids[0]));
    assert_eq!(spec.typed::<Body>(upper.any()), Some(upper));
    assert_eq!(spec.typed::<Geom>(upper.any()), None);
}

#[test]
#[should_panic(expected = "another spec")]
fn an_id_of_another_spec_panics() {
    let [mut one, two] = [Spec::new("one"), Spec::new("two")];
    one.add_geom(two.world());
}

#[test]
fn elements_that_are_added_after_a_clone_belong_to_one_spec_only() {
    let mut spec = parse(ARM);
    let upper = spec.body("upper").unwrap().id();
    let mut copy = spec.clone();
    assert_eq!(copy.body("upper").unwrap().id(), upper);
    let ours = spec.add_body(upper).set_name("ours").id();
    let theirs = copy.add_geom(upper).set_name("theirs").id();
    assert!(spec.contains(ours) && !copy.contains(ours));
    assert!(copy.contains(theirs) && !spec.contains(theirs));
    assert_ne!(ours.any(), theirs.any());

    // A later clone has the elements of both lineages, and clones of clones agree on them.
    let [mut second, third] = [copy.clone(), copy.clone().clone()];
    for id in [upper.any(), theirs.any()] {
        assert!(second.contains(id) && third.contains(id));
    }
    assert!(!second.contains(ours));
    let last = second.add_geom(upper).id();
    assert!(!copy.contains(last) && !third.contains(last) && !spec.contains(last));

    // Attachments add elements too.
    let mount = Mount::body(copy.world());
    let attached = copy.attach(&parse(ARM), mount, "a_").unwrap()[0];
    assert_eq!(copy.body(attached).name(), Some("a_upper"));
    assert!(!spec.contains(attached) && !second.contains(attached));

    let misuse = |operation: &mut dyn FnMut()| {
        let panic = std::panic::catch_unwind(std::panic::AssertUnwindSafe(operation)).unwrap_err();
        assert!(panic.downcast_ref::<&str>().is_some_and(|text| text.contains("another spec")));
    };
    misuse(&mut || _ = copy.add_joint(ours));
    misuse(&mut || _ = copy.remove(ours));
    misuse(&mut || _ = spec.remove_with_references(theirs));
    misuse(&mut || _ = spec.body(attached));
}

#[test]
#[should_panic(expected = "was removed")]
fn an_id_of_a_removed_element_panics() {
    let mut spec = parse(ARM);
    let geom = spec.geom("a").unwrap().id();
    spec.remove(geom).unwrap();
    spec.geom_mut(geom).set_mass(1.0);
}

#[test]
fn attributes_are_read_set_and_removed() {
    let mut spec = parse(ARM);
    let lower = spec.body("lower").unwrap();
    assert_eq!(lower.numbers("pos").unwrap(), Some(vec![1.0, 0.0, 0.0]));
    assert_eq!(lower.numbers("quat").unwrap(), None);
    assert!(lower.numbers("name").is_err());
    assert_eq!(lower.parent(), Some(spec.body("upper").unwrap().id().any()));
    assert_eq!(
        lower.children().map(|id| spec.element(id).tag().to_owned()).collect::<Vec<_>>(),
        ["joint", "geom", "site"]
    );
    let mut lower = spec.body_mut("lower").unwrap();
    lower.set_pos([0.0, 2.0, 0.0]);
    assert_eq!(lower.unset("pos").as_deref(), Some("0 2 0"));
    same(&spec, &ARM.replace(" pos='1 0 0'", ""));
}
