//! Vertices of skins and flexes, computed from the file, equal those of the engine.

use std::fmt::Write;

use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::nalgebra::Point3;
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
use mujoco_safe::{Data, Model};

use crate::file::{File, recorded, saved, still};

/// A chain of six bodies in a tube with a texture. Four vertices follow all bodies, and two bones
/// have the same body.
pub fn arm() -> Model {
    let (mut bodies, mut vertices, mut texcoords, mut faces) =
        (String::new(), String::new(), String::new(), String::new());
    for ring in 0..7 {
        for (corner, [y, z]) in [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]].into_iter().enumerate() {
            write!(vertices, "{} {y} {z} ", 0.15 * f64::from(ring)).unwrap();
            write!(texcoords, "{} {} ", 0.5 * f64::from(ring), 0.25 * corner as f64).unwrap();
            if ring < 6 {
                let [a, b] = [corner, (corner + 1) % 4].map(|corner| 4 * ring as usize + corner);
                write!(faces, "{a} {b} {d} {a} {d} {c} ", c = a + 4, d = b + 4).unwrap();
            }
        }
    }
    let of_all = [0.05, 0.1, 0.35, 0.35, 0.1, 0.05];
    let mut bones = String::new();
    for body in 0..6 {
        let angle = f64::to_radians(5.0 * f64::from(body + 1));
        write!(
            bodies,
            "<body name='b{body}' pos='{x} 0 0' euler='10 0 0'><joint axis='0 1 0' damping='.01'/><joint axis='0 0 1' damping='.01'/>
               <geom size='.03' pos='.075 0 0'/>",
            x = if body == 0 { 0.0 } else { 0.15 }
        )
        .unwrap();
        let (mut ids, mut weights) = (String::new(), String::new());
        for ring in 0..7 {
            let is_end = ring == 0 && body == 0 || ring == 6 && body == 5;
            let weight = match ring {
                3 => of_all[body as usize],
                _ if is_end => 1.0,
                _ if ring == body || ring == body + 1 => 0.5,
                _ => continue,
            };
            for corner in 0..4 {
                write!(ids, "{} ", 4 * ring + corner).unwrap();
                // The first body has two bones.
                write!(weights, "{} ", if body == 0 { 0.5 * weight } else { weight }).unwrap();
            }
        }
        for shift in if body == 0 { &[0.0, 0.01][..] } else { &[0.0] } {
            write!(
                bones,
                "<bone body='b{body}' bindpos='{x} 0 {shift}' bindquat='{w} {sine} 0 0' vertid='{ids}' vertweight='{weights}'/>",
                x = 0.15 * f64::from(body),
                w = angle.cos(),
                sine = angle.sin(),
            )
            .unwrap();
        }
    }
    Model::from_xml_str(&format!(
        "<mujoco><statistic extent='1' center='.4 0 0'/>
           <asset><texture name='checker' type='2d' builtin='checker' rgb1='1 .6 .1' rgb2='.1 .2 .9' width='16' height='16'/>
             <material name='checked' texture='checker'/>
             <skin name='arm' material='checked' vertex='{vertices}' texcoord='{texcoords}' face='{faces}'>{bones}</skin></asset>
           <worldbody><light pos='.4 -2 3' dir='0 .5 -1' castshadow='false'/>
             <camera name='front' pos='.4 -1.6 -.1' xyaxes='1 0 0 0 .1 1'/>
             <geom type='plane' size='2 2 .1' pos='0 0 -1.1' rgba='.7 .7 .7 1'/>{bodies}{ends}</worldbody></mujoco>",
        ends = "</body>".repeat(6)
    ))
    .unwrap()
}

/// Vertices of the skin in the state of the data, by the engine.
fn of_engine(data: &mut Data) -> Vec<Point3<f64>> {
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let (options, mut camera) = (SceneOptions::default(), Camera::free(data.model()));
    scene.update(data, &options, None, &mut camera, Categories::all()).unwrap();
    let skin = scene.skins().next().unwrap();
    skin.vertices.iter().map(|vertex| Point3::from(vertex.map(f64::from))).collect()
}

/// Compares vertices in all records, and returns the file.
fn check(model: &Model, name: &str, tolerance: f64, of_engine: impl Fn(&mut Data) -> Vec<Point3<f64>>) -> File {
    let trajectory = recorded(model, 1, 80);
    let options = GltfOptions::default().with_rotation_error(1e-6).with_frames_per_second(f64::INFINITY);
    let file = saved(model, &[("", &trajectory)], &options);
    let mut data = Data::new(model.clone()).unwrap();
    let (mut moved, mut first) = (0.0_f64, Vec::new());
    for record in 0..trajectory.len() {
        trajectory.apply(record, &mut data).unwrap();
        data.forward().unwrap();
        let expected = of_engine(&mut data);
        first = if record == 0 { expected.clone() } else { first };
        let keys = if record == 0 { [Some((0, 0)), None] } else { [Some((0, record)); 2] };
        for key in keys {
            let found = file.skinned(name, key);
            assert_eq!(found.len(), expected.len());
            for (vertex, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let error = (found - expected).norm();
                assert!(error <= tolerance, "record {record}, vertex {vertex}: {error}");
            }
        }
        moved = expected.iter().zip(&first).map(|(now, start)| (now - start).norm()).fold(moved, f64::max);
    }
    assert!(moved > 0.01, "the vertices move: {moved}");
    file
}

