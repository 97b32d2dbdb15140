//! Bodies, joints, geoms, sites, cameras and lights of a model.

use mujoco_safe::enums::GeomType;
use mujoco_safe::sys;

use super::{check_fields, int, joint_sizes, models, on_model, optional, raw, span};
use crate::twins::differing;

/// Returns the engine's number of a type. Our enum omits some of the engine's types, so its
/// discriminants differ.
fn geom_type(shape: GeomType) -> i32 {
    (match shape {
        GeomType::Plane => sys::mjGEOM_PLANE,
        GeomType::HeightField => sys::mjGEOM_HFIELD,
        GeomType::Sphere => sys::mjGEOM_SPHERE,
        GeomType::Capsule => sys::mjGEOM_CAPSULE,
        GeomType::Ellipsoid => sys::mjGEOM_ELLIPSOID,
        GeomType::Cylinder => sys::mjGEOM_CYLINDER,
        GeomType::Box => sys::mjGEOM_BOX,
        GeomType::Mesh => sys::mjGEOM_MESH,
        other => panic!("unexpected type: {other:?}"),
    }) as i32
}

fn byte(array: *const u8, index: usize) -> u8 {
    // SAFETY: the engine's arrays have a row for each element.
    unsafe { *array.add(index) }
}

#[test]
fn fields_of_bodies_and_joints_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let nuser = m.nuser_body as usize;
        check_fields!(name, model.bodies(), |body, i| {
            pos: m.body_pos, [3 * i; 3];
            quat: m.body_quat, [4 * i; 4];
            ipos: m.body_ipos, [3 * i; 3];
            iquat: m.body_iquat, [4 * i; 4];
            mass: m.body_mass, [i; 1];
            subtreemass: m.body_subtreemass, [i; 1];
            inertia: m.body_inertia, [3 * i; 3];
            invweight0: m.body_invweight0, [2 * i; 2];
            user: m.body_user, [nuser * i; nuser];
            // Newer engines distinguish two kinds of such bodies.
            => simple: body.simple(), byte(m.body_simple, i) != 0;
            => parent: body.parent().index(), int(m.body_parentid, i);
            => root: body.root().index(), int(m.body_rootid, i);
            => weld: body.weld().index(), int(m.body_weldid, i);
            => joints: body.joints().indices(), span(m.body_jntadr, m.body_jntnum, i);
            => geoms: body.geoms().indices(), span(m.body_geomadr, m.body_geomnum, i);
            => njnt: body.njnt(), int(m.body_jntnum, i);
            => ngeom: body.ngeom(), int(m.body_geomnum, i);
            => dofs: (body.dofs().len(), body.dofs().start),
                (int(m.body_dofnum, i), if body.dofs().is_empty() { 0 } else { int(m.body_dofadr, i) });
            => sameframe: body.sameframe(), byte(m.body_sameframe, i) == 1;
            => mocap: body.mocap().map_or(-1, |mocap| mocap as i32), raw(m.body_mocapid, i);
        });
        let nuser = m.nuser_jnt as usize;
        let (q, v) = (|i| int(m.jnt_qposadr, i), |i| int(m.jnt_dofadr, i));
        check_fields!(name, model.joints(), |joint, i| {
            group: m.jnt_group, [i; 1];
            pos: m.jnt_pos, [3 * i; 3];
            axis: m.jnt_axis, [3 * i; 3];
            stiffness: m.jnt_stiffness, [i; 1];
            range: m.jnt_range, [2 * i; 2];
            margin: m.jnt_margin, [i; 1];
            qpos0: m.qpos0, [q(i); joint_sizes(m, i).0];
            qpos_spring: m.qpos_spring, [q(i); joint_sizes(m, i).0];
            armature: m.dof_armature, [v(i); joint_sizes(m, i).1];
            damping: m.dof_damping, [v(i); joint_sizes(m, i).1];
            frictionloss: m.dof_frictionloss, [v(i); joint_sizes(m, i).1];
            limited: m.jnt_limited, [i; 1];
            solref: m.jnt_solref, [2 * i; 2];
            solimp: m.jnt_solimp, [5 * i; 5];
            dof_solref: m.dof_solref, [2 * v(i); 2 * joint_sizes(m, i).1];
            dof_solimp: m.dof_solimp, [5 * v(i); 5 * joint_sizes(m, i).1];
            invweight0: m.dof_invweight0, [v(i); joint_sizes(m, i).1];
            M0: m.dof_M0, [v(i); joint_sizes(m, i).1];
            Madr: m.dof_Madr, [v(i); joint_sizes(m, i).1];
            simplenum: m.dof_simplenum, [v(i); joint_sizes(m, i).1];
            user: m.jnt_user, [nuser * i; nuser];
            => joint_type: joint.joint_type() as i32, raw(m.jnt_type, i);
            => parent_dof: joint.parent_dof().map_or(-1, |dof| dof as i32), raw(m.dof_parentid, v(i));
            => qpos_range: joint.qpos_range(), q(i)..q(i) + joint_sizes(m, i).0;
            => dofs: joint.dofs(), v(i)..v(i) + joint_sizes(m, i).1;
            => body: joint.body().index(), int(m.jnt_bodyid, i);
        });
    }
}

