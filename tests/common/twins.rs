//! Twins: a simulation through the library and a simulation through the C API, with the same
//! inputs.

use std::sync::{Arc, OnceLock};

use mujoco_safe::sys::{self, mjData, mjModel};
use mujoco_safe::{Controller, Data, Model, RandomController, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cases::cases;
use crate::installed::sample_files;

#[path = "differing.rs"]
pub(crate) mod differing;

/// A direct call of the C API.
macro_rules! c {
    ($function:ident($($argument:expr),* $(,)?)) => {
        // SAFETY: every test passes the model and data of one pair of twins, and arrays of the
        // engine's sizes.
        unsafe { mujoco_safe::sys::$function($($argument),*) }
    };
}
pub(crate) use c;

/// A model for comparisons.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) model: Arc<Model>,
}

const ZOO_XML: &str = include_str!("../models/zoo.xml");

/// Returns the bundled models, the zoo and the engine's models, loaded once.
pub(crate) fn subjects() -> &'static [Subject] {
    static SUBJECTS: OnceLock<Vec<Subject>> = OnceLock::new();
    SUBJECTS.get_or_init(|| {
        let zoo = Model::from_xml_str(ZOO_XML).unwrap();
        let mut subjects: Vec<_> = [("cartpole", sample::cartpole()), ("humanoid", sample::humanoid()), ("zoo", zoo)]
            .map(|(name, model)| Subject { name: name.to_owned(), model: Arc::new(model) })
            .into();
        // Newer compilers lack these composite objects.
        #[cfg(not(engine_since = "2.3.0"))]
        {
            let model = Model::from_xml_str(include_str!("../models/composites.xml")).unwrap();
            subjects.push(Subject { name: "composites".to_owned(), model: Arc::new(model) });
        }
        for path in sample_files() {
            let name = path.strip_prefix(sample::SYSTEM_MODELS).unwrap_or(&path).display().to_string();
            match Model::from_xml_path(&path) {
                Ok(model) => subjects.push(Subject { name, model: Arc::new(model) }),
                Err(error) => println!("skipped {name}, which does not load by itself: {error}"),
            }
        }
        subjects
    })
}

/// Returns the models with up to 200 degrees of freedom, with all cases up to 1000: simulations of
/// larger ones take hundreds of megabytes each.
pub(crate) fn usual_subjects() -> impl Iterator<Item = &'static Subject> {
    subjects().iter().filter(|subject| subject.model.nv() <= cases(200, 1000))
}

/// Returns models small enough for computations of quadratic cost.
pub(crate) fn small_subjects() -> impl Iterator<Item = &'static Subject> {
    subjects().iter().filter(|subject| subject.model.nv() <= 50)
}

/// Returns `length` values of an engine array from `start` on.
///
/// # Safety
///
/// The array has at least `start + length` values.
pub(crate) unsafe fn read<T: Copy>(array: *const T, start: usize, length: usize) -> Vec<T> {
    let mut values = Vec::with_capacity(length);
    // An empty array of the engine can be null.
    if length > 0 {
        // SAFETY: the caller guarantees the length of the array, and the vector has room for as
        // many values, which are initialised then.
        unsafe {
            std::ptr::copy_nonoverlapping(array.add(start), values.as_mut_ptr(), length);
            values.set_len(length);
        }
    }
    values
}

/// Returns the bits of numbers, whose comparison takes less time in a build without optimisation
/// than that of one number after another.
fn bits(values: &[f64]) -> &[u64] {
    // SAFETY: all bits are valid integers.
    let (before, bits, after) = unsafe { values.align_to() };
    assert!(before.is_empty() && after.is_empty(), "both types have the same size and alignment");
    bits
}

/// Asserts that the library and the engine give the same values, bit for bit: −0 differs from 0,
/// and NaN equals itself.
#[track_caller]
pub(crate) fn assert_same(what: &str, ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    if bits(ours) != bits(theirs) {
        let index = (0..ours.len()).find(|&index| ours[index].to_bits() != theirs[index].to_bits()).unwrap();
        panic!("{what}: the library has {} at index {index}, the engine {}", ours[index], theirs[index]);
    }
}

