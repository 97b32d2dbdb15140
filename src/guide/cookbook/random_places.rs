//! Objects at random places.
//!
//! Boxes are placed one after another. A place is drawn again while it overlaps with an earlier
//! object: [`forward`](crate::Data::forward) finds the contacts. [`Random`](crate::rollout::Random)
//! gives the same numbers on every machine; any other generator works too.
//!
//! ```
//! use mujoco_safe::Data;
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::rollout::Random;
//! use mujoco_safe::spec::Spec;
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
//! let mut random = Random::new(42, 0, 0); // seed, simulation, episode
//! for joint in 0..data.model().njnt() {
//!     loop {
//!         let (x, y) = (random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
//!         let half_turn = random.uniform(0.0, std::f64::consts::PI);
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
