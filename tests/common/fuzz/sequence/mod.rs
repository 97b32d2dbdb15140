//! A random sequence of calls.
//!
//! Each call is a line in a table: a name, and a function that takes the scene and the bytes that decide its arguments. A new
//! function of the crate is a new line in the table of the file it fits, or in a new file that [`TABLES`] lists.

mod control;
mod edit;
mod read;
mod several;
mod simulate;
mod write;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::{Data, Model, Result};

use super::{Bytes, Verdict, models, touch_all};

/// What the calls are made on.
pub(super) struct Scene {
    pub(super) data: Data,
    /// Another one, often of the same model.
    pub(super) other: Option<Data>,
    /// A state that was read before.
    pub(super) state: Vec<f64>,
    /// The model as it was loaded, which is shared.
    pub(super) model: Arc<Model>,
}

/// A call, or a few that go together. What it returns is not looked at: errors are allowed.
type Call = fn(&mut Scene, &mut Bytes<'_>) -> Result<()>;

/// Calls that are alike.
struct Table {
    /// How often one of them comes, compared to the others.
    weight: usize,
    calls: &'static [(&'static str, Call)],
}

/// All calls. A table to which a line is added is chosen as often as before.
const TABLES: &[Table] = &[
    Table { weight: 10, calls: simulate::CALLS },
    Table { weight: 7, calls: edit::CALLS },
    Table { weight: 6, calls: write::CALLS },
    Table { weight: 5, calls: read::CALLS },
    Table { weight: 4, calls: several::CALLS },
    Table { weight: 2, calls: control::CALLS },
];

const MOST_CALLS: usize = 40;

pub(super) fn call_sequence(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let which = models::choose(bytes);
    log(&models::all()[which].name);
    let model = models::model(which).clone();
    let data = Data::new(model.clone()).expect("a model of the corpus has no simulation");
    let mut scene = Scene { data, other: None, state: Vec::new(), model };
    let calls = 10 + bytes.below(MOST_CALLS - 9);
    for _ in 0..calls {
        if bytes.is_empty() {
            break;
        }
        let mut ticket = bytes.below(TABLES.iter().map(|table| table.weight).sum());
        let table = TABLES.iter().find(|table| {
            let found = ticket < table.weight;
            ticket = ticket.saturating_sub(table.weight);
            found
        });
        let calls = table.map_or(simulate::CALLS, |table| table.calls);
        let (name, call) = calls[bytes.below(calls.len())];
        log(name);
        if let Err(error) = call(&mut scene, bytes) {
            log(&format!("  {error}"));
        }
    }
    Verdict::Worked
}

/// A call that must panic, because it was given what belongs to another model.
fn must_panic<R>(call: impl FnOnce() -> R) {
    let payload = catch_unwind(AssertUnwindSafe(call)).err().expect("no panic");
    let text = payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied());
    assert!(text.is_some_and(|text| text.contains("another model")), "{text:?}");
}
