//! Normals and texture coordinates of meshes, which have their own indices in newer engines, and
//! the faces of skins.

use mujoco_safe::{Data, Error, LoadOptions, Model};

/// Cube with one normal for each side.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 0 1 0\nvn -1 0 0\nvn 1 0 0
f 1//1 4//1 3//1\nf 1//1 3//1 2//1\nf 5//2 6//2 7//2\nf 5//2 7//2 8//2
f 1//3 2//3 6//3\nf 1//3 6//3 5//3\nf 4//4 8//4 7//4\nf 4//4 7//4 3//4
f 1//5 5//5 8//5\nf 1//5 8//5 4//5\nf 2//6 3//6 7//6\nf 2//6 7//6 6//6\n";

const PYRAMID: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1
f 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 1/1 4/4 3/3\nf 2/2 3/3 4/4\n";

/// The pyramid as an element of a text.
const PYRAMID_TEXT: &str =
    "<mesh name='pyramid' vertex='0 0 0 1 0 0 0 1 0 0 0 1' texcoord='0 0 1 0 0 1 1 1' face='0 2 1 0 1 3 0 3 2 1 2 3'/>";

fn load(pyramid: &str) -> mujoco_safe::Result<Model> {
    // In this version the readers of mesh files are plugins.
    #[cfg(all(engine_since = "3.6.0", not(engine_since = "3.7.0")))]
    if let Some(directory) = crate::plugin::directory() {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(directory) }.unwrap();
    }
    let text = format!(
        "<mujoco>
          <asset>{pyramid}<mesh name='cube' file='cube.obj'/></asset>
          <worldbody><geom type='mesh' mesh='pyramid' pos='3 0 0'/><geom type='mesh' mesh='cube'/></worldbody>
        </mujoco>"
    );
    let files = [("cube.obj", CUBE.as_bytes()), ("pyramid.obj", PYRAMID.as_bytes())];
    Model::from_xml_str_with(&text, &LoadOptions::default().with_files(&files))
}

fn model() -> Model {
    load("<mesh name='pyramid' file='pyramid.obj'/>").unwrap()
}

/// Computes the unit normal of a triangle.
fn normal([first, second, third]: [[f32; 3]; 3]) -> [f32; 3] {
    let edge = |to: [f32; 3]| std::array::from_fn::<f32, 3, _>(|axis| to[axis] - first[axis]);
    let (u, v) = (edge(second), edge(third));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt();
    normal.map(|value| value / length)
}

#[test]
fn normals_of_the_corners_of_a_cube_are_those_of_its_sides() {
    let model = model();
    let cube = model.mesh("cube").unwrap();
    assert_eq!((cube.face().len(), cube.facenormal().len()), (12, 12));
    for (face, normals) in cube.face().iter().zip(cube.facenormal()) {
        let side = normal(face.map(|vertex| cube.vert()[vertex as usize]));
        for index in normals {
            let dot: f32 = cube.normal()[*index as usize].iter().zip(side).map(|(a, b)| a * b).sum();
            assert!(dot > 0.999, "{face:?} {normals:?}");
        }
    }
    assert!(cube.texcoord().is_empty() && cube.facetexcoord().is_empty());
}

#[test]
#[cfg_attr(
    all(engine_since = "2.3.3", not(engine_since = "2.3.6")),
    ignore = "the compiler confuses the coordinates when it flips them"
)]
fn texture_coordinates_of_the_corners_are_those_of_the_vertices_in_a_file() {
    check_texcoords(&model());
}

#[test]
fn texture_coordinates_of_the_corners_are_those_of_the_vertices_in_the_text() {
    // The compiler of these engines crashes on such a mesh.
    if cfg!(all(engine_since = "2.3.3", not(engine_since = "3.1.3"))) {
        assert!(load(PYRAMID_TEXT).unwrap_err().to_string().contains("use an OBJ file"));
    } else {
        check_texcoords(&load(PYRAMID_TEXT).unwrap());
    }
}

fn check_texcoords(model: &Model) {
    let pyramid = model.mesh("pyramid").unwrap();
    // The engine moves the vertices to the centre of mass and rotates them, so the corners are
    // recognised by their order in a face.
    let corners = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let texcoords = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    assert_eq!(pyramid.facetexcoord().len(), 4);
    for (expected, found) in corners.iter().zip(pyramid.facetexcoord()) {
        let found = found.map(|index| pyramid.texcoord()[index as usize]);
        // The compiler of newer engines flips the second coordinate.
        let flipped = found.map(|[u, v]| [u, 1.0 - v]);
        let expected = expected.map(|vertex: usize| texcoords[vertex]);
        assert!(found == expected || flipped == expected, "{found:?} {expected:?}");
    }
}

#[cfg(feature = "renderer")]
#[test]
fn a_mesh_with_fewer_normals_than_vertices_is_drawn() {
    use mujoco_safe::render::Renderer;
    use mujoco_safe::scene::Camera;

    let mut data = mujoco_safe::Data::new(model()).unwrap();
    data.forward().unwrap();
    let mut renderer = Renderer::new(data.model(), 64, 64).unwrap();
    let mut camera = Camera::free(data.model());
    let picture = renderer.snapshot(&mut data, &mut camera).unwrap().rgb().unwrap();
    let mut colours: Vec<[u8; 3]> = picture.as_bytes().as_chunks().0.to_vec();
    colours.sort_unstable();
    colours.dedup();
    // The background and three sides.
    assert!(colours.len() >= 4, "{colours:?}");
}

#[test]
fn a_skin_with_a_face_of_a_missing_vertex_is_rejected_before_it_is_drawn() {
    for (face, is_valid) in [("0 1 2", true), ("0 1 3", false), ("0 -1 2", false)] {
        let result = Model::from_xml_str(&format!(
            "<mujoco><asset>
               <skin name='s' vertex='0 0 0 1 0 0 0 1 0' face='{face}'>
                 <bone body='world' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/>
               </skin>
             </asset></mujoco>"
        ));
        assert_eq!(result.is_ok(), is_valid, "{face}: {result:?}");
    }
}

#[test]
fn an_error_in_a_collision_leaves_no_memory_of_its_simulation_to_later_collisions() {
    let text = r#"<mujoco><worldbody><geom type="ellipsoid" size=".1 .2 .3"/>
        <body pos=".05 0 0"><freejoint/><geom type="ellipsoid" size=".3 .2 .1"/></body></worldbody></mujoco>"#;
    let model = std::sync::Arc::new(Model::from_xml_str(text).unwrap());
    // Returns the number of bytes of its stack that a new simulation uses.
    let used = || {
        let mut data = Data::new(&model).unwrap();
        data.kinematics().unwrap();
        let [one, other] = [0, 1].map(|geom| model.geom(geom).unwrap().id());
        data.geom_distance(one, other, 1.0).unwrap();
        data.maxuse_stack()
    };
    let before = used();
    // Engines before 3.9 do not use the stack here.
    assert!(before > 0 || cfg!(not(engine_since = "3.10.0")));
    let mut failing = Data::new(&model).unwrap();
    failing.edit_model(|model| model.geom_size_mut().as_flattened_mut().fill(1e9)).unwrap();
    assert!(matches!(failing.forward(), Err(Error::Engine { .. })));
    drop(failing);
    assert_eq!(used(), before);
}
