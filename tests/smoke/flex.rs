//! Flexes: ropes, cloths and soft bodies. The independent source is the C API of the same engine.

use std::collections::BTreeSet;

use mujoco_safe::data::ContactSide;
use mujoco_safe::element::{EqualityObjects, Object};
use mujoco_safe::enums::EqualityType;
use mujoco_safe::scene::{Camera, Categories, SceneOptions, VisualFlags};
use mujoco_safe::sys;
use mujoco_safe::{Data, Differences, Model, Scene, StateSpec};

use crate::Raw;

const STEPS: usize = 200;

/// A cloth above a ball, a rope, and a soft block, each its own colour.
const TEXT: &str = r#"<mujoco>
  <statistic center="0 0 0.1" extent="1"/>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="floor" type="plane" size="2 2 0.1" rgba="0.5 0.5 0.5 1"/>
    <geom name="ball" size="0.1" pos="0 0 0.1"/>
    <flexcomp name="cloth" type="grid" count="5 5 1" spacing="0.08 0.08 0.08" pos="0 0 0.22" dim="2" radius="0.005" mass="0.2" rgba="1 0 0 1">
      <edge equality="true"/>
      <contact selfcollide="none"/>
    </flexcomp>
    <flexcomp name="rope" type="grid" count="6 1 1" spacing="0.05 0.05 0.05" pos="0.5 0 0.05" dim="1" radius="0.01" mass="0.1" rgba="0 1 0 1">
      <edge equality="true"/>
      <contact selfcollide="none"/>
    </flexcomp>
    <flexcomp name="block" type="grid" count="3 3 3" spacing="0.05 0.05 0.05" pos="-0.5 0 0.1" dim="3" radius="0.005" mass="0.5" rgba="0 0 1 1">
      <edge damping="1"/>
      <elasticity young="5e3" poisson="0.3"/>
      <contact selfcollide="none"/>
    </flexcomp>
  </worldbody>
</mujoco>"#;

const ROPE: &str = r#"<mujoco>
  <worldbody>
    <flexcomp name="rope" type="grid" count="4 1 1" spacing="0.05 0.05 0.05" dim="1" radius="0.01" mass="0.1">
      <edge stiffness="100" damping="0.1"/>
      <pin id="0"/>
    </flexcomp>
  </worldbody>
</mujoco>"#;

fn model() -> Model {
    // The elasticity of a flex was a plugin before 3.2.3.
    let elasticity = r#"<elasticity young="5e3" poisson="0.3"/>"#;
    let text = if cfg!(engine_since = "3.2.5") { TEXT.to_owned() } else { TEXT.replace(elasticity, "") };
    Model::from_xml_str(&text).unwrap()
}

fn fallen() -> Data {
    let mut data = Data::new(model()).unwrap();
    data.step_n(STEPS).unwrap();
    data.forward().unwrap();
    data
}

/// A tuple can name objects of kinds that have no views.
#[test]
fn a_tuple_refers_to_a_flex() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody><flexcomp name="rope" type="grid" count="3 1 1" spacing=".1 .1 .1" dim="1" mass="1" radius=".01"/>
             <body name="b"><geom size=".1"/></body></worldbody>
           <custom><tuple name="t"><element objtype="body" objname="b"/><element objtype="flex" objname="rope"/></tuple></custom></mujoco>"#,
    )
    .unwrap();
    let body = model.body("b").unwrap().id();
    let objects: Vec<Object> = model.tuple("t").unwrap().objects().collect();
    assert_eq!(objects, [Object::Body(body), Object::Flex(0)]);
}

