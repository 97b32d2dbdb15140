//! Settings of a URDF for MuJoCo: the elements `compiler`, `option` and `size` in `mujoco`.

use super::element::{Urdf, abbreviated};
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
    // The compiler does not see these attributes.
    for (attribute, words) in
        [("strippath", ["false", "true"]), ("angle", ["degree", "radian"]), ("coordinate", ["local", "global"])]
    {
        if let Some(found) = given(attribute).filter(|found| !words.contains(found)) {
            let [a, b] = words;
            let found = abbreviated(found);
            return Err(
                urdf.error(format!("'{attribute}' of <compiler> in <mujoco> is '{found}' instead of {a} or {b}"))
            );
        }
    }
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
    let section = mjcf.add(Tree::ROOT, urdf.tree.tag(source));
    let mut open = vec![(source, section)];
    while let Some((source, copy)) = open.pop() {
        let tag = urdf.tree.tag(source);
        let known = schema.attributes(mjcf, copy).unwrap_or_default();
        for (name, value) in &urdf.tree.node(source).attributes {
            if known.contains(&&name[..]) || OTHER.contains(&&name[..]) {
                mjcf.node_mut(copy).attributes.push((name.clone(), value.clone()));
            } else {
                ignored.add(&format!("'{name}' of <{tag}>"));
            }
        }
        let children = urdf.tree.children(source);
        let known = if children.is_empty() { Vec::new() } else { schema.children(mjcf, copy) };
        for &child in children {
            let tag = urdf.tree.tag(child);
            if known.contains(&tag) {
                open.push((child, mjcf.add(copy, tag)));
            } else {
                ignored.add(&format!("<{tag}> in <mujoco>"));
            }
        }
    }
    Ok(section)
}
