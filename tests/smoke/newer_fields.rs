//! The fields of the views that 2.2.2 does not have: each value is the row of its element in the
//! engine's array. The independent sources are the arrays, read through the C structs, and the
//! table of the engine's fields.

#![cfg_attr(not(engine_since = "2.3.0"), allow(dead_code, unused_mut, reason = "2.2.2 has no newer fields"))]

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use mujoco_safe::{Data, Model, sys};

#[macro_use]
#[allow(unused_macros, reason = "2.2.2 has no newer fields")]
mod lists {
    include!(concat!(env!("OUT_DIR"), "/view_fields.rs"));
}

/// The bits of the values of a field.
trait Bits {
    fn bits(&self) -> Vec<u64>;
}

macro_rules! bits {
    ($($type:ty => |$value:ident| $bits:expr),*) => {$(
        impl Bits for $type {
            fn bits(&self) -> Vec<u64> {
                let $value = *self;
                vec![u64::from($bits)]
            }
        }
    )*};
}
bits!(bool => |value| value, u8 => |value| value, f64 => |value| value.to_bits(), f32 => |value| value.to_bits(),
    i32 => |value| value.cast_unsigned());

impl<T: Bits> Bits for [T] {
    fn bits(&self) -> Vec<u64> {
        self.iter().flat_map(Bits::bits).collect()
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn bits(&self) -> Vec<u64> {
        self.as_slice().bits()
    }
}

impl<T: Bits + ?Sized> Bits for &T {
    fn bits(&self) -> Vec<u64> {
        (*self).bits()
    }
}

/// Returns rows of an array of the engine.
fn values<T: Bits + Copy>(array: *const T, range: Range<usize>, columns: usize) -> Vec<u64> {
    if range.is_empty() || columns == 0 {
        return Vec::new();
    }
    // SAFETY: the tests pass an array of a living model or data, and rows within it.
    unsafe { std::slice::from_raw_parts(array.add(range.start * columns), range.len() * columns) }.bits()
}

/// Returns the rows of an element in an array whose rows are parts of elements, by the addresses in
/// the engine's struct.
#[allow(unused_variables, reason = "2.2.2 has no newer fields")]
fn rows_of(model: &Model, rows: &str, index: usize) -> Range<usize> {
    // SAFETY: an array of the model with a number for each element.
    let at = |array: *const i32, index: usize| usize::try_from(unsafe { *array.add(index) }).unwrap_or(0);
    // SAFETY: a living model.
    let raw = unsafe { &*model.as_ptr() };
    let part = |first: *const i32, count: *const i32| at(first, index)..at(first, index) + at(count, index);
    // An address of the next joint, or the end.
    let to_next = |first: *const i32, end: usize| {
        at(first, index)..if index + 1 < model.njnt() { at(first, index + 1) } else { end }
    };
    // From an address to the least of those behind it.
    let following = |first: *const i32, end: usize| {
        // SAFETY: an array of the model with a number for each flex.
        let all: Vec<i32> = (0..model.flexes().len()).map(|index| unsafe { *first.add(index) }).collect();
        let own = all[index];
        let next = all.iter().copied().filter(|&other| other > own).min();
        if own < 0 { 0..0 } else { own as usize..next.map_or(end, |next| next as usize) }
    };
    let of_parts = |parts: Range<usize>, first: *const i32, count: *const i32| {
        let start = parts.start;
        let total: usize = parts.clone().map(|part| at(count, part)).sum();
        if parts.is_empty() { 0..0 } else { at(first, start)..at(first, start) + total }
    };
    match rows {
        "own" => index..index + 1,
        "dofs" => to_next(raw.jnt_dofadr, model.nv()),
        "positions" => to_next(raw.jnt_qposadr, model.nq()),
        #[cfg(engine_since = "3.11.0")]
        "controls" => part(raw.actuator_ctrladr, raw.actuator_ctrlnum),
        #[cfg(engine_since = "3.11.0")]
        "outputs" => part(raw.actuator_outadr, raw.actuator_outnum),
        #[cfg(engine_since = "3.0.0")]
        "vertices" => part(raw.flex_vertadr, raw.flex_vertnum),
        #[cfg(engine_since = "3.0.0")]
        "edges" => part(raw.flex_edgeadr, raw.flex_edgenum),
        #[cfg(engine_since = "3.0.0")]
        "elements" => part(raw.flex_elemadr, raw.flex_elemnum),
        #[cfg(engine_since = "3.3.0")]
        "nodes" => part(raw.flex_nodeadr, raw.flex_nodenum),
        #[cfg(engine_since = "3.0.0")]
        "element_data" => {
            let first = at(raw.flex_elemdataadr, index);
            first..first + at(raw.flex_elemnum, index) * (at(raw.flex_dim, index) + 1)
        }
        #[cfg(engine_since = "3.2.3")]
        "element_edges" => {
            let (first, edges) = (at(raw.flex_elemedgeadr, index), [1, 3, 6][at(raw.flex_dim, index) - 1]);
            first..first + at(raw.flex_elemnum, index) * edges
        }
        #[cfg(engine_since = "3.0.0")]
        "shell_data" => {
            let first = at(raw.flex_shelldataadr, index);
            first..first + at(raw.flex_shellnum, index) * at(raw.flex_dim, index)
        }
        #[cfg(engine_since = "3.0.0")]
        "texcoords" => following(raw.flex_texcoordadr, raw.nflextexcoord as usize),
        #[cfg(engine_since = "3.8.0")]
        "stiffness" => following(raw.flex_stiffnessadr, raw.nflexstiffness as usize),
        #[cfg(engine_since = "3.8.1")]
        "bending" => following(raw.flex_bendingadr, raw.nflexbending as usize),
        #[cfg(all(engine_since = "3.0.0", not(engine_since = "3.15.0")))]
        "evpairs" => part(raw.flex_evpairadr, raw.flex_evpairnum),
        #[cfg(engine_since = "3.3.0")]
        "polygons" => part(raw.mesh_polyadr, raw.mesh_polynum),
        #[cfg(engine_since = "3.3.4")]
        "octree" => part(raw.mesh_octadr, raw.mesh_octnum),
        #[cfg(engine_since = "3.3.0")]
        "mesh_vertices" => part(raw.mesh_vertadr, raw.mesh_vertnum),
        #[cfg(engine_since = "3.3.0")]
        "polygon_vertices" => {
            of_parts(part(raw.mesh_polyadr, raw.mesh_polynum), raw.mesh_polyvertadr, raw.mesh_polyvertnum)
        }
        #[cfg(engine_since = "3.3.0")]
        "polygon_map" => of_parts(part(raw.mesh_vertadr, raw.mesh_vertnum), raw.mesh_polymapadr, raw.mesh_polymapnum),
        #[cfg(engine_since = "2.3.0")]
        "states" => part(raw.plugin_stateadr, raw.plugin_statenum),
        other => panic!("no rows: {other}"),
    }
}

/// Arrays with the number of values that were compared and are not zero.
type Seen = BTreeMap<&'static str, usize>;

/// Checks each field of the views of an owner.
#[allow(unused_macros, reason = "2.2.2 has no newer fields")]
macro_rules! check {
    ($($one:ident $count:ident $field:ident $array:ident { $columns:expr } $rows:ident;)*) => {
        /// Checks the views of the elements of one kind for one array.
        fn check_all(owner: &Owner, model: &Model, raw: &Raw, seen: &mut Seen) {
            $({
                let columns: fn(&Model) -> usize = $columns;
                let sum = seen.entry(stringify!($array)).or_default();
                for index in 0..model.$count() {
                    let expected = values(raw.$array, rows_of(model, stringify!($rows), index), columns(model));
                    let view = owner.$one(index).unwrap();
                    assert_eq!(view.$field().bits(), expected, "{view:?}.{}", stringify!($field));
                    *sum += expected.iter().filter(|bits| **bits != 0).count();
                }
            })*
        }
    };
}

#[allow(clippy::wildcard_imports, unused_variables, reason = "2.2.2 has no newer fields")]
mod model_views {
    use super::*;
    type Owner = Model;
    type Raw = sys::mjModel;
    model_view_fields! { check }

