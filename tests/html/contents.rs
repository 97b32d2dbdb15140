//! Geoms, meshes, height fields, textures and cameras of a page.

use mujoco_safe::html::HtmlOptions;
use mujoco_safe::{Data, Model, Trajectory, sample};
use serde_json::Value;

use crate::page::{Page, saved};

/// A page of the initial state.
fn page(model: &Model) -> Page {
    page_with(model, &HtmlOptions::default())
}

fn page_with(model: &Model, options: &HtmlOptions) -> Page {
    let mut trajectory = Trajectory::new(model);
    trajectory.push(&Data::new(model.clone()).unwrap()).unwrap();
    saved(model, &[("", &trajectory)], options)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Geoms of all shapes, with all kinds of textures.
pub const SHAPES: &str = "<mujoco>
  <asset>
    <mesh name='prism' vertex='0 0 0  .4 0 0  0 .3 0  0 0 .2' face='0 2 1  0 1 3  0 3 2  1 2 3'
      texcoord='0 0  1 0  0 1  .25 .75'/>
    <mesh name='unused' vertex='0 0 0  1 0 0  0 1 0  0 0 1'/>
    <hfield name='hill' nrow='3' ncol='4' size='1 2 .5 .1'/>
    <texture name='checker' type='2d' builtin='checker' rgb1='1 0 0' rgb2='0 0 1' width='16' height='8'/>
    <texture name='cube' type='cube' builtin='gradient' rgb1='1 1 1' rgb2='0 0 0' width='4' height='24'/>
    <texture name='sky' type='skybox' builtin='gradient' rgb1='0 0 1' rgb2='1 1 1' width='4' height='24'/>
    <material name='checked' texture='checker' texrepeat='2 3' specular='.25' shininess='.75' emission='.1' rgba='.5 1 1 1'/>
    <material name='cubed' texture='cube'/>
  </asset>
  <worldbody>
    <light pos='2 -4 6' dir='0 .5 -1'/>
    <geom name='plane' type='plane' size='0 0 1' material='checked'/>
    <geom name='hill' type='hfield' hfield='hill'/>
    <body name='all' pos='0 0 1'>
      <geom name='sphere' size='.1'/>
      <geom name='box' type='box' size='.1 .2 .3' pos='1 0 0' euler='0 0 90' material='cubed'/>
      <geom name='capsule' type='capsule' size='.1 .2' pos='2 0 0'/>
      <geom name='cylinder' type='cylinder' size='.1 .2' pos='3 0 0'/>
      <geom name='ellipsoid' type='ellipsoid' size='.1 .2 .3' pos='4 0 0' rgba='.1 .2 .3 .4'/>
      <geom name='prism' type='mesh' mesh='prism' pos='5 0 0' euler='0 0 30' material='checked'/>
      <geom name='hidden' size='.1' group='3'/>
      <geom name='invisible' size='.1' rgba='0 0 0 0'/>
      <site name='site' size='.05' pos='6 0 0'/>
      <camera name='front' pos='2.5 -7 2' xyaxes='1 0 0 0 .25 1' fovy='40'/>
    </body>
  </worldbody></mujoco>";

#[test]
fn geoms_have_the_shapes_places_and_colours_of_the_model() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let page = page(&model);
    assert!(page.left_out.is_empty(), "{:?}", page.left_out);
    let look = &page.description["look"];
    let geoms = look["geoms"].as_array().unwrap();
    let find = |name: &str| geoms.iter().find(|geom| geom["name"] == name);
    let names: Vec<&str> = geoms.iter().map(|geom| geom["name"].as_str().unwrap()).collect();
    for (name, shape) in [
        ("plane", "plane"),
        ("hill", "heightfield"),
        ("sphere", "ellipsoid"),
        ("box", "box"),
        ("capsule", "capsule"),
        ("cylinder", "cylinder"),
        ("ellipsoid", "ellipsoid"),
        ("prism", "mesh"),
        ("site", "ellipsoid"),
    ] {
        assert_eq!(find(name).unwrap_or_else(|| panic!("{name} of {names:?}"))["shape"], shape);
    }
    assert_eq!(geoms.len(), 9, "{names:?}");
    assert_eq!(find("site").unwrap()["element"], "site");
    for geom in geoms.iter().filter(|geom| geom["element"] == "geom") {
        let id = model.geom(geom["name"].as_str().unwrap()).unwrap().id().index();
        assert_eq!(numbers(&geom["pos"]), model.geom_pos()[id]);
        assert_eq!(numbers(&geom["quat"]), model.geom_quat()[id]);
        assert_eq!(geom["frame"].as_i64().unwrap(), i64::from(model.geom_bodyid()[id]));
    }
    let close = |value: &Value, expected: &[f64]| {
        let found = numbers(value);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
    };
    close(&find("box").unwrap()["size"], &[0.1, 0.2, 0.3]);
    close(&find("ellipsoid").unwrap()["rgba"], &[0.1, 0.2, 0.3, 0.4]);
    let plane = find("plane").unwrap();
    close(&plane["rgba"], &[0.5, 1.0, 1.0, 1.0]);
    let shading = ["emission", "specular", "shininess"].map(|name| plane[name].as_f64().unwrap() as f32);
    assert_eq!(shading, [0.1, 0.25, 0.75]);
    assert!(
        (look["cameras"][0]["view"]["frustum_top"].as_f64().unwrap()
            / look["cameras"][0]["view"]["frustum_near"].as_f64().unwrap()
            - 20_f64.to_radians().tan())
        .abs()
            < 1e-6
    );
}

