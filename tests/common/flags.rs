//! Flags of the engine under test.

use mujoco_safe::model::EnableFlags;

/// Returns all flags of optional features that the engine has.
pub(crate) fn enable_flags() -> EnableFlags {
    let of_2_2_2 = EnableFlags::OVERRIDE | EnableFlags::ENERGY | EnableFlags::FWDINV;
    let mut flags = of_2_2_2;
    // The library rejects those that the engine lacks.
    for flag in EnableFlags::all() - of_2_2_2 {
        let mut model = mujoco_safe::sample::cartpole();
        if model.edit().edit_options(|options| options.enable |= flag).is_ok() {
            flags |= flag;
        }
    }
    flags
}
