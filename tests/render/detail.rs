//! Samples, levels of detail, and what a renderer keeps from image to image.
#![forbid(unsafe_code)]

use mujoco_safe::render::{Renderer, RendererOptions};
use mujoco_safe::scene::RenderFlags;

use crate::cases::cases;
use crate::stage::{self, Stage};

const SIZE: [usize; 2] = [33, 33];

#[test]
fn an_image_does_not_depend_on_earlier_images() {
    let light = r#"diffuse="0.4 0.4 0.4" cutoff="60""#;
    let xml = format!(
        r#"<mujoco><statistic extent="1" center="0 0 0"/>
           <visual><headlight active="0"/><map znear="0.01" zfar="100"/><quality shadowsize="256"/></visual>
           <worldbody>
             <light directional="true" pos="0 0 3" dir="0 0.3 -1" {light}/><light pos="0 0 3" dir="0 0 -1" {light}/>
             <geom type="plane" size="2 2 0.1"/>
             <body><freejoint/><geom size="0.2"/></body><body><freejoint/><geom type="box" size="0.1 0.2 0.3"/></body>
           </worldbody></mujoco>"#
    );
    let mut stage = Stage::new(&xml, [48, 32]);
    // The ball, then the box; in the last scenes they are below the floor, and their shadow is
    // invisible or absent.
    let places = [
        [[0.0, 0.0, 0.5], [0.5, 0.5, 0.5]],
        [[0.1, 0.0, 1.5], [-0.5, 0.5, 0.7]],
        [[0.0, 0.6, 0.3], [0.5, -0.5, 1.0]],
        [[-0.8, 0.0, 0.5], [0.0, 0.0, 2.0]],
        [[0.0, 0.0, -9.0], [50.0, 0.0, -9.0]],
    ];
    let place = |stage: &mut Stage, index: usize| {
        for (body, pos) in places[index].iter().enumerate() {
            stage.data.qpos_mut()[7 * body..][..3].copy_from_slice(pos);
        }
        stage.data.forward().unwrap();
        stage.look([0.0, 0.0, 0.3], 3.0, 90.0, -40.0);
    };
    let expected: Vec<_> = (0..places.len())
        .map(|index| {
            place(&mut stage, index);
            let options = RendererOptions::default().with_samples(1);
            Renderer::on(stage::gpu(), stage.data.model(), 48, 32, options).unwrap().rgb(&stage.scene).unwrap()
        })
        .collect();
    assert!(expected.iter().enumerate().all(|(index, picture)| !expected[..index].contains(picture)));
    for picture in 0..cases(100, 300) {
        // In a different order in each round.
        let index = picture * (1 + picture / places.len()) % places.len();
        place(&mut stage, index);
        assert_eq!(stage.rgb(), expected[index], "image {picture}");
    }
}

#[test]
fn the_haze_follows_the_camera() {
    let xml = r#"<mujoco><statistic extent="1" center="0 0 0"/>
        <visual><map znear="0.01" zfar="100"/><rgba haze="0.9 0.2 0.1 1"/></visual>
        <asset><texture type="skybox" builtin="flat" rgb1="0.2 0.3 0.4" width="8" height="48"/></asset>
        <worldbody><geom type="plane" size="0 0 1"/><geom size="0.2" pos="0 0 0.5"/></worldbody></mujoco>"#;
    let mut stage = Stage::new(xml, SIZE);
    // The haze is as high as the camera, which must be far above the plane.
    let look = |stage: &mut Stage, index: usize| stage.look([0.0; 3], 20.0 + 4.0 * index as f64, 90.0, -18.0);
    let expected: Vec<_> = (0..3)
        .map(|index| {
            look(&mut stage, index);
            let options = RendererOptions::default().with_samples(1);
            let mut renderer = Renderer::on(stage::gpu(), stage.data.model(), SIZE[0], SIZE[1], options).unwrap();
            renderer.rgb(&stage.scene).unwrap()
        })
        .collect();
    assert!(expected[0] != expected[1] && expected[1] != expected[2]);
    for index in [0, 0, 1, 2, 2, 0, 2, 1] {
        look(&mut stage, index);
        assert_eq!(stage.rgb(), expected[index], "{index}");
        let flags = stage.scene.render_flags();
        stage.scene.set_render_flags(flags - RenderFlags::HAZE);
        assert_ne!(stage.rgb(), expected[index], "{index}: without haze");
        stage.scene.set_render_flags(flags);
    }
}

