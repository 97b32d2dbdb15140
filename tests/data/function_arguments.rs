//! Arguments of functions of the state: one wrong size at a time, invalid sparse rows, keys of
//! elements, and ids of another model.
#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};

use mujoco_safe::data::{Accelerations, Axes, ConeHessian, FrameId, RayOptions};
use mujoco_safe::enums::{JacobianStorage, Solver};
use mujoco_safe::model::{DisableFlags, LengthRangeMode, LengthRangeOptions, ModelMut};
use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Error, InvalidKind, Matrix, Model, Result, sample};

use crate::child;

fn in_contact() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    assert!(data.nefc() > 0);
    data
}

#[track_caller]
fn is_shape(result: Result<()>, name: &str) {
    match result {
        Err(Error::Shape { what, .. }) => assert!(what.contains(name), "{what} and not {name}"),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn vectors_of_a_wrong_length_are_errors() {
    let mut data = in_contact();
    let (nv, nefc) = (data.model().nv(), data.nefc());
    let (mut dofs, mut rows) = (vec![0.0; nv], vec![0.0; nefc]);
    let (source, forces) = (dofs.clone(), rows.clone());
    let body = data.model().bodies().last().unwrap().id();
    for wrong in [0, 1, nv - 1, nv + 1, 3 * nv] {
        let mut mismatched = vec![0.0; wrong];
        let mismatched_source = mismatched.clone();
        is_shape(data.mul_m2_into(&source, &mut mismatched), "the result of mul_m2_into");
        is_shape(data.mul_m2_into(&mismatched_source, &mut dofs), "the vector of mul_m2_into");
        is_shape(data.solve_m2_into(&source, &mut mismatched), "the result of solve_m2_into");
        is_shape(data.rne_into(Accelerations::Present, &mut mismatched), "the result of rne_into");
        is_shape(data.apply_ft([0.0; 3], [0.0; 3], [0.0; 3], body, &mut mismatched), "qfrc_target of apply_ft");
        is_shape(data.mul_jac_vec_into(&mismatched_source, &mut rows), "the vector of mul_jac_vec_into");
        is_shape(data.mul_jac_t_vec_into(&forces, &mut mismatched), "the result of mul_jac_t_vec_into");
    }
    for wrong in [1, nv - 1, nv + 1] {
        is_shape(data.solve_m2_into(&vec![0.0; wrong], &mut vec![0.0; wrong]), "the vector of solve_m2_into");
    }
    for wrong in [0, nefc - 1, nefc + 1] {
        let mut mismatched = vec![0.0; wrong];
        let mismatched_source = mismatched.clone();
        is_shape(data.mul_jac_vec_into(&source, &mut mismatched), "the result of mul_jac_vec_into");
        is_shape(data.mul_jac_t_vec_into(&mismatched_source, &mut dofs), "the vector of mul_jac_t_vec_into");
        is_shape(
            data.constraint_update(&mismatched_source, ConeHessian::Compute).map(drop),
            "jar of constraint_update",
        );
    }
    let mut qpos = vec![0.0; data.model().nq() + 1];
    is_shape(data.model().normalize_quat(&mut qpos), "qpos of normalize_quat");
    is_shape(data.model().normalize_quat(&mut qpos[2..]), "qpos of normalize_quat");
}

#[test]
fn matrices_of_a_wrong_shape_are_errors() {
    let mut data = in_contact();
    let nv = data.model().nv();
    let body = data.model().bodies().last().unwrap().id();
    for (rows, columns) in [(3, nv + 1), (3, nv - 1), (2, nv), (nv, 3), (1, 3 * nv)] {
        let mut mismatched = Matrix::zeros(rows, columns);
        is_shape(data.angmom_mat_into(body, &mut mismatched), "the matrix of angmom_mat");
        is_shape(data.jac_point_axis_into([0.0; 3], [0.0; 3], body, Some(&mut mismatched), None), "jac_point");
        is_shape(data.jac_point_axis_into([0.0; 3], [0.0; 3], body, None, Some(&mut mismatched)), "jac_axis");
    }
    for (rows, columns) in [(nv, nv + 1), (nv + 1, nv), (1, nv * nv), (nv - 1, nv - 1)] {
        is_shape(data.add_m(&mut Matrix::zeros(rows, columns)), "the sum of add_m");
    }
}

#[test]
fn each_jacobian_of_point_and_axis_is_optional() {
    let mut data = in_contact();
    let nv = data.model().nv();
    let body = data.model().bodies().last().unwrap().id();
    let [point, axis] = data.jac_point_axis([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], body).unwrap();
    let mut alone = Matrix::zeros(3, nv);
    data.jac_point_axis_into([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], body, Some(&mut alone), None).unwrap();
    assert_eq!(alone, point);
    data.jac_point_axis_into([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], body, None, Some(&mut alone)).unwrap();
    assert_eq!(alone, axis);
    data.jac_point_axis_into([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], body, None, None).unwrap();
}

/// A change that invalidates the rows.
type Change<'a> = &'a dyn Fn(&mut Rows);

/// A call that must panic.
type Call = Box<dyn FnMut(&mut Data)>;

/// A sparse matrix with one row per degree of freedom.
#[derive(Clone)]
struct Rows {
    values: Vec<f64>,
    rownnz: Vec<i32>,
    rowadr: Vec<i32>,
    colind: Vec<i32>,
}

impl Rows {
    fn add(mut self, data: &mut Data) -> Result<()> {
        data.add_m_sparse(&mut self.values, &mut self.rownnz, &self.rowadr, &mut self.colind)
    }
}

#[test]
fn sparse_rows_out_of_bounds_are_errors() {
    let mut data = in_contact();
    let nv = data.model().nv();
    let good = Rows {
        values: vec![0.0; nv * nv],
        rownnz: vec![1; nv],
        rowadr: (0..nv).map(|row| (row * nv) as i32).collect(),
        colind: (0..nv * nv).map(|at| (at / nv) as i32).collect(),
    };
    good.clone().add(&mut data).unwrap();
    let changed = |change: Change<'_>| {
        let mut rows = good.clone();
        change(&mut rows);
        rows
    };
    is_shape(changed(&|rows| rows.rownnz.truncate(rows.rownnz.len() - 1)).add(&mut data), "rownnz of add_m_sparse");
    is_shape(changed(&|rows| rows.rownnz.push(0)).add(&mut data), "rownnz of add_m_sparse");
    is_shape(changed(&|rows| rows.rowadr.truncate(rows.rowadr.len() - 1)).add(&mut data), "rowadr of add_m_sparse");
    is_shape(changed(&|rows| rows.colind.truncate(rows.colind.len() - 1)).add(&mut data), "colind of add_m_sparse");
    is_shape(changed(&|rows| rows.values.truncate(rows.values.len() - 1)).add(&mut data), "colind of add_m_sparse");
    let last = nv - 1;
    let invalid: &[(&str, Change<'_>)] = &[
        ("negative count", &|rows| rows.rownnz[3] = -1),
        ("negative address", &|rows| rows.rowadr[3] = -1),
        ("huge count", &|rows| rows.rownnz[last] = i32::MAX),
        ("huge address", &|rows| rows.rowadr[last] = i32::MAX),
        ("two rows at one address", &|rows| rows.rowadr[4] = rows.rowadr[3]),
        ("rows in the wrong order", &|rows| rows.rowadr.swap(3, 4)),
        ("a row that overlaps the next", &|rows| rows.rowadr[4] = rows.rowadr[3] + 1),
        ("a last row beyond the end", &|rows| rows.rowadr[last] = (nv * nv) as i32 - 1),
        ("a column out of range", &|rows| rows.colind[3 * nv] = nv as i32),
        ("a negative column", &|rows| rows.colind[3 * nv] = -1),
        ("a duplicate column", &|rows| rows.rownnz[3] = 2),
    ];
    for (what, change) in invalid {
        let error = changed(change).add(&mut data).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{what}: {error}");
    }
    data.forward().expect("the data is unchanged");
}

#[test]
fn accelerations_of_an_earlier_state_are_not_returned() {
    let mut data = in_contact();
    let torso = FrameId::Body(data.model().body("torso").unwrap().id());
    let acceleration = |data: &Data| data.object_acceleration(torso, Axes::World);
    let error = acceleration(&data).unwrap_err();
    assert!(error.to_string().contains("object_acceleration needs the results of rne_post_constraint"), "{error}");
    data.rne_post_constraint().unwrap();
    acceleration(&data).unwrap();
    data.forward().unwrap();
    assert!(matches!(acceleration(&data), Err(Error::NotComputed { .. })));
    data.step1().unwrap();
    assert!(matches!(data.rne_post_constraint(), Err(Error::NotComputed { .. })));
    data.reset().unwrap();
    assert!(matches!(data.object_velocity(torso, Axes::World), Err(Error::NotComputed { .. })));
}

#[test]
fn ids_of_another_model_panic() {
    let mut data = in_contact();
    let other = sample::humanoid();
    let body = other.bodies().last().unwrap().id();
    let site = Model::from_xml_str("<mujoco><worldbody><site/></worldbody></mujoco>").unwrap();
    let site = FrameId::Site(site.sites().next().unwrap().id());
    let mut matrix = Matrix::zeros(3, data.model().nv());
    let mut dofs = vec![0.0; data.model().nv()];
    let mut calls: Vec<(&str, Call)> = vec![
        ("angmom_mat", Box::new(move |data| drop(data.angmom_mat_into(body, &mut matrix)))),
        ("jac_point_axis", Box::new(move |data| drop(data.jac_point_axis([0.0; 3], [0.0; 3], body)))),
        ("object_velocity", Box::new(move |data| drop(data.object_velocity(FrameId::Body(body), Axes::World)))),
        ("object_velocity", Box::new(move |data| drop(data.object_velocity(site, Axes::World)))),
        ("object_acceleration", Box::new(move |data| drop(data.object_acceleration(site, Axes::Local)))),
        ("apply_ft", Box::new(move |data| drop(data.apply_ft([0.0; 3], [0.0; 3], [0.0; 3], body, &mut dofs)))),
        ("local_to_global", Box::new(move |data| drop(data.local_to_global([0.0; 3], [0.0; 4], body)))),
    ];
    for (name, call) in &mut calls {
        assert!(catch_unwind(AssertUnwindSafe(|| call(&mut data))).is_err(), "{name}");
    }
}

#[test]
fn a_length_range_that_does_not_converge_is_an_error() {
    // The engine's compiler does not return for such a muscle. Without one, the length range is
    // computed on request.
    let xml = r#"<mujoco>
        <option timestep="0.1"/>
        <worldbody><body>
          <joint name="hinge" stiffness="1e7"/><geom size=".1" pos=".1 0 0"/>
        </body></worldbody>
        <actuator><motor name="motor" joint="hinge"/></actuator>
      </mujoco>"#;
    let mut model = Model::from_xml_str(xml).unwrap();
    let motor = model.actuator("motor").unwrap().id();
    let all = LengthRangeOptions::default().with_mode(LengthRangeMode::All);
    let before = model.actuator_lengthrange().to_vec();
    let error = model.edit().set_length_range(motor, &all).unwrap_err();
    assert!(matches!(error, Error::Unstable(_) | Error::Unsupported(_)), "{error}");
    assert_eq!(model.actuator_lengthrange(), before);

    assert_eq!(model.edit().set_length_range(motor, &LengthRangeOptions::default()).unwrap(), [0.0; 2], "no muscle");
    for invalid in [
        all.with_inttotal(f64::INFINITY),
        all.with_inttotal(1e9),
        all.with_inttotal(0.0),
        all.with_inteval(11.0),
        all.with_inteval(f64::NAN),
        all.with_accel(0.0),
        all.with_maxforce(-1.0),
        all.with_timeconst(f64::NAN),
        all.with_tolrange(-1.0),
    ] {
        let error = model.edit().set_length_range(motor, &invalid).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{invalid:?}: {error}");
    }
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(model.edit().set_total_mass(mass), Err(Error::Invalid { .. })), "{mass}");
    }
}

