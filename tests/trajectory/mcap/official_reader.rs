//! Files read by the official reader for Python, with its checks of all checksums.

use std::path::Path;
use std::sync::Arc;

use mujoco_safe::mcap::Log;
use mujoco_safe::{Controller, Data, Error, RandomController, Trajectory, sample};
use serde_json::Value;

use crate::python;

/// Prints the messages of all topics in the order of the file as JSON, with the metadata and the
/// names of the attachments. Both readers check the checksums of chunks, attachments and sections;
/// `check.py` checks the rest of the file before.
const SCRIPT: &str = r#"
import json, sys
from mcap.reader import NonSeekingReader, make_reader
from mcap_protobuf.decoder import DecoderFactory

def plain(value):
    if hasattr(value, "DESCRIPTOR"):
        return {field.name: plain(getattr(value, field.name)) for field in value.DESCRIPTOR.fields}
    if isinstance(value, (bool, int, float, str)):
        return value
    return [plain(part) for part in value]

with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    messages = [
        [channel.topic, schema.name, message.sequence, message.log_time, plain(decoded)]
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False)
    ]
    statistics = reader.get_summary().statistics
    attachments = [[part.name, part.media_type, part.data.decode()] for part in reader.iter_attachments()]
    metadata = {part.name: part.metadata for part in reader.iter_metadata()}
    file.seek(0)
    linear = NonSeekingReader(file, validate_crcs=True)
    assert sum(1 for _ in linear.iter_messages()) == statistics.message_count == len(messages)
print(json.dumps(dict(messages=messages, attachments=attachments, metadata=metadata)))
"#;

pub(super) fn read(path: &Path) -> Option<Value> {
    let script = [include_str!("check.py"), SCRIPT].concat();
    let output = python::run("mcap-protobuf-support", "mcap_protobuf, foxglove_schemas_protobuf", &script, path)?;
    Some(serde_json::from_str(&output).unwrap())
}

/// Returns the messages of a topic with their schema, number and time.
pub(super) fn messages<'v>(file: &'v Value, topic: &str, schema: &str) -> Vec<(u64, u64, &'v Value)> {
    let all = file["messages"].as_array().unwrap().iter().filter(|message| message[0] == topic);
    all.map(|message| {
        assert_eq!(message[1], schema);
        (message[2].as_u64().unwrap(), message[3].as_u64().unwrap(), &message[4])
    })
    .collect()
}

pub(super) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Object(parts) => parts.values().flat_map(numbers).collect(),
        Value::Array(parts) => parts.iter().flat_map(numbers).collect(),
        value => vec![value.as_f64().unwrap()],
    }
}

pub(super) fn vector(value: &Value) -> [f64; 3] {
    ["x", "y", "z"].map(|axis| value[axis].as_f64().unwrap())
}

fn timestamp(value: &Value) -> u64 {
    value["timestamp"]["seconds"].as_u64().unwrap() * 1_000_000_000 + value["timestamp"]["nanos"].as_u64().unwrap()
}

