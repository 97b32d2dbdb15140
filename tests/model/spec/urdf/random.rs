//! Generated robots, compiled by the engine's reader and as specs.

use std::fmt::Write as _;
use std::path::Path;

use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, LoadOptions, Model};
use rand::seq::{IndexedMutRandom, IndexedRandom};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{check, corner};
use crate::cases::cases;

struct Generator(Xoshiro256PlusPlus);

/// Returns a joint with the world as its parent.
fn in_world(joint: &str) -> String {
    let (before, rest) = joint.split_once("<parent link='").unwrap();
    let (_, after) = rest.split_once('\'').unwrap();
    format!("{before}<parent link='world'{after}")
}

impl Generator {
    fn once_in(&mut self, number: u32) -> bool {
        self.0.random_ratio(1, number)
    }

    fn choose(&mut self, texts: &[&'static str]) -> &'static str {
        texts.choose(&mut self.0).unwrap()
    }

    fn number(&mut self, low: f64, high: f64) -> f64 {
        if self.once_in(4) {
            [low, high, 0.5 * (low + high)][self.0.random_range(0..3)]
        } else {
            self.0.random_range(low..=high)
        }
    }

    fn vector(&mut self, size: f64) -> String {
        let numbers: Vec<String> = (0..3).map(|_| self.number(-size, size).to_string()).collect();
        numbers.join(" ")
    }

    fn origin(&mut self, has_rotation: bool) -> String {
        match self.0.random_range(0..4) {
            0 => String::new(),
            1 => format!("<origin xyz='{}'/>", self.vector(1.0)),
            _ if !has_rotation => "<origin rpy='0 0 0'/>".to_owned(),
            2 => format!("<origin rpy='{}'/>", self.vector(3.2)),
            _ => format!("<origin xyz='{}' rpy='{}'/>", self.vector(1.0), self.vector(3.2)),
        }
    }

    fn geometry(&mut self) -> String {
        let (a, b, c) = (self.number(0.01, 0.5), self.number(0.01, 0.5), self.number(0.01, 0.5));
        match self.0.random_range(0..7) {
            0 => format!("<box size='{a} {b} {c}'/>"),
            1 => format!("<cylinder radius='{a}' length='{b}'/>"),
            2 => format!("<sphere radius='{a}'/>"),
            3 if cfg!(engine_since = "2.3.3") => format!("<capsule radius='{a}' length='{b}'/>"),
            _ => {
                let file = self.choose(&["one.obj", "two.obj"]);
                let scales = ["", "", " scale='1 -1 2'", " scale='1 1 1'", " scale='2 1 1'"];
                // Older readers mix up the scales of a file.
                let scale = if cfg!(engine_since = "3.17.0") {
                    self.choose(&scales)
                } else if file == "one.obj" {
                    scales[0]
                } else {
                    scales[2]
                };
                format!("<mesh filename='{file}'{scale}/>")
            }
        }
    }

    fn link(&mut self, number: usize) -> String {
        let mut content = String::new();
        if !self.once_in(4) {
            // The moments of three masses about axes through the origin.
            let mut moments = [1e-3; 6];
            moments[3..].fill(0.0);
            for _ in 0..3 {
                let [x, y, z] = [0; 3].map(|_| self.number(-0.3, 0.3));
                let terms = [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z];
                moments.iter_mut().zip(terms).for_each(|(moment, term)| *moment += term);
            }
            let [xx, yy, zz, xy, xz, yz] = moments;
            // Some engines forget the orientation of an inertia, or have other signs of its axes.
            let origin = self.origin(cfg!(engine_since = "3.17.0"));
            let mass = self.number(0.1, 5.0);
            let _ = write!(
                content,
                "<inertial>{origin}<mass value='{mass}'/>
                 <inertia ixx='{xx}' iyy='{yy}' izz='{zz}' ixy='{xy}' ixz='{xz}' iyz='{yz}'/></inertial>"
            );
        }
        let geoms = if content.is_empty() { 1 } else { self.0.random_range(0..3) };
        for geom in 0..geoms {
            let kind = if geom == 0 { "collision" } else { self.choose(&["collision", "visual"]) };
            let material =
                self.choose(&["", "<material name='m'/>", "<material name='n'><color rgba='.1 .2 .3 1'/></material>"]);
            let material = if kind == "visual" { material } else { "" };
            let (origin, geometry) = (self.origin(true), self.geometry());
            let _ = write!(content, "<{kind}>{origin}<geometry>{geometry}</geometry>{material}</{kind}>");
        }
        format!("<link name='l{number}'>{content}</link>")
    }

    fn joint(&mut self, child: usize) -> String {
        // The engine has free joints in the world only.
        let types = ["revolute", "continuous", "prismatic", "fixed", "fixed", "planar"];
        let kind = self.choose(&types);
        let parent = self.0.random_range(0..child);
        let mut content = self.origin(true);
        if !self.once_in(3) {
            let _ = write!(content, "<axis xyz='{}'/>", self.vector(1.0));
        }
        if self.once_in(2) && kind != "continuous" {
            let (lower, upper) = (self.number(-2.0, 0.5), self.number(-0.5, 2.0));
            let effort = if cfg!(engine_since = "3.2.0") { " effort='7'" } else { "" };
            let _ = write!(content, "<limit lower='{lower}' upper='{upper}'{effort} velocity='1'/>");
        }
        if self.once_in(2) {
            let _ = write!(content, "<dynamics damping='{}'/>", self.number(0.0, 1.0));
        }
        if self.once_in(4) && child > 1 && cfg!(engine_since = "3.14.0") {
            let leader = self.0.random_range(1..child);
            let _ = write!(content, "<mimic joint='j{leader}' multiplier='{}'/>", self.number(-1.0, 1.0));
        }
        format!(
            "<joint name='j{child}' type='{kind}'><parent link='l{parent}'/><child link='l{child}'/>{content}</joint>"
        )
    }

    fn robot(&mut self) -> String {
        let count = self.0.random_range(1..9);
        let mut content: Vec<String> = (0..count).map(|number| self.link(number)).collect();
        let mut joints: Vec<String> = (1..count).map(|child| self.joint(child)).collect();
        if self.once_in(2) {
            // A root that is the world, and a part of the robot below it.
            content.push("<link name='world'/>".to_owned());
            let is_below = self.once_in(2);
            if let Some(joint) = joints.choose_mut(&mut self.0).filter(|_| is_below) {
                *joint = in_world(joint);
            }
        }
        content.extend(joints);
        for part in (1..content.len()).rev() {
            let other = self.0.random_range(0..=part);
            content.swap(part, other);
        }
        let settings = self.choose(&[
            "",
            "",
            "<compiler fusestatic='false'/>",
            "<compiler discardvisual='false'/>",
            "<compiler discardvisual='false' fusestatic='false' balanceinertia='true'/>",
            "<option timestep='.001'/>",
        ]);
        format!(
            "<robot name='r'><mujoco>{settings}</mujoco><material name='m'><color rgba='1 0 0 .5'/></material>{}</robot>",
            content.concat()
        )
    }
}

#[test]
fn generated_robots_equal_the_engines() {
    let folder = tempfile::tempdir().unwrap();
    for (name, size) in [("one", 0.1), ("two", 0.2)] {
        std::fs::write(folder.path().join(name).with_extension("obj"), corner(size)).unwrap();
    }
    let count = cases(150, 1500);
    let mut compared = 0;
    for seed in 0..count {
        let urdf = Generator(Xoshiro256PlusPlus::seed_from_u64(seed)).robot();
        let path = folder.path().join("robot.urdf");
        std::fs::write(&path, &urdf).unwrap();
        let theirs = Model::from_xml_path(&path);
        let spec = Spec::from_xml_path(&path).unwrap_or_else(|error| panic!("{error}\n{urdf}"));
        let ours = spec.compile();
        match (ours, theirs) {
            (Ok(ours), Ok(theirs)) => {
                check(&ours, &theirs, &urdf);
                let mut both = [ours, theirs].map(|model| Data::new(model).unwrap());
                let results = both.each_mut().map(|data| data.step().is_ok());
                assert_eq!(results[0], results[1]);
                compared += 1;
            }
            (Err(_), Err(_)) => {}
            (ours, theirs) => panic!("{ours:?} {theirs:?}\n{urdf}\n{}", spec.to_xml()),
        }
    }
    assert!(compared > count / 2, "{compared} of {count}");
}

/// Each URDF below a directory loads as a spec, stands in a scene with another one, and is saved.
#[test]
#[ignore = "needs a directory of robots"]
fn real_robots_load_and_are_saved() {
    let path = std::env::var_os("MUJOCO_SAFE_MODELS").expect("MUJOCO_SAFE_MODELS is a directory");
    let mut open = vec![std::path::PathBuf::from(path)];
    let mut failed = 0;
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            match scene(&path) {
                Ok(text) => println!("{}: {text}", path.display()),
                Err(text) => {
                    failed += 1;
                    println!("{}: FAILED {text}", path.display());
                }
            }
        }
    }
    println!("{failed} failed");
}

