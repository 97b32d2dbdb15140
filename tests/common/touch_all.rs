//! Reads, and writes back, every number behind every generated accessor: under memcheck, whatever is not initialised or lies
//! outside of the engine's memory is found. `boundary.rs` checks that no accessor is missing here.

use std::hint::black_box;

use mujoco_safe::{Data, MatrixView, MatrixViewMut, Model, ModelMut};

/// Something that an accessor returns.
trait Touch: Sized {
    /// How many of its numbers are not zero.
    fn touch(self) -> usize;

    /// Gives every number the value of the function, if it may be written to.
    fn write(self, _: &mut dyn FnMut() -> f64) {}
}

/// What the engine's arrays are made of.
trait Number: PartialEq + Default + Copy {
    fn from_f64(value: f64) -> Self;
}

macro_rules! numbers {
    ($($type:ty)*) => {$(
        impl Number for $type {
            fn from_f64(value: f64) -> Self {
                value as Self
            }
        }
    )*};
}
numbers!(f64 f32 i32 u8);

/// A jump that depends on the value, which is what memcheck looks at.
#[inline(never)]
#[allow(clippy::bool_to_int_with_if, reason = "a conversion is no jump, and memcheck would say nothing")]
fn look<T: PartialEq + Default>(value: T) -> usize {
    if black_box(value) == T::default() { 0 } else { 1 }
}

impl Touch for usize {
    fn touch(self) -> usize {
        look(self)
    }
}

impl Touch for f64 {
    fn touch(self) -> usize {
        look(self)
    }
}

impl<T: Number> Touch for &[T] {
    fn touch(self) -> usize {
        self.iter().map(|&value| look(value)).sum()
    }
}

impl<T: Number, const N: usize> Touch for &[[T; N]] {
    fn touch(self) -> usize {
        self.as_flattened().touch()
    }
}

impl Touch for MatrixView<'_> {
    fn touch(self) -> usize {
        self.as_slice().touch()
    }
}

impl<T: Number> Touch for &mut [T] {
    fn touch(self) -> usize {
        for value in self.iter_mut() {
            *value = black_box(*value);
        }
        self.len()
    }

    fn write(self, value: &mut dyn FnMut() -> f64) {
        for number in self {
            *number = T::from_f64(value());
        }
    }
}

impl<T: Number, const N: usize> Touch for &mut [[T; N]] {
    fn touch(self) -> usize {
        self.as_flattened_mut().touch()
    }

    fn write(self, value: &mut dyn FnMut() -> f64) {
        self.as_flattened_mut().write(value);
    }
}

impl Touch for MatrixViewMut<'_> {
    fn touch(mut self) -> usize {
        self.as_mut_slice().touch()
    }

    fn write(mut self, value: &mut dyn FnMut() -> f64) {
        self.as_mut_slice().write(value);
    }
}

