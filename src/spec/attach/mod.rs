//! Attachment of a spec to another one.

mod angles;
mod classes;
mod computed;
mod inertia;
mod initial;
mod pose;
mod positions;
mod settings;
mod units;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

pub(super) use self::classes::{defaults_of, effective, flexcomp_in, heirs, inseparable, separate_own};
pub(super) use self::initial::Defaults;
pub(super) use self::positions::resolved;
use self::units::Angles;
use super::attributes::Named;
use super::element_id::{ElementId, name_or_create};
use super::names::{self, Names, WORLD};
use super::schema::Schema;
use super::tree::{Index, Tree};
use super::value::Value;
use super::{Spec, attributes, keyframes, paths};
use crate::error::{Error, InvalidKind, Result};
use crate::kind::{self, Kind};
use crate::math::{self, Pose};

/// Place at which [`Spec::attach`] puts the world of another spec: a body or a site, and a pose in
/// its frame.
#[derive(Clone, Copy, Debug)]
pub struct Mount {
    place: Place,
    pose: Pose,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Body(ElementId<kind::Body>),
    Site(ElementId<kind::Site>),
}

impl Mount {
    /// Returns the place at the frame of a body, which may be the world.
    pub fn body(body: ElementId<kind::Body>) -> Self {
        Self { place: Place::Body(body), pose: Pose::default() }
    }

    /// Returns the place at the frame of a site, in the body of the site.
    pub fn site(site: ElementId<kind::Site>) -> Self {
        Self { place: Place::Site(site), pose: Pose::default() }
    }

    /// Sets the position, metres, in the frame of the body or site.
    #[must_use]
    pub fn with_pos(mut self, pos: [f64; 3]) -> Self {
        self.pose.pos = pos;
        self
    }

    /// Sets the orientation in the frame of the body or site. It is normalised.
    #[must_use]
    pub fn with_quat(mut self, mut quat: [f64; 4]) -> Self {
        math::normalize4(&mut quat);
        self.pose.quat = quat;
        self
    }
}

/// Sections whose elements are copied. The order does not matter to the compiler.
const COPIED: [&str; 11] = [
    "default",
    "extension",
    "custom",
    "asset",
    "contact",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "deformable",
    "keyframe",
];

