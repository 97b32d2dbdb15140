//! Cost of the guard that catches engine errors: `mj_version`, which does no other work, so that
//! the difference is the guard; and `mj_forward` of the cart-pole, the shortest call of practical
//! interest.
//!
//! ```text
//! cargo bench --bench guard
//! ```

mod common;

use std::hint::black_box;

use mujoco_safe::{Data, Result, sample, sys};

/// Number of calls per run.
const CALLS: u32 = 1000;

fn main() -> Result<()> {
    let mut data = Data::new(sample::cartpole())?;

    let guarded = |_: &mut Data| {
        for _ in 0..CALLS {
            let mut version = 0;
            // SAFETY: loading the model installed the guard's handler, and the result has a valid
            // place.
            black_box(unsafe { sys::guard::mj_version(black_box(&raw mut version)) });
        }
    };
    let raw = |_: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: the function takes no arguments and returns a constant.
            black_box(unsafe { sys::mj_version() });
        }
    };
    let variants: [common::Variant<'_, Data>; 2] = [("guarded", &guarded), ("raw", &raw)];
    common::compare("guard/mj_version", &mut data, CALLS, &variants);

    let guarded = |data: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: the data and its own model; the handler is installed.
            black_box(unsafe { sys::guard::mj_forward(data.model().as_ptr(), data.as_mut_ptr()) });
        }
    };
    let raw = |data: &mut Data| {
        for _ in 0..CALLS {
            // SAFETY: the data and its own model.
            unsafe { sys::mj_forward(data.model().as_ptr(), data.as_mut_ptr()) }
        }
    };
    let variants: [common::Variant<'_, Data>; 2] = [("guarded", &guarded), ("raw", &raw)];
    common::compare("guard/mj_forward", &mut data, CALLS, &variants);

    Ok(())
}