/// A simulation that is created and used only through the C API.
pub(crate) struct Raw {
    pub(crate) d: *mut mjData,
    model: Arc<Model>,
}

impl Raw {
    pub(crate) fn new(model: &Arc<Model>) -> Self {
        let d = c!(mj_makeData(model.as_ptr()));
        assert!(!d.is_null(), "mj_makeData failed");
        Self { d, model: model.clone() }
    }

    pub(crate) fn m(&self) -> *const mjModel {
        self.model.as_ptr()
    }

    pub(crate) fn data(&self) -> &mjData {
        // SAFETY: created in `new` and deleted in `drop`; no call in C runs during the borrow.
        unsafe { &*self.d }
    }

    pub(crate) fn values(&self, array: impl Fn(&mjData) -> *const f64, length: usize) -> Vec<f64> {
        // SAFETY: the tests pass each array with its size.
        unsafe { read(array(self.data()), 0, length) }
    }

    pub(crate) fn write(&mut self, array: impl Fn(&mjData) -> *mut f64, values: &[f64]) {
        let array = array(self.data());
        // SAFETY: as above. The engine's arrays and the numbers do not overlap.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), array, values.len()) };
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        c!(mj_deleteData(self.d));
    }
}

/// The two simulations, and the random numbers that both receive.
pub(crate) struct Twins {
    pub(crate) name: String,
    pub(crate) model: Arc<Model>,
    pub(crate) ours: Data,
    pub(crate) raw: Raw,
    controller: RandomController,
    random: Xoshiro256PlusPlus,
}

impl Twins {
    /// Returns twins at rest in the reference position.
    pub(crate) fn new(subject: &Subject) -> Self {
        let model = subject.model.clone();
        Self {
            name: subject.name.clone(),
            ours: Data::new(model.clone()).unwrap(),
            raw: Raw::new(&model),
            controller: RandomController::new(1),
            random: Xoshiro256PlusPlus::seed_from_u64(2),
            model,
        }
    }

    /// Returns twins in motion, after steps from random velocities with random controls and forces,
    /// with everything computed.
    pub(crate) fn in_motion(subject: &Subject) -> Self {
        let mut twins = Self::new(subject);
        twins.shake();
        // The largest model takes 5 ms per step.
        let steps = if twins.model.nv() > 1000 { 5 } else { 60 };
        for _ in 0..steps {
            twins.control();
            twins.step();
        }
        twins.forward();
        twins
    }

