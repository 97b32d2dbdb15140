//! Rays for which the engine would exit or read out of bounds.

use mujoco_safe::data::RayOptions;
use mujoco_safe::enums::GeomType;
use mujoco_safe::math::{quat2mat, ray_geom, ray_skin};
use mujoco_safe::{Data, Error, Model, sample};

fn any() -> RayOptions {
    RayOptions::default()
}

#[test]
fn a_ray_without_a_direction_is_an_error() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    assert!(matches!(data.ray([0.0; 3], [1.0, 0.0, 0.0], &any()), Err(Error::NotComputed { call: "ray", .. })));
    data.forward().unwrap();
    let nan = f64::NAN;
    for direction in [[0.0; 3], [1e-300, 0.0, 0.0], [nan, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0], [1e300; 3]] {
        assert!(matches!(data.ray([0.0; 3], direction, &any()), Err(Error::Invalid { .. })), "{direction:?}");
        let skin = ray_skin(&[], &[], &[0.0; 3], &direction);
        assert!(matches!(skin, Err(Error::Invalid { .. })), "{direction:?}");
        let mut hits = [None; 1];
        assert!(data.multi_ray_into([0.0; 3], &[direction], &any(), 1.0, &mut hits).is_err());
    }
    assert!(matches!(data.ray([nan, 0.0, 0.0], [1.0, 0.0, 0.0], &any()), Err(Error::Invalid { .. })));
    let mut hits = [None; 2];
    let one = [[0.0, 0.0, -1.0]];
    assert!(matches!(data.multi_ray_into([0.0; 3], &one, &any(), 1.0, &mut hits), Err(Error::Shape { .. })));
    assert!(matches!(data.multi_ray_into([0.0; 3], &one, &any(), nan, &mut hits[..1]), Err(Error::Invalid { .. })));
}

#[test]
fn a_ray_ignores_excluded_geoms() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let above = [data.xpos()[1][0], data.xpos()[1][1], 5.0];
    let down = [0.0, 0.0, -1.0];
    let first = data.ray(above, down, &any()).unwrap().unwrap();
    assert_ne!(data.geom(first.geom).name(), Some("floor"));
    let nothing = any().with_geomgroup([false; 6]);
    let floor = data.ray(above, down, &nothing).unwrap();
    // 2.2.2 ignores the groups of planes.
    let expected = if cfg!(engine_since = "2.3.0") { None } else { Some("floor") };
    assert_eq!(floor.and_then(|hit| data.geom(hit.geom).name()), expected);
    assert_eq!(data.ray(above, down, &nothing.with_static_geoms(false)).unwrap(), None);
    let body = data.model().geom_bodyid()[first.geom.index()] as usize;
    let body = data.model().bodies().nth(body).unwrap().id();
    let excluded = data.ray(above, down, &any().with_bodyexclude(body)).unwrap().unwrap();
    assert!(excluded.distance > first.distance);
}

#[test]
fn a_ray_function_rejects_geoms_of_another_type() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let floor = data.model().geom("floor").unwrap().id();
    let down = [0.0, 0.0, -1.0];
    for result in [data.ray_mesh(floor, [0.0; 3], down), data.ray_hfield(floor, [0.0; 3], down)] {
        let error = result.unwrap_err();
        assert!(matches!(&error, Error::Invalid { value, .. } if value == "a Plane"), "{error}");
    }
    let upright = quat2mat(&[1.0, 0.0, 0.0, 0.0]);
    for shape in [GeomType::Mesh, GeomType::HeightField] {
        let result = ray_geom(&[0.0; 3], &upright, &[1.0; 3], &[0.0, 0.0, 2.0], &down, shape);
        assert!(matches!(result, Err(Error::Invalid { .. })), "{shape:?}");
    }
}

#[test]
fn a_height_field_with_more_rows_than_columns_is_an_error() {
    for (rows, columns, readable) in [(2, 2, true), (5, 5, true), (4, 9, true), (9, 4, false), (4000, 2, false)] {
        let xml = format!(
            r#"<mujoco>
                 <asset><hfield name="field" nrow="{rows}" ncol="{columns}" size="1 1 .5 .1"/></asset>
                 <worldbody><geom name="field" type="hfield" hfield="field"/></worldbody>
               </mujoco>"#
        );
        let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
        data.forward().unwrap();
        let field = data.model().geom("field").unwrap().id();
        // From the side, the direction in which the engine would read beyond the height field.
        let [point, direction] = [[3.0, 0.9, 0.2], [-1.0, 0.0, 0.0]];
        let results = [
            data.ray(point, direction, &any()).map(|hit| hit.map(|hit| hit.distance)),
            data.ray_hfield(field, point, direction),
        ];
        for result in results {
            assert_eq!(result.is_ok(), readable, "{rows} x {columns}: {result:?}");
        }
    }
}

#[test]
fn a_face_with_missing_vertices_is_an_error() {
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let (point, down) = (&[0.2, 0.2, 1.0], &[0.0, 0.0, -1.0]);
    assert!(ray_skin(&[[0, 1, 2]], &vertices, point, down).unwrap().is_some());
    assert!(ray_skin(&[[0, 1, 2]], &vertices, point, &[0.0, 0.0, 1.0]).unwrap().is_none());
    for face in [[0, 1, 3], [-1, 1, 2], [i32::MAX, 0, 1], [i32::MIN, 0, 1]] {
        let error = ray_skin(&[[0, 1, 2], face], &vertices, point, down).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{face:?}: {error}");
    }
}
