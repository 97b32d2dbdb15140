//! Generates the fields of the views in `src/element` that 2.2.2 does not have, from the engine's
//! field table. Those of 2.2.2 are written by hand.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write as _;

use crate::accessors;
use crate::facts::{BY_HAND, WITHOUT_ACCESSOR};

/// Kinds with a view on a model: the lookup method, and the size that counts the elements.
const KINDS: [(&str, &str, &str); 23] = [
    ("Body", "body", "nbody"),
    ("Joint", "joint", "njnt"),
    ("Geom", "geom", "ngeom"),
    ("Site", "site", "nsite"),
    ("Camera", "camera", "ncam"),
    ("Light", "light", "nlight"),
    ("Tendon", "tendon", "ntendon"),
    ("Actuator", "actuator", "nactuator"),
    ("Sensor", "sensor", "nsensor"),
    ("Mesh", "mesh", "nmesh"),
    ("Skin", "skin", "nskin"),
    ("HeightField", "height_field", "nhfield"),
    ("Texture", "texture", "ntex"),
    ("Material", "material", "nmat"),
    ("Pair", "pair", "npair"),
    ("Exclude", "exclude", "nexclude"),
    ("Equality", "equality", "neq"),
    ("Numeric", "numeric", "nnumeric"),
    ("Text", "text", "ntext"),
    ("Tuple", "tuple", "ntuple"),
    ("Keyframe", "keyframe", "nkey"),
    ("Flex", "flex", "nflex"),
    ("Plugin", "plugin_instance", "nplugin"),
];

/// Kinds that also have a view on a simulation.
const IN_DATA: [&str; 12] =
    ["Body", "Joint", "Geom", "Site", "Camera", "Light", "Tendon", "Actuator", "Sensor", "Equality", "Flex", "Plugin"];

/// Rows of an array that belong to one element.
#[derive(Clone, Copy)]
struct Rows {
    /// Name in the lists of the tests.
    name: &'static str,
    /// Range, as Rust code in a method of a view.
    range: &'static str,
}

const fn rows(name: &'static str, range: &'static str) -> Rows {
    Rows { name, range }
}

/// Arrays whose rows are parts of elements: the size, the kind, and the rows of an element.
const PARTS: [(&str, &str, Rows); 22] = [
    ("nv", "Joint", rows("dofs", "self.in_model().dofs()")),
    ("nq", "Joint", rows("positions", "self.in_model().qpos_range()")),
    ("nu", "Actuator", rows("controls", "self.in_model().controls()")),
    ("nout", "Actuator", rows("outputs", "self.in_model().outputs()")),
    ("na", "Actuator", rows("activations", "self.in_model().activations()")),
    ("nflexvert", "Flex", rows("vertices", "range(model.flex_vertadr(), model.flex_vertnum(), self.id.index())")),
    ("nflexedge", "Flex", rows("edges", "range(model.flex_edgeadr(), model.flex_edgenum(), self.id.index())")),
    ("nflexelem", "Flex", rows("elements", "range(model.flex_elemadr(), model.flex_elemnum(), self.id.index())")),
    ("nflexnode", "Flex", rows("nodes", "range(model.flex_nodeadr(), model.flex_nodenum(), self.id.index())")),
    (
        "nflexelemdata",
        "Flex",
        rows("element_data", "to_next(model.flex_elemdataadr(), self.id.index(), model.nflexelemdata())"),
    ),
    (
        "nflexelemedge",
        "Flex",
        rows("element_edges", "to_next(model.flex_elemedgeadr(), self.id.index(), model.nflexelemedge())"),
    ),
    (
        "nflexshelldata",
        "Flex",
        rows("shell_data", "to_next(model.flex_shelldataadr(), self.id.index(), model.nflexshelldata())"),
    ),
    (
        "nflexstiffness",
        "Flex",
        rows("stiffness", "to_next(model.flex_stiffnessadr(), self.id.index(), model.nflexstiffness())"),
    ),
    (
        "nflexbending",
        "Flex",
        rows("bending", "to_next(model.flex_bendingadr(), self.id.index(), model.nflexbending())"),
    ),
    (
        "nflextexcoord",
        "Flex",
        rows("texcoords", "to_next(model.flex_texcoordadr(), self.id.index(), model.nflextexcoord())"),
    ),
    ("nflexevpair", "Flex", rows("evpairs", "range(model.flex_evpairadr(), model.flex_evpairnum(), self.id.index())")),
    ("nmeshpoly", "Mesh", rows("polygons", "range(model.mesh_polyadr(), model.mesh_polynum(), self.id.index())")),
    ("noct", "Mesh", rows("octree", "range(model.mesh_octadr(), model.mesh_octnum(), self.id.index())")),
    ("nmeshvert", "Mesh", rows("mesh_vertices", "self.vert_range()")),
    (
        "nmeshpolyvert",
        "Mesh",
        rows(
            "polygon_vertices",
            "of_parts(range(model.mesh_polyadr(), model.mesh_polynum(), self.id.index()), model.mesh_polyvertadr(), model.mesh_polyvertnum())",
        ),
    ),
    (
        "nmeshpolymap",
        "Mesh",
        rows("polygon_map", "of_parts(self.vert_range(), model.mesh_polymapadr(), model.mesh_polymapnum())"),
    ),
    (
        "npluginstate",
        "Plugin",
        rows("states", "range(model.plugin_stateadr(), model.plugin_statenum(), self.id.index())"),
    ),
];