#[test]
fn vertices_of_skins_are_those_of_the_engine() {
    let model = arm();
    // Single precision, in a chain of six bodies.
    let file = check(&model, "arm", 3e-6, of_engine);
    assert!(file.left_out.is_empty(), "{:?}", file.left_out);
    let node = file.shown("arm");
    let triangles = file.triangles(&node);
    let skin = model.skins().next().unwrap();
    assert_eq!(triangles.texcoords, skin.texcoord());
    let faces: Vec<_> = skin.face().iter().map(|face| face.map(|corner| corner as usize)).collect();
    assert_eq!(triangles.indices, faces);
    let material = node.mesh().unwrap().primitives().next().unwrap().material();
    assert_eq!((material.name(), material.double_sided()), (Some("checked"), false));
    assert!(material.pbr_metallic_roughness().base_color_texture().is_some());
    // The axis of the tube is x, and its normals point away from it.
    for (position, normal) in triangles.positions.iter().zip(&triangles.normals) {
        let dot: f32 = (1..3).map(|axis| 20.0 * position[axis] * normal[axis]).sum();
        assert!(dot > 1.2, "{position:?} {normal:?}");
    }
    // The first weights are the largest, for programs that read four.
    let primitive = node.mesh().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| file.gltf.blob.as_deref());
    let mut weights = reader.read_weights(0).unwrap().into_f32();
    let mut of_middle = weights.nth(13).unwrap();
    of_middle.sort_by(f32::total_cmp);
    assert!(of_middle.iter().zip([0.1, 0.1, 0.35, 0.35]).all(|(a, b)| (a - b).abs() < 1e-6), "{of_middle:?}");
    assert!(reader.read_weights(1).is_some() && reader.read_weights(2).is_none());
}

