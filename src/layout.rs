//! Values whose place in the engine's structs differs between versions, as slices and rows.

use std::ffi::c_int;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::ptr;

use mujoco_sys::{adapted, mjData, mjModel};

use crate::data::Data;
use crate::ffi;
use crate::model::{Model, ModelMut};

/// Row of a matrix of the engine.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    pub(crate) values: &'a [f64],
    /// Columns of the values, or `None` for a dense row.
    pub(crate) columns: Option<&'a [i32]>,
}

impl<'a> Row<'a> {
    /// Converts a row that `read` writes.
    ///
    /// # Safety
    ///
    /// `read` writes a row of initialised values, and of columns if it has some, which nothing
    /// changes during `'a`.
    unsafe fn read(read: impl FnOnce(*mut adapted::Row)) -> Self {
        let mut row = MaybeUninit::uninit();
        read(row.as_mut_ptr());
        // SAFETY: `read` has written the row.
        let adapted::Row { values, columns, count } = unsafe { row.assume_init() };
        let count = usize::try_from(count).unwrap_or(0);
        // SAFETY: the caller's promise.
        unsafe {
            let columns = (!columns.is_null()).then(|| ffi::array(columns, count));
            Self { values: ffi::array(values, count), columns }
        }
    }

    /// Returns the stored elements with their columns.
    pub(crate) fn iter(self) -> impl DoubleEndedIterator<Item = (usize, f64)> + 'a {
        let column = move |at: usize| self.columns.map_or(at, |columns| ffi::size(columns[at]));
        self.values.iter().enumerate().map(move |(at, &value)| (column(at), value))
    }

    /// Adds a multiple of the row to a dense row.
    pub(crate) fn add_to(self, row: &mut [f64], factor: f64) {
        if self.columns.is_none() {
            row.iter_mut().zip(self.values).for_each(|(row, value)| *row += factor * value);
        } else {
            self.iter().for_each(|(column, value)| row[column] += factor * value);
        }
    }

    /// Writes the dense row.
    pub(crate) fn write_into(self, row: &mut [f64]) {
        if self.columns.is_none() {
            row.copy_from_slice(self.values);
        } else {
            row.fill(0.0);
            self.iter().for_each(|(column, value)| row[column] = value);
        }
    }
}

