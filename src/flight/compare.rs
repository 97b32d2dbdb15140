//! Comparison of a trace with the results of this engine.

use std::io::Read;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::change;
use super::divergence::{Divergence, Pair, row_name};
use super::inputs;
use super::matched::{Order, align};
use super::model_difference::{self, ModelDifferences};
use super::origin::Origin;
use super::parts::invalid;
use super::quantities::{self, QUANTITIES, find};
use super::trace::{CONVERGED, NAME, Record, Results, Trace, TracedCall, TracedModel, converging, evaluate};
use crate::data::Data;
use crate::engine::engine_version;
use crate::error::{Error, Result};
use crate::model::Model;

/// Number of evaluations with disturbed inputs.
const DISTURBANCES: u64 = 3;
/// Least relative size of a disturbance.
const DISTURBANCE: f64 = 4.0 * f64::EPSILON;
/// Ratio of a difference to the effect of rounding up to which it counts as rounding.
const MOST_ROUNDING: f64 = 100.0;
/// Ratio of a difference to the remaining error of the solver up to which it counts as such.
const MOST_CONVERGENCE: f64 = 10.0;
/// Inputs that are disturbed.
const DISTURBED: [&str; 8] = ["qpos", "qvel", "act", "ctrl", "qfrc_applied", "xfrc_applied", "mocap_pos", "mocap_quat"];
/// Inputs that may have another length with another engine.
const INTERNAL: [&str; 6] = ["plugin", "plastic", "history", "sensordata", "act_dot", "eq_active"];

/// Differences of a trace from this engine. See [Comparison of engines](crate::flight).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Comparison {
    /// The program that has written the trace.
    pub origin: Origin,
    /// Number of calls.
    pub calls: u64,
    /// Number of calls whose quantities all have the same bits.
    pub identical: u64,
    /// The first difference of each quantity that rounding does not explain, in the order of the
    /// calls and of the stages. Those of the model have the stage `model`.
    pub divergences: Vec<Divergence>,
    /// The first difference of each quantity that the incomplete convergence of the solver
    /// explains.
    pub convergence: Vec<Divergence>,
    /// Fields of the model that differ, but do not enter a simulation: names, addresses, colours.
    pub other_fields: Vec<String>,
}

impl Comparison {
    /// Compares a trace with the results of this engine. Each call starts from the inputs in the
    /// trace. `model` is the model here; by default, this is the model of the trace with its edits.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidRecording`] for a damaged trace, [`Error::NotRepeated`] if this engine
    /// cannot load the model of the trace or the models have states of different lengths, and
    /// [`Error::File`] if the trace cannot be read.
    pub fn new(trace: impl Read, model: Option<&Model>) -> Result<Self> {
        let mut trace = Trace::open(trace)?;
        let Record::Begin { origin, xml } = trace.next()? else {
            return Err(invalid(NAME, "its first record is not its origin"));
        };
        let mut comparison = Self {
            origin,
            calls: 0,
            identical: 0,
            divergences: Vec::new(),
            convergence: Vec::new(),
            other_fields: Vec::new(),
        };
        let (mut first, mut side) = (None::<TracedModel>, None::<Side>);
        loop {
            match (trace.next()?, &mut side) {
                (Record::Model(traced), side) => {
                    let model = match model {
                        Some(model) => model.try_clone()?,
                        None => comparison.load(&xml, &traced, first.as_ref())?,
                    };
                    let disturbance = comparison.compare_models(&traced, &model)?;
                    *side = Some(Side::new(model, disturbance)?);
                    first.get_or_insert(traced);
                }
                (Record::Call(call), Some(side)) => {
                    comparison.compare_call(side, &call)?;
                    comparison.calls += 1;
                }
                (Record::End { .. }, _) => return Ok(comparison),
                (Record::Begin { .. } | Record::Call(_), _) => {
                    return Err(invalid(NAME, "its records have a wrong order"));
                }
            }
        }
    }

    /// Loads the model of the trace.
    fn load(&self, xml: &str, traced: &TracedModel, first: Option<&TracedModel>) -> Result<Model> {
        let here = engine_version().to_string();
        let mut reason = format!("the engine was {}, here it is {here}", self.origin.engine);
        if self.origin.engine == here && !traced.binary.is_empty() {
            match Model::from_binary(&traced.binary) {
                Ok(model) => return Ok(model),
                Err(error) => reason = error.to_string(),
            }
        }
        if xml.is_empty() {
            reason += ", and the trace has no MJCF: pass the model";
            return Err(Error::NotRepeated { call: self.calls, reason });
        }
        let mut model = Model::from_xml_str(xml)?;
        if let Some(first) = first {
            model_difference::follow(&mut model.edit(), &first.fields, &traced.fields);
        }
        Ok(model)
    }

    /// Compares the models, and returns the size of disturbances: at least that of the differences
    /// of the models that rounding explains.
    fn compare_models(&mut self, there: &TracedModel, here: &Model) -> Result<f64> {
        let ModelDifferences { divergences, other_fields, rounding } = model_difference::compare(
            &there.fields,
            here,
            self.calls,
            self.origin.engine == engine_version().to_string(),
        )?;
        for divergence in divergences {
            if !has(&self.divergences, &divergence.field) {
                self.divergences.push(divergence);
            }
        }
        self.other_fields.extend(other_fields);
        self.other_fields.sort();
        self.other_fields.dedup();
        Ok(DISTURBANCE.max(rounding))
    }

