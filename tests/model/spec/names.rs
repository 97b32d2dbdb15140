//! Names with spaces, and references by all kinds of elements.

use mujoco_safe::Model;
use mujoco_safe::spec::{Any, ElementId, Mount, Spec};

use super::super::same_models::assert_same;
use super::{parse, same};

/// Elements whose names are words of the names of others. Each element with a long name is referred
/// to in all ways that all engines have.
const ROOM: &str = "<mujoco model='m'>
  <default><default class='c'/><default class='c d'><geom rgba='1 0 0 1'/></default></default>
  <asset>
    <texture name='t' type='2d' builtin='flat' width='2' height='2'/><texture name='t u' type='2d' builtin='flat' width='2' height='2'/>
    <material name='m'/><material name='m n' texture='t u'/>
    <mesh name='v' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/><mesh name='v w' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>
    <hfield name='h' nrow='2' ncol='2' size='1 1 1 1'/><hfield name='h i' nrow='2' ncol='2' size='1 1 1 1'/>
    <skin name='k' material='m n' vertex='0 0 0 1 0 0 0 1 0' face='0 1 2'>
      <bone body='a b' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/></skin>
  </asset>
  <worldbody>
    <geom name='terrain' type='hfield' hfield='h i'/>
    <camera name='p' target='a b' mode='targetbody'/><light target='a b' mode='targetbody'/>
    <body name='a'><joint name='j'/><geom name='g' size='.1'/><geom size='.1'/><site name='s'/><camera name='q'/></body>
    <body name='b' pos='1 0 0'><joint name='k'/><geom name='f' size='.1'/><site name='r'/></body>
    <body name='a b' pos='2 0 0' childclass='c d'><joint name='j k'/><geom name='g f' size='.1' material='m n'/><site name='s r'/>
      <geom name='solid' type='mesh' mesh='v w' class='c d'/></body>
  </worldbody>
  <contact><exclude name='x' body1='a b' body2='b'/><pair name='y' geom1='g f' geom2='f'/></contact>
  <tendon><spatial name='l'><site site='s'/><site site='r'/></spatial>
    <spatial name='l o' material='m n'><site site='s'/><geom geom='g f' sidesite='s r'/><site site='r'/></spatial>
    <fixed name='z'><joint joint='j k' coef='1'/></fixed></tendon>
  <equality><weld name='1' body1='a b' body2='a'/><joint name='2' joint1='j k' joint2='j'/><tendon name='3' tendon1='l o' tendon2='l'/></equality>
  <actuator><motor name='4' joint='j k'/><motor name='5' tendon='l o'/><motor name='6' site='s r'/><motor name='4 5' joint='j'/>
    <position name='7' cranksite='s r' slidersite='r' cranklength='1'/></actuator>
  <sensor><framepos name='8' objtype='body' objname='a b' reftype='geom' refname='g f'/><jointpos name='9' joint='j k'/>
    <touch name='10' site='s r'/><tendonpos name='11' tendon='l o'/><actuatorfrc name='12' actuator='4 5'/><subtreecom name='13' body='a b'/></sensor>
  <custom><tuple name='14'><element objtype='body' objname='a b' prm='0'/><element objtype='material' objname='m n' prm='0'/><element objtype='sensor' objname='8' prm='0'/></tuple></custom>
</mujoco>";

/// Names of elements that nothing refers to, whose names are words of others.
const WORDS: [(&str, &str); 16] = [
    ("joint", "k"),
    ("geom", "g"),
    ("site", "missing"),
    ("material", "m"),
    ("texture", "t"),
    ("mesh", "v"),
    ("hfield", "h"),
    ("default", "c"),
    ("camera", "q"),
    ("body", "none"),
    ("joint", "none"),
    ("skin", "k"),
    ("motor", "4"),
    ("motor", "5"),
    ("spatial", "none"),
    ("tuple", "14"),
];

/// Returns the text of the room. Newer engines split the names in tuples at spaces, so they have no
/// tuple.
fn room() -> String {
    let tuple = ROOM.lines().find(|line| line.contains("<custom>")).unwrap();
    if cfg!(engine_since = "3.0.0") { ROOM.replace(tuple, "") } else { ROOM.to_owned() }
}

fn find(spec: &Spec, tag: &str, name: &str) -> Option<ElementId<Any>> {
    let mut open = vec![spec.element(spec.world()).parent().unwrap()];
    while let Some(id) = open.pop() {
        let element = spec.element(id);
        if element.tag() == tag && element.name() == Some(name) {
            return Some(id);
        }
        open.extend(element.children());
    }
    None
}