/// A function that calls each accessor, the list of their names, and a function that writes to the one of an index.
macro_rules! accessors {
    ($(#[$doc:meta])* $function:ident($owner:ty), $list:ident $(, $write:ident)?: $($name:ident)*) => {
        pub(crate) const $list: &[&str] = &[$(stringify!($name)),*];

        $(#[$doc])*
        pub(crate) fn $function(owner: $owner) -> usize {
            [$(owner.$name().touch()),*].iter().sum()
        }

        accessors!(@write $owner, [$($write)?] $($name)*);
    };
    (@write $owner:ty, [] $($name:ident)*) => {};
    (@write $owner:ty, [$write:ident] $($name:ident)*) => {
        /// Writes to the array that is at this place of the list.
        #[allow(dead_code, reason = "included by several tests, of which one writes")]
        pub(crate) fn $write(owner: $owner, index: usize, value: &mut dyn FnMut() -> f64) {
            let mut at = 0;
            $(
                if at == index {
                    return owner.$name().write(value);
                }
                at += 1;
            )*
            panic!("there are only {at} arrays");
        }
    };
}

accessors! {
    /// Reads all of a model.
    model(&Model), MODEL:
        nq nv nu na nbody njnt ngeom nsite ncam nlight nmesh nmeshvert nmeshtexvert nmeshface nmeshgraph nskin
        nskinvert nskintexvert nskinface nskinbone nskinbonevert nhfield nhfielddata ntex ntexdata nmat npair nexclude
        neq ntendon nwrap nsensor nnumeric nnumericdata ntext ntextdata ntuple ntupledata nkey nmocap nuser_body
        nuser_jnt nuser_geom nuser_site nuser_cam nuser_tendon nuser_actuator nuser_sensor nnames nM nD nemax njmax
        nconmax nstack nuserdata nsensordata nbuffer qpos0 qpos_spring body_parentid body_rootid body_weldid
        body_mocapid body_jntnum body_jntadr body_dofnum body_dofadr body_geomnum body_geomadr body_simple
        body_sameframe body_pos body_quat body_ipos body_iquat body_mass body_subtreemass body_inertia body_invweight0
        body_user jnt_type jnt_qposadr jnt_dofadr jnt_bodyid jnt_group jnt_limited jnt_solref jnt_solimp jnt_pos
        jnt_axis jnt_stiffness jnt_range jnt_margin jnt_user dof_bodyid dof_jntid dof_parentid dof_Madr dof_simplenum
        dof_solref dof_solimp dof_frictionloss dof_armature dof_damping dof_invweight0 dof_M0 geom_type geom_contype
        geom_conaffinity geom_condim geom_bodyid geom_dataid geom_matid geom_group geom_priority geom_sameframe
        geom_solmix geom_solref geom_solimp geom_size geom_rbound geom_pos geom_quat geom_friction geom_margin
        geom_gap geom_fluid geom_user geom_rgba site_type site_bodyid site_matid site_group site_sameframe site_size
        site_pos site_quat site_user site_rgba cam_mode cam_bodyid cam_targetbodyid cam_pos cam_quat cam_poscom0
        cam_pos0 cam_mat0 cam_fovy cam_ipd cam_user light_mode light_bodyid light_targetbodyid light_directional
        light_castshadow light_active light_pos light_dir light_poscom0 light_pos0 light_dir0 light_attenuation
        light_cutoff light_exponent light_ambient light_diffuse light_specular mesh_vertadr mesh_vertnum
        mesh_texcoordadr mesh_faceadr mesh_facenum mesh_graphadr mesh_vert mesh_normal mesh_texcoord mesh_face
        mesh_graph skin_matid skin_group skin_rgba skin_inflate skin_vertadr skin_vertnum skin_texcoordadr
        skin_faceadr skin_facenum skin_boneadr skin_bonenum skin_vert skin_texcoord skin_face skin_bonevertadr
        skin_bonevertnum skin_bonebindpos skin_bonebindquat skin_bonebodyid skin_bonevertid skin_bonevertweight
        hfield_size hfield_nrow hfield_ncol hfield_adr hfield_data tex_type tex_height tex_width tex_adr tex_rgb
        mat_texid mat_texuniform mat_texrepeat mat_emission mat_specular mat_shininess mat_reflectance mat_rgba
        pair_dim pair_geom1 pair_geom2 pair_signature pair_solref pair_solimp pair_margin pair_gap pair_friction
        exclude_signature eq_type eq_obj1id eq_obj2id eq_active eq_solref eq_solimp eq_data tendon_adr tendon_num
        tendon_matid tendon_group tendon_limited tendon_width tendon_solref_lim tendon_solimp_lim tendon_solref_fri
        tendon_solimp_fri tendon_range tendon_margin tendon_stiffness tendon_damping tendon_frictionloss
        tendon_lengthspring tendon_length0 tendon_invweight0 tendon_user tendon_rgba wrap_type wrap_objid wrap_prm
        actuator_trntype actuator_dyntype actuator_gaintype actuator_biastype actuator_trnid actuator_group
        actuator_ctrllimited actuator_forcelimited actuator_actlimited actuator_dynprm actuator_gainprm
        actuator_biasprm actuator_ctrlrange actuator_forcerange actuator_actrange actuator_gear actuator_cranklength
        actuator_acc0 actuator_length0 actuator_lengthrange actuator_user sensor_type sensor_datatype sensor_needstage
        sensor_objtype sensor_objid sensor_reftype sensor_refid sensor_dim sensor_adr sensor_cutoff sensor_noise
        sensor_user numeric_adr numeric_size numeric_data text_adr text_size tuple_adr tuple_size tuple_objtype
        tuple_objid tuple_objprm key_time key_qpos key_qvel key_act key_mpos key_mquat key_ctrl name_bodyadr
        name_jntadr name_geomadr name_siteadr name_camadr name_lightadr name_meshadr name_skinadr name_hfieldadr
        name_texadr name_matadr name_pairadr name_excludeadr name_eqadr name_tendonadr name_actuatoradr name_sensoradr
        name_numericadr name_textadr name_tupleadr name_keyadr
}
accessors! {
    /// Reads all of a simulation.
    data(&Data), DATA:
        qpos qvel act qacc_warmstart ctrl qfrc_applied xfrc_applied mocap_pos mocap_quat qacc act_dot userdata
        sensordata xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat cam_xpos cam_xmat
        light_xpos light_xdir subtree_com cdof cinert ten_wrapadr ten_wrapnum ten_J_rownnz ten_J_rowadr ten_J_colind
        ten_length ten_J wrap_obj wrap_xpos actuator_length actuator_moment crb qM qLD qLDiagInv qLDiagSqrtInv
        efc_type efc_id efc_J_rownnz efc_J_rowadr efc_J_rowsuper efc_J_colind efc_JT_rownnz efc_JT_rowadr
        efc_JT_rowsuper efc_JT_colind efc_J efc_JT efc_pos efc_margin efc_frictionloss efc_diagApprox efc_KBIP efc_D
        efc_R efc_AR_rownnz efc_AR_rowadr efc_AR_colind efc_AR ten_velocity actuator_velocity cvel cdof_dot qfrc_bias
        qfrc_passive efc_vel efc_aref subtree_linvel subtree_angmom qH qHDiagInv D_rownnz D_rowadr D_colind qDeriv qLU
        actuator_force qfrc_actuator qfrc_smooth qacc_smooth efc_b efc_force efc_state qfrc_constraint qfrc_inverse
        cacc cfrc_int cfrc_ext nstack nbuffer pstack maxuse_stack maxuse_con maxuse_efc solver_iter solver_nnz ne nf
        nefc ncon time
}
accessors! {
    /// Writes to all that may be written to in a model.
    model_mut(&mut ModelMut<'_>), MODEL_MUT, write_model:
        qpos0_mut qpos_spring_mut body_pos_mut body_quat_mut body_ipos_mut body_iquat_mut body_mass_mut
        body_subtreemass_mut body_inertia_mut body_invweight0_mut body_user_mut jnt_solref_mut jnt_solimp_mut
        jnt_pos_mut jnt_axis_mut jnt_stiffness_mut jnt_range_mut jnt_margin_mut jnt_user_mut dof_solref_mut
        dof_solimp_mut dof_frictionloss_mut dof_armature_mut dof_damping_mut dof_invweight0_mut dof_M0_mut
        geom_solmix_mut geom_solref_mut geom_solimp_mut geom_size_mut geom_rbound_mut geom_pos_mut geom_quat_mut
        geom_friction_mut geom_margin_mut geom_gap_mut geom_fluid_mut geom_user_mut geom_rgba_mut site_size_mut
        site_pos_mut site_quat_mut site_user_mut site_rgba_mut cam_pos_mut cam_quat_mut cam_poscom0_mut cam_pos0_mut
        cam_mat0_mut cam_fovy_mut cam_ipd_mut cam_user_mut light_pos_mut light_dir_mut light_poscom0_mut
        light_pos0_mut light_dir0_mut light_attenuation_mut light_cutoff_mut light_exponent_mut light_ambient_mut
        light_diffuse_mut light_specular_mut mesh_normal_mut mesh_texcoord_mut skin_rgba_mut skin_inflate_mut
        skin_vert_mut skin_texcoord_mut skin_bonebindpos_mut skin_bonebindquat_mut skin_bonevertweight_mut
        hfield_data_mut mat_texrepeat_mut mat_emission_mut mat_specular_mut mat_shininess_mut
        mat_reflectance_mut mat_rgba_mut pair_solref_mut pair_solimp_mut pair_margin_mut pair_gap_mut
        pair_friction_mut eq_solref_mut eq_solimp_mut eq_data_mut tendon_width_mut tendon_solref_lim_mut
        tendon_solimp_lim_mut tendon_solref_fri_mut tendon_solimp_fri_mut tendon_range_mut tendon_margin_mut
        tendon_stiffness_mut tendon_damping_mut tendon_frictionloss_mut tendon_lengthspring_mut tendon_length0_mut
        tendon_invweight0_mut tendon_user_mut tendon_rgba_mut actuator_dynprm_mut actuator_gainprm_mut
        actuator_biasprm_mut actuator_ctrlrange_mut actuator_forcerange_mut actuator_actrange_mut actuator_gear_mut
        actuator_cranklength_mut actuator_acc0_mut actuator_length0_mut actuator_lengthrange_mut actuator_user_mut
        sensor_cutoff_mut sensor_noise_mut sensor_user_mut numeric_data_mut tuple_objprm_mut key_time_mut key_qpos_mut
        key_qvel_mut key_act_mut key_mpos_mut key_mquat_mut key_ctrl_mut
}
accessors! {
    /// Writes to all that may be written to in a simulation.
    data_mut(&mut Data), DATA_MUT, write_data:
        qpos_mut qvel_mut act_mut qacc_warmstart_mut ctrl_mut qfrc_applied_mut xfrc_applied_mut mocap_pos_mut
        mocap_quat_mut qacc_mut act_dot_mut userdata_mut sensordata_mut xpos_mut xquat_mut xmat_mut xipos_mut
        ximat_mut xanchor_mut xaxis_mut geom_xpos_mut geom_xmat_mut site_xpos_mut site_xmat_mut cam_xpos_mut
        cam_xmat_mut light_xpos_mut light_xdir_mut subtree_com_mut cdof_mut cinert_mut ten_length_mut ten_J_mut
        wrap_xpos_mut actuator_length_mut actuator_moment_mut crb_mut qM_mut qLD_mut qLDiagInv_mut qLDiagSqrtInv_mut
        efc_J_mut efc_JT_mut efc_pos_mut efc_margin_mut efc_frictionloss_mut efc_diagApprox_mut efc_KBIP_mut efc_D_mut
        efc_R_mut efc_AR_mut ten_velocity_mut actuator_velocity_mut cvel_mut cdof_dot_mut qfrc_bias_mut
        qfrc_passive_mut efc_vel_mut efc_aref_mut subtree_linvel_mut subtree_angmom_mut qH_mut qHDiagInv_mut
        qDeriv_mut qLU_mut actuator_force_mut qfrc_actuator_mut qfrc_smooth_mut qacc_smooth_mut efc_b_mut
        efc_force_mut qfrc_constraint_mut qfrc_inverse_mut cacc_mut cfrc_int_mut cfrc_ext_mut
}
