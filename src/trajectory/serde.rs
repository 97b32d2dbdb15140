//! Trajectories as serde data. Deserialisation validates the sizes, because they index the records.

use std::borrow::Cow;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{Sizes, Trajectory};
use crate::serialise::MOST_WITHOUT_VALUES;

/// Serialised form: the sizes of a state, followed by the values of [`Trajectory`].
#[derive(Serialize, Deserialize)]
#[serde(rename = "Trajectory", deny_unknown_fields)]
struct Records<'t> {
    nq: usize,
    nv: usize,
    na: usize,
    nu: usize,
    times: Cow<'t, [f64]>,
    states: Cow<'t, [f64]>,
    controls: Cow<'t, [f64]>,
    #[serde(default)]
    nsensordata: usize,
    #[serde(default)]
    sensordata: Cow<'t, [f64]>,
}

impl Serialize for Trajectory {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Sizes { nq, nv, na, nu } = self.sizes;
        Records {
            nq,
            nv,
            na,
            nu,
            times: (&self.times).into(),
            states: (&self.states).into(),
            controls: (&self.controls).into(),
            nsensordata: self.nsensordata,
            sensordata: (&self.sensordata).into(),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Trajectory {
    /// Returns an error unless the number of values matches the sizes and the number of times, or
    /// if a size is above 2²⁰. The limit exists because a trajectory without records has no values
    /// that confirm its sizes, and the sizes determine the length of a CSV header.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Records { nq, nv, na, nu, times, states, controls, nsensordata, sensordata } =
            Records::deserialize(deserializer)?;
        if let Some(size) = [nq, nv, na, nu, nsensordata].into_iter().find(|&size| size > MOST_WITHOUT_VALUES) {
            return Err(de::Error::custom(format!(
                "a size of {size} is above {MOST_WITHOUT_VALUES}, which no model has"
            )));
        }
        let state = nq.checked_add(nv).and_then(|sum| sum.checked_add(na));
        for (name, size, found) in [
            ("states", state, states.len()),
            ("controls", Some(nu), controls.len()),
            ("sensordata", Some(nsensordata), sensordata.len()),
        ] {
            if size.and_then(|size| size.checked_mul(times.len())) != Some(found) {
                return Err(de::Error::custom(format!(
                    "a trajectory of {} records with nq {nq}, nv {nv}, na {na}, nu {nu} and nsensordata {nsensordata} has {found} \
                     values in '{name}'",
                    times.len()
                )));
            }
        }
        let sizes = Sizes { nq, nv, na, nu };
        Ok(Self {
            sizes,
            times: times.into_owned(),
            states: states.into_owned(),
            controls: controls.into_owned(),
            nsensordata,
            sensordata: sensordata.into_owned(),
        })
    }
}
