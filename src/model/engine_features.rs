//! Features of newer engines that this crate does not support yet. A model that uses one is
//! rejected when it is loaded.

use std::ops::Range;

use mujoco_sys::{guard, mjENBL_IPC, mjGEOM_SDF, mjMAXCONPAIR, mjOBJ_BODY, mjTRN_SLIDERCRANK, mjWRAP_JOINT};

use super::engine_limits::measures_distance;
use super::xml_guard::{MOST_BODIES, MOST_DOFS};
use super::{Model, Options};
use crate::enums::{
    ActuatorBias, ActuatorDynamics, ActuatorGain, CameraMode, Cone, EqualityType, GeomType, Integrator,
    JacobianStorage, JointType, SameFrame, SensorDataType, SensorType, Solver, TextureType, TransmissionType, WrapType,
};
use crate::ffi;
use crate::version::built_against;

impl Model {
    /// Returns the reason why a compiled model is not supported. Applies the rules for binary
    /// models to it, if they are known for the engine.
    pub(super) fn validate(&self) -> Result<(), String> {
        #[cfg(validates_binaries)]
        self.validate_binary()?;
        self.validate_features()
    }

    /// Returns the reason why a model is not supported. The types of all elements are known
    /// afterwards, and actuators have at least one control and one force.
    pub(super) fn validate_features(&self) -> Result<(), String> {
        let version = built_against();
        let unsupported =
            |what: String| Err(format!("{what}; mujoco-safe does not support this with MuJoCo {version}"));
        // State vectors do not contain the state of these contacts.
        if self.raw().opt.enableflags as u32 & mjENBL_IPC != 0 {
            return unsupported("the option ipc is enabled".to_owned());
        }
        self.unsafe_sleep().map_or(Ok(()), unsupported)?;
        // Between these versions the controls of an actuator are in places that no test has
        // examined.
        if cfg!(not(engine_since = "3.17.0")) && self.actuator_length0().len() != self.nu() {
            return unsupported("an actuator has several controls".to_owned());
        }
        let lacks = |&actuator: &usize| self.controls_of(actuator).is_empty() || self.outputs_of(actuator).is_empty();
        if let Some(actuator) = (0..self.nactuator()).find(lacks) {
            return unsupported(format!("actuator {actuator} has no control or no force"));
        }
        self.unknown_type().map_or(Ok(()), unsupported)?;
        self.changed_distance().map_or(Ok(()), unsupported)?;
        self.coupled_slides().map_or(Ok(()), unsupported)?;
        // The engine reads the length of a crank at the index of the force instead of the index of
        // the actuator.
        let is_misread = |&actuator: &usize| {
            let is_crank = self.actuator_trntype()[actuator] as u32 == mjTRN_SLIDERCRANK;
            is_crank && self.outputs_of(actuator).start != actuator
        };
        let misread = (0..self.nactuator()).find(is_misread).filter(|_| cfg!(not(engine_since = "4.0.0")));
        if let Some(actuator) = misread {
            return unsupported(format!(
                "actuator {actuator} is a slider-crank behind an actuator with several forces"
            ));
        }
        self.check_addresses().map_err(|error| error.to_string())?;
        self.check_limits()
    }

