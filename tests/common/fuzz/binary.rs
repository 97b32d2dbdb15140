//! Damaged binary models.

use std::sync::{Arc, OnceLock};

use mujoco_safe::model::IntoModel;
use mujoco_safe::{Data, Error, Model};

use super::mutate::{DAMAGES, Map};
use super::{Bytes, Verdict, models, sequence};

/// Number of height field cells beyond which a step takes seconds.
const MOST_CELLS: usize = 1_000_000;

/// Number of values of a kind beyond which a model is not used further.
const MOST_NUMBERS: usize = 1_000_000;

/// Number of calls with an accepted model, of all kinds.
const MOST_CALLS: usize = 12;

/// A valid file and its layout.
struct Original {
    file: Vec<u8>,
    map: Map,
}

fn originals() -> &'static [OnceLock<Original>] {
    static ORIGINALS: OnceLock<Vec<OnceLock<Original>>> = OnceLock::new();
    ORIGINALS.get_or_init(|| models::all().iter().map(|_| OnceLock::new()).collect())
}

pub(super) fn mutated_binary(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let which = models::choose(bytes);
    // The rules for binary models are known for 2.2.2 and 3.5.0 only.
    if cfg!(not(validates_binaries)) {
        log("from_binary, of a valid model");
        let file = models::model(which).to_binary().expect("a model of the corpus is not saved");
        assert!(matches!(Model::from_binary(&file), Err(Error::Unsupported(_))), "a binary model is not rejected");
        return Verdict::Rejected;
    }
    let original = originals()[which].get_or_init(|| {
        let file = models::model(which).to_binary().expect("a model of the corpus is not saved");
        let map = Map::new(&file);
        Original { file, map }
    });
    let damage = DAMAGES[bytes.below(DAMAGES.len())];
    let seed = bytes.word();
    log(&format!("{damage:?} of {} with seed {seed}", models::all()[which].name));
    let mut mutant = original.map.mutant(&original.file, damage, seed);
    if bytes.once_in(4) {
        let damage = DAMAGES[bytes.below(7)];
        log(&format!("and {damage:?}"));
        if mutant.len() == original.file.len() {
            mutant = original.map.mutant(&mutant, damage, bytes.word());
        }
    }
    log("from_binary");
    match Model::from_binary(&mutant) {
        Ok(model) => {
            let model = Arc::new(model);
            let verdict = use_model(model.clone(), log);
            if is_small(&model)
                && let Ok(data) = Data::new(model.clone())
            {
                sequence::make_calls(model, data, MOST_CALLS, bytes, log);
            }
            verdict
        }
        Err(_) => Verdict::Rejected,
    }
}

/// Returns `true` if collisions are fast, and if copies of states fit into the memory of a case:
/// Rust ends a process without memory.
pub(super) fn is_small(model: &Model) -> bool {
    #[cfg(engine_since = "3.5.0")]
    let history = model.nhistory();
    #[cfg(not(engine_since = "3.5.0"))]
    let history = 0;
    model.nhfielddata() <= MOST_CELLS
        && [model.nuserdata(), model.nsensordata(), history].into_iter().all(|count| count <= MOST_NUMBERS)
}

/// Uses a loaded model.
pub(super) fn use_model(model: impl IntoModel, log: &mut dyn FnMut(&str)) -> Verdict {
    let model = model.into_model();
    // Collisions with a height field of millions of cells are slow, but finite.
    if model.nhfielddata() > MOST_CELLS {
        return Verdict::Worked;
    }
    log("a simulation");
    // The stack may take gigabytes, which not every machine can provide.
    let Ok(mut data) = Data::new(model) else { return Verdict::Worked };
    for _ in 0..3 {
        log("step");
        if data.step().is_err() && data.reset().is_err() {
            break;
        }
    }
    log("inverse, contacts, clone");
    let _ = data.inverse();
    for contact in data.contacts() {
        let _ = contact.force_in_world();
    }
    let copy = data.try_clone();
    drop(copy);
    log("update_constants");
    let _ = data.edit_model(|model| model.update_constants());
    log("to_binary");
    let _ = data.model().to_binary();
    Verdict::Worked
}
