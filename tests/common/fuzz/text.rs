//! Damaged texts, and damaged files named in them.

use std::ops::Range;
use std::sync::OnceLock;

use mujoco_safe::{Error, LoadOptions, Model, sample};

use super::assets::{self, File};
use super::binary::use_model;
use super::newer_models::{self, NEWER};
use super::{Bytes, Verdict, models, token};

/// A text and the files named in it.
struct Source {
    name: String,
    text: Vec<u8>,
    files: Vec<File>,
}

/// Length of texts and files beyond which compiling takes too long.
const LONGEST: usize = 40_000;

const NUMBERS: [&str; 28] = [
    "0",
    "-1",
    "1",
    "2",
    "0.5",
    "1e-9",
    "1e-300",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "-inf",
    "1e9",
    "100",
    "1000",
    "65536",
    "1000000",
    "10000000",
    "46341",
    "2147483647",
    "-2147483648",
    "4294967297",
    "1e15",
    "-0.001",
    "",
    "x",
    "1 2 3",
    "0 0 0",
];

const VALUES: [&str; 36] = [
    "true",
    "false",
    "auto",
    "free",
    "ball",
    "slide",
    "hinge",
    "plane",
    "hfield",
    "sphere",
    "capsule",
    "ellipsoid",
    "cylinder",
    "box",
    "mesh",
    "implicit",
    "RK4",
    "PGS",
    "CG",
    "Newton",
    "elliptic",
    "sparse",
    "dense",
    "muscle",
    "filter",
    "integrator",
    "user",
    "grid",
    "cloth",
    "box",
    "particle",
    "rope",
    "loop",
    "world",
    "radian",
    "gradient",
];

/// Fragments that occur rarely.
const PIECES: [&str; 14] = [
    "<composite type='grid' count='3 3 1' spacing='.1'><geom size='.02'/></composite>",
    "<composite type='box' count='4 4 4' spacing='.1'><geom size='.02' type='sphere'/></composite>",
    "<composite type='cloth' count='4 4 1' spacing='.1'><geom size='.02'/><skin inflate='.1' texcoord='true' subgrid='2'/></composite>",
    "<composite type='rope' count='7 1 1' spacing='.1' prefix='R'><joint kind='main' damping='.1'/><geom type='capsule' size='.02 .03'/></composite>",
    "<muscle joint='j' timeconst='.01 .04' range='.75 1.05' force='-1' scale='200' ctrllimited='true' ctrlrange='0 1'/>",
    "<compiler fitaabb='true' balanceinertia='true' inertiafromgeom='true' discardvisual='true' fusestatic='true'/>",
    "<compiler><lengthrange mode='all' useexisting='false' inttotal='5' interval='1' timestep='.01' tolrange='.05' maxforce='10' accel='20' timeconst='1'/></compiler>",
    "<size nkey='2' nuserdata='10' nuser_body='3' nconmax='30' njmax='100' nstack='50000'/>",
    "<custom><numeric name='n' size='5' data='1 2'/><text name='t' data='x'/><tuple name='u'><element objtype='body' objname='world' prm='1'/></tuple></custom>",
    "<texture name='q' type='cube' builtin='checker' mark='cross' width='10' height='10' random='.5'/>",
    "<hfield name='q' nrow='4' ncol='4' size='1 1 1 1'/>",
    "<mesh name='q' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>",
    "<include file='part.xml'/>",
    "<default class='q'><geom size='1'/><default class='r'/></default>",
];

fn sources() -> &'static [Source] {
    static SOURCES: OnceLock<Vec<Source>> = OnceLock::new();
    SOURCES.get_or_init(|| {
        let part = ("part.xml".to_owned(), b"<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>".to_vec());
        let here =
            |name: &str, text: &str, files| Source { name: name.to_owned(), text: text.as_bytes().to_owned(), files };
        let mut all = vec![here("files", assets::TEXT, assets::files()); 3];
        for (name, text) in [
            ("cartpole", sample::CARTPOLE_XML),
            ("colliders", models::COLLIDERS),
            ("adhesion", models::ADHESION),
            ("zoo", models::ZOO),
            ("zoo", models::ZOO),
            ("humanoid", sample::HUMANOID_XML),
            ("every element", models::EVERY_ELEMENT),
        ] {
            all.push(here(name, text, vec![part.clone()]));
        }
        if cfg!(engine_since = "3.0.0") {
            all.extend(NEWER.map(|model| here(model.name, model.text, vec![part.clone()])));
        }
        for path in sample::system_models() {
            let Some(text) = small(&path) else { continue };
            let mut files = Vec::new();
            for entry in path.parent().and_then(|folder| folder.read_dir().ok()).into_iter().flatten().flatten() {
                if let Some(content) = small(&entry.path()) {
                    files.push((entry.file_name().display().to_string(), content));
                }
            }
            files.sort();
            all.push(Source { name: path.display().to_string(), text, files });
        }
        all
    })
}

impl Clone for Source {
    fn clone(&self) -> Self {
        Self { name: self.name.clone(), text: self.text.clone(), files: self.files.clone() }
    }
}

fn small(path: &std::path::Path) -> Option<Vec<u8>> {
    let size = path.metadata().ok().filter(|data| data.is_file())?.len();
    (size > 0 && size <= LONGEST as u64).then(|| std::fs::read(path).ok())?
}

pub(super) fn mutated_text(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let sources = sources();
    let source = &sources[bytes.below(sources.len())];
    log(&source.name);
    let mut text = source.text.clone();
    let mut files = source.files.clone();
    let asset = !files.is_empty() && bytes.once_in(2);
    if asset {
        let which = bytes.below(files.len());
        log(&format!("damage to {}", files[which].0));
        assets::damage(&mut files[which].1, bytes);
    }
    if !asset || bytes.once_in(4) {
        for _ in 0..=bytes.below(4) {
            let other = &sources[bytes.below(sources.len())];
            damage(&mut text, &other.text, bytes);
        }
    }
    let text = String::from_utf8_lossy(&text);
    load_and_use(&text, &files, log)
}

