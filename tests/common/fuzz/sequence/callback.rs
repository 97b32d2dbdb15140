//! Callbacks: permitted calls in a step, and misuse.

use std::panic::resume_unwind;
use std::sync::Arc;

use mujoco_safe::callback::Callbacks;
use mujoco_safe::{Data, Model, Result};

use super::super::bytes::of_seed;
use super::{Bytes, Call, ON_PURPOSE, call_some, expected, models, read_only};

/// Largest depth of nested scopes.
const DEEPEST: usize = 2;

/// The behaviour of a closure.
struct Closure {
    seed: u64,
    /// A simulation that the closure owns.
    own: Option<Data>,
    /// Mean number of calls per misuse.
    misuse_period: usize,
}

impl Closure {
    fn new(bytes: &mut Bytes<'_>, own: Option<Data>) -> Self {
        Self { seed: bytes.word(), own, misuse_period: [2, 8, 32][bytes.below(3)] }
    }

    /// Performs an action, and returns a number.
    fn act(&mut self, data: &Data, write: impl FnOnce(&mut Bytes<'_>)) -> f64 {
        self.seed = self.seed.wrapping_add(1);
        let stream = of_seed(self.seed, 0xc);
        let bytes = &mut Bytes::new(&stream);
        if bytes.once_in(2) {
            write(bytes);
        }
        if bytes.once_in(3) {
            let (_, call) = read_only::any(bytes);
            expected(&call(data, bytes));
        }
        if bytes.once_in(self.misuse_period) {
            expected(&self.misbehave(data, bytes));
        }
        if bytes.once_in(4) { bytes.number() } else { bytes.fraction() }
    }

    fn misbehave(&mut self, data: &Data, bytes: &mut Bytes<'_>) -> Result<()> {
        match bytes.below(8) {
            // Without the panic hook, which would print the message.
            0 => resume_unwind(Box::new(ON_PURPOSE)),
            1 => resume_unwind(Box::new(1)),
            2 => {
                let mut copy = data.try_clone()?;
                copy.step()?;
                self.own = Some(copy);
                Ok(())
            }
            3 => {
                let number = bytes.number();
                let callbacks = Callbacks::new()
                    .with_control(move |context| context.ctrl_mut().fill(number))
                    .with_actuator_gain(move |_, _| number)
                    .with_contact_filter(|_, _, collides| !collides);
                let Some(own) = &mut self.own else { return Ok(()) };
                if bytes.once_in(2) {
                    own.set_callbacks(callbacks);
                    return own.step();
                }
                own.with_callbacks(callbacks, Data::step)
            }
            4 if bytes.once_in(16) => {
                let text =
                    bytes.choose(&["<mujoco/>", "<mujoco><worldbody><body/></worldbody></mujoco>", "<nothing/>"]);
                self.own = Some(Data::new(Model::from_xml_str(text)?)?);
                Ok(())
            }
            5 => {
                let number = bytes.number();
                self.own.as_mut().map_or(Ok(()), |own| own.edit_model(|model| model.set_timestep(number)))
            }
            6 => {
                self.own = None;
                Ok(())
            }
            _ => self.own.as_mut().map_or(Ok(()), Data::step),
        }
    }
}

/// Returns some of the callbacks.
fn callbacks(bytes: &mut Bytes<'_>, other: Option<&Data>) -> Callbacks<'static> {
    let mut callbacks = Callbacks::new();
    // Rarely all of them.
    let set = bytes.word() & if bytes.once_in(4) { u64::MAX } else { bytes.word() };
    let mut closure = |kind: u32| {
        (set >> kind & 1 != 0)
            .then(|| Closure::new(bytes, other.filter(|_| kind < 3).and_then(|data| data.try_clone().ok())))
    };
    if let Some(mut closure) = closure(0) {
        callbacks = callbacks.with_control(move |context| {
            // A context dereferences to its data, which must not be borrowed while it is written
            // to.
            let mut value = None;
            let number = closure.act(context, |bytes| value = Some(bytes.below(4)));
            match value {
                Some(0) => context.ctrl_mut().fill(number),
                Some(1) => context.qfrc_applied_mut().fill(number),
                Some(2) => context.xfrc_applied_mut().as_flattened_mut().fill(number),
                Some(_) => context.userdata_mut().fill(number),
                None => {}
            }
        });
    }
    if let Some(mut closure) = closure(1) {
        callbacks = callbacks.with_passive(move |context| {
            let number = closure.act(context, |_| ());
            context.qfrc_passive_mut().iter_mut().step_by(2).for_each(|force| *force += number);
            context.userdata_mut().fill(number);
        });
    }
    if let Some(mut closure) = closure(2) {
        callbacks = callbacks.with_sensor(move |context| {
            let mut index = 0;
            let number = closure.act(context, |bytes| index = bytes.index(context.model().nsensor()));
            if number > 0.0 {
                context.sensordata_mut().fill(number);
            } else if let Ok(values) = context.data_mut(index) {
                values.fill(number);
            }
            let _ = context.stage();
        });
    }
    if let Some(mut closure) = closure(3) {
        callbacks = callbacks.with_contact_filter(move |data, [one, other], collides| {
            assert_ne!(data.geom(one).index(), data.geom(other).index());
            (closure.act(data, |_| ()) > 0.0) ^ collides
        });
    }
    if let Some(mut closure) = closure(4) {
        callbacks = callbacks.with_actuator_dynamics(move |data, actuator| {
            closure.act(data, |_| ()) + data.model().actuator(actuator).dynprm()[0]
        });
    }
    if let Some(mut closure) = closure(5) {
        callbacks = callbacks
            .with_actuator_gain(move |data, actuator| closure.act(data, |_| ()) * data.actuator(actuator).ctrl());
    }
    if let Some(mut closure) = closure(6) {
        callbacks = callbacks
            .with_actuator_bias(move |data, actuator| closure.act(data, |_| ()) + data.actuator(actuator).length());
    }
    callbacks
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("with_callbacks", |scene, bytes| {
        let callbacks = callbacks(bytes, scene.other.as_ref());
        let data = &mut scene.data;
        let steps = 1 + bytes.below(3);
        data.with_callbacks(callbacks, |data| {
            let results = (0..steps).map(|_| {
                let result = if steps == 2 { data.inverse() } else { data.step() };
                expected(&result);
                result
            });
            results.fold(Ok(()), Result::and)
        })
    }),
    ("with_callbacks, and other calls", |scene, bytes| {
        if scene.depth == DEEPEST {
            return Ok(());
        }
        let callbacks = callbacks(bytes, scene.other.as_ref());
        let stays = bytes.once_in(8);
        let mut held = std::mem::replace(&mut scene.data, Data::new(smallest())?);
        scene.depth += 1;
        held.with_callbacks(callbacks, |held| {
            std::mem::swap(held, &mut scene.data);
            let calls = 1 + bytes.below(8);
            call_some(scene, bytes, calls);
            if !stays {
                std::mem::swap(held, &mut scene.data);
            }
        });
        scene.depth -= 1;
        if !stays {
            scene.data = held;
        }
        Ok(())
    }),
    ("with_callbacks, and another simulation in its place", |scene, bytes| {
        let Some(other) = &mut scene.other else { return Ok(()) };
        let callbacks = callbacks(bytes, Some(&*other));
        let replaced = bytes.once_in(4);
        let result = scene.data.with_callbacks(callbacks, |data| {
            expected(&data.step());
            std::mem::swap(data, other);
            let results = [data.step(), other.step()];
            results.iter().for_each(expected);
            if replaced {
                *other = Data::new(smallest())?;
            }
            Ok(())
        });
        result.and(scene.data.step()).and(scene.other.as_mut().map_or(Ok(()), Data::step))
    }),
    ("with_callbacks, and a panic", |scene, bytes| {
        let callbacks = callbacks(bytes, None);
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            scene.data.with_callbacks(callbacks, |data| {
                expected(&data.forward());
                resume_unwind(Box::new(ON_PURPOSE))
            })
        }));
        assert!(result.is_err_and(|payload: Box<dyn std::any::Any + Send>| payload.is::<&str>()), "no panic");
        scene.data.step()
    }),
    ("set_callbacks", |scene, bytes| {
        let callbacks = callbacks(bytes, scene.other.as_ref());
        scene.data.set_callbacks(callbacks);
        scene.data.step()
    }),
    ("set_callbacks of another simulation", |scene, bytes| {
        let callbacks = callbacks(bytes, None);
        if let Some(other) = &mut scene.other {
            other.set_callbacks(callbacks);
            expected(&other.step());
        }
        Ok(())
    }),
    ("set_callbacks, of an empty set", |scene, _| {
        scene.data.set_callbacks(Callbacks::new());
        Ok(())
    }),
];

fn smallest() -> Arc<Model> {
    models::model(models::index_of(models::SMALLEST)).clone()
}
