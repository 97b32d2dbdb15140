//! Extreme numbers in every writable array: a step may return an error, but must not crash or hang.

#![forbid(unsafe_code)]

use std::sync::Arc;

use mujoco_safe::enums::{Integrator, Solver};
use mujoco_safe::{Controller, Data, Differences, Error, Model, RandomController, sample};

/// A model of all geoms that the general collision algorithm handles, and a mocap body.
const COLLIDERS: &str = include_str!("../models/colliders.xml");

/// Overwrites every writable number of a simulation. Only errors are allowed.
#[test]
fn no_number_in_a_simulation_crashes_or_hangs_a_step() {
    let numbers = [f64::NAN, f64::INFINITY, -1e300, 1e9, 0.0];
    let targets: &[fn(&mut Data) -> &mut [f64]] = &[
        |data| data.qpos_mut(),
        |data| data.qvel_mut(),
        |data| data.act_mut(),
        |data| data.ctrl_mut(),
        |data| data.qacc_warmstart_mut(),
        |data| data.qfrc_applied_mut(),
        |data| data.xfrc_applied_mut().as_flattened_mut(),
        |data| data.mocap_pos_mut().as_flattened_mut(),
        |data| data.mocap_quat_mut().as_flattened_mut(),
        |data| data.qacc_mut(),
        |data| data.sensordata_mut(),
        |data| data.xpos_mut().as_flattened_mut(),
        |data| data.xmat_mut().as_flattened_mut(),
        #[cfg(not(engine_since = "3.10.0"))]
        |data| data.qM_mut(),
        |data| data.qLD_mut(),
        |data| data.efc_J_mut(),
        |data| data.efc_D_mut(),
        |data| data.efc_AR_mut(),
        |data| data.efc_force_mut(),
        |data| data.efc_aref_mut(),
        |data| data.qfrc_bias_mut(),
        |data| data.geom_xpos_mut().as_flattened_mut(),
    ];
    for xml in [sample::HUMANOID_XML, COLLIDERS] {
        for solver in [Solver::Pgs, Solver::Newton] {
            let mut model = Model::from_xml_str(xml).unwrap();
            model.edit().edit_options(|options| options.solver = solver).unwrap();
            let mut data = Data::new(model).unwrap();
            for target in targets {
                for number in numbers {
                    data.reset().unwrap();
                    data.step1().unwrap();
                    target(&mut data).fill(number);
                    let halves = data.step2().and_then(|()| data.step());
                    let _ = data.reset();
                    data.forward().unwrap();
                    target(&mut data).fill(number);
                    let nv = data.model().nv();
                    let (mut result, vector) = (vec![0.0; nv], vec![1.0; nv]);
                    let _ = data.solve_m_into(&vector, &mut result);
                    let _ = data.mul_m_into(&vector, &mut result);
                    for contact in data.contacts() {
                        let _ = contact.force_in_world();
                    }
                    let _ = data.inverse();
                    let _ = data.transition_fd(1e-6, Differences::Forward);
                    if let Err(error) = halves {
                        assert!(
                            matches!(error, Error::Unstable(_) | Error::Engine { .. } | Error::Poisoned { .. }),
                            "{error}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn no_number_in_a_model_crashes_or_hangs_a_step() {
    let targets: [fn(&mut mujoco_safe::ModelMut<'_>, f64); 24] = [
        |model, number| model.qpos0_mut().fill(number),
        |model, number| model.body_mass_mut().fill(number),
        |model, number| model.body_inertia_mut().as_flattened_mut().fill(number),
        |model, number| model.body_pos_mut().as_flattened_mut().fill(number),
        |model, number| model.body_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.body_ipos_mut().as_flattened_mut().fill(number),
        |model, number| model.body_iquat_mut().as_flattened_mut().fill(number),
        |model, number| model.jnt_axis_mut().as_flattened_mut().fill(number),
        |model, number| model.jnt_range_mut().as_flattened_mut().fill(number),
        |model, number| model.dof_armature_mut().fill(number),
        |model, number| model.dof_damping_mut().fill(number),
        |model, number| model.dof_invweight0_mut().fill(number),
        |model, number| model.geom_size_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_pos_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_rbound_mut().fill(number),
        |model, number| model.geom_margin_mut().fill(number),
        |model, number| model.geom_friction_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_solref_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_solimp_mut().as_flattened_mut().fill(number),
        |model, number| model.site_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.actuator_gear_mut().as_flattened_mut().fill(number),
        |model, number| model.actuator_ctrlrange_mut().as_flattened_mut().fill(number),
        |model, number| model.hfield_data_mut().fill(number as f32),
    ];
    for xml in [sample::HUMANOID_XML, COLLIDERS] {
        let shared = Arc::new(Model::from_xml_str(xml).unwrap());
        for integrator in [Integrator::Euler, Integrator::Implicit] {
            for target in targets {
                for number in [f64::NAN, f64::INFINITY, -1e300, 1e9, -1.0, 0.0] {
                    let mut data = Data::new(shared.clone()).unwrap();
                    data.edit_model(|model| {
                        model.edit_options(|options| options.integrator = integrator).unwrap();
                        target(model, number);
                    })
                    .unwrap();
                    let mut random = RandomController::new(1);
                    let mut run = || -> mujoco_safe::Result<()> {
                        for _ in 0..3 {
                            random.control(&mut data)?;
                            data.step()?;
                        }
                        data.inverse()?;
                        data.transition_fd(1e-6, Differences::Forward).map(drop)
                    };
                    if let Err(error) = run() {
                        // One model has a rangefinder and a height field, whose orientation may
                        // become invalid.
                        assert!(
                            matches!(error, Error::Unstable(_) | Error::Engine { .. } | Error::Unsupported(_)),
                            "{error}"
                        );
                    }
                    data.reset().unwrap();
                    let _ = data.edit_model(|model| model.update_constants());
                    data.reset().unwrap();
                    let _ = data.step();
                }
            }
        }
    }
}
