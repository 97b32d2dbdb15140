//! Every accessor that is made from the table of fields hands out the engine's memory: the number itself, or the array that the
//! struct points at, of the type, length and shape that the engine's headers give, and inside of the engine's buffer.

use std::any::type_name;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use mujoco_safe::sys::{self, mjData, mjModel};
use mujoco_safe::{Data, EnableFlags, MatrixView, MatrixViewMut, Model, Solver, Timer, kind, sample};

use crate::twins::subjects;

/// What an accessor returns, or what the struct has.
#[derive(Debug, PartialEq)]
enum Seen {
    Number(f64),
    /// How many values there are, and in rows of how many, is known to an accessor only.
    Array {
        at: usize,
        element: &'static str,
        length: Option<usize>,
        columns: Option<usize>,
    },
}

trait See {
    fn see(self) -> Seen;
}

fn array<T>(array: *const T, length: Option<usize>, columns: Option<usize>) -> Seen {
    Seen::Array { at: array.addr(), element: type_name::<T>(), length, columns }
}

/// What the engine's arrays are made of, which is not an array itself.
trait Value {}

impl Value for f64 {}
impl Value for f32 {}
impl Value for i32 {}
impl Value for u8 {}

impl See for usize {
    fn see(self) -> Seen {
        Seen::Number(self as f64)
    }
}

impl See for i32 {
    fn see(self) -> Seen {
        Seen::Number(self.into())
    }
}

impl See for f64 {
    fn see(self) -> Seen {
        Seen::Number(self)
    }
}

impl<T> See for *mut T {
    fn see(self) -> Seen {
        array(self, None, None)
    }
}

impl<T: Value> See for &[T] {
    fn see(self) -> Seen {
        array(self.as_ptr(), Some(self.len()), None)
    }
}

impl<T: Value, const N: usize> See for &[[T; N]] {
    fn see(self) -> Seen {
        array(self.as_flattened().as_ptr(), Some(N * self.len()), Some(N))
    }
}

impl See for MatrixView<'_> {
    fn see(self) -> Seen {
        array(self.as_slice().as_ptr(), Some(self.as_slice().len()), Some(self.ncols()))
    }
}

impl<T: Value> See for &mut [T] {
    fn see(self) -> Seen {
        (&*self).see()
    }
}

impl<T: Value, const N: usize> See for &mut [[T; N]] {
    fn see(self) -> Seen {
        (&*self).see()
    }
}

impl See for MatrixViewMut<'_> {
    fn see(self) -> Seen {
        self.as_view().see()
    }
}

/// What accessors return, beside what the struct has, by field.
type Pairs = Vec<(&'static str, Seen, Seen)>;

macro_rules! pairs {
    ($ours:ident, $raw:ident: $($name:ident)*) => {
        vec![$((stringify!($name), $ours.$name().see(), $raw.$name.see())),*]
    };
}

macro_rules! writing_pairs {
    ($ours:ident, $raw:ident: $($name:ident($field:ident))*) => {
        vec![$({
            let theirs = $raw.$field.see();
            (stringify!($field), $ours.$name().see(), theirs)
        }),*]
    };
}

fn pairs_of_model(model: &Model, raw: &mjModel) -> Pairs {
    model_readers! { pairs model, raw: }
}

fn pairs_of_data(data: &Data, raw: &mjData) -> Pairs {
    data_readers! { pairs data, raw: }
}

/// The line of the table of fields: struct, kind, type, name, rows, columns.
fn line(owner: &str, name: &str) -> Vec<&'static str> {
    let mut lines = sys::FIELDS.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    lines.find(|line| line[0] == owner && line[3] == name).unwrap_or_else(|| panic!("the table has no {owner}.{name}"))
}

/// The engine's sizes, by name, and the memory that its arrays lie in.
struct Engine {
    sizes: HashMap<&'static str, usize>,
    buffer: Range<usize>,
}