/// Prefixes of the engine's names that the fields of a view do not have. Those of parts of a flex
/// keep the name of the part.
const PREFIXES: [(&str, &str); 24] = [
    ("body_", ""),
    ("jnt_", ""),
    ("dof_", ""),
    ("geom_", ""),
    ("site_", ""),
    ("cam_", ""),
    ("light_", ""),
    ("tendon_", ""),
    ("ten_", ""),
    ("actuator_", ""),
    ("sensor_", ""),
    ("mesh_", ""),
    ("skin_", ""),
    ("hfield_", ""),
    ("tex_", ""),
    ("mat_", ""),
    ("pair_", ""),
    ("eq_", ""),
    ("key_", ""),
    ("flex_", ""),
    ("flexvert_", "vert_"),
    ("flexedge_", "edge_"),
    ("flexelem_", "elem_"),
    ("plugin_", ""),
];

/// Words that are no names in Rust.
const KEYWORDS: &str = "abstract as async await become box break const continue \
    crate do dyn else enum extern false final fn for gen if impl in let loop macro match \
    mod move mut override priv pub ref return self static struct super trait true try type typeof unsafe unsized use virtual where while yield";

/// Line of the field table, and the place of an element in the array.
struct Field<'t> {
    name: &'t str,
    ctype: &'t str,
    columns: &'t str,
    comment: &'t str,
    /// Rows of an element, or `None` for one row.
    range: Option<Rows>,
}

/// Names of the hand-written fields of a kind on an owner.
type Names = HashMap<(String, String), HashSet<String>>;

