//! The kinematic tree: bodies, joints and degrees of freedom.
//!
//! The engine traverses these arrays without bounds checks. Nearly all of their contents follow
//! from three facts about each body: its parent, the number of its joints, and their types. These
//! are checked. The rest is recomputed by the compiler's rules and compared.

use mujoco_sys::{mjJNT_BALL, mjJNT_FREE, mjJNT_HINGE, mjJNT_SLIDE};

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{all_bytes, all_in, is, is_in, size_is};
use super::view::View;

/// Limit on the degrees of freedom of one body: the size of the engine's fixed buffers for the
/// joints of a body.
const MOST_BODY_DOFS: usize = 6;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    parents(view)?;
    all_bytes(view, field::jnt_limited, 1)?;
    flags(view)?;
    let types = i64::from(mjJNT_FREE)..=i64::from(mjJNT_HINGE);
    all_in(view, field::jnt_type, types)?;
    joints(view)?;
    inertia(view)?;
    simple(view)?;
    #[cfg(engine_since = "3.5.0")]
    super::newer::check_trees(view)?;
    Ok(())
}

/// Checks flags. The value 2 of `sameframe` (inertial frame) is valid only for elements attached to
/// a body.
#[cfg(not(engine_since = "3.5.0"))]
fn flags(view: &View<'_>) -> Result<(), Invalid> {
    all_bytes(view, field::body_simple, 1)?;
    all_bytes(view, field::body_sameframe, 1)
}

/// Checks flags. The value 2 of `simple` marks bodies whose joints are slides. The values 2 and 4
/// of `sameframe` (inertial frame) are valid only for elements attached to a body.
#[cfg(engine_since = "3.5.0")]
fn flags(view: &View<'_>) -> Result<(), Invalid> {
    use mujoco_sys::{mjSAMEFRAME_INERTIA, mjSAMEFRAME_INERTIAROT};

    all_bytes(view, field::body_simple, 2)?;
    all_bytes(view, field::body_sameframe, mjSAMEFRAME_INERTIAROT as u8 - 1)?;
    if let Some(i) = view.values(field::body_sameframe).position(|flag| u32::from(flag) == mjSAMEFRAME_INERTIA) {
        let expected = "it must be 0, 1 or 3, because the inertial frame is that of the body itself";
        return Err(Invalid::element(field::body_sameframe.name(), i, mjSAMEFRAME_INERTIA, expected));
    }
    all_bytes(view, field::jnt_actfrclimited, 1)?;
    all_bytes(view, field::jnt_actgravcomp, 1)
}

/// Checks parents, roots, and the depth-first order, in which a subtree is a range of ids.
fn parents(view: &View<'_>) -> Result<(), Invalid> {
    const WORLD: &str = "which is the world itself";
    is(view, field::body_parentid, 0, 0, WORLD)?;
    is(view, field::body_rootid, 0, 0, WORLD)?;
    for i in 1..view.size(size::nbody) {
        is_in(view, field::body_parentid, i, 0..=i as i64 - 1)?;
        let parent = view.get(field::body_parentid, i) as usize;
        let mut ancestor = i - 1;
        while ancestor > parent {
            ancestor = view.get(field::body_parentid, ancestor) as usize;
        }
        if ancestor != parent {
            let previous = i - 1;
            let expected =
                format!("bodies must be in depth-first order, so it must be {previous} or an ancestor of it");
            return Err(Invalid::element(field::body_parentid.name(), i, parent, expected));
        }
        let root = if parent == 0 { i as i64 } else { i64::from(view.get(field::body_rootid, parent)) };
        is(view, field::body_rootid, i, root, "the ancestor just below the world")?;
    }
    Ok(())
}

