//! Classes of defaults keep their meaning when specs are attached.

use mujoco_safe::Model;
use mujoco_safe::spec::Mount;

use super::super::same_models::assert_same;
use super::parse;

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
