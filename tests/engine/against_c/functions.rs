//! Functions of a state: Jacobians, the inertia matrix, differences of positions, contacts,
//! linearisations.

use std::sync::Arc;

use mujoco_safe::data::Jacobian;
use mujoco_safe::derivative::TransitionOutputs;
use mujoco_safe::enums::{Integrator, Solver};
use mujoco_safe::id::BodyId;
use mujoco_safe::{Differences, Error, Matrix, Model, StateSpace, StateSpec};

use crate::twins::{Subject, Twins, assert_same, c, differing, read, small_subjects, usual_subjects};

/// Returns every element of a small model, and some elements of a large one.
fn chosen<T>(elements: impl ExactSizeIterator<Item = T>) -> impl Iterator<Item = T> {
    let stride = elements.len().div_ceil(40).max(1);
    elements.step_by(stride)
}

/// Returns the engine's pair of Jacobians.
fn pair(nv: usize, call: impl FnOnce(*mut f64, *mut f64)) -> (Vec<f64>, Vec<f64>) {
    let (mut jacp, mut jacr) = (vec![0.0; 3 * nv], vec![0.0; 3 * nv]);
    call(jacp.as_mut_ptr(), jacr.as_mut_ptr());
    (jacp, jacr)
}

fn assert_same_pair(what: &str, ours: &Jacobian, (jacp, jacr): &(Vec<f64>, Vec<f64>)) {
    assert_same(what, ours.linear.as_slice(), jacp);
    assert_same(what, ours.angular.as_slice(), jacr);
}

#[test]
fn jacobians_equal_c() {
    for subject in usual_subjects() {
        let twins = Twins::in_motion(subject);
        let (model, ours, m, d) = (&twins.model, &twins.ours, twins.raw.m(), twins.raw.d);
        let nv = model.nv();
        for body in chosen(model.bodies()) {
            let (what, id) = (format!("{}, {body:?}", twins.name), body.index() as i32);
            let theirs = pair(nv, |jacp, jacr| c!(mj_jacBody(m, d, jacp, jacr, id)));
            assert_same_pair(&what, &ours.jac_body(body).unwrap(), &theirs);
            let theirs = pair(nv, |jacp, jacr| c!(mj_jacBodyCom(m, d, jacp, jacr, id)));
            assert_same_pair(&what, &ours.jac_body_com(body).unwrap(), &theirs);
            let point = [0.1 * f64::from(id), -0.2, 0.3];
            let theirs = pair(nv, |jacp, jacr| c!(mj_jac(m, d, jacp, jacr, point.as_ptr(), id)));
            assert_same_pair(&what, &ours.jac(point, body).unwrap(), &theirs);
        }
        for geom in chosen(model.geoms()) {
            let theirs = pair(nv, |jacp, jacr| c!(mj_jacGeom(m, d, jacp, jacr, geom.index() as i32)));
            assert_same_pair(&format!("{geom:?}"), &ours.jac_geom(geom).unwrap(), &theirs);
        }
        for site in chosen(model.sites()) {
            let theirs = pair(nv, |jacp, jacr| c!(mj_jacSite(m, d, jacp, jacr, site.index() as i32)));
            assert_same_pair(&format!("{site:?}"), &ours.jac_site(site).unwrap(), &theirs);
        }
    }
}

#[test]
fn jacobians_of_subtrees_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let bodies: Vec<BodyId> = chosen(twins.model.bodies()).map(|body| body.id()).collect();
        for body in bodies {
            let mut theirs = vec![0.0; 3 * twins.model.nv()];
            c!(mj_jacSubtreeCom(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), body.index() as i32));
            let ours = twins.ours.jac_subtree_com(body).unwrap();
            assert_same(&format!("{}, {body:?}", twins.name), ours.as_slice(), &theirs);
        }
    }
}

#[test]
fn a_single_jacobian_equals_that_of_the_pair() {
    for subject in small_subjects() {
        let twins = Twins::in_motion(subject);
        for body in twins.model.bodies() {
            let both = twins.ours.jac_body(body).unwrap();
            let (mut translation, mut rotation) =
                (Matrix::zeros(3, twins.model.nv()), Matrix::zeros(3, twins.model.nv()));
            twins.ours.jac_body_into(body, Some(&mut translation), None).unwrap();
            twins.ours.jac_body_into(body, None, Some(&mut rotation)).unwrap();
            assert_eq!((translation, rotation), (both.linear, both.angular), "{}, {body:?}", twins.name);
        }
    }
}

