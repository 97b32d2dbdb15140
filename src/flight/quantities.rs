//! Quantities of the stages of a step that two engines compute, in forms that do not depend on the
//! engine's layout.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::data::{Data, StateSpec};
use crate::error::Result;
use crate::kind::Kind;
use crate::layout::Row;
use crate::model::Model;

/// Objects to which the rows of a quantity belong.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    Elements(Kind),
    Positions,
    Dofs,
    Activations,
    Outputs,
    Readings,
    Contacts,
    Constraints,
    One,
}

/// Quantity that a stage computes.
pub(super) struct Quantity {
    pub(super) name: &'static str,
    /// The method of [`Data`] that computes it, or `integration`.
    pub(super) stage: &'static str,
    pub(super) rows: Rows,
    pub(super) columns: usize,
    read: fn(&Data, &mut Vec<f64>),
}

impl Quantity {
    /// Returns `true` if the values depend on the convergence of the solver.
    pub(super) fn depends_on_solver(&self) -> bool {
        ["fwd_constraint", "sensors", "integration"].contains(&self.stage)
    }
}

macro_rules! quantities {
    ($($stage:ident { $($name:literal $columns:literal $rows:expr, $data:ident => $values:expr;)* })*) => {
        &[$($(Quantity {
            name: $name,
            stage: stringify!($stage),
            rows: $rows,
            columns: $columns,
            read: |$data, out| out.extend($values),
        }),*),*]
    };
}

const BODIES: Rows = Rows::Elements(Kind::Body);
const JOINTS: Rows = Rows::Elements(Kind::Joint);
const GEOMS: Rows = Rows::Elements(Kind::Geom);
const SITES: Rows = Rows::Elements(Kind::Site);
const CAMERAS: Rows = Rows::Elements(Kind::Camera);
const TENDONS: Rows = Rows::Elements(Kind::Tendon);

/// All quantities, in the order in which the engine computes them. Matrices, which versions of the
/// engine store differently, are multiplied by a [test vector](test_vector). The inertia `cinert`
/// has the principal axes `ximat`, which are not unique.
#[rustfmt::skip]
pub(super) static QUANTITIES: &[Quantity] = quantities! {
    kinematics {
        "xpos" 3 BODIES, data => data.xpos().as_flattened();
        "xquat" 4 BODIES, data => data.xquat().as_flattened();
        "xipos" 3 BODIES, data => data.xipos().as_flattened();
        "xanchor" 3 JOINTS, data => data.xanchor().as_flattened();
        "xaxis" 3 JOINTS, data => data.xaxis().as_flattened();
        "geom_xpos" 3 GEOMS, data => data.geom_xpos().as_flattened();
        "geom_xmat" 9 GEOMS, data => data.geom_xmat().as_flattened();
        "site_xpos" 3 SITES, data => data.site_xpos().as_flattened();
        "site_xmat" 9 SITES, data => data.site_xmat().as_flattened();
    }
    com_pos {
        "subtree_com" 3 BODIES, data => data.subtree_com().as_flattened();
        "cinert" 10 BODIES, data => data.cinert().as_flattened();
        "cdof" 6 Rows::Dofs, data => data.cdof().as_flattened();
    }
    camlight {
        "cam_xpos" 3 CAMERAS, data => data.cam_xpos().as_flattened();
        "cam_xmat" 9 CAMERAS, data => data.cam_xmat().as_flattened();
    }
    compute_tendon {
        "ten_length" 1 TENDONS, data => data.ten_length();
        "ten_J·u" 1 TENDONS, data => products(data, data.model().ntendon(), Data::tendon_row);
    }
    compute_crb {
        "crb" 10 BODIES, data => data.crb().as_flattened();
        "M·u" 1 Rows::Dofs, data => product(data, data.model().nv(), |data, u, to| data.mul_m_into(u, to));
    }
    collision {
        "contact.geom" 2 Rows::Contacts, data => contacts(data, |contact| {
            contact.geoms().map_or([-1.0; 2], |geoms| geoms.map(|geom| geom.index() as f64))
        });
        "contact.pos" 3 Rows::Contacts, data => contacts(data, |contact| *contact.pos());
        "contact.dist" 1 Rows::Contacts, data => contacts(data, |contact| [contact.dist()]);
        "contact.frame" 9 Rows::Contacts, data => contacts(data, |contact| *contact.frame());
        "contact.dim" 1 Rows::Contacts, data => contacts(data, |contact| [contact.dim() as f64]);
        "contact.friction" 5 Rows::Contacts, data => contacts(data, |contact| *contact.friction());
    }
    make_constraint {
        "efc_type" 1 Rows::Constraints, data => data.efc_type().iter().map(|&code| f64::from(code));
        "efc_id" 1 Rows::Constraints, data => data.efc_id().iter().map(|&id| f64::from(id));
        "efc_J·u" 1 Rows::Constraints, data =>
            product(data, data.nefc(), |data, u, to| data.mul_jac_vec_into(u, to));
        "efc_pos" 1 Rows::Constraints, data => data.efc_pos();
        "efc_margin" 1 Rows::Constraints, data => data.efc_margin();
        "efc_frictionloss" 1 Rows::Constraints, data => data.efc_frictionloss();
        "efc_KBIP" 4 Rows::Constraints, data => data.efc_KBIP().as_flattened();
        "efc_R" 1 Rows::Constraints, data => data.efc_R();
    }
    transmission {
        "actuator_length" 1 Rows::Outputs, data => data.actuator_length();
        "actuator_moment·u" 1 Rows::Outputs, data =>
            products(data, data.model().actuator_length0().len(), Data::moment_row);
    }
    compute_ten_velocity { "ten_velocity" 1 TENDONS, data => data.ten_velocity(); }
    compute_actuator_velocity { "actuator_velocity" 1 Rows::Outputs, data => data.actuator_velocity(); }
    com_vel {
        "cvel" 6 BODIES, data => data.cvel().as_flattened();
        "cdof_dot" 6 Rows::Dofs, data => data.cdof_dot().as_flattened();
    }
    passive { "qfrc_passive" 1 Rows::Dofs, data => data.qfrc_passive(); }
    reference_constraint {
        "efc_vel" 1 Rows::Constraints, data => data.efc_vel();
        "efc_aref" 1 Rows::Constraints, data => data.efc_aref();
    }
    compute_qfrc_bias { "qfrc_bias" 1 Rows::Dofs, data => data.qfrc_bias(); }
    fwd_actuation {
        "act_dot" 1 Rows::Activations, data => data.act_dot();
        "actuator_force" 1 Rows::Outputs, data => data.actuator_force();
        "qfrc_actuator" 1 Rows::Dofs, data => data.qfrc_actuator();
    }
    fwd_acceleration {
        "qfrc_smooth" 1 Rows::Dofs, data => data.qfrc_smooth();
        "qacc_smooth" 1 Rows::Dofs, data => data.qacc_smooth();
    }
    fwd_constraint {
        "efc_force" 1 Rows::Constraints, data => data.efc_force();
        "qfrc_constraint" 1 Rows::Dofs, data => data.qfrc_constraint();
        "qacc" 1 Rows::Dofs, data => data.qacc();
    }
    sensors { "sensordata" 1 Rows::Readings, data => data.sensordata(); }
    integration {
        "next time" 1 Rows::One, data => [data.time()];
        "next qpos" 1 Rows::Positions, data => data.qpos();
        "next qvel" 1 Rows::Dofs, data => data.qvel();
        "next act" 1 Rows::Activations, data => data.act();
    }
};

