//! Distances between two geoms.

use mujoco_safe::data::GeomDistance;
use mujoco_safe::id::GeomId;
use mujoco_safe::{Data, Error, Model, sample};

/// Returns two geoms, the second on a body at `pos` with the orientation `euler` in degrees.
fn pair(first: &str, second: &str, pos: &str, euler: &str) -> Data {
    let xml = format!(
        r#"<mujoco>
             <asset>
               <mesh name="cube" vertex="-1 -1 -1  1 -1 -1  -1 1 -1  1 1 -1  -1 -1 1  1 -1 1  -1 1 1  1 1 1"/>
               <hfield name="flat" nrow="4" ncol="5" size="2 2 .5 .1"/>
             </asset>
             <worldbody>
               <geom name="a" {first}/>
               <body pos="{pos}" euler="{euler}"><freejoint/><geom name="b" {second}/></body>
             </worldbody>
           </mujoco>"#
    );
    let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
    data.kinematics().unwrap();
    data
}

fn geoms(data: &Data) -> [GeomId; 2] {
    ["a", "b"].map(|name| data.model().geom(name).unwrap().id())
}

fn distance(data: &mut Data, distmax: f64) -> Option<GeomDistance> {
    let [a, b] = geoms(data);
    data.geom_distance(a, b, distmax).unwrap()
}

const SPHERE: &str = r#"type="sphere" size=".5""#;
const CAPSULE: &str = r#"type="capsule" size=".25 1""#;
const BOX: &str = r#"type="box" size="1 1 1""#;
const PLANE: &str = r#"type="plane" size="5 5 .1""#;
const ELLIPSOID: &str = r#"type="ellipsoid" size=".5 1 2""#;
const CYLINDER: &str = r#"type="cylinder" size=".5 1""#;
const MESH: &str = r#"type="mesh" mesh="cube""#;
const FIELD: &str = r#"type="hfield" hfield="flat""#;

#[test]
fn distances_equal_analytic_distances() {
    let half = 0.5_f64;
    let cases: &[(&str, &str, &str, &str, f64)] = &[
        (SPHERE, SPHERE, "2 0 0", "0 0 0", 1.0),
        (SPHERE, SPHERE, "0 .6 0", "0 0 0", -0.4),
        (SPHERE, CAPSULE, "2 0 .7", "0 0 0", 1.25),
        (SPHERE, CAPSULE, "0 0 3", "0 0 0", 1.25),
        (CAPSULE, CAPSULE, "2 0 0", "90 0 0", 1.5),
        (CAPSULE, SPHERE, "2 0 0", "0 0 0", 1.25),
        (SPHERE, BOX, "3 0 0", "0 0 0", 1.5),
        (BOX, SPHERE, "2 2 2", "0 0 0", 3.0_f64.sqrt() - 0.5),
        (PLANE, SPHERE, "0 0 2", "0 0 0", 1.5),
        (PLANE, CAPSULE, "0 0 2", "0 90 0", 1.75),
        (PLANE, BOX, "1 2 4", "0 0 0", 3.0),
        (PLANE, BOX, "0 0 .5", "0 0 0", -0.5),
        (PLANE, CYLINDER, "0 0 3", "0 0 0", 2.0),
        (PLANE, ELLIPSOID, "0 0 3", "0 0 0", 1.0),
        (PLANE, MESH, "0 0 3", "0 0 0", 2.0),
        // Pairs for which the engine searches iteratively.
        (BOX, BOX, "4 0 0", "0 0 0", 2.0),
        (BOX, BOX, "4 4 4", "0 0 0", 12.0_f64.sqrt()),
        (BOX, BOX, "3 0 0", "0 0 45", 2.0 - 2.0_f64.sqrt()),
        (BOX, BOX, "1.5 .1 0", "0 0 0", -0.5),
        (BOX, CAPSULE, "3 0 0", "0 0 0", 1.75),
        (BOX, CAPSULE, "3 3 0", "0 0 0", 8.0_f64.sqrt() - 0.25),
        (ELLIPSOID, SPHERE, "3 0 0", "0 0 0", 2.0),
        (ELLIPSOID, ELLIPSOID, "0 0 5", "0 0 0", 1.0),
        (CYLINDER, CYLINDER, "0 0 3", "0 0 0", 1.0),
        (CYLINDER, SPHERE, "2 0 .5", "0 0 0", 1.0),
        (CYLINDER, BOX, "0 3 0", "0 0 0", 1.5),
        (MESH, SPHERE, "3 0 0", "0 0 0", 1.5),
        (MESH, BOX, "2.5 2.5 0", "0 0 0", half.sqrt()),
        (FIELD, SPHERE, ".3 .2 2", "0 0 0", 1.5),
    ];
    for &(first, second, pos, euler, expected) in cases {
        let what = format!("{first} and {second} at {pos}");
        let mut data = pair(first, second, pos, euler);
        let found = distance(&mut data, 100.0).unwrap_or_else(|| panic!("{what}"));
        assert!((found.distance - expected).abs() < 2e-5, "{what}: {} and not {expected}", found.distance);
        // The segment is as long as the distance. No result is returned beyond `distmax`.
        let [from, to] = found.fromto;
        let length = (0..3).map(|i| (from[i] - to[i]).powi(2)).sum::<f64>().sqrt();
        assert!((length - found.distance.abs()).abs() < 1e-9, "{what}: {found:?}");
        if expected > 0.0 {
            assert_eq!(distance(&mut data, 0.9 * expected), None, "{what}");
            assert!(distance(&mut data, 1.1 * expected).is_some(), "{what}");
        }
        // Exchanging the geoms reverses the segment. 3.5.0 finds other points then, up to 4 cm from
        // the analytic ones of two ellipsoids.
        let tolerance = match [first, second] {
            _ if cfg!(any(not(engine_since = "3.5.0"), engine_since = "3.17.0")) => 0.0,
            [ELLIPSOID, ELLIPSOID] => 0.08,
            _ => 1e-8,
        };
        let [a, b] = geoms(&data);
        let other = data.geom_distance(b, a, 100.0).unwrap().unwrap();
        // The nearest points of parallel faces are not unique, and newer engines find others.
        if cfg!(not(engine_since = "2.3.0")) || first != BOX || second != BOX {
            let reversed = [to, from];
            let mut pairs = other.fromto.as_flattened().iter().zip(reversed.as_flattened());
            assert!(pairs.all(|(a, b)| (a - b).abs() <= tolerance), "{what}: {found:?} and {other:?}");
        }
        assert!((other.distance - found.distance).abs() <= tolerance.min(2e-5), "{what}: {found:?} and {other:?}");
    }
}

