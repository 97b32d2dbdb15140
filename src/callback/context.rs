//! Arguments of the closures: the simulation during a step, with the fields that a closure may
//! change.

use std::ops::Deref;

use crate::data::{Data, Stage};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;

/// Defines the argument of a closure, which reads like [`Data`] and has methods for the writable
/// arrays.
macro_rules! context {
    (
        $(#[$doc:meta])*
        $name:ident { $($(#[$array_doc:meta])* $array_mut:ident -> $type:ty = |$data:ident| $values:expr;)* }
    ) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $name<'d> {
            // Private, and borrowed from `self` by all methods, so that no array is read while it
            // is written.
            data: &'d Data,
        }

        impl<'d> $name<'d> {
            pub(super) fn new(data: &'d Data) -> Self {
                Self { data }
            }

            $(
                $(#[$array_doc])*
                pub fn $array_mut(&mut self) -> &mut $type {
                    let $data = self.data;
                    // SAFETY: the engine allocated the array with this shape. The engine waits for
                    // the closure, the closure has no other access to the simulation, and `self` is
                    // borrowed exclusively.
                    unsafe { $values }
                }
            )*
        }

        impl Deref for $name<'_> {
            type Target = Data;

            fn deref(&self) -> &Data {
                self.data
            }
        }
    };
}

context! {
    /// Simulation before actuator forces are computed. Quantities that depend on positions and
    /// velocities are valid.
    ControlContext {
        /// Returns [`ctrl`](Data::ctrl) for writing.
        ctrl_mut -> [f64] = |data| ffi::array_mut(data.raw().ctrl, data.model().nu());
        /// Returns [`qfrc_applied`](Data::qfrc_applied) for writing.
        qfrc_applied_mut -> [f64] = |data| ffi::array_mut(data.raw().qfrc_applied, data.model().nv());
        /// Returns [`xfrc_applied`](Data::xfrc_applied) for writing.
        xfrc_applied_mut -> [[f64; 6]] = |data| ffi::rows_mut(data.raw().xfrc_applied, data.model().nbody());
        /// Returns [`userdata`](Data::userdata) for writing.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

context! {
    /// Simulation after passive forces were computed.
    PassiveContext {
        /// Returns [`qfrc_passive`](Data::qfrc_passive), which contains the engine's passive
        /// forces, for adding other forces.
        qfrc_passive_mut -> [f64] = |data| ffi::array_mut(data.raw().qfrc_passive, data.model().nv());
        /// Returns [`userdata`](Data::userdata) for writing.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

context! {
    /// Simulation after the evaluation of the sensors of a stage.
    SensorContext {
        /// Returns [`sensordata`](Data::sensordata) for writing.
        sensordata_mut -> [f64] = |data| ffi::array_mut(data.raw().sensordata, data.model().nsensordata());
        /// Returns [`userdata`](Data::userdata) for writing.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

impl ControlContext<'_> {
    /// Sets the control of an actuator, the first one if it has several. An id returns nothing; a
    /// name or an index returns a [`Result`](crate::Result).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.set_callbacks(Callbacks::new().with_control(|context| context.set_ctrl("slide", 0.5).expect("a known name")));
    /// data.step()?;
    /// assert_eq!(data.ctrl(), [0.5]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn set_ctrl<Q: IntoId<kind::Actuator>>(&mut self, actuator: Q, ctrl: f64) -> Q::Found<()> {
        let id = actuator.id_in(self.data.model().as_ref());
        Q::found(id, |id| {
            let control = self.data.model().first_control(id.index());
            self.ctrl_mut()[control] = ctrl;
        })
    }
}

impl SensorContext<'_> {
    /// Returns the stage whose sensors were evaluated. Readings of later stages are not valid yet.
    pub fn stage(&self) -> Stage {
        self.data.stage()
    }

    /// Returns the reading of a sensor for writing. An id yields the slice itself; a name or an
    /// index yields a [`Result`](crate::Result).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn data_mut<Q: IntoId<kind::Sensor>>(&mut self, sensor: Q) -> Q::Found<&mut [f64]> {
        let id = sensor.id_in(self.data.model().as_ref());
        Q::found(id, |id| {
            let range = self.data.model().sensor(id).data_range();
            &mut self.sensordata_mut()[range]
        })
    }
}
