//! Models in code: a [`Spec`] is an MJCF model that a program builds, reads, edits, joins with
//! others, and compiles.
//!
//! ```
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
//!
//! // A link with a hinge and a motor.
//! let mut arm = Spec::new("arm");
//! let upper = arm.add_body(arm.world()).set_name("upper").id();
//! arm.add_joint(upper).set_name("shoulder").set_axis([0.0, 1.0, 0.0]);
//! arm.add_geom(upper).set_type(GeomType::Capsule).set_fromto([0.0, 0.0, 0.0, 0.3, 0.0, 0.0]).set_size(&[0.03]);
//! arm.add_actuator(ActuatorElement::Motor).set_name("torque").set_joint("shoulder");
//!
//! // Two of them on a stand.
//! let mut robot = Spec::new("robot");
//! let stand = robot.add_body(robot.world()).set_name("stand").set_pos([0.0, 0.0, 1.0]).id();
//! robot.add_geom(stand).set_type(GeomType::Box).set_size(&[0.1, 0.2, 0.02]);
//! robot.attach(&arm, Mount::body(stand).with_pos([0.0, 0.2, 0.0]), "left_")?;
//! robot.attach(&arm, Mount::body(stand).with_pos([0.0, -0.2, 0.0]), "right_")?;
//!
//! let model = robot.compile()?;
//! assert_eq!((model.nbody(), model.nv(), model.nu()), (4, 2, 2));
//! let shoulder = model.joint("left_shoulder")?;
//! assert_eq!(shoulder.axis(), &[0.0, 1.0, 0.0]);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Relation to `mjSpec`
//!
//! A spec is a tree of MJCF elements, and [`Spec::compile`] writes it as text and compiles the text
//! as [`Model::from_xml_str`] does. So it works with every engine, also with those before 3.2,
//! which have no `mjSpec`, and the checks of untrusted texts apply to it. The differences from
//! `mjSpec`: attributes have the names and units of MJCF (angles are in degrees unless `compiler`
//! says otherwise), and vertices of meshes and pixels of textures are files, which can be in memory
//! ([`LoadOptions`]).
//!
//! # URDF
//!
//! A spec reads URDF too, as MJCF with the same links, joints and geoms: see the page
//! [`urdf`](crate::guide::urdf) of the guide. [`Spec::urdf_warnings`] lists what is left out.
//!
//! # Elements
//!
//! `add_…` methods create elements, and `set_…` methods set their attributes. Attributes without a
//! method are set by [`ElementMut::set`], which checks their names against the schema of the
//! engine. Each element has an [`ElementId`], which stays valid until the element is removed.
//! Elements are looked up by name or id, as in a [`Model`]: `spec.geom("foot")?`,
//! `spec.geom_mut(id)`.
//!
//! The methods do not check values: the compiler does, and its error names the element.
//!
//! # Keyframes
//!
//! The values of a keyframe (`qpos`, `qvel`, `act`, `ctrl`, `mpos`, `mquat`) are set as vectors, in
//! the order that the compiler gives the elements that the spec has at that time: bodies with those
//! in them before the next body, the joints of a body in the order of the text, then actuators.
//! Later they follow their elements: the values of a removed element are removed, and a new one has
//! those of the initial configuration, also in the middle: the reference position of a joint, the
//! pose of a free or mocap body, otherwise 0. Missing values at the end of a vector are these too.
//! An element whose number of values changes, such as a hinge that becomes a ball, counts as new.
//! [`Spec::compile`] and [`Spec::to_xml`] write the vectors for the present elements, and
//! [`Element::numbers`] returns them.
//!
//! ```
//! use mujoco_safe::spec::Spec;
//!
//! let mut spec = Spec::from_xml_str(
//!     "<mujoco>
//!        <worldbody>
//!          <body name='left'><joint/><geom size='.1'/></body>
//!          <body name='right' pos='1 0 0'><joint/><geom size='.1'/></body>
//!        </worldbody>
//!        <keyframe><key name='home' qpos='.1 .2'/></keyframe>
//!      </mujoco>",
//! )?;
//! let left = spec.body("left")?.id();
//! spec.remove(left)?;
//! assert_eq!(spec.compile()?.keyframe("home")?.qpos(), [0.2]);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Only the compiler knows how many values the elements have that `composite`, `flexcomp` and
//! `attach` create, how many activations and controls plugins and the actuators `pid`,
//! `orientation` and `dcmotor` have, and the pose of a new free or mocap body in `replicate` and of
//! a new free body that is aligned with its inertia. If such an element is new, the vector ends
//! before it, and newer engines (3.5.0, not 2.2.2) pad it. Those before 3.16 pad some joints that
//! do not start at 0 wrongly, so with 3.5.0 such a joint is an error there. An element counts as
//! new if its attributes change in a way that may change its number of values; other contents of
//! its files are not noticed. The values from the first such element to the end of a vector stay
//! together. This holds for all actuators if one may drive an element that another one creates in a
//! `replicate`, and with engines before 3.17 beside any `replicate`. If values cannot be placed by
//! these rules, because one comes after a new element of this kind, for example, or if a vector was
//! set with more values than the spec had, `compile` returns an error after a change of the
//! elements, until the vector is set again. `plastic` stays as it is.
//!
//! # Texts
//!
//! A spec reads XML, and as the engine's reader does also `--` in comments, `&` and `<` in values
//! of attributes, a `<!DOCTYPE>`, blanks before the declaration, and elements after the root, which
//! are ignored. An exception is `&` after a reference (`&lt;`) in the same value, in whose place
//! the engine reads another character.
//!
//! The elements that `replicate`, `composite`, `flexcomp` and `attach` create have no id in a spec,
//! because the compiler creates them. [`Model`] has them, with their names, and
//! [`Spec::expanded`] returns a spec with them.