fn scene(path: &Path) -> Result<String, String> {
    use mujoco_safe::enums::{GeomType, JointType};
    use mujoco_safe::kind::Joint;
    use mujoco_safe::spec::{ActuatorElement, Mount};

    let step = |name: &'static str| move |error: mujoco_safe::Error| format!("{name}: {error}");
    let mut notes = String::new();
    let mut robot = Spec::from_xml_path(path).map_err(step("read"))?;
    let options = LoadOptions::default().with_visuals();
    let mut with_visuals = Spec::from_xml_path_with(path, &options).map_err(step("visuals"))?;
    if let Err(error) = robot.compile() {
        for robot in [&mut robot, &mut with_visuals] {
            let mut compiler = robot.section_mut("compiler").unwrap();
            compiler.set("balanceinertia", true).unwrap().set("boundinertia", 1e-9).unwrap();
        }
        notes = format!("; with balanceinertia, because of {error}");
    }
    let model = robot.compile().map_err(step("compile"))?;
    if let Err(error) = with_visuals.compile() {
        notes = format!("{notes}; without visuals, because of {error}");
        with_visuals = robot.clone();
    }
    let ngeom = with_visuals.compile().map_err(step("compile visuals"))?.ngeom();
    let engine = match Model::from_xml_path(path) {
        Ok(theirs) => {
            // SAFETY: a valid model.
            let found = unsafe { super::differences(&model, theirs.as_ptr(), 1e-9, &[]) };
            if found.is_empty() { "same".to_owned() } else { format!("{found:?}") }
        }
        Err(error) => format!("rejects: {}", error.to_string().lines().next().unwrap_or_default()),
    };
    let mut scene = Spec::new("scene");
    let world = scene.world();
    scene.add_geom(world).set_type(GeomType::Plane).set_size(&[5.0, 5.0, 0.1]);
    scene.add_camera(world).set_pos([0.0, -3.0, 2.0]);
    scene.attach(&with_visuals, Mount::body(world).with_pos([0.0, 0.0, 1.0]), "a/").map_err(step("attach"))?;
    scene.attach(&robot, Mount::body(world).with_pos([3.0, 0.0, 1.0]), "b/").map_err(step("attach"))?;
    for joint in scene.ids::<Joint>() {
        let joint = scene.element(joint);
        if joint.attribute("type") != Some("free") {
            let name = joint.name().unwrap().to_owned();
            scene.add_actuator(ActuatorElement::Motor).set_joint(&name[..]);
        }
    }
    let model_of_scene = scene.compile().map_err(step("compile scene"))?;
    let folder = tempfile::tempdir().unwrap();
    let files = ["absolute.xml", "copied.xml"].map(|name| folder.path().join(name));
    scene.save_xml(&files[0]).map_err(step("save"))?;
    scene.save_xml_with_assets(&files[1]).map_err(step("save copies"))?;
    let mut states = Vec::new();
    let free = (0..model.njnt()).filter(|&joint| model.jnt_type()[joint] == JointType::Free as i32).count();
    let sizes = format!("nv {}, free {free}, geoms {} of {ngeom}", model.nv(), model.ngeom());
    let loaded = files.each_ref().map(Model::from_xml_path);
    let [a, b] = loaded;
    for model in [model_of_scene, a.map_err(step("load"))?, b.map_err(step("load copies"))?] {
        let mut data = Data::new(model).map_err(step("data"))?;
        (0..20).for_each(|_| drop(data.step()));
        states.push(data.qpos().to_vec());
    }
    if states.iter().any(|state| *state != states[0]) {
        return Err("the steps differ".to_owned());
    }
    Ok(format!("{sizes}; {} warnings; engine: {engine}{notes}", robot.urdf_warnings().len()))
}
