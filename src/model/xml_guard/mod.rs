//! Checks of model texts for inputs that are known to make the engine's compiler crash, raise a
//! fatal error while it holds its lock, or read standard input. Conditions that the text does not
//! reveal are left to the compiler: see [`Model::from_xml_str`](super::Model::from_xml_str).

mod assets;
mod expansion;
mod files;
mod flexes;
mod fusion;
mod joint_types;
mod limits;
mod lines;
mod parents;
mod place;
mod plugins;
mod readings;
mod simulation;
mod source;
mod tags;
mod urdf;

use std::borrow::Cow;
use std::collections::HashSet;
use std::rc::Rc;

#[cfg(feature = "viewer")]
pub(super) use self::files::FoundFiles;
pub(super) use self::files::{Files, directory, path_bytes};
pub(super) use self::simulation::{without_constraints, without_simulation};
pub(super) use self::tags::{Tags, decoded};

use self::assets::Format;
use self::expansion::{Expansion, Size};
use self::files::{EXTENSION, Found, NO_EXTENSION, abbreviated, last_part, message, reject_name};
use self::flexes::{Dim, Mesh};
use self::fusion::Fusion;
use self::joint_types::JointTypes;
use self::parents::Parent;
use self::place::{Candidate, Place};
use self::plugins::Plugins;
use self::readings::Readings;
use self::simulation::{Constraints, Muscles, Rangefinders, Simulations};
use self::source::{Source, at_line};
use self::tags::{Tag, numbers};
use self::urdf::Urdf;
use crate::error::{Error, Result};

/// Largest depth of includes and models in each other, and largest depth of elements over all
/// included files. The compiler and this check recurse, so deeply nested files would overflow the
/// stack of a thread.
const MOST_INCLUDED: usize = 50;
const MOST_NESTED: usize = 400;
/// Largest number of included texts and of models that are assets, and largest total length of
/// these texts in bytes. A text is read again for each model that has it as an asset.
const MOST_TEXTS: usize = 10_000;
const LONGEST_TEXTS: usize = 1 << 30;
/// Largest number of elements that the compiler creates from a model with `replicate` or `attach`,
/// each copy of an element counted.
const MOST_ELEMENTS: u64 = 1_000_000;
/// Largest numbers of bodies and of degrees of freedom. The engine packs two body ids into one C
/// int, and stores 6 nv² in a C int. The check of the compiled model has the same limits; this one
/// avoids minutes of compilation.
pub(super) const MOST_BODIES: usize = 32_766;
pub(super) const MOST_DOFS: usize = 13_377;
/// Smallest `njmax` of a text with adhesion. The compiler performs a step, in which each contact
/// needs up to ten constraints. For the first contact without room, the engine writes from one
/// element before the start of an array with an element per constraint (see `engine_limits.rs`).
/// With this `njmax` that array has more than 90 elements, and the memory before it is another
/// array on the stack of the same function. The writes stay in these arrays, and the compiler
/// discards the results of the step.
const LEAST_NJMAX: i32 = 100;
/// Largest number of asset directories in a text, which limits the number of paths to look up for a
/// file.
const MOST_FOLDERS: usize = 16;
/// Attributes that name a file.
const FILES: [&[u8]; 8] =
    [b"file", b"filename", b"fileright", b"fileleft", b"fileup", b"filedown", b"filefront", b"fileback"];

