//! Views of the elements of a spec.

use std::fmt;
use std::marker::PhantomData;

use super::attributes::Named;
use super::compile::check_character;
use super::element_id::{Any, ElementId, IntoElementId, SpecKind};
use super::keyframes;
use super::names;
use super::schema::Schema;
use super::tree::Index;
use super::{Spec, Value, attach, value};
use crate::error::{Error, InvalidKind, Result, near_names};
use crate::kind::{self, ElementKind};

/// View of an element of a spec.
pub struct Element<'s, K = Any> {
    spec: &'s Spec,
    index: Index,
    kind: PhantomData<fn() -> K>,
}

/// View of an element of a spec that can change it. The `set_…` methods return the view, so calls
/// can be chained.
pub struct ElementMut<'s, K = Any> {
    spec: &'s mut Spec,
    index: Index,
    kind: PhantomData<fn() -> K>,
}

impl<'s, K> Element<'s, K> {
    pub(super) fn new(spec: &'s Spec, index: Index) -> Self {
        Self { spec, index, kind: PhantomData }
    }

    /// Returns the id of the element.
    pub fn id(&self) -> ElementId<K> {
        self.spec.id(self.index)
    }

    /// Returns the tag, for example `geom`.
    pub fn tag(&self) -> &'s str {
        self.spec.tree.tag(self.index)
    }

    /// Returns the name of the element. An asset without a name has the name of its file, without
    /// directory and extension.
    #[doc(alias = "mjs_getName")]
    pub fn name(&self) -> Option<&'s str> {
        names::name(&self.spec.tree, self.index)
    }

    /// Returns the text of an attribute, or `None` if the element does not have it. The value may
    /// then come from a class of defaults. The values of a keyframe are in the order in which they
    /// were set; [`numbers`](Self::numbers) has the present one.
    #[doc(alias = "mjs_getString")]
    pub fn attribute(&self, name: &str) -> Option<&'s str> {
        self.spec.tree.attribute(self.index, name)
    }

    /// Returns the attributes and their texts.
    pub fn attributes(&self) -> impl Iterator<Item = (&'s str, &'s str)> {
        self.spec.tree.node(self.index).attributes.iter().map(|(name, value)| (&name[..], &value[..]))
    }

    /// Returns the numbers in an attribute, or `None` if the element does not have it. The values
    /// of a keyframe are those of the present elements, as [`Spec::compile`] places them.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the attribute is not a list of numbers, or if values of a keyframe
    /// cannot be placed.
    #[doc(alias = "mjs_getDouble")]
    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        if keyframes::has_owners(&self.spec.tree, self.index, name)
            && let Some(values) = keyframes::values(&attach::resolved(&self.spec.tree), self.index, name)?
        {
            return Ok(Some(values));
        }
        let numbers = value::numbers(text).ok_or_else(|| {
            let what = format!("attribute '{name}' of {}", names::describe(&self.spec.tree, self.index));
            Error::invalid(InvalidKind::Text, what, format!("'{text}'"), "a list of numbers")
        })?;
        Ok(Some(numbers))
    }

    /// Returns the element that contains this one, or `None` for the root.
    #[doc(alias = "mjs_getParent")]
    pub fn parent(&self) -> Option<ElementId> {
        self.spec.tree.parent(self.index).map(|index| self.spec.id(index))
    }

    /// Returns the elements directly in this one.
    #[doc(alias = "mjs_firstChild")]
    #[doc(alias = "mjs_nextChild")]
    pub fn children(&self) -> impl Iterator<Item = ElementId> + 's {
        let spec = self.spec;
        spec.tree.children(self.index).iter().map(|&index| spec.id(index))
    }
}

impl<K> fmt::Debug for Element<'_, K> {
    /// Writes the kind and the name: `geom 'foot'`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&names::describe(&self.spec.tree, self.index))
    }
}

impl<K> fmt::Debug for ElementMut<'_, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&names::describe(&self.spec.tree, self.index))
    }
}

impl<'s, K> ElementMut<'s, K> {
    pub(super) fn new(spec: &'s mut Spec, index: Index) -> Self {
        Self { spec, index, kind: PhantomData }
    }