#[test]
fn the_official_reader_reads_the_values_of_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    // Some engines can write only the text of the model that was loaded last, and other tests load
    // models at the same time.
    let (model, log, xml) = loop {
        let model = Arc::new(sample::humanoid());
        let log = Log::create(&path, &model).unwrap();
        if let Ok(xml) = model.to_xml() {
            break (model, log, xml);
        }
    };
    let mut log = log.with_display_rate(f64::INFINITY);
    let mut data = Data::new(&model).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut controller = RandomController::new(1);
    let (mut states, mut results) = (Trajectory::new(&model), Vec::new());
    for _ in 0..60 {
        controller.control(&mut data).unwrap();
        states.push(&data).unwrap();
        log.step(&mut data).unwrap();
        // The results of the state before the step.
        results.push(data.clone());
    }
    log.finish().unwrap();
    let Some(file) = read(&path) else { return };

    let found = messages(&file, "/state", "mujoco.State");
    assert_eq!(found.len(), 60);
    for (record, (number, time, state)) in found.into_iter().enumerate() {
        assert_eq!((number, state["time"].as_f64()), (record as u64 + 1, Some(states.times()[record])));
        assert_eq!(time, record as u64 * 5_000_000);
        let parts = ["qpos", "qvel", "act"].iter().flat_map(|part| numbers(&state[part])).collect::<Vec<_>>();
        assert_eq!((&parts[..], &numbers(&state["ctrl"])[..]), (states.state(record), states.ctrl(record)));
    }
    let sensors = messages(&file, "/sensors", "mujoco.Sensors");
    for (result, (_, _, readings)) in results.iter().zip(sensors) {
        assert_eq!(readings.as_object().unwrap().len(), model.nsensor());
        for sensor in model.sensors() {
            let expected = &result.sensordata()[sensor.data_range()];
            assert_eq!(numbers(&readings[sensor.name().unwrap()]), expected, "{:?}", sensor.name());
        }
    }
    for (record, (_, time, message)) in messages(&file, "/joints", "foxglove.JointStates").into_iter().enumerate() {
        assert_eq!(timestamp(message), time);
        let joints = message["joints"].as_array().unwrap();
        assert_eq!(joints.len(), model.njnt() - 1); // all but the free joint
        for joint in joints {
            let of_model = model.joint(joint["name"].as_str().unwrap()).unwrap();
            let (qpos, dof) = (of_model.qpos_range().start, of_model.dofs().start);
            let expected = [states.qpos(record)[qpos], states.qvel(record)[dof], results[record].qfrc_actuator()[dof]];
            assert_eq!(["position", "velocity", "effort"].map(|part| joint[part].as_f64().unwrap()), expected);
        }
    }
    for (record, (_, time, message)) in messages(&file, "/tf", "foxglove.FrameTransforms").into_iter().enumerate() {
        let transforms = message["transforms"].as_array().unwrap();
        assert_eq!(transforms.len(), model.nbody() - 1);
        for transform in transforms {
            let body = results[record].body(transform["child_frame_id"].as_str().unwrap()).unwrap();
            let [x, y, z] = vector(&transform["rotation"]);
            assert_eq!((&transform["parent_frame_id"], timestamp(transform)), (&Value::from("world"), time));
            assert_eq!(vector(&transform["translation"]), *body.xpos());
            assert_eq!([transform["rotation"]["w"].as_f64().unwrap(), x, y, z], *body.xquat());
        }
    }
    let mut touched = 0;
    for (record, (_, _, message)) in messages(&file, "/contacts", "mujoco.Contacts").into_iter().enumerate() {
        let contacts = message["contacts"].as_array().unwrap();
        assert_eq!(contacts.len(), results[record].ncon());
        for (found, contact) in contacts.iter().zip(results[record].contacts()) {
            let geoms = contact.geoms().unwrap().map(|geom| model.name(geom).map(str::to_owned));
            for (name, geom) in ["geom1", "geom2"].iter().zip(geoms) {
                assert!(geom.is_none_or(|geom| found[name] == geom.as_str()));
            }
            assert_eq!((vector(&found["position"]), vector(&found["normal"])), (*contact.pos(), *contact.normal()));
            assert_eq!(vector(&found["force"]), contact.force_in_world().unwrap());
            assert_eq!(found["dist"].as_f64().unwrap(), contact.dist());
            touched += 1;
        }
    }
    assert!(touched > 20, "{touched} contacts");
    assert_eq!(file["attachments"][0][0], "model.xml");
    assert_eq!(file["attachments"][0][2].as_str().unwrap(), xml);
    assert_eq!(file["metadata"]["mujoco"]["sizes"], "nq 28, nv 27, na 0, nu 21, nsensordata 14");
}

