//! Selection of the object at a point of the window.

use mujoco_safe::data::RayOptions;
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions, VisualFlags};
use mujoco_safe::sys::mjvCamera;

use crate::raw::{RawScene, filled, raw_options, scene_subjects};
use crate::twins::{Twins, assert_same, c, differing};

#[test]
fn selections_equal_c() {
    let (mut geoms, mut skins, mut nothing) = (0, 0, 0);
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        if subject.model.nhfield() > 0 && twins.ours.ray([0.0; 3], [1.0, 0.0, 0.0], &RayOptions::default()).is_err() {
            println!("skipped {}, whose height field the engine misreads", subject.name);
            continue;
        }
        let mut ours = Scene::new(&twins.model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let mut camera = Camera::free(&twins.model);
        let mut raw: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        let default = SceneOptions::default();
        let without_static = default.clone().with_flags(default.flags - VisualFlags::STATIC);
        let other_group = default.clone().with_geomgroup([false, true, false, true, true, true]);
        for options in [default.clone(), without_static, other_group] {
            ours.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
            theirs.update(&twins.raw, &options, None, &mut raw);
            let raw_options = raw_options(&options);
            let (head, height) = (ours.camera_in_model().unwrap(), ours.frustum_height().unwrap());
            for _ in 0..60 {
                let numbers = twins.numbers(2);
                let [relx, rely] = [0, 1].map(|i| 0.5 + 0.5 * numbers[i]);
                let found = ours.select(&twins.ours, &options, 1.5, [relx, rely]).unwrap();
                let (mut point, mut geom, mut skin) = ([0.0; 3], -1, -1);
                let (m, d) = (twins.raw.m(), twins.raw.d);
                let (places, scene) = ((&raw mut geom, &raw mut skin), &raw const *theirs.0);
                let (opt, selpnt) = (&raw const raw_options, point.as_mut_ptr());
                // SAFETY: the scene was updated with the data.
                let body = unsafe { differing::select((m, d), opt, [1.5, relx, rely], scene, selpnt, places) };
                let index = |index: Option<usize>| index.map_or(-1, |index| index as i32);
                assert_eq!(index(found.map(|found| found.body.index())), body, "{}", subject.name);
                let Some(found) = found else {
                    nothing += 1;
                    continue;
                };
                assert_eq!(index(found.geom.map(|geom| geom.index())), geom, "{}", subject.name);
                assert_eq!(index(found.skin.map(|skin| skin.index())), skin, "{}", subject.name);
                assert_same(&subject.name, &found.point, &point);
                let Some(geom) = found.geom else {
                    skins += 1;
                    continue;
                };
                geoms += 1;
                // The same ray, computed from the camera frame.
                let left = [0, 1, 2].map(|i| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    head.up[j] * head.forward[k] - head.up[k] * head.forward[j]
                });
                let (right, up) = ((relx - 0.5) * height * 1.5, (rely - 0.5) * height);
                let direction = [0, 1, 2].map(|i| head.forward[i] + up * head.up[i] - right * left[i]);
                let ray_options = RayOptions::default()
                    .with_geomgroup(options.geomgroup)
                    .with_static_geoms(options.flags.contains(VisualFlags::STATIC));
                let hit = twins.ours.ray(head.pos, direction, &ray_options).unwrap().unwrap();
                let at = [0, 1, 2].map(|i| head.pos[i] + hit.distance * direction[i]);
                // The camera frame has single precision, so the ray may hit another geom at an
                // edge.
                let near = (0..3).all(|i| (at[i] - found.point[i]).abs() < 1e-4 * (1.0 + at[i].abs()));
                assert!(near || hit.geom != geom, "{}: {at:?} and {:?}", subject.name, found.point);
            }
        }
    }
    assert!(geoms > 100 && skins > 5 && nothing > 5, "{geoms} geoms, {skins} skins, {nothing} times nothing");
}