impl Engine {
    fn new(model: &Pairs, buffer: *mut std::ffi::c_void, bytes: i32) -> Self {
        let sizes = model.iter().filter_map(|(name, _, theirs)| match theirs {
            Seen::Number(number) => Some((*name, *number as usize)),
            Seen::Array { .. } => None,
        });
        let bytes = usize::try_from(bytes).unwrap();
        Self { sizes: sizes.collect(), buffer: buffer.addr()..buffer.addr() + bytes }
    }

    /// As for a model, but of constraints only those that there are: an accessor hands out no more.
    fn of_data(model: &Pairs, raw: &mjData) -> Self {
        let mut engine = Self::new(model, raw.buffer, raw.nbuffer);
        engine.sizes.insert("njmax", usize::try_from(raw.nefc).unwrap());
        engine
    }

    fn extent(&self, text: &str) -> usize {
        text.split('*')
            .map(|factor| self.sizes.get(factor).copied().unwrap_or_else(|| factor.parse().unwrap()))
            .product()
    }

    /// Every pair is one and the same.
    fn compare(&self, model: &str, owner: &str, pairs: &Pairs) {
        for (name, ours, theirs) in pairs {
            let what = format!("{model}: {owner}.{name}");
            let line = line(owner, name);
            let (Seen::Array { at, element, length, columns }, Seen::Array { at: place, element: of, .. }) =
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
                    "mjtByte" => "u8",
                    other => other,
                }
            );
            let (rows, width) = (self.extent(line[4]), self.extent(line[5]));
            assert_eq!(*length, Some(rows * width), "{what}: length");
            // A slice has no columns: one is in its rows, or the rows are packed.
            if let Some(columns) = columns {
                assert_eq!(*columns, width, "{what}: columns");
            } else {
                assert!(
                    width == 1 || name.contains("_J") || name.starts_with("efc_"),
                    "{what}: {width} columns are lost"
                );
            }
            if rows * width > 0 {
                assert_eq!(at, place, "{what}: place");
                let bytes = rows
                    * width
                    * match line[2] {
                        "mjtNum" => 8,
                        "mjtByte" => 1,
                        _ => 4,
                    };
                assert!(self.buffer.start <= *at && at + bytes <= self.buffer.end, "{what}: outside of the buffer");
            }
        }
    }
}

/// The models of this file's tests: those of the other files here, and one with an element of every kind and type.
fn models() -> impl Iterator<Item = (String, Arc<Model>)> {
    let every = Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml"));
    let every = ("every_element".to_owned(), Arc::new(every.unwrap()));
    subjects().iter().map(|subject| (subject.name.clone(), subject.model.clone())).chain([every])
}

fn raw_model(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, which nothing writes to meanwhile.
    unsafe { &*model.as_ptr() }
}

fn raw_data(data: &Data) -> &mjData {
    // SAFETY: valid as long as the data, which nothing writes to meanwhile.
    unsafe { &*data.as_ptr() }
}

#[test]
fn accessors_of_a_model_hand_out_the_engines_memory() {
    for (name, model) in models() {
        let raw = raw_model(&model);
        let pairs = pairs_of_model(&model, raw);
        Engine::new(&pairs, raw.buffer, raw.nbuffer).compare(&name, "Model", &pairs);
    }
}

#[test]
fn accessors_of_a_simulation_hand_out_the_engines_memory_at_every_stage() {
    for (name, model) in models() {
        let sizes = pairs_of_model(&model, raw_model(&model));
        let mut data = Data::new(model).unwrap();
        for stage in [|_: &mut Data| Ok(()), Data::forward, Data::step, Data::reset] {
            stage(&mut data).unwrap_or_else(|error| panic!("{name}: {error}"));
            let raw = raw_data(&data);
            Engine::of_data(&sizes, raw).compare(&name, "Data", &pairs_of_data(&data, raw));
        }
    }
}

