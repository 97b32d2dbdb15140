//! Snapshots of the renderer: images of a simulation from a camera, without a scene of the caller.

use mujoco_safe::data::Warning;
use mujoco_safe::render::{RenderError, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories, NewGeom, RenderFlags, Scene, SceneOptions, VisualFlags};
use mujoco_safe::{Data, Error, Model, sample};

use crate::stage;

const SIZE: [usize; 2] = [48, 36];

fn renderer(model: &Model) -> Renderer {
    let options = RendererOptions::default().with_samples(1).with_shadow_size(64);
    Renderer::on(stage::gpu(), model, SIZE[0], SIZE[1], options).unwrap()
}

fn humanoid() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    data
}

/// Returns the scene of the humanoid that a program without snapshots would build.
fn scene(data: &mut Data, mut camera: Camera) -> Scene {
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    scene.update_camera(data, &mut camera.clone()).unwrap();
    scene.update(data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    scene
}

#[test]
fn snapshot_shows_the_images_of_the_same_scene() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let side = data.model().camera("side").unwrap().id();
    for mut camera in [Camera::fixed(data.model(), side), Camera::free(data.model())] {
        let scene = scene(&mut data, camera);
        let colours = renderer.rgb(&scene).unwrap();
        let depth = renderer.depth(&scene).unwrap();
        let segmentation = renderer.segmentation(&scene).unwrap();
        let mut snapshot = renderer.snapshot(&mut data, &mut camera).unwrap();
        assert!(snapshot.rgb().unwrap() == colours);
        assert!(snapshot.depth().unwrap() == depth);
        assert!(snapshot.segmentation().unwrap() == segmentation);
        let (mut rgb, mut metres, mut ids) = Default::default();
        snapshot.rgb_into(&mut rgb).unwrap();
        snapshot.depth_into(&mut metres).unwrap();
        snapshot.segmentation_into(&mut ids).unwrap();
        assert!(rgb == colours && metres == depth && ids == segmentation);
        let images = snapshot.images().unwrap();
        assert!(images.rgb == colours && images.depth == depth && images.segmentation == segmentation);
    }
}

#[test]
fn images_together_equal_single_images_if_a_geom_is_transparent() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let mut snapshot = renderer.snapshot(&mut data, "side").unwrap();
    let opaque = snapshot.images().unwrap();
    let glass = NewGeom::sphere(0.5).with_pos([0.0, 0.0, 1.2]).with_rgba([1.0, 0.0, 0.0, 0.4]);
    let glass = snapshot.scene_mut().add_geom(&glass).unwrap();
    let mut images = opaque.clone();
    snapshot.images_into(&mut images).unwrap();
    assert!(images.segmentation.segments().iter().any(|(segment, _)| segment.geom == glass), "the geom is visible");
    assert!(images.rgb != opaque.rgb && images.segmentation != opaque.segmentation);
    assert!(images.depth == opaque.depth, "transparent geoms have no depth");
    assert!(images.rgb == snapshot.rgb().unwrap());
    assert!(images.depth == snapshot.depth().unwrap());
    assert!(images.segmentation == snapshot.segmentation().unwrap());
}

#[test]
fn name_index_id_and_view_of_a_camera_give_the_same_image() {
    let mut data = humanoid();
    let model = data.model().clone();
    let mut renderer = renderer(&model);
    let id = model.camera("side").unwrap().id();
    let by_name = renderer.snapshot(&mut data, "side").unwrap().rgb().unwrap();
    assert!(renderer.snapshot(&mut data, &"side".to_owned()).unwrap().rgb().unwrap() == by_name);
    assert!(renderer.snapshot(&mut data, id.index()).unwrap().rgb().unwrap() == by_name);
    assert!(renderer.snapshot(&mut data, id).unwrap().rgb().unwrap() == by_name);
    assert!(renderer.snapshot(&mut data, model.camera(id)).unwrap().rgb().unwrap() == by_name);
    assert!(renderer.snapshot(&mut data, &mut Camera::fixed(&model, id)).unwrap().rgb().unwrap() == by_name);
    assert!(renderer.snapshot(&mut data, &mut Camera::free(&model)).unwrap().rgb().unwrap() != by_name);
}

#[test]
fn mutable_tracking_camera_moves_with_its_body() {
    let mut data = humanoid();
    let model = data.model().clone();
    let mut renderer = renderer(&model);
    let mut camera = Camera::tracking(&model, "torso").unwrap();
    camera.lookat[0] += 1.0;
    let (start, mut expected) = (camera, camera);
    Scene::new(&model, 1000).unwrap().update_camera(&data, &mut expected).unwrap();
    renderer.snapshot(&mut data, &mut camera).unwrap();
    assert_ne!(camera, start);
    assert_eq!(camera, expected, "one update per snapshot");
}

