//! Watched values: elements of the data, addressed by the name of their field.

use std::fmt;
use std::str::FromStr;

use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::field_docs::FieldDoc;
use crate::matrix::MatrixView;

/// Element of a field of [`Data`]. The index counts over rows and columns in row-major order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Watch {
    field: usize,
    index: usize,
}

impl Watch {
    /// Creates a watch of one element of a field, which is given by the engine's name.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchField`] if no real-valued field has this name.
    pub fn new(field: &str, index: usize) -> Result<Self> {
        match FIELDS.iter().position(|(name, _)| *name == field) {
            Some(field) => Ok(Self { field, index }),
            None => Err(FieldDoc::unknown("Data", field, Self::fields())),
        }
    }

    /// Returns the names of the fields that can be watched.
    pub fn fields() -> impl Iterator<Item = &'static str> {
        FIELDS.iter().map(|(name, _)| *name)
    }

    /// Returns the current value, or NaN if the index is out of range.
    pub fn value(self, data: &Data) -> f64 {
        FIELDS[self.field].1(data, self.index).unwrap_or(f64::NAN)
    }
}

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]", FIELDS[self.field].0, self.index)
    }
}

impl FromStr for Watch {
    type Err = Error;

    /// Parses `qpos[3]`, or `time` for the first element.
    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let Some((field, index)) = text.strip_suffix(']').and_then(|text| text.split_once('[')) else {
            return Self::new(text, 0);
        };
        match index.trim().parse() {
            Ok(index) => Self::new(field.trim(), index),
            Err(_) => {
                Err(Error::invalid(InvalidKind::Text, "the index of a watched value", index, "an integer from 0"))
            }
        }
    }
}

/// Array or scalar of real numbers.
trait Elements {
    /// Returns an element by its row-major index.
    fn element(&self, index: usize) -> Option<f64>;
}

impl Elements for &[f64] {
    fn element(&self, index: usize) -> Option<f64> {
        self.get(index).copied()
    }
}

impl<const N: usize> Elements for &[[f64; N]] {
    fn element(&self, index: usize) -> Option<f64> {
        self.as_flattened().get(index).copied()
    }
}

impl<const N: usize> Elements for [f64; N] {
    fn element(&self, index: usize) -> Option<f64> {
        self.get(index).copied()
    }
}

impl Elements for MatrixView<'_> {
    fn element(&self, index: usize) -> Option<f64> {
        self.as_slice().get(index).copied()
    }
}

impl Elements for f64 {
    fn element(&self, index: usize) -> Option<f64> {
        (index == 0).then_some(*self)
    }
}

/// Accessor of one element of a field.
type Read = fn(&Data, usize) -> Option<f64>;

macro_rules! fields {
    ($($(#[$condition:meta])? $name:ident)*) => {
        &[$($(#[$condition])? (stringify!($name), |data, index| data.$name().element(index))),*]
    };
}

/// Real-valued fields, in the order of 2.2.2, which alone has some of them.
#[rustfmt::skip]
static FIELDS: &[(&str, Read)] = fields! {
    time energy solver_fwdinv
    qpos qvel act qacc_warmstart ctrl qfrc_applied xfrc_applied mocap_pos mocap_quat qacc act_dot userdata
    sensordata xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat cam_xpos
    cam_xmat light_xpos light_xdir subtree_com cdof cinert ten_length ten_J wrap_xpos actuator_length
    actuator_moment crb
    #[cfg(not(engine_since = "2.3.0"))] qM
    qLD qLDiagInv
    #[cfg(not(engine_since = "2.3.0"))] qLDiagSqrtInv
    efc_J
    #[cfg(not(engine_since = "2.3.0"))] efc_JT
    efc_pos efc_margin efc_frictionloss
    #[cfg(not(engine_since = "2.3.0"))] efc_diagApprox
    efc_KBIP efc_D efc_R efc_AR ten_velocity actuator_velocity cvel cdof_dot qfrc_bias
    qfrc_passive efc_vel efc_aref subtree_linvel subtree_angmom qH qHDiagInv qDeriv qLU actuator_force
    qfrc_actuator qfrc_smooth qacc_smooth efc_b efc_force qfrc_constraint qfrc_inverse cacc cfrc_int cfrc_ext
};

#[cfg(test)]
mod tests {
    use super::Watch;
    use crate::{Data, Error, sample};

    #[test]
    fn value_is_found_by_field_and_index() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.step().unwrap();
        let value = |text: &str| text.parse::<Watch>().unwrap().value(&data);
        assert_eq!(value("qpos[2]"), data.qpos()[2]);
        assert_eq!(value("time"), data.time());
        assert_eq!(value(" xpos[ 5 ]"), data.xpos()[1][2]);
        // Newer engines store sparse rows.
        #[cfg(not(engine_since = "3.2.5"))]
        assert_eq!(value("actuator_moment[27]"), data.actuator_moment().row(1)[0]);
        assert!(value("qpos[1000]").is_nan());
        assert_eq!("qvel[3]".parse::<Watch>().unwrap().to_string(), "qvel[3]");
    }

    #[test]
    fn unknown_fields_and_invalid_indices_are_errors() {
        assert!("qpso[0]".parse::<Watch>().unwrap_err().to_string().contains("qpos"));
        assert!(matches!("qpos[x]".parse::<Watch>(), Err(Error::Invalid { .. })));
        assert!(matches!("qpos[-1]".parse::<Watch>(), Err(Error::Invalid { .. })));
    }

    #[test]
    #[cfg_attr(engine_since = "2.3.0", ignore = "the list has the arrays of 2.2.2")]
    fn every_real_array_can_be_watched() {
        let known: Vec<_> = Watch::fields().collect();
        let missing: Vec<_> = Data::fields()
            .filter(|field| field.ctype == "mjtNum" && field.is_array && !known.contains(&field.name))
            .map(|field| field.name)
            .collect();
        assert_eq!(missing, [""; 0]);
    }
}
