//! Extreme numbers in a scene: the result is an image or an error, never a panic, a hang or a
//! validation error of the graphics API.
#![forbid(unsafe_code)]

use mujoco_safe::render::{Lighting, RenderError, Renderer, RendererOptions};
use mujoco_safe::scene::{
    Connector, NewGeom, RenderFlags, Scene, SceneOptions, TextureRepeat, Transform, Viewpoint, VisualFlags,
};
use mujoco_safe::{Data, Error, Model};

use crate::cases::cases;
use crate::stage::{self, Stage};

/// Numbers for fields of a model, and for colours and positions of a geom in a scene.
const NUMBERS: [f64; 10] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e-30, 1e-45, 1e14, 1e30, f32::MAX as f64];

/// A model of everything that can be drawn, with every kind of light.
const WORLD: &str = r#"<mujoco>
  <visual><quality shadowsize="64"/></visual>
  <asset>
    <texture name="flat" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 1 0"/>
    <texture name="cube" type="cube" builtin="flat" mark="cross" width="8" height="8" rgb1="1 0 0" markrgb="1 1 1"/>
    <texture type="skybox" builtin="gradient" width="8" height="8" rgb1="0 0 1" rgb2="0 0 0"/>
    <material name="flat" texture="flat" texrepeat="2 2" texuniform="true" reflectance="0.4"/>
    <material name="cube" texture="cube" texuniform="true" emission="0.1" specular="1" shininess="0.9"/>
    <mesh name="corner" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
    <hfield name="hill" nrow="3" ncol="3" size="1 1 0.3 0.1"/>
  </asset>
  <worldbody>
    <light pos="0 0 3" dir="0 0 -1" cutoff="60" attenuation="1 0.1 0.1"/>
    <light directional="true" pos="2 0 3" dir="-1 0 -1" ambient="0.1 0.1 0.1"/>
    <light pos="1 1 2" dir="0 0 -1" castshadow="false" exponent="0"/>
    <geom type="plane" size="0 0 1" material="flat"/>
    <geom type="sphere" size="0.2" pos="0 0 1" material="cube"/>
    <geom type="capsule" size="0.1 0.3" pos="1 0 1" material="flat"/>
    <geom type="ellipsoid" size="0.1 0.2 0.3" pos="0 1 1" rgba="1 1 1 0.5"/>
    <geom type="cylinder" size="0.1 0.2" pos="-1 0 1"/>
    <geom type="box" size="0.1 0.2 0.3" pos="0 -1 1" material="cube"/>
    <geom type="mesh" mesh="corner" pos="1 1 0.5"/>
    <geom type="hfield" hfield="hill" pos="-2 -2 0.2"/>
  </worldbody>
</mujoco>"#;

/// Accepts an image, or an error that is not a validation error of the graphics API.
#[track_caller]
fn accept<T>(result: Result<T, RenderError>, what: &str) {
    match result {
        Ok(_) | Err(RenderError::Other(Error::Invalid { .. })) => {}
        Err(error) => panic!("{what}: {error}"),
    }
}

/// Renders colour, depth and segmentation of a scene.
#[track_caller]
fn draw_all(renderer: &mut Renderer, scene: &mut Scene, what: &str) {
    for flags in [RenderFlags::empty(), RenderFlags::WIREFRAME | RenderFlags::FOG, RenderFlags::SEGMENT] {
        scene.set_render_flags(RenderFlags::all() & !(RenderFlags::WIREFRAME | RenderFlags::SEGMENT) | flags);
        accept(renderer.rgb(scene), what);
    }
    accept(renderer.depth(scene), what);
    accept(renderer.segmentation(scene), what);
}

#[test]
fn a_geom_of_any_position_and_colour_is_drawn_or_skipped() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    for (index, number) in NUMBERS.map(|number| number as f32).into_iter().enumerate() {
        for set in (0..4).skip(index % cases(2, 1)).step_by(cases(2, 1)) {
            stage.update();
            for mut geom in stage.scene.geoms_mut() {
                match set {
                    0 => geom.set_pos([number, 0.0, 1.0]),
                    1 => geom.set_rgba([number, 0.5, 0.5, 1.0]),
                    2 => geom.set_rgba([1.0, 1.0, 1.0, number]),
                    _ => geom.set_emission(number),
                }
                geom.set_label("here").unwrap();
            }
            let Stage { renderer, scene, .. } = &mut stage;
            draw_all(renderer, scene, &format!("{number} as {set}"));
        }
    }
}

