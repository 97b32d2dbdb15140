//! Overhead of named access: reading a field through the view of an element
//! (`data.joint(id).qpos()`), by an index into the array (`data.qpos()[i]`), and through the
//! engine's pointer without checks. The lookup of the names is not included.
//!
//! ```text
//! cargo bench --bench view
//! ```

mod common;

use std::hint::black_box;

use mujoco_safe::id::Id;
use mujoco_safe::{Data, Result, sample};

/// Number of reads per run.
const READS: u32 = 1000;

/// Compares three variants of reading a number. Each element is given by its id and by an index.
fn compare<K>(
    name: &str,
    data: &mut Data,
    elements: impl Iterator<Item = (Id<K>, usize)>,
    (view_name, view): (&str, impl Fn(&Data, Id<K>) -> f64),
    (pointer_name, pointer): (&str, impl Fn(&Data, usize) -> f64),
    (slice_name, slice): (&str, impl Fn(&Data, usize) -> f64),
) {
    let elements: Vec<_> = elements.collect();
    let (ids, indices): (Vec<_>, Vec<_>) = elements.into_iter().cycle().take(READS as usize).unzip();
    let variants: [common::Variant<'_, Data>; 3] = [
        (view_name, &|data| read(data, &ids, &view)),
        (pointer_name, &|data| read(data, &indices, &pointer)),
        (slice_name, &|data| read(data, &indices, &slice)),
    ];
    common::compare(name, data, READS, &variants);
}

/// Reads a value for each key. `black_box` prevents the compiler from sharing work between reads.
fn read<K: Copy>(data: &Data, keys: &[K], get: impl Fn(&Data, K) -> f64) {
    for &key in keys {
        black_box(get(black_box(data), key));
    }
}

fn main() -> Result<()> {
    let mut data = Data::new(sample::humanoid())?;
    data.forward()?;
    let model = data.model().clone();

    compare(
        "view/qpos of a joint",
        &mut data,
        model.joints().map(|joint| (joint.id(), joint.qpos_range().start)),
        ("joint(id).qpos()[0]", |data, id| data.joint(id).qpos()[0]),
        // SAFETY: the data is alive, and the index is within the array.
        ("*qpos.add(i)", |data, index| unsafe { *(*data.as_ptr()).qpos.add(index) }),
        ("qpos()[i]", |data, index| data.qpos()[index]),
    );
    compare(
        "view/xpos of a body",
        &mut data,
        model.bodies().map(|body| (body.id(), body.index())),
        ("body(id).xpos()[2]", |data, id| data.body(id).xpos()[2]),
        // SAFETY: as above, for rows of three numbers.
        ("*xpos.add(3 * i + 2)", |data, index| unsafe { *(*data.as_ptr()).xpos.add(3 * index + 2) }),
        ("xpos()[i][2]", |data, index| data.xpos()[index][2]),
    );
    compare(
        "view/ctrl of an actuator",
        &mut data,
        model.actuators().map(|actuator| (actuator.id(), actuator.index())),
        ("actuator(id).ctrl()", |data, id| data.actuator(id).ctrl()),
        // SAFETY: as above.
        ("*ctrl.add(i)", |data, index| unsafe { *(*data.as_ptr()).ctrl.add(index) }),
        ("ctrl()[i]", |data, index| data.ctrl()[index]),
    );

    Ok(())
}