/// Values of one quantity.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) columns: usize,
    pub(super) values: Vec<f64>,
}

impl Series {
    /// Returns the first columns of each row.
    pub(super) fn cut(&self, columns: usize) -> Self {
        let columns = columns.min(self.columns);
        let values = self.values.chunks(self.columns).flat_map(|row| &row[..columns]).copied().collect();
        Self { name: self.name.clone(), columns, values }
    }
}

/// Returns the values of a quantity.
pub(super) fn find<'v>(values: &'v [Series], name: &str) -> Option<&'v Series> {
    values.iter().find(|values| values.name == name)
}

/// Reads the quantities before or after the integration.
pub(super) fn read(data: &Data, is_integrated: bool, into: &mut Vec<Series>) {
    let read = QUANTITIES.iter().filter(|quantity| (quantity.stage == "integration") == is_integrated);
    into.extend(read.map(|&Quantity { name, columns, read, .. }| {
        let mut values = Vec::new();
        read(data, &mut values);
        Series { name: name.to_owned(), columns, values }
    }));
}

/// Returns the names and places of the inputs of a call, in the order of
/// [`inputs::parts`](super::inputs::parts).
pub(super) fn inputs(model: &Model) -> impl Iterator<Item = (String, Range<usize>)> {
    let others = super::inputs::count(model) - model.state_size(StateSpec::INTEGRATION);
    let others = if cfg!(engine_since = "3.0.0") {
        vec![("sensordata", others - model.neq()), ("eq_active", model.neq())]
    } else {
        vec![("act_dot", others)]
    };
    let others = others.into_iter().map(|(name, length)| (name.to_owned(), length));
    let state = StateSpec::INTEGRATION.iter_names().map(|(name, part)| (name.to_lowercase(), model.state_size(part)));
    let mut end = 0;
    state.chain(others).map(move |(name, length)| {
        end += length;
        (name, end - length..end)
    })
}

fn contacts<const N: usize>(data: &Data, numbers: impl Fn(&crate::data::Contact<'_>) -> [f64; N]) -> Vec<f64> {
    data.contacts().flat_map(|contact| numbers(&contact)).collect()
}

/// Returns a vector without zeros, whose products with two different rows of numbers differ.
fn test_vector(length: usize) -> Vec<f64> {
    (0..length).map(|index| 1.0 + (0.618_033_988_749_895 * index as f64).fract()).collect()
}

/// Returns the product of a matrix and the test vector. A matrix that was not computed has no
/// product.
fn product(data: &Data, rows: usize, multiply: impl Fn(&Data, &[f64], &mut [f64]) -> Result<()>) -> Vec<f64> {
    let mut product = vec![0.0; rows];
    match multiply(data, &test_vector(data.model().nv()), &mut product) {
        Ok(()) => product,
        Err(_) => Vec::new(),
    }
}

/// Returns the products of rows and the test vector.
fn products<'d>(data: &'d Data, rows: usize, row: impl Fn(&'d Data, usize) -> Row<'d>) -> Vec<f64> {
    let vector = test_vector(data.model().nv());
    (0..rows).map(|index| row(data, index).iter().map(|(column, value)| value * vector[column]).sum()).collect()
}