#[test]
fn a_new_geom_of_any_size_is_drawn_or_skipped() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let texture = stage.data.model().texture("cube").unwrap().id();
    let textured = |size: f64| {
        let cuboid = NewGeom::cuboid([1.0; 3]);
        // The textures of newer engines belong to materials.
        if cfg!(engine_since = "3.2.1") {
            cuboid
        } else {
            cuboid.with_texture(texture, TextureRepeat::PerLength([size as f32; 2]))
        }
    };
    for size in [0.0, 1e-45, 1e-30, 1.0, 1e14, 1e30, f64::from(f32::MAX)] {
        stage.update();
        for geom in [
            NewGeom::plane([size, 1.0]),
            NewGeom::sphere(size),
            NewGeom::capsule(size, 1.0),
            NewGeom::capsule(0.1, size),
            NewGeom::ellipsoid([size, 1.0, size]),
            NewGeom::cylinder(size, size),
            NewGeom::cuboid([size, 0.0, 1.0]),
            NewGeom::connector(Connector::Line, size, [0.0; 3], [1.0, 0.0, size]),
            NewGeom::connector(Connector::Arrow, size, [0.0; 3], [0.0; 3]),
            NewGeom::connector(Connector::Arrow2, 0.1, [0.0; 3], [size, size, 0.0]),
            NewGeom::sphere(1.0).with_mat([size, 0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, 0.0]),
            textured(size),
            NewGeom::cuboid([1.0; 3]).with_surface(size as f32, size as f32, size as f32, size as f32),
            NewGeom::text("a\u{1F916}b").unwrap().with_pos([size; 3]),
        ] {
            for alpha in [1.0, 0.5] {
                stage.scene.add_geom(&geom.clone().with_rgba([1.0, 1.0, 1.0, alpha])).unwrap();
            }
        }
        let Stage { renderer, scene, .. } = &mut stage;
        draw_all(renderer, scene, &format!("size {size}"));
    }
}

#[test]
fn a_model_of_any_numbers_is_drawn() {
    let mut model = Model::from_xml_str(WORLD).unwrap();
    for (index, number) in NUMBERS.into_iter().enumerate().step_by(cases(2, 1)) {
        let single = number as f32;
        let mut edit = model.edit();
        edit.light_pos_mut().fill([number; 3]);
        edit.light_attenuation_mut()[0] = [single; 3];
        edit.light_cutoff_mut().fill(single);
        edit.light_exponent_mut().fill(single);
        edit.light_diffuse_mut().fill([single; 3]);
        edit.mat_texrepeat_mut().fill([single; 2]);
        edit.mat_shininess_mut().fill(single);
        edit.mat_reflectance_mut().fill(single);
        edit.hfield_data_mut()[4] = single;
        let mut data = Data::new(model.clone()).unwrap();
        data.forward().unwrap();
        let mut scene = stage::scene(&mut data);
        let lightings = [Lighting::PerPixel, Lighting::PerVertex];
        for lighting in lightings.into_iter().skip(index / 2 % cases(2, 1)).step_by(cases(2, 1)) {
            let options = RendererOptions::default().with_lighting(lighting);
            let mut renderer = Renderer::on(stage::gpu(), &model, 8, 8, options).unwrap();
            draw_all(&mut renderer, &mut scene, &format!("a model of {number}"));
        }
    }
}

#[test]
fn any_viewpoint_is_drawn_or_rejected() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let good = stage.scene.viewpoint();
    let Stage { renderer, scene, .. } = &mut stage;
    for number in [0.0, 1e-38, 1e-20, 1.0, 1e14, 1e20, f32::MAX] {
        for viewpoint in [
            Viewpoint { pos: [number, 0.0, 0.0], ..good },
            Viewpoint { forward: [0.0, 0.0, number], ..good },
            Viewpoint { up: [number; 3], forward: [number; 3], ..good },
            Viewpoint { frustum_top: number, frustum_bottom: -number, ..good },
            Viewpoint { frustum_near: number, ..good },
            Viewpoint { frustum_far: number, ..good },
            Viewpoint { frustum_center: number, ..good },
        ] {
            // Viewpoints that the scene rejects are not rendered.
            if scene.set_viewpoints([viewpoint; 2]).is_ok() {
                draw_all(renderer, scene, &format!("{viewpoint:?}"));
            }
        }
    }
}

#[test]
fn any_transform_of_the_model_is_drawn() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let Stage { renderer, scene, .. } = &mut stage;
    for scale in [0.01, 1.0, 100.0] {
        for shift in [0.0, 1e14, f32::MAX] {
            let transform = Transform { translate: [shift; 3], rotate: [1e-30, 0.0, 0.0, 1.0], scale };
            scene.set_transform(Some(transform)).unwrap();
            draw_all(renderer, scene, &format!("{transform:?}"));
        }
    }
}