#[test]
fn print_to_writes_every_quantity() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let folder = std::env::temp_dir().join(format!("print_to_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("humanoid.txt");
    assert!(matches!(data.print_to(&path), Err(Error::NotComputed { call: "print_to", .. })));
    assert!(!path.exists());
    data.forward().unwrap();
    data.print_to(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("QPOS") && text.contains("CFRC_EXT"), "the first and the last quantity");
    assert!(matches!(data.print_to(folder.join("missing").join("humanoid.txt")), Err(Error::File { .. })));
    assert!(matches!(data.print_to("a\0b"), Err(Error::Invalid { .. })));
    std::fs::remove_dir_all(&folder).unwrap();
}

/// MuJoCo 3.0 to 3.12 reads a null pointer in this case, 3.17 does not.
#[test]
fn print_to_writes_tendons_while_constraints_are_disabled() {
    if !child::is_child() {
        return child::passes("function_arguments::print_to_writes_tendons_while_constraints_are_disabled");
    }
    let mut model = Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
             <tendon><fixed><joint joint="j" coef="1"/></fixed></tendon></mujoco>"#,
    )
    .unwrap();
    model.edit().edit_options(|options| options.disable = DisableFlags::CONSTRAINT).unwrap();
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    let file = tempfile::NamedTempFile::new().unwrap();
    for _ in 0..2 {
        data.print_to(file.path()).unwrap();
        assert!(std::fs::read_to_string(file.path()).unwrap().contains("TEN_LENGTH"));
    }
}