impl Data {
    /// Returns the derivative of a length of an actuator with respect to each degree of freedom,
    /// from `actuator_moment`. The actuators have one output each, except those with several
    /// forces.
    pub(crate) fn moment_row(&self, output: usize) -> Row<'_> {
        let outputs = self.model().actuator_length0().len();
        assert!(output < outputs, "Bug: output {output} of {outputs}");
        // SAFETY: an output of the model. Zeroed arrays of a new data are rows without elements.
        unsafe { Row::read(|row| adapted::moment_row(self.model().as_ptr(), self.as_ptr(), output as c_int, row)) }
    }

    /// See [`Model::first_control`].
    #[inline]
    pub(crate) fn first_control(&self, actuator: usize) -> usize {
        self.model().first_control(actuator)
    }

    /// See [`Model::first_output`].
    #[inline]
    pub(crate) fn first_output(&self, actuator: usize) -> usize {
        self.model().first_output(actuator)
    }

    /// Returns the derivative of a tendon's length with respect to each degree of freedom, in the
    /// layout of the present options.
    pub(crate) fn tendon_row(&self, tendon: usize) -> Row<'_> {
        assert!(tendon < self.model().ntendon(), "Bug: tendon {tendon} of {}", self.model().ntendon());
        // SAFETY: a tendon of the model, whose arrays have the layout of its options.
        unsafe { Row::read(|row| adapted::tendon_row(self.model().as_ptr(), self.as_ptr(), tendon as c_int, row)) }
    }

    /// Returns the row of the factor L of the inertia matrix, without its diagonal of ones; `None`
    /// for engines that store it with `dof_Madr`.
    pub(crate) fn factor_row(&self, dof: usize) -> Option<Row<'_>> {
        self.triangle_row(dof, adapted::factor_row)
    }

    /// Returns the lower triangle of a row of the inertia matrix, with the diagonal element last;
    /// `None` for engines that store it with `dof_Madr`.
    pub(crate) fn inertia_row(&self, dof: usize) -> Option<Row<'_>> {
        self.triangle_row(dof, adapted::inertia_row)
    }

    /// Reads a row by one of these two functions.
    fn triangle_row(
        &self,
        dof: usize,
        read: unsafe extern "C" fn(*const mjModel, *const mjData, c_int, *mut adapted::Row),
    ) -> Option<Row<'_>> {
        assert!(dof < self.model().nv(), "Bug: degree of freedom {dof} of {}", self.model().nv());
        let mut is_known = false;
        // SAFETY: a degree of freedom of the model, whose sparse rows the compiler has made.
        let row = unsafe {
            Row::read(|row| {
                read(self.model().as_ptr(), self.as_ptr(), dof as c_int, row);
                is_known = (*row).count >= 0;
            })
        };
        is_known.then_some(row)
    }

    /// Returns the address of the first stored element of a row of the inertia matrix, and the row
    /// as by [`inertia_row`](Self::inertia_row).
    pub(crate) fn inertia_place(&self, dof: usize) -> (usize, Option<Row<'_>>) {
        let row = self.inertia_row(dof);
        let start = match &row {
            // The row is a part of the elements.
            Some(row) => (row.values.as_ptr().addr() - self.inertia_elements().as_ptr().addr()) / size_of::<f64>(),
            None => ffi::size(self.model().dof_Madr()[dof]),
        };
        (start, row)
    }

    /// Returns the stored elements of the inertia matrix.
    pub(crate) fn inertia_elements(&self) -> &[f64] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::inertia(self.as_ptr()), self.model().inertia_len()) }
    }

    /// Returns the state of the plugins.
    pub(crate) fn plugin_state_values(&self) -> &[f64] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::plugin_state(self.as_ptr()), self.model().plugin_state_len()) }
    }

    /// Returns the state of the plugins for writing.
    pub(crate) fn plugin_state_values_mut(&mut self) -> &mut [f64] {
        let length = self.model().plugin_state_len();
        // SAFETY: as above, and the data is borrowed exclusively.
        unsafe { ffi::array_mut(adapted::plugin_state(self.as_mut_ptr()), length) }
    }

    /// Returns the plastic deformation of the flexes.
    pub(crate) fn plastic_values(&self) -> &[f64] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::plastic(self.as_ptr()), self.model().plastic_len()) }
    }

    /// Returns the plastic deformation of the flexes for writing.
    pub(crate) fn plastic_values_mut(&mut self) -> &mut [f64] {
        let length = self.model().plastic_len();
        // SAFETY: as above, and the data is borrowed exclusively.
        unsafe { ffi::array_mut(adapted::plastic(self.as_mut_ptr()), length) }
    }

    /// Returns `true` if an equality constraint is enforced.
    pub(crate) fn is_equality_enforced(&self, equality: usize) -> bool {
        assert!(equality < self.model().neq(), "Bug: equality constraint {equality} of {}", self.model().neq());
        // SAFETY: a constraint of the model.
        unsafe { adapted::equality_enforced(self.model().as_ptr(), self.as_ptr(), equality as c_int) != 0 }
    }

    /// Returns the statistics of the solver's recorded iterations for an island of constraints.
    pub(crate) fn solver_statistics(&self, island: usize) -> &[mujoco_sys::mjSolverStat] {
        let mut statistics = ptr::null();
        let island = c_int::try_from(island).unwrap_or(c_int::MAX);
        // SAFETY: the count is at most the length of the island's part of the array in the struct.
        unsafe {
            let count = adapted::solver_iterations(self.as_ptr(), island, &raw mut statistics);
            ffi::array(statistics, usize::try_from(count).unwrap_or(0))
        }
    }
}

impl Model {
    /// Returns the number of stored elements of the inertia matrix.
    pub(crate) fn inertia_len(&self) -> usize {
        // SAFETY: a valid model, of which the function reads a size.
        ffi::size(unsafe { adapted::inertia_len(self.as_ptr()) })
    }

    /// Returns the length of the state of the plugins.
    pub(crate) fn plugin_state_len(&self) -> usize {
        // SAFETY: a valid model, of which the function reads a size.
        unsafe { adapted::plugin_state_len(self.as_ptr()) }
    }

    /// Returns the length of the plastic deformation of the flexes.
    pub(crate) fn plastic_len(&self) -> usize {
        // SAFETY: as above.
        unsafe { adapted::plastic_len(self.as_ptr()) }
    }

