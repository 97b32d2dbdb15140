//! Every generated accessor returns the engine's memory: the number itself, or the array of the
//! struct's pointer, with the type, length and shape of the engine's headers, and inside the
//! engine's buffer.

use std::any::type_name;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

use mujoco_safe::data::Timer;
use mujoco_safe::enums::Solver;
use mujoco_safe::sys::{self, mjData, mjModel};
use mujoco_safe::{Data, MatrixView, MatrixViewMut, Model, Stage, kind, sample};

use crate::cases::cases;
use crate::twins::{differing, subjects};

/// The result of an accessor, or the contents of the struct.
#[derive(Debug, PartialEq)]
enum Place {
    Number(f64),
    /// Length and columns are known for accessors only.
    Array {
        at: usize,
        element: &'static str,
        length: Option<usize>,
        columns: Option<usize>,
    },
}

trait Locate {
    fn locate(self) -> Place;
}

fn array<T>(array: *const T, length: Option<usize>, columns: Option<usize>) -> Place {
    Place::Array { at: array.addr(), element: type_name::<T>(), length, columns }
}

/// Types of elements of the engine's arrays.
trait Value {}

impl Value for f64 {}
impl Value for f32 {}
impl Value for i32 {}
impl Value for i64 {}
impl Value for u8 {}

impl Locate for usize {
    fn locate(self) -> Place {
        Place::Number(self as f64)
    }
}

impl Locate for i32 {
    fn locate(self) -> Place {
        // A size that the model leaves to the engine is -1 in newer engines, and 0 in the accessor.
        Place::Number(self.max(0).into())
    }
}

impl Locate for i64 {
    fn locate(self) -> Place {
        Place::Number(self.max(0) as f64)
    }
}

impl Locate for u8 {
    fn locate(self) -> Place {
        Place::Number(self.into())
    }
}

impl Locate for bool {
    fn locate(self) -> Place {
        Place::Number(self.into())
    }
}

impl Locate for f64 {
    fn locate(self) -> Place {
        Place::Number(self)
    }
}

impl<T> Locate for *mut T {
    fn locate(self) -> Place {
        array(self, None, None)
    }
}

impl<T: Value> Locate for &[T] {
    fn locate(self) -> Place {
        array(self.as_ptr(), Some(self.len()), None)
    }
}

impl<T: Value, const N: usize> Locate for &[[T; N]] {
    fn locate(self) -> Place {
        array(self.as_flattened().as_ptr(), Some(N * self.len()), Some(N))
    }
}

impl Locate for MatrixView<'_> {
    fn locate(self) -> Place {
        array(self.as_slice().as_ptr(), Some(self.as_slice().len()), Some(self.ncols()))
    }
}

impl<T: Value> Locate for &mut [T] {
    fn locate(self) -> Place {
        (&*self).locate()
    }
}

impl<T: Value, const N: usize> Locate for &mut [[T; N]] {
    fn locate(self) -> Place {
        (&*self).locate()
    }
}

impl Locate for MatrixViewMut<'_> {
    fn locate(self) -> Place {
        self.view().locate()
    }
}

/// Results of accessors and contents of the struct, by field.
type Pairs = Vec<(&'static str, Place, Place)>;

/// Adds a pair. Inlined for each of the hundreds of fields, it would take the compiler seconds.
#[inline(never)]
fn push(pairs: &mut Pairs, name: &'static str, ours: impl Locate, theirs: impl Locate) {
    pairs.push((name, ours.locate(), theirs.locate()));
}

macro_rules! pairs {
    ($ours:ident, $raw:ident: $($name:ident)*) => {{
        let mut pairs = Pairs::new();
        $(push(&mut pairs, stringify!($name), $ours.$name(), $raw.$name);)*
        pairs
    }};
}

macro_rules! writing_pairs {
    ($ours:ident, $raw:ident: $($name:ident($field:ident))*) => {{
        let mut pairs = Pairs::new();
        $(push(&mut pairs, stringify!($field), $ours.$name(), $raw.$field);)*
        pairs
    }};
}

fn pairs_of_model(model: &Model, raw: &mjModel) -> Pairs {
    model_readers! { pairs model, raw: }
}

fn pairs_of_data(data: &Data, raw: &mjData) -> Pairs {
    data_readers! { pairs data, raw: }
}

/// Returns the line of the table of fields: struct, kind, type, name, rows, columns.
fn line(owner: &'static str, name: &'static str) -> &'static [&'static str] {
    static LINES: LazyLock<HashMap<[&str; 2], Vec<&str>>> = LazyLock::new(|| {
        let lines = sys::FIELDS.lines().map(|line| line.split('\t').collect::<Vec<_>>());
        lines.map(|line| ([line[0], line[3]], line)).collect()
    });
    LINES.get(&[owner, name]).unwrap_or_else(|| panic!("the table lacks {owner}.{name}"))
}