#[test]
fn fields_of_geoms_sites_cameras_and_lights_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let nuser = m.nuser_geom as usize;
        check_fields!(name, model.geoms(), |geom, i| {
            contype: m.geom_contype, [i; 1];
            conaffinity: m.geom_conaffinity, [i; 1];
            condim: m.geom_condim, [i; 1];
            group: m.geom_group, [i; 1];
            priority: m.geom_priority, [i; 1];
            solmix: m.geom_solmix, [i; 1];
            solref: m.geom_solref, [2 * i; 2];
            solimp: m.geom_solimp, [5 * i; 5];
            size: m.geom_size, [3 * i; 3];
            rbound: m.geom_rbound, [i; 1];
            pos: m.geom_pos, [3 * i; 3];
            quat: m.geom_quat, [4 * i; 4];
            friction: m.geom_friction, [3 * i; 3];
            margin: m.geom_margin, [i; 1];
            gap: m.geom_gap, [i; 1];
            rgba: m.geom_rgba, [4 * i; 4];
            user: m.geom_user, [nuser * i; nuser];
            fluid: m.geom_fluid, [12 * i; 12];
            => geom_type: geom_type(geom.geom_type()), raw(m.geom_type, i);
            => mesh: optional(geom.mesh()), if raw(m.geom_type, i) == sys::mjGEOM_MESH as i32 { raw(m.geom_dataid, i) } else { -1 };
            => height_field: optional(geom.height_field()),
                if raw(m.geom_type, i) == sys::mjGEOM_HFIELD as i32 { raw(m.geom_dataid, i) } else { -1 };
            => material: optional(geom.material()), raw(m.geom_matid, i);
            => sameframe: geom.sameframe() as u8, byte(m.geom_sameframe, i);
            => body: geom.body().index(), int(m.geom_bodyid, i);
        });
        let nuser = m.nuser_site as usize;
        check_fields!(name, model.sites(), |site, i| {
            group: m.site_group, [i; 1];
            size: m.site_size, [3 * i; 3];
            pos: m.site_pos, [3 * i; 3];
            quat: m.site_quat, [4 * i; 4];
            rgba: m.site_rgba, [4 * i; 4];
            user: m.site_user, [nuser * i; nuser];
            => site_type: geom_type(site.site_type()), raw(m.site_type, i);
            => material: optional(site.material()), raw(m.site_matid, i);
            => sameframe: site.sameframe() as u8, byte(m.site_sameframe, i);
            => body: site.body().index(), int(m.site_bodyid, i);
        });
        let nuser = m.nuser_cam as usize;
        check_fields!(name, model.cameras(), |camera, i| {
            pos: m.cam_pos, [3 * i; 3];
            quat: m.cam_quat, [4 * i; 4];
            poscom0: m.cam_poscom0, [3 * i; 3];
            pos0: m.cam_pos0, [3 * i; 3];
            mat0: m.cam_mat0, [9 * i; 9];
            fovy: m.cam_fovy, [i; 1];
            ipd: m.cam_ipd, [i; 1];
            user: m.cam_user, [nuser * i; nuser];
            => mode: camera.mode() as i32, raw(m.cam_mode, i);
            => target: optional(camera.target()), raw(m.cam_targetbodyid, i);
            => body: camera.body().index(), int(m.cam_bodyid, i);
        });
        // SAFETY: the lights of the model.
        let directional = |i| unsafe { differing::is_directional(m, i) };
        check_fields!(name, model.lights(), |light, i| {
            pos: m.light_pos, [3 * i; 3];
            dir: m.light_dir, [3 * i; 3];
            poscom0: m.light_poscom0, [3 * i; 3];
            pos0: m.light_pos0, [3 * i; 3];
            dir0: m.light_dir0, [3 * i; 3];
            attenuation: m.light_attenuation, [3 * i; 3];
            cutoff: m.light_cutoff, [i; 1];
            exponent: m.light_exponent, [i; 1];
            ambient: m.light_ambient, [3 * i; 3];
            diffuse: m.light_diffuse, [3 * i; 3];
            specular: m.light_specular, [3 * i; 3];
            castshadow: m.light_castshadow, [i; 1];
            active: m.light_active, [i; 1];
            => directional: u8::from(light.directional()), directional(i);
            => mode: light.mode() as i32, raw(m.light_mode, i);
            => target: optional(light.target()), raw(m.light_targetbodyid, i);
            => body: light.body().index(), int(m.light_bodyid, i);
        });
    }
}
