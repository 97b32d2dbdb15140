//! Calls on `&Data`, which a callback may make as well.

use std::hint::black_box;

use mujoco_safe::data::{Axes, FrameId, RayOptions, Timer, Warning};
use mujoco_safe::id::{BodyId, GeomId};
use mujoco_safe::{Data, Matrix, Result, StateSpec, Trajectory};

use super::{Bytes, Call, print_all, touch_all};

/// A call that only reads.
type ReadOnlyCall = fn(&Data, &mut Bytes<'_>) -> Result<()>;

pub(super) const CALLS: &[(&str, Call)] = &[("a read-only call", |scene, bytes| {
    let (name, call) = any(bytes);
    (scene.log)(name);
    if bytes.once_in(100) {
        let data = &scene.data;
        return std::thread::scope(|scope| {
            scope.spawn(|| call(data, bytes)).join().expect("a read-only call panicked")
        });
    }
    call(&scene.data, bytes)
})];

/// Returns a call and its name.
pub(super) fn any(bytes: &mut Bytes<'_>) -> (&'static str, ReadOnlyCall) {
    READ_ONLY_CALLS[bytes.below(READ_ONLY_CALLS.len())]
}

pub(super) fn body(data: &Data, bytes: &mut Bytes<'_>) -> Result<BodyId> {
    Ok(data.model().body(bytes.index(data.model().nbody()))?.id())
}

pub(super) fn geom(data: &Data, bytes: &mut Bytes<'_>) -> Result<GeomId> {
    Ok(data.model().geom(bytes.index(data.model().ngeom()))?.id())
}

fn frame(data: &Data, bytes: &mut Bytes<'_>) -> Result<FrameId> {
    let model = data.model();
    Ok(match bytes.below(5) {
        0 => FrameId::BodyInertia(body(data, bytes)?),
        1 => FrameId::Body(body(data, bytes)?),
        2 => FrameId::Geom(geom(data, bytes)?),
        3 => FrameId::Site(model.site(bytes.index(model.nsite()))?.id()),
        _ => FrameId::Camera(model.camera(bytes.index(model.ncam()))?.id()),
    })
}

fn axes(bytes: &mut Bytes<'_>) -> Axes {
    [Axes::World, Axes::Local][bytes.below(2)]
}

fn ray_options(data: &Data, bytes: &mut Bytes<'_>) -> Result<RayOptions> {
    let groups = bytes.word();
    let mut options = RayOptions::default().with_static_geoms(bytes.once_in(2));
    options.geomgroup = bytes.once_in(2).then(|| std::array::from_fn(|group| groups >> group & 1 != 0));
    options.bodyexclude = if bytes.once_in(4) { Some(body(data, bytes)?) } else { None };
    Ok(options)
}

/// Returns a direction, mostly a valid one.
fn direction(bytes: &mut Bytes<'_>) -> [f64; 3] {
    if bytes.once_in(4) { bytes.numbers() } else { std::array::from_fn(|_| bytes.fraction()) }
}

const READ_ONLY_CALLS: &[(&str, ReadOnlyCall)] = &[
    ("jac_body, jac_body_com, jac", |data, bytes| {
        let body = body(data, bytes)?;
        black_box((data.jac_body(body)?, data.jac_body_com(body)?, data.jac(bytes.numbers(), body)?));
        let nv = data.model().nv() + usize::from(bytes.once_in(8));
        let (mut translation, mut rotation) = (Matrix::zeros(3, nv), Matrix::zeros(3, data.model().nv()));
        data.jac_into(bytes.numbers(), body, Some(&mut translation), None)?;
        data.jac_body_into(body, Some(&mut translation), Some(&mut rotation))?;
        data.jac_body_com_into(body, None, Some(&mut translation))
    }),
    ("jac_geom, jac_site", |data, bytes| {
        black_box(data.jac_geom(geom(data, bytes)?)?);
        black_box(data.jac_site(data.model().site(bytes.index(data.model().nsite()))?)?);
        Ok(())
    }),
    ("angmom_mat", |data, bytes| {
        black_box(data.angmom_mat(body(data, bytes)?)?);
        let mut matrix = Matrix::zeros(3, data.model().nv() + usize::from(bytes.once_in(4)));
        data.angmom_mat_into(body(data, bytes)?, &mut matrix)
    }),
    ("full_m", |data, bytes| {
        let nv = data.model().nv();
        let mut full = Matrix::zeros(nv, nv + usize::from(bytes.once_in(8)));
        data.full_m_into(&mut full)?;
        data.full_m().map(drop)
    }),
    ("mul_m, mul_m2", |data, bytes| {
        let nv = data.model().nv();
        let (mut result, vector) = (bytes.vector(nv), bytes.vector(nv));
        data.mul_m_into(&vector, &mut result)?;
        data.mul_m2_into(&vector, &mut result)
    }),
    ("mul_jac_vec, mul_jac_t_vec", |data, bytes| {
        let (mut rows, mut columns) = (bytes.vector(data.nefc()), bytes.vector(data.model().nv()));
        data.mul_jac_vec_into(&columns, &mut rows)?;
        data.mul_jac_t_vec_into(&rows, &mut columns)
    }),
    ("object_velocity, object_acceleration", |data, bytes| {
        black_box(data.object_velocity(frame(data, bytes)?, axes(bytes))?);
        black_box(data.object_acceleration(frame(data, bytes)?, axes(bytes))?);
        Ok(())
    }),
    ("local_to_global", |data, bytes| {
        data.local_to_global(bytes.numbers(), bytes.numbers(), body(data, bytes)?).map(drop)
    }),
    ("ray", |data, bytes| {
        let options = ray_options(data, bytes)?;
        data.ray(bytes.numbers(), direction(bytes), &options).map(drop)
    }),
    ("multi_ray_into", |data, bytes| {
        let options = ray_options(data, bytes)?;
        let directions: Vec<_> = (0..bytes.below(5)).map(|_| direction(bytes)).collect();
        let mut hits = vec![None; directions.len() + usize::from(bytes.once_in(8))];
        data.multi_ray_into(bytes.numbers(), &directions, &options, bytes.number(), &mut hits)
    }),
    ("ray_mesh, ray_hfield", |data, bytes| {
        let (mesh, field) = (
            data.ray_mesh(geom(data, bytes)?, bytes.numbers(), direction(bytes)),
            data.ray_hfield(geom(data, bytes)?, bytes.numbers(), direction(bytes)),
        );
        mesh.and(field).map(drop)
    }),
    ("contacts", |data, _| {
        for contact in data.contacts() {
            black_box((
                contact.geoms(),
                contact.sides(),
                contact.frame(),
                contact.is_active(),
                contact.friction(),
                contact.dim(),
            ));
            black_box((contact.force(), contact.force_in_world()).0?);
            black_box(format!("{contact:?}"));
        }
        Ok(())
    }),
    ("the row of a tendon", |data, bytes| {
        let tendon = data.tendon(bytes.index(data.model().ntendon()))?;
        let Some(row) = tendon.J() else { return Ok(()) };
        black_box((row.iter().count(), row.to_vec(), tendon.wrap_points().count()));
        row.write_into(&mut bytes.vector(data.model().nv()))
    }),
    ("energy, stage, warnings, solver, timers", |data, _| {
        black_box((data.energy(), data.stage(), data.warning(Warning::BadQpos), data.solver_fwdinv()));
        black_box((data.solver().count(), data.solver().last()));
        black_box(Timer::ALL.map(|timer| data.timer(timer)));
        let model = data.model();
        black_box((model.is_pyramidal(), model.is_sparse(), model.is_dual(), model.total_mass()));
        data.check_state()
    }),
    ("state", |data, bytes| {
        let spec = StateSpec::from_bits_retain(bytes.word() as u32);
        let mut state = bytes.vector(data.model().state_size(spec));
        black_box((data.state(spec), data.physics_state()));
        data.state_into(spec, &mut state)?;
        data.physics_state_into(&mut state)
    }),
    ("every array", |data, bytes| {
        if data.model().nv() < 30 || bytes.once_in(4) {
            black_box(touch_all::data(data));
        }
        Ok(())
    }),
    ("every array of the model", |data, bytes| {
        if data.model().nv() < 30 || bytes.once_in(4) {
            black_box(touch_all::model(data.model()));
        }
        Ok(())
    }),
    ("every view", |data, bytes| {
        if bytes.once_in(if data.model().nbody() < 12 { 8 } else { 64 }) {
            black_box((print_all::print_all(data.model(), data), format!("{:?} {data:?}", data.model())));
        }
        Ok(())
    }),
    ("names", |data, bytes| {
        let model = data.model();
        let name = model.joint(bytes.index(model.njnt()))?.name().map(str::to_owned);
        black_box(name.map(|name| model.joint(&name[..]).map(|joint| joint.index())));
        model.geom(*bytes.choose(&[&"", &"\0", &"floor", &"no such geom"])).map(drop)
    }),
    ("differentiate_pos, integrate_pos, normalize_quat", |data, bytes| {
        let model = data.model();
        let (one, two, mut qvel) = (bytes.vector(model.nq()), bytes.vector(model.nq()), bytes.vector(model.nv()));
        model.differentiate_pos_into(bytes.number(), &one, &two, &mut qvel)?;
        let mut qpos = one;
        model.integrate_pos(&mut qpos, &qvel, bytes.number())?;
        model.normalize_quat(&mut qpos)
    }),
    ("statistics, options, visual", |data, _| {
        let model = data.model();
        black_box((model.statistics(), model.options(), model.visual(), model.compile_warnings().len()));
        Ok(())
    }),
    ("a record", |data, _| Trajectory::new(data.model()).push(data)),
    ("a clone that steps", |data, bytes| {
        let mut copy = data.try_clone()?;
        if bytes.once_in(2) { copy.step() } else { copy.forward() }
    }),
];
