//! Images of many simulations in one array. Single images are the reference.

use mujoco_safe::environment::{Hopper, VectorEnvironment};
use mujoco_safe::render::{BatchCamera, GpuKind, RenderError, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories, NewGeom, RenderFlags, Scene, SceneOptions, VisualFlags};
use mujoco_safe::{Batch, Data, Error, Model, sample};

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cases::cases;
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

/// Compares the images of a batch with single images: colours, depths and ids.
fn check(renderer: &mut Renderer, count: usize, update: impl FnMut(usize, &mut Scene), model: &Model) {
    check_with(0.005, renderer, count, update, model);
}

/// Compares as [`check`] does. At most this share of the numbers may differ.
fn check_with(
    share: f64,
    renderer: &mut Renderer,
    count: usize,
    mut update: impl FnMut(usize, &mut Scene),
    model: &Model,
) {
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
    // Drawn one by one, and drawn together.
    for merges in [false, true, true] {
        let can_merge = renderer.set_merging(merges);
        assert!(can_merge || stage::gpu().kind() != GpuKind::Software || stage::gpu().backend() != "vulkan");
        let mut colors = vec![1; 3 * count * AREA];
        renderer.rgb_batch_into(&mut update, &mut colors).unwrap();
        assert_similar(share, &colors, &rgb, |found, expected| found.abs_diff(*expected) <= 8);
        let mut depths = vec![1.0; count * AREA];
        renderer.depth_batch_into(&mut update, &mut depths).unwrap();
        assert_similar(share, &depths, &metres, |found, expected| {
            found == expected || (found - expected).abs() < 1e-3 * expected
        });
        let mut segments = vec![1; count * AREA];
        renderer.segmentation_batch_into(&mut update, &mut segments).unwrap();
        assert_similar(share, &segments, &ids, |found, expected| found == expected);
    }
}

/// Asserts that the images of a comparison, of three kinds, were drawn together twice, if the
/// adapter can.
fn assert_together(renderer: &mut Renderer, count: usize) {
    let expected = if renderer.set_merging(true) { 6 * count } else { 0 };
    assert_eq!(renderer.images_drawn_together(), expected);
}

