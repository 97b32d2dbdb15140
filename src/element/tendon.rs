//! Tendons.

#![allow(non_snake_case, reason = "J: the engine's own spelling")]

use std::fmt;
use std::ops::Range;

use mujoco_sys as sys;

use super::{View, ViewMut, WrapPoints, Wraps, range};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{MaterialId, kind};
use crate::model::{Model, ModelMut};

fields!(Tendon on Model {
    /// The elements of its path: sites, geoms and pulleys of a spatial tendon, joints of a fixed one.
    #[doc(alias = "adr")]
    #[doc(alias = "num")]
    path: {Wraps<'a>} = |tendon| {
        Wraps::new(tendon.owner, range(tendon.owner.tendon_adr(), tendon.owner.tendon_num(), tendon.index()))
    };
    /// Its material, if it has one.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |tendon| tendon.optional_id_in(tendon.owner.tendon_matid());
    /// The group, for display.
    group: i32 = tendon_group, set_group;
    /// Whether [`range`](Self::range) is enforced. A limit that was not compiled in has the range `[0, 0]` unless one is set.
    limited: bool = tendon_limited, set_limited;
    /// Width, m, for display.
    width: f64 = tendon_width, set_width in tendon_width_mut;
    /// Limits of its length, m.
    range: [f64; 2] = tendon_range, range_mut in tendon_range_mut;
    /// At which distance from a limit the limit becomes active.
    margin: f64 = tendon_margin, set_margin in tendon_margin_mut;
    /// Stiffness of its spring, N/m.
    stiffness: f64 = tendon_stiffness, set_stiffness in tendon_stiffness_mut;
    /// Damping, N·s/m.
    damping: f64 = tendon_damping, set_damping in tendon_damping_mut;
    /// Dry friction, N.
    frictionloss: f64 = tendon_frictionloss, set_frictionloss in tendon_frictionloss_mut;
    /// Length at which its spring is at rest, m.
    lengthspring: f64 = tendon_lengthspring, set_lengthspring in tendon_lengthspring_mut;
    /// Length in the reference configuration, m.
    length0: f64 = tendon_length0;
    /// Inverse inertia in the reference configuration.
    invweight0: f64 = tendon_invweight0;
    /// Time constant and damping ratio of its limit.
    solref_lim: [f64; 2] = tendon_solref_lim, solref_lim_mut in tendon_solref_lim_mut;
    /// Impedance of its limit.
    solimp_lim: [f64; 5] = tendon_solimp_lim, solimp_lim_mut in tendon_solimp_lim_mut;
    /// Time constant and damping ratio of its dry friction.
    solref_fri: [f64; 2] = tendon_solref_fri, solref_fri_mut in tendon_solref_fri_mut;
    /// Impedance of its dry friction.
    solimp_fri: [f64; 5] = tendon_solimp_fri, solimp_fri_mut in tendon_solimp_fri_mut;
    /// Red, green, blue and opacity, where no material gives them.
    rgba: [f32; 4] = tendon_rgba, rgba_mut in tendon_rgba_mut;
    /// The user's own numbers.
    user: [f64] = tendon_user, user_mut in tendon_user_mut;
});

fields!(Tendon on Data {
    /// Length, m.
    length: f64 = ten_length;
    /// Velocity, m/s.
    velocity: f64 = ten_velocity;
    /// Derivative of its length by each degree of freedom. `None` where it has not been computed for the present model.
    J: {Option<JacobianRow<'a>>} = |tendon| tendon.jacobian_row();
    /// Where its path is among the points of all paths.
    #[doc(alias = "wrapadr")]
    #[doc(alias = "wrapnum")]
    wrap_range: {Range<usize>} = |tendon| range(tendon.owner.ten_wrapadr(), tendon.owner.ten_wrapnum(), tendon.index());
    /// Its path as it lies in space; empty for a fixed tendon.
    #[doc(alias = "wrap_obj")]
    #[doc(alias = "wrap_xpos")]
    wrap_points: {WrapPoints<'a>} = |tendon| {
        let range = tendon.wrap_range();
        let positions = tendon.owner.wrap_xpos().as_flattened().as_chunks().0;
        let objects = tendon.owner.wrap_obj().as_flattened();
        WrapPoints::new(&objects[range.clone()], &positions[range], tendon.owner.model().lineage())
    };
});

impl<'a> View<'a, Data, kind::Tendon> {
    fn jacobian_row(&self) -> Option<JacobianRow<'a>> {
        // Which layout the engine has written follows from the options, so that these must still be what they were then.
        if self.owner.stage() == Stage::Nothing {
            return None;
        }
        let (data, index, dofs) = (self.owner, self.index(), self.owner.model().nv());
        // SAFETY: a valid model, of which the engine reads the options and sizes.
        if unsafe { sys::mj_isSparse(data.model().as_ptr()) } == 0 {
            return Some(JacobianRow { values: data.ten_J().row(index), columns: None, dofs });
        }
        let row = range(data.ten_J_rowadr(), data.ten_J_rownnz(), index);
        let values = &data.ten_J().as_slice()[row.clone()];
        Some(JacobianRow { values, columns: Some(&data.ten_J_colind()[row]), dofs })
    }
}

/// A row of a Jacobian, as the engine keeps it: dense, or only the elements that are not zero.
#[derive(Clone, Copy)]
pub struct JacobianRow<'a> {
    values: &'a [f64],
    columns: Option<&'a [i32]>,
    dofs: usize,
}

impl<'a> JacobianRow<'a> {
    /// The elements that the engine keeps, each with its degree of freedom.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (usize, f64)> + 'a {
        let Self { values, columns, .. } = *self;
        (0..values.len()).map(move |at| (columns.map_or(at, |columns| ffi::size(columns[at])), values[at]))
    }

    /// Writes the whole row, zeros included. `(nv)`
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the slice has another length.
    pub fn write_into(&self, row: &mut [f64]) -> Result<()> {
        Error::check_length("the row of the Jacobian", row.len(), self.dofs)?;
        row.fill(0.0);
        for (dof, value) in self.iter() {
            row[dof] = value;
        }
        Ok(())
    }

    /// The whole row, zeros included. `(nv)`
    pub fn to_vec(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.dofs];
        for (dof, value) in self.iter() {
            row[dof] = value;
        }
        row
    }
}

impl fmt::Debug for JacobianRow<'_> {
    /// The degrees of freedom that it depends on, each with its element.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter().filter(|(_, value)| *value != 0.0)).finish()
    }
}