#[test]
fn the_nearest_points_are_on_the_surfaces() {
    let mut data = pair(BOX, ELLIPSOID, "4 0 0", "0 0 0");
    let [[x, ..], [to, ..]] = distance(&mut data, 10.0).unwrap().fromto;
    assert!((x - 1.0).abs() < 1e-3 && (to - 3.5).abs() < 1e-3, "{x} and {to}");
    let mut data = pair(SPHERE, CAPSULE, "2 0 .7", "0 0 0");
    assert_eq!(distance(&mut data, 10.0).unwrap().fromto, [[0.5, 0.0, 0.0], [1.75, 0.0, 0.0]]);
}

#[test]
fn computing_a_distance_changes_nothing() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    // Collisions with this flag perturb the geoms and restore them.
    let multiccd = crate::flags::enable_flags() & mujoco_safe::model::EnableFlags::MULTICCD;
    data.edit_model(|model| model.edit_options(|options| options.enable |= multiccd)).unwrap();
    data.forward().unwrap();
    let before = (data.geom_xpos().to_vec(), data.geom_xmat().to_vec(), data.contacts().len());
    let ids: Vec<GeomId> = data.model().geoms().map(|geom| geom.id()).collect();
    let mut penetrating = 0;
    for &a in &ids {
        for &b in ids.iter().filter(|&&b| b != a) {
            penetrating +=
                usize::from(data.geom_distance(a, b, 2.0).unwrap().is_some_and(|found| found.distance < 0.0));
        }
    }
    assert!(penetrating > 0);
    assert_eq!((data.geom_xpos().to_vec(), data.geom_xmat().to_vec(), data.contacts().len()), before);
}

#[test]
fn contacts_have_the_distances_of_their_geoms() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    let contacts: Vec<_> = data.contacts().map(|contact| (contact.geoms().unwrap(), contact.dist())).collect();
    assert!(!contacts.is_empty());
    for (geoms, _) in &contacts {
        let of_pair = contacts.iter().filter(|(others, _)| others == geoms).map(|(_, dist)| *dist);
        let deepest = of_pair.fold(f64::INFINITY, f64::min);
        let found = data.geom_distance(geoms[0], geoms[1], 1.0).unwrap().unwrap();
        assert!((found.distance - deepest).abs() < 1e-12, "{} and {deepest}", found.distance);
    }
}

#[test]
fn unsupported_pairs_and_limits_are_errors() {
    let mut data = pair(PLANE, SPHERE, "0 0 2", "0 0 0");
    let [a, b] = geoms(&data);
    assert!(matches!(data.geom_distance(a, a, 1.0), Err(Error::Unsupported(_))), "two planes");
    for distmax in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(data.geom_distance(a, b, distmax), Err(Error::Invalid { .. })), "{distmax}");
    }
    data.geom_xpos_mut()[b.index()] = [f64::NAN; 3];
    assert!(matches!(data.geom_distance(a, b, 1.0), Err(Error::Unsupported(_))));
    data.reset().unwrap();
    assert!(matches!(data.geom_distance(a, b, 1.0), Err(Error::NotComputed { call: "geom_distance", .. })));
}

#[test]
#[should_panic(expected = "another model")]
fn a_geom_of_another_model_panics() {
    let mut data = pair(PLANE, SPHERE, "0 0 2", "0 0 0");
    let [a, _] = geoms(&data);
    let [_, b] = geoms(&pair(PLANE, SPHERE, "0 0 2", "0 0 0"));
    let _ = data.geom_distance(a, b, 1.0);
}
