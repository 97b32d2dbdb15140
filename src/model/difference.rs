//! Differences of edited copies from the model that they were copied from, in memory proportional
//! to the edit.

use std::ops::Range;
use std::sync::Arc;

use super::options::fields::Mirror;
use super::{CheckedEdit, Model, ModelMut, Options, Statistics, Visual};
use crate::error::Result;
use crate::ffi;
use crate::generated::{model_settings, model_sizes};

/// Number of bytes that are compared at a time, which is faster than the comparison of single
/// words.
const BLOCK: usize = 4096;
const WORD: usize = size_of::<f64>();

/// Values of an edited copy of a model that differ from the model.
#[derive(Default, PartialEq)]
pub(crate) struct ModelDifference {
    /// Ranges of bytes in the memory of the model's arrays, ascending.
    places: Vec<Range<usize>>,
    /// Values in these places, one place after another.
    bytes: Vec<u8>,
    settings: Option<Box<Settings>>,
    visual: Option<Box<Visual>>,
}

impl ModelDifference {
    /// Sets this to the difference of a copy of the model. Allocates only if the difference exceeds
    /// the earlier ones.
    pub(crate) fn update(&mut self, model: &Model, copy: &Model) {
        assert!(copy.is_same_structure(model), "Bug: the difference of two models of different structures");
        self.places.clear();
        self.bytes.clear();
        let blocks = arrays(copy).chunks(BLOCK).zip(arrays(model).chunks(BLOCK)).enumerate();
        for (block, (new, old)) in blocks.filter(|(_, (new, old))| new != old) {
            let words = new.chunks(WORD).zip(old.chunks(WORD)).enumerate();
            for (word, (new, _)) in words.filter(|(_, (new, old))| new != old) {
                let start = block * BLOCK + word * WORD;
                match self.places.last_mut() {
                    Some(last) if last.end == start => last.end += new.len(),
                    _ => self.places.push(start..start + new.len()),
                }
                self.bytes.extend_from_slice(new);
            }
        }
        store(&mut self.settings, Settings::of(copy), &Settings::of(model));
        store(&mut self.visual, copy.visual(), &model.visual());
    }

    /// Makes this the difference of an unedited copy.
    pub(crate) fn clear(&mut self) {
        self.places.clear();
        self.bytes.clear();
        (self.settings, self.visual) = (None, None);
    }

    /// Returns `true` if the copy equals the model.
    pub(crate) fn is_empty(&self) -> bool {
        self.places.is_empty() && self.settings.is_none() && self.visual.is_none()
    }

    /// Writes the difference to a copy of `model` that differs from it at most in the places of
    /// this difference, and in its settings.
    pub(crate) fn write(&self, model: &Model, copy: &mut ModelMut<'_>) {
        assert!(copy.is_same_structure(model), "Bug: the difference of a model of another structure");
        let (to, mut from) = (arrays_mut(copy), &self.bytes[..]);
        for place in &self.places {
            let (values, rest) = from.split_at(place.len());
            to[place.clone()].copy_from_slice(values);
            from = rest;
        }
        copy.forget_loose_bounds();
        let (raw, original) = (copy.raw_mut(), model.raw());
        (raw.opt, raw.stat, raw.vis) = (original.opt, original.stat, original.vis);
        if let Some(settings) = self.settings.as_deref() {
            settings.options.write(&mut raw.opt);
            settings.statistics.write_into(&mut raw.stat);
        }
        if let Some(visual) = self.visual.as_deref() {
            visual.write_into(&mut raw.vis);
        }
    }
}

/// Options and statistics of a model.
#[derive(Clone)]
struct Settings {
    options: Options,
    statistics: Statistics,
}

impl Settings {
    fn of(model: &Model) -> Self {
        Self { options: model.options(), statistics: model.statistics() }
    }

    /// Returns the bits of the numbers that can be a negative zero.
    fn bits(&self) -> [[u64; 3]; 4] {
        let Self { options, statistics } = self;
        [options.gravity, options.wind, options.magnetic, statistics.center].map(|vector| vector.map(f64::to_bits))
    }
}

impl Clone for ModelDifference {
    fn clone(&self) -> Self {
        let mut clone = Self::default();
        clone.clone_from(self);
        clone
    }

    /// Copies the difference, into the present memory if it suffices.
    fn clone_from(&mut self, other: &Self) {
        self.places.clone_from(&other.places);
        self.bytes.clone_from(&other.bytes);
        self.settings.clone_from(&other.settings);
        self.visual.clone_from(&other.visual);
    }
}

impl PartialEq for Settings {
    fn eq(&self, other: &Self) -> bool {
        self.options == other.options && self.statistics == other.statistics && self.bits() == other.bits()
    }
}

/// Stores a value that differs from the original, in the box of an earlier value if there is one.
fn store<T: PartialEq>(place: &mut Option<Box<T>>, value: T, original: &T) {
    match place {
        _ if value == *original => *place = None,
        Some(place) => **place = value,
        None => *place = Some(Box::new(value)),
    }
}