#[test]
fn options_and_changes_of_the_scene_are_visible() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let hidden = SceneOptions::default().with_flags(VisualFlags::empty());
    let plain = renderer.snapshot(&mut data, "side").unwrap().rgb().unwrap();
    assert!(renderer.snapshot_with(&mut data, "side", &hidden).unwrap().rgb().unwrap() != plain);

    let mut snapshot = renderer.snapshot(&mut data, "side").unwrap();
    let geoms = snapshot.scene().ngeom();
    let marker = snapshot.scene_mut().add_geom(&NewGeom::sphere(0.3).with_pos([0.0, -0.5, 1.0])).unwrap();
    assert_eq!(marker, geoms);
    assert!(snapshot.segmentation().unwrap().segments().iter().any(|(segment, _)| segment.geom == marker));
    let flags = snapshot.scene().render_flags() | RenderFlags::WIREFRAME;
    snapshot.scene_mut().set_render_flags(flags);

    let later = renderer.snapshot(&mut data, "side").unwrap();
    assert_eq!(later.scene().ngeom(), geoms);
    assert!(later.scene().render_flags().contains(RenderFlags::WIREFRAME));
}

#[test]
fn scene_of_snapshots_grows_to_the_number_of_geoms() {
    const SITES: usize = 10_001;
    let sites = r#"<site pos="1 0 0"/>"#.repeat(SITES);
    let xml = format!(r#"<mujoco><worldbody><camera name="eye"/>{sites}</worldbody></mujoco>"#);
    let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
    data.forward().unwrap();
    let mut renderer = renderer(data.model());
    let mut snapshot = renderer.snapshot(&mut data, "eye").unwrap();
    assert_eq!(snapshot.scene().ngeom(), SITES);
    let flags = snapshot.scene().render_flags();
    assert!(flags.contains(RenderFlags::SHADOW));
    let capacity = snapshot.scene().max_geoms();
    snapshot.rgb().unwrap();
    assert_eq!(data.warning(Warning::VisualGeomFull).number, 0);
    assert_eq!(renderer.snapshot(&mut data, "eye").unwrap().scene().max_geoms(), capacity, "grows once");
}

#[test]
fn snapshot_before_positions_are_computed_is_an_error() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut renderer = renderer(data.model());
    let is_not_computed = |error| matches!(error, RenderError::Other(Error::NotComputed { .. }));
    assert!(is_not_computed(renderer.snapshot(&mut data, "side").unwrap_err()));
    data.fwd_position().unwrap();
    renderer.snapshot(&mut data, "side").unwrap();
    let contacts = SceneOptions::default().with_flags(VisualFlags::CONTACTFORCE);
    assert!(is_not_computed(renderer.snapshot_with(&mut data, "side", &contacts).unwrap_err()));
    data.step().unwrap();
    renderer.snapshot_with(&mut data, "side", &contacts).unwrap();
}

#[test]
fn unknown_camera_and_data_of_another_model_are_errors() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let error = renderer.snapshot(&mut data, "sied").unwrap_err();
    assert!(matches!(&error, RenderError::Other(Error::NoSuchName { name, .. }) if name == "sied"), "{error}");
    let error = renderer.snapshot(&mut data, 99).unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::NoSuchIndex { .. })), "{error}");
    let error = renderer.snapshot(&mut data, &mut Camera { distance: f64::NAN, ..Camera::default() }).unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::Invalid { .. })), "{error}");
    let error = renderer.snapshot(&mut humanoid(), "side").unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::OtherModel { .. })), "{error}");
    renderer.snapshot(&mut data, "side").unwrap().rgb().unwrap();
}

#[test]
#[should_panic(expected = "another model")]
fn camera_id_of_another_model_panics() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let foreign = humanoid().model().camera("side").unwrap().id();
    let _ = renderer.snapshot(&mut data, foreign);
}

#[test]
fn a_renderer_that_adopts_a_model_draws_it_like_a_new_one() {
    let mut data = humanoid();
    let mut renderer = renderer(data.model());
    let camera = Camera::free(data.model());
    let old = scene(&mut data, camera);
    let text = "<mujoco><asset><texture name='t' type='2d' builtin='checker' width='8' height='8' rgb1='1 0 0'/>
        <material name='m' texture='t'/></asset><worldbody><light pos='0 0 3'/><geom type='box' size='.2 .1 .1' material='m'/></worldbody></mujoco>";
    data.adopt(Model::from_xml_str(text).unwrap()).unwrap();
    renderer.adopt(data.model()).unwrap();
    data.forward().unwrap();
    let mut camera = Camera::free(data.model());
    let picture = renderer.snapshot(&mut data, &mut camera).unwrap().rgb().unwrap();
    let mut other = self::renderer(data.model());
    assert!(picture == other.snapshot(&mut data, &mut camera).unwrap().rgb().unwrap());
    assert!(matches!(renderer.rgb(&old), Err(RenderError::Other(Error::OtherModel { .. }))));
}