mod add;
#[cfg(feature = "mjz")]
mod archive;
mod attach;
mod attributes;
mod compile;
mod control;
mod copies;
mod element;
mod element_id;
mod expand;
mod free_base;
mod identity;
mod keyframes;
mod layout;
mod lenient;
mod lineages;
mod motors;
mod names;
mod paths;
mod read;
mod remove;
mod save;
mod schema;
mod setters;
mod text;
mod tree;
mod urdf;
mod value;

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::TempDir;

pub use self::add::ActuatorElement;
pub use self::attach::Mount;
use self::attributes::Named;
pub use self::element::{Element, ElementMut};
pub use self::element_id::{Any, ElementId, IntoElementId, Reference, SpecKind};
use self::lineages::Lineages;
use self::read::Sources;
use self::schema::Schema;
use self::tree::{Index, Tree};
pub use self::urdf::UrdfWarning;
pub use self::value::Value;
use crate::error::{Error, InvalidKind, Result};
use crate::file;
use crate::kind;
use crate::macros::with_aliases;
use crate::model::LoadOptions;
#[cfg(doc)]
use crate::model::Model;

with_aliases! {
    pub use self::value::{SensorFrame = "objtype", TexturePattern = "mjtBuiltin" "builtin"};
}

/// Editable description of a model. See the [module](self).
///
/// A clone has the same elements with the same ids. An element that is added later, to the spec or
/// to the clone, belongs to one of them only.
#[doc(alias = "mjSpec")]
#[doc(alias = "mj_makeSpec")]
#[doc(alias = "mj_copySpec")]
#[doc(alias = "mj_deleteSpec")]
pub struct Spec {
    tree: Tree,
    lineages: Lineages,
    world: Index,
    /// Directory of the file, to which the names of assets are relative.
    directory: Option<PathBuf>,
    /// Class with the defaults of `main`, if an attachment has separated them from the defaults of
    /// the attached spec.
    own_class: Option<Index>,
    /// Elements in the world, in bodies and in sections that attachments have copied.
    attached: HashSet<Index>,
    /// Warnings about the URDF from which the spec was read.
    warnings: Vec<UrdfWarning>,
    /// Directories with the files of archives, which are removed with the last spec that has them.
    unpacked: Vec<Arc<TempDir>>,
}

/// # Creation
impl Spec {
    /// Creates the description of a model that has a world only. Ranges are limits (`autolimits` of
    /// `compiler`) with every engine.
    pub fn new(name: &str) -> Self {
        let mut tree = Tree::new("mujoco");
        tree.node_mut(Tree::ROOT).set("model", name.to_owned());
        // Not the default of 2.2.2.
        let compiler = tree.section("compiler");
        tree.node_mut(compiler).set("autolimits", "true".to_owned());
        Self::from_tree((tree, Vec::new()), None)
    }

    /// Reads an MJCF file, and the files that it includes, or a URDF file (see [the
    /// module](self#urdf)). The names of other files in it stay relative to its directory.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, [`Error::Load`] if it or an included file is not
    /// XML, or if it is not a URDF whose links form trees, with the element that is wrong. The spec
    /// is not compiled, so other mistakes are errors of [`compile`](Self::compile).
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/models/cartpole.xml"))?;
    /// spec.section_mut("option")?.set("timestep", 0.001)?;
    /// assert_eq!(spec.compile()?.options().timestep, 0.001);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "from_file")]
    #[doc(alias = "mj_parseXML")]
    pub fn from_xml_path(path: impl AsRef<Path>) -> Result<Self> {
        Self::from_xml_path_with(path, &LoadOptions::default())
    }

