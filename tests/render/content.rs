//! Contents of images: every shape, decoration and label of the model is visible, edits become
//! visible with an upload, and invalid numbers affect only the objects that have them.
//!
//! The images are saved to the folder in the environment variable `MUJOCO_SAFE_PICTURES`, if set.
#![forbid(unsafe_code)]

use std::path::PathBuf;

use mujoco_safe::render::{Renderer, RendererOptions, RgbImage};
use mujoco_safe::scene::{
    Camera, CameraView, Categories, Connector, FrameMode, LabelMode, NewGeom, Perturbation, PerturbationFlags, Scene,
    SceneOptions, TextureRepeat, VisualFlags,
};
use mujoco_safe::{Data, Model, ModelMut, sample};

use crate::cases::cases;
use crate::stage;

const SIZE: [usize; 2] = [160, 120];

/// Saves an image for inspection.
fn save(picture: &RgbImage, name: &str) {
    if let Some(folder) = std::env::var_os("MUJOCO_SAFE_PICTURES") {
        picture.save_png(PathBuf::from(folder).join(name).with_extension("png")).unwrap();
    }
}

/// Returns a model with a mesh, a height field, a skin, textures of each type and mapping, lights
/// of each kind, and a camera.
fn assorted_model() -> Model {
    // Newer compilers lack the composite, which has many bodies and their skin.
    let [skin, cloth] = if cfg!(engine_since = "2.3.0") {
        [
            "<skin name='cloth' material='checks' vertex='0 0 0  .4 0 0  0 .4 0  .4 .4 0' texcoord='0 0  1 0  0 1  1 1'
               face='0 1 2  1 3 2  0 2 1  1 2 3' inflate='.01'>
               <bone body='B0_0' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2 3' vertweight='1 1 1 1'/></skin>",
            "<geom size='.03' group='3'/>",
        ]
    } else {
        [
            "",
            "<composite type='cloth' count='5 5 1' spacing='.1'><geom type='sphere' size='.03' group='3'/>
               <skin texcoord='true' material='checks' inflate='.01'/></composite>",
        ]
    };
    let xml = "<mujoco>
           <asset>
             SKIN
             <texture name='sky' type='skybox' builtin='gradient' width='32' height='192' rgb1='.4 .6 .8' rgb2='0 0 0'/>
             <texture name='checks' type='2d' builtin='checker' width='64' height='64' rgb1='.9 .3 .2' rgb2='.2 .3 .9'/>
             <texture name='cube' type='cube' builtin='flat' width='32' height='192' rgb1='.2 .7 .3' rgb2='.2 .7 .3' mark='cross' markrgb='1 1 1'/>
             <material name='checks' texture='checks' texrepeat='2 2'/>
             <material name='cube' texture='cube' texuniform='true'/>
             <mesh name='roof' vertex='0 0 0  1 0 0  1 1 0  0 1 0  .5 .5 .7' face='0 2 1  0 3 2  0 1 4  1 2 4  2 3 4  3 0 4'
               texcoord='0 0  1 0  1 1  0 1  .5 .5'/>
             <hfield name='hills' nrow='9' ncol='9' size='1 1 .5 .1'/>
           </asset>
           <worldbody>
             <light name='sun' directional='true' pos='0 0 4' dir='.3 .3 -1'/>
             <light name='spot' pos='-2 -2 3' dir='1 1 -1.2' cutoff='40'/>
             <camera name='side' pos='0 -5 1.5' xyaxes='1 0 0 0 .25 1'/>
             <geom name='floor' type='plane' size='0 0 .1' material='checks'/>
             <geom name='hills' type='hfield' hfield='hills' pos='2 1 .2' rgba='.5 .7 .4 1'/>
             <body pos='-1.5 .5 .5'><freejoint/><geom name='roof' type='mesh' mesh='roof' material='checks'/></body>
             <body pos='0 0 1'><joint name='hinge' axis='0 1 0'/><geom name='box' type='box' size='.3 .2 .25' material='cube'/>
               <site name='site' pos='0 0 .4' size='.05'/></body>
             <body pos='.8 -.5 .5'><freejoint/><geom name='ball' type='sphere' size='.25' rgba='.8 .8 .1 .5'/></body>
             <body name='B0_0' pos='-.4 -1 .6'><freejoint/>
               CLOTH</body>
           </worldbody>
           <actuator><motor name='motor' joint='hinge'/></actuator>
         </mujoco>";
    Model::from_xml_str(&xml.replace("SKIN", skin).replace("CLOTH", cloth)).unwrap()
}

