//! What does a name cost? Reading a field of an element through its view (`data.joint(id).qpos()`), by an index into the
//! array (`data.qpos()[i]`) and by the engine's pointer, which checks nothing. The names were looked up before.
//!
//! ```text
//! cargo bench --bench view
//! ```

mod common;

use std::hint::black_box;

use criterion::Criterion;
use mujoco_safe::{Data, Id, Result, sample};

/// How many reads a run makes.
const READS: u32 = 1000;

/// Compares three ways to read a number, each with its name. Every element is given by its id and by an index.
fn compare<K>(
    criterion: &mut Criterion,
    name: &str,
    data: &mut Data,
    elements: impl Iterator<Item = (Id<K>, usize)>,
    (view_name, view): (&str, impl Fn(&Data, Id<K>) -> f64),
    (pointer_name, pointer): (&str, impl Fn(&Data, usize) -> f64),
    (slice_name, slice): (&str, impl Fn(&Data, usize) -> f64),
) {
    let elements: Vec<_> = elements.collect();
    let (ids, indices): (Vec<_>, Vec<_>) = elements.into_iter().cycle().take(READS as usize).unzip();
    let ways: [common::Way<'_, Data>; 3] = [
        (view_name, &|data| read(data, &ids, &view)),
        (pointer_name, &|data| read(data, &indices, &pointer)),
        (slice_name, &|data| read(data, &indices, &slice)),
    ];
    common::compare(criterion, name, data, READS, &ways);
}

/// Reads something for every key. The compiler knows neither the data nor what is read, so each read is a whole one.
fn read<K: Copy>(data: &Data, keys: &[K], get: impl Fn(&Data, K) -> f64) {
    for &key in keys {
        black_box(get(black_box(data), key));
    }
}

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    let mut data = Data::new(sample::humanoid())?;
    data.forward()?;
    let model = data.model().clone();

    compare(
        &mut criterion,
        "view/qpos of a joint",
        &mut data,
        model.joints().map(|joint| (joint.id(), joint.qpos_range().start)),
        ("joint(id).qpos()[0]", |data, id| data.joint(id).qpos()[0]),
        // SAFETY: the data lives, and the index is one of the array's.
        ("*qpos.add(i)", |data, index| unsafe { *(*data.as_ptr()).qpos.add(index) }),
        ("qpos()[i]", |data, index| data.qpos()[index]),
    );
    compare(
        &mut criterion,
        "view/xpos of a body",
        &mut data,
        model.bodies().map(|body| (body.id(), body.index())),
        ("body(id).xpos()[2]", |data, id| data.body(id).xpos()[2]),
        // SAFETY: as above, in rows of three.
        ("*xpos.add(3 * i + 2)", |data, index| unsafe { *(*data.as_ptr()).xpos.add(3 * index + 2) }),
        ("xpos()[i][2]", |data, index| data.xpos()[index][2]),
    );
    compare(
        &mut criterion,
        "view/ctrl of an actuator",
        &mut data,
        model.actuators().map(|actuator| (actuator.id(), actuator.index())),
        ("actuator(id).ctrl()", |data, id| data.actuator(id).ctrl()),
        // SAFETY: as above.
        ("*ctrl.add(i)", |data, index| unsafe { *(*data.as_ptr()).ctrl.add(index) }),
        ("ctrl()[i]", |data, index| data.ctrl()[index]),
    );

    criterion.final_summary();
    Ok(())
}