/// Checks that joints and degrees of freedom are in the order of their bodies, and checks welds and
/// mocap bodies, which depend on the joints.
fn joints(view: &View<'_>) -> Result<(), Invalid> {
    const FOLLOWS: &str = "the end of the previous joints";
    let (nbody, njnt, nv) = (view.size(size::nbody), view.size(size::njnt), view.size(size::nv));
    let mut last_dof = vec![-1_i64; nbody];
    let (mut joint, mut qpos, mut dof, mut mocap) = (0, 0, 0, 0);
    for body in 0..nbody {
        let parent = view.get(field::body_parentid, body) as usize;
        let most = if body == 0 { 0 } else { njnt - joint };
        is_in(view, field::body_jntnum, body, 0..=most as i64)?;
        let count = view.get(field::body_jntnum, body) as usize;
        let adr = if count == 0 { -1 } else { joint as i64 };
        is(view, field::body_jntadr, body, adr, "the first joint of the body, or -1 for none")?;

        let first_dof = dof;
        let mut previous = if body == 0 { -1 } else { last_dof[parent] };
        for id in joint..joint + count {
            let (positions, dofs) = joint_size(view.get(field::jnt_type, id));
            if dofs == 6 && (count > 1 || parent != 0) {
                let expected = "a free joint must be the only joint of its body, and the body a child of the world";
                return Err(Invalid::element(field::jnt_type.name(), id, mjJNT_FREE, expected));
            }
            is(view, field::jnt_bodyid, id, body as i64, "the body of the joint")?;
            is(view, field::jnt_qposadr, id, qpos, FOLLOWS)?;
            is(view, field::jnt_dofadr, id, dof as i64, FOLLOWS)?;
            if dof + dofs > nv {
                return Err(Invalid::scalar(
                    "nv",
                    nv,
                    format!("the joints up to {id} have {} degrees of freedom", dof + dofs),
                ));
            }
            for i in dof..dof + dofs {
                is(view, field::dof_bodyid, i, body as i64, "the body of its joint")?;
                is(view, field::dof_jntid, i, id as i64, "the joint of this degree of freedom")?;
                is(
                    view,
                    field::dof_parentid,
                    i,
                    previous,
                    "the next degree of freedom towards the world, or -1 for none",
                )?;
                previous = i as i64;
            }
            qpos += positions;
            dof += dofs;
        }
        if dof - first_dof > MOST_BODY_DOFS {
            let expected = format!("the engine supports at most {MOST_BODY_DOFS}");
            return Err(Invalid::element(field::body_dofnum.name(), body, dof - first_dof, expected));
        }
        is(view, field::body_dofnum, body, (dof - first_dof) as i64, "the sum over its joints")?;
        let adr = if dof == first_dof { -1 } else { first_dof as i64 };
        is(view, field::body_dofadr, body, adr, "the first degree of freedom of the body, or -1 for none")?;
        last_dof[body] = previous;
        joint += count;

        let weld = if count > 0 { body as i64 } else { i64::from(view.get(field::body_weldid, parent)) };
        is(
            view,
            field::body_weldid,
            body,
            if body == 0 { 0 } else { weld },
            "the next body towards the world that has joints",
        )?;
        if view.get(field::body_mocapid, body) != -1 {
            if body == 0 || parent != 0 || count > 0 {
                let expected = "only a child of the world without joints can be a mocap body; other bodies have -1";
                return Err(Invalid::element(
                    field::body_mocapid.name(),
                    body,
                    view.get(field::body_mocapid, body),
                    expected,
                ));
            }
            is(view, field::body_mocapid, body, mocap, "the next mocap body, or -1 for none")?;
            mocap += 1;
        }
    }
    size_is(view, size::njnt, joint as u64, "the sum over the bodies")?;
    size_is(view, size::nq, qpos as u64, "the sum over the joints")?;
    size_is(view, size::nv, dof as u64, "the sum over the joints")?;
    size_is(view, size::nmocap, mocap as u64, "the number of mocap bodies")
}

/// Returns the numbers of positions and of degrees of freedom of a validated joint type.
pub(super) fn joint_size(kind: i32) -> (i64, usize) {
    const FREE: i32 = mjJNT_FREE as i32;
    const BALL: i32 = mjJNT_BALL as i32;
    const SLIDE: i32 = mjJNT_SLIDE as i32;
    const HINGE: i32 = mjJNT_HINGE as i32;
    match kind {
        FREE => (7, 6),
        BALL => (4, 3),
        SLIDE | HINGE => (1, 1),
        _ => unreachable!("Bug: an unchecked joint type"),
    }
}

/// Checks the layout of the sparse inertia matrix: row `i` has an element for `i` and for each
/// degree of freedom between it and the world. The sparse derivative has both triangles of the
/// matrix, and the diagonal once.
fn inertia(view: &View<'_>) -> Result<(), Invalid> {
    let mut depth: Vec<u64> = Vec::with_capacity(view.size(size::nv));
    let mut elements = 0;
    for (i, parent) in view.values(field::dof_parentid).enumerate() {
        is(view, field::dof_Madr, i, elements as i64, "the end of the previous row")?;
        let length = 1 + usize::try_from(parent).map_or(0, |parent| depth[parent]);
        depth.push(length);
        elements += length;
    }
    size_is(view, size::nM, elements, "the elements of the inertia matrix")?;
    size_is(view, size::nD, 2 * elements - depth.len() as u64, "2 nM - nv")
}

/// Checks the flags of simple bodies, whose part of the inertia matrix is diagonal. The engine
/// processes their degrees of freedom in runs of `dof_simplenum`, and skips all terms that couple
/// them to other bodies.
fn simple(view: &View<'_>) -> Result<(), Invalid> {
    let nbody = view.size(size::nbody);
    let moves = |body: usize| view.get(field::body_dofnum, body) > 0;
    let mut coupled = vec![false; nbody];
    let mut moving_below = vec![false; nbody];
    for body in 1..nbody {
        let parent = view.get(field::body_parentid, body) as usize;
        coupled[body] = parent != 0 && (coupled[parent] || moves(parent));
    }
    for body in (1..nbody).rev() {
        let parent = view.get(field::body_parentid, body) as usize;
        moving_below[parent] |= moving_below[body] || moves(body);
    }
    for body in 1..nbody {
        if view.get(field::body_simple, body) != 0 && moves(body) && (coupled[body] || moving_below[body]) {
            let expected = "it must be 0, because the body is coupled to another moving body";
            return Err(Invalid::element(field::body_simple.name(), body, 1, expected));
        }
        #[cfg(engine_since = "3.5.0")]
        super::newer::check_simple(view, body)?;
    }
    let mut run = 0;
    for i in (0..view.size(size::nv)).rev() {
        let body = view.get(field::dof_bodyid, i) as usize;
        run = if view.get(field::body_simple, body) == 0 { 0 } else { run + 1 };
        is(view, field::dof_simplenum, i, run, "the length of the run of simple degrees of freedom from here on")?;
    }
    Ok(())
}