/// Returns options that affect only the smoothness of edges and shadows.
fn fast() -> RendererOptions {
    RendererOptions::default().with_samples(1).with_shadow_size(256)
}

fn renderer(model: &Model, [width, height]: [usize; 2]) -> Renderer {
    Renderer::on(stage::gpu(), model, width, height, fast()).unwrap()
}

fn update(data: &mut Data, scene: &mut Scene, options: &SceneOptions) {
    let side = data.model().camera("side").unwrap().id();
    let mut camera = Camera { view: CameraView::Fixed(side), ..Camera::default() };
    scene.update(data, options, None, &mut camera, Categories::all()).unwrap();
}

/// Renders a simulation from its camera.
fn picture(renderer: &mut Renderer, data: &mut Data) -> RgbImage {
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    update(data, &mut scene, &SceneOptions::default());
    renderer.rgb(&scene).unwrap()
}

/// Returns the share of bytes that differ.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.as_bytes().len(), b.as_bytes().len());
    let differ = a.as_bytes().iter().zip(b.as_bytes()).filter(|(a, b)| a != b).count();
    differ as f64 / a.as_bytes().len() as f64
}

#[test]
fn edited_assets_are_visible_after_an_upload() {
    type Edit = fn(&mut ModelMut<'_>);
    type Upload = fn(&mut Renderer, &Model);
    let edits: [(&str, Edit, Upload); 4] = [
        (
            "texture",
            |model| model.texture_mut("checks").unwrap().rgb_mut().fill(255),
            |renderer, model| renderer.update_texture(model, "checks").unwrap(),
        ),
        (
            "cube",
            |model| model.texture_mut("cube").unwrap().rgb_mut().fill(0),
            |renderer, model| renderer.update_texture(model, "cube").unwrap(),
        ),
        (
            "mesh",
            |model| model.mesh_mut("roof").unwrap().normal_mut().fill([0.0, 0.0, -1.0]),
            |renderer, model| renderer.update_mesh(model, "roof").unwrap(),
        ),
        (
            "height field",
            |model| {
                for (index, elevation) in model.height_field_mut("hills").unwrap().data_mut().iter_mut().enumerate() {
                    *elevation = (index % 9) as f32 / 9.0;
                }
            },
            |renderer, model| renderer.update_height_field(model, "hills").unwrap(),
        ),
    ];
    for (what, edit, upload) in edits {
        let mut data = Data::new(assorted_model()).unwrap();
        let mut renderer = self::renderer(data.model(), SIZE);
        let before = picture(&mut renderer, &mut data);
        data.edit_model(edit).unwrap();
        assert_eq!(difference(&before, &picture(&mut renderer, &mut data)), 0.0, "{what}: visible too early");
        upload(&mut renderer, data.model());
        let after = picture(&mut renderer, &mut data);
        assert!(difference(&before, &after) > 0.001, "{what}: not visible");
        save(&after, &format!("edited {what}"));
        // A renderer created after the edit gives the same image.
        let mut other = self::renderer(data.model(), SIZE);
        assert_eq!(
            difference(&after, &picture(&mut other, &mut data)),
            0.0,
            "{what}: differs from a new renderer's image"
        );
    }
}

/// Sets a field of a model to a number everywhere.
type Fill = fn(&mut ModelMut<'_>, f64);

/// Fields of shapes that can be set to NaN or to huge numbers.
const INVALID_EDITS: [(&str, Fill); 8] = [
    ("colours", |model, number| model.geom_rgba_mut().fill([number as f32; 4])),
    ("sizes", |model, number| model.geom_size_mut().fill([number; 3])),
    ("normals", |model, number| model.mesh_normal_mut().fill([number as f32; 3])),
    ("texture coordinates", |model, number| {
        model.mesh_texcoord_mut().fill([number as f32; 2]);
        model.skin_texcoord_mut().fill([number as f32; 2]);
    }),
    ("elevations", |model, number| model.hfield_data_mut().fill(number as f32)),
    ("vertices of skins", |model, number| model.skin_vert_mut().fill([number as f32; 3])),
    ("weights of skins", |model, number| model.skin_bonevertweight_mut().fill(number as f32)),
    ("directions of lights", |model, number| model.light_dir_mut().fill([number; 3])),
];

#[test]
fn invalid_numbers_affect_only_their_own_object() {
    const SIZE: [usize; 2] = [64, 48];
    let mut clean = Data::new(assorted_model()).unwrap();
    let mut renderer = self::renderer(clean.model(), SIZE);
    let expected = picture(&mut renderer, &mut clean);
    for (index, (what, edit)) in INVALID_EDITS.iter().enumerate() {
        let numbers = [f64::NAN, f64::INFINITY, -1e30, 0.0];
        for number in numbers.into_iter().skip(index % cases(4, 1)).step_by(cases(4, 1)) {
            let mut data = Data::new(clean.model().clone()).unwrap();
            data.edit_model(|model| edit(model, number)).unwrap();
            let mut scene = Scene::new(data.model(), 1000).unwrap();
            // A simulation that has become unstable has no scene.
            if data.forward().is_err() {
                continue;
            }
            update(&mut data, &mut scene, &SceneOptions::default());
            // A renderer of the edited model, and a renderer that uploads the edit.
            let Ok(mut own) = Renderer::on(stage::gpu(), data.model(), SIZE[0], SIZE[1], fast()) else { continue };
            drop((own.rgb(&scene), own.depth(&scene), own.segmentation(&scene)));
            drop((renderer.rgb(&scene), renderer.depth(&scene), renderer.segmentation(&scene)));
            let after = picture(&mut renderer, &mut clean);
            assert_eq!(difference(&expected, &after), 0.0, "{what} of {number}: the next image differs");
        }
    }
}

#[test]
fn every_user_geom_is_visible() {
    let mut data = Data::new(assorted_model()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    update(&mut data, &mut scene, &SceneOptions::default());
    scene.clear();
    let (mesh, field) = (data.model().mesh("roof").unwrap().id(), data.model().height_field("hills").unwrap().id());
    let checks = data.model().texture("checks").unwrap().id();
    // The textures of newer engines belong to materials.
    let textured = |geom: NewGeom| {
        if cfg!(engine_since = "3.2.1") { geom } else { geom.with_texture(checks, TextureRepeat::PerGeom([1.0, 1.0])) }
    };
    let connector = |shape| NewGeom::connector(shape, 0.05, [0.0, 0.0, -0.3], [0.2, 0.0, 0.3]);
    let shapes = [
        textured(NewGeom::plane([0.3, 0.3])),
        NewGeom::sphere(0.3),
        NewGeom::capsule(0.15, 0.2),
        NewGeom::ellipsoid([0.3, 0.2, 0.1]),
        NewGeom::cylinder(0.2, 0.3),
        textured(NewGeom::cuboid([0.2, 0.3, 0.1])),
        NewGeom::mesh(mesh),
        NewGeom::convex_hull(mesh),
        NewGeom::height_field(field),
        NewGeom::connector(Connector::Capsule, 0.1, [0.0; 3], [0.2, 0.0, 0.3]),
        connector(Connector::Cylinder),
        connector(Connector::Arrow),
        connector(Connector::Arrow1),
        connector(Connector::Arrow2),
        connector(Connector::Line),
    ];
    let mut places = (0..4).flat_map(|row| (0..4).map(move |column| (row, column)));
    for (index, shape) in shapes.iter().enumerate() {
        let (row, column) = places.next().unwrap();
        let at = [-1.8 + 1.2 * f64::from(column), 0.0, 1.7 - 0.9 * f64::from(row)];
        let color = [0.3 + 0.04 * index as f32, 0.8 - 0.04 * index as f32, 0.6, 1.0];
        let shape = match index {
            // The ends of connectors are in the world frame.
            9.. => {
                let kinds = [
                    Connector::Capsule,
                    Connector::Cylinder,
                    Connector::Arrow,
                    Connector::Arrow1,
                    Connector::Arrow2,
                    Connector::Line,
                ];
                NewGeom::connector(
                    kinds[index - 9],
                    0.06,
                    [at[0], at[1], at[2] - 0.3],
                    [at[0] + 0.2, at[1], at[2] + 0.3],
                )
            }
            0 => shape.clone().with_pos(at).with_mat([1.0, 0.0, 0.0, 0.0, 0.6, -0.8, 0.0, 0.8, 0.6]),
            8 => shape.clone().with_pos([at[0], 1.0, at[2]]),
            _ => shape.clone().with_pos(at),
        };
        assert_eq!(scene.add_geom(&shape.with_rgba(color)).unwrap(), index);
    }
    let mut renderer = self::renderer(data.model(), [640, 480]);
    save(&renderer.rgb(&scene).unwrap(), "shapes");
    let segmentation = renderer.segmentation(&scene).unwrap();
    save(&segmentation.to_rgb(), "shapes by segment");
    let seen = segmentation.segments();
    let unseen: Vec<usize> =
        (0..shapes.len()).filter(|index| seen.iter().all(|(segment, _)| segment.geom != *index)).collect();
    assert!(unseen.is_empty(), "unseen: {unseen:?}");
    assert!(seen.iter().all(|(segment, count)| segment.object.is_none() && *count > 20), "{seen:?}");
}

/// A model leaves the pixels of this texture in a file, which the renderer reads.
#[cfg(all(unix, engine_since = "3.17.0"))]
#[test]
fn a_texture_whose_file_became_a_pipe_is_white() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("red.png");
    RgbImage::from_rgb(2, 2, [255, 0, 0].repeat(4)).unwrap().save_png(&file).unwrap();
    let [textured, plain] = ["texture='t'", ""].map(|texture| {
        let xml = format!(
            "<mujoco><asset><texture name='t' type='2d' file='{}' embed='false'/><material name='m' {texture}/></asset>
             <worldbody><camera name='side' pos='0 0 3'/><light pos='0 0 9'/><geom type='plane' size='9 9 1' material='m'/></worldbody></mujoco>",
            file.display()
        );
        Model::from_xml_str(&xml).unwrap()
    });
    let draw = |model: &Model| picture(&mut renderer(model, SIZE), &mut Data::new(model.clone()).unwrap());
    let white = draw(&plain);
    assert!(difference(&draw(&textured), &white) > 0.5);
    std::fs::remove_file(&file).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&file).status().unwrap().success());
    let (sender, drawn) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(draw(&textured)));
    let drawn = drawn.recv_timeout(std::time::Duration::from_secs(60)).expect("opening the pipe waits for a writer");
    assert_eq!(drawn.as_bytes(), white.as_bytes());
}

