//! Pairs of geoms, pairs of bodies, and equality constraints.

use mujoco_safe::element::EqualityObjects;
use mujoco_safe::sys;

use super::{check_fields, int, models, on_model, optional, raw};
use crate::twins::differing;

#[test]
fn fields_of_pairs_excludes_and_equalities_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        check_fields!(name, model.pairs(), |pair, i| {
            dim: m.pair_dim, [i; 1];
            signature: m.pair_signature, [i; 1];
            solref: m.pair_solref, [2 * i; 2];
            solimp: m.pair_solimp, [5 * i; 5];
            margin: m.pair_margin, [i; 1];
            gap: m.pair_gap, [i; 1];
            friction: m.pair_friction, [5 * i; 5];
            => geom1: pair.geom1().index(), int(m.pair_geom1, i);
            => geom2: pair.geom2().index(), int(m.pair_geom2, i);
        });
        let first = usize::from(!cfg!(engine_since = "3.0.0"));
        check_fields!(name, model.excludes(), |exclude, i| {
            signature: m.exclude_signature, [i; 1];
            // The header's formula: (body1+1)<<16 + body2+1, since 3.0 body1<<16 + body2.
            => body1: ((exclude.body1().index() + first) << 16) + exclude.body2().index() + first, int(m.exclude_signature, i);
            => body2: exclude.body2().index() + first, int(m.exclude_signature, i) % (1 << 16);
        });
        check_fields!(name, model.equalities(), |equality, i| {
            active: differing::equality_active(m), [i; 1];
            solref: m.eq_solref, [2 * i; 2];
            solimp: m.eq_solimp, [5 * i; 5];
            data: m.eq_data, [sys::mjNEQDATA as usize * i; sys::mjNEQDATA as usize];
            => equality_type: equality.equality_type() as i32, raw(m.eq_type, i);
            => objects: raw_objects(equality.objects()), [raw(m.eq_obj1id, i), raw(m.eq_obj2id, i)];
        });
    }
}

fn raw_objects(objects: EqualityObjects) -> [i32; 2] {
    match objects {
        EqualityObjects::Bodies(one, other) => [one.index() as i32, other.index() as i32],
        EqualityObjects::Joints(one, other) => [one.index() as i32, optional(other)],
        EqualityObjects::Tendons(one, other) => [one.index() as i32, optional(other)],
        other => panic!("unexpected objects: {other:?}"),
    }
}
