//! Every setter of every element of models and simulations.

use std::sync::OnceLock;

use mujoco_safe::{Data, ModelMut, Result};

use super::{Bytes, Call};

/// A number and an integer to write.
#[derive(Clone, Copy)]
struct Value {
    number: f64,
    integer: i32,
}

/// The argument type of a setter.
trait Argument {
    fn of(value: Value) -> Self;
}

impl Argument for f64 {
    fn of(value: Value) -> Self {
        value.number
    }
}

impl Argument for f32 {
    fn of(value: Value) -> Self {
        value.number as Self
    }
}

impl Argument for i32 {
    fn of(value: Value) -> Self {
        value.integer
    }
}

impl Argument for u8 {
    fn of(value: Value) -> Self {
        value.integer as Self
    }
}

impl Argument for bool {
    fn of(value: Value) -> Self {
        value.integer > 1
    }
}

impl<T: Argument, const N: usize> Argument for [T; N] {
    fn of(value: Value) -> Self {
        std::array::from_fn(|_| T::of(value))
    }
}

/// The return type of a setter.
trait Outcome {
    fn outcome(self) -> Result<()>;
}

impl Outcome for () {
    fn outcome(self) -> Result<()> {
        Ok(())
    }
}

impl Outcome for Result<()> {
    fn outcome(self) -> Self {
        self
    }
}

/// Writes to a whole array, or to one number of it.
fn write<T: Argument>(array: &mut [T], value: Value) {
    if value.integer % 2 == 0 {
        for number in array {
            *number = T::of(value);
        }
    } else if let Some(number) = array.len().checked_sub(1).map(|last| &mut array[value.integer as usize % (last + 1)])
    {
        *number = T::of(value);
    }
}

