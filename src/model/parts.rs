//! Places of the values of elements in the arrays that have parts of different lengths: samples of
//! delays, plastic deformations, and states of plugins.

use std::collections::HashMap;
use std::ops::Range;

use super::Model;
use super::survivors::Survivors;
use crate::kind::Kind;

/// Places of the values of elements in an array, and a number on which the meaning of the values
/// depends.
pub(crate) type Parts = HashMap<(Kind, usize), (Range<usize>, i32)>;

/// Returns the places of the values that stay, in the new and in the old array.
pub(crate) fn kept_parts(survivors: &Survivors<'_>, new: Parts, old: &Parts) -> Vec<(Range<usize>, Range<usize>)> {
    let parts = new.into_iter().filter_map(|((kind, index), (place, form))| {
        let (origin, found) = old.get(&(kind, survivors.origin(kind, index)?))?;
        (origin.len() == place.len() && *found == form).then(|| (place, origin.clone()))
    });
    parts.collect()
}

/// Returns the places of elements in an array of this length, from their addresses. Negative
/// addresses are those of elements without values.
#[cfg(engine_since = "2.3.0")]
fn parts(elements: impl Iterator<Item = ((Kind, usize), i32, i32)>, length: usize) -> Parts {
    let place = |(element, address, form)| Some((usize::try_from(address).ok()?, element, form));
    let mut places: Vec<_> = elements.filter_map(place).collect();
    places.sort_by_key(|&(address, ..)| address);
    let ends: Vec<usize> = places.iter().skip(1).map(|&(address, ..)| address).chain([length]).collect();
    places.into_iter().zip(ends).map(|((start, element, form), end)| (element, (start..end, form))).collect()
}

impl Model {
    /// Returns the places of the buffers of samples in `history`, and the numbers of samples.
    #[cfg_attr(not(engine_since = "3.5.0"), allow(clippy::unused_self, reason = "newer engines have buffers"))]
    pub(crate) fn history_parts(&self) -> Parts {
        #[cfg(engine_since = "3.5.0")]
        {
            let of = |kind, shapes: &[[i32; 2]], addresses: &[i32]| {
                let buffers = shapes.iter().zip(addresses).enumerate();
                buffers
                    .filter(|(_, ([samples, _], _))| *samples > 0)
                    .map(|(index, ([samples, _], &address))| ((kind, index), address, *samples))
                    .collect::<Vec<_>>()
            };
            let actuators = of(Kind::Actuator, self.actuator_history(), self.actuator_historyadr());
            let sensors = of(Kind::Sensor, self.sensor_history(), self.sensor_historyadr());
            parts(actuators.into_iter().chain(sensors), self.history_len())
        }
        #[cfg(not(engine_since = "3.5.0"))]
        Parts::new()
    }

    /// Returns the places of joints, tendons and flexes in `plastic`.
    #[cfg_attr(
        not(engine_since = "4.0.0"),
        allow(clippy::unused_self, reason = "newer engines have plastic deformations")
    )]
    pub(crate) fn plastic_parts(&self) -> Parts {
        #[cfg(engine_since = "4.0.0")]
        {
            let of = |kind, addresses: &[i32], form: &dyn Fn(usize) -> i32| {
                let elements = addresses.iter().enumerate();
                elements.map(|(index, &address)| ((kind, index), address, form(index))).collect::<Vec<_>>()
            };
            let joints = of(Kind::Joint, self.jnt_plasticadr(), &|_| 0);
            let tendons = of(Kind::Tendon, self.tendon_plasticadr(), &|_| 0);
            let flexes = of(Kind::Flex, self.flex_plasticadr(), &|flex| self.flex_plasticmode()[flex]);
            parts(joints.into_iter().chain(tendons).chain(flexes), self.plastic_len())
        }
        #[cfg(not(engine_since = "4.0.0"))]
        Parts::new()
    }

    /// Returns the places of the instances of plugins in `plugin_state`.
    #[cfg_attr(not(engine_since = "2.3.0"), allow(clippy::unused_self, reason = "newer engines have plugins"))]
    pub(crate) fn plugin_parts(&self) -> Parts {
        #[cfg(engine_since = "2.3.0")]
        {
            let instances = self.plugin_stateadr().iter().zip(self.plugin_statenum()).enumerate();
            let with_state = instances.filter(|(_, (_, count))| **count > 0);
            parts(with_state.map(|(index, (&address, _))| ((Kind::Plugin, index), address, 0)), self.plugin_state_len())
        }
        #[cfg(not(engine_since = "2.3.0"))]
        Parts::new()
    }
}