/// Returns the source of the views' fields, for `src/element/newer.rs`, and the lists with which
/// the tests read each of them. `element` is the source of `src/element`.
pub(crate) fn generate(table: &str, default: &str, version: u32, element: &str) -> [String; 2] {
    let hand_written = hand_written(element);
    let in_default: HashMap<[&str; 2], &str> =
        accessors::cells(default).map(|[owner, _, _, name, _, columns, _]| ([owner, name], columns)).collect();
    let mut fields: BTreeMap<(usize, &str), Vec<Field<'_>>> = BTreeMap::new();
    for [owner, kind, ctype, name, rows, columns, comment] in accessors::cells(table) {
        let is_older = in_default.get(&[owner, name]).is_some_and(|same| *same == columns);
        if kind != "array" || is_older || !is_of_element(name, ctype) {
            continue;
        }
        let Some((kind, range)) = place(rows, version) else { continue };
        let owner = if owner == "Data" { "Data" } else { "Model" };
        let index = KINDS.iter().position(|(name, ..)| *name == kind).expect("a kind of the table");
        if owner == "Model" || IN_DATA.contains(&kind) {
            fields.entry((index, owner)).or_default().push(Field { name, ctype, columns, comment, range });
        }
    }
    let mut methods = String::new();
    let mut lists = [String::new(), String::new()];
    for (index, (kind, one, count)) in KINDS.iter().enumerate() {
        for owner in ["Model", "Data"] {
            if owner == "Data" && !IN_DATA.contains(kind) {
                continue;
            }
            let taken = hand_written.get(&((*kind).to_owned(), owner.to_owned()));
            let mut view = View { kind, owner, readers: String::new(), names: Vec::new() };
            for field in fields.get(&(index, owner)).into_iter().flatten() {
                let short = short(field.name);
                let is_taken = |name: &str| {
                    KEYWORDS.split(' ').any(|word| word == name)
                        || taken.is_some_and(|taken| taken.contains(name))
                        || view.names.iter().any(|other| other == name)
                };
                // An array of 2.2.2 with another shape, which the view adapts.
                if is_taken(&short) && in_default.contains_key(&[owner, field.name]) {
                    continue;
                }
                let method = if is_taken(&short) { field.name.to_owned() } else { short };
                if !is_taken(&method) && view.add(field, &method) {
                    let columns = match columns(field.columns) {
                        Columns::Fixed(number) => format!("|_: &Model| {}", number.replace("mujoco_sys", "sys")),
                        Columns::Size(size) => format!("|model: &Model| model.{size}()"),
                    };
                    let range = field.range.map_or("own", |rows| rows.name);
                    let list = &mut lists[usize::from(owner == "Data")];
                    let _ =
                        writeln!(list, "            {one} {count} {method} {} {{ {columns} }} {range};", field.name);
                }
            }
            methods.push_str(&view.text());
        }
    }
    let list = |name: &str, entries: &str| {
        format!(
            "macro_rules! {name} {{\n    ($then:ident) => {{\n        $then! {{\n{entries}        }}\n    }};\n}}\n"
        )
    };
    [methods, list("model_view_fields", &lists[0]) + &list("data_view_fields", &lists[1])]
}

/// Returns `false` for fields with a hand-written accessor or without one, and for arrays whose
/// rows are not values of elements: sparse matrices and lists of indices.
fn is_of_element(name: &str, ctype: &str) -> bool {
    let is_index = ["_rownnz", "_rowadr", "_colind", "_ind", "D_diag"].iter().any(|suffix| name.ends_with(suffix));
    let is_list = ["map_", "island_", "name_"].iter().any(|prefix| name.starts_with(prefix));
    !is_index && !is_list && !BY_HAND.contains(&name) && !WITHOUT_ACCESSOR.contains(&ctype)
}

/// Returns the kind of the elements with rows in an array, and the range of an element if its rows
/// are parts of elements.
fn place(rows: &str, version: u32) -> Option<(&'static str, Option<Rows>)> {
    // Before 3.11 each actuator has one control.
    if rows == "nu" && version < 3_011_000 {
        return Some(("Actuator", None));
    }
    let own = KINDS.iter().find(|(.., count)| *count == rows).map(|(kind, ..)| (*kind, None));
    own.or_else(|| PARTS.iter().find(|(size, ..)| *size == rows).map(|&(_, kind, range)| (kind, Some(range))))
}

/// Returns the name of a field of a view.
fn short(name: &str) -> String {
    let prefix = PREFIXES.iter().find(|(prefix, _)| name.starts_with(prefix));
    prefix.map_or(name.to_owned(), |(prefix, part)| format!("{part}{}", &name[prefix.len()..]))
}

enum Columns {
    Fixed(String),
    Size(String),
}

fn columns(columns: &str) -> Columns {
    if columns.starts_with("mjN") {
        Columns::Fixed(format!("{{ mujoco_sys::{columns} as usize }}"))
    } else if columns.bytes().all(|byte| byte.is_ascii_digit()) {
        Columns::Fixed(columns.to_owned())
    } else {
        Columns::Size(columns.to_owned())
    }
}

/// View of a kind on an owner, with its generated methods.
struct View<'t> {
    kind: &'t str,
    owner: &'t str,
    readers: String,
    names: Vec<String>,
}