#[test]
fn the_moments_of_all_actuators_equal_c() {
    for subject in usual_subjects() {
        let twins = Twins::in_motion(subject);
        let (nu, nv) = (twins.model.nu(), twins.model.nv());
        // Values from before the call do not remain.
        let mut ours = Matrix::zeros(nu, nv);
        ours.as_mut_slice().fill(f64::NAN);
        twins.ours.full_moment_into(&mut ours).unwrap();
        // SAFETY: the model is valid, and the actuators are its own.
        let row = |i| unsafe { differing::actuator_moment(&*twins.raw.m(), twins.raw.data(), i) };
        let theirs: Vec<f64> = (0..nu).flat_map(row).collect();
        assert_same(&twins.name, ours.as_slice(), &theirs);
        assert_eq!(twins.ours.full_moment().unwrap(), ours, "{}", twins.name);
    }
}

#[test]
fn the_inertia_matrix_equals_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let nv = twins.model.nv();
        let mut theirs = vec![0.0; nv * nv];
        // SAFETY: the model and data of one pair of twins.
        unsafe { differing::full_m(twins.raw.m(), twins.raw.d, &mut theirs) };
        assert_same(&twins.name, twins.ours.full_m().unwrap().as_slice(), &theirs);

        let vector = twins.numbers(nv);
        let (mut ours, mut theirs) = (vec![0.0; nv], vec![0.0; nv]);
        twins.ours.mul_m_into(&vector, &mut ours).unwrap();
        c!(mj_mulM(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), vector.as_ptr()));
        assert_same(&twins.name, &ours, &theirs);

        let vectors = twins.numbers(3 * nv);
        let (mut ours, mut theirs) = (vec![0.0; 3 * nv], vec![0.0; 3 * nv]);
        twins.ours.solve_m_into(&vectors, &mut ours).unwrap();
        c!(mj_solveM(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), vectors.as_ptr(), 3));
        assert_same(&twins.name, &ours, &theirs);
    }
}

#[test]
fn differences_and_sums_of_positions_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let (nq, nv) = (twins.model.nq(), twins.model.nv());
        let (velocity, from) = (twins.numbers(nv), twins.model.qpos0().to_vec());
        let mut to = twins.ours.qpos().to_vec();
        let mut theirs = to.clone();
        assert_eq!(to.len(), nq);
        twins.model.integrate_pos(&mut to, &velocity, 0.7).unwrap();
        c!(mj_integratePos(twins.raw.m(), theirs.as_mut_ptr(), velocity.as_ptr(), 0.7));
        assert_same(&twins.name, &to, &theirs);

        let (mut ours, mut theirs) = (vec![0.0; nv], vec![0.0; nv]);
        twins.model.differentiate_pos_into(0.3, &from, &to, &mut ours).unwrap();
        c!(mj_differentiatePos(twins.raw.m(), theirs.as_mut_ptr(), 0.3, from.as_ptr(), to.as_ptr()));
        assert_same(&twins.name, &ours, &theirs);
    }
}

#[test]
fn contacts_and_their_forces_equal_c() {
    let mut seen = 0;
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        // Long enough for the humanoids to reach the ground.
        if twins.model.nv() < 100 {
            for _ in 0..100 {
                twins.step();
            }
            twins.forward();
        }
        let raw = twins.raw.data();
        assert_eq!(twins.ours.contacts().len(), raw.ncon as usize, "{}", twins.name);
        for (index, contact) in twins.ours.contacts().enumerate() {
            // SAFETY: the engine's array has `ncon` contacts.
            let theirs = unsafe { *raw.contact.add(index) };
            let what = format!("{}, contact {index}", twins.name);
            assert_eq!(contact.index(), index);
            assert_same(&what, &[contact.dist()], &[theirs.dist]);
            assert_same(&what, contact.pos(), &theirs.pos);
            assert_same(&what, contact.frame(), &theirs.frame);
            assert_same(&what, contact.normal(), &theirs.frame[..3]);
            assert_same(&what, contact.friction(), &theirs.friction);
            assert_eq!(
                contact.geoms().unwrap().map(|geom| geom.index() as i32),
                [theirs.geom1, theirs.geom2],
                "{what}"
            );
            assert_eq!(contact.dim() as i32, theirs.dim, "{what}");
            assert_eq!(contact.is_active(), theirs.efc_address >= 0, "{what}");
            let mut wrench = [0.0; 6];
            c!(mj_contactForce(twins.raw.m(), twins.raw.d, index as i32, wrench.as_mut_ptr()));
            let ours = contact.force().unwrap();
            assert_same(&what, &ours.force, &wrench[..3]);
            assert_same(&what, &ours.torque, &wrench[3..]);

            let mut world = [0.0; 3];
            c!(mju_mulMatTVec(world.as_mut_ptr(), theirs.frame.as_ptr(), wrench.as_ptr(), 3, 3));
            for (ours, theirs) in contact.force_in_world().unwrap().iter().zip(world) {
                assert!((ours - theirs).abs() <= 1e-12 * (1.0 + theirs.abs()), "{what}: {ours} and {theirs}");
            }
            seen += 1;
        }
    }
    assert!(seen > 0, "no model has contacts");
}