#[test]
fn groups_select_geoms_and_sites() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let options =
        HtmlOptions::default().with_geomgroup([false, false, false, true, false, false]).with_sitegroup([false; 6]);
    let page = page_with(&model, &options);
    let geoms = page.description["look"]["geoms"].as_array().unwrap();
    assert_eq!(geoms.iter().map(|geom| geom["name"].as_str().unwrap()).collect::<Vec<_>>(), ["hidden"]);
    assert!(page.description["look"]["meshes"].as_object().unwrap().is_empty(), "only used meshes are contained");
}

#[test]
fn meshes_and_height_fields_are_rounded_to_a_fraction_of_their_extent() {
    let mut model = Model::from_xml_str(SHAPES).unwrap();
    for (index, elevation) in model.edit().height_field_mut("hill").unwrap().data_mut().iter_mut().enumerate() {
        *elevation = (index as f32).sin().abs();
    }
    let page = page(&model);
    let value = |interval: &Value, number: i64| {
        interval["low"].as_f64().unwrap() + interval["step"].as_f64().unwrap() * number as f64
    };
    let meshes = page.description["look"]["meshes"].as_object().unwrap();
    assert_eq!(meshes.len(), 1, "the unused mesh is left out");
    let (view, mesh) = (model.mesh("prism").unwrap(), meshes.values().next().unwrap());
    let positions = &mesh["positions"];
    let axes = page.channels(&positions["vectors"], view.vert().len(), 1);
    for (axis, channel) in axes.iter().enumerate() {
        for (vertex, &number) in channel.iter().enumerate() {
            let error = value(&positions["intervals"][axis], number) - f64::from(view.vert()[vertex][axis]);
            assert!(error.abs() <= 0.4 / 131_000.0, "{error}");
        }
    }
    let faces: Vec<i64> = view.face().as_flattened().iter().map(|&corner| corner.into()).collect();
    assert_eq!(page.channels(&positions["faces"], faces.len(), 1), [faces]);
    let coordinates = page.channels(&mesh["texcoords"]["vectors"], view.texcoord().len(), 1);
    for (vertex, texcoord) in view.texcoord().iter().enumerate() {
        for axis in 0..2 {
            let found = value(&mesh["texcoords"]["intervals"][axis], coordinates[axis][vertex]);
            assert!((found - f64::from(texcoord[axis])).abs() <= 1.0 / 131_000.0);
        }
    }
    let field = page.description["look"]["height_fields"].as_object().unwrap().values().next().unwrap();
    let elevations = &page.channels(&field["elevations"], 12, 1)[0];
    for (&number, &elevation) in elevations.iter().zip(model.height_field("hill").unwrap().data()) {
        assert!((value(&field["interval"], number) - f64::from(elevation)).abs() <= 1.0 / 131_000.0);
    }
    assert_eq!(numbers(&field["size"]), [1.0, 2.0, 0.5, 0.1]);
}

#[test]
fn textures_are_png_files_with_the_pixels_of_the_model() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let page = page(&model);
    let look = &page.description["look"];
    for texture in model.textures() {
        let found = &look["textures"][texture.id().index().to_string()];
        let mut reader = png::Decoder::new(std::io::Cursor::new(page.part(&found["png"]))).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!([info.width as usize, info.height as usize], [texture.width(), texture.height()]);
        assert_eq!(pixels, texture.rgb());
        assert_eq!(found["cube"], texture.name() != Some("checker"));
    }
    assert_eq!(look["sky"].as_u64().unwrap() as usize, model.texture("sky").unwrap().id().index());
}

#[test]
fn the_humanoid_is_drawn_completely() {
    let page = page(&sample::humanoid());
    assert!(page.left_out.is_empty(), "{:?}", page.left_out);
    assert_eq!(page.description["look"]["left_out"], serde_json::json!([]));
}

#[test]
fn elements_that_are_not_drawn_are_named() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><site name='a'/><body pos='0 0 1'><geom size='.1'/></body></worldbody>
           <sensor><rangefinder site='a'/></sensor></mujoco>",
    )
    .unwrap();
    let page = page(&model);
    // Not all engines tell of which element a decoration is.
    assert!(matches!(&page.left_out[..], [line] if line.contains("Line")), "{:?}", page.left_out);
    assert_eq!(page.description["look"]["left_out"], serde_json::json!(page.left_out));
}