/// Inverse dynamics of engines from 3.0 does not compute the matrix of the dual solver, which they
/// print through a null pointer.
#[test]
fn print_to_succeeds_after_inverse_dynamics_with_the_dual_solver() {
    if !child::is_child() {
        return child::passes("function_arguments::print_to_succeeds_after_inverse_dynamics_with_the_dual_solver");
    }
    let mut data = in_contact();
    let sparse_dual = |model: &mut ModelMut<'_>| {
        model.edit_options(|options| (options.solver, options.jacobian) = (Solver::Pgs, JacobianStorage::Sparse))
    };
    data.edit_model(sparse_dual).unwrap();
    data.inverse().unwrap();
    assert!(data.nefc() > 0);
    let file = tempfile::NamedTempFile::new().unwrap();
    data.print_to(file.path()).unwrap();
    assert!(std::fs::read_to_string(file.path()).unwrap().contains("CFRC_EXT"));
}

#[test]
fn set_keyframe_changes_the_model_of_one_simulation_only() {
    let model = std::sync::Arc::new(sample::humanoid());
    let mut data = Data::new(model.clone()).unwrap();
    for _ in 0..10 {
        data.step().unwrap();
    }
    data.forward().unwrap();
    let stage = data.stage();
    data.set_keyframe(0).unwrap();
    assert_eq!(data.stage(), stage);
    let saved = (data.time(), data.physics_state());
    data.reset_to_key(0).unwrap();
    assert_eq!((data.time(), data.physics_state()), saved);
    let mut other = Data::new(model).unwrap();
    other.reset_to_key(0).unwrap();
    assert_ne!(other.physics_state(), saved.1, "the shared model is unchanged");
    assert!(matches!(data.set_keyframe("handstand"), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.set_keyframe(99), Err(Error::NoSuchIndex { .. })));
}

