//! Specs that a program builds.

use mujoco_safe::enums::{GeomType, JointType, SensorType, TextureType};
use mujoco_safe::kind::Kind;
use mujoco_safe::spec::{ActuatorElement, SensorFrame, Spec, TexturePattern};
use mujoco_safe::{Error, Model, sample};

use super::same;

#[test]
fn a_model_built_in_code_equals_its_text() {
    let mut spec = Spec::new("arm");
    spec.section_mut("option").unwrap().set("timestep", 0.004).unwrap();
    spec.default_mut("main", "geom").unwrap().set("rgba", [0.5, 0.5, 0.5, 1.0]).unwrap();
    spec.add_texture()
        .set_name("grid")
        .set_type(TextureType::Flat)
        .set_builtin(TexturePattern::Checker)
        .set_width(16)
        .set_height(16);
    spec.add_material().set_name("floor").set_texture("grid");
    let world = spec.world();
    spec.add_geom(world).set_name("floor").set_type(GeomType::Plane).set_size(&[5.0, 5.0, 0.1]).set_material("floor");
    spec.add_light(world).set_pos([0.0, 0.0, 3.0]);
    let upper = spec.add_body(world).set_name("upper").set_pos([0.0, 0.0, 1.0]).id();
    let shoulder = spec.add_joint(upper).set_name("shoulder").set_type(JointType::Ball).id();
    let link = spec.add_geom(upper).set_name("link").set_type(GeomType::Capsule).id();
    spec.geom_mut(link).set_fromto([0.0, 0.0, 0.0, 0.3, 0.0, 0.0]).set_size(&[0.02]);
    let lower = spec.add_body(upper).set_name("lower").set_pos([0.3, 0.0, 0.0]).id();
    let elbow = spec
        .add_joint(lower)
        .set_name("elbow")
        .set_axis([0.0, 1.0, 0.0])
        .set_range([-90.0, 0.0])
        .set_limited(true)
        .id();
    spec.body_mut(lower).set_inertial(0.5, [0.1, 0.0, 0.0], [0.01, 0.01, 0.001]);
    let tip = spec.add_site(lower).set_name("tip").set_pos([0.2, 0.0, 0.0]).id();
    let anchor = spec.add_site(world).set_name("anchor").set_pos([1.0, 0.0, 1.0]).id();
    spec.add_spatial_tendon().set_name("cord").set_stiffness(3.0).wrap_site(anchor).wrap_site(tip);
    spec.add_fixed_tendon().set_name("sum").wrap_joint(elbow, 2.0);
    spec.add_actuator(ActuatorElement::Motor).set_name("torque").set_joint(elbow).set_gear(&[10.0]);
    spec.add_actuator(ActuatorElement::Position).set_name("servo").set_tendon("cord").set_kp(5.0);
    spec.add_sensor(SensorType::JointPosition).unwrap().set_name("angle").set_joint(elbow);
    spec.add_sensor(SensorType::FramePosition).unwrap().set_objtype(SensorFrame::Site).set_objname("tip");
    spec.add_exclude().set_body1(upper).set_body2(lower);
    spec.add_connect().set_body1(lower).set_anchor([0.2, 0.0, 0.0]).set_active(false);
    spec.add_numeric().set_name("gains").set_data(&[1.0, 0.25]);
    spec.add_keyframe().set_name("bent").set_qpos(&[1.0, 0.0, 0.0, 0.0, -0.5]);
    assert_eq!(spec.joint(shoulder).name(), Some("shoulder"));

    same(
        &spec,
        "<mujoco model='arm'>
           <option timestep='0.004'/>
           <default><geom rgba='.5 .5 .5 1'/></default>
           <asset>
             <texture name='grid' type='2d' builtin='checker' width='16' height='16'/>
             <material name='floor' texture='grid'/>
           </asset>
           <worldbody>
             <geom name='floor' type='plane' size='5 5 .1' material='floor'/>
             <light pos='0 0 3'/>
             <body name='upper' pos='0 0 1'>
               <joint name='shoulder' type='ball'/>
               <geom name='link' type='capsule' fromto='0 0 0 .3 0 0' size='.02'/>
               <body name='lower' pos='.3 0 0'>
                 <joint name='elbow' axis='0 1 0' range='-90 0' limited='true'/>
                 <inertial mass='.5' pos='.1 0 0' diaginertia='.01 .01 .001'/>
                 <site name='tip' pos='.2 0 0'/>
               </body>
             </body>
             <site name='anchor' pos='1 0 1'/>
           </worldbody>
           <tendon>
             <spatial name='cord' stiffness='3'><site site='anchor'/><site site='tip'/></spatial>
             <fixed name='sum'><joint joint='elbow' coef='2'/></fixed>
           </tendon>
           <actuator>
             <motor name='torque' joint='elbow' gear='10'/>
             <position name='servo' tendon='cord' kp='5'/>
           </actuator>
           <sensor><jointpos name='angle' joint='elbow'/><framepos objtype='site' objname='tip'/></sensor>
           <contact><exclude body1='upper' body2='lower'/></contact>
           <equality><connect body1='lower' anchor='.2 0 0' active='false'/></equality>
           <custom><numeric name='gains' data='1 .25'/></custom>
           <keyframe><key name='bent' qpos='1 0 0 0 -.5'/></keyframe>
         </mujoco>",
    );
}

