//! Limits on the values in a text that determine how much memory the compiler allocates and how far
//! it writes.

use std::collections::HashSet;
use std::sync::OnceLock;

use super::assets::{MOST_NUMBERS, NEEDS_TEXTURE_INDICES};
use super::files::abbreviated;
use super::tags::{Tag, decoded, numbers};

/// Largest number of keyframes, and of user values of an element. Above the needs of any model, and
/// low enough to bound the time and the memory of the compiler.
const MOST_KEYS: u64 = 10_000;
const MOST_USER: u64 = 10_000;
/// Largest number of user values of a simulation.
const MOST_USERDATA: u64 = 100_000_000;
/// Largest number of values in an element of `custom`: the size of the compiler's array.
const MOST_CUSTOM: u64 = 500;
/// Largest depth of models that have other models as assets. The compiler recurses.
const MOST_MODELS: usize = 20;
/// Largest number of samples of a delay, and of contacts that a sensor returns.
const MOST_VALUES: u64 = 10_000;
/// Size of a texture that is assumed if a text gives only the other size: the limit of squares.
const SQUARE_TEXTURE: u64 = 12_900;
/// Largest parameter of a mesh that the compiler generates.
const MOST_PARAMETER: f64 = 1000.0;
/// The same for meshes whose number of vertices is the square of a parameter. The time of the
/// compiler grows with the square of that number: 5 s for 200, a minute for 400.
const MOST_GRID_PARAMETER: f64 = 200.0;
/// Largest number of vertices of a flex whose shape few nodes determine, and of these nodes, which
/// are bodies.
const MOST_VERTICES: u64 = 100_000;
const MOST_NODES: u64 = 32_766;
/// Largest product of the integers in an attribute that this crate does not know.
const MOST_UNKNOWN: u64 = 1_000_000;
/// Attributes of the engines whose compilers have been examined. Those that determine a size have a
/// limit.
const ATTRIBUTES: &str = include_str!("attributes.txt");
/// Largest number of vertices of the skin of a composite.
const MOST_SKIN: u64 = 4_000_000;

/// Returns the number in an attribute, `default` if the attribute is missing, and a very large
/// number if it cannot be parsed.
pub(super) fn size(tag: &Tag<'_>, name: &[u8], default: u64) -> u64 {
    tag.attribute(name).map_or(default, |value| {
        std::str::from_utf8(value.trim_ascii())
            .ok()
            .and_then(|value| value.parse::<f64>().ok())
            // The compiler's parser truncates numbers that do not fit into a C int.
            .filter(|&value| value >= f64::from(i32::MIN))
            .map_or(u64::MAX, |value| value.max(0.0) as u64)
    })
}

/// Returns `true` if nodes of a grid determine the shape of a flex. It then has a body for each
/// node instead of each vertex.
pub(super) fn is_interpolated(tag: &Tag<'_>) -> bool {
    matches!(tag.attribute(b"dof").as_deref(), Some(b"trilinear" | b"quadratic"))
}

/// Returns the product of the numbers in an attribute, each increased by `more` and at least 1.
pub(super) fn product(tag: &Tag<'_>, name: &[u8], more: u64) -> u64 {
    numbers(&tag.attribute(name).unwrap_or_default())
        .map(|number| number.map_or(1 << 40, |number| u64::try_from(number).unwrap_or(0).saturating_add(more).max(1)))
        .fold(1, u64::saturating_mul)
}

/// Roles of textures in a material.
const ROLES: [&str; 9] = ["rgb", "occlusion", "roughness", "metallic", "normal", "opacity", "emissive", "rgba", "orm"];

fn is_role(role: &[u8]) -> bool {
    ROLES.iter().any(|known| known.as_bytes() == role)
}

