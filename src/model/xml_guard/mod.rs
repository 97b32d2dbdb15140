//! A look at model texts before the engine's compiler sees them, for what makes it crash, raise a fatal error while it holds
//! its lock, or read standard input. What a look at the text cannot see stays the compiler's: see
//! [`Model::from_xml_str`](super::Model::from_xml_str).

mod asset;
mod file;
mod muscle;
mod rangefinder;
mod size;
mod tag;
mod urdf;

use std::borrow::Cow;
use std::collections::HashSet;

pub(super) use self::file::{Files, directory, path_bytes};
pub(super) use self::muscle::without_simulation;
pub(super) use self::tag::{Tags, decoded};

use self::asset::Format;
use self::file::{Found, is_irregular, last_part, shown};
use self::muscle::Muscles;
use self::rangefinder::Rangefinders;
use self::tag::{Tag, numbers};
use self::urdf::Urdf;
use super::length_range::Simulation;
use crate::error::{Error, Result};

/// How deep files may include each other, and elements be nested over all of them. The compiler recurses, and a file in every
/// file ends the stack of a thread.
const MOST_INCLUDED: usize = 50;
const MOST_NESTED: usize = 400;
/// Bytes of a file name; the engine's limit is 999.
const LONGEST_NAME: usize = 900;
/// Largest numbers of bodies and of degrees of freedom. The engine packs two body ids into one C int, and counts 6 nv² with a C
/// int. The check of the compiled model has the same limits; this one saves the minutes of compilation.
const MOST_BODIES: usize = 32_766;
const MOST_DOFS: usize = 13_377;
/// The least room for constraints that a text with adhesion may give. The compiler takes a step, in which each contact needs up to
/// ten. For the first that has no room the engine writes from one before an array with a number for each constraint (see
/// `hazard.rs`). With this much room that array has more than 90, and before it is one that the same function has on the stack, so
/// what is written stays in there, and the compiler throws the step's results away.
const LEAST_NJMAX: i32 = 100;
/// Bytes of an extension: the compiler cuts them off without a look at how many there are.
const EXTENSION: usize = 3;
/// Directories of assets in a text, and with it the places in which a file is looked for.
const MOST_FOLDERS: usize = 16;
/// The attributes that name a file.
const FILES: [&[u8]; 8] =
    [b"file", b"filename", b"fileright", b"fileleft", b"fileup", b"filedown", b"filefront", b"fileback"];

/// Refuses what the compiler must not see in this text, or in the texts that it includes. Returns how it would simulate muscles,
/// if it may: whether that comes to an end a look at the text does not tell.
pub(super) fn check(source_name: &str, text: &[u8], files: &Files<'_>) -> Result<Option<Simulation>> {
    let mut check = Check {
        files,
        seen: HashSet::new(),
        bodies: 0,
        dofs: 0,
        joints: Vec::new(),
        little_room: false,
        adhesion: false,
        composite: Vec::new(),
        folders: vec![Vec::new()],
        assets: Vec::new(),
        muscles: Muscles::default(),
        rangefinders: Rangefinders::default(),
        urdf: Urdf::default(),
    };
    check.text(source_name, text, 0)?;
    check.assets()?;
    // The compiler takes a step, so that a look at the compiled model comes too late.
    if check.adhesion && check.little_room {
        let message = format!(
            "adhesion needs room for at least {LEAST_NJMAX} constraints (njmax), or for as many as the compiler finds"
        );
        return Err(Error::Load { source_name: source_name.to_owned(), message });
    }
    check.rangefinders.check()?;
    Ok(check.muscles.simulation())
}

struct Check<'f> {
    files: &'f Files<'f>,
    /// The files that were included. The compiler refuses one that comes twice, so it is not looked at again.
    seen: HashSet<Vec<u8>>,
    bodies: usize,
    dofs: usize,
    /// The joints of the fixed tendon that was begun last.
    joints: Vec<Vec<u8>>,
    /// Whether there is little room for constraints.
    little_room: bool,
    /// Whether there is an actuator on a body.
    adhesion: bool,
    /// The counts of the composite that was begun last.
    composite: Vec<u64>,
    /// The directories in which assets may be.
    folders: Vec<Vec<u8>>,
    assets: Vec<Asset>,
    muscles: Muscles,
    rangefinders: Rangefinders,
    urdf: Urdf,
}

