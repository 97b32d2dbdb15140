//! Images of many simulations in one array. Single images are the reference.

use mujoco_safe::render::{GpuKind, RenderError, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories, NewGeom, RenderFlags, Scene, SceneOptions};
use mujoco_safe::{Data, Error, Model, sample};

use crate::stage;

const SIZE: [usize; 2] = [21, 30];
const AREA: usize = 21 * 30;

fn renderer(model: &Model, samples: usize) -> Renderer {
    let options = RendererOptions::default().with_samples(samples).with_shadow_size(256);
    Renderer::on(stage::gpu(), model, SIZE[0], SIZE[1], options).unwrap()
}

/// Updates a scene to a simulation, seen from a direction that depends on the index of the image.
fn show(index: usize, data: &mut Data, scene: &mut Scene) -> mujoco_safe::Result<()> {
    let mut camera = Camera { azimuth: 20.0 * index as f64, elevation: -40.0, ..Camera::free(data.model()) };
    scene.update(data, &SceneOptions::default(), None, &mut camera, Categories::all())
}

/// Compares the images of a batch with single images: colours, depths and ids, twice.
fn check(renderer: &mut Renderer, count: usize, mut update: impl FnMut(usize, &mut Scene), model: &Model) {
    let mut scene = Scene::new(model, 1000).unwrap();
    let (mut rgb, mut metres, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..count {
        update(index, &mut scene);
        rgb.extend(renderer.rgb(&scene).unwrap().into_bytes());
        metres.extend(renderer.depth(&scene).unwrap().into_vec());
        ids.extend_from_slice(renderer.segmentation(&scene).unwrap().as_slice());
    }
    let mut update = |index: usize, scene: &mut Scene| {
        update(index, scene);
        Ok(())
    };
    for _ in 0..2 {
        let mut colors = vec![1; 3 * count * AREA];
        renderer.rgb_batch_into(&mut update, &mut colors).unwrap();
        assert_similar(&colors, &rgb, |found, expected| found.abs_diff(*expected) <= 8);
        let mut depths = vec![1.0; count * AREA];
        renderer.depth_batch_into(&mut update, &mut depths).unwrap();
        assert_similar(&depths, &metres, |found, expected| {
            found == expected || (found - expected).abs() < 1e-3 * expected
        });
        let mut segments = vec![1; count * AREA];
        renderer.segmentation_batch_into(&mut update, &mut segments).unwrap();
        assert_similar(&segments, &ids, |found, expected| found == expected);
    }
}

/// Asserts that at most 0.5 % of the elements differ. Rounding at edges depends on the place of the
/// image in the texture.
fn assert_similar<T>(found: &[T], expected: &[T], is_equal: impl Fn(&T, &T) -> bool) {
    assert_eq!(found.len(), expected.len());
    let differences = found.iter().zip(expected).filter(|(found, expected)| !is_equal(found, expected)).count();
    assert!(200 * differences <= expected.len(), "{differences} of {} elements differ", expected.len());
}

#[test]
fn batch_contains_the_single_images_in_order() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let model = data.model().clone();
    let mut update = |index: usize, scene: &mut Scene| {
        data.reset().unwrap();
        data.qpos_mut()[2] = 1.3 + 0.1 * (index % 5) as f64;
        data.forward().unwrap();
        show(index, &mut data, scene).unwrap();
        for number in 0..index % 3 {
            scene.add_geom(&NewGeom::sphere(0.1).with_pos([0.4 * number as f64, 0.5, 1.0])).unwrap();
        }
    };
    // More images than two submissions contain: they have up to 4 for a software rasteriser, and 64
    // for hardware.
    let count = if stage::gpu().kind() == GpuKind::Software { 13 } else { 150 };
    check(&mut renderer(&model, 4), count, &mut update, &model);
    check(&mut renderer(&model, 1), 2, &mut update, &model);
}

#[test]
fn images_of_a_batch_may_need_different_render_targets() {
    let xml = "<mujoco><asset><material name='mirror' reflectance='.6'/></asset>
        <worldbody><light pos='0 -1 3'/>
          <geom type='box' size='.5 .5 .02' material='mirror'/>
          <geom type='sphere' size='.1' pos='0 0 .2' rgba='1 0 0 1'/>
        </worldbody></mujoco>";
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let update = |index: usize, scene: &mut Scene| {
        show(index, &mut data, scene).unwrap();
        // With a stencil buffer, without one, and without multisampling.
        let added = [RenderFlags::REFLECTION, RenderFlags::empty(), RenderFlags::SEGMENT][index / 2 % 3];
        let flags = scene.render_flags() - (RenderFlags::REFLECTION | RenderFlags::SEGMENT);
        scene.set_render_flags(flags | added);
    };
    check(&mut renderer(&model, 4), 9, update, &model);
}

#[test]
fn each_image_of_a_batch_shows_its_own_skin() {
    let xml = "<mujoco>
        <asset><skin name='skin' vertex='0 0 0  .4 0 0  0 .4 0' face='0 1 2  0 2 1'>
          <bone body='body' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/></skin></asset>
        <worldbody><light pos='0 -1 3'/><geom type='plane' size='1 1 .1'/>
          <body name='body' pos='-.1 -.1 .3'><freejoint/><geom size='.05'/></body>
        </worldbody></mujoco>";
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    let model = data.model().clone();
    let update = |index: usize, scene: &mut Scene| {
        data.qpos_mut()[0] = -0.4 + 0.1 * index as f64;
        data.forward().unwrap();
        show(0, &mut data, scene).unwrap();
    };
    check(&mut renderer(&model, 1), 5, update, &model);
}

#[test]
fn array_that_is_no_multiple_of_an_image_is_an_error() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut renderer = renderer(data.model(), 1);
    let mut update = |index: usize, scene: &mut Scene| show(index, &mut data, scene);
    for length in [1, AREA - 1, AREA + 1, 2 * AREA - 1] {
        let error = renderer.depth_batch_into(&mut update, &mut vec![0.0; length]).unwrap_err();
        assert!(matches!(error, RenderError::Other(Error::Shape { .. })), "{error:?}");
        assert!(renderer.rgb_batch_into(&mut update, &mut vec![0; 3 * length]).is_err());
        assert!(renderer.segmentation_batch_into(&mut update, &mut vec![0; length]).is_err());
    }
    renderer.rgb_batch_into(update, &mut []).unwrap();
}

#[test]
fn batch_after_an_error_contains_all_images() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let mut renderer = renderer(&model, 1);
    let mut fail = |index: usize, scene: &mut Scene| {
        show(index, &mut data, scene)?;
        if index == 3 { scene.add_geom(&NewGeom::sphere(f64::NAN)).map(drop) } else { Ok(()) }
    };
    let mut rgb = vec![0; 3 * 5 * AREA];
    assert!(renderer.rgb_batch_into(&mut fail, &mut rgb).is_err());
    check(&mut renderer, 3, |index, scene| show(index, &mut data, scene).unwrap(), &model);
}