/// Returns a humanoid that has fallen, and a perturbation.
fn humanoid() -> (Data, Perturbation) {
    let mut data = Data::new(sample::humanoid()).unwrap();
    for _ in 0..300 {
        data.step().unwrap();
    }
    data.forward().unwrap();
    let mut perturbation = Perturbation::default();
    perturbation.select = data.model().bodies().nth(3).map(|body| body.id());
    perturbation.active = PerturbationFlags::all();
    perturbation.refpos = [0.3, -0.2, 0.8];
    perturbation.localpos = [0.2, -0.3, 0.1];
    perturbation.refquat = [0.8, 0.0, 0.6, 0.0];
    (data, perturbation)
}

fn decorated(
    renderer: &mut Renderer,
    data: &mut Data,
    perturbation: &Perturbation,
    options: &SceneOptions,
) -> RgbImage {
    let mut scene = Scene::new(data.model(), 10_000).unwrap();
    let mut camera = Camera::free(data.model());
    camera.lookat = [0.0, 0.0, 0.3];
    camera.distance = 3.0;
    scene.update(data, options, Some(perturbation), &mut camera, Categories::all()).unwrap();
    renderer.rgb(&scene).unwrap()
}

#[test]
fn every_decoration_is_visible() {
    let (mut data, perturbation) = humanoid();
    let mut renderer = self::renderer(data.model(), [640, 480]);
    let plain = SceneOptions::default().with_flags(VisualFlags::TEXTURE | VisualFlags::STATIC);
    let before = decorated(&mut renderer, &mut data, &perturbation, &plain);
    // Flags for which the model has something to show.
    for flag in [
        VisualFlags::JOINT,
        VisualFlags::ACTUATOR,
        VisualFlags::INERTIA,
        VisualFlags::PERTOBJ,
        VisualFlags::CONTACTPOINT,
        VisualFlags::CONTACTFORCE,
        VisualFlags::TRANSPARENT,
        VisualFlags::AUTOCONNECT,
        VisualFlags::COM,
        VisualFlags::SELECT,
    ] {
        let options = plain.clone().with_flags(plain.flags | flag);
        let after = decorated(&mut renderer, &mut data, &perturbation, &options);
        assert!(difference(&before, &after) > 1e-5, "{flag:?} is not visible");
        save(&after, &format!("decoration {flag:?}"));
    }
    for frame in [FrameMode::Body, FrameMode::Geom, FrameMode::Contact, FrameMode::World] {
        let after = decorated(&mut renderer, &mut data, &perturbation, &plain.clone().with_frame(frame));
        assert!(difference(&before, &after) > 1e-5, "frames of {frame:?} are not seen");
        save(&after, &format!("frames {frame:?}"));
    }
    let all = SceneOptions::default().with_flags(VisualFlags::all()).with_frame(FrameMode::Body);
    save(&decorated(&mut renderer, &mut data, &perturbation, &all), "decoration all");
}