    /// Returns the flags of the equality constraints that are enforced, or enforced initially.
    pub(crate) fn equality_active(&self) -> &[u8] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::equality_active(self.as_ptr()), self.neq()) }
    }

    /// Returns `true` if an equality constraint couples sites instead of bodies.
    pub(crate) fn couples_sites(&self, equality: usize) -> bool {
        assert!(equality < self.neq(), "Bug: equality constraint {equality} of {}", self.neq());
        // SAFETY: a constraint of the model.
        unsafe { adapted::equality_couples_sites(self.as_ptr(), equality as c_int) != 0 }
    }

    /// Returns the address of an actuator's activation.
    pub(crate) fn activation_of(&self, actuator: usize) -> Option<usize> {
        assert!(actuator < self.nactuator(), "Bug: actuator {actuator} of {}", self.nactuator());
        // SAFETY: an actuator of the model.
        usize::try_from(unsafe { adapted::activation(self.as_ptr(), actuator as c_int) }).ok()
    }

    /// Returns the actuator that has an activation.
    pub(crate) fn actuator_of_activation(&self, activation: usize) -> usize {
        let has = |&actuator: &usize| self.activations_of(actuator).contains(&activation);
        (0..self.nactuator()).find(has).expect("Bug: an activation without an actuator")
    }

    /// Returns the actuator that has a control.
    pub(crate) fn actuator_of_control(&self, control: usize) -> usize {
        let has = |&actuator: &usize| self.controls_of(actuator).contains(&control);
        (0..self.nactuator()).find(has).expect("Bug: a control without an actuator")
    }

    /// Returns the index of the first control of an actuator.
    #[inline]
    #[cfg_attr(
        not(engine_since = "3.17.0"),
        allow(clippy::unused_self, reason = "the model of newer engines has the place")
    )]
    pub(crate) fn first_control(&self, actuator: usize) -> usize {
        #[cfg(engine_since = "3.17.0")]
        return ffi::size(self.actuator_ctrladr()[actuator]);
        #[cfg(not(engine_since = "3.17.0"))]
        actuator
    }

    /// Returns the index of the first force and length of an actuator.
    #[inline]
    #[cfg_attr(
        not(engine_since = "3.17.0"),
        allow(clippy::unused_self, reason = "the model of newer engines has the place")
    )]
    pub(crate) fn first_output(&self, actuator: usize) -> usize {
        #[cfg(engine_since = "3.17.0")]
        return ffi::size(self.actuator_outadr()[actuator]);
        #[cfg(not(engine_since = "3.17.0"))]
        actuator
    }

    /// Returns the indices of the controls of an actuator.
    #[inline]
    pub(crate) fn controls_of(&self, actuator: usize) -> Range<usize> {
        #[cfg(engine_since = "3.17.0")]
        let count = ffi::size(self.actuator_ctrlnum()[actuator]);
        #[cfg(not(engine_since = "3.17.0"))]
        let count = 1;
        let first = self.first_control(actuator);
        first..first + count
    }

    /// Returns the indices of the forces and lengths of an actuator.
    #[inline]
    pub(crate) fn outputs_of(&self, actuator: usize) -> Range<usize> {
        #[cfg(engine_since = "3.17.0")]
        let count = ffi::size(self.actuator_outnum()[actuator]);
        #[cfg(not(engine_since = "3.17.0"))]
        let count = 1;
        let first = self.first_output(actuator);
        first..first + count
    }

    /// Returns the indices of the activations of an actuator.
    pub(crate) fn activations_of(&self, actuator: usize) -> Range<usize> {
        let Some(first) = self.activation_of(actuator) else { return 0..0 };
        #[cfg(engine_since = "2.3.7")]
        let count = ffi::size(self.actuator_actnum()[actuator]);
        #[cfg(not(engine_since = "2.3.7"))]
        let count = 1;
        first..first + count
    }

    /// Returns `true` if an actuator has several controls, forces or activations.
    pub(crate) fn has_several_controls(&self) -> bool {
        let actuators = self.nactuator();
        self.nu() != actuators
            || self.actuator_length0().len() != actuators
            || (0..actuators).any(|actuator| self.activations_of(actuator).len() > 1)
    }

    /// Returns the places of the normals and texture coordinates of a mesh.
    pub(crate) fn mesh_faces(&self, mesh: usize) -> adapted::MeshFaces {
        assert!(mesh < self.nmesh(), "Bug: mesh {mesh} of {}", self.nmesh());
        let mut faces = MaybeUninit::uninit();
        // SAFETY: a mesh of the model. The function writes the complete struct.
        unsafe {
            adapted::mesh_faces(self.as_ptr(), mesh as c_int, faces.as_mut_ptr());
            faces.assume_init()
        }
    }

    /// Returns the pixels of all textures.
    pub(crate) fn texture_bytes(&self) -> &[u8] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::texture_bytes(self.as_ptr()), self.ntexdata()) }
    }

    /// Returns the number of bytes of a texture's pixels.
    pub(crate) fn texture_channels(&self, texture: usize) -> usize {
        assert!(texture < self.ntex(), "Bug: texture {texture} of {}", self.ntex());
        // SAFETY: a texture of the model.
        ffi::size(unsafe { adapted::texture_channels(self.as_ptr(), texture as c_int) })
    }

    /// Returns the texture for the colour of a material.
    pub(crate) fn material_texture(&self, material: usize) -> Option<usize> {
        assert!(material < self.nmat(), "Bug: material {material} of {}", self.nmat());
        // SAFETY: a material of the model.
        usize::try_from(unsafe { adapted::material_texture(self.as_ptr(), material as c_int) }).ok()
    }

    /// Returns the texture of a material that a renderer draws: the texture of the base colour.
    pub(crate) fn drawn_texture(&self, material: usize) -> Option<usize> {
        assert!(material < self.nmat(), "Bug: material {material} of {}", self.nmat());
        // SAFETY: a material of the model.
        usize::try_from(unsafe { adapted::drawn_texture(self.as_ptr(), material as c_int) }).ok()
    }

    /// Returns `true` if the engine converts the pixels of a texture from the sRGB colour space to
    /// linear colours.
    #[cfg(any(feature = "renderer", feature = "html", feature = "gltf"))]
    pub(crate) fn texture_is_srgb(&self, texture: usize) -> bool {
        assert!(texture < self.ntex(), "Bug: texture {texture} of {}", self.ntex());
        // SAFETY: a texture of the model.
        unsafe { adapted::texture_is_srgb(self.as_ptr(), texture as c_int) != 0 }
    }

    /// Returns `true` for a directional light.
    pub(crate) fn is_directional(&self, light: usize) -> bool {
        assert!(light < self.nlight(), "Bug: light {light} of {}", self.nlight());
        // SAFETY: a light of the model.
        unsafe { adapted::light_directional(self.as_ptr(), light as c_int) != 0 }
    }

    /// Returns the two ends of the rest length of a tendon's spring.
    pub(crate) fn tendon_rest_length(&self, tendon: usize) -> [f64; 2] {
        assert!(tendon < self.ntendon(), "Bug: tendon {tendon} of {}", self.ntendon());
        let mut count = 0;
        // SAFETY: a tendon of the model, which has one or two numbers.
        let lengths = unsafe {
            let lengths = adapted::tendon_rest_length(self.as_ptr(), tendon as c_int, &raw mut count);
            ffi::array(lengths.cast_const(), ffi::size(count))
        };
        [lengths[0], lengths[lengths.len() - 1]]
    }
}