/// Returns the number of nodes of the cells of a flex. A quadratic cell has twice the nodes of a
/// trilinear one along each axis.
fn nodes(tag: &Tag<'_>) -> u64 {
    let is_quadratic = tag.attribute(b"dof").as_deref() == Some(b"quadratic");
    product(tag, b"cellcount", 1).saturating_mul(if is_quadratic { 8 } else { 1 })
}

/// Returns the reason to reject a tag: sizes whose product overflows in the compiler or exhausts
/// memory, or faces of a mesh with nonexistent vertices. `composite` is the count of the composite
/// that contains the tag.
pub(super) fn reject(tag: &Tag<'_>, composite: &[u64]) -> Option<String> {
    let too_many = |name: &str, most: u64| Some(format!("{name} must be an integer of at most {most}"));
    // The rules for a file depend on its format.
    if [&b"mesh"[..], b"hfield", b"skin", b"texture"].contains(&tag.name)
        && let Some(format) = tag.attribute(b"content_type")
        && !is_format_of(&format, &tag.attribute(b"file").unwrap_or_default())
    {
        return Some("a content_type must be that of the file's extension".to_owned());
    }
    match tag.name {
        b"contact" | b"rangefinder" if size(tag, b"num", 0) > MOST_VALUES => too_many("num", MOST_VALUES),
        _ if size(tag, b"nsample", 0) > MOST_VALUES => too_many("nsample", MOST_VALUES),
        _ if size(tag, b"actdim", 0) > MOST_VALUES => too_many("actdim", MOST_VALUES),
        // The compiler reads beyond the layers of a flex if none is active.
        _ if !(1..=i32::MAX as u64).contains(&size(tag, b"activelayers", 1)) => {
            Some("activelayers must be an integer from 1".to_owned())
        }
        // The compiler crashes without cells, and on negative counts with a positive product.
        _ if numbers(&tag.attribute(b"cellcount").unwrap_or_default()).flatten().any(|count| count < 1) => {
            Some("cellcount must be at least 1".to_owned())
        }
        _ if nodes(tag) > MOST_NODES => Some("a flex is too large".to_owned()),
        // The compiler of 4.0 crashes if the model has keyframes too. It knows no frame that it
        // could find.
        _ if cfg!(engine_since = "4.0.0")
            && [&b"objtype"[..], b"reftype"].iter().any(|name| tag.attribute(name).as_deref() == Some(b"frame")) =>
        {
            Some("a frame is not an object that a sensor or a tuple can refer to".to_owned())
        }
        // The compiler of 3.5 raises an error that keeps it locked.
        b"layer" if cfg!(not(engine_since = "3.17.0")) && !tag.attribute(b"role").is_none_or(|role| is_role(&role)) => {
            Some(format!("the role of a layer must be one of {}", ROLES.join(", ")))
        }
        b"texture" => {
            // A size that is missing may be that of a class, or the other one may be.
            let (width, height) = match ([&b"width"[..], b"height"]).map(|name| tag.attribute(name).is_some()) {
                [false, false] => (0, 0),
                _ => (size(tag, b"width", SQUARE_TEXTURE), size(tag, b"height", SQUARE_TEXTURE)),
            };
            // A cube map is six squares.
            let height = height.max(width.saturating_mul(6));
            let gridsize = tag.attribute(b"gridsize").unwrap_or_default();
            let mut grid = numbers(&gridsize);
            if grid.any(|number| number.is_none_or(|number| number > 12)) {
                return Some("a gridsize must be at most 12".to_owned());
            }
            // The compiler writes three bytes for each pixel of a generated texture, and reads
            // three for each pixel of a cube.
            let channels = size(tag, b"nchannel", 3);
            let is_generated = tag.attribute(b"builtin").is_some_and(|builtin| *builtin != *b"none");
            if channels < 3 && (is_generated || tag.attribute(b"type").as_deref() != Some(b"2d")) {
                return Some("a builtin texture and a cube must have 3 or 4 channels".to_owned());
            }
            let channels = channels.max(3);
            let numbers = width.saturating_mul(height).saturating_mul(channels);
            (numbers > MOST_NUMBERS || channels > 4).then(|| "a texture is too large".to_owned())
        }
        b"hfield" => (size(tag, b"nrow", 0).saturating_mul(size(tag, b"ncol", 0)) > MOST_NUMBERS)
            .then(|| "a height field is too large".to_owned()),
        b"mesh" => mesh(tag),
        b"size" => {
            if size(tag, b"nkey", 0) > MOST_KEYS {
                return too_many("nkey", MOST_KEYS);
            }
            if size(tag, b"nuserdata", 0) > MOST_USERDATA {
                return too_many("nuserdata", MOST_USERDATA);
            }
            let users = ["body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor"]
                .map(|kind| format!("nuser_{kind}"));
            let user = users.iter().find(|user| size(tag, user.as_bytes(), 0) > MOST_USER)?;
            too_many(user, MOST_USER)
        }
        b"numeric" => {
            let data = numbers(&tag.attribute(b"data").unwrap_or_default()).count() as u64;
            (size(tag, b"size", 1) > MOST_CUSTOM || data > MOST_CUSTOM)
                .then(|| format!("a custom numeric has more than {MOST_CUSTOM} numbers"))
        }
        // The compiler of 3.5 adds points without end.
        b"flexcomp"
            if cfg!(not(engine_since = "3.17.0"))
                && matches!(tag.attribute(b"type").as_deref(), Some(b"box" | b"cylinder" | b"ellipsoid"))
                && numbers(&tag.attribute(b"count").unwrap_or_default()).any(|count| count == Some(1)) =>
        {
            Some("the count of a box, a cylinder or an ellipsoid must be at least 2".to_owned())
        }
        b"flexcomp" if is_interpolated(tag) && product(tag, b"count", 0) > MOST_VERTICES => {
            Some("a flex is too large".to_owned())
        }
        b"skin" if !composite.is_empty() => {
            let subgrid = size(tag, b"subgrid", 0).min(MOST_SKIN);
            let vertices = composite
                .iter()
                .fold(1, |product: u64, count| product.saturating_mul(count.saturating_mul(subgrid + 1)));
            (vertices > MOST_SKIN && subgrid > 0).then(|| "the skin of a composite is too large".to_owned())
        }
        _ => None,
    }
}