/// A file that is not a text.
struct Asset {
    format: Format,
    name: Vec<u8>,
    /// The text that names it.
    source_name: String,
}

impl<'f> Check<'f> {
    /// The depth of the deepest element.
    fn text(&mut self, source_name: &str, text: &[u8], included: usize) -> Result<usize> {
        let refuse = |position: usize, why: &str| {
            let line = text[..position].split(|&byte| byte == b'\n').count();
            Err(Error::Load { source_name: source_name.to_owned(), message: format!("{why}, line {line}") })
        };
        if let Some(position) = text.iter().position(|&byte| byte == 0) {
            return refuse(position, "the text has a NUL byte, at which the compiler would stop reading");
        }
        let (mut depth, mut deepest) = (0, 0);
        for tag in Tags::new(text) {
            let is = |name: &[u8]| tag.name.eq_ignore_ascii_case(name);
            if tag.closes {
                depth -= usize::from(depth > 0);
                continue;
            }
            deepest = deepest.max(depth + 1);
            let mut names = FILES.iter().filter_map(|attribute| tag.attribute(attribute));
            let why = names.find_map(|name| bad_name(tag.name, &name)).or_else(|| size::fault(&tag, &self.composite));
            if let Some(why) = why {
                return refuse(tag.position, &why);
            }
            self.muscles.note(&tag);
            self.rangefinders.note(&tag, source_name);
            self.note_files(&tag, source_name);
            if self.folders.len() > MOST_FOLDERS {
                return refuse(tag.position, &format!("more than {MOST_FOLDERS} directories of assets"));
            }
            let file = tag.attribute(b"file");
            if let Some(name) = file.filter(|_| is(b"include")) {
                if included >= MOST_INCLUDED {
                    return refuse(tag.position, &format!("more than {MOST_INCLUDED} files include each other"));
                }
                let content = match self.included(&name) {
                    Ok(content) => content,
                    Err(why) => return refuse(tag.position, &format!("'{}' {why}", shown(&name))),
                };
                if let Some(content) = content {
                    let inner = self.text(&String::from_utf8_lossy(&name), &content, included + 1)?;
                    deepest = deepest.max(depth + inner);
                }
            }
            if self.is_repeated(&tag) {
                return refuse(
                    tag.position,
                    "a fixed tendon has the same joint twice; give it once, with the sum of the coefficients",
                );
            }
            // The engine resolves includes in MJCF only.
            if included == 0
                && let Err(why) = self.urdf.note(&tag, depth)
            {
                return refuse(tag.position, &why);
            }
            self.count(&tag);
            if self.bodies > MOST_BODIES || self.dofs > MOST_DOFS {
                let why = format!("more than {MOST_BODIES} bodies or {MOST_DOFS} degrees of freedom");
                return refuse(tag.position, &why);
            }
            if deepest > MOST_NESTED {
                return refuse(tag.position, &format!("elements are nested more than {MOST_NESTED} deep"));
            }
            depth += usize::from(!tag.empty);
        }
        if included == 0
            && let Err((position, why)) = self.urdf.check_chains(MOST_NESTED)
        {
            return refuse(position, &why);
        }
        Ok(deepest)
    }

    /// What an included file contains; `None` if it was included before or cannot be read, which the compiler will tell, and
    /// an error if the compiler must not open it.
    fn included(&mut self, name: &[u8]) -> Result<Option<Cow<'f, [u8]>>, &'static str> {
        // The compiler puts the name behind the directory whatever it is.
        let path = [self.files.directory, name].concat();
        if !self.seen.insert(path.to_ascii_lowercase()) {
            return Ok(None);
        }
        match self.files.find(&path) {
            Found::Nothing => Ok(None),
            Found::Rejected(why) => Err(why),
            Found::Content(content) => Ok(Some(content)),
        }
    }

