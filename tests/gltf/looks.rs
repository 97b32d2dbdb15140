//! Materials, textures, cameras, lights and names.

use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;
use gltf::material::AlphaMode;
use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::{Model, sample};

use crate::file::{File, SHAPES, recorded, saved, still};

fn assert_close(found: &[f32], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-5), "{found:?} {expected:?}");
}

/// A colour of the screen as a linear one, by the definition of sRGB.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn material<'f>(file: &'f File, name: &str) -> gltf::Material<'f> {
    file.shown(name).mesh().unwrap().primitives().next().unwrap().material()
}

#[test]
fn materials_have_the_colours_of_the_model() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let file = still(&model);
    let glass = material(&file, "ellipsoid");
    assert_eq!(glass.alpha_mode(), AlphaMode::Blend);
    let [r, g, b] = [0.1, 0.2, 0.3].map(linear);
    assert_close(&glass.pbr_metallic_roughness().base_color_factor(), &[r, g, b, 0.4]);
    let checked = material(&file, "plane");
    assert_eq!((checked.name(), checked.alpha_mode()), (Some("checked"), AlphaMode::Opaque));
    assert_close(&checked.emissive_factor(), &[linear(0.05), linear(0.1), linear(0.1)]);
    let surface = checked.pbr_metallic_roughness();
    // An exponent of 0.75 * 128.
    assert_close(&[surface.metallic_factor(), surface.roughness_factor()], &[0.0, (2.0_f64 / 98.0).powf(0.25)]);
    assert_close(&surface.base_color_factor(), &[linear(0.5), 1.0, 1.0, 1.0]);
    // The mean colour of the cube texture, of which each pixel is (255, 127, 0) or (255, 128, 0).
    let cubed = material(&file, "box").pbr_metallic_roughness();
    let color = cubed.base_color_factor();
    assert_close(&[color[0], color[2], color[3], cubed.roughness_factor()], &[linear(0.5), 0.0, 1.0, 1.0]);
    assert!((f64::from(color[1]) - linear(0.5)).abs() < 5e-3, "{color:?}");
    assert_eq!(file.left_out, ["the pattern of the cube texture cube", "the sky"]);
}

#[test]
#[cfg(engine_since = "3.2.0")]
fn materials_have_the_metallic_and_roughness_of_the_model() {
    let model = Model::from_xml_str(
        "<mujoco><asset><material name='steel' metallic='.75' roughness='.25'/></asset>
           <worldbody><geom name='ball' size='.1' material='steel'/></worldbody></mujoco>",
    )
    .unwrap();
    let file = still(&model);
    let surface = material(&file, "ball").pbr_metallic_roughness();
    assert_close(&[surface.metallic_factor(), surface.roughness_factor()], &[0.75, 0.25]);
}

#[test]
fn textures_have_the_pixels_and_coordinates_of_the_model() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let file = still(&model);
    assert_eq!(file.gltf.images().len(), 1);
    let image = file.gltf.images().next().unwrap();
    let gltf::image::Source::View { view, mime_type: "image/png" } = image.source() else { panic!("a PNG file") };
    let mut reader = png::Decoder::new(std::io::Cursor::new(file.view(&view))).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!([info.width, info.height], [16, 8]);
    assert_eq!(pixels, model.texture("checker").unwrap().rgb());
    // Without repetition before 3.12, which repeats texture coordinates.
    let repeat = if cfg!(engine_since = "3.12.0") { [2.0, 3.0] } else { [1.0, 1.0] };
    let mesh = model.mesh("prism").unwrap();
    let triangles = file.triangles(&file.shown("prism"));
    for (corners, (face, coordinates)) in triangles.indices.iter().zip(mesh.face().iter().zip(mesh.facetexcoord())) {
        for corner in 0..3 {
            assert_eq!(triangles.positions[corners[corner]], mesh.vert()[face[corner] as usize]);
            let [u, v] = mesh.texcoord()[coordinates[corner] as usize];
            assert_eq!(triangles.texcoords[corners[corner]], [u * repeat[0], v * repeat[1]]);
        }
    }
    // A texture on an infinite plane repeats every metre for each repetition, in x and y.
    let plane = file.triangles(&file.shown("plane"));
    let (a, b) = (plane.positions[0], plane.positions[3]);
    let per_metre = [0, 1].map(|axis| (plane.texcoords[3][axis] - plane.texcoords[0][axis]) / (b[axis] - a[axis]));
    assert_close(&per_metre.map(f32::abs), &[1.0, 1.5]);
}

#[test]
fn cameras_and_lights_are_those_of_the_model() {
    let file = still(&Model::from_xml_str(SHAPES).unwrap());
    let camera = file.gltf.cameras().find(|camera| camera.name() == Some("front")).unwrap();
    let Projection::Perspective(perspective) = camera.projection() else { panic!("a perspective") };
    assert_close(&[perspective.yfov()], &[40_f64.to_radians()]);
    assert_eq!(file.gltf.cameras().len(), 3);
    let lights: Vec<_> = file.gltf.lights().unwrap().collect();
    assert_eq!(lights.iter().map(|light| light.name().unwrap()).collect::<Vec<_>>(), ["headlight", "spot", "sun"]);
    assert!(matches!(lights[2].kind(), Kind::Directional));
    assert_close(&[lights[2].intensity()], &[std::f64::consts::PI]);
    let Kind::Spot { outer_cone_angle, .. } = lights[1].kind() else { panic!("a spot") };
    assert_close(&[outer_cone_angle], &[30_f64.to_radians()]);
    assert_close(&lights[1].color(), &[0.5, 0.5, 1.0]);
}

#[test]
fn elements_that_are_left_out_are_named() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><site name='a' pos='0 0 2'/>
           <body><joint type='slide' axis='0 0 1'/><geom size='.1'/><site name='b'/></body></worldbody>
           <tendon><spatial name='rope'><site site='a'/><site site='b'/></spatial></tendon></mujoco>",
    )
    .unwrap();
    assert_eq!(still(&model).left_out, ["tendon rope"]);
    let nothing_left_out = still(&sample::cartpole()).left_out;
    assert!(nothing_left_out.iter().all(|text| !text.contains("geom")), "{nothing_left_out:?}");
}

#[test]
fn names_are_data() {
    let hostile = ["</script>", "\"},{", "\\\u{1}", "é€\u{1f980}"];
    let names = hostile.map(|name| name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;"));
    let body = |name: &str| format!("<body name=\"{name}\"><geom name=\"{name}\" size='.1'/></body>");
    // XML has no control characters.
    let bodies: String = names.iter().filter(|name| !name.contains('\u{1}')).map(|name| body(name)).collect();
    let model = Model::from_xml_str(&format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>")).unwrap();
    let file = still(&model);
    for name in hostile.iter().filter(|name| !name.contains('\u{1}')) {
        file.shown(name);
        assert!(file.gltf.nodes().any(|node| node.mesh().is_none() && node.name() == Some(name)));
    }
}

#[test]
fn equal_trajectories_have_equal_files() {
    let model = sample::humanoid();
    let [a, b] = [(); 2].map(|()| saved(&model, &[("", &recorded(&model, 1, 50))], &GltfOptions::default()));
    assert_eq!(a.bytes, b.bytes);
}
