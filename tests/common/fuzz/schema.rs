//! Texts with extreme values of every element and attribute of the linked engine's schema.

use std::sync::Arc;

use mujoco_safe::scene::{Camera, Categories, SceneOptions, VisualFlags};
use mujoco_safe::{Data, Scene};

use super::binary::{is_small, use_model};
use super::{Bytes, Verdict, schema_models, sequence, text};

/// Largest number of calls for an accepted model.
const MOST_CALLS: usize = 6;

pub(super) fn hostile_text(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let text = schema_models::hostile(&mut |end| bytes.below(end));
    load_and_call(&text, MOST_CALLS, bytes, log)
}

/// Loads a text that may name the files of the schema's models, and makes calls with an accepted
/// model.
pub(super) fn load_and_call(text: &str, calls: usize, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let files = schema_models::files().iter().map(|(name, content)| ((*name).to_owned(), content.clone()));
    let Some(model) = text::load(text, &files.collect::<Vec<_>>(), log).map(Arc::new) else {
        return Verdict::Rejected;
    };
    let verdict = use_model(model.clone(), log);
    if is_small(&model)
        && let Ok(mut data) = Data::new(model.clone())
    {
        log("the scene");
        draw(&mut data);
        sequence::make_calls(model, data, calls, bytes, log);
    }
    verdict
}

/// Updates a scene with each of the two forms of flexes.
fn draw(data: &mut Data) {
    let Ok(mut scene) = Scene::new(data.model(), 1000) else { return };
    let mut camera = Camera::free(data.model());
    for flag in [VisualFlags::FLEXFACE, VisualFlags::FLEXSKIN] {
        let options = SceneOptions::default().with_flags(flag | VisualFlags::SKIN);
        let _ = scene.update(data, &options, None, &mut camera, Categories::all());
    }
}