type ModelSetter = (&'static str, fn(&mut ModelMut<'_>, usize, Value) -> Result<()>);
type DataSetter = (&'static str, fn(&mut Data, usize, Value) -> Result<()>);

macro_rules! setters {
    ($($element:ident: $($set:ident)* | $($array:ident)*;)*) => {
        &[$(
            $((concat!(stringify!($element), ".", stringify!($set)), |owner, index, value| {
                owner.$element(index)?.$set(Argument::of(value)).outcome()
            }),)*
            $((concat!(stringify!($element), ".", stringify!($array)), |owner, index, value| {
                write(&mut owner.$element(index)?.$array()[..], value);
                Ok(())
            }),)*
        )*]
    };
}

const MODEL: &[ModelSetter] = setters! {
    actuator_mut: set_group set_ctrllimited set_forcelimited set_actlimited set_cranklength
        | dynprm_mut gainprm_mut biasprm_mut ctrlrange_mut forcerange_mut actrange_mut lengthrange_mut gear_mut user_mut;
    body_mut: set_mass | pos_mut ipos_mut inertia_mut quat_mut iquat_mut user_mut;
    camera_mut: set_fovy set_ipd | pos_mut quat_mut user_mut;
    equality_mut: set_active | solref_mut solimp_mut data_mut;
    geom_mut: set_contype set_conaffinity set_group set_priority set_condim set_solmix set_margin set_gap
        | solref_mut solimp_mut size_mut pos_mut friction_mut quat_mut fluid_mut rgba_mut user_mut;
    height_field_mut: | data_mut;
    joint_mut: set_group set_limited set_stiffness set_margin
        | solref_mut range_mut solimp_mut pos_mut axis_mut qpos0_mut qpos_spring_mut armature_mut damping_mut
        frictionloss_mut user_mut dof_solref_mut dof_solimp_mut;
    keyframe_mut: set_time | qpos_mut qvel_mut act_mut mpos_mut mquat_mut ctrl_mut;
    light_mut: set_directional set_castshadow set_active set_cutoff set_exponent
        | pos_mut dir_mut attenuation_mut ambient_mut diffuse_mut specular_mut;
    material_mut: set_texuniform set_emission set_specular set_shininess set_reflectance | texrepeat_mut rgba_mut;
    mesh_mut: | normal_mut texcoord_mut;
    numeric_mut: | data_mut;
    pair_mut: set_dim set_margin set_gap | solref_mut solimp_mut friction_mut;
    sensor_mut: set_cutoff set_noise | user_mut;
    site_mut: set_group | size_mut pos_mut quat_mut rgba_mut user_mut;
    skin_mut: set_group set_inflate
        | rgba_mut vert_mut bonebindpos_mut texcoord_mut bonebindquat_mut bonevertweight_mut;
    tendon_mut: set_group set_limited set_width set_margin set_stiffness set_damping set_frictionloss set_lengthspring
        | range_mut solref_lim_mut solref_fri_mut solimp_lim_mut solimp_fri_mut rgba_mut user_mut;
    texture_mut: | rgb_mut;
    tuple_mut: | objprm_mut;
};

const DATA: &[DataSetter] = setters! {
    joint_mut: | qpos_mut qvel_mut qacc_mut qacc_warmstart_mut qfrc_applied_mut;
    actuator_mut: set_ctrl |;
    body_mut: | xfrc_applied_mut;
    sensor_mut: | data_mut;
};

const OPTIONAL: &[DataSetter] = &[
    ("body_mut.mocap_pos_mut", |data, index, value| {
        data.body_mut(index)?.mocap_pos_mut().map_or(Ok(()), |pos| {
            write(pos, value);
            Ok(())
        })
    }),
    ("body_mut.mocap_quat_mut", |data, index, value| {
        data.body_mut(index)?.mocap_quat_mut().map_or(Ok(()), |quat| {
            write(quat, value);
            Ok(())
        })
    }),
    ("actuator_mut.act_mut", |data, index, value| {
        data.actuator_mut(index)?.act_mut().map_or(Ok(()), |act| {
            *act = value.number;
            Ok(())
        })
    }),
];

/// The setters of integers, which enable computations and decide their layout.
fn integer_setters() -> &'static [ModelSetter] {
    const NAMES: [&str; 7] = ["set_active", "limited", "condim", "contype", "conaffinity", "set_dim", "set_priority"];
    static SWITCHES: OnceLock<Vec<ModelSetter>> = OnceLock::new();
    let is_switch = |(name, _): &&ModelSetter| NAMES.iter().any(|switch| name.contains(switch));
    SWITCHES.get_or_init(|| MODEL.iter().filter(is_switch).copied().collect())
}

/// Returns an index that is valid for most kinds of elements, and a value.
fn arguments(bytes: &mut Bytes<'_>) -> (usize, Value) {
    let index = [0, 0, 1, 2, bytes.index(8)][bytes.below(5)];
    let integer = if bytes.once_in(4) { bytes.integer() } else { bytes.below(7) as i32 };
    (index, Value { number: bytes.number(), integer })
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("elements of the model", |scene, bytes| {
        let chosen: Vec<_> = (0..=bytes.below(3)).map(|_| (bytes.below(MODEL.len()), arguments(bytes))).collect();
        for &(which, _) in &chosen {
            (scene.log)(MODEL[which].0);
        }
        scene.data.edit_model(|model| {
            let results = chosen.iter().map(|&(which, (index, value))| MODEL[which].1(model, index, value));
            results.fold(Ok(()), Result::and)
        })
    }),
    ("integer setters of the model", |scene, bytes| {
        let chosen: Vec<_> =
            (0..4).map(|_| (integer_setters()[bytes.below(integer_setters().len())], arguments(bytes))).collect();
        scene.data.edit_model(|model| {
            let results = chosen.iter().map(|&((_, set), (index, value))| set(model, index, value));
            results.fold(Ok(()), Result::and)
        })
    }),
    ("an element", |scene, bytes| {
        let (name, set) = [DATA, OPTIONAL].concat()[bytes.below(DATA.len() + OPTIONAL.len())];
        (scene.log)(name);
        let (index, value) = arguments(bytes);
        set(&mut scene.data, index, value)
    }),
];