/// # Attachment
impl Spec {
    /// Attaches another spec: adds copies of the elements of its world to a body, and copies of its
    /// other elements, with `prefix` before all names. Returns the ids of the bodies that were in
    /// its world, also in frames.
    ///
    /// The attached elements keep the defaults, angles, limits and directories of their own spec:
    /// classes of defaults are copied, angles are converted if the unit or the order of Euler
    /// angles differs, limits become explicit if `autolimits` differs, and names of files become
    /// independent of `meshdir` and `texturedir`. A joint position is an angle or a length by the
    /// type that the joint has when the text is written, also if a class sets the position or the
    /// type, and for joints that are added later. Defaults in `main` of this spec, also later ones
    /// by [`default_mut`](Self::default_mut) and [`section_mut`](Self::section_mut), move to a
    /// class of their own, which its elements get, also those that are added later.
    ///
    /// References to the world become references to the body, and anchors of constraints in the
    /// world move with the pose. Keyframes are copied, and the values of each follow their elements
    /// (see [the module](super#keyframes)): in a keyframe of one spec, the elements of the other
    /// one have their initial values. Free joints and mocap bodies keep their values, which are in
    /// the frame of the world. Options, statistics, visualiser settings and sizes of the other spec
    /// are not copied. The settings of `compiler` that concern the model as a whole, such as
    /// `fusestatic`, `discardvisual` and `lengthrange`, are taken from this spec.
    ///
    /// The settings of `compiler` that concern inertia and meshes are those of this spec. A spec
    /// without bodies, or without meshes, takes them from the first spec that is attached. The
    /// bodies of other specs keep the mass and inertia of their own settings: if the text alone
    /// does not determine these, the attached spec is compiled, and its bodies get an `<inertial>`,
    /// which geoms that are added later do not change. A spec without meshes may differ in the
    /// settings of meshes, one without free joints in `alignfree`. A total mass that this spec sets
    /// (`settotalmass`) is that of the whole model.
    ///
    /// An error, which names the setting, is all else: a bound of this spec that would change an
    /// attached body, `inertiafromgeom="true"` of this spec beside explicit inertias, other
    /// settings of inertia beside elements that create bodies (`composite`, `flexcomp`, `attach`),
    /// inertias of files in memory, and `settotalmass` of the attached spec.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`], and this spec is unchanged, if a name exists already, also that of a
    /// keyframe, if the bodies depend on settings that differ, or if a pose or an angle is not a
    /// list of numbers. [`Error::Unsupported`] if an element cannot be moved to the pose, or has an
    /// attribute that only engines newer than the supported ones have, or for a prefix and a skin
    /// whose file names bodies. The pose must be the pose of the body for elements that refer to
    /// the frame of the world: vertices of flexes, bones of skins, targets of cameras and lights,
    /// frames of sensors, and `relpose`.
    ///
    /// # Panics
    ///
    /// If the body or site of `mount` belongs to another spec, or was removed.
    ///
    /// ```
    /// use mujoco_safe::spec::{Mount, Spec};
    ///
    /// let pole = Spec::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/models/cartpole.xml"))?;
    /// let mut scene = Spec::new("two carts");
    /// let world = Mount::body(scene.world());
    /// scene.attach(&pole, world, "near_")?;
    /// scene.attach(&pole, world.with_pos([0.0, 2.0, 0.0]), "far_")?;
    /// let model = scene.compile()?;
    /// assert_eq!(model.nv(), 4);
    /// assert!(model.joint("far_hinge").is_ok());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_attach")]
    #[track_caller]
    pub fn attach(&mut self, other: &Self, mount: Mount, prefix: &str) -> Result<Vec<ElementId<kind::Body>>> {
        let (body, pose) = self.mounted(mount)?;
        let mut tree = self.tree.clone();
        let mut child = other.tree.clone();

        let is_changed = body != self.world
            || pose != Pose::default()
            || !prefix.is_empty()
            || Angles::of(&child) != Angles::of(&tree)
            || settings::are_limits_automatic(&child) != settings::are_limits_automatic(&tree);
        if is_changed {
            check_known(&child)?;
        }
        check_prefix(&child, prefix)?;
        settings::agree(&mut tree, &mut child, other)?;
        Angles::of(&child).convert(&mut child, &Angles::of(&tree))?;
        if child.descendants(Tree::ROOT).iter().any(|&index| paths::is_asset(&child, index)) {
            paths::resolve(&mut tree, None);
            paths::resolve(&mut child, self.foreign_directory(other).as_deref());
        }
        let body_name = if body == self.world { WORLD.to_owned() } else { name_or_create(&mut tree, body, BODY) };
        move_anchors(&mut child, &pose)?;
        refer_to_frame(&mut child, &body_name, &pose)?;
        let own_class = classes::separate(&mut tree, &mut child, body, prefix)?;
        add_prefix(&mut child, prefix, &body_name);
        if let Some((class, name)) = shared_name(&tree, &child) {
            let what = format!("the prefix '{prefix}' of the attached {}", other.source_name());
            return Err(Error::invalid(
                InvalidKind::Duplicate,
                what,
                format!("not unique: the {class} '{name}' exists"),
                "another text",
            ));
        }

        let angles = Angles::of(&tree);
        let worlds: Vec<Index> = child.sections("worldbody").collect();
        let elements: Vec<Index> = worlds.into_iter().flat_map(|world| child.children(world).to_vec()).collect();
        let mut bodies = Vec::new();
        let mut attached = self.attached.clone();
        let mut copies = HashMap::new();
        for element in elements {
            let element = pose::moved(&mut child, element, &pose, &angles)?;
            let copy = tree.copy_into(&child, element, body, &mut copies);
            attached.insert(copy);
            let mut open = vec![copy];
            while let Some(index) = open.pop() {
                match tree.tag(index) {
                    "body" => bodies.push(index),
                    "frame" => open.extend(tree.children(index).iter().rev()),
                    _ => {}
                }
            }
        }
        for section in COPIED {
            let elements = child.sections(section).flat_map(|index| child.children(index)).copied();
            for element in elements {
                let section = tree.section(section);
                let copy = tree.copy_into(&child, element, section, &mut copies);
                keyframes::map_owners(&mut tree, copy, &copies);
                attached.insert(copy);
            }
        }
        self.tree = tree;
        self.attached = attached;
        self.own_class = own_class.or(self.own_class);
        self.unpacked.extend_from_slice(&other.unpacked);
        Ok(bodies.into_iter().map(|index| self.id(index)).collect())
    }