    /// Reads an MJCF or URDF file. Included files can be in memory, and a URDF can name meshes by
    /// `package://` URIs.
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path`](Self::from_xml_path), and [`Error::Load`] if the directory of a
    /// package is not known.
    pub fn from_xml_path_with(path: impl AsRef<Path>, options: &LoadOptions<'_>) -> Result<Self> {
        let path = path.as_ref();
        Self::from_file(path, &path.display().to_string(), options)
    }

    /// Reads a file that errors call `source_name`.
    fn from_file(path: &Path, source_name: &str, options: &LoadOptions<'_>) -> Result<Self> {
        let text = file::read_regular(path).map_err(Error::file(path))?;
        let text = String::from_utf8(text).map_err(|_| Error::Load {
            source_name: source_name.to_owned(),
            message: "the text is not UTF-8: convert it to this encoding".to_owned(),
        })?;
        let directory = path.parent().unwrap_or(Path::new(""));
        let sources = Sources { directory: Some(directory), options };
        Ok(Self::from_tree(sources.read(source_name, &text)?, Some(directory.to_owned())))
    }

    /// Reads MJCF or URDF text. Files are relative to the working directory.
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path`](Self::from_xml_path).
    #[doc(alias = "from_string")]
    #[doc(alias = "mj_parseXMLString")]
    #[doc(alias = "mj_parse")]
    pub fn from_xml_str(xml: &str) -> Result<Self> {
        Self::from_xml_str_with(xml, &LoadOptions::default())
    }

    /// Reads MJCF or URDF text. Included files and the meshes of a URDF can be in memory; those in
    /// memory are needed by [`compile_with`](Self::compile_with) again.
    ///
    /// # Errors
    ///
    /// As for [`from_xml_path_with`](Self::from_xml_path_with).
    pub fn from_xml_str_with(xml: &str, options: &LoadOptions<'_>) -> Result<Self> {
        let read = Sources { directory: None, options }.read("the given XML", xml)?;
        Ok(Self::from_tree(read, None))
    }

    fn from_tree((mut tree, warnings): (Tree, Vec<UrdfWarning>), directory: Option<PathBuf>) -> Self {
        let world = tree.sections("worldbody").next();
        let world = world.unwrap_or_else(|| tree.section("worldbody"));
        keyframes::remember_all(&mut tree);
        Self {
            tree,
            lineages: Lineages::new(),
            world,
            directory,
            own_class: None,
            attached: HashSet::new(),
            warnings,
            unpacked: Vec::new(),
        }
    }

    /// Returns the name of the model, the attribute `model` of the root.
    pub fn name(&self) -> &str {
        self.tree.attribute(Tree::ROOT, "model").unwrap_or_default()
    }

    /// Returns the world, the body that contains all others.
    pub fn world(&self) -> ElementId<kind::Body> {
        self.id(self.world)
    }

    /// Returns the directory to which the names of files are relative, or `None` for the working
    /// directory.
    pub fn directory(&self) -> Option<&Path> {
        self.directory.as_deref()
    }

    /// Returns what the spec does not have of the URDF from which it was read, and what acts
    /// otherwise than it seems. Nothing is printed. The warnings are about the URDF: changes of the
    /// spec do not change them, except [`add_free_base`](Self::add_free_base) and
    /// [`add_motors`](Self::add_motors).
    ///
    /// ```
    /// use mujoco_safe::spec::{Spec, UrdfWarning};
    ///
    /// let spec = Spec::from_xml_str(
    ///     r#"<robot name="box">
    ///       <link name="box">
    ///         <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    ///       </link>
    ///       <transmission/>
    ///     </robot>"#,
    /// )?;
    /// assert_eq!(
    ///     spec.urdf_warnings(),
    ///     [
    ///         UrdfWarning::FixedMass { link: "box".to_owned(), mass: 2.0 },
    ///         UrdfWarning::Ignored { what: "<transmission>".to_owned(), count: 1 },
    ///     ]
    /// );
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn urdf_warnings(&self) -> &[UrdfWarning] {
        &self.warnings
    }
}

impl Spec {
    fn id<K>(&self, index: Index) -> ElementId<K> {
        ElementId::new(index, self.lineages.of(index))
    }