#[test]
fn what_may_be_written_to_is_the_engines_memory() {
    for (name, model) in models() {
        let mut model = model.try_clone().unwrap();
        let raw = *raw_model(&model);
        let sizes = pairs_of_model(&model, &raw);
        let mut edit = model.edit();
        let pairs: Pairs = model_writers! { writing_pairs edit, raw: };
        Engine::new(&sizes, raw.buffer, raw.nbuffer).compare(&name, "Model", &pairs);

        let mut data = Data::new(model).unwrap();
        data.forward().unwrap_or_else(|error| panic!("{name}: {error}"));
        // The arrays stay where they are; the copy of the struct, warnings and solver statistics included, is let go at once.
        let raw = *raw_data(&data);
        let pairs: Pairs = data_writers! { writing_pairs data, raw: };
        Engine::of_data(&sizes, &raw).compare(&name, "Data", &pairs);
    }
}

/// Fields with an accessor of another name or form. The compiler makes sure that there is one.
fn other_accessors(owner: &str) -> Vec<&'static str> {
    let _ = (Model::name::<kind::Body>, Model::text_data);
    let _ = (Data::warning, Data::timer, Data::solver_fwdinv, Data::energy);
    let _ = |data: &Data| (data.contacts().len(), data.solver().len());
    match owner {
        "Model" => vec!["names", "text_data"],
        _ => vec!["warning", "timer", "solver", "solver_fwdinv", "energy", "contact"],
    }
}

#[test]
fn every_field_of_model_and_data_has_an_accessor() {
    macro_rules! names {
        ($($name:ident)*) => { [$(stringify!($name)),*] };
    }
    let (model, data) = (model_readers! { names }, data_readers! { names });
    for (owner, listed) in [("Model", &model[..]), ("Data", &data)] {
        let mut listed = [listed, &other_accessors(owner)].concat();
        let lines = sys::FIELDS.lines().filter_map(|line| line.strip_prefix(owner)?.split('\t').nth(3));
        let mut fields: Vec<&str> = lines.collect();
        listed.sort_unstable();
        fields.sort_unstable();
        assert_eq!(listed, fields, "{owner}");
    }
}

#[test]
fn what_lies_in_the_data_itself_is_the_engines() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.edit_model(|model| model.options(|options| options.enable = EnableFlags::all())).unwrap().unwrap();
    data.reset_to_key("squat").unwrap();
    (0..5).for_each(|_| data.step().unwrap());
    let raw = raw_data(&data);
    assert_eq!((data.solver_fwdinv(), data.energy()), (raw.solver_fwdinv, raw.energy));
    assert!(data.energy()[1] > 0.0 && data.solver_fwdinv()[1] > 0.0);
    for (timer, raw) in Timer::ALL.into_iter().zip(raw.timer) {
        let count = data.timer(timer);
        assert_eq!((count.duration, count.number), (raw.duration, raw.number as usize), "{timer:?}");
    }
    assert_eq!(data.timer(Timer::Step).number, 5);
    // Inverse dynamics, which the comparison with forward dynamics calls, has this timer too.
    assert_eq!(data.timer(Timer::Constraint).number, 10);
    assert!(data.solver_iter() > 0);
    assert_eq!(data.solver().len(), raw.solver_iter as usize);
    for (ours, raw) in data.solver().zip(raw.solver) {
        assert_eq!((ours.improvement, ours.gradient, ours.lineslope), (raw.improvement, raw.gradient, raw.lineslope));
        let counts = [ours.nactive, ours.nchange, ours.neval, ours.nupdate].map(|count| count as i32);
        assert_eq!(counts, [raw.nactive, raw.nchange, raw.neval, raw.nupdate]);
    }
}

#[test]
fn timers_are_the_engines_constants() {
    let numbers = Timer::ALL.map(|timer| timer as usize);
    assert!(numbers.into_iter().eq(0..sys::mjNTIMER as usize));
    assert_eq!(Timer::PositionProject as u32, sys::mjTIMER_POS_PROJECT);
    assert_eq!(Timer::Constraint as u32, sys::mjTIMER_CONSTRAINT);
}

#[test]
fn of_more_than_a_thousand_iterations_the_first_thousand_are_kept() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.edit_model(|model| {
        model.options(|options| {
            options.solver = Solver::Pgs;
            (options.iterations, options.tolerance) = (1500, 0.0);
        })
    })
    .unwrap()
    .unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    assert_eq!((data.solver_iter(), data.solver().len()), (1500, sys::mjNSOLVER as usize));
}