#[test]
fn steps_and_contacts_of_flexes_equal_those_of_c() {
    let mut data = Data::new(model()).unwrap();
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    let mut kinds = BTreeSet::new();
    for step in 0..STEPS {
        data.step().unwrap();
        c!(mj_step(data.model().as_ptr(), raw.0));
        // SAFETY: the arrays have the lengths of the model and of the last step.
        let (qpos, contacts) = unsafe {
            (
                std::slice::from_raw_parts((*raw.0).qpos, data.model().nq()),
                (0..(*raw.0).ncon as usize).map(|index| *(*raw.0).contact.add(index)).collect::<Vec<_>>(),
            )
        };
        assert_eq!(data.qpos(), qpos, "step {step}");
        assert_eq!(data.contacts().len(), contacts.len());
        for (ours, theirs) in data.contacts().zip(contacts) {
            let sides = ours.sides().map(|side| match side {
                ContactSide::Geom(geom) => ["geom".to_owned(), geom.index().to_string()],
                ContactSide::FlexElement { flex, element } => ["element".to_owned(), format!("{flex} {element}")],
                ContactSide::FlexVertex { flex, vertex } => ["vertex".to_owned(), format!("{flex} {vertex}")],
                other => panic!("{other:?}"),
            });
            for (side, found) in sides.iter().enumerate() {
                let expected = match (theirs.geom[side], theirs.flex[side], theirs.elem[side], theirs.vert[side]) {
                    (geom, -1, ..) => ["geom".to_owned(), geom.to_string()],
                    (_, flex, element, -1) => ["element".to_owned(), format!("{flex} {element}")],
                    (_, flex, _, vertex) => ["vertex".to_owned(), format!("{flex} {vertex}")],
                };
                assert_eq!(*found, expected);
                kinds.insert(found[0].clone());
            }
            assert_eq!(ours.geoms().is_some(), theirs.flex == [-1, -1]);
            assert!(ours.force().is_ok());
        }
    }
    assert!(kinds.contains("geom") && kinds.len() > 1, "{kinds:?}");
}

#[test]
fn resets_copies_and_states_of_flexes_are_exact() {
    let mut data = fallen();
    let saved = data.state(StateSpec::INTEGRATION);
    let mut copy = data.clone();
    data.step_n(STEPS).unwrap();
    copy.step_n(STEPS).unwrap();
    let end = data.qpos().to_vec();
    assert_eq!(copy.qpos(), end);
    data.set_state(StateSpec::INTEGRATION, &saved).unwrap();
    data.step_n(STEPS).unwrap();
    assert_eq!(data.qpos(), end);
    data.reset().unwrap();
    data.step_n(STEPS).unwrap();
    data.forward().unwrap();
    assert_eq!(data.state(StateSpec::INTEGRATION), saved);
}

#[test]
fn the_linearisation_of_a_flex_equals_that_of_c() {
    let mut data = Data::new(Model::from_xml_str(ROPE).unwrap()).unwrap();
    let (nv, nu) = (data.model().nv(), data.model().nu());
    assert!(nv > 0 && nu == 0);
    let ours = data.transition_fd(1e-6, Differences::Central).unwrap();
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    let mut a = vec![0.0; 4 * nv * nv];
    let none = std::ptr::null_mut();
    c!(mjd_transitionFD(data.model().as_ptr(), raw.0, 1e-6, 1, a.as_mut_ptr(), none, none, none));
    assert_eq!(ours.a.as_slice(), a);
}

#[test]
fn an_equality_constraint_of_a_flex_names_it() {
    let model = model();
    let found: Vec<_> = model.equalities().map(|equality| (equality.equality_type(), equality.objects())).collect();
    assert_eq!(found, [0, 1].map(|flex| (EqualityType::Flex, EqualityObjects::Flex(flex))));
}

