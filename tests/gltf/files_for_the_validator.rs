//! Files for the tests of `scripts/try-html`.

use std::path::{Path, PathBuf};

use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::{Data, Model, RandomController, Trajectory, sample};

use crate::file::{SHAPES, recorded};
use crate::skins;

/// Models of single features, next to those of the sample models.
const MODELS: [(&str, &str); 7] = [
    ("shapes", SHAPES),
    ("empty", "<mujoco/>"),
    ("still", "<mujoco><worldbody><geom size='1 1 1' type='box'/></worldbody></mujoco>"),
    ("names", "<mujoco><worldbody><body name='&lt;script>&quot;\\'><freejoint/><geom name='é' size='.1'/></body></worldbody></mujoco>"),
    (
        "lights",
        "<mujoco><worldbody><geom type='plane' size='1 1 1'/><light cutoff='0.001' pos='0 0 1'/><light cutoff='90' pos='0 0 1'/>
           <light cutoff='170' pos='0 0 1'/><light exponent='0' pos='0 0 0'/><light directional='true' diffuse='0 0 0'/></worldbody></mujoco>",
    ),
    (
        "tendon",
        "<mujoco><worldbody><site name='a' pos='0 0 2'/><body><joint type='slide' axis='0 0 1'/><geom size='.1'/>
           <site name='b'/></body></worldbody><tendon><spatial><site site='a'/><site site='b'/></spatial></tendon></mujoco>",
    ),
    (
        "degenerate",
        "<mujoco><asset><mesh name='m' vertex='0 0 0  1 0 0  0 1 0  0 0 1  0 0 1' face='0 2 1  0 1 3  0 3 2  1 2 3  3 4 3'/></asset>
           <worldbody><geom type='mesh' mesh='m'/><geom type='box' size='1e-20 1 1'/></worldbody></mujoco>",
    ),
];

#[test]
#[ignore = "scripts/try-html runs it"]
fn files_are_written() {
    let folder = PathBuf::from(std::env::var_os("HTML_PAGES").expect("HTML_PAGES is the folder for the files"));
    let mut count = 0;
    let mut write = |name: &str, model: &Model, most: f64| {
        let mut data = Data::new(model.clone()).unwrap();
        let mut trajectory = Trajectory::new(model);
        let steps = (1.0 / model.options().timestep).round().min(most) as usize;
        // A model that becomes unstable has a shorter motion.
        let _ = trajectory.record(&mut data, &mut RandomController::new(1), steps);
        trajectory.save_glb(model.clone(), folder.join(format!("{name}.glb")), &GltfOptions::default()).unwrap();
        count += 1;
    };
    for (name, xml) in MODELS {
        write(name, &Model::from_xml_str(xml).unwrap(), 100.0);
    }
    let skin = skins::arm();
    write("skin", &skin, 200.0);
    let mut hostile = skin;
    let mut edit = hostile.edit();
    edit.skin_bonevertweight_mut()[0] = -1.0;
    edit.skin_bonevertweight_mut()[1] = 1e-30;
    edit.skin_bonebindquat_mut()[1] = [0.0; 4];
    write("hostile_skin", &hostile, 100.0);
    #[cfg(engine_since = "3.0.0")]
    write("flex", &Model::from_xml_str(skins::FLEX).unwrap(), 100.0);
    write("cartpole", &sample::cartpole(), 100.0);
    write("humanoid", &sample::humanoid(), 100.0);
    write("hopper", &sample::hopper(), 100.0);
    write("half_cheetah", &sample::half_cheetah(), 100.0);
    for name in ["arm", "rover"] {
        write(name, &Model::from_xml_path(Path::new("models").join(format!("{name}.xml"))).unwrap(), 100.0);
    }
    for path in sample::system_models() {
        // Some files are parts of others.
        if let Ok(model) = Model::from_xml_path(&path) {
            let name = path.file_stem().unwrap().to_string_lossy();
            write(&format!("system_{name}"), &model, 10.0);
        }
    }
    let model = sample::humanoid();
    let (first, second) = (recorded(&model, 1, 200), recorded(&model, 2, 200));
    let both = [("first", &first), ("second", &second)];
    mujoco_safe::gltf::save(folder.join("two.glb"), model, both, &GltfOptions::default().with_rotation_error(1e-6))
        .unwrap();
    assert!(count >= 20, "{count} models");
}
