//! Statistics by which a policy normalises its inputs and outputs.

use serde_json::{Value, json};

/// Least and largest value, mean and standard deviation of each component of vectors.
#[derive(Default)]
pub(crate) struct Statistics {
    count: f64,
    components: Vec<Component>,
}

#[derive(Clone)]
struct Component {
    min: f64,
    max: f64,
    mean: f64,
    /// Sum of the squared distances from the mean.
    squares: f64,
}

impl Statistics {
    /// Adds vectors of one length, by Welford's method.
    pub(crate) fn add<V: AsRef<[f64]>>(&mut self, vectors: impl Iterator<Item = V>) {
        for vector in vectors {
            self.count += 1.0;
            let new = Component { min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0, squares: 0.0 };
            self.components.resize(vector.as_ref().len(), new);
            for (component, &value) in self.components.iter_mut().zip(vector.as_ref()) {
                component.min = component.min.min(value);
                component.max = component.max.max(value);
                let offset = value - component.mean;
                component.mean += offset / self.count;
                component.squares += offset * (value - component.mean);
            }
        }
    }

    /// Returns the statistics of a number of frames. `shaped` gives a component its shape.
    pub(crate) fn to_json(&self, frames: usize, shaped: impl Fn(f64) -> Value) -> Value {
        let all = |value: &dyn Fn(&Component) -> f64| {
            self.components.iter().map(|component| shaped(value(component))).collect::<Vec<_>>()
        };
        json!({
            "min": all(&|component| component.min),
            "max": all(&|component| component.max),
            "mean": all(&|component| component.mean),
            "std": all(&|component| (component.squares / self.count).sqrt()),
            "count": [frames],
        })
    }
}
