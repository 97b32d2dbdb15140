//! Height fields: elevations over a grid.

use std::ops::Range;

use nalgebra::{DMatrixView, Dyn};

use super::{View, ViewMut};
use crate::ffi;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(HeightField on Model {
    /// Half its extent along x and along y, its largest elevation, and the depth of its base below, m.
    size: [f64; 4] = hfield_size;
    /// How many rows of elevations it has, along y.
    nrow: {usize} = |field| ffi::size(field.owner.hfield_nrow()[field.index()]);
    /// How many columns of elevations it has, along x.
    ncol: {usize} = |field| ffi::size(field.owner.hfield_ncol()[field.index()]);
    /// Where its elevations are in `hfield_data`.
    #[doc(alias = "adr")]
    data_range: {Range<usize>} = |field| {
        let start = ffi::size(field.owner.hfield_adr()[field.index()]);
        start..start + field.nrow() * field.ncol()
    };
    /// Its elevations, row by row, as fractions of the largest. `(nrow · ncol)`
    data: [f32] = hfield_data at data_range, data_mut in hfield_data_mut;
});

impl<'a> View<'a, Model, kind::HeightField> {
    /// Its elevations as a matrix `(nrow, ncol)`: a view of the engine's memory, not a copy.
    ///
    /// ```
    /// use mujoco_safe::Model;
    ///
    /// let mut model = Model::from_xml_str(
    ///     "<mujoco><asset><hfield name='hills' nrow='2' ncol='3' size='1 1 0.5 0.1'/></asset></mujoco>",
    /// )?;
    /// model.edit().height_field_mut("hills")?.data_mut()[5] = 0.25;
    /// let hills = model.height_field("hills")?;
    /// assert_eq!(hills.matrix().shape(), (2, 3));
    /// assert_eq!(hills.matrix()[(1, 2)], 0.25);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn matrix(&self) -> DMatrixView<'a, f32, Dyn, Dyn> {
        let (rows, columns) = (self.nrow(), self.ncol());
        DMatrixView::from_slice_with_strides(self.data(), rows, columns, columns, 1)
    }
}
