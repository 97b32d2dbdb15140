//! Vectors and matrices of wrong sizes.

use mujoco_safe::derivative::TransitionOutputs;
use mujoco_safe::{
    Controller, Data, Differences, Error, Lqr, LqrWeights, Matrix, Model, PdController, Result, StateSpace, StateSpec,
    Trajectory, sample,
};

use super::text_of;

/// Makes each call once with valid sizes, then with each size wrong in turn.
#[test]
fn a_wrong_size_is_an_error_with_the_expected_size() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let (nq, nv, nu) = (model.nq(), model.nv(), model.nu());
    let body = model.body("torso").unwrap().id();
    let (geom, site_model) = (model.geom(0).unwrap().id(), sample::humanoid());
    let numbers = |length: usize| vec![0.0; length];
    let vectors = |wanted: usize| [0, wanted - 1, wanted + 1];
    let shapes = |(rows, columns): (usize, usize)| [(rows, columns + 1), (rows + 1, columns), (columns, rows), (0, 0)];
    let assert_shape_error = |result: Result<()>, wanted: &str| {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Shape { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(&format!("must have {wanted}")), "{text}");
    };
    drop(site_model);

    model.differentiate_pos_into(1.0, &numbers(nq), &numbers(nq), &mut numbers(nv)).unwrap();
    model.integrate_pos(&mut numbers(nq), &numbers(nv), 1.0).unwrap();
    for wrong in vectors(nv) {
        assert_shape_error(
            model.differentiate_pos_into(1.0, &numbers(nq), &numbers(nq), &mut numbers(wrong)),
            &format!("({nv})"),
        );
        assert_shape_error(model.integrate_pos(&mut numbers(nq), &numbers(wrong), 1.0), &format!("({nv})"));
    }
    for wrong in vectors(nq) {
        assert_shape_error(
            model.differentiate_pos_into(1.0, &numbers(wrong), &numbers(nq), &mut numbers(nv)),
            &format!("({nq})"),
        );
        assert_shape_error(
            model.differentiate_pos_into(1.0, &numbers(nq), &numbers(wrong), &mut numbers(nv)),
            &format!("({nq})"),
        );
        assert_shape_error(model.integrate_pos(&mut numbers(wrong), &numbers(nv), 1.0), &format!("({nq})"));
    }
    for dt in [0.0, f64::NAN, f64::INFINITY] {
        text_of(
            model.differentiate_pos_into(dt, &numbers(nq), &numbers(nq), &mut numbers(nv)),
            &["dt is", "finite and not zero"],
        );
    }
    text_of(model.integrate_pos(&mut numbers(nq), &numbers(nv), f64::NAN), &["dt is NaN"]);

    let full = |shape: (usize, usize)| Matrix::zeros(shape.0, shape.1);
    data.full_m_into(&mut full((nv, nv))).unwrap();
    data.mul_m_into(&numbers(nv), &mut numbers(nv)).unwrap();
    data.solve_m_into(&numbers(nv), &mut numbers(nv)).unwrap();
    data.solve_m_into(&numbers(3 * nv), &mut numbers(3 * nv)).unwrap();
    for wrong in [(nv, nv + 1), (nv + 1, nv), (0, 0), (nv * nv, 1)] {
        assert_shape_error(data.full_m_into(&mut full(wrong)), &format!("({nv}, {nv})"));
    }
    data.full_moment_into(&mut full((nu, nv))).unwrap();
    for wrong in [(nv, nu), (nu, nv + 1), (0, 0)] {
        assert_shape_error(data.full_moment_into(&mut full(wrong)), &format!("({nu}, {nv})"));
    }
    for wrong in vectors(nv) {
        assert_shape_error(data.mul_m_into(&numbers(nv), &mut numbers(wrong)), &format!("({nv})"));
        assert_shape_error(data.mul_m_into(&numbers(wrong), &mut numbers(nv)), &format!("({nv})"));
        assert_shape_error(data.solve_m_into(&numbers(wrong), &mut numbers(nv)), "");
        assert_shape_error(data.solve_m_into(&numbers(nv), &mut numbers(wrong)), &format!("({nv})"));
    }
    assert_shape_error(data.solve_m_into(&numbers(nv), &mut numbers(2 * nv)), &format!("({nv})"));
    assert_shape_error(data.solve_m_into(&numbers(2 * nv + 1), &mut numbers(2 * nv)), "");

    let wanted = (3, nv);
    data.jac_into([0.0; 3], body, Some(&mut full(wanted)), Some(&mut full(wanted))).unwrap();
    for wrong in shapes(wanted) {
        let text = format!("(3, {nv})");
        assert_shape_error(data.jac_into([0.0; 3], body, Some(&mut full(wrong)), None), &text);
        assert_shape_error(data.jac_into([0.0; 3], body, None, Some(&mut full(wrong))), &text);
        assert_shape_error(data.jac_body_into(body, Some(&mut full(wrong)), None), &text);
        assert_shape_error(data.jac_body_com_into(body, None, Some(&mut full(wrong))), &text);
        assert_shape_error(data.jac_geom_into(geom, Some(&mut full(wanted)), Some(&mut full(wrong))), &text);
        assert_shape_error(data.jac_subtree_com_into(body, &mut full(wrong)), &text);
    }

    for spec in [StateSpec::PHYSICS, StateSpec::INTEGRATION, StateSpec::empty()] {
        let size = model.state_size(spec);
        data.state_into(spec, &mut numbers(size)).unwrap();
        for wrong in [size + 1, size.saturating_sub(1)].into_iter().filter(|&wrong| wrong != size) {
            assert_shape_error(data.state_into(spec, &mut numbers(wrong)), &format!("({size})"));
            assert_shape_error(data.set_state(spec, &numbers(wrong)), &format!("({size})"));
        }
    }
    let size = nq + nv;
    for wrong in vectors(size) {
        assert_shape_error(data.physics_state_into(&mut numbers(wrong)), &format!("({size})"));
        assert_shape_error(data.set_physics_state(&numbers(wrong)), &format!("({size})"));
    }

    assert_shape_error(Lqr::with_gain(&data, full((nu, 2 * nv + 1))).map(drop), &format!("({nu}, {})", 2 * nv));
    assert_shape_error(Lqr::with_gain(&data, full((2 * nv, nu))).map(drop), &format!("({nu}, {})", 2 * nv));
    let mut other = Data::new(sample::cartpole()).unwrap();
    assert_shape_error(Lqr::with_gain(&data, full((nu, 2 * nv))).unwrap().control(&mut other), "");
    assert_shape_error(PdController::new(&model, 1.0, 1.0).control(&mut other), "");
    assert_shape_error(Trajectory::new(&model).push(&other), "");
}