#[test]
fn a_name_that_is_a_word_of_another_one_is_not_referred_to() {
    for (tag, name) in WORDS {
        let mut spec = parse(&room());
        let Some(id) = find(&spec, tag, name) else { continue };
        let before = spec.to_xml().lines().count();
        spec.remove(id).unwrap_or_else(|error| panic!("{tag} {name}: {error}"));
        assert!(spec.to_xml().lines().count() < before, "{tag} {name}");
        spec.compile().unwrap_or_else(|error| panic!("{tag} {name}: {error}"));
    }
}

/// The example of a robot with an "arm" and a "left arm".
#[test]
fn removal_keeps_the_references_to_longer_names() {
    let mut spec = parse(
        "<mujoco><worldbody>
           <body name='arm'><joint name='j1'/><geom size='.1'/></body>
           <body name='left arm'><joint name='j 2'/><geom name='g' size='.1'/></body></worldbody>
         <sensor><framepos name='s' objtype='body' objname='left arm'/></sensor>
         <contact><exclude name='e' body1='left arm' body2='world'/></contact></mujoco>",
    );
    let arm = spec.body("arm").unwrap().id();
    spec.remove_with_references(arm).unwrap();
    let model = spec.compile().unwrap();
    assert_eq!((model.nbody(), model.nsensor(), model.nexclude()), (2, 1, 1));
}

#[test]
fn removal_with_references_finds_names_with_spaces() {
    let mut spec = parse(&room());
    for (tag, name) in
        [("body", "a b"), ("texture", "t u"), ("material", "m n"), ("mesh", "v"), ("default", "c d"), ("hfield", "h i")]
    {
        let id = find(&spec, tag, name).unwrap();
        assert!(!matches!(tag, "body" | "texture" | "hfield") || spec.remove(id).is_err(), "{name}");
        spec.remove_with_references(id).unwrap();
    }
    same(
        &spec,
        "<mujoco model='m'>
           <default><default class='c'/></default>
           <asset><texture name='t' type='2d' builtin='flat' width='2' height='2'/><material name='m'/><hfield name='h' nrow='2' ncol='2' size='1 1 1 1'/></asset>
           <worldbody>
             <body name='a'><joint name='j'/><geom name='g' size='.1'/><geom size='.1'/><site name='s'/><camera name='q'/></body>
             <body name='b' pos='1 0 0'><joint name='k'/><geom name='f' size='.1'/><site name='r'/></body>
           </worldbody>
           <tendon><spatial name='l'><site site='s'/><site site='r'/></spatial></tendon>
           <actuator><motor name='4 5' joint='j'/></actuator>
           <sensor><actuatorfrc name='12' actuator='4 5'/></sensor>
         </mujoco>"
            .replace("<asset>", "<asset><mesh name='v w' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>")
            .as_str(),
    );
}

/// Each name is replaced where it is a whole reference only.
#[test]
fn renaming_and_prefixes_respect_spaces() {
    let alone = Model::from_xml_str(&room()).unwrap();
    let mut spec = parse(&room());
    let renamed = [
        ("body", "a b", "x y z"),
        ("body", "a", "a b"),
        ("joint", "j", "j k j"),
        ("joint", "j k", "j"),
        ("site", "s r", "new"),
        ("material", "m n", "m  n"),
        ("motor", "4 5", "4 5 6"),
        ("texture", "t u", "u t"),
        ("default", "c d", "d c"),
        ("geom", "g f", "f g"),
        ("framepos", "8", "8 9"),
        ("spatial", "l o", "o"),
        ("mesh", "v w", "w"),
        ("hfield", "h i", "i"),
    ];
    for (tag, old, new) in renamed {
        let id = find(&spec, tag, old).unwrap();
        spec.edit(id).set_name(new);
    }
    let model = spec.compile().unwrap();
    assert_same(&model, &alone, 0.0, &spec.to_xml());
    assert!(model.body("x y z").is_ok() && model.actuator("4 5 6").is_ok() && model.material("m  n").is_ok());

    // A prefix with a space.
    let mut spec = parse("<mujoco model='m'/>");
    let mount = Mount::body(spec.world());
    spec.attach(&parse(&room()), mount, "left ").unwrap();
    let model = spec.compile().unwrap();
    for name in ["left a", "left a b"] {
        assert!(model.body(name).is_ok(), "{name}");
    }
    assert_same(&model, &alone, 0.0, &spec.to_xml());
}