/// Returns the reason to reject integers in an attribute that no examined compiler has. A new one
/// may be a size, whose limit is not known.
pub(super) fn reject_unknown(tag: &Tag<'_>) -> Option<String> {
    static KNOWN: OnceLock<HashSet<&[u8]>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| ATTRIBUTES.lines().map(str::as_bytes).collect());
    // Numbers with a point or an exponent are not sizes.
    let integer = |word: &[u8]| {
        let append = |number: u64, digit: &u8| number.saturating_mul(10).saturating_add(u64::from(digit - b'0'));
        word.iter().all(u8::is_ascii_digit).then(|| word.iter().fold(0, append))
    };
    let product = |value: &[u8]| {
        let words = value.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.filter_map(integer).fold(1, |product: u64, size| product.saturating_mul(size.max(1)))
    };
    let unknown =
        tag.attributes().find(|(name, value)| !known.contains(name) && product(&decoded(value)) > MOST_UNKNOWN);
    unknown.map(|(name, _)| {
        let name = String::from_utf8_lossy(name);
        format!("the attribute '{name}' is unknown to this crate, and has integers with a product of more than {MOST_UNKNOWN}")
    })
}

/// Returns the reason to reject a model that is an asset, inside `depth` models. Without a file the
/// compiler crashes. Plugins can read other formats, which are not checked.
pub(super) fn reject_model(tag: &Tag<'_>, depth: usize) -> Option<String> {
    if depth >= MOST_MODELS {
        return Some(format!(
            "models are nested more than {MOST_MODELS} deep as assets; a model must not contain itself"
        ));
    }
    let Some(name) = tag.attribute(b"file") else {
        return Some("a model as an asset (<model>) needs a file".to_owned());
    };
    let is_xml = tag.attribute(b"content_type").as_deref() == Some(b"text/xml")
        || name.ends_with(b".xml")
        || name.ends_with(b".urdf");
    (!is_xml).then(|| {
        let name = abbreviated(&name);
        format!("the model file '{name}' must end in .xml or .urdf, or have the content_type text/xml")
    })
}