/// A reference by id needs a name in the text.
#[test]
fn an_element_without_a_name_gets_one_when_another_refers_to_it() {
    let mut spec = Spec::new("cart");
    let cart = spec.add_body(spec.world()).id();
    let slide = spec.add_joint(cart).set_type(JointType::Slide).id();
    spec.add_geom(cart).set_size(&[0.1]);
    spec.add_actuator(ActuatorElement::Motor).set_joint(slide);
    let name = spec.joint(slide).name().unwrap().to_owned();
    assert_eq!(spec.actuator(spec.ids()[0]).attribute("joint"), Some(&name[..]));
    assert_eq!(spec.compile().unwrap().nu(), 1);
}

#[test]
fn unknown_attributes_and_elements_are_errors_that_list_the_known_ones() {
    let mut spec = Spec::new("errors");
    let world = spec.world();
    let error = spec.add_geom(world).set("radius", 1.0).unwrap_err().to_string();
    assert!(error.contains("'radius'") && error.contains("size"), "{error}");
    let error = spec.edit(world).add("geoms").unwrap_err().to_string();
    assert!(error.contains("the world") && error.contains("geom, "), "{error}");
    let error = spec.section_mut("options").unwrap_err().to_string();
    assert!(error.contains("option, "), "{error}");
    if super::super::is_default() {
        let error = spec.add_sensor(SensorType::Contact).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
    }
    assert!(spec.default_mut("main", "body").is_err());
    let error = spec.body("arm").unwrap_err();
    assert!(matches!(error, Error::NoSuchName { kind: Kind::Body, .. }), "{error}");

    let error = Spec::from_xml_str(sample::HUMANOID_XML).unwrap().body("left_knee").unwrap_err();
    let expected = "there is no body named 'left_knee' (there is joint 'left_knee', actuator 'left_knee')";
    assert!(error.to_string().starts_with(expected), "{error}");
}

/// The compiler reports a line of a text that the program never sees.
#[test]
fn an_error_of_the_compiler_names_the_element() {
    let mut spec = Spec::new("invalid");
    let arm = spec.add_body(spec.world()).set_name("arm").id();
    spec.add_geom(arm).set_size(&[0.1]);
    spec.add_geom(arm).set_size(&[-0.1]);
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("the spec 'invalid'") && error.contains("geom 1 of body 'arm'"), "{error}");

    let mut spec = Spec::new("keyword");
    spec.add_camera(spec.world()).set_name("eye").set("mode", "sideways").unwrap();
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("camera 'eye'"), "{error}");
}

/// The guards of texts apply to specs.
#[test]
fn hostile_specs_are_errors() {
    let mut deep = Spec::new("deep");
    let mut body = deep.world();
    for _ in 0..100_000 {
        body = deep.add_body(body).id();
    }
    assert!(deep.compile().is_err());
    drop(deep.clone());

    let mut strange = Spec::new("quotes \" < > & \n");
    let geom = strange.add_geom(strange.world()).set_name("a\"b<c>&d\n'e'").id();
    for size in [&[f64::NAN][..], &[f64::INFINITY], &[-1e300, 1e-300], &[]] {
        strange.geom_mut(geom).set_size(size);
        let _ = strange.compile();
    }
    strange.geom_mut(geom).set_size(&[1.0]);
    let model = strange.compile().unwrap();
    assert!(model.geom("a\"b<c>&d\n'e'").is_ok());

    let mut numeric = Spec::new("numeric");
    numeric.add_numeric().set_name("long").set_data(&vec![0.0; 100_000]);
    let _ = numeric.compile();
}

#[test]
fn the_debug_output_counts_elements() {
    let spec = Spec::new("empty");
    assert_eq!(format!("{spec:?}"), "Spec 'empty': bodies 1, joints 0, geoms 0");
    assert_eq!(format!("{:?}", spec.element(spec.world())), "the world");
    assert_eq!(Model::from_xml_str(&spec.to_xml()).unwrap().nbody(), 1);
}
