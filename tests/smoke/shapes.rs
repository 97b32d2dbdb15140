//! Each array that an accessor returns lies in the memory of its struct: inside the buffer or the
//! arena, without an overlap with another array, and in the buffer followed by padding only. A
//! wrong length or a field that the table lacks would show as an overlap or a gap.

use std::mem::{size_of, size_of_val};

use mujoco_safe::enums::{Cone, JacobianStorage, Solver};
use mujoco_safe::{Data, MatrixView, Model, sample};

use crate::cases::cases;
use crate::installed::sample_models;

/// Memory of an array.
#[derive(Clone, Copy, Debug)]
struct Region {
    #[allow(dead_code, reason = "messages print it")]
    name: &'static str,
    start: usize,
    bytes: usize,
}

impl Region {
    fn end(self) -> usize {
        self.start + self.bytes
    }

    /// Returns the memory of an array of the struct that has no accessor with its name.
    fn raw<T>(name: &'static str, array: *const T, length: usize) -> Self {
        Self { name, start: array.addr(), bytes: length * size_of::<T>() }
    }
}

/// The result of an accessor: an array, or a size, which has no memory.
trait Memory: Sized {
    fn region(self, _: &'static str) -> Option<Region> {
        None
    }
}

impl Memory for usize {}
impl Memory for f64 {}
impl Memory for bool {}

impl<T> Memory for &[T] {
    fn region(self, name: &'static str) -> Option<Region> {
        Some(Region { name, start: self.as_ptr().addr(), bytes: size_of_val(self) })
    }
}

impl Memory for MatrixView<'_> {
    fn region(self, name: &'static str) -> Option<Region> {
        self.as_slice().region(name)
    }
}

macro_rules! regions {
    ($owner:ident: $($name:ident)*) => { vec![$($owner.$name().region(stringify!($name))),*] };
}

/// Alignment of arrays in a buffer, in bytes: an upper bound of the versions.
const PADDING: usize = 64;

/// Asserts that the arrays do not overlap, and lie inside `memory`. Returns those that are not
/// empty, by address.
fn check_disjoint(regions: impl IntoIterator<Item = Region>, memory: Region) -> Vec<Region> {
    let mut regions: Vec<Region> = regions.into_iter().filter(|region| region.bytes > 0).collect();
    regions.sort_by_key(|region| region.start);
    for region in &regions {
        assert!(memory.start <= region.start && region.end() <= memory.end(), "{region:?} is outside of {memory:?}");
    }
    for pair in regions.windows(2) {
        assert!(pair[0].end() <= pair[1].start, "{:?} overlaps {:?}", pair[0], pair[1]);
    }
    regions
}

/// Asserts that nothing but padding lies between the arrays.
fn check_gaps(regions: &[Region], memory: Region) {
    let starts = regions.iter().map(|region| region.start).chain([memory.end()]);
    let ends = [memory.start].into_iter().chain(regions.iter().map(|region| region.end()));
    for ((start, end), region) in starts.zip(ends).zip([memory].iter().chain(regions)) {
        // Empty arrays at the end of the buffer are aligned too.
        let most = if start == memory.end() { 2 * PADDING } else { PADDING };
        assert!(start - end < most, "{} bytes follow {region:?}", start - end);
    }
}

fn check_model(model: &Model) {
    // SAFETY: a valid model.
    let raw = unsafe { &*model.as_ptr() };
    let memory = Region::raw("buffer", raw.buffer.cast::<u8>(), usize::try_from(raw.nbuffer).unwrap());
    let mut regions: Vec<Region> = model_readers! { regions model: }.into_iter().flatten().collect();
    regions.push(Region::raw("names", raw.names, raw.nnames as usize));
    regions.push(Region::raw("text_data", raw.text_data, raw.ntextdata as usize));
    #[cfg(engine_since = "3.0.0")]
    regions.push(Region::raw("paths", raw.paths, raw.npaths as usize));
    check_gaps(&check_disjoint(regions, memory), memory);
}

fn check_data(data: &Data) {
    // SAFETY: a valid data.
    let raw = unsafe { &*data.as_ptr() };
    let buffer = Region::raw("buffer", raw.buffer.cast::<u8>(), usize::try_from(raw.nbuffer).unwrap());
    let mut regions: Vec<Region> = data_readers! { regions data: }.into_iter().flatten().collect();
    regions.push(Region::raw("contact", raw.contact.cast_const(), data.ncon()));
    #[cfg(not(engine_since = "2.3.0"))]
    // Arrays of contacts and constraints are longer than the rows in use that accessors return, so
    // there are gaps.
    check_disjoint(regions, buffer);
    #[cfg(engine_since = "2.3.0")]
    {
        let arena = Region::raw("arena", raw.arena.cast::<u8>(), raw.parena);
        let (in_arena, in_buffer): (Vec<Region>, Vec<Region>) =
            regions.into_iter().partition(|region| (arena.start..arena.end()).contains(&region.start));
        check_disjoint(in_arena, arena);
        check_gaps(&check_disjoint(in_buffer, buffer), buffer);
    }
}

/// Returns the models of the repository and of the engine's package that this engine loads.
fn models() -> Vec<(String, Model)> {
    let ours = ["assembly", "colliders", "every_element", "zoo"]
        .map(|name| format!("{}/tests/models/{name}.xml", env!("CARGO_MANIFEST_DIR")));
    let mut models: Vec<_> = sample_models().into_iter().step_by(cases(3, 1)).collect();
    models.extend(ours.into_iter().filter_map(|path| Some((path.clone(), Model::from_xml_path(&path).ok()?))));
    models.push(("cartpole".to_owned(), sample::cartpole()));
    models.push(("humanoid".to_owned(), sample::humanoid()));
    assert!(models.len() >= 4, "the engine loads few of the models");
    models
}

#[test]
fn arrays_lie_in_the_memory_of_their_struct_and_do_not_overlap() {
    for (name, model) in models() {
        println!("{name}");
        check_model(&model);
        let mut data = Data::new(model).unwrap();
        check_data(&data);
        for _ in 0..5 {
            data.step().unwrap();
            check_data(&data);
        }
        data.reset().unwrap();
        check_data(&data);
    }
}

#[test]
fn arrays_of_constraints_do_not_overlap_for_any_storage_and_solver() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
        for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
            for (cone, noslip_iterations) in [(Cone::Pyramidal, 0), (Cone::Elliptic, 3)] {
                data.edit_model(|model| {
                    model.edit_options(|options| {
                        (options.jacobian, options.solver, options.cone) = (jacobian, solver, cone);
                        options.noslip_iterations = noslip_iterations;
                    })
                })
                .unwrap();
                data.reset_to_key("squat").unwrap();
                check_data(&data);
                for _ in 0..50 {
                    data.step().unwrap();
                    check_data(&data);
                }
                assert!(data.nefc() > 0 && data.efc_J().len() >= data.nefc());
                check_data(&data.clone());
                data.inverse().unwrap();
                check_data(&data);
            }
        }
    }
}
