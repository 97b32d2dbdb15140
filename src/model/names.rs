//! Conversion between names and ids of elements.

use std::ffi::CStr;

use mujoco_sys as sys;

use super::Model;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::sealed::Sealed;
use crate::id::{Id, IntoId, Lookup};
use crate::kind::{ElementKind, Kind};

/// # Names and counts
impl Model {
    /// Returns the number of actuators. It is the number of controls [`nu`](Self::nu) unless
    /// actuators have several controls, as actuators of the types `pid` and `orientation` do in
    /// newer engines.
    #[cfg(not(engine_since = "3.11.0"))]
    #[inline]
    pub fn nactuator(&self) -> usize {
        self.nu()
    }

    /// Returns the number of flexes. 0 with engines before 3.0, which have none.
    #[cfg(not(engine_since = "3.0.0"))]
    #[inline]
    pub fn nflex(&self) -> usize {
        0
    }

    /// Returns the number of plugin instances. 0 with engines before 2.3, which have none.
    #[cfg(not(engine_since = "2.3.0"))]
    #[inline]
    pub fn nplugin(&self) -> usize {
        0
    }

    /// Returns the number of elements of a kind.
    #[inline]
    pub fn count(&self, kind: Kind) -> usize {
        match kind {
            Kind::Body => self.nbody(),
            Kind::Joint => self.njnt(),
            Kind::Geom => self.ngeom(),
            Kind::Site => self.nsite(),
            Kind::Camera => self.ncam(),
            Kind::Light => self.nlight(),
            Kind::Mesh => self.nmesh(),
            Kind::Skin => self.nskin(),
            Kind::HeightField => self.nhfield(),
            Kind::Texture => self.ntex(),
            Kind::Material => self.nmat(),
            Kind::Pair => self.npair(),
            Kind::Exclude => self.nexclude(),
            Kind::Equality => self.neq(),
            Kind::Tendon => self.ntendon(),
            Kind::Actuator => self.nactuator(),
            Kind::Sensor => self.nsensor(),
            Kind::Numeric => self.nnumeric(),
            Kind::Text => self.ntext(),
            Kind::Tuple => self.ntuple(),
            Kind::Keyframe => self.nkey(),
            Kind::Flex => self.nflex(),
            Kind::Plugin => self.nplugin(),
        }
    }

    /// Returns the name of an element, or `None` if it has none.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_id2name")]
    pub fn name<K: ElementKind>(&self, id: Id<K>) -> Option<&str> {
        self.check_id(id);
        self.name_at(K::KIND, id.index())
    }

    /// Returns the name of an element by kind and index, or `None` if it has none or the index is
    /// out of bounds.
    pub(crate) fn name_at(&self, kind: Kind, index: usize) -> Option<&str> {
        let index = i32::try_from(index).ok()?;
        // SAFETY: the engine checks type and index, and returns NULL or a string inside the model.
        let name = unsafe { sys::mj_id2name(self.as_ptr(), kind.object_type(), index) };
        if name.is_null() {
            return None;
        }
        // SAFETY: NUL-terminated, and valid as long as the model.
        unsafe { CStr::from_ptr(name) }.to_str().ok().filter(|name| !name.is_empty())
    }

    /// Returns the names of all elements of a kind that have one.
    pub fn names(&self, kind: Kind) -> impl Iterator<Item = &str> {
        (0..self.count(kind)).filter_map(move |index| self.name_at(kind, index))
    }

    /// Returns the contents of all custom texts, each NUL-terminated, at the positions `text_adr`
    /// with the lengths `text_size`. [`Model::text`] returns a single text.
    pub fn text_data(&self) -> &[u8] {
        // SAFETY: the engine allocated the array with this size, `u8` has the layout of C's char,
        // and nothing writes to a borrowed model.
        unsafe { ffi::array(self.raw().text_data.cast::<u8>(), self.ntextdata()) }
    }

    /// Returns the values of the attributes of all plugin instances, each NUL-terminated.
    #[cfg(engine_since = "2.3.0")]
    pub(crate) fn plugin_attributes(&self) -> &[u8] {
        // SAFETY: as in `text_data`.
        unsafe { ffi::array(self.raw().plugin_attr.cast::<u8>(), self.npluginattr()) }
    }

    /// Returns the id of the element with a name or an index, or of a view.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] with the existing names, [`Error::NoSuchIndex`] with their number.
    ///
    /// # Panics
    ///
    /// If an id or a view belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::id::{BodyId, IntoId};
    /// use mujoco_safe::{Model, Result, kind, sample};
    ///
    /// fn heaviest_of(model: &Model, body: impl IntoId<kind::Body>) -> Result<Option<BodyId>> {
    ///     let root = model.id(body)?;
    ///     let children = model.bodies().filter(|body| body.index() > 0 && body.parent() == root);
    ///     Ok(children.max_by(|a, b| a.mass().total_cmp(&b.mass())).map(|body| body.id()))
    /// }
    ///
    /// let model = sample::humanoid();
    /// assert_eq!(heaviest_of(&model, "world")?, Some(model.id("torso")?));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_name2id")]
    pub fn id<K: ElementKind>(&self, element: impl IntoId<K>) -> Result<Id<K>> {
        element.id_in(self)
    }

    /// Panics if the id belongs to another model.
    #[inline]
    #[track_caller]
    pub(crate) fn check_id<K: ElementKind>(&self, id: Id<K>) {
        assert!(
            id.lineage() == self.lineage && id.index() < self.count(K::KIND),
            "{id:?} belongs to another model: ids are valid for the model that they came from and for its clones"
        );
    }
}

impl Sealed for Model {}

impl Lookup for Model {
    fn id_of_name<K: ElementKind>(&self, name: &str) -> Result<Id<K>> {
        let unknown = || Error::NoSuchName {
            kind: K::KIND,
            name: name.to_owned(),
            known: self.names(K::KIND).map(str::to_owned).collect(),
            others: Kind::ALL.iter().copied().filter(|&kind| self.names(kind).any(|other| other == name)).collect(),
        };
        // Reject the empty name here, because the engine would return an unnamed element for it.
        let name_c = Some(name)
            .filter(|name| !name.is_empty())
            .and_then(|name| std::ffi::CString::new(name).ok())
            .ok_or_else(unknown)?;
        // SAFETY: a valid type and string; returns -1 or an index.
        let index = unsafe { sys::mj_name2id(self.as_ptr(), K::KIND.object_type(), name_c.as_ptr()) };
        usize::try_from(index).map(|index| Id::new(index, self.lineage)).map_err(|_| unknown())
    }

    fn id_of_index<K: ElementKind>(&self, index: usize) -> Result<Id<K>> {
        let count = self.count(K::KIND);
        if index < count {
            Ok(Id::new(index, self.lineage))
        } else {
            Err(Error::NoSuchIndex { kind: K::KIND, index, count })
        }
    }

    #[inline]
    #[track_caller]
    fn check_id<K: ElementKind>(&self, id: Id<K>) {
        Model::check_id(self, id);
    }
}
