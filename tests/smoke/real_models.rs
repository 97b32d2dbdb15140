//! Real models load here if the engine loads them, and move as in the engine. Set
//! `MUJOCO_SAFE_MODELS` to a model or a directory, and run
//! `cargo test --test smoke real_models -- --ignored --nocapture`.

use std::ffi::{CString, c_char};
use std::path::{Path, PathBuf};

use mujoco_safe::enums::Integrator;
use mujoco_safe::sys::{self, mjModel};
use mujoco_safe::{Data, Differences, Error, Model};

use crate::Raw;

const STEPS: usize = 100;
/// Largest number of degrees of freedom of a model that the test linearises: the time grows with
/// its square.
const MOST_DOFS: usize = 150;

/// A model that the engine has compiled.
struct RawModel(*mut mjModel);

impl Drop for RawModel {
    fn drop(&mut self) {
        c!(mj_deleteModel(self.0));
    }
}

/// Compiles a file by a direct call of the engine. Returns its message if it fails.
fn compiled_by_engine(path: &Path) -> Result<RawModel, String> {
    let name = CString::new(path.as_os_str().as_encoded_bytes()).unwrap();
    let mut message = [0 as c_char; 1000];
    let length = message.len() as i32;
    let model = c!(mj_loadXML(name.as_ptr(), std::ptr::null(), message.as_mut_ptr(), length));
    if model.is_null() {
        // SAFETY: the engine writes a text that ends with NUL.
        let message = unsafe { std::ffi::CStr::from_ptr(message.as_ptr()) };
        return Err(message.to_string_lossy().replace('\n', " "));
    }
    Ok(RawModel(model))
}

/// Returns the positions after the steps, or `None` if the engine has reset an unstable simulation.
fn stepped_by_engine(model: &RawModel) -> Option<Vec<f64>> {
    let data = Raw(c!(mj_makeData(model.0)));
    for _ in 0..STEPS {
        c!(mj_step(model.0, data.0));
        let unstable = [sys::mjWARN_BADQPOS, sys::mjWARN_BADQVEL, sys::mjWARN_BADQACC];
        // SAFETY: a valid data.
        if unstable.into_iter().any(|warning| unsafe { (*data.0).warning[warning as usize].number > 0 }) {
            return None;
        }
    }
    // SAFETY: the array has nq numbers.
    Some(unsafe { std::slice::from_raw_parts((*data.0).qpos, usize::try_from((*model.0).nq).unwrap()) }.to_vec())
}

/// Returns the XML files below a path, in order.
fn xml_files(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let mut entries: Vec<PathBuf> = path.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let is_wanted = |entry: &PathBuf| entry.is_dir() || entry.extension().is_some_and(|extension| extension == "xml");
    entries.iter().filter(|entry| is_wanted(entry)).flat_map(|entry| xml_files(entry)).collect()
}

/// Returns what fails for a model that the engine compiles.
fn failure(path: &Path, reference: &RawModel) -> Option<String> {
    let model = match Model::from_xml_path(path) {
        Ok(model) => model,
        Err(error) => return Some(format!("load: {error}")),
    };
    let mut data = Data::new(model).unwrap();
    match (data.step_n(STEPS), stepped_by_engine(reference)) {
        (Ok(()), Some(qpos)) if data.qpos() == qpos => {}
        (Ok(()), Some(_)) => return Some("step: the positions differ from those of the engine".to_owned()),
        (Err(Error::Unstable(_)), None) => data.reset().unwrap(),
        (Ok(()), None) => return Some("step: the engine has reset its simulation".to_owned()),
        (Err(error), _) => return Some(format!("step: {error}")),
    }
    // The engine does not differentiate steps of RK4.
    let is_linearised = data.model().nv() <= MOST_DOFS && data.model().options().integrator != Integrator::Rk4;
    if is_linearised && let Err(error) = data.transition_fd(1e-6, Differences::Forward) {
        return Some(format!("linearise: {error}"));
    }
    #[cfg(feature = "renderer")]
    {
        use mujoco_safe::render::{RenderError, Renderer};
        use mujoco_safe::scene::Camera;

        let mut draw = || -> Result<(), RenderError> {
            let mut renderer = Renderer::new(data.model(), 64, 64)?;
            let mut camera = Camera::free(data.model());
            data.forward()?;
            renderer.snapshot(&mut data, &mut camera)?.rgb()?;
            Ok(())
        };
        if let Err(error) = draw() {
            return Some(format!("draw: {error}"));
        }
    }
    None
}

#[test]
#[ignore = "needs a directory of models"]
fn real_models_load_step_and_are_linearised_and_drawn_if_the_engine_loads_them() {
    let path = std::env::var_os("MUJOCO_SAFE_MODELS").expect("MUJOCO_SAFE_MODELS is a model or a directory");
    #[cfg(engine_since = "2.3.3")]
    if let Some(plugins) = crate::plugin::directory() {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(plugins) }.unwrap();
    }
    let (mut good, mut failures) = (0, 0);
    for path in xml_files(Path::new(&path)) {
        // The engine does not load parts that other files include.
        let Ok(reference) = compiled_by_engine(&path) else { continue };
        match failure(&path, &reference) {
            None => good += 1,
            Some(failure) => {
                failures += 1;
                println!("{}: {failure}", path.display());
            }
        }
    }
    println!("{good} models pass, {failures} fail");
    assert!(good > 0 && failures == 0);
}
