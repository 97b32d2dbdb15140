//! Scenes of the rows that `pictures/linked.py` writes.

#![forbid(unsafe_code)]

use std::path::Path;

use mujoco_safe::scene::{
    Camera, CameraView, Categories, Connector, FrameMode, LabelMode, NewGeom, Perturbation, PerturbationFlags,
    RenderFlags, Scene, SceneOptions, Transform, VisualFlags,
};
use mujoco_safe::{Data, Model};
use serde_json::Value;

/// Returns the state and the scene of a row.
pub fn drawn(folder: &Path, row: &Value) -> (Data, Scene) {
    let name = text_of(row, "name");
    let file = folder.join(format!("{name}.xml"));
    let model = if file.exists() { Model::from_xml_path(file) } else { Model::from_xml_str(text_of(row, "xml")) };
    let mut data = Data::new(model.unwrap()).unwrap();
    if name.starts_with("sleeping") {
        for _ in 0..row["steps"].as_u64().unwrap() {
            data.step().unwrap();
        }
    } else {
        data.qpos_mut().copy_from_slice(&numbers(&row["qpos"]));
        data.qvel_mut().copy_from_slice(&numbers(&row["qvel"]));
        data.act_mut().copy_from_slice(&numbers(&row["act"]));
        if let Some(ctrl) = row.get("ctrl") {
            data.ctrl_mut().copy_from_slice(&numbers(ctrl));
        }
    }
    data.forward().unwrap();
    let mut options = SceneOptions::default();
    for (key, value) in [("visual", true), ("no_visual", false)] {
        for flag in names(row, key) {
            match VisualFlags::from_name(flag) {
                Some(flag) => options.flags.set(flag, value),
                None => println!("{name}: no visual flag {flag}"),
            }
        }
    }
    options.flex_layer = row["flex_layer"].as_u64().unwrap() as u32;
    options.bvh_depth = row["bvh_depth"].as_u64().unwrap() as u32;
    options.label = LABELS.iter().find(|(name, _)| *name == text_of(row, "label")).unwrap().1;
    options.frame = FRAMES.iter().find(|(name, _)| *name == text_of(row, "frame")).unwrap().1;
    for (kind, shown) in row.get("groups").and_then(Value::as_object).into_iter().flatten() {
        let shown: Vec<bool> = numbers(shown).iter().map(|&number| number != 0.0).collect();
        let groups = if kind == "geomgroup" { &mut options.geomgroup } else { &mut options.sitegroup };
        groups.copy_from_slice(&shown);
    }
    let perturbation = row.get("perturb").map(|pulled| perturbation(&data, pulled));
    let mut camera = camera(data.model(), row);
    let mut scene = Scene::new(data.model(), 20_000).unwrap();
    let mut flags = scene.render_flags();
    for (key, value) in [("render", true), ("no_render", false)] {
        for flag in names(row, key) {
            match RenderFlags::from_name(flag) {
                Some(flag) => flags.set(flag, value),
                None => println!("{name}: no render flag {flag}"),
            }
        }
    }
    scene.set_render_flags(flags);
    let categories = row
        .get("categories")
        .map_or(Categories::all(), |categories| Categories::from_bits_truncate(categories.as_u64().unwrap() as u32));
    for _ in 0..2 {
        scene.update(&mut data, &options, perturbation.as_ref(), &mut camera, categories).unwrap();
    }
    if let Some(transform) = row.get("transform") {
        let scale = transform["scale"].as_f64().unwrap() as f32;
        let (translate, rotate) = (array(&transform["translate"]), array(&transform["rotate"]));
        let transform = Transform { translate: single(translate), rotate: single(rotate), scale };
        scene.set_transform(Some(transform)).unwrap();
    }
    for geom in row.get("decor").and_then(Value::as_array).into_iter().flatten() {
        scene.add_geom(&new_geom(data.model(), geom)).unwrap();
    }
    (data, scene)
}

/// Returns the width and the height of the image of a scene.
pub fn size_of(row: &Value) -> [usize; 2] {
    array(&row["size"]).map(|length| length as usize)
}