#[test]
fn an_inflated_skin_of_one_body_is_exact() {
    let model = Model::from_xml_str(
        "<mujoco><asset><skin name='tent' inflate='.03' vertex='0 0 0  1 0 0  0 1 0  .2 .2 .7' face='0 1 3 1 2 3 2 0 3'>
             <bone body='b' bindpos='.1 .2 .3' bindquat='.6 .8 0 0' vertid='0 1 2 3' vertweight='3 1 1 1'/></skin></asset>
           <worldbody><body name='b' pos='0 0 1'><freejoint/><geom type='box' size='.1 .2 .3' pos='.1 .1 .1'/></body></worldbody></mujoco>",
    )
    .unwrap();
    let mut model = model;
    model.edit().body_ipos_mut()[1] = [0.3, 0.0, 0.0];
    check(&model, "tent", 2e-6, of_engine);
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers have other composites")]
fn cloth_has_the_vertices_of_the_engine() {
    let cloth = |skin: &str| {
        Model::from_xml_str(&format!(
            "<mujoco><worldbody><body name='B2_1' pos='0 0 1'><freejoint/>
               <composite type='cloth' count='5 4 1' spacing='.1'><geom type='sphere' size='.02'/>{skin}</composite></body>
               <geom type='box' size='.1 .05 .1' pos='0 0 .85'/></worldbody></mujoco>"
        ))
        .unwrap()
    };
    let name = "skin 0";
    let model = cloth("<skin texcoord='true'/>");
    let name = model.skins().next().unwrap().name().unwrap_or(name);
    assert!(check(&model, name, 3e-6, of_engine).left_out.is_empty());
    // Interpolated vertices have negative weights, which glTF does not have: up to an eighth.
    let file = check(&cloth("<skin subgrid='2'/>"), name, 0.02, of_engine);
    assert!(file.left_out.len() == 1 && file.left_out[0].contains("weights of a vertex"), "{:?}", file.left_out);
}

#[test]
fn a_hidden_skin_is_not_contained() {
    let hidden = "<mujoco><asset><skin name='s' group='4' vertex='0 0 1  1 0 1  0 1 1' face='0 1 2'>
        <bone body='world' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/></skin></asset></mujoco>";
    for (xml, count) in [(hidden.to_owned(), 0), (hidden.replace("group='4'", ""), 1)] {
        let file = still(&Model::from_xml_str(&xml).unwrap());
        assert_eq!((file.gltf.meshes().len(), &file.left_out[..]), (count, &[][..]));
    }
}

#[test]
fn a_skin_that_no_bones_describe_is_left_out_with_the_reason() {
    let reason = |change: &dyn Fn(&mut Model)| {
        let mut model = arm();
        change(&mut model);
        let file = still(&model);
        assert_eq!(file.gltf.skins().len(), usize::from(file.left_out.is_empty()));
        file.left_out.concat()
    };
    for value in [f32::NAN, f32::INFINITY] {
        assert!(reason(&|model| model.edit().skin_vert_mut()[3][1] = value).contains("not finite"));
        assert!(reason(&|model| model.edit().skin_bonebindpos_mut()[2][1] = value).contains("not finite"));
        assert!(reason(&|model| model.edit().skin_bonebindquat_mut()[2][1] = value).contains("not finite"));
        assert!(reason(&|model| model.edit().skin_inflate_mut()[0] = value).contains("not finite"));
        assert!(reason(&|model| model.edit().skin_bonevertweight_mut()[0] = value).contains("weights of vertex 0"));
    }
    assert!(reason(&|model| model.edit().skin_bonebindquat_mut()[2] = [f32::MAX; 4]).contains("not finite"));
    assert_eq!(reason(&|model| model.edit().skin_vert_mut()[3] = [f32::MAX; 3]), "");
    // A vertex without a bone.
    let without = reason(&|model| model.edit().skin_bonevertweight_mut().fill(0.0));
    assert_eq!(without, "skin arm: weights of vertex 0 with the sum 0 instead of 1");
}

/// Sheets, a soft body and a rope.
#[cfg(engine_since = "3.0.0")]
pub const FLEX: &str = "<mujoco><statistic extent='1' center='0 0 .8'/>
  <asset><texture name='checker' type='2d' builtin='checker' rgb1='1 .6 .1' rgb2='.1 .2 .9' width='16' height='16'/>
    <material name='checked' texture='checker'/></asset>
  <worldbody><light pos='.4 -2 3' dir='0 .5 -1' castshadow='false'/>
    <camera name='front' pos='.1 -1.6 1' xyaxes='1 0 0 0 .2 1'/>
    <geom type='plane' size='2 2 .1'/><geom size='.1' pos='-.4 0 .7'/>
    <body name='a' pos='-.4 0 1'><flexcomp name='sheet' type='grid' count='5 4 1' dim='2' spacing='.1 .1 .1' radius='.005' mass='1'
        material='checked'><edge equality='true'/></flexcomp></body>
    <body name='b' pos='.2 0 1'><flexcomp name='block' type='grid' count='3 3 3' dim='3' spacing='.1 .1 .1' radius='.005'
        mass='1' rgba='.2 .8 .3 1'><edge equality='true'/></flexcomp></body>
    <body name='c' pos='.6 0 1'><freejoint/><geom size='.02' pos='.1 0 .1'/>
      <flexcomp name='board' type='grid' count='3 3 1' dim='2' spacing='.1 .1 .1' radius='.005'
        mass='1' rigid='true'><contact selfcollide='none'/></flexcomp></body>
    <body name='d' pos='0 0 2'><flexcomp name='rope' type='grid' count='5 1 1' dim='1' spacing='.1 .1 .1' radius='.01' mass='1'>
        <edge equality='true'/></flexcomp></body>
  </worldbody></mujoco>";

#[test]
#[cfg(engine_since = "3.0.0")]
fn vertices_of_flexes_are_those_of_the_engine() {
    let model = Model::from_xml_str(FLEX).unwrap();
    for (flex, corners) in [(0, model.flex_elem()), (1, model.flex_shell()), (2, model.flex_elem())] {
        let start = match flex {
            1 => model.flex_shelldataadr()[flex],
            _ => model.flex_elemdataadr()[flex],
        } as usize;
        let count = if flex == 1 { model.flex_shellnum()[flex] } else { model.flex_elemnum()[flex] } as usize;
        let corners: Vec<usize> = corners[start..start + 3 * count].iter().map(|&corner| corner as usize).collect();
        let first = model.flex_vertadr()[flex] as usize;
        // Vertices in the file have the order of the corners of the triangles.
        let mut order = Vec::new();
        for &corner in &corners {
            if !order.contains(&corner) {
                order.push(corner);
            }
        }
        let file = check(&model, &format!("flex {flex}"), 5e-6, |data| {
            order.iter().map(|&vertex| Point3::from(data.flexvert_xpos()[first + vertex])).collect()
        });
        assert_eq!(file.left_out, ["flex 3: a rope, which has no triangles"]);
        let node = file.shown(&format!("flex {flex}"));
        let triangles = file.triangles(&node);
        let found: Vec<usize> = triangles.indices.as_flattened().iter().map(|&at| order[at]).collect();
        assert_eq!(found, corners);
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        assert_eq!(primitive.material().double_sided(), flex != 1);
        assert_eq!(triangles.texcoords.is_empty(), flex != 0);
        if flex == 0 {
            let start = model.flex_texcoordadr()[0] as usize;
            for (found, &vertex) in triangles.texcoords.iter().zip(&order) {
                assert_eq!(*found, model.flex_texcoord()[start + vertex]);
            }
        }
    }
}

#[test]
#[cfg(engine_since = "3.5.0")]
fn an_interpolated_flex_is_left_out_with_the_reason() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><body name='a' pos='0 0 1'><flexcomp name='soft' type='grid' count='4 4 4' dim='3' spacing='.1 .1 .1'
           radius='.01' mass='1' dof='trilinear'><contact selfcollide='none'/></flexcomp></body></worldbody></mujoco>",
    )
    .unwrap();
    assert_eq!(still(&model).left_out, ["flex 0: vertices that are interpolated between bodies"]);
}
