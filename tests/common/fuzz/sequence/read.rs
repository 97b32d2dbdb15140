//! What only reads, and what computes from a simulation without changing it.

use std::fmt::Write as _;
use std::hint::black_box;

use mujoco_safe::{Data, Matrix, Result, StateSpec, Warning};

use super::{Bytes, Call, must_panic, touch_all};

/// The displays of every view.
fn text(data: &Data) -> String {
    let model = data.model();
    let mut text = format!("{model:?} {data:?}");
    macro_rules! print {
        ($($many:ident),*) => {$(
            for view in model.$many() { let _ = write!(text, "{view:?} {view}"); }
            for view in data.$many() { let _ = write!(text, "{view:?} {view}"); }
        )*};
    }
    print!(bodies, joints, geoms, sites, cameras, lights, tendons, actuators, sensors);
    for key in model.keyframes() {
        let _ = write!(text, "{key:?} {key}");
    }
    text
}

fn jacobians(data: &mut Data, bytes: &mut Bytes<'_>) -> Result<()> {
    let model = data.model().clone();
    let body = model.body(bytes.index(model.nbody()))?;
    black_box(data.jac_body(body)?);
    black_box(data.jac_body_com(body)?);
    black_box(data.jac(body, bytes.numbers())?);
    black_box(data.jac_subtree_com(body)?);
    if let Ok(geom) = model.geom(bytes.below(8)) {
        black_box(data.jac_geom(geom)?);
    }
    if let Ok(site) = model.site(bytes.below(4)) {
        black_box(data.jac_site(site)?);
    }
    let nv = model.nv() + usize::from(bytes.once_in(8));
    let (mut translation, mut rotation) = (Matrix::zeros(3, nv), Matrix::zeros(3, model.nv()));
    data.jac_body_into(body, Some(&mut translation), Some(&mut rotation))?;
    data.jac_body_com_into(body, None, Some(&mut translation))
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("jacobians", |scene, bytes| jacobians(&mut scene.data, bytes)),
    ("full_m", |scene, bytes| {
        let nv = scene.data.model().nv();
        let mut full = Matrix::zeros(nv, nv + usize::from(bytes.once_in(8)));
        scene.data.full_m_into(&mut full)?;
        scene.data.full_m().map(drop)
    }),
    ("mul_m", |scene, bytes| {
        let nv = scene.data.model().nv();
        let (mut result, vector) = (bytes.vector(nv), bytes.vector(nv));
        scene.data.mul_m(&mut result, &vector)
    }),
    ("solve_m", |scene, bytes| {
        let nv = scene.data.model().nv();
        // Several right-hand sides at once, too.
        let times = 1 + bytes.below(3);
        let (mut result, vector) = (bytes.vector(times * nv), bytes.vector(times * nv));
        scene.data.solve_m(&mut result, &vector)
    }),
    ("contacts", |scene, _| {
        for contact in scene.data.contacts() {
            black_box((contact.geoms(), contact.frame(), contact.is_active(), contact.friction(), contact.dim()));
            black_box((contact.force(), contact.force_in_world()).0?);
            black_box(format!("{contact:?}"));
        }
        Ok(())
    }),
    ("energy, stage, warnings", |scene, _| {
        black_box((scene.data.energy(), scene.data.stage(), scene.data.warning(Warning::BadQpos)));
        Ok(())
    }),
    ("state", |scene, bytes| {
        let spec = StateSpec::from_bits_retain(bytes.word() as u32);
        let mut state = bytes.vector(scene.data.model().state_size(spec));
        scene.state = scene.data.state(StateSpec::INTEGRATION);
        scene.data.state_into(spec, &mut state)
    }),
    ("every array", |scene, bytes| {
        if scene.data.model().nv() < 30 || bytes.once_in(4) {
            black_box(touch_all::data(&scene.data));
        }
        Ok(())
    }),
    ("every array of the model", |scene, bytes| {
        if scene.data.model().nv() < 30 || bytes.once_in(4) {
            black_box(touch_all::model(scene.data.model()));
        }
        Ok(())
    }),
    ("every display", |scene, bytes| {
        if bytes.once_in(4) {
            black_box(text(&scene.data));
        }
        Ok(())
    }),
    ("names", |scene, bytes| {
        let model = scene.data.model();
        let name = model.joint(bytes.index(model.njnt()))?.name().map(str::to_owned);
        black_box(name.map(|name| model.joint(&name[..]).map(|joint| joint.index())));
        model.geom(*bytes.choose(&[&"", &"\0", &"floor", &"no such geom"])).map(drop)
    }),
    ("differentiate_pos, integrate_pos", |scene, bytes| {
        let model = scene.data.model();
        let (one, two, mut qvel) = (bytes.vector(model.nq()), bytes.vector(model.nq()), bytes.vector(model.nv()));
        model.differentiate_pos(&mut qvel, bytes.number(), &one, &two)?;
        let mut qpos = one;
        model.integrate_pos(&mut qpos, &qvel, bytes.number())
    }),
    ("statistics", |scene, _| {
        let model = scene.data.model();
        black_box((model.statistics(), model.options(), model.compile_warnings().len(), model.text_data().len()));
        Ok(())
    }),
    ("an id of another model", |scene, bytes| {
        let Some(other) = scene.other.as_ref().filter(|other| !other.model().is_same_structure(scene.data.model()))
        else {
            return Ok(());
        };
        let body = other.model().body(0)?.id();
        match bytes.below(3) {
            0 => must_panic(|| scene.data.jac_body(body)),
            1 => must_panic(|| scene.data.body(body).index()),
            _ => must_panic(|| scene.data.model().name(body).map(str::len)),
        }
        Ok(())
    }),
];
