//! Numerical results.

#[cfg(engine_since = "3.5.0")]
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::derivative::{InverseForce, InverseJacobians};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Matrix, Model, StateSpec, sample, sys};
#[cfg(engine_since = "3.5.0")]
use mujoco_safe::{Differences, Lineariser};

use super::oracle::inertia;
use super::{EPS, assert_near, subjects};

/// Returns forces, sensor values and inertia matrix of the engine's inverse dynamics for a modified
/// copy.
fn inverse_of_changed(data: &Data, change: impl FnOnce(&mut Data)) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut copy = data.clone();
    copy.set_state(StateSpec::INTEGRATION, &data.state(StateSpec::INTEGRATION)).unwrap();
    change(&mut copy);
    let model = copy.model().clone();
    // SAFETY: the data belongs to the model.
    unsafe { sys::mj_inverse(model.as_ptr(), copy.as_mut_ptr()) };
    (copy.qfrc_inverse().to_vec(), copy.sensordata().to_vec(), inertia(&copy).to_vec())
}

/// Returns `(after − before) / eps`, with the operations of the engine.
fn difference(after: &[f64], before: &[f64]) -> Vec<f64> {
    after.iter().zip(before).map(|(after, before)| (after - before) / EPS).collect()
}

#[test]
fn rows_equal_differences_of_the_engines_inverse_dynamics() {
    for mut data in subjects() {
        let original = data.clone();
        let InverseJacobians { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } =
            data.inverse_fd(EPS, InverseForce::Total).unwrap();
        let (force, sensors, inertia) = inverse_of_changed(&original, |_| {});
        let model = original.model().clone();
        for dof in 0..model.nv() {
            let mut direction = vec![0.0; model.nv()];
            direction[dof] = 1.0;
            let (f, s, m) = inverse_of_changed(&original, |data| {
                // SAFETY: the arrays have the model's sizes.
                unsafe { sys::mj_integratePos(model.as_ptr(), data.qpos_mut().as_mut_ptr(), direction.as_ptr(), EPS) };
            });
            // The same operations give the same bits.
            assert_near("DfDq", df_dq.row(dof), &difference(&f, &force), 1e-12);
            assert_near("DsDq", ds_dq.row(dof), &difference(&s, &sensors), 1e-12);
            assert_near("DmDq", dm_dq.row(dof), &difference(&m, &inertia), 1e-12);
            let (f, s, _) = inverse_of_changed(&original, |data| data.qvel_mut()[dof] += EPS);
            assert_near("DfDv", df_dv.row(dof), &difference(&f, &force), 1e-12);
            assert_near("DsDv", ds_dv.row(dof), &difference(&s, &sensors), 1e-12);
            let (f, s, _) = inverse_of_changed(&original, |data| data.qacc_mut()[dof] += EPS);
            assert_near("DfDa", df_da.row(dof), &difference(&f, &force), 1e-12);
            assert_near("DsDa", ds_da.row(dof), &difference(&s, &sensors), 1e-12);
        }
    }
}

#[test]
fn without_constraints_the_derivative_by_acceleration_is_the_inertia_matrix() {
    for mut data in subjects() {
        let disable = DisableFlags::CONSTRAINT;
        data.edit_model(|model| model.edit_options(|options| options.disable = disable)).unwrap();
        let found = data.inverse_fd(1e-3, InverseForce::Total).unwrap().df_da;
        assert_near("DfDa", found.as_slice(), data.full_m().unwrap().as_slice(), 1e-7);
    }
}

/// Returns the full matrix of elements in the storage of the inertia matrix.
fn full_inertia(model: &Model, elements: &[f64]) -> Matrix {
    let nv = model.nv();
    let mut full = Matrix::zeros(nv, nv);
    #[cfg(not(engine_since = "3.10.0"))]
    // SAFETY: the arrays have the model's sizes.
    unsafe {
        sys::mj_fullM(model.as_ptr(), full.as_mut_slice().as_mut_ptr(), elements.as_ptr());
    }
    // The storage is sparse rows of the lower triangle, and the function takes the data.
    #[cfg(engine_since = "3.10.0")]
    for row in 0..nv {
        let start = model.M_rowadr()[row] as usize;
        let range = start..start + model.M_rownnz()[row] as usize;
        for (&column, &element) in model.M_colind()[range.clone()].iter().zip(&elements[range]) {
            let column = column as usize;
            (full[(row, column)], full[(column, row)]) = (element, element);
        }
    }
    full
}