/// Returns `true` if a file has the extension of a format.
fn is_format_of(format: &[u8], file: &[u8]) -> bool {
    let extensions: [(&[u8], &[u8]); 5] = [
        (b"image/png", b".png"),
        (b"image/ktx", b".ktx"),
        (b"model/obj", b".obj"),
        (b"model/stl", b".stl"),
        (b"model/vnd.mujoco.msh", b".msh"),
    ];
    extensions.into_iter().any(|(name, end)| {
        name == format && file.len() >= end.len() && file[file.len() - end.len()..].eq_ignore_ascii_case(end)
    })
}

fn mesh(tag: &Tag<'_>) -> Option<String> {
    // Numbers of vertices of a generated mesh, or of its subdivisions.
    let params = tag.attribute(b"params").unwrap_or_default();
    let builtin = tag.attribute(b"builtin").unwrap_or_default();
    let has_grid = [&b"supersphere"[..], b"supertorus", b"plate", b"wedge"].contains(&&*builtin);
    let most = if has_grid { MOST_GRID_PARAMETER } else { MOST_PARAMETER };
    let is_moderate = |word: &str| word.parse().is_ok_and(|number: f64| number.abs() <= most);
    if !builtin.is_empty() && !String::from_utf8_lossy(&params).split_whitespace().all(is_moderate) {
        return Some(format!("a parameter of a generated mesh must be a number of at most {most}"));
    }
    // The compiler would combine arrays of different lengths from the file and the text.
    if let Some(array) =
        [&b"vertex"[..], b"normal", b"texcoord", b"face"].into_iter().find(|name| tag.attribute(name).is_some())
        && tag.attribute(b"file").is_some()
    {
        return Some(format!("a mesh has both a file and an attribute '{}'", String::from_utf8_lossy(array)));
    }
    if NEEDS_TEXTURE_INDICES && tag.attribute(b"texcoord").is_some() {
        return Some(
            "MuJoCo 2.3.3 to 3.1.2 cannot compile a mesh with texture coordinates in the text: use an OBJ file"
                .to_owned(),
        );
    }
    let vertex = tag.attribute(b"vertex")?;
    let reals = |list: &[u8]| {
        String::from_utf8_lossy(list).split_whitespace().all(|word| word.parse().is_ok_and(f32::is_finite))
    };
    if !reals(&vertex) {
        return Some("a vertex of a mesh is not finite".to_owned());
    }
    let vertices = numbers(&vertex).count() / 3;
    let outside = numbers(&tag.attribute(b"face")?)
        .find(|vertex| !vertex.is_some_and(|vertex| usize::try_from(vertex).is_ok_and(|it| it < vertices)));
    outside.map(|_| format!("a face of a mesh has an index that is not a vertex from 0 to {}", vertices.max(1) - 1))
}

#[cfg(test)]
mod tests {
    use super::ATTRIBUTES;

    /// The list has the attributes of the engines of the full tier. A new attribute may be a size:
    /// give it a limit, or add it to the list.
    #[test]
    #[cfg(tested_in_full)]
    fn all_attributes_of_the_engine_are_known() {
        let known: Vec<&str> = ATTRIBUTES.lines().collect();
        let schema = crate::model::schema().unwrap();
        let unknown: Vec<&str> = schema
            .lines()
            .flat_map(|line| line.rsplit(')').next().unwrap_or_default().split_whitespace())
            .filter(|attribute| !known.contains(attribute))
            .collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
}