/// Returns the numbers of the engine by name.
fn numbers(pairs: &Pairs) -> impl Iterator<Item = (&'static str, usize)> {
    pairs.iter().filter_map(|(name, _, theirs)| match theirs {
        Place::Number(number) => Some((*name, *number as usize)),
        Place::Array { .. } => None,
    })
}

/// The engine's sizes by name, and its buffers.
struct Engine {
    sizes: HashMap<&'static str, usize>,
    buffer: Range<usize>,
    /// The arena of a simulation, which contains the arrays of contacts and constraints in newer
    /// engines.
    arena: Range<usize>,
    /// `true` if the engine has computed the arrays in the arena.
    is_computed: bool,
    is_sparse: bool,
}

impl Engine {
    fn new(model: &Pairs, buffer: *mut std::ffi::c_void, bytes: impl TryInto<usize, Error: std::fmt::Debug>) -> Self {
        let bytes: usize = bytes.try_into().unwrap();
        Self {
            sizes: numbers(model).collect(),
            buffer: buffer.addr()..buffer.addr() + bytes,
            arena: 0..0,
            is_computed: false,
            is_sparse: false,
        }
    }

    /// Returns the sizes of a simulation: those of the model, but with the current number of
    /// constraints, to which accessors are limited.
    fn of_data(model: &Pairs, simulation: &Data, data: &Pairs, raw: &mjData) -> Self {
        #[cfg(not(engine_since = "2.3.0"))]
        let _ = data;
        let mut engine = Self::new(model, raw.buffer, raw.nbuffer);
        engine.sizes.insert("njmax", usize::try_from(raw.nefc).unwrap());
        engine.is_computed = simulation.require(Stage::Acceleration).is_ok();
        // SAFETY: a valid model, of which the function reads options and sizes.
        engine.is_sparse = unsafe { sys::mj_isSparse(simulation.model().as_ptr()) } != 0;
        #[cfg(engine_since = "2.3.0")]
        {
            engine.arena = raw.arena.addr()..raw.arena.addr() + usize::try_from(raw.narena).unwrap();
            engine.sizes.extend(numbers(data));
        }
        engine
    }

    fn extent(&self, text: &str) -> usize {
        text.split('*')
            .map(|factor| match factor {
                #[cfg(engine_since = "3.2.1")]
                "mjNTEXROLE" => sys::mjNTEXROLE as usize,
                _ => self.sizes.get(factor).copied().unwrap_or_else(|| factor.parse().expect(factor)),
            })
            .product()
    }

    /// Returns the length of an accessor of the array at an address. Arrays in the arena are empty
    /// until the engine has allocated and written them.
    fn length(&self, name: &str, line: &[&str], at: usize) -> usize {
        const INDICES_OF_J: [&str; 4] = ["efc_J_rownnz", "efc_J_rowadr", "efc_J_rowsuper", "efc_J_colind"];
        match (line[1], name) {
            ("arena", _) if !self.is_computed || at == 0 => 0,
            ("arena", name) if !self.is_sparse && INDICES_OF_J.contains(&name) => 0,
            // The engine may allocate more dense rows than it uses.
            ("arena", "efc_J") if !self.is_sparse => self.extent("nefc*nv"),
            _ => self.extent(line[4]) * self.extent(line[5]),
        }
    }

    /// Asserts that both sides of every pair are the same.
    fn compare(&self, model: &str, owner: &'static str, pairs: &Pairs) {
        for (name, ours, theirs) in pairs {
            let what = format!("{model}: {owner}.{name}");
            let line = line(owner, name);
            let (Place::Array { at, element, length, columns }, Place::Array { at: place, element: of, .. }) =
                (ours, theirs)
            else {
                assert_eq!(ours, theirs, "{what}");
                continue;
            };
            assert_eq!(element, of, "{what}");
            assert_eq!(
                *of,
                match line[2] {
                    "mjtNum" => "f64",
                    "float" => "f32",
                    "int" => "i32",
                    "mjtByte" | "mjtBool" => "u8",
                    "mjtSize" => "i64",
                    other => other,
                }
            );
            let (expected, width) = (self.length(name, line, *place), self.extent(line[5]));
            assert_eq!(*length, Some(expected), "{what}: length");
            // A slice has no columns: a row is either an array or flattened.
            if let Some(columns) = columns {
                assert_eq!(*columns, width, "{what}: columns");
            } else {
                assert!(
                    width == 1 || name.contains("_J") || name.starts_with("efc_"),
                    "{what}: {width} columns missing"
                );
            }
            if expected > 0 {
                assert_eq!(at, place, "{what}: address");
                let bytes = expected
                    * match line[2] {
                        "mjtNum" | "mjtSize" => 8,
                        "mjtByte" | "mjtBool" => 1,
                        _ => 4,
                    };
                let buffer = if line[1] == "arena" { &self.arena } else { &self.buffer };
                assert!(buffer.start <= *at && at + bytes <= buffer.end, "{what}: outside of the buffer");
            }
        }
    }
}

