//! Labels have a limited length, and are not truncated inside a character.

#![forbid(unsafe_code)]

use mujoco_safe::scene::{Camera, Categories, LabelMode, NewGeom, Scene, SceneOptions};
use mujoco_safe::{Data, Error, Model, sample};

#[test]
fn labels_are_not_truncated_within_the_limit() {
    let mut scene = Scene::new(&sample::cartpole(), 10).unwrap();
    for text in ["", "goal", &"x".repeat(99), &"é".repeat(49)] {
        let index = scene.add_geom(&NewGeom::text(text).unwrap()).unwrap();
        assert_eq!(scene.geom(index).label(), text);
    }
    for text in ["x".repeat(100), "é".repeat(50), "a\0b".to_owned()] {
        assert!(matches!(NewGeom::text(&text), Err(Error::Invalid { .. })), "{text:?}");
        let mut geoms = scene.geoms_mut();
        assert!(matches!(geoms.next().unwrap().set_label(&text), Err(Error::Invalid { .. })));
    }
    assert_eq!(scene.geom(0).label(), "");
}

#[test]
fn long_names_are_truncated_at_a_character_boundary() {
    for (name, label) in [("b".repeat(300), "b".repeat(99)), ("é".repeat(300), "é".repeat(49))] {
        let xml = format!(r#"<mujoco><worldbody><geom name="{name}" size="1"/></worldbody></mujoco>"#);
        let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 10).unwrap();
        // The rest of the previous label must not follow.
        for _ in 0..10 {
            scene.add_geom(&NewGeom::text(&"z".repeat(99)).unwrap()).unwrap();
        }
        let options = SceneOptions::default().with_label(LabelMode::Geom);
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
        assert_eq!(scene.geom(0).label(), label);
    }
}
