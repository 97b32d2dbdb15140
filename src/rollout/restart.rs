//! A reset at the price of a step.
//!
//! The engine's own sets all memory of a simulation to zero, which is megabytes for the smallest model, since it has room for
//! hundreds of constraints: as long as some hundred steps of the cart-pole take. What is left out here are the arrays of
//! constraints and contacts. Nobody reads a row of them that was not written since: the accessors end where the rows in use do,
//! and a step that did would depend on the one before it.

use crate::data::{Data, PipelineFlags};
use crate::error::Result;

/// Makes a simulation what a reset makes it.
pub(super) fn restart(data: &mut Data) -> Result<()> {
    if data.check_usable().is_err() {
        return data.reset();
    }
    data.clear_arrays();
    data.set_computed(PipelineFlags::empty());

    let raw = data.raw_mut();
    // SAFETY: counters, times and costs: plain numbers, for which all zeros are a value.
    (raw.warning, raw.timer, raw.solver) = unsafe { std::mem::zeroed() };
    (raw.pstack, raw.maxuse_stack, raw.maxuse_con, raw.maxuse_efc) = (0, 0, 0, 0);
    (raw.solver_iter, raw.solver_nnz, raw.solver_fwdinv) = (0, 0, [0.0; 2]);
    (raw.ne, raw.nf, raw.nefc, raw.ncon) = (0, 0, 0, 0);
    (raw.time, raw.energy) = (0.0, [0.0; 2]);

    let model = data.model().clone();
    data.qpos_mut().copy_from_slice(model.qpos0());
    for (body, &mocap) in model.body_mocapid().iter().enumerate() {
        if let Ok(mocap) = usize::try_from(mocap) {
            data.mocap_pos_mut()[mocap] = model.body_pos()[body];
            data.mocap_quat_mut()[mocap] = model.body_quat()[body];
        }
    }
    Ok(())
}
