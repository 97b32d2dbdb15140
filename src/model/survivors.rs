//! Elements of a model that are also in another one.
//!
//! [`Data::adopt`](crate::Data::adopt) documents the rules.

use std::collections::HashMap;

use super::Model;
use super::identity::IDENTIFIED;
use crate::enums::EqualityType;
use crate::ffi;
use crate::kind::Kind;

/// Kinds of elements whose state a simulation keeps. A kind comes after those that its elements
/// refer to.
pub(crate) const KINDS: [Kind; 8] =
    [Kind::Body, Kind::Joint, Kind::Tendon, Kind::Flex, Kind::Actuator, Kind::Equality, Kind::Sensor, Kind::Plugin];

/// Elements of an old model that are also in a new one.
pub(crate) struct Survivors<'m> {
    old: &'m Model,
    new: &'m Model,
    /// For each element of the new model the same element of the old one.
    origins: HashMap<Kind, Vec<Option<usize>>>,
}

impl<'m> Survivors<'m> {
    pub(crate) fn of(old: &'m Model, new: &'m Model) -> Self {
        let mut survivors = Self { old, new, origins: HashMap::new() };
        for kind in KINDS {
            survivors.find(kind);
        }
        survivors
    }

    /// Returns the element of the old model that an element of the new one is.
    pub(crate) fn origin(&self, kind: Kind, new: usize) -> Option<usize> {
        self.origins.get(&kind)?.get(new).copied().flatten()
    }

    /// Returns the surviving elements of a kind, as pairs of their indices in the new and in the
    /// old model.
    pub(crate) fn pairs(&self, kind: Kind) -> impl Iterator<Item = (usize, usize)> {
        let origins = self.origins.get(&kind).into_iter().flatten().enumerate();
        origins.filter_map(|(new, origin)| Some((new, (*origin)?)))
    }

    /// Returns `true` if all elements survive with their indices.
    pub(crate) fn are_all(&self) -> bool {
        KINDS.iter().all(|&kind| {
            let count = self.new.count(kind);
            count == self.old.count(kind) && (0..count).all(|index| self.origin(kind, index) == Some(index))
        })
    }

    fn find(&mut self, kind: Kind) {
        let (old, new) = (self.old, self.new);
        if old.is_same_structure(new) {
            self.origins.insert(kind, (0..new.count(kind)).map(Some).collect());
            return;
        }
        let mut pairing = Pairing::new(old.count(kind), new.count(kind));
        if kind == Kind::Body {
            pairing.join(0, 0);
        }
        let identities = old.identities.as_deref().zip(new.identities.as_deref());
        let identities = identities.filter(|(old, new)| old.spec == new.spec && IDENTIFIED.contains(&kind));
        if let Some((old_ones, new_ones)) = identities {
            let known: HashMap<_, _> =
                (0..old.count(kind)).filter_map(|index| Some((old_ones.get(kind, index)?, index))).collect();
            for index in 0..new.count(kind) {
                if let Some(&origin) = new_ones.get(kind, index).and_then(|identity| known.get(identity)) {
                    pairing.join(index, origin);
                }
            }
        }
        // Two elements with identities are the same only if the identities are.
        let are_distinct = |new: usize, old: usize| {
            identities.is_some_and(|(a, b)| a.get(kind, old).is_some() && b.get(kind, new).is_some())
        };
        let name = |index: usize| Some((old.name_at(kind, index)?, index));
        let names: HashMap<&str, usize> = (0..old.count(kind)).filter_map(name).collect();
        // Elements without identities may be copies of elements of the specs, which must be the
        // same.
        let have_same_sources =
            |name: Option<&str>| identities.is_none_or(|(old, new)| old.sources(kind, name) == new.sources(kind, name));
        for index in 0..new.count(kind) {
            let Some((name, &origin)) = new.name_at(kind, index).and_then(|name| names.get_key_value(name)) else {
                continue;
            };
            if !are_distinct(index, origin) && have_same_sources(Some(name)) {
                pairing.join(index, origin);
            }
        }
        self.origins.insert(kind, pairing.origins);
        // The compiler can fuse other bodies although the spec has the same ones, so a body or
        // joint is found by its order only if all of them are found.
        let is_fixed = !matches!(kind, Kind::Body | Kind::Joint);
        let all_are_found = identities.is_none_or(|(old, _)| old.sources(kind, None).is_empty());
        if have_same_sources(None) && (is_fixed || all_are_found) {
            self.find_unnamed(kind, &pairing.is_taken, &are_distinct);
        }
        #[cfg(engine_since = "2.3.0")]
        if kind == Kind::Plugin {
            self.find_plugins();
        }
        for index in 0..new.count(kind) {
            if self.origin(kind, index).is_some_and(|origin| !self.has_same_values(kind, index, origin)) {
                self.set(kind, index, None);
            }
        }
    }