    /// Returns the body and the pose in its frame.
    #[track_caller]
    fn mounted(&self, mount: Mount) -> Result<(Index, Pose)> {
        let site = match mount.place {
            Place::Body(body) => return Ok((self.index(body), mount.pose)),
            Place::Site(site) => self.index(site),
        };
        let frame = pose::of(&self.tree, site, &Angles::of(&self.tree))?;
        let pose = math::mul_pose(&frame, &mount.pose);
        // A frame or a copy (`replicate`) has a pose of its own.
        match self.tree.parent(site) {
            Some(body) if matches!(self.tree.tag(body), "body" | "worldbody") => Ok((body, pose)),
            _ => {
                let site = names::describe(&self.tree, site);
                Err(Error::Unsupported(format!("cannot attach a spec to {site}, which is not directly in a body")))
            }
        }
    }

    /// Returns the directory of another spec if it is not the one of this spec.
    fn foreign_directory(&self, other: &Self) -> Option<PathBuf> {
        let of = |spec: &Self| {
            let directory = spec.directory.as_deref().filter(|path| !path.as_os_str().is_empty());
            std::path::absolute(directory.unwrap_or(Path::new("."))).ok()
        };
        of(other).filter(|directory| of(self).as_ref() != Some(directory))
    }
}

const BODY: Named = Named::Kind(Kind::Body);

/// Returns an error if an element has an attribute of a newer engine, which may be a name, an
/// angle, a limit or a place in the world.
fn check_known(child: &Tree) -> Result<()> {
    let sections = COPIED.iter().chain(&["worldbody"]).flat_map(|tag| child.sections(tag));
    for index in sections.flat_map(|section| child.descendants(section)) {
        if let Some(attribute) = attributes::unknown(child, index).next() {
            let element = names::describe(child, index);
            return Err(Error::Unsupported(format!(
                "cannot attach {element}: attribute '{attribute}' is not known here and may be a name, an angle, a limit or a place in the world"
            )));
        }
    }
    Ok(())
}

/// Returns an error if names with the prefix would be other names in a text.
fn check_prefix(child: &Tree, prefix: &str) -> Result<()> {
    let invalid = |expected: &str| {
        Err(Error::invalid(InvalidKind::Text, "the prefix of the attached spec", format!("{prefix:?}"), expected))
    };
    if prefix.contains('\0') {
        return invalid("a text without NUL");
    }
    let has_list = || child.descendants(Tree::ROOT).into_iter().any(|index| names::has_list(child, index));
    if prefix.contains(|character: char| character.is_ascii_whitespace()) && has_list() {
        return invalid("a text without spaces, which separate the names in the lists of <flex>");
    }
    let mut elements = child.descendants(Tree::ROOT).into_iter();
    let with_file = |index: &Index| child.tag(*index) == "skin" && child.attribute(*index, "file").is_some();
    if let Some(skin) = elements.find(with_file).filter(|_| !prefix.is_empty()) {
        let skin = names::describe(child, skin);
        return Err(Error::Unsupported(format!(
            "cannot put a prefix before the names of bodies in the file of {skin}"
        )));
    }
    Ok(())
}

/// Moves the anchors of constraints in the world, and makes the world explicit in constraints
/// without a second body.
fn move_anchors(child: &mut Tree, pose: &Pose) -> Result<()> {
    let is_moved = *pose != Pose::default();
    let constraints: Vec<Index> =
        child.sections("equality").flat_map(|section| child.children(section).to_vec()).collect();
    for index in constraints {
        let node = child.node(index);
        let is_weld = node.tag == "weld";
        let [first, second] = ["body1", "body2"].map(|name| node.attribute(name).unwrap_or(WORLD) == WORLD);
        let connects = (is_weld || node.tag == "connect") && node.attribute("body1").is_some();
        if !connects || !(first || second) {
            continue;
        }
        if is_moved && node.attribute("relpose").is_some() {
            return Err(in_world(child, index, "relpose"));
        }
        // The anchor is in the frame of the first body, or for a weld in the frame of the second
        // one.
        let is_in_world = if is_weld { second } else { first };
        if is_moved && is_in_world {
            let anchor = pose::triple(child, index, "anchor")?.or(is_weld.then_some([0.0; 3]));
            if let Some(anchor) = anchor {
                let anchor = math::trn_vec_pose(pose, &anchor);
                child.node_mut(index).set("anchor", anchor.text().into_owned());
            }
        }
        if child.attribute(index, "body2").is_none() {
            child.node_mut(index).set("body2", WORLD.to_owned());
        }
    }
    Ok(())
}

