//! A model that changes while it runs.
//!
//! [`Data::adopt`](crate::Data::adopt) gives a simulation an edited model and keeps the state of
//! all elements that are in both models. Here a cart-pole gets a second pole while it moves. The
//! model can also come from a file that has been edited: its elements are then found by their
//! names. [`Batch::adopt`](crate::Batch::adopt) does the same for all simulations of a batch.
//!
//! ```
//! use mujoco_safe::enums::GeomType;
//! use mujoco_safe::spec::Spec;
//! use mujoco_safe::{Data, sample};
//!
//! let mut spec = Spec::from_xml_str(sample::CARTPOLE_XML)?;
//! let mut data = Data::new(spec.compile()?)?;
//! data.joint_mut("hinge")?.qpos_mut()[0] = 0.1;
//! data.step_n(20)?;
//! let (time, angle) = (data.time(), data.joint("hinge")?.qpos()[0]);
//!
//! let cart = spec.body("cart")?.id();
//! let pole = spec.add_body(cart).set_name("second pole").id();
//! spec.add_joint(pole).set_name("second hinge").set_axis([0.0, 1.0, 0.0]);
//! spec.add_geom(pole)
//!     .set_type(GeomType::Capsule)
//!     .set_fromto([0.0, 0.0, 0.0, 0.0, 0.0, 0.3])
//!     .set_size(&[0.02]);
//! let adoption = data.adopt(spec.compile()?)?;
//!
//! let new: Vec<String> = adoption.new.iter().map(ToString::to_string).collect();
//! assert_eq!(new, ["body 'second pole'", "joint 'second hinge'"]);
//! assert_eq!((data.time(), data.joint("hinge")?.qpos()[0]), (time, angle));
//! assert_eq!(data.joint("second hinge")?.qpos()[0], 0.0);
//! data.step_n(20)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
