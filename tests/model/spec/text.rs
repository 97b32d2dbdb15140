//! Texts of specs: the engine and the reader of specs read every name as it is.

use mujoco_safe::Model;
use mujoco_safe::kind::Geom;
use mujoco_safe::spec::{ActuatorElement, Spec};

use crate::cases::cases;

/// Names that need escapes in XML, or that XML cannot have.
fn names() -> Vec<String> {
    let mut names: Vec<String> = [
        "a b",
        " a  b ",
        "a\"b'c",
        "a&b<c>d",
        "&amp;",
        "&#1;",
        "a\tb\nc\rd\r\ne",
        "é😀",
        "a;b/c\\d",
        "]]>",
        "<!--",
        "\u{2028}",
    ]
    .map(str::to_owned)
    .to_vec();
    let special =
        (1..0x20).chain(0x7f..0xa1).step_by(cases(3, 1)).chain([0xfeff, 0xfffd, 0xfffe, 0xffff, 0xf_0001, 0x10_ffff]);
    names.extend(special.map(|code| format!("a{}b", char::from_u32(code).unwrap())));
    names
}

#[test]
fn all_names_survive_as_text() {
    for name in names() {
        let mut spec = Spec::new(&name);
        let world = spec.world();
        let body = spec.add_body(world).set_name(&name).id();
        spec.add_geom(body).set_name(&name).set_size(&[0.1]);
        spec.add_joint(body).set_name(&name);
        spec.add_actuator(ActuatorElement::Motor).set_name(&name).set_joint(&name[..]);
        spec.add_text().set_name("t").set("data", &name[..]).unwrap();
        let text = spec.to_xml();

        let model = Model::from_xml_str(&text).unwrap_or_else(|error| panic!("{name:?}: {error}"));
        assert!(model.body(&name).is_ok() && model.joint(&name).is_ok(), "{name:?}");
        assert_eq!(model.actuator(&name).unwrap().id().index(), 0);
        let read = Spec::from_xml_str(&text).unwrap_or_else(|error| panic!("{name:?}: {error}"));
        assert_eq!(read.to_xml(), text);
        assert_eq!(read.name(), name);
        assert_eq!(read.geom(read.ids::<Geom>()[0]).name(), Some(&name[..]));
        super::same(&read, &text);
    }
}

/// The engine keeps white space in names, which readers of XML replace by spaces.
#[test]
fn texts_are_read_as_the_engine_reads_them() {
    for value in ["a\tb", "a\nb", "a\r\nb\rc", "a&#9;b&#10;c", "&amp;\t&lt;\n&#65;", "a\u{1}b", "a&#2;\tb", "a&#x1f;b"]
    {
        let text = format!("<mujoco><worldbody><geom name=\"{value}\" size='1\n2 3'/></worldbody></mujoco>");
        let model = Model::from_xml_str(&text).unwrap();
        let spec = Spec::from_xml_str(&text).unwrap();
        let geom = spec.geom(spec.ids::<Geom>()[0]);
        assert_eq!(geom.name(), model.geom(0).unwrap().name(), "{value:?}");
        assert_eq!(geom.attribute("size"), Some("1 2 3"));
        super::same(&spec, &text);
    }
}

#[test]
fn a_nul_character_is_an_error() {
    let mut spec = Spec::new("m");
    let world = spec.world();
    let mut geom = spec.add_geom(world);
    assert!(geom.set_size(&[0.1]).set("name", "a\0b").unwrap_err().to_string().contains("NUL"));
    geom.set_name("a\0b");
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("'name' of geom") && error.contains("NUL"), "{error}");
    assert!(Model::from_xml_str(&spec.to_xml()).is_err());
    assert!(Spec::from_xml_str(&spec.to_xml()).is_err());
    assert!(Spec::from_xml_str("<mujoco model='a&#0;b'/>").is_err());
}

/// The engine's reader accepts more than XML.
#[test]
fn texts_that_are_not_xml_are_read_as_the_engine_reads_them() {
    let world = "<worldbody><body name='b'><geom size='.1'/></body></worldbody>";
    let texts = [
        format!("<mujoco><!-- ---- arm ---- -->{world}<!-- <body>\n--- --></mujoco>"),
        format!("<mujoco><!--- arm --->{world}</mujoco>"),
        format!("<!DOCTYPE mujoco>\n<mujoco>{world}</mujoco>"),
        format!("\n <?xml version='1.0'?>\n<mujoco>{world}</mujoco>"),
        format!("<mujoco>{}</mujoco>", world.replace("'b'", "'a & b &c; &amp'")),
        format!("<mujoco>{}</mujoco>", world.replace("'b'", "'a<b>'")),
        format!("<mujoco>{world}</mujoco><!-- end --><x/>"),
    ];
    for text in texts {
        assert!(roxmltree::Document::parse(&text).is_err(), "{text}");
        let spec = Spec::from_xml_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let model = Model::from_xml_str(&text).unwrap();
        let name = spec.element(spec.ids::<mujoco_safe::kind::Body>()[1]).name();
        assert_eq!(name, model.body(1).unwrap().name(), "{text}");
        super::same(&spec, &text);
    }
    for broken in [
        "<mujoco><worldbody></mujoco>",
        "<mujoco",
        "<mujoco><!-- </mujoco>",
        "<mujoco a='&'",
        "<mujoco a='&lt; &'/>",
        "",
    ] {
        assert!(Spec::from_xml_str(broken).is_err(), "{broken}");
    }
}

#[test]
fn a_file_may_end_with_nul() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["<mujoco model='m'/>\n\0", "<robot name='m'><link name='a'/></robot>\0\0"] {
        let path = folder.path().join("model.xml");
        std::fs::write(&path, text).unwrap();
        let spec = Spec::from_xml_path(&path).unwrap();
        assert_eq!((spec.name(), spec.compile().unwrap().nv()), ("m", 0));
        assert_eq!(mujoco_safe::Model::from_xml_path(&path).unwrap().nv(), 0);
    }
    let text = "<mujoco/>\0<mujoco/>";
    assert!(Spec::from_xml_str(text).unwrap_err().to_string().contains("NUL"));
}