/// Rejects unsafe inputs in this text, in the texts that it includes, and in the models that are
/// its assets. Returns the simulations that must be checked on a compiled model.
pub(super) fn check(source_name: &str, text: &[u8], files: &Files<'_>) -> Result<Simulations> {
    let mut check = Check {
        files,
        model: ModelState::default(),
        depth: 0,
        open: 0,
        texts: 0,
        length: 0,
        bodies: 0,
        dofs: 0,
        joints: Vec::new(),
        has_small_njmax: false,
        has_adhesion: false,
        parent: Parent::default(),
        composite: Vec::new(),
        folders: vec![Vec::new()],
        assets: Vec::new(),
        meshes: Vec::new(),
        flexes: Vec::new(),
        muscles: Muscles::default(),
        constraints: Constraints::default(),
        rangefinders: Rangefinders::default(),
        fusion: Fusion::default(),
        joint_types: JointTypes::default(),
    };
    check.model(source_name, text, &Rc::new(Place::new(files.directory)))?;
    check.assets(source_name)?;
    // The compiler performs a step, so a check of the compiled model would be too late.
    if check.has_adhesion && check.has_small_njmax {
        let message =
            format!("adhesion needs an njmax of at least {LEAST_NJMAX}, or the njmax that the compiler computes");
        return Err(Error::Load { source_name: source_name.to_owned(), message });
    }
    if let Some(message) = check.fusion.check().or_else(|| check.joint_types.check()) {
        return Err(Error::Load { source_name: source_name.to_owned(), message });
    }
    check.rangefinders.check()?;
    let may_lack_room = check.constraints.may_lack_room();
    Ok(Simulations { muscles: check.muscles.simulation(), may_lack_room })
}

/// Returns the reason to reject the file of a texture, which the engine reads after a load, too.
#[cfg(all(engine_since = "3.17.0", any(feature = "renderer", feature = "html", feature = "gltf")))]
pub(super) fn reject_texture(path: &[u8]) -> Option<String> {
    let reason = match files::on_disk(path)? {
        Found::Rejected(reason) => reason,
        Found::Content(content) => Format::of_texture(path).reject(path, &content, &Files::default())?,
    };
    Some(message(path, reason))
}

struct Check<'f> {
    files: &'f Files<'f>,
    model: ModelState,
    /// Number of models that have the present one as an asset.
    depth: usize,
    /// Number of texts that contain the present place.
    open: usize,
    /// Number of texts in files, and their total length.
    texts: usize,
    length: usize,
    bodies: usize,
    dofs: usize,
    /// Joints of the most recent fixed tendon.
    joints: Vec<Vec<u8>>,
    /// `true` if `njmax` is below [`LEAST_NJMAX`].
    has_small_njmax: bool,
    /// `true` if an actuator acts on a body.
    has_adhesion: bool,
    parent: Parent,
    /// Counts of the most recent composite.
    composite: Vec<u64>,
    /// Directories that may contain assets.
    folders: Vec<Vec<u8>>,
    assets: Vec<Asset>,
    /// Meshes in the texts, and dimensions of the flexes that may have a mesh of the model.
    meshes: Vec<Mesh>,
    flexes: Vec<Dim>,
    muscles: Muscles,
    constraints: Constraints,
    rangefinders: Rangefinders,
    fusion: Fusion,
    joint_types: JointTypes,
}

/// State of the check of one model and the texts that it includes.
#[derive(Default)]
struct ModelState {
    expansion: Expansion,
    readings: Readings,
    urdf: Urdf,
    plugins: Plugins,
}

/// Text in a file, and the path at which the compiler finds it.
type Text<'f> = (Candidate, Cow<'f, [u8]>);

/// Mesh, skin, height field or texture file.
struct Asset {
    format: Format,
    is_mesh: bool,
    name: Vec<u8>,
    /// The name of the text that refers to it, and the directories of that text.
    source_name: String,
    place: Rc<Place>,
}

impl<'f> Check<'f> {
    /// Checks a model, and returns its size and its numbers of values.
    fn model(&mut self, source_name: &str, text: &[u8], place: &Rc<Place>) -> Result<(Size, Readings)> {
        let outer = std::mem::take(&mut self.model);
        self.text(Source { name: source_name, text, place, includes: 0, elements: 0 })?;
        let inner = std::mem::replace(&mut self.model, outer);
        let reject = |message| Error::Load { source_name: source_name.to_owned(), message };
        let chain =
            inner.urdf.check_chains(MOST_NESTED).map_err(|(position, why)| reject(at_line(&why, text, position)))?;
        let size = inner.expansion.finish(chain).map_err(reject)?;
        inner.readings.check(size.elements()).map_err(reject)?;
        inner.plugins.check().map_or(Ok(()), |why| Err(reject(why)))?;
        Ok((size, inner.readings))
    }

