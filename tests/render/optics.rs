//! Pixels against the formulas of optics: colours, light, transparency, fog, mirrors and shadows,
//! independent of the implementation.
#![forbid(unsafe_code)]

use mujoco_safe::render::{Lighting, Renderer, RendererOptions, RgbImage};
use mujoco_safe::scene::{NewGeom, RenderFlags};

use crate::stage::{self, Stage};

const SIZE: [usize; 2] = [33, 33];

fn world(visual: &str, body: &str) -> String {
    format!(
        r#"<mujoco><statistic extent="1" center="0 0 0"/>
           <visual><headlight active="0"/><map znear="0.01" zfar="100"/>{visual}</visual>
           <worldbody>{body}</worldbody></mujoco>"#
    )
}

fn middle(picture: &RgbImage) -> [u8; 3] {
    picture.pixel(picture.width() / 2, picture.height() / 2)
}

/// Asserts that colours are equal up to the rounding of a byte.
#[track_caller]
fn assert_rgb(actual: [u8; 3], expected: [f64; 3]) {
    let is_close =
        actual.iter().zip(expected).all(|(&actual, expected)| (f64::from(actual) - 255.0 * expected).abs() <= 1.0);
    assert!(is_close, "{actual:?} is not {:?}", expected.map(|part| 255.0 * part));
}

#[test]
fn an_empty_scene_is_black_without_depth_and_geoms() {
    let mut stage = Stage::new(&world("", ""), SIZE);
    assert!(stage.rgb().as_bytes().iter().all(|&byte| byte == 0));
    assert!(stage.renderer.depth(&stage.scene).unwrap().as_slice().iter().all(|depth| *depth == f32::INFINITY));
    assert!(stage.renderer.segmentation(&stage.scene).unwrap().pixels().all(|pixel| pixel.is_none()));
}