/// The names in these attributes are a list, unlike in all others.
#[cfg(engine_since = "3.5.0")]
#[test]
fn lists_of_bodies_are_split() {
    let text = "<mujoco model='m'><worldbody><body name='a'><joint type='slide'/><geom size='.1'/></body><body name='b'><joint type='slide'/><geom size='.1'/></body>
        <body name='c'><joint type='slide'/><geom size='.1'/></body><body name='a b'><geom size='.1'/></body></worldbody>
        <deformable><flex name='f' dim='2' body='a b c' vertex='0 0 0 1 0 0 0 1 0' element='0 1 2'/></deformable></mujoco>";
    let mut spec = parse(text);
    let free = spec.body("a b").unwrap().id();
    spec.remove(free).unwrap();
    let used = spec.body("b").unwrap().id();
    assert!(spec.remove(used).unwrap_err().to_string().contains("flex 'f'"));
    spec.body_mut("b").unwrap().set_name("z");
    same(
        &spec,
        &text
            .replace("<body name='a b'><geom size='.1'/></body>", "")
            .replace("body name='b'", "body name='z'")
            .replace("'a b c'", "'a z c'"),
    );

    let mut outer = Spec::new("outer");
    let mount = Mount::body(outer.world());
    outer.attach(&parse(text), mount, "p_").unwrap();
    assert!(outer.to_xml().contains("body=\"p_a p_b p_c\""));
    outer.compile().unwrap();
    let error = outer.attach(&parse(text), mount, "left ").unwrap_err().to_string();
    assert!(error.contains("flex"), "{error}");
}

/// The layers of a material are not needed without their texture, and the material remains.
#[cfg(engine_since = "3.5.0")]
#[test]
fn a_texture_of_a_layer_is_removed_with_the_layer() {
    let texture = |name: &str| format!("<texture name='{name}' type='2d' builtin='flat' width='2' height='2'/>");
    let text = format!(
        "<mujoco><asset>{}{}<material name='m'><layer role='rgb' texture='t'/><layer role='normal' texture='t u'/></material></asset>
         <worldbody><geom material='m' size='1'/></worldbody></mujoco>",
        texture("t"),
        texture("t u")
    );
    let mut spec = parse(&text);
    let id = spec.texture("t").unwrap().id();
    spec.remove_with_references(id).unwrap();
    same(&spec, &text.replace(&texture("t"), "").replace("<layer role='rgb' texture='t'/>", ""));
}

/// Attributes of newer engines may be references.
#[test]
fn elements_that_unknown_attributes_may_refer_to_are_not_removed() {
    let text = "<mujoco><worldbody><body name='arm'><geom name='g' size='1'/></body><body name='b'><geom name='h' size='1' warp='left arm'/></body></worldbody></mujoco>";
    let mut spec = parse(text);
    let before = spec.to_xml();
    let arm = spec.body("arm").unwrap().id();
    for error in [spec.remove(arm).unwrap_err(), spec.remove_with_references(arm).unwrap_err()] {
        let message = error.to_string();
        assert!(message.contains("'warp'") && message.contains("geom 'h'"), "{message}");
    }
    assert_eq!(spec.to_xml(), before);
}

/// The compiler gives the elements of a class the mesh of the class, so only these elements refer
/// to it.
#[test]
fn a_removed_mesh_of_a_class_leaves_the_other_defaults_of_the_class() {
    const MESHES: &str = "<mesh name='b' vertex='0 0 0 4 0 0 0 2 0 0 0 1'/>";
    let mut spec = parse(&format!(
        "<mujoco><default><default class='c'><geom type='mesh' mesh='a' friction='.3' density='70'/></default></default>
         <asset><mesh name='a' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>{MESHES}</asset>
         <worldbody><geom class='c'/><geom name='other' class='c' mesh='b'/>
         <body childclass='c'><geom/><geom type='sphere' size='1' mesh='b'/></body></worldbody></mujoco>"
    ));
    let mesh = spec.mesh("a").unwrap().id();
    assert!(spec.remove(mesh).is_err());
    spec.remove_with_references(mesh).unwrap();
    same(
        &spec,
        &format!(
            "<mujoco><default><geom friction='.3' density='70'/></default><asset>{MESHES}</asset>
             <worldbody><geom name='other' type='mesh' mesh='b'/>
             <body><geom type='sphere' size='1' mesh='b'/></body></worldbody></mujoco>"
        ),
    );
}

/// The bones in the file of a skin have names of bodies, which could be those of other bodies.
#[test]
fn a_prefix_for_the_bones_in_a_file_is_rejected() {
    let child = parse(
        "<mujoco><asset><skin name='s' file='s.skn'/></asset><worldbody><body name='b'><geom size='.1'/></body></worldbody></mujoco>",
    );
    let mut spec = child.clone();
    let mount = Mount::body(spec.world());
    let error = spec.attach(&child, mount, "p_").unwrap_err();
    assert!(error.to_string().contains("skin 's'"), "{error}");
    let mut spec = Spec::new("outer");
    let mount = Mount::body(spec.world());
    spec.attach(&child, mount, "").unwrap();
}