#[test]
fn each_number_of_samples_smooths_edges() {
    let xml = r#"<mujoco><visual><headlight active="0"/></visual>
        <asset><material name="white" emission="1" specular="0" rgba="1 1 1 1"/></asset>
        <worldbody><geom size="0.4" material="white"/></worldbody></mujoco>"#;
    let colours = |samples| {
        let mut stage = Stage::with(xml, SIZE, RendererOptions::default().with_samples(samples));
        stage.look([0.0; 3], 2.0, 90.0, -90.0);
        let image = stage.rgb();
        // The edge of a white disk on black.
        image.as_bytes().chunks(3).filter(|pixel| (20..=235).contains(&pixel[0])).count()
    };
    let counts = [1, 2, 4, 8].map(colours);
    assert!(counts[1..].iter().all(|&count| count >= counts[0]), "{counts:?}");
    // Every adapter has 4 samples.
    assert!(counts[2] > counts[0] + 10 && counts[3] > counts[0] + 10, "{counts:?}");
}

/// A mesh that is small in the image is drawn with fewer vertices, unless its texture coordinates
/// are seen.
#[test]
fn a_small_mesh_keeps_its_texture() {
    const CELLS: usize = 20;
    let grid = |count: usize| (0..count).flat_map(move |row| (0..count).map(move |column| [column, row]));
    let place = |index: usize| index as f64 / CELLS as f64;
    let texcoords: Vec<[f64; 2]> = grid(CELLS + 1).map(|indices| indices.map(place)).collect();
    let vertices = texcoords.iter().map(|[u, v]| [0.2 * (u * (1.0 - u) + v * (1.0 - v)), u - 0.5, v - 0.5]);
    // Both sides of each cell.
    let faces = grid(CELLS).flat_map(|[column, row]| {
        let [first, next] = [row, row + 1].map(|row| row * (CELLS + 1) + column);
        [[first, first + 1, next + 1], [first, next + 1, next], [next + 1, first + 1, first], [next, next + 1, first]]
    });
    let [vertices, texcoords, faces] = [
        vertices.flatten().map(|number| number.to_string()).collect::<Vec<_>>().join(" "),
        texcoords.iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(" "),
        faces.flatten().map(|index| index.to_string()).collect::<Vec<_>>().join(" "),
    ];
    let xml = format!(
        r#"<mujoco><statistic extent="1" center="0 0 0"/><visual><headlight active="0"/><map znear="0.01" zfar="100"/></visual>
           <asset><mesh name="dome" vertex="{vertices}" texcoord="{texcoords}" face="{faces}"/>
             <texture name="fields" type="2d" builtin="checker" width="64" height="64" rgb1="1 0 0" rgb2="0 0 1"/>
             <material name="checked" texture="fields" emission="1"/></asset>
           <worldbody><geom type="mesh" mesh="dome" material="checked"/></worldbody></mujoco>"#
    );
    let mut stage = Stage::new(&xml, SIZE);
    stage.look([0.0; 3], 4.0, 180.0, 0.0);
    let image = stage.rgb();
    let count = |colour: [u8; 3]| image.as_bytes().chunks(3).filter(|pixel| **pixel == colour).count();
    let [red, blue] = [[255, 0, 0], [0, 0, 255]].map(count);
    // Two fields of each colour.
    assert!(red > 12 && blue > 12 && red.abs_diff(blue) < red / 3, "{red} red, {blue} blue");
}