impl ModelMut<'_> {
    /// Sets whether an equality constraint is enforced, or enforced initially.
    pub(crate) fn set_equality_active(&mut self, equality: usize, active: bool) {
        let length = self.neq();
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively.
        let flags = unsafe { ffi::array_mut(adapted::equality_active(self.as_ptr()), length) };
        flags[equality] = active.into();
    }

    /// Returns the pixels of all textures for writing.
    pub(crate) fn texture_bytes_mut(&mut self) -> &mut [u8] {
        let length = self.ntexdata();
        // SAFETY: the engine allocated the array with this length, the model is borrowed
        // exclusively, and any byte is a colour.
        unsafe { ffi::array_mut(adapted::texture_bytes(self.as_ptr()), length) }
    }

    /// Sets the index of the material of a geom.
    pub(crate) fn set_geom_material(&mut self, geom: usize, material: Option<usize>) {
        let (length, materials) = (self.ngeom(), self.nmat());
        assert!(material.is_none_or(|index| index < materials), "Bug: material {material:?} of {materials}");
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively. The index is that of a material, or −1 for none.
        let indices = unsafe { ffi::array_mut(self.raw_mut().geom_matid, length) };
        indices[geom] = material.map_or(-1, |index| index as c_int);
    }

    /// Makes a light directional, or else a spotlight.
    pub(crate) fn set_is_directional(&mut self, light: usize, directional: bool) {
        assert!(light < self.nlight(), "Bug: light {light} of {}", self.nlight());
        // SAFETY: a light of the model, which is borrowed exclusively.
        unsafe { adapted::set_light_directional(self.raw_mut(), light as c_int, directional.into()) };
    }

    /// Sets both ends of the rest length of a tendon's spring.
    pub(crate) fn set_tendon_rest_length(&mut self, tendon: usize, [low, high]: [f64; 2]) {
        assert!(tendon < self.ntendon(), "Bug: tendon {tendon} of {}", self.ntendon());
        let mut count = 0;
        // SAFETY: a tendon of the model, which has one or two numbers, and the model is borrowed
        // exclusively.
        let lengths = unsafe {
            let lengths = adapted::tendon_rest_length(self.as_ptr(), tendon as c_int, &raw mut count);
            ffi::array_mut(lengths, ffi::size(count))
        };
        lengths[0] = low;
        *lengths.last_mut().expect("Bug: a tendon without a rest length") = high;
    }
}