#[test]
fn a_scene_has_the_vertices_of_flexes_and_selects_them() {
    let mut data = fallen();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    assert!(scene.flexes().all(|flex| flex.faces.is_empty() && flex.vertices.iter().all(|at| *at == [0.0; 3])));
    let mut camera = Camera::free(data.model());
    (camera.lookat, camera.distance) = ([0.0, 0.0, 0.1], 1.0);
    let options = SceneOptions::default();
    scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
    let vertices: Vec<f32> = scene.flexes().flat_map(|flex| flex.vertices.as_flattened()).copied().collect();
    let expected: Vec<f32> = data.flexvert_xpos().as_flattened().iter().map(|&number| number as f32).collect();
    assert_eq!(vertices, expected);
    // A rope has edges, a cloth and a block have a surface.
    let shown: Vec<_> =
        scene.flexes().map(|flex| (flex.faces.is_empty(), flex.shows_edges, flex.shows_vertices)).collect();
    assert_eq!(shown, [(false, false, false), (true, true, false), (false, false, false)]);
    let found = scene.select(&data, &options, 1.0, [0.5, 0.5]).unwrap().expect("the cloth is at the centre");
    assert_eq!((found.flex, found.geom, found.skin), (Some(0), None, None));
    let hidden = options.with_flags(SceneOptions::default().flags - VisualFlags::FLEXSKIN - VisualFlags::FLEXEDGE);
    let behind = scene.select(&data, &hidden, 1.0, [0.5, 0.5]).unwrap().expect("the ball is below the cloth");
    assert_eq!((behind.flex, behind.geom), (None, Some(data.model().geom("ball").unwrap().id())));
}

#[cfg(feature = "renderer")]
#[test]
fn flexes_are_drawn_with_their_colours() {
    use mujoco_safe::render::Renderer;

    let mut data = fallen();
    let mut renderer = Renderer::new(data.model(), 160, 120).unwrap();
    let mut camera = Camera::free(data.model());
    (camera.lookat, camera.distance, camera.elevation) = ([0.0, 0.0, 0.1], 2.0, -40.0);
    let default = SceneOptions::default();
    let all = VisualFlags::FLEXVERT | VisualFlags::FLEXEDGE | VisualFlags::FLEXFACE;
    for options in [default.clone(), default.clone().with_flags((default.flags - VisualFlags::FLEXSKIN) | all)] {
        let mut snapshot = renderer.snapshot_with(&mut data, &mut camera, &options).unwrap();
        let picture = snapshot.rgb().unwrap();
        for (flex, channel) in [(0, 0), (1, 1), (2, 2)] {
            let is_it = |pixel: &&[u8; 3]| (0..3).all(|other| other == channel || pixel[channel] / 2 > pixel[other]);
            let count = picture.as_bytes().as_chunks().0.iter().filter(is_it).count();
            // The lines of a flex are a pixel wide.
            assert!(count > 10, "flex {flex} has {count} pixels");
        }
        let segments = snapshot.segmentation().unwrap().segments();
        let flexes: BTreeSet<usize> =
            segments.iter().filter_map(|(segment, _)| snapshot.scene().geom(segment.geom).flex()).collect();
        assert_eq!(flexes, BTreeSet::from([0, 1, 2]));
    }
    let hidden = default.with_flexgroup([false; 6]);
    let picture = renderer.snapshot_with(&mut data, &mut camera, &hidden).unwrap().rgb().unwrap();
    assert!(picture.as_bytes().as_chunks::<3>().0.iter().all(|[red, green, _]| red / 2 <= *green));
}

#[test]
fn flexes_have_islands_unless_the_engine_writes_out_of_bounds_for_them() {
    use mujoco_safe::model::{DisableFlags, Options};

    let islands = |data: &Data| {
        assert!(data.contacts().len() > 0);
        // SAFETY: the pointer of a valid simulation, of which a number is read.
        unsafe { (*data.as_ptr()).nisland }
    };
    let mut data = fallen();
    let before = islands(&data);
    assert_eq!(before > 0, cfg!(engine_since = "3.6.0"), "{before} islands");
    let is_disabled = cfg!(all(engine_since = "3.3.6", not(engine_since = "3.6.0")));
    assert_eq!(data.model().options().disable.contains(DisableFlags::ISLAND), is_disabled);

    let enable = |options: &mut Options| options.disable = DisableFlags::empty();
    data.edit_model(|model| model.edit_options(enable)).unwrap();
    data.forward().unwrap();
    let mut model = Model::clone(data.model());
    model.edit().edit_options(enable).unwrap();
    let mut copy = Data::new(model).unwrap();
    copy.set_state(StateSpec::INTEGRATION, &data.state(StateSpec::INTEGRATION)).unwrap();
    copy.forward().unwrap();
    assert_eq!([islands(&data), islands(&copy)], [before; 2]);
}