#[test]
fn linearisations_equal_c() {
    for subject in small_subjects() {
        // The library tightens a looser tolerance for differences.
        let mut model = Model::clone(&subject.model);
        let tolerance = if model.options().solver == Solver::Newton { 1e-15 } else { 0.0 };
        model.edit().edit_options(|options| options.tolerance = tolerance).unwrap();
        // Before 4.0 it corrects columns of controls and activations.
        let corrects = cfg!(not(engine_since = "4.0.0")) && model.options().integrator == Integrator::Implicit;
        let subject = Subject { name: subject.name.clone(), model: Arc::new(model) };
        for (differences, central) in [(Differences::Forward, 0), (Differences::Central, 1)] {
            let mut twins = Twins::in_motion(&subject);
            let (nx, nu, ny) = (2 * twins.model.nv() + twins.model.na(), twins.model.nu(), twins.model.nsensordata());
            let before = twins.ours.state(StateSpec::INTEGRATION);
            let ours = match twins.ours.transition_fd(1e-6, differences) {
                // C would exit: the stack of some of the engine's models is too small.
                Err(Error::Engine { message, .. }) if message == "Stack overflow" => {
                    println!("skipped {}, whose nstack is too small for transition_fd", twins.name);
                    break;
                }
                result => result.unwrap_or_else(|error| panic!("{}: {error}", twins.name)),
            };
            let mut theirs = [nx * nx, nx * nu, ny * nx, ny * nu].map(|length| vec![0.0; length]);
            // The engine omits a matrix whose pointer is NULL, so empty matrices cannot be
            // requested.
            let [a, b, c, d] = theirs
                .each_mut()
                .map(|matrix| if matrix.is_empty() { std::ptr::null_mut() } else { matrix.as_mut_ptr() });
            c!(mjd_transitionFD(twins.raw.m(), twins.raw.d, 1e-6, central, a, b, c, d));

            // Before 4.0 the engine's central differences of the sensors by the controls have the
            // wrong sign.
            if differences == Differences::Central && cfg!(not(engine_since = "4.0.0")) {
                theirs[3].iter_mut().for_each(|value| *value = 0.0 - *value);
            }
            let StateSpace { a, b, c, d } = &ours;
            for (what, ours, theirs, shape) in [
                ("A", a, &theirs[0], (nx, nx)),
                ("B", b, &theirs[1], (nx, nu)),
                ("C", c, &theirs[2], (ny, nx)),
                ("D", d, &theirs[3], (ny, nu)),
            ] {
                assert_eq!(ours.shape(), shape, "{what} of {}", twins.name);
                let columns = match what {
                    "B" | "D" if corrects => 0,
                    _ if corrects => 2 * twins.model.nv(),
                    _ => shape.1,
                };
                let kept = |values: &[f64]| -> Vec<f64> {
                    values.chunks_exact(shape.1.max(1)).flat_map(|row| row[..columns].to_vec()).collect()
                };
                let what = format!("{what} of {} by {differences:?}", twins.name);
                assert_same(&what, &kept(ours.as_slice()), &kept(theirs));
            }
            // In C only the time has changed.
            assert_same("the state is unchanged", &twins.ours.state(StateSpec::INTEGRATION), &before);
            // SAFETY: the data belongs to the twins, and nothing else uses it.
            unsafe { (*twins.raw.d).time = twins.ours.time() };
            twins.assert_same_state("after linearisation");

            // A matrix computed alone is the same.
            let mut alone = Matrix::zeros(nx, nu);
            let outputs = TransitionOutputs { b: Some(&mut alone), ..Default::default() };
            let mut again = Twins::in_motion(&subject);
            again.ours.transition_fd_into(1e-6, differences, outputs).unwrap();
            assert_same(&format!("B alone of {}", twins.name), alone.as_slice(), b.as_slice());
        }
    }
}

#[test]
fn the_constraint_jacobian_equals_c() {
    for subject in small_subjects() {
        let twins = Twins::in_motion(subject);
        // Dense rows, because these models are small.
        if c!(mj_isSparse(twins.raw.m())) == 0 {
            let count = twins.ours.nefc() * twins.model.nv();
            // SAFETY: the engine's array has nefc dense rows of nv numbers.
            let theirs = unsafe { read(twins.raw.data().efc_J, 0, count) };
            assert_same(&twins.name, twins.ours.efc_J(), &theirs);
        }
    }
}
