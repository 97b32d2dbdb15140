//! Noise on the controls, for a test of how robust a controller is.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::data::Data;
use crate::viewer::link::ControlNoise;

/// Seed of every run, so that a run can be repeated.
const SEED: u64 = 1;

/// Ornstein–Uhlenbeck process on each control, as in the engine's `simulate`.
#[derive(Debug)]
pub(super) struct NoiseSource {
    pub settings: ControlNoise,
    generator: Xoshiro256PlusPlus,
    /// State of each process, whose stationary standard deviation is 1.
    processes: Vec<f64>,
    /// Controls without noise, while the noise is applied.
    controls: Vec<f64>,
}

impl Default for NoiseSource {
    fn default() -> Self {
        Self {
            settings: ControlNoise::default(),
            generator: Xoshiro256PlusPlus::seed_from_u64(SEED),
            processes: Vec::new(),
            controls: Vec::new(),
        }
    }
}

impl NoiseSource {
    /// Restarts the processes.
    pub fn reset(&mut self) {
        *self = Self { settings: self.settings, ..Self::default() };
    }

    /// Advances the processes by a step, and adds them to the controls.
    pub fn apply(&mut self, data: &mut Data) {
        if self.settings.deviation <= 0.0 {
            return;
        }
        let model = data.model().clone();
        self.processes.resize(model.nu(), 0.0);
        self.controls.clear();
        self.controls.extend_from_slice(data.ctrl());
        let decay = (-model.timestep() / self.settings.correlation_time.max(f64::MIN_POSITIVE)).exp();
        let gain = (1.0 - decay * decay).sqrt();
        for (index, (process, control)) in self.processes.iter_mut().zip(data.ctrl_mut()).enumerate() {
            let sample: f64 = StandardNormal.sample(&mut self.generator);
            *process = decay * *process + gain * sample;
            let half_range = match model.actuator_ctrlrange()[index] {
                [low, high] if model.actuator_ctrllimited()[index] != 0 => 0.5 * (high - low),
                _ => 1.0,
            };
            *control += self.settings.deviation * half_range * *process;
        }
    }

    /// Restores the controls without noise after a step.
    pub fn remove(&mut self, data: &mut Data) {
        if self.controls.len() == data.ctrl().len() {
            data.ctrl_mut().copy_from_slice(&self.controls);
        }
        self.controls.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::NoiseSource;
    use crate::viewer::link::ControlNoise;
    use crate::{Data, Model};

    const TEXT: &str = r#"<mujoco><option timestep="0.01"/>
        <worldbody><body><joint name="hinge"/><geom size="0.1"/></body></worldbody>
        <actuator>
          <motor joint="hinge" ctrllimited="true" ctrlrange="-3 1"/>
          <motor joint="hinge"/>
        </actuator>
      </mujoco>"#;

    #[test]
    fn noise_has_the_standard_deviation_and_the_correlation_of_an_ornstein_uhlenbeck_process() {
        let mut data = Data::new(Model::from_xml_str(TEXT).unwrap()).unwrap();
        let settings = ControlNoise { deviation: 0.3, correlation_time: 0.05 };
        let mut noise = NoiseSource { settings, ..NoiseSource::default() };
        let count = 200_000;
        let (mut previous, mut variances, mut covariances) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for _ in 0..count {
            noise.apply(&mut data);
            for (index, &control) in data.ctrl().iter().enumerate() {
                variances[index] += control * control / f64::from(count);
                covariances[index] += control * previous[index] / f64::from(count);
                previous[index] = control;
            }
            noise.remove(&mut data);
            assert_eq!(data.ctrl(), [0.0; 2]);
        }
        // In half ranges of the first control, in the unit of the second.
        for (index, deviation) in [(0, 0.3 * 2.0), (1, 0.3)] {
            assert!((variances[index].sqrt() / deviation - 1.0).abs() < 0.03, "{variances:?}");
            let correlation = covariances[index] / variances[index];
            assert!((correlation - f64::exp(-0.01 / 0.05)).abs() < 0.01, "{correlation}");
        }
    }
}