#[test]
fn a_wrong_shape_of_a_linearisation_is_an_error() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
           <actuator><motor joint="j"/><general joint="j" dyntype="filter"/></actuator>
           <sensor><jointpos joint="j"/><jointvel joint="j"/><jointpos joint="j"/><jointpos joint="j"/></sensor></mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let good = data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!([&good.a, &good.b, &good.c, &good.d].map(|matrix| matrix.shape()), [(3, 3), (3, 2), (4, 3), (4, 2)]);
    let fields: [fn(&mut StateSpace) -> &mut Matrix; 4] =
        [|it| &mut it.a, |it| &mut it.b, |it| &mut it.c, |it| &mut it.d];
    for (field, name) in fields.into_iter().zip(["A of", "B of", "C of", "D of"]) {
        let (rows, columns) = field(&mut good.clone()).shape();
        for wrong in [(rows + 1, columns), (rows, columns + 1), (0, 0), (rows * columns, 1)] {
            let mut system = good.clone();
            *field(&mut system) = Matrix::zeros(wrong.0, wrong.1);
            let result = data.transition_fd_into(1e-6, Differences::Central, &mut system);
            text_of(result, &[name, "transition_fd", &format!("must have ({rows}, {columns})")]);
        }
    }
    for eps in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        text_of(data.transition_fd(eps, Differences::Forward), &["eps", "between 1e-12 and 1"]);
    }
    data.transition_fd_into(1e-6, Differences::Forward, TransitionOutputs::default()).unwrap();
}

#[test]
fn weights_of_wrong_shapes_are_errors() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let good = || LqrWeights::new(Matrix::identity(4), Matrix::identity(1));
    Lqr::at_present_state(&mut data, &good()).unwrap();
    for wrong in [
        LqrWeights { q: Matrix::identity(3), ..good() },
        LqrWeights { r: Matrix::identity(2), ..good() },
        LqrWeights { s: Some(Matrix::zeros(1, 4)), ..good() },
        LqrWeights { r: Matrix::from_diagonal(&[-1.0]), ..good() },
        LqrWeights { q: Matrix::from_row_major(4, 4, vec![f64::NAN; 16]), ..good() },
    ] {
        text_of(Lqr::at_present_state(&mut data, &wrong), &["there is no regulator"]);
    }
}