#[test]
fn an_emissive_material_has_its_own_colour() {
    let mut stage = Stage::new(&world("", r#"<light directional="true" diffuse="0 0 0" specular="0 0 0"/>"#), SIZE);
    stage.look_along_x([0.0; 3], 3.0);
    stage
        .scene
        .add_geom(&NewGeom::sphere(0.5).with_rgba([0.2, 0.4, 0.6, 1.0]).with_surface(1.0, 0.0, 0.0, 0.0))
        .unwrap();
    let picture = stage.rgb();
    assert_rgb(middle(&picture), [0.2, 0.4, 0.6]);
    assert_eq!(picture.pixel(0, 0), [0; 3], "beside the box");
    let depth = stage.renderer.depth(&stage.scene).unwrap();
    assert!((depth.metres(16, 16) - 2.5).abs() < 0.01, "{}", depth.metres(16, 16));
}

#[test]
fn a_directional_light_follows_the_cosine_law() {
    // The visible side of the box faces along -x.
    let body = r#"<light directional="true" castshadow="false" dir="3 0 -4" ambient="0.1 0.2 0" diffuse="0.5 0.5 0.5" specular="0 0 0"/>
                  <geom type="box" size="0.5 2 2" rgba="1 0.5 0.25 1"/>"#;
    for lighting in [Lighting::PerVertex, Lighting::PerPixel] {
        let options = RendererOptions::default().with_samples(1).with_lighting(lighting);
        let mut stage = Stage::with(&world("", body), SIZE, options);
        stage.look_along_x([0.0; 3], 3.0);
        let cosine = 0.6;
        let expected = [0, 1, 2].map(|channel| {
            let (rgb, ambient) = ([1.0, 0.5, 0.25][channel], [0.1, 0.2, 0.0][channel]);
            rgb * (ambient + 0.5 * cosine)
        });
        assert_rgb(middle(&stage.rgb()), expected);
    }
}

#[test]
fn lights_beyond_the_limit_of_the_options_are_ignored() {
    // Light k adds k/100 of red. With the engine's OpenGL only the first 8 lights have an effect.
    let light = |k: usize| {
        let red = 0.01 * k as f64;
        format!(r#"<light directional="true" castshadow="false" dir="1 0 0" diffuse="{red} 0 0" specular="0 0 0"/>"#)
    };
    let body: String = (1..=10).map(light).collect();
    let body = format!(r#"{body}<geom type="box" size="0.5 2 2" rgba="1 1 1 1"/>"#);
    for (limit, total) in [(None, 55.0), (Some(8), 36.0), (Some(1), 1.0)] {
        let mut options = RendererOptions::default().with_samples(1);
        options.max_lights = limit;
        let mut stage = Stage::with(&world("", &body), SIZE, options);
        stage.look_along_x([0.0; 3], 3.0);
        assert_rgb(middle(&stage.rgb()), [0.01 * total, 0.0, 0.0]);
    }
}

#[test]
fn a_spot_light_attenuates_and_has_a_cone() {
    let lamp = |cutoff: f64, x: f64| {
        let body = format!(
            r#"<light castshadow="false" pos="{x} 0 0" dir="1 0 0" cutoff="{cutoff}" exponent="0" attenuation="1 0.5 0.25"
                      ambient="0 0 0" diffuse="1 1 1" specular="0 0 0"/>
               <geom type="box" size="0.5 0.6 0.6" rgba="1 1 1 1"/>"#
        );
        let options = RendererOptions::default().with_samples(1).with_lighting(Lighting::PerPixel);
        let mut stage = Stage::with(&world("", &body), SIZE, options);
        stage.look_along_x([0.0; 3], 3.0);
        stage.rgb()
    };
    for x in [-1.5, -2.5] {
        let distance = -0.5 - x;
        let strength = 1.0 / (1.0 + 0.5 * distance + 0.25 * distance * distance);
        assert_rgb(middle(&lamp(90.0, x)), [strength; 3]);
    }
    // The cone of 20° is 0.36 m wide at 1 m, and the frustum of 45° 1.04 m at 2.5 m: 6 pixels from
    // the middle are 0.38 m.
    let spot = lamp(20.0, -1.5);
    assert!(spot.pixel(16 + 4, 16)[0] > 50 && spot.pixel(16 + 8, 16)[0] == 0, "{:?}", spot.pixel(24, 16));
}

#[test]
fn a_specular_highlight_is_at_the_mirror_direction() {
    // Light and camera are both at -x, so the highlight is where the sphere faces them.
    let body = r#"<light directional="true" castshadow="false" dir="1 0 0" diffuse="0 0 0" specular="1 1 1"/>"#;
    let options = RendererOptions::default().with_samples(1).with_lighting(Lighting::PerPixel);
    let mut stage = Stage::with(&world("", body), SIZE, options);
    stage.look_along_x([0.0; 3], 3.0);
    stage
        .scene
        .add_geom(&NewGeom::sphere(0.5).with_rgba([0.5, 0.5, 0.5, 1.0]).with_surface(0.0, 0.8, 0.5, 0.0))
        .unwrap();
    let picture = stage.rgb();
    let [red, ..] = middle(&picture);
    assert!((f64::from(red) - 255.0 * 0.8).abs() < 4.0, "{red}");
    assert!(picture.pixel(16 + 5, 16)[0] < red / 2);
}

#[test]
fn transparent_geoms_are_blended() {
    let dark = r#"<light directional="true" diffuse="0 0 0" specular="0 0 0"/>"#;
    let mut stage = Stage::new(&world("", dark), SIZE);
    stage.look_along_x([0.0; 3], 3.0);
    let wall = |x: f64, rgba| {
        NewGeom::cuboid([0.01, 2.0, 2.0]).with_pos([x, 0.0, 0.0]).with_rgba(rgba).with_surface(1.0, 0.0, 0.0, 0.0)
    };
    stage.scene.add_geom(&wall(0.0, [0.0, 0.5, 0.0, 0.4])).unwrap();
    stage.scene.add_geom(&wall(1.0, [1.0, 0.0, 0.0, 1.0])).unwrap();
    // It is drawn twice, front to back and back to front, like in the engine.
    let over = |below: f64, own: f64| 0.4 * own + 0.6 * below;
    assert_rgb(middle(&stage.rgb()), [over(over(1.0, 0.0), 0.0), over(over(0.0, 0.5), 0.5), 0.0]);
    stage.scene.set_render_flags(stage.scene.render_flags() | RenderFlags::ADDITIVE);
    assert_rgb(middle(&stage.rgb()), [1.0, 0.4 * 0.5, 0.0]);
}

#[test]
fn fog_hides_distant_geoms() {
    let visual = r#"<map fogstart="2" fogend="4" znear="0.01" zfar="100"/><rgba fog="0 0 1 1"/>"#;
    let xml = format!(
        r#"<mujoco><statistic extent="1" center="0 0 0"/><visual><headlight active="0"/>{visual}</visual><worldbody>
           <light directional="true" diffuse="0 0 0" specular="0 0 0"/></worldbody></mujoco>"#
    );
    let mut stage = Stage::new(&xml, SIZE);
    stage.look_along_x([0.0; 3], 3.0);
    let flags = stage.scene.render_flags() | RenderFlags::FOG;
    for (x, clear) in [(-1.5, 1.0), (0.0, 0.5), (0.5, 0.25), (2.0, 0.0)] {
        stage.update();
        stage.scene.set_render_flags(flags);
        // The visible side of the box is at x.
        let wall = NewGeom::cuboid([0.5, 3.0, 3.0]).with_pos([x + 0.5, 0.0, 0.0]);
        stage.scene.add_geom(&wall.with_rgba([1.0, 0.0, 0.0, 1.0]).with_surface(1.0, 0.0, 0.0, 0.0)).unwrap();
        assert_rgb(middle(&stage.rgb()), [clear, 0.0, 1.0 - clear]);
    }
}

#[test]
fn the_sky_is_visible_through_the_wire_frame_of_a_floor() {
    let xml = r#"<mujoco><statistic extent="1" center="0 0 0"/><visual><map znear="0.01" zfar="100"/></visual>
      <asset><texture type="skybox" builtin="flat" width="8" height="48" rgb1="0.2 0.4 0.6" rgb2="0.2 0.4 0.6"/></asset>
      <worldbody><geom type="plane" size="0 0 1"/></worldbody></mujoco>"#;
    let mut stage = Stage::new(xml, SIZE);
    stage.look([0.0; 3], 1.0, 90.0, -70.0);
    let is_sky = |picture: &RgbImage| {
        let near = |pixel: &&[u8; 3]| pixel.iter().zip([51, 102, 153]).all(|(&byte, sky)| byte.abs_diff(sky) <= 1);
        picture.as_bytes().as_chunks::<3>().0.iter().filter(near).count()
    };
    assert_eq!(is_sky(&stage.rgb()), 0, "the floor hides the sky");
    stage.scene.set_render_flags(stage.scene.render_flags() | RenderFlags::WIREFRAME);
    assert!(is_sky(&stage.rgb()) > 33 * 33 / 2);
}

#[test]
fn wireframes_have_the_edges_of_quadrilaterals_without_their_diagonals() {
    let xml = r#"<mujoco><visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/><map znear="0.01"/></visual>
      <worldbody><geom type="plane" size="1 1 1" rgba="1 0 0 1"/></worldbody></mujoco>"#;
    let mut stage = Stage::new(xml, [201, 201]);
    // The plane has four cells of 1 m by 1 m. From this distance 0.01 m is a pixel.
    stage.look([0.0; 3], 1.005 / 22.5_f64.to_radians().tan(), 90.0, -90.0);
    stage.scene.set_render_flags(stage.scene.render_flags() | RenderFlags::WIREFRAME);
    let picture = stage.rgb();
    let is_line = |x: usize, y: usize| {
        (-1..=1).any(|shift: isize| {
            let [x, y] = [x, y].map(|at| (at as isize + shift) as usize);
            picture.pixel(x, y)[0] > 60
        })
    };
    // Points on the border of the cells, away from other lines.
    for (x, y) in [(100, 40), (100, 160), (40, 100), (160, 100)] {
        assert!(is_line(x, y), "no edge at {x}, {y}");
    }
    // The centres of the cells, which are on both diagonals.
    for (x, y) in [(50, 50), (150, 50), (50, 150), (150, 150), (30, 30), (170, 30)] {
        assert!(!(y - 4..=y + 4).any(|y| picture.pixel(x, y)[0] > 0), "a diagonal at {x}, {y}");
    }
}

#[test]
fn a_mirror_shows_the_reflected_geom() {
    let mirror = |size: &str| {
        let xml = format!(
            r#"<mujoco><statistic extent="1" center="0 0 0"/><visual><headlight active="0"/><map zfar="100"/></visual>
               <asset><material name="mirror" reflectance="0.5" rgba="0 0 0 1" specular="0"/></asset>
               <worldbody><light directional="true" diffuse="0 0 0" specular="0 0 0"/>
                 <geom type="plane" size="{size}" material="mirror"/></worldbody></mujoco>"#
        );
        let mut stage = Stage::new(&xml, [65, 65]);
        // The camera looks down at 30°: the ball is 0.5 m above the floor, and its reflection 0.5 m
        // below.
        stage.look([0.0; 3], 4.0, 0.0, -30.0);
        let ball = NewGeom::sphere(0.2)
            .with_pos([0.0, 0.0, 0.5])
            .with_rgba([1.0, 0.5, 0.0, 1.0])
            .with_surface(1.0, 0.0, 0.0, 0.0);
        stage.scene.add_geom(&ball).unwrap();
        stage
    };
    for size in ["0 0 1", "2 2 1"] {
        let mut stage = mirror(size);
        let picture = stage.rgb();
        // The distance of the reflection from the centre of the image follows from its position in
        // the frustum of 45°.
        let (along, down) = (4.0 + 0.5 * 0.5, 0.5 * 30_f64.to_radians().cos());
        let row = 32.5 + 32.5 * down / along / 22.5_f64.to_radians().tan();
        assert_rgb(picture.pixel(32, row as usize), [0.5, 0.25, 0.0]);
        stage.scene.set_render_flags(stage.scene.render_flags() & !RenderFlags::REFLECTION);
        assert_eq!(stage.rgb().pixel(32, row as usize), [0; 3]);
    }
    // No reflection appears beside a small mirror.
    let picture = mirror("0.05 0.05 1").rgb();
    assert!((33..65).all(|row| picture.pixel(32, row)[0] < 130));
    assert!((36..65).all(|row| picture.pixel(32, row) == [0; 3]), "a reflection beside the mirror");
}

#[test]
fn a_shadow_is_where_light_is_blocked() {
    // The light shines straight down from 3 m: the ball's shadow is a disk around the origin.
    for light in
        [r#"directional="true" pos="0 0 3" dir="0 0 -1""#, r#"pos="0 0 3" dir="0 0 -1" cutoff="60" exponent="0""#]
    {
        let xml = world(
            r#"<quality shadowsize="512"/>"#,
            &format!(
                r#"<light {light} ambient="0.2 0.2 0.2" diffuse="0.6 0.6 0.6" specular="0 0 0"/>
                   <geom type="plane" size="1 1 0.1" rgba="1 1 1 1"/>
                   <geom type="sphere" size="0.2" pos="0 0 1.5"/>"#
            ),
        );
        let mut stage = Stage::new(&xml, [65, 65]);
        // From below the ball, at 45°.
        stage.look([0.0; 3], 1.5, 0.0, -45.0);
        let shaded = stage.rgb();
        assert_eq!(middle(&shaded), [0; 3], "a light adds nothing in its shadow, not even its ambient part");
        assert!(shaded.pixel(2, 32)[0] > 100, "beside the shadow {:?}", shaded.pixel(2, 32));
        stage.scene.set_render_flags(stage.scene.render_flags() & !RenderFlags::SHADOW);
        assert!(middle(&stage.rgb())[0] > 100, "without shadows");
    }
}

#[test]
fn geoms_outside_the_view_cast_visible_shadows() {
    // The ball is two metres to the left, or behind the camera; the shadow of its centre is at the
    // origin.
    for ball in [[0.0, -2.0, 1.0], [0.0, 2.0, 1.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [0.0, 0.0, 2.0]] {
        let [x, y, z] = ball;
        let toward = format!(r#"dir="{} {} {}""#, -x, -y, -z);
        let parallel = format!(r#"directional="true" pos="{x} {y} {}" {toward}"#, z + 1.0);
        let lamp = format!(r#"pos="{} {} {}" {toward} cutoff="60" exponent="0""#, 2.0 * x, 2.0 * y, 2.0 * z);
        for light in [parallel, lamp] {
            let xml = world(
                r#"<quality shadowsize="1024"/>"#,
                &format!(
                    r#"<light {light} ambient="0 0 0" diffuse="1 1 1" specular="0 0 0" attenuation="1 0 0"/>
                       <geom type="plane" size="5 5 0.1" rgba="1 1 1 1"/>
                       <body pos="{x} {y} {z}"><freejoint/><geom size="0.3"/></body>"#
                ),
            );
            let mut stage = Stage::new(&xml.replace("<map", r#"<map shadowclip="4""#), [33, 33]);
            stage.look([0.0; 3], 1.0, 0.0, -60.0);
            let ball = stage.renderer.segmentation(&stage.scene).unwrap();
            let is_floor = ball.pixels().all(|pixel| pixel.is_some_and(|segment| segment.geom == 0));
            assert!(is_floor, "the ball is in sight");
            assert_eq!(middle(&stage.rgb()), [0; 3], "{light}");
            stage.data.qpos_mut()[2] = -5.0;
            stage.data.forward().unwrap();
            stage.update();
            assert!(middle(&stage.rgb())[0] > 100, "{light}: unexpected shadow");
        }
    }
}

#[test]
fn segmentation_colours_equal_segmentation_numbers() {
    let body = r#"<geom type="sphere" size="0.3" pos="0 0.4 0"/><geom type="box" size="0.2 0.2 0.2" pos="0 -0.4 0" rgba="1 1 1 0.3"/>"#;
    let mut stage = Stage::new(&world("", body), SIZE);
    stage.look_along_x([0.0; 3], 3.0);
    let segmentation = stage.renderer.segmentation(&stage.scene).unwrap();
    stage.scene.set_render_flags(stage.scene.render_flags() | RenderFlags::SEGMENT | RenderFlags::IDCOLOR);
    let colors = stage.rgb();
    let mut seen = [false; 2];
    for (rgb, segment) in colors.as_bytes().as_chunks::<3>().0.iter().zip(segmentation.pixels()) {
        let number = u32::from_le_bytes([rgb[0], rgb[1], rgb[2], 0]);
        assert_eq!(number.checked_sub(1), segment.map(|segment| segment.geom as u32));
        if let Some(segment) = segment {
            seen[segment.geom] = true;
        }
    }
    assert_eq!(seen, [true; 2]);
}

#[test]
fn images_do_not_depend_on_the_thread_or_earlier_sizes() {
    let xml = world(
        r#"<quality shadowsize="256"/>"#,
        r#"<light pos="0 0 3"/><geom type="plane" size="0 0 1"/><geom size="0.3" pos="0 0 1"/>"#,
    );
    let mut stage = Stage::with(&xml, [48, 32], RendererOptions::default());
    let expected = stage.rgb();
    for [width, height] in [[1, 1], [100, 3], [48, 32]] {
        stage.renderer.resize(width, height).unwrap();
        let picture = stage.rgb();
        assert_eq!([picture.width(), picture.height()], [width, height]);
        let mut rgba = vec![0; 4 * width * height];
        stage.renderer.rgba_into(&stage.scene, &mut rgba).unwrap();
        let same = rgba.as_chunks::<4>().0.iter().zip(picture.as_bytes().as_chunks::<3>().0);
        assert!(same.into_iter().all(|(rgba, rgb)| rgba[..3] == rgb[..] && rgba[3] == 255));
    }
    assert_eq!(stage.rgb(), expected);
    let (scene, model) = (&stage.scene, stage.data.model());
    std::thread::scope(|threads| {
        for _ in 0..3 {
            threads.spawn(|| {
                let mut renderer = Renderer::on(stage::gpu(), model, 48, 32, RendererOptions::default()).unwrap();
                for _ in 0..3 {
                    assert_eq!(renderer.rgb(scene).unwrap(), expected);
                }
            });
        }
    });
}

#[test]
fn an_edited_model_is_drawn_after_an_update_of_the_renderer() {
    let xml = r#"<mujoco><statistic extent="1" center="0 0 0"/><visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
      <asset><texture name="t" type="2d" builtin="flat" width="4" height="4" rgb1="1 0 0"/><material name="m" texture="t"/>
        <hfield name="h" nrow="2" ncol="2" size="1 1 1 0.1"/></asset>
      <worldbody><geom type="hfield" hfield="h" material="m"/></worldbody></mujoco>"#;
    let mut stage = Stage::new(xml, SIZE);
    stage.look([0.0; 3], 5.0, 0.0, -90.0);
    assert_eq!(middle(&stage.rgb()), [255, 0, 0]);
    let near = stage.renderer.depth(&stage.scene).unwrap().metres(16, 16);
    let (texture, field) = {
        let model = stage.data.model();
        (model.texture("t").unwrap().id(), model.height_field("h").unwrap().id())
    };
    stage
        .data
        .edit_model(|model| {
            for pixel in model.texture_mut(texture).rgb_mut().as_chunks_mut::<3>().0 {
                *pixel = [0, 255, 0];
            }
            model.hfield_data_mut().fill(0.5);
        })
        .unwrap();
    assert_eq!(middle(&stage.rgb()), [255, 0, 0], "the renderer keeps its copy");
    let model = stage.data.model().clone();
    stage.renderer.update_texture(&model, texture).unwrap();
    stage.renderer.update_height_field(&model, field).unwrap();
    assert_eq!(middle(&stage.rgb()), [0, 255, 0]);
    let raised = stage.renderer.depth(&stage.scene).unwrap().metres(16, 16);
    assert!((near - raised - 0.5).abs() < 0.01, "{near} {raised}");
}
