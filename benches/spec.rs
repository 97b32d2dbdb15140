//! Cost of a scene that is edited: a second robot is attached and all compiled, and a changed model
//! takes over a running simulation. The references are `mjs_attach` with `mj_compile`, and
//! `mj_recompile`, which engines have since 3.2.
//!
//! ```text
//! MUJOCO_DIR=$(scripts/engine 4.0.1) cargo bench --bench spec
//! ```

mod common;

#[cfg(engine_since = "3.5.0")]
fn main() -> mujoco_safe::Result<()> {
    edits::main()
}

#[cfg(not(engine_since = "3.5.0"))]
fn main() {
    println!("the references need MuJoCo 3.5 or newer");
}

#[cfg(engine_since = "3.5.0")]
mod edits {
    use std::cell::RefCell;
    use std::ffi::CString;
    use std::ptr;

    use mujoco_safe::spec::{Mount, Spec};
    use mujoco_safe::{Data, Result, sample, sys};

    use crate::common;

    const NAMES: [&str; 2] = ["humanoid", "half_cheetah"];

    /// Parses a text with the engine.
    fn parse(text: &str) -> *mut sys::mjSpec {
        let text = CString::new(text).expect("a text without NUL");
        // SAFETY: the text ends with NUL, and no message is asked for.
        let spec = unsafe { sys::mj_parseXMLString(text.as_ptr(), ptr::null(), ptr::null_mut(), 0) };
        assert!(!spec.is_null());
        spec
    }

    pub(crate) fn main() -> Result<()> {
        for (name, text) in NAMES.into_iter().zip([sample::HUMANOID_XML, sample::HALF_CHEETAH_XML]) {
            let (scene, robot) = (Spec::from_xml_str(text)?, Spec::from_xml_str(text)?);
            let raw = [parse(text), parse(text)];

            let ours = |(): &mut ()| {
                let mut scene = scene.clone();
                let mount = Mount::body(scene.world()).with_pos([0.0, 3.0, 0.0]);
                scene.attach(&robot, mount, "second/").expect("names with a prefix");
                scene.compile().expect("a valid scene");
            };
            let engine = |(): &mut ()| {
                // SAFETY: valid specs and names that end with NUL; the copies and the model are
                // freed once.
                unsafe {
                    let [scene, robot] = raw.map(|spec| sys::mj_copySpec(spec));
                    let frame = sys::mjs_addFrame(sys::mjs_findBody(scene, c"world".as_ptr()), ptr::null_mut());
                    (*frame).pos = [0.0, 3.0, 0.0];
                    let second = sys::mjs_attach((*frame).element, (*robot).element, c"second/".as_ptr(), c"".as_ptr());
                    let model = sys::mj_compile(scene, ptr::null());
                    assert!(!second.is_null() && !model.is_null());
                    sys::mj_deleteModel(model);
                    sys::mj_deleteSpec(scene);
                    sys::mj_deleteSpec(robot);
                }
            };
            common::compare(
                &format!("attach/{name}"),
                &mut (),
                1,
                &[("Spec::attach and compile", &ours), ("mjs_attach and mj_compile", &engine)],
            );

            let data = RefCell::new(Data::new(scene.compile()?)?);
            let ours = |(): &mut ()| {
                let model = scene.compile().expect("a valid spec");
                data.borrow_mut().adopt(model).expect("a valid model");
            };
            // SAFETY: a valid spec and model. The model and the data are those of the spec, and
            // stay until the end of the program.
            let (model, state) = unsafe {
                let model = sys::mj_compile(raw[0], ptr::null());
                (model, sys::mj_makeData(model))
            };
            let engine = |(): &mut ()| {
                // SAFETY: a spec with its model and data.
                assert_eq!(unsafe { sys::mj_recompile(raw[0], ptr::null(), model, state) }, 0);
            };
            common::compare(
                &format!("recompile/{name}"),
                &mut (),
                1,
                &[("Spec::compile and Data::adopt", &ours), ("mj_recompile", &engine)],
            );
        }
        Ok(())
    }
}