#[test]
fn models_without_degrees_of_freedom_work_in_every_call() {
    for xml in ["<mujoco/>", "<mujoco><worldbody><geom size='1'/><body><geom size='1'/></body></worldbody></mujoco>"] {
        let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
        let world = data.model().bodies().next().unwrap().id();
        for parts in [
            [Data::kinematics, Data::com_pos, Data::camlight, Data::compute_tendon, Data::compute_crb, Data::factor_m],
            [
                Data::collision,
                Data::make_constraint,
                Data::transmission,
                Data::project_constraint,
                Data::compute_ten_velocity,
                Data::compute_actuator_velocity,
            ],
            [
                Data::com_vel,
                Data::passive,
                Data::reference_constraint,
                Data::compute_qfrc_bias,
                Data::fwd_actuation,
                Data::fwd_acceleration,
            ],
            [
                Data::fwd_constraint,
                Data::subtree_vel,
                Data::rne_post_constraint,
                Data::compare_fwd_inv,
                Data::sensor_acc,
                Data::energy_vel,
            ],
        ] {
            for part in parts {
                part(&mut data).unwrap();
            }
        }
        data.object_acceleration(FrameId::BodyInertia(world), Axes::World).unwrap();
        data.mul_m2_into(&[], &mut []).unwrap();
        data.solve_m2_into(&[], &mut []).unwrap();
        data.rne_into(Accelerations::Present, &mut []).unwrap();
        data.mul_jac_vec_into(&[], &mut []).unwrap();
        data.mul_jac_t_vec_into(&[], &mut []).unwrap();
        assert_eq!(data.constraint_update(&[], ConeHessian::Compute).unwrap(), 0.0);
        data.add_m(&mut Matrix::zeros(0, 0)).unwrap();
        data.add_m_sparse(&mut [], &mut [], &[], &mut []).unwrap();
        assert_eq!(data.angmom_mat(world).unwrap().shape(), (3, 0));
        assert_eq!(data.jac_point_axis([0.0; 3], [1.0; 3], world).unwrap()[0].shape(), (3, 0));
        data.apply_ft([1.0; 3], [1.0; 3], [0.0; 3], world, &mut []).unwrap();
        data.object_velocity(FrameId::Body(world), Axes::Local).unwrap();
        data.local_to_global([1.0; 3], [1.0, 0.0, 0.0, 0.0], world).unwrap();
        data.ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], &mujoco_safe::data::RayOptions::default()).unwrap();
        data.euler().unwrap();
        assert!(data.model().total_mass() >= 0.0);
    }
}