    /// Returns numbers between -1 and 1.
    pub(crate) fn numbers(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.random.random::<f64>() * 2.0 - 1.0).collect()
    }

    /// Sets the same random velocities and forces on both.
    pub(crate) fn shake(&mut self) {
        let nv = self.model.nv();
        let velocities: Vec<f64> = self.numbers(nv).iter().map(|number| 0.2 * number).collect();
        let forces: Vec<f64> = self.numbers(nv).iter().map(|number| 0.05 * number).collect();
        self.ours.qvel_mut().copy_from_slice(&velocities);
        self.ours.qfrc_applied_mut().copy_from_slice(&forces);
        self.raw.write(|d| d.qvel, &velocities);
        self.raw.write(|d| d.qfrc_applied, &forces);
    }

    /// Sets the same random controls on both.
    pub(crate) fn control(&mut self) {
        self.controller.control(&mut self.ours).unwrap();
        self.raw.write(|d| d.ctrl, self.ours.ctrl());
    }

    pub(crate) fn step(&mut self) {
        self.ours.step().unwrap_or_else(|error| panic!("{}: {error}", self.name));
        c!(mj_step(self.raw.m(), self.raw.d));
    }

    pub(crate) fn forward(&mut self) {
        self.ours.forward().unwrap_or_else(|error| panic!("{}: {error}", self.name));
        c!(mj_forward(self.raw.m(), self.raw.d));
    }

    /// Asserts equal time, state, inputs and warnings.
    #[track_caller]
    pub(crate) fn assert_same_state(&self, when: &str) {
        let (model, ours, raw) = (&self.model, &self.ours, &self.raw);
        let (nq, nv, nu, na) = (model.nq(), model.nv(), model.nu(), model.na());
        let name = &self.name;
        assert_same(&format!("{name}, {when}: time"), &[ours.time()], &[raw.data().time]);
        assert_same(&format!("{name}, {when}: qpos"), ours.qpos(), &raw.values(|d| d.qpos, nq));
        assert_same(&format!("{name}, {when}: qvel"), ours.qvel(), &raw.values(|d| d.qvel, nv));
        assert_same(&format!("{name}, {when}: act"), ours.act(), &raw.values(|d| d.act, na));
        assert_same(&format!("{name}, {when}: ctrl"), ours.ctrl(), &raw.values(|d| d.ctrl, nu));
        let warmstart = raw.values(|d| d.qacc_warmstart, nv);
        assert_same(&format!("{name}, {when}: qacc_warmstart"), ours.qacc_warmstart(), &warmstart);
        for index in 0..sys::mjNWARNING as usize {
            // SAFETY: the library's data is valid, and nothing writes to it during the borrow.
            let (ours, raw) = (unsafe { (*ours.as_ptr()).warning[index] }, raw.data().warning[index]);
            assert_eq!((ours.number, ours.lastinfo), (raw.number, raw.lastinfo), "{name}, {when}: warning {index}");
        }
    }

    /// Asserts equal results of forward dynamics.
    #[track_caller]
    pub(crate) fn assert_same_dynamics(&self, when: &str) {
        let (model, ours, raw) = (&self.model, &self.ours, &self.raw);
        let (nv, nu) = (model.nv(), model.nu());
        let same = |what: &str, ours: &[f64], theirs: &[f64]| {
            assert_same(&format!("{}, {when}: {what}", self.name), ours, theirs);
        };
        same("qacc", ours.qacc(), &raw.values(|d| d.qacc, nv));
        same("qfrc_bias", ours.qfrc_bias(), &raw.values(|d| d.qfrc_bias, nv));
        same("qfrc_passive", ours.qfrc_passive(), &raw.values(|d| d.qfrc_passive, nv));
        same("qfrc_actuator", ours.qfrc_actuator(), &raw.values(|d| d.qfrc_actuator, nv));
        same("qfrc_constraint", ours.qfrc_constraint(), &raw.values(|d| d.qfrc_constraint, nv));
        same("actuator_force", ours.actuator_force(), &raw.values(|d| d.actuator_force, nu));
        same("act_dot", ours.act_dot(), &raw.values(|d| d.act_dot, model.na()));
        same("xpos", ours.xpos().as_flattened(), &raw.values(|d| d.xpos, 3 * model.nbody()));
        same("xmat", ours.xmat().as_flattened(), &raw.values(|d| d.xmat, 9 * model.nbody()));
        same("subtree_com", ours.subtree_com().as_flattened(), &raw.values(|d| d.subtree_com, 3 * model.nbody()));
        same("sensordata", ours.sensordata(), &raw.values(|d| d.sensordata, model.nsensordata()));
        let mut inertia = vec![0.0; nv * nv];
        // SAFETY: the model and data of one pair of twins.
        unsafe { differing::full_m(raw.m(), raw.d, &mut inertia) };
        same("M", ours.full_m().unwrap().as_slice(), &inertia);
        assert_eq!(ours.nefc(), raw.data().nefc as usize, "{}, {when}: nefc", self.name);
        same("efc_force", ours.efc_force(), &raw.values(|d| d.efc_force, ours.nefc()));
        same("efc_pos", ours.efc_pos(), &raw.values(|d| d.efc_pos, ours.nefc()));
    }
}
