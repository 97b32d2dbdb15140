//! Tendons and rows of their Jacobian.

#![allow(non_snake_case, reason = "J: the engine's own spelling")]

use std::fmt;
use std::ops::Range;

use super::{View, ViewMut, WrapPoints, Wraps, range};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::MaterialId;
use crate::kind;
use crate::layout::Row;
use crate::model::{Model, ModelMut};

/// # Methods of [`TendonData`](super::TendonData)
impl<'a> View<'a, Data, kind::Tendon> {
    fn jacobian_row(&self) -> Option<JacobianRow<'a>> {
        // The options determine the layout that the engine has written, so they must not have
        // changed since.
        if self.owner.stage() == Stage::None {
            return None;
        }
        Some(JacobianRow::new(self.owner.tendon_row(self.index()), self.owner.model().nv()))
    }
}

fields!(Tendon on Model {
    /// Elements of the path: sites, geoms and pulleys of a spatial tendon, joints of a fixed
    /// tendon.
    #[doc(alias = "adr")]
    #[doc(alias = "num")]
    path: {Wraps<'a>} = |tendon| {
        Wraps::new(tendon.owner, range(tendon.owner.tendon_adr(), tendon.owner.tendon_num(), tendon.index()))
    };
    /// Material, if any.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |tendon| tendon.optional_id_in(tendon.owner.tendon_matid());
    /// Visualisation group.
    group: i32 = tendon_group, set_group;
    /// Returns `true` if [`range`](Self::range) is enforced. A tendon compiled without a limit has
    /// the range `[0, 0]` until one is set.
    limited: bool = tendon_limited, set_limited;
    /// Width for visualisation, m.
    width: f64 = tendon_width, set_width in tendon_width_mut;
    /// Limits of the length, m.
    range: [f64; 2] = tendon_range, range_mut in tendon_range_mut;
    /// Distance from a limit at which the limit constraint becomes active.
    margin: f64 = tendon_margin, set_margin in tendon_margin_mut;
    /// Stiffness of the spring, N/m.
    stiffness: f64 = tendon_stiffness, set_stiffness in tendon_stiffness_mut;
    /// Damping, N·s/m.
    damping: f64 = tendon_damping, set_damping in tendon_damping_mut;
    /// Dry friction, N.
    frictionloss: f64 = tendon_frictionloss, set_frictionloss in tendon_frictionloss_mut;
    /// Rest length of the spring, m. Since 2.3 the spring can have a range of rest lengths, of
    /// which this is the lower end.
    lengthspring: {f64} = |tendon| tendon.owner.tendon_rest_length(tendon.index())[0];
    /// Length in the reference configuration, m.
    length0: f64 = tendon_length0;
    /// Inverse inertia in the reference configuration.
    invweight0: f64 = tendon_invweight0;
    /// Solver reference parameters of the limit: time constant and damping ratio.
    solref_lim: [f64; 2] = tendon_solref_lim, solref_lim_mut in tendon_solref_lim_mut;
    /// Solver impedance parameters of the limit.
    solimp_lim: [f64; 5] = tendon_solimp_lim, solimp_lim_mut in tendon_solimp_lim_mut;
    /// Solver reference parameters of the dry friction: time constant and damping ratio.
    solref_fri: [f64; 2] = tendon_solref_fri, solref_fri_mut in tendon_solref_fri_mut;
    /// Solver impedance parameters of the dry friction.
    solimp_fri: [f64; 5] = tendon_solimp_fri, solimp_fri_mut in tendon_solimp_fri_mut;
    /// Red, green, blue and opacity, used without a material.
    rgba: [f32; 4] = tendon_rgba, rgba_mut in tendon_rgba_mut;
    /// User data.
    user: [f64] = tendon_user, user_mut in tendon_user_mut;
});

/// # Methods of [`TendonMut`](super::TendonMut)
impl ViewMut<'_, ModelMut<'_>, kind::Tendon> {
    /// Sets `lengthspring`, both ends of the range if it is one.
    pub fn set_lengthspring(&mut self, value: f64) {
        let index = self.id.index();
        self.owner.set_tendon_rest_length(index, [value; 2]);
    }
}

fields!(Tendon on Data {
    /// Length, m.
    length: f64 = ten_length;
    /// Velocity, m/s.
    velocity: f64 = ten_velocity;
    /// Derivative of the length with respect to each degree of freedom. `None` unless computed for
    /// the present model.
    J: {Option<JacobianRow<'a>>} = |tendon| tendon.jacobian_row();
    /// Range of its path in the points of all paths.
    #[doc(alias = "wrapadr")]
    #[doc(alias = "wrapnum")]
    wrap_range: {Range<usize>} = |tendon| range(tendon.owner.ten_wrapadr(), tendon.owner.ten_wrapnum(), tendon.index());
    /// Points of the path in space; empty for a fixed tendon.
    #[doc(alias = "wrap_obj")]
    #[doc(alias = "wrap_xpos")]
    wrap_points: {WrapPoints<'a>} = |tendon| {
        let range = tendon.wrap_range();
        let positions = tendon.owner.wrap_xpos().as_flattened().as_chunks().0;
        let objects = tendon.owner.wrap_obj().as_flattened();
        WrapPoints::new(&objects[range.clone()], &positions[range], tendon.owner.model().lineage())
    };
});

/// Row of a Jacobian in the engine's layout: dense, or sparse.
#[derive(Clone, Copy)]
pub struct JacobianRow<'a> {
    values: &'a [f64],
    columns: Option<&'a [i32]>,
    dofs: usize,
}

impl<'a> JacobianRow<'a> {
    pub(super) fn new(row: Row<'a>, dofs: usize) -> Self {
        Self { values: row.values, columns: row.columns, dofs }
    }

    /// Returns an iterator over the stored elements, each with its degree of freedom.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (usize, f64)> + 'a {
        let Self { values, columns, .. } = *self;
        (0..values.len()).map(move |at| (columns.map_or(at, |columns| ffi::size(columns[at])), values[at]))
    }

    /// Writes the dense row, including zeros. `(nv)`
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the length of the slice is not `nv`.
    pub fn write_into(&self, row: &mut [f64]) -> Result<()> {
        Error::check_length("the row of the Jacobian", row.len(), self.dofs)?;
        row.fill(0.0);
        self.iter().for_each(|(dof, value)| row[dof] = value);
        Ok(())
    }

    /// Returns the dense row, including zeros. `(nv)`
    pub fn to_vec(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.dofs];
        self.iter().for_each(|(dof, value)| row[dof] = value);
        row
    }
}

impl fmt::Debug for JacobianRow<'_> {
    /// Formats the non-zero elements, each with its degree of freedom.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter().filter(|(_, value)| *value != 0.0)).finish()
    }
}
