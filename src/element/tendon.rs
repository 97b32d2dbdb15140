//! Tendons.

use super::{View, ViewMut};
use crate::data::Data;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Tendon on Model {
    /// The group, for display.
    group: i32 = tendon_group;
    /// Whether [`range`](Self::range) is enforced.
    limited: {bool} = |tendon| tendon.owner.tendon_limited()[tendon.index()] != 0;
    /// Width, m, for display.
    width: f64 = tendon_width, set_width in tendon_width_mut;
    /// Limits of its length, m.
    range: [f64; 2] = tendon_range, range_mut in tendon_range_mut;
    /// At which distance from a limit the limit becomes active.
    margin: f64 = tendon_margin, set_margin in tendon_margin_mut;
    /// Stiffness of its spring, N/m.
    stiffness: f64 = tendon_stiffness, set_stiffness in tendon_stiffness_mut;
    /// Damping, N·s/m.
    damping: f64 = tendon_damping, set_damping in tendon_damping_mut;
    /// Dry friction, N.
    frictionloss: f64 = tendon_frictionloss, set_frictionloss in tendon_frictionloss_mut;
    /// Length at which its spring is at rest, m.
    lengthspring: f64 = tendon_lengthspring, set_lengthspring in tendon_lengthspring_mut;
    /// Length in the reference configuration, m.
    length0: f64 = tendon_length0;
    /// Inverse inertia in the reference configuration.
    invweight0: f64 = tendon_invweight0;
    /// Time constant and damping ratio of its limit.
    solref_lim: [f64; 2] = tendon_solref_lim, solref_lim_mut in tendon_solref_lim_mut;
    /// Impedance of its limit.
    solimp_lim: [f64; 5] = tendon_solimp_lim, solimp_lim_mut in tendon_solimp_lim_mut;
    /// Time constant and damping ratio of its dry friction.
    solref_fri: [f64; 2] = tendon_solref_fri, solref_fri_mut in tendon_solref_fri_mut;
    /// Impedance of its dry friction.
    solimp_fri: [f64; 5] = tendon_solimp_fri, solimp_fri_mut in tendon_solimp_fri_mut;
    /// Red, green, blue and opacity, where no material gives them.
    rgba: [f32; 4] = tendon_rgba, rgba_mut in tendon_rgba_mut;
    /// The user's own numbers.
    user: [f64] = tendon_user, user_mut in tendon_user_mut;
});

fields!(Tendon on Data {
    /// Length, m.
    length: f64 = ten_length;
    /// Velocity, m/s.
    velocity: f64 = ten_velocity;
});