#[test]
fn the_derivative_of_the_inertia_matrix_equals_differences() {
    for mut data in subjects() {
        let dm_dq = data.inverse_fd(EPS, InverseForce::Total).unwrap().dm_dq;
        let (model, nv) = (data.model().clone(), data.model().nv());
        for dof in 0..nv {
            let full = full_inertia(&model, dm_dq.row(dof));
            let at = |sign: f64| {
                let mut copy = data.clone();
                let mut direction = vec![0.0; nv];
                direction[dof] = sign;
                model.integrate_pos(copy.qpos_mut(), &direction, EPS).unwrap();
                copy.forward().unwrap();
                copy.full_m().unwrap()
            };
            let (plus, minus) = (at(1.0), at(-1.0));
            let central: Vec<f64> = plus
                .as_slice()
                .iter()
                .zip(minus.as_slice())
                .map(|(plus, minus)| (plus - minus) / (2.0 * EPS))
                .collect();
            assert_near("M", full.as_slice(), &central, 1e-4);
        }
    }
}

#[test]
fn derivatives_of_a_pendulum_equal_the_formula() {
    // A point mass of 2 kg at the end of a rod of 0.5 m, on a damped hinge with a spring and a
    // position servo.
    let model = Model::from_xml_str(
        r#"<mujoco>
             <option gravity="0 0 -10"/>
             <worldbody>
               <body>
                 <joint name="hinge" axis="0 1 0" damping=".3" stiffness="1.5"/>
                 <inertial pos="0 0 -.5" mass="2" diaginertia="1e-9 1e-9 1e-9"/>
               </body>
             </worldbody>
             <actuator>
               <general joint="hinge" gainprm="5" biastype="affine" biasprm="0 -5 -.2"/>
             </actuator>
             <sensor><jointpos joint="hinge"/><jointvel joint="hinge"/></sensor>
           </mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let (angle, inertia) = (0.7_f64, 2.0 * 0.25);
    data.qpos_mut()[0] = angle;
    data.qvel_mut()[0] = -0.4;
    data.qacc_mut()[0] = 2.0;
    data.ctrl_mut()[0] = 0.1;
    let gravity = 2.0 * 10.0 * 0.5 * angle.cos();
    let cases = [(InverseForce::Total, [0.0, 0.0]), (InverseForce::WithoutActuators, [5.0, 0.2])];
    for (force, servo) in cases {
        let found = data.inverse_fd(EPS, force).unwrap();
        assert_near("DfDq", found.df_dq.as_slice(), &[gravity + 1.5 + servo[0]], 1e-5);
        assert_near("DfDv", found.df_dv.as_slice(), &[0.3 + servo[1]], 1e-7);
        assert_near("DfDa", found.df_da.as_slice(), &[inertia], 1e-7);
        assert_near("DsDq", found.ds_dq.as_slice(), &[1.0, 0.0], 1e-8);
        assert_near("DsDv", found.ds_dv.as_slice(), &[0.0, 1.0], 1e-8);
        assert_near("DsDa", found.ds_da.as_slice(), &[0.0, 0.0], 0.0);
        assert_near("DmDq", found.dm_dq.as_slice(), &[0.0], 1e-8);
    }
    // The data itself has the forces of inverse dynamics, including applied forces.
    let expected = inertia * 2.0 + 2.0 * 10.0 * 0.5 * angle.sin() + 1.5 * angle + 0.3 * -0.4;
    assert_near("force", data.qfrc_inverse(), &[expected], 1e-8);
}

#[test]
fn rows_correspond_to_inputs() {
    // Coriolis forces are not symmetric between an arm that rotates and an arm that slides along
    // it.
    let model = Model::from_xml_str(
        r#"<mujoco>
             <option gravity="0 0 0"/>
             <worldbody>
               <body>
                 <joint axis="0 0 1"/>
                 <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/>
                 <body>
                   <joint type="slide" axis="1 0 0"/>
                   <inertial pos=".5 0 0" mass="2" diaginertia="1e-9 1e-9 1e-9"/>
                 </body>
               </body>
             </worldbody>
           </mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    data.qvel_mut().copy_from_slice(&[3.0, 0.7]);
    // With r = 0.5: moment 2 m r ω ṙ, force −m r ω².
    let found = data.inverse_fd(EPS, InverseForce::Total).unwrap().df_dv;
    let by_turning = [2.0 * 2.0 * 0.5 * 0.7, -2.0 * 2.0 * 0.5 * 3.0];
    let by_sliding = [2.0 * 2.0 * 0.5 * 3.0, 0.0];
    assert_near("by ω", found.row(0), &by_turning, 1e-5);
    assert_near("by ṙ", found.row(1), &by_sliding, 1e-5);
}

/// The derivative of the kinetic energy by velocities is the momentum.
#[cfg(engine_since = "3.5.0")]
#[test]
fn the_derivative_of_the_kinetic_energy_by_velocities_is_the_momentum() {
    let text = r#"<mujoco><worldbody><body><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .3 0 0"/>
        <body pos=".3 0 0"><joint axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .3 0 0"/></body></body></worldbody>
        <sensor><e_kinetic/></sensor></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.qvel_mut().copy_from_slice(&[1.5, -0.7]);
    data.forward().unwrap();
    let mut momentum = [0.0; 2];
    data.mul_m_into(&[1.5, -0.7], &mut momentum).unwrap();
    let options = TransitionOptions::default();
    let (system, _) =
        Lineariser::new(data.model(), options).unwrap().inverse_jacobians(&mut data, InverseForce::Total).unwrap();
    assert_near("a Lineariser", system.ds_dv.as_slice(), &momentum, 1e-5);
    let system = data.inverse_fd(EPS, InverseForce::Total).unwrap();
    assert_near("inverse_fd", system.ds_dv.as_slice(), &momentum, 1e-5);
    // The engine's own differences of a step are zero.
    let system = data.transition_fd(EPS, Differences::Central).unwrap();
    assert_near("transition_fd", &system.c.row(0)[2..], &momentum, 1e-12);
    let limited = Model::from_xml_str(&text.replace("<e_kinetic/>", "<e_kinetic cutoff='1e-6'/>")).unwrap();
    let mut data = Data::new(limited).unwrap();
    data.qvel_mut().copy_from_slice(&[1.5, -0.7]);
    assert_eq!(data.transition_fd(EPS, Differences::Central).unwrap().c.row(0), [0.0; 4]);
}

#[test]
fn derivatives_of_the_cart_pole_equal_a_newer_engine() {
    // Recorded from mjd_inverseFD of the Python module of MuJoCo 3.1.6.
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.qpos_mut().copy_from_slice(&[0.2, 0.7]);
    data.qvel_mut().copy_from_slice(&[0.5, -1.5]);
    data.qacc_mut().copy_from_slice(&[1.0, 2.0]);
    data.ctrl_mut()[0] = 0.3;
    let found = data.inverse_fd(EPS, InverseForce::WithoutActuators).unwrap();
    assert_near("DfDq", found.df_dq.as_slice(), &[0.0, 0.0, -0.451_399_550_627_229_5, -1.222_097_515_407_583], 1e-8);
    assert_near("DfDv", found.df_dv.as_slice(), &[0.050_000_000_58, 0.0, 0.289_897_862_16, 0.049_999_999_918], 1e-8);
    let inertia = [2.000_000_000_28, 0.114_726_328_215_297_71, 0.114_726_327_993_253_11, 0.063_454_431_709_075_72];
    assert_near("DfDa", found.df_da.as_slice(), &inertia, 1e-8);
    // The sparse inertia matrix has another order there, so full matrices are compared.
    let full = full_inertia(data.model(), found.dm_dq.row(1));
    assert_near("DmDq", full.as_slice(), &[0.0, -0.096_632_710_430_699_65, -0.096_632_710_430_699_65, 0.0], 1e-8);
}