    /// Returns the id of the element.
    pub fn id(&self) -> ElementId<K> {
        self.spec.id(self.index)
    }

    /// Returns a view for reading.
    pub fn view(&self) -> Element<'_, K> {
        Element::new(self.spec, self.index)
    }

    /// Sets an attribute. The names of attributes, their units and the words for enums are the same
    /// as in [MJCF](https://mujoco.readthedocs.io/en/stable/XMLreference.html).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the engine does not know the attribute, or the value has a NUL
    /// character. Otherwise the value is checked when the spec is compiled.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::new("ball");
    /// let error = spec.add_geom(spec.world()).set("frictoin", [1.0, 0.1, 0.1]).unwrap_err();
    /// assert!(error.to_string().contains("friction"), "{error}");
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_setString")]
    #[doc(alias = "mjs_setDouble")]
    #[doc(alias = "mjs_setInt")]
    #[doc(alias = "mjs_setFloat")]
    #[allow(clippy::needless_pass_by_value, reason = "the argument is often a literal")]
    pub fn set(&mut self, attribute: &str, value: impl Value) -> Result<&mut Self> {
        let schema = Schema::of_engine()?;
        if !schema.has(&self.spec.tree, self.index, attribute) {
            let known = schema.attributes(&self.spec.tree, self.index).unwrap_or_default();
            let near = near_names(attribute, known.iter().copied());
            let similar = if near.is_empty() { String::new() } else { format!("perhaps {}; ", near.join(" or ")) };
            let expected = format!("{similar}one of {}", known.join(", "));
            let what = format!("the name of an attribute of {}", names::describe(&self.spec.tree, self.index));
            return Err(Error::invalid(InvalidKind::Unknown, what, format!("'{attribute}'"), expected));
        }
        check_character(&self.spec.tree, self.index, attribute, &value.text())?;
        if attribute == "name" {
            return Ok(self.set_name(&value.text()));
        }
        Ok(self.put(attribute, &value))
    }

    /// Removes an attribute, so that the value of the class of defaults applies. Returns its text.
    pub fn unset(&mut self, attribute: &str) -> Option<String> {
        self.spec.tree.node_mut(self.index).unset(attribute)
    }

    /// Sets the name, and replaces it in all attributes that refer to the element. Names must be
    /// unique in a kind: if another element has the new name, the references to both are the same
    /// afterwards.
    #[doc(alias = "mjs_setName")]
    pub fn set_name(&mut self, name: &str) -> &mut Self {
        let tree = &mut self.spec.tree;
        let Some(class) = names::named(tree, self.index) else { return self };
        let old = names::name(tree, self.index).map(str::to_owned);
        tree.node_mut(self.index).set(names::name_attribute(class), name.to_owned());
        // If another element has the old name too, the references are those to that one.
        if let Some(old) = old.filter(|old| names::find(tree, class, old).is_none()) {
            names::rename_references(tree, class, &old, name);
        }
        self
    }

    /// Sets the class of defaults.
    #[doc(alias = "mjs_setDefault")]
    pub fn set_class(&mut self, class: &str) -> &mut Self {
        self.put("class", &class)
    }

    /// Adds an element to this one.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the engine does not accept the element here.
    pub fn add(&mut self, tag: &str) -> Result<ElementMut<'_>> {
        self.spec.check_child(self.index, tag)?;
        Ok(self.append(tag))
    }

    /// Adds an element that the engine accepts here.
    pub(super) fn append(&mut self, tag: &str) -> ElementMut<'_> {
        self.spec.append(self.index, tag)
    }

    /// Sets an attribute that the engine knows.
    pub(super) fn put(&mut self, attribute: &str, value: &impl Value) -> &mut Self {
        let text = value.text().into_owned();
        self.spec.tree.node_mut(self.index).set(attribute, text);
        keyframes::remember(&mut self.spec.tree, self.index, attribute);
        self
    }

    pub(super) fn spec(&mut self) -> &mut Spec {
        self.spec
    }
}

