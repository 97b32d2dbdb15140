//! A renderer prints nothing to standard output and standard error. Each test renders in a child
//! process.

#![cfg(target_os = "linux")]

use mujoco_safe::render::{Gpu, RenderError, Renderer, RendererOptions};
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
use mujoco_safe::{Data, sample};

use crate::child;

/// Renders an image, with the expected backend if set.
#[test]
fn renders_an_image_in_a_child_process() {
    if !child::is_child() {
        return;
    }
    let gpu = match Gpu::new() {
        Ok(gpu) => gpu,
        Err(RenderError::NoAdapter { .. }) => return,
        Err(error) => panic!("{error}"),
    };
    if let Ok(backend) = std::env::var("EXPECTED_BACKEND") {
        assert_eq!(gpu.backend(), backend);
    }
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 100).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    let mut renderer = Renderer::on(&gpu, data.model(), 64, 64, RendererOptions::default()).unwrap();
    let picture = renderer.rgb(&scene).unwrap();
    let first = picture.pixel(0, 0);
    assert!(picture.as_bytes().chunks_exact(3).any(|pixel| *pixel != first), "the image is empty");
}

/// Runs the test above with these variables, and without the variables of a desktop session.
fn prints_nothing(variables: &[(&str, &str)]) {
    let output = child::command("quiet::renders_an_image_in_a_child_process")
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("DISPLAY")
        .envs(variables.iter().copied())
        .output()
        .unwrap();
    let [stdout, stderr] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success() && stdout.contains("1 passed"), "{stdout}{stderr}");
    assert_eq!(child::printed(&stdout), Vec::<&str>::new());
    assert_eq!(stderr, "");
}

/// Mesa's device selection layer complains about a missing `XDG_RUNTIME_DIR`.
#[test]
fn a_renderer_prints_nothing_without_a_session() {
    prints_nothing(&[("EXPECTED_BACKEND", "vulkan")]);
    prints_nothing(&[("EXPECTED_BACKEND", "vulkan"), ("NODEVICE_SELECT", "1")]);
}

#[test]
fn a_renderer_falls_back_to_opengl_and_prints_nothing() {
    prints_nothing(&[("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null"), ("EXPECTED_BACKEND", "gl")]);
}