impl Model {
    /// Returns `true` if all sizes, arrays and settings have the same bits as those of another
    /// model.
    pub(crate) fn has_same_bits(&self, other: &Self) -> bool {
        macro_rules! same_sizes {
            ($($size:ident)*) => { true $(&& self.raw().$size == other.raw().$size)* };
        }
        macro_rules! same_settings {
            ($($group:ident $(.$part:ident)+;)*) => {
                true $(&& self.raw().$group$(.$part)+.bits() == other.raw().$group$(.$part)+.bits())*
            };
        }
        let (sizes, settings) = (model_sizes! { same_sizes }, model_settings! { same_settings });
        sizes && settings && arrays(self) == arrays(other)
    }
}

/// Value of a setting as bits, which distinguish the zeros and are equal to themselves.
trait Bits {
    type Bits: PartialEq;

    fn bits(&self) -> Self::Bits;
}

impl Bits for i32 {
    type Bits = Self;

    fn bits(&self) -> Self {
        *self
    }
}

impl Bits for f32 {
    type Bits = u32;

    fn bits(&self) -> u32 {
        self.to_bits()
    }
}

impl Bits for f64 {
    type Bits = u64;

    fn bits(&self) -> u64 {
        self.to_bits()
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    type Bits = [T::Bits; N];

    fn bits(&self) -> Self::Bits {
        std::array::from_fn(|index| self[index].bits())
    }
}

/// Returns the memory of all arrays of a model.
fn arrays(model: &Model) -> &[u8] {
    // SAFETY: the engine allocated the buffer with this size and filled it with zeros before it
    // wrote the arrays. The model is borrowed.
    unsafe { ffi::array(model.raw().buffer.cast_const().cast(), model.nbuffer()) }
}

fn arrays_mut<'m>(model: &'m mut ModelMut<'_>) -> &'m mut [u8] {
    let size = model.nbuffer();
    // SAFETY: as in `arrays`, and the model is borrowed exclusively.
    unsafe { ffi::array_mut(model.raw_mut().buffer.cast(), size) }
}

/// Copy of a model, to which one difference after another is written.
pub(crate) struct EditedModel {
    copy: Arc<Model>,
    /// Places in which the copy may differ from the model.
    places: Vec<Range<usize>>,
}

impl EditedModel {
    fn new(model: &Model) -> Result<Self> {
        Ok(Self { copy: Arc::new(model.try_clone()?), places: Vec::new() })
    }

    /// Makes the copy of the model differ by exactly this difference. Creates the copy if there is
    /// none.
    pub(crate) fn set<'e>(
        edited: &'e mut Option<Self>,
        model: &Model,
        difference: &ModelDifference,
    ) -> Result<&'e mut Self> {
        // A closure may have kept a reference to the copy.
        let is_usable = edited.as_mut().is_some_and(|edited| Arc::get_mut(&mut edited.copy).is_some());
        if !is_usable {
            *edited = Some(Self::new(model)?);
        }
        let edited = edited.as_mut().expect("Bug: the copy has been created");
        let mut copy = Self::unshared(&mut edited.copy).edit();
        if edited.places != difference.places {
            let (to, from) = (arrays_mut(&mut copy), arrays(model));
            for place in &edited.places {
                to[place.clone()].copy_from_slice(&from[place.clone()]);
            }
            edited.places.clone_from(&difference.places);
        }
        difference.write(model, &mut copy);
        Ok(edited)
    }

    /// Edits the copy, and stores the new difference.
    pub(crate) fn edit(
        &mut self,
        model: &Model,
        edit: impl FnOnce(&mut ModelMut<'_>) -> Result<()>,
        difference: &mut ModelDifference,
    ) -> Result<()> {
        let mut checked = CheckedEdit::new(Self::unshared(&mut self.copy));
        let result = edit(checked.model());
        let result = result.and(checked.finish());
        difference.update(model, &self.copy);
        self.places.clone_from(&difference.places);
        result
    }

    /// Returns the copy, which the caller may exchange for another model until
    /// [`put_back`](Self::put_back).
    pub(crate) fn model_mut(&mut self) -> &mut Arc<Model> {
        &mut self.copy
    }

    /// Puts back the copy, which has this difference from the model.
    pub(crate) fn put_back(edited: &mut Option<Self>, copy: Arc<Model>, difference: Option<&ModelDifference>) {
        let edited = match edited {
            Some(edited) => {
                edited.copy = copy;
                edited
            }
            None => edited.insert(Self { copy, places: Vec::new() }),
        };
        edited.places.clear();
        edited.places.extend(difference.into_iter().flat_map(|difference| &difference.places).cloned());
    }

    fn unshared(copy: &mut Arc<Model>) -> &mut Model {
        Arc::get_mut(copy).expect("Bug: the copy of a model is shared")
    }
}