/// Returns the usual models, every fourth one unless all cases run, and a model with an element of
/// every kind and type.
fn models() -> impl Iterator<Item = (String, Arc<Model>)> {
    let every = Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml"));
    let every = ("every_element".to_owned(), Arc::new(every.unwrap()));
    subjects().iter().step_by(cases(4, 1)).map(|subject| (subject.name.clone(), subject.model.clone())).chain([every])
}

fn raw_model(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, and nothing writes to it during the borrow.
    unsafe { &*model.as_ptr() }
}

fn raw_data(data: &Data) -> &mjData {
    // SAFETY: valid as long as the data, and nothing writes to it during the borrow.
    unsafe { &*data.as_ptr() }
}

#[test]
fn accessors_of_a_model_return_the_engines_memory() {
    for (name, model) in models() {
        let raw = raw_model(&model);
        let pairs = pairs_of_model(&model, raw);
        Engine::new(&pairs, raw.buffer, raw.nbuffer).compare(&name, "Model", &pairs);
    }
}

#[test]
fn accessors_of_a_simulation_return_the_engines_memory_at_every_stage() {
    for (name, model) in models() {
        let sizes = pairs_of_model(&model, raw_model(&model));
        let mut data = Data::new(model).unwrap();
        for stage in [|_: &mut Data| Ok(()), Data::forward, Data::step, Data::reset] {
            stage(&mut data).unwrap_or_else(|error| panic!("{name}: {error}"));
            let raw = raw_data(&data);
            let pairs = pairs_of_data(&data, raw);
            Engine::of_data(&sizes, &data, &pairs, raw).compare(&name, "Data", &pairs);
        }
    }
}

#[test]
fn mutable_accessors_return_the_engines_memory() {
    for (name, model) in models() {
        let mut model = model.try_clone().unwrap();
        // SAFETY: numbers and addresses; the arrays keep their address.
        let raw = unsafe { std::ptr::read(raw_model(&model)) };
        let sizes = pairs_of_model(&model, &raw);
        let mut edit = model.edit();
        let pairs: Pairs = model_writers! { writing_pairs edit, raw: };
        Engine::new(&sizes, raw.buffer, raw.nbuffer).compare(&name, "Model", &pairs);

        let mut data = Data::new(model).unwrap();
        data.forward().unwrap_or_else(|error| panic!("{name}: {error}"));
        // SAFETY: as above.
        let raw = unsafe { std::ptr::read(raw_data(&data)) };
        let pairs: Pairs = data_writers! { writing_pairs data, raw: };
        let numbers = pairs_of_data(&data, &raw);
        Engine::of_data(&sizes, &data, &numbers, &raw).compare(&name, "Data", &pairs);
    }
}

/// Returns fields with an accessor of another name or form, whose existence the compiler checks.
fn other_accessors(owner: &str) -> Vec<&'static str> {
    let _ = (Model::name::<kind::Body>, Model::text_data);
    let _ = (Data::warning, Data::timer, Data::solver_fwdinv, Data::energy);
    let _ = |data: &Data| (data.contacts().len(), data.solver().len());
    match owner {
        "Model" => vec!["names", "text_data"],
        _ => vec!["warning", "timer", "solver", "solver_fwdinv", "energy", "contact"],
    }
}

/// Returns `true` for fields of newer engines that have no accessor: file names, attributes and
/// pointers of plugins, the numbers of the solver's iterations by island, the thread pool with its
/// stacks, and the solver's workspace with its copies that are sorted by island.
fn has_no_accessor(line: &[&str]) -> bool {
    const BY_ISLAND: [&str; 2] = ["solver_niter", "solver_nnz"];
    const WORKSPACE: [&str; 6] = ["iacc", "iefc_", "iM", "iLD", "ifrc_", "efm_"];
    let name = line[3];
    ["paths", "plugin_attr", "plugin_data", "threadpool", "maxuse_threadstack"].contains(&name)
        || line[1] == "vector" && BY_ISLAND.contains(&name)
        || line[1] == "arena" && WORKSPACE.iter().any(|beginning| name.starts_with(beginning))
}

