//! Jacobians of a body's centre of mass, a foot of the humanoid: [`Data::jac_body_com_into`], which
//! writes to the caller's matrices, and [`Data::jac_body_com`], which allocates them, against
//! `mj_jacBodyCom`.
//!
//! ```text
//! cargo bench --bench jacobian
//! ```

mod common;

use std::hint::black_box;

use mujoco_safe::id::BodyId;
use mujoco_safe::{Data, Matrix, Result, sample, sys};

/// Number of calls per run.
const CALLS: u32 = 100;

struct Foot {
    data: Data,
    id: BodyId,
    linear: Matrix,
    angular: Matrix,
}

fn main() -> Result<()> {
    let mut data = Data::new(sample::humanoid())?;
    data.forward()?;
    let (id, nv) = (data.model().body("foot_left")?.id(), data.model().nv());
    let mut foot = Foot { data, id, linear: Matrix::zeros(3, nv), angular: Matrix::zeros(3, nv) };

    let into = |foot: &mut Foot| {
        for _ in 0..CALLS {
            let outputs = (Some(&mut foot.linear), Some(&mut foot.angular));
            foot.data.jac_body_com_into(black_box(foot.id), outputs.0, outputs.1).expect("positions are computed");
        }
    };
    let allocating = |foot: &mut Foot| {
        for _ in 0..CALLS {
            black_box(foot.data.jac_body_com(black_box(foot.id)).expect("positions are computed"));
        }
    };
    let raw = |foot: &mut Foot| {
        let (model, data) = (foot.data.model().as_ptr(), foot.data.as_ptr());
        let outputs = (foot.linear.as_mut_slice().as_mut_ptr(), foot.angular.as_mut_slice().as_mut_ptr());
        for _ in 0..CALLS {
            let body = black_box(foot.id).index() as i32;
            // SAFETY: the data and its own model, a valid body, and outputs of 3 × nv values.
            unsafe { sys::mj_jacBodyCom(model, data, outputs.0, outputs.1, body) }
        }
    };
    common::compare(
        "jacobian",
        &mut foot,
        CALLS,
        &[("jac_body_com_into", &into), ("jac_body_com", &allocating), ("mj_jacBodyCom", &raw)],
    );

    Ok(())
}