    fn set(&mut self, kind: Kind, new: usize, old: Option<usize>) {
        if let Some(place) = self.origins.get_mut(&kind).and_then(|origins| origins.get_mut(new)) {
            *place = old;
        }
    }

    /// Pairs elements without names by their order, if all those of a parent are alike.
    fn find_unnamed(&mut self, kind: Kind, is_taken: &[bool], are_distinct: &dyn Fn(usize, usize) -> bool) {
        let (old, new) = (self.old, self.new);
        let mut old_groups: HashMap<usize, Vec<usize>> = HashMap::new();
        for index in (0..old.count(kind)).filter(|&index| !is_taken[index] && old.name_at(kind, index).is_none()) {
            old_groups.entry(parent(old, kind, index)).or_default().push(index);
        }
        let mut new_groups: HashMap<usize, Vec<usize>> = HashMap::new();
        for index in (0..new.count(kind)).filter(|&index| new.name_at(kind, index).is_none()) {
            if self.origin(kind, index).is_none() {
                new_groups.entry(parent(new, kind, index)).or_default().push(index);
            }
        }
        let mut parents: Vec<usize> = new_groups.keys().copied().collect();
        // A parent body comes before its children.
        parents.sort_unstable();
        for group in parents {
            let new_ones = &new_groups[&group];
            let origin =
                if matches!(kind, Kind::Body | Kind::Joint) { self.origin(Kind::Body, group) } else { Some(0) };
            let Some(old_ones) = origin.and_then(|origin| old_groups.get(&origin)) else { continue };
            let pairs = new_ones.iter().copied().zip(old_ones.iter().copied());
            let may_be_same = |(new, old)| !are_distinct(new, old) && self.are_alike(kind, new, old);
            if new_ones.len() == old_ones.len() && pairs.clone().all(may_be_same) {
                pairs.for_each(|(new, old)| self.set(kind, new, Some(old)));
            }
        }
    }

    /// Returns `true` if elements have state of the same kind.
    fn has_same_values(&self, kind: Kind, new: usize, old: usize) -> bool {
        let (a, b) = (self.new, self.old);
        match kind {
            Kind::Joint => a.jnt_type()[new] == b.jnt_type()[old],
            Kind::Sensor => a.sensor_type()[new] == b.sensor_type()[old] && a.sensor_dim()[new] == b.sensor_dim()[old],
            #[cfg(engine_since = "2.3.0")]
            Kind::Plugin => a.plugin()[new] == b.plugin()[old] && a.plugin_statenum()[new] == b.plugin_statenum()[old],
            _ => true,
        }
    }

