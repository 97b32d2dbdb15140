//! Models of the benchmarks: two balance problems, and the engine's 22 humanoids.

use std::path::Path;

use mujoco_safe::{Data, Differences, Lqr, LqrWeights, Matrix, Result, StateSpace, sample};
use nalgebra::{DMatrix, DVector};

/// Simulation at a set-point, including controls, with the cost weights of deviations.
pub(crate) struct Balance {
    pub(crate) data: Data,
    pub(crate) weights: LqrWeights,
}

impl Balance {
    /// Creates the upright cart-pole: 4 states, 1 control.
    pub(crate) fn cartpole() -> Result<Self> {
        let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
        Ok(Self { data: Data::new(sample::cartpole())?, weights })
    }

    /// Creates the humanoid standing on its left leg: 54 states, 21 controls. The cost is dominated
    /// by the centre of mass relative to the foot, followed by the joints of the leg and the
    /// abdomen, then the other joints; the global position costs almost nothing.
    pub(crate) fn humanoid() -> Result<Self> {
        let mut data = Data::new(sample::humanoid())?;
        let key = data.model().keyframe("stand_on_left_leg")?.id();
        let model = data.model().clone();
        let nv = model.nv();

        // Inverse dynamics at rest. At the right height the vertical force vanishes, because the
        // floor supplies it.
        let mut forces_at = |height: f64| -> Result<DVector<f64>> {
            data.reset_to_key(key)?;
            data.forward()?;
            data.qacc_mut().fill(0.0);
            data.qpos_mut()[2] += height;
            data.inverse()?;
            Ok(DVector::from_column_slice(data.qfrc_inverse()))
        };
        let mut height = (0.0, f64::INFINITY);
        for micrometres in -1000..=1000 {
            let candidate = f64::from(micrometres) * 1e-6;
            let vertical = forces_at(candidate)?[2].abs();
            if vertical < height.1 {
                height = (candidate, vertical);
            }
        }
        let forces = forces_at(height.0)?;
        let qpos0 = data.qpos().to_vec();
        let moment = data.full_moment()?.transposed().clone_owned();
        let ctrl0 = moment.pseudo_inverse(1e-12).expect("the tolerance is positive") * forces;

        data.reset()?;
        data.qpos_mut().copy_from_slice(&qpos0);
        data.ctrl_mut().copy_from_slice(ctrl0.as_slice());
        data.forward()?;

        let com = data.jac_subtree_com(model.body("torso")?)?;
        let foot = data.jac_body_com(model.body("foot_left")?)?.linear;
        let offset = com.to_nalgebra() - foot.to_nalgebra();
        let mut position_cost = 1000.0 * offset.tr_mul(&offset);
        for joint in model.joints().skip(1) {
            let name = joint.name().unwrap_or_default();
            let leg = name.starts_with("left") && ["hip", "knee", "ankle"].iter().any(|part| name.contains(part));
            let cost = if leg || name.contains("abdomen") { 3.0 } else { 0.3 };
            joint.dofs().for_each(|dof| position_cost[(dof, dof)] += cost);
        }
        let mut q = DMatrix::identity(2 * nv, 2 * nv) * 1e-10;
        let mut positions = q.view_mut((0, 0), (nv, nv));
        positions += position_cost;
        Ok(Self { data, weights: LqrWeights::new(q, Matrix::identity(model.nu())) })
    }

    /// Linearises the simulation at the set-point.
    pub(crate) fn system(&mut self) -> Result<StateSpace> {
        self.data.transition_fd(Lqr::EPS, Differences::Central)
    }
}

/// Returns the path of the engine's sample model with 22 humanoids, if it is installed
/// (`apt-get install libmujoco-samples`).
pub(crate) fn many_humanoids() -> Option<&'static Path> {
    let path = Path::new("/usr/share/mujoco/model/humanoid/22_humanoids.xml");
    path.exists().then_some(path)
}
