//! Loading, saving and editing models, and the guards in front of the engine's compiler.

#![allow(clippy::duplicate_mod, reason = "the models of the schema have the files of assets too")]

#[path = "../common/assets.rs"]
mod assets;
#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/installed.rs"]
mod installed;
#[cfg(validates_binaries)]
#[path = "../common/mutate.rs"]
mod mutate;
#[path = "../common/parameter_edits.rs"]
mod parameter_edits;
#[cfg(validates_binaries)]
#[path = "../common/print_all.rs"]
mod print_all;
#[macro_use]
#[path = "../common/fields.rs"]
mod fields;
#[path = "../common/random_text.rs"]
mod random_text;
#[path = "../common/same_models.rs"]
mod same_models;
#[cfg(validates_binaries)]
#[path = "../common/scene_options.rs"]
mod scene_options;
#[path = "../common/schema_models/mod.rs"]
mod schema_models;

mod asset_models;
mod bounds;
mod compiled;
mod damaged_assets;
mod edits;
mod engine_limits;
mod load;
#[cfg(validates_binaries)]
mod mutated_binaries;
mod rejected_files;
mod rejected_flexes;
mod rejected_texts;
// Binary models load with 2.2.2 and 3.5.0 only.
#[cfg(validates_binaries)]
mod save;
#[cfg(feature = "serde")]
mod serde;
mod spec;
mod urdf;

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use assets::folder;
use mujoco_safe::{LoadOptions, Model};

/// A special file.
const DEVICE: &str = if cfg!(windows) { "nul.png" } else { "/dev/zero" };

/// Returns `true` with the default engine.
fn is_default() -> bool {
    mujoco_safe::built_against().to_string() == "2.2.2"
}

/// Loads a text with owned files.
fn from_memory(xml: &str, files: &[(&str, Vec<u8>)]) -> mujoco_safe::Result<Model> {
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, content.as_slice())).collect();
    Model::from_xml_str_with(xml, &LoadOptions::default().with_files(&files))
}

/// Returns the model in the binary format of the engine.
fn bytes(model: &Model) -> Vec<u8> {
    model.to_binary().unwrap()
}

/// Serialises raw loads, which bypass the library and replace the XML tree that the engine keeps
/// for saving.
static RAW_LOADS: Mutex<()> = Mutex::new(());

/// Returns the bytes of a model that the engine loads from a path.
fn bytes_in_c(path: &Path) -> Vec<u8> {
    bytes_in_c_with_files(path, &[])
}

/// Returns the bytes of a model that the engine loads from a path, with files in its virtual file
/// system.
fn bytes_in_c_with_files(path: &Path, files: &[(&str, &[u8])]) -> Vec<u8> {
    use std::ffi::CString;
    use std::ptr;

    use mujoco_safe::sys::{self, guard};

    let _raw = RAW_LOADS.lock().unwrap_or_else(PoisonError::into_inner);
    let name = CString::new(path.to_str().unwrap()).unwrap();
    let (mut model, mut message) = (ptr::null_mut(), [0; 1000]);
    let mut table = Box::<sys::mjVFS>::new_uninit();
    // SAFETY: the engine initialises the table; each file is created with the length of its content
    // and then filled.
    let mut table = unsafe {
        sys::mj_defaultVFS(table.as_mut_ptr());
        let mut table = table.assume_init();
        for (index, (name, content)) in files.iter().enumerate() {
            let name = CString::new(*name).unwrap();
            #[cfg(not(engine_since = "3.1.3"))]
            {
                assert_eq!(sys::mj_makeEmptyFileVFS(&raw mut *table, name.as_ptr(), content.len() as i32), 0);
                ptr::copy_nonoverlapping(content.as_ptr(), table.filedata[index].cast::<u8>(), content.len());
            }
            #[cfg(engine_since = "3.1.3")]
            {
                let (buffer, length) = (content.as_ptr().cast(), content.len() as i32);
                assert_eq!(sys::mj_addBufferVFS(&raw mut *table, name.as_ptr(), buffer, length), 0, "file {index}");
            }
        }
        table
    };
    // SAFETY: loading a model through the library has installed the handlers; the name and the
    // table are valid, and the buffer has the given length.
    let status =
        unsafe { guard::mj_load_xml(name.as_ptr(), &raw const *table, message.as_mut_ptr(), 1000, &raw mut model) };
    assert!(status == guard::OK && !model.is_null(), "the engine cannot load {}", path.display());
    // SAFETY: the model is valid, the buffer has the size that the engine reports, and the table
    // and the model are freed once.
    unsafe {
        sys::mj_deleteVFS(&raw mut *table);
        let mut bytes = vec![0_u8; sys::mj_sizeModel(model) as usize];
        let size = bytes.len() as i32;
        assert_eq!(guard::mj_save_model(model, ptr::null(), bytes.as_mut_ptr().cast(), size), guard::OK);
        sys::mj_deleteModel(model);
        bytes
    }
}
