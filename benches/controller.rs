//! LQR control law of the humanoid: a straightforward closure that allocates vectors in every call,
//! against [`Lqr`], which reuses its buffers. The number of allocations is printed as well.
//!
//! (The source of this comparison, in another language on another machine, reports 1.22 µs with 13
//! allocations against 0.81 µs with none.)
//!
//! ```text
//! cargo bench --bench controller
//! ```

mod common;

use common::models::Balance;
use mujoco_safe::{Controller, Data, Lqr, Matrix, Result};
use nalgebra::DVector;

/// Number of calls per run.
const CALLS: u32 = 100;

/// Evaluates the controller repeatedly for one state. The control law does not depend on the
/// controls, which it overwrites.
fn run(data: &mut Data, controller: &mut impl Controller) {
    for _ in 0..CALLS {
        controller.control(data).expect("the controller belongs to this model");
    }
}

fn main() -> Result<()> {
    let mut balance = Balance::humanoid()?;
    let solution = Lqr::solve(&balance.system()?, &balance.weights)?;
    let mut data = balance.data;

    let gain = solution.k.to_nalgebra();
    let (qpos0, ctrl0) = (data.qpos().to_vec(), DVector::from_column_slice(data.ctrl()));
    let allocating = |data: &mut Data| -> Result<()> {
        let mut dq = DVector::zeros(data.model().nv());
        data.model().differentiate_pos_into(1.0, &qpos0, data.qpos(), dq.as_mut_slice())?;
        let dx = DVector::from_vec([dq.as_slice(), data.qvel()].concat());
        let ctrl = &ctrl0 - &gain * dx;
        data.ctrl_mut().copy_from_slice(ctrl.as_slice());
        Ok(())
    };
    let lqr = Lqr::with_gain(&data, Matrix::from(&gain))?;

    // Move slightly away from the set-point.
    data.step()?;
    data.qvel_mut().fill(0.01);

    for (name, controller) in [
        ("a closure that allocates", &mut { allocating } as &mut dyn Controller),
        ("Lqr", &mut lqr.clone() as &mut dyn Controller),
    ] {
        let counted = allocation_counter::measure(|| controller.control(&mut data).expect("as in `run`"));
        println!("controller: {name} allocates {} times per call", counted.count_total);
    }

    common::compare(
        "controller",
        &mut (data, lqr),
        CALLS,
        &[
            ("Lqr", &|(data, lqr)| run(data, lqr)),
            ("a closure that allocates", &|(data, _)| run(data, &mut { allocating })),
        ],
    );

    Ok(())
}