impl View<'_> {
    /// Adds a field. Returns `false` for a shape that no view has: a range of rows of a matrix.
    fn add(&mut self, field: &Field<'_>, method: &str) -> bool {
        let array = field.name;
        // Every byte of an element that 2.2.2 does not have is a switch.
        let is_switch = matches!(field.ctype, "mjtByte" | "mjtBool");
        let element = accessors::rust_type(field.ctype);
        let at = field.range.map_or("self.id.index()", |rows| rows.range);
        let model = if at.contains("model.") { "let model = self.owner.model_of();\n        " } else { "" };
        let (result, value) = match (columns(field.columns), field.range) {
            (Columns::Fixed(one), None) if one == "1" && is_switch => {
                ("bool".to_owned(), format!("self.owner.{array}()[{at}] != 0"))
            }
            (Columns::Fixed(one), None) if one == "1" => (element.to_owned(), format!("self.owner.{array}()[{at}]")),
            (Columns::Fixed(one), Some(_)) if one == "1" => {
                (format!("&'a [{element}]"), format!("&self.owner.{array}()[{at}]"))
            }
            (Columns::Fixed(number), None) => {
                (format!("&'a [{element}; {number}]"), format!("&self.owner.{array}()[{at}]"))
            }
            (Columns::Fixed(number), Some(_)) => {
                (format!("&'a [[{element}; {number}]]"), format!("&self.owner.{array}()[{at}]"))
            }
            (Columns::Size(_), None) if element == "f64" => {
                ("&'a [f64]".to_owned(), format!("self.owner.{array}().row({at})"))
            }
            (Columns::Size(_), _) => return false,
        };
        // rustdoc rejects an alias that is the name.
        let alias = if method == array { String::new() } else { format!("    #[doc(alias = \"{array}\")]\n") };
        let _ = writeln!(
            self.readers,
            "    /// {}\n    ///\n    /// Engine array `{array}`.\n{alias}    #[inline]\n    pub fn {method}(&self) -> {result} {{\n        {model}{value}\n    }}\n",
            accessors::meaning(field.comment)
        );
        self.names.push(method.to_owned());
        true
    }

    /// Returns the `impl` blocks.
    fn text(&self) -> String {
        let Self { kind, owner, readers, names } = self;
        let suffix = if *owner == "Data" { "Data" } else { "" };
        let mut text = String::new();
        if !readers.is_empty() {
            let _ = writeln!(
                text,
                "/// # Newer fields of [`{kind}{suffix}`](crate::element::{kind}{suffix})\nimpl<'a> View<'a, {owner}, kind::{kind}> {{\n{readers}}}\n"
            );
        }
        let pairs: Vec<String> = names.iter().map(|name| format!("(\"{name}\", Box::new(self.{name}()))")).collect();
        let list = pairs.join(", ");
        let _ = writeln!(
            text,
            "impl<'a> NewerFields<'a> for View<'a, {owner}, kind::{kind}> {{\n    fn newer_fields(&self) -> Vec<(&'static str, Box<dyn Debug + 'a>)> {{\n        vec![{list}]\n    }}\n}}\n"
        );
        text
    }
}

/// Returns the names of the hand-written fields and methods of each kind on each owner.
fn hand_written(element: &str) -> Names {
    let functions =
        element.split("pub fn ").skip(1).filter_map(|rest| rest.split(['(', '<']).next()).map(str::to_owned);
    let functions: HashSet<String> = functions.collect();
    let mut names: Names = HashMap::new();
    for block in element.split("\nfields!(").skip(1) {
        let (head, body) = block.split_once('{').expect("a block of fields");
        let (kind, owner) = head.trim().split_once(" on ").expect("a kind on an owner");
        let body = body.split("\n});").next().unwrap_or_default();
        let lines = body.lines().filter_map(|line| line.strip_prefix("    "));
        let fields = lines.filter_map(|line| line.split_once(": ")).map(|(name, _)| name.to_owned());
        names.entry((kind.to_owned(), owner.trim().to_owned())).or_insert_with(|| functions.clone()).extend(fields);
    }
    names
}
