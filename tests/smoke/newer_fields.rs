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

/// Arrays of the table that no view needs: sparse matrices, and lists of indices of other elements.
const OF_NO_ELEMENT: [&str; 7] = ["_rownnz", "_rowadr", "_colind", "_ind", "D_diag", "map_", "island_"];

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
    // Each array with one row for each element is read: those of 2.2.2 by hand-written fields.
    let sizes = [
        "nbody",
        "njnt",
        "ngeom",
        "nsite",
        "ncam",
        "nlight",
        "ntendon",
        "nactuator",
        "nsensor",
        "nmesh",
        "nskin",
        "nhfield",
        "ntex",
        "nmat",
        "npair",
        "nexclude",
        "neq",
        "nnumeric",
        "ntext",
        "ntuple",
        "nkey",
        "nflex",
        "nplugin",
        "nu",
        "nv",
        "nout",
    ];
    let first = include_str!("../../mujoco-sys/fields/v2_2_2.tsv");
    let names = |table: &'static str| {
        table.lines().skip(1).filter_map(move |line| {
            let cells: Vec<&str> = line.split('\t').collect();
            let is_array =
                cells[1] == "array" && sizes.contains(&cells[4]) && !["char", "uintptr_t"].contains(&cells[2]);
            (is_array && !cells[3].starts_with("name_")).then(|| cells[3])
        })
    };
    let first: BTreeSet<&str> = names(first).collect();
    for name in names(sys::FIELDS) {
        let is_list = OF_NO_ELEMENT.iter().any(|part| name.contains(part));
        assert!(is_list || first.contains(name) || seen.contains_key(name), "{name}");
    }
    // The models set values in these.
    let expected: &[(&str, bool)] = &[
        ("jnt_actfrcrange", cfg!(engine_since = "3.0.0")),
        ("body_gravcomp", cfg!(engine_since = "3.0.0")),
        ("qfrc_damper", cfg!(engine_since = "3.0.0")),
        ("cam_resolution", cfg!(engine_since = "3.0.0")),
        ("flex_rgba", cfg!(engine_since = "3.0.0")),
        ("flexvert_xpos", cfg!(engine_since = "3.0.0")),
        ("flexedge_length0", cfg!(engine_since = "3.0.0")),
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
    }
}