    /// Checks the rules for 2.2.2 that do not depend on the layout of a binary model: a step
    /// terminates, and stays within its arrays.
    fn check_limits(&self) -> Result<(), String> {
        let opt = &self.raw().opt;
        if !(opt.timestep.is_finite() && opt.timestep > 0.0) {
            return Err(format!("opt.timestep is {}; it must be finite and positive", opt.timestep));
        }
        if self.nbody() > MOST_BODIES || self.nv() > MOST_DOFS {
            return Err(format!("the model has more than {MOST_BODIES} bodies or {MOST_DOFS} degrees of freedom"));
        }
        let options = self.options();
        let iterations = [
            options.iterations,
            options.ls_iterations,
            options.noslip_iterations,
            options.mpr_iterations,
            options.sdf_initpoints,
            options.sdf_iterations,
        ];
        if let Some(count) = iterations.into_iter().find(|&count| count > Options::MOST_ITERATIONS) {
            return Err(format!("a solver has {count} iterations; at most a million are allowed"));
        }
        self.check_distances(options.mpr_iterations)?;
        if cfg!(engine_since = "3.0.0") && options.mpr_iterations < 1 {
            // The solver has space for its first polytope only if it may iterate.
            return Err(format!(
                "the collision solver has {} iterations; at least 1 is needed",
                options.mpr_iterations
            ));
        }
        // The collision functions for signed distance fields write a contact for each point, at
        // least one, into arrays of this length.
        let points = 1..=mjMAXCONPAIR as usize;
        if self.geom_type().contains(&(mjGEOM_SDF as i32)) && !points.contains(&options.sdf_initpoints) {
            return Err(format!("sdf_initpoints is {}; it must be from 1 to {mjMAXCONPAIR}", options.sdf_initpoints));
        }
        for tendon in 0..self.ntendon() {
            let start = ffi::size(self.tendon_adr()[tendon]);
            let path = start..start + ffi::size(self.tendon_num()[tendon]);
            let mut joints: Vec<i32> = path
                .filter(|&at| self.wrap_type()[at] == mjWRAP_JOINT as i32)
                .map(|at| self.wrap_objid()[at])
                .collect();
            let count = joints.len();
            joints.sort_unstable();
            joints.dedup();
            if joints.len() < count {
                return Err(format!(
                    "fixed tendon {tendon} has a joint twice, on which some engines write out of bounds"
                ));
            }
        }
        self.check_skins()?;
        self.check_flexes()
    }

    /// Checks that the faces of skins refer to vertices of the skin, which the visualiser assumes
    /// and compilers before 4.0 do not check.
    fn check_skins(&self) -> Result<(), String> {
        for skin in 0..self.nskin() {
            let vertices = self.skin_vertnum()[skin];
            let start = ffi::size(self.skin_faceadr()[skin]);
            let faces = start..start + ffi::size(self.skin_facenum()[skin]);
            let indices = self.skin_face()[faces].as_flattened();
            if let Some(at) = indices.iter().position(|index| !(0..vertices).contains(index)) {
                let (at, index) = (3 * start + at, indices[at]);
                return Err(format!("skin_face[{at}] is {index}; it must be from 0 to {}", vertices - 1));
            }
        }
        Ok(())
    }

    /// Checks that the elements, the shell and the texture coordinates of flexes are inside the
    /// arrays of the flex, which the visualiser assumes. It uses the vertices of a shell also as
    /// indices of texture coordinates.
    #[cfg(engine_since = "3.3.0")]
    fn check_flexes(&self) -> Result<(), String> {
        let starts = self.flex_texcoordadr();
        for flex in 0..self.nflex() {
            let vertices = self.flex_vertnum()[flex];
            let next = starts[flex + 1..].iter().find(|&&start| start >= 0);
            let coordinates = next.map_or(self.nflextexcoord() as i32, |&start| start) - starts[flex];
            let has_texture = starts[flex] >= 0;
            let (corners, dim) = (self.flex_dim()[flex] + 1, self.flex_dim()[flex]);
            let elements = (self.flex_elemdataadr()[flex], self.flex_elemnum()[flex] * corners);
            let shell = (self.flex_shelldataadr()[flex].max(0), self.flex_shellnum()[flex] * dim);
            let drawn = if has_texture && dim > 1 { coordinates.min(vertices) } else { vertices };
            let indices = self.flex_elem();
            // Engines before 3.3.1 use the indices of vertices.
            #[cfg(engine_since = "3.3.1")]
            let textured = self.flex_elemtexcoord();
            #[cfg(not(engine_since = "3.3.1"))]
            let textured = indices;
            for (name, array, (start, count), end) in [
                ("flex_elem", indices, elements, vertices),
                ("flex_shell", self.flex_shell(), shell, drawn),
                ("flex_elemtexcoord", textured, elements, if has_texture { coordinates } else { i32::MAX }),
            ] {
                let start = ffi::size(start);
                let range = &array[start..start + ffi::size(count)];
                if let Some(at) = range.iter().position(|index| !(0..end).contains(index)) {
                    let (at, index) = (start + at, range[at]);
                    return Err(format!("{name}[{at}] is {index}; it must be from 0 to {}", end - 1));
                }
            }
        }
        Ok(())
    }

