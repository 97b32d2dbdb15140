//! Identification of a mass on a spring (one unknown, 1,500 steps), of the armatures of an arm
//! (five unknowns, 1,000 steps), which are the problems of the tests of `mujoco.sysid`, and of the
//! inertia of the arm's load with its armatures and dampings (20 unknowns).
//!
//! If the environment variable `MUJOCO_PYTHON` names a Python with `mujoco[sysid]` of the engine's
//! version, both solve the same problems alternately, and the ratio of the times and the largest
//! error of an unknown are printed, of those that are no inertia. The time of the bare steps of the
//! log, without any identification, is the unit of the last numbers: each iteration of a search
//! takes at least one such rollout, and one for each differenced unknown.
//!
//! ```text
//! MUJOCO_DIR=$(scripts/engine 3.17.0) MUJOCO_PYTHON=python3 cargo bench --bench identification
//! ```

mod common;

use std::env;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use common::peer::{Comparison, Peer, line};
use mujoco_safe::derivative::ModelParameter;
use mujoco_safe::identification::{Experiment, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Matrix, Model, Result};

const PAIRS: usize = 15;

/// Program that reads the model, the unknowns (what, and of which joint or body), the truth, the
/// first value, the bounds, the times, the controls and the readings, and solves the problem once
/// per input line.
const SYSID: &str = r#"
import sys, time
import mujoco, numpy as np
from mujoco import sysid

def numbers():
    return np.array([float(number) for number in sys.stdin.readline().split()])

xml = sys.stdin.readline()
unknowns = [unknown.split(":") for unknown in sys.stdin.readline().split()]
truth = numbers()
first, low, high = numbers()
times = numbers()
spec = mujoco.MjSpec.from_string(xml)
model = spec.compile()
data = mujoco.MjData(model)
controls = numbers().reshape(len(times), model.nu)
readings = numbers().reshape(len(times), model.nsensordata)
start = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
# Its readings of a step carry the time after the step.
late = sysid.TimeSeries.from_names(times[:-1] + model.opt.timestep, readings[:-1], model)
sequence = sysid.ModelSequences("problem", spec, "log", start, sysid.TimeSeries(times, controls), late)
residual = sysid.build_residual_fn(models_sequences=[sequence])

def write(kind, name):
    if kind == "mass":
        return lambda s, p: setattr(s.body(name), "mass", p.value[0])
    if kind == "armature":
        return lambda s, p: setattr(s.joint(name), "armature", p.value[0])
    def damping(s, p):
        joint = s.joint(name)
        joint.damping = p.value[0] if np.isscalar(joint.damping) else [p.value[0], 0.0, 0.0]
    return damping

def unknown(kind, name, value):
    if kind == "inertia":
        # Its own function for this sets a rotation that the compiler does not accept.
        def modify(s, p):
            sysid.apply_body_inertia(s, name, p)
            s.body(name).iquat = [1.0, 0.0, 0.0, 0.0]
        return sysid.body_inertia_param(spec, model, name, inertia_type=sysid.InertiaType.Pseudo, modifier=modify)
    one = sysid.Parameter(f"{kind}:{name}", nominal=value, min_value=low, max_value=high, modifier=write(kind, name))
    one.value[:] = first
    return one

print("ready", flush=True)
for _ in sys.stdin:
    params = sysid.ParameterDict()
    for (kind, name), value in zip(unknowns, truth):
        params.add(unknown(kind, name, value))
    begin = time.perf_counter()
    found, _ = sysid.optimize(initial_params=params, residual_fn=residual, optimizer="mujoco", verbose=False)
    seconds = time.perf_counter() - begin
    named = [(f"{kind}:{name}", value) for (kind, name), value in zip(unknowns, truth) if kind != "inertia"]
    error = max(abs(found[name].value[0] - value) for name, value in named)
    print(repr(seconds), repr(float(error)), file=sys.__stdout__, flush=True)
"#;