#[test]
fn any_quality_is_drawn() {
    let set = |quality: &str| WORLD.replace(r#"<quality shadowsize="64"/>"#, quality);
    for quality in [
        r#"<quality shadowsize="0"/>"#,
        r#"<quality shadowsize="1"/>"#,
        r#"<quality shadowsize="3"/>"#,
        r#"<quality shadowsize="5" offsamples="3" numslices="1" numstacks="1" numquads="1"/>"#,
        r#"<quality offsamples="0" numslices="0" numstacks="-5" numquads="-1"/>"#,
        r#"<map znear="0.5" zfar="0.6" haze="0"/>"#,
        r#"<map fogstart="5" fogend="5" shadowclip="0" shadowscale="1e9"/>"#,
        r#"<map fogstart="-1e30" fogend="1e30" haze="-7" zfar="1e9"/>"#,
        r#"<global linewidth="-1"/>"#,
    ] {
        let mut stage = Stage::new(&set(quality), [16, 12]);
        let Stage { renderer, scene, .. } = &mut stage;
        draw_all(renderer, scene, quality);
    }
}

#[test]
fn any_number_of_lights_is_drawn() {
    for count in [0, 1, 7, 9, 100] {
        let lights: String = (0..count).map(|_| r#"<light pos="0 0 3" dir="0 0 -1" cutoff="80"/>"#).collect();
        let headlight = if count == 100 { r#"<visual><headlight active="0"/></visual>"# } else { "" };
        let xml =
            format!(r#"<mujoco>{headlight}<worldbody>{lights}<geom type="plane" size="1 1 1"/></worldbody></mujoco>"#);
        for lighting in [Lighting::PerVertex, Lighting::PerPixel] {
            let options = RendererOptions::default().with_shadow_size(16).with_samples(1).with_lighting(lighting);
            let mut stage = Stage::with(&xml, [4, 4], options);
            accept(stage.renderer.rgb(&stage.scene), &format!("{count} lights"));
        }
    }
}

#[test]
fn a_scene_without_an_update_is_rejected() {
    let stage = Stage::new(WORLD, [16, 12]);
    let scene = Scene::new(stage.data.model(), 10).unwrap();
    let mut renderer = stage.renderer;
    for result in
        [renderer.rgb(&scene).map(drop), renderer.depth(&scene).map(drop), renderer.segmentation(&scene).map(drop)]
    {
        assert!(matches!(result, Err(RenderError::Other(Error::Invalid { .. }))), "{result:?}");
    }
}

#[test]
fn a_scene_of_another_model_is_rejected() {
    let stage = Stage::new(WORLD, [16, 12]);
    let mut other = Stage::new(WORLD, [16, 12]);
    let is_rejected = |result: Result<(), RenderError>| {
        assert!(matches!(result, Err(RenderError::Other(Error::OtherModel { .. }))), "{result:?}");
    };
    is_rejected(other.renderer.rgb(&stage.scene).map(drop));
    is_rejected(other.renderer.depth(&stage.scene).map(drop));
    is_rejected(other.renderer.segmentation(&stage.scene).map(drop));
    let (own, foreign) = (other.data.model().clone(), stage.data.model());
    is_rejected(other.renderer.update_texture(foreign, own.texture("flat").unwrap().id()));
    is_rejected(other.renderer.update_mesh(foreign, own.mesh("corner").unwrap().id()));
    is_rejected(other.renderer.update_height_field(foreign, own.height_field("hill").unwrap().id()));
}

#[test]
#[should_panic(expected = "another model")]
fn an_id_of_another_model_panics() {
    let foreign = Model::from_xml_str(WORLD).unwrap();
    let mut stage = Stage::new(WORLD, [16, 12]);
    let model = stage.data.model().clone();
    let _ = stage.renderer.update_texture(&model, foreign.texture("flat").unwrap().id());
}

#[test]
fn an_asset_that_the_model_lacks_is_an_error() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let model = stage.data.model().clone();
    let result = stage.renderer.update_mesh(&model, "flat");
    assert!(matches!(result, Err(RenderError::Other(Error::NoSuchName { .. }))), "{result:?}");
    let result = stage.renderer.update_texture(&model, model.ntex());
    assert!(matches!(result, Err(RenderError::Other(Error::NoSuchIndex { .. }))), "{result:?}");
}

#[test]
fn an_invalid_image_size_is_an_error() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let too_large = |result: &Result<_, _>| matches!(result, Err(RenderError::TooLarge { size: 0x7FFF_FFFF, .. }));
    for [width, height] in [[0, 12], [16, 0]] {
        let result = stage.renderer.resize(width, height);
        assert!(matches!(result, Err(RenderError::Other(Error::Invalid { .. }))), "{result:?}");
    }
    assert!(too_large(&stage.renderer.resize(0x7FFF_FFFF, 12)));
    assert!(too_large(&stage.renderer.resize(16, 0x7FFF_FFFF)));
    assert_eq!(stage.renderer.size(), [16, 12], "the size is unchanged");
    let options = RendererOptions::default().with_shadow_size(0x7FFF_FFFF);
    assert!(too_large(&Renderer::on(stage::gpu(), stage.data.model(), 16, 12, options).map(drop)));
    let mut wrong = vec![0; 4 * 16 * 12 - 1];
    let result = stage.renderer.rgba_into(&stage.scene, &mut wrong);
    assert!(matches!(result, Err(RenderError::Other(Error::Shape { .. }))), "{result:?}");
}

#[test]
fn every_visual_flag_is_drawn() {
    let mut stage = Stage::new(WORLD, [16, 12]);
    let Stage { data, scene, camera, renderer } = &mut stage;
    for flag in VisualFlags::all() {
        let options = SceneOptions::default().with_flags(flag);
        scene.update(data, &options, None, camera, mujoco_safe::scene::Categories::all()).unwrap();
        accept(renderer.rgb(scene), &format!("{flag:?}"));
    }
}