    #[cfg(not(engine_since = "3.3.0"))]
    #[allow(
        clippy::unused_self,
        clippy::unnecessary_wraps,
        reason = "older engines have no indices of texture coordinates"
    )]
    fn check_flexes(&self) -> Result<(), String> {
        Ok(())
    }

    /// Returns a description of the first sensor of distances that the engine would measure by
    /// another method than its own, whose results can be wrong by more than the geoms' sizes: see
    /// `mujoco-sys/shim/interpose.c`.
    fn changed_distance(&self) -> Option<String> {
        let types = |kind: i32, id: i32| {
            let id = ffi::size(id);
            let geoms = if kind as u32 == mjOBJ_BODY { self.geoms_of(id) } else { id..id + 1 };
            geoms.map(|geom| self.geom_type()[geom])
        };
        let objects = |sensor: usize| {
            let object = types(self.sensor_objtype()[sensor], self.sensor_objid()[sensor]);
            let reference = types(self.sensor_reftype()[sensor], self.sensor_refid()[sensor]);
            object.flat_map(move |object| reference.clone().map(move |reference| (object, reference)))
        };
        // SAFETY: no preconditions.
        let changes = |(object, reference)| unsafe { guard::changes_distance(object, reference) != 0 };
        let mut sensors = (0..self.nsensor()).filter(|&sensor| measures_distance(self.sensor_type()[sensor]));
        let sensor = sensors.find(|&sensor| objects(sensor).any(changes))?;
        Some(format!(
            "sensor {sensor} measures the distance of shapes whose collision function this crate replaces in this \
             program, which would change the reading (Data::geom_distance is right)"
        ))
    }

    /// Returns the geoms of a body.
    pub(super) fn geoms_of(&self, body: usize) -> Range<usize> {
        let start = usize::try_from(self.body_geomadr()[body]).unwrap_or(0);
        start..start + ffi::size(self.body_geomnum()[body])
    }

    /// Returns a description of the first element whose type the enums do not have.
    fn unknown_type(&self) -> Option<String> {
        let opt = &self.raw().opt;
        let first = |what: &str, types: &[i32], is_known: &dyn Fn(i32) -> bool| {
            let index = types.iter().position(|&raw| !is_known(raw))?;
            Some(format!("{what} {index} has the type {}", types[index]))
        };
        let frames = |what: &str, frames: &[u8]| {
            let index = frames.iter().position(|&raw| SameFrame::from_raw(raw).is_none())?;
            Some(format!("{what} {index} has the flag sameframe {}", frames[index]))
        };
        macro_rules! known {
            ($what:literal, $types:expr, $enum:ident) => {
                first($what, $types, &|raw| $enum::from_raw(raw).is_some())
            };
        }
        known!("option integrator", &[opt.integrator], Integrator)
            .or_else(|| known!("option cone", &[opt.cone], Cone))
            .or_else(|| known!("option jacobian", &[opt.jacobian], JacobianStorage))
            .or_else(|| known!("option solver", &[opt.solver], Solver))
            .or_else(|| known!("joint", self.jnt_type(), JointType))
            .or_else(|| known!("geom", self.geom_type(), GeomType))
            .or_else(|| known!("site", self.site_type(), GeomType))
            .or_else(|| known!("camera", self.cam_mode(), CameraMode))
            .or_else(|| known!("light", self.light_mode(), CameraMode))
            .or_else(|| known!("texture", self.tex_type(), TextureType))
            .or_else(|| known!("tendon path element", self.wrap_type(), WrapType))
            .or_else(|| known!("transmission of actuator", self.actuator_trntype(), TransmissionType))
            .or_else(|| known!("dynamics of actuator", self.actuator_dyntype(), ActuatorDynamics))
            .or_else(|| known!("gain of actuator", self.actuator_gaintype(), ActuatorGain))
            .or_else(|| known!("bias of actuator", self.actuator_biastype(), ActuatorBias))
            .or_else(|| known!("equality constraint", self.eq_type(), EqualityType))
            .or_else(|| known!("sensor", self.sensor_type(), SensorType))
            .or_else(|| known!("data of sensor", self.sensor_datatype(), SensorDataType))
            .or_else(|| frames("geom", self.geom_sameframe()))
            .or_else(|| frames("site", self.site_sameframe()))
    }
}