/// # Elements by id
impl Spec {
    /// Returns a view of an element.
    ///
    /// # Panics
    ///
    /// If the id belongs to another spec, or the element was removed.
    #[track_caller]
    pub fn element<K>(&self, id: ElementId<K>) -> Element<'_, K> {
        Element::new(self, self.index(id))
    }

    /// Returns a view of an element that can change it.
    ///
    /// # Panics
    ///
    /// As for [`element`](Self::element).
    #[track_caller]
    pub fn edit<K>(&mut self, id: ElementId<K>) -> ElementMut<'_, K> {
        let index = self.index(id);
        ElementMut::new(self, index)
    }

    /// Returns `true` if the element belongs to this spec and was not removed.
    pub fn contains<K>(&self, id: ElementId<K>) -> bool {
        self.owns(id) && self.tree.contains(id.index())
    }

    /// Returns the ids of all elements of a kind, in the order of the text.
    ///
    /// ```
    /// use mujoco_safe::kind::Geom;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::from_xml_str("<mujoco><worldbody><geom size='1'/><geom size='2'/></worldbody></mujoco>")?;
    /// for geom in spec.ids::<Geom>() {
    ///     spec.edit(geom).set_rgba([1.0, 0.0, 0.0, 1.0]);
    /// }
    /// assert_eq!(spec.compile()?.geom_rgba()[1], [1.0, 0.0, 0.0, 1.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_firstElement")]
    #[doc(alias = "mjs_nextElement")]
    pub fn ids<K: ElementKind>(&self) -> Vec<ElementId<K>> {
        names::all(&self.tree, Named::Kind(K::KIND)).map(|index| self.id(index)).collect()
    }

    /// Returns the id with a kind, or `None` if the element has another one.
    pub fn typed<K: ElementKind>(&self, id: ElementId) -> Option<ElementId<K>> {
        let index = self.index(id);
        (names::kind(&self.tree, index) == K::KIND.into()).then(|| self.id(index))
    }
}

/// Declares the lookups of a kind.
macro_rules! lookups {
    ($($name:ident $name_mut:ident $kind:ident;)*) => {
        /// # Elements by name
        impl Spec {
            $(
                #[doc = concat!("Returns the ", stringify!($name), " with a name or an id.")]
                ///
                /// # Errors
                ///
                /// [`Error::NoSuchName`] for a name that does not exist.
                #[doc(alias = "mjs_findElement")]
                #[track_caller]
                pub fn $name<Q: IntoElementId<kind::$kind>>(&self, key: Q) -> Q::Found<Element<'_, kind::$kind>> {
                    Q::map(key.find(self), |index| Element::new(self, index))
                }

                #[doc = concat!("Returns the ", stringify!($name), " with a name or an id, to change it.")]
                ///
                /// # Errors
                ///
                /// [`Error::NoSuchName`] for a name that does not exist.
                #[track_caller]
                pub fn $name_mut<Q: IntoElementId<kind::$kind>>(&mut self, key: Q) -> Q::Found<ElementMut<'_, kind::$kind>> {
                    Q::map(key.find(self), |index| ElementMut::new(self, index))
                }
            )*
        }
    };
}

lookups! {
    body body_mut Body;
    joint joint_mut Joint;
    geom geom_mut Geom;
    site site_mut Site;
    camera camera_mut Camera;
    light light_mut Light;
    mesh mesh_mut Mesh;
    skin skin_mut Skin;
    height_field height_field_mut HeightField;
    texture texture_mut Texture;
    material material_mut Material;
    pair pair_mut Pair;
    exclude exclude_mut Exclude;
    equality equality_mut Equality;
    tendon tendon_mut Tendon;
    actuator actuator_mut Actuator;
    sensor sensor_mut Sensor;
    numeric numeric_mut Numeric;
    text text_mut Text;
    tuple tuple_mut Tuple;
    keyframe keyframe_mut Keyframe;
}

impl<K: SpecKind> From<ElementMut<'_, K>> for ElementId<K> {
    fn from(element: ElementMut<'_, K>) -> Self {
        element.id()
    }
}
