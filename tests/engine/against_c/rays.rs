//! Rays.

use mujoco_safe::data::RayOptions;
use mujoco_safe::enums::GeomType;
use mujoco_safe::math::ray_geom;

use crate::twins::{Twins, assert_same, differing, usual_subjects};

#[test]
fn rays_equal_c() {
    let mut hits = 0;
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        if twins.model.nhfield() > 0 && twins.ours.ray([0.0; 3], [1.0, 0.0, 0.0], &RayOptions::default()).is_err() {
            println!("skipped {}, whose height field the engine misreads", twins.name);
            continue;
        }
        let exclude = twins.model.bodies().last().unwrap().id();
        let some_groups = [true, false, true, false, true, true];
        for options in [
            RayOptions::default(),
            RayOptions::default().with_static_geoms(false),
            RayOptions::default().with_bodyexclude(exclude),
            RayOptions::default().with_geomgroup(some_groups),
        ] {
            for _ in 0..50 {
                let numbers = twins.numbers(6);
                let [point, direction] = [0, 3].map(|at| [numbers[at] * 2.0, numbers[at + 1] * 2.0, numbers[at + 2]]);
                let ours = twins.ours.ray(point, direction, &options).unwrap();
                let groups = options.geomgroup.map(|groups| groups.map(u8::from));
                let groups = groups.as_ref().map_or(std::ptr::null(), |groups| groups.as_ptr());
                let body = options.bodyexclude.map_or(-1, |body| body.index() as i32);
                let with_static = options.static_geoms;
                let (mut geom, m, d) = (0, twins.raw.m(), twins.raw.d);
                let (pnt, vec) = (point.as_ptr(), direction.as_ptr());
                // SAFETY: the model and data of one pair of twins.
                let theirs = unsafe { differing::ray((m, d), [pnt, vec], groups, with_static, body, &mut geom) };
                assert_eq!(ours.map_or(-1, |hit| hit.geom.index() as i32), geom, "{}", twins.name);
                assert_same(&twins.name, &[ours.map_or(-1.0, |hit| hit.distance)], &[theirs]);
                hits += usize::from(ours.is_some());
            }
        }
    }
    assert!(hits > 100, "only {hits} rays hit a geom");
}

/// A ray on one geom in C.
macro_rules! one_ray {
    ($function:ident($($argument:expr),*)) => {
        // SAFETY: the model and data of one pair of twins, and a geom of the model.
        unsafe { differing::$function($($argument),*) }
    };
}

#[test]
fn rays_on_one_geom_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let model = twins.model.clone();
        for geom in model.geoms().take(40) {
            for _ in 0..10 {
                // From a nearby point towards the geom.
                let numbers = twins.numbers(3);
                let centre = twins.ours.geom_xpos()[geom.index()];
                let direction = [numbers[0], numbers[1], numbers[2]];
                let point = [0, 1, 2].map(|i| centre[i] - 3.0 * direction[i]);
                let (m, d, id) = (twins.raw.m(), twins.raw.d, geom.index() as i32);
                let (pnt, vec) = (point.as_ptr(), direction.as_ptr());
                let (ours, theirs) = match geom.geom_type() {
                    GeomType::Mesh => {
                        (twins.ours.ray_mesh(geom, point, direction), one_ray!(ray_mesh(m, d, id, [pnt, vec])))
                    }
                    GeomType::HeightField => match twins.ours.ray_hfield(geom, point, direction) {
                        Ok(ours) => (Ok(ours), one_ray!(ray_hfield(m, d, id, [pnt, vec]))),
                        Err(_) => continue,
                    },
                    shape => {
                        assert!(twins.ours.ray_mesh(geom, point, direction).is_err());
                        assert!(twins.ours.ray_hfield(geom, point, direction).is_err());
                        let (pos, mat) = (twins.ours.geom_xpos()[geom.index()], twins.ours.geom_xmat()[geom.index()]);
                        let size = model.geom_size()[geom.index()];
                        let ours = ray_geom(&pos, &mat, &size, &point, &direction, shape);
                        let (pos, mat, size) = (pos.as_ptr(), mat.as_ptr(), size.as_ptr());
                        (ours, one_ray!(ray_geom([pos, mat, size], [pnt, vec], model.geom_type()[geom.index()])))
                    }
                };
                assert_same(&format!("{geom:?}"), &[ours.unwrap().unwrap_or(-1.0)], &[theirs.max(-1.0)]);
            }
        }
    }
}