    /// Returns `true` if two elements without names may be the same.
    fn are_alike(&self, kind: Kind, new: usize, old: usize) -> bool {
        let (a, b) = (self.new, self.old);
        let refers_alike = |kind: Option<Kind>, new: i32, old: i32| self.refers_alike(kind, new, old);
        self.has_same_values(kind, new, old)
            && match kind {
                Kind::Body => {
                    joint_types(a, new) == joint_types(b, old)
                        && (a.body_mocapid()[new] < 0) == (b.body_mocapid()[old] < 0)
                }
                Kind::Tendon => {
                    let [new, old] = [path(a, new), path(b, old)];
                    let are_alike = |(&(form, new), (other, old)): (&(i32, i32), &(i32, i32))| {
                        form == *other && refers_alike(kind_of_wrap(form), new, *old)
                    };
                    new.len() == old.len() && new.iter().zip(&old).all(are_alike)
                }
                #[cfg(engine_since = "3.0.0")]
                Kind::Flex => a.flex_vertnum()[new] == b.flex_vertnum()[old],
                Kind::Actuator => {
                    let target = target(a.actuator_trntype()[new]);
                    let [first, second] =
                        [0, 1].map(|end| (a.actuator_trnid()[new][end], b.actuator_trnid()[old][end]));
                    a.actuator_trntype()[new] == b.actuator_trntype()[old]
                        && a.actuator_dyntype()[new] == b.actuator_dyntype()[old]
                        && refers_alike(target, first.0, first.1)
                        && refers_alike(Some(Kind::Site), second.0, second.1)
                }
                Kind::Equality => {
                    let target = match EqualityType::of_field(a.eq_type()[new]) {
                        EqualityType::Connect | EqualityType::Weld if a.couples_sites(new) => Some(Kind::Site),
                        EqualityType::Connect | EqualityType::Weld => Some(Kind::Body),
                        EqualityType::Joint => Some(Kind::Joint),
                        EqualityType::Tendon => Some(Kind::Tendon),
                        EqualityType::Flex | EqualityType::FlexVertex | EqualityType::FlexStrain => Some(Kind::Flex),
                    };
                    a.eq_type()[new] == b.eq_type()[old]
                        && a.couples_sites(new) == b.couples_sites(old)
                        && refers_alike(target, a.eq_obj1id()[new], b.eq_obj1id()[old])
                        && refers_alike(target, a.eq_obj2id()[new], b.eq_obj2id()[old])
                }
                Kind::Sensor => {
                    let (target, reference) = (a.sensor_objtype()[new], a.sensor_reftype()[new]);
                    #[cfg(engine_since = "3.3.6")]
                    let have_same_numbers = a.sensor_intprm()[new] == b.sensor_intprm()[old];
                    #[cfg(not(engine_since = "3.3.6"))]
                    let have_same_numbers = true;
                    (target, reference) == (b.sensor_objtype()[old], b.sensor_reftype()[old])
                        && have_same_numbers
                        && refers_alike(kind_of(target), a.sensor_objid()[new], b.sensor_objid()[old])
                        && refers_alike(kind_of(reference), a.sensor_refid()[new], b.sensor_refid()[old])
                }
                // Plugins are paired by the elements to which they belong.
                Kind::Plugin => false,
                _ => true,
            }
    }

    /// Returns `true` if two references to elements of a kind are to the same element. `-1` refers
    /// to none.
    fn refers_alike(&self, kind: Option<Kind>, new: i32, old: i32) -> bool {
        match (kind, usize::try_from(new), usize::try_from(old)) {
            (_, Err(_), Err(_)) => true,
            (Some(kind), Ok(new), Ok(old)) if KINDS.contains(&kind) => self.origin(kind, new) == Some(old),
            (Some(kind), Ok(new), Ok(old)) => self.new.name_at(kind, new) == self.old.name_at(kind, old),
            _ => false,
        }
    }

    /// Pairs the instances of plugins without names by the elements to which they belong.
    #[cfg(engine_since = "2.3.0")]
    fn find_plugins(&mut self) {
        let old: HashMap<_, _> = owners(self.old).collect();
        for (owner, new) in owners(self.new) {
            let origin = self.origin(owner.0, owner.1).and_then(|index| old.get(&(owner.0, index)));
            let is_unnamed = |&&old: &&usize| {
                let [a, b] = [self.new.name_at(Kind::Plugin, new), self.old.name_at(Kind::Plugin, old)];
                a.is_none() && b.is_none()
            };
            if let Some(&origin) = origin.filter(is_unnamed) {
                self.set(Kind::Plugin, new, Some(origin));
            }
        }
    }
}

