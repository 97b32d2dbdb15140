//! Kinematic trees: the bodies and degrees of freedom below each body that moves relative to the
//! world, and the trees that a tendon connects.

use mujoco_sys::{
    mjJNT_SLIDE, mjSLEEP_ALLOWED, mjSLEEP_AUTO_ALLOWED, mjSLEEP_AUTO_NEVER, mjSLEEP_INIT, mjWRAP_JOINT, mjWRAP_PULLEY,
    mjWRAP_SITE,
};

use super::super::invalid::Invalid;
use super::super::layout::{field, size};
use super::super::rule::{all_in, is, piece, size_is};
use super::super::view::View;
use super::sparsity;

/// Checks the trees and the matrices whose sparsity depends on them, after bodies, joints and
/// degrees of freedom.
pub(in super::super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    trees(view)?;
    // The number of bodies with gravity compensation, which the engine compares with zero.
    if view.size(size::ngravcomp) > view.size(size::nbody) {
        let count = view.size(size::ngravcomp);
        return Err(Invalid::scalar("ngravcomp", count, format!("the model has {} bodies", view.size(size::nbody))));
    }
    sparsity::check(view)
}

/// Checks that a simple body is marked as one with slides if all its joints are slides.
pub(in super::super) fn check_simple(view: &View<'_>, body: usize) -> Result<(), Invalid> {
    if view.get(field::body_simple, body) == 0 {
        return Ok(());
    }
    let joints = piece(view, field::body_jntadr, field::body_jntnum, body);
    let slides = !joints.is_empty() && joints.into_iter().all(|i| view.get(field::jnt_type, i) as u32 == mjJNT_SLIDE);
    is(view, field::body_simple, body, if slides { 2 } else { 1 }, "or 0, because of its joints")
}

/// Checks the numbers and addresses of trees. A degree of freedom without a parent begins a tree.
fn trees(view: &View<'_>) -> Result<(), Invalid> {
    const WHY: &str = "the tree of the next degree of freedom towards the world";
    let ntree = view.size(size::ntree);
    let starts: Vec<usize> = (0..view.size(size::nv)).filter(|&i| view.get(field::dof_parentid, i) == -1).collect();
    size_is(view, size::ntree, starts.len() as u64, "the number of degrees of freedom without a parent")?;
    let ends = starts.iter().skip(1).copied().chain([view.size(size::nv)]);
    for (tree, (&start, end)) in starts.iter().zip(ends).enumerate() {
        is(view, field::tree_dofadr, tree, start as i64, "its first degree of freedom")?;
        is(view, field::tree_dofnum, tree, (end - start) as i64, "its degrees of freedom")?;
        (start..end).try_for_each(|i| is(view, field::dof_treeid, i, tree as i64, WHY))?;
    }

    let mut counts = vec![0; ntree];
    for body in 0..view.size(size::nbody) {
        let weld = view.get(field::body_weldid, body) as usize;
        let tree = match view.get(field::body_dofnum, weld) {
            0 => -1,
            _ => view.get(field::dof_treeid, view.get(field::body_dofadr, weld) as usize),
        };
        is(view, field::body_treeid, body, tree.into(), "the tree of its degrees of freedom, or -1 for none")?;
        let Ok(tree) = usize::try_from(tree) else { continue };
        if counts[tree] == 0 {
            is(view, field::tree_bodyadr, tree, body as i64, "its first body")?;
        }
        counts[tree] += 1;
    }
    for (tree, count) in counts.into_iter().enumerate() {
        is(view, field::tree_bodynum, tree, count, "the number of its bodies")?;
    }
    all_in(view, field::tree_sleep_policy, mjSLEEP_AUTO_NEVER.into()..=mjSLEEP_INIT.into())
}

/// Checks the trees that each tendon connects, after the paths of tendons. The sleep of a body
/// assumes that a tendon between more than two trees keeps them awake.
pub(in super::super) fn check_tendons(view: &View<'_>) -> Result<(), Invalid> {
    for tendon in 0..view.size(size::ntendon) {
        let mut trees: Vec<i32> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        for i in piece(view, field::tendon_adr, field::tendon_num, tendon) {
            let object = view.get(field::wrap_objid, i) as usize;
            let body = match view.get(field::wrap_type, i) as u32 {
                mjWRAP_JOINT => field::jnt_bodyid,
                mjWRAP_PULLEY => continue,
                mjWRAP_SITE => field::site_bodyid,
                _ => field::geom_bodyid,
            };
            let tree = view.get(field::body_treeid, view.get(body, object) as usize);
            if tree >= 0 && seen.insert(tree) {
                trees.push(tree);
            }
        }
        is(view, field::tendon_treenum, tendon, trees.len() as i64, "the number of trees along its path")?;
        for i in 0..2 {
            let tree = trees.get(i).copied().unwrap_or(-1);
            is(view, field::tendon_treeid, 2 * tendon + i, tree.into(), "the tree along its path, or -1 for none")?;
        }
        if trees.len() > 2 {
            for tree in trees {
                let policy = view.get(field::tree_sleep_policy, tree as usize);
                if matches!(policy as u32, mjSLEEP_AUTO_ALLOWED | mjSLEEP_ALLOWED | mjSLEEP_INIT) {
                    let expected = format!("tendon {tendon} connects more than two trees, which must not sleep");
                    return Err(Invalid::element(field::tree_sleep_policy.name(), tree as usize, policy, expected));
                }
            }
        }
    }
    Ok(())
}