#[cfg(feature = "renderer")]
#[test]
fn the_official_reader_reads_images_and_cameras() {
    use mujoco_safe::render::{DepthImage, LogImage, RgbImage};
    use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut side = Camera::fixed(data.model(), data.model().camera("side").unwrap().id());
    scene.update(&mut data, &SceneOptions::default(), None, &mut side, Categories::all()).unwrap();
    let pinhole = scene.pinhole_camera(3, 2).unwrap();

    let mut log = Log::create(&path, data.model()).unwrap();
    log.write(&data).unwrap();
    let pixels: Vec<u8> = (0..18).map(|value| 10 * value).collect();
    let rgb = RgbImage::from_rgb(3, 2, pixels.clone()).unwrap();
    let metres = [0.5, 1.25, f32::INFINITY, 3e-3, 7.0, 0.1];
    let depth = DepthImage::from_metres(3, 2, metres.to_vec()).unwrap();
    log.write_camera("side", 0.25, &pinhole).unwrap();
    for time in [0.25, 0.5] {
        log.write_image("side", time, &rgb).unwrap();
        log.write_image("side", time, LogImage::Png(&rgb)).unwrap();
        log.write_image("side", time, &depth).unwrap();
    }
    assert!(matches!(log.write_image("side", 1.0, &RgbImage::default()), Err(Error::Invalid { .. })));
    assert!(matches!(log.write_image("side", 1.0, &DepthImage::default()), Err(Error::Invalid { .. })));
    let orthographic = mujoco_safe::scene::PinholeCamera { orthographic: true, ..pinhole };
    assert!(matches!(log.write_camera("side", 1.0, &orthographic), Err(Error::Invalid { .. })));
    log.finish().unwrap();
    assert_eq!(Trajectory::load_mcap(data.model(), &path).unwrap().len(), 1);
    let Some(file) = read(&path) else { return };

    let bytes = |image: &Value| numbers(&image["data"]).iter().map(|&byte| byte as u8).collect::<Vec<_>>();
    let images = messages(&file, "/camera/side/rgb", "foxglove.RawImage");
    assert_eq!(images.iter().map(|(_, time, _)| *time).collect::<Vec<_>>(), [250_000_000, 500_000_000]);
    let (_, time, image) = images[0];
    assert_eq!((timestamp(image), bytes(image)), (time, pixels.clone()));
    assert_eq!((&image["encoding"], &image["frame_id"]), (&Value::from("rgb8"), &Value::from("camera/side")));
    assert_eq!(["width", "height", "step"].map(|field| image[field].as_u64().unwrap()), [3, 2, 9]);
    let image = messages(&file, "/camera/side/depth", "foxglove.RawImage")[1].2;
    let found: Vec<f32> = bytes(image).as_chunks().0.iter().map(|&depth| f32::from_le_bytes(depth)).collect();
    assert_eq!((&image["encoding"], &found[..]), (&Value::from("32FC1"), &metres[..]));
    assert_eq!(image["step"], 12);
    let image = messages(&file, "/camera/side/png", "foxglove.CompressedImage")[0].2;
    assert_eq!(image["format"], "png");
    let mut png = png::Decoder::new(std::io::Cursor::new(bytes(image))).read_info().unwrap();
    let mut decoded = vec![0; 18];
    png.next_frame(&mut decoded).unwrap();
    assert_eq!(decoded, pixels);

    // The calibration and the frame project a point to its pixel.
    let calibration = messages(&file, "/camera/side/calibration", "foxglove.CameraCalibration")[0].2;
    let frames = messages(&file, "/tf", "foxglove.FrameTransforms");
    let of_camera = |frames: &&Value| frames["transforms"][0]["child_frame_id"] == calibration["frame_id"];
    let frame = &frames.iter().map(|(_, _, frames)| *frames).find(of_camera).unwrap()["transforms"][0];
    let [x, y, z] = vector(&frame["rotation"]);
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(frame["rotation"]["w"].as_f64().unwrap(), x, y, z));
    let head = *data.body("head").unwrap().xpos();
    let in_camera = rotation.inverse() * (Vector3::from(head) - Vector3::from(vector(&frame["translation"])));
    let projection = nalgebra::Matrix3x4::from_row_slice(&numbers(&calibration["P"]));
    let image = projection * in_camera.push(1.0);
    let expected = pinhole.project(head).unwrap();
    for axis in 0..2 {
        assert!((image[axis] / image[2] + 0.5 - expected[axis]).abs() < 1e-6, "{image} {expected:?}");
    }
    assert!(image[2] > 0.0);
}