    /// Checks a text and those that it includes.
    fn text(&mut self, source: Source<'_>) -> Result<()> {
        // A file that a C program has written can end with NUL.
        let end = source.text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        if let Some(position) = source.text[..end].iter().position(|&byte| byte == 0) {
            let why = if source.text.starts_with(b"PK\x03\x04") {
                "the file is an archive: read it with Spec::from_archive_path"
            } else {
                "the text has a NUL byte, at which the compiler would stop reading"
            };
            return Err(source.error(position, why));
        }
        self.open += 1;
        let mut depth = 0;
        for tag in Tags::new(source.text) {
            if tag.closes {
                depth -= usize::from(depth > 0);
                self.end(&tag, source.elements + depth);
                continue;
            }
            let level = source.elements + depth;
            let reject = |why: String| source.error(tag.position, &why);
            self.start(&tag, level, &source).map_err(reject)?;
            self.nested(&tag, level, &source)?;
            if self.is_repeated(&tag) {
                let why = "a fixed tendon has the same joint twice; list it once, with the sum of the coefficients";
                return Err(source.error(tag.position, why));
            }
            self.count(&tag).map_err(reject)?;
            // The engine resolves includes in MJCF only.
            if source.includes == 0 {
                self.model.urdf.record(&tag, depth).map_err(reject)?;
            }
            depth += usize::from(!tag.empty);
        }
        self.open -= 1;
        Ok(())
    }

    /// Records the start of an element inside a number of others, and applies the rules for its
    /// attributes.
    fn start(&mut self, tag: &Tag<'_>, level: usize, source: &Source<'_>) -> Result<(), String> {
        self.model.expansion.start(tag, level)?;
        self.model.readings.record(tag, self.model.expansion.copies());
        let mut names = FILES.iter().filter_map(|attribute| tag.attribute(attribute));
        let why = (names.find_map(|name| reject_name(tag.name, &name)))
            .or_else(|| limits::reject(tag, &self.composite))
            .or_else(|| flexes::reject(tag).map(str::to_owned))
            .or_else(|| if self.model.urdf.is_urdf() { None } else { limits::reject_unknown(tag) })
            .or_else(|| self.parent.start(tag).map(str::to_owned));
        if let Some(why) = why {
            return Err(why);
        }
        self.model.plugins.record(tag);
        self.muscles.record(tag, self.depth > 0);
        self.constraints.record(tag);
        self.rangefinders.record(tag, source.name);
        self.fusion.start(tag, level, self.depth > 0);
        self.joint_types.start(tag, level);
        self.record_files(tag, source);
        if self.folders.len() > MOST_FOLDERS {
            return Err(format!("the model has more than {MOST_FOLDERS} asset directories"));
        }
        Ok(())
    }

    /// Records the end of an element.
    fn end(&mut self, tag: &Tag<'_>, level: usize) {
        self.parent.end(tag);
        self.model.expansion.end(level);
        self.fusion.end(level);
        self.joint_types.end(level);
    }

    /// Checks the texts that an element includes or has as a model.
    fn nested(&mut self, tag: &Tag<'_>, level: usize, source: &Source<'_>) -> Result<()> {
        let is_include = tag.name.eq_ignore_ascii_case(b"include");
        // Older compilers reject a model as an asset.
        let is_model = cfg!(engine_since = "3.2.0") && tag.name == b"model" && !self.model.urdf.is_urdf();
        if !is_include && !is_model {
            return Ok(());
        }
        let reject = |why: &str| Err(source.error(tag.position, why));
        let file = tag.attribute(b"file");
        if self.open > MOST_INCLUDED && file.is_some() {
            return reject(&format!(
                "includes are nested more than {MOST_INCLUDED} deep; a file must not include itself"
            ));
        }
        if let Some(why) = is_model.then(|| limits::reject_model(tag, self.depth)).flatten() {
            return reject(&why);
        }
        if is_include && file.is_none() {
            return Ok(());
        }
        let name = file.unwrap_or_default();
        let found = match self.named(&name, source.place) {
            Ok(found) => found,
            Err(why) => return reject(&format!("'{}' {why}", abbreviated(&name))),
        };
        let name = String::from_utf8_lossy(&name);
        for (found, content) in found {
            if is_include {
                let place = &Rc::new(source.place.of_include(&found));
                let (includes, elements) = (source.includes + 1, level);
                self.text(Source { name: &name, text: &content, place, includes, elements })?;
            } else {
                self.depth += 1;
                let (size, readings) = self.model(&name, &content, &Rc::new(source.place.of_model(&found)))?;
                self.depth -= 1;
                self.model.expansion.record_model(size);
                self.model.readings.record_model(&readings);
            }
        }
        Ok(())
    }

