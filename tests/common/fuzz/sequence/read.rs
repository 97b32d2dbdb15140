//! Calls that need scratch space but keep the state, and calls that need no simulation.

use std::hint::black_box;

use mujoco_safe::data::Accelerations;
use mujoco_safe::model::{Statistics, Visual};
use mujoco_safe::{Data, Matrix, Model, Options, Result};

use super::{Bytes, Call, must_panic, read_only};

pub(super) const CALLS: &[(&str, Call)] = &[
    ("jac_subtree_com, jac_point_axis", |scene, bytes| {
        let body = read_only::body(&scene.data, bytes)?;
        black_box(scene.data.jac_subtree_com(body)?);
        black_box(scene.data.jac_point_axis(bytes.numbers(), bytes.numbers(), body)?);
        let mut matrix = Matrix::zeros(3, scene.data.model().nv() + usize::from(bytes.once_in(4)));
        scene.data.jac_subtree_com_into(body, &mut matrix)?;
        scene.data.jac_point_axis_into(bytes.numbers(), bytes.numbers(), body, None, Some(&mut matrix))
    }),
    ("solve_m", |scene, bytes| solve(scene.data.model().nv(), bytes, |result, b| scene.data.solve_m_into(b, result))),
    ("solve_m2", |scene, bytes| solve(scene.data.model().nv(), bytes, |result, b| scene.data.solve_m2_into(b, result))),
    ("rne", |scene, bytes| {
        let mut result = bytes.vector(scene.data.model().nv());
        scene.data.rne_into(bytes.either(Accelerations::Present, Accelerations::Zero), &mut result)
    }),
    ("add_m", |scene, bytes| {
        let nv = scene.data.model().nv();
        let mut sum = Matrix::zeros(nv + usize::from(bytes.once_in(8)), nv);
        sum.as_mut_slice().fill(bytes.number());
        scene.data.add_m(&mut sum)
    }),
    ("add_m_sparse", |scene, bytes| add_m_sparse(&mut scene.data, bytes)),
    ("apply_ft", |scene, bytes| {
        let body = read_only::body(&scene.data, bytes)?;
        let mut target = bytes.vector(scene.data.model().nv());
        scene.data.apply_ft(bytes.numbers(), bytes.numbers(), bytes.numbers(), body, &mut target)
    }),
    ("geom_distance", |scene, bytes| {
        let (one, other) = (read_only::geom(&scene.data, bytes)?, read_only::geom(&scene.data, bytes)?);
        scene.data.geom_distance(one, other, bytes.number()).map(drop)
    }),
    ("field_docs", |_, bytes| {
        let text = String::from_utf8_lossy(&bytes.word().to_le_bytes()).into_owned();
        let name = bytes.choose(&["qpos", "map.znear", "", "\0", "qpso", "\t", "\n", "%s%n", &text]);
        if !bytes.once_in(4) {
            return Model::field_docs("nv").map(drop);
        }
        let docs: [fn(&str) -> Result<String>; 5] =
            [Model::field_docs, Data::field_docs, Options::field_docs, Visual::field_docs, Statistics::field_docs];
        let which = bytes.below(5);
        if bytes.once_in(64) {
            black_box(Data::fields().map(|field| field.shape().len()).sum::<usize>());
        }
        docs[which](name).map(drop)
    }),
    ("schema", |_, bytes| {
        if bytes.once_in(256) {
            mujoco_safe::model::schema().and(mujoco_safe::model::schema_html()).map(drop)
        } else {
            Ok(())
        }
    }),
    ("an id of another model", |scene, bytes| {
        let Some(other) = scene.other.as_ref().filter(|other| !other.model().is_same_structure(scene.data.model()))
        else {
            return Ok(());
        };
        let (body, geom) = (other.model().body(0)?.id(), other.model().geom(0)?.id());
        match bytes.below(7) {
            0 => must_panic(|| scene.data.jac_body(body)),
            1 => must_panic(|| scene.data.body(body).index()),
            2 => must_panic(|| scene.data.model().name(body).map(str::len)),
            3 => must_panic(|| scene.data.ray_mesh(geom, [0.0; 3], [1.0; 3])),
            4 => must_panic(|| scene.data.geom_distance(geom, geom, 1.0)),
            5 => must_panic(|| scene.data.local_to_global([0.0; 3], [0.0; 4], body)),
            _ => must_panic(|| scene.data.edit_model(|model| model.body_mut(body).set_mass(1.0))),
        }
        Ok(())
    }),
];

/// Solves for one or several right-hand sides.
fn solve(nv: usize, bytes: &mut Bytes<'_>, call: impl FnOnce(&mut [f64], &[f64]) -> Result<()>) -> Result<()> {
    let times = 1 + bytes.below(3);
    let (mut result, vector) = (bytes.vector(times * nv), bytes.vector(times * nv));
    call(&mut result, &vector)
}

/// Adds to sparse rows that have room, or to invalid rows.
fn add_m_sparse(data: &mut Data, bytes: &mut Bytes<'_>) -> Result<()> {
    let nv = data.model().nv();
    let (mut values, mut columns) = (vec![bytes.number(); nv * nv], vec![0; nv * nv]);
    let (mut counts, mut addresses) = (vec![0; nv], (0..nv).map(|row| (row * nv) as i32).collect::<Vec<_>>());
    for _ in 0..bytes.below(4) {
        let (at, number) = (bytes.below(nv * nv), bytes.integer());
        let array = [&mut columns, &mut counts, &mut addresses].into_iter().nth(bytes.below(3));
        if let Some(number_there) = array.and_then(|array| array.get_mut(at % nv.max(1))) {
            *number_there = number;
        }
    }
    if bytes.once_in(8) {
        values.truncate(nv);
    }
    data.add_m_sparse(&mut values, &mut counts, &addresses, &mut columns)
}
