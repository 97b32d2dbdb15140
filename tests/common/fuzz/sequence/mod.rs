//! Random sequences of calls.
//!
//! Each call is an entry of a table: a name, and a function of the scene and of the bytes that
//! decide its arguments. A new function of the crate is a new entry in the table of a suitable
//! file, or in a new file that [`TABLES`] lists.

mod batches;
mod callback;
mod control;
mod edit;
mod elements;
mod environments;
mod files;
mod inference;
mod linearise;
mod math;
mod parts;
mod read;
mod read_only;
mod rollouts;
mod scene_view;
mod several;
mod simulate;
mod specs;
mod write;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::{Data, Error, Lineariser, Model, Result, Stage};

use super::{Bytes, Verdict, models, print_all, touch_all};

/// The subjects of the calls.
pub(super) struct Scene<'l> {
    pub(super) data: Data,
    /// Another simulation, often of the same model.
    pub(super) other: Option<Data>,
    /// A state that was read earlier.
    pub(super) state: Vec<f64>,
    /// The loaded model, which is shared.
    pub(super) model: Arc<Model>,
    /// An abstract scene, of the model of the call that created it.
    view: Option<scene_view::SceneView>,
    /// A workspace for linear systems, of the model of the call that created it.
    transition: Option<Lineariser>,
    /// Depth of the nested scopes with callbacks.
    pub(super) depth: usize,
    /// Called with a description before each action.
    pub(super) log: &'l mut dyn FnMut(&str),
}

impl<'l> Scene<'l> {
    pub(super) fn new(model: Arc<Model>, data: Data, log: &'l mut dyn FnMut(&str)) -> Self {
        Self { data, other: None, state: Vec::new(), model, view: None, transition: None, depth: 0, log }
    }
}

/// A call, or a few related calls. The result is ignored: errors are allowed.
type Call = fn(&mut Scene<'_>, &mut Bytes<'_>) -> Result<()>;

/// Related calls.
struct Table {
    /// Relative frequency of the table.
    weight: usize,
    /// True if most calls need the results of a step.
    needs_step: bool,
    calls: &'static [(&'static str, Call)],
}

/// All calls. Adding an entry to a table does not change the frequency of the table.
const TABLES: &[Table] = &[
    Table { weight: 12, needs_step: false, calls: simulate::CALLS },
    Table { weight: 7, needs_step: false, calls: edit::CALLS },
    Table { weight: 5, needs_step: false, calls: write::CALLS },
    Table { weight: 5, needs_step: false, calls: elements::CALLS },
    Table { weight: 5, needs_step: true, calls: read_only::CALLS },
    Table { weight: 3, needs_step: true, calls: read::CALLS },
    Table { weight: 4, needs_step: false, calls: several::CALLS },
    Table { weight: 4, needs_step: false, calls: parts::CALLS },
    Table { weight: 3, needs_step: false, calls: callback::CALLS },
    Table { weight: 2, needs_step: false, calls: math::CALLS },
    Table { weight: 2, needs_step: false, calls: control::CALLS },
    Table { weight: 2, needs_step: false, calls: linearise::CALLS },
    Table { weight: 2, needs_step: false, calls: inference::CALLS },
    Table { weight: 1, needs_step: false, calls: rollouts::CALLS },
    Table { weight: 1, needs_step: false, calls: environments::CALLS },
    Table { weight: 1, needs_step: false, calls: batches::CALLS },
    Table { weight: 3, needs_step: true, calls: scene_view::CALLS },
    Table { weight: 1, needs_step: false, calls: files::CALLS },
    Table { weight: 1, needs_step: false, calls: specs::CALLS },
];

const MOST_CALLS: usize = 40;

pub(super) fn call_sequence(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let which = models::choose(bytes);
    log(&models::all()[which].name);
    let model = models::model(which).clone();
    let data = Data::new(model.clone()).expect("a model of the corpus has no simulation");
    let calls = 10 + bytes.below(MOST_CALLS - 9);
    make_calls(model, data, calls, bytes, log);
    Verdict::Worked
}

/// Makes a sequence of calls with a simulation of a model.
pub(super) fn make_calls(
    model: Arc<Model>,
    data: Data,
    calls: usize,
    bytes: &mut Bytes<'_>,
    log: &mut dyn FnMut(&str),
) {
    call_some(&mut Scene::new(model, data, log), bytes, calls);
}

/// Writes to the state or the inputs of the simulation, or edits its model, as one of the random
/// calls does.
pub(super) fn change(scene: &mut Scene<'_>, bytes: &mut Bytes<'_>) {
    let calls = bytes.either(&write::CALLS[write::ARRAYS..], edit::CALLS);
    let (name, call) = calls[bytes.below(calls.len())];
    (scene.log)(name);
    let _ = call(scene, bytes);
}

/// Makes this number of calls, or fewer if the bytes are used up.
fn call_some(scene: &mut Scene<'_>, bytes: &mut Bytes<'_>, calls: usize) {
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
        let table = table.expect("the ticket is below the sum of the weights");
        if table.needs_step && scene.data.stage() != Stage::Acceleration && bytes.once_in(2) {
            (scene.log)("forward, for the next call");
            expected(&scene.data.forward());
        }
        let calls = table.calls;
        let (name, call) = calls[bytes.below(calls.len())];
        (scene.log)(name);
        let result = call(scene, bytes);
        if let Err(error) = &result {
            (scene.log)(&format!("  {error}"));
        }
        // No further decision would be random.
        if matches!(result, Err(Error::Poisoned { .. })) && bytes.once_in(2) {
            let _ = scene.data.reset();
        }
        expected(&result);
    }
}

/// The message of deliberate panics in callbacks.
const ON_PURPOSE: &str = "on purpose";

/// Asserts that an error of a callback is a deliberate panic.
fn expected(result: &Result<()>) {
    if let Err(Error::Callback { message, .. }) = result {
        assert!([ON_PURPOSE, "(no message)"].contains(&&message[..]), "a closure panicked: {message}");
    }
}

/// Asserts that a call with an object of another model panics.
fn must_panic<R>(call: impl FnOnce() -> R) {
    let payload = catch_unwind(AssertUnwindSafe(call)).err().expect("no panic");
    let text = payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied());
    assert!(text.is_some_and(|text| text.contains("another model")), "{text:?}");
}
