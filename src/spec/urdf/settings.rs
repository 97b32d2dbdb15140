//! Settings of a URDF for MuJoCo: the elements `compiler`, `option` and `size` in `mujoco`.

use super::element::Urdf;
use super::ignored::Ignored;
use crate::error::Result;
use crate::spec::schema::Schema;
use crate::spec::tree::{Index, Tree};
use crate::spec::value::Value;

/// Attributes of `compiler` that a URDF cannot change, or that have no effect on the converted
/// model because file names are complete.
const OTHER: [&str; 7] = ["angle", "coordinate", "eulerseq", "strippath", "meshdir", "assetdir", "texturedir"];

pub(super) struct Settings {
    /// Visual geometry is kept.
    pub(super) has_visuals: bool,
    /// Links without a joint to the world become a part of it.
    pub(super) fuses: bool,
    /// Directory of the meshes.
    pub(super) folder: String,
    /// The directories in the names of files do not count.
    pub(super) strips: bool,
}

/// Writes the sections `compiler`, `option` and `size`.
pub(super) fn write(urdf: Urdf<'_>, mjcf: &mut Tree, has_visuals: bool, ignored: &mut Ignored) -> Result<Settings> {
    let mujoco = urdf.child(Tree::ROOT, "mujoco")?;
    let section = |tag: &str| mujoco.map_or(Ok(None), |mujoco| urdf.child(mujoco, tag));
    let source = section("compiler")?;
    let given = |attribute: &str| source.and_then(|compiler| urdf.text(compiler, attribute));
    let compiler = match source {
        Some(source) => copy(urdf, source, mjcf, ignored)?,
        None => mjcf.add(Tree::ROOT, "compiler"),
    };
    if given("coordinate").is_some_and(|value| value != "local") {
        ignored.add("'coordinate' of <compiler>");
    }
    let node = mjcf.node_mut(compiler);
    for attribute in OTHER {
        node.unset(attribute);
    }
    node.set("angle", "radian".to_owned());
    node.set("eulerseq", "XYZ".to_owned());
    for attribute in ["autolimits", "fusestatic"] {
        if node.attribute(attribute).is_none() {
            node.set(attribute, true.text().into_owned());
        }
    }
    let has_visuals = has_visuals || given("discardvisual") == Some("false");
    if has_visuals {
        node.unset("discardvisual");
    }
    for tag in ["option", "size"] {
        if let Some(source) = section(tag)? {
            copy(urdf, source, mjcf, ignored)?;
        }
    }
    Ok(Settings {
        has_visuals,
        fuses: mjcf.attribute(compiler, "fusestatic") == Some("true"),
        folder: given("meshdir").or(given("assetdir")).unwrap_or_default().to_owned(),
        strips: given("strippath") == Some("true"),
    })
}

/// Copies a section without the attributes and elements that the engine does not know, which its
/// reader of URDF ignores.
fn copy(urdf: Urdf<'_>, source: Index, mjcf: &mut Tree, ignored: &mut Ignored) -> Result<Index> {
    let schema = Schema::of_engine()?;
    let section = mjcf.copy(urdf.tree, source, Tree::ROOT);
    for index in mjcf.descendants(section) {
        if !mjcf.contains(index) {
            continue;
        }
        let tag = mjcf.tag(index).to_owned();
        let Some(known) = schema.attributes(mjcf, index) else {
            ignored.add(&format!("<{tag}> in <mujoco>"));
            mjcf.remove(index);
            continue;
        };
        let attributes = &mut mjcf.node_mut(index).attributes;
        attributes.retain(|(name, _)| {
            let is_known = known.contains(&&name[..]) || OTHER.contains(&&name[..]);
            if !is_known {
                ignored.add(&format!("'{name}' of <{tag}>"));
            }
            is_known
        });
    }
    Ok(section)
}
