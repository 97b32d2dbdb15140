//! Complete programs for common tasks. Each runs as a test.
//!
//! # A mocap body as a gripper
//!
//! The program sets the pose of a mocap body, which becomes a gripper by activating and
//! deactivating a weld constraint.
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom type="plane" size="1 1 .1"/>
//!            <body name="hand" mocap="true" pos="0 0 .3"><geom size=".02" contype="0" conaffinity="0"/></body>
//!            <body name="cube" pos="0 0 .05"><freejoint/><geom type="box" size=".05 .05 .05" mass=".2"/></body>
//!          </worldbody>
//!          <equality><weld name="grasp" body1="hand" body2="cube" relpose="0 0 -.07 1 0 0 0" active="false"/></equality>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.body_mut("hand")?.mocap_pos_mut().expect("a mocap body")[2] = 0.12;
//! data.edit_model(|model| model.equality_mut("grasp").map(|mut grasp| grasp.set_active(true)))?;
//! for step in 0..500 {
//!     data.body_mut("hand")?.mocap_pos_mut().expect("a mocap body")[2] = 0.12 + 0.001 * f64::from(step);
//!     data.step()?;
//! }
//! assert!(data.body("cube")?.xpos()[2] > 0.4);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Inverse kinematics with a Jacobian
//!
//! Damped least squares: `dq = Jᵀ (J Jᵀ + λ² I)⁻¹ e` (Buss, *Introduction to inverse kinematics
//! with Jacobian transpose, pseudoinverse and damped least squares methods*, 2009).
//! [`Matrix::transposed`](crate::Matrix::transposed) is a nalgebra view of the transpose without a
//! copy.
//!
//! ```
//! use mujoco_safe::{Data, Model, nalgebra, nalgebra::Vector3};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <body><joint name="shoulder" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/>
//!              <body pos=".4 0 0"><joint name="elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/>
//!                <site name="tip" pos=".4 0 0"/>
//!              </body>
//!            </body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let tip = model.site("tip")?.id();
//! let mut data = Data::new(model)?;
//! data.qpos_mut().copy_from_slice(&[-0.5, 1.0]);
//! let target = Vector3::new(0.4, 0.0, 0.3);
//! for _ in 0..100 {
//!     data.fwd_position()?;
//!     let error = target - Vector3::from(*data.site(tip).xpos());
//!     let jacobian = data.jac_site(tip)?.linear;
//!     let j = jacobian.transposed(); // (nv, 3): a view
//!     let damped = j.tr_mul(&j) + 1e-4 * nalgebra::DMatrix::<f64>::identity(3, 3);
//!     let dq = &j * damped.lu().solve(&error).expect("a positive definite matrix");
//!     data.integrate_pos(dq.as_slice(), 1.0)?;
//! }
//! data.fwd_position()?;
//! assert!((target - Vector3::from(*data.site(tip).xpos())).norm() < 1e-4);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Gravity compensation
//!
//! The bias force at rest, applied through the actuators, holds a robot in place.
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody><body>
//!            <joint name="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .5 0 0" size=".03"/>
//!          </body></worldbody>
//!          <actuator><motor joint="hinge"/></actuator>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! for _ in 0..1000 {
//!     data.step1()?; // position- and velocity-dependent quantities
//!     let force = data.qfrc_bias()[0];
//!     data.ctrl_mut()[0] = force;
//!     data.step2()?;
//! }
//! assert!(data.qpos()[0].abs() < 1e-9);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Applied force and contact forces
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom name="floor" type="plane" size="5 5 .1"/>
//!            <body name="box" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" mass="2"/></body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.body_mut("box")?.xfrc_applied_mut()[0] = 5.0; // N, along x; persists until changed
//! for _ in 0..500 {
//!     data.step()?;
//! }
//! let mut total = [0.0; 3];
//! for contact in data.contacts() {
//!     let force = contact.force_in_world()?; // on the second geom, the box
//!     (0..3).for_each(|axis| total[axis] += force[axis]);
//! }
//! assert!((total[0] + 5.0).abs() < 0.1, "friction: {total:?}");
//! assert!((total[2] - 2.0 * 9.81).abs() < 0.1, "the floor: {total:?}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Lidar with rays
//!
//! ```
//! use mujoco_safe::data::RayOptions;
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom name="wall" type="box" pos="2 0 .5" size=".1 3 .5"/>
//!            <body name="robot" pos="0 0 .2"><freejoint/><geom size=".1"/><site name="lidar"/></body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.forward()?;
//! let directions: Vec<[f64; 3]> = (-45..=45).map(|degrees| f64::from(degrees).to_radians()).map(|a| [a.cos(), a.sin(), 0.0]).collect();
//! let options = RayOptions::default().with_bodyexclude(data.model().body("robot")?);
//! let mut hits = vec![None; directions.len()];
//! let origin = *data.site("lidar")?.xpos();
//! data.multi_ray_into(origin, &directions, &options, 10.0, &mut hits)?;
//! let ahead = hits[45].expect("a wall");
//! assert!((ahead.distance - 1.9).abs() < 1e-9);
//! assert_eq!(data.geom(ahead.geom).name(), Some("wall"));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Sensors by name
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.forward()?;
//! for sensor in data.sensors() {
//!     let description = sensor.in_model();
//!     println!("{:?}: {:?}, {} values, {:?}", sensor.name(), description.sensor_type(), description.dim(), sensor.data());
//! }
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Variations of a model
//!
//! The ids of a model are valid for its clones. `scale_mass` scales mass and inertia together, like
//! a change of density, and [`update_constants`](crate::ModelMut::update_constants) updates the
//! derived quantities.
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let model = sample::cartpole();
//! let pole = model.body("pole")?.id();
//! let hinge = model.joint("hinge")?.id();
//! let mut angles = Vec::new();
//! for scale in [0.8, 1.0, 1.2] {
//!     let mut variation = model.clone();
//!     let mut edit = variation.edit();
//!     edit.body_mut(pole).scale_mass(scale)?;
//!     edit.joint_mut(hinge).damping_mut()[0] *= scale;
//!     edit.update_constants()?;
//!     let mut data = Data::new(variation)?;
//!     data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//!     data.step_n(20)?;
//!     angles.push(data.joint(hinge).qpos()[0]);
//! }
//! assert!(angles.iter().all(|angle| *angle > 0.1));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # A model that changes while it runs
//!
//! [`Data::adopt`](crate::Data::adopt) gives a simulation an edited model and keeps the state of
//! all elements that are in both models. Here a cart-pole gets a second pole while it moves. The
//! model can also come from a file that has been edited: its elements are then found by their
//! names. [`Batch::adopt`](crate::Batch::adopt) does the same for all simulations of a batch.
//!
//! ```
//! use mujoco_safe::Data;
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::spec::Spec;
//!
//! let mut spec = Spec::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/models/cartpole.xml"))?;
//! let mut data = Data::new(spec.compile()?)?;
//! data.joint_mut("hinge")?.qpos_mut()[0] = 0.1;
//! data.step_n(20)?;
//! let (time, angle) = (data.time(), data.joint("hinge")?.qpos()[0]);
//!
//! let cart = spec.body("cart")?.id();
//! let pole = spec.add_body(cart).set_name("second pole").id();
//! spec.add_joint(pole).set_name("second hinge").set_axis([0.0, 1.0, 0.0]);
//! spec.add_geom(pole).set_type(GeomType::Capsule).set_fromto([0.0, 0.0, 0.0, 0.0, 0.0, 0.3]).set_size(&[0.02]);
//! let adoption = data.adopt(spec.compile()?)?;
//!
//! let new: Vec<String> = adoption.new.iter().map(ToString::to_string).collect();
//! assert_eq!(new, ["body 'second pole'", "joint 'second hinge'"]);
//! assert_eq!((data.time(), data.joint("hinge")?.qpos()[0]), (time, angle));
//! assert_eq!(data.joint("second hinge")?.qpos()[0], 0.0);
//! data.step_n(20)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Objects at random places
//!
//! Boxes are placed one after another. A place is drawn again while it overlaps with an earlier
//! object: [`forward`](crate::Data::forward) finds the contacts.
//!
//! ```
//! use mujoco_safe::Data;
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::spec::Spec;
//! use rand::{RngExt, SeedableRng};
//! use rand_xoshiro::Xoshiro256PlusPlus;
//!
//! let mut spec = Spec::new("table");
//! let world = spec.world();
//! spec.add_geom(world).set_type(GeomType::Plane).set_size(&[1.0, 1.0, 0.1]);
//! for number in 0..10 {
//!     // Above each other, so that they do not touch before they are placed.
//!     let item = spec.add_body(world).set_pos([0.0, 0.0, 1.0 + f64::from(number)]).id();
//!     spec.add_freejoint(item);
//!     spec.add_geom(item).set_type(GeomType::Box).set_size(&[0.05, 0.05, 0.05]);
//! }
//! let mut data = Data::new(spec.compile()?)?;
//! let mut random = Xoshiro256PlusPlus::seed_from_u64(0);
//! for joint in 0..data.model().njnt() {
//!     loop {
//!         let half_turn = 0.5 * random.random_range(0.0..std::f64::consts::TAU);
//!         let [x, y] = [0.0; 2].map(|_: f64| random.random_range(-0.3..0.3));
//!         let pose = [x, y, 0.06, half_turn.cos(), 0.0, 0.0, half_turn.sin()];
//!         data.joint_mut(joint)?.qpos_mut().copy_from_slice(&pose);
//!         data.forward()?;
//!         if data.contacts().all(|contact| contact.dist() > 0.0) {
//!             break;
//!         }
//!     }
//! }
//! assert_eq!(data.ncon(), 0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Domain randomisation
//!
//! Each rollout edits its own copy of the model. The random numbers are drawn beforehand, so that
//! the results do not depend on the threads.
//! [`with_forward_after_step`](crate::Rollout::with_forward_after_step) updates the poses that the
//! outputs read. With the feature `npz`, `result.save_npz(path)?` writes all arrays for NumPy.
//!
//! ```
//! use mujoco_safe::{Rollout, sample};
//! use rand::{RngExt, SeedableRng};
//! use rand_xoshiro::Xoshiro256PlusPlus;
//!
//! let (nroll, nstep) = (16, 50);
//! let mut random = Xoshiro256PlusPlus::seed_from_u64(0);
//! let scales: Vec<f64> = (0..nroll).map(|_| random.random_range(0.8..1.2)).collect();
//! let model = sample::cartpole();
//! let (pole, hinge) = (model.body("pole")?.id(), model.joint("hinge")?.id());
//! let result = Rollout::new(model, nroll, nstep)
//!     .with_model_edits(|roll, edit| {
//!         edit.body_mut(pole).scale_mass(scales[roll])?;
//!         edit.joint_mut(hinge).damping_mut()[0] *= scales[roll];
//!         edit.update_constants()
//!     })
//!     .with_shared_controls(&vec![0.1; nstep]) // (nstep, nu)
//!     .with_outputs(1, |data, row| row[0] = data.body(pole).xpos()[0])
//!     .with_forward_after_step()
//!     .run()?;
//! assert!(result.outcomes().iter().all(Result::is_ok));
//! assert_eq!(result.outputs().len(), nroll * nstep);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Identification of parameters
//!
//! The Gauss–Newton method fits the damping and the relative mass of a pendulum to readings of its
//! sensor. One rollout has the nominal parameters, and one more per parameter gives the
//! differences. Row k of `sensordata` is the reading in the state before step k + 1, which
//! `d.sensordata` holds after that step.
//!
//! ```
//! use mujoco_safe::{Model, Result, Rollout, nalgebra::{DMatrix, DVector}};
//!
//! let model = std::sync::Arc::new(Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody><body name="arm">
//!            <joint name="hinge" axis="0 1 0" damping="0.1"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
//!          </body></worldbody>
//!          <actuator><motor joint="hinge"/></actuator>
//!          <sensor><jointpos joint="hinge"/></sensor>
//!        </mujoco>"#,
//! )?);
//! let (arm, hinge) = (model.body("arm")?.id(), model.joint("hinge")?.id());
//! let controls: Vec<f64> = (0..400).map(|step| 0.5 * (0.03 * f64::from(step)).sin()).collect();
//! // Readings for each column [damping, relative mass], one column of readings each.
//! let simulate = |parameters: &DMatrix<f64>| -> Result<DMatrix<f64>> {
//!     let result = Rollout::new(&model, parameters.ncols(), controls.len())
//!         .with_model_edits(|roll, edit| {
//!             edit.joint_mut(hinge).damping_mut()[0] = parameters[(0, roll)];
//!             edit.body_mut(arm).scale_mass(parameters[(1, roll)])?;
//!             edit.update_constants()
//!         })
//!         .with_shared_controls(&controls)
//!         .run()?;
//!     Ok(DMatrix::from_column_slice(controls.len(), parameters.ncols(), result.sensordata()))
//! };
//! let measured: DVector<f64> = simulate(&DMatrix::from_column_slice(2, 1, &[0.25, 1.3]))?.column(0).into();
//!
//! let mut estimate = DVector::from_column_slice(&[0.1, 1.0]);
//! for _ in 0..10 {
//!     let eps = 1e-6;
//!     let mut parameters = DMatrix::from_columns(&[estimate.clone(), estimate.clone(), estimate.clone()]);
//!     (0..2).for_each(|i| parameters[(i, i + 1)] += eps);
//!     let readings = simulate(&parameters)?;
//!     let nominal: DVector<f64> = readings.column(0).into();
//!     let jacobian = DMatrix::from_fn(controls.len(), 2, |row, i| (readings[(row, i + 1)] - nominal[row]) / eps);
//!     let normal = jacobian.tr_mul(&jacobian);
//!     estimate += normal.cholesky().expect("identifiable parameters").solve(&jacobian.tr_mul(&(&measured - nominal)));
//! }
//! assert!((&estimate - DVector::from_column_slice(&[0.25, 1.3])).norm() < 1e-6, "{estimate}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Saving and restoring a state, bit for bit
//!
//! ```
//! use mujoco_safe::{Data, StateSpec, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut saved = data.state(StateSpec::INTEGRATION); // all inputs of the next step
//! data.step_n(10)?;
//! let first = data.qpos().to_vec();
//! data.set_state(StateSpec::INTEGRATION, &saved)?;
//! data.step_n(10)?;
//! assert_eq!(data.qpos(), first);
//! data.state_into(StateSpec::INTEGRATION, &mut saved)?; // reuses the vector
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Parallel simulations
//!
//! Threads share a model, and each thread has its own simulation.
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::{Data, sample};
//!
//! let model = Arc::new(sample::cartpole());
//! let angles = std::thread::scope(|scope| {
//!     let threads: Vec<_> = (0..4)
//!         .map(|thread| {
//!             let model = model.clone();
//!             scope.spawn(move || -> mujoco_safe::Result<f64> {
//!                 let mut data = Data::new(model)?;
//!                 data.ctrl_mut()[0] = 0.1 * f64::from(thread);
//!                 data.step_n(20)?;
//!                 Ok(data.qpos()[1])
//!             })
//!         })
//!         .collect();
//!     threads.into_iter().map(|thread| thread.join().expect("no panic")).collect::<Result<Vec<_>, _>>()
//! })?;
//! assert!(angles.windows(2).all(|pair| pair[1].abs() > pair[0].abs())); // a larger control gives a larger angle
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Custom numeric and text fields of a model
//!
//! ```
//! use mujoco_safe::Model;
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <custom><numeric name="gains" data="10 2.5"/><text name="author" data="me"/></custom>
//!        </mujoco>"#,
//! )?;
//! assert_eq!(model.numeric("gains")?.data(), [10.0, 2.5]);
//! assert_eq!(model.text("author")?.data(), "me");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Examples
//!
//! The folder `examples/` of the repository has larger programs:
//!
//! ```sh
//! cargo run --release --example getting_started              # load, inspect, random control, reset, record
//! cargo run --release --example contacts                     # also tippe_top and pendulum_chaos: the tutorials of the Python bindings
//! cargo run --release --example cartpole_lqr -- --angle 0.3  # linearise, solve, balance
//! cargo run --release --example humanoid_lqr -- --help       # balance a humanoid on one leg, step by step
//! cargo run --release --features renderer --example assemble -- --out out   # a model in code: two arms on a table
//! cargo run --release --features renderer --example pick_and_place   # a scene that changes while it runs: grasp, adopt an edited model
//! cargo run --release --example rollouts                     # 256 pushes of a balanced pole, on all cores
//! cargo run --release --example cartpole_swing_up            # iLQR within the motor's range, tracked by a table of gains
//! cargo run --release --example humanoid_predictive          # predictive sampling recovers from pushes under which the LQR falls
//! cargo run --release --example humanoid_stand_up            # predictive control: from a squat to standing; arm_tracking: an arm follows a target
//! cargo run --release --example learn_gait                   # a half cheetah learns to run in minutes, by random search
//! cargo run --release --features viewer --example humanoid_predictive -- --view   # pull a humanoid, watch its plan, change the weights
//! cargo run --release --features renderer --example camera_sensor   # a rover steers by its depth camera
//! cargo run --release --features viewer --example view -- model.xml # any model in the viewer
//! ```