/// Loads a text with files in memory, and uses an accepted model.
pub(super) fn load_and_use(text: &str, files: &[File], log: &mut dyn FnMut(&str)) -> Verdict {
    load(text, files, log).map_or(Verdict::Rejected, |model| use_model(model, log))
}

/// Loads a text with files in memory. An accepted model must survive the binary round trip bit for
/// bit.
pub(super) fn load(text: &str, files: &[File], log: &mut dyn FnMut(&str)) -> Option<Model> {
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (&name[..], &content[..])).collect();
    log(&format!("loading\n{text}\n"));
    for (name, content) in &files {
        log(&format!("{name}: {}", content.escape_ascii()));
    }
    let model = Model::from_xml_str_with(text, &LoadOptions::default().with_files(&files));
    let model = model.inspect_err(|error| log(&error.to_string())).ok()?;
    log("the binary round trip");
    let saved = model.to_binary().expect("a model that loads can be saved");
    match Model::from_binary(&saved) {
        // The rules for binary models are known for 2.2.2 and 3.5.0 only, except for some features.
        Err(Error::Unsupported(_)) => {}
        again => {
            let again = again.expect("a model that was saved loads again").to_binary();
            assert!(again.expect("a model that loads can be saved") == saved, "the binary form changed");
        }
    }
    Some(model)
}

/// Returns one of the strings, with newer engines half of the time one that 2.2.2 lacks.
fn choose<'c>(bytes: &mut Bytes<'_>, all: &[&'c str], newer: &[&'c str]) -> &'c str {
    let is_newer = cfg!(engine_since = "3.0.0") && bytes.once_in(2);
    bytes.choose(if is_newer { newer } else { all })
}

/// Damages a text, possibly with a part of another text.
pub(super) fn damage(text: &mut Vec<u8>, other: &[u8], bytes: &mut Bytes<'_>) {
    let kind = bytes.below(20);
    let attributes = token::attributes(text);
    let tags = token::tags(text);
    if attributes.is_empty() || tags.is_empty() {
        return;
    }
    let attribute = attributes[bytes.below(attributes.len())].clone();
    let first = bytes.below(tags.len());
    match kind {
        0 => drop(text.drain(tags[first].clone())),
        1 => drop(text.drain(token::element(text, &tags, first))),
        2 => {
            let element = token::element(text, &tags, first);
            let copy = text[element.clone()].repeat(1 + bytes.below(3));
            text.splice(element.end..element.end, copy);
        }
        // Moves an element.
        3 => {
            let copy = text[token::element(text, &tags, first)].to_vec();
            let at = tags[bytes.below(tags.len())].end;
            text.splice(at..at, copy);
        }
        4 => {
            let (one, two) = (tags[first].clone(), tags[bytes.below(tags.len())].clone());
            let (one, two) = if one.start < two.start { (one, two) } else { (two, one) };
            if one.end <= two.start {
                let (a, b) = (text[one.clone()].to_vec(), text[two.clone()].to_vec());
                text.splice(two, a);
                text.splice(one, b);
            }
        }
        5 => drop(text.drain(attribute.whole())),
        // Moves an attribute.
        6 | 7 => {
            let copy = [b" ", &text[attribute.whole()]].concat();
            insert_attribute(text, &tags[first], &copy);
        }
        8 => {
            let others = token::attributes(other);
            if let Some(donor) = others.get(bytes.below(others.len())) {
                let copy = [b" ", &other[donor.whole()]].concat();
                insert_attribute(text, &tags[first], &copy);
            }
        }
        9 => {
            let donor = text[attributes[bytes.below(attributes.len())].value.clone()].to_vec();
            text.splice(attribute.value, donor);
        }
        10 => {
            let value = choose(bytes, &VALUES, &newer_models::VALUES);
            text.splice(attribute.value, value.bytes());
        }
        11 => {
            let others = token::tags(other);
            if !others.is_empty() {
                let copy = other[token::element(other, &others, bytes.below(others.len()))].to_vec();
                let at = tags[first].end;
                text.splice(at..at, copy);
            }
        }
        12 => {
            let piece = choose(bytes, &PIECES, &newer_models::PIECES);
            let at = tags[first].end;
            text.splice(at..at, piece.bytes());
        }
        13 => {
            let at = bytes.below(text.len());
            text[at] = bytes.word() as u8;
        }
        14 => {
            if bytes.once_in(4) {
                text.truncate(bytes.below(text.len()));
            } else {
                let at = bytes.below(text.len());
                text[at] ^= 1 << bytes.below(7);
            }
        }
        _ => number(text, &attribute.value, bytes),
    }
}

/// Replaces a number of a value by an extreme number.
fn number(text: &mut Vec<u8>, value: &Range<usize>, bytes: &mut Bytes<'_>) {
    let words = token::words(text, value);
    let number = bytes.choose(&NUMBERS);
    match words.get(bytes.below(words.len() + 1)) {
        Some(word) => text.splice(word.clone(), number.bytes()),
        None => text.splice(value.clone(), number.bytes()),
    };
}

/// Inserts an attribute at the end of a tag.
fn insert_attribute(text: &mut Vec<u8>, tag: &Range<usize>, attribute: &[u8]) {
    let slash = usize::from(text[tag.end - 2] == b'/');
    let at = tag.end - 1 - slash;
    text.splice(at..at, attribute.iter().copied());
}