    /// Reads the texts that the compiler may read for a name, also if it was read before: the
    /// compiler may recognise a repeated include by its name only, and a file can have several
    /// names. Returns none if no text can be read, which the compiler reports, and an error if the
    /// compiler must not open one.
    fn named(&mut self, name: &[u8], place: &Place) -> Result<Vec<Text<'f>>, &'static str> {
        let mut texts: Vec<Text<'f>> = Vec::new();
        for candidate in place.texts(name) {
            for found in self.files.find(&candidate.path) {
                let content = match found {
                    Found::Rejected(why) => return Err(why),
                    Found::Content(content) => content,
                };
                // Several candidates can be the same file. The compiler uses the first.
                if texts.iter().any(|(_, known)| *known == content) {
                    continue;
                }
                self.texts += 1;
                self.length = self.length.saturating_add(content.len());
                if self.texts > MOST_TEXTS || self.length > LONGEST_TEXTS {
                    return Err("is beyond the limits of 10,000 files and 1 GiB on the texts of a model");
                }
                texts.push((candidate.clone(), content));
            }
        }
        Ok(texts)
    }

    /// Records the asset files that a tag names, and the directories that may contain them.
    fn record_files(&mut self, tag: &Tag<'_>, source: &Source<'_>) {
        match tag.name {
            b"mesh" => self.meshes.push(Mesh::of_tag(tag)),
            b"flexcomp" if !is_empty(tag, b"mesh") => self.flexes.push(Dim::of(tag)),
            _ => {}
        }
        if tag.name == b"compiler" {
            for folder in [&b"meshdir"[..], b"texturedir", b"assetdir"].iter().filter_map(|name| tag.attribute(name)) {
                if !self.folders.iter().any(|known| *known == *folder) {
                    self.folders.push(folder.into_owned());
                }
            }
            return;
        }
        for name in FILES.iter().filter_map(|attribute| tag.attribute(attribute)) {
            let format = Format::of(tag, &name);
            let is_mesh = tag.name == b"mesh";
            if ![&b"include"[..], b"model"].contains(&tag.name) {
                let (name, source_name) = (name.into_owned(), source.name.to_owned());
                self.assets.push(Asset { format, is_mesh, name, source_name, place: source.place.clone() });
            }
        }
    }