#[test]
fn labels_are_visible() {
    let (mut data, perturbation) = humanoid();
    let mut renderer = self::renderer(data.model(), [640, 480]);
    let plain = SceneOptions::default();
    let before = decorated(&mut renderer, &mut data, &perturbation, &plain);
    for label in [LabelMode::Body, LabelMode::Geom, LabelMode::Selection] {
        let after = decorated(&mut renderer, &mut data, &perturbation, &plain.clone().with_label(label));
        assert!(difference(&before, &after) > 1e-4, "labels of {label:?} are not seen");
        save(&after, &format!("labels {label:?}"));
        // White letters.
        let is_white = |pixel: &&[u8; 3]| pixel.iter().all(|&byte| byte > 230);
        let white = |picture: &RgbImage| picture.as_bytes().as_chunks::<3>().0.iter().filter(is_white).count();
        assert!(white(&after) > white(&before) + 5, "{label:?}: {} against {}", white(&after), white(&before));
    }
}

#[test]
fn a_user_label_is_drawn_at_its_position_in_front_of_everything() {
    let mut data = Data::new(assorted_model()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    update(&mut data, &mut scene, &SceneOptions::default());
    let mut renderer = self::renderer(data.model(), SIZE);
    let before = renderer.rgb(&scene).unwrap();
    // Behind the hills, and with letters that the font lacks.
    scene.add_geom(&NewGeom::text("höher als die Hügel").unwrap().with_pos([1.5, 4.0, 0.1])).unwrap();
    let after = renderer.rgb(&scene).unwrap();
    assert!(difference(&before, &after) > 1e-3);
    save(&after, "text");
    let segmentation = renderer.segmentation(&scene).unwrap();
    assert!(segmentation.pixels().flatten().all(|segment| segment.geom + 1 < scene.ngeom()), "a label is no geom");
}
