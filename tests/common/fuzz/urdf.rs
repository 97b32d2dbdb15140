//! URDF texts from a grammar whose choices are mostly valid, damaged like other XML.

use std::fmt::Write as _;

use mujoco_safe::LoadOptions;
use mujoco_safe::spec::Spec;

use super::text::{damage, load_and_use};
use super::{Bytes, Verdict, assets};

const TYPES: [&str; 12] = [
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "&#114;evolute",
    "Revolute",
    "revolute ",
    "spherical",
    "ball",
    "",
];

const NUMBERS: [&str; 16] = [
    "1",
    "0.1",
    "0",
    "-1",
    "2",
    "1e-9",
    "1e-300",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "1e9",
    "",
    "x",
    "1 2",
    "4294967297",
];

/// Attributes of `<compiler>` in the `<mujoco>` extension.
const COMPILER: [&str; 12] = [
    "fusestatic='false'",
    "discardvisual='false'",
    "strippath='false'",
    "balanceinertia='true'",
    "boundmass='0.01' boundinertia='0.01'",
    "settotalmass='3'",
    "inertiafromgeom='true'",
    "meshdir='meshes'",
    "angle='degree'",
    "eulerseq='zyx'",
    "coordinate='global'",
    "fitaabb='true'",
];

const EXTENSIONS: [&str; 6] = [
    "<option integrator='implicit'/>",
    "<option cone='elliptic' jacobian='sparse' timestep='0.01'/>",
    "<size njmax='50' nconmax='10'/>",
    "<size nkey='2' nuserdata='3' nstack='20000'/>",
    "<worldbody><body/></worldbody>",
    "<compiler><lengthrange mode='all'/></compiler>",
];

pub(super) fn generated_urdf(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let mut text = robot(bytes).into_bytes();
    if bytes.once_in(4) {
        let other = text.clone();
        for _ in 0..=bytes.below(4) {
            damage(&mut text, &other, bytes);
        }
    }
    let (text, files) = (String::from_utf8_lossy(&text), assets::files());
    // Half of them as a spec, which is loaded by the text of its MJCF.
    if bytes.once_in(2) {
        let options =
            files.iter().fold(LoadOptions::default(), |options, (name, content)| options.with_file(name, content));
        let options = if bytes.once_in(2) { options.with_visuals() } else { options };
        log(&format!("converting\n{text}\n"));
        return match Spec::from_xml_str_with(&text, &options) {
            Ok(spec) => load_and_use(&spec.to_xml(), &files, log),
            Err(_) => Verdict::Rejected,
        };
    }
    load_and_use(&text, &files, log)
}

fn robot(bytes: &mut Bytes<'_>) -> String {
    let links = 1 + bytes.below(7);
    let names: Vec<String> = (0..links).map(|index| link_name(index, bytes)).collect();
    let mut content = extension(bytes);
    for name in &names {
        content += &link(name, bytes);
    }
    for child in 1..links {
        let parent = if bytes.once_in(40) { bytes.below(links) } else { bytes.below(child) };
        content += &joint(child, &names[parent], &names[child], bytes);
    }
    if bytes.once_in(8) {
        content +=
            "<transmission name='t'><joint name='j1'/><actuator name='a'/></transmission><gazebo reference='l0'/>";
    }
    format!("<robot name='r'>{content}</robot>")
}

fn link_name(index: usize, bytes: &mut Bytes<'_>) -> String {
    match bytes.below(60) {
        56 => "world".to_owned(),
        57 => String::new(),
        58 => "l0".to_owned(),
        59 => format!("&#108;{index}"),
        _ => format!("l{index}"),
    }
}

/// Returns `valid`, or occasionally any other number.
fn number(valid: &str, bytes: &mut Bytes<'_>) -> String {
    if bytes.once_in(80) { bytes.choose(&NUMBERS).to_owned() } else { valid.to_owned() }
}

fn vector(valid: [&str; 3], bytes: &mut Bytes<'_>) -> String {
    valid.map(|valid| number(valid, bytes)).join(" ")
}

