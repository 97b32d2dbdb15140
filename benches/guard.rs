//! What does it cost to survive an engine error? The same engine function with the guard and without: `mj_version`, which does
//! nothing else, so that the difference is the guard, and `mj_forward` of the cart-pole, the shortest call of interest.
//!
//! ```text
//! cargo bench --bench guard
//! ```

mod common;

use std::hint::black_box;

use mujoco_safe::{Data, Result, sample, sys};

/// How many calls a run makes.
const CALLS: u32 = 1000;

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    let mut data = Data::new(sample::cartpole())?;

    let guarded = |_: &mut Data| {
        for _ in 0..CALLS {
            let mut version = 0;
            // SAFETY: the guard's handler is there since the model was loaded, and there is a place for the result.
            black_box(unsafe { sys::guard::mj_version(black_box(&raw mut version)) });
        }
    };
    let raw = |_: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: takes nothing and returns a constant.
            black_box(unsafe { sys::mj_version() });
        }
    };
    let ways: [common::Way<'_, Data>; 2] = [("guarded", &guarded), ("raw", &raw)];
    common::compare(&mut criterion, "guard/mj_version", &mut data, CALLS, &ways);

    let guarded = |data: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: a data and its own model, and the handler is there.
            black_box(unsafe { sys::guard::mj_forward(data.model().as_ptr(), data.as_mut_ptr()) });
        }
    };
    let raw = |data: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: a data and its own model.
            unsafe { sys::mj_forward(data.model().as_ptr(), data.as_mut_ptr()) }
        }
    };
    let ways: [common::Way<'_, Data>; 2] = [("guarded", &guarded), ("raw", &raw)];
    common::compare(&mut criterion, "guard/mj_forward", &mut data, CALLS, &ways);

    criterion.final_summary();
    Ok(())
}