    /// Returns `true` if the id belongs to an element of this spec, even if the element was
    /// removed.
    fn owns<K>(&self, id: ElementId<K>) -> bool {
        id.lineage() == self.lineages.of(id.index())
    }

    /// Returns the index of an element.
    ///
    /// # Panics
    ///
    /// If the id belongs to another spec, or the element was removed.
    #[track_caller]
    fn index<K>(&self, id: ElementId<K>) -> Index {
        assert!(self.owns(id), "the id belongs to another spec");
        assert!(self.tree.contains(id.index()), "the element was removed from its spec");
        id.index()
    }

    fn element_mut<K>(&mut self, index: Index) -> ElementMut<'_, K> {
        ElementMut::new(self, index)
    }

    /// Adds an element, with the class of this spec's own elements unless it gets the class of a
    /// body.
    fn append<K>(&mut self, parent: Index, tag: &str) -> ElementMut<'_, K> {
        let index = self.tree.add(parent, tag);
        let is_outermost = self.is_section(parent);
        let class = self.own_class().and_then(|class| names::name(&self.tree, class)).map(str::to_owned);
        if let Some(class) = class.filter(|_| is_outermost) {
            let schema = Schema::of_engine();
            for attribute in ["childclass", "class"] {
                if schema.as_ref().is_ok_and(|schema| schema.has(&self.tree, index, attribute)) {
                    self.tree.node_mut(index).set(attribute, class.clone());
                }
            }
        }
        self.element_mut(index)
    }

    /// Returns `true` for the sections whose elements have the class of this spec's own elements,
    /// and for copies (`replicate`) in the world.
    fn is_section(&self, index: Index) -> bool {
        let parents = std::iter::successors(Some(index), |&index| self.tree.parent(index));
        let outermost = parents.into_iter().find(|&index| self.tree.tag(index) != "replicate");
        outermost.is_some_and(|index| self.tree.parent(index) == Some(Tree::ROOT) && self.tree.tag(index) != "default")
    }

    /// Returns the class of this spec's own elements.
    fn own_class(&self) -> Option<Index> {
        self.own_class.filter(|&class| self.tree.contains(class))
    }

    /// Returns the class that has the defaults of this spec's own elements: the last section, or
    /// the class in which they are separate from the defaults of attached elements.
    fn main_class(&mut self) -> Result<Index> {
        if self.own_class().is_none() && self.attached.iter().any(|&index| self.tree.contains(index)) {
            let mut tree = self.tree.clone();
            self.own_class = Some(attach::separate_own(&mut tree, &self.attached)?);
            self.tree = tree;
        }
        Ok(self.own_class().unwrap_or_else(|| self.tree.section("default")))
    }

    /// Checks that the compiler accepts an element in another one.
    fn check_child(&self, parent: Index, tag: &str) -> Result<()> {
        let known = Schema::of_engine()?.children(&self.tree, parent);
        if matches!(tag, "composite" | "flexcomp") && self.own_class().is_some() && self.is_section(parent) {
            return Err(attach::inseparable(&format!("<{tag}>")));
        }
        // It has the defaults of joints of `main` itself.
        let mut own = self.tree.children(self.world).iter().filter(|index| !self.attached.contains(index));
        let flex = own.find_map(|&index| attach::flexcomp_in(&self.tree, index));
        if let Some(flex) = flex.filter(|_| tag == "joint" && self.own_class() == Some(parent)) {
            return Err(attach::inseparable(&names::describe(&self.tree, flex)));
        }
        if known.contains(&tag) {
            return Ok(());
        }
        let place = names::describe(&self.tree, parent);
        Err(Error::invalid(
            InvalidKind::Unknown,
            format!("the tag of an element in {place}"),
            format!("'{tag}'"),
            known.join(", "),
        ))
    }
}

impl Clone for Spec {
    fn clone(&self) -> Self {
        Self {
            tree: self.tree.clone(),
            lineages: self.lineages.of_clone(self.tree.next()),
            world: self.world,
            directory: self.directory.clone(),
            own_class: self.own_class,
            attached: self.attached.clone(),
            warnings: self.warnings.clone(),
            unpacked: self.unpacked.clone(),
        }
    }
}

impl fmt::Debug for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |class| names::all(&self.tree, class).count();
        let [bodies, joints, geoms] =
            [kind::Kind::Body, kind::Kind::Joint, kind::Kind::Geom].map(|kind| count(Named::Kind(kind)));
        write!(f, "Spec '{}': bodies {bodies}, joints {joints}, geoms {geoms}", self.name())
    }
}