/// Asserts that at most this share of the elements differ. Rounding at edges depends on the place
/// of the image in the texture.
fn assert_similar<T>(share: f64, found: &[T], expected: &[T], is_equal: impl Fn(&T, &T) -> bool) {
    assert_eq!(found.len(), expected.len());
    let differences = found.iter().zip(expected).filter(|(found, expected)| !is_equal(found, expected)).count();
    let limit = (share * expected.len() as f64) as usize;
    assert!(differences <= limit, "{differences} of {} elements differ", expected.len());
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
    let mut of_many = renderer(&model, 4);
    check(&mut of_many, count, &mut update, &model);
    assert_together(&mut of_many, count);
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

/// A mirror, a sky, textures of both kinds, lights with all features, transparent geoms, lines and
/// a horizon.
const MIXED: &str = "<mujoco>
    <visual><headlight ambient='.2 .2 .2'/></visual>
    <asset>
      <texture name='sky' type='skybox' builtin='gradient' rgb1='.4 .6 .8' rgb2='0 0 .2' width='32' height='64'/>
      <texture name='tiles' type='2d' builtin='checker' rgb1='.1 .2 .3' rgb2='.5 .6 .7' width='32' height='32'/>
      <texture name='cube' type='cube' builtin='flat' mark='edge' rgb1='.8 .2 .3' markrgb='1 1 1' width='32' height='32'/>
      <material name='floor' texture='tiles' texrepeat='3 3' texuniform='true' reflectance='.4'/>
      <material name='ball' texture='cube' specular='.8' shininess='.6'/>
      <mesh name='wedge' vertex='0 0 0  .3 0 0  0 .3 0  0 0 .3'/>
    </asset>
    <worldbody>
      <light name='sun' directional='true' pos='0 0 4' dir='.2 .3 -1'/>
      <light name='spot' pos='1 -1 3' dir='-.3 .3 -1' cutoff='50' exponent='3'/>
      <light name='lamp' pos='-1 1 2' dir='0 0 -1' castshadow='false'/>
      <geom name='floor' type='plane' size='FLOOR' material='floor'/>
      <geom type='box' size='.2 .3 .1' pos='.7 .5 .1' rgba='.2 .7 .3 .5'/>
      <geom type='mesh' mesh='wedge' pos='-.6 .3 .1'/>
      <body name='ball' pos='0 0 .4'><freejoint/>
        <geom size='.15' material='ball'/><geom type='capsule' size='.05' fromto='0 0 0 .4 0 .3' rgba='.9 .8 .1 1'/>
        <site name='near' pos='.4 0 .3' size='.04' rgba='1 0 0 .4'/>
      </body>
      <site name='far' pos='-.5 -.5 .8'/>
    </worldbody>
    <tendon><spatial width='.01' rgba='.1 .3 .9 1'><site site='near'/><site site='far'/></spatial></tendon>
  </mujoco>";

#[test]
fn images_with_different_cameras_lights_and_colours_equal_single_images() {
    let flags = [RenderFlags::FOG, RenderFlags::HAZE, RenderFlags::ADDITIVE];
    for (case, (floor, flags)) in ["0 0 .2", "2 1.5 .1", "3 0 .3"].into_iter().zip(flags).enumerate().take(cases(1, 3))
    {
        let mut data = Data::new(Model::from_xml_str(&MIXED.replace("FLOOR", floor)).unwrap()).unwrap();
        let model = data.model().clone();
        let update = |index: usize, scene: &mut Scene| {
            let mut random = Xoshiro256PlusPlus::seed_from_u64((100 * case + index) as u64);
            let mut number = || random.random::<f32>();
            data.qpos_mut()[..3]
                .copy_from_slice(&[0, 1, 2].map(|axis| f64::from(number()) + 0.3 * f64::from(axis - 1)));
            data.edit_model(|edit| {
                for light in 0..model.nlight() {
                    edit.light_diffuse_mut()[light] = model.light_diffuse()[light].map(|part| part * number());
                    // With and without the feature.
                    let mut either = |value: f32| if number() < 0.5 { value } else { 0.0 };
                    edit.light_specular_mut()[light] = [either(0.6); 3];
                    edit.light_ambient_mut()[light] = [either(0.1); 3];
                    edit.light_attenuation_mut()[light] = [1.0, either(0.2), 0.0];
                    edit.light_exponent_mut()[light] = either(model.light_exponent()[light]);
                }
                edit.geom_rgba_mut()[1][3] = if number() < 0.5 { 1.0 } else { 0.5 };
            })
            .unwrap();
            data.forward().unwrap();
            let [azimuth, elevation, distance] =
                [360.0 * number(), -60.0 * number() - 2.0, 1.0 + 4.0 * number()].map(f64::from);
            let mut camera = Camera { azimuth, elevation, distance, ..Camera::free(data.model()) };
            scene.set_render_flags(scene.render_flags() | flags);
            scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        };
        let options = RendererOptions::default().with_samples(4).with_shadow_size(512);
        let mut renderer = Renderer::on(stage::gpu(), &model, SIZE[0], SIZE[1], options).unwrap();
        // These small images have many edges, also of textures.
        let count = cases(8, 12);
        check_with(0.01, &mut renderer, count, update, &model);
        assert_together(&mut renderer, count);
    }
}

#[test]
fn camera_of_a_batch_sees_each_simulation_with_its_edits() {
    let mut hoppers = VectorEnvironment::new(Hopper::model(), Hopper, 5, 3).unwrap();
    for _ in 0..20 {
        hoppers.step(&[0.3, -0.2, 0.1].repeat(5)).unwrap();
    }
    let (batch, model) = (hoppers.batch(), hoppers.batch().model().clone());
    // The second geom is red in the third simulation only, and the batch remains as it is.
    let edit = |index: usize, data: &mut Data| {
        data.edit_model(|edit| {
            if index == 2 {
                edit.geom_rgba_mut()[1] = [1.0, 0.0, 0.0, 1.0];
            }
        })
    };
    let mut free = Camera { azimuth: 90.0, distance: 4.0, ..Camera::free(&model) };
    let mut camera = BatchCamera::new(renderer(&model, 4), &model, &mut free).unwrap().with_edits(edit);
    let mut single = renderer(&model, 4);
    let (mut rgb, mut metres, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    let mut data = Data::new(&model).unwrap();
    for index in 0..batch.len() {
        batch.load(index, &mut data).unwrap();
        edit(index, &mut data).unwrap();
        data.forward().unwrap();
        let mut free = free;
        let images = single.snapshot(&mut data, &mut free).unwrap().images().unwrap();
        rgb.extend(images.rgb.into_bytes());
        metres.extend(images.depth.into_vec());
        ids.extend_from_slice(images.segmentation.as_slice());
    }
    assert_similar(0.005, camera.rgb(batch).unwrap(), &rgb, |found, expected| found.abs_diff(*expected) <= 8);
    assert_similar(0.005, camera.depth(batch).unwrap(), &metres, |found, expected| {
        found == expected || (found - expected).abs() < 1e-3 * expected
    });
    assert_similar(0.005, camera.segmentation(batch).unwrap(), &ids, |found, expected| found == expected);
    let red = |image: &[u8]| image.as_chunks::<3>().0.iter().filter(|[r, g, b]| *r > 100 && *g < 20 && *b < 20).count();
    let counts: Vec<usize> = camera.rgb(batch).unwrap().chunks(3 * AREA).map(red).collect();
    assert!(counts[2] > 0 && [0, 1, 3, 4].iter().all(|&index| counts[index] == 0), "{counts:?}");
    let without_contacts = camera.rgb(batch).unwrap().to_vec();
    let contacts = SceneOptions::default().with_flags(VisualFlags::CONTACTPOINT | VisualFlags::CONTACTFORCE);
    assert!(camera.with_scene_options(contacts).rgb(batch).unwrap() != without_contacts);
    let error = BatchCamera::new(renderer(&sample::cartpole(), 1), &model, &mut free).unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::OtherModel { .. })), "{error:?}");
    let mut camera = BatchCamera::new(renderer(&model, 1), &model, &mut free).unwrap();
    let other = Batch::new(sample::cartpole(), 1).unwrap();
    let error = camera.rgb(&other).unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::OtherModel { .. })), "{error:?}");

    let before = camera.rgb(batch).unwrap().to_vec();
    assert!(camera.adopt(other.model(), "no such camera").is_err());
    assert!(camera.rgb(batch).unwrap() == before);
    let mut free = Camera::free(other.model());
    camera.adopt(other.model(), &mut free).unwrap();
    let mut new = BatchCamera::new(renderer(other.model(), 1), other.model(), &mut free).unwrap();
    assert!(camera.rgb(&other).unwrap() == new.rgb(&other).unwrap());
    let error = camera.rgb(batch).unwrap_err();
    assert!(matches!(error, RenderError::Other(Error::OtherModel { .. })), "{error:?}");
}

