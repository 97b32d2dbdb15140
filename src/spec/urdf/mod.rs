//! Conversion of URDF to MJCF.
//!
//! The result has the elements that the engine's own reader of URDF creates. What the engine cannot
//! represent is a [`UrdfWarning`]. The modules are the parts of a URDF: `links` (the tree),
//! `joints`, `inertial`, `geometry`, `meshes` (files), `settings` (the element `mujoco`); `ignored`
//! finds the other elements.

mod element;
mod geometry;
mod ignored;
mod inertial;
mod joints;
mod links;
mod meshes;
mod settings;
mod warning;

use std::path::Path;

use self::element::Urdf;
use self::geometry::Geometry;
use self::ignored::Ignored;
use self::inertial::{inertial, pose};
use self::links::{Links, Type};
use self::meshes::Files;
pub use self::warning::UrdfWarning;
use super::schema::Schema;
use super::tree::{Index, Tree};
use crate::error::Result;
use crate::model::LoadOptions;

/// Attributes of an element of MJCF.
type Attributes = Vec<(&'static str, String)>;

/// Returns `true` if a text is a URDF. The engine ignores the case of the root's tag.
pub(super) fn is_urdf(tree: &Tree) -> bool {
    tree.tag(Tree::ROOT).eq_ignore_ascii_case("robot")
}

/// Converts a URDF from a directory, or from memory.
pub(super) fn convert(
    urdf: &Tree,
    source_name: &str,
    directory: Option<&Path>,
    options: &LoadOptions<'_>,
) -> Result<(Tree, Vec<UrdfWarning>)> {
    let urdf = Urdf { tree: urdf, source_name };
    let template =
        urdf.tree.descendants(Tree::ROOT).into_iter().find(|&index| urdf.tree.tag(index).starts_with("xacro:"));
    if let Some(found) = template {
        let tag = urdf.tree.tag(found);
        return Err(urdf.error(format!("the text is a template with <{tag}>: expand it with the program xacro")));
    }
    let mut mjcf = Tree::new("mujoco");
    if let Some(name) = urdf.text(Tree::ROOT, "name").filter(|name| !name.is_empty()) {
        mjcf.node_mut(Tree::ROOT).set("model", name.to_owned());
    }
    let mut ignored = Ignored::default();
    let settings = settings::write(urdf, &mut mjcf, options.has_visuals, &mut ignored)?;
    let links = Links::read(urdf)?;
    let mut warnings = Vec::new();

    let files = Files { directory, options, folder: settings.folder, strips: settings.strips };
    let mut geometry = Geometry::new(urdf, files, settings.has_visuals)?;
    let geoms = links.all.iter().map(|link| geometry.geoms(link, &mut warnings)).collect::<Result<Vec<_>>>()?;
    if geometry.visuals > 0 {
        warnings.push(UrdfWarning::Visuals { count: geometry.visuals });
    }
    if !geometry.meshes.attributes.is_empty() {
        let asset = mjcf.add(Tree::ROOT, "asset");
        for attributes in geometry.meshes.attributes {
            add(&mut mjcf, asset, "mesh", attributes);
        }
    }

    add_bodies(urdf, &mut mjcf, &links, geoms, settings.fuses, &mut warnings)?;
    let equalities = joints::equalities(urdf, &links.joints, &mut warnings)?;
    if !equalities.is_empty() {
        let section = mjcf.add(Tree::ROOT, "equality");
        for attributes in equalities {
            add(&mut mjcf, section, "joint", attributes);
        }
    }
    ignored.add_elements(urdf.tree);
    warnings.extend(ignored.into_warnings());
    Ok((mjcf, warnings))
}

/// Adds the bodies of the links, with the geoms of each link.
fn add_bodies(
    urdf: Urdf<'_>,
    mjcf: &mut Tree,
    links: &Links<'_>,
    mut geoms: Vec<Vec<Attributes>>,
    fuses: bool,
    warnings: &mut Vec<UrdfWarning>,
) -> Result<()> {
    let world = mjcf.add(Tree::ROOT, "worldbody");
    let has_effort = has_effort()?;
    let mut bodies = vec![world; links.all.len()];
    // The root to which a link is fixed, and the mass that is fixed to each root.
    let mut roots: Vec<Option<usize>> = vec![None; links.all.len()];
    let mut masses = vec![0.0; links.all.len()];
    for &number in &links.order {
        let link = &links.all[number];
        let joint = link.joint.map(|joint| &links.joints[joint]);
        roots[number] = match joint {
            None => Some(number),
            Some(joint) => roots[joint.parent].filter(|_| joint.of_type == Type::Fixed),
        };
        if !link.is_world() {
            let parent = joint.map_or(world, |joint| bodies[joint.parent]);
            let mut attributes = Attributes::new();
            attributes.extend((!link.name.is_empty()).then(|| ("name", link.name.to_owned())));
            if let Some(joint) = joint {
                attributes.extend(pose(urdf, joint.element)?);
            }
            bodies[number] = add(mjcf, parent, "body", attributes);
        }
        if let Some(found) = inertial(urdf, link.element)? {
            if let Some(root) = roots[number] {
                masses[root] += found.mass;
            }
            if !found.has_moments {
                warnings.push(UrdfWarning::NoInertia { link: link.name.to_owned() });
            }
            if !link.is_world() {
                add(mjcf, bodies[number], "inertial", found.attributes);
            }
        }
        let has_mass = |geom: &Attributes| !geom.contains(&("density", "0".to_owned()));
        if urdf.child(link.element, "inertial")?.is_none()
            && roots[number].is_none()
            && geoms[number].iter().any(has_mass)
        {
            warnings.push(UrdfWarning::Density { link: link.name.to_owned() });
        }
        if let Some(joint) = joint {
            for attributes in joints::joints(urdf, joint, has_effort, warnings)? {
                add(mjcf, bodies[number], "joint", attributes);
            }
        }
        for attributes in std::mem::take(&mut geoms[number]) {
            add(mjcf, bodies[number], "geom", attributes);
        }
    }
    // A joint to the link 'world' says that its child does not move.
    let fixed = (0..masses.len()).filter(|&root| fuses && masses[root] > 0.0 && !links.all[root].is_world());
    warnings.extend(
        fixed.map(|number| UrdfWarning::FixedMass { link: links.all[number].name.to_owned(), mass: masses[number] }),
    );
    Ok(())
}

/// Returns `true` if the engine limits the forces of joints.
fn has_effort() -> Result<bool> {
    let mut tree = Tree::new("mujoco");
    let world = tree.section("worldbody");
    let body = tree.add(world, "body");
    let joint = tree.add(body, "joint");
    Ok(Schema::of_engine()?.has(&tree, joint, joints::EFFORT))
}

fn add(mjcf: &mut Tree, parent: Index, tag: &str, attributes: Attributes) -> Index {
    let index = mjcf.add(parent, tag);
    let attributes = attributes.into_iter().map(|(name, value)| (name.to_owned(), value));
    mjcf.node_mut(index).attributes.extend(attributes);
    index
}