/// Makes references to the frame of the world references to the same frame of `body`. A body has no
/// frame at a pose.
fn refer_to_frame(child: &mut Tree, body: &str, pose: &Pose) -> Result<()> {
    let world = Names::from([(WORLD.to_owned(), vec![BODY])]);
    for index in child.descendants(Tree::ROOT) {
        let found = names::references(child, index).into_iter();
        let found = found.filter(|found| found.is_frame && found.refers_to(child, index, &world));
        for attribute in found.map(|found| found.attribute.to_owned()).collect::<Vec<_>>() {
            if *pose != Pose::default() {
                return Err(in_world(child, index, &attribute));
            }
            // Of other bodies than the world, `body` is the inertial frame. Plugins interpret the
            // type themselves.
            let kind = attribute.replace("name", "type");
            if body != WORLD && child.tag(index) != "plugin" && child.attribute(index, &kind) == Some("body") {
                child.node_mut(index).set(&kind, "xbody".to_owned());
            }
        }
    }
    Ok(())
}

fn in_world(child: &Tree, index: Index, attribute: &str) -> Error {
    let element = names::describe(child, index);
    Error::Unsupported(format!(
        "cannot move {element}, whose '{attribute}' is in the frame of the world; give it a body in place of the world"
    ))
}

/// Puts a prefix before all names and references. References to the world become references to
/// `body`.
fn add_prefix(child: &mut Tree, prefix: &str, body: &str) {
    names::map_references(child, &mut |class, name| {
        let is_world = class == BODY && name == WORLD;
        Some(if is_world { body.to_owned() } else { format!("{prefix}{name}") })
    });
    let elements: Vec<Index> =
        child.sections("worldbody").chain(COPIED.iter().flat_map(|tag| child.sections(tag))).collect();
    let elements: Vec<Index> = elements.into_iter().flat_map(|section| child.descendants(section)).collect();
    for index in elements {
        if child.tag(index) == "worldbody" || (child.tag(index) == "default" && child.parent(index) == Some(Tree::ROOT))
        {
            continue;
        }
        if let Some((class, name)) = names::named(child, index).zip(names::name(child, index)) {
            let name = format!("{prefix}{name}");
            child.node_mut(index).set(names::name_attribute(class), name);
        }
        // The names of the elements that these create start with an attribute.
        if matches!(child.tag(index), "composite" | "attach") {
            let name = format!("{prefix}{}", child.attribute(index, "prefix").unwrap_or_default());
            child.node_mut(index).set("prefix", name);
        }
    }
}

/// Returns the class of names and a name that both trees have.
fn shared_name(tree: &Tree, child: &Tree) -> Option<(Named, String)> {
    let all = |tree: &Tree| {
        let elements = tree.descendants(Tree::ROOT).into_iter();
        let named = elements.filter(|&index| tree.tag(index) != "worldbody");
        let named = named.filter(|&index| !(tree.tag(index) == "default" && tree.parent(index) == Some(Tree::ROOT)));
        let named = named.filter_map(|index| Some((names::named(tree, index)?, names::name(tree, index)?.to_owned())));
        named.collect::<Vec<_>>()
    };
    let known: std::collections::HashSet<(String, String)> =
        all(tree).into_iter().map(|(class, name)| (class.to_string(), name)).collect();
    all(child).into_iter().find(|(class, name)| known.contains(&(class.to_string(), name.clone())))
}

/// Returns `true` if the compiler accepts a class of defaults for an element.
fn has_class(tree: &Tree, index: Index) -> Result<bool> {
    Ok(Schema::of_engine()?.has(tree, index, "class"))
}