    pub fn check_views(model: &Model, seen: &mut Seen) {
        // SAFETY: a living model.
        check_all(model, model, unsafe { &*model.as_ptr() }, seen);
    }
}

#[allow(clippy::wildcard_imports, unused_variables, reason = "2.2.2 has no newer fields")]
mod data_views {
    use super::*;
    type Owner = Data;
    type Raw = sys::mjData;
    data_view_fields! { check }

    pub fn check_views(data: &Data, seen: &mut Seen) {
        // SAFETY: a living data.
        check_all(data, data.model(), unsafe { &*data.as_ptr() }, seen);
    }
}

/// Returns models with the features of newer engines.
fn models() -> Vec<Model> {
    let mut texts = vec![MODEL.to_owned()];
    // The compilers of these versions cannot read its mesh.
    if cfg!(not(all(engine_since = "2.3.3", not(engine_since = "3.1.3")))) {
        texts.push(include_str!("../models/every_element.xml").to_owned());
    }
    if cfg!(engine_since = "3.0.0") {
        texts.push(ACTUATED.to_owned());
    }
    if cfg!(engine_since = "3.0.0") {
        texts.push(FLEX.to_owned());
    }
    let mut models: Vec<Model> = texts.iter().map(|text| Model::from_xml_str(text).unwrap()).collect();
    #[cfg(engine_since = "2.3.6")]
    models.extend(super::plugin::loaded(PLUGIN));
    models
}

const MODEL: &str = r#"<mujoco>
  <worldbody><light pos="0 0 3"/><camera name="eye"/>
    <body><joint name="a" damping="2" stiffness="3" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
</mujoco>"#;

const ACTUATED: &str = r#"<mujoco>
  <worldbody>
    <body gravcomp=".5"><joint name="a" damping="2" stiffness="3" axis="0 1 0" actuatorfrcrange="-1 2"/><geom size=".1" pos=".3 0 0"/></body>
  </worldbody>
  <actuator><motor joint="a"/></actuator>
</mujoco>"#;

const FLEX: &str = r#"<mujoco>
  <worldbody>
    <camera name="eye" sensorsize=".02 .01" resolution="200 100" focal=".03 .03"/>
    <flexcomp name="cloth" type="grid" count="4 3 1" spacing=".1 .1 .1" pos="0 0 1" dim="2" radius="0.01" mass="0.2" rgba="1 0 0 1">
      <edge equality="true"/></flexcomp>
    <flexcomp name="rope" type="grid" count="5 1 1" spacing=".1 .1 .1" pos="0 1 1" dim="1" radius="0.01" mass="0.2"/>
  </worldbody>
</mujoco>"#;

#[cfg(engine_since = "2.3.6")]
const PLUGIN: &str = r#"<mujoco>
  <extension><plugin plugin="mujoco.sensor.touch_grid"><instance name="grid"><config key="size" value="2 2"/>
    <config key="fov" value="20 20"/><config key="gamma" value="0"/><config key="nchannel" value="1"/></instance></plugin></extension>
  <worldbody><body><freejoint/><geom size=".1"/><site name="s"/></body></worldbody>
  <sensor><plugin instance="grid" objtype="site" objname="s"/></sensor>
</mujoco>"#;

/// Starts, parts or ends of the names of arrays that no view reads, and the reasons.
const EXCEPTIONS: [(&str, &str); 27] = [
    ("_rownnz", "index of a sparse matrix"),
    ("_rowadr", "idem"),
    ("_colind", "idem"),
    ("_ind", "list of indices of other elements"),
    ("D_diag", "index of a sparse matrix"),
    ("map_", "list of indices of other elements"),
    ("mapM2", "index of a sparse matrix"),
    ("mapD2", "idem"),
    ("efm", "factor of a matrix of the whole model"),
    ("flexedge_J", "values of a sparse matrix"),
    ("flexvert_J", "idem"),
    ("ten_J", "idem, read by hand: `Tendon::J`"),
    ("actuator_moment", "idem: `Actuator::moment`"),
    ("island_", "constraint islands are no elements"),
    ("tree_", "kinematic trees are no elements; a body has the index of its tree"),
    ("bvh_", "bounding volumes, of bodies, meshes and flexes"),
    ("mesh_facenormal", "read by hand: `Mesh::facenormal`"),
    ("mesh_facetexcoord", "idem: `Mesh::facetexcoord`"),
    ("tex_data", "idem: `Texture::rgb`"),
    ("plugin_attr", "idem: `Plugin::attr`"),
    ("plugin_data", "a pointer of the plugin"),
    ("name_", "idem: the name of a view"),
    ("names_map", "hashes of all names"),
    ("paths", "the paths of all files"),
    ("history", "samples of delays: `Data::read_ctrl_into`, `read_sensor_into`"),
    ("plastic", "plastic deformation of joints, tendons and flexes"),
    ("M", "a sparse matrix: `Data::full_m`"),
];

#[test]
fn every_newer_field_of_a_view_is_the_row_of_its_element() {
    let mut seen = Seen::new();
    for model in models() {
        model_views::check_views(&model, &mut seen);
        let mut data = Data::new(model).unwrap();
        data.qvel_mut().fill(0.1);
        data.step().unwrap();
        data.forward().unwrap();
        data_views::check_views(&data, &mut seen);
    }
    // Those of 2.2.2 are read by hand-written fields (`tests/coverage`).
    let names = |table: &'static str| {
        let cells = table.lines().skip(1).map(|line| line.split('\t').collect::<Vec<_>>());
        cells.filter(|cells| cells[1] == "array").map(|cells| cells[3])
    };
    let first: BTreeSet<&str> = names(include_str!("../../mujoco-sys/fields/v2_2_2.tsv")).collect();
    let is_exception =
        |name: &str| EXCEPTIONS.iter().any(|(part, _)| *part == name || (part.len() > 1 && name.contains(part)));
    let missing: Vec<&str> = names(sys::FIELDS)
        .filter(|&name| !first.contains(name) && !seen.contains_key(name) && !is_exception(name))
        .collect();
    assert!(missing.is_empty(), "no view has these: {missing:?}");
    // The models set values in these.
    let expected: &[(&str, bool)] = &[
        ("jnt_actfrcrange", cfg!(engine_since = "3.0.0")),
        ("body_gravcomp", cfg!(engine_since = "3.0.0")),
        ("qfrc_damper", cfg!(engine_since = "3.0.1")),
        ("cam_resolution", cfg!(engine_since = "3.0.0")),
        ("flex_rgba", cfg!(engine_since = "3.0.0")),
        ("flexvert_xpos", cfg!(engine_since = "3.0.0")),
        ("flexedge_length0", cfg!(engine_since = "3.0.0")),
        ("flex_elem", cfg!(engine_since = "3.0.0")),
        ("flex_shell", cfg!(engine_since = "3.0.0")),
        ("mesh_polyvert", cfg!(engine_since = "3.5.0")),
        ("mesh_polymap", cfg!(engine_since = "3.5.0")),
        ("geom_aabb", cfg!(engine_since = "2.3.7")),
        ("light_intensity", false),
    ];
    for (name, is_set) in expected {
        assert!(!is_set || seen.get(name).is_some_and(|count| *count > 0), "{name}");
    }
    assert_eq!(seen.is_empty(), cfg!(not(engine_since = "2.3.0")));
}

