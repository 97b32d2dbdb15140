//! The stages of the pipeline in the valid order, in any other order, and interleaved with other
//! calls.

use mujoco_safe::data::{ConeHessian, NewContact, SensorUpdate};
use mujoco_safe::{Data, Result, Stage};

use super::{Bytes, Call, read_only, touch_all};

type Part = (&'static str, fn(&mut Data) -> Result<()>);

macro_rules! parts {
    ($($name:ident)*) => { &[$((stringify!($name), Data::$name)),*] };
}

/// The stages in a valid order.
const FORWARD: &[Part] = parts! {
    kinematics com_pos camlight compute_tendon compute_crb factor_m collision make_constraint transmission
    project_constraint compute_ten_velocity compute_actuator_velocity com_vel passive reference_constraint
    compute_qfrc_bias subtree_vel fwd_actuation fwd_acceleration fwd_constraint rne_post_constraint sensor_pos sensor_vel
    sensor_acc energy_pos energy_vel compare_fwd_inv
};

/// Combined stages, and integrators.
const LARGER: &[Part] = parts! {
    fwd_position fwd_velocity inv_position inv_velocity inv_constraint euler runge_kutta
};

fn run(scene: &mut super::Scene<'_>, (name, part): Part) -> Result<()> {
    (scene.log)(name);
    part(&mut scene.data)
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("a stage", |scene, bytes| run(scene, FORWARD[bytes.below(FORWARD.len())])),
    ("a combined stage", |scene, bytes| run(scene, LARGER[bytes.below(LARGER.len())])),
    ("the first stages", |scene, bytes| {
        let end = bytes.below(FORWARD.len() + 1);
        FORWARD[..end].iter().try_for_each(|&part| run(scene, part))
    }),
    ("the stages with an array overwritten between two", |scene, bytes| {
        let (at, number) = (bytes.below(FORWARD.len()), bytes.number());
        FORWARD[..at].iter().try_for_each(|&part| run(scene, part))?;
        let which = bytes.below(touch_all::DATA_MUT.len());
        (scene.log)(touch_all::DATA_MUT[which]);
        touch_all::write_data(&mut scene.data, which, &mut || number);
        FORWARD[at..].iter().try_for_each(|&part| run(scene, part))
    }),
    ("all stages except one", |scene, bytes| {
        let without = bytes.below(FORWARD.len());
        let parts = FORWARD.iter().enumerate().filter(|(at, _)| *at != without);
        parts.map(|(_, &part)| run(scene, part)).fold(Ok(()), Result::and)
    }),
    ("the combined stages of forward dynamics", |scene, _| {
        scene.data.fwd_position()?;
        scene.data.fwd_velocity()?;
        scene.data.fwd_actuation()?;
        scene.data.fwd_acceleration()?;
        scene.data.fwd_constraint()
    }),
    ("forward_skip, inverse_skip", |scene, bytes| {
        let skip = [Stage::None, Stage::Position, Stage::Velocity, Stage::Acceleration][bytes.below(4)];
        let sensors = bytes.either(SensorUpdate::Skip, SensorUpdate::Compute);
        if bytes.once_in(2) { scene.data.forward_skip(skip, sensors) } else { scene.data.inverse_skip(skip, sensors) }
    }),
    ("add_contact", |scene, bytes| {
        const COLLISION: usize = 7;
        FORWARD[..COLLISION].iter().try_for_each(|&part| run(scene, part))?;
        for _ in 0..bytes.below(6) {
            let contact = contact(&scene.data, bytes)?;
            scene.data.add_contact(&contact)?;
        }
        for &part in &FORWARD[COLLISION..] {
            run(scene, part)?;
            // Invalidates the results of later stages.
            if bytes.once_in(100) {
                let contact = contact(&scene.data, bytes)?;
                scene.data.add_contact(&contact)?;
            }
        }
        Ok(())
    }),
    ("constraint_update", |scene, bytes| {
        let jar = bytes.vector(scene.data.nefc());
        scene.data.constraint_update(&jar, bytes.either(ConeHessian::Compute, ConeHessian::Skip)).map(drop)
    }),
];

fn contact(data: &Data, bytes: &mut Bytes<'_>) -> Result<NewContact> {
    let geoms = [read_only::geom(data, bytes)?, read_only::geom(data, bytes)?];
    let normal = if bytes.once_in(8) { bytes.numbers() } else { [bytes.fraction(), 0.5, bytes.fraction()] };
    let mut contact = NewContact::new(geoms, 0.01 * bytes.fraction(), [0.0; 3], normal);
    contact.dim = [1, 3, 4, 6, 3, bytes.below(9)][bytes.below(6)];
    let number = bytes.number();
    match bytes.below(12) {
        0 => contact.dist = number,
        1 => contact.pos.fill(number),
        2 => contact.includemargin = number,
        3 => contact.friction.fill(number),
        4 => contact.solref.fill(number),
        5 => contact.solimp.fill(number),
        6 => contact.friction[bytes.below(5)] = number,
        7 => contact.solref[bytes.below(2)] = number,
        8 => contact.solimp[bytes.below(5)] = number,
        _ => {}
    }
    Ok(contact)
}
