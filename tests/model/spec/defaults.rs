//! Classes of defaults keep their meaning when specs are attached.

use mujoco_safe::Model;
use mujoco_safe::spec::{Mount, Spec};

use super::super::same_models::assert_same;
use super::{parse, same};

/// The defaults of a later section are not those of the classes in an earlier one.
#[test]
fn repeated_sections_of_defaults_keep_their_order() {
    let part = "<default><geom size='.1' rgba='1 0 0 1'/><default class='s'><site size='.3'/></default></default>
         <default><geom size='.2'/><default class='t'><geom rgba='0 1 0 1'/></default></default>
         <default class='main'><geom group='2'/></default>
         <worldbody><geom class='s'/><geom class='t'/><geom/><body childclass='s'><geom/><site/></body></worldbody>";
    let text = format!("<mujoco model='m'>{part}</mujoco>");
    let expected = Model::from_xml_str(&text).unwrap();
    let mut spec = parse("<mujoco model='m'/>");
    let mount = Mount::body(spec.world());
    spec.attach(&parse(&text), mount, "").unwrap();
    assert_same(&spec.compile().unwrap(), &expected, 0.0, &spec.to_xml());

    // The defaults of the spec itself move to classes too.
    let mut spec = parse(&text);
    let mount = Mount::body(spec.world());
    spec.attach(&parse("<mujoco><default><geom size='7'/></default></mujoco>"), mount, "c_").unwrap();
    assert_same(&spec.compile().unwrap(), &expected, 0.0, &spec.to_xml());
}

/// A limit follows from the range of the class or of the element, whichever it has.
#[test]
fn limits_of_classes_and_elements_are_kept() {
    let part = "<default><joint range='-1 1'/><motor ctrlrange='-2 2'/>
           <default class='none'><joint range='0 0'/></default><default class='off'><joint limited='false'/></default></default>
         <worldbody><body><geom size='.1'/><joint name='a'/><joint class='none' name='b'/><joint class='none' range='-3 3' name='c'/>
           <joint class='off' range='-1 1' name='d'/><joint range='0 0' name='e'/><joint limited='auto' name='f'/></body></worldbody>
         <actuator><motor joint='a'/><motor joint='b' ctrlrange='0 0'/><motor joint='c' ctrllimited='auto' ctrlrange='0 1'/></actuator>";
    let text = format!("<mujoco model='m'><compiler autolimits='true'/>{part}</mujoco>");
    let mut spec = parse("<mujoco model='m'><compiler autolimits='false'/></mujoco>");
    let mount = Mount::body(spec.world());
    spec.attach(&parse(&text), mount, "").unwrap();
    assert_same(&spec.compile().unwrap(), &Model::from_xml_str(&text).unwrap(), 0.0, &spec.to_xml());
}

/// Defaults belong to the spec that sets them, before or after an attachment.
#[test]
fn defaults_that_are_set_after_an_attachment_do_not_reach_attached_elements() {
    const CHILD: &str = "<mujoco><worldbody><geom name='a' size='.1' mass='1'/>
        <body name='b'><joint name='j'/><geom size='.1' mass='1'/></body></worldbody>
        <actuator><motor name='m' joint='j'/></actuator></mujoco>";
    for own in ["", "<default><site size='.3'/></default>"] {
        let mut spec =
            parse(&format!("<mujoco>{own}<worldbody><geom name='own' size='.2' mass='1'/></worldbody></mujoco>"));
        let mount = Mount::body(spec.world());
        spec.attach(&parse(CHILD), mount, "p_").unwrap();
        spec.section_mut("default").unwrap().child_mut("geom").unwrap().set("margin", 0.4).unwrap();
        spec.default_mut("main", "geom").unwrap().set("gap", 0.1).unwrap();
        spec.default_mut("main", "motor").unwrap().set("gear", 7.0).unwrap();
        spec.default_mut("heavy", "geom").unwrap().set("size", 0.5).unwrap();
        let world = spec.world();
        spec.add_geom(world).set_name("later").set_class("heavy").set("mass", 1.0).unwrap();
        spec.attach(&parse(CHILD), mount, "q_").unwrap();
        let child = |prefix: &str| {
            format!(
                "<geom name='{prefix}a' size='.1' mass='1'/>
                 <body name='{prefix}b'><joint name='{prefix}j'/><geom size='.1' mass='1'/></body>"
            )
        };
        same(
            &spec,
            &format!(
                "<mujoco><worldbody><geom name='own' size='.2' mass='1' margin='.4' gap='.1'/>{}
                 <geom name='later' size='.5' mass='1' margin='.4' gap='.1'/>{}</worldbody>
                 <actuator><motor name='p_m' joint='p_j'/><motor name='q_m' joint='q_j'/></actuator></mujoco>",
                child("p_"),
                child("q_")
            ),
        );
    }
}

/// Copies and frames have no class or another one, so the elements in them have it.
#[cfg(engine_since = "3.5.0")]
#[test]
fn elements_in_copies_that_are_added_after_an_attachment_have_the_defaults_of_the_spec() {
    let mut spec = parse("<mujoco><default><geom size='.2'/></default></mujoco>");
    let mount = Mount::body(spec.world());
    spec.attach(&parse("<mujoco><default><geom size='.1'/></default></mujoco>"), mount, "p_").unwrap();
    let world = spec.world();
    let mut world = spec.edit(world);
    let mut copies = world.add("replicate").unwrap();
    copies.set("count", 2).unwrap().set("offset", [1.0, 0.0, 0.0]).unwrap();
    copies.add("geom").unwrap();
    copies.add("frame").unwrap().add("geom").unwrap();
    same(
        &spec,
        "<mujoco><worldbody><replicate count='2' offset='1 0 0'><geom size='.2'/><frame><geom size='.2'/></frame></replicate></worldbody></mujoco>",
    );
    let world = spec.world();
    let error = spec.edit(world).add("composite").unwrap_err();
    assert!(error.to_string().contains("put it into a body"), "{error}");
}

/// The class exists without a section of defaults.
#[test]
fn attached_elements_of_the_class_main_stay_in_it() {
    let mut spec = parse("<mujoco><default><geom size='.2'/></default></mujoco>");
    let child = parse("<mujoco><worldbody><geom name='a' class='main' size='.1'/></worldbody></mujoco>");
    let mount = Mount::body(spec.world());
    for prefix in ["", "p_"] {
        spec.attach(&child, mount, prefix).unwrap();
    }
    same(&spec, "<mujoco><worldbody><geom name='a' size='.1'/><geom name='p_a' size='.1'/></worldbody></mujoco>");
    let mut spec = Spec::new("empty");
    let mount = Mount::body(spec.world());
    spec.attach(&child, mount, "p_").unwrap();
    same(&spec, "<mujoco model='empty'><worldbody><geom name='p_a' size='.1'/></worldbody></mujoco>");
}