#[test]
fn names_indices_ids_and_views_select_the_same_element() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let foot = model.body("foot_left").unwrap();
    let expected = data.jac_body_com(foot.id()).unwrap();
    assert_eq!(data.jac_body_com("foot_left").unwrap(), expected);
    assert_eq!(data.jac_body_com(foot.index()).unwrap(), expected);
    assert_eq!(data.jac_body_com(foot).unwrap(), expected);

    let count = model.nbody();
    assert!(matches!(data.jac([0.0; 3], "foot"), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.jac_point_axis([0.0; 3], [0.0; 3], count), Err(Error::NoSuchIndex { .. })));
    assert!(matches!(data.angmom_mat("foot"), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.local_to_global([0.0; 3], [0.0; 4], count), Err(Error::NoSuchIndex { .. })));
    assert!(matches!(data.geom_distance("floor", "foot", 1.0), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.ray_mesh("foot", [0.0; 3], [1.0; 3]), Err(Error::NoSuchName { .. })));
    let mut target = vec![0.0; model.nv()];
    assert!(matches!(data.apply_ft([0.0; 3], [0.0; 3], [0.0; 3], "foot", &mut target), Err(Error::NoSuchName { .. })));
    let mut own = sample::humanoid();
    assert!(matches!(
        own.edit().set_length_range("foot", &LengthRangeOptions::default()),
        Err(Error::NoSuchName { .. })
    ));
}

#[test]
fn programs_can_match_the_kind_of_an_invalid_value() {
    let model = sample::humanoid();
    let mut data = Data::new(model.clone()).unwrap();
    data.forward().unwrap();
    let kind = |error: Error| match error {
        Error::Invalid { kind, .. } => kind,
        other => panic!("{other}"),
    };
    let (above, down) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let options = RayOptions::default();
    assert_eq!(kind(data.ray([f64::NAN; 3], down, &options).unwrap_err()), InvalidKind::NotFinite);
    assert_eq!(kind(data.ray(above, [0.0; 3], &options).unwrap_err()), InvalidKind::OutOfRange);
    assert_eq!(kind(data.ray_mesh("floor", above, down).unwrap_err()), InvalidKind::Unsuitable);
    assert_eq!(kind(model.print_to("a\0b").unwrap_err()), InvalidKind::Text);

    let mut spec = Spec::new("");
    let world = spec.world();
    assert_eq!(kind(spec.add_geom(world).set("rgb", 1.0).map(drop).unwrap_err()), InvalidKind::Unknown);
    assert_eq!(kind(spec.remove(world).unwrap_err()), InvalidKind::Unsuitable);

    let gravity = |parameters: Parameters| {
        parameters.with(&model, Parameter::Gravity(2), Distribution::Uniform { low: -10.0, high: -9.0 })
    };
    let twice = gravity(Parameters::new()).and_then(gravity);
    assert_eq!(kind(twice.map(drop).unwrap_err()), InvalidKind::Duplicate);
}