#[test]
fn the_fields_of_flexes_and_plugins_are_found_by_name() {
    let cartpole = mujoco_safe::sample::cartpole();
    assert!(cartpole.flex("cloth").is_err() && cartpole.plugin_instance("grid").is_err());
    assert_eq!((cartpole.flexes().len(), cartpole.plugin_instances().len()), (0, 0));
    #[cfg(engine_since = "3.0.0")]
    {
        let mut data = Data::new(Model::from_xml_str(FLEX).unwrap()).unwrap();
        data.forward().unwrap();
        let model = data.model().clone();
        let cloth = model.flex("cloth").unwrap();
        assert_eq!((cloth.index(), cloth.name(), cloth.vertnum(), cloth.dim()), (0, Some("cloth"), 12, 2));
        assert_eq!(cloth.rgba(), &[1.0, 0.0, 0.0, 1.0]);
        assert_eq!(data.flex("rope").unwrap().vert_xpos(), &data.flexvert_xpos()[12..17]);
        let text = cloth.to_string();
        assert!(text.contains("vertnum:") && text.contains("12"), "{text}");
    }
    #[cfg(engine_since = "3.0.0")]
    if let Some(model) = super::plugin::loaded(PLUGIN) {
        let grid = model.plugin_instance("grid").unwrap();
        assert_eq!((grid.index(), model.sensors().next().unwrap().plugin()), (0, 0));
        // In the order in which the plugin declares them.
        assert!(grid.attr().any(|value| value == "2 2") && grid.attr().any(|value| value == "20 20"));
    }
}