fn camera(model: &Model, row: &Value) -> Camera {
    if let Some(camera) = row["camera"].as_str() {
        return Camera::fixed(model, camera).unwrap();
    }
    if row.get("default").is_some() {
        return Camera::free(model);
    }
    let body = row.get("track").map(|body| model.body(body.as_str().unwrap()).unwrap().id());
    Camera {
        view: body.map_or(CameraView::Free, CameraView::Tracking),
        lookat: array(&row["lookat"]),
        distance: row["distance"].as_f64().unwrap(),
        azimuth: row["azimuth"].as_f64().unwrap(),
        elevation: row["elevation"].as_f64().unwrap(),
    }
}

fn perturbation(data: &Data, pulled: &Value) -> Perturbation {
    let body = data.model().body(text_of(pulled, "body")).unwrap().id();
    let [x, y, z] = data.xipos()[body.index()];
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(body);
    perturbation.active = PerturbationFlags::from_bits_truncate(pulled["active"].as_u64().unwrap() as u32);
    (perturbation.refpos, perturbation.refquat) = ([x + 0.2, y + 0.1, z + 0.3], [0.8, 0.6, 0.0, 0.0]);
    perturbation.localpos = [0.05, 0.0, 0.05];
    perturbation
}

fn new_geom(model: &Model, geom: &Value) -> NewGeom {
    let size = numbers(&geom["size"]);
    let connector = |shape| NewGeom::connector(shape, size[0], array(&geom["from"]), array(&geom["to"]));
    let is_line = geom.get("from").is_some();
    let new = match text_of(geom, "kind") {
        "CAPSULE" if is_line => connector(Connector::Capsule),
        "CYLINDER" if is_line => connector(Connector::Cylinder),
        "ARROW" => connector(Connector::Arrow),
        "ARROW1" => connector(Connector::Arrow1),
        "ARROW2" => connector(Connector::Arrow2),
        "LINE" => connector(Connector::Line),
        "SPHERE" => NewGeom::sphere(size[0]),
        "CAPSULE" => NewGeom::capsule(size[0], size[1]),
        "ELLIPSOID" => NewGeom::ellipsoid([size[0], size[1], size[2]]),
        "CYLINDER" => NewGeom::cylinder(size[0], size[1]),
        "BOX" => NewGeom::cuboid([size[0], size[1], size[2]]),
        "PLANE" => NewGeom::plane([size[0], size[1]]),
        "MESH" => NewGeom::mesh(model.meshes().next().unwrap()),
        kind => panic!("{kind}"),
    };
    let pos = geom.get("pos").map_or([0.0; 3], array);
    let new = new.with_pos(pos).with_rgba(single(array(&geom["rgba"])));
    match geom.get("category") {
        Some(category) => new.with_category(Categories::from_bits_truncate(category.as_u64().unwrap() as u32)),
        None => new,
    }
}

const LABELS: [(&str, LabelMode); 17] = [
    ("NONE", LabelMode::None),
    ("BODY", LabelMode::Body),
    ("JOINT", LabelMode::Joint),
    ("GEOM", LabelMode::Geom),
    ("SITE", LabelMode::Site),
    ("CAMERA", LabelMode::Camera),
    ("LIGHT", LabelMode::Light),
    ("TENDON", LabelMode::Tendon),
    ("ACTUATOR", LabelMode::Actuator),
    ("CONSTRAINT", LabelMode::Constraint),
    ("FLEX", LabelMode::Flex),
    ("SKIN", LabelMode::Skin),
    ("SELECTION", LabelMode::Selection),
    ("SELPNT", LabelMode::SelectionPoint),
    ("CONTACTPOINT", LabelMode::ContactPoint),
    ("CONTACTFORCE", LabelMode::ContactForce),
    ("ISLAND", LabelMode::Island),
];

const FRAMES: [(&str, FrameMode); 8] = [
    ("NONE", FrameMode::None),
    ("BODY", FrameMode::Body),
    ("GEOM", FrameMode::Geom),
    ("SITE", FrameMode::Site),
    ("CAMERA", FrameMode::Camera),
    ("LIGHT", FrameMode::Light),
    ("CONTACT", FrameMode::Contact),
    ("WORLD", FrameMode::World),
];

pub fn text_of<'v>(row: &'v Value, key: &str) -> &'v str {
    row[key].as_str().unwrap()
}

fn names<'v>(row: &'v Value, key: &str) -> impl Iterator<Item = &'v str> {
    row[key].as_array().unwrap().iter().map(|name| name.as_str().unwrap())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn array<const N: usize>(value: &Value) -> [f64; N] {
    numbers(value).try_into().unwrap()
}

fn single<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    numbers.map(|number| number as f32)
}