#[test]
fn each_image_of_a_batch_shows_the_material_of_its_edit() {
    let xml = |material: &str| {
        format!(
            "<mujoco><asset>
                <texture name='tiles' type='2d' builtin='checker' rgb1='1 0 0' rgb2='0 0 1' width='32' height='32'/>
                <texture name='cube' type='cube' builtin='flat' mark='edge' rgb1='0 .8 0' markrgb='1 1 1' width='32' height='32'/>
                <material name='first' texture='tiles' texrepeat='2 2'/>
                <material name='second' texture='cube' specular='.8'/></asset>
              <worldbody><light pos='0 -1 3'/><geom name='table' type='box' size='.5 .5 .1' {material}/></worldbody></mujoco>"
        )
    };
    let materials = ["material='first'", "material='second'", ""];
    let batch = Batch::new(Model::from_xml_str(&xml(materials[0])).unwrap(), 6).unwrap();
    let model = batch.model().clone();
    let ids = [Some(model.material("first").unwrap().id()), Some(model.material("second").unwrap().id()), None];
    let mut free = Camera { azimuth: 30.0, elevation: -40.0, ..Camera::free(&model) };
    let edit = move |index: usize, data: &mut Data| {
        data.edit_model(|edit| edit.geom_mut("table").unwrap().set_material(ids[index % 3]))
    };
    let mut camera = BatchCamera::new(renderer(&model, 4), &model, &mut free).unwrap().with_edits(edit);
    // Models that were compiled with these materials.
    let expected = materials.map(|material| {
        let mut data = Data::new(Model::from_xml_str(&xml(material)).unwrap()).unwrap();
        data.forward().unwrap();
        let mut free = free;
        renderer(data.model(), 4).snapshot(&mut data, &mut free).unwrap().rgb().unwrap().into_bytes()
    });
    assert!(expected[0] != expected[1] && expected[1] != expected[2]);
    for (index, image) in camera.rgb(&batch).unwrap().chunks(3 * AREA).enumerate() {
        assert_similar(0.005, image, &expected[index % 3], |found, expected| found.abs_diff(*expected) <= 8);
    }
}
