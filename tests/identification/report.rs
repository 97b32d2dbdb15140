//! Reports are well-formed pages in which names are texts, whatever the numbers.

use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Matrix};

use crate::{SPRING, model, record};

/// Names with markup.
const HOSTILE: &str = "</h3><script>alert('1')</script><img src=x onerror=\"alert(1)\"> & ]]>";

/// Returns the text of a report, which is also written to the folder `REPORTS`, if there is one.
fn report(fit: &Fit, held_out: &[mujoco_safe::identification::MeasurementError], name: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    fit.save_report(&path, held_out).unwrap();
    if let Some(folder) = std::env::var_os("REPORTS") {
        std::fs::copy(&path, std::path::Path::new(&folder).join(name)).unwrap();
    }
    std::fs::read_to_string(path).unwrap()
}

/// Fits the damping and, twice, the mass of the spring, with a held-out log.
fn hostile_fit() -> (Fit, Vec<mujoco_safe::identification::MeasurementError>) {
    let model = model(SPRING);
    let data = Data::new(&model).unwrap();
    let push = |rate: f64| move |time: f64| vec![5.0 * (rate * time).sin()];
    let (log, other) = (record(data.clone(), 400, push(9.0)), record(data.clone(), 300, push(20.0)));
    let experiment = |name: &str, log: &crate::Log| {
        let both = Measurement::of(HOSTILE, log.signal(0..2, 3), |data, output| {
            output.copy_from_slice(&[data.qpos()[0], data.qvel()[0]]);
            Ok(())
        });
        let position = Measurement::of_sensor(&model, "position", log.sensor(&model, "position", 1)).unwrap();
        Experiment::new(name, &data).with_controls(log.controls()).with_measurement(both).with_measurement(position)
    };
    let damping = Unknown::parameter(&model, Parameter::JointDamping(model.joint("slide").unwrap().id())).unwrap();
    let half = |name: &str| {
        let body = model.body("mass").unwrap().id().index();
        Unknown::edit(name, 0.7, move |value, model| {
            model.body_mass_mut()[body] += value - 0.5;
            model.update_constants()
        })
    };
    let unknowns = vec![damping.starting_at(8.0).with_prior(5.0, 10.0), half(HOSTILE), half("half of the mass")];
    let identification = Identification::new(unknowns).unwrap().with_experiment(experiment(HOSTILE, &log)).unwrap();
    let fit = identification.solve(Options::default()).unwrap();
    let held_out = fit.validate([experiment("held-out log", &other)]).unwrap();
    (fit, held_out)
}

#[test]
fn names_are_texts_and_all_parts_are_there() {
    let (fit, held_out) = hostile_fit();
    let page = report(&fit, &held_out, "spring.html");
    for element in ["<script", "<img", "onerror=\""] {
        assert!(!page.contains(element), "{element}");
    }
    // Two names of unknowns, one of a combination, one of an experiment and two of measurements.
    assert!(page.matches("&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt;").count() >= 6);
    // The cost, and two plots for each of the three components of both experiments.
    assert_eq!((page.matches("<svg").count(), page.matches("</svg>").count()), (13, 13));
    assert_eq!(fit.undetermined().len(), 1);
    for text in ["Held-out experiments", "held-out log", "half of the mass", "5 ± 10", "Converged"] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(fit.costs().len(), fit.outcome().iterations);
    assert_eq!([fit.costs()[0], fit.costs()[fit.costs().len() - 1]], [fit.outcome().first_cost, fit.outcome().cost]);
    for error in fit.errors().iter().chain(&held_out) {
        assert_eq!(error.measured.times(), error.simulated.times());
        let squares = error.measured.values().as_slice().iter().zip(error.simulated.values().as_slice());
        let mean = squares.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / error.count as f64;
        assert!((mean.sqrt() - error.rms).abs() <= 1e-12 * error.rms);
    }
}

/// Readings that are missing, huge, or equal to the last digit.
#[test]
fn any_readings_can_be_plotted() {
    let model = model(SPRING);
    let data = Data::new(&model).unwrap();
    let times: Vec<f64> = (0..5000).map(|k| 1e-4 * f64::from(k)).collect();
    for value in [f64::NAN, 0.0, 1e300, -1e300, 1.0 + f64::EPSILON, 5e-324, 1e-8] {
        let values = (0..5000).map(|k| if k % 1700 == 3 { f64::NAN } else { value * f64::from(k % 2) });
        let signal = Signal::new(times.clone(), Matrix::from_row_major(5000, 1, values.collect())).unwrap();
        let position = Measurement::of_sensor(&model, "position", signal).unwrap();
        let experiment = Experiment::new("log", &data).with_measurement(position);
        let fit = Identification::new(vec![]).unwrap().with_experiment(experiment).unwrap();
        let page = report(&fit.solve(Options::default()).unwrap(), &[], &format!("{value:e}.html"));
        assert_eq!(page.matches("</svg>").count(), 3, "{value}");
        assert!(page.len() < 200_000, "{value}: {} bytes", page.len());
    }
}