#[test]
fn every_field_of_model_and_data_has_an_accessor() {
    macro_rules! names {
        ($($name:ident)*) => { [$(stringify!($name)),*] };
    }
    let (model, data) = (model_readers! { names }, data_readers! { names });
    for (owner, listed) in [("Model", &model[..]), ("Data", &data)] {
        let mut listed = [listed, &other_accessors(owner)].concat();
        let lines = sys::FIELDS.lines().filter(|line| line.starts_with(owner)).map(|line| line.split('\t').collect());
        let mut fields: Vec<&str> =
            lines.filter(|line: &Vec<&str>| !has_no_accessor(line)).map(|line| line[3]).collect();
        listed.sort_unstable();
        fields.sort_unstable();
        assert_eq!(listed, fields, "{owner}");
    }
}

/// The timers that every engine has, with their constants.
const TIMERS: [(Timer, u32); 12] = [
    (Timer::Step, sys::mjTIMER_STEP),
    (Timer::Forward, sys::mjTIMER_FORWARD),
    (Timer::Inverse, sys::mjTIMER_INVERSE),
    (Timer::Position, sys::mjTIMER_POSITION),
    (Timer::Velocity, sys::mjTIMER_VELOCITY),
    (Timer::Actuation, sys::mjTIMER_ACTUATION),
    (Timer::Constraint, sys::mjTIMER_CONSTRAINT),
    (Timer::PositionKinematics, sys::mjTIMER_POS_KINEMATICS),
    (Timer::PositionInertia, sys::mjTIMER_POS_INERTIA),
    (Timer::PositionCollision, sys::mjTIMER_POS_COLLISION),
    (Timer::PositionMake, sys::mjTIMER_POS_MAKE),
    (Timer::PositionProject, sys::mjTIMER_POS_PROJECT),
];

#[test]
fn values_inside_the_data_struct_equal_c() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.edit_model(|model| model.edit_options(|options| options.enable = crate::flags::enable_flags())).unwrap();
    data.reset_to_key("squat").unwrap();
    (0..5).for_each(|_| data.step().unwrap());
    let raw = raw_data(&data);
    assert_eq!((data.solver_fwdinv(), data.energy()), (raw.solver_fwdinv, raw.energy));
    assert!(data.energy()[1] > 0.0 && data.solver_fwdinv()[1] > 0.0);
    for (timer, constant) in TIMERS {
        let (count, raw) = (data.timer(timer), raw.timer[constant as usize]);
        assert_eq!((count.duration, count.number), (raw.duration, raw.number as usize), "{timer:?}");
    }
    assert_eq!(data.timer(Timer::Step).number, 5);
    // Inverse dynamics, which the comparison with forward dynamics calls, has this timer too.
    assert_eq!(data.timer(Timer::Constraint).number, 10);
    assert!(data.solver().len() > 0);
    assert_eq!(data.solver().len(), differing::solver_iterations(raw) as usize);
    for (ours, raw) in data.solver().zip(&raw.solver) {
        assert_eq!((ours.improvement, ours.gradient, ours.lineslope), (raw.improvement, raw.gradient, raw.lineslope));
        let counts = [ours.nactive, ours.nchange, ours.neval, ours.nupdate].map(|count| count as i32);
        assert_eq!(counts, [raw.nactive, raw.nchange, raw.neval, raw.nupdate]);
    }
}

#[test]
fn timers_equal_the_engines_constants() {
    // Newer engines have no timer for the acceleration, and have others for an integration and for
    // the phases of collision detection.
    let expected = TIMERS.iter().map(|(timer, _)| *timer);
    assert!(Timer::ALL.into_iter().filter(|timer| *timer != Timer::Acceleration).eq(expected));
    #[cfg(not(engine_since = "2.3.0"))]
    assert!(Timer::ALL.into_iter().map(|timer| timer as u32).eq(0..sys::mjNTIMER));
}

#[test]
fn solver_statistics_are_limited_to_a_thousand_iterations() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.edit_model(|model| {
        model.edit_options(|options| {
            options.solver = Solver::Pgs;
            (options.iterations, options.tolerance) = (1500, 0.0);
        })
    })
    .unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    assert_eq!((differing::solver_iterations(raw_data(&data)), data.solver().len()), (1500, sys::mjNSOLVER as usize));
}