#[test]
fn inconsistent_flexes_are_errors() {
    let flex = |attributes: &str| {
        format!(
            "<mujoco><worldbody><body name='a'><joint/><geom size='0.1'/></body><body name='b' pos='1 0 0'><joint/><geom size='0.1'/></body>
             </worldbody><deformable><flex name='f' {attributes}/></deformable></mujoco>"
        )
    };
    assert!(Model::from_xml_str(&flex("dim='1' body='a b' element='0 1'")).is_ok());
    for wrong in [
        "dim='1' body='a b' element='0 99'",
        "dim='1' body='a b' element='0 -1'",
        "dim='2' body='a b' element='0 1'",
        "dim='1' body='a c' element='0 1'",
        "dim='7' body='a b' element='0 1'",
    ] {
        assert!(Model::from_xml_str(&flex(wrong)).is_err(), "{wrong}");
    }
    for large in [
        "count='1000 1000 1000'",
        "count='100000 1 1' dof='trilinear'",
        "count='3 3 3' dof='quadratic' cellcount='999 999 999'",
    ] {
        let text = format!("<mujoco><worldbody><flexcomp type='grid' dim='3' {large}/></worldbody></mujoco>");
        assert!(Model::from_xml_str(&text).is_err(), "{large}");
    }
}

/// Rows of contacts with torsional and rolling friction, which engines before 3.11 compute wrongly
/// for a sparse Jacobian.
#[test]
#[cfg_attr(not(engine_since = "3.3.6"), ignore = "older compilers have other flexes")]
fn rolling_friction_of_flexes_has_the_rows_of_the_dense_jacobian() {
    let model = |jacobian: &str, condim: usize| {
        Model::from_xml_str(&format!(
            r#"<mujoco><option jacobian="{jacobian}"/><worldbody><geom type="box" size=".1 .1 .02" condim="{condim}"/>
                 <flexcomp name="block" type="grid" count="2 2 2" spacing=".1 .1 .1" pos="0.02 0.01 0.06" dim="3" radius="0.005" mass="0.5">
                   <elasticity young="5e3" poisson="0.3"/><contact selfcollide="none" condim="{condim}"/>
                 </flexcomp></worldbody></mujoco>"#
        ))
        .unwrap()
    };
    let rows = |model: Model| {
        let mut data = Data::new(model).unwrap();
        data.qvel_mut().iter_mut().zip(0..).for_each(|(velocity, i)| *velocity = 0.1 * f64::from(i % 5));
        data.forward().unwrap();
        assert!(data.ncon() > 0);
        // J v
        let mut rates = vec![0.0; data.nefc()];
        data.mul_jac_vec_into(data.qvel(), &mut rates).unwrap();
        rates
    };
    for condim in [3, 4, 6] {
        let (dense, sparse) = (rows(model("dense", condim)), rows(model("sparse", condim)));
        assert_eq!(dense.len(), sparse.len());
        let near = dense.iter().zip(&sparse).all(|(left, right)| (left - right).abs() < 1e-12);
        assert!(near, "condim {condim}: {dense:?} {sparse:?}");
    }
    // The dimension can change after loading.
    let [dense, sparse] = ["dense", "sparse"].map(|jacobian| {
        let mut edited = model(jacobian, 3);
        edited.edit().geom_mut(0).unwrap().set_condim(6).unwrap();
        rows(edited)
    });
    assert!(dense.iter().zip(&sparse).all(|(left, right)| (left - right).abs() < 1e-12), "{dense:?} {sparse:?}");
}
