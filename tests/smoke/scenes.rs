//! A scene after the parts of the pipeline that it asks for is the scene after the whole of it.

use mujoco_safe::scene::{Camera, Categories, Scene, SceneGeom, SceneOptions, VisualFlags};
use mujoco_safe::{Data, Error, Model, StateSpec, sample};

use crate::installed::sample_files;

/// Casts a ray, and colours a joint and a tendon at their limits with newer engines.
const LIMITS: &str = r#"
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <light mode="trackcom" pos="0 0 3"/>
    <camera mode="targetbodycom" target="arm" pos="2 0 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" range="-0.1 0.1" limited="true"/>
      <geom type="capsule" size="0.05" fromto="0 0 0 0.5 0 0"/>
      <site name="tip" pos="0.5 0 0" zaxis="0 0 -1"/>
    </body>
    <geom type="plane" size="1 1 0.1"/>
    <site name="anchor" pos="0.5 0 1.5"/>
  </worldbody>
  RAY TENDON
</mujoco>"#;
const RAY: &str = r#"<sensor><rangefinder site="tip"/></sensor>"#;
const TENDON: &str = r#"
<tendon><spatial limited="true" range="0 0.4"><site site="tip"/><site site="anchor"/></spatial></tendon>"#;

fn models() -> impl Iterator<Item = Model> {
    let with = |ray, tendon| Model::from_xml_str(&LIMITS.replace("RAY", ray).replace("TENDON", tendon)).unwrap();
    let small = [with("", ""), with(RAY, ""), with("", TENDON), with(RAY, TENDON)];
    let files = sample_files().into_iter().filter_map(|path| Model::from_xml_path(path).ok());
    let installed = files.filter(|model| model.nv() <= 60);
    [sample::humanoid(), sample::cartpole()].into_iter().chain(small).chain(installed)
}

/// Contents of a scene that an image depends on.
#[derive(Debug, PartialEq)]
struct Contents {
    /// Pose, size and colour, and label.
    geoms: Vec<(Vec<f32>, String)>,
    skins: Vec<Vec<[f32; 3]>>,
    lights: Vec<([f32; 3], [f32; 3])>,
    viewpoints: String,
}

fn numbers(geom: SceneGeom<'_>) -> Vec<f32> {
    geom.pos().into_iter().chain(geom.mat()).chain(geom.size()).chain(geom.rgba()).collect()
}

fn contents(data: &mut Data, options: &SceneOptions) -> Result<Contents, Error> {
    let model = data.model().clone();
    let mut scene = Scene::new(&model, 20_000).unwrap();
    let mut camera = match model.cameras().next() {
        Some(camera) => Camera::fixed(&model, camera.id()),
        None => Camera::free(&model),
    };
    scene.update(data, options, None, &mut camera, Categories::all())?;
    Ok(Contents {
        geoms: scene.geoms().map(|geom| (numbers(geom), geom.label().into())).collect(),
        skins: scene.skins().map(|skin| skin.vertices.to_vec()).collect(),
        lights: scene.lights().map(|light| (light.pos, light.dir)).collect(),
        viewpoints: format!("{:?}", scene.viewpoints()),
    })
}

/// Computes the poses, the position stage, and the sensors of this stage, until the scene has what
/// it asks for. Returns the contents, and the number of these three.
fn ask(data: &mut Data, options: &SceneOptions) -> (Contents, usize) {
    let poses = |data: &mut Data| {
        data.kinematics()?;
        data.com_pos()?;
        data.camlight()
    };
    for (at, compute) in [poses, Data::fwd_position, Data::sensor_pos].into_iter().enumerate() {
        compute(data).unwrap();
        match contents(data, options) {
            Ok(contents) => return (contents, at),
            Err(Error::NotComputed { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
    data.forward().unwrap();
    (contents(data, options).unwrap(), 3)
}

#[test]
fn scenes_after_the_parts_that_they_ask_for_equal_those_after_all_parts() {
    let mut counts = [0; 4];
    for model in models() {
        let mut moved = Data::new(model).unwrap();
        let model = moved.model().clone();
        moved.qvel_mut().fill(0.5);
        moved.ctrl_mut().fill(0.3);
        moved.step_n(60).unwrap();
        let state = moved.state(StateSpec::INTEGRATION);
        moved.forward().unwrap();
        for flag in VisualFlags::all().iter().chain([VisualFlags::empty()]) {
            let options = SceneOptions::default();
            let flags = options.flags | flag;
            let options = options.with_flags(flags);
            // Results of another state.
            let mut data = Data::new(model.clone()).unwrap();
            data.forward().unwrap();
            data.set_state(StateSpec::INTEGRATION, &state).unwrap();
            let (found, parts) = ask(&mut data, &options);
            assert!(found == contents(&mut moved, &options).unwrap(), "{flag:?} of {model:?}");
            counts[parts] += 1;
        }
    }
    assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
}
