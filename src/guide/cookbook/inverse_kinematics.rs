//! Inverse kinematics with limits.
//!
//! An arm follows a target within the ranges and speeds of its joints. [`ik`](crate::ik) has tasks
//! for poses, centres of mass, postures, directions and momenta, priorities, distances between
//! geoms, closed chains, and a search for positions from random starts.
//!
//! ```
//! use mujoco_safe::control::residual::{Frame, FramePosition, JointPosition};
//! use mujoco_safe::ik::{Ik, SearchOptions, Task};
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <default>
//!            <geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/>
//!            <joint axis="0 1 0" limited="true" range="-150 150"/>
//!          </default>
//!          <worldbody>
//!            <body>
//!              <joint name="shoulder"/><geom/>
//!              <body pos=".4 0 0">
//!                <joint name="elbow"/><geom/>
//!                <site name="tip" pos=".4 0 0"/>
//!              </body>
//!            </body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! let model = data.model().clone();
//! data.qpos_mut().copy_from_slice(&[-0.5, 1.0]);
//!
//! let mut ik = Ik::new(&model);
//! let tip = ik.add_task(Task::new(FramePosition::site(&model, "tip")?));
//! // A small weight: the posture decides only where the tip leaves freedom.
//! ik.add_task(Task::new(JointPosition::all(&model)).with_weight(1e-6));
//! ik.set_velocity_limits(2.0)?; // rad/s
//!
//! ik.set_target(tip, &[0.4, 0.0, 0.3])?;
//! for _ in 0..100 {
//!     let tick = ik.step(&mut data, 0.01)?; // velocities, which also move the positions
//!     assert!(tick.is_solved());
//!     assert!(tick.velocity().iter().all(|rate| rate.abs() <= 2.0 + 1e-9));
//! }
//! data.kinematics()?;
//! assert!((data.site(model.site("tip")?).xpos()[2] - 0.3).abs() < 1e-4);
//!
//! // Without a path: any position of the joints for a target. The posture is secondary.
//! let mut ik = Ik::new(&model);
//! ik.add_task(Task::new(FramePosition::site(&model, "tip")?.with_target([-0.5, 0.0, 0.2])));
//! ik.add_task(Task::new(JointPosition::all(&model)).with_priority(1));
//! let found = ik.search(&mut data, &SearchOptions::default())?.found();
//! let found = found.expect("a reachable target");
//! assert!(found.error < 1e-6);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! In a simulation, `ik.solve(&mut data, dt)` on a second [`Data`](crate::Data) gives the velocity
//! or, after `ik.integrate`, the position for the actuators.