/// Returns the elements that have an instance of a plugin, and the instances.
#[cfg(engine_since = "2.3.0")]
fn owners(model: &Model) -> impl Iterator<Item = ((Kind, usize), usize)> {
    let of = |kind, plugins: &'_ [i32]| {
        let instances = plugins.iter().enumerate();
        instances
            .filter_map(|(index, &plugin)| Some(((kind, index), usize::try_from(plugin).ok()?)))
            .collect::<Vec<_>>()
    };
    let [bodies, actuators, sensors] = [
        of(Kind::Body, model.body_plugin()),
        of(Kind::Actuator, model.actuator_plugin()),
        of(Kind::Sensor, model.sensor_plugin()),
    ];
    bodies.into_iter().chain(actuators).chain(sensors)
}

/// Returns the types of the joints of a body.
fn joint_types(model: &Model, body: usize) -> &[i32] {
    let first = usize::try_from(model.body_jntadr()[body]).unwrap_or_default();
    &model.jnt_type()[first..][..ffi::size(model.body_jntnum()[body])]
}

/// Returns the kind of elements that a transmission of this type drives.
fn target(transmission: i32) -> Option<Kind> {
    match transmission as u32 {
        mujoco_sys::mjTRN_JOINT | mujoco_sys::mjTRN_JOINTINPARENT => Some(Kind::Joint),
        mujoco_sys::mjTRN_TENDON => Some(Kind::Tendon),
        mujoco_sys::mjTRN_SITE | mujoco_sys::mjTRN_SLIDERCRANK => Some(Kind::Site),
        mujoco_sys::mjTRN_BODY => Some(Kind::Body),
        _ => None,
    }
}

/// Returns the types of the parts of a tendon's path, and the elements to which they refer.
fn path(model: &Model, tendon: usize) -> Vec<(i32, i32)> {
    let parts = ffi::size(model.tendon_adr()[tendon])..;
    let parts = parts.take(ffi::size(model.tendon_num()[tendon]));
    parts.map(|part| (model.wrap_type()[part], model.wrap_objid()[part])).collect()
}

/// Returns the kind of the element to which a part of a tendon's path refers.
fn kind_of_wrap(form: i32) -> Option<Kind> {
    match form as u32 {
        mujoco_sys::mjWRAP_JOINT => Some(Kind::Joint),
        mujoco_sys::mjWRAP_SITE => Some(Kind::Site),
        mujoco_sys::mjWRAP_SPHERE | mujoco_sys::mjWRAP_CYLINDER => Some(Kind::Geom),
        _ => None,
    }
}

/// Returns the kind of an `mjtObj`.
fn kind_of(object: i32) -> Option<Kind> {
    if object as u32 == mujoco_sys::mjOBJ_XBODY {
        return Some(Kind::Body);
    }
    Kind::ALL.iter().copied().find(|kind| kind.object_type() == object)
}

/// Returns the body that contains an element, or 0 for elements that are in no body.
fn parent(model: &Model, kind: Kind, index: usize) -> usize {
    match kind {
        Kind::Body => ffi::size(model.body_parentid()[index]),
        Kind::Joint => ffi::size(model.jnt_bodyid()[index]),
        _ => 0,
    }
}

/// Pairs of elements of one kind.
struct Pairing {
    origins: Vec<Option<usize>>,
    /// Old elements that have a partner.
    is_taken: Vec<bool>,
}

impl Pairing {
    fn new(old: usize, new: usize) -> Self {
        Self { origins: vec![None; new], is_taken: vec![false; old] }
    }

    /// Joins two elements, unless one of them has a partner.
    fn join(&mut self, new: usize, old: usize) {
        if self.origins[new].is_none() && !self.is_taken[old] {
            self.origins[new] = Some(old);
            self.is_taken[old] = true;
        }
    }
}