    fn compare_call(&mut self, side: &mut Side, traced: &TracedCall) -> Result<()> {
        let inputs = side.inputs(traced, self.calls)?;
        let time = inputs[0];
        let here = evaluate(&mut side.data, traced.call, &inputs);
        let there = &traced.results;
        let mut is_identical = there.error == here.error;
        if !is_identical && !has(&self.divergences, "result") {
            let text = |error: &Option<String>| error.as_deref().unwrap_or("success").to_owned();
            let element = format!("there: {}; here: {}", text(&there.error), text(&here.error));
            let [there, here] = [there, &here].map(|results| f64::from(u8::from(results.error.is_some())));
            let (call, stage, field, rounding) = (self.calls, "call", "result".to_owned(), 0.0);
            self.divergences.push(Divergence { call, time, stage, field, element, there, here, rounding });
        }
        let order = Order::of(&there.values, &here.values);
        let mut pairs = Vec::new();
        for quantity in QUANTITIES {
            let values = find(&there.values, quantity.name).zip(find(&here.values, quantity.name));
            // Matched constraints have the same objects.
            let is_matched = quantity.name == "efc_id" && order.constraints.is_some();
            let Some((there, here)) = values.filter(|_| !is_matched) else { continue };
            let there = align(quantity, there, &order);
            let has_same_shape = there.columns == here.columns && there.values.len() == here.values.len();
            if !has_same_shape || !change::is_same(&there.values, &here.values) {
                is_identical = false;
                if !has(&self.divergences, quantity.name) {
                    pairs.push((quantity, there, here));
                }
            }
        }
        self.identical += u64::from(is_identical);
        if pairs.is_empty() {
            return Ok(());
        }
        let disturbed = side.disturbed(traced, &inputs);
        let mut converged = None;
        for (quantity, there, values) in pairs {
            let disturbed = disturbed.iter().map(|results| find(&results.values, quantity.name));
            let worst = Pair::worst(&there, values, &disturbed.collect::<Vec<_>>(), 0.0);
            let Some(pair) = worst.filter(|pair| pair.ratio > MOST_ROUNDING) else { continue };
            let owner = |row| row_name(quantity.rows, row, &here.values, side.data.model());
            let element = pair.element(quantity.columns, owner);
            let divergence = pair.report(self.calls, time, quantity.stage, quantity.name, element);
            let mut error = 0.0;
            if quantity.depends_on_solver() {
                let of_trace = find(&traced.results.values, &format!("{CONVERGED}{}", quantity.name));
                let there = of_trace.zip(find(&traced.results.values, quantity.name));
                let converged = converged.get_or_insert_with(|| evaluate(&mut side.converged, traced.call, &inputs));
                let here = find(&converged.values, quantity.name).map(|converged| (converged, values));
                for (converged, values) in there.into_iter().chain(here) {
                    error = pair.error(quantity, converged, values).max(error);
                }
            }
            let most = MOST_CONVERGENCE * error + MOST_ROUNDING * pair.rounding;
            let is_convergence = (pair.there - pair.here).abs() <= most;
            let divergences = if is_convergence { &mut self.convergence } else { &mut self.divergences };
            if !has(divergences, quantity.name) {
                divergences.push(divergence);
            }
        }
        Ok(())
    }
}

fn has(divergences: &[Divergence], field: &str) -> bool {
    divergences.iter().any(|known| known.field == field)
}

/// Simulations of this engine.
struct Side {
    data: Data,
    /// Simulation whose solver converges further.
    converged: Data,
    /// Relative size of disturbances.
    disturbance: f64,
}

impl Side {
    fn new(model: Model, disturbance: f64) -> Result<Self> {
        let data = Data::new(model)?;
        let converged = converging(data.model())?;
        Ok(Self { data, converged, disturbance })
    }

    /// Returns the inputs of a call in the order of this engine.
    fn inputs(&mut self, traced: &TracedCall, call: u64) -> Result<Vec<f64>> {
        self.data.reset()?;
        let mut values = Vec::new();
        inputs::read(&self.data, &mut values);
        for (name, place) in quantities::inputs(self.data.model()) {
            match traced.inputs.iter().find(|input| input.name == name) {
                Some(input) if input.values.len() == place.len() => values[place].copy_from_slice(&input.values),
                Some(input) if !INTERNAL.contains(&&*name) => {
                    let (there, here) = (input.values.len(), place.len());
                    let reason = format!("the trace has {there} values of {name}, the model {here}");
                    return Err(Error::NotRepeated { call, reason });
                }
                _ => {}
            }
        }
        Ok(values)
    }

    /// Returns the results of a call from inputs that differ by rounding.
    fn disturbed(&mut self, traced: &TracedCall, values: &[f64]) -> Vec<Results> {
        let with_seed = |seed| {
            let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut disturbed = values.to_vec();
            for (_, place) in quantities::inputs(self.data.model()).filter(|(name, _)| DISTURBED.contains(&&**name)) {
                for value in &mut disturbed[place] {
                    let size = self.disturbance * value.abs().max(1.0);
                    *value += if random.random() { size } else { -size };
                }
            }
            evaluate(&mut self.data, traced.call, &disturbed)
        };
        (0..DISTURBANCES).map(with_seed).collect()
    }
}