    /// Checks the asset files. A later part of the text may change the directory that the compiler
    /// uses, and whether it uses the directory in the name. Therefore all candidate paths are
    /// checked.
    fn assets(&mut self, model: &str) -> Result<()> {
        let mut seen = HashSet::new();
        let of_flex = |mesh: &Mesh| self.flexes.iter().find_map(|&dim| mesh.reject(dim));
        if let Some(reason) = self.meshes.iter().find_map(of_flex) {
            let message = format!("a mesh of the text, which a flexcomp may have, {reason}");
            return Err(Error::Load { source_name: model.to_owned(), message });
        }
        for asset in &self.assets {
            let reject = |name: &[u8], reason| {
                Err(Error::Load { source_name: asset.source_name.clone(), message: message(name, reason) })
            };
            let longest = self.folders.iter().map(|folder| asset.place.asset(folder, &asset.name).len()).max();
            if asset.format.is_grid() && !asset.name.is_empty() && longest <= Some(EXTENSION) {
                return reject(&asset.name, NO_EXTENSION);
            }
            for folder in &self.folders {
                let names = [&asset.name[..], last_part(&asset.name)];
                for (name, path) in names
                    .into_iter()
                    .flat_map(|name| asset.place.assets(folder, name).into_iter().map(move |path| (name, path)))
                {
                    if !seen.insert((asset.format, path.clone())) {
                        continue;
                    }
                    for found in self.files.find(&path) {
                        let reason = match found {
                            Found::Rejected(why) => (!name.is_empty()).then_some(why),
                            Found::Content(content) => {
                                let size = asset.format.rows_and_columns(&content);
                                self.rangefinders.record_field(size, &asset.source_name);
                                asset.format.reject(&path, &content, self.files).or_else(|| {
                                    let is_of_flex = asset.is_mesh && !self.flexes.is_empty();
                                    is_of_flex.then(|| Mesh::of_file(&path, &content)).and_then(|mesh| of_flex(&mesh))
                                })
                            }
                        };
                        if let Some(reason) = reason {
                            return reject(name, reason);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Returns `true` if the tag repeats a joint of the same fixed tendon.
    fn is_repeated(&mut self, tag: &Tag<'_>) -> bool {
        match (tag.name, tag.attribute(b"joint")) {
            (b"fixed", _) => self.joints.clear(),
            (b"joint", Some(joint)) if self.joints.iter().any(|known| *known == *joint) => return true,
            (b"joint", Some(joint)) => self.joints.push(joint.into_owned()),
            _ => {}
        }
        false
    }

    /// Counts bodies and degrees of freedom, with all copies of replications. The error tells that
    /// there are too many.
    fn count(&mut self, tag: &Tag<'_>) -> Result<(), String> {
        let copies = self.model.expansion.copies();
        let add = |sum: &mut usize, count: u64| {
            *sum = sum.saturating_add(usize::try_from(count.saturating_mul(copies)).unwrap_or(usize::MAX));
        };
        match tag.name {
            b"size" => {
                // The compiler's parser may convert a number that does not fit into a C int to any
                // value.
                let is_small = || tag.integer(b"njmax").is_none_or(|rows| (0..LEAST_NJMAX).contains(&rows));
                self.has_small_njmax |= tag.attribute(b"njmax").is_some() && is_small();
            }
            b"adhesion" | b"general" => self.has_adhesion |= tag.attribute(b"body").is_some(),
            b"body" | b"link" => add(&mut self.bodies, 1),
            b"freejoint" => add(&mut self.dofs, 6),
            b"joint" => {
                let dofs = match tag.attribute(b"type").as_deref() {
                    Some(b"free" | b"floating") => 6,
                    Some(b"ball" | b"planar") => 3,
                    _ => 1,
                };
                add(&mut self.dofs, dofs);
            }
            b"composite" => {
                self.composite = counts(tag);
                add(&mut self.bodies, grid(tag));
            }
            // A flex has a body for each vertex, unless few nodes determine its shape.
            b"flexcomp" if !limits::is_interpolated(tag) => add(&mut self.bodies, grid(tag)),
            _ => {}
        }
        if self.bodies > MOST_BODIES || self.dofs > MOST_DOFS {
            return Err(format!("the model has more than {MOST_BODIES} bodies or {MOST_DOFS} degrees of freedom"));
        }
        Ok(())
    }
}

/// Returns the number of points of a composite or a flex.
fn grid(tag: &Tag<'_>) -> u64 {
    counts(tag).into_iter().fold(1, u64::saturating_mul)
}

/// Returns the attribute `count` of a composite or a flex.
fn counts(tag: &Tag<'_>) -> Vec<u64> {
    numbers(&tag.attribute(b"count").unwrap_or_default())
        .map(|count| count.map_or(1, |count| count.clamp(1, 1 << 20) as u64))
        .collect()
}

/// Returns `true` if an attribute is missing or empty.
fn is_empty(tag: &Tag<'_>, name: &[u8]) -> bool {
    tag.attribute(name).is_none_or(|value| value.is_empty())
}

#[cfg(test)]
mod tests;