#[test]
fn the_official_reader_reads_the_shapes_and_the_names() -> Result<(), Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let model = mujoco_safe::Model::from_xml_str(
        r#"<mujoco>
             <asset>
               <material name="red" rgba="1 0 0 1"/>
               <hfield name="hill" nrow="2" ncol="3" size="3 2 .5 .1"/>
               <mesh name="tetrahedron" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
             </asset>
             <worldbody>
               <geom type="plane" size="0 4 1" rgba="0 1 0 .5"/>
               <geom type="hfield" hfield="hill"/>
               <body name="a" pos="0 0 1">
                 <freejoint/>
                 <site name="s"/>
                 <geom type="box" size=".1 .2 .3" pos="1 2 3" material="red"/>
                 <geom type="sphere" size=".4"/>
                 <geom type="ellipsoid" size=".1 .2 .3"/>
                 <geom type="cylinder" size=".1 .2"/>
                 <geom type="capsule" fromto="0 0 0  2 0 0" size=".1"/>
                 <geom type="sphere" size="9" group="3"/>
               </body>
               <body pos="5 0 1"><freejoint/><geom type="mesh" mesh="tetrahedron"/></body>
             </worldbody>
             <sensor>
               <accelerometer name="imu left/1" site="s"/><gyro site="s"/><framepos name="sensor1" objtype="site" objname="s"/>
               <framequat name="imu_left-1" objtype="site" objname="s"/>
             </sensor>
           </mujoco>"#,
    )?;
    let mut trajectory = Trajectory::with_sensordata(&model);
    let mut data = Data::new(model)?;
    trajectory.record(&mut data, &mut |_: &mut Data| (), 1)?;
    trajectory.save_mcap(data.model(), &path)?;
    let Some(file) = read(&path) else { return Ok(()) };

    let scene = messages(&file, "/scene", "foxglove.SceneUpdate")[0].2;
    let entity = |frame: &str| {
        let mut entities = scene["entities"].as_array().unwrap().iter();
        let found = entities.find(|entity| entity["frame_id"] == frame).unwrap();
        assert!(found["id"] == frame && found["frame_locked"] == true);
        found
    };
    let (world, body, mesh) = (entity("world"), entity("a"), entity("body2"));
    let [plane, hill] = &world["triangles"].as_array().unwrap()[..] else { panic!("{world}") };
    assert_eq!(numbers(&plane["color"]), [0.5, 0.0, 1.0, 0.0]); // a, b, g, r: sorted by name
    let extent = 5.0 * data.model().statistics().extent;
    assert_eq!(vector(&plane["points"][3]), [extent, 4.0, 0.0]);
    assert_eq!(vector(&hill["points"][5]), [3.0, 2.0, 0.0]);
    assert_eq!((plane["indices"].as_array().unwrap().len(), hill["indices"].as_array().unwrap().len()), (6, 12));

    let cube = &body["cubes"][0];
    assert_eq!((vector(&cube["size"]), vector(&cube["pose"]["position"])), ([0.2, 0.4, 0.6], [1.0, 2.0, 3.0]));
    assert_eq!(numbers(&cube["color"]), [1.0, 0.0, 0.0, 1.0]);
    let sizes =
        |kind: &str| body[kind].as_array().unwrap().iter().map(|part| vector(&part["size"])).collect::<Vec<_>>();
    assert_eq!(sizes("spheres"), [[0.8; 3], [0.2, 0.4, 0.6], [0.2; 3], [0.2; 3]]);
    assert_eq!(sizes("cylinders"), [[0.2, 0.2, 0.4], [0.2, 0.2, 2.0]]);
    let end = |index: usize| vector(&body["spheres"][index]["pose"]["position"]);
    let (mut ends, expected) = ([end(2), end(3)], [[0.0; 3], [2.0, 0.0, 0.0]]);
    ends.sort_by(|first, second| first[0].total_cmp(&second[0]));
    assert!(ends.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-12), "{ends:?}");

    let tetrahedron = &mesh["triangles"][0];
    let (points, indices) = (tetrahedron["points"].as_array().unwrap(), numbers(&tetrahedron["indices"]));
    assert_eq!((points.len(), indices.len()), (4, 12));
    let triple = |face: &[f64]| {
        let [a, b, c] = [0, 1, 2].map(|corner| vector(&points[face[corner] as usize]));
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    // The faces point outwards: their volumes are those of the tetrahedron.
    let volume = indices.chunks(3).map(triple).sum::<f64>() / 6.0;
    assert!((volume - 1.0 / 6.0).abs() < 1e-6, "{volume}");

    let sensors = messages(&file, "/sensors", "mujoco.Sensors")[0].2;
    let names: Vec<&String> = sensors.as_object().unwrap().keys().collect();
    assert_eq!(names, ["imu_left_1", "imu_left_1_2", "sensor1", "sensor1_2"]);
    assert_eq!(numbers(&sensors["imu_left_1"]), trajectory.sensordata(0)[..3]);
    assert_eq!(numbers(&sensors["sensor1_2"]), trajectory.sensordata(0)[3..6]);
    assert_eq!(numbers(&sensors["sensor1"]), trajectory.sensordata(0)[6..9]);
    Ok(())
}