    /// Remembers the files of assets that a tag names, and the directories in which they may be.
    fn note_files(&mut self, tag: &Tag<'_>, source_name: &str) {
        if tag.name == b"compiler" {
            for folder in [&b"meshdir"[..], b"texturedir"].iter().filter_map(|name| tag.attribute(name)) {
                if !self.folders.iter().any(|known| *known == *folder) {
                    self.folders.push(folder.into_owned());
                }
            }
            return;
        }
        for name in FILES.iter().filter_map(|attribute| tag.attribute(attribute)) {
            let format = Format::of(tag.name, &name);
            if tag.name != b"include" {
                self.assets.push(Asset { format, name: name.into_owned(), source_name: source_name.to_owned() });
            }
        }
    }

    /// Looks at the files of assets. Which directory counts, and whether that in the name does, may be decided at the end of
    /// the text, so every place in which the compiler might look is looked in.
    fn assets(&mut self) -> Result<()> {
        let mut seen = HashSet::new();
        for asset in &self.assets {
            let refuse = |name: &[u8], fault| {
                Err(Error::Load { source_name: asset.source_name.clone(), message: asset::message(name, fault) })
            };
            let longest = self.folders.iter().map(|folder| self.files.asset_path(folder, &asset.name).len()).max();
            if asset.format.is_grid() && !asset.name.is_empty() && longest <= Some(EXTENSION) {
                return refuse(&asset.name, NO_EXTENSION);
            }
            for folder in &self.folders {
                for name in [&asset.name[..], last_part(&asset.name)] {
                    let path = self.files.asset_path(folder, name);
                    if !seen.insert((asset.format, path.clone())) {
                        continue;
                    }
                    let fault = match self.files.find(&path) {
                        Found::Nothing => None,
                        Found::Rejected(why) => (!name.is_empty()).then_some(why),
                        Found::Content(content) => {
                            let size = asset.format.rows_and_columns(&content);
                            self.rangefinders.note_field(size, &asset.source_name);
                            asset.format.fault(&path, &content, self.files)
                        }
                    };
                    if let Some(fault) = fault {
                        return refuse(name, fault);
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether this is another entry for a joint that the fixed tendon has an entry for.
    fn is_repeated(&mut self, tag: &Tag<'_>) -> bool {
        match (tag.name, tag.attribute(b"joint")) {
            (b"fixed", _) => self.joints.clear(),
            (b"joint", Some(joint)) if self.joints.iter().any(|known| *known == *joint) => return true,
            (b"joint", Some(joint)) => self.joints.push(joint.into_owned()),
            _ => {}
        }
        false
    }

    /// Counts bodies and degrees of freedom.
    fn count(&mut self, tag: &Tag<'_>) {
        match tag.name {
            b"size" => {
                // A number that does not fit may be any to the compiler's parser.
                let is_little = || tag.integer(b"njmax").is_none_or(|rows| (0..LEAST_NJMAX).contains(&rows));
                self.little_room |= tag.attribute(b"njmax").is_some() && is_little();
            }
            b"adhesion" | b"general" => self.adhesion |= tag.attribute(b"body").is_some(),
            b"body" | b"link" => self.bodies += 1,
            b"freejoint" => self.dofs += 6,
            b"joint" => {
                self.dofs += match tag.attribute(b"type").as_deref() {
                    Some(b"free" | b"floating") => 6,
                    Some(b"ball" | b"planar") => 3,
                    _ => 1,
                }
            }
            b"composite" => {
                self.composite = numbers(&tag.attribute(b"count").unwrap_or_default())
                    .map(|count| count.map_or(1, |count| count.clamp(1, 1 << 20) as u64))
                    .collect();
                let bodies = self.composite.iter().fold(1, |product: u64, &count| product.saturating_mul(count));
                self.bodies = self.bodies.saturating_add(usize::try_from(bodies).unwrap_or(usize::MAX));
            }
            _ => {}
        }
    }
}

const NO_EXTENSION: &str = "has a name too short for an extension, which tells the compiler what is in it";

/// What is wrong with the name of a file that this element names. The compiler looks for it among the files in memory, where no
/// name, or one that is too long, is a fatal error.
fn bad_name(element: &[u8], name: &[u8]) -> Option<String> {
    let last = last_part(name).len();
    let why = match name.last() {
        // Only that of an included file is looked at then.
        None if !element.eq_ignore_ascii_case(b"include") => return None,
        None | Some(b'/' | b'\\') => "has nothing behind its last slash",
        _ if last > LONGEST_NAME => "is longer than 900 bytes",
        // The parser makes nothing of some of these, and ends the name at others.
        _ if name.contains(&0) || name.windows(2).any(|window| window == b"&#") => "has a reference to no character",
        _ if is_irregular(name) => "is not that of a regular file",
        _ if matches!(element, b"mesh" | b"skin") && last < EXTENSION => {
            return Some(asset::message(name, NO_EXTENSION));
        }
        _ => return None,
    };
    Some(format!("the file name '{}' {why}", shown(name)))
}

#[cfg(test)]
mod tests {
    use super::{Files, check};

    fn message(text: &str) -> String {
        check("the text", text.as_bytes(), &Files::default()).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn no_cut_of_a_text_makes_the_look_at_it_fail() {
        let text = b"<mujoco><mesh vertex='0 0 0' face = \"0 1 2\"/><!-- a --><include file='/x/'/><a/ b=/></mujoco>";
        for end in 0..text.len() {
            for start in 0..end {
                let _ = check("", &text[start..end], &Files::default());
            }
        }
    }

    #[test]
    fn what_the_compiler_must_not_see_is_refused_with_its_line() {
        for (text, expected) in [
            ("<mujoco>\n<include file=''/></mujoco>", "nothing behind its last slash, line 2"),
            ("<mujoco><include\x0bfile\x0b=\x0b''/></mujoco>", "nothing behind its last slash"),
            ("<mujoco><include file='a&#47;'/></mujoco>", "nothing behind its last slash"),
            ("<mujoco><include file='a/&#0;'/></mujoco>", "reference to no character"),
            ("<mujoco><include file='a/&#9999999;'/></mujoco>", "reference to no character"),
            ("<mujoco><mesh file='a/b'/></mujoco>", "too short for an extension"),
            ("<mujoco><skin file='sk'/></mujoco>", "too short for an extension"),
            ("<mujoco><texture fileup='abc'/></mujoco>", "too short for an extension"),
            ("<mujoco><hfield file='a'/></mujoco>", "too short for an extension"),
            ("<mujoco>\0</mujoco>", "NUL byte"),
            ("<mujoco><include file='/dev/null'/></mujoco>", "regular file"),
            ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'/>", "0 to 2"),
            ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 -1'/>", "0 to 2"),
            ("<texture width='50000' height='50000'/>", "a texture is too large"),
            ("<hfield nrow='50000' ncol='50000'/>", "a height field is too large"),
            ("<composite count='1000 1000 1'/>", "32766 bodies"),
            ("<composite count='&#49;000 1000 1'/>", "32766 bodies"),
            ("<hfield nrow='-4294917296' ncol='50000'/>", "a height field is too large"),
            ("<size njmax='&#53;'/><adhesion body='b'/>", "adhesion needs room"),
            ("<size njmax='5.5'/><adhesion body='b'/>", "adhesion needs room"),
            ("<size njmax='4294967301'/><adhesion body='b'/>", "adhesion needs room"),
            ("<hfield nrow='3' ncol='2'/><geom hfield='h'/><rangefinder/>", "3 rows and 2 columns"),
            ("<hfield nrow='1' ncol='2'/><geom hfield='h'/><rangefinder/>", "1 rows and 2 columns"),
            ("<hfield nrow='1e1' ncol='5'/><geom hfield='h'/><rangefinder/>", "1 rows and 5 columns"),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn good_texts_pass() {
        for text in [
            crate::sample::CARTPOLE_XML,
            crate::sample::HUMANOID_XML,
            "<mujoco><!-- <include file=''/> --></mujoco>",
            "<mesh vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2\n1 2 3'/>",
            "<size njmax='100'/><adhesion body='b'/>",
            "<size njmax='-1'/><adhesion body='b'/>",
            "<hfield nrow='3' ncol='3'/><geom hfield='h'/><rangefinder/>",
            "<hfield nrow='3' ncol='2'/><geom hfield='h'/>",
            "<hfield nrow='3' ncol='2'/><rangefinder/>",
            "<compiler meshdir='parts'/><hfield file='a'/>",
            "<texture file='&#97;.png'/>",
            "<texture type='skybox' builtin='gradient' width='512' height='3072'/>",
        ] {
            assert_eq!(message(text), "");
        }
    }
}
