//! Model of an arm of 56 meshes, each a surface of revolution with grooves. Its files are too large
//! for the repository.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::Result;

/// Number of links.
const LINKS: usize = 8;
/// Meshes of each link.
const PARTS: usize = 7;
/// Vertices around each mesh, and along it.
const AROUND: usize = 48;
const ALONG: usize = 40;

/// Folder with the model `arm.xml`, which is removed when this value is dropped.
pub struct Arm(tempfile::TempDir);

impl Arm {
    pub fn create() -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let (mut assets, mut bodies) = (String::new(), String::new());
        for link in 0..LINKS {
            let pos = if link == 0 { "0 0 .1" } else { "0 0 .22" };
            write!(bodies, r#"<body pos="{pos}" euler="{} 0 {}"><joint axis="1 0 0"/>"#, 14 + link, 20 * link)?;
            for part in 0..PARTS {
                let name = format!("m{link}_{part}");
                fs::write(folder.path().join(&name).with_extension("obj"), mesh(link, part)?)?;
                let [red, green] = [link as f64 / LINKS as f64, part as f64 / PARTS as f64];
                write!(assets, r#"<mesh file="{name}.obj"/>"#)?;
                let turn = TAU * part as f64 / PARTS as f64;
                let (x, y) = if part == 0 { (0.0, 0.0) } else { (0.06 * turn.cos(), 0.06 * turn.sin()) };
                let z = 0.02 * part as f64;
                write!(
                    bodies,
                    r#"<geom type="mesh" mesh="{name}" pos="{x} {y} {z}" rgba="{red} {green} .6 1" contype="0" conaffinity="0"/>"#
                )?;
            }
        }
        bodies.push_str(&"</body>".repeat(LINKS));
        let xml = format!(
            r#"<mujoco><statistic extent="1" center="0 0 .6"/><asset>{assets}</asset><worldbody>
               <light pos="0 -1 3" dir="0 .3 -1" cutoff="60"/><geom type="plane" size="2 2 .2" rgba=".5 .5 .5 1"/>
               {bodies}</worldbody></mujoco>"#
        );
        fs::write(folder.path().join("arm.xml"), xml)?;
        Ok(Self(folder))
    }

    pub fn folder(&self) -> &Path {
        self.0.path()
    }
}

/// Returns the mesh of a part as a Wavefront file.
fn mesh(link: usize, part: usize) -> Result<String> {
    let mut text = String::new();
    let scale = if part == 0 { 1.0 } else { 0.4 };
    for (row, column) in (0..=ALONG).flat_map(|row| (0..AROUND).map(move |column| (row, column))) {
        let (along, turn) = (row as f64 / ALONG as f64, TAU * column as f64 / AROUND as f64);
        let grooves = 1.0 + 0.08 * (TAU * along * (2 + part) as f64).sin() + 0.04 * ((3 + link) as f64 * turn).cos();
        let radius = scale * 0.05 * grooves * (along * (1.0 - along)).sqrt().max(0.02) * 2.0;
        writeln!(text, "v {} {} {}", radius * turn.cos(), radius * turn.sin(), scale * 0.22 * along)?;
    }
    let index = |row: usize, column: usize| 1 + row * AROUND + column % AROUND;
    for (row, column) in (0..ALONG).flat_map(|row| (0..AROUND).map(move |column| (row, column))) {
        let corners = [index(row, column), index(row, column + 1), index(row + 1, column + 1), index(row + 1, column)];
        writeln!(
            text,
            "f {} {} {}\nf {} {} {}",
            corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]
        )?;
    }
    Ok(text)
}