fn extension(bytes: &mut Bytes<'_>) -> String {
    if !bytes.once_in(3) {
        return String::new();
    }
    let attributes: Vec<&str> = (0..=bytes.below(3)).map(|_| bytes.choose(&COMPILER)).collect();
    let more = if bytes.once_in(2) { bytes.choose(&EXTENSIONS) } else { "" };
    format!("<mujoco><compiler {}/>{more}</mujoco>", attributes.join(" "))
}

fn link(name: &str, bytes: &mut Bytes<'_>) -> String {
    let mut content = String::new();
    if !bytes.once_in(4) {
        let [xx, yy, zz] = ["0.1", "0.1", "0.1"].map(|valid| number(valid, bytes));
        let [xy, xz, yz] = ["0", "0.01", "0"].map(|valid| number(valid, bytes));
        let _ = write!(
            content,
            "<inertial>{}<mass value='{}'/><inertia ixx='{xx}' iyy='{yy}' izz='{zz}' ixy='{xy}' ixz='{xz}' iyz='{yz}'/></inertial>",
            origin(bytes),
            number("1", bytes)
        );
    }
    for _ in 0..bytes.below(3) {
        let kind = bytes.choose(&["collision", "visual"]);
        let material = if bytes.once_in(3) { "<material name='m'><color rgba='1 0 0 1'/></material>" } else { "" };
        let _ = write!(content, "<{kind}>{}<geometry>{}</geometry>{material}</{kind}>", origin(bytes), geometry(bytes));
    }
    format!("<link name='{name}'>{content}</link>")
}

fn geometry(bytes: &mut Bytes<'_>) -> String {
    match bytes.below(16) {
        0..4 => format!("<box size='{}'/>", vector(["0.1", "0.2", "0.1"], bytes)),
        4..7 => format!("<cylinder radius='{}' length='{}'/>", number("0.1", bytes), number("0.2", bytes)),
        7..10 => format!("<sphere radius='{}'/>", number("0.1", bytes)),
        15 => bytes
            .choose(&["", "<mesh/>", "<box/>", "<mesh filename=''/>", "<mesh filename='/'/>", "<capsule radius='1'/>"])
            .to_owned(),
        _ => {
            let present = ["package://robot/meshes/t.stl", "t.obj", "t.msh", "meshes/t.stl"];
            let absent = ["missing.stl", "package://robot/t.dae", "t.png"];
            let file = if bytes.once_in(12) { bytes.choose(&absent) } else { bytes.choose(&present) };
            let scale =
                if bytes.once_in(3) { format!(" scale='{}'", vector(["1", "-1", "2"], bytes)) } else { String::new() };
            format!("<mesh filename='{file}'{scale}/>")
        }
    }
}

fn origin(bytes: &mut Bytes<'_>) -> String {
    if bytes.once_in(2) {
        return String::new();
    }
    format!("<origin xyz='{}' rpy='{}'/>", vector(["0", "0.3", "0.1"], bytes), vector(["0", "0.5", "0"], bytes))
}

fn joint(child: usize, parent: &str, link: &str, bytes: &mut Bytes<'_>) -> String {
    let kind = if bytes.once_in(30) { bytes.choose(&TYPES) } else { TYPES[bytes.below(6)] };
    let mut content = format!("<parent link='{parent}'/><child link='{link}'/>{}", origin(bytes));
    if !bytes.once_in(3) {
        let _ = write!(content, "<axis xyz='{}'/>", vector(["0", "1", "0"], bytes));
    }
    if bytes.once_in(3) {
        let (lower, upper, effort) = (number("-1", bytes), number("1", bytes), number("5", bytes));
        let _ = write!(content, "<limit lower='{lower}' upper='{upper}' effort='{effort}' velocity='1'/>");
    }
    if bytes.once_in(3) {
        let _ = write!(content, "<dynamics damping='{}' friction='{}'/>", number("0.1", bytes), number("0.1", bytes));
    }
    if bytes.once_in(40) {
        content += bytes.choose(&["<mimic joint='j1'/>", "<parent link='l0'/>", "<child/>", "<axis/>", "<limit/>"]);
    }
    let attributes = if bytes.once_in(60) {
        bytes.choose(&["", "name='j'", "type='fixed'"]).to_owned()
    } else {
        format!("name='j{child}' type='{kind}'")
    };
    format!("<joint {attributes}>{content}</joint>")
}