/// Unknown number (`mass` or `inertia` of a body, `armature` or `damping` of a joint), its element,
/// and the truth.
type Hidden = (&'static str, String, f64);

struct Problem {
    xml: String,
    hidden: Vec<Hidden>,
    /// First value, and bounds.
    range: [f64; 3],
    times: Vec<f64>,
    controls: Matrix,
    readings: Matrix,
    start: Data,
    identification: Identification,
}

fn spring() -> Result<Problem> {
    let xml = r#"<mujoco><option timestep="0.002"><flag contact="disable"/></option><worldbody><body name="mass">
        <inertial pos="0 0 0" mass="1" diaginertia="0.001 0.001 0.001"/>
        <joint name="slide" type="slide" axis="1 0 0" stiffness="100" damping="5"/><geom size="0.05"/></body></worldbody>
        <actuator><motor name="push" joint="slide"/></actuator>
        <sensor><jointpos name="position" joint="slide"/><jointvel name="velocity" joint="slide"/></sensor></mujoco>"#;
    let push = |time: f64| vec![5.0 * (TAU * 1.5 * time).sin() + 3.0 * (TAU * 3.7 * time).sin()];
    Problem::new(xml, vec![("mass", "mass".into(), 1.0)], [2.0, 0.3, 3.0], 1500, push)
}

/// Returns the arm with unknown armatures and, if it carries a load, its inertia and dampings.
fn arm(has_load: bool) -> Result<Problem> {
    let truth = [0.5, 0.4, 0.3, 0.2, 0.1];
    let (mut bodies, mut motors, mut sensors) = (String::new(), String::new(), String::new());
    for (i, armature) in truth.iter().enumerate() {
        let (mass, axis) = ([1.0, 0.8, 0.6, 0.4, 0.2][i], ["0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0"][i]);
        let _ = write!(
            bodies,
            r#"<body name="b{i}" pos="0 0 .1"><inertial pos="0 0 .05" mass="{mass}" diaginertia="{0} {0} {1}"/>
            <joint name="j{i}" axis="{axis}" armature="{armature}" damping="{2}"/><geom size=".03"/>"#,
            0.01 * mass,
            0.005 * mass,
            2.0 * armature
        );
        let _ = write!(motors, r#"<motor name="m{i}" joint="j{i}"/>"#);
        let _ = write!(sensors, r#"<jointpos name="q{i}" joint="j{i}"/><jointvel name="v{i}" joint="j{i}"/>"#);
    }
    let xml = format!(
        r#"<mujoco><option timestep="0.002" integrator="implicit"><flag contact="disable"/></option><worldbody>{bodies}{}</worldbody>
        <actuator>{motors}</actuator><sensor>{sensors}</sensor></mujoco>"#,
        "</body>".repeat(5)
    );
    let control = |time: f64| {
        let rates = [0.5, 0.7, 0.4, 0.9, 0.6];
        (0..5).map(|i| (5 - i) as f64 * (TAU * rates[i] * time + 0.5 * i as f64).sin()).collect()
    };
    let joints = |what: &'static str, factor: f64| {
        truth.iter().enumerate().map(move |(i, armature)| (what, format!("j{i}"), factor * armature))
    };
    let mut hidden: Vec<Hidden> = joints("armature", 1.0).collect();
    if has_load {
        hidden.extend(joints("damping", 2.0));
        hidden.push(("inertia", "b4".into(), f64::NAN));
    }
    // From far away, a search for all of them ends in another minimum.
    let first = if has_load { 0.25 } else { 0.01 };
    Problem::new(&xml, hidden, [first, 0.001, 2.0], 1000, control)
}

impl Problem {
    fn new(
        xml: &str,
        hidden: Vec<Hidden>,
        range: [f64; 3],
        steps: usize,
        control: impl Fn(f64) -> Vec<f64>,
    ) -> Result<Self> {
        let xml = xml.replace('\n', " ");
        let model = Arc::new(Model::from_xml_str(&xml)?);
        let mut data = Data::new(&model)?;
        let start = data.clone();
        let mut unknowns = Vec::new();
        for (what, name, _) in &hidden {
            if *what == "inertia" {
                // The data come from another inertia than that of the model.
                let body = model.body(name)?.id();
                data.edit_model(|model| {
                    model.body_mut(body).scale_mass(1.8)?;
                    model.body_ipos_mut()[body.index()] = [0.01, 0.02, 0.06];
                    model.update_constants()
                })?;
                // The bounds of `mujoco.sysid`: a tenth to ten times the mass, half to twice the
                // moments, and half a metre.
                let near = [0.5 * 10_f64.ln(), 0.5 * 2_f64.ln(), 0.5, 0.5];
                for (at, unknown) in Unknown::all_inertia(&model, body)?.into_iter().enumerate() {
                    let first = ModelParameter::LogCholesky(body, at).value(&model)?;
                    let near = near[[0, 1, 1, 1, 2, 2, 2, 3, 3, 3][at]];
                    unknowns.push(unknown.between(first - near, first + near));
                }
                continue;
            }
            let parameter = match *what {
                "mass" => Parameter::MassFactor(model.body(name)?.id()),
                "armature" => Parameter::JointArmature(model.joint(name)?.id()),
                _ => Parameter::JointDamping(model.joint(name)?.id()),
            };
            unknowns.push(Unknown::parameter(&model, parameter)?.starting_at(range[0]).between(range[1], range[2]));
        }
        let (mut times, mut controls, mut readings) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..steps {
            times.push(data.time());
            let control = control(data.time());
            data.ctrl_mut().copy_from_slice(&control);
            data.step()?;
            controls.extend(control);
            readings.extend_from_slice(data.sensordata());
        }
        let controls = Matrix::from_row_major(steps, model.nu(), controls);
        let readings = Matrix::from_row_major(steps, model.nsensordata(), readings);
        let mut experiment =
            Experiment::new("log", &start).with_controls(Signal::new(times.clone(), controls.clone())?);
        for sensor in model.sensors() {
            let place = sensor.data_range().start;
            let values = readings.rows().map(|row| row[place]).collect();
            let signal = Signal::scalar(times.clone(), values)?;
            experiment = experiment.with_measurement(Measurement::of_sensor(&model, sensor.id(), signal)?);
        }
        let identification = Identification::new(unknowns)?.with_experiment(experiment)?;
        Ok(Self { xml, hidden, range, times, controls, readings, start, identification })
    }

    /// Returns the seconds and the largest error.
    fn solve(&self) -> (f64, f64) {
        let start = Instant::now();
        let fit = self.identification.solve(Options::default()).expect("a search");
        let seconds = start.elapsed().as_secs_f64();
        let errors = fit.estimates().iter().zip(&self.hidden).filter(|(_, (what, ..))| *what != "inertia");
        let errors = errors.map(|(estimate, (_, _, truth))| (estimate.value - truth).abs());
        (seconds, errors.fold(0.0, f64::max))
    }

    /// Returns the seconds of the steps of the log.
    fn rollout(&self) -> f64 {
        let mut data = self.start.clone();
        let start = Instant::now();
        for control in self.controls.rows() {
            data.ctrl_mut().copy_from_slice(control);
            data.step().expect("the log is stable");
        }
        start.elapsed().as_secs_f64()
    }

    /// Solves the problem alternately with `mujoco.sysid`.
    fn beside_sysid(&self, python: &str, name: &str) -> std::io::Result<()> {
        let names: Vec<String> = self.hidden.iter().map(|(what, name, _)| format!("{what}:{name}")).collect();
        let mut lines = vec![self.xml.clone(), names.join(" ")];
        lines.push(line(self.hidden.iter().map(|(_, _, truth)| *truth)));
        let numbers = [&self.range[..], &self.times, self.controls.as_slice(), self.readings.as_slice()];
        lines.extend(numbers.map(|numbers| line(numbers.iter().copied())));
        let mut peer = Peer::start(python, &["-c", SYSID], &lines)?;
        let (mut error, mut rollouts) = (0.0, Vec::new());
        let Comparison { ours, theirs, ratio: [low, middle, high], rest } = peer.compare(PAIRS, "", || {
            rollouts.push(self.rollout());
            let (seconds, found) = self.solve();
            error = found;
            seconds
        })?;
        println!(
            "{name}: {:.1} ms (error {error:.1e}), mujoco.sysid {:.1} ms (error {:.1e}), ratio {middle:.3} [{low:.3}, {high:.3}]",
            1e3 * ours,
            1e3 * theirs,
            rest.first().unwrap_or(&f64::NAN),
        );
        let rollout = common::median(rollouts);
        println!(
            "    bare steps of the log {:.2} ms: {:.1} and {:.1} times",
            1e3 * rollout,
            ours / rollout,
            theirs / rollout
        );
        Ok(())
    }
}

fn main() -> Result<()> {
    for (name, problem) in [
        ("mass on a spring", spring()?),
        ("armatures of an arm", arm(false)?),
        ("load, armatures and dampings of an arm", arm(true)?),
    ] {
        if !common::is_selected(name) {
            continue;
        }
        match env::var_os("MUJOCO_PYTHON") {
            None => {
                common::bench(name, 1, &mut || _ = problem.solve());
                common::bench(&format!("{name}, bare steps of the log"), 1, &mut || _ = problem.rollout());
            }
            Some(python) => {
                if let Err(error) = problem.beside_sysid(&python.to_string_lossy(), name) {
                    println!("{name}: mujoco.sysid cannot be compared: {error}");
                }
            }
        }
    }
    Ok(())
}
