//! What a closure sees and may change: the simulation at one moment of a step.

use std::ops::Deref;

use crate::data::{Data, Stage};
use crate::ffi;
use crate::id::{Key, kind};

/// Declares a moment: all of the simulation to be read, and the arrays that may be written to.
macro_rules! moment {
    (
        $(#[$doc:meta])*
        $name:ident { $($(#[$array_doc:meta])* $array_mut:ident -> $type:ty = |$data:ident| $values:expr;)* }
    ) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $name<'d> {
            // Private, and lent for no longer than the moment itself is borrowed: so nothing is read while it is written to.
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
                    // SAFETY: the engine allocated the array with this shape. It waits for the closure, the closure has no
                    // other way to the simulation, and `self` is borrowed exclusively.
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

moment! {
    /// The moment before actuator forces are computed: what depends on positions and velocities is there.
    ControlMoment {
        /// [`ctrl`](Data::ctrl), to be written to.
        ctrl_mut -> [f64] = |data| ffi::array_mut(data.raw().ctrl, data.model().nu());
        /// [`qfrc_applied`](Data::qfrc_applied), to be written to.
        qfrc_applied_mut -> [f64] = |data| ffi::array_mut(data.raw().qfrc_applied, data.model().nv());
        /// [`xfrc_applied`](Data::xfrc_applied), to be written to.
        xfrc_applied_mut -> [[f64; 6]] = |data| ffi::rows_mut(data.raw().xfrc_applied, data.model().nbody());
        /// [`userdata`](Data::userdata), to be written to.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

moment! {
    /// The moment after passive forces were computed.
    PassiveMoment {
        /// [`qfrc_passive`](Data::qfrc_passive), to be added to: the engine's own passive forces are in it.
        qfrc_passive_mut -> [f64] = |data| ffi::array_mut(data.raw().qfrc_passive, data.model().nv());
        /// [`userdata`](Data::userdata), to be written to.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

moment! {
    /// The moment after the sensors of a stage were read.
    SensorMoment {
        /// [`sensordata`](Data::sensordata), to be written to.
        sensordata_mut -> [f64] = |data| ffi::array_mut(data.raw().sensordata, data.model().nsensordata());
        /// [`userdata`](Data::userdata), to be written to.
        userdata_mut -> [f64] = |data| ffi::array_mut(data.raw().userdata, data.model().nuserdata());
    }
}

impl SensorMoment<'_> {
    /// The stage whose sensors were read; those of the later ones are still to come.
    pub fn stage(&self) -> Stage {
        self.data.stage()
    }

    /// The reading of a sensor, to be written to. By an id as it is, by a name or an index as a [`Result`](crate::Result).
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    pub fn data_mut<Q: Key<kind::Sensor>>(&mut self, sensor: Q) -> Q::Found<&mut [f64]> {
        let id = sensor.id(self.data.model().as_ref());
        Q::found(id, |id| {
            let range = self.data.model().sensor(id).data_range();
            &mut self.sensordata_mut()[range]
        })
    }
}
