//! Renderers that come and go, and pictures of many sizes, leave nothing behind in the graphics library.

use super::{Gpu, Renderer, RendererOptions};
use crate::data::Data;
use crate::sample;
use crate::scene::{Camera, Categories, Scene, SceneOptions};

/// How many things of each kind there are: buffers, textures, their views, groups, pipelines.
fn things(gpu: &Gpu) -> [usize; 5] {
    gpu.wait().unwrap();
    let report = gpu.report().expect("a report of the graphics library");
    let hub = report.hub_report();
    [&hub.buffers, &hub.textures, &hub.texture_views, &hub.bind_groups, &hub.render_pipelines]
        .map(|registry| registry.num_allocated)
}

#[test]
fn nothing_is_left_behind() {
    let gpu = Gpu::new().unwrap();
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    let options = RendererOptions::default().samples(1).shadow_size(64);
    let draw = |count: u32| {
        let mut renderer = Renderer::on(&gpu, data.model(), 8, 8, &options).unwrap();
        for frame in 0..count {
            renderer.resize(4 + frame % 7, 4 + frame % 5).unwrap();
            renderer.rgb(&scene).unwrap();
            renderer.depth(&scene).unwrap();
        }
        things(&gpu)
    };
    let empty = things(&gpu);
    let few = draw(3);
    assert!(few > empty, "a renderer has things");
    assert_eq!(things(&gpu), empty, "all of them are gone with it");
    assert_eq!(draw(60), few, "as many after 60 pictures as after 3");
    assert_eq!(things(&gpu), empty);
}
